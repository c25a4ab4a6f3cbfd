"""Canonicity tests: what must vanish by Poisson's, Lagrange's, the symplectic, bilinear or contact condition."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal, Protocol

import sympy as sp
from sympy import Expr

from canon.cached_property import cached_property
from canon.expression.symbols.user_input import given_expression
from canon.mechanics.algebra.substitution import entry
from canon.mechanics.hamilton.bracket import symplectic_unit
from canon.mechanics.hamilton.pfaffian_form import canonical_covariant, curl, displacements
from canon.proof.domain.verdict import Evidence, Status, Verdict

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from sympy import Symbol

    from canon.proof.domain.domain import Domain

__all__ = ["TESTS", "PhaseSpaceMap", "Test", "disagreement", "given_valence", "residuals"]

Test = Literal["poisson", "lagrange", "symplectic", "bilinear", "contact"]
TESTS: tuple[Test, ...] = ("poisson", "lagrange", "symplectic", "bilinear", "contact")


class PhaseSpaceMap(Protocol):
    """What the tests and repairs need of a map (q, p) → (Q, P)."""

    @property
    def q(self) -> tuple[Symbol, ...]:
        """The old coordinates."""
        ...

    @property
    def variables(self) -> tuple[Symbol, ...]:
        """(q, p)."""
        ...

    @property
    def t(self) -> Symbol:
        """The time."""
        ...

    @property
    def domain(self) -> Domain:
        """Where the map is meant."""
        ...

    @property
    def new_q(self) -> tuple[Expr, ...]:
        """The new coordinates."""
        ...

    @property
    def new_p(self) -> tuple[Expr, ...]:
        """The new momenta."""
        ...

    @property
    def images(self) -> tuple[Expr, ...]:
        """(Q, P)."""
        ...

    @cached_property
    def jacobian(self) -> sp.ImmutableDenseMatrix:
        """M = ∂(Q, P)/∂(q, p)."""
        ...

    @cached_property
    def lagrange_brackets(self) -> sp.ImmutableDenseMatrix:
        """The Lagrange brackets of the old variables."""
        ...

    def poisson_bracket_of(self, i: int, j: int) -> Expr:
        """Return the Poisson bracket of two of (Q, P)."""
        ...

    def contact_form(self, valence: Expr) -> tuple[Expr, ...]:
        """Return the coefficients of valence · p dq − P dQ."""
        ...


def residuals(T: PhaseSpaceMap, by: Test, c: Expr) -> Iterator[tuple[str, Expr]]:
    """Yield what is asked, in the words of the test, and the expression that must vanish."""
    match by:
        case "poisson":
            return _brackets(T.poisson_bracket_of, _names(T, "QP"), c, "{{{}, {}}}")
        case "lagrange":
            brackets = T.lagrange_brackets
            return _brackets(lambda i, j: entry(brackets, i, j), [str(z) for z in T.variables], c, "[{}, {}]")
        case "symplectic":
            J = symplectic_unit(len(T.q))
            whole = T.jacobian * J * T.jacobian.T
            said = "the entry ({}, {}) of M J Mᵀ"
            return _brackets(lambda i, j: entry(whole, i, j), _names(T, "QP"), c, said)
        case "bilinear":
            return _coefficients(T, c)
        case "contact":
            return _exactness(T, c)
    raise ValueError(
        f"no test is called {by!r}; choose poisson, lagrange, symplectic, bilinear, contact or all"
    )


def disagreement(verdicts: Mapping[str, Verdict]) -> Verdict:
    """Return the verdict that all tests share; UNDECIDED, naming them, where two contradict each other."""
    evidence = tuple(
        Evidence(
            f"{test} test",
            f"{v.status.name} in {v.seconds:.3f} s" + (f", {v.certificate}" if v.certificate else ""),
        )
        for test, v in verdicts.items()
    )
    seconds = sum(v.seconds for v in verdicts.values())
    holding = [v for v in verdicts.values() if v.holds]
    failing = [v for v in verdicts.values() if v.fails]
    question = "the map is canonical"
    if holding and failing:
        return Verdict(
            Status.UNDECIDED,
            question,
            evidence=evidence,
            seconds=seconds,
            feedback="the tests disagree, which cannot be: please report this map as a fault of canon",
        )
    agreed = (failing or holding or list(verdicts.values()))[0]
    return replace(agreed, evidence=evidence, seconds=seconds)


def _brackets(
    bracket: Callable[[int, int], Expr], names: list[str], c: Expr, written: str
) -> Iterator[tuple[str, Expr]]:
    """Yield bracket by bracket, each built when it is asked about: the budget may end before."""
    n = len(names) // 2
    for i in range(2 * n):
        for j in range(i + 1, 2 * n):
            due = c if j == i + n else sp.S.Zero
            yield f"{written.format(names[i], names[j])} = {due}", bracket(i, j) - due


def _coefficients(T: PhaseSpaceMap, c: Expr) -> Iterator[tuple[str, Expr]]:
    """Yield the coefficients of δa db in Σ(δP dQ − dP δQ) − c Σ(δp dq − dp δq)."""
    d, delta = displacements(T.variables)
    n = len(T.q)
    covariant = canonical_covariant(T.new_q, T.new_p, T.variables)
    for i in range(2 * n):
        for j in range(i + 1, 2 * n):
            due = c if j == i + n else sp.S.Zero
            yield (
                f"the coefficient of {delta[j]}*{d[i]} is {due}",
                covariant.diff(delta[j]).diff(d[i]) - due,
            )


def _exactness(T: PhaseSpaceMap, c: Expr) -> Iterator[tuple[str, Expr]]:
    rotation = curl(T.contact_form(c), T.variables)
    z = T.variables
    for i in range(len(z)):
        for j in range(i + 1, len(z)):
            yield (
                f"the coefficients of d{z[i]} and d{z[j]} in p dq − P dQ have equal cross derivatives",
                entry(rotation, i, j),
            )


def _names(T: PhaseSpaceMap, letters: str) -> list[str]:
    n = len(T.q)
    return [f"{letter}{'' if n == 1 else i + 1}" for letter in letters for i in range(n)]


def given_valence(valence: Expr | int, moving: Sequence[Symbol]) -> Expr:
    """Return the valence that was given, a constant that is not zero.

    Raises
    ------
    ValueError
        Where it is zero, or depends on what moves.

    Examples
    --------
    >>> q = sp.Symbol("q")
    >>> given_valence(2, [q])
    2
    >>> given_valence(q, [q])
    Traceback (most recent call last):
        ...
    ValueError: the valence should be a constant other than 0, not q
    """
    c = given_expression(valence, "valence")
    if c == 0 or c.has(*moving):
        raise ValueError(f"the valence should be a constant other than 0, not {c}")
    return c
