"""``canon check``: judge sheets of claims."""

from __future__ import annotations

import sys
from itertools import islice
from typing import TYPE_CHECKING

from canon.command.argument_types import seconds, whole_number
from canon.printable import in_one_line, printable
from canon.process import JUDGING

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

    from canon.exercise.report.judgement import Judgement
    from canon.exercise.report.report import Report
    from canon.exercise.sheet.sheet import Claim, Sheet, SheetError
    from canon.process import Child

__all__ = ["DESCRIPTION", "EXAMPLES", "add_arguments", "run"]

_UNREADABLE = "unreadable sheet"

DESCRIPTION = """\
Judge each claim of one or more sheets. HOLDS is only said of what was proved, FAILS only of what was certainly
refuted; what is neither is UNDECIDED, with what is known. Nothing in a sheet is executed, and every claim has
a budget of time (10 s unless it says otherwise).
"""
_TEXT = """\
a sheet (TOML; JSON has the same keys):

  [[claim]]
  id = "pendulum"
  kind = "euler-lagrange"
  q = ["theta"]
  parameters = { m = "positive", l = "positive", g = "positive" }
  L = "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)"
  claim = ["theta'' + g/l*sin(theta) = 0"]

  [[claim]]
  id = "polar"
  kind = "canonicity"
  q = ["q"]
  p = ["p"]
  parameters = { q = "positive" }
  Q = ["sqrt(2*q)*cos(p)"]
  P = ["sqrt(2*q)*sin(p)"]

kinds of claims:
{kinds}

exit status: 0 all hold, 1 some fail, 3 none fails but some are undecided, 2 bad usage or an invalid claim;
with --expect 1 where a verdict differs from the claim's "expect", else 0

examples:
  canon check answers.toml
  canon check --json --jobs 4 class/*.json > verdicts.jsonl
  canon check --expect regression.toml
  canon check --only pendulum answers.toml
  canon check --html report.html --junit report.xml answers.toml
"""


def _kinds() -> str:
    from canon.exercise.sheet.kinds import KINDS

    names = list(KINDS)
    return "\n".join("  " + ", ".join(names[i : i + 4]) for i in range(0, len(names), 4))


