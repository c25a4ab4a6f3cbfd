"""Planets about a star in SIMD lanes: the Kepler motion of each, and kicks by their attractions on one another.

Jacobi's coordinates: X_i is the place of body i from the centre of mass of the bodies before it, V_i its velocity;
H₀ = Σ |P_i|²/2m'_i − k'_i/|X_i| with m'_i = m_i M_{i−1}/M_i, M_i = Σ_{j≤i} m_j, and k'_i = Σ_{j<i} k_ij; H₁ is the rest
of the attractions.

Democratic heliocentric coordinates: X_i is the place of planet i from the star, V_i its velocity in the frame of the
centre of mass; H₀ = Σ m_i|V_i|²/2 − k_0i/|X_i|, H₁ = |Σ m_i V_i|²/2m_0 − Σ k_ij/|X_i − X_j|, whose two parts commute,
as one moves all X alike.

The centre of mass moves evenly and is put in where a state is asked for.

Sources: J. Wisdom, M. Holman, Symplectic maps for the N-body problem, Astron. J. 102 (1991) 1528–1538,
doi:10.1086/115978; M. J. Duncan, H. F. Levison, M. H. Lee, A multiple time step symplectic algorithm for integrating
close encounters, Astron. J. 116 (1998) 2067–2077, doi:10.1086/300541; lanes over planets: P. Javaheri, H. Rein,
D. Tamayo, WHFast512: a symplectic N-body integrator for planetary systems optimized with AVX512 instructions, Open J.
Astrophys. 6 (2023), doi:10.21105/astro.2307.05683.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate
from typing import TYPE_CHECKING

from canon.kernel.solvable.lanes import BodyLanes, StepLengths
from canon.kernel.solvable.planet_coordinates import (
    PlanetCoordinates,
    heliocentric_coordinates,
    jacobi_coordinates,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.llvm.writer import Writer
    from canon.kernel.solvable.solvable_parts import Planets

__all__ = ["HeliocentricPlanets", "JacobiPlanets"]


@dataclass(frozen=True)
class _Pull:
    """Attractions k d/|d|³ along vectors d: registers k/|d|³ and |d|²."""

    d: Sequence[str]
    strength: str
    square: str


class _PlanetsInLanes(BodyLanes):
    """Planets about a star, in coordinates that a subclass knows.

    Parameters
    ----------
    w
        Where the loop is written.
    part
        Star and planets.
    mu
        The gravitational parameters of the planets' orbits.
    chart
        The coordinates.
    compensated
        Whether round-off is carried along.
    """

    def __init__(
        self, w: Writer, part: Planets, mu: Sequence[Fraction], chart: PlanetCoordinates, *, compensated: bool
    ) -> None:
        self.part, self.m, self.chart = part, part.masses, chart
        axes = len(part.bodies[0])
        super().__init__(w, mu, axes, 4 * axes + 1, compensated=compensated)
        self.degrees = axes * len(self.m)
        self.centre = [w.at(self.extra, number * axes) for number in range(4)]
        self.steps = w.at(self.extra, 4 * axes)

    # the state outside -----------------------------------------------------------------------------

    def enter(self, y: str, e: str) -> None:
        """Write the planets' places and velocities, and those of the centre of mass."""
        bodies = range(len(self.m))
        mean = [m / sum(self.m) for m in self.m]
        self.w.store(self.w.constant(Fraction(0)), self.steps, 0)
        with self.w.loop(0, self.axes) as axis:
            places = [self.read(y, e, self._place(j, axis)) for j in bodies]
            momenta = [self.read(y, e, self._momentum(j, axis)) for j in bodies]
            velocities = [self.combined([1 / m], [p]) for m, p in zip(self.m, momenta, strict=True)]
            for values, matrix, first, centre in (
                (places, self.chart.places, self.places, self.centre[:2]),
                (velocities, self.chart.velocities, self.velocities, self.centre[2:]),
            ):
                own = [self.combined(row, values) for row in matrix]
                self.set_bodies(own, self.w.let(f"add i64 {axis}, {first}"))
                for part, where in zip(self.narrow(self.combined(mean, values)), centre, strict=True):
                    self.w.store(part, where, axis)

    def _place(self, body: int, axis: str) -> str:
        return self.w.entry(self.part.bodies[body], axis)

    def _momentum(self, body: int, axis: str) -> str:
        return self.w.let(f"add i64 {self._place(body, axis)}, {self.degrees}")

    def leave(self, y: str, e: str) -> None:
        """Write q and p of all bodies."""
        elapsed = self.w.algebra("mul", self.w.load(self.steps, 0), self.w.load("%c", 1))
        elapsed = self.wide(elapsed, self.w.constant(Fraction(0)))
        with self.w.loop(0, self.axes) as axis:
            place, velocity = (
                self.wide(*(self.w.load(part, axis) for part in parts))
                for parts in (self.centre[:2], self.centre[2:])
            )
            centre = self.pair.algebra("add", place, self.pair.algebra("mul", elapsed, velocity))
            rows = (self.w.let(f"add i64 {axis}, {first}") for first in (self.places, self.velocities))
            places, velocities = (
                [mean, *self.bodies(row)] for mean, row in zip((centre, velocity), rows, strict=True)
            )
            for i, m in enumerate(self.m):
                self.write(self.combined(self.chart.places_back[i], places), y, e, self._place(i, axis))
                speed = self.combined(self.chart.velocities_back[i], velocities)
                self.write(self.combined([m], [speed]), y, e, self._momentum(i, axis))

    def count(self, steps: str) -> None:
        """Count steps, for the centre of mass."""
        self.w.store(self.w.algebra("add", self.w.load(self.steps, 0), self.w.whole(steps)), self.steps, 0)

    # attractions -----------------------------------------------------------------------------------

    def _pull(self, strength: Sequence[Fraction], d: Sequence[str], idle: Sequence[Fraction] = ()) -> _Pull:
        """Return attractions; ``idle`` is added to |d|², so that lanes left over have a distance."""
        c = self.c
        square = c.numbers(idle) if idle else ""
        for value in d:
            square = c.fma(value, value, square) if square else c.mul(value, value)
        # The root and the quotient at once, rather than one after the other.
        part = c.div(c.numbers(self.filled(strength, Fraction(0))), c.mul(square, square))
        return _Pull(d, c.mul(c.sqrt(square), part), square)

    def _pulled(self, pull: _Pull, along: Sequence[str] | None = None) -> list[str]:
        """Return the attractions, or how they change where d changes by ``along``."""
        c = self.c
        if along is None:
            return [c.mul(pull.strength, d) for d in pull.d]
        turn = c.div(c.mul(c.number(Fraction(-3)), c.dot(pull.d, along)), pull.square)
        return [c.mul(pull.strength, c.fma(turn, d, a)) for d, a in zip(pull.d, along, strict=True)]

    def _turn(self, by: int) -> list[int]:
        """Return the order of lanes in which each planet's place is taken by the one ``by`` places on."""
        n = self.count_of_bodies
        return [(i + by) % n if i < n else i for i in range(self.lanes)]

    def _pairs(self, place: Sequence[str]) -> list[_Pull]:
        """Return the attractions among planets: each by the one k places on, k = 1 … ⌊n/2⌋."""
        n, attractions = self.count_of_bodies, self.part.attractions
        idle, pulls = self.filled([Fraction(0)] * n, Fraction(1)), list[_Pull]()
        for k in range(1, n // 2 + 1):
            onward = self._turn(k)
            strength = [attractions[i + 1][onward[i] + 1] for i in range(n)]
            pulls.append(self._pull(strength, self._differences(place, k), idle if self.lanes > n else ()))
        return pulls

    def _differences(self, place: Sequence[str], k: int) -> list[str]:
        return [self.c.sub(self.rearranged(value, self._turn(k)), value) for value in place]

    def _add_pairs(
        self, pulls: Sequence[_Pull], force: Sequence[str], place: Sequence[str] | None = None
    ) -> list[str]:
        """Add attractions and reactions to forces, or their changes where places change."""
        total, n = list(force), self.count_of_bodies
        for k, pull in enumerate(pulls, start=1):
            actions = self._pulled(pull, None if place is None else self._differences(place, k))
            for axis, action in enumerate(actions):
                total[axis] = self.c.add(total[axis], action) if total[axis] else action
                if 2 * k != n:
                    total[axis] = self.c.sub(total[axis], self.rearranged(action, self._turn(-k)))
        return total


class JacobiPlanets(_PlanetsInLanes):
    """Planets about a star in Jacobi's coordinates.

    Parameters
    ----------
    w
        Where the loop is written.
    part
        Star and planets.
    compensated
        Whether round-off is carried along.
    """

    def __init__(self, w: Writer, part: Planets, *, compensated: bool) -> None:
        m, k = part.masses, part.attractions
        total, count = list(accumulate(m)), range(1, len(m))
        self.reduced = [m[i] * total[i - 1] / total[i] for i in count]
        self.shares = [m[i] / total[i] for i in count]
        mu = [sum(k[i][:i]) / reduced for i, reduced in zip(count, self.reduced, strict=True)]
        self.own = mu
        super().__init__(w, part, mu, jacobi_coordinates(m), compensated=compensated)

    def kicked(self, x: list[str], u: list[str], times: StepLengths) -> tuple[list[str], list[str]]:
        """Write the velocities' change by what H₀ leaves of the attractions.

        With R_i the place from the star, R = CX, and f_i = −∂V/∂R_i the change of V_i is t(Σ_j C_ji f_j/m'_i + µ_i
        X_i/|X_i|³), C_ij = m_j/M_j for 0 < j < i and C_ii = 1.
        """
        c, place = self.c, self._from_star(x)
        star = self._pull([-k for k in self.part.attractions[0][1:]], place)
        pairs = self._pairs(place)
        # 1/|X| as the flow that follows has it; the lanes left over move on plain orbits.
        square = c.dot(x, x)
        near = c.div(c.one, c.sqrt(square))
        weight = c.mul(c.numbers(self.filled(self.own, Fraction(0))), near)
        own = _Pull(x, c.mul(weight, c.mul(near, near)), square)
        forces = self._add_pairs(pairs, self._pulled(star))
        rates = [self._gathered_by(*each) for each in zip(self._pulled(own), forces, strict=True)]
        if not times.commutator:
            return x, self.increased(self.velocities, u, self.v.splat(times.kick), rates)
        along = self._from_star(rates)
        forces = self._add_pairs(pairs, self._pulled(star, along), along)
        bends = [self._gathered_by(*each) for each in zip(self._pulled(own, rates), forces, strict=True)]
        kick, more = self.v.splat(times.kick), self.v.splat(times.commutator)
        change = [c.fma(more, b, c.mul(kick, a)) for a, b in zip(rates, bends, strict=True)]
        return x, self.increased(self.velocities, u, c.one, change)

    def _from_star(self, x: Sequence[str]) -> list[str]:
        """Return R = CX along each axis."""
        c, n, found = self.c, self.count_of_bodies, list[str]()
        for value in x:
            total = value
            for j in range(n - 1):
                column = [self.shares[j] if j < i else Fraction(0) for i in range(n)]
                one = self.rearranged(value, [j] * self.lanes)
                total = c.fma(c.numbers(self.filled(column, Fraction(0))), one, total)
            found.append(total)
        return found

    def _gathered_by(self, start: str, force: str) -> str:
        """Return start_i + Σ_j C_ji f_j/m'_i, summed by pairs of columns: short chains."""
        c, n = self.c, self.count_of_bodies
        sums = [c.fma(c.numbers(self.filled([1 / m for m in self.reduced], Fraction(0))), force, start)]
        for j in range(1, n):
            weights = [self.shares[i] / self.reduced[i] if i < j else Fraction(0) for i in range(n)]
            entries = c.numbers(self.filled(weights, Fraction(0)))
            one = self.rearranged(force, [j] * self.lanes)
            if j % 2:
                sums.append(c.mul(entries, one))
            else:
                sums[-1] = c.fma(entries, one, sums[-1])
        while len(sums) > 1:
            sums = [c.add(*sums[i : i + 2]) if i + 1 < len(sums) else sums[i] for i in range(0, len(sums), 2)]
        return sums[0]


class HeliocentricPlanets(_PlanetsInLanes):
    """Planets about a star in democratic heliocentric coordinates.

    Parameters
    ----------
    w
        Where the loop is written.
    part
        Star and planets.
    compensated
        Whether round-off is carried along.
    """

    def __init__(self, w: Writer, part: Planets, *, compensated: bool) -> None:
        m = part.masses
        mu = [k / mass for k, mass in zip(part.attractions[0][1:], m[1:], strict=True)]
        super().__init__(w, part, mu, heliocentric_coordinates(m), compensated=compensated)

    def kicked(self, x: list[str], u: list[str], times: StepLengths) -> tuple[list[str], list[str]]:
        """Write X ← X + t Σ m_j V_j/m_0 and the change of V by the attractions among planets."""
        c, kick = self.c, self.v.splat(times.kick)
        m = self.part.masses
        weights = c.numbers(self.filled([mass / m[0] for mass in m[1:]], Fraction(0)))
        jump = [self._summed(c.mul(weights, value)) for value in u]
        used = c.numbers(self.filled([Fraction(1)] * self.count_of_bodies, Fraction(0)))
        x = self.increased(self.places, x, c.mul(kick, used), jump)
        forces = self._add_pairs(self._pairs(x), [""] * self.axes)
        if not forces[0]:
            return x, u
        inverse = c.numbers(self.filled([1 / mass for mass in m[1:]], Fraction(0)))
        return x, self.increased(self.velocities, u, kick, [c.mul(inverse, force) for force in forces])

    def _summed(self, value: str) -> str:
        """Return the sum over all lanes, in every lane."""
        if self.lanes & (self.lanes - 1):
            total = self.rearranged(value, [0] * self.lanes)
            for lane in range(1, self.count_of_bodies):
                total = self.c.add(total, self.rearranged(value, [lane] * self.lanes))
            return total
        stride = self.lanes // 2
        while stride:
            value = self.c.add(value, self.rearranged(value, [i ^ stride for i in range(self.lanes)]))
            stride //= 2
        return value
