"""A shared expression graph: every distinct subexpression is one node, however often it is used.

SymPy expressions are trees; derivatives of trees swell. Here an expression is an integer, the number of a
node in an arena, and equal expressions are the same integer, so derivatives share what they have in common
and a program compiled from them computes everything once. Children have smaller numbers than their
parents: a pass in rising order is a forward sweep, in falling order a reverse sweep, and nothing recurses.

Only light algebra is done, on exact numbers: constants are folded, 0 and 1 disappear, short sums and
products are flattened, equal terms and equal bases are merged. Like SymPy, x·x⁻¹ becomes 1.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

from canon.expression import translation
from canon.expression.arithmetic import FLOAT64
from canon.expression.elementary import AT_ZERO, SLOPES, folded_power

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.expression.arithmetic import Arithmetic

__all__ = ["Graph", "Node"]

_FLATTENED = 8
"""Sums and products longer than this stay one shared node when they are part of a longer one."""


class Node(NamedTuple):
    """One operation: its kind, its operands' numbers, and for a leaf its value.

    ``kind`` is ``"number"`` (``value`` a Fraction), ``"named"`` (``"pi"`` or ``"E"``), ``"symbol"`` (a SymPy
    Symbol), ``"add"``, ``"mul"``, ``"pow"`` (base, exponent), ``"atan2"`` (y, x) or a function's name.
    """

    kind: str
    operands: tuple[int, ...] = ()
    value: Any = None


class Graph:
    """An arena of expression nodes.

    Examples
    --------
    >>> from sympy import cos, sin, symbols
    >>> x, y = symbols("x y")
    >>> graph = Graph()
    >>> f = graph.from_sympy(x * sin(x * y))
    >>> graph.to_sympy(graph.derivative(f, x))
    x*y*cos(x*y) + sin(x*y)
    >>> print(*graph.evaluate([f], {x: 0.5, y: 3.0}))
    0.498747...
    """

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self._number_of: dict[Node, int] = {}
        self._symbols: list[frozenset[Symbol]] = []
        self._derivatives: dict[Symbol, dict[int, int]] = {}

    # building ------------------------------------------------------------------------------------

    def _node(self, kind: str, operands: tuple[int, ...] = (), value: Any = None) -> int:
        node = Node(kind, operands, value)
        number = self._number_of.get(node)
        if number is None:
            number = self._number_of[node] = len(self.nodes)
            self.nodes.append(node)
            own = [frozenset((value,))] if kind == "symbol" else [self._symbols[o] for o in operands]
            self._symbols.append(own[0] if len(own) == 1 else frozenset[Any]().union(*own))
        return number

    def number(self, value: Fraction | int) -> int:
        """Return the node of an exact rational number."""
        return self._node("number", value=Fraction(value))

    @cached_property
    def zero(self) -> int:
        """The node of 0."""
        return self.number(0)

    @cached_property
    def one(self) -> int:
        """The node of 1."""
        return self.number(1)

    def named(self, name: str) -> int:
        """Return the node of π (``"pi"``) or e (``"E"``)."""
        if name not in ("pi", "E"):
            raise ValueError(f"no constant is called {name!r}; the graph knows 'pi' and 'E'")
        return self._node("named", value=name)

    def symbol(self, symbol: Symbol) -> int:
        """Return the node of a symbol."""
        return self._node("symbol", value=symbol)

    def add(self, terms: Iterable[int]) -> int:
        """Return the sum of nodes, equal terms merged."""
        constant, coefficients = Fraction(0), dict[int, Fraction]()
        for term in self._flat("add", terms):
            factor, rest = self._factored(term)
            if rest is None:
                constant += factor
            else:
                coefficients[rest] = coefficients.get(rest, Fraction(0)) + factor
        operands = sorted(self.scaled(factor, rest) for rest, factor in coefficients.items() if factor)
        if constant:
            operands.insert(0, self.number(constant))
        if len(operands) < 2:
            return operands[0] if operands else self.number(0)
        return self._node("add", tuple(operands))

    def mul(self, factors: Iterable[int]) -> int:
        """Return the product of nodes, powers of equal bases merged."""
        constant, exponents = Fraction(1), dict[int, Fraction]()
        for factor in self._flat("mul", factors):
            node = self.nodes[factor]
            if node.kind == "number":
                constant *= node.value
                continue
            base, exponent = self._powered(factor)
            exponents[base] = exponents.get(base, Fraction(0)) + exponent
        operands: list[int] = []
        for base, exponent in exponents.items():
            power = self.pow(base, self.number(exponent))
            if self.nodes[power].kind == "number":
                constant *= self.nodes[power].value
            else:
                operands.append(power)
        if not constant:
            return self.number(0)
        return self._product(constant, tuple(sorted(operands)))

    def _product(self, constant: Fraction, operands: tuple[int, ...]) -> int:
        if constant != 1 or not operands:
            operands = (self.number(constant), *operands)
        return operands[0] if len(operands) == 1 else self._node("mul", operands)

    def plain_add(self, terms: Iterable[int]) -> int:
        """Return a sum whose terms stay as they are: only zeros disappear, nothing is merged or flattened."""
        return self._plain("add", sorted(term for term in terms if term != self.zero), self.zero)

    def plain_mul(self, factors: Iterable[int]) -> int:
        """Return a product whose factors stay as they are: only 1 disappears, and 0 makes it 0."""
        operands = sorted(factor for factor in factors if factor != self.one)
        return self.zero if self.zero in operands else self._plain("mul", operands, self.one)

    def _plain(self, kind: str, operands: list[int], neutral: int) -> int:
        if len(operands) > 1:
            return self._node(kind, tuple(operands))
        return operands[0] if operands else neutral

    def scaled(self, factor: Fraction, node: int) -> int:
        """Return factor · node without looking at anything but node's own numerical factor."""
        own, rest = self._factored(node)
        if rest is None or not factor:
            return self.number(factor * own)
        operands = self.nodes[rest].operands if self.nodes[rest].kind == "mul" else (rest,)
        return self._product(factor * own, operands)

    def negative(self, node: int) -> int:
        """Return −node."""
        return self.scaled(Fraction(-1), node)

    def pow(self, base: int, exponent: int) -> int:
        """Return base**exponent, the principal value."""
        if self.nodes[exponent].kind != "number":
            return self._node("pow", (base, exponent))
        power: Fraction = self.nodes[exponent].value
        if power in (0, 1):
            return base if power else self.number(1)
        node = self.nodes[base]
        if node.kind == "number":
            folded = folded_power(node.value, power)
            return self._node("pow", (base, exponent)) if folded is None else self.number(folded)
        if power.denominator == 1:
            inner, own = self._powered(base)
            if own != 1:
                return self.pow(inner, self.number(own * power))
            factor, rest = self._factored(base)
            if factor != 1 and rest is not None:
                return self.mul([self.pow(self.number(factor), exponent), self.pow(rest, exponent)])
        return self._node("pow", (base, exponent))

    def power(self, base: int, exponent: Fraction | int) -> int:
        """Return base**exponent for an exact exponent."""
        return self.pow(base, self.number(exponent))

    def function(self, name: str, *operands: int) -> int:
        """Return an elementary function, by its SymPy name, of nodes."""
        if name not in SLOPES and name != "atan2":
            raise ValueError(
                f"the graph has no function {name!r}; it knows {', '.join(sorted(SLOPES))}, atan2"
            )
        if len(operands) == 1 and self.nodes[operands[0]] == Node("number", (), 0) and name in AT_ZERO:
            return self.number(AT_ZERO[name])
        return self._node(name, operands)

    def _flat(self, kind: str, operands: Iterable[int]) -> list[int]:
        flat: list[int] = []
        for operand in operands:
            node = self.nodes[operand]
            flat.extend(
                node.operands if node.kind == kind and len(node.operands) <= _FLATTENED else (operand,)
            )
        return flat

    def _factored(self, node: int) -> tuple[Fraction, int | None]:
        """Split c·x into its number c and the rest x (None where the node is a number)."""
        kind, operands, value = self.nodes[node]
        if kind == "number":
            return value, None
        if kind == "mul" and self.nodes[operands[0]].kind == "number":
            return self.nodes[operands[0]].value, self._product(Fraction(1), operands[1:])
        return Fraction(1), node

    def _powered(self, node: int) -> tuple[int, Fraction]:
        """Split x**c into x and the exact number c (1 for what is no such power)."""
        kind, operands, _ = self.nodes[node]
        if kind == "pow" and self.nodes[operands[1]].kind == "number":
            return operands[0], self.nodes[operands[1]].value
        return node, Fraction(1)

    # SymPy ---------------------------------------------------------------------------------------

    def from_sympy(self, expression: Expr) -> int:
        """Return the node of a SymPy expression.

        Floats are taken for the exact binary numbers they are.

        Raises
        ------
        canon.expression.translation.NotModelledError
            The expression holds something the graph has no operation for; the message names it.
        """
        return translation.from_sympy(self, expression)

    def to_sympy(self, node: int) -> Expr:
        """Return a node as a SymPy expression."""
        return translation.to_sympy(self, [node])[0]

    # sweeps --------------------------------------------------------------------------------------

    def reachable(self, nodes: Iterable[int]) -> list[int]:
        """Return the given nodes and all they are computed from, operands first."""
        found, waiting = set[int](), list(nodes)
        while waiting:
            node = waiting.pop()
            if node not in found:
                found.add(node)
                waiting.extend(self.nodes[node].operands)
        return sorted(found)

    def symbols(self, node: int) -> frozenset[Symbol]:
        """Return the symbols a node depends on."""
        return self._symbols[node]

    def derivative(self, node: int, symbol: Symbol) -> int:
        """Return ∂node/∂symbol (forward sweep, remembered for every subexpression).

        d|x|/dx is sign(x) and d sign(x)/dx is 0, which leaves out x = 0.
        """
        known = self._derivatives.setdefault(symbol, {})
        for each in self.reachable([node]) if node not in known else ():
            if each in known:
                continue
            kind, operands, value = self.nodes[each]
            if kind == "symbol":
                known[each] = self.number(int(value == symbol))
            elif symbol not in self.symbols(each):
                known[each] = self.number(0)
            else:
                slopes = zip(operands, self.slopes(each), strict=True)
                known[each] = self.add(
                    [self.mul([slope, known[o]]) for o, slope in slopes if symbol in self.symbols(o)]
                )
        return known[node]

    def gradient(self, node: int, symbols: Sequence[Symbol]) -> tuple[int, ...]:
        """Return ∂node/∂symbol for many symbols at once (reverse sweep).

        The gradient costs a small multiple of the expression itself, whatever the number of symbols.
        """
        wanted = frozenset(symbols)
        contributions: dict[int, list[int]] = {node: [self.number(1)]}
        for each in reversed(self.reachable([node])):
            if each not in contributions or self.nodes[each].kind == "symbol":
                continue
            adjoint = self.add(contributions.pop(each))
            for operand, slope in zip(self.nodes[each].operands, self.slopes(each), strict=True):
                if wanted & self.symbols(operand):
                    contributions.setdefault(operand, []).append(self.mul([adjoint, slope]))
        return tuple(self.add(contributions.get(self.symbol(symbol), ())) for symbol in symbols)

    def slopes(self, node: int) -> tuple[int, ...]:
        """Return the partial derivatives of a node's operation by its operands."""
        kind, operands, _ = self.nodes[node]
        if kind == "add":
            return (self.one,) * len(operands)
        if kind == "mul":
            return self._products_of_others(operands)
        if kind == "pow":
            base, exponent = operands
            lowered = self.mul([exponent, self.pow(base, self.add([exponent, self.number(-1)]))])
            if self.nodes[exponent].kind in ("number", "named"):
                return lowered, self.number(0)
            return lowered, self.mul([node, self.function("log", base)])
        if kind == "atan2":
            y, x = operands
            inverse = self.power(self.add([self.power(x, 2), self.power(y, 2)]), -1)
            return self.mul([x, inverse]), self.negative(self.mul([y, inverse]))
        return (SLOPES[kind](self, operands[0], node),) if operands else ()

    def _products_of_others(self, factors: tuple[int, ...]) -> tuple[int, ...]:
        before, after = [self.one], [self.one]
        for factor in factors[:-1]:
            before.append(self.mul([before[-1], factor]))
        for factor in reversed(factors[1:]):
            after.append(self.mul([after[-1], factor]))
        return tuple(self.mul(pair) for pair in zip(before, reversed(after), strict=True))

    def substitute(self, nodes: Sequence[int], replacements: Mapping[int, int]) -> list[int]:
        """Return nodes with some subexpressions replaced by others, all at once."""
        image = dict[int, int]()
        for each in self.reachable(nodes):
            if each in replacements:
                image[each] = replacements[each]
            else:
                image[each] = self._rebuilt(each, [image[o] for o in self.nodes[each].operands])
        return [image[node] for node in nodes]

    def _rebuilt(self, node: int, operands: list[int]) -> int:
        kind, old, _ = self.nodes[node]
        if list(old) == operands:
            return node
        if kind == "add":
            return self.add(operands)
        if kind == "mul":
            return self.mul(operands)
        return self.pow(*operands) if kind == "pow" else self.function(kind, *operands)

    def evaluate(
        self, nodes: Sequence[int], values: Mapping[Symbol, Any], arithmetic: Arithmetic = FLOAT64
    ) -> list[Any]:
        """Return the values of nodes at a point, or at an array of points.

        Parameters
        ----------
        nodes
            What to evaluate; common subexpressions are evaluated once.
        values
            A number or NumPy array for each symbol, of the kind the arithmetic works with.
        arithmetic
            How exact constants and functions are evaluated; see :mod:`canon.expression.arithmetic`.

        Returns
        -------
        list
            One value for each node. Floating-point arithmetics return NaN outside a function's domain.

        Raises
        ------
        KeyError
            A symbol has no value.
        """
        done = dict[int, Any]()
        with arithmetic.quiet():
            for each in self.reachable(nodes):
                kind, operands, value = self.nodes[each]
                if kind == "symbol" and value not in values:
                    raise KeyError(f"no value given for the symbol {value}")
                done[each] = (
                    values[value]
                    if kind == "symbol"
                    else self._value(each, [done[o] for o in operands], arithmetic)
                )
        return [done[node] for node in nodes]

    def _value(self, node: int, x: list[Any], arithmetic: Arithmetic) -> Any:
        kind, operands, value = self.nodes[node]
        if kind == "number":
            return arithmetic.number(value)
        if kind == "named":
            return arithmetic.named(value)
        if kind == "add":
            return sum(x[1:], x[0])
        if kind == "mul":
            return prod(x[1:], start=x[0])
        if kind == "pow":
            exponent = self.nodes[operands[1]]
            return arithmetic.power(x[0], exponent.value if exponent.kind == "number" else x[1])
        return arithmetic.functions[kind](*x)
