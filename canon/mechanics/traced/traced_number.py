"""Traced numbers: formulas in place of numbers, which know Python's operators and NumPy's functions of numbers."""

from __future__ import annotations

import math
import operator
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import sympy as sp

from canon.mechanics.traced.complex_rates import modulus, real_and_imaginary

if TYPE_CHECKING:
    from collections.abc import Callable

    from sympy.logic.boolalg import Boolean

    from canon.mechanics.traced.decisions import Decisions

__all__ = ["OF_NUMBERS", "TracedCondition", "TracedNumber", "choice", "expression", "is_traced"]


_LONG, _LONGEST = 300, 50_000
"""Operations of formulas whose signs SymPy is not asked for, and of the longest."""


def is_traced(x: Any) -> bool:
    """Tell whether something is, or holds, a formula in place of a number."""
    if isinstance(x, TracedNumber | TracedCondition):
        return True
    if isinstance(x, list | tuple):
        return any(map(is_traced, cast("list[Any]", x)))
    return isinstance(x, np.ndarray) and x.dtype == object and any(map(is_traced, x.flat))


def expression(x: Any) -> sp.Expr:
    """Return a formula, or a number as the exact fraction that it is.

    Raises
    ------
    TypeError
        It is none.
    """
    if isinstance(x, np.ndarray) and x.ndim == 0:
        x = x.item()
    if isinstance(x, TracedNumber):
        return x.formula
    if isinstance(x, TracedCondition):
        return x.number().formula
    if isinstance(x, sp.Expr):
        return x
    if isinstance(x, bool | np.bool_):
        return sp.Integer(int(x))
    if isinstance(x, int | float | np.integer | np.floating | Fraction) and np.isfinite(float(x)):
        return sp.Rational(Fraction(x if isinstance(x, int | Fraction) else float(x)))
    if isinstance(x, complex | np.complexfloating) and np.isfinite(complex(x)):
        return expression(x.real) + sp.I * expression(x.imag)
    raise TypeError(f"{x!r} is no formula and no finite number")


class TracedNumber:
    """A formula in place of a number: arithmetic and NumPy's functions make longer ones.

    Parameters
    ----------
    formula
        What it is.
    decisions
        Whom to ask where its sign is asked for.
    length
        So many operations it was made of.
    """

    __slots__ = ("decisions", "formula", "length")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, formula: sp.Expr, decisions: Decisions | None = None, length: int = 1) -> None:
        self.formula = formula
        self.decisions = decisions
        self.length = length

    def __repr__(self) -> str:
        return str(self.formula)

    def __format__(self, _: str) -> str:
        return str(self.formula)

    def __neg__(self) -> TracedNumber:
        return TracedNumber(-self.formula, self.decisions)

    def __pos__(self) -> TracedNumber:
        return self

    def __abs__(self) -> TracedNumber:
        return TracedNumber(modulus(self.formula), self.decisions)

    def __bool__(self) -> bool:
        return bool(_differs_from_zero(self))

    def _asked(self, *_: Any) -> Any:
        raise TypeError(
            "it asks for the number of something that moves, as an index does, or math imported inside it"
        )

    __float__ = __int__ = __index__ = __complex__ = _asked

    @property
    def real(self) -> TracedNumber:
        """The real part."""
        return TracedNumber(real_and_imaginary(self.formula)[0], self.decisions)

    @property
    def imag(self) -> TracedNumber:
        """The imaginary part."""
        return TracedNumber(real_and_imaginary(self.formula)[1], self.decisions)

    def __divmod__(self, other: Any) -> Any:
        whole = OF_NUMBERS["floor_divide"](self, other)
        return whole, self - whole * other

    def item(self) -> TracedNumber:
        """Return itself, as NumPy's numbers do."""
        return self

    def copy(self) -> TracedNumber:
        """Return itself."""
        return self


class TracedCondition:
    """A condition in place of a truth value.

    Parameters
    ----------
    formula
        What it is.
    decisions
        Whom to ask where its truth is asked for.
    """

    __slots__ = ("decisions", "formula")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, formula: Boolean, decisions: Decisions | None) -> None:
        self.formula = formula
        self.decisions = decisions

    def __repr__(self) -> str:
        return str(self.formula)

    def __bool__(self) -> bool:
        if self.decisions is None:
            raise TypeError("it asks for the truth of something that moves")
        return self.decisions.decide(self.formula)

    def __int__(self) -> int:
        return int(bool(self))

    __index__ = __int__

    def __float__(self) -> float:
        return float(bool(self))

    def number(self) -> TracedNumber:
        """Return 1 where the condition holds and 0 where it does not."""
        return TracedNumber(sp.Piecewise((sp.S.One, self.formula), (sp.S.Zero, True)), self.decisions)

    def __invert__(self) -> Any:
        return _condition(sp.Not(self.formula), self.decisions)

    def __neg__(self) -> TracedNumber:
        return -self.number()


