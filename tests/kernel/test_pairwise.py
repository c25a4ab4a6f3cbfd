"""Forces of pairs: what is found, what is not, and that the loops compute the written-out force."""

from __future__ import annotations

import itertools
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from canon.expression.symbols.symbol import coordinates
from canon.expression.symbols.symbol import time as t
from canon.flow.fixed_step.compiled_loop import compiled_loop
from canon.flow.fixed_step.kept_loops import kept_splitting
from canon.flow.method.method import Splitting
from canon.flow.method.number_formats import FIXED
from canon.flow.propagation import propagate
from canon.kernel.loops import splitting
from canon.kernel.program.hamilton_equations import HamiltonEquations, equations
from canon.kernel.program.pairwise import pair_forces
from canon.kernel.program.repeated.pair_function import PairForces
from canon.mechanics.hamilton.hamiltonian import Hamiltonian

BODIES = 13
SOFTENING = sp.Rational(1, 4)


def system_of(potential: sp.Expr, q: tuple[sp.Symbol, ...]) -> HamiltonEquations:
    H = sp.Add(*(s.momentum**2 / 2 for s in q)) + potential
    return equations(H, q, tuple(s.momentum for s in q), t, {})


def plane(count: int = BODIES) -> list[tuple[sp.Symbol, sp.Symbol]]:
    q = coordinates(" ".join(f"{c}{i}" for i in range(count) for c in "xy") + ",")
    return list(zip(q[::2], q[1::2], strict=True))


def flat(bodies: list[tuple[sp.Symbol, sp.Symbol]]) -> tuple[sp.Symbol, ...]:
    return tuple(itertools.chain.from_iterable(bodies))


def attraction(bodies: list[tuple[sp.Symbol, sp.Symbol]]) -> sp.Expr:
    return sp.Add(*(
        -sp.Rational(i + 1, j + 3) / sp.sqrt((a[0] - b[0]) ** 2 + (b[1] - a[1]) ** 2 + SOFTENING)
        for (i, a), (j, b) in itertools.combinations(enumerate(bodies), 2)
    ))  # fmt: skip


def start(n: int, orbits: int = 1) -> np.ndarray:
    random = np.random.default_rng(5)
    return random.uniform(-2, 2, (2 * n, orbits))


def test_every_pair_and_its_strength_is_found() -> None:
    bodies = plane()
    trap = sp.Add(*(x**2 - y**4 / 7 for x, y in bodies))
    found = pair_forces(system_of(attraction(bodies) + trap, flat(bodies)))
    assert found is not None
    assert (found.bodies, found.axes) == (BODIES, 2)
    assert found.strengths[2][5] == found.strengths[5][2] == Fraction(-3, 8)
    assert all(found.strengths[i][i] == 0 for i in range(BODIES))
    assert len(found.rest) == 2 * BODIES


def not_found() -> dict[str, sp.Expr]:
    bodies = plane()
    (first, second), *_ = itertools.combinations(bodies, 2)
    lost = 1 / sp.sqrt((first[0] - second[0]) ** 2 + (first[1] - second[1]) ** 2 + sp.Rational(1, 4))
    return {
        "a pair is missing": attraction(bodies) + sp.Rational(1, 4) * lost - lost / 12,
        "one pair is softened otherwise": attraction(bodies).subs(first[0] - second[0], 2 * (first[0] - second[0])),
        "not symmetric": sp.Add(*(
            sp.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + 1) * (a[0] - 2 * b[0])
            for a, b in itertools.combinations(bodies, 2)
        )),
        "few bodies": attraction(bodies[:5]) + sp.Add(*(x**2 + y**2 for x, y in bodies)),
    }  # fmt: skip


@pytest.mark.parametrize("what", not_found())
def test_what_is_no_sum_over_all_pairs_is_left_alone(what: str) -> None:
    assert pair_forces(system_of(not_found()[what], flat(plane()))) is None


def test_few_bodies_are_written_out() -> None:
    found = [pair_forces(system_of(attraction(plane(n)), flat(plane(n)))) for n in (5, BODIES)]
    assert [each is None for each in found] == [True, False]


