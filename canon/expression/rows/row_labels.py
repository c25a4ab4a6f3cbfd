r"""Labels of rows: the coordinate or the direction of which an equation is, ``x:``, ``$\theta$:``, ``x-direction:``.

``\begin{align} x:\quad & m\ddot x = -kx \\ y:\quad & m\ddot y = -mg \end{align}`` says two equations. A label is a
declared name that stands in its equation as well, or is called a direction; any other declared name is asked about.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.latex.names import stems
from canon.expression.text.tokens import GREEK, LanguageError

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["end_of_label", "without_row_labels"]

_BLANK = r"(?:\s|&|~|\\q?quad(?![A-Za-z])|\\[,;: ])*"
_LETTER = r"(?:\\[A-Za-z]{2,12}|[^\W\d_]{1,12})(?:_(?:\w{1,4}|\{\w{1,4}\}))?"
_CALLED = (
    r"(?:\s?[-‐–]\s?|\s)(?:direction|component|axis|equation|coordinate|part|[Rr]ichtung|[Kk]omponente|[Gg]leichung"
    r"|[Aa]chse|Koordinate|dir\.?|comp\.?|eqn?\.?)"
)
_DIRECTION = (
    r"(?:(?:[Hh]orizontal|[Vv]ertical|[Rr]adial|[Tt]angential|[Tt]ransverse|[Aa]zimuthal|[Aa]ngular|[Nn]ormal)(?:ly|e|er)?"
    r"(?:\s(?:direction|component|equation|part|[Rr]ichtung|[Kk]omponente))?)"
)
_PREFIX = (
    r"(?:\\(?:text|textrm|mathrm)\s?\{\s?(?:[Ff]or|[Ff]ür)\s?\}\s*"
    r"|(?:[Ff]or|[Ii]n(?: the)?|[Aa]long(?: the)?|[Ff]ür)\s+)?"
)
_SAID = (
    rf"(?:\$\s*(?P<a>{_LETTER})\s*\$|\\\(\s*(?P<b>{_LETTER})\s*\\\)|(?P<c>{_LETTER}))(?P<called>{_CALLED})?"
)
_TEXT = (
    rf"\\(?:text|textrm|textbf|textit|mathrm)\s?\{{\s?{_PREFIX}(?P<d>{_LETTER})?(?:\$(?P<e>{_LETTER})\$)?"
    rf"(?P<named>{_CALLED})?\s?(?P<colon>:)?\s?\}}(?(colon)|\s*:(?![:=]))"
)
_LABEL = re.compile(
    rf"{_PREFIX}(?:\$\s*(?P<f>{_LETTER})\s*:\s*\$|{_TEXT}|(?:{_DIRECTION}|{_SAID})\s*:(?![:=])){_BLANK}"
    r"(?=(?P<rest>(?:\\[:;,]|\\\\(?=\[)|[^:;,\n=\\]|\\[^\\:;,\n])+?(?<![<>!:])=))"
)
_ENDS = re.compile(r"\n|\\\\|(?<!\\);")
_ENVIRONMENT = r"\\begin\{[a-z]{4,12}\*?\}(?:\{[lcr|@{} \d]{1,20}\})?"
_LAID_OUT = rf"(?:\s|&|{_ENVIRONMENT})*"
_ROW = re.compile(
    rf"(?:^|\n|\\\\|(?<!\\);|{_ENVIRONMENT}){_LAID_OUT}(?:\$\$|\\\[|\\\(|\$(?=\s*{_LETTER}\s*:))?{_LAID_OUT}"
)


def without_row_labels(text: str, scope: Scope) -> str:
    r"""Return a text with blanks for the labels before its equations, as long as it was.

    Raises
    ------
    LanguageError
        Where a declared name and a colon stand before an equation in which the name is not.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({"x": coordinates("x"), "y": coordinates("y")})
    >>> without_row_labels(r"x:\quad & \ddot x = 0 \\ y:\quad & \ddot y = 1", scope)
    '          \\ddot x = 0 \\\\          \\ddot y = 1'
    >>> without_row_labels("x-direction: x'' = 0", scope), without_row_labels("x: 1, y: 2", scope)
    ("             x'' = 0", 'x: 1, y: 2')
    """
    if ":" not in text or "=" not in text:
        return text
    signs = [*text]
    at = 0
    while at <= len(text) and (row := _ROW.search(text, at)):
        end = end_of_label(text, scope, row.end())
        if end > row.end():
            signs[row.end() : end] = " " * (end - row.end())
        at = max(end, row.end(), row.start() + 1)
    return "".join(signs)


def end_of_label(text: str, scope: Scope, begin: int = 0) -> int:
    """Return where the label before an equation ends; where it begins if there is none.

    Raises
    ------
    LanguageError
        Where a declared name and a colon stand before an equation in which the name is not.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> end_of_label("x-direction: y = 1", Scope()), end_of_label("a: b = 1", Scope())
    (13, 0)
    """
    found = _LABEL.match(text, begin)
    if found is None:
        return begin
    name = next((found[each] for each in "abcdef" if found[each]), "")
    declared = any(map(scope.declares, _names(name)))
    if not name or ((found["called"] or found["named"]) and (declared or _is_one_letter(name))):
        return found.end()
    if not declared:
        return begin
    if _stands_in(name, _ENDS.split(text[found.start("rest") :], maxsplit=1)[0]):
        return found.end()
    shown = f"{found.group().partition(':')[0].strip()}:"
    reason = f"is {shown} the label of this equation, or does it say {name}?"
    raise LanguageError(text, begin + 1, reason, "leave the label out, or write one equation in a row")


def _is_one_letter(name: str) -> bool:
    """Tell whether a name is one letter, Greek ones spelled out; a word may deny what follows."""
    return len(name) == 1 or name.lstrip("\\") in GREEK.values()


def _names(name: str) -> tuple[str, ...]:
    """Return what a name may be declared as."""
    bare = name.lstrip("\\")
    stem, _, index = bare.partition("_")
    index = index.strip("{}")
    letters = (stem, GREEK.get(stem, stem), *stems(stem))
    return tuple(f"{letter}{gap}{index}" for letter in letters for gap in (("_", "") if index else ("",)))


def _stands_in(name: str, rest: str) -> bool:
    """Tell whether a name stands in an equation, in any spelling of its letter."""
    bare = name.lstrip("\\").partition("_")[0]
    spelled = {bare, GREEK.get(bare, bare), *(sign for sign, word in GREEK.items() if word == bare)}
    return any(each in rest for each in spelled)
