"""Progress: a bar with an estimate on a terminal, nothing where standard error is piped."""

import importlib.util
import io
import sys
import time

import pytest

from canon import progress
from canon.flow.method.method import Splitting
from canon.flow.propagate import propagate
from canon.progress import reporting
from tests.flow.systems import PENDULUM


class Terminal(io.StringIO):
    def isatty(self):
        return True


def looked_at(monkeypatch):
    """Make standard error a terminal, from inside the test: pytest sets it anew between setup and test."""
    found = Terminal()
    monkeypatch.setattr(sys, "stderr", found)
    monkeypatch.setattr(progress, "_PATIENCE", 0.0)
    return found


def test_nothing_is_shown_where_nobody_looks(monkeypatch):
    piped = io.StringIO()
    monkeypatch.setattr(sys, "stderr", piped)
    monkeypatch.setattr(progress, "_PATIENCE", 0.0)
    propagate(PENDULUM, [1.0, 0.0], (0, 2000), method=Splitting("verlet"), step=0.01, progress=True)
    assert piped.getvalue() == ""


@pytest.mark.parametrize("wanted", [None, False])
def test_nothing_is_shown_where_it_is_not_wanted(monkeypatch, wanted):
    terminal = looked_at(monkeypatch)
    propagate(PENDULUM, [1.0, 0.0], (0, 20), method=Splitting("verlet"), step=0.01, progress=wanted)
    assert terminal.getvalue() == ""


def test_tqdm_shows_a_bar_that_reaches_the_end(monkeypatch):
    pytest.importorskip("tqdm")
    terminal = looked_at(monkeypatch)
    with reporting(progress=True) as report:
        report(0.5)
        time.sleep(0.15)  # tqdm draws ten times a second at most
        report(1.0)
    assert "100%" in terminal.getvalue()
    assert "<" in terminal.getvalue()


def test_plain_lines_tell_what_is_left(monkeypatch):
    terminal = looked_at(monkeypatch)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with reporting(progress=True) as report:
        report(0.25)
        report(0.5)
    shown = terminal.getvalue()
    assert " 50 % done, about 0 s left" in shown
    assert shown.endswith("\r")
