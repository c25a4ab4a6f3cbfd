"""Tokens of text: numbers, names and signs, and the error that points at a column.

Greek letters and Newton's dots are spelled the plain way here: ``θ̇`` becomes ``theta`` with one prime.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

__all__ = ["GREEK", "Atom", "LanguageError", "Token", "tokens"]

MAX_CHARACTERS = 50_000
MAX_TOKENS = 20_000
MAX_DIGITS = 1_000
MAX_SMALL = 9
"""Small figures in a row."""
MAX_FAULTS = 5
"""Most faults of one text that are told at once."""
MAX_REASON = 300
"""Characters of a reason that are told; only a name in it can make it longer."""


class LanguageError(ValueError):
    """Raised for text that is not in the expression language, with the column where it goes wrong.

    Parameters
    ----------
    text
        The whole text.
    column
        Where it goes wrong, counted from 1.
    reason
        What is wrong there.
    remedy
        What to write instead; empty where there is no single answer.
    others
        What else is wrong in the same text.
    """

    def __init__(
        self, text: str, column: int, reason: str, remedy: str = "", others: tuple[LanguageError, ...] = ()
    ) -> None:
        super().__init__(text, column, reason, remedy, others)
        self.text = text
        self.column = column
        self.reason = reason
        self.remedy = remedy
        self.others = others

    @classmethod
    def together(cls, faults: Sequence[LanguageError]) -> LanguageError:
        """Return one error that tells several, the first of them first; what is said twice is told once."""
        told: dict[tuple[str, str], LanguageError] = {}
        for fault in sorted(faults, key=lambda fault: fault.column):
            told.setdefault((fault.reason, fault.remedy), fault)
        first, *others = told.values()
        return cls(first.text, first.column, first.reason, first.remedy, tuple(others[: MAX_FAULTS - 1]))

    @property
    def message(self) -> str:
        """Reason and remedy on one line, long names in them cut, and after them those of the other faults."""
        reason = self.reason if len(self.reason) <= MAX_REASON else f"{self.reason[:MAX_REASON]}…"
        told = f"{reason}; {self.remedy}" if self.remedy else reason
        more = (
            f"also column {o.column}: {o.reason if o.remedy == self.remedy else o.message}"
            for o in self.others
        )
        return "; ".join((told, *more))

    def at_home_in(self, text: str, place: Callable[[int], int] = int) -> LanguageError:
        """Return the same error in the text it comes from, ``place`` telling the column there."""
        others = tuple(other.at_home_in(text, place) for other in self.others)
        return LanguageError(text, place(self.column), self.reason, self.remedy, others)

    def caret(self) -> str:
        """Return the text around the fault with a caret under the column."""
        start = max(0, self.column - 41)
        shown = re.sub(r"[^\S ]", " ", self.text[start : start + 80])
        return f"{shown}\n{' ' * (self.column - 1 - start)}^"

    def __str__(self) -> str:
        return f"column {self.column}: {self.message}\n{self.caret()}"


_SUPER = "⁰¹²³⁴⁵⁶⁷⁸⁹"
_SUB = {
    **dict(zip("₀₁₂₃₄₅₆₇₈₉ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ", "0123456789aehijklmnoprstuvx", strict=True)),
    **dict(zip("ᵦᵧᵨᵩᵪ", ("beta", "gamma", "rho", "phi", "chi"), strict=True)),
}
_VULGAR = "½¼¾⅓⅔⅕⅖⅗⅘⅙⅚⅛⅜⅝⅞"
_PRIMES = {"'": 1, "′": 1, "’": 1, "ʹ": 1, "´": 1, '"': 2, "″": 2, "”": 2, "‴": 3}
_MARKS = {"\u0307": 1, "˙": 1, "\u0308": 2, "¨": 2}
_LETTER = rf"(?:[^\W\d_{_SUPER}{_VULGAR}{''.join(_SUB)}ⁿ]|\\\[[A-Z][A-Za-z]{{1,20}}\])"
_AFTER = (
    rf"(?:{_LETTER}|[0-9_{''.join(_SUB)}{''.join(_MARKS)}{''.join(_PRIMES)}]|(?<=_)\{{[^{{}}\s]{{1,12}}\}})"
)
_TOKEN = re.compile(
    r"(?P<space>[\s\u2061\u2062\u2063]+|'(?=(?:diff|integrate|sum)\b)|\\(?=[*_^])"
    r"|(?:np|numpy|math|sp|sympy|sym|sy|sm|smp|mpmath|cmath)\.(?=[A-Za-z])|[.,;](?=\s*$))"
    r"|(?P<string>'[A-Za-z_]\w{0,40}'|\"[A-Za-z_]\w{0,40}\")"
    r"|(?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    rf"|(?P<vulgar>[{_VULGAR}])"
    rf"|(?P<super>[⁺⁻]?[{_SUPER}]+|⁻?ⁿ)"
    r"|(?P<half>S\.Half(?!\w))"
    rf"|(?P<name>_{{0,2}}{_LETTER}{_AFTER}*|%(?:pi|e|i)(?!\w))"
    r"|(?P<operator>\.diff(?=\()|\*\*|<=|>=|!=|==|:=|[-+*/^()\[\]{}|<>=,−–·×⋅∙•∗÷∕⁄√∛∜≤≥≠∂°])"
)
GREEK = {
    "α": "alpha", "β": "beta", "γ": "gamma", "δ": "delta", "ε": "epsilon", "ζ": "zeta", "η": "eta", "θ": "theta",
    "ϑ": "theta", "ι": "iota", "κ": "kappa", "λ": "lambda", "μ": "mu", "ν": "nu", "ξ": "xi", "π": "pi", "ρ": "rho",
    "σ": "sigma", "τ": "tau", "υ": "upsilon", "φ": "phi", "ϕ": "phi", "χ": "chi", "ψ": "psi", "ω": "omega",
    "Γ": "Gamma", "Δ": "Delta", "Θ": "Theta", "Λ": "Lambda", "Ξ": "Xi", "Π": "Pi", "Σ": "Sigma", "Υ": "Upsilon",
    "Φ": "Phi", "Ψ": "Psi", "Ω": "Omega", "ϖ": "varpi",
}  # fmt: skip
_ALIKE = {"−": "-", "–": "-", "·": "*", "×": "*", "⋅": "*", "∙": "*", "•": "*", "∗": "*", "÷": "/", "∕": "/",
          "⁄": "/", "≤": "<=", "≥": ">=", "≠": "!=", ":=": "="}  # fmt: skip
_LETTERS = {**GREEK, "ℓ": "ell", "ℏ": "hbar", "ħ": "hbar", "ϵ": "epsilon", "ϱ": "rho", "ς": "sigma",
            "µ": "mu", "∆": "Delta", "Ω": "Omega", "ℋ": "H", "ℒ": "L", "ℛ": "R", "ℱ": "F", "ℰ": "E", "ℳ": "M",
            "ı": "i", "ⅇ": "e", "ⅆ": "d", "ⅈ": "I"}  # fmt: skip
_NOT_HERE = {
    "∫": "write the integral out, as a function of its ends",
    "∑": "write its terms one by one, with + between",
    "∏": "write its factors one by one, with * between",
    "±": "it stands for two answers; write the one that is meant",
    "∓": "it stands for two answers; write the one that is meant",
    "∞": "an expression is finite; write a bound as a condition without it",
    "≈": "write = for an equation",
    "∇": "write the partial derivatives, ∂V/∂x",
    "!": "there is no factorial; write the number",
    "%": "write a fraction of 100",
    "&": "write And(a, b) for conditions",
    '"': "there are no string literals",
    "'": "a prime belongs directly after the name of a coordinate; there are no string literals",
    ".": "attributes are not part of the language; write 0.5 for a decimal",
    ":": "lambdas and slices are not part of the language",
    ";": "one expression is asked for here",
}


@dataclass(frozen=True, slots=True)
class Atom:
    """A letter or digit of a word, and the dots or primes on it; ``θ̇`` is ``theta`` with one."""

    plain: str
    rates: int
    column: int


@dataclass(frozen=True, slots=True)
class Token:
    """A number, a word, an operator or the end.

    Parameters
    ----------
    kind
        ``number``, ``vulgar`` (½), ``super`` (²), ``name``, ``string``, ``operator`` or ``end``.
    text
        What it is in plain spelling.
    column
        Where it stands, counted from 1.
    primes
        Newton's dots, or primes, of a name.
    tight
        Whether nothing stands between it and the token before.
    atoms
        The letters and digits of a word.
    """

    kind: str
    text: str
    column: int
    primes: int = 0
    tight: bool = False
    atoms: tuple[Atom, ...] = ()


def tokens(text: str) -> list[Token]:
    """Return the tokens of a text, the end among them.

    Raises
    ------
    LanguageError
        Where the text is too long, or holds what is not part of the language.

    Examples
    --------
    >>> [token.text for token in tokens("2*θ'")]
    ['2', '*', 'theta', '']
    """
    if len(text) > MAX_CHARACTERS:
        raise LanguageError(
            text,
            MAX_CHARACTERS,
            f"{len(text)} characters, and at most {MAX_CHARACTERS} are read",
            "split the claim",
        )
    found: list[Token] = []
    at = 0
    tight = False
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise _stray(text, at)
        if match.lastgroup != "space":
            found.append(_token(text, match, tight))
            if len(found) > MAX_TOKENS:
                raise LanguageError(
                    text, at + 1, f"more than {MAX_TOKENS} numbers, names and signs", "split the claim"
                )
        tight = match.lastgroup != "space"
        at = match.end()
    found.append(Token("end", "", len(text) + 1))
    return found


def _token(text: str, match: re.Match[str], tight: bool) -> Token:
    column, kind = match.start() + 1, match.lastgroup or ""
    word = match.group()
    match kind:
        case "number" if sum(c.isdigit() for c in word) > MAX_DIGITS:
            raise LanguageError(text, column, f"a number of more than {MAX_DIGITS} digits")
        case "name" if word.startswith("%"):
            return Token("name", word, column, tight=tight)
        case "name":
            atoms = tuple(_atoms(text, word, column))
            primes = sum(atom.rates for atom in atoms)
            return Token("name", "".join(atom.plain for atom in atoms), column, primes, tight, atoms)
        case "super" if len(word) > MAX_SMALL:
            raise LanguageError(text, column, f"an exponent of more than {MAX_SMALL} figures")
        case "super":
            return Token(kind, unicodedata.normalize("NFKC", word).replace("−", "-"), column, tight=tight)
        case "half":
            return Token("vulgar", "½", column, tight=tight)
        case "operator":
            return Token(kind, _ALIKE.get(word, word), column, tight=tight)
        case _:
            return Token(kind, word, column, tight=tight)


def _atoms(text: str, word: str, column: int) -> Iterator[Atom]:
    """Yield the letters and digits of a word in plain spelling, subscripts as ``_1``."""
    plain, rates, start = "", 0, column
    lowered = False
    for match in _LETTERS_OF_WORD.finditer(word):
        letter, at = match.group(), column + match.start()
        sub = _SUB.get(letter) or (letter[1:-1] if letter.startswith("{") else "")
        marks = _rates(letter)
        if marks:
            rates += marks
            continue
        if plain:
            yield Atom(plain, rates, start)
            plain, rates = "", 0
        if sub and not lowered and not letter.startswith("{"):
            yield Atom("_", 0, at)
        lowered = bool(sub)
        start = at
        if letter.startswith("{"):
            yield from (Atom(_plain(text, c, at)[0], 0, at) for c in sub if c not in "_,")
        elif sub:
            plain = sub
        else:
            plain, rates = _plain(text, letter, at)
    if plain:
        yield Atom(plain, rates, start)


_LETTERS_OF_WORD = re.compile(r"\\\[\w+\]|\{[^{}]*\}|.", re.DOTALL)


def _rates(letter: str) -> int:
    return _PRIMES.get(letter) or _MARKS.get(letter, 0)


def _plain(text: str, letter: str, column: int) -> tuple[str, int]:
    """Return the plain spelling of a letter, and how many dots it has in one character with it."""
    if letter.startswith("\\["):
        return _of_mathematica(letter), 0
    if "\U0001d400" <= letter <= "\U0001d7ff":  # italic and bold letters, as they are copied from a page
        letter = unicodedata.normalize("NFKC", letter)
    base, *marks = unicodedata.normalize("NFD", letter)
    plain = _LETTERS.get(letter) or _LETTERS.get(base, base)
    if plain.isascii() and all(mark in _MARKS for mark in marks):
        return plain, sum(_MARKS[mark] for mark in marks)
    raise LanguageError(
        text,
        column,
        f"{letter!r} (U+{ord(letter):04X}) is not a letter of the language",
        "names are made of Latin or Greek letters, digits and _",
    )


def _of_mathematica(letter: str) -> str:
    r"""Return the plain name of Mathematica's ``\[Theta]`` or ``\[CapitalPhi]``."""
    name = letter[2:-1]
    capital = name.startswith("Capital") and len(name) > 7
    name = name.removeprefix("Capital").removeprefix("Curly").removeprefix("Script").lower()
    return name.capitalize() if capital else name


def _stray(text: str, at: int) -> LanguageError:
    character = text[at]
    shown = repr(character) if character.isascii() else f"{character!r} (U+{ord(character):04X})"
    return LanguageError(text, at + 1, f"{shown} is not part of the language", _NOT_HERE.get(character, ""))
