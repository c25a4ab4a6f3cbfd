"""Families of a program's operations: those that compute the same function of operands of the same families."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from canon.kernel.program.program import Program

__all__ = ["LEAVES", "OperationFamily", "families_of", "has_stride", "operand_places"]

LEAVES = ("input", "time", "constant")
"""What is no operation on others."""


@dataclass
class OperationFamily:
    """Operations of one kind on operands of the same families.

    ``members`` are the registers they write; a member's place in the family's array is its position here.
    """

    operation: str
    value: Fraction | None
    operands: tuple[int, ...]
    members: list[int] = field(default_factory=list[int])


def families_of(steps: Program) -> tuple[list[OperationFamily], list[tuple[int, int]]]:
    """Return the families, operands' before their users', and each register's family and place in it."""
    found: list[OperationFamily] = []
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
            found.append(OperationFamily("time" if is_time else operation, constant, kinds))
        family_of.append(number[key])
        operands_of.append(operands)
        found[number[key]].members.append(register)
    return found, list(zip(family_of, _places(steps, found, operands_of), strict=True))


def _places(
    steps: Program, families: Sequence[OperationFamily], operands_of: Sequence[tuple[int, ...]]
) -> list[int]:
    """Sort the members of families, and return each register's place; that of an input is its number."""
    place = [0] * len(operands_of)
    for family in families:
        if family.operation == "input":
            for register in family.members:
                place[register] = int(steps.instructions[register].value)
            continue
        # In the order of their operands, members tend to read and to be read with a stride.
        family.members.sort(key=lambda register: [place[o] for o in operands_of[register]])
        for position, register in enumerate(family.members):
            place[register] = position
    return place


def operand_places(
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


def has_stride(places: Sequence[int]) -> bool:
    """Return whether places follow each other by a stride."""
    return len(places) < 3 or all(b - a == places[1] - places[0] for a, b in itertools.pairwise(places))
