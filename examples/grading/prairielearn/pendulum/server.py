"""PrairieLearn: the answer is judged when it is parsed, so what can't be read is asked again and costs no attempt."""

import canon
from canon.exercise import MarkingPolicy

QUESTION = {
    "id": "answer",
    "kind": "euler-lagrange",
    "q": ["theta"],
    "parameters": {"m": "positive", "l": "positive", "g": "positive"},
    "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)",
}


class ForAPerson(Exception):
    """Raised for what canon can't decide: PrairieLearn then marks nothing and shows the course staff an issue."""


def marked(data):
    answer = str(data["submitted_answers"].get("answer", ""))
    (mark,) = MarkingPolicy().marks(canon.check([{**QUESTION, "claim": [answer]}], budget=5.0))
    return mark


def parse(data):
    """Ask again for what can't be read: an answer with a format error is not graded."""
    mark = marked(data)
    if mark.asks_again:
        data["format_errors"]["answer"] = mark.sentence


def grade(data):
    """Mark what could be read."""
    mark = marked(data)
    if mark.points is None:
        raise ForAPerson(mark.sentence)
    data["partial_scores"]["answer"] = {"score": mark.points, "weight": 1}
    data["score"] = mark.points
    data["feedback"]["answer"] = mark.sentence
