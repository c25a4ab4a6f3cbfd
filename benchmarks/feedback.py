"""Diagnosis on trial: wrong answers made by a model of slips, and how many sentences name the slip.

    python benchmarks/feedback.py                             # the table of the last run over the whole corpus
    python benchmarks/feedback.py --run --lines found.jsonl   # a run: minutes of processor time, resumed if cut off
    python benchmarks/feedback.py --show --lines found.jsonl  # the open answers whose slip was not named

Slips and questions are those of ``tests/exercise/slips_of_students.py``. An answer is *named* where the diagnosis has
the mistake of its slip and brings back the right answer, *placed* where it says something else that is proved, and
*silent* where nothing is said. *False* is a repair that is not judged to hold: there should be none.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

sys.path.insert(0, str(Path(__file__).parents[1]))

from days import in_words, today

from canon.exercise.claim_verdict import examined
from canon.exercise.diagnose.diagnosis_search import diagnosis
from canon.exercise.diagnose.effort import BudgetSpent
from canon.exercise.question.deadline import Deadline
from canon.exercise.report.sentences import sentence
from tests.exercise.slips_of_students import half_of, is_named, of_a_question, questions

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.exercise.diagnose.diagnosis import Diagnosis
    from canon.exercise.sheet.reading import Reading
    from tests.exercise.slips_of_students import Question, WrongAnswer

RESULTS = Path(__file__).parent / "results" / "feedback.txt"
OUTCOMES = ("named", "placed", "silent", "false")
HALVES = ("open", "closed")
PATIENCE = 120.0
BUDGET_SPENT = "(the seconds ended the search)"


def outcome(answer: WrongAnswer, found: Diagnosis | None) -> str:
    """Return what a diagnosis is worth."""
    if found is None:
        return "silent"
    for told in (found, found.instead):
        if told is not None and told.repaired is not None and not holds(told.repaired):
            return "false"
    return "named" if is_named(answer, found) else "placed"


def holds(repaired: Reading) -> bool:
    """Whether a repaired claim is judged to hold, with much more time than the diagnosis had."""
    return examined(repaired, Deadline.after(PATIENCE)).verdict.holds


def tried(question: Question, each: int) -> Iterator[dict[str, Any]]:
    """Yield for each wrong answer to a question what is said of it and what that is worth."""
    for answer in of_a_question(question, each):
        finding = answer.finding
        start, spent = time.process_time(), False
        try:
            found = diagnosis(finding)
        except BudgetSpent:
            found, spent = None, True
        seconds = time.process_time() - start
        yield {
            "slip": answer.slip,
            "outcome": outcome(answer, found),
            "said": sentence(found) if found else BUDGET_SPENT if spent else "",
            "wrong": "; ".join(
                f"{k}: {v}  (right: {answer.question.answer(k)})" for k, v in answer.wrong.items()
            ),
            "seconds": round(seconds, 2),
        }


def run(lines: Path, each: int, every: int, part: int) -> None:
    """Append a line a question, but for those that have one."""
    done = {line["question"] for line in read(lines)}
    for question in questions()[part::every]:
        if question.name not in done:
            line = {"question": question.name, "kind": question.keys["kind"], "half": half_of(question)}
            line["day"] = today()
            line["answers"] = list(tried(question, each))
            with lines.open("a", encoding="utf-8") as file:
                print(json.dumps(line, ensure_ascii=False), file=file)


def read(lines: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in lines.read_text("utf-8").splitlines()] if lines.exists() else []


def row(name: str, counts: Counter[str]) -> str:
    total = sum(counts.values())
    shares = "  ".join(f"{counts[o]:5d} ({100 * counts[o] / total:5.1f} %)" for o in OUTCOMES)
    return f"{name:<32}{total:6d}  {shares}"


def table(found: Sequence[dict[str, Any]]) -> Iterator[str]:
    """Yield the counts of both halves, then those of each slip and kind over both."""
    head = "  ".join(f"{o:>15}" for o in OUTCOMES)
    halves, slips, kinds = (dict[str, Counter[str]]() for _ in range(3))
    slowest = 0.0
    for line in found:
        for answer in line["answers"]:
            rows = ((halves, line["half"]), (slips, answer["slip"]), (kinds, line["kind"]))
            for counts, name in rows:
                counts.setdefault(name, Counter())[answer["outcome"]] += 1
            slowest = max(slowest, answer["seconds"])
    yield f"measured on {in_words(line['day'] for line in found)}"
    asked = sum(len(line["answers"]) for line in found)
    yield f"{asked} wrong answers to {len(found)} questions, each judged to be wrong\n"
    yield f"{'half':<32}{'':>6}  {head}"
    yield from (row(half, halves[half]) for half in HALVES if half in halves)
    for title, counted in (("slip", slips), ("kind of claim", kinds)):
        yield f"\n{title:<32}{'':>6}  {head}"
        yield from (row(name, counted[name]) for name in sorted(counted))
    spent = sum(answer["said"] == BUDGET_SPENT for line in found for answer in line["answers"])
    yield f"\nslowest diagnosis: {slowest:.1f} s of processor time; searches that their seconds ended: {spent}"


def show(found: Sequence[dict[str, Any]]) -> None:
    """Print the answers of the open half whose slip was not named."""
    for line in found:
        for answer in line["answers"] if line["half"] == "open" else ():
            if answer["outcome"] != "named":
                print(f"{answer['outcome']} | {line['question']} | {answer['slip']} | {answer['wrong']}")
                print(f"    {answer['said'] or '–'}")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--run", action="store_true", help="try the whole corpus")
    parser.add_argument("--lines", type=Path, help="JSON lines, one a question, that a run appends to")
    parser.add_argument("--each", type=int, default=7, help="slips a question")
    parser.add_argument("--every", type=int, default=1, help="take every n-th question")
    parser.add_argument("--part", type=int, default=0, help="of these, begin with this one")
    parser.add_argument("--show", action="store_true", help="print the open ones whose slip is not named")
    arguments = parser.parse_args()
    if arguments.lines is None:
        print(RESULTS.read_text("utf-8").rstrip())
        return
    if arguments.run:
        run(arguments.lines, arguments.each, arguments.every, arguments.part)
    found = read(arguments.lines)
    if arguments.show:
        show(found)
    text = "\n".join(table(found))
    print(text)
    if len(found) == len(questions()):
        RESULTS.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
