"""Systems whose H or L jumps: the momentum changes at once there, which no derivative shows.

Where H jumps at a surface g(q) = 0 the momentum changes along ∂g/∂q, and H keeps its value: a particle is refracted
(L. D. Landau & E. M. Lifshitz, *Mechanics*, 3rd ed., § 7, problem). What does not depend on the momentum in that
direction is kept with it, and so is a multiple of H beside it.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.exercise.question.deadline import PROOF_SECONDS
from canon.mechanics.algebra.linear import SingularMatrixError, solve
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.analytic import proved_sign
from canon.proof.continuity.continuity import continuity
from canon.proof.continuity.jumps import find_jump
from canon.proof.continuity.one_sided import cuts_of, off_the_kinks
from canon.proof.domain.verdict import Undecided
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.proof.domain.domain import Domain

__all__ = ["check_absent", "check_gauge_term", "check_kept_at_jumps", "check_motion_at_jumps"]


def check_kept_at_jumps(I: Expr, system: Hamiltonian | Lagrangian | None, domain: Domain) -> None:
    """Refuse a quantity that may change where the momentum does so at once.

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
    """Refuse a motion that may meet a jump of H or L.

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
        if proved_sign(substitute(gap, motion), there) not in ("+", "-"):
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

    Raises
    ------
    Undecided
        Where it jumps.
    """
    lagrangian = Lagrangian(difference, q, t=t)
    for gap in _jumps(lagrangian, domain):
        raise Undecided(_said(lagrangian, gap, "L2 − L1"))


def _said(system: Hamiltonian | Lagrangian, gap: Expr, name: str = "") -> str:
    name = name or ("H" if isinstance(system, Hamiltonian) else "L")
    return (
        f"{name} jumps where {gap} = 0: the momentum changes at once there, which no derivative shows; narrow the "
        "domain to one side"
    )


def _jumps(system: Hamiltonian | Lagrangian, domain: Domain) -> list[Expr]:
    """Return what vanishes where H or L is seen to jump."""
    f = system.H if isinstance(system, Hamiltonian) else system.L
    state = (*system.q, *(system.p if isinstance(system, Hamiltonian) else system.velocities), system.t)
    found: dict[Expr, None] = {}
    for cut in cuts_of(f, state):
        if cut.bends or cut.gap in found or proved_sign(cut.gap, domain) in ("+", "-"):
            continue
        if find_jump(f, cut, state, domain, time.monotonic() + PROOF_SECONDS) is not None:
            found[cut.gap] = None
    return list(found)


def _is_kept_at(gap: Expr, I: Expr, system: Hamiltonian | Lagrangian, domain: Domain) -> bool:
    """Tell whether I does not depend on the momentum across a surface, but for a multiple of the energy."""
    change = _change_of_motion(gap, system, domain)
    if change is None:
        return False
    energy = system.H if isinstance(system, Hamiltonian) else system.jacobi_energy
    state = (*system.q, *change, system.t)
    own, of_energy = (_slope(f, change) for f in (I, energy))
    if vanishes_off_kinks(own, domain, PROOF_SECONDS).holds:
        return True
    share = sp.cancel(own / of_energy) if of_energy != 0 else sp.nan
    if share.has(sp.nan, *state):
        return False
    return bool(continuity(sp.expand(I - share * energy), state, domain, PROOF_SECONDS, angles=False).holds)


def _slope(f: Expr, change: Mapping[Symbol, Expr]) -> Expr:
    return off_the_kinks(sp.expand(sp.Add(*(f.diff(s) * by for s, by in change.items()))))


def _change_of_motion(
    gap: Expr, system: Hamiltonian | Lagrangian, domain: Domain
) -> dict[Symbol, Expr] | None:
    """Return how momenta, or velocities, may change where g(q) = 0; None where g is no function of q."""
    if (gap.free_symbols & set(_beside(system))) or not gap.has(*system.q):
        return None
    normal = [gap.diff(x) for x in system.q]
    if isinstance(system, Hamiltonian):
        return dict(zip(system.p, normal, strict=True))
    try:
        changed = solve(system.mass_matrix, sp.Matrix(normal), domain)
    except SingularMatrixError:
        return None
    return dict(zip(system.velocities, cast("list[Expr]", list(changed)), strict=True))


def _beside(system: Hamiltonian | Lagrangian) -> Sequence[Symbol]:
    return (*(system.p if isinstance(system, Hamiltonian) else system.velocities), system.t)
