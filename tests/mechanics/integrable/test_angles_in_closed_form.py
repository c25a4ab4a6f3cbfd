"""Angles in closed form: Kepler's equation, the pendulum's amplitude; each known integral in both ways; wrong twins."""

from types import SimpleNamespace

import pytest
import sympy as sp
from flint import arb

from canon.flow.propagation import propagate
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.actions import action_variables
from canon.mechanics.integrable.closed_form import angles_in_closed_form as module
from canon.mechanics.integrable.closed_form.angles_in_closed_form import closed_angles
from canon.mechanics.integrable.closed_form.incomplete_integrals import integrals_by_terms
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.mechanics.integrable.cycles import CycleKind

q, p = sp.symbols("q p", real=True)
r, theta, w = sp.symbols("r theta omega", positive=True)
phi, p_r, p_theta, p_phi = sp.symbols("phi p_r p_theta p_phi", real=True)
HALF, QUARTER = sp.Rational(1, 2), sp.Rational(1, 4)

ONE = {
    "oscillator": (p**2 / 2 + 2 * q**2 + q, {q: 1, p: 1}),
    "pendulum": (p**2 / 2 - sp.cos(q), {q: 0, p: 1}),
    "pendulum about π": (p**2 / 2 + sp.cos(q), {q: 3, p: 1}),
    "rotation": (p**2 / 2 - sp.cos(q), {q: 0, p: 3}),
    "rotation backwards over π": (p**2 / 2 + sp.cos(q), {q: 0, p: -3}),
    "Morse": (p**2 / 2 + (1 - sp.exp(-q)) ** 2, {q: 0, p: HALF}),
    "Morse mirrored": (p**2 / 2 + (1 - sp.exp(2 * q)) ** 2, {q: 0, p: HALF}),
    "Pöschl–Teller": (p**2 / 2 - 3 / sp.cosh(2 * q) ** 2, {q: 0, p: 1}),
    "trigonometric well": (p**2 / 2 + 3 / sp.cos(q) ** 2, {q: 0, p: 1}),
    "trigonometric well by a tangent": (p**2 / 2 + 2 * sp.tan(q) ** 2, {q: QUARTER, p: 1}),
    "Pöschl–Teller by a tangent": (p**2 / 2 + sp.tanh(q) ** 2, {q: QUARTER, p: 1}),
    "hard spring": (p**2 / 2 + q**2 / 2 + q**4, {q: 0, p: 1}),
    "over both wells": (p**2 / 2 - q**2 / 2 + q**4, {q: 0, p: 1}),
    "one of two wells": (p**2 / 2 - q**2 / 2 + q**4 / 4, {q: 1, p: QUARTER}),
    "soft spring": (p**2 / 2 + q**2 / 2 - q**4 / 8, {q: 0, p: HALF}),
}
QUICK = {"oscillator", "pendulum", "rotation backwards over π"}


@pytest.mark.parametrize("wave", [sp.sin, sp.cos])
def test_a_polar_angle_of_two_turns_a_turn_has_the_derivative_of_its_integral(wave):
    f, place = wave(2 * q) ** -2, sp.Rational(9, 10) if wave is sp.sin else sp.Rational(3, 10)
    cycle = SimpleNamespace(kind=CycleKind.LIBRATION, turning_points=(arb(0.2), arb(1.3)))
    found = integrals_by_terms("polar angle", sp.Integer(5), {f: sp.Integer(-1)}, q, cycle)
    for each, integral in found.items():
        slope = integral.part.diff(q).subs(q, place)
        assert abs(sp.N(slope - (each / (2 * sp.sqrt(5 - f))).subs(q, place))) < 1e-12


def torus_of(H, start):
    return action_variables(hamilton_jacobi(H), start)


@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in ONE]
)
def test_known_integrals_have_their_angles_in_both_ways(name):
    H, start = ONE[name]
    torus = torus_of(Hamiltonian(H, q, p), start)
    for sign in (1, -1):
        (angle,) = closed_angles(torus, {q: sign})
        assert angle is not None
        assert angle.tori == 3
        assert angle.signs == {q: sign}


def test_the_pendulums_angle_is_its_amplitude_in_units_of_a_quarter_period():
    (angle,) = closed_angles(torus_of(Hamiltonian(p**2 / 2 - sp.cos(q), q, p), {q: 0, p: 1}))
    m = (sp.Symbol("E", real=True) + 1) / 2
    F = sp.elliptic_f(sp.asin(sp.sin(q / 2) / sp.sqrt(m)), m)
    textbook = sp.pi / 2 * (F / sp.elliptic_k(m) + 1)
    at = {q: 0.3, sp.Symbol("E", real=True): -0.4}
    assert abs(sp.N((angle.theta - textbook).subs(at))) < 1e-14


