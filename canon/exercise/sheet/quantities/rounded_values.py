"""Rounded values behind exact ones, ``θ = arccos(2/3) ≈ 48.2°``: passed over where their figures are right."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import sympy as sp

from canon.expression.parse import LanguageError, parse_expression
from canon.expression.text.notation import is_latex

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["without_rounded"]

_ROUNDED = re.compile(
    r"(?:\\(?:approx|simeq)(?![A-Za-z])|[≈≃≅])\s*(?P<number>[-−]?[0-9]{1,9}(?:(?:[.,]|\{,\})[0-9]{1,12})?)"
    r"(?P<degrees>\s?(?:°|\^\s?\{?\s?\\circ\s?\}?|\\degree))?(?=[\s.$]*$)"
)
_GREATEST_EXPONENT = 20
_LONGEST = 2_000


def without_rounded(text: str, scope: Scope) -> tuple[str, str]:
    """Return a text without a rounded value behind an exact one, and that value; an empty one where there is none.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> without_rounded("x = sqrt(2) ≈ 1.41", Scope()), without_rounded("x = sqrt(2) ≈ 1.42", Scope())[1]
    (('x = sqrt(2)       ', '≈ 1.41'), '')
    """
    found = _ROUNDED.search(text) if len(text) <= _LONGEST else None
    if found is None:
        return text, ""
    said = re.split("[=≈<>]", text[: found.start()])[-1].strip(" $")
    try:
        exact = parse_expression(f"${said}$" if is_latex(text) else said, scope)
    except LanguageError:
        return text, ""
    if exact.free_symbols or not _is_small(exact) or not exact.is_real or not _rounds(exact, found):
        return text, ""
    behind = text[found.end() :]
    return text[: found.start()] + " " * len(found.group()) + behind, found.group().strip()


def _is_small(exact: sp.Expr) -> bool:
    """Tell whether a number can be worked out at once: no power in it is a tower."""
    exponents = [power.exp for power in exact.atoms(sp.Pow)] + [power.exp for power in exact.atoms(sp.exp)]
    return all(
        isinstance(exponent, sp.Rational) and abs(exponent.p) <= _GREATEST_EXPONENT * exponent.q
        for exponent in exponents
    )


def _rounds(exact: sp.Expr, found: re.Match[str]) -> bool:
    """Tell whether a number is an exact one to its last figure, rounded there or cut."""
    figures = re.sub(r"\{?,\}?", ".", found["number"].replace("−", "-"))
    unit = sp.pi / 180 if found["degrees"] else sp.S.One
    last = sp.Rational(1, 10 ** len(figures.partition(".")[2]))
    beyond = sp.N(sp.Abs(exact / unit) - abs(sp.Rational(figures)), 30)
    same_sign = bool((exact >= 0) == (sp.Rational(figures) >= 0))
    return same_sign and bool(-last / 2 <= beyond) and bool(beyond < last)
