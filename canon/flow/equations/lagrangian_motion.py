"""Motion of a Lagrangian with forces and constraints, in the state (q, q̇).

M q̈ − Aᵀλ = f, A q̈ = −γ with the constraints differentiated (twice f(q, t) = 0, once g(q, q̇, t) = 0), solved on the
graph. 2α ġ + α² f is added to the differentiated constraints, so that round-off off the constraints dies out
(J. Baumgarte, Comput. Methods Appl. Mech. Eng. 1, 1 (1972), doi:10.1016/0045-7825(72)90018-7), α being the fastest rate
of the motion's linearisation at the start. Jacobi's energy h = Σ q̇ ∂L/∂q̇ − L changes at the rate
Q·q̇ + Σ λ (a·q̇) − ∂L/∂t, and a·q̇ = −a₀ on the constraints.
"""

from __future__ import annotations

import functools
import math
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from canon.expression.symbols.symbol import acceleration, momentum
from canon.flow.equations.articulated_motion import articulated_motion
from canon.flow.equations.first_order_motion import FirstOrderMotion, Residual, from_no_other_start
from canon.flow.equations.linear_equations import (
    SingularAtStartError,
    independent_rows,
    pivots_hold,
    refuse_infinite,
    solved_from_start,
    undetermined,
)
from canon.kernel.program.lagrangian.momenta_and_forces import MomentaAndForces
from canon.mechanics.at_scale.constrained import constrained
from canon.mechanics.at_scale.second_order import derivation_of_lagrangian

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.array import Array
    from canon.expression.graph.graph import Graph
    from canon.flow.equations.first_order_motion import MovingSystem
    from canon.mechanics.at_scale.constrained import ConstrainedEquations
    from canon.mechanics.at_scale.second_order import SecondOrderEquations
    from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
    from canon.mechanics.lagrange.lagrangian import Lagrangian

__all__ = [
    "SPAN",
    "NoDiscreteActionError",
    "constraints_of",
    "lagrangian_motion",
    "multiplier_symbol",
    "rate_of_pull",
    "values_at_start",
    "with_momenta_and_forces",
]

_PULL = sp.Dummy("alpha", positive=True)

SPAN = sp.Dummy("span", real=True)
"""Under this symbol numbers of the start have the span, which says how slow is slow, and whether time runs back."""

_IN_A_SPAN = 10.0
"""How many times in the span a deviation from the constraints falls by a factor e where the motion has no rates."""


class NoDiscreteActionError(ValueError):
    """The system is none whose discrete action a variational integrator makes stationary; the message says why."""


def multiplier_symbol(i: int) -> Symbol:
    """Return the name under which the multiplier of constraint i = 1, 2 … is known to observables and events."""
    return sp.Symbol(f"lambda_{i}", real=True)


def constraints_of(
    system: Lagrangian | ConstrainedLagrangian,
) -> tuple[Lagrangian, Sequence[Expr], Sequence[Expr]]:
    """Return a Lagrangian with its holonomic and its nonholonomic constraints."""
    from canon.mechanics.lagrange.lagrangian import Lagrangian

    if isinstance(system, Lagrangian):
        return system, (), ()
    return system.lagrangian, system.holonomic, system.nonholonomic


