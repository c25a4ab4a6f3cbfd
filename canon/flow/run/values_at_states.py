"""Energy and rates at states: on the equations' graph, or of sums over rows without writing them out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.graph.number_systems import FLOAT64, LONGDOUBLE
from canon.kernel.program.repeated.repeated_values import rates_of_sums, size_of_sums, value_of_sums

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from canon.array import Array
    from canon.expression.graph.number_systems import Arithmetic
    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.program.repeated.repeated_terms import RepeatedTerms

__all__ = ["energy_and_rates", "energy_terms", "size_of_energy", "values_of_sums"]


def energy_and_rates(
    system: HamiltonEquations, state: npt.NDArray[Any], time: Any, arithmetic: Arithmetic
) -> Sequence[Any]:
    """Return H, ∂H/∂p and −∂H/∂q at one state, shape (2n,), or at several, shape (2n, orbits)."""
    if system.sums:
        with arithmetic.quiet():
            rates = rates_of_sums(system.sums, system.t, state, time, arithmetic)
            return [value_of_sums(system.sums, system.t, state, time, arithmetic), *rates]
    values = dict(zip(system.inputs, (*state, time), strict=True))
    return system.graph.evaluate((system.hamiltonian, *system.velocity, *system.force), values, arithmetic)


def values_of_sums(
    system: HamiltonEquations, sums: Sequence[RepeatedTerms], state: npt.NDArray[np.longdouble], t: Array
) -> npt.NDArray[np.longdouble]:
    """Return what sums over rows add up to at states of shape (2n, times, …) in long doubles."""
    times = t.astype(np.longdouble).reshape((-1,) + (1,) * (state.ndim - 2))
    with LONGDOUBLE.quiet():
        return value_of_sums(sums, system.t, state, times, LONGDOUBLE)


def size_of_energy(system: HamiltonEquations, states: Array, t: Array) -> Array:
    """Return Σ |term| over the terms of H at states of shape (2n, times, …)."""
    times = t.reshape((-1,) + (1,) * (states.ndim - 2))
    with FLOAT64.quiet():
        if system.sums:
            return size_of_sums(system.sums, system.t, states, times, FLOAT64)
        values = dict(zip(system.inputs, (*states, times), strict=True))
        found = system.graph.evaluate(energy_terms(system), values)
    return np.sum([abs(np.broadcast_to(value, states.shape[1:])) for value in found], axis=0)


def energy_terms(system: HamiltonEquations) -> tuple[int, ...]:
    """Return the nodes of the terms of H, where a sum with a factor before it is several too."""
    graph = system.graph
    node = graph.nodes[system.hamiltonian]
    if node.kind == "add":
        return node.operands
    sums = [each for each in node.operands if graph.nodes[each].kind == "add"]
    if node.kind != "mul" or len(sums) != 1:
        return (system.hamiltonian,)
    factors = [each for each in node.operands if each != sums[0]]
    return tuple(graph.mul((*factors, term)) for term in graph.nodes[sums[0]].operands)
