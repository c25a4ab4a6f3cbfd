"""Kepler's equation in universal variables: F(X) = r₀X + ηG₂ + ζG₃ − t = 0; F' = r > 0, so there is one root.

Convergence is certain. Steps of fifth order start from the series of X in t; the signs of F keep a bracket, steps that
leave it halve it, and from the eighth step on every second one does. The root lies in [0, B] with B = 2π/√β on
an ellipse, t being no more than half a period. Where βr₀ ≤ µ/2, so that e ≥ ½, also B³ = 100 t/µ will do: r = q + µe
G₂(X − X_p) around the pericentre X_p, hence t ≥ 2µe G₃(X/2) ≥ 2µe·0.6 (X/2)³/6.

Where a time step is a small part of the period, one step from the series is enough: that comes first, without a search.
In wider numbers than doubles the root is found in doubles, and one step of fifth order more leads to theirs.

Sources: J. M. A. Danby, Fundamentals of Celestial Mechanics (2nd ed., Willmann-Bell 1988), §§ 6.9, 6.10.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.formulas import LaneFormulas
from canon.kernel.llvm.number_types import DOUBLE
from canon.kernel.solvable.stumpff import REACH, stumpff, stumpff_series

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.llvm.writer import Writer

__all__ = ["TWO_PI", "KeplerOrbit", "in_doubles", "of_doubles", "universal_anomaly"]

TWO_PI = Fraction("6.28318530717958647692528676655900576839433879875021")

_ITERATIONS = 240
"""After these the bracket has been halved 116 times, more than the 53 bits of a root and its reach need."""

_PATIENCE = 8
"""Iterations before every second one halves the bracket."""

_FURTHER = 6
"""Steps in wide numbers from the root in doubles: one is enough wherever that root is good for some digits."""


@dataclass(frozen=True)
class KeplerOrbit:
    """What Kepler's equation reads: registers, one lane for each body; 1/r₀ is ``near``, µ/r₀ ``pull``."""

    r0: str
    near: str
    eta: str
    speed2: str
    beta: str
    zeta: str
    mu: str
    pull: str
    t: str


def universal_anomaly(w: Writer, v: Writer, orbit: KeplerOrbit) -> tuple[str, str, str]:
    """Solve Kepler's equation for X and return X, G₂, G₃."""
    c = LaneFormulas(v)
    found = v.array(1), v.array(1), v.array(1)
    if dataclasses.replace(v.number, lanes=1) == DOUBLE:
        _solve(w, v, orbit, found)
    else:
        doubles = in_doubles(v, orbit.t)[0]
        rounded = KeplerOrbit(
            *(in_doubles(v, getattr(orbit, each.name))[1] for each in dataclasses.fields(KeplerOrbit))
        )
        first = doubles.array(1), doubles.array(1), doubles.array(1)
        _solve(w, doubles, rounded, first)
        v.store(of_doubles(v, doubles.load(first[0], 0)), found[0], 0)
        _continue(w, v, c, orbit, found)
    return v.load(found[0], 0), v.load(found[1], 0), v.load(found[2], 0)


def _continue(w: Writer, v: Writer, c: LaneFormulas, orbit: KeplerOrbit, found: Sequence[str]) -> None:
    """Write X, G₂ and G₃ of a root that is known roughly."""
    doubt = v.array(1)
    v.store(c.one, doubt, 0)
    with w.loop(0, _FURTHER):
        x = v.load(found[0], 0)
        trial = _trial(c, orbit, x, *stumpff(w, v, orbit.beta, x))
        settled = c.equal(v.load(doubt, 0), c.zero)
        for value, where in zip(_moved_on(c, x, trial, orbit.beta), found, strict=True):
            v.store(c.select(settled, v.load(where, 0), value), where, 0)
        rooted = c.either(settled, trial.last)
        v.store(c.select(rooted, c.zero, c.one), doubt, 0)
        w.leave_if(c.all(rooted))
    left = v.load(doubt, 0)
    v.store(c.add(v.load(found[0], 0), c.div(left, c.sub(c.one, left))), found[0], 0)


