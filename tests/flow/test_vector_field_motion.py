"""Vector fields by the driver of heyoka's integrator that Hamiltonians have: pulses, first steps, first zeros."""

import numpy as np
import pytest
import sympy as sp

from canon import coordinates, time
from canon.flow.geometry.vector_field_motion import at_first_zero, sampled, vector_field_system
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.mechanics.hamilton.vector_field import VectorField

x, v = coordinates("x v")
PULSE = sp.exp(-(((time - 50) / sp.Rational(1, 100)) ** 2))


def final(field, y0, end, variations=0):
    system = vector_field_system(field, {})
    start = np.concatenate([y0, *([np.eye(len(y0))[0]] * variations)])
    return sampled(
        system, system.heyoka_pairs(variations), np.array([0.0, end]), start, variations=variations
    ).rows[-1]


@pytest.mark.parametrize("variations", [0, 1])
def test_a_short_pulse_is_not_stepped_over(variations):
    kicked = VectorField((v, PULSE), (x, v))
    found = final(kicked, np.zeros(2), 100.0, variations)
    speed = np.sqrt(np.pi) / 100
    np.testing.assert_allclose(found[:2], [50 * speed, speed], rtol=1e-13)
    assert found[2:].tolist() == [1.0, 0.0] * variations


def test_an_odd_number_of_variables_meets_its_pulse_too():
    (found,) = final(VectorField((PULSE,), (x,)), np.zeros(1), 100.0)
    assert found == pytest.approx(np.sqrt(np.pi) / 100, rel=1e-13)


def test_a_start_whose_symmetry_hides_coefficients_has_a_first_step_that_fits():
    """A pendulum released from the horizontal; by the energy, whose error was 2e-8."""
    angle, rate = final(VectorField((v, -sp.sin(x)), (x, v)), np.array([np.pi / 2, 0.0]), 1.0)
    assert abs(rate**2 / 2 - np.cos(angle)) < 4e-15


def test_the_first_zero_and_none():
    oscillator = vector_field_system(VectorField((v, -x), (x, v)), {})
    node = oscillator.node(x, "x")
    t, state, steps = at_first_zero(oscillator, node, np.array([1.0, 0.0]), 10.0)
    assert t == pytest.approx(np.pi / 2, rel=1e-14)
    assert state[1] == pytest.approx(-1, rel=1e-14)
    assert steps > 1
    with pytest.raises(NonFiniteStateError, match=r"does not vanish before t = 1\b"):
        at_first_zero(oscillator, node, np.array([1.0, 0.0]), 1.0)


def test_a_motion_that_ends_says_where():
    with pytest.raises(NonFiniteStateError, match=r"continued after t = 1 .*edge of") as lost:
        final(VectorField((x**2,), (x,)), np.array([1.0]), 2.0)
    assert lost.value.time == pytest.approx(1.0, rel=1e-12)
