r"""Characters and commands of LaTeX: what each is in the grammar, Unicode's letters and figures among them."""

from __future__ import annotations

import unicodedata
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING

from canon.expression.text.tokens import GREEK

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["REMEDIES", "SIGNS", "figure", "letter", "raised_figures", "remedy"]

SIGNS: Mapping[str, str] = MappingProxyType(
    {
        **dict.fromkeys(("+", "-", "−", "–", "\\minus"), "SIGN"),
        **dict.fromkeys(("*", "·", "×", "⋅", "∙", "∗", "•", "\\cdot", "\\times", "\\ast", "\\bullet"), "TIMES"),
        **dict.fromkeys(("/", "∕", "⁄"), "SLASH"),
        "^": "CARET", "_": "UNDER", ",": "COMMA", "\\over": "OVER",
        **dict.fromkeys(("\\binom", "\\tbinom", "\\dbinom"), "FRAC"),
        **dict.fromkeys(("\\frac", "\\tfrac", "\\dfrac", "\\cfrac", "\\nicefrac", "\\sfrac"), "FRAC"),
        **dict.fromkeys(("\\sqrt", "√"), "SQRT"),
        **dict.fromkeys(("=", "<", ">", "≤", "≥", "≠", "\\lt", "\\gt", "\\le", "\\leq", "\\leqslant", "\\ge", "\\geq",
                         "\\geqslant", "\\ne", "\\neq"), "RELATION"),
    }
)  # fmt: skip
"""The terminal of the grammar that each sign is."""

REMEDIES: Mapping[str, str] = MappingProxyType(
    {
        "infty": "an expression is finite; write a bound as a condition without it",
        "pm": "write two claims, one for each sign", "mp": "write two claims, one for each sign",
        "int": "write the integral out", "sum": "write the sum out", "prod": "write the product out",
        "begin": "write one expression", "vec": "write the components", "mathbf": "write the components",
        "boldsymbol": "write the components", "bm": "write the components",
        "dddot": "only first and second rates are read",
        "approx": "write = for an equation", "simeq": "write = for an equation", "propto": "write = for an equation",
        "sim": "write = for an equation", "lg": r"write \log_{10}",
        "nabla": r"write the partial derivatives \frac{\partial V}{\partial x}", "div": "write / or \\frac",
        "\\": "write one equation only", "%": "comments are not read",
        "input": "files are not read", "include": "files are not read", "write": "nothing is written",
        **dict.fromkeys(("def", "newcommand", "let", "gdef", "edef", "renewcommand"), "macros are not read"),
        "left": r"write \left( \right)", "right": r"write \left( \right)",
        "cdots": "write it out", "ldots": "write it out",
        "dots": "write it out", "hbox": r"write \text{…}",
    }
)  # fmt: skip
"""What to write instead of a command."""

_FIGURES = {"½": (1, 2), "⅓": (1, 3), "⅔": (2, 3), "¼": (1, 4), "¾": (3, 4), "⅙": (1, 6), "⅛": (1, 8), "⅜": (3, 8),
            "⅝": (5, 8), "⅞": (7, 8), "⅕": (1, 5), "⅖": (2, 5)}  # fmt: skip
_RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")


def figure(character: str) -> tuple[int, int] | None:
    """Return numerator and denominator of a fraction in one character."""
    return _FIGURES.get(character)


def raised_figures(text: str, at: int, end: int) -> tuple[str, int]:
    """Return the figures of a superscript in Unicode, ``⁻¹``, and where they end; none where no such thing stands."""
    stop = at
    while stop < end and (text[stop] in "⁰¹²³⁴⁵⁶⁷⁸⁹" or (stop == at and text[stop] == "⁻")):
        stop += 1
    figures = text[at:stop].translate(_RAISED)
    return (figures, stop) if figures.lstrip("-") else ("", at)


@cache
def letter(character: str) -> tuple[str, int] | None:
    """Return the plain name and the dots of a letter in Unicode: θ is theta, ẍ is x with two dots; None for any other.

    Examples
    --------
    >>> letter("θ"), letter("ẋ"), letter("𝑥"), letter("²")
    (('theta', 0), ('x', 1), ('x', 0), None)
    """
    if character in ("ℓ", "ℏ", "ħ"):
        return ("ell", 0) if character == "ℓ" else ("hbar", 0)
    if unicodedata.category(character) not in ("Lu", "Ll", "Lo"):
        return None
    base, *marks = unicodedata.normalize("NFKD", character)
    if any(mark not in "\u0307\u0308" for mark in marks):
        return None
    dots = sum(1 if mark == "\u0307" else 2 for mark in marks)
    plain = GREEK.get(character, GREEK.get(base, base))
    return (plain, dots) if plain.isascii() and plain.isalpha() and dots < 3 else None


def remedy(character: str) -> str:
    """Return what to write instead of a character."""
    return {
        "'": "a prime belongs directly after the name of a coordinate",
        ".": "write 0.5 for a decimal",
        "&": "write one equation only",
        "!": "there is no factorial",
        ":": "write / for a quotient",
        ";": "write one equation only",
        "%": "comments are not read",
    }.get(character, "")
