"""Where functions made of pieces are continuous: derivatives do not show a jump."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.core.relational import Relational

from canon.proof.domain import Domain
from canon.proof.generic import is_analytic
from canon.proof.replacement import KINKED
from canon.proof.typed import arguments
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Iterable

    from sympy import Expr, Symbol
    from sympy.logic.boolalg import Boolean

__all__ = ["PIECED", "may_jump", "without_pieces"]

JUMPS = (sp.sign, sp.Heaviside)
PIECED = (*KINKED, sp.Piecewise)
"""Functions that are made of pieces: one that is not zero at one point may vanish on a whole piece."""


def without_pieces(functions: Iterable[Expr], domain: Domain) -> bool:
    """Tell whether functions are certainly analytic where signs said in the domain are known, as in |q| where q > 0.

    Examples
    --------
    >>> x, k = sp.symbols("x k", real=True)
    >>> without_pieces([abs(x)], Domain((x > 0,))), without_pieces([abs(x)], Domain())
    (True, False)
    """
    bounds = [c for c in domain.conditions if isinstance(c, sp.Gt) and c.rhs == 0]
    positive = {c.lhs: sp.Dummy(str(c.lhs), positive=True) for c in bounds if isinstance(c.lhs, sp.Symbol)}
    return is_analytic([cast("Expr", f.xreplace(positive)) for f in functions], domain)


def may_jump(f: Expr, variables: Iterable[Symbol], domain: Domain) -> bool:
    """Tell whether a function that has pieces in some variables is not known to be continuous.

    Examples
    --------
    >>> x = sp.symbols("x", real=True)
    >>> [may_jump(f, [x], Domain()) for f in (abs(x), sp.sign(x), abs(x) / x, sp.Piecewise((x, x > 0), (0, True)))]
    [False, True, True, False]
    >>> may_jump(x * sp.sign(x), [x], Domain())
    False
    """
    moving = tuple(variables)
    f = cast("Expr", f.replace(lambda e: isinstance(e, sp.Mul), _with_moduli))
    kinked = [part for part in f.atoms(*PIECED) if part.has(*moving)]
    if not kinked or without_pieces([f], domain):
        return False
    if any(isinstance(part, JUMPS) for part in kinked):
        return True
    if any(power.exp.is_negative and power.has(*moving) for power in f.atoms(sp.Pow)):
        return True
    return not all(_pieces_meet(part, domain) for part in kinked if isinstance(part, sp.Piecewise))


def _with_moduli(product: Expr) -> Expr:
    """Write u·sign(u) as |u|, which it is everywhere and which does not jump."""
    powers = product.as_powers_dict()
    for jump in [base for base in powers if isinstance(base, sp.sign) and powers[base] == 1]:
        u = arguments(jump)[0]
        if powers.get(u, 0) == 1:
            product = product / (u * jump) * sp.Abs(u)
    return product


def _pieces_meet(function: sp.Piecewise, domain: Domain) -> bool:
    """Tell whether two pieces are proved equal on their common bound."""
    pieces = cast("tuple[tuple[Expr, sp.Basic], ...]", function.args)
    if len(pieces) != 2 or not isinstance(bound := pieces[0][1], Relational):
        return False
    at_bound = cast("Boolean", sp.Eq(bound.lhs, bound.rhs, evaluate=False))
    return vanishes(pieces[0][0] - pieces[1][0], Domain((*domain.conditions, at_bound), domain.box)).holds
