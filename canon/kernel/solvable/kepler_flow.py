"""Kepler's flow by universal variables, one formula for ellipse, parabola and hyperbola, bodies in SIMD lanes.

With β = 2µ/r₀ − v₀², η = x₀·v₀, ζ = µ − βr₀ and G_k(X) = Xᵏ c_k(βX²), c_k Stumpff's functions, the universal
anomaly X after the time t solves F(X) = r₀X + ηG₂ + ζG₃ − t = 0 (:mod:`canon.kernel.solvable.kepler_equation`). Then
x − x₀ = −(µG₂/r₀) x₀ + (t − µG₃) v₀ and v − v₀ = −(µG₁/(r₀r)) x₀ − (µG₂/r) v₀: increments, so that what rounding
takes from them can be carried along.

Sources: J. M. A. Danby, Fundamentals of Celestial Mechanics (2nd ed., Willmann-Bell 1988), §§ 6.9, 6.10; H. Rein,
D. Tamayo, WHFast: a fast and unbiased implementation of a symplectic Wisdom–Holman integrator for long-term
gravitational simulations, Mon. Not. R. Astron. Soc. 452 (2015) 376–388, doi:10.1093/mnras/stv1257.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.kernel.llvm.formulas import LaneFormulas
from canon.kernel.solvable.kepler_equation import (
    TWO_PI,
    KeplerOrbit,
    in_doubles,
    of_doubles,
    universal_anomaly,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.llvm.writer import Writer

__all__ = ["KeplerMotion", "kepler_flow"]


@dataclass(frozen=True)
class KeplerMotion:
    """Kepler's motion after a time: registers, one lane for each body.

    Parameters
    ----------
    moved, turned
        The increments of places and velocities.
    factors
        f − 1, g, ḟ and ġ − 1 with x = f x₀ + g v₀ and v = ḟ x₀ + ġ v₀.
    orbit
        What Kepler's equation read; its η and t are those of motion forward in time.
    forward
        1 or −1: the sign of t.
    anomaly, g
        X, and G₁, G₂, G₃.
    near
        1/r.
    whole
        The whole number of periods that was taken from the time, as a time.
    """

    moved: list[str]
    turned: list[str]
    factors: tuple[str, str, str, str]
    orbit: KeplerOrbit
    forward: str
    anomaly: str
    g: tuple[str, str, str]
    near: str
    whole: str


def kepler_flow(w: Writer, v: Writer, x: Sequence[str], u: Sequence[str], mu: str, t: str) -> KeplerMotion:
    """Write the motion of bodies about fixed centres.

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
    c = LaneFormulas(v)
    r0 = c.sqrt(c.dot(x, x))
    near = c.div(c.one, r0)
    pull = c.mul(mu, near)
    speed2, along = c.dot(u, u), c.dot(x, u)
    beta = c.sub(c.add(pull, pull), speed2)
    zeta = c.fma(c.neg(beta), r0, mu)
    given, t = t, _within_half_a_period(w, v, mu, beta, t)
    forward = c.select(c.less(t, c.zero), c.neg(c.one), c.one)
    orbit = KeplerOrbit(r0, near, c.mul(along, forward), speed2, beta, zeta, mu, pull, c.abs(t))
    anomaly, g2, g3 = universal_anomaly(w, v, orbit)
    f = c.neg(c.mul(pull, g2))
    g = c.fma(c.neg(c.mul(mu, forward)), g3, t)
    moved = [c.fma(f, a, c.mul(g, b)) for a, b in zip(x, u, strict=True)]
    g1 = c.fma(c.neg(beta), g3, anomaly)
    per_r = c.div(c.one, c.fma(orbit.eta, g1, c.fma(zeta, g2, r0)))
    f_rate = c.neg(c.mul(c.mul(c.mul(pull, forward), g1), per_r))
    g_rate = c.neg(c.mul(c.mul(mu, g2), per_r))
    turned = [c.fma(f_rate, a, c.mul(g_rate, b)) for a, b in zip(x, u, strict=True)]
    factors, whole = (f, g, f_rate, g_rate), c.sub(given, t)
    return KeplerMotion(moved, turned, factors, orbit, forward, anomaly, (g1, g2, g3), per_r, whole)


def _within_half_a_period(w: Writer, v: Writer, mu: str, beta: str, t: str) -> str:
    """Take the nearest whole number of periods P = 2πµ/β^(3/2) from t: (t/π)² β³ ≥ µ² tells without a root whether."""
    c = LaneFormulas(v)
    kept = v.array(1)
    v.store(t, kept, 0)
    turn = c.mul(t, c.number(2 / TWO_PI))
    ratio = c.mul(c.mul(c.mul(turn, turn), c.mul(beta, beta)), beta)
    longer = c.at_most(c.mul(mu, mu), ratio)
    with w.loop(0, w.let(f"zext i1 {v.any_lane(longer)} to i64")):
        safe = c.select(c.less(c.zero, beta), beta, c.one)
        period = c.div(c.mul(c.number(TWO_PI), mu), c.mul(safe, c.sqrt(safe)))
        doubles, count = in_doubles(v, c.div(t, period))
        whole = of_doubles(v, doubles.intrinsic("rint", count))
        v.store(c.select(longer, c.fma(c.neg(whole), period, t), t), kept, 0)
    return v.load(kept, 0)
