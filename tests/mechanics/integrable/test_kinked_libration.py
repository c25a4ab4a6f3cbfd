"""Cycles over kinks of moduli: beta functions of |q|ⁿ, elementary wells in pieces; central powers by quadrature."""

import mpmath as mp
import pytest
import sympy as sp
from flint import arb

from canon.exercise.claim_verdict import examine
from canon.exercise.sheet.sheet import Claim
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.actions import action_variables, angles
from canon.mechanics.integrable.closed_form.actions_in_closed_form import closed_actions
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.mechanics.integrable.turning_points import NoCycleError
from canon.proof.domain.balls import precision, value
from canon.proof.domain.domain import Domain
from canon.proof.vanish import vanishes

q, p = sp.symbols("q p", real=True)
k, a, r = sp.symbols("k a r", positive=True)
phi, p_r, p_phi, E = sp.symbols("phi p_r p_phi E", real=True)
slow = pytest.mark.slow


def torus_of(V, momentum=3, values=None):
    integral = hamilton_jacobi(Hamiltonian(p**2 / 2 + V, q, p))
    return action_variables(integral, {q: 0, p: momentum}, values or {}, digits=20)


def holds(ball, formula):
    with precision(150):
        return bool(ball.overlaps(value(sp.sympify(formula), {}).real)) and ball.rel_accuracy_bits() > 60


def by_beta(n, energy, wall=1):
    """J = √(2E) (E/k)^(1/n) 2/(π n) B(1/n, 3/2), from q = (E/k)^(1/n) x^(1/n)."""
    n = sp.sympify(n)
    beta = sp.gamma(1 / n) * sp.gamma(sp.Rational(3, 2)) / sp.gamma(1 / n + sp.Rational(3, 2))
    return sp.sqrt(2 * energy) * (energy / wall) ** (1 / n) * 2 / (sp.pi * n) * beta


@pytest.mark.parametrize(
    "n", [3, *(pytest.param(sp.Rational(*n), marks=slow) for n in ((1, 1), (3, 2), (2, 3), (5, 1), (7, 3)))]
)
def test_powers_of_the_modulus_have_the_action_of_their_beta_functions(n):
    torus = torus_of(sp.Abs(q) ** n)
    energy = sp.Rational(9, 2)
    assert holds(torus.J[0], by_beta(n, energy))
    assert not holds(torus.J[0], by_beta(n, energy) * (1 + sp.Rational(1, 10**12)))
    assert holds(torus.frequencies[0], 1 / by_beta(n, E).diff(E).subs(E, energy))
    (found,) = closed_actions(torus)
    assert vanishes(found.J - by_beta(n, E), Domain((E > 0,))).holds
    assert vanishes(found.J - 2 * by_beta(n, E), Domain((E > 0,))).fails


@slow
def test_a_wall_about_another_place():
    torus = torus_of(k * sp.Abs(q - a) ** 3, values={k: sp.Rational(3, 2), a: sp.Rational(1, 3)})
    (found,) = closed_actions(torus)
    assert vanishes(found.J - by_beta(3, E, k), Domain((E > 0,))).holds


@pytest.mark.parametrize("momentum", [3, pytest.param(5, marks=slow)])
def test_a_trough_with_two_kinks(momentum):
    """Level between q = ±1, where p is constant, and falling beyond."""
    torus = torus_of(sp.Abs(q - 1) + sp.Abs(q + 1), momentum)
    rest = sp.Rational(momentum**2, 2)
    assert holds(
        torus.J[0],
        (2 * sp.sqrt(2 * rest) + sp.Rational(2, 3) * sp.sqrt(2) * rest ** sp.Rational(3, 2)) / sp.pi,
    )
    period = 4 / sp.sqrt(2 * rest) + 2 * sp.sqrt(2 * rest)
    assert holds(torus.frequencies[0], 2 * sp.pi / period)
    assert holds(
        angles(torus, {q: 1, p: 1})[0], 2 * sp.pi / period * (sp.sqrt(2 * rest) / 2 + 2 / sp.sqrt(2 * rest))
    )


@slow
def test_a_spring_with_dry_kink():
    """V = q²/2 + |q|: both halves are arcs of circles about q = ∓1."""
    torus = torus_of(q**2 / 2 + sp.Abs(q), 3)
    R = sp.sqrt(10)
    half = R**2 / 2 * (sp.pi / 2 - sp.asin(1 / R)) - sp.sqrt(R**2 - 1) / 2
    assert holds(torus.J[0], 2 * half / sp.pi)
    assert holds(torus.frequencies[0], sp.pi / (2 * sp.acos(1 / R)))


