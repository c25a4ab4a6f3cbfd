"""Tangent maps with many entries, in loops over rows, are those of the same map written out."""

import numpy as np
import pytest

from canon.expression.symbols.symbol import time
from canon.kernel.llvm.number_types import DOUBLE
from canon.kernel.loops import tangent_splitting
from canon.kernel.loops.deviations import Deviations
from canon.kernel.program.hamilton_equations import equations

from .test_rolled import bodies, driven, toda

STEP = 0.01
STAGES = {False: ((0.2, 0.3, 0.4, 0.1), (0.3, 0.4, 0.3)), True: ((0.0, 0.3, 0.7, 0.0), (0.3, 0.4, 0.3))}


def moved(system, vectors, lanes, *, kick_first, compensated):
    """Return the state and δ(vectors, size) after twenty steps, from the first unit vectors."""
    size = 2 * len(system.q)
    deviations = Deviations(DOUBLE, size, size, vectors, lanes)
    loop = tangent_splitting.tangent_splitting_loop(
        system, 3, deviations, compensated=compensated, kick_first=kick_first
    )
    y = np.random.default_rng(5).normal(size=size) / 3
    e = np.zeros(deviations.carry)
    beside = e[deviations.before :].reshape(deviations.groups, size, lanes)
    for k in range(vectors):
        beside[k // lanes, k, k % lanes] = 1.0
    a, b = STAGES[kick_first]
    c = [0.5, STEP, *(STEP * x for pair in zip(a, b, strict=False) for x in pair), STEP * a[-1]]
    numbers = np.array(c)
    loop.code.call(y.ctypes.data, e.ctypes.data, numbers.ctypes.data, 0, 20, 1)
    return y, beside.transpose(0, 2, 1).reshape(-1, size)[:vectors]


@pytest.mark.parametrize("make", [lambda: bodies(3), lambda: driven(9), lambda: toda(8)])
@pytest.mark.parametrize(("vectors", "lanes"), [(1, 1), (3, 1), (8, 4)])
@pytest.mark.parametrize("kick_first", [False, True])
def test_loops_over_rows_move_deviations_as_what_is_written_out(
    make, vectors, lanes, kick_first, monkeypatch
):
    q, H = make()
    system = equations(H, q, tuple(s.momentum for s in q), time, {})
    kick_first = kick_first and system.autonomous
    way = {"kick_first": kick_first, "compensated": lanes > 1}
    y, written_out = moved(system, vectors, lanes, **way)
    monkeypatch.setattr(tangent_splitting, "_WRITTEN_OUT", 0)
    monkeypatch.setattr(tangent_splitting, "_COPIED", 0)
    again, in_loops = moved(system, vectors, lanes, **way)
    np.testing.assert_array_equal(again, y)
    np.testing.assert_allclose(in_loops, written_out, rtol=1e-13, atol=1e-15)
    assert np.abs(in_loops - np.eye(vectors, y.size)).max() > 0.01


def test_a_tangent_map_of_many_rows_is_symplectic(monkeypatch):
    monkeypatch.setattr(tangent_splitting, "_WRITTEN_OUT", 0)
    q, H = toda(5)
    system = equations(H, q, tuple(s.momentum for s in q), time, {})
    n = len(q)
    J = np.block([[np.zeros((n, n)), np.eye(n)], [-np.eye(n), np.zeros((n, n))]])
    _, columns = moved(system, 2 * n, 4, kick_first=False, compensated=True)
    np.testing.assert_allclose(columns @ J @ columns.T, J, atol=1e-13)
