"""Branch points: where a root in the equations comes down to zero and its Taylor series goes on as the other root.

u̇ = −√u from u = 1 has the solution (1 − t/2)², which is at rest from t = 2 on. Its series goes on to rise: there √u is
t/2 − 1, and what it has become is −√u. A step of the Taylor method passes over that without an infinity.
"""

from __future__ import annotations

import functools
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.expression.graph.number_systems import FLOAT64
from canon.flow.run.event import Event, prepared_events
from canon.flow.run.non_finite_state import NonFiniteStateError, time_and_state

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.array import Array
    from canon.expression.graph.graph import Graph
    from canon.flow.run.event import PreparedEvent
    from canon.flow.run.samples import Samples
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["branch_points", "check_branch_points", "is_nonnegative", "may_meet_branch_points"]


def may_meet_branch_points(system: HamiltonEquations) -> bool:
    """Tell whether the equations hold a root that may come down to zero."""
    return bool(_open_roots(system))


def branch_points(system: HamiltonEquations, state: Array, t: float) -> tuple[PreparedEvent, ...]:
    """Return events at the zeros of square roots and the like that the equations hold and that are not zero at first.

    Those of what is a sum of squares are left out: they vanish at collisions, where steps become short by themselves.

    Parameters
    ----------
    system
        The equations.
    state, t
        The start of one orbit, shape (2n,).
    """
    roots = _open_roots(system)
    if not roots:
        return ()
    values = dict(zip(system.inputs, (*state, t), strict=True))
    with FLOAT64.quiet():
        found = system.graph.evaluate(roots, values)
    return prepared_events(
        system,
        [Event(system.graph.to_sympy(root)) for root, value in zip(roots, found, strict=True) if value > 0],
    )


def check_branch_points(branches: Sequence[PreparedEvent], samples: Samples) -> Samples:
    """Return samples of a motion that has met none of these zeros.

    Raises
    ------
    NonFiniteStateError
        It has met one: what follows is not the system's motion.
    """
    events = [each.event for each in branches]
    stopped = next((met.t for met in samples.crossings if met.event.action == "stop"), None)
    for met in samples.crossings:
        if met.event in events and met.t != stopped:
            raise NonFiniteStateError(
                f"the motion can't be continued after {time_and_state(met.t, met.y)}: {met.event.function} comes down "
                "to zero there, and its series goes on as the other root; stop earlier, or by an Event",
                met.t,
                met.y,
            )
    return samples


@functools.lru_cache(maxsize=64)
def _open_roots(system: HamiltonEquations) -> tuple[int, ...]:
    """Return the roots of what may have any sign, those that the equations divide by included.

    acos(cos x) has the slope sin x/√(1 − cos² x): its series goes on beyond x = π as if the root had changed its sign.
    """
    graph = system.graph
    found = dict[int, None]()
    for node in graph.reachable(system.rates):
        if _is_open_root(graph, node):
            base, exponent = (graph.nodes[node].operands[0], graph.nodes[graph.nodes[node].operands[1]].value)
            found[node if exponent > 0 else graph.power(base, Fraction(1, exponent.denominator))] = None
    return tuple(found)


def _is_open_root(graph: Graph, node: int) -> bool:
    """Tell whether a node is a root, of even index, of what may have any sign, or one over such a root."""
    kind, operands, _ = graph.nodes[node]
    if kind != "pow":
        return False
    exponent = graph.nodes[operands[1]]
    if exponent.kind != "number" or exponent.value.denominator % 2:
        return False
    return not graph.is_constant(operands[0]) and not is_nonnegative(graph, operands[0])


def is_nonnegative(graph: Graph, node: int) -> bool:
    """Tell whether a sum of even powers, of moduli, exponentials and positive numbers stands there."""
    kind, operands, value = graph.nodes[node]
    match kind:
        case "number":
            return value >= 0
        case "add":
            return all(is_nonnegative(graph, each) for each in operands)
        case "mul":
            return all(is_nonnegative(graph, each) for each in operands)
        case "pow":
            exponent = graph.nodes[operands[1]]
            even = exponent.kind == "number" and exponent.value.denominator == 1 and exponent.value % 2 == 0
            return even or is_nonnegative(graph, operands[0])
        case _:
            return kind in ("exp", "cosh")
