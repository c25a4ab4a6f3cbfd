"""Derivatives as people type them: ``dθ/dt``, ``d²θ/dt²``, ``d/dt(m l² θ̇)``, ``∂V/∂x``.

d/dt is the derivative along the motion, ∂ the partial one. Where ``d`` is declared, it is a factor as any other name.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from canon.expression.symbols.symbol import Coordinate
from canon.expression.text.syntax import Call, Name, Node, Number, children, parts

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.expression.text.factor_parser import FactorParser
    from canon.expression.text.scope import Scope
    from canon.expression.text.tokens import Token

__all__ = ["PARTIAL", "PRIMED", "TOTAL", "derivative", "names_outside_functions", "of_operator"]

TOTAL, PARTIAL, PRIMED = "d/dt", "∂", "f'"
"""Functions of the syntax tree that no name can spell."""


def derivative(reader: FactorParser, token: Token | None = None) -> Node | None:
    """Return a quotient of differentials, its first sign being next or, for ``d``, just read; None where it is none."""
    start, sign = reader.at, "d"
    if token is None:
        token, sign = reader.token, "∂"
        reader.at += 1
    reader.deeper(token)
    order = _order(reader)
    operand = None if reader.token.text == "/" else _above(reader)
    reader.depth -= 1
    bracket = reader.tokens[min(reader.at + 1, len(reader.tokens) - 1)].text == "("
    if reader.token.text != "/" or not _is_sign(reader, reader.at + 1 + bracket, sign):
        if sign == "∂":
            raise reader.fault("a derivative is written ∂f/∂x", token=token)
        reader.at = start
        return None
    reader.at += 1
    variables = _below(reader, sign)
    if sum(n for _, n in variables) != order:
        raise reader.fault("the orders above and below differ", "write d²x/dt²", token)
    if operand is None:
        operand = _after(reader, token, sign)
    return _made(reader, sign, operand, variables, token)


def _is_sign(reader: FactorParser, at: int, sign: str) -> bool:
    return at < len(reader.tokens) and reader.tokens[at].text == sign and not reader.tokens[at].primes


def _order(reader: FactorParser) -> int:
    """Return the order written after a sign or a variable, 1 where none is."""
    token = reader.token
    if token.kind == "super" and token.text.isdigit():
        reader.at += 1
        return int(token.text[:3])
    if token.text in ("^", "**") and reader.tokens[reader.at + 1].text.isdigit():
        reader.at += 2
        return int(reader.tokens[reader.at - 1].text[:3])
    if token.text in ("^", "**") and reader.tokens[reader.at + 1].text in ("{", "("):
        digit, closing = reader.tokens[reader.at + 2 : reader.at + 4]
        if digit.text.isdigit() and closing.text in ("}", ")"):
            reader.at += 4
            return int(digit.text[:3])
    return 1


def _above(reader: FactorParser) -> Node | None:
    """Return what is differentiated, written after the sign: a name, a value of a function, a bracket."""
    token = reader.token
    if token.kind == "name" or token.text in ("(", "[", "{"):
        return reader.atom()
    return None


def _below(reader: FactorParser, sign: str) -> list[tuple[Node, int]]:
    """Return the variables below, each with its order."""
    variables: list[tuple[Node, int]] = []
    bracket = reader.take("(")
    while _is_sign(reader, reader.at, sign) and (not variables or sign == "∂"):
        reader.at += 1
        name = reader.token
        if name.kind != "name":
            raise reader.fault("a variable is missing", "write d/dt or ∂/∂x")
        reader.at += 1
        variables.append((Name(name.text, name.primes, name.column), _order(reader)))
    if bracket and not reader.take(")"):
        if reader.token.kind == "end":
            raise reader.unclosed(bracket)
        raise reader.fault("below a derivative stand its variables alone", "write d/dt or ∂²f/(∂x∂y)")
    return variables


def _after(reader: FactorParser, token: Token, sign: str) -> Node:
    """Return what stands after ``d/dt``: a bracket, or one name alone."""
    what = "d/dt" if sign == "d" else "∂/∂x"
    opening = reader.token
    if opening.text in ("(", "[", "{"):
        reader.at += 1
        inside = reader.group(opening)
        if reader.token.text in ("^", "**") or reader.token.kind == "super":
            raise reader.fault(
                f"does this raise the derivative, or what {what} acts on?",
                f"write ({what}( ))^2 or {what}(( )^2)",
            )
        return inside
    if opening.text == "∂" or (opening.kind == "name" and opening.text != "d"):
        node = reader.atom()
        if (
            not reader.starts(reader.token)
            and reader.token.text not in ("^", "**", "*", "/")
            and reader.token.kind != "super"
        ):
            return node
    raise reader.fault(f"what does {what} reach?", f"write {what}( ) around it", token)


def _made(
    reader: FactorParser, sign: str, operand: Node, variables: list[tuple[Node, int]], token: Token
) -> Node:
    time = reader.scope.time.name
    variable, order = variables[0]
    if order > 8:
        raise reader.fault("a derivative of more than the 8th order", token=token)
    if sign == "d" and isinstance(variable, Name) and variable.text == time and not variable.primes:
        if isinstance(operand, Name) and reader.scope.declares(operand.text) and operand.primes + order <= 2:
            return Name(operand.text, operand.primes + order, operand.column)
        node = operand
        for _ in range(order):
            node = Call(TOTAL, (node,), token.column)
        return node
    if sign == "∂" and _is_rate(reader, operand, variables) and isinstance(operand, Name):
        return Name(operand.text, operand.primes + order, operand.column)
    orders = [Number(n, 1, token.column) for _, n in variables]
    name = PARTIAL if sign == "∂" else "d/dx"
    return Call(name, (operand, *(v for v, _ in variables), *orders), token.column)


def _is_rate(reader: FactorParser, operand: Node, variables: list[tuple[Node, int]]) -> bool:
    """Tell whether ``∂²θ/∂t²`` is meant for the acceleration: what moves depends on the time alone."""
    ((variable, order), *others) = variables
    clock = isinstance(variable, Name) and variable.text == reader.scope.time.name and not variable.primes
    if others or not clock or not isinstance(operand, Name) or operand.primes + order > 2:
        return False
    return isinstance(reader.scope.symbol(operand.text), Coordinate)


def of_operator(reader: FactorParser) -> Token | None:
    """Return the name in Maple's ``D(D(x))(t)`` with as many primes, None where there is none; ``D`` has been read.

    Behind a coordinate ``(t)`` is read as well, behind a function its argument comes next.
    """
    texts = [token.text for token in reader.tokens[reader.at : reader.at + 10]]
    order = 1
    while texts[2 * order - 1 : 2 * order + 1] == ["D", "("]:
        order += 1
    end = reader.at + 2 * order
    name = reader.tokens[min(end - 1, len(reader.tokens) - 1)]
    if name.kind != "name" or texts[0] != "(" or texts[2 * order : 3 * order + 1] != [")"] * order + ["("]:
        return None
    rate = replace(name, primes=name.primes + order)
    if name.text in reader.scope.functions and not name.primes:
        reader.at = end + order
        return rate
    clock = [token.text for token in reader.tokens[end + order + 1 : end + order + 3]]
    if rate.primes > 2 or not reader.scope.moves(name.text) or clock != [reader.scope.time.name, ")"]:
        return None
    reader.at = end + order + 3
    return rate


def names_outside_functions(node: Node, scope: Scope) -> Iterator[Name]:
    """Yield the names of a tree that do not stand in the argument of a declared function of the time."""
    stack = [node]
    while stack:
        part = stack.pop()
        if isinstance(part, Name):
            yield part
        elif isinstance(part, Call) and part.function in ("Derivative", "diff", "D", PARTIAL):
            stack.append(part.arguments[0])
        elif not (isinstance(part, Call) and part.function in scope.functions and _has_time(part, scope)):
            stack += children(part)


def _has_time(call: Call, scope: Scope) -> bool:
    return any(isinstance(part, Name) and part.text == scope.time.name for part in parts(call))
