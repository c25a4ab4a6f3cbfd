"""A model of slips: wrong answers to questions whose right answers are known, each with the slip that made it.

Questions are the claims of ``tests/data/claims`` that hold, of all kinds whose answer is a formula. A slip changes the
answer in one way that people do: :data:`SLIPS` lists them, each with the mistakes that name it. Which slips a question
gets is drawn with a seed. Questions fall into two halves by a hash of their name: *open* ones, to build with, and
*closed* ones, with another seed, which nobody looks at one by one.
"""

from __future__ import annotations

import hashlib
import json
import random
from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import combinations
from pathlib import Path
from typing import Any

import sympy as sp

from canon.exercise.claim_verdict import Finding, InvalidClaim, examine
from canon.exercise.diagnose.change import Mistake as M  # noqa: N817
from canon.exercise.diagnose.diagnosis import Diagnosis  # noqa: TC001
from canon.exercise.sheet.reading import Reading
from canon.exercise.sheet.sheet import Claim, claim_from
from canon.exercise.sheet.sympy_trees import shown
from canon.expression.symbols.symbol import Coordinate, Momentum, Rate, acceleration, velocity
from canon.proof.rungs.ladder import REFUSALS
from canon.proof.vanish import vanishes

__all__ = [
    "SLIPS",
    "Question",
    "WrongAnswer",
    "half_of",
    "is_named",
    "of_a_question",
    "questions",
    "wrong_answers",
]

CLAIMS = Path(__file__).parents[1] / "data" / "claims"
KINDS = (
    "euler-lagrange", "dissipative", "multiplier-holonomic", "nonholonomic", "legendre-hamiltonian",
    "hamilton-equations", "routhian", "gibbs-appell", "poisson-bracket", "lie-bracket", "canonicity",
    "canonicity-time-dependent", "generating-F1", "generating-F2", "generating-F3", "generating-F4",
    "transformed-hamiltonian-K", "constant-of-motion", "lagrangian-equivalence", "kinetic-energy", "generalized-force",
    "bilinear-covariant", "lagrange-bracket", "linearisation", "solution", "reaction", "equality-only",
)  # fmt: skip
MOST_EQUALITIES = 8
"""Identities without mechanics that are asked."""

Place = tuple[str | int, ...]


@dataclass(frozen=True)
class Question:
    """A claim that holds, and the places of its answer."""

    keys: dict[str, Any]
    places: tuple[Place, ...]

    @property
    def name(self) -> str:
        return self.keys["id"]

    @property
    def reading(self) -> Reading:
        return Reading(claim_from({k: v for k, v in self.keys.items() if k != "expect"}))

    @property
    def is_readable(self) -> bool:
        """Whether all answers are formulas in the declared names: those in differentials are not."""
        try:
            return all(isinstance(self.answer(place), sp.Expr) for place in self.places)
        except InvalidClaim:
            return False

    def answer(self, place: Place) -> sp.Expr:
        """Return the expression at a place; an equation as what should vanish."""
        found: Any = self.keys
        for step in place:
            found = found[step]
        reading, text = self.reading, str(found)
        where = key_of(place)
        return (
            reading.equation(where, text)
            if place[0] in ("claim", "implicit")
            else reading.inside(where, [text])[0]
        )

    def with_answers(self, answers: dict[Place, sp.Expr]) -> dict[str, Any]:
        """Return the keys of the claim with other answers in some places."""
        keys = deepcopy({k: v for k, v in self.keys.items() if k != "expect"})
        for place, answer in answers.items():
            inner: Any = keys
            for step in place[:-1]:
                inner = inner[step]
            inner[place[-1]] = shown(answer)
        return keys


@dataclass(frozen=True)
class WrongAnswer:
    """A wrong answer with the true slip as its label."""

    question: Question
    slip: str
    wrong: dict[Place, sp.Expr]

    @cached_property
    def finding(self) -> Finding:
        """The judgement, by which the answer is known to be wrong."""
        return examine(self.claim)

    @property
    def claim(self) -> Claim:
        return claim_from(
            {**self.question.with_answers(self.wrong), "id": f"{self.question.name}: {self.slip}"}
        )


