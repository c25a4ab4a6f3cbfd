"""Syntax of the expression language: text in, syntax tree out, nothing evaluated.

Every bound that keeps hostile text harmless is checked here, before anything is built: length, number of
tokens, digits of a number, nesting.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from canon.expression.text.tokens import MAX_CHARACTERS, MAX_DIGITS, MAX_TOKENS, LanguageError, Token

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = [
    "MAX_CHARACTERS",
    "MAX_TOKENS",
    "Call",
    "Comparison",
    "LanguageError",
    "Name",
    "Negative",
    "Node",
    "Number",
    "Parser",
    "Power",
    "Product",
    "Sum",
    "Tuple",
    "children",
    "equation",
    "parts",
]

MAX_NESTING = 64


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


def children(node: Node) -> tuple[Node, ...]:
    """Return the nodes directly inside a node."""
    match node:
        case Call(_, arguments):
            return arguments
        case Tuple(items) | Comparison(items):
            return items
        case Negative(operand):
            return (operand,)
        case Sum(pairs) | Product(pairs):
            return tuple(part for _, part in pairs)
        case Power(base, exponent):
            return (base, exponent)
        case _:
            return ()


def parts(node: Node) -> Iterator[Node]:
    """Yield a node and everything inside it."""
    stack = [node]
    while stack:
        part = stack.pop()
        yield part
        stack += reversed(children(part))


def equation(node: Node) -> tuple[Node, Node] | None:
    """Return the sides of ``a = b``, ``a == b`` or ``Eq(a, b)``; None for anything else."""
    match node:
        case Comparison((left, right), ("=" | "==",)) | Call("Eq", (left, right)):
            return left, right
        case _:
            return None


class Parser(ABC):
    """Recursive descent; one method for each level of precedence, as in Python's own grammar.

    Factors and brackets are left to those who know the declared names.
    """

    def __init__(self, text: str, tokens: list[Token]) -> None:
        self.text = text
        self.tokens = tokens
        self.at = 0
        self.depth = 0

    @property
    def token(self) -> Token:
        """The token that comes next."""
        return self.tokens[self.at]

    def fault(self, reason: str, remedy: str = "", token: Token | None = None) -> LanguageError:
        """Return the error of a token, the next one unless given."""
        return LanguageError(self.text, (token or self.token).column, reason, remedy)

    def take(self, *operators: str) -> Token | None:
        """Take the next token if it is one of these operators."""
        token = self.token
        if token.kind == "operator" and token.text in operators:
            self.at += 1
            return token
        return None

    def whole(self) -> Node:
        """Return the tree of the whole text."""
        node = self.comparison()
        token = self.token
        if token.kind == "end":
            return node
        if token.text in (")", ",", "]", "}"):
            raise self.fault(f"{token.text!r} without an opening bracket")
        raise self.fault(f"an operator is missing before {token.text!r}", "write * for a product")

    def comparison(self) -> Node:
        """Read ``a < b = c``, or one sum."""
        column = self.token.column
        operands = [self.sum()]
        relations: list[str] = []
        while relation := self.take(*_RELATIONS):
            relations.append(relation.text)
            operands.append(self.sum())
        return Comparison(tuple(operands), tuple(relations), column) if relations else operands[0]

    def sum(self) -> Node:
        """Read terms with signs between them."""
        column = self.token.column
        terms = [(False, self.product())]
        while sign := self.take("+", "-"):
            terms.append((sign.text == "-", self.product()))
        return Sum(tuple(terms), column) if len(terms) > 1 else terms[0][1]

    @abstractmethod
    def product(self) -> Node:
        """Read factors."""

    def signed(self) -> Node:
        """Read a factor with signs before it."""
        column = self.token.column
        minus = False
        while sign := self.take("+", "-"):
            minus ^= sign.text == "-"
        node = self.power()
        return Negative(node, column) if minus else node

    @abstractmethod
    def power(self) -> Node:
        """Read a base, and an exponent if there is one."""

    def atom(self) -> Node:
        """Read a number, a name, a call or a bracket."""
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

    def number(self, token: Token) -> Node:
        """Return the exact value of a decimal."""
        mantissa, _, exponent = token.text.lower().partition("e")
        whole, _, fraction = mantissa.partition(".")
        power = int(exponent or "0") - len(fraction)
        if abs(power) > MAX_DIGITS:
            raise self.fault(f"a power of ten beyond 10**{MAX_DIGITS}", token=token)
        digits = int(whole + fraction)
        return Number(digits * 10 ** max(power, 0), 10 ** max(-power, 0), token.column)

    @abstractmethod
    def named(self, token: Token) -> Node:
        """Read what a name begins."""

    @abstractmethod
    def group(self, opening: Token) -> Node:
        """Read a bracket, or the pair in it."""

    def deeper(self, token: Token) -> None:
        """Count one level of nesting more."""
        self.depth += 1
        if self.depth > MAX_NESTING:
            raise self.fault(f"nested more than {MAX_NESTING} deep", token=token)
