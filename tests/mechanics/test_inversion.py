"""Peeling inversions: right at the witness, and wherever the noted conditions hold."""

import pytest
import sympy as sp
from hypothesis import example, given, settings
from hypothesis import strategies as st

from canon.mechanics.algebra.branch_point import BranchPoint, branch_points
from canon.mechanics.algebra.potential import potential
from canon.mechanics.algebra.solve_on_branch import Inversion, UnstatableError, isolate, solve_system
from canon.mechanics.algebra.table_integrals import table_integral
from canon.proof.domain.domain import Domain
from canon.proof.vanish import vanishes

x, y, u, v, Y, Z = sp.symbols("x y u v Y Z", real=True)

LAYERS = {
    "sin": sp.sin,
    "cos": sp.cos,
    "tan": sp.tan,
    "cot": sp.cot,
    "exp": sp.exp,
    "sinh": sp.sinh,
    "cosh": sp.cosh,
    "atan": sp.atan,
    "square": lambda f: f**2,
    "cube": lambda f: f**3,
    "root": lambda f: sp.sqrt(f**2 + 1),
    "reciprocal": lambda f: 1 / f,
    "shift": lambda f: f + sp.Rational(1, 3),
    "scale": lambda f: -2 * f * u,
    "quadratic": lambda f: f**2 + f,
    "fraction": lambda f: (f - 2) / (f + 3),
    "two functions": lambda f: sp.sin(f) + sp.cos(f),
}


def test_a_number_of_which_no_digit_is_known_is_none():
    """cosh(cosh(cosh(23/4))) has some 10⁶⁷ digits before the point."""
    towering = BranchPoint({x: sp.Rational(-23, 4)}, {})
    assert towering.number(sp.cosh(sp.cosh(sp.cosh(x)))) is None
    assert towering.number(sp.cosh(sp.cosh(x))) == pytest.approx(8.4196909e67)
    assert BranchPoint({}, {}).number(sp.sin(sp.pi)) == 0


def test_where_two_branches_meet_none_is_chosen():
    fold = Inversion(BranchPoint({x: sp.Rational(-1, 2)}, {Y: x**2 + x}))
    with pytest.raises(UnstatableError):
        isolate(x**2 + x, Y, x, fold)
    beside = Inversion(BranchPoint({x: sp.Rational(-2, 3)}, {Y: x**2 + x}))
    assert isolate(x**2 + x, Y, x, beside).subs(Y, 2) == -2
    assert beside.conditions == [2 * x + 1 < 0]


@settings(max_examples=50, deadline=None)
@example(["quadratic"], 38)
@example(["cosh", "cosh", "cosh"], 35)
@example(["square", "fraction", "quadratic"], 0)
@given(st.lists(st.sampled_from(sorted(LAYERS)), min_size=1, max_size=3), st.integers(0, 50))
def test_an_isolated_unknown_is_right_wherever_its_conditions_hold(layers, seed):
    f = x
    for layer in layers:
        f = LAYERS[layer](f)
    found_witnesses = list(branch_points({x, u}, {Y: f}, Domain(), 1, seed=seed))
    if not found_witnesses:
        return
    inversion = Inversion(found_witnesses[0])
    try:
        found = isolate(f, Y, x, inversion)
    except UnstatableError:  # conditions too long to be said: the callers then return nothing
        return
    if found is None:
        return
    assert not found.has(x)
    assert found_witnesses[0].agree(found, x)
    for other in branch_points({x, u}, {Y: f}, Domain(tuple(inversion.conditions)), 4, seed=seed + 1):
        assert other.agree(found, x), (found, inversion.conditions)


@pytest.mark.parametrize("layer", sorted(LAYERS))
def test_every_layer_can_be_peeled(layer):
    f = LAYERS[layer](x)
    witness = next(iter(branch_points({x, u}, {Y: f}, Domain(), 1)))
    assert isolate(f, Y, x, Inversion(witness)) is not None


def test_the_branch_follows_the_witness():
    for place, branch in (
        (sp.Rational(1, 2), sp.acos(Y)),
        (-sp.Rational(1, 2), -sp.acos(Y)),
        (sp.Integer(7), sp.acos(Y) + 2 * sp.pi),
    ):
        inversion = Inversion(BranchPoint({x: place}, {Y: sp.cos(x)}))
        assert isolate(sp.cos(x), Y, x, inversion) == branch
        assert all(c.subs(x, place) for c in inversion.conditions)


def test_systems():
    equations = [(x * sp.cos(y), Y), (x * sp.sin(y), Z)]
    meaning = {Y: x * sp.cos(y), Z: x * sp.sin(y)}
    first = Domain((x > 0, y > 0, y < sp.pi / 2))
    witness = next(iter(branch_points({x, y}, meaning, first, 1)))
    solved = solve_system(equations, [x, y], Inversion(witness))
    assert solved is not None
    assert vanishes(solved[x].subs(meaning, simultaneous=True) - x, first).holds
    assert (
        solve_system([(x**5 + x, Y)], [x], Inversion(BranchPoint({x: sp.Integer(1)}, {Y: x**5 + x}))) is None
    )


POTENTIALS = [
    x**2 * sp.sin(y),
    sp.log(x**2 + 1) * y,
    sp.atan(x * u) + y * x,
    sp.exp(x * y) + y**3 / 3,
    sp.Function("V")(x) * y,
    sp.sqrt(x**2 + y**2),
]


@pytest.mark.parametrize("G", POTENTIALS, ids=str)
def test_closed_forms_are_integrated(G):
    found = potential([G.diff(x), G.diff(y)], [x, y], Domain())
    assert found is not None
    assert vanishes((found - G).diff(x)).holds
    assert vanishes((found - G).diff(y)).holds


def test_forms_that_are_not_closed_have_no_potential():
    assert potential([y, -x], [x, y], Domain()) is None
    assert potential([x * y, x], [x, y], Domain()) is None


TABLE = [
    x**3 * u,
    u / x,
    sp.sin(u * x + 1),
    x * sp.exp(-x),
    x * sp.exp(x**2),
    sp.cos(x) * sp.sin(x) ** 3,
    1 / (1 + x**2),
    x**2 * sp.cos(2 * x),
]


@pytest.mark.parametrize("term", TABLE, ids=str)
def test_table_integrals(term):
    integral = table_integral(term, x)
    assert integral is not None
    assert vanishes(integral.diff(x) - term).holds


def test_nested_functions_are_left_alone():
    """SymPy's rules would search for minutes here."""
    assert table_integral(sp.exp(-x) * sp.sin(y * sp.exp(-x) + sp.exp(2 * x)) * sp.exp(2 * x), x) is None


def test_the_potential_of_nothing_and_of_ones():
    x, y = sp.symbols("x y", real=True)
    assert potential([sp.S.Zero, sp.S.Zero], [x, y], Domain()) == 0
    assert potential([sp.S.One, sp.S.One], [x, y], Domain()) == x + y
