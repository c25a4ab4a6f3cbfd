"""Claims by which a reader of the code had wrong verdicts, with right neighbours: what is no proof decides nothing."""

import pytest

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.sheet.sheet import Claim

BUDGET = 60.0
"""Seconds for a claim: that a busy machine is slow is no question here."""


def said(kind, **keys):
    """Return the verdict on a claim as a word; invalid where nothing can be judged."""
    try:
        return judge(Claim("a", kind, keys, budget=BUDGET)).status.value
    except InvalidClaim:
        return "invalid"


SPRING = {
    "q": ["r"], "parameters": {"r": "positive", "w": "positive", "a": "positive"},
    "L": "r_dot**2/2 - w**2*(r - a)**2/2", "equilibrium": {"r": "a"},
}  # fmt: skip


@pytest.mark.parametrize(
    ("claim", "due"),
    [
        ("r'' + w**2*sqrt(r**2) = 0", "fails"),
        ("r'' + w**2*Abs(r) = 0", "fails"),
        ("r'' + w**2*r = 0", "holds"),
        ("r'' - w**2*r = 0", "fails"),
    ],
)
def test_a_deviation_has_either_sign_whatever_is_assumed_of_the_coordinate(claim, due):
    assert said("linearisation", **SPRING, claim=[claim]) == due


@pytest.mark.parametrize(
    ("word", "value", "domain", "claim", "due"),
    [
        ("positive", "-9.81", [], "-9.81", "invalid"),
        ("positive", "9.81", [], "9.81", "holds"),
        ("positive", "9.81", [], "-9.81", "fails"),
        ("real", "-9.81", [], "9.81", "holds"),
        ("real", "-9.81", [], "-9.81", "fails"),
        ("negative", "-9.81", [], "9.81", "holds"),
        ("nonzero", "0", [], "0", "invalid"),
        ("integer", "1/2", [], "1/2", "invalid"),
        ("real", "9.81", ["g < 0"], "9.81", "invalid"),
        ("real", "-9.81", ["g < 0"], "9.81", "holds"),
        ("real", "sqrt(2)", ["g**2 <= 2"], "sqrt(2)", "holds"),
        ("real", "sqrt(2)", ["g**2 < 2"], "sqrt(2)", "invalid"),
    ],
)
def test_given_numbers_are_what_is_assumed_of_their_names(word, value, domain, claim, due):
    keys = {"parameters": {"g": word}, "given": {"g": value}, "domain": domain}
    assert said("number", **keys, value="sqrt(g**2)", tolerance="0.001", claim=claim) == due


@pytest.mark.parametrize(
    ("n", "value", "due"),
    [
        ("k/2", "k", "undecided"),
        ("k", "2*k", "holds"),
        ("k*(k + 1)/2", "k**2 + k", "holds"),
        ("k + 1/2", "2*k + 1", "fails"),
        ("2", "4", "holds"),
        ("sqrt(2)", "2*sqrt(2)", "fails"),
    ],
)
def test_values_of_whole_parameters_are_proved_to_be_whole(n, value, due):
    keys = {"q": ["q"], "p": ["p"], "parameters": {"n": "integer", "k": "integer"}, "find": ["n"]}
    pairs = [{"f": "q", "g": "2*n*p", "value": value}]
    assert said("parameters", of="poisson-bracket", **keys, pairs=pairs, values=[{"n": n}]) == due


