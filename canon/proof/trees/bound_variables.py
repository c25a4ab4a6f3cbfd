"""Bound variables: those of sums, products, integrals and substitutions."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.concrete.expr_with_limits import ExprWithLimits

from canon.proof.trees.anatomy import Anatomy, anatomy

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["BINDING", "bound_by", "with_bound_variables", "with_own_bound_variables"]

BINDING = (ExprWithLimits, sp.Subs)
"""Expressions that bind variables."""


def bound_by(part: sp.Basic) -> set[sp.Basic]:
    """Return what one sum, integral or substitution binds; an integral without limits binds nothing.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> bound_by(sp.Integral(x * y, (x, 0, y))), bound_by(sp.Integral(x, x))
    ({x}, set())
    """
    return set(cast("Sequence[sp.Basic]", getattr(part, "bound_symbols", ())))


def with_bound_variables(found: Anatomy) -> set[sp.Basic]:
    """Return the parts in which a variable stands that a sum, an integral or a substitution around them binds.

    Examples
    --------
    >>> x, n = sp.symbols("x n")
    >>> sorted(map(str, with_bound_variables(anatomy([x**2 + sp.Sum(x**2 + x**n, (n, 1, 3))]))))
    ['n', 'x**2 + x**n', 'x**n']
    """
    return {
        part
        for around in found.of(*BINDING)
        for part in anatomy([around.args[0]]).parts
        if not bound_by(around).isdisjoint(part.free_symbols)
    }


def with_own_bound_variables(exprs: Sequence[sp.Basic]) -> list[sp.Basic]:
    """Return expressions whose bound variables occur nowhere free, so that what is said of x is not said of ∫ … dx.

    Examples
    --------
    >>> x = sp.Symbol("x")
    >>> with_own_bound_variables([x * sp.Integral(x, (x, 0, x))])
    [x*Integral(_x, (_x, 0, x))]
    """
    names: dict[sp.Basic, sp.Basic] = {}
    renamed: dict[sp.Basic, sp.Basic] = {}
    for part in anatomy(exprs).of(*BINDING):  # what stands inside comes before what it stands in
        for s in sorted(bound_by(part), key=sp.default_sort_key):
            names.setdefault(s, _own(s))
        renamed[part] = _renamed(part.func(*(a.xreplace(renamed) for a in part.args)), names)
    return [e.xreplace(renamed) for e in exprs] if renamed else list(exprs)


def _own(bound: sp.Basic) -> sp.Dummy:
    return sp.Dummy(str(bound), **cast("dict[str, bool]", bound.assumptions0))


def _renamed(part: sp.Basic, names: dict[sp.Basic, sp.Basic]) -> sp.Basic:
    own: dict[sp.Basic, sp.Basic] = {s: names[s] for s in bound_by(part) if s in names}
    if isinstance(part, sp.Subs):
        inside, variables, point = part.args
        return part.func(inside.xreplace(own), variables.xreplace(own), point)
    if not isinstance(part, ExprWithLimits):
        return part
    limits: list[sp.Basic] = []
    outer: dict[sp.Basic, sp.Basic] = {}
    for limit in reversed(cast("tuple[sp.Tuple, ...]", part.limits)):  # the last is outermost
        variable, *ends = limit.args
        ends = [end.xreplace(outer) for end in ends]
        limits.append(sp.Tuple(own.get(variable, variable), *ends))
        if variable in own:
            outer[variable] = own[variable]
    return part.func(part.args[0].xreplace(own), *reversed(limits))
