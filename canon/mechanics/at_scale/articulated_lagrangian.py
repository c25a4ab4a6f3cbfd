"""Equations of motion of a Lagrangian whose kinetic energy is a sum of squares, along the tree of its velocities."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from canon.cached_property import cached_property
from canon.expression.graph.graph import Graph
from canon.mechanics.at_scale.articulated import tree_of_sums
from canon.mechanics.at_scale.assembly import Assembly
from canon.mechanics.at_scale.kinetic_terms import Reader
from canon.mechanics.at_scale.second_order import at_constant_speed
from canon.mechanics.at_scale.squares_of_velocities import squares_of_velocities

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy import Symbol

    from canon.array import Array
    from canon.mechanics.at_scale.articulated import TreeOfSums
    from canon.mechanics.lagrange.lagrangian import Lagrangian

__all__ = ["ArticulatedLagrangian", "articulated_lagrangian"]

_FEWEST = 6
"""Systems of fewer coordinates are solved with their mass matrix."""


@dataclass(frozen=True)
class ArticulatedLagrangian:
    """A Lagrangian L = Σ ½ w u² + R on a graph, u = Σ a q̇ + a₀ being sums of a tree.

    Parameters
    ----------
    lagrangian
        The Lagrangian.
    assembly
        Its channels, and the graph.
    tree
        Their sums.
    rest
        The node of R.
    """

    lagrangian: Lagrangian
    assembly: Assembly
    tree: TreeOfSums
    rest: int

    @property
    def graph(self) -> Graph:
        """The graph that all nodes are on."""
        return self.assembly.graph

    @property
    def depends_on_time(self) -> bool:
        """Whether t stands in L."""
        parts = [
            node for c in self.assembly.channels for node in (*(a for _, a in c.slopes), c.rest or self.rest)
        ]
        return self.lagrangian.t in self.graph.all_symbols((*parts, self.rest))

    @cached_property
    def _slopes_of_rest(self) -> tuple[int, ...]:
        """∂R/∂q, then ∂R/∂q̇."""
        return self.graph.gradient(self.rest, (*self.lagrangian.q, *self.lagrangian.velocities))

    @cached_property
    def _speeds(self) -> list[int]:
        """The sums u."""
        v, mul = self.assembly.v, self.graph.plain_mul
        return self.tree.added(lambda slope: [mul((slope[1], v[slope[0]])) if slope[0] >= 0 else slope[1]])

    @cached_property
    def momenta(self) -> tuple[int, ...]:
        """∂L/∂q̇, nodes."""
        n = len(self.lagrangian.q)
        own = self.tree.projected(self._speeds, n)
        return tuple(map(self.graph.plain_add, zip(own, self._slopes_of_rest[n:], strict=True)))

    @cached_property
    def energy(self) -> int:
        """Jacobi's function Σ q̇ ∂L/∂q̇ − L = Σ ½ w u (u − 2 a₀) + Σ q̇ ∂R/∂q̇ − R, a node."""
        graph, mul, n = self.graph, self.graph.plain_mul, len(self.lagrangian.q)
        half = graph.number(Fraction(1, 2))
        given = self.tree.added(lambda slope: [graph.multiple(-2, slope[1])] if slope[0] < 0 else [])
        terms = [
            mul((half, w, u, graph.plain_add((u, less))))
            for u, less, each in zip(self._speeds, given, self.tree.sums, strict=True)
            for w in each.weights
        ]
        terms += [mul(pair) for pair in zip(self.assembly.v, self._slopes_of_rest[n:], strict=True)]
        return graph.plain_add([*terms, graph.negative(self.rest)])

    @cached_property
    def right(self) -> tuple[int, ...]:
        """What M q̈ is: the right-hand side of Lagrange's equations, nodes."""
        graph, assembly, n = self.graph, self.assembly, len(self.lagrangian.q)
        # u̇ without accelerations
        along = self.tree.added(lambda s: assembly.rate(s[1], assembly.v[s[0]] if s[0] >= 0 else graph.one))
        terms = [[graph.negative(F)] for F in self.tree.projected(along, n)]
        for c in assembly.channels:
            for i, term in assembly.not_a_rate(c):
                terms[i].append(term)
        drifts = at_constant_speed(graph, self._slopes_of_rest[n:], self.lagrangian)
        for i, (slope, drift) in enumerate(zip(self._slopes_of_rest, drifts, strict=False)):
            terms[i] += [slope, graph.negative(drift)]
        for i, force in enumerate(self.lagrangian.forces):
            terms[i].append(assembly.reader.node(force))
        return tuple(map(graph.plain_add, terms))

    @cached_property
    def _masses_of_rest(self) -> dict[tuple[int, int], int]:
        """∂²R/∂q̇ᵢ∂q̇ⱼ by (i, j), i ≥ j, where it is not 0."""
        graph, v = self.graph, self.lagrangian.velocities
        fast = graph.mask(v)
        momenta = self._slopes_of_rest[len(v) :]
        found = {
            (i, j): graph.derivative(p, v[j])
            for i, p in enumerate(momenta)
            if graph.masks[p] & fast
            for j in range(i + 1)
        }
        return {place: node for place, node in found.items() if node != graph.zero}

    @cached_property
    def accelerations(self) -> tuple[int, ...]:
        """The accelerations q̈, nodes.

        Raises
        ------
        ZeroDivisionError
            A pivot is 0 on the graph.
        """
        return self.tree.solved(self.right, self._masses_of_rest)

    def mass_matrix(self) -> tuple[tuple[int, ...], ...]:
        """Return M as nodes, shape (n, n)."""
        lower = [[*row] for row in self.assembly.mass_matrix()]
        for (i, j), node in self._masses_of_rest.items():
            lower[i][j] = self.graph.plain_add((lower[i][j], node))
        n = len(lower)
        return tuple(tuple(lower[max(i, j)][min(i, j)] for j in range(n)) for i in range(n))

    def masses_at(self, values: Mapping[Symbol, float]) -> Array:
        """Return the numbers of M at a point, shape (n, n), worked out without its nodes."""
        graph, channels, n = self.graph, self.assembly.channels, len(self.lagrangian.q)
        nodes = [*dict.fromkeys(node for c in channels for node in (c.weight, *(a for _, a in c.slopes)))]
        nodes += self._masses_of_rest.values()
        number = dict(zip(nodes, map(float, graph.evaluate(nodes, values)), strict=True))
        slopes = np.zeros((len(channels), n))
        for row, c in zip(slopes, channels, strict=True):
            for i, a in c.slopes:
                row[i] += number[a]
        masses = slopes.T @ (np.array([number[c.weight] for c in channels])[:, np.newaxis] * slopes)
        for (i, j), node in self._masses_of_rest.items():
            masses[i, j] += number[node]
            masses[j, i] += number[node] * (i != j)
        return masses


