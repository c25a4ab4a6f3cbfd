"""Counterexamples: points of the domain where two sides certainly differ."""

from __future__ import annotations

import random
import time
from dataclasses import dataclass, field
from itertools import combinations
from typing import TYPE_CHECKING, cast

import sympy as sp
from flint import acb, arb
from sympy.core.function import AppliedUndef, Derivative, Subs
from sympy.core.relational import Relational

from canon.proof.anatomy import Anatomy, anatomy
from canon.proof.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.typed import free_symbols, rational
from canon.proof.verdict import Counterexample

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.proof.domain import Domain

__all__ = [
    "Search",
    "evaluated",
    "first_counterexample",
    "look_for_counterexample",
    "search_widely",
    "with_example_functions",
]

HIGHEST_PRECISION = 3200
"""Bits after which a point that has not decided is left."""


SCREEN_BITS = 128
"""Precision at which many expressions are screened together."""

LARGEST_GAP = 200
"""Size of an argument whose zeros are looked for."""


@dataclass
class Search:
    """What evaluating two sides at points has shown."""

    counterexample: Counterexample | None = None
    agreements: int = 0
    digits: int = 0
    unmodelled: str = ""
    tried: int = 0
    functions: dict[str, str] = field(default_factory=dict[str, str])

    @property
    def known(self) -> str:
        """What is known, in words."""
        if self.unmodelled:
            return self.unmodelled
        if not self.agreements:
            return "no point of the domain was found where both sides have a value"
        return f"agreement at {self.agreements} points to {self.digits} digits"


def look_for_counterexample(
    left: Expr,
    right: Expr,
    points: Iterable[Mapping[Symbol, sp.Rational]],
    *,
    highest: int,
    deadline: float,
    search: Search | None = None,
) -> Search:
    """Evaluate both sides at points of the domain until they certainly differ somewhere.

    Parameters
    ----------
    left, right
        The two sides.
    points
        Exact points; the same for both sides.
    highest
        Bits of precision at most.
    deadline
        Value of :func:`time.monotonic` to stop at.
    search
        What was found before, to be added to.
    """
    result = search or Search()
    sides = (left, right)
    has_functions = anatomy(sides).has(AppliedUndef)
    for number, point in enumerate(points):
        if time.monotonic() > deadline:
            break
        if has_functions:
            (left_there, right_there), result.functions = with_example_functions(
                (left, right), random.Random(number)
            )
            sides = (left_there, right_there)
        result.tried += 1
        if _try_point(sides, point, highest, deadline, result):
            break
        if not point and not has_functions:
            break
    return result


def first_counterexample(
    exprs: Sequence[Expr], domain: Domain, deadline: float, *, points: int = 2
) -> tuple[Search, int | None]:
    """Look for an expression that is certainly not zero at a point, values of common parts being shared."""
    found = anatomy(exprs)
    result = Search()
    shown: Sequence[Expr] = exprs
    for number, point in enumerate(domain.points(found.symbols, points)):
        if found.has(AppliedUndef):
            shown, result.functions = with_example_functions(exprs, random.Random(number))
        with precision(SCREEN_BITS):
            memo: dict[sp.Basic, acb] = {}
            for place, expr in enumerate(shown):
                if time.monotonic() > deadline:
                    return result, None
                try:
                    ball = value(expr, point, memo)
                except (Undefined, NotDecided, Unmodelled):
                    continue
                if not ball.contains(0):
                    _record(ball, acb(0), point, result)
                    return result, place
        result.agreements += 1
    return result, None


def search_widely(left: Expr, right: Expr, domain: Domain, deadline: float) -> Search:
    """Look for a counterexample with high precision, outside the box, and where pieces meet."""
    found = anatomy([left, right])
    symbols = found.symbols
    marks = landmarks(found, domain)
    rounds = (
        (domain.points(symbols, 6, seed=1), 512),
        (domain.points(symbols, 40, seed=2, in_box=False), 128),
        (domain.points(symbols, 60, seed=3, in_box=False, marks=marks), 128),
        (domain.points(symbols, 40, seed=4, marks=marks), 128),
        (domain.points(symbols, 4, seed=1), HIGHEST_PRECISION),
    )
    search = Search()
    for points, highest in rounds:
        look_for_counterexample(left, right, points, highest=highest, deadline=deadline, search=search)
        if search.counterexample is not None or search.unmodelled:
            break
    return search


def landmarks(sides: Anatomy, domain: Domain) -> dict[Symbol, list[sp.Rational]]:
    """Return values at which a symbol may reach a boundary, a kink or a cut, and values beyond them."""
    found: dict[Symbol, set[sp.Rational]] = {s: set(_EVERYWHERE) for s in sides.symbols}
    relations = [r for condition in domain.conditions for r in condition.atoms(Relational)]
    relations.extend(sides.of(Relational))
    places: set[sp.Basic] = {r.lhs - r.rhs for r in relations if isinstance(r.lhs, sp.Expr)}
    places |= {e.args[0] for e in sides.of(sp.Abs, sp.sign, sp.Heaviside, sp.acot, sp.log)}
    places |= {a - b for e in sides.of(sp.Max, sp.Min) for a, b in combinations(e.args, 2)}
    places |= {e.base for e in sides.of(sp.Pow) if not e.exp.is_integer}
    places = {gap for gap in places if anatomy([gap]).tree <= LARGEST_GAP}
    for gap in places:
        for s in free_symbols(gap):
            found.setdefault(s, set()).update(_crossings(cast("Expr", gap), s))
    return {s: sorted(values) for s, values in found.items()}


