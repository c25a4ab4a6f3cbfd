"""Study page: one HTML file with its figures inside, which needs no network and no other file."""

from __future__ import annotations

import base64
import io
from datetime import UTC, datetime
from html import escape
from typing import TYPE_CHECKING

from canon.expression.symbols.user_input import counted
from canon.plot.case_labels import error_symbol, labels_of
from canon.plot.energy import plot_block_means, plot_energy_error
from canon.plot.study import plot_study_heatmap
from canon.plot.style import LINES
from canon.plot.work_precision import plot_drift_by_step
from canon.study.cases.result import State

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from matplotlib.axes import Axes

    from canon.study.cases.result import Result

__all__ = ["study_report"]

MOTIONS = 24
"""Motions that have figures of their own; the table has all."""

DRIFTS = 2
"""Fitted drifts shown of a motion: those that stand out most from their standard error."""

FEWEST_STEPS = 3
"""Steps of one method from which the error is drawn against the step."""

POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
h1, h2 { line-height: 1.2; }
h2 { margin-top: 2.5rem; border-top: 1px solid #ddd; padding-top: 1rem; }
img { max-width: 100%; height: auto; display: block; margin: 1rem 0; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 0.85rem; font-variant-numeric: tabular-nums; }
th, td { padding: 0.2rem 0.7rem; text-align: right; white-space: nowrap; }
th { border-bottom: 2px solid #999; }
td { border-bottom: 1px solid #eee; }
th.text, td.text { text-align: left; white-space: normal; }
tr.failed td { background: #fbeae7; }
tr.pending td { color: #767676; }
@media print { body { max-width: none; } h2 { break-before: page; } }
"""

COLUMNS = ("motion", "method", "verdict", "max |{error}|", "drift per unit of time", "exponent", "steps",
           "evaluations", "seconds")  # fmt: skip


def study_report(results: Sequence[Result], title: str, seconds: float | None = None) -> str:
    """Return a page that shows a study: all cases as a picture and a table, and the errors of each motion.

    Parameters
    ----------
    results
        What :func:`canon.study.cases.result.results_of` returned.
    title
        Heading of the page.
    seconds
        Of the page of a study that runs: after how many seconds a browser is to load it anew.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    ValueError
        Where there is no case.

    Examples
    --------
    >>> import tempfile
    >>> from canon import Study, results_of, run_study
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = f"{folder}/study.sqlite"
    ...     _ = run_study(Study.of(system="henon-heiles", method="rk4", step=0.1, span=100.0), file)
    ...     study_report(results_of(file), "Drifts").count("<tr class=")
    1
    """
    heading, again, running = escape(title), [], []
    if seconds is not None:
        now = f"{datetime.now(UTC):%Y-%m-%d %H:%M:%S} UTC"
        again = [f'<meta http-equiv="refresh" content="{max(1, round(seconds))}">']
        running = [f"<p>The study is running. This page is of {now}, and loads itself anew.</p>"]
    return "\n".join(
        [
            "<!DOCTYPE html>",
            '<html lang="en"><head><meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">',
            *again,
            f"<title>{heading}</title><style>{STYLE}</style></head><body>",
            f"<h1>{heading}</h1>",
            *running,
            *_summary(results),
            *_motions(results),
            "<h2>All cases</h2>",
            *_table(results),
            "</body></html>\n",
        ]
    )


def _summary(results: Sequence[Result]) -> Iterator[str]:
    axes = plot_study_heatmap(results)
    yield _figure(axes, f"every case of the study as a cell: {axes.get_title(loc='left')}")
    for versions in dict.fromkeys(tuple(result.versions.items()) for result in results if result.versions):
        count = sum(tuple(result.versions.items()) == versions for result in results)
        named = ", ".join(f"{name} {number}" for name, number in versions)
        yield f"<p>{counted(count, 'case')} computed with {escape(named)}.</p>"
    failed = [result for result in results if result.state is State.FAILED]
    if failed:
        pairs = zip(results, *labels_of(results), strict=True)
        said = {id(result): escape(f"{motion}, {setting}") for result, motion, setting in pairs}
        yield "<h2>What failed, and why</h2><ul>"
        for result in failed:
            yield f"<li>{said[id(result)]}: {escape(result.failure)}</li>"
        yield "</ul>"


def _motions(results: Sequence[Result]) -> Iterator[str]:
    """Yield the figures of each motion that has a finished case."""
    finished: dict[str, list[Result]] = {}
    for result, name in zip(results, labels_of(results)[0], strict=True):
        if result.state is State.FINISHED:
            finished.setdefault(name, []).append(result)
    for name in list(finished)[:MOTIONS]:
        yield f"<h2>{escape(name)}</h2>"
        yield from _figures(finished[name], name)
    if len(finished) > MOTIONS:
        yield f"<p>Figures are shown of the first {MOTIONS} of {len(finished)} motions; the table has all.</p>"


def _figures(results: Sequence[Result], name: str) -> Iterator[str]:
    for first in range(0, len(results), len(LINES)):
        drawn = [result for result in results[first : first + len(LINES)] if result.numbers["curve"]]
        if drawn:
            yield _figure(plot_energy_error(drawn), f"energy error against time: {name}")
    steps: dict[str, int] = {}
    for result in results:
        if result.case.step is not None:
            steps[str(result.case.method)] = steps.get(str(result.case.method), 0) + 1
    if max(steps.values(), default=0) >= FEWEST_STEPS:
        yield _figure(plot_drift_by_step(results), f"energy error against the step: {name}")
        yield _figure(plot_drift_by_step(results, what="slope"), f"drift against the step: {name}")
    secular = [result for result in results if result.numbers["verdict"] == "secular"]
    for result in sorted(secular, key=_significance, reverse=True)[:DRIFTS]:
        yield f"<h3>{escape(result.setting)}</h3>"
        means = plot_block_means(result, label=error_symbol([result]))
        yield _figure(means, f"fitted drift of {result.setting}")


def _significance(result: Result) -> float:
    return abs(result.numbers["slope"]) / max(result.numbers["slope_error"], 1e-300)


def _table(results: Sequence[Result]) -> Iterator[str]:
    yield '<div class="scroll"><table><thead><tr>'
    heads = [escape(name.format(error=error_symbol(results))) for name in COLUMNS]
    yield "".join(f"<th{_text(i)}>{name}</th>" for i, name in enumerate(heads))
    yield "</tr></thead><tbody>"
    for result, *names in zip(results, *labels_of(results), strict=True):
        row = (*names, *_cells(result))
        cells = "".join(f"<td{_text(i)}>{escape(cell)}</td>" for i, cell in enumerate(row))
        yield f'<tr class="{result.state.value}">{cells}</tr>'
    yield "</tbody></table></div>"


def _cells(result: Result) -> Sequence[str]:
    seconds = "" if result.seconds is None else f"{result.seconds:.3g}"
    if result.state is not State.FINISHED:
        told = f"{100 * result.done:.0f} % done" if result.state is State.PENDING else result.failure
        return (f"{result.state.value}: {told}", "", "", "", "", "", seconds)
    numbers = result.numbers
    low, high = numbers["exponent_interval"]
    return (
        numbers["verdict"],
        f"{numbers['bound']:.2e}",
        f"{numbers['slope']:.1e} ± {numbers['slope_error']:.0e}",
        f"{numbers['exponent']:.2f} ({low:.2f} … {high:.2f})",
        f"{numbers['steps']}",
        f"{numbers['evaluations']}",
        seconds,
    )


def _text(column: int) -> str:
    return ' class="text"' if column < 3 else ""


def _figure(axes: Axes, about: str) -> str:
    """Return the figure of Axes as an image inside the page; what it shows is said in words as well."""
    figure, written = axes.get_figure(root=True), io.BytesIO()
    if figure is None:
        raise ValueError("the Axes belong to no figure; make them with plt.subplots()")
    figure.savefig(written, format="svg", bbox_inches="tight", metadata={"Date": None})
    data = base64.b64encode(written.getvalue()).decode("ascii")
    return f'<img alt="{escape(about, quote=True)}" src="data:image/svg+xml;base64,{data}">'
