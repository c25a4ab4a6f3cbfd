"""The kind `parameters`: all values for which a claim of another kind holds; what is told of wrong or missing ones."""

import random

import pytest
import sympy as sp

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.question.deadline import Deadline
from canon.exercise.question.parameter_system import covers, families
from canon.exercise.sheet.kinds import KINDS, kind_of
from canon.exercise.sheet.sheet import Claim, claim_from
from canon.exercise.sheet_check import judged
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Undecided

POLAR = {
    "of": "canonicity", "q": ["q"], "p": ["p"], "Q": ["q**alpha*cos(beta*p)"], "P": ["q**alpha*sin(beta*p)"],
    "parameters": {"q": "positive", "alpha": "real", "beta": "real"}, "find": ["alpha", "beta"],
}  # fmt: skip
BRACKET = {
    "of": "poisson-bracket", "q": ["q"], "p": ["p"], "pairs": [{"f": "q**a", "g": "p", "value": "3*q**2"}],
    "parameters": {"a": "real", "q": "positive"}, "find": ["a"],
}  # fmt: skip
ARBITRARY = {
    "of": "constant-of-motion", "q": ["x"], "p": ["p"], "H": "p**2/(2*m) + V(x)", "I": "a*p**2 + b*V(x)",
    "functions": {"V": ["x"]}, "parameters": {"a": "real", "b": "nonzero", "m": "positive"}, "find": ["a"],
}  # fmt: skip
GAUGE = {
    "of": "lagrangian-equivalence", "q": ["x"], "L1": "x_dot**2/2", "L2": "x_dot**2/2 + a*x*x_dot + b*x**2",
    "relation": "gauge", "F": "3*x**2/2", "parameters": {"a": "real", "b": "real"}, "find": ["a", "b"],
}  # fmt: skip
CUBIC = {
    "of": "bilinear-covariant", "q": ["q"], "p": ["p"], "Q": ["a*q"], "P": ["a**2*p"], "factor": "8",
    "parameters": {"a": "real"}, "find": ["a"],
}  # fmt: skip
LIE = {
    "of": "lie-bracket", "x": ["x", "y"], "X": ["x**n", "0"], "Y": ["x", "y"], "claim": ["-2*x**3", "0"],
    "parameters": {"n": "real", "x": "positive"}, "find": ["n"],
}  # fmt: skip
TYPE_ONE = {
    "of": "generating-F1", "q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"], "F": "a*q*Q",
    "map": {"Q": ["p"], "P": ["-q"]}, "parameters": {"a": "real"}, "find": ["a"],
}  # fmt: skip


def told(keys, *values):
    return judge(Claim("a", "parameters", {**keys, "values": list(values)}))


@pytest.mark.parametrize(
    ("keys", "right", "wrong"),
    [
        (POLAR, [{"alpha": "1/2", "beta": "2"}], [{"alpha": "2", "beta": "1/2"}]),
        (POLAR, [{"beta": "2", "alpha": "1/beta*1"}], [{"alpha": "1/beta"}]),
        (BRACKET, [{"a": "3"}], [{"a": "2"}]),
        (ARBITRARY, [{"a": "b/(2*m)"}], [{"a": "b/m"}]),
        (GAUGE, [{"a": "3", "b": "0"}], [{"a": "3"}]),
        (CUBIC, [{"a": "2"}], [{"a": "2"}, {"a": "-2"}]),
        (LIE, [{"n": "3"}], [{"n": "2"}]),
        (TYPE_ONE, [{"a": "1"}], []),
    ],
)  # fmt: skip
def test_all_values_and_others(keys, right, wrong):
    if right[0].get("alpha") == "1/beta*1":  # a value in terms of one that is given beside it is refused
        with pytest.raises(InvalidClaim, match="holds beta"):
            told(keys, *right)
    else:
        assert told(keys, *right).holds
    assert told(keys, *wrong).fails


def test_what_is_told_of_wrong_and_missing_values():
    claims = [
        claim_from({"id": str(i), "kind": "parameters", **keys, "values": values})
        for i, (keys, values) in enumerate(
            [
                (POLAR, [{"alpha": "1/2", "beta": "1"}]),
                (POLAR, []),
                (GAUGE, [{"a": "3", "b": "0"}, {"a": "0", "b": "0"}]),
                (TYPE_ONE, []),
            ]
        )
    ]
    first, second, third, fourth = judged(claims)
    assert first.feedback == "alpha = 1/2, beta = 1 is no solution: {Q, P} comes out wrong"
    assert first.corrected == second.corrected == "alpha = 1/2, beta = 2"
    assert second.feedback == "there is a solution: alpha = 1/2, beta = 2"
    assert third.feedback.startswith("a = 0, b = 0 is no solution")
    assert third.corrected == "a = 3, b = 0"
    assert fourth.corrected == "a = 1"


def test_a_value_that_assumptions_or_the_domain_exclude():
    spring = {
        "of": "solution", "q": ["x"], "L": "m*x_dot**2/2 - k*x**2/2", "solution": {"x": "A*cos(w*t)"},
        "parameters": {"m": "positive", "k": "positive", "A": "nonzero", "w": "positive"}, "find": ["w"],
    }  # fmt: skip
    assert told(spring, {"w": "sqrt(k/m)"}).holds
    assert "by what is assumed" in told(spring, {"w": "sqrt(k/m)"}, {"w": "-sqrt(k/m)"}).feedback
    free = {**spring, "parameters": {**spring["parameters"], "w": "real"}, "domain": ["w > 0"]}
    assert told(free, {"w": "sqrt(k/m)"}).holds
    assert told(free, {"w": "sqrt(k/m)"}, {"w": "-sqrt(k/m)"}).fails


