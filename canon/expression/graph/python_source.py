"""Python source of graph nodes: a function, callable a few milliseconds after the derivation without compiling.

Where there are many nodes, the first calls walk over them, and Python's compiler is asked only when more calls show
that it pays; both do the same operations in the same order, so the numbers are the same to the last bit. The text
holds nothing but numbered names, numbers and functions of :mod:`math`: nothing a user wrote reaches the compiler.
"""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import chain
from typing import TYPE_CHECKING, Any

from canon.expression.graph.written_steps import function_of_text

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sympy import Symbol

    from canon.expression.graph.graph import Graph

__all__ = ["python_function"]

_DEEPEST = 12
"""Subexpressions used once are written where they are used, up to this nesting."""

_MANY = 300
"""Up to so many nodes Python's compiler is quicker than a thought about it."""

_PATIENCE = 6
"""So many calls walk over the nodes; compiling costs as much as about ten."""

_FUNCTIONS: dict[str, Any] = {
    name: getattr(math, name)
    for name in (
        "sin", "cos", "tan", "exp", "log", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh",
        "atan2", "erf", "erfc", "sqrt", "pi",
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
    >>> from canon.expression.graph.graph import Graph
    >>> x, y = symbols("x y")
    >>> graph = Graph()
    >>> f = python_function(graph, [graph.from_sympy(x**2 * y), graph.from_sympy(sin(x) / y)], [x, y])
    >>> f((1.0, 2.0))
    (2.0, 0.420735...)
    """
    unknown = graph.all_symbols(outputs) - set(inputs)
    if unknown:
        raise KeyError(f"no value for {', '.join(sorted(map(str, unknown)))}: give each as an input")
    reachable = graph.reachable(outputs)
    if len(reachable) > _MANY:
        return _Patient(graph, tuple(outputs), tuple(inputs), reachable)
    return _compiled(graph, outputs, inputs)


class _Patient:
    """A function that walks over the nodes at first, and is compiled when it is called again and again."""

    def __init__(
        self, graph: Graph, outputs: tuple[int, ...], inputs: tuple[Symbol, ...], reachable: Sequence[int]
    ) -> None:
        self._graph, self._outputs, self._inputs, self._reachable = graph, outputs, inputs, reachable
        self._calls_left = _PATIENCE
        self._run = self._walk

    def __call__(self, x: Sequence[float]) -> tuple[float, ...]:
        if self._calls_left:
            self._calls_left -= 1
            if not self._calls_left:
                self._run = _compiled(self._graph, self._outputs, self._inputs)
        return self._run(x)

    def _walk(self, x: Sequence[float]) -> tuple[float, ...]:
        given = dict(zip(self._inputs, x, strict=True))
        done: dict[int, float] = {}
        nodes = self._graph.nodes
        for each in self._reachable:
            kind, operands, value = nodes[each]
            if kind == "mul":
                total = done[operands[0]]
                for o in operands[1:]:
                    total *= done[o]
                done[each] = total
            elif kind == "add":
                total = done[operands[0]]
                for o in operands[1:]:
                    total += done[o]
                done[each] = total
            elif kind == "symbol":
                done[each] = given[value]
            elif kind == "number":
                done[each] = float(value)
            elif kind == "named":
                done[each] = _FUNCTIONS[value]
            elif kind == "pow":
                exponent = nodes[operands[1]]
                done[each] = _raised(
                    done[operands[0]], exponent.value if exponent.kind == "number" else done[operands[1]]
                )
            else:
                done[each] = _FUNCTIONS[kind](*(done[o] for o in operands))
        return tuple([done[node] for node in self._outputs])


def _raised(base: float, exponent: Fraction | float) -> float:
    """Return what the text of :func:`_power` computes."""
    if not isinstance(exponent, Fraction):
        return base**exponent
    if exponent < 0:
        return 1.0 / (_raised(base, -exponent) if exponent != -1 else base)
    if exponent.denominator == 2:
        root = math.sqrt(base)
        return root**exponent.numerator if exponent.numerator != 1 else root
    if exponent == 2:
        return base * base
    return base ** (float(exponent) if exponent.denominator != 1 else exponent.numerator)


def _compiled(
    graph: Graph, outputs: Sequence[int], inputs: Sequence[Symbol]
) -> Callable[[Sequence[float]], tuple[float, ...]]:
    return function_of_text(_text(graph, outputs, inputs), _FUNCTIONS)


def _text(graph: Graph, outputs: Sequence[int], inputs: Sequence[Symbol]) -> str:
    nodes, reachable = graph.nodes, graph.reachable(outputs)
    uses = dict.fromkeys(reachable, 0)
    for operand in chain(outputs, *(nodes[each].operands for each in reachable)):
        uses[operand] += 1
    squared = _bases_of_squares(graph, reachable)
    place = {symbol: f"x{k}" for k, symbol in enumerate(inputs)}
    lines = ["def f(x):"]
    if inputs:
        lines.append(f" {','.join(place.values())}, = x")
    written: dict[int, str] = {}
    depths: dict[int, int] = {}
    for each in reachable:
        kind, operands, value = nodes[each]
        depths[each] = 0
        if not operands:
            written[each] = (
                place[value] if kind == "symbol" else _number(value) if kind == "number" else value
            )
            continue
        text = _operation(graph, kind, [written[o] for o in operands], operands)
        depth = 1 + max([depths[o] for o in operands])
        if uses[each] > 1 or depth > _DEEPEST or each in squared:
            lines.append(f" n{each} = {text}")
            written[each] = f"n{each}"
        else:
            written[each], depths[each] = text, depth
    lines.append(f" return ({''.join([written[node] + ',' for node in outputs])})")
    return "\n".join(lines)


def _bases_of_squares(graph: Graph, reachable: Sequence[int]) -> set[int]:
    """Return what is squared and needs a name for that: x·x is rounded once, Python's x**2 need not be."""
    powers = (graph.nodes[each].operands for each in reachable if graph.nodes[each].kind == "pow")
    return {base for base, exponent in powers if graph.nodes[exponent].value in (2, -2)}


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
    if exponent == 2:
        return f"({base}*{base})"
    if exponent.denominator == 2:
        return f"sqrt({base})**{exponent.numerator}"
    return f"({base}**{_number(exponent) if exponent.denominator != 1 else exponent.numerator})"
