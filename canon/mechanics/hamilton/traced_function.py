"""Traced functions: equations given as a function f(t, y) of Python, as SciPy takes them, read as formulas.

The function is called once, with symbols in place of numbers that know NumPy's functions; what it returns are the
formulas, so that Taylor's method, every precision and the error estimates apply.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import sympy as sp

from canon.expression.symbols.symbol import time
from canon.expression.symbols.user_input import counted
from canon.mechanics.hamilton.vector_field import VectorField

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.array import Array

__all__ = ["field_of_function", "is_rates_function", "read_at_start"]

_NEAR = 1e-9
"""In parts of their size: how far formulas may be from what the function returns at the start, for rounding."""

_CLOCKS = ("t", "time", "tau")
_READABLE = (
    "it is called once with symbols, so that arithmetic and NumPy's functions of numbers are what it may use, and "
    "numpy.zeros_like(y) for its rates, no math.sin, no if, no table, no numpy.linalg.solve; write such equations as "
    "canon.VectorField, with SymPy's Piecewise or canon.flow.sampled_function, or give the function to "
    "scipy.integrate.solve_ivp"
)


def is_rates_function(system: Any) -> bool:
    """Tell whether a system is a function f(t, y) and no value that canon knows."""
    own = type(system).__module__.partition(".")[0] in (
        "canon",
        "sympy",
        "heyoka",
    )  # a vector field can be called
    return callable(system) and not own and not isinstance(system, type) and not hasattr(system, "H")


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
        The function asks for numbers: it branches by them, or calls what is none of NumPy's functions; or it takes
        other arguments, or the time last.
    ValueError
        It returns another number of rates.

    Examples
    --------
    >>> import numpy
    >>> field_of_function(lambda t, y: [y[1], -4 * numpy.sin(y[0]) + numpy.cos(2 * t)], 2).components
    (y_1, -4*sin(y_0) + cos(2*t))
    """
    _refuse_other_arguments(f)
    variables = sp.symbols(f"y_:{n}", real=True, seq=True)
    state = np.empty(n, dtype=object)
    state[:] = [_Traced(s) for s in variables]
    try:
        rates: list[Any] = [
            _expression(x) for x in np.ravel(np.asarray(f(_Traced(time), state), dtype=object))
        ]
    except (TypeError, AttributeError) as failed:
        raise TypeError(f"the function f(t, y) can't be read as formulas ({failed}): {_READABLE}") from failed
    if len(rates) != n:
        raise ValueError(f"f(t, y) returns {counted(len(rates), 'rate')} for {counted(n, 'variable')}")
    return VectorField(rates, variables)


def read_at_start(f: Callable[[Any, Any], Any], t0: float, y0: Any) -> VectorField:
    """Return the equations of a function, as many as the start has numbers, after a look at what it returns there.

    Raises
    ------
    TypeError, ValueError
        As :func:`field_of_function` does; or the start or what it returns there are no real numbers, or not what its
        formulas give.

    Examples
    --------
    >>> read_at_start(lambda t, y: -y, 0.0, [1.0]).components
    (-y_0,)
    """
    if y0 is None or isinstance(y0, Mapping | str):
        raise ValueError("the start of a function f(t, y) is given as numbers in order: y0 = [1.0, 0.0]")
    numbers = _real_numbers(y0, "the start of a function f(t, y)")
    if not numbers.ndim:
        raise ValueError(
            f"y0 = {y0} is one number: give the start as a list, y0 = [{y0}], and f returns as many"
        )
    field = field_of_function(f, len(numbers))
    start = numbers.reshape(len(numbers), -1)[:, 0]
    returned = np.ravel(_real_numbers(f(t0, start.copy()), "what f(t, y) returns at the start"))
    point = dict(zip((*field.x, time), map(sp.Float, (*start, t0)), strict=True))
    told = [_value(cast("sp.Expr", rate.xreplace(point))) for rate in field.components]
    returned[~np.isfinite(returned)] = math.nan  # no value there, which is told when the motion starts
    size = np.abs(returned).max(initial=0.0)
    if not np.allclose(told, returned, rtol=_NEAR, atol=_NEAR * size, equal_nan=True):
        raise TypeError(
            f"at the start f(t, y) returns {returned.tolist()}, read as formulas {told}: {_READABLE}"
        )
    return field


