"""Constructors: what SymPy and Mathematica print instead of a formula, ``Mul(Integer(2), Symbol('x'))``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.expression.text.applied_functions import with_brackets
from canon.expression.text.differentials import PARTIAL, PRIMED
from canon.expression.text.syntax import (
    Call,
    Comparison,
    Name,
    Node,
    Number,
    Power,
    Product,
    Sum,
    Tuple,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from canon.expression.text.factor_parser import FactorParser
    from canon.expression.text.tokens import Token

__all__ = ["constructed"]


def constructed(reader: FactorParser, token: Token) -> Node | None:
    """Return what a constructor of SymPy or Mathematica makes, as ``Mul(Integer(2), Symbol('x'))``; else None."""
    opening = reader.token
    if opening.text not in ("(", "[") or reader.scope.declares(token.text) or token.primes:
        return None
    if token.text in ("Symbol", "Function") and opening.text == "(":
        return _quoted(reader, token)
    make = _CONSTRUCTORS.get(token.text)
    if make is None:
        return None
    arguments = [node for node in with_brackets(reader) if not _is_assumption(node)]
    node = make(token.column, arguments)
    if isinstance(node, Name) and token.text == "Subscript":
        return _with_subscript(reader, node)
    if node is None:
        raise reader.fault(
            f"{token.text} with {len(arguments)} argument(s)", "write the formula itself", token
        )
    return node


def _with_subscript(reader: FactorParser, name: Name) -> Name:
    """Return the declared name that ``Subscript[m, 1]`` is, m_1 or m1, and pass over ``[t]`` behind one that moves."""
    plain = name.text.replace("_", "")
    if not reader.scope.declares(name.text) and reader.scope.declares(plain):
        name = Name(plain, 0, name.column)
    if [t.text for t in reader.tokens[reader.at : reader.at + 3]] == ["[", reader.scope.time.name, "]"]:
        reader.at += 3
    return name


def _is_assumption(node: Node) -> bool:
    """Tell whether this is ``real=True`` or ``evaluate=False``, which changes no formula here."""
    match node:
        case Comparison((Name(), Name(text="True" | "False" | "true" | "false")), ("=",)):
            return True
        case _:
            return False


def _quoted(reader: FactorParser, token: Token) -> Node | None:
    """Return the name in ``Symbol('x')``, or of ``Function('theta')(Symbol('t'))``."""
    string = reader.tokens[reader.at + 1]
    if string.kind != "string":
        return None
    name = string.text[1:-1]
    found = reader.words.declared(name)
    name = found[0] if len(found) == 1 else name
    while reader.token.text != ")":
        if reader.token.kind == "end":
            raise reader.fault("'(' is never closed", token=token)
        reader.at += 1
    reader.at += 1
    if token.text == "Symbol" or reader.tokens[reader.at].text != "(":
        return Name(name, 0, string.column)
    return Call(name, with_brackets(reader), string.column)


def _product(column: int, arguments: list[Node]) -> Node:
    return Product(tuple((False, node) for node in arguments), column)


def _quotient(column: int, arguments: list[Node]) -> Node | None:
    if len(arguments) != 2:
        return None
    return Product(((False, arguments[0]), (True, arguments[1])), column)


def _sum(column: int, arguments: list[Node]) -> Node:
    return Sum(tuple((False, node) for node in arguments), column)


def _power(column: int, arguments: list[Node]) -> Node | None:
    return Power(arguments[0], arguments[1], column) if len(arguments) == 2 else None


def _squared(column: int, arguments: list[Node]) -> Node | None:
    return Power(arguments[0], Number(2, 1, column), column) if len(arguments) == 1 else None


def _itself(column: int, arguments: list[Node]) -> Node | None:  # noqa: ARG001
    return arguments[0] if len(arguments) == 1 else None


def _equation(column: int, arguments: list[Node]) -> Node | None:
    return Comparison((arguments[0], arguments[1]), ("=",), column) if len(arguments) == 2 else None


def _tuple(column: int, arguments: list[Node]) -> Node:
    return Tuple(tuple(arguments), column)


def _derivative(column: int, arguments: list[Node]) -> Node | None:
    return Call("Derivative", tuple(arguments), column) if len(arguments) > 1 else None


def _over(kind: str) -> Callable[[int, list[Node]], Node | None]:
    """Return the constructor of an integral or sum; without a range it has no value."""
    return lambda column, arguments: Call(kind, tuple(arguments), column) if len(arguments) > 1 else None


def _outermost_first(column: int, arguments: list[Node]) -> Node | None:
    """Return Mathematica's integral, whose first range is the outermost; that of Integral is the innermost."""
    if len(arguments) < 2:
        return None
    operand, *over = arguments
    return Call("Integral", (operand, *reversed(over)), column)


def _slope_at(column: int, arguments: list[Node]) -> Node | None:
    """Return the derivative at a place that SymPy prints as ``Subs(Derivative(V(_xi_1), _xi_1), _xi_1, x)``."""
    match arguments:
        case [Call("Derivative", (Call(f, (Name(v),)), Name(w))), Name(u), place] if v == w == u:
            order = 1
        case [
            Call("Derivative", (Call(f, (Name(v),)), Tuple((Name(w), Number(order, 1))))),
            Name(u),
            place,
        ] if v == w == u:
            pass
        case _:
            return None
    value, times = Call(f, (place,), column), Number(order, 1, column)
    return (
        Call(PARTIAL, (value, place, times), column)
        if isinstance(place, Name)
        else Call(PRIMED, (value, times), column)
    )


def _subscripted(column: int, arguments: list[Node]) -> Node | None:
    """Return the name that Mathematica's ``Subscript[m, 1]`` is."""
    match arguments:
        case [Name(text, 0), Number(number, 1)]:
            return Name(f"{text}_{number}", 0, column)
        case [Name(text, 0), Name(index, 0)]:
            return Name(f"{text}_{index}", 0, column)
        case _:
            return None


_CONSTRUCTORS: Mapping[str, Callable[[int, list[Node]], Node | None]] = {
    "Mul": _product, "Times": _product, "Add": _sum, "Plus": _sum, "Pow": _power, "Power": _power, "pow": _power,
    "Rational": _quotient, "Fraction": _quotient, "Integer": _itself, "Float": _itself, "S": _itself,
    "sympify": _itself, "Hold": _itself, "HoldForm": _itself, "Tuple": _tuple, "D": _derivative,
    "Equal": _equation, "Equality": _equation, "power": _power, "square": _squared, "rational": _quotient,
    **dict.fromkeys(("Integral", "integrate"), _over("Integral")),
    "Integrate": _outermost_first,
    **dict.fromkeys(("Sum", "sum", "summation"), _over("Sum")),
    **dict.fromkeys(("Product", "product"), _over("Product")),
    "Subscript": _subscripted, "Subs": _slope_at,
}  # fmt: skip
