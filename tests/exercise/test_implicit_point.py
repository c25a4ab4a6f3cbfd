"""Implicit maps that can't be solved: the false ones are refuted at a point, the true ones never."""

from fractions import Fraction

import mpmath
import pytest
import sympy as sp

from canon.exercise.claim_verdict import judge
from canon.exercise.question.implicit_point import PRECISION, enclosed
from canon.exercise.sheet.sheet import Claim
from canon.proof.domain.balls import precision

KEYS = {
    "q": ["q"],
    "p": ["p"],
    "new_q": ["Q"],
    "new_p": ["P"],
    "box": {"h": [-0.2, 0.2], "w": [0.3, 1.5], "q": [-2, 2], "p": [-2, 2]},
    "parameters": {"h": "real", "w": "positive"},
}
TRAPEZOIDAL = ["Q - q - h*(P + p)/2", "P - p + h*w**2*(sin(Q) + sin(q))/2"]
MIDPOINT = ["Q - q - h*(P + p)/2", "P - p + h*w**2*sin((Q + q)/2)"]


def judged(equations, **keys):
    return judge(Claim("i", "canonicity", {**KEYS, "implicit": equations, **keys}))


def test_the_trapezoidal_rule_is_refuted_where_an_independent_route_refutes_it_too():
    verdict = judged(TRAPEZOIDAL)
    assert verdict.fails
    assert verdict.certificate == "ball"
    point = {name: text.rstrip("…") for name, text in verdict.counterexample.point.items()}
    h, w, q, p = (float(Fraction(point[name])) for name in "hwqp")
    with mpmath.workdps(40):

        def step(q0, p0):
            def gap(Q, P):
                force = w**2 * (mpmath.sin(Q) + mpmath.sin(q0)) / 2
                return Q - q0 - h * (P + p0) / 2, P - p0 + h * force

            return mpmath.findroot(gap, (q0, p0))

        e = mpmath.mpf(10) ** -12
        columns = [
            (step(*plus) - step(*minus)) / (2 * e)
            for plus, minus in (((q + e, p), (q - e, p)), ((q, p + e), (q, p - e)))
        ]
        determinant = columns[0][0] * columns[1][1] - columns[0][1] * columns[1][0]
        assert abs(determinant - 1) > 1e-9
        assert abs(step(q, p)[0] - mpmath.mpf(point["Q"])) < 1e-12
        assert abs(step(q, p)[1] - mpmath.mpf(point["P"])) < 1e-12


def test_the_implicit_midpoint_rule_is_not_refuted():
    assert judged(MIDPOINT).holds


@pytest.mark.parametrize(
    ("equations", "fails"),
    [
        (["Q - q - h*P", "P - p + h*sin(q + h*P)"], True),
        (["Q - q - h*sin(q)*exp(P)", "P - p + h*cos(q)*exp(P)"], False),
        (["Q - q - h*sin(P)", "P - p + h*(sin(Q) + Q**5)"], True),
        (["Q - q - h*sin(P) - h*sin(p)", "P - p + h*sin(Q + q)"], True),
        (["Q - q - h*cos((P + p)/2)", "P - p + h*sin((Q + q)/2)*exp((Q + q)/2)"], False),
    ],
)
def test_false_maps_fail_and_true_ones_do_not(equations, fails):
    verdict = judged(equations)
    assert verdict.fails is fails
    assert not (verdict.undecided and fails)


def test_a_domain_without_the_solution_refutes_nothing():
    """The new coordinate is assumed negative and lies near a positive old one."""
    signs = {"h": "real", "w": "positive", "q": "positive", "Q": "negative"}
    verdict = judged(TRAPEZOIDAL, parameters=signs, box={**KEYS["box"], "q": [1, 2]})
    assert not verdict.fails


def test_no_box_around_a_double_root_or_a_jump():
    x = sp.Symbol("x", real=True)
    with precision(PRECISION):
        assert enclosed([x**2], [x], {}, [sp.Integer(1)]) is None
        assert enclosed([x + sp.Piecewise((1, x > 0), (-1, True))], [x], {}, [sp.Rational(1, 7)]) is None
        (root,) = enclosed([x**3 - 2], [x], {}, [sp.Integer(1)])
        assert (root**3).contains(2)
        assert root.rad() < 1e-25


WITHOUT_SOLUTION = [
    ["Abs(Q - q) = -1", "Abs(P - p) = -1"],
    ["Q = q", "Abs(P - p) = -1"],
    ["(Q - q)**2 = -1", "P = p"],
    ["exp(Q - q) = -1", "P = p"],
    ["cosh(Q - q) = 0", "P = p"],
    ["Max(Q - q, 0) = -1", "P = p"],
]


@pytest.mark.parametrize("equations", WITHOUT_SOLUTION)
def test_equations_without_a_solution_define_no_map(equations):
    verdict = judged(equations)
    assert verdict.fails
    assert "no real solution" in verdict.feedback


@pytest.mark.parametrize("first", ["sqrt(Q - q) = -1", "sin(Q - q) = 2", "Q = q + I", "Abs(Q - q)**4 = 0"])
def test_equations_of_which_no_solution_is_found_are_no_ground_to_hold(first):
    assert not judged([first, "P = p"]).holds


@pytest.mark.parametrize(
    "first", ["Q = q", "Q = q + 1", "exp(Q) = exp(q)", "Q + Q**3 = q + q**3 + Q**3 - q**3"]
)
def test_equations_with_a_solution_still_define_one(first):
    assert judged([first, "P = p"]).holds


def test_arbitrary_functions_stand_in_equations_too():
    step = ["Q = q + h*P", "P = p - h*Derivative(V(q), q)"]
    assert judged(step, functions={"V": ["q"]}).holds
    assert not judged(["Q = q", "P = p + sqrt(-1 - V(q)**2)"], functions={"V": ["q"]}).holds
