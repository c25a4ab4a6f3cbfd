"""Hamiltonians that are sums of one term over many rows, H = Σ T(p_k) + Σ V(q_k): places in the state for symbols."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import sympy as sp
from sympy import Symbol

from canon.cached_property import cached_property
from canon.expression.graph.graph import Graph
from canon.expression.symbols.repeated_sum import RepeatedSum
from canon.kernel.program.program import exact_value, with_numbers

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from fractions import Fraction

    import numpy.typing as npt
    from sympy import Expr

__all__ = ["Column", "RepeatedTerms", "repeated_terms"]

_FEWEST = 64
"""Sums of fewer terms are written out: then the compiler sees every term."""

_SINGLE = 200
"""Up to so many operations may stand beside the sums, written out."""

_KINKED = ("Abs", "sign")
"""Functions at whose kinks steps are said to lose their order: such sums are written out."""

Column: TypeAlias = "npt.NDArray[np.intp] | tuple[Fraction, ...]"
"""Arguments of one slot, row by row: places in the state (q, p), or numbers."""


@dataclass(frozen=True, eq=False)
class RepeatedTerms:
    """Σ f(x) over rows of places in a state, or over pairs of such rows.

    Parameters
    ----------
    graph, node
        f on a graph of its own.
    slots
        The symbols of its arguments; over pairs those of the first row, then those of the second.
    columns
        The arguments of a row by slot.
    pairs
        Whether the sum goes over pairs of rows.
    """

    graph: Graph
    node: int
    slots: tuple[Symbol, ...]
    columns: tuple[Column, ...]
    pairs: bool

    @property
    def count(self) -> int:
        """The number of rows."""
        return len(self.columns[0])

    @property
    def size(self) -> int:
        """The number of operations of f."""
        return len(self.graph.reachable([self.node]))

    @cached_property
    def moving(self) -> tuple[int, ...]:
        """The slots of a row whose arguments are places in the state."""
        return tuple(k for k, column in enumerate(self.columns) if isinstance(column, np.ndarray))

    @cached_property
    def slopes(self) -> tuple[int, ...]:
        """The nodes of ∂f/∂x for each of those slots; of pairs for those of the first row, then of the second."""
        width = len(self.columns)
        shifts = (0, width) if self.pairs else (0,)
        moving = [self.slots[shift + k] for shift in shifts for k in self.moving]
        return tuple(self.graph.gradient(self.node, moving))

    @cached_property
    def is_quadratic(self) -> bool:
        """Whether the term is a quadratic form in its variables, with constant coefficients."""
        numbers = {s for k, s in enumerate(self.slots) if k % len(self.columns) not in self.moving}
        variables = tuple(s for s in self.slots if s not in numbers)
        return all(
            self.graph.symbols(slope) <= {*self.slots}
            and all(self.graph.symbols(node) <= numbers for node in self.graph.gradient(slope, variables))
            for slope in self.slopes
        )

    def reads(self, n: int) -> set[str]:
        """Return whether q, p or both are read, of states (q, p) of n coordinates."""
        places = [self.columns[k] for k in self.moving]
        return {"p" if place >= n else "q" for column in places for place in np.asarray(column).tolist()}


def repeated_terms(
    hamiltonian: Expr,
    q: Sequence[Symbol],
    p: Sequence[Symbol],
    t: Symbol,
    parameters: Mapping[str, Fraction],
) -> tuple[RepeatedTerms, ...] | None:
    """Return the sums that a Hamiltonian consists of, or None where it is better, or has to be, written out.

    Raises
    ------
    KeyError
        A symbol of H is neither a coordinate, a momentum, the time nor a given parameter.
    """
    parts = _parts(hamiltonian)
    if parts is None:
        return None
    sums, single = parts
    reader = _Reader({s: i for i, s in enumerate((*q, *p))}, t, parameters)
    found: list[RepeatedTerms] = []
    for each in sums:
        read = reader.of_sum(each)
        if read is None:
            return None
        found += read
    if single != 0:
        found.append(reader.of_single(single))
        if found[-1].size > _SINGLE:
            return None
    kinds = {each.graph.nodes[k].kind for each in found for k in each.graph.reachable([each.node])}
    return None if kinds.intersection(_KINKED) else tuple(found)


def _parts(hamiltonian: Expr) -> tuple[list[RepeatedSum], Expr] | None:
    """Return the sums that a Hamiltonian adds up, some of them long, and the rest of it, which holds none."""
    sums: list[RepeatedSum] = []
    single: list[Expr] = []
    for addend in sp.Add.make_args(hamiltonian):
        factor, rest = addend.as_independent(RepeatedSum, as_Add=False)
        if isinstance(rest, RepeatedSum):
            sums.append(rest if factor == 1 else rest.of(factor * rest.term))
        elif addend.has(RepeatedSum):
            return None
        else:
            single.append(addend)
    return (sums, sp.Add(*single)) if any(each.length >= _FEWEST for each in sums) else None


@dataclass(frozen=True)
class _Reader:
    """Puts places for symbols and numbers for parameters."""

    place: Mapping[Symbol, int]
    t: Symbol
    parameters: Mapping[str, Fraction]

    def of_sum(self, whole: RepeatedSum) -> list[RepeatedTerms] | None:
        """Return a sum as sums whose columns are all places or all numbers, or None where its arguments are other."""
        if not self.place.keys().isdisjoint(whole.term.free_symbols):
            return None
        rows: dict[tuple[bool, ...], list[tuple[Any, ...]]] = {}
        known: dict[Expr, Any] = {}
        for row in whole.rows:
            read = tuple(self._argument(each, known) for each in row)
            if None in read:
                return None
            rows.setdefault(tuple(isinstance(each, int) for each in read), []).append(read)
        if whole.pairs and len(rows) > 1:
            return None
        graph = Graph()
        node = self._node(graph, whole.term, whole.slots)
        return [
            RepeatedTerms(graph, node, whole.slots, _columns(kinds, members), whole.pairs)
            for kinds, members in rows.items()
        ]

    def of_single(self, expression: Expr) -> RepeatedTerms:
        """Return what stands beside the sums, as a sum of one row."""
        slots = tuple(s for s in self.place if s in expression.free_symbols)
        graph = Graph()
        node = self._node(graph, expression, slots)
        return RepeatedTerms(graph, node, slots, tuple(np.array([self.place[s]]) for s in slots), pairs=False)

    def _node(self, graph: Graph, expression: Expr, slots: Sequence[Symbol]) -> int:
        return with_numbers(graph, expression, (*slots, self.t), self.parameters, "the Hamiltonian")

    def _argument(self, argument: Expr, known: dict[Expr, Any]) -> Any:
        """Return the place of a variable or the value of a number; None of what is neither."""
        if isinstance(argument, Symbol) and argument in self.place:
            return self.place[argument]
        if argument not in known:
            known[argument] = None
            held = argument.free_symbols
            if self.t not in held and self.place.keys().isdisjoint(held):
                graph = Graph()
                known[argument] = exact_value(graph, self._node(graph, argument, ()))
        return known[argument]


def _columns(kinds: Sequence[bool], rows: Sequence[Sequence[Any]]) -> tuple[Column, ...]:
    columns: Iterator[tuple[Any, ...]] = zip(*rows, strict=True)
    return tuple(
        np.array(column) if is_place else tuple(column)
        for is_place, column in zip(kinds, columns, strict=True)
    )