def _refuse_other_arguments(f: Callable[..., Any]) -> None:
    """Refuse a function of other arguments than f(t, y), as far as it says which it takes."""
    try:
        taken = inspect.signature(f).parameters.values()
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


def _value(formula: sp.Expr) -> float:
    """Return the value of a formula, nan where that is no finite real number, as NumPy's functions have it."""
    value = sp.N(formula)
    return float(value) if value.is_real else math.nan


class _Traced:
    """A formula in place of a number: arithmetic and NumPy's functions make longer ones."""

    __slots__ = ("formula",)
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, formula: sp.Expr) -> None:
        self.formula = formula

    def __add__(self, other: Any) -> Any:
        return _made(lambda a, b: a + b, self, other)

    def __mul__(self, other: Any) -> Any:
        return _made(lambda a, b: a * b, self, other)

    def __sub__(self, other: Any) -> Any:
        return _made(lambda a, b: a - b, self, other)

    def __rsub__(self, other: Any) -> Any:
        return _made(lambda a, b: b - a, self, other)

    def __truediv__(self, other: Any) -> Any:
        return _made(lambda a, b: a / b, self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return _made(lambda a, b: b / a, self, other)

    def __pow__(self, other: Any) -> Any:
        return _made(lambda a, b: a**b, self, other)

    def __rpow__(self, other: Any) -> Any:
        return _made(lambda a, b: b**a, self, other)

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self) -> _Traced:
        return _Traced(-self.formula)

    def __pos__(self) -> _Traced:
        return self

    def __abs__(self) -> _Traced:
        return _Traced(sp.Abs(self.formula))

    def arctan2(self, x: Any) -> Any:
        return _made(sp.atan2, self, x)

    def hypot(self, other: Any) -> Any:
        return _made(lambda a, b: sp.sqrt(a**2 + b**2), self, other)

    def _asked(self, *_: Any) -> Any:
        raise TypeError("it asks for the number or the sign of something that moves")

    __bool__ = __float__ = __int__ = __index__ = __lt__ = __le__ = __gt__ = __ge__ = __eq__ = __ne__ = _asked


_OF_NUMPY: dict[str, Callable[[Any], Any]] = {
    "sin": sp.sin, "cos": sp.cos, "tan": sp.tan, "arcsin": sp.asin, "arccos": sp.acos, "arctan": sp.atan,
    "sinh": sp.sinh, "cosh": sp.cosh, "tanh": sp.tanh, "arcsinh": sp.asinh, "arccosh": sp.acosh,
    "arctanh": sp.atanh, "exp": sp.exp, "log": sp.log, "sqrt": sp.sqrt, "fabs": sp.Abs,
    "exp2": lambda x: 2**x, "expm1": lambda x: sp.exp(x) - 1, "log1p": lambda x: sp.log(1 + x),
    "log2": lambda x: sp.log(x) / sp.log(2), "log10": lambda x: sp.log(x) / sp.log(10),
    "cbrt": lambda x: sp.sign(x) * sp.Abs(x) ** sp.Rational(1, 3), "conjugate": lambda x: x,
    "deg2rad": lambda x: x * sp.pi / 180, "radians": lambda x: x * sp.pi / 180,
}  # fmt: skip
"""What NumPy's functions of one number call on objects, by their names."""


def _method(function: Callable[[Any], Any]) -> Callable[[_Traced], _Traced]:
    return lambda traced: _Traced(function(traced.formula))


for _name, _function in _OF_NUMPY.items():
    setattr(_Traced, _name, _method(_function))


def _made(operation: Callable[[Any, Any], Any], a: _Traced, b: Any) -> Any:
    if isinstance(b, np.ndarray):
        return NotImplemented  # NumPy goes through its elements
    return _Traced(operation(a.formula, _expression(b)))


def _expression(x: Any) -> sp.Expr:
    """Return a formula, or a number as the exact fraction that it is."""
    if isinstance(x, _Traced):
        return x.formula
    if isinstance(x, sp.Expr):
        return x
    if isinstance(x, int | float | np.integer | np.floating | Fraction) and np.isfinite(float(x)):
        return sp.Rational(Fraction(x if isinstance(x, int | Fraction) else float(x)))
    raise TypeError(f"{x!r} is no formula and no finite number")