def lagrangian_motion(
    system: Lagrangian | ConstrainedLagrangian, start: Mapping[Symbol, float]
) -> FirstOrderMotion:
    """Return the first-order equations of a Lagrangian with its forces and constraints.

    Parameters
    ----------
    system
        The Lagrangian, or the Lagrangian with its constraints.
    start
        Numbers for q, q̇, t and the parameters at the start: pivots and α are chosen there, and constraints that
        depend on others there are left out, their multipliers being 0.

    Raises
    ------
    ValueError
        The accelerations are not determined at the start.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> x = coordinates("x")
    >>> damped = Lagrangian(x.dot**2 / 2 - x**2 / 2, [x], forces=[-x.dot / 10])
    >>> motion = lagrangian_motion(damped, {x: 1.0, x.dot: 0.0})
    >>> [motion.graph.to_sympy(node) for node in motion.rates], motion.graph.to_sympy(motion.power)
    ([x_dot, -x - x_dot/10], -x_dot**2/10)
    """
    lagrangian, holonomic, nonholonomic = constraints_of(system)
    if not holonomic and not nonholonomic and (free := articulated_motion(lagrangian, start)) is not None:
        return free
    found = derivation_of_lagrangian(lagrangian)
    graph, q, v, t, n = found.graph, found.q, found.velocities, found.t, len(found.q)
    bound, left_out = _parted(found, holonomic, nonholonomic, start)
    matrix, right = _bordered(found, bound)
    where = "the mass matrix" if bound is None else "the matrix of masses and constraints"
    values = values_at_start(graph, [node for row in matrix for node in row], start, where)
    try:
        solved = solved_from_start(graph, matrix, right, values.reshape(len(matrix), -1))
    except SingularAtStartError as singular:
        raise ValueError(undetermined(singular, v, where)) from None
    accelerations, kept = solved[:n], tuple(map(graph.negative, solved[n:]))
    if bound is not None:
        alpha = graph.number(
            Fraction(rate_of_pull(graph, (*q, *v), (*map(graph.symbol, v), *accelerations), start))
        )
        solved = graph.substitute(solved, {graph.symbol(_PULL): alpha})
        accelerations, kept = tuple(solved[:n]), tuple(map(graph.negative, solved[n:]))
    L, speeds = graph.from_sympy(lagrangian.L), [graph.symbol(s) for s in v]
    momenta = graph.gradient(L, v)
    Q = [graph.from_sympy(force) for force in lagrangian.forces] or [graph.zero] * n
    A, rests = (bound.A, bound.rests) if bound is not None else ((), ())
    power = (_dot(graph, Q, speeds), *map(graph.negative, (_dot(graph, kept, rests), graph.derivative(L, t))))
    multipliers = _with_gaps(graph, kept, [index for index, _ in left_out])
    named = dict(zip((acceleration(s) for s in q), accelerations, strict=True))
    named |= dict(zip((momentum(s) for s in q), momenta, strict=True))
    named |= {multiplier_symbol(i): node for i, node in enumerate(multipliers, 1)}
    named = {s: node for s, node in named.items() if s not in start}  # a parameter keeps its name
    return FirstOrderMotion(
        kind="constrained Lagrangian" if multipliers else "Lagrangian",
        graph=graph,
        q=q,
        second=v,
        letter="v",
        t=t,
        rates=(*speeds, *accelerations),
        energy=graph.add((_dot(graph, speeds, momenta), graph.negative(L))),
        power=graph.add(power),
        named=named,
        multipliers=multipliers,
        reactions=tuple(_dot(graph, kept, [row[i] for row in A]) for i in range(n)) if multipliers else (),
        masses=lambda: tuple(map(tuple, matrix)),
        residuals=(
            *_residuals(graph, bound, speeds),
            *(replace(r, left_out=True) for _, more in left_out for r in _residuals(graph, more, speeds)),
        ),
        holds_from=functools.partial(_pivots_hold, found) if bound is None else from_no_other_start,
    )


def _pivots_hold(found: SecondOrderEquations, start: Mapping[Symbol, float]) -> bool:
    """Tell whether elimination without exchanges of rows solves M q̈ = f from a start."""
    n = len(found.q)
    nodes = [found.M[max(i, j)][min(i, j)] for i in range(n) for j in range(n)]
    values = values_at_start(found.graph, nodes, start, "the mass matrix")
    return pivots_hold(values.reshape(n, n), found.velocities, range(n))


def values_at_start(graph: Graph, nodes: Sequence[int], start: Mapping[Symbol, float], what: str) -> Array:
    """Return the values of nodes at the start as doubles.

    Raises
    ------
    ValueError
        One of them is not finite there.
    """
    point = {**start, _PULL: 0.0}
    found = np.array([float(x) for x in graph.evaluate(nodes, point)])
    refuse_infinite(found, what)
    return found


def _parted(
    found: SecondOrderEquations,
    holonomic: Sequence[Expr],
    nonholonomic: Sequence[Expr],
    start: Mapping[Symbol, float],
) -> tuple[ConstrainedEquations | None, list[tuple[int, ConstrainedEquations]]]:
    """Return the constraints that are independent at the start, and the numbers and equations of the others."""
    given = [*((f, True) for f in holonomic), *((g, False) for g in nonholonomic)]
    if not given:
        return None, []

    def one(f: Expr, *, is_holonomic: bool) -> ConstrainedEquations:
        return constrained(found, *((f,), ()) if is_holonomic else ((), (f,)))

    each = [one(f, is_holonomic=is_holonomic) for f, is_holonomic in given]
    rows = np.array(
        [values_at_start(found.graph, c.A[0], start, f"constraint {i}") for i, c in enumerate(each, 1)]
    )
    kept = independent_rows(rows)
    if len(kept) == len(given):
        return constrained(found, holonomic, nonholonomic), []
    if not kept:
        which = " and ".join(f"{f} = 0" for f, _ in given)
        raise ValueError(
            f"at the start {which} restricts no velocity, as its gradient vanishes there: write (…)**2 = 0 as … = 0, "
            "and start where the constraints have gradients"
        )
    chosen = ([given[i][0] for i in kept if given[i][1] == wanted] for wanted in (True, False))
    return constrained(found, *chosen), [(i, each[i]) for i in range(len(given)) if i not in kept]


