"""``canon tour``: what canon does, on answers and a motion that everyone can check."""

from __future__ import annotations

import sys
import textwrap
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import argparse

    from canon.exercise.report.judgement import Judgement
    from canon.study.energy_drift.drift_study import DriftStudy

__all__ = ["DESCRIPTION", "EXAMPLES", "add_arguments", "run"]

DESCRIPTION = """\
Judge a bundled sheet of answers from lecture notes, some of them wrong, and say where each wrong one is wrong;
then run the Hénon–Heiles system with symplectic methods, a non-symplectic one and heyoka's Taylor method, and tell
which of them can be trusted for long. Takes less than half a minute.
"""
EXAMPLES = """\
examples:
  canon tour
  canon tour --plot energy.pdf
  canon tour --no-plot
"""

PERIODS = 2000.0
STEPS_PER_PERIOD = 40


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command reads."""
    parser.add_argument(
        "--plot", metavar="FILE", default="canon-tour.png", help="where the figure goes (canon-tour.png)"
    )
    parser.add_argument("--no-plot", action="store_true", help="write no figure")


def run(arguments: argparse.Namespace) -> int:
    """Judge, run, measure; return 0 where every verdict is the one the sheet expects."""
    right = _judge_answers()
    print()
    study = _study()
    _show_study(study)
    if not arguments.no_plot:
        from canon.command.drift import save_figure

        save_figure(study, arguments.plot)
    return 0 if right else 1


def _judge_answers() -> bool:
    from canon.exercise.judging_process import Worker
    from canon.exercise.report.report import Report
    from canon.exercise.sheet.sheet import bundled_sheet

    sheet = bundled_sheet("tour")
    print(f"1. Is it right?  {sheet.title}\n")
    judgements: list[Judgement] = []
    with Worker() as worker:
        for claim in sheet.claims:
            judgements.append(worker.judge(claim))
            print(*judgements[-1].lines(), sep="\n", flush=True)
    report = Report(sheet.title, tuple(judgements))
    print(report.summary)
    for judgement in report.unexpected:
        print(f"canon tour: {judgement.id}: {judgement.status}, expected {judgement.expect}", file=sys.stderr)
    return not report.unexpected


def _study() -> DriftStudy:
    from canon.flow.method.method import RK4, Splitting, Taylor
    from canon.progress import ProgressBar
    from canon.scene import find
    from canon.study.energy_drift.drift_study import drift_study

    scene = find("henon-heiles")
    print("2. Does its simulation stay right, and what does that cost?\n", flush=True)
    methods = (Splitting("kahan-li-8"), Splitting("verlet"), RK4(), Taylor())
    step = scene.period / STEPS_PER_PERIOD
    with ProgressBar() as progress:
        return drift_study(scene, methods=methods, step=step, periods=PERIODS, progress=progress)


def _show_study(study: DriftStudy) -> None:
    from canon.study.energy_drift.drift import Growth
    from canon.study.energy_drift.drift_table import drift_table

    print(drift_table(study))
    print()
    for row in study.rows:
        if row.drift is not None and row.drift.verdict is not Growth.BOUNDED:
            told = f"{row.method}: {row.drift.verdict.value}; {row.drift.reason}."
            print(textwrap.fill(told, 100, subsequent_indent="  "))
    print()
