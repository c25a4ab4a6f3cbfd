"""Parser of the safe expression language: text to SymPy, never evaluated as code.

The grammar is in :mod:`canon.expression.text.syntax`; here the tree gets its meaning within a :class:`Scope` of
declared names. What SymPy would evaluate at ruinous cost (``9**9**9``) is refused before it is built.
"""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING, NoReturn, cast

import sympy as sp
from sympy import Expr, Rational, Symbol

from canon.expression.symbols.magnitude import MOST_DIGITS, digits
from canon.expression.symbols.symbol import Coordinate
from canon.expression.symbols.user_input import given_kind
from canon.expression.text import syntax
from canon.expression.text.juxtaposition import parse_juxtaposed
from canon.expression.text.notation import is_latex
from canon.expression.text.scope import Scope
from canon.expression.text.statement import Statement, plain_statements
from canon.expression.text.syntax import LanguageError, parse_syntax
from canon.expression.text.units import without_units
from canon.expression.text.vocabulary import CONSTANTS, FUNCTIONS, MAX_CHOICES, RELATIONS

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
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

MAX_EXPONENT = 1_000
MAX_BITS = 14_000
"""Longest number that is built: Python writes integers of up to 4300 digits."""


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
    return Builder(text, scope).expression(syntax_of(text, scope))


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
    if not isinstance(node, syntax.Comparison):
        return builder.expression(node)
    if node.relations != ("=",):
        raise LanguageError(text, node.column, "this is not one equation", "write lhs = rhs")
    left, right = (builder.expression(side) for side in node.operands)
    return left - right


def syntax_of(text: str, scope: Scope) -> syntax.Node:
    """Return the syntax tree of a text, whose names need not mean anything yet.

    Raises
    ------
    LanguageError
        With the column, the reason and a remedy.
    """
    given_kind(text, str, "an expression of the language")
    given_kind(scope, Scope, "the scope", "write Scope({'x': x}) with the declared names")
    if is_latex(text):
        from canon.expression.latex.grammar import parse_latex  # only here: it loads a parser generator

        return _in_place(text, without_units(text, scope), lambda blanked: parse_latex(blanked, scope))
    if scope.implicit:
        return _in_place(text, without_units(text, scope), lambda blanked: parse_juxtaposed(blanked, scope))
    return _in_place(text, without_units(text, scope), parse_syntax)


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
    if is_latex(text):
        from canon.expression.latex.latex_statement import latex_statements  # only here, as above

        return latex_statements(text)
    return plain_statements(text)


def _in_place(text: str, blanked: str, parse: Callable[[str], syntax.Node]) -> syntax.Node:
    """Return the tree of a text without its units; an error shows the text as it was written."""
    try:
        return parse(blanked)
    except LanguageError as error:
        raise LanguageError(text, error.column, error.reason, error.remedy) from None


