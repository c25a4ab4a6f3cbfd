"""``canon completion``: what the shell offers when the tab key is pressed after ``canon``."""

from __future__ import annotations

import argparse
import importlib
from typing import TYPE_CHECKING

from canon.command import COMMANDS
from canon.command.shells import SHELLS, Option, Place

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["DESCRIPTION", "EXAMPLES", "add_arguments", "places", "run"]

DESCRIPTION = """\
Print a script that completes commands, options, scenes, methods and files on the tab key. It is written from the
commands themselves and runs without starting Python; print it anew after an upgrade.
"""
EXAMPLES = """\
examples:
  canon completion bash > ~/.local/share/bash-completion/completions/canon
  canon completion zsh > ~/.zfunc/_canon            with  fpath+=~/.zfunc  before compinit in ~/.zshrc
  canon completion fish > ~/.config/fish/completions/canon.fish
  source <(canon completion bash)                   in this shell only
"""
FILES = {"FILE", "IMAGE", "OTHER", "OUTPUT", "SHEET", "STUDY.toml"}
"""Names that values have in the help and that stand for files."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command reads."""
    parser.add_argument("shell", choices=list(SHELLS), help="the shell that the script is for")


def run(arguments: argparse.Namespace) -> int:
    """Print the script."""
    print(SHELLS[arguments.shell](list(places())), end="")
    return 0


def places() -> Iterator[Place]:
    """Yield every place in a command line where something can be completed: ``canon``, ``canon study``, …

    Examples
    --------
    >>> {place.words: place.following for place in places()}["canon", "study"]
    {'run': 'run the cases of a study file that are not finished', ...}
    """
    yield Place(
        ("canon",),
        COMMANDS,
        (
            Option(("-h", "--help"), "show this help message and exit"),
            Option(("--version",), "show the version"),
        ),
    )
    for name in COMMANDS:
        parser = _Parser()
        importlib.import_module(f"canon.command.{name}").add_arguments(parser)
        yield from _places_of(parser, ("canon", name))


class _Parser(argparse.ArgumentParser):
    """A parser that tells what it has been told to read."""

    @property
    def arguments(self) -> list[argparse.Action]:
        return list(self._actions)


def _places_of(parser: _Parser, words: tuple[str, ...]) -> Iterator[Place]:
    following: dict[str, str] = {}
    options: list[Option] = []
    files = False
    for argument in parser.arguments:
        if argument.option_strings:
            options.append(_option(argument))
        elif argument.dest == "action":
            actions: dict[str, _Parser] = dict(argument.choices or {})
            following |= {name: sub.description or "" for name, sub in actions.items()}
            for name, sub in actions.items():
                yield from _places_of(sub, (*words, name))
        else:
            following |= dict.fromkeys(_words_of(argument), "")
            files |= argument.metavar in FILES
    yield Place(words, following, tuple(options), files)


def _option(argument: argparse.Action) -> Option:
    return Option(
        tuple(argument.option_strings),
        argument.help or "",
        takes_value=argument.nargs != 0,
        values=tuple(_words_of(argument)),
        files=argument.metavar in FILES,
    )


def _words_of(argument: argparse.Action) -> list[str]:
    """Return the words that a value can be, where they are known."""
    from canon.kernel.schemes.splitting_schemes import SCHEMES
    from canon.scene import names

    if argument.choices:
        return list(argument.choices)
    if argument.dest == "scene":
        return [*names(), "list"]
    if argument.dest == "method":
        return [*SCHEMES, *(f"gauss-{stages}" for stages in range(1, 9)), "rk4", "taylor", "dop853"]
    return []
