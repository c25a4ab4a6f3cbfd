"""Attacks on canon, counted: what was told, what was harmless, and whether anything went wrong unsaid.

python benchmarks/robustness.py                    # every sort, as many as the documentation says
python benchmarks/robustness.py bits 100           # one sort, so many of it

Ends with status 1 where an attack gave a traceback, other numbers, a false line, or left a process.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).parent.parent))
sys.path.insert(0, str(Path(__file__).parent))

from attacks.bits import flipped_bits, flipped_kept_bits
from attacks.service import served_load
from attacks.studies import hostile_studies

if TYPE_CHECKING:
    from collections.abc import Callable

    from attacks.count import Count

SORTS: dict[str, tuple[Callable[[int, Path], Count], int]] = {
    "bits": (flipped_bits, 1200),
    "kept": (flipped_kept_bits, 400),
    "studies": (hostile_studies, 2000),
    "serve": (served_load, 10_000),
}


def main(arguments: list[str]) -> int:
    name, number = (*arguments, "", "")[:2]
    if name and name not in SORTS:
        sys.exit(f"no attack is called {name}; there are {', '.join(SORTS)}")
    bad = 0
    for sort, (attack, usual) in SORTS.items():
        if sort == name or not name:
            with tempfile.TemporaryDirectory() as folder:
                found = attack(int(number or usual), Path(folder))
            print(found, flush=True)
            bad += found.bad
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
