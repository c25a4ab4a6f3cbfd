"""Repair hint for a map that is not canonical: the factor, sign, exchange or valence that would make it so."""

from __future__ import annotations

import time as clock
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.expression.symbols.symbol import time
from canon.mechanics.algebra.jacobian import is_large
from canon.mechanics.algebra.substitution import MOST_TERMS, exchanged, terms_if_expanded
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.mechanics.canonical.canonicity_tests import PhaseSpaceMap
    from canon.proof.domain.domain import Domain

__all__ = ["RepairHint", "constant_value", "repair_hint"]

_PLACES = (sp.S.Zero, sp.S.One, sp.Rational(1, 2), sp.Rational(-1, 3))


def constant_value(
    f: Expr, variables: Sequence[Symbol], domain: Domain, budget: float = 10.0, t: Symbol = time
) -> Expr | None:
    """Return the constant that f equals on the domain, free of the variables and of t; None if there is none.

    Candidates come from simple points; one is returned only after its equality with f was proved.

    Examples
    --------
    >>> from sympy import sin, cos, symbols
    >>> from canon.proof.domain.domain import Domain
    >>> q, m, t = symbols("q m t", real=True)
    >>> constant_value(m*sin(q)**2 + m*cos(q)**2, [q], Domain(), t=t)
    m
    """
    moving = f.free_symbols & {*variables, t}
    if not moving:
        return f
    free = {u: sp.Dummy(real=True) for u in _arbitrary(f, {*variables, t})}
    plain = exchanged(f, free)
    tried: set[Expr] = set()
    deadline = clock.monotonic() + budget
    for place in _PLACES:
        candidate = exchanged(plain, dict.fromkeys((*moving, *free.values()), place))
        if candidate.has(sp.nan, sp.zoo, sp.oo, sp.S.NegativeInfinity) or candidate in tried:
            continue
        tried.add(candidate)
        candidate = _short(candidate)
        seconds = min(10.0, deadline - clock.monotonic())
        if seconds > 0 and vanishes_off_kinks(f - candidate, domain, seconds).holds:
            return candidate
    return None


def _arbitrary(f: Expr, moving: set[Symbol]) -> list[Expr]:
    """Return the arbitrary functions of moving variables and their derivatives: a constant takes any value for them."""
    found = [u for kind in (sp.Subs, sp.Derivative, AppliedUndef) for u in f.atoms(kind)]
    return [cast("Expr", u) for u in found if u.free_symbols & moving]


@dataclass(frozen=True)
class RepairHint:
    """What makes a map canonical whose pairs of coordinate and momentum have constant brackets.

    Parameters
    ----------
    brackets
        {Qᵢ, Pⱼ} of each pair, in the order of the coordinates.
    wanted
        What each of them should be: the valence.
    partners
        The momentum that belongs to each coordinate, by its number from 0; empty for a single pair.
    """

    brackets: tuple[Expr, ...]
    wanted: Expr
    partners: tuple[int, ...] = ()

    @property
    def is_renumbering(self) -> bool:
        """Whether the momenta stand in another order than the coordinates."""
        return any(i != j for i, j in enumerate(self.partners))

    @property
    def bracket(self) -> Expr | None:
        """The one value of all brackets, None where they differ or the order is wrong."""
        alike = not self.is_renumbering and len(set(self.brackets)) == 1
        return self.brackets[0] if alike else None

    @property
    def valence(self) -> Expr | None:
        """The valence with which the map is canonical; None where it is not, or where an exchange is in place."""
        return None if self.bracket in (None, 0, -self.wanted) else self.bracket

    def __str__(self) -> str:
        c = self.wanted
        if self.is_renumbering:
            moved = ((i, j) for i, j in enumerate(self.partners) if i != j)
            order = ", ".join(f"P{i + 1} = old P{j + 1}" for i, j in moved)
            return f"the momenta stand in the wrong order: renumber them so that {order}"
        if self.bracket == 0:
            return "{Q, P} = 0: Q and P depend on each other, so nothing simple mends the map"
        if self.bracket == -c:
            return f"{{Q, P}} = {self.bracket}, not {c}: exchange Q and P, or change the sign of one of them"
        if self.valence is not None:
            return (
                f"{{Q, P}} = {self.valence}, not {c}: canonical with valence {self.valence}; "
                f"multiply P by {c / self.valence} to make it {'univalent' if c == 1 else f'of valence {c}'}"
            )
        return "; ".join(
            f"{{Q{i}, P{i}}} = {value}, not {c}: multiply P{i} by {c / value}"
            for i, value in enumerate(self.brackets, 1)
            if value != c
        )


def repair_hint(T: PhaseSpaceMap, c: Expr, seconds: float = 10.0) -> RepairHint | None:
    """Return what would mend the map, None where that is not simple or takes too long."""
    if is_large(T.images):
        return None
    n, deadline = len(T.q), clock.monotonic() + seconds
    if n == 1:
        value = constant_value(T.poisson_bracket_of(0, 1), T.variables, T.domain, seconds, T.t)
        return None if value is None else RepairHint((value,), c)
    for a, b in ((first + i, first + j) for first in (0, n) for i in range(n) for j in range(i)):
        if not _vanishes(T.poisson_bracket_of(a, b), T.domain, min(10.0, deadline - clock.monotonic())):
            return None
    constants: dict[tuple[int, int], Expr | None] = {}
    for i, j in product(range(n), repeat=2):
        left = deadline - clock.monotonic()
        if left < 0:
            return None
        constants[i, j] = constant_value(T.poisson_bracket_of(i, n + j), T.variables, T.domain, left, T.t)
    return _of_pairs(constants, n, c)


def _of_pairs(constants: Mapping[tuple[int, int], Expr | None], n: int, c: Expr) -> RepairHint | None:
    """Return the constants of the brackets of each new coordinate with the one momentum that is not free of it."""
    partners = [[j for j in range(n) if constants[i, j] != 0] for i in range(n)]
    if any(len(others) != 1 for others in partners):
        return None
    found = [constants[i, j] for i, (j,) in enumerate(partners)]
    if None in found:
        return None
    return RepairHint(tuple(cast("list[Expr]", found)), c, tuple(j for (j,) in partners))


def _vanishes(f: Expr, domain: Domain, seconds: float) -> bool:
    return f == 0 or (seconds > 0 and vanishes_off_kinks(f, domain, seconds).holds)


def _short(candidate: Expr) -> Expr:
    """Return a candidate in lowest terms, a number as a short fraction; whoever uses it checks it afterwards."""
    if candidate.is_number and not candidate.is_Rational:
        guess = sp.nsimplify(candidate.evalf(30), rational=True, tolerance=sp.Float("1e-20"))
        return guess if guess.is_Rational and guess.q < 10**6 else candidate
    if candidate.is_rational_function():
        return sp.cancel(candidate) if terms_if_expanded(candidate) <= MOST_TERMS else candidate
    return candidate
