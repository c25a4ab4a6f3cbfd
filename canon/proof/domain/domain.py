"""Domains of claims, and points of them.

What a single symbol may be (positive, real, integer …) is said by the symbol's own SymPy assumptions; a
:class:`Domain` adds conditions that tie symbols together and boxes from which points are usefully drawn.
"""

from __future__ import annotations

import functools
import random
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

from sympy import Eq, Float, Ge, Gt, Integer, Le, Lt, Ne, Rational, Symbol, oo, sympify
from sympy.core.function import AppliedUndef
from sympy.logic.boolalg import Boolean

from canon.cached_property import cached_property
from canon.frozen_mapping import FrozenMapping
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, holds_at, precision
from canon.proof.domain.declarations import allows, declared_complex, said_of
from canon.proof.domain.feasible_points import moved_inside
from canon.proof.domain.rational_points import rational_solution
from canon.proof.domain.relations import isolated, linear, parts_of, unfolded
from canon.proof.trees.anatomy import anatomy
from canon.proof.trees.polynomial import polynomial_factors
from canon.proof.trees.sympy_types import free_symbols, rational

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from sympy import Expr

__all__ = [
    "EVERYWHERE",
    "Domain",
    "as_domain",
    "conditions_hold",
    "has_point",
]


@dataclass(frozen=True)
class Domain:
    """Domain of a claim: the conditions that hold besides its symbols' own assumptions.

    Parameters
    ----------
    conditions
        SymPy relations and ``Ne`` that hold at every point of the domain.
    box
        Ranges from which sample points can usefully be drawn: a hint, not part of the claim.

    Raises
    ------
    TypeError, ValueError
        Where a condition is none of SymPy's, or holds a floating-point number.

    Examples
    --------
    >>> from sympy import symbols
    >>> x = symbols("x", real=True)
    >>> Domain(conditions=(x < 1,)).conditions
    (x < 1,)
    """

    conditions: tuple[Boolean, ...] = ()
    box: Mapping[Symbol, tuple[Rational, Rational]] = field(default_factory=lambda: FrozenMapping({}))

    def __post_init__(self) -> None:
        conditions: Any = self.conditions
        box: Any = self.box
        if isinstance(conditions, str) or not isinstance(conditions, Iterable):
            raise TypeError(f"the conditions should be a tuple, as in Domain((x > 0,)), not {conditions!r}")
        sorted_out = (sympify(c, strict=True) if isinstance(c, bool) else c for c in conditions)
        object.__setattr__(self, "conditions", tuple(sorted_out))
        for condition in cast("tuple[Any, ...]", self.conditions):
            if not isinstance(condition, Boolean):
                raise TypeError(
                    f"a condition should be one of SymPy's, such as x > 0 or Ne(x, 0), not {condition!r}"
                )
        rounded = anatomy(self.conditions).of(Float)
        if rounded:
            raise ValueError(
                f"{min(rounded, key=str)} in the conditions is a rounded number, from which nothing exact follows; "
                "write it as a fraction, such as Rational('0.1') or Rational(1, 10)"
            )
        bounds = (isolated(bound) for condition in self.conditions for bound in unfolded(condition))
        object.__setattr__(self, "conditions", tuple(bounds))
        for name, ends in box.items():
            if not isinstance(name, Symbol):
                raise TypeError(
                    f"the box names symbols, not {name!r}; write {{x: (low, high)}} with the symbol x"
                )
            if not isinstance(ends, Sequence) or len(ends) != 2:
                raise TypeError(f"the box should give {name} a pair (low, high), not {ends!r}")

    def __repr__(self) -> str:
        said = [str(condition) for condition in self.conditions]
        said += [f"{name} in {low} … {high}" for name, (low, high) in self.box.items()]
        return f"<Domain: {', '.join(said) or 'everywhere'}>"

    def points(
        self,
        symbols: Iterable[Symbol],
        count: int,
        *,
        seed: int = 0,
        in_box: bool = True,
        marks: Mapping[Symbol, Sequence[Rational]] = FrozenMapping({}),
        deadline: float = float("inf"),
        but_functions: bool = False,
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
        in_box
            Keep to the box, which is a hint and no part of the claim.
        marks
            Values at which one or two symbols at a time are put.
        deadline
            Value of :func:`time.monotonic` after which no more points are drawn.
        but_functions
            Leave :attr:`on_functions` to the caller, who chooses the functions.

        Examples
        --------
        >>> from sympy import symbols
        >>> x = symbols("x", positive=True)
        >>> all(0 < point[x] < 1 for point in Domain(conditions=(x < 1,)).points([x], 5))
        True
        """
        conditioned = {s for condition in self.conditions for s in free_symbols(condition)}
        ordered = sorted({*symbols, *conditioned}, key=lambda s: s.name)
        facts = {s: said_of(s) for s in ordered}
        chance, steering = random.Random(seed), random.Random(seed)
        settled = self._but_functions if but_functions else self.conditions
        found = moved = moves = unsolved = 0
        for attempt in range(40 * count + 200):
            if found + moved == count or time.monotonic() > deadline:
                return
            point = self._drawn(ordered, attempt, chance, marks, in_box=in_box)
            solved = self._settle_equalities(point, steering)
            unsolved += not solved
            if unsolved > MOST_UNSOLVED and found + moved == 0:
                return
            if solved and _belongs(point, facts, settled):
                found += 1
                yield point
            elif found == 0 and attempt >= PATIENCE and moves < MOST_MOVES:
                moves += 1
                inside = moved_inside(point, settled, steering, deadline)
                if not inside or not _belongs(inside, facts, settled):
                    continue
                moved += 1
                yield inside

    def interval(self, symbol: Symbol) -> tuple[Expr, Expr, bool]:
        """Return the bounds of one symbol, and whether both are certainly excluded.

        Examples
        --------
        >>> from sympy import pi, symbols
        >>> theta = symbols("theta", positive=True)
        >>> Domain(conditions=(theta < pi,)).interval(theta)
        (0, pi, True)
        """
        low: Expr = Integer(0) if symbol.is_nonnegative else -oo
        high: Expr = Integer(0) if symbol.is_nonpositive else oo
        open_low = bool(symbol.is_positive) or low is -oo
        open_high = bool(symbol.is_negative) or high is oo
        for condition in parts_of(self.conditions):
            if not isinstance(condition, Lt | Le | Gt | Ge):
                continue
            less, greater = cast("Expr", condition.lts), cast("Expr", condition.gts)
            strict = isinstance(condition, Lt | Gt)
            if less == symbol and greater.is_number and (greater < high or (greater == high and strict)):
                high, open_high = greater, strict
            elif greater == symbol and less.is_number and (less > low or (less == low and strict)):
                low, open_low = less, strict
        return low, high, open_low and open_high

    def is_connected(self, symbols: Iterable[Symbol]) -> bool:
        """Tell whether the domain, points excluded by ≠ added, is certainly connected.

        An intersection of half spaces is convex. A symbol that is declared nonzero, of neither sign, takes its values
        on two half-lines, which are not connected.
        """
        if any(s.is_integer or declared_complex(s) or _parts(s) for s in symbols):
            return False
        bounds = (c for c in parts_of(self.conditions) if not isinstance(c, Ne))
        return all(isinstance(c, Lt | Le | Gt | Ge) and linear(c) for c in bounds)

    def contains(self, point: Mapping[Symbol, Rational]) -> bool:
        """Tell whether every condition certainly holds at an exact point."""
        return conditions_hold(self.conditions, point)

    def admits(self, point: Mapping[Symbol, Rational]) -> bool:
        """Tell whether a point certainly belongs to the domain, what was declared of its symbols included.

        Conditions on arbitrary functions are left to the caller, who chooses the functions.
        """
        return _belongs(point, {s: said_of(s) for s in point}, self._but_functions)

    @cached_property
    def on_functions(self) -> tuple[Boolean, ...]:
        """The conditions on arbitrary functions, which hold or not as the functions are chosen."""
        return tuple(c for c in self.conditions if c.has(AppliedUndef))

    @property
    def _but_functions(self) -> Sequence[Boolean]:
        return [c for c in self.conditions if c not in self.on_functions]

    def _drawn(
        self,
        symbols: Sequence[Symbol],
        attempt: int,
        chance: random.Random,
        marks: Mapping[Symbol, Sequence[Rational]],
        *,
        in_box: bool,
    ) -> dict[Symbol, Rational]:
        scale = rational(_SCALES[(attempt // 3) % len(_SCALES)])
        point = {s: self._draw(s, scale, chance, in_box=in_box) for s in symbols}
        marked = [s for s in symbols if marks.get(s)]
        for s in chance.sample(marked, k=min(len(marked), 1 + attempt % 2)):
            point[s] = chance.choice(marks[s])
        return point

    def _draw(self, symbol: Symbol, scale: Rational, chance: random.Random, *, in_box: bool) -> Rational:
        if in_box and symbol in self.box:
            low, high = (Rational(end) for end in self.box[symbol])
            drawn = low + (high - low) * Rational(chance.randint(1, 63), 64)
            return Integer(round(drawn)) if symbol.is_integer else rational(drawn)
        if symbol.is_integer:
            magnitude = Integer(chance.randint(1, max(3, int(8 * scale))))
        else:
            magnitude = scale * Rational(chance.randint(1, 23), chance.choice((4, 7, 8)))
        sign = 1 if symbol.is_nonnegative else -1 if symbol.is_nonpositive else chance.choice((1, -1))
        return rational(sign * magnitude)

    def _settle_equalities(self, point: dict[Symbol, Rational], chance: random.Random) -> bool:
        """Move a point to where the equalities hold; say whether rational numbers were found."""
        gaps = [chance.choice(factors) for factors in self._gaps]
        found = rational_solution(gaps, point, chance) if gaps else point
        point.update(found or {})
        return found is not None

    @cached_property
    def _gaps(self) -> tuple[tuple[Expr, ...], ...]:
        """The factors of what vanishes on the domain, equality by equality."""
        equal = (c for c in self.conditions if isinstance(c, Eq))
        gaps = (cast("Expr", c.lhs) - cast("Expr", c.rhs) for c in equal)
        return tuple(tuple(f for f, _ in polynomial_factors(gap)) or (gap,) for gap in gaps)


EVERYWHERE = Domain()
"""No condition beside the symbols' own assumptions."""


def has_point(domain: Domain) -> bool:
    """Tell whether a point of a domain is found; that of the last domains is kept, as each repair of an answer asks.

    Examples
    --------
    >>> from sympy import symbols
    >>> x = symbols("x", real=True)
    >>> has_point(Domain((x > 1,))), has_point(Domain((x > 1, x < 0)))
    (True, False)
    """
    return _has_point(domain.conditions, tuple(domain.box.items()))


@functools.lru_cache(maxsize=256)
def _has_point(
    conditions: tuple[Boolean, ...], box: tuple[tuple[Symbol, tuple[Rational, Rational]], ...]
) -> bool:
    domain = Domain(conditions, FrozenMapping(dict(box)))
    return next(domain.points((), 1), None) is not None


def as_domain(given: Any, otherwise: Domain = EVERYWHERE) -> Domain:
    """Return a domain that may not have been given.

    Raises
    ------
    TypeError
        Where something else was given.

    Examples
    --------
    >>> from sympy import symbols
    >>> x = symbols("x", real=True)
    >>> as_domain(x > 0)
    Traceback (most recent call last):
        ...
    TypeError: a domain is needed, not x > 0; write Domain((x > 0,))
    """
    if given is None:
        return otherwise
    if not isinstance(given, Domain):
        remedy = f"; write Domain(({given},))" if isinstance(given, Boolean) else ""
        raise TypeError(f"a domain is needed, not {given}{remedy}")
    return given


_SCALES = tuple(Rational(p, q) for p, q in ((1, 2), (1, 1), (1, 8), (4, 1), (1, 1), (1, 500), (30, 1)))
"""Sizes that points are drawn at, one after another."""


PATIENCE = 40
"""Attempts without a point after which points are moved to where the conditions hold."""

MOST_MOVES = 40

MOST_UNSOLVED = 12
"""Attempts without rational numbers that satisfy the equalities after which none are looked for."""


def _parts(s: Symbol) -> bool:
    return bool(s.is_nonzero and not s.is_positive and not s.is_negative)


def conditions_hold(conditions: Iterable[Boolean], point: Mapping[Symbol, Rational]) -> bool:
    """Tell whether conditions certainly hold at an exact point."""
    try:
        with precision(128):
            return all(holds_at(condition, point) for condition in conditions)
    except (NotDecided, Undefined, Unmodelled):
        return False


def _belongs(
    point: Mapping[Symbol, Rational],
    facts: Mapping[Symbol, Mapping[str, bool]],
    conditions: Sequence[Boolean],
) -> bool:
    """Whether what was declared of each symbol, and every condition, holds at a point."""
    allowed = all(allows(facts[s], number) for s, number in point.items())
    return allowed and conditions_hold(conditions, point)
