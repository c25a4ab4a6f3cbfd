"""Rolled loops: large programs as loops over operations of one kind.

The force of a chain or of many bodies repeats a few operations thousands of times. Written out, it takes seconds to
compile; here operations that compute the same function of operands of the same kinds form a family, and
each family becomes one loop over arrays, whose operands are found by a stride where the pattern is regular and by
a table where it is not.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from fractions import Fraction

    from canon.kernel.program import Program
    from canon.kernel.writer import Writer

__all__ = ["is_worth_rolling", "write_rolled"]

_REGULAR, _IRREGULAR = 100, 12_000
"""Programs with fewer operations are written out: the compiler then sees every one of them. Irregular ones, which need
tables, run faster written out, and are rolled only where compiling them would take very long."""

_LEAVES = ("input", "time", "constant")

_WRITTEN_OUT = 3
"""Families up to this size are written out."""


@dataclass
class _Family:
    """Operations of one kind on operands of the same families.

    ``members`` are the registers they write; a member's place in the family's array is its position here.
    """

    operation: str
    value: Fraction | None
    operands: tuple[int, ...]
    members: list[int] = field(default_factory=list[int])


def _families(steps: Program) -> tuple[list[_Family], list[tuple[int, int]]]:
    """Return the families, operands' before their users', and each register's family and place in it."""
    found: list[_Family] = []
    number: dict[Any, int] = {}
    family_of: list[int] = []
    operands_of: list[tuple[int, ...]] = []
    for register, (operation, operands, value) in enumerate(steps.instructions):
        if operation in ("add", "mul"):
            operands = tuple(sorted(operands, key=lambda o: family_of[o]))
        kinds = tuple(family_of[o] for o in operands)
        is_time = operation == "input" and value == len(steps.inputs) - 1
        key = (operation, kinds, value if operation == "constant" or is_time else None)
        if key not in number:
            number[key] = len(found)
            found.append(
                _Family("time" if is_time else operation, value if operation == "constant" else None, kinds)
            )
        family_of.append(number[key])
        operands_of.append(operands)
        found[number[key]].members.append(register)
    place = [0] * len(family_of)
    for family in found:
        # In the order of their operands, members tend to read and to be read with a stride.
        if family.operation != "input":
            family.members.sort(key=lambda register: [place[o] for o in operands_of[register]])
        for position, register in enumerate(family.members):
            value = steps.instructions[register].value
            place[register] = int(value) if family.operation == "input" else position
    return found, list(zip(family_of, place, strict=True))


def is_worth_rolling(steps: Program) -> bool:
    """Return whether a program is better written as loops."""
    count = len(steps.instructions)
    if count <= _REGULAR:
        return False
    families, location = _families(steps)
    places = _operand_places(steps, families, location)
    tables = sum(not _is_regular(column) for columns in places for column in columns)
    return count > _IRREGULAR or tables == 0


def write_rolled(w: Writer, steps: Program, state: str, clock: str, take: Callable[[str, str], None]) -> None:
    """Write a program as loops.

    Parameters
    ----------
    w
        The function's writer.
    steps
        The program, a function of (q, p, t).
    state, clock
        The arrays that hold (q, p), and t.
    take
        Writes what is done with an output, given its number and its value; called inside a loop.
    """
    _Rolling(w, steps, state, clock).write(take)


def _operand_places(
    steps: Program, families: Sequence[_Family], location: Sequence[tuple[int, int]]
) -> list[list[list[int]]]:
    """Return, by family and operand, where each member finds the operand in the operand's family."""
    found: list[list[list[int]]] = []
    for family in families:
        columns: list[list[int]] = [[] for _ in family.operands]
        for register in family.members:
            operands = steps.instructions[register].operands
            if family.operation in ("add", "mul"):
                operands = tuple(sorted(operands, key=lambda o: location[o][0]))
            for column, operand in zip(columns, operands, strict=True):
                column.append(location[operand][1])
        found.append(columns)
    return found


def _is_regular(places: Sequence[int]) -> bool:
    return len(places) < 3 or all(b - a == places[1] - places[0] for a, b in itertools.pairwise(places))


@dataclass
class _Loop:
    """Families of one size whose members, one by one, read what the same loop wrote just before, or older arrays."""

    size: int
    families: list[int]


class _Rolling:
    def __init__(self, w: Writer, steps: Program, state: str, clock: str) -> None:
        self.w, self.steps, self.state, self.clock = w, steps, state, clock
        self.families, self.location = _families(steps)
        self.arrays: dict[int, str] = {}
        self.places = _operand_places(steps, self.families, self.location)

    def write(self, take: Callable[[str, str], None]) -> None:
        for loop in self._loops():
            for number in loop.families:
                self.arrays[number] = self.w.array(loop.size)
            if loop.size <= _WRITTEN_OUT:
                for k in range(loop.size):
                    self._members(loop, str(k), k)
            else:
                with self.w.loop(0, loop.size) as k:
                    self._members(loop, k, None)
        for kind in sorted({self.location[register][0] for register in self.steps.outputs}):
            rows = [i for i, register in enumerate(self.steps.outputs) if self.location[register][0] == kind]
            places = [self.location[self.steps.outputs[i]][1] for i in rows]
            with self.w.loop(0, len(rows)) as k:
                take(self._index(rows, k), self._operand(kind, self._index(places, k)))

    def _loops(self) -> list[_Loop]:
        """Put families into as few loops as their dependencies allow."""
        loops: list[_Loop] = []
        loop_of: dict[int, int] = {}
        for number, family in enumerate(self.families):
            if family.operation in _LEAVES:
                continue
            size, earliest = len(family.members), 0
            for operand, places in zip(family.operands, self.places[number], strict=True):
                if operand in loop_of:
                    aligned = places == list(range(size)) and loops[loop_of[operand]].size == size
                    earliest = max(earliest, loop_of[operand] + (not aligned))
            fitting = (k for k in range(earliest, len(loops)) if loops[k].size == size)
            chosen = next(fitting, len(loops))
            if chosen == len(loops):
                loops.append(_Loop(size, []))
            loops[chosen].families.append(number)
            loop_of[number] = chosen
        return loops

    def _members(self, loop: _Loop, k: str, known: int | None) -> None:
        """Write every family's member k; ``known`` is k where it is a number."""
        fresh: dict[int, str] = {}
        for number in loop.families:
            family = self.families[number]
            operands: list[str] = []
            for kind, places in zip(family.operands, self.places[number], strict=True):
                if kind in fresh and (known is None or places[known] == known):
                    operands.append(fresh[kind])
                else:
                    operands.append(
                        self._operand(kind, self._index(places, k) if known is None else str(places[known]))
                    )
            fresh[number] = self.w.operation(family.operation, operands)
            self.w.store(fresh[number], self.arrays[number], k)

    def _operand(self, kind: int, index: str) -> str:
        family = self.families[kind]
        if family.value is not None:
            return self.w.constant(family.value)
        if family.operation == "input":
            return self.w.load(self.state, index)
        if family.operation == "time":
            return self.w.load(self.clock, 0)
        return self.w.load(self.arrays[kind], index)

    def _index(self, places: Sequence[int], k: str) -> str:
        """Write the place that belongs to member k: a stride, or an entry of a table."""
        stride = places[1] - places[0] if len(places) > 1 else 0
        if _is_regular(places):
            if stride == 0:
                return str(places[0])
            scaled = k if stride == 1 else self.w.let(f"mul i64 {k}, {stride}")
            return self.w.let(f"add i64 {scaled}, {places[0]}") if places[0] else scaled
        return self.w.entry(places, k)
