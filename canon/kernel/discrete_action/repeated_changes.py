"""Repeated changes of an iteration inside a compiled loop: when they have settled, and whether they converged."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.number_types import DOUBLE, SINGLE
from canon.kernel.llvm.solvers.linear_solver import magnitude

if TYPE_CHECKING:
    from canon.kernel.llvm.writer import Writer

__all__ = ["RepeatedChanges"]

_NEAR, _SETTLED, _CONVERGED = 26, 30, 20
"""In doubles, below 2⁻²⁶ of the largest number a Newton step's error is one of the factors, which are kept then; above
2⁻³⁰ nothing is taken for round-off; above 2⁻²⁰ at the end the iteration has not converged. In others accordingly."""


@dataclass(frozen=True)
class RepeatedChanges:
    """Writes the watch over an iteration: it ends when the changes are small and do not halve any more.

    Parameters
    ----------
    w, g
        Writers in the loop's numbers and in those, no wider than doubles, that changes are watched in.
    watched
        Memory of the largest change of this iteration, of the least so far, of the one before, and of the largest
        number.
    """

    w: Writer
    g: Writer
    watched: str

    @classmethod
    def of(cls, w: Writer) -> RepeatedChanges:
        """Return the watch with memory of its own."""
        g = w.in_numbers(SINGLE if w.number == SINGLE else DOUBLE)
        return cls(w, g, g.array(4))

    def begin(self) -> None:
        """Write that nothing has changed yet."""
        g = self.g
        for slot in range(3):
            g.store(g.infinity(), self.watched, slot)
        g.store(g.constant(Fraction(0)), self.watched, 3)

    def count(self) -> None:
        """Write that an iteration begins to change its numbers."""
        g = self.g
        now, least = g.load(self.watched, 0), g.load(self.watched, 1)
        g.store(g.intrinsic("minnum", now, least), self.watched, 1)
        g.store(g.constant(Fraction(0)), self.watched, 0)
        g.store(g.constant(Fraction(0)), self.watched, 3)

    def note(self, change: str, new: str) -> None:
        """Write that a number has changed; NaN counts as the largest change there is."""
        g, size = self.g, magnitude(self.w, change)
        known = g.select(g.less(size, g.infinity()), size, g.infinity())
        g.store(g.intrinsic("maxnum", g.load(self.watched, 0), known), self.watched, 0)
        self.reach(new)

    def reach(self, number: str) -> None:
        """Write that there is a number of that size."""
        g = self.g
        g.store(g.intrinsic("maxnum", g.load(self.watched, 3), magnitude(self.w, number)), self.watched, 3)

    def _above(self, bits: int) -> str:
        """Return whether the last change is above 2⁻ᵇⁱᵗˢ of the largest number."""
        g = self.g
        part = g.constant(Fraction(1, 2 ** (bits * self.w.number.mantissa // 53)))
        return g.less(g.algebra("mul", g.load(self.watched, 3), part), g.load(self.watched, 0))

    def coarse(self) -> str:
        """Return 1 where the factors are to be made anew, else 0, as an integer."""
        return self.w.let(f"zext i1 {self._above(_NEAR)} to i64")

    def settled(self) -> str:
        """Return whether the iteration is to end."""
        g = self.g
        now = g.load(self.watched, 0)
        slow = g.less(g.load(self.watched, 1), g.algebra("add", now, now))
        ended = self.w.let(f"or i1 {g.equal(now, g.constant(Fraction(0)))}, {g.equal(now, g.infinity())}")
        fine = self.w.let(f"xor i1 {self._above(_SETTLED)}, true")
        return self.w.let(f"or i1 {ended}, {self.w.let(f'and i1 {slow}, {fine}')}")

    def result(self) -> tuple[str, str]:
        """Return whether the iteration has not converged, and its last change."""
        g = self.g
        now = g.load(self.watched, 0)
        endless = g.equal(now, g.infinity())
        return self.w.let(f"or i1 {endless}, {self._above(_CONVERGED)}"), self.w.widened(now, g.number)
