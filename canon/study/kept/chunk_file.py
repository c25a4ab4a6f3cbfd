"""Chunk of a case: the arrays kept of it, in one NumPy archive beside the results file, named by its checksum.

A chunk is written as a whole before the row that names it, in the row's transaction, with its length and SHA-256 in
the row. So a row that is there has its chunk, a kill between the two leaves a chunk that no row names, nobody mends
between the two, and a flipped bit in a chunk is told when it is read.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import re
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from canon.array import Array

__all__ = ["Chunk", "ChunkFolder", "DamagedChunk"]

ASIDE = "aside"
"""Folder in the folder of chunks, for what is damaged or belongs to nothing."""


class DamagedChunk(OSError):
    """Raised where what was kept of a case is not in the file, or not what was written."""


@dataclass(frozen=True)
class Chunk:
    """Which file holds what was kept of a case, and what is in it.

    Parameters
    ----------
    key
        Key of the case.
    checksum
        SHA-256 of the file.
    shapes
        Shapes of the arrays by name.
    """

    key: str
    checksum: str
    shapes: Mapping[str, tuple[int, ...]]

    @property
    def file_name(self) -> str:
        """Name of the file: two programs that keep different things of a case do not meet."""
        return f"{self.key[:16]}-{self.checksum[:16]}.npz"

    def to_dict(self) -> dict[str, Any]:
        """Return what stands in the row of the case."""
        return {
            "checksum": self.checksum,
            "shapes": {name: list(shape) for name, shape in self.shapes.items()},
        }

    @staticmethod
    def named_by(key: str, outcome: str) -> Chunk | None:
        """Return the chunk that the row of a case names in its outcome, None where it names none.

        Examples
        --------
        >>> Chunk.named_by("a key", "no JSON: a store takes any text") is None
        True
        """
        if '"kept": {"checksum": ' not in outcome:
            return None
        written = json.loads(outcome)["kept"]
        if not (re.fullmatch("[0-9a-f]{64}", written["checksum"]) and re.fullmatch(r"[\w -]+", key)):
            return None  # no file of this folder has such a name
        return Chunk(key, written["checksum"], {name: tuple(n) for name, n in written["shapes"].items()})

    @staticmethod
    def of(key: str, arrays: Mapping[str, Array]) -> tuple[Chunk, bytes]:
        """Return the chunk of a case with these arrays, and the content of its file: the same bytes for the same."""
        stream = io.BytesIO()
        written: Any = {name: array.astype("<f8") for name, array in arrays.items()}
        np.savez(stream, **written)
        content = stream.getvalue()
        shapes = {name: array.shape for name, array in arrays.items()}
        return Chunk(key, hashlib.sha256(content).hexdigest(), shapes), content


@dataclass(frozen=True)
class ChunkFolder:
    """Folder of the chunks of a results file: ``study.sqlite.kept`` beside ``study.sqlite``.

    Parameters
    ----------
    results
        The results file.

    Examples
    --------
    >>> with tempfile.TemporaryDirectory() as place:
    ...     folder = ChunkFolder(Path(place) / "study.sqlite")
    ...     chunk, content = Chunk.of("a key", {"t": np.array([0.0, 0.5])})
    ...     folder.write(chunk, content)
    ...     folder.arrays(chunk)["t"].tolist(), [path.name for path in folder.files()] == [chunk.file_name]
    ([0.0, 0.5], True)
    """

    results: Path

    @property
    def path(self) -> Path:
        """Where the chunks are; the folder is made with the first of them."""
        return self.results.with_name(f"{self.results.name}.kept")

    def write(self, chunk: Chunk, content: bytes) -> None:
        """Write a chunk, which outlives a power cut once this returns; the same chunk may be there already."""
        self.path.mkdir(exist_ok=True)
        handle, name = tempfile.mkstemp(dir=self.path, prefix=f".{chunk.file_name}.")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            Path(name).replace(self.path / chunk.file_name)
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise
        _keep_names(self.path)

    def content(self, chunk: Chunk) -> bytes:
        """Return the bytes of a chunk.

        Raises
        ------
        DamagedChunk
            They are not there, or not what was written.
        """
        place = self.path / chunk.file_name
        remedy = f"'canon study mend {self.results}' sets it aside, so that the case is computed again"
        try:
            content = place.read_bytes()
        except FileNotFoundError:
            raise DamagedChunk(f"{place}, kept of case {chunk.key[:12]}, is not there; {remedy}") from None
        if hashlib.sha256(content).hexdigest() != chunk.checksum:
            raise DamagedChunk(f"{place}, kept of case {chunk.key[:12]}, is damaged; {remedy}")
        return content

    def arrays(self, chunk: Chunk, names: Iterable[str] | None = None) -> dict[str, Array]:
        """Return arrays of a chunk by name, all of them unless names are given.

        Raises
        ------
        DamagedChunk
            As :meth:`content`.
        """
        content = self.content(chunk)
        try:
            with np.load(io.BytesIO(content), allow_pickle=False) as archive:
                return {name: archive[name] for name in (chunk.shapes if names is None else names)}
        except (KeyError, ValueError, zipfile.BadZipFile) as strange:
            raise DamagedChunk(
                f"{self.path / chunk.file_name} holds no arrays of a case ({strange})"
            ) from strange

    def files(self) -> list[Path]:
        """Return every file of the folder, those of unfinished writing among them."""
        return sorted(path for path in self.path.iterdir() if path.is_file()) if self.path.is_dir() else []

    def is_whole(self, chunk: Chunk) -> bool:
        """Tell whether a chunk is there as it was written."""
        try:
            self.content(chunk)
        except DamagedChunk:
            return False
        return True

    def set_aside(self, file: Path) -> Path:
        """Move a file of the folder to where nothing is read, and return its new place."""
        place = self.path / ASIDE
        place.mkdir(exist_ok=True)
        names = (place / f"{file.name}{number or ''}" for number in range(10_000))
        free = next(name for name in names if not name.exists())
        return file.rename(free)


def _keep_names(folder: Path) -> None:
    """Have a folder's names outlive a power cut, where the system lets folders be opened for that."""
    if os.name == "posix":
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
