"""Splittings for Hamiltonians that do not split: explicit in two copies of phase space, held together or projected."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from canon.flow.method.composition import check_order, weights_of_order
from canon.flow.method.engine import FIXED_STEPS

__all__ = ["ExtendedPhaseSpace", "SemiexplicitSplitting"]


@dataclass(frozen=True)
class ExtendedPhaseSpace:
    """Tao's explicit method for every H(q, p, t): two copies of phase space, held together by a rotation.

    Parameters
    ----------
    order
        2, 4, 6 or 8.
    omega
        The strength ω of ω(‖q − x‖² + ‖p − y‖²)/2, which rotates the difference of the copies (q, p) and (x, y) by 2ω
        in a unit of time. A few times the fastest rate of the motion: with less the copies part, with more the steps
        must be smaller.

    Raises
    ------
    ValueError
        No such order, or ω is no positive number.

    Notes
    -----
    The method is symplectic in the doubled phase space; the state that is kept is the mean of the copies, whose energy
    error stays bounded while the copies keep together, and whose Jacobian is symplectic to the method's error only. See
    :class:`SemiexplicitSplitting` for a method that is symplectic in (q, p) and has no ω.

    Examples
    --------
    >>> from canon import propagate
    >>> from canon.scene import find
    >>> pendulum = find("double-pendulum")
    >>> motion = propagate(pendulum, (0, 10), method=ExtendedPhaseSpace(4, omega=20), step=0.002)
    >>> bool(abs(motion.energy_error).max() < 1e-6)
    True
    """

    order: int = 4
    omega: float = math.nan
    engine, family, is_symplectic, solvable = FIXED_STEPS, "extended_phase_space", True, None
    tolerance = None
    citation = (
        "M. Tao, Explicit symplectic approximation of nonseparable Hamiltonians: algorithm and long time performance, "
        "Phys. Rev. E 94 (2016) 043303, doi:10.1103/PhysRevE.94.043303"
    )

    def __post_init__(self) -> None:
        check_order(self.order, "ExtendedPhaseSpace")
        if not (math.isfinite(self.omega) and self.omega > 0):
            raise ValueError(
                f"ExtendedPhaseSpace({self.order}, omega={self.omega}): give omega, a positive number in units of "
                "1/time, a few times the fastest rate of the motion; SemiexplicitSplitting needs none"
            )

    def __str__(self) -> str:
        return f"tao-{self.order}, omega {float(self.omega)!r}"

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it."""
        return {"extended_phase_space": self.order, "omega": float(self.omega)}

    @property
    def stages(self) -> int:
        """Evaluations of the derivatives of H in a step."""
        return 3 * len(weights_of_order(self.order))


@dataclass(frozen=True)
class SemiexplicitSplitting:
    """The semiexplicit method for every H(q, p, t): explicit in two copies of phase space, symplectic in (q, p).

    Parameters
    ----------
    order
        2, 4, 6 or 8.

    Raises
    ------
    ValueError
        No such order.

    Notes
    -----
    A symmetric projection brings the copies together at the end of every step; its 2n equations are solved to
    round-off in a few repetitions of the step. Quadratic integrals are kept.

    Examples
    --------
    >>> from canon import propagate
    >>> from canon.scene import find
    >>> pendulum = find("double-pendulum")
    >>> motion = propagate(pendulum, (0, 10), method=SemiexplicitSplitting(4), step=0.01)
    >>> bool(abs(motion.energy_error).max() < 1e-6)
    True
    """

    order: int = 4
    engine, family, is_symplectic, solvable = FIXED_STEPS, "semiexplicit", True, None
    tolerance = None
    citation = (
        "B. Jayawardana, T. Ohsawa, Semiexplicit symplectic integrators for non-separable Hamiltonian systems, "
        "Math. Comp. 92 (2022) 251–281, doi:10.1090/mcom/3778"
    )

    def __post_init__(self) -> None:
        check_order(self.order, "SemiexplicitSplitting")

    def __str__(self) -> str:
        return f"semiexplicit-{self.order}"

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it."""
        return {"semiexplicit": self.order}

    @property
    def stages(self) -> int:
        """Evaluations of the derivatives of H in one repetition of a step."""
        return 2 * len(weights_of_order(self.order)) + 1