@pytest.mark.parametrize(
    ("constraint", "domain", "due"),
    [
        ("x - a*sign(t) = 0", [], "rheonomic"),
        ("x - a*sign(t) = 0", ["t > 0"], "scleronomic"),
        ("x - sqrt(t**2)/t = 0", [], "rheonomic"),
        ("x - y*(3 + sign(t - 3)) = 0", [], "rheonomic"),
        ("x - y*Piecewise((1, t > 3), (2, True)) = 0", [], "rheonomic"),
        ("x - y*Piecewise((1, y > 3), (2, True)) = 0", [], "scleronomic"),
        ("x_dot - y_dot - atan(t) - atan(1/t) = 0", [], "rheonomic"),
        ("x - sign(t) >= 0", [], "rheonomic"),
        ("x - sign(t)**2 = 0", [], "scleronomic"),
        ("(x - y)*exp(t) = 0", [], "scleronomic"),
        ("x - a*t = 0", [], "rheonomic"),
        ("x_dot - a = 0", [], "scleronomic"),
        ("x**2 + y**2 - a**2 = 0", [], "scleronomic"),
    ],
)
def test_the_time_stands_in_constraints_by_steps_too(constraint, domain, due):
    keys = {"q": ["x", "y"], "parameters": {"a": "positive"}, "domain": domain, "constraints": [constraint]}
    other = {"rheonomic": "scleronomic", "scleronomic": "rheonomic"}[due]
    assert said("constraint-class", **keys, **{"class": [due]}) == "holds"
    assert said("constraint-class", **keys, **{"class": [other]}) == "fails"


@pytest.mark.parametrize("constraint", ["(1 + sign(t))*(x - y) = 0", "(1 + sign(t))*(x_dot - y_dot) = 0"])
def test_constraints_that_hold_at_some_times_only_are_not_called_scleronomic(constraint):
    keys = {"q": ["x", "y"], "constraints": [constraint]}
    assert said("constraint-class", **keys, **{"class": ["scleronomic"]}) != "holds"


def test_relations_inside_brackets_part_no_constraint():
    keys = {"q": ["x", "y"], "class": ["unilateral"]}
    steps = "y*Piecewise((1, y > 3), (2, True))"
    assert said("constraint-class", **keys, constraints=[f"x >= {steps}"]) == "holds"
    assert said("constraint-class", **keys, constraints=[f"x = {steps}"]) == "fails"


@pytest.mark.parametrize(
    ("leaves", "due"),
    [
        ("(9*cos(theta)**2 - 12*cos(theta) + 4)/(3*cos(theta) - 2) = 0", "fails"),
        ("(3*cos(theta) - 2)**2/(3*cos(theta) - 2)", "fails"),
        ("(3*cos(theta) - 2)/(cos(theta) + 2) = 0", "holds"),
        ("(3*cos(theta) - 2)/cos(theta) = 0", "holds"),
        ("3 = 2/cos(theta)", "holds"),
        ("3 = 1/cos(theta)", "fails"),
        ("theta = acos(2/3)", "holds"),
    ],
)
def test_a_leaving_condition_has_a_value_where_the_contact_is_lost(leaves, due):
    keys = {
        "q": ["r", "theta"], "parameters": {"m": "positive", "g": "positive", "a": "positive"},
        "L": "m*(r_dot**2 + r**2*theta_dot**2)/2 - m*g*r*cos(theta)", "contact": "r - a",
        "integrals": ["m*a**2*theta_dot**2/2 + m*g*a*cos(theta) = m*g*a"],
    }  # fmt: skip
    assert said("leaving-condition", **keys, leaves=leaves) == due


RESONANT = "eps*I1*I2*cos(u - v)"


@pytest.mark.parametrize(
    ("domain", "K", "due"),
    [
        (["w1 = w2"], "", "fails"),
        (["w1 = w2"], RESONANT, "holds"),
        (["w1 >= w2", "w1 <= w2"], "", "fails"),
        (["w1 >= w2", "w1 <= w2"], RESONANT, "holds"),
        (["(w1 - w2)*(w1 - 2*w2) = 0"], "", "undecided"),
        (["(w1 - w2)**2*(w1 - 2*w2)**2 <= 0"], "", "undecided"),
        (["w1 = 2*w2"], "", "holds"),
        (["w1 = 2*w2"], RESONANT, "fails"),
        (["w1 > w2"], "", "holds"),
        (["w1 >= w2"], "", "holds"),
        (["w1**2 + w2**2 < 7"], "", "holds"),
        ([], "", "holds"),
        ([], RESONANT, "fails"),
    ],
)
def test_the_domain_decides_which_terms_of_an_average_are_resonant(domain, K, due):
    keys = {
        "q": ["u", "v"], "p": ["I1", "I2"], "angles": ["u", "v"], "small": ["eps"], "domain": domain,
        "parameters": {"w1": "positive", "w2": "positive", "eps": "real"},
        "H": f"w1*I1 + w2*I2 + {RESONANT}", "K": f"w1*I1 + w2*I2 + {K or 0}",
    }  # fmt: skip
    assert said("averaged-hamiltonian", **keys) == due


