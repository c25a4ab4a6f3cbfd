"""Reports of judged claims: a table, JSON lines, an exit status."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.exercise.report.judgement import MARKS, Judgement
from canon.expression.symbols.input_in_words import counted
from canon.printable import in_one_line

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.exercise.sheet.sheet import Claim

__all__ = ["Report"]


@dataclass(frozen=True)
class Report:
    """The judgements of a sheet, in the order of its claims.

    Parameters
    ----------
    title
        Of the sheet.
    judgements
        One for each claim; iterating over the report gives them.
    claims
        The claims themselves, so that a page can show what was claimed; may be missing.

    Examples
    --------
    >>> report = Report("two", (Judgement("a", "equality-only", "holds"), Judgement("b", "equality-only", "fails")))
    >>> [judgement.id for judgement in report if judgement.status == "fails"], report.counts, report.exit_status
    (['b'], {'holds': 1, 'fails': 1}, 1)
    """

    title: str
    judgements: tuple[Judgement, ...]
    claims: tuple[Claim, ...] = ()

    def __iter__(self) -> Iterator[Judgement]:
        return iter(self.judgements)

    def __len__(self) -> int:
        return len(self.judgements)

    @property
    def counts(self) -> dict[str, int]:
        """How many judgements have each status; a status that none has is left out."""
        return {status: self.count(status) for status in MARKS if self.count(status)}

    def count(self, status: str) -> int:
        """Return how many judgements have a status."""
        return sum(judgement.status == status for judgement in self.judgements)

    @property
    def exit_status(self) -> int:
        """0: all hold; 1: some fail; 3: none fails, some are undecided; 2: one is invalid, or there is none."""
        if self.count("invalid") or not self.judgements:
            return 2
        if self.count("fails"):
            return 1
        return 3 if self.count("undecided") else 0

    @property
    def unexpected(self) -> tuple[Judgement, ...]:
        """The judgements that differ from what the author expects."""
        return tuple(judgement for judgement in self.judgements if not judgement.as_expected)

    @property
    def summary(self) -> str:
        """One line: how many of each."""
        counts = ", ".join(f"{number} {status}" for status, number in self.counts.items())
        seconds = sum(judgement.seconds for judgement in self.judgements)
        points = f", {self.points_in_words}" if self.out_of else ""
        return f"{counted(len(self.judgements), 'claim')}: {counts or 'none'}{points} ({seconds:.1f} s)"

    @property
    def earned(self) -> float:
        """The points of all claims together, as far as they are known."""
        return sum(judgement.earned or 0.0 for judgement in self.judgements)

    @property
    def out_of(self) -> float:
        """What all claims together are worth."""
        return sum(judgement.points or 0.0 for judgement in self.judgements)

    @property
    def points_in_words(self) -> str:
        """How many points there are, and of how many that is not known."""
        open_ = sum(j.points for j in self.judgements if j.points is not None and j.share is None)
        return f"{self.earned:.4g} of {self.out_of:g} points" + (f", {open_:g} of them open" if open_ else "")

    def json_lines(self) -> str:
        """Return one JSON object a line."""
        return "".join(judgement.json_line + "\n" for judgement in self.judgements)

    def to_json(self) -> str:
        """Return the whole report as one JSON object: title, counts, exit status and the claims in their order."""
        claims = [judgement.to_dict() for judgement in self.judgements]
        said = {"title": self.title, "counts": self.counts, "exit_status": self.exit_status, "claims": claims}
        points = {"earned": self.earned, "out_of": self.out_of} if self.out_of else {}
        return json.dumps({**said, **points}, indent=1)

    def to_html(self) -> str:
        """Return the report as a page: formulas set, everything in one file, no script, nothing fetched."""
        from canon.exercise.report.page import page

        return page(self)

    def to_junit(self) -> str:
        """Return the report as JUnit XML, a test case for each claim, for the test tab of a CI."""
        from canon.exercise.report.junit import junit

        return junit(self)

    def __repr__(self) -> str:
        return f"<Report {self.title!r}: {self.summary}>"

    def _repr_html_(self) -> str:
        from canon.exercise.report.page import fragment

        return fragment(self)

    def __str__(self) -> str:
        lines = [in_one_line(self.title)] if self.title else []
        lines += [line for judgement in self.judgements for line in judgement.lines()]
        return "\n".join([*lines, self.summary])
