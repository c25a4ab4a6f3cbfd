"""Claims changed in one place and judged anew: what a person may have meant."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import chain, groupby
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.exercise.manifold import EmptyDomainError
from canon.exercise.question import Deadline, decide
from canon.exercise.reading import InvalidClaim, Reading
from canon.exercise.variants import common_slips, times, variants
from canon.expression.symbol import velocity
from canon.mechanics.linear import SingularMatrixError
from canon.proof.verdict import Undecided

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from sympy import Expr

__all__ = ["another_reading", "one_change", "only_where"]

TRIAL_SECONDS = 0.4
_ANSWERS: Mapping[str, tuple[str, ...]] = {
    "gibbs-appell": ("S",),
    "hamilton-equations": ("solution",),
    "canonicity": ("P", "Q", "implicit"),
    "canonicity-time-dependent": ("P", "Q", "implicit"),
    "bilinear-covariant": ("P", "Q"),
    "lagrange-bracket": ("p", "q"),
    "transformed-hamiltonian-K": ("K", "map.P", "map.Q", "inverse_map.p", "inverse_map.q"),
    "constant-of-motion": ("I",),
    "lagrangian-equivalence": ("F", "L2"),
    "equality-only": ("rhs", "lhs"),
    **{f"generating-F{k}": ("F", "map.Q", "map.P", "inverse_map.q", "inverse_map.p") for k in "1234"},
}
"""Where the answer stands in claims that are judged as a whole."""


def another_reading(reading: Reading, deadline: float) -> str:
    """Return which other claim, of the same formulas, is right: another type, variables exchanged, the inverse."""
    keys, kind = reading.claim.keys, reading.claim.kind
    trials: list[tuple[str, Mapping[str, Any], str]] = []
    if kind.startswith("generating"):
        trials += [
            (f"generating-F{k}", keys, f"F generates this map as a function of type {k}, not {kind[-1]}")
            for k in "1234"
            if k != kind[-1]
        ]
    if reading.has("map"):
        exchanged = {"Q": keys["map"].get("P"), "P": keys["map"].get("Q")}
        trials.append((kind, {**keys, "map": exchanged}, "Q and P are exchanged in the map"))
    if kind == "hamilton-equations" and reading.has("q_dot"):
        exchanged = {"q_dot": keys["p_dot"], "p_dot": keys["q_dot"]}
        trials.append((kind, {**keys, **exchanged}, "the equations of q and p are exchanged"))
    if kind == "routhian":
        other = {"L-pq": "pq-L", "pq-L": "L-pq"}[reading.word("convention")]
        trials.append((kind, {**keys, "convention": other}, f"right under the other convention, {other}"))
    if reading.has("map") and time.monotonic() < deadline and _holds(_inverted(reading), deadline):
        return "what is given as the map is its inverse"
    for other, changed, sentence in trials:
        if time.monotonic() < deadline and _holds(_read_anew(reading, other, changed), deadline):
            return sentence
    return ""


def only_where(reading: Reading, deadline: float) -> str:
    """Return a region, or a value of a parameter, for which the claim does hold."""
    keys = reading.claim.keys
    assumed = dict(keys.get("parameters", {}))
    free = [
        s
        for s in reading.scope.names.values()
        if s.is_positive is None and s.is_negative is None and not s.is_integer
    ]
    for symbol in free[:6]:
        for word, sign in (("positive", ">"), ("negative", "<")):
            if time.monotonic() > deadline:
                return ""
            changed = {**keys, "parameters": {**assumed, symbol.name: word}}
            if _holds(_read_anew(reading, reading.claim.kind, changed), deadline):
                return f"right only for {symbol} {sign} 0"
    variables = {
        name for key in ("q", "p", "x", "variables", "new_q", "new_p") for name in _names(keys.get(key))
    }
    for name in [n for n in assumed if n not in variables and n in reading.scope.names][:8]:
        if time.monotonic() > deadline:
            return ""
        if _holds(replace(reading, at=MappingProxyType({reading.scope.names[name]: sp.S.One})), deadline):
            return f"right only for {name} = 1"
    return ""


def one_change(reading: Reading, deadline: float) -> str:
    """Return one change in the answer that makes the whole claim right."""
    answers = list(_answers(reading))
    symbols = tuple(reading.scope.names.values())
    for key, group in groupby(answers, key=lambda answer: answer[0].partition("[")[0]):
        items = list(group)
        if len(items) > 1:
            for slip, change in common_slips([e for _, e in items], symbols):
                if time.monotonic() > deadline:
                    return ""
                trial = reading
                for name, expression in items:
                    trial = trial.with_instead(name, expression.xreplace(dict(slip)))
                if _holds(trial, deadline):
                    return f"in {key} {change}"
    share = (deadline - time.monotonic()) / max(1, len(answers))
    for number, (key, expression) in enumerate(answers, 1):
        until = min(deadline, deadline - share * (len(answers) - number))
        for new, change in chain(_rescaled(key, expression), _named(key, variants(expression, symbols))):
            if time.monotonic() > until:
                break
            if not _trivial(new, reading) and _holds(reading.with_instead(key, new), deadline):
                return change
    return ""


def _rescaled(key: str, expression: Expr) -> Iterator[tuple[Expr, str]]:
    yield -expression, f"{key} has the wrong sign"
    for factor in (sp.Rational(1, 2), sp.Rational(2)):
        yield factor * expression, f"{key} should be {times(factor)} what it is"


def _named(key: str, found: Iterator[tuple[Expr, str]]) -> Iterator[tuple[Expr, str]]:
    return ((new, f"in {key} {change}") for new, change in found)


def _answers(reading: Reading) -> Iterator[tuple[str, Expr]]:
    for key in _ANSWERS.get(reading.claim.kind, ()):
        outer, _, inner = key.partition(".")
        if not reading.has(outer):
            continue
        value = reading.claim.keys[outer]
        if inner:
            items = reading.inside(key, value.get(inner, []))
        elif isinstance(value, list):
            items = reading.expressions(outer)
        elif outer == "solution":
            yield from ((f"{key}.{name}", item) for name, item in reading.table(key).items())
            continue
        else:
            yield key, reading.expression(key)
            continue
        yield from ((f"{key}[{i}]", item) for i, item in enumerate(items))


def _inverted(reading: Reading) -> Reading:
    """Return the claim with its map read as giving the old variables by the new ones."""
    keys = {key: value for key, value in reading.claim.keys.items() if key != "map"}
    symbols = [reading.symbols(key) for key in ("q", "p", "new_q", "new_p")]
    swap = dict(zip((*symbols[0], *symbols[1]), (*symbols[2], *symbols[3]), strict=True))
    inverted = _read_anew(
        reading, reading.claim.kind, {**keys, "inverse_map": {k: ["0"] * len(symbols[0]) for k in "qp"}}
    )
    for part, name in (("Q", "q"), ("P", "p")):
        for i, f in enumerate(reading.inside(f"map.{part}", reading.claim.keys["map"][part])):
            inverted = inverted.with_instead(f"inverse_map.{name}[{i}]", f.xreplace(swap))
    return inverted


def _trivial(answer: Expr, reading: Reading) -> bool:
    """Whether an answer says nothing any more: a constant of the motion that is constant anyway."""
    variables = {s for key in ("q", "p", "x") if reading.is_names(key) for s in reading.symbols(key)}
    rates = {velocity(s) for s in variables}
    return reading.claim.kind == "constant-of-motion" and not answer.free_symbols & (variables | rates)


def _read_anew(reading: Reading, kind: str, keys: Mapping[str, Any]) -> Reading:
    return Reading(replace(reading.claim, kind=kind, keys=MappingProxyType(dict(keys))))


def _holds(reading: Reading, deadline: float) -> bool:
    from canon.exercise.judge import JUDGES

    left = min(TRIAL_SECONDS, max(0.05, deadline - time.monotonic()))
    try:
        questions = JUDGES[reading.claim.kind](reading)
        return all(decide(question, Deadline.after(left)).holds for question in questions)
    except (Undecided, SingularMatrixError, InvalidClaim, EmptyDomainError):
        return False


def _names(value: object) -> list[str]:
    return (
        [value]
        if isinstance(value, str)
        else [v for v in value if isinstance(v, str)]
        if isinstance(value, list)
        else []
    )
