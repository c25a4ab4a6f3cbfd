"""Legendre's polynomials at rational numbers, in 70 digits."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["legendre_values"]

_DIGITS = 10**70
"""Unit of the numbers, ten digits finer than that of the nodes that quadratures have here."""


def legendre_values(z: Fraction, count: int) -> Iterator[Fraction]:
    """Yield L_0(z), L_1(z) …, so many of them.

    Examples
    --------
    >>> [str(x) for x in legendre_values(Fraction(1, 2), 3)]
    ['1', '1/2', '-1/8']
    """
    before, here = Fraction(0), Fraction(1)
    for k in range(count):
        yield here
        new = ((2 * k + 1) * z * here - k * before) / (k + 1)
        before, here = here, Fraction(round(new * _DIGITS), _DIGITS)
