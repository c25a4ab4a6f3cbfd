"""Confirmation run of the candidate about to be chosen, and whether plain doubles suffice."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from canon.flow.method.setting import Setting
from canon.study.method_choice.candidate import MARGIN, Candidate, candidate_of, tried_with
from canon.study.method_choice.error_law import order_of
from canon.study.method_choice.pilot_run import pilot_share
from canon.study.method_choice.step_search import LONGEST_PILOT
from canon.study.method_choice.tolerance_search import ADAPTIVE_MARGIN, last_rung, tolerance_at

if TYPE_CHECKING:
    from canon.study.method_choice.choice_question import Question

__all__ = ["confirmed", "double_instead"]

CONFIRMING = 8.0
"""How many times longer than the pilots the last look at the cheapest candidate is: a drift that hid in an oscillation
is eight times larger then, and one look at one candidate costs less than the pilots of a dozen."""

RESONANT = 3.0
"""How many times larger than expected an error is that is put down to a resonance: √8 is what a walk grows by in a look
eight times as long."""

NEIGHBOUR = 0.97
"""Ratio of neighbouring steps: small, so that leaving a resonance costs little."""

SHORTEST_STRIDE = 0.3
"""Ratio of one step to the next, at least: a large error tells little of its order."""

WHOLE_SECONDS = 0.5
"""Processor time up to which the whole run is the last look: then nothing is extrapolated."""

POSITION_SECONDS = 0.02
"""The same for positions, whose reference in more digits takes some twenty times as long."""

LOOKS = 4
"""How often the step is made shorter at most: a candidate that still fails then is one no more."""

CHEAPER = 0.97
"""Share of the cost that plain doubles must save to be worth their round-off: timings are no better."""


def double_instead(question: Question, chosen: Candidate, span: float, accuracy: float) -> Candidate | None:
    """Return the candidate in plain doubles where that is expected to keep the accuracy and to cost less."""
    if chosen.precision != "compensated":
        return None
    tried = tried_with(question, Setting(chosen.method, chosen.step, precision="double"), span)
    found = candidate_of(question, tried, accuracy)
    return found if found.keeps and found.predicted_cost < CHEAPER * chosen.predicted_cost else None


def confirmed(question: Question, chosen: Candidate, span: float, accuracy: float) -> Candidate:
    """Return the candidate after a longer look: at resonance, and at an error that grows late."""
    if chosen.seen >= question.span:
        return chosen
    longer = _longer(question, chosen, span)
    setting, resonant = chosen.setting, False
    tried = tried_with(question, setting, longer)
    share = 1.0 if setting.step is not None or longer >= question.span else ADAPTIVE_MARGIN
    for _ in range(LOOKS):
        if tried.error <= share * accuracy:
            break
        if setting.step is not None:
            resonant = resonant or tried.error > RESONANT * chosen.predicted_error
            order = order_of(tried.pilot)
            factor = (MARGIN * accuracy / tried.error) ** (1.0 / order) if tried.error < math.inf else 0.5
            setting = setting.turned(setting.knob * min(NEIGHBOUR, max(factor, SHORTEST_STRIDE)))
        elif setting.knob > tolerance_at(last_rung(setting.arithmetic)):
            setting = setting.turned(_smaller_tolerance(setting, tried.error / (share * accuracy)))
        else:
            break
        tried = tried_with(question, setting, longer)
    return replace(candidate_of(question, tried, accuracy), resonant=resonant)


def _smaller_tolerance(setting: Setting, excess: float) -> float:
    """Return a tolerance that is smaller by whole orders of Taylor's method, as many as an error is too large by."""
    orders = max(1, math.ceil(math.log(excess) / 2.0)) if excess < math.inf else 1
    return max(tolerance_at(last_rung(setting.arithmetic)), setting.knob * math.exp(-2.0 * orders))


def _longer(question: Question, chosen: Candidate, span: float) -> float:
    """Return how long the last look is: the whole span where that is cheap."""
    cheap = POSITION_SECONDS if question.observable == "position" else WHOLE_SECONDS
    if chosen.predicted_cost <= cheap:
        return question.span
    longer = min(question.span, CONFIRMING * span * pilot_share(chosen.method))
    return longer if chosen.step is None else min(longer, LONGEST_PILOT * chosen.step)
