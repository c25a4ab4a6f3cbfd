"""Noise models of block means: covariances of an error that oscillates, wanders, or does both.

The block means of a bounded oscillation scatter independently about one value at worst (those of a quasi-
periodic one less); those of accumulated round-off are a random walk. Both at once is the local level
model of Harvey, *Forecasting, structural time series models and the Kalman filter* (1989), § 2.3; with a
walk of exponent H ≠ ½ (fractional Brownian motion) in place of the random walk the same model measures
how fast the error wanders.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.study.energy_drift.block_means import PLACES, WIDTH, bump, window_starts

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt

    from canon.array import Array

__all__ = [
    "Fit",
    "NoiseFamily",
    "fit",
    "fractional",
    "local_level",
    "returning",
    "scatter_covariance",
    "walk_covariance",
    "wandering",
]


@dataclass(frozen=True)
class NoiseFamily:
    """Covariances of the K − 1 increments of K block means, each up to a factor.

    Parameters
    ----------
    exponent
        Exponent H of the wandering part of each member, shape (members,); of a returning one its memory.
    ratio
        Its variance per block over that of the scatter about the level; ``inf`` without scatter.
    bases
        Coordinates in which the increments of all members of one exponent are independent, shape
        (exponents, K − 1, K − 1).
    basis_of
        The number of each member's, shape (members,).
    spread
        Standard deviations of these coordinates, shape (members, K − 1).
    log_determinant
        Of each covariance.
    line
        Whitened increments of a slope of one per block, shape (members, K − 1).
    """

    exponent: Array
    ratio: Array
    bases: Array
    basis_of: npt.NDArray[np.intp]
    spread: Array
    log_determinant: Array
    line: Array

    def whitened(self, increments: Array) -> Array:
        """Return increments, shape (K − 1,) or (K − 1, series), as each member sees them: independent, variance one."""
        return _whitened(self.bases, self.basis_of, self.spread, increments)


@dataclass(frozen=True)
class Fit:
    """Generalized least squares of increments = slope × distance + noise, for each member of a family.

    Parameters
    ----------
    slope, slope_error
        Estimate and standard error, shape (members,).
    scale
        Estimated factor of the member's covariance.
    log_likelihood
        Restricted (slope and factor removed).
    freedom
        Degrees of freedom of ``slope_error``.
    """

    slope: Array
    slope_error: Array
    scale: Array
    log_likelihood: Array
    freedom: int


def fit(increments: Array, family: NoiseFamily, floor: float = 0.0) -> Fit:
    """Return the fit of one slope to increments of block means, for every member of a family.

    Parameters
    ----------
    increments
        Differences of neighbouring block means, shape (K − 1,).
    family
        The covariances to try.
    floor
        Variance of an increment that arithmetic leaves even where nothing scatters.
    """
    y = family.whitened(increments)
    x = family.line
    weight = np.sum(x * x, axis=1)
    slope = np.sum(x * y, axis=1) / weight
    squares = np.sum((y - slope[:, None] * x) ** 2, axis=1)
    freedom = increments.size - 1
    scale = squares / freedom + floor
    likelihood = -0.5 * (family.log_determinant + np.log(weight) + freedom * np.log(scale))
    return Fit(slope, np.sqrt(scale / weight), scale, likelihood, freedom)


@lru_cache(maxsize=16)
def local_level(windows: int) -> NoiseFamily:
    """Return scatter about a level that walks at random, from no walk (first) to nothing but walk (last)."""
    ratios = np.concatenate([[0.0], np.geomspace(0.1 / windows**2, 30.0, 40), [np.inf]])
    return _family(np.full(ratios.size, 0.5), ratios, windows)


@lru_cache(maxsize=16)
def fractional(windows: int) -> NoiseFamily:
    """Return fractional noise alone, from H = −0.45 (nearly independent) to 0.95 (nearly a trend)."""
    exponents = np.linspace(-0.45, 0.95, 57)
    factor = np.linalg.cholesky(np.stack([walk_covariance(float(h), windows) for h in exponents]))
    spread = np.ones(factor.shape[:2])
    determinants = 2.0 * np.sum(np.log(np.diagonal(factor, axis1=1, axis2=2)), axis=1)
    ratios, each = np.full(exponents.size, np.inf), np.arange(exponents.size)
    return _made(exponents, ratios, _inverse_triangles(factor), each, spread, determinants, windows)


@lru_cache(maxsize=16)
def wandering(windows: int) -> NoiseFamily:
    """Return scatter about a level that wanders as t^H, for a grid of H (slow index) and ratios."""
    exponents = np.linspace(0.05, 0.95, 19)
    ratios = np.concatenate([np.geomspace(1.0 / windows**2, 10.0, 13), [np.inf]])
    return _family(np.repeat(exponents, ratios.size), np.tile(ratios, exponents.size), windows)


@lru_cache(maxsize=16)
def returning(windows: int) -> NoiseFamily:
    """Return scatter about a level that walks but returns, with memories from one block to the whole run (and none).

    A grid of memories in blocks (slow index; the last one, ``inf``, is the random walk) and ratios.
    """
    memories = np.concatenate([np.geomspace(1.0, windows + WIDTH, 12), [np.inf]])
    ratios = np.concatenate([np.geomspace(1.0 / windows**2, 10.0, 9), [np.inf]])
    return _family(
        np.repeat(memories, ratios.size), np.tile(ratios, memories.size), windows, returning_covariance
    )


def _family(
    exponents: Array,
    ratios: Array,
    windows: int,
    covariance: Callable[[float, int], Array] = lambda h, windows: walk_covariance(h, windows),
) -> NoiseFamily:
    """Return scatter beside walks in each of these ratios.

    Scatter C Cᵀ and the walk C U Λ Uᵀ Cᵀ are diagonal together in the coordinates Uᵀ C⁻¹: one decomposition for all
    ratios of an exponent (G. H. Golub, C. F. Van Loan, Matrix Computations, § 8.7).
    """
    own, basis_of = np.unique(exponents, return_inverse=True)
    factor = np.linalg.cholesky(scatter_covariance(windows))
    to_scatter = _inverse_triangles(factor[np.newaxis])[0]
    walks = np.stack([covariance(float(h), windows) for h in own])
    variances, axes = np.linalg.eigh(to_scatter @ walks @ to_scatter.T)
    alone = np.isinf(ratios)[:, np.newaxis]
    weights = np.where(alone, 1.0, ratios[:, np.newaxis])
    spread = np.sqrt(np.where(alone, 0.0, 1.0) + weights * variances[basis_of])
    determinants = 2.0 * (np.sum(np.log(np.diagonal(factor))) + np.sum(np.log(spread), axis=1))
    bases = np.swapaxes(axes, 1, 2) @ to_scatter
    return _made(exponents, ratios, bases, basis_of, spread, determinants, windows)


def _made(
    exponents: Array,
    ratios: Array,
    bases: Array,
    basis_of: npt.NDArray[np.intp],
    spread: Array,
    log_determinant: Array,
    windows: int,
) -> NoiseFamily:
    line = _whitened(bases, basis_of, spread, np.diff(window_starts(windows)) / PLACES)
    return NoiseFamily(exponents, ratios, bases, basis_of, spread, log_determinant, line)


def _whitened(bases: Array, basis_of: npt.NDArray[np.intp], spread: Array, increments: Array) -> Array:
    seen = (bases @ increments)[basis_of]
    return seen / (spread if increments.ndim == 1 else spread[:, :, np.newaxis])


def _inverse_triangles(lower: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return the inverses of lower triangles, shape (members, n, n), row by row of all of them at once.

    A stack of full inverses takes many times as long, and SciPy's triangular ones long to import.
    """
    found = np.zeros_like(lower)
    for k in range(lower.shape[1]):
        found[:, k, k] = 1.0
        found[:, k, :k] -= (lower[:, k : k + 1, :k] @ found[:, :k, :k])[:, 0]
        found[:, k, : k + 1] /= lower[:, k, k, np.newaxis]
    return found


