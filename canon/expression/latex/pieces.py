"""Pieces of a LaTeX formula: factors before products, function calls and derivatives are told apart."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from canon.expression.latex.names import Applied, Function, Mark
from canon.expression.text.syntax import Call, Name, Negative, Node, Number, Power, Product, parts

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = [
    "FactorRun",
    "Group",
    "Head",
    "LatexFraction",
    "Operator",
    "Piece",
    "Powered",
    "base_and_order",
    "in_degrees",
    "is_function",
    "is_in_degrees",
    "is_minus_one",
    "items_of",
    "mark_of",
    "names_in",
    "raised",
    "unbraced",
    "whole",
]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Group:
    """What stands in brackets, or in braces, which are not seen in print."""

    inner: Piece
    braces: bool
    column: int

    @property
    def printed(self) -> bool:
        """Whether brackets are seen in print."""
        return not self.braces or (isinstance(self.inner, Group) and self.inner.printed)


@dataclass(frozen=True, slots=True)
class Powered:
    """A factor with an exponent."""

    base: Piece
    exponent: Node
    column: int


@dataclass(frozen=True, slots=True)
class Head:
    r"""A function before its argument is known, with the exponent of ``\sin^2`` and the base of ``\log_2``."""

    function: Function | Applied
    base: Node | None
    exponent: Node | None
    column: int


@dataclass(frozen=True, slots=True)
class LatexFraction:
    """A fraction; ``numbers`` says whether it is one of two numbers, ``degrees`` whether it is an angle in degrees."""

    node: Product
    numbers: bool
    column: int
    degrees: bool = False


@dataclass(frozen=True, slots=True)
class Operator:
    r"""A derivative before its operand is known, ``\frac{\partial}{\partial x}``."""

    total: bool
    variables: tuple[tuple[Name, int], ...]
    column: int


@dataclass(frozen=True, slots=True)
class FactorRun:
    """Factors side by side."""

    items: tuple[Piece, ...]
    column: int


Piece: TypeAlias = Node | Group | Powered | Head | LatexFraction | Operator | FactorRun | Mark


def in_degrees(number: Number) -> LatexFraction:
    r"""Return the angle of so many degrees, ``30^\circ``."""
    column = number.column
    factors = ((False, number), (False, Name("pi", 0, column)), (True, Number(180, 1, column)))
    return LatexFraction(Product(factors, column), numbers=True, column=column, degrees=True)


def is_function(piece: Piece) -> bool:
    r"""Whether a piece is a built-in function that waits for its argument."""
    return isinstance(piece, Head) and isinstance(piece.function, Function)


def is_minus_one(exponent: Node | None) -> bool:
    """Whether an exponent is the −1 of an inverse function."""
    return isinstance(exponent, Negative) and whole(exponent.operand) == 1


def whole(node: Node) -> int | None:
    """Return the whole number that a node is, None for any other node."""
    return node.numerator if isinstance(node, Number) and node.denominator == 1 else None


def base_and_order(piece: Piece) -> tuple[Piece, int | None]:
    """Return what a piece raises and the whole number it is raised to, None for any other exponent."""
    return (piece.base, whole(piece.exponent)) if isinstance(piece, Powered) else (piece, 1)


def raised(node: Node, exponent: Node | None) -> Node:
    """Return a node raised to an exponent, if there is one."""
    return node if exponent is None else Power(node, exponent, node.column)


def unbraced(piece: Piece) -> Piece:
    """Return what stands in braces, which are not seen in print."""
    while isinstance(piece, Group) and piece.braces:
        piece = piece.inner
    return piece


def is_in_degrees(piece: Piece) -> bool:
    """Whether a piece is an angle in degrees, with which an argument ends."""
    return isinstance(piece, LatexFraction) and piece.degrees


def items_of(piece: Piece) -> tuple[Piece, ...]:
    """Return what stands side by side in a piece, seen through braces."""
    piece = unbraced(piece)
    return piece.items if isinstance(piece, FactorRun) else (piece,)


def mark_of(piece: Piece) -> str | None:
    """Return ``d`` or ``partial``, and ``declared`` for the d of a declared symbol."""
    if isinstance(piece, Mark) and piece.text in ("d", "partial"):
        return piece.text
    return "declared" if isinstance(piece, Name) and piece.text == "d" else None


def names_in(node: Node) -> Iterator[Name]:
    """Yield the names and the called functions of a tree."""
    for part in parts(node):
        if isinstance(part, Name):
            yield part
        elif isinstance(part, Call):
            yield Name(part.function, 0, part.column)