@pytest.mark.parametrize(
    ("frequencies", "domain", "wave", "due"),
    [
        (("sqrt(k1/m1)", "sqrt(k2/m2)"), ["k1*m2 = k2*m1"], "2*u - 2*v", "fails"),
        (("sqrt(k1/m1)", "sqrt(k2/m2)"), ["k1*m2 = k2*m1"], "u", "holds"),
        (("sqrt(k1/m1)", "sqrt(k2/m2)"), ["k1*m2 = 4*k2*m1"], "u - 2*v", "fails"),
        (("sqrt(k1/m1)", "sqrt(k2/m2)"), [], "u - v", "holds"),
        (("sqrt(k1**2 - a)", "m1"), [], "u", "holds"),
        (("a", "1"), ["a = 0"], "u", "fails"),
        (("a", "1"), ["a > 0"], "u", "holds"),
        (("a + Abs(a)", "1"), [], "u", "undecided"),
    ],
)
def test_frequencies_are_divided_by_where_they_are_not_zero(frequencies, domain, wave, due):
    keys = {
        "q": ["u", "v"], "p": ["I1", "I2"], "angles": ["u", "v"], "small": ["eps"], "domain": domain,
        "parameters": {**dict.fromkeys(("k1", "k2", "m1", "m2"), "positive"), "eps": "real", "a": "real"},
    }  # fmt: skip
    K = "({})*I1 + ({})*I2".format(*frequencies)
    assert said("averaged-hamiltonian", **keys, H=f"{K} + eps*I1*I2*cos({wave})", K=K) == due


@pytest.mark.parametrize(
    ("domain", "due"), [(["w = 1"], "undecided"), (["w >= 1", "w <= 1"], "undecided"), ([], "holds")]
)
def test_bounds_that_leave_one_value_tie_parameters_of_normal_forms(domain, due):
    keys = {
        "q": ["x", "y"], "p": ["px", "py"], "parameters": {"w": "positive"}, "domain": domain, "degree": 4,
        "H": "(px**2 + x**2)/2 + w*(py**2 + y**2)/2 + x**2*y**2", "actions": ["J1", "J2"], "K": "J1 + w*J2 + J1*J2",
    }  # fmt: skip
    assert said("normal-form", **keys) == due


SCALED = {"of": "poisson-bracket", "pairs": [{"f": "q", "g": "p*V(a*q)", "value": "V(q)"}]}
SHIFTED = {"of": "constant-of-motion", "H": "p**2/2 + V(q)", "I": "p**2/2 + V(q + a)"}
SHIFTED_AND_SCALED = {"of": "constant-of-motion", "H": "p**2/2 + V(q)", "I": "c*p**2/2 + V(q + a)"}
NEW_HAMILTONIAN = {
    "of": "transformed-hamiltonian-K", "new_q": ["Q"], "new_p": ["P"], "H": "p**2/2 + V(q)",
    "map": {"Q": ["q"], "P": ["p"]}, "K": "P**2/2 + V(a*Q)",
}  # fmt: skip
REWRITTEN = {
    "of": "poisson-bracket",
    "pairs": [{"f": "q", "g": "p*V((q + 1)**2)", "value": "a*V(q**2 + 2*q + 1)"}],
}
ANOTHER_FACTOR = {"of": "poisson-bracket", "pairs": [{"f": "q", "g": "2*p*V(a*q)", "value": "V(q)"}]}
WITH_A_GIVEN = {"of": "poisson-bracket", "pairs": [{"f": "q", "g": "p*V(a*q)", "value": "V(b*q)"}]}


