"""Theta quotients: Jacobi's elliptic functions on complex balls, from the theta functions of Arb.

sn, cn and dn are quotients of theta functions of ζ = πu/(2K) and the nome of τ = i K(1 − m)/K(m) (NIST DLMF 22.2.4–6).
Real m < 0 and m > 1, where that τ lies on a branch cut, are led back to 0 < m < 1 (22.17.2–6). am and ε have logarithms
and residues at the poles of dn and are given values at real arguments only.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import acb, arb

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["amplitude", "epsilon", "sn_cn_dn"]

UNBOUNDED = acb("nan")
"""What no ball is known for: at wider balls, or where a function has a branch; more digits may help."""


def sn_cn_dn(u: acb, m: acb) -> tuple[acb, acb, acb]:
    """Return balls that hold sn, cn and dn of u and the parameter m, real ones at real arguments.

    Examples
    --------
    >>> s, c, d = sn_cn_dn(acb(2), acb("0.3"))
    >>> (s * s + c * c - 1).contains(0), (d * d + acb("0.3") * s * s).overlaps(acb(1)), s.imag.is_zero()
    (True, True, True)
    """
    if not (u.imag.is_zero() and m.imag.is_zero()):
        return _quotients(u, m)
    s, c, d = _at_real_parameter(u, m)
    return acb(s.real), acb(c.real), acb(d.real)


def _at_real_parameter(u: acb, m: acb) -> tuple[acb, acb, acb]:
    if m.is_zero():
        return u.sin(), u.cos(), acb(1)
    if m.real < 0:
        complement = (1 - m).sqrt()
        s, c, d = _quotients(u * complement, m / (m - 1))
        return s / d / complement, c / d, 1 / d
    if m.real > 1:
        k = m.sqrt()
        s, c, d = _quotients(u * k, 1 / m)
        return s / k, d, c
    if (1 - m).is_zero():
        return u.tanh(), u.sech(), u.sech()
    return _quotients(u, m)


def _quotients(u: acb, m: acb) -> tuple[acb, acb, acb]:
    quarter = m.elliptic_k()
    tau = acb(0, 1) * (1 - m).elliptic_k() / quarter
    if not (quarter.is_finite() and tau.is_finite() and tau.imag > 0):
        return UNBOUNDED, UNBOUNDED, UNBOUNDED
    t1, t2, t3, t4 = acb.modular_theta(u / (2 * quarter), tau)
    _, z2, z3, z4 = acb.modular_theta(acb(0), tau)
    return z3 * t1 / (z2 * t4), z4 * t2 / (z2 * t4), z4 * t3 / (z3 * t4)


def amplitude(u: acb, m: acb) -> acb:
    """Return a ball that holds am(u, m) at real u and m: the angle of (cn, sn), with half a turn for every 2K.

    Examples
    --------
    >>> amplitude(2 * acb("0.3").elliptic_k(), acb("0.3")).overlaps(acb.pi())
    True
    """
    return _beyond_half_periods(u, m, _angle, acb.pi())


def epsilon(u: acb, m: acb) -> acb:
    """Return a ball that holds ε(u, m) = ∫₀ᵘ dn²(t, m) dt at real u and m: E(am(u, m), m), 2E more for every 2K.

    Examples
    --------
    >>> epsilon(acb("0.3").elliptic_k(), acb("0.3")).overlaps(acb("0.3").elliptic_e())
    True
    """
    if m.imag.is_zero() and m.real > 1:
        wide = u * m.sqrt()
        return m.sqrt() * (epsilon(wide, 1 / m) - (1 - 1 / m) * wide)
    return _beyond_half_periods(u, m, lambda v, n: acb.elliptic_e_inc(_angle(v, n), n), 2 * m.elliptic_e())


def _angle(u: acb, m: acb) -> acb:
    s, c, _ = sn_cn_dn(u, m)
    return acb(arb.atan2(s.real, c.real))


def _beyond_half_periods(u: acb, m: acb, near: Callable[[acb, acb], acb], rise: acb) -> acb:
    """Return f(u) = f(u − 2Kj) + j·rise with the j that brings the middle of u nearest to zero."""
    if not (u.imag.is_zero() and m.imag.is_zero()):
        return UNBOUNDED
    half_period = 2 * m.elliptic_k().real if m.real < 1 else arb("inf")
    if not half_period.is_finite():
        return near(u, m) if m.real >= 1 else UNBOUNDED
    periods = u.real / half_period
    if not periods.is_finite():
        return UNBOUNDED
    turns = round(float(periods.mid()))
    rest = u - turns * half_period
    if not abs(rest.real) < half_period:
        return UNBOUNDED
    return acb(near(rest, m).real) + turns * rise.real
