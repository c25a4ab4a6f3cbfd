"""Kepler's flow by universal variables, one formula for ellipse, parabola and hyperbola, bodies in SIMD lanes.

With β = 2µ/r₀ − v₀², η = x₀·v₀, ζ = µ − βr₀ and G_k(X) = Xᵏ c_k(βX²), c_k Stumpff's functions, the universal
anomaly X after the time t solves F(X) = r₀X + ηG₂ + ζG₃ − t = 0; F' = r > 0, so there is one root. Then
x − x₀ = −(µG₂/r₀) x₀ + (t − µG₃) v₀ and v − v₀ = −(µG₁/(r₀r)) x₀ − (µG₂/r) v₀: increments, so that what rounding
takes from them can be carried along.

Convergence is certain. Steps of fifth order start from the series of X in t; the signs of F keep a bracket, steps that
leave it halve it, and from the eighth step on every second one does. The root lies in [0, B] with B = 2π/√β on
an ellipse, t being less than a period. Where βr₀ ≤ µ/2, so that e ≥ ½, also B³ = 100 t/µ will do: r = q + µe
G₂(X − X_p) around the pericentre X_p, hence t ≥ 2µe G₃(X/2) ≥ 2µe·0.6 (X/2)³/6.

Sources: J. M. A. Danby, Fundamentals of Celestial Mechanics (2nd ed., Willmann-Bell 1988), §§ 6.9, 6.10; H. Rein,
D. Tamayo, WHFast: a fast and unbiased implementation of a symplectic Wisdom–Holman integrator for long-term
gravitational simulations, Mon. Not. R. Astron. Soc. 452 (2015) 376–388, doi:10.1093/mnras/stv1257.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.arithmetic import Arithmetic
from canon.kernel.machine import double_pair

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.writer import Writer

__all__ = ["kepler_flow"]

_REACH = Fraction(5, 2)
"""Stumpff's functions are summed as power series up to this |z|, and reached from there by quartering z."""

_TERMS = 10
"""Terms of the series: the first one left out is below 2⁻⁵⁵ of the sum."""

_QUARTERINGS = 30
"""From |z| = 2.5 · 4³⁰ the cosh of √|z| is beyond doubles anyhow."""

_ITERATIONS = 240
"""After these the bracket has been halved 116 times, more than the 53 bits of a root and its reach need."""

_PATIENCE = 8
"""Iterations before every second one halves the bracket."""

_NEAR = Fraction(1, 2**22)
"""A step a of fifth order is the last where (aF''/F')², a²F'''/F', a²β, ¼(a/X)² are below: it errs by 2⁻⁵⁴ of X."""

_TWO_PI = Fraction("6.28318530717958647692528676655900576839433879875021")


@dataclass(frozen=True)
class _Orbit:
    """What Kepler's equation reads: registers, one lane for each body."""

    r0: str
    eta: str
    beta: str
    zeta: str
    mu: str
    t: str


def kepler_flow(
    w: Writer, v: Writer, x: Sequence[str], u: Sequence[str], mu: str, t: str
) -> tuple[list[str], list[str]]:
    """Write the motion of bodies about fixed centres and return the increments of places and velocities.

    Parameters
    ----------
    w, v
        Writers of the same function, the second in as many lanes as there are bodies.
    x, u
        Places and velocities, a register for each axis.
    mu
        Gravitational parameters, positive.
    t
        The time, of either sign; the same in all lanes.
    """
    c = Arithmetic(v)
    square, speed2, along = c.dot(x, x), c.dot(u, u), c.dot(x, u)
    r0 = c.sqrt(square)
    near = c.div(c.one, r0)
    pull = c.mul(mu, near)
    beta = c.sub(c.add(pull, pull), speed2)
    zeta = c.fma(c.neg(beta), r0, mu)
    forward = v.intrinsic("copysign", c.one, t)
    orbit = _Orbit(r0, c.mul(along, forward), beta, zeta, mu, _within_a_period(w, v, mu, beta, c.abs(t)))
    guess = _series(c, orbit, near, speed2, pull)
    anomaly, g2, g3 = _solved(w, v, orbit, guess)
    g1 = c.fma(c.neg(beta), g3, anomaly)
    r = c.fma(orbit.eta, g1, c.fma(zeta, g2, r0))
    per_r = c.div(c.one, r)
    pulled = c.mul(mu, g2)
    f = c.neg(c.mul(pulled, near))
    g = c.mul(forward, c.fma(c.neg(mu), g3, orbit.t))
    f_rate = c.neg(c.mul(forward, c.mul(c.mul(pull, g1), per_r)))
    g_rate = c.neg(c.mul(pulled, per_r))
    moved = [c.fma(f, a, c.mul(g, b)) for a, b in zip(x, u, strict=True)]
    turned = [c.fma(f_rate, a, c.mul(g_rate, b)) for a, b in zip(x, u, strict=True)]
    return moved, turned


