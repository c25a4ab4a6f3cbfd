"""Legendre's transformation both ways, Hamilton's equations, claims about them."""

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.expression.symbols.symbol import coordinates, parameters, time
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.hamilton.legendre import is_dual
from canon.mechanics.hamilton.legendre_pair import (
    LegendreError,
    hamiltonian,
    has_hamiltonian,
    is_hamiltonian_of,
    lagrangian,
)
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.domain.domain import Domain
from canon.proof.vanish import vanishes

m, a, g, k, b, c, l = parameters("m a g k b c l", positive=True)
x, y, theta, phi = coordinates("x y theta phi")

LAGRANGIANS = {
    "oscillator": (m * x.dot**2 / 2 - k * x**2 / 2, [x]),
    "double pendulum": (
        m * a**2 * (2 * theta.dot**2 + phi.dot**2 + 2 * theta.dot * phi.dot * sp.cos(theta - phi)) / 2
        + m * g * a * (2 * sp.cos(theta) + sp.cos(phi)),
        [theta, phi],
    ),
    "two degrees": (x.dot**2 / (2 * (a + b * y**2)) + y.dot**2 / 2 - k * y**2, [x, y]),
    "magnetic field": (m * (x.dot**2 + y.dot**2) / 2 + k * (x * y.dot - y * x.dot), [x, y]),
    "off-diagonal only": (m * x.dot * y.dot - k * x * y, [x, y]),
    "driven": (m * x.dot**2 / 2 + x.dot * sp.sin(time), [x]),
}


@pytest.mark.parametrize("name", LAGRANGIANS)
def test_legendre_and_back_is_the_identity(name):
    L = Lagrangian(*LAGRANGIANS[name])
    assert vanishes(lagrangian(hamiltonian(L)).L - L.L).holds


@pytest.mark.parametrize("name", LAGRANGIANS)
def test_the_hamiltonian_is_recognized_and_a_twin_is_not(name):
    lagrangian = Lagrangian(*LAGRANGIANS[name])
    H = hamiltonian(lagrangian)
    assert is_hamiltonian_of(lagrangian, H.H, H.p).holds
    assert is_hamiltonian_of(lagrangian, H.H + H.p[0] ** 2 / 1000, H.p).fails


@pytest.mark.parametrize("name", LAGRANGIANS)
def test_hamiltons_equations_are_lagranges(name):
    """With p = ∂L/∂q̇, q̇ = ∂H/∂p is an identity and ṗ + ∂H/∂q is Lagrange's equation."""
    lagrangian = Lagrangian(*LAGRANGIANS[name])
    H = hamiltonian(lagrangian)
    there = dict(zip(H.p, lagrangian.momenta, strict=True))
    for v, rate in zip(lagrangian.velocities, H.q_dot, strict=True):
        assert vanishes(rate.xreplace(there) - v).holds
    for s, rate in zip(lagrangian.q, H.p_dot, strict=True):
        assert vanishes(rate.xreplace(there) - lagrangian.L.diff(s)).holds


coefficients = st.integers(-3, 3)


@settings(max_examples=50, deadline=None)
@given(st.lists(coefficients, min_size=8, max_size=8))
def test_round_trip_of_generated_lagrangians(n):
    """Positive definite mass matrices A Aᵀ + 1 with linear and potential terms."""
    A = sp.Matrix([[n[0], n[1] * x], [n[2] * sp.sin(y), n[3]]])
    M = A * A.T + sp.eye(2)
    v = sp.Matrix([x.dot, y.dot])
    L = (v.T * M * v)[0] / 2 + n[4] * y * x.dot + n[5] * x**2 * y.dot - n[6] * x**2 * y - n[7] * sp.cos(y)
    system = Lagrangian(L, [x, y])
    H = hamiltonian(system)
    assert vanishes(lagrangian(H).L - L).holds
    assert is_hamiltonian_of(system, H.H, H.p).holds


def test_relativistic_hamiltonian_of_two_degrees():
    slow = Domain((x.dot**2 + y.dot**2 < c**2,))
    particle = Lagrangian(-m * c**2 * sp.sqrt(1 - (x.dot**2 + y.dot**2) / c**2) - k * x, [x, y])
    H = hamiltonian(particle, domain=slow)
    expected = c * sp.sqrt(m**2 * c**2 + x.momentum**2 + y.momentum**2) + k * x
    assert vanishes(H.H - expected).holds
    assert is_hamiltonian_of(particle, expected, H.p, slow).holds
    assert is_hamiltonian_of(particle, -expected, H.p, slow).fails
    # without a domain the particle is meant where L is real, below the speed of light
    assert is_hamiltonian_of(particle, expected, H.p).holds
    assert is_hamiltonian_of(particle, -expected, H.p).fails


