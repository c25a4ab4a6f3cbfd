"""What a careful reader of the equations of motion and the kernel found, each beside what must go on working."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from canon import DOP853, Event, Gauss, Hamiltonian, Lagrangian, coordinates, parameters, propagate
from canon.expression.graph.graph import Graph
from canon.expression.symbols.symbol import acceleration, time
from canon.flow import AccuracyWarning, WisdomHolman
from canon.kernel.magnetic.magnetic_form import NotMagneticError, magnetic_form
from canon.kernel.program.hamilton_equations import equations, exact_number
from canon.kernel.program.program import exact_value
from canon.kernel.solvable.solvable_parts import Planets, UnsolvableError, solvable_part
from canon.mechanics import GibbsAppell, Particle, UnilateralLagrangian
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian

x, y, a, b = coordinates("x y a b")

# pairs of planets that stand twice -----------------------------------------------------------------

X0, Y0, X1, Y1 = coordinates("x_0 y_0 x_1 y_1")
PLACES = (X0, Y0, X1, Y1)
MOMENTA = tuple(s.momentum for s in PLACES)
LIGHT = sp.Rational(1, 100)
KINETIC = (MOMENTA[0] ** 2 + MOMENTA[1] ** 2) / 2 + (MOMENTA[2] ** 2 + MOMENTA[3] ** 2) / (2 * LIGHT)
THERE = 1 / sp.sqrt((X0 - X1) ** 2 + (Y0 - Y1) ** 2)
BACK = 1 / sp.sqrt((X1 - X0) ** 2 + (Y1 - Y0) ** 2)


def attraction(potential: sp.Expr) -> Fraction:
    part = solvable_part(equations(KINETIC + potential, PLACES, MOMENTA, time, {}))
    assert isinstance(part, Planets)
    return part.attractions[0][1]


def test_a_pair_that_stands_twice_attracts_twice():
    assert attraction(-LIGHT * THERE) == Fraction(1, 100)
    assert attraction(-LIGHT * (THERE + BACK) / 2) == Fraction(1, 100)
    assert attraction(-LIGHT * THERE + BACK / 500) == Fraction(1, 125)
    with pytest.raises(UnsolvableError, match="not attracted"):
        attraction(-LIGHT * THERE + BACK * LIGHT)


def test_planets_written_as_half_of_all_pairs_move_as_those_of_each_pair_once():
    start = [0, 0, 1, 0, 0, -0.01, 0, 0.01]
    once, twice = (
        propagate(
            Hamiltonian(KINETIC + V, PLACES, MOMENTA),
            (0, 3),
            start,
            method=WisdomHolman(),
            step=0.1,
            samples=3,
        )
        for V in (-LIGHT * THERE, -LIGHT * (THERE + BACK) / 2)
    )
    np.testing.assert_allclose(once.y, twice.y, rtol=1e-13, atol=1e-13)


# impacts where masses depend on velocities ----------------------------------------------------------


def test_masses_that_depend_on_velocities_do_not_bounce_as_constant_ones():
    fast = Lagrangian(-sp.sqrt(1 - x.dot**2 - y.dot**2), [x, y])
    with pytest.raises(ValueError, match="masses depend on the velocities"):
        propagate(fast, (0, 3), [0, 0, 0.3, 0.3], events=[Event(x - 1, 0, "bounce")])
    turned = propagate(fast, (0, 3), [0, 0, 0.5, 0.3], events=[Event(x - 1, 0, {x.dot: -x.dot})])
    np.testing.assert_allclose(turned.final, [0.5, 0.9, -0.5, 0.3], rtol=1e-12)
    contact = UnilateralLagrangian(fast, [1 - x], restitution=1)
    with pytest.raises(ValueError, match="leave out its restitution"):
        propagate(contact, (0, 3), [0, 0, 0.5, 0.3])
    with pytest.warns(AccuracyWarning, match="the motion ends at t = 2"):
        propagate(UnilateralLagrangian(fast, [1 - x]), (0, 3), [0, 0, 0.5, 0.3])


def test_impacts_along_a_straight_line_are_known_whatever_the_mass():
    fast = Lagrangian(-sp.sqrt(1 - x.dot**2), [x])
    moved = propagate(fast, (0, 3), [0, 0.5], events=[Event(x - 1, 0, "bounce")])
    np.testing.assert_allclose(moved.final, [0.5, -0.5], rtol=1e-12)
    with pytest.raises(ValueError, match="masses depend on the velocities"):
        propagate(fast, (0, 3), [0, 0.5], events=[Event(x - 1 + time / 10, 0, "bounce")])
    slow = Lagrangian(x.dot**2 / 2, [x])
    moved = propagate(slow, (0, 3), [0, 0.5], events=[Event(x - 1 + time / 10, 0, "bounce")])
    assert moved.final[1] == pytest.approx(-0.7, rel=1e-12)
    beside = Lagrangian(-sp.sqrt(1 - x.dot**2) + (1 + x**2) * y.dot**2 / 2, [x, y])
    moved = propagate(beside, (0, 3), [0, 0, 0, 0.5], events=[Event(y - 1, 0, "bounce")])
    assert abs(moved.energy_error).max() < 1e-13


# contacts ------------------------------------------------------------------------------------------


def test_a_contact_that_nothing_presses_is_closed():
    row = UnilateralLagrangian(Lagrangian((a.dot**2 + b.dot**2) / 2, [a, b]), [a, b - a], restitution=0)
    with pytest.warns(AccuracyWarning, match="t = 3, .* while another contact is closed"):
        motion = propagate(row, (0, 6), [1, 3, -1, -1])
    np.testing.assert_allclose(motion.final, [0, 0, 0, -1], atol=1e-12)
    assert [r.closed for r in motion.regimes] == [(), (1,)]


def test_a_contact_that_is_pressed_closes_and_one_that_is_pulled_opens():
    for force, start, height in ((-1, [0.5, 0], 0.0), (1, [0.25, -1], (1 + np.sqrt(0.5)) ** 2 / 2)):
        ball = UnilateralLagrangian(Lagrangian(y.dot**2 / 2 + force * y, [y]), [y], restitution=0)
        assert propagate(ball, (0, 2), start).final[0] == pytest.approx(height, abs=1e-9)


def test_backwards_a_ball_moves_away_from_the_wall_that_it_is_about_to_strike():
    free = Lagrangian(y.dot**2 / 2 - 2 * y, [y])
    for restitution in (None, 1):
        ball = UnilateralLagrangian(free, [y], restitution)
        np.testing.assert_allclose(propagate(ball, (1, 0), [0, -2]).final, [1, 0], atol=1e-10)
        with pytest.raises(ValueError, match=r"moves into a wall.*time runs back"):
            propagate(ball, (1, 0), [0, 2])
        with pytest.raises(ValueError, match="moves into a wall: y = 0"):
            propagate(ball, (0, 1), [0, -2])


def test_samples_that_all_stand_at_impacts_are_no_way_into_the_wall():
    ball = UnilateralLagrangian(Lagrangian(y.dot**2 / 2 - 2 * y, [y]), [y], restitution=1)
    for samples in (1, 3):
        motion = propagate(ball, (0, 3), [0, 1], samples=samples)
        assert [met.t for met in motion.events[:2]] == pytest.approx([1, 2])
        assert abs(motion.y[0]).max() < 1e-13


# Gibbs and Appell ----------------------------------------------------------------------------------


def test_a_charge_of_gibbs_and_appell_keeps_its_energy():
    charge = GibbsAppell([Particle(1, (x, y))], [x, y], V=-(x * y.dot - y * x.dot))
    motion = propagate(charge, (0, 3), [1, 0, 0, 0.3])
    assert abs(motion.energy_error).max() < 1e-13
    np.testing.assert_allclose(motion.energy, 0.045, rtol=1e-12)
    held = GibbsAppell([Particle(1, (x, y))], [x, y], V=(x**2 + y**2) / 2)
    np.testing.assert_allclose(propagate(held, (0, 3), [1, 0, 0, 0.3]).energy, 0.545, rtol=1e-12)


def test_a_charge_in_quasi_velocities_keeps_its_energy():
    u, w = sp.symbols("u w", real=True)
    skew = [u + w / 2, w]
    charge = GibbsAppell([Particle(1, (x, y))], [x, y], -(x * y.dot - y * x.dot), [u, w], skew)
    plain = GibbsAppell([Particle(1, (x, y))], [x, y], V=-(x * y.dot - y * x.dot))
    turned, along = propagate(charge, (0, 3), [1, 0, -0.15, 0.3]), propagate(plain, (0, 3), [1, 0, 0, 0.3])
    np.testing.assert_allclose(turned.final[:2], along.final[:2], rtol=1e-11)
    np.testing.assert_allclose(turned.energy, 0.045, rtol=1e-11)


def test_forces_that_hold_accelerations_join_the_inertia_of_their_own_row():
    pushed = GibbsAppell([Particle(1, (x, y))], [x, y], forces=[-acceleration(y) / 2, -1])
    motion = propagate(pushed, (0, 2), [0, 0, 0, 0])
    np.testing.assert_allclose(motion.final, [1, -2, 1, -2], rtol=1e-12)
    assert motion.work[-1] == pytest.approx(2.5)
    carried = GibbsAppell([Particle(1, (x + time, y))], [x, y], forces=[-acceleration(y) / 2, -1])
    np.testing.assert_allclose(propagate(carried, (0, 2), [0, 0, 0, 0]).final, [1, -2, 1, -2], rtol=1e-12)
    heavier = GibbsAppell([Particle(1, (x, y))], [x, y], forces=[-acceleration(x), -1])
    np.testing.assert_allclose(propagate(heavier, (0, 2), [0, 0, 1, 0]).final, [2, -2, 1, -2], rtol=1e-12)


def test_no_balance_of_work_is_asked_of_rates_that_are_not_linear_in_u():
    u = sp.Symbol("u", real=True)
    bent = GibbsAppell([Particle(1, (x, y))], [x, y], u=[u], q_dot=[u, u**2], forces=[1, 0])
    motion = propagate(bent, (0, 1), [0, 0, 1])
    assert abs(motion.energy_error).max() < 1e-13
    assert motion.work[-1] == pytest.approx(motion.energy[-1] - 1)
    straight = GibbsAppell([Particle(1, (x, y))], [x, y], u=[u], q_dot=[u, 2 * u], forces=[1, 0])
    motion = propagate(straight, (0, 1), [0, 0, 1])
    assert motion.work[-1] == pytest.approx(motion.final[0])
    assert abs(motion.energy_error).max() < 1e-13


# parameters by orbit -------------------------------------------------------------------------------


@pytest.mark.parametrize("iteration", ["fixed-point", "newton"])
def test_a_large_parameter_by_orbit_does_not_hide_stages_that_have_not_converged(iteration):
    mu, far, GM = parameters("mu", positive=True), 1.496e11, 1.327e20
    kinetic = (x.momentum**2 + y.momentum**2) / 2
    sun = Hamiltonian(kinetic - mu / sp.sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum])
    start, day = np.array([far, 0, 0, np.sqrt(GM / far)]), 86400
    how = {"method": Gauss(4, iteration=iteration), "step": 120 * day, "samples": 1}
    alone = propagate(sun, (0, 2400 * day), start, parameters={mu: GM}, **how)
    both = propagate(
        sun, (0, 2400 * day), np.stack([start, start], 1), parameters={mu: np.array([GM, GM])}, **how
    )
    for orbit in both.final.T:
        np.testing.assert_allclose(orbit, alone.final, rtol=1e-10)


# names and numbers ---------------------------------------------------------------------------------


def test_a_parameter_called_as_a_multiplier_keeps_its_name():
    weight, other = parameters("lambda_1 g")
    for symbol, shown in ((weight, 9.0), (other, None)):
        pendulum = ConstrainedLagrangian(
            Lagrangian((x.dot**2 + y.dot**2) / 2 - symbol * y, [x, y]), holonomic=[x**2 + y**2 - 1]
        )
        motion = propagate(pendulum, (0, 0.1), [1, 0, 0, 2], parameters={symbol: 9}, samples=2)
        assert motion.multipliers[0, 0] == pytest.approx(-2)
        seen = motion[2 * weight]
        assert seen[0] == pytest.approx(18 if shown else -4)
    ball = UnilateralLagrangian(Lagrangian(y.dot**2 / 2 - weight * y, [y]), [y], 0)
    resting = propagate(ball, (0, 1), [1, 0], parameters={weight: 9}, samples=3)
    np.testing.assert_allclose(resting[1 * weight], 9)
    assert resting.multipliers[0, -1] == pytest.approx(9)


def test_constants_of_no_size_are_zero_and_those_beyond_all_numbers_are_refused():
    graph = Graph()
    assert exact_value(graph, graph.from_sympy(sp.exp(-(10**10), evaluate=False))) == 0
    assert 0 < exact_value(graph, graph.from_sympy(sp.exp(-1000))) < Fraction(1, 10**434)
    assert float(exact_value(graph, graph.from_sympy(-sp.exp(2)))) == pytest.approx(-np.exp(2), rel=1e-15)
    with pytest.raises(ValueError, match="too large to compute with"):
        exact_value(graph, graph.from_sympy(sp.exp(10**10, evaluate=False)))
    rate = parameters("E")
    falling = Hamiltonian(x.momentum**2 / 2 + x + sp.exp(-rate) * x, [x], [x.momentum])
    end = propagate(falling, (0, 2), [0, 0], method=DOP853(), parameters={rate: 10**10}).final
    np.testing.assert_allclose(end, [-2, -2], rtol=1e-12)


def test_roots_that_are_not_quadratic_in_the_momenta_are_no_magnetic_form():
    p, q, t = sp.symbols("p q t", real=True)
    with pytest.raises(NotMagneticError, match="H is not"):
        magnetic_form(equations(sp.sqrt(1 + p) + q**2, [q], [p], t, {}))
    assert magnetic_form(equations(sp.sqrt(1 + p**2) + q**2, [q], [p], t, {})) is not None


def test_a_parameter_one_by_zero_is_no_number():
    with pytest.raises(ValueError, match="g = '1/0' is no finite real number"):
        exact_number("1/0", "g")
    assert exact_number("1/3", "g") == Fraction(1, 3)
