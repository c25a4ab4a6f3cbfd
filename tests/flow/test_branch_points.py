"""Roots that come down to zero: the Taylor method does not go on by the other root."""

import numpy as np
import pytest
import sympy as sp
from sympy import Rational, sqrt, symbols

from canon import Event, Hamiltonian, Lagrangian, VectorField, coordinates, propagate
from canon.flow import AccuracyWarning, NonFiniteStateError

u, v = symbols("u v", real=True)
U = symbols("U", real=True)
DRAINING = VectorField([-sqrt(u)], [u])


@pytest.mark.parametrize("end", [2.5, 2.9, 3, 3.1, 4, 6])
@pytest.mark.parametrize("precision", ["double", "quad"])
def test_a_tank_that_is_empty_does_not_fill_again(end, precision):
    """Torricelli: u = (1 − t/2)² until t = 2."""
    with pytest.raises(NonFiniteStateError) as lost:
        propagate(DRAINING, (0, end), [1.0], precision=precision)
    assert lost.value.time == pytest.approx(2, abs=1e-6)
    assert abs(lost.value.state[0]) < 1e-12


def test_the_same_of_functions_several_variables_and_backwards():
    with pytest.raises(NonFiniteStateError, match="sqrt"):
        propagate(lambda t, y: -np.sqrt(y), (0, 3), [1.0])
    two = VectorField([-sqrt(u), -(v ** Rational(3, 2)) + u], [u, v])
    with pytest.raises(NonFiniteStateError, match=r"sqrt\(u\) comes down to zero"):
        propagate(two, (0, 3), [1.0, 1.0])
    with pytest.raises(NonFiniteStateError, match="after t = -2 "):
        propagate(VectorField([sqrt(u)], [u]), (0, -3), [1.0])


def test_of_many_orbits_the_first_that_meets_it_is_named():
    tanks = np.array([[9.0, 1.0, 4.0]])
    with pytest.raises(NonFiniteStateError, match=r"orbit 1: .* after t = 2 .*goes on as the other root"):
        propagate(DRAINING, (0, 3), tanks)
    before = propagate(DRAINING, (0, 1), tanks)
    assert before.final == pytest.approx((np.sqrt(tanks) - 0.5) ** 2, rel=1e-14)
    assert before.resume(1.9).final == pytest.approx((np.sqrt(tanks) - 0.95) ** 2, rel=1e-11)
    with pytest.raises(NonFiniteStateError, match="orbit 1"):
        before.resume(3)


def test_before_it_and_at_an_event_there_all_is_well():
    before = propagate(DRAINING, (0, 1.9), [1.0])
    assert before.final[0] == pytest.approx(0.05**2, rel=1e-12)
    assert before.events == ()
    stopped = propagate(DRAINING, (0, 3), [1.0], events=[Event(u - Rational(1, 4), action="stop")])
    assert stopped.t[-1] == pytest.approx(1, rel=1e-14)
    half = propagate(DRAINING, (0, 1), [1.0])
    assert half.resume(1.9).final[0] == pytest.approx(0.05**2, rel=1e-12)
    with pytest.raises(NonFiniteStateError):
        half.resume(3)


def test_roots_that_stay_positive_are_no_branch_points():
    x = coordinates("x")
    bowl = Hamiltonian(x.momentum**2 / 2 - sqrt(4 - x**2), [x], [x.momentum])
    motion = propagate(bowl, (0, 100), [1.5, 0.3])
    assert motion.events == ()
    assert abs(motion.energy_error).max() < 1e-14
    relativistic = Hamiltonian(sqrt(1 + x.momentum**2) + x**2 / 2, [x], [x.momentum])
    assert abs(propagate(relativistic, (0, 100), [1.5, 0.3]).energy_error).max() < 1e-14


def test_a_root_of_a_velocity_beside_the_work_that_is_followed():
    x = coordinates("x")
    with pytest.raises(NonFiniteStateError, match="after t = 2 where") as lost:
        propagate(Lagrangian(x.dot**2 / 2, [x], forces=[-sqrt(x.dot)]), (0, 5), [0.0, 1.0])
    assert lost.value.state == pytest.approx([2 / 3, 0], abs=1e-10)


@pytest.mark.parametrize(("potential", "where"), [(sp.acos(sp.cos(U)), 0), (sp.asin(sp.sin(U)), np.pi / 2)])
def test_kinks_that_arcs_make_end_the_motion(potential, where):
    x = coordinates("x")
    wave = Hamiltonian(x.momentum**2 / 2 + potential.subs(U, x), [x], [x.momentum])
    with pytest.raises(NonFiniteStateError) as lost:
        propagate(wave, (0, 20), [0.5, 2.1])
    assert lost.value.state[0] == pytest.approx(where, abs=1e-6)


def test_what_series_do_not_show_is_told_by_the_energy():
    """Beside x = 0.1 a double does not tell √(x² + 1e-24) from x, whose series goes on as −|x| beyond 0."""
    x = coordinates("x")
    sharp = Hamiltonian(x.momentum**2 / 2 + sqrt(x**2 + Rational(1, 10**24)), [x], [x.momentum])
    with pytest.warns(AccuracyWarning, match="the energy changes by"):
        propagate(sharp, (0, 20), [0.5, 2.1])
