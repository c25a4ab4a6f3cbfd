"""``canon study`` from the shell: run, status, resume, export, report, merge, and what it says when it can't."""

from __future__ import annotations

import csv
import json
import signal
import subprocess
import sys

import pytest

from canon import Splitting
from canon.cli import main
from canon.study.cases.case import Case, key_of
from canon.study.cases.store import Record, Store

SMALL = """
[system.quartic]
H = "p**2/(2*m) + k*q**4/4"
q = "q"
p = "p"
parameters = { m = 1.0, k = 2.0 }
starts = { near = [0.5, 0.0], far = [2.0, 0.0] }

[[study]]
system = "quartic"
start = ["near", "far"]
method = ["verlet", "rk4"]
step = 0.05
span = 100
"""
FAILING = SMALL + '\n[[study]]\nsystem = "double-pendulum"\nmethod = "verlet"\nstep = 0.1\nspan= 50\n'


@pytest.fixture
def small(tmp_path):
    file = tmp_path / "small.toml"
    file.write_text(SMALL)
    return file


def said(capsys):
    out, err = capsys.readouterr()
    return out, err


def test_run_keeps_results_beside_the_study_and_exports_them(small, capsys):
    assert main(["study", "run", str(small)]) == 0
    out, err = said(capsys)
    kept = small.with_suffix(".sqlite")
    assert out == f"{kept}: 4 cases: 4 finished, 0 failed, 0 pending\n"
    assert err == ""
    assert main(["study", "run", str(small)]) == 0
    for ending in ("csv", "parquet", "nc"):
        output = small.with_suffix(f".{ending}")
        assert main(["study", "export", str(kept), str(output)]) == 0
        assert output.stat().st_size > 1000
    with small.with_suffix(".csv").open(newline="") as file:
        assert [line["system"] for line in csv.DictReader(file)] == ["quartic"] * 4
    assert main(["study", "report", str(kept), str(small.with_suffix(".html"))]) == 0
    assert "quartic; from near" in small.with_suffix(".html").read_text()
    image = small.with_suffix(".png")
    assert main(["study", "status", str(kept), "--plot", str(image)]) == 0
    assert image.read_bytes().startswith(b"\x89PNG")


def test_failures_and_what_is_pending_show_in_words_and_in_the_exit_status(tmp_path, capsys):
    file, kept = tmp_path / "failing.toml", tmp_path / "kept.sqlite"
    file.write_text(FAILING)
    assert main(["study", "run", str(file), "--store", str(kept)]) == 1
    out, _ = said(capsys)
    assert "5 cases: 4 finished, 1 failed, 0 pending" in out
    assert "failed: double-pendulum, verlet, h = 0.1: H is not separable, T(p, t) + V(q, t)" in out
    store = Store(kept)
    later = Case(
        "kepler",
        Case.from_dict(json.loads(next(iter(store.cases().values())))).method,
        1e3,
        step=0.01,
        parts=8,
    )
    store.add_cases({key_of(later): json.dumps(later.to_dict())})
    store.save_checkpoint(key_of(later), 2, "…")
    (failed,) = (key for key, record in store.records().items() if record.failure)
    store.forget([failed])
    assert main(["study", "status", str(kept)]) == 3
    out, _ = said(capsys)
    assert "4 finished, 0 failed, 2 pending (1 begun)" in out
    assert "begun: kepler, verlet, h = 0.01: 25 % done" in out


def test_failed_cases_are_run_again_when_asked(small, capsys):
    assert main(["study", "run", str(small)]) == 0
    store = Store(small.with_suffix(".sqlite"))
    key = next(iter(store.cases()))
    whole = store.records()[key]
    store.forget([key])
    store.save(Record(key, "", "the machine was out of memory"))
    assert main(["study", "run", str(small)]) == 1
    assert main(["study", "resume", str(store.path), "--retry"]) == 0
    assert store.records()[key].outcome == whole.outcome


def test_shares_of_several_jobs_merge_to_the_whole(small, tmp_path, capsys):
    for k in (1, 2, 3):
        share = tmp_path / f"part{k}.sqlite"
        assert main(["study", "run", str(small), "--share", f"{k}/3", "--store", str(share)]) == 0
    merged, whole = tmp_path / "merged.sqlite", tmp_path / "whole.sqlite"
    assert main(["study", "merge", str(merged), str(tmp_path / "missing.sqlite")]) == 2
    assert not merged.exists()
    assert main(["study", "merge", str(merged), *(str(tmp_path / f"part{k}.sqlite") for k in (1, 2, 3))]) == 0
    assert main(["study", "run", str(small), "--store", str(whole)]) == 0
    outcomes = [{key: r.outcome for key, r in Store(path).records().items()} for path in (merged, whole)]
    assert outcomes[0] == outcomes[1]
    assert len(outcomes[0]) == 4


@pytest.mark.skipif(sys.platform == "win32", reason="it is killed as POSIX does")
def test_killed_and_resumed_from_the_shell(tmp_path):
    file, kept = tmp_path / "long.toml", tmp_path / "long.sqlite"
    file.write_text(
        '[[study]]\nsystem = "henon-heiles"\nmethod = ["kahan-li-8", "taylor"]\nstep = 0.02\nspan= 600\nparts = 30\n'
    )
    canon = [sys.executable, "-m", "canon.cli", "study"]
    program = subprocess.Popen([*canon, "run", str(file), "--checkpoint", "0"])
    while not (kept.exists() and kept.stat().st_size and Store(kept).parts_done()):
        assert program.poll() is None
    program.send_signal(signal.SIGKILL)
    program.wait()
    assert 0 < max(Store(kept).parts_done().values()) < 30
    assert main(["study", "status", str(kept)]) == 3
    assert main(["study", "resume", str(kept)]) == 0
    whole = tmp_path / "whole.sqlite"
    assert main(["study", "run", str(file), "--store", str(whole)]) == 0
    assert {k: r.outcome for k, r in Store(kept).records().items()} == {
        k: r.outcome for k, r in Store(whole).records().items()
    }


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["status", "nowhere.sqlite"],
            "there is no file nowhere.sqlite; 'canon study run STUDY.toml' makes one",
        ),
        (["run", "nowhere.toml"], "nowhere.toml"),
        (["export", "{kept}", "table.xlsx"], "the ending of its name says the format; there are .csv"),
        (["status", "{text}"], "it is no SQLite file; give another file"),
        (["report", "{kept}", "no/such/folder.html"], "No such file or directory"),
    ],
)
def test_what_can_not_be_done_is_said(tmp_path, capsys, arguments, message):
    store = Store(tmp_path / "kept.sqlite")
    store.add_cases({"k": json.dumps(Case("kepler", Splitting("verlet"), 1.0, step=0.1).to_dict())})
    (tmp_path / "notes.txt").write_text("these are my notes, " * 100)
    places = {"kept": str(store.path), "text": str(tmp_path / "notes.txt")}
    assert main(["study", *(argument.format(**places) for argument in arguments)]) == 2
    out, err = said(capsys)
    assert out == ""
    assert err.startswith("canon study: ")
    assert message in err


@pytest.mark.parametrize("share", ["0/3", "4/3", "3", "a/b"])
def test_shares_that_make_no_sense(share, capsys):
    with pytest.raises(SystemExit, match="2"):
        main(["study", "run", "study.toml", "--share", share])
    assert "should be K/N, such as 3/16" in said(capsys)[1]


@pytest.mark.slow
def test_two_worker_processes(small, capsys):
    code = "import sys; from canon.cli import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", code, "study", "run", str(small), "--jobs", "2"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "4 finished, 0 failed, 0 pending" in done.stdout
