"""The limits of the service: who asks too much is told so, and when to come back; others are served."""

from __future__ import annotations

import asyncio
import logging
import queue
import socket
import threading
from contextlib import contextmanager
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

pytest.importorskip("starlette", reason="the extra 'serve' is not installed")

from starlette.applications import Starlette
from starlette.responses import Response, StreamingResponse
from starlette.routing import Route

from canon.exercise.report.judgement import Judgement
from canon.serve import Limits, application, http_server, text_reader, web_application
from canon.serve.guarded_responses import HEADERS
from canon.serve.refusal import Refusal
from canon.serve.token_bucket import MOST_CLIENTS, Buckets, WorkTime

RIGHT = {"id": "right", "kind": "equality-only", "lhs": "2*x", "rhs": "x + x", "parameters": {"x": "real"}}


class Slow:
    """A pool whose claims are judged when the test says so."""

    def __init__(self, workers, budget):
        self.budget, self.go, self.asked = budget, threading.Event(), []
        self.processes, self.started = tuple(range(workers)), workers

    def judge(self, claim):
        self.asked.append(claim)
        self.go.wait()
        return Judgement(claim.id, claim.kind, "undecided", 3.0, known="not looked at")

    def close(self):
        self.go.set()


class Silent:
    """A reader that reads nothing, or says that it worked for long."""

    waiting = 0

    async def how_read(self, asked, work):
        work.seconds += {"long": 3.0, "endless": 3.0}.get(asked["text"], 0.0)
        if asked["text"] == "endless":
            raise Refusal(422, "this text could not be read")
        return {"read": True, "statements": [], "warnings": []}

    def close(self):
        pass


@pytest.fixture
def served(monkeypatch, running):
    monkeypatch.setattr("canon.serve.judging_queue.JudgePool", Slow)
    monkeypatch.setattr("canon.serve.web_application.TextReader", Silent)
    return lambda **limits: running(application(Limits(**limits)))


def http_connections(client):
    return len(client.server.server_state.connections)


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
        owed = int(answers[1].headers["retry-after"])
        assert 59 <= owed <= 61  # a claim's worth, and what it took to look at the requests
        assert client.post("/read", json={"text": "x"}).status_code == 429
        assert client.get("/health").status_code == 200


@pytest.mark.parametrize(("text", "status"), [("long", 200), ("endless", 422)])
def test_a_text_that_takes_long_to_read_costs_what_its_reading_takes(served, text, status):
    """Three seconds of a process cost as many claims as three seconds of judging do, whatever came of them."""
    with served(rate=1.0, burst=3.0) as client:
        assert client.post("/read", json={"text": text}).status_code == status
        refused = client.post("/read", json={"text": "x"})
        assert refused.status_code == client.post("/check", json=RIGHT).status_code == 429
        assert 1 <= int(refused.headers["retry-after"]) <= 61
    with served(rate=1.0, burst=3.0) as client:
        assert [client.post("/read", json={"text": "x"}).status_code for _ in range(9)] == [200] * 9


def test_what_is_no_claim_is_not_free(served):
    json_ = {"Content-Type": "application/json"}
    with served(rate=0.001, burst=1.0) as client:
        answers = [client.post("/check", content=b"{", headers=json_).status_code for _ in range(42)]
        assert (answers[0], answers[-1]) == (400, 429)


def test_the_work_of_reading_is_counted_where_it_ends_and_where_it_does_not(monkeypatch):
    """By a process that answers, then one that does not; the next one is started at the cost of the same text."""
    started = []

    class Process:
        usable = True

        def __init__(self, *_, **__):
            started.append(self)
            self.asked = 0

        def send(self, encode, seconds):
            self.asked += 1

        def receive(self, deadline):
            if self.asked == 2:
                raise text_reader.Late
            return b"{}"

        def kill(self):
            self.usable = False

    clock = iter(range(100)).__next__

    async def asked():
        reader = text_reader.TextReader()
        found = []
        for _ in range(3):
            work = WorkTime(clock)
            try:
                await reader.how_read({"text": "x"}, work)
            except Refusal as refusal:
                found.append(refusal.status)
            found.append(work.seconds)
        reader.close()
        return found

    monkeypatch.setattr(text_reader, "Child", Process)
    assert asyncio.run(asked()) == [1, 422, 1, 1]
    assert [process.usable for process in started] == [False, False]


