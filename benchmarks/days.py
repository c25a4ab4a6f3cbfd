"""The days on which stored results were measured: scripts that keep results name them, and the page repeats them."""

from __future__ import annotations

import re
from datetime import date
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["days_in", "in_words", "today"]

_DAY = re.compile(r"\b20\d\d-\d\d-\d\d\b")
_HEADER = re.compile(r"^(?:python [^\n]*?, |measured on )?20\d\d-\d\d-\d\d\b[^\n]*", re.MULTILINE)


def today() -> str:
    return date.today().isoformat()


def in_words(days: Iterable[str]) -> str:
    """Return one day, two days, or the first and the last of more."""
    found = sorted({*days})
    return " and ".join(found) if len(found) < 3 else f"{found[0]} to {found[-1]}"


def days_in(printed: str) -> str:
    """Return the days that the headers of an output name, in words; nothing where it has no header."""
    return in_words(day for header in _HEADER.findall(printed) for day in _DAY.findall(header))
