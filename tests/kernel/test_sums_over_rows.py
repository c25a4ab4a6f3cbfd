"""Sums over chains, pairs and lattices, kept as one term: they are what they are written out, and move as that does."""

from __future__ import annotations

import dataclasses
import threading

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon import (
    AccuracyWarning,
    Event,
    Gauss,
    Hamiltonian,
    Lagrangian,
    Splitting,
    Taylor,
    coordinates,
    equal,
    flow_jacobian,
    is_constant_of_motion,
    load_motion,
    propagate,
    vanishes,
)
from canon.expression.symbols.repeated_sum import RepeatedSum
from canon.flow.checked_request import _kept_system, hamilton_equations_of
from canon.mechanics import chain_sum, lattice_sum, pair_sum, row_sum, written_out

SITES = 90


def variables(n):
    return sp.symbols(f"q0:{n}", real=True), sp.symbols(f"p0:{n}", real=True)


def kinetic(p):
    return row_sum(lambda p: p**2 / 2, p)


def bond(a, b):
    return (b - a) ** 2 / 2 + (b - a) ** 4 / 40


def attraction(a, b):
    *x, m = a
    *y, M = b
    return -m * M / sp.sqrt(1 + sum((u - v) ** 2 for u, v in zip(x, y, strict=True)))


def fixed_ends(n):
    q, p = variables(n)
    return kinetic(p) + chain_sum(bond, [0, *q, 0]), q, p


def ring(n):
    q, p = variables(n)
    return kinetic(p) + chain_sum(lambda a, b: sp.exp(a - b), [*q, q[0]]), q, p


def masses_and_field(n):
    q, p = variables(n)
    m = [1 + sp.Rational(k % 5, 7) for k in range(n)]
    pinned = row_sum(lambda x, k: k * x**2 / 2 + sp.cos(x), q, range(n))
    return row_sum(lambda p, m: p**2 / (2 * m), p, m) + chain_sum(bond, q) + pinned + q[3] ** 4 / 4, q, p


def second_neighbours(n):
    q, p = variables(n)
    return kinetic(p) + chain_sum(bond, q) + sp.Rational(1, 3) * row_sum(bond, q[:-2], q[2:]), q, p


def plane(n):
    side = 10
    q, p = variables(side * side)
    rows = [q[side * k : side * (k + 1)] for k in range(side)]
    return kinetic(p) + lattice_sum(lambda a, b: 1 - sp.cos(a - b), rows, periodic=n > 90), q, p


def driven(n):
    q, p = variables(n)
    t = sp.Symbol("t", real=True)
    return kinetic(p) + chain_sum(bond, q) + row_sum(lambda x: x * sp.sin(2 * t), q), q, p


def some_still(n):
    q, p = variables(n)
    return kinetic(p[:-3]) + chain_sum(bond, q[5:]), q, p


def bodies(n):
    x, p = [sp.symbols(f"x{k} y{k}", real=True) for k in range(n)], sp.symbols(f"p0:{2 * n}", real=True)
    m = [1 + sp.Rational(k, n) for k in range(n)]
    q = tuple(s for body in x for s in body)
    kinetic = row_sum(lambda p, m: p**2 / (2 * m), p, [each for each in m for _ in range(2)])
    return kinetic + pair_sum(attraction, [(*b, each) for b, each in zip(x, m, strict=True)]), q, p


def bodies_in_a_trap(n):
    H, q, p = bodies(n)
    return H + row_sum(lambda x: x**2 / 50, q), q, p


KEPT = [
    fixed_ends,
    ring,
    masses_and_field,
    second_neighbours,
    plane,
    driven,
    some_still,
    bodies,
    bodies_in_a_trap,
]


def made(make, n=None):
    n = n or (14 if make in (bodies, bodies_in_a_trap) else SITES)
    H, q, p = make(n)
    return Hamiltonian(H, q, p), Hamiltonian(written_out(H), q, p)


def start(system):
    n = len(system.q)
    return np.concatenate(
        [np.sin(np.arange(n)) + (0.5 * np.arange(n) if n < SITES else 0), np.cos(np.arange(n)) / 3]
    )


