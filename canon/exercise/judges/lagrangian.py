"""Claims about Lagrange's equations: free, damped, reduced by Routh, equivalent Lagrangians; Appell's equations.

For the Gibbs–Appell function: S = Σ ½ m a² + ½ I α² over the bodies; ∂S/∂u̇ⱼ = Σ (Qᵢ − ∂V/∂qᵢ) ∂q̇ᵢ/∂uⱼ (P. Appell,
J. reine angew. Math. 121 (1900) 310). A rotor with ``omega`` as a list of three has them along axes fixed in it, where
Euler's gyroscopic terms join in: the torque is I ω̇ + ω × I ω, so that of principal axes I₁ω̇₁ + (I₃ − I₂)ω₂ω₃.
"""

from __future__ import annotations

from contextlib import suppress
from itertools import combinations
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.question.answer import stay_open
from canon.exercise.question.answer_values import what_may_vanish, without_value_on
from canon.exercise.question.continuous_answer import is_continuous
from canon.exercise.question.deadline import PROOF_SECONDS
from canon.exercise.question.given_bodies import check_real, given_bodies
from canon.exercise.question.jumping_system import check_absent, check_gauge_term
from canon.exercise.question.question import (
    Determines,
    Part,
    Question,
    Regular,
    Same,
    SameEquations,
    more_than_zero,
    wrong_variables,
)
from canon.expression.symbols.symbol import acceleration, time_derivative, velocity
from canon.expression.symbols.user_input import counted
from canon.frozen_mapping import FrozenMapping
from canon.mechanics.algebra.constraint_manifold import EmptyDomainError, transported
from canon.mechanics.algebra.linear import SingularMatrixError, is_regular, solve_affine
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.lagrange.appell import GibbsAppell
from canon.mechanics.lagrange.hidden_constraints import all_motions, motions_of
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.reduction.routh import routhian as routh
from canon.proof.continuity.turns_of_angles import continuity_but_for_turns
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Undecided
from canon.proof.kinks import vanishes_off_kinks
from canon.proof.trees.affine_form import is_affine

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy.logic.boolalg import Boolean

    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.verdict import Verdict

__all__ = [
    "appell_system",
    "determined_motions",
    "dissipative",
    "euler_lagrange",
    "gibbs_appell",
    "lagrangian_equivalence",
    "lagrangian_of",
    "routhian",
]

SECONDS = 1.0
"""Time for the question whether two rates are equal at every state, on a motion or not."""


def euler_lagrange(reading: Reading) -> Iterator[Question]:
    """The claimed equations are equivalent to d/dt ∂L/∂q̇ − ∂L/∂q = 0."""
    lagrangian = lagrangian_of(reading)
    yield from same_motion(reading, lagrangian)


def dissipative(reading: Reading) -> Iterator[Question]:
    """Equations with d/dt ∂L/∂q̇ − ∂L/∂q + ∂F/∂q̇ = Q, and dE/dt = Σ q̇ (Q − ∂F/∂q̇) − ∂L/∂t.

    What is claimed is what is asked: an answer that gives dE/dt alone, without accelerations, is complete.
    """
    q, t = reading.symbols("q"), reading.time
    damping = reading.expression("F", sp.S.Zero)
    applied = reading.expressions("Qnc", like="q") if reading.has("Qnc") else (sp.S.Zero,) * len(q)
    forces = [Q - damping.diff(velocity(x)) for x, Q in zip(q, applied, strict=True)]
    lagrangian = lagrangian_of(reading, forces=forces)
    if reading.has("claim"):
        yield from same_motion(reading, lagrangian)
    if reading.has("energy_rate"):
        rate = sp.Add(*(velocity(x) * Q for x, Q in zip(q, forces, strict=True)), -lagrangian.L.diff(t))
        yield from _energy_rate(reading, lagrangian, rate)


