"""``canon scene``: list the ready systems; show one, run it, check what is known of it, draw it."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from canon.command.scene_options import add_scene, scene_given

if TYPE_CHECKING:
    import argparse

    from canon.scene.describe import Section
    from canon.scene.scene import Scene
    from canon.scene.scene_motion import SceneMotion

__all__ = ["DESCRIPTION", "EXAMPLES", "add_arguments", "run"]

DESCRIPTION = """\
Ready mechanical systems. Without a name: list them. With a name: its parameters, equations of motion, Hamiltonian,
Routhian and constants of the motion; with --run also a motion, held against everything known of it.
"""
EXAMPLES = """\
examples:
  canon scene                                       all scenes
  canon scene spherical-pendulum                    its equations as text
  canon scene spherical-pendulum --latex            the same in LaTeX
  canon scene kepler --start e=0.9 --run            integrate, check every known integral and closed form
  canon scene double-pendulum --plot sketch.png     a sketch with the way the masses take
  canon scene spring-pendulum --animate it.gif      an animation (.mp4 where ffmpeg is installed)

exit status: 0 done and all checks passed, 1 a check failed, 2 bad usage
"""
_LONG = 1200
"""Formulas longer than so many characters are not shown unless asked for."""

_MANY = 8


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command reads."""
    add_scene(parser, "a scene by name; all are listed without it", needed=False)
    parser.add_argument("--latex", action="store_true", help="formulas in LaTeX")
    parser.add_argument("--all", action="store_true", help="show long formulas too")
    parser.add_argument(
        "--run",
        dest="integrate",
        action="store_true",
        help="integrate, check every known integral and closed form",
    )
    parser.add_argument(
        "--periods",
        metavar="N",
        type=float,
        help="duration in periods; 100 of --run, a few of --plot and --animate",
    )
    parser.add_argument("--plot", metavar="FILE", help="write a sketch (.png, .pdf, .svg)")
    parser.add_argument("--animate", metavar="FILE", help="write an animation (.gif, .mp4)")
    parser.add_argument(
        "--seconds", metavar="S", type=float, default=6.0, help="how long the animation is (6)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Show, run and draw what was asked for; return the exit status."""
    from canon.scene import SceneError

    if arguments.scene in (None, "list"):
        _list()
        return 0
    try:
        scene = scene_given(arguments)
        scene.start(arguments.start)
        if not (arguments.integrate or arguments.plot or arguments.animate):
            _show(scene, arguments)
        status = _check(scene, arguments) if arguments.integrate else 0
        if arguments.plot or arguments.animate:
            _draw(scene, arguments)
    except BrokenPipeError:
        raise  # the reader went away; canon.cli says so by its exit status
    except (SceneError, ValueError, ArithmeticError, OSError, ImportError) as error:
        print(f"canon scene: {error}", file=sys.stderr)
        return 2
    return status


def _list() -> None:
    from canon.scene import SCENES

    width = max(len(scene.name) for scene in SCENES)
    for scene in SCENES:
        print(f"{scene.name:{width}}  {scene.title}")


def _show(scene: Scene, arguments: argparse.Namespace) -> None:
    from canon.scene.describe import description

    print(f"{scene.title}\n")
    print(f"  coordinates: {', '.join(scene.coordinates.split())}")
    for c in scene.parameters:
        print(f"  {c.name} = {f'{c.value:g} {c.unit}'.strip()}: {c.meaning}")
    for start in scene.starts:
        print(f"  start {start.name!r}: {start.about}")
    print(f"  source: {scene.source}")
    for section in description(scene):
        _print_section(section, arguments)
    if scene.solutions:
        print("\nKnown motions (--run holds them against the equations)")
        for solution in scene.solutions:
            where = f"; known where {solution.condition.about}" if solution.condition else ""
            print(f"  {solution.name} (start {solution.start!r}{where})")


def _print_section(section: Section, arguments: argparse.Namespace) -> None:
    print(f"\n{section.title}")
    shown = section.formulas if arguments.all else section.formulas[:_MANY]
    for formula in shown:
        text = formula.latex if arguments.latex else str(formula)
        if len(text) > _LONG and not arguments.all:
            about = f"{formula.about}: " if formula.about else ""
            text = f"{about}{text[:60]}… ({len(text)} characters; --all shows them)"
        print(f"  {text}")
    if len(section.formulas) > len(shown):
        print(f"  … {len(section.formulas) - len(shown)} more; --all shows them")
    if section.remark:
        print(f"  {section.remark}")


def _check(scene: Scene, arguments: argparse.Namespace) -> int:
    from canon.scene.known_truths import check, conserved

    passed = True
    for each in check(scene, arguments.start, arguments.periods):
        print(f"{'✓' if each.passed else '✗'} {each}")
        passed &= each.passed
    for integral in scene.integrals:
        verdict = conserved(scene, integral)
        print(
            f"{'✓' if verdict.holds else '✗'} {integral.name}: conserved by the equations: {verdict.status.name}"
        )
        passed &= not verdict.fails
    return 0 if passed else 1


def _draw(scene: Scene, arguments: argparse.Namespace) -> None:
    from canon.plot.scene import animate_scene, plot_scene
    from canon.scene.scene_motion import run as motion_of

    periods = min(arguments.periods or scene.shown, scene.horizon)
    motion: SceneMotion = motion_of(
        scene, arguments.start, periods, samples=max(400, min(4000, round(200 * periods)))
    )
    if arguments.plot:
        figure = plot_scene(motion).get_figure(root=True)
        if figure is not None:
            figure.savefig(arguments.plot, dpi=150)
        print(f"picture: {arguments.plot}")
    if arguments.animate:
        animate_scene(motion, arguments.animate, seconds=arguments.seconds)
        print(f"animation: {arguments.animate}")
