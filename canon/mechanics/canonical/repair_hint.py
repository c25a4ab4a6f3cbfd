"""What would make a map canonical that is not: a factor, a sign, an exchange, a valence."""

from __future__ import annotations

import time
from itertools import product
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.mechanics.algebra.jacobian import is_large
from canon.mechanics.algebra.substitution import exchanged
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.mechanics.canonical.canonicity_tests import PhaseSpaceMap
    from canon.proof.domain.domain import Domain

__all__ = ["constant_value", "mending"]

_PLACES = (sp.S.Zero, sp.S.One, sp.Rational(1, 2), sp.Rational(-1, 3))


def constant_value(
    f: Expr, variables: Sequence[Symbol], t: Symbol, domain: Domain, budget: float = 10.0
) -> Expr | None:
    """Return the constant that f equals on the domain, free of the variables and of t; None if there is none.

    Candidates come from simple points; one is returned only after its equality with f was proved.

    Examples
    --------
    >>> from sympy import sin, cos, symbols
    >>> from canon.proof.domain.domain import Domain
    >>> q, m, t = symbols("q m t", real=True)
    >>> constant_value(m*sin(q)**2 + m*cos(q)**2, [q], t, Domain())
    m
    """
    moving = f.free_symbols & {*variables, t}
    if not moving:
        return f
    free = {u: sp.Dummy(real=True) for u in _arbitrary(f, {*variables, t})}
    plain = exchanged(f, free)
    tried: set[Expr] = set()
    deadline = time.monotonic() + budget
    for place in _PLACES:
        candidate = exchanged(plain, dict.fromkeys((*moving, *free.values()), place))
        if candidate.has(sp.nan, sp.zoo, sp.oo, sp.S.NegativeInfinity) or candidate in tried:
            continue
        tried.add(candidate)
        candidate = _short(candidate)
        verdict = vanishes_off_kinks(f - candidate, domain, min(10.0, deadline - time.monotonic()))
        if verdict.holds:
            return candidate
    return None


def _arbitrary(f: Expr, moving: set[Symbol]) -> list[Expr]:
    """Return the arbitrary functions of moving variables and their derivatives: a constant takes any value for them."""
    found = [u for kind in (sp.Subs, sp.Derivative, AppliedUndef) for u in f.atoms(kind)]
    return [cast("Expr", u) for u in found if u.free_symbols & moving]


def mending(T: PhaseSpaceMap, c: Expr, seconds: float = 10.0) -> str:
    """Return one sentence that says how to mend the map, or nothing where that is not simple or takes too long."""
    if is_large(T.images):
        return ""
    n, deadline = len(T.q), time.monotonic() + seconds
    if n == 1:
        value = constant_value(T.poisson_bracket_of(0, 1), T.variables, T.t, T.domain, seconds)
        return _of_one_pair(value, c)
    for a, b in ((first + i, first + j) for first in (0, n) for i in range(n) for j in range(i)):
        if time.monotonic() > deadline or not _vanishes(T.poisson_bracket_of(a, b), T.domain):
            return ""
    constants: dict[tuple[int, int], Expr | None] = {}
    for i, j in product(range(n), repeat=2):
        left = deadline - time.monotonic()
        if left < 0:
            return ""
        constants[i, j] = constant_value(T.poisson_bracket_of(i, n + j), T.variables, T.t, T.domain, left)
    partners = {i: [j for j in range(n) if constants[i, j] != 0] for i in range(n)}
    if any(len(js) != 1 or constants[i, js[0]] is None for i, js in partners.items()):
        return ""
    paired = {i: js[0] for i, js in partners.items()}
    values = {i: constants[i, j] for i, j in paired.items()}
    if any(i != j for i, j in paired.items()):
        exchanged = ", ".join(f"P{i + 1} = old P{j + 1}" for i, j in paired.items() if i != j)
        return f"the momenta stand in the wrong order: renumber them so that {exchanged}"
    if len(set(values.values())) == 1:
        return _of_one_pair(values[0], c)
    return "; ".join(
        f"{{Q{i + 1}, P{i + 1}}} = {value}, not {c}: multiply P{i + 1} by {c / value}"
        for i, value in values.items()
        if value != c
    )


def _of_one_pair(value: Expr | None, c: Expr) -> str:
    if value is None:
        return ""
    if value == 0:
        return "{Q, P} = 0: Q and P depend on each other, so nothing simple mends the map"
    if value == -c:
        return f"{{Q, P}} = {value}, not {c}: exchange Q and P, or change the sign of one of them"
    return (
        f"{{Q, P}} = {value}, not {c}: canonical with valence {value}; multiply P by {c / value} "
        f"to make it {'univalent' if c == 1 else f'of valence {c}'}"
    )


def _vanishes(f: Expr, domain: Domain) -> bool:
    return f == 0 or vanishes_off_kinks(f, domain).holds


def _short(candidate: Expr) -> Expr:
    """Return a candidate in lowest terms; whoever uses it checks it afterwards."""
    if candidate.is_rational_function():
        return sp.cancel(candidate)
    if candidate.is_number and not candidate.is_Rational:
        guess = sp.nsimplify(candidate.evalf(30), rational=True, tolerance=sp.Float("1e-20"))
        if guess.is_Rational and guess.q < 10**6:
            return guess
    return candidate