def _solve(w: Writer, v: Writer, orbit: KeplerOrbit, found: tuple[str, str, str]) -> None:
    """Write X, G₂, G₃ in doubles: by one step from the series where that is enough in all lanes, else by a search.

    The search repeats that step: lanes for which it was enough get the same bits, whatever their neighbours ask for.
    """
    c = LaneFormulas(v)
    guess = _series(c, orbit)
    square = c.mul(guess.x, guess.x)
    z = c.mul(orbit.beta, square)
    c2, c3 = stumpff_series(c, z)
    trial = _trial(c, orbit, guess.x, c.mul(square, c2), c.mul(c.mul(square, guess.x), c3))
    for value, where in zip(_moved_on(c, guess.x, trial, orbit.beta), found, strict=True):
        v.store(value, where, 0)
    plain = c.both(c.at_most(c.abs(z), c.number(REACH)), guess.fair)
    enough = c.all(c.both(plain, trial.last))
    with w.loop(w.let(f"zext i1 {enough} to i64"), 1):
        v.store(v.select(guess.fair, guess.x, guess.reach), found[0], 0)
        _search(w, v, orbit, found)


@dataclass(frozen=True)
class _Guess:
    """Where the search for X starts: t/r₀, a power series in t, and the flag of lanes where that can be trusted."""

    reach: str
    x: str
    fair: str


def _series(c: LaneFormulas, orbit: KeplerOrbit) -> _Guess:
    """Return X up to t⁴ from dX/dt = 1/r and r̈ = h²/r³ − µ/r²."""
    reach = c.mul(orbit.t, orbit.near)
    square = c.mul(reach, reach)
    a1 = c.mul(c.mul(orbit.eta, orbit.near), reach)
    spin = c.fma(c.neg(a1), a1, c.mul(orbit.speed2, square))  # h² t²/r⁴
    fall = c.mul(orbit.pull, square)  # µ t²/r³
    a2 = c.mul(c.number(Fraction(1, 2)), c.sub(spin, fall))
    a3 = c.mul(a1, c.fma(c.number(Fraction(-1, 2)), spin, c.mul(c.number(Fraction(1, 3)), fall)))
    second = c.fma(a1, a1, c.neg(a2))
    third = c.fma(a1, c.sub(a2, second), c.neg(a3))
    factor = c.fma(c.number(Fraction(-1, 2)), a1, c.one)
    factor = c.fma(c.number(Fraction(1, 3)), second, factor)
    factor = c.fma(c.number(Fraction(1, 4)), third, factor)
    fair = c.both(c.at_most(c.number(Fraction(1, 4)), factor), c.at_most(factor, c.number(Fraction(4))))
    return _Guess(reach, c.mul(reach, factor), fair)


@dataclass(frozen=True)
class _Trial:
    """Kepler's equation at an X: what is missed, G₀ … G₃, the step to the root, and whether it is the last."""

    miss: str
    g: tuple[str, str, str, str]
    step: str
    last: str


