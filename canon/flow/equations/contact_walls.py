"""Walls f(q, t) ≥ 0 of a motion: their nodes, and the equations of all regimes of contact as one system.

Each contact has a variable σ that rests between events: 1 while it is closed, 0 while it is open. With G = A M⁻¹Aᵀ,

    σᵢ (Σ Gᵢₖ λₖ + (A q̈₀ + γ + 2α ḟ + α² f)ᵢ) + (1 − σᵢ) λᵢ = 0

makes λ keep f = 0 in the one case and vanish in the other, so that one system of equations has all regimes, and events
that change σ lead from one to the next. Elimination in the given order meets principal minors of G alone, which are
positive.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from canon.expression.graph.piecewise_form import without_pieces
from canon.expression.symbols.symbol import acceleration
from canon.flow.equations.first_order_motion import Residual, from_no_other_start
from canon.flow.equations.lagrangian_motion import multiplier_symbol, values_at_start
from canon.flow.equations.linear_equations import solved_from_start

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.expression.graph.graph import Graph
    from canon.flow.equations.first_order_motion import FirstOrderMotion

__all__ = [
    "NEAR",
    "Regimes",
    "Wall",
    "dot",
    "is_touched",
    "power_of_two",
    "size_of_wall",
    "values_of",
    "wall_of",
]

NEAR = 1e-9
"""In parts of the size of its terms: a contact that misses 0 by less at the start is closed, or about to open."""


@dataclass(frozen=True)
class Wall:
    """A contact's nodes: f, ∂f/∂q, ḟ, its part without accelerations of f̈, and M⁻¹ of its direction."""

    f: Expr
    value: int
    normal: tuple[int, ...]
    rate: int
    curvature: int
    pushed: tuple[int, ...]
    kept: tuple[int, ...]
    switch: Symbol
    margin: Symbol
    armed: Symbol


@dataclass(frozen=True)
class Regimes:
    """The equations of all regimes, and the events that lead from one to the next."""

    free: FirstOrderMotion
    walls: Sequence[Wall]
    unit: Fraction
    alpha: Fraction

    @property
    def graph(self) -> Graph:
        """The graph of all nodes."""
        return self.free.graph

    def motion(self) -> FirstOrderMotion:
        """Return the equations."""
        graph, free, walls = self.graph, self.free, self.walls
        n, multipliers = len(free.q), self.multipliers
        others = [
            graph.add(
                (own, *(graph.mul((lam, w.kept[b])) for lam, w in zip(multipliers, walls, strict=True)))
            )
            for b, own in enumerate(free.multipliers)
        ]
        every, power = (*others, *multipliers), free.power
        rests = [graph.substitute([r.node], self._at_rest)[0] for r in free.residuals if r.words == "rate"]
        rests += [graph.substitute([w.rate], self._at_rest)[0] for w in walls]
        more = [
            graph.add((new, graph.negative(old))) for new, old in zip(others, free.multipliers, strict=True)
        ]
        more += multipliers
        assert power is not None
        power = graph.add(
            (power, *(graph.negative(graph.mul(pair)) for pair in zip(more, rests, strict=True)))
        )
        kept, rates = [*(free.reactions or [graph.zero] * n)], self.accelerations
        added = [self._force(k, more) for k in range(n)]
        named = dict(free.named) | dict(zip((acceleration(s) for s in free.q), rates, strict=True))
        named |= {multiplier_symbol(i): node for i, node in enumerate(every, 1)}
        return replace(
            free,
            kind="Lagrangian with contacts",
            rates=(*free.rates[:n], *rates),
            power=power,
            named=named,
            multipliers=every,
            reactions=tuple(graph.add(pair) for pair in zip(kept, added, strict=True)),
            masses=tuple,
            residuals=(*free.residuals, *self._residuals()),
            holds_from=from_no_other_start,
        )

    @property
    def accelerations(self) -> tuple[int, ...]:
        """The nodes of the accelerations in all regimes."""
        graph, n, multipliers = self.graph, len(self.free.q), self.multipliers
        pushes = [
            [graph.mul((lam, w.pushed[k])) for lam, w in zip(multipliers, self.walls, strict=True)]
            for k in range(n)
        ]
        return tuple(graph.add((self.free.rates[n + k], *pushes[k])) for k in range(n))

    @property
    def _at_rest(self) -> dict[int, int]:
        return {self.graph.symbol(s): self.graph.zero for s in self.free.second}

    def _force(self, k: int, more: Sequence[int]) -> int:
        """Return what the contacts add to the force of constraint along coordinate k, M q̈ − Q − …, through them."""
        graph, rows = self.graph, self.free.matrix[len(self.free.q) :]
        along = [row[k] for row in rows] + [w.normal[k] for w in self.walls]
        return graph.add([graph.mul(pair) for pair in zip(more, along, strict=True)])

    def _residuals(self) -> tuple[Residual, ...]:
        graph = self.graph
        closed = [self.closed(w) for w in self.walls]
        pairs = list(zip(closed, self.walls, strict=True))
        return (
            *(Residual(graph.mul((s, w.value)), "position") for s, w in pairs),
            *(Residual(graph.mul((s, w.rate)), "rate") for s, w in pairs),
        )

    def closed(self, wall: Wall) -> int:
        """Return the node that is 1 while a contact is closed and 0 while it is open."""
        return self.graph.scaled(1 / self.unit, self.graph.symbol(wall.switch))

    def open(self, wall: Wall) -> int:
        """Return the node that is 0 while a contact is closed and 1 while it is open."""
        return self.graph.add((self.graph.one, self.graph.negative(self.closed(wall))))

    @property
    def multipliers(self) -> tuple[int, ...]:
        """λ, one a contact, by elimination in the given order."""
        graph, n = self.graph, len(self.free.q)
        accelerations, alpha = self.free.rates[n:], self.alpha
        rows, right = list[list[int]](), list[int]()
        for i, wall in enumerate(self.walls):
            s, away = self.closed(wall), self.open(wall)
            G = [graph.mul((s, dot(graph, wall.normal, other.pushed))) for other in self.walls]
            G[i] = graph.add((G[i], away))
            bent = (dot(graph, wall.normal, accelerations), wall.curvature)
            back = (graph.scaled(2 * alpha, wall.rate), graph.scaled(alpha**2, wall.value))
            rows.append(G)
            right.append(graph.negative(graph.mul((s, graph.add((*bent, *back))))))
        return _in_order(graph, rows, right)


