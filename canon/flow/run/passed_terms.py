"""Terms that steps of one size may have passed over: narrow pulses, bumps in space, divisors that nearly vanish.

Steps of half the size may pass over them again, and a companion with such steps knows as little.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from canon.kernel.program.localised_terms import denominators_of, exponents_of, sights

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from canon.flow.run.samples import Samples
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["may_have_passed", "rate_along"]

_RESOLVED = 4.0
"""A divisor that is near its least value for so many steps is seen by them."""


def may_have_passed(system: HamiltonEquations, samples: Samples, step: float) -> bool:
    """Return whether steps of a size may have passed over a term that is localised in time or space.

    Parameters
    ----------
    system, samples
        The equations and their motion, states of shape (2n, times, orbits).
    step
        The size of the steps.
    """
    exponents = exponents_of(system.graph, system.rates)
    if any(not (abs(x) <= sights(2.0**-52)[1]).all() for x in _along(system, samples, exponents)):
        return True
    return any(_passes(system, samples, node, step) for node in denominators_of(system.graph, system.rates))


def _passes(system: HamiltonEquations, samples: Samples, node: int, step: float) -> bool:
    """Return whether a divisor D may have been small between steps, by D, D′ and D″ along the motion at the samples.

    D + D′τ + D″τ²/2 is exact for 1 + ((t − t₀)/w)², as for a straight way past 1 + ((x − x₀)/w)². It is least at
    τ = −D′/D″, and twice as large √(2 D/D″) beside that.
    """
    speed = rate_along(system, node)
    value, slope, bend = _along(system, samples, (node, speed, rate_along(system, speed)))
    value, slope, bend = (x * np.sign(value) for x in (value, slope, bend))
    times = samples.t[:, np.newaxis]
    with np.errstate(all="ignore"):
        least = np.maximum(value - slope**2 / (2 * bend), 0.0)
        narrow = np.sqrt(2 * least / bend) < _RESOLVED * step
        met = times - slope / bend
    within = (met >= samples.t.min() - step) & (met <= samples.t.max() + step)
    return bool((narrow & within & (bend > 0)).any())


def _along(system: HamiltonEquations, samples: Samples, nodes: Sequence[int]) -> list[npt.NDArray[Any]]:
    point = dict(zip(system.inputs, (*samples.y, samples.t[:, np.newaxis]), strict=True))
    with np.errstate(all="ignore"):
        found = system.graph.evaluate(nodes, point)
    return [np.broadcast_to(np.asarray(x, dtype=np.float64), samples.y.shape[1:]) for x in found]


def rate_along(system: HamiltonEquations, node: int) -> int:
    """Return df/dt along the motion."""
    graph = system.graph
    slopes = graph.gradient(node, system.inputs)
    rates = (*system.velocity, *system.force, graph.one)
    return graph.add([graph.mul([a, b]) for a, b in zip(slopes, rates, strict=True)])
