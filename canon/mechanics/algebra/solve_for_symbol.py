"""Equations solved for one symbol through the functions that it stands in: cos θ = 2/3 gives θ = ± acos 2/3 + 2πn.

All real solutions are found, none that is not one: each comes with what must not be negative for it. Sine and cosine
of one angle u become one by sin² = 1 − cos², or quotients in tan(u/2); u = π, which has no such tangent, is looked at
for itself.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.mechanics.algebra.substitution import exchanged, symbols_of
from canon.proof.domain.reality import certainly_real
from canon.proof.trees.polynomial import polynomial_factors
from canon.proof.trees.polynomial_roots import Root, polynomial_in, real_roots
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.proof.domain.domain import Domain

__all__ = ["named", "real_solutions"]

MOST_LAYERS = 4
MOST_TURNS = 24
"""Whole turns of a bounded angle that are told apart."""
SLACK = 1e-9
"""What is left to rounding at the bounds of an angle: a solution too many is taken away by the domain."""


def real_solutions(equation: Expr, symbol: Symbol, domain: Domain) -> list[Root] | None:
    """Return the real solutions of ``equation = 0`` on a domain, None where they have no closed form here.

    Parameters
    ----------
    equation
        What should vanish; not a polynomial in the symbol.
    symbol
        What it is solved for.
    domain
        Where. A bounded angle is told apart from those a whole turn away; else an integer says how many turns.

    Examples
    --------
    >>> from canon.proof.domain.domain import Domain
    >>> x = sp.Symbol("x", real=True)
    >>> [root.value for root in real_solutions(3 * sp.cos(x) - 2, x, Domain((x > 0, x < 3)))]
    [acos(2/3)]
    >>> real_solutions(sp.cos(x) - x, x, Domain()) is None
    True
    """
    found = _solved(equation, symbol, MOST_LAYERS)
    if found is None:
        return None
    return [told for root in found for told in _turns_told_apart(root, symbol, domain)]


def _polynomial_roots(equation: Expr, unknown: Expr) -> list[Root] | None:
    """Return the real roots of a polynomial in one symbol or function; None where they are not written in roots."""
    x = sp.Dummy("x", real=True)
    poly = polynomial_in(exchanged(equation, {unknown: x}), x)
    return None if poly is None else real_roots(poly)


def named(value: Expr) -> Expr:
    """Return a value with its number of turns written as an integer n.

    Examples
    --------
    >>> named(2 * sp.pi * sp.Dummy("n", integer=True))
    2*pi*n
    """
    return exchanged(value, {n: sp.Symbol(n.name, integer=True) for n in value.atoms(sp.Dummy)})


def _solved(equation: Expr, symbol: Symbol, layers: int) -> list[Root] | None:
    """Return the real solutions, factor by factor."""
    if layers == 0:
        return None
    found: list[Root] = []
    for factor, _ in polynomial_factors(equation):
        if factor.has(symbol):
            roots = _of_factor(factor, symbol, layers)
            if roots is None:
                return None
            found += roots
        elif not factor.is_nonzero:  # where it vanishes every value of the symbol would do
            return None
    return found


def _of_factor(factor: Expr, symbol: Symbol, layers: int) -> list[Root] | None:
    kernels = _kernels(factor, symbol)
    if len(kernels) > 1:
        factor, kernels = _by_one_function(factor, kernels)
    if len(kernels) == 2:
        return _by_half_angle(factor, kernels, symbol, layers)
    if len(kernels) != 1:
        return None
    (kernel,) = kernels
    roots = _polynomial_roots(factor, kernel)
    if roots is None or kernel == symbol:
        return roots
    found: list[Root] = []
    for root in roots:
        inner = _undone(kernel, root.value)
        if inner is None:
            return None
        for gap, conditions in inner:
            further = _solved(gap, symbol, layers - 1)
            if further is None:
                return None
            found += [deeper.inside((*root.conditions, *conditions)) for deeper in further]
    return found


def _kernels(factor: Expr, symbol: Symbol) -> list[Expr]:
    """Return the generators of a polynomial that depend on a symbol."""
    try:
        gens = sp.Poly(factor).gens
    except sp.PolynomialError:
        return []
    return [g for g in gens if g.has(symbol)]


def _by_one_function(factor: Expr, kernels: list[Expr]) -> tuple[Expr, list[Expr]]:
    """Write even powers of the sine by the cosine, or of the cosine by the sine."""
    if not _sine_and_cosine(kernels):
        return factor, kernels
    for kernel, other in (kernels, kernels[::-1]):
        square = sp.Dummy("square")
        poly = sp.Poly(factor, kernel)
        if all(power % 2 == 0 for (power,) in poly.monoms()):
            even = sp.Add(*(c * square ** (power // 2) for (power,), c in poly.terms()))
            return sp.expand(exchanged(even, {square: 1 - other**2})), [other]
    return factor, kernels


def _sine_and_cosine(kernels: list[Expr]) -> bool:
    kinds = {kernel.func for kernel in kernels}
    return len(kernels) == 2 and kinds == {sp.sin, sp.cos} and len({k.args for k in kernels}) == 1


def _by_half_angle(factor: Expr, kernels: list[Expr], symbol: Symbol, layers: int) -> list[Root] | None:
    if not _sine_and_cosine(kernels):
        return None
    angle = arguments(kernels[0])[0]
    tangent = sp.Dummy("tangent", real=True)
    values = {
        sp.sin(angle): 2 * tangent / (1 + tangent**2),
        sp.cos(angle): (1 - tangent**2) / (1 + tangent**2),
    }
    if not certainly_real(angle):
        return None
    numerator = sp.numer(sp.together(exchanged(factor, values)))
    found: list[Root] = []
    for part, _ in polynomial_factors(numerator):
        roots = _polynomial_roots(part, tangent) if part.has(tangent) else []
        if roots is None:
            return None
        for root in roots:
            further = _solved(angle - 2 * sp.atan(root.value) - _turns(2), symbol, layers - 1)
            if further is None:
                return None
            found += [deeper.inside(root.conditions) for deeper in further]
    if exchanged(factor, {sp.sin(angle): sp.S.Zero, sp.cos(angle): sp.S.NegativeOne}) == 0:
        opposite = _solved(angle - sp.pi - _turns(2), symbol, layers - 1)
        if opposite is None:
            return None
        found += opposite
    return found


def _turns(halves: int) -> Expr:
    return halves * sp.pi * sp.Dummy("n", integer=True)


def _undone(kernel: Expr, value: Expr) -> list[tuple[Expr, tuple[Expr, ...]]] | None:
    """Return what vanishes where a function has a value, in each case with what must not be negative then."""
    inside = arguments(kernel)[0]
    if isinstance(kernel, sp.asin | sp.acos | sp.atan):
        return [_undone_inverse(kernel, inside, value)]
    if isinstance(kernel, sp.Pow):
        if kernel.exp == sp.S.Half:
            return [(inside - value**2, (value,))]
        return [(kernel.exp - sp.log(value) / sp.log(kernel.base), (value,))] if _positive(kernel) else None
    if isinstance(kernel, sp.log):
        return [(inside - sp.exp(value), ())]
    if not certainly_real(inside):
        return None
    match kernel:
        case sp.cos():
            bounds = (1 - value, 1 + value)
            return [(inside - sign * sp.acos(value) - _turns(2), bounds) for sign in (1, -1)]
        case sp.sin():
            bounds = (1 - value, 1 + value)
            angles = (sp.asin(value), sp.pi - sp.asin(value))
            return [(inside - angle - _turns(2), bounds) for angle in angles]
        case sp.tan():
            return [(inside - sp.atan(value) - _turns(1), ())]
        case sp.Abs():
            return [(inside - sign * value, (value,)) for sign in (1, -1)]
        case sp.exp():
            return [(inside - sp.log(value), (value,))]
        case _:
            return None


def _undone_inverse(kernel: Expr, inside: Expr, value: Expr) -> tuple[Expr, tuple[Expr, ...]]:
    match kernel:
        case sp.acos():
            return inside - sp.cos(value), (value, sp.pi - value)
        case sp.asin():
            return inside - sp.sin(value), (sp.pi / 2 - value, sp.pi / 2 + value)
        case _:
            return inside - sp.tan(value), (sp.pi / 2 - value, sp.pi / 2 + value)


def _positive(power: sp.Pow) -> bool:
    base = power.base
    return bool(base.is_number and base.is_positive and base != 1) and certainly_real(power.exp)


def _turns_told_apart(root: Root, symbol: Symbol, domain: Domain) -> Iterator[Root]:
    """Yield a solution for each number of turns that the bounds of the symbol leave, where that can be told."""
    turns = [n for n in symbols_of(root.value) if isinstance(n, sp.Dummy) and n.is_integer]
    low, high, _ = domain.interval(symbol)
    if len(turns) != 1 or not (low.is_finite and high.is_finite):
        yield root
        return
    (n,) = turns
    start, step = exchanged(root.value, {n: sp.S.Zero}), root.value.diff(n)
    if not (start.is_number and start.is_real and step.is_number and step.is_nonzero):
        yield root
        return
    ends = sorted(float(sp.N((end - start) / step, 20)) for end in (low, high))
    first, last = math.ceil(ends[0] - SLACK), math.floor(ends[1] + SLACK)
    if last - first > MOST_TURNS:
        yield root
        return
    for turn in range(first, last + 1):
        yield Root(start + turn * step, root.conditions)
