"""Lazy variable: an xarray variable whose numbers are read when they are used, with dask or without it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import xarray
from xarray.backends import BackendArray
from xarray.core import indexing

if TYPE_CHECKING:
    from canon.array import Array

__all__ = ["lazy_variable"]


class PartlyRead(Protocol):
    """An array of doubles of which parts can be read: a number, slice or list of numbers an axis."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Its extents, known without reading."""
        ...

    def __getitem__(self, key: tuple[Any, ...]) -> Array: ...


@dataclass(eq=False)
class _Backed(BackendArray):
    """An array as xarray's backends have it (https://docs.xarray.dev/en/stable/internals/how-to-add-new-backend.html)."""

    array: PartlyRead

    def __post_init__(self) -> None:
        self.shape, self.dtype = self.array.shape, np.dtype(np.float64)

    def __getitem__(self, key: Any) -> Any:
        return indexing.explicit_indexing_adapter(
            key, self.shape, indexing.IndexingSupport.OUTER, self.array.__getitem__
        )


def lazy_variable(dimensions: tuple[str, ...], array: PartlyRead) -> xarray.Variable:
    """Return an array of cases as a variable of which only the parts that are used are read."""
    return xarray.Variable(dimensions, indexing.LazilyIndexedArray(_Backed(array)))