def _within_a_period(w: Writer, v: Writer, mu: str, beta: str, t: str) -> str:
    """Take whole periods 2πµ/β^(3/2) from t, where there are any: (t/2π)² β³ ≥ µ² tells without a root."""
    c = Arithmetic(v)
    kept = v.array(1)
    v.store(t, kept, 0)
    turn = c.mul(t, c.number(1 / _TWO_PI))
    ratio = c.mul(c.mul(c.mul(turn, turn), c.mul(beta, beta)), beta)
    longer = v.let(f"fcmp oge {v.number.name} {ratio}, {c.mul(mu, mu)}")
    with w.loop(0, w.let(f"zext i1 {v.any_lane(longer)} to i64")):
        bound = v.less(c.zero, beta)
        safe = v.select(bound, beta, c.one)
        period = c.div(c.mul(c.number(_TWO_PI), mu), c.mul(safe, c.sqrt(safe)))
        whole = v.intrinsic("floor", c.div(t, period))
        rest = v.intrinsic("maxnum", c.fma(c.neg(whole), period, t), c.zero)
        v.store(v.select(longer, rest, t), kept, 0)
    return v.load(kept, 0)


def _series(c: Arithmetic, orbit: _Orbit, near: str, speed2: str, pull: str) -> str:
    """Return X up to t⁴, from dX/dt = 1/r and r̈ = h²/r³ − µ/r²; or t/r₀ where that is far from it."""
    reach = c.mul(orbit.t, near)
    square = c.mul(reach, reach)
    a1 = c.mul(c.mul(orbit.eta, near), reach)
    spin = c.fma(c.neg(a1), a1, c.mul(speed2, square))  # h² t²/r⁴
    fall = c.mul(pull, square)  # µ t²/r³
    a2 = c.mul(c.number(Fraction(1, 2)), c.sub(spin, fall))
    a3 = c.mul(a1, c.fma(c.number(Fraction(-1, 2)), spin, c.mul(c.number(Fraction(1, 3)), fall)))
    second = c.fma(a1, a1, c.neg(a2))
    third = c.fma(a1, c.sub(a2, second), c.neg(a3))
    factor = c.fma(c.number(Fraction(-1, 2)), a1, c.one)
    factor = c.fma(c.number(Fraction(1, 3)), second, factor)
    factor = c.fma(c.number(Fraction(1, 4)), third, factor)
    fair = c.both(c.at_most(c.number(Fraction(1, 4)), factor), c.at_most(factor, c.number(Fraction(4))))
    return c.mul(reach, c.writer.select(fair, factor, c.one))


