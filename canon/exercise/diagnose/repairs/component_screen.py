"""Screen of one component: its values at a few points of the domain, which tell wrong candidates at once."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING

import sympy as sp
from flint import acb
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.cached_property import cached_property
from canon.exercise.diagnose.repairs.unbuilt import Values
from canon.mechanics.algebra.substitution import symbols_of
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value

if TYPE_CHECKING:
    from canon.exercise.diagnose.repairs.unbuilt import Form
    from canon.exercise.question.question import Part
    from canon.proof.domain.domain import Domain

__all__ = ["PRECISION", "Screen"]

POINTS = 3
PRECISION = 128
"""Bits of the values."""


class Screen:
    """Values at a few points of the domain, which tell wrong candidates at once."""

    def __init__(self, part: Part, domain: Domain) -> None:
        self.part = part
        symbols = symbols_of(part.right, part.claimed, *part.through.values())
        self.points: list[dict[sp.Basic, acb]] = []
        self.first: dict[Symbol, sp.Rational] | None = None
        with precision(PRECISION):
            for number, point in enumerate(
                domain.points(
                    (s for s in symbols if s not in part.through), POINTS, seed=11, but_functions=True
                )
            ):
                memo = self.memo(point, number)
                if memo is not None:
                    self.first = self.first or point
                    self.points.append(memo)

    def memo(self, point: dict[Symbol, sp.Rational], number: int) -> dict[sp.Basic, acb] | None:
        """Return the values of symbols and arbitrary functions at a point, of the replaced symbols too."""
        memo: dict[sp.Basic, acb] = {s: value(s, point) for s in point}
        whole = sp.Tuple(self.part.claimed, self.part.right, *self.part.through.values())
        for i, unknown in enumerate(sorted(whole.atoms(AppliedUndef, sp.Derivative, sp.Subs), key=str)):
            memo[unknown] = acb(number + 2) / (i + 3)
        try:
            replaced = {s: value(v, {}, memo) for s, v in self.part.through.items()}
        except (Undefined, NotDecided, Unmodelled):
            return None
        return {**{k: v for k, v in memo.items() if k not in replaced}, **replaced}

    def values(self, expression: Expr) -> list[acb] | None:
        """Return the values of an expression in the claim's symbols, None where it has none."""
        try:
            with precision(PRECISION):
                return [value(expression, {}, memo) for memo in self.points]
        except (Undefined, NotDecided, Unmodelled):
            return None

    @cached_property
    def right(self) -> list[acb] | None:
        """The values that would be right."""
        return self.values(self.part.right)

    @cached_property
    def residual(self) -> list[acb] | None:
        """The values of what should vanish."""
        claimed = self.values(self.part.claimed)
        if claimed is None or self.right is None:
            return None
        with precision(PRECISION):
            return [a - b for a, b in zip(claimed, self.right, strict=True)]

    @cached_property
    def _at(self) -> list[Values]:
        """The values at the points, of what is not built as well."""
        return [Values(lambda f, memo=memo: value(f, {}, memo)) for memo in self.points]

    def passes(self, expression: Form) -> bool:
        """Whether an expression could be right as far as its values tell."""
        if self.right is None:
            return False
        try:
            with precision(PRECISION):  # the next point is looked at only where this one leaves it open
                return all(
                    (at(expression) - b).contains(0) for at, b in zip(self._at, self.right, strict=True)
                )
        except (Undefined, NotDecided, Unmodelled):
            return False

    def vanish(self, expression: Expr) -> bool:
        """Whether an expression vanishes as far as its values tell."""
        found = self.values(expression)
        return found is not None and all(z.contains(0) for z in found)

    def ratio(self, a: Expr, b: Expr) -> Fraction | None:
        """Return the constant a/b if it is a simple rational at every point."""
        return _constant_ratio(self.values(a), self.values(b))

    def quotient(self, right: Expr, rest: Expr, term: Expr) -> Fraction | None:
        """Return the constant (right − rest)/term if it is a simple rational at every point."""
        values = [self.values(f) for f in (right, rest, term)]
        if any(found is None for found in values):
            return None
        with precision(PRECISION):
            pairs = [(a - b, c) for a, b, c in zip(*(found or [] for found in values), strict=True)]
            known = [(a, c) for a, c in pairs if not (a.contains(0) and c.contains(0))]
            if len(known) < POINTS - 1:
                return None
            return _constant_ratio([a for a, _ in known], [c for _, c in known])

    def share_of_residual(self, term: Expr) -> Fraction | None:
        """Return the constant residual/term if it is a simple rational at every point."""
        return _constant_ratio(self.residual, self.values(term))


def _constant_ratio(above: list[acb] | None, below: list[acb] | None) -> Fraction | None:
    if above is None or below is None or not above:
        return None
    with precision(PRECISION):
        if any(b.contains(0) for b in below):
            return None
        ratios = [a / b for a, b in zip(above, below, strict=True)]
        middle = float(ratios[0].real.mid())
        if not math.isfinite(middle):  # beyond 1e308: no factor that a person forgets
            return None
        guess = Fraction(middle).limit_denominator(64)
        exact = acb(guess.numerator) / guess.denominator
        return guess if all((r - exact).contains(0) for r in ratios) else None
