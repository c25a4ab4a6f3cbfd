"""Systems of equations: the same solutions or not."""

import time
from types import SimpleNamespace

import pytest
import sympy as sp
from sympy import Function, cos, sin

from canon.proof import equivalence, equivalent_equations
from canon.proof.domain.domain import EVERYWHERE
from canon.proof.domain.verdict import Status
from canon.proof.equivalence import _refuted_in_a_regime

m1, m2, l, g = sp.symbols("m1 m2 l g", positive=True)
phi, v, x_acc, phi_acc = sp.symbols("phi v x_acc phi_acc", real=True)

PENDULUM = [
    (m1 + m2) * x_acc + m2 * l * (phi_acc * cos(phi) - v**2 * sin(phi)),
    m2 * l * (l * phi_acc + x_acc * cos(phi) + g * sin(phi)),
]


def test_invertible_recombination_is_equivalent():
    divided = [PENDULUM[0] - cos(phi) * PENDULUM[1] / l, PENDULUM[1] / (m2 * l)]
    assert equivalent_equations(PENDULUM, divided, [x_acc, phi_acc]).status is Status.HOLDS


def test_solved_form_is_equivalent():
    solved = sp.solve(PENDULUM, [x_acc, phi_acc], dict=True)[0]
    explicit = [u - solved[u] for u in (x_acc, phi_acc)]
    assert equivalent_equations(PENDULUM, explicit, [x_acc, phi_acc]).holds


def test_wrong_sign_names_the_equation():
    wrong = [PENDULUM[0], PENDULUM[1].xreplace({g: -g})]
    verdict = equivalent_equations(PENDULUM, wrong, [x_acc, phi_acc])
    assert verdict.fails
    assert verdict.counterexample is not None
    assert "equation 2 of the second system" in verdict.feedback


def test_missing_equation_is_reported():
    verdict = equivalent_equations(PENDULUM, PENDULUM[:1], [x_acc, phi_acc])
    assert verdict.fails
    assert "equation 2 of the first system does not follow from the second" in verdict.feedback


def test_redundant_equations_do_no_harm():
    redundant = [*PENDULUM, PENDULUM[0] + 3 * PENDULUM[1]]
    assert equivalent_equations(redundant, PENDULUM, [x_acc, phi_acc]).holds


def test_dependent_combination_is_not_equivalent():
    dependent = [PENDULUM[0], 2 * PENDULUM[0]]
    assert equivalent_equations(PENDULUM, dependent, [x_acc, phi_acc]).fails


def test_arbitrary_functions_in_the_coefficients():
    V = Function("V")
    force = [m1 * x_acc + V(phi).diff(phi)]
    assert equivalent_equations(force, [x_acc + V(phi).diff(phi) / m1], [x_acc]).holds
    assert equivalent_equations(force, [x_acc - V(phi).diff(phi) / m1], [x_acc]).fails


def test_unknowns_must_enter_affinely():
    with pytest.raises(ValueError, match="not affine"):
        equivalent_equations([x_acc**2 - 1], [x_acc - 1], [x_acc])


def test_a_generic_point_is_named():
    k, m = sp.symbols("k", real=True), sp.symbols("m", positive=True)
    right = [x_acc + phi]
    for factor, left_open in ((k, ("k ≠ 0",)), (m, ()), (m * k * phi, ("k ≠ 0, phi ≠ 0",)), (k**2 + 1, ())):
        verdict = equivalent_equations([factor * right[0]], right, [x_acc])
        assert verdict.holds
        assert verdict.assumed == tuple(f"generic point: {said}" for said in left_open)
    assert equivalent_equations([(k - k) * right[0]], right, [x_acc]).fails


SILENT = [
    abs(v) + v,
    sp.Max(v, 0),
    sp.Piecewise((0, v < 1), (1, True)),
    1 + sp.sign(v * phi),
    abs(abs(v) - 1) - abs(v) + 1,
]
LOUD = [abs(v) + 1, sp.Max(v, 1), v * sp.Max(v, 1), sp.sign(v) * abs(phi), 2 + sp.sign(v * phi)]


@pytest.mark.parametrize("factor", SILENT, ids=str)
def test_a_factor_that_is_zero_on_an_open_part_is_found_there(factor):
    verdict = equivalent_equations([x_acc * factor - v * factor], [x_acc - v], [x_acc])
    assert verdict.fails
    assert verdict.counterexample is not None
    assert " where " in verdict.feedback


@pytest.mark.parametrize("factor", LOUD, ids=str)
def test_a_factor_that_is_zero_at_single_places_is_none(factor):
    assert equivalent_equations([(x_acc - v) * factor], [x_acc - v], [x_acc]).holds
    assert equivalent_equations([(x_acc - v) * factor], [x_acc + v], [x_acc]).fails


def test_pieces_that_turn_on_the_unknowns_are_not_looked_at_one_by_one():
    """|a| + a = 2l has the one solution a = l."""
    with pytest.raises(ValueError, match="not affine"):
        equivalent_equations([abs(x_acc) + x_acc - 2 * l], [x_acc - l], [x_acc])
    folded = _refuted_in_a_regime(
        [abs(x_acc) + x_acc - 2 * l], [x_acc - l], [x_acc], EVERYWHERE, time.monotonic() + 5, str
    )
    assert folded is None


def test_determinants_share_the_budget_and_each_is_looked_at(monkeypatch):
    """The second and third after a second each, the others when all of it is spent."""
    now, budgets = 100.0, []

    def noted(f, domain, budget):
        nonlocal now
        budgets.append(budget)
        now += 1.0 if len(budgets) < 3 else 9.0
        return vanishes(f, domain)

    vanishes = equivalence.vanishes
    monkeypatch.setattr(equivalence, "vanishes", noted)
    monkeypatch.setattr(equivalence, "time", SimpleNamespace(monotonic=lambda: now))
    combined = [PENDULUM[0] - PENDULUM[1], PENDULUM[0] + PENDULUM[1]]
    assert equivalent_equations(PENDULUM, combined, [x_acc, phi_acc], budget=4.0).holds
    assert budgets[:4] == [4.0, 3.0, 2.0, 0.1]
    assert set(budgets[4:]) <= {0.1}
