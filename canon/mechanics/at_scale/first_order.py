"""Hamilton's equations at scale: p = M(q, t) q̇ + b, ṗ = ∂L/∂q + Q at fixed q̇, on an expression graph.

The velocities follow from the momenta by solving with M, numerically or by L D Lᵀ on the graph; no matrix is
inverted, and ∂H/∂q = −∂L/∂q spares the derivative of an inverse.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import sympy as sp

from canon.cached_property import cached_property
from canon.expression.graph.graph import Graph
from canon.expression.graph.python_source import python_function
from canon.expression.symbols.symbol import momentum, time, velocity
from canon.mechanics.algebra.dynamicsymbols import coordinate_symbols
from canon.mechanics.at_scale.assembly import Assembly
from canon.mechanics.at_scale.kinetic_terms import Reader, channels
from canon.mechanics.at_scale.ldl import solved_on_graph
from canon.mechanics.lagrange.lagrangian import forces_in_order

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.mechanics.lagrange.body import Body

__all__ = ["CanonicalEquations", "canonical_derivation"]


@dataclass(frozen=True)
class CanonicalEquations:
    """Momenta, their rates and the energy on a graph, in q, q̇ and t.

    Parameters
    ----------
    graph
        The graph that the numbers below are nodes of.
    q
        The coordinates.
    M
        Lower triangle of the symmetric mass matrix: row i has i + 1 nodes.
    drift
        b = p at q̇ = 0, n nodes.
    p_dot
        ∂L/∂q + Q as a function of q, q̇, t, n nodes.
    potential
        V − T₀, so that H = ½ q̇·(p − b) + V − T₀.
    t
        The time.
    """

    graph: Graph
    q: tuple[Symbol, ...]
    M: tuple[tuple[int, ...], ...]
    drift: tuple[int, ...]
    p_dot: tuple[int, ...]
    potential: int
    t: Symbol

    @cached_property
    def p(self) -> tuple[Symbol, ...]:
        """The symbols of the momenta."""
        return tuple(momentum(s) for s in self.q)

    @cached_property
    def velocities(self) -> tuple[Symbol, ...]:
        """The symbols q̇."""
        return tuple(velocity(s) for s in self.q)

    @cached_property
    def parameters(self) -> tuple[Symbol, ...]:
        """The symbols besides q, q̇ and t, by name."""
        nodes = (*(node for row in self.M for node in row), *self.drift, *self.p_dot, self.potential)
        used = self.graph.all_symbols(nodes)
        return tuple(sorted(used - {*self.q, *self.velocities, self.t}, key=lambda s: s.name))

    @cached_property
    def at_place(self) -> Callable[[Sequence[float]], tuple[float, ...]]:
        """M, b and V − T₀ as a function of the numbers q, t, parameters; H and Hamilton's equations share it."""
        nodes = (*(node for row in self.M for node in row), *self.drift, self.potential)
        return python_function(self.graph, nodes, (*self.q, self.t, *self.parameters))

    @cached_property
    def momentum_excess(self) -> tuple[int, ...]:
        """The nodes p − b = M q̇."""
        graph = self.graph
        return tuple(
            graph.plain_add((graph.symbol(s), graph.negative(b)))
            for s, b in zip(self.p, self.drift, strict=True)
        )

    @cached_property
    def q_dot(self) -> tuple[int, ...]:
        """The velocities as nodes in q, p, t, by L D Lᵀ of M on the graph."""
        return solved_on_graph(self.graph, self.M, self.momentum_excess)

    @cached_property
    def hamiltonian(self) -> int:
        """H(q, p, t) as a node."""
        graph = self.graph
        terms = [graph.plain_mul(pair) for pair in zip(self.momentum_excess, self.q_dot, strict=True)]
        return graph.plain_add(
            (graph.plain_mul((graph.number(Fraction(1, 2)), graph.plain_add(terms))), self.potential)
        )

    @cached_property
    def explicit_p_dot(self) -> tuple[int, ...]:
        """The rates ṗ as nodes in q, p, t."""
        v = {self.graph.symbol(s): node for s, node in zip(self.velocities, self.q_dot, strict=True)}
        return tuple(self.graph.substitute(self.p_dot, v))


def canonical_derivation(
    bodies: Sequence[Body],
    q: Sequence[Symbol],
    V: Expr = sp.S.Zero,
    field: Sequence[Expr] = (),
    forces: Sequence[Expr] | Mapping[Symbol, Expr] | None = None,
    t: Symbol = time,
) -> CanonicalEquations:
    """Return Hamilton's equations of bodies, derived on an expression graph.

    The parameters are those of :func:`canon.mechanics.at_scale.second_order.derivation`.

    Raises
    ------
    ValueError
        Where the forces do not match the coordinates, or V is not affine in the velocities.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.mechanics.lagrange.body import Particle
    >>> x = coordinates("x")
    >>> m, k = parameters("m k", positive=True)
    >>> spring = canonical_derivation([Particle(m, (x,))], [x], k*x**2/2)
    >>> spring.graph.to_sympy(spring.hamiltonian)
    k*x**2/2 + p_x**2/(2*m)
    """
    reader = Reader(Graph(), coordinate_symbols(q), t)
    graph, mul = reader.graph, reader.graph.plain_mul
    assembly = Assembly(reader, list(channels(reader, bodies, field)))
    found = assembly.channels
    loads = [graph.zero if c.load is None else mul((c.weight, c.load)) for c in found]
    still = [graph.zero if c.rest is None else mul((c.weight, c.rest)) for c in found]
    momenta = [mul((c.weight, assembly.speed(c))) for c in found]
    potential = reader.given(V)
    pulls = [graph.negative(a) for a in graph.gradient(potential, reader.q)]
    given = [reader.given(Q) for Q in forces_in_order(forces, reader.q)] or [graph.zero] * len(reader.q)
    p_dot = zip(assembly.slopes_of_T(momenta), assembly.projected(loads), pulls, given, strict=True)
    drift = assembly.projected(still)
    shifts = reader.slopes_in_velocities(V)
    if (
        shifts
    ):  # p = ∂T/∂q̇ − ∂V/∂q̇, and H holds V without velocities: Σ q̇ ∂V/∂q̇ − V is that with its sign changed
        drift = [graph.plain_add((b, graph.negative(a))) for b, a in zip(drift, shifts, strict=True)]
        (potential,) = graph.substitute(
            [potential], {graph.symbol(velocity(s)): graph.zero for s in reader.q}
        )
    energies = [potential, *assembly.heights(bodies, field)]
    for w, c in zip(still, found, strict=True):
        if c.rest is not None:
            energies.append(mul((graph.number(Fraction(-1, 2)), w, c.rest)))
    return CanonicalEquations(
        graph, reader.q, assembly.mass_matrix(), tuple(drift),
        tuple(graph.plain_add(terms) for terms in p_dot), graph.plain_add(energies), t,
    )  # fmt: skip
