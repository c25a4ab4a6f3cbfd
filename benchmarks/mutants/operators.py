"""Operators of mutation: those of cosmic-ray that are usual, and a few that it lacks, written as it asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import parso
from cosmic_ray import plugins
from cosmic_ray.operators.operator import Operator

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["operators"]

_ALIKE = (
    {"Eq", "NotEq", "Lt", "LtE", "Gt", "GtE"},
    {"Is", "IsNot"},
    {"Add", "Sub", "Mul", "Div", "FloorDiv", "Mod", "Pow"},
    {"BitOr", "BitAnd", "BitXor", "LShift", "RShift"},
    {"UAdd", "USub"},
)
"""What is exchanged for what: `==` for `is`, say, changes nothing where numbers are small, and proves nothing."""
_ALONE = {
    "AddNot",
    "ReplaceTrueWithFalse",
    "ReplaceFalseWithTrue",
    "ReplaceAndWithOr",
    "ReplaceOrWithAnd",
    "ReplaceBreakWithContinue",
    "ReplaceContinueWithBreak",
    "NumberReplacer",
    "ZeroIterationForLoop",
    "ReplaceUnaryOperator_Delete_Not",
    "ReplaceUnaryOperator_Delete_USub",
    "ReplaceUnaryOperator_Delete_Invert",
}
_Operator: Any = Operator
"""Its annotations say that it returns nothing."""
_OPPOSITES = {"min": "max", "max": "min", "any": "all", "all": "any"}


class ReturnNone(_Operator):
    """Return nothing where something was returned."""

    def mutation_positions(self, node: Any) -> Iterator[tuple[Any, Any]]:
        if node.type == "return_stmt" and node.children[1].get_code().strip() != "None":
            yield node.children[1].start_pos, node.children[1].end_pos

    def mutate(self, node: Any, index: int) -> Any:  # noqa: ARG002, there is one way only
        node.children[1] = parso.parse(" None")
        return node

    @classmethod
    def examples(cls) -> tuple[()]:
        return ()


class SwapMembership(_Operator):
    """Ask whether something is not there instead of whether it is, and the other way round."""

    def mutation_positions(self, node: Any) -> Iterator[tuple[Any, Any]]:
        for at in self._found(node):
            yield node.children[at].start_pos, node.children[at].end_pos

    def mutate(self, node: Any, index: int) -> Any:
        at = self._found(node)[index]
        was = node.children[at].get_code().strip()
        node.children[at] = parso.parse(" not in" if was == "in" else " in")
        return node

    def _found(self, node: Any) -> list[int]:
        if node.type != "comparison":
            return []
        return [
            k for k, each in enumerate(node.children) if each.get_code().split() in (["in"], ["not", "in"])
        ]

    @classmethod
    def examples(cls) -> tuple[()]:
        return ()


class SwapOpposite(_Operator):
    """Call `max` instead of `min`, `all` instead of `any`, and the other way round."""

    def mutation_positions(self, node: Any) -> Iterator[tuple[Any, Any]]:
        if node.type == "atom_expr" and node.children[0].get_code().strip() in _OPPOSITES:
            yield node.children[0].start_pos, node.children[0].end_pos

    def mutate(self, node: Any, index: int) -> Any:  # noqa: ARG002, there is one way only
        name = node.children[0]
        name.value = _OPPOSITES[name.value]
        return node

    @classmethod
    def examples(cls) -> tuple[()]:
        return ()


class DropSliceBound(_Operator):
    """Leave out where a slice begins or ends."""

    def mutation_positions(self, node: Any) -> Iterator[tuple[Any, Any]]:
        for at in self._bounds(node):
            yield node.children[at].start_pos, node.children[at].end_pos

    def mutate(self, node: Any, index: int) -> Any:
        del node.children[self._bounds(node)[index]]
        return node

    def _bounds(self, node: Any) -> list[int]:
        if node.type != "subscript":
            return []
        return [k for k, each in enumerate(node.children) if each.type not in ("operator", "sliceop")]

    @classmethod
    def examples(cls) -> tuple[()]:
        return ()


_OWN = {each.__name__: each for each in (ReturnNone, SwapMembership, SwapOpposite, DropSliceBound)}


def operators() -> dict[str, Any]:
    """Return the operators by name, those of cosmic-ray first."""
    names = [name.partition("/")[2] for name in plugins.operator_names()]
    theirs: dict[str, Any] = {
        name: plugins.get_operator(f"core/{name}")() for name in names if _is_usual(name)
    }
    return theirs | {name: operator() for name, operator in _OWN.items()}


def _is_usual(name: str) -> bool:
    return name in _ALONE or any(set(name.split("_")[1:]) <= kinds for kinds in _ALIKE if "_" in name)
