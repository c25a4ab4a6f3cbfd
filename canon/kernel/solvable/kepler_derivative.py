"""Kepler's flow's derivative by the starting state, along deviations, bodies in SIMD lanes.

In the notation of :mod:`canon.kernel.solvable.kepler_flow`, with ∂G_k/∂X = G_{k−1} and ∂G_k/∂β = B_k = ½(k G_{k+2} −
X G_{k+1}), a deviation changes X by δX = −(G₁ δr₀ + G₂ δη + (ηB₂ + ζB₃ − r₀G₃) δβ − δt)/r. The time t that Kepler's
equation reads has lost a whole number of periods, t = t₀ − NP(β), so that it changes too, by 3NP δβ/2β.

Sources: H. Rein, D. Tamayo, Second-order variational equations for N-body simulations, Mon. Not. R. Astron. Soc. 459
(2016) 2275–2285, doi:10.1093/mnras/stw644; S. Mikkola, K. Innanen, Symplectic tangent map for planetary motions,
Celest. Mech. Dyn. Astron. 74 (1999) 59–67, doi:10.1023/A:1008312912468.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.solvable.stumpff import further_stumpff

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.llvm.formulas import LaneFormulas
    from canon.kernel.solvable.kepler_flow import KeplerMotion

__all__ = ["KeplerDerivative"]

_HALF = Fraction(1, 2)


class KeplerDerivative:
    """The derivative of one motion.

    Parameters
    ----------
    c
        Writes formulas in the lanes of the bodies.
    x, u
        Places and velocities before the motion.
    motion
        The motion.
    """

    def __init__(self, c: LaneFormulas, x: Sequence[str], u: Sequence[str], motion: KeplerMotion) -> None:
        self.c, self.x, self.u, self.motion = c, x, u, motion
        orbit, anomaly, (g1, g2, g3) = motion.orbit, motion.anomaly, motion.g
        g4, g5 = further_stumpff(c, orbit.beta, anomaly, g2, g3)
        half = c.number(_HALF)
        back = c.neg(c.mul(half, anomaly))
        self.by_beta = (
            c.fma(back, g2, c.mul(half, g3)),
            c.fma(back, g3, g4),
            c.fma(back, g4, c.mul(c.number(3 * _HALF), g5)),
        )
        first, second, third = self.by_beta
        # β is positive where there are periods.
        safe = c.select(c.less(c.zero, orbit.beta), orbit.beta, c.one)
        self.later = c.mul(c.mul(c.number(3 * _HALF), motion.forward), c.div(motion.whole, safe))
        self.pull = c.fma(orbit.eta, second, c.fma(orbit.zeta, third, c.neg(c.fma(orbit.r0, g3, self.later))))
        self.g0 = c.fma(c.neg(orbit.beta), g2, c.one)
        self.rise = c.fma(orbit.eta, first, c.fma(orbit.zeta, second, c.neg(c.mul(orbit.r0, g2))))
        self.bend = c.fma(orbit.eta, self.g0, c.mul(orbit.zeta, g1))
        self.steep = c.mul(orbit.pull, c.mul(orbit.near, orbit.near))

    def moved(self, dx: Sequence[str], du: Sequence[str]) -> tuple[list[str], list[str]]:
        """Write a deviation after the motion, δx and δv along each axis."""
        c, x, u = self.c, self.x, self.u
        f, g, f_rate, g_rate = self.motion.factors
        df, dg, df_rate, dg_rate = self._changes(dx, du)

        def sums(a: str, b: str, da: str, db: str, start: Sequence[str]) -> list[str]:
            return [
                c.add(each, c.fma(a, p, c.fma(b, q, c.fma(da, r, c.mul(db, s)))))
                for each, p, q, r, s in zip(start, dx, du, x, u, strict=True)
            ]

        return sums(f, g, df, dg, dx), sums(f_rate, g_rate, df_rate, dg_rate, du)

    def _changes(self, dx: Sequence[str], du: Sequence[str]) -> tuple[str, str, str, str]:
        """Write δf, δg, δḟ and δġ."""
        c, motion, orbit = self.c, self.motion, self.motion.orbit
        g1, g2, _ = motion.g
        along = c.dot(self.x, dx)
        r0 = c.mul(orbit.near, along)
        eta = c.mul(motion.forward, c.add(c.dot(self.u, dx), c.dot(self.x, du)))
        beta = c.mul(c.number(Fraction(-2)), c.fma(self.steep, along, c.dot(self.u, du)))
        anomaly = c.mul(c.neg(motion.near), c.fma(g1, r0, c.fma(g2, eta, c.mul(self.pull, beta))))
        d1, d2, d3 = (
            c.fma(lower, anomaly, c.mul(by_beta, beta))
            for lower, by_beta in zip((self.g0, g1, g2), self.by_beta, strict=True)
        )
        r = c.fma(self.g0, r0, c.fma(g1, eta, c.fma(self.rise, beta, c.mul(self.bend, anomaly))))
        start, end = c.mul(orbit.near, r0), c.mul(motion.near, r)
        df = c.mul(orbit.pull, c.fma(g2, start, c.neg(d2)))
        dg = c.mul(motion.forward, c.fma(self.later, beta, c.neg(c.mul(orbit.mu, d3))))
        fall = c.mul(c.mul(orbit.pull, motion.forward), motion.near)
        df_rate = c.mul(fall, c.fma(g1, c.add(start, end), c.neg(d1)))
        dg_rate = c.mul(c.mul(orbit.mu, motion.near), c.fma(g2, end, c.neg(d2)))
        return df, dg, df_rate, dg_rate
