"""Extreme cases: what ordinary tools do there, and what canon does. Writes docs/extremes.md.

python benchmarks/extremes.py                        # every row not done yet, then the page
python benchmarks/extremes.py numeric kepler         # rows of a part whose names hold a text, done anew
python benchmarks/extremes.py --fresh                # all of them anew
python benchmarks/extremes.py --page                 # the page from what is there

Every row runs in a process of its own. What is done is kept in out/extremes, so an interrupted run goes on where
it stopped; the page keeps a part as it was until all of its rows are there. Ends with status 1 where canon hung,
crashed or was silently wrong.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
from concurrent.futures import ThreadPoolExecutor, as_completed
from datetime import date
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

sys.path.insert(0, str(Path(__file__).parent.parent))
sys.path.insert(0, str(Path(__file__).parent))

from extremes.page import page, summary
from extremes.running import PARTS, do_pieces, rows_of, run_row

if TYPE_CHECKING:
    from extremes.row import Row

HERE = Path(__file__).parent
KEPT = HERE.parent / "out" / "extremes"
PAGE = HERE.parent / "docs" / "extremes.md"
BAD = {"hang", "crash", "wrong"}


def main(arguments: list[str]) -> int:
    if arguments[:1] == ["--pieces"]:
        part, name, first, into = arguments[1:]
        do_pieces(part, name, int(first), Path(into))
        return 0
    said = parsed(arguments)
    parts = {part: rows_of(part) for part in ([said.part] if said.part else PARTS)}
    kept = kept_rows()
    if not said.page:
        anew = said.fresh or bool(said.text)
        wanted = [(part, row) for part, rows in parts.items() for row in rows if said.text in row.name]
        run_all([(part, row) for part, row in wanted if anew or key(part, row) not in kept], said.jobs)
        kept = kept_rows()
    done = {
        part: [(row, kept[key(part, row)]) for row in rows_of(part) if key(part, row) in kept]
        for part in PARTS
    }
    whole = {part: found if len(found) == len(rows_of(part)) else [] for part, found in done.items()}
    tools = ", ".join(f"{name} {version(name)}" for name in ("sympy", "numpy", "scipy", "heyoka", "llvmlite"))
    where = f"{date.today()}, {platform.machine()}, Python {platform.python_version()}, {tools}"
    earlier = PAGE.read_text(encoding="utf-8") if PAGE.exists() else ""
    PAGE.write_bytes(page(whole, where, earlier).encode("utf-8", "backslashreplace"))
    for part in PARTS:
        print(f"{part}: {summary(done[part])}")
    return int(any(pieces[0]["kind"] in BAD for found in done.values() for _, pieces in found))


def parsed(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("part", nargs="?", choices=PARTS)
    parser.add_argument("text", nargs="?", default="", help="only rows whose names hold this")
    parser.add_argument("--fresh", action="store_true", help="do rows anew that are done")
    parser.add_argument("--page", action="store_true", help="run nothing")
    parser.add_argument("--jobs", type=int, default=2, help="rows at once")
    return parser.parse_args(arguments)


def key(part: str, row: Row) -> str:
    return f"{part}/{row.name}"


def run_all(wanted: list[tuple[str, Row]], jobs: int) -> None:
    with ThreadPoolExecutor(jobs) as pool:
        futures = {pool.submit(run_row, part, row): key(part, row) for part, row in wanted}
        for count, future in enumerate(as_completed(futures), 1):
            name, pieces = futures[future], future.result()
            keep(name, pieces)
            for piece in pieces:
                error, estimate = (
                    f"{piece[k]:.1e}" if piece[k] is not None else "–" for k in ("error", "estimate")
                )
                print(
                    f"{count}/{len(futures)} {name} {piece['tool']}: {piece['kind']}, error {error}, "
                    f"stated {estimate}, {piece['seconds']:.1f} s: {piece['said']}",
                    flush=True,
                )


def kept_rows() -> dict[str, Any]:
    """Return what earlier and other runs have done, by part and row."""
    found = {f"{path.parent.name}/{path.stem}": path for path in KEPT.glob("*/*.json")}
    return {name: json.loads(path.read_text()) for name, path in found.items()}


def keep(name: str, pieces: list[dict[str, Any]]) -> None:
    """Write a row into a file of its own, so that several runs at once do not disturb each other."""
    path = KEPT / f"{name}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_suffix(f".{os.getpid()}")
    fresh.write_text(json.dumps(pieces, indent=1))
    fresh.replace(path)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
