"""Growth tests on block means: is there a slope, does the level wander, and with which power of time?

Every estimate weighs the increments of the block means with a covariance that allows for a random walk,
because a straight line fitted to a random walk by least squares is "significant" most of the time
(Durlauf & Phillips, Econometrica 56, 1333 (1988), doi:10.2307/1913101). How much walk there is beside the
scatter is not known: the slope is averaged over it, with half of the prior weight on nothing but walk.
Newey–West errors are the usual alternative; they need a bandwidth, and are too small by an unbounded
factor for a walk.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from canon.study.energy_drift.block_means import PLACES, WIDTH, bump, window_starts
from canon.study.energy_drift.noise_models import (
    Fit,
    NoiseFamily,
    fit,
    fractional,
    local_level,
    returning,
    wandering,
)
from canon.study.energy_drift.student_t import student_tail

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.array import Array

__all__ = [
    "Exponent",
    "MeanReversion",
    "RandomWalk",
    "Slope",
    "power_of_time",
    "power_of_wandering",
    "return_of",
    "slope_of",
    "walk_of",
]

PURE_WALK_WEIGHT = 0.5
"""Prior weight of "nothing but walk"; the other half is spread evenly over the logarithm of the ratio."""

WALK_DROP = 2.1
"""Half of the 95 % quantile of a likelihood ratio with one parameter and about 30 degrees of freedom."""

POWER_DROP = 3.2
"""The same for a power of time: larger, because the ratio of walk to scatter is estimated from the same windows."""

DETECTED = 0.95
"""Probability with which a slope as large as the detection limit is found."""


@dataclass(frozen=True)
class Slope:
    """A slope per block, its standard error, and how probable one as large is without any drift."""

    value: float
    error: float
    probability: float
    detection_limit: float


@dataclass(frozen=True)
class RandomWalk:
    """Twice the log-likelihood ratio for a walk, and the root-mean-square distance it covers over the run."""

    evidence: float
    size: float


@dataclass(frozen=True)
class MeanReversion:
    """Twice the log-likelihood ratio for a return of the level to its mean, and the memory in blocks."""

    evidence: float
    memory: float


@dataclass(frozen=True)
class Exponent:
    """An exponent and its 95 % confidence interval."""

    value: float
    low: float
    high: float


def slope_of(means: Array, false_alarm: float) -> Slope:
    """Return the slope per block of block means that scatter, wander, or both.

    The probability is twice the two-sided one of the mixture. With that factor no ratio of walk to scatter
    gives more than 1.3 times as many false alarms as claimed at the level of 1 %
    (benchmarks/drift_calibration.py).

    Parameters
    ----------
    means
        Block means, shape (blocks,).
    false_alarm
        Probability of a slope below which one is said to be there; sets the detection limit.
    """
    family = local_level(means.size)
    found = _fit(means, family)
    posterior = _prior(family) * np.exp(found.log_likelihood - found.log_likelihood.max())
    posterior /= posterior.sum()
    value = float(posterior @ found.slope)
    widening = found.freedom / (found.freedom - 2.0)
    error = float(np.sqrt(posterior @ (widening * found.slope_error**2 + (found.slope - value) ** 2)))
    sigmas = found.slope / found.slope_error
    against = float(min(posterior @ student_tail(found.freedom, side) for side in (sigmas, -sigmas)))
    return Slope(value, error, min(1.0, 4.0 * against), _limit(found, posterior, false_alarm))


def _limit(found: Fit, posterior: Array, false_alarm: float) -> float:
    """Return the slope that would be found with 95 % probability: the threshold and the scatter around it."""
    widest = float(found.slope_error.max())

    def exceeded(sigmas: float) -> float:
        return float(posterior @ student_tail(found.freedom, sigmas * widest / found.slope_error))

    return widest * (_place_of(exceeded, false_alarm / 4.0) + _place_of(exceeded, 1.0 - DETECTED))


def _place_of(falling: Callable[[float], float], value: float) -> float:
    """Return where a falling function that is ½ at 0 has a value below that, by false position.

    An end that stays twice is given half its weight (M. Dowell, P. Jarratt, BIT 11 (1971) 168,
    doi:10.1007/BF01934364): fewer looks than halving takes.
    """
    low, above, high = 0.0, 0.5 - value, 1.0
    while (below := falling(high) - value) > 0.0 and high < _MOST_SIGMAS:
        low, above, high = high, below, 2.0 * high
    middle, stayed = high, 0
    while high - low > _FINE * high and below < 0.0 < above:
        middle = low + (high - low) * above / (above - below)
        rest = falling(middle) - value
        if abs(rest) <= _FINE * value:
            return middle
        if rest > 0.0:
            low, above, below, stayed = middle, rest, below / (2.0 if stayed > 0 else 1.0), 1
        else:
            high, below, above, stayed = middle, rest, above / (2.0 if stayed < 0 else 1.0), -1
    return middle


_MOST_SIGMAS, _FINE = 1e3, 1e-10


def walk_of(means: Array) -> RandomWalk:
    """Return the evidence that the level of block means walks at random, beside scatter and a slope.

    Restricted likelihood ratio of the local level model against no walk. Without a walk the evidence follows
    half a χ² of one degree of freedom: it exceeds 5.4 once in a hundred series.
    """
    family = local_level(means.size)
    found = _fit(means, family)
    best = int(found.log_likelihood.argmax())
    evidence = 2.0 * float(found.log_likelihood[best] - found.log_likelihood[0])
    share = 1.0 if np.isinf(family.ratio[best]) else family.ratio[best]
    return RandomWalk(evidence, float(np.sqrt(found.scale[best] * share * (means.size + WIDTH))))


def return_of(means: Array) -> MeanReversion:
    """Return the evidence that the level of block means comes back to its mean instead of walking away.

    Restricted likelihood ratio of a walk with a memory (Ornstein & Uhlenbeck's process) against the random
    walk, both beside scatter and a slope.
    """
    family = returning(means.size)
    found = _fit(means, family)
    walks = np.isinf(family.exponent)
    best = int(np.where(walks, -np.inf, found.log_likelihood).argmax())
    evidence = 2.0 * float(found.log_likelihood[best] - found.log_likelihood[walks].max())
    return MeanReversion(evidence, float(family.exponent[best]))


def power_of_wandering(means: Array, beside_scatter: bool) -> Exponent:
    """Return the exponent H of a level that wanders as t^H, a slope removed.

    Parameters
    ----------
    means
        Block means.
    beside_scatter
        Whether independent scatter comes on top. Without it H may be negative, near −½ for block means
        that only scatter.
    """
    family = (wandering if beside_scatter else fractional)(means.size)
    found = _fit(means, family)
    exponents = np.unique(family.exponent)
    return _interval(exponents, found.log_likelihood.reshape(exponents.size, -1).max(axis=1), WALK_DROP)


def power_of_time(means: Array) -> Exponent:
    """Return the exponent γ of block means that follow a + c t^γ beside scatter and walk, 0.2 ≤ γ ≤ 8."""
    family = local_level(means.size)
    exponents, x = _powers(means.size)
    y = family.whitened(np.diff(means))[:, :, None]
    slope = np.sum(x * y, axis=1) / np.sum(x * x, axis=1)
    squares = np.sum((y - slope[:, None, :] * x) ** 2, axis=1)
    scale = squares / (means.size - 2) + _floor(means)
    likelihood = -0.5 * (family.log_determinant[:, None] + means.size * np.log(scale))
    return _interval(exponents, likelihood.max(axis=0), POWER_DROP)


def _prior(family: NoiseFamily) -> Array:
    """Return the prior weight of each ratio of walk to scatter of a local level model."""
    prior = np.full(family.ratio.size, (1.0 - PURE_WALK_WEIGHT) / (family.ratio.size - 1))
    prior[-1] = PURE_WALK_WEIGHT
    return prior


def _fit(means: Array, family: NoiseFamily) -> Fit:
    """Return the fit of a slope of one per block."""
    return fit(np.diff(means), family, _floor(means))


@lru_cache(maxsize=4)
def _powers(windows: int) -> tuple[Array, Array]:
    """Return exponents γ, and the increments of the window means of t^γ as each member of the family whitens them."""
    exponents = np.linspace(0.2, 8.0, 391)
    place = (np.arange(64) + 0.5) / 64
    weight = bump(place) / bump(place).sum()
    t = (window_starts(windows)[:, None] / PLACES + WIDTH * place) / (windows + WIDTH)
    increments = np.diff((t[None] ** exponents[:, None, None]) @ weight, axis=1)
    return exponents, local_level(windows).whitened(increments.T)


def _interval(exponents: Array, log_likelihood: Array, drop: float) -> Exponent:
    """Return the best exponent of a grid and its interval, never finer than the grid."""
    finer = np.linspace(exponents[0], exponents[-1], 2001)
    profile = np.interp(finer, exponents, log_likelihood)
    inside = finer[profile >= profile.max() - drop]
    best, step = float(exponents[log_likelihood.argmax()]), float(exponents[1] - exponents[0])
    return Exponent(best, min(float(inside[0]), best - step), max(float(inside[-1]), best + step))


def _floor(means: Array) -> float:
    """Return the variance that the arithmetic of block means leaves in an increment."""
    return float((np.finfo(np.float64).eps * np.abs(means).max()) ** 2)
