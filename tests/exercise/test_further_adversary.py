"""The further kinds under attack: what was once held of a false claim, or denied of a true one, beside its opposite.

Every group has claims that canon judged wrongly, and neighbours that differ in what matters.
"""

import random

import mpmath as mp
import numpy as np
import pytest
import sympy as sp

from canon.exercise.judge import InvalidClaim, judge
from canon.exercise.sheet.sheet import Claim


def said(kind, **keys):
    """Return the verdict on a claim as a word; invalid where nothing can be judged."""
    try:
        return judge(Claim("a", kind, keys)).status.value
    except InvalidClaim:
        return "invalid"


def declared(text):
    return dict(pair.split(":") for pair in text.split())


# --- constraints ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("constraints", "word", "expected"),
    [
        (["x_dot = 0", "x_dot = 1"], "holonomic", "undecided"),  # they contradict each other
        (["x_dot = 0", "y_dot = 1"], "holonomic", "holds"),
        (["x = 0", "x = 1"], "holonomic", "invalid"),
        (["x = 0", "y = 1"], "holonomic", "holds"),
        (["x**2 + y**2 + 1"], "holonomic", "invalid"),  # no point
        (["x**2 + y**2 - 1"], "holonomic", "holds"),
        (["x = t", "x_dot = 0"], "rheonomic", "invalid"),
        # together they say w = 0, and x_dot = 0 then: holonomic, although dω does not vanish off w = 0
        (["x_dot - w*y_dot - w", "x_dot - w*y_dot"], "nonholonomic", "undecided"),
        (["x_dot - w*y_dot"], "nonholonomic", "holds"),
        # on x = 0 what is left is z_dot = y*w_dot: a basis that divides by x sees nothing
        (["x = 0", "x*y_dot + z_dot - y*w_dot"], "holonomic", "fails"),
        (["x = 0", "x*y_dot + z_dot - y*w_dot"], "nonholonomic", "holds"),
        (["x = 0", "x*y_dot + z_dot - z*w_dot"], "holonomic", "holds"),
        # the second edge never bears
        (["x >= 0", "x >= -1 - t**2"], "rheonomic", "undecided"),
        (["x >= 0", "x >= 1 + t**2"], "rheonomic", "holds"),
    ],
)
def test_classes_of_constraints(constraints, word, expected):
    assert (
        said("constraint-class", q=["x", "y", "z", "w"], constraints=constraints, **{"class": [word]})
        == expected
    )


@pytest.mark.parametrize(
    ("constraints", "dof", "expected"),
    [
        (["x_dot - y_dot", "x_dot - y_dot - z"], "2", "undecided"),  # z = 0 follows, and one freedom is left
        (["x_dot - y_dot", "2*x_dot - 2*y_dot"], "2", "holds"),
        (["x_dot", "x_dot - 1"], "2", "undecided"),
        (["Max(x, 0)*y_dot"], "2", "undecided"),
        (["x*y_dot"], "2", "holds"),
    ],
)
def test_numbers_of_freedoms(constraints, dof, expected):
    assert said("degrees-of-freedom", q=["x", "y", "z"], constraints=constraints, dof=dof) == expected


def test_ranks_of_random_constraints_against_numpy():
    chance = random.Random(11)
    for _ in range(6):
        n, m = 4, chance.randint(1, 4)
        rows = [[chance.randint(-2, 2) for _ in range(n)] for _ in range(m)]
        if chance.random() < 0.5 and m > 1:
            rows[-1] = [a + b for a, b in zip(rows[0], rows[-2], strict=True)]
        rows = [row for row in rows if any(row)]
        if not rows:
            continue
        texts = [" + ".join(f"({c})*x{j}_dot" for j, c in enumerate(row)) for row in rows]
        right = n - np.linalg.matrix_rank(np.array(rows))
        keys = {"q": [f"x{j}" for j in range(n)], "constraints": texts}
        for dof in (right, right + 1, right - 1):
            expected = "holds" if dof == right else "fails"
            assert said("degrees-of-freedom", **keys, dof=str(dof)) == expected
            assert said("degrees-of-freedom", **keys, dof=str(dof), counting="positions") == expected