def articulated_lagrangian(lagrangian: Lagrangian) -> ArticulatedLagrangian | None:
    """Return a Lagrangian along the tree of its velocities; None where they share little, or are few.

    Raises
    ------
    canon.expression.graph.sympy_conversion.NotModelledError
        L holds something the graph has no operation for.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> from sympy import cos
    >>> q = coordinates("q1:8")
    >>> paths = [sum(s.dot for s in q[: k + 1]) for k in range(7)]
    >>> L = Lagrangian(sum(u**2 for u in paths) / 2 + cos(q[-1]), q)
    >>> chain = articulated_lagrangian(L)
    >>> chain.tree.terms, [chain.graph.to_sympy(a) for a in chain.accelerations]
    (7, [0, 0, 0, 0, 0, sin(q7), -2*sin(q7)])
    """
    n = len(lagrangian.q)
    if n < _FEWEST:
        return None
    reader = Reader(Graph(), lagrangian.q, lagrangian.t)
    found = squares_of_velocities(reader, lagrangian.L)
    tree = tree_of_sums(reader.graph, found.channels)
    if 2 * tree.terms > sum(len(c.slopes) for c in found.channels):
        return None
    return ArticulatedLagrangian(lagrangian, Assembly(reader, found.channels), tree, reader.node(found.rest))
