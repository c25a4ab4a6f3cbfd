"""Table of a choice: the answer in words, with the candidates it was chosen from."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Protocol

from canon.study.energy_drift.drift_table import aligned

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.study.method_choice.candidate import Candidate

__all__ = ["answer", "choice_table", "duration_in_words"]


MEANINGLESS = 0.1
"""Relative position error from which the position is lost."""


class ChosenAmong(Protocol):
    """What a table needs of a choice, such as :class:`canon.study.method_choice.choose.Choice`."""

    @property
    def title(self) -> str:
        """What was asked about."""
        ...

    @property
    def observable(self) -> str:
        """What is to keep the accuracy."""
        ...

    @property
    def accuracy(self) -> float:
        """The accuracy asked for."""
        ...

    @property
    def span(self) -> float:
        """For how long."""
        ...

    @property
    def unknown(self) -> str:
        """Why it is not known whether the accuracy is kept; empty where it is."""
        ...

    @property
    def chosen(self) -> Candidate:
        """The best candidate."""
        ...

    @property
    def candidates(self) -> Sequence[Candidate]:
        """All of them, the chosen one first."""
        ...


def choice_table(choice: ChosenAmong) -> str:
    """Return a choice as an answer in words, and the table of the candidates.

    Examples
    --------
    >>> from canon import choose
    >>> from canon.scene import find
    >>> print(choice_table(choose(find("henon-heiles"), 1e4, accuracy=1e-3)).splitlines()[0])
    Hénon–Heiles: a star in the meridian plane of a galaxy
    """
    head = ("method", "order", "step", "precision", "error", "evaluations", "CPU", "")
    lines = aligned([head, *map(_cells, choice.candidates)], right={1, 2, 4, 5, 6})
    rule = "─" * max(map(len, lines))
    asked = f"{choice.observable} to {choice.accuracy:.2g} over t = {choice.span:.6g}"
    return "\n".join([choice.title, f"{asked}: {answer(choice)}", "", lines[0], rule, *lines[1:], rule])


def answer(choice: ChosenAmong) -> str:
    """Return the choice in one line of words."""
    best = choice.chosen
    cost = duration_in_words(best.predicted_cost)
    if not best.keeps:
        if best.predicted_error > MEANINGLESS and choice.observable == "position":
            return "no method can promise it: neighbouring motions part too fast"
        if math.isinf(best.predicted_error):
            return "no method can follow the motion so long"
        return f"no method keeps it; the best reaches {best.predicted_error:.1e} in {cost}: {_named(best)}"
    found = f"{_named(best)} in {best.precision} precision, error {best.predicted_error:.1e}, {cost}"
    return f"not known: {choice.unknown}; if it goes on as seen: {found}" if choice.unknown else found


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
