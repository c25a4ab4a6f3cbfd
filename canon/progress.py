"""Progress with the time that is left, by tqdm, on standard error where a person looks at it."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from typing import NoReturn

    from tqdm import tqdm

__all__ = ["ProgressBar", "reporting"]

_PATIENCE = 1.0
"""Seconds before anything is shown: short work needs no bar."""
_EVERY = 0.1
"""Seconds between two changes of the line."""
_LINE = "{l_bar}{bar:20}| {remaining} left{postfix}"


class ProgressBar:
    """One line with what is being done, a bar and the time that is left; silent where standard error is no terminal.

    Call it with what is being done and how much of it is done; another name begins another bar.

    Examples
    --------
    >>> with ProgressBar() as progress:
    ...     progress("verlet", 0.5)
    """

    def __init__(self) -> None:
        self._bar: tqdm[NoReturn] | None = None
        self._what = ""

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    def __call__(self, what: str, done: float, of: float = 1.0, note: str = "") -> None:
        """Show how much is done.

        Parameters
        ----------
        what
            What is being done. What was done of it when it was named first says nothing of the time that is left.
        done, of
            So much, of so much.
        note
            What else there is to say.
        """
        if not sys.stderr.isatty():
            return
        if self._bar is None or what != self._what:
            self._end()
            self._bar, self._what = _bar(what, done, of), what
        self._bar.set_postfix_str(note, refresh=False)
        self._bar.update(done - self._bar.n)

    def _end(self) -> None:
        if self._bar is not None:
            self._bar.close()


def _bar(what: str, done: float, of: float) -> tqdm[NoReturn]:
    from tqdm import tqdm

    return tqdm(
        desc=what,
        initial=done,
        total=of,
        bar_format=_LINE,
        delay=_PATIENCE,
        mininterval=_EVERY,
        miniters=0,
        leave=False,
        file=sys.stderr,
    )


@contextmanager
def reporting(progress: Callable[[float], None] | bool | None) -> Generator[Callable[[float], None]]:
    """Yield what a run is to call with the fraction done.

    Parameters
    ----------
    progress
        A function: that one. True: a bar on standard error where that is a terminal; nothing where it is piped.
        None or False: nothing.

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
    elif not progress:
        yield lambda _: None
    else:
        with ProgressBar() as bar:
            bar("", 0.0)
            yield lambda fraction: bar("", fraction)
