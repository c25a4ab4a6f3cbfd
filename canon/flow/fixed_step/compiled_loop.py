"""Compiled loop of a fixed-step method: compiled once, then kept, with the coefficients that it reads."""

from __future__ import annotations

import dataclasses
import functools
from typing import TYPE_CHECKING, Any

from canon.flow.fixed_step.kept_loops import (
    kept_boris,
    kept_galerkin,
    kept_gauss,
    kept_lie_poisson,
    kept_magnetic,
    kept_mixing,
    kept_nonholonomic,
    kept_projecting,
    kept_rattle,
    kept_runge_kutta,
    kept_solvable,
    kept_splitting,
)
from canon.flow.fixed_step.partial_step import PartialSteps
from canon.flow.fixed_step.step_coefficients import step_coefficients
from canon.flow.method.composition import weights_of_order
from canon.kernel.llvm.machine_code import simd_bytes

if TYPE_CHECKING:
    from collections.abc import Callable
    from fractions import Fraction

    from canon.flow.method.constrained_method import NonholonomicLeapfrog, Rattle
    from canon.flow.method.energy_keeping_method import AverageVectorField
    from canon.flow.method.lie_poisson_splitting import LiePoissonSplitting
    from canon.flow.method.magnetic_methods import Boris, MagneticSplitting
    from canon.flow.method.method import RK4, Gauss, Method, Splitting
    from canon.flow.method.nonseparable_splitting import ExtendedPhaseSpace, SemiexplicitSplitting
    from canon.flow.method.number_formats import Precision
    from canon.flow.method.solvable_splitting import SolvableSplitting
    from canon.flow.method.variational_method import GalerkinVariational
    from canon.flow.run.sampling_plan import Plan
    from canon.kernel.llvm.loop import Loop
    from canon.kernel.llvm.number_types import MachineType
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["check_splitting", "compiled_loop", "loop_by_solvable_parts", "steps_between"]

_KEPT = 64
"""Steps between those of a run kept for the next call."""

_FEW_STOPS = 1001
"""What is read of plans with so many samples is kept for the next motion that has the same plan."""

_INTERLEAVED = 4
"""SIMD registers' worth of orbits stepped together: while one waits for a root or a quotient, others compute."""

_PLANE, _STAGES, _MANY = 2, 5, 1000
"""Of so many orbits twice as many are stepped together where roots and quotients are what takes the time, as in
Kepler's problem: in up to so many degrees of freedom, which the registers just hold, through so many stages a step."""

_SMALL = 200
"""Up to this many operations in the force the registers hold that many orbits."""


def compiled_loop(system: HamiltonEquations, method: Method, precision: Precision, orbits: int = 1) -> Loop:
    """Return the machine code that steps a system with a method, kept from an earlier call if there was one.

    Parameters
    ----------
    system, method, precision
        What to integrate, how, and in which numbers; a method with steps of one size.
    orbits
        How many orbits will be stepped together: several run side by side in SIMD lanes.

    Raises
    ------
    ValueError
        A splitting is asked of a Hamiltonian that does not split, or a Nyström method of one whose kinetic energy
        is not quadratic.
    """
    return _LOOPS[method.family](system, method, precision, orbits)


def _gauss(
    system: HamiltonEquations, method: Gauss | AverageVectorField, precision: Precision, _orbits: int
) -> Loop:
    newton = method.iteration == "newton"
    return kept_gauss(
        system, method.stages, precision.number, compensated=precision.compensated, newton=newton
    )


def _extended(
    system: HamiltonEquations, method: ExtendedPhaseSpace, precision: Precision, orbits: int
) -> Loop:
    number = _with_lanes(precision.number, system, orbits, 0)
    return kept_mixing(system, len(weights_of_order(method.order)), number, compensated=precision.compensated)


def _semiexplicit(
    system: HamiltonEquations, method: SemiexplicitSplitting, precision: Precision, _orbits: int
) -> Loop:
    return kept_projecting(
        system, len(weights_of_order(method.order)), precision.number, compensated=precision.compensated
    )


def _rattle(system: HamiltonEquations, method: Rattle, precision: Precision, _orbits: int) -> Loop:
    if system.holonomic is None:
        raise ValueError(
            "Rattle keeps the constraints of a ConstrainedLagrangian, and this is none; Splitting, Gauss and Taylor "
            "apply"
        )
    weights = len(weights_of_order(method.order))
    return kept_rattle(system, weights, precision.number, compensated=precision.compensated)


def _nonholonomic(
    system: HamiltonEquations, method: NonholonomicLeapfrog, precision: Precision, _orbits: int
) -> Loop:
    if system.nonholonomic is None:
        raise ValueError(
            "NonholonomicLeapfrog keeps the constraints on velocities of a ConstrainedLagrangian, and this is none; "
            "Splitting, Gauss and Taylor apply"
        )
    weights = len(weights_of_order(method.order))
    return kept_nonholonomic(system, weights, precision.number, compensated=precision.compensated)


def _galerkin(
    system: HamiltonEquations, method: GalerkinVariational, precision: Precision, _orbits: int
) -> Loop:
    if system.lagrangian is None:
        raise ValueError(
            "GalerkinVariational is for a Lagrangian, with its forces, and this is none; Splitting, Gauss and Taylor "
            "apply"
        )
    return kept_galerkin(
        system, method.degree, method.nodes, precision.number, compensated=precision.compensated
    )


