"""Tangent maps of Gauss methods: deviations moved by the exact derivative of an implicit step, beside the orbit.

The derivative of the stages L_i = h b_i f(Y_i), Y_i = y + Σ_j µ_ij L_j solves ΔL_i = h b_i f′(Y_i) ΔY_i with
ΔY_i = δ + Σ_j µ_ij ΔL_j, a linear system, by the iteration that the stages themselves are found by, Newton's with the
factors of the orbit's: it converges as fast as theirs. δ + Σ ΔL_i is then the deviation after the step, and symplectic
in δ, as µ_ij + µ_ji = 1.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.loop import PARAMETERS, SIGNATURE, Loop, compiled_function
from canon.kernel.llvm.writer import Writer
from canon.kernel.loops.gauss import remedy, write_gauss
from canon.kernel.program.program import exact_value
from canon.kernel.program.slopes import slopes
from canon.kernel.schemes.gauss_tableau import lanes_for

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.loops.deviations import Deviations
    from canon.kernel.loops.gauss import GaussIteration
    from canon.kernel.loops.newton_stages import NewtonStages
    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.program.slopes import Slopes

__all__ = ["numbers_of_method", "tangent_gauss_loop"]

_ITERATIONS = 100
_SETTLED = Fraction(1, 2**54)
"""A change of ΔL that is this part of the largest ΔY is lost in rounding; the last iteration makes it smaller still."""

_SMALL = 16
"""Numbers of a deviation up to which several are moved by turns: more would not stay near the processor."""

_CONVERGED = Fraction(1, 2**40)
"""A last change above this part means that the iteration has not converged."""


def numbers_of_method(system: HamiltonEquations, stages: int) -> int:
    """Return how many numbers a Gauss loop keeps behind the compensation."""
    return 2 + 2 * len(system.q) * lanes_for(stages)


def tangent_gauss_loop(
    system: HamiltonEquations, stages: int, deviations: Deviations, *, compensated: bool, newton: bool
) -> Loop:
    """Compile the steps of :func:`canon.kernel.loops.gauss.gauss_loop` with deviations beside the orbit.

    The deviations lie in ``e`` behind what the method keeps. Where their iteration does not converge they become NaN.
    """
    w = Writer(deviations.number)
    half, n = deviations.size // 2, len(system.q)
    moving = [*range(half), *range(n, n + half)]
    inputs = (*system.q, *system.p)
    rates = [(*system.velocity, *system.force)[k] for k in moving]
    matrix = slopes(system.graph, rates, [inputs[k] for k in moving])

    def beside(iteration: GaussIteration, clock: str, array: str) -> None:
        _TangentStages.of(iteration, clock, array, matrix).write(deviations.groups)

    carry = write_gauss(
        w, system, stages, compensated=compensated, newton=newton, more=deviations.numbers, beside=beside
    )
    code = compiled_function(w, "advance", PARAMETERS, SIGNATURE)
    return Loop(code, n, compensated, w.number, carry, implicit=True, remedy=remedy(newton=newton))


@dataclass(frozen=True)
class _TangentStages:
    """Writes the deviations of one step.

    Parameters
    ----------
    iteration
        The stages of the orbit.
    array
        Where the deviations lie, each after the one before.
    matrix, entries
        The slopes of the rates, and their numbers: those that vary in memory, in lanes over the stages.
    delta, moved
        ΔL, and ΔY, in lanes over the stages.
    change, before, reach
        The largest change of ΔL, the one before it, and the largest size of ΔY.
    """

    iteration: GaussIteration
    array: str
    matrix: Slopes
    entries: str
    delta: str
    moved: str
    change: str
    before: str
    reach: str

    @classmethod
    def of(cls, iteration: GaussIteration, clock: str, array: str, matrix: Slopes) -> _TangentStages:
        v, size = iteration.v, len(matrix.rows)
        entries = ""
        if matrix.varying:
            entries = v.array(len(matrix.varying))
            places = [v.load(iteration.place, i) for i in range(iteration.size)]
            program = iteration.system.program(matrix.varying)
            for k, value in enumerate(v.program(program, [*places, clock])):
                v.store(value, entries, k)
        return cls(
            iteration,
            array,
            matrix,
            entries,
            v.array(size),
            v.array(size),
            v.array(1),
            v.array(1),
            v.array(1),
        )

    @property
    def size(self) -> int:
        return len(self.matrix.rows)

    def write(self, vectors: int) -> None:
        """Move every deviation; some small ones by turns, so that none waits for its own last result."""
        w = self.iteration.w
        together = next(k for k in (4, 3, 2, 1) if vectors % k == 0) if self.size <= _SMALL else 1
        others = [self._with_own_arrays() for _ in range(together - 1)]
        with w.loop(0, vectors // together) as g:
            first = w.let(f"mul i64 {g}, {together * self.size}")
            places = [w.let(f"add i64 {first}, {k * self.size}") for k in range(together)]
            each = [(one, w.at(self.array, at)) for one, at in zip((self, *others), places, strict=True)]
            for one, _ in each:
                one.begin()
            with w.loop(0, _ITERATIONS):
                for one, own in each:
                    one.once(own)
                settled = [one.has_settled() for one, _ in each]
                w.leave_if(functools.reduce(lambda a, b: w.let(f"and i1 {a}, {b}"), settled))
            for one, own in each:
                one.end(own)

    def _with_own_arrays(self) -> _TangentStages:
        v = self.iteration.v
        delta, moved = v.array(self.size), v.array(self.size)
        return replace(self, delta=delta, moved=moved, change=v.array(1), before=v.array(1), reach=v.array(1))

    def begin(self) -> None:
        """Write the start of the iteration, ΔL = 0."""
        w, v = self.iteration.w, self.iteration.v
        with w.loop(0, self.size) as i:
            v.store(v.constant(Fraction(0)), self.delta, i)
        v.store(v.constant(Fraction(0)), self.change, 0)

    def end(self, own: str) -> None:
        """Add the stages to the deviation; NaN where the iteration has not converged."""
        w, v = self.iteration.w, self.iteration.v
        lost = w.let(f"xor i1 {self._is_below(_CONVERGED)}, true")
        with w.loop(0, self.size) as i:
            found = v.load(self.delta, i)
            # A sum over stages from the smallest: the deviation itself is added last.
            change = w.constant(Fraction(0))
            for j in range(self.iteration.method.stages):
                change = w.algebra("add", change, v.lane(found, j))
            new = w.algebra("add", w.load(own, i), change)
            w.store(w.select(lost, w.nan(), new), own, i)

    def once(self, own: str) -> None:
        """Write one iteration, ΔY from ΔL and ΔL from ΔY."""
        w, v, method = self.iteration.w, self.iteration.v, self.iteration.method
        zero = v.constant(Fraction(0))
        v.store(v.load(self.change, 0), self.before, 0)
        v.store(zero, self.change, 0)
        v.store(zero, self.reach, 0)
        with w.loop(0, self.size) as i:
            moved = method.moved(v.splat(w.load(own, i)), v.load(self.delta, i))
            v.store(moved, self.moved, i)
            self._enlarge(self.reach, moved)
        found = [self._rate(row) for row in self.matrix.rows]
        if self.iteration.newton is not None:
            found = self._improved(self.iteration.newton, found)
        for i, new in enumerate(found):
            self._enlarge(self.change, v.algebra("sub", new, v.load(self.delta, i)))
            v.store(new, self.delta, i)

    def _rate(self, row: Sequence[tuple[int, int]]) -> str:
        """Write h b_i Σ_k slope_k ΔY_k."""
        v = self.iteration.v
        place = {node: k for k, node in enumerate(self.matrix.varying)}
        total = v.constant(Fraction(0))
        for j, node in row:
            if node in place:
                slope = v.load(self.entries, place[node])
            else:
                slope = v.constant(exact_value(self.matrix.graph, node))
            total = v.multiply_add(slope, v.load(self.moved, j), total)
        return v.algebra("mul", self.iteration.method.weight, total)

    def _improved(self, newton: NewtonStages, found: list[str]) -> list[str]:
        """Write Newton's change of ΔL with the factors of the orbit's own; parameters do not deviate."""
        v, n, half = self.iteration.v, self.iteration.size // 2, self.size // 2
        still = [v.constant(Fraction(0))] * (n - half)
        old = [v.load(self.delta, i) for i in range(self.size)]
        full = newton.improved(
            [*old[:half], *still, *old[half:], *still], [*found[:half], *still, *found[half:], *still]
        )
        return [*full[:half], *full[n : n + half]]

    def _enlarge(self, largest: str, value: str) -> None:
        v = self.iteration.v
        v.store(v.intrinsic("maxnum", v.load(largest, 0), v.intrinsic("fabs", value)), largest, 0)

    def _is_below(self, part: Fraction) -> str:
        """Return whether the last change is no more than a part of the largest ΔY."""
        w, v = self.iteration.w, self.iteration.v
        change, reach = v.greatest(v.load(self.change, 0)), v.greatest(v.load(self.reach, 0))
        limit = w.algebra("mul", reach, w.constant(part))
        return w.let(f"fcmp ole {w.number.name} {change}, {limit}")

    def has_settled(self) -> str:
        """Return whether the change is lost in rounding, or small and halved no more."""
        w, v = self.iteration.w, self.iteration.v
        change, before = v.greatest(v.load(self.change, 0)), v.greatest(v.load(self.before, 0))
        half = w.algebra("mul", before, w.constant(Fraction(1, 2)))
        stays = w.let(f"fcmp oge {w.number.name} {change}, {half}")
        small = w.let(f"and i1 {stays}, {self._is_below(_CONVERGED)}")
        return w.let(f"or i1 {small}, {self._is_below(_SETTLED)}")
