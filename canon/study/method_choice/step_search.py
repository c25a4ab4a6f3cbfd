"""Step search: the largest step or tolerance with which a method keeps an accuracy, and its cost."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from canon.flow.method.energy_keeping_method import AverageVectorField
from canon.flow.method.engine import FICTITIOUS_TIME, SCIPY
from canon.flow.method.method import Gauss
from canon.flow.method.setting import Setting
from canon.study.method_choice.candidate import (
    HOPELESS,
    MARGIN,
    PILOTS,
    Candidate,
    TriedSetting,
    by_order,
    candidate_of,
    nothing,
    tried_with,
)
from canon.study.method_choice.error_law import order_of
from canon.study.method_choice.resolution import least_error
from canon.study.method_choice.tolerance_search import searched_tolerance

if TYPE_CHECKING:
    from canon.flow.method.method import Method
    from canon.study.method_choice.choice_question import Question

__all__ = ["LONGEST_PILOT", "searched", "widest_step"]

LOWEST = 0.6
"""Share of the accuracy below which a setting is dearer than it need be: by a fifth at order 2, by 5 % at order 8."""

LONGEST_PILOT = 4_000_000
"""Steps of a pilot run at most: a tenth of a second for small systems."""

LARGER = (2.0, 1.5)
"""Steps beyond the one found that are tried, in units of it: where error terms cancel, a larger step may err less. More
tries would find more, and cost more than they save where runs are short."""

LOST = 7
"""After so many steps, each half the one before, with which the motion is lost, the search ends: at two orders of
magnitude below the time scale of the motion."""

LEAST_SECONDS, LONGEST_STEP = 5e-5, 16.0
"""What a step taken in Python costs at least, and how many of Taylor's steps to round-off are no longer than a step of
a Runge–Kutta method may be before it loses the motion; both on the safe side (tests/study/test_choose.py)."""

SAME = 1.02
"""Ratio of steps that are taken for one: their costs differ by less than timings do."""

STRIDE = (0.1, 2.5)
"""How far to go from one step to the next: beyond, the order that one error shows need not hold."""

INSIDE = (0.1, 0.9)
"""Where between a good step and a bad one the next may lie, logarithmically: at an end it would tell nothing."""

FALLING = 0.25
"""Share of its order with which an error still falls where round-off is not all that is left of it."""

SHORTER = 0.25
"""Share of a usual step that a time-transformed method begins with: starts are often where the motion is fast."""

DISTURBED_ORDER = 8
"""Order with which the first step of a splitting by solvable parts is guessed: that of the terms linear in the
disturbance, 2n for SABA_n. It is only where the search begins."""

FINEST = 2.0
"""How many times the least error of the numbers is aimed at where less was asked than they resolve."""

STAGES_A_STEP, GAUSS_STAGES_A_STEP = 16.0, 6.0
"""By how many stages the widest step grows by one of Taylor's, of explicit methods and of Gauss's: a rule of thumb, by
which the search begins and steps in a fictitious time end."""


def searched(
    question: Question,
    method: Method,
    precision: str,
    span: float,
    natural: float,
    accuracy: float,
    cheapest: float,
) -> Candidate:
    """Return a method at the largest step or tolerance that is expected to keep the accuracy.

    Parameters
    ----------
    span
        Duration of a pilot run.
    natural
        Time scale of the motion.
    accuracy
        Error allowed.
    cheapest
        Cost of the best candidate so far: the search ends where a method can't come near it.
    """
    least = least_error(precision)
    if accuracy < least:
        finest = searched(question, method, precision, span, natural, FINEST * least, cheapest)
        note = f"{precision} numbers resolve no error below {least:.1e}"
        return replace(finest, keeps=False, note=finest.note if math.isinf(finest.predicted_error) else note)
    if not method.engine.takes_step:
        if _least_in_python(method, question.span, natural) > HOPELESS * cheapest:
            return nothing(Setting(method, precision=precision), "dearer at any tolerance")
        return searched_tolerance(question, method, precision, span, accuracy, cheapest)
    return _searched_step(question, method, precision, span, natural, accuracy, cheapest)


def _searched_step(
    question: Question,
    method: Method,
    precision: str,
    span: float,
    natural: float,
    accuracy: float,
    cheapest: float,
) -> Candidate:
    """Return a method of steps at the largest one that is expected to keep the accuracy."""
    # An integral may be kept exactly whatever the step: begin with a large one.
    error = accuracy if question.integral is None else 1.0
    first = _first_step(method, natural, error, span)
    setting = Setting(method, step=first, precision=precision)
    good: TriedSetting | None = None
    bad: TriedSetting | None = None
    tried: TriedSetting | None = None
    ceiling, lost = math.inf, 0
    for _ in range(PILOTS):
        tried = tried_with(question, setting, span, tried)
        lost += math.isinf(tried.error)
        if lost == LOST:
            return nothing(setting, "its error grows too fast")
        ceiling = min(ceiling, _ceiling(tried, natural))
        if setting.knob > SAME * ceiling:
            setting = setting.turned(ceiling)
            continue
        if tried.error <= accuracy:
            good = tried
        elif bad is not None and good is None and _is_floor(bad, tried):
            best = min(bad, tried, key=lambda each: each.error)
            return candidate_of(question, best, accuracy, note="its error falls no further")
        else:
            bad = tried
        knob = min(ceiling, _next_knob(tried, good, bad, accuracy))
        if good is not None and _is_enough(good, bad, knob, ceiling, accuracy, cheapest):
            break
        if good is None and _is_hopeless(tried, knob, span, cheapest):
            return by_order(question, tried, accuracy)
        setting = setting.turned(knob)
    if good is None:
        return _beyond_the_pilots(question, setting, bad, accuracy)
    if good.knob * LARGER[-1] <= ceiling:
        good = _still_larger(question, good, span, accuracy, cheapest)
    return _at_best(question, good, accuracy, cheapest)


def _least_in_python(method: Method, span: float, natural: float) -> float:
    """Return the least that a method's steps cost, whatever the tolerance, where they are taken in Python; else 0."""
    return LEAST_SECONDS * span / (LONGEST_STEP * natural) if method.engine is SCIPY else 0.0


