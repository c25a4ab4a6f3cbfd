"""Conditions of pieces: relations, and alternatives of which one is enough."""

from __future__ import annotations

from itertools import product
from math import prod
from typing import TYPE_CHECKING

from canon.expression.text import syntax
from canon.expression.text.syntax import LanguageError
from canon.expression.text.vocabulary import MAX_CHOICES, RELATIONS

if TYPE_CHECKING:
    from sympy import Expr
    from sympy.logic.boolalg import Boolean

    from canon.expression.text.scope import Scope

__all__ = ["alternatives", "related"]


def alternatives(text: str, node: syntax.Node, scope: Scope) -> tuple[syntax.Node, ...]:
    """Return the conditions of which one is enough, ``(a or b) and c`` as two of them.

    Raises
    ------
    LanguageError
        Where there are more than anyone means.
    """
    if not isinstance(node, syntax.Call) or node.function in scope.functions:
        return (node,)
    inside = (
        [alternatives(text, part, scope) for part in node.arguments] if node.function in ("And", "Or") else []
    )
    count = sum(map(len, inside)) if node.function == "Or" else prod(map(len, inside))
    if count > MAX_CHOICES:
        reason = f"a condition of more than {MAX_CHOICES} alternatives"
        raise LanguageError(text, node.column, reason, "write the pieces one by one")
    if node.function == "Or":
        return tuple(one for part in inside for one in part)
    if node.function == "And":
        return tuple(syntax.Call("And", chosen, node.column) for chosen in product(*inside))
    return (node,)


def related(left: Expr, relation: str, right: Expr) -> Boolean:
    """Return a relation, a number on its right."""
    if left.is_number and not right.is_number:
        left, right = right, left
        relation = relation.translate(str.maketrans("<>", "><"))
    return RELATIONS[relation](left, right)
