"""Section loops: compiled steps that note where orbits in SIMD lanes pass a surface g = 0, and find the places there.

Two functions share a loop's own machine code, so that the motion is bit for bit the one without them. The first steps
one block of lanes and notes the state before every step in which an orbit passes; the second takes what was noted,
whichever orbits it is of, lane by lane and finds the part of the step at which g = 0 by Newton's method in a bracket.
"""

from __future__ import annotations

import ctypes
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.loop import compiled_function
from canon.kernel.llvm.writer import Writer

if TYPE_CHECKING:
    from canon.kernel.llvm.loop import Loop
    from canon.kernel.llvm.machine_code import MachineCode
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["crossing_places_function", "crossing_search_function"]

_POINTER, _INTEGER = ctypes.c_void_p, ctypes.c_int64

_SEARCH_SIGNATURE = (*[_POINTER] * 10, *[_INTEGER] * 4)
_SEARCH_PARAMETERS = ", ".join(
    (
        "ptr %advance, ptr %y, ptr %e, ptr %c, ptr %seen",
        "ptr %noted_y, ptr %noted_e, ptr %noted_g, ptr %noted, ptr %counts",
        "i64 %first, i64 %steps, i64 %room, i64 %wanted",
    )
)
_PLACES_SIGNATURE = (*[_POINTER] * 11, *[_INTEGER] * 2)
_PLACES_PARAMETERS = ", ".join(
    (
        "ptr %advance, ptr %y, ptr %e, ptr %base, ptr %slope, ptr %times, ptr %parts, ptr %sides",
        "ptr %own_y, ptr %own_e, ptr %own_c",
        "i64 %blocks, i64 %coefficients",
    )
)
_ITERATIONS = 60
_LOOSE_BITS = 10
"""The part of a step is known when Newton's step is below so many bits above the last one of the numbers."""


def crossing_search_function(system: HamiltonEquations, g: int, loop: Loop, direction: int) -> MachineCode:
    """Compile ``search(advance, y, e, c, seen, noted_y, noted_e, noted_g, noted, counts, first, steps, room, wanted)``.

    It steps one block of orbits. ``seen`` has g after the last step and after the one before, in lanes. Of each
    passing ``noted_y`` and ``noted_e`` get the state before the step, ``noted_g`` g there and after it, ``noted`` the
    lane and the number of the step. ``counts`` has how many passings each lane has had, then how many places are
    noted, the steps taken since step 0, and how often some g turned so near zero that it may have passed twice within
    a step. It returns after ``steps``, where less than a block of room is left, or where every lane has ``wanted``.

    Parameters
    ----------
    system
        The equations.
    g
        The node of g(q, p, t).
    loop
        The loop; not in double-double.
    direction
        1: passings at which g rises, −1: at which it falls, 0: all.
    """
    w = Writer(loop.number)
    lanes, size = loop.number.lanes, len(system.inputs) - 1
    before_y, before_e = w.array(size), w.array(loop.carry)
    noted_at, done_at, turned_at = lanes, lanes + 1, lanes + 2
    with w.loop("%first", w.let("add i64 %first, %steps")) as step:
        w.copy("%y", before_y, size)
        if loop.compensated:
            w.copy("%e", before_e, size)
        w.line(f"call void %advance(ptr %y, ptr %e, ptr %c, i64 {step}, i64 1, i64 1)")
        after = w.let(f"add i64 {step}, 1")
        _store_integer(w, after, "%counts", done_at)
        clock = w.multiply_add(w.whole(after), w.load("%c", 1), w.load("%c", 0))
        value = w.program(system.program([g]), [*_state(w, loop, "%y", "%e", size), clock])[0]
        last, earlier = w.load("%seen", 0), w.load("%seen", 1)
        w.store(value, "%seen", 0)
        w.store(last, "%seen", 1)
        passed = _passed(w, last, value, direction)
        turned = _turned_near_zero(w, earlier, last, value)
        with w.loop(0, w.let(f"zext i1 {w.any_lane(turned)} to i64")):
            _add_to_integer(w, "%counts", turned_at, "1")
        with w.loop(0, w.let(f"zext i1 {w.any_lane(passed)} to i64")), w.loop(0, lanes) as lane:
            flag = _flag_in_lane(w, passed, lane)
            few = w.let(f"icmp slt i64 {_load_integer(w, '%counts', lane)}, %wanted")
            both = w.let(f"and i1 {flag}, {few}")
            with w.loop(0, w.let(f"zext i1 {both} to i64")):
                place = _load_integer(w, "%counts", noted_at)
                _note(w, loop, (before_y, before_e), (last, value), lane, place, size)
                pair = w.let(f"shl i64 {place}, 1")
                _store_integer(w, lane, "%noted", pair)
                _store_integer(w, step, "%noted", w.let(f"add i64 {pair}, 1"))
                _add_to_integer(w, "%counts", noted_at, "1")
                _add_to_integer(w, "%counts", lane, "1")
        left = w.let(f"sub i64 %room, {_load_integer(w, '%counts', noted_at)}")
        full = w.let(f"icmp slt i64 {left}, {lanes}")
        least: str = _load_integer(w, "%counts", 0)
        for lane in range(1, lanes):
            least = w.lesser_integer(least, _load_integer(w, "%counts", lane))
        enough = w.let(f"icmp sge i64 {least}, %wanted")
        w.leave_if(w.let(f"or i1 {full}, {enough}"))
    return compiled_function(w, "search", _SEARCH_PARAMETERS, _SEARCH_SIGNATURE)


