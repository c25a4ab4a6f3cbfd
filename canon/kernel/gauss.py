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
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from mpmath import MPContext

from canon.kernel.loop import METHOD, Loop, blocks_of, finished, increase, steps_of
from canon.kernel.machine import DOUBLE
from canon.kernel.writer import Writer

if TYPE_CHECKING:
    from canon.kernel.structure import Equations

__all__ = ["HIGHEST_STAGES", "Tableau", "gauss_coefficients", "gauss_loop", "gauss_tableau"]

HIGHEST_STAGES = 8
_ITERATIONS = 100
_ROUND_OFF = Fraction(1, 2**42)
"""Changes above this part of the largest component are not taken for round-off while iterations are left."""

_NOT_CONVERGED = Fraction(1, 2**20)
"""A last change above this part of the largest component means that the iteration has not converged."""


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


def gauss_coefficients(stages: int, h: Fraction) -> list[float]:
    """Return what the loop reads after t0 and h: h b, h c, the columns of µ, the columns of ν, padded to lanes.

    µ_ij is rounded for i > j, where it lies in [½, 2] so that 1 − µ_ij is a double as well.
    """
    tableau = gauss_tableau(stages)
    mu = np.full((stages, stages), 0.5)
    for i in range(stages):
        for j in range(i):
            mu[i, j] = float(tableau.mu[i][j])
            mu[j, i] = 1 - mu[i, j]
    rows = [
        [float(h * b) for b in tableau.b],
        [float(h * c) for c in tableau.c],
        *mu.T,
        *np.array(tableau.prediction, dtype=np.float64).T,
    ]
    padded = np.zeros((len(rows), _lanes(stages)))
    padded[:, :stages] = rows
    return padded.ravel().tolist()


def _lanes(stages: int) -> int:
    return 1 << (stages - 1).bit_length()


def gauss_loop(system: Equations, stages: int, *, compensated: bool) -> Loop:
    """Compile Gauss–Legendre steps, the stages side by side in SIMD lanes.

    After the 2n numbers of compensation, ``e`` keeps the number of iterations, the last change of an iteration
    that did not converge, and the stages L, from which the next step's are predicted. A step whose
    iteration does not converge makes the state NaN.
    """
    size, lanes = 2 * len(system.q), _lanes(stages)
    w = Writer(DOUBLE)
    v = w.side_by_side(lanes)
    carry = size + 2 + size * lanes
    y, e = w.array(size), w.array(size) if compensated else ""
    method = _Stages(v, w.at("%c", METHOD), stages)
    stage, place, least = v.array(size), v.array(size), v.array(size)
    done, change, reach = w.array(1), v.array(1), v.array(1)
    zero, none = w.constant(Fraction(0)), v.constant(Fraction(0))
    field = system.program((*system.velocity, *system.force))
    with blocks_of(w, y, e, size, carry) as kept:
        v.copy(w.at(kept, size + 2), stage, size)
        with steps_of(w, system) as time:
            clock = v.algebra("add", v.splat(time), method.node)
            with w.loop(0, size) as i:
                v.store(method.predicted(v.load(stage, i)), stage, i)
                v.store(v.infinity(), least, i)
            w.store(zero, done, 0)
            with w.loop(0, _ITERATIONS):
                last = w.less(zero, w.load(done, 0))
                with w.loop(0, size) as i:
                    moved = method.moved(v.splat(w.load(e, i)) if e else none, v.load(stage, i))
                    v.store(v.algebra("add", v.splat(w.load(y, i)), moved), place, i)
                v.store(none, change, 0)
                v.store(none, reach, 0)
                w.store(w.constant(Fraction(1)), done, 0)
                for i, rate in enumerate(v.program(field, [*(v.load(place, i) for i in range(size)), clock])):
                    new = v.algebra("mul", method.weight, rate)
                    difference = v.intrinsic("fabs", v.algebra("sub", new, v.load(stage, i)))
                    before = v.load(least, i)
                    decreasing = v.any_lane(v.less(difference, before))
                    v.store(new, stage, i)
                    v.store(v.intrinsic("minnum", before, difference), least, i)
                    v.store(v.intrinsic("maxnum", v.load(change, 0), difference), change, 0)
                    far = v.algebra("add", v.intrinsic("fabs", new), v.intrinsic("fabs", v.load(place, i)))
                    v.store(v.intrinsic("maxnum", v.load(reach, 0), far), reach, 0)
                    w.store(w.select(decreasing, zero, w.load(done, 0)), done, 0)
                w.store(w.algebra("add", w.load(kept, size), w.constant(Fraction(1))), kept, size)
                moves, scale = v.greatest(v.load(change, 0)), v.greatest(v.load(reach, 0))
                coarse = w.less(w.algebra("mul", scale, w.constant(_ROUND_OFF)), moves)
                w.store(w.select(coarse, zero, w.load(done, 0)), done, 0)
                w.leave_if(w.let(f"or i1 {last}, {w.equal(moves, zero)}"))
            moves, scale = v.greatest(v.load(change, 0)), v.greatest(v.load(reach, 0))
            diverges = w.less(w.algebra("mul", scale, w.constant(_NOT_CONVERGED)), moves)
            w.store(w.select(diverges, moves, w.load(kept, size + 1)), kept, size + 1)
            w.store(w.select(diverges, w.nan(), w.load(y, 0)), y, 0)
            with w.loop(0, size) as i:
                found = v.load(stage, i)
                for j in range(stages):
                    increase(w, y, e, i, w.constant(Fraction(1)), v.lane(found, j))
        v.copy(stage, w.at(kept, size + 2), size)
    return finished(w, len(system.q), compensated=compensated, carry=carry)


class _Stages:
    """The method's numbers, read from the loop's coefficients, and the sums over stages made with them."""

    def __init__(self, v: Writer, table: str, stages: int) -> None:
        self.v, self.stages = v, stages
        self.weight, self.node = v.load(table, 0), v.load(table, 1)
        columns = [v.load(table, 2 + column) for column in range(2 * stages)]
        self.mu, self.prediction = columns[:stages], columns[stages:]

    def moved(self, carried: str, stage: str) -> str:
        """Write e + Σ_j µ_ij L_j for all stages i."""
        return self._sum(carried, self.mu, stage)

    def predicted(self, stage: str) -> str:
        """Write Σ_j ν_ij L_j for all stages i."""
        return self._sum(self.v.constant(Fraction(0)), self.prediction, stage)

    def _sum(self, total: str, columns: list[str], stage: str) -> str:
        for j, column in enumerate(columns):
            total = self.v.intrinsic("fma", column, self.v.splat(self.v.lane(stage, j)), total)
        return total
