"""The corpus of identities: it can be read, it is paired, and its labels stand a numerical check."""

from __future__ import annotations

import random
from collections import Counter
from typing import Any

import mpmath as mp
import pytest

from tests.data.identities import verify
from tests.data.identities.load import ASSUMPTIONS, entries, identities, subjects

ENTRIES = [entry for subject in subjects() for entry in entries(subject)]
KEYS = {"id", "title", "lhs", "rhs", "symbols", "conditions", "box", "functions", "truth"}


def stem(entry: dict[str, Any]) -> str:
    """Return the id of the true identity that a false one is the twin of."""
    return entry["id"].rpartition("-")[0]


def test_the_corpus_is_as_large_as_promised() -> None:
    truths = Counter(entry["truth"] for entry in ENTRIES)
    assert truths[True] >= 250
    assert truths[False] >= 250


def test_ids_name_one_entry_each() -> None:
    assert [name for name, times in Counter(entry["id"] for entry in ENTRIES).items() if times > 1] == []


def test_entries_have_known_keys_and_assumptions() -> None:
    for entry in ENTRIES:
        assert set(entry) <= KEYS, entry["id"]
        assert set(entry["symbols"].values()) <= set(ASSUMPTIONS), entry["id"]
        assert set(entry.get("box", {})) <= set(entry["symbols"]), entry["id"]


def test_every_true_identity_has_a_false_twin_and_every_false_one_a_true_stem() -> None:
    true = {entry["id"] for entry in ENTRIES if entry["truth"]}
    assert {stem(entry) for entry in ENTRIES if not entry["truth"]} == true


@pytest.mark.parametrize("subject", subjects())
def test_the_language_reads_every_entry(subject: str) -> None:
    read = identities(subject)
    assert len(read) == len(entries(subject))
    for identity in read:
        assert not any(condition in (True, False) for condition in identity.conditions), identity.id
        if not identity.truth:
            assert identity.lhs != identity.rhs, identity.id


def test_a_sample_of_the_labels_stands_a_numerical_check() -> None:
    for entry in random.Random(3).sample(ENTRIES, 30):
        complaint, _, _ = verify.verdict(entry, points_wanted=25)
        assert complaint == "", entry["id"]


@pytest.mark.slow
@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry["id"])
def test_every_label_stands_a_numerical_check(entry: dict[str, Any]) -> None:
    complaint, _, _ = verify.verdict(entry)
    assert complaint == ""


def test_the_numerical_check_notices_turned_labels() -> None:
    for name in ("root-of-square", "root-of-square-a", "cosh-square", "cosh-square-a", "lambert-xexpx-a"):
        entry = next(entry for entry in ENTRIES if entry["id"] == name)
        complaint, _, _ = verify.verdict({**entry, "truth": not entry["truth"]}, points_wanted=25)
        assert complaint.startswith("called ")


def test_the_numerical_check_refuses_what_is_not_in_the_language() -> None:
    entry = {"id": "x", "lhs": "x.real", "rhs": "0", "symbols": {"x": "real"}, "truth": True}
    with pytest.raises(ValueError, match="not in the language"):
        verify.verdict(entry)


def test_the_stand_in_for_an_arbitrary_function_knows_its_derivatives() -> None:
    f = verify.arbitrary(2, random.Random(1))
    x, y = mp.mpf("0.3"), mp.mpf("-0.7")
    with mp.workdps(60):
        for orders in ((1, 0), (0, 2), (1, 1), (2, 1), (3, 0)):
            assert mp.almosteq(f.derivative((x, y), orders), mp.diff(f, (x, y), orders), 1e-50)
