"""Changed claims: one place changed and judged again, to find what a person may have meant."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType
from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.diagnose.change import Change, Mistake
from canon.exercise.diagnose.diagnosis import Diagnosis, judged_to_hold
from canon.exercise.diagnose.repairs.answer_places import answers_of, called
from canon.exercise.diagnose.repairs.screening import screening
from canon.exercise.diagnose.rereadings import read_anew
from canon.exercise.sheet.kind import named_function
from canon.exercise.sheet.reading import InvalidClaim
from canon.mechanics.algebra.substitution import symbols_of
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr

    from canon.exercise.diagnose.diagnosis import WrongAnswer
    from canon.exercise.sheet.reading import Reading

__all__ = [
    "another_gauge",
    "another_reading",
    "only_for",
    "only_where",
    "right_where",
    "staggered_step",
]

SCREEN_STEPS = 500
"""Steps for values of a changed claim at some points, which is read anew."""
MOST_DIVIDING = 16
_BOUNDS = (sp.exp(-1), 1, -1, 3 * sp.pi / 2, sp.pi, sp.pi / 2, -sp.pi / 2, -sp.pi)


def another_reading(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield which other claim, of the same formulas, is right: another type, variables exchanged, the inverse."""
    trials = [
        trial
        for name in wrong.reading.kind.rereadings
        for trial in named_function("canon.exercise.diagnose.rereadings", name)(wrong.reading)
    ]
    for trial, change in trials:
        if wrong.effort.spend(SCREEN_STEPS) and _could_hold(trial) and judged_to_hold(trial, wrong.effort):
            yield Diagnosis((change,), trial)


