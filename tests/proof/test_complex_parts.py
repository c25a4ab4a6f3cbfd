"""Arguments, signs and conjugates of complex expressions, and arcs of half angles."""

import pytest
from sympy import (
    Abs,
    I,
    Integer,
    Ne,
    acos,
    acosh,
    acot,
    acsc,
    acsch,
    arg,
    asec,
    asech,
    asin,
    asinh,
    atan,
    atan2,
    conjugate,
    cos,
    cosh,
    diff,
    exp,
    im,
    log,
    pi,
    re,
    sign,
    sin,
    sinh,
    sqrt,
    symbols,
    tan,
)

from canon.proof import Domain, equal

x, y, z, a, b = symbols("x y z a b", real=True)
p, q = symbols("p q", positive=True)
u = symbols("u", complex=True)

TRUE = [
    (
        asin(x),
        2 * atan(x / (1 + sqrt(1 - x**2))),
        Domain(
            (
                x > -1,
                x < 1,
            )
        ),
        2 * atan(x / (1 - sqrt(1 - x**2))),
    ),
    (
        asin(x),
        2 * atan(x / (1 + sqrt(1 - x**2))),
        Domain(
            (
                x >= -1,
                x <= 1,
            )
        ),
        2 * atan(x / (2 + sqrt(1 - x**2))),
    ),
    (asin(x), 2 * atan(x / (1 + sqrt(1 - x**2))), Domain(), 2 * atan(x / (2 + sqrt(1 - x**2)))),
    (
        acos(x),
        2 * atan(sqrt((1 - x) / (1 + x))),
        Domain(
            (
                x > -1,
                x <= 1,
            )
        ),
        2 * atan(sqrt((1 + x) / (1 - x))),
    ),
    (
        acos(x),
        2 * atan(sqrt((1 - x) / (1 + x))),
        Domain(
            (
                x > -1,
                x < 1,
            )
        ),
        2 * atan(sqrt((1 + x) / (1 - x))),
    ),
    (
        asin(x),
        2 * acot((1 + sqrt(1 - x**2)) / x),
        Domain(
            (
                x > 0,
                x < 1,
            )
        ),
        acot((1 + sqrt(1 - x**2)) / x),
    ),
    (
        asin(x),
        2 * acot((1 + sqrt(1 - x**2)) / x),
        Domain(
            (
                x > -1,
                x < 1,
            )
        ),
        2 * acot((2 + sqrt(1 - x**2)) / x),
    ),
    (
        acos(x),
        2 * acot(sqrt((1 + x) / (1 - x))),
        Domain(
            (
                x > -1,
                x < 1,
            )
        ),
        2 * atan(sqrt((1 + x) / (1 - x))),
    ),
    (
        atan2(sin(x), cos(x)),
        x,
        Domain(
            (
                -pi < x,
                x < pi,
            )
        ),
        -x,
    ),
    (
        atan2(sin(2 * x), cos(2 * x)),
        2 * x,
        Domain(
            (
                -pi / 2 < x,
                x <= pi / 2,
            )
        ),
        x,
    ),
    (arg(x + I * y), atan2(y, x), Domain(), atan2(x, y)),
    (arg(x + I * y), atan(y / x), Domain((x > 0,)), -atan(y / x)),
    (
        arg(p * exp(I * x)),
        x,
        Domain(
            (
                -pi < x,
                x < pi,
            )
        ),
        -x,
    ),
    (sign(2 + 2 * I), (1 + I) / sqrt(2), Domain(), 1 + I),
    (sign(x + I * y), (x + I * y) / sqrt(x**2 + y**2), Domain((x > 0,)), x / sqrt(x**2 + y**2)),
    (
        acos(x),
        2 * asin(sqrt((1 - x) / 2)),
        Domain(
            (
                x >= -1,
                x <= 1,
            )
        ),
        2 * asin(sqrt((1 + x) / 2)),
    ),
    (
        acos(x),
        2 * acos(sqrt((1 + x) / 2)),
        Domain(
            (
                x >= -1,
                x <= 1,
            )
        ),
        acos(sqrt((1 + x) / 2)),
    ),
    (
        asin(x),
        pi / 2 - 2 * atan(sqrt((1 - x) / (1 + x))),
        Domain(
            (
                x > -1,
                x < 1,
            )
        ),
        2 * atan(sqrt((1 - x) / (1 + x))),
    ),
    (atan2(y, x), 2 * atan(y / (x + sqrt(x**2 + y**2))), Domain((x > 0,)), atan(y / (x + sqrt(x**2 + y**2)))),
    (
        atan2(y, x),
        2 * atan(y / (x + sqrt(x**2 + y**2))),
        Domain((Ne(y, 0),)),
        atan(y / (x + sqrt(x**2 + y**2))),
    ),
    (acot((1 + sqrt(1 + x**2)) / x) * 2, atan(x), Domain((x > 0,)), -atan(x)),
    (
        2 * atan((1 - cos(x)) / sin(x)),
        x,
        Domain(
            (
                -pi < x,
                x < pi,
            )
        ),
        -x,
    ),
    (
        2 * atan(sin(x) / (1 + cos(x))),
        x,
        Domain(
            (
                -pi < x,
                x < pi,
            )
        ),
        x / 2,
    ),
    (
        2 * atan(tan(x / 2)),
        x,
        Domain(
            (
                -pi < x,
                x < pi,
            )
        ),
        x / 2,
    ),
    (
        acos(cos(x)),
        x,
        Domain(
            (
                x >= 0,
                x <= pi,
            )
        ),
        -x,
    ),
    (
        asin(sin(x)),
        pi - x,
        Domain(
            (
                pi / 2 <= x,
                x <= 3 * pi / 2,
            )
        ),
        x,
    ),
    (
        atan2(p * sin(x), p * cos(x)),
        x,
        Domain(
            (
                -pi < x,
                x < pi,
            )
        ),
        -x,
    ),
    (arg(-x), pi, Domain((x > 0,)), Integer(0)),
    (arg(-1 - x**2), pi, Domain(), Integer(0)),
    (
        arg(exp(I * x)),
        x,
        Domain(
            (
                -pi < x,
                x <= pi,
            )
        ),
        -x,
    ),
    (re(log(x + I * y)), log(x**2 + y**2) / 2, Domain((x > 0,)), log(x**2 + y**2)),
    (im(log(x + I * y)), arg(x + I * y), Domain(), -arg(x + I * y)),
    (
        log(x + I * y),
        log(x**2 + y**2) / 2 + I * atan2(y, x),
        Domain(),
        log(x**2 + y**2) / 2 - I * atan2(y, x),
    ),
    (sign(3 - 4 * I), (3 - 4 * I) / 5, Domain(), (3 + 4 * I) / 5),
    (sign(u) * Abs(u), u, Domain(), -u),
    (atan2(-y, x), -atan2(y, x), Domain((x > 0,)), atan2(y, x)),
    (
        asech(x),
        log(1 / x + sqrt(1 / x - 1) * sqrt(1 / x + 1)),
        Domain(),
        log(1 / x - sqrt(1 / x - 1) * sqrt(1 / x + 1)),
    ),
    (acsch(x), log(1 / x + sqrt(1 + 1 / x**2)), Domain(), log(1 / x - sqrt(1 + 1 / x**2))),
    (asech(u), acosh(1 / u), Domain(), asinh(1 / u)),
    (acsch(u), asinh(1 / u), Domain(), acosh(1 / u)),
    (asec(u), acos(1 / u), Domain(), asin(1 / u)),
    (acsc(u), asin(1 / u), Domain(), acos(1 / u)),
    (asec(x) + acsc(x), pi / 2, Domain(), pi),
    (asec(u) + acsc(u), pi / 2, Domain(), pi),
    (
        asech(x),
        log((1 + sqrt(1 - x**2)) / x),
        Domain(
            (
                x > 0,
                x < 1,
            )
        ),
        log((1 - sqrt(1 - x**2)) / x),
    ),
    (asech(x), I * asec(x), Domain((x > 1,)), -I * asec(x)),
    (asech(2), I * pi / 3, Domain(), I * pi / 4),
    (acsch(u), log(1 / u + sqrt(1 + 1 / u**2)), Domain(), log(1 / u - sqrt(1 + 1 / u**2))),
    (cosh(asech(u)), 1 / u, Domain(), u),
    (sinh(acsch(u)), 1 / u, Domain(), u),
    (acsch(-x), -acsch(x), Domain(), acsch(x)),
    (asec(-x), pi - asec(x), Domain(), asec(x)),
    (asec(x), -I * log(1 / x + I * sqrt(1 - 1 / x**2)), Domain(), I * log(1 / x + I * sqrt(1 - 1 / x**2))),
    (acsc(x), -I * log(I / x + sqrt(1 - 1 / x**2)), Domain(), I * log(I / x + sqrt(1 - 1 / x**2))),
    (asec(u), -I * log(1 / u + I * sqrt(1 - 1 / u**2)), Domain(), I * log(1 / u + I * sqrt(1 - 1 / u**2))),
    (
        diff(asech(x), x),
        -1 / (x * sqrt(1 - x**2)),
        Domain(
            (
                x > 0,
                x < 1,
            )
        ),
        1 / (x * sqrt(1 - x**2)),
    ),
    (diff(acsch(x), x), -1 / (x * sqrt(1 + x**2)), Domain((x > 0,)), 1 / (x * sqrt(1 + x**2))),
    (acsch(I * x), -I * acsc(x), Domain(), I * acsc(x)),
    (asech(u), log(1 / u + sqrt(1 / u - 1) * sqrt(1 / u + 1)), Domain(), log(1 / u + sqrt(1 / u**2 - 1))),
    (asech(-x), I * pi - asech(x), Domain((x > 1,)), asech(x)),
    (asinh(u), -I * asin(I * u), Domain(), I * asin(I * u)),
    (acos(u), -I * log(u + I * sqrt(1 - u**2)), Domain(), I * log(u + I * sqrt(1 - u**2))),
    (asin(u), -I * log(I * u + sqrt(1 - u**2)), Domain(), I * log(I * u + sqrt(1 - u**2))),
]


