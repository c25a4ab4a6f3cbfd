"""Jacobi's elliptic functions am, sn, cn, dn and ε of an argument u and the parameter m = k², as SymPy functions.

am(u, m) = ∫₀ᵘ dn(t, m) dt, for m < 1 the inverse of Legendre's integral F(φ, m); sn = sin am, cn = cos am,
dn = √(1 − m sn²) with its analytic continuation; ε(u, m) = ∫₀ᵘ dn²(t, m) dt, for m < 1 Legendre's E(am(u, m), m). All
are real and analytic at real u and m (NIST DLMF, chapter 22).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import mpmath as mp
import sympy as sp
from sympy import Expr

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["JACOBI", "jacobi_am", "jacobi_cn", "jacobi_dn", "jacobi_epsilon", "jacobi_sn"]

GUARD_BITS = 20


class _Jacobi(sp.Function):
    """What the functions share: they are real at real arguments, and elementary where m is 0 or 1."""

    nargs = (2,)
    sign_at_minus_u: int
    name_in_books: str
    at_zero_modulus: Callable[[Expr], Expr]
    at_unit_modulus: Callable[[Expr], Expr]

    if TYPE_CHECKING:

        def __new__(cls, u: Expr | int, m: Expr | int) -> Expr:
            """SymPy's constructor, which returns any expression."""
            ...

    @classmethod
    def eval(cls, *args: Expr) -> Any:
        u, m = args
        if m.is_zero:
            return cls.at_zero_modulus(u)
        if m == 1:
            return cls.at_unit_modulus(u)
        if u.is_zero:
            return cls.at_zero_modulus(u)
        if u.could_extract_minus_sign():
            return cls.sign_at_minus_u * cls(-u, m)
        return None

    def _eval_is_extended_real(self) -> bool | None:
        return True if all(a.is_extended_real for a in self.args) else None

    def _eval_is_finite(self) -> bool | None:
        return True if all(a.is_real for a in self.args) else None

    def _eval_evalf(self, prec: int) -> Expr | None:
        bits = prec + GUARD_BITS
        try:
            # Whole numbers too as mpmath's, for Python divides its own in doubles.
            u, m = (a._to_mpmath(bits, allow_ints=False) for a in cast("Any", self.args))  # noqa: SLF001 (SymPy's own)
        except ValueError:  # a symbol has no number
            return None
        with mp.workprec(bits):
            return cast("Expr", sp.Expr._from_mpmath(self._number(u, m), prec))  # noqa: SLF001 (as above)

    def _number(self, u: Any, m: Any) -> Any:
        return _of_mpmath(self.name_in_books, u, m)

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        u, m = (printer.doprint(a) for a in self.args)
        power = "" if exp is None else f"^{{{exp}}}"
        name = (
            rf"\operatorname{{{self.name_in_books}}}" if self.name_in_books.isalpha() else self.name_in_books
        )
        return rf"{name}{power}\left({u}\middle| {m}\right)"


class jacobi_am(_Jacobi):  # noqa: N801 (a function, named as SymPy names its own)
    """Jacobi's amplitude am(u, m) = ∫₀ᵘ dn(t, m) dt, the φ of u = F(φ, m) where m < 1.

    Examples
    --------
    >>> u, m = sp.symbols("u m", real=True)
    >>> jacobi_am(u, m).diff(u), jacobi_am(-u, 0), jacobi_am(1, sp.Rational(1, 2)).n(20)
    (jacobi_dn(u, m), -u, 0.93231507988385386595)
    """

    sign_at_minus_u = -1
    name_in_books = "am"
    at_zero_modulus = staticmethod(lambda u: u)
    at_unit_modulus = staticmethod(lambda u: 2 * sp.atan(sp.tanh(u / 2)))

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return the derivative by u, the first argument, or by m."""
        return _slope_of_amplitude(self, argindex)

    def _number(self, u: Any, m: Any) -> Any:
        return _amplitude(u, m)


class jacobi_sn(_Jacobi):  # noqa: N801 (as above)
    """Jacobi's sn(u, m) = sin am(u, m).

    Examples
    --------
    >>> u, m = sp.symbols("u m", real=True)
    >>> jacobi_sn(u, m).diff(u), jacobi_sn(u, 1)
    (jacobi_cn(u, m)*jacobi_dn(u, m), tanh(u))
    """

    sign_at_minus_u = -1
    name_in_books = "sn"
    at_zero_modulus = sp.sin
    at_unit_modulus = sp.tanh

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return the derivative by u, the first argument, or by m."""
        u, m = cast("tuple[Expr, Expr]", self.args)
        return jacobi_cn(u, m) * _slope_of_amplitude(self, argindex)