def key_of(place: Place) -> str:
    """Return the key of a place as a reading has it: claim[0], pairs[1].value, solution.q."""
    text = str(place[0])
    for step in place[1:]:
        text += f"[{step}]" if isinstance(step, int) else f".{step}"
    return text


# --- slips in one expression -----------------------------------------------------------------------------------------

Edit = Callable[[sp.Expr, Reading], Iterator[sp.Expr]]


def in_every_sum(edit: Callable[[sp.Expr, sp.Expr], sp.Expr]) -> Edit:
    """Return the slip that changes one term of one sum, wherever the sum stands."""

    def edited(f: sp.Expr, reading: Reading) -> Iterator[sp.Expr]:
        for node in f.atoms(sp.Add) | ({f} if f.is_Add else set()):
            for term in node.args:
                yield f.xreplace({node: edit(node, term)})

    return edited


def in_every(kind: type | tuple[type, ...], edit: Callable[[Any], Iterator[sp.Expr]]) -> Edit:
    """Return the slip that changes one subexpression of a kind, in one term."""

    def edited(f: sp.Expr, reading: Reading) -> Iterator[sp.Expr]:
        for term in sp.Add.make_args(f):
            for node in term.atoms(kind):
                for new in edit(node):
                    yield f - term + term.xreplace({node: new})

    return edited


def as_a_whole(factor: sp.Expr) -> Edit:
    return lambda f, reading: iter(() if f.is_Add and has_motion(f) else (factor * f,))


def has_motion(f: sp.Expr) -> bool:
    return any(s.name.endswith("_ddot") for s in f.free_symbols)


def factor_lost(f: sp.Expr, reading: Reading) -> Iterator[sp.Expr]:
    for term in sp.Add.make_args(f):
        for factor in sp.Mul.make_args(term):
            if factor.is_Symbol and len(sp.Mul.make_args(term)) > 1:
                yield f - term + term / factor


def inner_factor_lost(f: sp.Expr, reading: Reading) -> Iterator[sp.Expr]:
    """A factor that stands in the argument of a function too, as that of an inner derivative does."""
    for term in sp.Add.make_args(f):
        inside = {
            s for g in term.atoms(sp.Function) for a in g.args if a.is_Mul for s in a.args if s.is_Symbol
        }
        for factor in sp.Mul.make_args(term):
            if factor in inside:
                yield f - term + term / factor


def factor_of_a_bracket(f: sp.Expr, reading: Reading) -> Iterator[sp.Expr]:
    """a(b + c) written as ab + c."""
    for node in f.atoms(sp.Mul):
        sums = [a for a in node.args if a.is_Add]
        if len(sums) == 1 and node != sums[0]:
            rest = node / sums[0]
            for term in sums[0].args:
                yield f.xreplace({node: rest * term + (sums[0] - term)})


def power_off_by_one(f: sp.Expr, reading: Reading) -> Iterator[sp.Expr]:
    for term in sp.Add.make_args(f):
        for node in term.atoms(sp.Pow):
            if node.exp.is_Integer and abs(node.exp) > 1:
                yield f - term + term.xreplace({node: node.base ** (node.exp - sp.sign(node.exp))})
                yield f - term + term.xreplace({node: node.base ** (node.exp + sp.sign(node.exp))})


def upside_down(f: sp.Expr, reading: Reading) -> Iterator[sp.Expr]:
    """g/l written as l/g."""
    for term in sp.Add.make_args(f):
        numerator, denominator = term.as_numer_denom()
        for a in numerator.free_symbols & set(sp.Mul.make_args(numerator)):
            for b in denominator.free_symbols & set(sp.Mul.make_args(denominator)):
                yield f - term + term * b**2 / a**2


def wrong_index(f: sp.Expr, reading: Reading) -> Iterator[sp.Expr]:
    """θ₁ for θ₂ in one function or factor: names that differ in a figure, or coordinates among each other."""
    for a, b in alike(f, reading):
        for old, new in ((a, b), (b, a)):
            for term in sp.Add.make_args(f):
                for node in [*term.atoms(sp.Function), *sp.Mul.make_args(term)]:
                    if node.has(old) and (node.is_Function or node.is_Symbol or node.is_Pow):
                        yield f - term + term.xreplace({node: node.xreplace({old: new})})


