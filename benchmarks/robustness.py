"""Attacks on canon, counted: what was told, what was harmless, and whether anything went wrong unsaid.

python benchmarks/robustness.py                    # every sort, as many as the documentation says
python benchmarks/robustness.py bits               # one sort, as many
python benchmarks/robustness.py bits 100           # one sort, so many of it; nothing is recorded

Attacks go in pieces, each with a seed of its own. A piece that has ended is recorded in
benchmarks/results/robustness.json for the commit of what it attacks: after an interrupt the same command goes on with
the next piece. What was recorded on another commit is done anew. Prints the table of docs/measured.md, and ends
with status 1 where an attack gave a traceback, other numbers, a false line or verdict, or left a process.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

sys.path.insert(0, str(Path(__file__).parent.parent))
sys.path.insert(0, str(Path(__file__).parent))

from attacks.bits import flipped_bits, flipped_kept_bits
from attacks.claims import hostile_claims
from attacks.count import Count
from attacks.kills import kills
from attacks.requests import hostile_requests
from attacks.service import served_load
from attacks.stores import hostile_stores
from attacks.streams import streams
from attacks.studies import hostile_studies
from days import in_words

if TYPE_CHECKING:
    from collections.abc import Callable

    Attack = Callable[[int, Path, int], Count]

HERE = Path(__file__).parent
RECORD = HERE / "results" / "robustness.json"

SORTS: dict[str, tuple[Attack, int, int]] = {
    "bits": (flipped_bits, 1200, 100),
    "kept": (flipped_kept_bits, 400, 100),
    "stores": (hostile_stores, 300, 100),
    "studies": (hostile_studies, 2000, 200),
    "claims": (hostile_claims, 21_000, 1000),
    "kills": (kills, 200, 20),
    "streams": (streams, 310, 31),
    "requests": (hostile_requests, 1000, 500),
    "serve": (served_load, 10_000, 10_000),
}
"""Each sort with its attack, how many there are, and how many of them are a piece."""
OF_THE_SERVICE = ("requests", "serve")
"""Sorts that ask `canon serve`; the others do not touch it."""


def main(arguments: list[str]) -> int:
    name, number = (*arguments, "", "")[:2]
    if name and name not in SORTS:
        sys.exit(f"no attack is called {name}; there are {', '.join(SORTS)}")
    bad = 0
    for sort in [name] if name else SORTS:
        found = _attacked(sort, int(number), 1) if number else _in_pieces(sort)
        print(found, flush=True)
        bad += found.bad
    if not number:
        print(_measured([name] if name else [*SORTS]))
    return 1 if bad else 0


def _attacked(sort: str, count: int, seed: int) -> Count:
    with tempfile.TemporaryDirectory() as folder:
        return SORTS[sort][0](count, Path(folder), seed)


def _in_pieces(sort: str) -> Count:
    """Do the pieces of a sort that are not recorded yet, and return the sum of all."""
    _, usual, piece = SORTS[sort]
    done = _recorded(sort)
    for seed in range(1, -(-usual // piece) + 1):
        if str(seed) not in done:
            done[str(seed)] = _attacked(sort, piece, seed).to_dict()
            _record(sort, done)
            print(f"{sort}: piece {seed} of {-(-usual // piece)}", file=sys.stderr, flush=True)
    found = [Count.from_dict(each) for each in done.values()]
    total = Count(found[0].sort, sum((each.outcomes for each in found), Counter[str]()))
    for each in found:
        total.first = {**each.first, **total.first}
        total.figures += each.figures if len(found) == 1 else []
    return total


def _recorded(sort: str) -> dict[str, dict[str, Any]]:
    written = json.loads(RECORD.read_text("utf-8")) if RECORD.exists() else {}
    found = written.get(sort, {})
    return found["pieces"] if found.get("commit") == _commit(sort) else {}


def _record(sort: str, pieces: dict[str, dict[str, Any]]) -> None:
    written = json.loads(RECORD.read_text("utf-8")) if RECORD.exists() else {}
    written[sort] = {"commit": _commit(sort), "pieces": pieces}
    beside = RECORD.with_suffix(".new")
    beside.write_text(json.dumps(written, indent=1, ensure_ascii=True) + "\n", "utf-8")
    beside.replace(RECORD)


def _measured(sorts: list[str]) -> str:
    """Return when the recorded pieces of these sorts were done, and on which commits."""
    written = json.loads(RECORD.read_text("utf-8"))
    days = in_words(piece["day"] for sort in sorts for piece in written[sort]["pieces"].values())
    commits = " and ".join(sorted({written[sort]["commit"] for sort in sorts}))
    return f"measured on {days}, canon at commit {commits}"


def _commit(sort: str) -> str:
    """Return the commit of the last change of the attacks or of what they meet in canon."""
    passed_over = [] if sort in OF_THE_SERVICE else [":!canon/serve"]
    asked = ["git", "log", "-1", "--format=%h", "--", "canon", "benchmarks/attacks", *passed_over]
    return subprocess.run(asked, capture_output=True, text=True, cwd=HERE.parent, check=False).stdout.strip()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
