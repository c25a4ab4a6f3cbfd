"""Sides of equations in an answer: taken apart, and where one says from which functions a formula comes."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from canon.exercise.sheet.field_texts import says_constant
from canon.exercise.sheet.kind import BESIDE
from canon.exercise.sheet.left_sides import is_action, is_definition, label_of
from canon.exercise.sheet.quantities.given_functions import GivenFunctions, key_at
from canon.expression.parse import LanguageError, parse_expression, statements_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from canon.expression.text.scope import Scope
    from canon.expression.text.statement import Side, Statement

__all__ = ["Sides"]


@dataclass(frozen=True)
class Sides:
    """What is known of the sides of equations in one claim.

    Parameters
    ----------
    keys
        The claim.
    scope
        Its declared names.
    fault
        Makes the error of a text at a place.
    passed
        Where sentences on what is passed over are noted.
    """

    keys: Mapping[str, Any]
    scope: Scope
    fault: Callable[[str, LanguageError], Exception]
    passed: list[str]

    def statements(self, place: str, text: str) -> tuple[Statement, ...]:
        """Return the statements of a text."""
        try:
            return statements_of(text, self.scope)
        except LanguageError as error:
            raise self.fault(place, error) from None

    def reads(self, place: str, text: str) -> Callable[[str], object]:
        """Return what reads one piece of a text and raises its error."""

        def read(piece: str) -> object:
            try:
                return parse_expression(piece, self.scope)
            except LanguageError as error:
                raise self.fault(place, error.at_home_in(text)) from None

        return read

    def told(self, place: str, text: str, side: Side, reason: str, remedy: str) -> Exception:
        """Return the error of one side of a text."""
        return self.fault(place, LanguageError(text, side.column, reason, remedy))

    def given(self, place: str) -> GivenFunctions:
        """Return the functions that the claim gives for an answer at a place."""
        return GivenFunctions(self.keys, key_at(place), self.scope)

    def is_origin(self, place: str, side: Side, asked: str) -> bool:
        """Tell whether a side says where a formula comes from: of functions, given or not."""
        if is_action(side.text, asked) and (asked != "S" or "constants" in self.keys):  # Gibbs's S is another
            return True
        return (
            is_definition(side.said, asked, self.scope) or self.given(place).worked_out(side.said) is not None
        )

    def without_own_names(self, place: str, sides: Sequence[Side]) -> Sequence[Side]:
        """Return the sides of a chain without a name that its writer gives to it: F in ``m x'' = F = -k x``.

        Such a name is not declared and stands nowhere else in the claim, so that nothing depends on it.
        """
        own = [side for side in sides if self._is_own_name(side)]
        if len(own) != 1 or len(sides) < 3:
            return sides
        self.passed.append(f"{own[0].text.strip()} in {place} is passed over: it is a name of your own")
        return [side for side in sides if side is not own[0]]

    def _is_own_name(self, side: Side) -> bool:
        label = label_of(side.said)
        if (
            label is None
            or not label.name
            or label.rates
            or label.arguments
            or says_constant(side.text, self.scope)
        ):
            return False
        if not self.can_read(side):
            said = repr({key: value for key, value in self.keys.items() if key not in BESIDE})
            typed = repr(side.text.strip(" $"))[1:-1]
            spellings = {side.said} if re.search(r"\s", typed) else {side.said, typed}
            names = [re.findall(rf"(?<!\w){re.escape(name)}(?!\w)", said) for name in spellings]
            return sum(map(len, names)) == 1
        return False

    def can_read(self, side: Side) -> bool:
        """Tell whether a side is an expression in the declared names."""
        try:
            parse_expression(side.text, self.scope)
        except LanguageError:
            return False
        return True

    def is_unknown(self, place: str, side: Side) -> bool:
        """Tell whether a side is made of functions that nobody gave."""
        return self.is_origin(place, side, "claim") and self.given(place).worked_out(side.said) is None

    def origin(self, place: str, side: Side, near: Side) -> list[str]:
        """Return the equation of an origin with a side near it; one of what is not given is passed over."""
        found = self.given(place).equations(side, near)
        if found is None:
            shown = side.text.strip().lstrip("$")
            self.passed.append(f"{shown} in {place} is passed over: what it is made of is not given here")
        return found or []
