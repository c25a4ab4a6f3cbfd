"""Traced arrays: arrays of formulas, which NumPy's functions of arrays know."""

from __future__ import annotations

from functools import reduce
from inspect import signature
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import sympy as sp

from canon.mechanics.traced.traced_number import (
    OF_NUMBERS,
    TracedCondition,
    TracedNumber,
    choice,
    expression,
    is_traced,
)
from canon.proof.refute.largest_minor import determinant

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from sympy import Expr

__all__ = ["TracedArray", "by_function", "by_ufunc", "interpolated", "piecewise_polynomial", "solved"]

MOST_EQUATIONS, MOST_OPERATIONS = 8, 10_000
"""Linear equations that are solved as formulas, and operations in these; larger ones are of no use."""

MOST_PIECES = 60

_ORDINARY = {"initial": signature(np.max).parameters["initial"].default, "where": True}
"""What NumPy's own functions hand on where nothing else is asked."""

_OF_MATRICES = ("matmul", "vecdot", "matvec", "vecmat")


class TracedArray(np.ndarray[Any, Any]):
    """An array of objects, formulas among them."""

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **how: Any) -> Any:
        return by_ufunc(ufunc, method, inputs, how)

    def __array_function__(self, function: Any, _: Any, args: Any, how: Any) -> Any:
        return by_function(function, args, how)

    def __getitem__(self, key: Any) -> Any:
        return super().__getitem__(_with_truths(key))

    def __setitem__(self, key: Any, value: Any) -> None:
        super().__setitem__(_with_truths(key), value)

    def astype(self, *_: Any, **__: Any) -> Any:
        """Return itself: what moves has no type of numbers."""
        return self.copy()

    @property
    def real(self) -> Any:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The real parts."""
        return _each(lambda x: x.real, 1)(self)

    @property
    def imag(self) -> Any:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The imaginary parts."""
        return _each(lambda x: x.imag, 1)(self)


def _with_truths(key: Any) -> Any:
    """Return an index in which conditions are decided, as ``x[x < 0] = 0`` needs it."""
    if isinstance(key, tuple):
        return tuple(map(_with_truths, cast("tuple[Any, ...]", key)))
    if isinstance(key, np.ndarray) and key.dtype == object:
        return np.array([bool(c) for c in key.flat]).reshape(key.shape)
    return key


def _each(function: Callable[..., Any], n: int) -> Callable[..., Any]:
    acting = np.frompyfunc(function, n, 1)
    return lambda *arrays: _shown(acting(*map(_plain, arrays)))


def _plain(x: Any) -> Any:
    """Return what holds formulas as NumPy's own array of objects; a list of them too."""
    if isinstance(x, TracedArray):
        return x.view(np.ndarray)
    if isinstance(x, TracedNumber | TracedCondition):
        alone = np.empty((), dtype=object)
        alone[()] = x
        return alone
    return np.asarray(x, dtype=object) if isinstance(x, list | tuple) and is_traced(x) else x


def _shown(x: Any) -> Any:
    if isinstance(x, tuple):
        return tuple(map(_shown, cast("tuple[Any, ...]", x)))
    if isinstance(x, np.ndarray) and x.dtype == object:
        return x.view(TracedArray) if x.ndim else x.item()
    return x


def by_ufunc(ufunc: Any, method: str, inputs: Sequence[Any], how: Mapping[str, Any]) -> Any:
    """Apply one of NumPy's functions of numbers to arrays and numbers of which some are formulas.

    Raises
    ------
    TypeError
        It has no formula.
    """
    name = ufunc.__name__
    of_objects = name in _OF_MATRICES or set("".join(ufunc.types)) <= set("O->")  # from Python
    if name not in OF_NUMBERS and not of_objects:
        raise TypeError(f"{name} of something that moves")
    if method == "at":
        return _at_places(ufunc, *inputs)
    acting = ufunc if of_objects else np.frompyfunc(OF_NUMBERS[name], ufunc.nin, 1)
    arrays = [
        np.asarray(_plain(x), dtype=object) for x in inputs[: None if method in ("__call__", "outer") else 1]
    ]
    if any(how.get(key, ordinary) is not ordinary for key, ordinary in _ORDINARY.items()):
        raise TypeError(f"{name} with initial= or where= of something that moves")
    kept = {key: value for key, value in how.items() if key in ("axis", "keepdims")}
    found = getattr(acting, method)(*arrays, **kept)
    if how.get("out"):
        (out,) = how["out"]
        out[...] = found
        return out
    return _shown(found)


def _at_places(ufunc: Any, array: Any, places: Any, *values: Any) -> None:
    """Apply a function to some elements of an array, as often as each is named."""
    shape = np.shape(_plain(array)[places])
    operands = [np.broadcast_to(np.asarray(_plain(v), dtype=object), shape) for v in values]
    for k, place in enumerate(places):
        array[place] = by_ufunc(ufunc, "__call__", (array[place], *(v[k] for v in operands)), {})


