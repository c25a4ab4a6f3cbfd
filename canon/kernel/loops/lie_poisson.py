"""Lie–Poisson splittings: planes that turn by an angle, and kicks, the exact flows of parts of H on a Poisson manifold.

A turn by θ is three shears, x ← x − t y, y ← y + s x, x ← x − t y with t = tan(θ/2), s = sin θ. Whatever rounding
makes of t and s they keep areas, so that a turn by the same angle again and again moves on an ellipse that is a circle
but for round-off: |M|², M · Γ and |e|² wander, and do not drift. Where cos θ < 0 the turn by θ − π is done, and both
signs are changed. A turn about M is Cayley's, which is a turn whatever rounding makes of the angle.

Sources: R. I. McLachlan, Explicit Lie–Poisson integration and the Euler equations, Phys. Rev. Lett. 71 (1993)
3043–3046, doi:10.1103/PhysRevLett.71.3043; S. Reich, Momentum conserving symplectic integrators, Physica D 76 (1994)
375–383, doi:10.1016/0167-2789(94)90046-9; J. Touma, J. Wisdom, Lie–Poisson integrators for rigid body dynamics in the
solar system, Astron. J. 107 (1994) 1189–1202, doi:10.1086/116931.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.circular_functions import sine_and_cosine, turning_functions
from canon.kernel.llvm.formulas import LaneFormulas
from canon.kernel.llvm.loop import (
    METHOD,
    PARAMETERS,
    SIGNATURE,
    Loop,
    blocks_of,
    compiled_function,
    increase,
    steps_of,
)
from canon.kernel.llvm.number_types import DOUBLE, MachineType
from canon.kernel.llvm.solvers.cayley_turn import across, turn_factor, write_turn
from canon.kernel.llvm.writer import Writer
from canon.kernel.program.slopes import slopes

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.kernel.loops.deviations import Deviations
    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.program.lie_poisson_parts import Kick, LiePoissonParts, PlaneTurns, TurningBlock

__all__ = ["lie_poisson_loop", "palindrome"]

Stage = tuple[int, Fraction]
"""Which part moves, and for which part of a step: turns first, then turns about M, the drift, and kicks last."""

_HALF = Fraction(1, 2)


def palindrome(parts: LiePoissonParts) -> tuple[Stage, ...]:
    """Return the parts in an order that is its own reverse: half kicks, half turns, a whole one, and back.

    Turns about M and the drift commute with the other turns and stand in the middle.
    """
    turns = len(parts.turns)
    first = turns + len(parts.commons) + bool(parts.drift)
    commuting = range(turns, first)
    order = [*range(first, first + len(parts.kicks)), *range(turns)]
    middle = [order.pop()] if turns or not commuting else []
    halves = [(part, _HALF) for part in order]
    whole = [(part, Fraction(1)) for part in (*middle, *commuting)]
    return (*halves, *whole, *reversed(halves))


def lie_poisson_loop(
    system: HamiltonEquations,
    parts: LiePoissonParts,
    weights: int,
    *,
    compensated: bool,
    number: MachineType = DOUBLE,
    stages: Sequence[Stage] | None = None,
    deviations: Deviations | None = None,
) -> Loop:
    """Compile compositions of so many steps; the coefficients are h w₁, h w₂ …

    Parameters
    ----------
    system, parts, weights
        The equations, the parts of H, and the number of steps that one is composed of.
    compensated, number
        The arithmetic.
    stages
        The parts in their order; as :func:`palindrome` has them where not given.
    deviations
        Vectors beside the orbit, in ``e`` behind the compensation, which each flow moves by its derivative.
    """
    w, size = Writer(number), 2 * len(system.q)
    y, e = w.array(size), w.array(size) if compensated else ""
    carry = size if deviations is None else deviations.carry
    with blocks_of(w, y, e, size, carry) as kept:
        beside = None if deviations is None else _Deviating(w, deviations, w.at(kept, deviations.before))
        writing = _Flows(w, system, parts, y, e, beside)
        with steps_of(w, system), w.loop(0, weights) as i:
            step = w.load("%c", w.let(f"add i64 {i}, {METHOD}"))
            for part, share in palindrome(parts) if stages is None else stages:
                writing.move(part, step if share == 1 else w.algebra("mul", step, w.constant(share)))
    code = compiled_function(w, "advance", PARAMETERS, SIGNATURE)
    return Loop(code, len(system.q), compensated, number, carry)


@dataclass(frozen=True)
class _Deviating:
    """Writes what moves the deviations beside an orbit.

    Parameters
    ----------
    w, deviations, array
        The writer, the deviations and where they lie, each after the one before.
    """

    w: Writer
    deviations: Deviations
    array: str

    def vectors(self) -> Iterator[str]:
        """Repeat what follows for every deviation, and give where it lies."""
        with self.w.loop(0, self.deviations.vectors) as g:
            yield self.w.at(self.array, self.w.let(f"mul i64 {g}, {self.deviations.size}"))

    def increase(self, own: str, i: int, factor: str, rate: str) -> None:
        """Write δᵢ ← δᵢ + factor · rate."""
        w = self.w
        w.store(w.multiply_add(factor, rate, w.load(own, i)), own, i)

    def combined(self, own: str, entries: Sequence[tuple[int, str]]) -> str:
        """Write Σ entry · δ."""
        total = self.w.constant(Fraction(0))
        for j, entry in entries:
            total = self.w.multiply_add(entry, self.w.load(own, j), total)
        return total


@dataclass(frozen=True)
class _Flows:
    """Writes the flows of the parts, on a state y with its compensation e, or "" where there is none.

    The exact flow of a part has the exact derivative: along a kick by rates f that rest it is 1 + t f′, along a turn by
    an angle the turn of the deviation and, as the angle deviates too, of the state by a right angle more.
    """

    w: Writer
    system: HamiltonEquations
    parts: LiePoissonParts
    y: str
    e: str
    beside: _Deviating | None

    def move(self, part: int, time: str) -> None:
        """Write the flow of a part."""
        turns, commons = self.parts.turns, self.parts.commons
        if part < len(turns):
            self._turn(turns[part], time)
        elif part < len(turns) + len(commons):
            common = commons[part - len(turns)]
            for block in common.blocks:
                self._turn_block(block, self.w.algebra("mul", time, self.w.constant(common.rate)))
        else:
            kicks = [*((self.parts.drift,) if self.parts.drift else ()), *self.parts.kicks]
            self._kick(kicks[part - len(turns) - len(commons)], time)

    def _evaluated(self, nodes: Sequence[int]) -> list[str]:
        w, size = self.w, 2 * len(self.system.q)
        state = [w.load(self.y, i) for i in range(size)]
        return w.program(self.system.program(nodes), [*state, w.load("%c", 0)])

    def _kick(self, kick: Kick, time: str) -> None:
        components, nodes = zip(*kick, strict=True)
        rates = self._evaluated(nodes)
        if self.beside is not None:
            rows = self._slopes(nodes)
            for own in self.beside.vectors():
                changes = [self.beside.combined(own, row) for row in rows]
                for i, change in zip(components, changes, strict=True):
                    self.beside.increase(own, i, time, change)
        for i, rate in zip(components, rates, strict=True):
            increase(self.w, self.y, self.e, str(i), time, rate)

    def _slopes(self, nodes: Sequence[int]) -> list[list[tuple[int, str]]]:
        """Write the derivatives of functions of the state, those that are not 0, by component."""
        state = (*self.system.q, *self.system.p)
        rows = slopes(self.system.graph, nodes, state).rows
        wanted = list(dict.fromkeys(node for row in rows for _, node in row))
        known = dict(zip(wanted, self._evaluated(wanted), strict=True))
        return [[(j, known[node]) for j, node in row] for row in rows]

    def _turn(self, turn: PlaneTurns, time: str) -> None:
        """Write turns of planes, and what they do to deviations."""
        w = self.w
        (rate,) = self._evaluated([turn.rate])
        by_state = [] if self.beside is None else self._slopes([turn.rate])[0]
        known = self._sines_and_cosines(turn, w.algebra("mul", time, rate))
        shears = {speed: self._shears(*both) for speed, both in known.items()}
        for i, j, c in turn.planes:
            first, second, sign = shears[abs(c)]
            self._turn_plane(*((i, j) if c > 0 else (j, i)), first, second, sign)
        if self.beside is None:
            return
        # After the orbit: what a further angle does to the state is told by the state that was turned.
        for own in self.beside.vectors():
            further = w.algebra("mul", time, self.beside.combined(own, by_state))
            for i, j, c in turn.planes:
                beyond = w.algebra("mul", w.constant(abs(c)), further)
                self._turn_deviation(self.beside, own, (i, j) if c > 0 else (j, i), shears[abs(c)], beyond)

    def _sines_and_cosines(self, turn: PlaneTurns, angle: str) -> dict[Fraction, tuple[str, str]]:
        """Write sine and cosine of the angle of each speed; twice as fast as another takes those of the other."""
        w, f, known = self.w, LaneFormulas(self.w), dict[Fraction, tuple[str, str]]()
        for speed in sorted({abs(c) for _, _, c in turn.planes}):
            if speed / 2 in known:
                sine, cosine = known[speed / 2]
                double = f.mul(f.add(sine, sine), cosine)
                known[speed] = double, f.mul(f.sub(cosine, sine), f.add(cosine, sine))
            else:
                own = angle if speed == 1 else w.algebra("mul", angle, w.constant(speed))
                known[speed] = sine_and_cosine(w, own)
        return known

    def _turn_deviation(
        self, beside: _Deviating, own: str, plane: tuple[int, int], shears: tuple[str, str, str], beyond: str
    ) -> None:
        """Write the turn of a deviation in a plane, and what the angle beyond turns the state by."""
        w, (a, b), (first, second, sign) = self.w, plane, shears
        for moved, by, factor in ((a, b, first), (b, a, second), (a, b, first)):
            beside.increase(own, moved, factor, w.load(own, by))
        for moved, by, more in ((a, b, w.negative(beyond)), (b, a, beyond)):
            turned = w.algebra("mul", sign, w.load(own, moved))
            w.store(w.multiply_add(more, w.load(self.y, by), turned), own, moved)

    def _shears(self, sine: str, cosine: str) -> tuple[str, str, str]:
        """Write −tan and sine of the angle, or of what it exceeds half a turn by, and 1 or −1."""
        f = LaneFormulas(self.w)
        back = f.less(cosine, f.zero)
        sign = f.select(back, f.neg(f.one), f.one)
        sine, cosine = f.mul(sign, sine), f.mul(sign, cosine)
        return f.neg(f.div(sine, f.add(f.one, cosine))), sine, sign

    def _turn_plane(self, i: int, j: int, first: str, second: str, sign: str) -> None:
        w = self.w
        for moved, by, factor in ((i, j, first), (j, i, second), (i, j, first)):
            increase(w, self.y, self.e, str(moved), factor, w.load(self.y, by))
        for place in (i, j):
            for array in (self.y, self.e) if self.e else (self.y,):
                w.store(w.algebra("mul", sign, w.load(array, place)), array, place)

    def _turn_block(self, block: TurningBlock, time: str) -> None:
        """Write exp(time S) y as two turns by half the angle, Cayley's with K = t S for some t."""
        w, f = self.w, LaneFormulas(self.w)
        M = [f.mul(w.load(self.y, i), w.constant(block.speed)) for i in block.axis]
        speed = f.sqrt(f.dot(M, M))
        half = f.mul(f.mul(time, speed), w.constant(_HALF))
        sine, cosine = sine_and_cosine(w, half)
        # Where the half angle is beyond a right one, it less half a turn: both halves make a whole turn less.
        sine = f.select(f.less(cosine, f.zero), f.neg(sine), sine)
        tangent = f.div(sine, f.add(f.one, f.abs(cosine)))
        rests = f.equal(speed, f.zero)
        t = f.select(rests, f.zero, f.div(tangent, f.select(rests, f.one, speed)))
        axis = [f.mul(t, m) for m in M]
        factor, entries = turn_factor(w, axis), [(i, j, axis[k]) for i, j, k in block.entries]
        changed = None if self.beside is None else _BlockDerivative(f, self.y, block, M, time)
        for _ in range(2):
            write_turn(w, self.y, self.e, entries, factor)
        if changed is None or self.beside is None:
            return
        for own in self.beside.vectors():
            changes = changed.along(own)
            for _ in range(2):
                write_turn(w, own, "", entries, factor)
            for i, change in changes.items():
                self.beside.increase(own, i, f.one, change)


