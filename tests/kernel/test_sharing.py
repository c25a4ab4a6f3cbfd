"""Equations written with fewer products of functions: the same functions, and never more products."""

import random
from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.expression.graph.graph import Graph
from canon.expression.graph.number_systems import multiprecision
from canon.expression.symbols.symbol import time
from canon.kernel.program.hamilton_equations import equations, exact_numbers
from canon.kernel.program.program import program
from canon.kernel.program.shared_products import with_shared_products
from canon.scene import find
from tests.kernel.test_rolled import chain

SYMBOLS = sp.symbols("x y z", positive=True)


def products(graph, nodes, inputs):
    """Count products and quotients of two functions."""
    steps = program(graph, nodes, inputs)

    def is_constant(register):
        return steps.instructions[register].operation == "constant"

    return sum(
        operation in ("mul", "div") and not any(map(is_constant, operands))
        for operation, operands, _ in steps.instructions
    )


def grown(seed):
    """Return a graph and functions in it that share parts: sums, products, powers and quotients at random."""
    choose, graph = random.Random(seed), Graph()
    made = [*map(graph.symbol, SYMBOLS), graph.number(Fraction(1, 3)), graph.named("pi")]
    for _ in range(choose.randrange(4, 30)):
        some = [choose.choice(made) for _ in range(choose.randrange(2, 5))]
        kind = choose.choice(["add", "mul", "mul", "pow", "sin", "scaled"])
        if kind == "add":
            made.append(graph.add(some))
        elif kind == "mul":
            made.append(graph.mul(some))
        elif kind == "pow":
            made.append(graph.power(some[0], choose.choice([-3, -2, -1, 2, 3])))
        elif kind == "sin":
            made.append(graph.add([graph.number(2), graph.function("sin", some[0])]))
        else:
            made.append(graph.scaled(choose.choice([1, 2, 3]), some[0]))
    return graph, made[-choose.randrange(1, 8) :]


@settings(deadline=None, max_examples=200)
@given(st.integers(0, 10**6))
def test_the_functions_stay_the_same(seed):
    """Everything is positive here, so that no cancellation hides a difference, nor makes one."""
    graph, nodes = grown(seed)
    arithmetic = multiprecision(60)
    values = (Fraction(7, 10), Fraction(13, 10), Fraction(4, 5))
    at = dict(zip(SYMBOLS, map(arithmetic.number, values), strict=True))
    before = graph.evaluate(nodes, at, arithmetic)
    after = graph.evaluate(with_shared_products(graph, nodes), at, arithmetic)
    for old, new in zip(before, after, strict=True):
        assert abs(old - new) <= abs(old) * arithmetic.number(Fraction(1, 10**25))


@pytest.mark.parametrize(
    ("scene", "before", "after"),
    [
        # p₁ cos, cos², w = (p₂ − a p₁ cos)/(1 − k cos²), w cos, and w (b p₁ − c w cos) sin
        ("double-pendulum", 11, 6),
        ("triple-pendulum", 42, 27),
        ("lagrange-top", 29, 19),
        ("kovalevskaya-top", 28, 20),
        ("kepler", 5, 5),
        ("henon-heiles", 3, 3),
        ("toda-6", 0, 0),
        ("outer-solar-system", 108, 105),
    ],
)
def test_fewer_products_where_there_is_something_to_share(scene, before, after):
    known = find(scene)
    whole = known.hamiltonian
    system = equations(whole.H, whole.q, whole.p, sp.Symbol("t"), exact_numbers(known.values))
    written = (*system.velocity, *system.force)
    counts = [products(system.graph, nodes, system.inputs) for nodes in (written, system.rates)]
    assert counts == [before, after]


def test_a_pendulums_equations_have_one_quotient():
    """N²/D², N/D, and N c/D of H's gradient are the square and multiples of one N/D."""
    N, D, c = SYMBOLS
    graph = Graph()
    nodes = [graph.from_sympy(each) for each in (N / D, N * c / D, N**2 * c / D**2)]
    steps = program(graph, with_shared_products(graph, nodes), SYMBOLS)
    assert steps.count("div") == 1
    assert steps.count("mul") == 2


def test_terms_with_a_factor_in_common_share_it():
    x, y, z = SYMBOLS
    graph = Graph()
    shared = with_shared_products(graph, [graph.from_sympy(x * y + 3 * x * z + z)])
    assert sp.simplify(graph.to_sympy(shared[0]) - (x * (y + 3 * z) + z)) == 0
    assert products(graph, shared, SYMBOLS) == 1


def sums(graph, nodes, inputs):
    steps = program(graph, nodes, inputs)
    return steps.count("add") + steps.count("sub")


def test_sums_share_the_terms_they_have_in_common_up_to_a_constant():
    x, y, z = SYMBOLS
    graph = Graph()
    nodes = [graph.from_sympy(each) for each in (x + 2 * y, 3 * x + 6 * y + z, x - 2 * y)]
    assert sums(graph, nodes, SYMBOLS) == 4
    assert sums(graph, with_shared_products(graph, nodes), SYMBOLS) == 3


def test_a_chains_forces_compute_each_bond_once():
    """d = b − a, d + d²/4, and the difference of two neighbours: three sums a mass, not five."""
    counts = []
    for n in (12, 22):
        q, H = chain(n)
        system = equations(H, q, tuple(s.momentum for s in q), time, {})
        counts.append([sums(system.graph, nodes, system.inputs) for nodes in (system.force, system.rates)])
    assert [(long - short) / 10 for short, long in zip(*counts, strict=True)] == [5, 3]


def test_products_that_are_equal_once_multiplied_out_are_added():
    graph = Graph()
    x, y, z = map(graph.symbol, SYMBOLS)
    nested = graph.plain_mul([x, graph.plain_mul([y, z])])
    node = graph.plain_add([nested, graph.plain_mul([x, y, z]), x])
    other = graph.plain_add([nested, graph.scaled(2, x)])
    shared = with_shared_products(graph, [node, other])
    a, b, c = SYMBOLS
    assert [sp.expand(graph.to_sympy(each)) for each in shared] == [2 * a * b * c + a, a * b * c + 2 * a]


def test_a_factor_is_not_taken_out_where_that_saves_nothing():
    x, y, _ = SYMBOLS
    graph = Graph()
    (found,) = with_shared_products(graph, [graph.from_sympy(x + 2 * x * y)])
    assert graph.to_sympy(found) == x + 2 * x * y


def test_long_sums_do_not_take_long_and_do_not_recurse():
    graph = Graph()
    x, y, _ = map(graph.symbol, SYMBOLS)
    node = graph.add([x, y])
    for _ in range(5000):
        node = graph.add([graph.function("sin", node), graph.plain_mul([x, y, node])])
    shared = with_shared_products(graph, [node])
    # x y is computed once; it is one product with each sum.
    assert products(graph, shared, SYMBOLS) == 5001
