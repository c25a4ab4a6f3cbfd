"""Pfaffian forms Σ aᵢ dxᵢ: exactness, and the bilinear covariant.

With two independent displacements d and δ, the bilinear covariant of Σ aᵢ dxᵢ is
δ(a·dx) − d(a·δx) = Σ ∂aᵢ/∂xⱼ (δxⱼ dxᵢ − dxⱼ δxᵢ) (E. T. Whittaker, Analytical Dynamics, § 126 ff.).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.symbol import velocity
from canon.expression.symbols.user_input import counted, given_expression, given_symbols
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.substitution import as_tuple, entry, substitute

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.proof.domain.domain import Domain
    from canon.proof.domain.verdict import Verdict

__all__ = ["bilinear_covariant", "canonical_covariant", "curl", "displacements", "divided_by_dt", "is_exact"]


def displacements(x: Sequence[Symbol]) -> tuple[tuple[Symbol, ...], tuple[Symbol, ...]]:
    """Return symbols for dx and δx, named ``d_x`` and ``delta_x``.

    Examples
    --------
    >>> from sympy import symbols
    >>> displacements(symbols("q p"))
    ((d_q, d_p), (delta_q, delta_p))
    """
    return (
        tuple(Symbol(f"d_{s.name}", real=True) for s in x),
        tuple(Symbol(f"delta_{s.name}", real=True) for s in x),
    )


def divided_by_dt(form: Expr, q: Sequence[Symbol], t: Symbol) -> Expr | None:
    """Return Σ aᵢ q̇ᵢ + b of a form Σ aᵢ dqᵢ + b dt; None where it is not linear and homogeneous in differentials.

    Examples
    --------
    >>> from canon import coordinates
    >>> (x, phi), t = coordinates("x phi"), Symbol("t", real=True)
    >>> (dx, dphi, dt), _ = displacements((x, phi, t))
    >>> divided_by_dt(dx - x*dphi - 2*dt, (x, phi), t), divided_by_dt(dx - x, (x, phi), t)
    (-phi_dot*x + x_dot - 2, None)
    """
    d, _ = displacements((*q, t))
    rates = [*map(velocity, q), sp.S.One]
    slopes = [form.diff(x) for x in d]
    rest = sp.expand(form - sp.Add(*(slope * x for slope, x in zip(slopes, d, strict=True))))
    if rest != 0 or any(slope.has(*d, *rates[:-1]) for slope in slopes):
        return None
    return substitute(form, dict(zip(d, rates, strict=True)))


def bilinear_covariant(
    form: Sequence[Expr],
    x: Sequence[Symbol],
    d: Sequence[Symbol] | None = None,
    delta: Sequence[Symbol] | None = None,
) -> Expr:
    """Return Σ ∂aᵢ/∂xⱼ (δxⱼ dxᵢ − dxⱼ δxᵢ), the bilinear covariant of Σ aᵢ dxᵢ.

    Parameters
    ----------
    form
        The coefficients aᵢ(x).
    x
        The variables.
    d, delta
        Symbols for the two displacements; ``d_x`` and ``delta_x`` unless given.

    Examples
    --------
    >>> from sympy import symbols
    >>> q, p = symbols("q p")
    >>> bilinear_covariant([p, 0], [q, p])
    -d_p*delta_q + d_q*delta_p
    """
    form, x = as_tuple(form), given_symbols(x, "x")
    named = displacements(x)
    d, delta = d or named[0], delta or named[1]
    rotation = curl(form, x)
    n = len(x)
    return sp.Add(
        *(rotation[i, j] * (delta[j] * d[i] - d[j] * delta[i]) for i in range(n) for j in range(i + 1, n))
    )


def canonical_covariant(new_q: Sequence[Expr], new_p: Sequence[Expr], z: Sequence[Symbol]) -> Expr:
    """Return Σ (δP dQ − dP δQ) in the displacements of the variables z on which Q and P depend.

    Examples
    --------
    >>> from sympy import symbols
    >>> q, p = symbols("q p")
    >>> canonical_covariant([2*q], [p], [q, p])
    -2*d_p*delta_q + 2*d_q*delta_p
    """
    d, delta = displacements(z)

    def along(f: Expr, displacement: Sequence[Symbol]) -> Expr:
        return sp.Add(*(f.diff(s) * h for s, h in zip(z, displacement, strict=True)))

    return sp.Add(
        *(
            along(P_, delta) * along(Q_, d) - along(P_, d) * along(Q_, delta)
            for Q_, P_ in zip(new_q, new_p, strict=True)
        )
    )


def curl(form: Sequence[Expr], x: Sequence[Symbol]) -> sp.Matrix:
    """Return the antisymmetric matrix ∂aᵢ/∂xⱼ − ∂aⱼ/∂xᵢ, which vanishes where Σ aᵢ dxᵢ is closed."""
    n = len(x)
    if len(form) != n:
        raise ValueError(
            f"{counted(len(form), 'coefficient')} for {counted(n, 'variable')}; a form has one for each"
        )
    matrix = sp.zeros(n, n)
    for i in range(n):
        for j in range(i + 1, n):
            matrix[i, j] = given_expression(form[i]).diff(x[j]) - given_expression(form[j]).diff(x[i])
            matrix[j, i] = -matrix[i, j]
    return matrix


def is_exact(
    form: Sequence[Expr], x: Sequence[Symbol], domain: Domain | None = None, budget: float = 10.0
) -> Verdict:
    """Tell whether Σ aᵢ dxᵢ is exact: ∂aᵢ/∂xⱼ = ∂aⱼ/∂xᵢ for all pairs.

    That makes it exact on every simply connected part of the domain (Poincaré's lemma).

    Examples
    --------
    >>> from sympy import symbols
    >>> q, p = symbols("q p", real=True)
    >>> is_exact([p, q], [q, p]).status.name, is_exact([p, 0], [q, p]).status.name
    ('HOLDS', 'FAILS')
    """
    rotation = curl(form, x)
    n = len(x)
    return all_vanish(
        (
            (f"∂({form[i]})/∂{x[j]} = ∂({form[j]})/∂{x[i]}", entry(rotation, i, j))
            for i in range(n)
            for j in range(i + 1, n)
        ),
        "the form is an exact differential",
        domain,
        budget,
    )
