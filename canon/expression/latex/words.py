r"""LaTeX tokens: numbers, declared names, functions, signs and brackets, each with its column.

Every bound that keeps hostile text harmless is checked here, before the grammar sees a word: length, number of
words, digits, nesting. Brackets are matched here too, so the grammar only ever sees matching ones.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NoReturn

from canon.expression.latex.characters import REMEDIES, SIGNS, figure, letter, raised_figures, remedy
from canon.expression.latex.latex_layout import CASES
from canon.expression.latex.names import (
    FUNCTIONS,
    UPRIGHT,
    Applied,
    Function,
    Item,
    Mark,
    Names,
    Pieces,
    spellings,
    stems,
)
from canon.expression.latex.pieces import Group, LatexFraction, Operator, in_degrees
from canon.expression.latex.printed_forms import (
    CLAUSE,
    CONDITION,
    DECORATIONS,
    OF_SPECIAL_FUNCTIONS,
    OTHERWISE,
    PARTIAL,
    PLAIN,
    is_printed_call,
)
from canon.expression.latex.scripts import Scripts, accented, braced_name, dots_above, scripts, upright
from canon.expression.latex.word_list import Word, WordList, Words, together
from canon.expression.text import syntax
from canon.expression.text.syntax import LanguageError, Name, Node, Number, Product

if TYPE_CHECKING:
    from collections.abc import Mapping

    from canon.expression.text.scope import Scope

__all__ = ["Word", "Words", "words_of"]

_SPACE = re.compile(
    r"(?:\s|~|\\[,;:!>/\s]|\\(?:q?quad|thinspace|thickspace|medspace|negthinspace|enspace|displaystyle|limits|nolimits"
    r"|qty)(?![A-Za-z]))+"
)
_THIN = re.compile(r"\s|\\[!/]|\\displaystyle|\\negthinspace|\\qty|\\(?:no)?limits")
"""The spaces that show no gap in print."""
_NUMBER = re.compile(r"[0-9]+(?:\.[0-9]+)?|\.[0-9]+")
_DEGREES = re.compile(
    r"(?:\s|\\[,!;:])*(?:\^\s*(?:\\circ(?![A-Za-z])|\{\s*\\circ\s*\})|\\degree(?![A-Za-z])|°)(?!\s*(?:\\text|\\mathrm|C))"
)
_FIGURES = re.compile(r"[0-9]+(?![.0-9])")
_RUN = re.compile(r"[A-Za-z][A-Za-z0-9]*")
_COMMAND = re.compile(r"\\(?:[A-Za-z]+|.)", re.DOTALL)
_COMMAND_WITH_ARGUMENT = re.compile(r"\\(?:[A-Za-z]+(?:\{[^{}]{0,200}\})?|.)", re.DOTALL)

_SIZES = re.compile(r"\\(?:left|right|middle|[bB]igg?[lrm]?)(?![A-Za-z])\s*")
_ACCENTS = {"dot": 1, "ddot": 2}
_SQUARED = re.compile(r"(?:\s|\\,|\\right|\|)*(?:\^\s*(?:2(?![0-9])|\{\s*2\s*\})|²)")
_MOST_FAULTS = 5  # that are told at once


def words_of(
    text: str, scope: Scope, start: int = 0, end: int | None = None, inner: Mapping[int, Node] | None = None
) -> Words:
    """Return the words of a formula in LaTeX, which begins and ends at these places of its field.

    Integrals and sums have been read: ``inner`` has their trees by the places of the signs that stand for them.

    Raises
    ------
    LanguageError
        Where the text is too large, not closed, or has something in it that is not read; all such places are told.
    """
    if len(text) > (most := syntax.MAX_CHARACTERS):
        told = f"{len(text)} characters, and at most {most} are read"
        raise LanguageError(text, most, told, "split the claim")
    reader = _Reader(text, scope, (start, len(text) if end is None else end), inner or {})
    faults: list[LanguageError] = []
    while reader.at < reader.end and len(faults) < _MOST_FAULTS:
        at = reader.at
        try:
            reader.step()
        except LanguageError as error:
            faults.append(error)
            reader.passed_over(at)
    if faults:
        raise together(faults)
    if reader.out.open:
        reader.refuse(reader.out.open[-1].column, f"{reader.out.open[-1].shown} is never closed")
    return Words(tuple(reader.out.words), frozenset(reader.out.spaced), reader.end + 1)


class _Reader:
    """Walks through the text once, from left to right."""

    def __init__(self, text: str, scope: Scope, span: tuple[int, int], inner: Mapping[int, Node]) -> None:
        self.text = text
        self.names = Names(text, scope)
        self.at, self.end = span
        self.out = WordList(text)
        self.inner = inner

    def refuse(self, column: int, reason: str, remedy: str = "") -> NoReturn:
        raise LanguageError(self.text, column, reason, remedy)

    def passed_over(self, at: int) -> None:
        """Go on behind a word that is not read."""
        word = _COMMAND_WITH_ARGUMENT.match(self.text, at, self.end) or _RUN.match(self.text, at, self.end)
        self.at = max(self.at, word.end() if word else at + 1)
        self.out.singles = 0

    def step(self) -> None:
        """Read one word."""
        if space := _SPACE.match(self.text, self.at, self.end):
            self.out.gap = self.out.gap or bool(_THIN.sub("", space.group()))
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
        if self.out.singles:
            if len(digits) > self.out.singles or not digits.isdigit():
                self.refuse(
                    column, f"LaTeX takes only the first digit of {digits[:20]} here", "write braces, x^{10}"
                )
            digits = digits[0]
        if len(digits) > syntax.MAX_DIGITS:
            self.refuse(column, f"a number of more than {syntax.MAX_DIGITS} digits")
        self.at += len(digits)
        whole, _, fraction = digits.partition(".")
        number = Number(int(whole + fraction), 10 ** len(fraction), column)
        degrees = None if self.out.singles else _DEGREES.match(self.text, self.at, self.end)
        if degrees:
            self.at = degrees.end()
        self.out.emit("ATOM", digits, column, in_degrees(number) if degrees else number)

    def letters(self, run: str) -> None:
        """Read names in roman letters, with subscript and primes where they are not a bare argument."""
        column = self.at + 1
        if not self.out.singles and self.spelled_plainly():
            return
        if self.out.singles:
            if len(run) > self.out.singles:
                self.refuse(
                    column, f"LaTeX takes only the first letter of {run[:20]} here", "write braces, x^{ab}"
                )
            run = run[0]
            self.at += 1
            self.put(self.names.run(run, column, (), 0, powered=False), column)
            return
        self.at += len(run)
        special = is_printed_call(run, self.text, self.at, self.end)
        if special and not self.names.declares(run):
            self.put([Function(OF_SPECIAL_FUNCTIONS[run], column)], column)
            return
        if run == "sqrt" and self.follows("({") and not self.names.declares(run):
            self.put([Function("sqrt", column)], column)
            return
        dots, self.at = dots_above(self.text, self.at, self.end)
        after = scripts(self.text, self.at, self.end)
        self.at = after.at
        order = dots or after.primes
        items = self.names.run(run, column, after.pieces, order, powered=self.follows("^"))
        self.put(items, column)
        self.out.raised(after.power)

    def spelled_plainly(self) -> bool:
        """Read a declared name as the plain language spells it, ``p_theta`` or ``x_dot``, if one stands here."""
        match = PLAIN.match(self.text, self.at, self.end)
        if match is None or not self.names.declares(match.group()):
            return False
        start = self.at
        self.at = match.end()
        after = scripts(self.text, self.at, self.end)
        if after.pieces:
            return False
        self.named((match.group(),), start)
        return True

    def put(self, items: list[Item], column: int) -> None:
        for item in items:
            self.out.emit("HEAD" if isinstance(item, Function | Applied) else "ATOM", "", item.column, item)
        start = column - 1
        self.out.words[-1] = Word(
            self.out.last, items[-1], self.text[start : self.at].strip()[:30], items[-1].column
        )

    def follows(self, characters: str) -> bool:
        space = _SPACE.match(self.text, self.at, self.end)
        return self.text.startswith(tuple(characters), space.end() if space else self.at)

    def named(self, found: tuple[str, ...], start: int, pieces: Pieces = (), order: int = 0) -> None:
        """Write the declared name with these stems, whose text began at ``start`` and has been read to here."""
        column = start + 1
        bare = self.out.singles > 0
        if not bare and not order:
            order, self.at = dots_above(self.text, self.at, self.end)
        after = Scripts((), 0, None, self.at) if bare else scripts(self.text, self.at, self.end)
        if after.pieces and pieces:
            self.refuse(self.at + 1, "a second subscript", "write one, q_{12}")
        if after.primes and order:
            self.refuse(self.at + 1, "a prime and a dot on one name", "write one of them")
        self.at = after.at
        pieces, rates = pieces or after.pieces, order or after.primes
        item: Item | None = self.names.spelled(found, pieces, rates, column, dotted=order > 0)
        if item is None and not pieces and not bare:
            item = self.numbered(found, rates, column, dotted=order > 0)
        if item is None and not pieces and not rates:
            item = _undeclared(found[0], column)
        if item is None:
            shown = self.text[start : self.at].strip()[:40]
            plain = self.names.spelled(found, pieces, 0, column)
            if plain:
                self.names.no_rate(plain.text if isinstance(plain, Name) else plain.name, column)
            remedy = self.names.scope.near(spellings(found[-1], pieces)[0], self.text[self.at :])
            self.refuse(column, f"{shown} is not declared", remedy)
        self.put([item], column)
        self.out.raised(after.power)

    def numbered(self, found: tuple[str, ...], rates: int, column: int, *, dotted: bool) -> Item | None:
        r"""Read the number of ``\theta1`` as a subscript, where only names with it are declared."""
        number = _FIGURES.match(self.text, self.at, self.end)
        item = number and self.names.spelled(found, ((number.group(),),), rates, column, dotted=dotted)
        if number and item:
            self.at = number.end()
        return item

    def case(self, sign: str) -> None:
        r"""Read ``\begin{cases}``, ``\\`` and ``\end{cases}``."""
        column = self.at + 1
        self.at += len(sign)
        if sign.startswith("\\begin"):
            self.out.opened(sign, "\\end{cases}", column)
        elif sign.startswith("\\end"):
            self.out.closed("\\end{cases}", column)
        elif not self.text.startswith("\\end", _blanks_end(self.text, self.at)):
            self.out.emit("CROW", sign, column)

    def accent(self, command: str) -> None:
        start = self.at
        if self.out.singles:
            self.refuse(start + 1, f"{command} as an argument without braces", "write braces around it")
        under = accented(self.text, start + len(command), self.end)
        self.at = under.at
        kind = command[1:]
        if kind in _ACCENTS:
            self.named(under.stems, start, under.pieces, _ACCENTS[kind])
            return
        found = [
            f"{stem}{gap}{word}" for word in DECORATIONS[kind] for stem in under.stems for gap in ("", "_")
        ]
        if "vec" in DECORATIONS[kind] and _SQUARED.match(self.text, self.at, self.end):
            found += filter(self.names.is_length, under.stems)  # the square of a vector is that of its length
        self.named(tuple(found), start, under.pieces)

    def upright(self, word: str, start: int) -> None:
        r"""Write the word of ``\mathrm{word}``: d, e and i have their meaning, others are names or functions."""
        column = start + 1
        if word in ("d", "e"):
            self.put([Mark(word, column)], column)
        elif word == "i" and not self.names.declares("i"):
            if self.names.declares("I"):
                self.refuse(
                    column, "the imaginary unit can't be written here: I is declared", "rename the symbol I"
                )
            self.put([Name("I", 0, column)], column)
        elif (known := FUNCTIONS.get(word, UPRIGHT.get(word, ""))) and not self.names.declares(word):
            self.put([Function(known, column)], column)
        else:
            self.named((word,), start)

    def command(self, command: str) -> None:
        start, column = self.at, self.at + 1
        if command == "\\\\" and not self.out.in_cases:
            self.refuse_open_bracket_of_cases()
        if self.out.in_cases and (said := CONDITION.match(self.text, start, self.end)):
            self.condition(said, command)
        elif command in SIGNS:
            self.at += len(command)
            self.out.emit(SIGNS[command], command, column)
        elif command == "\\partial" and (match := PARTIAL.match(self.text, start, self.end)):
            self.partial(match)
        elif word := upright(self.text, start):
            self.at = word[1]
            self.upright(word[0], start)
        elif letters := stems(command[1:]):
            self.at += len(command)
            self.named(letters, start)
        elif command[1:] in (*_ACCENTS, *DECORATIONS):
            self.accent(command)
        elif (cases := CASES.match(self.text, start, self.end)) or (command == "\\\\" and self.out.in_cases):
            self.case(cases.group() if cases else command)
        elif item := self.mark_or_function(command, column):
            self.at += len(command)
            self.put([item], column)
        elif not self.bracket(command, ""):
            self.refuse(column, f"{command} is not read", REMEDIES.get(command[1:], ""))

    def condition(self, said: re.Match[str], command: str) -> None:
        joint = {"\\wedge": "CAND", "\\land": "CAND", "\\vee": "COR", "\\lor": "COR"}.get(command)
        if said.group(1) in OTHERWISE or joint:
            self.out.emit(joint or "COTHERWISE", said.group(), self.at + 1)
        self.at = said.end()

    def mark_or_function(self, command: str, column: int) -> Mark | Function | None:
        if command in ("\\dd", "\\diff") or (command == "\\d" and not self.names.declares("d")):
            return Mark("d", column)
        if command == "\\partial":
            return Mark("partial", column)
        return Function(FUNCTIONS[command[1:]], column) if command[1:] in FUNCTIONS else None

    def delimiter(self, size: str) -> None:
        r"""Read the bracket after ``\left``, ``\bigr`` and the like."""
        match = _COMMAND.match(self.text, self.at, self.end)
        shown = match.group() if match else self.text[self.at : min(self.at + 1, self.end)]
        side = "open" if size.endswith(("left", "l")) else "close" if size.endswith(("right", "r")) else ""
        if size == "\\middle" and shown == "|":
            self.out.emit("COMMA", shown, self.at + 1)
            self.at += 1
            return
        if size == "\\middle" or not self.bracket(shown, side):
            self.refuse(self.at + 1, f"{size} belongs before a bracket", "write ( ), [ ], \\{ \\} or | |")

    def bracket(self, shown: str, side: str) -> bool:
        """Read a bracket; ``side`` says whether a bar opens or closes where it was told."""
        if shown == "(" and self.out.at_condition and CLAUSE.match(self.text, self.at, self.end):
            self.out.opened("(", "clause )", self.at + 1)
            self.at += 1
            return True
        if not self.out.bracket(shown, side, self.at + 1):
            return False
        self.at += len(shown)
        return True

    def refuse_open_bracket_of_cases(self) -> None:
        """Refuse a bracket that is open where a column or a row of ``cases`` ends, and go on as if it were not."""
        opened = self.out.open
        cases = max((k for k, bracket in enumerate(opened) if bracket.kind == "CASES"), default=len(opened))
        if unclosed := opened[cases + 1 :]:
            del opened[cases + 1 :]
            self.refuse(unclosed[0].column, f"{unclosed[0].shown} is never closed")

    def sign(self, character: str) -> None:
        column = self.at + 1
        if character == "&" and not self.out.in_cases:
            self.refuse_open_bracket_of_cases()
        if self.at in self.inner:
            self.out.emit("ATOM", "(…)", column, Group(self.inner[self.at], braces=False, column=column))
            self.at += 1
        elif character == "&" and self.out.in_cases:
            self.at += 1
            self.out.emit("CCOLUMN", "&", column)
        elif character in SIGNS:
            self.known_sign(character)
        elif fraction := figure(character):
            self.at += 1
            above, below = (Number(number, 1, column) for number in fraction)
            quotient = Product(((False, above), (True, below)), column)
            item = LatexFraction(quotient, numbers=True, column=column)
            self.out.emit("ATOM", character, column, item)
        elif (figures := raised_figures(self.text, self.at, self.end))[0]:
            self.out.raised_by(figures[0], column)
            self.at = figures[1]
        elif character == "∂":
            self.at += 1
            self.put([Mark("partial", column)], column)
        elif odd := letter(character):
            self.at += 1
            self.named(stems(odd[0]) or (odd[0],), column - 1, (), odd[1])
        elif (
            character == "{"
            and not self.out.singles
            and (braced := braced_name(self.text, self.at, self.end))
        ):
            self.at = braced[3]
            self.named(braced[0], column - 1, braced[1], braced[2])
        elif character == "{" and not self.out.singles and (word := upright(self.text, self.at)):
            self.at = word[1]
            self.upright(word[0], column - 1)
        elif not self.bracket(character, ""):
            shown = repr(character) if character.isascii() else f"{character!r} (U+{ord(character):04X})"
            self.refuse(column, f"{shown} is not part of a formula", remedy(character))

    def known_sign(self, character: str) -> None:
        """Read a sign of the grammar; √ before a bracket is the function."""
        column = self.at + 1
        self.at += 1
        if character == "√" and self.follows("("):
            self.put([Function("sqrt", column)], column)
        else:
            self.out.emit(SIGNS[character], character, column)

    def partial(self, match: re.Match[str]) -> None:
        r"""Read ``\partial_x``, ``\partial_x^2`` or ``\partial_{xy}``, a derivative that waits for its operand."""
        column = self.at + 1
        group = 2 if match.group(2) is not None else 3
        inside = words_of(self.text, self.names.scope, match.start(group), match.end(group)).words
        variables = [word.item for word in inside if isinstance(word.item, Name)]
        order = int(match.group(1) or match.group(4) or 1)
        if len(variables) < len(inside) or (
            order > 1 and (len(variables) > 1 or (match.group(1) and match.group(4)))
        ):
            self.refuse(column, "a derivative with respect to what?", r"write \frac{\partial V}{\partial x}")
        self.at = match.end()
        operator = Operator(total=False, variables=tuple((name, order) for name in variables), column=column)
        self.out.emit("ATOM", match.group(), column, operator)


def _blanks_end(text: str, at: int) -> int:
    while at < len(text) and text[at].isspace():
        at += 1
    return at


def _undeclared(name: str, column: int) -> Item | None:
    """Return what an undeclared Greek letter means all the same."""
    if name == "pi":
        return Name("pi", 0, column)
    return Mark("delta", column) if name == "delta" else None