def test_angles_over_the_kink_are_times_of_free_fall():
    torus = torus_of(sp.Abs(q), 2)
    omega = sp.pi / 4
    for place, momentum, time in ((-1, 1, sp.sqrt(2)), (1, 1, 4 - sp.sqrt(2)), (1, -1, 4 + sp.sqrt(2))):
        assert holds(angles(torus, {q: place, p: momentum})[0], omega * time)


@slow
def test_a_claim_about_a_wedge():
    keys = {
        "q": ["q"],
        "p": ["p"],
        "H": "p**2/2 + g*Abs(q)",
        "parameters": {"g": "positive", "E": "positive"},
    }
    right = "4*sqrt(2)*E**(3/2)/(3*pi*g)"
    assert examine(Claim("a", "action-angle", {**keys, "J": [right]})).verdict.holds
    assert examine(Claim("a", "action-angle", {**keys, "J": [right.replace("4*", "2*")]})).verdict.fails


@slow
@pytest.mark.parametrize(
    ("n", "pull"), [(1, 1), (3, 1), (sp.Rational(3, 2), 1), (4, 1), (sp.Rational(-1, 2), -2)]
)
def test_central_powers_agree_with_another_quadrature(n, pull):
    """q = (r₁ + r₂)/2 − (r₂ − r₁)/2 cos x takes the roots from both ends, in mpmath's Gauss–Legendre."""
    H = Hamiltonian(p_r**2 / 2 + p_phi**2 / (2 * r**2) + pull * r**n, [r, phi], [p_r, p_phi])
    torus = action_variables(hamilton_jacobi(H), {r: 1, phi: 0, p_r: sp.Rational(1, 2), p_phi: 1}, digits=20)
    energy = sp.Rational(1, 8) + sp.Rational(1, 2) + pull
    with mp.workdps(30):
        low, high = (mp.mpf(end.str(30, radius=False)) for end in torus.cycles[0].turning_points)
        power, level = mp.mpf(sp.N(n, 30)), mp.mpf(sp.N(energy, 30))

        def momentum(x):
            place = (low + high) / 2 - (high - low) / 2 * mp.cos(x)
            square = 2 * (level - int(pull) * place**power) - 1 / place**2
            return mp.sqrt(abs(square)) * (high - low) / 2 * mp.sin(x)

        due = mp.quad(momentum, mp.linspace(0, mp.pi, 5)) / mp.pi
        assert torus.J[0].overlaps(arb(mp.nstr(due, 25)) + arb(0, 1e-16))
        assert torus.J[0].rel_accuracy_bits() > 60


def test_a_modulus_of_a_parameter_has_no_kink():
    """V = |a| |q| is the wedge of the slope |a|."""
    slope = sp.Symbol("a", real=True)
    for number in (-2, 2):
        torus = torus_of(sp.Abs(slope) * sp.Abs(q), values={slope: number})
        assert holds(torus.J[0], by_beta(1, sp.Rational(9, 2), 2))
        assert not holds(torus.J[0], by_beta(1, sp.Rational(9, 2), 1))


@pytest.mark.parametrize(
    ("V", "stiffness", "energy"),
    [
        (q**2 / 2 + sp.Abs(q - 10), 1, 5),
        (2 * q**2 + sp.Abs(q**2 - 100), 2, sp.Rational(9, 2)),
        (q**2 / 2 + sp.Abs(q**2 - 100) / 4, sp.Rational(1, 2), sp.Rational(9, 2)),
    ],
)
def test_a_kink_beyond_the_turning_points_is_not_met(V, stiffness, energy):
    """Within, the wells are (q − 1)²/2 + 19/2 and parabolas: J is the energy above the bottom over ω."""
    torus = torus_of(V)
    omega = sp.sqrt(stiffness)
    assert holds(torus.frequencies[0], omega)
    assert holds(torus.J[0], energy / omega)
    assert not holds(torus.J[0], 2 * energy / omega)


def test_two_kinks_that_are_not_told_apart_are_refused():
    """√(3 + 2√2) = 1 + √2: one kink, written in two ways; as one it is a wedge of twice the slope."""
    written = sp.sqrt(3 + 2 * sp.sqrt(2))
    with pytest.raises(NoCycleError, match="two kinks of the potential of q are too near to each other"):
        torus_of(sp.Abs(q - written) + sp.Abs(q - 1 - sp.sqrt(2)), 5)
    integral = hamilton_jacobi(Hamiltonian(p**2 / 2 + 2 * sp.Abs(q - 1 - sp.sqrt(2)), q, p))
    torus = action_variables(integral, {q: 1 + sp.sqrt(2), p: 3}, {}, digits=20)
    assert holds(torus.J[0], by_beta(1, sp.Rational(9, 2), 2))
