"""Sums kept as one term: what is put for a symbol in them means what it means outside."""

from __future__ import annotations

import itertools

import pytest
import sympy as sp

from canon.expression.symbols.repeated_sum import RepeatedSum, written_out

a, b = sp.Dummy("a"), sp.Dummy("b")
m, n = sp.symbols("m n", positive=True)
x = sp.symbols("x0:4", real=True)
CHAIN = RepeatedSum(m * (b - a) ** 2, [a, b], [x[:-1], x[1:]])
SQUARES = sum((q - p) ** 2 for p, q in itertools.pairwise(x))
PAIRS = RepeatedSum(m * a * b, [a, b], [x], pairs=True)


@pytest.mark.parametrize("new", [a, b, a + n, a * b])
def test_a_symbol_that_stands_for_arguments_inside_is_another_one_outside(new: sp.Expr) -> None:
    assert sp.expand(written_out(CHAIN.xreplace({m: new})) - new * SQUARES) == 0
    products = (sum(x) ** 2 - sum(each**2 for each in x)) / 2
    assert sp.expand(written_out(PAIRS.xreplace({m: new})) - new * products) == 0


def test_what_stands_for_arguments_is_not_replaced() -> None:
    assert CHAIN.xreplace({a: n}) == CHAIN
    assert sp.expand(written_out(CHAIN.xreplace({m: n, a: n})) - n * SQUARES) == 0
    assert written_out(CHAIN.xreplace({x[0]: n})).has(n)
