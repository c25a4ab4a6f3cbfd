"""Declarations: what was said of a symbol or a function by its SymPy assumptions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sympy.core.function import AppliedUndef

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from sympy import Basic, Rational

__all__ = ["allows", "declared_complex", "said_of"]


def _declared(named: Basic) -> Mapping[str, bool]:
    """Return what was declared of a symbol, or of a function (SymPy keeps that with the function's class)."""
    return getattr(named.func, "_kwargs", {}) if isinstance(named, AppliedUndef) else named.assumptions0


def declared_complex(symbol: Basic) -> bool:
    """Tell whether a symbol or function was declared complex, or not to be real; all others are read as real."""
    said = _declared(symbol)
    if said.get("real") is not None:
        return not said["real"]
    return "complex" in said or "imaginary" in said


def said_of(named: Basic) -> dict[str, bool]:
    """Return what was declared of a symbol or an applied function beyond what holds for every rational number.

    Examples
    --------
    >>> from sympy import Symbol
    >>> said_of(Symbol("x", real=True)), said_of(Symbol("z", imaginary=True))["real"]
    ({}, False)
    """
    return {
        fact: so
        for fact, so in _declared(named).items()
        if not fact.startswith("extended_") and _OF_EVERY_RATIONAL.get(fact) is not so
    }


_OF_EVERY_RATIONAL: dict[str, bool] = {
    **dict.fromkeys(("commutative", "complex", "real", "finite", "hermitian", "rational", "algebraic"), True),
    **dict.fromkeys(("infinite", "imaginary", "irrational", "transcendental"), False),
}


_SEEN_AT_ONCE: dict[str, Callable[[Rational], bool]] = {
    "positive": lambda number: number.p > 0,
    "negative": lambda number: number.p < 0,
    "zero": lambda number: number.p == 0,
    "nonzero": lambda number: number.p != 0,
    "nonnegative": lambda number: number.p >= 0,
    "nonpositive": lambda number: number.p <= 0,
    "integer": lambda number: number.q == 1,
    "noninteger": lambda number: number.q != 1,
    "even": lambda number: number.q == 1 and number.p % 2 == 0,
    "odd": lambda number: number.q == 1 and number.p % 2 == 1,
}
"""Facts that a fraction p/q in lowest terms, q > 0, shows; SymPy would deduce all its facts to tell one of them."""


def allows(facts: Mapping[str, bool], number: Rational) -> bool:
    """Tell whether a number is all that a symbol was declared to be; what is not seen at once, SymPy says.

    Examples
    --------
    >>> from sympy import Rational, Symbol
    >>> facts = said_of(Symbol("m", positive=True))
    >>> allows(facts, Rational(1, 3)), allows(facts, Rational(-1, 3))
    (True, False)
    """
    return all(_is(number, fact) is so for fact, so in facts.items())


def _is(number: Rational, fact: str) -> bool | None:
    seen = _SEEN_AT_ONCE.get(fact)
    return getattr(number, f"is_{fact}") if seen is None else bool(seen(number))
