"""Jacobian of a time-transformed motion: from the section t = start of the extended phase space to others.

Variations are carried along by the method itself, through the extended equations of c K with c = 1: a step of these is
the step of K and its exact derivative by the state and, through c, by its size. Steps are as many whatever the start,
but their size in the fictitious time depends on it, and so does the part of one that leads to t = T. With Z = ∂Y/∂c of
that last part the variation on the section is δY − Z δt/Z_t.

In the extended phase space the map is symplectic to round-off; on sections of constant time, where the landing has
its part, to the method's error.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from canon.flow.checked_request import hamilton_equations_of
from canon.flow.fixed_step.compiled_loop import compiled_loop, steps_between
from canon.flow.fixed_step.partial_step import LoopState
from canon.flow.method.method import TimeTransformed
from canon.flow.method.number_formats import fixed_precision
from canon.flow.run.non_finite_state import NonFiniteStateError, time_and_state
from canon.flow.run.sampling_plan import fixed_plan
from canon.flow.transformed.extended_hamiltonian import extended
from canon.flow.transformed.transformed_orbit import StepEnd, TransformedOrbit
from canon.kernel.llvm.number_types import DOUBLE, double_pair
from canon.kernel.program.program import exact_value
from canon.kernel.program.variational import of_all_variables, variational

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Symbol

    from canon.array import Array
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.flow.task import Task
    from canon.flow.transformed.extended_hamiltonian import ExtendedSystem
    from canon.flow.transformed.land_at_time import StateAtTime

__all__ = ["transformed_jacobian"]

_C = sp.Dummy("size of steps", real=True)

_LITTLE = Fraction(1, 2**40)


def transformed_jacobian(
    task: Task, hamiltonian: HamiltonianSystem, parameters: Mapping[Symbol | str, Any]
) -> tuple[Array, Array, Array, Array]:
    """Return times, the motion, and its Jacobian as the sum of two arrays, shape (2n, 2n, times).

    Parameters
    ----------
    task
        The motion, of one orbit.
    hamiltonian, parameters
        What it is of.
    """
    frame, method = task.fictitious, task.method
    assert frame is not None
    assert isinstance(method, TimeTransformed)
    larger = extended(hamiltonian, method)
    scaled = replace(larger, H=_C * larger.H)  # pyright: ignore[reportOperatorIssue]
    system = of_all_variables(variational(hamilton_equations_of(scaled, parameters, (_C.name,)), 1))
    plan = task.plan
    instants = (
        np.linspace(plan.instants[0], plan.instants[-1], plan.wanted + 1) if plan.wanted else plan.instants
    )
    columns = [
        _column(task, replace(frame, system=system), method, instants, variation)
        for variation in _variations(task, frame)
    ]
    y, M = columns[0][0], np.stack([column for _, column in columns], axis=1)
    high = M.astype(np.float64)
    return instants, y, high, (M - high).astype(np.float64)


def _start(task: Task) -> list[Fraction]:
    pairs = zip(task.states[0][:, 0].tolist(), task.states[1][:, 0].tolist(), strict=True)
    return [Fraction(high) + Fraction(low) for high, low in pairs]


def _variations(task: Task, frame: ExtendedSystem) -> list[list[Fraction]]:
    """Return for each of (q, p) the variation of (q, t, c, p, p_t, c) at the start that goes with it."""
    physical, graph, state = frame.physical, frame.physical.graph, _start(task)
    x = (*physical.q, *physical.p)
    values = zip(physical.inputs, (*state, task.plan.start), strict=True)
    point = {graph.symbol(symbol): graph.number(value) for symbol, value in values}
    nodes = [frame.rate, *graph.gradient(physical.hamiltonian, x), *graph.gradient(frame.rate, x)]
    rate, *slopes = (exact_value(graph, node) for node in graph.substitute(nodes, point))
    size, none = len(x), Fraction(0)
    found = list[list[Fraction]]()
    for j in range(size):
        unit = [Fraction(i == j) for i in range(size)]
        c = -slopes[size + j] / rate  # steps are of the size step/rate
        half = size // 2
        found.append([*unit[:half], none, c, *unit[half:], -slopes[j], c])
    return found


def _column(
    task: Task, frame: ExtendedSystem, method: TimeTransformed, instants: Array, variation: Sequence[Fraction]
) -> tuple[Array, Any]:
    """Return the motion and the change of (q, p) at every instant that goes with a variation of the start."""
    kind, clock = fixed_precision(task.precision), frame.clock
    loop = compiled_loop(frame.system, method.method, kind)
    assert task.fictitious is not None
    state, h = task.fictitious.start(_start(task), task.plan.start)
    half = len(state) // 2
    layout, one = _Layout(half, clock), Fraction(1)
    first = [*state[:half], one, *variation[: half + 1], *state[half:], one, *variation[half + 1 :]]
    high, low = (np.array(part)[:, np.newaxis] for part in zip(*map(double_pair, first), strict=True))
    steps = steps_between(loop, method.method, fixed_plan(Fraction(0), task.plan.forward * h, (0,)))
    bits = min(kind.number.mantissa, DOUBLE.mantissa)
    orbit = TransformedOrbit(frame, steps, StepEnd(0, LoopState(high, low)), (), bits, lambda _: None)
    y, column = [high[layout.own, 0]], [_sum(LoopState(high, low))[layout.varied]]
    for instant in instants[1:].tolist():
        try:
            orbit.go(Fraction(instant))
        except NonFiniteStateError as lost:
            t, at = float(lost.state[clock]), lost.state[layout.own]
            raise NonFiniteStateError(
                f"the motion or its variations are not finite after {time_and_state(t, at)}: a collision or the edge "
                "of H's domain; stop earlier",
                t,
                at,
            ) from None
        found = orbit.state_at(Fraction(instant))
        delta, along = _sum(found.state), _along(orbit, found, layout)
        y.append(found.state.high[layout.own, 0])
        column.append((delta - along * (delta[layout.time] / along[layout.time]))[layout.varied])
    return np.stack(y, axis=1), np.stack(column, axis=1)


@dataclass(frozen=True)
class _Layout:
    """Where in (q, t, c, δq, δt, δc; p, p_t, c, δp, δp_t, δc) things are; ``half`` is the number of (q, t)."""

    half: int
    clock: int

    @property
    def own(self) -> list[int]:
        """(q, p)."""
        return [i for first in (0, 2 * self.half + 2) for i in range(first, first + self.half - 1)]

    @property
    def varied(self) -> list[int]:
        """(δq, δp)."""
        return [i + self.half + 1 for i in self.own]

    @property
    def time(self) -> int:
        """δt."""
        return self.half + 1 + self.clock

    @property
    def sizes(self) -> list[int]:
        """Both δc."""
        return [2 * self.half + 1, 4 * self.half + 3]


def _along(orbit: TransformedOrbit, found: StateAtTime, layout: _Layout) -> Any:
    """Return the variation of the state at the end of a part of a step by its length, up to a factor."""
    segment, size = found.segment, layout.half + 1
    high, low = segment.state.high.copy(), segment.state.low.copy()
    for first in (size, 3 * size):
        high[first : first + size], low[first : first + size] = 0.0, 0.0
    high[layout.sizes] = 1.0
    # A part of no length has the direction of a very small one.
    end = max(found.part, segment.begin + _LITTLE)
    return _sum(orbit.steps.moved(LoopState(high, low), 0, segment.begin, end))


def _sum(state: LoopState) -> Any:
    return state.high[:, 0].astype(np.longdouble) + state.low[:, 0]
