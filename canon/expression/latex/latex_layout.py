r"""Layout in LaTeX: displays, spaces, boxes and labels, which say nothing of the meaning, become blanks.

``$``, ``\[ \]``, ``\begin{align}``, ``&``, ``\label{…}``, ``\boxed{…}`` and comments are taken off; each leaves as many
blanks as it had characters, so that every column stays where it was. What parts two formulas leaves a mark.
"""

from __future__ import annotations

import re
from itertools import islice, pairwise
from typing import NoReturn

from canon.expression.text.tokens import MAX_CHARACTERS, LanguageError

__all__ = ["CASES", "PART", "ROW", "without_layout"]

ROW, PART = "\x1e", "\x1f"
r"""What stands in the place of ``\\``, and of the gap between two formulas in dollars."""
CASES = re.compile(r"\\(begin|end)\s*\{\s*d?cases\s*\}")

_DISPLAYS = frozenset(
    ("equation", "align", "aligned", "alignat", "alignedat", "gather", "gathered", "split", "eqnarray", "multline",
     "multlined", "displaymath", "math", "flalign", "subequations", "array", "center")
)  # fmt: skip
_ENVIRONMENT = re.compile(r"\\(begin|end)\s*\{\s*([A-Za-z]+)(\*?)\s*\}(?:\s*\[[tcb]\])?")
_COLUMNS = re.compile(r"\s*\{[lcr|@{}0-9\s]{0,40}\}")
_COMMENT = re.compile(r"(?<!\\)%[^\n]*")
_SAID_OF_THE_PAGE = re.compile(
    r"\\(?:label|tag\*?|ref|eqref|vspace\*?|hspace\*?|color|vphantom|cite|footnote)\s*\{[^{}]*\}"
    r"|\\(?:nonumber|notag|displaystyle|textstyle|scriptstyle|centering|noindent|hfill|par|allowbreak|mathstrut|strut"
    r"|allowdisplaybreaks|medskip|bigskip|smallskip|newline|hline|nobreak|left\s*\.\s*(?=\\left)|relax)(?![A-Za-z])"
)
_PRINTED_ATAN2 = re.compile(r"\\operatorname\s*\{\s*atan_\s*\{?2\}?\s*\}")
"""How SymPy prints the name."""
_INSIDE = r"(?:[^{}]|\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\})"
_PRINTED_SUBS = re.compile(
    r"\\left\.\s*\\frac\{d(?:\^\{([2-8])\})?\}\{d (?P<x>\\?[A-Za-z]{1,10}(?:_\{\w{1,3}\})?)(?:\^\{\1\})?\}\s*"
    r"(?P<f>\\?\w{1,20}|\\operatorname\{\w{1,20}\})\{\\left\((?P=x) \\right\)\}\s*\\right\|_\{\\substack\{"
    rf"\s*(?P=x)=(?P<place>{_INSIDE}{{1,2000}})\}}\}}"
)
"""How SymPy prints the derivative of a function at a place."""
_ENTRY = r"((?:[^&\\{}]|\\[^\\&]|\{[^{}]{0,99}\}){1,200})"
_DETERMINANT = re.compile(
    rf"\\begin\{{vmatrix\}}{_ENTRY}&{_ENTRY}\\\\{_ENTRY}&{_ENTRY}(?:\\\\\s{{0,9}})?\\end\{{vmatrix\}}"
)
"""Determinants of two rows and two columns."""
_BROKEN_BRACKET = re.compile(
    r"\\right\s*\.(?:\s|&|~|\\\\|\\(?:q?quad|nonumber|notag)(?![A-Za-z])|\\[,;:!])*\\left\s*\."
)
_BOX = re.compile(
    r"\\(?:boxed|fbox|underline|ensuremath|colorbox\s*\{\w*\}|textcolor\s*\{\w*\}|mathclap|mathop)\s*(?=\{)"
)
_ROW = re.compile(r"\\\\\*?(?:\s*\[\s*-?[0-9.]+\s*(?:pt|em|ex|mm|cm|in|baselineskip)\s*\])?")
_DELIMITER = re.compile(r"\$\$?|(?<!\\)\\[\[\]()]")
_CLOSING = {"$": "$", "$$": "$$", "\\[": "\\]", "\\(": "\\)"}
_EQUALS_FIRST = re.compile(r"(?:\s|\\(?:display|text)style(?![A-Za-z])){0,40}=")
_EQUALS_LAST = re.compile(r"=\s*$")
_GAP = re.compile(r"[\s,;.:]*(?:and|und|et|i\.\s?e\.|d\.\s?h\.|that is|hence|thus|so)?[\s,;.:]*")
_BRACE = re.compile(r"\\.|[{}]", re.DOTALL)
_BRACE_OR_EQUALS = re.compile(r"\\.|[{}=]", re.DOTALL)
_STANDS_ALONE = re.compile(
    rf"(?:[\s.,;{ROW}{PART}]|\\(?:q?quad|[,;:! ]))*(?:$|\\[a-z]+arrow|\\implies|(?<=[{ROW}{PART};])"
    rf"|(?:(?<=[^\\],)|(?<=quad))(?=[^{ROW}{PART}=]{{1,60}}=))"
)
_MOST_BOXES = 20
_BLANK = r"(?:\s|~|&|\\q?quad(?![A-Za-z])|\\[,;:! ])*"
_AMPERSAND = re.compile(r"(?<!\\)&")
_SIGN_BEFORE = re.compile(
    rf"(?:^|[=<>≤≥≠+\-−*/({{\[,;{ROW}{PART}]|\\(?:equiv|approx|simeq|[lg]eq?|neq?|cdot|times|left\s*[(\[]|colon|implies|Rightarrow)){_BLANK}$"
)
_SIGN_BEHIND = re.compile(
    rf"{_BLANK}(?:$|[=<>≤≥≠+\-−*/)\],.{ROW}{PART}]|:=|\\(?:equiv|approx|simeq|[lg]eq?|neq?|cdot|times|right)(?![A-Za-z]))"
)
_SYSTEM_OPENS = re.compile(
    r"\\left\s*\\(?:\{|lbrace(?![A-Za-z]))(?=\s*\\begin\s*\{\s*(?:array|aligned|gathered)\s*\})"
)
_SYSTEM_CLOSES = re.compile(r"(?<=\})\s*\\right\s*\.")