def by_function(function: Any, args: Sequence[Any], how: Mapping[str, Any]) -> Any:
    """Apply one of NumPy's functions of arrays to arguments of which some are formulas."""
    own = _OF_ARRAYS.get(function)
    if own is not None:
        return own(*args, **how)
    plain = tuple(_lifted(x) for x in args)
    keys = {key: _lifted(x) for key, x in how.items() if key != "dtype"}
    holder = np.empty(0, dtype=object)
    return _shown(np.ndarray.__array_function__(holder, function, (), plain, keys))


def _lifted(x: Any) -> Any:
    """Return a number that is a formula as an array that NumPy's functions take."""
    return _plain(x).view(TracedArray) if isinstance(x, TracedNumber | TracedCondition) else x


# -- functions of arrays -------------------------------------------------------------------------------


def _where(condition: Any, *both: Any) -> Any:
    if not both:
        raise TypeError("numpy.where with one argument asks where something that moves is true")
    return _each(choice, 3)(condition, *both)


def _clip(x: Any, low: Any = None, high: Any = None, **_: Any) -> Any:
    for name, bound in (("maximum", low), ("minimum", high)):
        x = x if bound is None else _each(OF_NUMBERS[name], 2)(x, bound)
    return x


def _select(conditions: Sequence[Any], choices: Sequence[Any], default: Any = 0) -> Any:
    found = default
    for condition, value in reversed(list(zip(conditions, choices, strict=True))):
        found = _where(condition, value, found)
    return found


def _pieces(x: Any, conditions: Any, functions: Sequence[Any], *args: Any, **how: Any) -> Any:
    conditions = list(conditions) if isinstance(conditions, list | tuple | np.ndarray) else [conditions]
    values = [f(x, *args, **how) if callable(f) else f for f in functions]
    default = values.pop() if len(values) > len(conditions) else 0
    for condition, value in zip(conditions, values, strict=True):  # the last that holds is the one
        default = _where(condition, value, default)
    return default


def interpolated(
    x: Any, places: Any, values: Any, left: Any = None, right: Any = None, period: Any = None
) -> Any:
    """Return values between those of a table, as ``numpy.interp`` does.

    Raises
    ------
    TypeError
        The table is long, or is repeated.
    """
    if period is not None or len(places) > MOST_PIECES:
        raise TypeError(f"numpy.interp of a table that is repeated or has more than {MOST_PIECES} places")
    places, values = list(map(expression, places)), list(map(expression, values))
    slopes = [(b - a) / (q - p) for p, q, a, b in zip(places, places[1:], values, values[1:], strict=False)]

    def at(number: Any) -> Any:
        u = expression(number)
        pieces = [(values[0] if left is None else expression(left), u < places[0])]
        pieces += [
            (a + s * (u - p), u <= q) for p, q, a, s in zip(places, places[1:], values, slopes, strict=False)
        ]
        last = (values[-1] if right is None else expression(right), sp.true)
        return TracedNumber(sp.Piecewise(*pieces, last), getattr(number, "decisions", None))

    return _each(at, 1)(x)


def piecewise_polynomial(places: Any, coefficients: Any) -> Callable[..., Any]:
    """Return a spline as SciPy keeps it, highest powers first, as a function of what may be a formula.

    Raises
    ------
    TypeError
        It has many pieces.
    """
    if len(places) - 1 > MOST_PIECES:
        raise TypeError(f"a spline of more than {MOST_PIECES} pieces")

    def at(number: Any) -> Any:
        u = expression(number)
        pieces: list[Any] = []
        for k in range(len(places) - 1):
            v = u - expression(places[k])
            value = reduce(lambda total, c, v=v: total * v + expression(c), coefficients[:, k], sp.S.Zero)
            pieces.append((value, u < expression(places[k + 1]) if k < len(places) - 2 else sp.true))
        return TracedNumber(sp.Piecewise(*pieces), getattr(number, "decisions", None))

    return lambda x, *_, **__: _each(at, 1)(x)


def solved(matrix: Any, right: Any) -> Any:
    """Solve linear equations by elimination, the first pivot that is not the number zero being taken.

    Raises
    ------
    TypeError
        There are many of them.
    numpy.linalg.LinAlgError
        A pivot is zero.
    """
    a, b = np.asarray(_plain(matrix)), np.asarray(_plain(right))
    if not is_traced(a):
        numbers = a.astype(float)
        return (
            _shown(np.linalg.inv(numbers).astype(object) @ b) if is_traced(b) else np.linalg.solve(numbers, b)
        )
    n = len(a)
    if n > MOST_EQUATIONS:
        raise TypeError(
            f"it solves {n} linear equations; give the Lagrangian instead, of which the equations are derived"
        )
    columns = b.reshape(n, -1)
    rows = _eliminated([[expression(x) for x in (*a[i], *columns[i])] for i in range(n)])
    decisions = next((x.decisions for x in (*a.flat, *b.flat) if isinstance(x, TracedNumber)), None)
    found = np.empty(columns.shape, dtype=object)
    for i, row in enumerate(rows):
        found[i] = [TracedNumber(x, decisions) for x in row[n:]]
    return found.reshape(b.shape).view(TracedArray)


