"""The domain a claim is about, and points of it.

What a single symbol may be (positive, real, integer …) is said by the symbol's own SymPy assumptions; a
:class:`Domain` adds conditions that tie symbols together and boxes from which points are usefully drawn.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

from sympy import Eq, Integer, Rational, Symbol

from canon.proof.balls import NotDecided, Undefined, Unmodelled, holds_at, precision

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from sympy.logic.boolalg import Boolean

__all__ = ["EVERYWHERE", "Domain"]


@dataclass(frozen=True)
class Domain:
    """Conditions that hold beside the symbols' own assumptions.

    Parameters
    ----------
    conditions
        SymPy relations and ``Ne`` that hold at every point of the domain.
    box
        Ranges from which sample points can usefully be drawn: a hint, not part of the claim.

    Examples
    --------
    >>> from sympy import symbols
    >>> x = symbols("x", real=True)
    >>> Domain(conditions=(x < 1,)).conditions
    (x < 1,)
    """

    conditions: tuple[Boolean, ...] = ()
    box: Mapping[Symbol, tuple[Rational, Rational]] = field(default_factory=lambda: MappingProxyType({}))

    def points(
        self, symbols: Iterable[Symbol], count: int, *, seed: int = 0, special: bool = False
    ) -> Iterator[dict[Symbol, Rational]]:
        """Draw exact points of the domain: short rationals at several scales.

        Parameters
        ----------
        symbols
            What needs a value.
        count
            How many points at most; fewer where the conditions leave little room.
        seed
            Equal seeds draw equal points.
        special
            Put some of the symbols at 0, 1 and −1.

        Examples
        --------
        >>> from sympy import symbols
        >>> x = symbols("x", positive=True)
        >>> all(0 < point[x] < 1 for point in Domain(conditions=(x < 1,)).points([x], 5))
        True
        """
        ordered = sorted(set(symbols), key=lambda s: s.name)
        chance = random.Random(seed)
        found = 0
        for attempt in range(40 * count + 200):
            if found == count:
                return
            scale = _SCALES[(attempt // 3) % len(_SCALES)]
            point = {s: self._draw(s, scale, chance) for s in ordered}
            if special:
                for s in chance.sample(ordered, k=min(len(ordered), 1 + attempt % 2)):
                    point[s] = _nearest_allowed(s, Rational(chance.choice((0, 0, 1, -1))), point[s])
            if self._settle_equalities(point) and self.contains(point):
                found += 1
                yield point

    def contains(self, point: Mapping[Symbol, Rational]) -> bool:
        """Tell whether every condition certainly holds at an exact point."""
        try:
            with precision(128):
                return all(holds_at(condition, point) for condition in self.conditions)
        except (NotDecided, Undefined):
            return False
        except Unmodelled:
            return False

    def _draw(self, symbol: Symbol, scale: Rational, chance: random.Random) -> Rational:
        if symbol in self.box:
            low, high = (Rational(end) for end in self.box[symbol])
            drawn = low + (high - low) * Rational(chance.randint(1, 63), 64)
            return _nearest_allowed(symbol, drawn, drawn)
        if symbol.is_integer:
            magnitude = Integer(chance.randint(1, max(3, int(8 * scale))))
        else:
            magnitude = scale * Rational(chance.randint(1, 23), chance.choice((4, 7, 8)))
        sign = 1 if symbol.is_nonnegative else -1 if symbol.is_nonpositive else chance.choice((1, -1))
        return sign * magnitude

    def _settle_equalities(self, point: dict[Symbol, Rational]) -> bool:
        """Solve each equality for a symbol it holds linearly; say whether rational values were found."""
        for condition in self.conditions:
            if not isinstance(condition, Eq):
                continue
            gap = condition.lhs - condition.rhs
            linear = [s for s in point if (slope := gap.diff(s)) != 0 and s not in slope.free_symbols]
            for s in linear:
                others = {name: number for name, number in point.items() if name != s}
                slope = gap.diff(s).xreplace(others)
                rest = gap.xreplace({s: Integer(0)}).xreplace(others)
                if slope.is_Rational and rest.is_Rational and slope != 0:
                    point[s] = -rest / slope
                    break
            else:
                return False
        return True


EVERYWHERE = Domain()
"""No condition beside the symbols' own assumptions."""

_SCALES = (Rational(1, 2), Rational(1), Rational(1, 8), Rational(4), Rational(1), Rational(30))
"""Sizes that points are drawn at, one after another."""


def _nearest_allowed(symbol: Symbol, wanted: Rational, otherwise: Rational) -> Rational:
    """Return ``wanted`` if the symbol's assumptions allow it."""
    checks = (
        (symbol.is_positive, wanted > 0),
        (symbol.is_negative, wanted < 0),
        (symbol.is_nonnegative, wanted >= 0),
        (symbol.is_nonpositive, wanted <= 0),
        (symbol.is_zero is False, wanted != 0),
        (symbol.is_integer, wanted.is_integer),
    )
    if all(allowed for asked, allowed in checks if asked):
        return wanted
    if symbol.is_integer:
        return Integer(round(float(otherwise)))
    return otherwise
