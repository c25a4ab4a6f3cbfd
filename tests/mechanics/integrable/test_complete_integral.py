"""Separation of variables: published systems, what does not separate, and integrals with a wrong coefficient."""

from dataclasses import replace

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.mechanics.canonical.inverse.inverse_transformation import inverse_transformation
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.mechanics.hamilton.bracket import poisson_bracket
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable import complete_integral
from canon.mechanics.integrable.classical_coordinates import NAMES, charts_for
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.mechanics.integrable.function_splitting import product_parts, sum_parts
from canon.mechanics.integrable.separability import is_separable
from canon.mechanics.integrable.separated_momenta import NotSeparatedError, separated_momenta
from canon.proof.domain.domain import EVERYWHERE, Domain
from canon.proof.vanish import vanishes

x, y, z, px, py, pz = sp.symbols("x y z p_x p_y p_z", real=True)
r, theta, m, k, k1, k2, c, F, w, l, a, g = sp.symbols("r theta m k k1 k2 c F omega l a g", positive=True)
phi, psi, p_r, p_theta, p_phi, p_psi = sp.symbols("phi psi p_r p_theta p_phi p_psi", real=True)
I1, I3 = sp.symbols("I1 I3", positive=True)

PLANE = (px**2 + py**2) / (2 * m)
SPACE = (px**2 + py**2 + pz**2) / (2 * m)
SPHERE = (p_theta**2 + p_phi**2 / sp.sin(theta) ** 2) / (2 * m)
HENON_HEILES = Hamiltonian((px**2 + py**2 + x**2 + y**2) / 2 + x**2 * y - y**3 / 3, [x, y], [px, py])
INTEGRABLE_HENON_HEILES = Hamiltonian(
    (px**2 + py**2 + x**2 + y**2) / 2 + x**2 * y + y**3 / 3, [x, y], [px, py]
)
DOUBLE_PENDULUM = Hamiltonian(
    (px**2 + 2 * py**2 - 2 * px * py * sp.cos(x - y)) / (2 * (1 + sp.sin(x - y) ** 2))
    - 2 * sp.cos(x)
    - sp.cos(y),
    [x, y],
    [px, py],
)
LAGRANGE_TOP = Hamiltonian(
    p_theta**2 / (2 * I1)
    + (p_phi - p_psi * sp.cos(theta)) ** 2 / (2 * I1 * sp.sin(theta) ** 2)
    + p_psi**2 / (2 * I3)
    + m * g * l * sp.cos(theta),
    [theta, phi, psi],
    [p_theta, p_phi, p_psi],
)
SEPARABLE = {
    "oscillator": Hamiltonian(px**2 / (2 * m) + m * w**2 * x**2 / 2, x, px),
    "pendulum": Hamiltonian(px**2 / (2 * m * l**2) - m * g * l * sp.cos(x), x, px),
    "two oscillators": Hamiltonian(PLANE + k1 * x**2 / 2 + k2 * y**4, [x, y], [px, py]),
    "Kepler": Hamiltonian(p_r**2 / (2 * m) + SPHERE / r**2 - k / r, [r, theta, phi], [p_r, p_theta, p_phi]),
    "spherical pendulum": Hamiltonian(
        SPHERE / l**2 + m * g * l * sp.cos(theta), [theta, phi], [p_theta, p_phi]
    ),
    "Lagrange's top": LAGRANGE_TOP,
    "Liouville": Hamiltonian(((px**2 + py**2) / 2 + x**4 + y**2) / (x**2 + y**2 + 1), [x, y], [px, py]),
}


@pytest.mark.parametrize("name", SEPARABLE)
def test_textbook_systems_separate_in_their_coordinates(name):
    found = hamilton_jacobi(SEPARABLE[name])
    assert found.separable.holds
    assert found.is_complete_integral().holds
    assert len(found.constants) == len(found.momenta)


