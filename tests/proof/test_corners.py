"""Claims that are false in a corner of the domain only, 10⁻² … 10⁻¹¹ wide; without the corner they are true."""

from itertools import pairwise

import pytest
from sympy import (
    Abs,
    Integer,
    Max,
    Min,
    Piecewise,
    Rational,
    acos,
    acosh,
    asin,
    atan,
    atan2,
    cos,
    cosh,
    exp,
    log,
    pi,
    sin,
    sqrt,
    symbols,
    tan,
)

from canon import Domain, equal, judge
from canon.exercise import Claim
from canon.proof.refute.corners import corner_points, places_of_change
from canon.proof.trees.anatomy import anatomy

x, y, p = symbols("x y p", real=True)
u, v = symbols("u v", positive=True)

CORNERS = {
    "closed end": lambda w: (Max(0, x - 1 + w), 0, [x >= 0, x <= 1]),
    "open end": lambda w: (Max(0, x - 1 + w), 0, [x >= 0, x < 1]),
    "sign of a symbol": lambda w: (Abs(u - w), u - w, []),
    "two kinks": lambda w: (Abs(x) * Abs(x - w), x**2 - w * x, []),
    "root of a square": lambda w: (sqrt(u**2 - 2 * w * u + w**2), u - w, []),
    "arc of a sine": lambda w: (asin(sin(x)), x, [x > -pi / 2, x < pi / 2 + w]),
    "arc of a cosine": lambda w: (acos(cos(x)), x, [x > 0, x < pi + w]),
    "arc of a cosine, low": lambda w: (acos(cos(x)), x, [x > -w, x < pi]),
    "arc of a tangent": lambda w: (atan(tan(x)), x, [x > -pi / 2, x < pi / 2 + w]),
    "doubled arc": lambda w: (
        asin(2 * x * sqrt(1 - x**2)),
        2 * asin(x),
        [x > 0, x < sqrt(2) / 2 + w],
    ),
    "gap between pieces": lambda w: (Piecewise((1, p**2 < 2), (1, p**2 > 2 + w), (0, True)), 1, [p > 0]),
    "irrational end": lambda w: (Max(0, p**2 - 2), p**2 - 2, [p > sqrt(2) - w]),
    "irrational kink": lambda w: (Abs(p**2 - 2), p**2 - 2, [p > sqrt(2) - w]),
    "transcendental kink": lambda w: (Abs(exp(x) - 2), exp(x) - 2, [x > log(2) - w]),
    "zero of a sine": lambda w: (Abs(sin(x)), sin(x), [x > -w, x < 1]),
    "next zero of a sine": lambda w: (sqrt(1 - cos(x) ** 2), sin(x), [x > 0, x < pi + w]),
    "zero of a cosine": lambda w: (sqrt(cos(x) ** 2), cos(x), [x > 0, x < pi / 2 + w]),
    "zero of a symbol": lambda w: (Abs(x), x, [x > -w]),
    "logarithm": lambda w: (log(x**2), 2 * log(x), [x > -w]),
    "pole": lambda w: (atan(x) + atan(1 / x), pi / 2, [x > -w]),
    "root of a pole": lambda w: (sqrt(1 / x), 1 / sqrt(x), [x > -w]),
    "area": lambda w: (acosh(cosh(x)), x, [x > -w]),
    "less of two": lambda w: (Min(x, w), w, [x > w / 2]),
    "edge of a triangle": lambda w: (Max(0, x + y - 1 + w), 0, [x >= 0, y >= 0, x + y < 1]),
    "corner of a square": lambda w: (Max(0, x + y - 2 + w), 0, [x < 1, y < 1]),
    "corner, three arguments": lambda w: (Max(x, y, x + y - 1 + w), Max(x, y), [x < 1, y < 1]),
    "diagonal": lambda w: (Abs(x - y), x - y, [x - y > -w]),
    "strip along a diagonal": lambda w: (sqrt((x - y - w) ** 2), x - y - w, [x > y]),
    "arc of a sine of two": lambda w: (asin(sin(x + y)), x + y, [x + y > -pi / 2, x + y < pi / 2 + w]),
    "angle in the plane": lambda w: (atan2(y, x), atan(y / x), [x > -w]),
    "root of a product": lambda w: (sqrt(x * y), sqrt(x) * sqrt(y), [x > -w, y > -w]),
    "logarithm of a product": lambda w: (log(x * y), log(x) + log(y), [x > -w, y > -w]),
    "hyperbola": lambda w: (Max(0, x * y - 1 + w), 0, [x > 0, y > 0, x * y < 1]),
    "circle": lambda w: (Abs(x**2 + y**2 - 1), 1 - x**2 - y**2, [x**2 + y**2 < 1 + w]),
}
WIDTHS = [Rational(1, 10**k) for k in (2, 6, 9)]


