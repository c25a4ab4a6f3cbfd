"""Labels of a study's cases: words that tell every two apart, with more digits or a number where they need them."""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING

from canon.study.cases.result import motion_in_words, setting_in_words
from canon.study.motion.system_text import SystemText

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Sequence

    from canon.study.cases.case import Case
    from canon.study.cases.result import Result

__all__ = ["error_symbol", "labels_of"]

DIGITS = ({"digits": 6}, {"digits": 9}, {"digits": 13}, {"digits": 17})
"""Digits that numbers are written with beside those of every day: as many as tell cases apart."""


def labels_of(results: Sequence[Result]) -> tuple[list[str], list[str]]:
    """Return a label of the motion and one of the setting of each result; no two results have the same two.

    Runs of one motion by one setting, as over different spans, are numbered.
    """
    cases = [result.case for result in results]
    motions = _labels(cases, [case.what_moves for case in cases], motion_in_words)
    met: dict[Hashable, int] = {}
    settings: list[Hashable] = []
    for case in cases:
        cell = case.what_moves, case.setting
        met[cell] = met.get(cell, 0) + 1
        settings.append((case.setting, met[cell]))
    return motions, _labels(cases, settings, setting_in_words)


def _labels(cases: Sequence[Case], keys: Sequence[Hashable], words: Callable[..., str]) -> list[str]:
    """Return a label for each case, the same for the same key only."""
    first = dict(zip(reversed(keys), reversed(cases), strict=True))
    shown = [{key: words(first[key], **digits) for key in dict.fromkeys(keys)} for digits in ({}, *DIGITS)]
    apart = [len(set(said.values())) for said in shown]
    said, taken = shown[apart.index(max(apart))], set[str]()
    for key, label in said.items():
        said[key] = next(
            each for n in count(1) if (each := f"{label} ({n})" if n > 1 else label) not in taken
        )
        taken.add(said[key])
    return [said[key] for key in keys]


def error_symbol(results: Sequence[Result]) -> str:
    """Return what the errors of finished cases are called: ``ΔE/E``, ``ΔE`` where one is absolute, ΔI of no energy."""
    judged = [result for result in results if result.numbers]
    known = not any(isinstance(r.case.system, SystemText) and not r.case.system.has_energy for r in judged)
    letter = "E" if known else "I"
    return f"Δ{letter}/{letter}" if all(r.numbers.get("relative", True) for r in judged) else f"Δ{letter}"
