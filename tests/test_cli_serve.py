"""``canon serve``: on loopback, ended by a signal when what is in hand was answered, a sentence where it can't run."""

from __future__ import annotations

import http.client
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time

import pytest

from canon.cli import main
from tests.exercise.endless_claim import ENDLESS


def test_without_the_extra_it_says_what_to_install(monkeypatch, capsys):
    for name in ("starlette", "uvicorn"):
        monkeypatch.setitem(sys.modules, name, None)
    for name in [name for name in sys.modules if name.startswith("canon.serve.")]:
        monkeypatch.delitem(sys.modules, name)
    assert main(["serve"]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert "pip install 'canon-mechanics[serve]'" in told.err


def test_nothing_of_a_web_server_is_loaded_before_it_is_asked_for():
    code = (
        "import sys, canon, canon.serve, canon.cli\n"
        "for words in (['serve', '--help'], ['check', '--help']):\n"
        "    try: canon.cli.main(words)\n"
        "    except SystemExit: pass\n"
        "print(sorted({'starlette', 'uvicorn', 'sympy'} & set(sys.modules)), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"
    assert "--host ADDRESS" in done.stdout


@pytest.mark.parametrize(
    "words", [["--port", "70000"], ["--workers", "0"], ["--budget", "nan"], ["--rate", "-1"]]
)
def test_what_makes_no_sense_is_refused(words, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["serve", *words])
    assert ended.value.code == 2
    assert words[0] in capsys.readouterr().err


def test_a_claim_has_an_hour_at_most(capsys):
    pytest.importorskip("uvicorn", reason="the extra 'serve' is not installed")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        words = ["serve", "--port", str(taken.getsockname()[1]), "--budget"]
        assert main([*words, "3600"]) == 2
        assert "in use" in capsys.readouterr().err
        with pytest.raises(SystemExit):
            main([*words, "3601"])
    assert "up to 3600" in capsys.readouterr().err


def test_limits_that_contradict_each_other_are_refused(capsys):
    pytest.importorskip("uvicorn", reason="the extra 'serve' is not installed")
    assert main(["serve", "--claims", "300"]) == 2
    assert "raise waiting" in capsys.readouterr().err


def test_a_port_that_is_taken_is_told(capsys):
    pytest.importorskip("uvicorn", reason="the extra 'serve' is not installed")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        assert main(["serve", "--port", str(taken.getsockname()[1])]) == 2
    assert "in use" in capsys.readouterr().err


class Running:
    """A service in a process of its own, and its log."""

    def __init__(self, *words):
        command = [sys.executable, "-P", "-m", "canon", "serve", "--port", "0", *words]
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.log = []
        self.port = 0
        for line in self.process.stderr:
            self.log.append(json.loads(line))
            self.port = self.log[-1].get("port", self.port)
            if "startup complete" in self.log[-1]["event"]:
                break
        self.rest = threading.Thread(target=lambda: self.log.extend(map(json.loads, self.process.stderr)))
        self.rest.start()

    def ask(self, path, body=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port)
        said = json.dumps(body) if body is not None else None
        connection.request("POST" if said else "GET", path, said, {"Content-Type": "application/json"})
        answer = connection.getresponse()
        found = answer.status, json.loads(answer.read())
        connection.close()
        return found


@pytest.mark.skipif(sys.platform == "win32", reason="signals are POSIX's")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_it_when_what_is_in_hand_was_answered(number):
    pytest.importorskip("uvicorn", reason="the extra 'serve' is not installed")
    service = Running("--workers", "1", "--budget", "1.0")
    try:
        assert service.log[0]["host"] == "127.0.0.1"
        found = []
        asking = threading.Thread(target=lambda: found.append(service.ask("/check", ENDLESS)))
        asking.start()
        while service.ask("/health")[1]["waiting"]["claims"] == 0:
            time.sleep(0.02)
        service.process.send_signal(number)
        asking.join()
        assert service.process.wait() == 0
        ((status, judgement),) = found
        assert (status, judgement["status"]) == (200, "undecided")
        assert judgement["known"]
        with pytest.raises(ConnectionRefusedError):
            service.ask("/health")
    finally:
        service.process.kill()
        service.rest.join()
        with service.process.stdout as out, service.process.stderr:
            printed = out.read()
    assert printed == ""
    assert service.log[-1]["event"] == "stopped"
    (line,) = (line for line in service.log if line.get("path") == "/check")
    assert (line["method"], line["status"], line["claims"], line["undecided"]) == ("POST", 200, 1, 1)
    assert {"time", "level", "seconds", "client", "bytes"} <= line.keys()
    assert ENDLESS["L"] not in json.dumps(service.log)
    with pytest.raises(ProcessLookupError):
        os.kill(service.process.pid, 0)
