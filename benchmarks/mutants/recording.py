"""Plug-in of pytest for the record of what tests execute: it writes how long each took, and ends those that take long.

What a test had executed until then is on the record too, with the mark that it takes long.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Generator
    from types import FrameType

_SECONDS = 20.0
_PROCESSOR_SECONDS = 3.0
_AGAIN = 0.1
_CALLED_BACK = "cycle_quadrature.py"
"""The module whose functions FLINT's integration calls."""
_CUT = "cut short by the record"
_ALIKE = 2
"""Of a test with many parameters so many are run, the first and one in the middle: others execute the same lines."""
INTO = "MUTANTS_RECORD"
"""The variable of the environment with the file that is written."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Leave out most parameters of a test that has many."""
    alike = defaultdict[str, list[pytest.Item]](list)
    for item in items:
        alike[item.nodeid.partition("[")[0]].append(item)
    items[:] = [item for each in alike.values() for item in each[:: -(-len(each) // _ALIKE)]]


@pytest.hookimpl(wrapper=True, trylast=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, Any, Any]:  # noqa: ARG001, pytest goes by the names
    """Run a test for so long at most."""
    with _limited():
        return (yield)


@pytest.hookimpl(wrapper=True, trylast=True)
def pytest_runtest_setup(item: pytest.Item) -> Generator[None, Any, Any]:  # noqa: ARG001
    """Prepare a test for so long at most."""
    with _limited():
        return (yield)


@contextlib.contextmanager
def _limited() -> Generator[None]:
    def give_up(_: int, frame: FrameType | None) -> None:
        if not _called_by_a_library(frame):
            pytest.skip(_CUT)  # hypothesis lets this through, and seeks no smaller example

    before = signal.signal(signal.SIGALRM, give_up)
    signal.signal(signal.SIGPROF, give_up)
    signal.setitimer(signal.ITIMER_REAL, _SECONDS, _AGAIN)
    signal.setitimer(signal.ITIMER_PROF, _PROCESSOR_SECONDS, _AGAIN)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGALRM, before)


def _called_by_a_library(frame: FrameType | None) -> bool:
    """Tell whether a library would lose what is raised here: it goes on then, as if a function had no value."""
    while frame is not None and not frame.f_code.co_filename.endswith(_CALLED_BACK):
        frame = frame.f_back
    return frame is not None


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Write a line about each part of a test: its name, the part, what came of it, its seconds, whether it was cut."""
    line = [report.nodeid, report.when, report.outcome, report.duration, _CUT in str(report.longrepr or "")]
    with Path(os.environ[INTO]).open("a", encoding="utf-8") as out:
        out.write(json.dumps(line) + "\n")
