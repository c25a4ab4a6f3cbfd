"""Coefficient tables against the order conditions, in 60-digit arithmetic."""

import mpmath
import numpy as np
import pytest

from canon.kernel.schemes.order_conditions import _nystrom_ideal, composed, defects, order
from canon.kernel.schemes.splitting_schemes import SCHEMES


def _digits(coefficients):
    return [mpmath.mpf(c.numerator) / c.denominator for c in coefficients]


@pytest.fixture(autouse=True)
def sixty_digits():
    with mpmath.workdps(60):
        yield


@pytest.mark.parametrize("name", SCHEMES)
def test_order_conditions_hold_to_50_digits_and_no_further_ones_do(name):
    scheme = SCHEMES[name]
    found = defects(_digits(scheme.a), _digits(scheme.b), scheme.order + 1, nystrom=scheme.nystrom)
    assert max(found[:-1]) < mpmath.mpf(10) ** -50
    assert found[-1] > mpmath.mpf(10) ** -10


@pytest.mark.parametrize("name", SCHEMES)
def test_tables_are_complete_symmetric_and_cited(name):
    scheme = SCHEMES[name]
    assert sum(scheme.a) == sum(scheme.b) == 1
    assert scheme.a == scheme.a[::-1]
    assert scheme.b == scheme.b[::-1]
    assert len(scheme.a) == len(scheme.b) + 1
    assert "doi:10." in scheme.citation
    assert scheme.name == name


@pytest.mark.parametrize("name", ["verlet", "forest-ruth", "blanes-moan-4", "srkn-6b", "kahan-li-6"])
def test_a_wrong_30th_digit_is_noticed(name):
    scheme = SCHEMES[name]
    a, b = _digits(scheme.a), _digits(scheme.b)
    wrong = mpmath.mpf(10) ** -30
    a[1 if not scheme.a[0] else 0] += wrong
    found = defects(a, b, scheme.order, nystrom=scheme.nystrom)
    assert max(found) > wrong / 1000


@pytest.mark.parametrize("name", ["srkn-6a", "srkn-6b"])
def test_nystrom_methods_have_order_four_in_general(name):
    scheme = SCHEMES[name]
    a, b = (list(map(float, half)) for half in (scheme.a, scheme.b))
    assert order(a, b) == 4
    assert order(a, b, nystrom=True) == 6


def test_the_nystrom_ideal_has_the_right_size():
    # Free Lie algebra on two letters: 3, 6, 9, 18 elements of length 4 … 7; modulo the ideal 2, 4, 5, 10
    # (A. Murua, On order conditions for partitioned symplectic methods, SIAM J. Numer. Anal. 34, 1997).
    assert [len(_nystrom_ideal(7)[length]) for length in (4, 5, 6, 7)] == [1, 2, 4, 8]


def test_the_series_of_one_exponential_is_its_own():
    words = composed([mpmath.mpf(1), mpmath.mpf(0)], [mpmath.mpf(0)], 3)
    assert words[3][0] == mpmath.mpf(1) / 6
    assert not any(words[3][1:])


def test_first_second_and_third_order_are_told_apart():
    assert order([1.0, 0.0], [1.0]) == 1
    assert order([0.5, 0.5], [1.0]) == 2
    assert order([0.0, 2 / 3, -2 / 3, 1.0], [7 / 24, 3 / 4, -1 / 24]) == 3
    assert order([0.4, 0.5], [1.0]) == 0
    assert order([np.nan, 0.5], [1.0]) == 0