def test_relativistic_hamiltonian_goes_back():
    H = Hamiltonian(c * sp.sqrt(m**2 * c**2 + x.momentum**2), x, x.momentum)
    assert vanishes(
        lagrangian(H).L + m * c**2 * sp.sqrt(1 - x.dot**2 / c**2), Domain((x.dot**2 < c**2,))
    ).holds


def test_a_singular_hessian_names_its_null_direction():
    with pytest.raises(LegendreError, match=r"singular along \(-1, 1\)") as caught:
        hamiltonian(Lagrangian((x.dot + y.dot) ** 2 / 2, [x, y]))
    assert caught.value.null_direction == (-1, 1)


def test_a_hessian_singular_in_the_velocities_is_found():
    """L homogeneous of first degree: a reparametrization-invariant action."""
    lagrangian = Lagrangian(sp.sqrt(x.dot**2 + y.dot**2), [x, y])
    assert has_hamiltonian(lagrangian).fails
    with pytest.raises(LegendreError, match="singular along"):
        hamiltonian(lagrangian)


def test_existence_is_told_apart():
    assert has_hamiltonian(Lagrangian(m * x.dot**2 / 2, [x])).holds
    assert has_hamiltonian(Lagrangian(m * x.dot, [x])).fails


def test_forces_do_not_fit_into_a_hamiltonian():
    with pytest.raises(LegendreError, match="forces without a potential"):
        hamiltonian(Lagrangian(x.dot**2, [x], forces=[-x.dot]))


def test_claimed_equations():
    H = Hamiltonian(x * x.momentum - y * y.momentum - a * x**2 + b * y**2, (x, y), (x.momentum, y.momentum))
    p1, p2 = H.p
    right = ([x, -y], [2 * a * x - p1, p2 - 2 * b * y])
    assert H.has_equations(*right).holds
    assert H.has_equations(right[0], [2 * a * x + p1, p2 - 2 * b * y]).fails


def test_claimed_motions():
    w = sp.sqrt(g / l)
    H = Hamiltonian(theta.momentum**2 / (2 * m * l**2) - m * g * l * sp.cos(theta), theta, theta.momentum)
    p = 2 * m * l**2 * w / sp.cosh(w * time)
    oscillator = Hamiltonian(x.momentum**2 / (2 * m) + k * x**2 / 2, x, x.momentum)
    w0 = sp.sqrt(k / m)
    motion = {x: a * sp.cos(w0 * time), x.momentum: -m * w0 * a * sp.sin(w0 * time)}
    assert oscillator.is_solution(motion).holds
    assert oscillator.is_solution({**motion, x.momentum: -motion[x.momentum]}).fails
    assert H.is_solution({theta: 2 * sp.atan(sp.tanh(w * time)), theta.momentum: p}).fails
    with pytest.raises(ValueError, match="does not say what p_x is"):
        oscillator.is_solution({x: sp.sin(time)})


def test_conserved_quantities_have_no_rate():
    px, py = x.momentum, y.momentum
    H = Hamiltonian((px**2 + py**2) / (2 * m) + sp.Function("V")(x**2 + y**2), (x, y), (px, py))
    assert vanishes(H.rate(x * py - y * px)).holds
    assert vanishes(H.rate(x * py + y * px)).fails
    assert vanishes(H.rate(H.H)).holds
    assert H.rate(x * time - time**2) == x - 2 * time + px * time / m


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Hamiltonian(x, (x, y), (x.momentum,)), "2 coordinates and 1 momentum"),
        (lambda: Hamiltonian(x, (x,), (x,)), "not all different"),
        (lambda: hamiltonian(Lagrangian(x.dot**2, [x]), p=[x.momentum, y.momentum]), "2 momenta for 1"),
    ],
)
def test_refusals_say_what_is_wrong(make, words):
    with pytest.raises(ValueError, match=words):
        make()