@pytest.mark.parametrize("make", KEPT)
@pytest.mark.parametrize("precision", ["double", "compensated"])
def test_a_sum_moves_as_it_does_written_out(make, precision):
    kept, plain = made(make)
    assert hamilton_equations_of(kept, {}).sums
    how = {"method": Splitting("blanes-moan-6"), "step": 0.02, "samples": 4, "precision": precision}
    one, other = (propagate(system, (0, 2), start(kept), **how) for system in (kept, plain))
    np.testing.assert_allclose(one.y, other.y, rtol=0, atol=2e-12 * np.abs(other.y).max())
    np.testing.assert_allclose(one.energies.values, other.energies.values, rtol=1e-15, atol=1e-14)
    size = np.abs(other.energies.values).max()
    np.testing.assert_allclose(one.energy_change, other.energy_change, rtol=1e-3, atol=1e-13 * size)


@pytest.mark.parametrize("make", KEPT)
def test_nothing_is_written_out_by_a_splitting(make, monkeypatch):
    system, _ = made(make)
    _kept_system.cache_clear()  # equations kept from another test may have been written out there
    monkeypatch.setattr(RepeatedSum, "doit", lambda *_, **__: pytest.fail("written out"))
    run = propagate(system, (0, 1), start(system), method=Splitting("verlet"), step=0.05, samples=5)
    assert np.isfinite(run.energy_change).all()
    assert "degrees of freedom" in str(run)


