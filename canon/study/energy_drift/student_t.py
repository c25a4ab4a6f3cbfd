"""Student's t distribution for whole degrees of freedom, by its finite sums.

M. Abramowitz & I. A. Stegun, Handbook of Mathematical Functions (1964), 26.7.3 and 26.7.4. SciPy has it for any
degrees, but takes longer to import than the drift of a short run.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from canon.array import Array

__all__ = ["student_tail"]


def student_tail(freedom: int, t: Array) -> Array:
    """Return the probability P(T > t), to about 10⁻¹⁵ of one.

    Parameters
    ----------
    freedom
        Degrees of freedom.
    t
        Where, of any shape.

    Examples
    --------
    >>> student_tail(30, np.array([0.0, 1.697261, 2.749996, np.inf])).round(6)
    array([0.5  , 0.05 , 0.005, 0.   ])
    """
    size = np.minimum(np.abs(t), 1e150)
    length = np.hypot(size, math.sqrt(freedom))
    sine, cosine = size / length, math.sqrt(freedom) / length
    weights = _weights(freedom)
    total = cosine[..., np.newaxis] ** (2 * np.arange(len(weights))) @ weights
    odd = 2.0 / math.pi * (np.arctan2(sine, cosine) + sine * cosine * total)
    within = odd if freedom % 2 else sine * total
    beyond = np.clip(0.5 - 0.5 * within, 0.0, 0.5)
    return np.where(t > 0, beyond, 1.0 - beyond)


@functools.lru_cache(maxsize=64)
def _weights(freedom: int) -> npt.NDArray[Any]:
    """Return the products (2·4…2k)/(3·5…(2k + 1)) of odd degrees, (1·3…(2k − 1))/(2·4…2k) of even ones."""
    odd = freedom % 2
    ratios = [(2 * k - 1 + odd) / (2 * k + odd) for k in range(1, (freedom - odd) // 2)]
    found = np.cumprod([1.0, *ratios])
    return found if freedom > 1 else np.zeros(1)
