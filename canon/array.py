"""Arrays of doubles: their type in annotations, and whether all are finite."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["Array", "all_finite"]

Array = npt.NDArray[np.float64]
"""An array of doubles."""


def all_finite(numbers: npt.NDArray[Any]) -> bool:
    """Tell whether all numbers of an array of machine numbers are finite.

    Where their squares together are a finite number, they are: one pass over them, and no array beside.

    Examples
    --------
    >>> [all_finite(np.array(x)) for x in ([1.0, 2.0], [1e300, -1e300], [1.0, np.nan], [np.inf, -np.inf])]
    [True, True, False, False]
    """
    return math.isfinite(np.vdot(numbers, numbers)) or bool(np.isfinite(numbers).all())
