"""Claims about the Gibbs–Appell function and Appell's equations, with or without quasi-velocities.

S = Σ ½ m a² + ½ I α² over the bodies; ∂S/∂u̇ⱼ = −Σ ∂V/∂qᵢ ∂q̇ᵢ/∂uⱼ (P. Appell, J. reine angew. Math. 121 (1900)
310). A rotor with ``omega`` as a list of three has them along axes fixed in it, where Euler's gyroscopic terms join
in: the torque is I ω̇ + ω × I ω, so that of principal axes I₁ω̇₁ + (I₃ − I₂)ω₂ω₃.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.judges.energy_and_force import exactly
from canon.exercise.question.continuous_answer import is_continuous
from canon.exercise.question.question import Part, Question, Same, SameEquations, more_than_zero
from canon.expression.symbols.symbol import acceleration, velocity
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.substitution import substitute

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from canon.exercise.sheet.reading import Reading

__all__ = ["gibbs_appell"]


@dataclass(frozen=True)
class _Kinematics:
    """Velocities and their rates in the variables (q, u, t), and d/dt in them."""

    q: tuple[Symbol, ...]
    u: tuple[Symbol, ...]
    u_dot: tuple[Symbol, ...]
    q_dot: tuple[Expr, ...]
    t: Symbol

    def rate(self, f: Expr) -> Expr:
        """Return df/dt of f(q, u, t)."""
        return sp.Add(
            *(f.diff(x) * v for x, v in zip(self.q, self.q_dot, strict=True)),
            *(f.diff(u) * a for u, a in zip(self.u, self.u_dot, strict=True)),
            f.diff(self.t),
        )

    @property
    def through(self) -> Mapping[Symbol, Expr]:
        """What q̇ and q̈ are, where quasi-velocities are used."""
        if self.u == tuple(velocity(x) for x in self.q):
            return {}
        return {
            **{velocity(x): v for x, v in zip(self.q, self.q_dot, strict=True)},
            **{acceleration(x): self.rate(v) for x, v in zip(self.q, self.q_dot, strict=True)},
        }


def gibbs_appell(reading: Reading) -> Iterator[Question]:
    """S has the right derivatives by the accelerations, and the equations are Appell's."""
    kinematics = _kinematics(reading)
    forces = _appell_forces(reading, kinematics)
    slopes = _slopes(reading, kinematics)
    if reading.has("S"):
        claimed = substitute(reading.expression("S"), kinematics.through)
        yield Same(
            tuple(
                Part(f"∂S/∂{a}", claimed.diff(a), s) for a, s in zip(kinematics.u_dot, slopes, strict=True)
            ),
            reading.domain,
        )
        variables = (*kinematics.q, *kinematics.u, *kinematics.u_dot, kinematics.t)
        yield is_continuous(claimed, variables, reading.domain, "S")
    if reading.has("claim"):
        equations = tuple(s - Q for s, Q in zip(slopes, forces, strict=True))
        written = reading.equations("claim")
        claims = tuple(substitute(claim, kinematics.through) for claim in written)
        yield SameEquations(
            claims,
            equations,
            kinematics.u_dot,
            reading.domain,
            lambda: equations,
            written,
            kinematics.through,
        )
        yield more_than_zero(claims, reading.domain)


def _kinematics(reading: Reading) -> _Kinematics:
    q, t = reading.symbols("q"), reading.time
    if not reading.has("quasi"):
        velocities = tuple(velocity(x) for x in q)
        return _Kinematics(q, velocities, tuple(acceleration(x) for x in q), velocities, t)
    if not reading.has("q_dot"):
        reading.fault("q_dot", "missing; say what each velocity is in terms of the quasi-velocities")
    u = reading.symbols("quasi")
    return _Kinematics(q, u, tuple(velocity(w) for w in u), reading.expressions("q_dot", like="q"), t)


def _appell_forces(reading: Reading, kinematics: _Kinematics) -> list[Expr]:
    V = reading.expression("V", sp.S.Zero)
    pairs = list(zip(kinematics.q, kinematics.q_dot, strict=True))
    return [sp.Add(*(-V.diff(x) * v.diff(u) for x, v in pairs)) for u in kinematics.u]


def _slopes(reading: Reading, kinematics: _Kinematics) -> list[Expr]:
    """Return ∂S/∂u̇ = Σ m a·∂a/∂u̇ + Σ torque·∂α/∂u̇, without S itself."""
    terms: list[tuple[Expr, Expr]] = []
    for i, body in enumerate(reading.claim.keys["bodies"]):
        where = f"bodies[{i}]"
        if "r" in body:
            (mass,) = exactly(reading, f"{where}.m", body["m"], 1)
            for place in reading.inside(f"{where}.r", body["r"]):
                a = kinematics.rate(substitute(kinematics.rate(place), kinematics.through))
                terms.append((mass * a, a))
        if "I" in body:
            terms += _rotor(reading, where, body, kinematics)
    return [sp.Add(*(force * a.diff(b) for force, a in terms)) for b in kinematics.u_dot]


def _rotor(
    reading: Reading, where: str, body: Mapping[str, object], kinematics: _Kinematics
) -> list[tuple[Expr, Expr]]:
    inertia = reading.inside(f"{where}.I", body["I"])
    if "angle" in body:
        (angle,) = exactly(reading, f"{where}.angle", body["angle"], 1)
        rates: Sequence[Expr] = (substitute(kinematics.rate(angle), kinematics.through),)
    else:
        rates = [substitute(w, kinematics.through) for w in reading.inside(f"{where}.omega", body["omega"])]
    angular = [kinematics.rate(w) for w in rates]
    if len(rates) == 3 and len(inertia) in (1, 3, 6):
        return list(zip(_euler(_tensor(inertia), sp.Matrix(rates), sp.Matrix(angular)), angular, strict=True))
    if len(inertia) == 1:
        inertia = inertia * len(rates)
    if len(inertia) != len(rates):
        reading.fault(
            f"{where}.I",
            f"{counted(len(inertia), 'moment')} of inertia for "
            f"{counted(len(rates), 'angular velocity', 'angular velocities')}",
        )
    return [(moment * a, a) for moment, a in zip(inertia, angular, strict=True)]


def _tensor(inertia: tuple[Expr, ...]) -> sp.Matrix:
    """Return the tensor of inertia from one moment, three principal ones, or Ixx, Iyy, Izz, Ixy, Ixz, Iyz."""
    xx, yy, zz, xy, xz, yz = (*(inertia if len(inertia) > 1 else inertia * 3), *(sp.S.Zero,) * 3)[:6]
    return sp.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _euler(tensor: sp.Matrix, rates: sp.Matrix, angular: sp.Matrix) -> Sequence[Expr]:
    """Return Euler's torque I ω̇ + ω × I ω."""
    return (tensor * angular + rates.cross(tensor * rates)).flat()
