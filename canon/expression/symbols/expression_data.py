"""Expressions as plain data, for files: symbols, and SymPy trees of the operations that mechanics is written in.

What is read is made of the operations listed here, as it stands, by their constructors: no text is evaluated.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.expression.symbols.symbol import Coordinate, Momentum, Rate

if TYPE_CHECKING:
    from collections.abc import Callable

    from sympy import Expr, Symbol

__all__ = ["expression_data", "expression_from", "symbol_data", "symbol_from"]

_SYMBOLS: dict[str, Any] = {
    "symbol": sp.Symbol, "dummy": sp.Dummy, "coordinate": Coordinate, "rate": Rate, "momentum": Momentum,
}  # fmt: skip

_OPERATIONS: dict[str, Any] = {
    name: getattr(sp, name)
    for name in (
        "Add", "Mul", "Pow", "sin", "cos", "tan", "cot", "sec", "csc", "exp", "log", "asin", "acos", "atan", "acot",
        "atan2", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "Abs", "sign", "erf", "erfc",
    )
}  # fmt: skip

_CONSTANTS: dict[str, Any] = {"pi": sp.pi, "E": sp.E}


def symbol_data(symbol: Symbol) -> list[Any]:
    """Return a symbol's kind, name and assumptions.

    Raises
    ------
    ValueError
        It is of a class of its own.

    Examples
    --------
    >>> symbol_data(Coordinate("x", real=True)), symbol_from(["coordinate", "x", {"real": True}]).dot
    (['coordinate', 'x', {'real': True}], x_dot)
    """
    kind = next((name for name, each in _SYMBOLS.items() if type(symbol) is each), None)
    if kind is None:
        raise ValueError(f"{symbol} is a {type(symbol).__name__}, a class of symbols that files do not know")
    given: Any = symbol
    _, assumed = given.__getnewargs_ex__()
    return [kind, symbol.name, dict(assumed)]


def symbol_from(data: list[Any]) -> Symbol:
    """Return the symbol that :func:`symbol_data` wrote; a dummy is a new one."""
    kind, name, assumed = data
    return _SYMBOLS[kind](name, **assumed)


def expression_data(expression: Expr, symbol: Callable[[Symbol], int]) -> list[list[Any]]:
    """Return an expression's operations, operands before what is made of them, the whole last.

    Parameters
    ----------
    expression
        The expression.
    symbol
        Gives a symbol its number.

    Raises
    ------
    ValueError
        It holds an operation that files do not know, or one that would not be read back as it is.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> data = expression_data(x**2 / 2, lambda _: 0)
    >>> expression_from(data, [x])
    x**2/2
    """
    done: dict[int, int] = {}
    nodes, waiting, met = list[list[Any]](), list[Any]([expression]), dict[int, sp.Symbol]()

    def numbered(each: Symbol) -> int:
        met[number := symbol(each)] = each
        return number

    while waiting:
        current = waiting[-1]
        missing = [each for each in current.args if id(each) not in done]
        if missing:
            waiting.extend(missing)
            continue
        waiting.pop()
        if id(current) not in done:
            done[id(current)] = len(nodes)
            nodes.append(_node_data(current, [done[id(each)] for each in current.args], numbered))
    if _made(nodes, met) != expression:
        raise ValueError(f"{expression} would not be read from a file as it is")
    return nodes


def _node_data(f: Any, operands: list[int], symbol: Callable[[Symbol], int]) -> list[Any]:
    if f.is_Symbol:
        return ["symbol", symbol(f)]
    if f.is_Rational:
        return ["rational", int(f.p), int(f.q)]
    if f.is_Float and f.is_finite:
        sign, mantissa, exponent, bits = f._mpf_
        return ["float", int(sign), int(mantissa), int(exponent), int(bits), int(f._prec)]  # noqa: SLF001
    name = next((name for name, each in _CONSTANTS.items() if f is each), None)
    if name is not None:
        return ["constant", name]
    name = type(f).__name__
    if _OPERATIONS.get(name) is not type(f):
        raise ValueError(f"{name} in {f} is an operation that files do not know")
    return [name, *operands]


def expression_from(data: list[list[Any]], symbols: list[Symbol]) -> Expr:
    """Return the expression that :func:`expression_data` wrote, its symbols by their numbers."""
    return _made(data, dict(enumerate(symbols)))


def _made(data: list[list[Any]], symbols: dict[int, Symbol]) -> Expr:
    made: list[Any] = []
    for kind, *rest in data:
        if kind == "symbol":
            made.append(symbols[rest[0]])
        elif kind == "rational":
            made.append(sp.Rational(*rest))
        elif kind == "float":
            *number, precision = rest
            made.append(sp.Float(tuple(number), precision=precision))
        elif kind == "constant":
            made.append(_CONSTANTS[rest[0]])
        else:
            made.append(_OPERATIONS[kind](*(made[k] for k in rest), evaluate=False))
    return made[-1]