@pytest.mark.parametrize("make", [masses_and_field, bodies_in_a_trap])
def test_orbits_side_by_side_move_as_one_by_one(make):
    system, _ = made(make)
    y0 = np.stack([start(system) * factor for factor in (1, 0.9, 1.1, 0.8, 1.2)], axis=1)
    how = {"method": Splitting("verlet"), "step": 0.05, "samples": 3}
    together = propagate(system, (0, 1), y0, **how)
    for k in range(5):
        alone = propagate(system, (0, 1), y0[:, k], **how)
        np.testing.assert_allclose(together.y[:, :, k], alone.y, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("scheme", ["verlet", "srkn-6b"])
def test_where_no_force_acts_the_momenta_stay(scheme):
    q, p = variables(80)
    system, y0 = Hamiltonian(kinetic(p), q, p), np.arange(160.0)
    assert hamilton_equations_of(system, {}).sums
    end = propagate(system, (0, 1), y0, method=Splitting(scheme), step=0.125, samples=1).y[:, -1]
    assert np.array_equal(end[80:], y0[80:])
    np.testing.assert_allclose(end[:80], y0[:80] + y0[80:], rtol=1e-14)


def test_where_nothing_is_kinetic_the_places_stay():
    q, p = variables(80)
    system, y0 = Hamiltonian(chain_sum(bond, q), q, p), np.sin(np.arange(160.0))
    assert hamilton_equations_of(system, {}).sums
    end = propagate(system, (0, 1), y0, method=Splitting("verlet"), step=0.125, samples=1).y[:, -1]
    assert np.array_equal(end[:80], y0[:80])
    assert np.abs(end[80:] - y0[80:]).max() > 0.1


def test_kick_first_schemes_keep_the_force_of_pairs():
    system, plain = made(bodies)
    how = {"method": Splitting("srkn-6b"), "step": 0.02, "samples": 2}
    one, other = (propagate(each, (0, 1), start(system), **how) for each in (system, plain))
    np.testing.assert_allclose(one.y, other.y, rtol=0, atol=1e-12 * np.abs(other.y).max())


def test_a_step_is_symplectic_and_goes_back():
    system, _ = made(masses_and_field, 70)
    y0 = start(system)
    how = {"method": Splitting("verlet"), "step": 0.05, "samples": 1}
    there = propagate(system, (0, 1), y0, **how).y[:, -1]
    back = propagate(system, (1, 0), there, **how).y[:, -1]
    np.testing.assert_allclose(back, y0, rtol=0, atol=1e-11)
    M, n = flow_jacobian(system, (0, 1), y0, method=Splitting("verlet"), step=0.05).final, 70
    J = np.block([[np.zeros((n, n)), np.eye(n)], [-np.eye(n), np.zeros((n, n))]])
    np.testing.assert_allclose(M.T @ J @ M, J, rtol=0, atol=1e-11)


def test_every_other_method_sees_the_sum_written_out():
    system, plain = made(fixed_ends, 70)
    y0 = start(system)
    for how in ({"method": Taylor()}, {"method": Gauss(4), "step": 0.1}):
        one, other = (propagate(each, (0, 1), y0, samples=2, **how) for each in (system, plain))
        assert np.array_equal(one.y, other.y)
        assert np.abs(one.energy_change - other.energy_change).max() <= 2.0**-60 * other.energies.values[0]


def test_observables_and_parameters_go_with_it():
    q, p = variables(80)
    k, m = sp.symbols("k m", positive=True)
    H = row_sum(lambda p: p**2 / (2 * m), p) + chain_sum(lambda a, b: k * (b - a) ** 2 / 2, [0, *q, 0])
    system, y0 = Hamiltonian(H, q, p), [1.0] + [0.0] * 159
    how = {"method": Splitting("verlet"), "step": 0.1, "samples": 3, "observables": {"first": q[0] ** 2}}
    run = propagate(system, (0, 3), y0, parameters={"k": 2, "m": 3}, **how)
    other = propagate(Hamiltonian(written_out(H), q, p), (0, 3), y0, parameters={"k": 2, "m": 3}, **how)
    np.testing.assert_allclose(run.observables["first"], other.observables["first"], rtol=1e-12)
    with pytest.raises(KeyError, match="the Hamiltonian holds m: give each a number"):
        propagate(system, (0, 3), y0, parameters={"k": 2}, **how)


def test_observables_of_a_kept_system_are_kept_too(monkeypatch):
    H, q, p = masses_and_field(SITES)
    t = sp.Symbol("t", real=True)
    functions = {
        "total": row_sum(lambda p: p, p),
        "product": row_sum(lambda q, p: q * p, q, p) + q[3] * t + 7,
        "pairs": pair_sum(lambda a, b: a * b, q[:5]),
        "one": sp.cos(q[0]) * p[1],
        "seven": sp.Integer(7),
    }
    plain = {name: written_out(f) for name, f in functions.items()}
    y0, kept = start(made(masses_and_field)[0]), Hamiltonian(H, q, p)
    _kept_system.cache_clear()
    how = {"method": Splitting("verlet"), "step": 0.02, "samples": 3, "precision": "compensated"}
    other = propagate(Hamiltonian(written_out(H), q, p), (0, 1), y0, observables=plain, **how)
    with monkeypatch.context() as patched:
        patched.setattr(RepeatedSum, "doit", lambda *_, **__: pytest.fail("written out"))
        run = propagate(kept, (0, 1), y0, observables=functions, **how)
        for name in functions:
            np.testing.assert_allclose(run.observables[name], other.observables[name], rtol=1e-11, atol=1e-11)
    inside = {"inside": sp.sin(row_sum(lambda p: p, p))}
    run = propagate(kept, (0, 1), y0, observables=inside, **how)
    np.testing.assert_allclose(run.observables["inside"], np.sin(other.observables["total"]), atol=1e-11)
    wide = propagate(kept, (0, 1), y0, observables=functions, **(how | {"precision": "extended"}))
    np.testing.assert_allclose(wide.observables["product"], other.observables["product"], rtol=1e-11)


@pytest.mark.parametrize("make", [masses_and_field, bodies_in_a_trap])
def test_what_was_saved_goes_on_bit_for_bit(make, tmp_path):
    system, _ = made(make)
    how = {
        "method": Splitting("verlet"),
        "step": 0.02,
        "observables": {"total": row_sum(lambda p: p, system.p)},
    }
    run = propagate(system, (0, 1), start(system), samples=5, **how)
    run.save(tmp_path / "motion.npz")
    again = load_motion(tmp_path / "motion.npz")
    assert again.record.task.system.sums
    for one, other in ((run, again), (run.resume(until=2), again.resume(until=2))):
        assert np.array_equal(one.y, other.y)
        assert np.array_equal(one.energy_change, other.energy_change)
        assert np.array_equal(one.observables["total"], other.observables["total"])


def test_the_normal_modes_of_a_long_chain_are_known():
    n, mode = 200, 3
    q, p = variables(n)
    system = Hamiltonian(kinetic(p) + chain_sum(lambda a, b: (b - a) ** 2 / 2, [0, *q, 0]), q, p)
    shape = np.sin(np.pi * mode * np.arange(1, n + 1) / (n + 1))
    omega = 2 * np.sin(np.pi * mode / (2 * (n + 1)))
    how = {"method": Splitting("blanes-moan-6"), "step": 0.1, "samples": 1}
    end = propagate(system, (0, 50), np.concatenate([shape, np.zeros(n)]), **how).y[:, -1]
    np.testing.assert_allclose(
        end, np.concatenate([shape * np.cos(50 * omega), -omega * shape * np.sin(50 * omega)]), atol=1e-10
    )


def test_momentum_of_a_thousand_bodies_is_kept():
    H, q, p = bodies(1000)
    y0 = np.concatenate([np.random.default_rng(1).normal(size=2000) * 30, np.zeros(2000)])
    run = propagate(Hamiltonian(H, q, p), (0, 0.1), y0, method=Splitting("verlet"), step=0.01, samples=1)
    push = np.abs(run.y[2000:, -1]).sum()
    assert push > 100
    assert np.abs(run.y[2000::2, -1].sum()) < 1e-13 * push
    assert abs(run.energy_change[-1]) < 1e-6 * abs(run.energies.values[0])


@settings(max_examples=50, deadline=None)
@given(
    st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5), st.integers(-3, 3)), min_size=1, max_size=30),
    st.integers(0, 3),
)
def test_slopes_of_random_sums_are_those_of_the_sum_written_out(rows, which):
    x = sp.symbols("x0:6")
    term = (
        lambda a, b, k: k * a * b,
        lambda a, b, k: sp.sin(a - k * b),
        lambda a, b, k: a,
        lambda a, b, k: k * sp.exp(a + b),
    )[which]
    kept = row_sum(term, *zip(*((x[i], x[j], k) for i, j, k in rows), strict=True))
    plain = written_out(kept)
    for s in x:
        assert sp.expand(kept.diff(s) - plain.diff(s)) == 0
    assert kept.free_symbols <= {*x}


