"""Polynomials with a bound on their errors: after every operation the exact coefficients lie in the balls."""

from fractions import Fraction

import pytest
from flint import acb, arb, fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.mechanics.perturbation.enclosed.enclosed_polynomial import FixedPointRing, PrecisionError

RING = FixedPointRing(2, 40)
parts = st.fractions(min_value=-3, max_value=3, max_denominator=7)
exact_ones = st.dictionaries(
    st.tuples(st.integers(0, 2), st.integers(0, 2)), st.tuples(parts, parts), max_size=3
)
numbers = st.integers(-5, 5)


def ball(x):
    return arb(fmpq(x.numerator, x.denominator))


def enclosed(exact):
    """Return a polynomial, made of its variables and constants, whose coefficients are not multiples of 2⁻⁴⁰."""
    total = RING.zero
    for powers, (re, im) in exact.items():
        term = RING.constant(acb(ball(re), ball(im)))
        for j, power in enumerate(powers):
            for _ in range(power):
                term = term * RING.variable(j)
        total = total + term
    return total


def holds(found, exact):
    """Tell whether all exact coefficients lie in the balls, which are small."""
    balls = found.coefficients
    zero = Fraction(0), Fraction(0)
    places = {*balls, *exact}
    values = (
        (balls.get(k, acb(arb(0, found.bound), arb(0, found.bound))), exact.get(k, zero)) for k in places
    )
    return found.bound < 1e-6 and all(
        b.real.contains(ball(re)) and b.imag.contains(ball(im)) for b, (re, im) in values
    )


def product(f, g):
    total = {}
    for (a, b), (re, im) in f.items():
        for (c, d), (more_re, more_im) in g.items():
            before = total.get((a + c, b + d), (Fraction(0), Fraction(0)))
            total[a + c, b + d] = (
                before[0] + re * more_re - im * more_im,
                before[1] + re * more_im + im * more_re,
            )
    return total


def scaled(f, factor):
    return {k: (re * factor, im * factor) for k, (re, im) in f.items()}


def added(f, g):
    zero = Fraction(0), Fraction(0)
    return {k: tuple(x + y for x, y in zip(f.get(k, zero), g.get(k, zero), strict=True)) for k in {*f, *g}}


@settings(max_examples=50)
@given(exact_ones, exact_ones, numbers, st.integers(1, 9))
def test_every_operation_encloses_the_exact_result(f, g, number, divisor):
    F, G = enclosed(f), enclosed(g)
    assert holds(F, f)
    assert holds(F + G, added(f, g))
    assert holds(F - G, added(f, scaled(g, -1)))
    assert holds(F * G, product(f, g))
    assert holds(F.times(number), scaled(f, number))
    assert holds(F.over(divisor), scaled(f, Fraction(1, divisor)))


def test_the_wrong_twin_is_not_enclosed():
    f = {(1, 0): (Fraction(1, 3), Fraction(2, 3))}
    assert holds(enclosed(f).times(3), scaled(f, 3))
    for wrong in (
        (Fraction(1), Fraction(3)),
        (Fraction(1), Fraction(1, 2)),
        (Fraction(1) + Fraction(1, 10**9), Fraction(2)),
    ):
        assert not holds(enclosed(f).times(3), {(1, 0): wrong})


def test_a_complex_polynomial_times_an_imaginary_one():
    """(x + 2i y) 3i = −6 y + 3i x."""
    f, i3 = RING.variable(0) + RING.variable(1) * RING.constant(acb(0, 2)), RING.constant(acb(0, 3))
    due = {(1, 0): (Fraction(0), Fraction(3)), (0, 1): (Fraction(-6), Fraction(0))}
    assert holds(f * i3, due)
    assert holds(i3 * f, due)
    assert not holds(f * i3, scaled(due, -1))


@pytest.mark.parametrize("number", [acb(1) / acb(0), acb(0, arb(0, float("inf")))], ids=["pole", "anything"])
def test_a_number_without_bounds_makes_no_polynomial(number):
    with pytest.raises(PrecisionError, match="not known to its last whole digit"):
        RING.constant(number)
