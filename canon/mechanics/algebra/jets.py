"""Jets: symbols in place of arbitrary functions and their derivatives, which at one point are independent numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.proof.domain.domain import Domain

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy.logic.boolalg import Boolean

__all__ = ["jets_of", "with_jets"]


def jets_of(expressions: Sequence[Expr], domain: Domain, t: Symbol) -> dict[Expr, Symbol]:
    """Return a symbol for each arbitrary function and each of its derivatives.

    At one point they are independent of one another, and nothing is differentiated any more. Functions of more than
    the time are left alone where they occur with different arguments.

    Examples
    --------
    >>> from sympy import Function, symbols
    >>> x, t = symbols("x t", real=True)
    >>> V = Function("V")(x)
    >>> jets_of([V + V.diff(x)], Domain(), t)
    {Derivative(V(x), x): Derivative(V(x), x), V(x): V(x)}
    """
    everything = (*expressions, *domain.conditions)
    atoms = set[Expr]().union(*(e.atoms(AppliedUndef, sp.Derivative) for e in everything))
    places = {atom.expr if isinstance(atom, sp.Derivative) else atom for atom in atoms}
    named = [str(place.func) for place in places]
    jets: dict[Expr, Symbol] = {}
    for atom in sorted(atoms, key=str):
        function = atom.expr if isinstance(atom, sp.Derivative) else atom
        plain = all(isinstance(argument, Symbol) for argument in function.args)
        alone = named.count(str(function.func)) == 1
        if isinstance(function, AppliedUndef) and (function.args == (t,) or (plain and alone)):
            positive = {"positive": True} if atom == function and function.is_positive else {}
            jets[atom] = Symbol(str(atom), real=True, **positive)
    return jets


def with_jets(domain: Domain, jets: Mapping[Expr, Symbol]) -> Domain:
    """Return a domain with the symbols that stand for functions and derivatives in its conditions."""
    return Domain(tuple(cast("Boolean", c.xreplace(dict(jets))) for c in domain.conditions), domain.box)
