"""Tags of cases: words that results are found by, which are no part of what a case is."""

from __future__ import annotations

import reprlib
from dataclasses import replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable

    from canon.study.cases.case import Case

__all__ = ["tags_from", "unite"]

LONGEST = 100
"""Letters of a tag."""


def tags_from(written: Any) -> tuple[str, ...]:
    """Return tags as a study says them: a word, or a list of words.

    Raises
    ------
    ValueError
        One of them is no printable text of 1 to 100 letters.

    Examples
    --------
    >>> tags_from(["first try", "paper"]), tags_from("paper")
    (('first try', 'paper'), ('paper',))
    """
    words = written if isinstance(written, list | tuple) else [written]
    for word in words:
        if not (isinstance(word, str) and word.strip() and word.isprintable() and len(word) <= LONGEST):
            raise ValueError(
                f"tags = {reprlib.repr(word)}: a tag is a text of 1 to {LONGEST} printable letters"
            )
    return tuple(dict.fromkeys(words))


def unite(found: dict[Case, Case], cases: Iterable[Case]) -> None:
    """Add cases to those found, each to itself; one that is there already gets the further tags."""
    for case in cases:
        known = found.setdefault(case, case)
        if more := tuple(tag for tag in case.tags if tag not in known.tags):
            found[case] = replace(known, tags=known.tags + more)
