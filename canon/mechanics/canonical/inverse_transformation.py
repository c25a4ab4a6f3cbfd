"""Inverse of a canonical transformation in closed form."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from sympy import Expr, Symbol

from canon.expression.symbols.user_input import counted, given_kind, given_symbols
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.branch_point import branch_points, far_from_principal
from canon.mechanics.algebra.solve_on_branch import Inversion, solve_system
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.proof.domain.domain import Domain

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy.logic.boolalg import Boolean

__all__ = ["NoClosedInverseError", "inverse_transformation"]


class NoClosedInverseError(ValueError):
    """Raised where the inverse of a map was not found in closed form on its domain."""


def inverse_transformation(
    transformation: CanonicalTransformation, new_q: Sequence[Symbol], new_p: Sequence[Symbol]
) -> CanonicalTransformation:
    """Return q(Q, P, t), p(Q, P, t), proved on the domain of the map.

    This also makes a map from its inverse: give the inverse as a transformation of (Q, P) and invert it.

    Parameters
    ----------
    transformation
        The map (q, p) → (Q, P).
    new_q, new_p
        Symbols for the new variables.

    Raises
    ------
    NoClosedInverseError
        Where the equations could not be solved on one branch that covers the domain.

    Examples
    --------
    >>> from sympy import symbols, sqrt, sin, cos
    >>> q = symbols("q", positive=True); p, Q, P = symbols("p Q P", real=True)
    >>> T = CanonicalTransformation(q, p, q**2, p/(2*q))
    >>> inverse_transformation(T, [Q], [P]).images
    (sqrt(Q), 2*P*sqrt(Q))
    """
    T = given_kind(transformation, CanonicalTransformation, "the map")
    new_q, new_p = given_symbols(new_q, "new_q"), given_symbols(new_p, "new_p")
    if not len(new_q) == len(new_p) == len(T.q):
        raise ValueError(
            f"{len(new_q)} new_q and {len(new_p)} new_p for "
            f"{counted(len(T.q), 'degree')} of freedom; give one each"
        )
    meaning = dict(zip((*new_q, *new_p), T.images, strict=True))
    if len(set(meaning)) < 2 * len(T.q) or set(meaning) & set(T.variables):
        raise ValueError("the new variables need different symbols, none of them an old variable")
    symbols = set(T.variables).union(*(f.atoms(Symbol) for f in T.images))
    for witness in sorted(branch_points(symbols, meaning, T.domain, 12), key=far_from_principal)[:3]:
        solved = solve_system([(f, s) for s, f in meaning.items()], T.variables, Inversion(witness))
        if solved is None:
            continue
        back = all_vanish(
            ((f"{z} comes back", substitute(solved[z], meaning) - z) for z in T.variables),
            "the inverse is right",
            T.domain,
        )
        if back.holds:
            conditions = tuple(cast("Boolean", c.xreplace(solved)) for c in T.domain.conditions)
            images: list[Expr] = [solved[z] for z in T.variables]
            n = len(T.q)
            return CanonicalTransformation(new_q, new_p, images[:n], images[n:], Domain(conditions), T.t)
    raise NoClosedInverseError(
        "the map could not be inverted in closed form on its whole domain; narrow the domain to one branch "
        "with conditions such as p > 0"
    )
