"""Functions of two bodies: whether they are symmetric, and the force between every pair of bodies."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from canon.kernel.program.program import Program, exact_value, program

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy import Symbol

    from canon.expression.graph.graph import Graph
    from canon.kernel.program.repeated.repeated_terms import RepeatedTerms

__all__ = ["Key", "PairForces", "factored", "forces_of_pair_sum", "pair_key"]

Key: TypeAlias = "tuple[Any, ...]"
"""What functions of two bodies have in common that are the same."""


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


def forces_of_pair_sum(whole: RepeatedTerms, n: int) -> PairForces | None:
    """Return the forces of a sum over pairs of rows, or None where it is no symmetric function of bodies in order.

    A row is a body: its coordinates, which follow each other in q body by body, and its numbers. All n coordinates are
    those of bodies.
    """
    width, axes = len(whole.columns), len(whole.moving)
    first, second = whole.slots[:width], whole.slots[width:]
    here = {s: (body, k) for body, slots in enumerate((first, second)) for k, s in enumerate(slots)}
    there = {s: (1 - body, k) for s, (body, k) in here.items()}
    symbols = whole.graph.symbols(whole.node)
    in_order = whole.count * axes == n and all(
        np.array_equal(np.asarray(whole.columns[k]), np.arange(whole.count) * axes + i)
        for i, k in enumerate(whole.moving)
    )
    if not in_order or not symbols <= here.keys():
        return None
    if pair_key(whole.graph, whole.node, here) != pair_key(whole.graph, whole.node, there):
        return None
    fixed = [k for k in range(width) if k not in whole.moving]
    inputs = [slots[k] for own in (whole.moving, fixed) for slots in (first, second) for k in own]
    pulls = [whole.graph.negative(slope) for slope in whole.slopes[:axes]]
    numbers = tuple(tuple(whole.columns[k]) for k in fixed)
    return PairForces(whole.count, axes, program(whole.graph, pulls, inputs), (), (), numbers)


def factored(graph: Graph, term: int) -> tuple[Fraction, int]:
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


def pair_key(graph: Graph, node: int, slots: Mapping[Symbol, tuple[int, int]]) -> Key:
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
        factor, rest = factored(graph, node)
        inner = [rest] if graph.nodes[rest].kind != "mul" else list(graph.nodes[rest].operands)
        return ("mul", factor, *sorted((pair_key(graph, each, slots) for each in inner), key=repr))
    if kind == "pow":
        exponent = graph.nodes[operands[1]]
        base = graph.nodes[operands[0]]
        is_even = exponent.kind == "number" and exponent.value.denominator == 1 and exponent.value % 2 == 0
        if is_even and base.kind == "add":
            signed = [_signed(graph, term, slots) for term in base.operands]
            either = min(sorted(signed), sorted((key, -factor) for key, factor in signed))
            return ("pow", exponent.value, *either)
    return (kind, *(pair_key(graph, operand, slots) for operand in operands))


def _signed(graph: Graph, term: int, slots: Mapping[Symbol, tuple[int, int]]) -> tuple[str, Fraction]:
    factor, rest = factored(graph, term)
    return repr(pair_key(graph, rest, slots)), factor
