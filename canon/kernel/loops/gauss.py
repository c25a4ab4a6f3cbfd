"""Gauss–Legendre methods: symplectic for every Hamiltonian, order 2s with s stages, implicit.

With other numbers a_ij and b_j, which the loop reads, its steps are those of the average vector field methods, which
keep the energy (:mod:`canon.kernel.schemes.average_vector_field`).

The stages solve L_i = h b_i f(Y_i), Y_i = y + (e + Σ_j µ_ij L_j) with µ_ij = a_ij/b_j. A Runge–Kutta method is
symplectic where µ_ij + µ_ji = 1, which the rounded µ fulfil exactly here; the iteration goes on until no
component's change still decreases, then once more, so that what is left is round-off without a trend; where the sum
y + Σ L_i is compensated, twice more, as what one iteration leaves shows as a drift after 10⁹ steps.

Sources: E. Hairer, R. I. McLachlan, A. Razakarivony, Achieving Brouwer's law with implicit Runge–Kutta methods,
BIT 48 (2008) 231–243, doi:10.1007/s10543-008-0170-3; M. Antoñana, J. Makazaga, A. Murua, Reducing and monitoring
round-off error propagation for symplectic implicit Runge–Kutta schemes, Numer. Algorithms 76 (2017) 861–880,
doi:10.1007/s11075-017-0287-z.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.lane_rows import row_of, store_row
from canon.kernel.llvm.loop import METHOD, Loop, blocks_of, compile_loop, increase, steps_of
from canon.kernel.llvm.number_types import DOUBLE, SINGLE
from canon.kernel.llvm.writer import Writer
from canon.kernel.loops.newton_stages import newton_stages
from canon.kernel.schemes.gauss_tableau import lanes_for

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.kernel.llvm.number_types import MachineType
    from canon.kernel.loops.newton_stages import NewtonStages
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["GaussIteration", "gauss_loop", "remedy", "write_gauss"]

_ITERATIONS = 100
_HALVES = 2
"""Coordinates and momenta: they are measured each by their own largest, as one may be 10¹⁰ times the other."""

_STIFF_SETTLED = 30
"""The same for Newton's changes, of which the rounding of large forces is a larger part."""

_NEAR = 26
"""Changes below 2⁻²⁶ of the largest component are a Newton step's error of the factors that are kept then."""

_STIFF = (
    "the step is too large for the iteration; take a smaller one, Taylor(), or the method with iteration='newton', "
    "where a stiff part of H and not the motion asks for small steps"
)
_SINGULAR = "the step is too large for Newton's method; take a smaller one, or Taylor()"

_SETTLED, _CONVERGED = 42, 20
"""In doubles, changes above 2⁻⁴² of the largest component are not taken for round-off while iterations are left; a
last change above 2⁻²⁰ of it means that the iteration has not converged. In other numbers accordingly."""


def gauss_loop(
    system: HamiltonEquations,
    stages: int,
    *,
    compensated: bool,
    number: MachineType = DOUBLE,
    newton: bool = False,
) -> Loop:
    """Compile Gauss–Legendre steps, the stages side by side in SIMD lanes.

    After the 2n numbers of compensation, ``e`` keeps the number of iterations, the last change of an iteration
    that did not converge, and the stages L, from which the next step's are predicted. A step whose
    iteration does not converge makes the state NaN. In single precision iterations are counted up to 2²⁴. Iterated are
    the equations themselves, or Newton's steps (:mod:`canon.kernel.loops.newton_stages`).
    """
    w = Writer(number)
    carry = write_gauss(w, system, stages, compensated=compensated, newton=newton)
    made = compile_loop(w, len(system.q), compensated=compensated, carry=carry)
    return replace(made, remedy=remedy(newton=newton))


def remedy(*, newton: bool) -> str:
    """Return what helps where the stages do not converge."""
    return _SINGULAR if newton else _STIFF


