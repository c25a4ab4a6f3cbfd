"""Quotients with a slash: where they end, as far as that is beyond doubt.

``1/2 m`` is half of m, ``1/2(a + b)`` of the sum, ``g/l sin θ`` and ``k/m x`` have g/l and k/m as factors: numbers, or
parameters before a function or before what moves, written without blanks and with one behind.
After a bracket the quotient ends, ``1/(2m) x``, and before one behind a blank, ``m/2 (a + b)``, ``E/w (a + b)``, as
before a function, ``x/2 sqrt(a)``; not where a momentum is divided, for ``p²/2 (m + M)`` may be p²/(2(m + M)). A
momentum over a number and a word is over all of it: ``p²/2m`` is p²/(2m); so is anything over ``2π``. Everything else
is refused with both readings: ``x/2m``, ``k/mx``, ``k/m a``.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.symbols.symbol import Momentum
from canon.expression.text.applied_functions import is_function
from canon.expression.text.syntax import Name, Negative, Node, Number, Power, Product, parts

if TYPE_CHECKING:
    from canon.expression.text.factor_parser import FactorParser

__all__ = ["divisor", "ended"]

_CLOSING = {"(": ")", "[": "]", "{": "}"}


def divisor(reader: FactorParser, factors: list[tuple[bool, Node]]) -> Node:
    """Return what a slash divides by, the last factor read, with what is written as one word with it."""
    below = factors[-1][1]
    if not (isinstance(below, Number) and reader.token.tight):
        return below
    if _is_circle(reader):
        return Product(((False, below), (False, reader.power())), below.column)
    if not _holds_momentum(reader, factors[:-1]):
        return below
    taken: list[Node] = [below]
    start = reader.at
    while reader.token.tight and reader.token.kind == "name" and not is_function(reader):
        node = reader.power()
        base = node.base if isinstance(node, Power) else node
        if not isinstance(base, Name) or base.primes or (not taken[1:] and not _steady(reader, base)):
            break
        taken.append(node)
    else:
        if not reader.starts(reader.token) and taken[1:]:
            return Product(tuple((False, node) for node in taken), below.column)
    reader.at = start
    return below


def _is_circle(reader: FactorParser) -> bool:
    """Tell whether π stands here, behind its number, and nothing else as a factor: ``E/2π``."""
    pi = reader.token
    if pi.text not in ("pi", "π") or pi.primes or reader.scope.declares(pi.text):
        return False
    behind = reader.tokens[reader.at + 1]
    return not behind.tight or not (
        reader.starts(behind) or behind.kind == "super" or behind.text in ("^", "**")
    )


def _holds_momentum(reader: FactorParser, factors: list[tuple[bool, Node]]) -> bool:
    """Tell whether a momentum stands in one of the factors."""
    names = (n for _, above in factors for n in parts(above) if isinstance(n, Name))
    return any(isinstance(reader.scope.symbol(name.text), Momentum) for name in names)


def _steady(reader: FactorParser, node: Node) -> bool:
    """Tell whether a factor is a number or a parameter."""
    if isinstance(node, Name):
        return not node.primes and not reader.scope.moves(node.text)
    return isinstance(node, Number)


def _is_single(reader: FactorParser, node: Node) -> bool:
    """Tell whether a divisor is a number, a parameter or a power of one."""
    return _steady(reader, node.base if isinstance(node, Power) else node)


def _signless(node: Node) -> Node:
    """Return a factor without the minus before it."""
    return node.operand if isinstance(node, Negative) else node


def ended(reader: FactorParser, factors: list[tuple[bool, Node]], starts: list[int]) -> None:
    """Refuse a factor after a quotient unless the quotient ends before it beyond doubt.

    Raises
    ------
    LanguageError
        With both readings.
    """
    begin, end = starts[-2], reader.at
    piece = reader.tokens[begin:end]
    slash = starts[-1] - begin
    below = piece[slash + 1 :]
    bracketed = below[-1].text == _CLOSING.get(below[0].text)
    tight = all(t.tight for t in piece[slash:]) and not reader.token.tight
    over, under = _signless(factors[-2][1]), factors[-1][1]
    plain = isinstance(over, Number) and isinstance(under, Number)
    apart = reader.token.text == "(" or (is_function(reader) and isinstance(under, Number))
    plain = plain or (apart and _is_single(reader, under) and not _holds_momentum(reader, factors[:-1]))
    goes_on = is_function(reader) or (reader.token.kind == "name" and reader.scope.moves(reader.token.text))
    steady = goes_on and all(_steady(reader, _signless(node)) for _, node in factors)
    half = reader.token.text == "(" and isinstance(over, Number) and isinstance(under, Number)
    if bracketed or (tight and (plain or steady)) or (half and all(t.tight for t in piece[slash:])):
        return
    shown = reader.text[piece[0].column - 1 : reader.token.column - 1].strip()
    after = reader.text[reader.token.column - 1 :].split(" ")[0]
    factor = re.split(r"[-+*/)\]}=,]", after)[0][:20] or reader.token.text
    blank = "" if reader.token.tight else " "
    above, _, lower = shown.rpartition("/")
    above, lower = above.strip()[-40:], lower.strip()[:40]
    raise reader.fault(
        f"{above}/{lower}{blank}{factor} is {above}/{lower}*{factor} or {above}/({lower}*{factor})?",
        "write the one that is meant",
    )
