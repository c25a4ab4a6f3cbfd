"""Certified integrals over one cycle of a separated coordinate.

Between turning points a < b the root is written √(p²) = √(q − a) √(b − q) √R, where R is holomorphic and not zero about
[a, b]. The integral of f(q) (p²)^(±1/2) from a to b is then the real part of the integral along a path in the upper
half plane, from a − d over a − d + i d and b + d + i d to b + d: outside [a, b] the root is imaginary. The square-root
ends are never touched. Where a is a wall, at which p² > 0, the path begins at a itself. That p² is holomorphic in the
rectangle and has no zeros there but a and b is proved by balls and by the argument principle; integrals are Arb's
 (doi:10.1007/978-3-319-96418-8_30), with rigorous bounds.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING

from flint import acb, arb, ctx

from canon.mechanics.integrable.turning_points import NoCycleError
from canon.proof.domain.balls import precision

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from canon.mechanics.integrable.ball_function import BallFunction

__all__ = ["Libration", "integral_along"]

MOST_HALVINGS = 30
"""How often the width of the rectangle is halved; its smallest is 2^−30 of the interval."""
COARSE_GOAL = 2.0**-14
"""The tolerance of its integral: far less than half of π, so that one integer is left."""
MOST_WIDTHS = 4
"""Rectangles in which the integral is tried before it is given up."""
DEEPEST = 7
"""How often boxes are halved in the proof that p² is holomorphic."""
CUT_DEPTH = 40
"""How often a path is halved in the proof that √R is one function along it."""
COARSE_BITS = 64
"""The precision of the argument principle, whose value is an integer."""
SPARE_BITS = 32
"""Bits of the working precision that integrals need not reach."""
EVALUATIONS = 200_000
COARSE_EVALUATIONS = 4_000
"""Those of an integral that only counts zeros: of one that takes more, a zero lies near the path; another is taken."""


_I, _MINUS_I = acb(0, 1), acb(0, -1)


@dataclass(frozen=True)
class Libration:
    """The cycle between two turning points, and the rectangle about it in which p² is under control.

    Parameters
    ----------
    square, slope
        p² and its derivative.
    low, high
        The turning points.
    name
        The coordinate, for messages.
    wall
        Whether the lower end is no turning point: p² is positive there, and the path begins at it.
    proved
        The widths of rectangles that were looked at, and whether they will do.
    """

    square: BallFunction
    slope: BallFunction
    low: arb
    high: arb
    name: str
    wall: bool = False
    proved: dict[float, bool] = field(default_factory=dict[float, bool], compare=False, repr=False)

    def root(self, q: acb, analytic: bool = False) -> acb:
        """Return √(p²) in the upper half plane, positive on the upper side of the interval.

        √R is not finite on a ball that meets the cut, whether Arb asks for a holomorphic function or for bounds only:
        Arb integrates over a jump, and beyond the cut the other root would be taken.
        """
        left, right = q - self.low, self.high - q
        rest = self._rest(q, analytic).sqrt(analytic=True)
        low = _MINUS_I.sqrt() if self.wall else (_MINUS_I * left).sqrt(analytic=analytic)
        return low * (_I * right).sqrt(analytic=analytic) * rest

    def _rest(self, q: acb, analytic: bool = False) -> acb:
        """Return R = p²/((q − a)(b − q)), or p²/(b − q) at a wall."""
        ends = self.high - q if self.wall else (q - self.low) * (self.high - q)
        return self.square(q, analytic) / ends

    def integral(self, f: Callable[[acb, bool], acb], power: int, end: arb | None = None) -> arb:
        """Return the integral of f·(p²)^(power/2) from the lower turning point to the upper one, or to ``end``.

        Raises
        ------
        NoCycleError
            Where no rectangle was found in which the integrand is certainly holomorphic.
        """

        def integrand(q: acb, analytic: bool) -> acb:
            return f(q, analytic) * self.root(q, analytic) ** power

        for path in self._paths(end):
            total = integral_along(integrand, path)
            if total.is_finite():
                return total.real
        raise self._too_near

    def _paths(self, end: arb | None) -> Iterator[list[acb]]:
        """Give paths about rectangles in which p² is proved to have the two zeros and no pole, wide ones first.

        √R is one function along each of them: R does not meet the negative real axis, as it may where p² turns much.
        """
        d = ((self.high - self.low) / 2).mid()
        given = 0
        for _ in range(MOST_HALVINGS):
            path = self._path(d, end)
            if self._proved_for(d) and all(
                _is_off_the_cut(self._rest, *ends, CUT_DEPTH) for ends in pairwise(path)
            ):
                given += 1
                yield path
            if given == MOST_WIDTHS:
                return
            d = (d / 2).mid()

    def _proved_for(self, d: arb) -> bool:
        key = float(d)
        if key not in self.proved:
            self.proved[key] = self._is_proved(d)
        return self.proved[key]

    def _is_proved(self, d: arb) -> bool:
        with precision(COARSE_BITS):
            low, high = self._left(d), (self.high + d).mid()
            if not _holomorphic(self.square, low.union(high), arb(0).union(d), DEEPEST):
                return False
            turns = integral_along(
                lambda q, analytic: self.slope(q, analytic) / self.square(q, analytic),
                list(reversed(self._path(d, None))),
                COARSE_GOAL,
                COARSE_EVALUATIONS,
            )
            if not turns.is_finite():
                return False
            count = (turns.imag / arb.pi()).unique_fmpz()
            return count is not None and int(count) == (1 if self.wall else 2)

    def _path(self, d: arb, end: arb | None) -> list[acb]:
        left, right = self._left(d), (self.high + d).mid() if end is None else end
        return [acb(left), acb(left, d), acb(right, d), acb(right)]

    def _left(self, d: arb) -> arb:
        return self.low if self.wall else (self.low - d).mid()

    @property
    def _too_near(self) -> NoCycleError:
        return NoCycleError(
            f"the cycle of {self.name} between {float(self.low):.12g} and {float(self.high):.12g} is too near to a "
            "separatrix or to a singular point for a certified integral; ask for more digits, or change the start"
        )


def integral_along(
    f: Callable[[acb, bool], acb],
    corners: list[acb],
    tolerance: float | None = None,
    evaluations: int = EVALUATIONS,
) -> acb:
    """Return the integral along the straight lines between corners, a ball that certainly holds it.

    Examples
    --------
    >>> integral_along(lambda z, analytic: 1 / z, [acb(1), acb(0, 1), acb(-1)]).overlaps(acb(0, 1) * acb.pi())
    True
    """
    total = acb(0)
    goal = arb(2) ** (SPARE_BITS - ctx.prec) if tolerance is None else arb(tolerance)
    for start, end in pairwise(corners):
        total += acb.integral(f, start, end, rel_tol=goal, abs_tol=goal, eval_limit=evaluations)
        if not total.is_finite():
            break
    return total


def _holomorphic(f: BallFunction, real: arb, imaginary: arb, depth: int) -> bool:
    """Whether f is certainly holomorphic on a rectangle, which is halved until balls tell."""
    if f(acb(real, imaginary), analytic=True).is_finite():
        return True
    if depth == 0:
        return False
    halves = (
        [(part, imaginary) for part in _halves(real)]
        if float(real.rad()) >= float(imaginary.rad())
        else [(real, part) for part in _halves(imaginary)]
    )
    return all(_holomorphic(f, x, y, depth - 1) for x, y in halves)


def _is_off_the_cut(f: Callable[[acb], acb], start: acb, end: acb, depth: int) -> bool:
    """Whether f certainly keeps off zero and the negative real axis on a line, which is halved until balls tell."""
    if f(start.union(end)).sqrt(analytic=True).is_finite():
        return True
    if depth == 0:
        return False
    middle = ((start + end) / 2).mid()
    return _is_off_the_cut(f, start, middle, depth - 1) and _is_off_the_cut(f, middle, end, depth - 1)


def _halves(interval: arb) -> tuple[arb, arb]:
    low, middle, high = interval.lower(), interval.mid(), interval.upper()
    return low.union(middle), middle.union(high)
