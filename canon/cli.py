"""The command line: ``canon check``, ``choose``, ``completion``, ``drift``, ``scene``, ``serve``, ``study``, ``tour``.

Every command is a module of :mod:`canon.command` with ``DESCRIPTION``, ``EXAMPLES``, ``add_arguments(parser)``
and ``run(arguments) -> exit status``; only the one that is asked for is imported.
"""

from __future__ import annotations

import argparse
import importlib
import os
import signal
import sys
from contextlib import suppress
from typing import TYPE_CHECKING

from canon.command import COMMANDS
from canon.command.exit_status import BROKEN_PIPE, INTERRUPTED, UNWRITTEN
from canon.command.standard_streams import silenced, streams_open, why_not_written
from canon.printable import in_one_line

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

_THREADS_OF_MATRICES = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Matrices are small here: more threads would only wait for each other."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status.

    Parameters
    ----------
    argv
        The arguments after ``canon``; those of the process unless given.
    """
    given = list(sys.argv[1:] if argv is None else argv)
    for variable in _THREADS_OF_MATRICES:
        os.environ.setdefault(variable, "1")
    try:
        streams_open()
        status = _status(given)
        sys.stdout.flush()
    except BrokenPipeError:
        status = BROKEN_PIPE
    except KeyboardInterrupt:
        with suppress(ValueError):  # where this is not the main thread
            signal.signal(signal.SIGINT, signal.SIG_IGN)  # a second one has nothing left to stop
        _tell("canon: interrupted")
        status = INTERRUPTED
    except OSError as error:
        if not (why := why_not_written(error)):
            raise
        _tell(f"canon: standard output can't be written: {why}")
        status = UNWRITTEN
    silenced()
    return status


def _tell(line: str) -> None:
    with suppress(OSError):  # where standard error takes no more either
        print(line, file=sys.stderr)


def _status(given: list[str]) -> int:
    if not given:
        _parser(given).print_help(sys.stderr)
        return 2
    if (word := given[0]) not in COMMANDS and not word.startswith("-"):
        print(
            in_one_line(f"canon: there is no command {word!r}{_near(word)}; 'canon --help' lists all"),
            file=sys.stderr,
        )
        return 2
    try:
        arguments = _parser(given).parse_args(given)
    except SystemExit:
        sys.stdout.flush()
        raise
    return arguments.run(arguments)


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
