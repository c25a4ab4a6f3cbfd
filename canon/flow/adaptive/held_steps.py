"""Steps of the Taylor method held to localised terms: pulses in time and bumps in space are not passed over.

Where the exponent of a term becomes of moderate size a step ends; from there on the series know the term. To find such
times heyoka looks for zeros in every step, which takes up to three times as long, so that it is done only where the
motion has come far from a term.
"""

from __future__ import annotations

import copy
import functools
import itertools
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.kernel.heyoka_bridge import heyoka_functions
from canon.kernel.program.localised_terms import exponents_of, sights

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from canon.array import Array
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["HeldSteps", "LocalisedTerms", "finer", "spacing", "stops_at"]

_LARGEST = 1e300

_LOOKS = 50
"""In so many parts at least a slice is looked through for states that are far from a term."""


@dataclass(frozen=True, eq=False)
class LocalisedTerms:
    """The exponents of the equations' localised terms, and the sizes at which the terms come in sight."""

    system: HamiltonEquations
    exponents: tuple[int, ...]
    levels: tuple[float, ...]
    number: Callable[[Fraction], Any]
    unit: Fraction
    forward: int

    @classmethod
    def of(
        cls,
        system: HamiltonEquations,
        number: Callable[[Fraction], Any],
        tolerance: float | None,
        unit: Fraction,
        forward: int,
    ) -> LocalisedTerms:
        """Return those of Hamilton's equations, for numbers of one kind or a larger tolerance."""
        levels = sights(max(tolerance or 0.0, spacing(number)))
        return cls(system, _exponents(system), levels, number, unit, forward)

    def near(self, largest: Array) -> bool:
        """Return whether all terms are well in sight where their exponents have these sizes."""
        return bool((largest <= self.levels[1]).all())

    def beside(self, events: Mapping[str, Sequence[Any]]) -> dict[str, list[Any]]:
        """Return heyoka's events with those that end a step where a term comes in sight, after all others."""
        functions = heyoka_functions(self.system, self.exponents, self.number, self.unit)
        levels = [self.number(Fraction(level)) for level in self.levels]
        stops = stops_at(functions, levels, self.forward)
        return {
            "nt_events": [*events.get("nt_events", ())],
            "t_events": [*events.get("t_events", ()), *stops],
        }

    def largest(self, states: Sequence[Any], times: Sequence[Any]) -> Array:
        """Return the largest size of each exponent at some states; inf where one has no value."""
        y = np.array(states).astype(np.float64).T[: len(self.system.inputs) - 1] * float(self.unit)
        point = dict(zip(self.system.inputs, (*y, np.array(times).astype(np.float64)), strict=True))
        with np.errstate(all="ignore"):
            found = self.system.graph.evaluate(self.exponents, point)
        return np.array([np.nan_to_num(abs(np.asarray(x)), nan=np.inf).max(initial=0.0) for x in found])

    def hold(self, integrator: Any, largest: Array) -> None:
        """Weigh the stops of an integrator, so that none of them makes the tolerance coarse for the state."""
        sizes = np.where(np.isfinite(largest), np.maximum(largest, self.levels[0]), _LARGEST)
        integrator.pars[:] = [self.number(Fraction(1) / Fraction(x)) for x in sizes.tolist()]


@functools.lru_cache(maxsize=64)
def _exponents(system: HamiltonEquations) -> tuple[int, ...]:
    """Return the exponents of the localised terms of equations, of an earlier motion's where there was one."""
    return exponents_of(system.graph, system.rates)


def stops_at(functions: Sequence[Any], levels: Sequence[Any], forward: int) -> list[Any]:
    """Return heyoka's events that end a step, and no more, where a function's size comes below a level.

    Each is weighed by a parameter of the integrator, the first by the first: one over the function's largest size, as
    heyoka measures the state's errors in parts of whatever is largest, functions of events included.

    Parameters
    ----------
    functions
        Exponents of localised terms as heyoka's expressions.
    levels
        As :func:`canon.kernel.program.localised_terms.sights` has them, in the integrator's numbers.
    forward
        1 where time runs forward, −1 where it runs back.
    """
    import heyoka as hy

    rising, falling = hy.event_direction.positive, hy.event_direction.negative
    if forward < 0:
        rising, falling = falling, rising
    return [
        hy.t_event(
            hy.par[k] * (f + hy.expression(side)), fp_type=type(side), direction=way, callback=_goes_on
        )
        for k, f in enumerate(functions)
        for level in levels
        for side, way in ((level, rising), (-level, falling))
    ]


def _goes_on(_integrator: Any, _sign: int) -> bool:
    return True


def spacing(number: Callable[[Fraction], Any]) -> float:
    """Return the distance of 1 from the next number."""
    one = number(Fraction(1))
    if isinstance(one, float):
        return 2.0**-52
    if type(one) is np.longdouble:
        return float(np.finfo(np.longdouble).eps)
    return 2.0 ** (1 - getattr(one, "prec", 113))


class HeldSteps:
    """An orbit's own integrator whose steps are held to localised terms, compiled when it is first asked for.

    Parameters
    ----------
    terms
        The terms.
    compiled
        Makes the integrator.
    waits
        Whether steps are held only where the motion comes far from a term; otherwise they always are, or there are no
        terms.
    """

    def __init__(self, terms: LocalisedTerms, compiled: Callable[[], Any], *, waits: bool) -> None:
        self.terms, self.waits = terms, waits and bool(terms.exponents)
        self._compiled, self._made = compiled, None

    def integrator(self, largest: Array) -> Any:
        """Return the integrator, ready for another start, for exponents of some sizes."""
        if self._made is None:
            self._made = copy.deepcopy(self._compiled())
        self._made.reset_cooldowns()
        self.terms.hold(self._made, largest)
        return self._made


def finer(grid: Sequence[Any]) -> tuple[list[Any], int]:
    """Return a grid of at least so many parts as are looked through, and how many of them make one of its own."""
    parts = max(1, -(-_LOOKS // (len(grid) - 1)))
    if parts == 1:
        return list(grid), 1
    kind = type(grid[0])
    times = [grid[0]]
    for a, b in itertools.pairwise(grid):
        times += [a + (b - a) * kind(k) / kind(parts) for k in range(1, parts)]
        times.append(b)
    return times, parts