def _energy_rate(reading: Reading, lagrangian: Lagrangian, rate: Expr) -> Iterator[Question]:
    """Yield whether the claimed dE/dt is a rate on all motions, which may bind velocities too."""
    claimed, accelerations = reading.expression("energy_rate"), [acceleration(x) for x in lagrangian.q]
    through, domain = _on_the_motion(lagrangian, (claimed, rate), reading.domain)
    right = substitute(rate, through)
    shown = right if rate.has(*accelerations) else rate
    yield Same((Part("dE/dt", claimed, right, through, "energy_rate"),), domain, lambda: shown)
    yield from _valued_on_the_motion(reading, "energy_rate", lagrangian)
    written = [a for a in accelerations if claimed.has(a)]
    yield Determines(lambda: (f"dE/dt stays open: it is written with {written[0]}",) if written else ())


def routhian(reading: Reading) -> Iterator[Question]:
    """Ignorable coordinates do not occur in L, and R(q, v, ∂L/∂v_c) = ±(L − Σ v_c ∂L/∂v_c)."""
    q, t = reading.symbols("q"), reading.time
    ignorable, momenta = reading.subset("cyclic", of="q"), reading.symbols("momenta")
    if len(momenta) != len(ignorable):
        reading.fault(
            "momenta",
            f"{counted(len(momenta), 'momentum', 'momenta')} for "
            f"{counted(len(ignorable), 'ignorable coordinate')}",
        )
    sign = {"L-pq": 1, "pq-L": -1}.get(reading.word("convention"))
    if sign is None:
        reading.fault("convention", "write L-pq or pq-L")
    lagrangian = lagrangian_of(reading)
    L, velocities = lagrangian.L, tuple(velocity(c) for c in ignorable)
    absent = tuple(Part(f"∂L/∂{c} of the ignorable coordinate {c}", L.diff(c)) for c in ignorable)
    yield Same(absent, reading.domain, said=_not_ignorable)
    check_absent(ignorable, lagrangian, reading.domain)
    yield Regular(
        sp.Matrix([[L.diff(a, b) for b in velocities] for a in velocities]),
        "the Hessian in the ignorable velocities",
        reading.domain,
    )
    through = {p: L.diff(v) for p, v in zip(momenta, velocities, strict=True)}
    if reading.has("R"):
        right = sign * (L - sp.Add(*(v * L.diff(v) for v in velocities)))
        yield from wrong_variables(
            reading.expression("R"), velocities, "R", "q, the other velocities, the momenta and t"
        )
        part = Part("the Routhian", reading.expression("R"), right, through, "R")
        yield Same(
            (part,),
            transported(reading.domain, through),
            lambda: routhian_in_momenta(lagrangian, velocities, through, sign),
        )
        yield from without_value_on(reading, "R", momenta, lambda: [(through, reading.domain)])
    if reading.has("claim"):
        conserved = tuple(time_derivative(p, q, t) for p in through.values())
        written = reading.equations("claim")
        seen = tuple(substitute(equation, through) for equation in written)
        unknowns = tuple(acceleration(x) for x in q)
        yield SameEquations(
            (*seen, *conserved),
            lagrangian.equations,
            unknowns,
            transported(reading.domain, through),
            lambda: routh(lagrangian, ignorable, momenta, domain=reading.domain).equations,
            written,
            through,
            time=reading.time,
        )
        yield from _valued_on_the_motion(reading, "claim", lagrangian, through)
        yield more_than_zero(written, reading.domain)


def _not_ignorable(part: Part) -> str:
    return f"{part.name.rpartition(' ')[2]} is not ignorable: L depends on it"