@pytest.mark.parametrize(("left", "right", "domain", "twin"), TRUE)
def test_identity_holds_and_its_twin_fails(left, right, domain, twin):
    assert equal(left, right, domain).holds
    assert equal(left, twin, domain).fails


def test_half_angle_from_the_cosine():
    half = 2 * atan(sqrt((1 - cos(x)) / (1 + cos(x))))
    assert equal(half, x, Domain((x >= 0, x < pi))).holds
    assert equal(half, -x, Domain((x > -pi, x <= 0))).holds
    assert equal(half, x, Domain((x > -pi, x < pi))).fails


def test_atan2_of_sine_and_cosine_is_the_angle_up_to_a_turn():
    assert equal(atan2(sin(x), cos(x)), x, Domain((x > -pi, x < 2 * pi))).fails
    assert equal(atan2(sin(x), cos(x)), x - 2 * pi, Domain((x > pi, x < 3 * pi))).holds
    assert equal(atan2(sin(x), cos(x)), x, Domain((x >= -pi, x <= pi))).fails is False
    assert not equal(atan2(sin(x), cos(x)), x, Domain((x >= -pi, x <= pi))).holds


def test_arguments_add_up_only_within_a_half_turn():
    assert equal(arg((p + I * q) * (p - I * q)), 0).holds
    assert equal(arg(x + I), pi / 2 - atan(x)).holds
    assert equal(arg((x + I) ** 2), 2 * arg(x + I)).fails
    assert equal(arg(-x), 0, Domain((x > 0,))).fails


