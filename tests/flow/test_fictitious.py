"""Time-transformed motions as others: named times, events, observables, ensembles, interruption and resumption."""

from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from canon.flow.checked_request import hamilton_equations_of
from canon.flow.fixed_step.partial_step import LoopState, PartialSteps
from canon.flow.method.method import Gauss, Splitting, TimeTransformed
from canon.flow.propagation import Interrupted, propagate
from canon.flow.run.event import Event
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.transformed.extended_hamiltonian import extended, extended_system
from canon.flow.transformed.land_at_time import Segment, state_at_time
from tests.flow.systems import KEPLER, PENDULUM, System, kepler_start
from tests.flow.test_geometry import kepler_orbit

x, y = KEPLER.q
px, py = KEPLER.p
RADIUS = sp.sqrt(x**2 + y**2)
PERIOD = 2 * np.pi
LOGARITHMIC = TimeTransformed(Splitting("kahan-li-8"))
POINCARE = TimeTransformed(Gauss(6), RADIUS)
METHODS = [LOGARITHMIC, TimeTransformed(Splitting("verlet")), POINCARE]
RADIAL = x * px + y * py


def keywords(method, **others):
    return {
        "system": KEPLER, "y0": kepler_start(0.9), "t_span": (0, 20), "method": method, "step": 0.004, **others,
    }  # fmt: skip


def at_time(t):
    """A state of the extended Kepler problem."""
    state = np.array([[1.0], [0.0], [float(t)], [0.0], [1.0], [0.5]])
    return LoopState(state, np.zeros_like(state))


def extended_kepler():
    larger = extended(KEPLER, LOGARITHMIC)
    return extended_system(larger, hamilton_equations_of(larger, {}), KEPLER, Fraction(1))


# times ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", [LOGARITHMIC, POINCARE], ids=str)
def test_named_times_are_landed_at_and_the_states_there_are_the_closed_form(method):
    times = np.sort(np.random.default_rng(1).uniform(0, 20, 40))
    found = propagate(**keywords(method, times=times))
    np.testing.assert_array_equal(found.t, [0.0, *times, 20.0])
    true = np.stack([kepler_orbit(kepler_start(0.9), t) for t in found.t], axis=1)
    assert abs(found.y - true).max() < 3e-11


@pytest.mark.parametrize("method", METHODS, ids=str)
def test_looking_at_it_leaves_the_motion_as_it_is(method):
    many = propagate(**keywords(method, times=np.linspace(0.1, 19.9, 57)))
    few, even = propagate(**keywords(method, times=[7.0])), propagate(**keywords(method, samples=30))
    for other in (few, even):
        np.testing.assert_array_equal(many.final, other.final)
        np.testing.assert_array_equal(many.carried[:, -1], other.carried[:, -1])
        assert many.steps == other.steps
    assert 7.0 in few.t


@pytest.mark.parametrize("forward", [1, -1])
@pytest.mark.parametrize("precision", ["single", "double", "compensated", "extended", "double-double"])
def test_times_are_landed_at_in_every_precision_and_direction(precision, forward):
    times = forward * np.array([0.3, 2.0, PERIOD, 6.4])
    found = propagate(
        **{**keywords(LOGARITHMIC, times=times, precision=precision), "t_span": (0, 7 * forward)}
    )
    true = np.stack([kepler_orbit(kepler_start(0.9), t) for t in found.t], axis=1)
    np.testing.assert_array_equal(found.t[1:-1], times)
    assert abs(found.y - true).max() < (2e-3 if precision == "single" else 2e-11)


def test_several_times_within_one_step():
    times = 10 + np.arange(1, 20) / 1000
    found = propagate(**keywords(LOGARITHMIC, times=times, precision="double-double"))
    true = np.stack([kepler_orbit(kepler_start(0.9), t) for t in found.t], axis=1)
    assert found.steps < 600
    assert abs(found.y - true).max() < 1e-11


