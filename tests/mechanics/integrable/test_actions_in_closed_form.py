"""Closed actions: published formulas come out, each is compared with quadrature, and a changed one is not returned."""

import mpmath as mp
import pytest
import sympy as sp

from canon.exercise.claim_verdict import examine
from canon.exercise.sheet.sheet import Claim
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.actions import action_variables
from canon.mechanics.integrable.closed_form import actions_in_closed_form as module
from canon.mechanics.integrable.closed_form.actions_in_closed_form import (
    closed_actions,
    in_reciprocals,
    three_roots,
)
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.mechanics.integrable.turning_points import NoCycleError
from canon.proof.domain.domain import Domain
from canon.proof.vanish import vanishes

q, p = sp.symbols("q p", real=True)
r, theta, m, k, w, D, a, b = sp.symbols("r theta m k omega D a b", positive=True)
phi, p_r, p_theta, p_phi = sp.symbols("phi p_r p_theta p_phi", real=True)
E, L = sp.symbols("E alpha_phi", real=True)
half, third = sp.Rational(1, 2), sp.Rational(1, 3)
PLANE = ([r, phi], [p_r, p_phi])
CENTRAL = p_r**2 / (2 * m) + p_phi**2 / (2 * m * r**2)
ORBIT = {r: 1, phi: 0, p_r: third, p_phi: half}
LINE = {q: 0, p: 1}
BOUND = Domain((E < 0, L > 0))

CASES = {
    "oscillator": (Hamiltonian(p**2 / (2 * m) + m * w**2 * q**2 / 2, q, p), LINE, E / w, Domain((E > 0,))),
    "Kepler": (Hamiltonian(CENTRAL - k / r, *PLANE), ORBIT, k * sp.sqrt(m / (-2 * E)) - L, BOUND),
    "radial oscillator": (
        Hamiltonian(CENTRAL + m * w**2 * r**2 / 2, *PLANE),
        ORBIT,
        E / (2 * w) - L / 2,
        Domain((E > 0, L > 0)),
    ),
    "Morse": (
        Hamiltonian(p**2 / (2 * m) + D * (1 - sp.exp(-a * q)) ** 2, q, p),
        LINE,
        (sp.sqrt(2 * m * D) - sp.sqrt(2 * m * (D - E))) / a,
        Domain((E > 0, E < D)),
    ),
    "Pöschl–Teller": (
        Hamiltonian(p**2 / (2 * m) - D / sp.cosh(a * q) ** 2, q, p),
        LINE,
        (sp.sqrt(2 * m * D) - sp.sqrt(-2 * m * E)) / a,
        Domain((E < 0,)),
    ),
    "isochrone": (
        Hamiltonian(CENTRAL - k / (b + sp.sqrt(b**2 + r**2)), *PLANE),
        ORBIT,
        k * sp.sqrt(m / (-2 * E)) - (L + sp.sqrt(L**2 + 4 * k * m * b)) / 2,
        BOUND,
    ),
}
VALUES = {m: sp.Rational(3, 2), k: 2, w: 2, D: 3, a: half, b: third}


@pytest.mark.parametrize("name", CASES)
def test_published_formulas_come_out(name):
    H, start, formula, domain = CASES[name]
    values = {s: v for s, v in VALUES.items() if H.H.has(s)}
    found = closed_actions(action_variables(hamilton_jacobi(H), start, values, digits=20))
    assert found[0] is not None
    assert (found[0].name, found[0].tori) == (name, 3)
    assert vanishes(found[0].J - formula, domain).holds
    assert vanishes(found[0].J - 2 * formula, domain).fails
    if len(found) == 2:
        assert found[1].J == L


