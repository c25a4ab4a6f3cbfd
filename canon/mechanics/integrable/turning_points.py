"""Turning points of one separated coordinate: ends of the interval with p² > 0, isolated and refined in balls."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import acb, arb

if TYPE_CHECKING:
    from canon.mechanics.integrable.ball_function import BallFunction

__all__ = ["NoCycleError", "real_value", "turning_point", "turning_point_at"]

MOST_STEPS = 3000
MOST_REFINEMENTS = 200
FARTHEST = 2.0**100
"""Beyond this many lengths a motion is called unbounded."""
SMALLEST = 2.0**-60
"""Steps this small, against the length, are taken for a separatrix or a singular point."""


class NoCycleError(ValueError):
    """Raised where a coordinate runs through no cycle: unbounded, at rest, or too near to a separatrix."""


def real_value(f: BallFunction, x: arb) -> arb:
    """Return f on a real ball; not a number where f is not certainly real there, as behind a branch point."""
    ball = f(acb(x))
    return ball.real if ball.imag.is_zero() else arb("nan")


def turning_point(
    square: BallFunction, slope: BallFunction, start: arb, direction: int, reach: arb | None, name: str
) -> arb | None:
    """Return the first zero of p² in one direction from a place where p² > 0; None where ``reach`` comes first.

    Cells on which p² is certainly positive are passed over: by its ball, or where it falls and is positive at the
    far end. On the last cell p² certainly falls, to less than zero: it holds one simple zero, and none was missed.

    Raises
    ------
    NoCycleError
        Where no zero comes, or one that is not told from a double one.

    Examples
    --------
    >>> import sympy as sp
    >>> from canon.mechanics.integrable.ball_function import BallFunction
    >>> q = sp.Symbol("q")
    >>> print(turning_point(BallFunction(2 - q**2, q, {}), BallFunction(-2*q, q, {}), arb(0), 1, None, "q").str(10))
    [1.414213562 +/- 3.74e-10]
    """
    unit = max(1.0, abs(float(start.mid())))
    here, step = start, arb(unit / 64)
    for _ in range(MOST_STEPS):
        following = (here + direction * step).mid()
        cell = here.union(following)
        falls, behind = direction * real_value(slope, cell) < 0, real_value(square, following)
        if falls and behind < 0:
            return _refined(square, slope, cell)
        if real_value(square, cell) > 0 or (falls and behind > 0):
            here, step = following, 2 * step
            if reach is not None and direction * (here - reach) > 0:
                return None
            if abs(float(here)) > FARTHEST * unit:
                raise NoCycleError(f"the motion in {name} is not bounded, so that it has no action")
            continue
        step = (step * 7 / 16).mid()
        if float(step) < SMALLEST * max(unit, abs(float(here))):
            break
    raise NoCycleError(
        f"no simple turning point was isolated near {name} = {float(here):.12g}: the motion is on a separatrix or "
        "closer to one than balls can tell, or runs into a singular point; change the start, or ask for more digits"
    )


def turning_point_at(slope: BallFunction, place: arb, name: str) -> int:
    """Return in which direction p² > 0 from a place where p² = 0.

    Raises
    ------
    NoCycleError
        Where p² may have a double zero there.
    """
    rate = real_value(slope, place)
    if rate > 0:
        return 1
    if rate < 0:
        return -1
    raise NoCycleError(
        f"{name} is at rest at {float(place):.12g}, an equilibrium of its own motion: a stable one has the action "
        "zero, at an unstable one the action is not defined; start beside it"
    )


def _refined(square: BallFunction, slope: BallFunction, cell: arb) -> arb:
    """Return the only zero in a cell on which the slope keeps its sign, by Newton's method on balls."""
    for _ in range(MOST_REFINEMENTS):
        middle = cell.mid()
        at_middle = real_value(square, middle)
        newton = middle - at_middle / real_value(slope, cell)
        if not newton.is_finite() or not newton.overlaps(cell):
            return cell
        narrower = newton.intersection(cell)
        if float(narrower.rad()) > 0.9 * float(cell.rad()):
            return narrower
        cell = narrower
    return cell
