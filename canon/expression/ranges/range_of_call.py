"""Ranges as programs write them: ``Integral(f, (x, 0, a))``, ``Integrate[f, {x, 0, a}]``, ``sum(f, i, 1, 3)``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from canon.expression.text.syntax import (
    Call,
    Comparison,
    Name,
    Negative,
    Node,
    Number,
    Power,
    Product,
    Sum,
    Tuple,
    parts,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

__all__ = [
    "INTEGRAL",
    "LIMITS_ARE_MISSING",
    "PRODUCT",
    "SUM",
    "Range",
    "bound_names",
    "name_with_index_inside",
    "ranges",
    "with_index",
    "without_bounds",
]

INTEGRAL, SUM, PRODUCT = "Integral", "Sum", "Product"
LIMITS_ARE_MISSING = "needs a lower and an upper limit here"


@dataclass(frozen=True, slots=True)
class Range:
    """A variable and its bounds."""

    variable: Name
    lower: Node
    upper: Node


def ranges(arguments: Sequence[Node]) -> tuple[Range, ...]:
    """Return the ranges behind what is integrated or summed, the outermost last; none where they are not complete."""
    match arguments:
        case (Name() as variable, lower, upper) if not isinstance(lower, Tuple):
            return (Range(variable, lower, upper),)
        case _:
            found = tuple(_of_tuples(arguments))
            return found if len(found) == len(arguments) else ()


def without_bounds(arguments: Sequence[Node]) -> Name | None:
    """Return the variable of an integral without limits, ``∫ f dx`` or ``Integral(f, x)``; None for any other."""
    match arguments:
        case (Name() as variable,) | (Tuple((Name() as variable,)),):
            return variable
        case _:
            return None


def _of_tuples(arguments: Sequence[Node]) -> Iterator[Range]:
    for argument in arguments:
        match argument:
            case Tuple((Name() as variable, lower, upper)):
                yield Range(variable, lower, upper)
            case _:
                return


def bound_names(node: Node) -> frozenset[str]:
    """Return the variables and indices of all integrals and sums in a tree."""
    calls = (
        part for part in parts(node) if isinstance(part, Call) and part.function in (INTEGRAL, SUM, PRODUCT)
    )
    return frozenset(one.variable.text for call in calls for one in ranges(call.arguments[1:]))


def with_index(node: Node, index: str, number: int, known: Callable[[str], bool]) -> Node:
    """Return a tree with a number for an index, also where it ends a name: ``m_i`` becomes ``m_1`` or ``m1``.

    Parameters
    ----------
    node
        The tree.
    index, number
        The index, and what stands for it.
    known
        Tells whether a name is declared.

    Examples
    --------
    >>> both = Product(((False, Name("i", 0, 1)), (False, Name("q_i", 1, 3))), 1)
    >>> with_index(both, "i", 2, known=lambda name: name == "q_2").factors
    ((False, Number(numerator=2, denominator=1, column=1)), (False, Name(text='q_2', primes=1, column=3)))
    """

    def inside(part: Node) -> Node:
        return with_index(part, index, number, known)

    def marked(parts: tuple[tuple[bool, Node], ...]) -> tuple[tuple[bool, Node], ...]:
        return tuple((mark, inside(part)) for mark, part in parts)

    match node:
        case Name(text, primes, column):
            if text == index and not primes:
                return Number(number, 1, column)
            stem, rate = _without_rate(text)
            bare = stem.removesuffix(f"_{index}")
            if bare == stem:
                return node
            spelled = f"{bare}{number}" if known(f"{bare}{number}") else f"{bare}_{number}"
            return Name(spelled + rate, primes, column)
        case Call():
            return replace(node, arguments=tuple(map(inside, node.arguments)))
        case Tuple():
            return replace(node, items=tuple(map(inside, node.items)))
        case Comparison():
            return replace(node, operands=tuple(map(inside, node.operands)))
        case Negative():
            return replace(node, operand=inside(node.operand))
        case Sum():
            return replace(node, terms=marked(node.terms))
        case Product():
            return replace(node, factors=marked(node.factors))
        case Power():
            return replace(node, base=inside(node.base), exponent=inside(node.exponent))
        case _:
            return node


def name_with_index_inside(node: Node, index: str) -> Name | None:
    """Return a name with two subscripts of which one may be the index, as ``m_ij``; None where there is none.

    Examples
    --------
    >>> name_with_index_inside(Name("m_ij", 0, 1), "i").text, name_with_index_inside(Name("p_phi", 0, 1), "i")
    ('m_ij', None)
    """
    for part in parts(node):
        if not isinstance(part, Name):
            continue
        subscripts = _without_rate(part.text)[0].split("_")[1:]
        if subscripts[-1:] == [index]:
            subscripts.pop()
        if any(index in one and len(one) < 3 and one not in _SHORT_GREEK for one in subscripts):
            return part
    return None


_SHORT_GREEK = ("mu", "nu", "xi", "pi")


def _without_rate(name: str) -> tuple[str, str]:
    """Return a name and the ending of its rate, nothing where it has none."""
    ending = next((ending for ending in ("_ddot", "_dot") if name.endswith(ending)), "")
    return name.removesuffix(ending), ending
