"""From a Hamiltonian and a starting state to a trajectory."""

from __future__ import annotations

import functools
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from canon.flow.adaptive import integrate_dop853, integrate_taylor
from canon.flow.fixed import compiled_loop, fixed_steps
from canon.flow.method import DOP853, FixedStep, Method, Taylor
from canon.flow.stepping import NonFiniteStateError
from canon.flow.trajectory import Array, Trajectory, measured
from canon.kernel.structure import Equations, equations, exact

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from fractions import Fraction

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
        ``Splitting(...)``, ``Gauss(...)``, ``RK4()``, ``Taylor(...)`` or ``DOP853(...)``; ``Taylor()`` where not given.
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
        The motion ran into a collision or out of H's domain, or the stages of an implicit method did not
        converge; the error has the last good time and state.

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
    if isinstance(method, FixedStep):
        loop = compiled_loop(system, method, compensated=_is_compensated(precision))
        found = fixed_steps(loop, method, state, (start, end), step, samples, progress)
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
