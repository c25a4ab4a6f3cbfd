"""First-order equations of any mechanical system on one graph, and the same with numbers as the engines take them.

The engines of this room read a state in two halves, as (q, p) is. Of an odd number of variables the second half is
filled up by one that rests. Where the energy is not conserved the work W = ∫ P dt of what changes it is integrated
along as a further variable that no sample shows: E − W is constant, and its change is the error of the energy balance.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING

import sympy as sp

from canon.cached_property import cached_property
from canon.frozen_mapping import FrozenMapping
from canon.kernel.program.hamilton_equations import EquationNodes, HamiltonEquations

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from sympy import Symbol

    from canon.expression.graph.graph import Graph
    from canon.flow.run.event import Event

__all__ = [
    "FirstOrderMotion",
    "MovingSystem",
    "Residual",
    "from_any_start",
    "from_no_other_start",
    "moving_system",
]


def from_no_other_start(_start: Mapping[Symbol, float]) -> bool:
    """Equations that may be others from another start."""
    return False


def from_any_start(_start: Mapping[Symbol, float]) -> bool:
    """Equations that are the same from every start."""
    return True


@dataclass(frozen=True, eq=False)
class Residual:
    """A function that constraints make vanish along the motion: its node, its slopes' nodes, and what to call it."""

    node: int
    words: str
    left_out: bool = False


@dataclass(frozen=True, eq=False)
class Contact:
    """A unilateral constraint f ≥ 0 along a motion.

    Parameters
    ----------
    words
        f in words.
    value, multiplier
        The nodes of f and of λ.
    switch
        The variable, integrated along unseen, that is positive while the contact is closed and 0 while it is open.
    closed
        Whether it is closed at the start.
    opens, lands, parts, crowded
        The events: λ falls to 0; f falls to 0; f has risen for good after the contact opened; f falls to 0 while
        another contact is closed, None where that matters nothing.
    restitution
        Newton's coefficient at the start; None where a motion ends at an impact.
    """

    words: str
    value: int
    multiplier: int
    switch: Symbol
    closed: bool
    opens: Event
    lands: Event
    parts: Event
    crowded: Event | None = None
    restitution: float | None = None

    @property
    def events(self) -> tuple[Event, ...]:
        """All of its events."""
        return (self.opens, self.lands, self.parts, *(() if self.crowded is None else (self.crowded,)))


@dataclass(frozen=True, eq=False)
class Contacts:
    """The unilateral constraints of a motion, and what is integrated along for them.

    Parameters
    ----------
    each
        The contacts, in their order.
    hidden
        Variables that rest between events, and their starts.
    work
        The variable of the work done, which impacts change too.
    losses
        The nodes of what impacts add to the energy, by the symbol of the work after each.
    """

    each: tuple[Contact, ...]
    hidden: Mapping[Symbol, Fraction]
    work: Symbol
    losses: Mapping[Symbol, int]


@dataclass(frozen=True, eq=False)
class FirstOrderMotion:
    """Equations of motion ẏ = Y(y, t) of a system, its parameters symbols still.

    Parameters
    ----------
    kind
        What the system is, in words.
    graph
        The graph that all nodes are on.
    q, second
        Coordinates, and the rest of the state: velocities, quasi-velocities or momenta.
    letter
        ``"v"``, ``"u"`` or ``"p"`` for what ``second`` is; ``"x"`` where the state is one list of variables.
    t
        The time.
    rates
        The nodes of the rates of q and of ``second``.
    energy
        The node of the energy, T + V or Jacobi's function; None where none is known.
    power
        The node of the energy's rate, by the work of forces and what depends on time; 0 where it is conserved.
    named
        Nodes of further symbols: momenta, accelerations, reactions.
    multipliers, reactions
        The nodes of λ, one a constraint, and of the generalized forces of constraint, one a coordinate.
    residuals
        What the constraints make vanish: positions, then rates.
    masses
        What gives the matrix of masses and constraints, if it is asked for.
    contacts
        Unilateral constraints, which open and close.
    holds_from
        Whether the equations are these from a start too, for which others may have been derived; it raises ValueError
        where they do not determine the motion there.
    """

    kind: str
    graph: Graph
    q: tuple[Symbol, ...]
    second: tuple[Symbol, ...]
    letter: str
    t: Symbol
    rates: tuple[int, ...]
    energy: int | None = None
    power: int | None = None
    named: Mapping[Symbol, int] = field(default_factory=lambda: FrozenMapping({}))
    multipliers: tuple[int, ...] = ()
    reactions: tuple[int, ...] = ()
    residuals: tuple[Residual, ...] = ()
    masses: Callable[[], tuple[tuple[int, ...], ...]] = tuple
    contacts: Contacts | None = None
    holds_from: Callable[[Mapping[Symbol, float]], bool] = from_no_other_start

    @cached_property
    def matrix(self) -> tuple[tuple[int, ...], ...]:
        """The matrix of masses and constraints that impulses go through, nodes; empty where none is known."""
        return self.masses()

    @cached_property
    def growth_of_power(self) -> int:
        """The node of the power's rate along the motion, where it does not depend on t itself."""
        graph = self.graph
        slopes = graph.gradient(graph.zero if self.power is None else self.power, self.state)
        return graph.add([graph.mul(pair) for pair in zip(slopes, self.rates, strict=True)])

    @property
    def state(self) -> tuple[Symbol, ...]:
        """The variables, in the order of the state."""
        return (*self.q, *self.second)

    @property
    def parameters(self) -> tuple[Symbol, ...]:
        """All other symbols, by name."""
        used = self.graph.all_symbols(self.nodes) - {*self.state, self.t}
        return tuple(sorted((s for s in used if not isinstance(s, sp.Dummy)), key=lambda s: s.name))

    @property
    def nodes(self) -> tuple[int, ...]:
        """Every node."""
        known = [node for node in (self.energy, self.power) if node is not None]
        vanish = [residual.node for residual in self.residuals]
        along = (*self.named.values(), *self.multipliers, *self.reactions, *vanish)
        if self.contacts is None:
            return (*self.rates, *known, *along)
        return (
            *self.rates,
            *known,
            *along,
            *self.contacts.losses.values(),
            *(c.value for c in self.contacts.each),
        )