@pytest.mark.parametrize("name", SEPARABLE)
def test_the_constants_are_integrals_in_involution(name):
    found = hamilton_jacobi(SEPARABLE[name])
    values = [found.defined_as[constant] for constant in found.constants]
    for i, first in enumerate(values):
        for second in values[:i]:
            assert vanishes(poisson_bracket(first, second, found.H.q, found.H.p)).holds


@pytest.mark.parametrize("name", SEPARABLE)
def test_an_integral_with_a_wrong_coefficient_is_refused(name):
    found = hamilton_jacobi(SEPARABLE[name])
    for i, momentum in enumerate(found.momenta):
        wrong = (
            replace(momentum, shift=2 * momentum.shift)
            if momentum.square is None
            else replace(momentum, square=momentum.square + 1)
        )
        changed = replace(found, momenta=(*found.momenta[:i], wrong, *found.momenta[i + 1 :]))
        if momentum.square is not None or found.H.H.has(momentum.p):
            assert changed.is_complete_integral().fails


def test_constants_that_are_not_independent_make_no_complete_integral():
    found = hamilton_jacobi(SEPARABLE["two oscillators"])
    doubled = replace(found, constants=(found.energy, found.energy))
    verdict = doubled.is_complete_integral()
    assert verdict.fails
    assert "not independent" in verdict.feedback


CLASSICAL = {
    "polar": (Hamiltonian(PLANE - k / sp.sqrt(x**2 + y**2), [x, y], [px, py]), None),
    "parabolic": (Hamiltonian(PLANE - k / sp.sqrt(x**2 + y**2) - F * x, [x, y], [px, py]), None),
    "elliptic": (
        Hamiltonian(
            PLANE - k1 / sp.sqrt((x - c) ** 2 + y**2) - k2 / sp.sqrt((x + c) ** 2 + y**2), [x, y], [px, py]
        ),
        c,
    ),
    "spherical": (
        Hamiltonian(SPACE - k / sp.sqrt(x**2 + y**2 + z**2), [x, y, z], [px, py, pz]),
        None,
    ),
    "cylindrical": (Hamiltonian(SPACE + k * (x**2 + y**2) ** 2 + F * z, [x, y, z], [px, py, pz]), None),
    "paraboloidal": (
        Hamiltonian(SPACE - k / sp.sqrt(x**2 + y**2 + z**2) - F * z, [x, y, z], [px, py, pz]),
        None,
    ),
    "prolate": (
        Hamiltonian(
            SPACE - k1 / sp.sqrt(x**2 + y**2 + (z - c) ** 2) - k2 / sp.sqrt(x**2 + y**2 + (z + c) ** 2),
            [x, y, z],
            [px, py, pz],
        ),
        c,
    ),
}


@pytest.mark.parametrize("name", CLASSICAL)
def test_classical_coordinates_are_found(name):
    H, focal = CLASSICAL[name]
    found = hamilton_jacobi(H, "any", focal=focal)
    assert found.chart is not None
    assert found.chart.name == name
    assert found.is_complete_integral().holds


@pytest.mark.parametrize("name", NAMES)
def test_charts_are_canonical_and_carry_the_hamiltonian_over(name):
    H, focal = CLASSICAL[name]
    (chart,) = charts_for(H, name, focal)
    lift = chart.lift()
    assert lift.is_canonical().holds
    free = Hamiltonian(sum(p**2 for p in H.p), H.q, H.p)
    old = sum(p**2 for p in lift.new_p)
    assert vanishes(chart.hamiltonian(free).H - old).holds
    V = H.H.subs(dict.fromkeys(H.p, 0))
    there = V.subs(dict(zip(H.q, chart.position, strict=True)), simultaneous=True)
    due = chart.hamiltonian(H).H.subs(dict.fromkeys(chart.p, 0))
    start = {s: sp.Rational(5 + i, 7) for i, s in enumerate(sorted(there.free_symbols, key=str))}
    assert abs((there - due).subs(start).evalf(30)) < 1e-25


