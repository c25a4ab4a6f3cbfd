r"""Word lists: what the reader of LaTeX hands to the grammar, with matching brackets and every bound on its size."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NoReturn

from canon.expression.text import syntax
from canon.expression.text.syntax import LanguageError, Number

if TYPE_CHECKING:
    from canon.expression.latex.names import Item
    from canon.expression.latex.pieces import Group, LatexFraction, Operator

__all__ = ["Word", "WordList", "Words", "together"]

_SINGLES = {"CARET": 1, "UNDER": 1, "FRAC": 2, "SQRT": 1}
"""How many arguments may follow without braces, each then one character."""
_OPEN = {
    "(": ")",
    "[": "]",
    "\\{": "\\}",
    "\\lbrace": "\\rbrace",
    "{": "}",
    "\\lvert": "\\rvert",
    "\\lbrack": "\\rbrack",
}


@dataclass(frozen=True, slots=True)
class Word:
    """One word: its kind in the grammar, what it means, how it looks and where it stands."""

    kind: str
    item: Item | LatexFraction | Operator | Group | None
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


class WordList:
    """Takes words one by one, and matches their brackets."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.words: list[Word] = []
        self.spaced: set[int] = set()
        self.gap = False
        self.singles = 0
        self.open: list[_Bracket] = []

    def refuse(self, column: int, reason: str, remedy: str = "") -> NoReturn:
        """Raise the error of this text."""
        raise LanguageError(self.text, column, reason, remedy)

    @property
    def last(self) -> str:
        """The kind of the last word."""
        return self.words[-1].kind if self.words else ""

    @property
    def in_cases(self) -> bool:
        r"""Whether the last bracket that opened is ``\begin{cases}``."""
        return bool(self.open) and self.open[-1].kind in ("CASES", "CLAUSE")

    @property
    def at_condition(self) -> bool:
        """Whether a condition of cases begins here."""
        return self.in_cases and self.last in ("CCOLUMN", "CAND", "COR", "LCLAUSE")

    def emit(
        self, kind: str, shown: str, column: int, item: Item | LatexFraction | Operator | Group | None = None
    ) -> None:
        """Take one word."""
        if len(self.words) >= syntax.MAX_TOKENS:
            self.refuse(column, f"more than {syntax.MAX_TOKENS} numbers, names and signs", "split the claim")
        self.words.append(Word(kind, item, shown, column))
        if self.gap:
            self.spaced.add(column)
        self.gap = False
        self.singles = max(self.singles - 1, 0) if kind == "ATOM" else _SINGLES.get(kind, 0)

    def raised(self, power: Number | None) -> None:
        """Write the power that stood before the subscript, as in ``p^2_1``."""
        if power is not None:
            self.emit("CARET", "^", power.column)
            self.emit("ATOM", str(power.numerator), power.column, power)

    def raised_by(self, figures: str, column: int) -> None:
        """Write the exponent that superscripts of Unicode spell."""
        if len(figures) > syntax.MAX_DIGITS:
            self.refuse(column, f"a number of more than {syntax.MAX_DIGITS} digits")
        self.emit("CARET", "^", column)
        number = Number(int(figures.lstrip("-")), 1, column)
        if figures.startswith("-"):
            self.emit("LBRACE", "{", column)
            self.emit("SIGN", "-", column)
        self.emit("ATOM", figures, column, number)
        if figures.startswith("-"):
            self.emit("RBRACE", "}", column)
        self.singles = 0

    def bracket(self, shown: str, side: str, column: int) -> bool:
        """Read a bracket; ``side`` says whether a bar opens or closes where it was told."""
        if shown in ("|", "\\vert"):
            opens = side == "open" or (not side and not (self.open and self.open[-1].closing == "|"))
            found = self.opened(shown, "|", column) if opens else self.closed("|", column)
        elif shown in _OPEN:
            found = self.opened(shown, _OPEN[shown], column)
        elif shown in _OPEN.values():
            found = self.closed(shown, column)
        else:
            return False
        return found

    def opened(self, shown: str, closing: str, column: int) -> bool:
        """Take a bracket that opens."""
        if len(self.open) >= syntax.MAX_NESTING:
            self.refuse(column, f"nested more than {syntax.MAX_NESTING} deep")
        if closing == "\\end{cases}":
            self.open.append(_Bracket(shown, closing, "CASES", 0, column))
            self.emit("LCASES", shown, column)
            return True
        if closing == "clause )":
            self.open.append(_Bracket(shown, ")", "CLAUSE", 0, column))
            self.emit("LCLAUSE", shown, column)
            return True
        index = shown == "[" and self.last == "SQRT"
        kind = (
            "INDEX" if index else "BRACE" if shown == "{" else "BAR" if closing in ("|", "\\rvert") else "PAR"
        )
        singles = 1 if index else max(self.singles - 1, 0) if shown == "{" else 0
        self.open.append(_Bracket(shown, closing, kind, singles, column))
        self.emit("L" + kind, shown, column)
        return True

    def closed(self, shown: str, column: int) -> bool:
        """Take a bracket that closes."""
        if not self.open:
            self.refuse(column, f"{shown} closes nothing")
        bracket = self.open.pop()
        if bracket.closing != shown:
            where = f"{bracket.shown} of column {bracket.column}"
            self.refuse(column, f"{shown} where {bracket.closing} should close the {where}")
        self.emit("R" + bracket.kind, shown, column)
        self.singles = bracket.singles
        return True


def together(faults: list[LanguageError]) -> LanguageError:
    """Return several faults as one, at the column of the first."""
    first, *others = faults
    told = dict.fromkeys((first.reason,))
    also: list[str] = []
    for fault in others:
        if fault.reason not in told:
            told[fault.reason] = None
            also.append(f"column {fault.column}: {fault.message}")
    return (
        LanguageError(first.text, first.column, first.reason, "; ".join((first.remedy, *also)).strip("; "))
        if also
        else first
    )
