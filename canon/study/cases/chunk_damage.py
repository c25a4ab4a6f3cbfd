"""Damage among the chunks of a results file: files that are not what was written, are gone, or belong to no case."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.study.kept.chunk_file import Chunk, ChunkFolder

if TYPE_CHECKING:
    from pathlib import Path

    from canon.study.cases.store import Store

__all__ = ["DamagedFile", "damaged_chunks", "orphaned_chunks", "set_chunks_aside"]


@dataclass(frozen=True)
class DamagedFile:
    """A file of what is kept that is not as it should be.

    Parameters
    ----------
    key
        Key of its case, or its beginning.
    file
        The file.
    why
        What is wrong with it.
    """

    key: str
    file: Path
    why: str

    @property
    def what(self) -> str:
        """What the file is of its case, and what is wrong with it."""
        return f"what was kept ({self.file.name}: {self.why})"

    def __str__(self) -> str:
        return f"{self.what} of case {self.key[:12]}"


def damaged_chunks(store: Store) -> tuple[DamagedFile, ...]:
    """Return the chunks that records name and that are not there as they were written; all of them are read."""
    folder = ChunkFolder(store.path)
    found: list[DamagedFile] = []
    for key, chunk in _named(store).items():
        if not folder.is_whole(chunk):
            file = folder.path / chunk.file_name
            found.append(DamagedFile(key, file, "it is damaged" if file.exists() else "it is not there"))
    return tuple(found)


def orphaned_chunks(store: Store) -> tuple[DamagedFile, ...]:
    """Return the files among the chunks that no record names, as a kill between chunk and record leaves them."""
    named = {chunk.file_name for chunk in _named(store).values()}
    return tuple(
        DamagedFile(file.name.lstrip(".")[:16], file, "no record names it")
        for file in ChunkFolder(store.path).files()
        if file.name not in named
    )


def set_chunks_aside(store: Store) -> tuple[DamagedFile, ...]:
    """Move damaged and orphaned chunks to a folder beside the others, and forget the records that named them.

    A study that runs meanwhile waits with what it writes, and loses nothing.

    Returns
    -------
    tuple of DamagedFile
        What was wrong, and where.
    """
    folder, damaged = ChunkFolder(store.path), damaged_chunks(store)  # reading all of them may take long
    with store.while_nobody_writes():
        orphaned = orphaned_chunks(store)
        for each in (*damaged, *orphaned):
            if each.file.exists():
                folder.set_aside(each.file)
    store.forget(each.key for each in damaged)
    return (*damaged, *orphaned)


def _named(store: Store) -> dict[str, Chunk]:
    named = ((key, Chunk.named_by(key, record.outcome)) for key, record in store.records().items())
    return {key: chunk for key, chunk in named if chunk is not None}
