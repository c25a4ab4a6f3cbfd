"""Event loop: compiled steps until a function of the state may have crossed zero."""

from __future__ import annotations

import ctypes
import dataclasses
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.loop import compiled_function
from canon.kernel.llvm.number_types import DOUBLE
from canon.kernel.llvm.writer import Writer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.llvm.loop import Loop
    from canon.kernel.llvm.machine_code import MachineCode
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["event_function"]

_REACH = Fraction(4)
"""A g that turns once within a step moves by no more than its slope times the step; so many times that is allowed."""

_POINTER, _INTEGER = ctypes.c_void_p, ctypes.c_int64
_SIGNATURE = (*[_POINTER] * 8, *[_INTEGER] * 2)
_PARAMETERS = ", ".join(
    (
        "ptr %advance, ptr %y, ptr %e, ptr %c, ptr %before_y, ptr %before_e",
        "ptr %kept, ptr %done",
        "i64 %first, i64 %steps",
    )
)


def event_function(
    system: HamiltonEquations,
    values: Sequence[int],
    rates: Sequence[int],
    loop: Loop,
    timed: int | None = None,
) -> MachineCode:
    """Compile ``drive(advance, y, e, c, before_y, before_e, kept, done, first, steps)``.

    It calls the loop's own machine code for one step at a time, so that the motion is bit for bit the one
    without it, and returns after the first step in which some event may have happened: its function g
    changed sign, or g approached zero at the start of the step and recedes at its end, so fast at both that it may
    have reached it. ``before`` has the state from which that step started, ``done`` the number of steps taken
    since step 0.

    Parameters
    ----------
    system
        The equations.
    values, rates
        The nodes of each g and of dg/dt along the motion.
    loop
        A loop for one orbit. ``kept`` has the direction of time, ±1, and for each event the sign that g has
        had last (0: not known yet), dg/dt, positive where g rises in the order of passing, and g.
    timed
        Which component of the state is a time, where one is: the function returns too after the step in which that
        reaches the number that ``kept`` has last, or turns back.
    """
    w = Writer(dataclasses.replace(loop.number, lanes=1))
    size = len(system.inputs) - 1
    d = w.in_numbers(DOUBLE)
    zero, direction = "0.0", d.load("%kept", 0)
    with w.loop("%first", w.let("add i64 %first, %steps")) as step:
        w.copy("%y", "%before_y", size)
        w.copy("%e", "%before_e", loop.carry)
        w.line(f"call void %advance(ptr %y, ptr %e, ptr %c, i64 {step}, i64 1, i64 1)")
        after = w.let(f"add i64 {step}, 1")
        w.line(f"store i64 {after}, ptr %done")
        state = [w.load("%y", i) for i in range(size)]
        if loop.compensated:
            state = [w.algebra("add", y, w.load("%e", i)) for i, y in enumerate(state)]
        clock = w.multiply_add(w.whole(after), w.load("%c", 1), w.load("%c", 0))
        found = [w.as_double(x) for x in w.program(system.program((*values, *rates)), [*state, clock])]
        length = d.algebra("mul", direction, w.as_double(w.load("%c", 1)))
        far = d.algebra("mul", length, d.constant(_REACH))
        flag = "false"
        for i, (value, rate) in enumerate(zip(found[: len(values)], found[len(values) :], strict=True)):
            side, before, old = (d.load("%kept", 1 + 3 * i + k) for k in range(3))
            passed = d.algebra("mul", direction, rate)
            d.store(passed, "%kept", 2 + 3 * i)
            d.store(value, "%kept", 3 + 3 * i)
            crossed = d.less(d.algebra("mul", side, value), zero)
            came, goes = d.algebra("mul", side, before), d.algebra("mul", side, passed)
            dipped = "true"
            for distance, slope in ((old, d.negative(came)), (value, goes)):
                reach = d.algebra("mul", slope, far)
                near = d.less(d.algebra("mul", side, distance), reach)
                dipped = w.let(f"and i1 {dipped}, {w.let(f'and i1 {d.less(zero, slope)}, {near}')}")
            unknown = d.equal(side, zero)
            for each in (crossed, dipped, unknown):
                flag = w.let(f"or i1 {flag}, {each}")
        if timed is not None:
            goal = d.load("%kept", 1 + 3 * len(values))
            for each in _clock_flags(w, d, state[timed], timed, goal, compensated=loop.compensated):
                flag = w.let(f"or i1 {flag}, {each}")
        w.leave_if(flag)
    return compiled_function(w, "drive", _PARAMETERS, _SIGNATURE)


def _clock_flags(
    w: Writer, d: Writer, now: str, row: int, goal: str, *, compensated: bool
) -> tuple[str, str]:
    """Return whether a component that is a time has reached a goal, and whether it has turned back in the step."""
    direction = d.load("%kept", 0)
    ahead, there = (d.algebra("mul", direction, x) for x in (w.as_double(now), goal))
    passed = w.algebra("sub", w.load("%y", row), w.load("%before_y", row))
    if compensated:
        rest = w.algebra("sub", w.load("%e", row), w.load("%before_e", row))
        passed = w.algebra("add", passed, rest)
    turned = d.less(d.algebra("mul", direction, w.as_double(passed)), "0.0")
    return w.let(f"fcmp oge double {ahead}, {there}"), turned
