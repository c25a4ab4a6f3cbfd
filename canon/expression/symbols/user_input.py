"""Checks of user input: errors name what the input should have been."""

from __future__ import annotations

from collections.abc import Set
from numbers import Real
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.expression.symbols.input_in_words import counted, described, given_kind, listed

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from sympy import Expr, Symbol

__all__ = [
    "NotFiniteError",
    "all_of",
    "by_symbol",
    "counted",
    "free_name",
    "given_expression",
    "given_kind",
    "given_seconds",
    "given_symbols",
    "listed",
]


LONGEST = 1e8
"""Seconds of the longest budget."""


class NotFiniteError(ValueError):
    """What was given, or came out, is infinite or undefined."""


def given_expression(f: Any, name: str = "") -> Expr:
    """Return what was given as an expression.

    Parameters
    ----------
    f
        A SymPy expression or a number.
    name
        What it is called where it was given, such as ``"H"``.

    Raises
    ------
    TypeError
        For text, lists, systems and conditions, with what to write instead.
    NotFiniteError
        For what is no finite number.

    Examples
    --------
    >>> given_expression(2)
    2
    >>> given_expression("q*p", "I")
    Traceback (most recent call last):
        ...
    TypeError: I should be an expression, not the text 'q*p'; make its symbols with coordinates() and parameters() ...
    """
    if isinstance(f, sp.Expr) and not isinstance(f, sp.MatrixBase):
        expression = f
    else:
        if isinstance(f, str | list | tuple | set | dict | sp.MatrixBase | bool):
            raise TypeError(_not_an_expression(f, name))
        try:
            expression = sp.sympify(f, strict=True)
        except sp.SympifyError:
            raise TypeError(_not_an_expression(f, name)) from None
        if not isinstance(expression, sp.Expr):
            raise TypeError(_not_an_expression(f, name))
    if expression in (sp.nan, sp.zoo, sp.oo, -sp.oo):
        raise NotFiniteError(f"{name or 'the expression'} is {expression}, which is no finite quantity")
    return expression


def given_symbols(x: Any, name: str = "") -> tuple[Symbol, ...]:
    """Return one symbol or several as a tuple.

    Raises
    ------
    TypeError
        Where something else is among them.

    Examples
    --------
    >>> q, p = sp.symbols("q p")
    >>> given_symbols(q), given_symbols([q, p])
    ((q,), (q, p))
    >>> given_symbols([q**2], "x")
    Traceback (most recent call last):
        ...
    TypeError: x should be symbols, as coordinates('q') or parameters('m') make them, not q**2
    """
    if isinstance(x, Set):
        raise TypeError(f"{name or 'the variables'}: a set has no order; give a list")
    several: tuple[Any, ...] = (
        (x,) if isinstance(x, sp.Basic | str) or not hasattr(x, "__iter__") else tuple(x)
    )
    for each in several:
        if not isinstance(each, sp.Symbol):
            said = "symbols, as coordinates('q') or parameters('m') make them"
            raise TypeError(f"{name or 'the variables'} should be {said}, not {described(each)}")
    return several


def given_seconds(budget: Any) -> float:
    """Return a budget of time as it was given; three years for one without end, as no lock waits for ever.

    Raises
    ------
    TypeError, ValueError
        Where it is no number.

    Examples
    --------
    >>> given_seconds("3")
    Traceback (most recent call last):
        ...
    TypeError: budget should be a number of seconds, not the text '3'
    """
    if not isinstance(budget, Real):
        raise TypeError(f"budget should be a number of seconds, not {described(budget)}")
    if budget != budget:
        raise ValueError("budget should be a number of seconds, not NaN")
    return min(float(budget), LONGEST)


def all_of(x: Any, count: int, name: str, of: str) -> Sequence[Any]:
    """Return as many things as there should be.

    Raises
    ------
    TypeError, ValueError
        Where it is no sequence, or one of another length.

    Examples
    --------
    >>> all_of([1], 2, "xi", "coordinates")
    Traceback (most recent call last):
        ...
    ValueError: xi has 1 entry for 2 coordinates; give one each
    """
    if isinstance(x, str) or not hasattr(x, "__len__"):
        raise TypeError(
            f"{name} should be a list with one entry for each of {count} {of}, not {described(x)}"
        )
    if len(x) != count:
        raise ValueError(f"{name} has {counted(len(x), 'entry', 'entries')} for {count} {of}; give one each")
    return x


def by_symbol(given: Mapping[Any, Any], symbols: Sequence[Symbol], name: str) -> dict[Symbol, Any]:
    """Return what was given by symbol or by name, by symbol; what was not named is left out.

    Raises
    ------
    ValueError
        Where something else was named, or one of the symbols twice.

    Examples
    --------
    >>> q, p = sp.symbols("q p", real=True)
    >>> by_symbol({"q": 1}, [q, p], "at"), by_symbol({sp.Symbol("q"): 1}, [q, p], "at")
    ({q: 1}, {q: 1})
    >>> by_symbol({"x": 1}, [q, p], "at")
    Traceback (most recent call last):
        ...
    ValueError: at names x, which is none of q, p
    """
    named = {symbol.name: symbol for symbol in symbols}
    unknown = sorted({str(key) for key in given} - {*named})
    if unknown:
        raise ValueError(f"{name} names {', '.join(unknown)}, which is none of {', '.join(named)}")
    found = {named[str(key)]: value for key, value in given.items()}
    if len(found) < len(given):
        raise ValueError(f"{name} names a symbol twice: {', '.join(sorted(map(str, given)))}")
    return found


def free_name(name: str, taken: Collection[str]) -> str:
    """Return a name with as many underscores behind it as make it another one than those that are taken.

    Examples
    --------
    >>> free_name("r", {"r", "phi"}), free_name("u", {"r", "phi"})
    ('r_', 'u')
    """
    while name in taken:
        name += "_"
    return name


def _not_an_expression(f: Any, name: str) -> str:
    remedy = ""
    if isinstance(f, str):
        remedy = "; make its symbols with coordinates() and parameters() and write it with them"
    elif isinstance(f, sp.Equality):
        remedy = "; write lhs - rhs"
    elif isinstance(f, list | tuple | sp.MatrixBase) and len(f) == 1:
        remedy = "; leave the brackets out"
    elif isinstance(f, sp.MatrixBase):
        remedy = "; give its entries one by one"
    else:
        held = [letter for letter in ("H", "L", "F") if isinstance(getattr(f, letter, None), sp.Expr)]
        remedy = f"; give its .{held[0]}" if held else ""
    wanted = f"{name} should be an expression" if name else "an expression is needed"
    return f"{wanted}, not {described(f)}{remedy}"