@pytest.mark.parametrize(
    ("square", "known"),
    [
        (a - b * r**2, (a / (2 * sp.sqrt(b)), "oscillator")),
        (a + b / r - k**2 / r**2, (b / (2 * sp.sqrt(-a)) - k, "Kepler")),
        (a - b * r**2 - k**2 / r**2, (a / (4 * sp.sqrt(b)) - k / 2, "radial oscillator")),
        (a - b * r**2 + k / r, None),
    ],
)
def test_powers_are_recognised_by_their_exponents(square, known):
    terms = module.terms_in(square, r)
    assert module._powers(terms.pop(sp.S.One), terms, r) == known


@pytest.mark.parametrize("n", [4, 6, 10])
def test_even_powers_have_gamma_functions(n):
    """J = E^(1/2 + 1/n) √(2 m) k^(−1/n) Γ(1/n)/(n √π Γ(3/2 + 1/n)), so E grows as J^(2n/(n + 2))."""
    H = Hamiltonian(p**2 / (2 * m) + k * q**n, q, p)
    torus = action_variables(hamilton_jacobi(H), LINE, {m: sp.Rational(3, 2), k: 2}, digits=20)
    (found,) = closed_actions(torus)
    gammas = sp.gamma(sp.Rational(1, n)) / sp.gamma(sp.Rational(3, 2) + sp.Rational(1, n))
    formula = E ** (half + sp.Rational(1, n)) * sp.sqrt(2 * m) * k ** sp.Rational(-1, n) * gammas
    assert (found.name, found.tori) == ("even power", 3)
    assert vanishes(found.J - formula / (n * sp.sqrt(sp.pi)), Domain((E > 0,))).holds
    assert vanishes(found.J - 2 * formula / (n * sp.sqrt(sp.pi)), Domain((E > 0,))).fails


@pytest.mark.parametrize("potential", [q**4 + q**6])
def test_sums_of_even_powers_have_no_such_formula(potential):
    H = Hamiltonian(p**2 / 2 + potential, q, p)
    assert closed_actions(action_variables(hamilton_jacobi(H), LINE, digits=20)) == (None,)


@pytest.mark.parametrize(("momentum", "name"), [(1, "pendulum, libration"), (-3, "pendulum, rotation")])
def test_the_pendulum_has_complete_elliptic_integrals(momentum, name):
    H = Hamiltonian(p**2 / (2 * m) - k * sp.cos(q), q, p)
    (found,) = closed_actions(action_variables(hamilton_jacobi(H), {q: 0, p: momentum}, {m: 1, k: 1}, 20))
    assert found.name == name
    assert found.J.has(sp.elliptic_e)


@pytest.mark.parametrize(
    ("H", "formula"),
    [
        (p * (w + a * sp.cos(q)), E / sp.sqrt(w**2 - a**2)),
        pytest.param(w * p + a * sp.sin(q), E / w, marks=pytest.mark.slow),
        pytest.param(p * (a * sp.sin(q) - w), -E / sp.sqrt(w**2 - a**2), marks=pytest.mark.slow),
    ],
)
def test_a_hamiltonian_linear_in_the_momentum_turns(H, formula):
    """ωJ + εJ cos θ, the example of many pages on averaging: it turns with √(ω² − ε²)."""
    integral = hamilton_jacobi(Hamiltonian(H, q, p))
    (found,) = closed_actions(action_variables(integral, {q: 1, p: half}, {w: 2, a: half}, digits=20))
    inside = Domain((w > a,))
    assert (found.name, found.tori) == ("rotation linear in p", 3)
    assert vanishes(found.J - formula, inside).holds
    assert vanishes(found.J - formula.subs(w, 2 * w), inside).fails


def test_a_relativistic_energy_is_solved_for_the_momentum_where_its_root_is_positive():
    """√(m² + p²) + V = E has p² = (E − V)² − m² where E > V; where E < V that is a solution of another equation."""
    integral = hamilton_jacobi(Hamiltonian(sp.sqrt(m**2 + p**2) - D * q, q, p))
    (momentum,), e = integral.momenta, integral.energy
    assert vanishes(momentum.square - (e + D * q) ** 2 + m**2).holds
    assert vanishes(momentum.square - (e - D * q) ** 2 + m**2).fails
    assert momentum.where == (e + D * q > 0)
    assert integral.is_complete_integral().holds


