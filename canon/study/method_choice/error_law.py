"""Error laws: how errors grow with time and with the step, to extrapolate from a short run to a long one.

A symplectic method keeps a modified energy, so its energy error stays within a bound proportional to h^p
for exponentially long times; that of other methods grows in proportion to t (Hairer, Lubich & Wanner,
*Geometric Numerical Integration*, 2nd ed., § IX.8, § X.3). Round-off comes on top as a random walk, ∝ √t. An
energy error that is bounded puts the phase, and so the position, wrong in proportion to t; one that grows
with t puts it wrong in proportion to t²; a random walk, to t^(3/2).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from canon.study.energy_drift.drift import FEWEST, Growth, drift

if TYPE_CHECKING:
    from canon.study.method_choice.pilot_run import Pilot

__all__ = ["expected_error", "order_of"]

WALK_FACTOR = 2.0
"""The largest distance of a walk from its start is within twice its root-mean-square end in 95 % of cases."""

CHAOTIC = 3.5
"""Power of time above which a position error is taken to grow exponentially."""

SATURATED = 0.05
"""Relative position error from which the growth is no longer that of small errors."""


def order_of(pilot: Pilot) -> float:
    """Return the power of the step (or of the tolerance) with which the error is expected to fall."""
    return float(pilot.setting.method.order) if pilot.setting.step is not None else 1.0


def expected_error(pilot: Pilot, span: float, observable: str) -> float:
    """Return the largest error expected over a span that is longer than the pilot's.

    Parameters
    ----------
    pilot
        The short run.
    span
        Duration to extrapolate to.
    observable
        ``"position"``, or a quantity that should stay constant.

    Returns
    -------
    float
        Infinity where the pilot failed, or where the error grows exponentially.
    """
    if pilot.lost:
        return math.inf
    if span <= pilot.span * (1.0 + 1e-9):
        return pilot.bound
    if observable == "position":
        return _position(pilot, span)
    return _constant(pilot, span)


def _constant(pilot: Pilot, span: float) -> float:
    """Return the error of what should stay constant: bounded, secular and random parts."""
    ratio = span / pilot.span
    if pilot.t.size < FEWEST:
        return pilot.bound * (1.0 if pilot.setting.method.is_symplectic else ratio)
    found = drift(pilot.t, pilot.mean, diverged=math.inf)
    walk = WALK_FACTOR * found.walk * math.sqrt(ratio)
    if pilot.setting.method.is_symplectic and found.verdict not in (Growth.SECULAR, Growth.DIVERGED):
        return math.hypot(pilot.bound * _widening(pilot, ratio), walk)
    if found.walk and abs(found.slope) < 2.0 * found.slope_error:
        return max(pilot.bound, walk)
    rate = abs(found.slope)
    swing = max(0.0, pilot.bound - rate * pilot.span)
    return swing + rate * span + walk


def _widening(pilot: Pilot, ratio: float) -> float:
    """Return how much the bound of an oscillation may grow still, judged by how it has grown."""
    early = float(pilot.largest[: max(1, pilot.largest.size // 8)].max())
    grown = pilot.bound / early if early > 0.0 else 1.0
    return grown ** (0.5 * min(1.0, math.log(ratio, 8.0)))


def _position(pilot: Pilot, span: float) -> float:
    """Return the position error: a sum of powers of time with positive coefficients, fitted to its envelope."""
    t, envelope = pilot.t / pilot.span, np.maximum.accumulate(pilot.largest)
    quarter, half, whole = envelope[t.size // 4], envelope[t.size // 2 - 1], envelope[-1]
    if quarter <= 0.0:
        return float(whole * (span / pilot.span) ** 2)
    if whole > 2.0**CHAOTIC * half and whole > 1e-14:
        return math.inf
    symplectic = pilot.setting.method.is_symplectic
    if whole > SATURATED:
        return float(whole * span / pilot.span) if symplectic else math.inf
    from scipy.optimize import nnls  # long to import, and most choices end before

    powers = np.array([0.5, 1.0] if symplectic else [0.5, 1.0, 2.0])
    design = t[:, None] ** powers
    late = t.size // 4
    weights, _ = nnls(design[late:] / envelope[late:, None], np.ones(t.size - late))
    fitted = float(weights @ (span / pilot.span) ** powers)
    excess = float((envelope[late:] / (design[late:] @ weights)).max())
    return max(fitted * max(1.0, excess), float(whole))
