"""Anatomy of expressions: their distinct parts, each looked at once.

SymPy's ``free_symbols``, ``has`` and ``atoms`` walk the whole tree; composed maps share parts, and their
trees are far larger than the number of distinct parts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import sympy as sp

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["Anatomy", "anatomy"]


@dataclass(frozen=True)
class Anatomy:
    """The distinct parts of some expressions, and the size of their trees."""

    parts: tuple[sp.Basic, ...]
    tree: int

    @property
    def symbols(self) -> set[sp.Symbol]:
        """The symbols, without those bound by a substitution or an integral."""
        return {part for part in self.parts if isinstance(part, sp.Symbol)} - self._bound

    @property
    def _bound(self) -> set[sp.Basic]:
        bound: set[sp.Basic] = set()
        for part in self.parts:
            if isinstance(part, sp.Subs):
                bound |= set(cast("tuple[sp.Symbol, ...]", part.variables)) - part.free_symbols
        return bound

    def has(self, *kinds: type[Any]) -> bool:
        """Tell whether some part is of one of these kinds."""
        return any(isinstance(part, kinds) for part in self.parts)

    def of(self, *kinds: type[Any]) -> list[Any]:
        """Return the parts of these kinds."""
        return [part for part in self.parts if isinstance(part, kinds)]


def anatomy(exprs: Iterable[sp.Basic]) -> Anatomy:
    """Return the anatomy of some expressions together.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> found = anatomy([sp.sin(x + y) * (x + y)])
    >>> sorted(map(str, found.symbols)), len(found.parts), found.tree
    (['x', 'y'], 5, 8)
    """
    sizes: dict[sp.Basic, int] = {}
    total = 0
    for expr in exprs:
        stack: list[tuple[sp.Basic, bool]] = [(expr, False)]
        while stack:
            part, ready = stack.pop()
            if part in sizes:
                continue
            if ready:
                sizes[part] = 1 + sum(map(sizes.__getitem__, part.args))
            elif inner := part.args:
                stack.append((part, True))
                stack.extend([(a, False) for a in inner if a not in sizes])
            else:
                sizes[part] = 1
        total += sizes[expr]
    return Anatomy(tuple(sizes), total)
