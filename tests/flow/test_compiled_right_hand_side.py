"""The compiled right-hand side: the rates that the derivation says, in other programs' hands."""

import copy
import itertools
import pickle
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from canon import ConstrainedLagrangian, Hamiltonian, Lagrangian, coordinates, parameters, propagate
from canon.flow import right_hand_side

x, y = coordinates("x y")
m, g = parameters("m g", positive=True)
DRIVEN = Hamiltonian(
    x.momentum**2 / (2 * m) + m * g * x**2 / 2 + x**4 * sp.sin(sp.Symbol("t", real=True)), [x], [x.momentum]
)
VALUES = {m: 2.0, g: 9.81}
RATES = right_hand_side(DRIVEN, [1.0, 0.0], VALUES)
NUMBERS = st.floats(-10, 10)


@settings(max_examples=50, deadline=None)
@given(NUMBERS, NUMBERS, NUMBERS)
def test_the_rates_are_hamiltons_equations(t, q, p):
    at = {**VALUES, x: q, x.momentum: p, DRIVEN.t: t}
    right = [float(DRIVEN.H.diff(x.momentum).subs(at)), -float(DRIVEN.H.diff(x).subs(at))]
    np.testing.assert_allclose(RATES(t, [q, p]), right, rtol=1e-13, atol=1e-11)


def test_another_integrator_gives_the_same_motion():
    found = solve_ivp(RATES, (0.0, 3.0), RATES.start, method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    motion = propagate(DRIVEN, (0.0, 3.0), [1.0, 0.0], parameters=VALUES)
    np.testing.assert_allclose(found, motion.final, atol=1e-9)
    wrong = right_hand_side(DRIVEN, [1.0, 0.0], {**VALUES, g: 9.8})
    assert abs(solve_ivp(wrong, (0.0, 3.0), wrong.start, rtol=1e-9).y[:, -1] - motion.final).max() > 1e-4


def test_of_a_constrained_system_they_are_velocities_and_accelerations_on_the_constraint():
    wire = ConstrainedLagrangian(
        Lagrangian(m * (x.dot**2 + y.dot**2) / 2 - m * g * y, [x, y]), holonomic=[y - x**2]
    )
    rates = right_hand_side(wire, {"x": 1, "y": 1, "x_dot": 0.5, "y_dot": 1.0}, VALUES)
    assert rates.variables == (x, y, x.dot, y.dot)
    found = rates(0.0, rates.start)
    assert found[:2] == pytest.approx([0.5, 1.0])
    at = {x: 1, y: 1, x.dot: 0.5, y.dot: 1.0, **VALUES}
    assert found[2:] == pytest.approx([float(a.subs(at)) for a in wire.accelerations])


def test_they_are_copied_and_pickled():
    for twin in (copy.deepcopy(RATES), pickle.loads(pickle.dumps(RATES))):
        assert (twin(0.5, [1.0, 2.0]) == RATES(0.5, [1.0, 2.0])).all()


def test_the_rates_of_many_motions_are_refused():
    with pytest.raises(ValueError, match="give one state"):
        right_hand_side(DRIVEN, [[1.0, 2.0], [0.0, 0.0]], VALUES)
    with pytest.raises(KeyError, match="g"):
        right_hand_side(DRIVEN, [1.0, 0.0], {m: 1.0})


def test_several_threads_may_call_it_at_once():
    x = coordinates("x1:11")
    chain = Hamiltonian(
        sum(a.momentum**2 / 2 for a in x) - sum(sp.cos(a) * sp.cos(b) for a, b in itertools.pairwise(x)),
        x,
        [a.momentum for a in x],
    )
    f = right_hand_side(chain, np.zeros(20))
    states = np.random.default_rng(0).standard_normal((4, 20))
    true = [f(0.0, y) for y in states]
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        with ThreadPoolExecutor(4) as pool:
            wrong = list(
                pool.map(lambda k: sum((f(0.0, states[k]) != true[k]).any() for _ in range(5000)), range(4))
            )
    finally:
        sys.setswitchinterval(before)
    assert wrong == [0] * 4
