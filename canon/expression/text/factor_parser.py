"""Parser of what makes one factor where names are declared: exponents, roots, moduli, brackets of any shape."""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.expression.text.declared_names import Words
from canon.expression.text.syntax import (
    Call,
    LanguageError,
    Name,
    Negative,
    Node,
    Number,
    Parser,
    Power,
    Tuple,
)
from canon.expression.text.tokens import MAX_TOKENS, Token, tokens
from canon.expression.text.units import OF_MECHANICS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.expression.text.scope import Scope

__all__ = ["CLOSING", "ROOTS", "FactorParser"]

CLOSING = {"(": ")", "[": "]", "{": "}"}
"""The bracket that ends one."""
ROOTS = {"√": 2, "∛": 3, "∜": 4}
"""Signs of roots."""


class FactorParser(Parser):
    """The grammar of factors, with the names that are declared."""

    def __init__(self, text: str, scope: Scope) -> None:
        self.words = Words(text, scope)
        super().__init__(text, list(_words(tokens(text), self.words)))
        self.scope = scope
        self.bars = 0
        self.bare_end = -1
        """Where the last argument without brackets ended."""
        self.bare_start: tuple[Token, ...] = ()
        """Its function, and where it began."""

    def starts(self, token: Token) -> bool:
        """Tell whether a factor can begin with a token."""
        if token.kind in ("number", "vulgar", "name", "string"):
            return True
        return token.text in ("(", "[", "{", *ROOTS, "∂") or (token.text == "|" and not self.bars)

    def raised(self, token: Token) -> Node:
        """Return the exponent that small figures spell."""
        if token.text.endswith("n"):
            node: Node = Name("n", 0, token.column)
        else:
            node = Number(int(token.text.lstrip("+-")), 1, token.column)
        return Negative(node, token.column) if token.text.startswith("-") else node

    def exponent(self, sign: Token) -> Node:
        """Read an exponent; ``x^1/2`` could be x or its root."""
        begin = self.token
        node = self.signed()
        if begin.text == "1" and self.token.text == "/" and self.token.tight:
            raise self.fault("is only 1 raised, or the fraction?", "write x**(1/2), or x/2", begin)
        if begin.text == "-" and sign.text == "^" and self.starts(self.token) and self.token.tight:
            raise self.fault("does this still belong to the exponent?", "write brackets, e^(-a*t)")
        return node

    def root(self, sign: Token) -> Node:
        """Read what stands under √, ∛ or ∜: a bracket, a number or a name."""
        self.deeper(sign)
        radicand = self.atom()
        self.depth -= 1
        last = self.tokens[self.at - 1]
        bracketed, degree = last.text in (")", "]", "}"), ROOTS.get(sign.text, 2)
        follows = self.token
        number = isinstance(radicand, Number)
        more = (
            (follows.tight and self.starts(follows))
            or (follows.text in ("/", "^", "**") and not number)
            or follows.kind == "super"
        )
        if not bracketed and more:
            remedy = "write sqrt( ) around what is under it" if degree == 2 else "write brackets around it"
            raise self.fault("how far does the root reach?", remedy, sign)
        if degree == 2:
            return Call("sqrt", (radicand,), sign.column)
        return Power(radicand, Number(1, degree, sign.column), sign.column)

    def modulus(self, bar: Token) -> Node:
        """Read what stands between two bars."""
        self.deeper(bar)
        self.bars += 1
        inside = self.sum()
        self.bars -= 1
        self.depth -= 1
        if not self.take("|"):
            raise self.fault("'|' is never closed", token=bar)
        return Call("Abs", (inside,), bar.column)

    def group(self, opening: Token) -> Node:
        """Read a bracket of any shape, or the pair in it."""
        bars, self.bars = self.bars, 0
        self.deeper(opening)
        items = [self.comparison()]
        comma = False
        while not self.take(CLOSING[opening.text]):
            if not self.take(","):
                raise self.unclosed(opening)
            comma = True
            if self.token.text != CLOSING[opening.text]:
                items.append(self.comparison())
        self.depth -= 1
        self.bars = bars
        return Tuple(tuple(items), opening.column) if comma else items[0]

    def unclosed(self, opening: Token) -> LanguageError:
        """Return the error of a bracket that does not end here."""
        if self.token.text in (")", "]", "}") and self.token.text != CLOSING[opening.text]:
            return self.fault(
                f"{opening.text!r} is closed by {self.token.text!r}", "close each bracket as it was opened"
            )
        if self.token.kind == "end":
            return self.fault(f"{opening.text!r} is never closed", token=opening)
        reason = f"an operator or {CLOSING[opening.text]!r} is missing before {self.token.text!r}"
        return self.fault(reason, "write * for a product")


def _words(found: list[Token], words: Words) -> Iterator[Token]:
    """Yield the tokens with each word read; all words that can be read in two ways are told at once."""
    faults: list[LanguageError] = []
    count = 0
    for before, token, after in zip([found[-1], *found], found, [*found[1:], found[-1]], strict=False):
        if token.kind != "name":
            yield token
            continue
        try:
            read = words.read(token, after.text in ("(", "[") and after.tight, after.text == "/")
            if before.kind == "number" and token.text in OF_MECHANICS and len(read) > 1:
                shown = "*".join(part.text for part in read)
                told = f"is {token.text} a unit, or {shown}?"
                raise LanguageError(words.text, token.column, told, f"write {shown}, or [{token.text}]")
            count += len(read)
            if count > MAX_TOKENS:
                told = f"more than {MAX_TOKENS} numbers, names and signs"
                raise LanguageError(words.text, token.column, told, "split the claim")
            yield from read
        except LanguageError as fault:
            faults.append(fault)
    if faults:
        raise LanguageError.together(faults)
