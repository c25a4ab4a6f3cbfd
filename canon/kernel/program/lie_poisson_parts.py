"""Lie–Poisson parts ready to compile: turns about an axis or about M, and kicks by what rests along their flow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fractions import Fraction

__all__ = ["CommonTurn", "Kick", "LiePoissonParts", "PlaneTurns", "TurningBlock"]


Kick = tuple[tuple[int, int], ...]
"""Components of a state, and the nodes of their rates."""


@dataclass(frozen=True, eq=False)
class PlaneTurns:
    """The flow of a function of one variable, which rests: some planes turn, ẏᵢ = −c r yⱼ and ẏⱼ = c r yᵢ.

    Parameters
    ----------
    rate
        The node of r, a function of the variable that rests.
    planes
        Two components i and j of a state, and c.
    """

    rate: int
    planes: tuple[tuple[int, int, Fraction], ...]


@dataclass(frozen=True, eq=False)
class TurningBlock:
    """Components that turn together, ẏ = S y with S³ = −c² |M|² S, where M rests.

    Parameters
    ----------
    entries
        Components i and j of a state, and which of M turns one towards the other: Sᵢⱼ = −c Mₖ, Sⱼᵢ = c Mₖ.
    axis
        The components of M.
    speed
        c.
    """

    entries: tuple[tuple[int, int, int], ...]
    axis: tuple[int, ...]
    speed: Fraction


@dataclass(frozen=True, eq=False)
class CommonTurn:
    """The flow of ½ r |M|²: M rests, and what turns with the body turns about it, ẏ = r S y in each block."""

    rate: Fraction
    blocks: tuple[TurningBlock, ...]


@dataclass(frozen=True, eq=False)
class LiePoissonParts:
    """The parts of H, each with a flow known in closed form.

    Parameters
    ----------
    turns
        The parts that turn planes.
    commons
        The parts that turn about M; they commute with all turns.
    kicks
        Of each part that is left components of a state and the nodes of their rates, constant along its flow.
    drift
        The same of one that commutes with all turns, as the motion of centres of mass does.
    """

    turns: tuple[PlaneTurns, ...]
    commons: tuple[CommonTurn, ...]
    kicks: tuple[Kick, ...]
    drift: Kick = ()
