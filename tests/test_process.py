"""The processes that judge and prove run canon and what it rests on, and nothing else, wherever they start."""

import io
import math
import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import threading
import time
import zipfile
from contextlib import suppress
from pathlib import Path

import pytest

from canon.cli import main
from canon.process import Child, Ended, Late, _limit_memory, _read, _write, end_with_parent
from canon.trusted_folders import RESTS_ON, safe_path, trusted_folders

ROOT = Path(__file__).parents[1]
TRAP = "import pathlib; pathlib.Path({marker!r}).open('a').write({name!r})\nraise SystemExit('owned')\n"
CUSTOM = ("sitecustomize", "usercustomize")
STANDARD = (
    "json",
    "queue",
    "decimal",
    "signal",
    "struct",
    "subprocess",
    "importlib",
    "pickle",
    "site",
    "canon",
)
JUDGE = """
import canon
keys = {"lhs": "$\\\\sin(2 x)$", "rhs": "2*sin(x)*cos(x)", "parameters": {"x": "real"}}
print(canon.check(canon.exercise.Sheet("s", (canon.exercise.Claim("a", "equality-only", keys),))).counts)
canon.expect("equality-only", **keys)
"""
PROVE = """
import sympy, canon
from canon.proof.worker.budget import prove_in_worker
x = sympy.Symbol("x", real=True)
print(prove_in_worker([sympy.sin(x)**2 + sympy.cos(x)**2 - 1], canon.Domain(), 30.0)[0].holds)
"""


@pytest.fixture
def hostile(tmp_path):
    """Return a folder in which modules lie in wait, and the file that says which of them ran."""
    folder, marker = tmp_path / "answers", tmp_path / "owned"
    folder.mkdir()

    def lay(*names):
        for name in names:
            (folder / f"{name}.py").write_text(TRAP.format(marker=str(marker), name=name), "utf-8")
        return folder, marker

    return lay


def run(arguments, folder, code="", **environment):
    kept = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONSAFEPATH")}
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        input=code,
        capture_output=True,
        text=True,
        env={**kept, "PYTHONPATH": str(ROOT), **environment},
        check=False,
    )


STARTS = {
    "-c": ["-c", JUDGE],
    "stdin": ["-"],
    "REPL": ["-i", "-q"],
    "module": ["-m", "code", "-q"],
    "script": ["run.py"],
}


@pytest.mark.parametrize("start", STARTS)
def test_nothing_in_the_working_folder_runs(hostile, start):
    """There it is that python -c, a REPL and a notebook look first."""
    folder, marker = hostile(*RESTS_ON, *CUSTOM)
    (folder / "run.py").write_text(JUDGE, "utf-8")
    done = run(STARTS[start], folder, JUDGE)
    assert not marker.exists(), marker.read_text("utf-8")
    assert "{'holds': 1}" in done.stdout, done.stderr
    assert "Error" not in done.stderr


def test_nothing_beside_a_script_runs(hostile):
    folder, marker = hostile(*RESTS_ON, *CUSTOM)
    (folder / "run.py").write_text(JUDGE, "utf-8")
    done = run([str(folder / "run.py")], folder.parent)
    assert not marker.exists(), marker.read_text("utf-8")
    assert "{'holds': 1}" in done.stdout, done.stderr


@pytest.mark.parametrize(("asked", "said"), [(JUDGE, "{'holds': 1}"), (PROVE, "True")])
def test_nothing_runs_in_a_folder_entered_later(hostile, asked, said):
    folder, marker = hostile(*RESTS_ON, *CUSTOM, *STANDARD)
    enter = (
        f"{asked}\nfrom canon.proof.worker.budget import _worker\nimport os\n_worker(os.getpid()).stop()\n"
    )
    done = run(["-c", f"{enter}os.chdir({str(folder)!r})\n{asked}"], folder.parent)
    assert not marker.exists(), marker.read_text("utf-8")
    assert done.stdout.split("\n")[:2] == [said, said], done.stderr


def test_the_proofs_of_a_session_run_nothing_at_their_start(hostile):
    folder, marker = hostile(*CUSTOM)
    assert run(["-c", PROVE], folder).stdout.strip() == "True"
    assert not marker.exists()


def test_the_traps_do_spring(hostile):
    """The wrong twin: where Python itself is told to look there, it does."""
    folder, marker = hostile("sitecustomize")
    run(["-c", ""], folder, PYTHONPATH=str(folder))
    assert marker.read_text("utf-8") == "sitecustomize"


def test_it_works_among_the_installed_packages():
    assert "holds" in run(["-c", JUDGE], sysconfig.get_path("purelib")).stdout


