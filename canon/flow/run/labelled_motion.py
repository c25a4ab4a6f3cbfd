"""Motions as labelled tables for other programs: xarray datasets and pandas frames."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray

    from canon.array import Array

__all__ = ["labelled"]


def labelled(t: Array, columns: Mapping[str, Array], said: Mapping[str, Any]) -> xarray.Dataset:
    """Return what a motion has at its times as an xarray dataset along ``t``, of many orbits along ``orbit`` too.

    Parameters
    ----------
    t
        Sample times, shape (times,).
    columns
        Variables and observables by name, each of shape (times,) or (times, orbits).
    said
        Attributes of the dataset, such as the method.

    Raises
    ------
    ImportError
        xarray is not installed.
    """
    try:
        made: Any = import_module("xarray")
    except ModuleNotFoundError as missing:
        raise ImportError(
            f"{missing.name} is not installed: pip install 'canon-mechanics[export]'"
        ) from missing
    axes = ("t", "orbit")
    variables = {name: (axes[: values.ndim], values) for name, values in columns.items()}
    return made.Dataset(variables, coords={"t": t}, attrs=dict(said))
