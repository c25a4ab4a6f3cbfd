"""``canon completion``: what the shell offers when the tab key is pressed after ``canon``."""

from __future__ import annotations

import argparse
import importlib

import shtab

from canon.command import COMMANDS

__all__ = ["DESCRIPTION", "EXAMPLES", "add_arguments", "run", "whole_parser"]

DESCRIPTION = """\
Print a script that completes commands, options, scenes, methods and files on the tab key. shtab writes it from the
commands themselves; it runs without starting Python. Print it anew after an upgrade.
"""
EXAMPLES = """\
examples:
  canon completion bash > ~/.local/share/bash-completion/completions/canon
  canon completion zsh > ~/.zfunc/_canon            with  fpath+=~/.zfunc  before compinit in ~/.zshrc
  canon completion fish > ~/.config/fish/completions/canon.fish
  canon completion tcsh > ~/.canon.csh              with  source ~/.canon.csh  in ~/.tcshrc
  canon completion powershell >> $PROFILE
  source <(canon completion bash)                   in this shell only
"""
FILES = {"FILE", "IMAGE", "OTHER", "OUTPUT", "SHEET", "STUDY.toml"}
"""Names that values have in the help and that stand for files."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command reads."""
    parser.add_argument("shell", choices=shtab.SUPPORTED_SHELLS, help="the shell that the script is for")


def run(arguments: argparse.Namespace) -> int:
    """Print the script."""
    print(shtab.complete(whole_parser(), arguments.shell))
    return 0


def whole_parser() -> argparse.ArgumentParser:
    """Return a parser of every command, which knows the scenes, the methods, and where files are meant.

    Examples
    --------
    >>> whole_parser().parse_args(["drift", "kepler", "--method", "verlet"]).method
    ['verlet']
    """
    parser = _Parser(prog="canon")
    parser.add_argument("--version", action="version", help="show the version")
    commands = parser.add_subparsers(metavar="command")
    for name, line in COMMANDS.items():
        command = commands.add_parser(name, help=line)
        importlib.import_module(f"canon.command.{name}").add_arguments(command)
        command.tell_values()
    return parser


class _Parser(argparse.ArgumentParser):
    """A parser whose arguments are told which values they can have."""

    def tell_values(self) -> None:
        for argument in self._actions:
            if argument.dest == "action":
                for action in dict[str, _Parser](argument.choices or {}).values():
                    action.tell_values()
            elif argument.metavar in FILES:
                vars(argument)["complete"] = shtab.FILE
            elif argument.dest in {"scene", "method"}:
                argument.choices = _scenes() if argument.dest == "scene" else _methods()


def _scenes() -> list[str]:
    from canon.scene import names

    return [*names(), "list"]


def _methods() -> list[str]:
    from canon.kernel.schemes.splitting_schemes import SCHEMES

    return [
        *SCHEMES,
        *(f"gauss-{stages}" for stages in range(1, 9)),
        *(f"semiexplicit-{order}" for order in (2, 4, 6, 8)),
        "rk4",
        "taylor",
        "dop853",
    ]
