"""Pair forces of many bodies, written as a loop over the sources around a loop over the targets.

No sum runs along the inner loop, so that nothing is reordered and compilers turn it into SIMD instructions.
"""

from __future__ import annotations

import itertools
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.kernel.llvm.writer import Writer
    from canon.kernel.program.repeated.pair_function import PairForces

__all__ = ["write_pair_forces"]

_ALIGNED = 8
"""Bodies are filled up to a multiple of this, so that the inner loop has no remainder."""


def write_pair_forces(
    w: Writer, forces: PairForces, state: str, rest: Callable[[Callable[[str, str], None]], None] | None,
    take: Callable[[str, str], None],
) -> None:  # fmt: skip
    """Write the forces of pairs, and what is left, as loops.

    Parameters
    ----------
    w
        The function's writer.
    forces
        What was found.
    state
        The array that holds q.
    rest
        Writes the rest of the forces, where there is one; what it is given takes the number of a component and its
        value.
    take
        Writes what is done with a component of the force, given its number and its value; called inside a loop.
    """
    bodies, axes = forces.bodies, forces.axes
    filled = -(-bodies // _ALIGNED) * _ALIGNED
    place, force = ([w.array(filled) for _ in range(axes)] for _ in range(2))
    zero = w.constant(Fraction(0))
    with w.loop(0, filled) as i:
        for array in (*place, *force):
            w.store(zero, array, i)
    with w.loop(0, bodies) as i:
        own = w.let(f"mul i64 {i}, {axes}")
        for k, array in enumerate(place):
            w.store(w.load(state, w.let(f"add i64 {own}, {k}")), array, i)
    if rest is not None:
        left = w.array(bodies * axes)
        rest(lambda i, value: w.store(value, left, i))
        with w.loop(0, bodies) as i:
            own = w.let(f"mul i64 {i}, {axes}")
            for k, array in enumerate(force):
                w.store(w.load(left, w.let(f"add i64 {own}, {k}")), array, i)
    strength = _strength(w, forces.strengths, filled) if forces.strengths else None
    empty = [Fraction(0)] * (filled - bodies)
    numbers = [w.number_table([*column, *empty]) for column in forces.numbers]
    with w.loop(0, bodies) as j:
        source = [w.load(array, j) for array in place]
        numbers_of_source = [number(j) for number in numbers]
        row = w.let(f"mul i64 {j}, {filled}")
        with w.loop(0, filled) as i:
            target = [w.load(array, i) for array in place]
            is_itself = w.let(f"icmp eq i64 {i}, {j}")
            factor = strength and strength(w.let(f"add i64 {row}, {i}"))
            arguments = [*target, *source, *(number(i) for number in numbers), *numbers_of_source]
            for array, pull in zip(force, w.program(forces.gradient, arguments), strict=True):
                kind, so_far = w.number.name, w.load(array, i)
                kept = w.let(f"select i1 {is_itself}, {kind} {zero}, {kind} {pull}")
                added = w.multiply_add(factor, kept, so_far) if factor else w.algebra("add", kept, so_far)
                w.store(added, array, i)
    with w.loop(0, bodies) as i:
        own = w.let(f"mul i64 {i}, {axes}")
        for k, array in enumerate(force):
            take(w.let(f"add i64 {own}, {k}"), w.load(array, i))


def _strength(w: Writer, strengths: Sequence[Sequence[Fraction]], filled: int) -> Callable[[str], str]:
    """Return what writes c_ij, given j · filled + i: one number for all, or a table's entry."""
    pairs = {c for i, row in enumerate(strengths) for j, c in enumerate(row) if i != j}
    if len(pairs) == 1:
        known = w.constant(pairs.pop())
        return lambda _: known
    rows = [[*row, *[Fraction(0)] * (filled - len(row))] for row in strengths]
    return w.number_table(list(itertools.chain.from_iterable(rows)))
