"""Changes of an answer: which part, which mistake, with what; values, which a report puts into words."""

from __future__ import annotations

import enum
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from sympy import Expr

__all__ = ["Change", "Mistake", "rank"]


class Mistake(enum.Enum):
    """Kind of mistake in an answer; beside each kind stand the items that its change holds."""

    # a whole component
    WRONG_SIGN = enum.auto()
    WRONG_FACTOR = enum.auto()  # the factor that would be right
    # one of its terms
    TERM_SIGN = enum.auto()  # the term
    TERM_FACTOR = enum.auto()  # the term, what to multiply it with
    TERM_MISSING = enum.auto()  # the term
    CORIOLIS_TERM_MISSING = enum.auto()  # the term
    TERM_MISSING_IN = enum.auto()  # the bracket, the term
    TERM_SUPERFLUOUS = enum.auto()  # the term
    FACTOR_MISSING = enum.auto()  # where, the factor
    DIVISOR_MISSING = enum.auto()  # where, the divisor
    FACTOR_SUPERFLUOUS = enum.auto()  # the factor, where
    UPSIDE_DOWN = enum.auto()  # where, the fraction
    # what stands in a term: what was written, what is right
    FUNCTION = enum.auto()
    FUNCTION_MISSING = enum.auto()
    ARGUMENT = enum.auto()
    EXPONENT = enum.auto()
    SYMBOL = enum.auto()
    NUMBER = enum.auto()
    SQUARE = enum.auto()  # what should be squared
    VARIABLE_OF_DERIVATIVE = enum.auto()
    BRANCH = enum.auto()
    SIGN_OF = enum.auto()  # a symbol or function whose sign is wrong
    SYMBOLS_EXCHANGED = enum.auto()  # where, one, the other
    # dimensional analysis
    TERMS_OF_OTHER_DIMENSION = enum.auto()  # whether these are all, terms with their dimension, fewest first
    NO_NUMBER = enum.auto()  # where, the argument, its dimension
    DIMENSION_OF_ANSWER = enum.auto()  # its dimension, that of the right one
    # how the answer was derived
    DERIVATIVE_NOT_TOTAL = enum.auto()  # the terms that are missing
    DERIVATIVE_NOT_TOTAL_IN = enum.auto()  # the term whose number is wrong for it, what to multiply it with
    TIME_TERM_MISSING = enum.auto()  # the rate, the term
    TIME_DERIVATIVE_MISSING = enum.auto()
    TIME_DERIVATIVE_SIGN = enum.auto()
    MULTIPLIERS_OPPOSITE = enum.auto()  # the multipliers
    REACTIONS_OPPOSITE = enum.auto()  # the multipliers of constraints on velocities
    RULE_OPPOSITE = enum.auto()  # the rules
    NEW_FOR_OLD = enum.auto()  # the new variables
    OPPOSITE_CONVENTION = enum.auto()  # the convention here
    # what it is right for
    ONLY_FOR = enum.auto()  # the parameter, its value
    ONLY_WHERE = enum.auto()  # the expression, the relation to 0
    ONLY_SMALL = enum.auto()  # what is small, the order
    # other claims that were meant
    OTHER_TYPE = enum.auto()  # the type, the one that was said
    OTHER_ROUTHIAN = enum.auto()  # the convention
    INVERSE_MAP = enum.auto()
    MAP_EXCHANGED = enum.auto()
    EQUATIONS_EXCHANGED = enum.auto()
    OTHER_GAUGE = enum.auto()
    ONLY_EQUATIONS = enum.auto()
    # statements about the claim as a whole
    EQUATION_MISSING = enum.auto()
    FACTOR_OF_COVARIANT = enum.auto()  # the right one, the claimed one
    BRACKET_OPPOSITE = enum.auto()  # its name, its value, the wanted one
    VALENCE = enum.auto()  # the bracket's name, its value, the wanted one, what to multiply P with
    MAP_MENDED = enum.auto()  # the repair hint
    MORE_WRONG = enum.auto()  # how many
    AS_JUDGED = enum.auto()  # what the judge said when it refuted the claim


@dataclass(frozen=True, slots=True)
class Change:
    """Change of a wrong answer: the mistake, what it is about, and the component in which it is.

    Parameters
    ----------
    mistake
        What kind of thing.
    items
        What it is about, as :class:`Mistake` lists it.
    place
        The component in which it is; empty where the claim as a whole is meant.
    everywhere
        Whether it is so in every place of the component.
    inside
        The part of the component in which it is, where that is not the whole.
    """

    mistake: Mistake
    items: tuple[object, ...] = ()
    place: str = ""
    everywhere: bool = False
    inside: object = None

    @classmethod
    def of(cls, mistake: Mistake, *items: object, place: str = "") -> Change:
        """Return a change with its items one by one."""
        return cls(mistake, items, place)

    def at(self, place: str) -> Change:
        """Return the change as one of a component."""
        return replace(self, place=place)


_PLAIN = {
    Mistake.WRONG_SIGN: 0, Mistake.TERM_SIGN: 0,
    Mistake.WRONG_FACTOR: 1, Mistake.TERM_FACTOR: 1, Mistake.TERM_MISSING: 1, Mistake.CORIOLIS_TERM_MISSING: 1,
    Mistake.FUNCTION: 1, Mistake.TERM_MISSING_IN: 2,
    Mistake.EXPONENT: 1, Mistake.FACTOR_MISSING: 2, Mistake.FUNCTION_MISSING: 2, Mistake.UPSIDE_DOWN: 2,
    Mistake.SYMBOL: 2, Mistake.ARGUMENT: 2, Mistake.BRANCH: 2, Mistake.SIGN_OF: 2, Mistake.TERM_SUPERFLUOUS: 2,
}  # fmt: skip
_RARE = 3
_NATURAL = {"1/2", "2", "1/3", "3", "1/4", "4", "2/3", "3/2", "-1/2", "-2", "6", "1/6", "8", "1/8"}
"""Factors that people lose; 8/7 is none."""


def rank(change: Change) -> int:
    """Return how far back a change stands among those that would all make an answer right: the likeliest first.

    Examples
    --------
    >>> rank(Change.of(Mistake.TERM_SIGN, "x")), rank(Change.of(Mistake.TERM_FACTOR, "x", "8/7"))
    (0, 5)
    """
    found = _PLAIN.get(change.mistake, _RARE)
    if (
        change.mistake in (Mistake.TERM_FACTOR, Mistake.WRONG_FACTOR)
        and str(change.items[-1]) not in _NATURAL
    ):
        found = 5
    if change.mistake is Mistake.FACTOR_MISSING and getattr(change.items[-1], "is_Symbol", False):
        found = 2 if getattr(change.items[0], "is_Add", False) else 1
    if change.mistake is Mistake.FACTOR_MISSING and _is_fraction(change.items[-1]):
        found = _RARE
    return found + 2 * change.everywhere + (change.inside is not None)


def _is_fraction(factor: object) -> bool:
    """Whether a factor has symbols above and below the line, which nobody forgets at once."""
    if not hasattr(factor, "as_numer_denom"):
        return False
    return all(part.free_symbols for part in cast("Expr", factor).as_numer_denom())
