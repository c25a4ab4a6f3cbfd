"""Statistics loop: observables every so many compiled steps, their changes since the start summed and bounded.

Between two samples of a long run lie millions of steps; what a sample misses, the sums and bounds hold. They are
computed in wider numbers than the state's, so that they are the trajectory's and not the evaluation's.
"""

from __future__ import annotations

import ctypes
import dataclasses
from typing import TYPE_CHECKING

from canon.kernel.llvm.loop import compiled_function
from canon.kernel.llvm.number_types import DOUBLE, DOUBLE_DOUBLE, EXTENDED, MachineType
from canon.kernel.llvm.writer import Writer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.llvm.loop import Loop
    from canon.kernel.llvm.machine_code import MachineCode
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["ENTRIES", "statistics_function", "wide_number"]

ENTRIES = 4
"""Numbers kept of an observable: its value at the start; the sum, the least and the greatest of its changes."""

_POINTER, _INTEGER = ctypes.c_void_p, ctypes.c_int64
_SIGNATURE = (*[_POINTER] * 4, *[_INTEGER] * 4, _POINTER)
_PARAMETERS = ", ".join(
    (
        "ptr %advance, ptr %y, ptr %e, ptr %c",
        "i64 %first, i64 %steps, i64 %blocks, i64 %cadence",
        "ptr noalias %kept",
    )
)


def wide_number(number: MachineType) -> MachineType:
    """Return the numbers in which observables of states in given numbers are watched.

    Doubles are watched with a 64-bit mantissa where the processor has one (x86), x87 numbers in double-double;
    double-double states, for which there is nothing wider, in double-double too.
    """
    if number.pair or number.scalar == "x86_fp80":
        return DOUBLE_DOUBLE
    if number.scalar == "float":
        return DOUBLE
    return EXTENDED if EXTENDED.available() else DOUBLE_DOUBLE


def statistics_function(system: HamiltonEquations, nodes: Sequence[int], loop: Loop) -> MachineCode:
    """Compile ``drive(advance, y, e, c, first, steps, blocks, cadence, kept)``.

    It calls the loop's own machine code and evaluates the nodes after every step whose number is a multiple of
    the cadence, so that the motion is bit for bit the one without it. ``kept`` has :data:`ENTRIES` numbers for
    each node of each orbit.

    Parameters
    ----------
    system
        The equations.
    nodes
        The observables.
    loop
        The loop.
    """
    w = Writer(dataclasses.replace(loop.number, lanes=1))
    end = w.let("add i64 %first, %steps")
    turn = w.let("sdiv i64 %first, %cadence")
    last_turn = w.let(f"sdiv i64 {w.let(f'sub i64 {end}, 1')}, %cadence")
    with w.loop(turn, w.let(f"add i64 {last_turn}, 1")) as k:
        due_from = w.let(f"mul i64 {k}, %cadence")
        due_at = w.let(f"add i64 {due_from}, %cadence")
        done, after = w.greater_integer("%first", due_from), w.lesser_integer(end, due_at)
        steps = w.let(f"sub i64 {after}, {done}")
        w.line(f"call void %advance(ptr %y, ptr %e, ptr %c, i64 {done}, i64 {steps}, i64 %blocks)")
        due = w.let(f"icmp eq i64 {after}, {due_at}")
        times = w.let(f"select i1 {due}, i64 %blocks, i64 0")
        with w.loop(0, times) as block, w.loop(0, loop.number.lanes) as lane:
            _watch(w, system, nodes, loop, block, lane, after)
    return compiled_function(w, "drive", _PARAMETERS, _SIGNATURE)


def _watch(
    w: Writer, system: HamiltonEquations, nodes: Sequence[int], loop: Loop, block: str, lane: str, step: str
) -> None:
    """Evaluate the nodes for one orbit and record their changes."""
    size, lanes = len(system.inputs) - 1, loop.number.lanes
    wide = w.in_numbers(wide_number(loop.number))

    def component(array: str, length: int, i: int) -> str:
        before = w.let(f"add i64 {w.let(f'mul i64 {block}, {length}')}, {i}")
        return wide.widened(_in_lane(w, array, before, lanes, lane), w.number)

    state = [component("%y", size, i) for i in range(size)]
    if loop.compensated:
        state = [wide.algebra("add", y, component("%e", loop.carry, i)) for i, y in enumerate(state)]
    start, h = (_in_lane(w, "%c", i, lanes, lane) for i in (0, 1))
    clock = wide.widened(w.multiply_add(w.whole(step), h, start), w.number)
    orbit = w.let(f"add i64 {w.let(f'mul i64 {block}, {lanes}')}, {lane}")
    own = wide.at("%kept", w.let(f"mul i64 {orbit}, {len(nodes) * ENTRIES}"))
    for k, value in enumerate(wide.program(system.program(nodes), [*state, clock])):
        entry = k * ENTRIES
        change = wide.algebra("sub", value, wide.load(own, entry))
        wide.store(wide.algebra("add", wide.load(own, entry + 1), change), own, entry + 1)
        least, greatest = wide.load(own, entry + 2), wide.load(own, entry + 3)
        wide.store(wide.select(wide.less(change, least), change, least), own, entry + 2)
        wide.store(wide.select(wide.less(greatest, change), change, greatest), own, entry + 3)


def _in_lane(w: Writer, array: str, index: str | int, lanes: int, lane: str) -> str:
    """Read one lane of an array's element: of a pair, lanes of high parts lie before lanes of low ones."""
    part = w.in_numbers(dataclasses.replace(w.number, pair=False))
    first = w.let(f"add i64 {w.let(f'mul i64 {index}, {lanes * (1 + w.number.pair)}')}, {lane}")
    high = part.load(array, first)
    if not w.number.pair:
        return high
    return w.paired(high, part.load(array, w.let(f"add i64 {first}, {lanes}")))
