"""Drift verdict of a conserved quantity: bounded along a run, wandering as round-off does, or drifting."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, overload

import numpy as np

from canon.flow.trajectory import Trajectory
from canon.study.energy_drift.block_means import WIDTH, Blocks, block_means
from canon.study.energy_drift.drift_verdict import Drift, Growth
from canon.study.energy_drift.error_series import ErrorSeries, error_series
from canon.study.energy_drift.growth import (
    Exponent,
    RandomWalk,
    Slope,
    power_of_time,
    power_of_wandering,
    return_of,
    slope_of,
    walk_of,
)
from canon.study.motion.observables import ENERGY

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


__all__ = ["FEWEST", "Drift", "Growth", "drift", "judged_series"]

WINDOWS = 32
"""Windows from which slopes and walks are found."""

BLOCKS = WINDOWS + WIDTH
"""Blocks of a run."""

FINE_WINDOWS = 128
"""Windows from which the exponent of a walk is taken where the samples suffice."""

FEWEST = 256
"""Samples a series needs at least."""

WALK_EVIDENCE = 5.4
"""Evidence for a walk that series without one reach once in a hundred."""

RETURNS = 5.5
"""Evidence for a return to the mean that a random walk reaches once in a hundred."""

PERHAPS_RETURNS = 2.8
"""Evidence that it reaches in one of twenty."""

LONGEST_MEMORY = 0.125
"""Share of the run above which a memory is too long to tell a return from a walk."""

BLOW_UP = 30.0
"""Ratio of the last window to the median one (root mean square) that only growth faster than t⁴ reaches."""

UNCLEAR = "a slow oscillation, or a drift that a longer run would show"

WIDENING = 0.5
"""Share of its size by which an oscillation must widen over the run to count as growth.

Less is what slow changes of an orbit bring about, such as those of Jupiter's eccentricity.
"""

BEYOND_ROUND_OFF = 50.0
"""How far a walk may exceed the expected round-off and still be called round-off."""

BEYOND_BIAS = 10.0
"""How far an error may exceed what rounding always to one side does, and still be rounding's."""

COARSE_WINDOWS = 8
"""Windows in which the oscillation's size at the end is compared with that in the first half."""

LARGER_AT_THE_END = ((2, 1.5), (4, 1.75))
"""How many times larger than ever in the first half, and in the first quarter, the oscillation may be at the end of a
bounded series."""

UNIT_ROUND_OFF = 2.0**-53


