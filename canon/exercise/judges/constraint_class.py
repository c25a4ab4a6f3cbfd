"""Claims about the class of constraints and the number of degrees of freedom.

Holonomic: all constraints are equations that restrict positions, velocities entering at most as the rate of such an
equation (Frobenius' theorem decides that, all constraints together); an inequality is not (H. Goldstein, Classical
Mechanics, § 1.3). Rheonomic: what is allowed depends explicitly on the time. Unilateral: an inequality.
"""

from __future__ import annotations

import re
import time as clock
from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr

from canon.exercise.question.answer import stay_open
from canon.exercise.question.question import Determines, Question, Stated, fails, opposite
from canon.expression.symbols.symbol import acceleration, velocity
from canon.expression.symbols.user_input import counted
from canon.mechanics.lagrange.constraint_system import ConstraintSystem
from canon.proof.domain.verdict import Status, Undecided, Verdict, all_hold

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.exercise.sheet.reading import Reading

__all__ = ["constraint_class", "degrees_of_freedom"]

_PAIRS = (("holonomic", "nonholonomic"), ("scleronomic", "rheonomic"), ("bilateral", "unilateral"))
_WORDS_APART = re.compile(r"\s*[,;]\s*(?:and\s+)?|\s+and\s+")
_RELATION_OR_BRACKET = re.compile(
    r"(?P<open>[(\[{]|\\begin\b)|(?P<close>[)\]}]|\\end\b)|<=|>=|<|>|=|≤|≥|\\leq?\b|\\geq?\b"
)


def constraint_class(reading: Reading) -> Iterator[Question]:
    """Each word of the claim is right for the constraints as a whole."""
    constraints = _constraints(reading)
    words = [_spelled(word) for said in reading.words("class") for word in _WORDS_APART.split(said.strip())]
    pairs = [_pair_of(reading, i, word) for i, word in enumerate(words)]
    verdicts: list[Verdict] = []
    for word, pair in zip(words, pairs, strict=True):
        first = _first_of(pair, constraints)
        verdict = first if word == pair[0] else opposite(first, "")
        verdicts.append(verdict.about(word))
        if verdict.fails:
            yield _wrong_word(verdict, word, pairs[: len(verdicts)], constraints)
            return
    yield Stated(all_hold(verdicts))
    untold = [" or ".join(pair) for pair in _PAIRS if pair not in pairs]
    yield Determines(lambda: stay_open(untold))


def _spelled(word: str) -> str:
    """Return a word as it is spelled here, ``Non-holonomic`` and ``scleronomous`` too.

    Examples
    --------
    >>> _spelled("Non-holonomic"), _spelled("rheonomous"), _spelled("round")
    ('nonholonomic', 'rheonomic', 'round')
    """
    plain = re.sub(r"[\s_-]+", "", word.lower()).removesuffix("ous")
    return {"anholonomic": "nonholonomic", "scleronom": "scleronomic", "rheonom": "rheonomic"}.get(
        plain, plain
    )


def _pair_of(reading: Reading, i: int, word: str) -> tuple[str, str]:
    found = next((pair for pair in _PAIRS if word in pair), None)
    if found is None:
        known = sorted(word for pair in _PAIRS for word in pair)
        reading.fault(f"class[{i}]", f"should be one of {', '.join(known)}")
    return found


def _wrong_word(
    verdict: Verdict, word: str, asked: Sequence[tuple[str, str]], constraints: ConstraintSystem
) -> Stated:
    """Return FAILS for a word, with why the other is right, and the right words of all pairs asked about so far."""
    firsts = [(pair, _first_of(pair, constraints)) for pair in asked]
    right = [pair[0] if first.holds else pair[1] if first.fails else "?" for pair, first in firsts]
    certificate = verdict.certificate if verdict.counterexample else "exact"
    said = replace(verdict, question=word, certificate=certificate, feedback=_why(right[-1], constraints))
    return Stated(said, lambda: ", ".join(right))


