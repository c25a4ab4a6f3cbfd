"""Incomplete integrals ½ ∫ f/p dq of known momenta p² = Σ c f(q): the derivatives of ∫ p dq by the coefficients c.

Each is counted from the lower turning point of a libration, or from q = 0 in a rotation, and comes with its whole value
(I. S. Gradshteyn, I. M. Ryzhik, Table of Integrals, 2.26; P. F. Byrd, M. D. Friedman, Handbook of Elliptic Integrals,
213, 218, 219). Arccosines run from 0 to π over a libration, amplitudes φ from −π/2 to π/2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Rational, Symbol, acos, elliptic_e, elliptic_f, elliptic_k, sqrt

from canon.mechanics.integrable.cycles import CycleKind

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from flint import arb

    from canon.mechanics.integrable.cycles import Cycle

__all__ = ["Incomplete", "integrals_by_terms"]


@dataclass(frozen=True)
class Incomplete:
    """An integral from the beginning of a cycle, and its value over the whole of one way.

    Parameters
    ----------
    part
        The integral up to q.
    whole
        The integral to the other turning point, or through the period of a rotation.
    """

    part: Expr
    whole: Expr

    def times(self, factor: Expr) -> Incomplete:
        """Return the multiple."""
        return Incomplete(factor * self.part, factor * self.whole)

    def plus(self, other: Incomplete) -> Incomplete:
        """Return the sum."""
        return Incomplete(self.part + other.part, self.whole + other.whole)

    def backwards(self) -> Incomplete:
        """Return the integral over the mirrored cycle, which is counted from its other end."""
        return Incomplete(self.whole - self.part, self.whole)


Integrals = dict[Expr, Incomplete]


def integrals_by_terms(
    name: str, A: Expr, terms: Mapping[Expr, Expr], q: Symbol, cycle: Cycle
) -> Integrals | None:
    """Return ½ ∫ f/p dq for 1 and each function f in p² = A + Σ c f, by the name of the known integral.

    None for names whose incomplete integrals are not known, and for cycles that the formulas are not meant for.
    """
    low = cast("tuple[arb, arb]", cycle.turning_points)[0] if cycle.kind is CycleKind.LIBRATION else None
    if name in _LIBRATIONS and low is not None:
        needs_positive, integrals = _LIBRATIONS[name]
        return None if needs_positive and not low > 0 else integrals(A, terms, q)
    if name == "pendulum, libration":
        return _pendulum(A, terms, q, cycle)
    if name == "pendulum, rotation":
        return _rotating_pendulum(A, terms, q, cycle)
    return None


def _quadratic(A: Expr, B: Expr, C: Expr, x: Expr) -> tuple[Incomplete, Incomplete]:
    """Return ∫ dx/√R and ∫ x dx/√R between the zeros of R = A + B x + C x², C < 0."""
    arc = Incomplete(acos((2 * C * x + B) / sqrt(B**2 - 4 * A * C)), sp.pi).times(1 / sqrt(-C))
    edge = Incomplete(sqrt(A + B * x + C * x**2) / C, sp.S.Zero)
    return arc, edge.plus(arc.times(-B / (2 * C)))


def _inverse(A: Expr, B: Expr, C: Expr, x: Expr) -> Incomplete:
    """Return ∫ dx/(x √R) between positive zeros of R = A x² + B x + C, C < 0."""
    return Incomplete(acos((-2 * C - B * x) / (x * sqrt(B**2 - 4 * A * C))), sp.pi).times(1 / sqrt(-C))


def _oscillator(A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> Integrals:
    B, C = terms.get(q, sp.S.Zero), terms[q**2]
    arc, first = _quadratic(A, B, C, q)
    return {sp.S.One: arc.times(Rational(1, 2)), q: first.times(Rational(1, 2))}


def _kepler(A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> Integrals:
    B, C = terms[1 / q], terms[q**-2]
    arc, first = _quadratic(C, B, A, q)
    inverse = _inverse(A, B, C, q)
    half = Rational(1, 2)
    return {sp.S.One: first.times(half), 1 / q: arc.times(half), q**-2: inverse.times(half)}


def _radial_oscillator(A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> Integrals:
    """With x = q² it is Kepler's integral."""
    wall, spring, quarter = terms[q**-2], terms[q**2], Rational(1, 4)
    arc, first = _quadratic(wall, A, spring, q**2)
    inverse = _inverse(spring, A, wall, q**2)
    return {sp.S.One: arc.times(quarter), q**2: first.times(quarter), q**-2: inverse.times(quarter)}


