"""Request for the motion of any system: start, parameters and method checked, and the task made of them."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

from sympy import sympify

from canon.flow.checked_request import course_of, functions_by_name, refuse_swapped, two_ends
from canon.flow.method.method import TimeTransformed
from canon.flow.run.event import Event
from canon.flow.system.hamiltonian_map import (
    DRIFT_AND_KICK,
    KICK_AND_DRIFT,
    HamiltonianMap,
    check_whole,
    kicked,
)
from canon.flow.system.parameter_values import SpareParameters, check_given, check_known, symbols_in
from canon.flow.system.scene_as_system import is_named, is_scene, opened, scene_of
from canon.flow.system.start_of_motion import read_by_labels
from canon.mechanics.traced.rates_function import is_rates_function

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.flow.checked_request import HamiltonianCourse
    from canon.flow.equations.first_order_motion import MovingSystem
    from canon.flow.request import Request
    from canon.flow.task import Task

__all__ = ["any_task", "course_before_start", "is_hamiltonian", "refuse_contacts", "task_from"]


def is_hamiltonian(system: Any) -> bool:
    """Tell whether a system has H, q, p and t, as :class:`canon.flow.run.hamiltonian_system.HamiltonianSystem` says."""
    return all(hasattr(system, name) for name in ("H", "q", "p", "t"))


def refuse_contacts(moving: MovingSystem | None, what: str) -> None:
    """Refuse systems whose contacts open and close for what knows no events.

    Raises
    ------
    ValueError
        The system has contacts.
    """
    if moving is not None and moving.contacts is not None:
        raise ValueError(
            f"{what} knows no events, by which contacts open and close: take the system in one regime, "
            "UnilateralLagrangian.closed(…)"
        )


def _check_events(events: Any) -> None:
    if isinstance(events, list | tuple) and all(
        isinstance(each, Event) for each in cast("Sequence[Any]", events)
    ):
        return
    raise TypeError(
        f"events={reprlib.repr(events)}: give a list of canon.Event(g), g being an expression that crosses zero; a "
        "function event(t, y) of SciPy is written as such an expression"
    )


def _check_parameters(given: Any) -> None:
    if given is not None and not isinstance(given, Mapping):
        said = reprlib.repr(given)
        raise TypeError(f"parameters={said}: give numbers by name, parameters={{'m': 1.0, 'k': 2.0}}")


def any_task(request: Request) -> tuple[Task, MovingSystem | None]:
    """Return the task of a request, and what its system is where it is no Hamiltonian.

    Raises
    ------
    TypeError, KeyError, ValueError
        As :func:`canon.flow.propagation.propagate` documents them.
    """
    course = course_before_start(request)
    if course is not None:
        return task_from(course, request, request.y0), None
    if is_rates_function(request.system):
        refuse_swapped(request.t_span, request.y0)
        from canon.mechanics.traced.traced_function import read_at_start  # only here: few come with functions

        begin, end = map(float, two_ends(request.t_span))
        request = replace(request, y0=read_by_labels(request.y0))
        request = replace(request, system=read_at_start(request.system, (begin, end), request.y0))
    if is_scene(request.system):
        system, y0, parameters = opened(request.system, request.y0, request.parameters or {})
        request = replace(request, system=system, y0=y0, parameters=SpareParameters(parameters))
    from canon.flow.system_task import system_task  # only here: it loads what derives equations

    return system_task(request)


def task_from(course: HamiltonianCourse, request: Request, y0: Any) -> Task:
    """Return the task of a start on the course of a request; of a scene it may have a name.

    Raises
    ------
    TypeError, KeyError, ValueError
        As :func:`canon.flow.propagation.propagate` documents them.
    """
    refuse_swapped(request.t_span, y0)
    if is_named(y0) and is_scene(request.system):
        y0 = opened(request.system, y0, request.parameters or {}).y0
    return course.task(y0)


def course_before_start(request: Request) -> HamiltonianCourse | None:
    """Return the course of a request where it can be known before the start: of Hamiltonians, their scenes and maps.

    The equations of other systems depend on where they start: None of those.

    Raises
    ------
    TypeError, KeyError, ValueError
        As :func:`canon.flow.propagation.propagate` documents them.
    """
    _check_events(request.events)
    _check_parameters(request.parameters)
    if is_rates_function(request.system):
        return None
    if is_scene(request.system):
        scene = scene_of(request.system)
        if not scene.is_free:
            return None
        system, _, parameters = opened(scene, (), request.parameters or {})
        request = replace(request, system=system, parameters=SpareParameters(parameters))
    if isinstance(request.system, HamiltonianMap):
        return _map_course(request, request.system)
    return _hamiltonian_course(request) if is_hamiltonian(request.system) else None


def _map_course(request: Request, system: HamiltonianMap) -> HamiltonianCourse:
    """Return the course of iterating a map.

    Raises
    ------
    TypeError, KeyError, ValueError
        As :func:`any_task`; or a method, a step or a time between iterations is given.
    """
    for name, given in (("method", request.method), ("step", request.step), ("tolerance", request.tolerance)):
        if given is not None:
            raise ValueError(f"{name}={given}: a map has no {name}, it is iterated; leave {name} out")
    if request.events or request.cadence is not None:
        raise ValueError("a map has no states between its iterations: leave events and cadence out")
    begin, end = two_ends(request.t_span)
    check_whole(begin)
    check_whole(end)
    method = KICK_AND_DRIFT if end > begin else DRIFT_AND_KICK
    made = _hamiltonian_course(replace(request, system=system.hamiltonian, method=method, step=1.0))
    return replace(made, course=replace(made.course, system=kicked(made.course.system)))


def _hamiltonian_course(request: Request) -> HamiltonianCourse:
    """Return the course of a Hamiltonian's motion."""
    variables = (*request.system.q, *request.system.p)
    if request.parameters:
        check_given(
            request.parameters,
            symbols_in(sympify(request.system.H, strict=True)),
            (*variables, request.system.t),
        )
        if not isinstance(request.parameters, SpareParameters):
            check_known(request.parameters, _symbols_of(request) - {*variables, request.system.t})
    return course_of(request)


def _symbols_of(request: Request) -> set[Any]:
    """Return the symbols of a Hamiltonian and of the functions along its motion."""
    functions = list(functions_by_name(request.observables).values())
    for event in request.events:
        if isinstance(event.action, Mapping):
            functions += event.action.values()
        functions.append(event.function)
    # A time transformation may hold parameters of its own, such as a length below which it no longer slows down.
    if isinstance(request.method, TimeTransformed) and request.method.g is not None:
        functions.append(request.method.g)
    others = {symbol for f in functions for symbol in sympify(f, strict=True).free_symbols}
    return others | symbols_in(sympify(request.system.H, strict=True))
