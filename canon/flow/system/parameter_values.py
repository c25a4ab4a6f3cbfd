"""Values of a system's parameters: every one is there, once, and what its symbol says it is."""

from __future__ import annotations

import functools
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from canon.expression.symbols.symbol import Momentum, Rate
from canon.frozen_mapping import FrozenMapping
from canon.kernel.program.hamilton_equations import exact_number
from canon.mechanics.algebra.substitution import symbols_within

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from fractions import Fraction

    from sympy import Expr, Symbol

__all__ = ["SpareParameters", "check_given", "check_known", "check_parameters", "symbols_in"]

_KINDS = ("positive", "negative", "nonnegative", "nonpositive", "nonzero", "integer")


class SpareParameters(FrozenMapping["Symbol | str", Any]):
    """Values of the parameters of a scene or of a table, some of which may not matter in the motion.

    That of a user's own system which it has not is an error instead, since it may be a slip.
    """


def check_parameters(
    parameters: Mapping[Symbol | str, Any],
    needed: Iterable[Symbol],
    variables: Sequence[Symbol],
    *,
    others: Iterable[Symbol] = (),
) -> None:
    """Refuse parameters that a system lacks, that are given twice, or against what their symbols say.

    Parameters
    ----------
    parameters
        A number, or an array over the orbits, by symbol or name.
    needed
        The symbols that must have a number.
    variables
        Coordinates, velocities and the like, and the time, which are no parameters.
    others
        Symbols of observables and events, which need one too.

    Raises
    ------
    KeyError
        A parameter has no number, or a number is for no parameter.
    ValueError
        A name is given twice, is that of a variable, or its number is not what the symbol is said to be; or what needs
        one is a momentum or an acceleration.

    Examples
    --------
    >>> (m,) = sp.symbols("m", positive=True, seq=True)
    >>> check_parameters({"m": -1.0}, [m], [])
    Traceback (most recent call last):
        ...
    ValueError: m = -1.0, but m was made as a positive symbol: give a positive number
    """
    needed = tuple(needed)
    _check_none_moves(needed)
    known = {s.name: s for s in (*others, *needed)}
    check_given(parameters, known.values(), variables)
    check_known(parameters, known.values())
    seen = {str(key) for key in parameters}
    missing = sorted(name for name in known if name not in seen)
    if missing:
        raise KeyError(f"no number for {', '.join(missing)}: give each one, parameters={{symbol: value}}")


def _check_none_moves(needed: Sequence[Symbol]) -> None:
    """Refuse momenta and accelerations that a system is written in beside its variables, as in a force −p_x."""
    moving = sorted(str(s) for s in needed if isinstance(s, Momentum | Rate))
    if moving:
        raise ValueError(
            f"the system holds {', '.join(moving)}, which is no parameter and none of its variables: write L, forces "
            "and constraints in q, q̇ and t (a momentum p_x as ∂L/∂x_dot; what is dragged along as kinetic energy in L)"
        )


def check_known(parameters: Mapping[Symbol | str, Any], symbols: Iterable[Any]) -> None:
    """Refuse numbers for parameters that a system has not.

    Raises
    ------
    KeyError
        A number is for no parameter.
    """
    known = {symbol.name for symbol in symbols}
    for name in (str(key) for key in parameters):
        if name not in known:
            near = get_close_matches(name, known, 1)
            has = f"it has {', '.join(sorted(known))}" if known else "it has none"
            meant = f"; is {near[0]} meant?" if near else ""
            raise KeyError(f"the system has no parameter {name}, {has}{meant}")


def check_given(
    parameters: Mapping[Symbol | str, Any], symbols: Iterable[Any], variables: Sequence[Symbol]
) -> None:
    """Refuse parameters that are given twice, that move, or that are against what a symbol of their name says.

    Those of other names are passed over: a scene may have parameters that do not matter.

    Raises
    ------
    ValueError
        A name is given twice, is that of a variable, or its number is not what the symbol is said to be; or what needs
        one is a momentum or an acceleration.
    """
    known = {s.name: s for s in symbols}
    moving, seen = {s.name for s in variables}, set[str]()
    for key, value in parameters.items():
        name = str(key)
        if name in seen:
            raise ValueError(f"parameters give {name} twice, by its symbol and by its name; give it once")
        seen.add(name)
        if name in moving:
            raise ValueError(f"{name} moves and is no parameter: its start stands in y0")
        if name in known:
            numbers = np.asarray(value, dtype=object)
            for orbit, number in enumerate(numbers.ravel().tolist()):
                _check_kind(known[name], number, f"{name}[{orbit}]" if numbers.ndim else name)


def _check_kind(symbol: Symbol, value: Any, said: str) -> None:
    kind = _missing_kind(symbol, exact_number(value, said))
    if kind:
        raise ValueError(
            f"{said} = {value}, but {symbol.name} was made as a {kind} symbol: give a {kind} number"
        )


@functools.lru_cache(maxsize=1024)
def _missing_kind(symbol: Symbol, value: Fraction) -> str:
    """Return what a symbol is said to be and a number is not, "" where it is all of that."""
    number: Any = sp.Rational(value)
    kinds = (kind for kind in _KINDS if getattr(symbol, f"is_{kind}") and not getattr(number, f"is_{kind}"))
    return next(kinds, "")


@functools.lru_cache(maxsize=256)
def symbols_in(f: Expr) -> frozenset[Any]:
    """Return the symbols of an expression, as of an earlier call."""
    return symbols_within(f, {})
