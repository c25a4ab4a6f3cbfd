"""Expressions and graphs as plain data: what is written is read back as it was, and nothing else is."""

from __future__ import annotations

import pytest
import sympy as sp

from canon.expression.graph.graph import Graph
from canon.expression.graph.graph_data import graph_data, graph_from
from canon.expression.symbols.expression_data import expression_data, expression_from

u, v = sp.symbols("u v", real=True)


@pytest.mark.parametrize("constant", [sp.pi, sp.E])
def test_constants_are_kept_by_name(constant: sp.Expr) -> None:
    f = constant * u**2 + sp.sin(constant * u)
    data = expression_data(f, lambda _: 0)
    assert ["constant", str(constant)] in data
    assert expression_from(data, [u]) == f
    graph = Graph()
    node = graph.from_sympy(f)
    again = graph_from(graph_data(graph, lambda _: 0), [u])
    assert again.nodes == graph.nodes
    assert again.to_sympy(node) == f


def test_symbols_of_one_number_would_be_one_symbol() -> None:
    with pytest.raises(ValueError, match=r"u \+ v would not be read from a file as it is"):
        expression_data(u + v, lambda _: 0)
    assert expression_from(expression_data(u + v, [u, v].index), [u, v]) == u + v


@pytest.mark.parametrize(("f", "name"), [(sp.gamma(u), "gamma"), (sp.EulerGamma * u, "EulerGamma")])
def test_an_operation_that_files_do_not_know_is_named(f: sp.Expr, name: str) -> None:
    with pytest.raises(ValueError, match=f"{name} in .* is an operation that files do not know"):
        expression_data(f, lambda _: 0)


def test_a_graph_of_another_operation_is_not_written() -> None:
    graph = Graph()
    graph.operation("gamma", (graph.symbol(u),))
    with pytest.raises(ValueError, match=r"gamma\(…\) is an operation that files do not know"):
        graph_data(graph, lambda _: 0)


@pytest.mark.parametrize(
    ("nodes", "told"),
    [
        ([["symbol", 0], ["number", "2"], ["number", "2"]], "node 2 of a graph stands there twice"),
        (
            [["symbol", 0], ["named", "pi"], ["mul", 0, 1], ["mul", 0, 1]],
            "node 3 of a graph stands there twice",
        ),
        ([["named", "tau"]], "no constant is called 'tau'; the graph knows 'pi' and 'E'"),
        ([["symbol", 0], ["sin", 1]], "node 1 of a graph is no operation on nodes before it: sin"),
    ],
)
def test_a_graph_that_none_has_written_is_refused(nodes: list[list[object]], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        graph_from({"nodes": nodes, "negatives": []}, [u])
