"""Drift of formal integrals along orbits: the power that theory says, and that of a wrong twin."""

from dataclasses import replace

import pytest
import sympy as sp

from canon import Hamiltonian, birkhoff_normal_form
from canon.mechanics import formal_integral
from canon.study import integral_drift

x, y, px, py = sp.symbols("x y p_x p_y", real=True)
H = Hamiltonian((px**2 + py**2 + x**2 + 2 * y**2) / 2 + x**2 * y, [x, y], [px, py])
DIRECTION = [1, 0.5, 0, 1]


@pytest.mark.parametrize("order", [2, 4, 6])
def test_the_drift_grows_with_the_power_after_the_order(order):
    seen = integral_drift(formal_integral(birkhoff_normal_form(H, order), [1, 0]), DIRECTION)
    assert seen.expected == order + 1
    assert all(seen.above_rounding)
    assert abs(seen.slope - (order + 1)) < 0.25


def test_a_wrong_coefficient_drifts_with_its_own_power():
    right = formal_integral(birkhoff_normal_form(H, 6), [1, 0])
    wrong = replace(right, parts={**right.parts, 4: right.parts[4].times(2)})
    seen = integral_drift(wrong, DIRECTION)
    assert seen.expected == 4
    assert abs(seen.slope - 4) < 0.25


def test_an_equilibrium_elsewhere_is_where_the_starts_are():
    moved = Hamiltonian(H.H.subs({x: x - 3}), [x, y], [px, py])
    right = formal_integral(birkhoff_normal_form(moved, 4, at={x: 3}), [1, 0])
    here = formal_integral(birkhoff_normal_form(H, 4), [1, 0])
    there, at_home = (integral_drift(f, DIRECTION, [0.05, 0.1]).drifts for f in (right, here))
    for a, b in zip(there, at_home, strict=True):
        assert abs(a / b - 1) < 1e-3


def test_a_direction_of_zeros_is_refused():
    with pytest.raises(ValueError, match="not all zero"):
        integral_drift(formal_integral(birkhoff_normal_form(H, 2), [1, 0]), [0, 0, 0, 0])
