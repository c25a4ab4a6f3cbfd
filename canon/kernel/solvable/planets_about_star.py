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
from canon.kernel.solvable.planet_attractions import PlanetAttractions, Pull
from canon.kernel.solvable.planet_coordinates import (
    PlanetCoordinates,
    heliocentric_coordinates,
    jacobi_coordinates,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.llvm.writer import Writer
    from canon.kernel.solvable.lanes import Derivative
    from canon.kernel.solvable.solvable_parts import Planets

__all__ = ["HeliocentricPlanets", "JacobiPlanets"]


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
        self.attractions = PlanetAttractions(self, part.attractions)
        self.numbers_beside = 2 * axes
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

    # deviations ------------------------------------------------------------------------------------

    def enter_deviation(self, outer: str, inner: str) -> None:
        """Write δX and δV of the planets, then those of the centre of mass."""
        w, beside, bodies = self.w, self._beside(inner), range(len(self.m))
        whole = sum(self.m, Fraction(0))
        mean = [m / whole for m in self.m]
        with w.loop(0, self.axes) as axis:
            places = [w.load(outer, self._place(j, axis)) for j in bodies]
            momenta = [w.load(outer, self._momentum(j, axis)) for j in bodies]
            self.set_deviation([self.summed(row, places) for row in self.chart.places], axis, inner)
            slow = [[a / m for a, m in zip(row, self.m, strict=True)] for row in self.chart.velocities]
            velocities = [self.summed(row, momenta) for row in slow]
            self.set_deviation(velocities, w.let(f"add i64 {axis}, {self.axes}"), inner)
            w.store(self.summed(mean, places), beside, axis)
            w.store(self.summed([1 / whole for _ in bodies], momenta), w.at(beside, self.axes), axis)

    def leave_deviation(self, inner: str, outer: str, steps: str) -> None:
        """Write (δq, δp) of all bodies."""
        w, beside = self.w, self._beside(inner)
        elapsed = w.algebra("mul", w.whole(steps), w.load("%c", 1))
        with w.loop(0, self.axes) as axis:
            velocity = w.load(w.at(beside, self.axes), axis)
            centre = w.multiply_add(elapsed, velocity, w.load(beside, axis))
            places = [centre, *self.deviation(axis, inner)]
            velocities = [velocity, *self.deviation(w.let(f"add i64 {axis}, {self.axes}"), inner)]
            for i, m in enumerate(self.m):
                w.store(self.summed(self.chart.places_back[i], places), outer, self._place(i, axis))
                back = [m * a for a in self.chart.velocities_back[i]]
                w.store(self.summed(back, velocities), outer, self._momentum(i, axis))

    def _beside(self, inner: str) -> str:
        return self.w.at(inner, 2 * self.axes * self.lanes)


@dataclass(frozen=True)
class _JacobiPulls:
    """What H₀ leaves of the attractions, R(X) for the velocities, and its derivatives.

    Parameters
    ----------
    planets
        The planets.
    own, star, pairs
        The attractions that H₀ holds, those by the star, and those among planets.
    """

    planets: JacobiPlanets
    own: Pull
    star: Pull
    pairs: list[Pull]

    def rates(self) -> list[str]:
        """Return R(X)."""
        a = self.planets.attractions
        return self._gathered(a.pulled(self.own), a.add_pulls(self.pairs, a.pulled(self.star)))

    def changes(self, dx: Sequence[str]) -> list[str]:
        """Return R′(X) δX."""
        a, along = self.planets.attractions, self.planets.from_star(dx)
        forces = a.add_changes(self.pairs, a.changed(self.star, along), along)
        return self._gathered(a.changed(self.own, dx), forces)

    def bends(self, first: Sequence[str], second: Sequence[str]) -> list[str]:
        """Return R″(X)[a, b]."""
        a = self.planets.attractions
        one, other = self.planets.from_star(first), self.planets.from_star(second)
        forces = a.add_bends(self.pairs, a.bent(self.star, one, other), one, other)
        return self._gathered(a.bent(self.own, first, second), forces)

    def _gathered(self, own: Sequence[str], forces: Sequence[str]) -> list[str]:
        return [self.planets.gathered_by(*each) for each in zip(own, forces, strict=True)]


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
        c, pulls = self.c, self._pulls(x)
        rates = pulls.rates()
        if not times.commutator:
            return x, self.increased(self.velocities, u, self.v.splat(times.kick), rates)
        kick, more = self.v.splat(times.kick), self.v.splat(times.commutator)
        change = [c.fma(more, b, c.mul(kick, a)) for a, b in zip(rates, pulls.changes(rates), strict=True)]
        return x, self.increased(self.velocities, u, c.one, change)

    def kick_derivative(self, x: list[str], times: StepLengths) -> Derivative:
        """Return what moves deviations as the kick that found the planets at x moves the orbit."""
        c, pulls, kick = self.c, self._pulls(x), self.v.splat(times.kick)
        more = self.v.splat(times.commutator) if times.commutator else ""
        rates = pulls.rates() if more else []

        def moved(dx: list[str], du: list[str]) -> tuple[list[str], list[str]]:
            first = pulls.changes(dx)
            turned = [c.fma(kick, a, b) for a, b in zip(first, du, strict=True)]
            if more:
                bends = zip(pulls.bends(rates, dx), pulls.changes(first), strict=True)
                turned = [c.fma(more, c.add(*two), b) for two, b in zip(bends, turned, strict=True)]
            return dx, turned

        return moved

    def _pulls(self, x: Sequence[str]) -> _JacobiPulls:
        c, attractions = self.c, self.attractions
        place = self.from_star(x)
        star = attractions.pull([-k for k in self.part.attractions[0][1:]], place)
        # 1/|X| as the flow that follows has it; the lanes left over move on plain orbits.
        square = c.dot(x, x)
        near = c.div(c.one, c.sqrt(square))
        weight = c.mul(c.numbers(self.filled(self.own, Fraction(0))), near)
        own = Pull(x, c.mul(weight, c.mul(near, near)), c.div(c.number(Fraction(-3)), square))
        return _JacobiPulls(self, own, star, attractions.pairs(place))

    def from_star(self, x: Sequence[str]) -> list[str]:
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

    def gathered_by(self, start: str, force: str) -> str:
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
        kick = self.v.splat(times.kick)
        x = self.increased(self.places, x, self._reach(kick), self._jump(u))
        pairs = self.attractions.pairs(x)
        if not pairs:
            return x, u
        forces = self.attractions.add_pulls(pairs, [""] * self.axes)
        return x, self.increased(self.velocities, u, kick, self._accelerations(forces))

    def kick_derivative(self, x: list[str], times: StepLengths) -> Derivative:
        """Return what moves deviations as the kick that left the planets at x moves the orbit."""
        c, kick, pairs = self.c, self.v.splat(times.kick), self.attractions.pairs(x)
        reach = self._reach(kick)

        def moved(dx: list[str], du: list[str]) -> tuple[list[str], list[str]]:
            dx = [c.fma(reach, a, b) for a, b in zip(self._jump(du), dx, strict=True)]
            if not pairs:
                return dx, du
            changes = self._accelerations(self.attractions.add_changes(pairs, [""] * self.axes, dx))
            return dx, [c.fma(kick, a, b) for a, b in zip(changes, du, strict=True)]

        return moved

    def _reach(self, kick: str) -> str:
        """Return the kick's time in the lanes of planets, 0 in those left over."""
        used = self.filled([Fraction(1)] * self.count_of_bodies, Fraction(0))
        return self.c.mul(kick, self.c.numbers(used))

    def _jump(self, u: Sequence[str]) -> list[str]:
        """Return Σ m_j V_j/m_0, the same for all planets."""
        m = self.part.masses
        weights = self.c.numbers(self.filled([mass / m[0] for mass in m[1:]], Fraction(0)))
        return [self._summed(self.c.mul(weights, value)) for value in u]

    def _accelerations(self, forces: Sequence[str]) -> list[str]:
        inverse = self.c.numbers(self.filled([1 / mass for mass in self.part.masses[1:]], Fraction(0)))
        return [self.c.mul(inverse, force) for force in forces]

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
