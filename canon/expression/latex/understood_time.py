r"""The time that is understood: ``\theta(t)`` and ``\dot\theta(t)^2`` are the coordinate and its rate, symbols here."""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.expression.latex.pieces import Group, Piece, Powered, unbraced
from canon.expression.symbols.symbol import Coordinate, Momentum, Rate
from canon.expression.text.syntax import Name

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["has_rate_or_is_momentum", "is_time", "without_time"]


def without_time(items: tuple[Piece, ...], scope: Scope) -> tuple[Piece, ...]:
    r"""Return factors without the time in ``\theta(t)``, ``\dot\theta(t)^2``, ``\theta^{2}{\left(t \right)}``."""
    found: list[Piece] = []
    for item in items:
        base, exponent = (item.base, item.exponent) if isinstance(item, Powered) else (item, None)
        before = found[-1] if found else None
        name = _what_is_raised(before) if isinstance(before, Powered) and exponent is None else before
        if not (isinstance(name, Name) and is_time(base, scope) and _takes_time(name, scope)):
            found.append(item)
        elif exponent is not None:
            found[-1] = Powered(name, exponent, name.column)
    return tuple(found)


def _what_is_raised(power: Powered) -> Piece:
    r"""Return the base of a power without its braces or brackets, ``\left(\dot x\right)^2``."""
    base = unbraced(power.base)
    return unbraced(base.inner) if isinstance(base, Group) else base


def _takes_time(name: Name, scope: Scope) -> bool:
    return has_rate_or_is_momentum(name, scope) or name.text in scope.timed


def is_time(piece: Piece, scope: Scope) -> bool:
    """Tell whether a piece is the time in printed brackets."""
    group = unbraced(piece)
    inside = unbraced(group.inner) if isinstance(group, Group) else None
    return isinstance(inside, Name) and inside.text == scope.time.name


def has_rate_or_is_momentum(name: Name, scope: Scope) -> bool:
    """Tell whether a name is that of a coordinate, a rate or a momentum."""
    return isinstance(scope.symbol(name.text), Coordinate | Momentum | Rate)
