"""RATTLE steps: positions held on g(q) = 0 and velocities along it by multipliers, symmetric and symplectic.

P½ = P₀ + h/2 (F(q₀, P½) + push₀ λ), q₁ = q₀ + h/2 (V(q₀, P½) + V(q₁, P½)), g(q₁) = 0; P₁ = P½ + h/2 (F(q₁, P½) +
push₁ µ), G(q₁) V(q₁, P₁) = 0, with P the momenta, or the velocities where masses are constant: then only λ is implicit.
Newton's method finds λ, beginning with the µ of the last step; what compensation carries counts in g, so that it is the
state q + e that lies on the constraints.

Sources: H. C. Andersen, J. Comput. Phys. 52 (1983) 24–34, doi:10.1016/0021-9991(83)90014-1; E. Hairer, C. Lubich,
G. Wanner, Geometric Numerical Integration (2nd ed., Springer 2006), § VII.1.4, (1.26), doi:10.1007/3-540-30666-8.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.loop import METHOD, Loop, blocks_of, compile_loop, steps_of
from canon.kernel.llvm.number_types import DOUBLE, SINGLE, MachineType
from canon.kernel.llvm.solvers.linear_solver import LinearSolver, eliminated, magnitude
from canon.kernel.llvm.writer import Writer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.program.holonomic_system import HolonomicSystem

__all__ = ["rattle_loop"]

_ITERATIONS = 50

_REFINED = 2
"""How often the multipliers of the velocities are solved for: the second time for what rounding left."""

_SMALL = 6
"""Up to so many constraints equations are eliminated in registers; more by pivots in memory."""


def rattle_loop(
    system: HamiltonEquations,
    holonomic: HolonomicSystem,
    weights: int,
    *,
    compensated: bool,
    number: MachineType = DOUBLE,
) -> Loop:
    """Compile compositions of so many RATTLE steps; the coefficients are h w₁, h w₂ …

    After the compensation ``e`` keeps the number of iterations, the last relative residual of a constraint that did not
    come to vanish, and the multipliers.
    """
    w, size, k = Writer(number), 2 * len(system.q), len(holonomic.values)
    writing = _Rattle.of(w, system, holonomic, compensated=compensated)
    with blocks_of(w, writing.y, writing.e, size, size + 2 + k) as kept:
        multipliers = w.at(kept, size + 2)
        w.copy(multipliers, writing.multipliers, k)
        writing.look_at_place()
        with steps_of(w, system):
            if holonomic.momenta:
                writing.set_momenta()
            with w.loop(0, weights) as i:
                writing.step(w.load("%c", w.let(f"add i64 {i}, {METHOD}")), kept)
            if holonomic.momenta:
                writing.set_velocities()
        w.copy(writing.multipliers, multipliers, k)
    made = compile_loop(w, len(system.q), compensated=compensated, carry=size + 2 + k)
    return replace(made, iterated="the multipliers", remedy="take a smaller step, or Taylor()")


@dataclass(frozen=True)
class _Rattle:
    """Writes RATTLE steps.

    Parameters
    ----------
    w, g, system, holonomic
        Writers in the loop's numbers and in those, no wider than doubles, in which residuals are watched; the system.
    y, e
        The state and its compensation or "".
    momenta
        P, where it is not the velocities.
    half
        P½ − P₀.
    place, lost
        q₁, and what rounding took from it.
    forces, pushes, shares, slopes
        F, push, M⁻¹Gᵀ and G at the place where the motion stands; F only where it does not depend on P.
    multipliers, residuals
        λ, and g or G V.
    watched
        The relative residual, and the least so far.
    matrix
        What solves for multipliers in memory, where they are many.
    """

    w: Writer
    g: Writer
    system: HamiltonEquations
    holonomic: HolonomicSystem
    y: str
    e: str
    momenta: str
    half: str
    place: str
    lost: str
    forces: str
    pushes: str
    shares: str
    slopes: str
    multipliers: str
    residuals: str
    watched: str
    matrix: LinearSolver | None

    @classmethod
    def of(
        cls, w: Writer, system: HamiltonEquations, holonomic: HolonomicSystem, *, compensated: bool
    ) -> _Rattle:
        n, k, size = len(holonomic.velocity), len(holonomic.values), 2 * len(system.q)
        g = w.in_numbers(w.number if w.number == SINGLE else DOUBLE)
        many = None
        if k > _SMALL:
            many = LinearSolver(w, k, w.array(k * k), w.reserve(f"[{k} x i64], align 64"))
        y, e = w.array(size), w.array(size) if compensated else ""
        momenta, half, place, lost, forces = (w.array(n) for _ in range(5))
        pushes, shares, slopes = (w.array(k * n) for _ in range(3))
        return cls(
            w, g, system, holonomic, y, e, momenta, half, place, lost, forces, pushes, shares, slopes,
            w.array(k), w.array(k), g.array(2), many,
        )  # fmt: skip

    @property
    def n(self) -> int:
        return len(self.holonomic.velocity)

    @property
    def k(self) -> int:
        return len(self.holonomic.values)

    @property
    def second(self) -> int:
        """Where velocities begin in a state."""
        return len(self.system.q)

    def _momentum(self, i: int) -> tuple[str, int]:
        """Return where P_i stands."""
        return (self.momenta, i) if self.holonomic.momenta else (self.y, self.second + i)

    def _carried(self, i: int) -> str:
        """Return what compensation carries of a component."""
        return self.w.load(self.e, i) if self.e else self.w.constant(Fraction(0))

    def _evaluated(self, nodes: Sequence[int], q: Sequence[str], P: Sequence[str] | None = None) -> list[str]:
        """Write nodes at positions and momenta."""
        w, m = self.w, self.second
        state = [w.load(self.y, i) for i in range(2 * m)]
        state[: self.n] = q
        if P is not None:
            state[m : m + self.n] = P
        return w.program(self.system.program(nodes), [*state, w.load("%c", 0)])

    def _here(self) -> list[str]:
        return [self.w.load(self.y, i) for i in range(self.n)]

    def _there(self) -> list[str]:
        return [self.w.load(self.place, i) for i in range(self.n)]

    def _dot(self, row: Sequence[int], table: str, a: int, x: Sequence[str]) -> str:
        """Write Σ_i G_ai x_i; entries whose nodes are 0 are passed over."""
        w, total = self.w, self.w.constant(Fraction(0))
        for i in self._filled(row):
            total = w.multiply_add(w.load(table, a * self.n + i), x[i], total)
        return total

    def _filled(self, row: Sequence[int]) -> list[int]:
        return [i for i, node in enumerate(row) if node != self.system.graph.zero]

    def set_momenta(self) -> None:
        """Write P = p(q, v)."""
        for i, p in enumerate(self._evaluated(self.holonomic.momenta, self._here())):
            self.w.store(p, self.momenta, i)

    def set_velocities(self) -> None:
        """Write v = V(q, P)."""
        w = self.w
        P = [w.load(self.momenta, i) for i in range(self.n)]
        for i, v in enumerate(self._evaluated(self.holonomic.velocity, self._here(), P)):
            w.store(v, self.y, self.second + i)
            if self.e:
                w.store(w.constant(Fraction(0)), self.e, self.second + i)

    def look_at_place(self) -> None:
        """Write what is needed of the place where the motion stands."""
        h = self.holonomic
        rows = [node for table in (h.slopes, h.pushes, h.shares) for row in table for node in row]
        found = self._evaluated([*rows, *self._plain_forces], self._here())
        size = self.k * self.n
        for place, table in enumerate((self.slopes, self.pushes, self.shares)):
            for i, value in enumerate(found[place * size : (place + 1) * size]):
                self.w.store(value, table, i)
        for i, value in enumerate(found[3 * size :]):
            self.w.store(value, self.forces, i)

    @property
    def _plain_forces(self) -> tuple[int, ...]:
        """F where it does not depend on P."""
        return () if self.holonomic.momenta else self.holonomic.force

    def step(self, length: str, kept: str) -> None:
        """Write one RATTLE step of that length."""
        w, g, size = self.w, self.g, 2 * self.second
        half = w.algebra("mul", w.constant(Fraction(1, 2)), length)
        for slot in range(2):
            g.store(g.infinity(), self.watched, slot)
        for i in range(self.n):
            w.store(w.load(self.y, i), self.place, i)
            w.store(w.constant(Fraction(0)), self.half, i)
        with w.loop(0, _ITERATIONS):
            w.store(w.algebra("add", w.load(kept, size), w.constant(Fraction(1))), kept, size)
            moved = self._move(length, half)
            w.leave_if(self._is_near(g.load(self.watched, 0)))
            self._correct(w.algebra("mul", length, half), moved)
        # Where rounding is larger than thought, as in large systems, the iteration ends by its count and is accepted.
        bits = w.number.mantissa * 3 // 4 if self.holonomic.momenta else self._bits
        enough = g.less(g.load(self.watched, 0), g.constant(Fraction(1, 2**bits)))
        wrong = w.let(f"xor i1 {enough}, true")
        residual = w.widened(g.load(self.watched, 0), g.number)
        w.store(w.select(wrong, residual, w.load(kept, size + 1)), kept, size + 1)
        self._arrive()
        self._project(half)
        nothing = w.widened(g.nan(), g.number)
        for i in range(self.n):
            w.store(w.select(wrong, nothing, w.load(self.y, i)), self.y, i)

    def _is_near(self, residual: str) -> str:
        """Return whether one more change, which squares the residual, leaves rounding only."""
        return self.g.less(residual, self.g.constant(Fraction(1, 2**self._bits)))

    @property
    def _bits(self) -> int:
        if self.holonomic.momenta:  # positions and momenta are iterated too, which gains a few bits at a time
            return self.w.number.mantissa - 2
        return self.w.number.mantissa // 2 + 4

    def _move(self, length: str, half: str) -> list[str]:
        """Write P½ and q₁ with the multipliers so far, and return q₁ − q₀."""
        w, here = self.w, self._here()
        forces = [w.load(self.forces, i) for i in range(self.n)]
        if self.holonomic.momenta:
            forces = self._evaluated(self.holonomic.force, here, self._halfway())
        for i in range(self.n):
            total = self._pushed(forces[i], i)
            carried = w.constant(Fraction(0)) if self.holonomic.momenta else self._carried(self.second + i)
            w.store(w.multiply_add(half, total, carried), self.half, i)
        moved: list[str] = []
        if self.holonomic.momenta:
            P, V = self._halfway(), self.holonomic.velocity
            both = zip(self._evaluated(V, here, P), self._evaluated(V, self._there(), P), strict=True)
            for i, (a, b) in enumerate(both):
                moved.append(w.multiply_add(half, w.algebra("add", a, b), self._carried(i)))
        else:
            for i in range(self.n):
                own = w.multiply_add(length, w.load(self.half, i), self._carried(i))
                moved.append(w.multiply_add(length, w.load(*self._momentum(i)), own))
        self._note_change(here, moved)
        for i, (q, step) in enumerate(zip(here, moved, strict=True)):
            new = w.algebra("add", q, step)
            w.store(w.algebra("sub", step, w.algebra("sub", new, q)), self.lost, i)
            w.store(new, self.place, i)
        return moved

    def _pushed(self, force: str, i: int) -> str:
        """Write F_i + Σ_a push_ai λ_a."""
        w, total = self.w, force
        for a, row in enumerate(self.holonomic.pushes):
            if row[i] != self.system.graph.zero:
                total = w.multiply_add(
                    w.load(self.pushes, a * self.n + i), w.load(self.multipliers, a), total
                )
        return total

    def _halfway(self) -> list[str]:
        """Write P½."""
        w = self.w
        return [w.algebra("add", w.load(*self._momentum(i)), w.load(self.half, i)) for i in range(self.n)]

    def _note_change(self, here: Sequence[str], moved: Sequence[str]) -> None:
        """Where positions are iterated, write by how much they change, in parts of their size, into the residual."""
        if not self.holonomic.momenta:
            return
        w, g = self.w, self.g
        change, reach = g.constant(Fraction(0)), g.constant(Fraction(0))
        for i, (q, step) in enumerate(zip(here, moved, strict=True)):
            new = w.algebra("add", q, step)
            change = g.intrinsic("maxnum", change, magnitude(w, w.algebra("sub", new, w.load(self.place, i))))
            reach = g.intrinsic("maxnum", reach, magnitude(w, new))
            reach = g.intrinsic("maxnum", reach, magnitude(w, step))
        part = g.select(g.less(g.constant(Fraction(0)), change), g.algebra("div", change, reach), change)
        before, least = g.load(self.watched, 0), g.load(self.watched, 1)
        worst = g.intrinsic("maxnum", part, g.select(g.equal(before, g.infinity()), part, before))
        # Below 32 rounding units, 512 of pairs, what does not halve any more is rounding.
        bits = w.number.mantissa - (9 if w.number.pair else 5)
        fine = g.less(worst, g.constant(Fraction(1, 2**bits)))
        slow = g.less(least, g.algebra("add", worst, worst))
        settled = w.let(f"and i1 {fine}, {slow}")
        first = g.equal(before, g.infinity())
        kept = g.select(first, before, g.select(settled, g.constant(Fraction(0)), worst))
        g.store(kept, self.watched, 0)
        g.store(g.intrinsic("minnum", least, worst), self.watched, 1)

    def _correct(self, square: str, moved: Sequence[str]) -> None:
        """Write λ ← λ − S⁻¹ g(q₁), S = (h²/2) G(q₁) M⁻¹G(q₀)ᵀ, and the residual of g in parts of Σ |G q|."""
        w, g, h = self.w, self.g, self.holonomic
        rows = [node for row in h.slopes for node in row]
        found = self._evaluated([*h.values, *rows], self._there())
        slopes = [found[self.k + a * self.n : self.k + (a + 1) * self.n] for a in range(self.k)]
        worst, residuals = g.constant(Fraction(0)), list[str]()
        for a, row in enumerate(h.slopes):
            value, scale = found[a], g.constant(Fraction(0))
            for i in self._filled(row):
                slope = slopes[a][i]
                if self.e:
                    value = w.multiply_add(slope, w.load(self.lost, i), value)
                reach = g.algebra("add", magnitude(w, w.load(self.place, i)), magnitude(w, moved[i]))
                scale = g.intrinsic("fma", magnitude(w, slope), reach, scale)
            residuals.append(value)
            size = magnitude(w, value)
            part = g.select(g.equal(size, g.constant(Fraction(0))), size, g.algebra("div", size, scale))
            # NaN counts as the worst there is.
            known = g.less(part, g.infinity())
            worst = g.intrinsic("maxnum", worst, g.select(known, part, g.infinity()))
        g.store(worst, self.watched, 0)
        matrix = self._metric(square, slopes)
        for a, change in enumerate(self._solved(matrix, residuals)):
            w.store(w.algebra("sub", w.load(self.multipliers, a), change), self.multipliers, a)

    def _metric(self, factor: str, slopes: Sequence[Sequence[str]]) -> list[list[str]]:
        """Write G M⁻¹Gᵀ times a factor, of slopes G and the shares that are kept."""
        w, shares = self.w, self.holonomic.shares
        return [
            [w.algebra("mul", factor, self._dot(shares[b], self.shares, b, row)) for b in range(self.k)]
            for row in slopes
        ]

    def _arrive(self) -> None:
        """Write q₁ over q₀, and what is needed of the new place."""
        w = self.w
        for i in range(self.n):
            w.store(w.load(self.place, i), self.y, i)
            if self.e:
                w.store(w.load(self.lost, i), self.e, i)
        if self.holonomic.momenta:
            P = self._halfway()
            for i, force in enumerate(self._evaluated(self.holonomic.force, self._here(), P)):
                w.store(force, self.forces, i)
        self.look_at_place()

    def _project(self, half: str) -> None:
        """Write P₁ = P½ + h/2 (F + push µ) with G V(q₁, P₁) = 0; µ is what the next step begins with."""
        w, h = self.w, self.holonomic
        slopes = [[w.load(self.slopes, a * self.n + i) for i in range(self.n)] for a in range(self.k)]
        matrix = self._metric(half, slopes)
        for _ in range(_REFINED):
            rates = self._rates_of_constraints(*self._after(half))
            for a, change in enumerate(self._solved(matrix, rates)):
                w.store(w.algebra("sub", w.load(self.multipliers, a), change), self.multipliers, a)
        arrived, lost = self._after(half)
        for i in range(self.n):
            w.store(arrived[i], *self._momentum(i))
            if self.e and not h.momenta:
                w.store(lost[i], self.e, self.second + i)

    def _rates_of_constraints(self, P: list[str], lost: list[str]) -> list[str]:
        """Write G V(q₁, P₁), with what rounding took from P₁ where that is carried along."""
        w, h = self.w, self.holonomic
        V = self._evaluated(h.velocity, self._here(), P) if h.momenta else P
        rates = [self._dot(row, self.slopes, a, V) for a, row in enumerate(h.slopes)]
        if not self.e or h.momenta:
            return rates
        rest = [self._dot(row, self.slopes, a, lost) for a, row in enumerate(h.slopes)]
        return [w.algebra("add", x, y) for x, y in zip(rates, rest, strict=True)]

    def _after(self, half: str) -> tuple[list[str], list[str]]:
        """Write P₁ with the multipliers so far, and what rounding takes from it."""
        w, P, lost = self.w, list[str](), list[str]()
        for i in range(self.n):
            step = w.multiply_add(half, self._pushed(w.load(self.forces, i), i), w.load(self.half, i))
            old = w.load(*self._momentum(i))
            P.append(w.algebra("add", old, step))
            lost.append(w.algebra("sub", step, w.algebra("sub", P[-1], old)))
        return P, lost

    def _solved(self, matrix: list[list[str]], right: Sequence[str]) -> list[str]:
        """Write the solution of linear equations."""
        w, many = self.w, self.matrix
        if many is None:
            return eliminated(w, matrix, right)
        for a, row in enumerate(matrix):
            w.store(right[a], self.residuals, a)
            for b, entry in enumerate(row):
                w.store(entry, many.matrix, a * self.k + b)
        many.factorise()
        many.solve(self.residuals)
        return [w.load(self.residuals, a) for a in range(self.k)]
