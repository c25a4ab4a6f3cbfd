"""Book form of a right answer: a few plain forms of it, of which one that is clearly shorter is shown.

The forms are those of algebra: a common factor drawn out, multiplied out, the terms of one coefficient together, over
one denominator in lowest terms, with sin² + cos² = 1 used up. What is too large for one of them is left as it stands;
every size is known before it is tried.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, TypeAlias, cast

import sympy as sp
from sympy import Expr

from canon.expression.symbols.symbol import Coordinate, Momentum, Rate
from canon.mechanics.algebra.substitution import MOST_TERMS, size, terms_if_expanded

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["book_forms"]

Wave: TypeAlias = "type[sp.sin | sp.cos]"

MOST_NODES = 300
MOST_GENERATORS = 14
"""Symbols and functions of a fraction that is brought to lowest terms."""
MOST_DENOMINATORS = 4
"""Different sums below a stroke."""
CLEARLY, OF_A_SHORT_ONE = 0.75, 0.5
"""Part of its length that a form must not exceed to be shown in place of an answer as it stands."""
SHORT = 20
"""Nodes of an answer that anyone reads as it stands."""


@functools.lru_cache(maxsize=256)
def book_forms(f: Expr) -> tuple[Expr, ...]:
    """Return plain forms of an expression that are clearly shorter, the shortest first.

    They are equal by algebra off isolated points; whoever shows one proves it. Those of the last expressions are kept:
    a class has one right answer.

    Examples
    --------
    >>> r, m, w, phi = sp.symbols("r m w phi")
    >>> book_forms(m * r * sp.sin(phi) ** 2 + m * r * sp.cos(phi) ** 2)[0]
    m*r
    >>> book_forms((sp.sin(phi) ** 2 / sp.cos(phi) + sp.cos(phi)) * w)[0]
    w/cos(phi)
    >>> book_forms(m * w**2 - r / 2)
    ()
    """
    if size(f) > MOST_NODES:
        return ()
    longest = (CLEARLY if size(f) > SHORT else OF_A_SHORT_ONE) * size(f)
    found = {form: size(form) for form in _forms(f)}
    short = (form for form, nodes in found.items() if nodes <= longest)
    return tuple(sorted(short, key=lambda g: (found[g], str(g))))


def _forms(f: Expr) -> Iterator[Expr]:
    yield _factored(f)
    if terms_if_expanded(f) > MOST_TERMS:
        return
    expanded = sp.expand(f)
    yield expanded
    yield _factored(expanded)
    yield _by_parameters(expanded)
    for wave, other in ((sp.sin, sp.cos), (sp.cos, sp.sin)):
        if not f.has(wave):
            continue
        shorter = _without_squares(expanded, wave, other)
        yield shorter
        yield _factored(shorter)
        yield _by_parameters(shorter)
    yield from _fractions(f)


def _fractions(f: Expr) -> Iterator[Expr]:
    """Yield an expression over one denominator, in lowest terms, with and without squares of sines."""
    if not _is_small_fraction(f):
        return
    above, below = sp.fraction(sp.together(f))
    if max(terms_if_expanded(above), terms_if_expanded(below)) > MOST_TERMS:
        return
    above, below = sp.expand(above), sp.expand(below)
    waves = [pair for pair in ((sp.sin, sp.cos), (sp.cos, sp.sin)) if f.has(pair[0])]
    for a, b in (
        (above, below),
        *((_without_squares(above, *w), _without_squares(below, *w)) for w in waves),
    ):
        lowest = sp.cancel(a / b) if b != 0 else a
        yield lowest
        yield _factored(lowest)


def _factored(f: Expr) -> Expr:
    return sp.factor_terms(f)


def _by_parameters(f: Expr) -> Expr:
    """Return a sum with the terms together that have the same coefficient, as in (px² + py²)/(2 m)."""
    moving = f.atoms(Coordinate, Rate, Momentum)
    together: dict[Expr, list[Expr]] = {}
    for term in sp.Add.make_args(f):
        coefficient, rest = term.as_independent(*moving, as_Add=False)
        sign = -1 if coefficient.could_extract_minus_sign() else 1
        together.setdefault(sign * coefficient, []).append(sign * rest)
    return sp.Add(*(coefficient * sp.Add(*rest) for coefficient, rest in together.items()))


def _is_small_fraction(f: Expr) -> bool:
    below = {p.base for p in f.atoms(sp.Pow) if p.exp.is_negative}
    generators = f.atoms(sp.Symbol, sp.Function) | {p for p in f.atoms(sp.Pow) if not p.exp.is_Integer}
    sums = [base for base in below if base.is_Add]
    return bool(below) and len(sums) <= MOST_DENOMINATORS and len(generators) <= MOST_GENERATORS


def _without_squares(f: Expr, wave: Wave, other: Wave) -> Expr:
    """Return a sum of products with 1 − cos² for sin², multiplied out, or the other way round."""
    by: dict[Expr, Expr] = {}
    for power in f.atoms(sp.Pow):
        base, exponent = power.base, power.exp
        if isinstance(base, wave) and isinstance(exponent, sp.Integer) and 2 <= exponent <= 6:
            pairs, left = divmod(int(exponent), 2)
            by[power] = base**left * (1 - other(base.args[0]) ** 2) ** pairs
    there = cast("Expr", f.xreplace(by))
    return sp.expand(there) if terms_if_expanded(there) <= MOST_TERMS else there
