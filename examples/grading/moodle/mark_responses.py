"""Moodle: the responses of a quiz, downloaded as CSV, become marks to upload and a list for people.

python mark_responses.py question.json claim "Response 1" responses.csv

``question.json`` is a claim without its answer, ``claim`` the key under which the answer goes. Two files are written:
``marks.csv`` has the marks of what is right and wrong, ``to_look_at.csv`` what has none yet: unreadable answers, whose
authors are asked again, and undecided ones, which a person marks.
"""

import csv
import json
import sys
from pathlib import Path

import canon
from canon.exercise import MarkingPolicy, Sheet
from canon.exercise.sheet.sheet import claim_from

WHO = "Email address"


def marks(responses, question, key, column, policy=MarkingPolicy()):  # noqa: B008 (a frozen value)
    """Return the mark of each row of an export that has an answer, by who gave it."""
    rows = [row for row in csv.DictReader(responses) if row[column].strip() not in ("", "-")]
    claims = tuple(claim_from({**question, "id": row[WHO], key: row[column]}) for row in rows)
    report = canon.check(Sheet("quiz", claims), jobs=2, budget=10.0)
    return {judgement.id: policy.mark(judgement, [key]) for judgement in report}


def write(found, marked, open_):
    """Write what has a mark to one table, and what has none to the other."""
    done, waiting = csv.writer(marked), csv.writer(open_)
    done.writerow([WHO, "Grade", "Feedback"])
    waiting.writerow([WHO, "What to do", "Feedback"])
    for who, mark in found.items():
        if mark.points is None:
            waiting.writerow([who, "ask again" if mark.asks_again else "look at it", mark.sentence])
        else:
            done.writerow([who, mark.points, mark.sentence])


def main(question, key, column, responses):
    with Path(responses).open(newline="", encoding="utf-8-sig") as file:
        found = marks(file, json.loads(Path(question).read_text("utf-8")), key, column)
    with (
        Path("marks.csv").open("w", newline="", encoding="utf-8") as marked,
        Path("to_look_at.csv").open("w", newline="", encoding="utf-8") as open_,
    ):
        write(found, marked, open_)


if __name__ == "__main__":
    main(*sys.argv[1:])
