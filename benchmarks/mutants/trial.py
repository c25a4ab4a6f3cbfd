"""Trials of mutants: a fork of a process that has imported what canon rests on, but not canon, runs the tests.

The changed module lies in a copy of the checkout, so that the child processes of canon have the mutant too. What
machine code is kept between processes is named by the code that it was made of, so none of it hides a mutant; those of
the module that keeps it get an empty folder.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import json
import math
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from days import today

from mutants.sampling import Mutant, mutated_source

if TYPE_CHECKING:
    from collections.abc import Generator

__all__ = ["ONCE_MORE", "Trial", "copy_of_checkout", "failing", "trial", "warm_up"]

_RESTS_ON = (
    "hypothesis",
    "_hypothesis_pytestplugin",
    "sympy",
    "flint",
    "numpy",
    "scipy.integrate",
    "scipy.optimize",
    "scipy.stats",
    "llvmlite.binding",
    "heyoka",
    "lark",
    "mpmath",
    "matplotlib",
    "matplotlib.backends.backend_agg",
)
PROCESSOR_SECONDS, ONCE_MORE = 40.0, 60.0
"""No mutant has more, at first and once more; without a failure until then it has survived."""
_START = 15.0
"""Processor time of a test beside ten times what it took on the record: for imports and for code not yet compiled."""
_IDLE = 60.0
_LOOKS = 1.0
"""Seconds between looks at the processes, which cost a few milliseconds."""
_BUDGET = "its time was over"
_MEMORY = 10 * 2**30
_TICKS = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True)
class Trial:
    """What became of a mutant: killed by which test and how, or survived after how many."""

    outcome: str
    by: str
    how: str
    tests: int
    seconds: float
    day: str = field(default_factory=today)


def copy_of_checkout(home: Path, copy: Path) -> None:
    """Copy what git knows of a checkout, as it stands, to where mutants can be written into it."""
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=home, check=True, capture_output=True, text=True
    ).stdout.split("\0")
    for name in filter(None, listed):
        if (home / name).is_file():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(home / name, copy / name)


def warm_up() -> None:
    """Import what every test needs beside canon, once for all mutants."""
    os.environ["MPLBACKEND"] = "Agg"
    for name in _RESTS_ON:
        importlib.import_module(name)
    gc.freeze()  # no search for garbage goes through what is shared with the forks
    if any(name.partition(".")[0] == "canon" for name in sys.modules):
        raise RuntimeError("canon was imported before its mutants")


def trial(
    mutant: Mutant,
    tests: dict[str, float],
    home: Path,
    caches: Path,
    log: Path,
    processor_seconds: float = PROCESSOR_SECONDS,
) -> Trial:
    """Run tests on a mutant until one fails.

    Parameters
    ----------
    mutant
        The change.
    tests
        The tests in their order, each with the seconds that it took on the record.
    home
        The copy of the checkout.
    caches
        Where machine code is kept.
    log
        Where pytest's words go.
    processor_seconds
        How much all of them together may use.
    """
    with _changed(mutant, home), tempfile.TemporaryDirectory() as empty:
        kept = Path(empty) if mutant.file.endswith("kept_code.py") else caches
        events, status, late, used = _run(tests, home, kept, log, ["-x"], processor_seconds)
    return _judged(events, status, late, used)


def failing(tests: dict[str, float], home: Path, caches: Path, log: Path) -> set[str]:
    """Return those of some tests that fail on canon as it is, and those that were not reached."""
    if not tests:
        return set()
    events, *_ = _run(tests, home, caches, log, [], math.inf)
    begun = {test for what, test, _ in events if what == "start"}
    if not begun:  # a case that only a mutant has, of which pytest knows nothing, and then runs nothing
        whole = {test.partition("[")[0]: seconds for test, seconds in tests.items()}
        return failing(whole, home, caches, log) if whole.keys() != tests.keys() else set(tests)
    return {test for what, test, _ in events if what == "failed"} | {t for t in tests if "::" in t} - begun


@contextlib.contextmanager
def _changed(mutant: Mutant, home: Path) -> Generator[None]:
    """Keep a mutant in its file; the compiled module is deleted before and after, its time stamp may be the same."""
    path = home / mutant.file
    before = path.read_bytes()
    whole = mutated_source(home, mutant)
    if whole is None:
        raise ValueError(f"{mutant.file} has changed since its mutants were drawn")
    try:
        _put(path, whole.encode())
        yield
    finally:
        _put(path, before)


def _put(path: Path, source: bytes) -> None:
    path.write_bytes(source)
    for compiled in path.parent.glob(f"__pycache__/{path.stem}.*.pyc"):
        compiled.unlink()


def _run(
    tests: dict[str, float],
    home: Path,
    caches: Path,
    log: Path,
    options: list[str],
    processor_seconds: float,
) -> tuple[list[list[str]], int, str, float]:
    """Return what a fork told of the tests, how it ended, what was late, and the processor time."""
    with tempfile.TemporaryDirectory() as folder:
        told = Path(folder, "told")
        told.touch()
        child = os.fork()
        if child == 0:
            _be_the_child(tests, home, caches, told, log, options)
        status, late, used = _watched(child, tests, told, processor_seconds)
        return [json.loads(line) for line in told.read_text("utf-8").splitlines()], status, late, used


def _be_the_child(
    tests: dict[str, float], home: Path, caches: Path, told: Path, log: Path, options: list[str]
) -> None:
    """Run pytest in this process, which never returns."""
    status = 70
    try:
        os.setsid()
        with log.open("w") as out, Path(os.devnull).open() as nothing:
            os.dup2(nothing.fileno(), 0)
            os.dup2(out.fileno(), 1)
            os.dup2(out.fileno(), 2)
        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
        os.chdir(home)
        here = str(Path(__file__).parents[1])
        sys.path[:] = [str(home), *(p for p in sys.path if p not in (here, str(Path(here).parent)))]
        os.environ |= {"PYTHONPATH": str(home), "XDG_CACHE_HOME": str(caches), "CI": "true"}
        files = dict.fromkeys(test.partition("::")[0] for test in tests)
        os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
        quiet = ["-q", "-p", "no:cacheprovider", "-p", "_hypothesis_pytestplugin"]
        quiet += ["-W", "ignore::pytest.PytestAssertRewriteWarning"]
        status = int(pytest.main([*quiet, *options, *files], plugins=[_Teller(tests, told)]))
    finally:
        os._exit(status)


class _Teller:
    """Plug-in of pytest: keeps the wanted tests in the wanted order, and tells what begins and what fails."""

    def __init__(self, tests: dict[str, float], told: Path) -> None:
        self.order = {test: k for k, test in enumerate(tests)}
        self.told = told

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        places = {item: self.place(item.nodeid) for item in items}
        items[:] = sorted((item for item in items if places[item] >= 0), key=places.__getitem__)

    def place(self, test: str) -> int:
        """Return where a test stands in the order, by its own name, its function's or its file's; -1 for nowhere."""
        names = test, test.partition("[")[0], test.partition("::")[0]
        return min((self.order[name] for name in names if name in self.order), default=-1)

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        self.tell("start", nodeid, "")

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        if report.failed:
            said = str(report.longrepr).strip().splitlines()
            self.tell("failed", report.nodeid, said[-1][:160] if said else "")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            crash = getattr(report.longrepr, "reprcrash", None)
            said = str(getattr(crash, "message", report.longrepr)).strip().splitlines()
            self.tell("failed", report.nodeid, said[0][:160] if said else "")

    def tell(self, *what: str) -> None:
        with self.told.open("a", encoding="utf-8") as out:
            out.write(json.dumps(what) + "\n")


def _watched(
    child: int, tests: dict[str, float], told: Path, processor_seconds: float
) -> tuple[int, str, float]:
    """Wait for the child, and end it where a test or all of them take too long."""
    used, seen, late, status = 0.0, 0, "", 0
    began_at, began_with = time.monotonic(), 0.0
    ended, looked = 0, began_at
    while not ended and not late:
        time.sleep(0.05)
        ended, status, usage = os.wait4(child, os.WNOHANG)
        used = max(used, usage.ru_utime + usage.ru_stime)
        if ended or time.monotonic() - looked < _LOOKS:
            continue
        used, looked = max(used, _processor_seconds(child)), time.monotonic()
        events = told.read_text(encoding="utf-8").splitlines()
        if len(events) > seen:
            seen, began_at, began_with = len(events), looked, used
        test = json.loads(events[-1])[1] if events else ""
        allowed = _START + 10 * tests.get(test, 1.5)
        if used > processor_seconds:
            late = _BUDGET
        elif used - began_with > allowed or looked - began_at > _IDLE + 2 * allowed:
            late = test or "import"
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    if not ended:
        _, status = os.waitpid(child, 0)
        return status, late, used
    return status, "", used


def _judged(events: list[list[str]], status: int, late: str, used: float) -> Trial:
    begun = [test for what, test, _ in events if what == "start"]
    failed = [(test, how) for what, test, how in events if what == "failed"]
    code = os.waitstatus_to_exitcode(status)
    last = begun[-1] if begun else ""
    if failed:
        outcome, by, how = "killed", *failed[0]
    elif late and late != _BUDGET:
        outcome, by, how = "killed", late, "did not end"
    elif late or code == 0:
        outcome, by, how = "survived", "", late
    elif code == pytest.ExitCode.NO_TESTS_COLLECTED:
        outcome, by, how = "survived", "", "no test"
    else:
        outcome, by, how = "killed", last or "import", f"ended with status {code}"
    return Trial(outcome, by, how, len(begun), round(used, 2))


def _processor_seconds(session: int) -> float:
    """Return the processor time of all processes of a session, and of the children that they waited for."""
    ticks = 0
    for path in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            fields = path.read_text().rpartition(")")[2].split()
            if int(fields[3]) == session:
                ticks += sum(map(int, fields[11:15]))
    return ticks / _TICKS
