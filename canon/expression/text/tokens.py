"""Tokens of text: numbers, names and signs, and the error that points at a column.

Greek letters and Newton's dots are spelled the plain way here: ``θ̇`` becomes ``theta`` with one prime.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

__all__ = ["GREEK", "LanguageError", "Token", "tokens"]

MAX_CHARACTERS = 50_000
MAX_TOKENS = 20_000
MAX_DIGITS = 1_000
MAX_REASON = 300
"""Characters of a reason that are told; only a name in it can make it longer."""


class LanguageError(ValueError):
    """Text that is not in the expression language, and where.

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
    """

    def __init__(self, text: str, column: int, reason: str, remedy: str = "") -> None:
        super().__init__(text, column, reason, remedy)
        self.text = text
        self.column = column
        self.reason = reason
        self.remedy = remedy

    @property
    def message(self) -> str:
        """Reason and remedy on one line, long names in them cut."""
        reason = self.reason if len(self.reason) <= MAX_REASON else f"{self.reason[:MAX_REASON]}…"
        return f"{reason}; {self.remedy}" if self.remedy else reason

    def caret(self) -> str:
        """Return the text around the fault with a caret under the column."""
        start = max(0, self.column - 41)
        shown = re.sub(r"[^\S ]", " ", self.text[start : start + 80])
        return f"{shown}\n{' ' * (self.column - 1 - start)}^"

    def __str__(self) -> str:
        return f"column {self.column}: {self.message}\n{self.caret()}"


_TOKEN = re.compile(
    r"(?P<space>\s+)"
    r"|(?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[^\W\d][\w\u0307\u0308]*'*)"
    r"|(?P<operator>\*\*|<=|>=|!=|==|[-+*/()<>=,−·×])"
)
GREEK = {
    "α": "alpha", "β": "beta", "γ": "gamma", "δ": "delta", "ε": "epsilon", "ζ": "zeta", "η": "eta", "θ": "theta",
    "ϑ": "theta", "ι": "iota", "κ": "kappa", "λ": "lambda", "μ": "mu", "ν": "nu", "ξ": "xi", "π": "pi", "ρ": "rho",
    "σ": "sigma", "τ": "tau", "υ": "upsilon", "φ": "phi", "ϕ": "phi", "χ": "chi", "ψ": "psi", "ω": "omega",
    "Γ": "Gamma", "Δ": "Delta", "Θ": "Theta", "Λ": "Lambda", "Ξ": "Xi", "Π": "Pi", "Σ": "Sigma", "Υ": "Upsilon",
    "Φ": "Phi", "Ψ": "Psi", "Ω": "Omega",
}  # fmt: skip
_ALIKE = {"−": "-", "·": "*", "×": "*"}
_NOT_HERE = {
    "^": "write ** for a power, and a unit as 9.81 [m/s^2]",
    "[": "write ( ) for grouping; there is no indexing",
    "{": "write ( ) for grouping",
    '"': "there are no string literals",
    "'": "a prime belongs directly after the name of a coordinate; there are no string literals",
    ".": "attributes are not part of the language; write 0.5 for a decimal",
    ":": "lambdas and slices are not part of the language",
    "√": "write sqrt( )",
}


@dataclass(frozen=True, slots=True)
class Token:
    """A number, a name, an operator or the end; ``primes`` counts Newton's dots of a name."""

    kind: str
    text: str
    column: int
    primes: int = 0


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
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise _stray(text, at)
        if match.lastgroup != "space":
            found.append(_token(text, match))
            if len(found) > MAX_TOKENS:
                raise LanguageError(
                    text, at + 1, f"more than {MAX_TOKENS} numbers, names and signs", "split the claim"
                )
        at = match.end()
    found.append(Token("end", "", len(text) + 1))
    return found


def _token(text: str, match: re.Match[str]) -> Token:
    column = match.start() + 1
    word = match.group()
    if match.lastgroup == "number":
        if sum(c.isdigit() for c in word) > MAX_DIGITS:
            raise LanguageError(text, column, f"a number of more than {MAX_DIGITS} digits")
        return Token("number", word, column)
    if match.lastgroup == "name":
        return _named(text, word, column)
    return Token("operator", _ALIKE.get(word, word), column)


def _named(text: str, word: str, column: int) -> Token:
    """Spell Greek letters and Newton's dots the plain way."""
    primes = len(word) - len(word.rstrip("'"))
    name = unicodedata.normalize("NFD", word.rstrip("'"))
    if name.endswith(("\u0307\u0307", "\u0308")):
        primes += 2
    elif name.endswith("\u0307"):
        primes += 1
    plain = "".join(GREEK.get(c, c) for c in name.rstrip("\u0307\u0308"))
    if not plain.isascii():
        odd = next(i for i, c in enumerate(word) if not c.isascii() and c not in GREEK)
        raise LanguageError(
            text,
            column + odd,
            f"{word[odd]!r} (U+{ord(word[odd]):04X}) is not a letter of the language",
            "write **2 for a power"
            if unicodedata.category(word[odd]) == "No"
            else "names are made of Latin or Greek letters, digits and _",
        )
    return Token("name", plain, column, primes)


def _stray(text: str, at: int) -> LanguageError:
    character = text[at]
    shown = repr(character) if character.isascii() else f"{character!r} (U+{ord(character):04X})"
    return LanguageError(text, at + 1, f"{shown} is not part of the language", _NOT_HERE.get(character, ""))
