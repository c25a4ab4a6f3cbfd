"""Juxtaposition: formulas as people type them, factors side by side, ``2 m g l (1 - cos θ)``, ``½mẋ²``.

Only what can be read in one way is read. Refused, with both readings, are ``a/b c``, ``x^2y``, ``x 2``, ``2e3`` where
``e`` is declared, and a symbol before a bracket that could be its argument: ``f(x)`` with a bare name inside, or a
coordinate before a bracket with the time in it. ``theta(t)`` is the coordinate itself.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING
from unicodedata import numeric

from canon.expression.text.applied_functions import applied, constructed, with_brackets
from canon.expression.text.declared_names import Words
from canon.expression.text.differentials import PARTIAL, derivative
from canon.expression.text.quotients import divisor, ended
from canon.expression.text.syntax import (
    Call,
    LanguageError,
    Name,
    Negative,
    Node,
    Number,
    Parser,
    Power,
    Product,
    Tuple,
)
from canon.expression.text.tokens import MAX_TOKENS, Token, tokens
from canon.expression.text.units import OF_MECHANICS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.expression.text.scope import Scope

__all__ = ["Reader", "parse_juxtaposed"]

_PRODUCT_OR_VALUE = "write * for a product; a function is declared in functions"
_CLOSING = {"(": ")", "[": "]", "{": "}"}


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
    >>> scope = Scope({s.name: s for s in (theta, m, g, l)})
    >>> parse_expression("2mgl (1 - cos θ)", scope) == parse_expression("2*m*g*l*(1 - cos(theta))", scope)
    True
    >>> parse_expression("g/2l", scope)
    Traceback (most recent call last):
        ...
    canon.expression.text.tokens.LanguageError: column 4: g/2l is g/2*l or g/(2*l)?; write the one that is meant
    g/2l
       ^
    """
    return Reader(text, scope).whole()


