"""Series expansions: functions analytic at a place, and the first terms of their expansions there.

Elliptic integrals at m = 0 and Lambert's W at 0 are analytic, though SymPy's formulas for their derivatives are
quotients that are 0/0 there: their series are written down instead (M. Abramowitz and I. A. Stegun, Handbook of
Mathematical Functions, 17.3.11, 17.3.12; R. M. Corless et al., Adv. Comput. Math. 5 (1996) 329, eq. 3.1).
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.question.deadline import SIDE_SECONDS
from canon.expression.symbols.jacobi_functions import JACOBI
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.proof.analytic import proved_sign
from canon.proof.domain.reality import certainly_real
from canon.proof.domain.verdict import Undecided
from canon.proof.kinks import vanishes_off_kinks
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.proof.domain.domain import Domain

__all__ = ["check_analytic", "coefficient", "coefficients", "without_kinks"]

_LARGEST_POWER = 16
"""Whole powers up to which products are multiplied out; of higher ones derivatives are taken."""

_WITHOUT_END = (sp.Max, sp.Min, sp.Piecewise, sp.Heaviside)


def check_analytic(f: Expr, place: Mapping[Symbol, Expr], domain: Domain) -> None:
    """Refuse what is not certainly analytic where some symbols have these values.

    Raises
    ------
    Undecided
        Naming the part.

    Examples
    --------
    >>> from canon.proof.domain.domain import Domain
    >>> m = sp.Symbol("m", real=True)
    >>> check_analytic(sp.elliptic_k(m), {m: sp.S.Zero}, Domain())
    >>> check_analytic(sp.elliptic_k(1 + m), {m: sp.S.Zero}, Domain())
    Traceback (most recent call last):
        ...
    canon.proof.domain.verdict.Undecided: elliptic_k(m + 1) is not certainly analytic there, ...
    """
    moving = tuple(place)
    pieces = sorted((part for part in f.atoms(*_WITHOUT_END) if part.has(*moving)), key=sp.default_sort_key)
    for part in (
        *pieces,
        *sp.preorder_traversal(f),
    ):  # pieces first: SymPy may fail to compare their values there
        if isinstance(part, Expr) and part.has(*moving) and not _analytic(part, place, domain):
            raise Undecided(
                f"{part} is not certainly analytic there, so no expansion of it is proved; narrow the domain"
            )


def _analytic(part: Expr, place: Mapping[Symbol, Expr], domain: Domain) -> bool:
    """Tell whether a function is certainly analytic at the values that its arguments have at a place."""

    def positive(u: Expr) -> bool:
        return proved_sign(u, domain) == "+"

    def nonzero(u: Expr) -> bool:
        return vanishes_off_kinks(u, domain, budget=SIDE_SECONDS).fails

    if isinstance(part, sp.Pow):
        base = substitute(part.base, place)
        if part.exp.is_integer:
            return not part.exp.is_negative or nonzero(base)
        return positive(base) and (not part.exp.has(*place) or bool(part.base.is_positive))
    if not isinstance(part, sp.Function):
        return not isinstance(part, _WITHOUT_END)
    there = [substitute(a, place) for a in arguments(part)]
    match part:
        case sp.tan() | sp.sec():
            return nonzero(sp.cos(there[0]))
        case sp.cot() | sp.csc():
            return nonzero(sp.sin(there[0]))
        case sp.log():
            return all(map(positive, there))
        case sp.asin() | sp.acos() | sp.atanh():
            return positive(1 - there[0] ** 2)
        case sp.acosh() | sp.acoth():
            return positive(there[0] - 1)
        case sp.acot():
            return proved_sign(there[0], domain) in ("+", "-")
        case sp.LambertW():
            return len(there) == 1 and positive(1 + sp.E * there[0])
        case sp.elliptic_k() | sp.elliptic_e() | sp.elliptic_f():
            return positive(1 - there[-1])
        case sp.elliptic_pi():
            return positive(1 - there[-1]) and positive(1 - there[0])
        case _ if isinstance(part, JACOBI):
            return all(map(certainly_real, there))
        case sp.atan2():
            return positive(there[1]) or proved_sign(there[0], domain) in ("+", "-")
        case sp.Abs() | sp.sign():
            return proved_sign(there[0], domain) in ("+", "-")
        case _:
            return not isinstance(part, _WITHOUT_END)


def without_kinks(f: Expr, place: Mapping[Symbol, Expr], domain: Domain) -> Expr:
    """Write |u| and sign(u) as what they are near a place where u has a sign.

    Examples
    --------
    >>> from canon.proof.domain.domain import Domain
    >>> x, a = sp.Symbol("x", real=True), sp.Symbol("a", positive=True)
    >>> without_kinks(abs(x - a), {x: sp.S.Zero}, Domain())
    a - x
    """
    known: dict[Expr, Expr] = {}
    for part in f.atoms(sp.Abs, sp.sign):
        u = arguments(part)[0]
        there = proved_sign(substitute(u, place), domain) if part.has(*place) else ""
        if there in ("+", "-"):
            side = sp.S.One if there == "+" else sp.S.NegativeOne
            known[part] = side if isinstance(part, sp.sign) else side * u
    return exchanged(f, known)


def coefficient(f: Expr, epsilon: Symbol, k: int) -> Expr:
    """Return the coefficient of order k of a function that is analytic at ε = 0.

    Raises
    ------
    Undecided
        Where it is not finite.

    Examples
    --------
    >>> e = sp.Symbol("e", real=True)
    >>> [coefficient(sp.elliptic_k(e), e, k) for k in range(3)]
    [pi/2, pi/8, 9*pi/128]
    """
    return coefficients(f, epsilon, k)[k]


def coefficients(f: Expr, epsilon: Symbol, order: int) -> list[Expr]:
    """Return the coefficients of orders 0 to the given one of a function that is analytic at ε = 0.

    Raises
    ------
    Undecided
        Where one is not finite.

    Examples
    --------
    >>> e, x = sp.symbols("e x", positive=True)
    >>> coefficients(sp.sqrt(x + e) * (1 + e) ** 2, e, 1)
    [sqrt(x), 2*sqrt(x) + 1/(2*sqrt(x))]
    """
    found = _taylor(_with_series(f, epsilon, order), epsilon, order)
    for k, each in enumerate(found):
        if each.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
            raise Undecided(
                f"the coefficient of order {k} is not finite, so this is no expansion in whole powers"
            )
    return found


def _taylor(f: Expr, epsilon: Symbol, order: int) -> list[Expr]:
    """Return Taylor's coefficients: of sums, products and powers by those of their parts, of others by derivatives."""
    if not f.has(epsilon):
        return [f, *[sp.S.Zero] * order]
    if isinstance(f, sp.Add):
        parts = (_taylor(part, epsilon, order) for part in arguments(f))
        return [sp.Add(*of_one_order) for of_one_order in zip(*parts, strict=True)]
    if isinstance(f, sp.Mul):
        return functools.reduce(_product, (_taylor(part, epsilon, order) for part in arguments(f)))
    found = _of_power(f, epsilon, order) if isinstance(f, sp.Pow) else None
    return found or [_by_derivative(f, epsilon, k) for k in range(order + 1)]


