"""Scale of a trial orbit: how large its variables, its period and its energy are, so that a search is free of units.

Coordinates and momenta are measured so that every pair has the same action, s_q s_p = A: that is a canonical change of
units, in which Hamilton's equations stay what they are and monodromy matrices stay symplectic. A pair that moves has
its swings in the ratio s_q / s_p, as a small vertical oscillation beside a large one; one that rests has the ratio of
an oscillator with its own ∂²H/∂p² and ∂²H/∂q² along the orbit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from canon.cached_property import cached_property

if TYPE_CHECKING:
    from canon.array import Array
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["OrbitScale", "orbit_scale"]

_RESTS = 1e-9
"""What swings by less than this part of its own size, or of what the largest pair swings by, may be all rounding."""


@dataclass(frozen=True, eq=False)
class OrbitScale:
    """Sizes that an orbit is measured by.

    Parameters
    ----------
    state
        Of each variable, (q, p), shape (2n,).
    period
        Of the period.

    Examples
    --------
    >>> import numpy as np
    >>> scale = OrbitScale(np.array([0.5, 4.0]), 8.0)
    >>> float(scale.action), float(scale.energy)
    (2.0, 0.25)
    """

    state: Array
    period: float

    @property
    def action(self) -> float:
        """The action s_q s_p, the same of every pair."""
        return float(self.state[0]) * float(self.state[len(self.state) // 2])

    @property
    def energy(self) -> float:
        """The action over the period."""
        return self.action / self.period

    @cached_property
    def both(self) -> Array:
        """The sizes of (q, p, T), shape (2n + 1,)."""
        return np.append(self.state, self.period)

    def bare(self, M: Array) -> Array:
        """Return a derivative of the state by the state as a pure number."""
        return M * self.state / self.state[:, np.newaxis]

    def dimensional(self, M: Array) -> Array:
        """Return the derivative in the system's own units."""
        return M * self.state[:, np.newaxis] / self.state


def orbit_scale(equations: HamiltonEquations, course: Array, shift: Array, period: float) -> OrbitScale:
    """Return the scale of a trial orbit.

    Parameters
    ----------
    equations
        The equations.
    course
        States along it, shape (2n, times).
    shift
        What angles gain in a period, which is no swing of theirs.
    period
        Its period.
    """
    n = len(course) // 2
    turned = np.outer(shift, np.linspace(0.0, 1.0, course.shape[1]))
    swings, sizes = np.ptp(course - turned, axis=1), abs(course).max(axis=1)
    swings = np.where(swings > _RESTS * sizes, swings, 0.0)
    actions = swings[:n] * swings[n:]
    moves = (actions > _RESTS**2 * actions.max(initial=0.0)) & (actions > 0)
    moves &= not equations.kicked  # a few iterates of a map show no swings
    ratios = np.divide(swings[:n], swings[n:], out=np.zeros(n), where=moves)
    if not moves.all():
        ratios = np.where(moves, ratios, _ratios_of_oscillators(equations, course, abs(period)))
    action = _largest_action(swings, ratios) or _largest_action(sizes, ratios) or 1.0
    return OrbitScale(np.sqrt(action * np.concatenate([ratios, 1 / ratios])), abs(period))


def _largest_action(sizes: Array, ratios: Array) -> float:
    n = len(ratios)
    return float(max((sizes[:n] ** 2 / ratios).max(), (sizes[n:] ** 2 * ratios).max()))


def _ratios_of_oscillators(equations: HamiltonEquations, course: Array, period: float) -> Array:
    """Return q/p of small oscillations of each pair; where it only drifts, what one brings about of the other.

    Derivatives that are not finite, as at an edge of the domain, are none.
    """
    graph, n = equations.graph, len(course) // 2
    point = dict(zip(equations.inputs, (*course, 0.0), strict=True))
    nodes = [graph.gradient(rate, (p,))[0] for rate, p in zip(equations.velocity, equations.p, strict=True)]
    nodes += [graph.gradient(rate, (q,))[0] for rate, q in zip(equations.force, equations.q, strict=True)]
    with np.errstate(all="ignore"):
        values = [abs(np.asarray(value, dtype=np.float64)) for value in graph.evaluate(nodes, point)]
        means = np.array([np.median(np.where(np.isfinite(value), value, 0.0)) for value in values])
    softness, stiffness = means[:n], means[n:]
    drifts = np.where(softness > 0, softness * period, 1.0)
    kicks = np.where(stiffness > 0, stiffness * period, 1.0)
    oscillates = (softness > 0) & (stiffness > 0)
    return np.where(oscillates, np.sqrt(drifts / kicks), np.where(softness > 0, drifts, 1 / kicks))
