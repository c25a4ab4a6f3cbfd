"""Delaunay's and Poincaré's variables: canonical, constant along orbits, regular where they should be; wrong twins."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.flow.method.adaptive_methods import Taylor
from canon.flow.propagation import propagate
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.actions import action_variables
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.mechanics.integrable.kepler_maps import delaunay_from_poincare, poincare_from_delaunay
from canon.mechanics.integrable.kepler_variables import (
    delaunay_generating_function,
    delaunay_variables,
    poincare_variables,
)
from canon.proof.domain.domain import Domain

r, mu, m = sp.symbols("r mu m", positive=True)
theta, phi, p_r, p_theta, p_phi = sp.symbols("theta phi p_r p_theta p_phi", real=True)
anywhere = sp.Symbol("s", real=True)
PLANE = ([r, phi], [p_r, p_phi])
SPACE = ([r, theta, phi], [p_r, p_theta, p_phi])
PLACES = pytest.mark.parametrize("place", [PLANE, SPACE], ids=["plane", "space"])
KINDS = pytest.mark.parametrize("variables", [delaunay_variables, poincare_variables])
BUDGET = 60.0
"""Seconds, so that a busy machine decides the same."""
START = {r: 1.1, theta: 1.3, phi: 0.7, p_r: 0.2, p_theta: 0.3, p_phi: 0.8}


@KINDS
@PLACES
@pytest.mark.parametrize("mass", [1, m])
def test_they_are_canonical_and_the_energy_is_a_function_of_one_momentum(variables, place, mass):
    assert variables(*place, mu, mass).has_new_hamiltonian(BUDGET).holds


@PLACES
def test_another_energy_is_refused(place):
    right = delaunay_variables(*place, mu)
    for energy in (right.new.H / 2, -right.new.H, right.new.H * right.new.p[0] / right.new.p[1]):
        wrong = replace(right, new=Hamiltonian(energy, right.new.q, right.new.p))
        assert wrong.has_new_hamiltonian(BUDGET).fails


def test_the_steps_agree_with_the_whole_map():
    assert delaunay_variables(*SPACE, mu).transformation.is_canonical(budget=BUDGET).holds


@pytest.mark.parametrize(
    ("variables", "place"),
    [
        (delaunay_variables, PLANE),
        (poincare_variables, PLANE),
        (delaunay_variables, SPACE),
        (poincare_variables, SPACE),
    ],
)
def test_wrong_twins_are_not_canonical(variables, place):
    T = variables(*place, mu).steps[0]
    moved = [i for i in range(len(T.q)) if T.new_q[i] not in T.q]
    for i in moved:
        turned = [-Q if i == j else Q for j, Q in enumerate(T.new_q)]
        doubled = [2 * P if i == j else P for j, P in enumerate(T.new_p)]
        for q, p in ((turned, T.new_p), (T.new_q, doubled)):
            assert CanonicalTransformation(T.q, T.p, q, p, T.domain).is_canonical(budget=BUDGET).fails


def test_wrong_steps_are_not_canonical():
    right = delaunay_variables(*PLANE, mu)
    (T,) = right.steps
    # the eccentric anomaly in place of the mean one
    wrong = CanonicalTransformation(
        T.q, T.p, [T.new_q[0] + r * p_r / T.new_p[0], T.new_q[1]], T.new_p, T.domain
    )
    assert replace(right, steps=(wrong,)).is_canonical(budget=BUDGET).fails


@pytest.mark.parametrize("number", [2, 3])
def test_the_polar_map_and_its_inverse(number):
    l, g, h = sp.symbols("l g h", real=True)
    L, G = sp.symbols("L G", positive=True)
    angles, actions = [l, g, h][:number], [L, G, sp.Symbol("H", real=True)][:number]
    there = poincare_from_delaunay(angles, actions)
    x, Lambda = sp.Symbol("lambda", real=True), sp.Symbol("Lambda", positive=True)
    eta, xi = sp.symbols("eta1:3", real=True)[: number - 1], sp.symbols("xi1:3", real=True)[: number - 1]
    back = delaunay_from_poincare([x, *eta], [Lambda, *xi])
    assert there.is_canonical(budget=BUDGET).holds
    assert back.is_canonical(budget=BUDGET).holds
    whole = back.then(there)
    gaps = [(str(z), f - z) for z, f in zip(whole.variables, whole.images, strict=True)]
    assert all_vanish(gaps, "each comes back", whole.domain, BUDGET).holds


@pytest.mark.parametrize("change", ["no two", "sign", "cosine"])
def test_wrong_polar_maps_are_refused(change):
    l, g = sp.symbols("l g", real=True)
    L, G = sp.symbols("L G", positive=True)
    T = poincare_from_delaunay([l, g], [L, G])
    q, p = {
        "no two": ([T.new_q[0], T.new_q[1] / sp.sqrt(2)], [L, T.new_p[1] / sp.sqrt(2)]),
        "sign": ([l + g, -T.new_q[1]], T.new_p),
        "cosine": ([l, T.new_q[1]], T.new_p),
    }[change]
    assert CanonicalTransformation(T.q, T.p, q, p, T.domain).is_canonical(budget=BUDGET).fails


@PLACES
def test_poincares_variables_are_those_made_of_delaunays(place):
    delaunay, poincare = delaunay_variables(*place, mu, m), poincare_variables(*place, mu, m)
    by_way = delaunay.transformation.then(poincare_from_delaunay(delaunay.new.q, delaunay.new.p))
    direct = poincare.transformation
    q, p = direct.q, direct.p
    one, other = (sp.lambdify((mu, m, *q, *p), T.images) for T in (direct, by_way))
    rng = np.random.default_rng(3)
    for _ in range(20):
        radius, longitude, pole = 1 + rng.uniform(-0.2, 0.2), rng.uniform(-3, 3), rng.uniform(1, 2)
        outward, south, around = rng.uniform(-0.3, 0.3), rng.uniform(-0.4, 0.4), rng.uniform(0.7, 0.9)
        plane, space = (longitude, outward, around), (pole, longitude, outward, south, around)
        at = (1.25, 0.75, radius, *(plane if len(q) == 2 else space))
        gaps = np.subtract(one(*at), other(*at))
        gaps[0] -= 2 * np.pi * round(gaps[0] / (2 * np.pi))
        assert np.max(np.abs(gaps)) < 1e-13


@PLACES
def test_along_an_orbit_of_heyoka_one_angle_grows_and_all_else_stays(place):
    delaunay = delaunay_variables(*place, mu, m)
    values = {mu: 1.25, m: 0.75}
    q, p = delaunay.old.q, delaunay.old.p
    times = np.linspace(0, 9, 19)
    orbit = propagate(
        delaunay.old, (0, 9), [START[z] for z in (*q, *p)], method=Taylor(), times=times, parameters=values
    )
    f = sp.lambdify((*q, *p), [g.subs(values) for g in delaunay.transformation.images])
    rows = np.array([f(*state) for state in np.asarray(orbit.y).T])
    n, L = len(q), rows[0, len(q)]
    rate = values[m] * values[mu] ** 2 / L**3
    found = np.unwrap(rows[:, 0]) - rows[0, 0]
    assert np.max(np.abs(found - rate * times)) < 1e-12 * rate * 9 * 50
    assert np.max(np.abs(np.unwrap(rows[:, 1:n], axis=0) - rows[0, 1:n])) < 1e-12
    assert np.max(np.abs(rows[:, n:] - rows[0, n:])) < 1e-12
    wrong = values[mu] ** 2 / L**3
    assert np.max(np.abs(found - wrong * times)) > 0.1


def test_the_action_and_frequency_agree_with_certified_quadrature():
    delaunay = delaunay_variables(*PLANE, mu)
    at = {r: sp.Rational(11, 10), phi: 0, p_r: sp.Rational(1, 5), p_phi: sp.Rational(4, 5)}
    torus = action_variables(hamilton_jacobi(delaunay.old), at, {mu: 1})
    L = delaunay.transformation.new_p[0].subs({**at, mu: 1})
    assert abs(float(torus.J[0] + torus.J[1]) - float(L)) < 1e-14
    assert abs(float(torus.frequencies[0]) - float(1 / L**3)) < 1e-14
    assert abs(float(torus.frequencies[1]) - float(1 / L**3)) < 1e-14


rational = st.fractions(min_value="1/2", max_value=3, max_denominator=7).map(sp.Rational)
CIRCLE = {p_r: 0, p_phi: sp.sqrt(mu * r)}
PLANAR = poincare_variables(*PLANE, mu).transformation
JACOBIAN = sp.lambdify((mu, *PLANAR.q, *PLANAR.p), PLANAR.jacobian)
J = np.kron([[0, 1], [-1, 0]], np.eye(2))
ON_CIRCLES = [sp.simplify(f.subs(CIRCLE)) for f in PLANAR.images]


def test_circular_orbits_have_poincares_variables():
    assert [phi, 0, sp.sqrt(mu) * sp.sqrt(r), 0] == ON_CIRCLES


@given(rational, rational, st.floats(-1, 1))
@settings(deadline=None, max_examples=50)
def test_poincares_variables_are_smooth_at_circular_orbits(radius, strength, longitude):
    M = JACOBIAN(float(strength), float(radius), longitude, 0.0, float(sp.sqrt(strength * radius)))
    assert np.max(np.abs(M @ J @ M.T - J)) < 1e-13


def test_circular_orbits_in_the_equator_have_poincares_variables():
    T = poincare_variables(*SPACE, 1).transformation
    circle = (1.0, np.pi / 2, np.pi / 5, 0.0, 0.0, 1.0)
    images = sp.lambdify((*T.q, *T.p), T.images)(*circle)
    assert np.allclose(images, [np.pi / 5, 0, 0, 1, 0, 0], atol=1e-15)
    M = sp.lambdify((*T.q, *T.p), T.jacobian)(*circle)
    unit = np.kron([[0, 1], [-1, 0]], np.eye(3))
    assert np.max(np.abs(M @ unit @ M.T - unit)) < 1e-14


def test_delaunays_variables_do_not_claim_circular_orbits():
    domain = delaunay_variables(*PLANE, 1).transformation.domain
    circle = {r: 1, phi: 0, p_r: 0, p_phi: 1}
    assert sp.false in [c.subs(circle) for c in domain.conditions]
    assert sp.false not in [c.subs({**circle, p_r: sp.Rational(1, 9)}) for c in domain.conditions]


@pytest.mark.parametrize("outward", [True, False])
def test_hamiltons_function_generates_delaunays_map_on_its_half_of_the_orbit(outward):
    delaunay = delaunay_variables(*PLANE, mu)
    T, F = delaunay.transformation, delaunay_generating_function(delaunay, outward)
    half = p_r > 0 if outward else p_r < 0
    assert F.generates(T, Domain((*T.domain.conditions, half)), BUDGET).holds
    other = delaunay_generating_function(delaunay, not outward)
    assert other.generates(T, Domain((*T.domain.conditions, half)), BUDGET).fails


def test_radii_that_may_have_any_sign_are_kept_positive():
    found = delaunay_variables([anywhere, phi], [p_r, p_phi], mu)
    assert sp.Gt(anywhere, 0) in found.transformation.domain.conditions
    assert found.is_canonical(budget=BUDGET).holds


@KINDS
@pytest.mark.parametrize(
    ("arguments", "error", "text"),
    [
        (([r], [p_r], mu), ValueError, "two of each in a plane"),
        (([r, phi], [p_r], mu), ValueError, "two of each in a plane"),
        ((*PLANE, -1), ValueError, "k should be positive, not -1"),
        ((*PLANE, anywhere), ValueError, "declare its symbols positive"),
        ((*PLANE, mu, 0), ValueError, "m should be positive, not 0"),
        (([r, phi**2], [p_r, p_phi], mu), TypeError, "should be symbols"),
    ],
)
def test_what_is_no_kepler_problem_is_told(variables, arguments, error, text):
    with pytest.raises(error, match=text):
        variables(*arguments)


def test_generating_functions_of_other_variables_are_refused():
    for other in (poincare_variables(*PLANE, mu), delaunay_variables(*SPACE, mu)):
        with pytest.raises(ValueError, match="Delaunay's variables in a plane"):
            delaunay_generating_function(other)
