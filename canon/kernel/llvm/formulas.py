"""Formulas in LLVM IR that read like formulas: short names for a writer's operations."""

from __future__ import annotations

import dataclasses
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.llvm.writer import Writer

__all__ = ["LaneFormulas"]


class LaneFormulas:
    """Operations on registers of one writer's numbers, lane by lane; pairs of doubles compare by their high parts.

    Parameters
    ----------
    writer
        Where the operations are written.
    """

    def __init__(self, writer: Writer) -> None:
        self.writer = writer
        self.zero, self.one = writer.constant(Fraction(0)), writer.constant(Fraction(1))
        self._part = writer.in_numbers(dataclasses.replace(writer.number, pair=False))

    def number(self, value: Fraction) -> str:
        """Return a constant, the same in all lanes."""
        return self.writer.constant(value)

    def numbers(self, values: Sequence[Fraction]) -> str:
        """Return a constant with a value for each lane."""
        kind = self.writer.number
        if len(values) != kind.lanes:
            raise ValueError(f"{len(values)} numbers for {kind.lanes} lanes")
        if kind.lanes == 1:
            return kind.literal(values[0])
        if kind.pair:
            high = [Fraction(float(value)) for value in values]
            low = [value - first for value, first in zip(values, high, strict=True)]
            parts = (self._lanes_of(each) for each in (high, low))
            return "{ " + ", ".join(f"{kind.base} {part}" for part in parts) + " }"
        return self._lanes_of(values)

    def _lanes_of(self, values: Sequence[Fraction]) -> str:
        one = dataclasses.replace(self._part.number, lanes=1)
        return "<" + ", ".join(f"{one.scalar} {one.literal(value)}" for value in values) + ">"

    def add(self, a: str, b: str) -> str:
        """Write a + b."""
        return self.writer.algebra("add", a, b)

    def sub(self, a: str, b: str) -> str:
        """Write a − b."""
        return self.writer.algebra("sub", a, b)

    def mul(self, a: str, b: str) -> str:
        """Write a · b."""
        return self.writer.algebra("mul", a, b)

    def div(self, a: str, b: str) -> str:
        """Write a / b."""
        return self.writer.algebra("div", a, b)

    def fma(self, a: str, b: str, c: str) -> str:
        """Write a · b + c, rounded once where the hardware does that."""
        return self.writer.multiply_add(a, b, c)

    def neg(self, a: str) -> str:
        """Write −a."""
        return self.writer.negative(a)

    def sqrt(self, a: str) -> str:
        """Write √a."""
        return self.writer.operation("sqrt", [a])

    def two_sum(self, a: str, b: str) -> tuple[str, str]:
        """Write a + b and what its rounding takes (D. E. Knuth's two-sum)."""
        total = self.add(a, b)
        kept = self.sub(total, b)
        return total, self.add(self.sub(a, kept), self.sub(b, self.sub(total, kept)))

    # comparisons and choices -----------------------------------------------------------------------

    def high(self, a: str) -> str:
        """Return a number's leading part."""
        if not self.writer.number.pair:
            return a
        return self.writer.let(f"extractvalue {self.writer.number.name} {a}, 0")

    def less(self, a: str, b: str) -> str:
        """Compare: a < b, false where either is NaN."""
        return self.writer.less(a, b)

    def at_most(self, a: str, b: str) -> str:
        """Compare: a ≤ b, false where either is NaN."""
        a, b = self.high(a), self.high(b)
        return self.writer.let(f"fcmp ole {self.writer.number.base} {a}, {b}")

    def equal(self, a: str, b: str) -> str:
        """Compare: a = b."""
        return self._part.equal(self.high(a), self.high(b))

    def select(self, flag: str, where_true: str, where_false: str) -> str:
        """Choose between two values."""
        if not self.writer.number.pair:
            return self.writer.select(flag, where_true, where_false)
        kind, parts = self.writer.number.name, list[str]()
        for k in (0, 1):
            either = [self.writer.let(f"extractvalue {kind} {x}, {k}") for x in (where_true, where_false)]
            parts.append(self._part.select(flag, *either))
        return self.writer.paired(*parts)

    def abs(self, a: str) -> str:
        """Write |a|."""
        if not self.writer.number.pair:
            return self.writer.intrinsic("fabs", a)
        return self.select(self.less(a, self.zero), self.neg(a), a)

    def greater(self, a: str, b: str) -> str:
        """Write the greater of a and b, b where either is NaN."""
        flag = self.writer.let(f"fcmp ult {self.writer.number.base} {self.high(a)}, {self.high(b)}")
        return self.select(flag, b, a)

    def both(self, a: str, b: str) -> str:
        """Write a and b, of flags."""
        return self.writer.let(f"and {self.writer.number.flags} {a}, {b}")

    def either(self, a: str, b: str) -> str:
        """Write a or b, of flags."""
        return self.writer.let(f"or {self.writer.number.flags} {a}, {b}")

    def all(self, flags: str) -> str:
        """Return whether a flag is set in every lane."""
        lanes = self.writer.number.lanes
        if lanes == 1:
            return flags
        bits = self.writer.let(f"bitcast <{lanes} x i1> {flags} to i{lanes}")
        return self.writer.let(f"icmp eq i{lanes} {bits}, -1")

    # sums ------------------------------------------------------------------------------------------

    def dot(self, a: Sequence[str], b: Sequence[str]) -> str:
        """Write Σ a_k b_k."""
        total = self.mul(a[0], b[0])
        for left, right in zip(a[1:], b[1:], strict=True):
            total = self.fma(left, right, total)
        return total

    def polynomial(self, x: str, coefficients: Sequence[Fraction]) -> str:
        """Write Σ c_k xᵏ by Horner's rule."""
        total = self.number(coefficients[-1])
        for coefficient in reversed(coefficients[:-1]):
            total = self.fma(total, x, self.number(coefficient))
        return total
