"""Lie series and averages: closed forms, laws on generated input, the other route, and what is refused."""

from dataclasses import replace

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.mechanics.hamilton.bracket import poisson_bracket
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.perturbation.averaging import AveragingError, adiabatic_invariant, average
from canon.mechanics.perturbation.birkhoff import birkhoff_normal_form
from canon.mechanics.perturbation.fourier_series import (
    NoFourierSeriesError,
    fourier_bracket,
    fourier_expression,
    fourier_series,
)
from canon.mechanics.perturbation.lie_series import lie_deprit, lie_series

q, p, tau, T = sp.symbols("q p tau T", real=True)
theta, phi, I, J, w, eps, b, Omega = sp.symbols("theta phi I J omega epsilon b Omega", positive=True)

QUARTIC = Hamiltonian(w * I + eps * I**2 * sp.cos(theta) ** 4, theta, I)
KAPITZA = Hamiltonian(
    Omega * T + eps * (p**2 / 2 - sp.cos(q) + b * sp.cos(tau) * sp.cos(q)), [q, tau], [p, T]
)
RESONANT = Hamiltonian(
    I
    + sp.Rational(201, 100) * J
    + eps * (sp.sqrt(I) * J * sp.cos(2 * theta - phi) + J * sp.cos(phi) + I * J),
    [theta, phi],
    [I, J],
)


def test_the_lie_series_of_the_oscillator_is_its_rotation():
    found = lie_series(q, (q**2 + p**2) / 2, [q], [p], 9, eps)
    due = sp.series(q * sp.cos(eps) + p * sp.sin(eps), eps, 0, 10).removeO()
    assert sp.expand(found - due) == 0


monomial = st.tuples(st.integers(-3, 3), st.integers(0, 3), st.integers(0, 3)).filter(
    lambda m: 1 < m[1] + m[2] < 4
)
polynomial = st.lists(monomial, min_size=1, max_size=2).map(
    lambda terms: sp.Add(*(c * q**i * p**j for c, i, j in terms))
)


@given(polynomial, polynomial, polynomial)
@settings(max_examples=50, deadline=None)
def test_lie_series_keep_products_and_brackets(f, g, W):
    def moved(h):
        return lie_series(h, W, [q], [p], 2, eps)

    def to_order(h):
        return [sp.expand(h).coeff(eps, n) for n in range(3)]

    assert to_order(moved(f * g)) == to_order(moved(f) * moved(g))
    bracket = poisson_bracket(f, g, [q], [p])
    assert to_order(moved(bracket)) == to_order(poisson_bracket(moved(f), moved(g), [q], [p]))
    assert to_order(lie_series(moved(f), -W, [q], [p], 2, eps)) == to_order(f)


@given(polynomial, polynomial, polynomial)
@settings(max_examples=50, deadline=None)
def test_deprits_transform_moves_with_its_generator(f, W1, W2):
    """d/dε of T f is T{f, W}: the definition, by SymPy's derivative in ε."""
    W = W1 + eps * W2
    moved = lie_deprit(f, W, [q], [p], 3, eps)
    rate = lie_deprit(poisson_bracket(f, W, [q], [p]), W, [q], [p], 2, eps)
    assert [sp.expand(moved.diff(eps) - rate).coeff(eps, n) for n in range(3)] == [0, 0, 0]
    assert sp.expand(lie_deprit(f, W1, [q], [p], 3, eps) - lie_series(f, W1, [q], [p], 3, eps)) == 0


def test_the_bracket_of_fourier_series_is_sympys():
    f = I**2 * sp.cos(theta) ** 3 * q + sp.sin(theta - 2 * phi) * J * p
    g = sp.exp(sp.I * theta) * I * J * p**2 + sp.sin(phi) ** 2 * q
    series = fourier_bracket(
        fourier_series(f, [theta, phi]), fourier_series(g, [theta, phi]), [I, J], [q], [p]
    )
    due = poisson_bracket(f, g, [theta, phi, q], [I, J, p])
    assert sp.simplify(sp.expand((fourier_expression(series, [theta, phi]) - due).rewrite(sp.exp))) == 0


