"""Published motions in balls: spherical pendulum and Lagrange's top by K and Π, Kepler in space, a Stäckel galaxy."""

import math

import mpmath as mp
import pytest
import sympy as sp
from flint import arb

from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.hamilton.bracket import poisson_bracket
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.actions import action_variables
from canon.mechanics.integrable.closed_form.actions_in_closed_form import closed_actions
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.proof.domain.balls import precision, value
from canon.proof.vanish import vanishes
from canon.study import orbit_frequencies

r, theta, k, u, v, Delta, c, M = sp.symbols("r theta k u v Delta c M", positive=True)
phi, psi, p_r, p_theta, p_phi, p_psi, p_u, p_v = sp.symbols(
    "phi psi p_r p_theta p_phi p_psi p_u p_v", real=True
)
half, third = sp.Rational(1, 2), sp.Rational(3, 5)
SPIN, SPHERE = p_phi - p_psi * sp.cos(theta), (p_theta**2 + p_phi**2 / sp.sin(theta) ** 2) / 2
PENDULUM = Hamiltonian(SPHERE + sp.cos(theta), [theta, phi], [p_theta, p_phi])
TOP = Hamiltonian(
    p_theta**2 / 2 + SPIN**2 / (2 * sp.sin(theta) ** 2) + p_psi**2 / 3 + sp.cos(theta),
    [theta, phi, psi],
    [p_theta, p_phi, p_psi],
)


def holds(ball, number):
    return ball.overlaps(arb(mp.nstr(number, 28)) + arb(0, 1e-20)) and ball.rel_accuracy_bits() > 80


def averages(cubic):
    """The period of z = cos θ with ż² = 2(z − z₁)(z₂ − z)(z₃ − z), and the means of 1/(1 − z) and 1/(1 + z).

    (E. T. Whittaker, Analytical Dynamics, sections 55 and 71; z = z₁ + (z₂ − z₁) sn².)
    """
    z1, z2, z3 = sorted(mp.re(z) for z in mp.polyroots(cubic, maxsteps=200, extraprec=200))
    m, K = (z2 - z1) / (z3 - z1), mp.ellipk((z2 - z1) / (z3 - z1))
    above = mp.ellippi((z2 - z1) / (1 - z1), m) / ((1 - z1) * K)
    below = mp.ellippi(-(z2 - z1) / (1 + z1), m) / ((1 + z1) * K)
    return 4 * K / mp.sqrt(2 * (z3 - z1)), above, below


@pytest.mark.slow
def test_the_spherical_pendulum_nutates_by_k_and_turns_by_pi():
    start = {theta: 2, phi: 0, p_theta: sp.Rational(1, 2), p_phi: sp.Rational(3, 5)}
    torus = action_variables(hamilton_jacobi(PENDULUM), start)
    with mp.workdps(40):
        E, L = (mp.mpf(PENDULUM.H.subs(start).n(40)), mp.mpf(3) / 5)
        period, above, below = averages([2, -2 * E, -2, 2 * E - L**2])
        assert holds(torus.frequencies[0], 2 * mp.pi / period)
        assert holds(torus.frequencies[1], L * (above + below) / 2)
        assert not holds(torus.frequencies[1], L * (above - below) / 2)


@pytest.mark.slow
def test_lagranges_top_precesses_and_spins_by_pi():
    start = {theta: 1, phi: 0, psi: 0, p_theta: sp.Rational(1, 4), p_phi: 2, p_psi: 3}
    torus = action_variables(hamilton_jacobi(TOP), start)
    with mp.workdps(40):
        a, b = mp.mpf(2), mp.mpf(3)
        h = mp.mpf((TOP.H - p_psi**2 / 3).subs(start).n(40))
        period, above, below = averages([2, -2 * h - b**2, 2 * a * b - 2, 2 * h - a**2])
        assert holds(torus.frequencies[0], 2 * mp.pi / period)
        assert holds(torus.frequencies[1], ((a - b) * above + (a + b) * below) / 2)
        assert holds(torus.frequencies[2], -b / 3 - ((a - b) * above - (a + b) * below) / 2)
        assert not holds(torus.frequencies[2], 2 * b / 3 - ((a - b) * above - (a + b) * below) / 2)


@pytest.mark.slow
@pytest.mark.parametrize("H", [PENDULUM, TOP], ids=["pendulum", "top"])
def test_the_action_on_the_sphere_is_known_in_integrals_of_all_three_kinds(H):
    """J = (1/π) ∫ √P dz/(1 − z²) by K, E and Π of the roots by Viète's cosines, beside mpmath's quadrature of it."""
    start = dict(
        zip(
            (*H.q, *H.p), (1, 0, 0, sp.Rational(1, 4), 2, 3) if H is TOP else (2, 0, half, third), strict=True
        )
    )
    torus = action_variables(hamilton_jacobi(H), start, digits=20)
    found = closed_actions(torus)[0]
    assert found.name == "motion on a sphere"
    assert all(found.J.has(f) for f in (sp.elliptic_k, sp.elliptic_e, sp.elliptic_pi))
    assert closed_actions(torus, 400)[0] is None
    low, high = (mp.mpf(end.str(20, radius=False)) for end in torus.cycles[0].turning_points)
    constants = {s: number for s, number in torus.values.items() if s != theta}
    square = sp.lambdify(theta, torus.integral.momenta[0].square.subs(constants), "mpmath")

    def along(x):
        place = (low + high) / 2 - (high - low) / 2 * mp.cos(x)
        return mp.sqrt(abs(square(place))) * (high - low) / 2 * mp.sin(x)

    due = mp.quad(along, mp.linspace(0, mp.pi, 5)) / mp.pi
    with precision(120):
        known = float(value(substitute(found.J, torus.values), {}).real.mid())
    assert abs(known / float(due) - 1) < 1e-10


