"""Motion and variations of a vector field by heyoka, and how a function changes along the motion."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import sympy as sp

from canon.cached_property import cached_property
from canon.expression.graph.graph import Graph
from canon.expression.symbols.symbol import time
from canon.expression.symbols.user_input import counted, listed
from canon.flow.adaptive.held_steps import HeldSteps, LocalisedTerms
from canon.flow.adaptive.taylor_events import TaylorEvents
from canon.flow.adaptive.taylor_orbit import TaylorOrbit
from canon.flow.geometry.certified_derivatives import Residual, RoundedValue, definite_node, values_at
from canon.flow.run.event import Event, PreparedEvent
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.kernel.heyoka_bridge import heyoka_expressions
from canon.kernel.heyoka_compiled import compiled_integrator
from canon.kernel.program.hamilton_equations import (
    EquationNodes,
    HamiltonEquations,
    exact_number,
    exact_numbers,
)
from canon.kernel.program.series_gaps import may_have_gaps
from canon.mechanics.algebra.dynamicsymbols import in_own_time
from canon.mechanics.hamilton.vector_field import VectorField, check_moves_in_time

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.array import Array
    from canon.flow.run.hamiltonian_system import HamiltonianSystem

__all__ = [
    "COMPACT_FROM",
    "IntegralRate",
    "SampledField",
    "VectorFieldSystem",
    "at_first_zero",
    "carried",
    "integral_rate",
    "sampled",
    "step_error",
    "vector_field_system",
]

COMPACT_FROM = 60
"""Equations with more operations are compiled in heyoka's compact mode."""


_TURN_HIGH, _TURN_LOW = 6.28125, 1.9353071795864769e-03
"""2π in two parts, the first with so few digits that a multiple of it is exact."""


@dataclass(frozen=True, eq=False)
class VectorFieldSystem:
    """Equations of motion ẋ = X(x, t) on a graph, with numbers for their parameters."""

    graph: Graph
    x: tuple[Symbol, ...]
    t: Symbol
    numbers: Mapping[str, Fraction]
    rates: tuple[int, ...]

    def node(self, f: Expr, what: str) -> int:
        """Return the node of a function of x, t and the parameters."""
        general = definite_node(self.graph, f, what)
        others = self.graph.symbols(general) - {*self.x, self.t}
        unknown = sorted(s.name for s in others if s.name not in self.numbers)
        if unknown:
            raise KeyError(
                f"{what} holds {', '.join(unknown)}: give each a number, parameters={{symbol: value}}"
            )
        known = {self.graph.symbol(s): self.graph.number(self.numbers[s.name]) for s in others}
        return self.graph.substitute([general], known)[0]

    @cached_property
    def equations(self) -> HamiltonEquations:
        """The same equations as the engines take them; all variables stand in their first half."""
        return HamiltonEquations(
            EquationNodes(self.graph, self.graph.zero, self.rates, ()),
            q=self.x,
            p=(),
            t=self.t,
            parameters=self.numbers,
            separable=False,
            quadratic_kinetic=False,
            autonomous=self.t not in self.graph.all_symbols(self.rates),
            canonical=False,
            spare=len(self.x),
        )

    def half(self) -> int:
        """Return n of the 2n variables (q, p)."""
        if len(self.x) % 2:
            raise ValueError(
                f"the field has {counted(len(self.x), 'variable')}, "
                "which can't be coordinates and momenta (q, p)"
            )
        return len(self.x) // 2

    def state(self, y: Sequence[Any]) -> Array:
        """Return a state as doubles."""
        given = np.array([float(exact_number(value, "a component of the state")) for value in y])
        if given.shape != (len(self.x),):
            raise ValueError(
                f"{counted(given.size, 'number')} given for the state ({listed(self.x)}): give one each"
            )
        return given

    def heyoka_pairs(self, variations: int = 0) -> list[tuple[Any, Any]]:
        """Return heyoka's equations of x and, after them, of so many variations δx."""
        import heyoka as hy

        graph, dummies = self.graph, [sp.Dummy(s.name) for _ in range(variations) for s in self.x]
        rates = list(self.rates)
        for k in range(variations):
            d = [graph.symbol(s) for s in dummies[k * len(self.x) : (k + 1) * len(self.x)]]
            for rate in self.rates:
                slopes = graph.gradient(rate, self.x)
                rates.append(graph.add([graph.mul([a, b]) for a, b in zip(slopes, d, strict=True)]))
        symbols = (*self.x, *dummies)
        variables = {s: hy.expression(f"q{i}") for i, s in enumerate(symbols)}
        made = heyoka_expressions(graph, rates, {**variables, self.t: hy.time})
        return list(zip(variables.values(), made, strict=True))


