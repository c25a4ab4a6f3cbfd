"""The expression graph: every distinct subexpression is one node, however often it is used.

SymPy expressions are trees; derivatives of trees swell. Here an expression is an integer, the number of a
node in an arena, and equal expressions are the same integer, so derivatives share what they have in common
and a program compiled from them computes everything once. Children have smaller numbers than their
parents: a pass in rising order is a forward sweep, in falling order a reverse sweep, and nothing recurses.

Only light algebra is done, on exact numbers: constants are folded, 0 and 1 disappear, short sums and
products are flattened, equal terms and equal bases are merged. Like SymPy, x·x⁻¹ becomes 1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from canon.expression.graph import algebra, differentiation, elementary, evaluation, sympy_conversion
from canon.expression.graph.arena import Arena, Node
from canon.expression.graph.number_systems import FLOAT64

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from fractions import Fraction

    from sympy import Expr, Symbol

    from canon.expression.graph.number_systems import Arithmetic

__all__ = ["Graph", "Node"]


class Graph(Arena):
    """Expression graph: every distinct subexpression is a node, stored once and known by its number.

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
        super().__init__()
        self._derivatives: dict[Symbol, dict[int, int]] = {}

    # building ------------------------------------------------------------------------------------

    def add(self, terms: Iterable[int]) -> int:
        """Return the sum of nodes, equal terms merged."""
        return algebra.add(self, terms)

    def mul(self, factors: Iterable[int]) -> int:
        """Return the product of nodes, powers of equal bases merged."""
        return algebra.mul(self, factors)

    def pow(self, base: int, exponent: int) -> int:
        """Return base**exponent, the principal value."""
        return algebra.power(self, base, exponent)

    def scaled(self, factor: Fraction | int, node: int) -> int:
        """Return factor · node without looking at anything but node's own numerical factor."""
        return algebra.scaled(self, factor, node)

    def negative(self, node: int) -> int:
        """Return −node."""
        return algebra.negative(self, node)

    def apart(self, node: int) -> int:
        """Return c·x with x as one factor, which other multiples of x then share."""
        factor, rest = algebra.factored(self, node)
        return node if rest is None or factor == 1 else self.multiple(factor, rest)

    def multiple(self, factor: Fraction | int, node: int) -> int:
        """Return factor · node with the node as it is."""
        return self.operation("mul", (self.number(factor), node))

    def power(self, base: int, exponent: Fraction | int) -> int:
        """Return base**exponent for an exact exponent."""
        return algebra.raised(self, base, exponent)

    def function(self, name: str, *operands: int) -> int:
        """Return an elementary function, by its SymPy name, of nodes."""
        return elementary.function(self, name, *operands)

    # SymPy ---------------------------------------------------------------------------------------

    def from_sympy(self, expression: Expr) -> int:
        """Return the node of a SymPy expression.

        Floats are taken for the exact binary numbers they are.

        Raises
        ------
        canon.expression.graph.sympy_conversion.NotModelledError
            The expression holds something the graph has no operation for; the message names it.
        """
        return sympy_conversion.from_sympy(self, expression)

    def to_sympy(self, node: int) -> Expr:
        """Return a node as a SymPy expression."""
        return sympy_conversion.to_sympy(self, [node])[0]

    # sweeps --------------------------------------------------------------------------------------

    def derivative(self, node: int, symbol: Symbol) -> int:
        """Return ∂node/∂symbol (forward sweep, remembered for every subexpression).

        d|x|/dx is sign(x) and d sign(x)/dx is 0, which leaves out x = 0.
        """
        return differentiation.derivative(self, node, symbol, self._derivatives.setdefault(symbol, {}))

    def directional(self, nodes: Sequence[int], along: Mapping[Symbol, int]) -> list[int]:
        """Return the rates of nodes whose symbols change at the given rates, themselves nodes (one forward sweep)."""
        return differentiation.directional(self, nodes, along)

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
