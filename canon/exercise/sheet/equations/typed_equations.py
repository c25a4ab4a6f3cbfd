"""Typed equations: a list of them as people write it, numbers beside them, several in one text, chains taken apart.

``d/dt(∂L/∂θ̇) - ∂L/∂θ = m l² θ̈ + m g l sin θ = 0`` says where its last equation comes from; alone, Lagrange's equation
is true of every system, and no answer. ``m r² φ̇ = const.`` says that its rate along the motion is zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from canon.exercise.sheet import field_texts
from canon.exercise.sheet.equations.defined_vectors import without_defined_vectors
from canon.exercise.sheet.equations.equation_numbers import without_numbers
from canon.exercise.sheet.equations.matrix_products import equations_of_products
from canon.exercise.sheet.equations.vector_equations import vector_equations
from canon.exercise.sheet.left_sides import is_definition
from canon.exercise.sheet.quantities.given_functions import key_at
from canon.exercise.sheet.quantities.known_vectors import vectors_in
from canon.expression.text.notation import is_latex

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.exercise.sheet.equations.sides import Sides
    from canon.expression.text.statement import Side, Statement

__all__ = ["typed_equations"]


def typed_equations(place: str, value: Any, known: Sides) -> list[Any]:
    """Return a list of equations, chains taken apart, each in a text of its own.

    Parameters
    ----------
    place
        Where they stand in the claim.
    value
        One text or a list of texts.
    known
        What is known of their sides.

    Raises
    ------
    Exception
        What ``known.fault`` makes, of a text that says nothing or can't be taken apart.
    """
    texts: list[Any] = value if isinstance(value, list) else [value]
    texts = without_numbers(texts) if all(type(text) is str for text in texts) else texts
    if len(texts) == 1 and isinstance(texts[0], str):
        text = texts[0]
        texts = vector_equations(text) or field_texts.equations_listed(text) or _products(place, text, known)
    return [each for i, text in enumerate(texts) for each in _of_text(f"{place}[{i}]", text, known)]


def _of_text(place: str, text: Any, known: Sides) -> list[Any]:
    """Return the equations of one text; what in it is true of every system is passed over beside them."""
    statements = known.statements(place, text) if isinstance(text, str) else ()
    if not isinstance(text, str) or _is_plain(statements, known):
        return [text]
    others = (
        statements if len(statements) == 1 else [s for s in statements if not known.given(place).restates(s)]
    )
    said = [
        _conserved(place, statement.sides, known)
        if key_at(place) == "claim" and _says_conserved(statement.sides, known)
        else _chain(place, statement, known)
        for statement in others
    ]
    refused = [each for each in said if isinstance(each, _Refused)]
    for each in refused:
        if not each.is_true or len(refused) == len(said):
            raise known.told(place, text, each.side, each.reason, each.remedy)
        known.passed.append(f"{each.shown} in {place} is passed over: {each.reason}")
    return [equation for each in said if not isinstance(each, _Refused) for equation in each]


@dataclass(frozen=True)
class _Refused:
    """A statement that is no equation of motion, and why."""

    side: Side
    is_true: bool
    reason: str
    remedy: str

    @property
    def shown(self) -> str:
        return self.side.text.strip().strip("$").strip()[:60]


def _is_plain(statements: Sequence[Statement], known: Sides) -> bool:
    """Tell whether a text is one equation of two sides, none of them a definition."""
    if len(statements) != 1 or len(statements[0].sides) > 2 or _says_conserved(statements[0].sides, known):
        return False
    return not any(is_definition(side.said, "claim", known.scope) for side in statements[0].sides)


def _products(place: str, text: str, known: Sides) -> list[str]:
    """Return the equations of the components where the sides are sums and products of matrices."""
    bare, defined = without_defined_vectors(text, known.keys)
    vectors = [*vectors_in(bare, known.keys, known.scope), *defined]
    return equations_of_products(bare, known.reads(place, bare), vectors) or [text]


def _chain(place: str, statement: Statement, known: Sides) -> list[str] | _Refused:
    """Return the equations that a chain says, definitions in it passed over; what is wrong where it says none."""
    sides = known.without_own_names(place, statement.sides)
    rest = [side for side in sides if not known.is_origin(place, side, "claim")]
    if len(rest) == len(sides):
        links = [field_texts.equation_between(a, b) for a, b in pairwise(sides)]
        return links or [sides[0].text]
    made = _worked_out(place, sides, rest, known)
    said = [side for side in rest if (side.said or side.text).strip("$0. ")]
    if len(rest) == 1 and said and sides[0] not in rest and "-" in sides[0].said:
        # d/dt(∂L/∂q̇) − ∂L/∂q is what stands there, and zero; or it equals the forces
        return made or [said[0].text]
    equations = [*made, *(field_texts.equation_between(a, b) for a, b in pairwise(rest))]
    if not said or not equations:
        unknown = next((side for side in sides if known.is_unknown(place, side)), None)
        is_true = all(map(known.can_read, rest)) if said else known.given(place).is_lagranges_equation(sides)
        return _Refused(unknown or sides[0], is_true and unknown is None, *_no_equation(said, unknown))
    return equations


def _says_conserved(sides: Sequence[Side], known: Sides) -> bool:
    """Tell whether a chain ends with ``= const.``."""
    free = not known.scope.declares("const")
    return len(sides) > 1 and free and field_texts.says_constant(sides[-1].text, known.scope)


def _conserved(place: str, sides: Sequence[Side], known: Sides) -> list[str]:
    """Return the equations of ``a = b = const.`` along the motion: a = b, and db/dt = 0."""
    sides = known.without_own_names(place, sides)[:-1]
    last = sides[-1]
    known.reads(place, last.text)(last.text)  # an error is told where it was typed
    said = last.text.strip().lstrip("$")
    latex = is_latex(last.text)
    rate = rf"$\frac{{d}}{{dt}}\left({said}\right) = 0" if latex else f"d/dt({said}) = 0"
    return [*(field_texts.equation_between(a, b) for a, b in pairwise(sides)), rate]


def _worked_out(place: str, sides: Sequence[Side], rest: Sequence[Side], known: Sides) -> list[str]:
    """Return the equations of origins with the side beside them that is read."""
    made: list[str] = []
    for side, beside in zip(sides, (*sides[1:], sides[max(0, len(sides) - 2)]), strict=True):
        if rest and side not in rest:
            made += known.origin(place, side, beside if beside in rest else rest[0])
    return made


def _no_equation(beside: Sequence[Side], unknown: Side | None) -> tuple[str, str]:
    """Return what is wrong with ``d/dt(∂L/∂θ̇) = ∂L/∂θ`` or ``∂L/∂x = -k x`` as an equation of motion, and a remedy."""
    if not beside:
        return "this is Lagrange's equation itself, true of every system", "write out what it is for this one"
    if unknown is not None:
        shown = unknown.text.strip().strip("$").strip()[:40]
        return f"what {shown} is made of is not given here", "write it out"
    return (
        "this says what a part of Lagrange's equation is, and is no equation of motion",
        "write out what it is for this one",
    )
