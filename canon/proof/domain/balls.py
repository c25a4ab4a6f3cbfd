"""Certified values: an expression at an exact point, enclosed in a complex ball.

Ball arithmetic (python-flint ``acb``, the Arb library: F. Johansson, IEEE Trans. Comput. 66 (2017) 1281,
doi:10.1109/TC.2017.2690633) encloses the true value. Where a ball keeps away from zero the value is
certainly not zero; where it touches a branch cut the enclosure covers both sides, so no sign is guessed.
Principal branches are SymPy's.
"""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, cast

import sympy as sp
from flint import acb, arb, ctx, fmpq, fmpz
from sympy.core.relational import Relational

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Mapping

    from sympy import Expr, Symbol

__all__ = ["NotDecided", "Undefined", "Unmodelled", "holds_at", "precision", "value"]


class Undefined(Exception):
    """The expression has no finite value at this point."""


class NotDecided(Exception):
    """The precision does not suffice to tell which branch applies."""


class Unmodelled(Exception):
    """The expression holds something that this module gives no meaning to."""


@contextmanager
def precision(bits: int) -> Generator[None]:
    """Run a block at a working precision of ``bits``."""
    before = ctx.prec
    ctx.prec = bits
    try:
        yield
    finally:
        ctx.prec = before


def value(expr: Expr, point: Mapping[Symbol, sp.Rational], memo: dict[sp.Basic, acb] | None = None) -> acb:
    """Enclose ``expr`` at ``point`` in a complex ball at the current precision.

    Parameters
    ----------
    expr
        Expression without arbitrary functions.
    point
        An exact rational value for every symbol.
    memo
        Values of subexpressions found before at the same point and precision.

    Raises
    ------
    Undefined
        Where a value is infinite or not a number at any precision.
    NotDecided
        Where the ball is too wide to tell a pole or the piece of a ``Piecewise``.
    Unmodelled
        For functions without a meaning here.

    Examples
    --------
    >>> x = sp.Symbol("x")
    >>> value(sp.sqrt(x) ** 2 - 2, {x: sp.Integer(2)}).contains(0)
    True
    """
    known: dict[sp.Basic, acb] = {} if memo is None else memo
    return _value(expr, point, known)


def _value(expr: sp.Basic, point: Mapping[Symbol, sp.Rational], memo: dict[sp.Basic, acb]) -> acb:
    found = memo.get(expr)
    if found is None:
        found = _fresh_value(expr, point, memo)
        if not found.is_finite():
            raise NotDecided(f"{expr.func.__name__} is unbounded at this precision")
        memo[expr] = found
    return found


def _fresh_value(expr: sp.Basic, point: Mapping[Symbol, sp.Rational], memo: dict[sp.Basic, acb]) -> acb:
    if isinstance(expr, sp.Rational):
        return acb(fmpq(int(expr.p), int(expr.q)))
    if isinstance(expr, sp.Symbol):
        if expr not in point:
            raise Unmodelled(f"{expr} has no value")
        number = point[expr]
        return acb(fmpq(int(number.p), int(number.q)))
    constant = _CONSTANTS.get(expr)
    if constant is not None:
        return constant()
    if isinstance(expr, sp.Piecewise):
        return _piecewise(expr, point, memo)
    arguments = [_value(argument, point, memo) for argument in expr.args]
    if isinstance(expr, sp.Add):
        return _exactly(_sum(arguments), [cast("Expr", expr)], point)
    if isinstance(expr, sp.Mul):
        return _product(arguments)
    if isinstance(expr, sp.Pow):
        return _power(arguments[0], arguments[1], expr.exp)
    function = _FUNCTIONS.get(expr.func)
    if function is None:
        raise Unmodelled(f"{expr.func.__name__} is not modelled")
    return function(*arguments)


SHORT = 8
"""Terms of a sum that is added up exactly where its ball does not tell whether it is zero."""