def write_gauss(
    w: Writer,
    system: HamiltonEquations,
    stages: int,
    *,
    compensated: bool,
    newton: bool,
    more: int = 0,
    beside: Callable[[GaussIteration, str, str], None] | None = None,
) -> int:
    """Write the steps of a Gauss method, and return how many numbers ``e`` holds.

    Parameters
    ----------
    w, system, stages, compensated, newton
        What to write, as :func:`gauss_loop` takes it.
    more
        Numbers that ``e`` holds after those of the method.
    beside
        Writes what else is done in a step, given the converged stages, their times, and the address of those numbers.
    """
    size, lanes = 2 * len(system.q), lanes_for(stages)
    v = w.side_by_side(lanes)
    own = size + 2 + size * lanes
    y, e = w.array(size), w.array(size) if compensated else ""
    method = _Stages(w, v, w.at("%c", METHOD), stages)
    with contextlib.ExitStack() as memory:
        solver = (
            memory.enter_context(newton_stages(w, v, system, method.weight, method.mu)) if newton else None
        )
        iteration = GaussIteration.of(w, v, system, y, e, method, solver)

        def also(clock: str, kept: str) -> None:
            if beside is not None:
                beside(iteration, clock, w.at(kept, own))

        _write_steps(w, v, system, (y, e, own + more), iteration, also)
    return own + more


def _write_steps(
    w: Writer,
    v: Writer,
    system: HamiltonEquations,
    state: tuple[str, str, int],
    iteration: GaussIteration,
    also: Callable[[str, str], None],
) -> None:
    """Write all steps of all blocks."""
    (y, e, carry), size, stages = state, 2 * len(system.q), iteration.method.stages
    with blocks_of(w, y, e, size, carry) as kept:
        count, failed, guess = size, size + 1, w.at(kept, size + 2)
        with w.loop(0, size) as i:
            v.store(row_of(w, v, guess, i), iteration.stage, i)
        with steps_of(w, system) as time:
            clock = iteration.begin(time)
            with w.loop(0, _ITERATIONS):
                w.store(w.algebra("add", w.load(kept, count), w.constant(Fraction(1))), kept, count)
                iteration.once(clock)
            lost, last_change = iteration.end()
            also(clock, kept)
            w.store(w.select(lost, last_change, w.load(kept, failed)), kept, failed)
            nothing = w.widened(iteration.d.nan(), iteration.watched)
            with w.loop(0, size) as i:
                w.store(w.select(lost, nothing, w.load(y, i)), y, i)
                found = v.load(iteration.stage, i)
                for j in range(stages):
                    increase(w, y, e, i, w.constant(Fraction(1)), v.lane(found, j))
        with w.loop(0, size) as i:
            store_row(w, v, v.load(iteration.stage, i), guess, i)


