"""One change in an answer that is judged as a whole: candidates are screened at points, ranked, and judged in turn."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, replace
from itertools import chain, groupby, islice
from typing import TYPE_CHECKING

import sympy as sp

from canon.cached_property import cached_property
from canon.exercise.diagnose.change import Change, Mistake, rank
from canon.exercise.diagnose.diagnosis import Diagnosis, judged_to_hold
from canon.exercise.diagnose.repairs.answer_places import answers_of, called
from canon.exercise.diagnose.repairs.lost_term import terms_lost
from canon.exercise.diagnose.repairs.repair import is_wrong
from canon.exercise.diagnose.repairs.screening import screening
from canon.exercise.diagnose.repairs.slips import (
    RARER,
    common_slips,
    lost_factors,
    plain_variants,
    rarer_variants,
)
from canon.exercise.diagnose.repairs.symbol_slips import slipped
from canon.exercise.diagnose.repairs.unbuilt import built
from canon.expression.symbols.symbol import Coordinate, velocity

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from sympy import Expr

    from canon.exercise.diagnose.diagnosis import WrongAnswer
    from canon.exercise.diagnose.effort import Effort
    from canon.exercise.diagnose.repairs.screening import Screening
    from canon.exercise.diagnose.repairs.unbuilt import Form
    from canon.exercise.sheet.reading import Reading

__all__ = ["anywhere", "in_one_of_two"]

MOST_ELSEWHERE = 3
"""Changes in other components that are judged, where one was found."""
SHARE = 0.75
"""Of the effort that is left, so that some is left to what is tried afterwards."""


@dataclass(frozen=True)
class _Candidate:
    """Answers with one change, not built yet."""

    forms: Mapping[str, Form]
    change: Change
    suspicion: int

    @property
    def order(self) -> tuple[int, int]:
        """What is tried first: likely mistakes, and among these the suspected components."""
        return rank(self.change), self.suspicion

    @cached_property
    def answers(self) -> Mapping[str, Expr]:
        """The answers themselves, none where SymPy has no such expression."""
        try:
            return {key: built(form) for key, form in self.forms.items()}
        except (TypeError, ValueError):
            return {}


def anywhere(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield one change in the answer that makes the whole claim right."""
    yield from _one_change(wrong.within(SHARE))


