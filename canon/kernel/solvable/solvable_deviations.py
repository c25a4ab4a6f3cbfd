"""Deviations beside motions by solvable parts, moved by the exact derivative of every flow and kick.

Those from bodies on Kepler orbits are moved in the bodies' own lanes and coordinates, and are put into these and taken
out of them, which is linear, in every call. The orbit is written as it is without deviations, so that it is the same
bit for bit; what its flows and their derivatives have in common is computed once where the compiler finds it.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.program.commutator import commutator_force
from canon.kernel.program.slopes import slopes
from canon.kernel.solvable.kepler_derivative import KeplerDerivative

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.kernel.program.slopes import Slopes
    from canon.kernel.solvable.lanes import BodyLanes, StepLengths
    from canon.kernel.solvable.linear_motion import LinearMotion

__all__ = ["BodyDeviations", "LinearDeviations"]


class BodyDeviations:
    """Deviations from bodies on Kepler orbits.

    Parameters
    ----------
    orbit
        The bodies.
    size
        Components of a deviation outside, δq then δp.
    vectors
        How many.
    """

    def __init__(self, orbit: BodyLanes, size: int, vectors: int) -> None:
        self.orbit, self.size, self.vectors = orbit, size, vectors
        self.each = 2 * orbit.axes * orbit.lanes + orbit.numbers_beside
        self.words = vectors * self.each

    def enter(self, outer: str, inner: str) -> None:
        """Write the deviations as they are moved, ``inner``, from those of (q, p), one after the other."""
        self.inner = inner
        for own, deviation in self._vectors(outer):
            self.orbit.enter_deviation(deviation, own)

    def leave(self, outer: str, steps: str) -> None:
        """Write the deviations of (q, p) after so many steps."""
        for own, deviation in self._vectors(outer):
            self.orbit.leave_deviation(own, deviation, steps)

    def move(self, times: StepLengths, pair: str) -> None:
        """Write a kick and then Kepler's motion, of the orbit and of its deviations."""
        del pair
        orbit = self.orbit
        x, u = orbit.kicked(orbit.rows(orbit.places), orbit.rows(orbit.velocities), times)
        motion = orbit.motion(x, u, times)
        kicked, flown = orbit.kick_derivative(x, times), KeplerDerivative(orbit.c, x, u, motion)
        orbit.go_on(x, u, motion)
        axes = range(orbit.axes)
        for own, _ in self._vectors(""):
            dx, du = ([orbit.row(first + axis, own) for axis in axes] for first in (0, orbit.axes))
            for index, value in enumerate(value for half in flown.moved(*kicked(dx, du)) for value in half):
                orbit.set_row(value, index, own)

    def _vectors(self, outer: str) -> Iterator[tuple[str, str]]:
        """Repeat what follows for every deviation, as it is moved and as it is outside."""
        w = self.orbit.w
        with w.loop(0, self.vectors) as g:
            own = w.at(self.inner, w.let(f"mul i64 {g}, {self.each}"))
            yield own, w.at(outer, w.let(f"mul i64 {g}, {self.size}")) if outer else ""


class LinearDeviations:
    """Deviations from the motion of a quadratic H₀ with kicks.

    Parameters
    ----------
    orbit
        The motion.
    vectors
        How many.
    """

    words = 0

    def __init__(self, orbit: LinearMotion, vectors: int) -> None:
        self.orbit, self.vectors, self.size = orbit, vectors, orbit.size
        self.moved = orbit.w.array(orbit.size)
        rest = orbit.part.rest
        self.of_kick = slopes(rest.graph, rest.force, rest.q, symmetric=True)
        self.of_commutator = slopes(
            rest.graph, commutator_force(rest, orbit.inverse_mass), rest.q, symmetric=True
        )

    def enter(self, outer: str, inner: str) -> None:
        """Take the deviations of (q, p), which are moved where they are."""
        del inner
        self.outer = outer

    def leave(self, outer: str, steps: str) -> None:
        """Do nothing: they are where they were."""

    def move(self, times: StepLengths, pair: str) -> None:
        """Write a kick and then the flow of H₀, of the orbit and of its deviations."""
        w = self.orbit.w
        kicks = [(times.kick, self.of_kick, self._entries(self.of_kick))]
        if times.commutator:
            kicks.append((times.commutator, self.of_commutator, self._entries(self.of_commutator)))
        self.orbit.move(times, pair)
        with w.loop(0, self.vectors) as g:
            own = w.at(self.outer, w.let(f"mul i64 {g}, {self.size}"))
            for time, matrix, entries in kicks:
                self._kick(own, time, matrix, entries)
            self._flow(own, pair)

    def _entries(self, matrix: Slopes) -> dict[int, str]:
        """Write the entries of a matrix at the orbit's place."""
        w, rest = self.orbit.w, self.orbit.part.rest
        nodes, n = list(dict.fromkeys(node for row in matrix.rows for _, node in row)), self.size // 2
        arguments = [*(w.load(self.orbit.state, i) for i in range(n)), *["poison"] * (n + 1)]
        return dict(zip(nodes, w.program(rest.program(nodes), arguments), strict=True))

    def _kick(self, own: str, time: str, matrix: Slopes, entries: dict[int, str]) -> None:
        """Write δp ← δp + time · slopes · δq."""
        w, n = self.orbit.w, self.size // 2
        for i, row in enumerate(matrix.rows):
            if row:
                total = w.constant(Fraction(0))
                for j, node in row:
                    total = w.multiply_add(entries[node], w.load(own, j), total)
                w.store(w.multiply_add(time, total, w.load(own, n + i)), own, n + i)

    def _flow(self, own: str, pair: str) -> None:
        """Write δ ← δ + (exp(tL) − 1) δ, column by column."""
        w, n = self.orbit.w, self.size
        main, lost = self.orbit.flow_matrix(pair)
        with w.loop(0, n) as i:
            w.store(w.constant(Fraction(0)), self.moved, i)
        with w.loop(0, n) as j:
            column, number = w.let(f"mul i64 {j}, {n}"), w.load(own, j)
            high, low = w.at(main, column), w.at(lost, column)
            with w.loop(0, n) as i:
                small = w.multiply_add(w.load(low, i), number, w.load(self.moved, i))
                w.store(w.multiply_add(w.load(high, i), number, small), self.moved, i)
        with w.loop(0, n) as i:
            w.store(w.algebra("add", w.load(own, i), w.load(self.moved, i)), own, i)