@pytest.mark.parametrize("name", ["verlet", "forest-ruth", "blanes-moan-6"])
def test_the_order_in_t_at_landed_times(name):
    # By Verlet's and other splittings with log H the orbit is the true one and the time alone errs.
    method, times = TimeTransformed(Splitting(name)), [2.0, 5.0, 9.0, 12.0]
    true = np.stack([kepler_orbit(kepler_start(0.9), t) for t in times], axis=1)
    steps = np.array([0.008, 0.006, 0.0045, 0.0034])
    errors = [
        abs(propagate(**{**keywords(method, times=times), "step": h}).y[:, 1:-1] - true).max() for h in steps
    ]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(method.order, abs=0.3)


def test_the_order_in_t_of_gauss_methods_at_landed_times():
    method, times = TimeTransformed(Gauss(2), RADIUS), [2.0, 5.0, 9.0, 12.0]
    true = np.stack([kepler_orbit(kepler_start(0.9), t) for t in times], axis=1)
    steps = np.array([0.004, 0.003, 0.002, 0.0015])
    errors = [
        abs(propagate(**{**keywords(method, times=times), "step": h}).y[:, 1:-1] - true).max() for h in steps
    ]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(4, abs=0.3)


def test_short_runs_do_not_overshoot():
    found = propagate(**keywords(LOGARITHMIC, samples=1000) | {"t_span": (0, 0.05)})
    assert found.steps < 15
    # One part of a step or two for the landing, at 17 evaluations.
    assert found.evaluations <= (found.steps + 4) * 17


def test_a_collision_behind_the_end_does_no_harm():
    # Falling from rest, the collision is at t = π/√8 = 1.1107; steps of 0.02 far from it.
    start = [1.0, 0.0, 0.0, 0.0]
    found = propagate(KEPLER, (0, 1.1), start, method=POINCARE, step=0.01, samples=5)
    assert found.t[-1] == 1.1
    with pytest.raises(NonFiniteStateError) as lost:
        propagate(KEPLER, (0, 2.0), start, method=POINCARE, step=0.01, samples=5)
    assert lost.value.time == pytest.approx(1.1107, abs=0.01)
    assert lost.value.state.shape == (4,)
    assert f"t = {lost.value.time:.9g}" in str(lost.value)


def test_an_end_that_no_part_of_a_step_meets_is_an_error():
    # Steps in which the time passes a gap at once.
    steps = PartialSteps(SimpleNamespace(implicit=False), list, Fraction(0), Fraction(1))
    object.__setattr__(steps, "moved", lambda state, n, begin, end: at_time(end > Fraction(3, 10)))
    frame = extended_kepler()
    legs = [Segment(Fraction(0), at_time(0)), Segment(Fraction(1), at_time(1))]
    with pytest.raises(ArithmeticError, match=r"no part of a step ends at t = 0\.5"):
        state_at_time(frame, steps, legs, Fraction(1, 2), Fraction(1, 2**56), Fraction(1, 2**51))


# observables ----------------------------------------------------------------------------------------------


def test_observables_at_the_samples():
    found = propagate(**keywords(LOGARITHMIC, observables={"spin": x * py - y * px, "radius": RADIUS}))
    np.testing.assert_allclose(found.observables["radius"], np.hypot(*found.q), rtol=1e-15)
    assert abs(found.changes["spin"]).max() < 1e-14


# events ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", [LOGARITHMIC, POINCARE], ids=str)
@pytest.mark.parametrize("how", [{}, {"times": [3.0, 12.5]}])
def test_pericentres_are_passed_at_multiples_of_the_period(method, how):
    start = kepler_orbit(kepler_start(0.9), 1.0)
    given = {
        **keywords(method, events=[Event(RADIAL, 1)], **how),
        "y0": start,
        "t_span": (1, 40),
        "step": 0.08,
    }
    found = propagate(**given)
    passages = [met.t / PERIOD for met in found.events]
    np.testing.assert_allclose(passages, [1, 2, 3, 4, 5, 6], atol=2e-14)
    for met in found.events:
        np.testing.assert_allclose(met.y, kepler_start(0.9), atol=2e-12)
        assert met.rising
        assert met.event is given["events"][0]
    plain = propagate(**{**given, "events": []})
    np.testing.assert_array_equal(found.final, plain.final)


