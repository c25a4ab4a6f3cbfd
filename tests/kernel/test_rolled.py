"""Rolled loops give the bits of the same program written out."""

import itertools

import numpy as np
import pytest
import sympy as sp

from canon.expression.symbols.symbol import coordinates, time
from canon.kernel.llvm import rolled
from canon.kernel.llvm.number_types import DOUBLE, MachineType
from canon.kernel.llvm.writer import Writer
from canon.kernel.loops import splitting
from canon.kernel.program.hamilton_equations import equations
from canon.kernel.program.operation_families import families_of, families_of_program


def chain(n):
    """A chain with fixed ends, cubic springs, and a push that depends on time where asked."""
    q = coordinates(" ".join(f"x{i}" for i in range(n)) + ",")
    ends = [sp.Integer(0), *q, sp.Integer(0)]
    springs = [(b - a) ** 2 / 2 + (b - a) ** 3 / 12 for a, b in itertools.pairwise(ends)]
    return q, sp.Add(*(s.momentum**2 / 2 for s in q), *springs)


def bodies(count):
    q = coordinates(" ".join(f"{c}{i}" for i in range(count) for c in "xyz") + ",")
    H = sp.Add(*(s.momentum**2 / 2 for s in q))
    for i in range(count):
        for j in range(i):
            H -= sp.Rational(i + j, 7) / sp.sqrt(sum((q[3 * i + k] - q[3 * j + k]) ** 2 for k in range(3)))
    return q, H


def toda(n):
    """Bonds hold functions, which are not to be computed twice."""
    q = coordinates(" ".join(f"x{i}" for i in range(n)) + ",")
    bonds = [sp.exp(a - b) for a, b in itertools.pairwise(q)]
    return q, sp.Add(*(s.momentum**2 / 2 for s in q), *bonds)


def second_neighbours(n):
    """Bonds of two kinds, of which a force reads members k and k + 1, and k and k + 2."""
    q, H = chain(n)
    return q, sp.Add(H, *((q[k + 2] - q[k]) ** 4 / 3 for k in range(n - 2)))


def driven(n):
    q, H = chain(n)
    return q, H + sp.cos(time) * sp.Add(*(sp.sin(s) / (k + 2) for k, s in enumerate(q)))


def stepped(system, number=DOUBLE, *, compensated, kick_first=False, steps=20):
    made = splitting.splitting_loop(system, 3, compensated=compensated, number=number, kick_first=kick_first)
    n = len(system.q)
    y = np.random.default_rng(5).normal(size=(2 * n, number.lanes)).ravel() / 3
    e = np.zeros(y.size)
    a, b = (0.0, 0.3, 0.7, 0.0) if kick_first else (0.2, 0.3, 0.4, 0.1), (0.3, 0.4, 0.3)
    c = np.array([0.5, 0.01, *(0.01 * x for pair in zip(a, b, strict=False) for x in pair), 0.01 * a[-1]])
    c = np.repeat(c, number.lanes)
    made.code.call(y.ctypes.data, e.ctypes.data, c.ctypes.data, 0, steps, 1)
    return np.concatenate([y, e])


@pytest.mark.parametrize(
    "make",
    [
        lambda: chain(12),
        lambda: bodies(4),
        lambda: driven(9),
        lambda: toda(11),
        lambda: second_neighbours(13),
    ],
    ids=["chain", "bodies", "driven", "toda", "second neighbours"],
)
@pytest.mark.parametrize("lanes", [1, 8])
@pytest.mark.parametrize("compensated", [False, True])
def test_rolled_and_written_out_programs_agree_bit_for_bit(make, lanes, compensated, monkeypatch):
    q, H = make()
    system = equations(H, q, tuple(s.momentum for s in q), time, {})
    number = MachineType("double", 53, "float64", "", lanes=lanes)
    monkeypatch.setattr(splitting, "is_worth_rolling", lambda *_: False)
    out = stepped(system, number, compensated=compensated)
    monkeypatch.setattr(splitting, "is_worth_rolling", lambda *_: True)
    np.testing.assert_array_equal(stepped(system, number, compensated=compensated), out)
    assert np.isfinite(out).all()
    if system.autonomous:
        shared = stepped(system, number, compensated=compensated, kick_first=True)
        monkeypatch.setattr(splitting, "is_worth_rolling", lambda *_: False)
        np.testing.assert_array_equal(
            stepped(system, number, compensated=compensated, kick_first=True), shared
        )


def test_long_chains_are_rolled_without_tables_and_small_systems_are_not():
    def force(n):
        q, H = chain(n)
        system = equations(H, q, tuple(s.momentum for s in q), time, {})
        return system.program(system.force)

    def velocity(n):
        q, H = chain(n)
        system = equations(H, q, tuple(s.momentum for s in q), time, {})
        return system.program(system.velocity)

    assert rolled.is_worth_rolling(force(100))
    assert rolled.is_worth_rolling(velocity(256))
    assert not rolled.is_worth_rolling(force(6))
    # Bodies need tables; written out they run faster, as long as they compile in reasonable time.
    q, H = bodies(12)
    system = equations(H, q, tuple(s.momentum for s in q), time, {})
    assert not rolled.is_worth_rolling(system.program(system.force))
    families, _ = families_of(force(100))
    assert len(families) < 40


def test_a_chains_forces_run_one_behind_its_bonds_and_nothing_lies_in_memory():
    q, H = chain(100)
    system = equations(H, q, tuple(s.momentum for s in q), time, {})
    made = rolled._Rolling(Writer(DOUBLE), families_of_program(system.program(system.force)), "%q", "%t")
    assert [loop.size for loop in made.loops if loop.after] == [99]
    # The squares of the two ends.
    assert [len(made.families[kind].members) for kind in made.arrays] == [2]
    q, H = toda(100)
    system = equations(H, q, tuple(s.momentum for s in q), time, {})
    made = rolled._Rolling(Writer(DOUBLE), families_of_program(system.program(system.force)), "%q", "%t")
    # The ends' forces read the exponentials of two bonds.
    assert {made.families[kind].operation for kind in made.arrays} == {"exp"}
