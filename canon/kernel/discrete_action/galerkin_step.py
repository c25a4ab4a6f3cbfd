"""Galerkin variational steps: polynomial motion over a step that makes a quadrature of the action stationary.

q(τ) = q₀ + Σ_l ∫₀^τ L_l Γ_l with Legendre's polynomials L_l, l < s, in τ = 0 … 1. With forces, by Lagrange and
d'Alembert's principle δ Σ_j w_j L(q_j, v_j, t_j) + Σ_j w_j Q_j δq_j = p₁ δq₁ − p₀ δq₀,

    Σ_j w_j (L_l(c_j)/h p_j + (∫₀^{c_j} L_l − δ_l0) F_j) = δ_l0 p₀,   q₁ = q₀ + Γ₀,   p₁ = p₀ + Σ_j w_j F_j,

p = ∂L/∂v and F = ∂L/∂q + Q at the nodes of the quadrature, w_j = h b_j. The sums are those of one action whatever its
coefficients are rounded to, so that the rounded step is symplectic where there are no forces. Newton's method solves
for Γ; p(q, v) is solved for v where a state is handed out.

Sources: J. E. Marsden, M. West, Discrete mechanics and variational integrators, Acta Numerica 10 (2001) 357–514,
§ 2.2.6, 3.2, doi:10.1017/S096249290100006X; S. Ober-Blöbaum, N. Saake, Construction and analysis of higher order
Galerkin variational integrators, Adv. Comput. Math. 41 (2015) 955–986, doi:10.1007/s10444-014-9394-8.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.discrete_action.repeated_changes import RepeatedChanges
from canon.kernel.llvm.loop import METHOD, Loop, blocks_of, compile_loop, increase, steps_of
from canon.kernel.llvm.number_types import DOUBLE, MachineType
from canon.kernel.llvm.solvers.linear_solver import LinearSolver, large_array
from canon.kernel.llvm.writer import Writer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.program.lagrangian.momenta_and_forces import MomentaAndForces

__all__ = ["galerkin_loop"]

_ITERATIONS = 50

_REMEDY = "the step is too large for Newton's method; take a smaller one, or Taylor()"


def galerkin_loop(
    system: HamiltonEquations,
    lagrangian: MomentaAndForces,
    degree: int,
    points: int,
    *,
    compensated: bool,
    number: MachineType = DOUBLE,
) -> Loop:
    """Compile Galerkin variational steps of polynomials of a degree, with so many points of quadrature.

    After the compensation ``e`` keeps the number of iterations, the last change of an iteration that did not converge,
    whether what follows is known, the state (q, v) with the momenta and their compensation that it was made of, and Γ.
    """
    w, size, n = Writer(number), 2 * len(system.q), len(lagrangian.momenta)
    carry = size + 3 + (4 + degree) * n
    with large_array(w, (degree * n) ** 2) as matrix, large_array(w, n * n) as masses:
        solvers = (
            LinearSolver(w, degree * n, matrix, _pivots(w, degree * n)),
            LinearSolver(w, n, masses, _pivots(w, n)),
        )
        writing = _Galerkin.of(w, system, lagrangian, degree, points, *solvers, compensated=compensated)
        with blocks_of(w, writing.y, writing.e, size, carry) as kept:
            writing.begin(kept)
            with steps_of(w, system) as time:
                writing.step(time, kept)
            writing.end(kept)
    made = compile_loop(w, len(system.q), compensated=compensated, carry=carry)
    return replace(made, iterated="the velocities", remedy=_REMEDY)


def _pivots(w: Writer, rows: int) -> str:
    """Reserve memory for the pivots of so many equations."""
    return w.reserve(f"[{rows} x i64], align 64")


@dataclass(frozen=True)
class _Galerkin:
    """Writes Galerkin variational steps.

    Parameters
    ----------
    w, system, lagrangian, degree, points
        What to write.
    y, e
        The state (q, v) and its compensation or "".
    momenta, lost
        p₀, and what rounding took from it.
    unknown, right
        Γ, and the residual of its equations, which Newton's change takes the place of.
    place, total
        q and v at a node; Σ_j w_j F_j and the work done.
    shares, values
        Of one node: the factors of p and F in each equation, those of Γ in q and in v; p and F, or their slopes.
    equations, masses
        What solves for Γ, and for v.
    changes
        What decides when an iteration ends.
    slopes, entries
        The nodes of ∂(p, F)/∂(q, v) that are not zero; where they stand: the half and the number of row and column.
    """

    w: Writer
    system: HamiltonEquations
    lagrangian: MomentaAndForces
    degree: int
    points: int
    y: str
    e: str
    momenta: str
    lost: str
    unknown: str
    right: str
    place: str
    total: str
    shares: str
    values: str
    equations: LinearSolver
    masses: LinearSolver
    changes: RepeatedChanges
    slopes: Sequence[int]
    entries: Sequence[tuple[int, int, int, int]]

    @classmethod
    def of(
        cls,
        w: Writer,
        system: HamiltonEquations,
        lagrangian: MomentaAndForces,
        degree: int,
        points: int,
        equations: LinearSolver,
        masses: LinearSolver,
        *,
        compensated: bool,
    ) -> _Galerkin:
        n, size = len(lagrangian.momenta), 2 * len(system.q)
        graph, second = system.graph, len(system.q)
        inputs = [(0, k, s) for k, s in enumerate(system.q[:n])] + [
            (1, k, s) for k, s in enumerate(system.p[:n])
        ]
        slopes, entries = list[int](), list[tuple[int, int, int, int]]()
        for half, nodes in enumerate((lagrangian.momenta, lagrangian.forces)):
            for i, node in enumerate(nodes):
                gradient = graph.gradient(node, [s for _, _, s in inputs])
                for slope, (other, k, _) in zip(gradient, inputs, strict=True):
                    if slope != graph.zero:
                        slopes.append(slope)
                        entries.append((half, i, other, k))
        y, e = w.array(size), w.array(size) if compensated else ""
        sizes = degree * n, degree * n, 2 * n, second, 4 * degree, max(len(slopes), n + second)
        gamma, right, place, total, shares, values = map(w.array, sizes)
        return cls(
            w, system, lagrangian, degree, points, y, e, w.array(n), w.array(n), gamma, right, place, total, shares,
            values, equations, masses, RepeatedChanges.of(w), slopes, entries,
        )  # fmt: skip

    # what is kept between calls ----------------------------------------------------------------------

    @property
    def n(self) -> int:
        """Degrees of freedom."""
        return len(self.lagrangian.momenta)

    @property
    def second(self) -> int:
        """Where velocities begin in a state."""
        return len(self.system.q)

    def _kept(self, kept: str) -> list[str]:
        """Return where the flag, q, v, p, its compensation and Γ are kept."""
        start, n = 2 * self.second + 2, self.n
        flag = self.w.at(kept, start)
        return [flag, *(self.w.at(kept, start + 1 + k * n) for k in range(5))]

    def begin(self, kept: str) -> None:
        """Write p₀: that which the state was made of, where it is known, else p(q, v)."""
        w, n = self.w, self.n
        flag, q, v, p, lost, unknown = self._kept(kept)
        w.copy(unknown, self.unknown, self.degree * n)
        same = w.less(w.constant(Fraction(0)), w.load(flag, 0))
        for i in range(n):
            for before, now in ((w.load(q, i), i), (w.load(v, i), self.second + i)):
                apart = w.as_double(w.algebra("sub", before, w.load(self.y, now)))
                same = w.let(f"and i1 {same}, {w.let(f'fcmp oeq double {apart}, 0.0')}")
        state = self._state(
            [w.load(self.y, i) for i in range(n)], [w.load(self.y, self.second + i) for i in range(n)]
        )
        # A motion that goes on from a sample alone begins there, not at the first time.
        now = w.multiply_add(w.whole("%first"), w.load("%c", 1), w.load("%c", 0))
        found = self._evaluated(self.lagrangian.momenta, state, now)
        for i, value in enumerate(found):
            w.store(w.select(same, w.load(p, i), value), self.momenta, i)
            w.store(w.select(same, w.load(lost, i), w.constant(Fraction(0))), self.lost, i)

    def end(self, kept: str) -> None:
        """Write v with p(q, v) = p, and keep what the state is made of."""
        w, n = self.w, self.n
        flag, q, v, p, lost, unknown = self._kept(kept)
        self._find_velocities(kept)
        w.store(w.constant(Fraction(1)), flag, 0)
        w.copy(self.y, q, n)
        w.copy(w.at(self.y, self.second), v, n)
        w.copy(self.momenta, p, n)
        w.copy(self.lost, lost, n)
        w.copy(self.unknown, unknown, self.degree * n)

    def _state(self, q: Sequence[str], v: Sequence[str]) -> list[str]:
        """Return a state with other positions and velocities."""
        state = [self.w.load(self.y, i) for i in range(2 * self.second)]
        state[: self.n], state[self.second : self.second + self.n] = q, v
        return state

    def _evaluated(self, nodes: Sequence[int], state: list[str], time: str) -> list[str]:
        return self.w.program(self.system.program(nodes), [*state, time])

    def _find_velocities(self, kept: str) -> None:
        """Write Newton's method for v, from the velocity with which the last step's polynomial ends."""
        w, n = self.w, self.n
        for i in range(n):
            moved = w.load(self.unknown, i)
            for k in range(1, self.degree):
                moved = w.algebra("add", moved, w.load(self.unknown, k * n + i))
            w.store(w.algebra("mul", w.load("%c", METHOD), moved), self.y, self.second + i)
        after = w.let("add i64 %first, %steps")
        time = w.multiply_add(w.whole(after), w.load("%c", 1), w.load("%c", 0))
        q = [w.load(self.y, i) for i in range(n)]
        masses = [k for k, (half, _, other, _) in enumerate(self.entries) if (half, other) == (0, 1)]
        self.changes.begin()
        with w.loop(0, _ITERATIONS):
            v = [w.load(self.y, self.second + i) for i in range(n)]
            nodes = [*self.lagrangian.momenta, *(self.slopes[k] for k in masses)]
            found = self._evaluated(nodes, self._state(q, v), time)
            with w.loop(0, n * n) as k:
                w.store(w.constant(Fraction(0)), self.masses.matrix, k)
            for k, slope in zip(masses, found[n:], strict=True):
                _, i, _, j = self.entries[k]
                w.store(slope, self.masses.matrix, i * n + j)
            for i, value in enumerate(found[:n]):
                missing = w.algebra("sub", w.load(self.momenta, i), value)
                w.store(w.algebra("add", missing, w.load(self.lost, i)), self.right, i)
            self.masses.factorise()
            self.masses.solve(self.right)
            self.changes.count()
            with w.loop(0, n) as i:
                here = w.at(self.y, self.second)
                change = w.load(self.right, i)
                new = w.algebra("add", w.load(here, i), change)
                w.store(new, here, i)
                self.changes.note(change, new)
                if self.e:
                    w.store(w.constant(Fraction(0)), self.e, w.let(f"add i64 {i}, {self.second}"))
            w.leave_if(self.changes.settled())
        self._lose_where_not_converged(kept)

    def _lose_where_not_converged(self, kept: str) -> None:
        """Write NaN over the state where the iteration has not converged, and by how much."""
        w, failed = self.w, 2 * self.second + 1
        lost, change = self.changes.result()
        before = w.load(kept, failed)
        none = w.let(f"fcmp oeq double {w.as_double(before)}, 0.0")
        first = w.let(f"and i1 {lost}, {none}")
        w.store(w.select(first, change, before), kept, failed)
        nothing = w.widened(self.changes.g.nan(), self.changes.g.number)
        with w.loop(0, 2 * self.second) as i:
            w.store(w.select(lost, nothing, w.load(self.y, i)), self.y, i)

    # a step ------------------------------------------------------------------------------------------

    def _table(self, which: int) -> str:
        """Return the address of a part of the coefficients: nodes, weights, L, ∫L, prediction."""
        r, s = self.points, self.degree
        return self.w.at("%c", METHOD + 1 + (0, r, 2 * r, 2 * r + s * r, 2 * r + 2 * s * r)[which])

    def step(self, time: str, kept: str) -> None:
        """Write one step."""
        w, n, count = self.w, self.n, 2 * self.second
        self._predict()
        self.changes.begin()
        with w.loop(0, _ITERATIONS):
            w.store(w.algebra("add", w.load(kept, count), w.constant(Fraction(1))), kept, count)
            self._residual(time)
            with w.loop(0, self.changes.coarse()):
                self._matrix(time)
            self.equations.solve(self.right)
            self.changes.count()
            with w.loop(0, self.degree * n) as i:
                change = w.load(self.right, i)
                new = w.algebra("sub", w.load(self.unknown, i), change)
                w.store(new, self.unknown, i)
                self.changes.note(change, new)
            for i in range(n):
                self.changes.reach(w.load(self.y, i))
            w.leave_if(self.changes.settled())
        self._residual(time)
        with w.loop(0, n) as i:
            increase(w, self.y, self.e, i, w.constant(Fraction(1)), w.load(self.unknown, i))
            increase(w, self.momenta, self.lost, i, w.constant(Fraction(1)), w.load(self.total, i))
        for i in range(n, self.second):
            if self.system.velocity[i] != self.system.graph.zero:
                increase(w, self.y, self.e, str(i), w.constant(Fraction(1)), w.load(self.total, i))
        self._lose_where_not_converged(kept)

    def _predict(self) -> None:
        """Write the polynomial of the last step continued over Γ."""
        w, n, table = self.w, self.n, self._table(4)
        with w.loop(0, n) as i:
            places = [w.let(f"add i64 {i}, {m * n}") for m in range(self.degree)]
            old = [w.load(self.unknown, place) for place in places]
            for k, place in enumerate(places):
                total = w.constant(Fraction(0))
                for m in range(self.degree):
                    total = w.multiply_add(w.load(table, k * self.degree + m), old[m], total)
                w.store(total, self.unknown, place)

    def _at_node(self, j: str, time: str) -> tuple[list[str], str]:
        """Write the state and the time at a node, and the node's shares."""
        w, n, s, r = self.w, self.n, self.degree, self.points
        rate, weight = w.load("%c", METHOD), w.load(self._table(1), j)
        for k in range(s):
            index = w.let(f"add i64 {j}, {k * r}")
            value, integral = w.load(self._table(2), index), w.load(self._table(3), index)
            slope = w.algebra("mul", rate, value)
            less = w.algebra("sub", integral, w.constant(Fraction(1))) if k == 0 else integral
            shares = w.algebra("mul", weight, slope), w.algebra("mul", weight, less), integral, slope
            for part, share in enumerate(shares):
                w.store(share, self.shares, part * s + k)
        with w.loop(0, n) as i:
            moved, speed = w.load(self.e, i) if self.e else w.constant(Fraction(0)), w.constant(Fraction(0))
            for k in range(s):
                own = w.load(self.unknown, w.let(f"add i64 {i}, {k * n}"))
                moved = w.multiply_add(w.load(self.shares, 2 * s + k), own, moved)
                speed = w.multiply_add(w.load(self.shares, 3 * s + k), own, speed)
            w.store(w.algebra("add", w.load(self.y, i), moved), self.place, i)
            w.store(speed, self.place, w.let(f"add i64 {i}, {n}"))
        place = [w.load(self.place, i) for i in range(2 * n)]
        return self._state(place[:n], place[n:]), w.algebra("add", time, w.load(self._table(0), j))

    def _residual(self, time: str) -> None:
        """Write what the equations for Γ miss, and Σ_j w_j F_j with the work."""
        w, n, s = self.w, self.n, self.degree
        with w.loop(0, s * n) as i:
            w.store(w.constant(Fraction(0)), self.right, i)
        for i in range(n):
            p = w.algebra("add", w.load(self.momenta, i), w.load(self.lost, i))
            w.store(w.negative(p), self.right, i)
        with w.loop(0, self.second) as i:
            w.store(w.constant(Fraction(0)), self.total, i)
        others = [i for i in range(n, self.second) if self.system.velocity[i] != self.system.graph.zero]
        with w.loop(0, self.points) as j:
            state, clock = self._at_node(j, time)
            nodes = [*self.lagrangian.nodes, *(self.system.velocity[i] for i in others)]
            found = self._evaluated(nodes, state, clock)
            for k, value in enumerate(found):
                w.store(value, self.values, k)
            weight = w.load(self._table(1), j)
            with w.loop(0, n) as i:
                p, force = w.load(self.values, i), w.load(self.values, w.let(f"add i64 {i}, {n}"))
                for k in range(s):
                    place = w.let(f"add i64 {i}, {k * n}")
                    total = w.multiply_add(w.load(self.shares, k), p, w.load(self.right, place))
                    total = w.multiply_add(w.load(self.shares, s + k), force, total)
                    w.store(total, self.right, place)
                w.store(w.multiply_add(weight, force, w.load(self.total, i)), self.total, i)
            for i, rate in zip(others, found[2 * n :], strict=True):
                w.store(w.multiply_add(weight, rate, w.load(self.total, i)), self.total, i)

    def _matrix(self, time: str) -> None:
        """Write the slopes of the equations for Γ, and factorise them."""
        w, n, s = self.w, self.n, self.degree
        with w.loop(0, self.equations.size**2) as i:
            w.store(w.constant(Fraction(0)), self.equations.matrix, i)
        with w.loop(0, self.points) as j:
            state, clock = self._at_node(j, time)
            found = self._evaluated(self.slopes, state, clock)
            for k, slope in enumerate(found):
                w.store(slope, self.values, k)
            with w.loop(0, len(self.entries)) as each:
                half, i, other, k = (
                    w.entry([entry[side] for entry in self.entries], each) for side in range(4)
                )
                slope = w.load(self.values, each)
                of_row, of_column = (
                    self._part_of_shares(half),
                    self._part_of_shares(w.let(f"add i64 {other}, 2")),
                )
                with w.loop(0, s) as row:
                    share = w.algebra("mul", w.load(of_row, row), slope)
                    entries = self.equations.row(self._index(row, n, i))
                    with w.loop(0, s) as column:
                        place = self._index(column, n, k)
                        total = w.multiply_add(share, w.load(of_column, column), w.load(entries, place))
                        w.store(total, entries, place)
        self.equations.factorise()

    def _part_of_shares(self, part: str) -> str:
        return self.w.at(self.shares, self.w.let(f"mul i64 {part}, {self.degree}"))

    def _index(self, k: str, size: int, i: str) -> str:
        """Return k · size + i."""
        return self.w.let(f"add i64 {self.w.let(f'mul i64 {k}, {size}')}, {i}")
