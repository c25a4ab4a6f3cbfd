"""The largest error that is still good enough: the step or tolerance a method needs, and what it costs then."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from canon.flow.method import DOP853, RK4, FixedStep, Gauss, Splitting, Taylor
from canon.flow.propagate import NonFiniteStateError, is_separable
from canon.kernel.scheme import SCHEMES
from canon.study.choose_law import expected_error, order_of
from canon.study.choose_pilot import Pilot, Question, Setting, dop853_share, pilot, seconds_per_time

if TYPE_CHECKING:
    from canon.flow.method import Method

__all__ = ["Candidate", "candidate_methods", "confirmed", "double_instead", "searched"]

MARGIN = 0.85
"""Share of the accuracy that is aimed at; what is above this and below one is taken as it is."""

LOWEST = 0.6
"""Share of the accuracy below which a setting is dearer than it need be."""

PILOTS = 9
"""Pilot runs a method gets at most."""

HOPELESS = 4.0
"""How many times dearer than the best so far a method may be expected to be before its search ends."""

LONGEST_PILOT = 4_000_000
"""Steps of a pilot run at most."""

LOOSEST = 3
"""First rung of the ladder of tolerances: 0.004."""

ADAPTIVE_MARGIN = 0.25
"""Share of the accuracy that is aimed at with adaptive methods, whose errors depend on rare close encounters."""

CONFIRMING = 8.0
"""How many times longer than the pilots the last look at the cheapest candidate is."""

LARGER = (2.0, 1.5)
"""Steps beyond the one found that are tried, in units of it."""

RESONANT = 3.0
"""How many times larger than at the neighbouring steps the error of a resonant one is."""

NEIGHBOUR = 0.97
"""Ratio of neighbouring steps."""


@dataclass(frozen=True)
class Candidate:
    """A method at the step or tolerance it needs, or why it does not reach the accuracy.

    Parameters
    ----------
    method, step, tolerance, precision
        As :func:`canon.flow.propagate.propagate` takes them; a step or tolerance is None where the method
        has the other.
    predicted_error
        Largest error expected over the span.
    predicted_cost
        Processor seconds expected of the steps.
    evaluations
        Evaluations of the force expected (Taylor: of the series).
    keeps
        Whether the accuracy is expected to be kept.
    resonant
        Whether a neighbouring step was resonant and had to be avoided.
    note
        What else there is to say.
    """

    method: Method
    step: float | None
    tolerance: float | None
    precision: str
    predicted_error: float
    predicted_cost: float
    evaluations: float
    keeps: bool
    resonant: bool = False
    note: str = ""

    @property
    def setting(self) -> Setting:
        """The setting as pilots take it."""
        return Setting(self.method, self.step, self.tolerance, self.precision)


def candidate_methods(question: Question) -> tuple[Method, ...]:
    """Return the methods that apply, those first that are usually the cheapest.

    Splittings where H = T(p) + V(q), else Gauss's methods, Taylor's, and two ordinary ones for comparison.
    """
    ordinary = RK4(), DOP853()
    if not is_separable(question.hamiltonian, question.values):
        return Taylor(), *(Gauss(s) for s in (4, 3, 2, 6, 8, 1)), *ordinary
    names = sorted(SCHEMES, key=lambda name: -SCHEMES[name].order)
    return Taylor(), *(Splitting(name) for name in names), *ordinary


@dataclass(frozen=True)
class _Try:
    """A pilot run and what is expected of its setting over the whole span."""

    pilot: Pilot
    error: float
    cost: float

    @property
    def knob(self) -> float:
        return self.pilot.setting.knob


def searched(
    question: Question,
    method: Method,
    precision: str,
    duration: float,
    natural: float,
    accuracy: float,
    cheapest: float,
) -> Candidate:
    """Return a method at the largest step or tolerance that is expected to keep the accuracy.

    Parameters
    ----------
    duration
        Duration of a pilot run.
    natural
        Time scale of the motion.
    accuracy
        Error allowed.
    cheapest
        Cost of the best candidate so far: the search ends where a method can't come near it.
    """
    if not isinstance(method, FixedStep):
        return _by_tolerance(question, method, precision, duration, accuracy, cheapest)
    # An integral may be kept exactly whatever the step: begin with a large one.
    error = accuracy if question.integral is None else 1.0
    first = _first_step(method, natural, error, duration)
    setting = Setting(method, step=first, precision=precision)
    good: _Try | None = None
    bad: _Try | None = None
    for _ in range(PILOTS):
        tried = _tried(question, setting, duration)
        if tried.error <= accuracy:
            good = tried
            if tried.error >= LOWEST * accuracy:
                break
        elif good is None and _is_floor(bad, tried):
            best = min((each for each in (bad, tried) if each is not None), key=lambda each: each.error)
            return _candidate(question, best, accuracy, note="its error falls no further")
        else:
            bad = tried
        knob = _next_knob(tried, good, bad, accuracy)
        if good is not None:
            if knob <= good.knob * 1.02 or _cost_at(good, knob) > HOPELESS * cheapest:
                break
        elif duration / knob > LONGEST_PILOT or _cost_at(tried, knob) > HOPELESS * cheapest:
            return _by_order(question, tried, accuracy)
        setting = setting.turned(knob)
    if good is not None:
        good = _still_larger(question, good, duration, accuracy, cheapest)
        dearer = good.error < LOWEST * accuracy and good.cost > HOPELESS * cheapest
        return _candidate(question, good, accuracy, note="dearer at any step" if dearer else "")
    return _by_order(question, bad, accuracy) if bad is not None else _nothing(setting, "")


def _still_larger(question: Question, good: _Try, duration: float, accuracy: float, cheapest: float) -> _Try:
    """Return a much larger step that keeps the accuracy too, where there is one: errors need not fall evenly."""
    for factor in LARGER:
        if good.cost / factor < cheapest:
            tried = _tried(question, good.pilot.setting.turned(good.knob * factor), duration)
            if tried.error <= MARGIN * accuracy:
                return tried
    return good


def _cost_at(tried: _Try, step: float) -> float:
    """Return what another step would cost."""
    return tried.cost * tried.knob / step


def _by_tolerance(
    question: Question, method: Method, precision: str, duration: float, accuracy: float, cheapest: float
) -> Candidate:
    """Return an adaptive method at the largest tolerance of a ladder that is expected to suffice.

    The rungs are e² apart, one order of Taylor's method each: in between heyoka's steps are the same.
    """
    duration *= dop853_share(method)
    aim = accuracy * ADAPTIVE_MARGIN if question.span > duration else accuracy
    last = _last_rung(precision)
    good: tuple[int, _Try] | None = None
    bad: tuple[int, _Try] | None = None
    rung = min(last, max(LOOSEST, round(-math.log(aim) / 2.0)))
    for _ in range(PILOTS):
        setting = Setting(method, tolerance=tolerance_at(rung), precision=precision)
        tried = _tried(question, setting, duration)
        if tried.error <= aim:
            good = rung, tried
        else:
            bad = rung, tried
            if tried.cost > HOPELESS * cheapest and good is None:
                return _by_order(question, tried, accuracy)
        low = bad[0] if bad is not None else LOOSEST - 1
        high = good[0] if good is not None else last + 1
        if high - low <= 1:
            break
        jump = math.log(tried.error / aim) / 2.0 if 0.0 < tried.error < math.inf else 2.0
        rung = min(max(rung + (math.ceil(jump) or -1), low + 1), high - 1)
    if good is not None:
        return _candidate(question, good[1], accuracy)
    if bad is None or math.isinf(bad[1].error):
        return _nothing(Setting(method, precision=precision), bad[1].pilot.failure if bad is not None else "")
    return _candidate(question, bad[1], accuracy, note="its tolerance is as small as it can be")


def tolerance_at(rung: int) -> float:
    """Return a tolerance for which Taylor's method takes an order one higher than the rung.

    Examples
    --------
    >>> from canon import Taylor
    >>> [Taylor(tolerance_at(rung)).order for rung in (5, 12, 18)]
    [6, 13, 19]
    """
    return math.exp(0.5 - 2.0 * rung)


def _last_rung(precision: str) -> int:
    bits = {"extended": 63, "quad": 112}.get(precision, 52)
    return math.floor(0.25 + bits * math.log(2.0) / 2.0) + 1


def _tried(question: Question, setting: Setting, duration: float) -> _Try:
    found = pilot(question, setting, duration)
    if found.lost:
        return _Try(found, math.inf, question.span / duration * found.steps)
    error = expected_error(found, question.span, question.observable)
    try:
        rate = seconds_per_time(question, found.setting, duration)
    except NonFiniteStateError:  # with a step a little smaller, to divide another span
        return _Try(found, math.inf, math.inf)
    return _Try(found, error, rate * question.span)


def _first_step(method: FixedStep, natural: float, accuracy: float, duration: float) -> float:
    """Return where to begin: as many steps in the natural one as an ordinary error constant asks for."""
    stages = method.stages
    widest = natural * (0.5 + stages / 16.0 if isinstance(method, Splitting) else 0.5 + stages / 6.0)
    return max(duration / LONGEST_PILOT, widest * min(1.0, (1e3 * accuracy) ** (1.0 / method.order)))


def _next_knob(tried: _Try, good: _Try | None, bad: _Try | None, accuracy: float) -> float:
    """Return the step whose error should be the one aimed at."""
    aim = MARGIN * accuracy
    if good is not None and bad is not None:
        if math.isinf(bad.error) or good.error <= 0.0:
            return math.sqrt(good.knob * bad.knob)
        slope = math.log(bad.error / good.error) / math.log(bad.knob / good.knob)
        wanted = good.knob * (aim / good.error) ** (1.0 / slope) if slope > 0.5 else 0.0
        low, high = (good.knob * (bad.knob / good.knob) ** share for share in (0.1, 0.9))
        return min(max(wanted, low), high)
    if math.isinf(tried.error):
        return tried.knob / 2.0
    if tried.error <= 0.0:
        return tried.knob * 2.0
    factor = (aim / tried.error) ** (1.0 / order_of(tried.pilot))
    return tried.knob * min(max(factor, 0.1), 2.5)


def _is_floor(bad: _Try | None, tried: _Try) -> bool:
    """Tell whether a smaller step no longer brings a smaller error: round-off is all that is left."""
    if bad is None or math.isinf(bad.error) or tried.knob >= bad.knob:
        return False
    gained = math.log(bad.error / tried.error) if tried.error > 0.0 else math.inf
    return gained < 0.25 * order_of(tried.pilot) * math.log(bad.knob / tried.knob)


def _by_order(question: Question, tried: _Try, accuracy: float) -> Candidate:
    """Return the candidate at the step that its order lets expect, which was not tried."""
    if math.isinf(tried.error):
        return _nothing(tried.pilot.setting, tried.pilot.failure or "its error grows too fast")
    knob = tried.knob * (MARGIN * accuracy / tried.error) ** (1.0 / order_of(tried.pilot))
    setting = tried.pilot.setting
    if setting.step is None and knob < 2.0**-52:
        return _candidate(question, tried, accuracy, note="its tolerance is as small as it can be")
    share = tried.knob / knob if setting.step is not None else 1.0
    found = _candidate(question, tried, accuracy)
    return replace(
        found,
        step=None if setting.step is None else knob,
        tolerance=None if setting.tolerance is None else knob,
        predicted_error=MARGIN * accuracy,
        predicted_cost=found.predicted_cost * share,
        evaluations=found.evaluations * share,
        keeps=True,
        note="by its order, not tried",
    )


def _candidate(question: Question, tried: _Try, accuracy: float, note: str = "") -> Candidate:
    setting, found = tried.pilot.setting, tried.pilot
    return Candidate(
        method=setting.method,
        step=setting.step,
        tolerance=setting.tolerance,
        precision=setting.precision,
        predicted_error=tried.error,
        predicted_cost=tried.cost,
        evaluations=found.evaluations * question.span / found.span,
        keeps=tried.error <= accuracy,
        note=note,
    )


def _nothing(setting: Setting, reason: str) -> Candidate:
    return Candidate(
        setting.method,
        None,
        None,
        setting.precision,
        predicted_error=math.inf,
        predicted_cost=math.inf,
        evaluations=math.inf,
        keeps=False,
        note=reason,
    )


def double_instead(
    question: Question, chosen: Candidate, duration: float, accuracy: float
) -> Candidate | None:
    """Return the candidate in plain doubles where that is expected to keep the accuracy and to cost less."""
    if chosen.precision != "compensated":
        return None
    tried = _tried(question, Setting(chosen.method, chosen.step, precision="double"), duration)
    found = _candidate(question, tried, accuracy)
    return found if found.keeps and found.predicted_cost < 0.97 * chosen.predicted_cost else None


def confirmed(question: Question, chosen: Candidate, duration: float, accuracy: float) -> Candidate:
    """Return the candidate after a longer look: at resonance, and at an error that grows late."""
    if question.span <= duration:
        return chosen
    longer = min(question.span, CONFIRMING * duration * dop853_share(chosen.method))
    if chosen.step is not None:
        longer = min(longer, LONGEST_PILOT * chosen.step)
    setting, resonant = chosen.setting, False
    tried = _tried(question, setting, longer)
    share = 1.0 if setting.step is not None or longer >= question.span else ADAPTIVE_MARGIN
    for _ in range(4):
        if tried.error <= share * accuracy:
            break
        if setting.step is not None:
            resonant = resonant or tried.error > RESONANT * chosen.predicted_error
            order = order_of(tried.pilot)
            factor = (MARGIN * accuracy / tried.error) ** (1.0 / order) if tried.error < math.inf else 0.5
            setting = setting.turned(setting.knob * min(NEIGHBOUR, max(factor, 0.3)))
        elif setting.knob > tolerance_at(_last_rung(setting.precision)):
            setting = setting.turned(setting.knob * math.exp(-2.0))
        else:
            break
        tried = _tried(question, setting, longer)
    return replace(_candidate(question, tried, accuracy), resonant=resonant)
