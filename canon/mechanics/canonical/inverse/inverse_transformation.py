"""Inverse of a canonical transformation in closed form."""

from __future__ import annotations

import time as clock
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol, atan, true

from canon.expression.symbols.user_input import counted, given_kind, given_seconds, given_symbols
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.branch_point import branch_points, far_from_principal
from canon.mechanics.algebra.solve_on_branch import Inversion, solve_system
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.canonical.inverse.inverse_branch import plain_sign, positive_radicands
from canon.mechanics.canonical.inverse.point_inverse import point_branch
from canon.mechanics.canonical.inverse.polar_inverse import free_angles, polar_branch
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.proof.domain.domain import Domain

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from sympy.logic.boolalg import Boolean

    from canon.mechanics.algebra.branch_point import BranchPoint
    from canon.mechanics.canonical.inverse.inverse_branch import BranchOfInverse

__all__ = ["NoClosedInverseError", "inverse_transformation", "meaning_of"]


class NoClosedInverseError(ValueError):
    """Raised where the inverse of a map was not found in closed form on its domain."""


def inverse_transformation(
    transformation: CanonicalTransformation,
    new_q: Sequence[Symbol],
    new_p: Sequence[Symbol],
    budget: float = 30.0,
) -> CanonicalTransformation:
    """Return q(Q, P, t), p(Q, P, t), proved on the domain of the map.

    This also makes a map from its inverse: give the inverse as a transformation of (Q, P) and invert it.

    Parameters
    ----------
    transformation
        The map (q, p) → (Q, P).
    new_q, new_p
        Symbols for the new variables.
    budget
        Seconds for solving and proving; a step of algebra that is under way is finished.

    Raises
    ------
    NoClosedInverseError
        Where the equations could not be solved on one branch that covers the domain, or not within the budget.

    Examples
    --------
    >>> from sympy import atan2, symbols
    >>> q = symbols("q", positive=True); p, Q, P = symbols("p Q P", real=True)
    >>> T = CanonicalTransformation(q, p, q**2, p/(2*q))
    >>> inverse = inverse_transformation(T, [Q], [P])
    >>> inverse.images, inverse.domain.conditions
    ((sqrt(Q), 2*P*sqrt(Q)), (Q > 0,))

    The oscillator by angle and action, whose branch is that of atan2 on the whole plane:

    >>> q, p = symbols("q p", real=True)
    >>> T = CanonicalTransformation(q, p, atan2(q, p), (q**2 + p**2)/2)
    >>> inverse_transformation(T, [Q], [P]).images
    (sqrt(2)*sqrt(P)*sin(Q), sqrt(2)*sqrt(P)*cos(Q))
    """
    T = given_kind(transformation, CanonicalTransformation, "the map")
    new_q, new_p = given_symbols(new_q, "new_q"), given_symbols(new_p, "new_p")
    meaning = meaning_of(T, new_q, new_p)
    _refuse_turns(T)
    symbols = set(T.variables).union(*(f.atoms(Symbol) for f in T.images))
    deadline = clock.monotonic() + given_seconds(budget)
    search = _Search(T, meaning, new_q, new_p, deadline)
    for witness in sorted(branch_points(symbols, meaning, T.domain, 12), key=far_from_principal)[:3]:
        inverse = search.through(witness)
        if inverse is not None:
            return inverse
    if clock.monotonic() > deadline:
        raise NoClosedInverseError(
            f"no inverse in closed form was found within {budget:g} s; give inverse_transformation a larger budget, "
            "or narrow the domain to one branch with conditions such as p > 0"
        )
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


@dataclass(frozen=True)
class _Search:
    """A map to be inverted in given symbols until a deadline."""

    T: CanonicalTransformation
    meaning: Mapping[Symbol, Expr]
    new_q: Sequence[Symbol]
    new_p: Sequence[Symbol]
    deadline: float

    def through(self, witness: BranchPoint) -> CanonicalTransformation | None:
        """Return the inverse on the branch of a witness, by the route that fits: coordinates alone, polar, peeled."""
        T = self.T
        return (
            self._proved(point_branch(T.q, T.p, self.meaning, witness, self.deadline))
            or self._proved(polar_branch(T.variables, self.meaning, witness, self.deadline))
            or self._peeled(witness)
        )

    def _proved(self, branch: BranchOfInverse | None) -> CanonicalTransformation | None:
        """Return the inverse of a branch, proved on the domain and on the image that it states."""
        if branch is None or not self._all_vanish(
            branch.returns(self.meaning), "the inverse is right", self.T.domain
        ):
            return None
        inverse = self._inverse(branch.values, branch.ranges)
        there, question = branch.undoes(self.meaning), "the map undoes its inverse"
        # The ranges are simple, and what is proved on them alone holds on the domain inside them.
        domains = (Domain(branch.ranges), inverse.domain)
        return inverse if any(self._all_vanish(there, question, domain) for domain in domains) else None

    def _peeled(self, witness: BranchPoint) -> CanonicalTransformation | None:
        """Return the inverse by one operation undone after the other, proved on the domain."""
        equations = [(f, s) for s, f in self.meaning.items()]
        solved = solve_system(equations, self.T.variables, Inversion(witness, deadline=self.deadline))
        if solved is None:
            return None
        claims = ((f"{z} comes back", substitute(solved[z], self.meaning) - z) for z in self.T.variables)
        right = self._all_vanish(claims, "the inverse is right", self.T.domain)
        return self._inverse(solved, tuple(positive_radicands(solved.values()))) if right else None

    def _all_vanish(self, claims: Iterable[tuple[str, Expr]], question: str, domain: Domain) -> bool:
        seconds = min(10.0, self.deadline - clock.monotonic())
        return seconds > 0 and all_vanish(claims, question, domain, seconds).holds

    def _inverse(
        self, values: Mapping[Symbol, Expr], ranges: tuple[Boolean, ...] = ()
    ) -> CanonicalTransformation:
        T, n = self.T, len(self.T.q)
        moved = [cast("Boolean", c.xreplace(dict(values))) for c in T.domain.conditions]
        moved += [cast("Boolean", sp.Gt(values[z], 0)) for z in T.variables if z.is_positive]
        moved = [plain_sign(c) for c in moved]
        conditions = tuple(c for c in (*ranges, *moved) if c != true)
        images = [values[z] for z in T.variables]
        return CanonicalTransformation(
            self.new_q, self.new_p, images[:n], images[n:], Domain(conditions), T.t
        )


def _refuse_turns(T: CanonicalTransformation) -> None:
    """Refuse a map in which the old variable is an angle without bounds: a turn on it has the same image."""
    for z in free_angles(T.variables, T.images):
        if not any(c.has(z) for c in T.domain.conditions):
            raise NoClosedInverseError(
                f"the map has no inverse on its whole domain, as {z} and {z} + 2*pi have the same image; narrow the "
                f"domain to one turn: -pi < {z} < pi"
            )


def _same_images(T: CanonicalTransformation) -> str:
    """Tell why there is no inverse at all, where points opposite each other certainly have the same image."""
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