@pytest.mark.slow
def test_kepler_in_space_has_one_frequency():
    H = Hamiltonian(p_r**2 / 2 + SPHERE / r**2 - k / r, [r, theta, phi], [p_r, p_theta, p_phi])
    start = {
        r: 1,
        theta: sp.Rational(5, 4),
        phi: 0,
        p_r: sp.Rational(1, 4),
        p_theta: sp.Rational(1, 2),
        p_phi: sp.Rational(-5, 8),
    }
    torus = action_variables(hamilton_jacobi(H), start, {k: 1})
    with mp.workdps(40):
        E, L = (mp.mpf(f.subs({**start, k: 1}).n(40)) for f in (H.H, sp.sqrt(2 * SPHERE)))
        total = 1 / mp.sqrt(-2 * E)
        for ball, due in zip(torus.J, (total - L, L - mp.mpf(5) / 8, mp.mpf(-5) / 8), strict=True):
            assert holds(ball, due)
        for ball, sense in zip(torus.frequencies, (1, 1, -1), strict=True):
            assert holds(ball, sense / total**3)


HYPERBOLIC, CIRCULAR = sp.sinh(u) ** 2, sp.sin(v) ** 2
ACROSS = HYPERBOLIC + CIRCULAR
OUTER, INNER = sp.sqrt(c**2 + Delta**2 * (1 + HYPERBOLIC)), sp.sqrt(c**2 + Delta**2 * (1 - CIRCULAR))
GALAXY = Hamiltonian(
    (p_u**2 + p_v**2) / (2 * Delta**2 * ACROSS)
    + p_phi**2 / (2 * Delta**2 * HYPERBOLIC * CIRCULAR)
    - M * (OUTER - INNER) / (Delta**2 * ACROSS),
    [u, v, phi],
    [p_u, p_v, p_phi],
)
"""Kuzmin and Kutuzov's −M/(√λ + √ν) in prolate coordinates (H. Dejonghe, T. de Zeeuw, Astrophys. J. 333 (1988) 90)."""


@pytest.mark.slow
def test_a_stackel_galaxy_separates_with_its_third_integral():
    """p²/(2Δ²) of both as in J. Binney and S. Tremaine, Galactic Dynamics, 2nd ed., equations (3.249)."""
    found = hamilton_jacobi(GALAXY)
    assert found.separable.holds
    assert found.is_complete_integral().holds
    E, L = GALAXY.H, p_phi
    I3 = p_v**2 / (2 * Delta**2) - E * CIRCULAR + M * INNER / Delta**2 + L**2 / (2 * Delta**2 * CIRCULAR)
    due = E * HYPERBOLIC - I3 + M * OUTER / Delta**2 - L**2 / (2 * Delta**2 * HYPERBOLIC)
    assert vanishes(p_u**2 / (2 * Delta**2) - due).holds
    assert vanishes(p_u**2 / (2 * Delta**2) - due - I3).fails
    for momentum, p in zip(found.momenta, (p_u, p_v), strict=False):
        assert vanishes(momentum.square.subs(found.defined_as) - p**2).holds
    assert vanishes(poisson_bracket(I3, E, GALAXY.q, GALAXY.p), budget=30.0).holds
    assert vanishes(poisson_bracket(I3, L, GALAXY.q, GALAXY.p)).holds


def galactic_torus(spread):
    """The torus through r = 1, θ = 5/4 with p_r = 1/4, p_θ = 1/2, p_φ = 5/8, as far as Δ is small against r."""
    start = {u: math.asinh(1 / spread), v: 1.25, phi: 0, p_u: 0.25, p_v: 0.5, p_phi: 0.625}
    return action_variables(hamilton_jacobi(GALAXY), start, {Delta: spread, c: 0.5, M: 1}, 17)


@pytest.mark.slow
def test_between_near_foci_it_is_the_isochrone():
    """J_r = M/√(−2E) − (L + √(L² + 4Mb))/2 and J_θ = L − |L_z| with b = c, as Δ → 0 with an error of order Δ²."""
    errors, L = [], math.sqrt(0.5**2 + (0.625 / math.sin(1.25)) ** 2)
    for spread in (1 / 16, 1 / 32):
        torus = galactic_torus(spread)
        E = float(torus.values[torus.integral.energy].n())
        radial = 1 / math.sqrt(-2 * E) - (L + math.sqrt(L**2 + 2)) / 2
        errors.append((abs(float(torus.J[0]) - radial), abs(float(torus.J[1]) - (L - 0.625))))
    for coarse, fine in zip(*errors, strict=True):
        assert coarse < 0.01
        assert 3.5 < coarse / fine < 4.5


@pytest.mark.slow
def test_an_orbit_in_the_galaxy_has_the_frequencies_of_its_torus():
    torus = galactic_torus(0.75)
    assert orbit_frequencies(torus, 50).difference < 1e-12
