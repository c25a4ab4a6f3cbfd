"""The command line: ``canon check``, ``choose``, ``completion``, ``drift``, ``scene``, ``study``, ``tour``.

Every command is a module of :mod:`canon.command` with ``DESCRIPTION``, ``EXAMPLES``, ``add_arguments(parser)``
and ``run(arguments) -> exit status``; only the one that is asked for is imported.
"""

from __future__ import annotations

import argparse
import importlib
import io
import os
import sys
from typing import TYPE_CHECKING

from canon.command import COMMANDS

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["COMMANDS", "main"]

EXAMPLES = """\
examples:
  canon tour                                        see what canon does
  canon check answers.toml                          judge a sheet of answers
  canon check --help                                how a sheet is written
  canon scene double-pendulum                       equations of a ready system
  canon drift kepler --plot drift.png               which methods can be trusted for long
  canon choose kepler --accuracy 1e-9               the cheapest one that suffices
"""
BROKEN_PIPE = 141
"""Exit status of a program whose reader went away, as shells report it: 128 + SIGPIPE."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status.

    Parameters
    ----------
    argv
        The arguments after ``canon``; those of the process unless given.
    """
    given = list(sys.argv[1:] if argv is None else argv)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without ✓ shows ?
    if not given:
        _parser(given).print_help(sys.stderr)
        return 2
    if (word := given[0]) not in COMMANDS and not word.startswith("-"):
        print(f"canon: there is no command {word!r}{_near(word)}; 'canon --help' lists all", file=sys.stderr)
        return 2
    arguments = _parser(given).parse_args(given)
    try:
        status = arguments.run(arguments)
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except KeyboardInterrupt:
        print("canon: interrupted", file=sys.stderr)
        return 130
    return status


def _near(word: str) -> str:
    import difflib

    close = difflib.get_close_matches(word, COMMANDS, n=1)
    return f" (did you mean {close[0]}?)" if close else ""


def _parser(given: list[str]) -> argparse.ArgumentParser:
    from canon import __version__

    parser = argparse.ArgumentParser(
        prog="canon",
        description="Is this piece of Hamiltonian mechanics right, does its simulation stay right, and what does that "
        "accuracy cost?",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"canon {__version__}")
    commands = parser.add_subparsers(metavar="command", required=True)
    asked = next((word for word in given if not word.startswith("-")), "")
    for name, line in COMMANDS.items():
        sub = commands.add_parser(name, help=line, formatter_class=argparse.RawDescriptionHelpFormatter)
        if name == asked:
            module = importlib.import_module(f"canon.command.{name}")
            sub.description, sub.epilog = module.DESCRIPTION, module.EXAMPLES
            module.add_arguments(sub)
            sub.set_defaults(run=module.run)
    return parser


if __name__ == "__main__":
    sys.exit(main())
