"""Lagrange's points, Stark–Kepler, J2, spin and orbit, two waves, Paul's trap, Atwood's machine: published facts."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.vanish import vanishes
from canon.scene import SceneError, find
from canon.scene.known_truths import check, conserved
from canon.scene.parts import Integral
from canon.scene.systems.celestial import EARTH_MOON, collinear_point
from canon.scene.systems.charge import MATHIEU_LIMIT, mathieu_exponent

NAMES = (
    "lagrange-points",
    "stark-kepler",
    "j2-satellite",
    "spin-orbit",
    "two-waves",
    "paul-trap",
    "swinging-atwood",
)
ROUTH = 0.0385208965045513718
"""Of Routh (1875): L4 is stable below it; (1 − √(69)/9)/2."""


@pytest.mark.parametrize("name", NAMES)
def test_what_is_said_of_them_is_met(name):
    scene = find(name)
    assert all(conserved(scene, integral).holds for integral in scene.integrals)
    found = check(scene, periods=20)
    assert all(each.passed for each in found), "\n".join(map(str, found))


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("stark-kepler", lambda s, I: I - s.F * (s.x**2 + s.y**2)),
        ("stark-kepler", lambda s, I: I + s.F * s.z**2 / 2),
        ("swinging-atwood", lambda s, I: I + s.g * s.r**2 * sp.sin(s.theta / 2)),
        ("lagrange-points", lambda s, I: I + s.x**2 + s.y**2),
        ("j2-satellite", lambda s, I: I + s.y * s.z.momentum - s.z * s.y.momentum),
    ],
)
def test_wrong_integrals_are_refused(name, wrong):
    scene = find(name)
    right = scene.integrals[-1].build
    assert conserved(scene, Integral("a wrong one", lambda s: wrong(s, right(s)))).fails


@pytest.mark.parametrize("ratio", [2, 4])
def test_tufillaros_integral_needs_the_threefold_mass(ratio):
    scene = find("swinging-atwood")
    s = scene.symbols
    other = scene.lagrangian.L + (ratio - 3) * (s.m * s.r.dot**2 / 2 - s.m * s.g * s.r)
    r, theta = scene.q
    equations = Lagrangian(other, scene.q)
    I = scene.integrals[0].build(s)
    rate = sum(
        I.diff(q) * q.dot + I.diff(q.dot) * a
        for q, a in zip((r, theta), equations.accelerations, strict=True)
    )
    assert vanishes(rate).fails


def test_the_collinear_points_are_where_they_are_published():
    """The roots of Euler's quintics (Szebehely, section 4.4); for a small mass Hill's cube root."""
    mu = EARTH_MOON
    euler = {
        1: [1, mu - 3, 3 - 2 * mu, -mu, 2 * mu, -mu],
        2: [1, 3 - mu, 3 - 2 * mu, -mu, -2 * mu, -mu],
        3: [1, 2 + mu, 1 + 2 * mu, mu - 1, 2 * mu - 2, mu - 1],
    }
    places = {1: lambda g: 1 - mu - g, 2: lambda g: 1 - mu + g, 3: lambda g: -mu - g}
    for number, quintic in euler.items():
        (root,) = (g.real for g in np.roots(quintic) if abs(g.imag) < 1e-9 and g.real > 0)
        assert collinear_point(mu, number) == pytest.approx(places[number](root), rel=1e-12)
    mu = 1e-9
    hill = (mu / 3) ** (1 / 3)
    assert 1 - mu - collinear_point(mu, 1) == pytest.approx(hill * (1 - hill / 3), rel=1e-5)
    assert collinear_point(mu, 2) - 1 + mu == pytest.approx(hill * (1 + hill / 3), rel=1e-5)
    assert collinear_point(mu, 3) == pytest.approx(-1 - 5 * mu / 12, abs=1e-12)


def test_all_five_are_equilibria_and_nothing_beside_them():
    scene = find("lagrange-points")
    field = [f.subs(scene.values_by_symbol()) for f in scene.hamiltonian.vector_field]
    rates = sp.lambdify((*scene.q, *scene.p), field)
    for start in scene.starts:
        state = scene.state(start.name)
        assert np.max(np.abs(rates(*state))) < 1e-13
        assert np.max(np.abs(rates(*(np.array(state) + 1e-6)))) > 1e-7


def linear_frequencies(mu, place):
    """Return the eigenvalues of the equations of motion linearised at a place of rest."""
    scene = find("lagrange-points")
    x, y = place
    at = {scene.symbols.mu: mu, **dict(zip((*scene.q, *scene.p), (x, y, -y, x), strict=True))}
    M = sp.Matrix(scene.hamiltonian.vector_field).jacobian([*scene.q, *scene.p]).subs(at)
    return np.linalg.eigvals(np.array(M, dtype=float))


def test_the_frequencies_of_l4_and_rouths_mass_ratio():
    """ω⁴ − ω² + 27 µ (1 − µ)/4 = 0, real where 27 µ (1 − µ) < 1."""
    for mu in (0.001, EARTH_MOON, ROUTH - 1e-6):
        squares = np.roots([1, -1, 27 * mu * (1 - mu) / 4])
        found = linear_frequencies(mu, (0.5 - mu, math.sqrt(0.75)))
        assert np.max(np.abs(found.real)) < 1e-7
        assert np.sort(found.imag**2)[::2] == pytest.approx(np.sort(squares.real), abs=1e-7)
    beyond = linear_frequencies(ROUTH + 1e-5, (0.5 - ROUTH - 1e-5, math.sqrt(0.75)))
    assert np.max(beyond.real) > 1e-3
    assert pytest.approx(1, rel=1e-15) == 27 * ROUTH * (1 - ROUTH)


@pytest.mark.parametrize(("number", "rate"), [(1, 2.932055933), (2, 2.158674329), (3, 0.1778753)])
def test_the_collinear_points_are_saddles_with_the_known_rates(number, rate):
    found = linear_frequencies(EARTH_MOON, (collinear_point(EARTH_MOON, number), 0.0))
    assert np.max(found.real) == pytest.approx(rate, rel=1e-6)
    assert np.sum(np.abs(found.real) > 1e-6) == 2


def test_stark_kepler_separates_in_parabolic_coordinates():
    x, z, px, pz = sp.symbols("x z p_x p_z", real=True)
    k, F = sp.symbols("k F", positive=True)
    plane = Hamiltonian((px**2 + pz**2) / 2 - k / sp.sqrt(x**2 + z**2) - F * z, [z, x], [pz, px])
    assert hamilton_jacobi(plane, "parabolic").is_complete_integral().holds


@pytest.mark.parametrize(("tilt", "sign"), [(50, -1), (130, 1)])
def test_the_node_goes_back_for_orbits_with_the_planet_and_forward_against_it(tilt, sign):
    """(3/2) J₂ n (R/p)² cos i, by SciPy's DOP853 in Newton's equations."""
    v = find("j2-satellite").values
    mu, R, J2, a, i = v["mu"], v["R"], v["J2"], 7000.0, math.radians(tilt)

    def newton(_t, y):
        r2 = y[:3] @ y[:3]
        flat = 1.5 * J2 * mu * R**2 / r2**2.5
        towards = np.array([5 * y[2] ** 2 / r2 - 1, 5 * y[2] ** 2 / r2 - 1, 5 * y[2] ** 2 / r2 - 3])
        return [*y[3:], *(-mu * y[:3] / r2**1.5 + flat * towards * y[:3])]

    n = math.sqrt(mu / a**3)
    speed = n * a
    span = 60 * 2 * math.pi / n
    start = [a, 0, 0, 0, speed * math.cos(i), speed * math.sin(i)]
    end = solve_ivp(newton, (0, span), start, "DOP853", rtol=1e-11, atol=1e-9).y[:, -1]
    L = np.cross(end[:3], end[3:])
    known = -1.5 * J2 * n * (R / a) ** 2 * math.cos(i) * span
    assert np.sign(known) == sign
    assert math.atan2(L[0], -L[1]) == pytest.approx(known, rel=5e-3)


@pytest.mark.parametrize(("part", "caught"), [(0.93, True), (1.07, False)])
def test_the_width_of_the_3_2_resonance(part, caught):
    """θ̇ = 3n/2 ± w n √(H(3/2, e)) is its edge (Goldreich & Peale 1966; Murray & Dermott, section 5.4)."""
    scene = find("spin-orbit")
    n, e, w = (scene.values[name] for name in "new")
    strength = 7 * e / 2 - 123 * e**3 / 16
    others = w**2 * n * (1 - 5 * e**2 / 2 + 13 * e**4 / 16 + (-e / 2 + e**3 / 16) / 2) / 2
    field = sp.lambdify(
        (scene.symbols.t, *scene.q, *scene.p),
        [f.subs(scene.values_by_symbol()) for f in scene.hamiltonian.vector_field],
    )
    start = [0.0, 1.5 * n + others + part * w * n * math.sqrt(strength)]
    motion = solve_ivp(lambda t, y: field(t, *y), (0, 200), start, rtol=1e-9, atol=1e-9, max_step=0.05)
    aside = np.abs(motion.y[0] - 1.5 * n * motion.t)
    assert bool(aside.max() < math.pi / 2) is caught


def test_resonances_that_overlap_are_refused():
    with pytest.raises(SceneError, match=r"the resonances lie apart where w is below"):
        find("spin-orbit").with_parameters(w=0.3)


@pytest.mark.parametrize(("amplitude", "passes"), [(0.01, False), (0.25, True)])
def test_two_waves_overlap_as_chirikov_says(amplitude, passes):
    """Particles between both waves get to p < 0 and to p > 1 where 2√M + 2√P > 1 by far, never where it is not."""
    scene = find("two-waves").with_parameters(M=amplitude, P=amplitude)
    field = sp.lambdify(
        (scene.symbols.t, *scene.q, *scene.p),
        [f.subs(scene.values_by_symbol()) for f in scene.hamiltonian.vector_field],
    )
    reached = []
    for p in (0.35, 0.45, 0.55):
        motion = solve_ivp(lambda t, y: field(t, *y), (0, 400), [0.0, p], rtol=1e-9, atol=1e-9)
        reached.append(bool(motion.y[1].min() < 0 and motion.y[1].max() > 1))
    assert reached == [passes] * 3
    assert (4 * math.sqrt(amplitude) > 1) is passes


def test_mathieus_exponent_is_that_of_the_monodromy_matrix():
    """cos πβ = half the trace over τ = 0 … π; β = 1 at q = 0.9080463 (Paul 1990; DLMF 28.6)."""
    for q in (0.1, 0.4, 0.9):

        def mathieu(tau, y, q=q):
            return [y[1], -2 * q * math.cos(2 * tau) * y[0]]

        even, odd = (
            solve_ivp(mathieu, (0, math.pi), start, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
            for start in ([1, 0], [0, 1])
        )
        assert math.cos(math.pi * mathieu_exponent(q)) == pytest.approx((even[0] + odd[1]) / 2, abs=1e-10)
        assert mathieu_exponent(-q) == mathieu_exponent(q)
    assert mathieu_exponent(0.9080463) == pytest.approx(1, abs=2e-3)
    assert mathieu_exponent(0.9) < 0.93


def test_a_trap_beyond_mathieus_limit_is_refused():
    scene = find("paul-trap")
    q = 2 * scene.values["e"] * scene.values["V"] / (scene.values["m"] * (500 * scene.values["W"]) ** 2)
    assert 0.3 < q < 0.4
    scene.with_parameters(V=scene.values["V"] * MATHIEU_LIMIT / q * 0.999)
    with pytest.raises(SceneError, match=r"the ion is held where"):
        scene.with_parameters(V=scene.values["V"] * MATHIEU_LIMIT / q * 1.001)


@pytest.mark.parametrize(("part", "upright"), [(1.15, True), (0.85, False)])
def test_kapitzas_pendulum_stands_where_a_w_squared_is_above_2_g_l(part, upright):
    """θ'' = −(g/l − (a W²/l) cos W t) sin θ, by SciPy, from 0.02 rad beside upside down."""
    g, l, a = 9.81, 0.2, 0.004
    W = part * math.sqrt(2 * g * l) / a

    def swing(t, y):
        return [y[1], -(g / l - a * W**2 / l * math.cos(W * t)) * math.sin(y[0])]

    motion = solve_ivp(swing, (0, 6), [math.pi - 0.02, 0], rtol=1e-9, atol=1e-10, max_step=0.3 / W)
    assert bool(np.abs(motion.y[0] - math.pi).max() < 0.5) is upright
