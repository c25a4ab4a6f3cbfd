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
from canon.mechanics.perturbation.quadratic_form import NoDiagonalFormError, characteristic_exponents
from canon.mechanics.perturbation.remainder import optimal_order, remainder_norms
from canon.mechanics.perturbation.taylor_parts import NotAnalyticError

q, p = sp.symbols("q p", real=True)
x, y, px, py, w = sp.symbols("x y p_x p_y w", real=True)
KINETIC = (px**2 + py**2) / 2
WELL = q**2 / 2
HENON_HEILES = Hamiltonian(KINETIC + (x**2 + y**2) / 2 + x**2 * y - y**3 / 3, [x, y], [px, py])


def two(potential, kinetic=KINETIC):
    return Hamiltonian(kinetic + potential, [x, y], [px, py])


def one(potential):
    return Hamiltonian(p**2 / 2 + potential, q, p)


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


@pytest.mark.parametrize(
    ("H", "order", "error", "said"),
    [
        (one(WELL), 1, ValueError, "the order should be a whole number from 2, not 1"),
        (one(WELL * (1 + one(0).t)), 4, ValueError, "H depends on the time; take"),
        (one(WELL + 1 / q), 4, NormalFormError, "∂H/∂q has no value at the point; take an equilibrium where"),
        (one(WELL + q ** sp.Rational(7, 2)), 4, NotAnalyticError, r"q\*\*\(7/2\) has no Taylor series where q = 0"),
        (one(WELL + abs(w) * q**3), 4, NoExactFieldError, r"Abs\(w\) is no algebraic number.*write a parameter for it"),
        (two(x**2 + y**2 + x**2 * sp.atan2(y, 1 + x)), 4, NotAnalyticError, r"atan2\(y, x \+ 1\).*or atan\(y/x\)"),
        (two(x**2 + y**2 + x**2 * (1 + x) ** y), 4, NotAnalyticError, r"\(x \+ 1\)\*\*y.*as exp\(y\*log\(x\)\)"),
    ],
)  # fmt: skip
def test_what_is_no_order_and_no_analytic_hamiltonian_is_refused_with_what_to_give(H, order, error, said):
    with pytest.raises(error, match=said):
        birkhoff_normal_form(H, order)


def test_what_the_refusals_advise_has_a_normal_form():
    """x² atan(y/(1 + x)) = x² y + … and x² exp(y log(1 + x)) = x² + x³ y + … ."""
    for advised, series in (
        (x**2 * sp.atan(y / (1 + x)), x**2 * y - x**3 * y),
        (x**2 * sp.exp(y * sp.log(1 + x)), x**2 + x**3 * y),
    ):
        given, written_out, twin = (
            birkhoff_normal_form(two(x**2 / 2 + 2 * y**2 + f), 4).K for f in (advised, series, 2 * series)
        )
        assert given == written_out
        assert given != twin


def test_a_root_beside_a_parameter_stays_in_the_coefficients():
    """ω I − 15 α² I²/(4 ω⁴) of p²/2 + ω² q²/2 + α q³, with ω² = 2 and α = √2 w."""
    form = birkhoff_normal_form(one(q**2 + sp.sqrt(2) * w * q**3), 4)
    (I,) = form.actions
    assert sp.expand(form.in_actions() - sp.sqrt(2) * I + sp.Rational(15, 8) * w**2 * I**2) == 0
    assert sp.expand(form.in_actions() - sp.sqrt(2) * I + sp.Rational(15, 4) * w**2 * I**2) != 0


@pytest.mark.parametrize("sign", [1, -1])
def test_the_sign_of_an_action_is_proved_where_sympy_does_not_know_it(sign):
    """w² − w + 1 = (w − 1/2)² + 3/4 is positive."""
    size = w**2 - w + 1
    form = birkhoff_normal_form(Hamiltonian(sign * (size * p**2 + q**2 / size) / 2, q, p), 2)
    assert form.frequencies == (sign,)
    assert sp.simplify(form.in_actions() - sign * form.actions[0]) == 0
    assert sp.simplify(form.in_variables() - form.source.H) == 0


def test_two_frequencies_of_opposite_signs_turn_one_plane():
    """L = x p_y − y p_x is I₁ − I₂ of (x + i y, p_x + i p_y), of which each has no action by itself."""
    form = birkhoff_normal_form(two(x**4, x * py - y * px - KINETIC + KINETIC), 4)
    assert {*form.frequencies} == {1, -1}
    assert is_normal_form(form).holds
    assert is_normal_form(replace(form, parts={**form.parts, 4: -form.parts[4]})).fails
    mean = sp.Rational(3, 8) * (x**2 + y**2) ** 2  # of (x cos t − y sin t)⁴
    assert sp.expand(form.in_variables() - (x * py - y * px) - mean) == 0


