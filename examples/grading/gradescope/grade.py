"""Gradescope: ``answers.json`` of a submission, ``{"pendulum": "…"}``, becomes ``results.json``.

``run_autograder`` calls it in the container:  python grade.py /autograder/submission /autograder/results
"""

import json
import sys
import tomllib
from pathlib import Path

import canon
from canon.exercise import Mark, MarkingPolicy, Outcome

HERE = Path(__file__).parent
POLICY = MarkingPolicy()
NOT_ANSWERED = Mark(Outcome.WRONG, POLICY.wrong, "not answered")
MOST = 100_000
"""Bytes of a submission that are read."""


def results(answers):
    """Return what Gradescope reads: a test for each question, in its order."""
    asked = tomllib.loads((HERE / "questions.toml").read_text("utf-8"))
    keys = asked["answers"]
    given = {name: str(answers[name]) for name in keys if str(answers.get(name, "")).strip()}
    questions = (claim for claim in asked["claim"] if claim["id"] in given)
    claims = [{**claim, keys[claim["id"]]: given[claim["id"]]} for claim in questions]
    report = canon.check(claims, budget=10.0) if claims else ()
    marks = {judgement.id: POLICY.mark(judgement) for judgement in report}
    waiting = [name for name, mark in marks.items() if mark.points is None]
    tests = [test(name, marks.get(name, NOT_ANSWERED)) for name in keys]
    return {"visibility": "visible", "tests": tests, "extra_data": {"for_a_person": waiting}}


def test(name, mark):
    """Return one test. What has no mark yet is worth nothing out of nothing: the rest is given by hand."""
    if mark.points is None:
        again = "; submit again" if mark.asks_again else ""
        return {"name": name, "score": 0.0, "max_score": 0.0, "output": f"{mark.sentence}{again}"}
    status = "passed" if mark.points == POLICY.right else "failed"
    said = {"name": name, "score": mark.points, "max_score": POLICY.right, "status": status}
    return {**said, "output": mark.sentence}


def submitted(folder):
    """Return the answers of a submission; what is no object of texts is no answer."""
    try:
        with (Path(folder) / "answers.json").open("rb") as file:
            found = json.loads(file.read(MOST))
    except (OSError, ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}


def main(submission, folder):
    written = json.dumps(results(submitted(submission)), indent=2, ensure_ascii=False)
    (Path(folder) / "results.json").write_text(written, "utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