@pytest.mark.slow
def test_the_radial_angle_is_keplers_equation():
    kepler = Hamiltonian(p_r**2 / 2 + p_phi**2 / (2 * r**2) - 1 / r, [r, phi], [p_r, p_phi])
    radial, azimuth = closed_angles(torus_of(kepler, {r: 1, phi: 0, p_r: QUARTER, p_phi: 1}))
    E, L = torus_constants = sp.Symbol("E", real=True), sp.Symbol("alpha_phi", real=True)
    a, e, u = 1.3, 0.4, 2.1
    at = dict(zip(torus_constants, (-1 / (2 * a), (a * (1 - e**2)) ** 0.5), strict=True))
    at[r] = a * (1 - e * sp.cos(u).evalf())
    assert abs(sp.N(radial.theta.subs(at)) - (u - e * sp.sin(u).evalf())) < 1e-12
    anomaly = 2 * sp.atan(
        ((1 + e) / (1 - e)) ** 0.5 * sp.tan(u / 2).evalf()
    )  # the pericentre is at φ − true anomaly
    assert (
        abs(sp.N(azimuth.theta.subs(at | {phi: 0.7})) - (0.7 - anomaly + u - e * sp.sin(u).evalf())) < 1e-12
    )
    assert E in radial.theta.free_symbols
    assert L in azimuth.theta.free_symbols


@pytest.mark.slow
@pytest.mark.parametrize(
    ("H", "start"),
    [
        (
            Hamiltonian(
                p_r**2 / 2 + (p_theta**2 + p_phi**2 / sp.sin(theta) ** 2) / (2 * r**2) - 1 / r,
                [r, theta, phi],
                [p_r, p_theta, p_phi],
            ),
            {r: 1, theta: 1, phi: 0, p_r: QUARTER, p_theta: HALF, p_phi: HALF},
        ),
        (
            Hamiltonian(
                p_r**2 / 2 + p_phi**2 / (2 * r**2) - 1 / (1 + sp.sqrt(1 + r**2)), [r, phi], [p_r, p_phi]
            ),
            {r: 1, phi: 0, p_r: QUARTER, p_phi: HALF},
        ),
        (
            Hamiltonian(p_r**2 / 2 + p_phi**2 / (2 * r**2) + r**2, [r, phi], [p_r, p_phi]),
            {r: 1, phi: 0, p_r: QUARTER, p_phi: HALF},
        ),
    ],
    ids=["Kepler in space", "isochrone", "oscillator in the plane"],
)
def test_several_coordinates_have_their_angles(H, start):
    for signs in ({}, {r: -1}):
        assert None not in closed_angles(torus_of(H, start), signs)


@pytest.mark.slow
def test_angles_grow_with_the_frequency_along_a_motion():
    H = Hamiltonian(p**2 / 2 - sp.cos(q), q, p)
    torus = torus_of(H, {q: 0, p: 1})
    (out,), (back,) = (closed_angles(torus, {q: sign}) for sign in (1, -1))
    energy = {sp.Symbol("E", real=True): -HALF}
    motion = propagate(H, (0, 6), {"q": 0, "p": 1}, samples=13)
    omega = float(torus.frequencies[0])
    for time, place, momentum in zip(motion.t, motion.q[0], motion.p[0], strict=True):
        angle = out if momentum > 0 else back
        found = float(sp.N(angle.theta.subs(energy | {q: float(place)})))
        turned = (found - sp.pi / 2 - omega * time) / (2 * sp.pi)
        assert abs(float(turned - round(turned))) < 1e-9


def test_a_wrong_integral_is_not_returned(monkeypatch):
    torus = torus_of(Hamiltonian(p**2 / 2 + 2 * q**2, q, p), {q: 1, p: 1})
    right = module.integrals_by_terms

    def doubled(*given):
        return {f: module.Incomplete(2 * each.part, each.whole) for f, each in right(*given).items()}

    monkeypatch.setattr(module, "integrals_by_terms", doubled)
    assert closed_angles(torus) == (None,)


def test_what_is_not_known_is_none():
    assert closed_angles(torus_of(Hamiltonian(p**2 / 2 + q**6, q, p), {q: 0, p: 1})) == (None,)


@pytest.mark.parametrize(
    ("signs", "said"), [({p: -1}, "p is none of q"), ({q: 2}, "a sign is 1, or -1")], ids=["momentum", "two"]
)
def test_signs_that_are_none_are_refused(signs, said):
    torus = torus_of(Hamiltonian(p**2 / 2 + 2 * q**2, q, p), {q: 1, p: 1})
    with pytest.raises(ValueError, match=said):
        closed_angles(torus, signs)
