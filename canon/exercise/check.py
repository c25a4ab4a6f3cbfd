"""Checking many claims in their order, in several processes, equal ones only once."""

from __future__ import annotations

import json
import queue
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from canon.exercise.judging_process import Worker
from canon.exercise.report.report import Report
from canon.exercise.sheet.sheet import Sheet, read_sheet
from canon.expression.symbols.input_in_words import given_kind

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.exercise.report.judgement import Judgement
    from canon.exercise.sheet.sheet import Claim

__all__ = ["check", "judged"]

_OWN_KEYS = frozenset(("id", "title", "source", "expect"))
"""Keys that say nothing about mechanics."""


def check(sheet: str | Path | Sheet, jobs: int = 1) -> Report:
    """Judge every claim of a sheet, each in its budget, in a process that can be killed.

    Parameters
    ----------
    sheet
        A sheet, or the path of one.
    jobs
        How many processes judge at the same time.

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
    given_kind(sheet, (Sheet, str, Path), "the sheet", "write Sheet(title, claims) of claims")
    read = sheet if isinstance(sheet, Sheet) else read_sheet(sheet)
    return Report(read.title or read.file, tuple(judged(read.claims, jobs)), read.claims)


def judged(claims: Sequence[Claim], jobs: int = 1) -> Iterator[Judgement]:
    """Yield the judgement on each claim, in order.

    Parameters
    ----------
    claims
        Claims, such as those of the sheets of a whole class; what is said twice is judged once.
    jobs
        How many processes judge at the same time.

    Examples
    --------
    >>> from canon.exercise.sheet.sheet import Claim
    >>> same = {"lhs": "2*(x + 1)", "rhs": "2*x + 2", "parameters": {"x": "real"}}
    >>> [j.status for j in judged([Claim("a", "equality-only", same), Claim("b", "equality-only", same)])]
    ['holds', 'holds']
    """
    if given_kind(jobs, int, "jobs") < 1:
        raise ValueError(f"jobs should be a number of processes, 1 or more, not {jobs!r}")
    with ExitStack() as stack:
        workers = [stack.enter_context(Worker()) for _ in range(jobs)]
        idle: queue.SimpleQueue[Worker] = queue.SimpleQueue()
        for worker in workers:
            idle.put(worker)
        pool = stack.enter_context(ThreadPoolExecutor(jobs))

        def judge(claim: Claim) -> Judgement:
            worker = idle.get()
            try:
                return worker.judge(claim)
            finally:
                idle.put(worker)

        first = {said: claim for claim in reversed(claims) if (said := _said(claim))}
        running = {said: pool.submit(judge, claim) for said, claim in reversed(first.items())}
        try:
            for claim in claims:
                found = running[_said(claim)].result()
                title = str(claim.keys.get("title", ""))
                yield replace(found, id=claim.id, title=title, expect=claim.expect, file=claim.file)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
            for worker in workers:  # nobody waits for what they are judging still
                worker.stop()


def _said(claim: Claim) -> str:
    """Return everything in a claim that matters to its judgement, as text; an ill-formed one is itself only."""
    if claim.errors:
        return f"{claim.id}: {claim.errors}"
    keys = {key: value for key, value in claim.keys.items() if key not in _OWN_KEYS}
    return json.dumps([keys, claim.budget], sort_keys=True, default=str)
