r"""Derivatives written as fractions: ``\frac{\partial^2 V}{\partial x\partial y}``, ``\frac{d\theta}{dt}``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NoReturn

from canon.expression.latex.pieces import Group, Operator, Piece, base_and_order, items_of, mark_of
from canon.expression.symbols.symbol import Coordinate, Rate
from canon.expression.text.syntax import Call, LanguageError, Name, Node, Number, Tuple

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["Derivatives", "are_differentials", "derivative", "differentials_behind"]


_MOST_RATES = 2
"""Most rates of a coordinate that are symbols: velocity and acceleration."""


@dataclass(frozen=True)
class Derivatives:
    """Reads the derivatives of one text.

    Parameters
    ----------
    text
        The whole LaTeX text, for errors.
    scope
        The declared names.
    """

    text: str
    scope: Scope

    def _refuse(self, column: int, reason: str, remedy: str) -> NoReturn:
        raise LanguageError(self.text, column, reason, remedy)

    def operator(self, above: Piece, below: Piece, column: int) -> Operator | None:
        r"""Return the derivative that a fraction begins like, None where the fraction is a quotient.

        Raises
        ------
        LanguageError
            Where it could be either, or the orders above and below differ.
        """
        found = _variables(below)
        if found is None:
            return None
        mark, variables = found
        first = items_of(above)[0]
        base, order = base_and_order(first)
        same = mark_of(base) == mark and order == sum(order for _, order in variables)
        if mark == "declared":
            if same:
                remedy = r"write \mathrm{d} for the derivative, or cancel d"
                self._refuse(column, "d is declared, so this is a derivative or a quotient", remedy)
            return None
        if not same:
            remedy = r"write \frac{\partial^2 V}{\partial x^2}"
            self._refuse(column, "this is neither a quotient nor a derivative", remedy)
        return Operator(mark == "d", variables, column)

    def along_the_motion(self, operator: Operator) -> Operator | None:
        r"""Return d/dt in place of ``\partial_t`` or ``\partial_t^2`` before a coordinate; None for other variables."""
        if any(name.text != self.scope.time.name for name, _ in operator.variables):
            return None
        order = sum(order for _, order in operator.variables)
        return Operator(total=True, variables=((operator.variables[0][0], order),), column=operator.column)

    def of(self, operator: Operator, operand: Node) -> Node:
        """Return the derivative of an operand.

        Raises
        ------
        LanguageError
            For the total derivative with respect to the time of anything but a coordinate or a function of the
            time alone, and for the derivative of a symbol.
        """
        time = self.scope.time.name
        of_time = operator.total and any(name.text == time for name, _ in operator.variables)
        if isinstance(operand, Name) and operand.text in self.scope.functions:
            names = self.scope.functions[operand.text]
            operand = Call(
                operand.text, tuple(Name(name, 0, operand.column) for name in names), operand.column
            )
        if isinstance(operand, Name):
            rate = self._is_rate(operator, operand)
            return self._rate(operator, operand, of_time=of_time or rate)
        arguments = self._arguments(operand)
        if of_time and not (
            len(arguments) == 1 and isinstance(arguments[0], Name) and arguments[0].text == time
        ):
            return self._along(operator, operand)
        if operator.total and len(arguments) > 1:
            self._refuse(operator.column, "the function has more than one argument", r"write \partial")
        return derivative(operand, operator.variables, operator.column)

    def _is_rate(self, operator: Operator, operand: Name) -> bool:
        r"""Tell whether ``\partial^2\theta/\partial t^2`` is meant for the acceleration: θ depends on t alone."""
        moves = isinstance(self.scope.symbol(operand.text), Coordinate)
        return moves and self.along_the_motion(operator) is not None

    def _arguments(self, operand: Node) -> tuple[Node, ...]:
        """Return the arguments of a declared function, none for any other operand."""
        declared = isinstance(operand, Call) and operand.function in self.scope.functions
        return operand.arguments if isinstance(operand, Call) and declared else ()

    def _along(self, operator: Operator, operand: Node) -> Node:
        """Return the derivative along the motion, as often as it is taken."""
        order = sum(order for _, order in operator.variables)
        if len(operator.variables) > 1 or order > _MOST_RATES:
            remedy = r"write it out with \dot x and \ddot x"
            self._refuse(operator.column, "this derivative along the motion is not read", remedy)
        for _ in range(order):
            operand = Call("d/dt", (operand,), operator.column)
        return operand

    def _rate(self, operator: Operator, operand: Name, *, of_time: bool) -> Name:
        r"""Return the θ̇ or θ̈ that ``\frac{d\theta}{dt}`` writes."""
        order = sum(order for _, order in operator.variables)
        base = operand.text.removesuffix("_dot")
        if base != operand.text and isinstance(self.scope.symbol(operand.text), Rate):
            operand, order = Name(base, 0, operand.column), order + 1
        rate = f"{operand.text}{('_dot', '_ddot')[order - 1]}" if 1 <= order <= _MOST_RATES else ""
        known = isinstance(self.scope.symbol(rate), Rate) or (rate in self.scope.names)
        if not (of_time and known and len(operator.variables) == 1):
            name = operand.text
            self._refuse(
                operand.column, f"{name} is a symbol of its own, not a function", "declare it in functions"
            )
        return Name(rate, 0, operator.column)


def derivative(operand: Node, variables: tuple[tuple[Name, int], ...], column: int) -> Node:
    """Return the derivative with respect to variables, each with its order."""
    orders = tuple(Tuple((name, Number(order, 1, name.column)), name.column) for name, order in variables)
    return Call("Derivative", (operand, *orders), column)


def differentials_behind(below: tuple[Piece, ...], order: int) -> int:
    r"""Return how many pieces behind the slash of ``\partial^2 W/\partial x\partial y`` are its differentials.

    Parameters
    ----------
    below
        What stands behind the slash.
    order
        The order above it, which tells where they end.
    """
    if _in_brackets(below[0])[0]:
        return 1
    mark = mark_of(below[0])
    if mark not in ("d", "partial") or len(below) == 1:
        return 0
    end = 2
    found = base_and_order(below[1])[1] or order
    while found < order and end + 1 < len(below) and mark_of(below[end]) == mark:
        found += base_and_order(below[end + 1])[1] or order
        end += 2
    return end


def are_differentials(items: tuple[Piece, ...]) -> bool:
    r"""Whether pieces are marks and what they stand before, ``\partial x\partial y``."""
    return not len(items) % 2 and all(mark_of(item) in ("d", "partial") for item in items[::2])


def _in_brackets(piece: Piece) -> tuple[tuple[Piece, ...], int]:
    r"""Return the differentials of ``(\partial x\partial y)`` or ``(\partial x)^2``, and the exponent."""
    base, order = base_and_order(piece)
    items = items_of(base.inner) if isinstance(base, Group) and base.printed else ()
    return (items, order) if items and are_differentials(items) and order else ((), 1)


def _variables(below: Piece) -> tuple[str, tuple[tuple[Name, int], ...]] | None:
    r"""Return the mark and the variables of ``\partial x^2\partial y``, None for any other denominator."""
    items, times = items_of(below), 1
    if len(items) == 1:
        items, times = _in_brackets(items[0])
    marks = {mark_of(item) for item in items[::2]}
    mark = marks.pop() if items else None
    if len(items) % 2 or marks or mark is None:
        return None
    variables: list[tuple[Name, int]] = []
    for item in items[1::2]:
        base, order = base_and_order(item)
        if not isinstance(base, Name) or order is None:
            return None
        variables.append((base, order * times))
    return mark, tuple(variables)
