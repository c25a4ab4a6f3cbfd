"""Functions with pieces may vanish on one of them, and functions of a symbol that is not zero on one half-line."""

import pytest
import sympy as sp
from sympy import Abs, Matrix, Max, Piecewise, atan, pi, sign, sqrt

from canon.mechanics.algebra.linear import is_regular
from canon.proof.analytic import is_analytic
from canon.proof.continuity.continuity import continuity
from canon.proof.domain.domain import Domain
from canon.proof.equivalence import equivalent_equations
from canon.proof.kinks import vanishes_off_kinks
from canon.proof.zero_pieces import zero_piece

x, y, k, u = sp.symbols("x y k u", real=True)
n = sp.Symbol("n", real=True, nonzero=True)


@pytest.mark.parametrize(
    ("f", "domain", "found"),
    [
        (1 + sign(x), (), "x < 0"),
        (Max(x, 0), (), "x < 0"),
        (k + Abs(k), (), "k < 0"),
        (Piecewise((0, x > y), (1, True)), (), "x > y"),
        (1 + sign(x), (x > 0,), ""),
        (k + 2 * Abs(k), (), ""),
        (2 + sign(x), (), ""),
        (Abs(x) * (x - y), (), ""),
        (x * Abs(x) + y, (), ""),
        (Piecewise((x, x > y), (y, True)), (), ""),
        (sqrt(x**2 + y**2) * sign(x), (), ""),
    ],
)
def test_what_vanishes_on_a_piece_is_told_from_what_does_on_thin_sets(f, domain, found):
    assert zero_piece(f, Domain(domain)) == found


@pytest.mark.parametrize(
    ("entry", "domain", "status"),
    [
        (1 + sign(x), (), "FAILS"),
        (1 + sign(x), (x > 0,), "HOLDS"),
        (Max(x, 0), (), "FAILS"),
        (x * sqrt(1 + 1 / x**2) - sqrt(1 + x**2), (), "UNDECIDED"),
        (3 + sign(x), (), "HOLDS"),
        (Abs(x), (), "HOLDS"),
        (sign(x) * x**2 + y, (), "HOLDS"),
        (sqrt(1 + x**2) / x, (), "HOLDS"),
        (sqrt(2 * k + 1 / x - y**2 / x**2), (), "HOLDS"),
    ],
)
def test_a_matrix_is_regular_on_every_piece_or_not_called_so(entry, domain, status):
    assert is_regular(Matrix([[entry, 1], [0, 1]]), Domain(domain)).status.name == status


def test_no_piece_of_a_line_without_zero_is_left_out():
    step = atan(1 / n) + atan(n) - pi / 2  # zero for all n > 0
    assert not is_analytic([step], Domain())
    assert not is_analytic([n * sqrt(1 + 1 / n**2) - sqrt(1 + n**2)], Domain())
    assert not equivalent_equations([step * (u + n)], [u + n], [u]).holds
    assert not vanishes_off_kinks(n * sign(step) ** 2 - n, Domain()).holds
    assert not Domain().is_connected([n])
    assert is_analytic([sqrt(1 + n**2) / n + sp.exp(n)], Domain())
    assert equivalent_equations([(u + n) / n], [u + n], [u]).holds
    assert vanishes_off_kinks(n * sign(n + y) ** 2 - n, Domain()).holds
    assert Domain().is_connected([x])
    assert continuity(sqrt(1 + n**2) + 1 / n, [n]).holds


@pytest.mark.parametrize("m", [sp.Symbol("m", positive=True), sp.Symbol("m", negative=True)])
def test_one_half_line_is_connected(m):
    assert is_analytic([atan(1 / m) + m], Domain())
    assert Domain().is_connected([m])
