"""What a second reader found in perturbation theory, actions and steps: each refused or right now, with a neighbour."""

from math import isnan

import pytest
import sympy as sp

from canon import Hamiltonian
from canon.mechanics import (
    action_variables,
    adiabatic_invariants,
    average,
    average_over_anomaly,
    birkhoff_normal_form,
    centre_manifold,
    delaunay_variables,
    formal_integral,
    hamilton_jacobi,
    levi_civita_condition,
    lie_deprit,
    midpoint_step,
    optimal_order,
    poincare_variables,
    runge_kutta_step,
)
from canon.mechanics.integrable.turning_points import NoCycleError
from canon.mechanics.perturbation.averaging import Averaged, AveragingError

q, p, Q, P, tau, T, x, y, px, py = sp.symbols("q p Q P tau T x y p_x p_y", real=True)
theta, phi = sp.symbols("theta phi", real=True)
I, J, eps, h = sp.symbols("I J epsilon h", positive=True)
mu, r, f, L, G, g, k = sp.symbols("mu r f L G g k", positive=True)
PENDULUM = Hamiltonian(p**2 / 2 - sp.cos(q), q, p)


def test_an_average_over_angles_refuses_the_time():
    t = Hamiltonian(p**2, q, p).t
    for forced in (I + eps * I * sp.cos(theta) * sp.cos(t), (1 + t) * I + eps * I * sp.cos(theta)):
        H = Hamiltonian(forced, theta, I)
        with pytest.raises(AveragingError, match="another fast angle"):
            average(H, theta, 1, eps)
        with pytest.raises(AveragingError, match="depends on the time"):
            Averaged(H, (theta,), (I,), eps, 1, None, (I, sp.S.Zero), (sp.S.Zero,), {}).is_average()
    resonant = I + T + eps * I * sp.cos(theta) * sp.cos(tau)
    K = average(Hamiltonian(resonant, [theta, tau], [I, T]), [theta, tau], 1, eps).K
    assert sp.expand(K - (I + T + eps * I * sp.cos(tau - theta) / 2)) == 0


@pytest.mark.parametrize("factor", [sp.Symbol("e", positive=True) ** 2, sp.Symbol("eta", positive=True), k])
def test_a_constant_called_as_the_eccentricity_stays_a_constant(factor):
    found = average_over_anomaly(factor / r**3, mu, r, f, [g], [L, G])
    assert found.in_momenta()[0] == factor * mu**3 / (G**3 * L**3)
    strength = average_over_anomaly(k / r**2, factor, r, f, [g], [L, G])
    assert strength.in_momenta()[0] == k * factor**2 / (G * L**3)


def test_a_strength_called_as_a_variable_is_refused():
    M = sp.Symbol("M", positive=True)
    R, p_r, p_phi = sp.Symbol("R", positive=True), *sp.symbols("p_r p_phi", real=True)
    with pytest.raises(ValueError, match="G is the name of a variable"):
        average_over_anomaly(k / r**2, G * M, r, f, [g], [L, G])
    for strength in (G * M, sp.Symbol("L", positive=True), sp.Symbol("p_r", positive=True)):
        with pytest.raises(ValueError, match="as mu in place of"):
            delaunay_variables([R, phi], [p_r, p_phi], strength)
    with pytest.raises(ValueError, match="Lambda in them"):
        poincare_variables([R, phi], [p_r, p_phi], 1, sp.Symbol("Lambda", positive=True))
    with pytest.raises(
        ValueError, match="r in them"
    ):  # the names of the plane of the orbit, through which it goes
        delaunay_variables([R, theta, phi], [p_r, sp.Symbol("p_theta", real=True), p_phi], r)
    right = delaunay_variables([R, phi], [p_r, p_phi], mu * M)
    assert right.new.q_dot[1] == 0
    # poincare_variables has no G among its variables
    assert poincare_variables([R, phi], [p_r, p_phi], G * M).new.q_dot[1] == 0


