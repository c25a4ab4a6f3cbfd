"""Declared names in words as people type them: ``θ₁`` for ``theta1``, ``mgl`` for m g l, ``sinθ`` for sin of theta.

A word is read only where it can be read in one way. What is declared goes before every other meaning.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from canon.expression.text.tokens import GREEK, Atom, LanguageError, Token
from canon.expression.text.vocabulary import CONSTANTS, FUNCTIONS, OTHER_NAMES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.expression.text.scope import Scope

__all__ = ["Words", "function_name", "key_of"]

_MAX_RUN = 24
"""Letters of a word that is still taken apart."""
_PIECE = {"lambda": "lam", "lamda": "lam", "lmbda": "lam", "varphi": "phi", "vartheta": "theta", "eps": "epsilon",
          "varepsilon": "epsilon", "ell": "l", "varrho": "rho"}  # fmt: skip
_PARTS = re.compile(r"[A-Za-z]+|[0-9]+")
_CAPITAL = {name.capitalize(): name for name in (
    "sin", "cos", "tan", "cot", "sec", "csc", "sinh", "cosh", "tanh", "exp", "sqrt", "log", "sign"
)}  # fmt: skip
"""Functions as Mathematica writes them."""
_TWO_LETTERS = ("am", "sn", "cn", "dn")
"""Jacobi's functions as books write them, unless both letters are declared: then they are factors."""
_GREEK = frozenset(GREEK.values())
_INVERSE = ("asin", "acos", "atan", "acot", "asinh", "acosh", "atanh")
"""Functions that are a factor a and another function where a is declared."""
_CALLED = frozenset((
    *FUNCTIONS, "Derivative", "diff", "Piecewise", "Eq", "Ne", "Symbol", "Function", "Integer", "Rational", "Mul",
    "Add", "Pow", "Tuple", "Hold", "Times", "Plus", "Power", "pow", "Float", "Fraction", "Equality", "Equal",
    "power", "square", "rational", "And", "Or",
))  # fmt: skip


def key_of(name: str) -> str:
    """Return what two spellings of one name have in common.

    Examples
    --------
    >>> key_of("lambda_1") == key_of("lam1"), key_of("p_theta") == key_of("ptheta"), key_of("l") == key_of("L")
    (True, True, False)
    """
    parts: list[str] = _PARTS.findall(name)
    return "".join(_PIECE.get(part) or part for part in parts)


def function_name(word: str, scope: Scope) -> str:
    """Return the function of the language that a word means; empty where it means none, or is declared.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> function_name("arctan", Scope()), function_name("Sin", Scope()), function_name("foo", Scope())
    ('atan', 'sin', '')
    """
    if word in scope.functions or scope.symbol(word) is not None:
        return ""
    if word == "cotg" and scope.declares("g"):  # cot g, or that function
        return ""
    if word in _TWO_LETTERS and all(scope.declares(letter) for letter in word):
        return ""
    for name in (word, OTHER_NAMES.get(word, ""), _CAPITAL.get(word, "")):
        known = OTHER_NAMES.get(name, name)
        if known in FUNCTIONS:
            return known
    return ""


@dataclass(frozen=True, slots=True)
class _Part:
    """A piece of a word: a declared name, a function, a constant or a number."""

    kind: str
    text: str
    start: int
    end: int


