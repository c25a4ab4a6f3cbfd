"""Equations of motion as functions of numbers: M is built entry by entry and solved by LAPACK."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from canon.expression.graph.python_source import python_function

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray
    from sympy import Symbol

    from canon.array import Array
    from canon.mechanics.at_scale.first_order import CanonicalEquations
    from canon.mechanics.at_scale.second_order import SecondOrderEquations


__all__ = [
    "acceleration_function", "energy_function", "hamilton_function", "mass_condition_function", "solved",
]  # fmt: skip

_SINGULAR = (
    "{name} is singular at this point, so the motion is not determined there; use other coordinates near it"
)

_FEW_UNITS = 2.0**-48
"""With solutions larger by 2⁴⁸ than what they are made from, less than two digits of them are right."""

_SMALLEST = 1e-290


def acceleration_function(
    equations: SecondOrderEquations, parameters: Mapping[Symbol, float]
) -> Callable[[Sequence[float], Sequence[float], float], Array]:
    """Return a function (q, q̇, t) → q̈.

    Parameters
    ----------
    equations
        Equations of motion.
    parameters
        A number for each parameter, in any consistent units.

    Raises
    ------
    KeyError
        A parameter has no number.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.mechanics.lagrange.body import Particle
    >>> from canon.mechanics.at_scale.second_order import derivation
    >>> x = coordinates("x")
    >>> m, k = parameters("m k", positive=True)
    >>> spring = derivation([Particle(m, (x,))], [x], k*x**2/2)
    >>> acceleration_function(spring, {m: 2.0, k: 8.0})([0.5], [0.0], 0.0)
    array([-2.])
    """
    constants = _numbers(equations.parameters, parameters)
    inputs = (*equations.q, *equations.velocities, equations.t, *equations.parameters)
    evaluate = python_function(equations.graph, equations.nodes, inputs)
    n = len(equations.q)
    lower = np.tril_indices(n)
    count = lower[0].size

    def accelerations(q: Sequence[float], v: Sequence[float], t: float) -> Array:
        values = evaluate((*q, *v, t, *constants))
        return _solved(values[:count], lower, n, values[count:])

    return accelerations


def hamilton_function(
    equations: CanonicalEquations, parameters: Mapping[Symbol, float]
) -> Callable[[Sequence[float], Sequence[float], float], tuple[Array, Array]]:
    """Return a function (q, p, t) → (q̇, ṗ); the parameters are those of :func:`acceleration_function`."""
    velocities, constants = _velocity_function(equations, parameters)
    inputs = (*equations.q, *equations.velocities, equations.t, *equations.parameters)
    forces = python_function(equations.graph, equations.p_dot, inputs)

    def rates(q: Sequence[float], p: Sequence[float], t: float) -> tuple[Array, Array]:
        v, _, _ = velocities(q, p, t)
        return v, np.array(forces((*q, *v, t, *constants)))

    return rates


def energy_function(
    equations: CanonicalEquations, parameters: Mapping[Symbol, float]
) -> Callable[[Sequence[float], Sequence[float], float], float]:
    """Return a function (q, p, t) → H; the parameters are those of :func:`acceleration_function`."""
    velocities, _ = _velocity_function(equations, parameters)

    def energy(q: Sequence[float], p: Sequence[float], t: float) -> float:
        v, excess, potential = velocities(q, p, t)
        return float(v @ excess / 2 + potential)

    return energy


def _velocity_function(
    equations: CanonicalEquations, parameters: Mapping[Symbol, float]
) -> tuple[
    Callable[[Sequence[float], Sequence[float], float], tuple[Array, Array, float]], tuple[float, ...]
]:
    """Return a function (q, p, t) → q̇, p − b, V − T₀, and the numbers of the parameters."""
    constants = _numbers(equations.parameters, parameters)
    evaluate = equations.at_place
    n = len(equations.q)
    lower = np.tril_indices(n)
    count = lower[0].size

    def velocities(q: Sequence[float], p: Sequence[float], t: float) -> tuple[Array, Array, float]:
        values = evaluate((*q, t, *constants))
        excess = np.asarray(p, dtype=np.float64) - np.array(values[count : count + n])
        return _solved(values[:count], lower, n, excess), excess, values[-1]

    return velocities, constants


def _solved(
    values: Sequence[float], lower: tuple[NDArray[np.intp], ...], n: int, right: Sequence[float] | Array
) -> Array:
    """Solve with the mass matrix whose lower triangle is given.

    Raises
    ------
    ArithmeticError
        It is singular, or so near to it that rounding leaves no digit of the solution.
    """
    matrix = _symmetric(values, lower, n)
    found = solved(matrix, right, "the mass matrix")
    # In units in which every M_ii is 1, a solution so much larger than the right-hand side is made of round-off.
    units = np.sqrt(abs(np.diagonal(matrix)))
    sizes = abs(np.asarray(right, dtype=np.float64)) / units
    if n > 1 and (abs(found) * units).max() * _FEW_UNITS > max(sizes.max(), _SMALLEST):
        raise ArithmeticError(_SINGULAR.format(name="the mass matrix"))
    return found


def _symmetric(values: Sequence[float], lower: tuple[NDArray[np.intp], ...], n: int) -> Array:
    matrix = np.empty((n, n))
    matrix[lower] = values
    matrix.T[lower] = values
    return matrix


def mass_condition_function(
    equations: SecondOrderEquations, parameters: Mapping[Symbol, float]
) -> Callable[[Sequence[float], Sequence[float], float], float]:
    """Return a function (q, q̇, t) → κ, the condition number of the mass matrix in the units best for it.

    Accelerations have about log₁₀ κ digits fewer than doubles have: their relative error is up to some κ 2⁻⁵². Masses
    of very different size alone do no harm, as each coordinate is measured in units in which its own M_ii is 1.

    Parameters
    ----------
    equations, parameters
        As :func:`acceleration_function` takes them.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> from canon.mechanics.at_scale.second_order import derivation_of_lagrangian
    >>> x, y = coordinates("x y")
    >>> u, v = x.dot, y.dot
    >>> free = derivation_of_lagrangian(Lagrangian(u**2 / 2 + 8 * v**2 + 3 * u * v, [x, y]))
    >>> round(mass_condition_function(free, {})([0.0, 0.0], [0.0, 0.0], 0.0), 9)
    7.0
    """
    constants = _numbers(equations.parameters, parameters)
    inputs = (*equations.q, *equations.velocities, equations.t, *equations.parameters)
    evaluate = python_function(equations.graph, equations.nodes, inputs)
    n = len(equations.q)
    lower = np.tril_indices(n)

    def condition(q: Sequence[float], v: Sequence[float], t: float) -> float:
        matrix = _symmetric(evaluate((*q, *v, t, *constants))[: lower[0].size], lower, n)
        units = np.sqrt(abs(np.diagonal(matrix)))
        if not np.isfinite(matrix).all() or not units.all():
            return float("inf")
        return float(np.linalg.cond(matrix / units / units[:, np.newaxis]))

    return condition


def solved(matrix: Array, right: Sequence[float] | Array, name: str) -> Array:
    """Solve linear equations, and say so where the matrix is singular or a number is not finite.

    Raises
    ------
    ArithmeticError
        With the name of the matrix.
    """
    try:
        found = cast("Array", np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError as singular:
        raise ArithmeticError(_SINGULAR.format(name=name)) from singular
    if not np.isfinite(found).all():
        raise ArithmeticError(
            f"the equations with {name} hold a number that is not finite at this point; take another point"
        )
    return found


def _numbers(symbols: Sequence[Symbol], parameters: Mapping[Symbol, float]) -> tuple[float, ...]:
    missing = [str(s) for s in symbols if s not in parameters]
    if missing:
        raise KeyError(f"no number for {', '.join(missing)}; give one each in parameters")
    return tuple(float(parameters[s]) for s in symbols)
