"""The service: verdicts as the command gives them, texts as they are read, and a sentence for what it does not do."""

from __future__ import annotations

import codecs
import json
import os
import signal
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields
from xml.etree.ElementTree import fromstring

import pytest

pytest.importorskip("starlette", reason="the extra 'serve' is not installed")

from canon.cli import main
from canon.exercise.report.judgement import Judgement
from canon.exercise.sheet.kinds import KINDS
from canon.exercise.sheet.sheet import bundled_sheet
from canon.serve import Limits, application
from canon.serve.guarded_responses import HEADERS

RIGHT = {"id": "right", "kind": "equality-only", "lhs": "2*x", "rhs": "x + x", "parameters": {"x": "real"}}
WRONG = {**RIGHT, "id": "wrong", "rhs": "x + 1"}
PENDULUM = {"q": ["theta"], "parameters": {"g": "real", "l": "real"}}
LINES = {"Accept": "application/x-ndjson"}
MANY = Limits(workers=2, budget=5.0, body=20_000, claims=8, waiting=40, rate=1e6, burst=1e6)


@pytest.fixture(scope="module")
def client(running):
    with running(application(MANY)) as made:
        yield made


def said_without_time(judgement):
    return {key: value for key, value in judgement.items() if key not in ("seconds", "file")}


def test_verdicts_are_those_of_the_command(client, tmp_path, capsys):
    """One claim as an object, a sheet as a list or as lines: each the line that ``canon check --json`` prints."""
    sheet = {"title": "both", "claims": [RIGHT, WRONG, {"id": "odd", "kind": "equality-only", "lhs": "1"}]}
    (path := tmp_path / "sheet.json").write_text(json.dumps(sheet))
    main(["check", "--json", str(path)])
    printed = [said_without_time(json.loads(line)) for line in capsys.readouterr().out.splitlines()]
    assert [one["status"] for one in printed] == ["holds", "fails", "invalid"]
    answer = client.post("/check", json=sheet).json()
    assert [said_without_time(one) for one in answer["verdicts"]] == printed
    assert (answer["title"], answer["counts"]) == ("both", {"holds": 1, "fails": 1, "invalid": 1})
    lines = client.post("/check", json=sheet, headers=LINES).text.splitlines()
    assert [said_without_time(json.loads(line)) for line in lines] == printed
    alone = [client.post("/check", json=claim).json() for claim in (RIGHT, WRONG)]
    assert [said_without_time(one) for one in alone] == printed[:2]
    assert set(alone[0]) == {*(field.name for field in fields(Judgement)), "earned"}


def test_a_claim_with_the_key_claim_is_no_sheet(client):
    pendulum = dict(bundled_sheet().claims[0].keys)
    assert client.post("/check", json=pendulum).json()["status"] == "holds"


def test_what_holds_for_one_is_remembered_by_what_is_said_and_not_by_its_name(client):
    first = client.post("/check", json={**RIGHT, "lhs": "7*x", "rhs": "3*x + 4*x"}).json()
    again = client.post("/check", json={**RIGHT, "id": "b", "lhs": "7*x", "rhs": "3*x + 4*x"}).json()
    assert (again["id"], again["status"], again["seconds"]) == ("b", "holds", 0.0)
    assert first["seconds"] > 0.0
    assert client.post("/check", json={**RIGHT, "lhs": "7*x", "rhs": "3*x - 4*x"}).json()["status"] == "fails"
    other_sign = {**RIGHT, "lhs": "sqrt(x**2)", "rhs": "x"}
    assert client.post("/check", json=other_sign).json()["status"] == "fails"
    assert (
        client.post("/check", json={**other_sign, "parameters": {"x": "positive"}}).json()["status"]
        == "holds"
    )


def test_one_claim_may_begin_with_a_byte_order_mark(client):
    head = {"Content-Type": "application/json"}
    for mark in (b"", codecs.BOM_UTF8):
        answer = client.post("/check", content=mark + json.dumps(RIGHT).encode(), headers=head)
        assert answer.json()["status"] == "holds"


def test_what_is_no_json_is_no_claim(client):
    glued = json.dumps(RIGHT).encode() + b'], "title": "x", "source": ["y"'
    answer = client.post("/check", content=glued, headers={"Content-Type": "application/json"})
    assert answer.status_code == 400


def test_a_text_is_shown_as_it_was_read(client):
    asked = {"text": r"\ddot\theta + \frac{g}{l}\sin\theta = 0", **PENDULUM}
    (found,) = client.post("/read", json=asked).json()["statements"]
    assert found["plain"] == "g*sin(theta)/l + theta_ddot = 0"
    math = fromstring(found["mathml"])
    assert math.tag == "math"
    assert [each.text for each in math.iter("mi")] == ["θ", "g", "l", "sin", "θ"]
    plain = client.post("/read", json={**asked, "text": "theta'' + g/l*sin(theta) = 0"}).json()
    assert plain["statements"][0]["mathml"] == found["mathml"]
    twin = client.post("/read", json={**asked, "text": "theta'' - g/l*sin(theta) = 0"}).json()
    assert twin["statements"][0]["plain"] != found["plain"]


