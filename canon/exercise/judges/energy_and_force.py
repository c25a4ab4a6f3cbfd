"""Claims about kinetic energies from positions, and generalized forces from virtual work or power.

T = Σ ½ m ṙ² + ½ ω·I ω;  Q_k = Σ F·∂r/∂q_k + Σ M·∂ω/∂q̇_k, the coefficients of δq in the virtual work.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.question.constraint_manifold import check_whole, inhabited, on_manifold
from canon.exercise.question.question import Part, Question, Same
from canon.expression.symbols.symbol import acceleration, time_derivative, velocity
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.substitution import exchanged, substitute

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from canon.exercise.sheet.reading import Reading

__all__ = ["exactly", "generalized_force", "kinetic_energy", "places", "shown_short"]

LONGEST_REDUCED = 400
"""Operations of an answer up to which sines and cosines are gathered for display."""


def kinetic_energy(reading: Reading) -> Iterator[Question]:
    """The kinetic energy of particles and rigid bodies, where constraints hold if there are any."""
    q, t = reading.symbols("q"), reading.time
    claimed = reading.expression("T")
    if claimed.has(*(acceleration(x) for x in q)):
        reading.fault("T", "a kinetic energy depends on coordinates, velocities and time only")
    right = sp.Add(*_energies(reading))
    held = reading.equations("constraints") if reading.has("constraints") else ()
    velocities = tuple(velocity(x) for x in q)
    rates = tuple(time_derivative(f, q, t) for f in held if not f.has(*velocities))
    check_whole(held, velocities, reading.domain)
    for branch in inhabited(on_manifold((*held, *rates), reading.domain, keep=(t,), prefer=velocities)):
        here = substitute(right, branch.values)
        part = Part("T", claimed, here, branch.values, "T")
        yield Same((part,), branch.domain, lambda here=here: shown_short(here))


def generalized_force(reading: Reading) -> Iterator[Question]:
    """The generalized forces of given forces, torques, virtual work, power and potential together."""
    q = reading.symbols("q")
    shares = [*_of_forces(reading), *_of_work(reading), *_of_power(reading), *_of_potential(reading)]
    right = tuple(sp.Add(*(share[k] for share in shares)) for k in range(len(q)))
    claimed = reading.expressions("Q", like="q")
    parts = tuple(
        Part(f"the generalized force of {x}", c, r, key=f"Q[{k}]")
        for k, (x, c, r) in enumerate(zip(q, claimed, right, strict=True))
    )
    answer = (f"Q_{x} = {r}" for x, r in zip(q, right, strict=True))
    yield Same(parts, reading.domain, lambda: tuple(answer))


def shown_short(f: Expr) -> Expr:
    """Return an expression as it is shown: multiplied out, squares of sines and cosines added up."""
    if sp.count_ops(f) > LONGEST_REDUCED:
        return f
    from sympy.simplify.fu import TR8  # products of sines and cosines into sums

    spread = sp.expand(f, trig=False)
    gathered = sp.expand(TR8(spread)) if spread.has(sp.sin, sp.cos) else spread
    return min((f, spread, gathered), key=sp.count_ops)


def _energies(reading: Reading) -> Iterator[Expr]:
    q, t = reading.symbols("q"), reading.time
    for i, body in enumerate(cast("Sequence[Mapping[str, object]]", reading.claim.keys["bodies"])):
        where = f"bodies[{i}]"
        if "r" in body:
            (mass,) = exactly(reading, f"{where}.m", body["m"], 1)
            for place in reading.inside(f"{where}.r", body["r"]):
                _check_position(reading, f"{where}.r", place)
                yield mass * time_derivative(place, q, t) ** 2 / 2
        if "I" in body:
            yield _of_rotation(reading, where, body)


def places(reading: Reading, key: str) -> Iterator[Expr]:
    """Yield the positions and angles of the bodies, or of the points where forces act."""
    given = cast("Sequence[Mapping[str, object]]", reading.claim.keys.get(key, []))
    for i, item in enumerate(given):
        for part in ("r", "angle"):
            if part in item:
                yield from reading.inside(f"{key}[{i}].{part}", item[part])


def _check_position(reading: Reading, where: str, place: Expr) -> None:
    if place.has(sp.I):
        reading.fault(where, "should be real components, not a complex number")
    if place.has(*(f(x) for x in reading.symbols("q") for f in (velocity, acceleration))):
        reading.fault(where, "a position depends on coordinates and time only")


def _of_rotation(reading: Reading, where: str, body: Mapping[str, object]) -> Expr:
    """Return ½ ω·I ω; I has one moment, three principal moments, or Ixx, Iyy, Izz, Ixy, Ixz, Iyz."""
    if "angle" in body:
        (angle,) = exactly(reading, f"{where}.angle", body["angle"], 1)
        rates: tuple[Expr, ...] = (time_derivative(angle, reading.symbols("q"), reading.time),)
    else:
        rates = reading.inside(f"{where}.omega", body["omega"])
    if any(w.has(sp.I, *(acceleration(x) for x in reading.symbols("q"))) for w in rates):
        reading.fault(where, "an angular velocity is real and depends on q, q̇ and the time only")
    inertia = reading.inside(f"{where}.I", body["I"])
    if len(inertia) == 6 and len(rates) == 3:
        xx, yy, zz, xy, xz, yz = inertia
        x, y, z = rates
        return (xx * x**2 + yy * y**2 + zz * z**2) / 2 + xy * x * y + xz * x * z + yz * y * z
    if len(inertia) == 1:
        inertia = inertia * len(rates)
    if len(inertia) != len(rates):
        reading.fault(
            f"{where}.I",
            f"{counted(len(inertia), 'moment')} of inertia for "
            f"{counted(len(rates), 'angular velocity', 'angular velocities')}",
        )
    return sp.Add(*(moment * w**2 / 2 for moment, w in zip(inertia, rates, strict=True)))


def _of_forces(reading: Reading) -> Iterator[list[Expr]]:
    q = reading.symbols("q")
    given = cast("Sequence[Mapping[str, object]]", reading.claim.keys.get("forces", []))
    for i, force in enumerate(given):
        first, second = next(
            (a, b) for a, b in (("F", "r"), ("torque", "angle"), ("torque", "omega")) if b in force
        )
        strengths = reading.inside(f"forces[{i}].{first}", force[first])
        along = reading.inside(f"forces[{i}].{second}", force[second])
        if len(strengths) != len(along):
            reading.fault(
                f"forces[{i}].{first}",
                f"{counted(len(strengths), 'component')}, and {len(along)} of {second}",
            )
        if second == "omega":
            slopes = [[w.diff(velocity(x)) for w in along] for x in q]
            if any(s.has(*(velocity(x) for x in q)) for row in slopes for s in row):
                reading.fault(f"forces[{i}].omega", "should be affine in the velocities")
        else:
            for r in along:
                _check_position(reading, f"forces[{i}].{second}", r)
            slopes = [[r.diff(x) for r in along] for x in q]
        yield [sp.Add(*(F * s for F, s in zip(strengths, row, strict=True))) for row in slopes]


def _of_work(reading: Reading) -> Iterator[list[Expr]]:
    if not reading.has("work"):
        return
    q = reading.symbols("q")
    deltas = [Symbol(f"delta_{x}", real=True) for x in q]
    work = reading.with_names({s.name: s for s in deltas}).expression("work")
    slopes: list[Expr] = [work.diff(d) for d in deltas]
    at_rest = exchanged(work, dict.fromkeys(deltas, sp.S.Zero))
    if any(s.has(*deltas) for s in slopes) or at_rest != 0:
        reading.fault("work", "a virtual work is linear in " + ", ".join(map(str, deltas)))
    yield slopes


def _of_power(reading: Reading) -> Iterator[list[Expr]]:
    """Yield ∂P/∂q̇ where P is affine in the velocities; with one coordinate P/q̇ where it is not."""
    if not reading.has("power"):
        return
    q, power = reading.symbols("q"), reading.expression("power")
    velocities = [velocity(x) for x in q]
    spread = cast("Expr", sp.expand(power))
    slopes: list[Expr] = [spread.diff(v) for v in velocities]
    if not any(s.has(*velocities) for s in slopes):
        yield [*slopes]
    elif len(q) == 1:
        yield [sp.cancel(power / velocities[0])]
    else:
        reading.fault(
            "power",
            "does not determine the forces unless it is affine in the velocities; give forces or work",
        )


def _of_potential(reading: Reading) -> Iterator[list[Expr]]:
    """Yield Q = d/dt ∂V/∂q̇ − ∂V/∂q, which is −∂V/∂q for an ordinary potential."""
    if not reading.has("V"):
        return
    q, t, V = reading.symbols("q"), reading.time, reading.expression("V")
    if V.has(*(acceleration(x) for x in q)):
        reading.fault("V", "a potential depends on coordinates, velocities and time only")
    yield [time_derivative(V.diff(velocity(x)), q, t) - V.diff(x) for x in q]


def exactly(reading: Reading, where: str, value: object, count: int) -> tuple[Expr, ...]:
    """Return what stands under a key, which is to be so many expressions."""
    found = reading.inside(where, value)
    if len(found) != count:
        reading.fault(where, f"{counted(count, 'expression')} should be here, not {len(found)}")
    return found
