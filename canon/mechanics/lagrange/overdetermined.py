"""More equations than unknowns, solved without a pole wherever they determine the unknowns.

Elimination by the simplest entry of a column divides by what may vanish on the way, as sin θ does, though the equations
stay regular there. Here only entries that vanish nowhere are pivots, in whatever column they stand. What no such entry
is left for is solved by least squares, AᵀW A x = AᵀW b, whose pivots vanish only where A loses rank.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from canon.mechanics.algebra.linear import is_plainly_nonzero, solve
from canon.mechanics.algebra.substitution import size

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr

__all__ = ["solve_overdetermined", "symmetric_product"]


def solve_overdetermined(
    matrix: sp.MatrixBase, right: Sequence[Expr], weights: Sequence[Expr]
) -> tuple[Expr, ...]:
    """Return the x with A x = b of consistent equations, finite wherever A has full column rank.

    Parameters
    ----------
    matrix
        A, of full column rank.
    right
        b.
    weights
        A positive weight of each equation, which gives the squares of all the same dimension.

    Examples
    --------
    >>> from sympy import Matrix, symbols
    >>> b = symbols("b", real=True)
    >>> solve_overdetermined(Matrix([[1, 0], [1, 1], [0, 1]]), [b, b + 2, 2], [1, 1, 1])
    (b, 2)
    """
    rows: list[list[Expr]] = [[*matrix.row(i).flat(), b] for i, b in enumerate(right)]
    waiting, open_ = list(range(len(rows))), list(range(matrix.cols))
    solved: list[tuple[int, int]] = []
    while chosen := _nowhere_zero(rows, waiting, open_):
        i, j = chosen
        waiting.remove(i)
        open_.remove(j)
        solved.append(chosen)
        for k in waiting:
            _take(rows, k, i, j)
    x: list[Expr] = [sp.S.Zero] * matrix.cols
    for j, value in zip(
        open_, _least_squares([rows[i] for i in waiting], open_, weights, waiting), strict=True
    ):
        x[j] = value
    for i, j in reversed(solved):
        known = (entry * other for k, (entry, other) in enumerate(zip(rows[i], x, strict=False)) if k != j)
        x[j] = (rows[i][-1] - sp.Add(*known)) / rows[i][j]
    return tuple(x)


def symmetric_product(
    left: Sequence[Sequence[Expr]], right: Sequence[Sequence[Expr]], weights: Sequence[Expr]
) -> sp.Matrix:
    """Return Σ w aᵢ bⱼ over pairs of rows, known to be symmetric in i and j.

    Examples
    --------
    >>> from sympy import symbols
    >>> m, a, b = symbols("m a b")
    >>> symmetric_product([(a, b)], [(a, b)], [m])
    Matrix([
    [a**2*m,  a*b*m],
    [ a*b*m, b**2*m]])
    """

    def entry(i: int, j: int) -> Expr:
        i, j = min(i, j), max(i, j)
        return sp.Add(*(w * a[i] * b[j] for w, a, b in zip(weights, left, right, strict=True)))

    return sp.Matrix(len(left[0]), len(left[0]), entry)


def _nowhere_zero(
    rows: list[list[Expr]], waiting: Sequence[int], open_: Sequence[int]
) -> tuple[int, int] | None:
    """Return row and column of the simplest entry that vanishes nowhere."""
    entries = [(i, j) for j in open_ for i in waiting if rows[i][j] != 0]
    plain = [(i, j) for i, j in entries if is_plainly_nonzero(rows[i][j])]
    signed = (
        (i, j)
        for i, j in sorted(entries, key=lambda at: size(rows[at[0]][at[1]]))
        if rows[i][j].is_positive or rows[i][j].is_negative
    )
    return min(plain, key=lambda at: size(rows[at[0]][at[1]])) if plain else next(signed, None)


def _take(rows: list[list[Expr]], k: int, i: int, j: int) -> None:
    """Take row i from row k so that column j vanishes there."""
    if rows[k][j] == 0:
        return
    factor = rows[k][j] / rows[i][j]
    rows[k] = [a if b == 0 else a - factor * b for a, b in zip(rows[k], rows[i], strict=True)]
    rows[k][j] = sp.S.Zero


def _least_squares(
    rows: Sequence[list[Expr]], columns: Sequence[int], weights: Sequence[Expr], numbers: Sequence[int]
) -> list[Expr]:
    if not columns:
        return []
    own, left = [weights[i] for i in numbers], [[row[j] for j in columns] for row in rows]
    right = sp.Matrix(
        [
            sp.Add(*(w * a[j] * row[-1] for w, a, row in zip(own, left, rows, strict=True)))
            for j in range(len(columns))
        ]
    )
    return solve(symmetric_product(left, left, own), right, name="the matrix of the squares").flat()
