"""Claims that say nothing, maps with pieces and quantities that jump are not taken for right."""

import pytest

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.sheet.sheet import Claim


def verdict(kind, **keys):
    return judge(Claim("a", kind, keys))


PENDULUM = {
    "q": ["r", "theta"],
    "L": "m*(r_dot**2 + r**2*theta_dot**2)/2 + m*g*r*cos(theta)",
    "parameters": {"m": "positive", "g": "positive", "l": "positive"},
    "multipliers": ["lam"],
    "constraints": ["r - l"],
}


@pytest.mark.parametrize(
    ("kind", "keys"),
    [
        ("conserved-or-not", {"q": ["x"], "L": "x_dot**2", "conserved": []}),
        ("first-order", {"exact": [], "claim": [], "small": ["e"], "parameters": {"e": "real"}}),
        ("reaction", {**PENDULUM, "constraints": ["r + l"], "values": {"lam": "7"},
                      "parameters": {**PENDULUM["parameters"], "r": "positive"}}),
        ("reaction", {**PENDULUM, "values": {"lam": "lam"}}),
        ("reaction", {**PENDULUM, "values": {"lam": "-m*g"}, "integrals": ["theta_dot = 1"]}),
        ("kinetic-energy", {"q": ["x"], "bodies": [{"m": "1", "r": ["x"]}], "T": "0",
                            "constraints": ["x + 1"], "parameters": {"x": "positive"}}),
        ("variation", {"q": ["x"], "L": "x_dot**2/2", "boundary": "x_dot", "integrand": "-x_ddot*delta_x"}),
        ("differential", {"x": ["x"], "f": "x**2", "claim": "2*x"}),
        ("generalized-force", {"q": ["x", "y"], "power": "x_dot*y_dot", "Q": ["0", "0"]}),
        ("positive-real", {"variables": ["s"], "H": "exp(-s)", "is": ["passive"]}),
        ("positive-real", {"variables": ["s"], "H": "1/s", "is": ["lovely"]}),
    ],
)  # fmt: skip
def test_claims_that_say_nothing_are_invalid(kind, keys):
    with pytest.raises(InvalidClaim):
        verdict(kind, **keys)


def said(kind, **keys):
    """Return the verdict on a claim as a word; invalid where nothing can be judged."""
    try:
        return judge(Claim("a", kind, keys)).status.value
    except InvalidClaim:
        return "invalid"


def test_a_map_with_pieces_is_not_called_regular():
    keys = {"of": "lagrange-equations", "q": ["q"]}
    assert said("invariance", **keys, Q=["Max(q, 0)"]) == "undecided"
    assert said("invariance", **keys, Q=["q**3 + q"]) == "holds"
    assert said("invariance", **keys, Q=["Max(q, 0) - Max(q, 0)"]) == "fails"


def test_quantities_that_jump_are_not_called_conserved():
    keys = {"q": ["x"], "L": "x_dot**2/2 - x**2/2"}
    assert said("conserved-or-not", **keys, conserved=["Abs(x)/x"]) == "fails"
    assert said("conserved-or-not", **keys, not_conserved=["x/Abs(x)"]) == "undecided"
    rolling = {"q": ["x"], "L": "x_dot**2/2 - Abs(x)"}
    assert said("conserved-or-not", **rolling, conserved=["x_dot**2/2 + Abs(x)"]) == "holds"
    assert said("conserved-or-not", **rolling, conserved=["x_dot**2/2 - Abs(x)"]) == "fails"
