"""From SymPy expressions to fractions over a tower of generators.

Every rewriting here is an identity of principal branches that holds wherever its left side is defined;
the docstring of each rule says why. Whatever has no rule becomes an opaque kernel, known only by its
name and the normal forms of its arguments, which is always sound.
"""

from __future__ import annotations

from math import lcm
from typing import TYPE_CHECKING, Any

import sympy as sp
from flint import fmpq
from sympy.core.function import AppliedUndef, Derivative, Subs

from canon.proof.signs import Signs
from canon.proof.tower import Fraction, TooLarge, Tower

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable

    from flint import fmpq_mpoly

    from canon.proof.domain import Domain

__all__ = ["NormalForm", "Refine", "declared_complex"]

LARGEST_MULTIPLE = 200
"""Multiples of an angle, and exponents, that are still written out."""

LARGEST_FACTORED_INTEGER = 10**24
"""Integers up to this are split into primes under roots and logarithms."""

ONE: Hashable = frozenset({(frozenset(), 1, 1)})
"""Key of the constant 1."""


class Refine(Exception):
    """A kernel is needed at a finer fraction than was provided for; start again."""


def declared_complex(symbol: sp.Basic) -> bool:
    """Tell whether a symbol was declared complex and not real; all others are read as real."""
    said = getattr(symbol, "assumptions0", {})
    return said.get("real") is not True and ("complex" in said or "imaginary" in said)


