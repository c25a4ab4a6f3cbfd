"""Parameters that differ from orbit to orbit; the same bits alone, in lanes and on threads."""

import numpy as np
import pytest
import sympy as sp

from canon.flow.method.method import DOP853, RK4, Gauss, Splitting, Taylor
from canon.flow.propagation import propagate
from canon.flow.run.event import Event
from canon.flow.run.non_finite_state import NonFiniteStateError
from tests.flow.systems import System, theta, x, y

(m, e), k = sp.symbols("m e", positive=True), sp.Symbol("k", nonnegative=True)
px, py = x.momentum, y.momentum
OSCILLATOR = System(px**2 / (2 * m) + k * x**2 / 2, (x,), (px,))
PENDULUMS = System(theta.momentum**2 / (2 * m) - k * sp.cos(theta), (theta,), (theta.momentum,))
SOFT = System(px**2 / 2 + py**2 / (2 * m) - k / sp.sqrt(x**2 + y**2 + e**2), (x, y), (px, py))
COUPLED = System((1 + k * x**2) * px**2 / (2 * m) + x**2 / 2, (x,), (px,))
METHODS = [
    (Splitting("kahan-li-8"), {"step": 0.05}),
    (Splitting("srkn-6b"), {"step": 0.05}),
    (RK4(), {"step": 0.02}),
    (Gauss(4), {"step": 0.1}),
    (Taylor(), {}),
    (DOP853(), {}),
]


@pytest.mark.parametrize(("method", "how"), METHODS, ids=lambda c: str(c)[:18])
def test_each_orbit_follows_its_own_parameters(method, how):
    masses, springs = np.array([1.0, 2.0, 0.5, 1.0, 3.0]), np.array([1.0, 1.0, 2.0, 0.25, 4.0])
    motion = propagate(
        OSCILLATOR, (0, 10), [1.0, 0.5], method=method, parameters={m: masses, "k": springs}, samples=20,
        observables={"kx": k * x}, **how,
    )  # fmt: skip
    assert motion.y.shape == (2, 21, 5)
    w = np.sqrt(springs / masses)
    expected = np.cos(np.outer(motion.t, w)) + 0.5 / (masses * w) * np.sin(np.outer(motion.t, w))
    bound = np.full(5, 1e-9)
    if method == RK4():  # it turns slower by (ωh)⁴/120 of the angle
        bound = 1.1 * w * motion.t[-1] * (w * motion.step) ** 4 / 120 * np.hypot(1.0, 0.5 / (masses * w))
    assert (abs(motion.q[0] - expected).max(axis=0) < bound).all()
    np.testing.assert_allclose(motion.energy[0], 0.125 / masses + springs / 2, rtol=1e-15)
    np.testing.assert_allclose(motion.observables["kx"], springs * motion.q[0], rtol=1e-15)
    # As with one number a run, up to round-off: the constants are rounded in another place.
    one = propagate(
        OSCILLATOR, (0, 10), [1.0, 0.5], method=method, parameters={m: 0.5, k: 2}, samples=20, **how
    )
    np.testing.assert_allclose(motion.y[:, :, 2], one.y, atol=1e-9 if method == DOP853() else 1e-13)


@pytest.mark.parametrize("precision", ["single", "double", "compensated", "extended", "double-double"])
@pytest.mark.parametrize("method", [Splitting("kahan-li-6"), RK4()], ids=str)
def test_alone_in_lanes_and_on_threads_the_same_bits(method, precision):
    orbits = 70
    start = np.array([1.0, 0.2, 0.1, 0.9])[:, np.newaxis] * np.linspace(0.9, 1.1, orbits)
    values = {
        m: np.linspace(1, 2, orbits),
        k: np.linspace(0.5, 1.5, orbits),
        e: np.linspace(0.1, 0.3, orbits),
    }
    arguments = {"method": method, "step": 0.05, "precision": precision, "samples": 3, "cadence": 10}
    together = propagate(SOFT, (0, 6), start, parameters=values, **arguments)
    for orbit in (0, 1, 37, 69):
        own = {name: value[orbit : orbit + 1] for name, value in values.items()}
        alone = propagate(SOFT, (0, 6), start[:, orbit], parameters=own, **arguments)
        np.testing.assert_array_equal(alone.y[:, :, 0], together.y[:, :, orbit])
        np.testing.assert_array_equal(alone.carried[:, :, 0], together.carried[:, :, orbit])
        np.testing.assert_array_equal(
            alone.statistics["energy"].mean[:, 0], together.statistics["energy"].mean[:, orbit]
        )


