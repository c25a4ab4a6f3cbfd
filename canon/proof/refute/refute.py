"""Counterexamples: points of the domain where two sides certainly differ."""

from __future__ import annotations

import random
import time
from dataclasses import dataclass, field
from functools import partial
from itertools import combinations
from typing import TYPE_CHECKING, cast

import sympy as sp
from flint import acb, arb
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational

from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.domain.domain import conditions_hold
from canon.proof.domain.verdict import Counterexample
from canon.proof.refute.corners import corner_points
from canon.proof.refute.sample_functions import with_example_functions
from canon.proof.trees.anatomy import Anatomy, anatomy
from canon.proof.trees.sympy_types import free_symbols, rational

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from sympy import Expr, Symbol
    from sympy.logic.boolalg import Boolean

    from canon.proof.domain.domain import Domain

__all__ = [
    "Search",
    "decimals",
    "first_counterexample",
    "look_for_counterexample",
    "look_in_corners",
    "search_widely",
]

HIGHEST_PRECISION = 3200
"""Bits after which a point that has not decided is left."""

CORNER_BITS = 256
"""Precision at points very close to others."""

SCREEN_BITS = 128
"""Precision at which many expressions are screened together."""

EXACT = 1000
"""Digits that equal values share."""

LARGEST_GAP = 200
"""Size of an argument whose zeros are looked for."""


@dataclass
class Search:
    """What evaluating two sides at points has shown; ``valued`` has the places of those found to have a value."""

    counterexample: Counterexample | None = None
    agreements: int = 0
    digits: int = 0
    agreed: list[Mapping[Symbol, sp.Rational]] = field(default_factory=list["Mapping[Symbol, sp.Rational]"])
    unmodelled: str = ""
    tried: int = 0
    functions: dict[str, str] = field(default_factory=dict[str, str])
    valued: set[int] = field(default_factory=set[int])

    @property
    def known(self) -> str:
        """What is known, in words."""
        if self.unmodelled:
            return self.unmodelled
        if not self.agreements:
            return "no point of the domain was found where both sides have a value"
        if self.digits >= EXACT:
            return f"exact agreement at {self.agreements} points"
        return f"agreement at {self.agreements} points to {self.digits} digits"