def alike(f: sp.Expr, reading: Reading) -> Iterator[tuple[sp.Symbol, sp.Symbol]]:
    symbols = sorted((s for s in f.free_symbols if isinstance(s, sp.Symbol)), key=lambda s: s.name)
    for a, b in combinations(symbols, 2):
        plain = [s.name.translate(str.maketrans("", "", "0123456789")) for s in (a, b)]
        moving = isinstance(a, Coordinate) and isinstance(b, Coordinate)
        if plain[0] == plain[1] or moving or {a.name[:-1], b.name[:-1]} == {"x", "y"}:
            yield a, b


def swapped(f: sp.Expr, reading: Reading) -> Iterator[sp.Expr]:
    for a, b in alike(f, reading):
        yield f.xreplace({a: b, b: a})


def coordinates_of(reading: Reading) -> tuple[sp.Symbol, ...]:
    """Return the coordinates of a claim, none where q has expressions."""
    return reading.symbols("q") if reading.is_names("q") else ()


def unit_parameter(f: sp.Expr, reading: Reading) -> Iterator[sp.Expr]:
    """A parameter taken to be one: right for that value only."""
    variables = (
        s for key in ("q", "p", "x", "new_q", "new_p") if reading.is_names(key) for s in reading.symbols(key)
    )
    names = set(reading.claim.keys.get("parameters", {})) - {s.name for s in variables}
    for s in f.free_symbols:
        if s.name in names and not isinstance(s, Coordinate):
            yield f.xreplace({s: sp.S.One})


def linearised(f: sp.Expr, reading: Reading) -> Iterator[sp.Expr]:
    """Sines and cosines of the coordinates replaced by their values for small angles."""
    small = {g: g.args[0] if isinstance(g, sp.sin) else sp.S.One
             for g in f.atoms(sp.sin, sp.cos) if g.free_symbols & set(coordinates_of(reading))}  # fmt: skip
    if any(isinstance(g, sp.sin) for g in small):
        yield f.xreplace({g: v for g, v in small.items() if isinstance(g, sp.sin)})


def velocity_for_acceleration(f: sp.Expr, reading: Reading) -> Iterator[sp.Expr]:
    for x in coordinates_of(reading):
        a = acceleration(x)
        if f.has(a) and len(sp.Add.make_args(f)) > 1:
            yield f.xreplace({a: velocity(x)})


def velocity_lost(f: sp.Expr, reading: Reading) -> Iterator[sp.Expr]:
    """q written for q̇ in one term."""
    for x in coordinates_of(reading):
        for term in sp.Add.make_args(f):
            if isinstance(x, Coordinate) and term.has(velocity(x)):
                yield f - term + term.xreplace({velocity(x): x})


TWINS = {sp.sin: sp.cos, sp.cos: sp.sin, sp.sinh: sp.cosh, sp.cosh: sp.sinh, sp.tan: sp.cot, sp.cot: sp.tan,
         sp.asin: sp.acos, sp.acos: sp.asin}  # fmt: skip
TRIG = (sp.sin, sp.cos, sp.tan)
TERM = {
    M.TERM_SIGN,
    M.MULTIPLIERS_OPPOSITE,
    M.REACTIONS_OPPOSITE,
    M.TIME_DERIVATIVE_SIGN,
    M.WRONG_SIGN,
    M.SIGN_OF,
    M.BRACKET_OPPOSITE,
    M.OPPOSITE_CONVENTION,
    M.MAP_MENDED,
    M.RULE_OPPOSITE,
    M.DERIVATIVE_NOT_TOTAL_IN,
}
FACTOR = {
    M.TERM_FACTOR,
    M.WRONG_FACTOR,
    M.FACTOR_MISSING,
    M.VALENCE,
    M.MAP_MENDED,
    M.FACTOR_OF_COVARIANT,
    M.NUMBER,
    M.DERIVATIVE_NOT_TOTAL_IN,
}
LOST = {M.FACTOR_MISSING, M.EXPONENT, M.VALENCE, M.MAP_MENDED, M.DIVISOR_MISSING}
POWER = {M.EXPONENT, M.FACTOR_MISSING, M.FACTOR_SUPERFLUOUS, M.DIVISOR_MISSING, M.SQUARE}
MISSING = {
    M.TERM_MISSING,
    M.TERM_MISSING_IN,
    M.CORIOLIS_TERM_MISSING,
    M.DERIVATIVE_NOT_TOTAL,
    M.DERIVATIVE_NOT_TOTAL_IN,
    M.TIME_DERIVATIVE_MISSING,
    M.TIME_TERM_MISSING,
}
SMALL = {M.FUNCTION_MISSING, M.FUNCTION, M.ONLY_SMALL}

