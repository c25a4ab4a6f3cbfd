"""The limits of the service: who asks too much is told so, and when to come back; others are served."""

from __future__ import annotations

import socket
import threading
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

pytest.importorskip("starlette", reason="the extra 'serve' is not installed")

from canon.exercise.report.judgement import Judgement
from canon.serve import Limits, application, http_server
from canon.serve.token_bucket import MOST_CLIENTS, Buckets

RIGHT = {"id": "right", "kind": "equality-only", "lhs": "2*x", "rhs": "x + x", "parameters": {"x": "real"}}


class Slow:
    """A pool whose claims are judged when the test says so."""

    def __init__(self, workers, budget):
        self.budget, self.go, self.asked = budget, threading.Event(), []
        self.processes, self.started = tuple(range(workers)), workers

    def judge(self, claim):
        self.asked.append(claim)
        assert self.go.wait(20)
        return Judgement(claim.id, claim.kind, "undecided", 3.0, known="not looked at")

    def close(self):
        self.go.set()


class Silent:
    """A reader that reads nothing."""

    waiting = 0

    async def how_read(self, asked):
        return {"read": True, "statements": [], "warnings": []}

    def close(self):
        pass


@pytest.fixture
def served(monkeypatch, running):
    monkeypatch.setattr("canon.serve.judging_queue.JudgePool", Slow)
    monkeypatch.setattr("canon.serve.web_application.TextReader", Silent)
    return lambda **limits: running(application(Limits(**limits)))


def pool_of(client):
    return client.app.state.service.queue._pool


def test_the_budget_of_the_service_is_that_of_every_claim(served):
    with served(budget=0.7) as client:
        pool_of(client).go.set()
        client.post("/check", json={**RIGHT, "budget": 3000})
        assert [claim.budget for claim in pool_of(client).asked] == [0.7]
        assert pool_of(client).budget == 0.7


def test_who_asks_too_often_is_told_when_to_come_back(served):
    with served(rate=1.0, burst=3.0) as client:
        pool_of(client).go.set()
        answers = [client.post("/check", json=RIGHT) for _ in range(3)]
        assert [answer.status_code for answer in answers] == [
            200,
            429,
            429,
        ]  # each took 3 s, which counts as well
        assert "at most 1 claims a minute" in answers[1].json()["detail"]
        assert 1 <= int(answers[1].headers["retry-after"]) <= 60
        assert client.post("/read", json={"text": "x"}).status_code == 429
        assert client.get("/health").status_code == 200


def test_other_clients_are_served_meanwhile(served):
    with served(rate=1.0, burst=1.0) as one:
        pool_of(one).go.set()
        assert [one.post("/check", json=RIGHT).status_code for _ in range(2)] == [200, 429]
        assert one.from_address("127.0.0.9").post("/check", json=RIGHT).status_code == 200


def test_no_more_wait_than_may_and_those_who_wait_are_answered(served):
    with served(workers=1, claims=3, waiting=4) as client:
        answers = []
        sheet = [{**RIGHT, "id": f"n{k}"} for k in range(3)]
        first = threading.Thread(target=lambda: answers.append(client.post("/check", json=sheet)))
        first.start()
        while not pool_of(client).asked:
            pass
        refused = client.post("/check", json=sheet)
        assert refused.status_code == 503
        assert "3 claims of other people are waiting" in refused.json()["detail"]
        assert int(refused.headers["retry-after"]) >= 1
        assert client.get("/health").json()["waiting"]["claims"] == 3
        pool_of(client).go.set()
        first.join(20)
        assert [one["id"] for one in answers[0].json()["verdicts"]] == ["n0", "n1", "n2"]
        assert client.get("/health").json()["waiting"]["claims"] == 0


def test_a_long_sheet_does_not_keep_others_waiting_for_its_end(served):
    """Claims of two requests are judged in turn, though one has many and came first."""
    with served(workers=1, claims=50, waiting=60) as client:
        sheet = [{**RIGHT, "id": f"long{k}"} for k in range(6)]
        threads = [threading.Thread(target=client.post, args=("/check",), kwargs={"json": sheet})]
        threads[0].start()
        while not pool_of(client).asked:
            pass
        short = {**RIGHT, "id": "short"}
        threads.append(threading.Thread(target=client.post, args=("/check",), kwargs={"json": short}))
        threads[1].start()
        while client.get("/health").json()["waiting"]["claims"] < 7:
            pass
        pool_of(client).go.set()
        for thread in threads:
            thread.join(20)
        assert [claim.id for claim in pool_of(client).asked].index("short") <= 2


@pytest.mark.parametrize("said", [b"", b"POST /check HTTP/1.1\r\nHost: local"])
def test_a_connection_on_which_no_request_comes_is_closed(served, monkeypatch, said):
    monkeypatch.setattr(http_server, "IDLE", 0.3)
    with served() as client, socket.create_connection(("127.0.0.1", client.port), 30) as silent:
        silent.sendall(said)
        assert silent.recv(100) == b""


def test_a_connection_on_which_something_is_answered_stays():
    """However long the answer takes, and for a whole period after it; looked at step by step."""
    closed, looks = [], []
    prompt = object.__new__(http_server._Prompt)
    prompt.transport = SimpleNamespace(is_closing=lambda: bool(closed), close=lambda: closed.append(True))
    prompt.loop = SimpleNamespace(call_later=lambda seconds, look: looks.append(look))
    prompt.cycle = SimpleNamespace(response_complete=False)
    for _ in range(4):
        prompt._look()
    prompt.cycle.response_complete = True
    prompt._look()
    prompt.cycle = SimpleNamespace(response_complete=True)  # another request came and was answered
    prompt._look()
    assert (len(looks), closed) == (6, [])
    prompt._look()
    assert closed == [True]
    prompt._look()
    assert len(looks) == 6


@pytest.mark.parametrize(
    ("given_", "told"),
    [({"workers": 0}, "workers should be"), ({"budget": 1e5}, "up to 3600"), ({"rate": float("nan")}, "rate should be"),
     ({"claims": 300}, "only 200 may wait")],
)  # fmt: skip
def test_limits_that_make_no_sense_are_refused(given_, told):
    with pytest.raises(ValueError, match=told):
        Limits(**given_)


@given(
    st.lists(st.tuples(st.floats(0, 10), st.floats(0.01, 5)), max_size=60),
    st.floats(0.1, 10),
    st.floats(1, 20),
)
def test_over_any_time_a_client_gets_no_more_than_its_burst_and_its_rate(asked, rate, burst):
    """Whatever is asked when: what was let through never exceeds burst + rate × time by more than one request."""
    now, let_through = 0.0, 0.0
    buckets = Buckets(rate, burst, lambda: now)
    for pause, tokens in asked:
        now += pause
        wait = buckets.take("client", tokens)
        assert wait >= 0.0
        if not wait:
            let_through += tokens
            assert let_through <= burst + rate * now + tokens + 1e-6
        else:
            now += wait * (1 + 1e-9) + 1e-9
            assert buckets.take("client", tokens) == 0.0
            let_through += tokens
    assert buckets.take("another", 1.0) == 0.0


def test_the_clients_that_are_remembered_are_bounded():
    buckets = Buckets(1.0, 1.0, lambda: 0.0)
    for number in range(MOST_CLIENTS + 500):
        buckets.take(str(number), 1.0)
    assert len(buckets._levels) == MOST_CLIENTS