def test_divisors_that_vanish_identically_are_refused_however_they_are_written():
    wave = eps * sp.cos(theta - phi)
    one, root = sp.sin(tau) ** 2 + sp.cos(tau) ** 2, sp.sqrt(3 + 2 * sp.sqrt(2))
    for H0, slow in ((one * I + J, tau), (root * I + (1 + sp.sqrt(2)) * J, None)):
        H = Hamiltonian(H0 + wave, [theta, phi], [I, J])
        with pytest.raises(AveragingError, match="divisor k·ω = 0"):
            adiabatic_invariants(H, [theta, phi], 1, eps, slow_time=slow)
    H = Hamiltonian((2 + tau**2) * I + J + wave, [theta, phi], [I, J])
    found = adiabatic_invariants(H, [theta, phi], 1, eps, slow_time=tau)[0]
    assert sp.expand(found.J - (I + wave / (1 + tau**2))) == 0


def test_an_equilibrium_is_known_by_name_and_a_misspelt_one_refused():
    for key in (q, "q", sp.Symbol("q")):
        assert birkhoff_normal_form(PENDULUM, 4, at={key: sp.pi}).diagonal.exponents[0].is_real
    with pytest.raises(ValueError, match="at names anything, which is none of q, p"):
        birkhoff_normal_form(PENDULUM, 4, at={"anything": 7})
    with pytest.raises(ValueError, match="twice"):
        birkhoff_normal_form(PENDULUM, 4, at={q: sp.pi, "q": 0})
    saddle = Hamiltonian((px**2 + py**2) / 2 + y**2 - (x - 1) ** 2 + (x - 1) ** 3, [x, y], [px, py])
    assert centre_manifold(saddle, 2, at={"x": 1}).equilibrium[x].contains(1)
    with pytest.raises(ValueError, match="at names z"):
        centre_manifold(saddle, 2, at={"z": 1})


def test_periods_are_known_by_name_and_proved_wrong_ones_refused():
    free = hamilton_jacobi(Hamiltonian(p**2 / 2, q, p))
    for key in (q, "q", sp.Symbol("q")):
        assert abs(float(action_variables(free, {q: 0, p: 1}, periods={key: 1}).J[0]) - 0.15915494) < 1e-8
    with pytest.raises(ValueError, match="periods names x"):
        action_variables(free, {q: 0, p: 1}, periods={x: 1})
    with pytest.raises(ValueError, match="positive number"):
        action_variables(free, {q: 0, p: 1}, periods={q: -1})
    rotating = hamilton_jacobi(PENDULUM)
    for wrong in (sp.pi, 6.283185307179586):
        with pytest.raises(NoCycleError, match="has not the period"):
            action_variables(rotating, {q: 0, p: 3}, periods={q: wrong})
    once, twice = (action_variables(rotating, {q: 0, p: 3}, periods={q: n * 2 * sp.pi}).J[0] for n in (1, 2))
    assert (2 * once).overlaps(twice)
    assert abs(float(once) - 2.63193) < 1e-4
    doubled = hamilton_jacobi(Hamiltonian(p**2 / 2 - sp.cos(2 * q), q, p))
    assert action_variables(doubled, {q: 0, p: 3}, periods={q: sp.pi}).cycles[0].period == sp.pi


def test_the_actions_of_a_float_are_those_of_all_its_digits():
    oscillator = hamilton_jacobi(Hamiltonian(p**2 / 2 + k * q**2 / 2, q, p))
    tenth = sp.Float("0.1", 50)
    fine, coarse = (
        action_variables(oscillator, {q: 1, p: 1}, {k: value}).frequencies[0] for value in (tenth, 0.1)
    )
    due = [sp.sqrt(sp.Rational(value)).evalf(30) for value in (tenth, 0.1)]
    assert abs(sp.Float(fine.mid().str(30, radius=False), 30) - due[0]) < 1e-27
    assert abs(sp.Float(coarse.mid().str(30, radius=False), 30) - due[1]) < 1e-27
    assert abs(due[0] - due[1]) > 1e-18


