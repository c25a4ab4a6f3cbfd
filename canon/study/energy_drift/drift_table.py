"""Table of a drift study: aligned columns, plain words."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING, Protocol

from canon.flow.method.engine import HEYOKA
from canon.study.energy_drift.drift import Growth
from canon.study.motion.observables import ENERGY

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.study.energy_drift.drift import Drift
    from canon.study.energy_drift.drift_rows import DriftRow

__all__ = ["aligned", "drift_table", "error_name"]

WORDS = {
    Growth.BOUNDED: "bounded",
    Growth.ROUND_OFF: "round-off",
    Growth.WANDERING: "wandering",
    Growth.SECULAR: "secular",
    Growth.DIVERGED: "diverged",
    Growth.UNDECIDED: "undecided",
}

MEANING = {
    Growth.BOUNDED: "no growth found; a drift as large as the one named would be found in 95 % of cases",
    Growth.ROUND_OFF: "wanders as a random walk does, in proportion to √t: accumulated rounding",
    Growth.WANDERING: "wanders as a random walk does, and rounding is not known to explain it",
    Growth.SECULAR: "grows steadily with time",
    Growth.DIVERGED: "the error has blown up",
    Growth.UNDECIDED: "a slow oscillation or modulation, or a drift that a longer run would show",
}


class StudiedRows(Protocol):
    """What a table needs of a drift study, such as :class:`canon.study.energy_drift.drift_study.DriftStudy`."""

    @property
    def title(self) -> str:
        """What was run."""
        ...

    @property
    def span(self) -> float:
        """Duration of the runs."""
        ...

    @property
    def period(self) -> float | None:
        """Period that rates are given by."""
        ...

    @property
    def time_unit(self) -> str:
        """Unit of time."""
        ...

    @property
    def rows(self) -> tuple[DriftRow, ...]:
        """One a method and observable."""
        ...

    @property
    def observables(self) -> tuple[str, ...]:
        """What was followed."""
        ...


def drift_table(study: StudiedRows) -> str:
    """Return a drift study as a table with a title, and below it what its words mean.

    Rates are per period where the study knows one. The drift is followed by its standard error, the growth
    exponent by its 95 % confidence interval, and the verdict "bounded" by the detection limit.

    Examples
    --------
    >>> from canon import RK4, Splitting
    >>> from canon.scene import find
    >>> from canon.study.energy_drift.drift_study import drift_study
    >>> study = drift_study(find("henon-heiles"), methods=[Splitting("verlet"), RK4()], periods=200)
    >>> print(drift_table(study).splitlines()[0])
    Hénon–Heiles: a star in the meridian plane of a galaxy; energy 1/12, on an invariant curve
    """
    rate = "period" if study.period is not None else study.time_unit or "unit of time"
    name = error_name(study)
    head = ("method", "order", "step", f"max |{name}|", f"drift per {rate}", "grows as t^", "verdict")
    cost = ("evaluations", "CPU")
    body = [(*_cells(study, row), *_cost(row)) for row in study.rows]
    lines = aligned([(*head, *cost), *body], right={1, 2, 3, 7, 8})
    if study.observables != (ENERGY,):
        column = aligned([("observable",), *((row.observable,) for row in study.rows)], right=set())
        width = max(map(len, column))
        lines = [f"{name:{width}}  {line}" for name, line in zip(column, lines, strict=True)]
    rule = "─" * max(map(len, lines))
    verdicts = dict.fromkeys(row.drift.verdict for row in study.rows if row.drift is not None)
    notes = [f"{WORDS[verdict]}: {MEANING[verdict]}" for verdict in verdicts]
    notes.extend(
        dict.fromkeys(f"{row.method} failed: {row.failure}" for row in study.rows if row.drift is None)
    )
    if any(row.method.engine is HEYOKA and row.drift for row in study.rows):
        notes.append("evaluations: of the force; for Taylor, of the whole series of its order")
    return "\n".join([study.title, _run(study), "", lines[0], rule, *lines[1:], rule, *notes])


def error_name(study: StudiedRows) -> str:
    """Return ΔE/E, or ΔE where the energy at the start is zero; ΔI where other quantities are followed."""
    letter = "E" if study.observables == (ENERGY,) else "I"
    return f"Δ{letter}/{letter}" if all(row.relative for row in study.rows) else f"Δ{letter}"


def _run(study: StudiedRows) -> str:
    unit = f" {study.time_unit}" if study.time_unit else ""
    lasting = f"t = 0 … {study.span:.6g}{unit}"
    if study.period is None:
        return lasting
    return f"{lasting}, {study.span / study.period:.6g} periods of {study.period:.4g}{unit}"


def _cells(study: StudiedRows, row: DriftRow) -> tuple[str, ...]:
    step = "adaptive" if row.step is None else f"{row.step:.4g}"
    found = row.drift
    if found is None:
        return str(row.method), str(row.method.order), step, "", "", "", "failed"
    unit = study.period or 1.0
    low, high = found.exponent_interval
    return (
        str(row.method),
        str(row.method.order),
        step,
        f"{found.bound:.1e}",
        with_error(found.slope * unit, found.slope_error * unit),
        "" if found.verdict is Growth.DIVERGED else f"{found.exponent:.2f} ({low:.2f} to {high:.2f})",
        _verdict(found, unit) if not row.orbits else _verdicts(row.orbits),
    )


def _verdict(found: Drift, unit: float) -> str:
    if found.verdict is Growth.BOUNDED:
        return f"bounded (drift < {found.detection_limit * unit:.0e})"
    if found.verdict is Growth.ROUND_OFF:
        return f"round-off ({found.walk:.0e} in all)"
    if found.verdict is Growth.WANDERING:
        return f"wandering ({found.walk:.0e} in all)"
    return WORDS[found.verdict]


def _verdicts(orbits: Sequence[Drift]) -> str:
    """Return how many orbits have which verdict; the other columns show the worst of them."""
    count = Counter(found.verdict for found in orbits)
    return "orbits: " + ", ".join(f"{count[growth]} {WORDS[growth]}" for growth in Growth if count[growth])


def _cost(row: DriftRow) -> tuple[str, str]:
    return ("", "") if row.drift is None else (f"{row.evaluations:,}", f"{row.cpu_seconds:.3f} s")


def with_error(value: float, error: float) -> str:
    """Return a value and its error with one power of ten, the error to two digits.

    Examples
    --------
    >>> with_error(-8.391e-07, 6.8e-10)
    '(-8.3910 ± 0.0068)e-07'
    >>> with_error(8e-20, 1.3e-18)
    '(0.1 ± 1.3)e-18'
    """
    largest = max(abs(value), error)
    if largest == 0.0 or not math.isfinite(largest):
        return f"{value:g} ± {error:g}"
    power = math.floor(math.log10(largest))
    scale = 10.0**power
    places = 1 if error == 0.0 else max(0, 1 - math.floor(math.log10(error / scale)))
    places = min(places, 6)
    return f"({value / scale:.{places}f} ± {error / scale:.{places}f})e{power:+03d}"


def aligned(rows: Sequence[tuple[str, ...]], right: set[int]) -> list[str]:
    """Return the rows with columns of equal width."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines: list[str] = []
    for row in rows:
        cells = [
            cell.rjust(width) if i in right else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append("  ".join(cells).rstrip())
    return lines
