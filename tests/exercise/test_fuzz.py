"""Claims with slips of the pen, thousands of them: every one gets a verdict or an error that names its place."""

import json
import random
from copy import deepcopy
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.explained_judgement import judgements
from canon.exercise.judging_process import GRACE, Worker
from canon.exercise.question.deadline import PATIENCE
from canon.exercise.sheet.sheet import SheetError, read_sheet, sheet_from
from canon.expression.parse import LanguageError, Scope, parse_expression

SHEETS = sorted((Path(__file__).parents[1] / "data" / "claims").glob("*.json"))
WRITTEN = [json.dumps(claim) for path in SHEETS for claim in json.loads(path.read_text("utf-8"))["claims"]]
CLAIMS = [claim for path in SHEETS for claim in read_sheet(path).claims]
PIECES = (
    "x", "0", "1/0", "-1", "**2", "+", "q", "t", "sin(", "sqrt(-1)", "I", "**(1/2)", "*0", "'", "_dot", "Abs(", ")",
    "log(",
)  # fmt: skip
OWN = ("id", "kind", "title", "expect", "budget")
LETTERS = "xqt0123456789.+-*/()<>=, 'eVsincogIpi_lambda[]{}\"\\^:;!$θ̇²√"
JSON_LIKE = '{}[]":,claims0123 \n="tomkind'


def slip(text, chance):
    """One slip in a text: something left out, put in, or overwritten."""
    start = chance.randrange(len(text) + 1)
    end = min(len(text), start + chance.randrange(1, 6))
    before, after, piece = text[:start], text[end:], chance.choice(PIECES)
    return chance.choice((before + after, before + piece + text[start:], before + piece + after))


def slipped(value, chance):
    """One slip somewhere inside a value."""
    if isinstance(value, str):
        return slip(value, chance)
    if isinstance(value, list) and value:
        place = chance.randrange(len(value))
        return [slipped(item, chance) if i == place else item for i, item in enumerate(value)]
    if isinstance(value, dict) and value:
        place = chance.choice(sorted(value))
        return {key: slipped(item, chance) if key == place else item for key, item in value.items()}
    return value


def slipped_claim(number):
    chance = random.Random(number)
    claim = chance.choice(CLAIMS)
    keys = {key: value for key, value in claim.keys.items() if key not in OWN}
    place = chance.choice(sorted(keys))
    return replace(claim, keys={**keys, place: slipped(keys[place], chance)}, budget=2.0)


def outcome(claim):
    try:
        return judge(claim).status.value
    except InvalidClaim as error:
        named = error.error
    assert named.claim == claim.id
    assert named.reason
    return "invalid"


@pytest.mark.parametrize("numbers", [range(150)], ids=["150"])
def test_slips_are_judged_or_named(numbers):
    outcomes = [outcome(slipped_claim(number)) for number in numbers]
    assert outcomes.count("undecided") <= 2
    assert {"holds", "fails", "invalid"} <= set(outcomes)


VALUES = (
    None, True, False, 0, 1, -1, 10**30, 0.5, "", "x", "q", "t", "0", "1/0", "x = y", "x < 1", "True", "I", "$x$", "$",
    "p_dot", [], [[]],
    ["x"], ["x", "x"], ["x", 1], [1, 2], {}, {"x": "x"}, {"x": [0, 1]}, {"Q": ["x"], "P": ["p"]}, [{}],
    [{"f": "x", "g": "x", "value": "x"}], [{"m": "1", "r": ["x"]}], [{"I": "1", "angle": "x"}],
    {"V": ["x"]}, {"f": ["t"]},
    "holds", ["q", "p"], ["p", "q"], "gauge", "L-pq", ["0"], ["0", "0"], "Piecewise((x, x > 0), (0, True))", "Abs(x)",
)  # fmt: skip
KEYS = (
    "domain",
    "functions",
    "parameters",
    "box",
    "t",
    "valence",
    "F",
    "claim",
    "q",
    "p",
    "L",
    "H",
    "restrict",
    "Q",
    "P",
)