@pytest.mark.parametrize("method", [LOGARITHMIC, POINCARE], ids=str)
def test_passages_on_the_way_back(method):
    start = kepler_orbit(kepler_start(0.9), 1.0)
    given = {**keywords(method, events=[Event(RADIAL, -1)]), "y0": start, "t_span": (1, -40), "step": 0.08}
    # Back in time the radius grows after the pericentre too: r p_r falls there in the order of passing.
    found = [met.t / PERIOD for met in propagate(**given).events]
    np.testing.assert_allclose(found, [0, -1, -2, -3, -4, -5, -6], atol=2e-14)


@pytest.mark.parametrize("how", [{}, {"times": [0.5, 3.14, 4.0]}])
def test_an_event_stops_the_motion(how):
    apocentre = Event(RADIAL, -1, "stop")
    found = propagate(**keywords(LOGARITHMIC, events=[apocentre], **how))
    assert found.stopped
    assert found.t[-1] == found.events[0].t == pytest.approx(np.pi, abs=1e-14)
    np.testing.assert_allclose(found.final, [-1.9, 0, 0, -((0.1 / 1.9) ** 0.5)], atol=1e-13)
    if how:
        np.testing.assert_array_equal(found.t[:-1], [0, 0.5, 3.14])
    with pytest.raises(ValueError, match="ended by the event"):
        found.resume(30)


@pytest.mark.parametrize("end", [np.pi - 1e-9, np.pi - 0.05])
def test_an_event_in_the_last_step_but_behind_the_end_is_none(end):
    for action in ("stop", "record"):
        given = keywords(LOGARITHMIC, events=[Event(RADIAL, -1, action)])
        found = propagate(**{**given, "t_span": (0, end)})
        assert found.events == ()
        assert found.t[-1] == end


@pytest.mark.parametrize("method", [LOGARITHMIC, POINCARE], ids=str)
@pytest.mark.parametrize(
    "action",
    ["bounce", {px: -px / 2}],
    ids=["elastic", "half"],
)
def test_walls_by_another_method(method, action):
    wall = Event(x + sp.Rational(1, 2), 0, action)
    given = {
        **keywords(method, events=[wall], times=np.linspace(0.5, 8, 31)), "y0": kepler_start(0.5), "t_span": (0, 8.5),
        "step": 0.01,
    }  # fmt: skip
    found = propagate(**given)
    true = propagate(**{**given, "method": None, "step": None})
    assert len(found.events) == len(true.events) > 2
    np.testing.assert_allclose([a.t for a in found.events], [a.t for a in true.events], atol=1e-11)
    np.testing.assert_allclose(found.y, true.y, atol=1e-10)
    for a, b in zip(found.events, true.events, strict=True):
        np.testing.assert_allclose(a.after, b.after, atol=1e-10)


def test_a_moving_wall_changes_the_energy_and_the_motion_knows():
    wall = Event(x + sp.Rational(1, 2) + KEPLER.t / 50, 0, "bounce")
    given = {
        **keywords(LOGARITHMIC, events=[wall], times=[5.0]), "y0": kepler_start(0.5), "t_span": (0, 7), "step": 0.01,
    }  # fmt: skip
    found, true = propagate(**given), propagate(**{**given, "method": None, "step": None})
    assert abs(true.energy_change[-1]) > 1e-2
    np.testing.assert_allclose(found.y, true.y, atol=1e-11)


# interruption and resumption ------------------------------------------------------------------------------