def without_layout(text: str) -> str:
    r"""Return a LaTeX text without what only sets it on the page; every column stays where it was.

    Raises
    ------
    LanguageError
        Where the text is too long, or a display does not end.

    Examples
    --------
    >>> without_layout(r"\begin{align} x &= 1 \end{align}").strip()
    'x  = 1'
    >>> without_layout(r"$H = \boxed{p^2}$, ").strip()
    'H =       {p^2}  ,'
    """
    if len(text) > MAX_CHARACTERS:
        reason = f"{len(text)} characters, and at most {MAX_CHARACTERS} are read"
        raise LanguageError(text, MAX_CHARACTERS, reason, "split the claim")
    bare = _COMMENT.sub(_blanks, text) if "%" in text else text
    bare = _without_delimiters(bare)
    if "\\" not in bare:
        return _aligned(bare) if "&" in bare else bare
    bare = _SAID_OF_THE_PAGE.sub(_blanks, bare)
    if "\\substack" in bare:
        bare = _PRINTED_SUBS.sub(_primed, bare)
    bare = _PRINTED_ATAN2.sub(lambda m: r"\operatorname{atan2}".ljust(len(m.group())), bare)
    bare = _BROKEN_BRACKET.sub(_blanks, bare)
    if "\\begin{vmatrix}" in bare:
        bare = _DETERMINANT.sub(_worked_out, bare)
    if "\\begin" in bare or "\\end" in bare:
        bare = _without_displays(text, bare)
    return _unboxed(_rows(bare))


def _primed(printed: re.Match[str]) -> str:
    """Return the derivative at a place with primes, printed as SymPy prints calls, and as long as it was."""
    primes = "'" * int(printed[1] or 1)
    return rf"{printed['f']}{primes}\left({printed['place']}\right)".ljust(len(printed.group()))


def _worked_out(found: re.Match[str]) -> str:
    """Return a determinant as the difference of two products, as long as it was."""
    a, b, c, d = (entry.strip() for entry in found.groups())
    return rf"[({a})\cdot({d})-({b})\cdot({c})]".ljust(len(found.group()))


def _unboxed(text: str) -> str:
    r"""Return a text without ``\boxed``; the braces of a box that holds whole equations go too."""
    boxes = [*islice(_BOX.finditer(text), _MOST_BOXES)]
    if not boxes:
        return text
    closing = _closing_braces(text)
    signs = [*text]
    for box in boxes:
        start, end = box.end(), closing.get(box.end(), -1)
        signs[box.start() : start] = " " * (start - box.start())
        if end > 0 and _holds_equations(text[start + 1 : end]) and _STANDS_ALONE.match(text, end + 1):
            signs[start] = signs[end] = " "
    return "".join(signs)


def _closing_braces(text: str) -> dict[int, int]:
    """Return for each brace that opens where it is closed."""
    found: dict[int, int] = {}
    open_: list[int] = []
    for match in _BRACE.finditer(text):
        if match.group() == "{":
            open_.append(match.start())
        elif match.group() == "}" and open_:
            found[open_.pop()] = match.start()
    return found


def _holds_equations(inside: str) -> bool:
    """Tell whether an equality sign stands in a box outside further braces."""
    depth = 0
    for match in _BRACE_OR_EQUALS.finditer(inside):
        sign = match.group()
        if sign == "=" and depth == 0:
            return True
        depth += (sign == "{") - (sign == "}")
    return False


def _blanks(match: re.Match[str]) -> str:
    return " " * len(match.group())


def _without_delimiters(text: str) -> str:
    r"""Return a text without ``$``, ``\[ \]``, ``\( \)``; a mark stands in the gap between two formulas."""
    bare = _DELIMITER.sub(_blanks, text)
    for (_, left), (right, _) in pairwise(_formulas(text)):
        if _EQUALS_FIRST.match(bare, right) or _EQUALS_LAST.search(bare[max(0, left - 20) : left]):
            continue  # one equation in several pairs of dollars
        if _GAP.fullmatch(text, left, right) and (right > left or text[left - 2 : left] in ("$$", "\\]")):
            mark = left if right > left else left - 1
            bare = bare[:mark] + PART + " " * (right - mark - 1) + bare[right:]
    return bare


