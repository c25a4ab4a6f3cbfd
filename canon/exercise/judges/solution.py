"""Claims about solutions of equations of motion.

A solution is given as functions of the time, or as velocities from which it follows by quadrature.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.judges.conserved import mechanical_system, motion_of
from canon.exercise.judges.energy_and_force import shown_short
from canon.exercise.judges.invariance import is_instead
from canon.exercise.question.answer import stay_open
from canon.exercise.question.answer_values import without_value_on
from canon.exercise.question.continuous_answer import is_continuous
from canon.exercise.question.jumping_system import check_has_no_jumps, check_motion_at_jumps
from canon.exercise.question.question import Determines, Part, Question, Regular, Same, fails
from canon.expression.symbols.symbol import Rate, acceleration, time_derivative, velocity
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.constraint_manifold import transported
from canon.mechanics.algebra.linear import is_regular
from canon.mechanics.algebra.possible_motion import motion_is_continuous, motion_is_real, real_somewhere
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.analytic import proved_sign
from canon.proof.continuity.smooth import PIECED
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Undecided, Verdict

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from canon.exercise.sheet.reading import Reading

__all__ = ["solution"]


def solution(reading: Reading) -> Iterator[Question]:
    """The claimed motion satisfies the equations and the initial values, and is general if constants are named."""
    if reading.has("solution") and reading.has("rates"):
        reading.fault("rates", "give solution or rates, not both")
    if reading.has("equations") and not reading.has("q"):
        reading.fault("equations", "are in the coordinates q; declare them")
    yield from _of_functions(reading) if reading.has("solution") else _of_rates(reading)


def _of_functions(reading: Reading) -> Iterator[Question]:
    """x = x(t): put into the equations it satisfies them."""
    t, state = reading.time, _state(reading)
    variables = tuple(x for x in state if x not in state.values())
    table = _table(reading, "solution", variables)
    for x, value in table.items():
        if value.has(*_ordered(state)) or value.atoms(Rate):
            reading.fault(f"solution.{x}", f"should depend on {t}, parameters and constants only")
    yield from motion_is_real(table, reading.domain)
    laws = _laws(reading)
    bound = _velocities_are_continuous(reading, laws, table)
    yield from motion_is_continuous(table, transported(reading.domain, table), laws, t, velocities=bound)
    motion: dict[Symbol, Expr] = {}
    for x, value in table.items():
        _check_smooth(value, t, reading.domain)
        motion[x] = value
        if _second_order(reading):
            motion |= {velocity(x): value.diff(t), acceleration(x): value.diff(t, 2)}
    domain = transported(reading.domain, motion)
    parts = tuple(Part(name, substitute(e, motion)) for name, e in _equations(reading, motion))
    yield Same(parts, domain, _no_answer, _left_over)
    yield from without_value_on(reading, "solution", tuple(motion), lambda: [(motion, domain)])
    if not reading.has("equations"):
        check_motion_at_jumps(motion, mechanical_system(reading), domain, reading.domain)
    yield from _initial(reading, {x: motion[x] for x in state if x in motion}, t)
    if reading.has("constants"):
        values = [motion[x] for x in _ordered(state)]
        yield from _general(reading, values, domain)
    else:
        yield Determines(lambda: _not_fixed(reading, _ordered(state)))


def _velocities_are_continuous(reading: Reading, laws: Sequence[Expr], table: Mapping[Symbol, Expr]) -> bool:
    """Tell whether the equations leave no place for a velocity that jumps: they do where they have jumps themselves."""
    if any(law.has(*map(acceleration, table)) for law in laws):
        return True
    return _second_order(reading) and not any(law.has(*PIECED) for law in laws)


def _laws(reading: Reading) -> list[Expr]:
    """Return what the equations of motion are made of, in terms of the state."""
    if _second_order(reading):
        return [e for _, e in _equations(reading, {})]
    return list(motion_of(reading).values())


def _check_smooth(value: Expr, t: Symbol, domain: Domain) -> None:
    """Refuse roots with a kink, such as √(t² − 2t + 1): beside it they may satisfy equations, at it they do not.

    Of moduli and pieces it is asked before whether the motion and its velocity are continuous.
    """
    for part in sp.preorder_traversal(value):
        if (
            isinstance(part, sp.Pow)
            and part.exp.is_integer is not True
            and _touches_zero(part.base, t, domain)
        ):
            raise Undecided(f"{part} may have a kink, where no motion satisfies equations; narrow the domain")


def _touches_zero(base: Expr, t: Symbol, domain: Domain) -> bool:
    """Whether a radicand may come down to zero and rise again, as 1 − cos t does."""
    if not base.has(t) or (sign := proved_sign(base, domain)) == "+":
        return False
    try:
        factors = sp.Poly(base, *base.free_symbols, domain="QQ").factor_list()[1]
    except sp.PolynomialError:
        return sign != ""
    return any(count > 1 and factor.has(t) for factor, count in factors)


def _of_rates(reading: Reading) -> Iterator[Question]:
    """ẋ = r(x, t): every motion with these velocities satisfies the equations; x(t) follows by quadrature."""
    if not _second_order(reading):
        reading.fault("rates", "belong to equations of second order; give q with L, or q with equations")
    q, t = reading.symbols("q"), reading.time
    v = tuple(velocity(x) for x in q)
    rates = _table(reading, "rates", q)
    for x, value in rates.items():
        if value.has(*v, *(acceleration(y) for y in q)):
            reading.fault(f"rates.{x}", "should depend on coordinates, time, parameters and constants only")
    yield from motion_is_real({velocity(x): r for x, r in rates.items()}, reading.domain)
    motion: dict[Symbol, Expr] = {velocity(x): r for x, r in rates.items()}
    motion |= {acceleration(x): substitute(time_derivative(r, q, t), motion) for x, r in rates.items()}
    domain = transported(reading.domain, motion)
    parts = tuple(Part(name, substitute(e, motion)) for name, e in _equations(reading, motion))
    yield Same(parts, domain, _no_answer, _left_over)
    yield from without_value_on(reading, "rates", tuple(motion), lambda: [(motion, domain)])
    if not reading.has("equations"):
        check_has_no_jumps(mechanical_system(reading), reading.domain)
    for x, rate in rates.items():
        yield is_continuous(rate, (*q, t), domain, f"{velocity(x)} = {rate}")
    if reading.has("initial"):
        yield from _initial_rates(reading, q, rates)
    if reading.has("constants"):
        yield from _general(reading, [rates[x] for x in q], domain)
    else:
        yield Determines(lambda: _not_fixed(reading, [*q, *v]))


def _not_fixed(reading: Reading, state: Sequence[Symbol]) -> tuple[str, ...]:
    """Return what is open of a motion that is one of many, unless its initial values are given."""
    needed = _of_the_order(reading, state) if _second_order(reading) else state
    given = reading.table("initial") if reading.has("initial") else {}
    lacking = [str(x) for x in needed if str(x) not in given]
    if len(lacking) == len(needed):
        return (f"this is one motion of many: {counted(len(needed), 'constant')} of integration stay open",)
    return stay_open([f"the initial value of {name}" for name in lacking])


def _second_order(reading: Reading) -> bool:
    return reading.has("q") and not reading.has("H")


def _state(reading: Reading) -> Mapping[Symbol, Expr]:
    """Return the rate of each state variable; of accelerations nothing is known where equations are given."""
    if _second_order(reading):
        return {x: velocity(x) for x in reading.symbols("q")}
    return dict.fromkeys(motion_of(reading), sp.S.Zero)


def _ordered(state: Mapping[Symbol, Expr]) -> list[Symbol]:
    rates = [v for v in state.values() if isinstance(v, Symbol)]
    return [*state, *rates]


def _equations(reading: Reading, motion: Mapping[Symbol, Expr]) -> list[tuple[str, Expr]]:
    """Return what should vanish on the motion."""
    if reading.has("equations"):
        return [(f"equation {i + 1}", e) for i, e in enumerate(reading.equations("equations"))]
    if _second_order(reading):
        q = reading.symbols("q")
        forces = reading.expressions("Qnc", like="q") if reading.has("Qnc") else None
        if not reading.has("L"):
            reading.fault("L", "missing; give L, or equations")
        lagrangian = Lagrangian(reading.expression("L"), q, forces, reading.time)
        return [(f"the equation of {x}", e) for x, e in zip(q, lagrangian.equations, strict=True)]
    t = reading.time
    return [(f"the equation of {x}", motion[x].diff(t) - rate) for x, rate in motion_of(reading).items()]


def _table(reading: Reading, key: str, variables: Sequence[Symbol]) -> dict[Symbol, Expr]:
    table, names = reading.table(key), {x.name: x for x in variables}
    if set(table) != set(names):
        reading.fault(key, f"should say what each of {', '.join(names)} is, and nothing else")
    return {names[name]: value for name, value in table.items()}


def _initial(reading: Reading, motion: Mapping[Symbol, Expr], t: Symbol) -> Iterator[Question]:
    """The motion starts where the claim says."""
    if not reading.has("initial"):
        return
    start = reading.expression("t0", sp.S.Zero)
    known = dict(motion)
    if _second_order(reading):
        known |= {velocity(x): value.diff(t) for x, value in motion.items()}
    parts: list[Part] = []
    for name, wanted in reading.table("initial").items():
        symbol = reading.scope.symbol(name)
        if symbol is None or symbol not in known:
            reading.fault(f"initial.{name}", f"should be one of {', '.join(map(str, known))}")
        there = substitute(known[symbol], {t: start})
        if there.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
            raise Undecided(
                f"{symbol} at {t} = {start} is a limit, which is not taken; claim the solution at another time"
            )
        parts.append(Part(f"{name} at {t} = {start}", there, wanted))
    yield Same(tuple(parts), reading.domain, _no_answer, is_instead)


def _left_over(part: Part) -> str:
    return f"the motion does not satisfy {part.name}: {shown_short(part.claimed)} is left over"


def _no_answer() -> None:
    """Return nothing: equations of motion have many solutions, and not all in closed form."""


def _initial_rates(reading: Reading, q: Sequence[Symbol], rates: Mapping[Symbol, Expr]) -> Iterator[Question]:
    """The motion starts with real velocities, and with those that the claim says."""
    table = reading.table("initial")
    names = {s.name for x in q for s in (x, velocity(x))}
    if not set(table) <= names:
        reading.fault("initial", f"should give values of {', '.join(sorted(names))}")
    start = {x: table[x.name] for x in q if x.name in table}
    start[reading.time] = reading.expression("t0", sp.S.Zero)
    parts: list[Part] = []
    for x in q:
        name = velocity(x).name
        there = substitute(rates[x], start)
        if name in table and there.has(*q, sp.nan, sp.zoo):
            reading.fault("initial", "should give the place of every coordinate that the rate depends on")
        yield from _starts(name, there, q, start, reading.domain)
        if name in table:
            parts.append(Part(f"{name} at the start", there, table[name]))
    if parts:
        yield Same(tuple(parts), reading.domain, _no_answer, is_instead)


def _starts(
    name: str, there: Expr, q: Sequence[Symbol], start: Mapping[Symbol, Expr], domain: Domain
) -> Iterator[Verdict]:
    """Yield whether a rate has a real value at the start; nothing where the start is not said.

    Raises
    ------
    Undecided
        Where the value is a limit.
    """
    if there.has(*q):
        return
    if there in (sp.zoo, sp.oo, -sp.oo):
        yield fails("the motion starts", f"{name} has no value at the start: no motion starts there")
        return
    if there.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
        raise Undecided(f"{name} at the start is a limit, which is not taken; start elsewhere")
    beside = Domain(tuple(c for c in domain.conditions if not c.has(*start)), domain.box)
    verdict = real_somewhere([there], beside, "the motion starts")
    said = f"{name} = {there} at the start"
    if verdict.fails:
        verdict = replace(verdict, feedback=f"{said} is not real: no motion starts there")
    yield replace(verdict, assumed=(f"{said} is claimed where it is real",)) if verdict.assumed else verdict


def _general(reading: Reading, values: Sequence[Expr], domain: Domain) -> Iterator[Question]:
    """As many constants as the state has variables, and the state depends regularly on them."""
    constants = reading.symbols("constants")
    foreign = [c for c in constants if any(f.has(c) for f in _given(reading))]
    if foreign:
        why = f"{foreign[0]} stands in the equations; it is no constant of integration"
        yield fails("the constants of integration", why)
        return
    if _second_order(reading):
        values = _of_the_order(reading, values)
    if len(constants) != len(values):
        why = f"the general solution has {counted(len(values), 'constant')}, not {len(constants)}"
        yield fails("the number of constants", why)
        return
    yield Regular(
        sp.Matrix([[value.diff(c) for c in constants] for value in values]),
        "the derivatives by the constants",
        domain,
        "the constants are not independent: the solution is not general",
    )


def _of_the_order(reading: Reading, values: Sequence[Expr]) -> Sequence[Expr]:
    """Return the part of the state that the equations leave free: positions only, where they are of first order."""
    q, equations = reading.symbols("q"), [e for _, e in _equations(reading, {})]
    second = [x for x in q if any(e.has(acceleration(x)) for e in equations)]
    highest = [(acceleration if second else velocity)(x) for x in q]
    slopes = sp.Matrix([[e.diff(u) for u in highest] for e in equations])
    square = len(equations) == len(q) and second in ([], list(q)) and not slopes.has(*highest)
    if not square or not is_regular(slopes, reading.domain).holds:
        raise Undecided(
            "how many constants the general solution of these equations has was not decided; "
            "solve them for the highest derivatives"
        )
    return values if second else values[: len(q)]


def _given(reading: Reading) -> Iterator[Expr]:
    """Yield what the equations of motion are made of."""
    for key in ("L", "H"):
        if reading.has(key):
            yield reading.expression(key)
    for key in ("X", "Qnc"):
        if reading.has(key):
            yield from reading.expressions(key)
    if reading.has("equations"):
        yield from reading.equations("equations")
