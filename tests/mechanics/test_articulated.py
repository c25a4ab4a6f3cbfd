"""Accelerations along the tree of velocities, beside M q̈ = f with the whole matrix."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from canon import Lagrangian, coordinates
from canon.expression.graph.graph import Graph
from canon.expression.symbols.symbol import time
from canon.mechanics.at_scale.articulated import tree_of_sums
from canon.mechanics.at_scale.articulated_lagrangian import articulated_lagrangian
from canon.mechanics.at_scale.kinetic_terms import Channel, Reader
from canon.mechanics.at_scale.numeric_functions import acceleration_function
from canon.mechanics.at_scale.second_order import derivation_of_lagrangian
from canon.mechanics.at_scale.squares_of_velocities import squares_of_velocities


def linkage(parents, numbering, *, rods=False, moved=sp.S.Zero):
    """Links in a plane: each hangs on an earlier one, or on a pivot that moves; angles numbered as is said."""
    angles = coordinates(f"theta:{len(parents)}")
    ends, T, V = {-1: (moved.diff(time), sp.S.Zero, sp.S.Zero)}, [], []
    for k, (parent, number) in enumerate(zip(parents, numbering, strict=True)):
        a, m = angles[number], sp.Rational(k + 2, 3)
        vx, vy, height = ends[parent]
        share = sp.Rational(1, 2) if rods else sp.S.One
        at = [v + share * s * a.dot for v, s in ((vx, sp.cos(a)), (vy, sp.sin(a)))]
        T.append(m * (at[0] ** 2 + at[1] ** 2) / 2 + (m * a.dot**2 / 24 if rods else 0))
        V.append(m * (height - share * sp.cos(a)))
        ends[k] = (vx + sp.cos(a) * a.dot, vy + sp.sin(a) * a.dot, height - sp.cos(a))
    return T, V, angles


def accelerations(lagrangian, state):
    """Return q̈ along the tree, and by the whole matrix."""
    n = len(lagrangian.q)
    values = dict(zip((*lagrangian.q, *lagrangian.velocities), state, strict=True)) | {time: 0.7}
    chain = articulated_lagrangian(lagrangian)
    whole = acceleration_function(derivation_of_lagrangian(lagrangian), {})(state[:n], state[n:], 0.7)
    return np.array(chain.graph.evaluate(chain.accelerations, values), dtype=float), whole


@st.composite
def linkages(draw):
    n = draw(st.integers(7, 10))
    parents = [draw(st.integers(max(-1, k - 2), k - 1)) for k in range(n)]
    numbering = draw(st.permutations(range(n)))
    moved = draw(st.sampled_from((sp.S.Zero, sp.sin(2 * time))))
    T, V, angles = linkage(parents, numbering, rods=draw(st.booleans()), moved=moved)
    state = draw(st.lists(st.floats(-2, 2), min_size=2 * n, max_size=2 * n))
    return Lagrangian(sp.Add(*T) - sp.Add(*V), list(angles)), state


@given(linkages())
@settings(max_examples=50, deadline=None)
def test_trees_of_links_accelerate_as_the_whole_matrix_says(case):
    lagrangian, state = case
    assume(articulated_lagrangian(lagrangian) is not None)  # they share enough
    along, whole = accelerations(lagrangian, state)
    assert np.allclose(along, whole, rtol=1e-9, atol=1e-9 * np.abs(whole).max())


def chain(n, **how):
    T, V, angles = linkage([*range(-1, n - 1)], range(n), **how)
    return Lagrangian(sp.Add(*T) - sp.Add(*V), list(angles))


@pytest.mark.parametrize("rods", [False, True])
def test_operations_grow_as_the_links(rods):
    def nodes(n):
        found = articulated_lagrangian(chain(n, rods=rods))
        return len(found.graph.reachable(found.accelerations))

    few, more, most = map(nodes, (10, 20, 40))
    assert abs(most - more - 2 * (more - few)) <= 2


def test_what_is_no_square_of_a_velocity_has_its_share():
    """A magnetic term, a mass that depends on the place, forces, and a pivot that moves."""
    T, V, q = linkage([*range(-1, 7)], range(8), moved=sp.cos(time))
    more = q[0] ** 3 * q[2].dot + sp.exp(q[1]) * q[3].dot ** 2 + q[4].dot * q[5].dot / 3
    L = Lagrangian(sp.Add(*T) - sp.Add(*V) + more, list(q), forces=[-k * x.dot for k, x in enumerate(q)])
    along, whole = accelerations(L, np.linspace(-1, 1.2, 16))
    assert np.allclose(along, whole, rtol=1e-11)


def test_momenta_and_energy_are_those_of_the_lagrangian():
    T, V, q = linkage([*range(-1, 6)], range(7), moved=sp.cos(time))
    L = Lagrangian(sp.Add(*T) - sp.Add(*V) + q[0] ** 3 * q[2].dot, list(q))
    found = articulated_lagrangian(L)
    values = dict(zip((*L.q, *L.velocities), np.linspace(0.3, 1.1, 14), strict=True)) | {time: 0.7}
    momenta = [sp.diff(L.L, v) for v in L.velocities]
    energy = sum(v * p for v, p in zip(L.velocities, momenta, strict=True)) - L.L
    due = sp.lambdify([[*values]], [*momenta, energy])([*values.values()])
    assert np.allclose(
        np.array(found.graph.evaluate((*found.momenta, found.energy), values), dtype=float), due, rtol=1e-13
    )


def test_the_mass_matrix_is_that_of_the_lagrangian():
    L = chain(7, rods=True)
    q = L.q
    more = Lagrangian(L.L + sp.exp(q[1]) * q[3].dot ** 2 + q[4].dot * q[5].dot / 3, q)
    found = articulated_lagrangian(more)
    values = dict(zip(q, np.linspace(0.3, 1.1, 7), strict=True))
    due = np.array(sp.lambdify([[*values]], sp.hessian(more.L, more.velocities))([*values.values()]))
    nodes = [node for row in found.mass_matrix() for node in row]
    assert np.allclose(
        np.array(found.graph.evaluate(nodes, values), dtype=float).reshape(7, 7), due, rtol=1e-14
    )
    assert np.allclose(found.masses_at(values), due, rtol=1e-14)


def test_angles_from_link_to_link_accelerate_alike():
    turns = coordinates("phi:8")
    T, vx, vy = [], sp.S.Zero, sp.S.Zero
    for k in range(8):
        angle, rate = sp.Add(*turns[: k + 1]), sp.Add(*(s.dot for s in turns[: k + 1]))
        vx, vy = vx + sp.cos(angle) * rate, vy + sp.sin(angle) * rate
        T.append((sp.expand(vx) ** 2 + sp.expand(vy) ** 2) / 2)
    L = Lagrangian(sp.Add(*T), list(turns))
    assert np.allclose(*accelerations(L, np.linspace(-1, 1, 16)), rtol=1e-9)


def test_where_little_is_shared_the_mass_matrix_is_solved():
    free = coordinates("x:7")
    assert articulated_lagrangian(Lagrangian(sum(s.dot**2 for s in free), free)) is None
    assert articulated_lagrangian(chain(5)) is None


def test_a_coordinate_without_mass_has_no_pivot():
    graph = Graph()
    tree = tree_of_sums(graph, [Channel(graph.one, ((0, graph.one),))])
    with pytest.raises(ZeroDivisionError, match="the pivot of coordinate 2 is 0"):
        tree.solved([graph.one, graph.one], {})


def test_a_spring_takes_the_place_of_a_mass_that_is_missing():
    """M = [[m + k, m], [m, m]] along a chain whose first body has no mass, and a body that stands still beside it."""
    graph, (m, k, force) = Graph(), sp.symbols("m k F", positive=True)
    mass, stiffness, push, one = *map(graph.symbol, (m, k, force)), graph.one
    chain = [Channel(graph.zero, ((0, one),)), Channel(mass, ((0, one), (1, one))), Channel(mass, ())]
    tree = tree_of_sums(graph, chain)
    assert tree.terms == 2
    found = tree.solved([push, graph.zero], {(0, 0): stiffness, (1, 0): graph.zero})
    assert [sp.simplify(graph.to_sympy(a)) for a in found] == [force / k, -force / k]


@pytest.mark.parametrize(
    ("term", "squares"),
    [
        ("m*(u + w)**2/2", 1),
        ("m*x**2*w**2/2", 1),
        ("m*(u**2 + (u + x*w)**2)/2", 2),
        ("m*(2*(u + w) + sin(x)*(u - w))**2", 1),
        ("m*x*w**2/2", 0),
        ("m*u*w", 0),
        ("m*(u*w + 1)**2", 0),
        ("m*(u**2 + u*w)", 0),
        ("sqrt(u**2 + w**2)", 0),
        ("x**2", 0),
    ],
)
def test_squares_of_velocities_are_found(term, squares):
    """What was found and what is left add up to the whole."""
    x, y = coordinates("x y")
    m = sp.Symbol("m", positive=True)
    L = sp.sympify(term, {"x": x, "u": x.dot, "w": y.dot, "m": m})
    reader = Reader(Graph(), (x, y), time)
    found = squares_of_velocities(reader, L)
    assert len(found.channels) == squares
    shown, v = reader.graph.to_sympy, (x.dot, y.dot)
    speeds = [
        sum(shown(a) * v[i] for i, a in c.slopes) + (shown(c.rest) if c.rest else 0) for c in found.channels
    ]
    again = sum((shown(c.weight) * u**2 / 2 for c, u in zip(found.channels, speeds, strict=True)), found.rest)
    assert sp.expand(again - L) == 0