def test_it_works_with_a_safe_path(hostile):
    folder, marker = hostile(*RESTS_ON, *CUSTOM, *STANDARD)
    assert "holds" in run(["-c", JUDGE], folder, PYTHONSAFEPATH="1").stdout
    assert not marker.exists()


STUDY = """
[system.free]
H = "p**2/2"
q = "q"
p = "p"
starts = { near = [0.5, 1.0] }
[[study]]
system = "free"
method = ["verlet", "rk4"]
step = 0.5
span = 300
"""


def test_the_pool_of_a_study_runs_nothing_in_the_working_folder(hostile):
    """As the installed command starts it: the folder of a script is on its path, and no option keeps others off."""
    folder, marker = hostile("multiprocessing", "pickle", "struct", *CUSTOM)
    (folder / "s.toml").write_text(STUDY, "utf-8")
    command = folder.parent / "command.py"
    command.write_text(
        "import sys\nfrom canon.cli import main\nif __name__ == '__main__':\n    sys.exit(main())\n"
    )
    done = run([str(command), "study", "run", "s.toml", "--jobs", "2"], folder)
    assert not marker.exists(), marker.read_text("utf-8")
    assert "2 finished" in done.stdout, done.stderr


def copied(folder):
    shutil.copytree(ROOT / "canon", folder / "canon", ignore=shutil.ignore_patterns("__pycache__"))
    return folder


def test_it_works_where_canon_lies_in_the_working_folder_and_runs_nothing_beside_it(hostile):
    folder, marker = hostile(*RESTS_ON, *CUSTOM)
    done = run(["-c", JUDGE + "print(canon.__file__)"], copied(folder), PYTHONPATH="")
    assert str(folder) in done.stdout, done.stderr
    assert "holds" in done.stdout
    assert not marker.exists()


def test_it_works_from_a_folder_whose_name_would_divide_a_path(tmp_path):
    folder = tmp_path / f"a{os.pathsep}b"
    folder.mkdir()
    code = f"import sys; sys.path.insert(0, {str(copied(folder))!r}){JUDGE}print(canon.__file__)"
    done = run(["-P", "-c", code], tmp_path, PYTHONPATH="")
    assert str(folder) in done.stdout, done.stderr
    assert "holds" in done.stdout


def test_it_works_from_an_archive(tmp_path):
    archive = tmp_path / "canon.zip"
    with zipfile.ZipFile(archive, "w") as packed:
        for path in sorted((ROOT / "canon").rglob("*.py*")):
            packed.write(path, path.relative_to(ROOT))
    done = run(["-P", "-c", f"{JUDGE}{PROVE}print(canon.__file__)"], tmp_path, PYTHONPATH=str(archive))
    assert done.stdout.split("\n")[1:3] == ["True", f"{archive / 'canon' / '__init__.py'}"], done.stderr
    assert "holds" in done.stdout


def test_what_canon_rests_on_comes_from_where_it_is_in_use(tmp_path, monkeypatch):
    """A SymPy that stands first on the path is that of the child too; one that lies in the working folder is not."""
    import sympy

    here = Path(sympy.__file__).parent
    (tmp_path / "sympy").symlink_to(here, target_is_directory=True)
    code = "from canon.trusted_folders import trusted_folders; print(*trusted_folders(), sep='\\n')"
    told = run(["-c", f"import sympy; {code}"], ROOT, PYTHONPATH=os.pathsep.join([str(tmp_path), str(ROOT)]))
    assert told.stdout.split("\n")[0] == str(tmp_path)
    told = run(["-c", code], tmp_path)
    assert told.stdout.split("\n")[0] == str(here.parent)
    assert str(here.parent) in trusted_folders()


@pytest.mark.skipif(sys.platform == "win32", reason="no groups of processes")
def test_a_killed_child_is_gone_and_says_so():
    child = Child("canon.proof.worker.proof_process", leads=True)
    assert child.receive(math.inf) == b""
    assert child.usable
    with pytest.raises(Late):
        child.receive(time.monotonic() + 0.2)
    child.kill()
    assert not child.usable
    with pytest.raises(Ended):
        child.receive(math.inf)
    with pytest.raises(ProcessLookupError):
        os.killpg(child.pid, 0)


def test_a_killed_child_is_waited_for_a_moment(monkeypatch):
    child, waited = Child("canon.no_such_module"), []
    monkeypatch.setattr(child._listener, "join", waited.append)
    child.kill()
    (seconds,) = waited
    assert 0.0 < seconds < 1.0


def test_a_child_that_cannot_start_says_so():
    child = Child("canon.no_such_module")
    with pytest.raises(Ended):
        child.receive(math.inf)
    child.kill()
    assert not child.usable


def test_what_cannot_be_sent_is_told():
    child = Child("canon.proof.worker.proof_process")
    assert child.receive(math.inf) == b""

    def too_deep():
        raise RecursionError

    child.send(too_deep, 1.0)
    with pytest.raises(Ended, match="RecursionError"):
        child.receive(math.inf)
    child.kill()


