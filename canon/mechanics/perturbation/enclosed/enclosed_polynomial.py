"""Polynomials whose coefficients are known to within a bound: complex fixed-point numbers on FLINT's integers.

A polynomial is 2⁻ᴾ (F + i G) + δ, where F and G have whole coefficients and the moduli of the coefficients of δ sum to
at most ``error`` · 2⁻ᴾ. That sum, ‖·‖₁, obeys ‖f g‖₁ ≤ ‖f‖₁ ‖g‖₁ and Σⱼ ‖∂f/∂xⱼ‖₁ = d ‖f‖₁ for homogeneous f of degree
d; so one whole number follows each polynomial through the arithmetic, and FLINT multiplies exactly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import Ordering, acb, arb, fmpz, fmpz_mpoly, fmpz_mpoly_ctx

from canon.cached_property import cached_property

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = ["EnclosedPolynomial", "FixedPointRing", "PrecisionError", "complex_product"]

Powers = tuple[int, ...]


class PrecisionError(ArithmeticError):
    """Raised where balls are too wide for an answer; more bits may give one."""


@dataclass(frozen=True)
class FixedPointRing:
    """Polynomials in some variables with complex coefficients that are multiples of 2⁻ᵇⁱᵗˢ, up to a known error.

    Parameters
    ----------
    size
        How many variables there are.
    bits
        P.
    hyperbolic
        How many of the pairs x₁ … xₙ, xₙ₊₁ … x₂ₙ, the first ones, are hyperbolic.

    Examples
    --------
    >>> ring = FixedPointRing(2, 64)
    >>> third = ring.constant(acb(1) / 3)
    >>> (third * ring.variable(0)).coefficients[1, 0].contains(acb(1) / 3)
    True
    """

    size: int
    bits: int
    hyperbolic: int = 0

    @cached_property
    def context(self) -> fmpz_mpoly_ctx:
        """FLINT's polynomials with whole coefficients."""
        return fmpz_mpoly_ctx.get([f"x{j}" for j in range(self.size)], Ordering.degrevlex)

    @cached_property
    def unit(self) -> int:
        """The number that stands for 1."""
        return 1 << self.bits

    @cached_property
    def zero(self) -> EnclosedPolynomial:
        """The polynomial 0."""
        return self.polynomial({}, {}, 0)

    def polynomial(
        self, re: Mapping[Powers, int], im: Mapping[Powers, int], error: int
    ) -> EnclosedPolynomial:
        """Return a polynomial with these coefficients, in units of 2⁻ᵇⁱᵗˢ."""
        made = self.context.from_dict
        return EnclosedPolynomial(self, made(dict(re)), made(dict(im)), error)

    def constant(self, value: acb) -> EnclosedPolynomial:
        """Return an enclosed number as a polynomial."""
        re, im, error = self.rounded(value)
        place = (0,) * self.size
        return self.polynomial({place: re}, {place: im}, error)

    def variable(self, j: int) -> EnclosedPolynomial:
        """Return the variable with this number, from 0."""
        return self.polynomial({tuple(int(i == j) for i in range(self.size)): self.unit}, {}, 0)

    def linear(self, coefficients: Sequence[acb]) -> EnclosedPolynomial:
        """Return Σ cⱼ xⱼ."""
        re: dict[Powers, int] = {}
        im: dict[Powers, int] = {}
        error = 0
        for j, c in enumerate(coefficients):
            place = tuple(int(i == j) for i in range(self.size))
            re[place], im[place], more = self.rounded(c)
            error += more
        return self.polynomial(re, im, error)

    def rounded(self, value: acb) -> tuple[int, int, int]:
        """Return the real and the imaginary part of a number in units of 2⁻ᵇⁱᵗˢ, and a bound on their error."""
        (re, e), (im, f) = (self._rounded_real(part) for part in (value.real, value.imag))
        return re, im, e + f

    def _rounded_real(self, value: arb) -> tuple[int, int]:
        if value.is_zero():
            return 0, 0
        scaled = value * (fmpz(1) << self.bits)
        middle = _whole(scaled.mid().floor())
        return middle, _whole((scaled - middle).abs_upper().ceil())


def _whole(value: arb) -> int:
    found = value.unique_fmpz()
    if found is None:
        raise PrecisionError("a number is not known to its last whole digit at the working precision")
    return int(found)


