"""erf and erfc in Hamiltonians and Lagrangians: every method and precision against mpmath."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp

from canon import Event, Hamiltonian, Lagrangian, coordinates, propagate
from canon.expression.graph.graph import Graph
from canon.expression.graph.number_systems import FLOAT64, LONGDOUBLE, multiprecision
from canon.expression.graph.python_source import python_function

x = coordinates("x")
p = x.momentum
t = sp.Symbol("t", real=True)
well = Hamiltonian(p**2 / 2 + sp.erf(x) ** 2 / 2 + sp.erfc(x) / 5, [x], [p])


def _by_mpmath() -> np.ndarray[Any, Any]:
    with mpmath.workdps(30):

        def rates(_: Any, y: Any) -> list[Any]:
            bell = mpmath.exp(-(y[0] ** 2)) / mpmath.sqrt(mpmath.pi)
            return [y[1], -2 * bell * mpmath.erf(y[0]) + mpmath.mpf(2) / 5 * bell]

        solution = mpmath.odefun(rates, 0, [mpmath.mpf(1) / 2, mpmath.mpf(0)], tol=mpmath.mpf(10) ** -24)
        return np.array([float(value) for value in solution(3)])


TRUE = _by_mpmath()


@pytest.mark.parametrize(
    ("how", "near"),
    [
        ({}, 1e-15),
        ({"precision": "extended"}, 3e-16),
        ({"precision": "quad"}, 3e-16),
        ({"precision": 40}, 3e-16),
        ({"method": "DOP853"}, 1e-11),
        ({"method": "kahan-li-8", "step": 0.05}, 1e-14),
        ({"method": "kahan-li-8", "step": 0.05, "precision": "extended"}, 1e-14),
        ({"method": "kahan-li-8", "step": 0.05, "precision": "single"}, 1e-5),
        ({"method": "gauss-6", "step": 0.05}, 1e-13),
        ({"method": "RK4", "step": 0.01}, 1e-8),
    ],
)
def test_a_well_of_error_functions(how: dict[str, Any], near: float) -> None:
    motion = propagate(well, (0, 3), [0.5, 0], samples=20, **how)
    assert abs(motion.final - TRUE).max() < near
    assert abs(motion.energy_error).max() < 10 * near


def test_the_twin_with_another_sign_moves_otherwise() -> None:
    twin = Hamiltonian(p**2 / 2 + sp.erf(x) ** 2 / 2 - sp.erfc(x) / 5, [x], [p])
    assert abs(propagate(twin, (0, 3), [0.5, 0], samples=20).final - TRUE).max() > 0.1


def test_double_double_says_what_to_take() -> None:
    with pytest.raises(ValueError, match=r"no erf in double-double.*quad"):
        propagate(well, (0, 3), [0.5, 0], method="verlet", step=0.1, precision="double-double")


@pytest.mark.parametrize("method", ["taylor", "DOP853"])
@pytest.mark.parametrize("width", ["1/10", "1/100", "1/10000"])
@pytest.mark.parametrize("function", [sp.erf, lambda u: 1 - sp.erfc(u)])
def test_a_narrow_switch_in_time_is_not_passed_over(method: str, width: str, function: Any) -> None:
    # A force that is 0 before t = 50 and 1 after it gives p = 10 at t = 60, x = 50 + w²/4.
    switch = (1 + function((t - 50) / sp.Rational(width))) / 2
    motion = propagate(Hamiltonian(p**2 / 2 - x * switch, [x], [p]), (0, 60), [0, 0], method=method)
    assert abs(motion.final - [50 + float(sp.Rational(width)) ** 2 / 4, 10]).max() < 1e-9


def test_a_lagrangian_with_friction_balances_its_energy_and_meets_events() -> None:
    rubbed = Lagrangian(x.dot**2 / 2 - sp.erf(x) ** 2, [x], forces=[-x.dot * sp.erfc(x) / 10])
    motion = propagate(rubbed, (0, 10), [0.5, 0], events=[Event(sp.erf(x))])
    assert abs(motion.energy_error).max() < 1e-14
    assert abs(np.array([met.y[0] for met in motion.events])).max() < 1e-14
    assert motion.error_estimate().relative[-1] < 1e-13


@pytest.mark.parametrize("at", [-7.5, -0.3, 0.0, 1e-9, 0.7, 3.0, 6.0, 20.0])
def test_values_and_slopes_in_every_number_system(at: float) -> None:
    graph = Graph()
    for function in (sp.erf, sp.erfc):
        node = graph.from_sympy(function(x))
        slope = graph.derivative(node, x)
        with mpmath.workdps(50):
            bell = 2 * mpmath.exp(-(mpmath.mpf(at) ** 2)) / mpmath.sqrt(mpmath.pi)
            exact = [getattr(mpmath, function.__name__)(at), bell if function is sp.erf else -bell]
            # exp(−x²) rounds its argument
            for system, near in ((FLOAT64, 4e-16), (LONGDOUBLE, 4e-16), (multiprecision(40), 1e-30)):
                found = graph.evaluate([node, slope], {x: system.number(Fraction(at))}, system)
                for value, right in zip(found, exact, strict=True):
                    missed = abs(mpmath.mpf(str(value)) - right)
                    assert missed <= near * (1 + at**2) * abs(right) + mpmath.mpf(10) ** -320
        made = python_function(graph, [node], [x])
        assert abs(made([at])[0] - float(exact[0])) <= 4e-16 * abs(float(exact[0]))
        assert graph.to_sympy(node) == function(x)


def test_long_doubles_have_their_own_digits() -> None:
    graph = Graph()
    node = graph.from_sympy(sp.erf(x))
    (found,) = graph.evaluate([node], {x: np.array([0.5, 1.5], dtype=np.longdouble)}, LONGDOUBLE)
    with mpmath.workdps(40):
        for value, at in zip(found, (0.5, 1.5), strict=True):
            above, below = value.as_integer_ratio()
            miss = abs(mpmath.mpf(above) / below - mpmath.erf(at))
            assert miss < 2 * float(np.finfo(np.longdouble).eps)


def test_functions_nested_deeper_than_pythons_compiler_reads():
    graph, x = Graph(), sp.Symbol("x")
    node, value = graph.from_sympy(x), 0.5
    for _ in range(250):
        node, value = graph.function("sin", node), math.sin(value)
    assert python_function(graph, [node], [x])((0.5,)) == (value,)
