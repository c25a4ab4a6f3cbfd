"""Claims about kinetic energies from positions, and generalized forces from virtual work or power.

T = Σ ½ m ṙ² + ½ ω·I ω;  Q_k = Σ F·∂r/∂q_k + Σ M·∂ω/∂q̇_k, the coefficients of δq in the virtual work.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.question.deadline import SIDE_SECONDS
from canon.exercise.question.given_bodies import check_real, given_bodies, given_forces
from canon.exercise.question.question import Part, Question, Same
from canon.expression.symbols.symbol import acceleration, time_derivative, velocity
from canon.mechanics.algebra.constraint_manifold import check_whole, inhabited, on_manifold
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.mechanics.lagrange.body import kinetic_energy as energy_of_bodies
from canon.mechanics.lagrange.force import potential_forces
from canon.mechanics.lagrange.quasi_velocity import Kinematics
from canon.proof.domain.verdict import Undecided
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.exercise.sheet.reading import Reading
    from canon.mechanics.lagrange.body import Body
    from canon.proof.domain.domain import Domain

__all__ = ["generalized_force", "kinetic_energy", "shown_short"]

LONGEST_REDUCED = 400
"""Operations of an answer up to which sines and cosines are gathered for display."""


def kinetic_energy(reading: Reading) -> Iterator[Question]:
    """The kinetic energy of particles and rigid bodies, where constraints hold if there are any."""
    q, t = reading.symbols("q"), reading.time
    claimed = reading.expression("T")
    if claimed.has(*(acceleration(x) for x in q)):
        reading.fault("T", "a kinetic energy depends on coordinates, velocities and time only")
    right = energy_of_bodies(tuple(_bodies(reading)), q, t)
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
    shares = [*given_forces(reading), *_of_work(reading), *_of_power(reading)]
    if reading.has("V"):
        V = reading.expression("V")
        if V.has(*(acceleration(x) for x in q)):
            reading.fault("V", "a potential depends on coordinates, velocities and time only")
        shares.append(potential_forces(V, q, reading.time))
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


def _bodies(reading: Reading) -> Iterator[Body]:
    """Yield the bodies, whose positions and angular velocities must be real functions of q, q̇ and t."""
    q = reading.symbols("q")
    kinematics, accelerations = Kinematics(q, t=reading.time), tuple(acceleration(x) for x in q)
    for where, body in given_bodies(reading):
        check_real(reading, f"{where}.r", body.r)
        if any(w.has(sp.I, *accelerations) for w in body.angular_velocity(kinematics)):
            reading.fault(where, "an angular velocity is real and depends on q, q̇ and the time only")
        yield body


def _of_work(reading: Reading) -> Iterator[tuple[Expr, ...]]:
    if not reading.has("work"):
        return
    q = reading.symbols("q")
    deltas = [Symbol(f"delta_{x}", real=True) for x in q]
    work = reading.with_names({s.name: s for s in deltas}).expression("work")
    slopes = tuple(work.diff(d) for d in deltas)
    at_rest = exchanged(work, dict.fromkeys(deltas, sp.S.Zero))
    if any(s.has(*deltas) for s in slopes) or at_rest != 0:
        reading.fault("work", "a virtual work is linear in " + ", ".join(map(str, deltas)))
    yield slopes


def _of_power(reading: Reading) -> Iterator[tuple[Expr, ...]]:
    """Yield ∂P/∂q̇ where P is linear in the velocities; with one coordinate P/q̇ where it is not."""
    if not reading.has("power"):
        return
    q, power = reading.symbols("q"), reading.expression("power")
    velocities = [velocity(x) for x in q]
    spread = cast("Expr", sp.expand(power))
    slopes = tuple(spread.diff(v) for v in velocities)
    if not any(s.has(*velocities) for s in slopes) and _is_none_at_rest(spread, velocities, reading.domain):
        yield slopes
    elif len(q) == 1:
        yield (sp.cancel(power / velocities[0]),)
    else:
        reading.fault(
            "power",
            "does not determine the forces unless it is linear in the velocities; give forces or work",
        )


def _is_none_at_rest(power: Expr, velocities: Sequence[Symbol], domain: Domain) -> bool:
    """Tell whether a power affine in the velocities is linear in them: P₀ of an engine is no force times a velocity.

    Raises
    ------
    Undecided
        Where that was not decided.
    """
    verdict = vanishes_off_kinks(exchanged(power, dict.fromkeys(velocities, sp.S.Zero)), domain, SIDE_SECONDS)
    if verdict.undecided:
        raise Undecided(
            "whether the power vanishes at rest was not decided; write it as a sum over the velocities"
        )
    return verdict.holds
