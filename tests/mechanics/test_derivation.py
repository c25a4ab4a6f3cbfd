"""Derivation on the graph against SymPy derivatives, Newton's laws in numbers, and Hamilton's equations."""

import numpy as np
import pytest
import sympy as sp
from chains import heavy_top, n_body, planar_pendulum, rods, spatial_arm, spherical_chain, spring_chain
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.expression.graph.common_subexpressions import shared_to_sympy
from canon.expression.graph.graph import Graph
from canon.expression.graph.python_source import python_function
from canon.expression.graph.sums import SharedSums
from canon.expression.graph.sympy_conversion import NotModelledError
from canon.expression.symbols.symbol import coordinates, parameters, time
from canon.mechanics.at_scale.first_order import canonical_derivation
from canon.mechanics.at_scale.ldl import solved_on_graph
from canon.mechanics.at_scale.numeric_functions import (
    acceleration_function,
    energy_function,
    hamilton_function,
)
from canon.mechanics.at_scale.second_order import derivation, derivation_of_lagrangian
from canon.mechanics.lagrange.body import Particle, PlanarBody, RigidBody, euler_rotation, kinetic_energy
from canon.mechanics.lagrange.force import gravity, lagrangian_of_bodies
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.vanish import vanishes

x, y = coordinates("x y")
m, k, w, c = parameters("m k w c", positive=True)


def turntable():
    """Rheonomic: M, drift, centrifugal and Coriolis terms."""
    co, si = sp.cos(w * time), sp.sin(w * time)
    return [Particle(m, (x * co - y * si + time**2, x * si + y * co))], (x, y), ()


def elastic():
    """Terms of one position that depend on two coordinates at once."""
    place = ((c + x) * sp.sin(y), -(c + x) * sp.cos(y) + x * y)
    return [PlanarBody(m, place, k, y + x * y)], (x, y), (0, -w)


SYSTEMS = {
    "pendulum": lambda: planar_pendulum(3),
    "cart": lambda: planar_pendulum(2, on_cart=True),
    "rods": lambda: rods(3),
    "spherical": lambda: spherical_chain(2),
    "top": heavy_top,
    "arm": spatial_arm,
    "turntable": turntable,
    "elastic": elastic,
}


def numbers(symbols, seed=0):
    chance = np.random.default_rng(seed)
    return dict(zip(symbols, chance.uniform(0.5, 1.5, len(symbols)), strict=True))


def by_sympy(bodies, q, field, at):
    """M and f by SymPy's own derivatives of T − V, in numbers."""
    L = Lagrangian(kinetic_energy(bodies, q) - gravity(bodies, field or (0,) * len(bodies[0].r)), q)
    here = {s: sp.Float(value, 40) for s, value in at.items()}
    M = np.array([[float(e.xreplace(here)) for e in row] for row in L.mass_matrix.tolist()])
    f = np.array([-float(e.xreplace(here)) for e in L.bias])
    return M, f, L, here


