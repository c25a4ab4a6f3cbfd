"""Task of a system without a Hamiltonian: its equations derived for where it starts, and for the method."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.flow.checked_request import (
    course_with,
    functions_by_name,
    parted_by_orbit,
    refuse_swapped,
    two_ends,
)
from canon.flow.equations.bounce import with_bounces
from canon.flow.equations.first_order_motion import moving_system
from canon.flow.equations.lagrangian_motion import SPAN
from canon.flow.method.engine import needs_hamiltonian
from canon.flow.method.method_text import method_of
from canon.flow.system.equations_for_method import Derivation, for_method
from canon.flow.system.kept_equations import kept_equations
from canon.flow.system.parameter_values import SpareParameters, check_parameters
from canon.flow.system.recognised_system import recognised
from canon.flow.system.start_of_motion import check_constraints, state_in_order
from canon.kernel.llvm.number_types import double_pair
from canon.kernel.program.hamilton_equations import exact_number, exact_numbers
from canon.mechanics.algebra.dynamicsymbols import plain

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy.typing as npt

    from canon.array import Array
    from canon.flow.equations.first_order_motion import Contacts, FirstOrderMotion, MovingSystem
    from canon.flow.method.method import Method
    from canon.flow.request import Request
    from canon.flow.run.event import Event
    from canon.flow.system.recognised_system import RecognisedSystem
    from canon.flow.task import Task

__all__ = ["system_task"]


def system_task(request: Request) -> tuple[Task, MovingSystem]:
    """Return the task of a system without a Hamiltonian."""
    y0: Any = request.y0
    refuse_swapped(request.t_span, y0)
    ends = two_ends(request.t_span)
    found, given = recognised(request.system), dict(request.parameters or {})
    variables = (*found.state, found.t)
    observed = {name: _plain(f, variables) for name, f in functions_by_name(request.observables).items()}
    met = tuple(_plain_event(event, variables) for event in request.events)
    functions = [*observed.values(), *(event.function for event in met)]
    others = _unneeded_but_given(found, functions, given)
    by_name = {s.name: s for s in (*found.parameters, *others)}
    if isinstance(request.parameters, SpareParameters):
        given = {key: value for key, value in given.items() if str(key) in by_name}
    check_parameters(given, found.parameters, variables, others=others - {*variables})
    fixed, varying = parted_by_orbit(given)
    states = _exact(state_in_order(y0, found.state))
    orbits = _orbits(states, varying, np.shape(y0))
    single = states[0].ndim == 1 and not varying
    start: dict[Symbol, Any] = {found.t: float(ends[0]), SPAN: float(ends[1] - ends[0]) or 1.0}
    start |= {by_name[str(key)]: float(exact_number(value, str(key))) for key, value in fixed.items()}
    start |= {by_name[name]: values.astype(np.float64) for name, values in varying.items()}
    start |= dict(zip(found.state, states[0].reshape(len(found.state), -1), strict=True))
    first = {s: float(np.ravel(value)[0]) for s, value in start.items()}
    numbers, orbits_of = exact_numbers(fixed), [by_name[name] for name in varying]
    chosen = method_of(request.method)
    derived = kept_equations(found.system, numbers, orbits_of, chosen.family).from_start(found, first)
    motion, met = with_bounces(derived.motion, met, first)
    hidden = _contacts_at_start(motion, orbits)
    check_constraints(motion, start | hidden)
    if motion.contacts is not None:
        _check_direction(motion.contacts, ends)
        met = (*met, *(event for contact in motion.contacts.each for event in contact.events))
    unit = _work_unit(motion, first | hidden)
    moving = derived.moving.get(unit) if motion is derived.motion else None
    if moving is None:
        moving = moving_system(motion, numbers, orbits_of, unit)
        _check_method(chosen, moving)
        moving = for_method(
            moving, Derivation(request.system, found, motion, numbers, first, orbits_of), chosen
        )
        if motion is derived.motion:
            derived.moving[unit] = moving
    full = _full_states(moving, states, varying, orbits)
    checked = replace(request, method=chosen, observables=observed, events=met)
    return course_with(checked, moving.equations, ends).task(full, single=single), moving


def _check_direction(contacts: Contacts, ends: tuple[Fraction, Fraction]) -> None:
    """Refuse a motion backwards in time through impacts that lose energy: before one of e = 0 it may have been any.

    Raises
    ------
    ValueError
        Where the span ends before it begins, and a restitution is below 1.
    """
    lossy = next((c for c in contacts.each if c.restitution is not None and c.restitution < 1), None)
    if lossy is not None and ends[1] < ends[0]:
        raise ValueError(
            f"impacts at {lossy.words} lose energy (restitution {lossy.restitution:g}), and a motion through them is "
            "not determined backwards in time: give a span that grows, or restitution=1"
        )


def _unneeded_but_given(
    system: RecognisedSystem, functions: Sequence[Expr], given: Mapping[Any, Any]
) -> set[Symbol]:
    """Return the parameters that are given and stand in functions along the motion, or in no equation at all."""
    named = {str(key) for key in given}
    in_functions = {s for f in functions for s in f.free_symbols if str(s) in named and isinstance(s, Symbol)}
    return in_functions | {s for s in system.unneeded if s.name in named}


def _plain(f: Any, variables: Sequence[Symbol]) -> Expr:
    return plain(f, variables[:-1], variables[-1])


def _plain_event(event: Event, variables: Sequence[Symbol]) -> Event:
    """Return an event in canon's symbols; itself where it is."""
    function: Any = event.function
    if not (isinstance(function, Expr) and function.has(AppliedUndef)):
        return event
    return replace(event, function=_plain(event.function, variables))


