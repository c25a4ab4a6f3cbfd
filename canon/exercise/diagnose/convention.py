"""Answers wrong as a whole: another sign convention, a common factor, a valence, a lost time derivative."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import sympy as sp
from sympy.core.function import AppliedUndef

from canon.exercise.diagnose.diagnosis import Diagnosis, scaled
from canon.exercise.diagnose.repair import common_ratio
from canon.exercise.diagnose.slips import times
from canon.mechanics.canonical.repair_hint import mending
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.exercise.question.question import Part
    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain

__all__ = ["convention", "variable_valence"]

PROOF_SECONDS = 0.5
_VARIABLE_VALENCE = re.compile(r"canonical with valence [^;]*[A-Za-z_]")
_BRACKETS = {
    "poisson-bracket": "the convention here is {q, p} = +1",
    "lagrange-bracket": "the convention here is [u, v] = Σ (∂q/∂u ∂p/∂v − ∂q/∂v ∂p/∂u)",
    "lie-bracket": "the convention here is [X, Y] = X·∇Y − Y·∇X",
}


def convention(reading: Reading, parts: Sequence[Part], domain: Domain) -> Iterator[Diagnosis]:
    """Yield what is wrong with all components together, if it is one thing and that was proved."""
    kind = reading.claim.kind
    if kind == "transformed-hamiltonian-K":
        yield from _stated(_time_derivative(parts, domain))
        return
    if kind.startswith("canonicity"):
        yield from _valence(reading, parts, domain)
        mended = _mended(reading)
        if not _VARIABLE_VALENCE.search(mended):
            yield from _stated(mended)
        return
    if kind.startswith("generating"):
        yield from _rescaled(reading, parts, domain)
        yield from _stated(_one_rule(parts, domain))
        return
    factor = _proved_factor(parts, domain)
    if kind == "bilinear-covariant" and reading.has("factor"):
        found = parts[0].right if factor is None else factor * parts[0].claimed
        if not found.has(*reading.symbols("q"), *reading.symbols("p")):
            sentence = f"the factor is {found}, not {parts[0].claimed}"
            yield Diagnosis(sentence, reading.with_instead("factor", found))
    elif factor is None:
        return
    elif kind in _BRACKETS and factor == -1:
        sentence = f"right under the opposite sign convention; {_BRACKETS[kind]}"
        yield Diagnosis(sentence, scaled(reading, parts, factor), only_fault=True)
    elif kind == "routhian" and factor == -1:
        sentence = "right under the opposite convention: R has the other sign here"
        yield Diagnosis(sentence, scaled(reading, parts, factor), only_fault=True)


def variable_valence(reading: Reading) -> Iterator[Diagnosis]:
    """Yield that a map is canonical with a valence that depends on parameters, a thing rarely meant."""
    mended = _mended(reading) if reading.claim.kind.startswith("canonicity") else ""
    if _VARIABLE_VALENCE.search(mended):
        yield from _stated(mended)


def _stated(sentence: str) -> Iterator[Diagnosis]:
    """Yield a sentence that was proved of the question on which the claim turned."""
    if sentence:
        yield Diagnosis(sentence, only_fault=True)


def _proved_factor(parts: Sequence[Part], domain: Domain) -> sp.Expr | None:
    """Return the constant c ≠ 0, 1 with c·claimed = right in every component, once that is proved."""
    ratio = common_ratio(parts, domain)
    if ratio is None or ratio in (0, 1):
        return None
    factor = sp.Rational(ratio.numerator, ratio.denominator)
    return factor if _proved(parts, factor, domain) else None


def _proved(parts: Sequence[Part], factor: sp.Expr, domain: Domain) -> bool:
    residuals = (factor * part.seen(part.claimed) - part.right for part in parts)
    return all(r == 0 or vanishes_off_kinks(r, domain, budget=PROOF_SECONDS).holds for r in residuals)


def _rescaled(reading: Reading, parts: Sequence[Part], domain: Domain) -> Iterator[Diagnosis]:
    factor = _proved_factor(parts, domain)
    if factor is not None:
        sentence = "F has the wrong sign" if factor == -1 else f"F should be {times(factor)} what it is"
        yield Diagnosis(sentence, reading.with_instead("F", factor * reading.expression("F")))


def _valence(reading: Reading, parts: Sequence[Part], domain: Domain) -> Iterator[Diagnosis]:
    factor = _proved_factor(parts, domain)
    if factor is None or not parts[0].name.startswith("{"):
        return
    wanted, found = parts[0].right, parts[0].right / factor
    name = parts[0].name
    if factor == -1:
        sentence = f"{name} = {found}, not {wanted}: exchange Q and P, or change the sign of one of them"
    else:
        sentence = f"canonical with valence {found}, not {wanted}: {name} = {found}; multiply P by {factor}"
    repaired = reading
    for i, P in enumerate(reading.expressions("P")):
        repaired = repaired.with_instead(f"P[{i}]", factor * P)
    yield Diagnosis(sentence, repaired)


def _mended(reading: Reading) -> str:
    if not reading.has("Q"):
        return ""
    q, p = reading.phase_space("q", "p")
    Q, P = reading.expressions("Q", like="q"), reading.expressions("P", like="p")
    if any(f.has(AppliedUndef) for f in (*Q, *P)):
        return ""  # arbitrary functions have no values at which a bracket could be looked at
    map_ = CanonicalTransformation(q, p, Q, P, reading.time, reading.domain)
    return mending(map_, reading.expression("valence", sp.S.One))


def _time_derivative(parts: Sequence[Part], domain: Domain) -> str:
    if parts[0].name.startswith("{"):
        return ""  # the map itself is not canonical
    if _proved_factor(parts, domain) == -1:
        return "the sign of ∂F/∂t in K is wrong: K = H + ∂F/∂t"
    if _proved([part for part in parts if part.right != 0], sp.S.Zero, domain):
        return ""
    still = (part.seen(part.claimed) for part in parts)
    if all(f == 0 or vanishes_off_kinks(f, domain, budget=PROOF_SECONDS).holds for f in still):
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