@pytest.mark.parametrize("name", SYSTEMS)
def test_agrees_with_sympy_derivatives(name):
    bodies, q, field = SYSTEMS[name]()
    equations = derivation(bodies, q, field=field)
    at = numbers((*q, *equations.velocities, equations.t, *equations.parameters))
    M, f, L, _ = by_sympy(bodies, q, field, at)
    found = equations.graph.evaluate(equations.nodes, at)
    lower = np.tril_indices(len(q))
    assert np.allclose(found[: -len(q)], M[lower], rtol=1e-12, atol=1e-12)
    assert np.allclose(found[-len(q) :], f, rtol=1e-11, atol=1e-11)
    other = derivation_of_lagrangian(L)
    again = other.graph.evaluate(other.nodes, at)
    assert np.allclose(found, again, rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("name", SYSTEMS)
def test_another_field_is_seen(name):
    """The wrong twin: gravity of the other sign, or the quadratic terms left out."""
    bodies, q, field = SYSTEMS[name]()
    equations = derivation(bodies, q, field=[-a for a in field])
    at = numbers((*q, *equations.velocities, equations.t, *equations.parameters))
    still = dict.fromkeys(equations.velocities, 0.0)
    _, f, _, _ = by_sympy(bodies, q, field, at)
    found = np.array(equations.graph.evaluate(equations.f, at if field else {**at, **still}))
    assert not np.allclose(found, f, rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize("name", SYSTEMS)
def test_hamiltons_equations(name):
    """p = M q̇ + b, ṗ = ∂L/∂q, H = Σ p q̇ − L against SymPy, by LAPACK and by L D Lᵀ on the graph."""
    bodies, q, field = SYSTEMS[name]()
    equations = canonical_derivation(bodies, q, field=field)
    at = numbers((*q, *equations.velocities, equations.t, *equations.parameters), seed=3)
    _, _, L, here = by_sympy(bodies, q, field, at)
    p = np.array([float(e.xreplace(here)) for e in L.momenta])
    v = np.array([at[s] for s in equations.velocities])
    p_dot = np.array([float(L.L.diff(s).xreplace(here)) for s in q])
    H = float(L.jacobi_energy.xreplace(here))
    place = [at[s] for s in q]
    values = {s: at[s] for s in equations.parameters}
    rates = hamilton_function(equations, values)(place, p, at[time])
    assert np.allclose(rates[0], v, rtol=1e-10, atol=1e-10)
    assert np.allclose(rates[1], p_dot, rtol=1e-10, atol=1e-10)
    assert energy_function(equations, values)(place, p, at[time]) == pytest.approx(H, rel=1e-10)
    canonical = {s: at[s] for s in (*q, equations.t, *equations.parameters)} | dict(
        zip(equations.p, p, strict=True)
    )
    explicit = equations.graph.evaluate(
        [*equations.q_dot, *equations.explicit_p_dot, equations.hamiltonian], canonical
    )
    assert np.allclose(explicit, [*v, *p_dot, H], rtol=1e-9, atol=1e-9)
    assert not np.allclose(rates[1], -p_dot, rtol=1e-2)


@pytest.mark.parametrize("name", SYSTEMS)
def test_handed_back_as_sympy_objects(name):
    """Replacements, M and f give the graph's numbers; every replacement uses earlier symbols only."""
    bodies, q, field = SYSTEMS[name]()
    equations = derivation(bodies, q, field=field)
    replacements, M, f = equations.to_sympy()
    at = numbers((*q, *equations.velocities, equations.t, *equations.parameters), seed=7)
    values = {s: sp.Float(value, 30) for s, value in at.items()}
    for symbol, expression in replacements:
        assert expression.free_symbols <= set(values)
        values[symbol] = expression.xreplace(values)
    found = [M[i, j] for i in range(len(q)) for j in range(i + 1)] + list(f)
    expected = equations.graph.evaluate(equations.nodes, at)
    given = [float(sp.sympify(e).xreplace(values)) for e in found]
    assert np.allclose(given, expected, rtol=1e-10, atol=1e-10)
    assert M == M.T
    assert not np.allclose(given, [-e for e in expected], rtol=1e-3)


def test_shared_names_pass_over_those_in_use():
    graph = Graph()
    x0, x1 = sp.symbols("x0 x1")
    f = sp.sin(x0 * x1)
    replacements, (again, square) = shared_to_sympy(graph, [graph.from_sympy(f), graph.from_sympy(f**2)])
    ((symbol, value),) = replacements
    assert (symbol.name, value) == ("x2", f)
    assert (again, square) == (symbol, symbol**2)


def test_acceleration_function_solves():
    bodies, q, field = planar_pendulum(4)
    equations = derivation(bodies, q, field=field)
    at = numbers((*q, *equations.velocities, *equations.parameters), seed=5)
    found = acceleration_function(equations, at)(
        [at[s] for s in q], [at[s] for s in equations.velocities], 0.0
    )
    M, f, _, _ = by_sympy(bodies, q, field, at)
    assert np.allclose(M @ found, f, rtol=1e-11)
    with pytest.raises(KeyError, match="no number for m3"):
        acceleration_function(equations, {s: a for s, a in at.items() if s.name != "m3"})


def test_singular_and_infinite_points_are_refused():
    """Spherical coordinates at the pole, and a start that is not a number."""
    bodies, q, field = spherical_chain(1)
    equations = derivation(bodies, q, field=field)
    accelerations = acceleration_function(equations, dict.fromkeys(equations.parameters, 1.0))
    assert np.isfinite(accelerations([0.5, 0.0], [0.0, 1.0], 0.0)).all()
    with pytest.raises(ArithmeticError, match="mass matrix is singular at this point"):
        accelerations([0.0, 0.0], [0.0, 1.0], 0.0)
    with pytest.raises(ArithmeticError, match="not finite"):
        accelerations([0.5, 0.0], [float("nan"), 1.0], 0.0)


def test_a_rod_without_thickness_moves_as_two_particles():
    """Its moment of inertia about its own axis is zero: half the mass at each of ±d along it."""
    m, g, d = parameters("m g d", positive=True)
    a, b = coordinates("alpha beta")
    turned = euler_rotation(a, b, sp.S.Zero)
    axis = turned[:, 2]
    inertia = sp.diag(m * d**2, m * d**2, 0)
    systems = {
        "rod": [RigidBody(m, tuple(1.5 * axis), inertia, turned)],
        "pair": [Particle(m / 2, tuple((1.5 + s * d) * axis)) for s in (1, -1)],
        "longer pair": [Particle(m / 2, tuple((1.5 + 2 * s * d) * axis)) for s in (1, -1)],
    }
    rod, pair, longer = (
        acceleration_function(derivation(bodies, (a, b), field=(0, 0, -g)), {m: 2, g: 9, d: 0.3})(
            [0.4, 1.1], [0.3, -0.2], 0.0
        )
        for bodies in systems.values()
    )
    assert np.allclose(rod, pair, rtol=1e-13)
    assert not np.allclose(rod, longer, rtol=1e-2)


def test_a_body_that_does_not_turn_has_no_inertia():
    inertia = parameters("J", positive=True)
    angles = {sp.pi / 3: {m, w}, y: {m, w, inertia}, time: {m, w}, c * time**2: {m, w}}
    for angle, expected in angles.items():
        block = PlanarBody(m, (x, x**2), inertia, angle)
        equations = derivation([block], (x, y) if angle == y else (x,), field=(0, -w))
        assert set(equations.parameters) == expected, angle


def test_a_place_with_a_kink_has_no_force_beside_it():
    """Of |x| the velocity is sign(x) ẋ and its slope zero: gravity along |x| pulls to the kink from both sides."""
    fall = derivation([Particle(m, (sp.Abs(x), y))], (x, y), field=(-w, 0))
    accelerations = acceleration_function(fall, {m: 2, w: 10})
    for place in (-0.5, 0.5):
        assert accelerations([place, 1.0], [1.0, 1.0], 0.0) == pytest.approx([-10 * np.sign(place), 0])
    canonical = canonical_derivation([Particle(m, (sp.Abs(x), y))], (x, y), field=(-w, 0))
    velocity, force = hamilton_function(canonical, {m: 2, w: 10})([-0.5, 1.0], [3.0, 4.0], 0.0)
    assert [*velocity, *force] == pytest.approx([1.5, 2, 20, 0])


def test_a_place_by_a_function_without_an_operation_is_refused_by_its_name():
    with pytest.raises(NotModelledError, match=r"besselj in besselj\(0, x\) has no operation"):
        derivation([Particle(m, (sp.besselj(0, x), y))], (x, y))


def test_a_long_chain_conserves_its_energy():
    """Twenty links: dH/dt = Σ ∂H/∂q q̇ + ∂H/∂p ṗ vanishes to round-off, and not if a link's mass is changed."""
    bodies, q, field = planar_pendulum(20)
    equations = canonical_derivation(bodies, q, field=field)
    values = numbers(equations.parameters, seed=9)
    chance = np.random.default_rng(1)
    place, p = chance.uniform(-1, 1, 20), chance.uniform(-1, 1, 20)
    H = energy_function(equations, values)

    def change(rates, h=1e-6):
        q_dot, p_dot = rates(place, p, 0.0)
        return (H(place + h * q_dot, p + h * p_dot, 0) - H(place - h * q_dot, p - h * p_dot, 0)) / (2 * h)

    assert abs(change(hamilton_function(equations, values))) < 1e-5
    other = values | {next(s for s in values if s.name == "m7"): 3.0}
    assert abs(change(hamilton_function(equations, other))) > 1e-2


def test_potentials_and_forces_enter():
    bodies, q, V = spring_chain(4)
    equations = derivation(bodies, q, V, forces=[-c * q[0].dot, 0, 0, 0])
    expected = lagrangian_of_bodies(bodies, q, V, forces=[-c * q[0].dot, 0, 0, 0])
    for node, bias in zip(equations.f, expected.bias, strict=True):
        assert vanishes(equations.graph.to_sympy(node) + bias).holds
    assert vanishes(equations.graph.to_sympy(equations.f[0]) - expected.bias[0]).fails
    with pytest.raises(ValueError, match="1 generalized force for 4"):
        derivation(bodies, q, V, forces=[0])
    with pytest.raises(ValueError, match="a field of 2 components"):
        derivation(bodies, q, V, field=(0, -1))


def test_n_body_forces():
    bodies, q, V = n_body(4)
    equations = derivation(bodies, q, V)
    at = numbers((*q, *equations.parameters), seed=2)
    here = {s: sp.Float(value, 40) for s, value in at.items()}
    found = equations.graph.evaluate(equations.f, at)
    assert np.allclose(found, [-float(V.diff(s).xreplace(here)) for s in q], rtol=1e-12)
    assert all(equations.M[i][j] == equations.graph.zero for i in range(12) for j in range(i))


def test_operations_grow_as_entries_do():
    """Shared sums: M takes at most 5 operations an entry, f a number of operations per link."""
    counts = {n: derivation(*planar_pendulum(n)[:2], field=(0, -1)).operations for n in (5, 10, 20)}
    for n, count in counts.items():
        assert count < 5 * n * (n + 1) / 2 + 25 * n


@settings(max_examples=60, deadline=None)
@given(st.lists(st.lists(st.integers(0, 6), min_size=0, max_size=7, unique=True), min_size=1, max_size=8))
def test_shared_sums_are_sums(families):
    graph = Graph()
    symbols = sp.symbols("s:7")
    nodes = [graph.symbol(s) for s in symbols]
    sums = SharedSums(graph)
    values = {s: 2.0**i for i, s in enumerate(symbols)}
    for family in families:
        (found,) = graph.evaluate([sums.of(tuple(nodes[i] for i in family))], values)
        assert found == sum(2**i for i in family)


def test_heads_and_tails_take_one_addition_each():
    for order in (lambda n: range(1, n + 1), lambda n: range(n, 0, -1)):
        graph = Graph()
        nodes = tuple(graph.symbol(s) for s in sp.symbols("s:30"))
        sums = SharedSums(graph)
        before = len(graph.nodes)
        for end in order(30):
            sums.of(nodes[30 - end :])
        assert len(graph.nodes) - before <= 32


POINTS = st.floats(0.2, 2.0)


@settings(max_examples=50, deadline=None)
@given(a=POINTS, b=POINTS)
def test_python_source_is_what_the_graph_evaluates(a, b):
    graph = Graph()
    u, v = sp.symbols("u v", positive=True)
    expressions = [
        u**2 / v - sp.sqrt(u * v) + sp.sin(u) * sp.exp(-v),
        (u + v) ** sp.Rational(-3, 2) + sp.atan2(u, v) * sp.pi,
        sp.tanh(u) + sp.asinh(v) ** 3 - sp.log(u + v) / 7,
        u**v + sp.Abs(u - v) + sp.sign(u - v) * sp.E,
        sp.Integer(3),
    ]
    nodes = [graph.from_sympy(e) for e in expressions]
    found = python_function(graph, nodes, [u, v])((a, b))
    assert found == pytest.approx(graph.evaluate(nodes, {u: a, v: b}), rel=1e-13)
    assert found[:4] == pytest.approx([float(e.subs({u: a, v: b})) for e in expressions[:4]], rel=1e-11)


def test_python_source_refuses_what_has_no_value():
    graph = Graph()
    with pytest.raises(KeyError, match="no value for y"):
        python_function(graph, [graph.from_sympy(x * y)], [x])
    assert python_function(graph, [graph.zero], [])(()) == (0.0,)


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 6), st.integers(0, 10**6))
def test_factorisation_solves(n, seed):
    chance = np.random.default_rng(seed)
    A = chance.uniform(-1, 1, (n, n))
    A = A @ A.T + n * np.eye(n)
    graph = Graph()
    symbols = {(i, j): sp.Symbol(f"a{i}_{j}") for i in range(n) for j in range(i + 1)}
    b = sp.symbols(f"b:{n}")
    nodes = [[graph.symbol(symbols[i, j]) for j in range(i + 1)] for i in range(n)]
    solution = solved_on_graph(graph, nodes, [graph.symbol(s) for s in b])
    right = chance.uniform(-1, 1, n)
    values = {s: A[place] for place, s in symbols.items()} | dict(zip(b, right, strict=True))
    assert np.allclose(A @ graph.evaluate(solution, values), right, rtol=1e-10, atol=1e-10)


