"""Values of graph nodes at points, in any arithmetic."""

from __future__ import annotations

import functools
import operator
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from canon.expression.graph.number_systems import FLOAT64, LONGDOUBLE

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from typing import TypeAlias

    from sympy import Symbol

    from canon.expression.graph.arena import Arena
    from canon.expression.graph.number_systems import Arithmetic

    _Step: TypeAlias = tuple[Callable[..., Any] | None, tuple[int, ...], Any]

__all__ = ["evaluate"]

_KEPT, _LARGE = 256, 5_000
"""Of so many evaluations it is kept how they go, and of none of so many operations: what is small is asked again."""


def evaluate(
    graph: Arena, nodes: Sequence[int], values: Mapping[Symbol, Any], arithmetic: Arithmetic
) -> list[Any]:
    """Return the values of nodes; see :meth:`canon.expression.graph.graph.Graph.evaluate`."""
    wanted, done = tuple(nodes), list[Any]()
    kept = None
    with arithmetic.quiet():
        if arithmetic is FLOAT64 or arithmetic is LONGDOUBLE:
            kept = _kept_steps(graph, wanted, wide=arithmetic is LONGDOUBLE)
        steps, places = _steps(graph, wanted, arithmetic) if kept is None else kept
        for function, operands, value in steps:
            if function is None:
                done.append(value)
            elif function is _value_of:
                done.append(_value_of(values, value))
            elif len(operands) == 1:
                done.append(function(done[operands[0]]))
            else:
                found = function(done[operands[0]], done[operands[1]])
                for more in operands[2:]:
                    found = function(found, done[more])
                done.append(found)
    return [done[place] for place in places]


@functools.lru_cache(maxsize=_KEPT)
def _kept_steps(graph: Arena, nodes: tuple[int, ...], *, wide: bool) -> tuple[list[_Step], list[int]] | None:
    """Return the steps of small evaluations, kept for the next one; None where there are many."""
    if len(graph.reachable(nodes)) > _LARGE:
        return None
    return _steps(graph, nodes, LONGDOUBLE if wide else FLOAT64)


def _steps(graph: Arena, nodes: tuple[int, ...], arithmetic: Arithmetic) -> tuple[list[_Step], list[int]]:
    """Return what to do in order, on what was done before, and where the nodes' values are then.

    A step without a function is a constant; sums and products go from the left.
    """
    reached = graph.reachable(nodes)
    place = {node: k for k, node in enumerate(reached)}
    steps = [_step(graph, node, place, arithmetic) for node in reached]
    return steps, [place[node] for node in nodes]


def _step(graph: Arena, node: int, place: Mapping[int, int], arithmetic: Arithmetic) -> _Step:
    kind, operands, value = graph.nodes[node]
    own = tuple(place[o] for o in operands)
    if kind == "symbol":
        return _value_of, (), value
    if kind == "number":
        return None, (), arithmetic.number(value)
    if kind == "named":
        return None, (), arithmetic.named(value)
    if kind in _FOLDED:
        return _FOLDED[kind], own, None
    if kind != "pow":
        return arithmetic.functions[kind], own, None
    exponent = graph.nodes[operands[1]]
    if exponent.kind == "number":
        assert isinstance(exponent.value, Fraction)
        return arithmetic.raising_to(exponent.value), own[:1], None
    return arithmetic.power, own, None


_FOLDED: dict[str, Callable[..., Any]] = {"add": operator.add, "mul": operator.mul}


def _value_of(values: Mapping[Symbol, Any], symbol: Symbol) -> Any:
    if symbol not in values:
        raise KeyError(f"no value given for the symbol {symbol}; give it one")
    return values[symbol]
