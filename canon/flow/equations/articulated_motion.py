"""Motion of many bodies that hang on each other, their accelerations found along the tree of their velocities."""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.expression.symbols.symbol import acceleration, momentum
from canon.flow.equations.first_order_motion import FirstOrderMotion
from canon.flow.equations.linear_equations import pivots_hold
from canon.mechanics.at_scale.articulated_lagrangian import articulated_lagrangian

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy import Symbol

    from canon.mechanics.at_scale.articulated_lagrangian import ArticulatedLagrangian
    from canon.mechanics.lagrange.lagrangian import Lagrangian

__all__ = ["articulated_motion"]


def articulated_motion(lagrangian: Lagrangian, start: Mapping[Symbol, float]) -> FirstOrderMotion | None:
    """Return the equations in (q, q̇); None where the velocities share little, or M is not definite at the start.

    Raises
    ------
    ValueError
        The accelerations are not determined at the start.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> q = coordinates("q1:8")
    >>> paths = [sum(s.dot for s in q[: k + 1]) for k in range(7)]
    >>> L = Lagrangian(sum(u**2 for u in paths) / 2 - q[0], q)
    >>> motion = articulated_motion(L, dict.fromkeys(q, 0.0))
    >>> [motion.graph.to_sympy(node) for node in motion.rates[7:]]
    [-1, 1, 0, 0, 0, 0, 0]
    """
    chain = articulated_lagrangian(lagrangian)
    if chain is None or not _pivots_hold(chain, start):
        return None
    graph, q, v, t = chain.graph, lagrangian.q, lagrangian.velocities, lagrangian.t
    speeds = [graph.symbol(s) for s in v]
    work = [graph.mul((graph.from_sympy(Q), u)) for Q, u in zip(lagrangian.forces, speeds, strict=False)]
    if chain.depends_on_time:
        work.append(graph.negative(graph.derivative(graph.from_sympy(lagrangian.L), t)))
    named: dict[Symbol, int] = dict(zip(map(acceleration, q), chain.accelerations, strict=True))
    named |= dict(zip(map(momentum, q), chain.momenta, strict=True))
    return FirstOrderMotion(
        kind="Lagrangian",
        graph=graph,
        q=q,
        second=v,
        letter="v",
        t=t,
        rates=(*speeds, *chain.accelerations),
        energy=chain.energy,
        power=graph.add(work),
        named=named,
        masses=chain.mass_matrix,
        holds_from=lambda start: _pivots_hold(chain, start),
    )


def _pivots_hold(chain: ArticulatedLagrangian, start: Mapping[Symbol, float]) -> bool:
    """Tell whether no pivot is small at a start, in the order in which accelerations are eliminated."""
    velocities = chain.lagrangian.velocities
    return pivots_hold(chain.masses_at(start), velocities, chain.tree.order(len(velocities)))
