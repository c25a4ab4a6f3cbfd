"""Unbuilt candidates: an answer with one change in it, whose value is known before its tree is made.

Nearly all candidates are told to be wrong by their first value. That of a changed node follows upwards, along the path
to the root, from the values of what stands beside it, which all candidates share; SymPy puts together only the trees of
those that pass.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias, cast

import sympy as sp
from sympy import Expr

from canon.proof.domain.ball_functions import FUNCTIONS, NotDecided, Undefined, Unmodelled, power

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from flint import acb

__all__ = ["Form", "Joined", "Place", "Unbuilt", "Values", "Within", "built", "places", "product"]


class Place:
    """Where an operand stands in a sum, a product or another node.

    Parameters
    ----------
    node
        The whole of which it is an operand.
    index
        Which operand it is.
    """

    __slots__ = ("_hash", "index", "node", "operand")

    def __init__(self, node: Expr, index: int) -> None:
        self.node, self.index = node, index
        self.operand = cast("Expr", node.args[index])
        self._hash = hash((node, index))

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Place) and self.index == other.index and self.node == other.node

    @property
    def beside(self) -> tuple[Expr, ...]:
        """The other operands."""
        operands = cast("tuple[Expr, ...]", self.node.args)
        return (*operands[: self.index], *operands[self.index + 1 :])

    @property
    def is_valued(self) -> bool:
        """Whether the value of the node follows from those of its operands."""
        node = self.node
        return bool(node.is_Add or node.is_Mul or (node.is_Pow and self.index == 0) or node.func in FUNCTIONS)


@dataclass(frozen=True, slots=True, eq=False)
class Within:
    """A node with something else in one place."""

    place: Place
    new: Form


@dataclass(frozen=True, slots=True, eq=False)
class Joined:
    """A sum or a product of expressions.

    Parameters
    ----------
    join
        ``Add`` or ``Mul``.
    parts
        Its terms or factors.
    """

    join: type[sp.Add] | type[sp.Mul]
    parts: tuple[Form, ...]


Unbuilt: TypeAlias = "Within | Joined"
Form: TypeAlias = "Expr | Unbuilt"
"""An expression, built or not."""


def places(f: Expr) -> Iterator[Place]:
    """Yield the places of the operands of an expression."""
    return (Place(f, i) for i in range(len(f.args)))


def product(*factors: Expr) -> Joined:
    """Return an unbuilt product."""
    return Joined(sp.Mul, factors)


def built(f: Form) -> Expr:
    """Return the expression itself.

    Raises
    ------
    TypeError, ValueError
        Where SymPy has no such expression, as a comparison with i.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> built(Within(Place(sp.sin(x), 0), product(x, y)))
    sin(x*y)
    """
    if isinstance(f, Within):
        operands, i = f.place.node.args, f.place.index
        return f.place.node.func(*operands[:i], built(f.new), *operands[i + 1 :])
    if isinstance(f, Joined):
        return f.join(*map(built, f.parts))
    return f


class Values:
    """Values at one point: of what is built by what is given, of the rest from these.

    Where the value of a whole does not follow from those of its operands, as that of (x y)/x at x = 0, it is built.

    Parameters
    ----------
    of
        Gives the value of an expression.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> from flint import acb
    >>> at = Values(lambda f: acb(int(f.subs({x: 2, y: 3}))))
    >>> at(Within(Place(x + y, 0), product(x, x)))
    7.00000000000000
    """

    def __init__(self, of: Callable[[Expr], acb]) -> None:
        self._of = of
        self._around: dict[Place, acb] = {}

    def __call__(self, f: Form) -> acb:
        """Return the value of an expression, built or not.

        Raises
        ------
        Undefined, NotDecided, Unmodelled
            Where it has none.
        """
        if isinstance(f, Expr):
            return self._of(f)
        try:
            return self._followed(f)
        except (Undefined, NotDecided, Unmodelled):
            pass
        try:
            whole = built(f)
        except (TypeError, ValueError) as error:
            raise Undefined(str(error)) from error
        return self._of(whole)

    def _followed(self, f: Form) -> acb:
        if isinstance(f, Within):
            found = self._in(f.place, self._followed(f.new))
        elif isinstance(f, Joined):
            found = _joined(f.join is sp.Add, map(self._followed, f.parts))
        else:
            return self._of(f)
        if not found.is_finite():
            raise NotDecided
        return found

    def _in(self, place: Place, new: acb) -> acb:
        """Return the value of a node with another value in one place."""
        node = place.node
        if node.is_Pow:
            exponent = place.beside[0]
            return power(new, self._of(exponent), exponent)
        if not (node.is_Add or node.is_Mul):
            before, after = node.args[: place.index], node.args[place.index + 1 :]
            of = self._of
            return FUNCTIONS[node.func](
                *(of(cast("Expr", a)) for a in before), new, *(of(cast("Expr", a)) for a in after)
            )
        around = self._around.get(place)
        if around is None:
            around = self._around[place] = _joined(bool(node.is_Add), map(self._of, place.beside))
        return around + new if node.is_Add else around * new


def _joined(is_sum: bool, values: Iterator[acb]) -> acb:
    total = next(values)
    for value in values:
        total = total + value if is_sum else total * value
    return total