def vector_field_system(
    motion: HamiltonianSystem | VectorField, parameters: Mapping[Symbol | str, Any]
) -> VectorFieldSystem:
    """Return Hamilton's equations, or those of a vector field, with numbers for the parameters."""
    graph, numbers = Graph(), exact_numbers(parameters)
    if isinstance(motion, VectorField):
        check_moves_in_time(motion, time)
        empty = VectorFieldSystem(graph, motion.x, time, numbers, ())
        given = [in_own_time(f, motion.x) for f in motion.components]
        rates = tuple(empty.node(f, "the vector field") for f in given)
        return VectorFieldSystem(graph, motion.x, time, numbers, rates)
    x, n = (*motion.q, *motion.p), len(motion.q)
    empty = VectorFieldSystem(graph, x, motion.t, numbers, ())
    slopes = graph.gradient(empty.node(motion.H, "the Hamiltonian"), x)
    rates = (*slopes[n:], *(graph.negative(slope) for slope in slopes[:n]))
    return VectorFieldSystem(graph, x, motion.t, numbers, rates)


def carried(
    field: VectorFieldSystem,
    equations: Any,
    t_span: tuple[float, float],
    y0: Array,
    samples: int,
    variations: int = 0,
) -> tuple[Array, int]:
    """Return the states at evenly spaced times, shape (samples + 1, …), and the steps taken.

    ``equations`` are heyoka's, of the field's variables and of so many ``variations`` of them.

    Raises
    ------
    NonFiniteStateError
        The motion can't be continued over the whole span.
    """
    start, end = (float(exact_number(t, "t_span")) for t in t_span)
    if start == end or samples < 1:
        raise ValueError(f"t_span = {t_span} with samples={samples}: there is no motion to look at")
    found = sampled(field, equations, np.linspace(start, end, samples + 1), y0, variations=variations)
    return found.rows, found.steps


class SampledField(NamedTuple):
    """States of a vector field at times, shape (times, variables), whole turns taken off, and the steps taken."""

    rows: Array
    turns: Array
    steps: int


def sampled(
    field: VectorFieldSystem,
    equations: Any,
    times: Array,
    y0: Array,
    *,
    variations: int = 0,
    angles: Sequence[int] = (),
) -> SampledField:
    """Return the states at times, angles turned back by whole turns as they grow.

    An angle that went on growing would be rounded to ever fewer digits, and heyoka's steps with it, as their error is
    relative to the largest variable.

    Parameters
    ----------
    field, equations, variations
        As :func:`carried` takes them.
    times, y0
        When, and the state at the first of these times.
    angles
        Which variables are angles whose whole turns do not matter.

    Raises
    ------
    NonFiniteStateError
        The motion can't be continued over the whole span.
    """
    large = len(field.graph.reachable(field.rates)) * (1 + variations) > COMPACT_FROM
    orbit = _orbit(field, equations, y0, (float(times[0]), float(times[-1])), compact=large)
    first = np.array(
        orbit.integrator.state
    )  # of heyoka's variational equations too, whose start y0 leaves out
    turning, turns, steps = np.array(angles, dtype=np.intp), np.zeros(len(first)), 0
    rows, whole = [first[np.newaxis]], [turns[np.newaxis].copy()]
    slices = len(times) - 1 if turning.size else 1
    for part in np.array_split(np.arange(1, len(times)), slices):
        made = orbit.advance(times[part[0] - 1 : part[-1] + 1], dense=False)
        if made.outcome is not None:
            raise orbit.lost(made.outcome, field.equations.rows)
        steps += made.steps
        rows.append(made.rows)
        whole.append(np.repeat(turns[np.newaxis], len(part), axis=0))
        if turning.size:
            state = orbit.integrator.state
            back = np.round(state[turning] / (2.0 * np.pi))
            state[turning] = (state[turning] - back * _TURN_HIGH) - back * _TURN_LOW
            turns[turning] += back
            rows[-1][-1], whole[-1][-1] = state, turns
    return SampledField(np.concatenate(rows), np.concatenate(whole), steps)


