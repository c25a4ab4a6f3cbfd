"""How much of each room its tests run: lines and branches, those of processes that tests start included.

python benchmarks/tested_lines.py                    # the quick tests, in an order drawn at random
python benchmarks/tested_lines.py -m slow            # what the slow ones run beside them: both are counted
python benchmarks/tested_lines.py --report           # nothing is run: the table of what was
python benchmarks/tested_lines.py --report study     # and the lines of a folder that are not run
python benchmarks/tested_lines.py --kept             # the table that was kept for docs/measured.md

What was run is counted until ``.coverage_data`` is removed, and the table is kept in ``results/tested_lines.txt``.
Other arguments go to pytest. It takes ``pip install coverage pytest-random-order``. Processes that are killed tell
nothing of what they ran. Tests with a bound of processor time may fail where each line takes longer than it does alone.
Under Python 3.11 a thread may fail to begin: two that begin at once can't both be traced (python/cpython#98257).
"""

from __future__ import annotations

import os
import platform
import random
import subprocess
import sys
from collections import defaultdict
from datetime import date
from pathlib import Path

from coverage import Coverage
from coverage.results import Numbers

HERE = Path(__file__).resolve().parents[1]
DATA = HERE / ".coverage_data" / "run"
RULES = HERE / "benchmarks" / "tested_lines.toml"
KEPT = HERE / "benchmarks" / "results" / "tested_lines.txt"
ASKED = DATA.parent / "asked"
LEAST = 85


def run(arguments: list[str]) -> int:
    """Run tests, add what they run to what is known, and return what pytest returns."""
    DATA.parent.mkdir(exist_ok=True)
    with ASKED.open("a", encoding="utf-8") as asked:
        print("pytest", *arguments, file=asked)
    order = ["--random-order-bucket=global", f"--random-order-seed={random.randrange(10**6)}"]
    print("pytest", *order, *arguments, file=sys.stderr)
    done = subprocess.run(
        [sys.executable, "-m", "coverage", "run", "--rcfile", str(RULES),
         "-m", "pytest", "-q", "-n", "2", "-p", "no:cacheprovider", *order, *arguments],
        cwd=HERE, env={**os.environ, "COVERAGE_FILE": str(DATA)}, stdout=sys.stderr, check=False,
    )  # fmt: skip
    known = Coverage(data_file=str(DATA), config_file=str(RULES))
    known.load()  # or what earlier runs have found would be lost
    known.combine([str(DATA.parent)], keep=False)
    known.save()
    return done.returncode


def report(shown: str) -> None:
    """Print and keep lines and branches by room, and the modules that fall short; print what of a folder is not run."""
    known = Coverage(data_file=str(DATA), config_file=str(RULES))
    known.load()
    rooms: defaultdict[str, Numbers] = defaultdict(Numbers)
    short, missing = list[tuple[float, str]](), list[str]()
    for path in sorted((HERE / "canon").rglob("*.py")):
        found = known._analyze(str(path))  # noqa: SLF001, the public analysis2 has no branches
        name = path.relative_to(HERE / "canon")
        room = name.parts[0] if len(name.parts) > 1 else "canon"
        rooms[room] += found.numbers
        if found.numbers.pc_covered < 95:
            short.append((found.numbers.pc_covered, name.as_posix()))
        if shown and name.as_posix().startswith(shown):
            missing.append(f"{name.as_posix()}: {found.missing_formatted(branches=True)}")
    asked = ASKED.read_text(encoding="utf-8").splitlines() if ASKED.exists() else []
    table = [
        f"{date.today()}, Python {platform.python_version()}, canon at commit {_commit()}",
        *asked,
        f"{'room':12}{'lines':>8}{'not run':>9}{'branches':>10}{'not taken':>11}{'branches taken':>16}{'both':>9}",
    ]
    for room, numbers in [*sorted(rooms.items()), ("all", sum(rooms.values(), Numbers()))]:
        taken = 100 * numbers.n_executed_branches / numbers.n_branches
        table.append(
            f"{room:12}{numbers.n_statements:8}{numbers.n_missing:9}{numbers.n_branches:10}"
            f"{numbers.n_missing_branches:11}{taken:14.1f} %{numbers.pc_covered:7.1f} %"
        )
    table += ["", f"{len(short)} modules below 95 %, of which below {LEAST} %:"]
    table += [f"{share:5.1f} %  {name}" for share, name in sorted(short) if share < LEAST]
    print(*table, sep="\n")
    KEPT.write_text("\n".join(table) + "\n", encoding="utf-8")
    print(*(f"{share:5.1f} %  {name}" for share, name in sorted(short) if share >= LEAST), *missing, sep="\n")


def _commit() -> str:
    asked = ["git", "rev-parse", "--short", "HEAD"]
    return subprocess.run(asked, cwd=HERE, capture_output=True, text=True, check=False).stdout.strip()


if __name__ == "__main__":
    given = sys.argv[1:]
    if "--kept" in given:
        print(KEPT.read_text(encoding="utf-8"), end="")
        sys.exit(0)
    failed = 0 if "--report" in given else run(given)
    report(given[-1] if given[:1] == ["--report"] and len(given) > 1 else "")
    sys.exit(failed)