@pytest.mark.parametrize(
    ("claim", "right", "wrong"),
    [
        (SCALED, [{"a": "1"}], [[], [{"a": "2"}], [{"a": "1"}, {"a": "-1"}]]),
        (SHIFTED, [{"a": "0"}], [[], [{"a": "1"}]]),
        (SHIFTED_AND_SCALED, [{"a": "0", "c": "1"}], [[], [{"a": "0"}], [{"c": "1"}]]),
        (NEW_HAMILTONIAN, [{"a": "1"}], [[], [{"a": "-1"}]]),
        (REWRITTEN, [{"a": "1"}], [[], [{"a": "0"}]]),
        (ANOTHER_FACTOR, [], [[{"a": "1"}], [{"a": "0"}]]),
        (WITH_A_GIVEN, [{"a": "b"}], [[], [{"a": "1"}]]),
    ],
)
def test_values_of_a_function_are_one_where_its_places_are(claim, right, wrong):
    of_c = "c" in claim.get("I", "")
    keys = {
        "q": ["q"], "p": ["p"], "parameters": dict.fromkeys("abc", "real"), "functions": {"V": ["q"]},
        "find": ["a", "c"] if of_c else ["a"],
    }  # fmt: skip
    assert said("parameters", **keys, **claim, values=right) == "holds"
    for values in wrong:
        assert said("parameters", **keys, **claim, values=values) == "fails"


def test_places_that_are_one_in_a_part_of_the_domain_leave_it_open():
    keys = {"q": ["q"], "p": ["p"], "parameters": {"a": "real"}, "functions": {"V": ["q"]}, "find": ["a"]}
    pairs = [{"f": "q", "g": "p*V(Abs(q))", "value": "a*V(q)"}]
    assert said("parameters", of="poisson-bracket", **keys, pairs=pairs, values=[]) != "holds"


@pytest.mark.parametrize(
    ("small", "domain", "exact", "claim", "due"),
    [
        (["eps"], ["b = eps*a"], "1 + b", "1 + eps*a", "holds"),
        (["eps"], ["b = eps*a"], "1 + b", "1 - eps*a", "fails"),
        (["eps"], ["b = eps*a"], "1 + b", "1", "fails"),
        (["eps"], ["b = eps*a"], "cos(b)", "1 - b**2/2 + b*eps - a*eps**2", "holds"),
        (["eps"], ["b = eps*a", "c = 1 + b"], "c**2", "1 + 2*eps*a", "holds"),
        (["eps"], ["eps = m/M"], "1/(M + m)", "1/M - eps/M", "holds"),
        (["eps"], ["eps = m/M"], "1/(M + m)", "1/M + eps/M", "fails"),
        (["eps"], ["b**2 = eps"], "1 + b", "1", "undecided"),
        (["x", "y"], ["y = 2*x"], "sin(y)", "2*x", "holds"),
        (["x", "y"], ["y = 2*x"], "sin(y)", "x", "fails"),
        (["x", "y"], ["y = x**2"], "sin(y)", "0", "undecided"),
        (["x", "y"], [], "sin(y)", "2*x", "fails"),
        (["eps"], ["eps*a > 0", "eps > 0"], "eps*sqrt(a**2)", "eps*a", "undecided"),
        (["eps"], ["eps > 0"], "eps*sqrt(a**2)", "eps*a", "fails"),
        (["eps"], ["a > eps"], "eps*sqrt(a**2)", "eps*a", "holds"),
    ],
)
def test_what_the_domain_says_of_small_quantities_is_put_in(small, domain, exact, claim, due):
    said_of = {**dict.fromkeys(("eps", "a", "b", "c", "x", "y"), "real"), "m": "positive", "M": "positive"}
    keys = {"parameters": said_of, "small": small, "domain": domain, "exact": [exact], "claim": [claim]}
    assert said("first-order", **keys) == due


