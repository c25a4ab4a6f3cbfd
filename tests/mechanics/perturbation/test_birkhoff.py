"""Birkhoff's normal form: closed forms, a second route without brackets, and what is refused."""

import re
from dataclasses import replace

import mpmath
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.mechanics.hamilton.bracket import poisson_bracket
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.perturbation.birkhoff import NormalFormError, birkhoff_normal_form
from canon.mechanics.perturbation.coefficient_field import NoExactFieldError
from canon.mechanics.perturbation.gustavson import formal_integral
from canon.mechanics.perturbation.near_identity import is_normal_form, near_identity_map
from canon.mechanics.perturbation.quadratic_form import NoDiagonalFormError
from canon.mechanics.perturbation.remainder import optimal_order, remainder_norms
from canon.mechanics.perturbation.taylor_parts import NotAnalyticError

q, p = sp.symbols("q p", real=True)
x, y, px, py = sp.symbols("x y p_x p_y", real=True)
KINETIC = (px**2 + py**2) / 2
HENON_HEILES = Hamiltonian(KINETIC + (x**2 + y**2) / 2 + x**2 * y - y**3 / 3, [x, y], [px, py])


def two(potential, kinetic=KINETIC):
    return Hamiltonian(kinetic + potential, [x, y], [px, py])


def first_degree(f, variables):
    return min(sum(powers) for powers, _ in sp.Poly(f, *variables).terms())


def test_the_energy_of_the_pendulum_is_that_of_its_elliptic_action():
    K = birkhoff_normal_form(Hamiltonian(p**2 / 2 - sp.cos(q), q, p), 14).in_actions()
    with mpmath.workdps(40):
        for size in ("0.01", "0.02"):
            E = mpmath.mpf(size) - 1
            m = (1 + E) / 2
            action = 8 / mpmath.pi * (mpmath.ellipe(m) - (1 - m) * mpmath.ellipk(m))
            error = abs(sp.N(K.subs(sp.Symbol("I1", real=True), sp.Float(str(action), 40)), 40) - E)
            assert error < 1e-3 * float(size) ** 8
            assert error > 1e-7 * float(size) ** 8


def test_the_quartic_oscillator_in_its_parameters():
    m, k, b = sp.symbols("m k b", positive=True)
    form = birkhoff_normal_form(Hamiltonian(p**2 / (2 * m) + k * q**2 / 2 + b * q**4 / 4, q, p), 6)
    (I,), w = form.actions, sp.sqrt(k / m)
    due = w * I + 3 * b * I**2 / (8 * m**2 * w**2) - 17 * b**2 * I**3 / (64 * m**4 * w**5)
    assert sp.simplify(form.in_actions() - due) == 0
    assert sp.simplify(form.amplitude_frequencies()[0] - due.diff(I)) == 0


def test_the_fourth_degree_of_henon_and_heiles():
    """K₄ = (7 L² − 5 K₂²)/12 with L = x p_y − y p_x, the form that Braun uses, J. Differ. Equ. 13, 300 (1973)."""
    form = birkhoff_normal_form(HENON_HEILES, 4)
    K2, L = (x**2 + y**2) / 2 + KINETIC, x * py - y * px
    assert sp.expand(form.in_variables() - K2 - (7 * L**2 - 5 * K2**2) / 12) == 0
    z1, z2, w1, w2 = form.complex_variables
    fourth = (
        -sp.Rational(5, 48) * (z1**2 * w1**2 + z2**2 * w2**2)
        - sp.Rational(7, 48) * (z2**2 * w1**2 + z1**2 * w2**2)
        + z1 * z2 * w1 * w2 / 12
    )
    assert sp.expand(form.K - (z1 * w1 + z2 * w2) / 2 - fourth) == 0


def test_gustavsons_integral_to_degree_eight_by_sympys_bracket():
    integral = formal_integral(birkhoff_normal_form(HENON_HEILES, 8))
    assert integral.is_formal_integral().holds
    rate = sp.expand(poisson_bracket(integral.expression, HENON_HEILES.H, [x, y], [px, py]))
    assert first_degree(rate, (x, y, px, py)) == 9
    independent = sp.Matrix([integral.expression, HENON_HEILES.H]).jacobian([x, y, px, py])
    assert independent.subs({x: sp.Rational(1, 3), y: 0, px: 0, py: sp.Rational(1, 5)}).rank() == 2