class _BlockDerivative:
    """How exp(t S) y = (1 + G₁S + G₂S²) y changes where the axis of S does, G₁ = sin ωt/ω, G₂ = (1 − cos ωt)/ω².

    Parameters
    ----------
    f
        Writes formulas.
    y
        The state before the turn.
    block, M
        What turns, and the axis times its speed, |M| = ω.
    t
        The time.
    """

    def __init__(self, f: LaneFormulas, y: str, block: TurningBlock, M: Sequence[str], t: str) -> None:
        self.f, self.block, self.M = f, block, M
        self.functions = turning_functions(f.writer, f.dot(M, M), t)
        self.old = {i: f.writer.load(y, i) for entry in block.entries for i in entry[:2]}
        self.once = across(f, self._entries(M), self.old)
        self.twice = across(f, self._entries(M), self.once)

    def _entries(self, axis: Sequence[str]) -> list[tuple[int, int, str]]:
        return [(i, j, axis[k]) for i, j, k in self.block.entries]

    def along(self, own: str) -> dict[int, str]:
        """Write the change of every component that a deviation of the axis makes."""
        f, w = self.f, self.f.writer
        g1, g2, slope1, slope2 = self.functions
        axis = [f.mul(w.load(own, i), w.constant(self.block.speed)) for i in self.block.axis]
        change = self._entries(axis)
        beta = f.mul(w.constant(Fraction(2)), f.dot(self.M, axis))
        first, then = across(f, change, self.old), across(f, change, self.once)
        before = across(f, self._entries(self.M), first)
        more1, more2 = f.mul(slope1, beta), f.mul(slope2, beta)
        return {
            i: f.dot(
                (more1, g1, more2, g2), (self.once[i], first[i], self.twice[i], f.add(then[i], before[i]))
            )
            for i in self.old
        }