class NormalForm:
    """Normal forms of expressions over one tower.

    Parameters
    ----------
    domain
        Conditions from which signs are taken.
    parts
        For each kernel the number of parts it is divided into; grows when :class:`Refine` is raised.
    deadline
        Value of :func:`time.monotonic` to stop at.
    """

    def __init__(self, domain: Domain, parts: dict[Hashable, int], deadline: float = float("inf")) -> None:
        self.tower = Tower(deadline)
        self.signs = Signs(self.tower)
        self.parts = parts
        self._memo: dict[sp.Basic, Fraction] = {}
        self._exponents: dict[Hashable, tuple[Fraction, int]] = {}
        self._radicands: dict[Hashable, tuple[Fraction, int]] = {}
        self._logged: dict[Hashable, Fraction] = {}
        for condition in domain.conditions:
            self._learn(condition)

    def _learn(self, condition: sp.Basic) -> None:
        """Take p > 0 or p ≥ 0 from an inequality whose sides are polynomials."""
        if isinstance(condition, sp.And):
            for part in condition.args:
                self._learn(part)
        elif isinstance(condition, sp.StrictLessThan | sp.LessThan | sp.StrictGreaterThan | sp.GreaterThan):
            gap = self.form(condition.gts - condition.lts)
            if not gap.den or self.signs.of(self._denominator(gap)) == "+":
                self.signs.learn(
                    gap.num, strict=isinstance(condition, sp.StrictLessThan | sp.StrictGreaterThan)
                )

    # -- recursion -------------------------------------------------------------------------------

    def form(self, expr: sp.Basic) -> Fraction:
        """Return the normal form of an expression."""
        found = self._memo.get(expr)
        if found is None:
            found = self._memo[expr] = self._fresh(expr)
        return found

    def _fresh(self, expr: sp.Basic) -> Fraction:
        t = self.tower
        match expr:
            case sp.Rational():
                return t.number(fmpq(int(expr.p), int(expr.q)))
            case sp.Symbol():
                return self._symbol(expr)
            case sp.Add():
                return t.sum(self.form(term) for term in expr.args)
            case sp.Mul():
                return t.times(*(self.form(factor) for factor in expr.args))
            case sp.Pow():
                return self._pow(expr)
            case sp.exp():
                return self.exponential(self.form(expr.args[0]))
            case sp.log() if len(expr.args) == 1:
                return self.logarithm(self.form(expr.args[0]))
            case sp.Abs():
                return self.absolute(self.form(expr.args[0]))
        if expr is sp.pi:
            return self.atom(("pi",), "+")
        if expr is sp.I:
            return self._imaginary_unit()
        if expr is sp.E:
            return self.exponential(t.number(1))
        rewritten = self._elementary(expr)
        return self._opaque(expr) if rewritten is None else rewritten

    def _elementary(self, expr: sp.Basic) -> Fraction | None:
        """Return trigonometric and hyperbolic functions through sin, cos and exp, by definition."""
        t = self.tower
        match expr:
            case sp.sin():
                return self.cos_sin(self.form(expr.args[0]))[1]
            case sp.cos():
                return self.cos_sin(self.form(expr.args[0]))[0]
            case sp.tan():
                c, s = self.cos_sin(self.form(expr.args[0]))
                return t.times(s, t.reciprocal(c))
            case sp.cot():
                c, s = self.cos_sin(self.form(expr.args[0]))
                return t.times(c, t.reciprocal(s))
            case sp.sec():
                return t.reciprocal(self.cos_sin(self.form(expr.args[0]))[0])
            case sp.csc():
                return t.reciprocal(self.cos_sin(self.form(expr.args[0]))[1])
            case sp.sinh() | sp.cosh() | sp.tanh() | sp.coth() | sp.sech() | sp.csch():
                return self._hyperbolic(type(expr).__name__, self.form(expr.args[0]))
        return None

    def _hyperbolic(self, name: str, argument: Fraction) -> Fraction:
        t = self.tower
        e = self.exponential(argument)
        inverse = self.exponential(self.negative(argument))
        plus = t.sum([e, inverse])
        minus = t.sum([e, self.negative(inverse)])
        half = t.number(fmpq(1, 2))
        match name:
            case "sinh":
                return t.times(half, minus)
            case "cosh":
                return t.times(half, plus)
            case "tanh":
                return t.times(minus, t.reciprocal(plus))
            case "coth":
                return t.times(plus, t.reciprocal(minus))
            case "sech":
                return t.times(t.number(2), t.reciprocal(plus))
            case _:
                return t.times(t.number(2), t.reciprocal(minus))

    # -- atoms -----------------------------------------------------------------------------------

    def atom(self, kernel: Hashable, sign: str) -> Fraction:
        """Return a generator without relation, of the given sign."""
        index = self.tower.generator(kernel)
        self.signs.declare(index, sign)
        return Fraction(self.tower.monomial(index))

    def _symbol(self, symbol: sp.Basic) -> Fraction:
        if declared_complex(symbol):
            sign = ""
        elif symbol.is_positive:
            sign = "+"
        elif symbol.is_negative:
            sign = "-"
        elif symbol.is_nonnegative:
            sign = "0+"
        elif symbol.is_nonpositive:
            sign = "0-"
        else:
            sign = "real"
        return self.atom(("symbol", symbol), sign)

    def _imaginary_unit(self) -> Fraction:
        kernel = ("I",)
        if not self.tower.knows(kernel):
            self.tower.relate(self.tower.generator(kernel), 2, self.tower.constant(-1))
        return Fraction(self.tower.monomial(self.tower.generator(kernel)))

    def _opaque(self, expr: sp.Basic) -> Fraction:
        """Return a kernel that is equal for equal functions of equal arguments."""
        if isinstance(expr, Derivative | Subs) and expr.has(AppliedUndef):
            return self.atom(_derivative_key(expr, self), "real")
        if not isinstance(expr, sp.Function) or not expr.args:
            return self.atom(("opaque", expr), "")
        arguments = [self.tower.canonical(self.form(a)) for a in expr.args]
        keys = tuple(self.fraction_key(a) for a in arguments)
        real = isinstance(expr, AppliedUndef) or isinstance(expr, sp.atan | sp.acot | sp.asinh | sp.atan2)
        real = real and all(self.is_real(a) for a in arguments)
        return self.atom((expr.func, keys), "real" if real else "")

    def fraction_key(self, f: Fraction) -> Hashable:
        """Return a hashable value equal for equal canonical fractions."""
        return (self.tower.key(f.num), frozenset((self.tower.key(self.tower.base(i)), e) for i, e in f.den))

    def is_real(self, f: Fraction) -> bool:
        """Tell whether a fraction is proven real wherever it is defined."""
        return self.signs.real(f.num) and all(self.signs.real(self.tower.base(i)) for i, _ in f.den)

    def negative(self, f: Fraction) -> Fraction:
        """Return −f."""
        return Fraction(-f.num, f.den)

    def _only_kernel(self, f: Fraction) -> tuple[Any, ...] | None:
        """Return the kernel that ``f`` is, to the first power and without coefficient, if it is one."""
        if f.den or len(f.num) != 1 or f.num.total_degree() != 1 or f.num.leading_coefficient() != 1:
            return None
        return self.tower.generators[self.tower.used(f.num)[0]]

    def _denominator(self, f: Fraction) -> fmpq_mpoly:
        t = self.tower
        total = t.constant(1)
        for i, e in f.den:
            total = t.product(total, t.polynomial_power(t.base(i), e))
        return total

    # -- linear combinations of atoms ------------------------------------------------------------

    def _combination(self, f: Fraction) -> list[tuple[Fraction, fmpq]]:
        """Write f as Σ rᵢ·atomᵢ with rational rᵢ and monomials over the denominator as atoms."""
        t = self.tower
        f = t.canonical(f)
        found: list[tuple[Fraction, fmpq]] = []
        for monomial, coefficient in t.terms(f.num):
            p = t.constant(1)
            for k, e in monomial:
                p = p * t.monomial(k, e)
            found.append((Fraction(p, f.den), coefficient))
        return found

    def _divided(self, kind: str, key: Hashable, coefficient: fmpq) -> int:
        """Return the number of parts that make ``coefficient`` a whole multiple, or ask to refine."""
        have = self.parts.get((kind, key), 1)
        need = lcm(have, int(coefficient.q))
        if need != have:
            self.parts[(kind, key)] = need
            raise Refine
        if abs(coefficient) * need > LARGEST_MULTIPLE:
            raise TooLarge(f"a multiple of {abs(coefficient) * need} of one argument")
        return need

    def _imaginary_split(self, f: Fraction) -> tuple[Fraction, Fraction]:
        """Write f = a + I·b; the denominator keeps whatever I it has, as one atom."""
        t = self.tower
        if not t.knows(("I",)):
            return f, t.number(0)
        i = t.generator(("I",))
        a, b = t.constant(0), t.constant(0)
        for monomial, coefficient in t.terms(t.reduce(f.num)):
            p = t.constant(coefficient)
            for k, e in monomial:
                if k != i:
                    p = p * t.monomial(k, e)
            if any(k == i for k, _ in monomial):
                b = b + p
            else:
                a = a + p
        return Fraction(a, f.den), Fraction(b, f.den)

    # -- exponentials and angles -----------------------------------------------------------------

    def exponential(self, f: Fraction) -> Fraction:
        """Return exp(f).

        exp is entire: exp(Σ rᵢ aᵢ) = Π exp(aᵢ/d)^(d rᵢ) and exp(i b) = cos b + i sin b hold everywhere.
        exp(r log u) is the principal power u^r by definition.
        """
        t = self.tower
        a, b = self._imaginary_split(f)
        factors: list[Fraction] = []
        for atom, r in self._combination(a):
            factors.append(self._exponential_part(atom, r))
        if not b.num.is_zero():
            c, s = self.cos_sin(b)
            factors.append(t.sum([c, t.times(self._imaginary_unit(), s)]))
        return t.times(*factors)

    def _exponential_part(self, atom: Fraction, r: fmpq) -> Fraction:
        t = self.tower
        logged = self._only_kernel(atom)
        if logged is not None and logged[0] == "log":
            return self.root(self._logged[logged], r)
        key = self.fraction_key(atom)
        parts = self._divided("exp", key, r)
        kernel = ("exp", key, parts)
        generator = self.atom(kernel, "+" if self.is_real(atom) else "")
        self._exponents[kernel] = (atom, parts)
        return t.power(generator, int((r * parts).p))

    def cos_sin(self, f: Fraction) -> tuple[Fraction, Fraction]:
        """Return (cos f, sin f) by the addition theorems, which hold for complex arguments as well."""
        t = self.tower
        a, b = self._imaginary_split(f)
        c, s = t.number(1), t.number(0)
        for atom, r in self._combination(a):
            c, s = self._turned((c, s), self._multiple_angle(atom, r))
        if not b.num.is_zero():
            e, inverse = self.exponential(b), self.exponential(self.negative(b))
            half = t.number(fmpq(1, 2))
            cosh = t.times(half, t.sum([e, inverse]))
            sinh = t.times(half, t.sum([e, self.negative(inverse)]))
            c, s = self._turned((c, s), (cosh, t.times(self._imaginary_unit(), sinh)))
        return c, s

    def _turned(
        self, first: tuple[Fraction, Fraction], second: tuple[Fraction, Fraction]
    ) -> tuple[Fraction, Fraction]:
        t = self.tower
        (c1, s1), (c2, s2) = first, second
        cos = t.sum([t.times(c1, c2), self.negative(t.times(s1, s2))])
        return cos, t.sum([t.times(s1, c2), t.times(c1, s2)])

    def _multiple_angle(self, atom: Fraction, r: fmpq) -> tuple[Fraction, Fraction]:
        t = self.tower
        key = self.fraction_key(atom)
        if self._only_kernel(atom) == ("pi",):
            return self._angle_of_pi(r)
        parts = self._divided("angle", key, r)
        n = int((r * parts).p)
        c, s = self._base_angle(("angle", key, parts), "real" if self.is_real(atom) else "")
        result = (t.number(1), t.number(0))
        square = (c, s)
        k = abs(n)
        while k:
            if k & 1:
                result = self._turned(result, square)
            k >>= 1
            if k:
                square = self._turned(square, square)
        return (result[0], self.negative(result[1])) if n < 0 else result

    def _base_angle(self, kernel: Hashable, sign: str) -> tuple[Fraction, Fraction]:
        """Return cos and sin of one atom as two generators with s² = 1 − c²."""
        t = self.tower
        c = self.atom(("cos", kernel), sign)
        fresh = not t.knows(("sin", kernel))
        s = self.atom(("sin", kernel), sign)
        if fresh:
            t.relate(t.generator(("sin", kernel)), 2, 1 - t.monomial(t.generator(("cos", kernel))) ** 2)
        return c, s

    def _angle_of_pi(self, r: fmpq) -> tuple[Fraction, Fraction]:
        """Return cos(rπ), sin(rπ): exact by SymPy's own table, else opaque real constants with s² = 1 − c²."""
        angle = sp.Rational(int(r.p), int(r.q)) % 2 * sp.pi
        c, s = sp.cos(angle), sp.sin(angle)
        if c.has(sp.cos, sp.sin) or s.has(sp.cos, sp.sin):
            return self._base_angle(("pi multiple", angle), "real")
        return self.form(c), self.form(s)

    # -- roots, powers, logarithms ---------------------------------------------------------------

    def _pow(self, expr: sp.Pow) -> Fraction:
        """Return a power; b^e = exp(e log b) is its definition for b ≠ 0.

        At b = 0 the functions x^e with e ≥ 0 are continuous from the right and others are undefined, so
        an identity of powers extends there.
        """
        base, exponent = expr.args
        if isinstance(exponent, sp.Integer):
            if abs(int(exponent)) > LARGEST_MULTIPLE:
                raise TooLarge(f"the exponent {exponent}")
            return self.tower.power(self.form(base), int(exponent))
        if isinstance(exponent, sp.Rational):
            return self.root(self.form(base), fmpq(int(exponent.p), int(exponent.q)))
        return self.exponential(self.tower.times(self.form(exponent), self.logarithm(self.form(base))))

    def _factors(self, f: Fraction) -> tuple[fmpq, list[tuple[fmpq_mpoly, int]]]:
        """Factor numerator and denominator over ℚ: content and (factor, exponent), positive leading terms."""
        t = self.tower
        f = t.canonical(f)
        if f.num.is_zero():
            raise ZeroDivisionError("a root or logarithm of zero")
        if len(f.num) > 200:
            unit, factors = (
                f.num.leading_coefficient(),
                [(f.num * t.constant(1 / f.num.leading_coefficient()), 1)],
            )
        else:
            unit, factors = f.num.factor()
        found = [(p, int(e)) for p, e in factors] + [(t.base(i), -e) for i, e in f.den]
        return unit, found

    def _split(
        self, f: Fraction
    ) -> tuple[fmpq, list[tuple[Fraction, int]], tuple[fmpq_mpoly, list[tuple[fmpq_mpoly, int]]]]:
        """Write f = |content| · Π positiveᵢ^eᵢ · rest with positiveᵢ ≥ 0 proven.

        (ab)^r = a^r b^r and log ab = log a + log b hold when a ≥ 0, so every proven factor may be taken
        out; an even power of a real factor is the same power of its modulus. The rest keeps the sign.
        """
        content, factors = self._factors(f)
        sign = 1 if content > 0 else -1
        outside: list[tuple[Fraction, int]] = []
        inside: list[tuple[fmpq_mpoly, int]] = []
        for p, e in factors:
            known = self.signs.of(p)
            if known.endswith("+"):
                outside.append((Fraction(p), e))
            elif known.endswith("-"):
                outside.append((Fraction(-p), e))
                sign = -sign if e % 2 else sign
            elif self.signs.real(p) and (e > 1 or e < 0):
                even = e - e % 2
                outside.append((self.absolute(Fraction(p)), even))
                if e % 2:
                    inside.append((p, 1))
            else:
                inside.append((p, e))
        return abs(content), outside, (self.tower.constant(sign), inside)

    def _rest(self, inside: tuple[fmpq_mpoly, list[tuple[fmpq_mpoly, int]]]) -> Fraction:
        t = self.tower
        num = Fraction(inside[0])
        for p, e in inside[1]:
            num = t.times(num, t.power(Fraction(p), e))
        return t.canonical(num)

    def root(self, f: Fraction, r: fmpq) -> Fraction:
        """Return the principal power f^r, r rational.

        (R^(1/n))^k = R^(k/n) holds for every R ≠ 0 and whole k, since |arg R|/n < π.
        """
        t = self.tower
        if r.q == 1:
            return t.power(f, int(r.p))
        if self.tower.is_zero(f):
            return t.power(t.number(0), 1 if r > 0 else -1)
        content, outside, inside = self._split(f)
        factors = [self._root_of_rational(content, r)]
        factors.extend(self._root_of_nonnegative(p, r * e) for p, e in outside)
        rest = self._rest(inside)
        if rest.num.is_constant() and not rest.den:
            if rest.num.leading_coefficient() < 0:
                c, s = self._angle_of_pi(r)
                factors.append(t.sum([c, t.times(self._imaginary_unit(), s)]))
        else:
            factors.append(self._root_kernel(rest, r, ""))
        return t.times(*factors)

    def _root_of_rational(self, number: fmpq, r: fmpq) -> Fraction:
        t = self.tower
        factors: list[Fraction] = []
        for n, side in ((int(number.p), 1), (int(number.q), -1)):
            if n == 1:
                continue
            primes = sp.factorint(n) if n <= LARGEST_FACTORED_INTEGER else {n: 1}
            for prime, e in primes.items():
                power = r * int(e) * side
                factors.append(self._root_kernel(t.number(int(prime)), power, "+"))
        return t.times(*factors)

    def _root_of_nonnegative(self, f: Fraction, r: fmpq) -> Fraction:
        """Return f^r for f ≥ 0; roots of exponentials and of roots are those of their arguments."""
        t = self.tower
        if r.q == 1:
            return t.power(f, int(r.p))
        kernel = self._only_kernel(f)
        if kernel is not None and kernel[0] in ("exp", "root"):
            if kernel[0] == "exp":
                atom, parts = self._exponents[kernel]
                return self._exponential_part(atom, r / parts)
            if kernel[0] == "root":
                radicand, parts = self._radicands[kernel]
                return self._root_kernel(radicand, r / parts, "0+")
        return self._root_kernel(f, r, self.signs.of(f.num) or "0+")

    def _root_kernel(self, radicand: Fraction, r: fmpq, sign: str) -> Fraction:
        """Return radicand^r by the generator ρ = radicand^(1/n), ρⁿ = radicand; whole powers come out."""
        t = self.tower
        whole = int(r.p) // int(r.q)
        part = r - whole
        outside = t.power(radicand, whole)
        if part == 0:
            return outside
        key = self.fraction_key(radicand)
        n = self._divided("root", key, part)
        kernel = ("root", key, n)
        if not t.knows(kernel):
            self._radicands[kernel] = (radicand, n)
            index = t.generator(kernel)
            if radicand.den:
                raise TooLarge("a root of a quotient")
            t.relate(index, n, radicand.num)
        generator = self.atom(kernel, sign)
        return t.times(outside, t.power(generator, int((part * n).p)))

    def logarithm(self, f: Fraction) -> Fraction:
        """Return log f: proven positive factors come out, log exp a = a for real a, log(−1) = iπ."""
        t = self.tower
        content, outside, inside = self._split(f)
        terms = [self._log_of_rational(content)]
        terms.extend(t.times(t.number(e), self._log_of_positive(p)) for p, e in outside)
        rest = self._rest(inside)
        if rest.num.is_constant() and not rest.den:
            if rest.num.leading_coefficient() < 0:
                terms.append(t.times(self._imaginary_unit(), self.form(sp.pi)))
        else:
            terms.append(self._log_kernel(rest, ""))
        return t.sum(terms)

    def _log_of_rational(self, number: fmpq) -> Fraction:
        t = self.tower
        terms: list[Fraction] = []
        for n, side in ((int(number.p), 1), (int(number.q), -1)):
            if n == 1:
                continue
            primes = sp.factorint(n) if n <= LARGEST_FACTORED_INTEGER else {n: 1}
            terms.extend(
                t.times(t.number(side * int(e)), self._log_kernel(t.number(int(prime)), "+"))
                for prime, e in primes.items()
            )
        return t.sum(terms)

    def _log_of_positive(self, f: Fraction) -> Fraction:
        t = self.tower
        kernel = self._only_kernel(f)
        if kernel is not None and kernel[0] in ("exp", "root"):
            if kernel[0] == "exp":
                atom, parts = self._exponents[kernel]
                return t.times(t.number(fmpq(1, parts)), atom)
            if kernel[0] == "root":
                radicand, parts = self._radicands[kernel]
                return t.times(t.number(fmpq(1, parts)), self._log_of_positive(radicand))
        return self._log_kernel(f, "real")

    def _log_kernel(self, f: Fraction, sign: str) -> Fraction:
        kernel = ("log", self.fraction_key(f))
        self._logged[kernel] = f
        return self.atom(kernel, sign)

    # -- modulus ---------------------------------------------------------------------------------

    def absolute(self, f: Fraction) -> Fraction:
        """Return |f|: |ab| = |a||b|; |p|² = p² for real p; |a + ib| = √(a² + b²)."""
        t = self.tower
        f = t.canonical(f)
        if f.num.is_zero():
            return f
        if not self.is_real(f):
            return self._complex_modulus(f)
        content, factors = self._factors(f)
        return t.times(t.number(abs(content)), *(t.power(self._modulus(p), e) for p, e in factors))

    def _modulus(self, p: fmpq_mpoly) -> Fraction:
        known = self.signs.of(p)
        if known:
            return Fraction(p if known.endswith("+") else -p)
        t = self.tower
        if p.leading_coefficient() < 0:
            p = -p
        kernel = ("abs", t.key(p))
        if not t.knows(kernel):
            t.relate(t.generator(kernel), 2, t.product(p, p))
        return self.atom(kernel, "0+")

    def _complex_modulus(self, f: Fraction) -> Fraction:
        t = self.tower
        a, b = self._imaginary_split(f)
        if self.is_real(a) and self.is_real(b):
            return self.root(t.sum([t.times(a, a), t.times(b, b)]), fmpq(1, 2))
        return self.atom(("modulus", self.fraction_key(f)), "0+")


def _derivative_key(expr: sp.Basic, forms: NormalForm) -> Hashable:
    """Return one key for ∂f at given arguments, whether SymPy writes Derivative or Subs."""
    inner, places = expr, {}
    if isinstance(expr, Subs):
        inner = expr.expr
        places = dict(zip(expr.variables, expr.point, strict=True))
    if isinstance(inner, Derivative) and isinstance(inner.expr, AppliedUndef):
        arguments = inner.expr.args
        counts = {v: int(n) for v, n in inner.variable_count if isinstance(n, sp.Integer)}
        plain = all(isinstance(a, sp.Symbol) or not (a.free_symbols & set(counts)) for a in arguments)
        distinct = all(sum(1 for a in arguments if a == v) == 1 for v in counts)
        if plain and distinct and len(counts) == len(inner.variable_count):
            orders = tuple(counts.get(a, 0) for a in arguments)
            at = _keys((places.get(a, a) for a in arguments), forms)
            return ("derivative", inner.expr.func, orders, at)
    return ("opaque", expr)


def _keys(arguments: Iterable[sp.Basic], forms: NormalForm) -> tuple[Hashable, ...]:
    return tuple(forms.fraction_key(forms.tower.canonical(forms.form(a))) for a in arguments)
