"""Bodies and forces of a claim: its tables ``bodies`` and ``forces``, read for mechanics."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr

from canon.expression.symbols.symbol import acceleration, velocity
from canon.expression.symbols.user_input import counted
from canon.mechanics.lagrange.body import Body, Particle, PlanarBody, RigidBody
from canon.mechanics.lagrange.force import generalized_forces, generalized_moments

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from canon.exercise.sheet.reading import Reading

__all__ = ["check_real", "given_bodies", "given_forces"]


def given_bodies(reading: Reading) -> Iterator[tuple[str, Body]]:
    """Yield the bodies of a claim, each with the key that it stands under.

    A body is a point ``m`` at ``r``, a rotor ``I`` with ``angle`` or ``omega``, or both. Three components of ``omega``
    are along axes that turn with the body, and ``I`` is then one moment, three principal ones, or Ixx, Iyy, Izz, Ixy,
    Ixz, Iyz; any other number of components are as many rotors, each with its moment.
    """
    for i, body in enumerate(_tables(reading, "bodies")):
        where = f"bodies[{i}]"
        if "r" in body:
            (mass,) = _exactly(reading, f"{where}.m", body["m"], 1)
            yield where, Particle(mass, reading.inside(f"{where}.r", body["r"]))
        if "I" in body:
            yield from ((where, rotor) for rotor in _rotors(reading, where, body))


def _rotors(reading: Reading, where: str, body: Mapping[str, object]) -> Iterator[Body]:
    inertia = reading.inside(f"{where}.I", body["I"])
    if "angle" in body:
        (angle,) = _exactly(reading, f"{where}.angle", body["angle"], 1)
        omega: tuple[Expr, ...] = ()
    else:
        angle, omega = None, reading.inside(f"{where}.omega", body["omega"])
    n = 1 if angle is not None else len(omega)
    if n == 3 and len(inertia) in (1, 3, 6):
        yield RigidBody(sp.S.Zero, (), _tensor(inertia), omega=omega)
        return
    moments = inertia * n if len(inertia) == 1 else inertia
    if len(moments) != n:
        reading.fault(
            f"{where}.I",
            f"{counted(len(moments), 'moment')} of inertia for "
            f"{counted(n, 'angular velocity', 'angular velocities')}",
        )
    if angle is not None:
        yield PlanarBody(sp.S.Zero, (), moments[0], angle)
    for moment, rate in zip(moments, omega, strict=False):
        yield PlanarBody(sp.S.Zero, (), moment, omega=rate)


def _tensor(inertia: tuple[Expr, ...]) -> sp.Matrix:
    """Return the tensor of inertia from one moment, three principal ones, or Ixx, Iyy, Izz, Ixy, Ixz, Iyz."""
    xx, yy, zz, xy, xz, yz = (*(inertia if len(inertia) > 1 else inertia * 3), *(sp.S.Zero,) * 3)[:6]
    return sp.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def given_forces(reading: Reading) -> Iterator[tuple[Expr, ...]]:
    """Yield the generalized forces of each force, torque and moment that a claim gives."""
    q = reading.symbols("q")
    for i, force in enumerate(_tables(reading, "forces")):
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
            try:
                yield generalized_moments([strengths], [along], q, reading.time)
            except ValueError:
                reading.fault(f"forces[{i}].omega", "should be affine in the velocities")
        else:
            check_real(reading, f"forces[{i}].{second}", along)
            yield generalized_forces([strengths], [along], q, reading.time)


def check_real(reading: Reading, where: str, positions: Sequence[Expr]) -> None:
    """Refuse positions that are complex, or depend on more than coordinates and time."""
    for place in positions:
        if place.has(sp.I):
            reading.fault(where, "should be real components, not a complex number")
        if place.has(*(f(x) for x in reading.symbols("q") for f in (velocity, acceleration))):
            reading.fault(where, "a position depends on coordinates and time only")


def _exactly(reading: Reading, where: str, value: object, count: int) -> tuple[Expr, ...]:
    """Return what stands under a key, which is to be so many expressions."""
    found = reading.inside(where, value)
    if len(found) != count:
        reading.fault(where, f"{counted(count, 'expression')} should be here, not {len(found)}")
    return found


def _tables(reading: Reading, key: str) -> Sequence[Mapping[str, object]]:
    return cast("Sequence[Mapping[str, object]]", reading.claim.keys.get(key, []))
