"""Points of the domain that tell the branches of a solution apart; what they suggest is proved afterwards."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import sympy as sp
from flint import acb, arb
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from canon.proof.domain.domain import Domain

__all__ = ["BranchPoint", "branch_points", "far_from_principal"]

_BITS, _MOST_BITS = 192, 12_288


@dataclass(frozen=True)
class BranchPoint:
    """An exact point, and what the new variables are there.

    Parameters
    ----------
    point
        A rational number for each symbol of the old description.
    meaning
        The new variables as expressions in the old ones.
    """

    point: Mapping[Symbol, sp.Rational]
    meaning: Mapping[Symbol, Expr]

    def value(self, f: Expr, bits: int = _BITS) -> Any:
        """Return a ball around the value of f, or None where it has none, or so many bits show none."""
        whole = _without_functions(substitute(f, self.meaning))
        point = {s: self.point.get(s, _stand_in(s, self.point)) for s in whole.atoms(Symbol)}
        try:
            with precision(bits):
                return value(whole, point)
        except (Undefined, NotDecided, Unmodelled):
            return None

    def number(self, f: Expr) -> float | None:
        """Return the value of f as a float, None where it is not a finite real number or no digit of it is known."""
        ball = self.value(f)
        if ball is None or not ball.imag.contains(0) or not ball.real.is_finite():
            return None
        if ball.real.rad() > 1 + abs(ball.real.mid()) / 1024:
            return None
        return float(ball.real.mid())

    def agree(self, a: Expr, b: Expr) -> bool:
        """Whether both are equal there as far as the working precision tells."""
        for bits in (_BITS, _MOST_BITS):  # as log(acos(1 − exp(−5000))), which takes many
            left, right = self.value(a, bits), self.value(b, bits)
            if left is not None and right is not None:
                with precision(bits):
                    return bool((left - right).contains(acb(0)))
        return False

    def nearest_multiple(self, difference: Expr, period: Expr) -> sp.Integer | None:
        """Return the integer k with difference = k·period there, or None."""
        ball = self.value(difference / period)
        if ball is None or not ball.imag.contains(0):
            return None
        with precision(_BITS):
            k = sp.Integer(round(float(ball.real.mid())))
            return k if (ball.real - arb(int(k))).contains(0) else None


def branch_points(
    symbols: set[Symbol], meaning: Mapping[Symbol, Expr], domain: Domain, count: int, seed: int = 7
) -> Iterator[BranchPoint]:
    """Yield points of the domain where the new variables have finite real values."""
    for point in domain.points(symbols, 6 * count, seed=seed):
        witness = BranchPoint(point, meaning)
        if all(witness.number(f) is not None for f in meaning.values()):
            yield witness
            count -= 1
            if count == 0:
                return


def far_from_principal(witness: BranchPoint) -> float:
    """Rank points: values between 0 and 3/2 lie on the principal branch of every elementary function."""
    return sum(max(0.0, -float(x)) + max(0.0, float(x) - 1.5) for x in witness.point.values())


def _without_functions(f: Expr) -> Expr:
    """Put a symbol for every arbitrary function and derivative, as their values are free."""
    derivatives = {d: Symbol(f"#{d}") for d in f.atoms(sp.Derivative, sp.Subs)}
    f = exchanged(f, derivatives)
    return exchanged(f, {u: Symbol(f"#{u}") for u in f.atoms(AppliedUndef)})


def _stand_in(s: Symbol, point: Mapping[Symbol, sp.Rational]) -> sp.Rational:
    """Return a number for a symbol that the point does not name: the same for a name at one point."""
    mark = sum(map(ord, s.name)) + int(1000 * abs(sum(map(float, point.values()))))
    return cast("sp.Rational", sp.Rational(5 + mark % 31, 13))
