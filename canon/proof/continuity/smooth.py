"""Functions made of pieces, and where they are analytic."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.proof.analytic import is_analytic
from canon.proof.trees.replacement import KINKED

if TYPE_CHECKING:
    from collections.abc import Iterable

    from sympy import Expr

    from canon.proof.domain.domain import Domain

__all__ = ["PIECED", "without_pieces"]

PIECED = (*KINKED, sp.Piecewise)
"""Functions that are made of pieces: one that is not zero at one point may vanish on a whole piece."""


def without_pieces(functions: Iterable[Expr], domain: Domain) -> bool:
    """Tell whether functions are certainly analytic where signs said in the domain are known, as in |q| where q > 0.

    Examples
    --------
    >>> from canon.proof.domain.domain import Domain
    >>> x, k = sp.symbols("x k", real=True)
    >>> without_pieces([abs(x)], Domain((x > 0,))), without_pieces([abs(x)], Domain())
    (True, False)
    """
    bounds = [c for c in domain.conditions if isinstance(c, sp.Gt) and c.rhs == 0]
    positive = {c.lhs: sp.Dummy(str(c.lhs), positive=True) for c in bounds if isinstance(c.lhs, sp.Symbol)}
    return is_analytic([cast("Expr", f.xreplace(positive)) for f in functions], domain)
