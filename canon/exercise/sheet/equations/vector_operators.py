r"""Vector fields as operators: ``-x ∂_x + y ∂_y`` has the components −x and y.

Each derivative stands last in its term, where it acts on nothing that is written; anything else is left alone.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, cast

from sympy import Dummy, S, Symbol

from canon.exercise.sheet.declared_symbols import as_list
from canon.exercise.sheet.field_texts import is_name_of_matrix
from canon.expression.parse import LanguageError, parse_expression, statements_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr

    from canon.expression.text.scope import Scope
    from canon.expression.text.statement import Side

__all__ = ["components_of_operator"]

_BY = r"\{{?\s{{0,3}}(?P<{0}>\\?[^\W\d_]\w{{0,9}}(?:_\{{\w{{1,5}}\}}|_\w)?)\s{{0,3}}\}}?"
_OPERATOR = re.compile(
    rf"\\[dt]?frac\s?\{{\s?\\partial\s?\}}\s?\{{\s?\\partial\s?{_BY.format('below')}\s?\}}"
    rf"|(?:\\partial|∂)\s?/\s?(?:\\partial|∂)\s?{_BY.format('behind')}"
    rf"|(?:\\partial\s?|∂)_{_BY.format('lowered')}|∂(?P<small>ₓ)"
    rf"|(?<![^\W_])d\s?/\s?d(?P<typed>[^\W\d_]\w{{0,9}})(?!\w)"
)
_TYPED = re.compile(r"(?<![^\W_])d\s?/\s?d[^\W\d_]")
"""``d/dx``, where ∂ is not at hand."""
_END = re.compile(r"(?:[\s)\].,;$]|\\right|\\[bB]igg?r?|\\[,;:! ])*(?:$|[-+−])")
"""What may stand behind a derivative: the end of its term, brackets among it."""


def components_of_operator(text: str, names: str | Sequence[str], scope: Scope) -> list[str]:
    r"""Return the components of a vector field that is written as an operator; none of other texts.

    Parameters
    ----------
    text
        What was typed.
    names, scope
        The names of the variables, and all declared ones.

    Examples
    --------
    >>> from sympy import Symbol
    >>> from canon.expression.parse import Scope
    >>> scope = Scope({name: Symbol(name, real=True) for name in "xy"})
    >>> components_of_operator("−x ∂/∂x + y ∂/∂y", ["x", "y"], scope)
    ['-x', 'y']
    >>> components_of_operator(r"$[X, Y] = x(\partial_x - 2\,\partial_y)$", ["x", "y"], scope)
    ['x', '-2*x']
    >>> components_of_operator("∂_x x", ["x", "y"], scope)
    []
    """
    if "∂" not in text and "\\partial" not in text and (scope.declares("d") or not _TYPED.search(text)):
        return []
    variables = [scope.names[name] for name in as_list(names) if name in scope.names]
    try:
        return _components(text, variables, scope)
    except LanguageError:  # it is told where it is read
        return []


def _components(text: str, variables: Sequence[Symbol], scope: Scope) -> list[str]:
    statements = statements_of(text, scope)
    first, *others = statements[0].sides
    values = others if others and is_name_of_matrix(first.text) else [first, *others]
    if len(statements) > 1:
        return []
    each = [_of_side(side, variables, scope) for side in values]
    # of a chain whose sides differ, which one is the answer?
    return [str(factor) for factor in each[-1]] if all(made == each[-1] for made in each) else []


def _of_side(side: Side, variables: Sequence[Symbol], scope: Scope) -> list[Expr]:
    """Return the components of one side; none where it is no operator."""
    plain, basis = _with_names(side.text, variables, scope)
    if not plain:
        return []
    names = {**scope.names, **{f"Basis_{i}": e for i, e in enumerate(basis)}}
    said = parse_expression(plain, replace(scope, names=names))
    found = [cast("Expr", said.diff(e)) for e in basis]
    linear = (
        not any(factor.has(*basis) for factor in found) and said.xreplace(dict.fromkeys(basis, S.Zero)) == 0
    )
    return found if linear else []


def _with_names(text: str, variables: Sequence[Symbol], scope: Scope) -> tuple[str, list[Dummy]]:
    """Return a side with a name for each derivative, and these by variables; nothing where one acts on something."""
    basis = [Dummy(f"e_{variable}", real=True) for variable in variables]

    def named(found: re.Match[str]) -> str:
        name = found["below"] or found["behind"] or found["lowered"] or found["typed"] or "x"
        by = parse_expression(name, scope)
        at = variables.index(by) if by in variables and not (found["typed"] and scope.declares("d")) else -1
        if at < 0 or not _END.match(found.string, found.end()):
            raise LanguageError(text, found.start() + 1, "this derivative acts on something")
        return f" Basis_{at} "

    plain, count = _OPERATOR.subn(named, text)
    return (plain if count else "", basis)