def test_the_quartic_oscillator_agrees_with_its_normal_form():
    x, y = sp.symbols("x y", real=True)
    K = average(QUARTIC.__class__(QUARTIC.H.subs(w, 1), theta, I), theta, 3, eps).K
    normal = birkhoff_normal_form(Hamiltonian((y**2 + x**2) / 2 + x**4 / 4, x, y), 8)
    by_degree = normal.in_actions().subs(normal.actions[0], I)
    assert sp.expand(K.subs(eps, 1) - by_degree) == 0


def test_kapitzas_pendulum_has_the_effective_potential_of_landau_and_lifshitz():
    """V_eff = −cos q + b² sin² q/(4Ω²): Mechanics, § 30, in these units."""
    found = average(KAPITZA, tau, 3, eps)
    assert found.terms[1] == p**2 / 2 - sp.cos(q)
    assert found.terms[2] == 0
    assert sp.simplify(found.terms[3] - b**2 * sp.sin(q) ** 2 / (4 * Omega**2)) == 0


@pytest.mark.parametrize(
    ("H", "angles", "order", "resonances"),
    [(QUARTIC, theta, 3, None), (KAPITZA, tau, 3, None), (RESONANT, [theta, phi], 2, [(2, -1)])],
)
def test_the_average_is_proved_and_its_wrong_twins_are_refuted(H, angles, order, resonances):
    found = average(H, angles, order, eps, resonances)
    assert found.is_average().holds
    for n in range(1, order + 1):
        if found.terms[n] != 0:
            twin = replace(found, terms=(*found.terms[:n], found.terms[n] * 2, *found.terms[n + 1 :]))
            assert twin.is_average().fails
    twin = replace(found, generators=(-found.generators[0], *found.generators[1:]))
    assert twin.is_average().fails
    parts = tuple(sp.expand(H.H).coeff(eps, n) for n in range(order + 1))
    nothing_done = replace(found, terms=parts, generators=(sp.S.Zero,) * order)
    assert "still has the fast term" in nothing_done.is_average().feedback


def test_a_divisor_that_vanishes_by_its_roots_is_a_resonance():
    """√(3 + 2√2) = 1 + √2, so that the term of θ − φ stays; divided by, it gave nan."""
    first = sp.sqrt(3 + 2 * sp.sqrt(2))
    H1 = eps * I * sp.cos(theta - phi)
    same = average(
        Hamiltonian(first * I + (1 + sp.sqrt(2)) * J + H1, [theta, phi], [I, J]), [theta, phi], 2, eps
    )
    assert same.terms[1:] == (I * sp.cos(theta - phi), 0)
    other = average(
        Hamiltonian(first * I + (1 + sp.sqrt(3)) * J + H1, [theta, phi], [I, J]), [theta, phi], 1, eps
    )
    assert other.terms[1] == 0


def test_near_resonant_terms_stay_and_their_small_divisor_is_not_divided_by():
    free = average(RESONANT, [theta, phi], 1, eps)
    assert min(abs(d) for d in free.divisors.values()) == sp.Rational(1, 100)
    kept = average(RESONANT, [theta, phi], 2, eps, [(2, -1)])
    assert min(abs(d) for d in kept.divisors.values()) > sp.Rational(9, 10)
    assert kept.terms[1].has(sp.cos(2 * theta - phi))
    with pytest.raises(ValueError, match="keeps resonant terms"):
        adiabatic_invariant(kept)


def test_the_adiabatic_invariant_changes_beyond_its_order_only():
    invariant = adiabatic_invariant(average(QUARTIC, theta, 2, eps))
    rate = sp.expand(poisson_bracket(invariant, QUARTIC.H, [theta], [I]))
    for n in range(3):
        assert sp.simplify(rate.coeff(eps, n).rewrite(sp.exp)) == 0
    assert sp.simplify(rate.coeff(eps, 3).rewrite(sp.exp)) != 0


