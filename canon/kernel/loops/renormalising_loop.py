"""Renormalising loop: every so many compiled steps deviations are made orthonormal again, and their growth is noted.

Modified Gram–Schmidt: each vector in turn is divided by its length and taken out of those after it, so that the
lengths are the diagonal of R in a QR decomposition; their logarithms are summed with compensation. See G. Benettin,
L. Galgani, A. Giorgilli, J.-M. Strelcyn, Meccanica 15 (1980) 9–20, doi:10.1007/BF02128236.
"""

from __future__ import annotations

import ctypes
import functools
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.loop import compiled_function
from canon.kernel.llvm.writer import Writer

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.kernel.llvm.machine_code import MachineCode
    from canon.kernel.loops.deviations import Deviations

__all__ = ["renormalising_function"]

_POINTER, _INTEGER = ctypes.c_void_p, ctypes.c_int64
_SIGNATURE = (*[_POINTER] * 4, *[_INTEGER] * 4, *[_POINTER] * 2)
_PARAMETERS = ", ".join(
    (
        "ptr %advance, ptr %y, ptr %e, ptr %c",
        "i64 %first, i64 %steps, i64 %every, i64 %blocks",
        "ptr noalias %logs, ptr noalias %least",
    )
)
_KEPT = 16


@functools.lru_cache(maxsize=_KEPT)
def renormalising_function(deviations: Deviations, *, orthogonal: bool) -> MachineCode:
    """Compile ``drive(advance, y, e, c, first, steps, every, blocks, logs, least)``.

    It calls a loop's own machine code for ``every`` steps, and for what is left at the end, so that the orbit is bit
    for bit the one without it. ``logs`` has two numbers, a sum and what it lacks, for each vector of each orbit, with
    the vectors or orbits side by side as deviations are; ``least`` gets, likewise, for each orbit or group place the
    least part of a squared length that was left when earlier vectors were taken out of it.

    Parameters
    ----------
    deviations
        How the deviations lie in ``e``.
    orthogonal
        Whether earlier vectors are taken out of later ones; else each is divided by its length only.
    """
    w = Writer(deviations.number)
    end = w.let("add i64 %first, %steps")
    more = w.let("sub i64 %every, 1")
    chunks = w.let(f"sdiv i64 {w.let(f'add i64 %steps, {more}')}, %every")
    with w.loop(0, chunks) as k:
        done = w.let(f"add i64 %first, {w.let(f'mul i64 {k}, %every')}")
        after = w.lesser_integer(end, w.let(f"add i64 {done}, %every"))
        steps = w.let(f"sub i64 {after}, {done}")
        w.line(f"call void %advance(ptr %y, ptr %e, ptr %c, i64 {done}, i64 {steps}, i64 %blocks)")
        with w.loop(0, "%blocks") as block:
            _Renormalising(w, deviations, block, orthogonal=orthogonal).write()
    return compiled_function(w, "drive", _PARAMETERS, _SIGNATURE)