def test_the_sign_of_a_complex_number_is_not_its_direction_at_zero():
    assert equal(sign(x + I * y), (x + I * y) / sqrt(x**2 + y**2)).holds
    assert equal(sign(u) ** 2, 1).fails
    assert equal(sign(u) * Abs(u), u).holds


@pytest.mark.parametrize(
    ("left", "right", "wrong"),
    [
        (conjugate(log(x)), log(x), -log(x)),
        (conjugate(sqrt(-x)), -sqrt(-x), sqrt(-x)),
        (conjugate(x + I * log(x)), x - I * log(x), x + I * log(x)),
        (arg(1 / (x + I * y)), -atan2(y, x), atan2(y, x)),
        (arg((x + I * y) ** 2 / (x - I * y)), arg((x + I * y) ** 3), arg((x - I * y) ** 3)),
    ],
    ids=str,
)
def test_conjugates_and_arguments_of_what_conditions_make_real_or_positive(left, right, wrong):
    positive = Domain((x > 0,))
    assert equal(left, right, positive).holds
    assert equal(left, wrong, positive).fails
    assert not equal(left, wrong).holds


@pytest.mark.parametrize("f", [re, im, conjugate, arg, sign, Abs], ids=lambda f: f.__name__)
def test_of_a_complex_number_written_in_two_ways_the_parts_are_equal(f):
    one = sin(x) ** 2 + cos(x) ** 2
    assert equal(f(u * (u + one)), f(u**2 + u)).holds
    assert not equal(f(u * (u + one)), f(u**2 - u)).holds


def test_logarithms_of_algebraic_numbers_that_are_no_roots_of_real_ones():
    assert equal(log(3 + 4 * I), 2 * log(2 + I)).holds
    assert equal(log(3 + 4 * I), 2 * log(2 - I)).fails
    assert equal(arg(-3 + 4 * I), 2 * arg(1 + 2 * I)).holds
    assert equal(arg(-3 - 4 * I), 2 * arg(-1 + 2 * I)).fails
    long = sqrt(2) + sqrt(3) + sqrt(5) + sqrt(7) + sqrt(11)
    assert equal(log(long**2), 2 * log(long)).holds
    assert equal(log(long**2), 2 * log(long - sqrt(11))).fails


def test_logarithms_of_numbers_that_depend_on_a_parity():
    n = symbols("n", integer=True)
    number = 2 + cos(pi * n)
    positive = Domain((number > 0, x > 0))
    assert equal(log(number**2), 2 * log(number), positive).holds
    assert equal(log(number**2), log(number), positive).fails
    assert equal(log(x * number), log(x) + log(number), positive).holds
    assert equal(log(x * number), log(x) - log(number), positive).fails
