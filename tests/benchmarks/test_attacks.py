"""The attacks of benchmarks/robustness.py: small samples of each find nothing, and what went wrong would be counted."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

pytest.importorskip("starlette", reason="the extra 'serve' is not installed")
pytest.importorskip("resource", reason="limits on files are those of POSIX")
sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

import robustness
from attacks import claims, requests, streams
from attacks.count import BAD, Count


def test_a_small_sample_of_hostile_claims(tmp_path):
    found = claims.hostile_claims(30, tmp_path, seed=2)
    assert found.bad == 0, str(found)
    assert found.outcomes.total() >= 30


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="processes are found as Linux lists them")
@pytest.mark.parametrize(
    ("sort", "count"),
    [
        ("bits", 20),
        ("kept", 20),
        ("stores", 25),
        ("studies", 40),
        ("kills", 6),
        ("streams", 12),
        ("requests", 90),
    ],
)
def test_a_small_sample(tmp_path, sort, count):
    found = robustness.SORTS[sort][0](count, tmp_path, 2)
    assert found.bad == 0, str(found)
    assert found.outcomes.total() >= count


@pytest.mark.parametrize(
    ("judgement", "outcome"),
    [({"status": "holds", "seconds": 0.1}, "false verdict"), ({"status": "fails", "seconds": 0.1}, "fails"),
     ({"status": "undecided", "seconds": 9.0}, "over budget")],
)  # fmt: skip
def test_false_and_late_verdicts_are_counted(monkeypatch, judgement, outcome):
    monkeypatch.setattr(claims, "load_is_low", lambda: True)
    assert claims._outcome(judgement) == outcome
    assert (outcome in BAD) is (outcome != "fails")


@pytest.mark.parametrize("said", ["\x1b[2J", "\x9b31m", "a\rb", "\u202ex"])
def test_what_commands_a_terminal_is_seen(said):
    assert claims._commands(f"fails {said}")
    assert not claims._commands("✗ fails\n\tθ")


@pytest.mark.parametrize(
    ("answer", "outcome"),
    [(b"HTTP/1.1 200 OK\r\nAccess-Control-Allow-Origin: *\r\n\r\n", "false line"), (b"", "closed without a word"),
     (b"HTTP/1.1 500 x\r\n\r\n", "wrong status"), (b"HTTP/1.1 200 OK\r\n\r\n", "wrong status"),
     (b"HTTP/1.1 421 x\r\n\r\n", "status 421")],
)  # fmt: skip
def test_wrong_answers_of_the_service_are_counted(monkeypatch, answer, outcome):
    status = int(answer.split()[1]) if answer else 0
    monkeypatch.setattr(requests, "_answer", lambda port, sent: (status, answer))
    assert requests._outcome(0, b"", (421,)) == outcome
    assert (outcome in BAD) is (outcome != "status 421")


def test_code_that_ran_and_tracebacks_are_counted(tmp_path, monkeypatch):
    monkeypatch.setattr(streams, "CANON", [sys.executable, "-c", "raise SystemExit(0)"])
    monkeypatch.setitem(streams.SURROUNDINGS, "x", "echo Traceback >&2; true")
    assert streams._outcome("x", "version", tmp_path) == "traceback"
    monkeypatch.setitem(streams.SURROUNDINGS, "x", "kill -9 $$")
    assert streams._outcome("x", "version", tmp_path) == "wrong status"
    (tmp_path / "owned").write_text("")
    assert streams._outcome("x", "version", tmp_path) == "code run"


def test_what_was_interrupted_goes_on_with_the_next_piece(tmp_path, monkeypatch, capsys):
    """Pieces that have ended are not done again; on another commit all are."""
    done, commit = [], ["one"]

    def attack(count, folder, seed):
        if seed == 3 and done.count(3) == 0:
            done.append(3)
            raise KeyboardInterrupt
        done.append(seed)
        found = Count("attacks")
        found.outcomes["traceback" if seed == 2 else "told"] = count
        found.first = {"traceback": "piece 2"} if seed == 2 else {}
        return found

    monkeypatch.setattr(robustness, "RECORD", tmp_path / "robustness.json")
    monkeypatch.setattr(robustness, "SORTS", {"some": (attack, 40, 10)})
    monkeypatch.setattr(robustness, "_commit", lambda sort: commit[0])
    with pytest.raises(KeyboardInterrupt):
        robustness.main(["some"])
    assert robustness.main(["some"]) == 1  # a traceback was among them
    assert done == [1, 2, 3, 3, 4]
    assert "attacks: 40: 30 told, 10 traceback; 10 bad\n  traceback: piece 2" in capsys.readouterr().out
    assert set(json.loads((tmp_path / "robustness.json").read_text())["some"]["pieces"]) == {
        "1",
        "2",
        "3",
        "4",
    }
    robustness.main(["some"])
    assert len(done) == 5
    commit[0] = "two"
    robustness.main(["some"])
    assert len(done) == 9
