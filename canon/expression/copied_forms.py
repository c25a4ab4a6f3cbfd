r"""Copied forms: what editors of formulas, type systems and keyboards write for what this language has another way for.

``\mathop x\limits^{..}`` and ``\frac{{{d^2}x}}{{d{t^2}}}`` of MathType, ``dot.double(x)`` of Typst, ``qⁿ⁻¹`` in small
letters, ``(m r² φ')' = 0`` with a prime on a bracket, ``D(D(x)) ~ -x`` of ModelingToolkit.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.text.notation import is_latex
from canon.expression.text.tokens import MAX_CHARACTERS

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["plainly_formed"]

_NAME = r"(?:\\[A-Za-z]{1,12}|[A-Za-z])"
_DOTS = r"(?P<dots>\.{1,2}|\\cdot|\\cdot\s?\\cdot)"
_ABOVE = re.compile(
    rf"\\mathop\s{{0,3}}\{{?\s?(?P<a>{_NAME})\s?\}}?\s{{0,3}}\\limits\s?\^\s?\{{\s?{_DOTS}\s?\}}"
    rf"|\\(?:overset|stackrel)\s?\{{\s?{_DOTS.replace('dots', 'more')}\s?\}}\s?\{{\s?(?P<b>{_NAME})\s?\}}"
)
"""Dots that are set above a letter by hand."""
_DOUBLED = re.compile(r"\{\s?\{([^{}]{0,400})\}\s?\}")
_RAISED_D = re.compile(r"\{\s?((?:d|\\partial)\s?\^\s?[2-4])\s?\}(?=\s?\\?[A-Za-z])")
_RAISED_T = re.compile(
    r"(?<=[d{])\s?\{\s?([A-Za-z]\s?\^\s?[2-4])\s?\}|(?<=\\partial)\s?\{\s?([A-Za-z]\s?\^\s?[2-4])\s?\}"
)
"""MathType's braces around each power."""
_TYPST = re.compile(r"(?<![\w.\\])dot(?P<two>\.double)?\(\s?(?P<name>[^\W\d_]\w{0,15})\s?\)")
_SMALL = dict(
    zip(
        "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁽⁾ⁿⁱᵃᵇᶜᵈᵉᶠᵍʰʲᵏˡᵐᵒᵖʳˢᵗᵘᵛʷˣʸᶻᵝᵞᵟᶿᵠᵡ",
        [*"0123456789+-()niabcdefghjklmoprstuvwxyz", "beta", "gamma", "delta", "theta", "phi", "chi"],
        strict=True,
    )
)
"""Small raised characters, of which an exponent is made."""
_RAISED = re.compile(rf"(?<=[\w)\]}}])[{''.join(_SMALL)}]{{1,12}}")
_FIGURES = re.compile(r"[⁺⁻]?[⁰¹²³⁴-⁹]+|⁻?ⁿ")
"""What the language has by itself."""
_ON_BRACKET = re.compile(r"\)(?:'|′|˙|\u0307)(?!['′˙\u0307\w(^*²³])")
_BEFORE_BRACKET = re.compile(r"(?:^|[=+\-−;,(|\n])\s*$")
_MOVES = re.compile(r"['′˙¨\u0307\u0308]|\\d?dot(?![A-Za-z])|[ẋẏżṙẍ]|_d?dot(?!\w)|d\w{1,9}\s?/\s?dt")
_TILDE = re.compile(r"(?<=\s)~(?=\s)")
_JULIA = re.compile(r"(?<!\w)D\(\s?(?P<two>D\(\s?)?(?P<name>[^\W\d_]\w{0,15})\s?\)(?(two)\s?\))")


def plainly_formed(text: str, scope: Scope) -> str:
    r"""Return a text without the forms of editors and type systems; it may be longer then.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> plainly_formed(r"m\overset{..}{x}", Scope()), plainly_formed("n·qⁿ⁻¹", Scope()), plainly_formed("x²", Scope())
    ('m\\ddot{x}', 'n·q^(n-1)', 'x²')
    >>> plainly_formed("(r² φ')' = 0", Scope()), plainly_formed("V(φ')' = 0", Scope())
    ("d/dt(r² φ') = 0", "V(φ')' = 0")
    """
    if len(text) > MAX_CHARACTERS:
        return text
    if is_latex(text):
        return _of_mathtype(text) if "\\" in text else text
    text = _RAISED.sub(_exponent, text)
    if "dot." in text and not scope.declares("dot"):
        text = _TYPST.sub(lambda found: found["name"] + "'" * (2 if found["two"] else 1), text)
    if not (scope.declares("d") or "d" in scope.functions):
        text = _without_primes_on_brackets(text)
    equal = "=" not in text and len(_TILDE.findall(text)) == 1
    if not equal or not _JULIA.search(text) or scope.declares("D") or "D" in scope.functions:
        return text
    return _TILDE.sub("=", _JULIA.sub(lambda found: found["name"] + "'" * found.group().count("D("), text))


def _of_mathtype(text: str) -> str:
    r"""Return LaTeX with ``\ddot`` for dots that are set by hand, and without doubled braces around derivatives."""
    if "\\mathop" in text or "\\overset" in text or "\\stackrel" in text:
        text = _ABOVE.sub(_accented, text)
    if "{{" in text.replace(" ", ""):
        for _ in range(3):
            text = _DOUBLED.sub(r"{\1}", _RAISED_T.sub(r" \1\2", _RAISED_D.sub(r"\1 ", text)))
    return text


def _accented(found: re.Match[str]) -> str:
    dots = found["dots"] or found["more"]
    two = dots.count(".") + dots.count("\\") == 2
    return rf"\{'d' * two}dot{{{found['a'] or found['b']}}}"


def _exponent(found: re.Match[str]) -> str:
    """Return an exponent in small letters in brackets; figures alone stay as they are."""
    small = found.group()
    if _FIGURES.fullmatch(small) or not any(_SMALL[each][0].isalpha() for each in small):
        return small
    return f"^({''.join(_SMALL[each] for each in small)})"


def _without_primes_on_brackets(text: str) -> str:
    """Return a text with ``d/dt(…)`` for a bracket with a prime or a dot that holds a rate and is no argument."""
    for _ in range(4):
        places = [*_ON_BRACKET.finditer(text)]
        made = next(
            (new for found in places if (new := _derived(text, found.start(), found.end())) != text), text
        )
        if made == text:
            break
        text = made
    return text


def _derived(text: str, close: int, end: int) -> str:
    depth = 0
    for at in range(close, -1, -1):
        depth += (text[at] == ")") - (text[at] == "(")
        if depth == 0:
            inside = text[at : close + 1]
            apart = _BEFORE_BRACKET.search(text[:at]) and _MOVES.search(inside)
            return f"{text[:at]}d/dt{inside}{text[end:]}" if apart else text
    return text
