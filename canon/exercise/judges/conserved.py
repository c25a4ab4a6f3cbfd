"""Claims about which quantities are conserved and which are not, the explicit time included."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.judges.energy_and_force import shown_short
from canon.exercise.judges.lagrangian import determined_motions
from canon.exercise.question.answer_values import without_value_on
from canon.exercise.question.continuous_answer import constants_are_continuous
from canon.exercise.question.deadline import SIDE_SECONDS
from canon.exercise.question.jumping_system import check_kept_at_jumps
from canon.exercise.question.question import Differ, Part, Question, Same, Tells
from canon.expression.symbols.symbol import acceleration, velocity
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.domain.verdict import Undecided
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain
    from canon.proof.domain.verdict import Verdict

__all__ = [
    "NOT_OF_THE_STATE",
    "conserved_or_not",
    "mechanical_system",
    "motion_of",
    "rate_along",
    "same_everywhere",
    "system_of",
    "valued_on_motions",
]

NOT_OF_THE_STATE = "what does not depend on the state is true of any system"


def conserved_or_not(reading: Reading) -> Iterator[Question]:
    """dI/dt = Σ ∂I/∂x ẋ + ∂I/∂t vanishes for the one list and does not vanish identically for the other."""
    rates, t = motion_of(reading), reading.time
    rate_of, state, system = rate_along(rates, t), (*rates, t), mechanical_system(reading)
    for key in ("conserved", "not_conserved"):
        if not reading.has(key):
            continue
        quantities = reading.expressions(key)
        for i, I in enumerate(quantities):
            if I.has(*(s for s in _accelerations(reading) if s not in rates)):
                reading.fault(f"{key}[{i}]", "should depend on the state and the time only")
            (rate,) = rate_of(I)
            if key == "conserved":
                yield Same((Part(f"d/dt ({I})", rate),), reading.domain, said=_not_conserved)
                check_kept_at_jumps(I, system, reading.domain)
                yield from constants_are_continuous(I, state, reading.domain, system_of(reading))
            else:
                _check_continuous(I, state, reading.domain)
                if vanishes_off_kinks(rate, reading.domain, SIDE_SECONDS).holds:
                    check_kept_at_jumps(I, system, reading.domain)
                why = f"{I} is conserved: its rate vanishes on every motion"
                yield Differ(Part(f"d/dt ({I})", rate), reading.domain, why)
        yield from valued_on_motions(reading, key)
        yield Tells((same_everywhere(quantities, tuple(rates), reading.domain),), NOT_OF_THE_STATE)


def rate_along(rates: Mapping[Symbol, Expr], t: Symbol) -> Callable[[Expr], tuple[Expr]]:
    """Return what gives the rate df/dt = Σ ∂f/∂x ẋ + ∂f/∂t of a function of the state, alone in a tuple."""

    def rate_of(f: Expr) -> tuple[Expr]:
        return (sp.Add(*(f.diff(x) * value for x, value in rates.items()), f.diff(t)),)

    return rate_of


def same_everywhere(
    quantities: Sequence[Expr],
    state: Sequence[Symbol],
    domain: Domain,
    values: Mapping[Symbol, Expr] = MappingProxyType({}),
) -> Same:
    """Return the question whether quantities do not depend on the state at all, where some symbols have values."""
    slopes = ((I, x, I.diff(x)) for I in quantities for x in state)
    parts = tuple(Part(f"∂({I})/∂{x}", slope, through=values) for I, x, slope in slopes if slope != 0)
    return Same(parts or (Part("0", sp.S.Zero),), domain)


def _check_continuous(I: Expr, state: Sequence[Symbol], domain: Domain) -> None:
    """Refuse quantities such as |x|/x, whose rate vanishes where it exists and which jump all the same.

    Raises
    ------
    Undecided
        Where the quantity may jump.
    """
    if not all(verdict.holds for verdict in constants_are_continuous(I, state, domain)):
        raise Undecided(f"{I} may jump, which its rate does not show; narrow the domain to where it does not")


def system_of(reading: Reading) -> tuple[Expr, ...]:
    """Return the function that gives a system, H or L; a motion is continuous where the components of X jump."""
    return tuple(reading.expression(key) for key in ("H", "L") if reading.has(key))[:1]


def mechanical_system(reading: Reading) -> Hamiltonian | Lagrangian | None:
    """Return the system that H or L gives with its forces; None where a vector field or equations are given."""
    if reading.has("H"):
        q, p = reading.phase_space("q", "p")
        return Hamiltonian(reading.expression("H"), q, p, reading.time)
    if reading.has("L"):
        q = reading.symbols("q")
        forces = reading.expressions("Qnc", like="q") if reading.has("Qnc") else None
        return Lagrangian(reading.expression("L"), q, forces, reading.time)
    return None


def valued_on_motions(reading: Reading, key: str) -> Iterator[Verdict]:
    """Yield what speaks against answers in the state having a value on the motions, for rates that cancel in them."""
    system = mechanical_system(reading)
    if system is None:
        return
    bound = _accelerations(reading) if isinstance(system, Hamiltonian) else [*map(acceleration, system.q)]
    yield from without_value_on(reading, key, bound, lambda: _rates_on_motions(system, reading.domain))


def _rates_on_motions(
    system: Hamiltonian | Lagrangian, domain: Domain
) -> Iterator[tuple[Mapping[Symbol, Expr], Domain]]:
    """Yield the rates that are no state variables, in terms of these, and where."""
    if isinstance(system, Lagrangian):
        yield from determined_motions(system.equations, system.q, domain, system.t)
        return
    field = dict(zip((*system.q, *system.p), system.vector_field, strict=True))
    rate_of = rate_along(field, system.t)
    first = {velocity(x): field[x] for x in system.q}
    yield {**first, **{acceleration(x): rate_of(field[x])[0] for x in system.q}}, domain


def motion_of(reading: Reading) -> dict[Symbol, Expr]:
    """Return the rate of each state variable of a system given by H, L or X."""
    system = mechanical_system(reading)
    if isinstance(system, Hamiltonian):
        return dict(zip((*system.q, *system.p), system.vector_field, strict=True))
    if isinstance(system, Lagrangian):
        rates: dict[Symbol, Expr] = {x: velocity(x) for x in system.q}
        return rates | dict(zip(system.velocities, system.accelerations, strict=True))
    if not reading.has("X"):
        reading.fault("L", "missing; give q with L, q and p with H, or x with X")
    return dict(zip(reading.symbols("x"), reading.expressions("X", like="x"), strict=True))


def _accelerations(reading: Reading) -> list[Symbol]:
    """Return what no state variable is: the accelerations, and in phase space the velocities too."""
    q = reading.symbols("q")
    return [f(x) for x in q for f in (velocity, acceleration)]


def _not_conserved(part: Part) -> str:
    return f"not conserved: on the motion {part.name} = {shown_short(part.claimed)}"
