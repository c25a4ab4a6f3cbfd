r"""Meaning of LaTeX factors side by side: products, applied functions, derivatives.

The conventions are those of :mod:`canon.expression.latex.grammar`. Each piece is turned into a node once, so the work
stays linear in the text.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise, takewhile
from typing import TYPE_CHECKING, NoReturn, cast

from canon.cached_property import cached_property
from canon.expression.latex.argument_end import ArgumentEnd, bare_argument
from canon.expression.latex.derivatives import Derivatives, derivative, differentials_behind
from canon.expression.latex.names import Applied, Function, Mark
from canon.expression.latex.pieces import (
    FactorRun,
    Group,
    Head,
    LatexFraction,
    Operator,
    Piece,
    Powered,
    base_and_order,
    is_function,
    is_in_degrees,
    is_minus_one,
    items_of,
    mark_of,
    raised,
    unbraced,
)
from canon.expression.latex.printed_forms import refuse_open_e
from canon.expression.latex.quotient import shown
from canon.expression.latex.understood_time import has_rate_or_is_momentum, without_time
from canon.expression.text.differentials import PRIMED
from canon.expression.text.open_readings import DECLARED_E, looks_like_eulers, prime_in_doubt
from canon.expression.text.syntax import Call, LanguageError, Name, Node, Number, Power, Product, Tuple

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["Meaning"]

_INVERSE = {"sin": "asin", "cos": "acos", "tan": "atan", "cot": "acot", "sinh": "asinh", "cosh": "acosh",
            "tanh": "atanh"}  # fmt: skip
_MAX_CHAIN = 4
r"""Most functions in a row without brackets, ``\ln\sin x``."""
_MOST_DERIVATIVES = 8
"""Most derivatives in front of what they are taken of."""


@dataclass(frozen=True)
class Meaning:
    """Gives pieces their meaning.

    Parameters
    ----------
    text
        The whole LaTeX text, for errors.
    scope
        The declared names.
    spaced
        Columns that a visible space stands before.
    """

    text: str
    scope: Scope
    spaced: frozenset[int]

    @cached_property
    def ends(self) -> ArgumentEnd:
        """What knows where arguments end."""
        return ArgumentEnd(self.scope, self.spaced)

    @cached_property
    def derivatives(self) -> Derivatives:
        """What reads the derivatives of this text."""
        return Derivatives(self.text, self.scope)

    def refuse(self, column: int, reason: str, remedy: str = "") -> NoReturn:
        """Raise the error of this text."""
        raise LanguageError(self.text, column, reason, remedy)

    def node(self, piece: Piece) -> Node:
        """Return the syntax tree of a piece."""
        match piece:
            case Group():
                return self.node(piece.inner)
            case Powered():
                return self._power(piece)
            case FactorRun():
                factors = self.factors(piece.items)
                if len(factors) == 1:
                    return factors[0]
                return Product(tuple((False, factor) for factor in factors), piece.column)
            case LatexFraction():
                return piece.node
            case Head() | Operator() | Mark():
                return self.factors((piece,))[0]
            case _:
                return piece

    def _power(self, piece: Powered) -> Node:
        if isinstance(piece.base, Mark):
            if piece.base.text != "e":
                self._stray(piece.base)
            if isinstance(piece.exponent, Number):
                refuse_open_e(self.text, piece.base.column)
            return Call("exp", (piece.exponent,), piece.column)
        base = self.node(piece.base)
        if looks_like_eulers(base, piece.exponent, self.scope):
            self.refuse(piece.column, *DECLARED_E)
        return Power(base, piece.exponent, piece.column)

    def factors(self, items: tuple[Piece, ...]) -> list[Node]:
        """Return the factors of pieces side by side."""
        items = without_time(items, self.scope)
        for left, right in pairwise(items):
            self._neighbours(left, right)
        found: list[Node] = []
        at = 0
        while at < len(items):
            item = items[at]
            match item:
                case Head(function=Function() as function):
                    node, at = self._application(items, at, item, function)
                case Head(function=Applied() as function):
                    node, at = self._declared(items, at, item, function)
                case Operator():
                    node, at = self._operators(items, at)
                case Mark():
                    node, at = self._marked(items, at, item)
                case _:
                    node, at = self.node(item), at + 1
            found.append(node)
        return found

    def _neighbours(self, left: Piece, right: Piece) -> None:
        """Refuse two factors that side by side look like something else."""
        column = right.column
        hidden = isinstance(left, Group) and not left.printed
        left, right = unbraced(left), unbraced(right)
        first = unbraced(right.base) if isinstance(right, Powered) else right
        if isinstance(first, Number) and (hidden or isinstance(left, Name | Number)):
            self.refuse(column, "a number after a factor", r"write x_2, x^2, 2x or \cdot, whichever is meant")
        if isinstance(left, Number) and isinstance(first, LatexFraction) and first.numbers:
            self.refuse(
                column, "a number before a fraction of numbers: a product or a mixed number?", r"put \cdot"
            )
        left = unbraced(left.base) if isinstance(left, Powered) else left  # x^2(a) asks as x(a) does
        inner = first.inner if isinstance(left, Name) and isinstance(first, Group) else None
        rate = isinstance(inner, Name) and inner.text.endswith("dot") and self.text[inner.column - 1] == "\\"
        if isinstance(left, Name) and isinstance(inner, Tuple | Number | Name) and not rate:
            if isinstance(inner, Name) and inner.text == self.scope.time.name:
                reason = f"{left.text} is a symbol here, its dependence on the time is understood"
                self.refuse(column, reason, "leave the argument out")
            reason = f"{left.text} is a declared symbol and can't be applied to anything"
            self.refuse(column, reason, "leave the brackets out for a product, or declare it in functions")
        begun = self.text[: column - 1].rstrip().endswith((r"\left", ")"))  # in a print, or behind (t)
        if (
            isinstance(left, Name)
            and isinstance(first, Group)
            and not begun
            and self.ends.is_another_time(left, first)
        ):
            reason = f"is {left.text} taken at another time here, or multiplied by this?"
            self.refuse(column, reason, r"put \cdot for a product; what moves is taken at the time t alone")

    def raised(self, base: Piece, exponent: Node) -> Powered:
        """Return a factor with its exponent, where print shows what is raised."""
        hidden = (
            isinstance(base, Group) and not base.printed and not isinstance(unbraced(base), Name | Number)
        )
        if hidden or isinstance(base, LatexFraction):
            self.refuse(
                base.column, "print does not show what is raised here", r"write \left( \right) around it"
            )
        return Powered(base, exponent, base.column)

    def _application(
        self, items: tuple[Piece, ...], at: int, head: Head, function: Function, chain: int = 1
    ) -> tuple[Node, int]:
        """Return a built-in function with its argument, and where that ends."""
        following = items[at + 1] if at + 1 < len(items) else None
        after: Node | None = None
        if following is None:
            self.refuse(head.column, f"{function.name} needs its argument")
        if isinstance(following, Group):
            argument, end = self.node(following), at + 2
        elif isinstance(following, Powered) and isinstance(following.base, Group):
            if not following.base.printed:
                self._ambiguous_power(following, function)
            argument, after, end = self.node(following.base), following.exponent, at + 2
        elif isinstance(following, Head) and isinstance(following.function, Function):
            if chain >= _MAX_CHAIN:
                self.refuse(
                    following.column, f"more than {_MAX_CHAIN} functions without brackets", "write brackets"
                )
            argument, end = self._application(items, at + 1, following, following.function, chain + 1)
        else:
            argument, end = self._bare(items, at, function)
        return self._called(head, function, argument, after), end

    def _bare(self, items: tuple[Piece, ...], at: int, function: Function) -> tuple[Node, int]:
        """Return the argument that a function without brackets takes, and where it ends."""
        end = at + 1
        taken: list[Node] = []
        numeric = True
        while end < len(items) and not is_function(items[end]) and not isinstance(items[end], Operator):
            if not numeric and self.ends.lies_before(taken, items[end]):
                break
            if not numeric and not self.ends.goes_on(taken, items[end]):
                self._open(items[end], taken, function)
            if taken and is_in_degrees(items[end - 1]):
                self._open(items[end], taken, function)
            node, end = self._of_argument(items, end)
            taken.append(node)
            numeric = numeric and self.ends.is_numeric(node)
        if not taken:
            self.refuse(items[at].column, f"{function.name} needs its argument")
        last = items[end - 1]
        if isinstance(last, Powered) and not isinstance(last.base, Number | Mark):
            self._ambiguous_power(last, function)
        if numeric and end < len(items) and not is_in_degrees(items[end - 1]):
            told = f"does this still belong to the argument of {function.name}?"
            self.refuse(items[end].column, told, "write brackets")
        whole = Product(tuple((False, node) for node in taken), taken[0].column)
        return (whole if taken[1:] else taken[0]), end

    def _of_argument(self, items: tuple[Piece, ...], at: int) -> tuple[Node, int]:
        """Return one factor of an argument without brackets, and where it ends."""
        item = items[at]
        if isinstance(item, Head) and isinstance(item.function, Applied):
            return self._declared(items, at, item, item.function)
        if isinstance(item, Mark):
            return self._marked(items, at, item)
        return self.node(item), at + 1

    def _open(self, item: Piece, taken: list[Node], function: Function) -> NoReturn:
        """Refuse a factor that may or may not belong to an argument, with both readings."""
        name, argument = function.name, shown(taken)
        factor = unbraced(item.base if isinstance(item, Powered) else item)
        symbol = shown([factor]) if isinstance(factor, Name) else "(…)"
        outside, inside = f"{name}({argument}) {symbol}", f"{name}({argument} {symbol})"
        self.refuse(
            item.column,
            f"does this factor still belong to the argument of {name}? {outside} or {inside}",
            f"write \\{outside} or \\{inside}, whichever is meant",
        )

    def _ambiguous_power(self, piece: Powered, function: Function) -> NoReturn:
        name = function.name
        self.refuse(
            piece.column, f"is {name} squared, or its argument?", f"write \\{name}^2(x) or \\{name}(x^2)"
        )

    def leaves_open(self, items: tuple[Piece, ...]) -> bool:
        r"""Whether what follows ``\cdot`` could belong to the argument that ends here, as in ``\cos\omega\cdot t``."""
        if items and is_in_degrees(items[-1]):
            return False
        derived = len(items) > 1 and isinstance(items[-2], Operator) and isinstance(items[-1], Name)
        if derived or self.ends_with_derivative_of_fraction(items):
            return True
        argument = [
            self.node(item) for item in bare_argument(items) if not isinstance(item, Mark | Head | Operator)
        ]
        return bool(argument) and not (
            any(map(self.ends.moves, argument)) or self.ends.is_angle(argument[-1])
        )

    def ends_with_derivative_of_fraction(self, items: tuple[Piece, ...]) -> bool:
        """Whether pieces end with an operator such as d/dt and a fraction, which what follows may belong to."""
        return len(items) > 1 and _is_fraction(items[-1]) and isinstance(items[-2], Operator)

    def _called(self, head: Head, function: Function, argument: Node, after: Node | None) -> Node:
        r"""Return a built-in function of its argument, raised as ``\sin^2`` or after the brackets."""
        name, column = function.name, head.column
        arguments = argument.items if isinstance(argument, Tuple) else (argument,)
        if head.base is not None:
            if name == "log":
                arguments = (*arguments, head.base)
            elif name == "atan" and isinstance(head.base, Number) and head.base.numerator == 2:
                name = "atan2"
            else:
                self.refuse(head.column, f"{name} takes no subscript")
        exponent = head.exponent
        inverse = is_minus_one(exponent)
        if exponent is not None and after is not None and not inverse:
            self.refuse(after.column, f"two exponents of {name}", "write one")
        if inverse and name not in _INVERSE:
            self.refuse(
                column,
                f"the inverse of {name}, or its reciprocal?",
                f"write the inverse out, or \\frac{{1}}{{{name}}}",
            )
        if inverse:
            return raised(Call(_INVERSE[name], arguments, column), after)
        return raised(Call(name, arguments, column), exponent or after)

    def _declared(self, items: tuple[Piece, ...], at: int, head: Head, function: Applied) -> tuple[Node, int]:
        """Return a declared function with its arguments, and where they end."""
        if head.base is not None or is_minus_one(head.exponent):
            self.refuse(
                head.column, f"{function.name} takes no subscript and no inverse", f"write {function.name}(…)"
            )
        following = items[at + 1] if at + 1 < len(items) else None
        group = following.base if isinstance(following, Powered) else following
        if not (isinstance(group, Group) and group.printed):
            if not function.order:
                return raised(Name(function.name, 0, head.column), head.exponent), at + 1
            names = self.scope.functions[function.name]
            if (doubt := prime_in_doubt(function.name, self.scope)) and not function.dotted:
                self.refuse(function.column, doubt, rf"write \frac{{d{function.name}}}{{d{names[0]}}}")
            places = tuple(Name(name, 0, head.column) for name in names)
            return raised(self._rate(function, places), head.exponent), at + 1
        inner = self.node(group)
        arguments = inner.items if isinstance(inner, Tuple) else (inner,)
        after = following.exponent if isinstance(following, Powered) else None
        if head.exponent is not None and after is not None:
            self.refuse(after.column, f"two exponents of {function.name}", "write one")
        return raised(self._rate(function, arguments), head.exponent or after), at + 2

    def _rate(self, function: Applied, arguments: tuple[Node, ...]) -> Node:
        r"""Return f(x), its derivative ``f'(x)``, or ``\dot f`` of a function of the time."""
        column = function.column
        call = Call(function.name, arguments, column)
        if not function.order:
            return call
        variable = arguments[0]
        if len(arguments) == 1 and not isinstance(variable, Name) and not function.dotted:
            return Call(PRIMED, (call, Number(function.order, 1, column)), column)
        if len(arguments) > 1 or not isinstance(variable, Name):
            self.refuse(
                column,
                f"the derivative of {function.name} with respect to what?",
                rf"write \frac{{\partial {function.name}}}{{\partial x}}",
            )
        if function.dotted and variable.text != self.scope.time.name:
            self.refuse(
                column,
                f"{function.name} is not a function of the time alone",
                f"write {function.name}'(x)\\dot x",
            )
        return derivative(call, ((variable, function.order),), column)

    def _operators(self, items: tuple[Piece, ...], at: int) -> tuple[Node, int]:
        r"""Return the derivative of what follows one operator or several, ``\partial_x\partial_y W``."""
        waiting = [*takewhile(lambda item: isinstance(item, Operator), items[at:])]
        *outer, innermost = cast("list[Operator]", waiting)
        if len(outer) >= _MOST_DERIVATIVES:
            self.refuse(innermost.column, "a derivative of more than the 8th order")
        node, end = self._operated(items, at + len(outer), innermost)
        for operator in reversed(outer):
            node = self.derivatives.of(operator, node)
        return node, end

    def _operated(self, items: tuple[Piece, ...], at: int, operator: Operator) -> tuple[Node, int]:
        """Return the derivative of what follows an operator such as d/dx."""
        following = items[at + 1] if at + 1 < len(items) else None
        if (
            isinstance(following, Head)
            and isinstance(following.function, Applied)
            and following.exponent is None
        ):
            operand, end = self._declared(items, at + 1, following, following.function)
            if end == len(items) and not isinstance(operand, Power):
                return self.derivatives.of(operator, operand), end
        if isinstance(following, Group):
            return self.derivatives.of(operator, self.node(following)), at + 2
        if at + 2 == len(items) and following and _is_fraction(following):
            return self.derivatives.of(operator, self.node(following)), at + 2
        name = following and unbraced(following)
        along = operator if operator.total else self.derivatives.along_the_motion(operator)
        whole = at + 2 == len(items)  # what d/dt r θ' reaches is not said
        if isinstance(name, Name) and along and whole and has_rate_or_is_momentum(name, self.scope):
            return self.derivatives.of(along, name), at + 2
        if isinstance(following, Head) and isinstance(following.function, Function):
            operand, end = self._application(items, at + 1, following, following.function)
            if end == len(items):
                return self.derivatives.of(operator, operand), end
        return self.refuse(
            operator.column,
            "the derivative of what?",
            r"write \frac{\partial V}{\partial x}, or what it acts on in brackets",
        )

    def _marked(self, items: tuple[Piece, ...], at: int, mark: Mark) -> tuple[Node, int]:
        """Return what a letter alone means, Euler's number or with what follows a differential, and where it ends."""
        if mark.text == "e":
            refuse_open_e(self.text, mark.column)
            return Call("exp", (Number(1, 1, mark.column),), mark.column), at + 1
        return self._varied(items, at, mark), at + 2

    def _varied(self, items: tuple[Piece, ...], at: int, mark: Mark) -> Node:
        r"""Return the declared ``d_x`` or ``delta_x`` that ``dx`` or ``\delta x`` writes."""
        following = items[at + 1] if at + 1 < len(items) else None
        if isinstance(following, Name) and mark.text in ("d", "delta"):
            name = f"{mark.text}_{following.text}"
            if self.scope.symbol(name) is not None:
                return Name(name, 0, mark.column)
        return self._stray(mark)

    def spelled_with_slash(
        self, above: tuple[Piece, ...], below: tuple[Piece, ...]
    ) -> tuple[int, Piece, int] | None:
        r"""Return the derivative of ``m\,d\theta/dt``, None where a slash divides.

        Parameters
        ----------
        above, below
            What stands before and behind the slash.

        Returns
        -------
        tuple
            Where it begins before the slash, what it is, and where it ends behind the slash.
        """
        for start, item in enumerate(above):
            base, order = base_and_order(item)
            if mark_of(base) in ("d", "partial") and (end := differentials_behind(below, order or 1)):
                spelled, over = FactorRun(above[start:], item.column), FactorRun(below[:end], below[0].column)
                return start, self.fraction(spelled, over, item.column), end
        return None

    def _stray(self, mark: Mark) -> NoReturn:
        if mark.text == "partial":
            self.refuse(
                mark.column, "a partial derivative is not complete", r"write \frac{\partial V}{\partial x}"
            )
        shown = {"d": "d", "delta": r"\delta"}[mark.text]
        self.refuse(mark.column, f"{shown} is not declared", "a derivative is written \\frac{dV}{dx}")

    def fraction(self, above: Piece, below: Piece, column: int) -> Piece:
        """Return a quotient, or the derivative that it spells."""
        operator = self.derivatives.operator(above, below, column)
        if operator is not None:
            operand = items_of(above)[1:]
            if not operand:
                return operator
            return self.derivatives.of(operator, self.node(FactorRun(operand, operand[0].column)))
        numerator, denominator = self.node(above), self.node(below)
        numbers = isinstance(numerator, Number) and isinstance(denominator, Number)
        return LatexFraction(Product(((False, numerator), (True, denominator)), column), numbers, column)


def _is_fraction(piece: Piece) -> bool:
    r"""Whether a piece is a fraction, a quotient or a derivative, ``\frac{\partial L}{\partial\dot\theta}``."""
    return isinstance(piece, LatexFraction) or (isinstance(piece, Call) and piece.function == "Derivative")
