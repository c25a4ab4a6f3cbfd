"""Slow times of a motion: what it does long after a pilot run has ended, looked for before any method is judged.

A pilot run of some hundred periods sees nothing of what takes ten thousand: an eccentricity that grows, an energy that
passes from one resonant mode to another, a separatrix that is crossed late. So the motion itself is followed ahead by
Taylor's method, which is cheap and makes no difference between the methods that are compared, over the whole span or
for a number of steps that takes a share of a second: steps are counted and not seconds, so that a busy machine gives
the same answer. Pilots then run where the motion was fastest and widest too. What has not settled at the end of what
was seen, and would change the motion before the end of the span, is said: no pilot can know it. So is a span that is
many times longer than what was seen, but of one degree of freedom, whose motion repeats itself.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.method.adaptive_methods import Taylor
from canon.flow.method.setting import Setting
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.system_request import is_hamiltonian
from canon.study.energy_drift.growth import slope_of
from canon.study.method_choice.pilot_run import unit_of

if TYPE_CHECKING:
    from canon.array import Array
    from canon.study.method_choice.choice_question import Question

__all__ = ["Outlook", "with_outlook"]

PARTS = 32
"""Parts in which the motion ahead is looked at."""

FINER = 8
"""Parts of the fastest part, of which the fastest is where pilots run."""

SEEN = 64
"""States of a part from which its extent is known."""

AHEAD = 3_000_000
"""Steps of Taylor's method times numbers of the state for which the motion is followed ahead: half a second to two."""

UNSEEN = 10.0
"""Where the span is so many times longer than what was seen, a slow change that matters can have left no trace: Kozai's
from e = 0.05, i = 88° grows by e-folds of a fifth of the span, and over its first sixteenth moves no coordinate by more
than the samples scatter."""

FASTER = 1.03
"""A place where Taylor's method takes so many times more steps than at the start is one for pilots too."""

WIDER = 1.5
"""So is one where a coordinate or momentum is so many times larger."""

SETTLED_PACE, SETTLED_SIZE = 0.1, 0.4
"""Changes of log(steps a time) and of log(size of a coordinate or momentum) that matter little to an error."""

FALSE_ALARM = 1e-3
"""Probability with which a change without a direction may be taken for a trend."""

SMALLEST_PART = 1e-9
"""A coordinate or momentum smaller than this part of the largest one is of the size of that part."""


@dataclass(frozen=True)
class Outlook:
    """What is known of the motion ahead of the pilots.

    Parameters
    ----------
    seen
        For how long the motion was followed.
    elsewhere
        Times and states (q, p) beside the start at which pilots run.
    unsettled
        What still changes at the end of that and matters before the end of the span; empty where nothing does.
    """

    seen: float
    elsewhere: tuple[tuple[float, Array], ...] = ()
    unsettled: str = ""


@dataclass(frozen=True)
class _Part:
    """A part of the motion: where it begins, how many steps a unit of time takes there, how large each y becomes."""

    start: Question
    pace: float
    size: Array


def with_outlook(question: Question, span: float, natural: float) -> tuple[Question, Outlook]:
    """Return the question with further places for pilots, and what was seen of the motion ahead.

    Parameters
    ----------
    span
        Duration of a pilot run: what it sees need not be looked at.
    natural
        Time scale of the motion.
    """
    if question.span <= span:
        return question, Outlook(question.span)
    parts, seen = _followed(question, span, natural)
    if not parts:
        return question, Outlook(span, unsettled="the motion could not be followed ahead")
    places = _places(parts, seen / len(parts), span)
    elsewhere = tuple((place.since, place.y0) for place in places)
    begin = question.run(Setting(Taylor(), precision="double"), natural, 1)
    unsettled = (
        "" if seen >= question.span else _unsettled(parts, seen, question.span) or _unseen(question, seen)
    )
    return replace(question, elsewhere=elsewhere, unit=unit_of(begin, question)), Outlook(
        seen, elsewhere, unsettled
    )


def _followed(question: Question, span: float, natural: float) -> tuple[list[_Part], float]:
    """Return the parts of the motion ahead and how long they last together."""
    seen = min(question.span, max(AHEAD / len(question.y0) * natural, 4.0 * span))
    parts, begin = list[_Part](), question
    for _ in range(PARTS):
        try:
            part, begin = _part(begin, seen / PARTS)
        except (NonFiniteStateError, ValueError):
            return parts, len(parts) * seen / PARTS
        parts.append(part)
    return parts, seen


def _part(begin: Question, span: float) -> tuple[_Part, Question]:
    """Return a part of the motion, and where the next one begins."""
    found = begin.run(Setting(Taylor(), precision="double"), span, SEEN)
    size = np.abs(found.y).max(axis=1)
    size = np.maximum(size, SMALLEST_PART * size.max())
    return _Part(begin, found.steps / span, size), begin.moved(begin.since + span, found.final)


def _places(parts: list[_Part], length: float, span: float) -> list[Question]:
    """Return where the motion is faster than at the start, and where some coordinate or momentum is larger."""
    first = parts[0]
    fastest = max(parts, key=lambda part: part.pace)
    widest = max(parts, key=lambda part: float((part.size / first.size).max()))
    found: list[Question] = []
    if fastest.pace > FASTER * first.pace:
        found.append(_fastest_of(fastest.start, length, span))
    if widest is not fastest and float((widest.size / first.size).max()) > WIDER:
        found.append(widest.start)
    return found


def _fastest_of(begin: Question, length: float, span: float) -> Question:
    """Return where within a part that is much longer than a pilot the motion is fastest."""
    if length < 2.0 * span:
        return begin
    parts: list[_Part] = []
    for _ in range(FINER):
        part, begin = _part(begin, length / FINER)
        parts.append(part)
    return max(parts, key=lambda part: part.pace).start


def _unsettled(parts: list[_Part], seen: float, span: float) -> str:
    """Say what still changes: records broken in the latter half, and trends that matter before the end."""
    n = len(parts[0].size) // 2
    pace = np.log([part.pace for part in parts])
    sizes = np.log([part.size for part in parts]).T
    until = f"at t = {seen:.3g}, as far as it was followed ahead"
    if _goes_on(pace, SETTLED_PACE, span / seen):
        return f"the pace of the motion still changes {until}"
    for i, size in enumerate(sizes):
        if _goes_on(size, SETTLED_SIZE, span / seen):
            system = parts[0].start.hamiltonian
            if not is_hamiltonian(system):
                return f"the size of component {i + 1} of the state still changes {until}"
            kind, name = ("coordinate", system.q[i]) if i < n else ("momentum", system.p[i - n])
            return f"the size of the {kind} {name} still changes {until}"
    return ""


def _unseen(question: Question, seen: float) -> str:
    """Say that most of the motion was not looked at, where that matters."""
    system = question.hamiltonian
    repeats = is_hamiltonian(system) and len(system.q) == 1 and system.t not in system.H.free_symbols
    if repeats or question.span <= UNSEEN * seen:
        return ""
    share = f"{seen / question.span:.1g} of the span"
    return f"it was followed ahead to t = {seen:.3g}, {share}: a slower change was not seen"


def _goes_on(values: Array, settled: float, ratio: float) -> bool:
    """Tell whether values of equal parts leave their range, or will by their trend in so many times as long."""
    early, late = np.split(values, [len(values) // 2])
    if late.max() > early.max() + settled or late.min() < early.min() - settled:
        return True
    trend = slope_of(values, FALSE_ALARM)
    return trend.probability < FALSE_ALARM and abs(trend.value) * len(values) * ratio > settled
