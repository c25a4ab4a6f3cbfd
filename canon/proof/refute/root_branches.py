"""Root branches: a symbol that an equality such as a² = 2 makes irrational is replaced by a root to refute a claim."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.core.function import AppliedUndef

from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, holds_at, precision, value
from canon.proof.domain.domain import Domain
from canon.proof.domain.reality import certainly_real
from canon.proof.domain.relations import parts_of
from canon.proof.refute.refute import Search, look_for_counterexample
from canon.proof.rungs.cases import eliminations, under_derivatives, without_symbol
from canon.proof.trees.polynomial_roots import polynomial_in, real_roots
from canon.proof.trees.replacement import NoValue, replaced
from canon.proof.trees.sympy_types import by_name

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from flint import acb
    from sympy import Expr, Symbol
    from sympy.logic.boolalg import Boolean

__all__ = ["search_branches"]

MOST_BRANCHES = 4
POINTS = 12
HIGHEST = 256


def search_branches(left: Expr, right: Expr, domain: Domain, deadline: float) -> Search:
    """Look for a counterexample after equalities were solved for real symbols, roots included.

    A counterexample must be a point of the domain as it was given: at its values every condition certainly holds, and
    no equality is excluded; that the values solve the equalities exactly is what their form shows.

    Examples
    --------
    >>> a = sp.Symbol("a", real=True)
    >>> two = Domain((sp.Eq(a**2, 2), a > 0))
    >>> print(search_branches(a, sp.Integer(1), two, time.monotonic() + 1).counterexample)
    at a = sqrt(2): 1.41421356237310 against 1.00000000000000
    """
    search = Search()
    equal = any(isinstance(c, sp.Eq) for c in domain.conditions)
    for tried, (values, narrowed) in enumerate(_solved(left - right, domain, {}) if equal else ()):
        if tried == MOST_BRANCHES or time.monotonic() > deadline:
            break
        try:
            by = cast("Mapping[sp.Basic, Expr]", values)
            sides = replaced(left, by, deadline), replaced(right, by, deadline)
        except NoValue:
            continue
        symbols = {s for f in (*sides, *values.values()) for s in by_name(f)}
        points = narrowed.points(symbols, POINTS, deadline=deadline, but_functions=True)
        search = look_for_counterexample(
            *sides,
            (point for point in points if _belongs(point, values, domain)),
            highest=HIGHEST,
            deadline=deadline,
            search=search,
            conditions=narrowed.on_functions,
        )
        if search.counterexample is not None:
            point = {s.name: str(f) for s, f in values.items()}
            found = replace(search.counterexample, point={**search.counterexample.point, **point})
            return replace(search, counterexample=found)
    return search


def _belongs(point: Mapping[Symbol, sp.Rational], values: Mapping[Symbol, Expr], domain: Domain) -> bool:
    """Tell whether a point, completed by the values of the solved symbols, satisfies the conditions as they were given.

    Inequalities must certainly hold; equalities, and g ≥ 0 beside g ≤ 0, must not be excluded.
    """
    whole = dict(point)
    balls: dict[sp.Basic, acb] = {}
    asked = [c for c in parts_of(domain.conditions) if not c.has(AppliedUndef)]
    closed = [cast("Expr", c.gts) - cast("Expr", c.lts) for c in asked if isinstance(c, sp.Ge | sp.Le)]
    with precision(HIGHEST):
        try:
            for s, f in values.items():
                number = cast("Expr", f.xreplace(point))
                if isinstance(number, sp.Rational):
                    whole[s] = number
                else:
                    balls[s] = value(number, {})
        except (NotDecided, Undefined, Unmodelled):
            return False
        return all(_may_hold(c, whole, dict(balls), closed) for c in asked)


def _may_hold(
    condition: Boolean,
    point: Mapping[Symbol, sp.Rational],
    balls: dict[sp.Basic, acb],
    closed: Sequence[Expr],
) -> bool:
    try:
        return holds_at(condition, point, balls)
    except NotDecided:
        if isinstance(condition, sp.Ge | sp.Le):
            gap = cast("Expr", condition.gts) - cast("Expr", condition.lts)
            return any(sp.expand(gap + other) == 0 for other in closed)
        return isinstance(condition, sp.Eq)
    except (Undefined, Unmodelled):
        return False


def _solved(
    expr: Expr, domain: Domain, values: Mapping[Symbol, Expr]
) -> Iterator[tuple[dict[Symbol, Expr], Domain]]:
    """Yield ways to satisfy all equalities: what some symbols are, and the domain of the others."""
    if not any(isinstance(c, sp.Eq) for c in domain.conditions):
        yield dict(values), domain
        return
    for s, solution, narrowed in _one_less(expr, domain):
        known = {old: cast("Expr", f.xreplace({s: solution})) for old, f in values.items()} | {s: solution}
        yield from _solved(expr, narrowed, known)


def _one_less(expr: Expr, domain: Domain) -> Iterator[tuple[Symbol, Expr, Domain]]:
    """Yield real values of one symbol: the one of a linear equality, or both roots of one of degree two."""
    staying = under_derivatives(expr, domain)
    for s, solution, narrowed in eliminations(domain, staying):
        if _takes_any(s) and certainly_real(solution):
            yield s, solution, narrowed
            return
    for condition in domain.conditions:
        if isinstance(condition, sp.Eq) and isinstance(condition.lhs, sp.Expr):
            gap = condition.lhs - cast("Expr", condition.rhs)
            for s in by_name(gap):
                if s not in staying and _takes_any(s):
                    yield from _roots(gap, s, domain, condition)


def _takes_any(s: Symbol) -> bool:
    """Tell whether a symbol stands for any real number, and not only for rational ones, or for none of the integers."""
    return bool(s.is_real) and s.is_rational is None and s.is_integer is None


def _roots(gap: Expr, s: Symbol, domain: Domain, condition: Boolean) -> Iterator[tuple[Symbol, Expr, Domain]]:
    """Yield the real roots of an equality of degree two in one symbol, where its discriminant is not negative."""
    poly = polynomial_in(gap, s)
    if poly is None or poly.degree() != 2:
        return
    a, b, c = poly.all_coeffs()
    if not (a.is_number and certainly_real(a) and certainly_real(b) and certainly_real(b**2 - 4 * a * c)):
        return
    for root in real_roots(poly) or ():
        narrowed = without_symbol(domain, condition, s, root.value)
        real = cast("Boolean", sp.Ge(root.conditions[0], 0))
        if narrowed is not None and real != sp.false:
            yield s, root.value, Domain((*narrowed.conditions, real), narrowed.box)
