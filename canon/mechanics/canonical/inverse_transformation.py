"""Inverse of a canonical transformation in closed form."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from sympy import Expr, Symbol, atan, true

from canon.expression.symbols.user_input import counted, given_kind, given_symbols
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.branch_point import branch_points, far_from_principal
from canon.mechanics.algebra.solve_on_branch import Inversion, solve_system
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.canonical.polar_inverse import free_angles, plain_sign, polar_branch
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.proof.domain.domain import Domain

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy.logic.boolalg import Boolean

    from canon.mechanics.algebra.branch_point import BranchPoint

__all__ = ["NoClosedInverseError", "inverse_transformation", "meaning_of"]


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
    >>> from sympy import atan2, symbols
    >>> q = symbols("q", positive=True); p, Q, P = symbols("p Q P", real=True)
    >>> T = CanonicalTransformation(q, p, q**2, p/(2*q))
    >>> inverse_transformation(T, [Q], [P]).images
    (sqrt(Q), 2*P*sqrt(Q))

    The oscillator by angle and action, whose branch is that of atan2 on the whole plane:

    >>> q, p = symbols("q p", real=True)
    >>> T = CanonicalTransformation(q, p, atan2(q, p), (q**2 + p**2)/2)
    >>> inverse_transformation(T, [Q], [P]).images
    (sqrt(2)*sqrt(P)*sin(Q), sqrt(2)*sqrt(P)*cos(Q))
    """
    T = given_kind(transformation, CanonicalTransformation, "the map")
    new_q, new_p = given_symbols(new_q, "new_q"), given_symbols(new_p, "new_p")
    meaning = meaning_of(T, new_q, new_p)
    symbols = set(T.variables).union(*(f.atoms(Symbol) for f in T.images))
    for witness in sorted(branch_points(symbols, meaning, T.domain, 12), key=far_from_principal)[:3]:
        inverse = _polar(T, meaning, witness, new_q, new_p) or _peeled(T, meaning, witness, new_q, new_p)
        if inverse is not None:
            return inverse
    raise NoClosedInverseError(
        f"the map could not be inverted in closed form on its whole domain{_same_images(T)}; narrow the domain "
        "to one branch with conditions such as p > 0"
    )


def meaning_of(
    T: CanonicalTransformation, new_q: Sequence[Symbol], new_p: Sequence[Symbol]
) -> dict[Symbol, Expr]:
    """Return the images of the map by the symbols of the new variables."""
    if not len(new_q) == len(new_p) == len(T.q):
        raise ValueError(
            f"{len(new_q)} new_q and {len(new_p)} new_p for "
            f"{counted(len(T.q), 'degree')} of freedom; give one each"
        )
    meaning = dict(zip((*new_q, *new_p), T.images, strict=True))
    if len(set(meaning)) < 2 * len(T.q) or set(meaning) & set(T.variables):
        raise ValueError("the new variables need different symbols, none of them an old variable")
    return meaning


def _polar(
    T: CanonicalTransformation,
    meaning: Mapping[Symbol, Expr],
    witness: BranchPoint,
    new_q: Sequence[Symbol],
    new_p: Sequence[Symbol],
) -> CanonicalTransformation | None:
    """Return the inverse of a map of polar type, proved on the domain and on the image that it states."""
    branch = polar_branch(T.variables, meaning, witness)
    if branch is None or not all_vanish(branch.returns(meaning), "the inverse is right", T.domain).holds:
        return None
    inverse = _inverse(T, branch.values, new_q, new_p, branch.ranges)
    there = branch.undoes(meaning)
    return inverse if all_vanish(there, "the map undoes its inverse", inverse.domain).holds else None


def _peeled(
    T: CanonicalTransformation,
    meaning: Mapping[Symbol, Expr],
    witness: BranchPoint,
    new_q: Sequence[Symbol],
    new_p: Sequence[Symbol],
) -> CanonicalTransformation | None:
    """Return the inverse by one operation undone after the other, proved on the domain."""
    solved = solve_system([(f, s) for s, f in meaning.items()], T.variables, Inversion(witness))
    if solved is None:
        return None
    claims = ((f"{z} comes back", substitute(solved[z], meaning) - z) for z in T.variables)
    if not all_vanish(claims, "the inverse is right", T.domain).holds:
        return None
    return _inverse(T, solved, new_q, new_p)


def _inverse(
    T: CanonicalTransformation,
    values: Mapping[Symbol, Expr],
    new_q: Sequence[Symbol],
    new_p: Sequence[Symbol],
    ranges: tuple[Boolean, ...] = (),
) -> CanonicalTransformation:
    moved = [cast("Boolean", c.xreplace(dict(values))) for c in T.domain.conditions]
    if ranges:
        moved = [plain_sign(c) for c in moved]
    conditions = tuple(c for c in (*ranges, *moved) if c != true)
    images, n = [values[z] for z in T.variables], len(T.q)
    return CanonicalTransformation(new_q, new_p, images[:n], images[n:], Domain(conditions), T.t)


def _same_images(T: CanonicalTransformation) -> str:
    """Tell why there is no inverse at all, where points far apart certainly have the same image."""
    for z in free_angles(T.variables, T.images):
        if not any(c.has(z) for c in T.domain.conditions):
            return f", as {z} and {z} + 2*pi have the same image (give the domain one turn: -pi < {z} < pi)"
    mirrored = {z: -z for z in T.variables}
    if any(c.xreplace(mirrored) not in T.domain.conditions for c in T.domain.conditions):
        return ""
    if any(z.is_nonnegative or z.is_nonpositive for z in T.variables):
        return ""
    pairs = [("the images are the same", substitute(f, mirrored) - f) for f in T.images]
    if not all_vanish(pairs, "points opposite each other have the same image", T.domain).holds:
        return ""
    arcs = " (atan2 tells opposite points apart, atan does not)" if any(f.has(atan) for f in T.images) else ""
    return f", as {T.variables} and the opposite point have the same image{arcs}"