def in_one_of_two(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield one change in F or L₂; where both are answered, half of the effort is left to L₂ as a component."""
    yield from _one_change(wrong.within(0.5 if wrong.reading.has("F") else SHARE))


def _one_change(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    reading, effort = wrong.reading, wrong.effort
    answers = dict(answers_of(reading))
    screen = screening(reading, answers)
    passing: list[_Candidate] = []
    for groups, least_to_come in _tiers(wrong, answers):
        found = (
            candidate for candidate in _passing(groups, screen, effort) if _says_something(candidate, reading)
        )
        passing = sorted((*passing, *found), key=lambda candidate: candidate.order)
        while passing and rank(passing[0].change) < least_to_come:
            if effort.spent:
                return
            candidate = passing.pop(0)
            diagnosis = _judged(candidate, wrong)
            if diagnosis is not None:
                yield replace(diagnosis, instead=_elsewhere(candidate, passing, wrong))


def _tiers(
    wrong: WrongAnswer, answers: Mapping[str, Expr]
) -> Iterator[tuple[list[Iterable[_Candidate]], float]]:
    """Yield groups of candidates, with the rank below which one that passes is judged before those to come.

    Where something is answered beside, a change there may be as likely, so that all are looked at together.
    """
    symbols = _symbols(wrong)

    def plain(key: str) -> Iterable[tuple[Form, Change]]:
        return chain(_rescaled(answers[key]), plain_variants(answers[key]))

    def factors(key: str) -> Iterable[tuple[Form, Change]]:
        return lost_factors(answers[key], symbols)

    def terms(key: str) -> Iterable[tuple[Form, Change]]:
        return terms_lost(wrong.reading, key, answers)

    def rarer(key: str) -> Iterable[tuple[Form, Change]]:
        return rarer_variants(answers[key], symbols)

    yield _of_components(wrong, answers, plain), math.inf
    if len(answers) == 1:
        yield _of_components(wrong, answers, factors), RARER
        yield _of_components(wrong, answers, terms), RARER
        yield _of_components(wrong, answers, rarer), math.inf
    else:
        yield [*_of_components(wrong, answers, factors, rarer, terms), *_in_all(answers, symbols)], math.inf


def _judged(candidate: _Candidate, wrong: WrongAnswer) -> Diagnosis | None:
    """Return the diagnosis that a candidate is, where the claim is judged to hold with it."""
    trial = wrong.reading
    for key, new in candidate.answers.items():
        trial = trial.with_instead(key, new)
    held = wrong.finding.held if "K" in candidate.answers else 0
    if not judged_to_hold(trial, wrong.effort, held):
        return None
    return Diagnosis((candidate.change,), trial, judged=held == 0)


def _elsewhere(first: _Candidate, others: Sequence[_Candidate], wrong: WrongAnswer) -> Diagnosis | None:
    """Return a change as likely in another component of the answer, where one makes the claim right as well."""
    answered = wrong.reading.kind.answer
    if wrong.reading.has("pairs") or any(_key(name) not in answered for name in first.answers):
        return None
    found = (
        _judged(other, wrong)
        for other in others
        if len(other.answers) == 1 == len(first.answers)
        and not other.answers.keys() & first.answers.keys()
        and all(_key(name) in answered for name in other.answers)
        and rank(other.change) <= rank(first.change) + 1
    )
    return next((d for d in islice(found, MOST_ELSEWHERE) if d is not None), None)


def _key(name: str) -> str:
    """Return the key of a claim under which an answer stands: P for P[0], solution for solution.q."""
    return name.partition("[")[0].partition(".")[0]


def _passing(
    groups: Sequence[Iterable[_Candidate]], screen: Screening | None, effort: Effort
) -> list[_Candidate]:
    """Return the candidates that values at points leave open; all of them where a kind has no screen."""
    found: list[_Candidate] = []
    for number, candidates in enumerate(groups):
        share = effort.share(1 / (len(groups) - number + 1))
        for candidate in candidates:
            if screen is not None and not share.spend(screen.steps):
                break
            if screen is None or screen.passes(candidate.forms):
                found.append(candidate)
    return found


def _symbols(wrong: WrongAnswer) -> tuple[sp.Symbol, ...]:
    """Return what may have been meant in place of a symbol."""
    names = tuple(wrong.reading.scope.names.values())
    rates = (velocity(s) for s in names if isinstance(s, Coordinate)) if wrong.reading.has("L") else ()
    return (*names, wrong.reading.time, *rates)


def _in_all(answers: Mapping[str, Expr], symbols: Sequence[sp.Symbol]) -> list[Iterable[_Candidate]]:
    """Return what may be wrong in all components under a key alike."""
    by_key = [(outer, list(keys)) for outer, keys in groupby(sorted(answers, key=_outer), key=_outer)]
    return [_common(outer, {key: answers[key] for key in keys}, symbols) for outer, keys in by_key]


def _of_components(
    wrong: WrongAnswer,
    answers: Mapping[str, Expr],
    *changes: Callable[[str], Iterable[tuple[Form, Change]]],
) -> list[Iterable[_Candidate]]:
    """Return the candidates of each component, those suspected first."""
    suspects = _suspects(wrong) or _following(wrong.reading)

    def candidates(key: str) -> Iterator[_Candidate]:
        for new, change in chain.from_iterable(make(key) for make in changes):
            yield _Candidate({key: new}, change.at(called(key, answers)), _suspicion(key, suspects))

    return [candidates(key) for key in sorted(answers, key=lambda key: _suspicion(key, suspects))]


def _common(outer: str, items: Mapping[str, Expr], symbols: Sequence[sp.Symbol]) -> Iterator[_Candidate]:
    """Yield what may be wrong in all components under a key alike."""
    if len(items) < 2:
        return
    for slip, change in common_slips(list(items.values()), symbols):
        changed = {key: slipped(f, slip) for key, f in items.items()}
        whole = {key: new for key, new in changed.items() if new is not None}
        if len(whole) == len(items):
            yield _Candidate(whole, change.at(outer), 0)


def _suspects(wrong: WrongAnswer) -> list[str]:
    """Return the names in brackets that are wrong, the most frequent first."""
    counts: Counter[str] = Counter()
    for part in wrong.parts:
        if part.bracket_of and is_wrong(part, wrong.domain):
            counts.update(part.bracket_of)
    return [name for name, _ in counts.most_common()]


def _following(reading: Reading) -> list[str]:
    """Return the momenta of a solution, which follow from its coordinates and are rather wrong than these."""
    return (
        [f"solution.{p}" for p in reading.words("p")] if reading.has("solution") and reading.has("p") else []
    )


def _outer(key: str) -> str:
    """Return the part of a key before the component: P of P[0], solution of solution.q."""
    if key.startswith("pairs"):
        return key
    return key.partition("[")[0] if "[" in key else key.partition(".")[0]


def _suspicion(key: str, suspects: Sequence[str]) -> int:
    """Return how far back in the line of suspects a component stands: P[1] is called P2, or P if it is alone."""
    letter, _, index = key.removeprefix("map.").partition("[")
    names = (letter, f"{letter}{int(index[:-1]) + 1}" if index.endswith("]") else letter)
    return min((i for i, suspect in enumerate(suspects) if suspect in names), default=len(suspects))


def _rescaled(f: Expr) -> Iterator[tuple[Expr, Change]]:
    yield -f, Change.of(Mistake.WRONG_SIGN)
    simple = map(sp.Rational, ("1/2", "2", "1/3", "3", "1/4", "4", "2/3", "3/2"))
    for factor in (*simple, 2 * sp.pi, 1 / (2 * sp.pi)):
        yield factor * f, Change.of(Mistake.WRONG_FACTOR, factor)


def _says_something(candidate: _Candidate, reading: Reading) -> bool:
    answers = candidate.answers
    return bool(answers) and not any(_trivial(key, answer, reading) for key, answer in answers.items())


def _trivial(key: str, answer: Expr, reading: Reading) -> bool:
    """Whether an answer under a key says nothing any more: a constant of the motion that is constant anyway."""
    variables = {s for key in ("q", "p", "x") if reading.is_names(key) for s in reading.symbols(key)}
    rates = {velocity(s) for s in variables}
    return key in reading.kind.varying and not answer.free_symbols & (variables | rates)
