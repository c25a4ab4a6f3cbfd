"""Kolmogorov's steps: each doubles the order of what is left, and the normal form is one by the same tests."""

from dataclasses import replace

import pytest
import sympy as sp
from flint import fmpq

from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.perturbation.birkhoff import NormalFormError, birkhoff_normal_form
from canon.mechanics.perturbation.generator_forms import hori_generator
from canon.mechanics.perturbation.gustavson import formal_integral
from canon.mechanics.perturbation.lie_transform import bracket_parts, chain
from canon.mechanics.perturbation.near_identity import is_normal_form, near_identity_map
from canon.mechanics.perturbation.remainder import remainder_norms

x, y, px, py = sp.symbols("x y p_x p_y", real=True)
KINETIC = (px**2 + py**2) / 2


def two(potential):
    return Hamiltonian(KINETIC + potential, [x, y], [px, py])


HENON_HEILES = two((x**2 + y**2) / 2 + x**2 * y - y**3 / 3)
IRRATIONAL = two(x**2 / 2 + y**2 + x**2 * y + y**4)


def first_moving(form, steps, order):
    """The lowest degree of H after some steps that does not commute with H₂."""
    bracket = form.diagonal.brackets
    parts = chain(form.original, form.generators[:steps], order, bracket)
    return min(bracket_parts(parts, {2: form.original[2]}, order, bracket))


@pytest.mark.parametrize("H", [HENON_HEILES, IRRATIONAL])
def test_what_is_left_begins_at_twice_the_degree_after_each_step(H):
    fast = birkhoff_normal_form(H, 10, superconvergent=True)
    assert [degree for degree, _ in fast.generators] == [3, 4, 6, 10]
    assert [first_moving(fast, steps, 10) for steps in range(4)] == [3, 4, 6, 10]
    slow = birkhoff_normal_form(H, 10)
    assert [first_moving(slow, steps, 10) for steps in range(4)] == [3, 4, 5, 6]


@pytest.mark.parametrize("H", [HENON_HEILES, two(-(x**2) / 2 + 2 * y**2 + x**2 * y + x**3)])
def test_the_form_and_its_map_pass_the_tests_of_other_forms(H):
    form = birkhoff_normal_form(H, 6, superconvergent=True)
    assert is_normal_form(form).holds
    assert is_normal_form(replace(form, generators=form.generators[:-1])).fails
    for to_new in (False, True):
        assert near_identity_map(form, to_new).is_canonical().holds
    assert formal_integral(form).is_formal_integral().holds
    assert form.parts == birkhoff_normal_form(H, 6).parts
    assert sorted(hori_generator(form)) == [3, 4, 5, 6]
    assert sorted(remainder_norms(form, 0.1)) == [2, 3, 4, 5]


def test_generators_are_those_of_single_degrees_until_steps_no_longer_commute():
    """exp(L_χ₄) exp(L_χ₅) and exp(L_{χ₄ + χ₅}) differ by ½{χ₄, χ₅}, of degree 7."""
    fast, slow = (birkhoff_normal_form(IRRATIONAL, 7, superconvergent=s) for s in (True, False))
    steps = {d: f for _, chi in fast.generators for d, f in chi.split(lambda e: int(sum(e))).items()}
    assert [d for d, chi in slow.generators if steps[d] == chi] == [3, 4, 5, 6]
    single = dict(slow.generators)
    half = fast.diagonal.brackets(single[4], single[5]).times(fmpq(1, 2))
    assert steps[7] in (single[7] + half, single[7] - half)


def test_frequencies_where_nothing_resonates_are_the_same():
    fast, slow = (birkhoff_normal_form(IRRATIONAL, 8, superconvergent=s) for s in (True, False))
    assert fast.in_actions() == slow.in_actions()
    assert [s.weight for s in fast.small_divisors] == [s.weight for s in slow.small_divisors]


def test_a_zero_divisor_in_a_step_keeps_the_order_before_it():
    with pytest.raises(NormalFormError, match=r"at degree 4 .* k = \(") as failed:
        birkhoff_normal_form(HENON_HEILES, 8, resonances=[], superconvergent=True)
    assert failed.value.reached.order == 3
    assert is_normal_form(failed.value.reached).holds
