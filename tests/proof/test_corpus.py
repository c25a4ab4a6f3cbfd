"""The corpus of identities: no wrong verdict, nearly every true one proved, every false one refuted."""

import sys
from pathlib import Path

import pytest

from canon.proof import Domain, equal

sys.path.insert(0, str(Path(__file__).parents[2]))
from tests.data.identities.load import identities

UNPROVED_AT_MOST = 0.02
"""Share of true identities that may stay undecided."""


def verdicts(chosen):
    for identity in chosen:
        domain = Domain(conditions=identity.conditions, box=identity.box)
        yield identity, equal(identity.lhs, identity.rhs, domain, budget=5.0)


def test_no_verdict_is_wrong_where_branches_matter():
    for identity, verdict in verdicts(identities("inverse_functions", "null_sets", "piecewise")):
        assert verdict.undecided or verdict.holds == identity.truth, identity.id


@pytest.mark.slow
def test_whole_corpus():
    wrong, unproved, unrefuted, true = [], [], [], 0
    for identity, verdict in verdicts(identities()):
        true += identity.truth
        if verdict.undecided:
            (unproved if identity.truth else unrefuted).append(identity.id)
        elif verdict.holds != identity.truth:
            wrong.append(identity.id)
    assert wrong == []
    assert unrefuted == []
    assert len(unproved) <= UNPROVED_AT_MOST * true, unproved
