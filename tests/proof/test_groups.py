"""Sums that cancel group by group."""

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from canon import vanishes
from canon.proof.rungs.groups import groups

x, y, z = sp.symbols("x y z", positive=True)
FACTORS = (
    sp.sqrt(x + y),
    sp.sqrt(x),
    1 / sp.sqrt(x - y),
    sp.log(z),
    x,
    sp.Integer(3),
    sp.sqrt(x + y) * sp.exp(x),
)


def torque_on_n_bodies(n: int, error: sp.Expr = sp.S.Zero) -> sp.Expr:
    """d/dt of the angular momentum of n bodies under pairwise attraction, not multiplied out."""
    places = [sp.symbols(f"x{i} y{i} z{i}", real=True) for i in range(n)]
    masses = sp.symbols(f"m0:{n}", positive=True)
    total = error
    for i, (xi, yi, _) in enumerate(places):
        force = [sp.S.Zero, sp.S.Zero]
        for j, other in enumerate(places):
            if j != i:
                cubed = sp.sqrt(sum((a - b) ** 2 for a, b in zip(places[i], other, strict=True))) ** 3
                for k in range(2):
                    force[k] += masses[i] * masses[j] * (other[k] - places[i][k]) / cubed
        total += xi * force[1] - yi * force[0]
    return total


@pytest.mark.parametrize("n", [4, 7])
def test_the_torque_of_n_bodies_on_themselves_is_zero(n):
    verdict = vanishes(torque_on_n_bodies(n), budget=60.0)
    assert verdict.holds
    assert verdict.certificate == "groups"


def test_and_one_force_too_many_is_not():
    x0, y0, x1, y1 = sp.symbols("x0 y0 x1 y1", real=True)
    pull = sp.Rational(1, 10**9) * x0 / sp.sqrt((x0 - x1) ** 2 + (y0 - y1) ** 2)
    assert vanishes(torque_on_n_bodies(5, pull)).fails


@given(
    st.lists(st.tuples(st.sampled_from(FACTORS), st.sampled_from(FACTORS), st.integers(-3, 3)), min_size=1)
)
def test_groups_add_up_to_the_whole(terms):
    expr = sum((c * f * (g + x * f) for f, g, c in terms), sp.S.Zero)
    parts = groups(expr)
    if parts is not None:
        assert sp.expand(sum(parts) - expr) == 0


def test_radicals_that_depend_on_each_other_are_left_to_the_whole():
    """√(x²y) = x √y: no group is zero by itself, their sum is."""
    roots = sum(y**k * (sp.sqrt(x**2 * (y + k), evaluate=False) - x * sp.sqrt(y + k)) for k in range(1, 8))
    hidden = roots.subs(x, x + 1)
    assert vanishes(hidden).holds
    assert vanishes(hidden + sp.Rational(1, 10**8) * sp.sqrt(y + 3)).fails


def test_a_long_residual_is_named_and_not_printed():
    u = sp.Function("u")
    undecided = vanishes(sum(u(x * k) for k in range(40)) - u(x) * 7, budget=0.5)
    assert not undecided.holds
    assert len(str(undecided)) < 2_000