def lagrangian_equivalence(reading: Reading) -> Iterator[Question]:
    """L₂ − L₁ is a total time derivative, or both have the same equations of motion."""
    q, t = reading.symbols("q"), reading.time
    first, second = lagrangian_of(reading, "L1").L, lagrangian_of(reading, "L2").L
    relation = reading.word("relation")
    if relation == "equations":
        if reading.has("F"):
            reading.fault("F", "stands beside the relation gauge only; leave it out, or write gauge")
        systems = [Lagrangian(L, q, t=t).equations for L in (second, first)]
        accelerations = tuple(acceleration(x) for x in q)
        yield SameEquations(systems[0], systems[1], accelerations, reading.domain, time=t)
        check_gauge_term(_in_motion(second - first, q, t), q, t, reading.domain)
        yield from _no_steps(first, second, q, reading)
    elif relation != "gauge":
        reading.fault("relation", "write gauge or equations")
    elif reading.has("F"):
        F = reading.expression("F")
        if F.has(*(acceleration(x) for x in q)):
            reading.fault("F", "should depend on coordinates, velocities and time only")
        yield Same((Part("dF/dt", time_derivative(F, q, t), second - first),), reading.domain)
        # At the cut of an angle F may step by a number, which makes no difference; t θ steps by another at each time.
        yield continuity_but_for_turns(F, (*q, t), reading.domain, PROOF_SECONDS, "F")
    else:
        yield from _is_affine_in_velocities(second - first, q, reading.domain)
        yield Same(tuple(_total_derivative_conditions(second - first, q, t)), reading.domain)
        check_gauge_term(_in_motion(second - first, q, t), q, t, reading.domain)
        yield from _no_steps(first, second, q, reading)
        yield Determines(lambda: stay_open(["F"]))


def _no_steps(first: Expr, second: Expr, q: Sequence[Symbol], reading: Reading) -> Iterator[Question]:
    """Yield whether either Lagrangian at rest has a step that the other has not: it gives an impulse there."""
    rest = [_at_rest(L, q, reading.time) for L in (first, second)]
    for mine, other, name in ((rest[0], rest[1], "L1"), (rest[1], rest[0], "L2")):
        yield is_continuous(mine, q, reading.domain, f"{name} at rest", (other,))


def _at_rest(L: Expr, q: Sequence[Symbol], t: Symbol) -> Expr:
    """Return a Lagrangian at rest, but for terms that hold velocities alone: these have no step anywhere.

    They need no value at rest, as ẋ log ẋ has none.

    Raises
    ------
    Undecided
        Where another term has no value at rest.
    """
    velocities = [velocity(x) for x in q]
    terms = [f for f in sp.Add.make_args(sp.expand(L)) if not f.has(*velocities) or f.has(*q, t)]
    rest = substitute(sp.Add(*terms), dict.fromkeys(velocities, sp.S.Zero))
    if rest.has(sp.nan, sp.zoo, sp.oo):
        raise Undecided("a Lagrangian has no value at rest, so whether it jumps somewhere was not decided")
    return rest


def _in_motion(L: Expr, q: Sequence[Symbol], t: Symbol) -> Expr:
    """Return the part of a Lagrangian that holds velocities."""
    return sp.expand(L - _at_rest(L, q, t))


def routhian_in_momenta(
    lagrangian: Lagrangian, ignorable: Sequence[Symbol], through: Mapping[Symbol, Expr], sign: int
) -> Expr | None:
    """Return ±(L − Σ p q̇) with the ignorable velocities eliminated, where the momenta are affine in them."""
    equations = [p - value for p, value in through.items()]
    if any(equation.diff(v).has(*ignorable) for equation in equations for v in ignorable):
        return None
    value = lagrangian.L - sp.Add(*(p * v for p, v in zip(through, ignorable, strict=True)))
    return sp.expand(sp.Integer(sign) * substitute(value, solve_affine(equations, ignorable)), trig=False)


def lagrangian_of(reading: Reading, key: str = "L", forces: Sequence[Expr] | None = None) -> Lagrangian:
    """Return the Lagrangian that a claim gives."""
    L, q = reading.expression(key), reading.symbols("q")
    if L.has(*(acceleration(x) for x in q)):
        reading.fault(key, "a Lagrangian depends on coordinates, velocities and time only")
    return Lagrangian(L, q, forces, reading.time)