def decided(corner, width):
    left, right, conditions = CORNERS[corner](width)
    return equal(left, Integer(right) if isinstance(right, int) else right, Domain(tuple(conditions)))


@pytest.mark.parametrize("width", WIDTHS, ids=str)
@pytest.mark.parametrize("corner", CORNERS)
def test_what_is_false_in_a_corner_fails(corner, width):
    verdict = decided(corner, width)
    assert verdict.fails
    left, right, conditions = CORNERS[corner](width)
    names = {s.name: s for s in (x, y, p, u, v)}
    point = {names[name]: Rational(value) for name, value in verdict.counterexample.point.items()}
    assert all(bool(condition.subs(point)) for condition in conditions)
    assert abs((left - right).subs(point).evalf(60)) > Rational(1, 10**50)


@pytest.mark.parametrize("corner", CORNERS)
def test_what_is_true_without_the_corner_does_not_fail(corner):
    verdict = decided(corner, Integer(0))
    assert not verdict.fails


@pytest.mark.parametrize("k", [3, 5, 7, 11])
def test_widths_between(k):
    assert decided("open end", Rational(3, 10**k)).fails
    assert decided("corner of a square", Rational(7, 10**k)).fails
    assert decided("irrational kink", Rational(2, 10**k)).fails


ACOT = [
    ("acot(x) + acot(-x)", "0", "Ne(x, 0)"),
    ("acot(x)", "-acot(-x)", "x > 0"),
    ("acot(x - y) + acot(y - x)", "0", "x > y"),
    ("acot(1 - exp(x)) + acot(exp(x) - 1)", "0", "x < 0"),
    ("$\\operatorname{arccot}(-x)$", "-acot(x)", "x < 0"),
    ("acot(-x*y)", "-acot(x*y)", "x*y > 0"),
]


@pytest.mark.parametrize(("left", "right", "where"), ACOT, ids=[a[0] for a in ACOT])
def test_acot_is_not_odd_at_zero(left, right, where):
    keys = {"lhs": left, "rhs": right, "parameters": {"x": "real", "y": "real"}}
    everywhere = judge(Claim("a", "equality-only", keys))
    assert everywhere.fails
    assert "1.57079632679490" in str(everywhere) or "3.14159265358979" in str(everywhere)
    assert judge(Claim("a", "equality-only", {**keys, "domain": [where]})).holds


def test_places_where_formulas_change():
    sides = anatomy([asin(x) + sqrt(x - 2) / (x - 3) + Max(x, 5) + atan2(x - 7, y)])
    places = {(g if g.coeff(x) == 1 else -g) for g in places_of_change(sides, Domain((x < 9,)))}
    assert places >= {x - k for k in (1, -1, 2, 3, 5, 7, 9)}


def test_points_lie_in_the_domain_and_between_all_places():
    domain = Domain((x > 0, x < 1))
    points = [point[x] for point in corner_points(anatomy([Abs(3 * x - 1) + Abs(3 * x**2 - 1)]), domain)]
    assert all(0 < place < 1 for place in points)
    bounds = [0, Rational(1, 3), 1 / sqrt(3), 1]
    assert all(any(low < place < high for place in points) for low, high in pairwise(bounds))
    assert min(points) < Rational(1, 10**20)
