"""The cycle of each separated coordinate: libration, rotation or ignorable, and the integrals over it."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, cast

import sympy as sp
from flint import acb, arb
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.integrable.ball_function import BallFunction
from canon.mechanics.integrable.cycle_quadrature import Libration, integral_along
from canon.mechanics.integrable.kinked_libration import KinkedLibration, kinked_libration
from canon.mechanics.integrable.turning_points import (
    NoCycleError,
    real_value,
    turning_point,
    turning_point_at,
)
from canon.proof.domain.balls import value
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Mapping

    from canon.mechanics.integrable.separated_momenta import SeparatedMomentum

__all__ = ["Cycle", "CycleIntegrals", "CycleKind", "ball_of", "cycle_of"]


def ball_of(number: Expr) -> acb:
    """Return a ball that holds an exact number, at the precision of the moment."""
    return value(number, {})


class CycleKind(Enum):
    """How a coordinate comes back to where it was."""

    LIBRATION = "libration"
    ROTATION = "rotation"
    IGNORABLE = "ignorable"


@dataclass(frozen=True)
class Cycle:
    """The cycle of one coordinate: what it is, and between which turning points or over which period.

    Parameters
    ----------
    q
        The coordinate.
    kind
        Libration, rotation, or that of an ignorable coordinate, whose momentum is constant.
    turning_points
        Both ends of a libration, balls that hold them.
    period
        The period of a rotating or ignorable coordinate.
    sign
        The sign of the momentum of a rotation.
    """

    q: Symbol
    kind: CycleKind
    turning_points: tuple[arb, arb] | None = None
    period: Expr | None = None
    sign: int = 1


@dataclass(frozen=True)
class CycleIntegrals:
    """Certified integrals of one momentum, and of its derivatives by the constants, over its cycle.

    Parameters
    ----------
    momentum
        The momentum.
    cycle
        Its cycle.
    balls
        The values of all parameters and constants.
    """

    momentum: SeparatedMomentum
    cycle: Cycle
    balls: Mapping[Symbol, acb] = field(repr=False)

    @cached_property
    def libration(self) -> Libration | KinkedLibration:
        """The cycle between both turning points."""
        q, (low, high) = self.momentum.q, cast("tuple[arb, arb]", self.cycle.turning_points)
        kinked = kinked_libration(self._square, q, self.balls, (low, high))
        return kinked or Libration(*_functions(self._square, q, self.balls), low, high, str(q))

    @property
    def _square(self) -> Expr:
        return cast("Expr", self.momentum.square)

    def whole(self, constant: Symbol | None = None) -> arb:
        """Return (1/2π) ∮ p dq, or its derivative by a constant."""
        if self.cycle.kind is CycleKind.LIBRATION:
            return self._of_root(constant, None) / arb.pi()
        period = ball_of(cast("Expr", self.cycle.period)).real
        if self.cycle.kind is CycleKind.ROTATION:
            return self._of_rotation(constant, period) / (2 * arb.pi())
        return self._of_constant(constant, period) / (2 * arb.pi())

    def up_to(self, constant: Symbol, place: Expr, outward: arb) -> arb:
        """Return ∂/∂α of ∫ p dq from the beginning of the cycle to a place.

        Parameters
        ----------
        constant
            α.
        place
            The coordinate.
        outward
            The momentum there less its shift, whose sign tells both ways of a libration apart.

        Raises
        ------
        ValueError
            Where the place is outside the turning points.
        """
        here = ball_of(place).real
        if self.cycle.kind is CycleKind.IGNORABLE:
            return self._of_constant(constant, here)
        if self.cycle.kind is CycleKind.ROTATION:
            return self._of_rotation(constant, here)
        q, (low, high) = self.momentum.q, cast("tuple[arb, arb]", self.cycle.turning_points)
        if not (here > low or here.overlaps(low)) or not (here < high or here.overlaps(high)):
            raise ValueError(
                f"{q} = {float(here):.12g} is outside its turning points {float(low):.12g} and {float(high):.12g}"
            )
        shift = self.momentum.shift.diff(constant)
        moved = arb(0)
        if shift != 0:
            moved = integral_along(BallFunction(shift, q, self.balls), [acb(low), acb(here)]).real
        if here.overlaps(low):
            return moved
        whole = self._of_root(constant, None)
        if here.overlaps(high):
            return moved + whole
        way = self._of_root(constant, here)
        return moved + (way if outward > 0 else 2 * whole - way)

    def _of_constant(self, constant: Symbol | None, length: arb) -> arb:
        """Return the integral of a constant momentum, or of its derivative, over a length."""
        f = self.momentum.shift if constant is None else self.momentum.shift.diff(constant)
        return length * BallFunction(f, self.momentum.q, self.balls)(acb(0)).real

    def _of_root(self, constant: Symbol | None, end: arb | None) -> arb:
        """Return the integral of √(p²), or of its derivative, from the lower turning point."""
        power, f = (1, sp.S.One) if constant is None else (-1, self._square.diff(constant) / 2)
        if f == 0:
            return arb(0)
        if isinstance(self.libration, KinkedLibration):
            return self.libration.integral(f, power, end)
        return self.libration.integral(BallFunction(f, self.momentum.q, self.balls), power, end)

    def _of_rotation(self, constant: Symbol | None, end: arb) -> arb:
        """Return the integral of p, or of its derivative by a constant, where it has no zero, from q = 0."""
        p = self.momentum.value(self.cycle.sign)
        f = BallFunction(p if constant is None else p.diff(constant), self.momentum.q, self.balls)
        total = integral_along(f, [acb(0), acb(end)])
        if not total.is_finite():
            raise NoCycleError(
                f"the integral over the rotation of {self.momentum.q} did not converge; ask for more digits"
            )
        return total.real


def cycle_of(
    momentum: SeparatedMomentum,
    values: Mapping[Symbol, Expr],
    balls: Mapping[Symbol, acb],
    periods: Mapping[Symbol, Expr],
) -> Cycle:
    """Return the cycle of one coordinate: follow p² from the start to where it vanishes, or through a period."""
    q = momentum.q
    if q in periods:
        _check_period(momentum, values, periods[q])
    if momentum.square is None:
        if not momentum.shift.has(q):
            return Cycle(q, CycleKind.IGNORABLE, period=periods.get(q, 2 * sp.pi))
        turn = periods.get(q) or _period(momentum)
        if turn is None:
            raise NoCycleError(
                f"{momentum.p} is no constant and has one value only: {q} runs through no cycle"
            )
        return Cycle(
            q, CycleKind.ROTATION, period=turn, sign=1 if ball_of(values[momentum.p]).real > 0 else -1
        )
    square, slope = _functions(momentum.square, q, balls)
    place, outward = ball_of(values[q]).real, values[momentum.p] - substitute(momentum.shift, values)
    if outward == 0 or outward.is_zero:
        direction = turning_point_at(slope, place, str(q))
        inside = _beside(square, slope, place, direction, str(q))
        other = cast("arb", turning_point(square, slope, inside, direction, None, str(q)))
        return Cycle(q, CycleKind.LIBRATION, (place, other) if direction > 0 else (other, place))
    period = periods.get(q) or _period(momentum)
    reach = None if period is None else place + ball_of(period).real
    high = turning_point(square, slope, place, 1, reach, str(q))
    if high is None:
        sign = 1 if ball_of(outward).real > 0 else -1
        return Cycle(q, CycleKind.ROTATION, period=period, sign=sign)
    low = cast("arb", turning_point(square, slope, place, -1, None, str(q)))
    return Cycle(q, CycleKind.LIBRATION, (low, high))


def _beside(square: BallFunction, slope: BallFunction, place: arb, direction: int, name: str) -> arb:
    """Return a place inside a libration beside its turning point, with no other zero of p² between them."""
    step = arb(max(1.0, abs(float(place))) / 64)
    for _ in range(64):
        inside = (place + direction * step).mid()
        if direction * real_value(slope, place.union(inside)) > 0 and real_value(square, inside) > 0:
            return inside
        step = (step / 2).mid()
    raise NoCycleError(f"{name} is at rest too near to an equilibrium or a separatrix; change the start")


def _functions(square: Expr, q: Symbol, balls: Mapping[Symbol, acb]) -> tuple[BallFunction, BallFunction]:
    return BallFunction(square, q, balls), BallFunction(square.diff(q), q, balls)


def _check_period(momentum: SeparatedMomentum, values: Mapping[Symbol, Expr], period: Expr) -> None:
    """Refuse a period that the momentum is proved not to have on this motion."""
    q = momentum.q
    others = {s: v for s, v in values.items() if s != q}
    parts = [substitute(f, others) for f in (momentum.square, momentum.shift) if f is not None and f.has(q)]
    moved = sp.Matrix([substitute(f, {q: q + period}) - f for f in parts])
    if parts and vanishes(moved, budget=2.0).fails:
        raise NoCycleError(
            f"the momentum of {q} has not the period {period} that was given; leave it out for an angle, or write the "
            "period exactly, as 2*pi"
        )


def _period(momentum: SeparatedMomentum) -> Expr | None:
    """Return 2π where p² and the shift are proved to have that period in an angle, or are constant."""
    q, parts = momentum.q, [f for f in (momentum.square, momentum.shift) if f is not None]
    if not any(f.has(q) for f in parts):
        return 2 * sp.pi
    if not any(f.has(sp.sin, sp.cos, sp.tan, sp.cot, sp.sec, sp.csc) for f in parts):
        return None
    turned = {q: q + 2 * sp.pi}
    both = sp.Matrix([substitute(f, turned) - f for f in parts])
    return 2 * sp.pi if vanishes(both, budget=2.0).holds else None
