"""Bodies that move, turn and are joined by springs: order, reversal, momenta to rounding, against Newton and Euler."""

import itertools

import numpy as np
import pytest
import sympy as sp

from canon import propagate
from canon.flow import LiePoissonSplitting, reversal_error
from canon.flow.method.method import RK4
from canon.flow.request import Request
from canon.flow.system_request import any_task
from canon.mechanics import MovingBody, attitude_matrix, moving_bodies


def chain(count):
    """Bodies side by side, each joined to the next at its end by a spring, and a start with all of them turning."""
    bodies = [MovingBody(str(i), 1 + sp.Rational(i, 2), [1, sp.Rational(3, 2), 2]) for i in range(count)]
    joints = [(a.place_of([1, 0, 0]), b.place_of([-1, 0, 0])) for a, b in itertools.pairwise(bodies)]
    V = 2 * sp.Add(*((x - y) ** 2 for ends in joints for x, y in zip(*ends, strict=True)))
    start = []
    for i in range(count):
        p = [(i - (count - 1) / 2) * x for x in (0.1, -0.2, 0.3)]
        start += [2 * i, 0, 0, *p, 0.4, 0.2 - i, 0.1, 0.96, 0.28 * (-1) ** i, 0, 0]
    return bodies, moving_bodies(bodies, V), start


BODIES, PAIR, START = chain(2)


def parts_of(system, start):
    task, _ = any_task(Request(system, (0, 1), start, method=LiePoissonSplitting(), step=1.0))
    return task.system.lie_poisson


def totals(bodies, motion):
    """Momentum and angular momentum of all together along a motion."""
    p = [motion[sp.Add(*(body.p[i] for body in bodies))] for i in range(3)]
    L = [motion[sp.Add(*(body.angular_momentum[i] for body in bodies))] for i in range(3)]
    return np.array([*p, *L])


def test_a_body_flies_and_turns_whatever_the_step():
    """A symmetric body turns by M/A about its fixed angular momentum: after half a turn its M is where it was."""
    body = MovingBody("a", 2, [1, 1, 1])
    start = [0, 0, 0, 1, 2, 3, 0, 0, np.pi, 1, 0, 0, 0]
    motion = propagate(moving_bodies([body]), (0, 1), start, method=LiePoissonSplitting(), step=0.5)
    np.testing.assert_allclose(motion.final, [0.5, 1, 1.5, 1, 2, 3, 0, 0, np.pi, 0, 0, 0, 1], atol=1e-15)


def test_names_are_different():
    with pytest.raises(ValueError, match="2 bodies: give one or more, each with a name of its own"):
        moving_bodies([MovingBody("a", 1, [1, 1, 1])] * 2)


@pytest.mark.slow
def test_parts_of_a_chain():
    parts = parts_of(PAIR, START)
    assert (len(parts.turns), len(parts.commons), len(parts.kicks), len(parts.drift)) == (4, 2, 1, 6)
    assert PAIR.is_poisson()
    assert PAIR.is_casimir(sp.Add(*(x**2 for x in BODIES[1].e)))


@pytest.mark.slow
def test_order_against_taylors_method():
    true = propagate(PAIR, (0, 4), START, samples=1).final
    for order, steps in ((2, 100), (4, 60), (6, 40)):
        errors = [
            abs(
                propagate(PAIR, (0, 4), START, method=LiePoissonSplitting(order), step=4 / n, samples=1).final
                - true
            ).max()
            for n in (steps, 2 * steps)
        ]
        assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.08 * order)


@pytest.mark.slow
def test_momenta_stay_and_energy_is_bounded_and_with_runge_and_kutta_they_do_not():
    bodies, system, start = chain(3)
    motion = propagate(system, (0, 5000), start, method=LiePoissonSplitting(2), step=0.05, samples=500)
    both = totals(bodies, motion)
    assert abs(both - both[:, :1]).max() < 1e-12
    error = abs(motion.energy_error)
    assert error.max() < 0.05
    assert error[-50:].max() < 3 * error[1:51].max()
    lost = totals(bodies, propagate(system, (0, 500), start, method=RK4(), step=0.05, samples=50))
    assert abs(lost - lost[:, :1]).max() > 1e-6


@pytest.mark.slow
def test_time_reversal_of_a_chain():
    assert abs(reversal_error(PAIR, (0, 10), START, method=LiePoissonSplitting(4), step=0.1)).max() < 1e-13


@pytest.mark.slow
def test_newtons_and_eulers_equations():
    """m r̈ is the pull of the springs, d(R M)/dt its moment about the centre of mass: both without brackets."""
    point = np.array([1.0, 0.0, 0.0])
    motion = propagate(PAIR, (0, 1), START, method=LiePoissonSplitting(8), step=2.0**-6, samples=64)
    R_of = sp.lambdify(sp.symbols("e_0:4", real=True), attitude_matrix(), "numpy")
    y = motion.y.reshape(2, 13, -1)
    R = np.array([[R_of(*y[i, 9:, k]) for k in range(y.shape[2])] for i in range(2)])
    ends = [y[i, :3].T + sign * R[i] @ point for i, sign in ((0, 1), (1, -1))]
    pull = 4 * (ends[1] - ends[0])
    spins = np.einsum("kij,jk->ki", R[0], y[0, 6:9])
    moments = np.cross(R[0] @ point, pull)
    weights, h = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60, motion.t[1] - motion.t[0]
    for what, rate in ((y[0, 3:6].T, pull), (spins, moments)):
        slopes = sum(w * what[k : len(what) - 6 + k] for k, w in enumerate(weights)) / h
        np.testing.assert_allclose(slopes, rate[3:-3], atol=1e-8)