def _at_best(question: Question, good: TriedSetting, accuracy: float, cheapest: float) -> Candidate:
    dearer = good.error < LOWEST * accuracy and good.cost > HOPELESS * cheapest
    return candidate_of(question, good, accuracy, note="dearer at any step" if dearer else "")


def _beyond_the_pilots(
    question: Question, setting: Setting, bad: TriedSetting | None, accuracy: float
) -> Candidate:
    """Return the step that the order of the last bad one promises; no pilot run has kept the accuracy."""
    return nothing(setting, "") if bad is None else by_order(question, bad, accuracy)


def _is_hopeless(tried: TriedSetting, knob: float, span: float, cheapest: float) -> bool:
    """Tell whether the step that may suffice is too small for a pilot run, or too dear for a choice."""
    return span / knob > LONGEST_PILOT or _cost_at(tried, knob) > HOPELESS * cheapest


def _is_enough(
    good: TriedSetting,
    bad: TriedSetting | None,
    knob: float,
    ceiling: float,
    accuracy: float,
    cheapest: float,
) -> bool:
    """Tell whether a step need not be made larger: its error is near the one allowed, or it never gets cheap."""
    if good.error >= LOWEST * accuracy or knob <= SAME * good.knob:
        return True
    largest = knob if bad is not None else min(ceiling, max(knob, _by_its_order(good, accuracy)))
    return _cost_at(good, largest) > HOPELESS * cheapest


def _ceiling(tried: TriedSetting, natural: float) -> float:
    """Return the largest step that still shows the motion.

    Steps of one size that are too large lose it; Verlet's in a fictitious time keep Kepler's energy whatever their
    size, and so may be no longer on average than ordinary ones.
    """
    method = tried.pilot.setting.method
    if method.engine is not FICTITIOUS_TIME or not tried.pilot.steps:
        return math.inf
    return tried.knob * widest_step(method, natural) * tried.pilot.steps / tried.pilot.span


def _still_larger(
    question: Question, good: TriedSetting, span: float, accuracy: float, cheapest: float
) -> TriedSetting:
    """Return a much larger step that keeps the accuracy too, where there is one: errors need not fall evenly."""
    for factor in LARGER:
        if good.cost / factor < cheapest:
            tried = tried_with(question, good.pilot.setting.turned(good.knob * factor), span, good)
            if tried.error <= MARGIN * accuracy:
                return tried
    return good


def _cost_at(tried: TriedSetting, step: float) -> float:
    """Return what another step would cost."""
    return tried.cost * tried.knob / step


def _first_step(method: Method, natural: float, accuracy: float, span: float) -> float:
    """Return where to begin: as many steps in the natural one as an ordinary error constant asks for.

    That of a splitting by solvable parts holds the size of the disturbance, so begin with a large step there.
    """
    if method.family == "solvable":
        widest, order = 2.0 * natural, DISTURBED_ORDER
    else:
        widest, order = widest_step(method, natural), method.order
    if method.engine is FICTITIOUS_TIME:
        widest *= SHORTER
    return max(span / LONGEST_PILOT, widest * min(1.0, (1e3 * accuracy) ** (1.0 / order)))


def widest_step(method: Method, natural: float) -> float:
    """Return the step that a method of that many stages may take where accuracy does not matter, about."""
    if isinstance(method, Gauss | AverageVectorField):  # the latter's further points make no step wider
        return natural * (0.5 + method.order / 2 / GAUSS_STAGES_A_STEP)
    return natural * (0.5 + method.stages / STAGES_A_STEP)


def _next_knob(
    tried: TriedSetting, good: TriedSetting | None, bad: TriedSetting | None, accuracy: float
) -> float:
    """Return the step whose error should be the one aimed at."""
    aim = MARGIN * accuracy
    if good is not None and bad is not None:
        if math.isinf(bad.error) or good.error <= 0.0:
            return math.sqrt(good.knob * bad.knob)
        slope = math.log(bad.error / good.error) / math.log(bad.knob / good.knob)
        wanted = good.knob * (aim / good.error) ** (1.0 / slope) if slope > 0.5 else 0.0
        low, high = (good.knob * (bad.knob / good.knob) ** share for share in INSIDE)
        return min(max(wanted, low), high)
    if math.isinf(tried.error):
        return tried.knob / 2.0
    shortest, longest = (factor * tried.knob for factor in STRIDE)
    return min(max(_by_its_order(tried, accuracy), shortest), longest)


def _by_its_order(tried: TriedSetting, accuracy: float) -> float:
    """Return the step whose error should be the one aimed at, if it followed the order of the method."""
    if tried.error <= 0.0:
        return math.inf
    return tried.knob * (MARGIN * accuracy / tried.error) ** (1.0 / order_of(tried.pilot))


def _is_floor(bad: TriedSetting, tried: TriedSetting) -> bool:
    """Tell whether a smaller step no longer brings a smaller error: round-off is all that is left."""
    if math.isinf(bad.error) or tried.knob >= bad.knob:
        return False
    gained = math.log(bad.error / tried.error) if tried.error > 0.0 else math.inf
    return gained < FALLING * order_of(tried.pilot) * math.log(bad.knob / tried.knob)
