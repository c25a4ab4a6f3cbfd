"""Extended Hamiltonian of a time transformation: symplectic steps that vary along the orbit, for close encounters.

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

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.flow.run.event import PreparedEvent, prepared_events
from canon.kernel.program.program import exact_value
from canon.mechanics.algebra.dynamicsymbols import in_own_time

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from sympy import Expr, Symbol

    from canon.flow.method.method import TimeTransformed
    from canon.flow.run.event import Event
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["Extended", "ExtendedSystem", "extended", "extended_system"]

# No parameter of H is one of these, whatever its name is.
_P_T, _S = sp.Dummy("p_t", real=True), sp.Dummy("s", real=True)


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
    >>> from canon.flow.method.method import Splitting, TimeTransformed
    >>> from canon.scene import find
    >>> extended(find("kepler").hamiltonian, TimeTransformed(Splitting("verlet"))).rate
    sqrt(x**2 + y**2)/mu
    """
    t, p_t, s = hamiltonian.t, _P_T, _S
    energy: Any = hamiltonian.H
    q, p = (*hamiltonian.q, t), (*hamiltonian.p, p_t)
    if method.g is not None:
        g: Any = in_own_time(method.g, (*hamiltonian.q, *hamiltonian.p), t)
        return Extended(g * (energy + p_t), q, p, s, g)
    kinetic, potential = _split(hamiltonian)
    return Extended(sp.log(kinetic + p_t) - sp.log(-potential), q, p, s, -1 / potential)


def _split(hamiltonian: HamiltonianSystem) -> tuple[Any, Any]:
    """Return T(p) and V(q, t)."""
    energy: Any = hamiltonian.H
    if energy.is_polynomial(*hamiltonian.q, *hamiltonian.p):
        energy = sp.expand(energy)
    kinetic, potential = sp.S.Zero, sp.S.Zero
    for term in _terms(energy, hamiltonian):
        moves, rests = term.has(*hamiltonian.p), term.has(*hamiltonian.q, hamiltonian.t)
        if moves and rests:
            raise ValueError(
                f"the logarithmic transformation needs H = T(p) + V(q, t), but H holds {term}; use "
                "TimeTransformed(Gauss(6), g=…) with a function g of your own"
            )
        kinetic, potential = (kinetic + term, potential) if moves else (kinetic, potential + term)
    return kinetic, potential


def _terms(energy: Any, hamiltonian: HamiltonianSystem) -> list[Any]:
    """Return the terms of a sum; those of a product such as (T + V)/m where it holds momenta beside coordinates."""
    terms = list[Any]()
    for term in sp.Add.make_args(energy):
        mixed = term.has(*hamiltonian.p) and term.has(*hamiltonian.q, hamiltonian.t)
        terms += sp.Add.make_args(sp.expand_mul(term)) if mixed else [term]
    return terms


@dataclass(frozen=True, eq=False)
class ExtendedSystem:
    """What a motion in a fictitious time needs beside H's own equations.

    Parameters
    ----------
    system
        Hamilton's equations of K, their time the fictitious one.
    physical
        Those of H on the same graph.
    rate
        The node of dt/ds as a function of (q, p, t).
    words
        What dt/ds is, for messages.
    step
        The size in t of the first step.
    """

    system: HamiltonEquations
    physical: HamiltonEquations
    rate: int
    words: str
    step: Fraction

    @property
    def clock(self) -> int:
        """Which component of the extended state is t."""
        return len(self.physical.q) - self.physical.varying

    @property
    def rows(self) -> list[int]:
        """The components of the extended state that are (q, p), parameters that vary included."""
        half = len(self.system.q)
        return [i for i in range(2 * half) if i % half != self.clock]

    def start(self, state: Sequence[Fraction], t: Fraction) -> tuple[list[Fraction], Fraction]:
        """Return the extended state at the start of a motion, and the step's size in the fictitious time.

        Raises
        ------
        ValueError
            dt/ds is not positive there.
        """
        physical, graph = self.physical, self.physical.graph
        values = zip(physical.inputs, (*state, t), strict=True)
        point = {graph.symbol(symbol): graph.number(value) for symbol, value in values}
        try:
            nodes = graph.substitute([physical.hamiltonian, self.rate], point)
        except ZeroDivisionError:
            raise ValueError(
                f"dt/ds = {self.words} has no value at the start, and time-transformed methods need it positive along "
                "the motion: add a constant to V that makes it negative, or give another g"
            ) from None
        energy, rate = (exact_value(graph, node) for node in nodes)
        if not rate > 0:
            raise ValueError(
                f"dt/ds = {self.words} is {float(rate):g} at the start, and time-transformed methods need it positive "
                "along the motion: give another g"
            )
        half = len(state) // 2
        q, p = list(state[:half]), list(state[half:])
        q.insert(self.clock, t)
        p.insert(self.clock, -energy)
        return [*q, *p], self.step / rate

    def events(self, events: Sequence[Event]) -> tuple[PreparedEvent, ...]:
        """Return events for the extended motion: their slopes are by s, and p_t changes as −H does."""
        return tuple(self._prepared(event) for event in prepared_events(self.physical, events))

    def _prepared(self, event: PreparedEvent) -> PreparedEvent:
        graph, physical = self.system.graph, self.physical
        rate = graph.mul([event.rate, self.system.velocity[self.clock]])
        if event.jump is None:
            return replace(event, rate=rate)
        state = (*physical.q, *physical.p)
        changed = {graph.symbol(symbol): new for symbol, new in zip(state, event.jump, strict=True)}
        energy = physical.hamiltonian
        (after,) = graph.substitute([energy], changed)
        t, p_t = (graph.symbol(half[self.clock]) for half in (self.system.q, self.system.p))
        half = len(physical.q)
        q, p = list(event.jump[:half]), list(event.jump[half:])
        q.insert(self.clock, t)
        p.insert(self.clock, graph.add([p_t, energy, graph.negative(after)]))
        return replace(event, rate=rate, jump=(*q, *p))


def extended_system(
    larger: Extended, system: HamiltonEquations, hamiltonian: HamiltonianSystem, step: Fraction
) -> ExtendedSystem:
    """Return what a motion in the fictitious time of an extended Hamiltonian needs.

    Parameters
    ----------
    larger, system
        The extended Hamiltonian, and its equations with numbers for the parameters.
    hamiltonian
        H.
    step
        The size in t of the first step.
    """
    graph, varying = system.graph, system.varying
    n = len(hamiltonian.q)
    q, p = (*hamiltonian.q, *system.q[n + 1 :]), (*hamiltonian.p, *system.p[n + 1 :])
    energy = system.node(hamiltonian.H, "the Hamiltonian")
    slopes = graph.gradient(energy, (*hamiltonian.q, *hamiltonian.p))
    stays = (graph.zero,) * varying
    physical = replace(
        system,
        q=q,
        p=p,
        t=hamiltonian.t,
        written=system.moving_by(
            (*slopes[n:], *stays), (*(graph.negative(slope) for slope in slopes[:n]), *stays), energy
        ),
    )
    return ExtendedSystem(system, physical, system.node(larger.rate, "dt/ds"), str(larger.rate), step)
