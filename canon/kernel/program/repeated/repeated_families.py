"""Rates of sums over rows as families of operations, which :mod:`canon.kernel.llvm.rolled` writes as loops.

Each operation of a term's slopes is a family with one member a row. What a component of the rate adds up is known by
the rows in which its variable stands: components that add up the same families, in the interior of a chain or of a
lattice, are one family of sums.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from canon.kernel.program.operation_families import Families, OperationFamily, regular
from canon.kernel.program.program import Program, program

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt
    from sympy import Symbol

    from canon.kernel.program.repeated.repeated_terms import RepeatedTerms

__all__ = ["MOST_ADDENDS", "families_of_sums", "most_addends"]

MOST_ADDENDS = 12
"""A component that adds up more slopes is that of a hub, to which every row belongs: it is written out."""


class _Addends(NamedTuple):
    """Slopes, one a row: the components of the rate that they belong to, and which members of a family they are."""

    components: npt.NDArray[np.intp]
    family: int
    places: Sequence[int]
    negative: bool


def most_addends(sums: Sequence[RepeatedTerms]) -> int:
    """Return how many slopes the component of a rate adds up that adds up most."""
    places = [np.asarray(each.columns[k]) for each in sums for k in each.moving]
    if not places:
        return 0
    return int(np.unique(np.concatenate(places), return_counts=True)[1].max())


def families_of_sums(
    sums: Sequence[RepeatedTerms], t: Symbol, n: int, *, negated: bool, shift: int
) -> Families:
    """Return the derivatives of sums over rows by the variables that stand in them, as families of operations.

    Parameters
    ----------
    sums
        Sums over rows, not over pairs, all of coordinates or all of momenta; of none of them every derivative is 0.
    t, n
        The symbol of the time, and how many coordinates there are: as many components has the rate.
    negated
        Whether it is −∂/∂x that is wanted.
    shift
        The place of the first component's variable in the state.
    """
    made = _Families()
    addends = [slopes for each in sums for slopes in made.slopes(each, t, shift, negated=negated)]
    outputs: dict[int, tuple[Sequence[int], Sequence[int]]] = {}
    for signature, rows, places in _alike(addends):
        kind, members = made.sum(signature, places)
        if kind in outputs:  # a slope by one variable that is the slope by another one too
            kind, members = made.copied(kind, members), range(len(rows))
        outputs[kind] = regular(rows.tolist()), members
    still = sorted({*range(n)}.difference(*(rows for rows, _ in outputs.values())))
    if still:
        outputs[made.constant()] = regular(still), [0] * len(still)
    return Families(made.families, made.places, outputs)


@dataclass
class _Families:
    """Families as they are made, and where their members find their operands."""

    families: list[OperationFamily] = field(default_factory=list[OperationFamily])
    places: list[list[Sequence[int]]] = field(default_factory=list[list["Sequence[int]"]])

    def new(self, family: OperationFamily, places: Sequence[Sequence[int]] = ()) -> int:
        """Add a family and return its number."""
        self.families.append(family)
        self.places.append(list(places))
        return len(self.families) - 1

    def constant(self) -> int:
        """Return the family of the number 0."""
        return self.new(OperationFamily("constant", Fraction(0), (), range(1)))

    def slopes(self, sums: RepeatedTerms, t: Symbol, shift: int, *, negated: bool) -> list[_Addends]:
        """Write the slopes of a term, and return which components of the rate they belong to."""
        nodes = [sums.graph.negative(node) for node in sums.slopes] if negated else list(sums.slopes)
        steps = program(sums.graph, nodes, (*sums.slots, t))
        families = self._operations(steps, sums)
        found: list[_Addends] = []
        for register, k in zip(steps.outputs, sums.moving, strict=True):
            operation, operands, _ = steps.instructions[register]
            components, negative = np.asarray(sums.columns[k]) - shift, operation == "neg"
            kind, places = families[operands[0] if negative else register]
            found.append(_Addends(components, kind, places, negative))
        return found

    def _operations(self, steps: Program, sums: RepeatedTerms) -> list[tuple[int, Sequence[int]]]:
        """Write the operations of a term, and return for each register its family and where a row finds it there."""
        every = range(sums.count)
        found: list[tuple[int, Sequence[int]]] = []
        for operation, operands, value in steps.instructions:
            if operation == "input":
                found.append(self._argument(sums, value))
                continue
            if operation == "constant":
                found.append((self.new(OperationFamily("constant", value, (), every)), every))
                continue
            kinds, places = zip(*(found[o] for o in operands), strict=True)
            found.append((self.new(OperationFamily(operation, None, kinds, every), places), every))
        return found

    def _argument(self, sums: RepeatedTerms, slot: int) -> tuple[int, Sequence[int]]:
        """Return the family of a term's argument, and where each row finds its own."""
        every = range(sums.count)
        if slot == len(sums.slots):
            return self.new(OperationFamily("time", None, (), every)), every
        column = sums.columns[slot]
        if isinstance(column, np.ndarray):
            return self.new(OperationFamily("input", None, (), every)), regular(column.tolist())
        if len({*column}) == 1:
            return self.new(OperationFamily("constant", column[0], (), every)), every
        return self.new(OperationFamily("numbers", None, (), every, column)), every

    def copied(self, kind: int, places: Sequence[int]) -> int:
        """Return a family of the members at some places."""
        every = range(len(places))
        return self.new(
            OperationFamily("add", None, (kind, self.constant()), every), [places, [0] * len(places)]
        )

    def sum(
        self, signature: Sequence[tuple[int, bool]], places: Sequence[Sequence[int]]
    ) -> tuple[int, Sequence[int]]:
        """Write Σ ± members of families, and return its family and the members that are sums."""
        order = sorted(range(len(signature)), key=lambda k: signature[k][1])  # what is added first
        (kind, negative), column = signature[order[0]], places[order[0]]
        every = range(len(column))
        if negative:
            kind, column = self.new(OperationFamily("neg", None, (kind,), every), [column]), every
        for k in order[1:]:
            other, negative = signature[k]
            operation = "sub" if negative else "add"
            kind = self.new(OperationFamily(operation, None, (kind, other), every), [column, places[k]])
            column = every
        return kind, column


def _alike(
    addends: Sequence[_Addends],
) -> list[tuple[tuple[tuple[int, bool], ...], npt.NDArray[np.intp], list[Sequence[int]]]]:
    """Return which families are added up, by which components, and where each finds its addends in the families."""
    if not addends:
        return []
    components = np.concatenate([each.components for each in addends])
    kinds = np.repeat(np.arange(len(addends)), [len(each.components) for each in addends])
    rows = np.concatenate([np.arange(len(each.components)) for each in addends])
    found_at = np.concatenate([np.asarray(each.places) for each in addends])
    order = np.lexsort((rows, kinds, components))
    components, kinds, found_at = components[order], kinds[order], found_at[order]
    starts = np.flatnonzero(np.diff(components, prepend=-1))
    counts = np.diff(starts, append=len(components))
    found: list[tuple[tuple[tuple[int, bool], ...], npt.NDArray[np.intp], list[Sequence[int]]]] = []
    for count in np.unique(counts).tolist():
        own = starts[counts == count]
        table = own[:, np.newaxis] + np.arange(count)
        signatures, which = np.unique(kinds[table], axis=0, return_inverse=True)
        for k, signature in enumerate(signatures.tolist()):
            members = table[which.ravel() == k]
            families = tuple((addends[i].family, addends[i].negative) for i in signature)
            places = [regular(found_at[column].tolist()) for column in members.T]
            found.append((families, components[members[:, 0]], places))
    return found