def _eliminated(rows: list[list[Expr]]) -> list[list[Expr]]:
    """Return rows of formulas of which the left part has become that of the unit matrix."""
    for k in range(len(rows)):
        best = _pivot(rows, k)
        rows[k], rows[best] = rows[best], rows[k]
        rows[k] = [x / rows[k][k] for x in rows[k]]
        if sum(sp.count_ops(x) for row in rows for x in row) > MOST_OPERATIONS:
            raise TypeError(f"formulas for the solution of {len(rows)} linear equations are very long")
        rows = [row if i == k else _without(row, rows[k], k) for i, row in enumerate(rows)]
    return rows


def _pivot(rows: list[list[Expr]], k: int) -> int:
    pivots = [i for i in range(k, len(rows)) if rows[i][k] != 0]
    if not pivots:
        raise np.linalg.LinAlgError("Singular matrix")
    return next((i for i in pivots if rows[i][k].is_number), pivots[0])


def _without(row: list[Expr], pivotal: list[Expr], k: int) -> list[Expr]:
    return row if row[k] == 0 else [x - row[k] * y for x, y in zip(row, pivotal, strict=True)]


def _inverse(matrix: Any) -> Any:
    return solved(matrix, np.eye(len(matrix)))


def _determinant(matrix: Any) -> Any:
    rows = np.asarray(_plain(matrix), dtype=object)
    if len(rows) > MOST_EQUATIONS // 2:
        raise TypeError(f"the determinant of {len(rows)} rows of something that moves")
    decisions = next((x.decisions for x in rows.flat if isinstance(x, TracedNumber)), None)
    return TracedNumber(determinant([list(map(expression, row)) for row in rows]), decisions)


def _along_axis(function: Callable[..., Any], axis: int, array: Any, *args: Any, **how: Any) -> Any:
    rows = np.moveaxis(np.asarray(_plain(array), dtype=object), axis, -1)
    found = [function(row.view(TracedArray), *args, **how) for row in rows.reshape(-1, rows.shape[-1])]
    whole = np.array(found, dtype=object)
    whole = whole.reshape(*rows.shape[:-1], *whole.shape[1:])
    return _shown(whole if whole.ndim < rows.ndim else np.moveaxis(whole, -1, axis))


def _norm(x: Any, ord: Any = None, axis: Any = None, keepdims: bool = False) -> Any:  # noqa: A002
    if ord not in (None, 2, "fro") or (ord == 2 and axis is None and np.ndim(x) != 1):
        raise TypeError(f"a norm of order {ord} of something that moves")
    squares = _each(lambda u: OF_NUMBERS["absolute"](u) ** 2, 1)(np.asarray(_plain(x), dtype=object))
    total = np.sum(np.asarray(_plain(squares)), axis=axis, keepdims=keepdims)
    return _each(OF_NUMBERS["sqrt"], 1)(total)


def _filled(x: Any, value: Any) -> Any:
    found = np.empty(np.shape(_plain(x)), dtype=object)
    found[...] = value
    return found.view(TracedArray)


def _sinc(x: Any) -> Any:
    return _each(lambda u: choice(u == 0, 1, OF_NUMBERS["sin"](u * np.pi) / (u * np.pi)), 1)(x)


_OF_ARRAYS: dict[Any, Callable[..., Any]] = {
    np.where: _where, np.clip: _clip, np.select: _select, np.piecewise: _pieces, np.interp: interpolated,
    np.linalg.solve: solved, np.linalg.inv: _inverse, np.linalg.norm: _norm, np.sinc: _sinc,
    np.linalg.det: _determinant, np.apply_along_axis: _along_axis,
    np.nan_to_num: lambda x, *_, **__: x, np.isreal: lambda x: _filled(x, value=True),
    np.zeros_like: lambda x, *_, **__: _filled(x, 0), np.empty_like: lambda x, *_, **__: _filled(x, 0),
    np.ones_like: lambda x, *_, **__: _filled(x, 1), np.full_like: lambda x, value, *_, **__: _filled(x, value),
    np.real: lambda z: z.real, np.imag: lambda z: z.imag,
    np.angle: lambda z: _each(OF_NUMBERS["arctan2"], 2)(z.imag, z.real),
}  # fmt: skip
"""NumPy's functions of arrays that have a way of their own with formulas."""


def _ufunc_of_numbers(_: Any, ufunc: Any, method: str, *inputs: Any, **how: Any) -> Any:
    return by_ufunc(ufunc, method, inputs, how)


def _function_of_numbers(_: Any, function: Any, __: Any, args: Any, how: Any) -> Any:
    return by_function(function, args, how)


for _type in (TracedNumber, TracedCondition):  # NumPy asks single numbers too
    for _name, _protocol in (("ufunc", _ufunc_of_numbers), ("function", _function_of_numbers)):
        setattr(_type, f"__array_{_name}__", _protocol)