SLIPS: dict[str, tuple[Edit, set[M]]] = {
    "sign": (in_every_sum(lambda node, term: node - 2 * term), TERM),
    "term lost": (in_every_sum(lambda node, term: node - term), MISSING),
    "half": (in_every_sum(lambda node, term: node - term / 2), FACTOR),
    "twice": (in_every_sum(lambda node, term: node + term), FACTOR),
    "sign of all": (as_a_whole(sp.S.NegativeOne), TERM),
    "half of all": (as_a_whole(sp.S.Half), FACTOR | {M.EXPONENT}),
    "factor lost": (factor_lost, LOST),
    "inner derivative": (inner_factor_lost, LOST),
    "factor of a bracket": (factor_of_a_bracket, LOST | {M.TERM_FACTOR}),
    "cos for sin": (in_every(tuple(TWINS), lambda g: iter((TWINS[g.func](g.args[0]),))), {M.FUNCTION}),
    "angle for sine": (in_every(TRIG, lambda g: iter(g.args)), SMALL),
    "double angle": (in_every(TRIG, lambda g: iter((g.func(2 * g.args[0]),))), {M.ARGUMENT}),
    "sign in a function": (in_every(sp.Function, lambda g: (g.func(*(h,)) for h in flipped(g))),
                           {M.TERM_SIGN, M.ARGUMENT, M.SIGN_OF}),
    "power": (power_off_by_one, POWER),
    "upside down": (upside_down, {M.UPSIDE_DOWN}),
    "branch": (in_every(sp.Pow, lambda g: iter((-g,) if g.exp == sp.S.Half else ())), TERM),
    "index": (wrong_index, {M.SYMBOL, M.SYMBOLS_EXCHANGED}),
    "exchanged": (swapped, {M.SYMBOLS_EXCHANGED, M.SYMBOL}),
    "parameter one": (unit_parameter, {M.ONLY_FOR, M.FACTOR_MISSING, M.EXPONENT}),
    "linearised": (linearised, SMALL),
    "velocity for acceleration": (velocity_for_acceleration, {M.SYMBOL}),
    "coordinate for velocity": (velocity_lost, {M.SYMBOL}),
}  # fmt: skip
"""Slips in one expression by name, each with the mistakes that name it."""


def flipped(g: sp.Expr) -> Iterator[sp.Expr]:
    if len(g.args) == 1 and g.args[0].is_Add:
        for term in g.args[0].args:
            yield g.args[0] - 2 * term


# --- slips in the derivation -----------------------------------------------------------------------------------------


def partial_for_total(question: Question) -> Iterator[dict[Place, sp.Expr]]:
    """∂/∂t of ∂L/∂q̇ at fixed positions: Σ ∂²L/∂q̇∂q̇ q̈ − ∂L/∂q, in the claim's own scale."""
    reading = question.reading
    if not (
        reading.kind.judge == "lagrangian.euler_lagrange"
        and len(question.places) == len(reading.symbols("q"))
    ):
        return
    L, q = reading.expression("L"), reading.symbols("q")
    for place, x in zip(question.places, q, strict=True):
        claimed, p = question.answer(place), L.diff(velocity(x))
        lost = sum(p.diff(y) * velocity(y) for y in q) + p.diff(reading.time)
        above, below = claimed.diff(acceleration(x)), p.diff(velocity(x))
        if lost != 0 and below != 0 and above != 0:
            yield {place: sp.expand(claimed) - sp.expand(sp.cancel(above / below) * lost)}


