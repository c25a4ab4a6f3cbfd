"""Diagnosis on trial: wrong answers made by a model of slips, and how many sentences name the slip.

    python benchmarks/feedback.py                       # both halves, all questions
    python benchmarks/feedback.py --half open --every 4 --show

Slips and questions are those of ``tests/exercise/slips_of_students.py``. An answer is *named* where the diagnosis has
the mistake of its slip and brings back the right answer, *placed* where it says something else that is proved, and
*silent* where nothing is said. *False* is a repair that is not judged to hold: there should be none.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).parents[1]))

from canon.exercise.diagnose.diagnosis import judged_to_hold
from canon.exercise.diagnose.diagnosis_search import diagnosis
from canon.exercise.diagnose.effort import Effort
from canon.exercise.judge import examine
from canon.exercise.report.sentences import sentence
from tests.exercise.slips_of_students import is_named, wrong_answers

if TYPE_CHECKING:
    from canon.exercise.diagnose.diagnosis import Diagnosis
    from tests.exercise.slips_of_students import WrongAnswer

OUTCOMES = ("named", "placed", "silent", "false")


def outcome(answer: WrongAnswer, found: Diagnosis | None) -> str:
    """Return what a diagnosis is worth."""
    if found is None:
        return "silent"
    if found.repaired is not None and not judged_to_hold(found.repaired, Effort(60.0)):
        return "false"
    return "named" if is_named(answer, found) else "placed"


def row(name: str, counts: Counter[str]) -> str:
    total = sum(counts.values())
    shares = "  ".join(f"{counts[o]:5d} ({100 * counts[o] / total:5.1f} %)" for o in OUTCOMES)
    return f"{name:<32}{total:6d}  {shares}"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--half", choices=("open", "closed", "both"), default="both")
    parser.add_argument("--each", type=int, default=7, help="slips a question")
    parser.add_argument("--every", type=int, default=1, help="take every n-th wrong answer")
    parser.add_argument("--show", action="store_true", help="print the open ones whose slip is not named")
    arguments = parser.parse_args()
    for half in ("open", "closed") if arguments.half == "both" else (arguments.half,):
        slips: dict[str, Counter[str]] = {}
        kinds: dict[str, Counter[str]] = {}
        slowest, total = 0.0, Counter[str]()
        for number, answer in enumerate(wrong_answers(half, arguments.each)):
            if number % arguments.every:
                continue
            finding = examine(answer.claim)
            start = time.process_time()
            found = diagnosis(finding)
            slowest = max(slowest, time.process_time() - start)
            result = outcome(answer, found)
            slips.setdefault(answer.slip, Counter())[result] += 1
            kinds.setdefault(answer.question.keys["kind"], Counter())[result] += 1
            total[result] += 1
            if arguments.show and half == "open" and result != "named":
                wrong = "; ".join(
                    f"{k}: {v}  (right: {answer.question.answer(k)})" for k, v in answer.wrong.items()
                )
                said = sentence(found) if found else "–"
                print(f"{result} | {answer.question.name} | {answer.slip} | {wrong}\n    {said}", flush=True)
        print(f"\n{half} half{'':<23}{'':>6}  " + "  ".join(f"{o:>15}" for o in OUTCOMES))
        for counts in (slips, kinds):
            for name in sorted(counts):
                print(row(name, counts[name]))
            print()
        print(row("all", total))
        print(f"slowest diagnosis: {slowest:.1f} s of processor time")


if __name__ == "__main__":
    main()
