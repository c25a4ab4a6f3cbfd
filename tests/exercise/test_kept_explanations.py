"""What is said of a wrong answer is said again of the same one in another order, and of no other."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import pytest

from canon.exercise import Claim
from canon.exercise.claim_verdict import examine
from canon.exercise.diagnose.kept_explanations import (
    LONGEST,
    MOST_KEPT,
    Explanation,
    KeptExplanations,
    meaning,
)
from canon.exercise.explained_judgement import judgements

PENDULUM = {
    "q": ["theta"],
    "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)",
    "parameters": {"m": "positive", "g": "positive", "l": "positive"},
}
SAME = (
    "m*l**2*theta_ddot - m*g*l*sin(theta)",
    "-sin(theta)*l*g*m + theta_ddot*m*l**2",
    "l*m*(l*theta_ddot) - g*(l*m)*sin(theta)",
    r"$m l^2 \ddot\theta - m g l \sin\theta$",
)
OTHERS = (
    "m*l**2*theta_ddot - 2*m*g*l*sin(theta)",
    "m*l**2*theta_ddot + m*g*l*cos(theta)",
    "m*l**2*theta_ddot = m*g*l*sin(theta)",
    "m*l*theta_ddot - m*g*sin(theta)",
)


def pendulum(answer: str, name: str = "a", **more: object) -> Claim:
    return Claim(name, "euler-lagrange", {**PENDULUM, "claim": [answer], **more})


def told(claim: Claim, kept: KeptExplanations | None = None) -> object:
    return replace(list(judgements(claim, kept))[-1][0], seconds=0.0)


def test_every_judgement_is_the_one_that_a_claim_gets_alone():
    kept = KeptExplanations()
    for number, answer in enumerate((*SAME, *OTHERS, *SAME, *OTHERS)):
        claim = pendulum(answer, f"student {number}")
        assert told(claim, kept) == told(claim)


def test_the_same_answer_in_another_order_is_looked_for_once():
    kept = KeptExplanations()
    assert len(list(judgements(pendulum(SAME[0]), kept))) == 3
    for answer in SAME[1:]:
        assert len(list(judgements(pendulum(answer), kept))) == 2  # no step between verdict and feedback
    assert len(list(judgements(pendulum(OTHERS[0]), kept))) == 3


@pytest.mark.parametrize(
    ("one", "other"),
    [
        *combinations((pendulum(SAME[0]), *map(pendulum, OTHERS)), 2),
        (pendulum(SAME[0]), pendulum(SAME[0], parameters={**PENDULUM["parameters"], "g": "real"})),
        (pendulum(SAME[0]), pendulum(SAME[0], domain=["theta > 0"])),
        (pendulum(SAME[0]), pendulum(SAME[0], L="m*l**2*theta_dot**2/2 + 2*m*g*l*cos(theta)")),
        (pendulum(SAME[0]), pendulum(SAME[0], complete=True)),
        (pendulum(SAME[0]), pendulum(SAME[0], partial=True)),
    ],
)
def test_another_answer_or_question_has_another_meaning(one, other):
    assert meaning(examine(one)) != meaning(examine(other))


def test_a_name_and_a_product_are_not_the_same_words():
    keys = {"lhs": "u", "parameters": {"u": "real", "ab": "real", "a": "real", "b": "real"}}
    one, other = (Claim("a", "equality-only", {**keys, "rhs": rhs}) for rhs in ("ab*1", "a*b"))
    assert meaning(examine(one)) != meaning(examine(other))


def test_the_oldest_is_dropped_and_what_is_too_long_is_not_kept():
    kept = KeptExplanations()
    for number in range(MOST_KEPT + 1):
        kept.keep(number, Explanation("", str(number)))
    kept.keep(None, Explanation("", "of a long claim"))
    assert kept.of(0) is None
    assert kept.of(1) is not None
    assert kept.of(None) is None
    assert meaning(examine(pendulum(f"{SAME[0]} + {'+'.join(['0*m'] * LONGEST)}"))) is None


def test_the_share_is_said_again_and_points_do_not_matter():
    kept = KeptExplanations()
    for points, answer in enumerate(SAME, 1):
        found = told(pendulum(answer, partial=True, points=points), kept)
        assert found == told(pendulum(answer, partial=True, points=points))
        assert found.share == 0.5
        assert found.points == points
    assert told(pendulum(SAME[0]), kept).share is None
