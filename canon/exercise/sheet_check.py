"""Checking many claims in their order, in several processes, equal ones only once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from canon.exercise.judge_pool import JudgePool
from canon.exercise.report.report import Report
from canon.exercise.sheet.sheet import Sheet, read_sheet
from canon.expression.symbols.input_in_words import given_kind

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.exercise.report.judgement import Judgement
    from canon.exercise.sheet.sheet import Claim
    from canon.process import Child

__all__ = ["check", "judged"]


def check(
    sheet: str | Path | Sheet | Mapping[str, Any] | list[Any] | tuple[Any, ...],
    jobs: int = 1,
    *,
    budget: float | None = None,
) -> Report:
    """Judge every claim of a sheet, each in its budget, in a process that can be killed.

    Parameters
    ----------
    sheet
        A sheet, or what :func:`canon.exercise.sheet.sheet.read_sheet` reads: the path of one, its text, its tables.
    jobs
        How many processes judge at the same time.
    budget
        Seconds for each claim, whatever the sheet says; set it where strangers write the sheets.

    Returns
    -------
    Report
        The judgements in the order of the claims; a notebook shows it as a page.

    Raises
    ------
    SheetError
        Where the file is no sheet.

    Examples
    --------
    >>> from canon.exercise import Claim, Sheet
    >>> keys = {"lhs": "sin(2*x)", "rhs": "2*sin(x)*cos(x)", "parameters": {"x": "real"}}
    >>> report = check(Sheet("one", (Claim("a", "equality-only", keys),)))
    >>> report.counts
    {'holds': 1}
    """
    given_kind(
        sheet, (Sheet, str, Path, Mapping, list, tuple), "the sheet", "write Sheet(title, claims) of claims"
    )
    read = sheet if isinstance(sheet, Sheet) else read_sheet(sheet)
    if budget is not None and not 0.0 < budget <= 3600.0:
        raise ValueError(f"budget should be a number of seconds up to 3600, not {budget!r}")
    claims = read.claims if budget is None else tuple(replace(claim, budget=budget) for claim in read.claims)
    return Report(read.title or read.file, tuple(judged(claims, jobs)), claims)


def judged(claims: Sequence[Claim], jobs: int = 1, child: Child | None = None) -> Iterator[Judgement]:
    """Yield the judgement on each claim, in order.

    Parameters
    ----------
    claims
        Claims, such as those of the sheets of a whole class; what is said twice is judged once.
    jobs
        How many processes judge at the same time.
    child
        A judging process that was started before, for the first of them.

    Examples
    --------
    >>> from canon.exercise.sheet.sheet import Claim
    >>> same = {"lhs": "2*(x + 1)", "rhs": "2*x + 2", "parameters": {"x": "real"}}
    >>> [j.status for j in judged([Claim("a", "equality-only", same), Claim("b", "equality-only", same)])]
    ['holds', 'holds']
    """
    if given_kind(jobs, int, "jobs") < 1:
        raise ValueError(f"jobs should be a number of processes, 1 or more, not {jobs!r}")
    with JudgePool(max(1, min(jobs, len(claims))), warm=False, child=child) as pool:
        yield from pool.judged(claims)