@dataclass(frozen=True)
class GaussIteration:
    """Writes the fixed-point iteration for the stages of one step.

    Parameters
    ----------
    w, v, d, g
        Writers of scalars and of lanes, in the loop's numbers and in those that changes and sizes are watched in.
    system, y, e, method
        The equations, the state, its compensation or "", and the method's numbers.
    watched
        The numbers that d writes.
    stage, place
        L and Y.
    least
        The least change so far, by component and stage.
    done, change, reach
        In how many iterations on end no change decreased; the largest changes of coordinates and of momenta; the sizes
        of what changed.
    newton
        What finds the changes by Newton's method, where it does.
    """

    w: Writer
    v: Writer
    d: Writer
    g: Writer
    system: HamiltonEquations
    y: str
    e: str
    method: _Stages
    watched: MachineType
    stage: str
    place: str
    least: str
    done: str
    change: str
    reach: str
    newton: NewtonStages | None = None

    @classmethod
    def of(
        cls,
        w: Writer,
        v: Writer,
        system: HamiltonEquations,
        y: str,
        e: str,
        method: _Stages,
        newton: NewtonStages | None = None,
    ) -> GaussIteration:
        """Return the writer for a loop, with memory of its own for the stages."""
        size = 2 * len(system.q)
        # Changes and sizes are watched in numbers no wider than doubles, of pairs by their high parts.
        watched = w.number if w.number == SINGLE else DOUBLE
        d, g = (each.in_numbers(replace(watched, lanes=each.number.lanes)) for each in (w, v))
        arrays = v.array(size), v.array(size), g.array(size), d.array(1), g.array(_HALVES), g.array(_HALVES)
        return cls(w, v, d, g, system, y, e, method, watched, *arrays, newton)

    @property
    def size(self) -> int:
        """Numbers of a state."""
        return 2 * len(self.system.q)

    def begin(self, time: str) -> str:
        """Predict the stages of the step that starts at a time, and return the stages' times."""
        v, g = self.v, self.g
        clock = v.algebra("add", v.splat(time), self.method.node)
        with self.w.loop(0, self.size) as i:
            v.store(self.method.predicted(v.load(self.stage, i)), self.stage, i)
            g.store(g.infinity(), self.least, i)
        self.d.store(self._zero, self.done, 0)
        if self.newton is not None:
            self.newton.begin()
        return clock

    def once(self, clock: str) -> None:
        """Write one iteration, and leave the loop that it stands in after the last one."""
        w, v, d, g = self.w, self.v, self.d, self.g
        before_the_last = 1 if self.e else 0  # iterations once settled, of compensated and of plain sums
        last = d.less(d.constant(Fraction(before_the_last)), d.load(self.done, 0))
        self._move()
        for half in range(_HALVES):
            g.store(g.constant(Fraction(0)), self.change, half)
            g.store(g.constant(Fraction(0)), self.reach, half)
        settled = d.algebra("add", d.load(self.done, 0), d.constant(Fraction(1)))
        d.store(settled, self.done, 0)
        field = self.system.program(self.system.rates)
        places = [v.load(self.place, i) for i in range(self.size)]
        found = [v.algebra("mul", self.method.weight, rate) for rate in v.program(field, [*places, clock])]
        if self.newton is not None:
            self.newton.factorise(places, clock)
            old = [v.load(self.stage, i) for i in range(self.size)]
            found = self.newton.improved(old, found)
        for i, new in enumerate(found):
            self._renew(i, new)
        if self.newton is not None:
            self.newton.keep_factors(self._moves_by_more_than(_NEAR))
            d.store(d.select(self.newton.halved(self._relative_change()), self._zero, settled), self.done, 0)
        coarse = self._moves_by_more_than(_SETTLED if self.newton is None else _STIFF_SETTLED)
        d.store(d.select(coarse, self._zero, d.load(self.done, 0)), self.done, 0)
        still = w.let(f"xor i1 {g.any_lane(g.less(g.constant(Fraction(0)), self._largest_change()))}, true")
        w.leave_if(w.let(f"or i1 {last}, {still}"))

    def end(self) -> tuple[str, str]:
        """Return whether the iteration has not converged, and its last change."""
        moves, diverges = self.g.greatest(self._largest_change()), self._moves_by_more_than(_CONVERGED)
        for half in range(_HALVES):
            scale = self.g.greatest(self.g.load(self.reach, half))
            diverges = self.w.let(f"or i1 {diverges}, {self.d.equal(scale, self.d.infinity())}")
        return diverges, self.w.widened(moves, self.watched)

    @property
    def _zero(self) -> str:
        return self.d.constant(Fraction(0))

    def _move(self) -> None:
        """Write Y_i = y + (e + Σ_j µ_ij L_j)."""
        w, v = self.w, self.v
        with w.loop(0, self.size) as i:
            carried = v.splat(w.load(self.e, i)) if self.e else v.constant(Fraction(0))
            moved = self.method.moved(carried, v.load(self.stage, i))
            v.store(v.algebra("add", v.splat(w.load(self.y, i)), moved), self.place, i)

    def _renew(self, i: int, new: str) -> None:
        """Replace a component of L and note by how much it changed."""
        v, d, g = self.v, self.d, self.g
        difference = _size(v, g, v.algebra("sub", new, v.load(self.stage, i)))
        before = g.load(self.least, i)
        decreasing = g.any_lane(g.less(difference, before))
        v.store(new, self.stage, i)
        g.store(g.intrinsic("minnum", before, difference), self.least, i)
        half = i * _HALVES // self.size
        g.store(g.intrinsic("maxnum", g.load(self.change, half), difference), self.change, half)
        if not self._is_parameter(i):
            far = g.algebra("add", _size(v, g, new), _size(v, g, v.load(self.place, i)))
            g.store(g.intrinsic("maxnum", g.load(self.reach, half), far), self.reach, half)
        d.store(d.select(decreasing, self._zero, d.load(self.done, 0)), self.done, 0)

    def _is_parameter(self, i: int) -> bool:
        """Tell whether a component is a parameter by orbit: it stays what it is, in whatever unit it has."""
        system, n = self.system, len(self.system.q)
        return i % n >= n - system.varying and system.rates[i] == system.graph.zero

    def _largest_change(self) -> str:
        """Return the largest change of a coordinate or momentum in each lane."""
        g = self.g
        return g.intrinsic("maxnum", *(g.load(self.change, half) for half in range(_HALVES)))

    def _relative_change(self) -> str:
        """Return the largest change in parts of the size of what changed, coordinates and momenta apart."""
        d, g, largest = self.d, self.g, self._zero
        for half in range(_HALVES):
            change, reach = (g.greatest(g.load(each, half)) for each in (self.change, self.reach))
            part = d.select(d.less(self._zero, change), d.algebra("div", change, reach), self._zero)
            largest = d.intrinsic("maxnum", largest, part)
        return self.w.widened(largest, self.watched)

    def _moves_by_more_than(self, bits: int) -> str:
        """Return whether a change is above 2⁻ᵇⁱᵗˢ of the size of what changed, coordinates and momenta apart."""
        d, g = self.d, self.g
        part, flags = d.constant(Fraction(1, 2 ** (bits * self.w.number.mantissa // 53))), list[str]()
        for half in range(_HALVES):
            limit = d.algebra("mul", g.greatest(g.load(self.reach, half)), part)
            flags.append(g.less(g.splat(limit), g.load(self.change, half)))
        return g.any_lane(self.w.let(f"or {g.number.flags} {', '.join(flags)}"))


def _size(v: Writer, g: Writer, value: str) -> str:
    """Write the sizes of numbers in lanes, in the numbers that sizes are watched in."""
    if v.number.pair:
        value = v.let(f"extractvalue {v.number.name} {value}, 0")
    elif v.number.scalar != g.number.scalar:
        value = v.let(f"fptrunc {v.number.name} {value} to {g.number.name}")
    return g.intrinsic("fabs", value)


class _Stages:
    """The method's numbers, read from the loop's coefficients, and the sums over stages made with them."""

    def __init__(self, w: Writer, v: Writer, table: str, stages: int) -> None:
        self.v, self.stages = v, stages

        def row(k: int) -> str:
            return row_of(w, v, table, k)

        self.weight, self.node = row(0), row(1)
        columns = [row(2 + column) for column in range(2 * stages)]
        self.mu, self.prediction = columns[:stages], columns[stages:]

    def moved(self, carried: str, stage: str) -> str:
        """Write e + Σ_j µ_ij L_j for all stages i."""
        return self._sum(carried, self.mu, stage)

    def predicted(self, stage: str) -> str:
        """Write Σ_j ν_ij L_j for all stages i."""
        return self._sum(self.v.constant(Fraction(0)), self.prediction, stage)

    def _sum(self, total: str, columns: list[str], stage: str) -> str:
        for j, column in enumerate(columns):
            total = self.v.multiply_add(column, self.v.splat(self.v.lane(stage, j)), total)
        return total
