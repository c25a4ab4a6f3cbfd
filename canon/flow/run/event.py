"""Events: what happens where a function of the state crosses zero."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import sympy as sp

from canon.expression.symbols.user_input import given_expression
from canon.mechanics.algebra.dynamicsymbols import in_own_time

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr, Symbol

    from canon.array import Array
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["Crossing", "Event", "PreparedEvent", "prepared_events"]

Action = Literal["record", "stop", "bounce"]


@dataclass(frozen=True)
class Event:
    """Event of a motion: what is to happen where a function g of the state and the time crosses zero.

    A crossing is a change of sign through zero, not by a jump or over a pole, as tan θ has. A motion that touches g = 0
    and turns back on the same side crosses nothing, nor does one that starts at g = 0, at rest or not, cross there.
    A step of fixed size that ends just where g has no value, at a pole, ends the motion with an error.

    With :class:`canon.Taylor` the zero is that of the step's own Taylor polynomial. With :class:`canon.DOP853` the
    step's interpolant is cut until g and its rate are in each part as at its ends; where that takes too many parts the
    motion ends with an error. With a method of
    fixed steps an event is noticed where g has another sign after a step than before it, or where g
    approached zero before the step and recedes after it (then the extremum between is looked for, so that two
    crossings in one step are found); it is located to the round-off of time by partial steps of the same
    method from the start of that step. Several events in one step are met in their order; crossings escape
    only where g turns more than once within one step. ``"record"`` and ``"stop"`` leave the motion as it is, bit
    for bit; after a change of the state the rest of the step is one partial step, and the grid of times stays.

    Parameters
    ----------
    function
        g, an expression in the variables of the motion, as :func:`canon.propagate` lists them for each system, the time
        and the parameters: g(q, p, t) of a Hamiltonian, g(q, q̇, t) of a Lagrangian, where momenta ``x.momentum``,
        multipliers and whatever else ``motion[…]`` knows by name may stand too. The variables of a function f(t, y) are
        ``sympy.symbols("y_0 y_1 …", real=True)``.
    direction
        1: only where g rises, −1: only where it falls, in the order in which the motion passes; 0: both.
    action
        ``"record"``: note time and state. ``"stop"``: end the motion there. ``"bounce"``: reflect it
        elastically from the wall g(q, t) = 0, p → p − 2 ġ ∇g/(∇g·M⁻¹∇g), which keeps H where the wall is at
        rest; H is to be quadratic in p, and a Lagrangian quadratic in q̇ at least in what an impact
        at this wall changes. Or new values of some coordinates and momenta: ``{p: -p/2}``.
    name
        What to call it.

    Raises
    ------
    TypeError
        The function or a new value is no expression.
    ValueError
        The direction or the action is none of these.

    Examples
    --------
    >>> from canon import Event, Hamiltonian, Splitting, coordinates, propagate
    >>> x = coordinates("x")
    >>> falling = Hamiltonian(x.momentum**2 / 2 + x, [x], [x.momentum])
    >>> motion = propagate(
    ...     falling, (0, 6), [0.5, 0.0], method=Splitting("verlet"), step=0.01, events=[Event(x, -1, "bounce")]
    ... )
    >>> [round(met.t, 9) for met in motion.events], bool(abs(motion.energy_error).max() < 1e-14)
    ([1.0, 3.0, 5.0], True)
    """

    function: Expr
    direction: int = 0
    action: Action | Mapping[Symbol, Expr] = "record"
    name: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "function", given_expression(self.function, "the function of an event"))
        if self.direction not in (-1, 0, 1):
            raise ValueError(f"direction={self.direction}: 1 where g rises, -1 where it falls, 0 both")
        if not isinstance(self.action, Mapping) and self.action not in ("record", "stop", "bounce"):
            raise ValueError(
                f"action={self.action!r}: 'record', 'stop', 'bounce', or new values {{p: -p}} of the state"
            )
        if isinstance(self.action, Mapping):
            for variable, value in self.action.items():
                given_expression(value, f"the new {variable} of the event {self}")

    def __str__(self) -> str:
        return self.name or f"{self.function} = 0"

    def counts(self, rising: bool) -> bool:
        """Return whether a crossing in that direction is this event."""
        return self.direction == 0 or (self.direction > 0) == rising


@dataclass(frozen=True, eq=False)
class Crossing:
    """Crossing of an event: the time and the state at which g crossed zero.

    Parameters
    ----------
    event
        Which one.
    t
        When.
    y
        The state there, (q, p) of a Hamiltonian, before any change, shape (2n,).
    rising
        Whether g rose through zero in the order in which the motion passes.
    after
        The state after the change, where the event changes it.
    """

    event: Event
    t: float
    y: Array
    rising: bool
    after: Array | None = None

    def __repr__(self) -> str:
        return f"<Crossing: {self.event} {'rising' if self.rising else 'falling'} at t = {self.t:.9g}>"


@dataclass(frozen=True, eq=False)
class PreparedEvent:
    """An event's nodes in a system's graph: g, dg/dt along the motion, and the state after its change.

    ``switches``: the change itself takes g away from zero, so that the motion need not leave it. ``resets``: it changes
    variables that g holds, as θ → θ − 2π at θ = π, and may take it away.
    """

    event: Event
    value: int
    rate: int
    jump: tuple[int, ...] | None
    switches: bool = False
    resets: bool = False


def prepared_events(system: HamiltonEquations, events: Sequence[Event]) -> tuple[PreparedEvent, ...]:
    """Return events on a system's graph.

    Raises
    ------
    KeyError
        A function holds a symbol that is neither coordinate, momentum, time nor a known parameter.
    ValueError
        A function is constant; a wall depends on momenta; H is not quadratic in p, so that there is no
        reflection known; a new value is given for what is no coordinate or momentum.
    """
    return tuple(_prepared(system, event) for event in events)


def _prepared(system: HamiltonEquations, event: Event) -> PreparedEvent:
    graph, state = system.graph, (*system.q, *system.p)
    function = in_own_time(sp.sympify(event.function, strict=True), state, system.t)
    value = system.node(function, f"the event {event}")
    if graph.is_constant(value):
        raise ValueError(f"the event {event} does not depend on the motion")
    slopes = graph.gradient(value, (*state, system.t))
    rates = (*system.velocity, *system.force, graph.one)
    rate = graph.add([graph.mul([a, b]) for a, b in zip(slopes, rates, strict=True)])
    if event.action == "bounce":
        return PreparedEvent(event, value, rate, _reflected(system, event, slopes, value, rate))
    if isinstance(event.action, str):
        return PreparedEvent(event, value, rate, None)
    given: dict[Any, Expr] = dict(event.action)
    changeable = {*(state[row] for row in system.rows), *(s for s in state if isinstance(s, sp.Dummy))}
    strange = [str(s) for s in given if s not in changeable]
    if strange:
        raise ValueError(
            f"the event {event} changes {', '.join(strange)}: it can change coordinates and momenta"
        )
    jump = [
        system.node(
            in_own_time(sp.sympify(given[s], strict=True), state, system.t),
            f"the new {s} of the event {event}",
        )
        if s in given
        else graph.symbol(s)
        for s in state
    ]
    held = graph.symbols(value)
    switched = {s for s in given if isinstance(s, sp.Dummy)}
    return PreparedEvent(
        event,
        value,
        rate,
        tuple(jump),
        switches=not switched.isdisjoint(held),
        resets=not held.isdisjoint(given),
    )


def _reflected(
    system: HamiltonEquations, event: Event, slopes: Sequence[int], value: int, rate: int
) -> tuple[int, ...]:
    # A parameter that differs from orbit to orbit is a coordinate that rests, and its momentum is nobody's.
    graph, n = system.graph, len(system.q) - system.varying
    p = frozenset[Any](system.p[:n])
    if not system.canonical:
        raise ValueError(
            f"the event {event} bounces, which Hamiltonians do: give the new velocities as its action, {{v: -v}}"
        )
    if graph.symbols(value) & p or not frozenset[Any](system.q[:n]) & graph.symbols(value):
        raise ValueError(
            f"the event {event} is no wall g(q, t) = 0 to bounce from: give its action as {{p: …}}"
        )
    inverse_mass = [graph.gradient(velocity, system.p[:n]) for velocity in system.velocity[:n]]
    if any(graph.symbols(entry) & p for row in inverse_mass for entry in row):
        raise ValueError(
            f"H is not quadratic in the momenta, so it is not known how they bounce at {event}: give {{p: …}}"
        )
    normal = slopes[:n]
    pushed = [
        graph.add([graph.mul([entry, slope]) for entry, slope in zip(row, normal, strict=True)])
        for row in inverse_mass
    ]
    across = graph.add([graph.mul([slope, m]) for slope, m in zip(normal, pushed, strict=True)])
    impulse = graph.scaled(-2, graph.mul([rate, graph.power(across, -1)]))
    momenta = [
        graph.add([graph.symbol(s), graph.mul([impulse, slope])])
        for s, slope in zip(system.p[:n], normal, strict=True)
    ]
    return (*(graph.symbol(s) for s in system.q), *momenta, *(graph.symbol(s) for s in system.p[n:]))