def _lie_poisson(
    system: HamiltonEquations, method: LiePoissonSplitting, precision: Precision, orbits: int
) -> Loop:
    if system.lie_poisson is None:
        raise ValueError(
            "LiePoissonSplitting moves a PoissonSystem, such as canon.mechanics.rotating_body(…), and this is none; "
            "Splitting, Gauss and Taylor apply"
        )
    number, weights = _with_lanes(precision.number, system, orbits, 0), len(weights_of_order(method.order))
    return kept_lie_poisson(system, weights, number, compensated=precision.compensated)


def _boris(system: HamiltonEquations, method: Boris, precision: Precision, orbits: int) -> Loop:
    number, weights = _with_lanes(precision.number, system, orbits, 0), len(weights_of_order(method.order))
    return kept_boris(system, weights, number, compensated=precision.compensated)


def _magnetic(
    system: HamiltonEquations, method: MagneticSplitting, precision: Precision, orbits: int
) -> Loop:
    number, weights = _with_lanes(precision.number, system, orbits, 0), len(weights_of_order(method.order))
    return kept_magnetic(system, weights, number, compensated=precision.compensated)


def _runge_kutta(system: HamiltonEquations, _method: RK4, precision: Precision, orbits: int) -> Loop:
    number = _with_lanes(precision.number, system, orbits, 0)
    return kept_runge_kutta(system, number, compensated=precision.compensated)


def check_splitting(system: HamiltonEquations, method: Splitting) -> None:
    """Refuse Hamiltonians that a splitting does not apply to.

    Raises
    ------
    ValueError
        H does not split, or a Nyström method is given a kinetic energy that is not quadratic.
    """
    if not system.separable:
        raise ValueError(
            "H is not separable, T(p, t) + V(q, t), so it does not split into drifts and kicks; use Gauss(6), "
            "SemiexplicitSplitting(4) or ExtendedPhaseSpace(4, omega=…), which are symplectic for every H, or Taylor()"
        )
    if method.scheme.nystrom and not system.quadratic_kinetic:
        raise ValueError(
            f"{method} keeps its order only for kinetic energies quadratic in p with constant coefficients; "
            "use Splitting('blanes-moan-6') or Splitting('kahan-li-8')"
        )


def _splitting(system: HamiltonEquations, method: Splitting, precision: Precision, orbits: int) -> Loop:
    check_splitting(system, method)
    stages = len(method.scheme.b)
    number = _with_lanes(precision.number, system, orbits, 0 if precision.compensated else stages)
    kick_first = method.scheme.kick_first and system.autonomous
    return kept_splitting(system, stages, number, compensated=precision.compensated, kick_first=kick_first)


def _solvable(
    system: HamiltonEquations, method: Splitting | SolvableSplitting, precision: Precision, _orbits: int
) -> Loop:
    assert method.solvable is not None
    return loop_by_solvable_parts(system, method.solvable, precision)


def loop_by_solvable_parts(
    system: HamiltonEquations,
    method: SolvableSplitting,
    precision: Precision,
    vectors: int = 0,
    units: tuple[Fraction, ...] = (),
) -> Loop:
    """Return the machine code of a splitting by solvable parts, with so many deviations beside each orbit.

    Parameters
    ----------
    system, method, precision
        What to integrate, how, and in which numbers.
    vectors, units
        Deviations of each orbit, the last numbers in e, and what their components are multiplied with there.

    Raises
    ------
    UnsolvableError
        H has no such parts, depends on t, or has parameters that differ by orbit.
    """
    from canon.kernel.solvable.solvable_parts import UnsolvableError

    if not system.autonomous:
        raise UnsolvableError(
            "H depends on t: splittings by solvable parts are for H(q, p); use Splitting('kahan-li-8')"
        )
    if system.varying:
        raise UnsolvableError(
            "parameters that differ by orbit: splittings by solvable parts take one number for each"
        )
    return kept_solvable(system, method, precision, vectors, units)


_LOOPS: dict[str, Callable[[HamiltonEquations, Any, Precision, int], Loop]] = {
    "splitting": _splitting,
    "solvable": _solvable,
    "gauss": _gauss,
    "average_vector_field": _gauss,
    "rk4": _runge_kutta,
    "extended_phase_space": _extended,
    "semiexplicit": _semiexplicit,
    "rattle": _rattle,
    "nonholonomic_leapfrog": _nonholonomic,
    "galerkin": _galerkin,
    "lie_poisson": _lie_poisson,
    "boris": _boris,
    "magnetic": _magnetic,
}
"""What compiles the methods of each family."""


def _with_lanes(number: MachineType, system: HamiltonEquations, orbits: int, stages: int) -> MachineType:
    if orbits == 1 or number.scalar == "x86_fp80":  # x87 numbers have no SIMD instructions
        return number
    if system.loops is not None:
        return dataclasses.replace(number, lanes=simd_bytes() // number.alignment)
    registers, force = 1, system.program(system.force)
    if len(force.instructions) <= _SMALL:
        waiting = force.count("sqrt") + force.count("div") > 0 and not number.pair
        many = waiting and len(system.q) <= _PLANE and stages >= _STAGES and orbits >= _MANY
        registers = 2 * _INTERLEAVED if many else _INTERLEAVED
    return dataclasses.replace(number, lanes=simd_bytes() // number.alignment * registers)


def steps_between(loop: Loop, method: Method, plan: Plan) -> PartialSteps:
    """Return what takes steps of any length between those of a run."""
    return (_kept_steps if len(plan.stops) <= _FEW_STOPS else _steps)(loop, method, plan)


def _steps(loop: Loop, method: Method, plan: Plan) -> PartialSteps:
    assert plan.h is not None
    coefficients = loop.coefficients or step_coefficients(method, loop.number)
    return PartialSteps(loop, coefficients, plan.start, plan.h)


_kept_steps = functools.lru_cache(maxsize=_KEPT)(_steps)
