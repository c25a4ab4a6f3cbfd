r"""Macros that a writer of LaTeX makes, ``\newcommand{\w}{\omega}`` and ``\def\w{\omega}``, and labelled braces.

A macro is written out behind its definition as TeX does it: its letters stand where its name stood. Where TeX would
take but the first of them, ``x^\w`` with ``\w`` for a product, nothing is written out, and the macro is told.
``\underbrace{a + b}_{T}`` is a + b where nothing beside it could be meant for the whole of it.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.latex.names import FUNCTIONS, stems
from canon.expression.prose import is_prose
from canon.expression.remarks import says_nothing
from canon.expression.text.tokens import MAX_CHARACTERS

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["without_macros"]

_MOST = 8
"""Most macros in one field."""
_MOST_USES = 24
"""Most uses of each."""
_LONGEST = 4_000
"""Characters of a text that is written out."""
_INSIDE = r"(?:[^{}\\]|\\.|\{(?:[^{}\\]|\\.|\{(?:[^{}\\]|\\.|\{(?:[^{}\\]|\\.)*\})*\})*\}){0,400}"
_DEFINITION = re.compile(
    r"\\(?:(?:re)?newcommand|providecommand)\s?\*?\s?(?:\{\s?(?P<a>\\[A-Za-z]{1,20})\s?\}|(?P<b>\\[A-Za-z]{1,20}))"
    rf"\s?(?:\[(?P<number>[1-3])\])?\s?\{{(?P<meaning>{_INSIDE})\}}"
    rf"|\\def\s?(?P<c>\\[A-Za-z]{{1,20}})\s?\{{(?P<other>{_INSIDE})\}}"
)
_KNOWN = (
    "frac",
    "dfrac",
    "tfrac",
    "dot",
    "ddot",
    "sqrt",
    "cdot",
    "times",
    "left",
    "right",
    "text",
    "mathrm",
    "partial",
)
_ARGUMENT = re.compile(rf"\s*(?:\{{(?P<braced>{_INSIDE})\}}|(?P<token>\\[A-Za-z]+|[A-Za-z0-9]))")
_ONE_TOKEN = re.compile(r"\s*(?:[A-Za-z0-9]|\\[A-Za-z]+)\s*")
_SCRIPT = re.compile(r"[\^_]\s*$")
_WANTS_ARGUMENT = re.compile(
    r"\\(?:[dtc]?frac\s*(?:\{[^{}]{0,99}\}|\\[A-Za-z]+|[A-Za-z0-9])?|sqrt|d{0,2}dot|vec|hat|bar|tilde|mathbf|boldsymbol|mathrm)"
    r"\s*$"
)
"""Before what would be the argument of another command."""
_BRACE = re.compile(
    rf"\\(?P<side>under|over)brace\s?\{{(?P<inside>{_INSIDE})\}}\s?(?P<script>[_^])\s?(?:\{{(?P<label>{_INSIDE})\}}|(?P<letter>[A-Za-z]))"
)
_NAME = re.compile(
    r"[\s=]{0,4}(?P<letter>[A-Za-z]|\\[A-Za-z]{2,12})"
    r"(?P<index>_(?:\w|\{\s?(?:\\(?:text|mathrm)\s?\{\s?)?(?:\w{1,4}|trans)\s?\}?\s?\}))?(?:\^(?:2|\{2\}))?\s?"
)
"""A name of the writer's own, and its square."""
_WORDS = re.compile(r"\s?\\(?:text|mathrm|textrm|mbox)\s?\{\s?(?P<words>[^{}\\$=]{1,40})\}\s?")
_TAKES_MORE = re.compile(
    rf"\\(?:{'|'.join(sorted(FUNCTIONS, key=len, reverse=True))}|operatorname|partial)(?![A-Za-z])|[/^_]\s*$|\bd\b"
)
"""What may take a factor behind the brace for its argument."""
_SIGNED = re.compile(r"\s*[-+−]")
_OPEN_BEFORE = re.compile(r"(?:^|[=(\[{&+$,]|\\left\s?[(\[])\s*$")
_FREE_BEFORE = re.compile(
    r"(?:[\^_]|\\(?!(?:q?quad|cdot|times|left|right|,|;|:|!| )(?![A-Za-z]))[A-Za-z]+)\s*$"
)
"""What would take a brace for its argument."""
_FREE_BEHIND = re.compile(r"(?:\s|\\[,;: ]|\\q?quad)*(?:$|[=)\]}&+\-−$.,;]|\\right|\\\\)")


def without_macros(text: str, scope: Scope) -> str:
    r"""Return a text with the macros that it defines written out, and without labels below and above braces.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> print(without_macros(r"\def\w{\omega}$\ddot x + \w^2 x = 0$", Scope()).strip())
    $\ddot x + \omega^2 x = 0$
    >>> print(without_macros(r"\newcommand{\dv}[2]{\frac{d #1}{d #2}}\dv{x}{t}", Scope()).strip())
    \frac{d x}{d t}
    >>> print(without_macros(r"\underbrace{a+b}_{T} - \underbrace{c}_{V}, 2\underbrace{a+b}_T", Scope()))
     a+b  -  c , 2\underbrace{a+b}_T
    """
    if len(text) > MAX_CHARACTERS or "\\" not in text:
        return text
    if "command" in text or "\\def" in text:
        text = _written_out(text)
    for _ in range(_MOST * ("brace" in text)):
        made = next((new for found in _BRACE.finditer(text) if (new := _unlabelled(found, scope))), "")
        if not made:
            break
        text = made
    return text


