"""Parameter values for which expressions vanish at every state: conditions at points, solved exactly.

What vanishes for all states vanishes with its derivatives at one state, so that each such value is a condition on the
parameters alone. The conditions are necessary; what solves them is put in again, and more of them are asked for until
the expressions vanish or nothing is left. Nothing is said where a part might have no value at the state, or where a
condition has no solutions in closed form.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, islice, product
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.mechanics.algebra.solve_for_symbol import real_solutions
from canon.mechanics.algebra.substitution import exchanged, substitute, symbols_of
from canon.proof.analytic import proved_sign
from canon.proof.continuity.smooth import PIECED
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Undecided
from canon.proof.trees.affine_form import is_affine
from canon.proof.trees.function_places import at_plain_places, outermost, places_apart
from canon.proof.trees.polynomial import polynomial_factors
from canon.proof.trees.sympy_types import arguments, rational
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy.logic.boolalg import Boolean

    from canon.exercise.question.deadline import Deadline

__all__ = ["Family", "families"]

Family = dict[Symbol, Expr]
"""What some of the wanted parameters are; the others are free."""

MOST_FAMILIES = 32
FEW_CONDITIONS, MOST_CONDITIONS = 8, 60
"""Conditions that are looked at, and that are looked at where the few are not solved."""
MOST_ROUNDS = 8
LONGEST = 300
LAST = 0.1
"""Seconds that must be left for another round."""
NICE = tuple(rational(sp.Rational(*n)) for n in ((0, 1), (1, 1), (2, 1), (-1, 1), (1, 2), (3, 1)))
"""Values of states at which logarithms, powers and sines are simple."""
_TOTAL = (
    sp.Add, sp.Mul, sp.Symbol, sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh, sp.tanh, sp.atan, sp.asinh, AppliedUndef,
)  # fmt: skip
"""What has a value for all real arguments."""


@dataclass(frozen=True)
class _Search:
    residuals: tuple[Expr, ...]
    wanted: tuple[Symbol, ...]
    given: tuple[Symbol, ...]
    domain: Domain
    deadline: Deadline


def families(
    residuals: Sequence[Expr],
    wanted: Sequence[Symbol],
    given: Sequence[Symbol],
    domain: Domain,
    deadline: Deadline,
) -> list[Family]:
    """Return all values of parameters for which expressions vanish at every state of a domain.

    Parameters
    ----------
    residuals
        What should vanish.
    wanted, given
        The parameters asked for, and those in terms of which they may be; all other symbols are the state.
    domain
        Of parameters and states.
    deadline
        When to stop.

    Raises
    ------
    Undecided
        Where that could not be told.

    Examples
    --------
    >>> from canon.exercise.question.deadline import Deadline
    >>> q = sp.Symbol("q", positive=True)
    >>> a, b = sp.symbols("a b", real=True)
    >>> families([a * b * q ** (2 * a - 1) - 1], [a, b], [], Domain(), Deadline.after(5.0))
    [{a: 1/2, b: 2}]
    """
    known = tuple(r for r in residuals if r != 0)
    search = _Search(known, tuple(wanted), tuple(given), domain, deadline)
    found = list(_completed(search, {}, MOST_ROUNDS))
    unique: list[Family] = []
    for family in found:
        if not any(covers(other, family, domain, deadline) for other in unique):
            unique = [other for other in unique if not covers(family, other, domain, deadline)] + [family]
    return unique


def covers(
    larger: Mapping[Symbol, Expr], smaller: Mapping[Symbol, Expr], domain: Domain, deadline: Deadline
) -> bool:
    """Tell whether it is proved that every point of one family is one of another.

    Examples
    --------
    >>> from canon.exercise.question.deadline import Deadline
    >>> a, b = sp.symbols("a b", real=True)
    >>> covers({b: 2 - a}, {a: sp.Integer(1), b: sp.Integer(1)}, Domain(), Deadline.after(5.0))
    True
    """
    gaps = [substitute(s - value, smaller) for s, value in larger.items()]
    return all(gap == 0 or vanishes(gap, domain, budget=deadline.left).holds for gap in gaps)


def _completed(search: _Search, family: Family, rounds: int) -> Iterator[Family]:
    """Yield the families within one in which everything vanishes."""
    if not _allowed(family, search.domain):
        return
    domain = _narrowed(search.domain, family)
    left = [r for r in (at_plain_places(substitute(r, family)) for r in search.residuals) if r != 0]
    left = [r for r in left if not vanishes(r, domain, budget=search.deadline.left).holds]
    if not left:
        yield family
        return
    free = [s for s in search.wanted if s not in family]
    solved = _next_step(search, left, free, domain, rounds)
    for number, step in enumerate(solved):
        if number >= MOST_FAMILIES:
            raise Undecided(f"more than {MOST_FAMILIES} cases of the parameters; narrow the domain")
        known = {s: substitute(value, step) for s, value in family.items()} | step
        if any(value.has(sp.nan, sp.zoo, sp.oo, -sp.oo) for value in known.values()):
            continue
        yield from _completed(search, known, rounds - 1)


def _next_step(
    search: _Search, left: Sequence[Expr], free: Sequence[Symbol], domain: Domain, rounds: int
) -> list[Family]:
    """Return values of one more parameter by which expressions may vanish; none where they certainly do not.

    The conditions take values of one arbitrary function at different places for independent of each other; where
    the places are one, they are not: parameters that bring them together are a case of its own.
    """
    why = "the conditions on the parameters were not found"
    left, together = _brought_together(search, left, free, domain, rounds)
    for most in (FEW_CONDITIONS, MOST_CONDITIONS):
        found = sorted(set(_conditions(left, free, search.given, domain, most)), key=_simplicity)
        conditions = [c for c in found if c.has(*free)]
        of_given = [vanishes(c, domain, budget=search.deadline.left) for c in found if not c.has(*free)]
        if any(verdict.fails for verdict in of_given):
            return together
        if any(verdict.undecided for verdict in of_given) or not conditions:
            continue
        if rounds == 0 or search.deadline.left < LAST:
            raise Undecided("the conditions on the parameters were not solved in time")
        solved = _solved_first(conditions, free, domain)
        if solved is not None:
            return [*together, *solved]
        why = f"the condition {conditions[0]} = 0 on the parameters has no solution in closed form here"
    raise Undecided(why)


def _brought_together(
    search: _Search, left: Sequence[Expr], free: Sequence[Symbol], domain: Domain, rounds: int
) -> tuple[list[Expr], list[Family]]:
    """Return expressions with one way of writing each place of an arbitrary function, and where two places are one.

    Raises
    ------
    Undecided
        Where that was not told: there f(u) and f(v) might be one number, or two.
    """
    pairs = (pair for f, g in places_apart(left) for pair in zip(arguments(f), arguments(g), strict=True))
    same = {u: v for u, v in pairs if sp.expand(u - v) == 0}
    left = [exchanged(r, same) for r in left] if same else list(left)
    found = [
        family for f, g in places_apart(left) for family in _at_one_place(search, f, g, free, domain, rounds)
    ]
    if {} in found:
        raise Undecided("an arbitrary function is taken at one place that is written in two ways")
    return left, found


def _at_one_place(
    search: _Search, f: AppliedUndef, g: AppliedUndef, free: Sequence[Symbol], domain: Domain, rounds: int
) -> list[Family]:
    """Return the parameters for which two values of a function are taken at one place, whatever the state."""
    gaps = tuple(u - v for u, v in zip(arguments(f), arguments(g), strict=True) if u != v)
    if any(gap.has(*PIECED) for gap in gaps):
        raise Undecided(f"whether {f} and {g} are taken at one place depends on the state")
    if not any(gap.has(*free) for gap in gaps):
        if any(vanishes(gap, domain, budget=search.deadline.left).fails for gap in gaps):
            return []
        raise Undecided(f"whether {f} and {g} are taken at one place was not decided")
    if rounds == 0:
        raise Undecided("the conditions on the parameters were not solved in time")
    at = _Search(gaps, tuple(free), search.given, domain, search.deadline)
    return list(_completed(at, {}, rounds - 1))


def _solved_first(conditions: Sequence[Expr], free: Sequence[Symbol], domain: Domain) -> list[Family] | None:
    """Return the solutions of the first condition that can be solved: for each factor a value of one parameter."""
    for condition in conditions:
        found: list[Family] | None = []
        for factor, _ in polynomial_factors(condition):
            if factor.has(*free):
                steps = _of_factor(factor, free, domain)
                found = None if steps is None or found is None else [*found, *steps]
        if found is not None:
            return found
    return None


def _of_factor(factor: Expr, free: Sequence[Symbol], domain: Domain) -> list[Family] | None:
    """Return values of one parameter where a factor vanishes, and those of another where the first is left open."""
    unknowns = [s for s in free if factor.has(s)]
    for s in (s for s in unknowns if is_affine(factor, [s])):
        slope = sp.expand(factor).diff(s)
        regular: Family = {s: sp.cancel(-exchanged(factor, {s: sp.S.Zero}) / slope)}
        if not slope.has(*free):
            return [regular]
        singular = _solved_first([slope], [t for t in free if slope.has(t)], domain)
        return None if singular is None else [regular, *singular]
    for s in unknowns:
        roots = real_solutions(factor, s, domain)
        if roots is not None and not any(r.value.atoms(sp.Dummy) for r in roots):
            return [{s: root.value} for root in roots if _real(root.conditions)]
    return None


def _real(conditions: Sequence[Expr]) -> bool:
    return not any(c.is_negative for c in conditions)


def _conditions(
    residuals: Sequence[Expr], free: Sequence[Symbol], given: Sequence[Symbol], domain: Domain, most: int
) -> Iterator[Expr]:
    """Yield what should vanish for the parameters, at most so many from one expression."""
    for residual in residuals:
        for part in _independent(residual):
            state = [s for s in symbols_of(part) if s not in free and s not in given]
            yield from islice(_at_points(part, state, free, domain), most)


def _independent(residual: Expr) -> Iterator[Expr]:
    """Yield the coefficients of arbitrary functions and their derivatives, which take any values at a state."""
    outer = outermost(residual)
    names: dict[Expr, Symbol] = {f: sp.Dummy("f") for f in sorted(outer, key=sp.default_sort_key)}
    numerator = sp.numer(sp.together(exchanged(residual, names))) if names else residual
    if not names:
        yield residual
        return
    try:
        yield from sp.Poly(numerator, *names.values()).coeffs()
    except sp.PolynomialError as error:
        raise Undecided(
            "arbitrary functions stand in the conditions in a way that is not polynomial"
        ) from error


def _at_points(
    residual: Expr, state: Sequence[Symbol], free: Sequence[Symbol], domain: Domain
) -> Iterator[Expr]:
    """Yield values at states, then those of first and of second derivatives."""
    points = list(_points(state, domain))
    smooth = not residual.has(*PIECED)
    first = [(s,) for s in state] if smooth else []
    second = [*((s, s) for s in state), *combinations(state, 2)] if smooth else []
    for orders in ([()], first, second):
        derivatives = [residual.diff(*by) if by else residual for by in orders]
        for point in points:
            for f in derivatives:
                there = _value(f, point, free, domain)
                if there is not None:
                    yield there


def _points(state: Sequence[Symbol], domain: Domain) -> Iterator[dict[Symbol, sp.Rational]]:
    """Yield states inside the domain, those with small whole numbers first."""
    about = Domain(tuple(c for c in domain.conditions if c.free_symbols <= set(state)))
    numbers = [[n for n in NICE if _may_be(s, n)] for s in state]
    nice = islice((dict(zip(state, chosen, strict=True)) for chosen in product(*numbers)), 40)
    tied = len(about.conditions) != len([c for c in domain.conditions if c.has(*state)]) if state else False
    if tied:
        return
    yield from islice((point for point in nice if about.contains(point)), 6)
    yield from ({s: p[s] for s in state} for p in about.points(state, 2))


def _may_be(s: Symbol, number: sp.Rational) -> bool:
    facts = (s.is_positive and not number > 0) or (s.is_negative and not number < 0)
    return not (facts or (s.is_nonzero and number == 0) or (s.is_integer and not number.is_integer))


def _value(f: Expr, point: Mapping[Symbol, Expr], free: Sequence[Symbol], domain: Domain) -> Expr | None:
    """Return what vanishes with a value at a state; where it is divided by zero is a case of its own.

    None where it may have no value for other parameters.
    """
    if any(not _off_the_kink(part, point) for part in f.atoms(*PIECED)):
        return None
    there = substitute(f, point)
    if there == 0 or there.has(sp.nan, sp.zoo, sp.oo, -sp.oo, sp.DiracDelta, sp.I):
        return None
    if not all(_has_value(part, free, domain) for part in sp.preorder_traversal(there)):
        return None
    there = _in_one_wave(there)
    below = sp.denom(sp.together(there))
    if below.has(*free):
        there = there * below * below
    value = sp.factor_terms(sp.expand(sp.numer(sp.together(there))))
    return value if value != 0 and sp.count_ops(value) < LONGEST else None


def _off_the_kink(part: Expr, point: Mapping[Symbol, Expr]) -> bool:
    there = substitute(arguments(part)[0], point) if isinstance(part, sp.Abs | sp.sign) else sp.S.Zero
    return bool(there.is_number and there.is_nonzero)


def _in_one_wave(f: Expr) -> Expr:
    """Write cos² of an angle that holds no state as 1 − sin²."""
    for wave in sorted(f.atoms(sp.cos), key=sp.default_sort_key):
        sine = sp.sin(arguments(wave)[0])
        f = cast("Expr", f.xreplace({wave**2: 1 - sine**2}))
    return f


def _has_value(part: sp.Basic, free: Sequence[Symbol], domain: Domain) -> bool:
    if not part.has(*free):
        return True
    if isinstance(part, sp.Pow):
        if part.exp.is_integer:
            return True
        return bool(part.base.is_positive) or proved_sign(part.base, domain) == "+"
    if isinstance(part, sp.log):
        return proved_sign(arguments(part)[0], domain) == "+"
    return isinstance(part, _TOTAL)


def _allowed(family: Mapping[Symbol, Expr], domain: Domain) -> bool:
    """Whether values may be what is assumed of the parameters, and satisfy the conditions on them."""
    for s, value in family.items():
        if value.is_real is False or (s.is_positive and value.is_nonpositive):
            return False
        if (s.is_negative and value.is_nonnegative) or (s.is_nonzero and value.is_zero):
            return False
        if s.is_integer and value.is_integer is False:
            return False
    return all(c.subs(list(family.items()), simultaneous=True) != sp.false for c in domain.conditions)


def _narrowed(domain: Domain, family: Mapping[Symbol, Expr]) -> Domain:
    conditions = (c.subs(list(family.items()), simultaneous=True) for c in domain.conditions)
    kept = cast("tuple[Boolean, ...]", tuple(c for c in conditions if c != sp.true))
    return Domain(kept, domain.box)


def _simplicity(condition: Expr) -> tuple[int, int, str]:
    return len(condition.free_symbols), int(sp.count_ops(condition)), str(condition)