def _bordered(
    found: SecondOrderEquations, bound: ConstrainedEquations | None
) -> tuple[list[list[int]], list[int]]:
    """Return ((M, Aᵀ), (A, 0)) and (f, −γ − 2α ġ − α² f), whose solution is (q̈, −λ)."""
    graph, n = found.graph, len(found.q)
    M = [[found.M[max(i, j)][min(i, j)] for j in range(n)] for i in range(n)]
    if bound is None:
        return M, list(found.f)
    k, alpha = len(bound.A), graph.symbol(_PULL)
    matrix = [[*row, *(a[i] for a in bound.A)] for i, row in enumerate(M)]
    matrix += [[*a, *[graph.zero] * k] for a in bound.A]
    speeds, right = [graph.symbol(s) for s in found.velocities], list(found.f)
    for i, curvature in enumerate(bound.curvatures):
        rate = graph.add((_dot(graph, bound.A[i], speeds), bound.rests[i]))
        terms = [curvature, graph.mul((graph.number(2), alpha, rate))]
        if i < len(bound.values):
            terms.append(graph.mul((alpha, alpha, bound.values[i])))
        right.append(graph.negative(graph.add(terms)))
    return matrix, right


def rate_of_pull(
    graph: Graph, state: Sequence[Symbol], rates: Sequence[int], start: Mapping[Symbol, float]
) -> float:
    """Return α: the largest rate of the motion's linearisation at the start, or a slow one of the span.

    It is negative where time runs back: what dies out forwards would grow.
    """
    slopes = [graph.gradient(rate, state) for rate in rates]
    point = {**start, _PULL: 0.0}
    jacobian = np.array([[float(x) for x in graph.evaluate(row, point)] for row in slopes])
    fastest = float(np.abs(np.linalg.eigvals(jacobian)).max()) if np.isfinite(jacobian).all() else 0.0
    # Round-off of a double eigenvalue 0 is no rate.
    real = fastest if fastest > 1e-6 * np.sqrt(np.abs(jacobian).max(initial=0.0)) else 0.0
    span = start.get(SPAN, _IN_A_SPAN)
    return math.copysign(max(real, _IN_A_SPAN / abs(span)), span)


def _residuals(
    graph: Graph, bound: ConstrainedEquations | None, speeds: Sequence[int]
) -> tuple[Residual, ...]:
    if bound is None:
        return ()
    rates = [
        graph.add((_dot(graph, row, speeds), rest)) for row, rest in zip(bound.A, bound.rests, strict=True)
    ]
    places = tuple(Residual(node, "position") for node in bound.values)
    return (*places, *(Residual(node, "rate") for node in rates))


def _with_gaps(graph: Graph, kept: Sequence[int], gaps: Sequence[int]) -> tuple[int, ...]:
    """Return the multipliers of all constraints: 0 for those left out."""
    given = iter(kept)
    return tuple(graph.zero if i in gaps else next(given) for i in range(len(kept) + len(gaps)))


def _dot(graph: Graph, a: Sequence[int], b: Sequence[int]) -> int:
    return graph.add([graph.mul(pair) for pair in zip(a, b, strict=True)])


def with_momenta_and_forces(
    given: Any,
    motion: FirstOrderMotion,
    moving: MovingSystem,
    numbers: Mapping[str, Fraction],
    varying: Sequence[Symbol] = (),
) -> MovingSystem:
    """Return the moving system of a Lagrangian with what variational integrators take: ∂L/∂q̇ and ∂L/∂q + Q.

    Parameters
    ----------
    given
        What the user gave.
    motion, moving
        Its equations, and the same with numbers.
    numbers, varying
        The parameters' numbers by name, and those that differ from orbit to orbit.

    Raises
    ------
    NoDiscreteActionError
        It is no Lagrangian, or has constraints.
    """
    from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
    from canon.mechanics.lagrange.lagrangian import Lagrangian

    if not isinstance(given, Lagrangian | ConstrainedLagrangian) or any(constraints_of(given)[1:]):
        raise NoDiscreteActionError(
            f"GalerkinVariational is for a canon.Lagrangian without constraints and does not apply to a {motion.kind}; "
            "Taylor, DOP853, RK4 and Gauss do"
        )
    graph, q, v = motion.graph, motion.q, motion.second
    lagrangian, *_ = constraints_of(given)
    L = graph.from_sympy(lagrangian.L)
    forces = [graph.from_sympy(force) for force in lagrangian.forces] or [graph.zero] * len(q)
    pushed = [graph.add(pair) for pair in zip(graph.gradient(L, q), forces, strict=True)]
    known = {graph.symbol(s): graph.number(numbers[s.name]) for s in motion.parameters if s not in varying}
    found = MomentaAndForces(tuple(graph.gradient(L, v)), tuple(pushed))
    numeric = found.with_nodes(graph.substitute(found.nodes, known))
    return replace(moving, equations=replace(moving.equations, lagrangian=numeric))
