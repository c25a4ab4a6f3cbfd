"""Parser of the safe expression language: text to SymPy, never evaluated as code.

The grammar is in :mod:`canon.expression.text.juxtaposition`, that of LaTeX in
:mod:`canon.expression.latex.grammar`; the tree gets
its meaning within a :class:`Scope` of declared names in :mod:`canon.expression.builder`.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, cast

from sympy import Expr, Rational

from canon.expression.builder import Builder
from canon.expression.copied_forms import plainly_formed
from canon.expression.own_macros import without_macros
from canon.expression.physics_package import written_out
from canon.expression.program_marks import without_program_marks
from canon.expression.programs.prefix_forms import with_signs_between
from canon.expression.programs.program_rates import with_rates_of_programs
from canon.expression.prose import without_prose
from canon.expression.ranges.typed_sums import with_sums
from canon.expression.remarks import without_remarks
from canon.expression.sentences.closing_sentence import with_constancy
from canon.expression.sentences.dictation import written_from_dictation
from canon.expression.sentences.joined_equations import plainly_joined
from canon.expression.siunitx import without_siunitx
from canon.expression.symbols.user_input import given_kind
from canon.expression.text import syntax
from canon.expression.text.juxtaposition import parse_juxtaposed
from canon.expression.text.markup import unmarked
from canon.expression.text.notation import is_latex
from canon.expression.text.scope import Scope
from canon.expression.text.statement import Statement, plain_statements
from canon.expression.text.syntax import LanguageError
from canon.expression.text.units import without_units
from canon.expression.typed_dots import with_typed_dots
from canon.expression.written_rates import with_primes

if TYPE_CHECKING:
    from collections.abc import Callable
    from decimal import Decimal

    from sympy.logic.boolalg import Boolean

__all__ = [
    "LanguageError",
    "Scope",
    "parse_condition",
    "parse_equation",
    "parse_expression",
    "statements_of",
    "syntax_of",
]

_LONGEST_KEPT = 600
"""Characters of a text whose tree is kept, so that a process that lives for weeks stays small."""


def parse_expression(text: str, scope: Scope) -> Expr:
    """Return the SymPy expression that a text spells.

    Parameters
    ----------
    text
        An expression of the language; ``theta`` may also be written ``θ``, ``theta_dot`` ``theta'`` or ``θ̇``.
    scope
        The declared names.

    Raises
    ------
    LanguageError
        With the column, the reason and a remedy.

    Examples
    --------
    >>> from canon import parameters
    >>> x, lam = parameters("x lambda")
    >>> parse_expression("lambda*x**2/3 + 0.25", Scope({"x": x, "lambda": lam}))
    lambda*x**2/3 + 1/4
    >>> parse_expression("x.__class__", Scope({"x": x}))
    Traceback (most recent call last):
        ...
    canon.expression.text.tokens.LanguageError: column 2: '.' is not part of the language; attributes are not part ...
    x.__class__
     ^
    """
    return Builder(text, scope).whole(syntax_of(text, scope))


def parse_condition(text: str, scope: Scope) -> Boolean:
    """Return the SymPy condition that a text spells, such as ``0 < theta < pi``, ``Ne(q, 0)`` or ``a*d - b*c = 1``.

    Raises
    ------
    LanguageError
        With the column, the reason and a remedy.
    """
    node = syntax_of(text, scope)
    if isinstance(node, syntax.Comparison) and "=" in node.relations:
        relations = tuple("==" if relation == "=" else relation for relation in node.relations)
        node = syntax.Comparison(node.operands, relations, node.column)
    return Builder(text, scope).condition(node)


def parse_equation(text: str, scope: Scope) -> Expr:
    """Return lhs − rhs of ``lhs = rhs``, or the expression itself, which then should vanish.

    Raises
    ------
    LanguageError
        With the column, the reason and a remedy.
    """
    builder = Builder(text, scope)
    node = syntax_of(text, scope)
    sides = syntax.equation(node)
    if sides is None and isinstance(node, syntax.Comparison):
        raise LanguageError(text, node.column, "this is not one equation", "write lhs = rhs")
    if sides is None:
        return builder.whole(node)
    for side in sides:
        builder.refuse_function_alone(side)
    return builder.whole(syntax.Sum(((False, sides[0]), (True, sides[1])), node.column))


def syntax_of(text: str, scope: Scope) -> syntax.Node:
    """Return the syntax tree of a text, whose names need not mean anything yet.

    Raises
    ------
    LanguageError
        With the column, the reason and a remedy.
    """
    given_kind(text, str, "an expression of the language")
    given_kind(scope, Scope, "the scope", "write Scope({'x': x}) with the declared names")
    return (_kept_syntax if len(text) <= _LONGEST_KEPT else _syntax)(text, scope)


def _syntax(text: str, scope: Scope) -> syntax.Node:
    text = _without_what_is_around(text, scope)
    if is_latex(text):
        from canon.expression.latex.grammar import parse_latex  # only here: it loads a parser generator

        text = without_siunitx(text)  # no earlier: of a quantity that is asked for, the unit is read
        return _in_place(text, without_units(text, scope), lambda blanked: parse_latex(blanked, scope))
    return _in_place(text, without_units(text, scope), lambda blanked: parse_juxtaposed(blanked, scope))


def _without_what_is_around(text: str, scope: Scope) -> str:
    """Return a text without markup, prose and remarks around its formula, every column where it was."""
    text = without_macros(text, scope)
    text = with_rates_of_programs(with_signs_between(text, scope), scope)
    written = with_sums(written_from_dictation(without_program_marks(text, scope), scope), scope)
    joined = plainly_joined(with_constancy(with_typed_dots(written, scope), scope), scope)
    plain = with_primes(unmarked(joined), scope)
    bare = without_prose(plain, scope)
    remarked = without_remarks(plain if bare == plain else unmarked(bare), scope)
    return written_out(plainly_formed(remarked, scope))


_kept_syntax = functools.lru_cache(maxsize=256)(_syntax)
"""A text is an expression, an equation and what has a value as it is written: one tree for all of them."""


def statements_of(text: str, scope: Scope) -> tuple[Statement, ...]:
    """Return the statements of one field, in whatever notation it is written; nothing in them is read yet.

    Raises
    ------
    LanguageError
        With the column, the reason and a remedy.

    Examples
    --------
    >>> [side.said for side in statements_of("H = p**2/2", Scope())[0].sides]
    ['H', 'p**2/2']
    """
    given_kind(text, str, "an expression of the language")
    given_kind(scope, Scope, "the scope", "write Scope({'x': x}) with the declared names")
    text = _without_what_is_around(text, scope)
    if is_latex(text):
        from canon.expression.latex.latex_statement import latex_statements  # only here, as above

        return latex_statements(text)
    return plain_statements(text)


def _in_place(text: str, blanked: str, parse: Callable[[str], syntax.Node]) -> syntax.Node:
    """Return the tree of a text without its units; an error shows the text as it was written."""
    try:
        return parse(blanked)
    except LanguageError as error:
        raise error.at_home_in(text) from None


def exact(value: Decimal | float | int | str) -> Rational:
    """Return the exact rational that a number in a sheet spells.

    Examples
    --------
    >>> exact(0.1)
    1/10
    """
    return cast("Rational", Rational(str(value)))
