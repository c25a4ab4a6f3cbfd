"""Hamiltonians that are sums of one term over many rows, H = Σ T(p_k) + Σ V(q_k): places in the state for symbols."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import sympy as sp
from sympy import Symbol

from canon.cached_property import cached_property
from canon.expression.graph.graph import Graph
from canon.expression.symbols.repeated_sum import RepeatedSum, sums_within
from canon.kernel.program.program import exact_value, with_numbers

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    import numpy.typing as npt
    from sympy import Expr

__all__ = ["Column", "KeptFunction", "RepeatedTerms", "repeated_terms", "sums_in"]

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
        """The number of rows; a constant has one."""
        return len(self.columns[0]) if self.columns else 1

    @property
    def is_single(self) -> bool:
        """Whether it is a single term."""
        return not self.columns or (self.count == 1 and not self.pairs)

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

    def written_out(self, variables: Sequence[Symbol]) -> Expr:
        """Return the sum as SymPy writes it, given the symbols of the state in order."""
        columns = [
            [sp.Rational(x.numerator, x.denominator) for x in column]
            if isinstance(column, tuple)
            else [variables[k] for k in column.tolist()]
            for column in self.columns
        ]
        term = self.graph.to_sympy(self.node)
        return RepeatedSum(term, self.slots, columns, self.pairs).doit() if columns else term

    def reads(self, n: int) -> set[str]:
        """Return whether q, p or both are read, of states (q, p) of n coordinates."""
        of_momenta = {bool(of) for k in self.moving for of in np.unique(np.asarray(self.columns[k]) >= n)}
        return {"p" if of else "q" for of in of_momenta}


@dataclass(frozen=True, eq=False)
class KeptFunction:
    """A function of the state as sums over rows.

    Parameters
    ----------
    sums
        The sums that it consists of.
    """

    sums: tuple[RepeatedTerms, ...]

    def written_out(self, variables: Sequence[Symbol]) -> Expr:
        """Return the function as SymPy writes it, given the symbols of the state in order."""
        return sp.Add(*(each.written_out(variables) for each in self.sums))


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
    if not any(each.is_long for each in sums_within(hamiltonian)):
        return None
    found = sums_in(hamiltonian, (*q, *p), t, parameters, "the Hamiltonian")
    if found is None or any(each.is_single and each.size > _SINGLE for each in found):
        return None
    kinds = {each.graph.nodes[k].kind for each in found for k in each.graph.reachable([each.node])}
    return None if kinds.intersection(_KINKED) else found


def sums_in(
    function: Expr, variables: Sequence[Symbol], t: Symbol, parameters: Mapping[str, Fraction], what: str
) -> tuple[RepeatedTerms, ...] | None:
    """Return the sums that a function of the state consists of, or None where sums stand inside other functions.

    Parameters
    ----------
    function, variables, t
        The function, the symbols of the state in order, and that of the time.
    parameters
        Numbers for all other symbols, by name.
    what
        What the function is called in errors.

    Raises
    ------
    KeyError
        A symbol has no number.
    """
    reader = _Reader({s: i for i, s in enumerate(variables)}, t, parameters, what)
    found: list[RepeatedTerms] = []
    single: list[Expr] = []
    for addend in sp.Add.make_args(function):
        factor, rest = addend.as_independent(RepeatedSum, as_Add=False)
        if isinstance(rest, RepeatedSum):
            read = reader.of_sum(rest if factor == 1 else rest.of(factor * rest.term))
            if read is None:
                return None
            found += read
        elif addend.has(RepeatedSum):
            return None
        else:
            single.append(addend)
    return (*found, reader.of_single(sp.Add(*single))) if single else tuple(found)


@dataclass(frozen=True)
class _Reader:
    """Puts places for symbols and numbers for parameters."""

    place: Mapping[Any, int]
    t: Symbol
    parameters: Mapping[str, Fraction]
    what: str

    def of_sum(self, whole: RepeatedSum) -> list[RepeatedTerms] | None:
        """Return a sum as sums whose columns are all places or all numbers, or None where its arguments are other."""
        if not self.place.keys().isdisjoint(whole.term.free_symbols):
            return None
        groups = self._columns(whole)
        if groups is None or (whole.pairs and len(groups) > 1):
            return None
        graph = Graph()
        node = self._node(graph, whole.term, whole.slots)
        return [RepeatedTerms(graph, node, whole.slots, columns, whole.pairs) for columns in groups]

    def _columns(self, whole: RepeatedSum) -> list[tuple[Column, ...]] | None:
        """Return the arguments of all rows with places and numbers in the same slots, or None where one is neither.

        In nearly all rows all are places, and there may be a hundred thousand of them.
        """
        read = [[self.place.get(each) for each in column] for column in whole.columns]
        other = {i for column in read if None in column for i, place in enumerate(column) if place is None}
        found = self._with_numbers(whole, read, sorted(other))
        if found is None:
            return None
        if len(other) < len(read[0]):
            found[(True,) * len(read)] = [i for i in range(len(read[0])) if i not in other]
        return [
            tuple(_column(is_place, column, rows) for is_place, column in zip(kinds, read, strict=True))
            for kinds, rows in sorted(found.items(), key=lambda group: group[1][0])
        ]

    def _with_numbers(
        self, whole: RepeatedSum, read: Sequence[list[Any]], other: Sequence[int]
    ) -> dict[tuple[bool, ...], list[int]] | None:
        """Put numbers where these rows have no places; return the rows by which of theirs are places."""
        known: dict[Expr, Any] = {}
        found: dict[tuple[bool, ...], list[int]] = {}
        for i in other:
            found.setdefault(tuple(column[i] is not None for column in read), []).append(i)
            for given, column in zip(whole.columns, read, strict=True):
                if column[i] is None:
                    column[i] = self._number(given[i], known)
            if any(column[i] is None for column in read):
                return None
        return found

    def of_single(self, expression: Expr) -> RepeatedTerms:
        """Return what stands beside the sums, as a sum of one row."""
        held = expression.free_symbols
        slots = tuple(s for s in self.place if s in held)
        graph = Graph()
        node = self._node(graph, expression, slots)
        return RepeatedTerms(graph, node, slots, tuple(np.array([self.place[s]]) for s in slots), pairs=False)

    def _node(self, graph: Graph, expression: Expr, slots: Sequence[Symbol]) -> int:
        return with_numbers(graph, expression, (*slots, self.t), self.parameters, self.what)

    def _number(self, argument: Expr, known: dict[Expr, Any]) -> Any:
        """Return the value of a number; None of what holds variables or the time."""
        if argument not in known:
            known[argument] = None
            held = argument.free_symbols
            if self.t not in held and self.place.keys().isdisjoint(held):
                graph = Graph()
                known[argument] = exact_value(graph, self._node(graph, argument, ()))
        return known[argument]


def _column(is_place: bool, column: Sequence[Any], rows: Sequence[int]) -> Column:
    members = column if len(rows) == len(column) else (column[i] for i in rows)
    return np.fromiter(members, np.intp, len(rows)) if is_place else tuple(members)
