"""Nonholonomic leapfrog steps: A(q) v = 0 kept by multipliers where a step begins and ends, symmetric, so reversible.

With L = K(q, v) − V(q), p = ∂K/∂v, R = ∂K/∂q + F with other forces F, and q½ = q₀ + h/2 v₀, q₁ = q½ + h/2 v₁:

    p(q₁, v₁) − p(q₀, v₀) = h/2 (R(q₀, v₀) + R(q₁, v₁)) − h ∂V/∂q(q½) + h A(q½)ᵀ λ,  A(q₁) v₁ + a(q₁) = 0,

the discrete Lagrange–d'Alembert equations of K at the middle between the places q½ of two steps, and of V at those
places: momenta of symmetries along which the constraints allow motion are kept to rounding. What holds the time has it
at the same places. Newton's method finds v₁ and λ; what compensation carries counts in the constraints, so that it is
the state with it that fulfils them. The work done is that of the mean of both ends' powers.

Sources: R. McLachlan, M. Perlmutter, Integrators for nonholonomic mechanical systems, J. Nonlinear Sci. 16 (2006)
283–328, doi:10.1007/s00332-005-0698-1; J. Cortés, S. Martínez, Non-holonomic integrators, Nonlinearity 14 (2001)
1365–1392, doi:10.1088/0951-7715/14/5/322.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from canon.kernel.llvm.loop import METHOD, Loop, blocks_of, compile_loop, increase, steps_of
from canon.kernel.llvm.number_types import DOUBLE, SINGLE, MachineType
from canon.kernel.llvm.solvers.linear_solver import LinearSolver, eliminated, magnitude
from canon.kernel.llvm.writer import Writer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.program.nonholonomic_system import NonholonomicSystem

__all__ = ["nonholonomic_loop"]

_ITERATIONS = 50

_SMALL = 8
"""Up to so many velocities and constraints equations are eliminated in registers; more by pivots in memory."""

_HALF = Fraction(1, 2)

Matrix = list[list[str]]
"""Registers of a matrix, "" where an entry is 0."""


def nonholonomic_loop(
    system: HamiltonEquations,
    nonholonomic: NonholonomicSystem,
    weights: int,
    *,
    compensated: bool,
    number: MachineType = DOUBLE,
) -> Loop:
    """Compile compositions of so many leapfrog steps; the coefficients are h w₁, h w₂ …

    After the compensation ``e`` keeps the number of iterations, and the last change of one that did not converge.
    """
    w, size = Writer(number), 2 * len(system.q)
    writing = _Leapfrog.of(w, system, nonholonomic, compensated=compensated)
    with blocks_of(w, writing.y, writing.e, size, size + 2) as kept, steps_of(w, system) as time:
        w.store(time, writing.clock, 0)
        with w.loop(0, weights) as i:
            writing.step(w.load("%c", w.let(f"add i64 {i}, {METHOD}")), kept)
    made = compile_loop(w, len(system.q), compensated=compensated, carry=size + 2)
    return replace(made, iterated="the velocities and multipliers", remedy="take a smaller step, or Taylor()")


class _Tables(NamedTuple):
    """Registers of what the equations of a step hold at one place; "" for an entry that is 0."""

    masses: list[list[str]]
    turning: list[list[str]]
    stiffness: list[list[str]]
    rows: list[list[str]]
    slopes: list[list[str]]
    rests: list[str]
    pull: list[str]
    momenta: list[str]


@dataclass(frozen=True)
class _Leapfrog:
    """Writes leapfrog steps.

    Parameters
    ----------
    w, g, system, of_rolling
        Writers in the loop's numbers and in those, no wider than doubles, in which changes are watched; the system.
    y, e
        The state and its compensation or "".
    clock
        t₀ and t₁.
    change, multipliers
        v₁ − v₀, and h λ.
    wanted
        What p₁ − h/2 R₁ − h Aᵀλ is to be; where p = M v + c, what M (v₁ − v₀) − h/2 R₁ − h Aᵀλ is to be.
    place, lost
        q₁, and what rounding took from it.
    pushes
        A(q½), row by row.
    watched
        Σ M δ² of the last change of v₁ in parts of Σ M v².
    many
        What solves equations in memory, where they are many, and its right-hand side.
    """

    w: Writer
    g: Writer
    system: HamiltonEquations
    of_rolling: NonholonomicSystem
    y: str
    e: str
    clock: str
    change: str
    multipliers: str
    wanted: str
    place: str
    lost: str
    pushes: str
    watched: str
    many: tuple[LinearSolver, str] | None

    @classmethod
    def of(
        cls, w: Writer, system: HamiltonEquations, given: NonholonomicSystem, *, compensated: bool
    ) -> _Leapfrog:
        n, k, size = len(given.kick), len(given.rows), 2 * len(system.q)
        g, m = w.in_numbers(w.number if w.number == SINGLE else DOUBLE), n + k
        many = None
        if m > _SMALL:
            many = LinearSolver(w, m, w.array(m * m), w.reserve(f"[{m} x i64], align 64")), w.array(m)
        y, e = w.array(size), w.array(size) if compensated else ""
        change, wanted, place, lost = (w.array(n) for _ in range(4))
        return cls(
            w, g, system, given, y, e, w.array(2), change, w.array(k), wanted, place, lost, w.array(k * n),
            g.array(1), many,
        )  # fmt: skip

    @property
    def n(self) -> int:
        return len(self.of_rolling.kick)

    @property
    def k(self) -> int:
        return len(self.of_rolling.rows)

    @property
    def second(self) -> int:
        """Where velocities begin in a state."""
        return len(self.system.q)

    def _evaluated(self, nodes: Sequence[int], time: str, q: Sequence[str], v: Sequence[str]) -> list[str]:
        """Write nodes at a time, places and velocities."""
        w, m = self.w, self.second
        state = [w.load(self.y, i) for i in range(2 * m)]
        state[: self.n], state[m : m + self.n] = q, v
        return w.program(self.system.program(nodes), [*state, time])

    def _loaded(self, array: str, first: int = 0) -> list[str]:
        return [self.w.load(array, first + i) for i in range(self.n)]

    def _carried(self, i: int) -> str:
        """Return what compensation carries of a component."""
        return self.w.load(self.e, i) if self.e else self.w.constant(Fraction(0))

    def step(self, length: str, kept: str) -> None:
        """Write one leapfrog step of that length."""
        w, g, size = self.w, self.g, 2 * self.second
        half = w.algebra("mul", w.constant(_HALF), length)
        w.store(w.algebra("add", w.load(self.clock, 0), length), self.clock, 1)
        self._set_out(length, half)
        with w.loop(0, _ITERATIONS):
            w.store(w.algebra("add", w.load(kept, size), w.constant(Fraction(1))), kept, size)
            self._move(length, half)
            self._improve(half, moving=True)
            w.leave_if(self._is_near())
        self._move(length, half)
        self._improve(half, moving=False)
        wrong = w.let(f"xor i1 {self._is_near()}, true")
        last = w.widened(g.load(self.watched, 0), g.number)
        w.store(w.select(wrong, last, w.load(kept, size + 1)), kept, size + 1)
        self._work(half)
        self._arrive(wrong)
        w.store(w.load(self.clock, 1), self.clock, 0)
        self._work(half)

    def _is_near(self) -> str:
        """Return whether one more change, which squares the error, leaves rounding only; the squares are watched."""
        bits = self.w.number.mantissa + 8
        return self.g.less(self.g.load(self.watched, 0), self.g.constant(Fraction(1, 2**bits)))

    def _set_out(self, length: str, half: str) -> None:
        """Write what is wanted and A(q½), and begin with v₁ = v₀, λ = 0."""
        w, given = self.w, self.of_rolling
        q, v = self._loaded(self.y), self._loaded(self.y, self.second)
        middle = [
            w.algebra("add", x, w.multiply_add(half, speed, self._carried(i)))
            for i, (x, speed) in enumerate(zip(q, v, strict=True))
        ]
        begins = w.load(self.clock, 0)
        nodes = [*given.kick, *(node for row in given.rows for node in row)]
        found = self._evaluated(nodes, w.algebra("add", begins, half), middle, v)
        wanted = [w.algebra("mul", length, kick) for kick in found[: self.n]]
        here = self._evaluated([*given.pull, *self._momenta], begins, q, v)
        for i, value in enumerate(wanted):
            total = w.multiply_add(half, here[i], value)
            w.store(total if given.steady else w.algebra("add", here[self.n + i], total), self.wanted, i)
            w.store(w.constant(Fraction(0)), self.change, i)
        for place, value in enumerate(found[self.n :]):
            w.store(value, self.pushes, place)
        for a in range(self.k):
            w.store(w.constant(Fraction(0)), self.multipliers, a)

    def _move(self, length: str, half: str) -> None:
        """Write q₁ = q₀ + h v₀ + h/2 (v₁ − v₀), and what rounding takes from it."""
        w = self.w
        for i in range(self.n):
            q, v = w.load(self.y, i), w.load(self.y, self.second + i)
            step = w.multiply_add(half, w.load(self.change, i), self._carried(i))
            step = w.multiply_add(length, v, step)
            if self.e:
                step = w.multiply_add(length, self._carried(self.second + i), step)
            new = w.algebra("add", q, step)
            w.store(w.algebra("sub", step, w.algebra("sub", new, q)), self.lost, i)
            w.store(new, self.place, i)

    def _after(self) -> tuple[list[str], list[str]]:
        """Write v₁ with the change so far, and what rounding takes from it."""
        w, v, lost = self.w, list[str](), list[str]()
        for i in range(self.n):
            old = w.load(self.y, self.second + i)
            step = w.algebra("add", w.load(self.change, i), self._carried(self.second + i))
            v.append(w.algebra("add", old, step))
            lost.append(w.algebra("sub", step, w.algebra("sub", v[-1], old)))
        return v, lost

    def _improve(self, half: str, *, moving: bool) -> None:
        """Write a step of Newton's method for v₁ − v₀ and λ; at a place q₁ that does not move any more, or does."""
        w, n = self.w, self.n
        v, lost = self._after()
        at = self._tables(v)
        square = w.algebra("mul", half, half)
        balance = [self._balance(at, i, half, square if moving else "") for i in range(n)]
        slips = [self._slips(at, a, half if moving else "", v, lost) for a in range(self.k)]
        both = self._solved(
            [row for row, _ in (*balance, *slips)], [right for _, right in (*balance, *slips)]
        )
        self._note(both[:n], [at.masses[i][i] for i in range(n)], v)
        for i, value in enumerate(both):
            array, place = (self.change, i) if i < n else (self.multipliers, i - n)
            w.store(w.algebra("add", w.load(array, place), value), array, place)

    def _tables(self, v: Sequence[str]) -> _Tables:
        """Write what the equations hold at the place, with the velocities after the step."""
        given = self.of_rolling
        tables = given.masses, given.turning, given.stiffness, given.rows, given.slopes
        nodes = [node for table in tables for row in table for node in row]
        nodes += [*given.rests, *given.pull, *self._momenta]
        found = iter(self._evaluated(nodes, self.w.load(self.clock, 1), self._loaded(self.place), v))
        masses, turning, stiffness, rows, slopes = (
            [[self._entry(node, next(found)) for node in row] for row in table] for table in tables
        )
        rests, pull = [next(found) for _ in given.rests], [next(found) for _ in given.pull]
        return _Tables(masses, turning, stiffness, rows, slopes, rests, pull, list(found))

    def _balance(self, at: _Tables, i: int, half: str, square: str) -> tuple[list[str], str]:
        """Write the row of a momentum, and what is lacking of it; with h²/4 where the place moves."""
        w, row = self.w, at.masses[i]
        if square:
            row = [
                self._sum((m, ""), (half, turn), (w.negative(square), stiff))
                for m, turn, stiff in zip(row, at.turning[i], at.stiffness[i], strict=True)
            ]
        pushes = [self._push(a, i) for a in range(self.k)]
        missing = w.multiply_add(half, at.pull[i], w.load(self.wanted, i))
        if at.momenta:
            missing = w.algebra("sub", missing, at.momenta[i])
        return [*row, *pushes], self._pushed(missing, i, () if at.momenta else at.masses[i])

    def _slips(
        self, at: _Tables, a: int, half: str, v: Sequence[str], lost: Sequence[str]
    ) -> tuple[list[str], str]:
        """Write the row of a constraint, and how far it is missed; with h/2 where the place moves."""
        row, terms = at.rows[a], [(at.rows[a], v)]
        if half:
            row = [
                self._sum((slope, ""), (half, turn)) for slope, turn in zip(row, at.slopes[a], strict=True)
            ]
        if self.e:
            terms.insert(0, (at.slopes[a], self._loaded(self.lost)))
        if self._carries_velocities:
            terms.insert(0, (at.rows[a], lost))
        return [*row, *[""] * self.k], self._slip(at.rests[a], terms)

    def _entry(self, node: int, register: str) -> str:
        return "" if node == self.system.graph.zero else register

    def _push(self, a: int, i: int) -> str:
        """Write −A(q½)_ai."""
        if self.of_rolling.rows[a][i] == self.system.graph.zero:
            return ""
        return self.w.negative(self.w.load(self.pushes, a * self.n + i))

    def _sum(self, *terms: tuple[str, str]) -> str:
        """Write a sum of products a b, or of a alone where b is ""; the first is the sum's first term."""
        w, (total, _), rest = self.w, terms[0], terms[1:]
        for factor, entry in rest:
            if entry:
                total = w.multiply_add(factor, entry, total) if total else w.algebra("mul", factor, entry)
        return total

    @property
    def _momenta(self) -> tuple[int, ...]:
        """What is evaluated of momenta: nothing where they are M v and a constant."""
        return () if self.of_rolling.steady else self.of_rolling.momenta

    def _pushed(self, total: str, i: int, masses: Sequence[str]) -> str:
        """Write what is lacking of momentum i less M (v₁ − v₀), and with what the multipliers push."""
        w = self.w
        for j, mass in enumerate(masses):
            if mass:
                total = w.multiply_add(w.negative(mass), w.load(self.change, j), total)
        for a, row in enumerate(self.of_rolling.rows):
            if row[i] != self.system.graph.zero:
                push = w.load(self.pushes, a * self.n + i)
                total = w.multiply_add(push, w.load(self.multipliers, a), total)
        return total

    def _slip(self, rest: str, terms: Sequence[tuple[Sequence[str], Sequence[str]]]) -> str:
        """Write −a less sums of products: of A with v₁, and of slopes with what rounding took and is carried along."""
        w, total = self.w, self.w.negative(rest)
        for row, factors in terms:
            for entry, factor in zip(row, factors, strict=True):
                if entry:
                    total = w.multiply_add(w.negative(entry), factor, total)
        return total

    @property
    def _carries_velocities(self) -> bool:
        """Whether what rounding takes from velocities is carried along; momenta would take as much from it."""
        return bool(self.e) and self.of_rolling.steady

    def _note(self, change: Sequence[str], masses: Sequence[str], v: Sequence[str]) -> None:
        """Write Σ M δ² / Σ M (v₁² + (v₁ − v₀)²), infinite where it is no number."""
        w, g = self.w, self.g
        changed, moved = g.constant(Fraction(0)), g.constant(Fraction(0))
        for i, (delta, mass, speed) in enumerate(zip(change, masses, v, strict=True)):
            weight = magnitude(w, mass)
            for x in (speed, w.load(self.change, i)):
                size = magnitude(w, x)
                moved = g.multiply_add(g.algebra("mul", weight, size), size, moved)
            size = magnitude(w, delta)
            changed = g.multiply_add(g.algebra("mul", weight, size), size, changed)
        rests = g.equal(changed, g.constant(Fraction(0)))
        part = g.select(rests, changed, g.algebra("div", changed, moved))
        known = g.less(part, g.infinity())
        g.store(g.select(known, part, g.infinity()), self.watched, 0)

    def _arrive(self, wrong: str) -> None:
        """Write (q₁, v₁) over (q₀, v₀), NaN where they were not found."""
        w, (v, lost) = self.w, self._after()
        nothing = w.widened(self.g.nan(), self.g.number)
        for i in range(self.n):
            w.store(w.select(wrong, nothing, w.load(self.place, i)), self.y, i)
            w.store(v[i], self.y, self.second + i)
            if self.e:
                w.store(w.load(self.lost, i), self.e, i)
                rest = lost[i] if self._carries_velocities else w.constant(Fraction(0))
                w.store(rest, self.e, self.second + i)

    def _work(self, half: str) -> None:
        """Write the work of the power here in half a step."""
        if not self.of_rolling.works:
            return
        w, n = self.w, self.n
        here, v = self._loaded(self.y), self._loaded(self.y, self.second)
        (power,) = self._evaluated([self.system.velocity[n]], w.load(self.clock, 0), here, v)
        increase(w, self.y, self.e, str(n), half, power)

    def _solved(self, matrix: Matrix, right: Sequence[str]) -> list[str]:
        """Write the solution of linear equations."""
        w = self.w
        if self.many is None:
            return eliminated(w, matrix, right)
        solver, place = self.many
        zero = w.constant(Fraction(0))
        for a, row in enumerate(matrix):
            w.store(right[a], place, a)
            for b, entry in enumerate(row):
                w.store(entry or zero, solver.matrix, a * solver.size + b)
        solver.factorise()
        solver.solve(place)
        return [w.load(place, a) for a in range(solver.size)]
