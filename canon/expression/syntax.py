"""The grammar of the expression language: text in, syntax tree out, nothing evaluated.

Every bound that keeps hostile text harmless is checked here, before anything is built: length, number of
tokens, digits of a number, nesting.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from typing import TypeAlias

__all__ = [
    "Call",
    "Comparison",
    "LanguageError",
    "Name",
    "Negative",
    "Node",
    "Number",
    "Power",
    "Product",
    "Sum",
    "Tuple",
    "parse_syntax",
]

MAX_CHARACTERS = 50_000
MAX_TOKENS = 20_000
MAX_DIGITS = 1_000
MAX_NESTING = 64


class LanguageError(ValueError):
    """Text that is not in the expression language, and where.

    Parameters
    ----------
    text
        The whole text.
    column
        Where it goes wrong, counted from 1.
    reason
        What is wrong there.
    remedy
        What to write instead; empty where there is no single answer.
    """

    def __init__(self, text: str, column: int, reason: str, remedy: str = "") -> None:
        super().__init__(text, column, reason, remedy)
        self.text = text
        self.column = column
        self.reason = reason
        self.remedy = remedy

    @property
    def message(self) -> str:
        """Reason and remedy on one line."""
        return f"{self.reason}; {self.remedy}" if self.remedy else self.reason

    def caret(self) -> str:
        """Return the text around the fault with a caret under the column."""
        start = max(0, self.column - 41)
        shown = re.sub(r"[^\S ]", " ", self.text[start : start + 80])
        return f"{shown}\n{' ' * (self.column - 1 - start)}^"

    def __str__(self) -> str:
        return f"column {self.column}: {self.message}\n{self.caret()}"


@dataclass(frozen=True, slots=True)
class Number:
    """An exact decimal: numerator over a power of ten."""

    numerator: int
    denominator: int
    column: int


@dataclass(frozen=True, slots=True)
class Name:
    """A name; ``primes`` counts the dots of Newton written as ``'``."""

    text: str
    primes: int
    column: int


@dataclass(frozen=True, slots=True)
class Call:
    """A function applied to arguments."""

    function: str
    arguments: tuple[Node, ...]
    column: int


@dataclass(frozen=True, slots=True)
class Tuple:
    """A parenthesised pair, as in ``(t, 2)`` or ``(expr, condition)``."""

    items: tuple[Node, ...]
    column: int


@dataclass(frozen=True, slots=True)
class Negative:
    """An operand with a minus sign before it."""

    operand: Node
    column: int


@dataclass(frozen=True, slots=True)
class Sum:
    """Terms, each with whether it is subtracted."""

    terms: tuple[tuple[bool, Node], ...]
    column: int


@dataclass(frozen=True, slots=True)
class Product:
    """Factors, each with whether it divides."""

    factors: tuple[tuple[bool, Node], ...]
    column: int


@dataclass(frozen=True, slots=True)
class Power:
    """A base and an exponent."""

    base: Node
    exponent: Node
    column: int


@dataclass(frozen=True, slots=True)
class Comparison:
    """Operands with the relations between neighbours, ``=`` among them."""

    operands: tuple[Node, ...]
    relations: tuple[str, ...]
    column: int


Node: TypeAlias = Number | Name | Call | Tuple | Negative | Sum | Product | Power | Comparison

