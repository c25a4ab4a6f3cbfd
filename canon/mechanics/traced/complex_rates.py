"""Parts of complex formulas: real and imaginary ones, as those who write the plane as x + i y want them back."""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING, cast

import sympy as sp

if TYPE_CHECKING:
    from sympy import Expr

__all__ = ["modulus", "real_and_imaginary"]


def real_and_imaginary(z: Expr) -> tuple[Expr, Expr]:
    """Return both parts of a formula of real variables.

    Raises
    ------
    TypeError
        It holds a function that is taken of complex numbers, other than ``exp``.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> real_and_imaginary((1 + sp.I * x) ** 2), real_and_imaginary(sp.exp(sp.I * x) / sp.Abs(x))
    ((1 - x**2, 2*x), (cos(x)/Abs(x), sin(x)/Abs(x)))
    """
    if not z.has(sp.I):
        return z, sp.S.Zero
    if z == sp.I:
        return sp.S.Zero, sp.S.One
    if isinstance(z, sp.Add | sp.Mul):
        together = _sum_of_two if isinstance(z, sp.Add) else _product_of_two
        return reduce(together, map(real_and_imaginary, z.args))
    if isinstance(z, sp.Pow) and z.exp.is_Integer:
        re, im = real_and_imaginary(z.base)
        if z.exp.is_negative:
            re, im = re / (re**2 + im**2), -im / (re**2 + im**2)
        return reduce(_product_of_two, [(re, im)] * abs(int(z.exp)))
    if isinstance(z, sp.exp):
        re, im = real_and_imaginary(cast("Expr", z.args[0]))
        return sp.exp(re) * sp.cos(im), sp.exp(re) * sp.sin(im)
    raise TypeError(f"{z} is taken of a complex number")


def _sum_of_two(a: tuple[Expr, Expr], b: tuple[Expr, Expr]) -> tuple[Expr, Expr]:
    return a[0] + b[0], a[1] + b[1]


def _product_of_two(a: tuple[Expr, Expr], b: tuple[Expr, Expr]) -> tuple[Expr, Expr]:
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def modulus(z: Expr) -> Expr:
    """Return the absolute value of a formula of real variables."""
    if not z.has(sp.I):
        return sp.Abs(z)
    re, im = real_and_imaginary(z)
    return sp.sqrt(re**2 + im**2)
