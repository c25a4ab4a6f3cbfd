"""Tangent maps of splittings: deviations moved by the exact derivative of every drift and kick, beside the orbit.

A kick p ← p + c f(q) has the derivative δp ← δp + c f′(q) δq, a drift q ← q + c v(p) has δq ← δq + c v′(p) δp. The
orbit is written as it is without deviations, so that it is the same bit for bit; what its forces and their slopes have
in common is computed once where the compiler finds it. See E. Hairer, C. Lubich, G. Wanner, Geometric Numerical
Integration (2nd ed., Springer 2006), § VI.4.
"""

from __future__ import annotations

import contextlib
import itertools
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.loop import PARAMETERS, SIGNATURE, Loop, blocks_of, compiled_function
from canon.kernel.llvm.writer import Writer
from canon.kernel.loops.splitting import SplittingWriter, write_splitting
from canon.kernel.program.program import exact_value
from canon.kernel.program.slopes import slopes

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from canon.kernel.loops.deviations import Deviations
    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.program.slopes import Slopes

__all__ = ["tangent_splitting_loop"]

_COPIED = 64
"""Up to so many numbers deviations are copied, for registers to hold them; more stay where they are."""

_WRITTEN_OUT = 1000
"""Up to so many entries a matrix is written out; larger ones are loops over its rows and entries."""


def tangent_splitting_loop(
    system: HamiltonEquations, stages: int, deviations: Deviations, *, compensated: bool, kick_first: bool
) -> Loop:
    """Compile the steps of :func:`canon.kernel.loops.splitting.splitting_loop` with deviations beside the orbit.

    The deviations lie in ``e`` behind the compensation, as :class:`canon.kernel.loops.deviations.Deviations` says.
    """
    w = Writer(deviations.number)
    orbit = SplittingWriter.of(w, system, compensated=compensated, kick_first=kick_first)
    size = 2 * len(system.q)
    with (
        blocks_of(w, orbit.y, orbit.e, size, deviations.carry, orbit.gap) as kept,
        _local(w, deviations, w.at(kept, size)) as array,
    ):
        beside = _TangentSplitting.of(orbit, deviations, array)
        write_splitting(w, system, stages, beside, kick_first=kick_first)
    code = compiled_function(w, "advance", PARAMETERS, SIGNATURE)
    return Loop(code, len(system.q), compensated, w.number, deviations.carry)


@contextlib.contextmanager
def _local(w: Writer, deviations: Deviations, kept: str) -> Generator[str]:
    """Yield where the deviations are to be moved: a copy of few, which is copied back."""
    v, count = deviations.writer(w), deviations.groups * deviations.size
    if count > _COPIED:
        yield kept
        return
    own = v.array(count)
    v.copy(kept, own, count)
    yield own
    v.copy(own, kept, count)