v, p_x = x.dot, x.momentum
TRANSCENDENTAL = {
    "exponential": (sp.exp(v), p_x * sp.log(p_x) - p_x),
    "hyperbolic": (sp.cosh(v), p_x * sp.asinh(p_x) - sp.sqrt(p_x**2 + 1)),
    "relativistic": (
        -m * c**2 * sp.sqrt(1 - v**2 / c**2) - k * x**2 / 2,
        c * sp.sqrt(m**2 * c**2 + p_x**2) + k * x**2 / 2,
    ),
    "of units": (-sp.sqrt(1 - v**2), sp.sqrt(1 + p_x**2)),
    "length": (sp.sqrt(1 + v**2), -sp.sqrt(1 - p_x**2)),
    "quartic": (v**4 / 4, sp.Rational(3, 4) * abs(p_x) ** sp.Rational(4, 3)),
    "sixth power": (
        m * v**6 / 6 - x**2,
        x**2 + 5 * abs(p_x) ** sp.Rational(6, 5) / (6 * m ** sp.Rational(1, 5)),
    ),
}


@pytest.mark.parametrize("name", TRANSCENDENTAL)
def test_velocities_that_are_eliminated_by_inverse_functions_stay_real(name):
    """H is that of the textbook, without √−1 (c √(m²c² + p²), not −c² √(−…)); with another sign it is not that of L."""
    L, right = TRANSCENDENTAL[name]
    found = hamiltonian(Lagrangian(L, [x])).H
    assert sp.expand(found - right) == 0
    assert not found.has(sp.I)
    real = Domain((abs(v) < c,) if L.has(c) else (abs(v) < 1,) if name == "of units" else ())
    assert is_hamiltonian_of(Lagrangian(L, [x]), right, [p_x], real).holds
    assert is_hamiltonian_of(Lagrangian(L, [x]), right + p_x, [p_x], real).fails


a, b = sp.symbols("a b", positive=True)
CONVEX = {
    "quartic and quadratic": v**4 / 4 + v**2 / 2,
    "with parameters": a * v**4 / 4 + m * v**2 / 2 - k * x**2 / 2,
    "with a cubic term": v**4 / 4 + v**3 / 2 + v**2 - x * v,
    "log cosh": m * sp.log(sp.cosh(v / a)),
}
VALUES = {a: sp.Rational(3, 2), m: sp.Rational(4, 3), k: 2, x: sp.Rational(1, 5)}


@pytest.mark.parametrize("name", CONVEX)
def test_velocities_of_convex_lagrangians(name):
    """∂H/∂p gives the velocity back to 30 digits, and H = p v − L there; this H is recognized, a twin is not."""
    L = Lagrangian(CONVEX[name], [x])
    H = hamiltonian(L)
    assert not H.H.has(sp.I)
    for speed in ("-1.3", "0.02", "0.7"):
        there = {**VALUES, v: sp.Rational(speed)}
        at = {**VALUES, p_x: L.momenta[0].subs(there)}
        assert abs(H.H.diff(p_x).evalf(40, subs=at) - there[v]) < sp.Float("1e-30")
        assert abs(H.H.evalf(40, subs=at) - L.jacobi_energy.evalf(40, subs=there)) < sp.Float("1e-30")
    assert is_hamiltonian_of(L, H.H, H.p).holds
    for twin in (-H.H, H.H + p_x, H.H + b, H.H.subs(p_x, 2 * p_x)):
        assert not is_hamiltonian_of(L, twin, H.p).holds
        assert is_hamiltonian_of(L, twin, H.p).fails


@pytest.mark.parametrize("L", [v**4 - v**2, v**4 + v**3, v**3 + v])
def test_no_hamiltonian_where_the_momentum_does_not_grow(L):
    """Several velocities have one momentum, or the momentum turns back: no closed form on all velocities is right."""
    with pytest.raises(LegendreError, match="could not be found in closed form on this domain; narrow it"):
        hamiltonian(Lagrangian(L, [x]))


def test_the_dual_says_nothing_of_what_is_not_convex():
    """p = 4 v³ − 2 v has three roots; a branch of them solves both identities, and is no Hamiltonian."""
    L = v**4 - v**2
    assert not is_dual(p_x * v - L, L, v, p_x)
    u = sp.Symbol("u", real=True)
    assert not is_dual(-(u**2) / 4, -(v**2), v, u)  # concave


def test_relativistic_motion_in_space_is_real():
    L = -m * c**2 * sp.sqrt(1 - (x.dot**2 + y.dot**2) / c**2)
    found = hamiltonian(Lagrangian(L, [x, y])).H
    squared = sp.expand(found**2 - c**2 * (m**2 * c**2 + x.momentum**2 + y.momentum**2))
    assert squared == 0
    assert not found.has(sp.I)
    assert found.subs({x.momentum: 0, y.momentum: 0}) == m * c**2


