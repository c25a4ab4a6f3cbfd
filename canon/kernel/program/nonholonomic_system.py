"""Nonholonomic system ready to compile: constraints on velocities, momenta, and slopes for Newton's method."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["NonholonomicSystem"]

Rows = tuple[tuple[int, ...], ...]


@dataclass(frozen=True, eq=False)
class NonholonomicSystem:
    """Nodes of d/dt ∂K/∂v = F + ∂K/∂q − ∂V/∂q + Aᵀλ with A(q) v + a(q) = 0 and L = K(q, v) − V(q); all may hold t.

    They are in the symbols of a system's state (q, v).

    Parameters
    ----------
    kick
        −∂V/∂q, functions of q.
    momenta, pull
        p = ∂K/∂v and R = ∂K/∂q + F, F being other forces.
    masses
        ∂p/∂v, row by row.
    turning
        ∂p/∂q − ∂R/∂v.
    stiffness
        ∂R/∂q.
    rows, rests
        A, one row a constraint, and a.
    slopes
        ∂(A v + a)/∂q.
    steady
        Whether p = M v + c with constant M and c.
    works
        Whether behind q in the state there is the work that is done on the system, whose rate is known there.
    """

    kick: tuple[int, ...]
    momenta: tuple[int, ...]
    pull: tuple[int, ...]
    masses: Rows
    turning: Rows
    stiffness: Rows
    rows: Rows
    rests: tuple[int, ...]
    slopes: Rows
    steady: bool
    works: bool

    @property
    def tables(self) -> tuple[Rows, ...]:
        """All nodes in rows."""
        single = (self.kick,), (self.momenta,), (self.pull,), (self.rests,)
        return *single, self.masses, self.turning, self.stiffness, self.rows, self.slopes

    @property
    def nodes(self) -> list[int]:
        """All of them, one after the other."""
        return [node for table in self.tables for row in table for node in row]

    def with_nodes(self, nodes: Sequence[int]) -> NonholonomicSystem:
        """Return the same with other nodes, in the order of :attr:`nodes`."""
        given = iter(nodes)
        kick, momenta, pull, rests, masses, turning, stiffness, rows, slopes = (
            tuple(tuple(next(given) for _ in row) for row in table) for table in self.tables
        )
        return replace(
            self, kick=kick[0], momenta=momenta[0], pull=pull[0], masses=masses, turning=turning,
            stiffness=stiffness, rows=rows, rests=rests[0], slopes=slopes,
        )  # fmt: skip
