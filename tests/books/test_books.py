"""Results of textbooks by section, each verdict as the reader of the book expects it; wrong twins fail."""

import re
from pathlib import Path

import pytest

from canon import judge, read_sheet

SHEETS = sorted((Path(__file__).parents[2] / "examples" / "sheets" / "books").glob("*.toml"))
CLAIMS = {path.stem: read_sheet(path).claims for path in SHEETS}
RESULTS = {
    "arnold": 61,
    "ferraz_mello": 46,
    "goldstein": 150,
    "hairer_lubich_wanner": 87,
    "hand_finch": 58,
    "jose_saletan": 66,
    "landau_lifshitz": 142,
    "lichtenberg_lieberman": 40,
    "sussman_wisdom": 77,
    "taylor": 77,
}
"""How many results of each book are claims; the twins are not counted."""

QUICK = re.compile(
    r"arnold-14-|goldstein-9\.2|hand_finch-1\.9|lichtenberg_lieberman-4\.|ferraz_mello-C|jose_saletan-4\.2|landau_lifshitz-14-2|sussman_wisdom-1\.10|taylor-11\.2"
)
"""Sections that are judged in every run; the others in the slow one."""


def _is_twin(claim):
    return re.search(r"-wrong\d*$", claim.id) is not None


@pytest.mark.parametrize(
    "claim",
    [
        pytest.param(
            claim,
            id=f"{book}-{claim.id}",
            marks=() if QUICK.match(f"{book}-{claim.id}") else pytest.mark.slow,
        )
        for book, claims in CLAIMS.items()
        for claim in claims
    ],
)
def test_the_verdict_is_the_books(claim):
    assert judge(claim).status.value == claim.expect


def test_the_books_are_there():
    assert {book: sum(not _is_twin(claim) for claim in claims) for book, claims in CLAIMS.items()} == RESULTS


@pytest.mark.parametrize("book", CLAIMS)
def test_every_accepted_claim_has_a_wrong_twin(book):
    """The twin ``X-wrong`` of ``X`` asks the same kind of question and differs in something."""
    claims = {claim.id: claim for claim in CLAIMS[book]}
    for claim in claims.values():
        if claim.expect == "holds":
            twin = claims[f"{claim.id}-wrong"]
            assert (twin.kind, twin.expect) == (claim.kind, "fails")
            told = {"source", "expect"}
            assert {k: v for k, v in claim.keys.items() if k not in told} != {
                k: v for k, v in twin.keys.items() if k not in told
            }
        if _is_twin(claim):
            assert claims[re.sub(r"-wrong\d*$", "", claim.id)].expect == "holds"


@pytest.mark.parametrize("book", CLAIMS)
def test_claims_are_named_by_the_section_of_the_book(book):
    """``pytest -k "goldstein and 9.3"`` runs what a section says."""
    for claim in CLAIMS[book]:
        section = re.match(r"(?:[IVX]+\.)?[\d.]+|[A-D](?=-)", claim.id)
        assert section, claim.id
        told = re.match(
            r"(?:§ |chapter |theorem |appendix )((?:[IVX]+\.)?\d+(?:\.\d+)*|[A-D])", claim.keys["source"]
        )
        assert told, claim.keys["source"]
        here, there = section[0].split("."), told[1].split(".")
        assert here[: len(there)] == there[: len(here)], claim.id
