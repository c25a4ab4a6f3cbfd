"""Longest step that does not pass over a localised term, from its exponent's first two derivatives along the motion."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.run.passed_terms import rate_along
from canon.kernel.llvm.loop import field_function
from canon.kernel.program.localised_terms import exponents_of, sights

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.array import Array
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["longest_step"]


def longest_step(system: HamiltonEquations) -> Callable[[float, Array], float]:
    """Return a function of t and y: within such a step no exponent comes from beyond its term's reach to beyond it.

    An exponent g of size m above the reach gets there after 2m/(|ġ| + √(ġ² + 2 m |g̈|)) at the earliest, to second
    order; inside, steps change it by half the reach.
    """
    graph = system.graph
    exponents = exponents_of(graph, system.rates)
    if not exponents:
        return lambda _t, _y: math.inf
    speeds = [rate_along(system, node) for node in exponents]
    nodes = (*exponents, *speeds, *(rate_along(system, node) for node in speeds))
    field, (_, reach, _) = field_function(system.program(nodes)), sights(2.0**-52)
    x, out = np.empty(len(system.inputs)), np.empty(len(nodes))

    def longest(t: float, y: Array) -> float:
        x[:-1], x[-1] = y, t
        field.call(x.ctypes.data, out.ctypes.data)
        value, speed, change = abs(out).reshape(3, -1)
        margin = np.maximum(value - reach, reach / 2)
        with np.errstate(all="ignore"):
            times = 2 * margin / (speed + np.sqrt(speed**2 + 2 * margin * change))
        times = times[np.isfinite(times)]
        return float(times.min()) if times.size else math.inf

    return longest
