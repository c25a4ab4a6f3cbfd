"""Real values: expressions that are certainly real wherever they are defined."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from sympy.core.function import AppliedUndef

from canon.expression.symbols.jacobi_functions import (
    jacobi_am,
    jacobi_cn,
    jacobi_dn,
    jacobi_epsilon,
    jacobi_sn,
)
from canon.proof.domain.declarations import declared_complex
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from sympy import Expr

__all__ = ["REAL_ON_REALS", "certainly_real"]

REAL_ON_REALS = (
    sp.sin
    | sp.cos
    | sp.tan
    | sp.exp
    | sp.sinh
    | sp.cosh
    | sp.tanh
    | sp.atan
    | sp.asinh
    | sp.Abs
    | sp.sign
    | sp.Max
    | sp.Min
    | jacobi_am
    | jacobi_sn
    | jacobi_cn
    | jacobi_dn
    | jacobi_epsilon
)
"""Functions that take real values at real arguments."""


def certainly_real(u: Expr) -> bool:
    """Tell whether u is real wherever it is defined, so that u > 0, u < 0 and u = 0 are all there is."""
    if declared_complex(u) and not u.is_number:
        return False
    if isinstance(u, sp.Symbol):
        return True
    if isinstance(u, sp.Pow) and not u.exp.is_integer:
        return u.base.is_nonnegative is True and certainly_real(u.exp)
    if isinstance(u, sp.log):
        return arguments(u)[0].is_positive is True
    if isinstance(u, sp.Add | sp.Mul | sp.Pow | AppliedUndef | REAL_ON_REALS):
        return all(certainly_real(a) for a in arguments(u))
    return u.is_number and u.is_real is True
