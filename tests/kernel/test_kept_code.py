"""Machine code kept between processes: the same bits, made anew where it is damaged, and from a safe folder only."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from canon.kernel.llvm import kept_code
from canon.kernel.llvm.kept_code import MOST_KEPT, folder_of_code, kept_or_made

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

MOTION = """
from canon import Splitting, propagate
from canon.scene import find
from canon.kernel.llvm import machine_code

made = []
compile_anew = machine_code.object_code
machine_code.object_code = lambda *given: made.append(1) or compile_anew(*given)
scene = find("kepler")
motion = propagate(
    scene.hamiltonian, (0, 10), scene.state(scene.starts[0]), method=Splitting("kahan-li-8"), step=0.01,
    parameters=scene.values,
)
print(len(made), motion.y.tobytes().hex())
"""

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="the folder is set by XDG_CACHE_HOME here")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The folder for machine code, below an empty one."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(sys, "platform", "linux")
    folder_of_code.cache_clear()
    found = folder_of_code()
    assert found is not None
    assert found.parents[1] == tmp_path.resolve()
    yield found
    folder_of_code.cache_clear()


def made(folder: Path) -> tuple[int, str]:
    """Return how many functions a new process compiles for a motion, and the motion."""
    settings = {**os.environ, "XDG_CACHE_HOME": str(folder.parents[1])}
    done = subprocess.run(
        [sys.executable, "-c", MOTION], capture_output=True, text=True, check=True, env=settings
    )
    count, bits = done.stdout.split()
    return int(count), bits


@pytest.mark.skipif(sys.platform != "linux", reason="the folder of another process is set by XDG_CACHE_HOME")
def test_another_process_takes_what_is_kept_and_gets_the_same_bits(folder: Path) -> None:
    first, bits = made(folder)
    assert first > 0
    assert made(folder) == (0, bits)
    for file in folder.iterdir():
        whole = bytearray(file.read_bytes())
        whole[len(whole) // 2] ^= 1
        file.write_bytes(whole)
    assert made(folder) == (first, bits), "damaged code was run"
    assert made(folder) == (0, bits), "what was damaged is not kept anew"


def test_it_is_made_once_for_each_program(folder: Path) -> None:
    calls: list[str] = []

    def make(what: str) -> bytes:
        calls.append(what)
        return what.encode()

    for what in ("a", "b", "a", "b", "a"):
        assert kept_or_made(what, lambda what=what: make(what)) == what.encode()
    assert calls == ["a", "b"]
    for file in folder.iterdir():
        file.write_bytes(file.read_bytes()[:20])
    assert kept_or_made("a", lambda: make("again")) == b"again"


@pytest.mark.parametrize("mode", [0o770, 0o707, 0o777])
def test_a_folder_that_others_write_to_is_not_trusted(folder: Path, mode: int) -> None:
    kept_or_made("a", lambda: b"good")
    folder.chmod(mode)
    folder_of_code.cache_clear()
    assert folder_of_code() is None
    assert kept_or_made("a", lambda: b"made anew") == b"made anew"


@pytest.mark.parametrize(("mode", "safe"), [(0o770, False), (0o777, False), (0o1777, True), (0o755, True)])
def test_nor_is_one_that_others_may_exchange(folder: Path, mode: int, safe: bool) -> None:
    folder.parent.chmod(mode)
    folder_of_code.cache_clear()
    assert folder_of_code() == (folder if safe else None)


def test_nothing_is_kept_where_there_is_no_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "linux")
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    folder_of_code.cache_clear()
    assert folder_of_code() is None
    assert kept_or_made("a", lambda: b"code") == b"code"
    folder_of_code.cache_clear()


def test_the_oldest_go_where_there_are_too_many(folder: Path) -> None:
    for k in range(5):
        file = folder / f"{k}.o"
        file.touch()
        os.truncate(file, MOST_KEPT // 3)
        os.utime(file, (k, k))
    kept_code._forget_oldest(folder)
    assert sorted(file.name for file in folder.iterdir()) == ["2.o", "3.o", "4.o"]


def test_a_full_disk_leaves_no_half_files(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(kept_code.Path, "replace", full)
    assert kept_or_made("a", lambda: b"code") == b"code"
    assert list(folder.iterdir()) == []
