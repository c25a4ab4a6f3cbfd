"""Extended phase space: a motion driven in time as one that conserves an energy, the time being a coordinate.

K = H(q, p, τ) + p_τ with τ̇ = ∂K/∂p_τ = 1 and ṗ_τ = −∂H/∂τ moves (q, p) as H does. Where p_τ = 0 at the start, −p_τ is
the work done from outside, ∫ ∂H/∂t dt, so that K is the energy less that work and should stay what H was at the start.
A method applied to K takes the steps it takes with H; K splits where the potential alone depends on the time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sympy import Expr

    from canon.array import Array
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.mechanics.hamilton.hamiltonian import Hamiltonian
    from canon.study.motion.observables import Observable

__all__ = ["Driven", "driven"]


@dataclass(frozen=True)
class Driven:
    """A motion with its time as the last coordinate.

    Parameters
    ----------
    hamiltonian
        K(q, τ; p, p_τ).
    time
        The time of H, and the coordinate τ in its place.
    """

    hamiltonian: Hamiltonian
    time: tuple[Expr, Expr]

    def state(self, y0: Array) -> Array:
        """Return the state (q, 0; p, 0) of a state (q, p); an axis of orbits stays."""
        n = len(y0) // 2
        return np.insert(y0, [n, 2 * n], 0.0, axis=0)

    def original(self, y: Array) -> Array:
        """Return the (q, p) of a state with time and work."""
        n = len(y) // 2 - 1
        return np.delete(y, [n, 2 * n + 1], axis=0)

    def observable(self, of: Observable) -> Observable:
        """Return an observable of (q, p, t) as one of (q, τ; p, p_τ)."""
        if of.expression is None:
            return of
        return replace(of, expression=of.expression.xreplace(dict([self.time])))


def driven(hamiltonian: HamiltonianSystem) -> Driven:
    """Return the motion of H(q, p, t) with its time as a coordinate.

    Examples
    --------
    >>> from canon import Hamiltonian, coordinates
    >>> from canon.expression.symbols.symbol import time
    >>> x = coordinates("x")
    >>> shaken = Hamiltonian(x.momentum**2 / 2 - x * time, [x], [x.momentum])
    >>> driven(shaken).hamiltonian.H
    p_tau - tau*x + p_x**2/2
    """
    import sympy as sp

    from canon.mechanics.hamilton.hamiltonian import Hamiltonian

    taken = {str(symbol) for symbol in (*hamiltonian.H.free_symbols, *hamiltonian.q, *hamiltonian.p)}
    name = next(name for name in ("tau", *(f"tau_{k}" for k in range(1, 99))) if name not in taken)
    tau, work = sp.Symbol(name, real=True), sp.Symbol(f"p_{name}", real=True)
    H = hamiltonian.H.xreplace({hamiltonian.t: tau}) + work
    return Driven(Hamiltonian(H, [*hamiltonian.q, tau], [*hamiltonian.p, work]), time=(hamiltonian.t, tau))
