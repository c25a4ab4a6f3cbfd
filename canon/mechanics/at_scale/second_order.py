"""Equations of motion at scale: M(q, t) q̈ = f(q, q̇, t) on an expression graph.

For T = ½ Σ w u², u = a·q̇ + a₀, Lagrange's equations are Σ w a (a·q̈) = −Σ w a s − Σ w u (Dₜa − ∂u/∂q) − ∂V/∂q + Q, with
s the part of u̇ without accelerations; the second sum vanishes where u is the rate of a position. Terms with equal
slopes a are put together first, so a chain of n links has n terms in f and not n². Nothing is expanded.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp

from canon.cached_property import cached_property
from canon.expression.graph.common_subexpressions import shared_to_sympy
from canon.expression.graph.graph import Graph
from canon.expression.graph.sums import opposite, signed_product
from canon.expression.symbols.symbol import time, velocity
from canon.mechanics.algebra.dynamicsymbols import coordinate_symbols
from canon.mechanics.at_scale.assembly import Assembly
from canon.mechanics.at_scale.kinetic_terms import Reader, channels
from canon.mechanics.lagrange.lagrangian import forces_in_order

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.mechanics.lagrange.body import Body
    from canon.mechanics.lagrange.lagrangian import Lagrangian

__all__ = ["SecondOrderEquations", "at_constant_speed", "derivation", "derivation_of_lagrangian"]


@dataclass(frozen=True)
class SecondOrderEquations:
    """Equations of motion M q̈ = f on a graph.

    Parameters
    ----------
    graph
        The graph that the numbers below are nodes of.
    q
        The coordinates.
    M
        Lower triangle of the symmetric mass matrix: row i has i + 1 nodes.
    f
        The right-hand side f(q, q̇, t), n nodes.
    t
        The time.
    """

    graph: Graph
    q: tuple[Symbol, ...]
    M: tuple[tuple[int, ...], ...]
    f: tuple[int, ...]
    t: Symbol

    @cached_property
    def velocities(self) -> tuple[Symbol, ...]:
        """The symbols q̇."""
        return tuple(velocity(s) for s in self.q)

    @cached_property
    def nodes(self) -> tuple[int, ...]:
        """The lower triangle of M row by row, then f."""
        return (*(node for row in self.M for node in row), *self.f)

    @cached_property
    def parameters(self) -> tuple[Symbol, ...]:
        """The symbols besides q, q̇ and t, by name."""
        used = self.graph.all_symbols(self.nodes)
        return tuple(sorted(used - {*self.q, *self.velocities, self.t}, key=lambda s: s.name))

    @property
    def operations(self) -> int:
        """How many operations M and f take: shared ones counted once, k − 1 for k terms or factors, signs free."""
        minus = self.graph.number(-1)
        total = 0
        for each in self.graph.reachable(self.nodes):
            operands = [o for o in self.graph.nodes[each].operands if o != minus]
            total += (
                max(len(operands) - 1, self.graph.nodes[each].kind not in ("add", "mul")) if operands else 0
            )
        return total

    def to_sympy(self) -> tuple[list[tuple[Symbol, Expr]], sp.Matrix, sp.Matrix]:
        """Return M and f as SymPy matrices, what they share replaced by symbols, in the manner of :func:`sympy.cse`.

        Returns
        -------
        replacements
            Pairs (symbol, expression), each in symbols that came before.
        M, f
            Matrices of shapes (n, n) and (n, 1).
        """
        n = len(self.q)
        replacements, found = shared_to_sympy(self.graph, self.nodes)
        rows = [found[i * (i + 1) // 2 : (i + 1) * (i + 2) // 2] for i in range(n)]
        M = sp.Matrix(n, n, lambda i, j: rows[max(i, j)][min(i, j)])
        return replacements, M, sp.Matrix(found[-n:])


def derivation(
    bodies: Sequence[Body],
    q: Sequence[Symbol],
    V: Expr = sp.S.Zero,
    field: Sequence[Expr] = (),
    forces: Sequence[Expr] | Mapping[Symbol, Expr] | None = None,
    t: Symbol = time,
) -> SecondOrderEquations:
    """Return Lagrange's equations M q̈ = f of bodies, derived on an expression graph.

    Parameters
    ----------
    bodies
        Particles and rigid bodies, as functions of q and t.
    q
        The coordinates; SymPy's dynamicsymbols are welcome here and in everything else that is given.
    V
        The potential energy besides that of the field; it may be affine in the velocities, as −e (A·ṙ − φ) is.
    field
        The acceleration vector of uniform gravity, as in ``(0, -g)``.
    forces
        Generalized forces Q(q, q̇, t) without potential, one a coordinate; or by coordinate, ``{x: -c*x.dot}``.
    t
        The time.

    Raises
    ------
    ValueError
        Where the forces do not match the coordinates, or V is not affine in the velocities.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.mechanics.lagrange.body import Particle
    >>> from sympy import cos, sin
    >>> theta = coordinates("theta")
    >>> m, l, g = parameters("m l g", positive=True)
    >>> bob = Particle(m, (l*sin(theta), -l*cos(theta)))
    >>> pendulum = derivation([bob], [theta], field=(0, -g))
    >>> pendulum.graph.to_sympy(pendulum.M[0][0])
    l**2*m
    """
    reader = Reader(Graph(), coordinate_symbols(q), t)
    graph = reader.graph
    assembly = Assembly(reader, list(channels(reader, bodies, field)))
    along = [
        opposite(graph, signed_product(graph, (c.weight, assembly.excess(c)))) for c in assembly.channels
    ]
    terms = [[F] for F in assembly.projected(along)]
    for c in assembly.channels:
        for i, term in assembly.not_a_rate(c):
            terms[i].append(term)
    _add_given(terms, reader, V, forces_in_order(forces, reader.q))
    return SecondOrderEquations(
        graph, reader.q, assembly.mass_matrix(), tuple(map(graph.plain_add, terms)), t
    )


def _add_given(terms: list[list[int]], reader: Reader, V: Expr, forces: Sequence[Expr]) -> None:
    """Append d/dt ∂V/∂q̇ − ∂V/∂q and the given forces to the terms of each coordinate."""
    graph = reader.graph
    for i, a in enumerate(graph.gradient(reader.given(V), reader.q)):
        terms[i].append(graph.negative(a))
    along = {**{s: graph.symbol(velocity(s)) for s in reader.q}, reader.t: graph.one}
    for i, a in enumerate(graph.directional(reader.slopes_in_velocities(V), along)):
        terms[i].append(a)
    for i, Q in enumerate(forces):
        terms[i].append(reader.given(Q))


def at_constant_speed(graph: Graph, nodes: Sequence[int], lagrangian: Lagrangian) -> list[int]:
    """Return the rates of functions of q, q̇ and t along a motion without accelerations, all nodes."""
    q, v = lagrangian.q, lagrangian.velocities
    along = {**{s: graph.symbol(w) for s, w in zip(q, v, strict=True)}, lagrangian.t: graph.one}
    return graph.directional(nodes, along)


def derivation_of_lagrangian(lagrangian: Lagrangian) -> SecondOrderEquations:
    """Return the equations of motion of any Lagrangian, differentiated on a graph.

    M = ∂p/∂q̇ may depend on the velocities then.

    Raises
    ------
    canon.expression.graph.sympy_conversion.NotModelledError
        L holds something the graph has no operation for.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates, parameters
    >>> x = coordinates("x")
    >>> m, k = parameters("m k", positive=True)
    >>> oscillator = derivation_of_lagrangian(Lagrangian(m*x.dot**2/2 - k*x**4/4, [x]))
    >>> [oscillator.graph.to_sympy(node) for node in oscillator.nodes]
    [m, -k*x**3]
    """
    graph = Graph()
    q, v, t = lagrangian.q, lagrangian.velocities, lagrangian.t
    both = graph.gradient(graph.from_sympy(lagrangian.L), (*q, *v))
    momenta = both[len(q) :]
    M = [tuple(graph.derivative(p, w) for w in v[: i + 1]) for i, p in enumerate(momenta)]
    Q = [(graph.from_sympy(force),) for force in lagrangian.forces] or [()] * len(q)
    f: list[int] = []
    for i, drift in enumerate(at_constant_speed(graph, momenta, lagrangian)):
        kind, operands, _ = graph.nodes[drift]
        left = map(graph.negative, operands if kind == "add" else (drift,))
        f.append(graph.add((both[i], *Q[i], *left)))
    return SecondOrderEquations(graph, q, tuple(M), tuple(f), t)
