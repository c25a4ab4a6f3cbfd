"""Integrals that look like known ones and are others: no formula is given; and where those that are given are valid."""

from types import SimpleNamespace

import pytest
import sympy as sp
from flint import arb

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import Claim
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.actions import action_variables
from canon.mechanics.integrable.closed_form import actions_in_closed_form as module
from canon.mechanics.integrable.closed_form.actions_in_closed_form import closed_actions, neighbouring_tori
from canon.mechanics.integrable.closed_form.angles_in_closed_form import closed_angles
from canon.mechanics.integrable.closed_form.incomplete_integrals import integrals_by_terms
from canon.mechanics.integrable.closed_form.validity import validity
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.mechanics.integrable.cycles import CycleKind

q, p, c = sp.symbols("q p c", real=True)
r, a, k = sp.symbols("r a k", positive=True)
HALF = sp.Rational(1, 2)
WALL = 1 / sp.sin(q) ** 2


def torus_of(H, start, parameters=None, **more):
    z = next(iter(start))
    return action_variables(hamilton_jacobi(Hamiltonian(H, z, p)), start, parameters, digits=8, **more)


def recognised(torus):
    (momentum,), (cycle,) = torus.integral.momenta, torus.cycles
    return module.recognised(momentum, cycle, torus.values)


STRANGERS = {
    "a shift that moves": ((p - sp.cos(q)) ** 2 / 2, "free rotation", (p - 1) ** 2 / 2, {q: 0, p: 4}, {}),
    "a wall of the square": (
        p**2 / 2 + 1 / sp.sin(q**2) ** 2,
        "polar angle",
        p**2 / 2 + 1 / sp.sin(2 * q) ** 2,
        {q: 1, p: 1},
        {},
    ),
    "a well softer than the isochrone": (
        p**2 / 2 + 1 / (2 * r**2) - 4 / (1 + r),
        "isochrone",
        p**2 / 2 + 1 / (2 * r**2) - 4 / (1 + sp.sqrt(1 + r**2)),
        {r: 1, p: HALF},
        {},
    ),
    "a spring of an unknown kind": (
        p**2 / 2 + q**2 / 2 + c * q**4,
        "quartic well",
        p**2 / 2 + q**2 / 2 + a * q**4,
        {q: 0, p: 1},
        {c: 1, a: 1},
    ),
    "a pull of an unknown sign": (
        p**2 / 2 + WALL + c * sp.cos(q),
        "motion on a sphere",
        p**2 / 2 + WALL - a * sp.cos(q),
        {q: 1, p: 1},
        {c: 1, a: 1},
    ),
    "a square on the sphere": (
        p**2 / 2 + WALL + sp.cos(q) ** 2 + sp.cos(q) / 3,
        "motion on a sphere",
        p**2 / 2 + WALL + sp.cos(q) / 3,
        {q: 1, p: 1},
        {},
    ),
    "a wave twice a turn": (
        p * (2 + sp.cos(2 * q)),
        "rotation linear in p",
        p * (2 + sp.cos(q)),
        {q: 0, p: 1},
        {},
    ),
    "over both complex roots": (
        p**2 / 2 - sp.cos(q) ** 2,
        "elliptic coordinates",
        p**2 / 2 + sp.cos(q) ** 2,
        {q: 0, p: 2},
        {},
    ),
}


@pytest.mark.parametrize("name", STRANGERS)
def test_a_neighbour_of_a_known_integral_has_no_formula(name):
    stranger, known, neighbour, start, parameters = STRANGERS[name]
    assert recognised(torus_of(stranger, start, parameters)) is None
    assert recognised(torus_of(neighbour, start, parameters))[1] == known


@pytest.mark.parametrize("H", [p**2 / 2 - sp.cos(q), p**2 / 2 + sp.cos(q) ** 2 / 4])
def test_two_turns_have_another_formula_than_one(H):
    start = {q: 0, p: 3}
    once, twice = torus_of(H, start), torus_of(H, start, periods={q: 4 * sp.pi})
    assert twice.J[0].overlaps(2 * once.J[0])
    assert recognised(once) is not None
    assert recognised(twice) is None


SECOND_HARMONICS = {
    "between other places than ±q": (p**2 / 2 + 2 * sp.cos(q) + 4 * sp.cos(q) ** 2, {q: 2, p: HALF}),
    "the same mirrored": (p**2 / 2 - 2 * sp.cos(q) + 4 * sp.cos(q) ** 2, {q: 1, p: HALF}),
    "about the lower of two places": (p**2 / 2 - sp.cos(q) - 4 * sp.cos(q) ** 2, {q: 0, p: HALF}),
    "about the upper of two places": (p**2 / 2 - sp.cos(q) - 4 * sp.cos(q) ** 2, {q: 3, p: HALF}),
}