def test_pairs_are_differentiated_as_they_are_written_out():
    x, g = sp.symbols("x0:5"), sp.Symbol("g")
    kept = pair_sum(lambda a, b: g * a[0] * a[1] * sp.sin(a[0] - 2 * b[0]), [(s, s**2) for s in x])
    plain = written_out(kept)
    assert len(plain.args) == kept.length == 10
    for s in (*x, g):
        assert sp.expand(written_out(kept.diff(s)) - plain.diff(s)) == 0


def test_what_does_not_split_or_is_no_list_of_symbols_is_written_out():
    q, p = variables(70)
    mixed = row_sum(lambda q, p: q**2 * p**2, q, p)
    inside = kinetic(p) + sp.sin(chain_sum(bond, q))
    shifted = kinetic(p) + chain_sum(bond, [s + 1 for s in q])
    hub = kinetic(p) + row_sum(bond, q[:1] * 69, q[1:])
    kinked = kinetic(p) + row_sum(sp.Abs, q)
    product = kinetic(p) * (1 + q[0] ** 2)
    for H in (
        mixed,
        inside,
        shifted,
        hub,
        kinked,
        product,
        pair_sum(lambda a, b: a - b**2, q) + kinetic(p),
    ):
        equations = hamilton_equations_of(Hamiltonian(H, q, p), {})
        assert not equations.sums
        assert len(equations.force) == 70
    assert hamilton_equations_of(Hamiltonian(kinked, q, p), {}).separable
    with pytest.warns(AccuracyWarning, match="steps over the kinks"):
        propagate(Hamiltonian(kinked, q, p), (0, 1), [1.0] * 140, method=Splitting("verlet"), step=0.1)


def test_a_kinetic_energy_that_is_not_quadratic_is_seen():
    q, p = variables(70)
    t = sp.Symbol("t", real=True)
    for f, quadratic in (
        (lambda p: p**2 / 2, True), (lambda p: p**4, False), (lambda p: p**2 * t, False), (lambda p: p * t, False)
    ):  # fmt: skip
        equations = hamilton_equations_of(Hamiltonian(row_sum(f, p) + chain_sum(bond, q), q, p), {})
        plain = hamilton_equations_of(Hamiltonian(written_out(row_sum(f, p) + chain_sum(bond, q)), q, p), {})
        assert equations.sums
        for name in ("separable", "quadratic_kinetic", "autonomous"):
            assert getattr(equations, name) is getattr(plain, name)
        assert equations.quadratic_kinetic is quadratic


