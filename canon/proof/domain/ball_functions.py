"""Functions of complex balls: what SymPy's constants and functions are on the enclosures of their arguments."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy as sp
from flint import acb, arb

from canon.expression.symbols.jacobi_functions import (
    jacobi_am,
    jacobi_cn,
    jacobi_dn,
    jacobi_epsilon,
    jacobi_sn,
)
from canon.proof.domain.theta_quotients import amplitude, epsilon, sn_cn_dn

if TYPE_CHECKING:
    from collections.abc import Callable

    from sympy import Expr

__all__ = ["CONSTANTS", "FUNCTIONS", "NotDecided", "Undefined", "Unmodelled", "power"]


class Undefined(Exception):
    """The expression has no finite value at this point."""


class NotDecided(Exception):
    """The precision does not suffice to tell which branch applies."""


class Unmodelled(Exception):
    """The expression holds something that this module gives no meaning to."""


def power(base: acb, exponent: acb, exact: Expr) -> acb:
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


def _elliptic_pi(n: acb, z: acb, m: acb | None = None) -> acb:
    return acb.elliptic_pi(n, z) if m is None else acb.elliptic_pi_inc(n, z, m)


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


CONSTANTS: dict[Any, Callable[[], acb]] = {
    sp.pi: lambda: acb.pi(),
    sp.E: lambda: acb(1).exp(),
    sp.I: lambda: acb(0, 1),
    sp.GoldenRatio: lambda: (1 + acb(5).sqrt()) / 2,
    sp.EulerGamma: lambda: acb(arb.const_euler()),
    sp.Catalan: lambda: acb(arb.const_catalan()),
}

FUNCTIONS: dict[Any, Callable[..., acb]] = {
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
    sp.elliptic_pi: _elliptic_pi,
    jacobi_am: amplitude,
    jacobi_sn: lambda u, m: sn_cn_dn(u, m)[0],
    jacobi_cn: lambda u, m: sn_cn_dn(u, m)[1],
    jacobi_dn: lambda u, m: sn_cn_dn(u, m)[2],
    jacobi_epsilon: epsilon,
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
