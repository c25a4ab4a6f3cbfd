"""``canon serve``: judge claims over HTTP, and a page where people type them."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from canon.command.argument_types import seconds, whole_number

if TYPE_CHECKING:
    import argparse

__all__ = ["DESCRIPTION", "EXAMPLES", "add_arguments", "run"]

DESCRIPTION = """\
Answer claims with verdicts over HTTP, as 'canon check --json' does, and show a page where people type them and see
how they are read. Only this machine can ask unless --host says otherwise. Every claim has a budget of time in a
process that can be killed; every client has a rate. Ctrl-C, or SIGTERM, ends it when the answers in hand have been
given.
"""
EXAMPLES = """\
paths:
  GET /               a page for people
  POST /check         a claim, or a sheet {"claims": [...]}, as JSON; its verdicts
  POST /read          {"text": "...", "q": ["theta"]}: how it is read, as MathML and in plain spelling
  GET /health         its processes, and how many claims wait
  GET /openapi.json   the same for programs; GET /api shows it

examples:
  canon serve                                    then open http://127.0.0.1:8000
  canon serve --workers 4 --budget 3
  canon serve --host 0.0.0.0 --name canon.example --proxy 10.0.0.2
  curl -H 'Content-Type: application/json' --data @sheet.json http://127.0.0.1:8000/check

needs: pip install 'canon-mechanics[serve]'
exit status: 0 ended by a signal, 2 bad usage, or nothing can listen there
"""
MISSING = "canon serve: it needs Starlette and uvicorn: pip install 'canon-mechanics[serve]'"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command reads."""
    parser.add_argument(
        "--host", metavar="ADDRESS", default="127.0.0.1", help="listen here (127.0.0.1: this machine only)"
    )
    parser.add_argument("--port", metavar="N", type=_port, default=8000, help="listen on this port (8000)")
    parser.add_argument(
        "--name",
        metavar="NAME",
        action="append",
        default=[],
        help="answer to this name in a Host header; may be repeated (any, unless on loopback)",
    )
    parser.add_argument(
        "--proxy", metavar="ADDRESS", default="", help="believe this reverse proxy who a client is"
    )
    parser.add_argument(
        "--workers", metavar="N", type=whole_number(256), default=2, help="processes that judge (2)"
    )
    parser.add_argument(
        "--budget", metavar="S", type=seconds(most=3600), default=5.0, help="seconds for each claim (5)"
    )
    parser.add_argument(
        "--rate",
        metavar="N",
        type=whole_number(10**6),
        default=60,
        help="claims a minute for each client (60)",
    )
    parser.add_argument(
        "--claims", metavar="N", type=whole_number(10_000), default=100, help="claims of one request (100)"
    )
    parser.add_argument(
        "--waiting", metavar="N", type=whole_number(10**6), default=200, help="claims that wait at most (200)"
    )
    parser.add_argument(
        "--body",
        metavar="BYTES",
        type=whole_number(10**7),
        default=262_144,
        help="bytes of one request (262144)",
    )


def _port(text: str) -> int:
    return 0 if text == "0" else whole_number(65_535)(text)


def run(arguments: argparse.Namespace) -> int:
    """Answer requests until a signal ends the service."""
    try:
        from canon.serve.http_server import serve
    except ModuleNotFoundError as missing:
        if (missing.name or "").partition(".")[0] not in ("starlette", "uvicorn"):
            raise
        print(MISSING, file=sys.stderr)
        return 2
    from canon.serve.service_limits import Limits

    try:
        limits = Limits(
            workers=arguments.workers,
            budget=arguments.budget,
            body=arguments.body,
            claims=arguments.claims,
            waiting=arguments.waiting,
            rate=arguments.rate,
            burst=max(arguments.rate, 1),
        )
        serve(arguments.host, arguments.port, limits, names=arguments.name, proxy=arguments.proxy)
    except (OSError, ValueError) as error:
        print(f"canon serve: {error}", file=sys.stderr)
        return 2
    return 0
