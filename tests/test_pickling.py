"""Public values and results pickle and deep-copy, and the copies answer as the originals do."""

import copy
import pickle

import numpy as np
import pytest
import sympy as sp

from canon import (
    DOP853,
    RK4,
    SABA,
    ConstrainedLagrangian,
    Domain,
    Event,
    Gauss,
    Lagrangian,
    Particle,
    Splitting,
    Study,
    Taylor,
    TimeTransformed,
    VectorField,
    WisdomHolman,
    check,
    choose,
    coordinates,
    drift,
    drift_study,
    equal,
    flow_jacobian,
    hamiltonian,
    parameters,
    propagate,
    routhian,
    work_precision,
)
from canon.exercise import Claim, Sheet
from canon.scene import find

X, Y = coordinates("x y")
M, K = parameters("m k", positive=True)
SPRING = Lagrangian(M * X.dot**2 / 2 - K * X**2 / 2, [X])
H = hamiltonian(SPRING)
DAMPED = Lagrangian(X.dot**2 / 2 - X**2 / 2, [X], forces=[-X.dot / 10])
STAR = find("henon-heiles")


def spring(**how):
    return propagate(H, (0, 10), [1, 0], parameters={M: 1, K: 1}, samples=20, **how)


MADE = {
    "lagrangian": lambda: SPRING,
    "hamiltonian": lambda: H,
    "routhian": lambda: routhian(Lagrangian(M * (X.dot**2 + X**2 * Y.dot**2) / 2, [X, Y])),
    "constraints": lambda: ConstrainedLagrangian(
        Lagrangian((X.dot**2 + Y.dot**2) / 2, [X, Y]), [X**2 + Y**2 - 1]
    ),
    "vector field": lambda: VectorField((Y, -X), (X, Y)),
    "domain": lambda: Domain((X > 0,)),
    "particle": lambda: Particle(M, (X, Y)),
    "event": lambda: Event(X, -1, "stop"),
    "methods": lambda: (
        Splitting("verlet"), Gauss(3), RK4(), Taylor(), DOP853(), WisdomHolman(), SABA(4),
        TimeTransformed(Splitting("verlet")),
    ),
    "motion": lambda: spring(method="verlet", step=0.1),
    "dense motion": lambda: spring(dense=True, observables={"square": X**2}),
    "damped motion": lambda: propagate(DAMPED, (0, 10), [1, 0], samples=20),
    "error estimate": lambda: spring(method="verlet", step=0.1).error_estimate(),
    "jacobian": lambda: flow_jacobian(H, (0, 1), [1, 0], parameters={M: 1, K: 1}),
    "drift": lambda: drift(propagate(STAR.hamiltonian, (0, 300), STAR.state(), method="rk4", step=0.1)),
    "drift study": lambda: drift_study(STAR, methods=["verlet"], periods=50),
    "choice": lambda: choose(STAR, 100.0, accuracy=1e-4, methods=["verlet"]),
    "work and precision": lambda: work_precision(
        STAR, 10.0, methods=["verlet"], steps=[0.1], repetitions=1
    ),
    "proved": lambda: equal(sp.sin(X) ** 2, 1 - sp.cos(X) ** 2),
    "refuted": lambda: equal(sp.sin(X), X),
    "study": lambda: Study.of(system="kepler", method="rk4", step=0.1, span=10.0),
    "report": lambda: check(
        Sheet("s", [Claim("a", "equality-only", {"lhs": "x", "rhs": "x", "variables": "x"})])
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MADE)
def test_copies_are_like_the_originals(name):
    made = MADE[name]()
    for copied in (pickle.loads(pickle.dumps(made)), copy.deepcopy(made)):
        assert type(copied) is type(made)
        assert repr(copied) == repr(made)


@pytest.mark.parametrize(("name", "until"), [("motion", 20), ("damped motion", 20), ("dense motion", 20)])
def test_a_copied_motion_goes_on_bit_for_bit(name, until):
    motion = MADE[name]()
    copied = pickle.loads(pickle.dumps(motion))
    assert np.array_equal(copied.y, motion.y)
    assert np.array_equal(copied["x"], motion["x"])
    assert np.array_equal(copied.energy_error, motion.energy_error)
    assert np.array_equal(copied.resume(until).y, motion.resume(until).y)


def test_a_scene_says_what_to_send_instead():
    assert copy.deepcopy(STAR) is STAR
    with pytest.raises(TypeError, match="send its name"):
        pickle.dumps(STAR)
