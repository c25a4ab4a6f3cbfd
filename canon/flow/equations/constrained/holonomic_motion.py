"""Holonomic motion as RATTLE takes it: directions of constraints in the metric of the masses, momenta if needed."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from canon.expression.symbols.user_input import counted
from canon.flow.equations.lagrangian_motion import values_at_start
from canon.flow.equations.linear_equations import SingularAtStartError, solved_from_start
from canon.flow.method.constrained_method import NotForRattleError
from canon.kernel.program.holonomic_system import HolonomicSystem
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from sympy import Symbol

    from canon.flow.equations.first_order_motion import FirstOrderMotion, MovingSystem

__all__ = ["with_constraints_kept"]


def with_constraints_kept(
    given: Any,
    motion: FirstOrderMotion,
    moving: MovingSystem,
    numbers: Mapping[str, Fraction],
    start: Mapping[Symbol, float],
    varying: Sequence[Symbol] = (),
) -> MovingSystem:
    """Return a moving system whose equations say how its constraints are kept by a method itself.

    Parameters
    ----------
    given
        What the user gave: a Lagrangian with holonomic constraints.
    motion, moving
        Its equations, and the same with numbers.
    numbers, varying
        The parameters' numbers by name, and those that differ from orbit to orbit.
    start
        Numbers for q, q̇ and the parameters at the start.

    Raises
    ------
    TypeError
        It is no Lagrangian with constraints.
    NotForRattleError
        It is not one that RATTLE is for.
    """
    if not isinstance(given, ConstrainedLagrangian):
        raise TypeError(
            f"Rattle is for a ConstrainedLagrangian and does not apply to a {motion.kind}; Taylor, DOP853, RK4 and "
            "Gauss do"
        )
    _check(given, moving)
    found = _holonomic(given, motion, start)
    graph = motion.graph
    known = {graph.symbol(s): graph.number(numbers[s.name]) for s in motion.parameters if s not in varying}
    numeric = found.with_nodes(graph.substitute(found.nodes, known))
    return replace(moving, equations=replace(moving.equations, holonomic=numeric))


def _check(given: ConstrainedLagrangian, moving: MovingSystem) -> None:
    others = "Taylor, DOP853, RK4 and Gauss do"
    if given.nonholonomic:
        number = counted(len(given.nonholonomic), "constraint")
        also = "" if given.holonomic else "NonholonomicLeapfrog keeps those; "
        raise NotForRattleError(
            f"Rattle keeps holonomic constraints, not {number} on velocities; {also}{others}"
        )
    if not given.holonomic:
        raise NotForRattleError(
            "Rattle keeps constraints, and there are none: hamiltonian(L) takes Splitting and Gauss"
        )
    if given.lagrangian.forces and any(force != 0 for force in given.lagrangian.forces):
        raise NotForRattleError(f"Rattle is for forces that L holds, and others are given; {others}")
    if moving.work is not None or not moving.equations.autonomous:
        raise NotForRattleError(f"Rattle is for L and constraints that do not hold the time; {others}")


def _holonomic(
    given: ConstrainedLagrangian, motion: FirstOrderMotion, start: Mapping[Symbol, float]
) -> HolonomicSystem:
    graph, q, v, n = motion.graph, motion.q, motion.second, len(motion.q)
    M = [list(row[:n]) for row in motion.matrix[:n]]
    slopes = tuple(tuple(row[:n]) for row in motion.matrix[n:])
    flat = [node for row in M for node in row]
    if graph.all_symbols(flat) & set(v):
        raise NotForRattleError(
            "Rattle is for masses that do not depend on velocities; Taylor, DOP853, RK4 and Gauss do"
        )
    values = values_at_start(graph, flat, start, "the mass matrix").reshape(n, n)

    def solved(right: Sequence[int]) -> tuple[int, ...]:
        return solved_from_start(graph, M, right, values)

    L = graph.from_sympy(given.lagrangian.L)
    momenta, force = graph.gradient(L, v), graph.gradient(L, q)
    at_rest = {graph.symbol(s): graph.zero for s in v}
    drift = graph.substitute(momenta, at_rest)
    vanish = tuple(r.node for r in motion.residuals if r.words == "position" and not r.left_out)
    try:
        shares = tuple(solved(row) for row in slopes)
        if not graph.all_symbols([*flat, *drift]) & {*q, *v} and not graph.all_symbols(force) & set(v):
            speeds = tuple(graph.symbol(s) for s in v)
            return HolonomicSystem(vanish, slopes, shares, shares, speeds, solved(force))
        excess = [graph.add((graph.symbol(s), graph.negative(b))) for s, b in zip(v, drift, strict=True)]
        velocity = solved(excess)
    except SingularAtStartError as singular:
        massless = [s.name for s, x in zip(q, singular.direction, strict=True) if abs(x) > 1e-6]
        raise NotForRattleError(
            f"Rattle divides by the masses, and the mass matrix is singular along {', '.join(massless)}: give every "
            "coordinate a mass, or use Taylor, DOP853, RK4 or Gauss"
        ) from None
    moved = dict(zip(map(graph.symbol, v), velocity, strict=True))
    return HolonomicSystem(
        vanish, slopes, slopes, shares, velocity, tuple(graph.substitute(force, moved)), tuple(momenta)
    )
