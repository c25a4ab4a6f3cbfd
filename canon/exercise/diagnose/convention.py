"""Conventions: answers wrong as a whole, by a sign convention, a common factor, a valence or a lost time derivative."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from sympy.core.function import AppliedUndef

from canon.exercise.diagnose.change import Change, Mistake
from canon.exercise.diagnose.diagnosis import Diagnosis, scaled
from canon.exercise.diagnose.effort import proved_to_vanish
from canon.exercise.diagnose.repairs.repair import common_ratio
from canon.mechanics.canonical.repair_hint import repair_hint
from canon.mechanics.canonical.transformation import CanonicalTransformation

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.exercise.diagnose.diagnosis import WrongAnswer
    from canon.exercise.question.question import Part
    from canon.exercise.sheet.reading import Reading
    from canon.mechanics.canonical.repair_hint import RepairHint

__all__ = [
    "factor",
    "lost_time_derivative",
    "one_rule",
    "opposite_sign",
    "rescaled",
    "valence",
    "variable_valence",
]


def opposite_sign(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield that all components have the opposite sign, where that is another convention."""
    reading, parts = wrong.reading, wrong.parts
    if reading.kind.opposite and _proved_factor(wrong) == -1:
        opposite = Change.of(Mistake.OPPOSITE_CONVENTION, reading.kind.opposite)
        yield Diagnosis((opposite,), scaled(reading, parts, sp.S.NegativeOne), only_fault=True)


def factor(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield the factor that the bilinear covariant has under a map."""
    reading, claimed = wrong.reading, wrong.parts[0].claimed
    if not reading.has("factor"):
        return
    ratio = _proved_factor(wrong)
    found = wrong.parts[0].right if ratio is None else ratio * claimed
    if not found.has(*reading.symbols("q"), *reading.symbols("p")):
        repaired = reading.with_instead("factor", found)
        yield Diagnosis.of(Mistake.FACTOR_OF_COVARIANT, found, claimed, repaired=repaired)


def valence(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield the valence of a map, or what makes it canonical, but for a valence that is rarely meant."""
    yield from _valence(wrong)
    mended = _mended(wrong.reading)
    if mended is not None and not _is_rarely_meant(mended):
        yield Diagnosis.stated(Mistake.MAP_MENDED, mended)


def variable_valence(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield that a map is canonical with a valence that depends on parameters, a thing rarely meant."""
    mended = _mended(wrong.reading)
    if mended is not None and _is_rarely_meant(mended):
        yield Diagnosis.stated(Mistake.MAP_MENDED, mended)


def _is_rarely_meant(mended: RepairHint) -> bool:
    return mended.valence is not None and not mended.valence.is_Rational


def _proved_factor(wrong: WrongAnswer) -> sp.Expr | None:
    """Return the constant c ≠ 0, 1 with c·claimed = right in every component, once that is proved."""
    ratio = common_ratio(wrong.parts, wrong.domain)
    if ratio is None or ratio in (0, 1):
        return None
    factor = sp.Rational(ratio.numerator, ratio.denominator)
    return factor if _proved(wrong.parts, factor, wrong) else None


def _proved(parts: Sequence[Part], factor: sp.Expr, wrong: WrongAnswer) -> bool:
    return all(_vanishes(factor * part.seen(part.claimed) - part.right, wrong) for part in parts)


def _vanishes(f: sp.Expr, wrong: WrongAnswer) -> bool:
    return f == 0 or proved_to_vanish(f, wrong.domain, wrong.effort)


def rescaled(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield that a generating function has a wrong factor."""
    reading, ratio = wrong.reading, _proved_factor(wrong)
    if ratio is not None:
        mistake, items = (Mistake.WRONG_SIGN, ()) if ratio == -1 else (Mistake.WRONG_FACTOR, (ratio,))
        repaired = reading.with_instead("F", ratio * reading.expression("F"))
        yield Diagnosis.of(mistake, *items, repaired=repaired, place="F")


def _valence(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    reading, parts, factor = wrong.reading, wrong.parts, _proved_factor(wrong)
    if factor is None or not parts[0].bracket_of:
        return
    wanted, found = parts[0].right, parts[0].right / factor
    name = parts[0].name
    if factor == -1:
        change = Change.of(Mistake.BRACKET_OPPOSITE, name, found, wanted)
    else:
        change = Change.of(Mistake.VALENCE, name, found, wanted, factor)
    repaired = reading
    for i, P in enumerate(reading.expressions("P")):
        repaired = repaired.with_instead(f"P[{i}]", factor * P)
    yield Diagnosis((change,), repaired)


def _mended(reading: Reading) -> RepairHint | None:
    if not reading.has("Q"):
        return None
    q, p = reading.phase_space("q", "p")
    Q, P = reading.expressions("Q", like="q"), reading.expressions("P", like="p")
    if any(f.has(AppliedUndef) for f in (*Q, *P)):
        return None  # arbitrary functions have no values at which a bracket could be looked at
    map_ = CanonicalTransformation(q, p, Q, P, reading.domain, reading.time)
    return repair_hint(map_, reading.expression("valence", sp.S.One))


def lost_time_derivative(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield that ∂F/∂t is missing in K, or stands there with the wrong sign."""
    parts = wrong.parts
    if parts[0].bracket_of:
        return  # the map itself is not canonical
    if _proved_factor(wrong) == -1:
        yield Diagnosis.stated(Mistake.TIME_DERIVATIVE_SIGN)
        return
    if _proved([part for part in parts if part.right != 0], sp.S.Zero, wrong):
        return
    still = (part.seen(part.claimed) for part in parts)
    if all(_vanishes(f, wrong) for f in still):
        yield Diagnosis.stated(Mistake.TIME_DERIVATIVE_MISSING)


def one_rule(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield that half of the rules of a generating function hold with the opposite sign."""
    parts = wrong.parts
    half = len(parts) // 2
    for right, other in ((parts[:half], parts[half:]), (parts[half:], parts[:half])):
        if _proved(right, sp.S.One, wrong) and _proved(other, sp.S.NegativeOne, wrong):
            yield Diagnosis.stated(Mistake.RULE_OPPOSITE, tuple(part.name for part in other))
            return
