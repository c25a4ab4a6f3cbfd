"""Finding the generating functions of a canonical map.

The contact form p dq − P dQ is integrated in the old variables (q, p), where no inversion is needed; the
four types differ from that function by ± Σ QP and ± Σ qp; only then the equations are solved for the
variables of the wanted type, on the branch that the domain determines.
"""

from __future__ import annotations

import time as clock
from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.user_input import given_kind
from canon.mechanics.algebra.branch_point import branch_points, far_from_principal
from canon.mechanics.algebra.linear import is_regular
from canon.mechanics.algebra.potential import potential
from canon.mechanics.algebra.solve_on_branch import Inversion, solve_system
from canon.mechanics.algebra.substitution import exchanged, shortened, substitute
from canon.mechanics.canonical.generating_function import (
    GeneratingFunction,
    NoGeneratingFunctionError,
    kind_name,
    kinds_of,
)
from canon.mechanics.canonical.parametric_generating_function import ParametricGeneratingFunction
from canon.proof.domain.domain import Domain

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy.logic.boolalg import Boolean

    from canon.mechanics.canonical.transformation import CanonicalTransformation
    from canon.proof.domain.verdict import Verdict

__all__ = ["SOLVING_SHARE", "GeneratingFunctionSearch", "generating_function"]

SOLVING_SHARE = 0.3
"""Part of the seconds in which the map is solved for the variables of the type; the others are for proofs."""


@dataclass(frozen=True)
class GeneratingFunctionSearch:
    """A map on its way to a generating function of given types.

    Parameters
    ----------
    map
        The canonical transformation.
    kinds
        The type of each degree of freedom.
    new_q, new_p
        Symbols for the new variables.
    """

    map: CanonicalTransformation
    kinds: tuple[int, ...]
    new_q: tuple[Symbol, ...]
    new_p: tuple[Symbol, ...]

    @cached_property
    def meaning(self) -> dict[Symbol, Expr]:
        """The new variables as functions of the old ones."""
        return dict(zip((*self.new_q, *self.new_p), self.map.images, strict=True))

    @property
    def given(self) -> tuple[Symbol, ...]:
        """The new variables of the type: Q for types 1 and 3, P for 2 and 4."""
        return tuple(
            Q if k in (1, 3) else P for k, Q, P in zip(self.kinds, self.new_q, self.new_p, strict=True)
        )

    @property
    def eliminated(self) -> tuple[Symbol, ...]:
        """The old variables that are not of the type: p for types 1 and 2, q for 3 and 4."""
        return tuple(
            p if k in (1, 2) else q for k, q, p in zip(self.kinds, self.map.q, self.map.p, strict=True)
        )

    def exists(self) -> Verdict:
        """Tell whether the block ∂(new variables of the type)/∂(eliminated old ones) is regular."""
        block = sp.Matrix([[self.meaning[b].diff(y) for y in self.eliminated] for b in self.given])
        return is_regular(block, self.map.domain, f"∂({_listed(self.given)})/∂({_listed(self.eliminated)})")

    @cached_property
    def in_old_variables(self) -> Expr | None:
        """G with dG = Σ p dq − Σ P dQ at fixed t, in old and new variables; None where none was found."""
        T = self.map
        hints = {q * p: q * p for q, p in zip(T.q, T.p, strict=True)}
        hints |= {
            q * p: self.meaning[q] * self.meaning[p] for q, p in zip(self.new_q, self.new_p, strict=True)
        }
        hints |= {f: substitute(f, self.meaning) for f in self._further_hints()}
        return potential(T.contact_form(), T.variables, T.domain, hints)

    def _further_hints(self) -> Iterator[Expr]:
        """Yield the new variables and squares, of which generating functions are often made."""
        yield from self.new_q
        yield from self.new_p
        for z in (*self.new_q, *self.new_p, *self.map.variables):
            yield z**2

    @cached_property
    def converted(self) -> Expr | None:
        """The function of the wanted type in mixed variables, G + Σ QP − Σ qp."""
        if self.in_old_variables is None:
            return None
        total = self.in_old_variables
        for i, k in enumerate(self.kinds):
            if k in (2, 4):
                total += self.new_q[i] * self.new_p[i]
            if k in (3, 4):
                total -= self.map.q[i] * self.map.p[i]
        total = exchanged(total, {self.meaning[b]: b for b in self.given if not self.meaning[b].is_Atom})
        others = {s: f for s, f in self.meaning.items() if s not in self.given}
        return substitute(total, others)

    def converted_along_map(self) -> Expr | None:
        """Return the function of the wanted type in the old variables only."""
        return None if self.converted is None else substitute(self.converted, self.meaning)

    def closed_forms(self, deadline: float) -> Iterator[tuple[Expr, tuple[Boolean, ...]]]:
        """Yield F in the variables of its type, with the conditions of the branch it is on."""
        if self.converted is None:
            return
        if not self.converted.has(*self.eliminated):
            yield self.converted, ()
            return
        symbols = set(self.map.variables).union(*(f.atoms(Symbol) for f in self.map.images))
        points = sorted(branch_points(symbols, self.meaning, self.map.domain, 12), key=far_from_principal)
        seen: set[Expr] = set()
        for witness in points[:3]:
            inversion = Inversion(witness, deadline=deadline)
            solved = solve_system([(self.meaning[b], b) for b in self.given], self.eliminated, inversion)
            if solved is None:
                continue
            F = shortened(substitute(exchanged(self.converted, inversion.known), solved))
            if F not in seen:
                seen.add(F)
                yield F, tuple(inversion.conditions)


