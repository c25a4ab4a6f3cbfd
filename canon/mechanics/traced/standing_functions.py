"""Standing functions: what takes formulas in place of the functions of NumPy, ``math``, ``cmath`` and Python."""

from __future__ import annotations

import builtins
import cmath
import functools
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.mechanics.traced.traced_array import TracedArray, by_function, solved
from canon.mechanics.traced.traced_number import OF_NUMBERS, is_traced

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["OF_PYTHON", "stands_for"]


def stands_for(x: Any) -> Any:
    """Return what stands for NumPy, Python's ``math`` and their functions; None for anything else.

    Examples
    --------
    >>> stands_for(math).pi == math.pi, stands_for(print)
    (True, None)
    """
    if x is np:
        return _NUMPY
    if x is np.linalg:
        return _LINEAR
    if x is math:
        return _MATH
    if x is cmath:
        return _CMATH
    if getattr(x, "__name__", None) == "scipy.linalg":
        return _Module(x, _OF_MATRICES)
    try:
        return _STANDING_IN.get(x)
    except TypeError:  # what has no hash
        return None


# -- NumPy ---------------------------------------------------------------------------------------------


class _Module:
    """A module of which some functions are exchanged."""

    def __init__(self, module: Any, own: dict[str, Any]) -> None:
        self._module = module
        self._own = own

    def __getattr__(self, name: str) -> Any:
        return self._own[name] if name in self._own else getattr(self._module, name)


def _room(value: Any) -> Callable[..., Any]:
    """Return a maker of arrays that have room for formulas."""

    def made(shape: Any, *_: Any, **__: Any) -> Any:
        found = np.empty(shape, dtype=object)
        found[...] = value
        return found.view(TracedArray)

    return made


def _full(shape: Any, value: Any, *_: Any, **__: Any) -> Any:
    return _room(value)(shape)


def _array(x: Any, *args: Any, **how: Any) -> Any:
    if is_traced(x):
        return np.array(x, dtype=object).view(TracedArray)
    if isinstance(x, TracedArray):  # of numbers only
        return x.copy()
    if args and args[0] is _Float:
        args = (float, *args[1:])
    if how.get("dtype") is _Float:
        how = {**how, "dtype": float}
    return np.array(x, *args, **how)


def _by(function: Any) -> Callable[..., Any]:
    """Return one of NumPy's functions with its formulas seen in lists too."""

    def of(*args: Any, **how: Any) -> Any:
        if any(map(is_traced, (*args, *how.values()))):
            return by_function(function, args, how)
        return function(*args, **how)

    return of


def _joined(function: Any) -> Callable[..., Any]:
    def of(*args: Any, **how: Any) -> Any:
        found = function(*args, **{key: value for key, value in how.items() if key != "dtype"})
        return found.view(TracedArray) if found.dtype == object else found

    return of


def _solve(matrix: Any, right: Any, *_: Any, **__: Any) -> Any:
    return solved(matrix, right)


_OWN: dict[str, Any] = {
    "zeros": _room(0), "empty": _room(0), "ones": _room(1), "full": _full, "array": _array, "asarray": _array,
    "asanyarray": _array, "ascontiguousarray": _array, "atleast_1d": _joined(np.atleast_1d),
    **{
        name: _joined(getattr(np, name))
        for name in ("concatenate", "hstack", "vstack", "stack", "column_stack", "append")
    },
    **{name: _by(getattr(np, name)) for name in ("where", "clip", "select", "piecewise", "interp", "sinc")},
    "apply_along_axis": _by(np.apply_along_axis),
}  # fmt: skip
_OF_MATRICES = {
    "solve": _solve,
    **{name: _by(getattr(np.linalg, name)) for name in ("inv", "norm", "det")},
}
_LINEAR = _Module(np.linalg, _OF_MATRICES)
_NUMPY = _Module(np, {**_OWN, "linalg": _LINEAR})

# -- Python --------------------------------------------------------------------------------------------


class _AsFloat(type):
    def __instancecheck__(cls, x: object) -> bool:
        return isinstance(x, float)


