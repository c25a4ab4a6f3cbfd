"""Chains of many sites: from 64 coordinates on the state has another layout in memory, and the same motion."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from canon import Hamiltonian, Splitting, coordinates, propagate
from canon.flow import RK4

SITES = (63, 64, 70)
KICKS_FIRST = Splitting(a=[0, 1, 0], b=["1/2", "1/2"])
"""Verlet's steps from kick to kick, of which each uses the last one's force again."""


def chain(sites: int) -> Hamiltonian:
    """Fermi, Pasta, Ulam and Tsingou's chain with fixed ends and α = 1/4."""
    q = coordinates(" ".join(f"q{k}" for k in range(sites)))
    ends = (0, *q, 0)
    bonds = [b - a for a, b in itertools.pairwise(ends)]
    kinetic = sum(each.momentum**2 for each in q) / 2
    return Hamiltonian(kinetic + sum(r**2 / 2 + r**3 / 12 for r in bonds), q, [each.momentum for each in q])


def start(sites: int, orbits: int) -> np.ndarray:
    return np.random.default_rng(sites).uniform(-0.3, 0.3, (2 * sites, orbits))


def force(q: np.ndarray) -> np.ndarray:
    padded = np.concatenate([np.zeros((1, q.shape[1])), q, np.zeros((1, q.shape[1]))])
    bond = np.diff(padded, axis=0)
    pull = bond + bond**2 / 4
    return pull[1:] - pull[:-1]


def stepped(method: Splitting, y: np.ndarray, step: float, steps: int) -> np.ndarray:
    q, p = (half.copy() for half in np.split(y, 2))
    a, b = (np.array([float(x) for x in half]) for half in (method.scheme.a, method.scheme.b))
    for _ in range(steps):
        for drift, kick in zip(a, b, strict=False):
            q += drift * step * p
            p += kick * step * force(q)
        q += a[-1] * step * p
    return np.concatenate([q, p])


@pytest.mark.parametrize("sites", SITES)
@pytest.mark.parametrize("precision", ["double", "compensated"])
def test_a_step_is_the_one_that_is_written_down(sites: int, precision: str) -> None:
    y, H = start(sites, 1), chain(sites)
    for method in (Splitting("verlet"), Splitting("blanes-moan-4"), KICKS_FIRST):
        motion = propagate(H, (0, 1), y[:, 0], method=method, step=0.05, samples=2, precision=precision)
        assert motion.y[:, 1] == pytest.approx(stepped(method, y, 0.05, 10)[:, 0], abs=1e-14)
        assert motion.final == pytest.approx(stepped(method, y, 0.05, 20)[:, 0], abs=1e-14)


def test_many_long_chains_have_the_bits_of_each() -> None:
    y, H = start(70, 5), chain(70)
    for method in (Splitting("blanes-moan-4"), RK4()):
        many = propagate(H, (0, 1), y, method=method, step=0.05, samples=1)
        one = propagate(H, (0, 1), y[:, 3], method=method, step=0.05, samples=1)
        assert (many.y[:, :, 3] == one.y).all()
    assert abs(one.final - stepped(Splitting("kahan-li-8"), y[:, 3:4], 0.05, 20)[:, 0]).max() < 1e-5


def test_a_long_chain_runs_back_to_its_start() -> None:
    y, H = start(70, 1)[:, 0], chain(70)
    there = propagate(H, (0, 5), y, method=Splitting("kahan-li-8"), step=0.1, samples=1)
    back = propagate(H, (5, 0), there.final, method=Splitting("kahan-li-8"), step=0.1, samples=1)
    assert back.final == pytest.approx(y, abs=1e-13)
