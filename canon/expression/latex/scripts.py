r"""LaTeX subscripts, primes, and the braces of ``\dot{\theta_1}``."""

from __future__ import annotations

import re
from dataclasses import dataclass

from canon.expression.latex.characters import letter
from canon.expression.latex.names import Pieces, stems
from canon.expression.text import syntax
from canon.expression.text.syntax import LanguageError, Number

__all__ = ["Accented", "Scripts", "accented", "braced_name", "dots_above", "scripts", "upright"]

_FIGURES = str.maketrans("₀₁₂₃₄₅₆₇₈₉", "0123456789")
_BLANK = re.compile(r"\s*")
_PRIMES = re.compile(
    r"['’′″]+|\^\s*\{\s*'+\s*\}|\^\s*(?:\\prime(?![A-Za-z])|\{(?:\s*\\prime(?![A-Za-z]))+\s*\})"
)
_POWER_BEFORE_SUBSCRIPT = re.compile(r"\^\s*(?:([0-9])|\{([0-9]+)\})\s*(?=_)")
_UPRIGHT = re.compile(
    r"\\(?:mathrm|mathit|text|textrm|textit|mathsf|mathnormal|operatorname\*?)\s*(?:\{\s*([A-Za-z][A-Za-z0-9]*)\s*\}|([A-Za-z]))"
    r"|\{\s*\\rm\s*([A-Za-z]+)\s*\}|\{\s*\\(?:mathrm|text|textrm)\s*\{?\s*(d)\s*\}?\s*\}"
)
_LETTER = re.compile(r"\\([A-Za-z]+)")
_RUN = re.compile(r"[A-Za-z0-9]+")
_LOWERED = re.compile(r"[₀-₉]+")
_DOTS = re.compile("[\u0307\u0308]+")
_NAME = r"(?:\\[A-Za-z]+|[A-Za-z])(?:\s*_\s*(?:\w|\{\s*\w+\s*\}))?"
_BRACED_NAME = re.compile(
    rf"\{{\s*(?:\\(d?dot)\s*)?(?:\{{\s*({_NAME})\s*\}}|({_NAME}))\s*\}}(?=\s*(?:_|'|\^\s*\{{?\s*\\prime))"
)
_MAX_PIECES = 5
"""Most pieces of one subscript; each may double the names it could mean."""


@dataclass(frozen=True, slots=True)
class Scripts:
    """Subscript and primes of a name, the power that stood before its subscript, and where they end."""

    pieces: Pieces
    primes: int
    power: Number | None
    at: int


@dataclass(frozen=True, slots=True)
class Accented:
    """The letter under an accent with the subscript that stood under it too, and where the accent ends."""

    stems: tuple[str, ...]
    pieces: Pieces
    at: int


def upright(text: str, at: int) -> tuple[str, int] | None:
    r"""Return the word of ``\mathrm{word}`` and where it ends, None if no such thing stands here."""
    match = _UPRIGHT.match(text, at)
    return (next(filter(None, match.groups())), match.end()) if match else None


def scripts(text: str, at: int, end: int) -> Scripts:
    """Return what hangs on the name that ends here.

    Raises
    ------
    LanguageError
        Where a subscript is no name.
    """
    pieces: Pieces = ()
    primes = 0
    power: Number | None = None
    while True:
        here = _blank(text, at)
        if here < end and text[here] == "_" and not pieces:
            pieces, at = _subscript(text, here)
        elif (lowered := _LOWERED.match(text, at, end)) and not pieces:
            pieces, at = ((lowered.group().translate(_FIGURES),),), lowered.end()
        elif (match := _PRIMES.match(text, here, end)) and power is None:
            primes += sum(map(match.group().count, ("'", "’", "′", "″", "″", "prime")))
            at = match.end()
        elif (match := _POWER_BEFORE_SUBSCRIPT.match(text, here, end)) and not pieces and power is None:
            digits = match.group(1) or match.group(2)
            if len(digits) > syntax.MAX_DIGITS:
                raise LanguageError(text, here + 1, f"a number of more than {syntax.MAX_DIGITS} digits")
            power, at = Number(int(digits), 1, here + 1), match.end()
        else:
            return Scripts(pieces, primes, power, at)


def dots_above(text: str, at: int, end: int) -> tuple[int, int]:
    """Return how many of Unicode's dots stand above the letter before, and where they end."""
    match = _DOTS.match(text, at, end)
    return (sum(1 if dot == "\u0307" else 2 for dot in match.group()), match.end()) if match else (0, at)


