"""Constrained motion at scale: M q̈ = f + Aᵀλ with A q̈ + γ = 0, index reduced, and a way back onto the constraints.

The constraints differentiated (γ = Ȧ q̇ + ȧ₀) leave M q̈ − Aᵀλ = f, A q̈ = −γ for q̈ and λ. Their solutions drift off
f(q, t) = 0 by what a numerical method does wrong; projection in the metric of M brings them back, to round-off
(E. Hairer & G. Wanner, Solving ODEs II, § VII.2), Baumgarte's terms 2α ḟ + β² f pull them back.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from canon.cached_property import cached_property
from canon.expression.graph.python_source import python_function
from canon.mechanics.algebra.dynamicsymbols import plain
from canon.mechanics.at_scale.numeric_functions import solved
from canon.mechanics.lagrange.dependence import DependentConstraintsError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.array import Array
    from canon.mechanics.at_scale.second_order import SecondOrderEquations


__all__ = ["ConstrainedEquations", "ConstrainedMotion", "constrained", "constrained_motion"]


@dataclass(frozen=True)
class ConstrainedEquations:
    """Equations of motion with constraints on one graph.

    Parameters
    ----------
    equations
        M and f without the reactions.
    values
        The holonomic constraints f(q, t), nodes; they come first among the rows.
    A
        The rows aₐ, n nodes each.
    rests
        a₀, so that A q̇ + a₀ = 0.
    curvatures
        γ = Ȧ q̇ + ȧ₀.
    """

    equations: SecondOrderEquations
    values: tuple[int, ...]
    A: tuple[tuple[int, ...], ...]
    rests: tuple[int, ...]
    curvatures: tuple[int, ...]

    @cached_property
    def nodes(self) -> tuple[int, ...]:
        """M, f, then A row by row, γ, a₀ and the holonomic values."""
        rows = (node for row in self.A for node in row)
        return (*self.equations.nodes, *rows, *self.curvatures, *self.rests, *self.values)

    @cached_property
    def parameters(self) -> tuple[Symbol, ...]:
        """The symbols besides q, q̇ and t, by name."""
        e = self.equations
        used = e.graph.all_symbols(self.nodes)
        return tuple(sorted(used - {*e.q, *e.velocities, e.t}, key=lambda s: s.name))


def constrained(
    equations: SecondOrderEquations, holonomic: Sequence[Expr] = (), nonholonomic: Sequence[Expr] = ()
) -> ConstrainedEquations:
    """Return equations of motion with constraints f(q, t) = 0 and g(q, q̇, t) = 0, the latter affine in q̇.

    Raises
    ------
    ValueError
        Where a holonomic constraint holds velocities, or another is not affine in them.
    DependentConstraintsError
        Where rows depend on one another at generic points, so that their multipliers are not determined.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.mechanics.lagrange.body import Particle
    >>> from canon.mechanics.at_scale.second_order import derivation
    >>> x, y = coordinates("x y")
    >>> m, l, g = parameters("m l g", positive=True)
    >>> free = derivation([Particle(m, (x, y))], [x, y], field=(0, -g))
    >>> hung = constrained_motion(constrained(free, holonomic=[x**2 + y**2 - l**2]), {m: 1, l: 2, g: 10})
    >>> a, tension = hung.accelerations([0.0, -2.0], [1.0, 0.0], 0.0)
    >>> a.round(12), tension.round(12)
    (array([0. , 0.5]), array([-2.625]))
    """
    graph, q, v, t = equations.graph, equations.q, equations.velocities, equations.t
    values = tuple(graph.from_sympy(plain(f, q, t)) for f in holonomic)
    given = tuple(graph.from_sympy(plain(g, q, t)) for g in nonholonomic)
    rows: list[tuple[int, ...]] = []
    rests: list[int] = []
    for f, node in zip(holonomic, values, strict=True):
        if graph.symbols(node) & set(v):
            raise ValueError(f"{f} = 0 holds velocities; give it as a nonholonomic constraint")
        rows.append(tuple(graph.derivative(node, s) for s in q))
        rests.append(graph.derivative(node, t))
    at_rest = {graph.symbol(s): graph.zero for s in v}
    for g, node in zip(nonholonomic, given, strict=True):
        row = tuple(graph.derivative(node, s) for s in v)
        if any(graph.symbols(a) & set(v) for a in row):
            raise ValueError(
                f"{g} = 0 is not affine in the velocities, so d'Alembert's principle does not cover it"
            )
        rows.append(row)
        rests.extend(graph.substitute([node], at_rest))
    _check_independent(equations, rows, (*holonomic, *nonholonomic))
    speeds = [graph.symbol(s) for s in v]
    rates = [
        graph.add((*(graph.mul((a, u)) for a, u in zip(row, speeds, strict=True)), rest))
        for row, rest in zip(rows, rests, strict=True)
    ]
    along = {**dict(zip(q, speeds, strict=True)), t: graph.one}
    curvatures = tuple(graph.directional(rates, along))
    return ConstrainedEquations(equations, values, tuple(rows), tuple(rests), curvatures)


@dataclass(frozen=True)
class ConstrainedMotion:
    """Constrained motion in numbers.

    Parameters
    ----------
    accelerations
        (q, q̇, t) → (q̈, λ).
    projected
        (q, q̇, t) → (q, q̇) on the constraints, the nearest in the metric of M; an ArithmeticError where Newton's
        iteration does not arrive.
    residual
        (q, q̇, t) → the values f and the rates A q̇ + a₀, which should vanish.
    """

    accelerations: Callable[[Sequence[float], Sequence[float], float], tuple[Array, Array]]
    projected: Callable[[Sequence[float], Sequence[float], float], tuple[Array, Array]]
    residual: Callable[[Sequence[float], Sequence[float], float], tuple[Array, Array]]


def constrained_motion(
    system: ConstrainedEquations, parameters: Mapping[Symbol, float], alpha: float = 0.0, beta: float = 0.0
) -> ConstrainedMotion:
    """Return constrained motion as functions of numbers.

    Parameters
    ----------
    system
        Equations with constraints.
    parameters
        A number for each parameter, in any consistent units.
    alpha, beta
        Baumgarte's rates, 1/time: the constraints obey f̈ + 2α ḟ + β² f = 0.

    Raises
    ------
    KeyError
        A parameter has no number.
    """
    missing = [str(s) for s in system.parameters if s not in parameters]
    if missing:
        raise KeyError(f"no number for {', '.join(missing)}; give one each in parameters")
    constants = tuple(float(parameters[s]) for s in system.parameters)
    e, k, h = system.equations, len(system.A), len(system.values)
    n = len(e.q)
    evaluate = python_function(e.graph, system.nodes, (*e.q, *e.velocities, e.t, *system.parameters))
    lower = np.tril_indices(n)
    ends = np.cumsum([lower[0].size, n, k * n, k, k])

    def parts(q: Sequence[float] | Array, v: Sequence[float] | Array, t: float) -> tuple[Array, list[Array]]:
        M, f, A, curvature, rest, values = np.split(np.array(evaluate((*q, *v, t, *constants))), ends)
        bordered = np.zeros((n + k, n + k))
        bordered[:n, :n][lower] = M
        bordered[:n, :n].T[lower] = M
        bordered[n:, :n] = A.reshape(k, n)
        bordered[:n, n:] = bordered[n:, :n].T
        return bordered, [f, curvature, A.reshape(k, n) @ np.asarray(v, dtype=np.float64) + rest, values]

    def accelerations(q: Sequence[float], v: Sequence[float], t: float) -> tuple[Array, Array]:
        bordered, (f, curvature, rate, values) = parts(q, v, t)
        pull = 2 * alpha * rate
        pull[:h] += beta**2 * values
        found = _solved(bordered, np.concatenate([f, -curvature - pull]))
        return found[:n], -found[n:]

    def projected(q: Sequence[float], v: Sequence[float], t: float) -> tuple[Array, Array]:
        place, speed = np.asarray(q, dtype=np.float64), np.asarray(v, dtype=np.float64)
        bordered, (_, _, rate, values) = parts(place, speed, t)
        size = np.inf
        while h and np.abs(values).max() < size:
            size = np.abs(values).max()
            nearer = place + _solved(bordered, np.concatenate([np.zeros(n), -values, np.zeros(k - h)]))[:n]
            bordered, (_, _, rate, values) = parts(nearer, speed, t)
            place = nearer if np.abs(values).max() < size else place
        if h and size > _NEAR:
            raise ArithmeticError(
                f"no point of the constraints was found from here (|f| = {size:.2g} remains); start nearer to them"
            )
        bordered, (_, _, rate, _) = parts(place, speed, t)
        return place, speed + _solved(bordered, np.concatenate([np.zeros(n), -rate]))[:n]

    def residual(q: Sequence[float], v: Sequence[float], t: float) -> tuple[Array, Array]:
        _, (_, _, rate, values) = parts(q, v, t)
        return values, rate

    return ConstrainedMotion(accelerations, projected, residual)


def _check_independent(
    equations: SecondOrderEquations, rows: Sequence[Sequence[int]], constraints: Sequence[Expr]
) -> None:
    """Look for dependent rows at a few points; rows of full rank at one of them are independent."""
    graph, flat = equations.graph, [a for row in rows for a in row]
    symbols = sorted(graph.all_symbols(flat), key=lambda s: s.name)
    chance = np.random.default_rng(5)
    for _ in range(4):
        point = dict(zip(symbols, chance.uniform(0.3, 1.7, len(symbols)), strict=True))
        A = np.array(graph.evaluate(flat, point), dtype=np.float64).reshape(len(rows), -1)
        if not np.isfinite(A).all():
            continue
        left, sizes, _ = np.linalg.svd(A)
        rank = int((sizes > 1e-12 * sizes.max(initial=0.0)).sum())
        if rank == len(rows):
            return
        combination = left[:, -1]
        dependent = tuple(
            a + 1 for a, c in enumerate(combination) if abs(c) > 1e-8 * np.abs(combination).max()
        )
        named = " and ".join(f"constraint {a} ({constraints[a - 1]} = 0)" for a in dependent)
        raise DependentConstraintsError(
            f"{named} {'depend on one another' if len(dependent) > 1 else 'restricts no velocity'}, so that no "
            "multiplier is determined; leave one of them out",
            dependent,
            (),
            contradictory=None,
        )


_NEAR = 1e-8
"""What Newton's iteration leaves of f at most, in the constraints' own units."""


def _solved(matrix: Array, right: Array) -> Array:
    return solved(matrix, right, "the matrix of masses and constraints")
