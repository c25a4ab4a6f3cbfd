"""Systems affine in some unknowns: accelerations, multipliers, velocities."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.mechanics.algebra.linear import solve
from canon.mechanics.algebra.substitution import exchanged

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.proof.domain.domain import Domain

__all__ = ["solved"]


def solved(
    system: Sequence[Expr], unknowns: Sequence[Symbol], domain: Domain | None = None
) -> dict[Symbol, Expr]:
    """Return the unknowns that solve a square system, each expression = 0 and affine in them.

    Raises
    ------
    SingularMatrixError
        Where the system does not determine them.
    Undecided
        Where that could not be told.

    Examples
    --------
    >>> x, y, a = sp.symbols("x y a")
    >>> solved([x + y - a, x - y], [x, y])
    {x: a/2, y: a/2}
    """
    at_rest = dict.fromkeys(unknowns, sp.S.Zero)
    matrix = sp.Matrix([[equation.diff(u) for u in unknowns] for equation in system])
    right = sp.Matrix([-exchanged(equation, at_rest) for equation in system])
    found = cast("list[Expr]", solve(matrix, right, domain).flat())
    return dict(zip(unknowns, found, strict=True))
