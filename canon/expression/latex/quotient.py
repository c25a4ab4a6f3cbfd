r"""Quotients with a slash: what ``/`` divides by, ``p^2/2m`` and ``g/l\sin\theta`` among them; open ones are refused.

A slash divides by one factor. Two habits of print go further, and both are read: a moving quantity over a number and
parameters, ``p^2/2m``, is p²/(2m); a quotient of two parameters before a function, ``g/l\sin\theta``, ends before the
function. A momentum over a number and a word that begins with a parameter, ``p_\phi^2/2mr^2``, is over all of it, as in
plain text. ``1/2m``, ``a/bc`` and ``k/2 x^2`` are refused with both readings.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.latex.pieces import Piece, Powered, is_function, names_in, whole
from canon.expression.symbols.symbol import Momentum, Rate
from canon.expression.text.syntax import Call, Name, Negative, Node, Number, Power, Product

if TYPE_CHECKING:
    from canon.expression.latex.argument_end import ArgumentEnd

__all__ = ["dividing", "shown"]


def dividing(
    above: list[Node], items: tuple[Piece, ...], below: list[Node], known: ArgumentEnd, text: str
) -> int | None:
    """Return how many of the factors behind a slash it divides by, None where that is open.

    Parameters
    ----------
    above
        The factors before the slash.
    items, below
        What stands behind it, as pieces and as factors.
    known
        What is known of the names.
    text
        The text in which they stand.
    """
    if len(below) == 1:
        return 1
    parameters = all(_is_name(item) for item in items[1:]) and not any(known.moves(node) for node in below)
    if whole(below[0]) is not None and parameters and any(map(known.moves, above)):
        return len(below)
    if whole(below[0]) is not None and _over_a_word(above, items, known, text):
        return len(below)
    coefficient = not any(map(known.moves, above)) and not all(map(known.is_numeric, above))
    if coefficient and isinstance(below[0], Name) and not known.moves(below[0]) and is_function(items[1]):
        return 1
    return None


def _over_a_word(above: list[Node], items: tuple[Piece, ...], known: ArgumentEnd, text: str) -> bool:
    r"""Tell whether a momentum stands over a number, a parameter and names without a gap, ``p_\phi^2/2mr^2``."""
    scope, names = known.scope, [_base(item) for item in items[1:]]
    momentum = any(isinstance(scope.symbol(name.text), Momentum) for node in above for name in names_in(node))
    words = [name for name in names if isinstance(name, Name)]
    if not momentum or not words or len(words) < len(names) or known.moves(words[0]):
        return False
    rates = any(isinstance(scope.symbol(word.text), Rate) for word in words)
    between = text[items[0].column - 1 : items[-1].column - 1]
    return not rates and not re.search(r"\s|\\[,;:!> ]|\\q?quad|~", between)


def _base(item: Piece) -> Piece:
    return item.base if isinstance(item, Powered) else item


def _is_name(item: Piece) -> bool:
    return isinstance(_base(item), Name)


def shown(factors: list[Node]) -> str:
    """Return factors in plain spelling, as far as they are short."""
    return " ".join(map(_shown, factors[:4])) + (" …" if factors[4:] else "")


def _shown(node: Node) -> str:
    match node:
        case Number(numerator, denominator):
            return str(numerator) if denominator == 1 else f"{numerator / denominator:.6g}"
        case Name(text):
            return text
        case Power(base, exponent):
            return f"{_shown(base)}^{_shown(exponent)}"
        case Negative(operand):
            return f"-{_shown(operand)}"
        case Call(function, arguments):
            return f"{function}({', '.join(map(_shown, arguments[:2]))})"
        case Product(factors) if len(factors) < 4 and not any(divides for divides, _ in factors):
            return "(" + " ".join(_shown(factor) for _, factor in factors) + ")"
        case Product(((False, first), (True, second))):
            return f"({_shown(first)}/{_shown(second)})"
        case _:
            return "(…)"
