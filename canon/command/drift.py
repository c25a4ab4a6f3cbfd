"""``canon drift``: run a scene long and judge how the errors of each method grow."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from canon.command.scene_options import add_duration, add_scene, list_scenes, methods_given, scene_given

if TYPE_CHECKING:
    import argparse

    from canon.scene.scene import Scene
    from canon.study.energy_drift.drift_study import DriftRow, DriftStudy

__all__ = ["DESCRIPTION", "EXAMPLES", "add_arguments", "run", "save_figure"]

DESCRIPTION = """\
Integrate a scene with several methods and tell how the error of its energy, or of whatever else should stay constant,
grows with each one: bounded, as round-off does (t^1/2), or secularly. Long runs show their progress; the states
between the samples are not kept.
"""
EXAMPLES = """\
methods: kahan-li-8, verlet, blanes-moan-4, … (symplectic splittings, for H = T(p) + V(q)), gauss-1 … gauss-8
and semiexplicit-2 … semiexplicit-8 (symplectic, for every H), taylor (heyoka's, adaptive), rk4, dop853 (not symplectic)

observables: energy, momenta (of ignorable coordinates), integrals (all known constants of the scene), symplecticity
(the bilinear covariant of two variations carried along by the method), or one of them by its name

reading the table:
  max |ΔE/E|   the largest energy error met
  drift        its mean growth per period, with standard error
  exponent     power of time it grows with: 0 bounded, 0.5 round-off, 1 secular
  verdict      "bounded" means: no growth found above the detection limit

examples:
  canon drift henon-heiles
  canon drift kepler --method kahan-li-8 --method rk4 --step 0.02 --periods 10000
  canon drift simple-pendulum --set l=2 --start small --plot pendulum.png
  canon drift henon-heiles --method taylor --tolerance 1e-10 --json
  canon drift kepler --observable energy --observable "angular momentum" --method verlet --method rk4
  canon drift henon-heiles --orbits 64 --method kahan-li-8 --precision double

exit status: 0 every run finished, 1 a run failed, 2 bad usage
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command reads."""
    add_scene(parser, "a scene by name; 'list' names those to take")
    parser.add_argument(
        "--method", metavar="NAME", action="append", help="may be repeated; the usual four unless given"
    )
    parser.add_argument(
        "--step", metavar="H", type=float, help="of the fixed-step methods; a fiftieth of the period"
    )
    parser.add_argument("--tolerance", metavar="EPS", type=float, help="of the adaptive methods")
    add_duration(parser)
    precisions = ["single", "double", "compensated", "extended", "double-double", "quad"]
    parser.add_argument(
        "--precision",
        choices=precisions,
        help="arithmetic: fixed steps have all but quad (compensated unless given), Taylor double, extended and quad",
    )
    parser.add_argument(
        "--observable", metavar="NAME", action="append", help="what to follow; may be repeated (energy)"
    )
    parser.add_argument(
        "--orbits", metavar="N", type=int, default=1, help="run so many orbits that start near one another"
    )
    parser.add_argument("--seed", metavar="N", type=int, default=0, help="of the starts of those orbits (0)")
    parser.add_argument("--samples", metavar="N", type=int, help="states kept of each run")
    parser.add_argument(
        "--json", action="store_true", help="one JSON object a method and line instead of a table"
    )
    parser.add_argument(
        "--plot", metavar="FILE", help="write a figure of the error over time (.png, .pdf, .svg)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Run the study, print its table or lines, return the exit status."""
    from canon.scene import SceneError
    from canon.study.energy_drift.drift_study import StudyError

    if arguments.scene == "list":
        list_scenes()
        return 0
    try:
        study = _study(scene_given(arguments), arguments)
    except (SceneError, StudyError, ValueError) as error:
        print(f"canon drift: {error}", file=sys.stderr)
        return 2
    if arguments.json:
        _print_lines(study)
    else:
        from canon.study.energy_drift.drift_table import drift_table

        print(drift_table(study))
    if arguments.plot and not save_figure(study, arguments.plot):
        return 2
    return 1 if any(row.failure for row in study.rows) else 0


def save_figure(study: DriftStudy, file: str) -> bool:
    """Write the errors of a study as a figure, a panel an observable; say so, or why not."""
    from canon.plot import PlotError, plot_errors

    try:
        figure = plot_errors(study)[0].get_figure(root=True)
        if figure is not None:
            figure.savefig(file, dpi=150)
    except (PlotError, OSError, ValueError) as error:
        print(f"canon: no figure was written: {error}", file=sys.stderr)
        return False
    print(f"figure: {file}")
    return True


def _study(scene: Scene, arguments: argparse.Namespace) -> DriftStudy:
    from canon.progress import ProgressBar
    from canon.study.energy_drift.drift_study import drift_study

    with ProgressBar() as progress:
        return drift_study(
            scene,
            arguments.start,
            methods=methods_given(arguments),
            step=arguments.step,
            tolerance=arguments.tolerance,
            periods=arguments.periods,
            span=arguments.span,
            precision=arguments.precision,
            samples=arguments.samples,
            observables=arguments.observable or ("energy",),
            orbits=arguments.orbits,
            seed=arguments.seed,
            progress=progress,
        )


def _print_lines(study: DriftStudy) -> None:
    import json

    for row in study.rows:
        print(json.dumps({"study": study.title, "span": study.span, "period": study.period, **_line(row)}))


def _line(row: DriftRow) -> dict[str, object]:
    line: dict[str, object] = {
        "method": str(row.method),
        "observable": row.observable,
        "order": row.method.order,
        "step": row.step,
        "steps": row.steps,
        "evaluations": row.evaluations,
        "cpu_seconds": row.cpu_seconds,
        "compile_seconds": row.compile_seconds,
        "precision": row.precision,
    }
    if row.drift is None:
        return {**line, "verdict": "failed", "reason": row.failure}
    found = row.drift
    return {
        **line,
        "relative": row.relative,
        "bound": found.bound,
        "slope": found.slope,
        "slope_error": found.slope_error,
        "detection_limit": found.detection_limit,
        "exponent": found.exponent,
        "exponent_interval": list(found.exponent_interval),
        "verdict": found.verdict.value,
        "reason": found.reason,
        **({"orbits": [each.verdict.value for each in row.orbits]} if row.orbits else {}),
    }