@overload
def drift(
    t: Trajectory,
    error: None = None,
    *,
    observable: str = ENERGY,
    orbit: int | None = None,
    diverged: float = 1.0,
    false_alarm: float = 0.01,
) -> Drift: ...
@overload
def drift(
    t: ArrayLike,
    error: ArrayLike,
    *,
    roundoff: float | None = None,
    resolution: float = UNIT_ROUND_OFF,
    diverged: float = 1.0,
    false_alarm: float = 0.01,
) -> Drift: ...
def drift(
    t: Trajectory | ArrayLike,
    error: ArrayLike | None = None,
    *,
    observable: str = ENERGY,
    orbit: int | None = None,
    roundoff: float | None = None,
    resolution: float = UNIT_ROUND_OFF,
    diverged: float = 1.0,
    false_alarm: float = 0.01,
) -> Drift:
    """Judge how the relative error of a conserved quantity grows along a run.

    ``drift(motion)`` knows the steps and the precision, and with them how much rounding can do: it tells truncation
    from round-off. ``drift(t, error)`` knows the numbers only; an error that walks at random is then called wandering,
    whatever makes it walk.

    The run is cut into blocks, and the increments of weighted block means (and of the size of the
    oscillation in each block) are tested for a slope and for a random walk. The size of the oscillation
    counts as growing where it does so by half or more over the run. Assumed is that the oscillation is
    faster than about a tenth of the run; a slower one cannot be told from a drift by any means but a
    longer run.

    Parameters
    ----------
    t
        A motion that :func:`canon.flow.propagation.propagate` returned, with at least 256 states
        (it keeps 1001 where nothing else is asked for, studies about 16 a period); or as many times, strictly
        increasing, shape (times,), evenly spread (jitter welcome: samples in step with an oscillation see it as a slow
        one).
    error
        Error with its sign, such as (E(t) − E₀)/abs(E₀), shape (times,); a motion brings its own.
    observable
        Of a motion: ``"energy"``, or an observable that it followed.
    orbit
        Of a motion with many orbits: which one.
    roundoff
        Random walk expected of round-off over the whole run, such as u√n after n steps; a walk more than
        50 times larger is not called round-off. A motion brings its own.
    resolution
        Error that the arithmetic can't tell from none. A motion brings its own.
    diverged
        Error from which the quantity has lost its meaning.
    false_alarm
        Probability with which a series without a drift may be called secular.

    Raises
    ------
    ValueError
        Where the series is shorter than 256 samples, not in order of time, or holds NaN or infinity: a failed run is
        never data. Where a Hamiltonian depends on t (:func:`canon.drift_study` follows the energy less the work done
        then, as ``drift`` does of the motion of a Lagrangian), or events have changed the energy, so that its change is
        no error. Where a motion has many orbits and none is chosen, or not the one that is.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0.0, 1000.0, 5001)
    >>> oscillation = 1e-6 * np.sin(6.1 * t)
    >>> drift(t, oscillation).verdict
    <Growth.BOUNDED: 'bounded'>
    >>> found = drift(t, oscillation + 1e-10 * t)
    >>> found.verdict, round(found.slope * 1e10, 3), round(found.exponent, 1)
    (<Growth.SECULAR: 'secular'>, 1.0, 1.0)

    A motion knows more:

    >>> from canon import Hamiltonian, Splitting, coordinates, propagate
    >>> x = coordinates("x")
    >>> quartic = Hamiltonian(x.momentum**2 / 2 + x**4 / 4, [x], [x.momentum])
    >>> verlet = {"method": Splitting("verlet"), "step": 0.05}
    >>> motion = propagate(quartic, t_span=(0, 1000), y0=[1.0, 0.0], samples=4096, **verlet)
    >>> drift(motion).verdict.value, drift(motion).cause
    ('bounded', 'truncation')
    """
    if isinstance(t, Trajectory):
        return judged_series(error_series(t, observable, orbit), diverged, false_alarm)
    if error is None:
        raise ValueError(
            "drift(motion) takes a motion that propagate returned; of a series give times and errors"
        )
    return _drift(*_checked(t, error), roundoff, resolution, diverged, false_alarm)


def judged_series(series: ErrorSeries, diverged: float = 1.0, false_alarm: float = 0.01) -> Drift:
    """Judge an error series by what is known of its run; of motions, rows of drift studies and stored cases alike.

    Parameters
    ----------
    series
        The series, with what rounding would do to it.
    diverged, false_alarm
        As :func:`drift` takes them.
    """
    times, values = _checked(series.t, series.error)
    found = _drift(times, values, series.walk, series.resolution, diverged * series.size, false_alarm)
    return _of_motion(found, series) if series.way else found


def _drift(
    times: NDArray[np.float64],
    values: NDArray[np.float64],
    roundoff: float | None,
    resolution: float,
    diverged: float,
    false_alarm: float,
) -> Drift:
    span = float(times[-1] - times[0])
    bound = float(np.abs(values).max())
    blocks = block_means(times, values, WINDOWS)
    if bound <= resolution:
        return _below_resolution(blocks, bound, span, resolution)
    slope = slope_of(blocks.mean, false_alarm / 2)
    breath = slope_of(blocks.amplitude, false_alarm / 2)
    walk = walk_of(blocks.mean)
    if not (walk.evidence > WALK_EVIDENCE and walk.size > resolution):
        walk = RandomWalk(walk.evidence, 0.0)
    drifts = slope.probability < false_alarm / 2 and abs(slope.value) * BLOCKS > resolution
    change = breath.value * BLOCKS / max(float(np.median(blocks.amplitude)), resolution)
    widens = breath.probability < false_alarm / 2 and change > WIDENING
    if _blew_up(blocks, bound, diverged):
        verdict, exponent, reason = _diverged(blocks, bound, diverged)
    elif drifts or widens:
        verdict, exponent, reason = _secular(blocks, slope, breath, drifts, widens)
    elif walk.size:
        verdict, exponent, reason = _wandering(times, values, blocks, walk, roundoff)
        walk = RandomWalk(walk.evidence, 0.0) if verdict is Growth.BOUNDED else walk
    else:
        verdict, exponent, reason = _bounded(times, values, blocks)
    return Drift(
        bound=bound,
        slope=slope.value / blocks.span,
        slope_error=slope.error / blocks.span,
        amplitude_slope=breath.value / blocks.span,
        amplitude_slope_error=breath.error / blocks.span,
        exponent=exponent.value,
        exponent_interval=(exponent.low, exponent.high),
        detection_limit=max(slope.detection_limit / blocks.span, resolution / span),
        verdict=verdict,
        walk=walk.size,
        span=span,
        reason=reason,
        blocks=blocks,
    )


