"""Continuity of answers known by derivatives only: constants of motion, generating functions, gauge terms, Casimirs.

Such a function may have jumped from one constant to another, which no derivative shows: it must be continuous too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.exercise.question.deadline import PROOF_SECONDS
from canon.exercise.question.question import fails
from canon.proof.continuity.constant_steps import is_locally_constant
from canon.proof.continuity.continuity import continuity
from canon.proof.continuity.turns_of_angles import continuity_but_for_turns

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from sympy import Expr, Symbol

    from canon.proof.domain.domain import Domain
    from canon.proof.domain.verdict import Verdict

__all__ = ["constants_are_continuous", "is_continuous"]


def is_continuous(
    f: Expr, variables: Iterable[Symbol], domain: Domain, name: str, given: Iterable[Expr] = ()
) -> Verdict:
    """Return whether a function that is known by its derivatives is continuous where what is given is so."""
    return continuity(f, variables, domain, PROOF_SECONDS, name, given)


def constants_are_continuous(
    I: Expr, state: Sequence[Symbol], domain: Domain, given: Iterable[Expr] = ()
) -> Iterator[Verdict]:
    """Yield whether a quantity with vanishing rates is continuous; one that is a number on each piece is told so.

    An angle that winds may jump by what it grows in a turn, always the same number: its slopes do not jump. A function
    of it that jumps otherwise, such as exp(θ − t), has another value after each turn, and is no constant. One that
    jumps where no motion crosses, as sign(E − 1) E does, is two constants, each on a domain of its own.

    Parameters
    ----------
    I, state, domain, given
        The quantity, what moves, where, and what is given of the system.
    """
    verdict = continuity_but_for_turns(I, state, domain, PROOF_SECONDS, str(I), tuple(given))
    if verdict.fails and is_locally_constant(I, state, domain):
        why = (
            f"{I} says nothing about the motion: all its derivatives vanish identically, "
            "so it is a number on each piece of its domain, whatever the system"
        )
        yield fails(f"{I} is a constant of the motion", why, I)
        return
    yield verdict
