"""A test of Otter's for one answer: ``grader.check("q1")`` tells whether it can be read, before it is handed in."""

from otter.test_files import test_case

import canon
from canon.exercise import MarkingPolicy

OK_FORMAT = False
name = "q1"
points = 1

QUESTION = {
    "id": "q1",
    "kind": "euler-lagrange",
    "q": ["theta"],
    "parameters": {"m": "positive", "l": "positive", "g": "positive"},
    "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)",
}


@test_case(name="the equation of motion", points=1)
def the_equation_of_motion(answer):
    (mark,) = MarkingPolicy().marks(canon.check([{**QUESTION, "claim": [str(answer)]}], budget=10))
    # gradescope/set_aside.py finds what this says
    assert mark.points is not None, f"canon: {mark.outcome.value}: {mark.sentence}"
    assert mark.points > 0, mark.sentence
