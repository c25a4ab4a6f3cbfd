"""Turns of angles: whether a function of an angle that winds has the same value after each turn.

A constant of the motion such as θ − t steps back by 2π at the cut of its angle, wherever that is laid: by the same
number everywhere, so that its slopes are continuous. exp(θ − t) or J (θ − t) steps by another number at each place, and
no function on phase space has its slopes: a motion that comes round has another value after each turn.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.proof.continuity.continuity import continuity
from canon.proof.domain.domain import EVERYWHERE, Domain

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from sympy import Expr, Symbol

    from canon.proof.domain.verdict import Verdict

__all__ = ["continuity_but_for_turns"]

LARGE = 2_000
"""Operations of a slope up to which its fractions are cancelled."""


def continuity_but_for_turns(
    f: Expr,
    variables: Sequence[Symbol],
    domain: Domain = EVERYWHERE,
    budget: float = 20.0,
    name: str = "",
    given: Iterable[Expr] = (),
) -> Verdict:
    """Tell whether a function is continuous but for angles that wind, at whose cuts it steps by fixed numbers.

    Parameters
    ----------
    f, variables, domain, budget, name, given
        As :func:`canon.proof.continuity.continuity.continuity` takes them; the budget is that of each of its questions.

    Returns
    -------
    Verdict
        HOLDS names in ``assumed`` the angles at whose cuts f steps.

    Examples
    --------
    >>> q, p, t = sp.symbols("q p t", real=True)
    >>> theta = sp.atan2(q, p)
    >>> [continuity_but_for_turns(f, [q, p, t]).status.name for f in (theta - t, sp.sin(theta - t), sp.exp(theta - t))]
    ['HOLDS', 'HOLDS', 'FAILS']
    """
    given, name = tuple(given), name or str(f)
    taken = continuity(f, variables, domain, budget, name, given)
    if not (taken.holds and taken.assumed):
        return taken
    whole = continuity(f, variables, domain, budget, name, given, angles=False)
    if whole.holds:
        return whole
    slopes = [
        continuity(_cancelled(f.diff(s)), variables, domain, budget, f"∂({name})/∂{s}", given, angles=False)
        for s in variables
        if f.has(s)
    ]
    worst = min(slopes, key=lambda verdict: (verdict.holds, verdict.undecided))
    if worst.holds:
        return taken
    return whole if worst.fails and whole.fails else worst


def _cancelled(slope: Expr) -> Expr:
    """Return a slope without the poles that d atan(q/p) has where p = 0, as it is written."""
    return cast("Expr", sp.cancel(slope)) if sp.count_ops(slope) < LARGE else slope
