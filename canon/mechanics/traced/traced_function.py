"""Traced functions: equations given as a function f(t, y) of Python, as SciPy takes them, read as formulas.

The function is called with symbols in place of numbers that know Python's operators and NumPy's functions, once for
every way it goes where it branches; what it returns are the formulas, so that Taylor's method, every precision and the
error estimates apply.
"""

from __future__ import annotations

import inspect
import math
import random
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import sympy as sp

from canon.expression.graph.piecewise_form import without_pieces
from canon.expression.symbols.symbol import time
from canon.expression.symbols.user_input import counted
from canon.mechanics.hamilton.vector_field import VectorField
from canon.mechanics.traced.complex_rates import real_and_imaginary
from canon.mechanics.traced.decisions import Decisions, along_all_ways
from canon.mechanics.traced.exchanged_names import with_exchanged_names
from canon.mechanics.traced.steps_of_time import with_single_steps
from canon.mechanics.traced.traced_array import TracedArray
from canon.mechanics.traced.traced_number import TracedNumber, expression

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.array import Array

__all__ = ["field_of_function", "read_at_start"]

_NEAR = 1e-9
"""In parts of their size: how far formulas may be from what the function returns at the start, for rounding."""

_CLOCKS = ("t", "time", "tau")
_READABLE = (
    "it is called with symbols, so that it may use arithmetic, if and what NumPy does to numbers and small matrices, "
    "but nothing that needs the numbers themselves; write such equations as canon.VectorField, with SymPy's Piecewise "
    "or canon.flow.sampled_function, or give the function to scipy.integrate.solve_ivp"
)
_ELSEWHERE = 2
"""Places beside the start at which formulas are compared with what the function returns."""

_ROUNDING = 1e-6
_INSIDE = 1e-9
"""Part of the span after which rates that step with the time are looked at first."""

_SMALL = 4000
"""Operations of formulas that are compared elsewhere too."""


def field_of_function(f: Callable[[Any, Any], Any], n: int) -> VectorField:
    """Return the equations ẏ = f(t, y) of a function as a vector field in ``y_0``, ``y_1``, …

    Parameters
    ----------
    f
        A function of the time and the state, an array of shape (n,), which returns the n rates.
    n
        The number of variables.

    Raises
    ------
    TypeError
        The function asks for the numbers themselves, as tables of many places do, or goes more ways than can be
        followed; or it takes other arguments, or the time last, or writes into its state.
    ValueError
        It returns another number of rates.

    Examples
    --------
    >>> import numpy
    >>> field_of_function(lambda t, y: [y[1], -4 * numpy.sin(y[0]) + numpy.cos(2 * t)], 2).components
    (y_1, -4*sin(y_0) + cos(2*t))
    >>> def with_dry_friction(t, y):
    ...     force = -0.5 if y[1] > 0 else 0.5
    ...     return [y[1], -y[0] + force]
    >>> field_of_function(with_dry_friction, 2).components[1]
    Piecewise((-y_0 - 1/2, y_1 > 0), (1/2 - y_0, True))
    """
    return _field(f, n, None)


def _field(f: Callable[[Any, Any], Any], n: int, span: tuple[float, float] | None) -> VectorField:
    _refuse_other_arguments(f)
    variables = sp.symbols(f"y_:{n}", real=True, seq=True)
    try:
        exchanged = with_exchanged_names(f)
        rates = along_all_ways(lambda decisions: _rates(exchanged, variables, decisions), span)
    except (TypeError, AttributeError, IndexError, np.linalg.LinAlgError) as failed:
        raise TypeError(f"the function f(t, y) can't be read as formulas ({failed}): {_READABLE}") from failed
    return VectorField(rates, variables)


def _rates(
    f: Callable[[Any, Any], Any], variables: Sequence[sp.Symbol], decisions: Decisions
) -> list[sp.Expr]:
    """Return what a function returns of symbols, going one way where it branches."""
    n = len(variables)
    state = np.empty(n, dtype=object)
    state[:] = given = [TracedNumber(s, decisions) for s in variables]
    returned = np.asarray(f(TracedNumber(time, decisions), state.view(TracedArray)), dtype=object)
    if any(a is not b for a, b in zip(state, given, strict=True)):
        raise TypeError("it writes into y, which belongs to whoever calls it: begin with y = y.copy()")
    if returned.size != n:
        raise ValueError(f"f(t, y) returns {counted(returned.size, 'rate')} for {counted(n, 'variable')}")
    if returned.ndim > 1 and returned.shape[-1] != n:
        raise ValueError(
            f"f(t, y) returns an array of shape {returned.shape}; give its numbers in a row, .ravel()"
        )
    rates = [expression(x) for x in returned.ravel()]
    parts = [real_and_imaginary(rate) for rate in rates]
    if any(sp.expand(im) != 0 for _, im in parts):
        raise TypeError("its rates are complex; give real and imaginary parts as variables of their own")
    return [re for re, _ in parts]


