"""Claims about rational transfer functions: positive real, and therefore passive, or not.

H = n/d with n, d coprime is positive real exactly where n + d has all its zeros in Re s < 0 and
Re n(jω) d(−jω) ≥ 0 for every ω: then (H − 1)/(H + 1) is bounded by 1 in the right half plane (A. Talbot, in
Recent Developments in Network Theory, Pergamon 1963; B. D. O. Anderson, S. Vongpanitlerd, Network Analysis and
Synthesis, § 2.7). A linear system with a rational H is passive exactly where H is positive real.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Rational, Symbol

from canon.exercise.question.question import Question, Stated
from canon.mechanics.algebra.substitution import exchanged, symbols_of
from canon.proof.analytic import proved_sign
from canon.proof.domain.verdict import Counterexample, Status, Undecided, Verdict
from canon.proof.kinks import OffKinks, off_kinks

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain

__all__ = ["is_positive_real_at", "positive_real"]

POINTS = 24
MOST_DEGREE = 12
_WORDS = ("positive-real", "passive", "not positive-real", "not passive")


@dataclass(frozen=True)
class _Fault:
    """Why a function with numbers for coefficients is not positive real."""

    feedback: str
    place: str
    value: str


def positive_real(reading: Reading) -> Iterator[Question]:
    """H is positive real for all values of the parameters, or for none."""
    words = reading.words("is")
    for i, word in enumerate(words):
        if word not in _WORDS:
            reading.fault(f"is[{i}]", f"should be one of {', '.join(_WORDS)}")
    if len(reading.symbols("variables")) != 1:
        reading.fault("variables", "should be one name, that of the complex frequency")
    (s,) = reading.symbols("variables")
    above, below = _polynomials(reading, s)
    off = off_kinks([above.as_expr(), below.as_expr()], reading.domain)
    for word in words:
        yield Stated(_judged(above, below, s, off, negated=word.startswith("not")).about(word))


def is_positive_real_at(above: sp.Poly, below: sp.Poly) -> _Fault | None:
    """Return why n/d, with rational coefficients, is not positive real; None where it is.

    Examples
    --------
    >>> s = sp.Symbol("s")
    >>> is_positive_real_at(sp.Poly(s, s), sp.Poly(s**2 + 3*s + 1, s)) is None
    True
    >>> is_positive_real_at(sp.Poly(1, s), sp.Poly(s**2 + 3*s + 1, s)).feedback
    'Re H(jω) < 0 for some ω'
    """
    (s,) = below.gens
    common = sp.gcd(above, below)
    above, below = (sp.Poly(sp.quo(f, common), s, domain="QQ") for f in (above, below))
    real = _real_part(above, below)
    for w in _between_roots(real):
        if _at(real, w).is_negative:
            value = _at(real, w) / _at(_real_part(below, below), w)
            return _Fault("Re H(jω) < 0 for some ω", f"j*sqrt({w})", str(sp.N(value, 15)))
    if not _is_hurwitz(above + below):
        why = (
            "H has a pole with Re s > 0, or one on the axis that is multiple or whose residue is not positive"
        )
        return _Fault(why, "a zero of H + 1 with Re s ≥ 0", "-1")
    return None


def _judged(above: sp.Poly, below: sp.Poly, s: Symbol, off: OffKinks, *, negated: bool) -> Verdict:
    parameters = [x for x in symbols_of(above.as_expr(), below.as_expr()) if x != s]
    for point in off.strictly.points(parameters, POINTS, seed=5) if parameters else ({},):
        pair = [sp.Poly(exchanged(f.as_expr(), point), s) for f in (above, below)]
        if pair[1].is_zero or not all(c.is_Rational for f in pair for c in f.all_coeffs()):
            continue
        fault = is_positive_real_at(*(sp.Poly(f, s, domain="QQ") for f in pair))
        if (fault is None) == negated:
            return _refuted(point, fault, str(s))
        if not parameters:
            return Verdict(Status.HOLDS, certificate="exact")
    return _proved(above, below, off.domain, negated=negated, has_parameters=bool(parameters))


def _proved(
    above: sp.Poly, below: sp.Poly, domain: Domain, *, negated: bool, has_parameters: bool
) -> Verdict:
    always, never = (partial(proof, above, below, domain) for proof in (_always, _never))
    claimed, opposite = (never, always) if negated else (always, never)
    if claimed():
        return Verdict(Status.HOLDS, certificate="exact")
    if opposite():
        why = "H is positive real" if negated else "Re H(jω) < 0 for some ω"
        return Verdict(Status.FAILS, certificate="exact", feedback=why)
    if not has_parameters:
        raise Undecided("H holds numbers that are not rational; write names for them, and say their signs")
    raise Undecided(
        f"no counterexample at {POINTS} values of the parameters, and no proof for all of them; "
        "say their signs, or give some of them as numbers"
    )


def _refuted(point: Mapping[Symbol, Rational], fault: _Fault | None, s: str) -> Verdict:
    there = {x.name: str(value) for x, value in point.items()}
    if fault is None:
        why = "H is positive real" + (" for some values of the parameters" if point else "")
        return Verdict(Status.FAILS, certificate="exact", feedback=why)
    example = Counterexample({**there, s: fault.place}, fault.value, "0", 15)
    return Verdict(Status.FAILS, certificate="exact", counterexample=example, feedback=fault.feedback)


def _polynomials(reading: Reading, s: Symbol) -> tuple[sp.Poly, sp.Poly]:
    H = reading.expression("H")
    above, below = sp.fraction(sp.cancel(sp.together(H)))
    try:
        pair = [sp.Poly(f, s) for f in (above, below)]
    except sp.PolynomialError:
        pair = []
    if not pair or any(c.has(s, sp.I) for f in pair for c in f.all_coeffs()):
        reading.fault("H", f"should be a quotient of polynomials in {s} with real coefficients")
    if max(f.degree() for f in pair) > MOST_DEGREE:
        reading.fault("H", f"has a degree above {MOST_DEGREE}")
    return pair[0], pair[1]


def _real_part(above: sp.Poly, below: sp.Poly) -> sp.Poly:
    """Return Re n(jω) d(−jω) as a polynomial in w = ω²."""
    w = sp.Dummy("w", nonnegative=True)

    def split(f: sp.Poly) -> tuple[Expr, Expr]:
        """Return a, b with f(jω) = a(w) + jω b(w)."""
        even = odd = sp.S.Zero
        for k, c in enumerate(reversed(f.all_coeffs())):
            term = (-1) ** (k // 2) * c * w ** (k // 2)
            even, odd = (even + term, odd) if k % 2 == 0 else (even, odd + term)
        return even, odd

    (a, b), (c, d) = split(above), split(below)
    return sp.Poly(sp.expand(a * c + w * b * d), w)


def _at(f: sp.Poly, w: Expr) -> Expr:
    return cast("Expr", f.eval(w))


def _coefficients(f: sp.Poly) -> list[Expr]:
    """Return the coefficients, that of the highest power first."""
    return cast("list[Expr]", f.all_coeffs())


def _between_roots(f: sp.Poly) -> list[Expr]:
    """Return 0 and a rational point in each interval of w > 0 on which f keeps its sign."""
    if f.is_zero or f.degree() == 0:
        return [sp.S.Zero]
    edges = _isolated(f)
    gaps = [(left + right) / 2 for (_, left), (right, _) in pairwise(edges)]
    return [sp.S.Zero, *gaps, (edges[-1][1] if edges else sp.S.Zero) + 1]


def _isolated(f: sp.Poly) -> list[tuple[Expr, Expr]]:
    """Return an interval around each zero w ≥ 0, in order, with room between any two."""
    width = sp.S.One
    while True:
        found = cast("list[tuple[tuple[Expr, Expr], int]]", f.sqf_part().intervals(inf=0, eps=width))
        edges = [ends for ends, _ in found]
        if all(bool(left < right) for (_, left), (right, _) in pairwise(edges)):
            return edges
        width /= 16


def _is_hurwitz(f: sp.Poly) -> bool:
    """Tell whether all zeros have Re s < 0, by Routh's array; a zero in its first column says no."""
    top, next_ = _coefficients(f)[::2], _coefficients(f)[1::2]
    sign = sp.sign(top[0])
    for _ in range(int(f.degree())):
        if not next_ or next_[0] == 0 or sp.sign(next_[0]) != sign:
            return False
        padded = [*next_, *[sp.S.Zero] * (len(top) - len(next_))]
        after = [
            (next_[0] * top[i + 1] - top[0] * (padded[i + 1] if i + 1 < len(padded) else 0)) / next_[0]
            for i in range(len(top) - 1)
        ]
        top, next_ = next_, after
    return True