@pytest.mark.slow
def test_sommerfelds_ellipse_turns():
    """J_r = kE/(c√(c⁴ − E²)) − √(L² − k²/c²), m = 1 (A. Sommerfeld, Ann. Physik 51 (1916) 1, c = 1 here)."""
    H = Hamiltonian(sp.sqrt(1 + p_r**2 + p_phi**2 / r**2) - k / r, *PLANE)
    start = {r: 1, phi: 0, p_r: third, p_phi: 1}
    radial, turning = closed_actions(action_variables(hamilton_jacobi(H), start, {k: half}, digits=20))
    inside = Domain((E > 0, E < 1, k < L))
    assert radial.name == "Kepler"
    assert turning.J == L
    formula = k * E / sp.sqrt(1 - E**2) - sp.sqrt(L**2 - k**2)
    assert vanishes(radial.J - formula, inside).holds
    assert vanishes(radial.J - formula.subs(L**2 - k**2, L**2), inside).fails


@pytest.mark.slow
@pytest.mark.parametrize(("along", "axis"), [(2, 1), (2, -1)])
def test_a_top_without_weight_has_its_angular_momentum_less_the_larger_component(along, axis):
    """J_θ = |L| − max(|p_φ|, |p_ψ|), L² = 2AE + (1 − A/C)p_ψ² (Landau & Lifshitz, § 35), here A = 1, C = 2."""
    psi, p_psi = sp.symbols("psi p_psi", real=True)
    T = (p_theta**2 + (p_phi - p_psi * sp.cos(theta)) ** 2 / sp.sin(theta) ** 2 + p_psi**2 / 2) / 2
    H = Hamiltonian(T, [theta, phi, psi], [p_theta, p_phi, p_psi])
    start = {theta: 1, phi: 0, psi: 0, p_theta: half, p_phi: along, p_psi: axis}
    torus = action_variables(hamilton_jacobi(H), start, digits=20)
    found = closed_actions(torus)[0]
    assert found.name == "free symmetric top"
    L_squared = sp.Rational(1, 4) + (along - axis * sp.cos(1)) ** 2 / sp.sin(1) ** 2 + axis**2
    value = found.J.subs(torus.values).n(25)
    assert abs(value - (sp.sqrt(L_squared) - max(abs(along), abs(axis))).n(25)) < 1e-18
    assert abs(value - (sp.sqrt(L_squared) - min(abs(along), abs(axis))).n(25)) > 0.1


def test_a_rate_that_vanishes_is_no_rotation():
    integral = hamilton_jacobi(Hamiltonian(p * (1 + 2 * sp.cos(q)), q, p))
    with pytest.raises(NoCycleError, match="rotation of q"):
        action_variables(integral, {q: 1, p: 1})


def test_the_polar_angle_has_the_whole_less_the_component():
    H = Hamiltonian((p_theta**2 + p_phi**2 / sp.sin(theta) ** 2) / 2, [theta, phi], [p_theta, p_phi])
    start = {theta: 1, phi: 0, p_theta: half, p_phi: third}
    found = closed_actions(action_variables(hamilton_jacobi(H), start, digits=20))
    assert vanishes(found[0].J - sp.sqrt(2 * E) + L, Domain((E > 0, L > 0))).holds


@pytest.mark.parametrize(
    "f", [sp.tan(a * q) ** 2, sp.cot(q) ** 2, sp.tanh(q) ** 2, sp.sec(q) ** 2, sp.sech(q)]
)
def test_tangents_and_secants_are_told_by_sines_and_cosines(f):
    reciprocals = module.in_reciprocals(3 * f)
    assert not reciprocals.has(sp.tan, sp.cot, sp.tanh, sp.sec, sp.sech)
    assert vanishes(reciprocals - 3 * f).holds
    assert vanishes(reciprocals - 4 * f).fails


