"""Gauss–Legendre methods: symplectic for every Hamiltonian, order 2s with s stages, implicit.

The stages solve L_i = h b_i f(Y_i), Y_i = y + (e + Σ_j µ_ij L_j) with µ_ij = a_ij/b_j. A Runge–Kutta method is
symplectic where µ_ij + µ_ji = 1, which the rounded µ fulfil exactly here; the iteration goes on until no
component's change still decreases, then once more, so that what is left is round-off without a trend; the sum
y + Σ L_i is compensated.

Sources: E. Hairer, R. I. McLachlan, A. Razakarivony, Achieving Brouwer's law with implicit Runge–Kutta methods,
BIT 48 (2008) 231–243, doi:10.1007/s10543-008-0170-3; M. Antoñana, J. Makazaga, A. Murua, Reducing and monitoring
round-off error propagation for symplectic implicit Runge–Kutta schemes, Numer. Algorithms 76 (2017) 861–880,
doi:10.1007/s11075-017-0287-z.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from mpmath import MPContext

from canon.expression.arithmetic import LONGDOUBLE
from canon.kernel.loop import METHOD, Loop, blocks_of, finished, increase, steps_of
from canon.kernel.machine import DOUBLE, EXTENDED, SINGLE, double_pair
from canon.kernel.writer import Writer

if TYPE_CHECKING:
    from canon.kernel.machine import MachineType
    from canon.kernel.structure import Equations

__all__ = ["HIGHEST_STAGES", "Tableau", "gauss_coefficients", "gauss_loop", "gauss_tableau"]

HIGHEST_STAGES = 8
_ITERATIONS = 100
_BITS = 42, 20
"""In doubles, changes above 2⁻⁴² of the largest component are not taken for round-off while iterations are left; a
last change above 2⁻²⁰ of it means that the iteration has not converged. In other numbers accordingly."""


@dataclass(frozen=True)
class Tableau:
    """Nodes and weights of Gauss–Legendre quadrature on [0, 1] and the method's matrices, 60 digits.

    Parameters
    ----------
    c, b
        Nodes and weights.
    mu
        µ_ij = a_ij / b_j; µ_ij + µ_ji = 1.
    prediction
        ν_ij: L_i of the next step is about Σ ν_ij L_j, the stages' polynomial continued.
    """

    c: tuple[Fraction, ...]
    b: tuple[Fraction, ...]
    mu: tuple[tuple[Fraction, ...], ...]
    prediction: tuple[tuple[Fraction, ...], ...]


@functools.cache
def gauss_tableau(stages: int) -> Tableau:
    """Return the Gauss–Legendre method with s stages, from its definition.

    The nodes are the zeros of the shifted Legendre polynomial P_s(2c − 1); a_ij and b_j integrate Lagrange's
    polynomials ℓ_j over [0, c_i] and [0, 1].
    """
    context = MPContext()
    context.dps = 80
    legendre: Any = sp.legendre_poly(stages, polys=True)
    zeros = context.polyroots([int(2**stages * x) for x in legendre.all_coeffs()], maxsteps=200)
    c: list[Any] = sorted((1 + context.re(zero)) / 2 for zero in zeros)
    vandermonde = context.matrix([[node**k for node in c] for k in range(stages)])

    def weights(moments: list[Any]) -> list[Any]:
        return list(context.lu_solve(vandermonde, context.matrix(moments)))

    b = weights([context.mpf(1) / (k + 1) for k in range(stages)])
    mu = [
        [
            a / weight
            for a, weight in zip(weights([x ** (k + 1) / (k + 1) for k in range(stages)]), b, strict=True)
        ]
        for x in c
    ]
    prediction = [
        [
            own * ell / weight
            for ell, weight in zip(weights([(1 + x) ** k for k in range(stages)]), b, strict=True)
        ]
        for x, own in zip(c, b, strict=True)
    ]
    digits = context.mpf(10) ** 60

    def exact(values: list[Any]) -> tuple[Fraction, ...]:
        return tuple(Fraction(int(context.nint(value * digits)), 10**60) for value in values)

    return Tableau(exact(c), exact(b), tuple(map(exact, mu)), tuple(map(exact, prediction)))


def gauss_coefficients(stages: int, h: Fraction, number: MachineType = DOUBLE) -> list[Fraction]:
    """Return what the loop reads after t0 and h: h b, h c, the columns of µ, the columns of ν, padded to lanes.

    µ_ij is rounded for i > j, where it lies in [½, 2] so that 1 − µ_ij is a number of the same type as well.
    """
    tableau = gauss_tableau(stages)

    def rounded(value: Fraction) -> Fraction:
        return _rounded(value, number)

    mu = [[Fraction(1, 2)] * stages for _ in range(stages)]
    for i in range(stages):
        for j in range(i):
            mu[i][j] = rounded(tableau.mu[i][j])
            mu[j][i] = 1 - mu[i][j]
    rows = [
        [rounded(h * b) for b in tableau.b],
        [rounded(h * c) for c in tableau.c],
        *map(list, zip(*mu, strict=True)),
        *([rounded(x) for x in column] for column in zip(*tableau.prediction, strict=True)),
    ]
    empty = [Fraction(0)] * (_lanes(stages) - stages)
    return [x for row in rows for x in (*row, *empty)]


def _rounded(value: Fraction, number: MachineType) -> Fraction:
    """Return a number of a type near an exact one."""
    if number == EXTENDED:
        return Fraction(*LONGDOUBLE.number(value).as_integer_ratio())
    high, low = double_pair(value)
    if number.pair:
        return Fraction(high) + Fraction(low)
    return Fraction(*np.dtype(number.dtype).type(high).as_integer_ratio())


def _lanes(stages: int) -> int:
    return 1 << (stages - 1).bit_length()


def gauss_loop(system: Equations, stages: int, *, compensated: bool, number: MachineType = DOUBLE) -> Loop:
    """Compile Gauss–Legendre steps, the stages side by side in SIMD lanes.

    After the 2n numbers of compensation, ``e`` keeps the number of iterations, the last change of an iteration
    that did not converge, and the stages L, from which the next step's are predicted. A step whose
    iteration does not converge makes the state NaN. In single precision iterations are counted up to 2²⁴.
    """
    size, lanes = 2 * len(system.q), _lanes(stages)
    w = Writer(number)
    v = w.side_by_side(lanes)
    # Changes and sizes are watched in numbers no wider than doubles, of pairs by their high parts.
    watched = number if number == SINGLE else DOUBLE
    d, g = (each.in_numbers(replace(watched, lanes=each.number.lanes)) for each in (w, v))
    round_off, not_converged = (Fraction(1, 2 ** (bits * number.mantissa // 53)) for bits in _BITS)
    carry = size + 2 + size * lanes
    y, e = w.array(size), w.array(size) if compensated else ""
    method = _Stages(w, v, w.at("%c", METHOD), stages)
    stage, place, least = v.array(size), v.array(size), g.array(size)
    done, change, reach = d.array(1), g.array(1), g.array(1)
    zero, none = d.constant(Fraction(0)), v.constant(Fraction(0))
    nothing = g.constant(Fraction(0))
    field = system.program(system.rates)
    with blocks_of(w, y, e, size, carry) as kept:
        with w.loop(0, size) as i:
            v.store(_row(w, v, w.at(kept, size + 2), i), stage, i)
        with steps_of(w, system) as time:
            clock = v.algebra("add", v.splat(time), method.node)
            with w.loop(0, size) as i:
                v.store(method.predicted(v.load(stage, i)), stage, i)
                g.store(g.infinity(), least, i)
            d.store(zero, done, 0)
            with w.loop(0, _ITERATIONS):
                last = d.less(zero, d.load(done, 0))
                with w.loop(0, size) as i:
                    moved = method.moved(v.splat(w.load(e, i)) if e else none, v.load(stage, i))
                    v.store(v.algebra("add", v.splat(w.load(y, i)), moved), place, i)
                g.store(nothing, change, 0)
                g.store(nothing, reach, 0)
                d.store(d.constant(Fraction(1)), done, 0)
                for i, rate in enumerate(v.program(field, [*(v.load(place, i) for i in range(size)), clock])):
                    new = v.algebra("mul", method.weight, rate)
                    difference = _size(v, g, v.algebra("sub", new, v.load(stage, i)))
                    before = g.load(least, i)
                    decreasing = g.any_lane(g.less(difference, before))
                    v.store(new, stage, i)
                    g.store(g.intrinsic("minnum", before, difference), least, i)
                    g.store(g.intrinsic("maxnum", g.load(change, 0), difference), change, 0)
                    far = g.algebra("add", _size(v, g, new), _size(v, g, v.load(place, i)))
                    g.store(g.intrinsic("maxnum", g.load(reach, 0), far), reach, 0)
                    d.store(d.select(decreasing, zero, d.load(done, 0)), done, 0)
                w.store(w.algebra("add", w.load(kept, size), w.constant(Fraction(1))), kept, size)
                moves, scale = g.greatest(g.load(change, 0)), g.greatest(g.load(reach, 0))
                coarse = d.less(d.algebra("mul", scale, d.constant(round_off)), moves)
                d.store(d.select(coarse, zero, d.load(done, 0)), done, 0)
                w.leave_if(w.let(f"or i1 {last}, {d.equal(moves, zero)}"))
            moves, scale = g.greatest(g.load(change, 0)), g.greatest(g.load(reach, 0))
            large = d.less(d.algebra("mul", scale, d.constant(not_converged)), moves)
            diverges = w.let(f"or i1 {large}, {d.equal(scale, d.infinity())}")
            last_change = w.select(diverges, w.widened(moves, watched), w.load(kept, size + 1))
            w.store(last_change, kept, size + 1)
            lost = w.widened(d.nan(), watched)
            with w.loop(0, size) as i:
                w.store(w.select(diverges, lost, w.load(y, i)), y, i)
                found = v.load(stage, i)
                for j in range(stages):
                    increase(w, y, e, i, w.constant(Fraction(1)), v.lane(found, j))
        with w.loop(0, size) as i:
            _store_row(w, v, v.load(stage, i), w.at(kept, size + 2), i)
    return finished(w, len(system.q), compensated=compensated, carry=carry)


def _size(v: Writer, g: Writer, value: str) -> str:
    """Write the sizes of numbers in lanes, in the numbers that sizes are watched in."""
    if v.number.pair:
        value = v.let(f"extractvalue {v.number.name} {value}, 0")
    elif v.number.scalar != g.number.scalar:
        value = v.let(f"fptrunc {v.number.name} {value} to {g.number.name}")
    return g.intrinsic("fabs", value)


def _row(w: Writer, v: Writer, table: str, k: int | str) -> str:
    """Read numbers that lie in memory one by one into lanes."""
    lanes = v.number.lanes
    if lanes == 1 or not (v.number.pair or v.number.scalar == "x86_fp80"):
        return v.load(table, k)
    first = w.let(f"mul i64 {k}, {lanes}")
    return v.from_lanes([w.load(table, w.let(f"add i64 {first}, {lane}")) for lane in range(lanes)])


def _store_row(w: Writer, v: Writer, value: str, table: str, k: str) -> None:
    """Store lanes as numbers that lie in memory one by one."""
    first = w.let(f"mul i64 {k}, {v.number.lanes}")
    for lane in range(v.number.lanes):
        w.store(v.lane(value, lane), table, w.let(f"add i64 {first}, {lane}"))


class _Stages:
    """The method's numbers, read from the loop's coefficients, and the sums over stages made with them."""

    def __init__(self, w: Writer, v: Writer, table: str, stages: int) -> None:
        self.v, self.stages = v, stages

        def row(k: int) -> str:
            return _row(w, v, table, k)

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
