"""Sums over pairs that compiled code adds up: as the same sums are added up term by term in wider numbers."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian, Splitting, propagate
from canon.expression.graph.number_systems import FLOAT64, LONGDOUBLE
from canon.flow.checked_request import hamilton_equations_of
from canon.flow.run.values_at_states import energy_and_rates, size_of_energy
from canon.kernel.llvm.number_types import DOUBLE, DOUBLE_DOUBLE
from canon.kernel.llvm.pair_values import CompiledPairs, can_be_compiled
from canon.kernel.program.repeated.repeated_terms import sums_in
from canon.kernel.program.repeated.repeated_values import rates_of_sums, size_of_sums, value_of_sums
from canon.mechanics import pair_sum, row_sum

T = sp.Symbol("t", real=True)


def gravity(a, b):
    (*x, m), (*y, M) = a, b
    return -m * M / sp.sqrt(sum((u - v) ** 2 for u, v in zip(x, y, strict=True)) + sp.Rational(1, 100))


def lopsided(a, b):
    """A term that is not the same where its rows change places, and depends on the time."""
    (x, y, m), (u, v, M) = a, b
    return m * (x - 2 * u) ** 3 + sp.exp(-((y - v) ** 2)) * T - M * v / (2 + x**2)


def molecules(a, b):
    (*x, _), (*y, _) = a, b
    r2 = sum((u - v) ** 2 for u, v in zip(x, y, strict=True))
    return r2**-6 - r2**-3


def pairs(count, axes, term):
    """Return the sum over pairs, its variables, and a state."""
    q = sp.symbols(f"q0:{count * axes}", real=True)
    p = sp.symbols(f"p0:{count * axes}", real=True)
    masses = [1 + sp.Rational(k, 7 * count) for k in range(count)]
    rows = [(*q[axes * k : axes * k + axes], masses[k]) for k in range(count)]
    state = np.random.default_rng(count).normal(size=2 * count * axes) * 3
    return pair_sum(term, rows), q, p, state


TERMS = [(gravity, 3), (lopsided, 2), (molecules, 3)]


@pytest.mark.parametrize("count", [3, 8, 9, 64, 77])
@pytest.mark.parametrize(("term", "axes"), TERMS)
@pytest.mark.parametrize("scalar", [DOUBLE, DOUBLE_DOUBLE], ids=["double", "double-double"])
def test_compiled_sums_are_those_of_numpy(count, term, axes, scalar):
    written, q, p, state = pairs(count, axes, term)
    sums = sums_in(written, (*q, *p), T, {}, "the sum")
    (each,) = sums
    assert each.pairs
    assert can_be_compiled(each)
    compiled, time = CompiledPairs(each, T, scalar), np.longdouble(1) / 3
    wide = state.astype(np.longdouble) + state * np.longdouble(2) ** -60 / 3
    if scalar is DOUBLE:
        wide, time = state.astype(np.longdouble), np.longdouble(float(time))
    value, size = compiled.value_and_size(wide, time)
    terms = size_of_sums(sums, T, wide, time, LONGDOUBLE)
    bound = terms * (1e-14 if scalar is DOUBLE else 1e-18)
    assert abs(size - terms) <= bound
    assert abs(value - value_of_sums(sums, T, wide, time, LONGDOUBLE)) <= bound
    rates, slopes = rates_of_sums(sums, T, wide, time, LONGDOUBLE), compiled.slopes(wide, time)
    half = len(q)
    largest = abs(rates).max()
    assert abs(-slopes[:half] - rates[half:]).max() <= largest * (1e-13 if scalar is DOUBLE else 1e-17)
    assert not slopes[half:].any()


def test_long_sums_are_added_up_piece_by_piece(monkeypatch):
    written, q, p, state = pairs(77, 3, gravity)
    (each,) = sums_in(written, (*q, *p), T, {}, "the sum")
    at_once = CompiledPairs(each, T, DOUBLE_DOUBLE)
    whole, slopes = at_once.value_and_size(state, 0.0), at_once.slopes(state, 0.0)
    monkeypatch.setattr("canon.kernel.llvm.pair_values._AT_ONCE", 77 * 5)
    assert at_once.value_and_size(state, 0.0) == whole
    assert np.array_equal(at_once.slopes(state, 0.0), slopes)


def test_other_functions_are_left_to_numpy():
    written, q, p, _ = pairs(9, 2, lambda a, b: sp.erf(a[0] - b[0]) * a[1])
    (each,) = sums_in(written, (*q, *p), T, {}, "the sum")
    assert not can_be_compiled(each)


def cluster(count):
    written, q, p, state = pairs(count, 3, gravity)
    masses = [1 + sp.Rational(k, 7 * count) for k in range(count) for _ in range(3)]
    kinetic = row_sum(lambda p, m: p**2 / (2 * m), p, masses)
    return Hamiltonian(kinetic + written, q, p), state


def test_energies_of_many_bodies_are_those_of_few_terms_at_a_time():
    """A cluster of 240 bodies by compiled code and by NumPy, for one state and for several."""
    system, state = cluster(240)
    equations = hamilton_equations_of(system, {})
    several = np.stack([state, 1.1 * state, -state], axis=1)
    for states in (state, several):
        found = energy_and_rates(equations, states, 0.0, FLOAT64)
        wanted = [
            value_of_sums(equations.sums, equations.t, states, 0.0, FLOAT64),
            *rates_of_sums(equations.sums, equations.t, states, 0.0, FLOAT64),
        ]
        for a, b in zip(found, wanted, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-11, atol=1e-9)
    sizes = size_of_energy(equations, several[:, :, np.newaxis], np.zeros(3))
    wanted = size_of_sums(equations.sums, equations.t, several, 0.0, FLOAT64)
    np.testing.assert_allclose(sizes[:, 0], wanted, rtol=1e-13)


def test_the_energy_along_a_motion_is_told_to_rounding():
    """Told by the motion, and by summing the states that it returns exactly."""
    system, state = cluster(210)
    motion = propagate(
        system, (0, 0.01), state, method=Splitting("verlet"), step=0.005, samples=3, precision="double"
    )
    masses = 1 + np.arange(210, dtype=np.longdouble) / (7 * 210)
    exactly = []
    for y in motion.y.T:
        place, push = y.astype(np.longdouble).reshape(2, 210, 3)
        energy = ((push**2).sum(axis=1) / (2 * masses)).sum()
        for k in range(209):
            apart = ((place[k] - place[k + 1 :]) ** 2).sum(axis=1) + np.longdouble(1) / 100
            energy -= (masses[k] * masses[k + 1 :] / np.sqrt(apart)).sum()
        exactly.append(energy)
    change = np.array(exactly) - exactly[0]
    np.testing.assert_allclose(motion.energies.values, np.array(exactly, dtype=float), rtol=1e-15)
    np.testing.assert_allclose(
        motion.energies.values - motion.energies.values[0], change.astype(float), atol=1e-13 * abs(exactly[0])
    )
