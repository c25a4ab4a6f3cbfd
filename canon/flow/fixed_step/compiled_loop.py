"""Compiled loop of a fixed-step method: compiled once, then kept, with the coefficients that it reads."""

from __future__ import annotations

import dataclasses
import functools
from typing import TYPE_CHECKING

from canon.flow.fixed_step.partial_step import PartialSteps
from canon.flow.method.method import RK4, FixedStep, Gauss, Splitting
from canon.flow.method.solvable_splitting import SolvableSplitting
from canon.flow.method.solvable_splitting import loop_of as solvable_loop_of
from canon.kernel.llvm.loop import Loop, runge_kutta_loop
from canon.kernel.llvm.machine_code import simd_bytes
from canon.kernel.loops.gauss import gauss_loop
from canon.kernel.loops.splitting import splitting_loop
from canon.kernel.schemes.gauss_tableau import gauss_coefficients

if TYPE_CHECKING:
    from fractions import Fraction

    from canon.flow.method.number_formats import Precision
    from canon.flow.run.sampling_plan import Plan
    from canon.kernel.llvm.number_types import MachineType
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["compiled_loop", "steps_between"]

_KEPT = 64
"""Compiled loops kept for the next call."""

_INTERLEAVED = 4
"""SIMD registers' worth of orbits stepped together: while one waits for a root or a quotient, others compute."""

_PLANE, _STAGES, _MANY = 2, 5, 1000
"""Of so many orbits twice as many are stepped together where roots and quotients are what takes the time, as in
Kepler's problem: in up to so many degrees of freedom, which the registers just hold, through so many stages a step."""

_SMALL = 200
"""Up to this many operations in the force the registers hold that many orbits."""


def compiled_loop(
    system: HamiltonEquations, method: FixedStep, precision: Precision, orbits: int = 1
) -> Loop:
    """Return the machine code that steps a system with a method, kept from an earlier call if there was one.

    Parameters
    ----------
    system, method, precision
        What to integrate, how, and in which numbers.
    orbits
        How many orbits will be stepped together: several run side by side in SIMD lanes.

    Raises
    ------
    ValueError
        A splitting is asked of a Hamiltonian that does not split, or a Nyström method of one whose kinetic energy
        is not quadratic.
    """
    if isinstance(method, Splitting) and method.parts is not None:
        method = SolvableSplitting(method.scheme, parts=method.parts)
    if isinstance(method, SolvableSplitting):
        return solvable_loop_of(system, method, precision)
    number = precision.number
    if orbits > 1:
        stages = len(method.scheme.b) if isinstance(method, Splitting) and not precision.compensated else 0
        number = _with_lanes(number, system, orbits, stages)
    if isinstance(method, Gauss):
        return _kept_gauss(system, method.stages, precision.number, compensated=precision.compensated)
    if isinstance(method, RK4):
        return _kept_runge_kutta(system, number, compensated=precision.compensated)
    if not system.separable:
        raise ValueError(
            "H is not a sum T(p, t) + V(q, t), so it does not split into drifts and kicks; use Gauss(6), which is "
            "symplectic for every H, or Taylor()"
        )
    if method.scheme.nystrom and not system.quadratic_kinetic:
        raise ValueError(
            f"{method} keeps its order only for kinetic energies quadratic in p with constant coefficients; "
            "use Splitting('blanes-moan-6') or Splitting('kahan-li-8')"
        )
    kick_first = method.scheme.kick_first and system.autonomous
    return _kept_splitting(
        system, len(method.scheme.b), number, compensated=precision.compensated, kick_first=kick_first
    )


def _with_lanes(number: MachineType, system: HamiltonEquations, orbits: int, stages: int) -> MachineType:
    if number.scalar == "x86_fp80":  # x87 numbers have no SIMD instructions
        return number
    registers, force = 1, system.program(system.force)
    if len(force.instructions) <= _SMALL:
        waiting = force.count("sqrt") + force.count("div") > 0 and not number.pair
        many = waiting and len(system.q) <= _PLANE and stages >= _STAGES and orbits >= _MANY
        registers = 2 * _INTERLEAVED if many else _INTERLEAVED
    return dataclasses.replace(number, lanes=simd_bytes() // number.alignment * registers)


@functools.lru_cache(maxsize=_KEPT)
def _kept_splitting(
    system: HamiltonEquations, stages: int, number: MachineType, *, compensated: bool, kick_first: bool
) -> Loop:
    return splitting_loop(system, stages, number=number, compensated=compensated, kick_first=kick_first)


@functools.lru_cache(maxsize=_KEPT)
def _kept_runge_kutta(system: HamiltonEquations, number: MachineType, *, compensated: bool) -> Loop:
    return runge_kutta_loop(system, number=number, compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def _kept_gauss(system: HamiltonEquations, stages: int, number: MachineType, *, compensated: bool) -> Loop:
    return gauss_loop(system, stages, compensated=compensated, number=number)


def steps_between(loop: Loop, method: FixedStep, plan: Plan) -> PartialSteps:
    """Return what takes steps of any length between those of a run."""
    assert plan.h is not None
    coefficients = loop.coefficients or functools.partial(_coefficients, method, loop.number)
    return PartialSteps(loop, coefficients, plan.start, plan.h)


def _coefficients(method: FixedStep, number: MachineType, h: Fraction) -> list[Fraction]:
    if isinstance(method, Gauss):
        return gauss_coefficients(method.stages, h, number)
    if isinstance(method, RK4):
        return [h / 2, h / 6, h / 3]
    a, b = method.scheme.a, method.scheme.b
    return [h * c for pair in zip(a, b, strict=False) for c in pair] + [h * a[-1]]
