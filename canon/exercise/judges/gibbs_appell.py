"""Claims about the Gibbs–Appell function and Appell's equations, with or without quasi-velocities.

S = Σ ½ m a² + ½ I α² over the bodies; ∂S/∂u̇ⱼ = Σ (Qᵢ − ∂V/∂qᵢ) ∂q̇ᵢ/∂uⱼ (P. Appell, J. reine angew. Math. 121 (1900)
310). A rotor with ``omega`` as a list of three has them along axes fixed in it, where Euler's gyroscopic terms join
in: the torque is I ω̇ + ω × I ω, so that of principal axes I₁ω̇₁ + (I₃ − I₂)ω₂ω₃.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.question.continuous_answer import is_continuous
from canon.exercise.question.given_bodies import given_bodies
from canon.exercise.question.question import Part, Question, Same, SameEquations, more_than_zero
from canon.expression.symbols.symbol import velocity
from canon.mechanics.lagrange.appell import GibbsAppell

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.exercise.sheet.reading import Reading

__all__ = ["gibbs_appell"]


def gibbs_appell(reading: Reading) -> Iterator[Question]:
    """S has the right derivatives by the accelerations, and the equations are Appell's."""
    appell = _system(reading)
    kinematics, domain = appell.kinematics, reading.domain
    if reading.has("S"):
        S = kinematics.along(reading.expression("S"))
        parts = (Part(f"∂S/∂{a}", S.diff(a), s) for a, s in zip(appell.u_dot, appell.slopes, strict=True))
        yield Same(tuple(parts), domain)
        yield is_continuous(S, (*appell.q, *kinematics.u, *appell.u_dot, kinematics.t), domain, "S")
    if reading.has("claim"):
        written = reading.equations("claim")
        claims = tuple(kinematics.along(claim) for claim in written)
        natural = kinematics.u == tuple(velocity(x) for x in appell.q)
        yield SameEquations(
            claims,
            appell.equations,
            appell.u_dot,
            domain,
            lambda: appell.equations,
            written,
            {} if natural else kinematics.through,
        )
        yield more_than_zero(claims, domain)


def _system(reading: Reading) -> GibbsAppell:
    if reading.has("quasi") and not reading.has("q_dot"):
        reading.fault("q_dot", "missing; say what each velocity is in terms of the quasi-velocities")
    return GibbsAppell(
        tuple(body for _, body in given_bodies(reading)),
        reading.symbols("q"),
        reading.expression("V", sp.S.Zero),
        reading.symbols("quasi") if reading.has("quasi") else None,
        reading.expressions("q_dot", like="q") if reading.has("quasi") else None,
        reading.expressions("Qnc", like="q") if reading.has("Qnc") else None,
        reading.time,
    )