_EVERYWHERE = tuple(
    rational(sp.Rational(p, q))
    for p, q in ((0, 1), (1, 1), (-1, 1), (2, 1), (-2, 1), (7, 2), (-7, 2), (10, 1))
)


def _crossings(gap: Expr, s: Symbol) -> set[sp.Rational]:
    """Return rationals at and around the zero of ``gap`` in one symbol, other symbols being 0."""
    slope = gap.diff(s)
    if slope.free_symbols or slope.is_zero is not False:
        return set()
    zero = -cast("Expr", gap.xreplace(dict.fromkeys(gap.free_symbols, sp.Integer(0)))) / slope
    if not zero.is_real or not zero.is_finite:
        return set()
    near = zero if isinstance(zero, sp.Rational) else sp.Rational(round(64 * float(zero)), 64)
    steps = (sp.Integer(0), sp.Rational(1, 32), sp.Integer(1), sp.Integer(3))
    around = [near + step for step in steps] + [near - step for step in steps]
    return {rational(number) for number in (*around, 2 * near)}


def _try_point(
    sides: tuple[Expr, Expr],
    point: Mapping[Symbol, sp.Rational],
    highest: int,
    deadline: float,
    result: Search,
) -> bool:
    bits = 64
    while bits <= highest and time.monotonic() < deadline:
        with precision(bits):
            memo: dict[sp.Basic, acb] = {}
            try:
                left, right = (value(side, point, memo) for side in sides)
            except Undefined:
                return False
            except Unmodelled as reason:
                result.unmodelled = str(reason)
                return True
            except NotDecided:
                bits *= 2
                continue
            difference = left - right
            if not difference.contains(0):
                _record(left, right, point, result)
                return True
            agreed = _agreeing_digits(left, right, difference)
        bits *= 2
        if bits > highest:
            result.agreements += 1
            result.digits = max(result.digits, agreed)
    return False


def _agreeing_digits(left: acb, right: acb, difference: acb) -> int:
    """Return how many decimal digits two values certainly share, decimals where one is exactly 0.

    Exactly equal values share 1000.
    """
    spread = abs(difference).upper()
    if spread.is_zero():
        return 1000
    if left.is_zero() or right.is_zero():
        return max(0, int(-float(arb(spread).log().mid()) / 2.302585092994046))
    size = max(abs(left).upper(), abs(right).upper())
    if size.is_zero() or size <= spread:
        return 0
    return int(float((arb(size) / arb(spread)).log().mid()) / 2.302585092994046)


def _record(left: acb, right: acb, point: Mapping[Symbol, sp.Rational], result: Search) -> None:
    names = {s.name: str(number) for s, number in point.items()} | result.functions
    result.counterexample = Counterexample(names, *_texts(left, right))


def _texts(left: acb, right: acb) -> tuple[str, str, int]:
    """Return both values in as many certain digits as tell them apart."""
    one_is_zero = left.is_zero() or right.is_zero()
    lost = 0 if one_is_zero else _agreeing_digits(left, right, left - right)
    digits = min(
        15 + lost, max(1, int(min(left.rel_accuracy_bits(), 10**6) * 0.30103)) if left != 0 else 15 + lost
    )
    return _text(left, 15 + lost), _text(right, 15 + lost), max(1, digits)


def _text(z: acb, digits: int) -> str:
    if z.is_zero():
        return "0"
    real = z.real.str(digits, radius=False)
    if z.imag.is_zero() or (z.imag.contains(0) and not z.real.contains(0)):
        return real
    return f"{real} + ({z.imag.str(digits, radius=False)})*I"


def with_example_functions(
    expressions: Sequence[Expr], chance: random.Random
) -> tuple[tuple[Expr, ...], dict[str, str]]:
    """Put short random polynomials for the arbitrary functions: the claim is for every such function."""
    applied = sorted(set[sp.Basic]().union(*(e.atoms(AppliedUndef) for e in expressions)), key=str)
    chosen: dict[str, str] = {}
    replaced = list(expressions)
    for function, sample in {a.func: a for a in applied}.items():
        places = sp.symbols(f"_u0:{len(sample.args)}", real=True)
        polynomial = _random_polynomial(places, chance)
        shown = polynomial.xreplace(dict(zip(places, sample.args, strict=True)))
        chosen[str(sample)] = str(shown)
        body = sp.Lambda(places, polynomial)
        replaced = [cast("Expr", e.replace(function, body)) for e in replaced]
    return tuple(evaluated(e) for e in replaced), chosen


def _random_polynomial(places: tuple[Symbol, ...], chance: random.Random) -> Expr:
    terms: list[Expr] = [sp.Rational(chance.randint(1, 9), 4)]
    for place in places:
        terms.extend(
            sp.Rational(chance.randint(-6, 6), chance.choice((1, 2, 3))) * place**k for k in (1, 2, 3)
        )
    if len(places) > 1:
        terms.append(chance.randint(1, 5) * sp.Mul(*places))
        terms.append(chance.randint(1, 5) * places[0] ** 2 * places[-1])
    return sp.Add(*terms)


def evaluated(expr: Expr) -> Expr:
    """Carry out the derivatives of what is not an arbitrary function."""
    if not expr.has(Derivative, Subs):
        return expr
    done = expr.replace(
        lambda e: isinstance(e, Derivative | Subs) and not e.has(AppliedUndef), lambda e: e.doit()
    )
    return cast("Expr", done)