# --- energies and forces --------------------------------------------------------------------------

TWO = {"q": ["x", "y"], "parameters": {"m": "positive"}, "bodies": [{"m": "m", "r": ["x"]}]}


@pytest.mark.parametrize(
    ("constraint", "expected"),
    [
        ("y*(x_dot - y_dot)", "undecided"),
        ("(1 + y**2)*(x_dot - y_dot)", "holds"),
        ("x_dot + y_dot - 1", "fails"),
    ],
)
def test_a_constraint_that_holds_for_all_velocities_somewhere(constraint, expected):
    assert said("kinetic-energy", **TWO, T="m*y_dot**2/2", constraints=[constraint]) == expected
    multiplier = {"L": "(x_dot**2 + y_dot**2)/2 - x", "multipliers": ["u"], "constraints": [constraint]}
    if expected == "undecided":
        assert said("reaction", q=["x", "y"], **multiplier, values={"u": "1/(2*y)"}) == "undecided"
        assert (
            said("reaction", q=["x", "y"], **multiplier, values={"u": "1/(2*y)"}, domain=["y != 0"])
            == "holds"
        )


@pytest.mark.parametrize(
    ("k", "expected"), [("real", "undecided"), ("nonzero", "holds"), ("positive", "holds")]
)
def test_a_factor_that_may_be_zero(k, expected):
    keys = {**TWO, "parameters": {"m": "positive", "k": k}}
    assert said("kinetic-energy", **keys, T="m*y_dot**2/2", constraints=["k*(x_dot - y_dot)"]) == expected


@pytest.mark.parametrize(("constraint", "expected"), [
    ("x**2*z = y**2", "undecided"),  # at x = y = 0 every z is allowed
    ("(1 + x**2)*z = y**2 + 1", "holds"),
    ("(1 + x**2)*z = -y**2 - 1", "fails"),
])  # fmt: skip
def test_points_that_a_graph_misses(constraint, expected):
    keys = {"q": ["x", "y", "z", "u"], "bodies": [{"m": "1", "r": ["u"]}]}
    assert said("kinetic-energy", **keys, T="u_dot**2*Abs(z)/z/2", constraints=[constraint]) == expected


@pytest.mark.parametrize(("constraints", "expected"), [
    (["x", "x - 1"], "invalid"),
    (["x**2 + 1"], "invalid"),
    (["x", "y - 1"], "holds"),
    (["x**2 - 1"], "holds"),
])  # fmt: skip
def test_the_rest_as_a_force_of_constraints_that_no_point_satisfies(constraints, expected):
    keys = {"q": ["x", "y"], "L": "(x_dot**2 + y_dot**2)/2", "multipliers": ["u", "v"][: len(constraints)]}
    assert said("reaction", **keys, constraints=constraints, force=["x_ddot", "y_ddot"]) == expected


@pytest.mark.parametrize(
    "body",
    [
        {"I": "1", "angle": "x", "r": ["x"]},  # r without m
        {"I": "1", "angle": "x", "m": "3"},  # m without r
        {"I": "1", "angle": "x", "omega": ["2*x_dot"]},
        {"m": "1", "r": ["exp(I*x)"]},
        {"m": "1", "r": ["x_dot"]},
        {"I": "1", "omega": ["x_ddot"]},
        {"m": "1", "r": ["x"], "angle": "x"},
    ],
)
def test_bodies_that_say_too_little_or_too_much_are_invalid(body):
    assert said("kinetic-energy", q=["x"], bodies=[body], T="x_dot**2/2") == "invalid"


def test_a_body_with_all_it_needs():
    body = {"m": "2", "r": ["x"], "I": "3", "angle": "x"}
    assert said("kinetic-energy", q=["x"], bodies=[body], T="5*x_dot**2/2") == "holds"
    assert said("kinetic-energy", q=["x"], bodies=[body], T="3*x_dot**2/2") == "fails"


