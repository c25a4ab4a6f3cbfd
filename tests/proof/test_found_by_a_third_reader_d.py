"""Claims that a reader of the zero test found judged wrongly, each beside one that is right."""

import pytest
import sympy as sp

from canon.proof import Domain, equal, equivalent_equations, vanishes
from canon.proof.rungs.cases import cases
from canon.proof.trees.bound_variables import with_own_bound_variables
from canon.proof.trees.replacement import NoValue, replaced

x, y, u, s, t = sp.symbols("x y u s t", real=True)
n, k = sp.symbols("n k", integer=True)
f = sp.Function("f")


def around(integrand):
    return sp.Integral(integrand, (x, -1, 1))


@pytest.mark.parametrize(
    ("left", "right", "condition"),
    [
        (sp.Sum(n * k, (n, 1, 3)), sp.Sum(k**2, (k, 1, 3)), sp.Eq(n, k)),
        (sp.Product(n * k, (n, 1, 3)), sp.Product(k**2, (k, 1, 3)), sp.Eq(n, k)),
        (sp.Integral(x * y, (x, 0, 1)), sp.Integral(y**2, (y, 0, 1)), sp.Eq(x, y)),
        (around(abs(x)), around(x), x > 0),
        (around(sp.Max(x, 0)), around(x), x > 0),
        (sp.Sum(abs(n), (n, -3, 3)), sp.Sum(n, (n, -3, 3)), n > 0),
        (sp.Sum(sp.Piecewise((1, n > 3), (0, True)), (n, 1, 5)), sp.Sum(1, (n, 1, 5)), n > 3),
    ],
)
def test_what_is_said_of_a_symbol_is_not_said_of_a_bound_variable_of_its_name(left, right, condition):
    assert not equal(left, right, Domain((condition,)), budget=1).holds


def test_no_case_has_one_sign_of_a_variable_of_integration():
    assert not vanishes((around(abs(x)) - around(x)) * (around(abs(x)) - around(-x)), budget=1).holds
    assert cases(around(abs(x)), Domain()) is None


def test_cases_are_cut_beside_and_inside_integrals_by_what_is_free():
    whole = sp.Integral(abs(x) * abs(t), (t, 0, 1))
    assert equal(whole, sp.Integral(x * abs(t), (t, 0, 1)), Domain((x > 0,)), budget=2).holds
    assert not equal(whole, sp.Integral(x * abs(t), (t, 0, 1)), Domain((x < 0,)), budget=1).holds
    assert vanishes(sp.sqrt(x**2) * around(x) - abs(x) * around(x)).holds


def test_free_symbols_in_sums_and_integrals_are_removed_by_equalities():
    first, second = sp.Integral(t * x, (t, 0, x)), sp.Integral(t * y, (t, 0, y))
    assert equal(first, second, Domain((sp.Eq(x, y),))).holds
    assert not equal(first, second, Domain((sp.Eq(x, 2 * y),)), budget=1).holds


def test_entries_of_a_matrix_have_bound_variables_of_their_own():
    right = sp.Matrix([x * sp.Integral(t * x, (t, 0, x)), sp.Integral(t * x, (t, 0, x))])
    left = sp.Matrix([y * sp.Integral(t * y, (t, 0, y)), sp.Integral(t * y, (t, 0, y))])
    assert equal(left, right, Domain((sp.Eq(x, y),))).holds
    captured = sp.Matrix([sp.Integral(x * y, (x, 0, 1)) - sp.Integral(y**2, (y, 0, 1)), x - y])
    assert not vanishes(captured, Domain((sp.Eq(x, y),)), budget=1).holds


def test_a_denominator_inside_a_substitution_says_nothing_of_the_free_symbol():
    inside = sp.Subs(sp.Derivative(f(u), u) / u, u, 1)
    assert not vanishes((sp.sign(u) ** 2 - 1) * inside, budget=1).holds
    assert vanishes((sp.sign(u) ** 2 - 1) * inside, Domain((sp.Ne(u, 0),))).holds


def test_a_replacement_leaves_bound_variables_alone():
    with pytest.raises(NoValue):
        replaced(sp.Integral(x * y, (x, 0, 1)), {x: y})
    with pytest.raises(NoValue):
        replaced(sp.Integral(x * y, (x, 0, 1)), {y: x})
    at_one = sp.Subs(sp.Derivative(f(x, y), x), x, 1)
    assert replaced(at_one + x, {x: t}) == at_one + t
    assert replaced(at_one, {x: t, y: s}) == sp.Subs(sp.Derivative(f(x, s), x), x, 1)
    with pytest.raises(NoValue):
        replaced(at_one, {y: x})
    assert replaced(sp.Integral(x * y, (x, 0, 1)), {y: t}) == sp.Integral(x * t, (x, 0, 1))


