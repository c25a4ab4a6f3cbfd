"""Pair forces recognised in H = Σ c_ij φ(x_i, x_j), one symmetric function of every pair of bodies.

Written out, the force of fifty bodies takes seconds to compile and does not fit the processor's caches. What
is recognised here, :mod:`canon.kernel.llvm.pair_loops` writes as a loop over the sources j around a loop over the
targets i, F_i ← F_i − c_ij ∂φ/∂x_i. Every pair is computed twice, which costs less than taking the reactions from the
first time would.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from canon.kernel.program.program import Program, exact_value, program

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Symbol

    from canon.expression.graph.graph import Graph
    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.program.repeated.repeated_terms import RepeatedTerms

__all__ = ["PairForces", "forces_of_pair_sum", "pair_forces"]

_FEWEST = 12
"""Fewer bodies are written out: then the compiler sees every pair, and computes it once."""

_Key = tuple[Any, ...]


@dataclass(frozen=True)
class PairForces:
    """−∂H/∂q as a sum over pairs of bodies and a rest.

    Parameters
    ----------
    bodies, axes
        Body i has the coordinates q[axes · i], …, q[axes · i + axes − 1].
    gradient
        −∂φ/∂x_i as a function of x_i and x_j.
    strengths
        c_ij, symmetric, zero on the diagonal; none where φ has no factors but its own.
    rest
        The nodes of what the pairs leave of −∂H/∂q; none where that is nothing.
    numbers
        Numbers of the bodies that φ holds, such as masses: ∂φ/∂x_i is then a function of x_i, x_j, and theirs.
    """

    bodies: int
    axes: int
    gradient: Program
    strengths: tuple[tuple[Fraction, ...], ...]
    rest: tuple[int, ...]
    numbers: tuple[tuple[Fraction, ...], ...] = ()


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


def _factored(graph: Graph, term: int) -> tuple[Fraction, int]:
    """Return a term's constant factor, and the rest of it."""
    if graph.nodes[term].kind != "mul":
        return Fraction(1), term
    factor, rest = Fraction(1), list[int]()
    for operand in graph.nodes[term].operands:
        if not graph.is_constant(operand):
            rest.append(operand)
        else:
            factor *= exact_value(graph, operand)
    return factor, graph.mul(rest)


def _pairs(
    graph: Graph, terms: Sequence[int], place: Mapping[Symbol, int], bodies: int, axes: int
) -> _Pairs | None:
    """Return the family of terms that has every pair of bodies once, in a symmetric function."""
    wanted = bodies * (bodies - 1) // 2
    terms = [term for term in terms if graph.masks[term].bit_count() == 2 * axes]
    if len(terms) < wanted:
        return None
    families: dict[_Key, dict[tuple[int, int], tuple[int, Fraction, int]]] = {}
    for term in terms:
        pair = _pair_of(graph, term, place, axes)
        if pair is None:
            continue
        factor, function = _factored(graph, term)
        slots = {s: (pair.index(place[s] // axes), place[s] % axes) for s in graph.symbols(term)}
        key = _key(graph, function, slots)
        if key != _key(graph, function, {s: (1 - body, axis) for s, (body, axis) in slots.items()}):
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


def _key(graph: Graph, node: int, slots: Mapping[Symbol, tuple[int, int]]) -> _Key:
    """Return what two functions of two bodies have in common that are the same, up to the order of sums and products.

    Of an even power of a sum only the sum's absolute value counts: (x_i − x_j)² is (x_j − x_i)².
    """
    kind, operands, value = graph.nodes[node]
    if kind == "symbol":
        return ("symbol", slots[value])
    if graph.is_constant(node):
        return ("number", exact_value(graph, node))
    if kind == "add":
        return ("add", *sorted(_signed(graph, term, slots) for term in operands))
    if kind == "mul":
        factor, rest = _factored(graph, node)
        inner = [rest] if graph.nodes[rest].kind != "mul" else list(graph.nodes[rest].operands)
        return ("mul", factor, *sorted((_key(graph, each, slots) for each in inner), key=repr))
    if kind == "pow":
        exponent = graph.nodes[operands[1]]
        base = graph.nodes[operands[0]]
        is_even = exponent.kind == "number" and exponent.value.denominator == 1 and exponent.value % 2 == 0
        if is_even and base.kind == "add":
            signed = [_signed(graph, term, slots) for term in base.operands]
            either = min(sorted(signed), sorted((key, -factor) for key, factor in signed))
            return ("pow", exponent.value, *either)
    return (kind, *(_key(graph, operand, slots) for operand in operands))


def _signed(graph: Graph, term: int, slots: Mapping[Symbol, tuple[int, int]]) -> tuple[str, Fraction]:
    factor, rest = _factored(graph, term)
    return repr(_key(graph, rest, slots)), factor


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


def forces_of_pair_sum(whole: RepeatedTerms) -> PairForces | None:
    """Return the forces of a sum over pairs of rows, or None where it is no symmetric function of bodies in order.

    A row is a body: its coordinates, which follow each other in q body by body, and its numbers.
    """
    width, axes = len(whole.columns), len(whole.moving)
    first, second = whole.slots[:width], whole.slots[width:]
    here = {s: (body, k) for body, slots in enumerate((first, second)) for k, s in enumerate(slots)}
    there = {s: (1 - body, k) for s, (body, k) in here.items()}
    symbols = whole.graph.symbols(whole.node)
    in_order = all(
        np.array_equal(np.asarray(whole.columns[k]), np.arange(whole.count) * axes + i)
        for i, k in enumerate(whole.moving)
    )
    if not in_order or not symbols <= here.keys():
        return None
    if _key(whole.graph, whole.node, here) != _key(whole.graph, whole.node, there):
        return None
    fixed = [k for k in range(width) if k not in whole.moving]
    inputs = [slots[k] for own in (whole.moving, fixed) for slots in (first, second) for k in own]
    pulls = [whole.graph.negative(slope) for slope in whole.slopes[:axes]]
    numbers = tuple(tuple(whole.columns[k]) for k in fixed)
    return PairForces(whole.count, axes, program(whole.graph, pulls, inputs), (), (), numbers)
