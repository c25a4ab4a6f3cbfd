"""Square roots of sums with moduli and roots: squares in disguise, and what only looks like one."""

import pytest
from sympy import Abs, sqrt, symbols

from canon.proof.vanish import equal

x, y = symbols("x y", real=True)
a, b = symbols("a b", positive=True)

SQUARES = [
    (sqrt(1 + x**2 + 2 * Abs(x)), 1 + Abs(x), 1 + x),
    (sqrt(4 + x**2 + 4 * Abs(x)), 2 + Abs(x), 2 - Abs(x)),
    (sqrt(1 + x**2 - 2 * Abs(x)), Abs(1 - Abs(x)), 1 - Abs(x)),
    (sqrt(x**4 + 2 * x**2 * Abs(x) + x**2), x**2 + Abs(x), x**2 + x),
    (sqrt(x**2 + y**2 + 2 * Abs(x) * y), Abs(Abs(x) + y), Abs(x) + y),
    (sqrt(2 + 2 * x**2 + 4 * Abs(x)), sqrt(2) * (1 + Abs(x)), sqrt(2) + Abs(x)),
    (sqrt(1 + a + 2 * sqrt(a)), 1 + sqrt(a), 1 - sqrt(a)),
    (sqrt(a + b + 2 * sqrt(a * b)), sqrt(a) + sqrt(b), sqrt(a) - sqrt(b)),
]


@pytest.mark.parametrize(("root", "right", "wrong"), SQUARES)
def test_the_root_of_a_square_of_a_sum_is_the_modulus_of_the_sum(root, right, wrong):
    assert equal(root, right).holds
    assert equal(root, wrong).fails


NO_SQUARES = [
    sqrt(2 + x**2 + 2 * Abs(x)),
    sqrt(1 + x**2 + 3 * Abs(x)),
    sqrt(3 + x**2 + 4 * Abs(x)),
    sqrt(1 + x**2 + y**2 + 2 * Abs(x) + 2 * Abs(y)),
]


@pytest.mark.parametrize("root", NO_SQUARES)
def test_other_roots_of_sums_with_moduli_are_left_as_they_are(root):
    assert equal(root, 1 + Abs(x)).fails
    assert equal(root**2 - root.base, 0).holds
    assert not equal(root * sqrt(4 * root.base), 2 * root.base + 1).holds
    assert equal(root * sqrt(4 * root.base), 2 * root.base).holds


def test_roots_in_roots_four_deep_cancel() -> None:
    left, right, wrong = sqrt(a + b + 2 * sqrt(a * b)), sqrt(a) + sqrt(b), sqrt(a) - sqrt(b)
    for _ in range(3):
        left, right, wrong = (sqrt(1 + f) for f in (left, right, wrong))
    assert equal(left, right).holds
    assert not equal(left, wrong).holds
