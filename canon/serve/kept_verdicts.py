"""Kept verdicts: what was proved or refuted once is not judged again while it is remembered."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import replace
from typing import TYPE_CHECKING

from canon.exercise.judge_pool import said

if TYPE_CHECKING:
    from canon.exercise.report.judgement import Judgement
    from canon.exercise.sheet.sheet import Claim

__all__ = ["KeptVerdicts"]

MOST = 2_000
"""Verdicts that are kept; the one that was asked for the longest ago goes first."""
LONGEST = 4_000
"""Characters of a claim whose verdict is kept."""


class KeptVerdicts:
    """Verdicts on the claims that were asked last.

    Only what holds or fails is kept: what was not decided may be, on a quieter machine.

    Examples
    --------
    >>> from canon.exercise import Claim, Judgement
    >>> kept, claim = KeptVerdicts(), Claim("a", "equality-only", {"lhs": "1", "rhs": "1"})
    >>> kept.keep(claim, Judgement("a", "equality-only", "holds"))
    >>> kept.verdict(Claim("b", "equality-only", {"lhs": "1", "rhs": "1"}))
    <Judgement 'b': equality-only, holds>
    """

    def __init__(self) -> None:
        self._found: OrderedDict[str, Judgement] = OrderedDict()

    def verdict(self, claim: Claim) -> Judgement | None:
        """Return the verdict on a claim that says the same, which took no time now; None where none is remembered."""
        key = said(claim)
        if (found := self._found.get(key)) is None:
            return None
        self._found.move_to_end(key)
        title = str(claim.keys.get("title", ""))
        return replace(found, id=claim.id, title=title, expect=claim.expect, file=claim.file, seconds=0.0)

    def keep(self, claim: Claim, judgement: Judgement) -> None:
        """Remember a verdict, if it is one that stays."""
        key = said(claim)
        if claim.errors or judgement.status not in ("holds", "fails") or len(key) > LONGEST:
            return
        self._found[key] = judgement
        while len(self._found) > MOST:
            self._found.popitem(last=False)