EXAMPLES = _TEXT.replace("{kinds}", _kinds())


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command reads."""
    parser.add_argument(
        "sheets", metavar="SHEET", nargs="+", help="a .toml or .json file of claims; - reads JSON from stdin"
    )
    parser.add_argument("--json", action="store_true", help="one JSON object a line instead of a table")
    parser.add_argument(
        "--html", metavar="FILE", help="also write a page with formulas, counterexamples and steps"
    )
    parser.add_argument("--junit", metavar="FILE", help="also write JUnit XML, a test case for each claim")
    parser.add_argument(
        "--expect",
        action="store_true",
        help="compare with what each claim expects; exit 1 where a verdict differs",
    )
    parser.add_argument(
        "--only", metavar="ID", action="append", help="judge this claim only; may be repeated"
    )
    parser.add_argument(
        "--jobs",
        metavar="N",
        type=whole_number(256),
        default=1,
        help="how many claims are judged at once (1)",
    )
    parser.add_argument(
        "--budget", metavar="S", type=seconds(most=3600), help="seconds a claim, whatever the sheet says"
    )
    parser.add_argument(
        "--implicit-multiplication",
        action="store_true",
        help="a letter after a number is always a factor, never a unit: 2 m g l",
    )


def run(arguments: argparse.Namespace) -> int:
    """Judge the sheets, print each verdict as soon as it is there, return the exit status."""
    from canon.process import Child

    child = Child(JUDGING, leads=True)  # it imports SymPy while the sheets are read
    try:
        return _run(arguments, child)
    finally:
        child.kill()


def _run(arguments: argparse.Namespace, child: Child) -> int:
    from canon.exercise.report.report import Report

    sheets = _sheets(arguments.sheets)
    chosen = [(sheet, _chosen(sheet, arguments)) for sheet in sheets]
    claims = [claim for _, some in chosen for claim in some]
    unknown = set(arguments.only or ()) - {claim.id for claim in claims}
    if unknown:
        print(f"canon check: no claim is called {', '.join(sorted(unknown))}", file=sys.stderr)
    if unknown or not sheets:
        return 2
    judgements = _judged(chosen, claims, arguments, child)
    title = (sheets[0].title or sheets[0].file) if len(sheets) == 1 else ""
    report = Report(title, tuple(judgements), tuple(claims))
    if not arguments.json:
        print(report.summary)
    if not _files_written(report, arguments):
        return 2
    return _status(report, judgements, expected=arguments.expect)


def _sheets(names: Sequence[str]) -> list[Sheet]:
    """Read the sheets and tell of those that can't be read; no sheet where the only one can't be."""
    from canon.exercise.sheet.sheet import SheetError

    sheets: list[Sheet] = []
    for name in names:
        try:
            sheets.append(_read(name))
        except SheetError as error:
            print(printable(f"canon check: {error}"), file=sys.stderr)
            if len(names) > 1:
                sheets.append(_unreadable(name, error))
    return sheets


def _judged(
    chosen: Sequence[tuple[Sheet, list[Claim]]],
    claims: list[Claim],
    arguments: argparse.Namespace,
    child: Child,
) -> list[Judgement]:
    """Judge the claims of each sheet in turn, and show each judgement when it is there."""
    from canon.exercise.sheet_check import judged

    judgements: list[Judgement] = []
    coming = judged(claims, arguments.jobs, child)
    for sheet, some in chosen:
        if not arguments.json and (sheet.title or len(chosen) > 1):
            print(in_one_line(sheet.title or sheet.file))
        for judgement in islice(coming, len(some)):
            judgements.append(judgement)
            _show(judgement, json=arguments.json)
    return judgements


def _files_written(report: Report, arguments: argparse.Namespace) -> bool:
    """Write the page and the XML that were asked for, and tell whether they could be."""
    from pathlib import Path

    for name, written in ((arguments.html, report.to_html), (arguments.junit, report.to_junit)):
        if name is None:
            continue
        try:
            Path(name).write_text(written(), "utf-8")
        except OSError as error:
            print(f"canon check: {name}: can't be written ({error.strerror or error})", file=sys.stderr)
            return False
    return True


def _status(report: Report, judgements: list[Judgement], *, expected: bool) -> int:

    if not expected:
        return report.exit_status
    for judgement in report.unexpected:
        line = f"canon check: {judgement.id}: {judgement.status}, expected {judgement.expect}"
        print(in_one_line(line), file=sys.stderr)
    if any(judgement.status == "invalid" and not judgement.expect for judgement in judgements):
        return 2
    return 1 if report.unexpected else 0


def _read(name: str) -> Sheet:
    from canon.exercise.sheet.sheet import MAX_BYTES, SheetError, read_sheet, sheet_from

    if name != "-":
        return read_sheet(name)
    if sys.stdin is None:  # pyright: ignore[reportUnnecessaryComparison]  # where the program was started with it closed
        raise SheetError("standard input: it is closed")
    data = sys.stdin.buffer.read(MAX_BYTES + 1)
    if len(data) > MAX_BYTES:
        raise SheetError(f"standard input: more than {MAX_BYTES} bytes; split the sheet")
    return sheet_from(data, file="standard input")


def _unreadable(name: str, error: SheetError) -> Sheet:
    """Return a sheet in place of one of many that can't be read, so that the others are judged and it is told of."""
    from canon.exercise.sheet.sheet import Claim, ClaimError, Sheet

    claim = Claim(name, _UNREADABLE, errors=(ClaimError(name, "", str(error)),), file=name)
    return Sheet("", (claim,), name)


def _chosen(sheet: Sheet, arguments: argparse.Namespace) -> list[Claim]:
    from dataclasses import replace

    wanted = arguments.only
    claims = [c for c in sheet.claims if not wanted or c.id in wanted or c.kind == _UNREADABLE]
    if arguments.budget is not None:
        claims = [replace(claim, budget=arguments.budget) for claim in claims]
    if arguments.implicit_multiplication:
        side_by_side = {"implicit_multiplication": True}
        claims = [replace(claim, keys={**claim.keys, **side_by_side}) for claim in claims]
    return claims


def _show(judgement: Judgement, *, json: bool) -> None:
    if json:
        print(judgement.json_line, flush=True)
    else:
        print(*judgement.lines(), sep="\n", flush=True)
