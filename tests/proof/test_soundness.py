"""Verdicts that once were wrong, each beside a true neighbour that must still be proved."""

import pytest
import sympy as sp
from sympy import (
    Abs,
    Derivative,
    Eq,
    Function,
    I,
    Max,
    Min,
    Ne,
    Piecewise,
    Rational,
    acos,
    atan,
    atan2,
    cos,
    exp,
    log,
    pi,
    sign,
    sin,
    sqrt,
    tan,
)

from canon.proof import Domain, equivalent_equations, vanishes
from canon.proof.verdict import Status

x, y, z, u, v = sp.symbols("x y z u v", real=True)
p, q = sp.symbols("p q", positive=True)
s, t = sp.symbols("s t", nonnegative=True)
negative = sp.Symbol("m", negative=True)
below = sp.Symbol("b", nonpositive=True)
c = sp.Symbol("c", complex=True)
n = sp.Symbol("n", integer=True)
even = sp.Symbol("k", even=True)

FAR = 10**6
SUM = 6 * x + 6 * y
POWER = SUM ** Rational(10**13 + 1, 3)

NOT_ZERO = [
    # nonnegative bases may vanish, and their powers with them
    (sign(s**p) - 1, ()),
    (sign(s ** (-y)) - 1, ()),
    (sign(Abs(x) ** p) - 1, ()),
    (Piecewise((1, s**p > 0), (0, True)) - 1, ()),
    (atan2(-(s**p), -1) + pi - atan(s**p), ()),
    (s - 1, (s**p <= 0,)),
    # negative bases have complex logarithms
    (sign(negative**n) - 1, (n > 1000,)),
    (log(negative**n) - n * log(negative), (n > 1000,)),
    # squares of what is not real
    (sign(1 / c**2) - 1, ()),
    (sign(1 / (sqrt(x + FAR) + 1) ** 2) - 1, ()),
    # the cut of atan2 belongs to its upper side, and only for real arguments
    (atan2(below, x) + acos(x / sqrt(x**2 + below**2)), ()),
    (atan2(y, x) + acos(x / sqrt(x**2 + y**2)), (y <= 0,)),
    # a branch without a value says nothing about the others
    (Piecewise((1 / x, y > -FAR), (1, True)), (Eq(x, 0),)),
    (y + sp.Sum(1 / n**2, (n, 1, sp.oo)), (Eq(x, 0),)),
]

ZERO = [
    (sign(p**y) - 1, ()),
    (sign(s**p + 1) - 1, ()),
    (s**p * s**q - s ** (p + q), ()),
    (sqrt(s ** (2 * p)) - s**p, ()),
    (Abs(s**p) - s**p, ()),
    (sign(negative**even) - 1, ()),
    (negative**n - (-1) ** n * (-negative) ** n, ()),
    ((x * y) ** n - x**n * y**n, (Ne(x, 0), Ne(y, 0))),
    (sign(1 / (1 + x**2) ** 2) - 1, ()),
    (sign(1 / x**2) - 1, (Ne(x, 0),)),
    (atan2(y, x) + acos(x / sqrt(x**2 + y**2)), (y < 0,)),
    (atan2(y, x) - acos(x / sqrt(x**2 + y**2)), (y >= 0,)),
    (Piecewise((1 / x, y > 0), (0, True)), (Eq(x, 0),)),
    (x + 2 * y, (Eq(x, -2 * y),)),
]


@pytest.mark.parametrize(("expr", "conditions"), NOT_ZERO, ids=str)
def test_what_is_not_zero_everywhere_is_not_proved(expr, conditions):
    assert vanishes(expr, Domain(conditions), budget=3.0).status is not Status.HOLDS


@pytest.mark.parametrize(("expr", "conditions"), ZERO, ids=str)
def test_what_is_zero_everywhere_is_proved(expr, conditions):
    assert vanishes(expr, Domain(conditions)).status is Status.HOLDS
