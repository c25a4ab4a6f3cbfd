"""Counterexamples: points of the domain where two sides certainly differ."""

from __future__ import annotations

import random
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import sympy as sp
from flint import acb
from sympy.core.function import AppliedUndef, Derivative, Subs

from canon.proof.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.domain import declared_complex
from canon.proof.verdict import Counterexample

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.proof.domain import Domain

__all__ = ["Search", "look_for_counterexample", "with_example_functions"]

HIGHEST_PRECISION = 3200
"""Bits after which a point that has not decided is left."""


@dataclass
class Search:
    """What evaluating two sides at points has shown."""

    counterexample: Counterexample | None = None
    agreements: int = 0
    digits: int = 0
    apart_where_not_real: str = ""
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
    domain: Domain,
    *,
    points: int,
    highest: int,
    deadline: float,
    seed: int = 0,
    special: bool = False,
    search: Search | None = None,
) -> Search:
    """Evaluate both sides at points of the domain until they certainly differ somewhere.

    A difference where a side is not real only counts if the claim speaks of complex numbers, or if no
    point was found where it is real: a claim is about the points where both sides are defined.
    """
    result = search or Search()
    spoken_complex = any(e.has(sp.I) or any(map(declared_complex, e.free_symbols)) for e in (left, right))
    chance = random.Random(seed)
    sides = (left, right)
    has_functions = any(e.has(AppliedUndef) for e in sides)
    symbols = left.free_symbols | right.free_symbols
    for point in domain.points(symbols, points, seed=seed, special=special):
        if time.monotonic() > deadline:
            break
        if has_functions:
            (left_there, right_there), result.functions = with_example_functions((left, right), chance)
            sides = (left_there, right_there)
        result.tried += 1
        if _try_point(sides, point, highest, deadline, result, complex_counts=spoken_complex):
            break
        if not symbols and not has_functions:
            break
    return result


def _try_point(
    sides: tuple[Expr, Expr],
    point: Mapping[Symbol, sp.Rational],
    highest: int,
    deadline: float,
    result: Search,
    *,
    complex_counts: bool,
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
                return _record(left, right, point, result, complex_counts=complex_counts)
            agreed = _agreeing_digits(left, right, difference)
        bits *= 2
        if bits > highest:
            result.agreements += 1
            result.digits = max(result.digits, agreed)
    return False


def _agreeing_digits(left: acb, right: acb, difference: acb) -> int:
    size = max(float(abs(left).mid()), float(abs(right).mid()), 1e-300)
    spread = abs(difference).upper()
    if spread.is_zero():
        return 1000
    return max(0, int(float((acb(size) / acb(spread)).real.log().mid()) / 2.302585))


def _record(
    left: acb, right: acb, point: Mapping[Symbol, sp.Rational], result: Search, *, complex_counts: bool
) -> bool:
    names = {s.name: str(number) for s, number in point.items()} | result.functions
    result.counterexample = Counterexample(names, *_texts(left, right))
    return True


def _texts(left: acb, right: acb) -> tuple[str, str, int]:
    """Return both values in as many certain digits as tell them apart."""
    difference = abs(left - right)
    size = max(float(abs(left).mid()), float(abs(right).mid()))
    lost = 0
    if size > 0:
        lost = max(0, int(float((acb(size) / acb(difference.mid())).real.log().mid()) / 2.302585))
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
        replaced = [e.replace(function, body) for e in replaced]
    return tuple(_derived(e) for e in replaced), chosen


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


def _derived(expr: Expr) -> Expr:
    if not expr.has(Derivative, Subs):
        return expr
    return expr.replace(lambda e: isinstance(e, Derivative | Subs), lambda e: e.doit())
