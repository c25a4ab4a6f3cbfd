"""Balances of Newton and Euler solved on a graph, with no pivot that vanishes where the bodies stand regularly.

Where the reactions do no virtual work, Σ ∂ṙ/∂q̇ · balance has the accelerations alone, with the symmetric matrix of
masses. The reactions, and all unknowns otherwise, follow by least squares: AᵀW A is definite wherever A has full rank.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.equations.lagrangian_motion import values_at_start
from canon.flow.equations.linear_equations import solved_from_start

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Symbol

    from canon.expression.graph.graph import Graph
    from canon.mechanics.lagrange.newton_euler import NewtonEuler

__all__ = ["solved_balances"]


def solved_balances(
    graph: Graph, given: NewtonEuler, balances: Sequence[int], start: Mapping[Symbol, float]
) -> tuple[int, ...]:
    """Return the nodes of the accelerations and of the reactions.

    Parameters
    ----------
    graph
        The graph.
    given
        The bodies with their loads.
    balances
        The nodes of its balances, linear in the unknowns.
    start
        Numbers for the state, t and the parameters.

    Raises
    ------
    SingularAtStartError
        They do not determine the unknowns there.
    """
    unknown, n = given.unknowns, len(given.q)
    weights = [graph.number(w) for w in _weights(graph, given, start)]
    if not given.has_mass_matrix:
        return _least_squares(graph, balances, unknown, weights, start)
    accelerations, reactions = unknown[:n], unknown[n:]
    slopes = [[graph.from_sympy(a) for a in row] for row in given.partial_velocities]
    still = {graph.symbol(s): graph.zero for s in reactions}
    moving = graph.substitute(balances, still)
    found = _projected(graph, slopes, moving, accelerations, start)
    through = {graph.symbol(s): node for s, node in zip(accelerations, found, strict=True)}
    holding = graph.substitute(balances, through)
    return (*found, *_least_squares(graph, holding, reactions, weights, start))


def _least_squares(
    graph: Graph,
    equations: Sequence[int],
    unknown: Sequence[Symbol],
    weights: Sequence[int],
    start: Mapping[Symbol, float],
) -> tuple[int, ...]:
    weighted = [
        [graph.mul((w, a)) for a in graph.gradient(e, unknown)]
        for w, e in zip(weights, equations, strict=True)
    ]
    return _projected(graph, weighted, equations, unknown, start)


def _projected(
    graph: Graph,
    directions: Sequence[Sequence[int]],
    equations: Sequence[int],
    unknown: Sequence[Symbol],
    start: Mapping[Symbol, float],
) -> tuple[int, ...]:
    """Return the unknowns of the equations' sums along directions, one an unknown, whose matrix is symmetric."""
    if not unknown:
        return ()
    slopes = [graph.gradient(e, unknown) for e in equations]
    still = {graph.symbol(s): graph.zero for s in unknown}
    rest = graph.substitute(equations, still)
    columns, n = list(zip(*directions, strict=True)), len(unknown)

    def along(i: int, values: Sequence[int]) -> int:
        return graph.add([graph.mul(pair) for pair in zip(columns[i], values, strict=True)])

    by_column = list(zip(*slopes, strict=True))
    matrix = [[along(min(i, j), by_column[max(i, j)]) for j in range(n)] for i in range(n)]
    right = [graph.negative(along(i, rest)) for i in range(n)]
    values = values_at_start(graph, [a for row in matrix for a in row], start, "the matrix of the balances")
    return solved_from_start(graph, matrix, right, values.reshape(n, n))


def _weights(graph: Graph, given: NewtonEuler, start: Mapping[Symbol, float]) -> list[Fraction]:
    """Return the weights of the balances at the start, 1 of a body whose mass is a parameter that is 0."""
    with np.errstate(all="ignore"):
        found = [float(w) for w in graph.evaluate([graph.from_sympy(w) for w in given.weights], start)]
    return [Fraction(w if np.isfinite(w) and w > 0 else 1.0) for w in found]