def choice(condition: Any, yes: Any, no: Any) -> Any:
    """Return one of two numbers, by a condition that may be known.

    Examples
    --------
    >>> x = TracedNumber(sp.Symbol("x", real=True))
    >>> choice(x > 0, x, 0), choice(True, 1.0, x)
    (Piecewise((x, x > 0), (0, True)), 1.0)
    """
    if isinstance(condition, TracedNumber):
        condition = _differs_from_zero(condition)
    if not isinstance(condition, TracedCondition):
        return yes if condition else no
    a, b = expression(yes), expression(no)
    return TracedNumber(
        a if a == b else sp.Piecewise((a, condition.formula), (b, True)), _of(yes, no) or condition.decisions
    )


def _of(*operands: Any) -> Decisions | None:
    found = (x.decisions for x in operands if isinstance(x, TracedNumber | TracedCondition))
    return next((decisions for decisions in found if decisions is not None), None)


def _condition(formula: Any, decisions: Decisions | None) -> Any:
    if formula in (sp.true, sp.false):
        return bool(formula)
    return TracedCondition(formula, decisions)


def _differs_from_zero(x: TracedNumber) -> Any:
    return _condition(sp.Ne(x.formula, 0), x.decisions)


def _truth(x: Any) -> Boolean:
    if isinstance(x, TracedCondition):
        return x.formula
    if isinstance(x, TracedNumber):
        return cast("Boolean", sp.Ne(x.formula, 0))
    return sp.true if x else sp.false


# -- operators -----------------------------------------------------------------------------------------


def _numbers(operation: Callable[..., Any]) -> Callable[..., Any]:
    """Return an operation on formulas as one on numbers, traced ones and others."""

    def of_numbers(*operands: Any) -> Any:
        if not any(isinstance(x, TracedNumber | TracedCondition) for x in operands):
            operands = tuple(TracedNumber(expression(x)) for x in operands)
        length = 1 + sum(getattr(x, "length", 1) for x in operands)
        if length > _LONGEST:
            raise TypeError(f"its formulas grow beyond {_LONGEST} operations, as by a loop that repeats them")
        return TracedNumber(operation(*map(expression, operands)), _of(*operands), length)

    return of_numbers


def _operator(operation: Callable[..., Any], *, swapped: bool) -> Callable[[Any, Any], Any]:
    of_numbers = _numbers((lambda a, b: operation(b, a)) if swapped else operation)

    def method(a: Any, b: Any) -> Any:
        if isinstance(b, np.ndarray | list | tuple):
            return NotImplemented  # NumPy goes through its elements
        return of_numbers(a, b)

    return method


def _comparison(relation: Callable[..., Any]) -> Callable[[Any, Any], Any]:
    def method(a: Any, b: Any) -> Any:
        if b is None or isinstance(b, np.ndarray | str | list | tuple):
            return NotImplemented
        if not isinstance(b, TracedNumber | TracedCondition) and not math.isfinite(b):
            if math.isnan(b):
                return relation is sp.Unequality
            return bool(relation(sp.S.Zero, sp.oo if b > 0 else -sp.oo))  # what moves is finite
        left, right = expression(a), expression(b)
        long = getattr(a, "length", 1) + getattr(b, "length", 1) > _LONG
        known = not long or (left.is_number and right.is_number)
        return _condition(relation(left, right, evaluate=known), _of(a, b))

    return method


