"""Abbreviations: names that an answer defines beside itself, ``θ'' + ω₀² sin θ = 0, ω₀² = g/l``.

What is not declared and stands alone, or squared, before ``=`` is put in wherever it stands in the rest of the answer.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import sympy as sp

from canon.exercise.sheet.left_sides import label_of
from canon.expression.as_written import as_written
from canon.expression.parse import LanguageError, parse_expression, statements_of, syntax_of
from canon.expression.symbols.symbol import (
    Coordinate,
    Momentum,
    Rate,
    time_derivative,
    velocity,
)
from canon.expression.text.declared_names import key_of
from canon.expression.text.scope import split
from canon.expression.text.syntax import Call, Name, parts
from canon.expression.text.tokens import GREEK
from canon.expression.text.units import units
from canon.expression.text.vocabulary import CONSTANTS, FUNCTIONS, OTHER_NAMES

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sympy import Basic, Expr, Symbol

    from canon.exercise.sheet.left_sides import Label
    from canon.expression.text.scope import Scope
    from canon.expression.text.statement import Side, Statement
    from canon.expression.text.syntax import Node

__all__ = ["Abbreviated", "doubtful_definition", "without_abbreviations"]

_SQUARED = re.compile(r"(?:\^2|\*\*2|²|\^\{2\})$")
_TIMES = re.compile(r"(?P<times>[2-9])\*?(?P<name>[^\W\d]\w*)")
"""A few times a name, ``2γ``."""
_WHERE = re.compile(r"^(\s*)(?:where|with|and|mit|wobei|avec|où|donde)\b", re.IGNORECASE)
_OF_VARIABLES = re.compile(
    r"(?<![\w\\])(?P<name>\\?[^\W\d_]\w{0,9}(?:_\{\w{1,9}\})?)\s?\((?P<inside>[^()=]{1,20})\)\s*=(?!=)"
)
"""``V(x) =``, of a function that an answer defines."""
_MOST = 8
"""Most abbreviations in one answer."""
_LONGEST = 2_000


class Abbreviated(NamedTuple):
    """The fields of an answer with what they abbreviate put in, and the definitions that nothing uses."""

    texts: list[str]
    unused: list[str]


def without_abbreviations(
    texts: Sequence[str], scope: Scope, is_asked: Callable[[Label], bool]
) -> Abbreviated | None:
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
    >>> without_abbreviations(["x'' + w^2 x = 0, w^2 = k/m, f = 3"], scope, lambda label: False)
    Abbreviated(texts=['x*(sqrt(k/m))**2 + x_ddot = 0'], unused=['f = 3'])
    """
    if sum(map(len, texts)) > _LONGEST:
        return None
    texts = [_without_arguments(text, scope, is_asked) for text in texts]
    statements = [s for text in texts for s in statements_of(text, scope)]
    defined, kept = _apart(statements, scope, is_asked) if len(statements) > 1 else ([], [])
    if not kept or not 0 < len(defined) <= _MOST:
        return None
    known = _with_names(scope, defined)
    unused = [
        each for each in defined if not _is_used(each, [s for s in statements if s is not each.said], known)
    ]
    if any(each.by_rate for each in unused):  # x' = c
        return None
    made = [_with(statement, known) for statement in kept]
    told = [" = ".join(side.text.strip().lstrip("$ ") for side in each.said.sides) for each in unused]
    return None if None in made else Abbreviated([text for text in made if text is not None], told)


def _without_arguments(text: str, scope: Scope, is_asked: Callable[[Label], bool]) -> str:
    """Return a text with V for ``V(x)`` where it says what V(x) is."""
    for found in list(_OF_VARIABLES.finditer(text)) if len(text) <= _LONGEST else []:
        name, inside = found["name"], found["inside"]
        label = label_of(_spelled(name) or name)
        said = text[found.start() : found.end("inside") + 1]
        declared = all(_is_declared(each, scope) for each in re.split(r"[,;]", inside))
        if (
            label is None
            or label.name in FUNCTIONS
            or label.name in scope.functions
            or label.name in OTHER_NAMES
        ):
            continue
        if declared and text.count(said) > 1 and _new_name(label.name, scope, is_asked):
            text = text.replace(said, name.ljust(len(said)))
    return text


def _is_declared(name: str, scope: Scope) -> bool:
    return scope.declares(_spelled(name.strip()) or name.strip())


def doubtful_definition(
    texts: Sequence[str], scope: Scope, is_asked: Callable[[Label], bool]
) -> LanguageError | None:
    """Return what is wrong with the value of a name that the rest of an answer uses; None where nothing is.

    Parameters
    ----------
    texts, scope, is_asked
        As above.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.expression import Scope
    >>> scope = Scope({s.name: s for s in (coordinates("x"), *parameters("m c"))})
    >>> doubtful_definition(["x'' + b x' = 0, where b = c/2m"], scope, lambda _: False).reason
    'c/2m is c/2*m or c/(2*m)?'
    """
    for text in texts:
        statements = statements_of(text, scope)
        for statement in statements if len(statements) > 1 else ():
            doubt = _doubt(statement, statements, scope, is_asked)
            if doubt is not None:
                return doubt.at_home_in(text)
    return None