def read_at_start(f: Callable[[Any, Any], Any], span: tuple[float, float], y0: Any) -> VectorField:
    """Return the equations of a function, as many as the start has numbers, after a look at what it returns there.

    Raises
    ------
    TypeError, ValueError
        As :func:`field_of_function` does; or the start or what it returns there are no real numbers, or not what its
        formulas give.

    Examples
    --------
    >>> read_at_start(lambda t, y: -y, (0.0, 1.0), [1.0]).components
    (-y_0,)
    """
    if y0 is None or isinstance(y0, Mapping | str):
        raise ValueError("the start of a function f(t, y) is given as numbers in order: y0 = [1.0, 0.0]")
    numbers = _real_numbers(y0, "the start of a function f(t, y)")
    if not numbers.ndim:
        raise ValueError(
            f"y0 = {y0} is one number: give the start as a list, y0 = [{y0}], and f returns as many"
        )
    written = _field(f, len(numbers), span)
    field = _over(written, span)
    t0 = span[0] if field is written else span[0] + _INSIDE * (span[1] - span[0])  # not on a step
    start = numbers.reshape(len(numbers), -1)[:, 0]
    returned = _returned(f, t0, start)
    if not np.array_equal(returned, _returned(f, t0, start), equal_nan=True):
        raise TypeError(
            "f(t, y) returns other rates when it is called again with the same t and y: no equations do"
        )
    told = _told(field, t0, start)
    if not _agree(told, returned, _NEAR, _size(field, t0, start)):
        raise TypeError(
            f"at the start f(t, y) returns {returned.tolist()}, read as formulas {told}: {_READABLE}"
        )
    if sum(sp.count_ops(rate) for rate in field.components) <= _SMALL:
        _compare_elsewhere(f, field, span, start)
    return field


def _over(field: VectorField, span: tuple[float, float]) -> VectorField:
    """Return equations with what steps with the time written out over a span."""
    rates = [with_single_steps(rate, *span) for rate in field.components]
    return field if rates == list(field.components) else VectorField(rates, field.x)


def _compare_elsewhere(
    f: Callable[[Any, Any], Any], field: VectorField, span: tuple[float, float], start: Array
) -> None:
    """Refuse formulas that are not what a function returns at other places, as where it remembers its last call.

    The times lie within the span, beyond which what steps with the time is not written out.
    """
    chosen = random.Random(0)
    for _ in range(_ELSEWHERE):
        there = np.array([x * chosen.uniform(0.8, 1.2) + chosen.uniform(-0.1, 0.1) for x in start])
        t = chosen.uniform(*span)
        try:
            returned = _returned(f, t, there)
        except (ArithmeticError, ValueError, AssertionError):  # no place of its
            continue
        told = _told(field, t, there)
        if not _agree(told, returned, _ROUNDING) and np.isfinite(told).all() and np.isfinite(returned).all():
            raise TypeError(
                f"at t = {t:.3g}, y = {there.round(3).tolist()} f(t, y) returns {returned.tolist()}, read as formulas "
                f"{told}; does it remember earlier calls? {_READABLE}"
            )


def _returned(f: Callable[[Any, Any], Any], t: float, y: Array) -> Array:
    returned = np.ravel(_real_numbers(f(t, y.copy()), "what f(t, y) returns at the start"))
    returned[~np.isfinite(returned)] = math.nan  # no value there, which is told when the motion starts
    return returned


def _told(field: VectorField, t: float, y: Array) -> list[float]:
    return _values(field.components, _point(field, t, y))


def _size(field: VectorField, t: float, y: Array) -> float:
    """Return the largest term of the rates at a place, of which they may be small differences."""
    terms = [term for rate in field.components for term in sp.Add.make_args(rate)]
    return float(np.nanmax(np.abs(_values(terms, _point(field, t, y))), initial=0.0))


def _point(field: VectorField, t: float, y: Array) -> dict[sp.Symbol, sp.Expr]:
    return dict(zip((*field.x, time), map(sp.Float, (*y, t)), strict=True))


def _values(formulas: Sequence[sp.Expr], point: dict[sp.Symbol, sp.Expr]) -> list[float]:
    return [_value(formula, point) for formula in formulas]


def _agree(told: list[float], returned: Array, near: float, size: float = 0.0) -> bool:
    size = max(size, np.abs(returned[np.isfinite(returned)]).max(initial=0.0))
    return np.allclose(told, returned, rtol=near, atol=near * size, equal_nan=True)


def _refuse_other_arguments(f: Callable[..., Any]) -> None:
    """Refuse a function of other arguments than f(t, y), as far as it says which it takes."""
    try:
        taken = inspect.signature(f, follow_wrapped=False).parameters.values()
    except (TypeError, ValueError):  # a function of C says nothing
        return
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    names = [a.name for a in taken if a.kind in positional and a.default is inspect.Parameter.empty]
    if len(names) > 2:
        others = ", ".join(names[2:])
        raise TypeError(
            f"the function takes {', '.join(names)}, and f(t, y) is called: put values of {others} in, "
            f"lambda t, y: f(t, y, {others}), as args= does in SciPy"
        )
    if len(names) == 2 and names[1] in _CLOCKS and names[0] not in _CLOCKS:
        raise TypeError(
            f"f({names[0]}, {names[1]}) has the order of SciPy's odeint: here the time comes first, as in solve_ivp; "
            f"give lambda t, y: f(y, t)"
        )


def _real_numbers(given: Any, what: str) -> Array:
    if np.asarray(given).dtype.kind == "c":  # NumPy would drop the imaginary parts of an array
        raise TypeError(
            f"{what} is complex ({given!r}): give real and imaginary parts as variables of their own"
        )
    try:
        return np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError) as strange:
        raise TypeError(f"{what} should be real numbers, not {given!r}") from strange


def _value(formula: sp.Expr, point: dict[sp.Symbol, sp.Expr]) -> float:
    """Return the value of a formula, nan where that is no finite real number, as NumPy's functions have it."""
    numbers = cast("dict[sp.Basic, sp.Basic]", point)
    try:
        value = sp.N(cast("sp.Expr", formula.xreplace(numbers)))
    except TypeError:  # a piece that is not meant there compares what is not real
        value = sp.N(cast("sp.Expr", without_pieces(formula).xreplace(numbers)))
    return float(value) if value.is_real else math.nan
