"""From a Hamiltonian and a starting state to a trajectory."""

from __future__ import annotations

import functools
import math
from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from canon.flow.adaptive import integrate_dop853, integrate_taylor
from canon.flow.method import DOP853, RK4, Method, Splitting, Taylor
from canon.flow.stepping import NonFiniteStateError, run
from canon.flow.trajectory import Array, Samples, Trajectory, measured
from canon.kernel.loop import Loop, runge_kutta_loop, splitting_loop
from canon.kernel.structure import Equations, equations, exact

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    import numpy.typing as npt
    from sympy import Expr, Symbol

__all__ = ["HamiltonianSystem", "NonFiniteStateError", "Trajectory", "propagate"]

_KEPT = 64
"""Systems and compiled loops kept for the next call."""


class HamiltonianSystem(Protocol):
    """What ``propagate`` needs of a Hamiltonian, such as :class:`canon.Hamiltonian`."""

    @property
    def H(self) -> Expr:
        """H(q, p, t)."""
        ...

    @property
    def q(self) -> tuple[Symbol, ...]:
        """The coordinates."""
        ...

    @property
    def p(self) -> tuple[Symbol, ...]:
        """The momenta."""
        ...

    @property
    def t(self) -> Symbol:
        """The time."""
        ...


def propagate(
    hamiltonian: HamiltonianSystem,
    y0: Sequence[float] | npt.NDArray[Any],
    t_span: tuple[float, float],
    *,
    method: Method | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    precision: str | None = None,
    parameters: Mapping[Symbol | str, Any] | None = None,
    samples: int = 1000,
    observables: Mapping[str, Expr] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """Integrate Hamilton's equations from a starting state.

    Parameters
    ----------
    hamiltonian
        The Hamiltonian, in any consistent units.
    y0
        The starting state (q, p), shape (2n,).
    t_span
        The first and the last time; the last may be the earlier one.
    method
        ``Splitting(...)``, ``RK4()``, ``Taylor(...)`` or ``DOP853(...)``; ``Taylor()`` where not given.
    step
        Step size of a fixed-step method. The step taken is the largest one not above it that divides the
        span; ``Trajectory.step`` has it.
    tolerance
        Relative tolerance of an adaptive method, in place of the method's own.
    precision
        ``"compensated"``, the fixed-step methods' default: round-off is carried along, Kahan's way, so that
        little of it accumulates; or ``"double"``.
    parameters
        A number for every parameter of H, by symbol or name.
    samples
        How many sampled states to keep after the first, evenly spaced up to a step.
    observables
        Further functions of (q, p, t) to evaluate at the samples, by name.
    progress
        Called now and then with the fraction done, 0 … 1.

    Returns
    -------
    Trajectory
        Sampled states, energies evaluated in higher precision than the states, and the cost.

    Raises
    ------
    KeyError
        A parameter of H has no value.
    ValueError
        The state's shape is wrong or it is not finite; a step is missing or makes no sense; the Hamiltonian
        is not separable and the method a splitting.
    NonFiniteStateError
        The motion ran into a collision or out of H's domain; the error has the last good time and state.

    Examples
    --------
    >>> from canon import Hamiltonian, Splitting, coordinates, parameters, propagate
    >>> import sympy
    >>> (theta,) = coordinates("theta")
    >>> (g,) = parameters("g", positive=True)
    >>> pendulum = Hamiltonian(theta.momentum**2 / 2 - g * sympy.cos(theta), [theta], [theta.momentum])
    >>> motion = propagate(
    ...     pendulum, [1.0, 0.0], (0, 1000), method=Splitting("kahan-li-8"), step=0.1, parameters={g: 9.81}
    ... )
    >>> motion.steps, bool(abs(motion.energy_error).max() < 1e-8)
    (10000, True)
    """
    method = _with_tolerance(Taylor() if method is None else method, tolerance)
    system = _system(hamiltonian, _numbers(parameters or {}))
    watched = dict(observables or {})
    nodes = [system.hamiltonian, *(system.node(f, f"the observable {name!r}") for name, f in watched.items())]
    state, (start, end) = _state(y0, len(system.q)), _span(t_span)
    if samples < 1:
        raise ValueError(f"samples={samples}: keep at least one state after the first")
    _check_start(system, state, start)
    if isinstance(method, Splitting | RK4):
        loop = _loop(system, method, compensated=_is_compensated(precision))
        found = _fixed_step(loop, method, state, start, end, step, samples, progress)
    else:
        if step is not None:
            raise ValueError(f"{method} chooses its own steps: leave step out and set its tolerance")
        if precision not in (None, "double"):
            raise ValueError(f"precision={precision!r}: {method} runs in double precision")
        times = np.linspace(float(start), float(end), samples + 1)
        if isinstance(method, Taylor):
            found = integrate_taylor(system, state, times, method, progress)
        else:
            found = integrate_dop853(system, state, times, method, progress)
    (energy, change), *rest = measured(system, nodes, found)
    return Trajectory(
        t=found.t,
        y=found.y,
        energy=energy,
        energy_change=change,
        method=method,
        precision="double" if found.carried is None else "compensated",
        step=found.step,
        steps=found.steps,
        evaluations=found.evaluations,
        cpu_seconds=found.cpu_seconds,
        compile_seconds=found.compile_seconds,
        autonomous=system.autonomous,
        observables=MappingProxyType(dict(zip(watched, (value for value, _ in rest), strict=True))),
        changes=MappingProxyType(dict(zip(watched, (each for _, each in rest), strict=True))),
    )


# what the user said --------------------------------------------------------------------------------


def _with_tolerance(method: Method, tolerance: float | None) -> Method:
    if tolerance is None:
        return method
    if isinstance(method, Taylor | DOP853):
        return replace(method, tolerance=tolerance)
    raise ValueError(f"{method} takes fixed steps: give step=, not tolerance=")


def _is_compensated(precision: str | None) -> bool:
    if precision not in (None, "compensated", "double"):
        raise ValueError(f"precision={precision!r}: there are 'compensated' and 'double'")
    return precision != "double"


def _numbers(parameters: Mapping[Symbol | str, Any]) -> frozenset[tuple[str, Fraction]]:
    return frozenset((str(name), exact(value, str(name))) for name, value in parameters.items())


def _system(hamiltonian: HamiltonianSystem, parameters: frozenset[tuple[str, Fraction]]) -> Equations:
    return _kept_system(hamiltonian.H, tuple(hamiltonian.q), tuple(hamiltonian.p), hamiltonian.t, parameters)


@functools.lru_cache(maxsize=_KEPT)
def _kept_system(
    H: Expr,
    q: tuple[Symbol, ...],
    p: tuple[Symbol, ...],
    t: Symbol,
    parameters: frozenset[tuple[str, Fraction]],
) -> Equations:
    return equations(H, q, p, t, dict(parameters))


def _state(y0: Sequence[float] | npt.NDArray[Any], n: int) -> Array:
    state = np.array(y0, dtype=np.float64)
    if state.shape != (2 * n,):
        raise ValueError(
            f"y0 has shape {state.shape}; {n} coordinates and {n} momenta make a state (q, p) of shape "
            f"({2 * n},)"
        )
    if not np.isfinite(state).all():
        raise ValueError(f"y0 = {state} is not finite")
    return state


def _span(t_span: tuple[float, float]) -> tuple[Fraction, Fraction]:
    start, end = (exact(t, "t_span") for t in t_span)
    if start == end:
        raise ValueError(f"t_span = {t_span} has no length")
    return start, end


def _check_start(system: Equations, state: Array, start: Fraction) -> None:
    values = dict(zip(system.inputs, (*state, np.float64(start)), strict=True))
    found = system.graph.evaluate([system.hamiltonian, *system.velocity, *system.force], values)
    if not np.isfinite(np.array(found, dtype=np.float64)).all():
        raise ValueError(f"H or its derivatives are not finite at y0 = {state}: start inside H's domain")


# fixed steps ---------------------------------------------------------------------------------------


def _loop(system: Equations, method: Splitting | RK4, *, compensated: bool) -> Loop:
    if isinstance(method, RK4):
        return _kept_runge_kutta(system, compensated=compensated)
    if not system.separable:
        raise ValueError(
            "H is not a sum T(p, t) + V(q, t), so it does not split into drifts and kicks; use Taylor()"
        )
    if method.scheme.nystrom and not system.quadratic_kinetic:
        raise ValueError(
            f"{method} keeps its order only for kinetic energies quadratic in p with constant coefficients; "
            "use Splitting('blanes-moan-6') or Splitting('kahan-li-8')"
        )
    return _kept_splitting(system, len(method.scheme.b), compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def _kept_splitting(system: Equations, stages: int, *, compensated: bool) -> Loop:
    return splitting_loop(system, stages, compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def _kept_runge_kutta(system: Equations, *, compensated: bool) -> Loop:
    return runge_kutta_loop(system, compensated=compensated)


def _fixed_step(
    loop: Loop,
    method: Splitting | RK4,
    state: Array,
    start: Fraction,
    end: Fraction,
    step: float | None,
    samples: int,
    progress: Callable[[float], None] | None,
) -> Samples:
    steps = _steps(start, end, step, method)
    h = (end - start) / steps
    stops = np.unique(np.linspace(0, steps, min(samples, steps) + 1).round().astype(np.int64))
    coefficients = np.array([float(start), float(h), *(float(h * c) for c in _coefficients(method))])
    done = run(loop, state, coefficients, [int(stop) for stop in stops], progress)
    return Samples(
        t=np.array([float(start + int(stop) * h) for stop in stops]),
        y=done.y,
        carried=done.carried if loop.compensated else None,
        steps=steps,
        evaluations=steps * method.stages,
        step=float(h),
        cpu_seconds=done.cpu_seconds,
        compile_seconds=loop.code.seconds,
    )


def _steps(start: Fraction, end: Fraction, step: float | None, method: Method) -> int:
    if step is None:
        raise ValueError(f"{method} takes fixed steps: give step=, in the units of time")
    if not (math.isfinite(step) and step > 0):
        raise ValueError(f"step={step}: give a positive number; the direction of time follows from t_span")
    ratio = abs(end - start) / Fraction(step)
    nearest = max(1, round(ratio))
    # A span that is a whole number of steps up to the rounding of its ends and of the step counts as one.
    return nearest if abs(ratio - nearest) <= nearest * Fraction(1, 10**9) else math.ceil(ratio)


def _coefficients(method: Splitting | RK4) -> list[Fraction]:
    if isinstance(method, RK4):
        return [Fraction(1, 2), Fraction(1, 6), Fraction(1, 3)]
    a, b = method.scheme.a, method.scheme.b
    return [c for pair in zip(a, b, strict=False) for c in pair] + [a[-1]]
