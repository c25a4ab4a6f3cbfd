"""Points: what is proved of a wrong answer has its share, and nothing else has."""

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from canon.exercise import Judgement, MarkingPolicy, check
from canon.exercise.diagnose.effort import BudgetSpent
from canon.exercise.diagnose.proved_share import share_of_terms
from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import Sheet, claim_from

SIGNS = {"m": "positive", "k": "positive", "g": "positive", "l": "positive"}
H = {"kind": "legendre-hamiltonian", "q": ["x", "y"], "p": ["p_x", "p_y"],
     "L": "m*(x_dot**2 + y_dot**2)/2 - k*x**2/2 - m*g*y"}  # fmt: skip
HE = {"kind": "hamilton-equations", "q": ["x", "y"], "p": ["p_x", "p_y"],
      "H": "(p_x**2 + p_y**2)/(2*m) + k*x**2/2 + m*g*y", "q_dot": ["p_x/m", "p_y/m"]}  # fmt: skip
EL = {"kind": "euler-lagrange", "q": ["x", "y"], "L": H["L"]}


def judged(question, **keys):
    claim = claim_from({"id": "a", "parameters": SIGNS, "points": 4, "partial": True, **question, **keys})
    assert not claim.errors
    return [judgement for judgement, _ in judgements(claim)][-1]


@pytest.mark.parametrize(
    ("question", "answer", "share"),
    [
        (H, {"H": "p_x**2/(2*m) + p_y**2/(2*m) + k*x**2/2 + m*g*y"}, 1),
        (H, {"H": "p_x**2/(2*m) + p_y**2/(2*m) + k*x**2/2 - m*g*y"}, Fraction(3, 4)),
        (H, {"H": "p_x**2/(2*m) + p_y**2/(2*m) + k*x**2/2"}, Fraction(3, 4)),
        (H, {"H": "-(p_x**2/(2*m) + p_y**2/(2*m) + k*x**2/2 + m*g*y)"}, 0),
        (H, {"H": "l*x**7 + g*exp(p_x)"}, 0),
        (HE, {"p_dot": ["-k*x", "m*g"]}, Fraction(3, 4)),
        (HE, {"p_dot": ["-k*x", "-m*g"]}, 1),
        (HE, {"p_dot": ["k*x", "m*g"]}, Fraction(1, 2)),
        (EL, {"claim": ["m*x'' + k*x = 0", "y'' = g"]}, Fraction(3, 4)),
        (EL, {"claim": ["m*x'' + k*x = 0", "0 = 0", "0 = 0", "y'' = g"]}, 0),
    ],
)  # fmt: skip
def test_the_share_is_what_stands_in_an_answer_that_holds(question, answer, share):
    judgement = judged(question, **answer)
    assert judgement.status == ("holds" if share == 1 else "fails")
    assert judgement.share == pytest.approx(float(share))
    assert judgement.earned == pytest.approx(4 * float(share))


def test_without_partial_a_wrong_answer_has_nothing():
    wrong = {"H": "p_x**2/(2*m) + p_y**2/(2*m) + k*x**2/2"}
    assert judged(H, partial=False, **wrong).share == 0
    bare = claim_from({"id": "a", "parameters": SIGNS, **H, **wrong})
    *_, (judgement, _) = judgements(bare)
    assert (judgement.points, judgement.share, judgement.earned) == (None, None, None)


def test_what_is_not_known_has_no_share(monkeypatch):
    def spent(*_):
        raise BudgetSpent

    assert judged(H, H="p_x**2 +").earned is None
    assert judged(H, H="p_x**2 +").points == 4
    monkeypatch.setattr("canon.exercise.diagnose.diagnosis_search.diagnosis", spent)
    cut = judged(H, H="p_x**2/(2*m)")
    assert (cut.status, cut.share) == ("fails", None)


def test_a_report_adds_them_and_says_so():
    keys = {"parameters": SIGNS, "points": 2, "partial": True}
    wrong = {**H, **keys, "H": "p_x**2/(2*m) + p_y**2/(2*m) + k*x**2/2 - m*g*y"}
    claims = [claim_from({"id": name, **claim}) for name, claim in
              [("a", wrong), ("b", {**wrong, "H": "(p_x"}), ("c", {**wrong, "partial": False})]]  # fmt: skip
    report = check(Sheet("three", tuple(claims)))
    assert (report.earned, report.out_of) == (1.5, 6.0)
    assert "1.5 of 6 points, 2 of them open" in report.summary
    assert "1.5 of 2 points: 75% of the answer is proved to be right" in str(report)
    assert Judgement.from_dict(report.judgements[0].to_dict()).share == 0.75
    assert '"earned": 1.5' in report.json_lines()
    assert '"out_of": 6.0' in report.to_json()


@pytest.mark.parametrize("points", [0, -1, 10**7, "two", True])
def test_points_are_numbers_above_nothing(points):
    assert claim_from({"id": "a", "kind": "equality-only", "lhs": "1", "rhs": "1", "points": points}).errors


def test_a_policy_gives_the_share():
    policy = MarkingPolicy(right=2.0, wrong=-1.0)
    mark = policy.mark(Judgement("a", "equality-only", "fails", feedback="a sign", points=1, share=0.5))
    assert (mark.points, mark.sentence) == (0.5, "a sign; 50% of it is proved to be right")
    assert policy.mark(Judgement("a", "equality-only", "fails")).points == -1.0


TERMS = st.lists(st.sampled_from(sp.symbols("a b c d e f")), unique=True, min_size=1, max_size=6)


@given(TERMS, TERMS)
def test_shares_of_terms(here, there):
    share = share_of_terms(sp.Add(*here), sp.Add(*there))
    assert (share == 1) == (set(here) == set(there))
    assert share == share_of_terms(sp.Add(*there), sp.Add(*here))
    assert share == Fraction(len({*here} & {*there}), max(len(here), len(there)))
