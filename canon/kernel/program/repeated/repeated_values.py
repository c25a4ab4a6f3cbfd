"""Values and rates of sums over rows: the term is evaluated once, on arrays that hold the arguments of all rows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    import numpy.typing as npt
    from sympy import Symbol

    from canon.expression.graph.number_systems import Arithmetic
    from canon.kernel.program.repeated.repeated_terms import RepeatedTerms

    _Numbers = npt.NDArray[Any]

__all__ = ["rates_of_sums", "size_of_sums", "value_of_sums"]

_AT_ONCE = 1 << 20
"""Numbers that an array holds, at most, where rows can be taken in several parts."""


def value_of_sums(
    sums: Sequence[RepeatedTerms], t: Symbol, state: _Numbers, time: Any, arithmetic: Arithmetic
) -> _Numbers:
    """Return the value of the sums at states of shape (2n, …), shape (…).

    Parameters
    ----------
    sums
        The sums.
    t
        The symbol of the time.
    state, time
        Where they are wanted; the time is a number, or an array that fits the states'.
    arithmetic
        Of the numbers that the state consists of.
    """
    total = np.zeros(state.shape[1:], dtype=state.dtype)
    for each in sums:
        for _, values in _parts(each, t, state, time, arithmetic):
            total = total + values.sum(axis=0)
    return total


def size_of_sums(
    sums: Sequence[RepeatedTerms], t: Symbol, state: _Numbers, time: Any, arithmetic: Arithmetic
) -> _Numbers:
    """Return the sum of the terms' absolute values, as :func:`value_of_sums` does that of the terms."""
    total = np.zeros(state.shape[1:], dtype=state.dtype)
    for each in sums:
        for _, values in _parts(each, t, state, time, arithmetic):
            total = total + np.abs(values).sum(axis=0)
    return total


def rates_of_sums(
    sums: Sequence[RepeatedTerms], t: Symbol, state: _Numbers, time: Any, arithmetic: Arithmetic
) -> _Numbers:
    """Return (∂H/∂p, −∂H/∂q) of H, the value of the sums, at states of shape (2n, …), in the same shape."""
    slopes = np.zeros_like(state)
    for each in sums:
        apart = all(len(set(each.columns[k])) == each.count for k in each.moving)
        for places, values in _parts(each, t, state, time, arithmetic, slopes=True):
            if not apart:
                np.add.at(slopes, places, values)
            elif places.strides == (0,):  # the first of all these pairs
                slopes[places[0]] += values.sum(axis=0)
            else:
                slopes[places] += values
    n = len(state) // 2
    return np.concatenate([slopes[n:], -slopes[:n]])


def _parts(
    sums: RepeatedTerms,
    t: Symbol,
    state: _Numbers,
    time: Any,
    arithmetic: Arithmetic,
    *,
    slopes: bool = False,
) -> Iterator[tuple[_Numbers, _Numbers]]:
    """Yield values of the term at some rows, or its slopes and the places in the state that they belong to."""
    nodes = sums.slopes if slopes else (sums.node,)
    for places, arguments in _taken(sums, state, arithmetic):
        known = {t: time, **dict(zip(sums.slots, arguments, strict=True))}
        shape = (len(arguments[0]) if arguments else 1, *state.shape[1:])
        found = sums.graph.evaluate(nodes, known, arithmetic)
        wide = [np.broadcast_to(np.asarray(value, dtype=state.dtype), shape) for value in found]
        if slopes:
            yield from zip(places, wide, strict=True)
        else:
            yield np.empty(0), wide[0]


def _taken(
    sums: RepeatedTerms, state: _Numbers, arithmetic: Arithmetic
) -> Iterator[tuple[list[_Numbers], list[_Numbers]]]:
    """Yield the places of a term's arguments that are variables, and all its arguments, for some rows after others."""
    if not sums.columns:
        yield [], []
        return
    if not sums.pairs:
        rows = max(1, _AT_ONCE // max(1, state[0].size))
        for start in range(0, sums.count, rows):
            part = slice(start, start + rows)
            yield _places(sums, part), _arguments(sums, state, part, arithmetic)
        return
    whole = _arguments(sums, state, slice(None), arithmetic)
    for i in range(sums.count - 1):
        first, second = _places(sums, slice(i, i + 1)), _places(sums, slice(i + 1, None))
        against = [column[i + 1 :] for column in whole]
        alone = [np.broadcast_to(column[i], b.shape) for column, b in zip(whole, against, strict=True)]
        yield (
            [*(np.broadcast_to(place, b.shape) for place, b in zip(first, second, strict=True)), *second],
            [*alone, *against],
        )


def _places(sums: RepeatedTerms, rows: slice) -> list[_Numbers]:
    return [np.asarray(sums.columns[k])[rows] for k in sums.moving]


def _arguments(sums: RepeatedTerms, state: _Numbers, rows: slice, arithmetic: Arithmetic) -> list[_Numbers]:
    found: list[_Numbers] = []
    for k, column in enumerate(sums.columns):
        if k in sums.moving:
            found.append(state[np.asarray(column)[rows]])
        else:
            numbers = np.array([arithmetic.number(x) for x in column[rows]], dtype=state.dtype)
            found.append(numbers.reshape(-1, *(1,) * (state.ndim - 1)))
    return found
