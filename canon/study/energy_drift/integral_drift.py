"""Drift of formal integrals along orbits: how far a series is from being constant, and with which power of the size."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.method.adaptive_methods import Taylor
from canon.flow.propagation import propagate

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from canon.mechanics.perturbation.gustavson import FormalIntegral

__all__ = ["IntegralDrift", "integral_drift"]

ROUNDING = 100 * np.finfo(float).eps
"""What rounding may do to an integral along an orbit, relative to its size; smaller drifts are not fitted."""


@dataclass(frozen=True)
class IntegralDrift:
    """How much a formal integral changed along orbits of several sizes.

    Parameters
    ----------
    radii
        The distances of the starts from the equilibrium.
    drifts
        The largest ``|I(t) − I(0)|`` along each orbit.
    expected
        The power of the radius that theory says, the degree at which {I, H} begins.
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
    seen = tuple(drift > floor for drift, floor in zip(drifts, floors, strict=True))
    chosen = np.array(seen)
    slope: float | None = None
    if chosen.sum() > 1:
        logs = np.log(np.asarray(radii, dtype=float)[chosen]), np.log(np.array(drifts)[chosen])
        slope = float(np.polyfit(*logs, 1)[0])
    expected = min(integral.rate, default=form.order + 1)
    return IntegralDrift(tuple(map(float, radii)), tuple(drifts), expected, slope, seen)
