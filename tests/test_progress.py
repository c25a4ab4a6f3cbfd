"""Progress: a bar with the time that is left on a terminal, nothing where standard error is piped."""

import io
import sys

import pytest

from canon import progress
from canon.cli import main
from canon.flow.method.method import Splitting
from canon.flow.propagation import propagate
from canon.progress import ProgressBar, reporting
from tests.flow.systems import PENDULUM


class Terminal(io.StringIO):
    def isatty(self):
        return True


def standard_error(monkeypatch, stream, patience=0.0):
    """Replace it from inside the test, as pytest sets it anew between setup and test; show every change at once."""
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setattr(progress, "_PATIENCE", patience)
    monkeypatch.setattr(progress, "_EVERY", 0.0)
    return stream


def run(progress):
    propagate(PENDULUM, (0, 2000), [1.0, 0.0], method=Splitting("verlet"), step=0.01, progress=progress)


def test_nothing_is_shown_where_nobody_looks(monkeypatch):
    piped = standard_error(monkeypatch, io.StringIO())
    run(progress=True)
    with ProgressBar() as bar:
        bar("verlet", 0.0)
        bar("verlet", 0.5)
    assert piped.getvalue() == ""


@pytest.mark.parametrize("wanted", [None, False])
def test_nothing_is_shown_where_it_is_not_wanted(monkeypatch, wanted):
    terminal = standard_error(monkeypatch, Terminal())
    run(progress=wanted)
    assert terminal.getvalue() == ""


def test_a_run_shows_a_bar_that_reaches_the_end_and_goes(monkeypatch):
    terminal = standard_error(monkeypatch, Terminal())
    run(progress=True)
    shown = terminal.getvalue()
    assert "100%|####################|" in shown
    assert shown.endswith("\r")
    assert shown.split("\r")[-2].strip() == ""


def test_short_work_shows_nothing(monkeypatch):
    terminal = standard_error(monkeypatch, Terminal(), patience=60.0)
    with reporting(progress=True) as report:
        report(0.5)
        report(1.0)
    with ProgressBar() as bar:
        bar("verlet", 0.5)
        bar("rk4", 1.0)
    assert terminal.getvalue() == ""


def test_the_line_tells_what_is_done_how_much_of_it_and_the_time_that_is_left(monkeypatch):
    now = [0.0]
    monkeypatch.setattr("tqdm.std.time", lambda: now[0])
    terminal = standard_error(monkeypatch, Terminal())
    with ProgressBar() as bar:
        bar("verlet", 0.0)
        now[0] = 30.0
        bar("verlet", 0.25)
        assert terminal.getvalue().split("\r")[-1] == "verlet:  25%|#####               | 01:30 left"
        bar("cases", 2.0, of=10, note="2.00 of 10 cases")
        now[0] = 50.0
        bar("cases", 4.5, of=10, note="4.50 of 10 cases, 1 failed")
        line = "cases:  45%|#########           | 00:44 left, 4.50 of 10 cases, 1 failed"
        assert terminal.getvalue().split("\r")[-1].strip() == line


@pytest.mark.parametrize(
    ("command", "told"),
    [
        (["drift", "kepler", "--method", "verlet", "--method", "rk4", "--periods", "50"], ["verlet", "RK4"]),
        (["choose", "henon-heiles", "--accuracy", "1e-3", "--periods", "50", "--method", "verlet"], ["pilot runs"]),
        (["study", "run", "{study}"], ["2.00 of 2 cases"]),
    ],
    ids=lambda words: words[0],
)  # fmt: skip
def test_commands_show_what_they_do(command, told, monkeypatch, tmp_path):
    study = tmp_path / "study.toml"
    study.write_text('[[study]]\nsystem = "kepler"\nmethod = ["verlet", "rk4"]\nstep = 0.05\nperiods = 20\n')
    terminal = standard_error(monkeypatch, Terminal())
    main([word.format(study=study) for word in command])
    for words in told:
        assert words in terminal.getvalue()
