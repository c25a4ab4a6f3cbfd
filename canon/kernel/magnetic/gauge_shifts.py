"""Splittings by shifts of gauge: the exact flows of wᵢ (pᵢ − Aᵢ)²/2 and of φ in turn, explicit and symplectic.

With Sᵢ = ∫ Aᵢ dqᵢ the shift p = P + ∂Sᵢ/∂q is canonical and makes wᵢ Pᵢ²/2 of the i-th part. So its flow is qᵢ′ = qᵢ +
h wᵢ (pᵢ − Aᵢ(q)), pⱼ′ = pⱼ + ∂Sᵢ/∂qⱼ(q′) − ∂Sᵢ/∂qⱼ(q). Coordinates without A drift together.

Source: Y. K. Wu, E. Forest, D. S. Robin, Explicit symplectic integrator for s-dependent static magnetic field, Phys.
Rev. E 68 (2003) 046502, doi:10.1103/PhysRevE.68.046502.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.loop import METHOD, Loop, blocks_of, compile_loop, increase, steps_of
from canon.kernel.llvm.number_types import DOUBLE, MachineType
from canon.kernel.llvm.writer import Writer

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.kernel.magnetic.magnetic_form import MagneticForm
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["GaugeShifts", "gauge_shift_loop"]

_HALF = Fraction(1, 2)


@dataclass(frozen=True, eq=False)
class GaugeShifts:
    """A Hamiltonian in magnetic form, with what shifts the gauge of each coordinate's part.

    Parameters
    ----------
    form
        The parts of H.
    shifts
        For each coordinate with an A, in parts that move at once: the components j of p that its part moves with the
        nodes of ∂Sᵢ/∂qⱼ, its own first.
    """

    form: MagneticForm
    shifts: tuple[tuple[tuple[tuple[int, int], ...], ...], ...]

    @property
    def free(self) -> list[int]:
        """The coordinates without A."""
        own = {shift[0][0] for part in self.shifts for shift in part}
        return [i for i in range(len(self.form.force)) if i not in own]


def gauge_shift_loop(
    system: HamiltonEquations,
    given: GaugeShifts,
    weights: int,
    *,
    compensated: bool,
    number: MachineType = DOUBLE,
) -> Loop:
    """Compile compositions of so many steps, kick – drift – parts with A – and back; the coefficients are h w₁ …"""
    w, size = Writer(number), 2 * len(system.q)
    y, e = w.array(size), w.array(size) if compensated else ""
    writing = _Flows(w, system, given, y, e)
    *before, middle = writing.flows()
    with blocks_of(w, y, e, size, size), steps_of(w, system), w.loop(0, weights) as i:
        step = w.load("%c", w.let(f"add i64 {i}, {METHOD}"))
        half = w.algebra("mul", step, w.constant(_HALF))
        for flow in before:
            flow(half)
        middle(step)
        for flow in reversed(before):
            flow(half)
    return compile_loop(w, len(system.q), compensated=compensated)


@dataclass(frozen=True)
class _Flows:
    """Writes the flows of the parts on a state y with its compensation e, or "" where there is none."""

    w: Writer
    system: HamiltonEquations
    given: GaugeShifts
    y: str
    e: str

    def flows(self) -> list[Callable[[str], None]]:
        """Return what writes each flow for a time."""
        found: list[Callable[[str], None]] = []
        if any(force != self.system.graph.zero for force in self.given.form.force):
            found.append(self._kick)
        if self.given.free:
            found.append(self._drift)
        found += [lambda time, part=part: self._move(part, time) for part in self.given.shifts]
        return found

    def _evaluated(self, nodes: Sequence[int]) -> list[str]:
        w, size = self.w, 2 * len(self.system.q)
        state = [w.load(self.y, i) for i in range(size)]
        return w.program(self.system.program(nodes), [*state, w.load("%c", 0)])

    def _canonical(self, i: int) -> int:
        """Return where pᵢ stands."""
        return len(self.system.q) + i

    def _kick(self, time: str) -> None:
        for i, force in enumerate(self._evaluated(self.given.form.force)):
            if self.given.form.force[i] != self.system.graph.zero:
                increase(self.w, self.y, self.e, str(self._canonical(i)), time, force)

    def _drift(self, time: str) -> None:
        w = self.w
        free = self.given.free
        masses = self._evaluated([self.given.form.inverse_masses[i] for i in free])
        for i, mass in zip(free, masses, strict=True):
            increase(
                w, self.y, self.e, str(i), time, w.algebra("mul", mass, w.load(self.y, self._canonical(i)))
            )

    def _move(self, part: Sequence[Sequence[tuple[int, int]]], time: str) -> None:
        """Write the flow of wᵢ (pᵢ − Aᵢ)²/2, for all coordinates that move at once."""
        w, one = self.w, self.w.constant(Fraction(1))
        own = [shift[0][0] for shift in part]
        pushes = [push for shift in part for push in shift]
        nodes = [node for _, node in pushes]
        found = self._evaluated([*nodes, *(self.given.form.inverse_masses[i] for i in own)])
        here, masses = dict(zip(pushes, found, strict=False)), found[len(nodes) :]
        for i, mass, shift in zip(own, masses, part, strict=True):
            kinetic = w.algebra("sub", w.load(self.y, self._canonical(i)), here[shift[0]])
            increase(w, self.y, self.e, str(i), time, w.algebra("mul", mass, kinetic))
        for (j, _), before, after in zip(pushes, found, self._evaluated(nodes), strict=False):
            increase(w, self.y, self.e, str(self._canonical(j)), one, w.algebra("sub", after, before))
