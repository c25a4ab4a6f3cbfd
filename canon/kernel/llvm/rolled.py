"""Rolled loops: large programs as loops over operations of one kind.

The force of a chain or of many bodies repeats a few operations thousands of times. Written out, it takes seconds to
compile; here operations that compute the same function of operands of the same kinds form a family, and
each family becomes one loop over arrays, whose operands are found by a stride where the pattern is regular and by
a table where it is not. Writing to memory is what such loops spend their time on, so loops are run together: of
members k of the same size, of a chain's bonds k + 1 and the forces between bonds k and k + 1, whose last bond stays in
a register; and what few others read of such a family is computed again.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from canon.kernel.program.operation_families import LEAVES, families_of_program, has_stride

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from canon.kernel.llvm.writer import Writer
    from canon.kernel.program.operation_families import Families
    from canon.kernel.program.program import Program

__all__ = ["is_worth_rolling", "write_rolled"]

_REGULAR, _BESIDE, _IRREGULAR = 100, 16, 12_000
"""Programs with fewer operations are written out: the compiler then sees every one of them. Irregular ones, which need
tables, run faster written out, and are rolled only where compiling them would take very long."""

_WRITTEN_OUT = 3
"""Families up to this size are written out."""

_CHEAP, _AGAIN = ("add", "sub", "mul", "neg"), 16
"""What is computed again rather than read from memory, and up to how many operations."""


def is_worth_rolling(steps: Program, beside: Callable[[], Program] | None = None) -> bool:
    """Return whether a program is better written as loops.

    A short one is where one beside it is: of arrays that loops work on, nothing is then kept in registers. That one may
    be very long, and is asked for only where it decides.
    """
    count = len(steps.instructions)
    if count <= _BESIDE:
        return False
    if count <= _REGULAR and not (beside is not None and is_worth_rolling(beside())):
        return False
    tables = sum(
        not has_stride(column) for columns in families_of_program(steps).places for column in columns
    )
    return count > _IRREGULAR or tables == 0


def write_rolled(
    w: Writer, steps: Families, state: str, clock: str, take: Callable[[str, str], None]
) -> None:
    """Write families of operations as loops.

    Parameters
    ----------
    w
        The function's writer.
    steps
        The families, functions of (q, p, t).
    state, clock
        The arrays that hold (q, p), and t.
    take
        Writes what is done with an output, given its number and its value; called inside a loop.
    """
    _Rolling(w, steps, state, clock).write(take)


@dataclass
class _Loop:
    """Families of one size whose members, one by one, read what the same loop wrote just before, or older arrays.

    ``after`` are families with one member less that read members k and k + 1 of these: they run one member behind.
    """

    size: int
    families: list[int]
    after: list[int] = field(default_factory=list[int])


class _Rolling:
    def __init__(self, w: Writer, steps: Families, state: str, clock: str) -> None:
        self.w, self.state, self.clock = w, state, clock
        self.families, self.places, self.outputs = steps.families, steps.places, steps.outputs
        self.loops = self._together(self._separate())
        self.arrays = {kind: w.array(len(self.families[kind].members)) for kind in sorted(self._kept())}

    def write(self, take: Callable[[str, str], None]) -> None:
        for loop in self.loops:
            if loop.size <= _WRITTEN_OUT:
                for k in range(loop.size):
                    self._members(loop.families, str(k), k, {}, take)
            elif loop.after:
                self._write_one_behind(loop, take)
            else:
                with self.w.loop(0, loop.size) as k:
                    self._members(loop.families, k, None, {}, take)
        for kind, (rows, places) in self.outputs.items():
            if not self._is_taken_at_once(kind):
                with self.w.loop(0, len(rows)) as k:
                    take(self._index(rows, k), self._operand(kind, self._index(places, k)))

    def _write_one_behind(self, loop: _Loop, take: Callable[[str, str], None]) -> None:
        """Write member k + 1 of a loop's families and member k of those after it, which reads members k and k + 1."""
        w = self.w
        last = {number: w.array(1) for number in self._read_by(loop.after) & set(loop.families)}

        def keep(fresh: dict[int, str]) -> None:
            for number, array in last.items():
                w.store(fresh[number], array, 0)

        keep(self._members(loop.families, "0", None, {}, take))
        with w.loop(0, loop.size - 1) as k:
            older = {(number, 0): w.load(array, 0) for number, array in last.items()}
            fresh = self._members(loop.families, w.let(f"add i64 {k}, 1"), None, {}, take)
            newer = {(number, 1): fresh[number] for number in last}
            self._members(loop.after, k, None, {**older, **newer}, take)
            keep(fresh)

    # loops ---------------------------------------------------------------------------------------

    def _separate(self) -> list[_Loop]:
        """Put families into as few loops as their dependencies allow."""
        loops: list[_Loop] = []
        loop_of: dict[int, int] = {}
        for number, family in enumerate(self.families):
            if family.operation in LEAVES:
                continue
            size, earliest = len(family.members), 0
            for operand, places in zip(family.operands, self.places[number], strict=True):
                if operand in loop_of:
                    aligned = places == range(size) and loops[loop_of[operand]].size == size
                    earliest = max(earliest, loop_of[operand] + (not aligned))
            fitting = (k for k in range(earliest, len(loops)) if loops[k].size == size)
            chosen = next(fitting, len(loops))
            if chosen == len(loops):
                loops.append(_Loop(size, []))
            loops[chosen].families.append(number)
            loop_of[number] = chosen
        return loops

    def _together(self, loops: list[_Loop]) -> list[_Loop]:
        """Run a loop one behind another that it reads two neighbours of."""
        done: list[_Loop] = []
        for loop in loops:
            read = self._read_by(loop.families) - set(loop.families)
            sources = [k for k, each in enumerate(done) if read & {*each.families, *each.after}]
            before = done[sources[-1]] if sources else None
            if before is not None and not before.after and self._is_one_behind(loop, before):
                before.after.extend(loop.families)
            else:
                done.append(loop)
        return done

    def _is_one_behind(self, loop: _Loop, before: _Loop) -> bool:
        if before.size <= _WRITTEN_OUT + 1 or loop.size != before.size - 1:
            return False
        return all(
            places[0] in (0, 1) and places == range(places[0], places[0] + loop.size)
            for number in loop.families
            for operand, places in zip(self.families[number].operands, self.places[number], strict=True)
            if operand in before.families
        )

    def _read_by(self, families: Sequence[int]) -> set[int]:
        """Return the families, leaves aside, that some families read."""
        return {
            operand
            for number in families
            for operand in self.families[number].operands
            if self.families[operand].operation not in LEAVES
        }

    # what lies in memory -------------------------------------------------------------------------

    def _is_taken_at_once(self, kind: int) -> bool:
        """Return whether every member of a family is one output, in order: then none waits for the others."""
        family = self.families[kind]
        return family.operation not in LEAVES and self.outputs[kind][1] == range(len(family.members))

    def _kept(self) -> set[int]:
        """Return the families that are read from memory: by other loops, or as outputs later.

        Few members of a family that costs little are computed again instead.
        """
        kept = {kind for kind in self.outputs if not self._is_taken_at_once(kind)}
        for loop in self.loops:
            own = {*loop.families, *loop.after}
            others = self._read_by(sorted(own)) - own
            kept |= others if loop.size > _WRITTEN_OUT else {each for each in others if self._is_dear(each)}
        return {kind for kind in kept if self.families[kind].operation not in LEAVES}

    def _is_dear(self, number: int) -> bool:
        """Return whether members are better read than computed again: there are few, or functions in them."""
        (own,) = (
            {*loop.families, *loop.after} for loop in self.loops if number in (*loop.families, *loop.after)
        )
        needed, waiting = set[int](), [number]
        while waiting:
            each = waiting.pop()
            if each not in needed:
                needed.add(each)
                waiting.extend(self._read_by([each]) & own)
        few = len(self.families[number].members) <= _WRITTEN_OUT
        return few or len(needed) > _AGAIN or any(self.families[k].operation not in _CHEAP for k in needed)

    # members -------------------------------------------------------------------------------------

    def _members(
        self,
        families: Sequence[int],
        k: str,
        known: int | None,
        near: Mapping[tuple[int, int], str],
        take: Callable[[str, str], None],
    ) -> dict[int, str]:
        """Write every family's member k; ``known`` is k where it is a number, ``near`` holds members k and k + 1."""
        fresh: dict[int, str] = {}
        again: dict[tuple[int, int], str] = {}
        for number in families:
            family = self.families[number]
            operands: list[str] = []
            for kind, places in zip(family.operands, self.places[number], strict=True):
                place = places[0] if known is None else places[known]
                if (kind, place) in near:
                    operands.append(near[kind, place])
                elif kind in fresh and (known is None or place == known):
                    operands.append(fresh[kind])
                elif known is None:
                    operands.append(self._operand(kind, self._index(places, k)))
                else:
                    operands.append(self._again(kind, place, again))
            fresh[number] = self.w.operation(family.operation, operands)
            if number in self.arrays:
                self.w.store(fresh[number], self.arrays[number], k)
            if number in self.outputs and self._is_taken_at_once(number):
                take(self._index(self.outputs[number][0], k), fresh[number])
        return fresh

    def _again(self, kind: int, place: int, done: dict[tuple[int, int], str]) -> str:
        """Read a member whose place is known, or compute it again where it is not in memory."""
        family = self.families[kind]
        if family.operation in LEAVES or kind in self.arrays:
            return self._operand(kind, str(place))
        if (kind, place) not in done:
            operands = [
                self._again(operand, places[place], done)
                for operand, places in zip(family.operands, self.places[kind], strict=True)
            ]
            done[kind, place] = self.w.operation(family.operation, operands)
        return done[kind, place]

    def _operand(self, kind: int, index: str) -> str:
        family = self.families[kind]
        if family.value is not None:
            return self.w.constant(family.value)
        if family.operation == "input":
            return self.w.load(self.state, index)
        if family.operation == "time":
            return self.w.load(self.clock, 0)
        if family.operation == "numbers":
            return self.w.number_table(family.numbers)(index)
        return self.w.load(self.arrays[kind], index)

    def _index(self, places: Sequence[int], k: str) -> str:
        """Write the place that belongs to member k: a stride, or an entry of a table."""
        stride = places[1] - places[0] if len(places) > 1 else 0
        if has_stride(places):
            if stride == 0:
                return str(places[0])
            scaled = k if stride == 1 else self.w.let(f"mul i64 {k}, {stride}")
            return self.w.let(f"add i64 {scaled}, {places[0]}") if places[0] else scaled
        return self.w.entry(places, k)
