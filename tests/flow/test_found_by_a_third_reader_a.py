"""What a third reading of fixed steps, events and time transformations found, each beside what must go on working."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import sympy as sp

from canon import (
    Event,
    Gauss,
    Hamiltonian,
    Lagrangian,
    Splitting,
    TimeTransformed,
    coordinates,
    parameters,
    propagate,
    time,
)
from canon.flow import (
    ExtendedPhaseSpace,
    GalerkinVariational,
    Interrupted,
    NonFiniteStateError,
    poincare_section,
)
from canon.flow.chaos.periodic_search import NoPeriodicOrbitError
from canon.flow.method.method_text import method_named
from canon.mechanics.algebra.linear import SingularMatrixError

x, y = coordinates("x y")
p, px, py = x.momentum, x.momentum, y.momentum
m, g, mu, a = parameters("m g mu a", positive=True)
r = sp.sqrt(x**2 + y**2)
falling = Hamiltonian(p**2 / 2 + x, [x], [p])
oscillator = Hamiltonian(p**2 / 2 + x**2 / 2, [x], [p])
kepler = Hamiltonian((px**2 + py**2) / 2 - mu / r, [x, y], [px, py])
VERLET = {"method": "verlet", "step": 0.01}


def test_between_its_samples_a_galerkin_method_has_the_mass_of_that_time():
    drive = {"L": Lagrangian(x.dot**2 / 2 * (1 + sp.sin(time) / 3) - x**2 / 2, [x]), "t0": 1}
    still = {"L": Lagrangian(x.dot**2 / 2 - x**2 / 2, [x]), "t0": 0}
    for each in (drive, still):
        span = (each["t0"], each["t0"] + 2)
        few, every = (
            propagate(each["L"], span, [1, 0], samples=n, method=GalerkinVariational(3), step=0.05)
            for n in (2, 40)
        )
        assert abs(few(every.t) - every.y).max() < 1e-14


@pytest.mark.parametrize("precision", ["double", "extended"])
@pytest.mark.parametrize("falls", [0, 22, 150, 199])
def test_the_orbit_that_is_lost_is_named(precision, falls):
    start = np.array([[1.0] * 200, [0.0] * 200, [0.0] * 200, [1.0] * 200])
    start[2, falls], start[3, falls] = -2.0, 0.0
    how = {"method": "verlet", "step": 1.0, "samples": 2, "precision": precision, "parameters": {mu: 1}}
    with pytest.raises(
        NonFiniteStateError, match=f"of orbit {falls}, after t = 0 where .* = \\(1, 0, -2, 0\\)"
    ):
        propagate(kepler, (0, 4), start, **how)
    with pytest.raises(NonFiniteStateError, match="in step 1, after t = 0"):  # one orbit has no number
        propagate(kepler, (0, 4), start[:, falls], **how)


def test_after_an_impact_the_other_events_of_that_step_are_met():
    events = [Event(x, -1, {p: -p / 2}, "floor"), Event(p, -1, "record", "top")]
    met = [
        propagate(falling, (0, 4.2), [1, 0], method="verlet", step=h, events=events).events
        for h in (0.1, 0.01)
    ]
    assert [str(each.event) for each in met[0]] == ["floor", "top"] * 6 + ["floor"]
    assert np.allclose([each.t for each in met[0]], [each.t for each in met[1]], rtol=0, atol=1e-12)


def test_an_impact_itself_is_no_crossing_of_the_momentum():
    events = [Event(x, -1, "bounce"), Event(p, 1, "record", "rises"), Event(p, -1, "record", "top")]
    met = propagate(falling, (0, 6), [0.5, 0], events=events, **VERLET).events
    assert [str(each.event) for each in met] == ["x = 0", "top"] * 2 + ["x = 0"] + ["top"] * (len(met) - 5)
    assert np.allclose([each.t for each in met[:5]], [1, 2, 3, 4, 5])


def test_bodies_whose_masses_differ_by_orbit_bounce():
    heavy = Hamiltonian(p**2 / (2 * m) + m * g * x, [x], [p])
    wall = [Event(x, -1, "bounce")]
    met = propagate(heavy, (0, 3), [1, 0], parameters={m: [1, 2], g: 10}, events=wall, **VERLET).events
    for each in met:
        assert np.allclose([hit.t for hit in each], np.sqrt(0.2) * np.array([1, 3, 5]))
    quartic = Hamiltonian(p**4 / m + m * x, [x], [p])
    with pytest.raises(ValueError, match="H is not quadratic"):
        propagate(quartic, (0, 3), [1, 0], parameters={m: [1, 2]}, events=wall, **VERLET)


def test_walls_may_stand_elsewhere_for_each_orbit():
    placed = Hamiltonian(p**2 / 2 + x + a, [x], [p])
    run = propagate(
        placed, (0, 3), [1, 0], parameters={a: [0.25, 0.5]}, events=[Event(x - a, -1, "bounce")], **VERLET
    )
    assert np.allclose([each[0].t for each in run.events], np.sqrt([1.5, 1.0]))
    assert abs(run.energy_error).max() < 1e-14
    with pytest.raises(ValueError, match="is no wall"):
        propagate(
            placed,
            (0, 3),
            [1, 0],
            parameters={a: [0.2, 0.5]},
            events=[Event(a - time, 0, "bounce")],
            **VERLET,
        )


def test_a_time_transformation_may_hold_parameters_of_its_own():
    def final(clock, **values):
        method = TimeTransformed(Gauss(4), g=clock)
        return propagate(kepler, (0, 5), [1, 0, 0, 1.1], method=method, step=0.01, parameters=values).final

    plain = final(r, mu=1)
    assert np.allclose(final(sp.sqrt(r**2 + a**2), mu=1, a=0.1), plain, rtol=0, atol=1e-11)
    assert np.allclose(final(r * (2 + sp.sin(sp.Symbol("t"))), mu=1), plain, rtol=0, atol=1e-11)
    with pytest.raises(KeyError, match="no parameter a"):
        final(r, mu=1, a=0.1)
    with pytest.raises(KeyError, match="holds a"):
        final(sp.sqrt(r**2 + a**2), mu=1)


@pytest.mark.parametrize("wrong", ["r", [1]])
def test_g_of_a_time_transformation_is_an_expression(wrong):
    with pytest.raises(TypeError, match="g of TimeTransformed should be an expression"):
        TimeTransformed(Gauss(4), g=wrong)


def test_an_orbit_that_has_its_points_may_be_lost_after():
    escaping = Hamiltonian(p**2 / 2 - x**4, [x], [p])
    starts = np.array([[0.5, 0.01], [1.0, 0.01]])
    how = {"method": "verlet", "step": 0.01}
    both = poincare_section(escaping, (0, 60), starts, x - 1, points=1, **how)
    for k in range(2):
        alone = poincare_section(escaping, (0, 60), starts[:, k], x - 1, points=1, **how)
        assert both.t[both.orbit == k] == alone.t
    with pytest.raises(NonFiniteStateError, match="of orbit 1"):
        poincare_section(escaping, (0, 3), starts[:, ::-1], x - 1, points=2, **how)


LOGARITHMIC = TimeTransformed(Splitting("verlet"))
CIRCLING = {"method": LOGARITHMIC, "step": 0.01, "parameters": {mu: 1}}


@pytest.mark.parametrize("wrong", [-5, 0, 0.5, "7", [7]])
def test_samples_are_counted_where_a_transformed_motion_goes_on_too(wrong):
    run = propagate(kepler, (0, 5), [1, 0, 0, 1.1], samples=20, **CIRCLING)
    with pytest.raises(ValueError, match="keep at least one state"):
        run.resume(10, samples=wrong)
    assert run.resume(10, samples=7).t[-1] == 10
    assert len(run.resume(10).t) >= 20
    with pytest.raises(ValueError, match="keep at least one state"):
        propagate(oscillator, (0, 1), [1, 0], samples=wrong, **VERLET)


def test_cadence_is_counted():
    for wrong in (float("nan"), "3", 0, 2.5):
        with pytest.raises(ValueError, match="give a number of steps, 1 or more"):
            propagate(oscillator, (0, 1), [1, 0], samples=10, cadence=wrong, **VERLET)
    assert len(propagate(oscillator, (0, 1), [1, 0], samples=10, cadence=np.int64(2), **VERLET).t) == 11


def test_times_may_be_the_ends_of_a_span_that_is_given_exactly():
    exactly = {"method": "verlet", "step": "0.01"}
    assert list(propagate(oscillator, ("0.3", 1), [1, 0], times=[0.3, 0.5], **exactly).t) == [0.3, 0.5, 1]
    tenths = np.linspace(0, 0.1, 11)
    assert np.array_equal(propagate(oscillator, (0, "0.1"), [1, 0], times=tenths, **exactly).t, tenths)
    for outside in ([0.29, 0.5], [0.3, 0.5, 1.01], [np.nextafter(0.3, 0), 0.5]):
        with pytest.raises(ValueError, match="outside t_span"):
            propagate(oscillator, ("0.3", 1), [1, 0], times=outside, **exactly)


@pytest.mark.parametrize("step", [0.125, 0.3])
def test_the_time_at_which_a_motion_stops_is_kept_once(step):
    stop = [Event(x, -1, "stop")]
    run = propagate(falling, (0, 6), [0.5, 0], method="verlet", step=step, events=stop)
    assert run.t[-1] == 1
    assert (np.diff(run.t) > 0).all()
    assert np.allclose(run.final, [0, -1])
    assert [met.t for met in run.events] == [1]


def test_errors_come_back_from_other_processes():
    lost = pickle.loads(pickle.dumps(NonFiniteStateError("lost", 1.5, np.array([1.0, 2.0]))))
    assert (str(lost), lost.time, list(lost.state)) == ("lost", 1.5, [1, 2])
    far = pickle.loads(pickle.dumps(NoPeriodicOrbitError("none", np.zeros(2), 3.0, 0.5)))
    assert (str(far), far.period, far.defect) == ("none", 3, 0.5)
    singular = pickle.loads(pickle.dumps(SingularMatrixError("singular", (sp.Integer(1), x))))
    assert (str(singular), singular.null_direction) == ("singular", (1, x))
    broken = pickle.loads(pickle.dumps(Interrupted(propagate(oscillator, (0, 1), [1, 0], **VERLET))))
    assert str(broken).startswith("interrupted at t = 1")
    assert broken.motion.t[-1] == 1


def test_the_logarithmic_transformation_takes_a_sum_over_a_mass():
    divided = Hamiltonian((px**2 / 2 + py**2 / 2 - 1 / r) / mu, [x, y], [px, py])
    found, plain = (propagate(each, (0, 5), [1, 0, 0, 1.1], **CIRCLING).final for each in (divided, kepler))
    assert np.allclose(found, plain, rtol=0, atol=1e-12)
    mixed = Hamiltonian((px**2 / 2 + py**2 / 2 - px / r) / mu, [x, y], [px, py])
    with pytest.raises(ValueError, match="needs H = T"):
        propagate(mixed, (0, 5), [1, 0, 0, 1.1], **CIRCLING)


def test_a_first_step_may_be_text():
    written = propagate(kepler, (0, 5), [1, 0, 0, 1.1], **{**CIRCLING, "step": "0.01"}).final
    assert np.allclose(
        written, propagate(kepler, (0, 5), [1, 0, 0, 1.1], **CIRCLING).final, rtol=0, atol=1e-12
    )
    for wrong in (None, 0, -1, float("nan"), "-1"):
        with pytest.raises(ValueError, match="the size in t of its first step"):
            propagate(kepler, (0, 5), [1, 0, 0, 1.1], **{**CIRCLING, "step": wrong})


def test_new_values_of_an_event_are_expressions_and_may_hold_a_bare_t():
    with pytest.raises(TypeError, match="the new p_x of the event x = 0 should be an expression"):
        Event(x, -1, {p: "-p"})
    with pytest.raises(ValueError, match="is nan, which is no finite quantity"):
        Event(x, -1, {p: sp.nan})
    for t in (sp.Symbol("t"), time):
        run = propagate(falling, (0, 1.5), [0.5, 0], events=[Event(x, -1, {p: -p * sp.cos(t)})], **VERLET)
        assert np.allclose(run.events[0].after, [0, np.cos(1)])


def test_methods_take_their_arguments_in_any_type_or_say_what_they_are():
    halves = p**2 / 2, x**2 / 2
    assert Splitting("verlet", parts=list(halves)) == Splitting("verlet", parts=sp.Tuple(*halves))
    for wrong in (halves[:1], halves[0]):
        with pytest.raises(ValueError, match="give the two parts of H"):
            Splitting("verlet", parts=wrong)
    with pytest.raises(ValueError, match="no splitting is called"):
        Splitting(["verlet"])
    final = propagate(oscillator, (0, 1), [1, 0], method=Gauss(2.0), step=0.1).final
    assert np.allclose(final, [np.cos(1), -np.sin(1)], atol=1e-6)
    with pytest.raises(ValueError, match=r"no method is called 'tao-4, omega 1\.\.2'"):
        method_named("tao-4, omega 1..2")
    omegas = {"1.2": 1.2, ".5": 0.5, "5.": 5, "2e1": 20, "=3": 3, "1.5e-1": 0.15}
    for text, omega in omegas.items():
        assert method_named(f"tao-4, omega {text}") == ExtendedPhaseSpace(4, omega=omega)


def test_single_precision_refuses_a_rate_that_it_has_not():
    weak = Hamiltonian(p**2 / 2 + sp.Rational(1, 10**50) * x, [x], [p])
    slow = {"method": "verlet", "step": 1e23, "samples": 1}
    with pytest.raises(ValueError, match="the rate of p_x at the start is 1e-50 in size, but 0 in single"):
        propagate(weak, (0, 1e25), [0, 0], precision="single", **slow)
    assert np.allclose(propagate(weak, (0, 1e25), [0, 0], **slow).final, [-0.5, -1e-25], atol=0)
    # in little time that rate comes to nothing in any precision
    assert list(propagate(weak, (0, 1), [1, 0], precision="single", **VERLET).final) == [1, 0]


def test_places_of_a_section_are_in_the_precision_of_the_motion():
    how = {"method": "sofroniou-spaletta-10", "step": 0.02}
    found = {
        precision: poincare_section(
            "henon-heiles", (0, 40), [0.0, 0.1, 0.45, 0.0], "x", precision=precision, **how
        )
        for precision in ("compensated", "extended")
    }
    errors = {precision: abs(section.energy_change).max() for precision, section in found.items()}
    assert errors["extended"] < 4e-18
    assert np.allclose(found["extended"].y, found["compensated"].y, rtol=0, atol=1e-14)


def test_times_of_a_motion_are_one_or_a_list():
    run = propagate(oscillator, (0, 1), [1, 0], **VERLET)
    assert run([]).shape == (2, 0)
    assert run([0.5]).shape == (2, 1)
    assert run(0.5).shape == (2,)
    with pytest.raises(ValueError, match=r"times of shape \(2, 2\): give one time or a list"):
        run(np.zeros((2, 2)))