def degrees_of_freedom(reading: Reading) -> Iterator[Question]:
    """n coordinates less the constraints that are independent; ``positions`` counts only those that are integrable."""
    constraints = _constraints(reading)
    counting = reading.word("counting") if reading.has("counting") else "velocities"
    if counting not in ("velocities", "positions"):
        reading.fault("counting", "write velocities or positions")
    claimed = reading.expression("dof")
    if not isinstance(claimed, sp.Integer):
        reading.fault("dof", "should be a whole number")
    right = constraints.freedom(counting)
    if int(claimed) == right:
        yield Verdict(Status.HOLDS, "degrees of freedom", "exact")
        return
    n, m = len(constraints.q), len(constraints.q) - right
    what = f"constraint{'s' * (m != 1)}" + (" on positions" if counting == "positions" else "")
    why = f"{counted(n, 'coordinate')} less {m} independent {what} leave {right}, not {claimed}"
    names = {"velocities": "independent virtual displacements", "positions": "positions that can be reached"}
    other = next(key for key in names if key != counting)
    try:
        if constraints.freedom(other) == int(claimed):
            why += f"; {claimed} is the number of {names[other]}"
    except Undecided:  # then the feedback says less
        pass
    yield Stated(fails("degrees of freedom", why), lambda: sp.Integer(right))


def _constraints(reading: Reading) -> ConstraintSystem:
    q, t = reading.symbols("q"), reading.time
    v = tuple(velocity(x) for x in q)
    given = reading.claim.keys.get("constraints", [])
    equations: list[Expr] = []
    inequalities: list[Expr] = []
    for i, text in enumerate(given if isinstance(given, list) else [given]):
        for relation, f in _relations(reading, f"constraints[{i}]", str(text)):
            (equations if relation == "=" else inequalities).append(f)
    for i, f in enumerate((*equations, *inequalities)):
        if not f.has(*q, *v):
            reading.fault(f"constraints[{i}]", "this constrains no coordinate and no velocity")
    return ConstraintSystem(
        q,
        tuple(f for f in equations if not f.has(*v)),
        tuple(g for g in equations if g.has(*v)),
        tuple(inequalities),
        reading.domain,
        clock.monotonic() + 0.8 * reading.claim.budget,
        t,
    )


def _relations(reading: Reading, where: str, text: str) -> Iterator[tuple[str, Expr]]:
    """Yield each relation in a constraint, with the difference of its sides; an expression alone is one that is = 0."""
    latex = text.strip().startswith("$")
    pieces = _at_relations(text.strip().strip("$") if latex else text)
    if pieces[1::2] in ([], ["="]):
        sides: tuple[Expr, ...] = (reading.constraint(where, text),)
    else:
        sides = reading.inside(where, [f"${p}$" if latex else p for p in pieces[::2]])
    if any(side.has(*(acceleration(x) for x in reading.symbols("q"))) for side in sides):
        reading.fault(where, "a constraint holds no accelerations")
    if len(sides) == 1:
        yield "=", sides[0]
    for left, relation, right in zip(sides, pieces[1::2], sides[1:], strict=False):
        yield relation, left - right


def _at_relations(text: str) -> list[str]:
    """Return the sides of a text and the relations between them; one inside brackets says when a piece applies.

    Examples
    --------
    >>> _at_relations("x - Piecewise((1, t > 3), (2, True)) >= 0"), _at_relations("0 < x")
    (['x - Piecewise((1, t > 3), (2, True)) ', '>=', ' 0'], ['0 ', '<', ' x'])
    """
    pieces, start, depth = list[str](), 0, 0
    for found in _RELATION_OR_BRACKET.finditer(text):
        bracket = found["open"] or found["close"]
        depth += 0 if not bracket else 1 if found["open"] else -1
        if not bracket and depth == 0:
            pieces += [text[start : found.start()], found[0]]
            start = found.end()
    return [*pieces, text[start:]]


def _first_of(pair: tuple[str, str], constraints: ConstraintSystem) -> Verdict:
    """Return whether the first word of a pair is the right one."""
    one_sided = bool(constraints.inequalities)
    if pair[0] == "scleronomic":
        return constraints.at_rest_in_time
    if one_sided:
        return fails(pair[0], "")
    if pair[0] == "bilateral":
        return Verdict(Status.HOLDS, "bilateral", "structure")
    return constraints.integrable


def _why(right: str, constraints: ConstraintSystem) -> str:
    """Say why a word is the right one."""
    match right:
        case "holonomic" if constraints.velocities:
            return "holonomic: the constraint on the velocities is integrable, it is the rate of one on positions"
        case "holonomic":
            return "holonomic: equations among the coordinates and the time only"
        case "nonholonomic" if constraints.inequalities:
            why = "nonholonomic: an inequality is no equation among the coordinates"
            return f"{why} (some call it holonomic and unilateral)"
        case "nonholonomic":
            return "nonholonomic: the constraint on the velocities is not integrable"
        case "scleronomic":
            return "scleronomic: what is allowed does not depend on the time"
        case "rheonomic":
            return "rheonomic: the time occurs explicitly"
        case "unilateral":
            return "unilateral: an inequality leaves one side free"
        case _:
            return "bilateral: the constraints are equations"
