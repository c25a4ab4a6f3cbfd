"""Families of a program's operations: those that compute the same function of operands of the same families."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from canon.kernel.program.program import Program

__all__ = [
    "LEAVES",
    "Families",
    "OperationFamily",
    "families_of",
    "families_of_program",
    "has_stride",
    "regular",
]

LEAVES = ("input", "time", "constant", "numbers")
"""What is no operation on others."""


@dataclass
class OperationFamily:
    """Operations of one kind on operands of the same families.

    ``members`` are the registers they write; a member's place in the family's array is its position here. A family of
    ``numbers`` has one for each member.
    """

    operation: str
    value: Fraction | None
    operands: tuple[int, ...]
    members: Sequence[int]
    numbers: tuple[Fraction, ...] = ()


@dataclass(frozen=True)
class Families:
    """A program as families of operations.

    Parameters
    ----------
    families
        The families, operands' before their users'.
    places
        By family and operand, where each member finds the operand in the operand's family.
    outputs
        By family that has outputs, their numbers, and which members they are.
    """

    families: Sequence[OperationFamily]
    places: Sequence[Sequence[Sequence[int]]]
    outputs: Mapping[int, tuple[Sequence[int], Sequence[int]]]


def families_of_program(steps: Program) -> Families:
    """Return a program as families of operations."""
    families, location = families_of(steps)
    found: dict[int, tuple[list[int], list[int]]] = {}
    for i, register in enumerate(steps.outputs):
        kind, place = location[register]
        rows, places = found.setdefault(kind, ([], []))
        rows.append(i)
        places.append(place)
    columns = [[regular(column) for column in own] for own in _operand_places(steps, families, location)]
    return Families(
        families, columns, {kind: (regular(a), regular(b)) for kind, (a, b) in sorted(found.items())}
    )


def families_of(steps: Program) -> tuple[list[OperationFamily], list[tuple[int, int]]]:
    """Return the families, operands' before their users', and each register's family and place in it."""
    found: list[OperationFamily] = []
    members: list[list[int]] = []
    number: dict[Any, int] = {}
    family_of: list[int] = []
    operands_of: list[tuple[int, ...]] = []
    for register, (operation, operands, value) in enumerate(steps.instructions):
        if operation in ("add", "mul"):
            operands = tuple(sorted(operands, key=lambda o: family_of[o]))
        kinds = tuple(family_of[o] for o in operands)
        is_time = operation == "input" and value == len(steps.inputs) - 1
        constant = value if operation == "constant" else None
        key = (operation, kinds, value if is_time else constant)
        if key not in number:
            number[key] = len(found)
            members.append([])
            found.append(OperationFamily("time" if is_time else operation, constant, kinds, members[-1]))
        family_of.append(number[key])
        operands_of.append(operands)
        members[number[key]].append(register)
    return found, list(zip(family_of, _places(steps, found, members, operands_of), strict=True))


def _places(
    steps: Program,
    families: Sequence[OperationFamily],
    members: Sequence[list[int]],
    operands_of: Sequence[tuple[int, ...]],
) -> list[int]:
    """Sort the members of families, and return each register's place; that of an input is its number."""
    place = [0] * len(operands_of)
    for family, own in zip(families, members, strict=True):
        if family.operation == "input":
            for register in own:
                place[register] = int(steps.instructions[register].value)
            continue
        # In the order of their operands, members tend to read and to be read with a stride.
        own.sort(key=lambda register: [place[o] for o in operands_of[register]])
        for position, register in enumerate(own):
            place[register] = position
    return place


def _operand_places(
    steps: Program, families: Sequence[OperationFamily], location: Sequence[tuple[int, int]]
) -> list[list[list[int]]]:
    """Return, by family and operand, where each member finds the operand in the operand's family."""
    found: list[list[list[int]]] = []
    for family in families:
        columns: list[list[int]] = [[] for _ in family.operands]
        for register in family.members:
            operands = steps.instructions[register].operands
            if family.operation in ("add", "mul"):
                operands = tuple(sorted(operands, key=lambda o: location[o][0]))
            for column, operand in zip(columns, operands, strict=True):
                column.append(location[operand][1])
        found.append(columns)
    return found


def regular(places: Sequence[int]) -> Sequence[int]:
    """Return places that follow each other by a positive stride as a range, and others as they are.

    Examples
    --------
    >>> regular([1, 3, 5]), regular([1, 2, 4])
    (range(1, 7, 2), [1, 2, 4])
    """
    if isinstance(places, range) or not places:
        return places
    first, stride = places[0], places[1] - places[0] if len(places) > 1 else 1
    if stride < 1:
        return places
    found = range(first, first + stride * len(places), stride)
    return found if list(places) == list(found) else places


def has_stride(places: Sequence[int]) -> bool:
    """Return whether places follow each other by a stride."""
    if isinstance(places, range) or len(places) < 3:
        return True
    return all(b - a == places[1] - places[0] for a, b in itertools.pairwise(places))
