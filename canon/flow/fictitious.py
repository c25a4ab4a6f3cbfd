"""Motion in a fictitious time: stretches of steps until the time has reached its end, and a landing there."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.given import counted
from canon.flow.compiled import compiled_loop
from canon.flow.fixed import fixed_steps
from canon.flow.measure import measured
from canon.flow.precision import fixed_precision
from canon.flow.request import system_of
from canon.flow.sampling import Plan, fixed_plan
from canon.flow.task import Task
from canon.flow.trajectory import Samples, Trajectory
from canon.flow.transformed import Extended, extended
from canon.kernel.machine import DOUBLE, double_pair
from canon.kernel.program import exact_value
from canon.kernel.structure import Equations, exact

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from sympy import Symbol

    from canon.flow.method import TimeTransformed
    from canon.flow.request import HamiltonianSystem
    from canon.flow.trajectory import Array

__all__ = ["transformed_motion"]

_LANDINGS = 60
"""Trials of a part of a step; bisection alone would need 53."""


def transformed_motion(
    hamiltonian: HamiltonianSystem,
    y0: Any,
    t_span: tuple[Any, Any],
    method: TimeTransformed,
    *,
    step: float | None,
    precision: str | int | None,
    parameters: Mapping[Symbol | str, Any] | None,
    samples: int | None,
    progress: Callable[[float], None] = lambda _: None,
) -> Trajectory:
    """Integrate in the fictitious time until the time reaches its end, and land there with a part of a step.

    Parameters
    ----------
    hamiltonian, y0, t_span, method, precision, parameters
        As :func:`canon.flow.propagate.propagate` takes them.
    step
        The size in t of a step at the start; elsewhere steps are longer or shorter as g is.
    samples
        About how many states to keep, evenly spaced in steps: up to twice as many are kept.
    progress
        Called now and then with the fraction of the time span that is done.

    Raises
    ------
    ValueError
        A step is missing or makes no sense, dt/ds is not positive at the start, or y0 holds several orbits.
    ArithmeticError
        The time stops or turns back, or no part of a step ends where the span does.
    KeyboardInterrupt
        Ctrl-C: nothing of the motion is kept.
    """
    if step is None or not (math.isfinite(step) and step > 0):
        raise ValueError(f"step={step}: {method} takes the size in t of its first step, a positive number")
    if np.ndim(y0) != 1:
        raise ValueError(f"{method} has a time of its own for each orbit: integrate one orbit at a time")
    n = len(hamiltonian.q)
    state = [exact(x, "a component of y0") for x in np.asarray(y0).tolist()]
    if len(state) != 2 * n:
        raise ValueError(
            f"y0 has {counted(len(state), 'component')}; {counted(n, 'coordinate')} "
            f"and {counted(n, 'momentum', 'momenta')} make a state (q, p)"
        )
    start, end = (exact(t, "t_span") for t in t_span)
    if start == end:
        raise ValueError(f"t_span = {t_span} has no length: give a start and another end")
    ours, larger = system_of(hamiltonian, parameters or {}), extended(hamiltonian, method)
    energy, rate = _at_start(ours, larger, state, start)
    if not rate > 0:
        raise ValueError(
            f"dt/ds = {larger.rate} is {float(rate):g} at the start, and {method} needs it positive along the motion: "
            "give another g"
        )
    h = (1 if end > start else -1) * Fraction(step) / rate
    kind = fixed_precision(precision)
    system = system_of(larger, parameters or {})
    loop = compiled_loop(system, method.method, kind)

    def advance(y: Sequence[Fraction], stops: Sequence[int], part: Fraction) -> Samples:
        high, low = (np.array(half)[:, np.newaxis] for half in zip(*map(double_pair, y), strict=True))
        plan = fixed_plan(Fraction(0), h * part, tuple(stops))

        def report(_part: float) -> None:
            progress(way.done)

        return fixed_steps(system, loop, method.method, (high, low), plan, report)

    way = _Way(advance, n, start, end, samples or 1000, min(kind.number.mantissa, DOUBLE.mantissa))
    way.run([*state[:n], start, *state[n:], -energy])
    return way.trajectory(ours, method, float(step), kind.name)


def _at_start(
    system: Equations, larger: Extended, state: Sequence[Fraction], t: Fraction
) -> tuple[Fraction, Fraction]:
    """Return H and dt/ds at the start, to 100 digits."""
    in_time: Any = larger.rate.xreplace({larger.q[-1]: system.t})
    rate = system.node(in_time, "dt/ds")
    graph = system.graph
    point = {graph.symbol(s): graph.number(x) for s, x in zip(system.inputs, (*state, t), strict=True)}
    found = [exact_value(graph, node) for node in graph.substitute([system.hamiltonian, rate], point)]
    return found[0], found[1]


@dataclass
class _Way:
    """States gathered in stretches of steps, thinned out where they grow too many.

    Parameters
    ----------
    advance
        Takes steps, or a part of one, from an exact state, and returns the states after some of them.
    n
        Degrees of freedom; the state is (q, t; p, p_t).
    start, end
        First and last time.
    wanted
        About how many states to keep.
    bits
        Bits of the mantissa that times are known to.
    """

    advance: Callable[[Sequence[Fraction], Sequence[int], Fraction], Samples]
    n: int
    start: Fraction
    end: Fraction
    wanted: int
    bits: int
    done: float = 0.0
    rows: list[tuple[Array, Array]] = field(default_factory=list[Any])
    steps: int = 0
    evaluations: int = 0
    cpu_seconds: float = 0.0
    compile_seconds: float = 0.0

    def run(self, state: Sequence[Fraction]) -> None:
        """Go from the start to the end."""
        stride = 1
        while True:
            piece = self._moved(state, range(0, stride * self.wanted + 1, stride))
            last = self._last_before_the_end(piece)
            self._keep(piece, range(1 if self.rows else 0, last + 1))
            self.steps += last * stride
            state = _exactly(piece, last)
            self.done = float((state[self.n] - self.start) / (self.end - self.start))
            if last < self.wanted:
                self._land(state, stride)
                return
            while len(self.rows) > 2 * self.wanted:
                self.rows, stride = self.rows[::2], 2 * stride

    def _moved(
        self, state: Sequence[Fraction], stops: Sequence[int], part: Fraction = Fraction(1)
    ) -> Samples:
        piece = self.advance(state, stops, part)
        if len(piece.t) < len(stops):
            raise KeyboardInterrupt("a motion in a fictitious time can't be resumed: nothing of it is kept")
        self.cpu_seconds += piece.cpu_seconds
        self.compile_seconds = piece.compile_seconds
        self.evaluations += piece.evaluations
        return piece

    @property
    def forward(self) -> int:
        """1 where time runs forward, −1 where it runs back."""
        return 1 if self.end > self.start else -1

    def _last_before_the_end(self, piece: Samples) -> int:
        times = self.forward * piece.y[self.n, :, 0]
        if not (np.diff(times) > 0).all():
            raise ArithmeticError(
                f"the time stops or turns back after t = {piece.y[self.n, 0, 0]:.9g}: "
                "dt/ds is to be positive along the motion"
            )
        return int(np.flatnonzero(times <= self.forward * float(self.end))[-1])

    def _land(self, state: Sequence[Fraction], stride: int) -> None:
        """Take single steps and then the part of one that ends where the span does."""
        piece = self._moved(state, range(stride + 1))
        last = min(self._last_before_the_end(piece), stride - 1)
        below, above = self._miss(piece, last), self._miss(piece, last + 1)
        tolerance = max(abs(self.end), abs(above - below)) / 2 ** (self.bits - 1)
        if abs(below) <= tolerance:
            self.steps += last
            self._keep(piece, [last] if last else [])  # the first one is kept already
            return
        self.steps += last + 1
        self._keep(self._landed(_exactly(piece, last), below, above, tolerance), [-1])

    def _miss(self, piece: Samples, k: int) -> Fraction:
        """Return how far behind the end a state is."""
        return self.forward * (_exactly(piece, k)[self.n] - self.end)

    def _landed(
        self, state: Sequence[Fraction], below: Fraction, above: Fraction, tolerance: Fraction
    ) -> Samples:
        """Take the part of a step that ends where the span does, between misses of no step and of a whole one."""
        low, high = Fraction(0), Fraction(1)
        for _ in range(_LANDINGS):
            part = Fraction(float(low - below * (high - low) / (above - below)))
            piece = self._moved(state, (0, 1), part)
            miss = self._miss(piece, -1)
            if abs(miss) <= tolerance:
                return piece
            # Where one end stays, halving its value keeps the secant from creeping (the Illinois rule).
            if miss > 0:
                high, above, below = part, miss, below / 2
            else:
                low, below, above = part, miss, above / 2
        raise ArithmeticError(
            f"no part of a step ends at t = {float(self.end):.9g}: dt/ds varies too fast there; take smaller steps"
        )

    def _keep(self, piece: Samples, which: Sequence[int]) -> None:
        self.rows += [(piece.y[:, k, 0], piece.carried[:, k, 0]) for k in which]

    def trajectory(
        self, system: Equations, method: TimeTransformed, step: float, precision: str
    ) -> Trajectory:
        """Return the motion in t."""
        states = [i for i in range(2 * self.n + 2) if i not in (self.n, 2 * self.n + 1)]
        high, low = (np.array([row[part] for row in self.rows]).T for part in (0, 1))
        found = Samples(
            t=high[self.n],
            y=high[states][:, :, np.newaxis],
            carried=low[states][:, :, np.newaxis],
            steps=self.steps,
            evaluations=self.evaluations,
            step=step,
            cpu_seconds=self.cpu_seconds,
            compile_seconds=self.compile_seconds,
        )
        one = replace(found, y=found.y[:, :, 0], carried=found.carried[:, :, 0])
        ((energy, change),) = measured(system, [system.hamiltonian], one, precision)
        task = Task(
            system=system,
            method=method,
            precision=precision,
            states=(found.y[:, 0], found.carried[:, 0]),
            single=True,
            plan=Plan(Fraction(float(found.t[0])), found.t, ends=(len(found.t) - 1,)),
            names=(),
            nodes=(system.hamiltonian,),
            cadence=None,
            events=(),
            dense=False,
        )
        return Trajectory(
            t=found.t,
            y=one.y,
            carried=one.carried,
            energy=energy,
            energy_change=change,
            method=method,
            precision=precision,
            step=step,
            steps=self.steps,
            evaluations=self.evaluations,
            cpu_seconds=self.cpu_seconds,
            compile_seconds=self.compile_seconds,
            autonomous=system.autonomous,
            task=task,
            samples=found,
        )


def _exactly(piece: Samples, k: int) -> list[Fraction]:
    pairs = zip(piece.y[:, k, 0].tolist(), piece.carried[:, k, 0].tolist(), strict=True)
    return [Fraction(high) + Fraction(low) for high, low in pairs]
