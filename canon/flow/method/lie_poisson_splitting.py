"""Lie–Poisson splittings as methods: rotating bodies and other Poisson systems, by exact flows of parts of H."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from canon.flow.method.composition import check_order, weights_of_order
from canon.flow.method.engine import FIXED_STEPS

__all__ = ["LiePoissonSplitting", "NoLiePoissonPartsError"]


class NoLiePoissonPartsError(ValueError):
    """H is no sum of parts that a Lie–Poisson splitting moves by; the message says why."""


@dataclass(frozen=True)
class LiePoissonSplitting:
    """A splitting on a Poisson manifold: turns about principal axes and kicks, each the exact flow of a part of H.

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
    For a :class:`canon.mechanics.PoissonSystem` with H = Σ Hᵢ(xᵢ) + V, where the flow of each Hᵢ turns planes, as those
    of M₁²/2A, M₂²/2B and M₃²/2C turn the body about its axes, and V is a function of variables that commute, as Γ or
    Euler's parameters do. Steps are Poisson maps: Casimir functions such as abs(M)², M · Γ and the norm of Euler's
    parameters stay what they are to round-off, the energy error is bounded.

    Examples
    --------
    A free body turning about its middle axis, which is not stable:

    >>> from canon import propagate
    >>> from canon.mechanics import free_body
    >>> motion = propagate(free_body([1, 2, 3]), (0, 1000), ["0.01", 1, 0], method=LiePoissonSplitting(4), step=0.1)
    >>> size = motion["M_1"]**2 + motion["M_2"]**2 + motion["M_3"]**2
    >>> bool(abs(size - size[0]).max() < 2e-15), bool(abs(motion.energy_error).max() < 1e-6)
    (True, True)
    """

    order: int = 2
    engine, family, is_symplectic, solvable = FIXED_STEPS, "lie_poisson", True, None
    tolerance = None
    citation = (
        "R. I. McLachlan, Explicit Lie–Poisson integration and the Euler equations, Phys. Rev. Lett. 71 (1993) "
        "3043–3046, doi:10.1103/PhysRevLett.71.3043; J. Touma, J. Wisdom, Lie–Poisson integrators for rigid body "
        "dynamics in the solar system, Astron. J. 107 (1994) 1189–1202, doi:10.1086/116931"
    )

    def __post_init__(self) -> None:
        check_order(self.order, "LiePoissonSplitting")

    def __str__(self) -> str:
        return f"lie-poisson-{self.order}"

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it."""
        return {"lie_poisson": self.order}

    @property
    def stages(self) -> int:
        """Steps of order 2 in a step."""
        return len(weights_of_order(self.order))
