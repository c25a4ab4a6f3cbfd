"""``canon choose``: the cheapest method, step and precision for a wanted accuracy over a wanted time."""

from __future__ import annotations

import math
import shlex
import sys
from typing import TYPE_CHECKING

from canon.command.scene_options import add_duration, add_scene, list_scenes, methods_given, scene_given

if TYPE_CHECKING:
    import argparse

    from canon.scene.scene import Scene
    from canon.study.method_choice.candidate import Candidate
    from canon.study.method_choice.choose import Choice

__all__ = ["DESCRIPTION", "EXAMPLES", "add_arguments", "run"]

DESCRIPTION = """\
Find the cheapest method, step and precision that are expected to keep an accuracy over a span of time. Every candidate
runs a few times for a short while; its error is extrapolated by the law it grows by, its cost by the number of steps.
"""
EXAMPLES = """\
reading the table:
  error        the largest one expected over the span
  evaluations  of the force; for Taylor, of the whole series of its order
  CPU          processor time expected of the steps, compilation and keeping samples left out

examples:
  canon choose kepler --accuracy 1e-10 --periods 1e6
  canon choose outer-solar-system --accuracy 1e-4 --span 3.65e8 --observable position
  canon choose kepler --observable "Runge–Lenz vector, x" --accuracy 1e-8 --periods 1e4
  canon choose henon-heiles --accuracy 1e-8 --periods 1e5 --method verlet --method taylor --json

exit status: 0 the accuracy is expected to be kept, 1 nothing keeps it, 2 bad usage
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command reads."""
    add_scene(parser, "a scene by name; 'list' names those to take")
    parser.add_argument(
        "--accuracy", metavar="EPS", type=float, default=1e-8, help="largest relative error allowed (1e-8)"
    )
    add_duration(parser)
    parser.add_argument(
        "--observable", metavar="NAME", default="energy", help="energy, position, or a constant of the scene"
    )
    parser.add_argument(
        "--method",
        metavar="NAME",
        action="append",
        help="consider this one; may be repeated (all that apply)",
    )
    parser.add_argument(
        "--json", action="store_true", help="one JSON object a candidate and line, the choice first"
    )


def run(arguments: argparse.Namespace) -> int:
    """Choose, print the table or lines, return the exit status."""
    from canon.scene import SceneError
    from canon.study.errors import StudyError

    if arguments.scene == "list":
        list_scenes()
        return 0
    try:
        choice = _choice(scene_given(arguments), arguments)
    except (SceneError, StudyError, ValueError) as error:
        print(f"canon choose: {error}", file=sys.stderr)
        return 2
    if arguments.json:
        _print_lines(choice)
    else:
        print(choice)
        if choice.reached and arguments.observable == "energy" and _is_long_enough(choice):
            print(f"\nto run it: {_command(choice, arguments)}")
    return 0 if choice.reached else 1


def _choice(scene: Scene, arguments: argparse.Namespace) -> Choice:
    from canon.progress import ProgressBar
    from canon.study.method_choice.choose import choose

    span = arguments.span if arguments.span is not None else arguments.periods * scene.period
    with ProgressBar() as progress:
        return choose(
            scene,
            span,
            arguments.start,
            accuracy=arguments.accuracy,
            observable=arguments.observable,
            methods=methods_given(arguments),
            progress=lambda _, done: progress("pilot runs", done),
        )


def _is_long_enough(choice: Choice) -> bool:
    """Tell whether a run has the steps from which ``canon drift`` judges how an error grows."""
    from canon.study.energy_drift.drift import FEWEST

    return choice.step is None or choice.span >= FEWEST * choice.step


def _command(choice: Choice, arguments: argparse.Namespace) -> str:
    """Return the command that runs the choice."""
    name = str(choice.method).partition("(")[0].lower()
    if name == "gauss":
        name = f"gauss-{choice.method.order // 2}{'-newton' if 'newton' in str(choice.method) else ''}"
    knob = f"--step {choice.step:.6g}" if choice.step is not None else f"--tolerance {choice.tolerance:.3g}"
    words = ["canon drift", arguments.scene, *(f"--set {each}" for each in arguments.set)]
    words += [f'--start "{arguments.start}"'] if arguments.start else []
    words += [f"--method {shlex.quote(name)}", knob, f"--span {choice.span:.10g}"]
    return " ".join([*words, f"--precision {choice.precision}"])


def _print_lines(choice: Choice) -> None:
    import json

    for candidate in (choice.chosen, *(each for each in choice.candidates if each is not choice.chosen)):
        print(json.dumps(_line(choice, candidate)))


def _line(choice: Choice, candidate: Candidate) -> dict[str, object]:
    return {
        "scene": choice.title,
        "span": choice.span,
        "accuracy": choice.accuracy,
        "observable": choice.observable,
        "chosen": candidate is choice.chosen and choice.reached,
        "method": str(candidate.method),
        "step": candidate.step,
        "tolerance": candidate.tolerance,
        "precision": candidate.precision,
        "predicted_error": _number(candidate.predicted_error),
        "predicted_cpu_seconds": _number(candidate.predicted_cost),
        "predicted_evaluations": _number(candidate.evaluations),
        "keeps": candidate.keeps,
        "resonant": candidate.resonant,
        "note": candidate.note,
    }


def _number(x: float) -> float | None:
    return x if math.isfinite(x) else None
