"""Mass matrices that are singular, or nearly so: refused where no digit is left, their condition told otherwise."""

import numpy as np
import pytest
import sympy as sp

from canon import Lagrangian, coordinates
from canon.mechanics.at_scale.numeric_functions import acceleration_function, mass_condition_function
from canon.mechanics.at_scale.second_order import derivation_of_lagrangian

x, y = coordinates("x y")
u, v = x.dot, y.dot
GAP = sp.Symbol("epsilon", positive=True)


def near_singular():
    """M = [[1, 1], [1, 1 + ε]], forces (−x, −2 y)."""
    L = (u**2 + 2 * u * v + (1 + GAP) * v**2) / 2 - x**2 / 2 - y**2
    return derivation_of_lagrangian(Lagrangian(L, [x, y]))


@pytest.mark.parametrize("gap", [2.0**-20, 2.0**-40, 2.0**-44])
def test_the_condition_bounds_the_error(gap):
    equations = near_singular()
    found = acceleration_function(equations, {GAP: gap})([0.3, 0.7], [0.0, 0.0], 0.0)
    f, e = sp.Matrix([-sp.Rational(0.3), -2 * sp.Rational(0.7)]), sp.Rational(gap)
    exact = sp.Matrix([[1 + e, -1], [-1, 1]]) / e * f
    error = max(abs(sp.Rational(float(a)) - b) / abs(b) for a, b in zip(found, exact, strict=True))
    condition = mass_condition_function(equations, {GAP: gap})([0.3, 0.7], [0.0, 0.0], 0.0)
    assert float(error) <= 4 * condition * 2.0**-52
    assert np.isclose(condition, 4 / gap, rtol=1e-2)


@pytest.mark.parametrize("gap", [1e-17, 2.0**-52])
def test_no_digits_are_an_error(gap):
    with pytest.raises(ArithmeticError, match="the mass matrix is singular at this point"):
        acceleration_function(near_singular(), {GAP: gap})([0.3, 0.7], [0.0, 0.0], 0.0)


@pytest.mark.parametrize("size", [1e-6, 1e-200, 1e200])
def test_small_forces_find_a_singular_matrix_as_large_ones_do(size):
    with pytest.raises(ArithmeticError, match="the mass matrix is singular at this point"):
        acceleration_function(near_singular(), {GAP: 2.0**-52})([0.3 * size, 0.7 * size], [0.0, 0.0], 0.0)


def test_singular_only_up_to_rounding():
    """M = [[1, c], [c, c²]] with c = 1/10·3: rounding makes its determinant 10⁻¹⁷ rather than 0."""
    c = sp.Symbol("c", positive=True)
    L = (u + c * v) ** 2 / 2 - x**2 / 2 - y**2
    equations = derivation_of_lagrangian(Lagrangian(L, [x, y]))
    for value in (0.1 * 3, 0.7, 1 / 3, 1.1):
        with pytest.raises(ArithmeticError, match="singular"):
            acceleration_function(equations, {c: value})([0.3, 0.7], [0.0, 0.0], 0.0)


@pytest.mark.parametrize("ratio", [1e12, 1e-12, 1e100])
def test_masses_of_any_ratio_are_well_conditioned(ratio):
    m = sp.Symbol("m", positive=True)
    equations = derivation_of_lagrangian(Lagrangian(u**2 / 2 + m * v**2 / 2 - x**2 / 2 - y, [x, y]))
    found = acceleration_function(equations, {m: ratio})([0.5, 0.0], [0.0, 0.0], 0.0)
    assert found.tolist() == [-0.5, -1 / ratio]
    assert mass_condition_function(equations, {m: ratio})([0.5, 0.0], [0.0, 0.0], 0.0) == pytest.approx(1.0)


def test_the_condition_of_a_matrix_that_loses_a_row_is_infinite():
    L = Lagrangian(x**2 * u**2 / 2 + v**2 / 2 + u * v / 4, [x, y])
    condition = mass_condition_function(derivation_of_lagrangian(L), {})
    assert condition([0.0, 1.0], [0.0, 0.0], 0.0) == np.inf
    assert condition([float("nan"), 1.0], [0.0, 0.0], 0.0) == np.inf
    assert condition([1.0, 1.0], [0.0, 0.0], 0.0) == pytest.approx((1 + 1 / 4) / (1 - 1 / 4))
