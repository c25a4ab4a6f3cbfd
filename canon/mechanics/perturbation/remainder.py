"""Remainders of normal forms: the first part that is left, its norm on a polydisc, and the order with the least."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite
from numbers import Real
from typing import TYPE_CHECKING

import sympy as sp

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly
    from sympy import Expr

    from canon.mechanics.perturbation.birkhoff import NormalForm
    from canon.mechanics.perturbation.phase_polynomial import PhasePolynomial
    from canon.mechanics.perturbation.quadratic_form import DiagonalForm

__all__ = ["OptimalOrder", "norm_on_polydisc", "optimal_order", "remainder_norms"]


@dataclass(frozen=True)
class OptimalOrder:
    """The order at which the first part of the remainder is least on a polydisc.

    Parameters
    ----------
    order
        That order.
    norm
        The norm of the first part that is left there.
    reached
        Whether a higher order was seen to be worse; if not, the best is at the end of what was computed.
    """

    order: int
    norm: float
    reached: bool


def norm_on_polydisc(f: PhasePolynomial, diagonal: DiagonalForm, radii: Sequence[float]) -> float:
    """Return Σ |coefficient| ∏ |aⱼ|^k |bⱼ|^l with |aⱼ| = |bⱼ| = √|cⱼ/2| ρⱼ, a bound of |f| where √(2I) ≤ ρ.

    Parameters
    ----------
    f
        A polynomial in (a, b) without parameters.
    diagonal
        The variables.
    radii
        ρ of each pair, in the units of √(2I).
    """
    ring = f.ring
    if ring.parameters:
        raise ValueError("a norm needs numbers: put values for the parameters into H before the normal form")
    scale = [abs(_number(c)) / 2 for c in diagonal.brackets.constants]
    size = [s**0.5 * float(r) for s, r in zip(scale, radii, strict=True)] * 2
    total = 0.0
    for exponents, term in f.split(lambda e: tuple(map(int, e))).items():
        product = abs(_number(term.coefficient_alone()))
        for s, k in zip(size, exponents, strict=True):
            product *= s**k
        total += product
    return total


def remainder_norms(form: NormalForm, radii: Sequence[float] | float | Expr) -> dict[int, float]:
    """Return, for each order from 2 to form.order − 1, the norm of the first part beyond it that is no normal form.

    Examples
    --------
    >>> from canon.mechanics.hamilton.hamiltonian import Hamiltonian
    >>> from canon.mechanics.perturbation.birkhoff import birkhoff_normal_form
    >>> q, p = sp.symbols("q p", real=True)
    >>> form = birkhoff_normal_form(Hamiltonian((p**2 + q**2) / 2 + q**3, q, p), 4)
    >>> round(remainder_norms(form, 0.1)[2], 12)
    0.001
    """
    n = len(form.source.q)
    rho = [float(radii)] * n if isinstance(radii, int | float | Real | sp.Expr) else [float(r) for r in radii]
    if len(rho) != n or not all(isfinite(r) and r > 0 for r in rho):
        raise ValueError(f"radii should be a positive number, or {n} of them, not {radii!r}")
    norms = dict.fromkeys(range(2, form.order), 0.0)
    for _, chi in form.generators:
        for degree, part in chi.split(lambda exponents: int(sum(exponents))).items():
            removed = form.diagonal.brackets(part, form.original[2])
            norms[degree - 1] = norm_on_polydisc(removed, form.diagonal, rho)
    return norms


def optimal_order(form: NormalForm, radii: Sequence[float] | float | Expr) -> OptimalOrder:
    """Return the order with the least first part of the remainder on a polydisc √(2Iⱼ) ≤ ρⱼ.

    Normal forms diverge in general: on each polydisc the remainder falls with the order only up to this one
    (A. Giorgilli, Notes on exponential stability of Hamiltonian systems, Pisa 2003). What is compared is the first
    part that is left, computed exactly; it is an estimate of the remainder and no bound of all of it.
    """
    norms = {order: norm for order, norm in remainder_norms(form, radii).items() if norm > 0}
    best, least = form.order, inf
    for order, norm in norms.items():
        if norm < least:
            best, least = order, norm
    if not norms:
        return OptimalOrder(form.order, 0.0, reached=False)
    return OptimalOrder(best, least, reached=best < max(norms))


def _number(c: PhasePolynomial) -> complex:
    if c.ring.root is None and c.den.is_constant():
        below = int(c.den.leading_coefficient())
        return complex(_whole(c.re) / below, _whole(c.im) / below)
    shown = c.ring.expression(c, [sp.S.One] * c.ring.size)
    return complex(shown.evalf(20))


def _whole(part: fmpz_mpoly) -> int:
    return int(part.leading_coefficient()) if part else 0