def at_first_zero(field: VectorFieldSystem, node: int, y0: Array, until: float) -> tuple[float, Array, int]:
    """Return the first time after 0 at which a node vanishes along the motion, the state there, and the steps.

    Raises
    ------
    NonFiniteStateError
        It does not vanish before the last time, or the motion ends before.
    """
    end = PreparedEvent(Event(field.graph.to_sympy(node), action="stop"), node, field.graph.zero, None)
    orbit = _orbit(field, field.heyoka_pairs(), y0, (0.0, until), compact=True, events=[end])
    made = orbit.advance(np.array([0.0, until]), dense=False)
    time, state = float(orbit.integrator.time), np.array(orbit.integrator.state)
    if not made.stopped or not np.isfinite(state).all():
        raise NonFiniteStateError(
            f"it does not vanish before t = {time:.9g} ({made.outcome or 'the last time'}); follow the motion longer",
            time,
            state,
        )
    return time, state, made.steps


def _orbit(
    field: VectorFieldSystem,
    equations: Any,
    y0: Array,
    t_span: tuple[float, float],
    *,
    compact: bool,
    events: Sequence[PreparedEvent] = (),
) -> TaylorOrbit:
    """Return an orbit of heyoka's equations of a field, or of its variations too, at the start of its way."""
    start, end = t_span
    forward = 1 if end > start else -1
    met = TaylorEvents(field.equations, events, "double", float, forward=forward)
    terms = LocalisedTerms.of(field.equations, float, None, Fraction(1), forward)

    def integrator(stops: Mapping[str, Sequence[Any]]) -> Any:
        return compiled_integrator(equations, y0, time=start, compact_mode=compact, **stops)

    own = met.heyoka_events()
    first = integrator(terms.beside(own) if own else own)
    return TaylorOrbit(
        first,
        met,
        integrator({}) if own else None,
        end - start,
        HeldSteps(terms, lambda: integrator(terms.beside({})), waits=not own),
        tested=may_have_gaps(field.graph, field.rates, first.order),
    )


def step_error(states: Array, steps: int) -> Array:
    """Return the error of each component after so many steps that are each right to a rounding, shape (2n,).

    A rounding is that of the component's largest value on the way: heyoka controls a step by the largest of
    all components, but its series converge alike for all.
    """
    return np.finfo(float).eps * math.sqrt(steps + 1) * np.abs(states).max(axis=0)


class IntegralRate(NamedTuple):
    """A claimed integral at one state: its value, the |∂I/∂x|, the size of its terms, and dI/dt."""

    value: Fraction
    slopes: tuple[float, ...]
    scale: Fraction
    rate: Residual


def integral_rate(field: VectorFieldSystem, claimed: int, y: Array, t: float) -> IntegralRate:
    """Return a claimed integral and its rate at a state, taken for the exact numbers it is.

    Raises
    ------
    ValueError
        One of them has no finite real value there.
    """
    graph, variables = field.graph, (*field.x, field.t)
    slopes = graph.gradient(claimed, variables)
    where = dict(zip(variables, map(Fraction, (*y.tolist(), t)), strict=True))
    values = values_at(graph, [claimed, *slopes, *field.rates], where)
    if values is None:
        raise ValueError(
            f"the claimed integral or its rate has no finite real value at t = {t:.9g} of the motion"
        )
    I, by, rates = values[0], values[1 : 1 + len(slopes)], values[1 + len(slopes) :]
    terms = [(a, X) for a, X in zip(by, (*rates, RoundedValue(Fraction(1), Fraction(0))), strict=True)]
    rate = Residual(
        abs(sum((a.number * X.number for a, X in terms), Fraction(0))),
        sum((abs(a.number) * X.error + abs(X.number) * a.error for a, X in terms), Fraction(0)),
        sum((abs(a.number * X.number) for a, X in terms), Fraction(0)),
        "dI/dt",
        where,
    )
    scale = abs(I.number) + sum(
        (abs(a.number * where[s]) for a, s in zip(by, variables, strict=True)), Fraction(0)
    )
    return IntegralRate(I.number, tuple(abs(float(a.number)) for a in by[:-1]), scale, rate)