_RELATIONS = ("<", "<=", ">", ">=", "!=", "==", "=")
_TOKEN = re.compile(
    r"(?P<space>\s+)"
    r"|(?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[^\W\d][\w\u0307\u0308]*'*)"
    r"|(?P<operator>\*\*|<=|>=|!=|==|[-+*/()<>=,−·×])"
)
_GREEK = {
    "α": "alpha", "β": "beta", "γ": "gamma", "δ": "delta", "ε": "epsilon", "ζ": "zeta", "η": "eta", "θ": "theta",
    "ϑ": "theta", "ι": "iota", "κ": "kappa", "λ": "lambda", "μ": "mu", "ν": "nu", "ξ": "xi", "π": "pi", "ρ": "rho",
    "σ": "sigma", "τ": "tau", "υ": "upsilon", "φ": "phi", "ϕ": "phi", "χ": "chi", "ψ": "psi", "ω": "omega",
    "Γ": "Gamma", "Δ": "Delta", "Θ": "Theta", "Λ": "Lambda", "Ξ": "Xi", "Π": "Pi", "Σ": "Sigma", "Υ": "Upsilon",
    "Φ": "Phi", "Ψ": "Psi", "Ω": "Omega",
}  # fmt: skip
_ALIKE = {"−": "-", "·": "*", "×": "*"}
_NOT_HERE = {
    "^": "write ** for a power",
    "[": "write ( ) for grouping; there is no indexing",
    "{": "write ( ) for grouping",
    '"': "there are no string literals",
    "'": "a prime belongs directly after the name of a coordinate; there are no string literals",
    ".": "attributes are not part of the language; write 0.5 for a decimal",
    ":": "lambdas and slices are not part of the language",
    "√": "write sqrt( )",
}


@dataclass(frozen=True, slots=True)
class _Token:
    kind: str
    text: str
    column: int
    primes: int = 0


def parse_syntax(text: str) -> Node:
    """Return the syntax tree of one expression, condition or equation.

    Raises
    ------
    LanguageError
        Where the text is too large or not in the grammar.
    """
    return _Parser(text, _tokens(text)).whole()


def _tokens(text: str) -> list[_Token]:
    if len(text) > MAX_CHARACTERS:
        raise LanguageError(
            text,
            MAX_CHARACTERS,
            f"{len(text)} characters, and at most {MAX_CHARACTERS} are read",
            "split the claim",
        )
    found: list[_Token] = []
    at = 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise _stray(text, at)
        if match.lastgroup != "space":
            found.append(_token(text, match))
            if len(found) > MAX_TOKENS:
                raise LanguageError(
                    text, at + 1, f"more than {MAX_TOKENS} numbers, names and signs", "split the claim"
                )
        at = match.end()
    found.append(_Token("end", "", len(text) + 1))
    return found


def _token(text: str, match: re.Match[str]) -> _Token:
    column = match.start() + 1
    word = match.group()
    if match.lastgroup == "number":
        if sum(c.isdigit() for c in word) > MAX_DIGITS:
            raise LanguageError(text, column, f"a number of more than {MAX_DIGITS} digits")
        return _Token("number", word, column)
    if match.lastgroup == "name":
        return _named(text, word, column)
    return _Token("operator", _ALIKE.get(word, word), column)


def _named(text: str, word: str, column: int) -> _Token:
    """Spell Greek letters and Newton's dots the plain way."""
    primes = len(word) - len(word.rstrip("'"))
    name = unicodedata.normalize("NFD", word.rstrip("'"))
    if name.endswith(("\u0307\u0307", "\u0308")):
        primes += 2
    elif name.endswith("\u0307"):
        primes += 1
    plain = "".join(_GREEK.get(c, c) for c in name.rstrip("\u0307\u0308"))
    if not plain.isascii():
        odd = next(i for i, c in enumerate(word) if not c.isascii() and c not in _GREEK)
        raise LanguageError(
            text,
            column + odd,
            f"{word[odd]!r} (U+{ord(word[odd]):04X}) is not a letter of the language",
            "names are made of Latin or Greek letters, digits and _",
        )
    return _Token("name", plain, column, primes)


def _stray(text: str, at: int) -> LanguageError:
    character = text[at]
    shown = repr(character) if character.isascii() else f"{character!r} (U+{ord(character):04X})"
    return LanguageError(text, at + 1, f"{shown} is not part of the language", _NOT_HERE.get(character, ""))


