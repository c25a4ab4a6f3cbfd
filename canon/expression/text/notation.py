"""Notation of a text: LaTeX or the plain language, and where its brackets close."""

from __future__ import annotations

import re

__all__ = ["closing_of", "is_latex"]

_IS_LATEX = re.compile(r"[$∫∑∏]|\\(?:[A-Za-z]|[(\\{|,;:! ]|\[(?![A-Z][A-Za-z]{1,20}\]))|[\^_]\{")


def is_latex(text: str) -> bool:
    r"""Tell whether a text is LaTeX.

    It is where it holds a dollar, a command such as ``\theta``, ``^{`` or ``_{``, or the sign of an integral or a sum.

    Plain text has none of these; ``\[Theta]`` is Mathematica's.

    Examples
    --------
    >>> is_latex(r"\frac12 m \dot x^2"), is_latex("x^{2}"), is_latex("m*x_dot**2/2")
    (True, True, False)
    """
    return _IS_LATEX.search(text) is not None


def closing_of(text: str, begin: int) -> int | None:
    """Return where the bracket that opens at a place closes, of whatever kind those inside are; None where it does not.

    Examples
    --------
    >>> closing_of("f(a[b]) + (c)", 1), closing_of("(a", 0)
    (6, None)
    """
    depth = 0
    for at in range(begin, len(text)):
        depth += (text[at] in "([{") - (text[at] in ")]}")
        if depth == 0:
            return at
    return None
