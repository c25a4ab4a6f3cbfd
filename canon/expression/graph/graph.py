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
from typing import TYPE_CHECKING, Any, NamedTuple

from canon.expression.graph import algebra, differentiation, evaluation
from canon.expression.graph import sympy_conversion as translation
from canon.expression.graph.elementary import AT_ZERO, SLOPES
from canon.expression.graph.number_systems import FLOAT64

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.expression.graph.number_systems import Arithmetic

__all__ = ["Graph", "Node"]


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
        self.masks: list[int] = []
        """Which symbols each node depends on, one bit a symbol; see :meth:`mask`."""
        self._number_of: dict[tuple[Any, ...], int] = {}
        self._rationals: dict[Fraction | int, int] = {}
        self._variables: dict[Symbol, int] = {}
        self._bits: dict[Symbol, int] = {}
        self._sets: dict[int, frozenset[Symbol]] = {0: frozenset()}
        self._derivatives: dict[Symbol, dict[int, int]] = {}
        self._negatives: dict[int, int] = {}

    # building ------------------------------------------------------------------------------------

    def _leaf(self, node: Node, mask: int = 0) -> int:
        self.nodes.append(node)
        self.masks.append(mask)
        return len(self.nodes) - 1

    def operation(self, kind: str, operands: tuple[int, ...]) -> int:
        """Return the node of an operation as it stands: operands sorted where order does not matter, a number first."""
        number = self._number_of.get((kind, operands))
        if number is None:
            mask = 0
            for operand in operands:
                mask |= self.masks[operand]
            number = self._number_of[kind, operands] = self._leaf(Node(kind, operands), mask)
        return number

    def number(self, value: Fraction | int) -> int:
        """Return the node of an exact rational number."""
        found = self._rationals.get(value)
        if found is None:
            found = self._rationals[value] = self._leaf(Node("number", (), Fraction(value)))
        return found

    @cached_property
    def zero(self) -> int:
        """The node of 0."""
        return self.number(0)

    @cached_property
    def one(self) -> int:
        """The node of 1."""
        return self.number(1)

    @cached_property
    def minus_one(self) -> int:
        """The node of −1."""
        return self.number(-1)

    def named(self, name: str) -> int:
        """Return the node of π (``"pi"``) or e (``"E"``)."""
        if name not in ("pi", "E"):
            raise ValueError(f"no constant is called {name!r}; the graph knows 'pi' and 'E'")
        number = self._number_of.get(("named", name))
        if number is None:
            number = self._number_of["named", name] = self._leaf(Node("named", (), name))
        return number

    def symbol(self, symbol: Symbol) -> int:
        """Return the node of a symbol."""
        found = self._variables.get(symbol)
        if found is None:
            bit = self._bits[symbol] = 1 << len(self._bits)
            found = self._variables[symbol] = self._leaf(Node("symbol", (), symbol), bit)
        return found

    def add(self, terms: Iterable[int]) -> int:
        """Return the sum of nodes, equal terms merged."""
        return algebra.add(self, terms)

    def mul(self, factors: Iterable[int]) -> int:
        """Return the product of nodes, powers of equal bases merged."""
        return algebra.mul(self, factors)

    def pow(self, base: int, exponent: int) -> int:
        """Return base**exponent, the principal value."""
        return algebra.power(self, base, exponent)

    def plain_add(self, terms: Iterable[int]) -> int:
        """Return a sum whose terms stay as they are: only zeros disappear, nothing is merged or flattened."""
        zero = self.zero
        return self._plain("add", [term for term in terms if term != zero], zero)

    def plain_mul(self, factors: Iterable[int]) -> int:
        """Return a product whose factors stay as they are: only 1 disappears, and 0 makes it 0."""
        one = self.one
        operands = [factor for factor in factors if factor != one]
        return self.zero if self.zero in operands else self._plain("mul", operands, one)

    def _plain(self, kind: str, operands: list[int], neutral: int) -> int:
        if len(operands) > 1:
            operands.sort()
            return self.operation(kind, tuple(operands))
        return operands[0] if operands else neutral

    def scaled(self, factor: Fraction | int, node: int) -> int:
        """Return factor · node without looking at anything but node's own numerical factor."""
        return algebra.scaled(self, factor, node)

    def negative(self, node: int) -> int:
        """Return −node."""
        found = self._negatives.get(node)
        if found is None:
            found = self._negatives[node] = self.scaled(-1, node)
        return found

    def apart(self, node: int) -> int:
        """Return c·x with x as one factor, which other multiples of x then share."""
        factor, rest = algebra.factored(self, node)
        return node if rest is None or factor == 1 else self.multiple(factor, rest)

    def multiple(self, factor: Fraction | int, node: int) -> int:
        """Return factor · node with the node as it is."""
        return self.operation("mul", (self.number(factor), node))

    def power(self, base: int, exponent: Fraction | int) -> int:
        """Return base**exponent for an exact exponent."""
        return self.pow(base, self.number(exponent))

    def function(self, name: str, *operands: int) -> int:
        """Return an elementary function, by its SymPy name, of nodes."""
        if name not in SLOPES and name != "atan2":
            raise ValueError(
                f"the graph has no function {name!r}; it knows {', '.join(sorted(SLOPES))}, atan2"
            )
        if len(operands) == 1 and operands[0] == self.zero and name in AT_ZERO:
            return self.number(AT_ZERO[name])
        return self.operation(name, operands)

    # SymPy ---------------------------------------------------------------------------------------

    def from_sympy(self, expression: Expr) -> int:
        """Return the node of a SymPy expression.

        Floats are taken for the exact binary numbers they are.

        Raises
        ------
        canon.expression.graph.sympy_conversion.NotModelledError
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
        return self.all_symbols((node,))

    def all_symbols(self, nodes: Iterable[int]) -> frozenset[Symbol]:
        """Return the symbols that nodes depend on together."""
        mask = 0
        for node in nodes:
            mask |= self.masks[node]
        found = self._sets.get(mask)
        if found is None:
            found = self._sets[mask] = frozenset(s for s, bit in self._bits.items() if bit & mask)
        return found

    def mask(self, symbols: Iterable[Symbol]) -> int:
        """Return the bits of symbols: a node depends on one of them where ``masks[node] & mask(symbols)``."""
        total = 0
        for symbol in symbols:
            total |= self._bits.get(symbol, 0)
        return total

    def derivative(self, node: int, symbol: Symbol) -> int:
        """Return ∂node/∂symbol (forward sweep, remembered for every subexpression).

        d|x|/dx is sign(x) and d sign(x)/dx is 0, which leaves out x = 0.
        """
        return differentiation.derivative(self, node, symbol, self._derivatives.setdefault(symbol, {}))

    def gradient(self, node: int, symbols: Sequence[Symbol]) -> tuple[int, ...]:
        """Return ∂node/∂symbol for many symbols at once (reverse sweep).

        The gradient costs a small multiple of the expression itself, whatever the number of symbols.
        """
        return differentiation.gradient(self, node, symbols)

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
            How exact constants and functions are evaluated; see :mod:`canon.expression.graph.number_systems`.

        Returns
        -------
        list
            One value for each node. Floating-point arithmetics return NaN outside a function's domain.

        Raises
        ------
        KeyError
            A symbol has no value.
        """
        return evaluation.evaluate(self, nodes, values, arithmetic)
