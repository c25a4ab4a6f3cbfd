"""Drift of formal integrals and adiabatic invariants along orbits: how far from constant, by size or by ε."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from canon.flow.method.adaptive_methods import Taylor
from canon.flow.propagation import propagate
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.hamilton.hamiltonian import Hamiltonian

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from canon.mechanics.perturbation.gustavson import FormalIntegral
    from canon.mechanics.perturbation.secular.adiabatic_series import AdiabaticInvariant

__all__ = ["IntegralDrift", "adiabatic_drift", "integral_drift"]

ROUNDING = 100 * np.finfo(float).eps
"""What rounding may do to an integral along an orbit, relative to its size; smaller drifts are not fitted."""


@dataclass(frozen=True)
class IntegralDrift:
    """How much a formal integral changed along orbits of several sizes.

    Parameters
    ----------
    radii
        The distances of the starts from the equilibrium, or the values of ε of an adiabatic invariant.
    drifts
        The largest ``|I(t) − I(0)|`` along each orbit.
    expected
        The power that theory says, the degree at which {I, H} begins, or the power of ε with which dJ/dt does.
    slope
        The power that was found; None where fewer than two drifts are above the rounding errors.
    above_rounding
        Which drifts are.
    """

    radii: tuple[float, ...]
    drifts: tuple[float, ...]
    expected: int
    slope: float | None
    above_rounding: tuple[bool, ...]


def integral_drift(
    integral: FormalIntegral,
    direction: Sequence[float],
    radii: Sequence[float] = (0.02, 0.03, 0.045, 0.07, 0.1),
    span: float = 100.0,
    samples: int = 501,
) -> IntegralDrift:
    """Propagate orbits of several sizes with heyoka's Taylor method, and return how a formal integral drifts on them.

    A formal integral to the order N changes by a power r^(N+1) of the size of the orbit over a fixed time; one with a
    wrong coefficient changes by a lower power.

    Parameters
    ----------
    integral
        The formal integral, without parameters.
    direction
        (q, p) of the starts from the equilibrium; each is scaled to the length of a radius.
    radii
        The sizes.
    span
        The time of each run, in the system's own unit.
    samples
        At how many times the integral is read.

    Examples
    --------
    >>> import sympy as sp
    >>> from canon import Hamiltonian, birkhoff_normal_form
    >>> from canon.mechanics import formal_integral
    >>> x, y, px, py = sp.symbols("x y p_x p_y", real=True)
    >>> H = Hamiltonian((px**2 + py**2 + x**2 + 2*y**2) / 2 + x**2*y, [x, y], [px, py])
    >>> seen = integral_drift(formal_integral(birkhoff_normal_form(H, 4), [1, 0]), [1, 0.5, 0, 1])
    >>> seen.expected, abs(seen.slope - 5) < 0.2
    (5, True)
    """
    form = integral.form
    size = float(np.linalg.norm(np.asarray(direction, dtype=float)))
    if len(direction) != 2 * len(form.source.q) or not np.isfinite(size) or size == 0.0:
        raise ValueError(f"the direction should be {2 * len(form.source.q)} numbers, not all zero")
    rest = np.array([float(form.equilibrium[z]) for z in (*form.source.q, *form.source.p)])
    times = np.linspace(0.0, span, samples)
    drifts: list[float] = []
    floors: list[float] = []
    for radius in radii:
        start = rest + np.asarray(direction, dtype=float) * (radius / size)
        run: Any = propagate(form.source, (0.0, span), start, method=Taylor(), times=times)
        values: npt.NDArray[np.float64] = np.asarray(run[integral.expression], dtype=float).ravel()
        drifts.append(float(np.max(np.abs(values - values[0]))))
        floors.append(float(ROUNDING * np.max(np.abs(values))))
    expected = min(integral.rate, default=form.order + 1)
    return _fitted(radii, drifts, floors, expected)


def adiabatic_drift(
    invariant: AdiabaticInvariant,
    start: Sequence[float],
    smalls: Sequence[float] = (0.02, 0.03, 0.045, 0.07, 0.1),
    slow_span: float = 2.0,
    samples: int = 501,
) -> IntegralDrift:
    """Propagate orbits for several ε with heyoka's Taylor method, and return how an adiabatic invariant drifts on them.

    A series to εⁿ changes by a power εⁿ⁺¹ over a fixed slow time τ = ε t, as its rate εⁿ⁺¹ goes to and fro with the
    fast angles; one with a wrong coefficient changes by a lower power.

    Parameters
    ----------
    invariant
        The invariant, without parameters beside ε.
    start
        (q, p) in the order of its Hamiltonian; slow momenta as they stand there, not divided by ε.
    smalls
        The values of ε.
    slow_span
        How far ε t goes.
    samples
        At how many times the invariant is read.

    Examples
    --------
    >>> import sympy as sp
    >>> from canon import Hamiltonian
    >>> from canon.mechanics import adiabatic_invariants
    >>> theta, x, y = sp.symbols("theta x y", real=True)
    >>> I, eps = sp.symbols("I epsilon", positive=True)
    >>> H = Hamiltonian((2 + x**2) * I + (x**2 + y**2) / 2 + eps * I * x * sp.cos(theta), [theta, x], [I, y])
    >>> (found,) = adiabatic_invariants(H, theta, 1, eps, slow_q=x)
    >>> seen = adiabatic_drift(found, [0, 0.5, 1, 0.3], smalls=[0.01, 0.02, 0.04])
    >>> seen.expected, abs(seen.slope - 2) < 0.2
    (2, True)
    """
    H, eps, tau = invariant.source, invariant.small, invariant.slow_time
    slow_p = [p for q, p in zip(H.q, H.p, strict=True) if q in invariant.slow_q]
    if len(start) != 2 * len(H.q):
        raise ValueError(f"the start should be {2 * len(H.q)} numbers")
    drifts: list[float] = []
    floors: list[float] = []
    for small in map(float, smalls):
        if not 0 < small < np.inf:
            raise ValueError(f"{eps} should be positive numbers, not {small}")
        place = {eps: sp.Float(small), **{p: small * p for p in slow_p}}
        place |= {} if tau is None else {tau: small * H.t}
        moved = Hamiltonian(substitute(H.H, place), H.q, H.p, H.t)
        begin = zip((*H.q, *H.p), map(float, start), strict=True)
        first = [v / small if z in slow_p else v for z, v in begin]
        times = np.linspace(0.0, slow_span / small, samples)
        run: Any = propagate(moved, (0.0, slow_span / small), first, method=Taylor(), times=times)
        values: npt.NDArray[np.float64] = np.asarray(run[substitute(invariant.J, place)], dtype=float).ravel()
        drifts.append(float(np.max(np.abs(values - values[0]))))
        floors.append(float(ROUNDING * np.max(np.abs(values))))
    return _fitted(smalls, drifts, floors, invariant.order + 1)


def _fitted(
    sizes: Sequence[float], drifts: Sequence[float], floors: Sequence[float], expected: int
) -> IntegralDrift:
    """Return the drifts with the power of the size that those above rounding errors follow."""
    seen = tuple(drift > floor for drift, floor in zip(drifts, floors, strict=True))
    chosen = np.array(seen)
    slope: float | None = None
    if chosen.sum() > 1:
        logs = np.log(np.asarray(sizes, dtype=float)[chosen]), np.log(np.array(drifts)[chosen])
        slope = float(np.polyfit(*logs, 1)[0])
    return IntegralDrift(tuple(map(float, sizes)), tuple(drifts), expected, slope, seen)
