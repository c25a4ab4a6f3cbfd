"""Values and slopes of a sum over pairs of rows, compiled: the second rows of the pairs lie side by side in SIMD lanes.

Half a million pairs, or fifty million, are no work for arrays that NumPy makes and reads once an operation. What the
values are wanted for is the error of a motion, so they are computed in numbers that the caller chooses: double-double
where the states are doubles.
"""

from __future__ import annotations

import ctypes
import dataclasses
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.cached_property import cached_property
from canon.kernel.llvm.loop import compiled_function
from canon.kernel.llvm.machine_code import simd_bytes
from canon.kernel.llvm.number_types import double_pair
from canon.kernel.llvm.writer import Writer
from canon.kernel.program.program import program

if TYPE_CHECKING:
    import numpy.typing as npt
    from sympy import Symbol

    from canon.array import Array
    from canon.kernel.llvm.machine_code import MachineCode
    from canon.kernel.llvm.number_types import MachineType
    from canon.kernel.program.program import Program
    from canon.kernel.program.repeated.repeated_terms import RepeatedTerms

__all__ = ["CompiledPairs", "can_be_compiled"]

_AT_ONCE = 1 << 24
"""Pairs that one call adds up: between calls Python hears of interruptions."""

_KNOWN = {"input", "constant", "add", "sub", "mul", "div", "neg", "sqrt", "exp", "log", "pow"}
"""Operations that all numbers have, in every range."""

_NOTHING = Fraction(0)

_POINTER, _INTEGER = ctypes.c_void_p, ctypes.c_int64


def can_be_compiled(sums: RepeatedTerms) -> bool:
    """Return whether a sum is one over pairs whose term has only operations that double-double numbers have too."""
    if not sums.pairs:
        return False
    others = sums.graph.symbols(sums.node).difference(sums.slots)
    term = program(sums.graph, [sums.node, *sums.slopes], (*sums.slots, *others))
    return {operation for operation, _, _ in term.instructions} <= _KNOWN


