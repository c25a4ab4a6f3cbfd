"""Bodies side by side in SIMD lanes: Kepler's motion of each, and kicks by what they do to one another.

Planets move in Jacobi's coordinates, X_i the place of body i from the centre of mass of the bodies before it, V_i
its velocity; H₀ = Σ |P_i|²/2m'_i − k'_i/|X_i| with m'_i = m_i M_{i−1}/M_i, M_i = Σ_{j≤i} m_j, and k'_i = Σ_{j<i} k_ij.
The centre of mass moves evenly and is put in where a state is asked for.

Sources: J. Wisdom, M. Holman, Symplectic maps for the N-body problem, Astron. J. 102 (1991) 1528–1538,
doi:10.1086/115978; lanes over planets: P. Javaheri, H. Rein, D. Tamayo, WHFast512: a symplectic N-body integrator for
planetary systems optimized with AVX512 instructions, Open J. Astrophys. 6 (2023), doi:10.21105/astro.2307.05683.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import accumulate
from typing import TYPE_CHECKING

from canon.kernel.arithmetic import Arithmetic
from canon.kernel.kepler import kepler_flow
from canon.kernel.loop import increase
from canon.kernel.machine import DOUBLE_DOUBLE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.planets import Centres, Planets
    from canon.kernel.writer import Writer

__all__ = ["CentresInLanes", "PlanetsInLanes"]

_WIDE = 8


def _lanes(bodies: int) -> int:
    return 1 << (bodies - 1).bit_length() if bodies <= _WIDE else -(-bodies // _WIDE) * _WIDE


class _Lanes:
    """The working state of some bodies: places and velocities by axis, each a vector over bodies, and round-off."""

    def __init__(
        self, w: Writer, mu: Sequence[Fraction], axes: int, extra: int, *, compensated: bool
    ) -> None:
        self.w, self.count_of_bodies, self.axes, self.compensated = w, len(mu), axes, compensated
        self.lanes = _lanes(len(mu))
        self.v = w.side_by_side(self.lanes)
        self.c = Arithmetic(self.v)
        self.pair = w.in_numbers(DOUBLE_DOUBLE)
        block = axes * self.lanes
        self.words = 4 * block + extra
        self.state = w.array(self.words)
        self.x, self.u, self.ex, self.eu = (w.at(self.state, k * block) for k in range(4))
        self.extra = w.at(self.state, 4 * block)
        self.mu = self.c.numbers(self.filled(mu))

    def filled(self, values: Sequence[Fraction], other: Fraction | None = None) -> list[Fraction]:
        """Return a value for each lane; the lanes left over repeat the last body, or have ``other``."""
        return [*values, *[values[-1] if other is None else other] * (self.lanes - len(values))]

    def flow(self, time: str, pair: str) -> None:
        """Write Kepler's motion of all bodies."""
        del pair
        x, u = ([self.v.load(array, axis) for axis in range(self.axes)] for array in (self.x, self.u))
        moved, turned = kepler_flow(self.w, self.v, x, u, self.mu, self.v.splat(time))
        for axis in range(self.axes):
            self.add(self.x, self.ex, axis, self.c.one, moved[axis])
            self.add(self.u, self.eu, axis, self.c.one, turned[axis])

    def add(self, array: str, carried: str, axis: int, coefficient: str, rate: str) -> None:
        """Write array ← array + coefficient · rate along an axis."""
        increase(self.v, array, carried if self.compensated else "", str(axis), coefficient, rate)

    # pairs of doubles ------------------------------------------------------------------------------

    def joined(self, high: str, low: str) -> str:
        """Return high + low as one number of twice the precision."""
        kind = self.pair.number.name
        first = self.w.let(f"insertvalue {kind} poison, double {high}, 0")
        return self.w.let(f"insertvalue {kind} {first}, double {low}, 1")

    def parts(self, value: str) -> tuple[str, str]:
        """Return the two doubles whose sum a pair is."""
        kind = self.pair.number.name
        return self.w.let(f"extractvalue {kind} {value}, 0"), self.w.let(f"extractvalue {kind} {value}, 1")

    def combined(self, weights: Sequence[Fraction], values: Sequence[str]) -> str:
        """Return Σ weight · value in pairs of doubles."""
        total = ""
        for weight, value in zip(weights, values, strict=True):
            if weight:
                term = value if weight == 1 else self.pair.algebra("mul", self.pair.constant(weight), value)
                total = self.pair.algebra("add", total, term) if total else term
        return total or self.pair.constant(Fraction(0))

    def read(self, y: str, e: str, index: str | int) -> str:
        """Return a component of the state outside, y + e."""
        low = self.w.load(e, index) if self.compensated else self.w.constant(Fraction(0))
        return self.joined(self.w.load(y, index), low)

    def write(self, value: str, y: str, e: str, index: str | int) -> None:
        """Store a component of a state."""
        high, low = self.parts(value)
        self.w.store(high, y, index)
        if self.compensated:
            self.w.store(low, e, index)

    def body(self, array: str, carried: str, axis: str, lane: int) -> str:
        """Return one body's component of the working state."""
        return self.read(array, carried, self._index(axis, lane))

    def set_body(self, value: str, array: str, carried: str, axis: str, body: int) -> None:
        """Store one body's component, for the last body into the lanes left over too."""
        lanes = [body] if body + 1 < self.count_of_bodies else range(body, self.lanes)
        for lane in lanes:
            self.write(value, array, carried, self._index(axis, lane))

    def _index(self, axis: str, lane: int) -> str:
        return self.w.let(f"add i64 {self.w.let(f'mul i64 {axis}, {self.lanes}')}, {lane}")


