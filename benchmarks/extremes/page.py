"""The page docs/extremes.md: a table for every part."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

from extremes.row import shown

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from extremes.row import Row

__all__ = ["bounded", "page", "summary"]

Pieces = list[dict[str, Any]]

_HEAD = """\
# At the extremes

Where numbers, expressions and systems end: what was tried, what ordinary tools do there, and what canon does.
Written by `python benchmarks/extremes.py`; every row runs in a process of its own, under a limit of time and memory.

A result stands with its true error and the error that the tool itself states (canon: an estimate with the trajectory or
verdict; others: the tolerance they were asked for). **said** is a clear error, a warning or UNDECIDED with the reason;
**wrong** is a wrong answer that nothing warns of, **unstated** a result whose error the tool does not state; seconds
are wall time in a warm process, with compilation.
"""

_SECTION = re.compile(r"^## (\w+)$(.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)
_TITLES = {"numeric": "Numeric", "symbolic": "Symbolic", "system": "System"}
_WORDS = {
    "result": "result", "said": "said", "wrong": "**wrong**", "unknown": "unstated", "hang": "**hangs**",
    "crash": "**crash**",
}  # fmt: skip


def summary(found: Sequence[tuple[Row, Pieces]]) -> str:
    """Return one line about a part's rows."""
    kinds = [pieces[0]["kind"] for _, pieces in found]
    stated, held = bounded(found)
    counts = ", ".join(
        f"{kinds.count(kind)} {word}"
        for kind, word in (
            ("result", "results within their stated error"), ("said", "clear errors or UNDECIDED"),
            ("unknown", "without a stated error"), ("wrong", "silently wrong"), ("hang", "hung"), ("crash", "crashed"),
        )
    )  # fmt: skip
    share = f"; the estimate bounds the true error in {held} of {stated} rows" if stated else ""
    return f"{len(found)} rows: {counts}{share}."


def bounded(found: Sequence[tuple[Row, Pieces]]) -> tuple[int, int]:
    """Return in how many rows canon states an error that can be compared, and in how many it bounds the true one."""
    both = [
        (p[0]["error"], p[0]["estimate"])
        for _, p in found
        if None not in (p[0].get("error"), p[0].get("estimate"))
    ]
    return len(both), sum(error <= estimate for error, estimate in both)


def page(parts: Mapping[str, Sequence[tuple[Row, Pieces]]], where: str, earlier: str = "") -> str:
    """Return the page; a part without rows is taken from an earlier page, with where and when it was run."""
    kept = {title: f"## {title}{rest}" for title, rest in _SECTION.findall(earlier)}
    tables = {part: _table(part, found, where) for part, found in parts.items() if found}
    sections = [tables.get(part) or kept.get(_TITLES.get(part, part), "") for part in parts]
    return "\n".join([_HEAD, *filter(None, sections)])


def _table(part: str, found: Sequence[tuple[Row, Pieces]], where: str) -> str:
    head = "| row | tried | ordinary tools | canon | true error | stated | s |\n|---|---|---|---|---|---|---|"
    lines = [_line(row, pieces) for row, pieces in found]
    said = f"{summary(found)}\nRun on {where}."
    return "\n".join([f"## {_TITLES.get(part, part)}\n\n{said}\n", head, *lines, ""])


def _line(row: Row, pieces: Pieces) -> str:
    own, *others = pieces
    ordinary = "<br>".join(f"{each['tool']}: {_WORDS[each['kind']]}, {_with_error(each)}" for each in others)
    cells = [
        row.name, shown(row.tried, 400), ordinary or "–", f"{_WORDS[own['kind']]}, {own['said']}",
        _number(own["error"]), _number(own["estimate"]), _number(own["seconds"]),
    ]  # fmt: skip
    return f"| {' | '.join(cells)} |"


def _with_error(piece: Mapping[str, Any]) -> str:
    return piece["said"] if piece["error"] is None else f"{piece['said']} (error {_number(piece['error'])})"


def _number(x: float | None) -> str:
    return "–" if x is None or math.isnan(x) else f"{x:.2g}"
