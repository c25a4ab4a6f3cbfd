"""Commands at their edges: lists, figures that can't be written, runs that fail, answers that are not as expected."""

from __future__ import annotations

import argparse
import errno
import io
import json
import multiprocessing
import os
import sys

import pytest

from canon import Splitting
from canon.cli import main
from canon.command import choose, tour
from canon.command.standard_streams import why_not_written
from canon.exercise.sheet.sheet import MAX_BYTES, Claim, Sheet
from canon.scene import find, names
from canon.study.energy_drift.drift_study import drift_study
from canon.study.errors import StudyError


@pytest.mark.parametrize("command", ["choose", "drift"])
def test_scenes_are_listed_by_every_command_that_takes_one(command, capsys):
    assert main([command, "list"]) == 0
    listed = [line.split()[0] for line in capsys.readouterr().out.splitlines() if line.strip()]
    told = [word for word in listed if word in names()]
    assert {"kepler", "henon-heiles", "simple-pendulum"} < set(told)
    assert len(told) == len(set(told)) > 20


def test_the_choice_of_a_gauss_method_is_run_by_its_name(capsys):
    words = ["choose", "henon-heiles", "--method", "gauss-2", "--accuracy", "1e-4", "--span"]
    assert main([*words, "200"]) == 0
    command = capsys.readouterr().out.splitlines()[-1]
    assert "--method gauss-2 --step" in command
    assert main([*command.removeprefix("to run it: canon ").split(), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["method"].lower().startswith("gauss")


def test_a_run_too_short_to_be_judged_is_not_proposed(capsys):
    """The command that was printed ended with: 224 samples are too few to judge growth."""
    assert main(["choose", "henon-heiles", "--method", "gauss-2", "--accuracy", "1e-4", "--span", "100"]) == 0
    told = capsys.readouterr().out
    assert "Gauss(2), step" in told
    assert "to run it" not in told


def test_a_run_that_fails_is_a_line_with_its_reason(capsys):
    words = [
        "drift",
        "double-pendulum",
        "--method",
        "verlet",
        "--method",
        "rk4",
        "--span",
        "20",
        "--step",
        "0.05",
    ]
    assert main([*words, "--json"]) == 1
    failed, kept = map(json.loads, capsys.readouterr().out.splitlines())
    assert failed["verdict"] == "failed"
    assert "not separable" in failed["reason"]
    assert "bound" not in failed
    assert kept["bound"] > 0.0


def test_a_figure_that_can_not_be_written_is_told(tmp_path, capsys):
    drift = ["drift", "henon-heiles", "--method", "verlet", "--periods", "20", "--plot"]
    assert main([*drift, str(tmp_path / "none" / "drift.png")]) == 2
    told = capsys.readouterr()
    assert "canon: no figure was written: " in told.err
    assert "verlet" in told.out


def test_a_picture_is_written_without_a_film(tmp_path, capsys):
    picture = tmp_path / "kepler.png"
    assert main(["scene", "kepler", "--plot", str(picture), "--periods", "1"]) == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
    told = capsys.readouterr().out
    assert f"picture: {picture}" in told
    assert "animation" not in told


def test_a_sheet_from_standard_input_has_a_largest_size(monkeypatch, capsys):
    for size, told in (
        (MAX_BYTES + 1, f"standard input: more than {MAX_BYTES} bytes; split the sheet"),
        (4, None),
    ):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b" " * size)))
        assert main(["check", "-"]) == 2
        assert (told in capsys.readouterr().err) if told else capsys.readouterr().err


def test_an_error_of_a_file_is_none_of_standard_output():
    assert why_not_written(OSError(errno.ENOSPC, "full")) == os.strerror(errno.ENOSPC)
    assert why_not_written(OSError(errno.ENOSPC, "full", "study.sqlite")) == ""
    assert why_not_written(FileNotFoundError(errno.ENOENT, "none", "sheet.toml")) == ""
    assert why_not_written(PermissionError(errno.EACCES, "no")) == ""


def test_an_error_of_a_file_is_not_taken_for_one_of_standard_output(monkeypatch):
    def lost(_arguments):
        raise OSError(errno.ENOSPC, "full", "choice.sqlite")

    monkeypatch.setattr(choose, "run", lost)
    with pytest.raises(OSError, match=r"choice.sqlite"):
        main(["choose", "list"])


def test_workers_end_with_a_study_that_ends_in_an_error(tmp_path, monkeypatch, capsys):
    def lost(_study, _store, executor, *_others):
        assert executor.submit(pow, 2, 3).result() == 8
        raise StudyError("the disk is gone")

    file = tmp_path / "study.toml"
    file.write_text("[[study]]\nsystem = 'kepler'\nmethod = 'rk4'\nstep = 0.1\nspan = 10\n")
    monkeypatch.setattr("canon.study.cases.run_study.run_study", lost)
    assert main(["study", "run", str(file), "--jobs", "2"]) == 2
    assert "the disk is gone" in capsys.readouterr().err
    assert multiprocessing.active_children() == []


def test_a_service_that_is_broken_is_not_said_to_lack_its_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "canon.serve.http_server", None)
    with pytest.raises(ModuleNotFoundError, match=r"canon.serve.http_server"):
        main(["serve"])


def test_a_tour_says_which_answer_is_not_as_expected(monkeypatch, capsys, tmp_path):
    keys = {"lhs": "2*x", "rhs": "x + x", "parameters": {"x": "real"}}
    claims = tuple(Claim(word, "equality-only", keys, expect=word) for word in ("holds", "fails"))
    study = drift_study(find("henon-heiles"), methods=[Splitting("verlet")], periods=20.0)
    monkeypatch.setattr("canon.exercise.sheet.sheet.bundled_sheet", lambda _name: Sheet("two", claims, "two"))
    monkeypatch.setattr(tour, "_study", lambda: study)
    monkeypatch.chdir(tmp_path)
    assert tour.run(argparse.Namespace(no_plot=True, plot="tour.png")) == 1
    told = capsys.readouterr()
    assert told.err == "canon tour: fails: holds, expected fails\n"
    assert "verlet" in told.out
    assert list(tmp_path.iterdir()) == []