@dataclass(frozen=True)
class _TangentSplitting:
    """Writes drifts and kicks of an orbit and of its deviations.

    Parameters
    ----------
    orbit
        Writes those of the orbit.
    deviations, array
        The deviations and where they lie.
    of_velocity, of_force
        The slopes of what drifts and of what kicks.
    held
        Where c f′(q) δq without its c is kept for the next step's first kick; "" where that is never so.
    """

    orbit: SplittingWriter
    deviations: Deviations
    array: str
    of_velocity: Slopes
    of_force: Slopes
    held: str

    @classmethod
    def of(cls, orbit: SplittingWriter, deviations: Deviations, array: str) -> _TangentSplitting:
        system, half = orbit.system, deviations.size // 2
        graph, q, p = system.graph, system.q[:half], system.p[:half]
        return cls(
            orbit,
            deviations,
            array,
            slopes(graph, system.velocity[:half], p, symmetric=True),
            slopes(graph, system.force[:half], q, symmetric=True),
            deviations.writer(orbit.w).array(deviations.groups * half) if orbit.kick_first else "",
        )

    @property
    def half(self) -> int:
        return self.deviations.size // 2

    def set_clocks(self, time: str) -> None:
        """Write the time that a step starts at."""
        self.orbit.set_clocks(time)

    def drift(self, coefficient: str) -> None:
        """Write q ← q + c v(p) and δq ← δq + c v′(p) δp."""
        self._move(self.of_velocity, len(self.orbit.system.q), self.orbit.kick_clock, 0, coefficient)
        self.orbit.drift(coefficient)

    def kick(self, coefficient: str) -> None:
        """Write p ← p + c f(q) and δp ← δp + c f′(q) δq."""
        if self.orbit.kick_first:
            self._keep()
            self._kick_again(coefficient)
        else:
            self._move(self.of_force, 0, self.orbit.drift_clock, self.half, coefficient)
        self.orbit.kick(coefficient)

    def kick_again(self, coefficient: str) -> None:
        """Write a kick with the force and the slopes that were kept."""
        self._kick_again(coefficient)
        self.orbit.kick_again(coefficient)

    def keep_force(self) -> None:
        """Write the force, and what it is for deviations, to where they are kept."""
        self._keep()
        self.orbit.keep_force()

    # deviations ----------------------------------------------------------------------------------

    def _move(self, matrix: Slopes, reads: int, clock: str, moved: int, coefficient: str) -> None:
        """Write one half of the deviations += c · slopes · the other half."""
        entries = self._entries(matrix, reads, clock)
        read = self.half - moved
        for g in self._groups():
            for i in self._rows(matrix):
                self._increase(
                    g, self._plus(i, moved), coefficient, self._product(matrix, entries, g, i, read)
                )

    def _keep(self) -> None:
        matrix = self.of_force
        entries = self._entries(matrix, 0, self.orbit.drift_clock)
        for g in self._groups():
            for i in self._rows(matrix):
                total = self._product(matrix, entries, g, i, 0)
                self._v.store(total, self.held, self._at(g, self.half, i))

    def _kick_again(self, coefficient: str) -> None:
        for g in self._groups():
            for i in self._rows(self.of_force):
                rate = self._v.load(self.held, self._at(g, self.half, i))
                self._increase(g, self._plus(i, self.half), coefficient, rate)

    def _entries(self, matrix: Slopes, reads: int, clock: str) -> str:
        """Write the entries that vary, of a large matrix all of them, into memory."""
        w, nodes = self.orbit.w, self._kept(matrix)
        if not nodes:
            return ""
        array = w.array(len(nodes))
        self.orbit.evaluate(nodes, reads, clock, lambda k, value: w.store(value, array, k))
        return array

    def _kept(self, matrix: Slopes) -> tuple[int, ...]:
        if _is_written_out(matrix):
            return matrix.varying
        return tuple(dict.fromkeys(node for row in matrix.rows for _, node in row))

    def _product(self, matrix: Slopes, entries: str, g: str, i: str, read: int) -> str:
        """Write Σ_j slope_ij δ_j for a group of vectors."""
        w, v, spread = self.orbit.w, self._v, self.deviations.spread
        place = {node: k for k, node in enumerate(self._kept(matrix))}
        if _is_written_out(matrix):
            total = ""
            for j, node in matrix.rows[int(i)]:
                x = v.load(self.array, self._at(g, 2 * self.half, str(read + j)))
                slope = (
                    spread(v, w.load(entries, place[node]))
                    if node in place
                    else v.constant(exact_value(matrix.graph, node))
                )
                total = v.multiply_add(slope, x, total) if total else v.algebra("mul", slope, x)
            return total
        starts = [0, *itertools.accumulate(map(len, matrix.rows))]
        columns, places = zip(*((j, place[node]) for row in matrix.rows for j, node in row), strict=True)
        total = v.array(1)
        v.store(v.constant(Fraction(0)), total, 0)
        with w.loop(w.entry(starts, i), w.entry(starts, w.let(f"add i64 {i}, 1"))) as k:
            column = self._plus(w.entry(columns, k), read)
            x = v.load(self.array, self._at(g, 2 * self.half, column))
            slope = spread(v, w.load(entries, w.entry(places, k)))
            v.store(v.multiply_add(slope, x, v.load(total, 0)), total, 0)
        return v.load(total, 0)

    def _increase(self, g: str, i: str, coefficient: str, rate: str) -> None:
        v, place = self._v, self._at(g, 2 * self.half, i)
        weight = self.deviations.spread(v, coefficient)
        v.store(v.multiply_add(weight, rate, v.load(self.array, place)), self.array, place)

    @property
    def _v(self) -> Writer:
        return self.deviations.writer(self.orbit.w)

    def _groups(self) -> Iterator[str]:
        """Repeat what follows for every group of vectors side by side."""
        if self.deviations.groups == 1:
            yield "0"
            return
        with self.orbit.w.loop(0, self.deviations.groups) as g:
            yield g

    def _rows(self, matrix: Slopes) -> Iterator[str]:
        """Repeat what follows for every row: those that hold something, or of a large matrix all."""
        if _is_written_out(matrix):
            yield from (str(i) for i, row in enumerate(matrix.rows) if row)
            return
        with self.orbit.w.loop(0, self.half) as i:
            yield i

    def _at(self, g: str, length: int, i: str) -> str:
        """Write the place of component i of a group's row of so many."""
        if self.deviations.groups == 1:
            return i
        return self._plus(self.orbit.w.let(f"mul i64 {g}, {length}"), i)

    def _plus(self, i: str, more: int | str) -> str:
        if isinstance(more, int) and i.isdecimal():
            return str(int(i) + more)
        return self.orbit.w.let(f"add i64 {i}, {more}") if more else i


def _is_written_out(matrix: Slopes) -> bool:
    return matrix.count <= _WRITTEN_OUT
