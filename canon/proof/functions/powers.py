"""Normal form of roots, exponentials, logarithms and moduli."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from flint import fmpq

from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.functions.angles import combination, cos_sin, divided, imaginary_split, phase_of_pi
from canon.proof.functions.large_powers import power
from canon.proof.functions.nested_roots import denested
from canon.proof.functions.number_logs import is_number, log_by_relations, primes_below, turns_of_number
from canon.proof.tower.algebraic_numbers import root_in_field
from canon.proof.tower.factors import apart, factors_of, modulus_of_polynomial, primes, split_signs
from canon.proof.tower.tower import Fraction

if TYPE_CHECKING:
    from flint import fmpq_mpoly

    from canon.proof.tower.forms import Forms

__all__ = ["exponential", "learn_zero", "logarithm", "modulus", "root"]


# -- exponentials --------------------------------------------------------------------------------------


def exponential(n: Forms, f: Fraction) -> Fraction:
    """Return exp(f).

    exp is entire: exp(Σ rᵢ aᵢ) = Π exp(aᵢ/d)^(d rᵢ) and exp(ib) = cos b + i sin b hold everywhere.
    exp(r log u) is the principal power u^r by definition. A kernel exp(a) with real a is positive; but
    where a holds log u it stands for u^y also at u = 0, so unless u ≠ 0 is proved it is only not negative,
    and its reciprocal may vanish as well (u^y with y < 0 in the denominator).
    """
    t = n.tower
    a, b = imaginary_split(n, f)
    factors = [_exponential_part(n, atom, r) for atom, r in combination(n, a)]
    if not b.num.is_zero():
        c, s = cos_sin(n, b)
        factors.append(t.sum([c, t.times(n.imaginary_unit, s)]))
    return t.times(*factors)


def _exponential_part(n: Forms, atom: Fraction, r: fmpq) -> Fraction:
    t = n.tower
    kernel = n.only_kernel(atom)
    if kernel is not None and kernel[0] == "log":
        return root(n, n.arguments[kernel], r)
    if (
        kernel is not None
        and kernel[0] is sp.LambertW
        and r.q == 1
        and (solved := _of_lambert_w(n, atom, kernel))
    ):
        return t.power(solved, int(r.p))
    key = n.fraction_key(atom)
    parts = divided(n, "exp", key, r)
    kernel = ("exp", key, parts)
    n.arguments[kernel] = n.scaled(fmpq(1, parts), atom)
    fresh = not t.knows(kernel)
    positive = _logarithms_defined(n, atom)
    generator = n.atom(
        kernel,
        ("+" if positive else "0+") if n.is_real(atom) else "",
        lambda: sp.exp(n.fraction_expression(n.arguments[kernel])),
    )
    if not positive:
        n.powers_of_zero.add(n.tower.generator(kernel))
    if fresh and (sign := n.sign(atom)):
        above = generator.num - 1 if sign.endswith("+") else 1 - generator.num
        n.signs.learn(above, strict=sign in ("+", "-"), combine=False)
    return t.power(generator, int((r * parts).p))


def _logarithms_defined(n: Forms, f: Fraction) -> bool:
    """Tell whether the argument of every logarithm in ``f`` is proven not to vanish."""
    kernels = {n.tower.generators[k] for p in (f.num, n.denominator(f)) for k in n.tower.used(p)}
    return all(n.sign(n.arguments[k]) in ("+", "-") for k in kernels if k[0] == "log")


def _of_lambert_w(n: Forms, w: Fraction, kernel: tuple[object, ...]) -> Fraction | None:
    """Return exp(W(z)) = z/W(z) for z ≠ 0 (W(z) exp W(z) = z on every branch; but for W₀ none has a value at 0)."""
    z = n.arguments.get(kernel)
    principal = len(cast("tuple[object, ...]", kernel[1])) == 1
    if z is None or (principal and n.sign(z) not in ("+", "-")):
        return None
    return n.over(z, w)


# -- roots ---------------------------------------------------------------------------------------------


def root(n: Forms, f: Fraction, r: fmpq) -> Fraction:
    """Return the principal power f^r for rational r.

    (R^(1/n))^k = R^(k/n) holds for every R ≠ 0 and whole k, since |arg R|/n < π; (−1)^r = exp(iπr).
    """
    t = n.tower
    if r.q == 1:
        return t.power(f, int(r.p))
    if t.is_zero(f):
        return t.power(t.number(0), 1 if r > 0 else -1)
    f, known = _without_squares(n, f, r)
    content, outside, rest = split_signs(n, f)
    outside.sort(key=lambda power: n.signs.of(power[0].num) != "+")
    factors = [known]
    factors += [_root_kernel(n, t.number(p), r * e, "+") for p, e in primes(content)]
    factors.extend(_root_of_nonnegative(n, p, r * e) for p, e in outside)
    if rest.num.is_constant() and not rest.den:
        if rest.num.leading_coefficient() < 0:
            c, s = phase_of_pi(n, r)
            factors.append(t.sum([c, t.times(n.imaginary_unit, s)]))
    else:
        factors.append(_root_kernel(n, rest, r, ""))
    return t.times(*factors)


def _without_squares(n: Forms, f: Fraction, r: fmpq) -> tuple[Fraction, Fraction]:
    """Return f without its factors σ² > 0 with a known root σ > 0, such as 1 − m sn² = dn², and their power."""
    t = n.tower
    known = t.number(1)
    for square, sigma in n.squares if r.q == 2 else ():
        while (quotient := t.quotient(f.num, square)) is not None and not quotient.is_zero():
            f, known = Fraction(quotient, f.den), t.times(known, t.power(sigma, int(r.p)))
    return f, known


def learn_zero(n: Forms, p: fmpq_mpoly) -> None:
    """Take p = 0; where that is s² = R with a real symbol s and R in earlier ones, s² is replaced, and √R = |s|."""
    t = n.tower
    t.learn_zero(p)
    if p.is_constant():
        n.empty = n.empty or not p.is_zero()
        return
    last = t.used(p)[-1]
    coefficients = t.coefficients(p, last)
    square = len(coefficients) == 3 and coefficients[1].is_zero() and coefficients[2].is_constant()
    free = t.generators[last][0] == "symbol" and t.relation(last) is None
    if not (square and free and n.signs.real(t.monomial(last))):
        return
    other = t.reduce(-coefficients[0] * t.constant(1 / coefficients[2].leading_coefficient()))
    if n.signs.real(other):
        t.relate(last, 2, other)
        n.signs.learn(other, strict=False)
        n.known_roots[n.fraction_key(Fraction(other))] = modulus(n, Fraction(t.monomial(last)))


def _root_of_nonnegative(n: Forms, f: Fraction, r: fmpq) -> Fraction:
    """Return f^r for f ≥ 0; powers of exponentials and of roots have those of their arguments."""
    t = n.tower
    if r.q == 1:
        return t.power(f, int(r.p))
    kernel = n.only_kernel(f)
    if kernel is not None and kernel[0] == "exp":
        return exponential(n, n.scaled(r, n.arguments[kernel]))
    if kernel is not None and kernel[0] == "root":
        return _root_kernel(n, n.arguments[kernel], r / kernel[2], "0+")
    return _root_kernel(n, f, r, n.signs.of(f.num) or "0+")


def _root_kernel(n: Forms, radicand: Fraction, r: fmpq, sign: str) -> Fraction:
    """Return radicand^r through ρ = radicand^(1/m), ρᵐ = radicand; whole powers come out."""
    t = n.tower
    whole = int(r.p) // int(r.q)
    part = r - whole
    outside = power(n, radicand, whole)
    if part == 0:
        return outside
    key = n.fraction_key(radicand)
    m = divided(n, "root", key, part)
    kernel = ("root", key, m)
    if not t.knows(kernel):
        if radicand.den:
            return t.times(outside, _root_of_fraction(n, radicand, m, int((part * m).p)))
        if m > 2 and sign == "+" and (alpha := _root_of_number(n, radicand, m)) is not None:
            return t.times(outside, t.power(alpha, int((part * m).p)))
        if m == 2 and sign and (known := n.known_roots.get(key) or denested(n, radicand.num)):
            n.known_roots[key] = known
            return t.times(outside, known)
        n.arguments[kernel] = radicand
        index = t.generator(kernel)
        t.relate(index, m, radicand.num)
    rho = n.atom(kernel, sign, lambda: n.fraction_expression(radicand) ** sp.Rational(1, m))
    return t.times(outside, t.power(rho, int((part * m).p)))


def _root_of_fraction(n: Forms, radicand: Fraction, m: int, k: int) -> Fraction:
    """Return (N/D)^(k/m) = σᵏ/Dᵏ with the kernel σ = D·(N/D)^(1/m), for which σᵐ = N·Dᵐ⁻¹."""
    t = n.tower
    below = n.denominator(radicand)
    kernel = ("scaled root", n.fraction_key(radicand), m)
    if not t.knows(kernel):
        power_of_kernel = t.product(radicand.num, t.polynomial_power(below, m - 1))
        n.arguments[kernel] = radicand
        t.relate(t.generator(kernel), m, power_of_kernel)
    sigma = n.atom(
        kernel, "", lambda: n.expression(below) * n.fraction_expression(radicand) ** sp.Rational(1, m)
    )
    return t.times(t.power(sigma, k), t.power(t.reciprocal(Fraction(below)), k))


def _root_of_number(n: Forms, radicand: Fraction, m: int) -> Fraction | None:
    """Return ᵐ√p for a positive number p of a quadratic field where the root lies in that field: ³√(2 + √5) = φ."""
    if not is_number(n, radicand):
        return None
    with precision(128):
        try:
            size = value(n.expression(radicand.num), {}).real.root(m)
        except (NotDecided, Undefined, Unmodelled):
            return None
        alpha = root_in_field(n.tower, radicand.num, m, size)
    return Fraction(alpha) if alpha is not None and n.signs.of(alpha) == "+" else None


# -- logarithms ----------------------------------------------------------------------------------------


def logarithm(n: Forms, f: Fraction, *, whole_powers: bool = False) -> Fraction:
    """Return log f: factors proven positive come out, log exp a = a for real a, log(−1) = iπ, log i = iπ/2.

    With ``whole_powers`` only exp(k log f) with whole k is wanted; then every factor may come out, because
    (ab)^k = a^k b^k for all a, b ≠ 0.
    """
    t = n.tower
    if t.is_zero(f):
        raise ZeroDivisionError("the logarithm of zero")
    content, outside, rest = apart(n, f) if whole_powers else split_signs(n, f)
    terms = [n.scaled(e, _log_kernel(n, t.number(p), "+")) for p, e in primes(content)]
    terms.extend(n.scaled(e, _log_of_factor(n, p)) for p, e in outside)
    if rest.num.is_constant() and not rest.den:
        if rest.num.leading_coefficient() < 0:
            terms.append(t.times(n.imaginary_unit, n.pi))
    elif (log := _log_of_complex_number(n, rest)) is not None:
        terms.append(log)
    else:
        terms.append(_log_kernel(n, rest, ""))
    return t.sum(terms)


def _log_of_complex_number(n: Forms, z: Fraction) -> Fraction | None:
    """Return log z = log(z z̄)/2 + iπr for a number whose argument is a rational multiple of π."""
    turns = turns_of_number(n, z)
    if turns is None:
        return None
    t = n.tower
    a, b = imaginary_split(n, z)
    size = t.sum([t.times(a, a), t.times(b, b)])
    phase = n.scaled(turns, t.times(n.imaginary_unit, n.pi))
    return t.sum([n.scaled(fmpq(1, 2), logarithm(n, size)), phase])


def _log_of_number(n: Forms, g: fmpq_mpoly) -> Fraction:
    """Return log g for an algebraic number g > 0, through logarithms met before where powers of them make g."""
    logs = {p: _log_kernel(n, n.tower.number(p), "+") for p in primes_below(n, g)}
    found = log_by_relations(n, g, logs)
    if found is None:
        f = Fraction(g)
        found = _log_kernel(n, f, n.sign(n.minus(f, n.tower.number(1))) or "real")
        n.number_logs.append((g, found))
    return found


def _log_of_factor(n: Forms, f: Fraction) -> Fraction:
    """Return log f, real only where f ≥ 0 is proven (at f = 0 neither side is defined).

    log exp a = a holds for real a, and up to a multiple of 2πi for others, which is all that whole powers
    need. The principal log R^(1/m) is (log R)/m, where log R must be the principal value itself.
    """
    kernel = n.only_kernel(f)
    if kernel is not None and kernel[0] == "exp":
        return n.arguments[kernel]
    if kernel is not None and kernel[0] == "root":
        radicand = n.arguments[kernel]
        positive = n.sign(radicand).endswith("+")
        inner = _log_of_factor(n, radicand) if positive else _log_kernel(n, radicand, "")
        return n.scaled(fmpq(1, kernel[2]), inner)
    if not n.sign(f).endswith("+"):
        return _log_of_complex_number(n, f) or _log_kernel(n, f, "")
    if is_number(n, f):
        return _log_of_number(n, f.num)
    return _log_kernel(n, f, n.sign(n.minus(f, n.tower.number(1))) or "real")


def _log_kernel(n: Forms, f: Fraction, sign: str) -> Fraction:
    kernel = ("log", n.fraction_key(f))
    n.arguments[kernel] = f
    return n.atom(kernel, sign, lambda: sp.log(n.fraction_expression(f)))


# -- moduli --------------------------------------------------------------------------------------------


def modulus(n: Forms, f: Fraction) -> Fraction:
    """Return |f|: |ab| = |a||b|; |p|² = p² for real p; |a + ib| = √(a² + b²)."""
    t = n.tower
    f = t.canonical(f)
    if f.num.is_zero():
        return f
    if not n.is_real(f):
        return _complex_modulus(n, f)
    content, factors = factors_of(n, f.num)
    result = t.number(abs(content))
    for p, e in factors + [(t.base(i), -e) for i, e in f.den]:
        result = t.times(result, t.power(modulus_of_polynomial(n, p), e))
    return result


def _complex_modulus(n: Forms, f: Fraction) -> Fraction:
    t = n.tower
    a, b = imaginary_split(n, f)
    if n.is_real(a) and n.is_real(b):
        return root(n, t.sum([t.times(a, a), t.times(b, b)]), fmpq(1, 2))
    return n.atom(("modulus", n.fraction_key(f)), "0+", lambda: sp.Abs(n.fraction_expression(f)))
