"""Cases of Abs, sign, Max, Min and Piecewise: the domain is cut where they change."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.core.relational import Relational
from sympy.logic.boolalg import Boolean

from canon.proof.domain.declarations import declared_complex
from canon.proof.domain.domain import Domain
from canon.proof.domain.reality import certainly_real
from canon.proof.rungs.periods import period_of
from canon.proof.trees.affine_form import is_affine
from canon.proof.trees.anatomy import anatomy
from canon.proof.trees.bound_variables import with_bound_variables
from canon.proof.trees.polynomial import MOST_TERMS, is_left_out, polynomial_factors, terms_at_most
from canon.proof.trees.replacement import KINKED, NoValue, defined_nowhere, replaced
from canon.proof.trees.sympy_types import arguments, by_name, free_symbols

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr, Symbol

__all__ = [
    "Case",
    "cases",
    "eliminations",
    "settle_equalities",
    "under_derivatives",
    "without_symbol",
]

MOST_VALUES = 24
"""Values or residues of an integer that are gone through one by one."""

MONOTONIC = (sp.exp, sp.sinh, sp.tanh, sp.atan, sp.asinh)
"""Functions that grow on the whole real line."""


@dataclass(frozen=True)
class Case:
    """One piece of the domain and what the expression is there; None where it is defined nowhere."""

    expr: Expr | None
    domain: Domain
    where: str


def cases(expr: Expr, domain: Domain) -> list[Case] | None:
    """Cut the domain so that one piecewise function less is left, or one symbol has a sign.

    The pieces cover the domain, so an expression that vanishes on each of them vanishes. Nothing is cut
    under a derivative, which looks beyond the points of a piece, nor by the sign of a variable of integration or
    summation, which runs through all of its range, nor where SymPy refuses a value.
    """
    found = anatomy([expr])
    if any(d.has(sp.Piecewise, *KINKED) for d in found.of(sp.Derivative, sp.Subs)):
        return None
    try:
        return _cut(expr, domain, with_bound_variables(found))
    except NoValue:
        return None


def _cut(expr: Expr, domain: Domain, inside: set[sp.Basic]) -> list[Case] | None:
    piecewise = sorted(expr.atoms(sp.Piecewise) - inside, key=sp.default_sort_key)
    if piecewise:
        return list(_pieces(expr, domain, _innermost(piecewise)))
    found = sorted(expr.atoms(*KINKED) - inside, key=sp.default_sort_key)
    found = [e for e in found if not any(map(declared_complex, e.free_symbols)) and e.free_symbols]
    if found:
        innermost = _innermost(found)
        if len(innermost.free_symbols) == 1 and not all(a.is_polynomial() for a in innermost.args):
            by_symbol = _by_symbol(innermost, domain, expr)
            if by_symbol is not None:
                return by_symbol
        return _by_kind(expr, domain, innermost)
    return _by_integer(expr, domain) or _by_symbol(expr, domain) or _by_slope(expr, domain)


def _innermost(parts: Sequence[Expr]) -> Expr:
    """Return the first part that none of the others stands in."""
    return next(p for p in parts if not any(other != p and p.has(other) for other in parts))


def _by_integer(expr: Expr, domain: Domain) -> list[Case] | None:
    """Cut by the few values of a bounded integer, or by its residue where it turns angles of πn/d."""
    for n in by_name(expr):
        if not n.is_integer or expr.has(sp.Derivative, sp.Subs):
            continue
        low, high, _ = domain.interval(n)
        if low.is_finite and high.is_finite and high - low <= MOST_VALUES:
            values = range(int(sp.ceiling(low)), int(sp.floor(high)) + 1)
            return [_substituted(expr, domain, n, sp.Integer(k), f"{n} = {k}") for k in values]
        period = period_of(expr, n)
        if 1 < period <= MOST_VALUES:
            turns = sp.Dummy("k", integer=True)
            return [
                _substituted(expr, domain, n, period * turns + r, f"{n} = {period}k + {r}")
                for r in range(period)
            ]
    return None


def _by_kind(expr: Expr, domain: Domain, function: sp.Basic) -> list[Case] | None:
    if isinstance(function, sp.Max | sp.Min):
        return [_extreme(expr, domain, function, i) for i in range(len(function.args))]
    u = arguments(function)[0]
    if not certainly_real(u):
        return None
    if isinstance(function, sp.Abs):
        return [
            _case(expr, {function: u}, domain, sp.Ge(u, 0)),
            _case(expr, {function: -u}, domain, sp.Lt(u, 0)),
        ]
    below, at_zero = (sp.Integer(-1), sp.Integer(0))
    if isinstance(function, sp.Heaviside):
        below, at_zero = sp.Integer(0), arguments(function)[1]
    off_zero = [
        _case(expr, {function: sp.Integer(1)}, domain, sp.Gt(u, 0)),
        _case(expr, {function: below}, domain, sp.Lt(u, 0)),
    ]
    if is_left_out(u, domain.conditions):
        return off_zero
    return [*off_zero, _case(expr, {function: at_zero}, domain, sp.Eq(u, 0))]


def _extreme(expr: Expr, domain: Domain, function: sp.Max | sp.Min, i: int) -> Case:
    """Return the case in which argument i is the first that is largest (smallest)."""
    chosen = arguments(function)[i]
    conditions: list[Boolean] = []
    for j, other in enumerate(arguments(function)):
        if j != i:
            larger, smaller = (chosen, other) if isinstance(function, sp.Max) else (other, chosen)
            conditions.append(_without_monotonic(larger, smaller, strict=j < i))
    return _case(expr, {function: chosen}, domain, sp.And(*conditions))


def _without_monotonic(larger: Expr, smaller: Expr, *, strict: bool) -> Boolean:
    while larger.func == smaller.func and isinstance(larger, MONOTONIC):
        inside = arguments(larger)[0], arguments(smaller)[0]
        if not all(map(certainly_real, inside)):
            break
        larger, smaller = inside
    return cast("Boolean", sp.Gt(larger, smaller) if strict else sp.Ge(larger, smaller))


def _case(expr: Expr, by: Mapping[sp.Basic, Expr], domain: Domain, condition: sp.Basic) -> Case:
    known = Domain(tuple(replaced(c, by) for c in domain.conditions), domain.box)
    return settle_equalities(replaced(expr, by), _narrowed(known, condition), str(condition))


def _narrowed(domain: Domain, *conditions: sp.Basic) -> Domain:
    added: list[Boolean] = []
    for condition in conditions:
        if isinstance(condition, sp.And):
            added.extend(condition.args)
        elif isinstance(condition, Boolean) and condition != sp.true:
            added.append(condition)
    return Domain((*domain.conditions, *added), domain.box)


def _pieces(expr: Expr, domain: Domain, function: sp.Basic) -> Iterator[Case]:
    """Yield one case for each way in which one piece's condition holds and those before fail."""
    failed: list[sp.Basic] = []
    for piece, condition in cast("tuple[tuple[Expr, Boolean], ...]", function.args):
        applies = sp.And(condition, *(sp.Not(c) for c in failed))
        alternatives = sp.to_dnf(applies) if len(applies.atoms(Relational)) <= 8 else applies
        for alternative in alternatives.args if isinstance(alternatives, sp.Or) else (alternatives,):
            if alternative != sp.false:
                chosen, narrowed = replaced(expr, {function: piece}), _narrowed(domain, alternative)
                if defined_nowhere(chosen):
                    yield Case(None, narrowed, str(alternative))
                else:
                    yield settle_equalities(chosen, narrowed, str(alternative))
        failed.append(condition)


