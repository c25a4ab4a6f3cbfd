"""Equations without accelerations bind velocities or coordinates; they are compared as such."""

import pytest

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import Claim

VORTEX = "(x*y_dot - y*x_dot)/2 - k*(x**2 + y**2)/2"
PHASE_SPACE = "p*x_dot - p**2/2 - V(x)"
BOUND = "x_dot**2/2 + x*y"
DRIVEN = "x_dot**2/2 + y*(x - t**3)"


def verdict(L, claim, q=("x", "y")):
    keys = {"q": list(q), "L": L, "claim": claim, "parameters": {"k": "nonzero"}, "functions": {"V": ["x"]}}
    return judge(Claim("a", "euler-lagrange", keys)).status.value


@pytest.mark.parametrize(
    ("L", "claim", "expected"),
    [
        (VORTEX, ["y_dot - k*x", "x_dot + k*y"], "holds"),
        (VORTEX, ["y_dot - k*x + 3*(x_dot + k*y)", "x_dot + k*y"], "holds"),
        (VORTEX, ["y_dot - k*x", "x_dot - k*y"], "fails"),
        (VORTEX, ["y_dot - k*x"], "fails"),
        (BOUND, ["x_ddot - y", "x"], "holds"),
        (BOUND, ["x_ddot - y", "x - 1"], "fails"),
        (BOUND, ["x_ddot + y", "x"], "holds"),  # both say x = y = 0
        (DRIVEN, ["x_ddot - y", "x - t**3"], "holds"),
        (DRIVEN, ["y - 6*t", "x - t**3"], "holds"),
        (DRIVEN, ["x_ddot + y", "x - t**3"], "fails"),
    ],
)
def test_degenerate_lagrangians(L, claim, expected):
    assert verdict(L, claim) == expected


@pytest.mark.parametrize(("force", "expected"), [("-", "holds"), ("", "fails")])
def test_a_lagrangian_of_first_order_in_phase_space(force, expected):
    assert verdict(PHASE_SPACE, ["x_dot = p", f"p_dot = {force}Derivative(V(x), x)"], ("x", "p")) == expected


def test_equations_that_bind_the_state_in_no_affine_way_stay_open():
    assert verdict("x_dot**2/2 + y*(x**3 - 1)", ["x_ddot - 3*y*x**2", "x - 2"]) == "undecided"


def test_the_same_equations_of_two_degenerate_lagrangians():
    keys = {"q": ["x", "y"], "L1": VORTEX, "parameters": {"k": "nonzero"}, "relation": "equations"}
    for L2, expected in ((f"3*({VORTEX})", "holds"), (VORTEX.replace("- k", "+ k"), "fails")):
        assert judge(Claim("a", "lagrangian-equivalence", keys | {"L2": L2})).status.value == expected


def test_one_expression_may_stand_in_a_list():
    keys = {"x": ["q", "p"], "form": ["p", "0"], "claim": ["d_q*delta_p - d_p*delta_q"]}
    assert judge(Claim("a", "bilinear-covariant", keys)).holds
    keys["claim"] = ["d_p*delta_q - d_q*delta_p"]
    assert judge(Claim("a", "bilinear-covariant", keys)).fails


@pytest.mark.parametrize(("domain", "holds"), [(["q > 0"], True), (["Ne(q, 0)"], False)])
def test_pieces_that_the_domain_leaves_out_are_no_obstacle(domain, holds):
    names = {"q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"]}
    keys = {**names, "F": "(q + Abs(q))*P", "map": {"Q": ["q + Abs(q)"], "P": ["p/2"]}, "domain": domain}
    assert judge(Claim("a", "generating-F2", keys)).holds is holds


@pytest.mark.parametrize(("factor", "said"), [("k", ("generic point: k ≠ 0",)), ("(k**2 + 1)", ())])
def test_parameters_are_as_generic_in_linearised_equations_as_in_lagranges(factor, said):
    keys = {"q": ["x"], "L": "x_dot**2/2 - x**2/2", "parameters": {"k": "real"}}
    for kind, more in (("euler-lagrange", {}), ("linearisation", {"equilibrium": {"x": "0"}})):
        verdict = judge(Claim("a", kind, {**keys, **more, "claim": [f"{factor}*(x_ddot + x)"]}))
        assert verdict.holds
        assert verdict.assumed == said
        assert judge(Claim("a", kind, {**keys, **more, "claim": [f"{factor}*(x_ddot - x)"]})).fails