def opposite_multipliers(question: Question) -> Iterator[dict[Place, sp.Expr]]:
    reading = question.reading
    if not reading.has("multipliers"):
        return
    minus = {s: -s for s in reading.symbols("multipliers")}
    changed = {
        p: question.answer(p).xreplace(minus) for p in question.places if question.answer(p).has(*minus)
    }
    if changed:
        yield changed


def time_derivative_forgotten(question: Question) -> Iterator[dict[Place, sp.Expr]]:
    """K = H in the new variables, with an inverse map that holds the time."""
    reading = question.reading
    if not (reading.has("K") and reading.has("inverse_map")):
        return
    maps = reading.lists("inverse_map", {"q": "q", "p": "p"})
    there = dict(zip((*reading.symbols("q"), *reading.symbols("p")), (*maps[0], *maps[1]), strict=True))
    plain = reading.expression("H").subs(there, simultaneous=True)
    if any(f.has(reading.time) for f in (*maps[0], *maps[1])):
        yield {("K",): sp.trigsimp(sp.expand(plain))}


def equations_exchanged(question: Question) -> Iterator[dict[Place, sp.Expr]]:
    reading = question.reading
    if reading.has("q_dot") and reading.has("p_dot"):
        n = len(reading.symbols("q"))
        right = {p: question.answer(p) for p in question.places}
        other = {"q_dot": "p_dot", "p_dot": "q_dot"}
        if len(right) == 2 * n:
            yield {p: right[other[str(p[0])], p[1]] for p in right}


def sign_of_a_bracket(question: Question) -> Iterator[dict[Place, sp.Expr]]:
    """{f, g} for {g, f} in all pairs."""
    if question.reading.has("pairs"):
        yield {p: -question.answer(p) for p in question.places}


DERIVATIONS: dict[str, tuple[Callable[[Question], Iterator[dict[Place, sp.Expr]]], set[M]]] = {
    "partial for total derivative": (partial_for_total, MISSING),
    "multipliers of the other sign": (opposite_multipliers, {M.MULTIPLIERS_OPPOSITE, M.REACTIONS_OPPOSITE,
                                                              M.TERM_SIGN, M.SIGN_OF, M.WRONG_SIGN}),
    "∂F/∂t forgotten": (time_derivative_forgotten, {M.TIME_DERIVATIVE_MISSING, M.TERM_MISSING}),
    "equations exchanged": (equations_exchanged, {M.EQUATIONS_EXCHANGED, M.SYMBOL, M.SYMBOLS_EXCHANGED}),
    "brackets reversed": (sign_of_a_bracket, TERM),
}  # fmt: skip
"""Slips in the derivation as a whole."""
TWO = "two slips"


@cache
def questions() -> tuple[Question, ...]:
    """Return every question, in a fixed order."""
    found: list[Question] = []
    for kind in KINDS:
        claims = json.loads((CLAIMS / f"{kind}.json").read_text("utf-8"))["claims"]
        right = [c for c in claims if c.get("expect") == "holds"]
        for keys in right[:MOST_EQUALITIES] if kind == "equality-only" else right:
            question = Question(keys, tuple(_places(keys)))
            if question.places and question.is_readable:
                found.append(question)
    return tuple(found)


def _places(keys: dict[str, Any]) -> Iterator[Place]:
    for key in Reading(claim_from(keys)).kind.answer:
        value = keys.get(key)
        if key == "pairs":
            yield from ((key, i, "value") for i in range(len(value)))
        elif isinstance(value, dict):
            yield from ((key, name) for name in value)
        elif isinstance(value, list):
            yield from ((key, i) for i in range(len(value)))
        elif isinstance(value, str):
            yield (key,)


def half_of(question: Question) -> str:
    """Return ``open`` for a question to build with, ``closed`` for the others."""
    return "open" if hashlib.sha256(question.name.encode()).digest()[0] % 2 == 0 else "closed"


def wrong_answers(half: str, each: int = 7, part: int = 0, parts: int = 1) -> Iterator[WrongAnswer]:
    """Yield wrong answers to the questions of one half, or to every few of them; each is judged to be wrong."""
    asked = [question for question in questions() if half_of(question) == half]
    for question in asked[part::parts]:
        yield from of_a_question(question, each)