def test_a_quadrature_is_shown_as_it_was_read(client):
    asked = {"kind": "hamilton-jacobi", "key": "W", "q": ["x"], "p": ["p"], "constants": ["E"]}
    found = client.post("/read", json={**asked, "text": r"\int\sqrt{2E - x^2}\,dx"}).json()
    (statement,) = found["statements"]
    assert statement["plain"] == "Integral(sqrt(2*E - x**2), x)"
    assert "".join(fromstring(statement["mathml"]).itertext()).startswith("∫")
    other = client.post("/read", json={**asked, "key": "H", "text": r"\int x\,dx"}).json()
    assert other["error"]["column"] == 1


def test_a_text_that_is_not_read_says_where(client):
    answer = client.post("/read", json={"text": "2*z + 1", "q": ["x"]})
    assert answer.status_code == 200
    found = answer.json()
    assert found["read"] is False
    assert found["error"]["column"] == 3
    assert found["error"]["caret"] == "2*z + 1\n  ^"
    assert "z is not declared" in found["error"]["reason"]
    placed = {"kind": "lie-bracket", "key": "X", "text": ["y", "(x"], "x": ["x", "y"]}
    assert client.post("/read", json=placed).json()["error"]["place"] == "X[1]"


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('touch owned')",
        "9**9**9",
        "(" * 3000,
        "$\\frac{" * 800,
        "x" * 9000,
        "\x00\u202e",
    ],
)
def test_hostile_texts_are_refused_and_the_next_is_read(client, text):
    found = client.post("/read", json={"text": text, "q": ["x"]})
    assert found.status_code in (200, 422)
    assert not found.json().get("read")
    assert client.post("/read", json={"text": "x + 1", "q": ["x"]}).json()["read"] is True


@pytest.mark.parametrize(
    ("path", "body", "kind", "status", "told"),
    [
        ("/check", b"{", "application/json", 400, "not valid JSON"),
        ("/check", b"[]", "application/json", 400, "without a claim"),
        ("/check", b'"text"', "application/json", 400, "no claims"),
        ("/check", b'{"kind": "equality-only", "kind": "x"}', "application/json", 400, "stands twice"),
        ("/check", b"[" * 19_000, "application/json", 400, "nested too deeply"),
        ("/check", b'{"claims": [' + b"9" * 9_000 + b"]}", "application/json", 400, "digits"),
        ("/check", b"\xff\xfe", "application/json", 400, "not UTF-8"),
        ("/check", json.dumps([RIGHT] * 9).encode(), "application/json", 413, "at most 8"),
        ("/check", b" " * 20_001, "application/json", 413, "more than 20000 bytes"),
        ("/check", b"{}", "text/plain", 415, "send JSON as application/json"),
        ("/check", b"{}", "", 415, "send JSON as application/json"),
        ("/read", b"[]", "application/json", 400, '{"text": …}'),
        ("/read", b'{"text": NaN}', "application/json", 400, "NaN is not a number"),
        ("/read", b"[" * 9_000, "application/json", 400, "not valid JSON"),
    ],
)
def test_what_is_not_answered_says_why(client, path, body, kind, status, told):
    answer = client.post(path, content=body, headers={"Content-Type": kind} if kind else {})
    assert answer.status_code == status
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["status"] == status
    assert told in answer.json()["detail"]


def test_a_body_is_counted_whatever_it_says_of_its_length(client):
    def chunks():
        for _ in range(30):
            yield b" " * 1_000

    assert (
        client.post("/check", content=chunks(), headers={"Content-Type": "application/json"}).status_code
        == 413
    )
    lied = {"Content-Type": "application/json", "Content-Length": "9999999999"}
    assert client.post("/check", content=b"{}", headers=lied).status_code == 413


def test_other_paths_methods_and_names(client):
    for method, path, status in (
        ("GET", "/nothing", 404),
        ("GET", "/check", 405),
        ("GET", "/../page.js.map", 404),
    ):
        answer = client.request(method, path)
        assert (answer.status_code, answer.json()["status"]) == (status, status)
    misled = client.post("/check", json=RIGHT, headers={"Host": "attacker.example"})
    assert misled.status_code == 421
    assert "localhost" in misled.json()["detail"]
    assert client.get("/health", headers={"Host": "localhost:8000"}).status_code == 200