def _by_symbol(deciding: Expr, domain: Domain, whole: Expr | None = None) -> list[Case] | None:
    """Cut by the sign of a real symbol under a root, a logarithm or an inverse function in ``deciding``."""
    expr = deciding if whole is None else whole
    if expr.has(sp.Derivative, sp.Subs):
        return None
    candidates: dict[Symbol, int] = {}
    free = free_symbols(expr)
    for part in sp.preorder_traversal(deciding):
        branching = isinstance(part, sp.Function) and not isinstance(
            part,
            sp.sin | sp.cos | sp.tan | sp.exp | sp.sinh | sp.cosh | sp.tanh | sp.core.function.AppliedUndef,
        )
        if branching or (isinstance(part, sp.Pow) and not part.exp.is_integer):
            for s in free_symbols(part):
                if s in free and not (s.is_nonnegative or s.is_nonpositive or declared_complex(s)):
                    candidates[s] = candidates.get(s, 0) + 1
    if not candidates:
        return None
    chosen = max(sorted(candidates, key=lambda s: s.name), key=lambda s: candidates[s])
    kind = {"integer": True} if chosen.is_integer else {}
    positive = sp.Dummy(chosen.name, positive=True, **kind)
    found = [
        _substituted(expr, domain, chosen, positive, f"{chosen} > 0"),
        _substituted(expr, domain, chosen, -positive, f"{chosen} < 0"),
    ]
    if chosen.is_zero is not False:
        found.append(_substituted(expr, domain, chosen, sp.Integer(0), f"{chosen} = 0"))
    return found


