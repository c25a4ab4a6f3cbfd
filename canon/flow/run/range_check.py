"""Range check of a start: units in which numbers would leave the range of doubles are refused."""

from __future__ import annotations

import functools
import math
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.graph.number_systems import FLOAT64, multiprecision
from canon.flow.method.engine import HEYOKA
from canon.kernel.llvm.double_double_functions import LARGEST_ANGLE

if TYPE_CHECKING:
    from canon.array import Array
    from canon.flow.method.method import Method
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["check_magnitudes", "is_narrow"]

_FAR = 1e100
"""Within 1/_FAR … _FAR nothing that a Hamiltonian of mechanics makes of numbers overflows or underflows."""

_SYSTEMS = 64
"""Systems of which it is kept that their parameters are ordinary numbers."""

_LOST = 1e-6
"""A force that doubles get wrong by this part has overflowed or underflowed on the way."""

_LEAST = 2.0**-1074
"""The least positive double: a rate of its size is rounded, however well it was computed."""

_LEAST_SINGLE, _SMALL_SINGLE = 2.0**-150, 2.0**-126
"""What becomes nothing in single precision, and the least number that it has to all its digits."""

_NOTHING_HAPPENS = 1e-3
"""A motion that changes by less than this part of itself in all of the time is no matter of its units."""

_RANGE = 300.0
"""Doubles reach from 10⁻³⁰⁸ to 10³⁰⁸."""


def check_magnitudes(
    system: HamiltonEquations,
    state: Array,
    rates: Array,
    span: tuple[Fraction, Fraction],
    method: Method,
    precision: str | int | None,
) -> None:
    """Make sure that doubles can hold what is computed on the way from a state to its rate of change.

    r⁻³ underflows at r = 10¹¹⁰ however large the mass is that it is multiplied with, and the motion would go
    straight on. Only the first state is looked at, and only where its numbers are far from 1.

    Parameters
    ----------
    system
        The equations.
    state, rates
        The first state and its rates of change in doubles, each of shape (2n,).
    span, method, precision
        From when to when, how, and in which numbers, of the exponents of doubles.

    Raises
    ------
    ValueError
        The equations in doubles differ from those in numbers of any size; or the coefficients of Taylor series
        leave doubles, as time is measured in units much too large or too small; or a rate is nothing in single
        precision that would come to something.
    """
    start = span[0]
    if precision == "single":
        _check_single(system, rates, abs(float(span[1] - start)))
    if precision == "double-double":
        _check_angles(system, state, start)
    point = [*state.tolist(), float(start)]
    if method.engine is HEYOKA:
        _check_series(system, point, rates, abs(float(span[1] - start)), method.order)
    ordinary = all(not x or 1 / _FAR < abs(x) < _FAR for x in (*point[:-1], *rates.tolist()))
    if ordinary and _has_ordinary_parameters(system):
        return
    nodes = [*system.velocity, *system.force]
    digits = multiprecision(40)
    exact = {s: digits.number(x) for s, x in zip(system.inputs, map(Fraction, point), strict=True)}
    for name, found, node in zip((*system.q, *system.p), rates, nodes, strict=True):
        true: Any = system.graph.evaluate([node], exact, digits)[0]
        if abs(float(found) - true) > max(_LOST * abs(true), _LEAST):
            raise ValueError(
                f"the rate of {name} at the start is {float(true):.3g}, but {float(found):.3g} in doubles: numbers on "
                "the way are beyond 1e±308. Choose units in which lengths, times and masses are nearer to 1, or "
                "precision='extended'"
            )


@functools.lru_cache(maxsize=_SYSTEMS)
def _has_ordinary_parameters(system: HamiltonEquations) -> bool:
    return all(not x or 1 / _FAR < abs(x) < _FAR for x in system.parameters.values())


def _check_single(system: HamiltonEquations, rates: Array, span: float) -> None:
    """Make sure that no rate is nothing in single precision that would come to something in all of the time."""
    for name, rate in zip((*system.q, *system.p), abs(rates).tolist(), strict=True):
        if 0 < rate < _LEAST_SINGLE and rate * span > _SMALL_SINGLE:
            raise ValueError(
                f"the rate of {name} at the start is {rate:.3g} in size, but 0 in single precision, which ends at "
                "1e-45. Choose units in which lengths, times and masses are nearer to 1, or precision='double'"
            )


