"""Facts about expressions as they are written: SymPy knows them of what is worked out only.

Of 2·0, or of −1 − 0·2 + (0 + 1)², left as they stand, its assumptions contradict one another: which of two rules it
tries first is drawn by lot, and one time in twenty the sum above, which is 0, "is not zero"; or it raises
``InconsistentAssumptions``.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.expression.symbols.magnitude import has_huge_number
from canon.proof.trees.anatomy import anatomy
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from sympy import Basic, Expr

__all__ = ["known", "worked_out"]

LARGE = 1_000
"""Size of a tree beyond which SymPy, which walks all of it again and again, takes seconds for a fact."""


def known(fact: str, f: Expr) -> bool | None:
    """Return what SymPy knows of an expression; None also of a large one, and where a number is too large or is none.

    Parameters
    ----------
    fact
        A name of SymPy's, such as ``is_zero``.
    f
        An expression in which anything may be left as it was written.

    Examples
    --------
    >>> known("is_zero", sp.Mul(2, 0, evaluate=False)), known("is_zero", sp.log(0))
    (True, None)
    """
    if anatomy([f]).tree > LARGE:
        return None
    try:
        plain = f if has_huge_number(f) else worked_out(f)
        return None if plain.has(sp.nan, sp.zoo, sp.oo, -sp.oo) else getattr(plain, fact)
    except OverflowError:
        return None


@functools.lru_cache(maxsize=1024)
def worked_out(f: Expr) -> Expr:
    """Return an expression with its sums, products, powers and functions evaluated.

    Examples
    --------
    >>> written = sp.Add(-1, sp.Pow(sp.Add(0, 1, evaluate=False), 2, evaluate=False), evaluate=False)
    >>> written, worked_out(written)
    (-1 + (0 + 1)**2, 0)
    """
    if not f.args or not isinstance(f, sp.Add | sp.Mul | sp.Pow | sp.Function):
        return f
    if isinstance(f, sp.Piecewise):
        pieces = cast("tuple[tuple[Expr, Basic], ...]", f.args)
        return sp.Piecewise(*((worked_out(piece), condition) for piece, condition in pieces), evaluate=False)
    return cast("Expr", f.func(*map(worked_out, arguments(f))))
