"""Exchanged names: a function of the user's whose ``numpy``, ``math`` and ``float`` let formulas pass.

``numpy.zeros(4)`` has places for numbers only, and ``math.sin`` takes nothing else. What a function calls by names of
its module or of the functions around it is exchanged in a copy of it; the module itself stays as it is.
"""

from __future__ import annotations

import copy
import dis
import enum
import functools
import sys
import types
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from canon.expression.symbols.input_in_words import module_of
from canon.mechanics.traced.standing_functions import OF_PYTHON, stands_for
from canon.mechanics.traced.traced_array import interpolated, piecewise_polynomial

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["with_exchanged_names"]


def with_exchanged_names(f: Callable[..., Any]) -> Callable[..., Any]:
    """Return a copy of a function in which NumPy's, Python's and SciPy's functions take formulas.

    Examples
    --------
    >>> import math
    >>> import sympy
    >>> from canon.mechanics.traced.traced_number import TracedNumber
    >>> q = TracedNumber(sympy.Symbol("q", real=True))
    >>> with_exchanged_names(lambda u: math.sin(u) + max(u, 0.5))(q)
    sin(q) + Max(1/2, q)
    """
    return cast("Callable[..., Any]", _Exchange().of(f))


class _Exchange:
    """One pass through a function and what it calls; each is exchanged once."""

    def __init__(self) -> None:
        self.done: dict[int, Any] = {}
        self.kept: list[Any] = []  # so that no id is used again

    def of(self, x: Any) -> Any:
        """Return what stands for a value; itself where nothing has to."""
        known = stands_for(x)
        if known is not None:
            return known
        if id(x) not in self.done:
            self.kept.append(x)
            self.done[id(x)] = x
            self._exchange(x)
        return self.done[id(x)]

    def _exchange(self, x: Any) -> None:
        match x:
            case types.FunctionType():
                self._function(x)
            case functools.partial():
                given = {key: self.of(value) for key, value in x.keywords.items()}
                self.done[id(x)] = functools.partial(self.of(x.func), *map(self.of, x.args), **given)
            case types.MethodType():
                owner = self.of(x.__self__)
                self.done[id(x)] = getattr(owner, x.__func__.__name__, x)
            case _ if _is_spline(x):
                self.done[id(x)] = piecewise_polynomial(x.x, x.c)
            case _ if _is_table(x):
                self.done[id(x)] = _of_table(x)
            case _ if isinstance(getattr(x, "py_func", None), types.FunctionType):
                self.done[id(x)] = self.of(x.py_func)
            case _ if isinstance(
                getattr(x, "__wrapped__", None), types.FunctionType
            ):  # with a cache around it
                self.done[id(x)] = self.of(x.__wrapped__)
            case _ if isinstance(getattr(x, "pyfunc", None), types.FunctionType):
                self.done[id(x)] = np.vectorize(self.of(x.pyfunc), otypes=[object])
            case _ if isinstance(x, tuple | list | dict):
                self._container(cast("Any", x))
            case _ if isinstance(x, set | np.ndarray):
                self.done[id(x)] = x.copy()
            case enum.Enum() | enum.EnumMeta():
                pass
            case type() if _is_class_of_user(x):
                self._class(x)
            case _ if _is_of_user(x):
                self._object(x)
            case _:
                pass

    def _function(self, f: types.FunctionType) -> None:
        scope: dict[str, Any] = dict(f.__globals__)
        cells = tuple(types.CellType() for _ in f.__closure__ or ())
        new = types.FunctionType(f.__code__, scope, f.__name__, f.__defaults__, cells)
        new.__kwdefaults__ = f.__kwdefaults__
        new.__dict__.update(f.__dict__)
        self.done[id(f)] = new
        for name in {*_names(f.__code__)}:
            if name in scope:
                scope[name] = self.of(scope[name])
            elif name in OF_PYTHON:
                scope[name] = OF_PYTHON[name]
        changed = {*_changed(f.__code__)}
        for name in changed & scope.keys():
            scope[name] = _Remembered.of(name, scope[name])
        for cell, old in zip(cells, f.__closure__ or (), strict=True):
            try:
                cell.cell_contents = self.of(old.cell_contents)
            except ValueError:  # a name that has no value yet
                continue
        for cell, name in zip(cells, f.__code__.co_freevars, strict=True):
            if name in changed:
                cell.cell_contents = _Remembered.of(name, cell.cell_contents)
        if f.__defaults__:
            new.__defaults__ = tuple(map(self.of, f.__defaults__))

    def _container(self, x: Any) -> None:
        """Exchange what a container holds, in a copy: what is written into it should not be the user's."""
        if isinstance(x, tuple):
            values = cast("tuple[Any, ...]", x)
            new = [self.of(value) for value in values]
            if any(a is not b for a, b in zip(values, new, strict=True)):
                self.done[id(x)] = type(x)(*new) if hasattr(x, "_fields") else type(x)(new)
            return
        own: Any = copy.copy(x)
        self.done[id(x)] = own
        for key, value in list(own.items() if isinstance(own, dict) else enumerate(own)):
            own[key] = self.of(value)

    def _object(self, x: Any) -> None:
        """Exchange the methods of an object of the user's own class, and the functions it holds, in a copy."""
        try:
            new = copy.copy(x)
            self.done[id(x)] = new
            object.__setattr__(new, "__class__", self._with_own_methods(type(x)))
            for name, value in list(vars(new).items()):
                object.__setattr__(new, name, self.of(value))
        except TypeError:  # such an object can't be copied or has a layout of its own
            self.done[id(x)] = x

    def _class(self, kind: type) -> None:
        """Exchange the methods of a class of the user's own, in a class below it."""
        try:
            self.done[id(kind)] = self._with_own_methods(kind)
        except (TypeError, ValueError):  # nothing may stand below it
            self.done[id(kind)] = kind

    def _with_own_methods(self, kind: type) -> type:
        own = {
            name: value
            for base in reversed(kind.__mro__)
            if base is not object
            for name, value in vars(base).items()
        }
        methods: dict[str, Any] = {}
        for name, value in own.items():
            match value:
                case types.FunctionType():
                    methods[name] = self.of(value)
                case staticmethod() | classmethod():
                    methods[name] = type(value)(self.of(cast("Any", value).__func__))
                case property() if value.fget is not None:
                    methods[name] = property(self.of(value.fget), value.fset)
                case _:
                    pass
        return type(kind.__name__, (kind,), methods)


