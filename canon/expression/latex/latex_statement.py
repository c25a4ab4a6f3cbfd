r"""Statements in LaTeX: a field taken apart at ``\\``, ``\Rightarrow``, commas between equations, and equality signs.

Nothing is read here; each side keeps its columns. A row of a display that begins with ``=`` or with a sign goes on with
the row before.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.expression.latex.latex_layout import CASES, PART, ROW, without_layout
from canon.expression.text.statement import NAME_BEFORE_SIGN, Side, Statement, opened, unwrapped
from canon.expression.text.tokens import LanguageError

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["Span", "latex_statements", "spans", "spelled_plainly"]

MAX_SIDES = 100
"""Most sides in one field."""
_SEEN = 60
"""Characters that are looked at on either side of a cut."""
_ARROWS = "Rightarrow|Longrightarrow|implies|iff|Leftrightarrow|Longleftrightarrow|therefore|rightarrow|longrightarrow"
_UPRIGHT = r"\\(?:text|textrm|mbox|mathrm|textit)\s*\{[\s,;~]*"
_JOINING = rf"{_UPRIGHT}(?:and|und|et|where|with|mit|wobei|avec|où)[\s,;:~]*\}}"
"""Words between statements."""
_BETWEEN = rf"(?:{_JOINING}|{_UPRIGHT}(?:thus|so|hence|then|i\.e\.)[\s,;:~]*\}})"
"""The same, and those of a conclusion."""
_TOKEN = re.compile(
    r"\\(?:begin|end)\s*\{\s*d?cases\s*\}"
    rf"|\\(?:{_ARROWS})(?![A-Za-z])"
    rf"|{_BETWEEN}|(?<=[\s,.;])(?:and|where|with)(?=[\s,:])"
    r"|\\(?:stackrel|overset)\s*\{[^{}]{0,20}\}\s*\{\s*=\s*\}"
    r"|\\(?:equiv|coloneqq|triangleq|doteq|q?quad|left|right|lbrace|rbrace)(?![A-Za-z])|\\[A-Za-z]+|\\.|:=|[=<>!]=|[-\w⇒∴=≡(){}\[\],;\n"
    + ROW
    + PART
    + "]",
    re.DOTALL,
)
_OPENS, _CLOSES = ("(", "[", "{", "\\{", "\\lbrace"), (")", "]", "}", "\\}", "\\rbrace")
_EQUALS = ("=", ":=", "==", "≡", "\\equiv", "\\coloneqq", "\\triangleq", "\\doteq")
_CONTINUES = re.compile(
    r"(?:\s|\\q?quad|\\[,;:! ]|[{}])*"
    r"(?:=|[-+−*/·×)\]^]|\\(?:equiv|cdot|times|right|[lg]eq?|approx|simeq)(?![A-Za-z])|[<>])"
)
_GOES_ON = re.compile(
    r"(?:=|[-+−*/·×(\[]|\\(?:equiv|cdot|times|left\s*[(\[])(?![A-Za-z]))(?:\s|\\q?quad|\\[,;:! ])*$"
)
_RELATION_FIRST = re.compile(
    r"(?:\s|\\q?quad|\\[,;:! ])*(?:=|\\equiv(?![A-Za-z])|[<>]|\\[lg]eq?(?![A-Za-z]))"
)
_ENDS = re.compile(rf"(?:[\s.,;~]|\\[,;:! ]|\\q?quad(?![A-Za-z])|\\\\|{_JOINING})*$")
_BEGINS = re.compile(rf"(?:[\s~]|\\[,;:! ]|\\q?quad(?![A-Za-z])|{_JOINING}|(?:and|where|with)(?=[\s,:]))*")


_DEFINES = re.compile(rf"(?:[\s~]|\\[,;:! ]|\\q?quad(?![A-Za-z])|{_BETWEEN})*{NAME_BEFORE_SIGN}(?:=|\\equiv)")


@dataclass(frozen=True, slots=True)
class Span:
    """Where a side begins and ends in its field."""

    start: int
    end: int


@dataclass(frozen=True, slots=True)
class _Cut:
    """A place where the field may be parted, and how: an equality sign, an arrow, a row, a comma or a wide gap."""

    kind: str
    start: int
    end: int


def latex_statements(text: str) -> tuple[Statement, ...]:
    r"""Return the statements of a field in LaTeX, each side with ``$`` before it where there is a place for it.

    Raises
    ------
    LanguageError
        Where a display does not end, or there are more sides than anyone writes in one field.

    Examples
    --------
    >>> [[side.said for side in s.sides] for s in latex_statements(r"$\dot q = p$, $\dot p = -q$")]
    [["q'", 'p'], ["p'", '-q']]
    """
    bare, statements = spans(text)
    return tuple(Statement(tuple(_side(bare, span) for span in sides)) for sides in statements)


def _side(bare: str, span: Span) -> Side:
    piece = bare[span.start : span.end]
    before = re.sub(r"\S", " ", bare[: span.start])
    return Side(f"{before[:-1]}$" + piece if before else piece, spelled_plainly(piece))


def spans(text: str) -> tuple[str, tuple[tuple[Span, ...], ...]]:
    r"""Return a field without its layout, and the sides of each statement in it.

    Raises
    ------
    LanguageError
        Where a display does not end, or there are more sides than anyone writes in one field.

    Examples
    --------
    >>> bare, statements = spans(r"$\dot q = \frac{p}{m}, \quad \dot p = -kq = F$.")
    >>> [[bare[side.start : side.end] for side in sides] for sides in statements]
    [['\\dot q', '\\frac{p}{m}'], ['\\dot p', '-kq', 'F']]
    """
    bare = opened(unwrapped(without_layout(text)))
    found = _cuts(bare)
    if found is None:  # brackets that do not close: the grammar says where
        return _clean(bare), ((_trimmed(bare, 0, len(bare)),),)
    equals = [cut for cut in found if cut.kind == "="]
    parts = _parts(bare, found, [cut.start for cut in equals])
    if len(equals) + len(parts) > MAX_SIDES:
        reason = (
            f"{len(equals) + len(parts)} sides of equations, and at most {MAX_SIDES} are read in one field"
        )
        raise LanguageError(text, 1, reason, "split the claim")
    statements: list[tuple[Span, ...]] = []
    for start, end in parts:
        inside = [cut for cut in equals if start <= cut.start < end]
        starts = [start, *(cut.end for cut in inside)]
        ends = [*(cut.start for cut in inside), end]
        if inside and not bare[starts[0] : ends[0]].strip():  # it goes on with what stands before the field
            starts, ends = starts[1:], ends[1:]
        sides = tuple(_trimmed(bare, a, b) for a, b in zip(starts, ends, strict=True))
        if inside or bare[start:end].strip(" .,;"):
            statements.append(sides)
    return _clean(bare, equals), tuple(statements or [(_trimmed(bare, 0, len(bare)),)])


def _clean(bare: str, equals: Sequence[_Cut] = ()) -> str:
    r"""Return a text without marks of rows, and with one plain sign for ``\equiv`` and ``:=``."""
    pieces: list[str] = []
    at = 0
    for cut in equals:
        pieces += (bare[at : cut.start], "=".ljust(cut.end - cut.start))
        at = cut.end
    return "".join((*pieces, bare[at:])).replace(ROW, " ").replace(PART, " ")


def _trimmed(bare: str, start: int, end: int) -> Span:
    """Return a side without the blanks around it and the full stop or comma behind it."""
    blank = _BEGINS.match(bare, start, end)
    start = blank.end() if blank else start
    piece = bare[start:end]
    while (stop := _ENDS.search(piece[-80:])) and stop.group():
        piece = piece[: len(piece) - len(stop.group())]
    return Span(start, start + len(piece))


def _cuts(bare: str) -> list[_Cut] | None:
    """Return where the field may be parted, outside all brackets; None where brackets do not match."""
    found: list[_Cut] = []
    open_: list[str] = []
    for match in _TOKEN.finditer(bare):
        sign = match.group()
        if CASES.match(sign):
            if "begin" in sign:
                open_.append("cases")
            elif not open_ or open_.pop() != "cases":
                return None
        elif sign in _OPENS:
            open_.append(sign)
        elif sign in _CLOSES:
            if not open_ or open_.pop() == "cases":
                return None
        elif not open_ and (kind := _kind(sign)):
            found.append(_Cut(kind, match.start(), match.end()))
    return None if open_ else found


def _kind(sign: str) -> str:
    if sign in _EQUALS or (sign.startswith(("\\stackrel", "\\overset")) and "=" in sign):
        return "="
    if sign in ("⇒", "∴") or sign.lstrip("\\") in _ARROWS.split("|"):
        return "arrow"
    if sign in (ROW, PART, ";", ",", "\n"):
        return sign
    if sign in ("\\quad", "\\qquad"):
        return "gap"
    is_word = sign.startswith(("\\text", "\\mbox", "\\mathrm")) and "{" in sign
    return "gap" if is_word or sign in ("and", "where", "with") else ""


def _parts(bare: str, cuts: list[_Cut], signs: list[int]) -> list[tuple[int, int]]:
    """Return where each statement begins and ends."""
    parts: list[tuple[int, int]] = []
    start = 0
    for cut, stop in _with_stops([cut for cut in cuts if cut.kind != "="], len(bare)):
        left = bisect_left(signs, cut.start) > bisect_left(signs, start)
        right = bisect_left(signs, stop) > bisect_left(signs, cut.start)
        before, after = bare[max(start, cut.start - _SEEN) : cut.start], bare[cut.end : cut.end + _SEEN]
        alone = (
            cut.kind in (",", "gap")
            and not left
            and bare[start : cut.start].strip()
            and _DEFINES.match(after)
        )
        if alone or _parts_here(cut.kind, before, after, both=left and right):
            parts.append((start, cut.start))
            start = cut.end
    parts.append((start, len(bare)))
    return parts


def _with_stops(places: list[_Cut], end: int) -> list[tuple[_Cut, int]]:
    """Return each cut with where the part behind it ends: at the next row, or the next cut of its own kind."""
    found: list[tuple[_Cut, int]] = []
    stops: dict[str, int] = {}
    for cut in reversed(places):
        found.append((cut, min(stops.get(cut.kind, end), stops.get(ROW, end))))
        stops[cut.kind] = cut.start
    return found[::-1]


def _parts_here(kind: str, before: str, after: str, *, both: bool) -> bool:
    """Tell whether a new statement begins behind a cut; ``both`` says that equality signs stand before and behind."""
    if kind in ("arrow", ";", PART):
        return True
    if _RELATION_FIRST.match(after):
        return False
    if kind == ROW:
        return not _GOES_ON.search(before) and (both or not _CONTINUES.match(after))
    return both and not (kind == "\n" and (_CONTINUES.match(after) or _GOES_ON.search(before)))


def spelled_plainly(side: str) -> str:
    r"""Return a side in plain spelling without blanks, as far as it can be a name; empty where it can't be one.

    Examples
    --------
    >>> spelled_plainly(r"\dot{p}_{\theta}"), spelled_plainly(r"F_{2}(q, P)"), spelled_plainly(r"\{ L_z , x \}")
    ("p_theta'", 'F_2(q,P)', '{L_z,x}')
    >>> spelled_plainly(r"\frac{\mathrm{d}\mathcal{H}}{\mathrm{d}t}")
    'dH/dt'
    """
    if len(side) > _LONGEST:
        return ""
    plain = side
    for pattern, spelling in _SPELLINGS:
        plain = pattern.sub(spelling, plain)
    plain = re.sub(r"\s+", "", plain)
    return plain if re.fullmatch(r"[\w+\-*/^(){}\[\],'∂Σ|]*", plain) else ""


_LONGEST = 100
_GREEK = (
    "alpha|beta|gamma|delta|epsilon|zeta|eta|theta|iota|kappa|lambda|mu|nu|xi|pi|rho|sigma|tau|upsilon|phi|chi|psi|omega"
    "|Gamma|Delta|Theta|Lambda|Xi|Pi|Sigma|Upsilon|Phi|Psi|Omega|hbar|ell"
)
_SPELLINGS = tuple(
    (re.compile(pattern), spelling)
    for pattern, spelling in (
        (
            r"\\(?:left|right|[bB]igg?[lrm]?|displaystyle|textstyle|limits|,|;|:|!|quad|qquad| )(?![A-Za-z])",
            "",
        ),
        (
            r"\\(?:mathrm|operatorname|text|mathit|mathcal|mathscr|mathfrak|mathbf|boldsymbol|rm|bm)\s*\{\s*(\w+)\s*\}",
            r"\1",
        ),
        (r"\{\s*\\(?:cal|rm|bf)\s*(\w+)\s*\}", r"\1"),
        (r"_\s*\{\s*(?:\\(?:rm|mathrm|text)\s*\{?\s*)?P\s?\.?\s?B\s?\.?\s*\}{1,2}", "_PB"),
        (r"\\(?:mathrm|text)\s*\{\s*const\.?\s*\}", "const"),
        (r"\\(?:mathrm|mathcal|mathscr|mathbf)\s*(\w)", r"\1"),
        (r"\\(?:hat|vec|bar|tilde|widehat|widetilde|overline)\s*(?:\{\s*(\w+)\s*\}|(\w))", r"\1\2"),
        (r"\\partial(?![A-Za-z])", "∂"),
        (r"\\sum(?![A-Za-z])\s*(?:_\s*(?:\{[^{}]{1,9}\}|\w))?\s*(?:\^\s*(?:\{[^{}]{1,9}\}|\w))?", "Σ"),
        (rf"\\(?:var)?({_GREEK})(?![A-Za-z])", r" \1 "),
        (r"_\s*\{\s*(\w+)\s*\}", r"_\1"),
        (r"_\s*(\w)", r"_\1"),
        (rf"\\dot(?![A-Za-z])\s*(?:\{{\s*(\w+)\s*\}}|({_GREEK}|\w))\s*(_\w+)?", r"\1\2\3'"),
        (rf"\\ddot(?![A-Za-z])\s*(?:\{{\s*(\w+)\s*\}}|({_GREEK}|\w))\s*(_\w+)?", r"\1\2\3''"),
        (r"\\[dtc]?frac\s*\{\s*([d∂][^{}]*)\}\s*\{\s*([d∂][^{}]*)\}", r"\1/\2"),
        (r"[−–]", "-"),
        (r"\\(?:\{|lbrace)", "{"),
        (r"\\(?:\}|rbrace)", "}"),
    )
)