class jacobi_cn(_Jacobi):  # noqa: N801 (as above)
    """Jacobi's cn(u, m) = cos am(u, m).

    Examples
    --------
    >>> u, m = sp.symbols("u m", real=True)
    >>> jacobi_cn(u, m).diff(u), jacobi_cn(-u, m)
    (-jacobi_dn(u, m)*jacobi_sn(u, m), jacobi_cn(u, m))
    """

    sign_at_minus_u = 1
    name_in_books = "cn"
    at_zero_modulus = sp.cos
    at_unit_modulus = sp.sech

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return the derivative by u, the first argument, or by m."""
        u, m = cast("tuple[Expr, Expr]", self.args)
        return -jacobi_sn(u, m) * _slope_of_amplitude(self, argindex)


class jacobi_dn(_Jacobi):  # noqa: N801 (as above)
    """Jacobi's dn(u, m) = √(1 − m sn²(u, m)), positive at real u for m ≤ 1.

    Examples
    --------
    >>> u, m = sp.symbols("u m", real=True)
    >>> jacobi_dn(u, m).diff(u), jacobi_dn(u, sp.Rational(1, 2)).is_positive
    (-m*jacobi_cn(u, m)*jacobi_sn(u, m), True)
    """

    sign_at_minus_u = 1
    name_in_books = "dn"
    at_zero_modulus = staticmethod(lambda _: sp.S.One)
    at_unit_modulus = sp.sech

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return the derivative by u, the first argument, or by m."""
        u, m = cast("tuple[Expr, Expr]", self.args)
        s, c = jacobi_sn(u, m), jacobi_cn(u, m)
        if argindex == 1:
            return -m * s * c
        moved = s**2 + 2 * m * s * c * _amplitude_by_parameter(u, m)
        return -moved / (2 * jacobi_dn(u, m))

    def _eval_is_positive(self) -> bool | None:
        u, m = cast("tuple[Expr, Expr]", self.args)
        return True if u.is_real and (1 - m).is_nonnegative else None


class jacobi_epsilon(_Jacobi):  # noqa: N801 (as above)
    """Jacobi's ε(u, m) = ∫₀ᵘ dn²(t, m) dt, the E(am(u, m), m) of Legendre where m < 1 (NIST DLMF 22.16.14–20).

    Examples
    --------
    >>> u, m = sp.symbols("u m", real=True)
    >>> jacobi_epsilon(u, m).diff(u), jacobi_epsilon(1, sp.Rational(1, 2)).n(20)
    (jacobi_dn(u, m)**2, 0.87227527702136475617)
    """

    sign_at_minus_u = -1
    name_in_books = "\\varepsilon"
    at_zero_modulus = staticmethod(lambda u: u)
    at_unit_modulus = sp.tanh

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return the derivative by u, the first argument, or by m."""
        u, m = cast("tuple[Expr, Expr]", self.args)
        d = jacobi_dn(u, m)
        return d**2 if argindex == 1 else (self - u) / (2 * m) + d * _amplitude_by_parameter(u, m)

    def _number(self, u: Any, m: Any) -> Any:
        """Return E(am(u, m), m); for m > 1 through 1/m, as dn(u, m) = cn(√m u, 1/m)."""
        if m < 1:
            return mp.ellipe(_amplitude(u, m), m)
        wide = mp.sqrt(m) * u
        return mp.sqrt(m) * (self._number(wide, 1 / m) - (1 - 1 / m) * wide)


JACOBI = (jacobi_am, jacobi_sn, jacobi_cn, jacobi_dn, jacobi_epsilon)
"""Jacobi's elliptic functions."""


def _of_mpmath(name: str, u: Any, m: Any) -> Any:
    """Return the number, real at real arguments, for which mpmath takes a complex way where m < 0 or m > 1."""
    found = mp.ellipfun(name, u, m=m)
    return mp.re(found) if mp.im(u) == 0 and mp.im(m) == 0 else found


def _amplitude(u: Any, m: Any) -> Any:
    """Return the angle of (cn, sn) with its half turns, one for every 2K."""
    turns = mp.nint(u / (2 * mp.ellipk(m))) if m < 1 else 0
    rest = u - turns * 2 * mp.ellipk(m) if turns else u
    return turns * mp.pi + mp.atan2(_of_mpmath("sn", rest, m), _of_mpmath("cn", rest, m))


def _slope_of_amplitude(f: _Jacobi, argindex: int) -> Expr:
    """Return ∂am/∂u or ∂am/∂m at the arguments of a function."""
    u, m = cast("tuple[Expr, Expr]", f.args)
    return jacobi_dn(u, m) if argindex == 1 else _amplitude_by_parameter(u, m)


def _amplitude_by_parameter(u: Expr, m: Expr) -> Expr:
    """Return ∂am/∂m = dn (u/(2m) − ε/(2m(1 − m))) + sn cn/(2(1 − m)), from F(am(u, m), m) = u."""
    s, c, d = (f(u, m) for f in (jacobi_sn, jacobi_cn, jacobi_dn))
    return d * (u / (2 * m) - jacobi_epsilon(u, m) / (2 * m * (1 - m))) + s * c / (2 * (1 - m))