def _check_angles(system: HamiltonEquations, state: Array, start: Fraction) -> None:
    nodes = system.graph.reachable((*system.velocity, *system.force))
    kinds = [system.graph.nodes[node] for node in nodes]
    angles = [each.operands[0] for each in kinds if each.kind in ("sin", "cos", "tan")]
    point = dict(zip(system.inputs, (*state.tolist(), float(start)), strict=True))
    for value in system.graph.evaluate(angles, point, FLOAT64):
        if abs(float(value)) > LARGEST_ANGLE:
            raise ValueError(
                f"an angle is {float(value):.3g} rad at the start: double-double has sines up to "
                f"{float(LARGEST_ANGLE):.2g} rad. Take whole turns off it, or Taylor() with precision='quad'"
            )


def is_narrow(precision: str | int | None) -> bool:
    """Return whether the numbers of a precision have the exponents of doubles."""
    return precision in (None, "single", "double", "compensated", "double-double")


def _check_series(
    system: HamiltonEquations, point: list[float], rates: Array, span: float, order: int
) -> None:
    speed = _speed(system, point, rates)
    slow = speed < 1 and speed * span < _NOTHING_HAPPENS
    if not speed or slow or (math.isfinite(speed) and abs(math.log10(speed)) * order <= _RANGE):
        return
    speed = min(speed, _slope_speed(system, point))
    if speed and abs(math.log10(speed)) * order > _RANGE:
        raise ValueError(
            f"the motion begins with a time scale of {1 / speed:.3g}: the coefficients of Taylor series of order "
            f"{order} are beyond 1e±308. Measure time in other units, or take precision='extended'"
        )


def _slope_speed(system: HamiltonEquations, point: list[float]) -> float:
    """Return √(|∂ṗ/∂q| |∂q̇/∂p|) and what the other slopes add; 0 where rates are constant, whose series are short.

    A ball that falls from a height of 10⁻³⁸ is quick for its size, but its series ends with t².
    """
    n, inputs, graph = len(system.q), system.inputs[:-1], system.graph
    slopes = [node for rate in (*system.velocity, *system.force) for node in graph.gradient(rate, inputs)]
    found = graph.evaluate(slopes, dict(zip(system.inputs, point, strict=True)), FLOAT64)
    sizes = abs(np.array(found, float)).reshape(2 * n, 2 * n)
    (own, to_p), (to_q, other) = (np.split(row, 2, axis=1) for row in np.split(sizes, 2))
    speed = math.sqrt(to_p.max()) * math.sqrt(to_q.max()) + own.max() + other.max()
    return speed if math.isfinite(speed) else math.inf


def _speed(system: HamiltonEquations, point: list[float], rates: Array) -> float:
    """Return √(|q̇| |ṗ| / (|q| |p|)), ω of an oscillator, or √(|q̈|/|q|) at rest; 0 where nothing moves.

    A rate of q or p alone says nothing: p changes slowly far from a bump, and quickly in parts of a p of round-off.
    """
    n, speeds = len(system.q), rates.tolist()
    # Of so few numbers lists are quicker than arrays.
    q, p = _largest(point[:n]), _largest(point[n:-1])
    velocity, force = _largest(speeds[:n]), _largest(speeds[n:])
    if not (q > 0 and force > 0):
        return 0.0
    if p > 0:
        return math.sqrt(velocity / q) * math.sqrt(force / p)
    pushed = [*point[:n], *speeds[n:], point[-1]]
    found = system.graph.evaluate(system.velocity, dict(zip(system.inputs, pushed, strict=True)), FLOAT64)
    gained = float(np.max(np.abs(np.array(found, float))))
    return math.sqrt(gained / q) if math.isfinite(gained) else 0.0


def _largest(numbers: list[float]) -> float:
    return max(map(abs, numbers))
