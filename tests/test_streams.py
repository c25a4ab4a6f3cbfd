"""Streams that are closed, full or no files, and processes whose parent was killed or interrupted."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from canon.cli import main
from canon.exercise import Sheet, SheetError, read_sheet
from canon.exercise.sheet_check import check
from canon.given_file import UnreadableFile, bytes_of
from canon.study.cases.store import Store

ONE = (
    '[[claim]]\nid = "one"\nkind = "equality-only"\nlhs = "2*x"\nrhs = "x + x"\nparameters = { x = "real" }\n'
)
CANON = [sys.executable, "-P", "-c", "import sys; from canon.cli import main; sys.exit(main(sys.argv[1:]))"]
LONG = """
[[study]]
system = "henon-heiles"
method = ["verlet", "rk4"]
step = 0.01
span = 1e7
"""

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="these are streams and signals of POSIX")


@pytest.fixture
def sheet(tmp_path):
    file = tmp_path / "one.toml"
    file.write_text(ONE)
    return file


def run(redirection, *arguments):
    """Run a command through a shell with streams redirected; return its status and what reached standard error."""
    told = f'exec "$@" {redirection}'
    return subprocess.run(
        ["/bin/sh", "-c", told, "sh", *CANON, *map(str, arguments)],
        capture_output=True,
        text=True,
        env={name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"},
        check=False,
    )


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no device that is always full")
def test_a_full_output_is_told_in_one_line(sheet):
    done = run("> /dev/full", "check", sheet)
    assert done.stderr == "canon: standard output can't be written: No space left on device\n"
    assert done.returncode == 2
    both = run("> /dev/full 2> /dev/full", "--version")
    assert both.returncode == 2


def test_a_closed_output_is_no_fault(sheet):
    done = run("<&- >&-", "check", sheet)
    assert (done.returncode, done.stderr) == (0, "")
    sheet.write_text(ONE.replace("x + x", "x + 1"))
    assert run(">&- 2>&-", "check", "--jobs", "2", sheet).returncode == 1


def test_a_closed_input_is_told():
    done = run("<&-", "check", "-")
    assert (done.returncode, done.stderr) == (2, "canon check: standard input: it is closed\n")


def test_pipes_and_devices_are_no_sheets(tmp_path):
    fifo = tmp_path / "answers.toml"
    os.mkfifo(fifo)
    for path, kind in ((fifo, "a pipe"), ("/dev/zero", "a device"), (tmp_path, "Is a directory")):
        with pytest.raises(SheetError, match=kind):
            read_sheet(path)


def test_a_pipe_that_a_shell_made_is_read(tmp_path):
    reading, writing = os.pipe()
    os.write(writing, b"some text")
    os.close(writing)
    assert bytes_of(Path(f"/dev/fd/{reading}"), 100, "split it") == b"some text"
    os.close(reading)
    (tmp_path / "long").write_bytes(b"x" * 101)
    with pytest.raises(UnreadableFile, match="more than 100 bytes, and no more are read; split it"):
        bytes_of(tmp_path / "long", 100, "split it")
    with pytest.raises(UnreadableFile, match="null"):
        bytes_of(Path("a\0b"), 100, "split it")


@pytest.mark.parametrize("name", ["one.toml", "one.json"])
def test_a_byte_order_mark_is_passed_over(tmp_path, name):
    claim = {"id": "one", "kind": "equality-only", "lhs": "1", "rhs": "1"}
    text = ONE if name.endswith("toml") else json.dumps({"claims": [claim]})
    (tmp_path / name).write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert [claim.id for claim in read_sheet(tmp_path / name).claims] == ["one"]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('{"claims": []}', "a list of claims without a claim"),
        ("[]", "a list of claims without a claim"),
        ('{"claims": [], "claim": [{"id": "a"}]}', "claims stand under 'claims' and under 'claim'"),
        ("{}", "no claims"),
    ],
)
def test_a_sheet_without_claims_is_bad_usage(tmp_path, capsys, text, told):
    file = tmp_path / "empty.json"
    file.write_text(text)
    assert main(["check", str(file)]) == 2
    assert told in capsys.readouterr().err
    assert check(Sheet("nothing", ())).exit_status == 2


def test_a_title_is_no_line_of_the_table(tmp_path, capsys):
    file = tmp_path / "forged.toml"
    forged = 'title = "Answers\\n✓ holds     one   equality-only"\n'
    file.write_text(forged + ONE.replace("x + x", "x + 1").replace('"one"', '"one\\n✓ holds"'))
    assert main(["check", str(file)]) == 1
    assert not any(line.startswith("✓") for line in capsys.readouterr().out.splitlines())


def has_ended(pid):
    """Tell whether a process is gone, or is but an entry that nobody has put away yet."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] in "ZX"
    except FileNotFoundError:
        return True