def of_a_question(question: Question, each: int = 7) -> Iterator[WrongAnswer]:
    """Yield wrong answers to one question, every slip at most once."""
    found, chance = 0, random.Random(f"{half_of(question)} {question.name}")
    names = [*SLIPS, TWO]
    chance.shuffle(names)
    for name in [*DERIVATIONS, *names]:
        for wrong in _slipped(question, name, chance):
            answer = WrongAnswer(question, name, wrong)
            if _fails(answer):
                yield answer
                found += 1
                break
        if found >= each:
            return


def _slipped(question: Question, name: str, chance: random.Random) -> Iterator[dict[Place, sp.Expr]]:
    """Yield a few answers with one slip, in a random order."""
    if name in DERIVATIONS:
        yield from DERIVATIONS[name][0](question)
        return
    places = list(question.places)
    chance.shuffle(places)
    if name == TWO:
        first, second = (
            chance.choice(("sign", "half", "twice", "term lost", "factor lost")) for _ in range(2)
        )
        if len(places) > 1:
            lists = (
                _in(question, place, slip, chance)
                for place, slip in zip(places, (first, second), strict=False)
            )
            for a, b in zip(*lists, strict=False):
                yield {**a, **b}
        return
    for place in places:
        yield from _in(question, place, name, chance)


def _in(question: Question, place: Place, name: str, chance: random.Random) -> Iterator[dict[Place, sp.Expr]]:
    right = question.answer(place)
    if right.has(sp.Derivative) and right.has(sp.Subs):
        return
    edit, _ = SLIPS[name]
    found = [
        f for f in dict.fromkeys(edit(right, question.reading)) if f != right and f != 0 and not f.is_number
    ]
    found.sort(key=str)
    chance.shuffle(found)
    yield from ({place: f} for f in found[:3] if not f.has(sp.nan, sp.zoo, sp.oo))


def _fails(answer: WrongAnswer) -> bool:
    try:
        return answer.finding.verdict.fails
    except (InvalidClaim, *REFUSALS):
        return False


def accepted(slip: str) -> set[M]:
    """Return the mistakes that name a slip."""
    return (SLIPS[slip] if slip in SLIPS else DERIVATIONS[slip])[1]


STATED = {M.TIME_DERIVATIVE_MISSING, M.TIME_DERIVATIVE_SIGN, M.ONLY_SMALL, M.ONLY_FOR, M.EQUATIONS_EXCHANGED,
          M.OPPOSITE_CONVENTION, M.BRACKET_OPPOSITE, M.VALENCE, M.MAP_MENDED, M.RULE_OPPOSITE,
          M.MULTIPLIERS_OPPOSITE, M.REACTIONS_OPPOSITE, M.FACTOR_OF_COVARIANT}  # fmt: skip
"""Mistakes of the claim as a whole, which name their slip whatever is repaired."""


def is_named(answer: WrongAnswer, found: Diagnosis | None) -> bool:
    """Whether a diagnosis names the slip: a mistake of its kind, and the right answer in the same place."""
    if found is None:
        return False
    if found.instead is not None and is_named(answer, found.instead):
        return True  # nothing in the claim tells which of two components was meant: both are told
    mistakes = {change.mistake for change in found.changes}
    if answer.slip == TWO:
        return len(found.changes) >= 2 and found.repaired is not None and _is_undone(answer, found.repaired)
    if not mistakes & accepted(answer.slip):
        return False
    return bool(mistakes & STATED) or (found.repaired is not None and _is_undone(answer, found.repaired))


def _is_undone(answer: WrongAnswer, repaired: Reading) -> bool:
    """Whether the repaired claim has the right answers again in the places where they were changed."""
    for place in answer.wrong:
        key, right = key_of(place), answer.question.answer(place)
        now = repaired.instead.get(key)
        if now is None:
            return False
        ratio = sp.cancel(now / right) if place[0] in ("claim", "I") else sp.S.One
        if any(isinstance(s, Coordinate | Rate | Momentum) for s in ratio.free_symbols):
            return False  # an equation or a constant of the motion may be multiplied with a constant
        if not vanishes(now - ratio * right, repaired.domain, budget=2.0).holds:
            return False
    return True