CASES = {
    "elliptic": (two(x**2 / 2 + y**2 + x**2 * y), 6),
    "irrational with mixed signs": (two(x**2 / 2 - x**2 * y, px**2 / 2 - py**2 / 2 - y**2), 5),
    "hyperbolic": (two(-(x**2) / 2 + 2 * y**2 + x**2 * y + x**3), 5),
    "loxodromic": (two(x**3 + x * py**2 + px * y**2, px * x + py * y + x * py - y * px), 5),
    "with a magnetic term": (two(x**2 + y**2 + x**3, KINETIC + (x * py - y * px) / 3), 5),
    "1:2 resonance": (two(x**2 / 2 + 2 * y**2 + x**2 * y), 6),
    "not a polynomial": (two(sp.exp(x**2 / 2) + 2 * sp.cosh(y) + sp.sin(x) ** 2 * y), 6),
    "free fall of the origin": (two((x**2 + y**2) / 2 + x**4 + x * y**3), 6),
}


@pytest.mark.parametrize("name", CASES)
def test_the_map_carries_h_to_k_without_any_bracket(name):
    H, order = CASES[name]
    form = birkhoff_normal_form(H, order)
    assert is_normal_form(form).holds
    for to_new in (False, True):
        kept = near_identity_map(form, to_new).is_canonical()
        assert kept.holds
        begins = re.fullmatch(r"at degree (\d+)", kept.evidence[0].text)
        assert begins
        assert int(begins[1]) >= order - 1


@pytest.mark.parametrize("name", CASES)
def test_a_changed_coefficient_is_no_normal_form(name):
    H, order = CASES[name]
    form = birkhoff_normal_form(H, order)
    degree = max(form.parts)
    twin = replace(form, parts={**form.parts, degree: form.parts[degree].times(2)})
    assert is_normal_form(twin).fails


def test_the_maps_are_inverse_to_each_other_and_only_approximately_canonical():
    form = birkhoff_normal_form(two(x**2 / 2 + 9 * y**2 / 8 + x**2 * y), 4)
    there, back = near_identity_map(form, to_new=True), near_identity_map(form)
    both = there.transformation.then(back.transformation)
    for image, variable in zip(both.images, (x, y, px, py), strict=True):
        assert first_degree(image - variable, (x, y, px, py)) == form.order
    bracket = sp.expand(
        poisson_bracket(*(there.transformation.images[j] for j in (0, 2)), [x, y], [px, py]) - 1
    )
    assert first_degree(bracket, (x, y, px, py)) >= form.order - 1
    assert there.transformation.is_canonical().fails


coefficient = st.fractions(-3, 3, max_denominator=4).map(lambda f: sp.Rational(f.numerator, f.denominator))


@given(st.lists(coefficient, min_size=9, max_size=9), st.tuples(st.integers(1, 4), st.integers(-4, 4)))
@settings(max_examples=50, deadline=None)
def test_generated_hamiltonians(numbers, frequencies):
    w1, w2 = frequencies
    if w2 == 0:
        return
    monomials = [x**3, x**2 * y, x * px * y, px * py * x, y**3, py**3, x**2 * py**2, x * y * px**2, py**4]
    H2 = w1 * (px**2 + x**2) / 2 + w2 * (py**2 + y**2) / 2
    H = Hamiltonian(H2 + sum(c * f for c, f in zip(numbers, monomials, strict=True)), [x, y], [px, py])
    form = birkhoff_normal_form(H, 5)
    assert is_normal_form(form).holds
    assert formal_integral(form).is_formal_integral().holds
    assert {abs(f) for f in form.frequencies} == {abs(w1), abs(w2)}
    assert sp.expand(form.in_variables() - H2).as_poly(x, y, px, py).total_degree() != 2


def test_l4_of_the_restricted_problem_has_the_frequencies_of_its_characteristic_equation():
    s = sp.sqrt(sp.Rational(14571, 16875))  # makes the frequencies 4/5 and 3/5
    mu = (1 - s) / 2
    a, b = sp.Rational(1, 2) - mu, sp.sqrt(3) / 2
    rotating = KINETIC - (x * py - y * px)
    attraction = (1 - mu) / sp.sqrt((x + mu) ** 2 + y**2) + mu / sp.sqrt((x - 1 + mu) ** 2 + y**2)
    form = birkhoff_normal_form(
        Hamiltonian(rotating - attraction, [x, y], [px, py]), 4, at={x: a, y: b, px: -b, py: a}
    )
    for w in form.frequencies:  # ω⁴ − ω² + 27 μ(1 − μ)/4 = 0
        assert sp.expand(w**4 - w**2 + 27 * mu * (1 - mu) / 4) == 0
    assert set(form.frequencies) == {sp.Rational(4, 5), -sp.Rational(3, 5)}
    assert is_normal_form(form).holds