class Builder:
    """Gives a syntax tree its meaning; every costly evaluation is bounded before SymPy is asked."""

    def __init__(self, text: str, scope: Scope) -> None:
        self.text = text
        self.scope = scope

    def refuse(self, node: syntax.Node, reason: str, remedy: str = "") -> NoReturn:
        raise LanguageError(self.text, node.column, reason, remedy)

    def expression(self, node: syntax.Node) -> Expr:
        """Return the expression of a tree, refusing what SymPy can't build or what is undefined everywhere."""
        try:
            return self.finite(node, self.built(node))
        except LanguageError:
            raise
        except (TypeError, ValueError, NotImplementedError) as error:  # SymPy's own refusals
            self.refuse(node, f"this can't be built: {_first_sentence(error)}")

    def built(self, node: syntax.Node) -> Expr:
        """Return what SymPy makes of a tree."""
        match node:
            case syntax.Number(numerator, denominator):
                return Rational(numerator, denominator)
            case syntax.Name():
                return self.name(node)
            case syntax.Call():
                return self.call(node)
            case syntax.Negative(operand):
                return -self.expression(operand)
            case syntax.Sum(terms):
                built = ((minus, self.expression(term)) for minus, term in terms)
                return sp.Add(*(-term if minus else term for minus, term in built))
            case syntax.Product(factors):
                return self.product(factors)
            case syntax.Power(base, exponent):
                return self.power(node, self.expression(base), self.expression(exponent))
            case syntax.Tuple():
                self.refuse(node, "a pair (…, …) belongs inside Piecewise or Derivative only")
            case syntax.Comparison():
                self.refuse(node, "a comparison where an expression should be")
        return self.refuse(node, "an expression is missing")

    def finite(self, node: syntax.Node, value: Expr) -> Expr:
        if isinstance(value, Rational) and _bits(value) > MAX_BITS:
            self.refuse(node, "a number too long to be meant")
        if value.args and not value.free_symbols and digits(value) > MOST_DIGITS:
            self.refuse(node, f"a number of more than {MOST_DIGITS:,.0f} digits before or behind the point")
        if value is sp.nan or value.has(sp.zoo, sp.oo, sp.S.NegativeInfinity, sp.nan):
            self.refuse(node, "this is infinite or undefined everywhere")
        return value

    def name(self, node: syntax.Name) -> Expr:
        symbol = self.scope.symbol(node.text + ("", "_dot", "_ddot")[min(node.primes, 2)])
        if symbol is not None and node.primes < 3:
            return symbol
        if node.primes:
            self.refuse(
                node,
                f"{node.text}{node.primes * chr(39)} is not a rate of a declared coordinate",
                "one or two primes after a coordinate; for a function write Derivative(f(t), t)",
            )
        if node.text in self.scope.functions:
            arguments = ", ".join(self.scope.functions[node.text])
            self.refuse(node, f"{node.text} is a function", f"write {node.text}({arguments})")
        if node.text in CONSTANTS:
            return CONSTANTS[node.text]
        if node.text in FUNCTIONS:
            self.refuse(node, f"{node.text} needs its argument in parentheses")
        return self.refuse(node, f"{node.text} is not declared", self.scope.near(node.text))

    def call(self, node: syntax.Call) -> Expr:
        name = node.function
        if name in self.scope.functions:
            return self.declared(node)
        if self.scope.symbol(name) is not None:
            self.refuse(
                node, f"{name} is a declared symbol and can't be applied to anything", "write * for a product"
            )
        if name == "Derivative":
            return self.derivative(node)
        if name == "Piecewise":
            return self.piecewise(node)
        if name not in FUNCTIONS:
            self.refuse(node, f"{name} is not a function of the language", self.scope.near(name))
        function, least, most = FUNCTIONS[name]
        if not least <= len(node.arguments) <= most:
            wanted = str(least) if least == most else f"{least} to {most}"
            self.refuse(node, f"{name} takes {wanted} argument(s), not {len(node.arguments)}")
        arguments = [self.expression(argument) for argument in node.arguments]
        if name == "exp":
            self.exponential(node, arguments[0])
        if function in (sp.Max, sp.Min):
            for argument, value in zip(node.arguments, arguments, strict=True):
                if value.is_extended_real is False:
                    self.refuse(argument, f"{name} compares real numbers, and this is not one")
        return function(*arguments)

    def declared(self, node: syntax.Call) -> Expr:
        wanted = self.scope.functions[node.function]
        if len(node.arguments) != len(wanted):
            self.refuse(
                node, f"{node.function} is declared with {len(wanted)} argument(s): {', '.join(wanted)}"
            )
        sign = self.scope.signs.get(node.function) or {"real": True}
        return sp.Function(node.function, **sign)(*(self.expression(argument) for argument in node.arguments))

    def derivative(self, node: syntax.Call) -> Expr:
        if len(node.arguments) < 2:
            self.refuse(
                node, "Derivative takes an expression and at least one variable", "write Derivative(f(t), t)"
            )
        value = self.expression(node.arguments[0])
        orders = [self.order(argument) for argument in node.arguments[1:]]
        if sum(order for _, order in orders) > 8:
            self.refuse(node, "a derivative of more than the 8th order")
        if isinstance(value, Coordinate) and all(variable == self.scope.time for variable, _ in orders):
            self.refuse(
                node, f"{value} is a coordinate here, not a function of the time", f"write {value}_dot"
            )
        return reduce(lambda f, order: f.diff(*order), orders, value)

    def order(self, node: syntax.Node) -> tuple[Symbol, int]:
        variable, order = node, 1
        if isinstance(node, syntax.Tuple):
            if len(node.items) != 2 or not isinstance(node.items[1], syntax.Number):
                self.refuse(node, "this should be (variable, order)", "write (t, 2)")
            variable = node.items[0]
            number = node.items[1]
            order = number.numerator
            if number.denominator != 1 or not 1 <= order <= 8:
                self.refuse(number, "the order of a derivative is a whole number from 1 to 8")
        symbol = self.expression(variable)
        if not isinstance(symbol, Symbol):
            self.refuse(node, "a derivative is taken with respect to a declared symbol")
        return symbol, order

    def piecewise(self, node: syntax.Call) -> Expr:
        if not 1 <= len(node.arguments) <= MAX_CHOICES:
            self.refuse(node, f"Piecewise takes 1 to {MAX_CHOICES} pieces")
        pieces: list[tuple[Expr, Boolean]] = []
        for piece in node.arguments:
            if not isinstance(piece, syntax.Tuple) or len(piece.items) != 2:
                self.refuse(
                    piece, "a piece is (expression, condition)", "write Piecewise((x, x > 0), (0, True))"
                )
            pieces.append((self.expression(piece.items[0]), self.condition(piece.items[1])))
        return self.joined(pieces)

    def joined(self, pieces: Sequence[tuple[Expr, Boolean]]) -> Expr:
        """Return pieces as one function."""
        return sp.Piecewise(*pieces)

    def condition(self, node: syntax.Node) -> Boolean:
        """Return the condition of a tree: a chain of comparisons, ``Ne(a, b)``, ``Eq(a, b)``, or True."""
        match node:
            case syntax.Name(text="True"):
                return sp.true
            case syntax.Call(function="Ne", arguments=(left, right)) if "Ne" not in self.scope.functions:
                return self.condition(syntax.Comparison((left, right), ("!=",), node.column))
            case syntax.Call(function="Eq", arguments=(left, right)) if "Eq" not in self.scope.functions:
                return self.condition(syntax.Comparison((left, right), ("==",), node.column))
            case syntax.Comparison(operands, relations):
                if "=" in relations:
                    self.refuse(
                        node, "an equation where a condition should be", "write < <= > >= or Ne(a, b)"
                    )
                sides = [self.expression(side) for side in operands]
                pairs = zip(sides, relations, sides[1:], strict=False)
                try:
                    chain = (_related(left, relation, right) for left, relation, right in pairs)
                    return sp.And(*chain)
                except TypeError:
                    self.refuse(node, "imaginary numbers can't be compared")
                except (ValueError, NotImplementedError) as error:
                    self.refuse(node, f"this can't be compared: {_first_sentence(error)}")
            case _:
                pass
        return self.refuse(node, "a condition is missing", "write < <= > >= or Ne(a, b)")

    def product(self, factors: tuple[tuple[bool, syntax.Node], ...]) -> Expr:
        built: list[Expr] = []
        bits = 0
        for divides, node in factors:
            factor = self.expression(node)
            if divides and factor is sp.S.Zero:
                self.refuse(node, "division by zero")
            bits += _bits(factor)
            if bits > MAX_BITS:
                self.refuse(node, "the product is a number too long to be meant")
            built.append(1 / factor if divides else factor)
        return sp.Mul(*built)

    def power(self, node: syntax.Power, base: Expr, exponent: Expr) -> Expr:
        coefficient = abs(exponent.as_coeff_Mul()[0])
        if isinstance(coefficient, Rational):
            if coefficient > MAX_EXPONENT:
                self.refuse(node, f"an exponent beyond {MAX_EXPONENT}")
            if max(coefficient.p, coefficient.q) > MAX_EXPONENT:
                self.refuse(node, f"an exponent whose numerator or denominator is beyond {MAX_EXPONENT}")
            if _bits(base) * max(1, int(coefficient)) > MAX_BITS:
                self.refuse(node, "the power is a number too long to be meant")
        if base is sp.S.Zero and isinstance(exponent, Rational) and exponent < 0:
            self.refuse(node, "division by zero")
        self.exponential(node, exponent)
        return sp.Pow(base, exponent)

    def exponential(self, node: syntax.Node, exponent: Expr) -> None:
        """Refuse exponents like 10**9*log(2), which SymPy turns into 2**10**9."""
        if not exponent.has(sp.log):
            return
        for term in sp.Add.make_args(exponent):
            if abs(term.as_coeff_Mul()[0]) > MAX_EXPONENT:
                self.refuse(node, f"a multiple of a logarithm beyond {MAX_EXPONENT} in an exponent")


def _related(left: Expr, relation: str, right: Expr) -> Boolean:
    """Return a relation, a number on its right."""
    if left.is_number and not right.is_number:
        left, right = right, left
        relation = relation.translate(str.maketrans("<>", "><"))
    return RELATIONS[relation](left, right)


def _first_sentence(error: Exception) -> str:
    return str(error).strip().partition("\n")[0].rstrip(".") or type(error).__name__


def _bits(value: Expr) -> int:
    """Return the length of the rational number in front of an expression, at least 1."""
    number = value.as_coeff_Mul()[0]
    if not isinstance(number, Rational):
        return 1
    return max(int(number.p).bit_length(), int(number.q).bit_length(), 1)


def exact(value: Decimal | float | int | str) -> Rational:
    """Return the exact rational that a number in a sheet spells.

    Examples
    --------
    >>> exact(0.1)
    1/10
    """
    return cast("Rational", Rational(str(value)))