def test_exponents_of_five_springs_are_not_solved_in_radicals():
    """det(μ + V) of a chain whose squares of exponents μ satisfy an equation of the fifth degree with the group S₅."""
    k = sp.Symbol("k", positive=True)

    def hessian(*springs):
        V = sp.Matrix(5, 5, lambda i, j: springs[i] if i == j else -1 if abs(i - j) == 1 else 0)
        return sp.diag(V, sp.eye(5))

    for springs, remedy in (
        ((2, 3, 6, 11, 18), "change to normal coordinates"),
        ((2, 3, 6, 11, 18 * k), "put numbers for the parameters"),
    ):
        with pytest.raises(NoDiagonalFormError, match=f"not solved in radicals; {remedy}"):
            characteristic_exponents(hessian(*springs))
    found = [exponent for exponent, _ in characteristic_exponents(hessian(2, 2, 2, 2, 2))]
    due = [2 * sp.sin(n * sp.pi / 12) for n in range(1, 6)]  # of a chain of equal springs between walls
    assert sorted(abs(complex(f)) for f in found) == pytest.approx([float(f) for f in due], abs=1e-14)


def test_an_integral_with_a_wrong_term_is_refuted_where_its_rate_begins():
    found = formal_integral(birkhoff_normal_form(one(WELL + q**3 + q**4), 4))
    assert found.is_formal_integral().holds
    for degree in (3, 4):
        wrong = replace(found, parts={**found.parts, degree: -found.parts[degree]}).is_formal_integral()
        assert wrong.fails
        assert wrong.evidence[0].text == f"at degree {degree}"
        due = poisson_bracket(
            sp.expand(-2 * found.form.expression({degree: found.parts[degree]})), (p**2 + q**2) / 2, [q], [p]
        )
        assert sp.expand(wrong.residual - due) == 0


def test_a_map_with_a_wrong_term_is_not_canonical_to_its_degree():
    there = near_identity_map(birkhoff_normal_form(HENON_HEILES, 5))
    assert there.is_canonical().holds
    first, *others = there.images
    for degree in (2, 3):
        wrong = replace(there, images=({**first, degree: -first[degree]}, *others)).is_canonical()
        assert wrong.fails
        assert wrong.evidence[0].text == f"at degree {degree - 1}"


def test_norms_are_those_of_the_scaled_problem():
    """q = Q/√ω makes p²/2 + ω² q²/2 + q³ to ω (H₂ + ω^(−5/2) Q³): cubes scale by ω^(−3/2), what follows by ω⁻⁴."""
    unit = remainder_norms(birkhoff_normal_form(one(WELL + q**3), 4), 0.1)
    found = remainder_norms(birkhoff_normal_form(one(q**2 + q**3), 4), 0.1)
    assert found[2] == pytest.approx(unit[2] * 2**-0.75, rel=1e-14)
    assert found[3] == pytest.approx(unit[3] / 4, rel=1e-14)


def test_norms_need_numbers_and_radii_of_each_pair():
    with pytest.raises(ValueError, match="a norm needs numbers: put values for the parameters into H"):
        remainder_norms(birkhoff_normal_form(one(WELL + w * q**3), 4), 0.1)
    form = birkhoff_normal_form(one(WELL + q**3), 4)
    for radii in (0, -1, [0.1, 0.2], [], float("inf"), float("nan")):
        with pytest.raises(ValueError, match="radii should be a positive number, or 1 of them, not"):
            remainder_norms(form, radii)
    assert remainder_norms(form, [0.1]) == remainder_norms(form, sp.Rational(1, 10))


def test_nothing_is_left_of_an_oscillator_at_any_order():
    found = optimal_order(birkhoff_normal_form(one(WELL), 5), 0.1)
    assert (found.order, found.norm, found.reached) == (5, 0.0, False)


@pytest.mark.parametrize("f", [sp.exp, lambda b: sp.sin(b) ** 2 + 1, sp.cosh])
def test_functions_among_the_frequencies_are_refused_and_parameters_in_their_place_are_not(f):
    a, b = sp.symbols("a b", positive=True)

    def with_strength(k):
        return two(a * x**2 / 2 + k * y**2 / 2 + x**2 * y**2, (a * px**2 + k * py**2) / 2)

    with pytest.raises(NoExactFieldError, match="write a parameter for it"):
        birkhoff_normal_form(with_strength(f(b)), 4)
    form = birkhoff_normal_form(with_strength(b), 4)
    I, J = form.actions
    assert any(sp.expand(form.in_actions() - a * A - b * B - A * B) == 0 for A, B in ((I, J), (J, I)))
