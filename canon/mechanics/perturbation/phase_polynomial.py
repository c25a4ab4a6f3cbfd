"""Phase-space polynomials with exact coefficients: rational, in parameters, in one algebraic number, and in i.

A polynomial is (re + i im)/den: ``re`` and ``im`` are FLINT's polynomials with whole coefficients in the phase
variables, parameters and the algebraic number, and ``den`` is a whole number, or a polynomial in the parameters alone.
Products of one pair of polynomials and of their derivatives have one denominator, so sums of them need no fractions.
Where a Hamiltonian is reversible one of ``re`` and ``im`` is zero in the variables z = q + i p, z̄ = q − i p, and costs
nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import lcm
from typing import TYPE_CHECKING, Any, TypeVar

import sympy as sp
from flint import Ordering, fmpq, fmpz, fmpz_mpoly, fmpz_mpoly_ctx
from sympy import Expr, Symbol

from canon.cached_property import cached_property

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Sequence


__all__ = ["PhasePolynomial", "PolynomialRing", "Sides"]

Key = TypeVar("Key", bound="Hashable")
Sides = tuple[fmpz_mpoly, fmpz_mpoly]


@dataclass(frozen=True)
class PolynomialRing:
    """Polynomials in phase variables over ℚ(parameters)(root)(i).

    Parameters
    ----------
    size
        How many phase variables there are, 2n of n degrees of freedom.
    parameters
        Symbols that coefficients are rational functions of.
    root
        An algebraic element, such as √2 or √(k m); None where coefficients are rational.
    relation
        The coefficients of its monic equation, from the constant one upwards: whole numbers, or polynomials in the
        parameters with whole coefficients.
    """

    size: int
    parameters: tuple[Symbol, ...] = ()
    root: Expr | None = None
    relation: tuple[Expr, ...] = ()

    @cached_property
    def context(self) -> fmpz_mpoly_ctx:
        """FLINT's polynomials in the phase variables, the root and the parameters, in this order.

        FLINT multiplies in arrays, one for each power of the first variable, where that is cheapest.
        """
        names = [*(f"x{j}" for j in range(self.size)), "r", *(f"c{j}" for j in range(len(self.parameters)))]
        return fmpz_mpoly_ctx.get(names, Ordering.lex)

    @cached_property
    def modulus(self) -> fmpz_mpoly | None:
        """The monic polynomial of which the root is a zero."""
        if self.root is None:
            return None
        r = self.context.gen(self.size)
        powers = (self._plain(c).re * r**k for k, c in enumerate(self.relation))
        return sum(powers, self.context.constant(0))

    @cached_property
    def zero(self) -> PhasePolynomial:
        """The polynomial 0."""
        return PhasePolynomial(self, self.nothing, self.nothing, self.unit)

    @cached_property
    def one(self) -> PhasePolynomial:
        """The polynomial 1."""
        return self.real(self.unit)

    @cached_property
    def i(self) -> PhasePolynomial:
        """The imaginary unit."""
        return PhasePolynomial(self, self.nothing, self.unit, self.unit)

    @cached_property
    def nothing(self) -> fmpz_mpoly:
        """FLINT's 0."""
        return self.context.constant(0)

    @cached_property
    def unit(self) -> fmpz_mpoly:
        """FLINT's 1."""
        return self.context.constant(1)

    def variable(self, j: int) -> PhasePolynomial:
        """Return the phase variable with this number, from 0."""
        return self.real(self.context.gen(j))

    def real(self, re: fmpz_mpoly, den: fmpz_mpoly | None = None) -> PhasePolynomial:
        """Return a polynomial without imaginary part."""
        return PhasePolynomial(self, re, self.nothing, den or self.unit).in_lowest_terms()

    def rational(self, value: int | fmpq) -> PhasePolynomial:
        """Return a rational number as a polynomial."""
        ratio, made = fmpq(value), self.context.constant
        return PhasePolynomial(self, made(ratio.p), self.nothing, made(ratio.q))

    def product(self, f: Sides, g: Sides) -> Sides:
        """Return the numerator of a product of two numerators, each a real and an imaginary part."""
        (a, b), (c, d) = f, g
        re, im = _sum(a * c, -(b * d)), _sum(a * d, b * c)
        if self.modulus is not None:
            re, im = re % self.modulus, im % self.modulus
        return re, im

    def number(self, value: Any) -> PhasePolynomial:
        """Return a real SymPy constant of the field as a polynomial.

        Raises
        ------
        ValueError
            Where it is not in the field.
        """
        if value.is_Rational:
            return self.rational(fmpq(int(value.p), int(value.q)))
        try:
            if self.root is not None and self.root.free_symbols:
                return self._with_root(value)
            numerator, denominator = sp.fraction(sp.together(value))
            return self._element(numerator) * self._element(denominator).inverse()
        except (sp.CoercionFailed, sp.PolynomialError, AttributeError) as refused:
            raise ValueError(f"{value} is not a rational function of {self.described}") from refused

    def total(self, terms: Iterable[PhasePolynomial]) -> PhasePolynomial:
        """Return the sum of many polynomials: of neighbours first, so that none is copied for each of the others."""
        sums = [*terms] or [self.zero]
        while len(sums) > 1:
            last = sums[-1:] if len(sums) % 2 else []
            sums = [f + g for f, g in zip(sums[::2], sums[1::2], strict=False)] + last
        return sums[0]

    def sum_of_products(self, products: Iterable[tuple[PhasePolynomial, PhasePolynomial]]) -> PhasePolynomial:
        """Return Σ f g."""
        total = self.zero
        for f, g in products:
            if f and g:
                total = total + f * g
        return total

    def expression(self, f: PhasePolynomial, symbols: Sequence[Expr]) -> Expr:
        """Return a polynomial as a SymPy expression, with these for the phase variables."""
        bases = [*symbols, self.root or sp.S.One, *self.parameters]
        if f.den.is_constant():
            below = int(f.den.leading_coefficient())
            return _expression(f.re, bases, below) + sp.I * _expression(f.im, bases, below)
        re, im, den = (_expression(part, bases) for part in (f.re, f.im, f.den))
        return (re + sp.I * im) / den

    def _plain(self, value: Any) -> PhasePolynomial:
        """Return a polynomial in the parameters with rational coefficients."""
        if not self.parameters:
            return self.rational(fmpq(int(value.p), int(value.q)))
        lead = (0,) * (self.size + 1)
        terms = sp.Poly(value, *self.parameters, domain="QQ").terms()
        return self._fractions({(*lead, *powers): fmpq(int(c.p), int(c.q)) for powers, c in terms})

    def _fractions(self, coefficients: dict[tuple[int, ...], fmpq]) -> PhasePolynomial:
        """Return the real polynomial with these coefficients."""
        below = lcm(*(int(c.q) for c in coefficients.values()))
        whole = {powers: int(c.p) * (below // int(c.q)) for powers, c in coefficients.items()}
        return self.real(self.context.from_dict(whole), self.context.constant(below))

    def _element(self, value: Expr) -> PhasePolynomial:
        """Return a SymPy polynomial in the parameters and the algebraic number."""
        if self.root is None or not value.has(sp.Pow, sp.AlgebraicNumber):
            return self._plain(sp.expand(value))
        return self._algebraic(value)

    def _algebraic(self, value: Expr) -> PhasePolynomial:
        """Return a number of ℚ(root), or a polynomial in the parameters with such coefficients."""
        field = sp.QQ.algebraic_field(self.root)
        if self.parameters:
            poly = sp.Poly(value, *self.parameters, domain=field)
            terms = [(powers, field.from_sympy(c)) for powers, c in poly.terms()]
        else:
            terms = [((), field.from_sympy(value))]
        total = self.zero
        for powers, number in terms:
            low_to_high = reversed(number.to_list())
            lead = (0,) * self.size
            entries = {
                (*lead, k, *powers): fmpq(int(c.numerator), int(c.denominator))
                for k, c in enumerate(low_to_high)
            }
            total = total + self._fractions(entries)
        return total

    def _with_root(self, value: Any) -> PhasePolynomial:
        """Return a polynomial in the parameters and in the one square root of them that was adjoined."""
        assert self.root is not None
        r, total = self.real(self.context.gen(self.size)), self.zero
        for term in sp.Add.make_args(sp.expand(value)):
            factors: tuple[Any, ...] = sp.Mul.make_args(term)
            radical = sp.Mul(*(f for f in factors if f.is_Pow and not f.exp.is_Integer))
            quotient = (
                sp.powdenest(sp.sqrt(sp.factor(radical**2 / self.root**2))) if radical != 1 else sp.S.One
            )
            above, below = sp.fraction(sp.together(term / radical * quotient))
            rest = self._plain(sp.expand(above)) * self._plain(sp.expand(below)).inverse()
            total = total + (rest * r if radical != 1 else rest)
        return total

    @property
    def described(self) -> str:
        """What coefficients are made of, in words."""
        names = ", ".join(map(str, self.parameters))
        found = [f"the parameters {names}" if names else "", f"{self.root}" if self.root is not None else ""]
        return " and ".join(filter(None, found)) or "rational numbers"


@dataclass(frozen=True)
class PhasePolynomial:
    """A polynomial (re + i im)/den of a ring in lowest terms; see :class:`PolynomialRing`."""

    ring: PolynomialRing
    re: fmpz_mpoly
    im: fmpz_mpoly
    den: fmpz_mpoly

    def __bool__(self) -> bool:
        return bool(self.re) or bool(self.im)

    def __len__(self) -> int:
        return len(self.re) + len(self.im)

    def __neg__(self) -> PhasePolynomial:
        return PhasePolynomial(self.ring, -self.re, -self.im, self.den)

    def __add__(self, other: PhasePolynomial) -> PhasePolynomial:
        if self.den == other.den:
            re, im = _sum(self.re, other.re), _sum(self.im, other.im)
            return PhasePolynomial(self.ring, re, im, self.den).in_lowest_terms()
        common = self.den * (other.den / self.den.gcd(other.den))
        a, b = common / self.den, common / other.den
        re, im = _sum(self.re * a, other.re * b), _sum(self.im * a, other.im * b)
        return PhasePolynomial(self.ring, re, im, common).in_lowest_terms()

    def __sub__(self, other: PhasePolynomial) -> PhasePolynomial:
        return self + (-other)

    def __mul__(self, other: PhasePolynomial) -> PhasePolynomial:
        re, im = self.ring.product((self.re, self.im), (other.re, other.im))
        return PhasePolynomial(self.ring, re, im, self.den * other.den).in_lowest_terms()

    def times(self, number: fmpq | int) -> PhasePolynomial:
        """Return the product with a rational number."""
        ratio = fmpq(number)
        above, below = int(ratio.p), int(ratio.q)
        return PhasePolynomial(
            self.ring, self.re * above, self.im * above, self.den * below
        ).in_lowest_terms()

    def derivative(self, j: int) -> PhasePolynomial:
        """Return the derivative by the phase variable with this number."""
        re, im = self.re.derivative(j), self.im.derivative(j)
        return PhasePolynomial(self.ring, re, im, self.den).in_lowest_terms()

    def along(self, components: Sequence[Sides], den: fmpz_mpoly) -> PhasePolynomial:
        """Return Σ Xⱼ ∂f/∂xⱼ for a vector field X whose components have one denominator."""
        re, im = self.ring.nothing, self.ring.nothing
        for j, component in enumerate(components):
            slope = self.re.derivative(j), self.im.derivative(j)
            if any(slope) and any(component):
                more = self.ring.product(slope, component)
                re, im = _sum(re, more[0]), _sum(im, more[1])
        return PhasePolynomial(self.ring, re, im, self.den * den).in_lowest_terms()

    def in_lowest_terms(self) -> PhasePolynomial:
        """Return the same polynomial with the common factors of its numerator and denominator divided out."""
        if self.den.is_one():
            return self
        common = self.den.gcd(self.re).gcd(self.im)
        if self.den.leading_coefficient() < 0:
            common = -common
        elif common.is_one():
            return self
        re, im, den = (part / common for part in (self.re, self.im, self.den))
        return PhasePolynomial(self.ring, re, im, den)

    def conjugate_coefficients(self) -> PhasePolynomial:
        """Return the polynomial with −i for i in its coefficients."""
        return PhasePolynomial(self.ring, self.re, -self.im, self.den)

    def inverse(self) -> PhasePolynomial:
        """Return the reciprocal of a constant that is not zero.

        Raises
        ------
        ZeroDivisionError
            Where it is zero.
        """
        if not self:
            raise ZeroDivisionError("0 has no reciprocal")
        if self.im:
            bar = self.conjugate_coefficients()
            return bar * (self * bar).inverse()
        if self.re.degrees()[self.ring.size] == 0:
            return self.ring.real(self.den, self.re)
        return _algebraic_inverse(self)

    def split(self, key: Callable[[tuple[int, ...]], Key]) -> dict[Key, PhasePolynomial]:
        """Return the parts whose exponents of the phase variables have the same key, by that key."""
        ring, end = self.ring, self.ring.size
        parts: dict[Key, tuple[dict[tuple[int, ...], fmpz], dict[tuple[int, ...], fmpz]]] = {}
        for side, polynomial in enumerate((self.re, self.im)):
            for powers, c in polynomial.to_dict().items():
                parts.setdefault(key(powers[:end]), ({}, {}))[side][powers] = c
        made = ring.context.from_dict
        return {
            k: PhasePolynomial(ring, made(re), made(im), self.den).in_lowest_terms()
            for k, (re, im) in parts.items()
        }

    def composed(self, images: Sequence[PhasePolynomial]) -> PhasePolynomial:
        """Return the polynomial with these for the phase variables."""
        total = self.ring.zero
        powers = [[self.ring.one] for _ in images]
        for exponents, part in self.split(lambda e: tuple(map(int, e))).items():
            product = part.coefficient_alone()
            for j, k in enumerate(exponents):
                while len(powers[j]) <= k:
                    powers[j].append(powers[j][-1] * images[j])
                if k:
                    product = product * powers[j][k]
            total = total + product
        return total

    def coefficient_alone(self) -> PhasePolynomial:
        """Return the polynomial with 1 for every phase variable."""
        at_one: dict[str | int, int | fmpz] = dict.fromkeys(range(self.ring.size), 1)
        return PhasePolynomial(self.ring, self.re.subs(at_one), self.im.subs(at_one), self.den)


def _sum(f: fmpz_mpoly, g: fmpz_mpoly) -> fmpz_mpoly:
    """Return f + g; FLINT copies the other term by term where one is 0."""
    return f + g if f and g else f or g


def _algebraic_inverse(e: PhasePolynomial) -> PhasePolynomial:
    """Return 1/e by Cayley and Hamilton: Faddeev's and LeVerrier's powers of the map x ↦ e x.

    With N₁ = 1, c_k = −tr(e N_k)/k and N_{k+1} = e N_k + c_k: e N_d + c_d = 0.
    """
    ring = e.ring
    degree = len(ring.relation) - 1
    element = ring.real(e.re)
    power, c = ring.one, ring.zero
    for k in range(1, degree + 1):
        product = element * power
        c = _trace(product).times(fmpq(-1, k))
        if k < degree:
            power = product + c
    return -(power * c.inverse()) * ring.real(e.den)


def _trace(e: PhasePolynomial) -> PhasePolynomial:
    """Return the trace of the map x ↦ e x on 1, r, r², …"""
    ring, total = e.ring, e.ring.zero
    at = ring.size
    r, product = ring.real(ring.context.gen(at)), e
    for k in range(len(ring.relation) - 1):
        diagonal = {
            (*powers[:at], 0, *powers[at + 1 :]): c
            for powers, c in product.re.to_dict().items()
            if powers[at] == k
        }
        total = total + ring.real(ring.context.from_dict(diagonal), product.den)
        product = product * r
    return total


def _expression(f: fmpz_mpoly, bases: Sequence[Expr], den: int = 1) -> Expr:
    return sp.Add(
        *(
            sp.Rational(int(c), den) * sp.Mul(*(b ** int(k) for b, k in zip(bases, powers, strict=True) if k))
            for powers, c in f.to_dict().items()
        )
    )
