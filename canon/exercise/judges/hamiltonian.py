"""Claims about Hamiltonians, Hamilton's equations and constants of the motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.exercise.judges.conserved import (
    NOT_OF_THE_STATE,
    mechanical_system,
    rate_along,
    same_everywhere,
    system_of,
    valued_on_motions,
)
from canon.exercise.judges.lagrangian import lagrangian_of
from canon.exercise.question.answer import stay_open
from canon.exercise.question.answer_values import without_value_on
from canon.exercise.question.continuous_answer import constants_are_continuous
from canon.exercise.question.jumping_system import check_kept_at_jumps, check_motion_at_jumps
from canon.exercise.question.question import Determines, Part, Question, Regular, Same, Tells, wrong_variables
from canon.expression.symbols.symbol import Rate, acceleration, velocity
from canon.mechanics.algebra.constraint_manifold import Branch, on_manifold, transported
from canon.mechanics.algebra.possible_motion import motion_is_continuous, motion_is_real
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.hamilton.legendre import where_root_is_real
from canon.mechanics.hamilton.legendre_pair import hamiltonian
from canon.mechanics.lagrange.hidden_constraints import Motions, motions_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy import Expr, Symbol

    from canon.exercise.sheet.reading import Reading

__all__ = ["constant_of_motion", "equality", "hamilton_equations", "legendre_hamiltonian"]


def legendre_hamiltonian(reading: Reading) -> Iterator[Question]:
    """The velocity Hessian is regular and H(q, ∂L/∂q̇, t) = Σ p q̇ − L."""
    _, p = reading.phase_space("q", "p")
    lagrangian = lagrangian_of(reading)
    domain = where_root_is_real(lagrangian.L, lagrangian.velocities, reading.domain)
    yield Regular(lagrangian.mass_matrix, "the velocity Hessian", domain, exceptions=True)
    if reading.has("H"):
        yield from wrong_variables(reading.expression("H"), lagrangian.velocities, "H", "q, p and t")
        through = dict(zip(p, lagrangian.momenta, strict=True))
        part = Part("H", reading.expression("H"), lagrangian.jacobi_energy, through, "H")
        yield Same((part,), transported(domain, through), lambda: hamiltonian(lagrangian, p, domain).H)
    else:
        yield Determines(lambda: stay_open(["H"]))


def hamilton_equations(reading: Reading) -> Iterator[Question]:
    """q̇ = ∂H/∂p and ṗ = −∂H/∂q as claimed, or solved by the claimed functions of time."""
    q, p = reading.phase_space("q", "p")
    system = Hamiltonian(reading.expression("H"), q, p, reading.time)
    if reading.has("q_dot"):
        claimed = (*reading.expressions("q_dot", like="q"), *reading.expressions("p_dot", like="p"))
        motion = [rate(x) for x in q for rate in (velocity, acceleration)]
        for z, rate in zip((*q, *p), claimed, strict=True):
            yield from wrong_variables(rate, motion, f"d{z}/dt", "q, p and t")
        keys = [f"{key}[{i}]" for key in ("q_dot", "p_dot") for i in range(len(q))]
        parts = tuple(
            Part(f"d{z}/dt", rate, right, key=key)
            for z, rate, right, key in zip((*q, *p), claimed, system.vector_field, keys, strict=True)
        )
        yield Same(parts, reading.domain, lambda: system.vector_field)
        for key in ("q_dot", "p_dot"):
            yield from valued_on_motions(reading, key)
    if reading.has("solution"):
        yield from _solution(reading, system)


def _solution(reading: Reading, system: Hamiltonian) -> Iterator[Question]:
    table, names = reading.table("solution"), {z.name: z for z in (*system.q, *system.p)}
    if set(table) != set(names):
        reading.fault("solution", f"should say what each of {', '.join(names)} is, and nothing else")
    motion = {names[name]: value for name, value in table.items()}
    for z, value in motion.items():
        if value.has(*motion) or value.atoms(Rate):
            reading.fault(f"solution.{z}", f"should depend on {system.t} and parameters only")
    yield from motion_is_real(motion, reading.domain)
    domain = transported(reading.domain, motion)
    rates = zip((*system.q, *system.p), system.vector_field, strict=True)
    parts = (
        Part(f"the equation of {z}", motion[z].diff(system.t), substitute(rate, motion)) for z, rate in rates
    )
    yield Same(tuple(parts), domain)
    known = {**motion, **{velocity(x): motion[x].diff(system.t) for x in system.q}}
    yield from without_value_on(reading, "solution", tuple(known), lambda: [(known, domain)])
    check_motion_at_jumps(motion, system, domain, reading.domain)
    yield from motion_is_continuous(motion, domain, [system.H], system.t, velocities=False)


def constant_of_motion(reading: Reading) -> Iterator[Question]:
    """dI/dt = Σ ∂I/∂x ẋ + ∂I/∂t vanishes, where the restrictions do."""
    I, t = reading.expression("I"), reading.time
    rates, motions = _rates(reading, I)
    rate_of, system = rate_along(rates, t), mechanical_system(reading)
    restrictions = reading.equations("restrict") if reading.has("restrict") else ()
    branches = _restricted(restrictions, motions)
    for branch in branches:
        there = substitute(I, branch.values)
        yield Same((Part("dI/dt", *rate_of(I), through=branch.values),), branch.domain)
        check_kept_at_jumps(there, system, branch.domain)
        yield from constants_are_continuous(there, (*rates, t), branch.domain, system_of(reading))
    yield from valued_on_motions(reading, "I")
    moved = _moved_in_any_way(reading) if restrictions else {}
    alone = _restricted(restrictions, _any_motions(reading)) if moved else []
    trivial = (
        tuple(Same((Part("dI/dt", *rate_along(moved, t)(I), through=b.values),), b.domain) for b in alone)
        if moved
        else tuple(same_everywhere((I,), tuple(rates), b.domain, b.values) for b in branches)
    )
    yield Tells(trivial, "it follows from `restrict` alone" if restrictions else NOT_OF_THE_STATE)
    if motions.through:
        seen = tuple(same_everywhere((substitute(I, b.values),), tuple(rates), b.domain) for b in branches)
        yield Tells(seen, "it is the same number on every motion")


def _restricted(restrictions: Sequence[Expr], motions: Motions) -> list[Branch]:
    """Return the states of motions at which restrictions hold, with the rates there of what is bound."""
    here = [substitute(f, motions.through) for f in restrictions]
    branches = on_manifold(here, motions.branch.domain)
    return [
        Branch({s: substitute(f, b.values) for s, f in motions.through.items()} | dict(b.values), b.domain)
        for b in branches
    ]


def _any_motions(reading: Reading) -> Motions:
    return Motions(Branch({}, reading.domain), {})


def _moved_in_any_way(reading: Reading) -> dict[Symbol, Expr]:
    """Return the rates of coordinates and velocities whatever moves them; none where no Lagrangian is given.

    Where ẋ = 0, d(x³)/dt = 3 x² ẋ vanishes in any system: only what takes the accelerations of this one says something.
    """
    q = reading.symbols("q") if reading.has("L") else ()
    return {s: rate(x) for x in q for s, rate in ((x, velocity), (velocity(x), acceleration))}


def equality(reading: Reading) -> Iterator[Question]:
    """Both sides are equal on the whole domain."""
    lhs, rhs = reading.expression("lhs"), reading.expression("rhs")
    yield Same((Part("lhs", lhs, rhs, key="lhs"),), reading.domain)


def _rates(reading: Reading, I: Expr) -> tuple[dict[Symbol, Expr], Motions]:
    """Return the rate of each variable, and what binds them: equations of first order have no rates that are free."""
    free = _any_motions(reading)
    if reading.has("H"):
        q, p = reading.phase_space("q", "p")
        system = Hamiltonian(reading.expression("H"), q, p, reading.time)
        return dict(zip((*q, *p), system.vector_field, strict=True)), free
    if not reading.has("L"):
        return dict(zip(reading.symbols("x"), reading.expressions("X", like="x"), strict=True)), free
    lagrangian = lagrangian_of(reading)
    accelerations = tuple(acceleration(x) for x in lagrangian.q)
    if I.has(*accelerations):
        reading.fault("I", "should depend on coordinates, velocities and time only")
    motions = motions_of(lagrangian, reading.domain)
    rates: dict[Symbol, Expr] = dict(zip(lagrangian.q, lagrangian.velocities, strict=True))
    if motions.branch.values or len(motions.solution) < len(accelerations):  # put in afterwards
        return rates | dict(zip(lagrangian.velocities, accelerations, strict=True)), motions
    found = (motions.solution[a] for a in accelerations)
    return rates | dict(zip(lagrangian.velocities, found, strict=True)), free
