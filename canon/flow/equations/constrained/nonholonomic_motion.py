"""Nonholonomic motion as the leapfrog takes it: L = K − V in two parts, their slopes, rows of the constraints."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.equations.lagrangian_motion import values_at_start
from canon.flow.method.constrained_method import NotForLeapfrogError
from canon.kernel.program.nonholonomic_system import NonholonomicSystem
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from sympy import Symbol

    from canon.flow.equations.first_order_motion import FirstOrderMotion, MovingSystem

__all__ = ["with_velocity_constraints_kept"]


def with_velocity_constraints_kept(
    given: Any,
    motion: FirstOrderMotion,
    moving: MovingSystem,
    numbers: Mapping[str, Fraction],
    start: Mapping[Symbol, float],
    varying: Sequence[Symbol] = (),
) -> MovingSystem:
    """Return a moving system whose equations say how constraints on its velocities are kept by a method itself.

    Parameters
    ----------
    given
        What the user gave: a Lagrangian with constraints on velocities.
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
    NotForLeapfrogError
        It is not one that the nonholonomic leapfrog is for.
    """
    if not isinstance(given, ConstrainedLagrangian):
        raise TypeError(
            f"NonholonomicLeapfrog is for a ConstrainedLagrangian and does not apply to a {motion.kind}; Taylor, "
            "DOP853, RK4 and Gauss do"
        )
    _check(given)
    found = _nonholonomic(given, motion, start, works=moving.work is not None)
    graph = motion.graph
    known = {graph.symbol(s): graph.number(numbers[s.name]) for s in motion.parameters if s not in varying}
    numeric = found.with_nodes(graph.substitute(found.nodes, known))
    return replace(moving, equations=replace(moving.equations, nonholonomic=numeric))


def _check(given: ConstrainedLagrangian) -> None:
    if given.holonomic and not given.nonholonomic:
        raise NotForLeapfrogError(
            "NonholonomicLeapfrog keeps constraints on velocities, and these are holonomic: Rattle() keeps them"
        )
    if given.holonomic:
        raise NotForLeapfrogError(
            "NonholonomicLeapfrog keeps constraints on velocities only, and there are holonomic ones too: take "
            "coordinates that fulfil those, or Taylor, DOP853, RK4 or Gauss"
        )
    if not given.nonholonomic:
        raise NotForLeapfrogError(
            "NonholonomicLeapfrog keeps constraints on velocities, and there are none: hamiltonian(L) takes Splitting "
            "and Gauss"
        )


def _nonholonomic(
    given: ConstrainedLagrangian, motion: FirstOrderMotion, start: Mapping[Symbol, float], *, works: bool
) -> NonholonomicSystem:
    graph, q, v, n = motion.graph, motion.q, motion.second, len(motion.q)
    L, at_rest = graph.from_sympy(given.lagrangian.L), {graph.symbol(s): graph.zero for s in motion.second}
    momenta, slopes = graph.gradient(L, v), graph.gradient(L, q)
    kick = graph.substitute(slopes, at_rest)
    forces = [graph.from_sympy(force) for force in given.lagrangian.forces] or [graph.zero] * n
    pull = [graph.add((a, graph.negative(b), f)) for a, b, f in zip(slopes, kick, forces, strict=True)]
    masses = [graph.gradient(p, v) for p in momenta]
    flat = [mass for row in masses for mass in row]
    _check_masses(values_at_start(graph, flat, start, "the mass matrix"), q)
    slopes_of_pull = [graph.gradient(f, (*q, *v)) for f in pull]
    constraints = [residual.node for residual in motion.residuals if not residual.left_out]
    moving = {*q, *v, motion.t}
    return NonholonomicSystem(
        kick=tuple(kick),
        momenta=tuple(momenta),
        pull=tuple(pull),
        masses=tuple(masses),
        turning=tuple(
            tuple(
                graph.add((a, graph.negative(b)))
                for a, b in zip(graph.gradient(p, q), of_pull[n:], strict=True)
            )
            for p, of_pull in zip(momenta, slopes_of_pull, strict=True)
        ),
        stiffness=tuple(of_pull[:n] for of_pull in slopes_of_pull),
        rows=tuple(tuple(row[:n]) for row in motion.matrix[n:]),
        rests=tuple(graph.substitute(constraints, at_rest)),
        slopes=tuple(graph.gradient(g, q) for g in constraints),
        steady=not graph.all_symbols(flat) & moving and not graph.all_symbols(momenta) & {*q, motion.t},
        works=works,
    )


def _check_masses(masses: Any, q: Sequence[Symbol]) -> None:
    """Refuse masses that are not positive: equations are eliminated without exchanging rows.

    Raises
    ------
    NotForLeapfrogError
        A direction has no mass, or a negative one.
    """
    matrix = masses.reshape(len(q), len(q))
    units = np.sqrt(np.abs(np.diagonal(matrix)))
    units[units == 0.0] = 1.0
    sizes, directions = np.linalg.eigh(matrix / np.outer(units, units))
    if sizes[0] > 1e-11 * sizes[-1]:
        return
    least = np.abs(directions[:, 0])
    along = ", ".join(s.name for s, x in zip(q, least, strict=True) if x > 1e-6 * least.max())
    raise NotForLeapfrogError(
        f"NonholonomicLeapfrog is for positive masses, and the mass matrix is not positive along {along}: give every "
        "coordinate a mass, or use Taylor, DOP853, RK4 or Gauss"
    )
