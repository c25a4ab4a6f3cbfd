"""Node storage of the expression graph: an arena that holds every distinct operation once.

Children have smaller numbers than their parents, so that a pass in rising order is a forward sweep, in falling order
a reverse sweep, and nothing recurses.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

from canon.cached_property import cached_property

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from sympy import Symbol

__all__ = ["Arena", "Node"]


class Node(NamedTuple):
    """One operation: its kind, its operands' numbers, and for a leaf its value.

    ``kind`` is ``"number"`` (``value`` a Fraction), ``"named"`` (``"pi"`` or ``"E"``), ``"symbol"`` (a SymPy
    Symbol), ``"add"``, ``"mul"``, ``"pow"`` (base, exponent), ``"atan2"`` (y, x) or a function's name.
    """

    kind: str
    operands: tuple[int, ...] = ()
    value: Any = None


_KEPT = 64
"""Of how many groups of nodes it is kept what they are computed from."""


class Arena:
    """Storage of expression nodes: equal operations on equal operands are one node.

    Examples
    --------
    >>> arena = Arena()
    >>> arena.operation("sin", (arena.number(2),)) == arena.operation("sin", (arena.number(2),))
    True
    """

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.masks: list[int] = []
        """Which symbols each node depends on, one bit a symbol; see :meth:`mask`."""
        self._number_of: dict[tuple[Any, ...], int] = {}
        self._rationals: dict[Fraction | int, int] = {}
        self._variables: dict[Symbol, int] = {}
        self._bits: dict[Symbol, int] = {}
        self._in_order: list[Symbol] = []
        self._reached: dict[tuple[int, ...], tuple[int, ...]] = {}
        self._sets: dict[bytes, frozenset[Symbol]] = {}
        self.negatives: dict[int, int] = {}
        """The node of −x for each node x whose negative was asked for."""

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
            self._in_order.append(symbol)
            found = self._variables[symbol] = self._leaf(Node("symbol", (), symbol), bit)
        return found

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

    def reachable(self, nodes: Iterable[int]) -> Sequence[int]:
        """Return the given nodes and all they are computed from, operands first."""
        asked = tuple(nodes)
        known = self._reached.get(asked)
        if known is None:
            found, waiting = set[int](), list(asked)
            while waiting:
                node = waiting.pop()
                if node not in found:
                    found.add(node)
                    waiting.extend(self.nodes[node].operands)
            if len(self._reached) >= _KEPT:
                self._reached.clear()
            known = self._reached[asked] = tuple(sorted(found))
        return known

    def is_constant(self, node: int) -> bool:
        """Whether a node depends on no symbol."""
        return not self.masks[node]

    def symbols(self, node: int) -> frozenset[Symbol]:
        """Return the symbols a node depends on."""
        return self.all_symbols((node,))

    def all_symbols(self, nodes: Iterable[int]) -> frozenset[Symbol]:
        """Return the symbols that nodes depend on together."""
        mask = 0
        for node in nodes:
            mask |= self.masks[node]
        # As bytes: Python's hash of 2^k is that of 2^(k mod 61), so that thousands of symbols would collide.
        key = mask.to_bytes((mask.bit_length() + 7) // 8, "little")
        found = self._sets.get(key)
        if found is None:
            found = self._sets[key] = frozenset(self._marked(mask))
        return found

    def _marked(self, mask: int) -> Iterator[Symbol]:
        """Yield the symbols whose bits are set; of thousands of symbols most nodes depend on a few."""
        while mask:
            place = mask.bit_length() - 1
            yield self._in_order[place]
            mask ^= 1 << place

    def mask(self, symbols: Iterable[Symbol]) -> int:
        """Return the bits of symbols: a node depends on one of them where ``masks[node] & mask(symbols)``."""
        total = 0
        for symbol in symbols:
            total |= self._bits.get(symbol, 0)
        return total