def test_the_same_sum_written_again_is_the_same_expression():
    q, p = variables(70)
    assert chain_sum(bond, q) == chain_sum(bond, q)
    assert hamilton_equations_of(Hamiltonian(fixed_ends(70)[0], q, p), {}) is hamilton_equations_of(
        Hamiltonian(fixed_ends(70)[0], q, p), {}
    )
    assert str(chain_sum(bond, q[:3])).startswith("Sum(")
    assert r"\sum_{i = 1 \ldots 2}" in sp.latex(chain_sum(bond, q[:3]))
    assert r"i < j" in sp.latex(pair_sum(lambda a, b: a * b, q[:3]))


@pytest.mark.parametrize(
    ("write", "error", "message"),
    [
        (lambda q: chain_sum(bond, q[:1]), ValueError, "a chain of 1 sites has no neighbours"),
        (lambda q: chain_sum((q[0] - q[1]) ** 2, q), TypeError, "should be a function, such as lambda a, b"),
        (lambda q: row_sum(bond, q[:3], q[:2]), ValueError, "columns of 3, 2 entries"),
        (lambda q: row_sum(bond), ValueError, "no columns"),
        (lambda q: row_sum(lambda x: [x], q), TypeError, "the term of the sum should be an expression"),
        (lambda q: row_sum(lambda x: x, ["a"]), TypeError, "an argument of the sum should be an expression"),
        (lambda q: pair_sum(attraction, [(q[0], 1)]), ValueError, "1 bodies make no pair"),
        (lambda q: pair_sum(attraction, [(q[0], 1), (q[1],)]), ValueError, "more is given than of others"),
        (lambda q: lattice_sum(bond, [[q[0]]]), ValueError, r"shape \(1, 1\) has no neighbours"),
        (lambda q: lattice_sum(bond, [q[:2], q[:3]]), ValueError, "the rows of the lattice differ in length"),
    ],
)
def test_what_is_no_sum_is_told(write, error, message):
    with pytest.raises(error, match=message):
        write(coordinates("q0:5"))


def test_equations_with_other_rates_are_no_sums_any_more():
    system = hamilton_equations_of(made(fixed_ends)[0], {})
    moved = dataclasses.replace(system, written=system.moving_by(system.force, system.velocity))
    assert system.sums
    assert not moved.sums
    assert moved.loops is None
    assert moved.velocity == system.force


def test_arrays_that_no_stack_holds_are_on_the_heap():
    H, q, p = fixed_ends(3000)
    system = Hamiltonian(H, q, p)
    y0 = np.stack([start(system) * factor for factor in np.linspace(0.5, 1.5, 16)], axis=1)
    how = {"method": Splitting("verlet"), "step": 0.05, "samples": 1, "precision": "compensated"}
    found = []
    before = threading.stack_size(256 * 1024)
    try:
        thread = threading.Thread(target=lambda: found.append(propagate(system, (0, 0.5), y0, **how)))
        thread.start()
    finally:
        threading.stack_size(before)
    thread.join()
    for k in (0, 15):
        alone = propagate(system, (0, 0.5), y0[:, k], **how)
        np.testing.assert_allclose(found[0].y[:, :, k], alone.y, rtol=1e-13, atol=1e-13)


def test_bodies_that_have_but_a_part_of_the_coordinates_are_written_out():
    q, p = variables(25)
    E = (
        kinetic(p)
        + pair_sum(lambda a, b: -1 / sp.sqrt(1 + (a[0] - b[0]) ** 2), [(x, 1) for x in q[:24]])
        + q[24] ** 2 / 2
    )
    y0 = np.r_[np.linspace(-1, 1, 25), np.zeros(25)]
    how = {"method": Splitting("blanes-moan-6"), "step": 0.05, "samples": 1}
    end = propagate(Hamiltonian(E, q, p), (0, 1), y0, **how).q[24, -1]
    assert end == pytest.approx(np.cos(1), abs=1e-7)


