"""Rows in processes of their own, killed at their limits, so that nothing hangs or takes the others down."""

from __future__ import annotations

import contextlib
import importlib
import json
import math
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

from extremes.row import Outcome, shown

if TYPE_CHECKING:
    from extremes.row import Row

__all__ = ["PARTS", "do_pieces", "rows_of", "run_row"]

PARTS = ("numeric", "symbolic", "system")
"""Modules of this package with a function ``rows()``."""

_SCRIPT = Path(__file__).parent.parent / "extremes.py"
_START_UP = 60.0
"""Seconds that a process may take to import what it needs on a busy machine, on top of the first limit."""


def rows_of(part: str) -> list[Row]:
    """Return a part's rows, none where its module is not there."""
    try:
        module = importlib.import_module(f"extremes.{part}")
    except ModuleNotFoundError as missing:
        if missing.name != f"extremes.{part}":
            raise
        return []
    rows = list(module.rows())
    names = [row.name for row in rows]
    if len(set(names)) < len(names):
        raise ValueError(f"{part}: {', '.join(sorted(n for n in names if names.count(n) > 1))} named twice")
    return rows


def do_pieces(part: str, name: str, first: int, into: Path) -> None:
    """Do a row's pieces from ``first`` on in this process and write a line of JSON after each."""
    (row,) = (row for row in rows_of(part) if row.name == name)
    if row.memory is not None:
        limit = int(row.memory * 2**30)
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    with into.open("a", encoding="utf-8") as out:
        out.write("{}\n")
        out.flush()
        for tool, run in row.pieces[first:]:
            wall, cpu = time.monotonic(), time.process_time()
            try:
                found = run().plain()
            except Exception as error:  # noqa: BLE001, the row's own judgement failed: that is what is to be recorded
                where = traceback.extract_tb(error.__traceback__)[-1]
                said = f"{type(error).__name__}: {error} ({Path(where.filename).name}:{where.lineno})"
                found = Outcome(shown(said)).plain() | {"kind": "crash"}
            spent = {"seconds": time.monotonic() - wall, "cpu_seconds": time.process_time() - cpu}
            out.write(json.dumps({"tool": tool} | found | spent, default=float) + "\n")
            out.flush()


def run_row(part: str, row: Row) -> list[dict[str, Any]]:
    """Return what became of each of a row's pieces; of a row without its ordinary tools, of canon's alone."""
    done = list[dict[str, Any]]()
    tools = [tool for tool, _ in row.pieces]
    while len(done) < len(tools):
        done += _until_trouble(part, row, len(done))
    return done


def _until_trouble(part: str, row: Row, first: int) -> list[dict[str, Any]]:
    """Run pieces in one process until all are done, one hangs or the process ends."""
    tools = [tool for tool, _ in row.pieces]
    wanted = len(tools) - first
    with tempfile.TemporaryDirectory() as folder:
        into, noise = Path(folder, "pieces"), Path(folder, "noise")
        into.touch()
        command = [sys.executable, str(_SCRIPT), "--pieces", part, row.name, str(first), str(into)]
        with noise.open("w") as out:
            process = subprocess.Popen(
                command, stdout=out, stderr=out, stdin=subprocess.DEVNULL, start_new_session=True
            )
        seen, deadline, hung = 0, time.monotonic() + _START_UP, False
        while process.poll() is None:
            lines = into.read_text(encoding="utf-8").count("\n")
            if lines > wanted:  # and one line of greeting
                break
            if lines > seen:
                seen, deadline = lines, time.monotonic() + row.limit
            if time.monotonic() > deadline:
                hung = True
                break
            time.sleep(0.05)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        found = [json.loads(line) for line in into.read_text(encoding="utf-8").splitlines()][1:][:wanted]
        if len(found) == wanted:
            return found
        last = noise.read_text(encoding="utf-8", errors="replace").strip().splitlines()[-1:]
    said = (
        f"killed after {row.limit:g} s"
        if hung
        else f"the process ended with status {process.returncode}: {last}"
    )
    lost = Outcome(shown(said)).plain() | {"kind": "hang" if hung else "crash"}
    spent = {"seconds": row.limit if hung else math.nan, "cpu_seconds": math.nan}
    return [*found, {"tool": tools[first + len(found)]} | lost | spent]