def _substituted(expr: Expr, domain: Domain, symbol: Symbol, by: Expr, where: str) -> Case:
    box = {s: ends for s, ends in domain.box.items() if s != symbol}
    conditions = [replaced(c, {symbol: by}) for c in domain.conditions]
    narrowed = Domain(tuple(c for c in conditions if c != sp.true), box)
    value = replaced(expr, {symbol: by})
    return Case(None if defined_nowhere(value) else value, narrowed, where)


def settle_equalities(expr: Expr, domain: Domain, where: str = "") -> Case:
    """Use equalities of the domain to remove symbols that they hold linearly, with a slope that is not zero.

    A symbol that is differentiated by, or for which SymPy takes no such value, stays.
    """
    for s, solution, narrowed in eliminations(domain, under_derivatives(expr, domain)):
        try:
            value = replaced(expr, {s: solution})
        except NoValue:
            continue
        if defined_nowhere(value):
            return Case(None, narrowed, where)
        return settle_equalities(value, narrowed, where)
    return Case(expr, domain, where)


def eliminations(
    domain: Domain, staying: set[sp.Basic], *, constant: bool = False
) -> Iterator[tuple[Symbol, Expr, Domain]]:
    """Yield a symbol, what an equality of the domain says that it is, and the domain of the others.

    Parameters
    ----------
    domain
        With equalities among its conditions, or with g ≥ 0 and g ≤ 0.
    staying
        Symbols that are not removed.
    constant
        Only where the slope is a number.

    Examples
    --------
    >>> a = sp.Symbol("a", positive=True)
    >>> b, d = sp.symbols("b d", real=True)
    >>> [(s, value) for s, value, _ in eliminations(Domain((sp.Eq(a * d - b, 1),)), set())]
    [(b, a*d - 1), (d, (b + 1)/a)]
    """
    found: list[tuple[bool, Symbol, Expr, sp.Basic]] = []
    for condition in (*domain.conditions, *_pinched(domain)):
        for s, slope, rest in _linear_in(condition, staying):
            if slope.free_symbols and (constant or not _known_nonzero(slope, domain)):
                continue
            if slope.free_symbols or slope.is_zero is False:
                found.append((bool(slope.free_symbols), s, -rest / slope, condition))
    for _, s, solution, condition in sorted(found, key=lambda one: one[0]):
        narrowed = without_symbol(domain, condition, s, solution)
        if narrowed is not None:
            yield s, solution, narrowed


def without_symbol(domain: Domain, equality: sp.Basic, s: Symbol, solution: Expr) -> Domain | None:
    """Return the domain of the other symbols where an equality gives one; None where SymPy takes no such value."""
    try:
        others = [replaced(c, {s: solution}) for c in domain.conditions if c != equality]
    except NoValue:
        return None
    box = {name: ends for name, ends in domain.box.items() if name != s}
    return Domain(tuple(c for c in (*others, *_assumed(s, solution)) if c != sp.true), box)


def _linear_in(condition: sp.Basic, staying: set[sp.Basic]) -> Iterator[tuple[Symbol, Expr, Expr]]:
    """Yield each symbol that an equality holds linearly, its slope, and the rest.

    That is shown by the form of the equality: a step, or atan(tan s), has a constant slope and more solutions than one.
    """
    if (
        not isinstance(condition, sp.Eq)
        or not isinstance(condition.lhs, sp.Expr)
        or not isinstance(condition.rhs, sp.Expr)
    ):
        return
    gap = condition.lhs - condition.rhs
    for s in by_name(gap):
        if s in staying or not is_affine(gap, [s]):
            continue
        slope = sp.expand(gap).diff(s) if s in gap.diff(s).free_symbols else gap.diff(s)
        if slope == 0:
            continue
        try:
            yield s, slope, replaced(gap, {s: sp.Integer(0)})
        except NoValue:
            continue