def test_near_resonances_are_kept_when_they_are_named():
    H = two(x**2 / 2 + sp.Rational(401, 200) ** 2 * y**2 / 2 + x**2 * y)
    assert abs(birkhoff_normal_form(H, 3).small_divisors[0].value - 0.005) < 1e-12
    kept = birkhoff_normal_form(H, 4, resonances=[(2, -1)])
    assert kept.small_divisors[0].value > 0.9
    assert 3 in kept.parts
    assert is_normal_form(kept).holds
    assert is_normal_form(replace(kept, resonances=((1, 0),))).fails
    with pytest.raises(ValueError, match="resonant terms"):
        kept.in_actions()
    assert formal_integral(kept, [1, 2]).is_formal_integral().holds
    with pytest.raises(ValueError, match="do not commute"):
        formal_integral(kept)


def test_a_zero_divisor_keeps_the_order_that_was_reached():
    with pytest.raises(NormalFormError, match=r"at degree 4 .* k = \(") as failed:
        birkhoff_normal_form(HENON_HEILES, 8, resonances=[])
    assert failed.value.reached.order == 3
    assert is_normal_form(failed.value.reached).holds


def test_too_many_terms_keep_the_order_that_was_reached(monkeypatch):
    monkeypatch.setattr("canon.mechanics.perturbation.birkhoff.MOST_TERMS", 40)
    with pytest.raises(NormalFormError, match="56 terms") as failed:
        birkhoff_normal_form(HENON_HEILES, 8)
    assert failed.value.reached.order == 4
    assert failed.value.reached.parts == birkhoff_normal_form(HENON_HEILES, 4).parts


@pytest.mark.parametrize(
    ("H", "error", "said"),
    [
        (two(x + y**2), NormalFormError, "no equilibrium: ∂H/∂x = 1"),
        (two(x**2 / 2), NoDiagonalFormError, "an exponent is zero"),
        (two(x**2 + y**2 + abs(x) ** 3), NotAnalyticError, "no Taylor series"),
        (two(x**2 + y**2 + sp.sqrt(x**2 + y**2) ** 3), NotAnalyticError, "no Taylor series"),
        (two(x**2 + sp.pi * y**2), NoExactFieldError, "pi is no algebraic number"),
        (two(sp.Symbol("c", real=True) * x**2 + y**2), NoDiagonalFormError, "depends on the parameters"),
    ],
)
def test_what_has_no_normal_form_is_refused(H, error, said):
    with pytest.raises(error, match=said):
        birkhoff_normal_form(H, 4)


def test_a_nilpotent_part_is_refused():
    """Two equal frequencies with opposite signs, coupled: the Hamiltonian Hopf bifurcation."""
    H = two((x**2 + y**2) / 2, x * py - y * px)
    with pytest.raises(NoDiagonalFormError, match="not semisimple"):
        birkhoff_normal_form(H, 4)


def test_the_remainder_falls_with_the_order_until_it_grows():
    form = birkhoff_normal_form(two(x**2 / 2 + 9 * y**2 / 8 + x**2 * y), 12)
    near, far = remainder_norms(form, 0.01), remainder_norms(form, 1.0)
    assert near[11] < 1e-15
    assert far[11] > far[2]
    assert optimal_order(form, 1.0).reached
    assert optimal_order(form, 0.01).order == 11
    assert not optimal_order(form, 0.01).reached
    for order in (3, 8):
        assert abs(remainder_norms(form, 0.02)[order] / near[order] / 2 ** (order + 1) - 1) < 1e-12


def test_the_root_of_a_square_may_have_either_sign_but_an_action_may_not():
    """In a rotating frame κ says which pair is which; a spring (w − 1)² has the action of |w − 1|."""
    w = sp.Symbol("w", positive=True)
    turning = two((x**2 + y**2) / 2 - w * (x * py - y * px))
    I, J = birkhoff_normal_form(turning, 2).actions
    found = birkhoff_normal_form(turning, 2).in_actions()
    assert any(sp.expand(found - (1 + w) * a - (1 - w) * b) == 0 for a, b in ((I, J), (J, I)))
    scaled = Hamiltonian((w - 1) * (p**2 + q**2) / 2, q, p)
    assert sp.expand(birkhoff_normal_form(scaled, 2).in_actions() - (w - 1) * I) == 0
    for H in (p**2 / 2 + (w - 1) ** 2 * q**2 / 2, (w - 1) * p**2 / 2 + q**2 / (2 * (w - 1))):
        with pytest.raises(NoDiagonalFormError, match="told from its negative"):
            birkhoff_normal_form(Hamiltonian(H, q, p), 2)