@pytest.mark.parametrize(
    "name", [n if n in ("elliptic", "polar") else pytest.param(n, marks=pytest.mark.slow) for n in NAMES]
)
def test_charts_have_inverses_where_they_are_one_to_one(name):
    H, focal = CLASSICAL[name]
    (chart,) = charts_for(H, name, focal)
    lift = chart.lift()
    back = inverse_transformation(lift, H.q, H.p)
    start = {z: sp.Rational(3 + k, 5) for k, z in enumerate(lift.variables)} | {c: sp.Rational(3, 2)}
    there = dict(zip((*H.q, *H.p), (f.subs(start).n(30) for f in lift.images), strict=True))
    for z, f in zip(lift.variables, back.images, strict=True):
        assert abs(f.subs({**there, c: start[c]}).n(30) - start[z]) < 1e-25
        assert abs(f.subs({**there, c: start[c]}).n(30) + start[z]) > 1


@pytest.mark.parametrize(
    ("H", "condition"),
    [
        (HENON_HEILES, "x and y do not separate: Levi-Civita's condition for the pair (x, y) fails"),
        (DOUBLE_PENDULUM, "x and y do not separate: Levi-Civita's condition for the pair (x, y) fails"),
        (CLASSICAL["polar"][0], "x and y do not separate"),
    ],
    ids=["Hénon–Heiles", "double pendulum", "Kepler in Cartesian coordinates"],
)
def test_what_does_not_separate_is_told_with_the_condition(H, condition):
    verdict = is_separable(H)
    assert verdict.fails
    assert condition in verdict.feedback
    assert verdict.counterexample is not None
    with pytest.raises(NotSeparatedError, match="Levi-Civita's condition"):
        hamilton_jacobi(H)


def test_no_classical_coordinates_separate_henon_heiles_nor_two_centres_without_their_foci():
    with pytest.raises(NotSeparatedError, match=r"polar coordinates.*parabolic coordinates.*elliptic"):
        hamilton_jacobi(HENON_HEILES, "any", focal=sp.Integer(1))
    with pytest.raises(NotSeparatedError):
        hamilton_jacobi(CLASSICAL["elliptic"][0], "any")
    with pytest.raises(NotSeparatedError):
        hamilton_jacobi(CLASSICAL["elliptic"][0], "elliptic", focal=2 * c)


def test_the_integrable_henon_heiles_separates_in_turned_coordinates():
    assert is_separable(INTEGRABLE_HENON_HEILES).fails
    u, v, pu, pv = sp.symbols("u v p_u p_v", real=True)
    turned = {
        x: (u - v) / sp.sqrt(2),
        y: (u + v) / sp.sqrt(2),
        px: (pu - pv) / sp.sqrt(2),
        py: (pu + pv) / sp.sqrt(2),
    }
    H = sp.expand(INTEGRABLE_HENON_HEILES.H.subs(turned, simultaneous=True))
    assert hamilton_jacobi(Hamiltonian(H, [u, v], [pu, pv])).is_complete_integral().holds


def test_bad_input_is_told():
    H = CLASSICAL["polar"][0]
    t = H.t
    with pytest.raises(ValueError, match="depends on the time"):
        hamilton_jacobi(Hamiltonian(px**2 + x * sp.cos(t), x, px))
    with pytest.raises(ValueError, match="no coordinates are called 'toroidal'"):
        hamilton_jacobi(H, "toroidal")
    with pytest.raises(ValueError, match="of 3 dimensions"):
        hamilton_jacobi(H, "spherical")
    with pytest.raises(ValueError, match="focal"):
        hamilton_jacobi(H, "elliptic")
    with pytest.raises(ValueError, match="Cartesian"):
        hamilton_jacobi(DOUBLE_PENDULUM, "polar")
    for uneven in (px**2 / 2 + 2 * py**2 + x**2 + y**2, x**2 * (px**2 + py**2) / 2 + y):
        with pytest.raises(ValueError, match="Cartesian"):
            hamilton_jacobi(Hamiltonian(uneven, [x, y], [px, py]), "polar")
    E = sp.Symbol("E", real=True)
    with pytest.raises(ValueError, match="already stands in H"):
        hamilton_jacobi(Hamiltonian(px**2 + E * x, x, px))
    with pytest.raises(NotSeparatedError, match="quadratic"):
        hamilton_jacobi(Hamiltonian(px**4 + x, x, px))