def _exactly(ball: acb, terms: list[Expr], point: Mapping[Symbol, sp.Rational]) -> acb:
    """Return an exact ball for a short polynomial that may vanish: a ball around 1/3 − 1/3 has a radius."""
    if not ball.contains(0) or ball.is_zero():
        return ball
    terms = [part for term in terms for part in sp.Add.make_args(term)]
    if len(terms) > SHORT:
        return ball
    found = [_monomial(term, point) for term in terms]
    return ball if None in found else acb(sum(cast("list[fmpq]", found), fmpq(0)))


def _monomial(term: Expr, point: Mapping[Symbol, sp.Rational]) -> fmpq | None:
    """Return the exact value of a rational multiple of powers of symbols, None for anything else."""
    total = fmpq(1)
    for factor in sp.Mul.make_args(term):
        base, exponent = factor.as_base_exp()
        number = point.get(base) if isinstance(base, sp.Symbol) else base
        if not isinstance(number, sp.Rational) or not isinstance(exponent, sp.Rational):
            return None
        if abs(int(exponent.p)) > SHORT or (number == 0 and exponent < 0):
            return None
        root = _root(number, int(exponent.q))
        if root is None:
            return None
        total *= root ** int(exponent.p)
    return total


def _root(number: sp.Rational, degree: int) -> fmpq | None:
    """Return the principal root of a rational number, None where it is not rational."""
    above, below = fmpz(int(number.p)), fmpz(int(number.q))
    if degree == 1:
        return fmpq(above, below)
    if above < 0 or degree > SHORT:
        return None
    roots = above.root(degree), below.root(degree)
    return fmpq(*roots) if roots[0] ** degree == above and roots[1] ** degree == below else None


def _sum(terms: list[acb]) -> acb:
    total = acb(0)
    for term in terms:
        total += term
    return total


def _product(factors: list[acb]) -> acb:
    total = acb(1)
    for factor in factors:
        total *= factor
    return total


def _power(base: acb, exponent: acb, exact: Expr) -> acb:
    """Return the principal power exp(exponent·log(base)); 0**0 is 1 as in SymPy."""
    if isinstance(exact, sp.Integer):
        n = int(exact)
        return base**n if n >= 0 else _reciprocal(base ** (-n))
    if isinstance(exact, sp.Rational) and exact.q == 2:
        root = base.sqrt() ** abs(int(exact.p))
        return root if exact.p > 0 else _reciprocal(root)
    if base.is_zero():
        if exponent.real > 0:
            return acb(0)
        if exponent.is_zero():
            return acb(1)
        if exponent.real <= 0:
            raise Undefined("a power of zero")
        raise NotDecided("a power of zero")
    if base.contains(0):
        raise NotDecided("a power of something near zero")
    return base.pow(exponent)


def _reciprocal(z: acb) -> acb:
    if z.is_zero():
        raise Undefined("division by zero")
    if z.contains(0):
        raise NotDecided("division by something near zero")
    return 1 / z


def _piecewise(expr: sp.Piecewise, point: Mapping[Symbol, sp.Rational], memo: dict[sp.Basic, acb]) -> acb:
    for piece, condition in cast("tuple[tuple[Expr, sp.Basic], ...]", expr.args):
        if holds_at(condition, point, memo):
            return _value(piece, point, memo)
    raise Undefined("no piece applies")


