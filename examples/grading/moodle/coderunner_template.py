"""CodeRunner: the template of a question with a combinator template grader, on a Jobe server that has canon.

CodeRunner must be given a fraction. What has no mark yet gets 0 there and says so; mark_responses.py then tells from
the downloaded responses whose 0 is none. With Precheck on, students see whether an answer can be read before it counts.
"""

import html
import json

import canon
from canon.exercise import MarkingPolicy

ANSWER = """{{ STUDENT_ANSWER | e('py') }}"""
PRECHECK = "{{ IS_PRECHECK }}" == "1"
QUESTION = {
    "id": "answer",
    "kind": "euler-lagrange",
    "q": ["theta"],
    "parameters": {"m": "positive", "l": "positive", "g": "positive"},
    "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)",
}

(mark,) = MarkingPolicy().marks(canon.check([{**QUESTION, "claim": [ANSWER]}], budget=5.0))
if PRECHECK:
    told = mark.sentence if mark.asks_again else "this can be read"
elif mark.points is None:
    told = f"This 0 is no mark yet. {mark.sentence}"
else:
    told = mark.sentence
fraction = 1.0 if PRECHECK and not mark.asks_again else mark.points or 0.0
print(json.dumps({"fraction": fraction, "prologuehtml": f"<p>{html.escape(told)}</p>"}))
