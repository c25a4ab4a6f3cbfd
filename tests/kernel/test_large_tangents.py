"""Deviations of many bodies that all pull at one another: by the powers of a step's own matrix."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from canon import Hamiltonian, Splitting, coordinates
from canon.flow import flow_jacobian

N = 34
Q = coordinates(" ".join(f"q{i}" for i in range(N)))
SPRINGS = np.array([[1.0 / (1 + abs(i - j)) for j in range(N)] for i in range(N)])


@pytest.mark.parametrize(
    "method",
    [Splitting(a=[0, 1], b=["1/2", "1/2"]), Splitting(a=["1/2", "1/2"], b=[1])],
    ids=["kick", "drift"],
)
def test_the_derivative_of_steps_is_the_power_of_their_matrix(method: Any) -> None:
    p = [s.momentum for s in Q]
    couplings = sum(SPRINGS[i, j] * Q[i] * Q[j] for i in range(N) for j in range(N)) / 2
    system = Hamiltonian(sum(s**2 for s in p) / 2 + couplings, list(Q), p)
    one, none = np.eye(N), np.zeros((N, N))

    def drift(h: float) -> Any:
        return np.block([[one, h * one], [none, one]])

    def kick(h: float) -> Any:
        return np.block([[one, none], [-h * SPRINGS, one]])

    kicks_first = len(method.scheme.b) == 2
    first, middle = (kick, drift) if kicks_first else (drift, kick)
    step = first(0.05) @ middle(0.1) @ first(0.05)
    found = flow_jacobian(system, (0, 0.5), np.linspace(-1, 1, 2 * N), method=method, step=0.1, samples=1)
    np.testing.assert_allclose(found.final, np.linalg.matrix_power(step, 5), atol=1e-13)
    assert abs(found.final - np.linalg.matrix_power(step, 4)).max() > 1e-2
