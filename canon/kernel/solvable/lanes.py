"""Positions and velocities of bodies on Kepler orbits, one SIMD lane for each body."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.formulas import LaneFormulas
from canon.kernel.llvm.number_types import DOUBLE, DOUBLE_DOUBLE
from canon.kernel.solvable.kepler_flow import kepler_flow

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.kernel.llvm.writer import Writer
    from canon.kernel.solvable.kepler_flow import KeplerMotion

    Derivative = Callable[[list[str], list[str]], tuple[list[str], list[str]]]
    """What moves a deviation, δx and δv along each axis."""

__all__ = ["BodyLanes", "StepLengths"]

_WIDE = 8


@dataclass(frozen=True)
class StepLengths:
    """How far a kick and the flow after it go: scalar registers.

    Parameters
    ----------
    kick, flow
        The times.
    commutator
        2γτ³ where the kick is by τH₁ + γτ³ {H₁, {H₀, H₁}}; empty where it is by H₁ alone.
    """

    kick: str
    flow: str
    commutator: str = ""


def _lanes(bodies: int) -> int:
    return 1 << (bodies - 1).bit_length() if bodies <= _WIDE else -(-bodies // _WIDE) * _WIDE


class BodyLanes:
    """Places and velocities by axis, each a vector over bodies, and what rounding takes from them.

    Parameters
    ----------
    w
        Where the loop is written, in scalars.
    mu
        The gravitational parameter of each body's orbit.
    axes
        Coordinates of a body.
    extra
        Numbers kept beyond these.
    compensated
        Whether round-off is carried along.
    """

    def __init__(
        self, w: Writer, mu: Sequence[Fraction], axes: int, extra: int, *, compensated: bool
    ) -> None:
        self.w, self.count_of_bodies, self.axes, self.compensated = w, len(mu), axes, compensated
        self.lanes = _lanes(len(mu))
        self.v = w.side_by_side(self.lanes)
        self.c = LaneFormulas(self.v)
        self.pair = w.in_numbers(DOUBLE_DOUBLE)
        self.pair.inlined = w.number.pair
        self.places, self.velocities, self.lost = 0, axes, 2 * axes
        rows = 4 * axes if compensated else 2 * axes
        self.words = rows * self.lanes + extra
        self.state = w.array(self.words)
        self.extra = w.at(self.state, rows * self.lanes)
        self.numbers_beside = 0
        """Numbers of a deviation beside those of the bodies."""
        self.mu = self.c.numbers(self.filled(mu))

    def filled(self, values: Sequence[Fraction], other: Fraction | None = None) -> list[Fraction]:
        """Return a value for each lane; the lanes left over repeat the last body, or have ``other``."""
        return [*values, *[values[-1] if other is None else other] * (self.lanes - len(values))]

    # motion ----------------------------------------------------------------------------------------

    def move(self, times: StepLengths, pair: str) -> None:
        """Write a kick and then Kepler's motion of all bodies; ``pair`` is the number of the two in the tables."""
        del pair
        x, u = self.kicked(self.rows(self.places), self.rows(self.velocities), times)
        self.go_on(x, u, self.motion(x, u, times))

    def motion(self, x: Sequence[str], u: Sequence[str], times: StepLengths) -> KeplerMotion:
        """Return Kepler's motion of all bodies."""
        return kepler_flow(self.w, self.v, x, u, self.mu, self.v.splat(times.flow))

    def go_on(self, x: Sequence[str], u: Sequence[str], motion: KeplerMotion) -> None:
        """Write the places and velocities that a motion comes to."""
        self.increased(self.places, x, self.c.one, motion.moved)
        self.increased(self.velocities, u, self.c.one, motion.turned)

    def kicked(self, x: list[str], u: list[str], times: StepLengths) -> tuple[list[str], list[str]]:
        """Write the flow of H₁ and return places and velocities after it."""
        raise NotImplementedError

    def kick_derivative(self, x: list[str], times: StepLengths) -> Derivative:
        """Return what moves deviations as the flow of H₁ moves the orbit; x are the places after it."""
        raise NotImplementedError

    def enter_deviation(self, outer: str, inner: str) -> None:
        """Write δx and δv along each axis, and what else is kept beside them, from (δq, δp)."""
        raise NotImplementedError

    def leave_deviation(self, inner: str, outer: str, steps: str) -> None:
        """Write (δq, δp) after so many steps."""
        raise NotImplementedError

    def count(self, steps: str) -> None:
        """Write down that so many steps were done: nothing where all moves with the steps."""

    # rows ------------------------------------------------------------------------------------------

    def rows(self, first: int) -> list[str]:
        """Return places, or velocities, along each axis."""
        return [self.row(first + axis) for axis in range(self.axes)]

    def increased(self, first: int, old: Sequence[str], coefficient: str, rates: Sequence[str]) -> list[str]:
        """Write places, or velocities, ← old + coefficient · rate, with what rounding takes, and return them."""
        new = list[str]()
        for axis, (value, rate) in enumerate(zip(old, rates, strict=True)):
            if self.compensated:
                increment = self.c.fma(coefficient, rate, self.row(self.lost + first + axis))
                total, rest = self.c.two_sum(value, increment)
                self.set_row(rest, self.lost + first + axis)
            else:
                total = self.c.fma(coefficient, rate, value)
            self.set_row(total, first + axis)
            new.append(total)
        return new

    def row(self, index: str | int, array: str = "") -> str:
        """Read a vector over bodies, of the state or of another array."""
        address, kind = self._address(index, array), self.w.number
        if kind.pair:
            return self.v.paired(*(self._part.load(self._half(address, k), 0) for k in (0, 1)))
        if kind.scalar == "x86_fp80":  # in memory they lie apart
            return self.gathered([self.w.load(address, lane) for lane in range(self.lanes)])
        return self.v.load(address, 0)

    def set_row(self, value: str, index: str | int, array: str = "") -> None:
        """Write a vector over bodies, of the state or of another array."""
        address, kind = self._address(index, array), self.w.number
        if kind.pair:
            for k in (0, 1):
                part = self.w.let(f"extractvalue {self.v.number.name} {value}, {k}")
                self._part.store(part, self._half(address, k), 0)
        elif kind.scalar == "x86_fp80":
            for lane in range(self.lanes):
                self.w.store(self.v.lane(value, lane), address, lane)
        else:
            self.v.store(value, address, 0)

    def _address(self, index: str | int, array: str) -> str:
        if isinstance(index, int):
            return self.w.at(array or self.state, index * self.lanes)
        return self.w.at(array or self.state, self.w.let(f"mul i64 {index}, {self.lanes}"))

    def _half(self, address: str, part: int) -> str:
        return self.w.in_numbers(DOUBLE).at(address, part * self.lanes)

    @property
    def _part(self) -> Writer:
        return self.v.in_numbers(dataclasses.replace(self.v.number, pair=False))

    def gathered(self, values: Sequence[str]) -> str:
        """Return the vector of some scalars."""
        if self.lanes == 1:
            return values[0]
        if self.w.number.pair:
            kind = self.w.number.name
            halves = ([self.w.let(f"extractvalue {kind} {x}, {k}") for x in values] for k in (0, 1))
            return self.v.paired(*map(self._gathered, halves))
        return self._gathered(values)

    def _gathered(self, values: Sequence[str]) -> str:
        base, scalar, found = self.v.number.base, self.v.number.scalar, "poison"
        for lane, value in enumerate(values):
            found = self.w.let(f"insertelement {base} {found}, {scalar} {value}, i32 {lane}")
        return found

    def rearranged(self, value: str, order: Sequence[int]) -> str:
        """Return the vector whose lane i is lane order[i] of another, where there are several."""
        base, mask = self.v.number.base, ", ".join(f"i32 {i}" for i in order)

        def one(part: str) -> str:
            return self.v.let(f"shufflevector {base} {part}, {base} poison, <{self.lanes} x i32> <{mask}>")

        if not self.v.number.pair:
            return one(value)
        return self.v.paired(
            *(one(self.w.let(f"extractvalue {self.v.number.name} {value}, {k}")) for k in (0, 1))
        )

    def set_deviation(self, values: Sequence[str], index: int | str, inner: str) -> None:
        """Store a deviation of one component of all bodies; the last body's goes into the lanes left over too."""
        self.set_row(self.gathered([*values, *[values[-1]] * (self.lanes - len(values))]), index, inner)

    def deviation(self, index: int | str, inner: str) -> list[str]:
        """Return a deviation of one component of every body."""
        value = self.row(index, inner)
        return [self.v.lane(value, lane) for lane in range(self.count_of_bodies)]

    def summed(self, weights: Sequence[Fraction], values: Sequence[str]) -> str:
        """Return Σ weight · value of scalars."""
        total = self.w.constant(Fraction(0))
        for weight, value in zip(weights, values, strict=True):
            if weight:
                total = self.w.multiply_add(self.w.constant(weight), value, total)
        return total

    # the state outside, in pairs of doubles --------------------------------------------------------

    def read(self, y: str, e: str, index: str | int) -> str:
        """Return a component of the state outside, y + e."""
        lost = self.w.load(e, index) if self.compensated else self.w.constant(Fraction(0))
        return self.wide(self.w.load(y, index), lost)

    def write(self, value: str, y: str, e: str, index: str | int) -> None:
        """Store a component of a state."""
        high, low = self.narrow(value)
        self.w.store(high, y, index)
        if self.compensated:
            self.w.store(low, e, index)

    def wide(self, value: str, lost: str) -> str:
        """Return value + lost in pairs of doubles."""
        if self.w.number == DOUBLE:
            return self.w.paired(value, lost)
        return self.pair.widened(value, self.w.number)

    def narrow(self, value: str) -> tuple[str, str]:
        """Round pairs of doubles to this loop's numbers; in doubles return the rest too, else none."""
        kind = self.w.number
        if kind.pair:
            return value, self.w.constant(Fraction(0))
        parts = [self.w.let(f"extractvalue {self.pair.number.name} {value}, {k}") for k in (0, 1)]
        if kind == DOUBLE:
            return parts[0], parts[1]
        if kind.scalar == "float":
            total = self.w.let(f"fptrunc double {parts[0]} to float")
        else:
            total = self.w.algebra("add", *(self.w.let(f"fpext double {x} to {kind.name}") for x in parts))
        return total, self.w.constant(Fraction(0))

    def combined(self, weights: Sequence[Fraction], values: Sequence[str]) -> str:
        """Return Σ weight · value in pairs of doubles."""
        total = ""
        for weight, value in zip(weights, values, strict=True):
            if weight:
                term = value if weight == 1 else self.pair.algebra("mul", self.pair.constant(weight), value)
                total = self.pair.algebra("add", total, term) if total else term
        return total or self.pair.constant(Fraction(0))

    def set_bodies(self, values: Sequence[str], index: str) -> None:
        """Store one component of all bodies; the last body's goes into the lanes left over too."""
        narrow = [self.narrow(value) for value in values]
        narrow += [narrow[-1]] * (self.lanes - len(narrow))
        self.set_row(self.gathered([high for high, _ in narrow]), index)
        if self.compensated:
            row = self.w.let(f"add i64 {index}, {self.lost}")
            self.set_row(self.gathered([low for _, low in narrow]), row)

    def bodies(self, index: str) -> list[str]:
        """Return one component of every body, in pairs of doubles."""
        value = self.row(index)
        rest = self.row(self.w.let(f"add i64 {index}, {self.lost}")) if self.compensated else ""
        none = self.w.constant(Fraction(0))
        return [
            self.wide(self.v.lane(value, lane), self.v.lane(rest, lane) if rest else none)
            for lane in range(self.count_of_bodies)
        ]
