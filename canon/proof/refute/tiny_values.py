"""Tiny values: differences that are far below what balls of their terms resolve, seen in another form of theirs.

A ball of −2pq + 2pq (1 − e^(−2000)) needs 2900 bits to keep away from zero, one of its normal form −2pq e^(−2000) needs
none: a product is not zero where no factor is. Where the normal form is A + Bρ with ρ² = R, it is (A² − B²R)/(A − Bρ):
√(x² + c) − x is c/(√(x² + c) + x).
"""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.core.function import AppliedUndef

from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.domain.limits import QUICK, Full, OutOfTime, Refine, TooLarge
from canon.proof.domain.verdict import Counterexample
from canon.proof.functions.normal_form import NormalForm
from canon.proof.refute.refute import decimals
from canon.proof.rungs.ladder import MOST_STARTS, REFUSALS
from canon.proof.trees.anatomy import anatomy
from canon.proof.trees.replacement import NoValue, replaced
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator, Mapping
    from typing import Any

    from sympy import Expr, Rational, Symbol

    from canon.proof.domain.domain import Domain
    from canon.proof.refute.refute import Search
    from canon.proof.tower.tower import Fraction

__all__ = ["look_for_tiny_value", "other_forms"]

POINTS = 8
BITS = 128
LARGEST = 400
"""Size of an expression whose normal form is looked at."""

LARGEST_EXPONENT = 100
"""Exponents of e that may be written out."""

_NO_VALUE = (NotDecided, Undefined, Unmodelled)


def look_for_tiny_value(difference: Expr, domain: Domain, deadline: float, search: Search) -> Search:
    """Look for a point where a difference has a value, and another form of it is certainly not zero.

    The forms equal the difference wherever it has a value on the domain, by the identities that also prove what is
    zero; the ball of the difference itself must agree.

    Examples
    --------
    >>> from canon.proof.domain.domain import EVERYWHERE
    >>> from canon.proof.refute.refute import Search
    >>> x = sp.Symbol("x", positive=True)
    >>> tiny = sp.sqrt(x**2 + sp.exp(-9000)) - x
    >>> print(look_for_tiny_value(tiny, EVERYWHERE, time.monotonic() + 1, Search()).counterexample)
    at x = 4/7: 1.95736096805286e-3909 against 0
    """
    found = anatomy([difference])
    if search.unmodelled or search.counterexample or found.has(AppliedUndef) or found.tree > LARGEST:
        return search
    for form in other_forms(difference, domain, deadline):
        for point in domain.points(found.symbols, POINTS, seed=8, deadline=deadline):
            if time.monotonic() > deadline:
                return search
            example = _example(difference, form, point)
            if example is not None:
                return replace(search, counterexample=example)
    return search


def _example(difference: Expr, form: Expr, point: Mapping[Symbol, Rational]) -> Counterexample | None:
    with precision(BITS):
        try:
            plain, other = value(difference, point), value(form, point)
        except _NO_VALUE:
            return None
    if other.contains(0) or not plain.overlaps(other):
        return None
    return Counterexample({s.name: str(number) for s, number in point.items()}, *decimals(other))


def other_forms(expr: Expr, domain: Domain, deadline: float) -> Iterator[Expr]:
    """Yield the normal form of an expression, and that with a square root brought from above to below.

    Examples
    --------
    >>> from canon.proof.domain.domain import EVERYWHERE
    >>> x = sp.Symbol("x", real=True)
    >>> [str(f) for f in other_forms((x + 1) ** 2 - x**2 - 2 * x - sp.exp(x), EVERYWHERE, time.monotonic() + 1)]
    ['1 - exp(x)']
    """
    try:
        named, numbers = _with_names(expr)
    except NoValue:
        return
    parts: dict[Hashable, Any] = {}
    capacity = 16
    for _ in range(MOST_STARTS):
        try:
            forms = NormalForm(domain, parts, deadline, QUICK, capacity)
            f = forms.form(named)
            for form in (forms.fraction_expression(f), *_by_conjugates(forms, f)):
                yield cast("Expr", form.xreplace(numbers))
        except Refine:
            continue
        except Full:
            capacity *= 2
            continue
        except (OutOfTime, TooLarge, *REFUSALS):
            pass
        return


def _with_names(expr: Expr) -> tuple[Expr, dict[sp.Basic, sp.Basic]]:
    """Return an expression with names for exponentials of large numbers, of which no power is written out."""
    names: dict[Expr, sp.Dummy] = {}
    by: dict[sp.Basic, sp.Basic] = {}
    for part in anatomy([expr]).of(sp.exp):
        c, rest = arguments(part)[0].as_coeff_Add()
        if abs(c) > LARGEST_EXPONENT:
            by[part] = names.setdefault(c, sp.Dummy(f"e^{c}", positive=True)) * sp.exp(rest)
    return replaced(expr, by) if by else expr, {name: sp.exp(c) for c, name in names.items()}


def _by_conjugates(n: NormalForm, f: Fraction) -> Iterator[Expr]:
    """Yield (A² − B²R)/(A − Bρ) for each square root ρ of a fraction A + Bρ."""
    t, below = n.tower, n.expression(n.denominator(f))
    above = t.reduce(f.num)
    for k in reversed(t.used(above)):
        relation = t.relation(k)
        if relation is None or relation[0] != 2:
            continue
        a, b = t.coefficients(above, k)
        norm = t.reduce(t.product(a, a) - t.product(t.product(b, b), relation[1]))
        conjugate = a - t.product(b, t.monomial(k))
        yield n.expression(norm) / (n.expression(conjugate) * below)
