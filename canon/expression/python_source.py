"""Graph nodes as a Python function: callable a few milliseconds after the derivation, compiled by nobody.

The text holds nothing but numbered names, numbers and functions of :mod:`math`, so nothing a user wrote reaches
Python's compiler.
"""

from __future__ import annotations

import math
from collections import Counter
from fractions import Fraction
from types import CodeType, FunctionType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sympy import Symbol

    from canon.expression.graph import Graph

__all__ = ["python_function"]

_DEEPEST = 12
"""Subexpressions used once are written where they are used, up to this nesting."""

_FUNCTIONS: dict[str, Any] = {
    name: getattr(math, name)
    for name in (
        "sin", "cos", "tan", "exp", "log", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh",
        "atan2", "sqrt", "pi",
    )
} | {"E": math.e, "Abs": abs, "sign": lambda x: float((x > 0) - (x < 0))}  # fmt: skip


def python_function(
    graph: Graph, outputs: Sequence[int], inputs: Sequence[Symbol]
) -> Callable[[Sequence[float]], tuple[float, ...]]:
    """Return a function of one sequence of numbers, the inputs, that returns a tuple of numbers, the outputs.

    Parameters
    ----------
    graph
        The graph.
    outputs
        The nodes to compute; what they share is computed once.
    inputs
        The symbols, in the order of the argument.

    Raises
    ------
    KeyError
        The outputs depend on a symbol that is not an input; the message names all such symbols.

    Examples
    --------
    >>> from sympy import sin, symbols
    >>> from canon.expression.graph import Graph
    >>> x, y = symbols("x y")
    >>> graph = Graph()
    >>> f = python_function(graph, [graph.from_sympy(x**2 * y), graph.from_sympy(sin(x) / y)], [x, y])
    >>> f((1.0, 2.0))
    (2.0, 0.420735...)
    """
    unknown = frozenset[Any]().union(*(graph.symbols(node) for node in outputs)) - set(inputs)
    if unknown:
        raise KeyError(f"no value for {', '.join(sorted(map(str, unknown)))}: give each as an input")
    module = compile(_text(graph, outputs, inputs), "<expression graph>", "exec")
    code = next(constant for constant in module.co_consts if isinstance(constant, CodeType))
    return FunctionType(code, _FUNCTIONS)


def _text(graph: Graph, outputs: Sequence[int], inputs: Sequence[Symbol]) -> str:
    written: dict[int, tuple[str, int]] = {}
    reachable = graph.reachable(outputs)
    uses = Counter(outputs)
    for each in reachable:
        uses.update(graph.nodes[each].operands)
    place = {symbol: f"x{k}" for k, symbol in enumerate(inputs)}
    lines = ["def f(x):"]
    if inputs:
        lines.append(f" {','.join(place.values())}, = x")
    for each in reachable:
        kind, operands, value = graph.nodes[each]
        if kind == "symbol":
            written[each] = (place[value], 0)
            continue
        if kind == "number":
            written[each] = (_number(value), 0)
            continue
        text = _operation(graph, kind, [written[o][0] for o in operands], operands) if operands else value
        depth = 1 + max((written[o][1] for o in operands), default=0)
        if uses[each] > 1 or depth > _DEEPEST:
            lines.append(f" n{each} = {text}")
            text, depth = f"n{each}", 0
        written[each] = (text, depth)
    lines.append(f" return ({''.join(written[node][0] + ',' for node in outputs)})")
    return "\n".join(lines)


def _number(value: Fraction) -> str:
    text = repr(float(value))
    return f"({text})" if value < 0 else text


def _operation(graph: Graph, kind: str, texts: list[str], operands: tuple[int, ...]) -> str:
    if kind == "add":
        return f"({'+'.join(texts)})"
    if kind == "mul":
        return f"({'*'.join(texts)})"
    if kind != "pow":
        return f"{kind}({','.join(texts)})"
    exponent = graph.nodes[operands[1]]
    return _power(texts[0], exponent.value if exponent.kind == "number" else texts[1])


def _power(base: str, exponent: Fraction | str) -> str:
    if isinstance(exponent, str):
        return f"({base}**{exponent})"
    if exponent < 0:
        return f"(1.0/{_power(base, -exponent)})" if exponent != -1 else f"(1.0/{base})"
    if exponent == Fraction(1, 2):
        return f"sqrt({base})"
    if exponent == 2 and base.isidentifier():
        return f"({base}*{base})"
    if exponent.denominator == 2:
        return f"sqrt({base})**{exponent.numerator}"
    return f"({base}**{_number(exponent) if exponent.denominator != 1 else exponent.numerator})"
