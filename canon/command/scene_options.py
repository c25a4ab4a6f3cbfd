"""The motion a command is about: a scene, its parameters and start, how long, with which methods."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

    from canon.flow.method.method import Method
    from canon.scene.scene import Scene

__all__ = [
    "add_duration",
    "add_scene",
    "list_scenes",
    "methods_given",
    "scene_given",
    "setting",
]


def add_scene(parser: argparse.ArgumentParser, about: str, *, needed: bool = True) -> None:
    """Declare the scene, changes of its parameters, and the start."""
    parser.add_argument("scene", metavar="SCENE", nargs=None if needed else "?", help=about)
    parser.add_argument("--set", metavar="NAME=VALUE", action="append", default=[], help="change a parameter")
    parser.add_argument("--start", metavar="NAME", help="the initial state, by its name in the scene")


def add_duration(parser: argparse.ArgumentParser) -> None:
    """Declare how long: in periods or in units of time."""
    length = parser.add_mutually_exclusive_group()
    length.add_argument(
        "--periods", metavar="N", type=float, default=1000.0, help="duration in periods (1000)"
    )
    length.add_argument("--span", metavar="T", type=float, help="duration in units of time")


def scene_given(arguments: argparse.Namespace) -> Scene:
    """Return the scene that was named, with the parameters that were changed.

    Raises
    ------
    SceneError, ValueError
        Where there is no such scene or parameter, or a value is no number.
    """
    from canon.scene import find

    return find(arguments.scene).with_parameters(**dict(map(setting, arguments.set)))


def methods_given(arguments: argparse.Namespace) -> Sequence[Method] | None:
    """Return the methods that were named; none of them means those that the command takes by itself."""
    from canon.flow.method.method_text import method_named

    return [method_named(name) for name in arguments.method] if arguments.method else None


def setting(text: str) -> tuple[str, float]:
    """Return name and value of ``NAME=VALUE``.

    Raises
    ------
    ValueError
        Where the text is no name, =, and finite number.

    Examples
    --------
    >>> setting("l=2")
    ('l', 2.0)
    """
    name, equals, value = text.partition("=")
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not (name.strip() and equals and math.isfinite(number)):
        raise ValueError(f"--set {text}: write a parameter's name, =, and a number, as in --set l=2")
    return name.strip(), number


def list_scenes() -> None:
    """Print every scene with its starts and parameters, those that a Hamiltonian describes first."""
    from canon.scene import SCENES

    width = max(len(scene.name) for scene in SCENES)
    for free in (True, False):
        if not free:
            print(
                "\nwith constraints or forces without potential, judged by the energy less the work of the forces:\n"
            )
        for scene in (scene for scene in SCENES if scene.is_free == free):
            print(f"{scene.name:{width}}  {scene.title}")
            print(f"{'':{width}}  starts: {', '.join(start.name for start in scene.starts)}")
            if scene.parameters:
                constants = (f"{c.name} = {c.value:g} {c.unit}".strip() for c in scene.parameters)
                print(f"{'':{width}}  parameters: {', '.join(constants)}")
