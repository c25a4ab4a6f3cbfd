"""The service at its edges: what is remembered and forgotten, logged, judged a second time, refused, or no answer."""

from __future__ import annotations

import asyncio
import json
import logging
import sys
from types import SimpleNamespace

import pytest

pytest.importorskip("starlette", reason="the extra 'serve' is not installed")

from canon.exercise import Claim, Judgement
from canon.exercise.judging_process import BROKE_OFF
from canon.serve import Limits, kept_verdicts, text_reader, web_application
from canon.serve.judging_queue import JudgingQueue
from canon.serve.kept_verdicts import KeptVerdicts
from canon.serve.reading_process import how_read
from canon.serve.refusal import Refusal
from canon.serve.request_log import _AsJson
from canon.serve.text_reader import TextReader
from canon.serve.token_bucket import WorkTime


def claim(number):
    return Claim(f"c{number}", "equality-only", {"lhs": str(number), "rhs": str(number)})


def test_the_verdict_that_was_asked_for_the_longest_ago_is_forgotten_first(monkeypatch):
    monkeypatch.setattr(kept_verdicts, "MOST", 2)
    kept = KeptVerdicts()
    for number in (1, 2):
        kept.keep(claim(number), Judgement(f"c{number}", "equality-only", "holds"))
    assert kept.verdict(claim(1)) is not None
    kept.keep(claim(3), Judgement("c3", "equality-only", "holds"))
    assert [kept.verdict(claim(number)) is not None for number in (1, 2, 3)] == [True, False, True]
    kept.keep(claim(4), Judgement("c4", "equality-only", "undecided"))
    assert kept.verdict(claim(4)) is None


def test_an_error_is_logged_with_where_it_arose():
    try:
        raise ValueError("half a sheet")
    except ValueError:
        caught = sys.exc_info()
    for error, is_told in ((caught, True), (None, False)):
        record = logging.LogRecord("canon.serve", logging.ERROR, __file__, 1, "fault", (), error)
        said = json.loads(_AsJson().format(record))
        assert (said["event"], said["level"]) == ("fault", "error")
        assert ("traceback" in said) is is_told
        assert not is_told or said["traceback"].endswith("ValueError: half a sheet")


def test_texts_wait_in_a_line_that_has_an_end(monkeypatch):
    reader = TextReader()
    try:
        asked = {"text": "x + x", "q": ["x"]}
        assert asyncio.run(reader.how_read(asked, WorkTime()))["read"]
        monkeypatch.setattr(text_reader, "WAITING", 0)
        with pytest.raises(Refusal, match="0 texts wait to be read; ask again in a second") as refused:
            asyncio.run(reader.how_read(asked, WorkTime()))
        assert (refused.value.status, reader.waiting) == (503, 0)
    finally:
        reader.close()


@pytest.mark.parametrize("answer", [web_application._refused, web_application._not_found])
def test_an_error_of_another_kind_is_no_answer(answer):
    with pytest.raises(ZeroDivisionError):
        asyncio.run(answer(None, ZeroDivisionError()))


class Pool:
    """A pool that gives the verdicts it was given, one after the other."""

    def __init__(self, *given):
        self.given, self.asked = list(given), []

    def judge(self, claim):
        self.asked.append(claim.id)
        return self.given.pop(0)

    def close(self):
        """Nothing runs."""


def queue_of(pool, monkeypatch, workers=1):
    monkeypatch.setattr("canon.serve.judging_queue.JudgePool", lambda *_: pool)
    return JudgingQueue(Limits(workers=workers, budget=1.0))


BROKEN = Judgement("c1", "equality-only", "undecided", known=BROKE_OFF)
HOLDS = Judgement("c1", "equality-only", "holds")


@pytest.mark.parametrize(
    ("given", "status", "times"),
    [([BROKEN, HOLDS], "holds", 2), ([BROKEN, BROKEN], "undecided", 2), ([HOLDS], "holds", 1)],
)
def test_a_claim_whose_process_broke_off_is_judged_a_second_time(given, status, times, monkeypatch):
    async def judged():
        queue = queue_of(pool := Pool(*given), monkeypatch)
        found = [each.status async for each in queue.verdicts([claim(1)])]
        queue.close()
        return found, pool.asked

    assert asyncio.run(judged()) == ([status], ["c1"] * times)


def test_claims_that_nobody_waits_for_are_not_judged(monkeypatch):
    async def left():
        queue = queue_of(pool := Pool(*[HOLDS] * 9), monkeypatch, workers=2)
        verdicts = queue.verdicts([claim(number) for number in range(9)])
        await anext(verdicts)
        await verdicts.aclose()
        await asyncio.sleep(0)
        waiting = queue.waiting
        queue.close()
        return len(pool.asked), waiting

    asked, waiting = asyncio.run(left())
    assert asked < 9
    assert waiting == 0


def test_a_table_of_texts_is_read_one_by_one():
    asked = {"kind": "solution", "q": ["x"], "p": ["p"], "H": "p**2/2 + x**2/2"}
    found = how_read({**asked, "key": "solution", "text": {"x": "sin(t)", "p": "cos(t)"}})
    assert found["read"], found
    assert [each["plain"] for each in found["statements"]] == ["sin(t)", "cos(t)"]
    assert [each["place"] for each in found["statements"]] == ["solution.x", "solution.p"]
    wrong = how_read({**asked, "key": "solution", "text": {"x": "sin(t)", "p": "cos(s)"}})
    assert wrong["error"]["place"] == "solution.p"
    assert SimpleNamespace(**wrong["error"]).column == 5