def test_accelerations_are_not_passed_over():
    assert said("generalized-force", q=["x"], V="x_ddot**2", Q=["0"]) == "invalid"
    assert said("generalized-force", q=["x"], V="x_dot*t", Q=["1"]) == "holds"
    assert said("variation", q=["x"], L="x_ddot**2/2", boundary="0", integrand="0") == "invalid"
    assert said("variation", q=["x"], L="x_dot*x", boundary="x*delta_x", integrand="0") == "holds"
    assert said("invariance", of="lagrange-equations", q=["q"], Q=["q + q_ddot"]) == "fails"
    assert said("invariance", of="lagrange-equations", q=["q"], Q=["q + q**3"]) == "holds"
    keys = {"of": "poisson-brackets", "q": ["q"], "p": ["p"], "P": ["p"]}
    assert said("invariance", **keys, Q=["q + q_dot"]) == "invalid"
    assert said("invariance", **keys, Q=["q + p"]) == "holds"


def test_a_map_with_pieces_is_not_called_regular():
    keys = {"of": "lagrange-equations", "q": ["q"]}
    assert said("invariance", **keys, Q=["Max(q, 0)"]) == "undecided"
    assert said("invariance", **keys, Q=["q**3 + q"]) == "holds"
    assert said("invariance", **keys, Q=["Max(q, 0) - Max(q, 0)"]) == "fails"


# --- reactions ------------------------------------------------------------------------------------

SPHERE = {
    "q": ["r", "theta"],
    "L": "m*(r_dot**2 + r**2*theta_dot**2)/2 - m*g*r*cos(theta)",
    "parameters": {"m": "positive", "g": "positive", "a": "positive"},
}


@pytest.mark.parametrize(("energy", "value", "expected"), [
    ("-5", "m*g*(3*cos(theta) + 10)", "invalid"),  # less than the least energy: no motion is meant
    ("5", "m*g*(3*cos(theta) - 10)", "holds"),
    ("5", "m*g*(3*cos(theta) + 10)", "fails"),
])  # fmt: skip
def test_energies_that_no_motion_has(energy, value, expected):
    integral = f"m*a**2*theta_dot**2/2 + m*g*a*cos(theta) = {energy}*m*g*a"
    keys = {**SPHERE, "constraints": ["r - a"], "multipliers": ["N"], "integrals": [integral]}
    assert said("reaction", **keys, values={"N": value}) == expected


@pytest.mark.parametrize(("leaves", "expected"), [
    ("1 = 0", "invalid"),
    ("m*g = 0", "invalid"),
    ("sin(theta)**2 + cos(theta)**2 = 1", "fails"),
    ("a*theta_dot**2 = g*cos(theta)", "holds"),
    ("a*theta_dot**2 = -g*cos(theta)", "fails"),
])  # fmt: skip
def test_conditions_that_hold_nowhere_or_everywhere_say_nothing(leaves, expected):
    assert said("leaving-condition", **SPHERE, contact="r - a", leaves=leaves) == expected


# --- motions --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("equation", "x", "domain", "expected"), [
    ("x_ddot", "sqrt(t**2 - 2*t + 1)", [], "fails"),  # |t − 1|
    ("x_ddot", "sqrt(t**2 - 2*t + 1)", ["t > 1"], "holds"),
    ("x_ddot + x/4", "sqrt(1 - cos(t))", [], "undecided"),  # √2 |sin t/2|
    ("x_ddot + x/4", "sin(t/2)", [], "holds"),
    ("x_dot**2 = 1", "Abs(t)", [], "undecided"),
    ("x_dot**2 = 1", "Abs(t)", ["t > 0"], "holds"),
    ("x*x_dot = 1", "sqrt(2*t + c)", [], "holds"),
    ("x*x_dot = 1", "sqrt(t + c)", [], "fails"),
    ("x_ddot", "Abs(c)*t", [], "holds"),
])  # fmt: skip
def test_motions_with_kinks(equation, x, domain, expected):
    keys = {"q": ["x"], "equations": [equation], "solution": {"x": x}, "parameters": {"c": "real"}}
    assert said("solution", **keys, domain=domain) == expected