def test_a_zero_pivot_is_refused():
    graph = Graph()
    with pytest.raises(ZeroDivisionError, match="pivot 1"):
        solved_on_graph(graph, [[graph.zero]], [graph.one])


def test_the_first_calls_and_the_compiled_ones_are_equal_to_the_last_bit():
    """Many nodes: the first calls walk over the graph, later ones run compiled text."""
    bodies, q, field = planar_pendulum(9)
    equations = derivation(
        bodies, q, V=sp.sqrt(1 + (q[0] - q[1]) ** 2) ** 3 / (2 + q[2] ** 4) ** 2, field=field
    )
    assert len(equations.graph.reachable(equations.nodes)) > 300
    inputs = (*q, *equations.velocities, *equations.parameters)
    function = python_function(equations.graph, equations.nodes, inputs)
    point = np.random.default_rng(1).uniform(0.2, 1.4, len(inputs)).tolist()
    values = [function(point) for _ in range(12)]
    assert all(value == values[0] for value in values)
    assert function(point[::-1]) != values[0]
    exact = equations.graph.evaluate(equations.nodes, dict(zip(inputs, point, strict=True)))
    assert np.allclose(values[0], np.array(exact, dtype=float), rtol=1e-13, atol=1e-13)


def mass_matrix(system):
    bodies, q, field = system
    equations = derivation(bodies, q, field=field)
    rows = [[equations.graph.to_sympy(node) for node in row] for row in equations.M]
    return equations, rows