@given(st.integers(-5, 5), st.integers(-5, 5), st.integers(1, 4), st.integers(1, 4))
@settings(deadline=None, max_examples=50)
def test_sums_and_products_come_apart(i, j, n, s):
    u, v = sp.symbols("u v", positive=True)
    left, right = i * u**n + sp.sin(u) + 3, j * sp.exp(v) + s * v
    mixed = sp.expand((left + right) * (u + v)) / (u + v)
    parts = sum_parts(mixed, [[u], [v]], EVERYWHERE)
    assert parts is not None
    assert not parts[0].has(v)
    assert not parts[1].has(u)
    assert vanishes(parts[0] + parts[1] - mixed).holds
    factors = product_parts(sp.expand((u**n + 1) * (sp.exp(v) + s)), [[u], [v]], EVERYWHERE)
    assert factors is not None
    assert not factors[0].has(v)
    assert not factors[1].has(u)
    assert sum_parts(left + right + u * v, [[u], [v]], EVERYWHERE) is None
    assert product_parts((u**n + 1) * (sp.exp(v) + s) + 1, [[u], [v]], EVERYWHERE) is None


def test_a_sum_comes_apart_as_it_is_written():
    u, v = sp.symbols("u v", positive=True)
    assert sum_parts(u + v**2 + 3, [[u], [v]], EVERYWHERE) == [u, v**2 + 3]


def test_free_motion_separates_in_elliptic_coordinates_where_they_are_asked_for():
    assert hamilton_jacobi(Hamiltonian(PLANE, [x, y], [px, py]), "elliptic", focal=c).chart.name == "elliptic"


def test_the_motion_of_the_oscillator_follows_from_its_integral():
    found = hamilton_jacobi(SEPARABLE["oscillator"])
    (integral,) = found.motion
    integrand = integral.args[0]
    E, t = found.energy, sp.Symbol("t", real=True)
    path = sp.sqrt(2 * E / m) / w * sp.sin(w * t)
    along = (integrand.subs(x, path) * path.diff(t)) ** 2
    assert vanishes(along - 1, Domain((E > 0, sp.cos(w * t) > 0))).holds


def test_the_lift_of_a_chart_is_a_canonical_transformation():
    H, _ = CLASSICAL["polar"]
    assert isinstance(hamilton_jacobi(H, "polar").chart.lift(), CanonicalTransformation)


def test_the_equation_and_the_determinant_have_half_of_the_budget_each(monkeypatch):
    found, budgets = hamilton_jacobi(SEPARABLE["oscillator"]), []

    def noting(proof):
        return lambda *given: budgets.append(given[-1]) or proof(*given)

    for name in ("all_vanish", "vanishes_off_kinks"):
        monkeypatch.setattr(complete_integral, name, noting(getattr(complete_integral, name)))
    assert found.is_complete_integral(budget=8.0).holds
    assert budgets == [4.0, 4.0]


def test_the_name_of_a_constant_is_none_of_those_that_stand_in_the_hamiltonian():
    pull = sp.Symbol("alpha_x", real=True)
    found = hamilton_jacobi(Hamiltonian((px**2 + py**2) / 2 + pull * y, [x, y], [px, py]))
    constant, energy = found.constants
    assert str(constant) == "alpha_x_"
    assert found.is_complete_integral().holds
    assert found.momenta[0].defined_as == px
    assert sp.expand(found.momenta[1].square - (2 * energy - 2 * pull * y - constant**2)) == 0


