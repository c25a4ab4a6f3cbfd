"""Compiled loops by their families, kept for the next call.

What writes the loop of a family is imported when the first loop of that family is asked for.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fractions import Fraction

    from canon.flow.method.number_formats import Precision
    from canon.flow.method.solvable_splitting import SolvableSplitting
    from canon.kernel.llvm.loop import Loop
    from canon.kernel.llvm.number_types import MachineType
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = [
    "kept_boris",
    "kept_galerkin",
    "kept_gauss",
    "kept_lie_poisson",
    "kept_magnetic",
    "kept_mixing",
    "kept_nonholonomic",
    "kept_projecting",
    "kept_rattle",
    "kept_runge_kutta",
    "kept_solvable",
    "kept_splitting",
]

_KEPT = 64
"""Compiled loops of each family kept for the next call."""


@functools.lru_cache(maxsize=_KEPT)
def kept_splitting(
    system: HamiltonEquations, stages: int, number: MachineType, *, compensated: bool, kick_first: bool
) -> Loop:
    """Return the loop of a splitting with so many stages."""
    from canon.kernel.loops.splitting import splitting_loop

    return splitting_loop(system, stages, number=number, compensated=compensated, kick_first=kick_first)


@functools.lru_cache(maxsize=_KEPT)
def kept_runge_kutta(system: HamiltonEquations, number: MachineType, *, compensated: bool) -> Loop:
    """Return the loop of the classical Runge–Kutta method."""
    from canon.kernel.llvm.loop import runge_kutta_loop

    return runge_kutta_loop(system, number=number, compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def kept_gauss(
    system: HamiltonEquations, stages: int, number: MachineType, *, compensated: bool, newton: bool
) -> Loop:
    """Return the loop of a method with implicit stages, iterated or by Newton's method."""
    from canon.kernel.loops.gauss import gauss_loop

    return gauss_loop(system, stages, compensated=compensated, number=number, newton=newton)


@functools.lru_cache(maxsize=_KEPT)
def kept_mixing(system: HamiltonEquations, weights: int, number: MachineType, *, compensated: bool) -> Loop:
    """Return the loop of two copies of phase space that are mixed."""
    from canon.kernel.loops.doubled_phase_space import mixing_loop

    return mixing_loop(system, weights, number=number, compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def kept_projecting(
    system: HamiltonEquations, weights: int, number: MachineType, *, compensated: bool
) -> Loop:
    """Return the loop of two copies of phase space that are projected onto one another."""
    from canon.kernel.loops.doubled_phase_space import projecting_loop

    return projecting_loop(system, weights, number=number, compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def kept_rattle(system: HamiltonEquations, weights: int, number: MachineType, *, compensated: bool) -> Loop:
    """Return the loop that keeps holonomic constraints."""
    from canon.kernel.loops.rattle import rattle_loop

    assert system.holonomic is not None
    return rattle_loop(system, system.holonomic, weights, number=number, compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def kept_nonholonomic(
    system: HamiltonEquations, weights: int, number: MachineType, *, compensated: bool
) -> Loop:
    """Return the loop that keeps constraints on velocities."""
    from canon.kernel.loops.nonholonomic_leapfrog import nonholonomic_loop

    assert system.nonholonomic is not None
    return nonholonomic_loop(system, system.nonholonomic, weights, number=number, compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def kept_galerkin(
    system: HamiltonEquations, degree: int, points: int, number: MachineType, *, compensated: bool
) -> Loop:
    """Return the loop of a variational integrator with polynomials of this degree and so many points."""
    from canon.kernel.discrete_action.galerkin_step import galerkin_loop

    assert system.lagrangian is not None
    return galerkin_loop(system, system.lagrangian, degree, points, compensated=compensated, number=number)


@functools.lru_cache(maxsize=_KEPT)
def kept_lie_poisson(
    system: HamiltonEquations, weights: int, number: MachineType, *, compensated: bool
) -> Loop:
    """Return the loop of the turns and kicks of a Poisson system."""
    from canon.kernel.loops.lie_poisson import lie_poisson_loop

    assert system.lie_poisson is not None
    return lie_poisson_loop(system, system.lie_poisson, weights, number=number, compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def kept_boris(system: HamiltonEquations, weights: int, number: MachineType, *, compensated: bool) -> Loop:
    """Return the loop of Boris's method."""
    from canon.kernel.magnetic.boris import boris_loop
    from canon.kernel.magnetic.magnetic_form import magnetic_form

    return boris_loop(system, magnetic_form(system), weights, number=number, compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def kept_magnetic(system: HamiltonEquations, weights: int, number: MachineType, *, compensated: bool) -> Loop:
    """Return the loop of drifts between shifts of the gauge."""
    from canon.flow.fixed_step.gauge_integrals import gauge_shifts
    from canon.kernel.magnetic.gauge_shifts import gauge_shift_loop

    return gauge_shift_loop(system, gauge_shifts(system), weights, number=number, compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def kept_solvable(
    system: HamiltonEquations,
    method: SolvableSplitting,
    precision: Precision,
    vectors: int,
    units: tuple[Fraction, ...],
) -> Loop:
    """Return the loop of a splitting by solvable parts.

    Raises
    ------
    UnsolvableError
        H has no such parts, or bodies of different numbers of coordinates, or none about which planets move.
    """
    from canon.kernel.schemes.perturbed_schemes import corrector
    from canon.kernel.solvable.solvable_loop import solvable_loop
    from canon.kernel.solvable.solvable_parts import (
        Centres,
        Planets,
        UnsolvableError,
        named_part,
        solvable_part,
    )

    part = solvable_part(system) if method.parts is None else named_part(system, *method.parts)
    if isinstance(part, Planets | Centres) and len({len(body) for body in part.bodies}) > 1:
        raise UnsolvableError(
            "the bodies have different numbers of coordinates; give each as many, or name two parts"
        )
    chosen = corrector(method.scheme, method.corrector) if method.corrector else None
    democratic = method.coordinates == "democratic-heliocentric"
    if democratic and not isinstance(part, Planets):
        raise UnsolvableError(
            "democratic heliocentric coordinates are for planets about a star, which H is not"
        )
    return solvable_loop(
        part,
        len(system.q),
        method.kicks,
        chosen,
        compensated=precision.compensated,
        number=precision.number,
        democratic=democratic,
        vectors=vectors,
        units=units,
    )
