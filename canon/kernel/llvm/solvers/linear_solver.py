"""Linear equations inside compiled loops: LU factorisation with partial pivoting, rows exchanged in place.

Source: G. H. Golub, C. F. Van Loan, Matrix Computations (4th ed., Johns Hopkins 2013), § 3.4.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from canon.kernel.llvm.number_types import SINGLE

if TYPE_CHECKING:
    from collections.abc import Generator, Sequence

    from canon.kernel.llvm.writer import Writer

__all__ = ["LinearSolver", "eliminated", "large_array", "magnitude"]


@contextlib.contextmanager
def large_array(w: Writer, length: int) -> Generator[str]:
    """Reserve memory for so many numbers, too many for the stack, for as long as what is written inside runs."""
    w.declarations.update({"declare ptr @malloc(i64)", "declare void @free(ptr)"})
    size = np.dtype(w.number.dtype).itemsize * (1 + w.number.pair)
    memory = w.let(f"call ptr @malloc(i64 {size * length})")
    yield memory
    w.line(f"call void @free(ptr {memory})")


def magnitude(w: Writer, value: str) -> str:
    """Write the size of a scalar as a double, of singles as a single."""
    if w.number == SINGLE:
        return w.intrinsic("fabs", value)
    as_double = w.as_double(value)
    w.declarations.add("declare double @llvm.fabs.f64(double)")
    return w.let(f"call double @llvm.fabs.f64(double {as_double})")


@dataclass(frozen=True)
class LinearSolver:
    """Writes the factorisation of a matrix in memory, and solutions with it.

    Parameters
    ----------
    w
        What is written to; scalars.
    size
        Rows of the matrix.
    matrix
        Address of its entries, row by row; the factors take their place.
    pivots
        Address of so many integers: the rows that were exchanged.
    """

    w: Writer
    size: int
    matrix: str
    pivots: str

    @property
    def length(self) -> int:
        """Numbers of the matrix in memory."""
        return self.size**2

    @property
    def right_length(self) -> int:
        """Numbers of a right-hand side in memory."""
        return self.size

    def row(self, i: str | int) -> str:
        """Return the address of a row."""
        w = self.w
        return w.at(self.matrix, w.let(f"mul i64 {i}, {self.size}"))

    def _pivot(self, k: str) -> str:
        return self.w.let(f"getelementptr inbounds i64, ptr {self.pivots}, i64 {k}")

    def factorise(self) -> None:
        """Write P A = L U; a singular matrix gives a solution that is not finite."""
        w = self.w
        with w.loop(0, self.size) as k:
            own, after = self.row(k), w.let(f"add i64 {k}, 1")
            self.exchange(k, own, (after, self.size), (0, self.size))
            reciprocal = w.algebra("div", w.constant(Fraction(1)), w.load(own, k))
            with w.loop(after, self.size) as i:
                row = self.row(i)
                share = w.algebra("mul", w.load(row, k), reciprocal)
                w.store(share, row, k)
                back = w.negative(share)
                with w.loop(after, self.size) as j:
                    w.store(w.multiply_add(back, w.load(own, j), w.load(row, j)), row, j)

    def exchange(
        self, k: str, own: str, rows: tuple[str, str | int], columns: tuple[str | int, str | int]
    ) -> None:
        """Write the exchange, in ``columns``, of row k with the one of ``rows`` whose entry in column k is largest."""
        w = self.w
        kind = "float" if w.number == SINGLE else "double"
        largest, place = w.reserve(kind), self._pivot(k)
        w.line(f"store {kind} {magnitude(w, w.load(own, k))}, ptr {largest}")
        w.line(f"store i64 {k}, ptr {place}")
        with w.loop(*rows) as i:
            size, before = magnitude(w, w.load(self.row(i), k)), w.let(f"load {kind}, ptr {largest}")
            larger = w.let(f"fcmp ogt {kind} {size}, {before}")
            w.line(
                f"store {kind} {w.let(f'select i1 {larger}, {kind} {size}, {kind} {before}')}, ptr {largest}"
            )
            held = w.let(f"load i64, ptr {place}")
            w.line(f"store i64 {w.let(f'select i1 {larger}, i64 {i}, i64 {held}')}, ptr {place}")
        other = self.row(w.let(f"load i64, ptr {place}"))
        with w.loop(*columns) as j:
            a, b = w.load(own, j), w.load(other, j)
            w.store(b, own, j)
            w.store(a, other, j)

    def exchange_right(self, k: str, right: str) -> None:
        """Write the exchange of row k of a right-hand side."""
        w = self.w
        other = w.let(f"load i64, ptr {self._pivot(k)}")
        a, b = w.load(right, k), w.load(right, other)
        w.store(b, right, k)
        w.store(a, right, other)

    def divide_back(self, i: str, columns: tuple[str | int, str | int], right: str) -> None:
        """Write the unknown of row i, from those of later ``columns``."""
        w, row = self.w, self.row(i)
        with w.loop(*columns) as j:
            w.store(w.multiply_add(w.negative(w.load(row, j)), w.load(right, j), w.load(right, i)), right, i)
        w.store(w.algebra("div", w.load(right, i), w.load(row, i)), right, i)

    def solve(self, right: str) -> None:
        """Write the solution over the right-hand side at an address."""
        w = self.w
        with w.loop(0, self.size) as k:
            self.exchange_right(k, right)
        with w.loop(0, self.size) as i:
            row = self.row(i)
            with w.loop(0, i) as j:
                w.store(
                    w.multiply_add(w.negative(w.load(row, j)), w.load(right, j), w.load(right, i)), right, i
                )
        with w.loop(0, self.size) as back:
            i = w.let(f"sub i64 {self.size - 1}, {back}")
            self.divide_back(i, (w.let(f"add i64 {i}, 1"), self.size), right)


def eliminated(w: Writer, matrix: list[list[str]], right: Sequence[str]) -> list[str]:
    """Write the solution of equations whose matrix is nearly definite, without exchanging rows.

    Entries that are 0 may be "": nothing is written for them.
    """
    k, rows = len(right), [[*row, x] for row, x in zip(matrix, right, strict=True)]
    inverse: list[str] = []
    for a in range(k):
        inverse.append(w.algebra("div", w.constant(Fraction(1)), rows[a][a]))
        for b in range(a + 1, k):
            if not rows[b][a]:
                continue
            share = w.negative(w.algebra("mul", rows[b][a], inverse[a]))
            for c in range(a + 1, k + 1):
                rows[b][c] = _increased(w, rows[b][c], share, rows[a][c])
    found = [""] * k
    for a in reversed(range(k)):
        total = rows[a][k]
        for c in range(a + 1, k):
            total = _increased(w, total, w.negative(rows[a][c]), found[c]) if rows[a][c] else total
        found[a] = w.algebra("mul", total, inverse[a])
    return found


def _increased(w: Writer, total: str, a: str, b: str) -> str:
    """Write total + a b; a total or a b that is 0 is ""."""
    if not b:
        return total
    return w.multiply_add(a, b, total) if total else w.algebra("mul", a, b)