def confused_claim(number):
    """A real claim in which one or two keys hold something of another sort, or are missing, or stand besides."""
    chance = random.Random(number)
    keys = json.loads(chance.choice(WRITTEN))
    for _ in range(chance.randrange(1, 3)):
        key, way = chance.choice(sorted(keys)), chance.random()
        value = keys[key]
        if way < 0.5:
            keys[key] = deepcopy(chance.choice(VALUES))
        elif way < 0.6:
            del keys[key]
        elif way < 0.75:
            keys[chance.choice(KEYS)] = deepcopy(chance.choice(VALUES))
        elif isinstance(value, list) and value:
            value[chance.randrange(len(value))] = deepcopy(chance.choice(VALUES))
        elif isinstance(value, dict) and value:
            value[chance.choice(sorted(value))] = deepcopy(chance.choice(VALUES))
    (claim,) = sheet_from(json.dumps({"claims": [{**keys, "budget": 2}]}).encode()).claims
    return claim


def told_of_all(numbers):
    """Judge confused claims as the worker does; whatever is raised is a fault of canon."""
    return [told for number in numbers for told, last in judgements(confused_claim(number)) if last]


def test_confused_claims_are_judged_or_named():
    told = told_of_all(range(90))
    assert {"holds", "fails", "invalid"} <= {judgement.status for judgement in told}
    assert all(judgement.known for judgement in told if judgement.status in ("invalid", "undecided"))


@pytest.mark.slow
@pytest.mark.parametrize("first", range(1000, 3500, 500))
def test_two_thousand_confused_claims(first):
    assert len(told_of_all(range(first, first + 500))) == 500


@pytest.mark.slow
@pytest.mark.parametrize("first", range(1000, 4000, 500))
def test_three_thousand_slips_in_the_worker(first):
    """Whatever a claim says, the worker answers for it in its budget and does not break off.

    On a busy machine a claim has that much of the processor, and is waited for PATIENCE times as long at most.
    """
    claims = [slipped_claim(number) for number in range(first, first + 500)]
    with Worker() as worker:
        told = [worker.judge(claim) for claim in claims]
    assert not [t for t in told if "broke off" in t.known]
    late = [t for t, c in zip(told, claims, strict=True) if t.seconds > PATIENCE * (c.budget + GRACE) + 0.5]
    assert not late


def test_a_claim_whose_answer_stands_in_a_list_is_named():
    """It once met the screen of gauges, which looks for F, although its relation has none."""
    written = (json.loads(text) for text in WRITTEN)
    other = next(keys for keys in written if keys.get("relation") == "equations" and "F" not in keys)
    (claim,) = sheet_from(json.dumps({"claims": [{**other, "F": ["x"]}]}).encode()).claims
    (told,) = (judgement for judgement, last in judgements(claim) if last)
    assert told.status == "invalid"
    assert told.known.startswith("key F: stands beside the relation gauge only")


TEXTS = st.text(alphabet=LETTERS, max_size=60) | st.text(max_size=30)


@settings(max_examples=1_000, deadline=None)
@given(TEXTS)
def test_any_text_is_an_expression_or_its_fault_has_a_column(text):
    read_or_placed(text)


@pytest.mark.slow
@settings(max_examples=20_000, deadline=None)
@given(TEXTS)
def test_twenty_thousand_texts(text):
    read_or_placed(text)


def read_or_placed(text):
    column = 1
    try:
        parse_expression(text, Scope())
    except LanguageError as error:
        column = error.column
    assert 1 <= column <= len(text) + 1


@settings(max_examples=2_000, deadline=None)
@given(st.binary(max_size=200) | st.text(alphabet=JSON_LIKE, max_size=200).map(str.encode), st.booleans())
def test_any_bytes_are_a_sheet_or_no_sheet(data, toml):
    try:
        read = sheet_from(data, toml=toml)
    except SheetError:
        return
    assert all(claim.id for claim in read.claims)
