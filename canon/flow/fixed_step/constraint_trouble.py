"""Constraint trouble: why multipliers are not found where a motion ends, dependent constraints or too large a step."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from canon.flow.run.non_finite_state import NonFiniteStateError, time_and_state

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.array import Array
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["told_of_constraints"]

_AHEAD = (0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0)
"""Where along the next step constraints are looked at, in steps."""

_DEPENDENT = 1e-2
"""Below this part of what it was a singular value of the constraints' metric says that they become dependent."""


def told_of_constraints(
    system: HamiltonEquations, lost: NonFiniteStateError, h: float
) -> NonFiniteStateError:
    """Return the end of a motion, which says that its constraints become dependent where they do.

    Parameters
    ----------
    system
        The equations, with the constraints that the method keeps.
    lost
        The end, with the last good state.
    h
        The step.
    """
    n = len(system.q) - system.varying
    if not system.keeps_constraints or system.varying:
        return lost
    q, v = lost.state[:n], lost.state[n : 2 * n]
    least = np.array([_metric(system, q + part * h * v, v, lost.time + part * h) for part in _AHEAD])
    if not (least.min() < _DEPENDENT * least[0]):
        return lost
    where = time_and_state(lost.time, lost.state)
    return type(lost)(
        f"the constraints become dependent in the step after {where}: their directions do not determine the "
        "multipliers there; stop before, or leave out the constraint that follows from the others",
        lost.time,
        lost.state,
    )


def _metric(system: HamiltonEquations, q: Array, v: Array, t: float) -> float:
    """Return the least singular value of G M⁻¹ Gᵀ; 0 where it is not finite."""
    point = dict(zip(system.inputs, (*q, *v, t), strict=True))

    def table(rows: Sequence[Sequence[int]]) -> Array:
        nodes = [node for row in rows for node in row]
        return np.array([float(x) for x in system.graph.evaluate(nodes, point)]).reshape(len(rows), -1)

    if system.holonomic is not None:
        metric = table(system.holonomic.slopes) @ table(system.holonomic.shares).T
    else:
        assert system.nonholonomic is not None
        G, M = table(system.nonholonomic.rows), table(system.nonholonomic.masses)
        if not (np.isfinite(M).all() and np.linalg.det(M)):
            return 0.0
        metric = G @ np.linalg.solve(M, G.T)
    return float(np.linalg.svd(metric, compute_uv=False)[-1]) if np.isfinite(metric).all() else 0.0
