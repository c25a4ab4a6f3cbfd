"""Motion by Routh's equations: the coordinates that remain move, the ignored ones are integrated along.

The state is (q, s, q̇, p): coordinates that remain, ignored ones, velocities of the former, constant momenta of the
latter. d/dt ∂R/∂q̇ − ∂R/∂q = Q for R = L − Σ p ṡ, and ṡ = −∂R/∂p (E. J. Routh 1877).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.expression.symbols.symbol import velocity
from canon.flow.equations.first_order_motion import FirstOrderMotion
from canon.flow.equations.lagrangian_motion import lagrangian_motion

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy import Symbol

    from canon.mechanics.reduction.routh import Routhian

__all__ = ["routhian_motion", "routhian_state"]


def routhian_state(given: Routhian) -> tuple[Symbol, ...]:
    """Return the variables (q, s, q̇, p)."""
    return (*given.q, *given.ignorable, *map(velocity, given.q), *given.momenta)


def routhian_motion(given: Routhian, start: Mapping[Symbol, float]) -> FirstOrderMotion:
    """Return the first-order equations of Routh's procedure, ignored coordinates included.

    Parameters
    ----------
    given
        Routh's function.
    start
        Numbers for the state, t and the parameters.
    """
    own = lagrangian_motion(given.lagrangian, start)
    graph, n, still = own.graph, len(given.q), (own.graph.zero,) * len(given.ignorable)
    ignored = tuple(graph.from_sympy(rate) for rate in given.ignorable_velocities)
    rates = (*own.rates[:n], *ignored, *own.rates[n:], *still)
    named = {**own.named, **dict(zip(map(velocity, given.ignorable), ignored, strict=True))}
    return FirstOrderMotion(
        kind="Routhian",
        graph=graph,
        q=(*given.q, *given.ignorable),
        second=(*own.second, *given.momenta),
        letter="v, p",
        t=given.t,
        rates=rates,
        energy=own.energy,
        power=own.power,
        named=named,
    )
