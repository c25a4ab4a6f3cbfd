"""What users may say to propagate, what they get back, and what is refused."""

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian
from canon.expression.symbols.symbol import coordinates, parameters
from canon.flow.method.method import DOP853, RK4, Splitting, Taylor
from canon.flow.propagation import propagate
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.run.observables_along import _many_digits, _wide_values
from canon.flow.run.samples import Samples
from canon.kernel.program.hamilton_equations import equations
from tests.flow.systems import (
    DRIVEN,
    HENON_HEILES,
    HENON_HEILES_START,
    KEPLER,
    PENDULUM,
    System,
    kepler_start,
)

VERLET = Splitting("verlet")
u = coordinates("u")
m, k = parameters("m k", positive=True)
OSCILLATOR = System(u.momentum**2 / (2 * m) + k * u**2 / 2, (u,), (u.momentum,))


def test_the_oscillator_moves_as_the_closed_form():
    motion = propagate(
        OSCILLATOR,
        (0, 10),
        [1.0, 0.0],
        method=Splitting("kahan-li-8"),
        step=0.01,
        parameters={m: 2, "k": sp.Rational(9, 2)},
        samples=100,
    )
    np.testing.assert_allclose(motion.q[0], np.cos(1.5 * motion.t), atol=1e-13)
    np.testing.assert_allclose(motion.p[0], -3 * np.sin(1.5 * motion.t), atol=4e-13)
    assert motion.energy[0] == 2.25
    assert motion.relative


@pytest.mark.parametrize("method", [VERLET, RK4(), Taylor(), DOP853()], ids=str)
def test_shapes_and_times(method):
    fixed = {"step": 0.1} if method in (VERLET, RK4()) else {}
    motion = propagate(HENON_HEILES, (1, 11), HENON_HEILES_START, method=method, samples=20, **fixed)
    assert motion.y.shape == (4, 21)
    assert motion.q.shape == motion.p.shape == (2, 21)
    np.testing.assert_allclose(motion.t, np.linspace(1, 11, 21), rtol=1e-15)
    np.testing.assert_array_equal(motion.y[:, 0], HENON_HEILES_START)
    np.testing.assert_array_equal(motion.final, motion.y[:, -1])
    assert motion.energy_error[0] == 0
    assert motion.steps > 0
    assert motion.evaluations >= motion.steps
    assert str(method) in repr(motion)
    assert f"t = {motion.t[0]:g} … {motion.t[-1]:g}, " in repr(motion)


@pytest.mark.parametrize("method", [Splitting("kahan-li-8"), Taylor(), DOP853()], ids=str)
def test_time_may_run_backwards(method):
    fixed = {"step": 0.05} if isinstance(method, Splitting) else {}
    there = propagate(HENON_HEILES, (0, 7), HENON_HEILES_START, method=method, samples=7, **fixed)
    back = propagate(HENON_HEILES, (7, 0), there.final, method=method, samples=7, **fixed)
    np.testing.assert_allclose(back.y[:, ::-1], there.y, atol=1e-9)


def test_sampled_states_do_not_depend_on_how_many_are_kept():
    arguments = {"method": Splitting("kahan-li-8"), "step": 0.1}
    few = propagate(HENON_HEILES, (0, 100), HENON_HEILES_START, samples=4, **arguments)
    many = propagate(HENON_HEILES, (0, 100), HENON_HEILES_START, samples=1000, **arguments)
    np.testing.assert_array_equal(few.y, many.y[:, ::250])


def test_the_step_is_the_largest_that_divides_the_span_and_is_not_above_the_asked_one():
    motion = propagate(PENDULUM, (0, 1), [1.0, 0.0], method=VERLET, step=0.3)
    assert (motion.steps, motion.step) == (4, 0.25)
    exact = propagate(PENDULUM, (0, 1), [1.0, 0.0], method=VERLET, step=0.1)
    assert exact.steps == 10
    assert propagate(PENDULUM, (0, 1), [1.0, 0.0], method=VERLET, step=5.0).steps == 1
    assert propagate(PENDULUM, (1, 0), [1.0, 0.0], method=VERLET, step=0.3).step == -0.25


def test_energy_is_evaluated_beyond_double_precision():
    motion = propagate(
        KEPLER, (0, 100), kepler_start(0.2), method=Splitting("kahan-li-8"), step=0.01, samples=50
    )
    error = abs(motion.energy_error[1:])
    # Evaluated in doubles, every value would be a multiple of 2⁻⁵³.
    assert error.max() < 4e-15
    assert np.any(error % 2.0**-53 != 0)


def test_long_doubles_and_40_digits_give_the_same_energies():
    made = equations(KEPLER.H, KEPLER.q, KEPLER.p, KEPLER.t, {})
    found = propagate(KEPLER, (0, 3), kepler_start(0.5), method=VERLET, step=0.01, samples=5)
    samples = Samples(found.t, found.y, found.carried, 1, 1, 0.01, 0.0, 0.0)
    carried = np.full_like(samples.y, 1e-18)
    wide, many = (
        [float(v) for v in values(made, [made.hamiltonian], samples.t, samples.y, carried)[0]]
        for values in (_wide_values, _many_digits)
    )
    np.testing.assert_allclose(wide, many, rtol=2e-16)


def test_a_vanishing_starting_energy_gives_absolute_errors():
    motion = propagate(OSCILLATOR, (0, 1), [0.0, 0.0], method=VERLET, step=0.1, parameters={m: 1, k: 1})
    assert not motion.relative
    assert abs(motion.energy_error).max() == 0


