"""Kepler's flow and its derivative by the starting state, for many states at once.

The flow is that of :mod:`canon.kernel.solvable.kepler_flow`: with β = 2µ/r₀ − u², η = x·u, ζ = µ − βr₀ and
G_k(X) = Xᵏ c_k(βX²), c_k Stumpff's functions, X solves r₀X + ηG₂ + ζG₃ = t, whose slope is r; then
f = 1 − µG₂/r₀, g = t − µG₃, and so on. The derivative follows from
∂G_k/∂X = G_{k−1}, ∂G_k/∂β = ½(k G_{k+2} − X G_{k+1}).

Sources: H. Rein, D. Tamayo, Second-order variational equations for N-body simulations, Mon. Not. R. Astron. Soc. 459
(2016) 2275–2285, doi:10.1093/mnras/stw644; B. A. Conway, An improved algorithm due to Laguerre for the solution of
Kepler's equation, Celest. Mech. 39 (1986) 199–211, doi:10.1007/BF01230852.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from canon.array import Array

__all__ = ["kepler_derivative"]

_ITERATIONS = 100

_NEAR = 2.0**-50
"""A last step of Laguerre's method is not larger than this part of X, or the miss than this part of the terms."""

_REACH = 3.0
"""Up to this |z| Stumpff's functions are summed as power series."""

_TERMS = 16


def kepler_derivative(x: Array, u: Array, mu: float, t: float) -> tuple[Array, Array, Array]:
    """Return places and velocities after a time, and their derivative.

    Parameters
    ----------
    x, u
        Places from the centre and velocities, shape (axes, states).
    mu
        The gravitational parameter, positive.
    t
        The time, of either sign.

    Returns
    -------
    tuple
        x and u after t, and ∂(x, u)/∂(x₀, u₀), shape (2 axes, 2 axes, states).

    Raises
    ------
    ArithmeticError
        Kepler's equation was not solved: the state is not finite, or at the centre.

    Examples
    --------
    >>> x, u, M = kepler_derivative(np.array([[1.0], [0.0]]), np.array([[0.0], [1.0]]), 1.0, math.pi / 2)
    >>> np.round(np.hstack([x, u]).T, 12) + 0.0
    array([[ 0.,  1.],
           [-1.,  0.]])
    >>> bool(abs(np.linalg.det(M[:, :, 0]) - 1) < 1e-14)
    True
    """
    axes = len(x)
    r0 = np.sqrt((x * x).sum(axis=0))
    eta, beta = (x * u).sum(axis=0), 2 * mu / r0 - (u * u).sum(axis=0)
    zeta = mu - beta * r0
    anomaly = _anomaly(r0, eta, beta, zeta, mu, t)
    g = _stumpff(beta, anomaly)
    r = r0 + eta * g[1] + zeta * g[2]
    f, rise = 1 - mu * g[2] / r0, t - mu * g[3]
    fall, turn = -mu * g[1] / (r0 * r), 1 - mu * g[2] / r
    # Gradients by (x0, u0), shape (2 axes, states).
    none = np.zeros_like(x)
    d_r0 = np.concatenate([x / r0, none])
    d_eta = np.concatenate([u, x])
    d_beta = -2 * mu / r0**2 * d_r0 - 2 * np.concatenate([none, u])
    d_zeta = -r0 * d_beta - beta * d_r0
    by_beta = [(k * g[k + 2] - anomaly * g[k + 1]) / 2 for k in range(4)]
    pull = anomaly * d_r0 + g[2] * d_eta + g[3] * d_zeta + (eta * by_beta[2] + zeta * by_beta[3]) * d_beta
    d_anomaly = -pull / r
    d_g = [none, *(g[k - 1] * d_anomaly + by_beta[k] * d_beta for k in range(1, 4))]
    d_r = d_r0 + g[1] * d_eta + g[2] * d_zeta + eta * d_g[1] + zeta * d_g[2]
    d_f, d_rise = mu / r0 * (g[2] / r0 * d_r0 - d_g[2]), -mu * d_g[3]
    d_fall = mu / (r0 * r) * (g[1] * (d_r0 / r0 + d_r / r) - d_g[1])
    d_turn = mu / r * (g[2] / r * d_r - d_g[2])
    moved, turned = f * x + rise * u, fall * x + turn * u
    unit = np.eye(axes)[:, :, np.newaxis]
    rows = [
        np.concatenate([unit * a, unit * b], axis=1) + x[:, np.newaxis] * d_a + u[:, np.newaxis] * d_b
        for a, b, d_a, d_b in ((f, rise, d_f, d_rise), (fall, turn, d_fall, d_turn))
    ]
    return moved, turned, np.concatenate(rows)


def _anomaly(r0: Array, eta: Array, beta: Array, zeta: Array, mu: float, t: float) -> Array:
    """Return X by Laguerre's method for polynomials of fifth degree, which converges from everywhere.

    It begins at t/r₀ or, where that is nearer, at a bound of X, |X|³ ≤ 100 |t|/µ where e ≥ ½, or at the mean βt/µ.
    """
    far = np.where(beta * r0 <= mu / 2, np.cbrt(100 * t / mu), beta * t / mu)
    x = np.where(abs(t) / r0 < abs(far), t / r0, far)
    for _ in range(_ITERATIONS):
        g = _stumpff(beta, x)
        miss, slope = r0 * x + eta * g[2] + zeta * g[3] - t, r0 + eta * g[1] + zeta * g[2]
        bend = eta * g[0] + zeta * g[1]
        root = np.sqrt(abs(16 * slope * slope - 20 * miss * bend))
        step = 5 * miss / (slope + root)
        x = x - step
        rounding = _NEAR * (abs(r0 * x) + abs(eta * g[2]) + abs(zeta * g[3]) + abs(t))
        if ((abs(step) <= _NEAR * abs(x)) | (abs(miss) <= rounding)).all():
            return x
    raise ArithmeticError("Kepler's equation was not solved: a state is not finite, or at the centre")


def _stumpff(beta: Array, x: Array) -> list[Array]:
    """Return G₀ … G₅."""
    z = beta * x * x
    near = abs(z) <= _REACH
    small, large = np.where(near, z, 0.0), np.where(near, _REACH, z)
    series = [_series(small, k) for k in range(6)]
    root = np.sqrt(abs(large))
    with np.errstate(over="ignore"):
        waves = (
            np.where(large > 0, np.cos(root), np.cosh(root)),
            np.where(large > 0, np.sin(root), np.sinh(root)),
        )
    far = [waves[0], waves[1] / root]
    for k in range(2, 6):
        far.append((1 / math.factorial(k - 2) - far[k - 2]) / large)
    return [x**k * np.where(near, a, b) for k, (a, b) in enumerate(zip(series, far, strict=True))]


def _series(z: Array, k: int) -> Array:
    """Return c_k(z) = Σ (−z)ʲ/(2j + k)!."""
    total = np.zeros_like(z)
    for j in reversed(range(_TERMS)):
        total = total * z + (-1) ** j / math.factorial(2 * j + k)
    return total