def _names(code: types.CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _names(constant)


def _changed(code: types.CodeType) -> Iterator[str]:
    """Yield the names around a function that it gives new values."""
    for step in dis.get_instructions(code):
        if step.opname == "STORE_GLOBAL" or (
            step.opname == "STORE_DEREF" and step.argval in code.co_freevars
        ):
            yield step.argval


class _Remembered:
    """A number that a function changes whenever it is called: no formula may hold it."""

    def __init__(self, name: str) -> None:
        self.name = name

    @classmethod
    def of(cls, name: str, value: Any) -> Any:
        return cls(name) if isinstance(value, int | float) else value

    def __repr__(self) -> str:
        return f"{self.name}, which it changes itself when it is called,"

    def _counted(self, _: Any) -> _Remembered:
        return self

    def _asked(self, *_: Any) -> Any:
        raise TypeError(f"it asks for {self.name}, which it changes itself when it is called")

    __add__ = __radd__ = __sub__ = __mul__ = _counted
    __bool__ = __float__ = __int__ = __lt__ = __le__ = __gt__ = __ge__ = __eq__ = __ne__ = __mod__ = _asked
    __hash__ = None  # type: ignore[assignment]


def _is_of_user(x: Any) -> bool:
    if isinstance(x, type | types.ModuleType | np.ndarray) or not hasattr(x, "__dict__"):
        return False
    return _is_class_of_user(type(x))


def _is_class_of_user(kind: type) -> bool:
    return module_of(kind).partition(".")[0] not in (
        *sys.stdlib_module_names,
        "numpy",
        "scipy",
        "sympy",
        "canon",
    )


def _is_spline(x: Any) -> bool:
    return (
        module_of(type(x)).startswith("scipy.interpolate")
        and hasattr(x, "c")
        and hasattr(x, "x")
        and (np.ndim(x.c) == 2 and len(x.x) == np.shape(x.c)[1] + 1)
    )


def _is_table(x: Any) -> bool:
    return type(x).__name__ == "interp1d" and getattr(x, "_kind", "") == "linear" and np.ndim(x.y) == 1


def _of_table(x: Any) -> Callable[[Any], Any]:
    return lambda u: interpolated(u, x.x, x.y)