def holds_at(
    condition: sp.Basic, point: Mapping[Symbol, sp.Rational], memo: dict[sp.Basic, acb] | None = None
) -> bool:
    """Tell whether a condition certainly holds, or certainly does not, at an exact point.

    Raises
    ------
    NotDecided
        Where two sides that should be compared cannot be told apart.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> holds_at(x**2 < 2, {x: sp.Rational(7, 5)})
    True
    """
    known: dict[sp.Basic, acb] = {} if memo is None else memo
    if condition in (sp.true, sp.false):
        return condition == sp.true
    if isinstance(condition, sp.And):
        return all(holds_at(part, point, known) for part in condition.args)
    if isinstance(condition, sp.Or):
        return any(holds_at(part, point, known) for part in condition.args)
    if isinstance(condition, sp.Not):
        return not holds_at(condition.args[0], point, known)
    if not isinstance(condition, Relational):
        raise Unmodelled(f"the condition {condition} is not modelled")
    sides = cast("tuple[Expr, ...]", condition.args)
    left, right = (_value(side, point, known) for side in sides)
    difference = _exactly(left - right, [sides[0], -sides[1]], point)
    return _compare(condition, difference)


def _compare(condition: Relational, difference: acb) -> bool:
    if isinstance(condition, sp.Eq | sp.Ne):
        if difference.is_zero():
            return isinstance(condition, sp.Eq)
        if difference.contains(0):
            raise NotDecided(f"{condition} cannot be told from its opposite")
        return isinstance(condition, sp.Ne)
    if not difference.imag.is_zero():
        if not difference.imag.contains(0):
            raise Undefined(f"{condition} compares complex numbers")
        raise NotDecided(f"{condition} compares numbers not known to be real")
    gap = difference.real
    if isinstance(condition, sp.StrictGreaterThan | sp.GreaterThan):
        gap = -gap
    if gap.is_zero():
        return isinstance(condition, sp.LessThan | sp.GreaterThan)
    if gap < 0:
        return True
    if gap > 0:
        return False
    raise NotDecided(f"{condition} cannot be told from its opposite")


def _real(z: acb) -> arb:
    if not z.imag.is_zero():
        raise NotDecided("an argument that should be real is not certainly so")
    return z.real


def _sign(z: acb) -> acb:
    if z.is_zero():
        return acb(0)
    if z.contains(0):
        raise NotDecided("the sign of something near zero")
    if z.imag.is_zero():
        return acb(1 if z.real > 0 else -1)
    return z / acb(abs(z))


def _heaviside(z: acb, at_zero: acb) -> acb:
    if z.is_zero():
        return at_zero
    real = _real(z)
    if real.contains(0):
        raise NotDecided("the step of something near zero")
    return acb(1 if real > 0 else 0)


def _impulse(z: acb, *_order: acb) -> acb:
    """DiracDelta, which SymPy writes into the derivative of sign(u): 0 where u ≠ 0, no value where u = 0."""
    if z.is_zero():
        raise Undefined("DiracDelta(0)")
    if z.contains(0):
        raise NotDecided("the impulse of something near zero")
    return acb(0)


def _atan2(y: acb, x: acb) -> acb:
    if y.is_zero() and x.is_zero():
        raise Undefined("atan2(0, 0)")
    if y.contains(0) and x.contains(0):
        raise NotDecided("atan2 near (0, 0)")
    if y.imag.is_zero() and x.imag.is_zero():
        return acb(arb.atan2(y.real, x.real))
    z = (x + acb(0, 1) * y) * _reciprocal((x * x + y * y).sqrt())
    return acb(0, -1) * z.log()


def _acot(z: acb) -> acb:
    if z.is_zero():
        return acb.pi() / 2
    return _reciprocal(z).atan()


def _logarithm(z: acb, base: acb | None = None) -> acb:
    if z.is_zero():
        raise Undefined("the logarithm of zero")
    return z.log() if base is None else z.log() / base.log()


def _elliptic_e(z: acb, m: acb | None = None) -> acb:
    return z.elliptic_e() if m is None else acb.elliptic_e_inc(z, m)


def _lambert_w(z: acb, branch: acb | None = None) -> acb:
    if branch is None:
        return z.lambertw()
    number = branch.unique_fmpz()
    if number is None:
        raise Unmodelled("LambertW of a branch that is not an integer")
    return z.lambertw(int(number))


