"""SIGKILL at any moment of a study that keeps everything: not a bit of what is kept changes, nothing is read half."""

from __future__ import annotations

import random
import signal
import subprocess
import sys
import time

import pytest

from canon import results_of, run_study
from canon.study import mend
from canon.study.cases.chunk_damage import damaged_chunks
from canon.study.cases.store import Store
from canon.study.kept.chunk_file import ChunkFolder

from .kept_studies import FUNCTIONS, STUDY, all_of

PROGRAM = """
import sys
from tests.study.kept_studies import FUNCTIONS, STUDY
from canon import run_study

run_study(
    STUDY, sys.argv[1], keep=FUNCTIONS, checkpoint_seconds=0.0, progress=lambda status: print(status, flush=True)
)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="it is killed as POSIX does")
def test_killed_at_any_moment_what_is_kept_is_the_same(tmp_path):
    whole = tmp_path / "whole.sqlite"
    run_study(STUDY, whole, keep=FUNCTIONS)
    rows, files = all_of(whole)
    draw, killed = random.Random(5), 0
    for number in range(8):
        path = tmp_path / f"killed{number}.sqlite"
        while True:
            program = subprocess.Popen(
                [sys.executable, "-c", PROGRAM, str(path)], stdout=subprocess.PIPE, text=True
            )
            for _ in range(draw.randint(1, 4)):
                program.stdout.readline()
            time.sleep(draw.uniform(0.0, 0.02))
            program.send_signal(signal.SIGKILL)
            ended = program.wait() != -signal.SIGKILL
            program.stdout.close()
            killed += not ended
            assert damaged_chunks(Store(path)) == ()
            found, kept = all_of(path)
            assert found.items() <= rows.items()
            assert {name: kept[name] for name in kept if not name.startswith(".")}.items() <= files.items()
            if ended or len(found) == len(rows):
                break
        for left in mend(path).chunks:
            assert left.why == "no record names it"
        run_study(STUDY, path, keep=FUNCTIONS)
        assert all_of(path) == (rows, files)
    assert killed >= 12


def test_killed_between_writing_and_naming_a_chunk(tmp_path, monkeypatch):
    """The moment a kill seldom meets: the chunk is written in part, or whole while its record is not."""
    path = tmp_path / "study.sqlite"

    def killed(self, record, before):
        before()
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(Store, "save", killed)
        with pytest.raises(KeyboardInterrupt):
            run_study(STUDY, path, keep=FUNCTIONS)
    (chunk,) = ChunkFolder(path).files()
    part = chunk.with_name(f".{chunk.name}.abcdef")
    part.write_bytes(chunk.read_bytes()[:100])
    assert [len(result.kept) for result in results_of(path)] == [0, 0]
    assert [left.why for left in mend(path).chunks] == ["no record names it"] * 2
    assert ChunkFolder(path).files() == []
    run_study(STUDY, path, keep=FUNCTIONS)
    assert [len(result.kept) for result in results_of(path)] == [4, 4]
