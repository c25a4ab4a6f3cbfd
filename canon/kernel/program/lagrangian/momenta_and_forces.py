"""Momenta ∂L/∂q̇ and forces ∂L/∂q + Q of a Lagrangian as nodes in the symbols of its state, ready to compile."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["MomentaAndForces"]


@dataclass(frozen=True, eq=False)
class MomentaAndForces:
    """Nodes of p(q, v, t) = ∂L/∂v and of F(q, v, t) = ∂L/∂q + Q, one a coordinate."""

    momenta: tuple[int, ...]
    forces: tuple[int, ...]

    @property
    def nodes(self) -> list[int]:
        """All of them, momenta first."""
        return [*self.momenta, *self.forces]

    def with_nodes(self, nodes: Sequence[int]) -> MomentaAndForces:
        """Return the same with other nodes, in the order of :attr:`nodes`."""
        n = len(self.momenta)
        return MomentaAndForces(tuple(nodes[:n]), tuple(nodes[n:]))
