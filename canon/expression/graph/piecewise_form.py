"""Functions made of pieces, written with signs and moduli: Piecewise, Max, Min and Heaviside for the expression graph.

A condition a > b is the number χ = (1 + sign(a − b))/2, which is 1 where it holds and 0 where it does not. On a border
between two pieces, where χ = 1/2, the value is the mean of both. A root of what a condition says is positive, as
(−x)^(3/2) where x < 0, is taken of max(−x, 0), so that it has a value on the other side too.
"""

from __future__ import annotations

import functools
import itertools
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["without_pieces"]

_LONG = 60
"""Operations of a radicand that is compared with a condition."""

_INEQUALITIES = (sp.StrictGreaterThan, sp.GreaterThan, sp.StrictLessThan, sp.LessThan)
_MADE_OF_PIECES = (sp.Piecewise, sp.Max, sp.Min, sp.Heaviside)


@functools.lru_cache(maxsize=256)
def without_pieces(expression: Expr) -> Expr:
    """Return an expression with ``sign`` and ``Abs`` in place of Piecewise, Max, Min and Heaviside.

    Parameters
    ----------
    expression
        A real expression.

    Raises
    ------
    ValueError
        A Piecewise has no value somewhere, or a condition that is no inequality.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> without_pieces(sp.Max(x, 0) ** 2)
    (x/2 + Abs(x)/2)**2
    >>> without_pieces(sp.Piecewise((x**2, x > 1), (x, True)))
    x**2*(sign(x - 1)/2 + 1/2) + x*(1/2 - sign(x - 1)/2)
    """
    given: Any = expression
    if not given.has(*_MADE_OF_PIECES):
        return expression
    given = given.replace(_is_root_of_extreme, lambda e: _in_one_piece(e.base) ** e.exp)
    return given.replace(lambda e: isinstance(e, _MADE_OF_PIECES), _written)


def _is_root_of_extreme(e: Any) -> bool:
    return isinstance(e, sp.Pow) and isinstance(e.base, sp.Max | sp.Min) and e.exp.is_integer is False


def _in_one_piece(extreme: Any) -> Any:
    """Return max(x, y) as y + (x − y) χ, of which nothing but y is left where x < y: a root of 0 is 0 then."""
    side = 1 if isinstance(extreme, sp.Max) else -1
    arguments: Any = extreme.args
    last, *others = arguments  # numbers come first
    for other in others:
        last = last + (other - last) * _where(side * (other - last))
    return last


def _written(whole: Any) -> Any:
    if isinstance(whole, sp.Heaviside):
        return _where(whole.args[0])
    if isinstance(whole, sp.Piecewise):
        return _pieces(whole)
    side = 1 if isinstance(whole, sp.Max) else -1
    arguments: Any = whole.args
    first, *others = arguments
    for other in others:
        first = (first + other) / 2 + side * sp.Abs(first - other) / 2
    return first


def _pieces(whole: Any) -> Any:
    conditions = [condition for _, condition in whole.args]
    if sp.Or(*conditions) != sp.true:
        raise ValueError(
            f"{_short(whole)} has no value where none of its conditions holds: say what it is there, "
            "Piecewise(…, (value, True))"
        )
    *others, value = _values(whole)
    for group in reversed(_apart(list(zip(others, conditions[:-1], strict=True)))):
        numbers = [_number(condition, whole) for _, condition in group]
        held = sp.Add(*(each * number for (each, _), number in zip(group, numbers, strict=True)))
        value = held + value * (1 - sp.Add(*numbers))
    return value


def _apart(pieces: list[tuple[Any, Any]]) -> list[list[tuple[Any, Any]]]:
    """Return pieces in groups of which no two hold at once, so that on a border between two they are all there is."""
    groups: list[list[tuple[Any, Any]]] = []
    for piece in pieces:
        if groups and all(_exclude(piece[1], other) for _, other in groups[-1]):
            groups[-1].append(piece)
        else:
            groups.append([piece])
    return groups


def _exclude(one: Any, other: Any) -> bool:
    """Tell whether of two conditions, as far as they are seen to, one says a ≥ b where the other says a < b."""
    ways = itertools.product(_parts(one, sp.Or), _parts(other, sp.Or))
    return all(any(a + b == 0 for a in _gaps(way) for b in _gaps(another)) for way, another in ways)


def _gaps(condition: Any) -> list[Any]:
    """Return what is positive where a condition holds."""
    relations: list[Any] = [each for each in _parts(condition, sp.And) if isinstance(each, _INEQUALITIES)]
    return [each.gts - each.lts for each in relations]


def _values(whole: Any) -> Iterator[Any]:
    """Yield the values of the pieces with what is known of each: its conditions, and that none before it holds."""
    before: list[Any] = []
    for value, condition in whole.args:
        yield functools.reduce(_with_values_elsewhere, (*before, *_parts(condition, sp.And)), value)
        before += map(sp.Not, _parts(condition, sp.Or))


def _parts(condition: Any, kind: type[sp.And | sp.Or]) -> tuple[Any, ...]:
    return condition.args if isinstance(condition, kind) else (condition,)


def _with_values_elsewhere(value: Any, condition: Any) -> Any:
    """Return a piece in which roots of what is positive where its condition holds are zero where it does not."""
    if not isinstance(condition, _INEQUALITIES):
        return value
    greater: Any = condition.gts
    gap = greater - condition.lts
    roots = [p for p in value.atoms(sp.Pow) if p.exp.is_positive and p.exp.is_integer is False]
    by = {p: (p.base * _where(p.base)) ** p.exp for p in roots if _rises_with(p.base, gap)}
    return value.xreplace(by)


def _rises_with(base: Any, gap: Any) -> bool:
    """Tell whether something is a positive multiple of another."""
    if base.is_nonnegative or sp.count_ops(base) + sp.count_ops(gap) > _LONG:
        return False
    ratio: Any = sp.cancel(base / gap)
    return bool(ratio.is_number and ratio.is_positive)


def _number(condition: Any, whole: Any) -> Any:
    """Return χ of a condition."""
    if isinstance(condition, _INEQUALITIES):
        greater: Any = condition.gts
        return _where(greater - condition.lts)
    if isinstance(condition, sp.Eq | sp.Ne):  # which is no stretch of any motion
        return sp.Integer(1 if isinstance(condition, sp.Ne) else 0)
    if isinstance(condition, sp.Not):
        return 1 - _number(condition.args[0], whole)
    if isinstance(condition, sp.And):
        return sp.Mul(*(_number(each, whole) for each in condition.args))
    if isinstance(condition, sp.Or):
        return 1 - sp.Mul(*(1 - _number(each, whole) for each in condition.args))
    raise ValueError(
        f"the condition {condition} in {_short(whole)} is no inequality: write it with <, >, & and |"
    )


def _where(positive: Any) -> Any:
    return (1 + sp.sign(positive)) / 2


def _short(whole: Any) -> str:
    shown = str(whole)
    return shown if len(shown) < 60 else f"{shown[:57]}…"
