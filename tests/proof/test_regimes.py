"""Open parts of a domain on which pieces are one formula, bounds of real values, and zeros that fill such a part."""

import time

import pytest
import sympy as sp
from sympy import Abs, Derivative, Eq, Function, Or, Piecewise, acosh, asec, sign, sqrt

from canon.proof.definedness.definedness import lack_of_value
from canon.proof.definedness.open_regimes import MOST, regimes
from canon.proof.definedness.real_values import LONGEST, is_nowhere_real, real_bounds
from canon.proof.domain.domain import Domain
from canon.proof.kinks import is_thin
from canon.proof.refute.largest_minor import Pivots, largest_minor
from canon.proof.zero_pieces import zero_piece

x, y, z, u, v = sp.symbols("x y z u v", real=True)


def parts(exprs, *conditions):
    return {str(regime) for regime in regimes(exprs, Domain(conditions), time.monotonic() + 5)}


def test_regimes_are_open_parts():
    assert parts([Abs(x)]) == {"x > 0", "x < 0"}
    assert parts([Abs(x)], Or(Eq(x, 5), x < 0)) == {"x < 0"}
    assert parts([Abs(x)], Or(x > 5, x < 0)) == {"x > 0", "x < 0"}
    assert parts([Abs(x), Abs(sqrt(x) - 1)]) == {"x > 0, sqrt(x) - 1 < 0", "x > 0, sqrt(x) - 1 > 0"}


def test_of_many_regimes_some_are_looked_at():
    stairs = sum(Abs(x - k) for k in range(-6, 7))
    assert len(parts([stairs])) == MOST
    assert len(parts([Abs(x - 1) + Abs(x + 1)])) == 3


def test_where_an_inverse_hyperbolic_cosine_is_real():
    assert real_bounds([acosh(x)], Domain()) == [x - 1 > 0]
    assert real_bounds([asec(x)], Domain()) == [x**2 - 1 > 0]
    assert real_bounds([acosh(x)], Domain((x > 2,))) == []


def test_a_long_function_may_be_real():
    short = sqrt(-1 - x**2)
    long = sp.Add(short, *(x**k for k in range(2, LONGEST)))
    assert is_nowhere_real(short + x, Domain())
    assert not is_nowhere_real(long, Domain())


def test_zeros_of_a_product_of_conjugates_are_thin_where_these_are_few():
    few, many = (sp.Add(*(sqrt(x**2 + k) for k in range(1, n))) for n in (3, 12))
    assert is_thin(few - 3, Domain()) is True
    assert is_thin(many - 90, Domain()) is False
    assert is_thin(few - few, Domain()) is None


@pytest.mark.parametrize(
    ("f", "found"),
    [
        (x + Abs(x) + y + Abs(y), "x < 0, y < 0"),
        (sum(s + Abs(s) for s in (x, y, z, u, v)), None),
        (1 + sign(x**2 + y**2 - 1), "x**2 + y**2 - 1 < 0"),
        ((x + Abs(x)) * Derivative(Abs(Function("V")(x)), x), None),
        (Piecewise((0, x > y), (1, True)) * 2, "x > y"),
    ],
    ids=str,
)
def test_a_part_on_which_a_function_vanishes_is_found_among_few(f, found):
    said = zero_piece(f, Domain())
    assert said is None if found is None else set(said.split(", ")) == set(found.split(", "))


def test_a_piece_for_one_value_alone_is_no_value():
    for only in (Eq(Abs(x), 1), Eq(sqrt(x**2), 1), Eq(x, 1)):
        lack = lack_of_value(Piecewise((y, only)), Domain(), time.monotonic() + 5)
        assert lack is not None
    assert lack_of_value(Piecewise((y, Abs(x) > 1)), Domain(), time.monotonic() + 5) is None


def test_no_equations_have_no_minor():
    assert largest_minor((), Domain()) == Pivots((), ())
    assert largest_minor(((x, y), (2 * x, y + 1)), Domain()) == Pivots((0, 1), (0, 1))
    assert largest_minor(((x, y), (2 * x, 2 * y)), Domain()) == Pivots((0,), (0,))
