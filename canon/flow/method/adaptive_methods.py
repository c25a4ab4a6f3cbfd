"""Adaptive methods, which choose their steps by a tolerance: heyoka's Taylor method and SciPy's DOP853."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from canon.flow.method.engine import HEYOKA, SCIPY

__all__ = ["DOP853", "Taylor"]


@dataclass(frozen=True)
class Taylor:
    """heyoka's adaptive Taylor method, of the order and with the steps its tolerance asks for.

    Parameters
    ----------
    tolerance
        What a step may miss, in parts of the largest number in the state at that time, coordinates and momenta (or
        velocities) alike, in whatever units; the rounding unit 2⁻⁵² where not given. A variable that is small beside
        the largest may have as many digits less: take units in which they are of one size where that matters, or
        :class:`DOP853`.

    Examples
    --------
    >>> Taylor().order
    20
    """

    tolerance: float | None = None
    citation = (
        "F. Biscani, D. Izzo, Revisiting high-order Taylor methods for astrodynamics and celestial "
        "mechanics, Mon. Not. R. Astron. Soc. 504 (2021) 2614–2628, doi:10.1093/mnras/stab1032"
    )
    engine, family, is_symplectic, solvable = HEYOKA, "taylor", False, None

    def __post_init__(self) -> None:
        _check_tolerance(self.tolerance)

    def __str__(self) -> str:
        return "Taylor" if self.tolerance is None else f"Taylor({self.tolerance:g})"

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it."""
        return {"taylor": True if self.tolerance is None else self.tolerance}

    @property
    def order(self) -> int:
        """The order that the tolerance leads to: ⌈1 − ½ ln(tolerance)⌉."""
        return math.ceil(1 - math.log(self.tolerance or 2.0**-52) / 2)

    @property
    def stages(self) -> int:
        """Taylor series in a step."""
        return 1


@dataclass(frozen=True)
class DOP853:
    """SciPy's adaptive Runge–Kutta method of order 8: the ordinary choice, for comparison.

    Parameters
    ----------
    tolerance
        What a step may miss of a component y is tolerance · (abs(y) + s). For a coordinate, s is the largest size that
        any coordinate has had so far, for a momentum or velocity likewise, but never more than 1. A state of small
        numbers is so followed as exactly as one of large ones, and no less exactly than SciPy's rtol = atol do.
    """

    tolerance: float = 1e-12
    order = 8
    stages = 12
    citation = (
        "E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., "
        "Springer 1993, doi:10.1007/978-3-540-78862-1"
    )
    engine, family, is_symplectic, solvable = SCIPY, "dop853", False, None

    def __post_init__(self) -> None:
        _check_tolerance(self.tolerance)

    def __str__(self) -> str:
        return f"DOP853({self.tolerance:g})"

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it."""
        return {"dop853": self.tolerance}


def _check_tolerance(tolerance: float | None) -> None:
    if tolerance is not None and not 0 < tolerance < 1:
        raise ValueError(f"tolerance {tolerance}: give a number between 0 and 1, such as 1e-12")
