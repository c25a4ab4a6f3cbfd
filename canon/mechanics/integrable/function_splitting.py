"""Functions split into sums and products of functions of single variables, each split proved by the zero test."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.proof.domain.declarations import allows, said_of
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from canon.proof.domain.domain import Domain

__all__ = ["common_factor", "factored", "have_values", "product_parts", "reference_places", "sum_parts"]

SECONDS = 2.0
"""Time for the proof of one split."""

MOST_PLACES = 12
"""Reference places that are tried."""


def sum_parts(f: Expr, groups: Sequence[Collection[Symbol]], domain: Domain) -> list[Expr] | None:
    """Return functions of one group of variables each whose sum is f, or None where none were found.

    What depends on no group goes to the last. Terms that mix the groups are looked at together: with a reference place
    r, m(x, y) = m(x, r) + m(r, y) − m(r, r) if it is a sum at all, and that is proved.

    Examples
    --------
    >>> from canon.proof.domain.domain import EVERYWHERE
    >>> x, y = sp.symbols("x y", positive=True)
    >>> sum_parts((x**2 - y**2)/(x - y), [[x], [y]], EVERYWHERE)
    [x, y]
    >>> sum_parts(x*y, [[x], [y]], EVERYWHERE) is None
    True
    """
    sums, rest = [sp.S.Zero for _ in groups], f
    for rewritten in (sp.expand, _cancelled, _by_sines):
        parts, mixed = _sorted_by_group(sp.Add.make_args(rewritten(rest)), groups)
        sums = [sp.Add(known, *part) for known, part in zip(sums, parts, strict=True)]
        rest = sp.Add(*mixed)
        if rest == 0:
            return sums
    for place in reference_places(groups):
        at_place = substitute(rest, place)
        pieces = [substitute(rest, _elsewhere(place, group)) - at_place for group in groups]
        pieces[-1] += at_place
        if have_values(pieces) and vanishes(rest - sp.Add(*pieces), domain, SECONDS).holds:
            return [known + piece for known, piece in zip(sums, pieces, strict=True)]
    return None


def product_parts(f: Expr, groups: Sequence[Collection[Symbol]], domain: Domain) -> list[Expr] | None:
    """Return functions of one group of variables each whose product is f ≠ 0, or None where none were found.

    Examples
    --------
    >>> from canon.proof.domain.domain import EVERYWHERE
    >>> x, y = sp.symbols("x y", positive=True)
    >>> product_parts(x**2*y + x**2, [[x], [y]], EVERYWHERE)
    [x**2, y + 1]
    >>> product_parts(x + y, [[x], [y]], EVERYWHERE) is None
    True
    """
    product = sp.factor_terms(f)
    parts, mixed = _sorted_by_group(sp.Mul.make_args(product), groups)
    if mixed:
        product = factored(f)
        parts, mixed = _sorted_by_group(sp.Mul.make_args(product), groups)
    products = [sp.Mul(*part) for part in parts]
    rest = sp.Mul(*mixed)
    if rest == 1:
        return products
    for place in reference_places(groups):
        at_place = substitute(rest, place)
        if not have_values([at_place]) or at_place == 0:
            continue
        pieces = [substitute(rest, _elsewhere(place, group)) for group in groups]
        pieces[-1] /= at_place ** (len(groups) - 1)
        if have_values(pieces) and vanishes(rest - sp.Mul(*pieces), domain, SECONDS).holds:
            return [known * piece for known, piece in zip(products, pieces, strict=True)]
    return None


def _sorted_by_group(
    pieces: Sequence[sp.Basic], groups: Sequence[Collection[Symbol]]
) -> tuple[list[list[Expr]], list[Expr]]:
    """Sort terms or factors by the one group that each depends on; those that depend on several come apart."""
    parts: list[list[Expr]] = [[] for _ in groups]
    mixed: list[Expr] = []
    for piece in cast("Sequence[Expr]", pieces):
        found = [i for i, group in enumerate(groups) if group and piece.has(*group)]
        (mixed if len(found) > 1 else parts[found[0] if found else -1]).append(piece)
    return parts, mixed


def _cancelled(f: Expr) -> Expr:
    try:
        return cast("Expr", sp.expand(sp.cancel(f)))
    except sp.PolynomialError:  # such as Piecewise: f stays as it is
        return f


def _by_sines(f: Expr) -> Expr:
    """Return f multiplied out with cos² = 1 − sin² and cosh² = 1 + sinh²."""
    squares = {
        g: 1 - sp.sin(g.base.args[0]) ** 2 if isinstance(g.base, sp.cos) else 1 + sp.sinh(g.base.args[0]) ** 2
        for g in f.atoms(sp.Pow)
        if isinstance(g.base, sp.cos | sp.cosh) and g.exp == 2
    }
    return cast("Expr", sp.expand(exchanged(f, squares)))


def factored(f: Expr) -> Expr:
    """Return f in factors where SymPy can, else f as it stands."""
    try:
        return cast("Expr", sp.factor(f))
    except sp.PolynomialError:
        return f


def common_factor(entries: Sequence[Expr]) -> Expr:
    """Return the powers that stand in each of the entries that are not zero, which are products."""
    powers = [f.as_powers_dict() for f in entries if f != 0]
    shared = set.intersection(*(set(each) for each in powers)) if powers else set()
    least = {base: min((each[base] for each in powers), key=sp.default_sort_key) for base in shared}
    return sp.Mul(*(base**e for base, e in least.items() if all(each[base] == e for each in powers)))


def reference_places(groups: Sequence[Collection[Symbol]]) -> Iterator[dict[Symbol, Expr]]:
    """Return reference places: the same plain value for each variable that may have it."""
    variables = sorted({s for group in groups for s in group}, key=str)
    plain: list[Expr] = [sp.S.Zero, sp.pi / 2, sp.S.One, sp.Integer(2), sp.S.Half, sp.Rational(1, 3)]
    for turn in range(min(MOST_PLACES, 2 * len(plain))):
        shift = turn // len(plain)
        chosen: dict[Symbol, Expr] = {}
        for k, s in enumerate(variables):
            candidates = [v for v in plain if _may_be(s, v)]
            if candidates:
                chosen[s] = candidates[(turn + shift * k) % len(candidates)]
        if len(chosen) == len(variables):
            yield chosen


def _may_be(symbol: Symbol, number: Expr) -> bool:
    facts = said_of(symbol)
    if isinstance(number, sp.Rational):
        return allows(facts, number)
    return symbol.is_negative is not True and symbol.is_rational is not True and symbol.is_integer is not True


def _elsewhere(place: dict[Symbol, Expr], group: Collection[Symbol]) -> dict[Symbol, Expr]:
    return {s: value for s, value in place.items() if s not in group}


def have_values(pieces: Sequence[Expr]) -> bool:
    """Whether none of the pieces is infinite or undefined."""
    return not any(piece.has(sp.nan, sp.zoo, sp.oo, -sp.oo) for piece in pieces)