class Words:
    """Reads the words of one text within a scope."""

    def __init__(self, text: str, scope: Scope) -> None:
        self.text = text
        self.scope = scope
        self.keys: dict[str, list[str]] = {}
        self.seen: dict[str, list[str]] = {}
        for name in scope.spelled:
            self.keys.setdefault(key_of(name), []).append(name)

    def declared(self, word: str) -> list[str]:
        """Return the declared names that a word spells: itself, or all that are spelled alike."""
        if word not in self.seen:
            itself = word in self.scope.functions or self.scope.symbol(word) is not None
            self.seen[word] = [word] if itself else self.keys.get(key_of(word), [])
        return self.seen[word]

    def read(self, token: Token, bracket: bool, divided: bool = False) -> list[Token]:
        """Return the tokens that a word stands for: one, or factors side by side, ``rdθ`` among them before a slash.

        Raises
        ------
        LanguageError
            Where it can be read in two ways.
        """
        if not token.atoms:
            return [token]
        found = self.declared(token.text)
        if token.text in found:
            return [replace(token, text=token.text)]
        if len(token.atoms) > _MAX_RUN:
            return [token]
        found = found or self._rate_in_letters(token)
        whole = [[_Part("name", name, 0, len(token.atoms))] for name in found]
        if not found and not bracket and function_name(token.text, self.scope) in _INVERSE:
            whole = [[_Part("function", token.text, 0, len(token.atoms))]]
        if not found and self._is_a_word(token, bracket):
            return [token]
        ways = [*whole, *self._split(token.atoms)]
        if len(ways) > 1:
            told = " or ".join(" ".join(part.text for part in way) for way in ways[:3])
            raise LanguageError(
                self.text, token.column, f"{token.text} can be read as {told}", "write * between factors"
            )
        if not ways:
            return (
                self._differential(token) or (self._before_differential(token) if divided else []) or [token]
            )
        return list(self._tokens(token, ways[0]))

    def _rate_in_letters(self, token: Token) -> list[str]:
        """Return the rate that programs write as ``xd`` or ``xdd``."""
        base = self.declared(token.text.rstrip("d")) if "_" not in token.text else []
        ending = {1: "_dot", 2: "_ddot"}.get(len(token.text) - len(token.text.rstrip("d")), "")
        return [rate for name in base if ending and self.scope.declares(rate := f"{name}{ending}")]

    def _is_a_word(self, token: Token, bracket: bool) -> bool:
        """Tell whether a word means something of its own: a function, a constant, a letter by its name."""
        name = token.text
        if bracket and (name in _CALLED or function_name(name, self.scope)):
            return True
        if function_name(name, self.scope) or name in _CALLED:
            return not any(way[-1].kind == "function" for way in self._split(token.atoms))
        return (name in CONSTANTS or name in _GREEK) and len(token.atoms) > 0 and not token.primes

    def _split(self, atoms: tuple[Atom, ...]) -> list[list[_Part]]:
        """Return the ways of reading a word as factors side by side, two of them at most."""
        ways: list[list[list[_Part]]] = [[[]]]
        for end in range(1, len(atoms) + 1):
            found: list[list[_Part]] = []
            for start in range(end):
                for way in ways[start]:
                    part = self._part(atoms, start, end, way)
                    if part is not None and not _repeats(way, part, atoms):
                        found.append([*way, part])
            ways.append(found[:3])
        return [way for way in ways[-1] if len(way) > 1][:2]

    def _part(self, atoms: tuple[Atom, ...], start: int, end: int, way: list[_Part]) -> _Part | None:
        piece = "".join(atom.plain for atom in atoms[start:end])
        marks = sum(1 for atom in atoms[start:end] if atom.rates)
        if "_" in (piece[0], piece[-1]) or marks > 1:
            return None
        if piece[0].isdigit():
            whole = piece.isdigit() and not (end < len(atoms) and atoms[end].plain.isdigit())
            after_function = bool(way) and way[-1].kind == "function"
            return _Part("number", piece, start, end) if whole and after_function and not marks else None
        names = self.declared(piece)
        if len(names) == 1 and (piece == names[0] or end < len(atoms) or start > 0):
            return _Part("name", names[0], start, end)
        return None if names or marks else self._of_vocabulary(piece, start, end)

    def _of_vocabulary(self, piece: str, start: int, end: int) -> _Part | None:
        if end - start == 1:
            return _Part("constant", "pi", start, end) if piece == "pi" else None
        is_function = piece not in ("th", "sh", "ch", "tg", "e") and function_name(piece, self.scope)
        return _Part("function", piece, start, end) if is_function else None

    def _tokens(self, token: Token, way: list[_Part]) -> Iterator[Token]:
        for part in way:
            atoms = token.atoms[part.start : part.end]
            rates = sum(atom.rates for atom in atoms)
            kind = "number" if part.kind == "number" else "name"
            tight = token.tight if part.start == 0 else True
            yield Token(kind, part.text, atoms[0].column, rates, tight)

    def _before_differential(self, token: Token) -> list[Token]:
        """Return the factors before a differential and that itself, for the ``rdθ`` of ``rdθ/dt``."""
        for start in (i for i, atom in enumerate(token.atoms) if i and atom.plain == "d"):
            before, rest = token.atoms[:start], token.atoms[start:]
            name = "".join(atom.plain for atom in before)
            found = [[_Part("name", n, 0, start)] for n in self.declared(name)] or self._split(before)
            end = self._differential(replace(token, atoms=rest, column=rest[0].column, tight=True))
            if len(found) == 1 and end and self.scope.declares(end[-1].text):
                return [*self._tokens(replace(token, atoms=before), found[0]), *end]
        return []

    def _differential(self, token: Token) -> list[Token]:
        """Return d and what it is of, for ``dθ`` or ``dt``."""
        first, *rest = token.atoms
        if first.plain != "d" or first.rates or not rest or self.scope.symbol("d") is not None:
            return []
        inner = replace(
            token,
            text="".join(atom.plain for atom in rest),
            atoms=tuple(rest),
            column=rest[0].column,
            tight=True,
        )
        names = self.declared(inner.text)
        if len(names) == 1:
            found = [replace(inner, text=names[0])]
        else:  # one product, or what is not declared and is told as such
            ways = self._split(tuple(rest))
            found = list(self._tokens(inner, ways[0])) if len(ways) == 1 else [inner]
        return [Token("name", "d", token.column, 0, token.tight), *found]


def _repeats(way: list[_Part], part: _Part, atoms: tuple[Atom, ...]) -> bool:
    """Tell whether a letter stands twice, as in words of a language: ``mass`` is not m a s s."""
    ascii_only = all(len(atom.plain) == 1 and not atom.rates for atom in atoms)
    return ascii_only and part.kind == "name" and any(p.text == part.text for p in way)