def test_the_energy_of_a_driven_system_is_no_error():
    motion = propagate(DRIVEN, (0, 5), [1.0, 0.5], method=VERLET, step=0.01)
    assert abs(motion.energy_change).max() > 0.01
    with pytest.raises(ValueError, match="depends on t"):
        _ = motion.energy_error


def test_progress_ends_at_one_and_rises():
    for method, fixed in ((VERLET, {"step": 0.001}), (Taylor(), {}), (DOP853(), {})):
        seen = []
        propagate(PENDULUM, (0, 50), [1.0, 0.0], method=method, progress=seen.append, samples=10, **fixed)
        assert seen == sorted(seen)
        assert seen[-1] == pytest.approx(1)


def test_an_interruption_is_heard_within_a_slice():
    def impatient(fraction):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        propagate(PENDULUM, (0, 1e9), [1.0, 0.0], method=VERLET, step=0.01, samples=2, progress=impatient)


REFUSED = [
    ({"y0": [float("nan"), 0.0]}, ValueError, "not finite"),
    ({"y0": [1.0]}, ValueError, r"shape \(1,\).*shape \(2,\)"),
    ({"y0": [[[1.0]], [[0.0]]]}, ValueError, "shape"),
    ({"parameters": {m: 1}}, KeyError, "holds k"),
    ({"parameters": {}}, KeyError, "holds k, m"),
    ({"parameters": {m: 1, k: float("inf")}}, ValueError, "k = inf"),
    ({"parameters": {m: 1, k: "two"}}, ValueError, "k = 'two'"),
    ({"parameters": {m: 1, k: m}}, ValueError, "no number"),
    ({"step": 0.0}, ValueError, "positive"),
    ({"step": -0.1}, ValueError, "positive"),
    ({"step": float("nan")}, ValueError, "positive"),
    ({"step": None}, ValueError, "fixed steps"),
    ({"tolerance": 1e-9}, ValueError, "not tolerance"),
    ({"precision": "quadruple"}, ValueError, "compensated"),
    ({"samples": 0}, ValueError, "samples"),
    ({"t_span": (1, 1)}, ValueError, "no length"),
    ({"t_span": (0, float("inf"))}, ValueError, "t_span"),
    ({"method": Taylor()}, ValueError, "own steps"),
    ({"method": Taylor(), "step": None, "precision": "compensated"}, ValueError, "'quad'"),
    ({"observables": {"I": sp.Symbol("w") * u}}, KeyError, "observable 'I' holds w"),
]


@pytest.mark.parametrize(("wrong", "error", "message"), REFUSED)
def test_what_makes_no_sense_is_refused(wrong, error, message):
    right = {
        "y0": [1.0, 0.0],
        "t_span": (0, 1),
        "method": VERLET,
        "step": 0.1,
        "parameters": {m: 1, k: 1},
    }
    propagate(OSCILLATOR, **right)
    with pytest.raises(error, match=message):
        propagate(OSCILLATOR, **{**right, **wrong})


def test_a_start_outside_the_domain_is_refused():
    with pytest.raises(ValueError, match="not finite at y0"):
        propagate(KEPLER, (0, 1), [0.0, 0.0, 1.0, 0.0], method=VERLET, step=0.1)


def test_a_run_out_of_the_domain_tells_time_and_state():
    # √(1 − u²) ends at u = 1, where this motion arrives near t = 0.5.
    edge = System(u.momentum**2 / 2 - sp.sqrt(1 - u**2) - 2 * u, (u,), (u.momentum,))
    with pytest.raises(NonFiniteStateError, match="after t =") as caught:
        propagate(edge, (0, 10), [0.0, 2.0], method=VERLET, step=0.001)
    assert 0.2 < caught.value.time < 1
    assert np.isfinite(caught.value.state).all()
    # Finite, and at most one drift beyond the edge.
    assert 0.99 < caught.value.state[0] < 1 + 0.001 * 2.8
    for method in (Taylor(), DOP853()):
        with pytest.raises(NonFiniteStateError, match="after t ="):
            propagate(edge, (0, 10), [0.0, 2.0], method=method)


def test_a_nystrom_method_asks_for_a_quadratic_kinetic_energy():
    quartic = System(u.momentum**4 / 4 + u**2 / 2, (u,), (u.momentum,))
    with pytest.raises(ValueError, match="quadratic in p"):
        propagate(quartic, (0, 1), [1.0, 0.0], method=Splitting("srkn-6a"), step=0.1)
    assert propagate(quartic, (0, 1), [1.0, 0.0], method=Splitting("blanes-moan-6"), step=0.1).steps == 10


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"k": 1, parameters("k", positive=True): 1}, "give k twice"),
        ({"k": -1}, "k was made as a positive symbol"),
        ({"k": np.array([1.0, -1.0])}, "k was made as a positive symbol"),
        ({"k": 1, "x": 2}, "x moves and is no parameter"),
        ({"k": 1, "t": 2}, "t moves and is no parameter"),
    ],
)
def test_parameters_of_a_hamiltonian_that_make_no_sense(given, sentence):
    x, k = coordinates("x"), parameters("k", positive=True)
    spring = Hamiltonian(x.momentum**2 / 2 + k * x**2 / 2, [x], [x.momentum])
    with pytest.raises(ValueError, match=sentence):
        propagate(spring, (0, 1), [1.0, 0.0], parameters=given)
