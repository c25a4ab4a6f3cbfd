"""Time transformations: close encounters with long steps, geometry in the fictitious time, and what is refused."""

import numpy as np
import pytest
import sympy as sp

from canon.flow.method.method import RK4, Gauss, Splitting, Taylor, TimeTransformed
from canon.flow.propagation import propagate
from canon.flow.transformed.extended_hamiltonian import extended
from tests.flow.systems import DOUBLE_PENDULUM, HENON_HEILES, KEPLER, PENDULUM, System, kepler_start
from tests.flow.test_geometry import compiled_jacobian, kepler_orbit
from tests.flow.test_solvable import planets, planets_start

x, y = KEPLER.q
LOGARITHMIC = TimeTransformed(Splitting("kahan-li-8"))
RADIUS = sp.sqrt(x**2 + y**2)


def motion(e, method, step, span=(0, 20 * np.pi + 1), **arguments):
    return propagate(KEPLER, span, kepler_start(e), method=method, step=step * (1 - e), **arguments)


@pytest.mark.parametrize("e", [0.9, 0.99, 0.999999])
def test_close_encounters_of_kepler_orbits(e):
    # Ten orbits in 650 steps. The energy -1/2 is a difference of terms 1/(1 - e) at the pericentre.
    found = motion(e, LOGARITHMIC, 0.1)
    assert found.steps < 700
    assert abs(found.energy_error).max() < 3e-14 / (1 - e)


def test_the_orbit_of_e_09_is_the_closed_form():
    found = motion(0.9, LOGARITHMIC, 0.05)
    assert found.t[-1] == pytest.approx(20 * np.pi + 1, abs=1e-13)
    assert abs(found.final - kepler_orbit(kepler_start(0.9), 20 * np.pi + 1)).max() < 1e-12


def test_without_the_transformation_as_many_steps_fail():
    found = propagate(
        KEPLER, (0, 20 * np.pi + 1), kepler_start(0.9), method=Splitting("kahan-li-8"), step=64 / 1000
    )
    assert abs(found.energy_error).max() > 1e-2


@pytest.mark.parametrize("e", [0.3, 0.9])
def test_verlet_stays_on_the_true_orbit_and_errs_in_time_only(e):
    # Mikkola & Tanikawa 1999; Preto & Tremaine 1999.
    found = motion(e, TimeTransformed(Splitting("verlet")), 0.05)
    r, (px, py) = np.hypot(*found.q), found.p
    lenz = py * (found.q[0] * py - found.q[1] * px) - found.q[0] / r
    inner = slice(0, -1)  # the landing ends within a step
    assert abs(found.energy_error[inner]).max() < 2e-14
    assert abs(lenz[inner] - e).max() < 1e-13
    true = kepler_orbit(kepler_start(e), found.t[-1])
    assert abs(found.final - true).max() > 1e-6


@pytest.mark.parametrize("name", ["verlet", "forest-ruth", "mclachlan-4", "blanes-moan-6"])
def test_fitted_orders_of_splittings_for_three_bodies(name):
    system, masses = planets("0.1")
    start, span = planets_start(masses), (0, 6)
    true = propagate(system, span, start, method=Taylor(), samples=1).final
    method = TimeTransformed(Splitting(name))
    steps = np.array([0.06, 0.04, 0.03]) * (2 if method.order > 4 else 1)
    errors = [
        abs(propagate(system, span, start, method=method, step=h, samples=4).final - true).max()
        for h in steps
    ]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(method.order, abs=0.35)


@pytest.mark.parametrize("stages", [1, 2, 3])
def test_fitted_orders_of_gauss_methods_with_poincares_transformation(stages):
    method = TimeTransformed(Gauss(stages), RADIUS)
    true = kepler_orbit(kepler_start(0.5), 7.0)
    steps = np.array([0.1, 0.07, 0.05])
    errors = [abs(motion(0.5, method, h, span=(0, 7), samples=4).final - true).max() for h in steps]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(2 * stages, abs=0.3)


@pytest.mark.parametrize(("e", "of_the_kinetic_energy"), [(0.9, 3e-14), (0.99, 3e-14), (0.999999, 1e-12)])
def test_gauss_methods_pass_close_encounters(e, of_the_kinetic_energy):
    # Near the pericentre times scale as r^(3/2); what rounding takes from H - E0 there turns the force by g'(H - E0).
    method = TimeTransformed(Gauss(8), RADIUS ** sp.Rational(3, 2))
    found = motion(e, method, 0.1 * (1 - e) ** 0.5)
    assert abs(found.energy_error).max() < of_the_kinetic_energy / (1 - e)


def test_a_constant_factor_of_g_is_of_no_account():
    once, twice = (motion(0.9, TimeTransformed(Gauss(4), k * RADIUS), 0.1, samples=50) for k in (1, 7))
    assert once.steps == twice.steps
    assert abs(once.final - twice.final).max() < 1e-10


@pytest.mark.parametrize("method", [LOGARITHMIC, TimeTransformed(Gauss(4), RADIUS)], ids=str)
def test_the_map_in_the_fictitious_time_is_symplectic(method):
    made = extended(KEPLER, method)
    system = System(made.H, made.q, made.p, made.t)
    start = [0.5, 0.0, 0.0, 0.0, 1.7, 0.5]
    m = compiled_jacobian(system, start, method.method, 0.1)
    j = np.kron([[0, 1], [-1, 0]], np.eye(3))
    assert abs(m.T @ j @ m - j).max() < 1e-9
    wrong = compiled_jacobian(system, start, RK4(), 0.1)
    assert abs(wrong.T @ j @ wrong - j).max() > 1e-8


