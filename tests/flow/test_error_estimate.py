"""What a trajectory says of its own error bounds the true one, which closed forms and 40 digits know."""

from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp
from mpmath import mp, mpf

from canon import (
    DOP853,
    RK4,
    Event,
    Gauss,
    Hamiltonian,
    Splitting,
    Taylor,
    TimeTransformed,
    WisdomHolman,
    coordinates,
    propagate,
    time,
)
from canon.flow import AccuracyWarning, NonFiniteStateError
from canon.flow.estimate.companion import CompanionTask

x, y = coordinates("x y")
KEPLER = Hamiltonian(
    (x.momentum**2 + y.momentum**2) / 2 - 1 / sp.sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum]
)
PENDULUM = Hamiltonian(x.momentum**2 / 2 - sp.cos(x), [x], [x.momentum])


def kepler_start(gap):
    """At the pericentre of an orbit with e = 1 − gap, up to rounding."""
    return [gap, 0.0, 0.0, ((2 - gap) / gap) ** 0.5]


def kepler_truth(start, times):
    """Kepler's motion from the pericentre (x0, 0, 0, v0), 60 digits."""
    with mp.workdps(60):
        x0, v0 = mpf(start[0]), mpf(start[3])
        a = 1 / (2 / x0 - v0**2)
        e, n = 1 - x0 / a, mp.power(a, mpf(-3) / 2)
        return np.array([_kepler_state(a, e, n, n * mpf(float(t))) for t in times], dtype=object).T


def _kepler_state(a, e, n, mean):
    mean -= 2 * mp.pi * mp.nint(mean / (2 * mp.pi))
    low, high = mpf(0), mp.pi
    for _ in range(220):
        middle = (low + high) / 2
        low, high = (middle, high) if middle - e * mp.sin(middle) < abs(mean) else (low, middle)
    E = mp.sign(mean) * low
    r, b = 1 - e * mp.cos(E), mp.sqrt(1 - e * e)
    return [a * (mp.cos(E) - e), a * b * mp.sin(E), -a * n * mp.sin(E) / r, a * n * b * mp.cos(E) / r]


def true_error(motion, truth):
    found = np.frompyfunc(mpf, 1, 1)(motion.y)
    return np.maximum.accumulate(abs(found - truth).astype(float), axis=1)


METHODS = [
    (Taylor(), {}),
    (Taylor(tolerance=1e-6), {}),
    (Taylor(), {"precision": "extended"}),
    (DOP853(), {}),
    (RK4(), {"step": 0.002}),
    (Gauss(4), {"step": 0.02}),
    (Splitting("verlet"), {"step": 0.002}),
    (Splitting("kahan-li-8"), {"step": 0.02}),
    (Splitting("kahan-li-8"), {"step": 0.02, "precision": "single"}),
    (Splitting("kahan-li-8"), {"step": 0.02, "precision": "double-double"}),
    (WisdomHolman(), {"step": 0.02}),
    (TimeTransformed(Splitting("kahan-li-8")), {"step": 0.01}),
]


@pytest.mark.parametrize(("method", "how"), METHODS, ids=lambda x: str(x))
def test_bounds_the_error_of_kepler_s_motion(method, how):
    start = kepler_start(0.4)
    motion = propagate(KEPLER, (0, 20), start, method=method, samples=20, **how)
    estimate = motion.error_estimate()
    error = true_error(motion, kepler_truth(start, motion.t))
    assert (error <= estimate.error).all()
    # Nor does it exaggerate: at the end it is within a factor of 4, or a few units of the last place. Wisdom and
    # Holman's method has no companion in wider numbers: what the motion makes of one unit is not to be told from it.
    unit = 1e-12 if method == WisdomHolman() else 2e-14
    assert (estimate.error[:, -1] <= 4 * error[:, -1] + unit).all()
    assert estimate.meaningful_until is None
    assert estimate.lyapunov_time is None


@pytest.mark.parametrize("gap", [1e-3, 1e-6, pytest.param(1e-12, marks=pytest.mark.slow)])
def test_bounds_it_where_the_motion_nearly_collides(gap):
    start = kepler_start(gap)
    method = TimeTransformed(Splitting("kahan-li-8"))
    motion = propagate(KEPLER, (0, 10), start, method=method, step=0.05 * gap, samples=10)
    estimate = motion.error_estimate()
    assert (true_error(motion, kepler_truth(start, motion.t)) <= estimate.error).all()
    assert estimate.relative[-1] < 1e-5


