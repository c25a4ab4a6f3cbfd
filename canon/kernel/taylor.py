"""Graphs to heyoka expressions, and heyoka's adaptive Taylor integrator for Hamilton's equations."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Symbol

    from canon.expression.graph import Graph
    from canon.kernel.structure import Equations

__all__ = ["heyoka_equations", "heyoka_expressions", "taylor_integrator"]

_SAME_NAME = (
    "sin", "cos", "tan", "exp", "log", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh", "acosh",
    "atanh", "atan2",
)  # fmt: skip

_COMPACT_FROM = 300
"""Graphs with more nodes are compiled in heyoka's compact mode, which keeps compile times short."""


def heyoka_expressions(graph: Graph, nodes: Sequence[int], variables: Mapping[Symbol, Any]) -> list[Any]:
    """Return nodes as heyoka expressions in given heyoka variables.

    Raises
    ------
    ValueError
        A node holds sign(x), which no Taylor series crosses.
    """
    import heyoka as hy

    done = dict[int, Any]()
    for each in graph.reachable(nodes):
        kind, operands, value = graph.nodes[each]
        x = [done[o] for o in operands]
        if kind == "symbol":
            done[each] = variables[value]
        elif kind == "number":
            done[each] = hy.expression(float(value))
        elif kind == "named":
            done[each] = hy.pi if value == "pi" else hy.exp(hy.expression(1.0))
        elif kind == "add":
            done[each] = hy.sum(x)
        elif kind == "mul":
            done[each] = hy.prod(x)
        elif kind == "pow":
            exponent = graph.nodes[operands[1]]
            half = exponent.kind == "number" and exponent.value == Fraction(1, 2)
            done[each] = hy.sqrt(x[0]) if half else x[0] ** x[1]
        elif kind in _SAME_NAME:
            done[each] = getattr(hy, kind)(*x)
        elif kind == "Abs":
            done[each] = hy.select(hy.gte(x[0], hy.expression(0.0)), x[0], -x[0])
        else:
            raise ValueError(
                f"{kind}(…) has no Taylor series where it jumps: use a smooth Hamiltonian, or RK4()"
            )
    return [done[node] for node in nodes]


def heyoka_equations(system: Equations) -> list[tuple[Any, Any]]:
    """Return Hamilton's equations as heyoka takes them: pairs of a variable and its rate, (q, p) in order."""
    import heyoka as hy

    names = [f"{letter}{i}" for letter in "qp" for i in range(len(system.q))]
    variables = dict(zip((*system.q, *system.p), map(hy.expression, names), strict=True))
    rates = heyoka_expressions(
        system.graph, (*system.velocity, *system.force), {**variables, system.t: hy.time}
    )
    return list(zip(variables.values(), rates, strict=True))


def taylor_integrator(system: Equations, y0: Sequence[float], t0: float, tolerance: float | None) -> Any:
    """Return heyoka's adaptive integrator of Hamilton's equations, double precision.

    Parameters
    ----------
    system
        The equations.
    y0, t0
        The state (q, p) and the time to start from.
    tolerance
        Relative tolerance of a step; the rounding unit where None.
    """
    import heyoka as hy

    size = len(system.graph.reachable((*system.velocity, *system.force)))
    options: dict[str, Any] = {} if tolerance is None else {"tol": tolerance}
    return hy.taylor_adaptive(
        heyoka_equations(system), list(y0), time=t0, compact_mode=size > _COMPACT_FROM, **options
    )