def look_for_counterexample(
    left: Expr,
    right: Expr,
    points: Iterable[Mapping[Symbol, sp.Rational]],
    *,
    highest: int,
    deadline: float,
    search: Search | None = None,
    conditions: Sequence[Boolean] = (),
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
    conditions
        Conditions on arbitrary functions, which the functions that are put in should satisfy.
    """
    result = search or Search()
    sides = (left, right)
    has_functions = anatomy(sides).has(AppliedUndef) or bool(conditions)
    for number, point in enumerate(points):
        if time.monotonic() > deadline:
            break
        if has_functions:
            found = _example((left, right), conditions, point, number)
            if found is None:
                continue
            (left_there, right_there), result.functions = found
            sides = (left_there, right_there)
        result.tried += 1
        if _try_point(sides, point, highest, deadline, result):
            break
        if not point and not has_functions:
            break
    return result


def _example(
    exprs: Sequence[Expr], conditions: Sequence[Boolean], point: Mapping[Symbol, sp.Rational], number: int
) -> tuple[Sequence[Expr], dict[str, str]] | None:
    """Put functions that satisfy the conditions at a point for the arbitrary ones."""
    for attempt in range(MOST_EXAMPLES if conditions else 1):
        chance = random.Random(number + 1000 * attempt)
        all_ = (*exprs, *cast("Sequence[Expr]", conditions))
        shown, functions = with_example_functions(all_, chance)
        if conditions_hold(cast("Sequence[Boolean]", shown[len(exprs) :]), point):
            return shown[: len(exprs)], functions
    return None


MOST_EXAMPLES = 12
"""Choices of functions of which one should satisfy the conditions on them."""


def first_counterexample(
    exprs: Sequence[Expr], domain: Domain, deadline: float, *, points: int = 2
) -> tuple[Search, int | None]:
    """Look for an expression that is certainly not zero at a point, values of common parts being shared."""
    found = anatomy(exprs)
    result = Search()
    shown: Sequence[Expr] = exprs
    drawn = domain.points(found.symbols, points, deadline=deadline, but_functions=True)
    for number, point in enumerate(drawn):
        if found.has(AppliedUndef) or domain.on_functions:
            example = _example(exprs, domain.on_functions, point, number)
            if example is None:
                continue
            shown, result.functions = example
        with precision(SCREEN_BITS):
            memo: dict[sp.Basic, acb] = {}
            for place, expr in enumerate(shown):
                if time.monotonic() > deadline:
                    return result, None
                try:
                    ball = value(expr, point, memo)
                except (Undefined, NotDecided, Unmodelled):
                    continue
                result.valued.add(place)
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
    draw = partial(domain.points, symbols, deadline=deadline, but_functions=True)
    rounds = (
        (draw(6, seed=1), 512),
        (draw(40, seed=2, in_box=False), 128),
        (draw(60, seed=3, in_box=False, marks=marks), 128),
        (draw(40, seed=4, marks=marks), 128),
    )
    search = Search()
    for points, highest in (*rounds, (_some(search), HIGHEST_PRECISION)):
        look_for_counterexample(
            left,
            right,
            points,
            highest=highest,
            deadline=deadline,
            search=search,
            conditions=domain.on_functions,
        )
        if search.counterexample is not None or search.unmodelled:
            break
    return search


def look_in_corners(left: Expr, right: Expr, domain: Domain, deadline: float, search: Search) -> Search:
    """Look for a counterexample close to where formulas change, adding to what was found before."""
    if search.unmodelled or search.counterexample is not None:
        return search
    return look_for_counterexample(
        left,
        right,
        corner_points(anatomy([left, right]), domain, deadline),
        highest=CORNER_BITS,
        deadline=deadline,
        search=search,
        conditions=domain.on_functions,
    )


def _some(search: Search) -> Iterator[Mapping[Symbol, sp.Rational]]:
    """Yield four points that agree so far, the first and others spread over what was tried."""
    agreed = list(search.agreed)
    yield from agreed[:: max(1, len(agreed) // 4)][:4]


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
    near = _near(-cast("Expr", gap.xreplace(dict.fromkeys(gap.free_symbols, sp.Integer(0)))) / slope)
    if near is None:
        return set()
    steps = (sp.Integer(0), sp.Rational(1, 32), sp.Integer(1), sp.Integer(3))
    around = [near + step for step in steps] + [near - step for step in steps]
    return {rational(number) for number in (*around, 2 * near)}


def _near(number: Expr) -> sp.Rational | None:
    """Return a rational number itself, or a multiple of 1/64 near a real one."""
    if isinstance(number, sp.Rational):
        return number
    if not number.is_real or not number.is_finite:
        return None
    with precision(SCREEN_BITS):
        try:
            mantissa, exponent = value(64 * number, {}).real.mid().man_exp()
        except (NotDecided, Undefined, Unmodelled):
            return None
    return rational(sp.Rational(sp.floor(sp.Integer(int(mantissa)) * sp.Integer(2) ** int(exponent)), 64))


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
            if not any(point is before for before in result.agreed):
                result.agreed.append(point)
                result.agreements += 1
            result.digits = max(result.digits, agreed)
    return False


def _agreeing_digits(left: acb, right: acb, difference: acb) -> int:
    """Return how many decimal digits two values certainly share, decimals where both may be 0."""
    spread = abs(difference).upper()
    if spread.is_zero():
        return EXACT
    decimals = int(-float(arb(spread).log().mid()) / 2.302585092994046)
    size = max(abs(left).lower(), abs(right).lower())
    if not size > 0:
        return min(max(0, decimals), EXACT - 1)
    shared = int(float((arb(size) / arb(spread)).log().mid()) / 2.302585092994046)
    return min(max(0, shared), EXACT - 1)


def _record(left: acb, right: acb, point: Mapping[Symbol, sp.Rational], result: Search) -> None:
    names = {s.name: str(number) for s, number in point.items()} | result.functions
    result.counterexample = Counterexample(names, *decimals(left, right))


def decimals(left: acb, right: acb | None = None) -> tuple[str, str, int]:
    """Return two values in as many certain digits as tell them apart, zero where the second is left out.

    Examples
    --------
    >>> decimals(acb(1) / 8)
    ('0.125000000000000', '0', 15)
    """
    right = acb(0) if right is None else right
    one_is_zero = left.is_zero() or right.is_zero()
    lost = 0 if one_is_zero else _agreeing_digits(left, right, left - right)
    digits = min(
        15 + lost, max(1, int(min(left.rel_accuracy_bits(), 10**6) * 0.30103)) if left != 0 else 15 + lost
    )
    return _text(left, 15 + lost), _text(right, 15 + lost), max(1, digits)


def _text(z: acb, digits: int) -> str:
    if z.is_zero():
        return "0"
    real = _real_text(z.real, digits)
    if z.imag.is_zero() or (z.imag.contains(0) and not z.real.contains(0)):
        return real
    return f"{real} + ({_real_text(z.imag, digits)})*I"


def _real_text(x: arb, digits: int) -> str:
    """Return a number as text; one of which no digit is certain as what it does not exceed, such as ``0 ± 1.0``."""
    if x.rel_accuracy_bits() > 0 or x.is_zero():
        return x.str(digits, radius=False)
    return f"0 ± {arb(x.abs_upper()).str(2, radius=False)}"
