"""Pinched bounds: a ≥ b beside a ≤ b leaves a = b, which is said as an equality then."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.proof.domain.domain import Domain
from canon.proof.domain.relations import parts_of

if TYPE_CHECKING:
    from sympy import Expr
    from sympy.logic.boolalg import Boolean

__all__ = ["with_pinched_bounds"]


def with_pinched_bounds(domain: Domain) -> Domain:
    """Return the same domain, with an equality for two bounds that leave one value.

    Two expressions that are not negative, whose sum is zero, are zero; nothing is added to a domain but what follows
    from it.

    Examples
    --------
    >>> a, b = sp.symbols("a b", real=True)
    >>> with_pinched_bounds(Domain((a >= b, a <= b))).conditions
    (a >= b, a <= b, Eq(a - b, 0))
    """
    bounds = [c for c in parts_of(domain.conditions) if isinstance(c, sp.Ge | sp.Le)]
    gaps = [cast("Expr", c.gts) - cast("Expr", c.lts) for c in bounds]
    ends = [f for f, g in combinations(gaps, 2) if f.free_symbols and sp.expand(f + g) == 0]
    equal = [cast("Boolean", sp.Eq(f, 0)) for f in ends]
    return Domain((*domain.conditions, *equal), domain.box) if equal else domain
