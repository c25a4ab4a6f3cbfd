"""Machine code kept between processes: object files in a folder of the user's own, by what they were made of.

To load a loop takes a small part of the time to compile it (``benchmarks/preparation.py``). A file is named by the
SHA-256 of the program, of LLVM's version and of the processor it was made for, and holds the SHA-256 of its code, so
that a damaged one is made anew. Code is loaded from a folder only where nobody else can write to it or exchange it;
where there is none, nothing is kept.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import stat
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["MOST_KEPT", "folder_of_code", "kept_or_made"]

MOST_KEPT = 64 * 2**20
"""Bytes of machine code that are kept, some thousands of loops; the oldest go first."""

_DIGEST = hashlib.sha256().digest_size
_OTHERS_WRITE = 0o022


def kept_or_made(made_of: str, make: Callable[[], bytes]) -> bytes:
    """Return the object file of a program: the kept one, or a new one, which is kept.

    Parameters
    ----------
    made_of
        Everything that the code depends on.
    make
        Compiles the program.
    """
    folder = folder_of_code()
    if folder is None:
        return make()
    file = folder / f"{hashlib.sha256(made_of.encode()).hexdigest()}.o"
    found = _read(file)
    if found is None:
        found = make()
        _write(file, found)
    return found


@functools.cache
def folder_of_code() -> Path | None:
    """Return the folder for machine code, made where it is missing; None where there is no safe place for one."""
    try:
        folder = (_caches() / "canon" / "machine-code").resolve()
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if sys.platform != "win32" and not (_is_own(folder) and all(map(_is_guarded, folder.parents))):
            return None
        _forget_oldest(folder)
    except (OSError, RuntimeError):  # Path.home() raises the latter where there is no home
        return None
    return folder


def _is_own(folder: Path) -> bool:
    """Tell whether a folder is the user's, and nobody else may write to it."""
    about = folder.stat()
    return about.st_uid == os.getuid() and not about.st_mode & _OTHERS_WRITE


def _is_guarded(folder: Path) -> bool:
    """Tell whether nobody but the user and the system can exchange what lies in a folder, as in ``/tmp``."""
    about = folder.stat()
    return about.st_uid in (0, os.getuid()) and bool(
        about.st_mode & stat.S_ISVTX or not about.st_mode & _OTHERS_WRITE
    )


def _caches() -> Path:
    """Return where this platform keeps what can be made anew."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    given = Path(os.environ.get("XDG_CACHE_HOME", ""))
    return given if given.is_absolute() else Path.home() / ".cache"


def _read(file: Path) -> bytes | None:
    """Return the code in a file; None where there is none, or it is not what was written."""
    try:
        whole = file.read_bytes()
    except OSError:
        return None
    code = whole[_DIGEST:]
    return code if hashlib.sha256(code).digest() == whole[:_DIGEST] else None


def _write(file: Path, code: bytes) -> None:
    """Keep code in a file, which appears at once or not at all; where it can't be written it is not kept."""
    with contextlib.suppress(OSError):
        handle, name = tempfile.mkstemp(dir=file.parent)
        digest = hashlib.sha256(code).digest()
        try:
            with os.fdopen(handle, "wb") as out:
                out.write(digest + code)
            Path(name).replace(file)
            if digest[0] == 0:  # now and then, in processes that go on for long
                _forget_oldest(file.parent)
        except OSError:
            Path(name).unlink(missing_ok=True)


def _forget_oldest(folder: Path) -> None:
    """Delete the files that were written first, where there are too many bytes of them."""
    files = [
        (about.st_mtime, about.st_size, entry.path) for entry in os.scandir(folder) if (about := entry.stat())
    ]
    room = MOST_KEPT
    for _, size, path in sorted(files, reverse=True):
        room -= size
        if room < 0:
            Path(path).unlink(missing_ok=True)
