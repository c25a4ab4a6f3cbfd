"""Where a contact is lost, said by an angle, a square, a modulus or an inverse function: the same places or not."""

import math

import pytest
import sympy as sp

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import Claim
from canon.mechanics.algebra.solve_for_symbol import real_solutions
from canon.proof.domain.domain import Domain

SPHERE = {
    "q": ["r", "th"],
    "parameters": {"m": "positive", "g": "positive", "R": "positive", "v": "positive"},
    "L": "m*(r_dot**2 + r**2*th_dot**2)/2 - m*g*r*cos(th)",
    "contact": "r - R",
    "integrals": ["m*r**2*th_dot**2/2 + m*g*r*cos(th) = m*g*R"],
}
FROM_THE_TOP = {**SPHERE, "domain": ["0 < th", "th < pi/2"]}
PUSHED = {**FROM_THE_TOP, "integrals": ["m*r**2*th_dot**2/2 + m*g*r*cos(th) = m*g*R + m*v**2/2"]}
SLOPE = {
    **SPHERE,
    "L": "m*(r_dot**2 + r**2*th_dot**2)/2 + m*g*r*(cos(th) + sin(th))",
    "contact": "R - r",
    "integrals": ["m*r**2*th_dot**2/2 - m*g*r*(cos(th) + sin(th)) = m*g*R"],
    "domain": ["0 < th", "th < 2*pi"],
}


def told(keys, leaves):
    return judge(Claim("a", "leaving-condition", {**keys, "leaves": leaves}))


@pytest.mark.parametrize(
    ("keys", "right", "wrong"),
    [
        (FROM_THE_TOP, "th = acos(2/3)", "th = acos(1/3)"),
        (SPHERE, "th = acos(2/3)", "th = acos(1/3)"),  # the other side and whole turns are meant too
        (SPHERE, "th = 2*pi - acos(2/3)", "th = pi - acos(2/3)"),
        (FROM_THE_TOP, "th = asin(sqrt(5)/3)", "th = asin(2/3)"),
        (FROM_THE_TOP, "th = atan(sqrt(5)/2)", "th = atan(sqrt(5)/3)"),
        (FROM_THE_TOP, "th = 2*asin(1/sqrt(6))", "th = asin(1/sqrt(6))"),
        (FROM_THE_TOP, "sin(th)**2 = 5/9", "sin(th)**2 = 4/9"),
        (FROM_THE_TOP, "Abs(cos(th)) = 2/3", "Abs(sin(th)) = 2/3"),
        (FROM_THE_TOP, "th**2 = acos(2/3)**2", "th**2 = acos(2/3)"),
        (FROM_THE_TOP, "1 - 2*sin(th/2)**2 = 2/3", "1 - 2*sin(th/2)**2 = 1/3"),
        (SPHERE, "cos(th) = 2/3", "cos(th)**2 = 4/9"),
        (SPHERE, "tan(th/2)**2 = 1/5", "tan(th)**2 = 5/4"),
        (PUSHED, "cos(th) = 2/3 + v**2/(3*g*R)", "cos(th) = 2/3 - v**2/(3*g*R)"),
        (PUSHED, "th = acos(2/3 + v**2/(3*g*R))", "th = asin(2/3 + v**2/(3*g*R))"),
        (PUSHED, "v = sqrt(g*R*(3*cos(th) - 2))", "v = sqrt(g*R*(3*cos(th) - 1))"),
        (SLOPE, "sqrt(2)*cos(th - pi/4) = -2/3", "sqrt(2)*cos(th + pi/4) = -2/3"),
        (SLOPE, "(th - 5*pi/4)**2 = acos(sqrt(2)/3)**2", "(th - 5*pi/4)**2 = acos(sqrt(2)/4)**2"),
    ],
)
def test_the_same_places_in_another_form(keys, right, wrong):
    assert told(keys, right).holds
    assert told(keys, wrong).fails


@pytest.mark.parametrize(
    ("keys", "leaves", "sentence"),
    [
        (FROM_THE_TOP, "th = acos(1/3)", "there the reaction does not vanish, as at th = acos(1/3)"),
        (FROM_THE_TOP, "(th - acos(2/3))*(th - 1) = 0", "there the reaction does not vanish, as at th = 1"),
        (
            SPHERE,
            "(th - acos(2/3))**2 = 0",
            "the reaction vanishes elsewhere too, as at th = 2*pi*n + acos(2/3)",
        ),
        (SLOPE, "th = 5*pi/4 + acos(sqrt(2)/3)", "the reaction vanishes elsewhere too"),
    ],
)
def test_zeros_at_a_part_of_the_places_fail(keys, leaves, sentence):
    verdict = told(keys, leaves)
    assert verdict.fails
    assert verdict.feedback.startswith(sentence)