@pytest.mark.parametrize(
    ("changed", "where"),
    [
        ({"of": "equality-only"}, "of"),
        ({"find": ["q"]}, "find"),
        ({"find": ["zeta"]}, "find"),
        ({"values": [{"gamma": "1"}]}, "values"),
        ({"values": [{"alpha": "q"}]}, "values"),
        ({"values": "alpha = 1"}, "values"),
        ({"P": ["q", "p"]}, "P"),
        ({"wrong": "1"}, "wrong"),
    ],
)
def test_what_is_invalid_names_its_key(changed, where):
    claim = claim_from({"id": "a", "kind": "parameters", **POLAR, "values": [], **changed})
    (judgement,) = judged([claim])
    assert judgement.status == "invalid"
    assert f"key {where}" in judgement.known


def test_undecided_where_conditions_have_no_closed_form():
    keys = {**CUBIC, "Q": ["(a**5 - a)*q"], "P": ["p"], "factor": "1"}
    assert told(keys).undecided
    assert told(keys, {"a": "2"}).fails


def test_the_keys_of_a_kind_are_those_of_both():
    for of in KINDS["parameters"].about:
        both = kind_of("parameters", {"of": of})
        assert {"of", "find", "values", *KINDS[of].required} == set(both.required)
        assert not {"of", "find", "values"} & {*KINDS[of].required, *KINDS[of].optional}


x, y = sp.symbols("x y", real=True)
a, b, c = sp.symbols("a b c", real=True)


@pytest.mark.parametrize("seed", range(12))
def test_planted_solutions_are_all_found(seed):
    """Each family satisfies the equations, and each planted solution lies in one."""
    chance = random.Random(seed)
    planted = {tuple(chance.randint(-3, 3) for _ in range(2)) for _ in range(chance.randint(1, 2))}
    line = chance.choice([a - b, a + 2 * b, a - 1])
    first, second = sorted({p[0] for p in planted}), {p[0]: p[1] for p in planted}
    on_a = sp.prod(a - r for r in first)
    on_b = b - sp.interpolate([(sp.Integer(r), sp.Integer(second[r])) for r in first], a)
    residuals = [on_a * line * x + on_b * line * (x**2 + y), on_a * line * sp.exp(x)]
    found = families(residuals, [a, b], [], Domain(), Deadline.after(20.0))
    for family in found:
        assert all(sp.expand(r.subs(family)) == 0 for r in residuals)
    for r in first:
        point = {a: sp.Integer(r), b: sp.Integer(second[r])}
        assert any(covers(family, point, Domain(), Deadline.after(5.0)) for family in found)
    assert any(line.subs(family) == 0 for family in found)
    assert len(found) <= len(first) + 1


def test_systems_of_other_forms():
    after = Deadline.after(20.0)
    assert families([a * x + x**2], [a], [], Domain(), after) == []
    assert families([a * b * x], [a, b], [], Domain(), after) == [{a: 0}, {b: 0}]
    assert families([sp.exp(a * x) - sp.exp(b * x)], [a, b], [], Domain(), after) == [{a: b}]
    assert families([c * a * x - c * x], [a], [c], Domain(), after) == [{a: 1}]
    assert families([1 / (x - a) - 1 / (x - 2)], [a], [], Domain(), after) == [{a: 2}]
    with pytest.raises(Undecided):
        families([sp.cos(a) * x - x], [a], [], Domain(), after)
    with pytest.raises(Undecided):
        families([sp.sqrt(x - a) - sp.sqrt(x - 2)], [a], [], Domain(), after)


SCALED = {
    "of": "canonicity", "q": ["q"], "p": ["p"], "Q": ["(a + b)*q"], "P": ["p"],
    "parameters": {"a": "real", "b": "real"}, "find": ["a", "b"],
}  # fmt: skip
ON_A_PART = [
    "1 - a + Piecewise((0, a < 0))",
    "Piecewise((1 - a, a < 10**9))",
    "1 - a + 0*log((a + 1)**2 - a**2 - 2*a - 1)",
    "1 - a + 0/(a - a)",
]
EVERYWHERE = [
    "1 - a",
    "1 - a + Piecewise((0, a < 0), (0, True))",
    "1 - a + 0/a",
    "Piecewise((1 - a, Ne(a, 0)))",
]


def test_values_are_defined_for_all_that_is_left_open():
    for value in ON_A_PART:
        verdict = judge(Claim("a", "parameters", {**SCALED, "values": [{"b": value}]}))
        assert verdict.fails, value
        assert "value" in verdict.feedback
    for value in EVERYWHERE:
        assert judge(Claim("a", "parameters", {**SCALED, "values": [{"b": value}]})).holds, value


def test_values_may_be_narrower_than_the_plane_where_the_domain_is():
    negative = {**SCALED, "domain": ["a < -1"], "values": [{"b": ON_A_PART[0]}]}
    assert judge(Claim("a", "parameters", negative)).holds
    parts = [{"b": "Piecewise((1 - a, a < 0))"}, {"b": "Piecewise((1 - a, a > 5))"}]
    assert not judge(Claim("a", "parameters", {**SCALED, "values": parts})).holds
