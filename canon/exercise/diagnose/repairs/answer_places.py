"""The answers of a claim, each under the key of its place such as ``Q[0]``: where a change is tried."""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.exercise.sheet.kind import Shape

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from sympy import Expr

    from canon.exercise.sheet.reading import Reading

__all__ = ["answers_of", "called"]


def answers_of(reading: Reading) -> Iterator[tuple[str, Expr]]:
    """Yield the expressions in which a change is tried, by keys such as ``Q[0]``."""
    for key in reading.kind.repaired:
        outer, _, inner = key.partition(".")
        if not reading.has(outer):
            continue
        value = reading.claim.keys[outer]
        match reading.kind.shapes[outer]:
            case Shape.BRACKETS:
                yield from _of_brackets(reading, key)
            case Shape.EXPRESSIONS:
                yield from ((f"{key}.{name}", item) for name, item in reading.table(key).items())
            case Shape.LISTS:
                items = reading.inside(key, value.get(inner, []))
                yield from ((f"{key}[{i}]", item) for i, item in enumerate(items))
            case Shape.TEXTS:
                items = (reading.equations if outer == "implicit" else reading.expressions)(outer)
                yield from ((f"{key}[{i}]", item) for i, item in enumerate(items))
            case _:
                yield key, reading.expression(key)


def called(key: str, keys: Collection[str]) -> str:
    """Return the place of an answer among those of a claim, the new variables as a person numbers them.

    Examples
    --------
    >>> called("P[0]", ["Q[0]", "P[0]"]), called("map.P[1]", ["map.P[0]", "map.P[1]"])
    ('P', 'P2')
    """
    outer, _, index = key.partition("[")
    letter, number = outer.rpartition(".")[2], index.removesuffix("]")
    if not number.isdigit() or outer == "implicit":
        return key
    alone = sum(other.partition("[")[0] == outer for other in keys) == 1
    return letter if alone else f"{letter}{int(number) + 1}"


def _of_brackets(reading: Reading, key: str) -> Iterator[tuple[str, Expr]]:
    for i, (f, g, value) in enumerate(reading.brackets("f", "g")):
        yield from zip((f"{key}[{i}].{name}" for name in ("value", "f", "g")), (value, f, g), strict=True)
