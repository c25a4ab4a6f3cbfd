"""The dearest error that is still good enough: the step or tolerance a method needs, and what it costs then."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from canon.flow.method import DOP853, RK4, FixedStep, Gauss, Splitting, Taylor
from canon.flow.propagate import is_separable
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

LEAST_TOLERANCE = 2.0**-52

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
    fixed = isinstance(method, FixedStep)
    setting = Setting(method, precision=precision).turned(_first_knob(method, natural, accuracy, duration))
    duration *= dop853_share(method)
    good: _Try | None = None
    bad: _Try | None = None
    best: _Try | None = None
    for _ in range(PILOTS):
        tried = _tried(question, setting, duration)
        if best is None or tried.error < best.error:
            best = tried
        if tried.error <= accuracy:
            good = tried if good is None or tried.cost < good.cost else good
            if tried.error >= LOWEST * accuracy:
                break
        else:
            floor = _is_floor(bad, tried)
            bad = tried if bad is None or tried.knob < bad.knob else bad
            if floor and good is None:
                break
        knob = _next_knob(question, tried, good, bad, accuracy, duration)
        limit = 1.0e-3 if not fixed else math.inf
        knob = min(knob, limit)
        if not fixed and knob < LEAST_TOLERANCE:
            if tried.knob <= LEAST_TOLERANCE:
                break
            knob = LEAST_TOLERANCE
        if good is not None and (knob <= good.knob * 1.02 or (bad is not None and bad.knob < 1.04 * good.knob)):
            break
        if duration / knob > LONGEST_PILOT and fixed:
            break
        if good is None and _least_cost(tried, knob) > HOPELESS * cheapest:
            return _candidate(question, tried, accuracy, _least_cost(tried, knob), "dearer, by its order")
        if good is not None and good.cost / (knob / good.knob if fixed else 1.6) > HOPELESS * cheapest:
            break
        setting = setting.turned(knob)
    if good is not None:
        return _candidate(question, good, accuracy)
    if best is None or math.isinf(best.error):
        reason = best.pilot.failure if best is not None else ""
        return _nothing(setting, reason or "no step tried keeps the motion")
    return _candidate(question, best, accuracy, note="its error falls no further")


def _tried(question: Question, setting: Setting, duration: float) -> _Try:
    found = pilot(question, setting, duration)
    if found.lost:
        return _Try(found, math.inf, question.span / duration * found.steps)
    error = expected_error(found, question.span, question.observable)
    rate = seconds_per_time(question, found.setting, duration)
    return _Try(found, error, rate * question.span)


def _first_knob(method: Method, natural: float, accuracy: float, duration: float) -> float:
    """Return where to begin: as many steps in the natural one as an ordinary error constant asks for."""
    if not isinstance(method, FixedStep):
        return min(1e-4, max(LEAST_TOLERANCE, 0.01 * accuracy))
    stages = method.stages
    widest = natural * (0.5 + stages / 16.0 if isinstance(method, Splitting) else 0.5 + stages / 6.0)
    return max(duration / LONGEST_PILOT, widest * min(1.0, (1e3 * accuracy) ** (1.0 / method.order)))


def _next_knob(
    question: Question, tried: _Try, good: _Try | None, bad: _Try | None, accuracy: float, duration: float
) -> float:
    """Return the step or tolerance whose error should be the one aimed at."""
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
    order = order_of(tried.pilot)
    factor = (aim / tried.error) ** (1.0 / order)
    return tried.knob * min(max(factor, 0.1 if order > 1.0 else 1e-4), 2.5 if order > 1.0 else 1e3)


def _is_floor(bad: _Try | None, tried: _Try) -> bool:
    """Tell whether a smaller step no longer brings a smaller error: round-off is all that is left."""
    if bad is None or math.isinf(bad.error) or tried.knob >= bad.knob:
        return False
    gained = math.log(bad.error / tried.error) if tried.error > 0.0 else math.inf
    return gained < 0.25 * order_of(tried.pilot) * math.log(bad.knob / tried.knob)


def _least_cost(tried: _Try, knob: float) -> float:
    """Return what the next step or tolerance would cost at least."""
    if tried.pilot.lost:
        return 0.0
    if tried.pilot.setting.step is not None:
        return tried.cost * tried.knob / knob
    return tried.cost


def _candidate(
    question: Question, tried: _Try, accuracy: float, cost: float | None = None, note: str = ""
) -> Candidate:
    setting, found = tried.pilot.setting, tried.pilot
    keeps = tried.error <= accuracy
    share = 1.0 if cost is None else cost / tried.cost
    return Candidate(
        method=setting.method,
        step=setting.step,
        tolerance=setting.tolerance,
        precision=setting.precision,
        predicted_error=tried.error,
        predicted_cost=tried.cost * share,
        evaluations=found.evaluations * question.span / found.span * share,
        keeps=keeps,
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
    longer = min(question.span, 8.0 * duration * dop853_share(chosen.method))
    setting, resonant = chosen.setting, False
    tried = _tried(question, setting, longer)
    for _ in range(4):
        if tried.error <= accuracy:
            break
        order = order_of(tried.pilot)
        factor = (MARGIN * accuracy / tried.error) ** (1.0 / order) if math.isfinite(tried.error) else 0.5
        if isinstance(setting.method, Splitting | Gauss):
            resonant = resonant or tried.error > RESONANT * chosen.predicted_error
        setting = setting.turned(setting.knob * min(NEIGHBOUR, max(factor, 0.3)))
        if setting.step is None and setting.knob < LEAST_TOLERANCE:
            break
        tried = _tried(question, setting, longer)
    return replace(_candidate(question, tried, accuracy), resonant=resonant)
