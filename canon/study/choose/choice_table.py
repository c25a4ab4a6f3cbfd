"""Accuracy and its cost as text: a choice with the candidates it was chosen from, runs of given steps."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.study.drift.drift_table import aligned

if TYPE_CHECKING:
    from canon.study.choose.candidate import Candidate
    from canon.study.choose.choose import Choice
    from canon.study.choose.work_precision import WorkPrecision, WorkRow

__all__ = ["answer", "choice_table", "duration_in_words", "work_table"]


MEANINGLESS = 0.1
"""Relative position error from which the position is lost."""


def choice_table(choice: Choice) -> str:
    """Return a choice as an answer in words, and the table of the candidates.

    Examples
    --------
    >>> from canon import choose
    >>> from canon.scene import find
    >>> print(choice_table(choose(find("henon-heiles"), None, 1e4, 1e-3)).splitlines()[0])
    Hénon–Heiles: a star in the meridian plane of a galaxy
    """
    head = ("method", "order", "step", "precision", "error", "evaluations", "CPU", "")
    lines = aligned([head, *map(_cells, choice.candidates)], right={1, 2, 4, 5, 6})
    rule = "─" * max(map(len, lines))
    asked = f"{choice.observable} to {choice.accuracy:.2g} over t = {choice.span:.6g}"
    return "\n".join([choice.title, f"{asked}: {answer(choice)}", "", lines[0], rule, *lines[1:], rule])


def work_table(work: WorkPrecision) -> str:
    """Return what each run cost and how precise it was, as a table with a title.

    Examples
    --------
    >>> from canon import RK4, work_precision
    >>> from canon.scene import find
    >>> print(work_table(work_precision(find("henon-heiles"), None, 5.0, [RK4()], steps=[0.1])).splitlines()[1])
    t = 0 … 5
    """
    head = ("method", "step", "precision", "energy error", "position error", "evaluations", "CPU", "")
    lines = aligned([head, *map(_work_cells, work.rows)], right={1, 3, 4, 5, 6})
    rule = "─" * max(map(len, lines))
    return "\n".join([work.title, f"t = 0 … {work.span:.6g}", "", lines[0], rule, *lines[1:], rule])


def _work_cells(row: WorkRow) -> tuple[str, ...]:
    knob = f"{row.step:.4g}" if row.step is not None else f"tol {row.tolerance:.1e}"
    name = str(row.method).partition("(")[0] if row.step is None else str(row.method)
    if row.failure:
        return (name, knob, row.precision, "", "", "", "", f"failed: {row.failure}")
    return (
        name,
        knob,
        row.precision,
        f"{row.energy_error:.1e}",
        f"{row.position_error:.1e}",
        f"{row.evaluations:,}",
        duration_in_words(row.cpu_seconds),
        "resonant step" if row.resonant else "",
    )


def answer(choice: Choice) -> str:
    """Return the choice in one line of words."""
    best = choice.chosen
    cost = duration_in_words(best.predicted_cost)
    if not choice.reached:
        if best.predicted_error > MEANINGLESS and choice.observable == "position":
            return "no method can promise it: neighbouring motions part too fast"
        if math.isinf(best.predicted_error):
            return "no method can follow the motion so long"
        return f"no method keeps it; the best reaches {best.predicted_error:.1e} in {cost}: {_named(best)}"
    return f"{_named(best)} in {best.precision} precision, error {best.predicted_error:.1e}, {cost}"


def _named(candidate: Candidate) -> str:
    if candidate.step is not None:
        return f"{candidate.method}, step {candidate.step:.4g}"
    return str(candidate.method) if candidate.tolerance is None else f"{_name(candidate)}, {_knob(candidate)}"


def _name(candidate: Candidate) -> str:
    return (
        str(candidate.method).partition("(")[0] if candidate.tolerance is not None else str(candidate.method)
    )


def _knob(candidate: Candidate) -> str:
    if candidate.step is not None:
        return f"{candidate.step:.4g}"
    return "" if candidate.tolerance is None else f"tol {candidate.tolerance:.1e}"


def _cells(candidate: Candidate) -> tuple[str, ...]:
    known = math.isfinite(candidate.predicted_error)
    remark = "" if candidate.keeps else "does not keep it"
    if candidate.resonant:
        remark = "resonant step avoided"
    return (
        _name(candidate),
        str(candidate.method.order) if candidate.tolerance is None else "",
        _knob(candidate),
        candidate.precision,
        f"{candidate.predicted_error:.1e}" if known else "",
        f"{candidate.evaluations:.2g}" if known else "",
        duration_in_words(candidate.predicted_cost) if known else "",
        candidate.note or remark,
    )


def duration_in_words(seconds: float) -> str:
    """Return a duration with a unit that suits it.

    Examples
    --------
    >>> duration_in_words(0.0042), duration_in_words(42.0), duration_in_words(90000.0)
    ('4.2 ms', '42 s', '25 h')
    """
    for unit, size in (("d", 86400.0 * 2), ("h", 7200.0), ("min", 120.0), ("s", 1.0), ("ms", 1e-3)):
        if seconds >= size:
            per = {"d": 86400.0, "h": 3600.0, "min": 60.0, "s": 1.0, "ms": 1e-3}[unit]
            return f"{seconds / per:.2g} {unit}" if seconds / per < 99.5 else f"{seconds / per:.0f} {unit}"
    return f"{seconds * 1e6:.2g} µs"
