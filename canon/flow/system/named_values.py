"""Values along a motion by name: variables, velocities, momenta, multipliers, and functions of them."""

from __future__ import annotations

from dataclasses import replace
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

from sympy import Dummy

from canon.expression.symbols.symbol import velocity
from canon.mechanics.algebra.dynamicsymbols import plain

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["node_along", "variables_of"]


def variables_of(equations: HamiltonEquations) -> tuple[Symbol, ...]:
    """Return the variables of the states that are shown, in their order."""
    both = (*equations.q, *equations.p)
    return tuple(both[row] for row in equations.rows)


def node_along(equations: HamiltonEquations, what: str | Expr) -> int:
    """Return the node of a function of what moves, or of one of them by name.

    Raises
    ------
    KeyError
        A name is known neither as a variable nor as something that follows from them.
    """
    shown = variables_of(equations)
    named: dict[Symbol, int] = dict(equations.named)
    if equations.canonical:
        n = len(equations.q) - equations.varying
        named |= dict(zip(map(velocity, equations.q[:n]), equations.velocity, strict=False))
    if isinstance(what, str):
        known: dict[str, Symbol] = {
            s.name: s for s in (*named, *shown, equations.t) if not isinstance(s, Dummy)
        }
        if what not in known:
            near = get_close_matches(what, known, 1)
            meant = f"; is {near[0]} meant?" if near else ""
            raise KeyError(f"nothing along this motion is called {what!r}, it has {', '.join(known)}{meant}")
        what = known[what]
    expression = plain(what, shown, equations.t)
    unnamed: Any = {s for s in expression.free_symbols if s in named}
    if not unnamed:
        return equations.node(expression, f"{expression}")
    return replace(equations, named=named).node(expression, f"{expression}")
