"""Equations of first order that were given as a list: vector fields, and heyoka's pairs of variable and rate."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.expression.graph.graph import Graph
from canon.expression.symbols.input_in_words import module_of
from canon.expression.symbols.symbol import time
from canon.expression.symbols.user_input import given_expression, given_symbols
from canon.flow.equations.first_order_motion import FirstOrderMotion, from_any_start
from canon.mechanics.algebra.dynamicsymbols import in_own_time
from canon.mechanics.algebra.substitution import exchanged
from canon.mechanics.hamilton.vector_field import VectorField, check_moves_in_time

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Symbol

__all__ = ["field_motion", "heyoka_field", "is_heyoka_system"]


def field_motion(field: VectorField, t: Symbol = time) -> FirstOrderMotion:
    """Return the equations ẋ = X(x, t) of a vector field; no energy is known of it.

    Raises
    ------
    ValueError
        One of the variables is the time.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y = symbols("x y")
    >>> field_motion(VectorField((y, -x), (x, y))).state
    (x, y)
    """
    check_moves_in_time(field, t)
    graph = Graph()
    given = [given_expression(f, "the vector field") for f in field.components]
    rates = tuple(graph.from_sympy(in_own_time(f, field.x, t)) for f in given)
    return FirstOrderMotion("vector field", graph, field.x, (), "x", t, rates, holds_from=from_any_start)


def is_heyoka_system(given: Any) -> bool:
    """Tell whether something is heyoka's list of pairs (variable, right-hand side), without loading heyoka."""
    if not isinstance(given, list | tuple) or not given:
        return False
    return all(
        isinstance(pair, tuple) and len(pair) == 2 and module_of(type(pair[0])).startswith("heyoka")  # pyright: ignore[reportUnknownArgumentType]
        for pair in given  # pyright: ignore[reportUnknownVariableType]
    )


def heyoka_field(pairs: Sequence[tuple[Any, Any]]) -> VectorField:
    """Return heyoka's equations as a vector field: ``par[0]`` becomes a parameter of that name.

    Raises
    ------
    ValueError
        A right-hand side holds a function that SymPy does not know.
    """
    import heyoka as hy

    clock = sp.Function("heyoka_time")()

    def taken(expression: Any) -> sp.Expr:
        try:
            own = expression if isinstance(expression, hy.expression) else hy.expression(expression)
            found: sp.Expr = hy.to_sympy(own)
        except TypeError as unknown:
            raise ValueError(f"{unknown}: write that right-hand side with SymPy's functions") from unknown
        exact = {x: sp.Rational(Fraction(float(x))) for x in found.atoms(sp.Float)}
        return exchanged(found, {**exact, clock: time})

    variables = [taken(x) for x, _ in pairs]
    if time in variables:
        raise ValueError("heyoka's variable t has the name of the time here: call it something else")
    return VectorField([taken(rate) for _, rate in pairs], given_symbols(variables, "heyoka's variables"))
