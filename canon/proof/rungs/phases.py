"""Phases: relations between inverse functions and logarithms, proved by exponentiation.

Where w = i·Σ rₖ arcₖ + Σ sₖ log gₖ + … has e^w = 1 identically, w is a whole multiple of 2πi at every
point. It is zero where the ranges of the arcs leave no other multiple, or where w is continuous on a
connected domain and balls leave no other multiple at one point.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction as Rational
from math import lcm
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.functions.angles import imaginary_split
from canon.proof.functions.arcs import ARCS
from canon.proof.functions.powers import exponential
from canon.proof.tower.tower import Fraction
from canon.proof.trees.sympy_types import free_symbols

if TYPE_CHECKING:
    from collections.abc import Hashable, Sequence

    from flint import arb, fmpq, fmpq_mpoly
    from sympy import Expr

    from canon.proof.functions.normal_form import NormalForm

__all__ = ["arcs_cancel"]

Monomial = tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Range:
    """An interval in units of π; infinite ends are None."""

    low: Rational | None
    high: Rational | None
    low_open: bool = False
    high_open: bool = False

    def times(self, r: Rational) -> Range:
        """Return the range of a multiple."""
        low, high = (None if end is None else end * r for end in (self.low, self.high))
        if r < 0:
            return Range(high, low, self.high_open, self.low_open)
        return Range(low, high, self.low_open, self.high_open)

    def plus(self, other: Range) -> Range:
        """Return the range of a sum of independent terms."""
        low = None if self.low is None or other.low is None else self.low + other.low
        high = None if self.high is None or other.high is None else self.high + other.high
        return Range(low, high, self.low_open or other.low_open, self.high_open or other.high_open)

    def only_zero_turns(self) -> bool:
        """Tell whether 0 is the only even number inside."""
        if self.low is None or self.high is None:
            return False
        above = self.low > -2 or (self.low == -2 and self.low_open)
        below = self.high < 2 or (self.high == 2 and self.high_open)
        return above and below


POINT = Range(Rational(0), Rational(0))
UNBOUNDED = Range(None, None)


def arcs_cancel(n: NormalForm, f: Fraction) -> bool:
    """Tell whether the numerator of ``f`` is proven zero, group by group of its inverse functions."""
    groups = _groups(n, n.tower.reduce(f.num))
    return groups is not None and all(_group_vanishes(n, h) for h in groups)


def _parted(monomial: Monomial, generators: set[int]) -> tuple[Monomial, Monomial]:
    """Return the factors of a monomial that are powers of some generators, and the others."""
    own = tuple(power for power in monomial if power[0] in generators)
    return own, tuple(power for power in monomial if power[0] not in generators)


def _groups(n: NormalForm, p: fmpq_mpoly) -> list[Fraction] | None:
    """Write p = Σ M·h_M, each h_M linear in arcs, logarithms and π with rational coefficients."""
    t = n.tower
    unit, pi = (t.generator(kernel) if t.knows(kernel) else -1 for kernel in (("I",), ("pi",)))
    linear: dict[Monomial, dict[Monomial, fmpq]] = {}
    plain: list[tuple[Monomial, fmpq]] = []
    for monomial, coefficient in t.terms(p):
        phases = [k for k, e in monomial for _ in range(e) if t.generators[k][0] in (*ARCS, "log")]
        if len(phases) > 1:
            return None
        if not phases:
            plain.append((monomial, coefficient))
            continue
        inner, outer = _parted(monomial, {phases[0], unit})
        linear.setdefault(outer, {})[inner] = coefficient
    if not linear or not _distributed(plain, linear, pi):
        return None
    return [Fraction(_polynomial(n, terms)) for terms in linear.values()]


def _distributed(
    plain: Sequence[tuple[Monomial, fmpq]], linear: dict[Monomial, dict[Monomial, fmpq]], pi: int
) -> bool:
    """Add each term without arcs and logarithms to the group whose monomial divides it; say if all have one."""
    for monomial, coefficient in plain:
        outer = _largest_divisor(monomial, linear, pi)
        if outer is None:
            return False
        taken = dict(outer)
        inner = tuple((k, e - taken.get(k, 0)) for k, e in monomial if e != taken.get(k, 0))
        linear[outer][inner] = coefficient
    return True


def _largest_divisor(monomial: Monomial, groups: dict[Monomial, Any], pi: int) -> Monomial | None:
    have = dict(monomial)
    dividing = [outer for outer in groups if all(have.get(k, 0) >= e for k, e in outer)]
    exact = [o for o in dividing if {k for k, e in have.items() if e > dict(o).get(k, 0)} <= {pi}]
    return max(exact or dividing, key=lambda o: sum(e for _, e in o), default=None)


def _polynomial(n: NormalForm, terms: dict[Monomial, fmpq]) -> fmpq_mpoly:
    t = n.tower
    total = t.constant(0)
    for monomial, coefficient in terms.items():
        p = t.constant(coefficient)
        for k, e in monomial:
            p = p * t.monomial(k, e)
        total = total + p
    return total


def _group_vanishes(n: NormalForm, h: Fraction) -> bool:
    t = n.tower
    terms = t.terms(h.num)
    kinds = {
        (t.generators[k][0], any(t.generators[j] == ("I",) for j, _ in m)) for m, _ in terms for k, _ in m
    }
    turns = any((arc, False) in kinds for arc in ARCS) or ("log", True) in kinds
    for multiple in _whole_multiples(n, terms):
        w = n.scaled(multiple, t.times(n.imaginary_unit, h) if turns else h)
        if not t.is_zero(n.minus(exponential(n, w), t.number(1))):
            continue
        if _bound(n, w).only_zero_turns() or _zero_by_continuity(n, h, w):
            return True
    return False


def _whole_multiples(n: NormalForm, terms: Sequence[tuple[Monomial, fmpq]]) -> list[int]:
    """Return by what a sum is multiplied in turn: the arcs in it get whole coefficients, then even ones."""
    of_arcs = [c for m, c in terms if any(n.tower.generators[k][0] in ARCS for k, _ in m)]
    common = lcm(*(int(c.q) for c in of_arcs))
    return sorted({1 if common <= 2 else common, common, 2 * common}) if of_arcs else [1]


def _bound(n: NormalForm, w: Fraction) -> Range:
    bound = POINT
    for monomial, coefficient in n.tower.terms(w.num):
        bound = bound.plus(_range(n, monomial).times(Rational(int(coefficient.p), int(coefficient.q))))
    return bound


def _range(n: NormalForm, monomial: Monomial) -> Range:
    """Return the range of the imaginary part of one term with coefficient 1, in units of π."""
    t = n.tower
    kernels = {t.generators[k]: e for k, e in monomial}
    imaginary = kernels.pop(("I",), 0)
    real = all(n.signs.declared(t.generator(kernel)) for kernel in kernels)
    if real and not imaginary:
        return POINT
    if len(kernels) != 1 or next(iter(kernels.values())) != 1:
        return UNBOUNDED
    kernel: Any = next(iter(kernels))
    if kernel[0] == "log" and not imaginary:
        return _argument_range(n, n.arguments[kernel])
    if not imaginary:
        return UNBOUNDED
    if kernel == ("pi",):
        return Range(Rational(1), Rational(1))
    if kernel[0] == "symbol":
        return _symbol_range(n, kernel[1])
    return _arc_range(n, kernel) if kernel[0] in ARCS else UNBOUNDED


def _argument_range(n: NormalForm, z: Fraction) -> Range:
    """Return the range of arg z: within a quarter turn where Re z > 0, of one sign where Im z has one."""
    whole = Range(Rational(-1), Rational(1), low_open=True)
    if z.den:
        return whole
    a, b = imaginary_split(n, z)
    if not (n.is_real(a) and n.is_real(b)):
        return whole
    if n.sign(a) == "+":
        whole = Range(Rational(-1, 2), Rational(1, 2), low_open=True, high_open=True)
    return _with_sign(whole, n.sign(b)) if n.sign(b) in ("+", "-") else whole


def _arc_range(n: NormalForm, kernel: tuple[Hashable, ...]) -> Range:
    """Return the range of Re arc: |Re asin| ≤ π/2, |atan| < π/2 for real arguments, −π < atan2 ≤ π.

    atan2(y, x) of real arguments has the sign of y, except that it is π at y = 0, x < 0.
    """
    z = n.arguments[kernel]
    sign = n.sign(z)
    quarter, half = Rational(1, 4), Rational(1, 2)
    constant = _constant_range(n, kernel)
    if constant is not None:
        return constant
    if kernel[0] == "atan2":
        whole = Range(Rational(-1), Rational(1), low_open=True)
        x = n.arguments[(*kernel, "x")]
        if not (n.is_real(x) and n.is_real(z)):
            return whole
        if n.sign(x).endswith("+"):
            return _with_sign(Range(-half, half), sign)
        return whole if sign == "0-" else _with_sign(whole, sign)
    if kernel[0] == "atan":
        if not n.is_real(z):
            return Range(-half, half)
        small = n.sign(n.minus(n.tower.number(1), n.tower.times(z, z))).endswith("+")
        whole = Range(-quarter, quarter) if small else Range(-half, half, low_open=True, high_open=True)
        return _with_sign(whole, sign)
    inside = n.sign(n.minus(n.tower.number(1), n.tower.times(z, z))) == "+"
    return _with_sign(Range(-half, half, low_open=inside, high_open=inside), sign)


def _with_sign(whole: Range, sign: str) -> Range:
    if sign.endswith("+"):
        return Range(Rational(0), whole.high, sign == "+", whole.high_open)
    if sign.endswith("-"):
        return Range(whole.low, Rational(0), whole.low_open, sign == "-")
    return whole


def _symbol_range(n: NormalForm, symbol: sp.Symbol) -> Range:
    low, high, strict = n.domain.interval(symbol)
    return Range(_in_turns(low, upwards=False), _in_turns(high, upwards=True), strict, strict)


def _in_turns(number: Expr, *, upwards: bool) -> Rational | None:
    """Return number/π, rounded outwards where it is not rational."""
    if not number.is_finite:
        return None
    ratio = number / sp.pi
    if isinstance(ratio, sp.Rational):
        return Rational(int(ratio.p), int(ratio.q))
    with precision(128):
        ball: arb = value(ratio, {}).real
        end = ball.upper() if upwards else ball.lower()
        mantissa, exponent = end.man_exp()
    return Rational(int(mantissa)) * Rational(2) ** int(exponent)


def _constant_range(n: NormalForm, kernel: tuple[Hashable, ...]) -> Range | None:
    expr = n.expression(n.tower.monomial(n.tower.generator(kernel)))
    if expr.free_symbols or expr.has(sp.core.function.AppliedUndef):
        return None
    with precision(128):
        try:
            ball: arb = value(expr / sp.pi, {}).real
        except (NotDecided, Undefined, Unmodelled):
            return None
        ends: list[Rational] = []
        for end in (ball.lower(), ball.upper()):
            mantissa, exponent = end.man_exp()
            ends.append(Rational(int(mantissa)) * Rational(2) ** int(exponent))
    return Range(ends[0], ends[1])


# -- continuity ----------------------------------------------------------------------------------------


def _zero_by_continuity(n: NormalForm, h: Fraction, w: Fraction) -> bool:
    """Tell whether w, a multiple of 2πi everywhere, is continuous on a connected domain and 0 at a point.

    Points that the domain excludes by ≠ may be ignored: w is shown to be continuous there as well.
    """
    expr = n.expression(h.num)
    symbols = free_symbols(expr)
    n.signs.forget_nonzero()
    if not n.domain.is_connected(symbols) or not is_continuous(n, h):
        return False
    turns = n.expression(w.num) / (2 * sp.pi * sp.I)
    for point in n.domain.points(symbols, 3, seed=5, deadline=n.tower.deadline):
        with precision(128):
            try:
                ball = value(turns, point)
            except (NotDecided, Undefined, Unmodelled):
                continue
        if abs(ball) < 1:
            return True
    return False


def is_continuous(n: NormalForm, f: Fraction) -> bool:
    """Tell whether ``f`` is proven defined and continuous on the whole domain."""
    t = n.tower
    if any(n.signs.of(t.base(i)) not in ("+", "-") or not _all_continuous(n, t.base(i)) for i, _ in f.den):
        return False
    return _all_continuous(n, f.num)


def _all_continuous(n: NormalForm, p: fmpq_mpoly) -> bool:
    return all(_kernel_continuous(n, n.tower.generators[k]) for k in n.tower.used(p))


def _kernel_continuous(n: NormalForm, kernel: tuple[Any, ...]) -> bool:
    if kernel[0] in ("pi", "I", "cyclotomic"):
        return True
    if kernel[0] == "symbol":
        return not kernel[1].is_integer
    argument = n.arguments.get(kernel)
    if argument is None or not is_continuous(n, argument):
        return False
    sign = n.signs.declared(n.tower.generator(kernel))
    match kernel[0]:
        case "exp" | "cos" | "sin" | "abs":
            return True
        case "root" | "asin" | "atan":
            return sign != "" and (kernel[0] != "root" or sign.endswith("+"))
        case "log":
            return n.sign(argument) == "+"
        case _:
            return False
