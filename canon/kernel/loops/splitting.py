"""Splitting loops: drifts q ← q + aᵢ h ∂H/∂p and kicks p ← p − bᵢ h ∂H/∂q of H = T(p, t) + V(q, t) in turn."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from canon.kernel.llvm.loop import METHOD, Loop, blocks_of, compile_loop, increase, steps_of
from canon.kernel.llvm.number_types import DOUBLE, MachineType
from canon.kernel.llvm.pair_loops import write_pair_forces
from canon.kernel.llvm.rolled import is_worth_rolling, write_rolled
from canon.kernel.llvm.writer import Writer
from canon.kernel.program.operation_families import families_of_program
from canon.kernel.program.pairwise import pair_forces

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Protocol, TypeAlias

    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.program.program import Program
    from canon.kernel.program.repeated.pair_function import PairForces
    from canon.kernel.program.repeated.rates_in_loops import RatesInLoops

    _Take: TypeAlias = Callable[[str, str], None]
    """What is done with the number of a component and its rate."""

    class Splits(Protocol):
        """What moves by drifts and kicks: an orbit, or an orbit with its deviations."""

        def set_clocks(self, time: str) -> None: ...
        def keep_force(self) -> None: ...
        def kick_again(self, coefficient: str) -> None: ...
        def drift(self, coefficient: str) -> None: ...
        def kick(self, coefficient: str) -> None: ...


__all__ = ["SplittingWriter", "splitting_loop", "write_splitting"]


def splitting_loop(
    system: HamiltonEquations,
    stages: int,
    *,
    compensated: bool,
    number: MachineType = DOUBLE,
    kick_first: bool = False,
) -> Loop:
    """Compile drift–kick–…–drift steps for H = T(p, t) + V(q, t).

    The coefficients are h·a₁, h·b₁, …, h·a_s, h·b_s, h·a_{s+1}. Two clocks make time-dependent parts exact
    splittings of the extended phase space: a kick reads the clock that drifts advance, and the other way
    round.

    Parameters
    ----------
    system, stages
        The equations, and the number s of kicks.
    compensated, number
        The arithmetic.
    kick_first
        Whether a₁ = a_{s+1} = 0 and t is absent from H: a step's first kick then uses the force of the last one.
    """
    n = len(system.q)
    w = Writer(number)
    writing = SplittingWriter.of(w, system, compensated=compensated, kick_first=kick_first)
    with blocks_of(w, writing.y, writing.e, 2 * n, 2 * n, writing.gap):
        write_splitting(w, system, stages, writing, kick_first=kick_first)
    return compile_loop(w, n, compensated=compensated)


def write_splitting(
    w: Writer, system: HamiltonEquations, stages: int, moving: Splits, *, kick_first: bool
) -> None:
    """Write the steps of a splitting for what moves by drifts and kicks."""
    if kick_first:
        moving.keep_force()
    with steps_of(w, system) as time:
        moving.set_clocks(time)
        if kick_first:
            moving.kick_again(w.load("%c", METHOD + 1))
        with w.loop(int(kick_first), stages) as s:
            pair = w.let(f"shl i64 {s}, 1")
            moving.drift(w.load("%c", w.let(f"add i64 {pair}, {METHOD}")))
            moving.kick(w.load("%c", w.let(f"add i64 {pair}, {METHOD + 1}")))
        if not kick_first:
            moving.drift(w.load("%c", METHOD + 2 * stages))


@dataclass(frozen=True)
class SplittingWriter:
    """Writes drifts and kicks of one Hamiltonian.

    Parameters
    ----------
    w, system
        What is written to, and the equations.
    y, e, gap
        The state, its compensation or "", and the gap between q and p.
    force
        Where the last force is kept.
    drift_clock, kick_clock
        The times that drifts and kicks have come to.
    pairs
        The force as a sum over pairs of bodies, where it is one.
    loops
        Drift and kick as loops, where H is kept as sums over rows.
    kick_first
        Whether the last force is used again.
    """

    w: Writer
    system: HamiltonEquations
    y: str
    e: str
    gap: int
    force: str
    drift_clock: str
    kick_clock: str
    pairs: PairForces | None
    loops: RatesInLoops | None
    kick_first: bool
    programs: dict[tuple[int, ...], Program] = field(
        default_factory=dict[tuple[int, ...], "Program"], repr=False
    )

    @classmethod
    def of(
        cls, w: Writer, system: HamiltonEquations, *, compensated: bool, kick_first: bool
    ) -> SplittingWriter:
        """Return the writer for a loop, with memory of its own for the state."""
        n = len(system.q)
        # In long chains q starts where SIMD stores do and p one number before: it is the inner members that are moved
        # together.
        gap = w.gap(n + 1)
        y, e = w.array(2 * n + gap, 2), w.array(2 * n + gap, 2) if compensated else ""
        force, drift_clock, kick_clock = w.array(n), w.array(1), w.array(1)
        loops = system.loops
        pairs = pair_forces(system) if loops is None else loops.pairs
        return cls(w, system, y, e, gap, force, drift_clock, kick_clock, pairs, loops, kick_first)

    @property
    def n(self) -> int:
        """Degrees of freedom, parameters that vary included."""
        return len(self.system.q)

    def drift(self, coefficient: str) -> None:
        """Write q ← q + coefficient · ∂H/∂p."""
        take = self._moving(0, coefficient)
        if self.loops is None:
            self.evaluate(self.system.velocity, self.n, self.kick_clock, take)
        else:
            write_rolled(self.w, self.loops.velocity, self.w.at(self.y, self.gap), self.kick_clock, take)
        self._advance(self.drift_clock, coefficient)

    def kick(self, coefficient: str) -> None:
        """Write p ← p − coefficient · ∂H/∂q."""
        if self.kick_first and self.w.number.lanes == 1:
            self.keep_force()
            self.kick_again(coefficient)
        else:
            self._evaluate_force(self._kicking(coefficient))
        self._advance(self.kick_clock, coefficient)

    def _kicking(self, coefficient: str) -> _Take:
        """Return what kicks by a rate at once, and keeps it where it is used again.

        One orbit has its force kept first: to write to two arrays in one loop slows long chains down.
        """
        moving = self._moving(self.n + self.gap, coefficient)
        if not self.kick_first:
            return moving

        def keeping(i: str, rate: str) -> None:
            self.w.store(rate, self.force, i)
            moving(i, rate)

        return keeping

    def kick_again(self, coefficient: str) -> None:
        """Write a kick with the force that was kept."""
        with self.w.loop(0, self.n) as i:
            self._moving(self.n + self.gap, coefficient)(i, self.w.load(self.force, i))

    def keep_force(self) -> None:
        """Write the force to where it is kept."""
        self._evaluate_force(lambda i, rate: self.w.store(rate, self.force, i))

    def set_clocks(self, time: str) -> None:
        """Write the time that a step starts at."""
        self.w.store(time, self.drift_clock, 0)
        self.w.store(time, self.kick_clock, 0)

    def _evaluate_force(self, take: _Take) -> None:
        w, pairs = self.w, self.pairs
        rest = self._rest_of_force()
        if pairs is not None:
            write_pair_forces(w, pairs, self.y, rest, take)
        elif rest is not None:
            rest(take)

    def _rest_of_force(self) -> Callable[[_Take], None] | None:
        """Return what writes the force but for that of pairs, where there is such a one."""
        if self.loops is not None:
            loops = self.loops.force
            return loops and (lambda take: write_rolled(self.w, loops, self.y, self.drift_clock, take))
        nodes = self.system.force if self.pairs is None else self.pairs.rest
        return (lambda take: self.evaluate(nodes, 0, self.drift_clock, take)) if nodes else None

    def evaluate(self, nodes: Sequence[int], reads: int, clock: str, take: _Take) -> None:
        """Write functions of t and the n components from ``reads`` on, and hand each to ``take``."""
        w, n, system = self.w, self.n, self.system
        steps = self._program(nodes)
        state = w.at(self.y, self.gap) if reads else self.y
        if is_worth_rolling(steps, (lambda: self._program(system.force)) if reads else None):
            write_rolled(w, families_of_program(steps), state, clock, take)
            return
        arguments = ["poison"] * (2 * n + 1)
        for i in range(n):
            arguments[reads + i] = w.load(state, reads + i)
        arguments[2 * n] = w.load(clock, 0)
        for i, value in enumerate(w.program(steps, arguments)):
            take(str(i), value)

    def _program(self, nodes: Sequence[int]) -> Program:
        """Return the program of some nodes, made once though a loop may write it twice."""
        found = self.programs.get(tuple(nodes))
        if found is None:
            found = self.programs[tuple(nodes)] = self.system.program(nodes)
        return found

    def _moving(self, first: int, coefficient: str) -> _Take:
        """Return what adds coefficient · rate to the components from ``first`` on."""
        w = self.w
        return lambda i, rate: increase(w, self.y, self.e, w.let(f"add i64 {i}, {first}"), coefficient, rate)

    def _advance(self, clock: str, coefficient: str) -> None:
        if not self.system.autonomous:
            self.w.store(self.w.algebra("add", self.w.load(clock, 0), coefficient), clock, 0)