def crossing_places_function(system: HamiltonEquations, g: int, rate: int, loop: Loop) -> MachineCode:
    """Compile ``places(advance, y, e, base, slope, times, parts, sides, own_y, own_e, own_c, blocks, coefficients)``.

    For each lane of each block: y and e are the state before a step and become the one where g = 0; ``times`` has the
    time before the step, ``parts`` a first guess of the part of the step and becomes that part, ``sides`` is −1
    where g rises through zero and 1 where it falls. A step of a part s reads the coefficients base + s·slope.
    ``own_y``, ``own_e`` and ``own_c`` are memory to work in.

    Parameters
    ----------
    system
        The equations.
    g, rate
        The nodes of g(q, p, t) and of dg/dt along the motion.
    loop
        The loop; not in double-double.
    """
    w = Writer(loop.number)
    size = len(system.inputs) - 1
    low_at, high_at, zero, one = w.array(1), w.array(1), w.constant(Fraction(0)), w.constant(Fraction(1))
    near = w.constant(Fraction(1, 2 ** (loop.number.mantissa - _LOOSE_BITS)))
    scalar = w.side_by_side(1)
    steps = system.program([g, rate])
    with w.loop(0, "%blocks") as block:
        y = w.at("%y", w.let(f"mul i64 {block}, {size}"))
        e = w.at("%e", w.let(f"mul i64 {block}, {loop.carry}"))
        time, side = w.load("%times", block), w.load("%sides", block)
        w.store(zero, low_at, 0)
        w.store(one, high_at, 0)
        with w.loop(0, _ITERATIONS):
            part = w.load("%parts", block)
            w.copy(y, "%own_y", size)
            w.copy(e, "%own_e", loop.carry)
            with w.loop(0, "%coefficients") as i:
                base, slope = (w.splat(scalar.load(name, i)) for name in ("%base", "%slope"))
                w.store(w.multiply_add(part, slope, base), "%own_c", i)
            w.store(time, "%own_c", 0)
            w.line("call void %advance(ptr %own_y, ptr %own_e, ptr %own_c, i64 0, i64 1, i64 1)")
            h = w.splat(scalar.load("%slope", 1))
            clock = w.multiply_add(part, h, time)
            found = w.program(steps, [*_state(w, loop, "%own_y", "%own_e", size), clock])
            value = w.algebra("mul", side, found[0])
            slope = w.algebra("mul", w.algebra("mul", side, found[1]), h)
            # side · g falls from above zero to below it.
            ahead = w.less(zero, value)
            low = w.select(ahead, part, w.load(low_at, 0))
            high = w.select(ahead, w.load(high_at, 0), part)
            w.store(low, low_at, 0)
            w.store(high, high_at, 0)
            new = w.algebra("sub", part, w.algebra("div", value, slope))
            middle = w.algebra("mul", w.constant(Fraction(1, 2)), w.algebra("add", low, high))
            inside = w.let(f"and {w.number.flags} {w.less(low, new)}, {w.less(new, high)}")
            at_zero = w.equal(value, zero)
            new = w.select(at_zero, part, w.select(inside, new, middle))
            far = w.less(near, w.intrinsic("fabs", w.algebra("sub", new, part)))
            w.leave_if(w.let(f"xor i1 {w.any_lane(far)}, true"))
            # A lane that is there waits for the others, so that its bits do not depend on theirs.
            w.store(w.select(far, new, part), "%parts", block)
        w.copy("%own_y", y, size)
        w.copy("%own_e", e, loop.carry)
    return compiled_function(w, "places", _PLACES_PARAMETERS, _PLACES_SIGNATURE)


