"""Energy and rates at states: on the equations' graph, or of sums over rows without writing them out."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.graph.number_systems import FLOAT64, LONGDOUBLE
from canon.kernel.llvm.number_types import DOUBLE, DOUBLE_DOUBLE
from canon.kernel.llvm.pair_values import CompiledPairs, can_be_compiled
from canon.kernel.program.repeated.repeated_values import rates_of_sums, size_of_sums, value_of_sums

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy.typing as npt
    from sympy import Symbol

    from canon.array import Array
    from canon.expression.graph.number_systems import Arithmetic
    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.program.repeated.repeated_terms import RepeatedTerms

__all__ = ["energy_and_rates", "energy_terms", "size_of_energy", "values_of_sums"]

_MANY = 200
"""Pairs of so many rows are added up by compiled code."""

_KEPT = 64


def energy_and_rates(
    system: HamiltonEquations, state: npt.NDArray[Any], time: Any, arithmetic: Arithmetic
) -> Sequence[Any]:
    """Return H, ∂H/∂p and −∂H/∂q at one state, shape (2n,), or at several, shape (2n, orbits)."""
    if system.sums:
        with arithmetic.quiet():
            rates = _rates(system, state, time, arithmetic)
            return [_value(system.sums, system.t, state, time, arithmetic), *rates]
    values = dict(zip(system.inputs, (*state, time), strict=True))
    return system.graph.evaluate((system.hamiltonian, *system.velocity, *system.force), values, arithmetic)


def values_of_sums(
    system: HamiltonEquations, sums: Sequence[RepeatedTerms], state: npt.NDArray[np.longdouble], t: Array
) -> npt.NDArray[np.longdouble]:
    """Return what sums over rows add up to at states of shape (2n, times, …) in long doubles."""
    times = t.astype(np.longdouble).reshape((-1,) + (1,) * (state.ndim - 2))
    with LONGDOUBLE.quiet():
        return _value(sums, system.t, state, times, LONGDOUBLE)


def size_of_energy(system: HamiltonEquations, states: Array, t: Array) -> Array:
    """Return Σ |term| over the terms of H at states of shape (2n, times, …)."""
    times = t.reshape((-1,) + (1,) * (states.ndim - 2))
    with FLOAT64.quiet():
        if system.sums:
            single, pairs = _apart(system.sums, system.t, FLOAT64)
            size = size_of_sums(single, system.t, states, times, FLOAT64)
            return size + _of_pairs(pairs, states, times, lambda each, y, at: each.value_and_size(y, at)[1])
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


# sums over rows, and over pairs of rows ---------------------------------------------------------------


def _value(
    sums: Sequence[RepeatedTerms], t: Symbol, state: npt.NDArray[Any], time: Any, arithmetic: Arithmetic
) -> npt.NDArray[Any]:
    single, pairs = _apart(sums, t, arithmetic)
    value = value_of_sums(single, t, state, time, arithmetic)
    return value + _of_pairs(pairs, state, time, lambda each, y, at: each.value_and_size(y, at)[0])


def _rates(
    system: HamiltonEquations, state: npt.NDArray[Any], time: Any, arithmetic: Arithmetic
) -> npt.NDArray[Any]:
    single, pairs = _apart(system.sums, system.t, arithmetic)
    rates = rates_of_sums(single, system.t, state, time, arithmetic)
    slopes = _of_pairs(pairs, state, time, lambda each, y, at: each.slopes(y, at))
    n = len(system.q)
    return rates + np.concatenate([slopes[n:], -slopes[:n]]) if pairs else rates


def _apart(
    sums: Sequence[RepeatedTerms], t: Symbol, arithmetic: Arithmetic
) -> tuple[list[RepeatedTerms], list[CompiledPairs]]:
    """Return the sums that NumPy adds up, and those over many pairs, which are compiled."""
    many = [each for each in sums if each.count >= _MANY and _is_compiled(each)]
    scalar = DOUBLE if arithmetic is FLOAT64 else DOUBLE_DOUBLE
    return [each for each in sums if each not in many], [_kept_pairs(each, t, scalar) for each in many]


_is_compiled = functools.lru_cache(maxsize=_KEPT)(can_be_compiled)
_kept_pairs = functools.lru_cache(maxsize=_KEPT)(CompiledPairs)


def _of_pairs(
    pairs: Sequence[CompiledPairs],
    state: npt.NDArray[Any],
    time: Any,
    take: Callable[[CompiledPairs, npt.NDArray[Any], Any], Any],
) -> Any:
    """Return the sum of what is taken of each at states of shape (2n, …): a number or, shape (2n,), slopes."""
    if not pairs:
        return state.dtype.type(0)
    times = np.broadcast_to(np.asarray(time, dtype=state.dtype), state.shape[1:])
    found = [
        sum(
            np.asarray(take(each, state[(slice(None), *place)], times[place]), dtype=state.dtype)
            for each in pairs
        )
        for place in np.ndindex(state.shape[1:])
    ]
    of_each = np.stack(found, axis=-1)
    return of_each.reshape(of_each.shape[:-1] + state.shape[1:])