def _always(above: sp.Poly, below: sp.Poly, domain: Domain) -> bool:
    """Prove both conditions for all values of the parameters."""
    return _hurwitz_for_all(above + below, domain) and _nonnegative(_real_part(above, below), domain)


def _never(above: sp.Poly, below: sp.Poly, domain: Domain) -> bool:
    """Prove Re H(jω) < 0 at ω → 0 or at ω → ∞, for all values of the parameters."""
    signs = [proved_sign(c, domain) for c in _coefficients(_real_part(above, below))]
    return "-" in (signs[0], signs[-1])


def _hurwitz_for_all(f: sp.Poly, domain: Domain) -> bool:
    coefficients = _coefficients(f)
    if proved_sign(coefficients[0], domain) == "-":
        coefficients = [-c for c in coefficients]
    if any(proved_sign(c, domain) != "+" for c in coefficients):
        return False
    n = len(coefficients) - 1

    def minor(k: int) -> Expr:
        """Return the determinant of Hurwitz of order k."""
        places = [[2 * j - i + 1 for j in range(k)] for i in range(k)]
        rows = [[coefficients[m] if 0 <= m <= n else sp.S.Zero for m in row] for row in places]
        return cast("Expr", sp.expand(sp.Matrix(rows).det(method="berkowitz")))

    return all(proved_sign(minor(k), domain) == "+" for k in range(2, n))


def _nonnegative(f: sp.Poly, domain: Domain) -> bool:
    """Prove f(w) ≥ 0 for w ≥ 0."""
    signs = {proved_sign(c, domain) for c in _coefficients(f) if c != 0}
    if signs <= {"+", "0+"}:
        return True
    if f.degree() == 2:
        a, b, c = _coefficients(f)
        inside = proved_sign(sp.expand(4 * a * c - b**2), domain) in ("+", "0+")
        return inside and proved_sign(a, domain) in ("+", "0+") and proved_sign(c, domain) in ("+", "0+")
    return proved_sign(f.as_expr(), domain) in ("+", "0+")