def _state(w: Writer, loop: Loop, y: str, e: str, size: int) -> list[str]:
    state = [w.load(y, i) for i in range(size)]
    if loop.compensated:
        state = [w.algebra("add", part, w.load(e, i)) for i, part in enumerate(state)]
    return state


def _passed(w: Writer, before: str, after: str, direction: int) -> str:
    """Write in which lanes g has passed zero; a zero belongs to the side that it comes to, and NaN passes nothing."""
    zero, flags = w.constant(Fraction(0)), w.number.flags

    def to_or_beyond(low: str, high: str) -> str:
        return w.let(f"or {flags} {w.less(low, high)}, {w.equal(low, high)}")

    found: list[str] = []
    if direction >= 0:
        found.append(w.let(f"and {flags} {w.less(before, zero)}, {to_or_beyond(zero, after)}"))
    if direction <= 0:
        found.append(w.let(f"and {flags} {w.less(zero, before)}, {to_or_beyond(after, zero)}"))
    return found[0] if len(found) == 1 else w.let(f"or {flags} {found[0]}, {found[1]}")


def _turned_near_zero(w: Writer, first: str, second: str, third: str) -> str:
    """Write in which lanes the parabola through three values of one sign passes zero between them."""
    zero = w.constant(Fraction(0))
    rise = w.algebra("sub", third, first)
    bend = w.algebra("sub", w.algebra("add", first, third), w.algebra("add", second, second))
    eight = w.constant(Fraction(8))
    # The vertex second − rise²/(8 bend) has another sign than second, and lies between the three.
    product = w.algebra("mul", w.algebra("mul", eight, bend), second)
    beyond = w.less(product, w.algebra("mul", rise, rise))
    same = w.less(zero, product)
    reach = w.less(w.intrinsic("fabs", rise), w.intrinsic("fabs", w.algebra("add", bend, bend)))
    alike = w.less(zero, w.algebra("mul", first, second))
    alike_too = w.less(zero, w.algebra("mul", second, third))
    flags = w.number.flags
    found = w.let(f"and {flags} {beyond}, {same}")
    for each in (reach, alike, alike_too):
        found = w.let(f"and {flags} {found}, {each}")
    return found


def _note(
    w: Writer,
    loop: Loop,
    state: tuple[str, str],
    values: tuple[str, str],
    lane: str,
    place: str,
    size: int,
) -> None:
    """Write one lane of the state before the step, and of g before and after it, to their place."""
    one, kind = w.side_by_side(1), w.number.name

    def in_lane(value: str) -> str:
        if w.number.lanes == 1:
            return value
        return w.let(f"extractelement {kind} {value}, i64 {lane}")

    row = w.let(f"mul i64 {place}, {size}")
    arrays = [(state[0], "%noted_y"), *([(state[1], "%noted_e")] if loop.compensated else [])]
    for source, target in arrays:
        for i in range(size):
            one.store(in_lane(w.load(source, i)), target, w.let(f"add i64 {row}, {i}"))
    pair = w.let(f"shl i64 {place}, 1")
    for k, value in enumerate(values):
        one.store(in_lane(value), "%noted_g", w.let(f"add i64 {pair}, {k}"))


def _flag_in_lane(w: Writer, flags: str, lane: str) -> str:
    return flags if w.number.lanes == 1 else w.let(f"extractelement {w.number.flags} {flags}, i64 {lane}")


def _load_integer(w: Writer, array: str, index: str | int) -> str:
    return w.let(f"load i64, ptr {w.let(f'getelementptr inbounds i64, ptr {array}, i64 {index}')}")


def _store_integer(w: Writer, value: str, array: str, index: str | int) -> None:
    w.line(f"store i64 {value}, ptr {w.let(f'getelementptr inbounds i64, ptr {array}, i64 {index}')}")


def _add_to_integer(w: Writer, array: str, index: str | int, more: str) -> None:
    _store_integer(w, w.let(f"add i64 {_load_integer(w, array, index)}, {more}"), array, index)
