"""Common subexpressions: nodes as SymPy expressions, a symbol for what is used twice, as in :func:`sympy.cse`."""

from __future__ import annotations

from collections import Counter
from itertools import count
from typing import TYPE_CHECKING

from sympy import Add, Mul, Symbol

from canon.expression.graph.sympy_conversion import to_sympy

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr

    from canon.expression.graph.graph import Graph

__all__ = ["shared_to_sympy"]


def shared_to_sympy(
    graph: Graph, nodes: Sequence[int], prefix: str = "x"
) -> tuple[list[tuple[Symbol, Expr]], list[Expr]]:
    """Return replacements and the nodes in terms of them.

    Parameters
    ----------
    graph
        The graph.
    nodes
        What to write as SymPy expressions.
    prefix
        The symbols are called ``x0``, ``x1`` …; names that the nodes use are passed over.

    Returns
    -------
    replacements
        Pairs (symbol, expression), each in symbols that came before.
    expressions
        One a node.

    Examples
    --------
    >>> from sympy import sin, symbols
    >>> from canon.expression.graph.graph import Graph
    >>> a, b = symbols("a b")
    >>> graph = Graph()
    >>> shared_to_sympy(graph, [graph.from_sympy(f) for f in (sin(a*b), sin(a*b)**2 + b)])
    ([(x0, sin(a*b))], [x0, b + x0**2])
    """
    reachable = graph.reachable(nodes)
    uses = Counter(operand for each in reachable for operand in graph.nodes[each].operands)
    uses.update(nodes)
    taken = {s.name for node in nodes for s in graph.symbols(node)}
    written: dict[int, Expr] = {}
    replacements: list[tuple[Symbol, Expr]] = []
    free = (f"{prefix}{number}" for number in count() if f"{prefix}{number}" not in taken)
    for each in reachable:
        kind, operands, _ = graph.nodes[each]
        if not operands:
            (written[each],) = to_sympy(graph, [each])
            continue
        x = [written[o] for o in operands]
        found = Add(*x) if kind == "add" else Mul(*x) if kind == "mul" else _other(graph, each, x)
        if uses[each] > 1 and not _is_short(graph, each):
            symbol = Symbol(next(free), real=True)
            replacements.append((symbol, found))
            found = symbol
        written[each] = found
    return replacements, [written[node] for node in nodes]


def _other(graph: Graph, node: int, x: Sequence[Expr]) -> Expr:
    """Write a power or a function of operands that are written already."""
    small = type(graph)()
    stand_ins = [Symbol(f"o{k}") for k in range(len(x))]
    kind, operands, _ = graph.nodes[node]
    if kind == "pow":
        return x[0] ** x[1]
    (plain,) = to_sympy(small, [small.function(kind, *(small.symbol(s) for s in stand_ins[: len(operands)]))])
    return plain.func(*x)


def _is_short(graph: Graph, node: int) -> bool:
    """Whether a node is only the negative of another, which needs no name."""
    kind, operands, _ = graph.nodes[node]
    return kind == "mul" and len(operands) == 2 and graph.nodes[operands[0]] == graph.nodes[graph.number(-1)]
