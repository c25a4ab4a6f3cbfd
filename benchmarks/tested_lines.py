"""How much of each room its tests run: lines and branches, those of processes that tests start included.

python benchmarks/tested_lines.py                    # the quick tests, in an order drawn at random
python benchmarks/tested_lines.py -m slow            # what the slow ones run beside them: both are counted
python benchmarks/tested_lines.py --report           # nothing is run: the table of what was
python benchmarks/tested_lines.py --report study     # and the branches of a folder that are not taken
python benchmarks/tested_lines.py --kept             # the table that was kept for docs/measured.md

What was run is counted until ``.coverage_data`` is removed, of a module until it changes, and the table is kept in
``results/tested_lines.txt``. Why no test takes a branch is said in ``untaken_branches.toml``, under its module and the
line that asks. Other arguments go to pytest. It takes ``pip install coverage pytest-random-order``. Processes that are
killed tell nothing of what they ran. Tests with a bound of processor time may fail where each line takes longer than
it does alone. Under Python 3.11 a thread may fail to begin: two that begin at once can't both be traced
(python/cpython#98257).
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import random
import subprocess
import sys
import tomllib
from collections import Counter, defaultdict
from datetime import date
from pathlib import Path
from typing import NamedTuple

from coverage import Coverage, CoverageData
from coverage.results import Numbers

HERE = Path(__file__).resolve().parents[1]
DATA = HERE / ".coverage_data" / "run"
RULES = HERE / "benchmarks" / "tested_lines.toml"
KEPT = HERE / "benchmarks" / "results" / "tested_lines.txt"
ASKED = DATA.parent / "asked"
MODULES = DATA.parent / "modules.json"
REASONS = HERE / "benchmarks" / "untaken_branches.toml"
LEAST = 85
HEAD = "room           lines  not run  branches  not taken  argued  branches taken     both"


def run(arguments: list[str]) -> int:
    """Run tests, add what they run to what is known, and return what pytest returns."""
    DATA.parent.mkdir(exist_ok=True)
    forget_changed_modules()
    with ASKED.open("a", encoding="utf-8") as asked:
        print("pytest", *arguments, f"at commit {_commit()}", file=asked)
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


def forget_changed_modules() -> None:
    """Take what is known of a module away if it is not the one that was run: its lines have other numbers."""
    now = {str(path): _digest(path) for path in (HERE / "canon").rglob("*.py")}
    if DATA.exists() and MODULES.exists():
        known = CoverageData(str(DATA))
        known.read()
        then = json.loads(MODULES.read_text(encoding="utf-8"))
        known.purge_files(sorted(path for path, digest in then.items() if now.get(path) != digest))
        known.write()
        known.close()
    MODULES.write_text(json.dumps(now, indent=0), encoding="utf-8")


class Tested(NamedTuple):
    """What is known of a module: its numbers, and the branches that no test takes, by the line that asks."""

    name: str
    numbers: Numbers
    untaken: list[tuple[int, str, int]]

    @property
    def room(self) -> str:
        return self.name.split("/")[0] if "/" in self.name else "canon"


def tested_modules() -> list[Tested]:
    forget_changed_modules()
    known = Coverage(data_file=str(DATA), config_file=str(RULES))
    known.load()
    modules = list[Tested]()
    for path in sorted((HERE / "canon").rglob("*.py")):
        found = known._analyze(str(path))  # noqa: SLF001, the public analysis2 has no branches
        lines = path.read_text(encoding="utf-8").splitlines()
        untaken = [
            (start, lines[start - 1].strip(), end)
            for start, ends in sorted(found.missing_branch_arcs().items())
            for end in ends
        ]
        modules.append(Tested(path.relative_to(HERE / "canon").as_posix(), found.numbers, untaken))
    return modules


def report(shown: str) -> None:
    """Print and keep lines and branches by room, and the modules that fall short; print what a folder lacks."""
    modules, reasons = tested_modules(), tomllib.loads(REASONS.read_text(encoding="utf-8"))
    rooms: defaultdict[str, Numbers] = defaultdict(Numbers)
    argued = Counter[str]()
    for module in modules:
        rooms[module.room] += module.numbers
        argued[module.room] += sum(asks in reasons.get(module.name, {}) for _, asks, _ in module.untaken)
    rooms["all"], argued["all"] = sum(rooms.values(), Numbers()), argued.total()
    table = [
        f"{date.today()}, Python {platform.python_version()}, canon at commit {_commit()}",
        *(ASKED.read_text(encoding="utf-8").splitlines() if ASKED.exists() else []),
        HEAD,
    ]
    for room, numbers in sorted(rooms.items(), key=lambda item: (item[0] == "all", item[0])):
        taken = 100 * numbers.n_executed_branches / numbers.n_branches
        table.append(
            f"{room:12}{numbers.n_statements:8}{numbers.n_missing:9}{numbers.n_branches:10}"
            f"{numbers.n_missing_branches:11}{argued[room]:8}{taken:14.1f} %{numbers.pc_covered:7.1f} %"
        )
    short = sorted((each.numbers.pc_covered, each.name) for each in modules if each.numbers.pc_covered < 95)
    table += ["", f"{len(short)} modules below 95 %, of which below {LEAST} %:"]
    table += [f"{share:5.1f} %  {name}" for share, name in short if share < LEAST]
    print(*table, sep="\n")
    KEPT.write_text("\n".join(table) + "\n", encoding="utf-8")
    print(*(f"{share:5.1f} %  {name}" for share, name in short if share >= LEAST), sep="\n")
    for module in modules if shown else []:
        if module.name.startswith(shown):
            for start, asks, end in module.untaken:
                why = reasons.get(module.name, {}).get(asks, "")
                print(f"{module.name}:{start}: {asks} → {end if end > 0 else 'the end'}  {why}")


def _digest(module: Path) -> str:
    return hashlib.sha256(module.read_bytes()).hexdigest()


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
