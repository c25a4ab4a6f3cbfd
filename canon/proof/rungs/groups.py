"""Groups of terms with the same radicals, each of which may cancel by itself.

In the bracket of the angular momentum of N bodies every pair of bodies cancels for itself. Over one tower all
distances would come to one denominator; a group knows only its own. Zero groups add up to zero, whatever
the other groups are, so nothing has to be known of how the groups depend on each other. Sines and cosines make no
groups: they do depend on each other, and seldom cancel apart.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.proof.trees.anatomy import anatomy

if TYPE_CHECKING:
    from sympy import Expr

__all__ = ["groups"]

LARGEST_BASE = 100
"""Size of a tree up to which what stands below a root is multiplied out to be recognised."""

MOST_TERMS = 5_000
"""Terms into which a sum is multiplied out at most."""


def groups(expr: Expr) -> list[Expr] | None:
    """Return parts that add up to ``expr``, each with other radicals.

    Products are multiplied out only as far as it takes to tell the radicals of their terms apart. None where there
    are fewer than three groups, or where there would be too many terms.

    Examples
    --------
    >>> x, y = sp.symbols("x y", positive=True)
    >>> groups(x*(sp.sqrt(y) + sp.sqrt(x + y) + y) - x*sp.sqrt(y) - x*sp.sqrt(x + y))
    [0, 0, x*y]
    """
    found: dict[frozenset[sp.Basic], list[Expr]] = {}
    radicals = _Radicals()
    waiting: list[Expr] = [expr]
    terms = 0
    while waiting:
        term = waiting.pop()
        if isinstance(term, sp.Add):
            waiting.extend(term.args)
        elif (mixed := _mixed_factor(term, radicals)) is not None:
            others = sp.Mul(*(cast("Expr", f) for f in term.args if f is not mixed))
            waiting.extend(sp.Mul(others, part) for part in mixed.args)
        else:
            found.setdefault(radicals.of(term), []).append(term)
        terms += 1
        if terms + len(waiting) > MOST_TERMS:
            return None
    return [sp.Add(*members) for members in found.values()] if len(found) > 2 else None


def _mixed_factor(term: Expr, radicals: _Radicals) -> sp.Add | None:
    """Return a sum among the factors whose terms have different radicals."""
    if isinstance(term, sp.Mul):
        for factor in term.args:
            if isinstance(factor, sp.Add) and len({radicals.of(a) for a in factor.args}) > 1:
                return factor
    return None


def _in_one_way(base: Expr) -> Expr:
    """Return a sum multiplied out, so that (x − y)² and (y − x)² are told to be the same."""
    found = anatomy([base])
    exponents = [p.exp for p in found.of(sp.Pow)]
    small = found.tree <= LARGEST_BASE and all(isinstance(e, sp.Rational) and abs(e) <= 4 for e in exponents)
    return sp.expand(base) if small else base


class _Radicals:
    """What stands below the outermost roots of expressions, remembered."""

    def __init__(self) -> None:
        self._known: dict[sp.Basic, frozenset[sp.Basic]] = {}

    def of(self, expr: sp.Basic) -> frozenset[sp.Basic]:
        for part in anatomy([expr]).parts if expr not in self._known else ():
            if part not in self._known:
                self._known[part] = self._fresh(part)
        return self._known[expr]

    def _fresh(self, part: sp.Basic) -> frozenset[sp.Basic]:
        if isinstance(part, sp.Pow) and isinstance(part.exp, sp.Rational) and not part.exp.is_Integer:
            return frozenset([_in_one_way(part.base)])
        return frozenset().union(*(self._known[a] for a in part.args))
