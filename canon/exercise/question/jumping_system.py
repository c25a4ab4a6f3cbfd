"""Systems whose H or L jumps: the motion changes at once there, which no derivative shows.

Where H jumps at a surface g(q) = 0 the momentum changes along ∂g/∂q, and H keeps its value: a particle is refracted
(L. D. Landau & E. M. Lifshitz, *Mechanics*, 3rd ed., § 7, problem). In general the state changes along the flow of g.
What has no bracket with g is kept, and so is a multiple of H beside it, if they are continuous there. At a jump in time
alone the state does not change.
"""

from __future__ import annotations

import time
from itertools import combinations
from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.question.deadline import SIDE_SECONDS
from canon.mechanics.algebra.linear import SingularMatrixError, solve
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.analytic import proved_sign
from canon.proof.continuity.branching import open_surfaces
from canon.proof.continuity.continuity import meets
from canon.proof.continuity.jumps import continued, real_sides
from canon.proof.continuity.one_sided import cuts_of, off_the_kinks
from canon.proof.continuity.winding_centre import centre_of
from canon.proof.domain.verdict import Undecided
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.proof.domain.domain import Domain

__all__ = [
    "check_absent",
    "check_gauge_term",
    "check_has_no_jumps",
    "check_kept_at_jumps",
    "check_motion_at_jumps",
]


def check_kept_at_jumps(I: Expr, system: Hamiltonian | Lagrangian | None, domain: Domain) -> None:
    """Refuse a quantity that may change where the motion does so at once.

    Raises
    ------
    Undecided
        Where it is not seen to keep its value there.
    """
    if system is None:
        return
    for gap in _jumps(system, domain):
        if not _is_kept_at(gap, I, system, domain):
            raise Undecided(_said(system, gap))


def check_motion_at_jumps(
    motion: Mapping[Symbol, Expr], system: Hamiltonian | Lagrangian | None, there: Domain, domain: Domain
) -> None:
    """Refuse a motion that may meet a jump of H or L, other than one in time alone.

    Parameters
    ----------
    motion
        The coordinates as functions of the time.
    system
        The system.
    there, domain
        Where the times are, and where the states are.

    Raises
    ------
    Undecided
        Where it is not proved to stay on one side.
    """
    if system is None:
        return
    for gap in _jumps(system, domain):
        met = proved_sign(substitute(gap, motion), there) not in ("+", "-")
        if met and not (_is_of_time(gap, system) and _is_kick(gap, system, domain)):
            raise Undecided(_said(system, gap))


def check_has_no_jumps(system: Hamiltonian | Lagrangian | None, domain: Domain) -> None:
    """Refuse a system that jumps, of which families of motions are claimed.

    Raises
    ------
    Undecided
        Where it jumps.
    """
    if system is None:
        return
    for gap in _jumps(system, domain):
        raise Undecided(_said(system, gap))


def check_absent(coordinates: Sequence[Symbol], lagrangian: Lagrangian, domain: Domain) -> None:
    """Refuse coordinates of which L seems to be free where it is differentiable, but at which it jumps.

    Raises
    ------
    Undecided
        Where L jumps at one of them.
    """
    for gap in _jumps(lagrangian, domain):
        if gap.has(*coordinates):
            raise Undecided(_said(lagrangian, gap))


def check_gauge_term(difference: Expr, q: Sequence[Symbol], t: Symbol, domain: Domain) -> None:
    """Refuse a difference of Lagrangians that jumps: it may give an impulse where no equation shows it.

    At a step of a·q̇ across the surface alone, as in sign(x) ẋ = d|x|/dt, the function whose rate it is has a kink.

    Raises
    ------
    Undecided
        Where it jumps otherwise.
    """
    lagrangian = Lagrangian(difference, q, t=t)
    state = _state(lagrangian)
    for gap in _jumps(lagrangian, domain):
        step = continued(difference, gap, state, up=True) - continued(difference, gap, state, up=False)
        slopes = [(step.diff(v), gap.diff(x)) for x, v in zip(q, lagrangian.velocities, strict=True)]
        along = [a * h - b * g for (a, g), (b, h) in combinations(slopes, 2)]
        if gap.has(t) or not vanishes_off_kinks(sp.Matrix([0, *along]), domain, SIDE_SECONDS).holds:
            raise Undecided(_said(lagrangian, gap, "L2 − L1"))