class _Parser:
    """Recursive descent; one method for each level of precedence, as in Python's own grammar."""

    def __init__(self, text: str, tokens: list[_Token]) -> None:
        self.text = text
        self.tokens = tokens
        self.at = 0
        self.depth = 0

    @property
    def token(self) -> _Token:
        return self.tokens[self.at]

    def fault(self, reason: str, remedy: str = "", token: _Token | None = None) -> LanguageError:
        return LanguageError(self.text, (token or self.token).column, reason, remedy)

    def take(self, *operators: str) -> _Token | None:
        token = self.token
        if token.kind == "operator" and token.text in operators:
            self.at += 1
            return token
        return None

    def whole(self) -> Node:
        node = self.comparison()
        token = self.token
        if token.kind == "end":
            return node
        if token.text in (")", ","):
            raise self.fault(f"{token.text!r} without an opening '('")
        raise self.fault(f"an operator is missing before {token.text!r}", "write * for a product")

    def comparison(self) -> Node:
        column = self.token.column
        operands = [self.sum()]
        relations: list[str] = []
        while relation := self.take(*_RELATIONS):
            relations.append(relation.text)
            operands.append(self.sum())
        return Comparison(tuple(operands), tuple(relations), column) if relations else operands[0]

    def sum(self) -> Node:
        column = self.token.column
        terms = [(False, self.product())]
        while sign := self.take("+", "-"):
            terms.append((sign.text == "-", self.product()))
        return Sum(tuple(terms), column) if len(terms) > 1 else terms[0][1]

    def product(self) -> Node:
        column = self.token.column
        factors = [(False, self.signed())]
        while sign := self.take("*", "/"):
            factors.append((sign.text == "/", self.signed()))
        return Product(tuple(factors), column) if len(factors) > 1 else factors[0][1]

    def signed(self) -> Node:
        column = self.token.column
        minus = False
        while sign := self.take("+", "-"):
            minus ^= sign.text == "-"
        node = self.power()
        return Negative(node, column) if minus else node

    def power(self) -> Node:
        base = self.atom()
        if sign := self.take("**"):
            self.deeper(sign)
            node = Power(base, self.signed(), sign.column)
            self.depth -= 1
            return node
        return base

    def atom(self) -> Node:
        token = self.token
        self.at += 1
        if token.kind == "number":
            return self.number(token)
        if token.kind == "name":
            return self.named(token)
        if token.text == "(":
            return self.group(token)
        self.at -= 1
        if token.kind == "end":
            raise self.fault("the expression ends too early")
        raise self.fault(f"{token.text!r} where a number, a name or '(' should be")

    def number(self, token: _Token) -> Node:
        mantissa, _, exponent = token.text.lower().partition("e")
        whole, _, fraction = mantissa.partition(".")
        power = int(exponent or "0") - len(fraction)
        if abs(power) > MAX_DIGITS:
            raise self.fault(f"a power of ten beyond 10**{MAX_DIGITS}", token=token)
        digits = int(whole + fraction)
        return Number(digits * 10 ** max(power, 0), 10 ** max(-power, 0), token.column)

    def named(self, token: _Token) -> Node:
        if token.primes or self.token.text != "(" or self.token.kind != "operator":
            return Name(token.text, token.primes, token.column)
        opening = self.token
        self.at += 1
        self.deeper(opening)
        arguments: list[Node] = []
        while not self.take(")"):
            if arguments and not self.take(","):
                raise self.unclosed(opening)
            arguments.append(self.comparison())
        self.depth -= 1
        return Call(token.text, tuple(arguments), token.column)

    def group(self, opening: _Token) -> Node:
        self.deeper(opening)
        items = [self.comparison()]
        comma = False
        while not self.take(")"):
            if not self.take(","):
                raise self.unclosed(opening)
            comma = True
            if self.token.text != ")":
                items.append(self.comparison())
        self.depth -= 1
        return Tuple(tuple(items), opening.column) if comma else items[0]

    def deeper(self, token: _Token) -> None:
        self.depth += 1
        if self.depth > MAX_NESTING:
            raise self.fault(f"nested more than {MAX_NESTING} deep", token=token)

    def unclosed(self, opening: _Token) -> LanguageError:
        if self.token.kind == "end":
            return self.fault("'(' is never closed", token=opening)
        if self.token.text == "for":
            return self.fault("comprehensions are not part of the language")
        return self.fault(
            f"an operator or ')' is missing before {self.token.text!r}", "write * for a product"
        )
