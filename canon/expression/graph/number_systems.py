"""Number systems in which an expression graph can be evaluated."""

from __future__ import annotations

import contextlib
import math
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from contextlib import AbstractContextManager

__all__ = [
    "FLOAT64", "LONGDOUBLE", "NOT_IN_NUMPY", "Arithmetic", "multiprecision", "numpy_functions", "written_constant",
]  # fmt: skip

_NUMPY_NAMES = {
    "asin": "arcsin", "acos": "arccos", "atan": "arctan", "asinh": "arcsinh", "acosh": "arccosh",
    "atanh": "arctanh", "atan2": "arctan2", "Abs": "abs",
}  # fmt: skip
_FUNCTION_NAMES = (
    "sin", "cos", "tan", "exp", "log", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh", "acosh",
    "atanh", "atan2", "Abs", "sign", "erf", "erfc",
)  # fmt: skip
NOT_IN_NUMPY = ("erf", "erfc")
"""Elementary functions that NumPy lacks."""
_DEEPEST = 20_000
"""Powers of 2 below this negative one are zero in every type of NumPy's."""

_NAMED = {
    "pi": "3.14159265358979323846264338327950288419716939937510582",
    "E": "2.71828182845904523536028747135266249775724709369995957",
}


@dataclass(frozen=True)
class Arithmetic:
    """How exact numbers become numbers of one kind, and how functions of those are computed.

    Parameters
    ----------
    name
        What it is called in messages and reports.
    digits
        Decimal digits it works with.
    number
        From an exact rational number.
    named
        From ``"pi"`` or ``"E"``.
    root
        The square root.
    functions
        The elementary functions by their SymPy names.
    """

    name: str
    digits: float
    number: Callable[[Fraction], Any]
    named: Callable[[str], Any]
    root: Callable[[Any], Any]
    functions: Mapping[str, Callable[..., Any]]

    def power(self, base: Any, exponent: Any) -> Any:
        """Return base**exponent: products for whole exponents, a square root for halves."""
        return self.raising_to(exponent)(base) if isinstance(exponent, Fraction) else base**exponent

    def raising_to(self, exponent: Fraction) -> Callable[[Any], Any]:
        """Return what raises a base to an exponent: products for whole exponents, a square root for halves."""
        whole, part, root = exponent.numerator, exponent.denominator, self.root
        if part > 2:
            number = self.number(exponent)
            return lambda base: base**number
        if part == 1:
            return (lambda base: base**whole) if whole > 0 else (lambda base: 1 / base**-whole)
        if abs(whole) == 1:
            return root if whole > 0 else (lambda base: 1 / root(base))
        return (lambda base: root(base) ** whole) if whole > 0 else (lambda base: 1 / root(base) ** -whole)

    def quiet(self) -> AbstractContextManager[Any]:
        """Keep NumPy from warning where a value leaves a function's domain: it returns NaN or inf."""
        return np.errstate(all="ignore")


def _each(dtype: type[np.floating[Any]], name: str) -> Callable[[Any], Any]:
    """Return a function that NumPy does not have, in doubles by Python's own, else by mpmath, number by number."""
    of_double = getattr(math, name)

    def of_wide(x: Any) -> Any:
        if not np.isfinite(x):
            return dtype(of_double(float(x)))
        from mpmath import MPContext, nstr

        context = MPContext()
        context.prec = 80
        above, below = x.as_integer_ratio()
        part, exponent = context.frexp(getattr(context, name)(context.mpf(above) / below))
        return np.ldexp(dtype(nstr(part, 24)), max(exponent, -_DEEPEST))

    one = of_double if dtype is np.float64 else of_wide
    mapped = np.vectorize(one, otypes=[dtype])
    return lambda x: mapped(x)[()]


def _numpy(dtype: type[np.floating[Any]]) -> Arithmetic:
    largest = np.finfo(dtype).maxexp

    @lru_cache(maxsize=4096)
    def number(value: Fraction) -> Any:
        top_bits, bottom_bits = value.numerator.bit_length(), value.denominator.bit_length()
        if top_bits - bottom_bits > largest:
            raise OverflowError(
                f"a number of about 2^{top_bits - bottom_bits} is beyond the range of {dtype.__name__}"
            )
        if max(top_bits, bottom_bits) > largest:
            return quotient(value)
        top, bottom = dtype(value.numerator), dtype(value.denominator)
        if int(top) == value.numerator and int(bottom) == value.denominator:
            return top / bottom
        return quotient(value)

    def quotient(value: Fraction) -> Any:
        # Too long for the type: round the quotient once, from more digits than the type holds.
        shift = max(0, 80 - abs(value.numerator).bit_length() + value.denominator.bit_length())
        return np.ldexp(dtype(str((value.numerator << shift) // value.denominator)), -shift)

    def named(name: str) -> Any:
        return dtype(_NAMED[name])

    own = {name: _each(dtype, name) for name in NOT_IN_NUMPY}
    return Arithmetic(
        name=np.dtype(dtype).name,
        digits=np.finfo(dtype).precision,
        number=number,
        named=named,
        root=np.sqrt,
        functions=own | numpy_functions(),
    )


def numpy_functions() -> dict[str, Callable[..., Any]]:
    """Return NumPy's elementary functions by their SymPy names; all but :data:`NOT_IN_NUMPY`."""
    names = (name for name in _FUNCTION_NAMES if name not in NOT_IN_NUMPY)
    return {name: getattr(np, _NUMPY_NAMES.get(name, name)) for name in names}


FLOAT64 = _numpy(np.float64)
"""IEEE double precision, scalars or arrays."""

LONGDOUBLE = _numpy(np.longdouble)
"""The platform's ``long double``: 64-bit mantissa on x86, no wider than a double on some others."""


def written_constant(name: str) -> str:
    """Return the digits of ``"pi"`` or ``"E"``."""
    return _NAMED[name]


@contextlib.contextmanager
def _nothing() -> Any:
    yield


def multiprecision(digits: int) -> Arithmetic:
    """Return arithmetic with mpmath numbers of so many digits (scalars only).

    Examples
    --------
    >>> from fractions import Fraction
    >>> print(multiprecision(30).number(Fraction(1, 3)))
    0.333333333333333333333333333333
    """
    from mpmath import MPContext

    context = MPContext()
    context.dps = digits

    def number(value: Fraction) -> Any:
        return context.mpf(value.numerator) / value.denominator

    def named(name: str) -> Any:
        return +context.pi if name == "pi" else +context.e

    functions = {name: getattr(context, name) for name in _FUNCTION_NAMES if name not in ("Abs",)}
    return Arithmetic(
        name=f"{digits} digits",
        digits=digits,
        number=number,
        named=named,
        root=context.sqrt,
        functions={**functions, "Abs": abs},
    )
