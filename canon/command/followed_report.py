"""Report that follows a study: a page written anew while the study runs, as often as something has changed."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from canon.study.cases.result import Results
    from canon.study.cases.store import Store

__all__ = ["follow"]


def follow(
    store: Store, asked: Callable[[], Results], output: Path, seconds: float, told: Callable[[str], None]
) -> None:
    """Write the page of a study again and again until no case is pending.

    An open browser loads it again as often as it may have changed; the last page, also after an interruption, no longer
    asks it to.

    Parameters
    ----------
    store
        The results file.
    asked
        Gives the results that are shown.
    output
        The page.
    seconds
        Time between two looks.
    told
        Called with a line each time the page was written.
    """
    from canon.study.cases.run_study import status_of

    seen: object = None
    try:
        while (status := status_of(store)).pending:
            now = (status, store.parts_done())
            if now != seen:
                _write(asked(), store.path.stem, output, seconds)
                told(f"{output}: {status}")
                seen = now
            time.sleep(seconds)
    finally:
        _write(asked(), store.path.stem, output)


def _write(results: Results, title: str, output: Path, seconds: float | None = None) -> None:
    """Write the page as a whole, so that no browser reads half of one."""
    from canon.plot.study_page import study_report

    part = output.with_name(f".{output.name}.part")
    part.write_text(study_report(results, title, seconds), encoding="utf-8")
    part.replace(output)
