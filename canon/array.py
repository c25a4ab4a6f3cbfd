"""Array type of annotations: NumPy arrays of doubles."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["Array"]

Array = npt.NDArray[np.float64]
"""An array of doubles."""