@pytest.mark.parametrize("name", SECOND_HARMONICS)
def test_a_second_harmonic_has_the_action_of_its_interval(name):
    torus = torus_of(*SECOND_HARMONICS[name])
    formula, known = recognised(torus)
    assert known == "elliptic coordinates"
    assert module.lies_in(formula, torus.values, torus.J[0])
    assert not module.lies_in(formula * (1 + sp.Rational(1, 10**6)), torus.values, torus.J[0])
    kind = validity(torus).kind
    assert len(kind) > 1
    assert all(f.subs(torus.values).n() > 0 for f in kind)


@pytest.mark.parametrize(
    ("start", "kind"), [({q: 1, p: sp.Rational(1, 4)}, -1), ({q: 0, p: 1}, 1)], ids=["in one", "over both"]
)
def test_two_wells_have_formulas_on_both_sides_of_their_separatrix(start, kind):
    torus = torus_of(p**2 / 2 - q**2 / 2 + q**4 / 4, start)
    assert validity(torus).kind == (kind * 2 * torus.integral.energy,)
    hard = torus_of(p**2 / 2 + q**2 / 2 + q**4 / 4, start)
    assert validity(hard).kind == ()


def test_a_soft_spring_holds_below_its_hills():
    """V = q²/2 − a q⁴/4 rises to 1/(4 a)."""
    torus = torus_of(p**2 / 2 + q**2 / 2 - a * q**4 / 4, {q: 0, p: HALF}, {a: 1})
    E, bounded = torus.integral.energy, validity(torus).bounded
    for energy, inside in ((sp.Rational(24, 100), True), (sp.Rational(26, 100), False), (-HALF, False)):
        assert all(f.subs({E: energy, a: 1}) > 0 for f in bounded) == inside


@pytest.mark.slow
def test_an_action_of_a_soft_spring_is_judged_on_bounded_motions():
    """Beyond the hills 1 − 4 b E is negative, and so is no motion there a counterexample to |1 − 4 b E|."""
    keys = {
        "q": ["q"],
        "p": ["p"],
        "H": "p**2/2 + q**2/2 - b*q**4/4",
        "parameters": {"b": "positive", "E": "real"},
    }
    right = "2*sqrt(2*(R + 1))/(3*pi*b)*(elliptic_e((1 - R)/(1 + R)) - R*elliptic_k((1 - R)/(1 + R)))"
    for root in ("sqrt(1 - 4*b*E)", "sqrt(Abs(1 - 4*b*E))"):
        assert judge(Claim("a", "action-angle", {**keys, "J": [right.replace("R", root)]})).holds
    wrong = right.replace("R", "sqrt(1 - 2*b*E)")
    assert judge(Claim("a", "action-angle", {**keys, "J": [wrong]})).fails


def test_a_rate_that_vanishes_on_the_way_is_no_turn():
    """With θ̇ = a + b cos θ and b > a no turn is ended: |a² − b²| is as right as a² − b²."""
    turning = torus_of(p * (a + k * sp.cos(q)), {q: 0, p: 1}, {a: 2, k: 1})
    assert validity(turning).bounded == (a**2 - k**2,)
    assert validity(torus_of(p - k * sp.cos(q), {q: 0, p: 3}, {k: 1})).bounded == ()
    keys = {"q": ["theta"], "p": ["p"], "H": "p*(a + b*cos(theta))", "energy": "E"} | {
        "parameters": {"a": "positive", "b": "positive", "E": "real"}
    }
    for square, status in (("a**2 - b**2", "HOLDS"), ("Abs(a**2 - b**2)", "HOLDS"), ("a**2 + b**2", "FAILS")):
        verdict = judge(Claim("a", "action-angle", {**keys, "J": [f"E/sqrt({square})"]}))
        assert verdict.status.name == status


@pytest.mark.parametrize(
    ("H", "start"),
    [
        (p**2 / 2 + c / sp.sin(q) ** 2, {q: 1, p: 1}),
        (p**2 / 2 + c * q**4, {q: 0, p: 1}),
        (p**2 / 2 + c / r**2 - 3 / r, {r: 1, p: HALF}),
        (p**2 / 2 + c / r**2 + r**2, {r: 1, p: HALF}),
        (p**2 / 2 + c / r**2 - 5 / (1 + sp.sqrt(1 + r**2)), {r: 1, p: HALF}),
        (p**2 / 2 + c * sp.exp(-2 * q) - 2 * sp.exp(-q), {q: 0, p: HALF}),
    ],
    ids=["polar angle", "even power", "Kepler", "radial oscillator", "isochrone", "Morse"],
)
def test_without_a_wall_no_motion_is_bounded(H, start):
    """With c < 0 the coordinate runs away or into a singular place."""
    torus = torus_of(H, start, {c: 1})
    bounded = validity(torus).bounded
    assert all(f.subs(torus.values) > 0 for f in bounded)
    assert not all(f.subs({**torus.values, c: -1}) > 0 for f in bounded)


