"""Continuity of answers known by derivatives only: constants of motion, generating functions, gauge terms, Casimirs.

Such a function may have jumped from one constant to another, which no derivative shows: it must be continuous too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.exercise.question.deadline import PROOF_SECONDS
from canon.exercise.question.question import fails
from canon.proof.analytic import proved_sign
from canon.proof.continuity.constant_steps import is_locally_constant
from canon.proof.continuity.continuity import continuity
from canon.proof.continuity.jumps import continued
from canon.proof.continuity.one_sided import cuts_of
from canon.proof.continuity.turns_of_angles import continuity_but_for_turns
from canon.proof.domain.domain import Domain
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from sympy import Expr, Symbol
    from sympy.logic.boolalg import Boolean

    from canon.proof.domain.verdict import Verdict

__all__ = ["constants_are_continuous", "is_continuous"]


def is_continuous(
    f: Expr, variables: Iterable[Symbol], domain: Domain, name: str, given: Iterable[Expr] = ()
) -> Verdict:
    """Return whether a function that is known by its derivatives is continuous where what is given is so."""
    return continuity(f, variables, domain, PROOF_SECONDS, name, given)


def constants_are_continuous(
    I: Expr,
    state: Sequence[Symbol],
    domain: Domain,
    rates: Callable[[Expr], Sequence[Expr]],
    given: Iterable[Expr] = (),
) -> Iterator[Verdict]:
    """Yield whether a quantity with vanishing rates is continuous; one that is a number on each piece is told so.

    An angle that winds may jump by what it grows in a turn, always the same number: its slopes do not jump. A function
    of it that jumps otherwise, such as exp(θ − t), has another value after each turn, and is no constant. Where it
    jumps at another constant of the motion, as sign(E − 1) E does, no motion comes from one side to the other.

    Parameters
    ----------
    I, state, domain, given
        The quantity, what moves, where, and what is given of the system.
    rates
        What vanishes where a function of the state is a constant too: its rate, or its brackets.
    """
    given = tuple(given)
    verdict = continuity_but_for_turns(I, state, domain, PROOF_SECONDS, str(I), given)
    if verdict.fails and is_locally_constant(I, state, domain):
        why = (
            f"{I} says nothing about the motion: all its derivatives vanish identically, "
            "so it is a number on each piece of its domain, whatever the system"
        )
        yield fails(f"{I} is a constant of the motion", why, I)
        return
    kept = None if verdict.holds else _kept_border(I, state, domain, rates, given)
    if kept is None:
        yield verdict
        return
    for up, side in ((True, kept > 0), (False, kept < 0)):
        there = Domain((*domain.conditions, cast("Boolean", side)), domain.box)
        one_sided = continued(I, kept, state, up=up)
        if one_sided.has(*state):
            yield from constants_are_continuous(one_sided, state, there, rates, given)


def _kept_border(
    I: Expr,
    state: Sequence[Symbol],
    domain: Domain,
    rates: Callable[[Expr], Sequence[Expr]],
    given: Sequence[Expr],
) -> Expr | None:
    """Return what vanishes where I may jump and is a continuous constant of the motion; None of a system that jumps."""
    if any(_open_gaps(f, state, domain) for f in given):
        return None
    for gap in _open_gaps(I, state, domain):
        is_kept = vanishes(sp.Matrix(rates(gap)), domain, PROOF_SECONDS).holds
        if is_kept and continuity(gap, state, domain, PROOF_SECONDS, angles=False).holds:
            return gap
    return None


def _open_gaps(f: Expr, state: Sequence[Symbol], domain: Domain) -> list[Expr]:
    """Return what vanishes where a function may jump inside the domain."""
    return [cut.gap for cut in cuts_of(f, state) if not cut.bends and proved_sign(cut.gap, domain) == ""]