@dataclass(frozen=True, eq=False)
class MovingSystem:
    """A system with numbers, as the engines take it, and what is read from its motion.

    Parameters
    ----------
    kind, q, second, letter
        As :class:`FirstOrderMotion` has them.
    equations
        The equations; their ``hamiltonian`` is the energy less the work done, or 0 where no energy is known.
    energy, work
        The nodes of the energy and of W; None where there are none.
    velocities, multipliers, reactions
        The nodes of q̇, of λ, and of the forces of constraint.
    residuals
        What the constraints make vanish.
    contacts
        Unilateral constraints.
    """

    kind: str
    q: tuple[Symbol, ...]
    second: tuple[Symbol, ...]
    letter: str
    equations: HamiltonEquations
    energy: int | None
    work: int | None
    velocities: tuple[int, ...]
    multipliers: tuple[int, ...]
    reactions: tuple[int, ...]
    residuals: tuple[Residual, ...]
    contacts: Contacts | None = None

    @property
    def state(self) -> tuple[Symbol, ...]:
        """The variables, in the order of the state."""
        return (*self.q, *self.second)

    @property
    def first_half(self) -> int:
        """How many variables of the state stand in the first half that the engines see."""
        return len(self.equations.q) - self.equations.varying


def moving_system(
    motion: FirstOrderMotion,
    numbers: Mapping[str, Fraction],
    varying: Sequence[Symbol] = (),
    work_unit: Fraction = Fraction(1),
) -> MovingSystem:
    """Return a system with numbers for its parameters, but for those that differ from orbit to orbit.

    Parameters
    ----------
    motion
        The equations.
    numbers
        An exact number for every parameter, by name.
    varying
        Parameters that differ from orbit to orbit: part of the state, where they stay what they are.
    work_unit
        What the work is measured in while it is integrated along, as errors of a step are relative to the largest
        variable; a power of 2.
    """
    graph, state = motion.graph, motion.state
    known = {graph.symbol(s): graph.number(numbers[s.name]) for s in motion.parameters if s not in varying}
    found = dict(zip(motion.nodes, graph.substitute(motion.nodes, known), strict=True))
    rates = [found[node] for node in motion.rates]
    half, spare = -(-len(state) // 2), len(state) % 2
    first, second = [*state[:half]], [*state[half:], *([sp.Dummy("rest", real=True)] * spare)]
    forward, after = rates[:half], [*rates[half:], *([graph.zero] * spare)]
    energy = None if motion.energy is None else found[motion.energy]
    power = graph.zero if motion.power is None else found[motion.power]
    conserved, work = graph.zero if energy is None else energy, None
    contacts, named = motion.contacts, {s: found[node] for s, node in motion.named.items()}
    if energy is not None and (power != graph.zero or contacts is not None):
        W = sp.Dummy("W", real=True) if contacts is None else contacts.work
        work = graph.scaled(work_unit, graph.symbol(W))
        conserved = graph.add((energy, graph.negative(work)))
        first.append(W)
        forward.append(graph.scaled(1 / work_unit, power))
        second.append(sp.Dummy("rest", real=True))
        after.append(graph.zero)
        for later, loss in ({} if contacts is None else contacts.losses).items():
            named[later] = graph.add((graph.symbol(W), graph.scaled(1 / work_unit, found[loss])))
    for each in (*varying, *(() if contacts is None else contacts.hidden)):
        first.append(each)
        forward.append(graph.zero)
        second.append(sp.Dummy(each.name, real=True))
        after.append(graph.zero)
    equations = HamiltonEquations(
        EquationNodes(graph, conserved, tuple(forward), tuple(after)),
        q=tuple(first),
        p=tuple(second),
        t=motion.t,
        parameters=dict(numbers),
        separable=False,
        quadratic_kinetic=False,
        autonomous=motion.t not in graph.all_symbols((*forward, *after, conserved)),
        varying=len(first) - half,
        canonical=False,
        spare=spare,
        named=named,
    )
    return MovingSystem(
        kind=motion.kind,
        q=motion.q,
        second=motion.second,
        letter=motion.letter,
        equations=equations,
        energy=energy,
        work=work,
        velocities=tuple(rates[: len(motion.q)]),
        multipliers=tuple(found[node] for node in motion.multipliers),
        reactions=tuple(found[node] for node in motion.reactions),
        residuals=tuple(replace(each, node=found[each.node]) for each in motion.residuals),
        contacts=contacts and _in_numbers(contacts, found),
    )


def _in_numbers(contacts: Contacts, found: Mapping[int, int]) -> Contacts:
    each = tuple(replace(c, value=found[c.value], multiplier=found[c.multiplier]) for c in contacts.each)
    return replace(contacts, each=each, losses={s: found[node] for s, node in contacts.losses.items()})
