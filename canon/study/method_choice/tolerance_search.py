"""Tolerance search: the largest tolerance with which an adaptive method keeps an accuracy."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.flow.method.setting import Setting
from canon.study.method_choice.candidate import (
    HOPELESS,
    PILOTS,
    Candidate,
    TriedSetting,
    by_order,
    candidate_of,
    nothing,
    tried_with,
)
from canon.study.method_choice.pilot_run import pilot_share

if TYPE_CHECKING:
    from canon.flow.method.method import Method
    from canon.study.method_choice.choice_question import Question

__all__ = ["ADAPTIVE_MARGIN", "last_rung", "searched_tolerance", "tolerance_at"]

LOOSEST = 3
"""First rung of the ladder of tolerances: 0.004."""

ADAPTIVE_MARGIN = 0.25
"""Share of the accuracy that is aimed at with adaptive methods, whose errors depend on rare close encounters."""


def searched_tolerance(
    question: Question, method: Method, precision: str, span: float, accuracy: float, cheapest: float
) -> Candidate:
    """Return an adaptive method at the largest tolerance of a ladder that is expected to suffice.

    The rungs are e² apart, one order of Taylor's method each: in between heyoka's steps are the same.
    """
    span *= pilot_share(method)
    aim = accuracy * ADAPTIVE_MARGIN if question.span > span else accuracy
    last = last_rung(precision)
    good: TriedSetting | None = None
    bad: TriedSetting | None = None
    low, high = LOOSEST - 1, last + 1
    rung = min(last, max(LOOSEST, round(-math.log(aim) / 2.0)))
    for _ in range(PILOTS):
        setting = Setting(method, tolerance=tolerance_at(rung), precision=precision)
        tried = tried_with(question, setting, span)
        if tried.error <= aim:
            good, high = tried, rung
        else:
            bad, low = tried, rung
            if tried.cost > HOPELESS * cheapest and good is None:
                return by_order(question, tried, accuracy)
        if high - low <= 1:
            break
        jump = math.log(tried.error / aim) / 2.0 if 0.0 < tried.error < math.inf else 2.0
        rung = min(max(rung + (math.ceil(jump) or -1), low + 1), high - 1)
    if good is not None:
        return candidate_of(question, good, accuracy)
    if bad is None or math.isinf(bad.error):
        return nothing(Setting(method, precision=precision), bad.pilot.failure if bad is not None else "")
    return candidate_of(question, bad, accuracy, note="its tolerance is as small as it can be")


def tolerance_at(rung: int) -> float:
    """Return a tolerance for which Taylor's method takes an order one higher than the rung.

    Examples
    --------
    >>> from canon import Taylor
    >>> [Taylor(tolerance_at(rung)).order for rung in (5, 12, 18)]
    [6, 13, 19]
    """
    return math.exp(0.5 - 2.0 * rung)


def last_rung(precision: str) -> int:
    """Return the rung of the smallest tolerance that an arithmetic can keep."""
    bits = {"extended": 63, "quad": 112}.get(precision, 52)
    return math.floor(0.25 + bits * math.log(2.0) / 2.0) + 1