def test_a_process_that_ended_or_has_read_enough_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[Reading] = []

    class Reading:
        """A process that says how many texts it was asked before, and can be killed by others."""

        def __init__(self, *_: object, **__: object) -> None:
            started.append(self)
            self.usable, self.asked = True, -1

        def send(self, encode: object, seconds: float) -> None:
            assert self.usable

        def receive(self, deadline: float) -> bytes:
            self.asked += 1
            return b'{"before": %d}' % (self.asked - 1)

        def kill(self) -> None:
            self.usable = False

    async def asked() -> list[int]:
        reader, found = text_reader.TextReader(), []
        for number in range(7):
            if number == 5:
                started[-1].usable = False
            found.append((await reader.how_read({"text": "x"}, WorkTime()))["before"])
        reader.close()
        return found

    monkeypatch.setattr(text_reader, "Child", Reading)
    monkeypatch.setattr(text_reader, "TEXTS_A_PROCESS", 3)
    assert asyncio.run(asked()) == [0, 1, 2, 0, 1, 0, 1]
    assert len(started) == 3


class Endless:
    """A process that is ready at once, and reads until it is killed."""

    def __init__(self, *_: object, **__: object) -> None:
        self.usable, self.reading, self.killed = True, threading.Event(), threading.Event()

    def send(self, encode: object, seconds: float) -> None:
        self.reading.set()

    def receive(self, deadline: float) -> bytes:
        if not self.reading.is_set():
            return b""
        self.killed.wait()
        raise text_reader.Ended

    def kill(self) -> None:
        self.usable = False
        self.killed.set()


def test_a_reader_that_is_closed_while_it_reads_starts_no_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """It once took its killed process for one that broke off, and started another, which nobody killed."""
    started: list[Endless] = []

    class Process(Endless):
        def __init__(self, *_: object, **__: object) -> None:
            super().__init__()
            started.append(self)

    async def closed() -> int:
        reader = text_reader.TextReader()
        asked = asyncio.create_task(reader.how_read({"text": "x"}, WorkTime()))
        while not (started and started[0].reading.is_set()):
            await asyncio.sleep(0)
        reader.close()
        with pytest.raises(Refusal, match="the service is ending") as refused:
            await asked
        return refused.value.status

    monkeypatch.setattr(text_reader, "Child", Process)
    assert asyncio.run(closed()) == 503
    assert [process.usable for process in started] == [False]


def test_a_reader_that_is_closed_while_its_process_starts_kills_it(monkeypatch: pytest.MonkeyPatch) -> None:
    made: queue.SimpleQueue[text_reader.TextReader] = queue.SimpleQueue()
    closing: list[threading.Thread] = []
    started: list[Endless] = []

    class Process(Endless):
        def __init__(self, *_: object, **__: object) -> None:
            super().__init__()
            closing.append(threading.Thread(target=made.get().close))
            closing[0].start()
            closing[0].join(0.1)  # until it is closed, or waits for this process
            started.append(self)

    monkeypatch.setattr(text_reader, "Child", Process)
    made.put(text_reader.TextReader())
    while not started:
        pass
    closing[0].join()
    assert [process.usable for process in started] == [False]


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [("::ffff:192.0.2.1", "192.0.2.1", True), ("::ffff:192.0.2.1", "::ffff:192.0.2.2", False),
     ("2001:db8::1", "2001:db8::2", True), ("2001:db8::1", "2001:db8:0:1::1", False),
     ("192.0.2.1", "192.0.2.2", False)],
)  # fmt: skip
def test_a_client_is_an_address_or_the_network_of_one_person(one, other, same):
    """A socket for both versions of IP names clients of version 4 within one network of version 6."""
    clients = [
        web_application._client(SimpleNamespace(client=SimpleNamespace(host=host))) for host in (one, other)
    ]
    assert (clients[0] == clients[1]) is same


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
        first.join()
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
            thread.join()
        assert [claim.id for claim in pool_of(client).asked].index("short") <= 2


@contextmanager
def logged():
    """Give the lines that the service and its server log: the status of each, and the exception."""
    lines = []

    class Kept(logging.Handler):
        def emit(self, record):
            lines.append((getattr(record, "said", {}).get("status"), record.exc_info))

    kept, loggers = Kept(logging.INFO), [logging.getLogger(name) for name in ("canon.serve", "uvicorn.error")]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.addHandler(kept)
        logger.setLevel(logging.INFO)
    try:
        yield lines
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.removeHandler(kept)
            logger.setLevel(level)


def test_a_client_that_goes_in_the_middle_of_its_request_is_no_fault(served):
    with logged() as lines:
        with served() as client, socket.create_connection(("127.0.0.1", client.port)) as going:
            head = b"POST /check HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
            going.sendall(head + b"Content-Length: 50\r\n\r\n[")
            while not http_connections(client):
                pass
            going.close()
            while (499, None) not in lines:
                pass
        assert not [error for _, error in lines if error]


