"""Answers behind ≈ where an approximation is asked for: the last form is judged, what it comes from is passed over."""

import pytest

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import Claim, claim_from

ROOT = {"exact": ["sqrt(1+eps)"], "small": ["eps"], "parameters": {"eps": "real"}}
PENDULUM = {
    "q": ["theta"],
    "parameters": {"g": "positive", "l": "positive"},
    "L": "l**2*theta_dot**2/2 + g*l*cos(theta)",
    "equilibrium": {"theta": "0"},
}


def said(kind, keys, claim):
    """Return the verdict on a claim as a word."""
    return judge(Claim("a", kind, {**keys, "claim": claim}, budget=60.0)).status.value


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("√(1+ε) ≈ 1 + ε/2", "√(1+ε) ≈ 1 + ε/3"),
        ("√(1+ε) ≃ 1 + ε/2", "√(1+ε) ≃ 1 - ε/2"),
        (
            r"\sqrt{1+\epsilon} = 1+\frac{\epsilon}{2}+O(\epsilon^2)",
            r"\sqrt{1+\epsilon} = 1+\frac{\epsilon}{3}+O(\epsilon^2)",
        ),
        (
            r"$\sqrt{1+\epsilon} \simeq 1+\frac{\epsilon}{2}$",
            r"$\sqrt{1+\epsilon} \simeq 1-\frac{\epsilon}{2}$",
        ),
        (r"(1+\epsilon)^{1/2} \approx 1+\frac12\epsilon", r"(1+\epsilon)^{1/2} \approx 1+\frac13\epsilon"),
        ("sqrt(1+eps) = 1 + eps/2 + ...", "sqrt(1+eps) = 1 + eps/3 + ..."),
        ("√(1+ε) = 1 + ε/2 - ε²/8 + O(ε³) ≈ 1 + ε/2", "√(1+ε) = 1 + ε/2 - ε²/8 + O(ε³) ≈ 1 - ε/2"),
        ("f = √(1+ε) ≈ 1 + ε/2 = 1 + 0.5ε", "f = √(1+ε) ≈ 1 + ε/2 = 1 + 0.6ε"),
        ("f ≈ 1 + ε/2", "f ≈ 1 + ε/3"),
    ],
)
def test_an_expansion_is_what_stands_behind_the_last_sign(right, wrong):
    assert said("first-order", ROOT, right) == "holds"
    assert said("first-order", ROOT, wrong) == "fails"


@pytest.mark.parametrize("claim", ["1 + ε/2 ≈ √(1+ε)", "1 + ε/3 ≈ √(1+ε)"])
def test_an_expansion_that_stands_first_is_asked_about(claim):
    with pytest.raises(InvalidClaim, match="which side is the answer"):
        said("first-order", ROOT, claim)


def test_an_equality_sign_still_says_what_it_says():
    assert said("first-order", ROOT, "√(1+ε) = 1 + ε/2") == "fails"


@pytest.mark.parametrize(
    "right",
    [
        "θ'' = -(g/l) sin θ ≈ -(g/l) θ",
        "sin θ ≈ θ, so θ'' + (g/l) θ = 0",
        "sin θ ≈ θ\nθ'' + (g/l) θ = 0",
        "θ'' + (g/l) sin θ = 0, sin θ ≈ θ ⇒ θ'' + (g/l) θ = 0",
        "θ'' + (g/l) θ = 0 (sin θ ≈ θ)",
        "θ'' + (g/l) θ = 0 (sin(θ) ≈ θ, cos(θ) ≈ 1)",
        "θ'' + (g/l) θ = 0, where sin θ ≈ θ",
        "θ'' + (g/l) θ = 0 for sin θ ≈ θ",
        "θ'' + (g/l) sin θ ≈ θ'' + (g/l) θ = 0",
        "l θ'' = -g sin θ ≈ -g θ ⇒ θ'' = -(g/l) θ",
        "θ'' ≈ -(g/l) θ",
        r"\ddot\theta = -\frac gl\sin\theta \simeq -\frac gl\theta = -\frac{g\theta}{l}",
        r"\sin\theta\approx\theta \Rightarrow \ddot\theta+\frac{g}{l}\theta=0",
        r"$\sin\theta\approx\theta$, so $\ddot\theta+\frac{g}{l}\theta=0$",
        r"\ddot\theta + \frac gl \theta = 0 \quad (\sin\theta\approx\theta)",
        r"$\ddot\theta + \frac gl \theta = 0$ where $\sin\theta\approx\theta$",
        r"\ddot\theta + \frac gl \theta = 0 \quad \text{for } \sin\theta\approx\theta",
    ],
)
def test_steps_of_a_linearisation_are_passed_over(right):
    assert said("linearisation", PENDULUM, right) == "holds"
    for sign, other in (
        (r"\frac gl\theta", r"\frac gl\theta\cdot 3"),
        (r"\frac{g}{l}\theta", r"3\frac{g}{l}\theta"),
        (r"\frac gl \theta", r"3\frac gl \theta"),
        ("(g/l) θ", "(g/l) 3*θ"),
    ):
        wrong = right.replace(sign, other)
        if wrong != right:
            assert said("linearisation", PENDULUM, wrong.replace(") 3*θ", ")*3*θ")) == "fails"


@pytest.mark.parametrize("wrong", ["sin θ ≈ θ", "θ'' = -(g/l) sin θ", "θ'' = -(g/l) sin θ ≈ (g/l) θ"])
def test_what_is_not_the_linear_equation_fails(wrong):
    assert said("linearisation", PENDULUM, wrong) == "fails"


def test_what_is_passed_over_is_told():
    claim = claim_from(
        {"id": "a", "kind": "linearisation", **PENDULUM, "claim": "sin θ ≈ θ, so θ'' + (g/l) θ = 0"}
    )
    told = list(judgements(claim))[-1][0].warnings
    assert "sin θ = θ, so in claim is passed over: what stands behind ≈ is judged" in told


def test_nothing_is_nearly_equal_where_an_exact_answer_is_asked_for():
    with pytest.raises(InvalidClaim, match="write = for an equation"):
        said("euler-lagrange", {"q": ["x"], "L": "x_dot**2/2 - 2*x**2"}, "x'' = -4x ≈ -5x")
