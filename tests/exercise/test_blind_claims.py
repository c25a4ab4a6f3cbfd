"""Blind claims of all kinds, 1 800 of them, labelled by who had not seen canon: no verdict is wrong, few are open."""

from pathlib import Path

import pytest

from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import read_sheet

SHEETS = sorted((Path(__file__).parents[1] / "data").glob("blind_claims/*/*.*"))
UNDECIDED = {"H3-EQ-70", "X-EQ-45", "X-EQ-47", "X-EQ-51"}
"""What canon can't decide yet; a claim that leaves this list is progress, one that joins it is a regression."""


@pytest.mark.slow
@pytest.mark.parametrize("sheet", SHEETS, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_verdicts(sheet):
    """The first judgement on a claim is its verdict; what a wrong answer is told is asked in test_slips.py."""
    claims = read_sheet(sheet).claims
    verdicts = {claim.id: next(judgements(claim))[0].status for claim in claims}
    expected = {claim.id: "undecided" if claim.id in UNDECIDED else claim.expect for claim in claims}
    assert verdicts == expected