class CentresInLanes(_Lanes):
    """Bodies about centres at the origins of their own coordinates, with kicks by a function of q.

    Parameters
    ----------
    w
        Where the loop is written.
    part
        The bodies, and the rest of H.
    compensated
        Whether round-off is carried along.
    """

    def __init__(self, w: Writer, part: Centres, *, compensated: bool) -> None:
        mu = [k / m for k, m in zip(part.attractions, part.masses, strict=True)]
        super().__init__(w, mu, max(map(len, part.bodies)), 0, compensated=compensated)
        self.part = part
        self.degrees = sum(map(len, part.bodies))

    def enter(self, y: str, e: str) -> None:
        """Write places and velocities; axes that a body does not have are 0."""
        none = self.pair.constant(Fraction(0))
        for body, (places, mass) in enumerate(zip(self.part.bodies, self.part.masses, strict=True)):
            for axis in range(self.axes):
                known = axis < len(places)
                place = self.read(y, e, places[axis]) if known else none
                momentum = self.read(y, e, self.degrees + places[axis]) if known else none
                self.set_body(place, self.x, self.ex, str(axis), body)
                self.set_body(self.combined([1 / mass], [momentum]), self.u, self.eu, str(axis), body)

    def leave(self, y: str, e: str) -> None:
        """Write q and p."""
        for body, (places, mass) in enumerate(zip(self.part.bodies, self.part.masses, strict=True)):
            for axis, place in enumerate(places):
                self.write(self.body(self.x, self.ex, str(axis), body), y, e, place)
                velocity = self.body(self.u, self.eu, str(axis), body)
                self.write(self.combined([mass], [velocity]), y, e, self.degrees + place)

    def count(self, steps: str) -> None:
        """Do nothing: all moves with the steps."""

    def kick(self, time: str) -> None:
        """Write the velocities' change −t ∂H₁/∂q / m."""
        w, rest = self.w, self.part.rest
        where = {
            place: (axis * self.lanes + body, body)
            for body, places in enumerate(self.part.bodies)
            for axis, place in enumerate(places)
        }
        arguments = [w.load(self.x, where[i][0]) for i in range(self.degrees)]
        steps = rest.program(rest.force)
        forces = w.program(steps, [*arguments, *["poison"] * (self.degrees + 1)])
        carried = self.eu if self.compensated else ""
        for i, force in enumerate(forces):
            index, body = where[i]
            rate = w.algebra("mul", force, w.constant(1 / self.part.masses[body]))
            last = body + 1 == len(self.part.bodies)
            for lane in range(self.lanes - body if last else 1):
                increase(w, self.u, carried, str(index + lane), time, rate)


