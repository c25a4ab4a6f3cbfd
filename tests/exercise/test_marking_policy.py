"""Marks: only what was proved is right, only what was refuted is wrong, and the rest is no zero."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from canon.exercise import Judgement, JudgePool, MarkingPolicy, Outcome
from canon.exercise.sheet.kinds import KINDS

PENDULUM = {
    "id": "a",
    "kind": "euler-lagrange",
    "q": ["theta"],
    "parameters": {"m": "positive", "l": "positive", "g": "positive"},
    "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)",
}
RIGHT = {**PENDULUM, "claim": ["theta'' + g/l*sin(theta) = 0"]}


@pytest.fixture(scope="module")
def pool():
    with JudgePool(workers=1, warm=False) as made:
        yield made


@pytest.mark.parametrize(
    ("claim", "outcome", "points", "told"),
    [
        (RIGHT, Outcome.RIGHT, 2.0, "right"),
        ({**RIGHT, "claim": ["theta'' - g/l*sin(theta) = 0"]}, Outcome.WRONG, -0.5, "wrong"),
        ({**RIGHT, "claim": ["theta'' + g/l*sin(theta"]}, Outcome.UNREADABLE, None, "column"),
        ({**RIGHT, "claim": ["theta'' + k*theta = 0"]}, Outcome.UNREADABLE, None, "k is not declared"),
        ({**RIGHT, "claim": []}, Outcome.UNREADABLE, None, "the answer is empty"),
        ({**RIGHT, "L": "m*l**2*theta_dot**2/2 + ("}, Outcome.UNDECIDED, None, "the question has a mistake"),
        ({**RIGHT, "L": "(", "claim": ["("]}, Outcome.UNDECIDED, None, "the question has a mistake"),
        ({**RIGHT, "masses": ["m"]}, Outcome.UNDECIDED, None, "the question has a mistake"),
        ({**RIGHT, "kind": "euler"}, Outcome.UNDECIDED, None, "the question has a mistake"),
        ({**RIGHT, "claim": ["theta'' = key L"]}, Outcome.UNREADABLE, None, "column"),
    ],
)
def test_what_canon_says_of_an_answer_is_marked(pool, claim, outcome, points, told):
    mark = MarkingPolicy(right=2.0, wrong=-0.5).mark(pool.judge(claim))
    assert (mark.outcome, mark.points) == (outcome, points)
    assert told in mark.sentence
    assert mark.asks_again == (outcome is Outcome.UNREADABLE)
    assert mark.needs_a_person == (outcome is Outcome.UNDECIDED)


def test_where_the_answer_stands_can_be_said(pool):
    """In a question about an equality the answer may be its left side."""
    keys = {"id": "a", "kind": "equality-only", "lhs": "x +", "rhs": "x", "parameters": {"x": "real"}}
    judgement = pool.judge(keys)
    assert MarkingPolicy().mark(judgement).needs_a_person
    assert MarkingPolicy().mark(judgement, ["lhs"]).asks_again


KIND = st.sampled_from([*KINDS, "unreadable sheet", ""])
STATUS = st.sampled_from(["holds", "fails", "undecided", "invalid"])


@given(
    STATUS,
    st.sampled_from([*KINDS, "unreadable sheet", ""]),
    st.text(max_size=60),
    st.sampled_from(["", "key L, ", "key claim[0]: "]),
)
def test_a_mark_is_given_exactly_where_something_was_decided(status, kind, text, place):
    """Whatever is told: no verdict, no points; and nothing but a proof is right."""
    mark = MarkingPolicy().mark(Judgement("a", kind, status, known=place + text, feedback=text))
    assert (mark.points is not None) == (status in ("holds", "fails"))
    assert (mark.outcome is Outcome.RIGHT) == (status == "holds")
    assert (mark.outcome is Outcome.WRONG) == (status == "fails")
    assert mark.sentence


def test_a_wrong_answer_is_worth_less():
    with pytest.raises(ValueError, match="worth more than a wrong one"):
        MarkingPolicy(right=1.0, wrong=1.0)
    with pytest.raises(ValueError, match="worth more than a wrong one"):
        MarkingPolicy(right=float("nan"))
