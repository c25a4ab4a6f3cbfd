"""The law of feedback: a claim with what was told put into it is judged to hold, from its first question on."""

from pathlib import Path

import pytest

from canon.exercise.diagnosis import judged_to_hold
from canon.exercise.feedback import diagnosis
from canon.exercise.judge import examine
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