def test_von_zeipels_function_generates_the_same_map_to_first_order():
    found = average(QUARTIC, theta, 1, eps)
    F = found.F2
    place = {F.q[0]: theta, F.new_p[0]: I}
    old_action = F.F.diff(F.q[0]).subs(place)
    new_angle = F.F.diff(F.new_p[0]).subs(place)
    assert sp.simplify(sp.expand(found.to_new(I) - old_action).coeff(eps, 1)) == 0
    assert sp.simplify(sp.expand(found.to_new(theta) + new_angle - 2 * theta).coeff(eps, 1)) == 0
    assert F.kind == (2,)


def test_an_exact_resonance_keeps_the_order_that_was_reached():
    H = Hamiltonian(
        I + J + eps * sp.cos(theta) * I * J + eps**2 * J * sp.cos(theta - phi), [theta, phi], [I, J]
    )
    with pytest.raises(AveragingError, match=r"at order 2 the term of k = \(-?1, -?1\)") as failed:
        average(H, [theta, phi], 3, eps, resonances=[])
    assert failed.value.reached.order == 1
    assert failed.value.reached.is_average().holds
    assert average(H, [theta, phi], 2, eps).is_average().holds


@pytest.mark.parametrize(
    ("H", "error", "said"),
    [
        (
            Hamiltonian(w * I + p**2 / 2 + eps * sp.cos(theta), [theta, q], [I, p]),
            AveragingError,
            "depends on p",
        ),
        (
            Hamiltonian(w * I + eps / (2 + sp.cos(theta)), theta, I),
            NoFourierSeriesError,
            "trigonometric polynomial",
        ),
        (
            Hamiltonian(w * I + eps * sp.cos(theta / 2), theta, I),
            NoFourierSeriesError,
            "trigonometric polynomial",
        ),
        (Hamiltonian(w * I + sp.exp(eps) * I, theta, I), ValueError, "no polynomial in epsilon"),
    ],
)
def test_what_has_no_average_is_refused(H, error, said):
    with pytest.raises(error, match=said):
        average(H, theta, 2, eps)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: average(QUARTIC, I, 1, eps), "the angles should be among the coordinates theta"),
        (lambda: average(QUARTIC, [], 1, eps), "the angles should be among the coordinates theta"),
        (lambda: average(QUARTIC, theta, 0, eps), "the order should be a whole number from 1, not 0"),
        (
            lambda: adiabatic_invariant(average(QUARTIC, theta, 1, eps), theta),
            r"theta is no momentum of a fast angle; those are \(I,\)",
        ),
        (lambda: lie_series(q, eps * q, [q], [p], 2, eps), "W depends on epsilon; lie_deprit takes such a W"),
        (lambda: lie_series(q, p, [q], [p], -1, eps), "the order should be a whole number from 0, not -1"),
        (lambda: lie_deprit(q, p, [q], [p], -1, eps), "the order should be a whole number from 0, not -1"),
    ],
)
def test_angles_orders_and_small_quantities_that_are_none_are_refused_with_what_to_give(call, said):
    with pytest.raises(ValueError, match=said):
        call()


def test_what_lie_series_refuses_is_taken_by_deprits_flow():
    """W = ε q moves p alone, dp/dε = {p, W} = −ε: p − ε²/2 at ε."""
    assert sp.expand(lie_deprit(p, eps * q, [q], [p], 3, eps) - (p - eps**2 / 2)) == 0
    assert lie_deprit(q, eps * q, [q], [p], 3, eps) == q


def test_a_wave_with_one_of_its_two_harmonics_is_complex():
    alone = {(-1, 2): 1 + 2 * sp.I}
    found = fourier_expression(alone, [theta, phi])
    assert sp.expand((found - (1 + 2 * sp.I) * sp.exp(sp.I * (2 * phi - theta))).rewrite(sp.exp)) == 0
    assert sp.expand((found - (1 + 2 * sp.I) * sp.exp(sp.I * (theta - 2 * phi))).rewrite(sp.exp)) != 0
    assert fourier_series(found, [theta, phi]) == {k: sp.expand(c) for k, c in alone.items()}
