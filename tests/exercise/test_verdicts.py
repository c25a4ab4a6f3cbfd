"""Every claim in tests/data/claims gets the verdict its author expects, and every true one has a wrong twin."""

from pathlib import Path

import pytest

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.kinds import KINDS
from canon.exercise.sheet.sheet import read_sheet

CLAIMS = Path(__file__).parent.parent / "data" / "claims"
SUBTLE = CLAIMS.parent / "subtle_claims.json"
SHEETS = {path.stem: read_sheet(path) for path in sorted(CLAIMS.glob("*.json"))}


@pytest.mark.parametrize(
    "claim", [pytest.param(c, id=f"{kind}:{c.id}") for kind, sheet in SHEETS.items() for c in sheet.claims]
)
def test_the_verdict_is_right(claim):
    verdict = judge(claim)
    assert verdict.status.value == claim.expect, str(verdict)
    if verdict.fails:
        assert verdict.counterexample is not None or verdict.certificate in ("exact", "structure")


@pytest.mark.parametrize("claim", [pytest.param(c, id=c.id) for c in read_sheet(SUBTLE).claims])
def test_subtle_claims(claim):
    """Right or wrong on a branch, at a kink, by a term of 10⁻³⁰, on one part of a manifold only; and long ones."""
    verdict = judge(claim)
    assert verdict.status.value == claim.expect, str(verdict)


def test_every_kind_has_true_and_false_claims():
    assert set(SHEETS) == set(KINDS)
    for kind, sheet in SHEETS.items():
        assert not sheet.errors
        assert {claim.kind for claim in sheet.claims} == {kind}
        assert sum(claim.expect == "holds" for claim in sheet.claims) >= 5, kind
        assert sum(claim.expect == "fails" for claim in sheet.claims) >= 5, kind


def test_every_true_claim_has_a_wrong_twin():
    for sheet in SHEETS.values():
        false = {claim.id.rstrip("abcdefgh") for claim in sheet.claims if claim.expect == "fails"}
        true = {claim.id for claim in sheet.claims if claim.expect == "holds"}
        assert true <= false, true - false


def test_what_is_expected_is_not_looked_at():
    """Judged with every expectation reversed, the verdicts are the same."""
    for sheet in SHEETS.values():
        for claim in sheet.claims[:4]:
            lying = type(claim)(claim.id, claim.kind, {**claim.keys, "expect": "maybe"}, budget=claim.budget)
            assert judge(lying).status.value == claim.expect