def test_weights_and_resonances_are_whole_numbers_one_each():
    form = birkhoff_normal_form(
        Hamiltonian((px**2 + py**2 + x**2 + 2 * y**2) / 2 + x**2 * y, [x, y], [px, py]), 4
    )
    for weights in ([0.5, 0.5], [1, 1, 1], [1], 3):
        with pytest.raises(ValueError, match="the weights should have 2 whole numbers"):
            formal_integral(form, weights)
    assert formal_integral(form, [sp.Integer(1), 0]).is_formal_integral().holds
    a, b = sp.symbols("omega1 omega2", positive=True)
    H = Hamiltonian(a * I + b * J + eps * sp.cos(theta - 2 * phi), [theta, phi], [I, J])
    for vector in ((0.5, -1), (1,), (1, -2, 0)):
        with pytest.raises(ValueError, match="each of the resonances should have 2 whole numbers"):
            average(H, [theta, phi], 1, eps, resonances=[vector])
    assert average(H, [theta, phi], 1, eps, resonances=[(1, -2)]).K.has(eps)
    with pytest.raises(ValueError, match="each of the resonances"):
        birkhoff_normal_form(form.source, 3, resonances=[(0.5, -1)])


def test_a_small_divisor_with_parameters_has_no_number():
    a, b = sp.symbols("a b", positive=True)
    quadratic = (px**2 + a**2 * x**2 + py**2 + b**2 * y**2) / 2
    form = birkhoff_normal_form(Hamiltonian(quadratic + x**2 * y**2, [x, y], [px, py]), 4)
    assert form.small_divisors
    assert all(isnan(s.value) for s in form.small_divisors)
    known = birkhoff_normal_form(Hamiltonian(form.source.H.subs({a: 1}), [x, y], [px, py]), 4)
    numbers = [s.value for s in known.small_divisors]
    assert not isnan(numbers[0])
    assert isnan(numbers[-1])


def test_the_small_quantity_is_a_symbol():
    for small in (1, sp.S(2), "epsilon"):
        with pytest.raises(TypeError, match="small quantity should be a symbol"):
            lie_deprit(q, p, [q], [p], 2, small)
    assert lie_deprit(q, p, [q], [p], 2, eps).subs(eps, 1) == q + 1


def test_steps_take_the_time_of_their_stages():
    H = Hamiltonian(p**2 / 2 + Hamiltonian(p, q, p).t * q, q, p)
    t, half = H.t, sp.Rational(1, 2)
    middle = midpoint_step(H, h, [Q], [P])
    assert sp.expand(middle.equations[1] - (P - p + h * (t + h / 2))) == 0
    assert middle.is_canonical().holds
    # p = p₀ − t h − h²/2 and q = q₀ + p₀ h − t h²/2 − h³/6: Kutta's third order is exact here
    kutta = runge_kutta_step(
        H, h, [[], [half], [-1, 2]], [sp.Rational(1, 6), sp.Rational(2, 3), sp.Rational(1, 6)]
    )
    assert sp.expand(kutta.new_q[0] - (q + p * h - t * h**2 / 2 - h**3 / 6)) == 0
    assert sp.expand(kutta.new_p[0] - (p - t * h - h**2 / 2)) == 0
    with pytest.raises(ValueError, match="b has 2 entries for 1 stages"):
        runge_kutta_step(H, h, [[]], [0, 1])
    with pytest.raises(ValueError, match="new_q has 2 entries"):
        midpoint_step(H, h, [Q, x], [P])


def test_other_inputs_are_told_in_words_or_taken():
    two = Hamiltonian((px**2 + py**2) / 2 + x * y, [x, y], [px, py])
    assert levi_civita_condition(two, 0, 1) == px * py
    for i, j in ((0, 2), (1, 1), (-1, 0)):
        with pytest.raises(ValueError, match="from 0 to 1"):
            levi_civita_condition(two, i, j)
    with pytest.raises(ValueError, match="one coordinate has no condition"):
        levi_civita_condition(PENDULUM, 0, 1)
    form = birkhoff_normal_form(PENDULUM, 6)
    assert optimal_order(form, sp.Rational(1, 10)) == optimal_order(form, 0.1)
    free = Hamiltonian((px**2 + py**2) / 2, [x, y], [px, py])
    for focal in (0, sp.S.Zero, -1):
        with pytest.raises(ValueError, match="half the distance of the foci, a positive number"):
            hamilton_jacobi(free, "elliptic", focal=focal)
    assert hamilton_jacobi(free, "elliptic", focal=1).H.q[0].name == "u"
