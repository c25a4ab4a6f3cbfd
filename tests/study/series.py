"""Synthetic error series of known kinds, over a run of 1000 units of time sampled 4096 times."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Callable

Array = NDArray[np.float64]
Random = np.random.Generator

SAMPLES = 4096
SPAN = 1000.0
TIMES = np.linspace(0.0, SPAN, SAMPLES + 1)
SHARE = TIMES / SPAN


def oscillation(random: Random, lines: int = 3, slowest: float = 60.0) -> Array:
    """A sum of sines of 60 to 1500 turns in the run, amplitudes 0.3 to 1."""
    turns = random.uniform(slowest, 1500.0, lines)
    phase = random.uniform(0.0, 2.0 * np.pi, lines)
    size = random.uniform(0.3, 1.0, lines)
    return size @ np.sin(2.0 * np.pi * np.outer(turns, SHARE) + phase[:, None])


def walk(random: Random) -> Array:
    """A random walk that covers a root-mean-square distance of one in the run."""
    return np.cumsum(random.normal(size=SAMPLES + 1)) / np.sqrt(SAMPLES)


def noise(random: Random) -> Array:
    return random.normal(size=SAMPLES + 1)


def pericentre(random: Random) -> Array:
    """Peaks as an eccentric orbit makes them."""
    turns, phase = random.uniform(80.0, 300.0), random.uniform(0.0, 2.0 * np.pi)
    return (1.2 + np.cos(2.0 * np.pi * turns * SHARE + phase)) ** -3


def beat(random: Random) -> Array:
    turns = random.uniform(100.0, 1000.0)
    other = turns + random.uniform(10.0, 30.0)
    return np.sin(2.0 * np.pi * turns * SHARE) + np.sin(
        2.0 * np.pi * other * SHARE + random.uniform(0.0, 6.0)
    )


def short_memory(random: Random) -> Array:
    """Noise with a memory of 1/200 of the run, as a bounded chaotic orbit makes it."""
    weight = np.exp(-np.arange(400) / 20.0)
    return np.convolve(random.normal(size=SAMPLES + 400), weight, mode="valid")[: SAMPLES + 1]


def remembering(random: Random, share: float) -> Array:
    """Noise with a memory of that share of the run, of variance about one."""
    memory = share * SAMPLES
    weight = np.exp(-np.arange(int(15.0 * memory)) / memory)
    drawn = random.normal(size=SAMPLES + weight.size)
    return np.convolve(drawn, weight, mode="valid") * np.sqrt(2.0 / memory)


BOUNDED: dict[str, Callable[[Random], Array]] = {
    "one line": lambda random: 1e-6 * oscillation(random, lines=1),
    "five lines": lambda random: 1e-6 * oscillation(random, lines=5),
    "beat": lambda random: 1e-6 * beat(random),
    "pericentre": lambda random: 1e-6 * pericentre(random),
    "white noise": lambda random: 1e-6 * noise(random),
    "short memory": lambda random: 1e-6 * short_memory(random),
}

ROUND_OFF: dict[str, Callable[[Random], Array]] = {
    "walk": lambda random: 1e-13 * walk(random),
    "walk under oscillation": lambda random: 1e-13 * walk(random) + 1e-11 * oscillation(random),
}

SECULAR: dict[str, tuple[float, Callable[[Random], Array]]] = {
    "drift under oscillation": (1.0, lambda random: 1e-6 * oscillation(random) + 1e-7 * SHARE),
    "drift with walk": (1.0, lambda random: 1e-13 * walk(random) + 20e-13 * SHARE),
    "quadratic": (2.0, lambda random: 1e-6 * oscillation(random) + 1e-6 * SHARE**2),
    "widening oscillation": (1.0, lambda random: 1e-6 * oscillation(random, lines=1) * SHARE),
}
"""The growth exponent, and the series."""
