"""Meaning of a syntax tree: SymPy expressions, with every costly evaluation bounded before SymPy is asked.

What SymPy would evaluate at ruinous cost (``9**9**9``) is refused before it is built.
"""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING, NoReturn

import sympy as sp
from sympy import Expr, Rational, Symbol

from canon.expression.conditions import alternatives, related
from canon.expression.ranges.over_ranges import over_ranges
from canon.expression.ranges.range_of_call import INTEGRAL, PRODUCT, SUM, bound_names
from canon.expression.symbols.magnitude import MOST_DIGITS, digits
from canon.expression.symbols.symbol import Coordinate, Momentum, Rate, time_derivative, velocity
from canon.expression.text import syntax
from canon.expression.text.differentials import PARTIAL, PRIMED, TOTAL, names_outside_functions
from canon.expression.text.syntax import LanguageError
from canon.expression.text.vocabulary import CONSTANTS, FUNCTIONS, MAX_CHOICES

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy.logic.boolalg import Boolean

    from canon.expression.text.scope import Scope

__all__ = ["Builder"]

MAX_EXPONENT = 1_000
MAX_BITS = 14_000
"""Longest number that is built: Python writes integers of up to 4300 digits."""


class Builder:
    """Gives a syntax tree its meaning; every costly evaluation is bounded before SymPy is asked."""

    def __init__(self, text: str, scope: Scope) -> None:
        self.text = text
        self.scope = scope

    def refuse(self, node: syntax.Node, reason: str, remedy: str = "") -> NoReturn:
        """Raise the error of this text at a node."""
        raise LanguageError(self.text, node.column, reason, remedy)

    def whole(self, node: syntax.Node) -> Expr:
        """Return the expression of a whole text; all names in it that mean nothing are told at once."""
        self.refuse_function_alone(node)
        try:
            return self.expression(node)
        except LanguageError as fault:
            others = [*self._strange_names(node)]
            raise LanguageError.together([fault, *others]) if others else fault from None

    def refuse_function_alone(self, node: syntax.Node) -> None:
        """Refuse V alone, which is a name, as of a left side; beside others it is the value V(x)."""
        if isinstance(node, syntax.Name) and node.text in self.scope.functions:
            arguments = ", ".join(self.scope.functions[node.text])
            self.refuse(node, f"{node.text} is a function", f"write {node.text}({arguments})")

    def _strange_names(self, node: syntax.Node) -> Iterator[LanguageError]:
        bound = bound_names(node)
        for part in syntax.parts(node):
            called = isinstance(part, syntax.Call)
            name = part.function if called else part.text if isinstance(part, syntax.Name) else ""
            known = name in (*self.scope.functions, *FUNCTIONS, *_OWN, "") or self.scope.declares(name)
            if (
                not known
                and (called or name not in (*CONSTANTS, "i"))
                and name.rpartition("_")[2] not in bound
            ):
                what = "is not a function of the language" if called else "is not declared"
                yield LanguageError(
                    self.text, part.column, f"{name} {what}", self.scope.near(name, "(" * called)
                )

    def expression(self, node: syntax.Node) -> Expr:
        """Return the expression of a tree, refusing what SymPy can't build or what is undefined everywhere."""
        try:
            return self.finite(node, self.built(node))
        except LanguageError:
            raise
        except (TypeError, ValueError, NotImplementedError) as error:  # SymPy's own refusals
            self.refuse(node, f"this can't be built: {_first_sentence(error)}")

    def built(self, node: syntax.Node) -> Expr:
        """Return what SymPy makes of a tree."""
        match node:
            case syntax.Number(numerator, denominator):
                return Rational(numerator, denominator)
            case syntax.Name():
                return self.name(node)
            case syntax.Call():
                return self.call(node)
            case syntax.Negative(operand):
                return -self.expression(operand)
            case syntax.Sum(terms):
                built = ((minus, self.expression(term)) for minus, term in terms)
                return sp.Add(*(-term if minus else term for minus, term in built))
            case syntax.Product(factors):
                return self.product(factors)
            case syntax.Power(base, exponent):
                return self.power(node, self.expression(base), self.expression(exponent))
            case syntax.Tuple():
                return self.refuse(node, "a pair (…, …) belongs inside Piecewise or Derivative only")
            case _:
                return self.refuse(node, "a comparison where an expression should be")

    def finite(self, node: syntax.Node, value: Expr) -> Expr:
        """Return a value that is finite and of a length that can be meant."""
        if isinstance(value, Rational) and _bits(value) > MAX_BITS:
            self.refuse(node, "a number too long to be meant")
        if value.args and not value.free_symbols and digits(value) > MOST_DIGITS:
            self.refuse(node, f"a number of more than {MOST_DIGITS:,.0f} digits before or behind the point")
        if value is sp.nan or value.has(sp.zoo, sp.oo, sp.S.NegativeInfinity, sp.nan):
            self.refuse(node, "this is infinite or undefined everywhere")
        return value

    def name(self, node: syntax.Name) -> Expr:
        """Return the symbol or constant that a name means."""
        name = node.text + ("", "_dot", "_ddot")[min(node.primes, 2)]
        symbol = self.scope.symbol(name)
        if symbol is not None and node.primes < 3:
            return self.value(node, name, symbol)
        if node.primes and isinstance(self.scope.symbol(node.text), Momentum):
            self.refuse(
                node,
                f"{node.text}' is the rate of a momentum, for which there is no symbol",
                "write what it is equal to on the motion",
            )
        if node.primes:
            self.refuse(
                node,
                f"{node.text}{min(node.primes, 4) * chr(39)} is not a rate of a declared coordinate",
                "one or two primes after a coordinate; for a function write Derivative(f(t), t)",
            )
        if node.text in self.scope.functions:
            return self.call(self.at_its_variables(node))
        if node.text in CONSTANTS:
            return CONSTANTS[node.text]
        if node.text == "i" and not self.scope.declares("I"):
            return sp.I
        if node.text in FUNCTIONS:
            self.refuse(node, f"{node.text} needs its argument in parentheses")
        return self.refuse(node, f"{node.text} is not declared", self.scope.near(node.text))

    def at_its_variables(self, node: syntax.Name) -> syntax.Call:
        """Return V(x) for the name V of a declared function."""
        variables = (syntax.Name(name, 0, node.column) for name in self.scope.functions[node.text])
        return syntax.Call(node.text, tuple(variables), node.column)

    def value(self, node: syntax.Node, name: str, symbol: Symbol) -> Expr:
        """Return a symbol, or what its name abbreviates."""
        value = self.scope.values.get(name, symbol)
        if value is None:
            self.refuse(node, f"{name} has no meaning here", "write out what it stands for")
        return value

    def call(self, node: syntax.Call) -> Expr:
        """Return the value of a function."""
        name = node.function
        if name in self.scope.functions:
            return self.declared(node)
        if (symbol := self.scope.symbol(name)) is not None:
            if node.arguments == (
                syntax.Name(self.scope.time.name, 0, _column(node.arguments)),
            ) and self.scope.takes_time(name):
                return self.value(node, name, symbol)
            self.refuse(
                node, f"{name} is a declared symbol and can't be applied to anything", "write * for a product"
            )
        if name in ("Derivative", "diff", "D"):
            return self.derivative(node)
        if name == TOTAL:
            return self.rate(node, self.expression(node.arguments[0]))
        if name in (PARTIAL, "d/dx"):
            return self.partial(node)
        if name == PRIMED:
            return self.primed(node)
        if name == "Piecewise":
            return self.piecewise(node)
        if name in (INTEGRAL, SUM, PRODUCT):
            return over_ranges(self, node)
        if name not in FUNCTIONS:
            self.refuse(node, f"{name} is not a function of the language", self.scope.near(name, "("))
        return self.of_vocabulary(node)

    def of_vocabulary(self, node: syntax.Call) -> Expr:
        """Return the value of a function that every scope has."""
        name = node.function
        function, least, most = FUNCTIONS[name]
        if not least <= len(node.arguments) <= most:
            wanted = str(least) if least == most else f"{least} to {most}"
            self.refuse(node, f"{name} takes {wanted} argument(s), not {len(node.arguments)}")
        arguments = [self.expression(argument) for argument in node.arguments]
        if name == "exp":
            self.exponential(node, arguments[0])
        if function in (sp.Max, sp.Min):
            for argument, value in zip(node.arguments, arguments, strict=True):
                if value.is_extended_real is False:
                    self.refuse(argument, f"{name} compares real numbers, and this is not one")
        return function(*arguments)

    def declared(self, node: syntax.Call) -> Expr:
        """Return the value of a declared function."""
        wanted = self.scope.functions[node.function]
        if len(node.arguments) != len(wanted):
            self.refuse(
                node, f"{node.function} is declared with {len(wanted)} argument(s): {', '.join(wanted)}"
            )
        sign = self.scope.signs.get(node.function) or {"real": True}
        return sp.Function(node.function, **sign)(*(self.expression(argument) for argument in node.arguments))

    def derivative(self, node: syntax.Call) -> Expr:
        """Return the derivative that ``Derivative`` or ``diff`` spells."""
        if len(node.arguments) < 2:
            self.refuse(
                node, "Derivative takes an expression and at least one variable", "write Derivative(f(t), t)"
            )
        value = self.expression(node.arguments[0])
        orders = list(self.orders(node.arguments[1:]))
        if sum(order for _, order in orders) > 8:
            self.refuse(node, "a derivative of more than the 8th order")
        if all(variable == self.scope.time for variable, _ in orders) and self._along(node, value):
            return reduce(lambda f, _: self.rate(node, f), range(sum(order for _, order in orders)), value)
        for variable, _ in orders:
            self.ask_what_depends(node, node.arguments[0], value, variable)
        return reduce(lambda f, order: f.diff(*order), orders, value)

    def ask_what_depends(
        self, node: syntax.Call, operand: syntax.Node, value: Expr, variable: Symbol
    ) -> None:
        """Refuse derivatives that would be 0 only because it is not written how their operand depends on the variable.

        ∂E/∂J is a frequency, and ∂w(τ)/∂t is ε w′, though neither J nor t stands in what is differentiated.
        """
        held = {str(symbol) for symbol in value.free_symbols} - {variable.name}
        hidden = sorted(held & self.scope.dependent)
        name = operand.text if isinstance(operand, syntax.Name) else ""
        bare = (
            name
            and isinstance(value, Symbol)
            and not self.scope.independent
            and name not in self.scope.values
        )
        by_hidden = variable.name in self.scope.dependent and variable not in value.free_symbols and held
        if value != variable and (hidden or by_hidden or bare):
            self.ask_about(node, ", ".join(hidden) or name or str(value), variable)

    def ask_about(self, node: syntax.Node, what: str, variable: Symbol) -> NoReturn:
        """Refuse a derivative of what may depend on the variable in a way that is not written."""
        reason = f"does {what} depend on {variable} here, or is it held fixed?"
        self.refuse(node, reason, "write the derivative out")

    def _along(self, node: syntax.Call, value: Expr) -> bool:
        """Tell whether a derivative with respect to the time is one along the motion, as that of ``theta(t)``."""
        inside = node.arguments[0]
        if isinstance(value, Coordinate | Rate):
            return True
        if any(
            isinstance(part, syntax.Call) and self.scope.symbol(part.function) is not None
            for part in syntax.parts(inside)
        ):
            return True
        bare = names_outside_functions(inside, self.scope)
        moving = sorted(
            {name.text for name in bare if self.scope.moves(name.text) and name.text != self.scope.time.name}
        )
        if moving:
            shown = ", ".join(moving)
            self.refuse(node, f"with {shown} held fixed, or along the motion?", "write ∂/∂t( ) or d/dt( )")
        return False

    def rate(self, node: syntax.Node, f: Expr) -> Expr:
        """Return df/dt along the motion."""
        q = [symbol for symbol in self.scope.names.values() if isinstance(symbol, Coordinate)]
        known = {*q, *(velocity(x) for x in q), self.scope.time}
        for symbol in sorted(f.free_symbols - known, key=str):
            if isinstance(symbol, Momentum | Rate) or self.scope.moves(str(symbol)):
                self.refuse(
                    node, f"the rate of {symbol} is no symbol of this question", "write the derivative out"
                )
            if str(symbol) in self.scope.dependent:
                self.ask_about(node, str(symbol), self.scope.time)
        return time_derivative(f, q, self.scope.time)

    def partial(self, node: syntax.Call) -> Expr:
        """Return a partial derivative, all other declared symbols held fixed."""
        operand, *rest = node.arguments
        variables, orders = rest[: len(rest) // 2], rest[len(rest) // 2 :]
        if isinstance(operand, syntax.Name) and operand.text in self.scope.functions:
            operand = self.at_its_variables(operand)
        if node.function == "d/dx" and not (
            isinstance(operand, syntax.Call)
            and operand.function in self.scope.functions
            and len(operand.arguments) == 1
        ):
            self.refuse(
                node, "a total or a partial derivative?", "write ∂/∂x( ), or d/dt( ) along the motion"
            )
        value = self.expression(operand)
        for variable, order in zip(variables, orders, strict=True):
            symbol = self.expression(variable)
            if not isinstance(symbol, Symbol) or not isinstance(order, syntax.Number):
                self.refuse(node, "a derivative is taken with respect to a declared symbol")
            self.ask_what_depends(node, operand, value, symbol)
            value = value.diff(symbol, order.numerator)
        return value

    def primed(self, node: syntax.Call) -> Expr:
        """Return the derivative of a function of one variable at a place, ``V'(r - a)``."""
        value, order = node.arguments
        f, variable = self.expression(value), sp.Dummy("xi_1", real=True)
        if not (len(f.args) == 1 and isinstance(order, syntax.Number) and order.numerator <= 8):
            self.refuse(
                node, "this is no derivative of a function of one variable", "write Derivative(V(x), x)"
            )
        slope = f.func(variable).diff(variable, order.numerator)
        return sp.Subs(slope, variable, f.args[0])

    def orders(self, nodes: Sequence[syntax.Node]) -> Iterator[tuple[Symbol, int]]:
        """Yield variables with their orders: ``t, t``, ``(t, 2)`` or Maxima's ``t, 2``."""
        for node, after in zip(nodes, (*nodes[1:], None), strict=True):
            if isinstance(node, syntax.Number) and node is not nodes[0]:
                continue
            if isinstance(after, syntax.Number) and isinstance(node, syntax.Name):
                node = syntax.Tuple((node, after), node.column)
            yield self.order(node)

    def order(self, node: syntax.Node) -> tuple[Symbol, int]:
        """Return a variable and the order of the derivative with respect to it."""
        variable, order = node, 1
        if isinstance(node, syntax.Tuple):
            if len(node.items) != 2 or not isinstance(node.items[1], syntax.Number):
                self.refuse(node, "this should be (variable, order)", "write (t, 2)")
            variable = node.items[0]
            number = node.items[1]
            order = number.numerator
            if number.denominator != 1 or not 1 <= order <= 8:
                self.refuse(number, "the order of a derivative is a whole number from 1 to 8")
        symbol = self.expression(variable)
        if not isinstance(symbol, Symbol):
            self.refuse(node, "a derivative is taken with respect to a declared symbol")
        return symbol, order

    def piecewise(self, node: syntax.Call) -> Expr:
        """Return a function defined piece by piece."""
        if not 1 <= len(node.arguments) <= MAX_CHOICES:
            self.refuse(node, f"Piecewise takes 1 to {MAX_CHOICES} pieces")
        pieces: list[tuple[Expr, Boolean]] = []
        for piece in node.arguments:
            if not isinstance(piece, syntax.Tuple) or len(piece.items) != 2:
                self.refuse(
                    piece, "a piece is (expression, condition)", "write Piecewise((x, x > 0), (0, True))"
                )
            value = self.expression(piece.items[0])
            ways = alternatives(self.text, piece.items[1], self.scope)
            pieces += [(value, self.condition(way)) for way in ways]
        return self.joined(pieces)

    def joined(self, pieces: Sequence[tuple[Expr, Boolean]]) -> Expr:
        """Return pieces as one function."""
        return sp.Piecewise(*pieces)

    def condition(self, node: syntax.Node) -> Boolean:
        """Return the condition of a tree: a chain of comparisons, ``Ne(a, b)``, ``Eq(a, b)``, or True."""
        match node:
            case syntax.Name(text="True"):
                return sp.true
            case syntax.Call(function="Ne", arguments=(left, right)) if "Ne" not in self.scope.functions:
                return self.condition(syntax.Comparison((left, right), ("!=",), node.column))
            case syntax.Call(function="Eq", arguments=(left, right)) if "Eq" not in self.scope.functions:
                return self.condition(syntax.Comparison((left, right), ("==",), node.column))
            case syntax.Call(function="And", arguments=parts) if "And" not in self.scope.functions:
                return sp.And(*(self.condition(part) for part in parts))
            case syntax.Comparison(operands, relations):
                if "=" in relations:
                    self.refuse(
                        node, "an equation where a condition should be", "write < <= > >= or Ne(a, b)"
                    )
                sides = [self.expression(side) for side in operands]
                pairs = zip(sides, relations, sides[1:], strict=False)
                try:
                    chain = (related(left, relation, right) for left, relation, right in pairs)
                    return sp.And(*chain)
                except TypeError:
                    self.refuse(node, "imaginary numbers can't be compared")
                except (ValueError, NotImplementedError) as error:
                    self.refuse(node, f"this can't be compared: {_first_sentence(error)}")
            case _:
                pass
        return self.refuse(node, "a condition is missing", "write < <= > >= or Ne(a, b)")

    def product(self, factors: tuple[tuple[bool, syntax.Node], ...]) -> Expr:
        """Return a product whose numbers stay short."""
        built: list[Expr] = []
        bits = 0
        for divides, node in factors:
            factor = self.expression(node)
            if divides and factor is sp.S.Zero:
                self.refuse(node, "division by zero")
            bits += _bits(factor)
            if bits > MAX_BITS:
                self.refuse(node, "the product is a number too long to be meant")
            built.append(1 / factor if divides else factor)
        return sp.Mul(*built)

    def power(self, node: syntax.Power, base: Expr, exponent: Expr) -> Expr:
        """Return a power whose numbers stay short."""
        coefficient = abs(exponent.as_coeff_Mul()[0])
        if isinstance(coefficient, Rational):
            if coefficient > MAX_EXPONENT:
                self.refuse(node, f"an exponent beyond {MAX_EXPONENT}")
            if max(coefficient.p, coefficient.q) > MAX_EXPONENT:
                self.refuse(node, f"an exponent whose numerator or denominator is beyond {MAX_EXPONENT}")
            if _bits(base) * max(1, int(coefficient)) > MAX_BITS:
                self.refuse(node, "the power is a number too long to be meant")
        if base is sp.S.Zero and isinstance(exponent, Rational) and exponent < 0:
            self.refuse(node, "division by zero")
        self.exponential(node, exponent)
        return sp.Pow(base, exponent)

    def exponential(self, node: syntax.Node, exponent: Expr) -> None:
        """Refuse exponents like 10**9*log(2), which SymPy turns into 2**10**9."""
        if not exponent.has(sp.log):
            return
        for term in sp.Add.make_args(exponent):
            if abs(term.as_coeff_Mul()[0]) > MAX_EXPONENT:
                self.refuse(node, f"a multiple of a logarithm beyond {MAX_EXPONENT} in an exponent")


def _first_sentence(error: Exception) -> str:
    return str(error).strip().partition("\n")[0].rstrip(".") or type(error).__name__


def _bits(value: Expr) -> int:
    """Return the length of the rational number in front of an expression, at least 1."""
    number = value.as_coeff_Mul()[0]
    if not isinstance(number, Rational):
        return 1
    return max(int(number.p).bit_length(), int(number.q).bit_length(), 1)


_OWN = ("Derivative", "diff", "D", "Piecewise", "Ne", "Eq", "And", "Or", "True", TOTAL, PARTIAL, PRIMED, "d/dx",
        INTEGRAL, SUM, PRODUCT)  # fmt: skip
"""Functions with a meaning of their own."""


def _column(nodes: Sequence[syntax.Node]) -> int:
    return nodes[0].column if nodes else 0
