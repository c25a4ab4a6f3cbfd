"""Schemes for H = A + εB and symplectic correctors: conditions by powers of ε, in 60-digit arithmetic."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest

from canon.kernel.schemes.order_conditions import conditions
from canon.kernel.schemes.perturbed_schemes import ABA, _generator, corrector, saba, sbab, wisdom_holman


@pytest.fixture(autouse=True)
def sixty_digits():
    with mpmath.workdps(60):
        yield


def digits(values):
    return [mpmath.mpf(c.numerator) / c.denominator for c in values]


def defects_by_power(a, b, length):
    """The greatest coefficient of log(method) − (A + B) by (word length, number of B)."""
    found = {}
    for degree, words in enumerate(conditions(digits(a), digits(b), length), start=1):
        powers = np.array([word.bit_count() for word in range(2**degree)])
        for power in range(1, degree + 1):
            found[degree, power] = max(abs(words[powers == power]))
    return found


TINY = mpmath.mpf(10) ** -50


@pytest.mark.parametrize("family", [saba, sbab])
@pytest.mark.parametrize("stages", range(1, 6))
def test_saba_and_sbab_are_exact_to_order_2n_in_what_is_linear_in_epsilon(family, stages):
    scheme = family(stages)
    found = defects_by_power(scheme.a, scheme.b, min(2 * stages + 1, 9))
    assert all(found[degree, 1] < TINY for degree in range(1, min(2 * stages, 9) + 1))
    if stages <= 4:
        assert found[2 * stages + 1, 1] > 1e-12
    assert found[3, 2] > 1e-6
    assert scheme.a == scheme.a[::-1]
    assert scheme.b == scheme.b[::-1]
    assert sum(scheme.a) == sum(scheme.b) == 1


@pytest.mark.parametrize("stages", range(1, 9))
def test_quadratures_integrate_powers(stages):
    for scheme, degree in ((saba(stages), 2 * stages - 1), (sbab(stages), 2 * stages - 1)):
        times, c = [], Fraction(0)
        for a in scheme.a[:-1]:
            c += a
            times.append(c)
        for power in range(degree + 1):
            total = sum(b * time**power for b, time in zip(scheme.b, times, strict=True))
            assert abs(total - Fraction(1, power + 1)) < Fraction(1, 10**50)


def test_known_coefficients_of_laskar_and_robutel():
    # Table in Laskar & Robutel 2001: SABA3 c1 = ½ − √15/10, d1 = 5/18; SBAB3 c2 = ½ − √5/10, d1 = 1/12.
    assert float(saba(3).a[0]) == pytest.approx(0.5 - 15**0.5 / 10, abs=1e-16)
    assert saba(3).b[0] - Fraction(5, 18) < Fraction(1, 10**50)
    assert float(sbab(3).a[1]) == pytest.approx(0.5 - 5**0.5 / 10, abs=1e-16)
    assert abs(sbab(3).b[0] - Fraction(1, 12)) < Fraction(1, 10**50)


@pytest.mark.parametrize("name", ABA)
def test_blanes_schemes_have_the_orders_in_their_names(name):
    orders = [int(n) for n in name.split("-")]
    scheme = ABA[name]
    found = defects_by_power(scheme.a, scheme.b, orders[0])
    for (degree, power), defect in found.items():
        if degree <= orders[min(power, 3) - 1]:
            assert defect < TINY, (degree, power)
    assert found[orders[1] + 1, 2] > 1e-12
    assert found[orders[2] + 1, 3] > 1e-12


def test_a_wrong_30th_digit_is_noticed():
    scheme = ABA["8-6-4"]
    b = (scheme.b[0] + Fraction(1, 10**30), *scheme.b[1:])
    assert (
        max(d for key, d in defects_by_power(scheme.a, b, 4).items() if key[1] == 1) > mpmath.mpf(10) ** -33
    )


def test_correctors_have_the_published_coefficients():
    # Wisdom, Holman & Touma 1996, with the digits of Rein & Tamayo 2015.
    third = corrector(wisdom_holman(), 3)
    assert [float(b) for b in third.b] == pytest.approx(
        [-0.024900596027799867, 0.024900596027799867], rel=1e-15
    )
    fifth = corrector(wisdom_holman(), 5)
    assert [float(b) for b in fifth.b[:2]] == pytest.approx(
        [0.0083001986759332891, -0.041500993379666445], rel=1e-15
    )
    assert float(fifth.a[1]) == pytest.approx((7 / 40) ** 0.5, rel=1e-16)


@pytest.mark.parametrize("scheme", [wisdom_holman(), saba(2), sbab(3)], ids=lambda s: s.name)
@pytest.mark.parametrize("order", [3, 7, 17])
def test_correctors_cancel_the_series_they_are_made_for(scheme, order):
    made = corrector(scheme, order)
    target = _generator(scheme, order)
    half = len(made.a) // 2
    for n in range(1, order - 1, 2):
        exact = sum(Fraction(4) * b * a**n for a, b in zip(made.a[:half], made.b[:half], strict=True))
        for k in range(2, n + 1):
            exact /= k
        assert exact == target[n]


def test_the_generator_of_wisdom_and_holmans_map_is_the_series_of_x_over_sinh():
    # (x/2)/sinh(x/2) = 1 − x²/24 + 7x⁴/5760 − 31x⁶/967680 + …
    assert _generator(wisdom_holman(), 5) == [
        0,
        Fraction(-1, 24),
        0,
        Fraction(7, 5760),
        0,
        Fraction(-31, 967680),
    ]


@pytest.mark.parametrize("order", [1, 2, 4, 19])
def test_correctors_of_other_orders_are_refused(order):
    with pytest.raises(ValueError, match="odd orders from 3 to 17"):
        corrector(wisdom_holman(), order)


@pytest.mark.parametrize(("family", "stages"), [(saba, 0), (saba, 9), (sbab, 0), (sbab, 2.5)])
def test_other_numbers_of_stages_are_refused(family, stages):
    with pytest.raises(ValueError, match="1 … 8"):
        family(stages)