def _written_out(text: str) -> str:
    """Return a text with its macros written out, the first of them first; one that can't be stays."""
    names: set[str] = set()
    for _ in range(_MOST):
        found = _DEFINITION.search(text)
        if found is None or len(text) > _LONGEST:
            break
        name = found["a"] or found["b"] or found["c"]
        meaning = found["meaning"] if found["meaning"] is not None else found["other"]
        twice = name in names or re.search(rf"\\{name[1:]}(?![A-Za-z])", meaning)
        if twice or not _is_free(name[1:], meaning.strip()):
            return text
        names.add(name)
        rest = _used(text[found.end() :], name, meaning.strip(), int(found["number"] or 0))
        if rest is None:
            return text
        text = text[: found.start()] + " " * (found.end() - found.start()) + rest
    return text


def _is_free(name: str, meaning: str) -> bool:
    r"""Tell whether a command has no other meaning, or is another form of its letter, ``\varphi`` for ``\phi``."""
    return not (name in FUNCTIONS or name in _KNOWN or stems(name)) or meaning.lstrip("\\") in stems(name)


def _used(text: str, name: str, meaning: str, number: int) -> str | None:
    """Return what follows a definition with the macro written out; None where that can't be done."""
    use = re.compile(rf"\\{name[1:]}(?![A-Za-z])\s*")
    begin = 0
    for _ in range(_MOST_USES + 1):
        found = use.search(text, begin)
        if found is None:
            return text
        made, end = _with_arguments(text, found.end(), meaning, number)
        before = text[: found.start()]
        if made is None or (_SCRIPT.search(before[-9:]) and not _ONE_TOKEN.fullmatch(made)):
            return None
        if not _ONE_TOKEN.fullmatch(made) and _WANTS_ARGUMENT.search(before[-140:]):
            made = f"{{{made}}}"
        gap = " " if re.search(r"\\[A-Za-z]+$", made) and text[end : end + 1].isalpha() else ""
        text = f"{before}{made}{gap}{text[end:]}"
        begin = len(before) + len(made)
    return None


def _with_arguments(text: str, end: int, meaning: str, number: int) -> tuple[str | None, int]:
    """Return the meaning of a macro with its arguments, and where they end; None where one is missing."""
    for place in range(1, number + 1):
        argument = _ARGUMENT.match(text, end)
        if argument is None:
            return None, end
        end = argument.end()
        said = argument["braced"] if argument["braced"] is not None else argument["token"]
        meaning = meaning.replace(f"#{place}", said)
    return meaning, end


def _unlabelled(found: re.Match[str], scope: Scope) -> str:
    """Return a text without one brace and its label; empty where the label says more, or the whole of it is meant."""
    text, inside = found.string, found["inside"]
    before, behind = text[: found.start()], text[found.end() :]
    is_label = (found["side"] == "under") == (found["script"] == "_")
    if not is_label or not _names_only(found["label"] or found["letter"], scope) or "brace" in inside:
        return ""
    if _FREE_BEFORE.search(before[-30:]) or (before[-1:].isdigit() and inside.lstrip()[:1].isdigit()):
        return ""
    signed = _SIGNED.match(inside) is not None
    ends = _FREE_BEHIND.match(behind) or re.match(r"\s*\\(?:under|over)brace\s?\{\s*[-+−]", behind)
    if _has_sum(inside.strip()[1:] if signed else inside):
        whole = ends and (signed or _OPEN_BEFORE.search(before))
    else:
        whole = ends or not (_TAKES_MORE.search(inside) or re.match(r"\s*[\^_']", behind))
    return f"{before} {inside} {behind}" if whole and "=" not in inside else ""


def _names_only(label: str, scope: Scope) -> bool:
    """Tell whether a label is a name that is not declared, or words that say nothing."""
    if words := _WORDS.fullmatch(label):
        return says_nothing(words["words"], scope) or is_prose(words["words"].split(), scope)
    name = _NAME.fullmatch(label)
    if name is None or (name["letter"][0] == "\\" and not stems(name["letter"][1:])):
        return False
    letters = stems(name["letter"][1:]) or (name["letter"],)
    index = re.sub(r"\\(?:text|mathrm)|[\s{}_]", "", name["index"] or "")
    return not any(
        scope.declares(f"{letter}{gap}{index}") for letter in letters for gap in ("", "_" * bool(index))
    )


def _has_sum(inside: str) -> bool:
    """Tell whether a sign stands outside brackets behind something."""
    depth = 0
    for at, sign in enumerate(inside):
        depth += (sign in "([{") - (sign in ")]}")
        if depth == 0 and sign in "+-−=" and inside[:at].strip():
            return True
    return False
