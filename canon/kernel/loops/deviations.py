"""Deviations in memory: vectors beside an orbit, in SIMD lanes over the vectors of one orbit or over many orbits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from canon.kernel.llvm.number_types import MachineType
    from canon.kernel.llvm.writer import Writer

__all__ = ["Deviations"]


@dataclass(frozen=True)
class Deviations:
    """How deviation vectors lie behind the compensation of a block of orbits.

    Parameters
    ----------
    number
        The numbers of the orbit, with its lanes over orbits.
    state
        Numbers of a state, parameters that vary included.
    size
        Components of a deviation, δq then δp.
    vectors
        Deviation vectors of each orbit.
    lanes
        Vectors side by side; 1 where orbits are.
    method
        Numbers that the method keeps between the compensation and the deviations.
    """

    number: MachineType
    state: int
    size: int
    vectors: int
    lanes: int = 1
    method: int = 0

    @property
    def groups(self) -> int:
        """How many times so many vectors as stand side by side there are."""
        return -(-self.vectors // self.lanes)

    @property
    def numbers(self) -> int:
        """How many of the orbit's numbers they take."""
        return self.groups * self.size * self.lanes

    @property
    def carry(self) -> int:
        """Numbers behind a block's state: its compensation, those of the method, then the deviations."""
        return self.before + self.numbers

    @property
    def before(self) -> int:
        """Numbers before the deviations."""
        return self.state + self.method

    def writer(self, w: Writer) -> Writer:
        """Return the writer of their numbers in a function that w writes."""
        return w if self.lanes == 1 else w.side_by_side(self.lanes)

    def spread(self, v: Writer, value: str) -> str:
        """Return a number of the orbit beside every vector; v is their writer."""
        return value if self.lanes == 1 else v.splat(value)