def _of_power(f: sp.Pow, epsilon: Symbol, order: int) -> list[Expr] | None:
    """Return the coefficients of a constant power; None where derivatives are to be taken."""
    if f.exp.has(epsilon):
        return None
    base = _taylor(f.base, epsilon, order)
    if f.exp.is_Integer and 0 < int(f.exp) <= _LARGEST_POWER:
        return functools.reduce(_product, [base] * int(f.exp))
    if base[0] != 0 and (f.exp.is_negative or not f.exp.is_integer):
        return _power(base, f.exp)
    return None


def _by_derivative(f: Expr, epsilon: Symbol, k: int) -> Expr:
    slope = f.diff(epsilon, k) if k else f
    return substitute(slope, {epsilon: sp.S.Zero}) / sp.factorial(k)


def _product(a: Sequence[Expr], b: Sequence[Expr]) -> list[Expr]:
    """Return the coefficients of a product: Cauchy's, Σ aⱼ bₖ₋ⱼ."""
    return [sp.Add(*(a[j] * b[k - j] for j in range(k + 1))) for k in range(len(a))]


def _power(a: Sequence[Expr], r: Expr) -> list[Expr]:
    """Return the coefficients of a power: k a₀ cₖ = Σ (j r − k + j) aⱼ cₖ₋ⱼ, as c a′ r = a c′ (L. Euler)."""
    c = [a[0] ** r]
    for k in range(1, len(a)):
        c.append(sp.Add(*((j * r - k + j) * a[j] * c[k - j] for j in range(1, k + 1))) / (k * a[0]))
    return c


def _with_series(f: Expr, epsilon: Symbol, order: int) -> Expr:
    """Replace functions of what vanishes at ε = 0 by their first terms; what is left out is of higher order."""
    known: dict[Expr, Expr] = {}
    for part in sorted(f.atoms(sp.elliptic_k, sp.elliptic_e, sp.LambertW), key=sp.default_sort_key):
        small = arguments(part)[-1]
        if part.has(epsilon) and substitute(small, {epsilon: sp.S.Zero}) == 0:
            inner = _with_series(small, epsilon, order)
            known[part] = sp.Add(*(_term(part, j) * inner**j for j in range(order + 1)))
    return exchanged(f, known)


def _term(part: Expr, j: int) -> Expr:
    """Return the coefficient of order j of a function at zero."""
    match part:
        case sp.LambertW():
            return sp.Rational((-j) ** (j - 1), sp.factorial(j)) if j else sp.S.Zero
        case sp.elliptic_k():
            return sp.pi / 2 * sp.Rational(sp.binomial(2 * j, j), 4**j) ** 2
        case sp.elliptic_e() if len(part.args) == 1:
            return sp.pi / 2 * sp.Rational(sp.binomial(2 * j, j), 4**j) ** 2 / (1 - 2 * j)
        case _:
            return sp.binomial(sp.S.Half, j) * (-1) ** j * _integral_of_sine(j, arguments(part)[0])


def _integral_of_sine(j: int, phi: Expr) -> Expr:
    """Return the integral of the sine to the power 2j from 0 to φ."""
    if j == 0:
        return phi
    below = _integral_of_sine(j - 1, phi)
    return (sp.Integer(2 * j - 1) * below - sp.cos(phi) * sp.sin(phi) ** (2 * j - 1)) / (2 * j)