def _trial(c: LaneFormulas, orbit: KeplerOrbit, x: str, g2: str, g3: str) -> _Trial:
    """Write a step of fifth order from X.

    It is the last where (aF''/F')², a²F'''/F', a²β, ¼(a/X)² are below 2^(−0.4 (p + 2)), p the bits of the mantissa:
    it errs by 2^−(p + 1) of X.
    """
    g1, g0 = c.fma(c.neg(orbit.beta), g3, x), c.fma(c.neg(orbit.beta), g2, c.one)
    miss = c.fma(orbit.r0, x, c.fma(orbit.eta, g2, c.fma(orbit.zeta, g3, c.neg(orbit.t))))
    slope = c.fma(orbit.eta, g1, c.fma(orbit.zeta, g2, orbit.r0))
    per = c.div(c.one, slope)
    newton = c.neg(c.mul(miss, per))
    bend = c.mul(c.mul(c.fma(orbit.eta, g0, c.mul(orbit.zeta, g1)), per), newton)
    square = c.mul(newton, newton)
    third = c.fma(orbit.zeta, g0, c.neg(c.mul(c.mul(orbit.beta, orbit.eta), g1)))
    twist = c.mul(c.mul(third, per), square)
    curl = c.mul(orbit.beta, square)
    step = c.mul(newton, _reversion(c, bend, twist, curl))
    near = Fraction(1, 2 ** (2 * (c.writer.number.mantissa + 2) // 5))
    largest = c.greater(c.greater(c.mul(bend, bend), c.abs(twist)), c.abs(curl))
    limit = c.mul(c.number(4 * near), c.mul(x, x))
    last = c.both(c.at_most(largest, c.number(near)), c.at_most(square, limit))
    return _Trial(miss, (g0, g1, g2, g3), step, last)


def _reversion(c: LaneFormulas, bend: str, twist: str, curl: str) -> str:
    """Return δ/a for the root δ of F's Taylor polynomial, up to the fourth power of Newton's step a = −F/F'.

    1 − b/2 + (b²/2 − w/6) + b(5w/12 − 5b²/8 + βa²/24) with b = aF⁽²⁾/F', w = a²F⁽³⁾/F'; F⁽⁴⁾ = −βF⁽²⁾.
    """
    half = c.fma(c.number(Fraction(1, 2)), bend, c.number(Fraction(-1, 2)))
    low = c.fma(twist, c.number(Fraction(-1, 6)), c.fma(bend, half, c.one))
    inner = c.fma(c.mul(c.number(Fraction(-5, 8)), bend), bend, c.mul(c.number(Fraction(1, 24)), curl))
    return c.fma(bend, c.fma(c.number(Fraction(5, 12)), twist, inner), low)


def _moved_on(c: LaneFormulas, x: str, trial: _Trial, beta: str) -> tuple[str, str, str]:
    """Return X + a, G₂(X + a) and G₃(X + a), by their Taylor series in the small a: G_k' = G_{k−1}, G₀' = −βG₁.

    What is added to G_k is rounded to it once: twice would make the energy drift.
    """
    g0, g1, g2, g3 = trial.g
    fall, rise = c.mul(beta, g0), c.mul(beta, g1)
    square = c.mul(trial.step, trial.step)

    def moved(start: str, first: str, values: Sequence[str], signs: Sequence[int]) -> str:
        second, third, fourth = (
            c.mul(c.number(Fraction(sign, math.factorial(k))), value)
            for k, (value, sign) in enumerate(zip(values, signs, strict=True), start=2)
        )
        slope = c.fma(square, c.fma(trial.step, fourth, third), c.fma(trial.step, second, first))
        return c.fma(trial.step, slope, start)

    g2_moved, g3_moved = (
        moved(g2, g1, (g0, rise, fall), (1, -1, -1)),
        moved(g3, g2, (g1, g0, rise), (1, 1, -1)),
    )
    return c.add(x, trial.step), g2_moved, g3_moved


# the search --------------------------------------------------------------------------------------------


def _search(w: Writer, v: Writer, orbit: KeplerOrbit, found: tuple[str, str, str]) -> None:
    """Write X, G₂ and G₃ to where they are wanted, starting from what X is there."""
    c = LaneFormulas(v)
    low, high, doubt = v.array(1), v.array(1), v.array(1)
    v.store(c.zero, low, 0)
    v.store(v.infinity(), high, 0)
    v.store(v.nan(), doubt, 0)
    with w.loop(0, _ITERATIONS) as turn:
        with w.loop(0, w.let(f"zext i1 {w.let(f'icmp eq i64 {turn}, {_PATIENCE // 2}')} to i64")):
            v.store(v.intrinsic("minnum", _bound(c, v, orbit), v.load(high, 0)), high, 0)
        x = v.load(found[0], 0)
        trial = _trial(c, orbit, x, *stumpff(w, v, orbit.beta, x))
        # What is left of the bracket may be one rounding: then X is known as well as it can be.
        below = v.less(trial.miss, c.zero)
        floor, ceiling = v.select(below, x, v.load(low, 0)), v.select(below, v.load(high, 0), x)
        closed = v.less(c.sub(ceiling, floor), c.mul(ceiling, c.number(Fraction(1, 2**51))))
        step = v.select(trial.last, trial.step, v.select(closed, c.zero, trial.step))
        v.store(floor, low, 0)
        v.store(ceiling, high, 0)
        # A body that has its root keeps it while others go on: no lane depends on another.
        settled = v.equal(v.load(doubt, 0), c.zero)
        new = _moved_on(c, x, dataclasses.replace(trial, step=step), orbit.beta)
        for value, where in zip(new, found, strict=True):
            v.store(v.select(settled, v.load(where, 0), value), where, 0)
        rooted = c.either(settled, c.either(trial.last, closed))
        v.store(v.select(rooted, c.zero, v.nan()), doubt, 0)
        w.leave_if(c.all(rooted))
        halve = w.let(
            f"and i1 {w.let(f'icmp sge i64 {turn}, {_PATIENCE}')}, {w.let(f'trunc i64 {turn} to i1')}"
        )
        candidate = v.load(found[0], 0)
        inside = c.both(v.less(floor, candidate), v.less(candidate, ceiling))
        open_end = v.equal(ceiling, v.infinity())
        middle = v.select(open_end, c.add(x, x), c.mul(c.number(Fraction(1, 2)), c.add(floor, ceiling)))
        safe = v.select(inside, candidate, middle)
        following = v.let(f"select i1 {halve}, {v.number.name} {middle}, {v.number.name} {safe}")
        v.store(v.select(rooted, candidate, following), found[0], 0)
    # Without a root, as where the state is not finite, the motion is not either.
    v.store(c.add(v.load(found[0], 0), v.load(doubt, 0)), found[0], 0)


def _bound(c: LaneFormulas, v: Writer, orbit: KeplerOrbit) -> str:
    """Return B with 0 ≤ X ≤ B; the cube root of y is at most √y or, for y < 1, ⁴√y."""
    bound = v.less(c.zero, orbit.beta)
    ellipse = c.div(c.number(TWO_PI), c.sqrt(v.select(bound, orbit.beta, c.one)))
    root = c.sqrt(c.div(c.mul(c.number(Fraction(100)), orbit.t), orbit.mu))
    slender = c.greater(root, c.sqrt(root))
    half = c.mul(c.number(Fraction(1, 2)), orbit.mu)
    is_slender = c.at_most(c.mul(orbit.beta, orbit.r0), half)
    either = v.select(is_slender, v.intrinsic("minnum", ellipse, slender), ellipse)
    return v.select(bound, either, slender)


# other numbers -----------------------------------------------------------------------------------------


def in_doubles(v: Writer, value: str) -> tuple[Writer, str]:
    """Round to doubles; return what writes in these, too."""
    doubles = v.in_numbers(dataclasses.replace(DOUBLE, lanes=v.number.lanes))
    if v.number.pair:
        return doubles, v.let(f"extractvalue {v.number.name} {value}, 0")
    if v.number.scalar == "double":
        return doubles, value
    narrowing = "fptrunc" if v.number.scalar == "x86_fp80" else "fpext"
    return doubles, v.let(f"{narrowing} {v.number.base} {value} to {doubles.number.base}")


def of_doubles(v: Writer, value: str) -> str:
    """Make numbers of a writer of doubles."""
    if v.number.pair:
        return v.paired(value, v.in_numbers(dataclasses.replace(v.number, pair=False)).constant(Fraction(0)))
    if v.number.scalar == "double":
        return value
    widening = "fpext" if v.number.scalar == "x86_fp80" else "fptrunc"
    return (
        v.let(f"{widening} <{v.number.lanes} x double> {value} to {v.number.base}")
        if v.number.lanes > 1
        else v.let(f"{widening} double {value} to {v.number.base}")
    )
