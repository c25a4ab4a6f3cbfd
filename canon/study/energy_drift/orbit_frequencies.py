"""Frequencies of an orbit against those of its torus: the angles that an independent integration arrives at."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, tau
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.method.adaptive_methods import Taylor
from canon.flow.request import Request
from canon.mechanics.integrable.actions import angles
from canon.mechanics.integrable.cycles import CycleKind
from canon.progress import reporting
from canon.study.motion.quiet_run import run_quietly

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt
    from sympy import Symbol

    from canon.mechanics.integrable.actions import ActionVariables

__all__ = ["OrbitFrequencies", "orbit_frequencies"]

FIRST = 0.05
"""The first time, in shortest periods: so early that no angle has gone half round."""
RATIO = 4.0
"""From one time to the next; each is told from its neighbours a turn away by the frequencies found before."""
KEPT = 1e-12
"""Relative change of the energy above which the orbit has more digits: close passes of a centre take them."""
CANDIDATES = 9
"""Samples about each time, of which one far from the turning points is taken."""


@dataclass(frozen=True)
class OrbitFrequencies:
    """The frequencies that an integrated orbit has, beside those of its torus.

    Parameters
    ----------
    expected
        ∂H/∂J of the torus.
    found
        The growth of the angles along the orbit over the time.
    span
        Over which time.
    energy_error
        The largest relative change of the energy on the way: an orbit that does not keep it is on other tori.
    """

    expected: tuple[float, ...]
    found: tuple[float, ...]
    span: float
    energy_error: float = 0.0

    @property
    def difference(self) -> float:
        """The largest difference between found and expected, relative to the largest frequency."""
        scale = max(abs(w) for w in self.expected)
        return max(abs(f - e) for f, e in zip(self.found, self.expected, strict=True)) / scale


def orbit_frequencies(
    torus: ActionVariables,
    periods: float = 200.0,
    *,
    progress: Callable[[float], None] | bool | None = None,
) -> OrbitFrequencies:
    """Propagate the start of a torus with heyoka's Taylor method, and return the frequencies of that orbit.

    The angles θ = ∂W/∂J of states along the orbit grow as ω t on the right torus. Frequencies are read from them over
    longer and longer times, without the frequencies that were expected. Where doubles do not keep the energy, as past
    a centre of force that is nearly met, the orbit has 113 bits.

    Parameters
    ----------
    torus
        What :func:`canon.mechanics.action_variables` returned.
    periods
        How many of the shortest periods the orbit runs for.
    progress
        As :func:`canon.propagate` takes it.

    Examples
    --------
    >>> import sympy as sp
    >>> from canon.mechanics import Hamiltonian, action_variables, hamilton_jacobi
    >>> q, p = sp.symbols("q p", real=True)
    >>> pendulum = hamilton_jacobi(Hamiltonian(p**2/2 - sp.cos(q), q, p))
    >>> orbit_frequencies(action_variables(pendulum, {q: 0, p: 1}, digits=17)).difference < 1e-12
    True
    """
    H = torus.integral.H
    variables = (*H.q, *H.p)
    expected = tuple(float(w) for w in torus.frequencies)
    shortest = tau / max(abs(w) for w in expected)
    centres = [0.0, *_times(shortest, periods)]
    offsets = np.linspace(0.0, FIRST / 4, CANDIDATES) * shortest
    times = np.concatenate([centre + offsets for centre in centres])
    start = np.array([float(torus.values[z]) for z in variables])
    known: dict[Symbol | str, float] = {
        s: float(v) for s, v in torus.values.items() if s in H.H.free_symbols and s not in variables
    }
    with reporting(progress) as report:
        for precision in ("double", "quad"):
            run: Any = run_quietly(
                Request(
                    H,
                    (0.0, float(times[-1])),
                    start,
                    method=Taylor(),
                    times=times,
                    parameters=known,
                    precision=precision,
                )
            )
            kept = float(np.abs(run.energy_error).max())
            if kept < KEPT:
                break
        states: npt.NDArray[np.float64] = run.y
        chosen = [
            _farthest_from_rest(torus, states, range(i * CANDIDATES, (i + 1) * CANDIDATES))
            for i in range(len(centres))
        ]
        reduced: list[npt.NDArray[np.float64]] = []
        for k in chosen:  # balls take nearly all of the time
            reduced.append(_angles(torus, variables, states[:, k]))
            report(len(reduced) / len(chosen))
    found, span = np.zeros(len(expected)), 0.0
    for k, theta in zip(chosen[1:], reduced[1:], strict=True):
        span = float(times[k] - times[chosen[0]])
        gone = theta - reduced[0]
        turns = np.round((found * span - gone) / tau)
        found = (gone + tau * turns) / span
    return OrbitFrequencies(expected, tuple(float(w) for w in found), span, kept)


def _times(shortest: float, periods: float) -> list[float]:
    if not periods > FIRST:
        raise ValueError(f"the orbit should run for more than {FIRST} periods, not {periods}")
    steps = max(1, int(np.ceil(np.log(periods / FIRST) / np.log(RATIO))))
    return [float(shortest * FIRST * (periods / FIRST) ** (k / steps)) for k in range(steps + 1)]


def _farthest_from_rest(torus: ActionVariables, states: npt.NDArray[np.float64], among: range) -> int:
    """Return the sample whose librations are farthest from their turning points, where angles are read badly."""

    def least(k: int) -> float:
        room = [1.0]
        for i, cycle in enumerate(torus.cycles):
            if cycle.turning_points is not None:
                low, high = (float(end) for end in cycle.turning_points)
                room.append((states[i, k] - low) * (high - states[i, k]) / (high - low) ** 2)
        return min(room)

    return max(among, key=least)


def _angles(
    torus: ActionVariables, variables: tuple[Symbol, ...], state: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Return the angles of a state, with rotating coordinates taken back into one period."""
    there = {z: float(x) for z, x in zip(variables, state, strict=True)}
    for cycle in torus.cycles:
        if cycle.kind is not CycleKind.LIBRATION and cycle.period is not None:
            period = float(cycle.period)
            there[cycle.q] -= period * np.floor(there[cycle.q] / period)
    return np.mod([float(theta) for theta in angles(torus, there)], 2 * pi)