def equal(a, b):
    np.testing.assert_array_equal(a.t, b.t)
    np.testing.assert_array_equal(a.y, b.y)
    np.testing.assert_array_equal(a.carried, b.carried)
    np.testing.assert_array_equal(a.energy_change, b.energy_change)
    assert a.steps == b.steps
    assert [(m.t, m.rising, m.y.tolist()) for m in a.events] == [
        (m.t, m.rising, m.y.tolist()) for m in b.events
    ]


def interrupted_at(part, given):
    def impatient(fraction):
        if fraction >= part:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted, match="resume") as caught:
        propagate(**given, progress=impatient)
    return caught.value.motion


WAYS = [
    {"samples": 20},
    {"samples": 2000},
    {"times": np.linspace(0.3, 19, 50)},
    {"samples": 20, "events": [Event(RADIAL), Event(y - 0.1 * x)]},
    {"times": np.linspace(0.3, 19, 50), "events": [Event(RADIAL)]},
    {"times": np.linspace(0.3, 19, 50), "events": [Event(x + 1, 0, {py: py * 11 / 10})]},
    {"samples": 20, "events": [Event(x + 1, 0, {py: py * 11 / 10})]},
]


@pytest.mark.parametrize("how", WAYS, ids=lambda how: ", ".join(how))
@pytest.mark.parametrize("method", [LOGARITHMIC, POINCARE], ids=str)
def test_an_interrupted_run_keeps_what_is_done_and_is_completed_bit_by_bit(method, how):
    given = keywords(method, **how)
    whole, part = propagate(**given), interrupted_at(0.4, given)
    kept = len(part.t)
    assert 0.2 * 20 < part.t[-1] < 0.9 * 20
    assert 3 < kept < len(whole.t)
    if "times" in how:
        np.testing.assert_array_equal(part.y, whole.y[:, :kept])
    assert all(met.t <= part.t[-1] for met in part.events)
    with pytest.raises(ValueError, match="complete the interrupted run"):
        part.resume(300)
    equal(part.resume(), whole)
    twice = interrupted_at(0.1, given)
    equal(twice.resume(), whole)


@pytest.mark.parametrize(
    ("precision", "how"),
    [
        ("single", WAYS[0]),
        ("double", WAYS[3]),
        ("extended", WAYS[0]),
        ("double-double", WAYS[0]),
        pytest.param("extended", WAYS[3], marks=pytest.mark.slow),
        pytest.param("double-double", WAYS[3], marks=pytest.mark.slow),
    ],
)
def test_a_run_resumed_is_the_run_in_one(precision, how):
    given = keywords(LOGARITHMIC, precision=precision, **how)
    whole = propagate(**given)
    half = propagate(**{**given, "t_span": (0, 9.7)})
    equal(half.resume(20), whole)
    equal(half.resume(11).resume(20), whole)


@pytest.mark.parametrize("how", WAYS[:1] + WAYS[2:3], ids=lambda how: ", ".join(how))
def test_a_continuation_that_is_interrupted_at_once_is_not_taken_for_a_whole_one(how):
    given = keywords(LOGARITHMIC, **how)
    whole = propagate(**given)
    half = propagate(
        **{**given, "t_span": (0, 9.7), **({"times": how["times"][:25]} if "times" in how else {})}
    )

    def impatient(_fraction):
        raise KeyboardInterrupt

    rest = {"times": how["times"][25:]} if "times" in how else {}
    with pytest.raises(Interrupted) as caught:
        half.resume(20, **rest, progress=impatient)
    part = caught.value.motion
    assert part.t[-1] <= 9.7
    np.testing.assert_array_equal(part.resume().final, whole.final)
    assert part.resume().steps == whole.steps