def _morse(A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> Integrals:
    """With x = exp(±a q) it is Kepler's integral, run through backwards where the exponent falls."""
    rates = {cast("Expr", f.args[0]).diff(q): f for f in terms}
    rate = next(r for r in rates if 2 * r in rates)
    B, C, x = terms[rates[rate]], terms[rates[2 * rate]], rates[rate]
    arc, first = _quadratic(A, B, C, x)
    inverse = _inverse(C, B, A, x)
    found = {sp.S.One: inverse, x: arc, rates[2 * rate]: first}
    scaled = {f: each.times(1 / (2 * sp.Abs(rate))) for f, each in found.items()}
    return {f: each.backwards() for f, each in scaled.items()} if rate.is_negative else scaled


def _polar_angle(A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> Integrals | None:
    ((f, C),) = terms.items()
    base = f.as_base_exp()[0]
    a = cast("Expr", base.args[0]).diff(q)
    if base not in (sp.sin(a * q), sp.cos(a * q)) or not a.is_positive:
        return None
    cosine, cotangent = sp.cos(a * q), sp.cot(a * q)
    if isinstance(base, sp.cos):
        cosine, cotangent = -sp.sin(a * q), -sp.tan(a * q)
    arc = Incomplete(acos(cosine * sqrt(A / (A + C))) / sqrt(A), sp.pi / sqrt(A))
    cross = Incomplete(acos(cotangent * sqrt(-C / (A + C))) / sqrt(-C), sp.pi / sqrt(-C))
    return {sp.S.One: arc.times(1 / (2 * a)), f: cross.times(1 / (2 * a))}


def _poeschl_teller(A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> Integrals | None:
    ((f, C),) = terms.items()
    u = cast("Expr", f.as_base_exp()[0].args[0])
    a = u.diff(q)
    if not a.is_positive:
        return None
    arc = Incomplete(acos(-sp.sinh(u) * sqrt(-A / (A + C))) / sqrt(-A), sp.pi / sqrt(-A))
    cross = Incomplete(acos(-sp.tanh(u) * sqrt(C / (A + C))) / sqrt(C), sp.pi / sqrt(C))
    return {sp.S.One: arc.times(1 / (2 * a)), f: cross.times(1 / (2 * a))}


def _isochrone(A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> Integrals:
    """With s = √(b² + r²), r dr = s ds, R = r² p² is quadratic in s, and r² = (s − b)(s + b)."""
    C = terms[q**-2]
    f = next(f for f in terms if f != q**-2)
    B, b = terms[f], (1 / f).subs(q, 0) / 2
    s = sqrt(b**2 + q**2)
    arc, first = _quadratic(-A * b**2 - B * b + C, B, A, s)
    inner = _inverse(A, B + 2 * A * b, C, s - b)
    outer = _inverse(A, B - 2 * A * b, C - 2 * B * b, s + b)
    half, quarter = Rational(1, 2), Rational(1, 4)
    return {
        sp.S.One: first.times(half),
        f: arc.plus(outer.times(-b)).times(half),
        q**-2: inner.plus(outer).times(quarter),
    }


def _elliptic(phi: Expr, m: Expr) -> tuple[Incomplete, Incomplete]:
    """Return F and E from φ = −π/2."""
    K, E = elliptic_k(m), elliptic_e(m)
    return Incomplete(elliptic_f(phi, m) + K, 2 * K), Incomplete(elliptic_e(phi, m) + E, 2 * E)


def _quartic_well(A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> Integrals:
    """With q = −a cos φ, a² = −(B + R)/(2 C), R² = B² − 4 A C."""
    B, C = terms[q**2], terms[q**4]
    R = sqrt(B**2 - 4 * A * C)
    m = (R + B) / (2 * R)
    F, E = _from_zero(acos(-q * sqrt(-2 * C / (B + R))), m)
    square = E.plus(F.times(m - 1)).times(R / -C)
    scale = 1 / (2 * sqrt(R))
    return {sp.S.One: F.times(scale), q**2: square.times(scale)}


def _from_zero(phi: Expr, m: Expr) -> tuple[Incomplete, Incomplete]:
    """Return F and E from φ = 0 to π."""
    return (
        Incomplete(elliptic_f(phi, m), 2 * elliptic_k(m)),
        Incomplete(elliptic_e(phi, m), 2 * elliptic_e(m)),
    )


def _soft_quartic_well(A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> Integrals:
    """With q = a sin φ, a² = (R − B)/(2 C) − R/C, b² = (R − B)/(2 C)."""
    B, C = terms[q**2], terms[q**4]
    R = sqrt(B**2 - 4 * A * C)
    m = (B + R) / (B - R)
    F, E = _elliptic(sp.asin(q * sqrt(2 * C / (-B - R))), m)
    over_b = sqrt(2 / (R - B))  # 1/(b √C)
    square = F.plus(E.times(sp.S.NegativeOne)).times((R - B) / (2 * C))
    return {sp.S.One: F.times(over_b / 2), q**2: square.times(over_b / 2)}


def _one_of_two_wells(A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> Integrals:
    """With q² = a² (1 − m sin² φ), a² = −(B + R)/(2 C), counted from the outer turning point."""
    B, C = terms[q**2], terms[q**4]
    R = sqrt(B**2 - 4 * A * C)
    a2, m = -(B + R) / (2 * C), 2 * R / (B + R)
    phi = sp.asin(sqrt((a2 - q**2) / (a2 * m)))
    F = Incomplete(elliptic_f(phi, m), elliptic_k(m)).backwards()
    E = Incomplete(elliptic_e(phi, m), elliptic_e(m)).backwards()
    scale = 1 / (2 * sqrt(-C))
    return {sp.S.One: F.times(scale / sqrt(a2)), q**2: E.times(scale * sqrt(a2))}


def _pendulum(A: Expr, terms: Mapping[Expr, Expr], q: Symbol, cycle: Cycle) -> Integrals | None:
    """With sin(q/2) = k sin φ about the lowest place, k² = (A + |B|)/(2 |B|); None for a libration a turn away."""
    ((f, B),) = terms.items()
    beta = sp.Abs(B)
    m = (A + beta) / (2 * beta)
    low, high = cast("tuple[arb, arb]", cycle.turning_points)
    middle = float(low + high) / 2
    if abs(middle) < 1e-6:
        sine, sign = sp.sin(q / 2), 1
    elif abs(middle - float(sp.pi)) < 1e-6:
        sine, sign = -sp.cos(q / 2), -1
    else:
        return None
    F, E = _elliptic(sp.asin(sine / sqrt(m)), m)
    scale = 1 / sqrt(2 * beta)
    cosine = E.times(sp.Integer(2)).plus(F.times(sp.S.NegativeOne)).times(sp.Integer(sign))
    return {sp.S.One: F.times(scale), f: cosine.times(scale)}


def _rotating_pendulum(A: Expr, terms: Mapping[Expr, Expr], q: Symbol, cycle: Cycle) -> Integrals | None:
    """The amplitude is half the angle from the lowest place, m = 2 |B|/(A + |B|)."""
    ((f, B),) = terms.items()
    if B.is_negative is None and B.is_positive is None:
        return None
    sign = 1 if B.is_positive else -1
    m = 2 * sp.Abs(B) / (A + sp.Abs(B))
    F, E = _from_zero(q / 2, m) if sign > 0 else _elliptic((q - sp.pi) / 2, m)
    scale = cycle.sign / sqrt(A + sp.Abs(B))
    cosine = F.plus(F.plus(E.times(sp.S.NegativeOne)).times(-2 / m)).times(sp.Integer(sign))
    return {sp.S.One: F.times(scale), f: cosine.times(scale)}


_LIBRATIONS: dict[str, tuple[bool, Callable[[Expr, Mapping[Expr, Expr], Symbol], Integrals | None]]] = {
    "oscillator": (False, _oscillator),
    "Kepler": (True, _kepler),
    "radial oscillator": (True, _radial_oscillator),
    "Morse": (False, _morse),
    "polar angle": (False, _polar_angle),
    "Pöschl–Teller": (False, _poeschl_teller),
    "isochrone": (True, _isochrone),
    "quartic well": (False, _quartic_well),
    "soft quartic well": (False, _soft_quartic_well),
    "double well, on one side": (True, _one_of_two_wells),
}
"""The integrals of librations by name, and whether the formulas are meant for positive q alone."""
