r"""LaTeX tokens: numbers, declared names, functions, signs and brackets, each with its column.

Every bound that keeps hostile text harmless is checked here, before the grammar sees a word: length, number of
words, digits, nesting. Brackets are matched here too, so the grammar only ever sees matching ones.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from typing import TYPE_CHECKING, NoReturn

from canon.expression.latex.names import (
    FUNCTIONS,
    Applied,
    Function,
    Item,
    Mark,
    Names,
    Pieces,
    spellings,
    stems,
)
from canon.expression.latex.scripts import Scripts, accented, scripts, upright
from canon.expression.text import syntax
from canon.expression.text.syntax import LanguageError, Name, Number

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["Word", "Words", "words_of"]

_SPACE = re.compile(
    r"(?:\s|~|\\[,;:!>\s]|\\(?:q?quad|thinspace|enspace|displaystyle|limits|nolimits)(?![A-Za-z]))+"
)
_THIN = re.compile(r"\s|\\!|\\displaystyle|\\(?:no)?limits")
"""The spaces that show no gap in print."""
_NUMBER = re.compile(r"[0-9]+(?:\.[0-9]+)?|\.[0-9]+")
_RUN = re.compile(r"[A-Za-z][A-Za-z0-9]*")
_COMMAND = re.compile(r"\\(?:[A-Za-z]+|.)", re.DOTALL)

_SIGNS = {
    "+": "SIGN", "-": "SIGN", "−": "SIGN", "*": "TIMES", "·": "TIMES", "×": "TIMES", "\\cdot": "TIMES",
    "\\times": "TIMES", "/": "SLASH", "^": "CARET", "_": "UNDER", ",": "COMMA", "\\frac": "FRAC", "\\tfrac": "FRAC",
    "\\dfrac": "FRAC", "\\cfrac": "FRAC", "\\sqrt": "SQRT",
    **dict.fromkeys(("=", "<", ">", "\\lt", "\\gt", "\\le", "\\leq", "\\leqslant", "\\ge", "\\geq", "\\geqslant",
                     "\\ne", "\\neq"), "RELATION"),
}  # fmt: skip
_SINGLES = {"CARET": 1, "UNDER": 1, "FRAC": 2, "SQRT": 1}
"""How many arguments may follow without braces, each then one character."""
_OPEN = {"(": ")", "[": "]", "\\{": "\\}", "\\lbrace": "\\rbrace", "{": "}", "\\lvert": "\\rvert"}
_SIZES = re.compile(r"\\(?:left|right|middle|[bB]igg?[lrm]?)(?![A-Za-z])\s*")
_ACCENTS = {"dot": 1, "ddot": 2}
_DECORATIONS = ("bar", "hat", "tilde")
_REMEDIES = {
    "infty": "an expression is finite; write a bound as a condition without it",
    "pm": "write two claims, one for each sign", "mp": "write two claims, one for each sign",
    "int": "write the integral out", "sum": "write the sum out", "prod": "write the product out",
    "begin": "write one expression; Piecewise is spelled without the $",
    "vec": "write the components", "mathbf": "write the components", "boldsymbol": "write the components",
    "dddot": "only first and second rates are read", "over": r"write \frac{a}{b}",
    "approx": "write = for an equation", "equiv": "write = for an equation", "lg": r"write \log_{10}",
    "nabla": r"write the partial derivatives \frac{\partial V}{\partial x}", "div": "write / or \\frac",
    "\\": "write one equation only", "%": "comments are not read",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Word:
    """One word: its kind in the grammar, what it means, how it looks and where it stands."""

    kind: str
    item: Item | None
    shown: str
    column: int


@dataclass(frozen=True, slots=True)
class Words:
    """The words of a formula, the columns that a visible space stands before, and the column after the end."""

    words: tuple[Word, ...]
    spaced: frozenset[int]
    end: int


@dataclass(frozen=True, slots=True)
class _Bracket:
    shown: str
    closing: str
    kind: str
    singles: int
    column: int


def words_of(text: str, scope: Scope) -> Words:
    """Return the words of a LaTeX text that begins with ``$``.

    Raises
    ------
    LanguageError
        Where the text is too large, not closed, or has something in it that is not read.
    """
    if len(text) > syntax.MAX_CHARACTERS:
        most = syntax.MAX_CHARACTERS
        raise LanguageError(
            text, most, f"{len(text)} characters, and at most {most} are read", "split the claim"
        )
    reader = _Reader(text, scope)
    while reader.at < reader.end:
        reader.step()
    if reader.open:
        reader.refuse(reader.open[-1].column, f"{reader.open[-1].shown} is never closed")
    return Words(tuple(reader.words), frozenset(reader.spaced), reader.end + 1)


class _Reader:
    """Walks through the text once, from left to right."""

    def __init__(self, text: str, scope: Scope) -> None:
        self.text = text
        self.names = Names(text, scope)
        self.at, self.end = self.inside()
        self.words: list[Word] = []
        self.spaced: set[int] = set()
        self.gap = False
        self.singles = 0
        self.open: list[_Bracket] = []

    def refuse(self, column: int, reason: str, remedy: str = "") -> NoReturn:
        raise LanguageError(self.text, column, reason, remedy)

    def inside(self) -> tuple[int, int]:
        """Return where the formula begins and ends between its dollars."""
        start = self.text.index("$")
        dollars = "$$" if self.text.startswith("$$", start) else "$"
        start += len(dollars)
        end = self.text.find("$", start)
        if end < 0:
            return start, len(self.text)
        if self.text[end:].rstrip() != dollars:
            self.refuse(end + 1, "one formula only is read", "nothing may follow the closing $")
        return start, end

    @property
    def last(self) -> str:
        return self.words[-1].kind if self.words else ""

    def emit(self, kind: str, shown: str, column: int, item: Item | None = None) -> None:
        if len(self.words) >= syntax.MAX_TOKENS:
            self.refuse(column, f"more than {syntax.MAX_TOKENS} numbers, names and signs", "split the claim")
        self.words.append(Word(kind, item, shown, column))
        if self.gap:
            self.spaced.add(column)
        self.gap = False
        self.singles = max(self.singles - 1, 0) if kind == "ATOM" else _SINGLES.get(kind, 0)

    def step(self) -> None:
        """Read one word."""
        if space := _SPACE.match(self.text, self.at, self.end):
            self.gap = self.gap or bool(_THIN.sub("", space.group()))
            self.at = space.end()
            return
        if number := _NUMBER.match(self.text, self.at, self.end):
            self.number(number.group())
        elif run := _RUN.match(self.text, self.at, self.end):
            self.letters(run.group())
        elif size := _SIZES.match(self.text, self.at, self.end):
            self.at = size.end()
            self.delimiter(size.group().strip())
        elif command := _COMMAND.match(self.text, self.at, self.end):
            self.command(command.group())
        else:
            self.sign(self.text[self.at])

    def number(self, digits: str) -> None:
        column = self.at + 1
        if self.singles:
            if len(digits) > self.singles or not digits.isdigit():
                self.refuse(
                    column, f"LaTeX takes only the first digit of {digits[:20]} here", "write braces, x^{10}"
                )
            digits = digits[0]
        if len(digits) > syntax.MAX_DIGITS:
            self.refuse(column, f"a number of more than {syntax.MAX_DIGITS} digits")
        self.at += len(digits)
        whole, _, fraction = digits.partition(".")
        self.emit("ATOM", digits, column, Number(int(whole + fraction), 10 ** len(fraction), column))

    def letters(self, run: str) -> None:
        """Read names in roman letters, with subscript and primes where they are not a bare argument."""
        column = self.at + 1
        if self.singles:
            if len(run) > self.singles:
                self.refuse(
                    column, f"LaTeX takes only the first letter of {run[:20]} here", "write braces, x^{ab}"
                )
            run = run[0]
            self.at += 1
            self.put(self.names.run(run, column, (), 0, powered=False), column)
            return
        self.at += len(run)
        after = scripts(self.text, self.at, self.end)
        self.at = after.at
        items = self.names.run(run, column, after.pieces, after.primes, powered=self.follows("^"))
        self.put(items, column)
        self.raised(after.power)

    def put(self, items: list[Item], column: int) -> None:
        for item in items:
            self.emit("HEAD" if isinstance(item, Function | Applied) else "ATOM", "", item.column, item)
        start = column - 1
        self.words[-1] = Word(self.last, items[-1], self.text[start : self.at].strip()[:30], items[-1].column)

    def follows(self, character: str) -> bool:
        space = _SPACE.match(self.text, self.at, self.end)
        return self.text.startswith(character, space.end() if space else self.at)

    def raised(self, power: Number | None) -> None:
        """Write the power that stood before the subscript, as in ``p^2_1``."""
        if power is not None:
            self.emit("CARET", "^", power.column)
            self.emit("ATOM", str(power.numerator), power.column, power)

    def named(self, found: tuple[str, ...], start: int, pieces: Pieces = (), order: int = 0) -> None:
        """Write the declared name with these stems, whose text began at ``start`` and has been read to here."""
        column = start + 1
        bare = self.singles > 0
        after = Scripts((), 0, None, self.at) if bare else scripts(self.text, self.at, self.end)
        if after.pieces and pieces:
            self.refuse(self.at + 1, "a second subscript", "write one, q_{12}")
        if after.primes and order:
            self.refuse(self.at + 1, "a prime and a dot on one name", "write one of them")
        self.at = after.at
        pieces, rates = pieces or after.pieces, order or after.primes
        item: Item | None = self.names.spelled(found, pieces, rates, column, dotted=order > 0)
        if item is None and not pieces and not rates:
            item = _undeclared(found[0], column)
        if item is None:
            shown = self.text[start : self.at].strip()[:40]
            plain = self.names.spelled(found, pieces, 0, column)
            if plain:
                self.names.no_rate(plain.text if isinstance(plain, Name) else plain.name, column)
            self.refuse(
                column, f"{shown} is not declared", self.names.scope.near(spellings(found[-1], pieces)[0])
            )
        self.put([item], column)
        self.raised(after.power)

    def accent(self, command: str) -> None:
        start = self.at
        if self.singles:
            self.refuse(start + 1, f"{command} as an argument without braces", "write braces around it")
        under = accented(self.text, start + len(command), self.end)
        self.at = under.at
        kind = command[1:]
        if kind in _ACCENTS:
            self.named(under.stems, start, under.pieces, _ACCENTS[kind])
        else:
            self.named(
                tuple(f"{stem}{gap}{kind}" for stem in under.stems for gap in ("", "_")), start, under.pieces
            )

    def upright(self, word: str, start: int) -> None:
        r"""Write the word of ``\mathrm{word}``: d, e and i have their meaning, others are names or functions."""
        column = start + 1
        if word in ("d", "e"):
            self.put([Mark(word, column)], column)
        elif word == "i":
            if self.names.declares("I"):
                self.refuse(
                    column, "the imaginary unit can't be written here: I is declared", "rename the symbol I"
                )
            self.put([Name("I", 0, column)], column)
        elif word in FUNCTIONS and not self.names.declares(word):
            self.put([Function(FUNCTIONS[word], column)], column)
        else:
            self.named((word,), start)

    def command(self, command: str) -> None:
        start = self.at
        word = upright(self.text, start)
        if command in _SIGNS:
            self.at += len(command)
            self.emit(_SIGNS[command], command, start + 1)
        elif word:
            self.at = word[1]
            self.upright(word[0], start)
        elif stems(command[1:]):
            self.at += len(command)
            self.named(stems(command[1:]), start)
        elif command[1:] in (*_ACCENTS, *_DECORATIONS):
            self.accent(command)
        elif command == "\\partial" or command[1:] in FUNCTIONS:
            self.at += len(command)
            column = start + 1
            item = (
                Mark("partial", column)
                if command == "\\partial"
                else Function(FUNCTIONS[command[1:]], column)
            )
            self.put([item], column)
        elif not self.bracket(command, ""):
            self.refuse(start + 1, f"{command} is not read", _REMEDIES.get(command[1:], ""))

    def delimiter(self, size: str) -> None:
        r"""Read the bracket after ``\left``, ``\bigr`` and the like."""
        match = _COMMAND.match(self.text, self.at, self.end)
        shown = match.group() if match else self.text[self.at : min(self.at + 1, self.end)]
        side = "open" if size.endswith(("left", "l")) else "close" if size.endswith(("right", "r")) else ""
        if size == "\\middle" or not self.bracket(shown, side):
            self.refuse(self.at + 1, f"{size} belongs before a bracket", "write ( ), [ ], \\{ \\} or | |")

    def bracket(self, shown: str, side: str) -> bool:
        """Read a bracket; ``side`` says whether a bar opens or closes where it was told."""
        column = self.at + 1
        if shown in ("|", "\\vert"):
            opens = side == "open" or (not side and not (self.open and self.open[-1].closing == "|"))
            found = self.opened(shown, "|", column) if opens else self.closed("|", column)
        elif shown in _OPEN:
            found = self.opened(shown, _OPEN[shown], column)
        elif shown in _OPEN.values():
            found = self.closed(shown, column)
        else:
            return False
        self.at += len(shown)
        return found

    def opened(self, shown: str, closing: str, column: int) -> bool:
        if len(self.open) >= syntax.MAX_NESTING:
            self.refuse(column, f"nested more than {syntax.MAX_NESTING} deep")
        index = shown == "[" and self.last == "SQRT"
        kind = (
            "INDEX" if index else "BRACE" if shown == "{" else "BAR" if closing in ("|", "\\rvert") else "PAR"
        )
        singles = 1 if index else max(self.singles - 1, 0) if shown == "{" else 0
        self.open.append(_Bracket(shown, closing, kind, singles, column))
        self.emit("L" + kind, shown, column)
        return True

    def closed(self, shown: str, column: int) -> bool:
        if not self.open:
            self.refuse(column, f"{shown} closes nothing")
        bracket = self.open.pop()
        if bracket.closing != shown:
            where = f"{bracket.shown} of column {bracket.column}"
            self.refuse(column, f"{shown} where {bracket.closing} should close the {where}")
        self.emit("R" + bracket.kind, shown, column)
        self.singles = bracket.singles
        return True

    def sign(self, character: str) -> None:
        column = self.at + 1
        if character in _SIGNS:
            self.at += 1
            self.emit(_SIGNS[character], character, column)
        elif not self.bracket(character, ""):
            shown = repr(character) if character.isascii() else f"{character!r} (U+{ord(character):04X})"
            self.refuse(column, f"{shown} is not part of a formula", _remedy(character))


def _undeclared(name: str, column: int) -> Item | None:
    """Return what an undeclared Greek letter means all the same."""
    if name == "pi":
        return Name("pi", 0, column)
    return Mark("delta", column) if name == "delta" else None


def _remedy(character: str) -> str:
    """Return what to write instead of a character."""
    letter = re.fullmatch(r"GREEK (SMALL|CAPITAL) LETTER (\w+)", unicodedata.name(character, ""))
    if letter:
        name = letter.group(2).lower().replace("lamda", "lambda")
        return f"write \\{name if letter.group(1) == 'SMALL' else name.capitalize()}"
    return {
        "'": "a prime belongs directly after the name of a coordinate",
        ".": "write 0.5 for a decimal, and no full stop at the end",
        "&": "write one equation only",
        "!": "there is no factorial",
        "≤": r"write \le",
        "≥": r"write \ge",
        "≠": r"write \ne",
    }.get(character, "")
