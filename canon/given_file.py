"""Files that are given by name: read up to a limit, and never from a device or a pipe that may not end."""

from __future__ import annotations

import os
import re
import stat
import tomllib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

__all__ = ["UnreadableFile", "bytes_of", "tables_of"]

PIPES_OF_SHELLS = ("/dev/fd/", "/dev/stdin", "/proc/self/fd/")
"""What a shell hands over for ``<(…)``: a pipe that whoever gives the command has just made."""

_LONG_DOTTED_KEY = re.compile(
    r"""(?<![\w.-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){32}""", re.ASCII
)
"""Python's TOML parser takes time in proportion to the square of the length of such a key."""

KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}


class UnreadableFile(ValueError):
    """Something that can't be read as a file; says why, without its name."""


def bytes_of(path: Path, most: int, instead: str) -> bytes:
    """Return what stands in a file.

    Parameters
    ----------
    path
        The file. A pipe only where a shell made it for the command.
    most
        Bytes that it may have; no more are ever read.
    instead
        What to do where it has more.

    Raises
    ------
    UnreadableFile
        Where it is not there, no file, or too long.

    Examples
    --------
    >>> from pathlib import Path
    >>> bytes_of(Path("no such file"), 100, "split it")
    Traceback (most recent call last):
        ...
    canon.given_file.UnreadableFile: can't be read (No such file or directory)
    """
    # Windows would change the ends of lines and stop at a Ctrl-Z; a pipe without a writer would be waited for.
    as_it_is = os.O_RDONLY | getattr(os, "O_BINARY", 0) | getattr(os, "O_NONBLOCK", 0)
    try:
        with os.fdopen(os.open(path, as_it_is), "rb") as file:
            kind = stat.S_IFMT(os.fstat(file.fileno()).st_mode)
            if kind == stat.S_IFIFO and str(path).startswith(PIPES_OF_SHELLS):
                os.set_blocking(file.fileno(), True)
            elif kind != stat.S_IFREG:
                raise UnreadableFile(f"it is {KINDS.get(kind, 'something else')} and no file")
            data = file.read(most + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, UnreadableFile):
            raise
        raise UnreadableFile(f"can't be read ({getattr(error, 'strerror', None) or error})") from error
    if len(data) > most:
        raise UnreadableFile(f"it has more than {most} bytes, and no more are read; {instead}")
    return data


def tables_of(text: str, number: Callable[[str], Any] = float) -> dict[str, Any]:
    r"""Return what a text in TOML says, in time that is proportional to its length.

    Parameters
    ----------
    text
        The text.
    number
        Makes a number of a decimal.

    Raises
    ------
    ValueError
        Where it is not TOML, nested too deeply, or a key has more than 32 parts.

    Examples
    --------
    >>> tables_of("[a]\nb = 1")
    {'a': {'b': 1}}
    """
    if long := _LONG_DOTTED_KEY.search(text):
        line = text.count("\n", 0, long.start()) + 1
        raise ValueError(f"a key of more than 32 parts, at line {line}")
    try:
        return tomllib.loads(text, parse_float=number)
    except RecursionError as error:
        raise ValueError("nested too deeply") from error