@pytest.mark.parametrize("offset", ["1", "10", "1000", "5000"])
def test_momenta_are_claimed_where_they_are_real_however_far_away(offset):
    keys = {"q": ["q"], "p": ["p"], "H": f"p**2/2 + q**2/2 + {offset}", "constants": ["E"]}
    assert said("hamilton-jacobi", **keys, gradient=[f"sqrt(2*(E - {offset}) - q**2)"]) == "holds"
    assert said("hamilton-jacobi", **keys, gradient=[f"sqrt(2*(E + {offset}) - q**2)"]) == "fails"
    assert said("hamilton-jacobi", **keys, gradient=[f"sqrt(2*(E - {offset}) - 2*q**2)"]) == "fails"


def test_momenta_are_claimed_where_they_are_real_beside_large_parameters():
    keys = {
        "q": ["q"], "p": ["p"], "H": "p**2/2 + q**2/2 + V0", "constants": ["E"], "domain": ["V0 > 1000"],
        "parameters": {"V0": "positive", "E": "real"},
    }  # fmt: skip
    assert said("hamilton-jacobi", **keys, gradient=["sqrt(2*E - 2*V0 - q**2)"]) == "holds"
    assert said("hamilton-jacobi", **keys, gradient=["sqrt(2*E + 2*V0 - q**2)"]) == "fails"


@pytest.mark.parametrize(
    ("equation", "motion", "due"),
    [
        ("4*x**3*x'' + 1 = 0", "sqrt(t - 1000)", "holds"),
        ("4*x**3*x'' - 1 = 0", "sqrt(t - 1000)", "fails"),
        ("4*x**3*x'' + 1 = 0", "sqrt(t - 1)", "holds"),
        ("4*x**3*x'' + 1 = 0", "I*sqrt(1000 - t)", "fails"),
        ("x'' + exp(-2*x) = 0", "log(t - 500)", "holds"),
        ("x'' - exp(-2*x) = 0", "log(t - 500)", "fails"),
        ("9*x**2*x'' + 2 = 0", "(t - 500)**(2/3)", "holds"),
        ("9*x**2*x'' + 2 = 0", "(t - 5)**(2/3)", "holds"),
        ("x'*x - t = 0", "sqrt(t**2 + 1)", "holds"),
        ("x'*x - t = 0", "sqrt(t**2 - 4000000)", "holds"),
        ("x'*x + t = 0", "sqrt(-1 - t**2)", "fails"),
        ("x'' = 0", "t + sqrt(-1 - a**2)", "fails"),
        ("x'' = 0", "t*log(-1 - a**2)", "fails"),
    ],
)
def test_a_motion_is_claimed_where_it_is_real_and_fails_where_it_is_real_nowhere(equation, motion, due):
    keys = {"q": ["x"], "parameters": {"a": "real"}, "equations": [equation], "solution": {"x": motion}}
    assert said("solution", **keys) == due


@pytest.mark.parametrize(("radicand", "due"), [("J - 1000", "holds"), ("-1 - J**2", "fails")])
def test_a_map_to_actions_is_claimed_where_it_is_real(radicand, due):
    keys = {"q": ["q"], "p": ["p"], "H": "(p**2 + q**2)/2", "new_q": ["theta"], "new_p": ["J"]}
    root = f"sqrt(2*({radicand}))"
    table = {"q": f"{root}*sin(theta)", "p": f"{root}*cos(theta)"}
    assert said("action-angle", **keys, transformation=table) == due


MASSLESS = {
    "q": ["x", "y", "z"], "parameters": {"m": "positive", "k": "positive"},
    "L": "m*(x_dot**2 + y_dot**2)/2 - k*(x - z)**2/2", "multipliers": ["lam"],
}  # fmt: skip
REDUNDANT = {
    "q": ["x", "y"], "parameters": {"m": "positive", "g": "positive", "a": "real"},
    "L": "m*(x_dot**2 + y_dot**2)/2 - m*g*y", "constraints": ["x - a", "2*x - 2*a"], "multipliers": ["lam", "mu"],
}  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "constraint", "claim", "due"),
    [
        ("multiplier-holonomic", "y", "z'' = 0", "holds"),
        ("multiplier-holonomic", "y", "z = x", "holds"),
        ("multiplier-holonomic", "y", "z' = x'", "holds"),
        ("multiplier-holonomic", "y", "x'' = 0", "holds"),
        ("multiplier-holonomic", "y", "x'' = z", "fails"),
        ("multiplier-holonomic", "y", "z = 2*x", "fails"),
        ("multiplier-holonomic", "y", "z' = 0", "fails"),
        ("nonholonomic", "y_dot", "z' = x'", "holds"),
        ("nonholonomic", "y_dot", "lam*z' = 0", "holds"),
        ("nonholonomic", "y_dot", "z' = y' + 1", "fails"),
    ],
)
def test_what_follows_from_rates_of_equations_holds_on_every_motion(kind, constraint, claim, due):
    assert said(kind, **MASSLESS, constraints=[constraint], claim=[claim]) == due


