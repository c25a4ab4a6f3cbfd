"""Constraint manifold: where some expressions vanish, written as a graph over free variables.

Each constraint is solved for one symbol that it determines, a coordinate or a parameter (a claim is for
every value of the parameters, so l = √(x² + y²) describes a circle of any radius without branches). The
points that a graph misses, where the coefficient of that symbol vanishes too, have a lower dimension and
lie in its closure: constraints are split into factors first.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.symbol import velocity
from canon.mechanics.algebra.solve_for_symbol import real_solutions
from canon.mechanics.algebra.substitution import substitute, symbols_of
from canon.proof.analytic import proved_sign
from canon.proof.definedness.definedness import lack_of_value
from canon.proof.definedness.formula_around import put_in
from canon.proof.domain.domain import Domain, has_point
from canon.proof.domain.verdict import Undecided
from canon.proof.kinks import vanishes_off_kinks
from canon.proof.rungs.ladder import is_empty
from canon.proof.trees.polynomial import polynomial_factors
from canon.proof.trees.polynomial_roots import is_binomial, polynomial_in, real_roots

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from sympy.logic.boolalg import Boolean

    from canon.proof.trees.polynomial_roots import Root

__all__ = [
    "Branch",
    "EmptyDomainError",
    "check_not_empty",
    "check_whole",
    "inhabited",
    "on_manifold",
    "transported",
]

MAX_BRANCHES = 16
SECONDS = 5.0
"""Last safety of the questions whether a constraint has a value on a branch, and whether a domain holds a point: they
end by themselves after a tenth of a second, which is more on the clock of a busy machine."""

_NO_POINT = "no point satisfies the constraints, assumptions and conditions"


class EmptyDomainError(ValueError):
    """No point satisfies the assumptions and conditions."""


@dataclass(frozen=True)
class Branch:
    """A part of the manifold: the symbols that are determined, and the domain of the others."""

    values: Mapping[Symbol, Expr]
    domain: Domain

    def and_then(self, symbol: Symbol, value: Expr, conditions: Sequence[Expr]) -> Branch:
        """Return the part where one symbol more is determined."""
        step = {symbol: value}
        values = {old: substitute(given, step) for old, given in self.values.items()} | step
        domain = Domain((*self.domain.conditions, *(sp.Ge(c, 0) for c in conditions)), self.domain.box)
        return Branch(values, transported(domain, step))


@dataclass(frozen=True)
class _Solution:
    """One way to solve a constraint: a symbol, and its values with what must not be negative for them."""

    symbol: Symbol
    roots: tuple[Root, ...]
    cost: tuple[int, int]
    everywhere: bool = True
    """Whether what it is divided by vanishes nowhere."""
    quotient: tuple[Expr, Expr] | None = None
    """Numerator and denominator, where it is linear in the symbol."""


def on_manifold(
    constraints: Sequence[Expr],
    domain: Domain,
    keep: Sequence[Symbol] = (),
    prefer: Sequence[Symbol] = (),
    until: float = math.inf,
) -> list[Branch]:
    """Return the branches of the set where all the constraints vanish.

    Parameters
    ----------
    constraints
        Expressions that vanish on the manifold.
    domain
        Where the claim is meant.
    keep
        Symbols that are not to be solved for, such as the time.
    prefer
        Symbols that are solved for where there is a choice, such as velocities.
    until
        When to stop, on the clock of ``time.monotonic``; the constraint that is being solved then is finished first.

    Raises
    ------
    Undecided
        Where a constraint can't be solved for any symbol in closed form, or not in time.
    EmptyDomainError
        Where no point of the domain satisfies the constraints: a claim about none is not taken for right.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> l = sp.Symbol("l", positive=True)
    >>> on_manifold([x**2 + y**2 - l**2], Domain())[0].values
    {l: sqrt(x**2 + y**2)}
    """
    branches = [Branch({}, domain)]
    for constraint in constraints:
        branches = [
            part for branch in branches for part in _restricted(branch, constraint, keep, prefer, until)
        ]
        if len(branches) > MAX_BRANCHES:
            raise Undecided(f"the constraints have more than {MAX_BRANCHES} branches; split the claim")
    branches = [branch for branch in branches if not any(_without_value(c, branch) for c in constraints)]
    if not branches:
        raise EmptyDomainError(_NO_POINT)
    return branches


def _without_value(constraint: Expr, branch: Branch) -> bool:
    """Whether a constraint has a value nowhere on a branch: zeros of its denominators are no solutions of it."""
    there = put_in(constraint, dict(branch.values.items()))
    lack = lack_of_value(there, branch.domain, time.monotonic() + SECONDS)
    return lack is not None and lack.proved


def inhabited(branches: Iterable[Branch]) -> list[Branch]:
    """Return the branches without those of which it is proved that they hold no point.

    Raises
    ------
    EmptyDomainError
        Where none is left.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> inhabited(on_manifold([x**2 + y**2 + 1], Domain()))
    Traceback (most recent call last):
        ...
    canon.mechanics.algebra.constraint_manifold.EmptyDomainError: no point satisfies the constraints, ...
    """
    found = [b for b in branches if not _without_point(b.domain)]
    if not found:
        raise EmptyDomainError(_NO_POINT)
    return found


def check_not_empty(constraints: Sequence[Expr], q: Sequence[Symbol], domain: Domain, t: Symbol) -> None:
    """Refuse positions of which it is proved that there are none; arbitrary functions may stay unsolved.

    Examples
    --------
    >>> from canon import coordinates
    >>> x = coordinates("x")
    >>> check_not_empty([x, x - 1], [x], Domain(), sp.Symbol("t", real=True))
    Traceback (most recent call last):
        ...
    canon.mechanics.algebra.constraint_manifold.EmptyDomainError: no point satisfies the constraints, ...
    """
    rates = [velocity(x) for x in q]
    try:
        inhabited(on_manifold([f for f in constraints if not f.has(*rates)], domain, keep=(t,)))
    except Undecided:
        return


def check_whole(constraints: Sequence[Expr], velocities: Sequence[Symbol], domain: Domain) -> None:
    """Refuse constraints on velocities that hold as well wherever something without velocities vanishes.

    y (ẋ − ẏ) = 0 allows every velocity where y = 0: that is a part of the manifold as large as the other.

    Examples
    --------
    >>> from canon import coordinates
    >>> x, y = coordinates("x y")
    >>> check_whole([y * (x.dot - y.dot)], [x.dot, y.dot], Domain())
    Traceback (most recent call last):
        ...
    canon.proof.domain.verdict.Undecided: the constraint holds for all velocities where y = 0; ...
    """
    for g in constraints:
        for factor, _ in polynomial_factors(g) if g.has(*velocities) else ():
            if (
                not factor.has(*velocities)
                and factor.is_nonzero is not True
                and proved_sign(factor, domain) not in ("+", "-")
                and sp.Ne(factor, 0) not in domain.conditions
            ):
                raise Undecided(
                    f"the constraint holds for all velocities where {factor} = 0; "
                    "divide by it, or exclude that in the domain"
                )


def transported(domain: Domain, values: Mapping[Symbol, Expr]) -> Domain:
    """Return the domain after a substitution, what was assumed of the replaced symbols turned into conditions.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> p = sp.Symbol("p", positive=True)
    >>> transported(Domain(), {p: x}).conditions
    (x > 0,)

    Raises
    ------
    EmptyDomainError
        Where a condition is false at every point.
    """
    try:
        conditions = [
            *(cast("Boolean", c.subs(list(values.items()), simultaneous=True)) for c in domain.conditions),
            *(sign for symbol, value in values.items() for sign in _signs(symbol, value)),
        ]
    except TypeError as error:  # SymPy does not compare numbers that are not real
        raise EmptyDomainError(f"a value that should be real is not ({error})") from error
    if sp.false in conditions:
        raise EmptyDomainError(
            "no point satisfies the assumptions and conditions; they contradict each other"
        )
    kept = {symbol: ends for symbol, ends in domain.box.items() if symbol not in values}
    kept_conditions = dict.fromkeys(c for c in conditions if c is not sp.true)
    found = Domain(tuple(kept_conditions), kept)
    if kept_conditions.keys() - set(domain.conditions) and _without_point(found):
        raise EmptyDomainError(_NO_POINT)
    return found


def _without_point(domain: Domain) -> bool:
    """Whether it is proved that a domain holds no point."""
    return not has_point(domain) and is_empty(domain, time.monotonic() + SECONDS)


def _signs(symbol: Symbol, value: Expr) -> Iterator[Boolean]:
    """Yield what is assumed of a symbol as a condition on its value, unless the value has that sign anyway."""
    if symbol.is_positive and not value.is_positive:
        yield cast("Boolean", sp.Gt(value, 0))
    elif symbol.is_negative and not value.is_negative:
        yield cast("Boolean", sp.Lt(value, 0))
    elif symbol.is_nonzero and not value.is_nonzero:
        yield cast("Boolean", sp.Ne(value, 0))


def _restricted(
    branch: Branch, constraint: Expr, keep: Sequence[Symbol], prefer: Sequence[Symbol], until: float
) -> Iterator[Branch]:
    if time.monotonic() > until:
        raise Undecided("the constraints were not solved in time; give more of it, or fewer constraints")
    here = substitute(constraint, branch.values)
    if here.is_nonzero:
        return
    if here == 0 or vanishes_off_kinks(here, branch.domain, budget=1.0).holds:
        yield branch
        return
    for factor in _factors(here, prefer):
        solution = min(_solutions(factor, branch.domain, keep, prefer), key=lambda s: s.cost, default=None)
        if solution is None:
            raise Undecided(
                f"{factor} = 0 could not be solved for any of its symbols in closed form; "
                "write the constraint solved for one of them"
            )
        if _leaves_a_handle(solution, branch.domain):
            raise Undecided(
                f"{factor} = 0 holds at singular points too, which are not looked into; "
                "exclude them in the domain"
            )
        found = False
        for root in solution.roots:
            try:
                part = branch.and_then(solution.symbol, root.value, root.conditions)
            except EmptyDomainError:
                continue
            found = True
            yield part
        if not found and not solution.everywhere:  # k x² + y² = 0 with k > 0 holds at x = y = 0
            raise Undecided(
                f"{factor} = 0 holds at singular points at most, which are not looked into; "
                "write what holds there as equations of their own"
            )


def _leaves_a_handle(solution: _Solution, domain: Domain) -> bool:
    """Whether x² z = y² was solved for z ≥ 0: x = y = 0 allows every z, and z < 0 is no limit of the graph."""
    if solution.everywhere or solution.quotient is None:
        return False
    return all(f != 0 and proved_sign(f, domain) in ("0+", "0-") for f in solution.quotient)


def _factors(expression: Expr, prefer: Sequence[Symbol]) -> list[Expr]:
    """Return the factors of the numerator that can vanish.

    Where some hold what is solved for, such as velocities, the others vanish in singular points only.
    """
    able = [f for f, _ in polynomial_factors(expression) if not (f.is_nonzero or f.is_positive)]
    return [f for f in able if prefer and f.has(*prefer)] or able or [sp.numer(sp.together(expression))]


def _solutions(
    c: Expr, domain: Domain, keep: Sequence[Symbol], prefer: Sequence[Symbol]
) -> Iterator[_Solution]:
    able = [s for s in symbols_of(c) if not s.is_integer and s not in keep]
    found = [solution for s in able for solution in _of_polynomial_in(c, s, 0 if s in prefer else 1)]
    yield from found
    for symbol in () if found else able:
        roots = real_solutions(c, symbol, domain)
        if roots is not None:
            cost = (0 if symbol in prefer else 1, int(sp.count_ops(c)))
            yield _Solution(symbol, tuple(roots), cost, everywhere=len(symbols_of(c)) == 1)


def _of_polynomial_in(c: Expr, symbol: Symbol, wanted: int) -> Iterator[_Solution]:
    poly = polynomial_in(c, symbol)
    single = poly is not None and bool(symbol.is_positive) and is_binomial(poly)
    if poly is None or (poly.degree() > 2 and not single):
        return
    lead = cast("Expr", poly.LC())
    certain = bool(lead.is_nonzero or lead.is_positive or lead.is_negative)
    linear = poly.degree() == 1
    kind = 0 if linear else 1 if single else 4 if is_binomial(poly) else 5
    cost = (kind + (0 if certain else 2), 10 * wanted + int(sp.count_ops(lead)))
    quotient = (cast("Expr", poly.nth(0)), lead) if linear else None
    yield _Solution(symbol, tuple(real_roots(poly, positive=single) or ()), cost, certain, quotient)
