"""Linear motion: the flow of a quadratic Hamiltonian is multiplication by exp(tL).

What is added to a state is (exp(tL) − 1) y. The matrix is known to 60 digits, as balls that hold it; each entry enters
as a sum of two doubles, for an entry rounded to one would be off in the same direction in every step.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from canon.kernel.llvm.loop import increase
from canon.kernel.program.commutator import commutator_force

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.llvm.number_types import MachineType
    from canon.kernel.llvm.writer import Writer
    from canon.kernel.solvable.lanes import StepLengths
    from canon.kernel.solvable.solvable_parts import Quadratic

__all__ = ["LinearMotion", "flow_matrices"]

_BITS = 280
"""Bits that matrices are computed with; their balls grow with exp |tL|."""

_ENOUGH = Fraction(1, 2**130)
"""Radius of a ball that leaves both doubles of an entry right."""


class LinearMotion:
    """The motion of H₀ quadratic in (q, p), with kicks by a function of q.

    Parameters
    ----------
    w
        Where the loop is written.
    part
        The quadratic part, and the rest.
    matrices
        Where in c the matrices start: for each pair exp(tL) − 1 by columns, and after it what rounding took.
    compensated
        Whether round-off is carried along.
    """

    def __init__(self, w: Writer, part: Quadratic, matrices: int, *, compensated: bool) -> None:
        self.w, self.part, self.matrices, self.compensated = w, part, matrices, compensated
        self.size = len(part.field)
        self.words = 2 * self.size
        self.state = w.array(self.words)
        self.carried = w.at(self.state, self.size) if compensated else ""
        self.moved, self.rest, self.slip = (w.array(self.size) for _ in range(3))

    def enter(self, y: str, e: str) -> None:
        """Write the working state: y and e themselves."""
        self.w.copy(y, self.state, self.size)
        if self.compensated:
            self.w.copy(e, self.carried, self.size)

    def leave(self, y: str, e: str) -> None:
        """Write y and e."""
        self.w.copy(self.state, y, self.size)
        if self.compensated:
            self.w.copy(self.carried, e, self.size)

    def count(self, steps: str) -> None:
        """Do nothing: all moves with the steps."""

    def move(self, times: StepLengths, pair: str) -> None:
        """Write a kick and then the flow of H₀."""
        self._kick(times)
        self._flow(pair)

    def _kick(self, times: StepLengths) -> None:
        """Write p ← p − t ∂H₁/∂q, and with a commutator + 2γτ³ ∂(½ Σ A_ij ∂_iH₁ ∂_jH₁)/∂q, A = ∂²H₀/∂p²."""
        w, n, rest = self.w, self.size // 2, self.part.rest
        arguments = [*(w.load(self.state, i) for i in range(n)), *["poison"] * (n + 1)]
        changes = [(rest.force, times.kick)]
        if times.commutator:
            changes.append((commutator_force(rest, self.inverse_mass), times.commutator))
        for nodes, time in changes:
            for i, force in enumerate(w.program(rest.program(nodes), arguments)):
                increase(w, self.state, self.carried, str(n + i), time, force)

    @property
    def inverse_mass(self) -> list[tuple[Fraction, ...]]:
        """∂²H₀/∂p²."""
        n = self.size // 2
        return [row[n:] for row in self.part.field[:n]]

    def flow_matrix(self, pair: str) -> tuple[str, str]:
        """Return where exp(tL) − 1 of a pair lies, and what rounding took from it."""
        w, entries = self.w, self.size**2
        offset = w.let(f"add i64 {w.let(f'mul i64 {pair}, {2 * entries}')}, {self.matrices}")
        matrix = w.at("%c", offset)
        return matrix, w.at(matrix, entries)

    def _flow(self, pair: str) -> None:
        """Write y ← y + (exp(tL) − 1) y, column by column."""
        w, n = self.w, self.size
        matrix, lost = self.flow_matrix(pair)
        zero = w.constant(Fraction(0))
        with w.loop(0, n) as i:
            w.store(zero, self.moved, i)
            w.store(zero, self.rest, i)
        with w.loop(0, n) as j:
            column = w.let(f"mul i64 {j}, {n}")
            main, small = w.at(matrix, column), w.at(lost, column)
            number = w.load(self.state, j)
            carried = w.load(self.carried, j) if self.compensated else zero
            with w.loop(0, n) as i:
                rest = w.multiply_add(w.load(small, i), number, w.load(self.rest, i))
                if self.compensated:
                    self._add_exactly(w.load(main, i), number, i)
                    rest = w.algebra("add", rest, w.load(self.slip, i))
                    rest = w.multiply_add(w.load(main, i), carried, rest)
                else:
                    w.store(w.multiply_add(w.load(main, i), number, w.load(self.moved, i)), self.moved, i)
                w.store(rest, self.rest, i)
        with w.loop(0, n) as i:
            if self.compensated:
                self._take(i)
            else:
                total = w.algebra("add", w.load(self.moved, i), w.load(self.rest, i))
                increase(w, self.state, "", i, w.constant(Fraction(1)), total)

    def _add_exactly(self, a: str, b: str, i: str) -> None:
        """Write moved_i + a b, and what rounding takes from product and sum into slip_i."""
        w = self.w
        product = w.algebra("mul", a, b)
        total, lost = _sum(w, w.load(self.moved, i), product)
        w.store(total, self.moved, i)
        slip = w.multiply_add(a, b, w.negative(product))
        w.store(w.algebra("add", slip, lost), self.slip, i)

    def _take(self, i: str) -> None:
        """Write y_i + e_i + moved_i + rest_i as a sum of two doubles.

        Rounding moved + rest to one double would be enough for random errors, but these, functions of a state that
        returns, add up to a drift of a quarter of a unit in each step.
        """
        w = self.w
        total, lost = _sum(w, w.load(self.state, i), w.load(self.moved, i))
        small = w.algebra("add", w.load(self.carried, i), w.algebra("add", w.load(self.rest, i), lost))
        new, carried = _sum(w, total, small)
        w.store(new, self.state, i)
        w.store(carried, self.carried, i)


def _sum(w: Writer, a: str, b: str) -> tuple[str, str]:
    """Return a + b and what its rounding takes (D. E. Knuth's two-sum)."""
    total = w.algebra("add", a, b)
    back = w.algebra("sub", total, a)
    lost = w.algebra("add", w.algebra("sub", a, w.algebra("sub", total, back)), w.algebra("sub", b, back))
    return total, lost


def flow_matrices(part: Quadratic, number: MachineType, times: Sequence[Fraction]) -> list[Fraction]:
    """Return exp(tL) − 1 for each time, by columns, each as numbers of the loop and then what they leave.

    Raises
    ------
    ArithmeticError
        A matrix is not known to 130 bits: the times are too long for it.
    """
    known = dict[Fraction, list[Fraction]]()
    for time in times:
        if time not in known:
            known[time] = _matrix(part, number, time)
    return [entry for time in times for entry in known[time]]


def _matrix(part: Quadratic, number: MachineType, time: Fraction) -> list[Fraction]:
    from flint import arb, arb_mat, ctx, fmpq  # pyright: ignore[reportMissingTypeStubs]

    n = len(part.field)
    with ctx.workprec(_BITS):
        scaled = [
            [arb(fmpq((x * time).numerator, (x * time).denominator)) for x in row] for row in part.field
        ]
        found = arb_mat(scaled).exp()
        exact = [_exact(found[i, j]) - (i == j) for j in range(n) for i in range(n)]
    high = [number.nearest(value) for value in exact]
    return high + [number.nearest(value - first) for value, first in zip(exact, high, strict=True)]


def _exact(ball: Any) -> Fraction:
    mantissa, exponent = ball.mid().man_exp()
    radius_mantissa, radius_exponent = ball.rad().man_exp()
    radius = Fraction(int(radius_mantissa)) * Fraction(2) ** int(radius_exponent)
    if not radius < _ENOUGH:
        raise ArithmeticError("exp(tL) of the quadratic part is not known to 130 bits: take a smaller step")
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