ORPHAN = """
import os, sys, time
sys.path.insert(0, {root!r})
from canon.exercise.judging_process import Worker
from canon.exercise.sheet.sheet import Claim
worker = Worker()
child = worker._running()
print(child.pid, flush=True)
keys = {{"lhs": "(x + t + cos(x) + 1)**60*sin(x)**40", "rhs": "(x + t + cos(x) + 1)**60*(1 - cos(x)**2)**20 + x*0",
         "parameters": {{"x": "real", "t": "real"}}}}
worker.judge(Claim("long", "equality-only", keys, budget=1.0))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no timers of the system")
def test_a_child_whose_parent_was_killed_ends_by_itself():
    with subprocess.Popen(
        [sys.executable, "-c", ORPHAN.format(root=str(ROOT))], stdout=subprocess.PIPE, text=True
    ) as parent:
        group = int(parent.stdout.readline())
        os.kill(parent.pid, signal.SIGKILL)
    with suppress(ProcessLookupError):
        while True:  # an orphan that goes on would hang here
            os.killpg(group, 0)
            time.sleep(0.1)


def test_a_process_that_ends_just_when_it_is_asked(monkeypatch):
    """Its listener does not trip over the thread that was to ask, and who waits is told."""
    child = Child("canon.exercise.judging_process")
    child.receive(math.inf)
    raised, start = [], threading.Thread.start

    def late(thread):
        child._process.kill()
        child._process.wait()
        time.sleep(0.3)
        start(thread)

    monkeypatch.setattr(threading, "excepthook", raised.append)
    monkeypatch.setattr(threading.Thread, "start", late)
    child.send(lambda: b"", 1.0)
    with pytest.raises(Ended):
        child.receive(math.inf)
    child._listener.join()
    assert raised == []
    child.kill()


class Limits:
    """The module ``resource`` of a system that may refuse every limit, as macOS does."""

    RLIMIT_AS, RLIM_INFINITY = "address space", -1

    def __init__(self):
        self.asked = []

    def getrlimit(self, which):
        return -1, 2**40

    def setrlimit(self, which, limits):
        self.asked.append((which, limits))
        raise ValueError("current limit exceeds maximum limit")


def test_a_child_on_macos_starts_without_a_limit_that_the_system_refuses(monkeypatch):
    """The error is that of python/cpython#78783; with it no claim would be judged there."""
    limits = Limits()
    monkeypatch.setitem(sys.modules, "resource", limits)
    monkeypatch.setattr(sys, "platform", "darwin")
    _limit_memory(2**31)
    assert limits.asked == []


def test_a_limit_that_is_refused_elsewhere_is_not_passed_over(monkeypatch):
    limits = Limits()
    monkeypatch.setitem(sys.modules, "resource", limits)
    monkeypatch.setattr(sys, "platform", "linux")
    with pytest.raises(ValueError, match="current limit"):
        _limit_memory(2**31)
    assert limits.asked == [("address space", (2**31, 2**40))]


def test_a_message_that_was_cut_off_is_none():
    whole = io.BytesIO()
    _write(whole, b"nine bytes")
    sent = whole.getvalue()
    assert _read(io.BytesIO(sent)) == b"nine bytes"
    for length in range(len(sent)):
        with pytest.raises(EOFError):
            _read(io.BytesIO(sent[:length]))


@pytest.mark.parametrize("given", [None, "3"])
def test_small_matrices_take_one_thread_unless_someone_says_otherwise(given, monkeypatch, capsys):
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    if given:
        monkeypatch.setenv("OPENBLAS_NUM_THREADS", given)
    main(["scene"])
    assert os.environ.pop("OPENBLAS_NUM_THREADS") == (given or "1")
    assert "kepler" in capsys.readouterr().out


def test_a_process_of_no_pool_goes_on_and_leaves_interrupts_to_others():
    before = signal.getsignal(signal.SIGINT)
    try:
        end_with_parent()
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


def test_what_is_no_package_with_a_folder_is_not_looked_for_in_one(monkeypatch):
    folders = trusted_folders()
    monkeypatch.setattr("canon.trusted_folders.RESTS_ON", (*RESTS_ON, "sys", "no_such_package_anywhere"))
    assert trusted_folders() == folders


@pytest.mark.parametrize("before", ["0", "1", None])
def test_the_path_of_other_interpreters_is_put_back(before, monkeypatch):
    if before is None:
        monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
    else:
        monkeypatch.setenv("PYTHONSAFEPATH", before)
    with safe_path():
        assert os.environ["PYTHONSAFEPATH"] == "1"
    assert os.environ.get("PYTHONSAFEPATH") == before
