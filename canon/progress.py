"""Progress of a run with an estimate of what is left, on standard error where a person looks at it."""

from __future__ import annotations

import contextlib
import importlib.util
import sys
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

__all__ = ["reporting"]

_PATIENCE = 1.0
"""Seconds before anything is shown, and between lines where tqdm is not installed."""


@contextlib.contextmanager
def reporting(progress: Callable[[float], None] | bool | None) -> Generator[Callable[[float], None]]:
    """Yield what a run is to call with the fraction done.

    Parameters
    ----------
    progress
        A function: that one. True: a bar with an estimate, by tqdm where it is installed and as plain lines
        otherwise, on standard error where that is a terminal; nothing where it is piped. None or False:
        nothing.

    Examples
    --------
    >>> seen = []
    >>> with reporting(seen.append) as report:
    ...     report(0.5)
    >>> seen
    [0.5]
    """
    if callable(progress):
        yield progress
    elif not progress or not sys.stderr.isatty():
        yield lambda _: None
    elif importlib.util.find_spec("tqdm"):
        with _bar() as report:
            yield report
    else:
        with _lines() as report:
            yield report


@contextlib.contextmanager
def _bar() -> Generator[Callable[[float], None]]:
    from tqdm import tqdm

    shown = "{l_bar}{bar}| {elapsed} < {remaining}"
    with tqdm(total=1.0, delay=_PATIENCE, bar_format=shown, leave=False, file=sys.stderr) as bar:

        def report(fraction: float) -> None:
            bar.update(fraction - bar.n)

        yield report


@contextlib.contextmanager
def _lines() -> Generator[Callable[[float], None]]:
    started = last = time.monotonic()
    width = 0

    def report(fraction: float) -> None:
        nonlocal last, width
        now = time.monotonic()
        if now - last < _PATIENCE or fraction <= 0:
            return
        last = now
        left = (now - started) * (1 - fraction) / fraction
        line = f"{100 * fraction:3.0f} % done, about {left:.0f} s left"
        sys.stderr.write("\r" + line.ljust(width))
        sys.stderr.flush()
        width = len(line)

    try:
        yield report
    finally:
        if width:
            sys.stderr.write("\r" + " " * width + "\r")
            sys.stderr.flush()
