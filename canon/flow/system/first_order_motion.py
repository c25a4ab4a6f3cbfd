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

from canon.frozen_mapping import FrozenMapping
from canon.kernel.program.hamilton_equations import HamiltonEquations

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Symbol

    from canon.expression.graph.graph import Graph

__all__ = ["FirstOrderMotion", "MovingSystem", "Residual", "moving_system"]


@dataclass(frozen=True, eq=False)
class Residual:
    """A function that constraints make vanish along the motion: its node, its slopes' nodes, and what to call it."""

    node: int
    words: str
    left_out: bool = False


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
    matrix
        The matrix of masses and constraints that impulses go through, nodes; empty where none is known.
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
    matrix: tuple[tuple[int, ...], ...] = ()

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
        return (*self.rates, *known, *self.named.values(), *self.multipliers, *self.reactions, *vanish)


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
    if energy is not None and power != graph.zero:
        W = sp.Dummy("W", real=True)
        work = graph.scaled(work_unit, graph.symbol(W))
        conserved = graph.add((energy, graph.negative(work)))
        first.append(W)
        forward.append(graph.scaled(1 / work_unit, power))
        second.append(sp.Dummy("rest", real=True))
        after.append(graph.zero)
    for each in varying:
        first.append(each)
        forward.append(graph.zero)
        second.append(sp.Dummy(each.name, real=True))
        after.append(graph.zero)
    equations = HamiltonEquations(
        graph=graph,
        q=tuple(first),
        p=tuple(second),
        t=motion.t,
        parameters=dict(numbers),
        hamiltonian=conserved,
        velocity=tuple(forward),
        force=tuple(after),
        separable=False,
        quadratic_kinetic=False,
        autonomous=motion.t not in graph.all_symbols((*forward, *after, conserved)),
        varying=len(first) - half,
        canonical=False,
        spare=spare,
        named={s: found[node] for s, node in motion.named.items()},
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
    )
