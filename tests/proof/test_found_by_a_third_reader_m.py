"""What a third reader suspected of proofs and session 34 saw: sums over rows in matrices, powers beyond any budget."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import pytest
import sympy as sp
from sympy import Eq, Matrix, sqrt, symbols

from canon.mechanics import row_sum
from canon.proof.domain.domain import Domain
from canon.proof.equivalence import equivalent_equations
from canon.proof.trees.polynomial import MOST_TERMS, polynomial_factors, terms_at_most
from canon.proof.vanish import equal, vanishes

if TYPE_CHECKING:
    from sympy.logic.boolalg import Boolean

ROW = symbols("x0:20", real=True)
SUM = row_sum(lambda s: s**2, ROW)
WRITTEN = sp.Add(*(s**2 for s in ROW))
u, x, y, z, w = symbols("u x y z w", real=True)


def test_sums_over_rows_are_written_out_in_matrices_and_systems() -> None:
    assert vanishes(Matrix([SUM - WRITTEN])).holds
    assert equal(Matrix([SUM, x]), Matrix([WRITTEN, x])).holds
    assert equal(Matrix([SUM, x]), Matrix([2 * WRITTEN, x])).fails
    assert equivalent_equations([u - SUM], [u - WRITTEN], [u]).holds
    assert equivalent_equations([u - SUM], [u - 2 * WRITTEN], [u]).fails


@pytest.mark.parametrize(
    "condition", [Eq((1 + x) ** 100_000, 2), Eq((x + y + z + w) ** 60, 1), (1 + x) ** 100_000 >= 2]
)
def test_large_powers_in_a_domain_end_within_the_budget(condition: Boolean) -> None:
    begun = time.process_time()
    assert not vanishes(x - y, Domain((condition,)), budget=1.0).holds
    assert time.process_time() - begun < 5.0


def test_both_sides_of_a_large_power() -> None:
    long = (x + y + z + w) ** 60
    begun = time.process_time()
    assert not vanishes(sqrt(x**2) - x, Domain((long >= 1, long <= 1)), budget=1.0).holds
    assert time.process_time() - begun < 5.0


def test_what_would_be_long_stays_whole_as_a_factor() -> None:
    long = (x + y + z + w) ** 60 - 1
    assert terms_at_most(long) > MOST_TERMS
    assert polynomial_factors(x * long) == [(x, 1), (long, 1)]
    short = (x + y) ** 5 - (x - y) ** 5
    assert terms_at_most(short) == 12
    assert sp.expand(sp.Mul(*(f**n for f, n in polynomial_factors(short))) * 2 - short) == 0
