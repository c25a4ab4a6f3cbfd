"""Newton's method for the stages of Gauss methods: steps that the slow motion sets where parts of H are stiff.

The stages solve L − F(L) = 0, F_i = h b_i f(Y_i). A change of L solves the 2ns equations δ_i − h b_i J(Y_i) Σ_j µ_ij
δ_j = F_i − L_i with the Jacobian J of f, taken from the graph in every stage: a stiff spring that turns in the step has
other directions in each, which one J for all, and the s/2 complex systems that it would lead to, do not know. The
factors are kept once the changes are small (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed.,
Springer 1996, § IV.8, doi:10.1007/978-3-642-05221-7). A change comes from the linear equations, never from F alone: the
rounding of large forces does not get into L. Where neighbours act on neighbours the equations form a band, of which
nothing outside is touched.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from canon.kernel.llvm.lane_rows import store_row
from canon.kernel.llvm.solvers.band_solver import BandSolver, band_memory, band_order, is_narrow
from canon.kernel.llvm.solvers.linear_solver import LinearSolver, large_array

if TYPE_CHECKING:
    from collections.abc import Generator, Sequence

    from canon.kernel.llvm.writer import Writer
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["NewtonStages", "newton_stages"]


_FAR = Fraction(2**100)
"""A change that the first one halves."""


@contextlib.contextmanager
def newton_stages(
    w: Writer, v: Writer, system: HamiltonEquations, weight: str, mu: Sequence[str]
) -> Generator[NewtonStages]:
    """Reserve the memory of the factors and yield what writes Newton's changes.

    Parameters
    ----------
    w, v
        Writers of scalars and of lanes, one a stage.
    system
        The equations.
    weight, mu
        h b_i, and the columns µ_ij of every j, in lanes.
    """
    equations = 2 * len(system.q) * len(mu)
    graph, state = system.graph, (*system.q, *system.p)
    slopes = [graph.gradient(rate, state) for rate in (*system.velocity, *system.force)]
    places = [(i, j) for i, row in enumerate(slopes) for j, slope in enumerate(row) if slope != graph.zero]
    order, reach = band_order(places, len(state))
    reach = (reach + 1) * len(mu) - 1  # all stages of a variable beside each other
    narrow = is_narrow(equations, reach)
    with large_array(w, band_memory(equations, reach) if narrow else equations**2) as matrix:
        pivots = w.reserve(f"[{equations} x i64], align 64")
        if narrow:
            solver = BandSolver(w, equations, matrix, pivots, reach)
            unknowns = Unknowns([len(mu) * place for place in order], 1)
        else:
            solver = LinearSolver(w, equations, matrix, pivots)
            unknowns = Unknowns(list(range(len(state))), len(state))
        lanes = v.number.lanes
        shares = w.array(len(mu) * lanes)
        for j, column in enumerate(mu):
            store_row(w, v, v.negative(v.algebra("mul", weight, column)), shares, str(j))
        yield NewtonStages(
            w, v, system, len(mu), [slopes[i][j] for i, j in places], places, solver, unknowns, shares,
            w.array(len(places) * lanes), w.array(solver.right_length), w.array(1), w.reserve("i64"),
        )  # fmt: skip


class Unknowns(NamedTuple):
    """Where the changes of a variable stand: that of the first stage, and how far the next ones are apart."""

    first: Sequence[int]
    apart: int

    def place(self, stage: int, variable: int) -> int:
        """Return the place of a stage's change of a variable."""
        return self.first[variable] + stage * self.apart


@dataclass(frozen=True)
class NewtonStages:
    """Writes Newton's changes of the stages.

    Parameters
    ----------
    w, v, system
        Writers of scalars and of lanes, and the equations.
    stages
        How many there are.
    slopes, places
        The nodes of the entries of J that are not zero, and where they stand.
    solver, unknowns
        The linear equations, and where their unknowns stand.
    shares
        Memory of −h b_i µ_ij.
    jacobian, right
        Memory of J in all stages, and of the right-hand side.
    least
        Memory of the least change so far.
    fresh
        Memory of 1 where J is to be taken anew, else 0.
    """

    w: Writer
    v: Writer
    system: HamiltonEquations
    stages: int
    slopes: Sequence[int]
    places: Sequence[tuple[int, int]]
    solver: LinearSolver
    unknowns: Unknowns
    shares: str
    jacobian: str
    right: str
    least: str
    fresh: str

    def begin(self) -> None:
        """Write that J is to be taken anew."""
        w = self.w
        w.line(f"store i64 1, ptr {self.fresh}")
        w.store(w.constant(_FAR), self.least, 0)

    def halved(self, change: str) -> str:
        """Return whether a change is below half of the least so far; rounding alone does not halve them on and on."""
        w, before = self.w, self.w.load(self.least, 0)
        fewer = w.less(w.algebra("add", change, change), before)
        w.store(w.select(w.less(change, before), change, before), self.least, 0)
        return fewer

    def keep_factors(self, coarse: str) -> None:
        """Write that the factors are kept from now on, unless changes are still large."""
        w = self.w
        w.line(f"store i64 {w.let(f'zext i1 {coarse} to i64')}, ptr {self.fresh}")

    def factorise(self, places: list[str], clock: str) -> None:
        """Write the matrix with J in all stages and factorise it, where it is to be taken anew."""
        w, v, lanes = self.w, self.v, self.v.number.lanes
        with w.loop(0, w.let(f"load i64, ptr {self.fresh}")):
            found = v.program(self.system.program(self.slopes), [*places, clock])
            for k, slope in enumerate(found):
                store_row(w, v, slope, self.jacobian, str(k))
            zero, one = w.constant(Fraction(0)), w.constant(Fraction(1))
            with w.loop(0, self.solver.length) as i:
                w.store(zero, self.solver.matrix, i)
            with w.loop(0, self.solver.size) as i:
                w.store(one, self.solver.row(i), i)
            with w.loop(0, len(self.places)) as k, w.loop(0, self.stages) as i:
                row, column = (
                    w.entry([self.unknowns.first[place[side]] for place in self.places], k) for side in (0, 1)
                )
                slope = w.load(self.jacobian, self._index(k, lanes, i))
                entries = self.solver.row(self._index(i, self.unknowns.apart, row))
                with w.loop(0, self.stages) as j:
                    share = w.load(self.shares, self._index(j, lanes, i))
                    place = self._index(j, self.unknowns.apart, column)
                    w.store(w.multiply_add(share, slope, w.load(entries, place)), entries, place)
            self.solver.factorise()

    def _index(self, k: str, size: int, i: str) -> str:
        """Return k · size + i."""
        return self.w.let(f"add i64 {self.w.let(f'mul i64 {k}, {size}')}, {i}")

    def improved(self, old: Sequence[str], found: Sequence[str]) -> list[str]:
        """Return the stages L + δ after L, ``old``, gave F(L), ``found``."""
        w, v = self.w, self.v
        for i, (before, new) in enumerate(zip(old, found, strict=True)):
            missing = v.algebra("sub", new, before)
            for stage in range(self.stages):
                w.store(v.lane(missing, stage), self.right, self.unknowns.place(stage, i))
        self.solver.solve(self.right)
        empty = [w.constant(Fraction(0))] * (v.number.lanes - self.stages)
        made: list[str] = []
        for i, before in enumerate(old):
            change = [w.load(self.right, self.unknowns.place(stage, i)) for stage in range(self.stages)]
            made.append(v.algebra("add", before, v.from_lanes([*change, *empty])))
        return made