def _exact(y0: Any) -> tuple[Array, Array]:
    """Return a state as the sum of two doubles."""
    given = np.asarray(y0)
    if given.dtype == np.float64:
        if not np.isfinite(given).all():
            raise ValueError(f"y0 = {given} is not finite: give a state of finite numbers")
        return given, np.zeros(given.shape)
    pairs = [double_pair(exact_number(x, "a component of y0")) for x in given.ravel().tolist()]
    high, low = (np.array(part).reshape(given.shape) for part in zip(*pairs, strict=True))
    return high, low


def _orbits(
    states: tuple[Array, Array], varying: Mapping[str, npt.NDArray[Any]], shape: tuple[int, ...]
) -> int:
    counts = {values.size for values in varying.values()}
    if states[0].ndim == 2:
        counts.add(states[0].shape[1])
    if len(counts) > 1:
        given = ", ".join(f"{name} of shape {values.shape}" for name, values in varying.items())
        raise ValueError(f"{given} for y0 of shape {shape}: parameters by orbit have shape (orbits,)")
    return counts.pop() if counts else 1


def _full_states(
    moving: MovingSystem,
    states: tuple[Array, Array],
    varying: Mapping[str, npt.NDArray[Any]],
    orbits: int,
) -> tuple[Array, Array]:
    """Return the states with what is integrated along unseen, each of shape (2n, orbits)."""
    numbers = [
        [double_pair(exact_number(value, name)) for value in values.tolist()]
        for name, values in varying.items()
    ]
    if moving.contacts is not None:
        numbers += [[double_pair(value)] for value in moving.contacts.hidden.values()]
    half, work = moving.first_half, 0 if moving.work is None else 1
    spare = moving.equations.spare
    made: list[Array] = []
    for part, which in zip(states, (0, 1), strict=True):
        visible = np.broadcast_to(part.reshape(len(moving.state), -1), (len(moving.state), orbits))
        own = np.array([[pair[which] for pair in row] for row in numbers]).reshape(len(numbers), orbits)
        still = np.zeros((work, orbits))
        rest = np.zeros((spare, orbits))
        made.append(np.concatenate([visible[:half], still, own, visible[half:], rest, still, own]))
    return made[0], made[1]


def _contacts_at_start(motion: FirstOrderMotion, orbits: int) -> dict[Symbol, Any]:
    """Return numbers for what is integrated along for contacts."""
    if motion.contacts is None:
        return {}
    if orbits > 1:
        raise ValueError(
            "contacts open and close at times of each orbit's own: propagate the orbits one by one"
        )
    return {s: float(value) for s, value in motion.contacts.hidden.items()}


def _work_unit(motion: FirstOrderMotion, start: Mapping[Symbol, float]) -> Fraction:
    """Return the power of 2 next to the size of the energy, or of what is done in the span; 1 where no work is done."""
    graph = motion.graph
    if motion.energy is None or motion.power is None:
        return Fraction(1)
    if motion.power == graph.zero and motion.contacts is None:
        return Fraction(1)
    kind, operands, _ = graph.nodes[motion.energy]
    terms = operands if kind == "add" else (motion.energy,)
    found = graph.evaluate([*terms, motion.power, motion.growth_of_power], start)
    *parts, power, rising = (abs(float(x)) for x in found)
    size = sum(parts) or power * abs(start[SPAN]) or rising * start[SPAN] ** 2
    return Fraction(2) ** math.frexp(size)[1] if 0 < size < math.inf else Fraction(1)


def _check_method(method: Method, moving: MovingSystem) -> None:
    if needs_hamiltonian(method.family):
        raise ValueError(
            f"{method} is made for a Hamiltonian and does not apply to a {moving.kind}; "
            "Taylor, DOP853, RK4 and Gauss do"
        )
