"""Hori's and Deprit's generators of the map of a normal form: by SymPy's brackets, and against a wrong twin."""

import pytest
import sympy as sp

from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.perturbation.birkhoff import birkhoff_normal_form
from canon.mechanics.perturbation.generator_forms import deprit_generator, hori_generator
from canon.mechanics.perturbation.lie_series import lie_deprit, lie_series

x, y, px, py = VARIABLES = sp.symbols("x y p_x p_y", real=True)
eps = sp.Symbol("epsilon")
KINETIC = (px**2 + py**2) / 2
SYSTEMS = {
    "resonant": Hamiltonian(KINETIC + (x**2 + y**2) / 2 + x**2 * y - y**3 / 3, [x, y], [px, py]),
    "hyperbolic": Hamiltonian(KINETIC - x**2 / 2 + 2 * y**2 + x**2 * y + x**3, [x, y], [px, py]),
}
SCALED = {z: eps * z for z in VARIABLES}


def degrees(f, order):
    scaled = sp.expand(f.subs(SCALED, simultaneous=True))
    return [sp.expand(scaled.coeff(eps, d)) for d in range(order + 1)]


@pytest.mark.parametrize("name", SYSTEMS)
def test_one_exponential_takes_h_to_k(name):
    H = SYSTEMS[name]
    form = birkhoff_normal_form(H, 4)
    K = degrees(form.in_variables(), 4)
    chi = form.expression(hori_generator(form))
    assert degrees(lie_series(H.H, chi, H.q, H.p, 2), 4) == K
    assert degrees(lie_series(H.H, -chi, H.q, H.p, 2), 4) != K


@pytest.mark.parametrize("name", SYSTEMS)
def test_deprits_flow_takes_h_to_k(name):
    """With (q, p) → ε(q, p) and H/ε², the part of degree s has the power ε^(s−2) of Deprit's series."""
    H = SYSTEMS[name]
    form = birkhoff_normal_form(H, 4)
    W = form.expression(deprit_generator(form))
    scaled = [sp.expand(f.subs(SCALED, simultaneous=True)) for f in (H.H, W, form.in_variables())]
    H_eps, W_eps, K_eps = (sp.expand(f / eps**power) for f, power in zip(scaled, (2, 3, 2), strict=True))
    found = lie_deprit(H_eps, W_eps, H.q, H.p, 2, eps)
    assert sp.expand(found - K_eps) == 0
    assert sp.expand(lie_deprit(H_eps, -W_eps, H.q, H.p, 2, eps) - K_eps) != 0


def test_the_three_forms_differ_beyond_their_first_parts():
    form = birkhoff_normal_form(SYSTEMS["hyperbolic"], 5)
    product, hori, deprit = dict(form.generators), hori_generator(form), deprit_generator(form)
    assert product[3] == hori[3] == deprit[3]
    assert hori[5] != product[5]
    assert deprit[4] == hori[4].times(2)


def test_parts_of_the_fifth_degree_take_account_of_how_those_below_act_on_each_other() -> None:
    H = Hamiltonian((px**2 + x**2) / 2 + x**3, x, px)
    form = birkhoff_normal_form(H, 5)
    parts = hori_generator(form)
    found = lie_series(H.H, form.expression(parts), H.q, H.p, 3)
    assert degrees(found, 5) == degrees(form.in_variables(), 5)
    assert 5 in parts


def test_where_the_map_has_no_quadratic_terms_the_generators_have_no_cubic_ones():
    form = birkhoff_normal_form(Hamiltonian((px**2 + x**2) / 2 + x**4, x, px), 4)
    for generator in (hori_generator(form), deprit_generator(form)):
        assert [*generator] == [4]
    chi = form.expression(hori_generator(form))
    H4 = (px**2 + x**2) / 2 + x**4
    assert degrees(lie_series(H4, chi, [x], [px], 1), 4) == degrees(form.in_variables(), 4)
    assert degrees(lie_series(H4, -chi, [x], [px], 1), 4) != degrees(form.in_variables(), 4)
