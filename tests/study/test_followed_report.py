"""A report that follows a study: written anew while cases are pending, at rest when none is."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time

import pytest

from canon import Study, results_of, run_study
from canon.cli import main
from canon.command import followed_report
from canon.plot.study_page import study_report
from canon.study.cases.run_study import resume
from canon.study.cases.store import Store

STUDY = Study.of(
    system="henon-heiles", method=["verlet", "rk4"], step=[0.1, 0.2], span=60.0, samples=256, tags="all"
)
REFRESH = re.compile(r'<meta http-equiv="refresh" content="(\d+)">')


def words(page):
    """Return a page without its images, in which matplotlib draws names by lot."""
    return re.sub(r'src="data:[^"]*"', "", page)


@pytest.fixture
def begun(tmp_path):
    """Return a file with two finished cases and two pending ones."""
    path = tmp_path / "study.sqlite"
    run_study(STUDY, path)
    Store(path).forget(list(Store(path).cases())[2:])
    return path


def test_the_page_grows_with_the_study_and_comes_to_rest(begun, tmp_path, monkeypatch, capsys):
    page, seen = tmp_path / "page.html", []

    def meanwhile(seconds):
        """Note what a browser finds, then finish a case, or nothing, as time passes."""
        text = page.read_text()
        seen.append((REFRESH.findall(text), text.count('<tr class="finished">'), page.stat().st_mtime_ns))
        assert seconds == 3.0
        if len(seen) == 2:
            store = Store(begun)
            run_study(Study(STUDY.cases[2:3]), store)
        if len(seen) == 3:
            resume(begun)

    monkeypatch.setattr(followed_report.time, "sleep", meanwhile)
    assert main(["study", "report", str(begun), str(page), "--follow", "3"]) == 0
    assert [(refresh, finished) for refresh, finished, _ in seen] == [(["3"], 2), (["3"], 2), (["3"], 3)]
    assert seen[0][2] == seen[1][2]  # nothing had changed
    assert words(page.read_text()) == words(study_report(results_of(begun), "study"))
    assert REFRESH.findall(page.read_text()) == []
    assert capsys.readouterr().out.splitlines() == [
        f"{page}: 4 cases: 2 finished, 0 failed, 2 pending",
        f"{page}: 4 cases: 3 finished, 0 failed, 1 pending",
        f"report: {page}",
    ]
    assert sorted(file.name for file in tmp_path.iterdir()) == ["page.html", "study.sqlite"]


def test_an_interrupted_page_is_at_rest(begun, tmp_path, monkeypatch):
    page = tmp_path / "page.html"

    def interrupted(seconds):
        raise KeyboardInterrupt

    monkeypatch.setattr(followed_report.time, "sleep", interrupted)
    with pytest.raises(KeyboardInterrupt):
        followed_report.follow(Store(begun), lambda: results_of(begun), page, 2.0, lambda line: None)
    assert REFRESH.findall(page.read_text()) == []
    assert page.read_text().count('<tr class="pending">') == 2


def test_a_running_page_says_of_when_it_is(begun):
    page = study_report(results_of(begun), "study", seconds=0.2)
    assert REFRESH.findall(page) == ["1"]
    assert re.search(r"The study is running. This page is of \d{4}-\d\d-\d\d \d\d:\d\d:\d\d UTC", page)


@pytest.mark.parametrize("seconds", ["0", "-1", "nan", "soon", "1e9"])
def test_a_time_that_makes_no_sense_is_refused(begun, tmp_path, seconds):
    with pytest.raises(SystemExit):
        main(["study", "report", str(begun), str(tmp_path / "page.html"), f"--follow={seconds}"])


@pytest.mark.slow
def test_it_follows_another_process(tmp_path):
    """The study runs in one process, the report follows in another and ends with it."""
    path, page, toml = tmp_path / "s.sqlite", tmp_path / "page.html", tmp_path / "s.toml"
    toml.write_text(
        '[[study]]\nsystem = ["henon-heiles", "kepler"]\nmethod = ["kahan-li-8", "taylor"]\nstep = 0.01\n'
        "span = 2000.0\nparts = 8\n"
    )
    command = [sys.executable, "-m", "canon", "study"]
    run = subprocess.Popen([*command, "run", str(toml), "--checkpoint", "0"], stdout=subprocess.PIPE)
    while not (path.exists() and Store(path).cases()):
        assert run.poll() is None
    run.send_signal(signal.SIGSTOP)  # until the report has begun, however fast the study is
    report = subprocess.Popen(
        [*command, "report", str(path), str(page), "--follow", "0.05"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    while not page.exists():
        assert report.poll() is None
        time.sleep(0.05)
    run.send_signal(signal.SIGCONT)
    out, err = report.communicate()
    assert (run.wait(), report.returncode, err) == (0, 0, "")
    run.stdout.close()
    lines = out.splitlines()
    assert len(lines) >= 3
    assert lines[-1] == f"report: {page}"
    assert words(page.read_text()) == words(study_report(results_of(path), "s"))