@pytest.mark.slow
def test_forces_of_one_instant_do_not_round_the_steps_of_all_others():
    """At this pericentre the force is 1e24 for 1e-18 units of time; the average step is 1e16 times longer."""
    start = kepler_start(1e-12)
    motion = propagate(KEPLER, (0, 6.5), start, precision="extended", samples=20)
    estimate, error = motion.error_estimate(), true_error(motion, kepler_truth(start, motion.t))
    assert (error <= estimate.error).all()
    assert (estimate.error[:, -1] <= 4 * error[:, -1] + 1e-14).all()


@pytest.mark.parametrize("gap", [1e-6, 1e-12])
@pytest.mark.filterwarnings("ignore::canon.AccuracyWarning")
def test_a_run_that_jumped_over_a_collision_is_not_held_against_another_that_did(gap):
    motion = propagate(KEPLER, (0, 10), kepler_start(gap), method=Gauss(6), step=0.01, samples=10)
    estimate = motion.error_estimate()
    assert (estimate.relative[1:] > 1.0).all()
    assert (true_error(motion, kepler_truth(kepler_start(gap), motion.t)) <= estimate.error).all()


def test_a_collision_that_taylor_s_method_can_not_pass_is_an_error():
    with pytest.raises(ValueError, match=r"begins with a time scale of 1e-18"):
        propagate(KEPLER, (0, 100), kepler_start(1e-12), samples=50)
    with pytest.raises(NonFiniteStateError, match=r"can't be continued after t = 3\.14"):
        propagate(KEPLER, (0, 100), [2.0, 0.0, 0.0, 7e-7], samples=50)


def double_pendulum():
    a, b = coordinates("a b")
    return Hamiltonian(
        (a.momentum**2 - 2 * sp.cos(a - b) * a.momentum * b.momentum + 2 * b.momentum**2)
        / (2 + 2 * sp.sin(a - b) ** 2)
        - 2 * sp.cos(a)
        - sp.cos(b),
        [a, b],
        [a.momentum, b.momentum],
    )


@pytest.mark.parametrize(
    "angle", [2.0, *(pytest.param(a, marks=pytest.mark.slow) for a in (1.994, 2.003, 2.008))]
)
def test_chaos_is_said(angle):
    double, start = double_pendulum(), [angle, 2.5, 0.0, 0.0]
    motion = propagate(double, (0, 150), start, samples=150)
    estimate = motion.error_estimate()
    assert 1.5 < estimate.lyapunov_time < 6
    assert 60 < estimate.meaningful_until < 160
    assert "this single trajectory means nothing" in str(estimate)
    truth = propagate(double, (0, 150), start, samples=150, precision="quad")
    with_meaning = motion.t < estimate.meaningful_until
    error = abs(motion.y - truth.y - truth.carried)
    assert (error <= estimate.error)[:, with_meaning].all()
    assert error[:, ~with_meaning].max() > 0.1


def test_small_oscillations_are_no_chaos():
    motion = propagate(double_pendulum(), (0, 600), [0.2, 0.3, 0.0, 0.0], samples=150)
    assert motion.error_estimate().lyapunov_time is None


def test_one_close_encounter_is_no_chaos():
    method = TimeTransformed(Splitting("kahan-li-8"))
    motion = propagate(KEPLER, (0, 6), [2.0, 0.0, 0.0, 7e-7], method=method, step=0.01, samples=20)
    estimate = motion.error_estimate()
    assert estimate.condition[-1] > 1e6
    assert estimate.lyapunov_time is None


def test_the_times_of_events_have_errors_too():
    crossing = Event(x, 1)
    motion = propagate(
        PENDULUM, (0, 40), [-1.0, 0.0], method=Splitting("verlet"), step=0.1, events=[crossing]
    )
    exact = propagate(PENDULUM, (0, 40), [-1.0, 0.0], precision="quad", events=[crossing])
    estimate = motion.error_estimate()
    missed = [abs(a.t - b.t) for a, b in zip(motion.events, exact.events, strict=True)]
    assert (missed <= estimate.events).all()
    assert (estimate.events <= 4 * np.array(missed)).all()
    assert np.isnan(estimate.condition).all()


@pytest.mark.parametrize("how", [{}, {"method": Splitting("kahan-li-8"), "step": 0.01}])
def test_the_time_of_an_event_that_ends_the_motion(how):
    end = Event(x, 1, "stop")
    motion = propagate(PENDULUM, (0, 40), [-1.0, 0.0], events=[end], **how)
    exact = propagate(PENDULUM, (0, 40), [-1.0, 0.0], precision="quad", events=[end])
    estimate = motion.error_estimate()
    assert motion.stopped
    assert estimate.events[0] < 1e-13
    assert abs(motion.events[0].t - exact.events[0].t) <= estimate.events[0]
    assert (abs(motion.final - exact.final) <= estimate.error[:, -1]).all()