class PlanetsInLanes(_Lanes):
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
        self.m, self.part = m, part
        self.total = list(accumulate(m))
        planets = range(1, len(m))
        self.reduced = [m[i] * self.total[i - 1] / self.total[i] for i in planets]
        mu = [sum(k[i][:i]) / reduced for i, reduced in zip(planets, self.reduced, strict=True)]
        axes = len(part.bodies[0])
        super().__init__(w, mu, axes, 4 * axes + 1, compensated=compensated)
        self.degrees = axes * len(m)
        self.centre = [w.at(self.extra, part * axes) for part in range(4)]
        self.steps = w.at(self.extra, 4 * axes)

    def enter(self, y: str, e: str) -> None:
        """Write Jacobi's places and velocities, and those of the centre of mass."""
        bodies = range(len(self.m))
        self.w.store(self.w.constant(Fraction(0)), self.steps, 0)
        with self.w.loop(0, self.axes) as axis:
            places = [self.read(y, e, self._place(j, axis)) for j in bodies]
            momenta = [self.read(y, e, self._momentum(j, axis)) for j in bodies]
            velocities = [self.combined([1 / m], [p]) for m, p in zip(self.m, momenta, strict=True)]
            for values, array, carried, centre in (
                (places, self.x, self.ex, self.centre[:2]),
                (velocities, self.u, self.eu, self.centre[2:]),
            ):
                for i in bodies[1:]:
                    before = [-m / self.total[i - 1] for m in self.m[:i]]
                    value = self.combined([*before, Fraction(1)], values[: i + 1])
                    self.set_body(value, array, carried, axis, i - 1)
                mean = self.parts(self.combined([m / self.total[-1] for m in self.m], values))
                for part, where in zip(mean, centre, strict=True):
                    self.w.store(part, where, axis)

    def _place(self, body: int, axis: str) -> str:
        return self.w.entry(self.part.bodies[body], axis)

    def _momentum(self, body: int, axis: str) -> str:
        return self.w.let(f"add i64 {self._place(body, axis)}, {self.degrees}")

    def leave(self, y: str, e: str) -> None:
        """Write q and p of all bodies."""
        bodies = range(len(self.m))
        elapsed = self.joined(
            self.w.algebra("mul", self.w.load(self.steps, 0), self.w.load("%c", 1)),
            self.w.constant(Fraction(0)),
        )
        with self.w.loop(0, self.axes) as axis:
            place, velocity = (
                self.joined(self.w.load(high, axis), self.w.load(low, axis))
                for high, low in (self.centre[:2], self.centre[2:])
            )
            centre = self.pair.algebra("add", place, self.pair.algebra("mul", elapsed, velocity))
            places = [centre, *(self.body(self.x, self.ex, axis, i) for i in bodies[:-1])]
            velocities = [velocity, *(self.body(self.u, self.eu, axis, i) for i in bodies[:-1])]
            for i in bodies:
                own = [self.total[i - 1] / self.total[i]] if i else []
                after = [-self.m[j] / self.total[j] for j in bodies[i + 1 :]]
                weights = [Fraction(1), *[Fraction(0)] * (max(i, 1) - 1), *own, *after]
                self.write(self.combined(weights, places), y, e, self._place(i, axis))
                speed = self.combined(weights, velocities)
                self.write(self.combined([self.m[i]], [speed]), y, e, self._momentum(i, axis))

    def count(self, steps: str) -> None:
        """Count steps, for the centre of mass."""
        w = self.w
        w.store(w.algebra("add", w.load(self.steps, 0), w.whole(steps)), self.steps, 0)

    def kick(self, time: str) -> None:
        """Write the velocities' change by what H₀ leaves of the attractions.

        With R_i the place from the star, R = C X, and f_i = −∂V/∂R_i the change of V_i is t(Σ_j C_ji f_j/m'_i + µ_i
        X_i/|X_i|³), C_ij = m_j/M_j for 0 < j < i and C_ii = 1.
        """
        v, c, planets = self.v, self.c, range(1, len(self.m))
        x = [v.load(self.x, axis) for axis in range(self.axes)]
        spread = [
            [self.m[j] / self.total[j] if j < i else Fraction(int(i == j)) for j in planets] for i in planets
        ]
        place = [self._product(spread, value) for value in x]
        central = c.numbers(self.filled([-self.part.attractions[0][i] for i in planets]))
        near = c.mul(central, self._inverse_cube(place, c.zero))
        force = [c.mul(near, value) for value in place]
        self._add_pairs(place, force)
        back = [[spread[j - 1][i - 1] / self.reduced[i - 1] for j in planets] for i in planets]
        own = c.mul(self.mu, self._inverse_cube(x, c.zero))
        factor = v.splat(time)
        for axis in range(self.axes):
            rate = c.fma(own, x[axis], self._product(back, force[axis]))
            self.add(self.u, self.eu, axis, factor, rate)

    def _inverse_cube(self, d: Sequence[str], at_least: str) -> str:
        square = self.c.dot(d, d) if at_least == self.c.zero else self.c.add(at_least, self.c.dot(d, d))
        return self.c.div(self.c.one, self.c.mul(square, self.c.sqrt(square)))

    def _product(self, matrix: Sequence[Sequence[Fraction]], value: str) -> str:
        """Write a matrix times the vector over bodies that a register holds."""
        total = ""
        for j in range(len(matrix)):
            column = [row[j] for row in matrix]
            entries = self.c.numbers(self.filled(column))
            part = self._broadcast(value, j)
            total = self.c.fma(entries, part, total) if total else self.c.mul(entries, part)
        return total

    def _broadcast(self, value: str, lane: int) -> str:
        return self._rearranged(value, [lane] * self.lanes)

    def _rearranged(self, value: str, order: Sequence[int]) -> str:
        if self.lanes == 1:
            return value
        kind, mask = self.v.number.name, ", ".join(f"i32 {i}" for i in order)
        return self.v.let(f"shufflevector {kind} {value}, {kind} poison, <{self.lanes} x i32> <{mask}>")

    def _add_pairs(self, place: Sequence[str], force: list[str]) -> None:
        """Add the attractions among planets: each with the one k places on, and the reaction, k = 1 … ⌊n/2⌋."""
        c, n = self.c, self.count_of_bodies
        idle = c.numbers(self.filled([Fraction(0)] * n, Fraction(1)))
        for k in range(1, n // 2 + 1):
            onward = [(i + k) % n if i < n else i for i in range(self.lanes)]
            backward = [(i - k) % n if i < n else i for i in range(self.lanes)]
            strength = [self.part.attractions[i + 1][onward[i] + 1] for i in range(n)]
            d = [c.sub(self._rearranged(value, onward), value) for value in place]
            pull = c.mul(c.numbers(self.filled(strength, Fraction(0))), self._inverse_cube(d, idle))
            for axis in range(self.axes):
                action = c.mul(pull, d[axis])
                force[axis] = c.add(force[axis], action)
                if 2 * k != n:
                    force[axis] = c.sub(force[axis], self._rearranged(action, backward))