def scatter_covariance(windows: int) -> Array:
    """Return the covariance of the increments of window means of white noise, the means of variance one.

    Windows overlap, so their means have the covariance r(h) / r(0), r the autocorrelation of the weights.
    """
    overlap = np.zeros(PLACES * (windows + WIDTH))
    autocorrelation = _autocorrelation()
    overlap[: WIDTH * PLACES] = autocorrelation[WIDTH * PLACES - 1 :] / autocorrelation[WIDTH * PLACES - 1]
    return _of_increments(overlap, windows)


def walk_covariance(exponent: float, windows: int) -> Array:
    """Return the covariance of the increments of window means of a walk with E|Δ|² = lag^(2H)/(2H).

    With r the autocorrelation of the weights, the means of windows h apart have covariance R(h) = −½ ∫
    r(u) |u + h|^(2H) du / 2H up to a constant. The kernel is taken as (|u|^(2H) − 1)/(2H), which
    continues through H = 0 as log|u|; cells are integrated in closed form.
    """
    reach = PLACES * (windows + WIDTH)
    edges = (np.arange(-WIDTH * PLACES, reach + 1) + 0.5) / PLACES
    kernel = np.diff(_primitive(edges, exponent)) * PLACES
    mean = -0.5 * np.convolve(kernel, _autocorrelation(), mode="valid")
    return _of_increments(mean, windows)


def returning_covariance(memory: float, windows: int) -> Array:
    """Return the covariance of the increments of window means of a walk that returns (Ornstein & Uhlenbeck's).

    Its covariance ½ m e^(−lag/m), m the memory in blocks, tends to that of the walk of unit variance per block.
    """
    if np.isinf(memory):
        return walk_covariance(0.5, windows)
    reach = PLACES * (windows + WIDTH)
    lags = np.abs(np.arange(-WIDTH * PLACES, reach) + 1.0) / PLACES
    kernel = 0.5 * memory * np.exp(-lags / memory)
    return _of_increments(np.convolve(kernel, _autocorrelation(), mode="valid"), windows)


def _of_increments(covariance_by_lag: Array, windows: int) -> Array:
    starts = window_starts(windows)
    of_means = covariance_by_lag[np.abs(np.subtract.outer(starts, starts))]
    return np.diff(np.diff(of_means, axis=0), axis=1)


@lru_cache(maxsize=1)
def _autocorrelation() -> Array:
    """Return r at lags −WIDTH … WIDTH blocks in steps of 1/PLACES, summing to one."""
    weight = bump((np.arange(WIDTH * PLACES) + 0.5) / (WIDTH * PLACES))
    weight /= weight.sum()
    return np.correlate(weight, weight, mode="full")


def _primitive(u: Array, exponent: float) -> Array:
    """Return ∫₀ᵘ (|x|^(2H) − 1)/(2H) dx."""
    double = 2.0 * exponent
    if abs(double) < 1e-9:
        return u * np.log(np.maximum(np.abs(u), np.finfo(np.float64).tiny)) - u
    return (np.sign(u) * np.abs(u) ** (double + 1.0) / (double + 1.0) - u) / double