x, a = sp.symbols("x a", real=True)


@pytest.mark.parametrize(
    "equation",
    [
        3 * sp.cos(x) - 2,
        2 * sp.sin(2 * x) ** 2 - 1,
        3 * sp.sin(x) + 4 * sp.cos(x) - 5,
        sp.sin(x) + sp.cos(x) + 1,
        sp.tan(x / 2) - 3,
        sp.Abs(sp.sin(x)) - sp.Rational(1, 3),
        sp.exp(2 * x) - 5 * sp.exp(x) + 6,
        sp.acos(x / 5) - 1,
        sp.log(x**2) - 1,
        sp.sin(x) ** 2 - sp.cos(x),
        sp.asin(x / 9) - 2,
    ],
)
def test_solutions_are_those_that_a_search_finds(equation):
    """Every change of sign on a fine grid is at a solution, and every solution is a zero."""
    low, high = sp.Rational(-7), sp.Rational(7)
    roots = [
        float(sp.re(sp.N(root.value)))
        for root in real_solutions(equation, x, Domain((x > low, x < high)))
        if all(sp.N(c) >= 0 for c in root.conditions)
    ]
    assert all(abs(sp.N(equation.subs(x, root))) < 1e-9 for root in roots)
    f = sp.lambdify(x, equation, "mpmath")
    grid = [-7 + 14 * (k + 0.37) / 4000 for k in range(4000)]
    values = [complex(f(g)) for g in grid]
    for (g, u), (h, v) in zip(
        zip(grid, values, strict=True), zip(grid[1:], values[1:], strict=False), strict=False
    ):
        crosses = u.imag == v.imag == 0 and u.real * v.real < 0 and abs(u.real - v.real) < 1
        if crosses:
            assert any(g - 1e-9 <= root <= h + 1e-9 for root in roots), (g, h)


def test_what_has_no_closed_form_is_not_solved():
    assert real_solutions(sp.cos(x) - x, x, Domain()) is None
    assert real_solutions(sp.sin(x) + sp.sin(sp.sqrt(2) * x), x, Domain()) is None
    assert real_solutions(a * (sp.cos(x) - 1), x, Domain()) is None  # where a = 0 every x would do


def test_half_angles_come_back_after_whole_turns():
    x = sp.Symbol("x", real=True)
    found = real_solutions(sp.sin(x) + 2 * sp.cos(x) - 1, x, Domain(()))
    values = [
        root.value.subs(dict.fromkeys(root.value.free_symbols, k)) for root in found for k in (-1, 0, 2)
    ]
    assert len({sp.N(value) for value in values}) == 6
    assert all(abs(sp.N(sp.sin(value) + 2 * sp.cos(value) - 1)) < 1e-12 for value in values)


def test_an_even_power_of_the_sine_is_one_of_the_cosine() -> None:
    """cos² x − 3 cos x − 2 = 0 gives (3 − √17)/2; of half the angle the tangent solves t⁴ − 3t² − 2 = 0."""
    found = real_solutions(sp.sin(x) ** 2 + 3 * sp.cos(x) + 1, x, Domain((x > 0, x < 2 * sp.pi)))
    angle = math.acos((3 - math.sqrt(17)) / 2)
    values = sorted(float(root.value) for root in found if root.value.is_real)
    assert values == pytest.approx([angle, 2 * math.pi - angle], abs=1e-12)


@pytest.mark.parametrize(("divisor", "status"), [
    ("th - acos(2/3)", "undecided"),  # at the very place
    ("th - 2*pi - acos(2/3)", "undecided"),
    ("th**2 - acos(2/3)**2", "undecided"),
    ("3*cos(th) - 2", "fails"),  # at all of them
    ("th - acos(1/3)", "holds"),
    ("th", "holds"),
])  # fmt: skip
def test_an_equation_without_a_value_at_a_place_of_leaving_is_not_accepted(divisor, status):
    above = "(3*cos(th) - 2)**2" if status == "fails" else "(3*cos(th) - 2)"
    assert told(SPHERE, f"{above}/({divisor}) = 0").status.value == status
