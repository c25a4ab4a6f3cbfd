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

_MOST_NUMBERS = 20_000_000
_NUMBERS_A_NODE = 40
"""What is evaluated together, and how many numbers a divisor with its slope and bend takes at each sample."""


def may_have_passed(system: HamiltonEquations, samples: Samples, step: float) -> bool:
    """Return whether steps of a size may have passed over a term that is localised in time or space.

    Parameters
    ----------
    system, samples
        The equations and their motion, states of shape (2n, times, orbits).
    step
        The size of the steps, negative where the motion runs back.
    """
    step = abs(step)
    exponents = exponents_of(system.graph, system.rates)
    if any(not (abs(x) <= sights(2.0**-52)[1]).all() for x in _along(system, samples, exponents)):
        return True
    nodes = list(denominators_of(system.graph, system.rates))
    together = max(1, _MOST_NUMBERS // (_NUMBERS_A_NODE * max(1, samples.y[0].size)))
    return any(
        _any_passes(system, samples, nodes[i : i + together], step) for i in range(0, len(nodes), together)
    )


def _any_passes(system: HamiltonEquations, samples: Samples, nodes: Sequence[int], step: float) -> bool:
    """Return whether a divisor D may have been small between steps, by D, D′ and D″ along the motion at the samples.

    D + D′τ + D″τ²/2 is exact for 1 + ((t − t₀)/w)², as for a straight way past 1 + ((x − x₀)/w)². It is least at
    τ = −D′/D″, and twice as large √(2 D/D″) beside that. All are evaluated together, since their bends share the
    forces: 200 bodies have 19 900 divisors.
    """
    speeds = [rate_along(system, node) for node in nodes]
    bends = [rate_along(system, speed) for speed in speeds]
    found = _along(system, samples, (*nodes, *speeds, *bends))
    n = len(nodes)
    return any(
        _passes(samples, value, slope, bend, step)
        for value, slope, bend in zip(found[:n], found[n : 2 * n], found[2 * n :], strict=True)
    )


def _passes(
    samples: Samples,
    value: npt.NDArray[Any],
    slope: npt.NDArray[Any],
    bend: npt.NDArray[Any],
    step: float,
) -> bool:
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
    there = graph.symbols(node)
    rates = (*system.velocity, *system.force, graph.one)
    known = {s: rate for s, rate in zip(system.inputs, rates, strict=True) if s in there}
    slopes = graph.gradient(node, tuple(known))
    return graph.add([graph.mul([a, b]) for a, b in zip(slopes, known.values(), strict=True)])
