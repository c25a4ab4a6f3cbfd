"""What README and CONTRIBUTING promise: the sheet, the commands, the documentation, the package."""

import os
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import canon
from canon.cli import COMMANDS, main
from canon.exercise.sheet_check import check

HERE = Path(__file__).parents[1]
README = (HERE / "README.md").read_text(encoding="utf-8")
BUILD = 'pip install -e ".[docs]" && sphinx-build -W -b html docs docs/_build'
MINUTES = 10


def block(language):
    return re.search(rf"^```{language}\n(.*?)^```", README, re.MULTILINE | re.DOTALL)[1]


def test_the_sheet_of_the_readme_is_judged_as_it_says(tmp_path):
    sheet = tmp_path / "answers.toml"
    sheet.write_text(block("toml"), encoding="utf-8")
    assert [claim["id"] for claim in tomllib.loads(block("toml"))["claim"]] == ["me", "my friend"]
    right, wrong = check(sheet).judgements
    assert (right.status, wrong.status) == ("holds", "fails")
    assert f"    {wrong.feedback}\n" in README


def test_every_command_of_the_readme_is_understood(capsys):
    """The options exist: with --help behind them, each command ends well."""
    shown = re.findall(r"^\$ canon (.*)$", README, re.MULTILINE)
    assert len(shown) == 6
    for line in shown:
        words = shlex.split(line, comments=True)
        assert words[0] in COMMANDS
        with pytest.raises(SystemExit) as ended:
            main([*words, "--help"])
        assert ended.value.code == 0
        printed = capsys.readouterr().out
        for option in (word for word in words if word.startswith("--")):
            assert option in printed


def test_every_name_of_the_table_is_public():
    table = README.partition("## What canon does")[2].partition("##")[0]
    named = {
        n for cell in re.findall(r"^\|.*\|(.*)\|$", table, re.MULTILINE) for n in re.findall(r"`(\w+)`", cell)
    }
    assert len(named) > 15
    assert named <= set(canon.__all__)


def test_no_link_leads_nowhere():
    for name in ("README.md", "CONTRIBUTING.md"):
        for target in re.findall(r"\]\((?!http)([^)#]+)", (HERE / name).read_text(encoding="utf-8")):
            assert (HERE / target).exists(), f"{name}: {target}"


def test_the_documentation_has_one_command():
    assert BUILD in README
    assert BUILD in (HERE / "CONTRIBUTING.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    """A fresh clone: what is committed, and nothing else."""
    folder = tmp_path_factory.mktemp("clone") / "canon"
    subprocess.run(["git", "clone", "--quiet", "--no-hardlinks", str(HERE), str(folder)], check=True)
    return folder


@pytest.mark.slow
def test_the_documentation_builds_without_warnings_from_a_fresh_clone(clone):
    """With the packages of this environment in place of the command's installation: pip install -e ".[dev,docs]"."""
    resource = pytest.importorskip(
        "resource", reason="the processor time of children, which POSIX systems tell"
    )
    words = shlex.split(BUILD.partition("&& ")[2])
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", *words[1:]],
        cwd=clone, env={**os.environ, "PYTHONPATH": str(clone)}, capture_output=True, text=True, check=False,
        timeout=3 * 60 * MINUTES,
    )  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert done.returncode == 0, done.stderr
    assert after.ru_utime - before.ru_utime < 60 * MINUTES, (
        "processor time, as others may use the machine too"
    )
    assert (clone / "docs" / "_build" / "tutorials" / "4_which_integrator.html").exists()


@pytest.mark.slow
def test_the_wheel_has_all_that_canon_needs(clone):
    """Built from a fresh clone and unpacked elsewhere, it judges the tour and shows its version."""
    built, unpacked = clone.parent / "built", clone.parent / "unpacked"
    pip = [sys.executable, "-m", "pip", "--quiet"]
    subprocess.run([*pip, "wheel", "--no-deps", "--wheel-dir", built, clone], check=True)
    (wheel,) = built.glob("canon_mechanics-*.whl")
    subprocess.run([*pip, "install", "--no-deps", "--target", unpacked, wheel], check=True)
    done = subprocess.run(
        [sys.executable, "-P", "-m", "canon", "tour", "--no-plot"],
        cwd=unpacked.parent, env={**os.environ, "PYTHONPATH": str(unpacked)}, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "✗ fails     oscillator-F1" in done.stdout
    assert not list(unpacked.glob("tests")), "the wheel holds canon alone"
