"""A study that keeps everything, small enough to be run many times over."""

from __future__ import annotations

from canon import Study
from canon.study.cases.store import Store
from canon.study.kept.chunk_file import ChunkFolder

KEEP = ["motion", "exponent", {"section": "x", "direction": "rising"}]

STUDY = Study.of(
    system="henon-heiles", method=["verlet", "taylor"], step=0.1, span=60.0, samples=512, parts=4, keep=KEEP
)


def spread(motion):
    return {"of_x": motion["x"].std(), "corners": motion.y[:2, :2]}


FUNCTIONS = {"spread": spread}


def all_of(path):
    """Every row of a results file and every byte kept beside it."""
    rows = {key: (record.outcome, record.failure) for key, record in Store(path).records().items()}
    return rows, {file.name: file.read_bytes() for file in ChunkFolder(path).files()}