def _logical(operation: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *operands: _condition(operation(*map(_truth, operands)), _of(*operands))


def _floor_quotient(a: sp.Expr, b: sp.Expr) -> sp.Expr:
    return sp.floor(a / b)


def _remainder(a: sp.Expr, b: sp.Expr) -> sp.Expr:
    return sp.Mod(a, b)


_OPERATORS: dict[str, Callable[..., Any]] = {
    "add": operator.add, "sub": operator.sub, "mul": operator.mul, "truediv": operator.truediv,
    "pow": operator.pow, "floordiv": _floor_quotient, "mod": _remainder,
}  # fmt: skip
_COMPARISONS: dict[str, Callable[..., Any]] = {
    "lt": sp.StrictLessThan, "le": sp.LessThan, "gt": sp.StrictGreaterThan, "ge": sp.GreaterThan,
    "eq": sp.Equality, "ne": sp.Unequality,
}  # fmt: skip

for _type in (TracedNumber, TracedCondition):
    for _name, _operation in _OPERATORS.items():
        setattr(_type, f"__{_name}__", _operator(_operation, swapped=False))
        setattr(_type, f"__r{_name}__", _operator(_operation, swapped=True))
    for _name, _relation in _COMPARISONS.items():
        setattr(_type, f"__{_name}__", _comparison(_relation))
for _name, _operation in (("and", sp.And), ("or", sp.Or), ("xor", sp.Xor)):
    setattr(TracedCondition, f"__{_name}__", _logical(_operation))
    setattr(TracedCondition, f"__r{_name}__", _logical(_operation))


# -- NumPy's functions of numbers ----------------------------------------------------------------------


def _conjugate(z: sp.Expr) -> sp.Expr:
    re, im = real_and_imaginary(z)
    return re - sp.I * im


def _cube_root(x: sp.Expr) -> sp.Expr:
    return sp.sign(x) * sp.Abs(x) ** sp.Rational(1, 3)


def _step(x: Any, at_zero: Any) -> sp.Expr:
    return sp.Heaviside(x, at_zero)


def _copied_sign(x: sp.Expr, of: sp.Expr) -> sp.Expr:
    return cast("sp.Expr", sp.Abs(x) * sp.Piecewise((sp.Integer(-1), of < 0), (sp.S.One, True)))


def _clipped(x: sp.Expr, low: sp.Expr, high: sp.Expr) -> sp.Expr:
    return cast("sp.Expr", sp.Min(sp.Max(x, low), high))


_OF_ONE: dict[str, Callable[[Any], Any]] = {
    "sin": sp.sin, "cos": sp.cos, "tan": sp.tan, "arcsin": sp.asin, "arccos": sp.acos, "arctan": sp.atan,
    "sinh": sp.sinh, "cosh": sp.cosh, "tanh": sp.tanh, "arcsinh": sp.asinh, "arccosh": sp.acosh,
    "arctanh": sp.atanh, "exp": sp.exp, "log": sp.log, "sqrt": sp.sqrt, "fabs": modulus, "absolute": modulus,
    "exp2": lambda x: 2**x, "expm1": lambda x: sp.exp(x) - 1, "log1p": lambda x: sp.log(1 + x),
    "log2": lambda x: sp.log(x) / sp.log(2), "log10": lambda x: sp.log(x) / sp.log(10), "cbrt": _cube_root,
    "conjugate": _conjugate, "deg2rad": lambda x: x * sp.pi / 180, "radians": lambda x: x * sp.pi / 180,
    "rad2deg": lambda x: x * 180 / sp.pi,
    "degrees": lambda x: x * 180 / sp.pi, "negative": operator.neg, "positive": operator.pos,
    "square": lambda x: x**2, "reciprocal": lambda x: 1 / x, "sign": sp.sign,
    "floor": sp.floor, "ceil": sp.ceiling, "expit": lambda x: 1 / (1 + sp.exp(-x)),
}  # fmt: skip
_OF_MORE: dict[str, Callable[..., Any]] = {
    "arctan2": sp.atan2, "hypot": lambda a, b: sp.sqrt(a**2 + b**2), "maximum": sp.Max, "minimum": sp.Min,
    "add": operator.add, "subtract": operator.sub, "multiply": operator.mul, "divide": operator.truediv,
    "power": operator.pow, "fmax": sp.Max, "fmin": sp.Min, "heaviside": _step,
    "copysign": _copied_sign, "clip": _clipped,
    "floor_divide": _floor_quotient, "remainder": _remainder, "float_power": operator.pow,
}  # fmt: skip
_ASKING: dict[str, Callable[..., Any]] = {
    "less": operator.lt, "less_equal": operator.le, "greater": operator.gt, "greater_equal": operator.ge,
    "equal": operator.eq, "not_equal": operator.ne, "logical_and": _logical(sp.And), "logical_or": _logical(sp.Or),
    "logical_not": _logical(sp.Not), "logical_xor": _logical(sp.Xor), "bitwise_and": _logical(sp.And),
    "bitwise_or": _logical(sp.Or), "invert": _logical(sp.Not), "isnan": lambda _: False, "isinf": lambda _: False,
    "isfinite": lambda _: True,
}  # fmt: skip

OF_NUMBERS: dict[str, Callable[..., Any]] = {
    **{name: _numbers(function) for name, function in {**_OF_ONE, **_OF_MORE}.items()},
    **_ASKING,
}
"""What NumPy's functions do to numbers, by their names."""


def _method(name: str) -> Callable[..., Any]:
    return lambda *operands: OF_NUMBERS[name](*operands)


for _name in (*_OF_ONE, "arctan2", "hypot"):  # which NumPy calls on the elements of arrays of objects
    setattr(TracedNumber, _name, _method(_name))
