"""Dimensional analysis of a wrong answer: terms that can't be added, arguments that are no numbers, another dimension.

It decides nothing: a verdict is proved by algebra. It is told of components only that are certainly wrong, and where
the dimensions of everything that matters are declared; a term that may vanish has any dimension, and is left aside.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.exercise.diagnose.change import Change, Mistake
from canon.exercise.diagnose.proved_share import components_of
from canon.exercise.diagnose.repairs.component_screen import Screen
from canon.exercise.question.declared_dimensions import declared_dimensions
from canon.exercise.question.expression_dimension import Clash, analysed, dimension_of
from canon.exercise.question.question import Part

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr

    from canon.exercise.sheet.quantities.dimension_texts import Dimension
    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain

__all__ = ["impossible_dimensions"]


def impossible_dimensions(
    reading: Reading, parts: Sequence[Part], domain: Domain, most: int
) -> tuple[Change, ...]:
    """Return what is dimensionally impossible in a wrong answer, one thing of each component.

    Parameters
    ----------
    reading
        A claim that fails.
    parts, domain
        What was compared when it did, and where.
    most
        How many components are told of.
    """
    known = declared_dimensions(reading)
    found: list[Change] = []
    for name, claimed, right in _wrong(reading, parts, domain) if known else ():
        change = _of_a_component(name, claimed, right, known, domain)
        if change is not None:
            found.append(change)
    return tuple(found[:most])


def _wrong(
    reading: Reading, parts: Sequence[Part], domain: Domain
) -> Iterator[tuple[str, Expr, Expr | None]]:
    """Yield the components that are certainly wrong: name, as it was written, and what would be right where known."""
    answers = dict(components_of(reading))
    seen = (_answered(part) if reading.kind.two_sided else part for part in parts)
    compared = [part for part in seen if part.key in answers]
    for part in compared:
        if _is_refuted(part, domain):
            yield part.name, answers[part.key], part.right if part.right != 0 else None
    if not compared and len(answers) == 1:
        yield from ((key.partition("[")[0], claimed, None) for key, claimed in answers.items())


def _answered(part: Part) -> Part:
    """Return the comparison of two sides as one of the right side, which is the answer."""
    return Part("rhs", part.right, part.claimed, key="rhs") if part.key == "lhs" else part


def _of_a_component(
    name: str, claimed: Expr, right: Expr | None, known: Mapping[str, Dimension], domain: Domain
) -> Change | None:
    place = "" if name == "claim" else name
    for clash in analysed(claimed, known):
        change = _told(clash, domain)
        if change is not None:
            return change.at(place)
    here = dimension_of(claimed, known)
    there = None if right is None else dimension_of(right, known)
    if here is None or there is None or here == there or not _is_somewhere(claimed, domain):
        return None
    return Change.of(Mistake.DIMENSION_OF_ANSWER, here, there, place=place)


def _told(clash: Clash, domain: Domain) -> Change | None:
    """Return the change that a clash is, None where what clashes may vanish."""
    parts = tuple((part, dimension) for part, dimension in clash.parts if _is_somewhere(part, domain))
    if not clash.is_of_a_sum:
        return Change.of(Mistake.NO_NUMBER, clash.node, *parts[0]) if parts else None
    groups: dict[Dimension, list[Expr]] = {}
    for part, dimension in parts:
        groups.setdefault(dimension, []).append(part)
    if len(groups) < 2:
        return None
    fewest_first = sorted(groups.items(), key=lambda item: len(item[1]))
    all_told = clash.all_decided and len(parts) == len(clash.parts)
    items = ((tuple(terms), dimension) for dimension, terms in fewest_first)
    return Change.of(Mistake.TERMS_OF_OTHER_DIMENSION, all_told, *items)


def _is_refuted(part: Part, domain: Domain) -> bool:
    """Whether balls exclude that a component is right, at a point of the domain."""
    values = Screen(part, domain).residual
    return values is not None and any(not z.contains(0) for z in values)


def _is_somewhere(f: Expr, domain: Domain) -> bool:
    """Whether an expression certainly does not vanish identically."""
    return _is_refuted(Part("", f), domain)
