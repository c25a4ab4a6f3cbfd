"""Constraints too many for registers: solved by pivots in memory, as a few of them are without."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from canon import ConstrainedLagrangian, Lagrangian, propagate
from canon.expression.symbols.symbol import coordinates
from canon.flow import NonholonomicLeapfrog, Rattle

X, Y, Z = (coordinates(" ".join(f"{name}{i}" for i in range(7))) for name in "xyz")


def mixed(constraints: list[Any]) -> list[Any]:
    """Return constraints that are fulfilled where these are, none of which stands alone but the last."""
    return [a + 2 * b for a, b in pairwise(constraints)] + constraints[-1:]


def pendulums(count: int) -> ConstrainedLagrangian:
    q = [s for pair in zip(X[:count], Y[:count], strict=True) for s in pair]
    L = Lagrangian(sum(s.dot**2 for s in q) / 2 - sum(Y[:count]), q)
    return ConstrainedLagrangian(
        L, holonomic=mixed([a**2 + b**2 - 1 for a, b in zip(X[:count], Y, strict=False)])
    )


def particles(count: int) -> ConstrainedLagrangian:
    """Rosenberg's particle, ż = y ẋ, in a spring, so many times."""
    q = [s for triple in zip(X[:count], Y, Z, strict=False) for s in triple]
    L = Lagrangian(sum(s.dot**2 for s in q) / 2 - sum(s**2 for s in (*X[:count], *Y[:count])) / 2, q)
    each = [c.dot - b * a.dot for a, b, c in zip(X[:count], Y, Z, strict=False)]
    return ConstrainedLagrangian(L, nonholonomic=mixed(each))


@pytest.mark.parametrize("precision", ["compensated", "double"])
@pytest.mark.parametrize(
    ("system", "count", "method", "place", "speed"),
    [
        (pendulums, 7, Rattle(2), [0.6, -0.8], [0.4, 0.3]),
        (particles, 3, NonholonomicLeapfrog(2), [0.5, 1.0, 0.2], [0.3, 0.1, 0.3]),
    ],
)
def test_many_copies_move_as_one_does(
    precision: str, system: Any, count: int, method: Any, place: list[float], speed: list[float]
) -> None:
    how = {"method": method, "step": 0.1, "samples": 4, "precision": precision}
    one = propagate(system(1), (0, 2), [*place, *speed], **how)
    many = propagate(system(count), (0, 2), [*place * count, *speed * count], **how)
    n = len(place)
    copies = many.y.reshape(2, count, n, -1).swapaxes(0, 1).reshape(count, 2 * n, -1)
    np.testing.assert_allclose(copies, np.broadcast_to(one.y, copies.shape), atol=1e-12)
    assert abs(one.y[:, -1] - one.y[:, 0]).max() > 0.1