def braced_name(text: str, at: int, end: int) -> tuple[tuple[str, ...], Pieces, int, int] | None:
    r"""Return stems, subscript, dots and end of ``{\dot\theta}`` before a subscript or prime, None elsewhere."""
    match = _BRACED_NAME.match(text, at, end)
    if match is None:
        return None
    order = {None: 0, "dot": 1, "ddot": 2}[match.group(1)]
    name = 2 if match.group(2) else 3
    found, after = _base(text, match.start(name), 1)
    return found, scripts(text, after, match.end(name)).pieces, order, match.end()


def accented(text: str, at: int, end: int) -> Accented:
    r"""Return the name under an accent: ``\theta``, ``x``, ``{q_1}``.

    Raises
    ------
    LanguageError
        Where anything but one name stands there.
    """
    at = _blank(text, at)
    if text[at : at + 1] != "{":
        found, after = _base(text, at, 1)
        return Accented(found, (), after)
    found, after = _base(text, _blank(text, at + 1), end)
    under = scripts(text, after, end)
    closing = _blank(text, under.at)
    if text[closing : closing + 1] != "}" or under.primes or under.power:
        raise LanguageError(text, at + 1, "an accent belongs over one name", r"write \dot{\theta}, \dot{q}_1")
    return Accented(found, under.pieces, closing + 1)


def _base(text: str, at: int, most: int) -> tuple[tuple[str, ...], int]:
    """Return the ways to declare the letter that stands here, or a run of at most so many letters."""
    if command := _LETTER.match(text, at):
        word = upright(text, at)
        found = (word[0],) if word else stems(command.group(1))
        if found:
            return found, word[1] if word else command.end()
    elif (run := _RUN.match(text, at)) and not run.group()[0].isdigit():
        return (run.group()[:most],), min(run.end(), at + most)
    elif at < len(text) and (odd := letter(text[at])) and not odd[1]:
        return stems(odd[0]) or (odd[0],), at + 1
    raise LanguageError(
        text, at + 1, "a name is missing here", r"an accent belongs over one name, as in \dot{\theta}"
    )


def _subscript(text: str, at: int) -> tuple[Pieces, int]:
    """Return the subscript whose ``_`` stands here, piece by piece, and where it ends."""
    start = at = _blank(text, at + 1)
    if text[at : at + 1] != "{":
        run = _RUN.match(text, at)
        digits = run.group() if run else ""
        if len(digits) > 1 and digits[:2].isdigit():
            raise LanguageError(
                text, at + 1, f"LaTeX lowers only the {digits[0]} of {digits[:20]}", "write q_{12}"
            )
        piece, after = _piece(text, at, 1)
        return (piece,), after
    pieces: list[tuple[str, ...]] = []
    depth = 0
    while True:
        if text[at : at + 1] == "{":
            depth, at = depth + 1, at + 1
        elif text[at : at + 1] == "}":
            depth, at = depth - 1, at + 1
        elif text[at : at + 1] == "_":
            at += 1
        else:
            piece, at = _piece(text, at, len(text))
            pieces.append(piece)
        if not pieces and depth == 0:
            raise LanguageError(text, start + 1, "an empty subscript")
        if depth == 0:
            return tuple(pieces), at
        if len(pieces) > _MAX_PIECES:
            raise LanguageError(text, start + 1, f"a subscript of more than {_MAX_PIECES} pieces")
        at = _blank(text, at)


def _piece(text: str, at: int, most: int) -> tuple[tuple[str, ...], int]:
    if run := _RUN.match(text, at):
        return (run.group()[:most],), min(run.end(), at + most)
    word = upright(text, at)
    if word:
        return (word[0],), word[1]
    command = _LETTER.match(text, at)
    if command and stems(command.group(1)):
        return stems(command.group(1)), command.end()
    if at < len(text) and (odd := letter(text[at])) and not odd[1]:
        return stems(odd[0]) or (odd[0],), at + 1
    raise LanguageError(
        text,
        min(at, len(text) - 1) + 1,
        "a subscript is made of letters, digits and Greek letters",
        "write q_{12}",
    )


def _blank(text: str, at: int) -> int:
    """Return where the blanks that stand here end."""
    match = _BLANK.match(text, at)
    return match.end() if match else at