def test_mass_matrices_look_as_in_the_textbook():
    """cos² + sin² = 1 is used where slopes depend on the same angles: exact zeros, constant diagonals."""
    equations, rows = mass_matrix(heavy_top())
    theta = equations.q[0]
    m, l, I1, I3 = sp.symbols("m l I1 I3", positive=True)
    s, c = sp.sin(theta), sp.cos(theta)
    assert rows[0] == [I1 + m * l**2]
    assert rows[1] == [0, I1 * s**2 + I3 * c**2 + m * l**2 * s**2]
    assert rows[2] == [0, I3 * c, I3]
    assert equations.operations < 150
    _, rows = mass_matrix(spherical_chain(1))
    assert rows[1][0] == 0
    assert rows[0][0] == m * l**2
    _, rows = mass_matrix(planar_pendulum(3))
    assert not any(row[-1].has(sp.sin, sp.cos) for row in rows)
    assert all(entry.has(sp.sin, sp.cos) for row in rows for entry in row[:-1])


def test_operations_beside_those_of_lagranges_method():
    """431 and 1595 operations of M and f remain of LagrangesMethod's after CSE at 5 and 10 links (SymPy 1.14)."""
    for n, theirs, share in ((5, 431, 3), (10, 1595, 4)):
        bodies, q, field = planar_pendulum(n)
        replacements, M, f = derivation(bodies, q, field=field).to_sympy()
        lower = [M[i, j] for i in range(n) for j in range(i + 1)]
        ours = sum(sp.count_ops(e) for e in (*(e for _, e in replacements), *lower, *f))
        assert ours * share <= theirs
        assert ours >= 3 * n * (n - 1) // 2