def _said(system: Hamiltonian | Lagrangian, gap: Expr, name: str = "") -> str:
    name = name or ("H" if isinstance(system, Hamiltonian) else "L")
    return (
        f"{name} may jump where {gap} = 0: the momentum changes at once there, which no derivative shows; narrow the "
        "domain to one side"
    )


def _function(system: Hamiltonian | Lagrangian) -> Expr:
    return system.H if isinstance(system, Hamiltonian) else system.L


def _state(system: Hamiltonian | Lagrangian) -> tuple[Symbol, ...]:
    return (*system.q, *(system.p if isinstance(system, Hamiltonian) else system.velocities), system.t)


def _jumps(system: Hamiltonian | Lagrangian, domain: Domain) -> list[Expr]:
    """Return what vanishes where H or L is not proved to be continuous; angles that wind are taken as they are.

    It may jump at the cuts of functions with pieces and, hidden from all derivatives, where roots and logarithms
    branch or a function is taken of a pole; where it is not real on one side it ends.
    """
    f, state = _function(system), _state(system)
    found: dict[Expr, bool] = {}
    for cut in cuts_of(f, state):
        if cut.gap in found or centre_of(cut, state, domain):
            continue
        apart = proved_sign(cut.gap, domain) in ("+", "-")
        found[cut.gap] = not apart and not meets(f, cut.gap, state, domain, SIDE_SECONDS)
    until = time.monotonic() + SIDE_SECONDS
    for surface in open_surfaces(f, state, domain):
        if surface.gap not in found:
            sides = None if f.has(sp.I) else real_sides(f, surface.gap, state, domain, until)
            found[surface.gap] = sides in (None, 2)
    return [gap for gap, jumps in found.items() if jumps]


def _is_kept_at(gap: Expr, I: Expr, system: Hamiltonian | Lagrangian, domain: Domain) -> bool:
    """Tell whether I has no bracket with the surface, but for a multiple of the energy, and is continuous there."""
    change = _change(gap, system, domain)
    if change is None:
        return False
    energy = system.H if isinstance(system, Hamiltonian) else system.jacobi_energy
    own, of_energy = (_slope(f, change) for f in (I, energy))
    share = sp.S.Zero
    if not vanishes_off_kinks(own, domain, SIDE_SECONDS).holds:
        share = sp.cancel(own / of_energy) if of_energy != 0 else sp.nan
    if share.has(sp.nan, *_state(system)):
        return False
    return meets(sp.expand(I - share * energy), gap, _state(system), domain, SIDE_SECONDS)


def _slope(f: Expr, change: Mapping[Symbol, Expr]) -> Expr:
    return off_the_kinks(sp.expand(sp.Add(*(f.diff(s) * by for s, by in change.items()))))


def _change(gap: Expr, system: Hamiltonian | Lagrangian, domain: Domain) -> dict[Symbol, Expr] | None:
    """Return along what the state may change where the gap vanishes; None where that is not known."""
    if isinstance(system, Hamiltonian):
        pairs = list(zip(system.q, system.p, strict=True))
        return {p: gap.diff(q) for q, p in pairs} | {q: -gap.diff(p) for q, p in pairs}
    if gap.has(*system.velocities) or not _is_kick(gap, system, domain):
        return None
    try:
        changed = solve(system.inertia, sp.Matrix([gap.diff(x) for x in system.q]), domain)
    except SingularMatrixError:
        return None
    return dict(zip(system.velocities, changed.flat(), strict=True))


def _is_of_time(gap: Expr, system: Hamiltonian | Lagrangian) -> bool:
    return not gap.has(*_state(system)[:-1])


def _is_kick(gap: Expr, system: Hamiltonian | Lagrangian, domain: Domain) -> bool:
    """Tell whether velocities change as momenta do: the part of L that holds them is continuous there."""
    if isinstance(system, Hamiltonian):
        return True
    at_rest = substitute(system.L, dict.fromkeys(system.velocities, sp.S.Zero))
    return meets(sp.expand(system.L - at_rest), gap, _state(system), domain, SIDE_SECONDS)
