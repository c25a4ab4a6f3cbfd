"""Kepler motion of bodies about fixed centres, with kicks by any function of the coordinates."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from canon.cached_property import cached_property
from canon.kernel.program.commutator import commutator_force
from canon.kernel.program.slopes import slopes
from canon.kernel.solvable.lanes import BodyLanes, StepLengths

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.llvm.writer import Writer
    from canon.kernel.program.slopes import Slopes
    from canon.kernel.solvable.lanes import Derivative
    from canon.kernel.solvable.solvable_parts import Centres

__all__ = ["CentresInLanes"]


class CentresInLanes(BodyLanes):
    """Kepler's motion of bodies about fixed centres, and kicks by H₁(q).

    Parameters
    ----------
    w
        Where the loop is written.
    part
        The bodies, of as many coordinates each, and the rest of H.
    compensated
        Whether round-off is carried along.
    """

    def __init__(self, w: Writer, part: Centres, *, compensated: bool) -> None:
        mu = [k / m for k, m in zip(part.attractions, part.masses, strict=True)]
        super().__init__(w, mu, len(part.bodies[0]), 0, compensated=compensated)
        self.part = part
        self.degrees = sum(map(len, part.bodies))

    def enter(self, y: str, e: str) -> None:
        """Write places and velocities."""
        for axis in range(self.axes):
            places, velocities = list[str](), list[str]()
            for own, mass in zip(self.part.bodies, self.part.masses, strict=True):
                places.append(self.read(y, e, own[axis]))
                velocities.append(self.combined([1 / mass], [self.read(y, e, self.degrees + own[axis])]))
            self.set_bodies(places, str(self.places + axis))
            self.set_bodies(velocities, str(self.velocities + axis))

    def leave(self, y: str, e: str) -> None:
        """Write q and p."""
        for axis in range(self.axes):
            places, velocities = (self.bodies(str(first + axis)) for first in (self.places, self.velocities))
            for body, (own, mass) in enumerate(zip(self.part.bodies, self.part.masses, strict=True)):
                self.write(places[body], y, e, own[axis])
                self.write(self.combined([mass], [velocities[body]]), y, e, self.degrees + own[axis])

    def kicked(self, x: list[str], u: list[str], times: StepLengths) -> tuple[list[str], list[str]]:
        """Write v ← v − t ∂H₁/∂q / m, and with a commutator + 2γτ³ ∂(Σ (∂H₁/∂q)²/2m)/∂q / m."""
        rest, inverse = self.part.rest, self._inverse_masses
        if not times.commutator:
            return x, self.increased(
                self.velocities, u, self.v.splat(times.kick), self._rates(x, rest.force, inverse)
            )
        first, second = (self._rates(x, nodes, inverse) for nodes in (rest.force, self._commutator_force))
        kick, more = self.v.splat(times.kick), self.v.splat(times.commutator)
        change = [self.c.fma(more, b, self.c.mul(kick, a)) for a, b in zip(first, second, strict=True)]
        return x, self.increased(self.velocities, u, self.c.one, change)

    def kick_derivative(self, x: list[str], times: StepLengths) -> Derivative:
        """Return what moves deviations as the kick that found the bodies at x moves the orbit."""
        rest, inverse, kicks = self.part.rest, self._inverse_masses, [(times.kick, self.part.rest.force)]
        if times.commutator:
            kicks.append((times.commutator, self._commutator_force))
        found: list[tuple[str, Slopes, dict[int, str]]] = []
        for time, force in kicks:
            matrix = slopes(rest.graph, force, rest.q, symmetric=True)
            nodes = list(dict.fromkeys(node for row in matrix.rows for _, node in row))
            found.append((time, matrix, dict(zip(nodes, self._evaluated(x, nodes), strict=True))))

        def moved(dx: list[str], du: list[str]) -> tuple[list[str], list[str]]:
            w, change = self.w, [self.w.constant(Fraction(0))] * self.degrees
            places = self._by_coordinate(dx)
            for time, matrix, entries in found:
                for i, row in enumerate(matrix.rows):
                    total = w.constant(Fraction(0))
                    for j, node in row:
                        total = w.multiply_add(entries[node], places[j], total)
                    change[i] = w.multiply_add(time, total, change[i])
            return dx, [self.c.add(a, b) for a, b in zip(du, self._by_axis(change, inverse), strict=True)]

        return moved

    # deviations ------------------------------------------------------------------------------------

    def enter_deviation(self, outer: str, inner: str) -> None:
        """Write δx and δv along each axis."""
        for axis in range(self.axes):
            places, velocities = list[str](), list[str]()
            for own, mass in zip(self.part.bodies, self.part.masses, strict=True):
                places.append(self.w.load(outer, own[axis]))
                velocities.append(self.summed([1 / mass], [self.w.load(outer, self.degrees + own[axis])]))
            self.set_deviation(places, axis, inner)
            self.set_deviation(velocities, self.axes + axis, inner)

    def leave_deviation(self, inner: str, outer: str, steps: str) -> None:
        """Write (δq, δp)."""
        del steps
        for axis in range(self.axes):
            places, velocities = (self.deviation(first + axis, inner) for first in (0, self.axes))
            for body, (own, mass) in enumerate(zip(self.part.bodies, self.part.masses, strict=True)):
                self.w.store(places[body], outer, own[axis])
                self.w.store(self.summed([mass], [velocities[body]]), outer, self.degrees + own[axis])

    # forces ----------------------------------------------------------------------------------------

    @cached_property
    def _inverse_masses(self) -> list[Fraction]:
        """1/m for each coordinate."""
        inverse = [Fraction(0)] * self.degrees
        for own, mass in zip(self.part.bodies, self.part.masses, strict=True):
            for place in own:
                inverse[place] = 1 / mass
        return inverse

    @cached_property
    def _commutator_force(self) -> tuple[int, ...]:
        diagonal = [
            [a if i == j else Fraction(0) for j in range(self.degrees)]
            for i, a in enumerate(self._inverse_masses)
        ]
        return commutator_force(self.part.rest, diagonal)

    def _rates(self, x: Sequence[str], nodes: Sequence[int], inverse: Sequence[Fraction]) -> list[str]:
        """Return f/m for the nodes f of a force on each coordinate."""
        return self._by_axis(self._evaluated(x, nodes), inverse)

    def _evaluated(self, x: Sequence[str], nodes: Sequence[int]) -> list[str]:
        rest = self.part.rest
        arguments = [*self._by_coordinate(x), *["poison"] * (self.degrees + 1)]
        return self.w.program(rest.program(nodes), arguments)

    def _by_coordinate(self, rows: Sequence[str]) -> list[str]:
        """Return the scalars of vectors over bodies, in the order of the coordinates."""
        found = ["poison"] * self.degrees
        for body, own in enumerate(self.part.bodies):
            for axis, place in enumerate(own):
                found[place] = self.v.lane(rows[axis], body)
        return found

    def _by_axis(self, forces: Sequence[str], inverse: Sequence[Fraction]) -> list[str]:
        """Return f/m as vectors over bodies."""
        w = self.w
        none, rows = w.constant(Fraction(0)), list[str]()
        for axis in range(self.axes):
            row = [
                w.algebra("mul", forces[own[axis]], w.constant(inverse[own[axis]]))
                for own in self.part.bodies
            ]
            # The lanes left over move on plain orbits.
            rows.append(self.gathered([*row, *[none] * (self.lanes - len(row))]))
        return rows
