"""Requests for centre manifolds: floats, powers and parameters in H, more bits where needed, what is refused."""

import pytest
import sympy as sp
from flint import acb, arb

from canon import Hamiltonian
from canon.mechanics.perturbation import centre_reduction
from canon.mechanics.perturbation.centre_reduction import centre_manifold
from canon.mechanics.perturbation.enclosed.enclosed_diagonal import enclosed_diagonal_form
from canon.mechanics.perturbation.enclosed.enclosed_equilibrium import enclosed_equilibrium
from canon.mechanics.perturbation.enclosed.enclosed_polynomial import FixedPointRing, PrecisionError
from canon.mechanics.perturbation.enclosed.enclosed_series import enclosed_parts
from canon.mechanics.perturbation.quadratic_form import NoDiagonalFormError
from canon.mechanics.perturbation.taylor_parts import NotAnalyticError
from canon.proof.domain.balls import precision

x, y, px, py, c = sp.symbols("x y p_x p_y c", real=True)
KINETIC = (px**2 + py**2) / 2
SADDLE = KINETIC + (2 * y**2 - x**2) / 2


def found(H, order=4, **choices):
    return centre_manifold(Hamiltonian(H, [x, y], [px, py]), order, **choices)


def test_floats_in_a_hamiltonian_are_the_numbers_that_they_are():
    floats = 0.5 * px**2 + 0.5 * py**2 - 0.5 * x**2 + y**2 + 0.25 * x * y**2 * (1 + x) ** 0.5
    exact = SADDLE + x * y**2 * sp.sqrt(1 + x) / 4
    assert found(floats).hamiltonian == found(exact).hamiltonian
    assert found(floats).hamiltonian != found(exact + x * y**2 / 8).hamiltonian
    tenth = found(SADDLE + 0.1 * x * y**2).hamiltonian
    assert tenth == found(SADDLE + sp.Rational(0.1) * x * y**2).hamiltonian


def test_what_the_refusal_of_a_power_advises_is_expanded():
    """y² (1 + y)^c = y² + c y³ + c (c − 1)/2 y⁴ + … on the manifold, where x = 0."""
    for exponent in (c, x):
        with pytest.raises(
            NotAnalyticError, match=rf"rational exponents .*; write exp\({exponent}\*log\(y \+ 1\)\)"
        ):
            found(SADDLE - y**2 + y**2 * (1 + y) ** exponent, parameters={c: sp.Rational(3, 2)})
    advised = SADDLE - y**2 + y**2 * sp.exp(c * sp.log(1 + y))
    for power in (sp.Rational(3, 2), -sp.Rational(3, 2)):
        given = found(advised, parameters={c: power}).hamiltonian
        assert given == found(SADDLE + power * y**3 + power * (power - 1) / 2 * y**4).hamiltonian
        assert given != found(SADDLE + power * y**3 + power * (power + 1) / 2 * y**4).hamiltonian


def test_a_modulus_of_a_parameter_is_no_kink():
    with_modulus = SADDLE + abs(c) * x * y**2
    assert found(with_modulus, parameters={c: -2}).hamiltonian == found(SADDLE + 2 * x * y**2).hamiltonian
    assert found(with_modulus, parameters={c: -2}).hamiltonian != found(SADDLE + x * y**2).hamiltonian


def test_large_coefficients_take_more_bits_until_the_digits_are_certain(monkeypatch):
    """K₄ is quadratic in the cubic coefficient: 10⁵⁰ times as large, to as many digits after the point."""
    large, unit = found(SADDLE + 10**25 * x * y**2), found(SADDLE + x * y**2)
    assert large.bits > unit.bits
    assert large.error < 1e-16
    quartic = [m.hamiltonian.H.coeff(m.q[0], 4).evalf(15) for m in (large, unit)]
    assert abs(quartic[0] / quartic[1] / 10**50 - 1) < 1e-13
    monkeypatch.setattr(centre_reduction, "MOST_BITS", 300)
    with pytest.raises(PrecisionError, match=r"300 bits give an error bound of .* only; take a lower order"):
        found(SADDLE + 10**25 * x * y**2)


