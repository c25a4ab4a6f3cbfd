"""Time transformations: symplectic methods with steps that vary along the orbit, for close encounters.

A step is taken in a fictitious time s with dt/ds = g. The extended Hamiltonian of (q, t; p, p_t), p_t = −H at
the start, makes that a Hamiltonian motion again, so that symplectic methods stay symplectic: Poincaré's K =
g(q, p)(H + p_t), which does not split and takes Gauss methods; or, where H = T(p) + V(q, t) with V < 0, the
logarithmic K = log(T + p_t) − log(−V) with g = 1/(T + p_t), which is −1/V along the motion and splits. On
Kepler's problem the drifts and kicks of the latter give the true orbit, up to round-off, with an error in time
only.

Sources: S. Mikkola, K. Tanikawa, Explicit symplectic algorithms for time-transformed Hamiltonians, Celest.
Mech. Dyn. Astron. 74 (1999) 287–295, doi:10.1023/A:1008368322547; M. Preto, S. Tremaine, A class of symplectic
integrators with adaptive time step for separable Hamiltonian systems, Astron. J. 118 (1999) 2532–2541,
doi:10.1086/301102; E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration (2nd ed., Springer 2006), §
VIII.2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from canon.flow.method import TimeTransformed
    from canon.flow.request import HamiltonianSystem

__all__ = ["Extended", "extended"]


@dataclass(frozen=True)
class Extended:
    """The Hamiltonian K of the extended phase space (q, t; p, p_t) in the fictitious time s.

    Parameters
    ----------
    H
        K.
    q, p, t
        Coordinates with t, momenta with p_t, and s.
    rate
        dt/ds along the motion, a function of (q, t).
    """

    H: Expr
    q: tuple[Symbol, ...]
    p: tuple[Symbol, ...]
    t: Symbol
    rate: Expr


def extended(hamiltonian: HamiltonianSystem, method: TimeTransformed) -> Extended:
    """Return the extended Hamiltonian whose motion in s is that of H in t.

    Raises
    ------
    ValueError
        The logarithmic transformation is asked of an H that is no sum T(p) + V(q, t).

    Examples
    --------
    >>> from canon.flow.method import Splitting, TimeTransformed
    >>> from canon.scene import find
    >>> extended(find("kepler").hamiltonian, TimeTransformed(Splitting("verlet"))).rate
    sqrt(x**2 + y**2)/mu
    """
    t, p_t, s = sp.Symbol("t", real=True), sp.Symbol("p_t", real=True), sp.Symbol("s", real=True)
    taken = {symbol.name for symbol in (*hamiltonian.q, *hamiltonian.p)}
    if taken & {"t", "p_t"}:
        t, p_t = sp.Dummy("t", real=True), sp.Dummy("p_t", real=True)
    energy: Any = hamiltonian.H.xreplace({hamiltonian.t: t})
    q, p = (*hamiltonian.q, t), (*hamiltonian.p, p_t)
    if method.g is not None:
        g: Any = sp.sympify(method.g, strict=True).xreplace({hamiltonian.t: t})
        return Extended(g * (energy + p_t), q, p, s, g)
    kinetic, potential = _split(energy, hamiltonian, t)
    return Extended(sp.log(kinetic + p_t) - sp.log(-potential), q, p, s, -1 / potential)


def _split(energy: Any, hamiltonian: HamiltonianSystem, t: Symbol) -> tuple[Any, Any]:
    """Return T(p) and V(q, t)."""
    if energy.is_polynomial(*hamiltonian.q, *hamiltonian.p):
        energy = sp.expand(energy)
    kinetic, potential = sp.S.Zero, sp.S.Zero
    for term in sp.Add.make_args(energy):
        moves, rests = term.has(*hamiltonian.p), term.has(*hamiltonian.q, t)
        if moves and rests:
            raise ValueError(
                f"the logarithmic transformation needs H = T(p) + V(q, t), but H holds {term}; use "
                "TimeTransformed(Gauss(6), g=…) with a function g of your own"
            )
        kinetic, potential = (kinetic + term, potential) if moves else (kinetic, potential + term)
    return kinetic, potential