@pytest.mark.parametrize("method", [LOGARITHMIC, TimeTransformed(Gauss(8), RADIUS)], ids=str)
def test_there_and_back(method):
    there = motion(0.9, method, 0.1, span=(0, 10))
    back = propagate(KEPLER, (10, 0), there.final, method=method, step=0.005)
    assert abs(back.t[-1]) < 1e-15
    assert abs(back.final - kepler_start(0.9)).max() < 2e-10


def test_a_driven_system_in_its_own_time():
    driven = System(KEPLER.H.subs(RADIUS, RADIUS) - sp.cos(KEPLER.t) / 50, KEPLER.q, KEPLER.p)
    tide = System(KEPLER.H - (2 + sp.cos(KEPLER.t)) / RADIUS / 20, KEPLER.q, KEPLER.p)
    true = propagate(tide, (0, 10), kepler_start(0.5), samples=1).final
    found = propagate(tide, (0, 10), kepler_start(0.5), method=LOGARITHMIC, step=0.01).final
    assert abs(found - true).max() < 1e-11
    assert not propagate(driven, (0, 1), kepler_start(0.5), method=LOGARITHMIC, step=0.01).autonomous


def test_samples_are_evenly_spaced_in_steps_and_no_more_than_twice_as_many():
    found = motion(0.9, LOGARITHMIC, 0.1, samples=20)
    assert 20 <= len(found.t) <= 42
    assert (np.diff(found.t) > 0).all()
    assert found.t[0] == 0
    steps = np.diff(motion(0.9, LOGARITHMIC, 0.1, samples=700).t)[:-1]
    assert len(steps) > 640
    assert steps.max() > 15 * steps.min()


@pytest.mark.parametrize("samples", [1, 3, 4, 10, 100])
def test_a_motion_whose_last_step_ends_at_the_end_has_that_state(samples):
    # With g = 1 the fictitious time is the time: 84 steps of 1/8 end at 10.5, thinned out or not.
    method = TimeTransformed(Gauss(2), sp.Integer(1))
    found = propagate(PENDULUM, (0, 10.5), [1.0, 0.0], method=method, step=0.125, samples=samples)
    plain = propagate(PENDULUM, (0, 10.5), [1.0, 0.0], method=Gauss(2), step=0.125, samples=1)
    assert found.t[-1] == 10.5
    assert found.steps == plain.steps == 84
    assert abs(found.final - plain.final).max() < 1e-14


@pytest.mark.parametrize(
    ("precision", "bits"), [("single", 24), ("double", 53), ("compensated", 53), ("double-double", 53)]
)
@pytest.mark.parametrize("forward", [1, -1])
def test_the_end_is_met_to_the_rounding_of_time(precision, bits, forward):
    found = motion(
        0.5, TimeTransformed(Splitting("verlet")), 0.02, span=(0, 10 * forward), precision=precision
    )
    assert abs(found.t[-1] - 10 * forward) <= 10 * 2.0 ** (1 - bits)


@pytest.mark.parametrize(
    ("system", "start", "method", "message"),
    [
        (HENON_HEILES, [0.1, 0.2, 0.3, 0.1], LOGARITHMIC, "positive along the motion"),
        (DOUBLE_PENDULUM, [1.0, 0.4, 0.1, -0.2], LOGARITHMIC, r"T\(p\) \+ V\(q, t\)"),
        (KEPLER, [0.5, 0, 0, 1.5], TimeTransformed(Gauss(2), -RADIUS), "positive along the motion"),
        (KEPLER, [0.5, 0, 1.5], LOGARITHMIC, "2 coordinates and 2 momenta"),
    ],
)
def test_what_cannot_be_transformed_is_refused(system, start, method, message):
    with pytest.raises(ValueError, match=message):
        propagate(system, (0, 1), start, method=method, step=0.01)


def test_steps_and_other_arguments_are_checked():
    for step in (None, 0.0, -1.0, float("nan")):
        with pytest.raises(ValueError, match="size in t of its first step"):
            propagate(KEPLER, (0, 1), kepler_start(0.5), method=LOGARITHMIC, step=step)
    with pytest.raises(ValueError, match="no length"):
        propagate(KEPLER, (1, 1), kepler_start(0.5), method=LOGARITHMIC, step=0.1)
    for foreign, message in (
        ({"cadence": 3}, "no statistics inside the loop"),
        ({"dense": True}, "no polynomials"),
        ({"tolerance": 1e-9}, "give step="),
        ({"times": [0.5, 2]}, "outside t_span"),
        ({"times": [0.5], "samples": 3}, "give one of them"),
    ):
        with pytest.raises(ValueError, match=message):
            propagate(KEPLER, (0, 1), kepler_start(0.5), method=LOGARITHMIC, step=0.1, **foreign)


def test_methods_without_a_transformation_of_theirs_are_refused():
    with pytest.raises(ValueError, match="does not split"):
        TimeTransformed(Splitting("verlet"), RADIUS)
    with pytest.raises(ValueError, match="how long a step"):
        TimeTransformed(Gauss(3))
