"""The law of feedback: a claim with what was told put into it is judged to hold, from its first question on."""

from pathlib import Path

import pytest

from canon.exercise.diagnosis import judged_to_hold
from canon.exercise.feedback import corrected, diagnosis
from canon.exercise.judge import examine
from canon.exercise.judging import judgements
from canon.exercise.sheet import Claim, read_sheet

ROOT = Path(__file__).parents[2]
SEEDS = sorted((ROOT / "examples" / "sheets" / "seeds").glob("*.toml"))
DATA = [
    *sorted((ROOT / "tests" / "data" / "claims").glob("*.json")),
    *sorted((ROOT / "tests" / "data").glob("subtle*.json")),
]
SEED = {c.id: c for path in SEEDS for c in read_sheet(path).claims}
STATEMENTS = (
    "an equation is missing",
    "must be eliminated",
    "singular",
    "∂F/∂t",
    "opposite sign of a rule",
    "not affine",
    "depends on",
    "does not follow",
    "exchange Q and P",
    "multiply P",
    "nothing simple mends the map",
    "momenta stand in the wrong order",
    "right only for small",
)
"""What is told without anything to put into the claim."""


def told(claim, seconds=1.0):
    finding = examine(claim)
    return diagnosis(finding, seconds) if finding.verdict.fails else None


def break_of_the_law(claim):
    """Return what was told of a claim although it does not hold with that put in."""
    found = told(claim)
    if found is None:
        return None
    if found.repaired is None:
        return None if any(text in found.sentence for text in STATEMENTS) else found.sentence
    assert found.repaired.claim.id == claim.id
    return None if judged_to_hold(found.repaired, 10.0) else found.sentence


def test_an_equation_that_doubles_another_one_is_no_repair():
    """Both equations of motion would be that of z; the one for r would be missing."""
    assert told(SEED["routh-cylindrical-eom-r"]) is None


@pytest.mark.parametrize("path", [pytest.param(p, id=p.stem) for p in SEEDS if "lagrange" in p.stem])
def test_every_repair_of_a_seed_holds_as_a_whole(path):
    broken = {c.id: break_of_the_law(c) for c in read_sheet(path).claims if c.expect != "holds"}
    assert not any(broken.values()), {k: v for k, v in broken.items() if v}


@pytest.mark.slow
@pytest.mark.parametrize("path", [pytest.param(p, id=p.stem) for p in (*SEEDS, *DATA)])
def test_every_repair_of_a_claim_holds_as_a_whole(path):
    broken = {c.id: break_of_the_law(c) for c in read_sheet(path).claims if c.expect != "holds"}
    assert not any(broken.values()), {k: v for k, v in broken.items() if v}


def test_a_slip_behind_a_derivative_is_passed_over():
    keys = {"lhs": "Derivative(A(x), x)*x", "rhs": "Derivative(A(x), x)*x**5 + sin(x) + exp(x)"}
    assert (
        told(Claim("d", "equality-only", {**keys, "functions": {"A": ["x"]}, "parameters": {"x": "real"}}))
        is None
    )


def test_routhian_feedback_speaks_of_momenta():
    """The slips stand in the student's momenta, not in the velocities of the ignorable coordinates."""
    assert told(SEED["routh-cylindrical-eom-r-read-as"], 6.0).sentence == (
        "in equation 1 the sign of P0**2/(m*r**3) is wrong"
    )
    keys = dict(SEED["routh-cylindrical-eom-r-read-as"].keys)
    lost = Claim("lost", "routhian", {**keys, "claim": ["m*r_ddot", "z_ddot + g"]})
    assert told(lost, 6.0).sentence == "in equation 1 the term -P0**2/(m*r**3) is missing"
    assert "theta" not in corrected(examine(lost))
    assert "P0**2" in corrected(examine(lost))


GENERATED = {
    c.id: c for k in "1234" for c in read_sheet(ROOT / f"tests/data/claims/generating-F{k}.json").claims
}


@pytest.mark.parametrize("name", ["F1-02a", "F1-08b", "F2-05a", "F3-01a", "F3-06a", "F4-03a", "F4-05a"])
def test_the_right_generating_function_is_shown(name, monkeypatch):
    """By the map and by the inverse map; the claim with it put in holds."""
    monkeypatch.setattr("canon.exercise.generating_answer.SECONDS", 10.0)  # on a busy machine too
    claim = GENERATED[name]
    shown = corrected(examine(claim))
    assert shown
    right = Claim(name, claim.kind, {**claim.keys, "F": shown}, budget=claim.budget)
    assert examine(right).verdict.holds


def test_the_right_answer_is_told_before_the_diagnosis_is_looked_for():
    steps = [judgement for judgement, _ in judgements(GENERATED["F1-02a"])]
    assert [bool(s.corrected) for s in steps] == [False, True, True]
    assert [bool(s.feedback) for s in steps] == [False, False, True]