def _choose(greater: bool) -> Callable[..., acb]:
    def extreme(*arguments: acb) -> acb:
        reals = [_real(z) for z in arguments]
        best = reals[0]
        for other in reals[1:]:
            best = best.max(other) if greater else best.min(other)
        return acb(best)

    return extreme


_CONSTANTS: dict[Any, Callable[[], acb]] = {
    sp.pi: lambda: acb.pi(),
    sp.E: lambda: acb(1).exp(),
    sp.I: lambda: acb(0, 1),
    sp.GoldenRatio: lambda: (1 + acb(5).sqrt()) / 2,
    sp.EulerGamma: lambda: acb(arb.const_euler()),
    sp.Catalan: lambda: acb(arb.const_catalan()),
}

_FUNCTIONS: dict[Any, Callable[..., acb]] = {
    sp.exp: lambda z: z.exp(),
    sp.log: _logarithm,
    sp.sin: lambda z: z.sin(),
    sp.cos: lambda z: z.cos(),
    sp.tan: lambda z: z.sin() * _reciprocal(z.cos()),
    sp.cot: lambda z: z.cos() * _reciprocal(z.sin()),
    sp.sec: lambda z: _reciprocal(z.cos()),
    sp.csc: lambda z: _reciprocal(z.sin()),
    sp.sinh: lambda z: z.sinh(),
    sp.cosh: lambda z: z.cosh(),
    sp.tanh: lambda z: z.sinh() * _reciprocal(z.cosh()),
    sp.coth: lambda z: z.cosh() * _reciprocal(z.sinh()),
    sp.sech: lambda z: _reciprocal(z.cosh()),
    sp.csch: lambda z: _reciprocal(z.sinh()),
    sp.asin: lambda z: z.asin(),
    sp.acos: lambda z: z.acos(),
    sp.atan: lambda z: z.atan(),
    sp.acot: _acot,
    sp.asec: lambda z: _reciprocal(z).acos(),
    sp.acsc: lambda z: _reciprocal(z).asin(),
    sp.asinh: lambda z: z.asinh(),
    sp.acosh: lambda z: z.acosh(),
    sp.atanh: lambda z: z.atanh(),
    sp.acoth: lambda z: _reciprocal(z).atanh(),
    sp.asech: lambda z: _reciprocal(z).acosh(),
    sp.acsch: lambda z: _reciprocal(z).asinh(),
    sp.atan2: _atan2,
    sp.Abs: lambda z: acb(abs(z)),
    sp.sign: _sign,
    sp.Heaviside: _heaviside,
    sp.DiracDelta: _impulse,
    sp.re: lambda z: acb(z.real),
    sp.im: lambda z: acb(z.imag),
    sp.conjugate: lambda z: z.conjugate(),
    sp.arg: lambda z: _atan2(acb(z.imag), acb(z.real)),
    sp.Max: _choose(greater=True),
    sp.Min: _choose(greater=False),
    sp.LambertW: _lambert_w,
    sp.elliptic_k: lambda m: m.elliptic_k(),
    sp.elliptic_e: _elliptic_e,
    sp.elliptic_f: lambda z, m: acb.elliptic_f(z, m),
    sp.gamma: lambda z: z.gamma(),
    sp.factorial: lambda z: (z + 1).gamma(),
    sp.binomial: lambda a, b: (a + 1).gamma() * (b + 1).rgamma() * (a - b + 1).rgamma(),
    sp.RisingFactorial: lambda z, k: (z + k).gamma() * z.rgamma(),
    sp.FallingFactorial: lambda z, k: (z + 1).gamma() * (z - k + 1).rgamma(),
    sp.beta: lambda a, b: a.gamma() * b.gamma() * (a + b).rgamma(),
    sp.loggamma: lambda z: z.lgamma(),
    sp.polygamma: lambda order, z: z.polygamma(order),
    sp.erf: lambda z: z.erf(),
    sp.erfc: lambda z: z.erfc(),
}
