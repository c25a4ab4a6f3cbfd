"""Written answers: without what is understood behind them, and with what they abbreviate put in.

``x - x^3/6 + O(x^5)`` is asked to an order, ``q P + C`` up to a constant; ``H = T + V, T = …, V = …`` is one answer.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from canon.exercise.sheet import field_texts
from canon.exercise.sheet.equations.nearly_equal import (
    expansion_alone,
    without_deltas,
    without_nearly_equal,
)
from canon.exercise.sheet.kind import Shape
from canon.exercise.sheet.left_sides import components_asked, entry_asked, is_asked, label_of
from canon.exercise.sheet.quantities.abbreviations import doubtful_definition, without_abbreviations
from canon.exercise.sheet.quantities.rounded_values import without_rounded
from canon.expression.parse import LanguageError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.exercise.sheet.equations.sides import Sides
    from canon.exercise.sheet.kind import Kind
    from canon.exercise.sheet.left_sides import Label, Quantity

__all__ = ["WrittenAnswers"]

_UP_TO_A_CONSTANT = ("F", "S", "W")
"""Generating functions, gauges and complete integrals."""
_BY_ANY_NAME = ("I", "conserved", "not_conserved")
"""Keys of constants of the motion, before which any free name may stand."""
_EXPANSIONS = {"small", "degree"}
"""Keys of kinds whose answers are right to an order."""


@dataclass(frozen=True)
class WrittenAnswers:
    """The answers of one claim.

    Parameters
    ----------
    kind
        Its kind.
    sides
        What is known of the sides of equations in it, and where what is passed over is noted.
    is_list_of_equations
        Whether several equations may stand in one text.
    """

    kind: Kind
    sides: Sides
    is_list_of_equations: bool

    def answer(self, key: str, value: Any, asked: Quantity) -> Any:
        """Return what stands under a key of the answer, written out."""
        if _EXPANSIONS & self.kind.shapes.keys():
            value = self._expansions(key, value)
        elif key == "claim" and "equilibrium" in self.kind.shapes:
            value = self._each(value, self._linear)
        if key == "S" and "bodies" in self.kind.shapes and isinstance(value, str):
            value = field_texts.without_terms_of_rest(value)
        value = self._without_rounded(key, value)
        if key in _UP_TO_A_CONSTANT and isinstance(value, str):
            value = self._without_constant(key, value)
        shape = self.kind.shapes.get(key)
        if shape is Shape.BRACKETS:
            pairs = value if isinstance(value, list) else [value]
            return [self._value_put_in(key, pair) for pair in pairs]
        if shape is Shape.EXPRESSIONS and isinstance(value, Mapping):
            return {name: self._put_in(key, text, (entry_asked(key, name),)) for name, text in value.items()}
        if key in self.kind.several or shape not in (Shape.TEXT, Shape.TEXTS):
            return value
        names = components_asked(key, self.sides.keys, self.sides.scope) if shape is Shape.TEXTS else ()
        return self._put_in(key, value, (asked, *names))

    def _value_put_in(self, key: str, pair: Any) -> Any:
        """Return a bracket whose value is written out, ``2r², where r² = x² + y²``."""
        if not (isinstance(pair, Mapping) and isinstance(pair.get("value"), str)):
            return pair
        return {**pair, "value": self._put_in(key, pair["value"], ())}

    def _expansions(self, key: str, value: Any) -> Any:
        """Return expansions without ``+ O(x^5)`` and ``+ …``, and what they are nearly equal to, which is told."""

        def expansion(text: str) -> str:
            declared = self.sides.scope.declares("O")
            text, remainder = (text, "") if declared else field_texts.without_remainder(text)
            if remainder:
                self.sides.passed.append(f"the remainder {remainder} in {key} is passed over")
            return expansion_alone(key, text, self.sides, remainder=bool(remainder))

        return self._each(value, expansion)

    def _linear(self, text: str) -> str:
        """Return linear equations without the steps to them, and without δ."""
        return without_deltas(without_nearly_equal("claim", text, self.sides), self.sides)

    def _each(self, value: Any, change: Callable[[str], str]) -> Any:
        """Return texts changed one by one."""
        if isinstance(value, list):
            return [self._each(text, change) for text in value]
        return change(value) if isinstance(value, str) else value

    def _without_rounded(self, key: str, value: Any) -> Any:
        """Return exact values without the rounded ones behind them, ``arccos(2/3) ≈ 48.2°``, which are told."""
        if key in self.kind.several or self.kind.shapes.get(key) not in (Shape.TEXT, Shape.TEXTS):
            return value
        if isinstance(value, list):
            return [self._without_rounded(key, text) for text in value]
        exact, rounded = without_rounded(value, self.sides.scope) if isinstance(value, str) else (value, "")
        if rounded:
            self.sides.passed.append(f"{rounded} in {key} is passed over: it is the value before it, rounded")
        return exact

    def _without_constant(self, key: str, text: str) -> str:
        """Return a function without ``+ C``, which is told."""
        function, name = field_texts.without_constant(text)
        if not name or self.sides.scope.declares(name):
            return text
        self.sides.passed.append(f"+ {name} in {key} is passed over: {key} is meant up to a constant")
        return function

    def _put_in(self, key: str, value: Any, asked: Sequence[Quantity]) -> Any:
        """Return texts with what they abbreviate put in; what is asked for is no abbreviation."""
        texts: list[Any] = value if isinstance(value, list) else [value]
        if not all(type(text) is str for text in texts):
            return value
        names = self._first_names(key, texts) if key in _BY_ANY_NAME else []

        def is_asked_for(label: Label) -> bool:
            return label in names or any(is_asked(label, each, self.sides.scope) for each in asked)

        try:
            scope = replace(self.sides.scope, quadratures=key in self.kind.quadratures)
            found = without_abbreviations(texts, scope, is_asked_for)
            doubt = doubtful_definition(texts, scope, is_asked_for) if found is None else None
        except LanguageError:  # it is told where the answer is read
            return value
        if doubt is not None:
            raise self.sides.fault(key, doubt)
        if found is None or (found.unused and "multipliers" in self.sides.keys):  # T = 17 m1 may be one
            return value
        if len(found.texts) > 1 and not isinstance(value, list) and not self.is_list_of_equations:
            return value  # more than one expression, which is told
        self.sides.passed.extend(
            f"{said} in {key} is passed over: the name is not declared, and nothing here uses it"
            for said in found.unused
        )
        return found.texts if isinstance(value, list) or len(found.texts) > 1 else found.texts[0]

    def _first_names(self, key: str, texts: Sequence[str]) -> list[Label | None]:
        """Return what stands before the first sign of each text."""
        said = [next(iter(self.sides.statements(key, text)), None) for text in texts]
        return [label_of(each.sides[0].said) for each in said if each is not None]