def _solved(w: Writer, v: Writer, orbit: _Orbit, guess: str) -> tuple[str, str, str]:
    """Solve Kepler's equation for X and return X, G₂, G₃."""
    c = Arithmetic(v)
    anomaly, second, third = v.array(1), v.array(1), v.array(1)
    low, high, doubt = v.array(1), v.array(1), v.array(1)
    v.store(guess, anomaly, 0)
    v.store(c.zero, low, 0)
    v.store(v.infinity(), high, 0)
    v.store(v.nan(), doubt, 0)
    with w.loop(0, _ITERATIONS) as turn:
        with w.loop(0, w.let(f"zext i1 {w.let(f'icmp eq i64 {turn}, {_PATIENCE // 2}')} to i64")):
            v.store(v.intrinsic("minnum", _bound(c, v, orbit), v.load(high, 0)), high, 0)
        x = v.load(anomaly, 0)
        g2, g3 = _stumpff(w, v, orbit.beta, x)
        g1, g0 = c.fma(c.neg(orbit.beta), g3, x), c.fma(c.neg(orbit.beta), g2, c.one)
        miss = c.fma(orbit.r0, x, c.fma(orbit.eta, g2, c.fma(orbit.zeta, g3, c.neg(orbit.t))))
        slope = c.fma(orbit.eta, g1, c.fma(orbit.zeta, g2, orbit.r0))
        per = c.div(c.one, slope)
        newton = c.neg(c.mul(miss, per))
        bend = c.mul(c.mul(c.fma(orbit.eta, g0, c.mul(orbit.zeta, g1)), per), newton)
        square = c.mul(newton, newton)
        twist = c.mul(
            c.fma(orbit.zeta, g0, c.neg(c.mul(c.mul(orbit.beta, orbit.eta), g1))), c.mul(per, square)
        )
        curl = c.mul(orbit.beta, square)
        step = c.mul(newton, _reversion(c, bend, twist, curl))
        largest = c.greater(c.greater(c.mul(bend, bend), c.abs(twist)), c.abs(curl))
        limit = c.mul(c.number(4 * _NEAR), c.mul(x, x))
        last = c.both(c.at_most(largest, c.number(_NEAR)), c.at_most(square, limit))
        # What is left of the bracket may be one rounding: then X is known as well as it can be.
        below = v.less(miss, c.zero)
        floor, ceiling = v.select(below, x, v.load(low, 0)), v.select(below, v.load(high, 0), x)
        closed = v.less(c.sub(ceiling, floor), c.mul(ceiling, c.number(Fraction(1, 2**51))))
        step = v.select(last, step, v.select(closed, c.zero, step))
        v.store(floor, low, 0)
        v.store(ceiling, high, 0)
        # A body that has its root keeps it while others go on: no lane depends on another.
        settled = v.equal(v.load(doubt, 0), c.zero)
        new = _moved_on(c, x, step, (g0, g1, g2, g3), orbit.beta)
        for value, where in zip(new, (anomaly, second, third), strict=True):
            v.store(v.select(settled, v.load(where, 0), value), where, 0)
        found = c.either(settled, c.either(last, closed))
        v.store(v.select(found, c.zero, v.nan()), doubt, 0)
        w.leave_if(c.all(found))
        halve = w.let(
            f"and i1 {w.let(f'icmp sge i64 {turn}, {_PATIENCE}')}, {w.let(f'trunc i64 {turn} to i1')}"
        )
        candidate = v.load(anomaly, 0)
        inside = c.both(v.less(floor, candidate), v.less(candidate, ceiling))
        open_end = v.let(f"fcmp oeq {v.number.name} {ceiling}, {v.infinity()}")
        middle = v.select(open_end, c.add(x, x), c.mul(c.number(Fraction(1, 2)), c.add(floor, ceiling)))
        safe = v.select(inside, candidate, middle)
        following = v.let(f"select i1 {halve}, {v.number.name} {middle}, {v.number.name} {safe}")
        v.store(v.select(found, candidate, following), anomaly, 0)
    # Without a root, as where the state is not finite, the motion is not either.
    return c.add(v.load(anomaly, 0), v.load(doubt, 0)), v.load(second, 0), v.load(third, 0)


def _reversion(c: Arithmetic, bend: str, twist: str, curl: str) -> str:
    """Return δ/a for the root δ of F's Taylor polynomial, up to the fourth power of Newton's step a = −F/F'.

    1 − b/2 + (b²/2 − w/6) + b(5w/12 − 5b²/8 + βa²/24) with b = aF⁽²⁾/F', w = a²F⁽³⁾/F'; F⁽⁴⁾ = −βF⁽²⁾.
    """
    half = c.fma(c.number(Fraction(1, 2)), bend, c.number(Fraction(-1, 2)))
    low = c.fma(bend, half, c.fma(twist, c.number(Fraction(-1, 6)), c.one))
    inner = c.fma(c.number(Fraction(5, 12)), twist, c.mul(c.number(Fraction(1, 24)), curl))
    inner = c.fma(c.mul(c.number(Fraction(-5, 8)), bend), bend, inner)
    return c.fma(bend, inner, low)