@pytest.mark.parametrize("precision", ["double", "compensated", "double-double", "extended", "single"])
@pytest.mark.parametrize("scheme", ["verlet", "srkn-6b"])
def test_loops_give_the_written_out_motion(
    precision: str, scheme: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    bodies = plane()
    q = flat(bodies)
    H = Hamiltonian(
        sp.Add(*(s.momentum**2 / 2 for s in q), *(x**2 + y**4 / 7 for x, y in bodies)) + attraction(bodies),
        q, [s.momentum for s in q],
    )  # fmt: skip

    def end() -> np.ndarray:
        motion = propagate(
            H,
            (0, 1),
            start(len(q))[:, 0],
            method=Splitting(scheme),
            step=0.01,
            precision=precision,
            samples=1,
        )
        return motion.y[:, -1]

    rolled = end()
    asked: list[HamiltonEquations] = []
    monkeypatch.setattr(splitting, "pair_forces", asked.append)  # which finds none
    kept_splitting.cache_clear()  # or the loop of before would be taken again
    written_out = end()
    assert asked
    bound = {"single": 2e-5, "double": 1e-13, "compensated": 1e-13}.get(precision, 2e-15)
    assert not np.array_equal(rolled, start(len(q))[:, 0])
    assert abs(rolled - written_out).max() < bound


@pytest.mark.parametrize("heavy", [1, 3])
def test_all_alike_and_one_heavy_body(heavy: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """One strength is a number, and two are a table."""
    bodies = plane()
    q = flat(bodies)
    pairs = itertools.combinations(enumerate(bodies), 2)
    V = -sum(
        (1 if i else heavy) / sp.sqrt((a[0] - b[0]) ** 2 + (b[1] - a[1]) ** 2 + SOFTENING)
        for (i, a), (_, b) in pairs
    )
    H = Hamiltonian(sp.Add(*(s.momentum**2 / 2 for s in q)) + V, q, [s.momentum for s in q])
    by = {"method": Splitting("verlet"), "step": 0.01, "samples": 1}
    rolled = propagate(H, (0, 1), start(len(q))[:, 0], **by).y[:, -1]
    asked: list[HamiltonEquations] = []
    monkeypatch.setattr(splitting, "pair_forces", asked.append)
    kept_splitting.cache_clear()
    written_out = propagate(H, (0, 1), start(len(q))[:, 0], **by).y[:, -1]
    assert asked
    assert abs(rolled - written_out).max() < 1e-13


def test_lanes_give_the_bits_of_one_orbit() -> None:
    bodies = plane(12)
    q = flat(bodies)
    H = Hamiltonian(sp.Add(*(s.momentum**2 / 2 for s in q)) + attraction(bodies), q, [s.momentum for s in q])
    states = start(len(q), 11)
    settings = {"method": Splitting("verlet"), "step": 0.01, "samples": 3}
    together = propagate(H, (0, 1), states, **settings)
    for orbit in (0, 10):
        alone = propagate(H, (0, 1), states[:, orbit], **settings)
        np.testing.assert_array_equal(together.y[:, :, orbit], alone.y)


def test_a_wrong_strength_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    bodies = plane()
    system = system_of(attraction(bodies), flat(bodies))
    found = pair_forces(system)
    assert isinstance(found, PairForces)
    wrong = replace(found, strengths=tuple(tuple(2 * c for c in row) for row in found.strengths))
    ends = []
    for forces in (found, wrong):
        monkeypatch.setattr(splitting, "pair_forces", lambda system, forces=forces: forces)
        made = compiled_loop(
            system_of(attraction(bodies), flat(bodies)), Splitting("verlet"), FIXED["double"]
        )
        y, e, c = start(len(system.q))[:, 0].copy(), np.zeros(made.carry), np.array([0, 0.1, 0.05, 0.1, 0.05])
        made.code.call(y.ctypes.data, e.ctypes.data, c.ctypes.data, 0, 1, 1)
        ends.append(y)
    assert abs(ends[0] - ends[1]).max() > 1e-3
