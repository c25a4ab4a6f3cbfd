"""Formulas in LLVM IR that read like formulas: short names for a writer's operations."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from canon.expression.given import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.writer import Writer

__all__ = ["Arithmetic"]


class Arithmetic:
    """Operations on registers of one writer's numbers.

    Parameters
    ----------
    writer
        Where the operations are written; not in pairs of doubles.
    """

    def __init__(self, writer: Writer) -> None:
        self.writer = writer
        self.zero, self.one = writer.constant(Fraction(0)), writer.constant(Fraction(1))

    def number(self, value: Fraction) -> str:
        """Return a constant, the same in all lanes."""
        return self.writer.constant(value)

    def numbers(self, values: Sequence[Fraction]) -> str:
        """Return a constant with a value for each lane."""
        kind = self.writer.number
        if len(values) != kind.lanes:
            raise ValueError(
                f"{counted(len(values), 'number')} for {counted(kind.lanes, 'lane')}; give one each"
            )
        if kind.lanes == 1:
            return kind.literal(values[0])
        one = self.writer.side_by_side(1).number
        return "<" + ", ".join(f"{kind.scalar} {one.literal(value)}" for value in values) + ">"

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
        """Write a · b + c, rounded once."""
        return self.writer.multiply_add(a, b, c)

    def neg(self, a: str) -> str:
        """Write −a."""
        return self.writer.negative(a)

    def sqrt(self, a: str) -> str:
        """Write √a."""
        return self.writer.intrinsic("sqrt", a)

    def abs(self, a: str) -> str:
        """Write |a|."""
        return self.writer.intrinsic("fabs", a)

    def greater(self, a: str, b: str) -> str:
        """Write the greater of a and b, b where either is NaN."""
        flag = self.writer.let(f"fcmp ult {self.writer.number.name} {a}, {b}")
        return self.writer.select(flag, b, a)

    def at_most(self, a: str, b: str) -> str:
        """Compare: a ≤ b, false where either is NaN."""
        return self.writer.let(f"fcmp ole {self.writer.number.name} {a}, {b}")

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
