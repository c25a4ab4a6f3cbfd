"""The page about studies: its files can be read, its program runs, its commands parse."""

from __future__ import annotations

import re
import runpy
import shlex
from pathlib import Path

import pytest

from canon import cli
from canon.study.cases.study import read_study

PAGE = (Path(__file__).parents[2] / "docs" / "howto" / "studies.md").read_text(encoding="utf-8")


def blocks(language):
    found = re.findall(rf"^( *)```{language}\n(.*?)^ *```", PAGE, re.MULTILINE | re.DOTALL)
    return [re.sub(rf"^{indent}", "", text, flags=re.MULTILINE) for indent, text in found]


def test_the_study_can_be_read(tmp_path):
    (text,) = blocks("toml")
    file = tmp_path / "drifts.toml"
    file.write_text(text)
    assert len(read_study(file).cases) == 2 * (4 * 3 + 1) + 2 * 2 * (2 + 1)


def test_the_program_runs_and_the_others_are_python(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    first, *others = blocks("python")
    assert len(others) == 7
    program = tmp_path / "program.py"
    program.write_text(first)
    runpy.run_path(str(program))
    assert capsys.readouterr().out == "16 cases: 16 finished, 0 failed, 0 pending\n"
    assert (tmp_path / "quartic.png").exists()
    for text in others:
        compile(text, "studies.md", "exec")


def test_the_study_of_another_system_is_made(tmp_path):
    (text,) = (text for text in blocks("python") if "system_text" in text)
    (tmp_path / "other.py").write_text(text)
    assert len(runpy.run_path(str(tmp_path / "other.py"))["study"].cases) == 4


@pytest.mark.parametrize(
    "command",
    [
        line.strip()
        for text in blocks("sh")
        for line in text.splitlines()
        if line.strip().startswith("canon ")
    ],
)
def test_its_commands_are_canons(command):
    for variable, value in (("$SLURM_ARRAY_TASK_ID", "3"), ("$SLURM_CPUS_PER_TASK", "8")):
        command = command.replace(variable, value)
    _, *words = shlex.split(command)
    arguments = cli._parser(words).parse_args(words)
    assert arguments.action in ("run", "resume", "status", "mend", "report", "export")


def test_the_programs_about_what_is_kept_and_asked_run(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    kept, asked = (text for text in blocks("python") if "kept.sqlite" in text or "asked.sqlite" in text)
    for name, text in (("kept", kept), ("asked", asked)):
        Path(f"{name}.py").write_text(text)
        runpy.run_path(f"{name}.py")
    verlet, taylor, fine = capsys.readouterr().out.splitlines()
    assert verlet.startswith("verlet, h = 0.1 31 0.0")
    assert taylor.startswith("Taylor 31 0.0")
    assert fine.endswith(" 8")
