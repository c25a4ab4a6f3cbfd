"""Tangent loop of a method: steps of an orbit with deviations beside it, compiled once, then kept."""

from __future__ import annotations

import dataclasses
import functools
import math
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.flow.fixed_step.compiled_loop import check_splitting, loop_by_solvable_parts
from canon.flow.method.composition import weights_of_order
from canon.flow.method.energy_keeping_method import AverageVectorField
from canon.flow.method.lie_poisson_splitting import LiePoissonSplitting
from canon.flow.method.method import Gauss, Splitting
from canon.kernel.llvm.machine_code import simd_bytes
from canon.kernel.loops.deviations import Deviations
from canon.kernel.loops.lie_poisson import lie_poisson_loop
from canon.kernel.loops.tangent_gauss import numbers_of_method, tangent_gauss_loop
from canon.kernel.loops.tangent_splitting import tangent_splitting_loop
from canon.kernel.program.program import exact_value

if TYPE_CHECKING:
    from canon.flow.method.method import Method
    from canon.flow.method.number_formats import Precision
    from canon.kernel.llvm.loop import Loop
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["TangentLoop", "has_tangent_loop", "tangent_loop"]

_KEPT = 32
"""Compiled loops kept for the next call."""

_STEPS_A_RADIAN = 3
"""Steps in which the angles of planets move by about a radian."""

_INTERLEAVED = 4
"""SIMD registers' worth of orbits stepped together, each with its deviations."""


@dataclasses.dataclass(frozen=True)
class TangentLoop:
    """A compiled loop, and how the deviations lie in what it works on.

    Parameters
    ----------
    loop, deviations
        The loop, and its deviations.
    units
        What each component of a deviation of (q, p) is multiplied with there, shape (2n,): lengths are those of what
        comes out. Empty where it is the deviation of (q, p) itself.
    """

    loop: Loop
    deviations: Deviations
    units: tuple[float, ...] = ()


def tangent_loop(
    system: HamiltonEquations,
    method: Method,
    precision: Precision,
    vectors: int,
    orbits: int = 1,
    *,
    step: float,
) -> TangentLoop:
    """Return the machine code that steps orbits with so many deviations each.

    Parameters
    ----------
    system, method, precision
        What to integrate, how, and in which numbers.
    vectors, orbits
        Deviations of each orbit, and how many orbits: many run side by side in SIMD lanes, else the deviations do.
    step
        The step size, by which times are measured where lengths of deviations ask for that.

    Raises
    ------
    ValueError
        H does not split.
    """
    number = precision.number
    registers = simd_bytes() // number.alignment
    state, size = 2 * len(system.q), 2 * (len(system.q) - system.varying)
    if isinstance(method, Gauss | AverageVectorField):
        kept = numbers_of_method(system, method.stages)
        deviations = Deviations(number, state, size, vectors, method=kept)
        newton = method.iteration == "newton"
        return _kept_gauss(
            system, method.stages, deviations, compensated=precision.compensated, newton=newton
        )
    if method.solvable is not None:
        units = _weights(system, step)
        loop = loop_by_solvable_parts(system, method.solvable, precision, vectors, units)
        own = loop.carry - state - size * vectors
        return TangentLoop(
            loop, Deviations(number, state, size, vectors, method=own), tuple(map(float, units))
        )
    lanes = 1
    if orbits > 1:
        number = dataclasses.replace(number, lanes=registers * _INTERLEAVED)
    if isinstance(method, LiePoissonSplitting):
        deviations = Deviations(number, state, len(system.rows), vectors)
        weights = len(weights_of_order(method.order))
        return _kept_lie_poisson(system, weights, deviations, compensated=precision.compensated)
    if orbits == 1:
        lanes = min(registers, 1 << (vectors - 1).bit_length())
    deviations = Deviations(number, state, size, vectors, lanes)
    assert isinstance(method, Splitting)
    check_splitting(system, method)
    kick_first = method.scheme.kick_first and system.autonomous
    stages, compensated = len(method.scheme.b), precision.compensated
    return _kept_splitting(system, stages, deviations, compensated=compensated, kick_first=kick_first)


def has_tangent_loop(method: Method) -> bool:
    """Tell whether the deviations of a method are compiled beside the orbit."""
    return method.family in ("splitting", "solvable", "gauss", "average_vector_field", "lie_poisson")


def _weights(system: HamiltonEquations, step: float) -> tuple[Fraction, ...]:
    """Return √(mω) for δq and 1/√(mω) for δp, rounded to powers of 2: they are of one size so, of light planets too.

    To multiply with them is a symplectic map. Where p is of no constant mass, m is 1; ω is an angle of about a radian
    in a few steps.
    """
    graph, weights = system.graph, list[Fraction]()
    for velocity, p in zip(system.velocity, system.p, strict=True):
        (inverse,) = graph.gradient(velocity, [p])
        known = exact_value(graph, inverse) if graph.is_constant(inverse) else Fraction(1)
        mass = 1 / known if known > 0 else Fraction(1)
        half = round(math.log2(float(mass) / (_STEPS_A_RADIAN * abs(step))) / 2)
        weights.append(Fraction(2) ** half)
    return (*weights, *(1 / weight for weight in weights))


@functools.lru_cache(maxsize=_KEPT)
def _kept_splitting(
    system: HamiltonEquations, stages: int, deviations: Deviations, *, compensated: bool, kick_first: bool
) -> TangentLoop:
    loop = tangent_splitting_loop(system, stages, deviations, compensated=compensated, kick_first=kick_first)
    return TangentLoop(loop, deviations)


@functools.lru_cache(maxsize=_KEPT)
def _kept_gauss(
    system: HamiltonEquations, stages: int, deviations: Deviations, *, compensated: bool, newton: bool
) -> TangentLoop:
    loop = tangent_gauss_loop(system, stages, deviations, compensated=compensated, newton=newton)
    return TangentLoop(loop, deviations)


@functools.lru_cache(maxsize=_KEPT)
def _kept_lie_poisson(
    system: HamiltonEquations, weights: int, deviations: Deviations, *, compensated: bool
) -> TangentLoop:
    assert system.lie_poisson is not None
    loop = lie_poisson_loop(
        system,
        system.lie_poisson,
        weights,
        compensated=compensated,
        number=deviations.number,
        deviations=deviations,
    )
    return TangentLoop(loop, deviations)