class _Renormalising:
    """Writes the decomposition of one block's deviations."""

    def __init__(self, w: Writer, deviations: Deviations, block: str, *, orthogonal: bool) -> None:
        self.w, self.v, self.deviations, self.orthogonal = w, deviations.writer(w), deviations, orthogonal
        self.size, groups = deviations.size, deviations.groups
        behind = w.let(f"add i64 {w.let(f'mul i64 {block}, {deviations.carry}')}, {deviations.before}")
        self.array = w.at("%e", behind)
        self.logs = self.v.at("%logs", w.let(f"mul i64 {block}, {2 * groups}"))
        self.least = self.v.at("%least", block)
        self.before = self.v.array(groups)

    def write(self) -> None:
        """Write the decomposition."""
        w, v = self.w, self.v
        with w.loop(0, self.deviations.groups) as g:
            v.store(self._dot(self._own(g), self._own(g)), self.before, g)
        with w.loop(0, self.deviations.groups) as g:
            if self.deviations.lanes == 1:
                self._one(g)
            else:
                for lane in range(self.deviations.lanes):
                    self._one_of(g, lane)
            self._note(g)

    def _own(self, g: str) -> str:
        return self.v.at(self.array, self.w.let(f"mul i64 {g}, {self.size}"))

    def _dot(self, a: str, b: str, lane: int | None = None) -> str:
        """Write the scalar product of vectors, or of the vector in one lane of a with all of b."""
        w, v = self.w, self.v
        total = v.array(1)
        v.store(v.constant(Fraction(0)), total, 0)
        with w.loop(0, self.size) as i:
            v.store(v.multiply_add(self._entry(a, i, lane), v.load(b, i), v.load(total, 0)), total, 0)
        return v.load(total, 0)

    def _entry(self, a: str, i: str, lane: int | None) -> str:
        if lane is None:
            return self.v.load(a, i)
        first = self.w.let(f"add i64 {self.w.let(f'mul i64 {i}, {self.deviations.lanes}')}, {lane}")
        return self.v.splat(self.w.load(a, first))

    def _after(self, g: str) -> Iterator[str]:
        """Repeat what follows for the groups after one."""
        w = self.w
        with w.loop(w.let(f"add i64 {g}, 1"), self.deviations.groups) as later:
            yield later

    def _take_out(self, own: str, later: str, dot: str, lane: int | None = None) -> None:
        """Write later −= dot · own."""
        v = self.v
        less = v.negative(dot)
        with self.w.loop(0, self.size) as i:
            v.store(v.multiply_add(less, self._entry(own, i, lane), v.load(later, i)), later, i)

    def _one(self, g: str) -> None:
        """Write what is done with the vector of each orbit that stands g-th."""
        v, own = self.v, self._own(g)
        square = self._dot(own, own)
        self._watch(square, g)
        length = v.intrinsic("sqrt", square)
        self._scale(own, length)
        v.store(length, self.before, g)
        if self.orthogonal:
            for later in self._after(g):
                other = self._own(later)
                self._take_out(own, other, self._dot(own, other))

    def _one_of(self, g: str, lane: int) -> None:
        """Write what is done with the vector in one lane of a group."""
        v, own = self.v, self._own(g)
        square = self._dot(own, own)
        lanes = range(self.deviations.lanes)
        here = self._flags([each == lane for each in lanes])
        one = v.constant(Fraction(1))
        last = v.load(self.before, g)
        self._watch(v.select(here, square, last), g)
        # A place without a vector has the length 0, and stays what it is.
        there = v.let(f"and {v.number.flags} {here}, {v.less(v.constant(Fraction(0)), square)}")
        length = v.select(there, v.intrinsic("sqrt", square), one)
        self._scale(own, length)
        v.store(v.select(here, length, last), self.before, g)
        if not self.orthogonal:
            return
        if lane + 1 < self.deviations.lanes:
            behind = self._flags([each > lane for each in lanes])
            dot = v.select(behind, self._dot(own, own, lane), v.constant(Fraction(0)))
            self._take_out(own, own, dot, lane)
        for later in self._after(g):
            other = self._own(later)
            self._take_out(own, other, self._dot(own, other, lane), lane)

    def _flags(self, flags: list[bool]) -> str:
        return "<" + ", ".join(f"i1 {str(flag).lower()}" for flag in flags) + ">"

    def _scale(self, own: str, length: str) -> None:
        v = self.v
        inverse = v.algebra("div", v.constant(Fraction(1)), length)
        with self.w.loop(0, self.size) as i:
            v.store(v.algebra("mul", v.load(own, i), inverse), own, i)

    def _watch(self, square: str, g: str) -> None:
        """Note which part of a squared length is left."""
        v = self.v
        part = v.algebra("div", square, v.load(self.before, g))
        v.store(v.intrinsic("minnum", part, v.load(self.least, 0)), self.least, 0)

    def _note(self, g: str) -> None:
        """Add the logarithms of a group's lengths to their sums (D. E. Knuth's sum of two numbers)."""
        v = self.v
        new = v.library("log", v.load(self.before, g))
        place = self.w.let(f"mul i64 {g}, 2")
        lack = self.w.let(f"add i64 {place}, 1")
        old = v.load(self.logs, place)
        total = v.algebra("add", old, new)
        back = v.algebra("sub", total, old)
        error = v.algebra(
            "add", v.algebra("sub", old, v.algebra("sub", total, back)), v.algebra("sub", new, back)
        )
        v.store(total, self.logs, place)
        v.store(v.algebra("add", v.load(self.logs, lack), error), self.logs, lack)
