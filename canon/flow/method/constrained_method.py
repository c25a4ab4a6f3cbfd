"""Methods that keep constraints themselves: RATTLE, symplectic on holonomic ones, and the nonholonomic leapfrog."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from canon.flow.method.composition import check_order, weights_of_order
from canon.flow.method.engine import FIXED_STEPS

__all__ = ["NonholonomicLeapfrog", "NotForLeapfrogError", "NotForRattleError", "Rattle"]


class NotForLeapfrogError(ValueError):
    """The constrained system is not one that the nonholonomic leapfrog is for; the message says why."""


class NotForRattleError(ValueError):
    """The constrained system is not one that RATTLE is for; the message says why."""


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


@dataclass(frozen=True)
class NonholonomicLeapfrog:
    """The leapfrog for constraints on velocities, of blades and of what rolls: they hold to rounding, steps reverse.

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
    For a :class:`canon.ConstrainedLagrangian` all of whose constraints are on velocities, A(q, t) q̇ + a(q, t) = 0, and
    whose masses are positive; forces may act, and everything may hold the time. Constraints that follow from others at
    the start are left out and stay fulfilled with them. Where neither forces nor the time come in, momenta of
    symmetries along which the constraints allow motion stay what they are.

    Motion with such constraints is not Hamilton's, and no method is symplectic on it. What the steps share with it is
    its symmetry in time: where reversed velocities lead back, and the motion is as regular as that of integrable
    systems, the energy error stays bounded, as K. Modin and O. Verdier explain (Numer. Math. 145 (2020) 405–435,
    doi:10.1007/s00211-020-01126-y). Where the motion is chaotic the energy may wander, where it is not reversible it
    may drift: :func:`canon.drift` tells.

    Examples
    --------
    The nonholonomic particle: a plane that turns as y grows.

    >>> from canon import ConstrainedLagrangian, Lagrangian, coordinates, propagate
    >>> x, y, z = coordinates("x y z")
    >>> L = Lagrangian((x.dot**2 + y.dot**2 + z.dot**2 - x**2 - y**2) / 2, [x, y, z])
    >>> particle = ConstrainedLagrangian(L, nonholonomic=[z.dot - y * x.dot])
    >>> start = {"x": 1, "y": 0, "z": 0, "x_dot": 0, "y_dot": 1, "z_dot": 0}
    >>> motion = propagate(particle, (0, 1000), start, method=NonholonomicLeapfrog(4), step=0.1)
    >>> bool(abs(motion.residuals).max() < 4 * 2**-53), bool(abs(motion.energy_error).max() < 1e-4)
    (True, True)
    """

    order: int = 2
    engine, family, is_symplectic, solvable = FIXED_STEPS, "nonholonomic_leapfrog", False, None
    tolerance = None
    citation = (
        "R. McLachlan, M. Perlmutter, Integrators for nonholonomic mechanical systems, J. Nonlinear Sci. 16 (2006) "
        "283–328, doi:10.1007/s00332-005-0698-1; J. Cortés, S. Martínez, Non-holonomic integrators, Nonlinearity 14 "
        "(2001) 1365–1392, doi:10.1088/0951-7715/14/5/322"
    )

    def __post_init__(self) -> None:
        check_order(self.order, "NonholonomicLeapfrog")

    def __str__(self) -> str:
        return f"nonholonomic-leapfrog-{self.order}"

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it."""
        return {"nonholonomic_leapfrog": self.order}

    @property
    def stages(self) -> int:
        """Steps of order 2 in a step."""
        return len(weights_of_order(self.order))
