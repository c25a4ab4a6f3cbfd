"""Stäckel's matrix of orthogonal coordinates: its rows are functions of one coordinate each, found from H.

H = Σ aᵢ (pᵢ + cᵢ)² + V separates if and only if functions uᵢₖ(qᵢ) and vᵢ(qᵢ) exist with Σ aᵢ uᵢₖ = 0, or 1 for the
energy, and Σ aᵢ vᵢ = V (P. Stäckel, Habilitationsschrift, Halle 1891; L. A. Pars, A Treatise on Analytical Dynamics,
section 17.2). Where all coordinates but qᵢ rest at a reference place, such a sum gives uᵢ(qᵢ) by the numbers that the
others have there; what was found is proved where nothing rests.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.integrable.function_splitting import (
    common_factor,
    factored,
    have_values,
    reference_places,
)
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.proof.domain.domain import Domain

__all__ = ["StaeckelMatrix", "staeckel_matrix"]

SECONDS = 2.0
"""Time for the proof of one column."""


@dataclass(frozen=True)
class StaeckelMatrix:
    """The functions of one coordinate each in (pᵢ + cᵢ)² = Σ uᵢₖ αₖ − vᵢ, with the energy the last of the α.

    Parameters
    ----------
    q
        The coordinates.
    rows
        uᵢₖ(qᵢ), of shape (n, n).
    potential
        vᵢ(qᵢ).
    """

    q: tuple[Symbol, ...]
    rows: tuple[tuple[Expr, ...], ...]
    potential: tuple[Expr, ...]

    def constants(self, squares: Sequence[Expr], a: Expr) -> tuple[Expr, ...]:
        """Return the αₖ without the energy for given (pᵢ + cᵢ)², by Cramer's rule.

        The first coefficient a is the cofactor of u₁ₙ over the determinant, which need not be multiplied out then.

        Examples
        --------
        >>> x, y, A, B = sp.symbols("x y A B", real=True)
        >>> StaeckelMatrix((x, y), ((sp.S(1), sp.S(1)), (sp.S(-1), sp.S(1))), (x**2, y**2)).constants([A, B], sp.S.Half)
        (A/2 - B/2 + x**2/2 - y**2/2,)
        """
        n = len(self.q)
        common = [common_factor(row) for row in self.rows]
        U = sp.Matrix([[u / g for u in row] for row, g in zip(self.rows, common, strict=True)])

        def cofactor(i: int, k: int) -> Expr:
            return factored(cast("Expr", U.cofactor(i, k, method="berkowitz")))

        known = [square + v for square, v in zip(squares, self.potential, strict=True)]
        scale = a * common[0] / cofactor(0, n - 1)
        return tuple(
            sp.Add(*(scale * cofactor(i, k) * f / common[i] for i, f in enumerate(known)))
            for k in range(n - 1)
        )


def staeckel_matrix(coefficients: Mapping[Symbol, Expr], V: Expr, domain: Domain) -> StaeckelMatrix | None:
    """Return Stäckel's matrix for H = Σ aᵢ (pᵢ + cᵢ)² + V, or None where none was found and proved.

    Parameters
    ----------
    coefficients
        aᵢ by coordinate.
    V
        What is left with all pᵢ + cᵢ zero.
    domain
        Where the coordinates are meant.

    Examples
    --------
    >>> from canon.proof.domain.domain import EVERYWHERE
    >>> u, v = sp.symbols("u v", positive=True)
    >>> found = staeckel_matrix({u: 1/(u**2 + v**2), v: 1/(u**2 + v**2)}, 2/(u**2 + v**2), EVERYWHERE)
    >>> found.rows, found.potential
    (((-1, u**2 + 1), (1, (v - 1)*(v + 1))), (2, 0))
    """
    q = tuple(coefficients)
    for place in sorted(reference_places([[s] for s in q]), key=_is_irrational):
        there = _Resting(q, tuple(coefficients.values()), place)
        if not there.is_regular():
            continue
        columns = [_without_scale(there.column(sp.S.Zero, k), q) for k in range(1, len(q))]
        columns += [there.column(sp.S.One, 0), there.column(V, 0)]
        targets = [*(sp.S.Zero for _ in q[1:]), sp.S.One, V]
        if all(map(have_values, columns)) and all(
            _adds_up(coefficients, column, target, domain)
            for column, target in zip(columns, targets, strict=True)
        ):
            rows = tuple(tuple(column[i] for column in columns[:-1]) for i in range(len(q)))
            return StaeckelMatrix(q, rows, columns[-1])
    return None


def _is_irrational(place: Mapping[Symbol, Expr]) -> bool:
    return any(not value.is_Rational for value in place.values())


def _without_scale(column: tuple[Expr, ...], q: Sequence[Symbol]) -> tuple[Expr, ...]:
    """Return a column divided by what all its entries have in common that is no function of a coordinate."""
    scale = sp.Mul(*(f for f in sp.Mul.make_args(common_factor(column)) if not f.has(*q)))
    return tuple(u / scale for u in column)


def _adds_up(a: Mapping[Symbol, Expr], column: Sequence[Expr], target: Expr, domain: Domain) -> bool:
    total = sp.Add(*(x * u for x, u in zip(a.values(), column, strict=True)))
    return vanishes(total - target, domain, SECONDS).holds


@dataclass(frozen=True)
class _Resting:
    """The coefficients aᵢ about a reference place."""

    q: tuple[Symbol, ...]
    a: tuple[Expr, ...]
    place: Mapping[Symbol, Expr]

    def is_regular(self) -> bool:
        """Whether every coefficient has a value there, and none is zero."""
        values = [substitute(f, self.place) for f in self.a]
        return have_values(values) and all(f.is_zero is not True for f in values)

    def column(self, target: Expr, free: int) -> tuple[Expr, ...]:
        """Return uᵢ(qᵢ) with Σ aᵢ uᵢ = target; u_free = 1 at the place, for free > 0, and others but u₁ are 0."""
        there: list[Expr] = [sp.S.One if k and k == free else sp.S.Zero for k in range(len(self.q))]
        there[0] = self._solved(0, target, there, self.place)
        return tuple(
            factored(self._solved(i, target, there, {s: v for s, v in self.place.items() if s != q}))
            for i, q in enumerate(self.q)
        )

    def _solved(self, i: int, target: Expr, there: Sequence[Expr], at: Mapping[Symbol, Expr]) -> Expr:
        """Return uᵢ from the sum, with the other u as they are at the place."""
        others = sp.Add(*(a * u for j, (a, u) in enumerate(zip(self.a, there, strict=True)) if j != i))
        return substitute((target - others) / self.a[i], dict(at))