@dataclass(frozen=True, eq=False)
class CompiledPairs:
    """A sum over pairs of rows, and its slopes, as functions of the state.

    Parameters
    ----------
    sums
        The sum.
    t
        The symbol of the time.
    scalar
        The numbers to compute in: doubles, or double-double.
    """

    sums: RepeatedTerms
    t: Symbol
    scalar: MachineType

    def value_and_size(self, state: npt.NDArray[Any], time: Any) -> tuple[Any, Any]:
        """Return the sum and the sum of the terms' absolute values at one state, shape (2n,)."""
        out = np.zeros(2 * self._numbers)
        self._add_up(self._value, state, time, out)
        total, size = self._lanes(out).sum(axis=1)
        return total, size

    def slopes(self, state: npt.NDArray[Any], time: Any) -> npt.NDArray[Any]:
        """Return the sum's derivatives by the variables of one state, shape (2n,), in the same shape."""
        count, moving = self.sums.count, len(self.sums.moving)
        out = np.zeros(moving * (count + self._blocks) * self._numbers)
        self._add_up(self._slopes, state, time, out)
        lanes = self._lanes(out)
        of_first = lanes[: moving * count].sum(axis=1).reshape(moving, count)
        of_second = lanes[moving * count :].reshape(moving, -1)[:, :count]
        found = np.zeros_like(state)
        for k, slope in zip(self.sums.moving, of_first + of_second, strict=True):
            np.add.at(found, np.asarray(self.sums.columns[k]), slope)
        return found

    @property
    def _number(self) -> MachineType:
        return dataclasses.replace(self.scalar, lanes=simd_bytes() // 8)

    @property
    def _numbers(self) -> int:
        """The doubles that lanes of numbers consist of."""
        return self._number.lanes * (1 + self._number.pair)

    @property
    def _blocks(self) -> int:
        return -(-self.sums.count // self._number.lanes)

    def _lanes(self, out: Array) -> npt.NDArray[np.longdouble]:
        high, low = self._number.unpacked(out)
        return high.astype(np.longdouble) + low

    def _add_up(self, code: MachineCode, state: npt.NDArray[Any], time: Any, out: Array) -> None:
        count, blocks, lanes = self.sums.count, self._blocks, self._number.lanes
        columns = [np.arange(count), *self._columns(state)]
        high = np.array(columns, dtype=np.float64)
        low = np.array([column - h for column, h in zip(columns, high, strict=True)], dtype=np.float64)
        begun = np.float64(time)
        alone = self.scalar.packed(
            np.append(begun, high[1:]), np.append(np.float64(time - begun), low[1:])
        )  # the time, then slot after slot
        filled = [
            np.concatenate([x, x[:, :1].repeat(blocks * lanes - count, axis=1)], axis=1) for x in (high, low)
        ]
        filled[0][0, count:] = -1.0  # no row: behind none
        rows = self._number.packed(*filled)
        for first in range(0, count, at_once := max(1, _AT_ONCE // count)):
            last = min(count, first + at_once)
            code.call(rows.ctypes.data, alone.ctypes.data, count, first, last, out.ctypes.data)

    def _columns(self, state: npt.NDArray[Any]) -> list[npt.NDArray[Any]]:
        moving = self.sums.moving
        return [
            state[np.asarray(column)] if k in moving else self._fixed[k]
            for k, column in enumerate(self.sums.columns)
        ]

    @cached_property
    def _fixed(self) -> dict[int, npt.NDArray[np.longdouble]]:
        """The columns of numbers, by slot."""
        return {
            k: np.array([np.longdouble(a) + b for a, b in map(double_pair, column)], dtype=np.longdouble)
            for k, column in enumerate(self.sums.columns)
            if isinstance(column, tuple)
        }

    @cached_property
    def _value(self) -> MachineCode:
        return _compiled(
            self.sums, program(self.sums.graph, [self.sums.node], self._inputs), self._number, slopes=False
        )

    @cached_property
    def _slopes(self) -> MachineCode:
        return _compiled(
            self.sums, program(self.sums.graph, self.sums.slopes, self._inputs), self._number, slopes=True
        )

    @property
    def _inputs(self) -> tuple[Symbol, ...]:
        return (*self.sums.slots, self.t)


def _compiled(sums: RepeatedTerms, term: Program, number: MachineType, *, slopes: bool) -> MachineCode:
    """Compile ``add_up(rows, alone, count, first, last, out)`` for pairs whose first row is one of first … last − 1.

    ``rows`` holds the numbers of the rows and then slot after slot, in blocks of lanes; ``alone`` the time and then
    slot after slot, one by one. ``out`` gets lanes of Σ f and Σ |f|; or of slopes, for each variable of a row, by first
    rows one by one, then by second rows in blocks.
    """
    v = Writer(number)
    w = v.side_by_side(1)
    width, moving = len(sums.columns), len(sums.moving)
    blocks = w.let(f"sdiv i64 {w.let(f'add i64 %count, {number.lanes - 1}')}, {number.lanes}")
    time = v.splat(w.load("%alone", 0))
    here = [v.array(1) for _ in range(moving if slopes else 2)]
    zero = v.constant(_NOTHING)

    def place(of: int, length: str, at: str) -> str:
        return w.let(f"add i64 {w.let(f'mul i64 {length}, {of}')}, {at}")

    if not slopes:
        for k, sum_so_far in enumerate(here):
            v.store(v.load("%out", k), sum_so_far, 0)
    with w.loop("%first", "%last") as i:
        own = [v.splat(w.load("%alone", w.let(f"add i64 {place(k, '%count', i)}, 1"))) for k in range(width)]
        number_of_own = v.whole(i)
        if slopes:
            for sum_so_far in here:
                v.store(zero, sum_so_far, 0)
        with w.loop(w.let(f"sdiv i64 {i}, {number.lanes}"), blocks) as block:
            other = [v.load("%rows", place(k, blocks, block)) for k in range(width + 1)]
            is_behind = v.less(number_of_own, other[0])
            found = [_where(v, is_behind, x) for x in v.program(term, [*own, *other[1:], time])]
            if slopes:
                for k, x in enumerate(found[moving:]):
                    at = w.let(f"add i64 {place(k, blocks, block)}, {w.let(f'mul i64 %count, {moving}')}")
                    v.store(v.algebra("add", v.load("%out", at), x), "%out", at)
            else:
                found.append(v.operation("Abs", found))
            for sum_so_far, x in zip(here, found, strict=False):
                v.store(v.algebra("add", v.load(sum_so_far, 0), x), sum_so_far, 0)
        if slopes:
            for k, sum_so_far in enumerate(here):
                v.store(v.load(sum_so_far, 0), "%out", place(k, "%count", i))
    if not slopes:
        for k, sum_so_far in enumerate(here):
            v.store(v.load(sum_so_far, 0), "%out", k)
    parameters = "ptr noalias %rows, ptr noalias %alone, i64 %count, i64 %first, i64 %last, ptr noalias %out"
    return compiled_function(
        v, "add_up", parameters, (_POINTER, _POINTER, _INTEGER, _INTEGER, _INTEGER, _POINTER)
    )


def _where(v: Writer, flag: str, value: str) -> str:
    """Return a value where a flag is set, else 0, lane by lane."""
    if not v.number.pair:
        return v.select(flag, value, v.number.literal(_NOTHING))
    part = v.in_numbers(dataclasses.replace(v.number, pair=False))
    zero = part.number.literal(_NOTHING)
    parts = [v.let(f"extractvalue {v.number.name} {value}, {k}") for k in (0, 1)]
    return v.paired(*(part.select(flag, x, zero) for x in parts))
