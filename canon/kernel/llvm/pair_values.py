"""Values and slopes of a sum over pairs of rows, compiled: the second rows of the pairs lie side by side in SIMD lanes.

Half a million pairs, or fifty million, are no work for arrays that NumPy makes and reads once an operation. What the
values are wanted for is the error of a motion, so they are computed in numbers that the caller chooses: double-double
where the states are doubles.
"""

from __future__ import annotations

import contextlib
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
    from collections.abc import Generator

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
        return _value_code(self.sums, program(self.sums.graph, [self.sums.node], self._inputs), self._number)

    @cached_property
    def _slopes(self) -> MachineCode:
        return _slopes_code(self.sums, program(self.sums.graph, self.sums.slopes, self._inputs), self._number)

    @property
    def _inputs(self) -> tuple[Symbol, ...]:
        return (*self.sums.slots, self.t)


@dataclass(frozen=True)
class _FirstRow:
    """The registers that hold the first row of pairs: its number, its slots in every lane, and the time."""

    i: str
    slots: list[str]
    time: str
    blocks: str


def _value_code(sums: RepeatedTerms, term: Program, number: MachineType) -> MachineCode:
    """Compile ``add_up`` so that ``out`` gets lanes of Σ f and Σ |f|."""
    v = Writer(number)
    totals = [v.array(1) for _ in range(2)]
    for k, total in enumerate(totals):
        v.store(v.load("%out", k), total, 0)
    with _first_rows(v, len(sums.columns)) as first, _pairs_of(v, first, term) as (_, found):
        for total, x in zip(totals, (*found, v.operation("Abs", found)), strict=True):
            _add(v, x, total, 0)
    for k, total in enumerate(totals):
        v.store(v.load(total, 0), "%out", k)
    return _function(v)


def _slopes_code(sums: RepeatedTerms, term: Program, number: MachineType) -> MachineCode:
    """Compile ``add_up`` so that ``out`` gets slopes: by first rows one by one, then by second rows in blocks."""
    v = Writer(number)
    moving = len(sums.moving)
    totals = [v.array(1) for _ in range(moving)]
    of_second = v.let(f"mul i64 %count, {moving}")
    with _first_rows(v, len(sums.columns)) as first:
        for total in totals:
            v.store(v.constant(_NOTHING), total, 0)
        with _pairs_of(v, first, term) as (block, found):
            for k, (x, y) in enumerate(zip(found[:moving], found[moving:], strict=True)):
                _add(v, x, totals[k], 0)
                _add(v, y, "%out", v.let(f"add i64 {of_second}, {_place(v, k, first.blocks, block)}"))
        for k, total in enumerate(totals):
            v.store(v.load(total, 0), "%out", _place(v, k, "%count", first.i))
    return _function(v)


@contextlib.contextmanager
def _first_rows(v: Writer, width: int) -> Generator[_FirstRow]:
    """Repeat what is written inside for each first row of a pair, from %first to %last − 1."""
    w, lanes = v.side_by_side(1), v.number.lanes
    blocks = w.let(f"sdiv i64 {w.let(f'add i64 %count, {lanes - 1}')}, {lanes}")
    time = v.splat(w.load("%alone", 0))
    with w.loop("%first", "%last") as i:
        places = [w.let(f"add i64 {_place(v, k, '%count', i)}, 1") for k in range(width)]
        yield _FirstRow(i, [v.splat(w.load("%alone", place)) for place in places], time, blocks)


@contextlib.contextmanager
def _pairs_of(v: Writer, first: _FirstRow, term: Program) -> Generator[tuple[str, list[str]]]:
    """Repeat what is written inside for blocks of second rows, and yield the block and the term's values, 0 elsewhere.

    The first of the numbers in a block are those of its rows: behind the first row are those that are larger.
    """
    number = v.whole(first.i)
    with v.loop(v.let(f"sdiv i64 {first.i}, {v.number.lanes}"), first.blocks) as block:
        of_rows, *slots = (
            v.load("%rows", _place(v, k, first.blocks, block)) for k in range(len(first.slots) + 1)
        )
        is_behind = v.less(number, of_rows)
        yield block, [_where(v, is_behind, x) for x in v.program(term, [*first.slots, *slots, first.time])]


def _place(v: Writer, k: int, length: str, at: str) -> str:
    """Return the index of an element in the k-th of arrays of one length."""
    return v.let(f"add i64 {v.let(f'mul i64 {length}, {k}')}, {at}")


def _add(v: Writer, x: str, array: str, at: str | int) -> None:
    v.store(v.algebra("add", v.load(array, at), x), array, at)


def _function(v: Writer) -> MachineCode:
    """Compile ``add_up(rows, alone, count, first, last, out)`` for pairs whose first row is one of first … last − 1.

    ``rows`` holds the numbers of the rows and then slot after slot, in blocks of lanes; ``alone`` the time and then
    slot after slot, one by one.
    """
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
