"""Attractions of planets in SIMD lanes: each by its star and by one another, and how they change where places do."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.kernel.solvable.lanes import BodyLanes
    from canon.kernel.solvable.solvable_parts import Matrix

    Action = Callable[["Pull", int], list[str]]
    """What a pull does, by its number: along each axis a vector over planets."""

__all__ = ["PlanetAttractions", "Pull"]


@dataclass(frozen=True)
class Pull:
    """Attractions F(d) = k d/|d|³ along vectors d: registers k/|d|³ and −3/|d|²."""

    d: Sequence[str]
    strength: str
    turn: str


@dataclass(frozen=True, eq=False)
class PlanetAttractions:
    """Writes attractions.

    Parameters
    ----------
    lanes
        The planets.
    strengths
        k_ij of all bodies, the star first.
    """

    lanes: BodyLanes
    strengths: Matrix

    def pull(self, strength: Sequence[Fraction], d: Sequence[str], idle: Sequence[Fraction] = ()) -> Pull:
        """Return attractions; ``idle`` is added to |d|², so that lanes left over have a distance."""
        c = self.lanes.c
        square = c.numbers(idle) if idle else ""
        for value in d:
            square = c.fma(value, value, square) if square else c.mul(value, value)
        # The root and the quotient at once, rather than one after the other.
        part = c.div(c.numbers(self.lanes.filled(strength, Fraction(0))), c.mul(square, square))
        return Pull(d, c.mul(c.sqrt(square), part), c.div(c.number(Fraction(-3)), square))

    def pulled(self, pull: Pull) -> list[str]:
        """Return F(d)."""
        return [self.lanes.c.mul(pull.strength, d) for d in pull.d]

    def changed(self, pull: Pull, along: Sequence[str]) -> list[str]:
        """Return F′(d) a, where d changes by a."""
        c = self.lanes.c
        turn = c.mul(pull.turn, c.dot(pull.d, along))
        return [c.mul(pull.strength, c.fma(turn, d, a)) for d, a in zip(pull.d, along, strict=True)]

    def bent(self, pull: Pull, first: Sequence[str], second: Sequence[str]) -> list[str]:
        """Return F″(d)[a, b] = −3k/|d|⁵ ((d·a) b + (d·b) a + (a·b) d − 5 (d·a)(d·b) d/|d|²)."""
        c = self.lanes.c
        one, other = c.dot(pull.d, first), c.dot(pull.d, second)
        steep = c.mul(c.number(Fraction(5, 3)), c.mul(pull.turn, c.mul(one, other)))
        own, scale = c.add(c.dot(first, second), steep), c.mul(pull.strength, pull.turn)
        return [
            c.mul(scale, c.fma(own, d, c.fma(one, b, c.mul(other, a))))
            for d, a, b in zip(pull.d, first, second, strict=True)
        ]

    # pairs of planets ------------------------------------------------------------------------------

    def pairs(self, place: Sequence[str]) -> list[Pull]:
        """Return the attractions among planets: each by the one k places on, k = 1 … ⌊n/2⌋."""
        lanes, n = self.lanes, self.lanes.count_of_bodies
        idle, pulls = lanes.filled([Fraction(0)] * n, Fraction(1)), list[Pull]()
        for k in range(1, n // 2 + 1):
            onward = self._turn(k)
            strength = [self.strengths[i + 1][onward[i] + 1] for i in range(n)]
            pulls.append(self.pull(strength, self.differences(place, k), idle if lanes.lanes > n else ()))
        return pulls

    def differences(self, place: Sequence[str], k: int) -> list[str]:
        """Return how far the planets k places on are from each."""
        return [self.lanes.c.sub(self.lanes.rearranged(value, self._turn(k)), value) for value in place]

    def added(self, pulls: Sequence[Pull], force: Sequence[str], action: Action) -> list[str]:
        """Add to forces, "" for none, what pulls among planets do, and their reactions."""
        total, c, n = list(force), self.lanes.c, self.lanes.count_of_bodies
        for k, pull in enumerate(pulls, start=1):
            for axis, each in enumerate(action(pull, k)):
                total[axis] = c.add(total[axis], each) if total[axis] else each
                if 2 * k != n:
                    total[axis] = c.sub(total[axis], self.lanes.rearranged(each, self._turn(-k)))
        return total

    def add_pulls(self, pulls: Sequence[Pull], force: Sequence[str]) -> list[str]:
        """Add attractions among planets to forces."""
        return self.added(pulls, force, lambda pull, _: self.pulled(pull))

    def add_changes(self, pulls: Sequence[Pull], force: Sequence[str], place: Sequence[str]) -> list[str]:
        """Add to changes of forces those of attractions among planets whose places change."""
        return self.added(pulls, force, lambda pull, k: self.changed(pull, self.differences(place, k)))

    def add_bends(
        self, pulls: Sequence[Pull], force: Sequence[str], first: Sequence[str], second: Sequence[str]
    ) -> list[str]:
        """Add to second derivatives of forces those of attractions among planets."""

        def bent(pull: Pull, k: int) -> list[str]:
            return self.bent(pull, self.differences(first, k), self.differences(second, k))

        return self.added(pulls, force, bent)

    def _turn(self, by: int) -> list[int]:
        """Return the order of lanes in which each planet's place is taken by the one ``by`` places on."""
        n = self.lanes.count_of_bodies
        return [(i + by) % n if i < n else i for i in range(self.lanes.lanes)]
