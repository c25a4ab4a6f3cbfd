"""Flipped bits in results files and in what is kept: status, export, resume and mend of each, beside the undamaged."""

from __future__ import annotations

import csv
import random
from typing import TYPE_CHECKING

from canon import RK4, Gauss, Splitting, Taylor
from canon.study.cases.checkpointed_run import advance
from canon.study.cases.result import results_of
from canon.study.cases.run_study import run_study
from canon.study.cases.store import Store
from canon.study.cases.study import Study
from canon.study.kept.chunk_file import ChunkFolder, DamagedChunk

from .count import Count, command

if TYPE_CHECKING:
    from pathlib import Path

    Kept = dict[tuple[str, str, str], bytes]

STUDY = Study.of(
    system=["henon-heiles", "kepler"],
    method=[Splitting("verlet"), RK4(), Gauss(2), Taylor()],
    step=0.01,
    span=20.0,
    samples=512,
    parts=4,
)
KEEPING = Study.of(
    system="henon-heiles",
    method=["verlet", "rk4"],
    step=0.1,
    span=30.0,
    samples=256,
    keep=["motion", {"section": "x"}],
)
BEGUN = 3
"""Cases that have a checkpoint and no record."""

MOVING = ("seconds", "done")
"""Columns that are no numbers of the motion."""


def flipped_bits(count: int, folder: Path, seed: int = 1) -> Count:
    """Flip one bit, or now and then several, in copies of a results file, and use each copy."""
    found, draw = Count("flipped bits in results files"), random.Random(seed)
    path, whole, expected = _made(folder)
    for number in range(count):
        damaged, places = bytearray(whole), []
        for _ in range(1 if number % 4 else draw.randint(2, 8)):
            places.append((draw.randrange(len(damaged)), draw.randrange(8)))
            damaged[places[-1][0]] ^= 1 << places[-1][1]
        for old in folder.glob("study.sqlite*"):
            old.unlink()
        path.write_bytes(damaged)
        found.add(_outcome(path, expected), f"seed {seed}, attack {number}: {places}")
    return found


def flipped_kept_bits(count: int, folder: Path, seed: int = 1) -> Count:
    """Flip one bit, or now and then several, in a file of what is kept of a case, cut it or lose it, and read all."""
    found, draw = Count("flipped bits in what is kept"), random.Random(seed)
    path = folder / "kept.sqlite"
    run_study(KEEPING, path)
    rows, files = path.read_bytes(), {file: file.read_bytes() for file in ChunkFolder(path).files()}
    expected = _all_kept(path)
    for number in range(count):
        path.write_bytes(rows)
        for file, content in files.items():
            file.write_bytes(content)
        file = draw.choice(list(files))
        damaged = bytearray(files[file])
        if number % 50 == 0:
            del damaged[draw.randrange(len(damaged)) :]
        for _ in range(1 if number % 4 else draw.randint(2, 8)):
            if damaged:
                damaged[draw.randrange(len(damaged))] ^= 1 << draw.randrange(8)
        file.write_bytes(damaged)
        found.add(
            _outcome_of_kept(path, expected, changed=bytes(damaged) != files[file]),
            f"seed {seed}, attack {number}",
        )
    return found


def _outcome_of_kept(path: Path, expected: Kept, *, changed: bool) -> str:
    """Return what came of a damaged file of what is kept: told by all that reads it, and computed again."""
    try:
        unsaid = _all_kept(path)
    except DamagedChunk:
        unsaid = None
    if unsaid is not None:
        return "other numbers" if unsaid != expected or changed else "unharmed"
    for action in (("status", path), ("export", path, path.with_suffix(".nc"), "--kept", "motion")):
        status, _, err = command("study", *action)
        if status != 2 or not err.startswith("canon study: "):
            return "traceback" if status is None else "other numbers"
    command("study", "mend", path)
    command("study", "resume", path)
    return "told and mended" if _all_kept(path) == expected else "other numbers"


def _all_kept(path: Path) -> Kept:
    return {
        (result.key, name, each): array.tobytes()
        for result in results_of(path)
        for name in result.kept
        for each, array in result.kept[name].items()
    }


def _made(folder: Path) -> tuple[Path, bytes, dict[str, dict[str, str]]]:
    path = folder / "study.sqlite"
    run_study(STUDY, path)
    expected = _exported(path)
    assert expected is not None
    store = Store(path)
    keys = list(store.cases())[-BEGUN:]
    store.forget(keys)
    for key, case in zip(keys, STUDY.cases[-BEGUN:], strict=True):
        point = advance(case, seconds=0.0)
        store.save_checkpoint(key, point.part, point.to_text())
    return path, path.read_bytes(), expected


def _outcome(path: Path, expected: dict[str, dict[str, str]]) -> str:
    """Return what came of a file: told and mended, or used with the same numbers."""
    status, said, err = command("study", "status", path)
    if status is None:
        return "traceback"
    if status == 2:
        return _after_mending(path, expected) if err.startswith("canon study: ") else "traceback"
    if "5 finished, 0 failed, 3 pending (3 begun)" not in said:
        return "other numbers"
    rows = _exported(path)
    if rows is None or any(row != expected[key] for key, row in rows.items() if row["state"] == "finished"):
        return "other numbers"
    status, *_ = command("study", "resume", path)
    return "unharmed" if status == 0 and _exported(path) == expected else "other numbers"


def _after_mending(path: Path, expected: dict[str, dict[str, str]]) -> str:
    """Return what came of a file after it was mended and the study run again."""
    status, *_ = command("study", "mend", path)
    if status is None:
        return "traceback"
    if status == 2:
        return "told, restore a copy"
    run_study(STUDY, path)
    return "told and mended" if _exported(path) == expected else "other numbers"


def _exported(path: Path) -> dict[str, dict[str, str]] | None:
    """Return what is exported of a file, by case; None where it is refused."""
    table = path.with_suffix(".csv")
    status, *_ = command("study", "export", path, table)
    if status != 0:
        return None
    with table.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {row["key"]: {name: x for name, x in row.items() if name not in MOVING} for row in rows}
