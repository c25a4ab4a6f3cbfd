"""Claims with ``±``: one of the upper signs and one of the lower, as books write two answers in one line."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from canon.exercise.sheet.answers.typed_values import SIGNS, both_signs
from canon.exercise.sheet.field_texts import texts_in
from canon.exercise.sheet.kind import Shape
from canon.exercise.sheet.kinds import kind_of
from canon.expression.parse import LanguageError
from canon.frozen_mapping import FrozenMapping

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.exercise.sheet.kind import Kind
    from canon.exercise.sheet.sheet import Claim

    _Fault = Callable[[str, LanguageError], Exception]

__all__ = ["signs_apart"]

_FORMULAS = (Shape.TEXT, Shape.TEXTS, Shape.EXPRESSIONS, Shape.LISTS, Shape.BRACKETS)
_SIDES = re.compile(r"(?<![<>!=])=(?!=)")


def signs_apart(claim: Claim, fault: _Fault) -> tuple[Claim, ...]:
    """Return the two claims that one with ``±`` in an answer stands for, or the claim itself.

    Upper signs go together: in the sides of a chain, and in W and its gradient.

    Parameters
    ----------
    claim
        The claim as written; its form has been checked.
    fault
        Makes the error of a text under a key.

    Raises
    ------
    Exception
        What ``fault`` makes, where it is not said which signs go together.

    Examples
    --------
    >>> from canon.exercise import Claim
    >>> claim = Claim("a", "constant-of-motion", {"q": "q", "p": "p", "H": "p**2/2", "I": "t ± q/p"})
    >>> [each.keys["I"] for each in signs_apart(claim, lambda key, error: error)]
    ['t + q/p', 't - q/p']
    """
    kind = kind_of(claim.kind, claim.keys)
    signed = [
        key for key in kind.answer if key in claim.keys and _is_signed(kind, key, claim.keys[key], fault)
    ]
    if not signed:
        return (claim,)
    return tuple(
        replace(
            claim,
            keys=FrozenMapping(
                {**claim.keys, **{key: _with_signs(claim.keys[key], key, which, fault) for key in signed}}
            ),
        )
        for which in (0, 1)
    )


def _is_signed(kind: Kind, key: str, value: Any, fault: _Fault) -> bool:
    """Tell whether ± stands in one formula under a key."""
    if key in kind.several or kind.shapes.get(key) not in _FORMULAS:
        return False
    texts = [text for _, text in texts_in({key: value}) if SIGNS.search(text)]
    if len(texts) > 1:
        told = f"is ± here and in {texts[0]} chosen together, or each by itself?"
        raise fault(key, LanguageError(texts[1], 1, told, "write one claim for each"))
    return bool(texts)


def _with_signs(value: Any, key: str, which: int, fault: _Fault) -> Any:
    """Return what stands under a key with the upper signs, or with the lower ones."""
    if isinstance(value, str):
        return _text(value, key, which, fault)
    if isinstance(value, list):
        return [_with_signs(item, key, which, fault) for item in value]
    if isinstance(value, dict | FrozenMapping):
        return {name: _with_signs(item, key, which, fault) for name, item in value.items()}
    return value


def _text(text: str, key: str, which: int, fault: _Fault) -> str:
    """Return a text with one kind of sign, each of its sides by itself and at its column."""
    if not SIGNS.search(text):
        return text
    made, begin = "", 0
    ends = [*(found.start() for found in _SIDES.finditer(text)), len(text)]
    try:
        for end in ends:
            made += both_signs(text[begin:end])[-1 if which else 0]
            begin = end
    except LanguageError as error:
        raise fault(key, error.at_home_in(text, lambda column: begin + column)) from None
    return made