def _checked(t: ArrayLike, error: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    if np.iscomplexobj(t) or np.iscomplexobj(error):
        raise ValueError(
            "times and errors should be real: give the real part, or the modulus, of a complex series"
        )
    times = np.asarray(t, dtype=np.float64)
    values = np.asarray(error, dtype=np.float64)
    if times.ndim != 1 or times.shape != values.shape:
        raise ValueError(
            f"times and errors must be two series of one length, not shapes {times.shape}, {values.shape}"
        )
    if times.size < FEWEST:
        raise ValueError(
            f"{times.size} samples are too few to judge growth: sample the run at least {FEWEST} times"
        )
    wrong = np.flatnonzero(~(np.isfinite(times) & np.isfinite(values)))
    if wrong.size:
        raise ValueError(
            f"the series is not finite at sample {wrong[0]} (t = {times[wrong[0]]:.6g}): the run failed "
            "there, and a failed run is no data; cut it before that time or run again with a smaller step"
        )
    if not np.all(np.diff(times) > 0.0):
        raise ValueError("the times must increase strictly; reverse the series of a backward run, or use −t")
    return times, values


def _below_resolution(blocks: Blocks, bound: float, span: float, resolution: float) -> Drift:
    return Drift(
        bound=bound,
        slope=0.0,
        slope_error=resolution / span,
        amplitude_slope=0.0,
        amplitude_slope_error=resolution / span,
        exponent=0.0,
        exponent_interval=(0.0, 1.0),
        detection_limit=resolution / span,
        verdict=Growth.BOUNDED,
        walk=0.0,
        span=span,
        reason=f"the error never exceeds {resolution:.2g}, which the arithmetic can't tell from none",
        blocks=blocks,
    )


def _blew_up(blocks: Blocks, bound: float, diverged: float) -> bool:
    size = np.hypot(blocks.mean, blocks.amplitude)
    return bound >= diverged or bool(size[-1] > BLOW_UP * np.median(size))


def _diverged(blocks: Blocks, bound: float, diverged: float) -> tuple[Growth, Exponent, str]:
    exponent = power_of_time(np.hypot(blocks.mean, blocks.amplitude))
    reason = f"the end of the run is over {BLOW_UP:.0f} times worse than its middle"
    if bound >= diverged:
        reason = f"the error reached {bound:.2g}, where the quantity has lost its meaning"
    return Growth.DIVERGED, exponent, reason


def _secular(
    blocks: Blocks, slope: Slope, breath: Slope, drifts: bool, widens: bool
) -> tuple[Growth, Exponent, str]:
    of_mean = drifts and not (widens and breath.value > abs(slope.value))
    what, found, series = (
        ("mean drifts", slope, blocks.mean) if of_mean else ("oscillation widens", breath, blocks.amplitude)
    )
    sigmas = abs(found.value) / found.error
    reason = f"the {what} by {found.value * BLOCKS:.2g} over the run, {sigmas:.3g} times its standard error"
    exponent = power_of_time(series)
    if of_mean and exponent.high < 1.0 and abs(slope.value) * BLOCKS < float(np.median(blocks.amplitude)):
        # A drift goes on; what slows down beneath an oscillation may be the arc of a slower one.
        return Growth.UNDECIDED, exponent, f"{reason}, but slows down: {UNCLEAR}"
    return Growth.SECULAR, exponent, reason


def _wandering(
    times: NDArray[np.float64],
    values: NDArray[np.float64],
    blocks: Blocks,
    walk: RandomWalk,
    roundoff: float | None,
) -> tuple[Growth, Exponent, str]:
    means = blocks.mean
    if times.size >= 16 * FINE_WINDOWS:
        means = block_means(times, values, FINE_WINDOWS).mean
    exponent = power_of_wandering(means, beside_scatter=True)
    back = return_of(means)
    if back.evidence > RETURNS and back.memory < LONGEST_MEMORY * means.size:
        memory = back.memory * blocks.span * (WINDOWS + WIDTH) / (means.size + WIDTH)
        return Growth.BOUNDED, exponent, f"the mean wanders, but returns within a time of about {memory:.2g}"
    found = f"the mean wanders by {walk.size:.2g} over the run"
    like_a_walk = exponent.low <= 0.5 <= exponent.high
    if roundoff is not None and walk.size <= BEYOND_ROUND_OFF * roundoff:
        # Rounding is known to be there: that it returns would need more evidence than one walk in twenty gives.
        if like_a_walk:
            return Growth.ROUND_OFF, exponent, f"{found}, as round-off of {roundoff:.2g} does"
        found += ", no more than round-off but not as t^½"
    elif roundoff is not None and like_a_walk:
        found += f" as a random walk does, far beyond the {roundoff:.2g} of round-off"
        return Growth.WANDERING, exponent, f"{found}: truncation, whose bound a longer run would show"
    elif roundoff is not None:
        found += f", far beyond the {roundoff:.2g} of round-off"
    elif back.evidence > PERHAPS_RETURNS:
        found += ", and perhaps returns"
    elif like_a_walk:
        found += (
            ", as a random walk does: of round-off or of truncation, which drift(motion) or roundoff= tells"
        )
        return Growth.WANDERING, exponent, found
    else:
        found += ", without a direction but not as t^½"
    return Growth.UNDECIDED, exponent, f"{found}: {UNCLEAR}"


def _bounded(
    times: NDArray[np.float64], values: NDArray[np.float64], blocks: Blocks
) -> tuple[Growth, Exponent, str]:
    found = power_of_wandering(blocks.mean, beside_scatter=False)
    exponent = Exponent(max(0.0, found.value), max(0.0, found.low), max(0.0, found.high))
    for windows in (blocks, block_means(times, values, COARSE_WINDOWS)):
        for part, most in LARGER_AT_THE_END:
            if (ratio := _end_over_start(windows, part)) > most:
                where = "half" if part == 2 else "quarter"
                reason = (
                    f"the oscillation at the end is {ratio:.2g} times as large as ever in the first {where}"
                )
                return Growth.UNDECIDED, exponent, f"{reason}: it widens, or is slowly modulated"
    return Growth.BOUNDED, exponent, "no growth above the detection limit"


def _end_over_start(blocks: Blocks, part: int) -> float:
    """Return how many times larger the oscillation is in the last tenth than ever in the first part."""
    size = blocks.amplitude
    early, late = size[: size.size // part].max(), np.median(size[-max(1, size.size // 10) :])
    return float(late / early) if early > 0.0 else 1.0


def _of_motion(found: Drift, series: ErrorSeries) -> Drift:
    """Return what was found of a motion's error with what it comes from.

    Rounding at random walks like √n, rounding always to one side drifts like n; what is beyond both is truncation. A
    drift between the two may be either.
    """
    if series.walk is None:
        return replace(found, bound=series.largest, way=series.way)
    cause, reason = "", found.reason
    reach = BEYOND_ROUND_OFF * series.walk
    if found.verdict is Growth.SECULAR and not series.truncated:
        reach = max(reach, BEYOND_BIAS * series.bias)
    if found.verdict is Growth.ROUND_OFF:
        cause = "round-off"
    elif series.largest > reach:
        cause = "truncation"
    elif found.verdict is Growth.SECULAR:
        reason += f"; rounding to one side may do {series.bias:.2g}: a run with half the step tells it from truncation"
    return replace(found, bound=series.largest, cause=cause, reason=reason, way=series.way)
