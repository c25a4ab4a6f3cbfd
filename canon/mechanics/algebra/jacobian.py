"""Partial derivatives of several functions; large ones on the expression graph.

SymPy looks through the whole tree below a part before it differentiates it. The tree of a map composed many times is
exponentially larger than its distinct parts, so such maps are differentiated part by part instead.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.expression.graph.graph import Graph
from canon.expression.graph.sympy_conversion import NotModelledError
from canon.proof.trees.anatomy import anatomy

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr, Symbol

__all__ = ["is_large", "jacobian"]

LARGE = 5_000
"""Size of the functions' trees from which they are differentiated on the graph."""


def jacobian(functions: Sequence[Expr], variables: Sequence[Symbol]) -> list[list[Expr]]:
    """Return ∂f/∂z, a row a function.

    Parameters
    ----------
    functions, variables
        What is differentiated, and by what.

    Examples
    --------
    >>> from sympy import sin, symbols
    >>> q, p = symbols("q p", real=True)
    >>> jacobian([q + p, p - sin(q)], [q, p])
    [[1, 1], [-cos(q), 1]]
    """
    if is_large(functions):
        graph = Graph()
        try:
            nodes = [graph.from_sympy(f) for f in functions]
        except NotModelledError:  # derivatives of arbitrary functions and the like
            return _by_sympy(functions, variables)
        return [[graph.to_sympy(graph.derivative(node, z)) for z in variables] for node in nodes]
    return _by_sympy(functions, variables)


def is_large(functions: Sequence[Expr]) -> bool:
    """Whether SymPy would walk long through these functions, which it does as trees.

    Examples
    --------
    >>> from sympy import Symbol
    >>> f = Symbol("x")
    >>> for _ in range(13): f = f**2 + f
    >>> is_large([f])
    True
    """
    return anatomy(functions).tree >= LARGE


def _by_sympy(functions: Sequence[Expr], variables: Sequence[Symbol]) -> list[list[Expr]]:
    return [[f.diff(z) for z in variables] for f in functions]
