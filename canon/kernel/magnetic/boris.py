"""Boris's push: half a drift, half a kick by E, a turn by B, half a kick, half a drift, for H = Σ (p − A)²/2m + φ.

The turn is Cayley's, π⁺ = (1 − K)⁻¹ (1 + K) π⁻ with Kᵢⱼ = ½ h Bᵢⱼ wⱼ: it keeps the kinetic energy and phase volume, and
its angle is 2 atan(½ h ω) in place of h ω. In a plane it is three shears, along one field two cross products. The state
is (q, p) again after every step; what p = π + A loses by rounding stands in the compensation, from which π comes back.

Sources: J. P. Boris, Relativistic plasma simulation – optimization of a hybrid code, Proc. 4th Conf. Numer. Simul.
Plasmas (1970) 3–67; H. Qin et al., Why is Boris algorithm so good?, Phys. Plasmas 20 (2013) 084503,
doi:10.1063/1.4818428.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.formulas import LaneFormulas
from canon.kernel.llvm.loop import METHOD, Loop, blocks_of, compile_loop, increase, steps_of
from canon.kernel.llvm.number_types import DOUBLE, MachineType
from canon.kernel.llvm.solvers.cayley_turn import turn_factor, write_turn
from canon.kernel.llvm.solvers.linear_solver import eliminated
from canon.kernel.llvm.writer import Writer
from canon.kernel.magnetic.magnetic_form import NotMagneticError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.magnetic.magnetic_form import MagneticForm
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["boris_loop"]

_HALF = Fraction(1, 2)

_LARGEST = 12
"""Up to so many coordinates that one B mixes equations are eliminated in registers; more are refused."""


def boris_loop(
    system: HamiltonEquations,
    form: MagneticForm,
    weights: int,
    *,
    compensated: bool,
    number: MachineType = DOUBLE,
) -> Loop:
    """Compile compositions of so many of Boris's steps; the coefficients are h w₁, h w₂ …

    Raises
    ------
    NotMagneticError
        B mixes too many coordinates.
    """
    w, size, n = Writer(number), 2 * len(system.q), len(form.force)
    y, e = w.array(size), w.array(size) if compensated else ""
    writing = _Push(w, system, form, y, e, w.array(n), w.array(n) if compensated else "", w.array(1))
    with blocks_of(w, y, e, size, size), steps_of(w, system) as time:
        w.store(time, writing.clock, 0)
        writing.to_kinetic()
        with w.loop(0, weights) as i:
            writing.step(w.load("%c", w.let(f"add i64 {i}, {METHOD}")))
        writing.to_canonical()
    return compile_loop(w, len(system.q), compensated=compensated)


@dataclass(frozen=True)
class _Push:
    """Writes Boris's steps.

    Parameters
    ----------
    w, system, form
        What is written to, the equations, and the parts of H.
    y, e
        The state and its compensation or "".
    kinetic, carried
        π, and its compensation or "".
    clock
        The time that the steps of a composition have come to.
    """

    w: Writer
    system: HamiltonEquations
    form: MagneticForm
    y: str
    e: str
    kinetic: str
    carried: str
    clock: str

    @property
    def n(self) -> int:
        return len(self.form.force)

    def _evaluated(self, nodes: Sequence[int]) -> list[str]:
        w, size = self.w, 2 * len(self.system.q)
        state = [w.load(self.y, i) for i in range(size)]
        return w.program(self.system.program(nodes), [*state, w.load(self.clock, 0)])

    def _canonical(self, i: int) -> int:
        """Return where pᵢ stands."""
        return len(self.system.q) + i

    def to_kinetic(self) -> None:
        """Write π = p − A."""
        w, f = self.w, LaneFormulas(self.w)
        for i, a in enumerate(self._evaluated(self.form.vector_potential)):
            p = w.load(self.y, self._canonical(i))
            if not self.e:
                w.store(f.sub(p, a), self.kinetic, i)
                continue
            high, low = f.two_sum(p, f.neg(a))
            high, low = f.two_sum(high, f.add(low, w.load(self.e, self._canonical(i))))
            w.store(high, self.kinetic, i)
            w.store(low, self.carried, i)

    def to_canonical(self) -> None:
        """Write p = π + A."""
        w, f = self.w, LaneFormulas(self.w)
        for i, a in enumerate(self._evaluated(self.form.vector_potential)):
            kinetic = w.load(self.kinetic, i)
            if not self.e:
                w.store(f.add(kinetic, a), self.y, self._canonical(i))
                continue
            high, low = f.two_sum(kinetic, a)
            high, low = f.two_sum(high, f.add(low, w.load(self.carried, i)))
            w.store(high, self.y, self._canonical(i))
            w.store(low, self.e, self._canonical(i))

    def step(self, time: str) -> None:
        """Write a step."""
        w, f, form = self.w, LaneFormulas(self.w), self.form
        half = f.mul(time, w.constant(_HALF))
        self._drift(half)
        zero = self.system.graph.zero
        pairs = [(i, j) for i in range(self.n) for j in range(self.n) if form.field[i][j] != zero]
        found = self._evaluated([*form.force, *(form.field[i][j] for i, j in pairs)])
        force, entries = found[: self.n], found[self.n :]
        self._kick(half, force)
        masses = self._inverse_masses()
        K = {(i, j): f.mul(f.mul(half, B), masses[j]) for (i, j), B in zip(pairs, entries, strict=True)}
        for block in form.blocks(zero):
            self._turn(block, K)
        self._kick(half, force)
        self._drift(half)

    def _inverse_masses(self) -> list[str]:
        """Write w of each coordinate."""
        f, given = LaneFormulas(self.w), self.form.relativistic
        if given is None:
            return self._evaluated(self.form.inverse_masses)
        factor, rest, slope = self._evaluated([given.factor, given.rest, given.slope])
        kinetic = [self.w.load(self.kinetic, i) for i in range(self.n)]
        root = f.sqrt(f.fma(slope, f.dot(kinetic, kinetic), rest))
        return [f.div(factor, root)] * self.n

    def _drift(self, half: str) -> None:
        w = self.w
        for i, mass in enumerate(self._inverse_masses()):
            increase(w, self.y, self.e, str(i), half, w.algebra("mul", mass, w.load(self.kinetic, i)))
        w.store(w.algebra("add", w.load(self.clock, 0), half), self.clock, 0)

    def _kick(self, half: str, force: Sequence[str]) -> None:
        for i, each in enumerate(force):
            if self.form.force[i] != self.system.graph.zero:
                self._increase(i, half, each)

    def _increase(self, i: int, factor: str, rate: str) -> None:
        increase(self.w, self.kinetic, self.carried, str(i), factor, rate)

    def _turn(self, block: Sequence[int], K: dict[tuple[int, int], str]) -> None:
        """Write π ← (1 − K)⁻¹ (1 + K) π in one block."""
        antisymmetric = not self.system.variations
        if antisymmetric and len(block) == 2:
            self._turn_plane(block[0], block[1], K)
        elif antisymmetric and len(block) == 3 and len({self.form.inverse_masses[i] for i in block}) == 1:
            self._turn_about(block, K)
        elif len(block) > 1:
            self._turn_by_elimination(block, K)

    def _turn_plane(self, i: int, j: int, K: dict[tuple[int, int], str]) -> None:
        f = LaneFormulas(self.w)
        first, second = K[i, j], K[j, i]
        shear = f.div(f.add(second, second), f.sub(f.one, f.mul(first, second)))
        for moved, by, factor in ((i, j, first), (j, i, shear), (i, j, first)):
            self._increase(moved, factor, self.w.load(self.kinetic, by))

    def _turn_about(self, block: Sequence[int], K: dict[tuple[int, int], str]) -> None:
        """Write Cayley's turn by K with K³ = −|k|² K."""
        f = LaneFormulas(self.w)
        entries = [(i, j, f.neg(k)) for (i, j), k in K.items() if i < j and {i, j} <= {*block}]
        write_turn(self.w, self.kinetic, self.carried, entries, turn_factor(self.w, [k for *_, k in entries]))

    def _across(self, K: dict[tuple[int, int], str], x: dict[int, str]) -> dict[int, str]:
        """Write K x."""
        f = LaneFormulas(self.w)
        total = dict.fromkeys(x, f.zero)
        for (i, j), k in K.items():
            if i in x:
                total[i] = f.fma(k, x[j], total[i])
        return total

    def _turn_by_elimination(self, block: Sequence[int], K: dict[tuple[int, int], str]) -> None:
        """Write π ← π + (1 − K)⁻¹ 2 K π."""
        w, f = self.w, LaneFormulas(self.w)
        if len(block) > _LARGEST:
            raise NotMagneticError(
                f"B mixes {len(block)} coordinates, {_LARGEST} at most in Boris's step: use Gauss(6) or Taylor()"
            )
        turned = self._across(K, {i: w.load(self.kinetic, i) for i in block})
        matrix = [[f.neg(K[i, j]) if (i, j) in K else f.zero for j in block] for i in block]
        for i, row in enumerate(matrix):
            row[i] = f.sub(f.one, K[block[i], block[i]]) if (block[i], block[i]) in K else f.one
        changes = eliminated(w, matrix, [f.add(turned[i], turned[i]) for i in block])
        for i, change in zip(block, changes, strict=True):
            self._increase(i, f.one, change)