def same_motion(reading: Reading, lagrangian: Lagrangian) -> Iterator[Question]:
    """Yield the questions whether the claimed equations are those of a Lagrangian, and say something."""
    unknowns = tuple(acceleration(x) for x in lagrangian.q)
    right = lagrangian.equations
    claimed = reading.equations("claim")
    yield SameEquations(claimed, right, unknowns, reading.domain, lambda: right, claimed, time=reading.time)
    yield from _valued_on_the_motion(reading, "claim", lagrangian)
    yield more_than_zero(claimed, reading.domain)


def _on_the_motion(
    lagrangian: Lagrangian, sides: tuple[Expr, Expr], domain: Domain
) -> tuple[dict[Symbol, Expr], Domain]:
    """Return what two sides hold that is determined on the motion, and where; nothing where they are equal anyway."""
    if vanishes_off_kinks(sides[0] - sides[1], domain, SECONDS).holds:
        return {}, domain
    motions = motions_of(lagrangian, domain)
    held = {s: value for s, value in motions.through.items() if any(side.has(s) for side in sides)}
    return held, motions.branch.domain


def determined_motions(
    equations: Sequence[Expr], q: Sequence[Symbol], domain: Domain, t: Symbol
) -> Iterator[tuple[dict[Symbol, Expr], Domain]]:
    """Yield what equations of motion determine, in terms of what is free, and where; nothing without motions.

    Raises
    ------
    Undecided
        Where that could not be told.
    """
    unknowns = tuple(acceleration(x) for x in q)
    try:
        yield solve_affine(equations, unknowns, domain), domain
    except SingularMatrixError:
        with suppress(EmptyDomainError):
            motions = all_motions(equations, (), q, unknowns, domain, t)
            yield motions.through, motions.branch.domain


def _valued_on_the_motion(
    reading: Reading, key: str, lagrangian: Lagrangian, through: Mapping[Symbol, Expr] = FrozenMapping({})
) -> Iterator[Verdict]:
    """Yield what speaks against answers having a value on the motions, where these determine what may vanish in them.

    At a regular mass matrix states are free, and accelerations alone are determined, with what is put in.
    """
    states = (*lagrangian.q, *lagrangian.velocities)
    bound = (*through, *(acceleration(x) for x in lagrangian.q))
    if what_may_vanish(reading, key, states) and not is_regular(lagrangian.mass_matrix, reading.domain).holds:
        bound += states

    def motions() -> Iterator[tuple[Mapping[Symbol, Expr], Domain]]:
        for found, domain in determined_motions(
            lagrangian.equations, lagrangian.q, reading.domain, lagrangian.t
        ):
            yield {**found, **{p: substitute(value, found) for p, value in through.items()}}, domain

    yield from without_value_on(reading, key, bound, motions)


def _is_affine_in_velocities(f: Expr, q: Sequence[Symbol], domain: Domain) -> Iterator[Question]:
    """Yield, unless the form of a function shows it, whether the function is affine in the velocities.

    It is so on a domain exactly where its slopes, and what it is beside Σ slope·v, are the same at any two velocities
    of it. That the slopes of the slopes vanish would not do: they do so for steps and for atan(tan v).
    """
    velocities = [velocity(x) for x in q]
    if is_affine(f, velocities):
        return
    others: dict[Symbol, Expr] = {v: sp.Dummy(f"{v}_1", **v.assumptions0) for v in velocities if f.has(v)}
    slopes = {v: f.diff(v) for v in others}
    rest = f - sp.Add(*(slope * v for v, slope in slopes.items()))
    elsewhere = (cast("Boolean", c.xreplace(others)) for c in domain.conditions if c.has(*others))
    parts = (
        Part("L2 − L1 is affine in the velocities", e, cast("Expr", e.xreplace(others)))
        for e in (*slopes.values(), rest)
    )
    yield Same(tuple(parts), Domain((*domain.conditions, *elsewhere), domain.box))