def test_a_kink_is_one():
    """The motions called wrong or doubtful above leave the equation by a jump of the velocity."""
    for f, t in ((lambda t: mp.sqrt(t**2 - 2 * t + 1), 1), (lambda t: mp.sqrt(1 - mp.cos(t)), 0)):
        right, left = (mp.diff(f, t + side * mp.mpf("1e-3")) for side in (1, -1))
        assert abs(right - left) > 1


@pytest.mark.parametrize(("equations", "x", "constants", "expected"), [
    (["x_ddot + k**2*x"], "A*cos(k*t)", ["A", "k"], "fails"),  # k is no constant of integration
    (["x_ddot + k**2*x"], "A*cos(k*t + B)", ["A", "B"], "holds"),
    (["x_ddot + k**2*x"], "A*cos(k*t)", ["A", "B"], "fails"),
    (["x_dot**2 - 1"], "t + C", ["C"], "undecided"),  # −t + C is one too
    (["x_dot - 1"], "t + C", ["C"], "holds"),
])  # fmt: skip
def test_constants_of_integration(equations, x, constants, expected):
    keys = {"q": ["x"], "equations": equations, "solution": {"x": x}, "constants": constants}
    assert said("solution", **keys, parameters={"k": "positive"}) == expected


def test_general_solutions_of_equations_that_leave_something_free():
    line = {"solution": {"x": "A + B*t", "y": "C + D*t"}, "constants": ["A", "B", "C", "D"], "q": ["x", "y"]}
    twice = ["x_ddot + y_ddot", "2*x_ddot + 2*y_ddot"]  # x = sin t, y = −sin t is one too
    assert said("solution", **line, equations=twice) == "undecided"
    assert said("solution", **line, equations=["x_ddot + y_ddot", "x_ddot - y_ddot"]) == "holds"
    assert said("solution", **line, L="(x_dot + y_dot)**2/2") == "undecided"
    assert said("solution", **line, L="(x_dot**2 + y_dot**2)/2") == "holds"


def test_lagrangians_of_first_order_have_as_many_constants_as_coordinates():
    turn = {"x": "A*cos(t) + B*sin(t)", "y": "-A*sin(t) + B*cos(t)"}
    keys = {"q": ["x", "y"], "L": "y*x_dot - (x**2 + y**2)/2", "solution": turn}
    assert said("solution", **keys, constants=["A", "B"]) == "holds"
    assert said("solution", **keys, constants=["A"], parameters={"B": "real"}) == "fails"


def test_quantities_that_jump_are_not_called_conserved():
    keys = {"q": ["x"], "L": "x_dot**2/2 - x**2/2"}
    assert said("conserved-or-not", **keys, conserved=["Abs(x)/x"]) == "fails"
    assert said("conserved-or-not", **keys, not_conserved=["x/Abs(x)"]) == "undecided"
    rolling = {"q": ["x"], "L": "x_dot**2/2 - Abs(x)"}
    assert said("conserved-or-not", **rolling, conserved=["x_dot**2/2 + Abs(x)"]) == "holds"
    assert said("conserved-or-not", **rolling, conserved=["x_dot**2/2 - Abs(x)"]) == "fails"


# --- expansions -----------------------------------------------------------------------------------

HOOP = {
    "q": ["theta"],
    "parameters": {"a": "positive", "w": "positive", "g": "positive"},
    "L": "a**2*(theta_dot**2 + w**2*sin(theta)**2)/2 + g*a*cos(theta)",
    "equilibrium": {"theta": "acos(g/(a*w**2))"},
    "claim": ["theta'' + (w**2 - g**2/(a**2*w**2))*theta = 0"],
}


@pytest.mark.parametrize(("domain", "expected"), [
    (["g > a*w**2"], "undecided"),  # arccos of more than 1
    (["g < a*w**2"], "holds"),
])  # fmt: skip
def test_places_that_are_not_real_are_no_equilibria(domain, expected):
    assert said("linearisation", **HOOP, domain=domain) == expected


