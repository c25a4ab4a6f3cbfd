"""Expression trees with their types: what SymPy gives back untyped, said once."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from sympy import Expr, Symbol

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["arguments", "replaced", "symbols_of"]


def arguments(f: Expr) -> tuple[Expr, ...]:
    """Return the arguments of an expression."""
    return cast("tuple[Expr, ...]", f.args)


def replaced(f: Expr, values: Mapping[Symbol, Expr] | Mapping[Expr, Expr]) -> Expr:
    """Return f with subexpressions replaced all at once."""
    return cast("Expr", f.xreplace(dict(values)))


def symbols_of(*expressions: Expr) -> list[Symbol]:
    """Return the symbols of some expressions by name."""
    found = {s for f in expressions for s in f.free_symbols if isinstance(s, Symbol)}
    return sorted(found, key=lambda s: s.name)
