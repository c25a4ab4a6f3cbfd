"""Kinds for the page: what it asks for in each kind of claim, with an example where canon brings one."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

from canon.exercise.sheet.kinds import KINDS
from canon.exercise.sheet.sheet import bundled_sheet

if TYPE_CHECKING:
    from canon.exercise.sheet.kind import Shape

__all__ = ["kinds"]

_HIDDEN = ("id", "kind", "title", "source", "expect", "budget")


@cache
def kinds() -> dict[str, Any]:
    """Return the keys of each kind with their shapes, where its answer stands, and an example.

    Examples
    --------
    >>> kinds()["equality-only"]["required"]
    {'lhs': 'text', 'rhs': 'text'}
    """
    examples: dict[str, dict[str, Any]] = {}
    for claim in bundled_sheet().claims:
        said = {key: value for key, value in claim.keys.items() if key not in _HIDDEN}
        examples.setdefault(claim.kind, said)
    return {
        name: {
            "required": _shapes(kind.required),
            "optional": _shapes(kind.optional),
            "one_of": kind.one_of,
            "answer": kind.answer,
            "unknowns": kind.unknowns,
            "example": examples.get(name),
        }
        for name, kind in KINDS.items()
        if not kind.about  # what is claimed about another kind has the keys of that one
    }


def _shapes(shapes: Any) -> dict[str, str]:
    found: dict[str, Shape] = dict(shapes)
    return {key: shape.name.lower() for key, shape in found.items()}
