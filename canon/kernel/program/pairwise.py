"""Pair forces recognised in H = Σ c_ij φ(x_i, x_j), one symmetric function of every pair of bodies.

Written out, the force of fifty bodies takes seconds to compile and does not fit the processor's caches. What
is recognised here, :mod:`canon.kernel.llvm.pair_loops` writes as a loop over the sources j around a loop over the
targets i, F_i ← F_i − c_ij ∂φ/∂x_i. Every pair is computed twice, which costs less than taking the reactions from the
first time would.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import sympy as sp

from canon.kernel.program.program import program
from canon.kernel.program.repeated.pair_function import Key, PairForces, factored, pair_key

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Symbol

    from canon.expression.graph.graph import Graph
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["pair_forces"]

_FEWEST = 12
"""Fewer bodies are written out: then the compiler sees every pair, and computes it once."""


def pair_forces(system: HamiltonEquations) -> PairForces | None:
    """Find the forces of pairs in the sum that H is, or return None where there are none, or few.

    Every pair of bodies has to occur once, in terms that differ by a factor only; a body's coordinates follow each
    other in q.
    """
    graph, n = system.graph, len(system.q)
    place = {symbol: i for i, symbol in enumerate(system.q)}
    terms = _terms(graph, system.hamiltonian)
    for axes in (3, 2, 1):
        bodies, odd = divmod(n, axes)
        if odd or bodies < _FEWEST:
            continue
        found = _pairs(graph, terms, place, bodies, axes)
        if found is not None:
            return _forces(system, terms, found, bodies, axes)
    return None


@dataclass(frozen=True)
class _Pairs:
    """Which terms belong to pairs, their factors, and one of them, without its factor, to stand for all."""

    members: Mapping[tuple[int, int], int]
    factors: Mapping[tuple[int, int], Fraction]
    first: tuple[int, int]
    function: int


def _terms(graph: Graph, node: int) -> list[int]:
    found, waiting = list[int](), [node]
    while waiting:
        each = waiting.pop()
        if graph.nodes[each].kind == "add":
            waiting.extend(graph.nodes[each].operands)
        else:
            found.append(each)
    return found


def _pairs(
    graph: Graph, terms: Sequence[int], place: Mapping[Symbol, int], bodies: int, axes: int
) -> _Pairs | None:
    """Return the family of terms that has every pair of bodies once, in a symmetric function."""
    wanted = bodies * (bodies - 1) // 2
    terms = [term for term in terms if graph.masks[term].bit_count() == 2 * axes]
    if len(terms) < wanted:
        return None
    families: dict[Key, dict[tuple[int, int], tuple[int, Fraction, int]]] = {}
    for term in terms:
        pair = _pair_of(graph, term, place, axes)
        if pair is None:
            continue
        factor, function = factored(graph, term)
        slots = {s: (pair.index(place[s] // axes), place[s] % axes) for s in graph.symbols(term)}
        key = pair_key(graph, function, slots)
        if key != pair_key(graph, function, {s: (1 - body, axis) for s, (body, axis) in slots.items()}):
            continue
        members = families.setdefault(key, {})
        if pair in members:
            return None
        members[pair] = term, factor, function
    whole = next((members for members in families.values() if len(members) == wanted), None)
    if whole is None:
        return None
    first = min(whole)
    return _Pairs(
        {pair: term for pair, (term, _, _) in whole.items()},
        {pair: factor for pair, (_, factor, _) in whole.items()},
        first,
        whole[first][2],
    )


def _pair_of(graph: Graph, term: int, place: Mapping[Symbol, int], axes: int) -> tuple[int, int] | None:
    """Return the two bodies whose coordinates stand in a term, and nothing else."""
    symbols = graph.symbols(term)
    if not all(symbol in place for symbol in symbols):
        return None
    bodies = sorted({place[symbol] // axes for symbol in symbols})
    return (bodies[0], bodies[1]) if len(bodies) == 2 else None


def _forces(
    system: HamiltonEquations, terms: Sequence[int], found: _Pairs, bodies: int, axes: int
) -> PairForces:
    graph = system.graph
    target, source = ([sp.Dummy(f"{letter}{k}", real=True) for k in range(axes)] for letter in ("x", "y"))
    renamed = {
        graph.symbol(system.q[axes * body + k]): graph.symbol(new[k])
        for body, new in zip(found.first, (target, source), strict=True)
        for k in range(axes)
    }
    function = graph.negative(graph.substitute([found.function], renamed)[0])
    gradient = program(graph, graph.gradient(function, target), [*target, *source])
    strengths = [[Fraction(0)] * bodies for _ in range(bodies)]
    for (i, j), factor in found.factors.items():
        strengths[i][j] = strengths[j][i] = factor
    taken = set(found.members.values())
    coordinates = frozenset(system.q)
    others = [term for term in terms if term not in taken and graph.symbols(term) & coordinates]
    rest = tuple(graph.negative(slope) for slope in graph.gradient(graph.add(others), system.q))
    return PairForces(bodies, axes, gradient, tuple(map(tuple, strengths)), rest if others else ())