def _doubt(
    statement: Statement, statements: Sequence[Statement], scope: Scope, is_asked: Callable[[Label], bool]
) -> LanguageError | None:
    """Return why the value that a statement gives to a name in the others can't be read, None where it can."""
    if len(statement.sides) != 2:
        return None
    left, right = statement.sides
    name = _new_name(_SQUARED.sub("", _said(left)), scope, is_asked)
    if not name:
        return None
    defined = _Definition(name, statement, sp.S.One, moves=False)
    try:
        syntax_of(right.text, scope)
    except LanguageError as error:
        others = [each for each in statements if each is not statement]
        return error if _is_used(defined, others, _with_names(scope, [defined])) else None
    return None


def _apart(
    statements: Sequence[Statement], scope: Scope, is_asked: Callable[[Label], bool]
) -> tuple[list[_Definition], list[Statement]]:
    """Return what an answer defines, each by what was defined before it, and the other statements.

    What is said of a name a second time is an equation: ``F = -k x, F = m x''``.
    """
    defined: list[_Definition] = []
    kept = list(statements)
    found = True
    while found:
        found = False
        for statement in sorted(kept, key=_turn):
            definition = _definition(statement, _with_names(scope, defined), is_asked)
            if definition is not None and not _holds_a_later_one(statement, kept, scope):
                defined.append(definition)
                kept.remove(statement)
                found = True
                break
    return defined, kept


def _holds_a_later_one(statement: Statement, kept: Sequence[Statement], scope: Scope) -> bool:
    """Tell whether what looks like a unit is a name that is defined later: ``c = 2 s, s = k/m``."""
    later = {_said(other.sides[0]) for other in kept if other is not statement and len(other.sides) > 1}
    found = [unit for side in statement.sides[1:] if later for unit in units(side.text, scope)]
    return any(unit.text in later for unit in found)


def _turn(statement: Statement) -> tuple[bool, bool]:
    """Return what sorts statements: definitions of I, e and the like come first, which are no constants then.

    Those of squares come last: in ``v² = g r, v = r θ'`` the first is an equation.
    """
    said = _said(statement.sides[0])
    label = label_of(said)
    is_constant = label is not None and label.name in (*CONSTANTS, *OTHER_NAMES)
    return not is_constant, _SQUARED.search(said) is not None


def _with_names(scope: Scope, defined: Sequence[_Definition]) -> Scope:
    """Return a scope in which names mean what an answer defines them by."""
    names = {**scope.names, **{each.name: each.symbol for each in defined}}
    values = {name: value for each in defined for name, value in each.values(scope).items()}
    return replace(scope, names=names, values=values)


@dataclass(frozen=True)
class _Definition:
    """A name that an answer defines, and its value; what moves has rates as well."""

    name: str
    said: Statement
    value: Expr
    moves: bool
    is_root: bool = False
    by_rate: bool = False

    @property
    def symbol(self) -> Symbol:
        """What it is read as: what moves has rates, and no d/dt takes it for a constant."""
        if self.moves:
            return Coordinate(self.name, real=True)
        return sp.Symbol(self.name, positive=True) if self.is_root else sp.Symbol(self.name, real=True)

    def values(self, scope: Scope) -> dict[str, Expr | None]:
        """Return its value, and its rates where it moves; None for a rate that this question has no symbol of."""
        found: dict[str, Expr | None] = {self.name: self.value}
        if self.moves:
            q = [symbol for symbol in scope.names.values() if isinstance(symbol, Coordinate)]
            first = _rate(self.value, q, scope)
            found[f"{self.name}_dot"] = first
            found[f"{self.name}_ddot"] = None if first is None else _rate(first, q, scope)
        return found


def _rate(value: Expr, q: Sequence[Symbol], scope: Scope) -> Expr | None:
    """Return dvalue/dt along the motion; None where it holds what has no rate here."""
    has_none = [
        s for s in value.free_symbols if _moves(s, scope) and s not in (*q, *map(velocity, q), scope.time)
    ]
    return None if has_none else time_derivative(value, q, scope.time)


def _moves(symbol: Basic, scope: Scope) -> bool:
    return isinstance(symbol, Coordinate | Momentum | Rate) or scope.moves(str(symbol))


def _moves_in(value: Expr, scope: Scope) -> bool:
    return any(_moves(symbol, scope) for symbol in value.free_symbols)