class _Float(float, metaclass=_AsFloat):
    """``float`` for what may be a formula."""

    def __new__(cls, x: Any = 0.0) -> Any:
        if isinstance(x, np.ndarray) and x.size == 1:
            x = x.item()
        return x if is_traced(x) else float(x)


def _extreme(name: str) -> Callable[..., Any]:
    of_python, of_formulas = getattr(builtins, name), OF_NUMBERS[f"{name}imum"]

    def of(*args: Any, **how: Any) -> Any:
        given = list(args[0]) if len(args) == 1 and not how else list(args)
        if how or not any(map(is_traced, given)):
            return of_python(*args, **how)
        return functools.reduce(of_formulas, given)

    return of


def _complex(re: Any = 0, im: Any = 0) -> Any:
    return re + 1j * im if is_traced(re) or is_traced(im) else complex(re, im)


OF_PYTHON: dict[str, Any] = {
    "float": _Float,
    "complex": _complex,
    "max": _extreme("max"),
    "min": _extreme("min"),
}

_NAMES_IN_MATH = {
    **{name: name for name in (
        "sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "expm1", "log1p", "log2", "log10", "sqrt", "fabs", "hypot",
        "copysign", "degrees", "radians", "cbrt", "floor", "ceil", "exp2",
    )},
    "asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2", "asinh": "arcsinh", "acosh": "arccosh",
    "atanh": "arctanh", "pow": "float_power", "isnan": "isnan", "isinf": "isinf", "isfinite": "isfinite",
}  # fmt: skip


def _of_math(function: Callable[..., Any], name: str) -> Callable[..., Any]:
    def of(*numbers: Any) -> Any:
        if not any(map(is_traced, numbers)):
            return function(*numbers)
        if any(isinstance(x, np.ndarray) and x.size > 1 for x in numbers):
            raise TypeError(f"math.{function.__name__} of an array; numpy's function takes one")
        return OF_NUMBERS[name](*(x.item() if isinstance(x, np.ndarray) else x for x in numbers))

    return of


def _logarithm(x: Any, *base: Any) -> Any:
    if not any(map(is_traced, (x, *base))):
        return math.log(x, *base)
    found = OF_NUMBERS["log"](x)
    return found / OF_NUMBERS["log"](base[0]) if base else found


def _sum(numbers: Any) -> Any:
    numbers = list(numbers)
    return sum(numbers) if any(map(is_traced, numbers)) else math.fsum(numbers)


def _distance(p: Any, q: Any) -> Any:
    if not any(map(is_traced, (*p, *q))):
        return math.dist(p, q)
    return OF_NUMBERS["sqrt"](sum((a - b) ** 2 for a, b in zip(p, q, strict=True)))


_IN_MATH: dict[str, Any] = {
    own: _of_math(getattr(math, own), name) for own, name in _NAMES_IN_MATH.items() if hasattr(math, own)
} | {"log": _logarithm, "fsum": _sum, "dist": _distance}


def _phase(z: Any) -> Any:
    return OF_NUMBERS["arctan2"](z.imag, z.real) if is_traced(z) else cmath.phase(z)


def _polar(z: Any) -> Any:
    return (abs(z), _phase(z)) if is_traced(z) else cmath.polar(z)


def _rect(r: Any, angle: Any) -> Any:
    if not (is_traced(r) or is_traced(angle)):
        return cmath.rect(r, angle)
    return r * (OF_NUMBERS["cos"](angle) + 1j * OF_NUMBERS["sin"](angle))


_CMATH = _Module(
    cmath,
    {"exp": _of_math(cmath.exp, "exp"), "phase": _phase, "polar": _polar, "rect": _rect},
)
_MATH = _Module(math, _IN_MATH)

_STANDING_IN: dict[Any, Any] = {
    **{getattr(np, name): own for name, own in _OWN.items()},
    **{getattr(math, name): own for name, own in _IN_MATH.items()},
    **{getattr(np.linalg, name): own for name, own in _OF_MATRICES.items()},
    builtins.float: _Float, builtins.complex: _complex,
    builtins.max: OF_PYTHON["max"], builtins.min: OF_PYTHON["min"],
}  # fmt: skip