def _total_derivative_conditions(difference: Expr, q: Sequence[Symbol], t: Symbol) -> Iterator[Part]:
    """Σ aᵢ q̇ᵢ + b is dF/dt of some F(q, t), locally, exactly where the form Σ aᵢ dqᵢ + b dt is closed."""
    velocities = [velocity(x) for x in q]
    slopes = [difference.diff(v) for v in velocities]
    for i, a in enumerate(slopes):
        for v in velocities[i:]:
            yield Part(f"L2 − L1 is affine in {v}", a.diff(v))
    rest = difference - sp.Add(*(a * v for a, v in zip(slopes, velocities, strict=True)))
    for (a, x), (b, y) in combinations(zip(slopes, q, strict=True), 2):
        yield Part(f"the derivatives by {x} and {y} agree", a.diff(y), b.diff(x))
    for a, x in zip(slopes, q, strict=True):
        yield Part(f"the derivatives by {x} and {t} agree", a.diff(t), rest.diff(x))


def gibbs_appell(reading: Reading) -> Iterator[Question]:
    """S has the right derivatives by the accelerations, and the equations are Appell's."""
    appell = appell_system(reading)
    kinematics, domain = appell.kinematics, reading.domain
    natural = kinematics.u == tuple(velocity(x) for x in appell.q)
    if reading.has("S"):
        S = kinematics.along(reading.expression("S"))
        parts = (Part(f"∂S/∂{a}", S.diff(a), s) for a, s in zip(appell.u_dot, appell.slopes, strict=True))
        yield Same(tuple(parts), domain)
        yield is_continuous(S, (*appell.q, *kinematics.u, *appell.u_dot, kinematics.t), domain, "S")
        if not natural:
            rates = tuple(kinematics.through)
            yield from without_value_on(reading, "S", rates, lambda: [(kinematics.through, domain)])
    if reading.has("claim"):
        written = reading.equations("claim")
        claims = tuple(kinematics.along(claim) for claim in written)
        yield SameEquations(
            claims,
            appell.equations,
            appell.u_dot,
            domain,
            lambda: appell.equations,
            written,
            {} if natural else kinematics.through,
        )
        determined = (*({} if natural else kinematics.through), *appell.u_dot)
        yield from without_value_on(reading, "claim", determined, lambda: _motions_of_bodies(appell, domain))
        yield more_than_zero(claims, domain)


def _motions_of_bodies(appell: GibbsAppell, domain: Domain) -> Iterator[tuple[Mapping[Symbol, Expr], Domain]]:
    """Yield q̇, q̈ and u̇ on the motions, in terms of q, u and t."""
    try:
        found = solve_affine(appell.equations, appell.u_dot, domain)
    except SingularMatrixError:  # what S does not determine stays free
        found = {}
    rates = {rate: substitute(value, found) for rate, value in appell.kinematics.through.items()}
    yield {**rates, **found}, domain


def appell_system(reading: Reading) -> GibbsAppell:
    """Return the bodies of a claim in its quasi-velocities."""
    if reading.has("quasi") and not reading.has("q_dot"):
        reading.fault("q_dot", "missing; say what each velocity is in terms of the quasi-velocities")
    if reading.has("q_dot") and not reading.has("quasi"):
        reading.fault("quasi", "missing; name the quasi-velocities in which q_dot is given")
    q, bodies = reading.symbols("q"), list(given_bodies(reading))
    for where, body in bodies:
        check_real(reading, f"{where}.r", body.r)
    quasi = reading.symbols("quasi") if reading.has("quasi") else None
    rates = reading.expressions("q_dot", like="q") if quasi is not None else None
    foreign = {velocity(x) for x in q} - {*(quasi or ())}
    for i, rate in enumerate(rates or ()):
        if held := sorted(map(str, foreign & rate.free_symbols)):
            reading.fault(f"q_dot[{i}]", f"holds {', '.join(held)}; write it in the quasi-velocities alone")
    return GibbsAppell(
        tuple(body for _, body in bodies),
        q,
        reading.expression("V", sp.S.Zero),
        quasi,
        rates,
        reading.expressions("Qnc", like="q") if reading.has("Qnc") else None,
        reading.time,
    )
