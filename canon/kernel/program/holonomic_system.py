"""Holonomic system ready to compile: constraints, their directions, and the rates of positions and momenta."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["HolonomicSystem"]


@dataclass(frozen=True, eq=False)
class HolonomicSystem:
    """Nodes of q̇ = V(q, P), Ṗ = F(q, P) + Σ λₐ pushₐ with g(q) = 0, in the symbols of a system's state (q, v).

    P are the velocities where masses are constant and nothing else depends on velocities; the momenta else. In V and F
    the symbols of the velocities stand for P.

    Parameters
    ----------
    values
        g, one node a constraint.
    slopes
        G = ∂g/∂q, row by row.
    pushes
        What a multiplier adds to Ṗ, row by row: M⁻¹Gᵀ, or Gᵀ where P are momenta.
    shares
        M⁻¹Gᵀ, by which a multiplier changes velocities.
    velocity, force
        V and F.
    momenta
        p(q, v) where P are momenta; empty where they are the velocities themselves.
    """

    values: tuple[int, ...]
    slopes: tuple[tuple[int, ...], ...]
    pushes: tuple[tuple[int, ...], ...]
    shares: tuple[tuple[int, ...], ...]
    velocity: tuple[int, ...]
    force: tuple[int, ...]
    momenta: tuple[int, ...] = ()

    @property
    def nodes(self) -> list[int]:
        """All of them, one after the other."""
        rows = (node for rows in (self.slopes, self.pushes, self.shares) for row in rows for node in row)
        return [*self.values, *rows, *self.velocity, *self.force, *self.momenta]

    def with_nodes(self, nodes: Sequence[int]) -> HolonomicSystem:
        """Return the same with other nodes, in the order of :attr:`nodes`."""
        given, n, k = iter(nodes), len(self.velocity), len(self.values)

        def some(count: int) -> tuple[int, ...]:
            return tuple(next(given) for _ in range(count))

        values = some(k)
        slopes, pushes, shares = (tuple(some(n) for _ in range(k)) for _ in range(3))
        return HolonomicSystem(values, slopes, pushes, shares, some(n), some(n), some(len(self.momenta)))
