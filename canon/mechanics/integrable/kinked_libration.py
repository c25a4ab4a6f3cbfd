"""Kinked librations: cycles on which p² holds |q − q₀|, taken apart where that has its kink.

On each side of a kink p² is holomorphic in s with |q − q₀| = sᵏ, k the denominator of the exponents of |q − q₀|.
Outside the last kinks a piece reaches to a turning point and is integrated beside it (:mod:`cycle_quadrature`), between
two kinks along the line.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from itertools import pairwise
from math import lcm
from typing import TYPE_CHECKING, cast

import sympy as sp
from flint import acb, arb

from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.mechanics.integrable.ball_function import BallFunction, NotHolomorphicError
from canon.mechanics.integrable.cycle_quadrature import Libration, integral_along
from canon.mechanics.integrable.turning_points import NoCycleError
from canon.proof.domain.balls import value
from canon.proof.trees.affine_form import is_affine

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from sympy import Expr, Symbol

__all__ = ["KinkedLibration", "kinked_libration"]


@dataclass(frozen=True)
class _Piece:
    """A piece of the cycle on one side of a kink, in s.

    Parameters
    ----------
    libration
        p² in s from the kink, where s = 0, to the end, which is a turning point or another kink.
    kink
        The ball of the coordinate at the kink.
    side
        The sign of q − q₀.
    power
        k of |q − q₀| = sᵏ.
    turning
        Whether the end is a turning point.
    within
        A function of q as one of s.
    """

    libration: Libration
    kink: arb
    side: int
    power: int
    turning: bool
    within: Callable[[Expr], BallFunction]

    def integral(self, f: Expr, power: int, end: arb | None) -> arb:
        """Return the integral of f (p²)^(power/2) by |dq| from the kink to the end of the piece, or to a place q."""
        g, k, spread = self.within(f), self.power, self.libration
        stop = None if end is None else arb.max(self.side * (end - self.kink), arb(0)) ** (arb(1) / k)

        def weighted(s: acb, analytic: bool) -> acb:
            return g(s, analytic) * k * s ** (k - 1)

        if self.turning:
            return spread.integral(weighted, power, stop)

        def integrand(s: acb, analytic: bool) -> acb:
            return weighted(s, analytic) * spread.square(s, analytic).sqrt(analytic=analytic) ** power

        total = integral_along(integrand, [acb(0), acb(spread.high if stop is None else stop)])
        if not total.is_finite():
            raise NoCycleError(f"the integral over {spread.name} between two kinks did not converge")
        return total.real


@dataclass(frozen=True)
class KinkedLibration:
    """The cycle between two turning points with kinks of p² between them.

    Parameters
    ----------
    pieces
        The pieces from the lower turning point to the upper one; the first is counted from its kink downwards.
    """

    pieces: tuple[_Piece, ...]

    def integral(self, f: Expr, power: int, end: arb | None = None) -> arb:
        """Return the integral of f·(p²)^(power/2) from the lower turning point to the upper one, or to ``end``."""
        first, *others = self.pieces
        total = first.integral(f, power, None)
        if end is not None and not end > first.kink:
            return total - first.integral(f, power, end)
        for piece in others:
            last = end is not None and (piece.turning or not end > _end_of(piece))
            total += piece.integral(f, power, end if last else None)
            if last:
                break
        return total


def _end_of(piece: _Piece) -> arb:
    return piece.kink + piece.side * piece.libration.high**piece.power


def kinked_libration(
    square: Expr, q: Symbol, balls: Mapping[Symbol, acb], ends: tuple[arb, arb]
) -> KinkedLibration | None:
    """Return the cycle taken apart at the kinks of |q − q₀| between both ends; None where it has none.

    Examples
    --------
    >>> q = sp.Symbol("q", real=True)
    >>> swing = kinked_libration(2 - 2*sp.Abs(q), q, {}, (arb(-1), arb(1)))
    >>> swing.integral(sp.S.One, 1).overlaps(4 * arb(2).sqrt() / 3)
    True
    """
    places = _kinks(square, q, balls, ends)
    if not places:
        return None
    cut = _Cut(square, q, balls, places)
    (first, low), (last, high) = (places[0], ends[0]), (places[-1], ends[1])
    pieces = [cut.piece(*first, -1, low, turning=True)]
    pieces += [cut.piece(*left, 1, right[1], turning=False) for left, right in pairwise(places)]
    pieces.append(cut.piece(*last, 1, high, turning=True))
    return KinkedLibration(tuple(pieces))


def _kinks(
    square: Expr, q: Symbol, balls: Mapping[Symbol, acb], ends: tuple[arb, arb]
) -> list[tuple[Expr, arb]]:
    """Return the places where linear functions under absolute values vanish between both ends, in their order."""
    found: dict[Expr, arb] = {}
    for part in square.atoms(sp.Abs, sp.sign):
        u = cast("Expr", part.args[0])
        slope = u.diff(q)
        if slope == 0:
            continue
        if slope.has(q) or not is_affine(u, [q]):
            _refuse_kink_within(u, q, balls, ends)
            continue
        place = sp.expand(q - u / slope)
        ball = _real(place, balls)
        if ball > ends[0] and ball < ends[1]:
            found[place] = ball
    places = sorted(found.items(), key=lambda each: float(each[1].mid()))
    if any(not left[1] < right[1] for left, right in pairwise(places)):
        raise NoCycleError(f"two kinks of the potential of {q} are too near to each other to be told apart")
    return places


def _refuse_kink_within(u: Expr, q: Symbol, balls: Mapping[Symbol, acb], ends: tuple[arb, arb]) -> None:
    """Refuse |u| that is not linear in q where u may vanish between both ends."""
    whole = BallFunction(u, q, balls)(acb(ends[0].union(ends[1]))).real
    if not (whole > 0 or whole < 0):
        raise NotHolomorphicError(
            f"Abs({u}) may have a kink between the turning points of {q}, and is not linear in {q}; write it with "
            f"absolute values of {q} less a constant, such as Abs({q} - 1)*Abs({q} + 1)"
        )


def _real(f: Expr, balls: Mapping[Symbol, acb]) -> arb:
    known: dict[sp.Basic, acb] = {**balls}
    return value(f, {}, known).real


@dataclass(frozen=True)
class _Cut:
    """A function p² with its kinks."""

    square: Expr
    q: Symbol
    balls: Mapping[Symbol, acb]
    places: Sequence[tuple[Expr, arb]]

    def piece(self, kink: Expr, at: arb, side: int, end: arb, *, turning: bool) -> _Piece:
        """Return the piece on one side of a kink, up to an end."""
        s = sp.Dummy("s", positive=True)
        inside = (at + end) / 2
        pieced = self.square.atoms(sp.Abs, sp.sign)
        known = {part: self._sign(part, inside) for part in pieced if part.has(self.q)}
        k = reduce(lcm, (_denominator(power, self.q) for power in self.square.atoms(sp.Pow)), 1)
        there = {self.q: kink + side * s**k}

        def in_s(f: Expr) -> Expr:
            plain = {
                part: sign * sp.expand(substitute(part.args[0], there)) if isinstance(part, sp.Abs) else sign
                for part, sign in known.items()
            }
            return substitute(exchanged(f, plain), there)

        balls = dict(self.balls)
        square = in_s(self.square)
        reach = (side * (end - at)) ** (arb(1) / k)
        spread = Libration(
            BallFunction(square, s, balls),
            BallFunction(square.diff(s), s, balls),
            arb(0),
            reach,
            str(self.q),
            wall=True,
        )
        return _Piece(spread, at, side, k, turning, lambda f: BallFunction(in_s(f), s, balls))

    def _sign(self, part: Expr, inside: arb) -> Expr:
        ball = BallFunction(cast("Expr", part.args[0]), self.q, self.balls)(acb(inside)).real
        if ball > 0:
            return sp.S.One
        if ball < 0:
            return sp.S.NegativeOne
        raise NoCycleError(f"the sign of {part.args[0]} between two kinks was not told; ask for more digits")


def _denominator(power: sp.Pow, q: Symbol) -> int:
    return int(power.exp.q) if isinstance(power.exp, sp.Rational) and power.base.has(q) else 1