@pytest.mark.parametrize(("keys", "expected"), [
    ({"domain": ["x > 1"]}, "invalid"),  # the place is not there
    ({"domain": ["x > -1"]}, "holds"),
    ({"parameters": {"x": "positive"}}, "invalid"),
    ({"claim": ["x*(x'' + x) = 0"]}, "fails"),  # not linear
    ({"claim": ["2*(x'' + x) = 0"]}, "holds"),
])  # fmt: skip
def test_where_an_oscillator_rests(keys, expected):
    whole = {
        "q": ["x"],
        "L": "x_dot**2/2 - x**2/2",
        "equilibrium": {"x": "0"},
        "claim": ["x'' + x = 0"],
        **keys,
    }
    assert said("linearisation", **whole) == expected


@pytest.mark.parametrize(("exact", "claim", "expected"), [
    ("e*tan(asin(3/5) + acos(3/5) + e)", "0", "undecided"),  # a pole that is hidden: the limit is −1
    ("e*tan(asin(3/5) + acos(4/5) + e)", "0", "holds"),
    ("e*tan(asin(3/5) + acos(4/5) + e)", "1", "fails"),
    ("e/cos(asin(3/5) + acos(3/5) + e)", "0", "undecided"),
])  # fmt: skip
def test_hidden_poles(exact, claim, expected):
    keys = {"exact": [exact], "claim": [claim], "small": ["e"], "order": 0, "parameters": {"e": "real"}}
    assert said("first-order", **keys) == expected
    with mp.workdps(30):
        near = sp.lambdify(sp.Symbol("e"), sp.sympify(exact), "mpmath")(mp.mpf("1e-9"))
    if expected != "undecided":
        assert (abs(near - mp.mpf(claim)) < mp.mpf("1e-8")) == (expected == "holds")
    else:
        assert abs(abs(near) - 1) < mp.mpf("1e-8")


@pytest.mark.parametrize(("exact", "claim", "domain", "expected"), [
    ("Abs(a)*e", "a*e", ["a > e"], "holds"),  # a > e > 0 for every e leaves a ≥ 0
    ("Abs(a)*e", "-a*e", ["a > e"], "fails"),
    ("Abs(a)*e", "a*e", ["a < 1"], "fails"),
    ("sin(e)", "e", ["e > 1"], "undecided"),  # not small
    ("sin(e)", "e", ["e < 1"], "holds"),
])  # fmt: skip
def test_conditions_on_what_is_small(exact, claim, domain, expected):
    keys = {"exact": [exact], "claim": [claim], "small": ["e"], "parameters": declared("e:positive a:real")}
    assert said("first-order", **keys, domain=domain) == expected


# --- positive real --------------------------------------------------------------------------------


@pytest.mark.parametrize(("H", "expected"), [
    ("Abs(s)**2/s", "invalid"),  # the conjugate of s, which is not rational
    ("s**2/s", "holds"),
    ("conjugate(s)", "invalid"),
    ("(s**2 + 1)*(s**2 + 9)/(s*(s**2 + 4))", "holds"),  # zeros and poles take turns
    ("(s**2 + 1)*(s**2 + 4)/(s*(s**2 + 9))", "fails"),
])  # fmt: skip
def test_functions_of_the_complex_frequency(H, expected):
    assert said("positive-real", variables=["s"], H=H, **{"is": ["passive"]}) == expected


def test_a_lag_is_passive_up_to_the_sum_of_its_poles():
    keys = {
        "variables": ["s"],
        "H": "(s + c)/((s + a)*(s + b))",
        "parameters": declared("a:positive b:positive c:positive"),
    }
    assert said("positive-real", **keys, domain=["c <= a + b"], **{"is": ["passive"]}) == "holds"
    assert said("positive-real", **keys, domain=["c > a + b"], **{"is": ["passive"]}) == "fails"
    assert said("positive-real", **keys, domain=["c > a + b"], **{"is": ["not passive"]}) == "holds"