class Reader(Parser):
    """The grammar with what people leave out: signs of multiplication, brackets of arguments."""

    def __init__(self, text: str, scope: Scope) -> None:
        self.words = Words(text, scope)
        super().__init__(text, list(_words(tokens(text), self.words)))
        self.scope = scope
        self.bars = 0
        self.bare_end = -1
        """Where the last argument without brackets ended."""

    def starts(self, token: Token) -> bool:
        """Tell whether a factor can begin with a token."""
        if token.kind in ("number", "vulgar", "name", "string"):
            return True
        return token.text in ("(", "[", "{", "√", "∂") or (token.text == "|" and not self.bars)

    def product(self) -> Node:
        """Read factors with * and / between them, or nothing."""
        column, first = self.token.column, self.at
        factors = [(False, self.signed())]
        starts = [first]
        while True:
            begins = self.at
            if sign := self.take("*", "/"):
                self.after_bare(sign)
                factors.append((sign.text == "/", self.signed()))
                if sign.text == "/":
                    factors[-1] = (True, divisor(self, factors))
            elif self.starts(self.token):
                factors.append((False, self.beside(factors, starts)))
            else:
                return Product(tuple(factors), column) if len(factors) > 1 else factors[0][1]
            starts.append(begins)

    def after_bare(self, sign: Token) -> None:
        """Refuse a quotient that could belong to an argument without brackets: ``sin x/2``."""
        if sign.text == "/" and self.bare_end == self.at - 1:
            raise self.fault(
                "does this divide the function or its argument?", "write sin(x)/2 or sin(x/2)", sign
            )

    def beside(self, factors: list[tuple[bool, Node]], starts: list[int]) -> Node:
        """Return the factor that stands directly after another one."""
        token, last = self.token, self.tokens[self.at - 1]
        divides, before = factors[-1]
        if token.kind in ("number", "vulgar", "string"):
            raise self.fault("a number after a factor", "write x_2, x**2 or 2*x, whichever is meant")
        if token.text == "for" and not self.scope.declares("for"):
            raise self.fault("comprehensions are not part of the language")
        if divides:
            ended(self, factors, starts)
        bare = before.operand if isinstance(before, Negative) else before
        exponent = isinstance(bare, Power) and last.kind != "super" and last.text not in (")", "]", "}")
        if exponent and token.tight and self.bare_end != self.at:
            raise self.fault(
                "does this still belong to the exponent?", "put a space or * before it, or brackets"
            )
        if token.text == "|" and token.tight:
            raise self.fault("does this bar open or close?", "write Abs( ) for one of the moduli")
        if token.tight and token.text in _CLOSING and self.bare_end == self.at:
            raise self.fault(
                "does this factor still belong to the argument?", "write sin(x)*(y) or sin(x*(y))"
            )
        factor = self.power()
        if token.text in _CLOSING and last.kind == "name":
            self.no_value(token, last, factor.base if isinstance(factor, Power) else factor)
        return factor

    def no_value(self, opening: Token, name: Token, inside: Node) -> None:
        """Refuse a symbol before a bracket that could be the argument of a function of that name."""
        if not (self.scope.declares(name.text) or name.primes):
            return
        moves = self.scope.moves(name.text) or name.primes > 0
        clock = any(
            token.text == self.scope.time.name
            for token in self.tokens[: self.at]
            if token.column > opening.column and token.kind == "name"
        )
        bare = isinstance(inside, Name) and not inside.primes
        clock = clock and not isinstance(inside, Name)
        if bare or isinstance(inside, Tuple) or (isinstance(inside, Number) and moves) or (moves and clock):
            raise self.fault(
                f"is {name.text} applied to this, or multiplied by it?", _PRODUCT_OR_VALUE, opening
            )

    def power(self) -> Node:
        """Read a base, and an exponent if there is one."""
        start = self.at
        base = self.atom()
        token = self.token
        if (token.kind == "super" or token.text in ("**", "^")) and self.bare_end == self.at > start:
            raise self.fault("does this raise the function or its argument?", "write sin(x)**2 or sin(x**2)")
        if token.kind == "super":
            self.at += 1
            return Power(base, self.raised(token), token.column)
        if sign := self.take("**", "^"):
            self.deeper(sign)
            node = Power(base, self.exponent(sign), sign.column)
            self.depth -= 1
            return node
        return base

    def raised(self, token: Token) -> Node:
        """Return the exponent that small figures spell."""
        if token.text.endswith("n"):
            node: Node = Name("n", 0, token.column)
        else:
            node = Number(int(token.text.lstrip("+-")), 1, token.column)
        return Negative(node, token.column) if token.text.startswith("-") else node

    def exponent(self, sign: Token) -> Node:
        """Read an exponent; ``x^1/2`` could be x or its root."""
        begin = self.token
        node = self.signed()
        if begin.text == "1" and self.token.text == "/" and self.token.tight:
            raise self.fault("is only 1 raised, or the fraction?", "write x**(1/2), or x/2", begin)
        if begin.text == "-" and sign.text == "^" and self.starts(self.token) and self.token.tight:
            raise self.fault("does this still belong to the exponent?", "write brackets, e^(-a*t)")
        return node

    def atom(self) -> Node:
        """Read a number, a name, a call or a bracket."""
        token = self.token
        match token.text:
            case "√":
                self.at += 1
                return self.root(token)
            case "∂" if (node := derivative(self)) is not None:
                return node
            case "|":
                self.at += 1
                return self.modulus(token)
            case "[" | "{":
                self.at += 1
                return self.group(token)
            case _:
                pass
        if token.kind == "vulgar":
            self.at += 1
            value = Fraction(numeric(token.text)).limit_denominator(10)
            return Number(value.numerator, value.denominator, token.column)
        if token.kind == "string":
            raise self.fault("there are no string literals")
        return super().atom()

    def root(self, sign: Token) -> Node:
        """Read what stands under √: a bracket, a number or a name."""
        self.deeper(sign)
        radicand = self.atom()
        self.depth -= 1
        last = self.tokens[self.at - 1]
        bracketed = last.text in (")", "]", "}")
        follows = self.token
        number = isinstance(radicand, Number)
        more = (
            (follows.tight and self.starts(follows))
            or (follows.text in ("/", "^", "**") and not number)
            or follows.kind == "super"
        )
        if not bracketed and more:
            raise self.fault("how far does the root reach?", "write sqrt( ) around what is under it", sign)
        return Call("sqrt", (radicand,), sign.column)

    def modulus(self, bar: Token) -> Node:
        """Read what stands between two bars."""
        self.deeper(bar)
        self.bars += 1
        inside = self.sum()
        self.bars -= 1
        self.depth -= 1
        if not self.take("|"):
            raise self.fault("'|' is never closed", token=bar)
        return Call("Abs", (inside,), bar.column)

    def group(self, opening: Token) -> Node:
        """Read a bracket of any shape, or the pair in it."""
        bars, self.bars = self.bars, 0
        self.deeper(opening)
        items = [self.comparison()]
        comma = False
        while not self.take(_CLOSING[opening.text]):
            if not self.take(","):
                raise self.unclosed(opening)
            comma = True
            if self.token.text != _CLOSING[opening.text]:
                items.append(self.comparison())
        self.depth -= 1
        self.bars = bars
        return Tuple(tuple(items), opening.column) if comma else items[0]

    def unclosed(self, opening: Token) -> LanguageError:
        """Return the error of a bracket that does not end here."""
        if self.token.text in (")", "]", "}") and self.token.text != _CLOSING[opening.text]:
            return self.fault(
                f"{opening.text!r} is closed by {self.token.text!r}", "close each bracket as it was opened"
            )
        if self.token.kind == "end":
            return self.fault(f"{opening.text!r} is never closed", token=opening)
        return super().unclosed(opening)

    def named(self, token: Token) -> Node:
        """Read a name, the call of a function, a function without brackets, or a derivative."""
        opening = self.token
        bracket = opening.text in ("(", "[")
        if token.text in self.scope.functions:
            return self.of_function(token, bracket)
        if self.scope.declares(token.text):
            if bracket and opening.tight and self.at_time(token):
                self.at += 3
                if token.primes:
                    return Name(token.text, token.primes, token.column)
                return Call(token.text, (Name(self.scope.time.name, 0, opening.column),), token.column)
            if opening.text == "[" and opening.tight:
                raise self.fault("there is no indexing", "write ( ) for grouping, * for a product")
            return Name(token.text, token.primes, token.column)
        if token.text == "d" and (node := derivative(self, token)) is not None:
            return node
        if (node := constructed(self, token)) is not None:
            return node
        if (node := applied(self, token)) is not None:
            return node
        if bracket and opening.tight:
            return self.called(token)
        return Name(token.text, token.primes, token.column)

    def of_function(self, token: Token, bracket: bool) -> Node:
        """Read a value of a declared function, or with primes its derivative."""
        if not token.primes:
            return self.called(token) if bracket else Name(token.text, 0, token.column)
        variables = self.scope.functions[token.text]
        arguments = with_brackets(self) if bracket else tuple(Name(v, 0, token.column) for v in variables)
        if len(variables) != 1 or len(arguments) != 1 or not isinstance(arguments[0], Name):
            raise self.fault(
                f"a prime after {token.text}: with respect to what?",
                f"write Derivative({token.text}(…), x)",
                token,
            )
        value = Call(token.text, arguments, token.column)
        return Call(PARTIAL, (value, arguments[0], Number(token.primes, 1, token.column)), token.column)

    def called(self, token: Token) -> Node:
        """Read the arguments of a call in round or square brackets."""
        opening = self.token
        arguments = with_brackets(self)
        if opening.text == "[" and token.text not in self.scope.functions:
            raise self.fault(f"{token.text}[…] is not part of the language", "write round brackets", opening)
        return Call(token.text, arguments, token.column)

    def at_time(self, name: Token) -> bool:
        """Tell whether ``(t)`` follows what moves."""
        if not (self.scope.moves(name.text) or name.primes) or self.at + 2 >= len(self.tokens):
            return False
        opening, inside, closing = self.tokens[self.at : self.at + 3]
        return (
            name.text != self.scope.time.name
            and inside.text == self.scope.time.name
            and not inside.primes
            and closing.text == _CLOSING[opening.text]
        )

    def number(self, token: Token) -> Node:
        """Return the exact value of a decimal, of one in degrees as well."""
        letter = token.text.lower().find("e")
        ending = token.text[letter:]
        if letter > 0 and (self.scope.declares(ending) or self.scope.declares(ending[0])):
            raise LanguageError(
                self.text,
                token.column,
                f"{token.text[:20]} is one number, or a product with {ending[0]}?",
                "write 2*10**3 for the number, * for the product",
            )
        node = super().number(token)
        if self.take("°"):
            degrees = Product(
                ((False, Name("pi", 0, token.column)), (True, Number(180, 1, token.column))), token.column
            )
            return Product(((False, node), (False, degrees)), token.column)
        return node


def _words(found: list[Token], words: Words) -> Iterator[Token]:
    """Yield the tokens with each word read; all words that can be read in two ways are told at once."""
    faults: list[LanguageError] = []
    count = 0
    for before, token, after in zip([found[-1], *found], found, [*found[1:], found[-1]], strict=False):
        if token.kind != "name":
            yield token
            continue
        try:
            read = words.read(token, after.text in ("(", "[") and after.tight)
            if before.kind == "number" and token.text in OF_MECHANICS and len(read) > 1:
                shown = "*".join(part.text for part in read)
                told = f"is {token.text} a unit, or {shown}?"
                raise LanguageError(words.text, token.column, told, f"write {shown}, or [{token.text}]")
            count += len(read)
            if count > MAX_TOKENS:
                told = f"more than {MAX_TOKENS} numbers, names and signs"
                raise LanguageError(words.text, token.column, told, "split the claim")
            yield from read
        except LanguageError as fault:
            faults.append(fault)
    if faults:
        raise LanguageError.together(faults)
