"""RATTLE as a method: constrained mechanical systems, symplectic on their constraints, of order 2 to 8."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from canon.flow.method.composition import check_order
from canon.flow.method.engine import FIXED_STEPS

__all__ = ["Rattle"]


@dataclass(frozen=True)
class Rattle:
    """RATTLE for a Lagrangian with holonomic constraints: they hold to rounding, and the energy error stays bounded.

    Parameters
    ----------
    order
        2, or 4, 6 or 8 by symmetric compositions.

    Raises
    ------
    ValueError
        No such order.

    Notes
    -----
    For a :class:`canon.ConstrainedLagrangian` whose constraints are holonomic and hold no time, whose masses do not
    depend on velocities, and on which no other forces act. Constraints that follow from others at the start are left
    out and stay fulfilled with them. Multipliers are known along the motion as for other methods.

    Examples
    --------
    >>> from canon import ConstrainedLagrangian, Lagrangian, coordinates, propagate
    >>> x, y = coordinates("x y")
    >>> L = Lagrangian((x.dot**2 + y.dot**2) / 2 - y, [x, y])
    >>> pendulum = ConstrainedLagrangian(L, holonomic=[x**2 + y**2 - 1])
    >>> motion = propagate(pendulum, (0, 1000), [1, 0, 0, 0], method=Rattle(4), step=0.05)
    >>> bool(abs(motion.residuals).max() < 4 * 2**-53), bool(abs(motion.energy_error).max() < 1e-5)
    (True, True)
    """

    order: int = 2
    engine, family, is_symplectic, solvable = FIXED_STEPS, "rattle", True, None
    tolerance = None
    citation = (
        "H. C. Andersen, Rattle: a “velocity” version of the Shake algorithm for molecular dynamics calculations, "
        "J. Comput. Phys. 52 (1983) 24–34, doi:10.1016/0021-9991(83)90014-1; B. Leimkuhler, R. D. Skeel, Symplectic "
        "numerical integrators in constrained Hamiltonian systems, J. Comput. Phys. 112 (1994) 117–125, "
        "doi:10.1006/jcph.1994.1085"
    )

    def __post_init__(self) -> None:
        check_order(self.order, "Rattle")

    def __str__(self) -> str:
        return f"rattle-{self.order}"

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it."""
        return {"rattle": self.order}

    @property
    def stages(self) -> int:
        """What an iteration for the multipliers evaluates: the constraints, once."""
        return 1
