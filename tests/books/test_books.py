"""Formulas of four textbooks by section, each verdict as the reader of the book expects it; wrong twins fail."""

import re
from pathlib import Path

import pytest

from canon import judge, read_sheet

SHEETS = sorted((Path(__file__).parents[2] / "examples" / "sheets" / "books").glob("*.toml"))
CLAIMS = [
    pytest.param(claim, id=f"{path.stem}-{claim.id}") for path in SHEETS for claim in read_sheet(path).claims
]


def test_the_books_are_there():
    assert [path.stem for path in SHEETS] == [
        "goldstein", "hairer_lubich_wanner", "landau_lifshitz", "sussman_wisdom",
    ]  # fmt: skip
    assert len(CLAIMS) >= 77


@pytest.mark.parametrize("claim", CLAIMS)
def test_the_verdict_is_the_books(claim):
    assert claim.keys["source"], "every claim names its section"
    assert judge(claim).status.value == claim.expect


@pytest.mark.parametrize("path", SHEETS, ids=lambda path: path.stem)
def test_claims_are_named_by_the_section_of_the_book(path):
    """``pytest -k "goldstein and 9.3"`` runs what a section says."""
    named = 0
    for claim in read_sheet(path).claims:
        section = re.match(r"(?:[IVX]+\.)?[\d.]+", claim.id)
        assert section, claim.id
        told = re.search(r"(?:§ |chapter )((?:[IVX]+\.)?\d+(?:\.\d+)*)", claim.keys["source"])
        if told:  # the others go on from the claim before: "and", "the same with"
            here, there = section[0].split("."), told[1].split(".")
            assert here[: len(there)] == there[: len(here)], claim.id
            named += 1
    assert named >= 5
