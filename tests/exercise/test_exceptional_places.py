"""Where a map is singular, where a potential bends across coordinates, and what stands beside a claim."""

import pytest

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import Claim


def verdict(kind, name="a", **keys):
    return judge(Claim(name, kind, keys))


@pytest.mark.parametrize("Q", ["q**3", "q**2", "q + sin(q)", "cosh(q)"])
def test_a_point_transformation_that_is_singular_somewhere_is_said_to_be_so(Q):
    found = verdict("invariance", of="lagrange-equations", q=["q"], Q=[Q])
    assert found.holds
    assert "∂Q/∂q is singular where" in "".join(found.assumed)
    positive = verdict("invariance", of="lagrange-equations", q=["q"], Q=[Q], domain=["q > 0", "q < 1"])
    assert positive.holds
    assert Q == "q + sin(q)" or not positive.assumed


@pytest.mark.parametrize(("L", "where"), [("x_dot**3/3", "x_dot"), ("-cos(x_dot)", "cos(x_dot)")])
def test_velocities_that_can_not_be_eliminated_everywhere_are_said_to_be_so(L, where):
    found = verdict("legendre-hamiltonian", q=["x"], p=["p"], L=L, exists=True)
    assert found.holds
    assert f"{where} = 0" in "".join(found.assumed)
    free = {"q": ["x"], "p": ["p"], "L": "m*x_dot**2/2", "parameters": {"m": "positive"}}
    assert not verdict("legendre-hamiltonian", **free, exists=True).assumed


PLANE = {"q": ["x", "y"], "p": ["px", "py"]}


@pytest.mark.parametrize("V", ["abs(x + y)", "max(x, y)", "abs(x**2 + y**2 - 1)", "sqrt((x + y)**2)"])
def test_a_kink_across_coordinates_does_not_separate(V):
    for said in ("separable", "not separable"):
        assert verdict("separable", **PLANE, H=f"(px**2 + py**2)/2 + {V}", **{"is": [said]}).undecided


@pytest.mark.parametrize("V", ["abs(x) + abs(y - 1)", "max(x, 0) + abs(y)", "abs(sin(x))"])
def test_kinks_of_one_coordinate_each_do_separate(V):
    H = f"(px**2 + py**2)/2 + {V}"
    assert verdict("separable", **PLANE, H=H, **{"is": ["separable"]}).holds
    assert verdict("separable", **PLANE, H=H, **{"is": ["not separable"]}).fails


@pytest.mark.parametrize("name", ["a", "F", "task F", "anna.F@uni.de"])
def test_the_verdict_does_not_depend_on_what_stands_beside_the_claim(name):
    keys = {"q": ["x"], "L": "m*x_dot**2/2 - k*x**2/2", "parameters": {"m": "positive", "k": "positive"}}
    for beside in ({}, {"title": "the force F"}, {"source": "book F"}):
        assert verdict("euler-lagrange", name, **keys, claim=["m x'' = F = -k x"], **beside).holds
        assert verdict("euler-lagrange", name, **keys, claim=["m x'' = F = k x"], **beside).fails


def test_a_frequency_that_the_domain_makes_resonant_is_so():
    keys = {**PLANE, "actions": ["J1", "J2"], "degree": 4, "parameters": {"w": "positive"},
            "H": "(px**2 + x**2)/2 + w*(py**2 + y**2)/2 + x**2*y**2", "K": "J1 + w*J2 + J1*J2"}  # fmt: skip
    assert verdict("normal-form", **keys).holds
    assert verdict("normal-form", **keys, domain=["w = sqrt(2)"]).holds
    assert verdict("normal-form", **{**keys, "K": "J1 + w*J2 + 2*J1*J2"}, domain=["w = sqrt(2)"]).fails
    for resonant in ("w = 1", "w**2 = 1"):
        assert verdict("normal-form", **keys, domain=[resonant]).undecided


def test_a_sum_of_arcs_is_the_number_that_it_is():
    assert verdict("number", value="atan(1/2) + atan(1/3)", claim="pi/4").holds
    assert verdict("number", value="atan(1/2) + atan(1/3)", claim="pi/3").fails


def test_a_square_of_what_stands_beside_it_is_an_equation():
    """In v² = g r cos θ, v = r θ' the second one says what v is, whichever comes first."""
    ball = {"q": ["r", "theta"], "parameters": {"m": "positive", "g": "positive", "a": "positive"},
            "L": "m*(r_dot**2 + r**2*theta_dot**2)/2 - m*g*r*cos(theta)", "contact": "r - a"}  # fmt: skip
    for leaves, right in (
        ("v**2 = a*g*cos(theta), v = a*theta_dot", True),
        ("v**2 = 2*a*g*cos(theta), v = a*theta_dot", False),
    ):
        for said in (leaves, ", ".join(reversed(leaves.split(", ")))):
            assert verdict("leaving-condition", **ball, leaves=said).holds == right


@pytest.mark.parametrize(
    ("exact", "right", "wrong"),
    [
        ("sqrt(x**2 + e)", "abs(x) + e/(2*abs(x))", "x + e/(2*x)"),
        ("log(x**2 + e)", "log(x**2) + e/x**2", "2*log(x) + e/x**2"),
        ("(x**2 + e)**(3/2)", "abs(x)**3 + 3*abs(x)*e/2", "x**3 + 3*x*e/2"),
    ],
)
def test_expansions_about_what_is_not_zero(exact, right, wrong):
    keys = {"exact": [exact], "small": ["e"], "parameters": {"e": "real", "x": "nonzero"}}
    assert verdict("first-order", **keys, claim=[right]).holds
    assert verdict("first-order", **keys, claim=[wrong]).fails


@pytest.mark.parametrize("sign", ["", "-", "±"])
def test_a_speed_of_leaving_is_that_of_one_sense_or_of_both(sign):
    """A ball that slides from the top of a sphere leaves at cos θ = 2/3, on either side."""
    ball = {"q": ["r", "theta"], "parameters": {"m": "positive", "g": "positive", "a": "positive"},
            "L": "m*(r_dot**2 + r**2*theta_dot**2)/2 - m*g*r*cos(theta)", "contact": "r - a",
            "integrals": ["m*a**2*theta_dot**2/2 + m*g*a*cos(theta) = m*g*a"]}  # fmt: skip
    found = judge(Claim("a", "leaving-condition", {**ball, "leaves": f"theta' = {sign}sqrt(2*g/(3*a))"}))
    assert found.holds
    assert verdict("leaving-condition", **ball, leaves=f"theta' = {sign}sqrt(g/(3*a))").fails