@pytest.mark.slow
def test_an_action_between_walls_of_an_unknown_sign_is_judged_where_there_are_walls():
    keys = {"q": ["q"], "p": ["p"], "H": "p**2/2 + c/sin(q)**2", "energy": "E"} | {
        "parameters": {"c": "real", "E": "real"}
    }
    for J, status in (
        ("sqrt(2*Abs(E)) - sqrt(2*Abs(c))", "HOLDS"),
        ("sqrt(2*Abs(E)) + sqrt(2*Abs(c))", "FAILS"),
    ):
        assert judge(Claim("a", "action-angle", {**keys, "J": [J]})).status.name == status


def test_neighbouring_tori_are_of_the_same_kind():
    """Just below the separatrix a 64th more of the momentum turns over."""
    below = torus_of(p**2 / 2 - sp.cos(q), {q: 0, p: sp.Rational(199, 100)})
    found = neighbouring_tori(below)
    assert [t.cycles[0].kind for t in found] == [CycleKind.LIBRATION] * 3
    assert [t.values[p] / below.values[p] - 1 for t in found] == [
        0,
        -sp.Rational(1, 64),
        sp.Rational(1, 1024),
    ]


def test_a_formula_is_compared_on_three_tori_or_not_given(monkeypatch):
    """From rest the place is changed in proportion, as there is no momentum."""
    resting = torus_of(p**2 / 2 + q**2 / 2, {q: 1, p: 0})
    assert [t.values[q] for t in neighbouring_tori(resting)] == [1, sp.Rational(65, 64), sp.Rational(63, 64)]
    assert closed_actions(resting)[0].tori == 3
    monkeypatch.setattr(module, "NEIGHBOURS", (sp.S.Zero, sp.Rational(1, 64)))
    assert closed_actions(resting) == closed_angles(resting) == (None,)


PLACES = SimpleNamespace(kind=CycleKind.LIBRATION, turning_points=(arb(0.2), arb(1.3)))
TURNING = SimpleNamespace(kind=CycleKind.ROTATION, period=2 * sp.pi, sign=1)


def swinging(middle):
    return SimpleNamespace(kind=CycleKind.LIBRATION, turning_points=(arb(middle) - 1, arb(middle) + 1))


@pytest.mark.parametrize(
    ("name", "cycle", "known", "unknown"),
    [
        ("polar angle", PLACES, sp.sin(2 * q) ** -2, sp.sin(2 * q + c) ** -2),
        ("polar angle", PLACES, sp.cos(a * q) ** -2, sp.cos(c * q) ** -2),
        ("Pöschl–Teller", PLACES, sp.cosh(a * q) ** -2, sp.cosh(c * q) ** -2),
    ],
)
def test_angles_are_known_of_rates_that_are_positive(name, cycle, known, unknown):
    A, C = (-sp.S.One, sp.Integer(3)) if name == "Pöschl–Teller" else (sp.Integer(5), -sp.S.One)
    assert integrals_by_terms(name, A, {known: C}, q, cycle).keys() == {1, known}
    assert integrals_by_terms(name, A, {unknown: C}, q, cycle) is None


@pytest.mark.parametrize(("middle", "known"), [(0.0, True), (float(sp.pi), True), (float(2 * sp.pi), False)])
def test_angles_of_a_pendulum_are_known_about_its_first_places(middle, known):
    found = integrals_by_terms(
        "pendulum, libration", sp.S.One, {sp.cos(q): 2 * sp.S.One}, q, swinging(middle)
    )
    assert (found is not None) == known


def test_a_pendulum_that_turns_needs_to_know_where_its_lowest_place_is():
    for strength, known in ((a, True), (-a, True), (c, False)):
        found = integrals_by_terms("pendulum, rotation", sp.Integer(9), {sp.cos(q): strength}, q, TURNING)
        assert (found is not None) == known


def test_angles_are_left_open_where_one_integral_is_not_known():
    """A rotation linear in p has an action; and two oscillators whose energy weighs their springs too."""
    linear = torus_of(p * (2 + sp.cos(q)), {q: 0, p: 1})
    assert closed_actions(linear)[0].name == "rotation linear in p"
    assert closed_angles(linear) == (None,)
    x, y, px, py = sp.symbols("x y p_x p_y", real=True)
    liouville = Hamiltonian((px**2 + py**2 + x**2 + 2 * y**2 + x) / (2 + x**2 + y**2), [x, y], [px, py])
    torus = action_variables(hamilton_jacobi(liouville), {x: 0, y: 0, px: HALF, py: HALF}, digits=8)
    assert closed_angles(torus) == (None, None)
