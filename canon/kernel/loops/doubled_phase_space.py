"""Doubled phase space: two copies of (q, p), each moved by the other, so that every H has explicit symplectic steps.

H(q, y) + H(x, p) of the copies (q, p) and (x, y) splits: H(q, y) moves p and x at fixed q and y, H(x, p) moves q and y.
Kept are the mean c of the copies, which is the state, and half their difference d = (x − q, y − p)/2; a motion begins
with d = 0. A part H(q, y) of length τ is c += τ/2 (g, f), d += τ/2 (g, −f) with (g, f) = (∂H/∂p, −∂H/∂q) at (q, y) =
(c_q − d_q, c_p + d_p); H(x, p) is the same with d turned round. Two clocks, each moved by the other copy's part, make
parts that depend on time exact flows as well.

What keeps the copies together is either the rotation of d by ω(|q − x|² + |p − y|²)/2, symplectic in the doubled space
(M. Tao, Phys. Rev. E 94 (2016) 043303, doi:10.1103/PhysRevE.94.043303; the rotation stands outside here, which costs
three evaluations a step of order 2 where it takes four in the middle), or a symmetric projection: d before each step is
chosen so that the step, which takes it to −d, is symplectic in (q, p) itself (B. Jayawardana, T. Ohsawa, Math. Comp. 92
(2022) 251–281, doi:10.1090/mcom/3778). F(d) = d + (d after the step) = 0 is solved with F' ≈ 2 + h N, N the
linearisation of the motion of d, which is taken to first order in h: no matrix is made.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.loop import METHOD, Loop, blocks_of, compile_loop, increase, steps_of
from canon.kernel.llvm.number_types import DOUBLE, SINGLE, MachineType
from canon.kernel.llvm.writer import Writer
from canon.kernel.program.variational import variational

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["mixing_coefficients", "mixing_loop", "projecting_coefficients", "projecting_loop"]

_PARTS = 3
"""A step of order 2: half of H(q, y), H(x, p), half of H(q, y)."""

_ROW = 3
"""Numbers of a step of order 2 among the coefficients: a quarter of its length; cosine and sine of the rotation."""

_ITERATIONS = 50
_HALVES = 2

_CONVERGED = 20
"""In doubles a last change above 2⁻²⁰ of the largest component means that the iteration has not converged."""


def mixing_loop(
    system: HamiltonEquations, weights: int, *, compensated: bool, number: MachineType = DOUBLE
) -> Loop:
    """Compile compositions of so many steps of order 2 in the doubled phase space, the copies held by a rotation.

    After the 2n numbers of compensation ``e`` keeps d.
    """
    w, size = Writer(number), 2 * len(system.q)
    copies = _Copies.of(w, system, compensated=compensated)
    with blocks_of(w, copies.y, copies.e, size, 2 * size) as kept:
        outer = w.at(kept, size)
        w.copy(outer, copies.d, size)
        with steps_of(w, system) as time:
            copies.set_clocks(time)
            with w.loop(0, weights) as i:
                row = w.let(f"add i64 {w.let(f'mul i64 {i}, {_ROW}')}, {METHOD}")
                copies.rotate(*(w.load("%c", w.let(f"add i64 {row}, {k}")) for k in (1, 2)))
                quarter = w.load("%c", row)
                with w.loop(0, _PARTS) as j:
                    odd = copies.is_odd(j)
                    twice = w.algebra("add", quarter, quarter)
                    copies.move(odd, w.let(f"select i1 {odd}, {_two(w, twice, quarter)}"))
            last = METHOD + weights * _ROW
            copies.rotate(w.load("%c", last), w.load("%c", last + 1))
        w.copy(copies.d, outer, size)
    made = compile_loop(w, len(system.q), compensated=compensated, carry=2 * size)
    return replace(made, implicit=False)


def mixing_coefficients(weights: Sequence[Fraction], omega: Fraction, h: Fraction) -> list[Fraction]:
    """Return what the loop reads after t0 and h: of every step a quarter of its length and the rotation before it.

    The rotations are of angle 2ωτ; those of neighbouring steps are one.
    """
    times = [Fraction(0), *weights, Fraction(0)]
    turns = [_turn(omega * h * (a + b)) for a, b in itertools.pairwise(times)]
    rows = [[w * h / 4, *turn] for w, turn in zip(weights, turns, strict=False)]
    return [x for row in (*rows, turns[-1]) for x in row]


def _turn(angle: Fraction) -> tuple[Fraction, Fraction]:
    """Return cosine and sine of an angle to 60 digits."""
    from mpmath import MPContext

    context = MPContext()
    context.dps = 60 + max(0, len(str(abs(angle.numerator) // angle.denominator)))
    at = context.mpf(angle.numerator) / angle.denominator
    cosine, sine = (int(context.nint(x * 10**60)) for x in (context.cos(at), context.sin(at)))
    return Fraction(cosine, 10**60), Fraction(sine, 10**60)


def projecting_loop(
    system: HamiltonEquations, weights: int, *, compensated: bool, number: MachineType = DOUBLE
) -> Loop:
    """Compile compositions of so many steps of order 2 between two halves of a symmetric projection.

    After the 2n numbers of compensation ``e`` keeps the number of iterations, the last change of one that did not
    converge, and d before the last two steps, from which the next is predicted.
    """
    w, size = Writer(number), 2 * len(system.q)
    copies = _Copies.of(w, system, compensated=compensated)
    projection = _Projection.of(w, copies)
    carry = 2 + 3 * size
    with blocks_of(w, copies.y, copies.e, size, carry) as kept:
        count, failed, guesses = size, size + 1, w.at(kept, size + 2)
        w.copy(guesses, projection.guess, size)
        w.copy(w.at(guesses, size), projection.before, size)
        with steps_of(w, system) as time:
            projection.begin()
            with w.loop(0, _ITERATIONS):
                w.store(w.algebra("add", w.load(kept, count), w.constant(Fraction(1))), kept, count)
                copies.set_clocks(time)
                projection.restart()
                with w.loop(0, 2 * weights + 1) as j:
                    copies.move(copies.is_odd(j), w.load("%c", w.let(f"add i64 {j}, {METHOD}")))
                projection.correct()
            lost, change = projection.end()
            w.store(w.select(lost, change, w.load(kept, failed)), kept, failed)
            with w.loop(0, size) as i:
                w.store(w.select(lost, projection.nothing, w.load(copies.y, i)), copies.y, i)
        w.copy(projection.guess, guesses, size)
        w.copy(projection.before, w.at(guesses, size), size)
    return compile_loop(w, len(system.q), compensated=compensated, carry=carry)


def projecting_coefficients(weights: Sequence[Fraction], h: Fraction) -> list[Fraction]:
    """Return what the loop reads after t0 and h: half the lengths of the parts in turn, neighbouring ones added."""
    times = [Fraction(0), *weights, Fraction(0)]
    evens = [h * (a + b) / 4 for a, b in itertools.pairwise(times)]
    odds = [h * w / 2 for w in weights]
    return [x for pair in zip(evens, odds, strict=False) for x in pair] + evens[-1:]


def _two(w: Writer, a: str, b: str) -> str:
    """Return two operands with their type."""
    return f"{w.number.name} {a}, {w.number.name} {b}"


@dataclass(frozen=True)
class _Copies:
    """Writes the parts of the doubled Hamiltonian.

    Parameters
    ----------
    w, system
        What is written to, and the equations.
    y, e, d
        The mean of the copies, its compensation or "", and half their difference.
    clocks
        The times of the copies.
    """

    w: Writer
    system: HamiltonEquations
    y: str
    e: str
    d: str
    clocks: str

    @classmethod
    def of(cls, w: Writer, system: HamiltonEquations, *, compensated: bool) -> _Copies:
        size = 2 * len(system.q)
        return cls(w, system, w.array(size), w.array(size) if compensated else "", w.array(size), w.array(2))

    @property
    def n(self) -> int:
        return len(self.system.q)

    def is_odd(self, j: str) -> str:
        """Return whether part j is one of H(x, p) rather than of H(q, y)."""
        return self.w.let(f"icmp eq i64 {self.w.let(f'and i64 {j}, 1')}, 1")

    def set_clocks(self, time: str) -> None:
        """Write the time at which a step starts."""
        self.w.store(time, self.clocks, 0)
        self.w.store(time, self.clocks, 1)

    def move(self, odd: str, half: str) -> None:
        """Write a part: H(x, p) where ``odd``, else H(q, y); ``half`` is half its length."""
        w, n = self.w, self.n
        one, minus = w.constant(Fraction(1)), w.constant(Fraction(-1))
        side = w.let(f"select i1 {odd}, {_two(w, one, minus)}")
        own = w.let(f"zext i1 {odd} to i64")
        other = w.let(f"xor i64 {own}, 1")
        place = [self._beside(side if i < n else w.negative(side), i) for i in range(2 * n)]
        rates = w.program(self.system.program(self.system.rates), [*place, w.load(self.clocks, own)])
        apart = w.algebra("mul", side, half)
        for i, rate in enumerate(rates):
            increase(w, self.y, self.e, str(i), half, rate)
            away = w.negative(apart) if i < n else apart
            w.store(w.multiply_add(away, rate, w.load(self.d, i)), self.d, i)
        if not self.system.autonomous:
            whole = w.algebra("add", half, half)
            w.store(w.algebra("add", w.load(self.clocks, other), whole), self.clocks, other)

    def _beside(self, side: str, i: int) -> str:
        """Return c_i ± d_i."""
        return self.w.multiply_add(side, self.w.load(self.d, i), self.w.load(self.y, i))

    def rotate(self, cosine: str, sine: str) -> None:
        """Write d ← (cos d_q + sin d_p, cos d_p − sin d_q)."""
        w = self.w
        with w.loop(0, self.n) as i:
            k = w.let(f"add i64 {i}, {self.n}")
            a, b = w.load(self.d, i), w.load(self.d, k)
            w.store(w.multiply_add(cosine, a, w.algebra("mul", sine, b)), self.d, i)
            w.store(w.multiply_add(cosine, b, w.algebra("mul", w.negative(sine), a)), self.d, k)


@dataclass(frozen=True)
class _Projection:
    """Writes the iteration for the d with which a step begins and to whose opposite it leads.

    Parameters
    ----------
    w, g
        Writers in the loop's numbers and in those, no wider than doubles, in which changes are watched.
    copies
        The copies.
    start, start_e
        The state before the step and its compensation.
    guess, before
        The d of this step, and that of the last one.
    residual
        d + (d after the step).
    sizes
        Of coordinates, then of momenta: the largest change and the largest component; then the least change so far.
    moves
        What gives N r.
    """

    w: Writer
    g: Writer
    copies: _Copies
    start: str
    start_e: str
    guess: str
    before: str
    residual: str
    sizes: str
    moves: Callable[[list[str]], list[str]]

    @classmethod
    def of(cls, w: Writer, copies: _Copies) -> _Projection:
        size = 2 * copies.n
        g = w.in_numbers(w.number if w.number == SINGLE else DOUBLE)
        start, start_e = w.array(size), w.array(size) if copies.e else ""
        guess, before, residual = (w.array(size) for _ in range(3))
        both = variational(copies.system, 1)
        n, slopes = copies.n, both.program((*both.velocity[copies.n :], *both.force[copies.n :]))

        def moves(r: list[str]) -> list[str]:
            state = [w.load(copies.y, i) for i in range(size)]
            turned = [*map(w.negative, r[:n]), *r[n:]]
            arguments = [*state[:n], *turned[:n], *state[n:], *turned[n:], w.load(copies.clocks, 0)]
            found = w.program(slopes, arguments)
            return [*found[:n], *map(w.negative, found[n:])]

        sizes = g.array(2 * _HALVES + 1)
        return cls(w, g, copies, start, start_e, guess, before, residual, sizes, moves)

    @property
    def size(self) -> int:
        return 2 * self.copies.n

    def begin(self) -> None:
        """Keep the state before the step and predict d from those of the last two steps."""
        w, copies = self.w, self.copies
        w.copy(copies.y, self.start, self.size)
        if copies.e:
            w.copy(copies.e, self.start_e, self.size)
        self.g.store(self.g.infinity(), self.sizes, 2 * _HALVES)
        with w.loop(0, self.size) as i:
            last = w.load(self.guess, i)
            step = w.algebra("sub", last, w.load(self.before, i))
            w.store(last, self.before, i)
            w.store(w.algebra("add", last, step), self.guess, i)

    def restart(self) -> None:
        """Go back to the state before the step, with the d that was found so far."""
        w, copies = self.w, self.copies
        w.copy(self.start, copies.y, self.size)
        if copies.e:
            w.copy(self.start_e, copies.e, self.size)
        w.copy(self.guess, copies.d, self.size)
        for k in range(2 * _HALVES):
            self.g.store(self.g.constant(Fraction(0)), self.sizes, k)

    def correct(self) -> None:
        """Write d ← d − (r − h N r/2)/2 with the residual r, and leave the loop after the last change."""
        w, g, copies = self.w, self.g, self.copies
        with w.loop(0, self.size) as i:
            w.store(w.algebra("add", w.load(self.guess, i), w.load(copies.d, i)), self.residual, i)
        r = [w.load(self.residual, i) for i in range(self.size)]
        half = w.constant(Fraction(1, 2))
        back = w.negative(w.algebra("mul", half, w.load("%c", 1)))
        for i, moved in enumerate(self.moves(r)):
            change = w.algebra("mul", half, w.multiply_add(back, moved, r[i]))
            w.store(w.algebra("sub", w.load(self.guess, i), change), self.guess, i)
            # A motion that comes to rest at the end of a step has momenta at its beginning.
            sizes = (0, change), (1, w.load(copies.y, i)), (1, w.load(self.start, i))
            for k, value in sizes if i in copies.system.rows else ():
                place = 2 * (i * _HALVES // self.size) + k
                size = g.intrinsic("fabs", value if w.number == SINGLE else w.as_double(value))
                g.store(g.intrinsic("maxnum", g.load(self.sizes, place), size), self.sizes, place)
        change, least = self._change(), g.load(self.sizes, 2 * _HALVES)
        small = w.let(f"xor i1 {self._moves_by_more_than(w.number.mantissa)}, true")
        settled = w.let(f"xor i1 {g.less(change, least)}, true")
        near = w.let(f"xor i1 {self._moves_by_more_than(self._coarse)}, true")
        g.store(g.intrinsic("minnum", change, least), self.sizes, 2 * _HALVES)
        w.leave_if(w.let(f"or i1 {small}, {w.let(f'and i1 {near}, {settled}')}"))

    def end(self) -> tuple[str, str]:
        """Return whether the iteration has not converged, and its last change."""
        return self._moves_by_more_than(self._coarse), self.w.widened(self._change(), self.g.number)

    @property
    def nothing(self) -> str:
        """What the state is where there is none."""
        return self.w.widened(self.g.nan(), self.g.number)

    @property
    def _coarse(self) -> int:
        return _CONVERGED * self.w.number.mantissa // DOUBLE.mantissa

    def _change(self) -> str:
        """Return the largest change."""
        g = self.g
        return g.intrinsic("maxnum", g.load(self.sizes, 0), g.load(self.sizes, 2))

    def _moves_by_more_than(self, bits: int) -> str:
        """Return whether a change is above 2⁻ᵇⁱᵗˢ of the largest component, coordinates and momenta apart."""
        g, flag = self.g, "false"
        for half in range(_HALVES):
            limit = g.algebra("mul", g.load(self.sizes, 2 * half + 1), g.constant(Fraction(1, 2**bits)))
            flag = self.w.let(f"or i1 {flag}, {g.less(limit, g.load(self.sizes, 2 * half))}")
        return flag