@pytest.mark.parametrize("host", [b"localhost", b"elsewhere.example"])
def test_a_body_that_is_no_http_behind_a_good_head_is_no_fault(served, host):
    """The server answers 400 by itself and hangs up, perhaps before the service has said what it thinks of the head."""
    with logged() as lines:
        with served() as client, socket.create_connection(("127.0.0.1", client.port)) as broken:
            broken.sendall(
                b"POST /check HTTP/1.1\r\nHost: "
                + host
                + b"\r\nTransfer-Encoding: chunked\r\n\r\nno chunk\r\n"
            )
            assert broken.recv(1000).startswith(b"HTTP/1.1 400 ")
            while not any(status for status, _ in lines):
                pass
        assert not [error for _, error in lines if error]


@pytest.mark.parametrize("said", [b"", b"POST /check HTTP/1.1\r\nHost: local"])
def test_a_connection_on_which_no_request_comes_is_closed(served, monkeypatch, said):
    monkeypatch.setattr(http_server, "IDLE", 0.3)
    with served() as client, socket.create_connection(("127.0.0.1", client.port)) as silent:
        silent.sendall(said)
        assert silent.recv(100) == b""


async def pieces(ended):
    try:
        while True:
            await asyncio.sleep(0)  # as one waits for a verdict
            yield b"x" * 1_000_000
    finally:
        ended.set()


@pytest.mark.parametrize("whole", [True, False], ids=["an answer in one", "an answer in pieces"])
def test_a_client_that_does_not_take_its_answer_is_let_go(monkeypatch, running, whole):
    """Nothing more is made for it, and what was made is dropped; others are answered."""
    monkeypatch.setattr(http_server, "UNREAD", 0.3)
    ended = threading.Event()

    async def much(_):
        return Response(b"x" * 50_000_000) if whole else StreamingResponse(pieces(ended))

    async def little(_):
        return Response(b"here")

    with (
        running(Starlette(routes=[Route("/much", much), Route("/", little)])) as client,
        socket.create_connection(("127.0.0.1", client.port)) as deaf,
    ):
        deaf.sendall(b"GET /much HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert whole or ended.wait()
        while client.get("/").content != b"here" or http_connections(client) > 0:
            pass  # what keeps a connection that nobody reads would hang here
        got = 0
        while piece := deaf.recv(1_000_000):
            got += len(piece)
        assert got < 50_000_000  # what the system had taken already


def test_a_client_that_takes_its_answer_slowly_gets_all_of_it(running):
    async def much(_):
        return Response(b"x" * 20_000_000)

    with (
        running(Starlette(routes=[Route("/", much)])) as client,
        socket.create_connection(("127.0.0.1", client.port)) as slow,
    ):
        slow.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
        found = 0
        while piece := slow.recv(10_000):
            found += piece.count(b"x")
    assert found == 20_000_000


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


def test_a_fault_of_the_service_is_no_answer_and_stands_in_the_log(served):
    """An error that nobody thought of is a 500 with the usual headers, and its traceback is logged, once each."""
    lines = []

    class Kept(logging.Handler):
        def emit(self, record):
            lines.append((record.name, getattr(record, "said", {}).get("status"), record.exc_info))

    def broken(_):
        raise RuntimeError("nobody thought of this")

    loggers, kept = [logging.getLogger(name) for name in ("canon.serve", "uvicorn.error")], Kept(logging.INFO)
    levels = [logger.level for logger in loggers]
    with served() as client:
        pool_of(client).judge = broken
        for logger in loggers:
            logger.addHandler(kept)
            logger.setLevel(logging.INFO)
        answer = client.post("/check", json=RIGHT)
        assert client.get("/health").json()["waiting"]["claims"] == 0
    for logger, level in zip(loggers, levels, strict=True):  # the server tells of it after it has answered
        logger.removeHandler(kept)
        logger.setLevel(level)
    assert (answer.status_code, answer.json()["detail"]) == (
        500,
        "a fault of the service; its log says where",
    )
    assert {name.lower() for name in HEADERS} <= set(answer.headers)
    assert "nobody" not in answer.text
    assert [status for name, status, _ in lines if name == "canon.serve"] == [500, 200]
    assert [str(error[1]) for *_, error in lines if error] == ["nobody thought of this"]


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


def test_who_has_not_asked_for_longest_is_forgotten_first():
    buckets = Buckets(1.0, 1.0, lambda: 0.0)
    for number in range(MOST_CLIENTS + 1):
        buckets.take(str(number), 1.0)
    assert buckets.take(str(MOST_CLIENTS), 1.0) > 0.0
    assert buckets.take("1", 1.0) > 0.0
    assert buckets.take("0", 1.0) == 0.0