def test_a_run_with_named_times_goes_on_with_others():
    given = keywords(POINCARE, times=[1.0, 2.0, 9.7, 11.0, 15.0], events=[Event(RADIAL)])
    whole = propagate(**given)
    half = propagate(**{**given, "t_span": (0, 9.7), "times": [1, 2]})
    equal(half.resume(20, times=[11, 15]), whole)
    evenly = propagate(**{**given, "t_span": (0, 9.7), "times": None, "samples": 10})
    more = evenly.resume(20, times=[11, 15])
    np.testing.assert_array_equal(more.final, whole.final)
    np.testing.assert_array_equal(more.t[-3:], [11, 15, 20])
    with pytest.raises(ValueError, match="lies behind"):
        evenly.resume(5)
    with pytest.raises(ValueError, match="has arrived"):
        evenly.resume()


# many orbits ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", [LOGARITHMIC, POINCARE], ids=str)
def test_many_orbits_have_their_own_steps_and_common_times(method):
    start = np.stack([kepler_start(e) for e in (0.2, 0.5, 0.9)], axis=1)
    given = keywords(method, samples=16)
    found = propagate(**{**given, "y0": start})
    np.testing.assert_array_equal(found.t, np.linspace(0, 20, 17))
    assert found.y.shape == (4, 17, 3)
    steps = 0
    for k in range(3):
        one = propagate(**{**given, "y0": start[:, k], "samples": None, "times": found.t})
        np.testing.assert_array_equal(found.y[:, :, k], one.y)
        steps += one.steps
    assert found.steps == steps
    part = interrupted_at(0.3, {**given, "y0": start})
    assert 3 < len(part.t) < 17
    equal(part.resume(), found)
    equal(propagate(**{**given, "y0": start, "t_span": (0, 10), "samples": 8}).resume(20), found)


def test_parameters_may_vary_by_orbit():
    mu = sp.Symbol("mu", positive=True)
    heavy = System((px**2 + py**2) / 2 - mu / RADIUS, (x, y), (px, py))
    masses = np.array([1.0, 1.5, 2.0])
    found = propagate(
        heavy, (0, 6), kepler_start(0.5), method=LOGARITHMIC, step=0.01, samples=4, parameters={mu: masses}
    )
    assert found.y.shape == (4, 5, 3)
    for k, mass in enumerate(masses):
        one = propagate(heavy, (0, 6), kepler_start(0.5), samples=4, parameters={mu: mass})
        np.testing.assert_allclose(found.y[:, :, k], one.y, atol=1e-11)


def test_one_of_many_orbits_that_is_lost_is_named():
    start = np.array([[0.5, 1.0], [0.0, 0.0], [0.0, 0.0], [1.7, 0.0]])
    with pytest.raises(NonFiniteStateError, match="orbit 1"):
        propagate(KEPLER, (0, 2), start, method=POINCARE, step=0.01, samples=5)
    with pytest.raises(NonFiniteStateError, match="orbit 1: "):
        propagate(KEPLER, (0, 2), start, method=POINCARE, step=0.01, events=[Event(RADIAL)])


# time reversal --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS, ids=str)
def test_whole_steps_are_retraced_to_round_off(method):
    there = propagate(**keywords(method, samples=2000))
    # A state at the end of a whole step, from which steps of the same fictitious size lead back.
    k = len(there.t) // 2
    rates = np.hypot(*there.q)  # dt/ds is r for all of them
    back = propagate(
        KEPLER, (there.t[k], 0), there.y[:, k], method=method, step=0.004 * rates[k] / rates[0], samples=2000
    )
    assert k <= len(back.t) - 1 <= k + 1
    np.testing.assert_allclose(back.y[:, :k], there.y[:, k:0:-1], atol=1e-10)
    np.testing.assert_allclose(back.final, kepler_start(0.9), atol=1e-10)


def test_a_pendulum_with_a_g_of_its_own():
    (p,) = PENDULUM.p
    method = TimeTransformed(Gauss(5), 1 / (1 + p**2))
    found = propagate(PENDULUM, (0, 20), [2.0, 0.3], method=method, step=0.1, times=np.arange(1, 20))
    true = propagate(PENDULUM, (0, 20), [2.0, 0.3], samples=20)
    np.testing.assert_allclose(found.y, true.y, atol=1e-11)
