"""Claims to first order in something small: expansions, and equations linearised about an equilibrium.

"To order n in λ" means that the two sides differ by o(λⁿ) at λ → 0, everything else fixed; where there are several
small quantities, all of them are of one order. The two sides must be quotients of functions analytic at λ = 0.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.judges.energy_and_force import shown_short
from canon.exercise.judges.lagrangian import determined_motions
from canon.exercise.question.answer_values import without_value_on
from canon.exercise.question.deadline import Deadline
from canon.exercise.question.question import (
    Determines,
    Part,
    Question,
    Same,
    SameEquations,
    Stated,
    decide,
    fails,
    more_than_zero,
)
from canon.exercise.question.series_expansion import check_analytic, coefficient, coefficients, without_kinks
from canon.exercise.sheet.sympy_trees import shown
from canon.expression.symbols.symbol import Coordinate, acceleration, velocity
from canon.expression.symbols.user_input import counted
from canon.frozen_mapping import FrozenMapping
from canon.mechanics.algebra.constraint_manifold import transported
from canon.mechanics.algebra.substitution import exchanged, substitute, symbols_of
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.analytic import proved_sign
from canon.proof.domain.domain import Domain
from canon.proof.domain.relations import parts_of
from canon.proof.domain.verdict import Status, Undecided, Verdict, all_hold
from canon.proof.kinks import off_kinks, vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy.logic.boolalg import Boolean

    from canon.exercise.sheet.reading import Reading

__all__ = ["first_order", "linearisation", "small_symbols"]

MOST_ORDERS = 8
_ORDINALS = ("zeroth", "first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth")


def first_order(reading: Reading) -> Iterator[Question]:
    """Both sides have the same expansion in the small quantities, up to the order that is claimed."""
    exact, claimed = reading.expressions("exact"), reading.expressions("claim")
    if not exact:
        reading.fault("exact", "at least one expression is needed")
    if len(exact) != len(claimed):
        reading.fault("claim", f"{counted(len(claimed), 'expression')} for the {len(exact)} under exact")
    order = int(reading.claim.keys.get("order", 1))
    if order != reading.claim.keys.get("order", 1) or not -MOST_ORDERS <= order <= MOST_ORDERS:
        reading.fault("order", f"should be a whole number from -{MOST_ORDERS} to {MOST_ORDERS}")
    small = small_symbols(reading)
    names, deadline = ", ".join(map(str, small)), Deadline.after(0.9 * reading.claim.budget)
    yield from _repeated(exact, claimed, small)
    tied = _tied(small, reading.domain)
    small, domain = [s for s in small if s not in tied], transported(reading.domain, tied)
    said = f"right to {_ordinal(order)} order in {names}"
    verdicts: list[Verdict] = []
    for i, (f, g) in enumerate(zip(exact, claimed, strict=True)):
        name = f"claim {i + 1}, to {_ordinal(order)} order in {names}"
        f, g = substitute(f, tied), substitute(g, tied)
        f, g = map(off_kinks((f, g), domain).seen, (f, g))
        verdict, at = _same_to_order(f, g, small, order, domain, deadline)
        if verdict.fails:
            yield Stated(
                Verdict(
                    Status.FAILS,
                    name,
                    verdict.certificate,
                    verdict.residual,
                    verdict.counterexample,
                    feedback=_where_wrong(at, verdict.residual, names),
                ),
                lambda f=f: _expanded(f, small, order, domain),
            )
            return
        verdicts.append(verdict)
    whole = all_hold(verdicts, said)
    if whole.holds:
        whole = Verdict(
            Status.HOLDS, said, f"exact to {_ordinal(order)} order in {names}", assumed=whole.assumed
        )
    yield Stated(whole)
    exactly = tuple(
        f"claim {i} is no sum of powers of {names}: expand it"
        for i, g in enumerate(claimed, 1)
        if not _is_expanded(g, small)
    )
    yield Determines(lambda: exactly)


def _repeated(exact: Sequence[Expr], claimed: Sequence[Expr], small: Sequence[Symbol]) -> Iterator[Stated]:
    """Yield that an answer says nothing which is what was given, and no expansion of it."""
    if [*exact] == [*claimed] and not all(_is_expanded(g, small) for g in claimed):
        said = "this says nothing: it is what is given, and not expanded"
        yield Stated(fails("the answer is an expansion", said))


def _is_expanded(f: Expr, small: Sequence[Symbol]) -> bool:
    """Whether an expression is a polynomial in what is small, divided perhaps by powers of it."""
    above, below = sp.fraction(sp.together(f))
    factors = [factor.as_base_exp()[0] for factor in sp.Mul.make_args(below)]
    return bool(above.is_polynomial(*small)) and all(
        base in small or not base.has(*small) for base in factors
    )


def linearisation(reading: Reading) -> Iterator[Question]:
    """The place is an equilibrium, and the claimed equations are Lagrange's to first order in q, q̇, q̈ about it.

    What is assumed of coordinates is said of places: a deviation from a place has either sign, so that √(r²) is no r.
    """
    q = reading.symbols("q")
    table, names = reading.table("equilibrium"), {x.name: x for x in q}
    if set(table) != set(names):
        reading.fault("equilibrium", f"should say where each of {', '.join(names)} rests, and nothing else")
    place = {names[name]: value for name, value in table.items()}
    if any(value.has(*q, reading.time) for value in place.values()):
        reading.fault("equilibrium", "should be given by parameters only")
    forces = reading.expressions("Qnc", like="q") if reading.has("Qnc") else None
    equations = Lagrangian(reading.expression("L"), q, forces, reading.time).equations
    moving = tuple(r(x) for x in q for r in (velocity, acceleration))
    given = Domain(tuple(c for c in reading.domain.conditions if not c.has(*moving)), reading.domain.box)
    domain = transported(given, place)  # the place satisfies what is assumed of the coordinates
    _check_real(place, domain)
    rates = [r(x) for x in q for r in (velocity, acceleration)]
    still = {**place, **dict.fromkeys(rates, sp.S.Zero)}
    parts = tuple(
        Part(f"the force on {x} at the equilibrium", substitute(e, still))
        for x, e in zip(q, equations, strict=True)
    )
    at_rest = decide(Same(parts, domain), Deadline.after(reading.claim.budget / 2))
    if at_rest.fails:
        why = "this is no equilibrium: there the equations of motion are not satisfied at rest"
        yield Verdict(
            Status.FAILS, at_rest.question, at_rest.certificate, at_rest.residual, at_rest.counterexample,
            feedback=why,
        )  # fmt: skip
        return
    yield at_rest
    deviation = {x: Coordinate(x.name, real=True) for x in q}
    linear = tuple(exchanged(_linear(e, q, rates, place, domain), deviation) for e in equations)
    free = _of_deviations(reading)
    written = tuple(exchanged(e, deviation) for e in free.equations("claim"))
    unknowns = tuple(acceleration(x) for x in q)
    shown_linear = partial(map, shown_short, linear)
    yield SameEquations(
        written, linear, unknowns, domain, lambda: tuple(shown_linear()), written, time=reading.time
    )
    small = tuple(deviation.values())
    motions = partial(determined_motions, linear, small, domain, reading.time)
    yield from without_value_on(free, "claim", (*small, *rates), motions)
    bends = tuple(
        Part(f"equation {i} beyond first order", e.diff(a, b))
        for i, e in enumerate(written, 1)
        for a, b in combinations_with_replacement((*small, *rates), 2)
    )
    yield Same(bends, domain, None, lambda part: f"{part.name}: a claimed equation is not linear")
    yield more_than_zero(written, domain)


def _of_deviations(reading: Reading) -> Reading:
    """Return the claim with nothing assumed of its coordinates."""
    said = reading.claim.keys.get("parameters", {})
    free = FrozenMapping({name: word for name, word in said.items() if name not in reading.words("q")})
    keys = FrozenMapping({**reading.claim.keys, **({"parameters": free} if said else {})})
    return replace(reading, claim=replace(reading.claim, keys=keys))


def _check_real(place: Mapping[Symbol, Expr], domain: Domain) -> None:
    """Refuse a place such as arccos 2, which is an equilibrium of nothing that is real."""
    values = [value for value in place.values() if not value.is_real]
    points = list(domain.points(symbols_of(*values), 12)) if values else []
    if values and all(any(abs(sp.im(sp.N(exchanged(f, p), 30))) > 1e-9 for f in values) for p in points):
        raise Undecided(
            "no values of the parameters were found for which the place is real; state them in the domain"
        )


def _linear(
    equation: Expr, q: Sequence[Symbol], rates: Sequence[Symbol], place: Mapping[Symbol, Expr], domain: Domain
) -> Expr:
    """Return the terms of first order in the deviations from a place."""
    still = {**place, **dict.fromkeys(rates, sp.S.Zero)}
    equation = without_kinks(equation, still, domain)
    check_analytic(equation, still, domain)
    terms = [substitute(equation.diff(s), still) * s for s in (*q, *rates)]
    if any(term.has(sp.nan, sp.zoo, sp.oo, -sp.oo) for term in terms):
        raise Undecided(
            "the equations have no derivative at the equilibrium, so they are not linearised there"
        )
    return sp.Add(*terms)


def small_symbols(reading: Reading) -> list[Symbol]:
    """Return the symbols of what is small, which are declared among the parameters."""
    names = reading.claim.keys["small"]
    found: list[Symbol] = []
    for name in names if isinstance(names, list) else [names]:
        symbol = reading.scope.symbol(name)
        if symbol is None or symbol == reading.time:
            reading.fault("small", f"{name} is not declared; {reading.scope.near(name)}")
        found.append(symbol)
    return found


def _same_to_order(
    f: Expr, g: Expr, small: Sequence[Symbol], order: int, domain: Domain, deadline: Deadline
) -> tuple[Verdict, int]:
    """Tell whether f − g = o(εⁿ), and at which order it fails first."""
    epsilon = sp.Dummy("epsilon", real=True)
    forgotten = [c for c in parts_of(domain.conditions) if _is_forgotten(c, small)]
    domain = _domain_near(small, domain)
    above, below = _quotient(f - g, small, epsilon, domain)
    start, lowest = _order_of(below, epsilon, domain, deadline)
    verdicts: list[Verdict] = []
    highest = order + start
    for k, found in enumerate(coefficients(above, epsilon, highest) if highest >= 0 else ()):
        verdict = vanishes_off_kinks(found, domain, budget=deadline.left)
        if verdict.fails and forgotten:
            raise Undecided(f"what {forgotten[0]} says of the rest was not used; write it without {small[0]}")
        if verdict.fails:
            left = shown_short(found / lowest * _power_of(small, k - start))
            return Verdict(
                Status.FAILS, "", verdict.certificate, left, verdict.counterexample, verdict.assumed
            ), k - start
        verdicts.append(verdict)
    return all_hold(verdicts), order


def _tied(small: Sequence[Symbol], domain: Domain) -> dict[Symbol, Expr]:
    """Return the values that equalities with something small in them give to symbols, as b = ε a to b.

    A value is analytic where all that is small is zero, so that what is o(εⁿ) is so in whichever of these symbols the
    rest is written. One small quantity is tied to others only by what is homogeneous of first degree, which becomes
    ε times itself where each of them does.

    Raises
    ------
    Undecided
        Where an equality gives no such value: what is fixed while ε goes to zero is not known then.
    """
    found: dict[Symbol, Expr] = {}
    equalities = [c for c in parts_of(domain.conditions) if isinstance(c, sp.Eq)]
    ties = [cast("Expr", c.lhs) - cast("Expr", c.rhs) for c in equalities]
    while any(tie.has(*small) for tie in ties):
        tie = next(tie for tie in ties if tie.has(*small))
        step = _value_near(tie, small, domain)
        if step is None:
            raise Undecided(
                f"{tie} = 0 in the domain ties what is small to the rest; write one of its symbols by the others"
            )
        found = {s: substitute(value, step) for s, value in found.items()} | step
        ties = [other for other in (substitute(t, step) for t in ties if t is not tie) if other != 0]
    if found and all(s in found for s in small):
        raise Undecided("the domain keeps what is small at one value; leave that condition out")
    return found


def _value_near(gap: Expr, small: Sequence[Symbol], domain: Domain) -> dict[Symbol, Expr] | None:
    """Return the value that an equation, linear in a symbol, gives to it, where it does so at ε = 0 too."""
    scale, zero = sp.Dummy("scale", positive=True), dict.fromkeys(small, sp.S.Zero)
    homogeneous = sp.expand(substitute(gap, {s: scale * s for s in small}) - scale * gap) == 0
    for s in sorted(symbols_of(gap), key=lambda s: (s in small, str(s))):
        slope = gap.diff(s)
        if slope.has(s) or s.is_integer or (s in small and not (homogeneous and not slope.has(*small))):
            continue
        there = substitute(slope, zero)
        if there.is_nonzero or proved_sign(there, domain) in ("+", "-"):
            return {s: sp.cancel(s - gap / slope)}
    return None


def _domain_near(small: Sequence[Symbol], domain: Domain) -> Domain:
    """Return the domain of the others where what is small goes to zero: a > λ leaves a ≥ 0."""
    conditions: list[Boolean] = []
    for c in parts_of(domain.conditions):
        if not c.has(*small):
            conditions.append(c)
        elif isinstance(c, sp.Gt | sp.Lt | sp.Ge | sp.Le):
            gap = substitute(_gap_of(c), dict.fromkeys(small, sp.S.Zero))
            conditions.append(sp.Ge(gap, 0))
    if sp.false in conditions:
        raise Undecided(
            f"the domain keeps {', '.join(map(str, small))} away from zero, "
            "where the claim is made; leave that condition out"
        )
    return Domain(tuple(c for c in conditions if c is not sp.true), domain.box)


def _gap_of(bound: sp.Gt | sp.Lt | sp.Ge | sp.Le) -> Expr:
    return cast("Expr", bound.gts) - cast("Expr", bound.lts)


def _is_forgotten(condition: Boolean, small: Sequence[Symbol]) -> bool:
    """Whether nothing is left of a condition on more than what is small where that is zero, as of ε a > 0."""
    if not condition.has(*small) or isinstance(condition, sp.Eq | sp.Ne):
        return False
    gap = _gap_of(cast("sp.Gt", condition))
    if substitute(gap, dict.fromkeys(small, sp.S.Zero)) != 0:
        return False
    open_ = [factor for factor in sp.Mul.make_args(sp.factor(gap)) if not factor.is_positive]
    return not sp.Mul(*open_).free_symbols <= {*small}


def _power_of(small: Sequence[Symbol], k: int) -> Expr:
    """Return λᵏ for one small quantity; for several the coefficient shows the powers itself."""
    return small[0] ** k if len(small) == 1 else sp.S.One


def _quotient(f: Expr, small: Sequence[Symbol], epsilon: Symbol, domain: Domain) -> tuple[Expr, Expr]:
    """Return numerator and denominator, both analytic at ε = 0, of f with every small quantity s as ε s."""
    size = {s: epsilon * (s if len(small) > 1 else 1) for s in small}
    scaled = without_kinks(substitute(f, size), {epsilon: sp.S.Zero}, domain)
    above, below = sp.fraction(sp.together(scaled)) if _singular(scaled, epsilon) else (scaled, sp.S.One)
    for side in (above, below):
        check_analytic(side, {epsilon: sp.S.Zero}, domain)
    return above, below


def _singular(f: Expr, epsilon: Symbol) -> bool:
    return any(
        substitute(part.base, {epsilon: sp.S.Zero}) == 0
        for part in f.atoms(sp.Pow)
        if part.exp.is_negative and part.has(epsilon)
    ) or bool(f.has(sp.tan, sp.cot, sp.sec, sp.csc))


def _order_of(f: Expr, epsilon: Symbol, domain: Domain, deadline: Deadline) -> tuple[int, Expr]:
    """Return the lowest order of f at ε = 0, and its coefficient."""
    for k in range(MOST_ORDERS + 1):
        found = coefficient(f, epsilon, k)
        verdict = vanishes_off_kinks(found, domain, budget=deadline.left)
        if verdict.fails:
            return k, found
        if verdict.undecided:
            break
    raise Undecided(
        "the order of a denominator in the small quantity was not decided; say the signs of the parameters"
    )


def _expanded(f: Expr, small: Sequence[Symbol], order: int, domain: Domain) -> Expr | None:
    """Return the expansion up to an order, where f itself is analytic."""
    epsilon = sp.Dummy("epsilon", real=True)
    above, below = _quotient(f, small, epsilon, domain)
    if below != 1:
        start, _ = _order_of(below, epsilon, domain, Deadline.after(1.0))
        regular = sp.series(above / below * epsilon**start, epsilon, 0, order + start + 1).removeO()
        above = sp.expand(regular / epsilon**start)
        return shown_short(substitute(above, {epsilon: small[0] if len(small) == 1 else sp.S.One}))
    terms = (c * _power_of(small, k) for k, c in enumerate(coefficients(above, epsilon, order)))
    return sp.Add(*map(shown_short, terms))


def _where_wrong(at: int, residual: object, names: str) -> str:
    known = f"right to {_ordinal(at - 1)} order in {names} only; " if at - 1 >= 0 else ""
    return (
        f"{known}the terms of {_ordinal(at)} order are wrong: exact less claimed is {shown(residual)} there"
    )


def _ordinal(order: int) -> str:
    return _ORDINALS[order] if 0 <= order < len(_ORDINALS) else f"({order})th"