def _listed(symbols: Sequence[Symbol]) -> str:
    return ", ".join(map(str, symbols))


def generating_function(
    transformation: CanonicalTransformation,
    kind: int | Sequence[int] = 1,
    new_q: Sequence[Symbol] | Symbol | None = None,
    new_p: Sequence[Symbol] | Symbol | None = None,
    budget: float = 10.0,
) -> GeneratingFunction | ParametricGeneratingFunction:
    """Find the generating function of a canonical map, up to a constant and a function of time.

    What is returned in closed form has been verified by the rules of its type on the map; its ``domain``
    states the branch it holds on.

    Parameters
    ----------
    transformation
        A canonical transformation of valence 1.
    kind
        1, 2, 3 or 4; or one of them for each degree of freedom.
    new_q, new_p
        Symbols for the new variables; Q, P (or Q1, Q2 … and P1, P2 …) unless given.
    budget
        Seconds for the verification of closed forms.

    Returns
    -------
    GeneratingFunction or ParametricGeneratingFunction
        Parametric where the map could not be solved for the variables of the type.

    Raises
    ------
    NoGeneratingFunctionError
        Where the map is not canonical, or the type does not exist for it, with the null direction.

    Examples
    --------
    >>> from sympy import symbols, acot
    >>> from canon import CanonicalTransformation
    >>> q, m, w = symbols("q m w", positive=True)
    >>> p = symbols("p", real=True)
    >>> T = CanonicalTransformation(q, p, acot(p/(m*w*q)), (p**2 + m**2*w**2*q**2)/(2*m*w))
    >>> generating_function(T, 1).F
    m*q**2*w*cot(Q)/2
    """
    from canon.mechanics.canonical.transformation import CanonicalTransformation

    given_kind(transformation, CanonicalTransformation, "the map")
    kinds = kinds_of(kind, len(transformation.q))
    canonical = transformation.is_canonical()
    if canonical.fails:
        raise NoGeneratingFunctionError(
            f"the map is not canonical, so it has no generating function; {canonical.feedback}", canonical
        )
    Q, P = _new_symbols(transformation, new_q, new_p)
    recovery = GeneratingFunctionSearch(transformation, kinds, Q, P)
    exists = recovery.exists()
    if exists.fails:
        raise NoGeneratingFunctionError(
            f"the map has no generating function of type {kind_name(kinds)}: {exists.feedback}; "
            "try another type",
            exists,
        )
    T = transformation
    end = clock.monotonic() + budget
    for F, conditions in recovery.closed_forms(clock.monotonic() + SOLVING_SHARE * budget):
        for domain in _narrowed(T.domain, conditions):
            found = GeneratingFunction(kinds, F, T.q, T.p, Q, P, domain, T.t)
            left = end - clock.monotonic()
            if left > 0 and found.generates(T, domain, left).holds:
                return found
    relations = tuple((b, recovery.meaning[b]) for b in recovery.given)
    return ParametricGeneratingFunction(kinds, recovery.converted_along_map(), relations, T)


def _narrowed(domain: Domain, conditions: tuple[Boolean, ...]) -> Iterator[Domain]:
    yield domain
    if conditions:
        yield Domain((*domain.conditions, *conditions), domain.box)


def _new_symbols(
    T: CanonicalTransformation,
    new_q: Sequence[Symbol] | Symbol | None,
    new_p: Sequence[Symbol] | Symbol | None,
) -> tuple[tuple[Symbol, ...], tuple[Symbol, ...]]:
    n = len(T.q)
    taken = {s.name for f in (*T.variables, *T.images) for s in f.atoms(Symbol)}
    found: list[tuple[Symbol, ...]] = []
    for letter, given in (("Q", new_q), ("P", new_p)):
        if given is not None:
            found.append((given,) if isinstance(given, Symbol) else tuple(given))
            continue
        names = [letter if n == 1 else f"{letter}{i + 1}" for i in range(n)]
        clash = sorted(taken & set(names))
        if clash:
            raise ValueError(
                f"{', '.join(clash)} is used in the map already; name the new variables with new_q, new_p"
            )
        found.append(tuple(Symbol(name, real=True) for name in names))
    return found[0], found[1]