@pytest.mark.parametrize("method", ["verlet", "kahan-li-8", "semiexplicit-4"])
def test_steps_over_kinks_err_as_much_with_half_their_size(method):
    stop = sp.Rational(1, 3)
    spring = Hamiltonian(
        x.momentum**2 / 2 + x**2 / 2 + sp.Piecewise((0, x < stop), (x - stop, True)), [x], [x.momentum]
    )
    with pytest.warns(AccuracyWarning, match="steps over the kinks"):
        motion = propagate(spring, (0, -15), [1.0, 0.0], samples=40, method=method, step=0.05)
    true = propagate(spring, (0, -15), [1.0, 0.0], times=motion.t[1:-1], precision="quad")
    assert (abs(motion.y - true.y) <= motion.error_estimate().error).all()


def test_chosen_orbits_of_an_ensemble():
    starts = np.array([np.linspace(0.1, 3, 40), np.zeros(40)])
    motion = propagate(PENDULUM, (0, 10), starts, method=Splitting("forest-ruth"), step=0.1, samples=5)
    some, all_of_them = motion.error_estimate([3, 30]), motion.error_estimate()
    assert some.error.shape == (2, 6, 2)
    assert np.allclose(some.relative, all_of_them.relative[:, [3, 30]], rtol=1e-3)


@pytest.mark.parametrize("how", [{}, {"times": [1.0, 2.0]}])
def test_time_transformed_motions_that_an_event_has_ended(how):
    method = TimeTransformed(Splitting("forest-ruth"))
    radial = x * x.momentum + y * y.momentum
    end = Event(radial, -1, "stop")
    motion = propagate(KEPLER, (0, 9), kepler_start(0.5), method=method, step=0.01, events=[end], **how)
    estimate = motion.error_estimate()
    assert motion.stopped
    # The apocentre is passed after half a period of 2π.
    assert abs(motion.t[-1] - np.pi) <= estimate.events[0] < 1e-4
    assert (true_error(motion, kepler_truth(kepler_start(0.5), motion.t)) <= estimate.error).all()


def test_an_exponential_that_is_small_is_rounded_by_its_exponent_and_blamed_for_nothing():
    x = coordinates("x")
    far = sp.exp(-8 * (x + sp.Rational(19, 16)) ** 2) / 32
    motion = propagate(
        Hamiltonian(x.momentum**2 / 2 + x**2 / 8 + far, [x], [x.momentum]), (0, 3), [0, 0], samples=8
    )
    wider = propagate(
        Hamiltonian(x.momentum**2 / 2 + x**2 / 8 + far, [x], [x.momentum]),
        (0, 3),
        [0, 0],
        samples=8,
        precision="quad",
    )
    estimate = motion.error_estimate()
    assert estimate.relative.max() < 1e-13
    assert (abs(motion.y - wider.y) <= estimate.error).all()


@pytest.mark.parametrize("method", [DOP853(), Taylor()])
def test_a_small_coordinate_beside_a_large_momentum(method):
    """Taylor's tolerance is relative to the largest number of a state, the companion's too: y by its integral."""
    x, y = q = coordinates("x y")
    mass = 2**40
    kick = sp.exp(-((8 * time - sp.Rational(3, 2)) ** 2)) / 32
    kinetic = x.momentum**2 / (2 * mass) + y.momentum**2 / 2
    pushed = Hamiltonian(kinetic + (x**2 + y**2) / 8 + y * kick, q, [x.momentum, y.momentum])
    motion = propagate(pushed, (0.0, 3.0), [1.5, 0.0, 2.0**20, 0.0], method=method, samples=8)
    with mp.workdps(40):
        for t, found, stated in zip(motion.t, motion["y"], motion.error_estimate().error[1], strict=True):
            end = mpf(float(t))
            true = -mp.quad(
                lambda s, end=end: 2 * mp.sin((end - s) / 2) * mp.exp(-((8 * s - mpf(3) / 2) ** 2)) / 32,
                [0, *(place for place in (mpf(3) / 16, mpf(1)) if place < end), end],
            )
            assert abs(found - true) <= stated


def test_twice_a_rounding_of_the_largest_number_is_cut_off_from_series_that_are_there():
    """And nothing of a coordinate that stays zero."""
    taylor = SimpleNamespace(plan=SimpleNamespace(h=None))
    scale, y = np.array([3.0, 0.0, 5.0, 1.0]).reshape(4, 1, 1), np.ones((4, 2, 1))
    y[1] = 0.0
    cut = CompanionTask(taylor, "in doubles", 1e-16).truncation(scale, y)
    assert cut.ravel().tolist() == [1e-15, 0.0, 1e-15, 1e-15]
