"""Nested roots of half angles, on the ranges on which they are cosines and sines."""

import pytest
from sympy import Abs, cos, pi, sin, sqrt, symbols

from canon.proof import Domain, equal

x = symbols("x", real=True)

TRUE = [
    (
        sqrt(2 + sqrt(2 + 2 * cos(4 * x))),
        2 * cos(x),
        Domain(
            (
                -pi / 4 < x,
                x < pi / 4,
            )
        ),
        2 * sin(x),
    ),
    (
        sqrt(2 + sqrt(2 + 2 * cos(4 * x))),
        2 * cos(x),
        Domain(
            (
                -pi / 4 <= x,
                x <= pi / 4,
            )
        ),
        2 * sin(x),
    ),
    (
        sqrt(2 + sqrt(2 + 2 * cos(4 * x))),
        2 * cos(x),
        Domain(
            (
                x >= 0,
                x <= pi / 4,
            )
        ),
        2 * cos(2 * x),
    ),
    (
        sqrt(2 + sqrt(2 + sqrt(2 + 2 * cos(8 * x)))),
        2 * cos(x),
        Domain(
            (
                -pi / 8 <= x,
                x <= pi / 8,
            )
        ),
        2 * cos(2 * x),
    ),
    (
        sqrt(2 - sqrt(2 + 2 * cos(4 * x))),
        2 * sin(x),
        Domain(
            (
                x >= 0,
                x <= pi / 4,
            )
        ),
        2 * cos(x),
    ),
    (
        sqrt((1 + cos(x)) / 2),
        cos(x / 2),
        Domain(
            (
                -pi <= x,
                x <= pi,
            )
        ),
        sin(x / 2),
    ),
    (
        sqrt((1 - cos(x)) / 2),
        sin(x / 2),
        Domain(
            (
                x >= 0,
                x <= 2 * pi,
            )
        ),
        cos(x / 2),
    ),
    (
        sqrt(2 + sqrt(2 + 2 * cos(x))),
        2 * cos(x / 4),
        Domain(
            (
                -pi <= x,
                x <= pi,
            )
        ),
        2 * cos(x / 2),
    ),
    (
        sqrt(1 + sin(2 * x)),
        sin(x) + cos(x),
        Domain(
            (
                -pi / 4 <= x,
                x <= 3 * pi / 4,
            )
        ),
        sin(x) - cos(x),
    ),
    (
        sqrt(2 + sqrt(2 + 2 * cos(4 * x))),
        2 * Abs(cos(x)),
        Domain(
            (
                -pi / 4 <= x,
                x <= pi / 4,
            )
        ),
        2 * Abs(sin(x)),
    ),
    (
        sqrt((1 - sqrt(1 - sin(x) ** 2)) / 2),
        sin(x / 2),
        Domain(
            (
                x >= 0,
                x <= pi / 2,
            )
        ),
        cos(x / 2),
    ),
    (
        sqrt(2 + sqrt(2 + 2 * cos(4 * x))),
        -2 * cos(x),
        Domain(
            (
                3 * pi / 4 <= x,
                x <= 5 * pi / 4,
            )
        ),
        2 * cos(x),
    ),
]


@pytest.mark.parametrize(("left", "right", "domain", "twin"), TRUE)
def test_identity_holds_and_its_twin_fails(left, right, domain, twin):
    assert equal(left, right, domain).holds
    assert equal(left, twin, domain).fails


def test_beyond_its_range_the_root_is_another_function():
    nested = sqrt(2 + sqrt(2 + 2 * cos(4 * x)))
    assert equal(nested, 2 * cos(x), Domain((x >= 0, x <= pi / 2))).fails
    assert equal(nested, 2 * sin(x), Domain((x >= pi / 4, x <= pi / 2))).holds
    assert equal(nested, 2 * cos(x)).fails
    assert equal(sqrt(cos(3 * x) ** 2), cos(3 * x), Domain((x >= -pi / 6, x <= pi / 6))).holds
    assert equal(sqrt(cos(3 * x) ** 2), cos(3 * x), Domain((x >= -pi / 6, x <= pi / 5))).fails
