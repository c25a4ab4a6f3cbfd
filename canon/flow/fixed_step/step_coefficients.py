"""Coefficients of a step: what the compiled loop of each method reads beside the time and the size of a step."""

from __future__ import annotations

import functools
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from canon.flow.method.composition import weights_of_order
from canon.kernel.loops.doubled_phase_space import mixing_coefficients, projecting_coefficients
from canon.kernel.schemes.average_vector_field import average_coefficients
from canon.kernel.schemes.galerkin_tableau import galerkin_coefficients
from canon.kernel.schemes.gauss_tableau import gauss_coefficients
from canon.kernel.schemes.splitting_schemes import SCHEMES

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.flow.method.constrained_method import NonholonomicLeapfrog, Rattle
    from canon.flow.method.energy_keeping_method import AverageVectorField
    from canon.flow.method.lie_poisson_splitting import LiePoissonSplitting
    from canon.flow.method.magnetic_methods import Boris, MagneticSplitting
    from canon.flow.method.method import RK4, Gauss, Method, Splitting
    from canon.flow.method.nonseparable_splitting import ExtendedPhaseSpace, SemiexplicitSplitting
    from canon.flow.method.variational_method import GalerkinVariational
    from canon.kernel.llvm.number_types import MachineType

__all__ = ["step_coefficients"]

_KEPT = 64
"""Steps of named splittings kept for the next call."""


def step_coefficients(method: Method, number: MachineType) -> Callable[[Fraction], list[Fraction]]:
    """Return the coefficients of a method as a function of the size of a step, where its loop does not say them."""
    return functools.partial(_COEFFICIENTS[method.family], method, number)


def _of_gauss(method: Gauss, number: MachineType, h: Fraction) -> list[Fraction]:
    return gauss_coefficients(method.stages, h, number)


def _of_average(method: AverageVectorField, number: MachineType, h: Fraction) -> list[Fraction]:
    return average_coefficients(method.degree, method.stages, h, number)


def _of_runge_kutta(_method: RK4, _number: MachineType, h: Fraction) -> list[Fraction]:
    return [h / 2, h / 6, h / 3]


def _of_splitting(method: Splitting, _number: MachineType, h: Fraction) -> list[Fraction]:
    name = method.scheme.name
    return list(_of_named_splitting(name, h)) if name else _times_step(method.scheme.a, method.scheme.b, h)


@functools.lru_cache(maxsize=_KEPT)
def _of_named_splitting(name: str, h: Fraction) -> tuple[Fraction, ...]:
    return tuple(_times_step(SCHEMES[name].a, SCHEMES[name].b, h))


def _times_step(a: Sequence[Fraction], b: Sequence[Fraction], h: Fraction) -> list[Fraction]:
    return [h * c for pair in zip(a, b, strict=False) for c in pair] + [h * a[-1]]


def _of_extended(method: ExtendedPhaseSpace, _number: MachineType, h: Fraction) -> list[Fraction]:
    return mixing_coefficients(weights_of_order(method.order), Fraction(method.omega), h)


def _of_composition(
    method: Rattle | NonholonomicLeapfrog | LiePoissonSplitting | Boris | MagneticSplitting,
    _number: MachineType,
    h: Fraction,
) -> list[Fraction]:
    return [h * weight for weight in weights_of_order(method.order)]


def _of_galerkin(method: GalerkinVariational, number: MachineType, h: Fraction) -> list[Fraction]:
    return galerkin_coefficients(method.degree, method.nodes, method.quadrature, h, number)


def _of_semiexplicit(method: SemiexplicitSplitting, _number: MachineType, h: Fraction) -> list[Fraction]:
    return projecting_coefficients(weights_of_order(method.order), h)


_COEFFICIENTS: dict[str, Callable[[Any, MachineType, Fraction], list[Fraction]]] = {
    "splitting": _of_splitting,
    "gauss": _of_gauss,
    "average_vector_field": _of_average,
    "rk4": _of_runge_kutta,
    "extended_phase_space": _of_extended,
    "semiexplicit": _of_semiexplicit,
    "rattle": _of_composition,
    "nonholonomic_leapfrog": _of_composition,
    "galerkin": _of_galerkin,
    "lie_poisson": _of_composition,
    "boris": _of_composition,
    "magnetic": _of_composition,
}
"""What a step of each family reads, where the loop does not say it."""
