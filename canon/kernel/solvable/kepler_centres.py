"""Kepler motion of bodies about fixed centres, with kicks by any function of the coordinates."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.program.commutator import commutator_force
from canon.kernel.solvable.lanes import BodyLanes, StepLengths

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.llvm.writer import Writer
    from canon.kernel.solvable.solvable_parts import Centres

__all__ = ["CentresInLanes"]


class CentresInLanes(BodyLanes):
    """Kepler's motion of bodies about fixed centres, and kicks by H₁(q).

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
        for axis in range(self.axes):
            places, velocities = list[str](), list[str]()
            for own, mass in zip(self.part.bodies, self.part.masses, strict=True):
                known = axis < len(own)
                momentum = self.read(y, e, self.degrees + own[axis]) if known else none
                places.append(self.read(y, e, own[axis]) if known else none)
                velocities.append(self.combined([1 / mass], [momentum]))
            self.set_bodies(places, str(self.places + axis))
            self.set_bodies(velocities, str(self.velocities + axis))

    def leave(self, y: str, e: str) -> None:
        """Write q and p."""
        for axis in range(self.axes):
            places, velocities = (self.bodies(str(first + axis)) for first in (self.places, self.velocities))
            for body, (own, mass) in enumerate(zip(self.part.bodies, self.part.masses, strict=True)):
                if axis < len(own):
                    self.write(places[body], y, e, own[axis])
                    self.write(self.combined([mass], [velocities[body]]), y, e, self.degrees + own[axis])

    def kicked(self, x: list[str], u: list[str], times: StepLengths) -> tuple[list[str], list[str]]:
        """Write v ← v − t ∂H₁/∂q / m, and with a commutator + 2γτ³ ∂(Σ (∂H₁/∂q)²/2m)/∂q / m."""
        rest, inverse = self.part.rest, list[Fraction]([Fraction(0)] * self.degrees)
        for own, mass in zip(self.part.bodies, self.part.masses, strict=True):
            for place in own:
                inverse[place] = 1 / mass
        if not times.commutator:
            return x, self.increased(
                self.velocities, u, self.v.splat(times.kick), self._rates(x, rest.force, inverse)
            )
        diagonal = [
            [a if i == j else Fraction(0) for j in range(self.degrees)] for i, a in enumerate(inverse)
        ]
        first, second = (
            self._rates(x, nodes, inverse) for nodes in (rest.force, commutator_force(rest, diagonal))
        )
        kick, more = self.v.splat(times.kick), self.v.splat(times.commutator)
        change = [self.c.fma(more, b, self.c.mul(kick, a)) for a, b in zip(first, second, strict=True)]
        return x, self.increased(self.velocities, u, self.c.one, change)

    def _rates(self, x: Sequence[str], nodes: Sequence[int], inverse: Sequence[Fraction]) -> list[str]:
        """Return f/m for the nodes f of a force on each coordinate, 0 for axes that a body does not have."""
        w, rest = self.w, self.part.rest
        arguments = ["poison"] * (2 * self.degrees + 1)
        for body, own in enumerate(self.part.bodies):
            for axis, place in enumerate(own):
                arguments[place] = self.v.lane(x[axis], body)
        forces = w.program(rest.program(nodes), arguments)
        none, rows = w.constant(Fraction(0)), list[str]()
        for axis in range(self.axes):
            row = [
                w.algebra("mul", forces[own[axis]], w.constant(inverse[own[axis]]))
                if axis < len(own)
                else none
                for own in self.part.bodies
            ]
            # The lanes left over move on plain orbits.
            rows.append(self.gathered([*row, *[none] * (self.lanes - len(row))]))
        return rows
