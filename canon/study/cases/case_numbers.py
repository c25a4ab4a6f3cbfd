"""Numbers kept of a finished case: the drift of its energy and of the other observables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from canon.study.energy_drift.drift import judged_series
from canon.study.energy_drift.envelope import envelope_of
from canon.study.energy_drift.error_series import series_of_parts

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.array import Array
    from canon.study.energy_drift.drift import Drift
    from canon.study.motion.observables import Observable
    from canon.study.motion.term_sizes import TermSizes

__all__ = ["judged_energy", "judged_observable"]

CURVE = 64
"""Points of the curve of |ΔE| that is kept of a run."""


def judged_energy(
    t: Array, change: Array, energy: float, run: tuple[int, str], *, relative: bool, sizes: TermSizes
) -> dict[str, Any]:
    """Return the numbers of the energy error along a run, as JSON can hold them.

    Parameters
    ----------
    t, change
        Times and H − H(start).
    energy
        H(start).
    run
        Its steps and precision: what round-off is expected of it.
    relative
        Whether H(start) is more than rounding, so that the error is relative to it.
    sizes
        Of the terms of H along the run.
    """
    series = series_of_parts(t, change, abs(energy) if relative else 1.0, run, relative=relative, sizes=sizes)
    found = judged_series(series)
    curve = envelope_of(t, series.error, CURVE)
    return {
        **_numbers(found),
        "relative": relative,
        "means": {"t": found.blocks.t.tolist(), "mean": found.blocks.mean.tolist()},
        "curve": {} if curve is None else {name: x.tolist() for name, x in curve.items()},
    }


def judged_observable(
    t: Array, change: Sequence[float], of: Observable, run: tuple[int, str], sizes: TermSizes
) -> dict[str, Any]:
    """Return the same for another observable, without curve and means."""
    series = series_of_parts(t, np.array(change), of.unit, run, relative=of.relative, sizes=sizes)
    return {**_numbers(judged_series(series)), "relative": of.relative}


def _numbers(found: Drift) -> dict[str, Any]:
    return {
        "verdict": found.verdict.value,
        "reason": found.reason,
        "bound": found.bound,
        "slope": found.slope,
        "slope_error": found.slope_error,
        "amplitude_slope": found.amplitude_slope,
        "amplitude_slope_error": found.amplitude_slope_error,
        "exponent": found.exponent,
        "exponent_interval": list(found.exponent_interval),
        "detection_limit": found.detection_limit,
        "walk": found.walk,
    }