def test_bound_variables_are_renamed_where_they_are_bound_and_nowhere_else():
    inner = sp.Integral(x, (x, 0, x))
    nested = sp.Integral(inner, (x, 0, x)) + x
    (own,) = with_own_bound_variables([nested])
    assert own.free_symbols == {x} == nested.free_symbols
    assert sp.expand(own.doit() - nested.doit()) == 0
    double = sp.Integral(x * y, (x, 0, y), (y, 0, x))
    (own,) = with_own_bound_variables([double])
    assert own.free_symbols == {x}
    assert own.doit() == double.doit()
    assert with_own_bound_variables([sp.Integral(x, x)]) == [sp.Integral(x, x)]


def test_an_unevaluated_limit_is_named():
    with pytest.raises(ValueError, match=r"Limit\(sin\(x\)/x, x, 0, dir='\+'\) is not carried out"):
        vanishes((sp.sign(x) ** 2 - 1) * sp.Limit(sp.sin(x) / x, x, 0))
    assert vanishes(sp.Limit(sp.sin(x) / x, x, 0).doit() - 1).holds
    a, b = sp.symbols("a b", commutative=False)
    with pytest.raises(ValueError, match="commute"):
        vanishes(a * b - b * a)


@pytest.mark.parametrize(
    "slope",
    [x - sp.Rational(1, 2), n - 2, 1 - sp.tanh(400 * x), sp.sqrt(1 + x**2 / sp.Integer(10) ** 80) - 1],
)
def test_a_system_without_solution_at_one_point_alone_has_solutions_at_generic_ones(slope):
    one, other = equivalent_equations([slope * u - 1], [slope * u - 2], [u], Domain((x > 0,))), slope * u - 1
    assert not one.holds
    assert equivalent_equations([other], [2 * other], [u], Domain((x > 0,))).fails is False


def test_a_system_that_is_nowhere_solvable_is_equivalent_to_another_such():
    hidden = sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1
    assert equivalent_equations([u - x, u - x - 1], [hidden * u - 1], [u]).holds
    assert not equivalent_equations([u - x, u - x - 1], [x * u - 1], [u]).holds
    assert equivalent_equations([u + s, u + s - y], [u, u - y], [u, s]).holds


@pytest.mark.parametrize("condition", [sp.Eq(x, 1.0), x > 0.5, sp.Or(x < -0.5, x > 1)])
def test_rounded_numbers_in_a_domain_are_refused_as_those_in_expressions_are(condition):
    with pytest.raises(ValueError, match="is a rounded number"):
        Domain((condition,))
    assert equal(x**2, sp.Rational(1, 4), Domain((sp.Eq(x, sp.Rational(1, 2)),))).holds


def test_inequalities_that_leave_one_point_are_no_open_domain():
    at_two, pinned = sp.Piecewise((5, sp.Eq(x, 2))), Domain((x >= 2, x <= 2))
    assert not equal(at_two, 5, pinned, budget=2).fails
    assert not equal(at_two, 4, pinned, budget=2).holds
    assert equal(at_two, 5, Domain((x > 2, x < 3)), budget=2).fails
    hidden = (x + 1) ** 2 - x**2 - 2 * x - 1
    assert not vanishes(hidden / x, Domain((x >= 0, x <= 0)), budget=2).holds
    assert vanishes(hidden / x, Domain((x >= 0,))).holds


def test_a_symbol_that_is_declared_not_real_is_complex():
    z = sp.Symbol("z", real=False)
    assert not vanishes(sp.sqrt(z**2) - abs(z)).holds
    assert not vanishes(abs(z) ** 2 - z**2).holds
    assert vanishes((z + 1) ** 2 - z**2 - 2 * z - 1).holds
    w = sp.Symbol("w")
    assert vanishes(sp.sqrt(w**2) - abs(w)).holds


def test_a_rational_symbol_has_no_irrational_counterexample():
    r = sp.Symbol("r", rational=True)
    assert not vanishes(r - 1, Domain((sp.Eq(r**2, 2), r > 0)), budget=2).fails
    assert vanishes(x - 1, Domain((sp.Eq(x**2, 2), x > 0)), budget=2).fails


def test_a_budget_without_end_is_a_long_one():
    unproved = sp.gamma(2 * y) - sp.gamma(y) * sp.gamma(y + sp.Rational(1, 3))
    assert vanishes(sp.Matrix([unproved, unproved * y]), budget=float("inf")).fails
    same = sp.gamma(2 * u) - 2 ** (2 * u - 1) / sp.sqrt(sp.pi) * sp.gamma(u) * sp.gamma(u + sp.Rational(1, 2))
    assert not vanishes(sp.Matrix([same, same * u]), Domain((u > 0,)), budget=float("inf")).fails


def test_equations_with_steps_of_the_unknown_are_not_affine():
    with pytest.raises(ValueError, match="equation 1 of the first system is not affine"):
        equivalent_equations([sp.floor(u) - 1], [u - 1], [u])
    assert equivalent_equations([u / 2 - x], [u - 2 * x], [u]).holds
