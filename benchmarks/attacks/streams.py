"""Streams and environments: every command with streams closed, full or broken, in surroundings that nobody expects."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from itertools import product
from pathlib import Path

from canon.study.cases.run_study import run_study
from canon.study.cases.study import Study

from .count import Count

CANON = [sys.executable, "-P", "-c", "import sys; from canon.cli import main; sys.exit(main(sys.argv[1:]))"]

SURROUNDINGS: dict[str, str] = {
    "as usual": 'exec "$@"',
    "output full": 'exec "$@" > /dev/full',
    "errors full": 'exec "$@" 2> /dev/full',
    "both full": 'exec "$@" > /dev/full 2> /dev/full',
    "no input": 'exec "$@" <&-',
    "no output": 'exec "$@" >&-',
    "no errors": 'exec "$@" 2>&-',
    "no streams": 'exec "$@" <&- >&- 2>&-',
    "a reader that goes": '"$@" | head -c 1',
    "a reader that never was": '"$@" | true',
    "input without end": 'exec "$@" < /dev/zero',
    "plain C": 'LC_ALL=C LANG=C PYTHONUTF8=0 PYTHONCOERCECLOCALE=0 exec "$@"',
    "ASCII": 'PYTHONIOENCODING=ascii exec "$@"',
    "ASCII, strict, to a full disk": 'PYTHONIOENCODING=ascii:strict exec "$@" > /dev/full',
    "another encoding": 'PYTHONIOENCODING=utf-16 exec "$@"',
    "no surroundings at all": 'exec env -i "$@"',
    "no home": 'env -u HOME HOME=/nowhere XDG_CACHE_HOME=/nowhere MPLCONFIGDIR=/nowhere "$@"',
    "no temporary folder": 'TMPDIR=/nowhere exec "$@"',
    "a strange terminal": 'TERM=nonsense COLUMNS=abc LINES=-1 exec "$@"',
    "no width": 'COLUMNS=0 exec "$@"',
    "a width beyond any": 'COLUMNS=999999999999 exec "$@"',
    "without docstrings": 'PYTHONOPTIMIZE=2 exec "$@"',
    "in the wrong time zone": 'TZ=:nonsense exec "$@"',
    "unbuffered": 'PYTHONUNBUFFERED=1 exec "$@"',
    "a folder that is gone": 'mkdir gone && cd gone && rmdir ../gone && exec "$@"',
    "a folder with modules of others": 'cd "$HOSTILE" && exec "$@"',
    "a start of others": 'PYTHONSTARTUP="$HOSTILE/json.py" PYTHONINSPECT= exec "$@"',
    "few files": 'ulimit -n 40 && exec "$@"',
    "files of no size": 'ulimit -f 0 && exec "$@"',
    "nothing may be read": 'umask 777 && exec "$@"',
    "interrupts are ignored": 'trap "" INT PIPE TERM && exec "$@"',
}
COMMANDS: dict[str, tuple[str, ...]] = {
    "version": ("--version",),
    "help": ("check", "--help"),
    "check": ("check", "{sheet}"),
    "check from a stream": ("check", "-"),
    "check as JSON by two": ("check", "--json", "--jobs", "2", "{sheet}"),
    "scenes": ("scene",),
    "status": ("study", "status", "{results}"),
    "export": ("study", "export", "{results}", "out.csv"),
    "run": ("study", "run", "{study}", "--store", "{new}", "--jobs", "2"),
    "drift": ("drift", "harmonic-oscillator", "--periods", "300", "--method", "verlet"),
}
HOSTILE = "import pathlib; pathlib.Path({marker!r}).write_text('owned')\nraise SystemExit('owned')\n"
SHEET = (
    '[[claim]]\nid = "θ"\nkind = "equality-only"\nlhs = "2*x"\nrhs = "x + x"\nparameters = { x = "real" }\n'
)
FILE = '[[study]]\nsystem = "harmonic-oscillator"\nmethod = ["verlet", "rk4"]\nstep = 0.1\nspan = 60.0\nsamples = 512\n'


def streams(count: int, folder: Path, seed: int = 1) -> Count:
    """Run the commands in the surroundings, ``count`` pairs of them from the one that ``seed`` says."""
    found = Count("streams and surroundings")
    (folder / "sheet.toml").write_text(SHEET, encoding="utf-8")
    (folder / "study.toml").write_text(FILE, encoding="utf-8")
    run_study(
        Study.of(system="kepler", method="verlet", step=0.1, span=60.0, samples=256),
        folder / "results.sqlite",
    )
    hostile = folder / "hostile"
    hostile.mkdir()
    for name in ("json", "sympy", "numpy", "flint", "canon", "sitecustomize", "sqlite3", "tomllib"):
        (hostile / f"{name}.py").write_text(HOSTILE.format(marker=str(folder / "owned")))
    pairs = list(product(SURROUNDINGS, COMMANDS))
    for number in range(count):
        surroundings, name = pairs[(number + (seed - 1) * count) % len(pairs)]
        found.add(_outcome(surroundings, name, folder), f"{name}: {surroundings}")
    return found


def _outcome(surroundings: str, name: str, folder: Path) -> str:
    for old in folder.glob("new*"):
        old.unlink()
    places = {
        key: str(folder / file) for key, file in (("sheet", "sheet.toml"), ("results", "results.sqlite"))
    }
    places |= {"study": str(folder / "study.toml"), "new": str(folder / "new.sqlite")}
    asked = [part.format(**places) for part in COMMANDS[name]]
    outside = {key: value for key, value in os.environ.items() if key != "PYTHONUNBUFFERED"}
    path = str(Path(__file__).parents[2])
    run = [
        *CANON[:-1],
        f"import sys; sys.path.insert(0, {path!r}); from canon.cli import main; sys.exit(main(sys.argv[1:]))",
    ]
    try:
        done = subprocess.run(
            ["/bin/sh", "-c", SURROUNDINGS[surroundings], "sh", *run, *asked],
            capture_output=True,
            timeout=120,
            cwd=folder,
            env={**outside, "HOSTILE": str(folder / "hostile"), "PYTHONPATH": path},
            start_new_session=True,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return "left running"
    if (folder / "owned").exists():
        (folder / "owned").unlink()
        return "code run"
    if b"Traceback" in done.stderr + done.stdout or b"Exception ignored" in done.stderr:
        return "traceback"
    ends = (0, 1, 2, 3, 130, 141, 128 + signal.SIGPIPE, -signal.SIGPIPE)
    return f"status {done.returncode}" if done.returncode in ends else "wrong status"
