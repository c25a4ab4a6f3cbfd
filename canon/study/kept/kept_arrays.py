"""Kept arrays of a case, read from its chunk when they are asked for and checked then."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.array import Array
    from canon.study.kept.chunk_file import Chunk, ChunkFolder

__all__ = ["Kept", "finite_arrays"]

LARGEST_WHOLE = 2**53
"""Up to here every whole number is a double."""


@dataclass(frozen=True, eq=False)
class Kept(Mapping[str, Any]):
    """What was kept of a case by name, an array or a mapping of arrays, read from its file when it is asked for.

    Parameters
    ----------
    folder
        Where the chunks are.
    chunk
        Which one; None where nothing was kept.

    Raises
    ------
    DamagedChunk
        On reading: the file is not there, or not what was written.
    """

    folder: ChunkFolder
    chunk: Chunk | None

    def __repr__(self) -> str:
        return f"<Kept: {', '.join(self) or 'nothing'}>"

    @property
    def shapes(self) -> Mapping[str, tuple[int, ...]]:
        """Shapes of the arrays by their whole names, such as ``motion.t``; nothing is read for them."""
        return {} if self.chunk is None else self.chunk.shapes

    def __contains__(self, name: object) -> bool:
        return name in tuple(self)  # the mapping's own way would read the file

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys(name.partition(".")[0] for name in self.shapes))

    def __len__(self) -> int:
        return len({name.partition(".")[0] for name in self.shapes})

    def __getitem__(self, name: str) -> Any:
        """Return the array of a name, or its arrays by name.

        Raises
        ------
        KeyError
            Nothing of that name was kept.
        """
        own = [each for each in self.shapes if each == name or each.startswith(f"{name}.")]
        if self.chunk is None or not own:
            raise KeyError(f"no {name!r} was kept of the case; there is {', '.join(self) or 'nothing'}")
        found = self.folder.arrays(self.chunk, own)
        return found[name] if own == [name] else {each.partition(".")[2]: found[each] for each in own}


def finite_arrays(name: str, value: Any) -> dict[str, Array]:
    """Return what a function returned as arrays of doubles by whole name.

    Parameters
    ----------
    name
        What it is called.
    value
        A number, an array, or a mapping of these by name.

    Raises
    ------
    ValueError
        It is none of these, or a number of it is not finite or no double.

    Examples
    --------
    >>> finite_arrays("spread", {"x": 2, "p": [0.5, 1.0]})
    {'spread.x': array(2.), 'spread.p': array([0.5, 1. ])}
    """
    if isinstance(value, Mapping):
        if not value or not all(isinstance(key, str) and key.isidentifier() for key in value):
            raise ValueError(f"{name} returned a mapping whose keys are no names: {list(value)[:5]}")
        return {f"{name}.{key}": _array(f"{name}[{key!r}]", each) for key, each in value.items()}
    return {name: _array(name, value)}


def _array(name: str, value: Any) -> Array:
    given = np.asarray(value)
    if given.dtype.kind not in "fiub":
        raise ValueError(f"{name} is no number nor array of real numbers, but of {given.dtype}")
    if given.dtype.kind in "iu" and given.size and max(int(given.max()), -int(given.min())) > LARGEST_WHOLE:
        raise ValueError(f"{name} holds whole numbers beyond 2**53, which doubles can't")
    found = given.astype(np.float64)
    if not np.isfinite(found).all():
        raise ValueError(f"{name} holds numbers that are not finite")
    return found