def test_a_parameter_called_as_a_momentum_is_refused_where_the_hamiltonian_is_made():
    """H would read p_x*x**2/2 + p_x**2/2, of two symbols."""
    x, a = coordinates("x"), sp.Symbol("p_x", positive=True)
    L = Lagrangian(x.dot**2 / 2 - a * x**2 / 2, [x])
    with pytest.raises(ValueError, match="p_x is the name of a momentum and of another symbol in L"):
        hamiltonian(L)
    other = sp.Symbol("k_x", real=True)
    assert other**2 / 2 + a * x**2 / 2 == hamiltonian(L, p=[other]).H


@pytest.mark.parametrize(
    ("L", "H", "domain"),
    [
        (-sp.sqrt(x.dot), lambda p: -1 / (4 * p), lambda p: p < 0),
        (-1 / sp.sqrt(1 + x.dot), lambda p: sp.Rational(3, 2) * sp.cbrt(2 * p) - p, lambda p: p > 0),
        (sp.cbrt(x.dot), lambda p: -2 / sp.sqrt(27 * p), lambda p: p > 0),
    ],
    ids=["square root", "one over a root", "cube root"],
)
def test_a_root_alone_has_a_hamiltonian(L, H, domain):
    """Its second derivative vanishes nowhere, though ∂L/∂q̇ holds no velocity beside the root."""
    p, there = x.momentum, Domain((x.dot > 0,))
    found = hamiltonian(Lagrangian(L, [x]), domain=there)
    assert vanishes(found.H - H(p), Domain((domain(p),))).holds
    assert is_hamiltonian_of(Lagrangian(L, [x]), H(p), [p], there).holds
    assert is_hamiltonian_of(Lagrangian(L, [x]), 2 * H(p), [p], there).fails
    with pytest.raises(LegendreError, match="singular along"):
        hamiltonian(Lagrangian(sp.sqrt(x.dot**2), [x]))


@pytest.mark.parametrize(
    "energy",
    [
        x.dot**2 * sp.sqrt(1 + x.dot**2),
        sp.sqrt(1 + x.dot**2) + x.dot**4,
        sp.sqrt(1 + x.dot**2) + x.dot**2 / 2,
        sp.sqrt(1 - x.dot**2) * sp.exp(x.dot),
    ],
    ids=str,
)
def test_velocities_without_a_closed_form_are_told(energy):
    with pytest.raises(LegendreError, match="could not be found in closed form on this domain"):
        hamiltonian(Lagrangian(energy, [x]))
    assert is_hamiltonian_of(Lagrangian(energy, [x]), x.momentum**2 / 2, [x.momentum]).fails


def test_the_energy_of_a_power_of_a_root():
    """L = (1 + v²)^(3/2): p = 3 v √(1 + v²)."""
    L = Lagrangian((1 + x.dot**2) ** sp.Rational(3, 2), [x])
    H = hamiltonian(L).H
    for v in (sp.Rational(1, 3), 1, -2):
        p = L.momenta[0].subs(x.dot, v)
        assert sp.N(H.subs(x.momentum, p) - (p * v - L.L.subs(x.dot, v)), 30) == pytest.approx(0, abs=1e-25)


def test_a_hamiltonian_of_which_no_value_is_known_is_left_open():
    p = x.momentum
    convex = Lagrangian(sp.cosh(x.dot) + x.dot**2, [x])
    assert is_hamiltonian_of(convex, p**2 * sp.besselj(0, p), [p]).undecided
    assert is_hamiltonian_of(convex, p**2, [p]).fails


@pytest.mark.parametrize(
    ("L", "H"),
    [
        (1 / x.dot**2, lambda p: -sp.Rational(3, 2) * sp.cbrt(2) * sp.Abs(p) ** sp.Rational(2, 3)),
        (-3 / x.dot**4, lambda p: 15 * (sp.Abs(p) / 12) ** sp.Rational(4, 5)),
        (x.dot**4 / 4, lambda p: sp.Rational(3, 4) * sp.Abs(p) ** sp.Rational(4, 3)),
    ],
    ids=["1/v²", "−3/v⁴", "v⁴/4"],
)
def test_an_even_power_of_either_sign_has_a_hamiltonian(L, H):
    p = x.momentum
    found = hamiltonian(Lagrangian(L, [x])).H
    for sign in (p > 0, p < 0):
        assert vanishes(found - H(p), Domain((sign,))).holds
        assert vanishes(found + H(p), Domain((sign,))).fails
    assert is_hamiltonian_of(Lagrangian(L, [x]), found, [p]).holds