def _known_nonzero(slope: Expr, domain: Domain) -> bool:
    """Tell whether assumptions or conditions say of every factor that it does not vanish."""
    said = set(domain.conditions)
    strict = ((sp.Ne(f, 0), sp.Gt(f, 0), sp.Lt(f, 0)) for f in _vanishing(slope))
    return all(said.intersection(ways) for ways in strict)


def _vanishing(product: Expr) -> list[Expr]:
    """Return the factors that may vanish, without their powers."""
    factors = sp.Mul.make_args(sp.factor_terms(product))
    bases = [f.base if isinstance(f, sp.Pow) else f for f in factors]
    return [base for base in bases if base.is_zero is not False]


def _by_slope(expr: Expr, domain: Domain) -> list[Case] | None:
    """Cut by the factors of an equality, or by whether the slope of a symbol in it vanishes."""
    staying = under_derivatives(expr, domain)
    equalities = (c for c in domain.conditions if isinstance(c, sp.Eq) and isinstance(c.lhs, sp.Expr))
    for condition in equalities:
        others = Domain(tuple(c for c in domain.conditions if c != condition), domain.box)
        vanishing = _factors_that_cut(condition)
        if vanishing:
            return [settle_equalities(expr, _narrowed(others, c), str(c)) for c in vanishing]
        for s, slope, rest in _linear_in(condition, staying):
            if _may_vanish(s, slope, domain):
                regular = _narrowed(domain, *(sp.Ne(f, 0) for f in _vanishing(slope)))
                singular = _narrowed(others, _equality(slope), _equality(rest))
                return [
                    settle_equalities(expr, regular, f"{slope} ≠ 0"),
                    settle_equalities(expr, singular, f"{slope} = 0"),
                ]
    return None


def _factors_that_cut(condition: sp.Eq) -> list[Boolean]:
    """Return for each factor of an equality that it vanishes; nothing where it has one factor, and that once."""
    gap = cast("Expr", condition.lhs) - cast("Expr", condition.rhs)
    factors = [f for f, _ in polynomial_factors(gap)]
    if len(factors) > 1 or (factors and sp.expand(gap / factors[0]).free_symbols):
        return [_equality(f) for f in factors]
    return []


def _may_vanish(s: Symbol, slope: Expr, domain: Domain) -> bool:
    return bool(slope.free_symbols) and not declared_complex(s) and not _known_nonzero(slope, domain)


def _equality(gap: Expr) -> Boolean:
    return cast("Boolean", sp.Eq(gap, 0))


def under_derivatives(expr: sp.Basic, domain: Domain) -> set[sp.Basic]:
    """Return the symbols that are differentiated by, or that stand inside a derivative."""
    derivatives = anatomy([expr, *domain.conditions]).of(sp.Derivative, sp.Subs)
    return set[sp.Basic]().union(*(d.free_symbols for d in derivatives))


def _pinched(domain: Domain) -> list[sp.Basic]:
    """Return g = 0 where the domain says both g ≥ 0 and g ≤ 0."""
    closed = [c for c in domain.conditions if isinstance(c, sp.GreaterThan | sp.LessThan)]
    written = [cast("Expr", c.gts) - cast("Expr", c.lts) for c in closed]
    gaps = [sp.expand(gap) for gap in written if terms_at_most(gap) <= MOST_TERMS]
    return [cast("sp.Basic", sp.Eq(gap, 0)) for gap in gaps if -gap in gaps and gap != 0][:1]


def _assumed(s: Symbol, solution: Expr) -> tuple[Boolean, ...]:
    """Return what the assumptions of a removed symbol say of its value."""
    said: list[sp.Basic] = []
    if s.is_positive:
        said.append(sp.Gt(solution, 0))
    elif s.is_nonnegative:
        said.append(sp.Ge(solution, 0))
    if s.is_negative:
        said.append(sp.Lt(solution, 0))
    elif s.is_nonpositive:
        said.append(sp.Le(solution, 0))
    elif s.is_nonzero:
        said.append(sp.Ne(solution, 0))
    return cast("tuple[Boolean, ...]", tuple(said))