@pytest.mark.slow
@pytest.mark.parametrize(
    ("potential", "formula"),
    [
        (D * sp.tan(a * q) ** 2, (sp.sqrt(2 * m * (E + D)) - sp.sqrt(2 * m * D)) / a),
        (D * sp.sec(a * q) ** 2, sp.sqrt(2 * m) * (sp.sqrt(E) - sp.sqrt(D)) / a),
        (D * sp.tanh(a * q) ** 2, sp.sqrt(2 * m) * (sp.sqrt(D) - sp.sqrt(D - E)) / a),
    ],
)
def test_squares_of_tangents_are_those_of_reciprocals(potential, formula):
    """Landau & Lifshitz, § 11, problem 2: periods in −U₀/cosh² αx and U₀ tan² αx."""
    H = Hamiltonian(p**2 / (2 * m) + potential, q, p)
    start = {q: half, p: 3 if potential.has(sp.sec) else 1}
    (found,) = closed_actions(action_variables(hamilton_jacobi(H), start, {m: 1, D: 3, a: half}, 20))
    inside = Domain((E > D,) if potential.has(sp.sec) else (E > 0, E < D))
    assert vanishes(found.J - formula, inside).holds
    assert vanishes(found.J - 2 * formula, inside).fails


@pytest.mark.parametrize(
    ("name", "factor"), [("oscillator", 1 + sp.Rational(1, 10**15)), ("oscillator", sp.I), ("Kepler", -1)]
)
def test_a_wrong_formula_is_not_returned(monkeypatch, name, factor):
    H, start, _, _ = CASES[name]
    right = module._powers

    def wrong(*given):
        found = right(*given)
        return None if found is None else (factor * found[0], found[1])

    monkeypatch.setattr(module, "_powers", wrong)
    values = {s: v for s, v in VALUES.items() if H.H.has(s)}
    assert closed_actions(action_variables(hamilton_jacobi(H), start, values, digits=20))[0] is None


WELLS = {
    "quartic well": (q**2 / 2 + k * q**4 / 4, 0, 1),
    "over both wells": (-(q**2) / 2 + k * q**4 / 4, 1, 2),
    "double well, on one side": (-(q**2) / 2 + k * q**4 / 4, -1, sp.Rational(1, 4)),
    "soft quartic well": (q**2 / 2 - k * q**4 / 4, 0, half),
}


@pytest.mark.parametrize(
    "name", [n if n == "quartic well" else pytest.param(n, marks=pytest.mark.slow) for n in WELLS]
)
def test_quartic_wells_have_complete_elliptic_integrals(name):
    """The area of the oval, and the period of Duffing's oscillator: both by mpmath's quadrature of another integral."""
    V, place, momentum = WELLS[name]
    torus = action_variables(
        hamilton_jacobi(Hamiltonian(p**2 / 2 + V, q, p)), {q: place, p: momentum}, {k: 1}, 20
    )
    (found,) = closed_actions(torus)
    assert found.name == {"over both wells": "quartic well"}.get(name, name)
    energy = sp.Rational(momentum) ** 2 / 2 + V.subs({q: place, k: 1})
    with mp.workdps(30):
        low, high = (mp.mpf(end.str(30, radius=False)) for end in torus.cycles[0].turning_points)
        square = sp.lambdify(q, 2 * (energy - V.subs(k, 1)), "mpmath")

        def along(x):
            return (
                mp.sqrt(abs(square((low + high) / 2 - (high - low) / 2 * mp.cos(x))))
                * (high - low)
                / 2
                * mp.sin(x)
            )

        area = mp.quad(along, mp.linspace(0, mp.pi, 5)) / mp.pi
        assert abs(mp.mpf(found.J.subs({E: energy, k: 1}).n(25)) / area - 1) < 1e-12