def another_gauge(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield whether L₂ − L₁ is the derivative of another function than the one that was given."""
    reading = wrong.reading
    if not reading.has("F"):
        return
    trial = read_anew(reading, {key: value for key, value in reading.claim.keys.items() if key != "F"})
    if judged_to_hold(trial, wrong.effort):
        yield Diagnosis.of(Mistake.OTHER_GAUGE, repaired=trial)


def only_where(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield a region in which the claim does hold.

    It may hold for more: that it holds only there is not proved, and not said.
    """
    reading, effort = wrong.reading, wrong.effort
    keys = reading.claim.keys
    assumed = dict(keys.get("parameters", {}))
    following = {name for key in _following(reading) for name in _names(keys.get(key))}
    free = [
        s
        for s in reading.scope.names.values()
        if s.is_positive is None and s.is_negative is None and not s.is_integer and s.name not in following
    ]
    for symbol in free[:6]:
        for word, sign in (("positive", ">"), ("negative", "<")):
            if _is_refuted_where(wrong, symbol, word):
                continue
            if not effort.spend(SCREEN_STEPS):
                return
            trial = read_anew(reading, {**keys, "parameters": {**assumed, symbol.name: word}})
            if _is_somewhere(trial) and _could_hold(trial) and judged_to_hold(trial, effort):
                yield Diagnosis.of(Mistake.ONLY_WHERE, symbol, sign, repaired=trial)


def _is_refuted_where(wrong: WrongAnswer, symbol: sp.Symbol, word: str) -> bool:
    """Whether the point at which the claim was refuted has this sign of a symbol."""
    example = wrong.finding.verdict.counterexample
    value = "" if example is None else example.point.get(symbol.name, "")
    try:
        return Fraction(value) > 0 if word == "positive" else Fraction(value) < 0
    except ValueError:  # there is none, or it is not rational
        return False


def only_for(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield a parameter that was taken to be one: the claim holds for that value of it."""
    reading, effort = wrong.reading, wrong.effort
    keys = reading.claim.keys
    assumed = dict(keys.get("parameters", {}))
    variables = {
        name for key in ("q", "p", "x", "variables", "new_q", "new_p") for name in _names(keys.get(key))
    }
    if reading.kind.two_sided and len(assumed) < 2:
        return  # at one point two functions may meet by chance
    named = {n: reading.scope.names[n] for n in assumed if n not in variables and n in reading.scope.names}
    for name, symbol in [(n, s) for n, s in named.items() if s.is_negative is not True][:8]:
        if not effort.spend(SCREEN_STEPS):
            return
        trial = replace(reading, at=MappingProxyType({symbol: sp.S.One}))
        if _could_hold(trial) and judged_to_hold(trial, effort):
            yield Diagnosis.of(Mistake.ONLY_FOR, name, sp.S.One, repaired=trial)


def right_where(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield a condition under which the claim does hold: the sign of a denominator, of a difference, a bound."""
    reading, effort = wrong.reading, wrong.effort
    expressions = [f for _, f in answers_of(reading)]
    for g in _dividing(expressions):
        for sign in (">", "<"):
            if not effort.spend(SCREEN_STEPS):
                return
            domain = reading.claim.keys.get("domain", [])
            conditions = [*(domain if isinstance(domain, list) else [domain]), f"{g} {sign} 0"]
            trial = read_anew(reading, {**reading.claim.keys, "domain": conditions})
            if _is_somewhere(trial) and _could_hold(trial) and judged_to_hold(trial, effort):
                yield Diagnosis.of(Mistake.ONLY_WHERE, g, sign, repaired=trial)


def _is_somewhere(reading: Reading) -> bool:
    """Whether the domain of a claim has a point: of an empty one everything is true."""
    try:
        return (
            next(reading.domain.points(reading.scope.names.values(), 1, but_functions=True), None) is not None
        )
    except InvalidClaim:
        return False


def _following(reading: Reading) -> tuple[str, ...]:
    """Return the keys whose names stand for what follows from other variables and can't be chosen freely."""
    if reading.has("map") or reading.has("implicit"):
        return ("new_q", "new_p")
    if reading.has("inverse_map") or reading.has("solution"):
        return ("q", "p")
    return reading.kind.following


def _dividing(expressions: Sequence[Expr]) -> list[Expr]:
    """Return what may divide the domain into a part where a claim holds and one where it does not."""
    found: dict[Expr, None] = {}
    for f in expressions:
        for node in sp.preorder_traversal(f):
            if isinstance(node, sp.Pow) and node.exp.is_negative and node.base.is_Add:
                found[node.base] = None
            elif isinstance(node, sp.Abs | sp.sign):
                found[arguments(node)[0]] = None
            elif isinstance(node, sp.Max | sp.Min) and len(arguments(node)) == 2:
                found[arguments(node)[0] - arguments(node)[1]] = None
    symbols = symbols_of(*expressions)
    if len(symbols) <= 2:
        found |= {s - bound: None for s in symbols for bound in _BOUNDS}
    return list(found)[:MOST_DIVIDING]


def staggered_step(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield that new momenta or coordinates belong in place of the old ones: a step of one after that of the other."""
    reading = wrong.reading
    if not reading.has("Q"):
        return
    answers = dict(answers_of(reading))
    screen = screening(reading, answers)
    for changed, change in _staggered(reading, answers):
        if screen is None or screen.passes(changed):
            trial = reading
            for name, new in changed.items():
                trial = trial.with_instead(name, new)
            if judged_to_hold(trial, wrong.effort):
                yield Diagnosis((change,), trial)


def _staggered(reading: Reading, answers: Mapping[str, Expr]) -> Iterator[tuple[Mapping[str, Expr], Change]]:
    """Yield maps with new momenta or coordinates where the old ones stand: a step of one after that of the other."""
    for here, there, letter in (("Q", "P", "p"), ("P", "Q", "q")):
        old = reading.symbols(letter)
        step = {z: answers[f"{there}[{i}]"] for i, z in enumerate(old)}
        images = {f"{here}[{i}]": answers[f"{here}[{i}]"] for i in range(len(old))}
        staggered = {
            key: f.subs(list(step.items()), simultaneous=True) for key, f in images.items() if f.has(*old)
        }
        new = Change.of(Mistake.NEW_FOR_OLD, there)
        for key in staggered if len(images) > 1 else ():
            yield {key: staggered[key]}, new.at(called(key, answers))
        if staggered:
            yield staggered, new.at(here)


def _could_hold(reading: Reading) -> bool:
    """Whether values at points leave it open that a claim holds."""
    try:
        screen = screening(reading, dict(answers_of(reading)))
    except InvalidClaim:
        return False
    return screen is None or screen.passes({})


def _names(value: object) -> list[str]:
    return (
        [value]
        if isinstance(value, str)
        else [v for v in value if isinstance(v, str)]
        if isinstance(value, list)
        else []
    )
