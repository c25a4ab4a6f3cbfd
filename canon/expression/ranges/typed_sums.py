"""Typed sums: ``sum_{i=1}^{3} I_i w_i^2`` and ``Σ_i m_i x_i'^2`` without LaTeX, made the calls that programs write.

A sum goes to the next plus, minus or sign of equality outside brackets; where its index goes on behind that, it is left
alone. Without bounds the index runs over the numbers with which all of its names are declared, ``m1, m2, m3``.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.text.declared_names import key_of
from canon.expression.text.tokens import MAX_CHARACTERS, LanguageError, tokens

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["with_sums"]

_SUM = re.compile(
    r"(?:[∑Σ](?P<f>[ᵢⱼₖₙ])|(?:[∑Σ]|(?<![\w\\])[Ss]um)\s?_\s?(?:"
    r"(?:\{\s?(?P<a>[a-z])\s?=\s?(?P<from>\d)\s?\}|\(\s?(?P<b>[a-z])\s?=\s?(?P<begin>\d)\s?\)|(?P<c>[a-z])=(?P<one>\d))"
    r"\s?\^\s?(?:\{\s?(?P<upto>\d)\s?\}|\(\s?(?P<end>\d)\s?\)|(?P<last>\d)(?!\d))"
    r"|\{\s?(?P<d>[a-z])\s?\}|(?P<e>[a-z])))(?![\w^=])"
)
_SMALL = dict(zip("ᵢⱼₖₙ", ("_i", "_j", "_k", "_n"), strict=True))
_BOUNDS = (("from", "begin", "one"), ("upto", "end", "last"))
_OPEN, _CLOSE = "([{", ")]}"
_MOST = 9
_MOST_SUMS = 8


def with_sums(text: str, scope: Scope) -> str:
    """Return a text with ``Sum(…, (i, 1, 3))`` for the sums that are typed in it; it is longer then.

    Examples
    --------
    >>> from canon import parameters
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({s.name: s for s in parameters("I1 I2 w1 w2")})
    >>> with_sums("Σ_i I_i w_i^2 = 2T", scope), with_sums("sum_{i=1}^2 I_i + w_1", scope)
    ('(Sum(I_i w_i^2, (i, 1, 2))) = 2T', '(Sum(I_i, (i, 1, 2))) + w_1')
    >>> with_sums("Σ_i I_i + w_i", scope), with_sums("Σ_i x_i", scope)
    ('Σ_i I_i + w_i', 'Σ_i x_i')
    """
    if len(text) > MAX_CHARACTERS or "\\" in text or "$" in text or not _SUM.search(text):
        return text
    if any(scope.declares(name) or name in scope.functions for name in ("sum", "Sum", "Sigma")):
        return text
    at = 0
    for _ in range(_MOST_SUMS):
        found = _SUM.search(text, at)
        if found is None:
            return text
        end = _end(text, found.end())
        made = _made(found, text[found.end() : end], text[end:], scope)
        text = f"{text[: found.start()]}{made or text[found.start() : end]}{text[end:]}"
        at = found.start() + len(made) if made else found.end()
    return text


def _made(found: re.Match[str], body: str, rest: str, scope: Scope) -> str:
    """Return the call of one sum; nothing where its index goes on behind it, or has no range."""
    index = next(found[name] for name in "abcdef" if found[name])
    index = _SMALL.get(index, index).lstrip("_")
    body = "".join(_SMALL.get(sign, sign) for sign in body).strip()
    goes_on = re.match(r"[^=;,\n]{0,2000}", rest)
    if goes_on and _of_index(index, goes_on.group()):
        return ""
    first, last = (next((found[n] for n in names if found[n]), "") for names in _BOUNDS)
    names = _of_index(index, body)
    bounds = _declared(names, int(first), int(last), scope) if first else _all_declared(names, scope)
    if not body or bounds is None:
        return ""
    return f"(Sum({body}, ({index}, {bounds[0]}, {bounds[1]}))) "


def _of_index(index: str, text: str) -> list[str]:
    """Return the names in a text that have an index."""
    small = next((sign for sign, plain in _SMALL.items() if plain == f"_{index}"), "(?!)")
    return re.findall(rf"(?<![^\W\d_])([^\W\d_ᵢⱼₖₙ]{{1,12}})(?:_\{{?{index}(?![A-Za-z0-9_])|{small})", text)


def _declared(names: list[str], first: int, last: int, scope: Scope) -> tuple[int, int] | None:
    """Return two bounds if every name is declared with all numbers between them; None otherwise."""
    known = {key_of(name) for name in scope.spelled}
    wanted = [key_of(f"{_plain(name)}{i}") for name in names for i in range(first, last + 1)]
    return (first, last) if wanted and all(each in known for each in wanted) else None


def _all_declared(names: list[str], scope: Scope) -> tuple[int, int] | None:
    """Return from where to where all names are declared with numbers; None where they differ in that."""
    known = {key_of(name) for name in scope.spelled}
    ends = {tuple(i for i in range(_MOST + 1) if key_of(f"{_plain(name)}{i}") in known) for name in names}
    last = len(max(ends, default=()))
    return (1, last) if last > 1 and ends == {tuple(range(1, last + 1))} else None


def _plain(name: str) -> str:
    try:
        return tokens(name)[0].text
    except LanguageError:
        return name


def _end(text: str, begin: int) -> int:
    """Return where the term behind a sum ends."""
    depth = 0
    for at in range(begin, len(text)):
        sign = text[at]
        depth += (sign in _OPEN) - (sign in _CLOSE)
        between = sign in "+-−" and text[begin:at].strip() and not _is_raised(text, at)
        if depth < 0 or (depth == 0 and (sign in "=;,\n<>" or between)):
            return at
    return len(text)


def _is_raised(text: str, at: int) -> bool:
    return text[:at].rstrip().endswith(("^", "**", "*", "/"))
