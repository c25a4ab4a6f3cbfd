"""Claims whose parameters are tied by equalities: right under them, wrong without them or under others."""

import pytest

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.judges.perturbed.tied_parameters import with_tied_values
from canon.exercise.sheet.reading import Reading
from canon.exercise.sheet.sheet import Claim

LINEAR = {
    "q": ["q"], "p": ["p"], "Q": ["a*q + b*p"], "P": ["c*q + d*p"],
    "parameters": dict.fromkeys("abcd", "real"),
}  # fmt: skip
SPRING = {
    "q": ["x"], "L": "m*x_dot**2/2 - k*x**2/2",
    "parameters": {"m": "positive", "k": "positive", "w": "positive"},
}  # fmt: skip
EQUAL = {"parameters": {"alpha": "real", "beta": "real", "x": "real"}}
ROTATION = {
    "q": ["x", "y"], "p": ["px", "py"],
    "Q": ["a*x + b*y", "c*x + d*y"], "P": ["a*px + b*py", "c*px + d*py"],
    "parameters": dict.fromkeys("abcd", "real"),
}  # fmt: skip


def told(kind, keys, *domain, **more):
    return judge(Claim("a", kind, {**keys, "domain": list(domain), **more}))


@pytest.mark.parametrize(
    ("kind", "keys", "right", "wrong"),
    [
        ("canonicity", LINEAR, ["a*d - b*c = 1"], ["a*d - b*c = 2"]),
        ("canonicity", LINEAR, ["a*d == 1 + b*c"], ["a*d == 1 - b*c"]),
        ("canonicity", LINEAR, ["Eq(a*d - b*c, 1)"], []),
        ("canonicity", LINEAR, ["a = d", "b = -c", "a**2 + b**2 = 1"], ["a = d", "b = c", "a**2 + b**2 = 1"]),
        ("canonicity", LINEAR, ["a*d - b*c = 1", "a = 0"], ["a*d - b*c = 2", "a = 0"]),
        ("canonicity", {**LINEAR, "valence": "2"}, ["a*d - b*c = 2"], ["a*d - b*c = 1"]),
        ("canonicity", ROTATION, ["a**2 + b**2 = 1", "c**2 + d**2 = 1", "a*c + b*d = 0"],
         ["a**2 + b**2 = 1", "c**2 + d**2 = 1", "a*c - b*d = 0"]),
        ("euler-lagrange", {**SPRING, "claim": ["x_ddot + w**2*x"]}, ["w**2 = k/m"], ["w**2 = m/k"]),
        ("euler-lagrange", {**SPRING, "claim": ["x_ddot + w**2*x"]}, ["w = sqrt(k/m)"], ["w = sqrt(m/k)"]),
        ("equality-only", {**EQUAL,
         "lhs": "sin(alpha*x)", "rhs": "sin(beta*x)"}, ["alpha == beta"], ["alpha == -beta"]),
        ("equality-only", {**EQUAL,
         "lhs": "cos(alpha*x)", "rhs": "cos(beta*x)"}, ["alpha = -beta"], ["alpha = 2*beta"]),
        ("equality-only", {**EQUAL,
         "lhs": "alpha", "rhs": "1"}, ["alpha*beta = beta", "Ne(beta, 0)"], ["alpha*beta = beta"]),
    ],
)  # fmt: skip
def test_under_one_equality_and_not_under_another(kind, keys, right, wrong):
    assert told(kind, keys, *right).holds
    assert told(kind, keys, *wrong).fails


def test_equalities_that_nothing_satisfies_are_refused():
    with pytest.raises(InvalidClaim, match="no point satisfies"):
        told("canonicity", LINEAR, "a = 1", "a = 2")


@pytest.mark.parametrize("place", [0, 1, 2])
def test_an_equality_that_gives_no_value_hides_none_of_the_others(place):
    ties = ["k = 3", "m = 2"]
    ties.insert(place, "c**3 + d**3 = 1")
    names = {"k": "positive", "m": "positive", "c": "real", "d": "real"}
    keys = {"q": ["q"], "p": ["p"], "H": "p**2/(2*m) + k*q**2/2", "K": "J", "actions": ["J"], "degree": 2}
    reading = Reading.of(Claim("a", "normal-form", {**keys, "parameters": names, "domain": ties}))
    energy = with_tied_values(reading, reading.expression("H"))
    assert str(energy) == "p**2/4 + 3*q**2/2"