def test_what_splits_or_is_quadratic_stays_so():
    assert propagate(
        PENDULUMS, (0, 1), [1.0, 0.0], method=Splitting("srkn-6a"), step=0.1, parameters={m: [1, 2], k: 1}
    ).y.shape == (2, 11, 2)
    with pytest.raises(ValueError, match="not separable"):
        propagate(
            COUPLED, (0, 1), [1.0, 0.0], method=Splitting("verlet"), step=0.1, parameters={m: [1, 2], k: 1}
        )
    moved = propagate(
        COUPLED, (0, 5), [1.0, 0.0], method=Gauss(6), step=0.05, parameters={m: [1, 2], k: [0, 3]}
    )
    assert abs(moved.energy_error).max() < 1e-13
    np.testing.assert_allclose(moved.q[0, :, 0], np.cos(moved.t), atol=1e-13)


def test_families_are_resumed_and_read_between_samples():
    arguments = {"method": Splitting("kahan-li-8"), "step": 0.1, "parameters": {m: ["1/3", 2], k: 1}}
    whole = propagate(PENDULUMS, (0, 20), [1.0, 0.0], samples=4, **arguments)
    half = propagate(PENDULUMS, (0, 10), [1.0, 0.0], samples=2, **arguments)
    np.testing.assert_array_equal(half.resume(20).y, whole.y)
    np.testing.assert_array_equal(whole(np.array([10.0])), half.y[:, -1:])


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"parameters": {m: [1, 2], k: [1, 2, 3]}}, ValueError, r"shape \(orbits,\)"),
        ({"parameters": {m: [[1, 2]], k: 1}}, ValueError, r"shape \(orbits,\)"),
        ({"parameters": {m: [], k: 1}}, ValueError, r"shape \(orbits,\)"),
        ({"parameters": {m: [1, np.nan], k: 1}}, ValueError, r"m\[1\] = nan"),
        ({"parameters": {m: [1, 0], k: 1}}, ValueError, r"m\[1\] = 0, but m was made as a positive"),
        ({"parameters": {m: [1, 2]}}, KeyError, "holds k"),
        ({"parameters": {m: [1, 2], k: 1, "w": [1, 2]}}, KeyError, "has no parameter w, it has k, m"),
        ({"y0": [[1, 1, 1], [0, 0, 0]]}, ValueError, r"shape \(orbits,\)"),
        ({"events": [Event(x, action="stop")]}, ValueError, "one by one"),
    ],
)
def test_parameters_that_make_no_sense_are_refused(change, error, message):
    right = {
        "y0": [1.0, 0.0], "t_span": (0, 1), "method": Splitting("verlet"), "step": 0.1,
        "parameters": {m: [1, 2], k: 1},
    }  # fmt: skip
    with pytest.raises(error, match=message):
        propagate(OSCILLATOR, **{**right, **change})


def test_a_lost_orbit_of_a_family_shows_its_state_without_the_parameters():
    edge = System(px**2 / 2 - k * sp.sqrt(1 - x**2) - 2 * x, (x,), (px,))
    with pytest.raises(NonFiniteStateError, match="of orbit 1") as caught:
        propagate(
            edge,
            (0, 1),
            [[0.0, 0.0], [0.1, 2.0]],
            method=Splitting("verlet"),
            step=0.001,
            parameters={k: [9, 1]},
        )
    assert caught.value.state.shape == (2,)