def test_a_hundred_letters_are_told_of_a_name_that_is_not_that_of_the_service(client):
    told = client.get("/health", headers={"Host": "a" * 99 + "bc"}).json()["detail"]
    assert told.startswith(f"this service is not called '{'a' * 99}b';")


def test_every_answer_forbids_what_the_page_does_not_need(client):
    for path in ("/", "/page.js", "/page.css", "/icon.svg", "/api", "/openapi.json", "/health", "/nothing"):
        answer = client.get(path)
        assert {name: answer.headers[name.lower()] for name in HEADERS} == HEADERS
        assert "access-control-allow-origin" not in answer.headers
    policy = dict(part.strip().split(" ", 1) for part in HEADERS["Content-Security-Policy"].split(";"))
    assert policy["default-src"] == "'none'"
    assert policy["script-src"] == policy["style-src"] == "'self'"


def test_the_pages_ask_for_nothing_from_elsewhere_and_have_no_script_inside(client):
    for path in ("/", "/api"):
        page = client.get(path).text
        assert "http://" not in page.replace("http://www.w3.org", "")
        assert "https://" not in page
        assert "style=" not in page
        assert all("></script>" in part for part in page.split("<script")[1:])
        assert " on" not in "".join(
            part.split(">")[0] for part in page.split("<")[1:] if not part.startswith("p")
        )
    script = client.get("/page.js").text
    assert "innerHTML" not in script
    assert "eval(" not in script


def test_the_document_tells_every_path_and_its_errors(client):
    document = client.get("/openapi.json").json()
    assert document["openapi"].startswith("3.1")
    paths = {route.path for route in client.app.routes} - {"/", "/page.js", "/page.css", "/icon.svg", "/api"}
    assert set(document["paths"]) == paths
    schemas = document["components"]["schemas"]
    assert schemas["Claim"]["properties"]["kind"]["enum"] == list(KINDS)
    verdict = client.post("/check", json=RIGHT).json()
    assert set(schemas["Verdict"]["properties"]) == set(verdict)
    used = json.dumps(document).split('"#/components/schemas/')[1:]
    assert {part.split('"')[0] for part in used} <= set(schemas)
    page = client.get("/api").text
    assert all(path in page for path in paths)
    assert all(f"<h3>{name}</h3>" in page for name in schemas)
    example = document["paths"]["/check"]["post"]["requestBody"]["content"]["application/json"]["example"]
    assert client.post("/check", json=example).json()["status"] == "holds"
    text = document["paths"]["/read"]["post"]["requestBody"]["content"]["application/json"]["example"]
    assert client.post("/read", json=text).json()["read"] is True


def test_the_page_knows_every_kind_and_its_examples_are_read(client):
    found = client.get("/kinds.json").json()
    assert set(found) == {name for name, kind in KINDS.items() if not kind.about}
    examples = {name: kind["example"] for name, kind in found.items() if kind["example"]}
    assert len(examples) >= 5
    for name, example in examples.items():
        for key in found[name]["answer"]:
            if key in example:
                asked = {**example, "kind": name, "key": key, "text": example[key]}
                asked = {
                    k: v for k, v in asked.items() if k not in ("L", "H", "F", "map", "inverse_map", "claim")
                }
                assert client.post("/read", json=asked).json()["read"] is True, (name, key)


def test_many_clients_at_once_each_get_their_own_answer(client):
    asked = [RIGHT if k % 3 else WRONG for k in range(24)]
    asked = [
        {**claim, "id": f"n{k}", "lhs": f"{claim['lhs']} + {k % 7} - {k % 7}"}
        for k, claim in enumerate(asked)
    ]
    with ThreadPoolExecutor(12) as threads:
        found = list(threads.map(lambda claim: client.post("/check", json=claim).json(), asked))
    assert [one["id"] for one in found] == [claim["id"] for claim in asked]
    assert [one["status"] for one in found] == ["holds" if k % 3 else "fails" for k in range(24)]


@pytest.mark.skipif(sys.platform == "win32", reason="it is killed as POSIX does")
def test_a_killed_process_is_noticed_and_replaced(client):
    pool = client.app.state.service.queue._pool
    before = client.get("/health").json()["processes"]
    assert before["running"] == before["wanted"] == 2
    for pid in pool.processes:
        os.kill(pid, signal.SIGKILL)
    found = [
        client.post("/check", json={**RIGHT, "lhs": f"2*x + {k}", "rhs": f"x + x + {k}"}).json()
        for k in range(90, 96)
    ]
    assert [one["status"] for one in found].count("holds") >= 4
    assert found[-1]["status"] == "holds"
    after = client.get("/health").json()["processes"]
    assert (after["running"], after["started"]) == (2, before["started"] + 2)