E = sp.Symbol("E", real=True)


@pytest.mark.parametrize(
    ("H", "left"),
    [
        (px**4 + x, "x"),
        (px**4 + x + py, "x"),
        (px**2 + y**2, "y"),
        (HENON_HEILES.H, "x, y"),
        (px**2 + x * y * px + py**2 + x * y, "x, y"),
        (px**2 + sp.sin(x * y) * px + py**2, "x, y"),
    ],
    ids=[
        "a fourth power",
        "beside an ignorable one",
        "no momentum",
        "a potential",
        "a product",
        "a term of first degree",
    ],
)
def test_momenta_that_are_no_functions_of_their_own_coordinate_are_not_found(H, left):
    n = 2 if H.has(y, py) else 1
    with pytest.raises(
        NotSeparatedError, match=f"no separated equations were found for {left}; .* at most quadratic"
    ):
        separated_momenta(Hamiltonian(H, [x, y][:n], [px, py][:n]), E, EVERYWHERE)


def test_terms_of_first_degree_are_shifts_where_they_belong_to_their_own_coordinate():
    """(p_x + x)² + p_y² + y⁴: p_x = −x ± …, the twin of what does not separate."""
    momenta, constants = separated_momenta(
        Hamiltonian((px + x) ** 2 + py**2 + y**4, [x, y], [px, py]), E, EVERYWHERE
    )
    assert momenta[0].shift == -x
    assert sp.expand(constants[0][1] - (px + x) ** 2) == 0
    assert sp.expand(momenta[1].square - (E - constants[0][0] - y**4)) == 0


def test_arcs_of_one_coordinate_leave_the_others_alone():
    def separable(V):
        return is_separable(Hamiltonian((px**2 + py**2) / 2 + V, [x, y], [px, py]))

    assert separable(sp.asin(sp.sin(x)) + y**2).holds
    assert separable(sp.acos(x / 4) + y**2).holds
    assert separable(sp.asin(sp.sin(x + y))).undecided
    assert separable(sp.acos((x + y) / 4)).fails


def test_a_momentum_that_may_not_stand_in_the_hamiltonian_is_named():
    """Li₂(x) + Li₂(1 − x) + log x log(1 − x) = π²/6 (Euler), which is not proved here, so p_y may be there or not."""
    euler = sp.polylog(2, x) + sp.polylog(2, 1 - x) + sp.log(x) * sp.log(1 - x) - sp.pi**2 / 6
    inside = Domain((x > 0, x < 1))
    verdict = is_separable(Hamiltonian(px**2 + euler * py + y**2, [x, y], [px, py]), inside, budget=0.2)
    assert verdict.undecided
    assert verdict.feedback == "whether H depends on p_y was not decided"
    without = is_separable(Hamiltonian(px**2 + y**2, [x, y], [px, py]), inside)
    assert without.feedback == "y does not separate: H depends on y, and not on its momentum p_y"


@pytest.mark.parametrize(
    ("hidden", "twin"),
    [
        (1 / (sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1), 1 / (sp.sin(x) ** 2 + sp.cos(x) ** 2 - 2)),
        (sp.log((y + 1) ** 2 - y**2 - 2 * y - 1), sp.log((y + 1) ** 2 - y**2 - 2 * y)),
    ],
)
def test_what_has_a_value_nowhere_does_not_separate(hidden, twin):
    for added in (0, y**2):
        verdict = is_separable(Hamiltonian(PLANE + added + hidden, [x, y], [px, py]))
        assert verdict.fails
        assert verdict.feedback.startswith("H has a value nowhere")
        assert is_separable(Hamiltonian(PLANE + added + twin, [x, y], [px, py])).holds
