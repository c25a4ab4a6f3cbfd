"""Saltation: how variations of a motion jump where its rates do.

A neighbour meets the zero of a switching function g a little earlier or later, and moves by the other rates meanwhile:
δ → δ + (f₊ − f₋) (∇g·δ)/ġ₋ (M. A. Aizerman, F. R. Gantmakher, Q. J. Mech. Appl. Math. 11 (1958) 243,
doi:10.1093/qjmam/11.2.243). A ball that falls from both sides of a kink of |x| has no other dispersion.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.kinked.next_regime import settled
from canon.flow.kinked.regime_signs import HELD

if TYPE_CHECKING:
    from canon.array import Array
    from canon.flow.kinked.next_regime import Passage
    from canon.flow.kinked.place import Place
    from canon.flow.kinked.regime_signs import Signs
    from canon.flow.kinked.regimes import Kinks

__all__ = ["jumps_near", "saltation"]

_PROJECTIONS, _NEAR = 50, 1e-9
"""Steps of Newton's method to a zero of a switching function, and in parts of their sizes what counts as one."""


def jumps_near(kinks: Kinks, at: Place) -> list[int]:
    """Return the switching functions of the state at whose zeros the rates jump, looked at beside a place.

    Those of time alone are left out, as all neighbours meet them at once.
    """
    return [k for k in range(len(kinks.functions)) if _jumps(kinks, k, at)]


def _jumps(kinks: Kinks, k: int, at: Place) -> bool:
    there = _on_zero(kinks, k, at)
    if there is None:
        return False
    signs = [1] * len(kinks.functions)
    rates: list[Array] = []
    for side in (1, -1):
        signs[k] = side
        own = kinks.regime(settled(kinks, tuple(signs), {k}, there)).system
        rates.append(np.array(there.values(own, [*own.velocity, *own.force])))
    return bool(abs(rates[0] - rates[1]).max() > _NEAR * np.abs(rates).max())


def _on_zero(kinks: Kinks, k: int, at: Place) -> Place | None:
    """Return the nearest place at which a switching function vanishes; None where the state leads to none."""
    system, node = kinks.system, kinks.functions[k]
    slopes = system.graph.gradient(node, system.inputs[:-1])
    for _ in range(_PROJECTIONS):
        value, *slope = at.values(system, [node, *slopes])
        square = float(np.square(slope).sum())
        if not square:
            return None
        if abs(value) <= _NEAR * (at.size(system, node) or 1.0):
            return at
        moved = at.y - value / square * np.array(slope)
        at = replace(at, y=moved, carried=np.zeros_like(moved))
    return None


def saltation(kinks: Kinks, before: Signs, following: Passage, k: int, at: Place) -> Array:
    """Return by how much a state with variations changes at a kink, shape (2n,).

    Parameters
    ----------
    kinks, before, following, k
        The kinks of the equations, the regime that ends, what follows, and the switching function that vanishes.
    at
        Where that is.

    Raises
    ------
    ValueError
        The motion stays on the kink, is refracted or reflected, or only touches it: its derivative is not known here.
    """
    system, y = kinks.system, at.y + at.carried
    change, count = np.zeros_like(y), system.variations
    if not count:
        return change
    regime, half = kinks.regime(before), len(system.q)
    n = half // (1 + count)
    own = np.array([*range(n), *range(half, half + n)])
    known = HELD not in (*before, *following.signs) and following.y is None
    speed = at.value(regime.system, regime.rate(regime.functions[k])) if known else 0.0
    if not speed:
        where = system.graph.to_sympy(kinks.functions[k])
        raise ValueError(
            f"the motion stays on {where} = 0 at t = {at.t:.9g}, touches it, is refracted or reflected there: the "
            "derivative of such a motion is not known here. Follow neighbours instead, propagate with starts of shape "
            "(2n, orbits)"
        )
    symbols = [system.inputs[row] for row in own]
    slope = np.array(at.values(system, system.graph.gradient(regime.functions[k], symbols)))
    rates = [
        np.array(at.values(each.system, [*each.system.velocity, *each.system.force]))[own]
        for each in (regime, kinks.regime(following.signs))
    ]
    for column in range(1, count + 1):
        rows = own + n * column
        change[rows] = (rates[1] - rates[0]) * (slope @ y[rows]) / speed
    return change
