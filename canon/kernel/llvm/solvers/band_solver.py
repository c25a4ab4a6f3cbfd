"""Linear equations of a band matrix inside compiled loops: LU factorisation with partial pivoting within the band.

Source: G. H. Golub, C. F. Van Loan, Matrix Computations (4th ed., Johns Hopkins 2013), § 4.3.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from canon.kernel.llvm.solvers.linear_solver import LinearSolver

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["BandSolver", "band_memory", "band_order", "is_narrow"]


def band_order(places: Sequence[tuple[int, int]], size: int) -> tuple[list[int], int]:
    """Return where each unknown stands among the others, and how far from the diagonal entries are then at most.

    By the reversed order of E. Cuthill and J. McKee (1969), which numbers neighbours after another.

    Parameters
    ----------
    places
        Rows and columns of the entries that are not zero.
    size
        How many unknowns there are.

    Examples
    --------
    A ring of six, whose ends are neighbours too:

    >>> order, reach = band_order([(i, (i + 1) % 6) for i in range(6)], 6)
    >>> sorted(order), reach
    ([0, 1, 2, 3, 4, 5], 2)
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    rows, columns = np.array([*places, *((j, i) for i, j in places)], dtype=np.int32).reshape(-1, 2).T
    pattern = csr_array((np.ones(len(rows)), (rows, columns)), shape=(size, size))
    order = np.empty(size, dtype=np.int64)
    order[reverse_cuthill_mckee(pattern, symmetric_mode=True)] = np.arange(size)
    return order.tolist(), int(abs(order[rows] - order[columns]).max(initial=0))


def is_narrow(size: int, reach: int) -> bool:
    """Tell whether a band is narrow enough for its longer rows, in which exchanged rows have their place."""
    return 2 * band_memory(size, reach) <= size**2


def band_memory(size: int, reach: int) -> int:
    """Return how many numbers the matrix takes in memory."""
    return (size + reach) * (3 * reach + 1)


@dataclass(frozen=True)
class BandSolver(LinearSolver):
    """Writes the factorisation of a band matrix in memory, and solutions with it.

    Rows hold the columns from ``reach`` before the diagonal to twice as many after it, where exchanged rows reach to.
    Behind the last row there are ``reach`` more of zeros, and behind a right-hand side twice as many numbers, so that
    no end of a loop depends on where it is.

    Parameters
    ----------
    reach
        How far from the diagonal entries are at most.
    """

    reach: int

    @property
    def row_length(self) -> int:
        """Entries of a row in memory."""
        return 3 * self.reach + 1

    @property
    def length(self) -> int:
        """Numbers of the matrix in memory."""
        return band_memory(self.size, self.reach)

    @property
    def right_length(self) -> int:
        """Numbers of a right-hand side in memory."""
        return self.size + 2 * self.reach

    def row(self, i: str | int) -> str:
        """Return an address of a row, from which its columns are counted."""
        w = self.w
        start = w.let(f"mul i64 {i}, {self.row_length - 1}")
        return w.at(self.matrix, w.let(f"add i64 {start}, {self.reach}"))

    def _after(self, k: str, count: int) -> tuple[str, str]:
        return self.w.let(f"add i64 {k}, 1"), self.w.let(f"add i64 {k}, {count + 1}")

    def factorise(self) -> None:
        """Write P A = L U; a singular matrix gives a solution that is not finite."""
        w, reach = self.w, self.reach
        with w.loop(0, self.size) as k:
            (after, rows), (_, columns) = self._after(k, reach), self._after(k, 2 * reach)
            own = self.row(k)
            self.exchange(k, own, (after, rows), (k, columns))
            reciprocal = w.algebra("div", w.constant(Fraction(1)), w.load(own, k))
            with w.loop(after, rows) as i:
                row = self.row(i)
                share = w.algebra("mul", w.load(row, k), reciprocal)
                w.store(share, row, k)
                back = w.negative(share)
                with w.loop(after, columns) as j:
                    w.store(w.multiply_add(back, w.load(own, j), w.load(row, j)), row, j)

    def solve(self, right: str) -> None:
        """Write the solution over the right-hand side at an address."""
        w, reach = self.w, self.reach
        with w.loop(0, self.size) as k:
            self.exchange_right(k, right)
            back = w.negative(w.load(right, k))
            after, rows = self._after(k, reach)
            with w.loop(after, rows) as i:
                w.store(w.multiply_add(back, w.load(self.row(i), k), w.load(right, i)), right, i)
        with w.loop(self.size, self.right_length) as i:
            w.store(w.constant(Fraction(0)), right, i)
        with w.loop(0, self.size) as back:
            i = w.let(f"sub i64 {self.size - 1}, {back}")
            self.divide_back(i, self._after(i, 2 * reach), right)