@pytest.mark.parametrize(
    ("claim", "due"),
    [
        ("(y'')**2 = g**2", "holds"),
        ("lam*x'' + 2*mu*x'' + y'' + g = 0", "holds"),
        ("lam + 2*mu = 0", "holds"),
        ("lam = 0", "fails"),
        ("(y'')**2 = 2*g**2", "fails"),
        ("lam*y'' = 0", "fails"),
    ],
)
def test_dependent_constraints_leave_multipliers_free(claim, due):
    assert said("multiplier-holonomic", **REDUNDANT, claim=[claim]) == due


VORTEX = {"q": ["x", "y"], "L": "(x*y_dot - y*x_dot)/2 - (x**2 + y**2)/2"}


@pytest.mark.parametrize(
    ("claim", "due"),
    [
        (["y'' + y = 0", "x - y' = 0"], "holds"),
        (["x' + y = 0", "y' - x = 0", "x'' + x = 0"], "holds"),
        (["x' + y = 0", "y' - x = 0"], "holds"),
        (["y'' - y = 0", "x - y' = 0"], "fails"),
        (["x'' + x = 0", "x - y' = 0"], "fails"),
        (["x' + y = 0", "y' - x = 0", "x'' - x = 0"], "fails"),
        (["x'' + x = 0", "y'' + y = 0"], "fails"),
        (["x' - y = 0", "y' - x = 0"], "fails"),
    ],
)
def test_equations_of_first_order_are_those_of_their_rates_too(claim, due):
    assert said("euler-lagrange", **VORTEX, claim=claim) == due


SWINGS = "8/pi*(elliptic_e((1 + E)/2) - (1 - E)/2*elliptic_k((1 + E)/2))"
TURNS = "2/pi*sqrt(2*(1 + E))*elliptic_e(2/(1 + E))"


@pytest.mark.parametrize(
    ("domain", "J", "due"),
    [
        ("p**2/2 - cos(q) < 1", SWINGS, "holds"),
        ("p**2/2 - cos(q) < 1/2", SWINGS, "holds"),
        ("p**2/2 - cos(q) < 1.0001", SWINGS, "undecided"),
        ("p**2/2 - cos(q) < 1.0001", f"2*{SWINGS}", "fails"),
        ("p**2/2 - cos(q) > 0.9999", TURNS, "undecided"),
        ("p**2/2 - cos(q) > 1", TURNS, "holds"),
        ("p**2/2 - cos(q) > 2", TURNS, "holds"),
        ("p**2/2 - cos(q) > 1", f"2*{TURNS}", "fails"),
    ],
)
def test_motions_of_one_kind_are_proved(domain, J, due):
    keys = {"q": ["q"], "p": ["p"], "H": "p**2/2 - cos(q)", "parameters": {"E": "real"}, "domain": [domain]}
    assert said("action-angle", **keys, J=[J]) == due


@pytest.mark.parametrize(
    ("omega", "due"),
    [("a*sqrt(2*Abs(D - E))", "holds"), ("a*sqrt(2*(D - E))", "holds"), ("a*sqrt(D - E)", "fails")],
)
def test_formulas_are_compared_where_motions_are_bounded(omega, due):
    keys = {"q": ["q"], "p": ["p"], "H": "p**2/2 + D*(1 - exp(-a*q))**2"}
    signs = {"D": "positive", "a": "positive", "E": "real"}
    assert said("frequency", **keys, parameters=signs, omega=[omega]) == due