def test_sums_in_sums_have_arguments_of_their_own():
    q, p = variables(3)
    nested = row_sum(lambda x: row_sum(lambda w: w * x, [1, 2, 3]), q)
    assert sp.expand(written_out(nested) - 6 * sum(q)) == 0
    assert [written_out(nested.diff(s)) for s in q] == [6, 6, 6]
    inner = row_sum(lambda w: w * q[0], [1, 2, 3])
    held = row_sum(lambda x: x * inner, [q[1], q[2]])
    assert sp.expand(written_out(held) - 6 * q[0] * (q[1] + q[2])) == 0
    assert sp.expand(written_out(held.diff(q[0])) - 6 * (q[1] + q[2])) == 0
    k = sp.Symbol("k")
    put_in = row_sum(lambda x: k * x**2, q).subs(k, row_sum(lambda w: w, [1, 2, 3]))
    assert sp.expand(written_out(put_in) - 6 * sum(s**2 for s in q)) == 0
    H = Hamiltonian(kinetic(p) + row_sum(lambda x: row_sum(lambda w: w * x**2 / 2, [1, 2, 3]), q), q, p)
    assert H.p_dot == tuple(-6 * s for s in q)
    assert is_constant_of_motion(p[0], H).fails
    many, momenta = variables(80)
    deep = kinetic(momenta) + row_sum(lambda x: row_sum(lambda w: w * x**2 / 2, [1, 2, 3]), many)
    system, y0 = Hamiltonian(deep, many, momenta), [1.0] * 80 + [0.0] * 80
    end = propagate(system, (0, 1), y0, method=Splitting("blanes-moan-6"), step=0.01, samples=1).y[7, -1]
    assert end == pytest.approx(np.cos(np.sqrt(6)), abs=1e-10)


def test_columns_that_the_term_does_not_hold_are_none_of_it():
    q, _ = variables(3)
    k = sp.Symbol("k")
    assert row_sum(lambda x, _: x**2, q, [k, 2 * k, 3 * k]).free_symbols == {*q}
    assert row_sum(lambda _: k, q) == 3 * k
    assert pair_sum(lambda *_: k, q) == 3 * k


def test_what_takes_sums_apart_sees_them_written_out():
    q, p = variables(4)
    C = chain_sum(bond, q)
    plain = written_out(C)
    assert equal(C, plain).holds
    assert vanishes(C - plain).holds
    assert equal(C, 2 * plain).fails
    assert Hamiltonian(kinetic(p) + C, q, p).H.atoms(RepeatedSum) == set()
    assert C.is_polynomial(*q)
    assert float(chain_sum(bond, [1, 2, 4])) == pytest.approx(0.5 + 1 / 40 + 2 + 16 / 40)
    assert sp.lambdify(q, C)(1, 2, 4, 4) == pytest.approx(0.5 + 1 / 40 + 2 + 16 / 40)
    long, momenta = variables(70)
    speeds = [sp.Symbol(f"{s}_dot", real=True) for s in long]
    springs = chain_sum(lambda a, b: (b - a) ** 2 / 2, long)
    L = Lagrangian(row_sum(lambda v: v**2 / 2, speeds) - springs, long)
    assert not L.L.has(RepeatedSum)
    H = Hamiltonian(kinetic(momenta) + springs, long, momenta)
    met = Event(row_sum(lambda x: x, long) - 1)
    y0 = [0.0] * 70 + [1.0] * 70
    run = propagate(H, (0, 1), y0, method=Taylor(), events=[met])
    assert run.events[0].t == pytest.approx(1 / 70)
    shown = sp.latex(C**2)
    assert r"\left(\sum_{i = 1 \ldots 3} \left(" in shown
    assert shown.endswith(r"\right)\right)^{2}")
    assert str(chain_sum(lambda a, b: a * b, q)) == "Sum(a_i*b_i, i = 1…3, (a, b)_1 = (q0, q1))"
    assert str(pair_sum(lambda a, b: a * b, q)) == "Sum(a_i*a_j, i < j = 1…4, (a)_1 = (q0))"


def test_a_periodic_lattice_is_closed_along_axes_of_three_and_more():
    q = sp.symbols("q0:6")
    rows, bonds = [q[:3], q[3:]], (lambda a, b: a * b)
    left_open, closed = (written_out(lattice_sum(bonds, rows, periodic=some)) for some in (False, True))
    assert closed - left_open == q[0] * q[2] + q[3] * q[5]
