"""Answers wrong as a whole: another sign convention, a common factor, a valence, a lost time derivative."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.repair import common_ratio
from canon.exercise.variants import times
from canon.mechanics.mending import mending
from canon.mechanics.transformation import CanonicalTransformation
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.exercise.question import Part
    from canon.exercise.reading import Reading
    from canon.proof.domain import Domain

__all__ = ["convention"]

PROOF_SECONDS = 0.5
_BRACKETS = {
    "poisson-bracket": "the convention here is {q, p} = +1",
    "lagrange-bracket": "the convention here is [u, v] = Σ (∂q/∂u ∂p/∂v − ∂q/∂v ∂p/∂u)",
    "lie-bracket": "the convention here is [X, Y] = X·∇Y − Y·∇X",
}


def convention(reading: Reading, parts: Sequence[Part], domain: Domain) -> str:
    """Return what is wrong with all components together, if it is one thing and that was proved."""
    kind = reading.claim.kind
    if kind == "transformed-hamiltonian-K":
        return _time_derivative(parts, domain)
    if kind.startswith("canonicity"):
        return _valence(parts, domain) or _mended(reading)
    if kind.startswith("generating"):
        return _whole(parts, domain, "F") or _one_rule(parts, domain)
    if kind == "bilinear-covariant" and reading.has("factor"):
        return _factor(parts, domain)
    if kind in _BRACKETS and _proved_factor(parts, domain) == -1:
        return f"right under the opposite sign convention; {_BRACKETS[kind]}"
    if kind == "routhian" and _proved_factor(parts, domain) == -1:
        return "right under the opposite convention: R has the other sign here"
    return ""


def _proved_factor(parts: Sequence[Part], domain: Domain) -> sp.Expr | None:
    """Return the constant c ≠ 0, 1 with c·claimed = right in every component, once that is proved."""
    ratio = common_ratio(parts, domain)
    if ratio is None or ratio in (0, 1):
        return None
    factor = sp.Rational(ratio.numerator, ratio.denominator)
    return factor if _proved(parts, factor, domain) else None


def _proved(parts: Sequence[Part], factor: sp.Expr, domain: Domain) -> bool:
    residuals = (factor * part.seen(part.claimed) - part.right for part in parts)
    return all(r == 0 or vanishes(r, domain, budget=PROOF_SECONDS).holds for r in residuals)


def _whole(parts: Sequence[Part], domain: Domain, name: str) -> str:
    factor = _proved_factor(parts, domain)
    if factor is None:
        return ""
    return f"{name} has the wrong sign" if factor == -1 else f"{name} should be {times(factor)} what it is"


def _valence(parts: Sequence[Part], domain: Domain) -> str:
    factor = _proved_factor(parts, domain)
    if factor is None or not parts[0].name.startswith("{"):
        return ""
    wanted, found = parts[0].right, parts[0].right / factor
    if factor == -1:
        return f"{parts[0].name} = {found}, not {wanted}: exchange Q and P, or change the sign of one of them"
    return f"canonical with valence {found}, not {wanted}: {parts[0].name} = {found}; multiply P by {factor}"


def _mended(reading: Reading) -> str:
    if not reading.has("Q"):
        return ""
    q, p = reading.phase_space("q", "p")
    Q, P = reading.expressions("Q", like="q"), reading.expressions("P", like="p")
    map_ = CanonicalTransformation(q, p, Q, P, reading.time, reading.domain)
    return mending(map_, reading.expression("valence", sp.S.One))


def _factor(parts: Sequence[Part], domain: Domain) -> str:
    factor = _proved_factor(parts, domain)
    return "" if factor is None else f"the factor is {parts[0].right / factor}, not {parts[0].right}"


def _time_derivative(parts: Sequence[Part], domain: Domain) -> str:
    if parts[0].name.startswith("{"):
        return ""  # the map itself is not canonical
    if _proved_factor(parts, domain) == -1:
        return "the sign of ∂F/∂t in K is wrong: K = H + ∂F/∂t"
    if _proved([part for part in parts if part.right != 0], sp.S.Zero, domain):
        return ""
    still = (part.seen(part.claimed) for part in parts)
    if all(f == 0 or vanishes(f, domain, budget=PROOF_SECONDS).holds for f in still):
        return "K is H in the new variables; ∂F/∂t is missing: K = H + ∂F/∂t"
    return ""


def _one_rule(parts: Sequence[Part], domain: Domain) -> str:
    half = len(parts) // 2
    for right, other in ((parts[:half], parts[half:]), (parts[half:], parts[:half])):
        if _proved(right, sp.S.One, domain) and _proved(other, sp.S.NegativeOne, domain):
            return (
                f"right under the opposite sign of a rule: here {' and '.join(part.name for part in other)}"
            )
    return ""
