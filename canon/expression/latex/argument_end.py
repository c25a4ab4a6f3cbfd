r"""End of an argument without brackets: which factors after ``\sin`` are still under the sine.

``\sin\theta\dot\phi`` is sin(θ) φ̇, since no one takes the sine of an angle times a velocity; ``\cos\omega t`` is
cos(ωt). What could be either is said to be open, and the reader asks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

from canon.expression.latex.names import Mark
from canon.expression.latex.pieces import Group, Piece, Powered, is_function, names_in, unbraced
from canon.expression.latex.understood_time import is_time
from canon.expression.symbols.symbol import Coordinate, Momentum, Rate
from canon.expression.text.open_readings import counts, is_angle, is_angle_of_functions, stem_of
from canon.expression.text.syntax import Name, Node

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.expression.text.scope import Scope

__all__ = ["ArgumentEnd", "bare_argument"]

_WAVES = (
    "k",
    "n",
    "m",
    "l",
    "j",
    "i",
    "N",
    "omega",
    "Omega",
    "nu",
    "kappa",
    "lambda",
    "lamda",
    "mu",
    "w",
    "s",
)
"""Letters that count waves or turns: arguments begin with them."""


@dataclass(frozen=True)
class ArgumentEnd:
    """Tells where arguments end.

    Parameters
    ----------
    scope
        The declared names.
    spaced
        Columns that a visible space stands before.
    """

    scope: Scope
    spaced: frozenset[int]

    def is_numeric(self, node: Node) -> bool:
        """Whether a factor is a number, π among them."""
        return all(name.text == "pi" and self.scope.symbol("pi") is None for name in names_in(node))

    def moves(self, node: Node) -> bool:
        """Whether a factor changes with the time."""
        return any(self._moves(name.text) for name in names_in(node))

    def is_angle(self, node: Node) -> bool:
        """Whether every name in a factor is that of an angle."""
        names = [name.text for name in names_in(node) if name.text != "pi"]
        return bool(names) and all(map(is_angle_of_functions, names))

    def lies_before(self, taken: list[Node], item: Piece) -> bool:
        """Whether an argument is complete before a factor that no argument would go on with."""
        whole = any(map(self.moves, taken)) or self.is_angle(taken[-1])
        base = unbraced(item.base) if isinstance(item, Powered) else unbraced(item)
        if isinstance(base, Mark) and base.text in ("d", "delta"):  # no function is taken of a differential
            return True
        if not whole:
            return False
        if isinstance(base, Mark):
            return base.text == "e" and isinstance(item, Powered)
        if isinstance(base, Name):
            symbol = self.scope.symbol(base.text)
            return isinstance(symbol, Rate) or (self.is_angle(taken[-1]) and isinstance(symbol, Momentum))
        if not (isinstance(base, Group) and base.printed and self.is_angle(taken[-1])):
            return False
        wave = not any(is_angle(name.text) or self._moves(name.text) for name in names_in(taken[-1]))
        return not is_time(base, self.scope) and not (wave and self.holds_what_moves(base))

    def holds_what_moves(self, group: Group) -> bool:
        r"""Whether a bracket could go on with an argument, as in ``\cos\beta(x - v t)``."""
        return any(self._moves(name.text) or name.text in "xyzt" for name in _names_of(group))

    def is_another_time(self, name: Name, group: Group) -> bool:
        """Whether a bracket behind what moves holds the time and nothing else that moves, as in ``x(t - a)``."""
        held = {inside.text for inside in _names_of(group)}
        clock = self.scope.time.name
        others = any(self._moves(text) for text in held if text != clock)
        return (
            group.column not in self.spaced
            and name.text != clock
            and self._moves(name.text)
            and clock in held
            and not others
        )

    def divides(self, argument: tuple[Piece, ...], below: Piece) -> bool:
        r"""Whether a slash behind a function divides it, ``g\sin\theta/l``: nobody divides an angle by a length."""
        alone = len(argument) == 1 and isinstance(argument[0], Name) and is_angle(argument[0].text)
        if alone and is_function(below):
            return True
        base = unbraced(below.base) if isinstance(below, Powered) else unbraced(below)
        if not alone or not isinstance(base, Group | Name):
            return False
        return any(not counts(name.text) and name.text != "pi" for name in _names_of(base))

    def goes_on(self, taken: list[Node], item: Piece) -> bool:
        r"""Whether a factor surely continues an argument, as the t of ``\omega t`` does."""
        if any(map(self.moves, taken)) or self.is_angle(taken[-1]) or item.column in self.spaced:
            return False
        base = item.base if isinstance(item, Powered) else item
        if not isinstance(base, Name) or isinstance(self.scope.symbol(base.text), Rate):
            return False
        last = taken[-1]
        run_together = isinstance(last, Name) and last.column + len(last.text) == base.column
        timed = self.scope.symbol(base.text) == self.scope.time
        return run_together or timed or self.is_angle(base) or self.is_number_of_waves(last)

    def is_number_of_waves(self, node: Node) -> bool:
        """Whether a factor is what people multiply an argument by: a number, k, n, ω."""
        names = [name.text for name in names_in(node) if name.text != "pi"]
        return all(stem_of(name) in _WAVES for name in names)

    def _moves(self, name: str) -> bool:
        symbol = self.scope.symbol(name)
        of_motion = isinstance(symbol, Coordinate | Momentum | Rate)
        return of_motion or symbol == self.scope.time or name in self.scope.functions


def _names_of(piece: Group | Name) -> Iterator[Name]:
    """Return the names of a name, or of what stands in printed brackets, which has been read."""
    return names_in(cast("Node", piece.inner) if isinstance(piece, Group) else piece)


def bare_argument(items: tuple[Piece, ...]) -> tuple[Piece, ...]:
    """Return what stands behind the last function of some pieces, nothing where that is in brackets."""
    heads = [at for at, item in enumerate(items) if is_function(item)]
    behind = items[heads[-1] + 1 :] if heads else ()
    for first in behind[:1]:
        if isinstance(first.base if isinstance(first, Powered) else first, Group):
            return ()
    return behind