@pytest.mark.parametrize(
    ("H", "choices", "error", "said"),
    [
        (KINETIC - x**2 / 2 - 2 * y**2 + x**2 * y, {}, PrecisionError, r"k·λ of k = \(.*rates of hyperbolic pairs"),
        (x * px + y * py + x * py - y * px + x**3, {}, NoDiagonalFormError, "four exponents ±α ± iβ belong together"),
        (SADDLE + c * x * y**2, {"parameters": {c: sp.I}}, ValueError, "the parameter c should be a real number"),
        (SADDLE + x * y**2, {"at": {x: c}}, ValueError, "the place of x should be a real number, not c"),
    ],
)  # fmt: skip
def test_resonant_rates_complex_exponents_and_numbers_are_refused(H, choices, error, said):
    with pytest.raises(error, match=said):
        found(H, **choices)


def test_of_two_saddles_the_centre_manifold_is_a_point():
    alone = found(KINETIC - x**2 / 2 - y**2 + x**2 * y, 3)
    assert [float(rate) for rate in alone.rates] == pytest.approx([1, 2**0.5], abs=1e-15)
    assert alone.embedding == {x: 0, y: 0, px: 0, py: 0}
    with pytest.raises(ValueError, match="the centre manifold is the equilibrium alone"):
        alone.hamiltonian  # noqa: B018


@pytest.mark.parametrize(
    ("f", "said"),
    [
        (sp.sqrt(x), r"sqrt\(x\) has no Taylor series where x = 0"),
        (1 / x, "1/x has no Taylor series where x = 0"),
        (sp.sqrt(x - 1), r"x - 1 is not certainly positive where sqrt\(x - 1\) is expanded"),
        (sp.log(x - 1), r"x - 1 is not certainly positive where log\(x - 1\) is expanded"),
    ],
)
def test_roots_quotients_and_logarithms_are_expanded_where_they_are_analytic(f, said):
    ring = FixedPointRing(1, 64)
    with pytest.raises(NotAnalyticError, match=said):
        enclosed_parts(f, {x: ring.variable(0)}, {x: acb(0)}, 3)
    parts = enclosed_parts(f, {x: ring.variable(0)}, {x: acb(2)}, 3)
    for k, part in enumerate(parts):
        due = sp.N(f.diff(x, k).subs(x, 2) / sp.factorial(k), 20)
        assert abs(float(part.coefficients.get((k,), acb(0)).real) - float(due)) < 1e-14


def test_an_equilibrium_is_proved_where_the_force_is_known_well_enough():
    """Beside a force A (exp u − 1 − u), known to A 2⁻ᵖ only, the zero of −u is not told at A = 2⁶⁰."""
    u = x - sp.Rational(1, 3)
    for size in (1, 2**60):
        H = size * (sp.exp(u) - 1 - u - u**2 / 2) - u**2 / 2
        with precision(160):
            if size == 1:
                (place,) = enclosed_equilibrium(H, [x], [arb("0.3")], {})
                assert place.overlaps(arb(1) / 3)
                assert place.rad() < arb("1e-30")
                assert not place.overlaps(arb(1) / 3 + arb("1e-20"))
            else:
                with pytest.raises(PrecisionError, match="the equilibrium was not proved; take more digits"):
                    enclosed_equilibrium(H, [x], [arb("0.3")], {})


@pytest.mark.parametrize(
    ("sign", "said"),
    [(1, "the sign of an elliptic pair is not known"), (-1, "the bracket of a hyperbolic pair is not known")],
)
def test_pairs_of_a_quadratic_form_are_told_where_its_balls_are_narrow(sign, said):
    """p²/2 ± q²/2 with balls for all coefficients: λ = ∓i or 1."""

    def form(radius):
        ball = arb(0, radius)
        return enclosed_diagonal_form([[sign + ball, ball], [ball, 1 + ball]])

    (exponent,) = form(1e-9).exponents
    assert exponent.overlaps(acb(0, -1) if sign > 0 else acb(1))
    assert not exponent.overlaps(acb(0, 1) if sign > 0 else acb(-1))
    with pytest.raises(PrecisionError, match=said):
        form(0.004)
