"""Abbreviations: names that an answer defines beside itself, ``θ'' + ω₀² sin θ = 0, ω₀² = g/l``.

What is not declared and stands alone, or squared, before ``=`` is put in wherever it stands in the rest of the answer.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.sheet.left_sides import label_of
from canon.expression.parse import LanguageError, parse_expression, statements_of
from canon.expression.text.notation import is_latex

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sympy import Expr, Symbol

    from canon.exercise.sheet.left_sides import Label
    from canon.expression.text.scope import Scope
    from canon.expression.text.statement import Side, Statement

__all__ = ["without_abbreviations"]

_SQUARED = re.compile(r"(?:\^2|\*\*2|²|\^\{2\})$")
_WHERE = re.compile(r"^(\s*)(?:where|with|and)\b", re.IGNORECASE)
_MOST = 8
"""Most abbreviations in one answer."""
_LONGEST = 2_000


def without_abbreviations(
    texts: Sequence[str], scope: Scope, is_asked: Callable[[Label], bool]
) -> list[str] | None:
    """Return the fields of an answer with what they abbreviate put in; None where they abbreviate nothing.

    Parameters
    ----------
    texts
        The fields.
    scope
        The declared names.
    is_asked
        Tells whether a name before ``=`` is that of the answer.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.expression import Scope
    >>> x, (m, k) = coordinates("x"), parameters("m k")
    >>> scope = Scope({s.name: s for s in (x, m, k)})
    >>> without_abbreviations(["x'' + w^2 x = 0, w^2 = k/m"], scope, lambda label: False)
    ['k*x/m + x_ddot = 0']
    """
    if any(is_latex(text) for text in texts) or sum(map(len, texts)) > _LONGEST:
        return None
    statements = [s for text in texts for s in statements_of(text, scope)]
    put: dict[Symbol, Expr] = {}
    kept: list[Statement] = []
    for statement in statements:
        found = _definition(statement, scope, is_asked) if len(statements) > 1 else None
        if found is None:
            kept.append(statement)
        else:
            put[found[0]] = found[1]
    if not put or not kept or len(put) > _MOST:
        return None
    known = replace(scope, names={**scope.names, **{symbol.name: symbol for symbol in put}})
    made = [_with(statement, known, put) for statement in kept]
    return None if None in made else [text for text in made if text is not None]


def _definition(
    statement: Statement, scope: Scope, is_asked: Callable[[Label], bool]
) -> tuple[Symbol, Expr] | None:
    """Return the name that a statement defines, and its value; None where it defines none."""
    if len(statement.sides) != 2:
        return None
    left, right = statement.sides
    said = re.sub(r"\s", "", _WHERE.sub(r"\1", left.text))
    base = _SQUARED.sub("", said)
    label = label_of(base)
    if label is None or not label.name or label.rates or label.arguments or is_asked(label):
        return None
    if scope.declares(label.name) or label.name in scope.functions or label.name == scope.time.name:
        return None
    try:
        value = parse_expression(right.text, scope)
    except LanguageError:
        return None
    return sp.Symbol(label.name, positive=True), sp.sqrt(value) if base != said else value


def _with(statement: Statement, scope: Scope, put: dict[Symbol, Expr]) -> str | None:
    """Return a statement with values in place of names; None where a side that holds one can't be read."""
    sides: list[str] = []
    for side in statement.sides:
        plain = _plain(side, scope, put)
        if plain is None and not label_of(side.said):
            return None
        sides.append(plain or side.said)
    return " = ".join(sides)


def _plain(side: Side, scope: Scope, put: dict[Symbol, Expr]) -> str | None:
    try:
        return str(parse_expression(_WHERE.sub(r"\1", side.text), scope).xreplace(put))
    except LanguageError:
        return None