def _bound(c: Arithmetic, v: Writer, orbit: _Orbit) -> str:
    """Return B with 0 ≤ X ≤ B; the cube root of y is at most √y or, for y < 1, ⁴√y."""
    bound = v.less(c.zero, orbit.beta)
    ellipse = c.div(c.number(_TWO_PI), c.sqrt(v.select(bound, orbit.beta, c.one)))
    root = c.sqrt(c.div(c.mul(c.number(Fraction(100)), orbit.t), orbit.mu))
    slender = c.greater(root, c.sqrt(root))
    half = c.mul(c.number(Fraction(1, 2)), orbit.mu)
    is_slender = c.at_most(c.mul(orbit.beta, orbit.r0), half)
    either = v.select(is_slender, v.intrinsic("minnum", ellipse, slender), ellipse)
    return v.select(bound, either, slender)


def _moved_on(c: Arithmetic, x: str, step: str, g: Sequence[str], beta: str) -> tuple[str, str, str]:
    """Return X + a, G₂(X + a) and G₃(X + a), by their Taylor series in the small a."""
    g0, g1, g2, g3 = g
    half, third, fourth = (c.mul(step, c.number(Fraction(1, k))) for k in (2, 3, 4))
    curve = c.fma(c.neg(c.mul(third, beta)), c.fma(fourth, g0, g1), g0)
    rise = c.fma(c.neg(c.mul(fourth, beta)), g1, g0)
    second = c.fma(step, c.fma(half, curve, g1), g2)
    third_one = c.fma(step, c.fma(half, c.fma(third, rise, g1), g2), g3)
    return c.add(x, step), second, third_one


def _stumpff(w: Writer, v: Writer, beta: str, x: str) -> tuple[str, str]:
    """Write G₂ = X² c₂(βX²) and G₃ = X³ c₃(βX²).

    c₂(4z) = c₁(z)²/2 and c₃(4z) = (c₂(z) + c₀(z) c₃(z))/4 lead back from arguments that the series reach.
    """
    c = Arithmetic(v)
    square = c.mul(x, x)
    argument, second, third, count = (v.array(1) for _ in range(4))
    v.store(c.mul(beta, square), argument, 0)
    v.store(c.zero, count, 0)
    with w.loop(0, _QUARTERINGS):
        z = v.load(argument, 0)
        small = c.at_most(c.abs(z), c.number(_REACH))
        w.leave_if(c.all(small))
        v.store(v.select(small, z, c.mul(z, c.number(Fraction(1, 4)))), argument, 0)
        v.store(c.add(v.load(count, 0), v.select(small, c.zero, c.one)), count, 0)
    z = v.load(argument, 0)
    for first, where in ((2, second), (3, third)):
        v.store(_stumpff_series(c, z, first), where, 0)
    with w.loop(0, _QUARTERINGS):
        left = v.load(count, 0)
        done = v.equal(left, c.zero)
        w.leave_if(c.all(done))
        z, c2, c3 = v.load(argument, 0), v.load(second, 0), v.load(third, 0)
        c0, c1 = c.fma(c.neg(z), c2, c.one), c.fma(c.neg(z), c3, c.one)
        new = (
            (second, c2, c.mul(c.number(Fraction(1, 2)), c.mul(c1, c1))),
            (third, c3, c.mul(c.number(Fraction(1, 4)), c.fma(c0, c3, c2))),
            (argument, z, c.mul(z, c.number(Fraction(4)))),
            (count, left, c.sub(left, c.one)),
        )
        for where, old, quadrupled in new:
            v.store(v.select(done, old, quadrupled), where, 0)
    return c.mul(square, v.load(second, 0)), c.mul(c.mul(square, x), v.load(third, 0))


def _stumpff_series(c: Arithmetic, z: str, first: int) -> str:
    """Write c_first(z) = Σ (−z)ᵏ/(2k + first)!, even and odd powers apart: two short chains instead of a long one.

    What doubles lack of the first coefficients goes in too: always the same, it would make the energy drift.
    """
    exact = [Fraction((-1) ** k, math.factorial(2 * k + first)) for k in range(_TERMS)]
    lacking = [double_pair(value)[1] for value in exact[:3]]
    z2 = c.mul(z, z)
    even = c.fma(c.polynomial(z2, exact[2::2]), z2, c.polynomial(z, [Fraction(value) for value in lacking]))
    return c.add(c.number(exact[0]), c.fma(c.polynomial(z2, exact[1::2]), z, even))
