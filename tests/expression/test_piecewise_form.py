"""Piecewise functions written with signs and moduli: values in pieces and on borders, and roots elsewhere."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian, coordinates, propagate
from canon.expression.graph.graph import Graph
from canon.expression.graph.piecewise_form import without_pieces

u, v = sp.symbols("u v", real=True)
ROOT = sp.sqrt(u)
FUNCTIONS = [
    sp.Piecewise((sp.sqrt(u**2 + 1), u > 0), (u, True)),
    sp.Piecewise((1, sp.Eq(u, 0)), (sp.sin(u) / u, True)),
    sp.Piecewise((u, sp.Ne(u, 0)), (2, True)),
    sp.Piecewise((u, sp.Not(u > 0, evaluate=False)), (2 * u, True)),
    sp.Piecewise((u, (u > 0) & (u < 1)), (2, True)),
    sp.Piecewise((u, (u < 0) | (u > 1)), (2, True)),
    sp.Piecewise((ROOT * sp.sqrt(1 - u), (u > 0) & (u < 1)), (u, True)),
    sp.Piecewise((1, (u < 0) | (v < 0)), (ROOT * v ** sp.Rational(3, 2), True)),
    sp.Piecewise((0, u < 0), (ROOT, u < 1), (2 - u, True)),
    sp.Piecewise((0, u < 0), (ROOT, u >= 0)),
    sp.Piecewise((sp.sqrt(-u), u < 0), (ROOT, u < 1), (sp.sqrt(u - 1), True)),
]
PLACES = (-2.0, -0.25, 0.25, 0.75, 1.5, 3.0)


@pytest.mark.parametrize("function", FUNCTIONS)
def test_the_value_is_that_of_the_piece_which_holds(function: sp.Expr) -> None:
    graph = Graph()
    node = graph.from_sympy(without_pieces(function))
    for at, other in itertools.product(PLACES, (-1.5, 2.0)):
        found = graph.evaluate([node], {u: at, v: other})[0]
        assert found == pytest.approx(float(function.subs({u: at, v: other})), rel=1e-14, abs=1e-15)


@pytest.mark.parametrize("condition", [sp.Symbol("b"), sp.Contains(u, sp.Interval(0, 1), evaluate=False)])
def test_a_condition_that_is_no_inequality_is_told(condition: sp.Basic) -> None:
    with pytest.raises(ValueError, match=r"is no inequality: write it with <, >, & and \|"):
        without_pieces(sp.Piecewise((u, condition), (2, True)))


@pytest.mark.parametrize("inner_first", [False, True])
def test_a_motion_may_start_where_the_root_of_another_piece_has_no_value(inner_first: bool) -> None:
    x = coordinates("x")
    soft, free = sp.Rational(2, 5) * x ** sp.Rational(5, 2), (sp.S.Zero, x <= 0)
    pieces = [(soft, (x > 0) & (x < 1)), free] if inner_first else [free, (soft, x < 1)]
    wall = sp.Piecewise(*pieces, (x - sp.Rational(3, 5), True))
    motion = propagate(Hamiltonian(x.momentum**2 / 2 + wall, [x], [x.momentum]), (0, 10), [-1, 0.51])
    assert abs(motion.energy_error).max() < 1e-14
    before = motion.t < 1.9
    np.testing.assert_allclose(motion.y[0][before], 0.51 * motion.t[before] - 1, rtol=0, atol=1e-14)
    turning = (5 / 4 * 0.51**2) ** 0.4  # where 2/5 x^(5/2) is the energy
    assert turning - 1e-4 < motion.y[0].max() <= turning
    assert motion.y[1][-1] == pytest.approx(-0.51, abs=1e-13)


@pytest.mark.parametrize(
    ("function", "mean"),
    [
        (sp.Piecewise((8, (u > 0) & (u < 1)), (2, u <= 0), (32, True)), {0: 5, 1: 20}),
        (sp.Piecewise((2, u <= 0), (8, u < 1), (32, True)), {0: 5, 1: 20}),
        (sp.Piecewise((32, (u < 0) | (u > 1)), (2, (u >= 0) & (u <= 1)), (8, True)), {0: 17, 1: 17}),
        (sp.Piecewise((8, (u > 0) & (u < 1)), (2, (u <= 0) & (v > 0)), (32, True)), {0: 5, 1: 20}),
    ],
)
def test_on_a_border_between_two_pieces_the_value_is_their_mean(
    function: sp.Expr, mean: dict[int, int]
) -> None:
    written = without_pieces(function)
    assert {at: written.subs({u: at, v: 1}) for at in mean} == mean
    for at in PLACES:
        assert written.subs({u: at, v: 1}) == function.subs({u: at, v: 1})


def test_a_sample_on_a_border_has_the_energy_of_the_motion() -> None:
    x = coordinates("x")
    soft = sp.Rational(2, 5) * x ** sp.Rational(5, 2)
    wall = sp.Piecewise((soft, (x > 0) & (x < 1)), (0, x <= 0), (x - sp.Rational(3, 5), True))
    motion = propagate(Hamiltonian(x.momentum**2 / 2 + wall, [x], [x.momentum]), (0, 4), [-1, 0.5], samples=8)
    assert motion.y[0][4] == 0
    assert abs(motion.energy_error).max() < 1e-14
