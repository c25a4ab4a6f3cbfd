"""Domains that random points miss, and conditions on arbitrary functions: still proved, still refuted."""

import time

import pytest
from sympy import (
    Abs,
    Derivative,
    Function,
    Max,
    Ne,
    Rational,
    acos,
    asin,
    cos,
    exp,
    log,
    pi,
    sin,
    sqrt,
    symbols,
    sympify,
)

from canon.proof.domain.domain import Domain
from canon.proof.vanish import equal, vanishes

x, y, z = symbols("x y z", real=True)
a = symbols("a", positive=True)
f = Function("f", real=True)
g = Function("g")

SLIVER = Domain((Abs(x - 7) < Rational(1, 1000),))
CORNER = Domain((x + y + z > 30, x < 11, y < 11, z < 11))
NEAR_THE_CREST = Domain((sin(x) > Rational(999, 1000), cos(x) > 0))


@pytest.mark.parametrize(
    ("domain", "left", "right", "wrong"),
    [
        (SLIVER, asin(sin(x)), x - 2 * pi, pi - x),
        (SLIVER, Abs(sin(x)), sin(x), -sin(x)),
        (Domain((x > 100, x < Rational(201, 2))), acos(cos(x)), 32 * pi - x, x - 32 * pi),
        (CORNER, Abs(x + y + z - 30), x + y + z - 30, x + y + z - 29),
        (CORNER, Max(x + y + z, 29), x + y + z, x + y + z + 1),
        (NEAR_THE_CREST, sqrt(1 - sin(x) ** 2), cos(x), -cos(x)),
        (Domain((a > 1000, a < 1001)), Abs(a - 1000), a - 1000, 1001 - a),
        (Domain((exp(x) > 10**6, x < 14)), log(exp(x)), x, x + Rational(1, 10**9)),
    ],
)
def test_what_holds_in_a_corner_of_space(domain, left, right, wrong):
    assert equal(left, right, domain).holds
    refuted = equal(left, wrong, domain)
    assert refuted.fails
    point = refuted.counterexample.point
    values = {s: Rational(point[s.name]) for s in (x, y, z, a) if s.name in point}
    assert domain.contains(values)


def test_thin_domains_are_found_though_no_random_point_lies_in_them():
    ball = Domain((x**2 + y**2 + z**2 < Rational(1, 10**6), z > 0))
    lens = Domain((x**2 + y**2 < 1, x * y > Rational(49, 100)))
    for domain in (ball, lens, SLIVER, CORNER, NEAR_THE_CREST):
        points = list(domain.points([x, y, z], 3))
        assert len(points) == 3
        assert all(domain.contains(point) for point in points)
    assert list(Domain((x > 2, x < 1)).points([x], 3)) == []
    assert list(Domain((x**2 + y**2 < 0,)).points([x], 3)) == []


def test_a_condition_on_a_function_chooses_the_function():
    positive, negative = Domain((f(x) > 0,)), Domain((f(x) < 0,))
    assert equal(sqrt(f(x) ** 2), f(x), positive).holds
    assert equal(sqrt(f(x) ** 2), f(x), negative).fails
    assert equal(sqrt(f(x) ** 2), -f(x), negative).holds
    assert equal(sqrt(f(x) ** 2), -f(x), positive).fails


def test_a_condition_on_a_derivative_makes_a_pivot_regular():
    rising = Domain((Derivative(g(x), x) > 0,))
    assert vanishes(Derivative(g(x), x), rising).fails
    assert vanishes(Derivative(g(x), x) - Derivative(g(x), x), rising).holds
    refuted = equal(g(x) * Derivative(g(x), x), g(x), Domain((Ne(g(x), 0),)))
    assert refuted.fails
    example, place = refuted.counterexample.point["g(x)"], Rational(refuted.counterexample.point["x"])
    assert sympify(example).subs(symbols("x"), place) != 0


def test_conditions_that_no_function_satisfies_refute_nothing():
    nowhere = Domain((f(x) ** 2 < 0,))
    verdict = equal(f(x), f(x) + 1, nowhere, budget=1.0)
    assert not verdict.fails


def test_looking_for_a_thin_domain_keeps_to_its_deadline():
    wild = sum((sin(exp(x) * i) - i) ** 2 for i in range(1, 30)) < Rational(1, 100)
    start = time.process_time()
    assert list(Domain((wild,)).points([x], 60, deadline=time.monotonic() + 0.3)) == []
    assert time.process_time() - start < 2.0