def _definition(statement: Statement, scope: Scope, is_asked: Callable[[Label], bool]) -> _Definition | None:
    """Return what a statement defines; None where it defines nothing."""
    if len(statement.sides) != 2:
        return None
    left, right = statement.sides
    if (rate := _rate_alone(left, scope)) is not None and not _is_asked(left, is_asked):
        return _by_its_rate(rate, statement, scope)
    said = _said(left)
    is_root = _SQUARED.search(said) is not None
    few = None if is_root else _TIMES.fullmatch(said)
    base = few["name"] if few else _SQUARED.sub("", said)
    name = _new_name(base, scope, is_asked)
    if not name:
        return None
    try:
        value = parse_expression(right.text, scope)
    except LanguageError:
        return None
    value = sp.sqrt(value) if is_root else value / int(few["times"] if few else 1)
    return _Definition(name, statement, value, _moves_in(value, scope), is_root)


def _said(side: Side) -> str:
    """Return a side in plain spelling, without the word before it: ``where ω₀² = g/l``."""
    plain = _WHERE.sub(r"\1", side.text)
    if re.search(r"[^\W_]\s+[^\W_]", plain.strip("$ ")):  # k x is no name
        return ""
    return side.said if plain == side.text else re.sub(r"\s", "", plain)


def _new_name(said: str, scope: Scope, is_asked: Callable[[Label], bool]) -> str:
    """Return the name that a side is; empty where it is none, or declared, or that of the answer."""
    label = label_of(said)
    if label is None or not label.name or label.rates or label.arguments or is_asked(label):
        return ""
    taken = key_of(label.name) in {key_of(name) for name in scope.spelled} or split(label.name, scope)
    return "" if taken else label.name


def _rate_alone(side: Side, scope: Scope) -> Expr | None:
    """Return the value of the velocity that a side is, and nothing else."""
    label = label_of(side.said)
    name = f"{label.name}_dot" if label and label.rates == 1 and not label.arguments else ""
    symbol = scope.symbol(name)
    return scope.values.get(name, symbol) if isinstance(symbol, Rate) else None


def _is_asked(side: Side, is_asked: Callable[[Label], bool]) -> bool:
    label = label_of(side.said)
    return label is not None and is_asked(label)


def _by_its_rate(rate: Expr, statement: Statement, scope: Scope) -> _Definition | None:
    """Return the name that ``x' = v`` or ``x' = p/m`` defines; None where it is not one name times something."""
    right = statement.sides[1]
    words = dict.fromkeys(map(_spelled, re.findall(r"\\?[^\W\d_]\w{0,9}", right.text)))
    for word in [word for word in words if _new_name(word, scope, lambda _: False)][:_MOST]:
        symbol = sp.Symbol(word, real=True)
        try:
            value = parse_expression(right.text, replace(scope, names={**scope.names, word: symbol}))
        except LanguageError:
            continue
        factor = value.diff(symbol)
        if factor != 0 and factor.free_symbols <= {*scope.names.values()} and value.subs(symbol, 0) == 0:
            found = _Definition(word, statement, rate / factor, moves=True, by_rate=True)
            return None if _moves_in(factor, scope) else found
    return None


def _spelled(word: str) -> str:
    r"""Return the plain name of a word, ``omega`` for ω and ``\omega``; a command of LaTeX is no name."""
    letter = word.lstrip("\\")
    label = label_of(letter)
    return "" if label is None or (letter != word and letter not in GREEK.values()) else label.name


def _with(statement: Statement, scope: Scope) -> str | None:
    """Return a statement with values in place of names; None where a side that holds one can't be read."""
    sides: list[str] = []
    for side in statement.sides:
        plain = _plain(side, scope)
        if plain is None and not label_of(side.said):
            return None
        sides.append(plain or (side.said if "$" in side.text else side.text.strip()))  # $H = c**2 is no LaTeX
    return " = ".join(sides)


def _is_used(definition: _Definition, statements: Sequence[Statement], scope: Scope) -> bool:
    """Tell whether a name, or a rate of it, stands in one of the statements."""
    names = {definition.name, f"{definition.name}_dot", f"{definition.name}_ddot"}
    trees = (_tree(side, scope) for each in statements for side in each.sides)
    return any(_named(part) in names for tree in trees if tree is not None for part in parts(tree))


def _named(part: Node) -> str:
    return part.function if isinstance(part, Call) else part.text if isinstance(part, Name) else ""


def _tree(side: Side, scope: Scope) -> Node | None:
    """Return how a side is read; None where it can't be."""
    try:
        return syntax_of(_WHERE.sub(r"\1", side.text), scope)
    except LanguageError:
        return None


def _plain(side: Side, scope: Scope) -> str | None:
    """Return a side with values in place of names; what can't be read is None.

    Nothing in it is cancelled, so that what has no value is found where the answer is read.
    """
    text = _WHERE.sub(r"\1", side.text)
    bare = replace(scope, values={})
    try:
        value = parse_expression(text, scope)
        written = str(as_written(text, scope))
        return written if parse_expression(written, bare) == value else str(value)
    except LanguageError:
        return None
