"""Checks of the arguments of a run, and the course made of them."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from sympy import Symbol

from canon.array import all_finite
from canon.expression.symbols.user_input import counted, given_expression
from canon.flow.course import Course
from canon.flow.fixed_step.fixed_steps import planned
from canon.flow.method.energy_keeping_method import AverageVectorField
from canon.flow.method.engine import FIXED_STEPS
from canon.flow.method.method import TimeTransformed
from canon.flow.method.method_text import method_of
from canon.flow.run.sampling_plan import adaptive_plan, sampling
from canon.flow.system.start_of_motion import read_by_labels, state_in_order
from canon.flow.transformed.extended_hamiltonian import extended, extended_system
from canon.frozen_mapping import FrozenMapping
from canon.kernel.llvm.number_types import double_pair
from canon.kernel.program.hamilton_equations import HamiltonEquations, equations, exact_number, exact_numbers
from canon.mechanics.algebra.dynamicsymbols import in_own_time

if TYPE_CHECKING:
    from collections.abc import Callable
    from fractions import Fraction

    import numpy.typing as npt
    from sympy import Expr

    from canon.array import Array
    from canon.flow.method.method import Method
    from canon.flow.request import Request
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.flow.task import Task
    from canon.flow.transformed.extended_hamiltonian import ExtendedSystem

__all__ = [
    "HamiltonianCourse",
    "course_of",
    "course_with",
    "functions_by_name",
    "hamilton_equations_of",
    "parted_by_orbit",
    "refuse_swapped",
    "two_ends",
]

_KEPT = 64
"""Systems kept for the next call."""


@dataclass(frozen=True, eq=False)
class HamiltonianCourse:
    """What a run of a Hamiltonian is to do, and how its starts are read.

    Parameters
    ----------
    course
        What it is to do.
    variables
        Coordinates and momenta, in order.
    varying
        Values of the parameters that differ from orbit to orbit, by name.
    """

    course: Course
    variables: tuple[Symbol, ...]
    varying: Mapping[str, npt.NDArray[Any]]

    def task(self, y0: Any) -> Task:
        """Return the task of a start: numbers in order, one or many, or by name.

        Raises
        ------
        KeyError, ValueError
            As :func:`canon.flow.propagation.propagate` documents them.
        """
        y0 = read_by_labels(y0)
        if isinstance(y0, Mapping):
            y0 = state_in_order(y0, self.variables)
        states, single = _with_parameters(y0, len(self.variables) // 2, self.varying)
        return self.course.task(states, single=single)


def course_of(request: Request) -> HamiltonianCourse:
    """Return the course of a request for the motion of a Hamiltonian; nothing of its start is looked at.

    Raises
    ------
    TypeError, KeyError, ValueError
        As :func:`canon.flow.propagation.propagate` documents them.
    """
    hamiltonian: HamiltonianSystem = request.system
    fixed, varying = parted_by_orbit(request.parameters or {})
    system = hamilton_equations_of(hamiltonian, fixed, tuple(varying))

    def in_fictitious_time(method: TimeTransformed) -> ExtendedSystem:
        larger = extended(hamiltonian, method)
        equations = hamilton_equations_of(larger, fixed, tuple(varying))
        return extended_system(larger, equations, hamiltonian, exact_number(request.step, "step"))

    made = course_with(request, system, two_ends(request.t_span), in_fictitious_time)
    return HamiltonianCourse(made, (*hamiltonian.q, *hamiltonian.p), FrozenMapping(varying))


def course_with(
    request: Request,
    system: HamiltonEquations,
    ends: tuple[Fraction, Fraction],
    in_fictitious_time: Callable[[TimeTransformed], ExtendedSystem] | None = None,
) -> Course:
    """Return the course of equations, with the rest of a request.

    Parameters
    ----------
    request
        Method, precision and what to keep; its system, span and parameters have been looked at already.
    system, ends
        The equations, the first and the last time.
    in_fictitious_time
        What makes the system that a time-transformed method integrates.
    """
    method = _with_tolerance(method_of(request.method), request.tolerance)
    if isinstance(method, AverageVectorField):
        method = method.on(system)
    extra = functions_by_name(request.observables)
    if "energy" in extra:
        raise ValueError(
            "observables: 'energy' is the Hamiltonian, which is always observed; take another name"
        )
    both = (*system.q, *system.p)
    observed = [
        system.observable(in_own_time(f, both, system.t), f"the observable {name!r}")
        for name, f in extra.items()
    ]
    wanted, plan, frame = sampling(ends, request.samples, request.times), None, None
    if method.engine is FIXED_STEPS:
        plan = planned(wanted, request.step, method)
    elif isinstance(method, TimeTransformed):
        _check_transformed(method, request.step, request.cadence)
        assert in_fictitious_time is not None
        frame = in_fictitious_time(method)
    else:
        _check_adaptive(method, request.step, request.cadence, request.precision)
        plan = adaptive_plan(wanted)
    return Course(
        system=system,
        method=method,
        precision=request.precision,
        ends=ends,
        wanted=wanted,
        plan=plan,
        names=tuple(extra),
        observed=tuple(observed),
        cadence=request.cadence,
        events=tuple(request.events),
        dense=request.dense,
        max_step=_longest(request.max_step, method),
        fictitious=frame,
    )


def functions_by_name(observables: Any) -> dict[str, Expr]:
    """Return observables as expressions by name."""
    if observables is not None and not isinstance(observables, Mapping):
        raise TypeError(f'observables={observables!r}: give functions by name, {{"name": function}}')
    return {name: given_expression(f, f"the observable {name!r}") for name, f in (observables or {}).items()}


# what the user said --------------------------------------------------------------------------------


def _with_tolerance(method: Method, tolerance: float | None) -> Method:
    if tolerance is None:
        return method
    if method.engine.takes_step:
        raise ValueError(f"{method} takes fixed steps: give step=, not tolerance=")
    return replace(method, tolerance=tolerance)


def _longest(max_step: float | None, method: Method) -> float | None:
    if max_step is None:
        return None
    if method.engine.takes_step:
        raise ValueError(f"{method} takes steps of the size that is given: step=, not max_step=")
    size = float(exact_number(max_step, "max_step"))
    if not size > 0:
        raise ValueError(f"max_step={max_step}: give a positive number, in the units of time")
    return size


def hamilton_equations_of(
    hamiltonian: HamiltonianSystem,
    parameters: Mapping[Symbol | str, Any],
    varying: tuple[str, ...] = (),
) -> HamiltonEquations:
    """Return a Hamiltonian's equations, kept from an earlier call if there was one.

    Parameters
    ----------
    hamiltonian
        The Hamiltonian.
    parameters
        A number for every parameter, by symbol or name.
    varying
        Names of the parameters that differ from orbit to orbit.

    Raises
    ------
    KeyError
        A parameter of H has no value.
    """
    q, p = tuple(hamiltonian.q), tuple(hamiltonian.p)
    numbers = frozenset(exact_numbers(parameters).items())
    return _kept_system(hamiltonian.H, q, p, hamiltonian.t, numbers, varying)


@functools.lru_cache(maxsize=_KEPT)
def _kept_system(
    H: Expr,
    q: tuple[Symbol, ...],
    p: tuple[Symbol, ...],
    t: Symbol,
    parameters: frozenset[tuple[str, Fraction]],
    varying: tuple[str, ...],
) -> HamiltonEquations:
    held = H.free_symbols if varying else ()
    known = {symbol.name: symbol for symbol in held if isinstance(symbol, Symbol)}
    missing = [name for name in varying if name not in known]
    if missing:
        raise KeyError(f"an array is given for {', '.join(missing)}, which H does not hold")
    return equations(H, q, p, t, dict(parameters), [known[name] for name in varying])


def parted_by_orbit(
    parameters: Mapping[Symbol | str, Any],
) -> tuple[dict[Symbol | str, Any], dict[str, npt.NDArray[Any]]]:
    """Part parameters into those with one value and those with one for each orbit."""
    varying = {str(name): np.asarray(value) for name, value in parameters.items() if np.ndim(value)}
    return {name: value for name, value in parameters.items() if str(name) not in varying}, varying


def _with_parameters(
    y0: Any, n: int, varying: Mapping[str, npt.NDArray[Any]]
) -> tuple[tuple[Array, Array], bool]:
    """Return the starting states with the parameters that vary, and whether it is a single one."""
    high, low = _states(y0, n)
    if not varying:
        return (high, low), np.ndim(y0) == 1
    orbits = {values.size for values in varying.values()} | (
        {high.shape[1]} if np.ndim(y0) == 2 else set[int]()
    )
    shapes = {name: values.shape for name, values in varying.items() if values.ndim != 1 or not values.size}
    if shapes or len(orbits) > 1:
        given = ", ".join(f"{name} of shape {values.shape}" for name, values in varying.items())
        raise ValueError(f"{given} for y0 of shape {np.shape(y0)}: parameters by orbit have shape (orbits,)")
    count = orbits.pop()
    pairs = [
        [double_pair(exact_number(value, f"{name}[{k}]")) for k, value in enumerate(values.tolist())]
        for name, values in varying.items()
    ]
    parameters = np.array(pairs).transpose(2, 0, 1)
    states: list[Array] = []
    for part, own in zip((high, low), parameters, strict=True):
        wide = np.broadcast_to(part, (2 * n, count))
        states.append(np.concatenate([wide[:n], own, wide[n:], own]))
    return (states[0], states[1]), False


def two_ends(t_span: Any) -> tuple[Fraction, Fraction]:
    """Return the first and the last time, exactly."""
    if np.shape(t_span) != (2,):
        raise ValueError(
            f"t_span = {t_span}: give the first and the last time, (t0, t1), and after it the state y0"
        )
    start, end = (exact_number(t, "t_span") for t in t_span)
    return start, end


def refuse_swapped(t_span: Any, y0: Any) -> None:
    """Refuse a state in the place of the span of time, where that can be seen.

    Raises
    ------
    ValueError
        The span is a list and the state a pair.
    """
    if isinstance(t_span, list) and isinstance(y0, tuple) and len(y0) == 2:
        raise ValueError(
            f"t_span = {t_span} and y0 = {y0} look like each other's: the span of time comes before the state, "
            f"propagate(system, {y0}, {t_span}). Where {t_span} is the span, write it as a tuple"
        )


def _states(y0: Any, n: int) -> tuple[Array, Array]:
    """Return the starting states as sums of two doubles, each of shape (2n, orbits)."""
    given = np.asarray(y0)
    if given.ndim not in (1, 2) or given.shape[0] != 2 * n or not given.size:
        raise ValueError(
            f"y0 has shape {given.shape}; {counted(n, 'coordinate')} and "
            f"{counted(n, 'momentum', 'momenta')} make a state (q, p) of shape ({2 * n},), "
            f"several of them ({2 * n}, orbits)"
        )
    if given.dtype == np.float64 and not all_finite(given):
        raise ValueError(f"y0 = {given} is not finite: give a state (q, p) of finite numbers")
    if given.dtype != np.float64:
        pairs = [double_pair(exact_number(x, "a component of y0")) for x in given.ravel().tolist()]
        high, low = (np.array(part).reshape(2 * n, -1) for part in zip(*pairs, strict=True))
        return high, low
    return given.reshape(2 * n, -1), np.zeros((2 * n, given.size // (2 * n)))


def _check_transformed(method: TimeTransformed, step: float | None, cadence: int | None) -> None:
    wrong = step is None or (isinstance(step, float) and not math.isfinite(step))
    if wrong or not exact_number(step, "step") > 0:
        raise ValueError(f"step={step}: {method} takes the size in t of its first step, a positive number")
    if cadence is not None:
        raise ValueError(
            f"cadence={cadence}: {method} has no statistics inside the loop, as its samples are not whole numbers of "
            "steps apart; observables= at many samples= do instead"
        )


def _check_adaptive(
    method: Method, step: float | None, cadence: int | None, precision: str | int | None
) -> None:
    if step is not None:
        raise ValueError(f"{method} chooses its own steps: leave step out and set its tolerance")
    if cadence is not None:
        raise ValueError(f"{method} chooses its own steps: cadence counts those of fixed-step methods")
    engine = method.engine
    if not (precision is None or precision in engine.precisions or engine.takes_digits):
        raise ValueError(
            f"precision={precision!r}: {method} runs in {' or '.join(engine.precisions)} precision"
        )
