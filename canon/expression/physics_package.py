r"""Derivatives in the shorthand of LaTeX's packages physics and derivative: ``\dv{x}{t}``, ``\pdv[2]{V}{x}``."""

from __future__ import annotations

import re

from canon.expression.text.tokens import MAX_CHARACTERS

__all__ = ["written_out"]

_BRACED = r"\s{0,9}\{((?:[^{}]|\{(?:[^{}]|\{[^{}]{0,99}\}){0,99}\}){0,200})\}"
_DERIVATIVE = re.compile(
    rf"\\(odv|pdv|dv|partialderivative|derivative|diffp|diff|od|pd)(?=\s{{0,9}}[\[{{])\s{{0,9}}(?:\[\s{{0,9}}([1-9])\s{{0,9}}\])?"
    rf"{_BRACED}(?:{_BRACED})?(?:{_BRACED})?"
)
_MOST = 4
"""Most derivatives of which one holds the next."""


def written_out(text: str) -> str:
    r"""Return a text with its derivatives as fractions.

    Examples
    --------
    >>> print(written_out(r"\dv{t}\pdv{L}{\dot x} = \pdv{L}{x}"))
    \frac{d}{dt}\frac{\partial L}{\partial \dot x} = \frac{\partial L}{\partial x}
    >>> print(written_out(r"\dv[2]{x}{t}, \pdv{F}{q}{t}"))
    \frac{d^{2}x}{dt^{2}}, \frac{\partial^{2}F}{\partial q\partial t}
    """
    if "\\" not in text or len(text) > MAX_CHARACTERS:  # the parser refuses so long a text
        return text
    for _ in range(_MOST):
        text, found = _DERIVATIVE.subn(_fraction, text)
        if not found:
            break
    return text


def _fraction(found: re.Match[str]) -> str:
    """Return a derivative as a fraction: of its first argument with respect to the others, or of what follows."""
    word, order, first, *others = found.groups()
    variables = [other for other in others if other is not None]
    of, variables = (first, variables) if variables else ("", [first])
    mark = "\\partial" if word.startswith("p") or word == "diffp" else "d"
    power = order or (str(len(variables)) if variables[1:] else "")
    raised = f"^{{{power}}}" if power else ""
    below = "".join(f"{_beside(mark, name)}{f'^{{{order}}}' if order else ''}" for name in variables)
    return rf"\frac{{{_beside(mark + raised, of)}}}{{{below}}}"


def _beside(mark: str, name: str) -> str:
    """Return a mark and what stands behind it, with a blank where a word of letters would run into the next."""
    name = name.strip()
    return f"{mark} {name}" if mark[-1:].isalpha() and mark != "d" and name else f"{mark}{name}"
