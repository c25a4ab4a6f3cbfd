"""Longest step that does not pass over a localised term, from its exponent's first two derivatives along the motion."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.run.compiled_nodes import compiled_nodes
from canon.flow.run.passed_terms import rate_along
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
    seen, (_, reach, _) = compiled_nodes(system, nodes), sights(2.0**-52)

    def longest(t: float, y: Array) -> float:
        value, speed, change = abs(seen.call(t, y)).reshape(3, -1)
        margin = np.maximum(value - reach, reach / 2)
        with np.errstate(all="ignore"):
            times = 2 * margin / (speed + np.sqrt(speed**2 + 2 * margin * change))
        times = times[np.isfinite(times)]
        return float(times.min()) if times.size else math.inf

    return longest
