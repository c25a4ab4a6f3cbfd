"""Dataset of what is kept: arrays of many cases side by side for xarray, each file read when its part is used."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.study.kept.keep_choice import CHAOS, EXPONENT, MOTION, SECTION

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import xarray

    from canon.array import Array
    from canon.study.kept.kept_arrays import Kept

__all__ = ["SideBySide", "dataset_of_kept"]

ALONG = {MOTION: "sample", SECTION: "passage", EXPONENT: "time", CHAOS: "time"}
"""What the arrays of a kept name lie along; those of functions along NAME_0, NAME_1, …"""


@dataclass(frozen=True)
class SideBySide:
    """One array of every case, padded with NaN where a case has fewer numbers, or none.

    Parameters
    ----------
    kept
        What was kept of each case.
    name
        Whole name of the array.

    Examples
    --------
    >>> SideBySide((), "motion.t").shape
    (0,)
    """

    kept: tuple[Kept, ...]
    name: str

    @property
    def shape(self) -> tuple[int, ...]:
        """Cases, and the largest extents of their arrays; nothing is read for it.

        Raises
        ------
        ValueError
            The arrays of the cases do not have equally many dimensions.
        """
        shapes = [each.shapes[self.name] for each in self.kept if self.name in each.shapes]
        if len({len(shape) for shape in shapes}) > 1:
            raise ValueError(
                f"{self.name} has {' and '.join(sorted({str(len(s)) for s in shapes}))} dimensions in different cases: "
                "choose among them, results.where(…)"
            )
        return (len(self.kept), *(max(extents) for extents in zip(*shapes, strict=True)))

    def __getitem__(self, key: tuple[Any, ...]) -> Array:
        """Return a part: a number, slice or list of numbers an axis, each taken by itself."""
        cases, *rest = key
        chosen = np.arange(len(self.kept))[cases]
        found = np.array([self._of(int(case), rest) for case in np.atleast_1d(chosen)])
        if not found.size:
            inner = self._padded(np.empty((0,) * (len(self.shape) - 1)), rest).shape
            found = np.empty((len(np.atleast_1d(chosen)), *inner))
        return found if np.ndim(chosen) else found[0]

    def _of(self, case: int, rest: Sequence[Any]) -> Array:
        kept = self.kept[case]
        if self.name not in kept.shapes or kept.chunk is None:
            return self._padded(np.full((0,) * (len(self.shape) - 1), np.nan), rest)
        return self._padded(kept.folder.arrays(kept.chunk, [self.name])[self.name], rest)

    def _padded(self, array: Array, rest: Sequence[Any]) -> Array:
        whole = np.full(self.shape[1:], np.nan)
        whole[tuple(map(slice, array.shape))] = array
        for axis in reversed(range(len(rest))):  # from the last, since a number takes its axis away
            whole = whole[(slice(None),) * axis + (rest[axis],)]
        return whole


def dataset_of_kept(kept: Sequence[Kept], name: str, inputs: Mapping[str, Sequence[Any]]) -> xarray.Dataset:
    """Return what was kept under a name as a dataset along ``case``; nothing is read before its numbers are used.

    Parameters
    ----------
    kept
        What was kept of each case.
    name
        ``"motion"``, ``"section"``, ``"exponent"``, ``"chaos"``, or the name of a function.
    inputs
        Coordinates along ``case``.

    Raises
    ------
    ImportError
        Where xarray is not installed.
    KeyError
        Nothing of that name was kept of any case.
    ValueError
        The arrays of the cases do not have equally many dimensions.
    """
    try:
        import xarray
    except ImportError as missing:
        raise ImportError("datasets need xarray: pip install canon-mechanics[export]") from missing
    from canon.study.kept.lazy_variable import lazy_variable

    names = dict.fromkeys(
        each for one in kept for each in one.shapes if each == name or each.startswith(f"{name}.")
    )
    if not names:
        there = ", ".join(dict.fromkeys(each for one in kept for each in one)) or "nothing"
        raise KeyError(f"no {name!r} was kept of any of the cases; there is {there}")
    variables: dict[str, Any] = {}
    for whole in names:
        array = SideBySide(tuple(kept), whole)
        further = range(len(array.shape) - 1)
        own = [ALONG[name]] if name in ALONG else [f"{whole.replace('.', '_')}_{k}" for k in further]
        variables[whole.partition(".")[2] or name] = lazy_variable(("case", *own), array)
    coordinates = {each: ("case", list(values)) for each, values in inputs.items() if each not in variables}
    return xarray.Dataset(variables, coordinates)
