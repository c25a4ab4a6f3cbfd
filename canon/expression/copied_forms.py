r"""Copied forms: what editors of formulas, type systems and keyboards write for what this language has another way for.

``\mathop x\limits^{..}`` and ``\frac{{{d^2}x}}{{d{t^2}}}`` of MathType, ``dot.double(x)`` of Typst, ``qⁿ⁻¹`` in small
letters, ``(m r² φ')' = 0`` with a prime on a bracket, ``D(D(x)) ~ -x`` of ModelingToolkit.
"""

from __future__ import annotations

import re
import unicodedata
from typing import TYPE_CHECKING

from canon.expression.text.declared_names import Words
from canon.expression.text.notation import is_latex
from canon.expression.text.tokens import MAX_CHARACTERS
from canon.expression.written_rates import has_rate

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["plainly_formed"]

_LONGEST = 2_000
"""Characters of a text in which primes on brackets are looked for."""
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
_DOLLARS = re.compile(r"\s*\$[^$∫∑∏{]{1,2000}\$[\s.]*")
"""One formula in dollars, which is Typst's as well, with nothing in it that only LaTeX has."""
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
_DOTTED = re.compile(r"[˙¨\u0307\u0308ẋẏżṙẍ]|_d?dot(?!\w)|d\w{1,9}\s?/\s?dt")
_PRIMED = re.compile(r"(?P<run>[^\W\d_]{1,12}(?:_\w{1,6})?)['′]")
_TILDE = re.compile(r"(?<=\s)~(?=\s)")
_JULIA = re.compile(r"(?<!\w)D\(\s?(?P<two>D\(\s?)?(?P<name>[^\W\d_]\w{0,15})\s?\)(?(two)\s?\))")


def plainly_formed(text: str, scope: Scope) -> str:
    r"""Return a text without the forms of editors and type systems; it may be longer then.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> plainly_formed(r"m\overset{..}{x}", Scope()), plainly_formed("eᵗ⁺¹", Scope()), plainly_formed("xᵃ", Scope())
    ('m\\ddot{x}', 'e^(t+1)', 'xᵃ')
    >>> plainly_formed("(r² φ̇)˙ = 0", Scope()), plainly_formed("V(φ̇)˙ = 0", Scope())
    ('d/dt(r² φ̇) = 0', 'V(φ̇)˙ = 0')
    """
    if len(text) > MAX_CHARACTERS:
        return text
    if is_latex(text):
        if "\\" in text:
            return _of_mathtype(text)
        if not (_TYPST.search(text) and _DOLLARS.fullmatch(text)) or scope.declares("dot"):
            return text
        text = text.replace("$", " ")
    text = _RAISED.sub(lambda found: _exponent(found.group(), scope), text)
    if "dot." in text and not scope.declares("dot"):
        text = _TYPST.sub(lambda found: found["name"] + "'" * (2 if found["two"] else 1), text)
    if len(text) <= _LONGEST and not (scope.declares("d") or "d" in scope.functions):
        text = _without_primes_on_brackets(text, Words(text, scope))
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


def _exponent(small: str, scope: Scope) -> str:
    """Return an exponent in small letters in brackets; figures alone, and indices that are not declared, stay."""
    letters = [_SMALL[each] for each in small if _SMALL[each][0].isalpha()]
    if _FIGURES.fullmatch(small) or not letters or not all(map(scope.declares, letters)):
        return small
    return f"^({''.join(_SMALL[each] for each in small)})"


def _without_primes_on_brackets(text: str, words: Words) -> str:
    """Return a text with ``d/dt(…)`` for a bracket with a prime or a dot that holds a rate and is no argument."""
    for _ in range(4):
        places = [*_ON_BRACKET.finditer(text)]
        made = next(
            (new for found in places if (new := _derived(text, found.start(), found.end(), words)) != text),
            text,
        )
        if made == text:
            break
        text = made
    return text


def _moves(inside: str, words: Words) -> bool:
    """Tell whether the rate of a coordinate stands in a bracket; V' of a function is none."""
    runs = [found["run"] for found in _PRIMED.finditer(inside)]
    primed = any(has_rate(run, words) or has_rate(run[-1], words) for run in runs)
    return primed or _DOTTED.search(unicodedata.normalize("NFD", inside)) is not None


def _derived(text: str, close: int, end: int, words: Words) -> str:
    depth = 0
    for at in range(close, -1, -1):
        depth += (text[at] == ")") - (text[at] == "(")
        if depth == 0:
            inside = text[at : close + 1]
            apart = _BEFORE_BRACKET.search(text[:at]) and _moves(inside, words)
            return f"{text[:at]}d/dt{inside}{text[end:]}" if apart else text
    return text
