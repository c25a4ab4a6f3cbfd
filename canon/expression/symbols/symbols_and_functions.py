"""Symbols and applied functions that stand in an expression, found in one walk that does not recurse."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sympy import Symbol
from sympy.core.function import AppliedUndef

if TYPE_CHECKING:
    from sympy import Expr

__all__ = ["symbols_and_functions"]


def symbols_and_functions(expression: Expr) -> tuple[set[Symbol], set[Any]]:
    """Return the symbols and the applied functions in an expression, bound ones and those inside others included.

    SymPy's ``atoms`` finds the same, but takes many times as long, which is seconds for sums over a hundred thousand
    rows.

    Examples
    --------
    >>> from sympy import Function, symbols
    >>> x, t = symbols("x t")
    >>> symbols_and_functions(x + Function("f")(t)) == ({x, t}, {Function("f")(t)})
    True
    """
    symbols, functions, waiting = set[Symbol](), set[Any](), list[Any]([expression])
    while waiting:
        current = waiting.pop()
        if isinstance(current, Symbol):
            symbols.add(current)
            continue
        if isinstance(current, AppliedUndef):
            functions.add(current)
        waiting.extend(current.args)
    return symbols, functions
