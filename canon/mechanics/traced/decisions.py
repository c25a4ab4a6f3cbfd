"""Decisions: a function that branches is called once for every way it can go, and its formulas are put together.

Where it asks whether something that moves is positive, each call is told which way to go; what comes of both ways are
the pieces of a ``Piecewise``. So ``if``, ``max``, ``np.where`` and whatever else asks for a truth value can be read.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import sympy as sp
from sympy.core.relational import Relational

from canon.expression.symbols.symbol import time

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sympy import Basic, Expr
    from sympy.logic.boolalg import Boolean

__all__ = ["Decisions", "along_all_ways"]

MOST_WAYS = 400
MOST_OPERATIONS = 500
"""Parts of a question that is written in one way, whichever side it was asked from."""

MOST_OF_TIME = 40
"""Parts of a question about the time alone that is answered where it is asked too early or too late to change."""

MOST_NESTED = 60
"""How deep a formula may be nested whose sign is asked for; each turn of a loop makes it deeper."""

MOST_QUESTIONS = 100
"""Questions of one call; a loop that runs until something that moves is small asks without end."""


class Decisions:
    """The answers to the questions of one call: those that are given, then yes.

    Parameters
    ----------
    given
        The first answers.
    span
        Two times between which the others lie, so that what never comes is not asked for.
    """

    def __init__(self, given: Sequence[bool] = (), span: tuple[float, float] | None = None) -> None:
        self.span = span
        self.asked: list[tuple[Boolean, bool]] = []
        self._given = given
        self._known: dict[Boolean, bool] = {}

    def decide(self, condition: Boolean) -> bool:
        """Return the answer to a question, the same each time it is asked.

        Raises
        ------
        TypeError
            There were too many.
        """
        written, nested = _size_and_depth(condition, {})
        if nested > MOST_NESTED:
            raise TypeError(
                f"it asks for the sign of a formula that is nested more than {MOST_NESTED} deep, as a loop does that "
                "runs until something that moves is small: run it a fixed number of times"
            )
        if isinstance(condition, Relational) and written <= MOST_OPERATIONS:
            condition = cast("Boolean", condition.canonical)
        if condition in (sp.true, sp.false):
            return bool(condition)
        of_time = written <= MOST_OF_TIME and condition.free_symbols == {time}
        if self.span is not None and condition not in self._known and of_time:
            ends = {_holds_at(condition, t) for t in self.span}
            if ends in ({True}, {False}):
                return ends == {True}
        if condition not in self._known:
            i = len(self.asked)
            if i == MOST_QUESTIONS:
                raise TypeError(
                    f"it asks more than {MOST_QUESTIONS} times for the sign of something that moves"
                )
            answer = self._given[i] if i < len(self._given) else True
            self.asked.append((condition, answer))
            self._known |= {condition: answer, sp.Not(condition): not answer}
        return self._known[condition]


def _size_and_depth(part: Basic, known: dict[Basic, tuple[int, int]]) -> tuple[int, int]:
    """Return how many parts a formula has when it is written out, and how deep; what occurs twice is looked at once."""
    if part not in known:
        inner = [_size_and_depth(each, known) for each in part.args]
        known[part] = (1 + sum(size for size, _ in inner), 1 + max((depth for _, depth in inner), default=0))
    return known[part]


def _holds_at(condition: Boolean, t: float) -> bool | None:
    """Tell whether a condition that is monotonous in the time holds at an instant; None of other conditions."""
    if not isinstance(condition, Relational) or isinstance(condition, sp.Eq | sp.Ne):
        return None
    left: Any = condition.lhs
    gap: Any = left - condition.rhs
    return bool(condition.subs(time, sp.Rational(t))) if gap.diff(time).is_number else None


def along_all_ways(
    call: Callable[[Decisions], list[Expr]], span: tuple[float, float] | None = None
) -> list[Expr]:
    """Return what a function returns, in pieces by the questions it asks.

    A way that an assertion of the function's own rules out is left out, and one on which it raises an error of its own
    where something that moves has exactly one value.

    Parameters
    ----------
    call
        Calls the function, which asks the decisions it is given.
    span
        When it is called.

    Raises
    ------
    TypeError
        There are too many ways, or it raises an error on one of them.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> along_all_ways(lambda d: [x if d.decide(x > 0) else -2 * x, sp.Integer(1)])
    [Piecewise((x, x > 0), (-2*x, True)), 1]
    """
    count = 0

    def from_here(given: list[bool]) -> list[Expr] | None:
        nonlocal count
        count += 1
        if count > MOST_WAYS:
            raise TypeError(f"there are more than {MOST_WAYS} ways through it, by signs of what moves")
        decisions = Decisions(given, span)
        found = _along_one_way(call, decisions)
        for i in reversed(range(len(given), len(decisions.asked))):
            before = [answer for _, answer in decisions.asked[:i]]
            found = _either(decisions.asked[i][0], found, from_here([*before, False]))
        return found

    whole = from_here([])
    if whole is None:
        raise TypeError("its own assertions rule out all ways through it")
    return whole


def _along_one_way(call: Callable[[Decisions], list[Expr]], decisions: Decisions) -> list[Expr] | None:
    """Return what a function returns on one way, None where that has no end."""
    try:
        return call(decisions)
    except AssertionError:
        return None
    except (ArithmeticError, RuntimeError, LookupError, NameError, ValueError) as raised:
        held = [condition if answer else sp.Not(condition) for condition, answer in decisions.asked]
        if any(isinstance(condition, sp.Eq) for condition in held):
            return None
        if not held:
            raise
        where = " and ".join(map(str, held))
        raise TypeError(
            f"it raises {type(raised).__name__} where {where}: leave that out, and watch it by an event"
        ) from raised


def _either(condition: Boolean, yes: list[Expr] | None, no: list[Expr] | None) -> list[Expr] | None:
    if yes is None or no is None or len(yes) != len(no):
        return no if yes is None else yes
    return [a if a == b else sp.Piecewise((a, condition), (b, True)) for a, b in zip(yes, no, strict=True)]
