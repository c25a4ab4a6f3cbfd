"""A ``results.json`` of Otter's in which what canon could not read or decide is worth nothing out of nothing.

python set_aside.py /autograder/results/results.json
"""

import json
import sys
from pathlib import Path

OPEN = ("canon: unreadable", "canon: undecided")


def set_aside(results):
    """Return the results with such tests set aside for a person."""
    tests, waiting = [], []
    for test in results["tests"]:
        if any(said in test.get("output", "") for said in OPEN):
            waiting.append(test["name"])
            test = {**test, "score": 0.0, "max_score": 0.0}
            test.pop("status", None)
        tests.append(test)
    found = {
        **results,
        "tests": tests,
        "extra_data": {**results.get("extra_data", {}), "for_a_person": waiting},
    }
    found.pop("score", None)  # Gradescope adds the tests up
    return found


def main(name):
    path = Path(name)
    path.write_text(json.dumps(set_aside(json.loads(path.read_text("utf-8"))), indent=2), "utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