@dataclass(frozen=True)
class EnclosedPolynomial:
    """A polynomial of a :class:`FixedPointRing`.

    Parameters
    ----------
    ring
        The ring.
    re, im
        F and G.
    error
        The bound on ‖δ‖₁, in units of 2⁻ᵇⁱᵗˢ.
    """

    ring: FixedPointRing
    re: fmpz_mpoly
    im: fmpz_mpoly
    error: int

    def __bool__(self) -> bool:
        """Tell whether a coefficient may differ from zero."""
        return bool(self.re) or bool(self.im) or self.error > 0

    def __len__(self) -> int:
        return len(self.re) + len(self.im)

    def __neg__(self) -> EnclosedPolynomial:
        return EnclosedPolynomial(self.ring, -self.re, -self.im, self.error)

    def __add__(self, other: EnclosedPolynomial) -> EnclosedPolynomial:
        return EnclosedPolynomial(self.ring, self.re + other.re, self.im + other.im, self.error + other.error)

    def __sub__(self, other: EnclosedPolynomial) -> EnclosedPolynomial:
        return self + (-other)

    def __mul__(self, other: EnclosedPolynomial) -> EnclosedPolynomial:
        re, im = complex_product((self.re, self.im), (other.re, other.im))
        return self.shifted(re, im, self.product_error(other))

    @cached_property
    def norm(self) -> int:
        """An upper bound of ‖F + i G‖₁, in units of 2⁻ᵇⁱᵗˢ."""
        return sum(abs(int(c)) for part in (self.re, self.im) for c in part.coeffs())

    def product_error(self, other: EnclosedPolynomial) -> int:
        """Return ‖f‖ error(g) + error(f) ‖g‖ + error(f) error(g), in units of 4⁻ᵇⁱᵗˢ."""
        return self.norm * other.error + self.error * (other.norm + other.error)

    def shifted(self, re: fmpz_mpoly, im: fmpz_mpoly, error: int) -> EnclosedPolynomial:
        """Return what is given in units of 4⁻ᵇⁱᵗˢ in those of 2⁻ᵇⁱᵗˢ: each coefficient is rounded down."""
        unit = self.ring.unit
        above = len(re) + len(im) + 1
        return EnclosedPolynomial(self.ring, re // unit, im // unit, error // unit + above)

    def over(self, number: int) -> EnclosedPolynomial:
        """Return the quotient by a whole number from 1."""
        if number == 1:
            return self
        above = len(self) + 1
        return EnclosedPolynomial(
            self.ring, self.re // number, self.im // number, self.error // number + above
        )

    def times(self, number: int) -> EnclosedPolynomial:
        """Return the product with a whole number."""
        return EnclosedPolynomial(self.ring, self.re * number, self.im * number, self.error * abs(number))

    @property
    def bound(self) -> float:
        """The bound on the error of each coefficient."""
        return math.nextafter(float(arb(fmpz(self.error)) / self.ring.unit), math.inf)

    @property
    def coefficients(self) -> dict[Powers, acb]:
        """The coefficients that are not certainly zero, each in a ball, by exponents."""
        radius = arb(0, 1) * fmpz(self.error)
        re, im = self.re.to_dict(), self.im.to_dict()
        scale = fmpz(1) << self.ring.bits
        places = sorted({*re, *im}, reverse=True)
        return {
            tuple(map(int, k)): acb(
                (arb(fmpz(re.get(k, 0))) + radius) / scale, (arb(fmpz(im.get(k, 0))) + radius) / scale
            )
            for k in places
        }


def complex_product(
    f: tuple[fmpz_mpoly, fmpz_mpoly], g: tuple[fmpz_mpoly, fmpz_mpoly]
) -> tuple[fmpz_mpoly, fmpz_mpoly]:
    """Return the product of two complex polynomials, by three real ones (Karatsuba) where both have two parts."""
    (a, b), (c, d) = f, g
    if not b:
        return a * c, a * d
    if not d:
        return a * c, b * c
    if not a:
        return -(b * d), b * c
    if not c:
        return -(b * d), a * d
    straight, crossed = a * c, b * d
    return straight - crossed, (a + b) * (c + d) - straight - crossed
