"""Values of graph nodes at points, in any arithmetic."""

from __future__ import annotations

import functools
import operator
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from canon.expression.graph.number_systems import FLOAT64, LONGDOUBLE
from canon.expression.graph.written_steps import squared, value_of, written_steps

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from sympy import Symbol

    from canon.expression.graph.arena import Arena
    from canon.expression.graph.number_systems import Arithmetic
    from canon.expression.graph.written_steps import Step

__all__ = ["evaluate"]

_KEPT, _LARGE = 256, 5_000
"""Of so many evaluations it is kept how they go, and of none of so many operations: what is small is asked again."""

_PATIENCE = 10
"""So many evaluations walk over the steps; to write them as a function costs as much as about twenty."""


def evaluate(
    graph: Arena, nodes: Sequence[int], values: Mapping[Symbol, Any], arithmetic: Arithmetic
) -> list[Any]:
    """Return the values of nodes; see :meth:`canon.expression.graph.graph.Graph.evaluate`."""
    wanted = tuple(nodes)
    with arithmetic.quiet():
        if arithmetic is FLOAT64 or arithmetic is LONGDOUBLE:
            kept = _kept_steps(graph, wanted, wide=arithmetic is LONGDOUBLE)
            if kept is not None:
                return kept.values(values)
        return _walked(*_steps(graph, wanted, arithmetic), values)


def _walked(steps: Sequence[Step], places: Sequence[int], values: Mapping[Symbol, Any]) -> list[Any]:
    """Return what is found at some of the steps."""
    done = list[Any]()
    for function, operands, value in steps:
        if function is None:
            done.append(value)
        elif function is value_of:
            done.append(value_of(values, value))
        elif len(operands) == 1:
            done.append(function(done[operands[0]]))
        else:
            found = function(done[operands[0]], done[operands[1]])
            for more in operands[2:]:
                found = function(found, done[more])
            done.append(found)
    return [done[place] for place in places]


class _KeptSteps:
    """Steps that are walked over at first, and written as a function where they are asked for again and again."""

    def __init__(self, steps: Sequence[Step], places: Sequence[int]) -> None:
        self._steps, self._places, self._calls_left = steps, places, _PATIENCE
        self.values = self._first_values

    def _first_values(self, values: Mapping[Symbol, Any]) -> list[Any]:
        self._calls_left -= 1
        if not self._calls_left:
            self.values = written_steps(self._steps, self._places)
        return _walked(self._steps, self._places, values)


@functools.lru_cache(maxsize=_KEPT)
def _kept_steps(graph: Arena, nodes: tuple[int, ...], *, wide: bool) -> _KeptSteps | None:
    """Return the steps of small evaluations, kept for the next one; None where there are many."""
    if len(graph.reachable(nodes)) > _LARGE:
        return None
    return _KeptSteps(*_steps(graph, nodes, LONGDOUBLE if wide else FLOAT64))


def _steps(graph: Arena, nodes: tuple[int, ...], arithmetic: Arithmetic) -> tuple[list[Step], list[int]]:
    """Return what to do in order, on what was done before, and where the nodes' values are then.

    A step without a function is a constant; sums and products go from the left.
    """
    reached = graph.reachable(nodes)
    place = {node: k for k, node in enumerate(reached)}
    steps = [_step(graph, node, place, arithmetic) for node in reached]
    return steps, [place[node] for node in nodes]


def _step(graph: Arena, node: int, place: Mapping[int, int], arithmetic: Arithmetic) -> Step:
    kind, operands, value = graph.nodes[node]
    own = tuple(place[o] for o in operands)
    if kind == "symbol":
        return value_of, (), value
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
        if exponent.value == 2 and (arithmetic is FLOAT64 or arithmetic is LONGDOUBLE):
            return squared, own[:1], None  # of arrays a power is that too
        return arithmetic.raising_to(exponent.value), own[:1], None
    return arithmetic.power, own, None


_FOLDED: dict[str, Callable[..., Any]] = {"add": operator.add, "mul": operator.mul}
