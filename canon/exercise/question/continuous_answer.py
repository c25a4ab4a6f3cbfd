"""Continuity of answers known by derivatives only: constants of motion, generating functions, gauge terms, Casimirs.

Such a function may have jumped from one constant to another, which no derivative shows: it must be continuous too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.exercise.question.deadline import PROOF_SECONDS
from canon.exercise.question.question import fails
from canon.proof.continuity.continuity import continuity, is_locally_constant

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from sympy import Expr, Symbol

    from canon.proof.domain.domain import Domain
    from canon.proof.domain.verdict import Verdict

__all__ = ["constants_are_continuous", "is_continuous"]

LARGE = 2_000
"""Operations of a slope up to which its fractions are cancelled."""


def is_continuous(
    f: Expr, variables: Iterable[Symbol], domain: Domain, name: str, given: Iterable[Expr] = ()
) -> Verdict:
    """Return whether a function that is known by its derivatives is continuous where what is given is so."""
    return continuity(f, variables, domain, PROOF_SECONDS, name, given)


def constants_are_continuous(
    I: Expr, state: Sequence[Symbol], domain: Domain, given: Iterable[Expr] = ()
) -> Iterator[Verdict]:
    """Yield whether a quantity with vanishing rate is continuous; one that is a number on each piece is told so.

    An angle that winds may jump by what it grows in a turn, always the same number: its slopes do not jump. A function
    of it that jumps otherwise, such as exp(θ − t), has another value after each turn, and is no constant.
    """
    verdict = is_continuous(I, state, domain, str(I), given)
    if verdict.holds and verdict.assumed:
        verdict = _of_angles(I, state, domain, tuple(given), verdict)
    if verdict.fails and is_locally_constant(I, state, domain):
        why = (
            f"{I} says nothing about the motion: all its derivatives vanish identically, "
            "so it is a number on each piece of its domain, whatever the system"
        )
        yield fails(f"{I} is a constant of the motion", why, I)
        return
    yield verdict


def _of_angles(
    I: Expr, state: Sequence[Symbol], domain: Domain, given: tuple[Expr, ...], taken: Verdict
) -> Verdict:
    """Return whether a function of angles that wind jumps by a fixed number at most; ``taken`` says which angles."""
    whole = continuity(I, state, domain, PROOF_SECONDS, str(I), given, angles=False)
    if whole.holds:
        return whole
    slopes = [
        continuity(_cancelled(I.diff(s)), state, domain, PROOF_SECONDS, f"∂({I})/∂{s}", given, angles=False)
        for s in state
        if I.has(s)
    ]
    worst = min(slopes, key=lambda verdict: (verdict.holds, verdict.undecided))
    if worst.holds:
        return taken
    return whole if worst.fails and whole.fails else worst


def _cancelled(slope: Expr) -> Expr:
    """Return a slope without the poles that d atan(q/p) has where p = 0, as it is written."""
    return cast("Expr", sp.cancel(slope)) if sp.count_ops(slope) < LARGE else slope