def children(pid):
    listed = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return [int(child) for child in listed]


@pytest.fixture
def begun(tmp_path):
    """A study that runs on two processes, both of which are at work."""
    file = tmp_path / "long.toml"
    file.write_text(LONG)
    command = [*CANON, "study", "run", str(file), "--jobs", "2", "--checkpoint", "0"]
    signal.signal(signal.SIGINT, signal.default_int_handler)  # where the tests run in the background too
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as program:
        kept = file.with_suffix(".sqlite")
        while not (kept.exists() and kept.stat().st_size and len(Store(kept).parts_done()) == 2):
            assert program.poll() is None
            time.sleep(0.1)
        yield program
        program.kill()


@pytest.mark.slow
def test_an_interrupted_study_prints_one_line(begun):
    os.killpg(begun.pid, signal.SIGINT)
    out, err = begun.communicate()
    assert (begun.returncode, out, err) == (130, "", "canon: interrupted\n")


POOL_THAT_NEVER_ENDS = """
import concurrent.futures, signal, sys, threading, time
from canon.cli import main
class Stuck(concurrent.futures.ProcessPoolExecutor):
    def shutdown(self, *args, **choices):
        threading.Event().wait()
concurrent.futures.ProcessPoolExecutor = Stuck
if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(3.0, signal.raise_signal, [signal.SIGINT]).start()
    sys.exit(main(["study", "run", sys.argv[1], "--jobs", "2"]))
"""


@pytest.mark.slow
def test_an_interrupted_study_ends_even_where_its_pool_does_not(tmp_path):
    """A worker that is killed while it sends leaves Python's pool waiting for the rest: seen once in many runs."""
    file, program = tmp_path / "long.toml", tmp_path / "stuck.py"
    file.write_text(LONG)
    program.write_text(POOL_THAT_NEVER_ENDS)
    done = subprocess.run(
        [sys.executable, str(program), str(file)], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (130, "")
    assert "canon: interrupted" in done.stderr.splitlines()


@pytest.mark.skipif(
    not Path("/proc/self/task").exists(), reason="processes are looked for where Linux lists them"
)
def test_the_workers_of_a_killed_study_end(begun):
    workers = children(begun.pid)
    assert len(workers) >= 2
    begun.kill()
    wait_for(workers)


PARENT = """
import time
from canon.exercise.judging_process import Worker
from canon.exercise.sheet.sheet import Claim
worker = Worker()
same = {"lhs": "x", "rhs": "x", "parameters": {"x": "real"}}
worker.judge(Claim("a", "equality-only", same))
print(worker._child.pid, flush=True)
worker._child.send(lambda: b"[" * 10_000_000, 600.0)
time.sleep(600)
"""


@pytest.mark.skipif(
    not Path("/proc/self/task").exists(), reason="processes are looked for where Linux lists them"
)
def test_a_judging_process_ends_with_its_parent():
    with subprocess.Popen([sys.executable, "-c", PARENT], stdout=subprocess.PIPE, text=True) as program:
        judging = int(program.stdout.readline())
        assert not has_ended(judging)
        program.kill()
    wait_for([judging])


def wait_for(pids):
    """Return once all have ended; one that goes on would hang here."""
    while not all(map(has_ended, pids)):
        time.sleep(0.05)
