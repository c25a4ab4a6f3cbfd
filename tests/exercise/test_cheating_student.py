"""Someone wants full marks without the answer: of many worthless answers not one holds, beside each a right one does.

A worthless answer is a form (no value anywhere, a value almost nowhere, a jump, right on a part only, an equation that
says nothing) made of a right answer of each kind, in the plain language and in LaTeX; or, by hand, one that says
nothing or copies the question. Beside each form stands the same decoration done honestly: the answer still holds.
"""

import json
import random
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.sheet.kinds import KINDS
from canon.exercise.sheet.sheet import Claim, sheet_from
from tests.exercise.right_answers import EMPTY, RIGHT, Right, with_kappa
from tests.exercise.worthless_forms import CLASSES, HIDDEN_ZEROS, PLAIN_ZEROS, Form

BUDGET = 3
"""Seconds for a worthless answer: one that is undecided has not got its marks."""
SHARES = {
    "nowhere": 0.35,
    "almost nowhere": 0.4,
    "jumps": 0.8,
    "parts": 0.7,
    "equations": 1.0,
    "honest": 0.25,
}
"""Of all pairs of a form and a right answer so many are tried; in the plain language or in LaTeX."""
PATIENCE = 30
"""Seconds for a right answer, which holds also on a busy machine."""


@dataclass(frozen=True)
class Attempt:
    """An answer handed in: of which class, whether it is right, and the claim as a sheet has it."""

    form: str
    sort: str
    keys: dict[str, object]
    honest: bool = False
    latex: bool = False

    @property
    def kind(self) -> str:
        return str(self.keys["kind"])

    def read(self) -> Claim:
        """Return the claim as the reader of sheets gives it."""
        (claim,) = sheet_from(json.dumps({"claims": [{"id": "a", **self.keys}]}).encode()).claims
        return claim


def attempts_at(right: Right, sort: str, form: Form) -> Iterator[Attempt]:
    """Yield a part of what could be made, the same part in every run: one of many would do, but they differ by kind."""
    chance = random.Random(f"{sort} {form.name} {right.name}")
    plain, any_zero = chance.choice(PLAIN_ZEROS), chance.choice(list(HIDDEN_ZEROS))
    honest = sort == "honest"
    if chance.random() < SHARES[sort]:
        spellings = form.written(right, plain if honest else any_zero)
        latex = bool(spellings[1]) and chance.random() < 0.5
        yield _attempt(right, sort, form.name, spellings[latex], honest=honest, latex=latex)
    if form.beside and right.role in CLASSES["honest"][1] and chance.random() < SHARES["honest"]:
        (answer, _) = Form(form.name, form.beside).written(right, plain)
        yield _attempt(right, sort, form.name, answer, honest=True, latex=False)


def _attempt(right: Right, sort: str, form: str, answer: str, *, honest: bool, latex: bool) -> Attempt:
    keys = {"kind": right.kind, **right.with_answer(answer), "budget": PATIENCE if honest else BUDGET}
    return Attempt(f"{sort}: {form}", sort, keys, honest=honest, latex=latex)


def by_hand() -> Iterator[Attempt]:
    for empty in EMPTY:
        for honest, answers in ((False, empty.worthless), (True, empty.right)):
            for answer in answers:
                keys = {"kind": empty.kind, **with_kappa({**empty.question, **answer})}
                keys["budget"] = PATIENCE if honest else BUDGET
                yield Attempt(f"by hand: {empty.kind}", "by hand", keys, honest=honest)


@cache
def attempts() -> tuple[Attempt, ...]:
    made = [
        attempt
        for sort, (forms, roles) in CLASSES.items()
        for form in forms
        for right in RIGHT
        if right.role in (form.roles or roles)
        for attempt in attempts_at(right, sort, form)
    ]
    return (*made, *by_hand())


def verdict(attempt: Attempt) -> str:
    try:
        return judge(attempt.read()).status.value
    except InvalidClaim:
        return "invalid"


def wrongly_judged(some: list[Attempt]) -> list[tuple[str, str]]:
    """Return the worthless answers that hold, and the right ones that do not."""
    said = [(attempt, verdict(attempt)) for attempt in some]
    return [(json.dumps(a.keys), status) for a, status in said if (status == "holds") != a.honest]


def sample(*, honest: bool) -> list[Attempt]:
    """Return one attempt of every form and one of every kind, the same ones in every run."""
    groups: dict[str, list[Attempt]] = {}
    for attempt in attempts():
        if attempt.honest == honest:
            for group in (attempt.form, attempt.kind):
                groups.setdefault(group, []).append(attempt)
    return [random.Random(group).choice(some) for group, some in groups.items()]


# --- the grammar ------------------------------------------------------------------------------------


def test_the_right_answers_hold_in_both_languages():
    for right in RIGHT:
        for answer in (right.frame[0].format(right.answer), f"${right.frame[1].format(right.latex)}$"):
            keys = {"kind": right.kind, **right.with_answer(answer), "budget": PATIENCE}
            assert verdict(Attempt("right", "right", keys)) == "holds", (right.name, answer)


def test_there_are_enough_attempts_of_every_kind_and_sort():
    worthless = [attempt for attempt in attempts() if not attempt.honest]
    assert len(worthless) >= 2000
    assert {attempt.kind for attempt in worthless} == set(KINDS)
    assert {attempt.kind for attempt in attempts() if attempt.sort == "by hand"} == set(KINDS)
    assert min(Counter(attempt.kind for attempt in worthless).values()) >= 15
    assert sum(attempt.latex for attempt in worthless) >= 600
    assert all(form.beside for sort, (forms, _) in CLASSES.items() for form in forms if sort != "honest")


# --- not one holds, and beside each form a right answer does ------------------------------------------


def test_no_worthless_answer_holds_of_a_sample():
    assert wrongly_judged(sample(honest=False)) == []


def test_the_right_neighbours_hold_of_a_sample():
    assert wrongly_judged(sample(honest=True)) == []


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_no_worthless_answer_holds(kind):
    assert wrongly_judged([a for a in attempts() if a.kind == kind and not a.honest]) == []


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_the_right_neighbours_hold(kind):
    assert wrongly_judged([a for a in attempts() if a.kind == kind and a.honest]) == []


def test_the_command_gives_no_marks_either(tmp_path: Path):
    some = random.Random(0).sample([a for a in sample(honest=False) if a.sort != "by hand"], 12)
    right = [a for a in attempts() if a.form == "honest: nothing added"][:1]
    claims = [{"id": f"a{i}", **attempt.keys} for i, attempt in enumerate((*some, *right))]
    sheet = tmp_path / "answers.json"
    sheet.write_text(json.dumps({"claims": claims}), "utf-8")
    command = [sys.executable, "-m", "canon", "check", "--json", str(sheet)]
    told = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    said = [json.loads(line)["status"] for line in told.splitlines()]
    assert len(said) == 13
    assert said[-1] == "holds"
    assert "holds" not in said[:-1]
