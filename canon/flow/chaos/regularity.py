"""Regularity of an orbit: regular, chaotic or not known yet, from how a deviation has grown, with a detection limit.

Beside a regular orbit deviations grow as a power of time, beside a chaotic one exponentially. The rule is calibrated on
orbits that are known to be the one or the other: benchmarks/chaos.py counts its false alarms and misses.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.tangent.deviation_growth import LEAST_SAMPLES

if TYPE_CHECKING:
    import numpy.typing as npt

    from canon.array import Array
    from canon.flow.tangent.deviation_growth import DeviationGrowth

__all__ = [
    "Judged",
    "Regularity",
    "judged_growth",
    "mean_megno",
    "mean_over_time",
    "megno_of",
    "of_their_systems",
    "quarters",
    "told",
]


class Regularity(enum.Enum):
    """What an orbit was found to be over the time that it was followed.

    ``LEFT`` is said of orbits among many that left the finite numbers, by escape or collision; of a single one that is
    an error. ``UNSTABLE`` are states of rest, and motions of linear systems, beside which neighbours part exponentially
    without chaos; an unstable periodic orbit has a positive exponent too, and is called chaotic here.
    """

    REGULAR = "regular"
    CHAOTIC = "chaotic"
    UNSTABLE = "unstable"
    NOT_KNOWN = "not known yet"
    LEFT = "left"


@dataclass(frozen=True)
class Judged:
    """Verdicts on orbits.

    Parameters
    ----------
    verdicts
        One for each orbit, shape (orbits,), of :class:`Regularity`.
    detection_limit
        An exponent above this one, at work over the whole run, would have been found.
    reasons
        Why, in words, one for each orbit.
    """

    verdicts: npt.NDArray[np.object_]
    detection_limit: float
    reasons: tuple[str, ...]


CHAOTIC_MEGNO, REGULAR_MEGNO = 6.0, 3.0
"""The mean MEGNO of growth as a power tᵇ is 2b: 2 where neighbours shear, up to 4 in degenerate cases. Exponential
growth gives λT/2."""

CHAOTIC_GROWTH, REGULAR_GROWTH = 4.0, 2.0
"""ln of the growth from the second quarter of the run to the last: 0.86 b of a power, λT/2 of an exponential."""


FAR_OFF = 0.05
"""Of orbits whose energy has changed by such a part nothing is said."""


def judged_growth(t: Array, log: Array) -> Judged:
    """Judge orbits by how a deviation has grown.

    Chaotic are those whose deviation grows faster than any power that regular motion makes, and goes on to do so in the
    second half of the run, so that one passage near a saddle is not taken for chaos; regular are those that show
    nothing of the kind. Both are said of the time that was run: an orbit that sticks to an island is regular while it
    does.

    Parameters
    ----------
    t
        Times since the start, shape (times,).
    log
        ln of the growth of one deviation vector, shape (times, orbits); NaN from where an orbit has left on.

    Raises
    ------
    ValueError
        There are too few times.
    """
    if len(t) <= LEAST_SAMPLES // 2:
        raise ValueError(
            f"{len(t) - 1} steps: a verdict takes at least {LEAST_SAMPLES}; give a longer span or a shorter step"
        )
    span = t[-1]
    megno = mean_megno(t, log)[-1]
    second, last = quarters(t)
    late = log[last].mean(axis=0) - log[second].mean(axis=0)
    left = ~np.isfinite(log).all(axis=0)
    found = np.full(log.shape[1], Regularity.NOT_KNOWN, dtype=object)
    found[(megno < REGULAR_MEGNO) & (late < REGULAR_GROWTH)] = Regularity.REGULAR
    found[(megno > CHAOTIC_MEGNO) & (late > CHAOTIC_GROWTH)] = Regularity.CHAOTIC
    found[left] = Regularity.LEFT
    limit = 2 * max(CHAOTIC_MEGNO, CHAOTIC_GROWTH) / span
    reasons = tuple(
        _reason(verdict, float(m), float(g), float(span), limit)
        for verdict, m, g in zip(found, megno, late, strict=True)
    )
    return Judged(found, limit, reasons)


def of_their_systems(judged: Judged, growth: DeviationGrowth) -> Judged:
    """Return verdicts that say no more of orbits than their systems allow.

    Nothing is said of those whose energy is far off: they are not the system's. Those that rest, and those of a linear
    system, are unstable and not chaotic where neighbours part exponentially.

    Parameters
    ----------
    judged
        The verdicts by growth alone.
    growth
        What else is known of the orbits.
    """
    wrong = (growth.energy_error > FAR_OFF) & (judged.verdicts != Regularity.LEFT)
    unstable = growth.without_chaos & (judged.verdicts == Regularity.CHAOTIC) & ~wrong
    if not (wrong | unstable).any():
        return judged
    verdicts, reasons = judged.verdicts.copy(), [*judged.reasons]
    verdicts[wrong], verdicts[unstable] = Regularity.NOT_KNOWN, Regularity.UNSTABLE
    for k in np.flatnonzero(wrong):
        off = growth.energy_error[k]
        reasons[k] = (
            f"the energy has changed by {off:.2g} of its size, so that this is not the system's motion: take a shorter "
            "step, or Taylor()"
        )
    for k in np.flatnonzero(unstable):
        reasons[k] += "; that is no chaos beside a state of rest or in a linear system"
    return replace(judged, verdicts=verdicts, reasons=tuple(reasons))


def told(verdict: Regularity, limit: float) -> str:
    """Return a verdict in words: with a regular orbit stands the rate above which chaos would have been seen.

    Examples
    --------
    >>> told(Regularity.REGULAR, 0.004), told(Regularity.CHAOTIC, 0.004)
    ('regular, no rate above 0.004', 'chaotic')
    """
    return f"regular, no rate above {limit:.2g}" if verdict is Regularity.REGULAR else verdict.value


def quarters(t: Array) -> tuple[slice, slice]:
    """Return which samples are in the second quarter of a span, and which in the last."""
    first, middle, third = np.searchsorted(t, t[-1] * np.array([0.25, 0.5, 0.75])).tolist()
    return slice(first, middle), slice(third, None)


def _reason(verdict: Regularity, megno: float, late: float, span: float, limit: float) -> str:
    seen = f"mean MEGNO {megno:.3g}, and e^{late:.2g} of growth from the second quarter to the last"
    match verdict:
        case Regularity.CHAOTIC | Regularity.UNSTABLE:
            return f"neighbours part exponentially: {seen}"
        case Regularity.REGULAR:
            return (
                f"neighbours part no faster than regular motion has it: {seen}; no exponent above {limit:.2g}"
            )
        case Regularity.LEFT:
            return "the orbit left the finite numbers, by escape or collision"
        case Regularity.NOT_KNOWN:
            return f"too much growth for a regular orbit, too little for a chaotic one: {seen}; run beyond {span:.3g}"


def megno_of(t: Array, log: Array) -> Array:
    """Return MEGNO at each time, (2/t) ∫₀ᵗ s d ln δ(s) = 2 (ln δ(t) − the mean of ln δ so far), 0 at the start."""
    return 2.0 * (log - mean_over_time(t, log))


def mean_megno(t: Array, log: Array) -> Array:
    """Return the mean of MEGNO over the time so far, at each time; of a regular orbit it comes to 2 quickly."""
    return mean_over_time(t, megno_of(t, log))


def mean_over_time(t: Array, values: Array) -> Array:
    """Return the mean of values over the time from 0 to each time, by the trapezoidal rule, shape of values."""
    areas = (values[1:] + values[:-1]) / 2 * np.diff(t)[:, np.newaxis]
    whole = np.concatenate([np.zeros_like(values[:1]), np.cumsum(areas, axis=0)])
    whole[1:] /= t[1:, np.newaxis]
    return whole
