"""Juxtaposition: factors side by side as a product, `2 m g l (1 - cos(theta))`, where a sheet asks for it.

Only what can be read in one way is read. Refused, with what to write instead, are ``a/b c``, ``x**2y``, ``x 2``,
``2e3`` where ``e`` is declared, and a symbol before a bracket that could be its argument: ``f(x)`` with a bare name
inside, or a coordinate before a bracket with the time in it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.expression.symbols.symbol import Coordinate, Momentum
from canon.expression.text.syntax import LanguageError, Name, Negative, Node, Parser, Power, Product, Tuple
from canon.expression.text.tokens import Token, tokens

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["parse_juxtaposed"]

_PRODUCT_OR_VALUE = "write * for a product; a function is declared in functions"


def parse_juxtaposed(text: str, scope: Scope) -> Node:
    """Return the syntax tree of a text in which factors may stand side by side.

    Raises
    ------
    LanguageError
        Where the text is not in the grammar, or could be read in two ways.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.expression.parse import Scope, parse_expression
    >>> theta, (m, g, l) = coordinates("theta"), parameters("m g l")
    >>> scope = Scope({s.name: s for s in (theta, m, g, l)}, implicit=True)
    >>> parse_expression("2 m g l (1 - cos(theta))", scope) == parse_expression("2*m*g*l*(1 - cos(theta))", scope)
    True
    >>> parse_expression("g/l sin(theta)", scope)
    Traceback (most recent call last):
        ...
    canon.expression.text.tokens.LanguageError: column 5: does the quotient end before this factor?; write ...
    g/l sin(theta)
        ^
    """
    return _Juxtaposed(text, tokens(text), scope).whole()


class _Juxtaposed(Parser):
    """The grammar with one rule more: a factor may follow a factor."""

    def __init__(self, text: str, tokens: list[Token], scope: Scope) -> None:
        super().__init__(text, tokens)
        self.scope = scope

    def product(self) -> Node:
        column = self.token.column
        factors = [(False, self.signed())]
        while True:
            if sign := self.take("*", "/"):
                factors.append((sign.text == "/", self.signed()))
            elif self.token.kind in ("number", "name") or self.token.text == "(":
                factors.append((False, self.beside(*factors[-1])))
            else:
                return Product(tuple(factors), column) if len(factors) > 1 else factors[0][1]

    def beside(self, divides: bool, before: Node) -> Node:
        """Return the factor that stands directly after another one."""
        token, last = self.token, self.tokens[self.at - 1]
        if token.kind == "number":
            raise self.fault("a number after a factor", "write x_2, x**2 or 2*x, whichever is meant")
        if divides:
            raise self.fault("does the quotient end before this factor?", "write a/(b*c) or a/b*c")
        bare = before.operand if isinstance(before, Negative) else before
        if isinstance(bare, Power) and not self.text[token.column - 2].isspace():
            raise self.fault(
                "does this still belong to the exponent?", "put a space or * before it, or brackets"
            )
        factor = self.power()
        if token.text == "(" and last.kind == "name":
            self.no_value(token, last, factor.base if isinstance(factor, Power) else factor)
        return factor

    def no_value(self, opening: Token, name: Token, inside: Node) -> None:
        """Refuse a symbol before a bracket that could be the argument of a function of that name."""
        symbol = self.scope.symbol(name.text)
        moves = isinstance(symbol, Coordinate | Momentum) or name.primes > 0
        clock = any(
            token.text == self.scope.time.name
            for token in self.tokens[: self.at]
            if self.within(token, opening)
        )
        if isinstance(inside, Name | Tuple) or (moves and clock):
            raise self.fault(
                f"is {name.text} applied to this, or multiplied by it?", _PRODUCT_OR_VALUE, opening
            )

    def within(self, token: Token, opening: Token) -> bool:
        return token.column > opening.column and token.kind == "name"

    def named(self, token: Token) -> Node:
        if self.scope.declares(token.text):
            return Name(token.text, token.primes, token.column)
        return super().named(token)

    def number(self, token: Token) -> Node:
        letter = token.text.lower().find("e")
        ending = token.text[letter:]
        if letter > 0 and (self.scope.declares(ending) or self.scope.declares(ending[0])):
            raise LanguageError(
                self.text,
                token.column,
                f"{token.text[:20]} is one number, or a product with {ending[0]}?",
                "write 2*10**3 for the number, * for the product",
            )
        return super().number(token)
