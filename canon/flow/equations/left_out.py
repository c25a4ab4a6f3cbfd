"""Constraints that others imply at the start: left out of the equations, looked at along the motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from canon.flow.equations.first_order_motion import MovingSystem
    from canon.flow.run.samples import Samples

__all__ = ["check_left_out"]

_VIOLATED = 1e-6
"""In parts of the size of its terms: a constraint that is missed by more does not follow from the others."""


def check_left_out(moving: MovingSystem, samples: Samples) -> None:
    """Make sure that what was left out, as it followed from the rest at the start, holds along the motion.

    Raises
    ------
    ValueError
        It does not: the constraints depend on one another at the start only.
    """
    nodes = [each.node for each in moving.residuals if each.left_out]
    if not nodes:
        return
    equations = moving.equations
    graph, state = equations.graph, (*equations.q, *equations.p)
    values = dict(zip(equations.inputs, (*samples.y, samples.t[:, np.newaxis]), strict=True))
    for node in nodes:
        slopes = graph.gradient(node, state)
        found, *by = (np.asarray(x, dtype=np.float64) for x in graph.evaluate([node, *slopes], values))
        largest = np.abs(samples.y).max()
        size = sum(
            (np.abs(a) * (np.abs(x) + largest) for a, x in zip(by, samples.y, strict=True)), np.zeros(1)
        )
        missed = np.broadcast_to(np.abs(found) > _VIOLATED * size, samples.y.shape[1:])
        if missed.any():
            first = float(samples.t[int(np.argmax(missed.any(axis=1)))])
            raise ValueError(
                f"a constraint that others imply at the start does not follow from them at t = {first:.6g}: the start "
                "is a singular place of the constraints, where they do not determine the motion. Start beside it"
            )