@pytest.mark.slow
def test_the_action_of_duffings_oscillator_is_judged():
    keys = {
        "q": ["q"],
        "p": ["p"],
        "H": "p**2/2 + q**2/2 + b*q**4/4",
        "parameters": {"b": "positive", "E": "positive"},
    }
    R = "sqrt(1 + 4*b*E)"
    right = (
        f"2*sqrt({R})/(3*pi*b)*(({R} + 1)*elliptic_k(({R} - 1)/(2*{R})) - 2*elliptic_e(({R} - 1)/(2*{R})))"
    )
    assert examine(Claim("a", "action-angle", {**keys, "J": [right]})).verdict.holds
    assert examine(Claim("a", "action-angle", {**keys, "J": [right.replace("+ 1", "- 1")]})).verdict.fails


def test_what_has_no_known_integral_is_left_open():
    sextic = hamilton_jacobi(Hamiltonian(p**2 / 2 + q**2 + q**6, q, p))
    assert closed_actions(action_variables(sextic, {q: 0, p: 1}, digits=20)) == (None,)
    shifted = hamilton_jacobi(Hamiltonian(p**2 / 2 + sp.exp(-3 * q) - 2 * sp.exp(-q), q, p))
    assert closed_actions(action_variables(shifted, {q: 0, p: half}, digits=20))[0] is None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("start", "masses"),
    [
        (
            (1, sp.Rational(1, 2), sp.Rational(1, 5), sp.Rational(1, 3)),
            (1, sp.Rational(1, 10), sp.Rational(1, 2)),
        ),
        ((sp.Rational(1, 10), sp.Rational(1, 5), sp.Rational(1, 10), sp.Rational(1, 5)), (3, 1, 1)),
    ],
    ids=["about both centres", "about one of them"],
)
def test_two_centres_have_all_three_complete_integrals(start, masses):
    x, y, px, py = sp.symbols("x y p_x p_y", real=True)
    one, two, c = sp.symbols("k1 k2 c", positive=True)
    near, far = sp.sqrt((x - c) ** 2 + y**2), sp.sqrt((x + c) ** 2 + y**2)
    centres = Hamiltonian((px**2 + py**2) / 2 - one / near - two / far, [x, y], [px, py])
    found = hamilton_jacobi(centres, "elliptic", focal=c)
    torus = action_variables(found, start, dict(zip((one, two, c), masses, strict=True)))
    for action in closed_actions(torus):
        assert action.name == "elliptic coordinates"
        assert action.J.has(sp.elliptic_k)
        assert action.J.has(sp.elliptic_e)
        assert action.J.has(sp.elliptic_pi)
        assert action.tori == 3


@pytest.mark.parametrize(("energy", "kind"), [(-0.3, "libration"), (0.9, "rotation")])
def test_a_pendulum_with_a_second_harmonic_has_them_too(energy, kind):
    V = -sp.cos(q) - sp.cos(q) ** 2 / 4
    speed = sp.sqrt(2 * (sp.Rational(energy).limit_denominator(10) - V.subs(q, 0)))
    torus = action_variables(hamilton_jacobi(Hamiltonian(p**2 / 2 + V, q, p)), {q: 0, p: speed})
    assert torus.cycles[0].kind.value == kind
    (action,) = closed_actions(torus)
    assert (action.name, action.tori) == ("elliptic coordinates", 3)


def test_three_real_roots_in_their_order():
    z = sp.Symbol("z")
    found = three_roots(sp.Poly(3 * (z - 1) * (z + 2) * (z - 5), z))
    assert [round(float(root), 12) for root in found] == [-2.0, 1.0, 5.0]


@pytest.mark.parametrize(
    "f", [sp.tan(q) ** 2, sp.cot(q) ** 2, sp.tanh(2 * q) ** 2, sp.sec(q), sp.csc(q), sp.sech(q)]
)
def test_functions_in_reciprocals_are_what_they_were(f):
    found = in_reciprocals(f)
    assert not found.has(*({type(g) for g in f.atoms(sp.Function)}))
    assert abs(sp.N((found - f).subs(q, sp.Rational(7, 10)))) < 1e-12