def wall_of(free: FirstOrderMotion, f: Expr, start: Mapping[Symbol, float]) -> Wall:
    """Return the nodes of a wall."""
    graph, q, t, n = free.graph, free.q, free.t, len(free.q)
    value = graph.from_sympy(without_pieces(f))
    normal = graph.gradient(value, q)
    speeds = [graph.symbol(s) for s in free.second]
    rate = graph.add((dot(graph, normal, speeds), graph.derivative(value, t)))
    bent = (dot(graph, graph.gradient(rate, q), speeds), graph.derivative(rate, t))
    size = len(free.matrix)
    values = values_at_start(graph, [a for row in free.matrix for a in row], start, "the mass matrix")
    right = [*normal, *[graph.zero] * (size - n)]
    solved = solved_from_start(graph, free.matrix, right, values.reshape(size, size))
    return Wall(
        f, value, normal, rate, graph.add(bent), tuple(solved[:n]), tuple(map(graph.negative, solved[n:])),
        sp.Dummy("closed", real=True), sp.Dummy("margin", real=True), sp.Dummy("armed", real=True),
    )  # fmt: skip


def size_of_wall(free: FirstOrderMotion, wall: Wall, start: Mapping[Symbol, float]) -> float:
    """Return the size of f's terms at the start; where all places are 0 there, f for places of size 1."""
    slopes = np.abs(values_of(free.graph, wall.normal, start))
    places = np.abs([float(start[s]) for s in free.q])
    f = abs(float(values_of(free.graph, [wall.value], start)[0]))
    return max(float(slopes @ places), f) or float(slopes.max()) or 1.0


def is_touched(free: FirstOrderMotion, wall: Wall, start: Mapping[Symbol, float]) -> bool:
    """Tell whether a wall is touched at the start."""
    f = float(values_of(free.graph, [wall.value], start)[0])
    return abs(f) <= NEAR * size_of_wall(free, wall, start)


def values_of(graph: Graph, nodes: Sequence[int], start: Mapping[Symbol, float]) -> Any:
    """Return what nodes are at the start."""
    with np.errstate(all="ignore"):
        return np.array([float(x) for x in graph.evaluate(nodes, start)])


def power_of_two(size: float) -> Fraction:
    """Return the power of 2 above a size; 1 of none."""
    return Fraction(2) ** (math.frexp(size)[1] if 0 < size < math.inf else 0)


def _in_order(graph: Graph, rows: Sequence[list[int]], right: Sequence[int]) -> tuple[int, ...]:
    """Return the solution of linear equations, eliminated in the order in which they stand."""
    table, n = [[*row, b] for row, b in zip(rows, right, strict=True)], len(rows)
    for k in range(n):
        inverse = graph.power(table[k][k], -1)
        for i in range(k + 1, n):
            factor = graph.negative(graph.mul((table[i][k], inverse)))
            table[i] = [
                a if j <= k else graph.add((a, graph.mul((factor, b))))
                for j, (a, b) in enumerate(zip(table[i], table[k], strict=True))
            ]
    x = [graph.zero] * n
    for i in reversed(range(n)):
        taken = [graph.negative(graph.mul((table[i][j], x[j]))) for j in range(i + 1, n)]
        x[i] = graph.mul((graph.add((table[i][n], *taken)), graph.power(table[i][i], -1)))
    return tuple(x)


def dot(graph: Graph, a: Sequence[int], b: Sequence[int]) -> int:
    """Return the node of Σ a b."""
    return graph.add([graph.mul(pair) for pair in zip(a, b, strict=True)])