def _formulas(text: str) -> list[tuple[int, int]]:
    """Return where each formula begins and ends, its delimiters included."""
    zones: list[tuple[int, int]] = []
    opened: re.Match[str] | None = None
    for match in _DELIMITER.finditer(text):
        sign = match.group()
        if opened is None:
            if sign not in _CLOSING:
                raise LanguageError(text, match.start() + 1, f"{sign} closes nothing")
            opened = match
        elif sign == _CLOSING[opened.group()]:
            zones.append((opened.start(), match.end()))
            opened = None
        elif opened.group() == "$" and sign == "$$":
            zones.append((opened.start(), match.start() + 1))
            opened = match
        else:
            reason = f"{sign} inside {opened.group()} of column {opened.start() + 1}"
            raise LanguageError(
                text, match.start() + 1, reason, f"close it with {_CLOSING[opened.group()]} before"
            )
    return zones


def _without_displays(text: str, bare: str) -> str:
    r"""Return a text without the ``\begin`` and ``\end`` of displays; ``cases`` that are values stay."""
    bare = _SYSTEM_OPENS.sub(_blanks, bare)
    pieces: list[str] = []
    open_: list[tuple[str, int]] = []
    at = 0
    for match in _ENVIRONMENT.finditer(bare):
        word, name = match.group(1), match.group(2)
        if word == "begin":
            open_.append((name, match.start()))
        elif not open_ or open_[-1][0] != name:
            raise LanguageError(text, match.start() + 1, f"\\end{{{name[:20]}}} closes nothing")
        else:
            open_.pop()
        if name in ("cases", "dcases"):
            continue
        if name not in _DISPLAYS:
            _refuse_display(text, name, match.start())
        end = _end_of_display(bare, match)
        pieces += (bare[at : match.start()], " " * (end - match.start()))
        at = end
    if open_:
        name, start = open_[-1]
        raise LanguageError(
            text, start + 1, f"\\begin{{{name}}} is never closed", f"write \\end{{{name}}} at its end"
        )
    return "".join((*pieces, bare[at:]))


def _end_of_display(bare: str, match: re.Match[str]) -> int:
    r"""Return where ``\begin`` or ``\end`` is over, with the columns of an array, the bracket after a system."""
    word, name = match.group(1), match.group(2)
    after = None
    if word == "begin" and name in ("array", "alignat", "alignedat"):
        after = _COLUMNS.match(bare, match.end())
    elif word == "end" and name in ("array", "aligned", "gathered"):
        after = _SYSTEM_CLOSES.match(bare, match.end())
    return after.end() if after else match.end()


def _refuse_display(text: str, name: str, start: int) -> NoReturn:
    remedy = "write its components one by one" if name.endswith("matrix") else "write the equations alone"
    raise LanguageError(text, start + 1, f"\\begin{{{name[:20]}}} is not read", remedy)


def _rows(text: str) -> str:
    r"""Return a text with a mark for each ``\\`` and blanks for each ``&``, except in cases that are values."""
    kept: list[tuple[int, int]] = []
    pieces: list[str] = []
    at = 0
    depth = 0
    start = 0
    for match in CASES.finditer(text):
        depth += 1 if match.group(1) == "begin" else -1
        if depth == 1 and match.group(1) == "begin":
            start = match.start()
        elif depth == 0:
            kept.append((start, match.end()))
    for start, end in [*kept, (len(text), len(text))]:
        pieces.append(_aligned(_ROW.sub(lambda m: ROW + " " * (len(m.group()) - 1), text[at:start])))
        inside = text[start:end]
        pieces.append(_rows(_without_cases(inside)) if _is_system(inside) else inside)
        at = end
    return "".join(pieces)


def _aligned(text: str) -> str:
    """Return a text with blanks for each ``&`` at a sign or where a row begins, marks for those that part columns."""
    return _AMPERSAND.sub(
        lambda m: (
            " "
            if _SIGN_BEFORE.search(text[max(0, m.start() - 60) : m.start()])
            or _SIGN_BEHIND.match(text, m.end())
            else PART
        ),
        text,
    )


def _without_cases(text: str) -> str:
    r"""Return a text that begins and ends with ``cases`` without these two."""
    first, last = CASES.match(text), [*CASES.finditer(text)][-1]
    opening = first.end() if first else 0
    return " " * opening + text[opening : last.start()] + " " * (len(text) - last.start())


def _is_system(cases: str) -> bool:
    r"""Tell whether the rows of ``cases`` are equations: each has ``=`` before its first ``&`` or right behind it."""
    if not cases:
        return False
    rows = [row for row in _ROW.split(_without_cases(cases)) if row.strip(" ,.;")]
    return bool(rows) and all(
        re.search(r"(?<![<>\\!])=", row.split("&")[0] + row.partition("&")[2][:3]) for row in rows
    )
