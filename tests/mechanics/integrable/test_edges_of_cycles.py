"""Cycles at their edges: other potentials, shifts, frequencies that vanish, starts at rest, poles beside the path."""

from dataclasses import replace

import mpmath as mp
import pytest
import sympy as sp
from flint import acb, arb

from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable import cycle_quadrature
from canon.mechanics.integrable.actions import action_variables, angles
from canon.mechanics.integrable.ball_function import BallFunction, NotHolomorphicError
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.mechanics.integrable.cycle_quadrature import Libration
from canon.mechanics.integrable.cycles import CycleKind
from canon.mechanics.integrable.function_splitting import product_parts, reference_places, sum_parts
from canon.mechanics.integrable.separated_momenta import NotSeparatedError
from canon.mechanics.integrable.turning_points import NoCycleError
from canon.proof.domain.balls import precision
from canon.proof.domain.domain import EVERYWHERE
from canon.proof.domain.verdict import Status
from canon.proof.vanish import vanishes

q, p, p_r, phi, p_phi, x, y = sp.symbols("q p p_r phi p_phi x y", real=True)
r, s, k = sp.symbols("r s k", positive=True)
HALF = sp.Rational(1, 2)
OSCILLATOR = hamilton_jacobi(Hamiltonian(p**2 / 2 + q**2 / 2, q, p))
ORBIT = {r: 1, phi: 0, p_r: HALF, p_phi: 1}


def radial(V, parameters=None, digits=12):
    H = Hamiltonian(p_r**2 / 2 + p_phi**2 / (2 * r**2) + V, [r, phi], [p_r, p_phi])
    return action_variables(hamilton_jacobi(H), ORBIT, parameters, digits)


def period_by_mpmath(V):
    """Return 2 ∫ dr/p_r between the turning points, and (1/π) ∫ p_r dr."""
    square = sp.lambdify(r, 2 * (sp.Rational(5, 8) + V.subs(r, 1) - V) - 1 / r**2, "mpmath")
    with mp.workdps(20):
        low, high = (mp.findroot(square, about, solver="anderson") for about in ((0.5, 0.99), (1.05, 2)))
        half, middle = (high - low) / 2, (high + low) / 2

        def root(u):
            return mp.sqrt(abs(square(middle + half * mp.sin(u))))

        ends = [-mp.pi / 2, 0, mp.pi / 2]
        time = 2 * mp.quad(lambda u: half * mp.cos(u) / root(u), ends)
        return float(time), float(mp.quad(lambda u: half * mp.cos(u) * root(u), ends) / mp.pi)


@pytest.mark.parametrize(
    ("V", "parameters"),
    [(sp.log(r), None), (r**sp.pi, None), (r**k, {k: 2}), (r**k, {k: sp.Rational(5, 2)})],
    ids=str,
)
def test_logarithms_and_any_powers_have_actions_and_frequencies(V, parameters):
    torus = radial(V, parameters)
    time, action = period_by_mpmath(V.subs(parameters or {}))
    assert float(torus.frequencies[0]) == pytest.approx(2 * sp.pi.n() / time, rel=1e-8)
    assert float(torus.J[0]) == pytest.approx(action, rel=1e-8)
    assert all(ball.rel_accuracy_bits() > 39 for ball in (*torus.J, *torus.frequencies))


def test_what_is_asked_of_actions_in_vain_is_told():
    with pytest.raises(ValueError, match="the digits should be a whole number from 1, not 0"):
        action_variables(OSCILLATOR, {q: 1, p: 1}, digits=0)
    with pytest.raises(ValueError, match="k has no value; give it among the parameters"):
        BallFunction(k * q, q, {})
    with pytest.raises(
        NotHolomorphicError, match="erf is not among the functions that cycles are integrated over"
    ):
        BallFunction(sp.erf(q), q, {})
    drift = hamilton_jacobi(Hamiltonian(p * (2 + q**2), q, p))
    with pytest.raises(
        NoCycleError, match="p is no constant and has one value only: q runs through no cycle"
    ):
        action_variables(drift, {q: 0, p: 1})


def test_a_modulus_is_continued_from_each_side_and_not_across():
    modulus = BallFunction(sp.Abs(q), q, {})
    around = acb(arb(0, 1))
    assert modulus(acb(-3, 1), analytic=True) == acb(3, -1)
    assert modulus(around).contains(acb(1))
    assert not modulus(around).contains(acb(2))
    assert not modulus(around, analytic=True).is_finite()
    assert not modulus(acb(arb(0, 1), 1)).is_finite()


def test_in_a_frame_that_moves_along_a_frequency_may_vanish():
    """H = (p_x² + x² + p_y²)/2 − √2 p_y has ω_y = p_y − √2: of 10⁻²⁵ three digits are found, of 0 none."""
    px, py = sp.symbols("p_x p_y", real=True)
    moving = hamilton_jacobi(Hamiltonian((px**2 + x**2 + py**2) / 2 - sp.sqrt(2) * py, [x, y], [px, py]))
    start = {x: 0, y: 0, px: 1, py: sp.sqrt(2)}
    slow = action_variables(moving, start | {py: sp.sqrt(2) + sp.Rational(1, 10**25)}, digits=3)
    assert [float(w) for w in slow.frequencies] == pytest.approx([1, 1e-25], rel=1e-3)
    with pytest.raises(NoCycleError, match=r"not found to 3 digits: .* or a frequency is zero"):
        action_variables(moving, start, digits=3)
    driven = hamilton_jacobi(Hamiltonian(p - sp.cos(q), q, p))
    with pytest.raises(NoCycleError, match="or an action or a frequency is zero"):
        action_variables(driven, {q: 0, p: 1}, digits=3)


def test_angles_of_a_shifted_momentum():
    """p_r = p′ + r p_φ turns oscillator and rotor into each other's way: θ_φ = φ + (r² − A²)/2."""
    H = Hamiltonian((p_r - p_phi * x) ** 2 / 2 + x**2 / 2 + p_phi**2 / 2, [x, phi], [p_r, p_phi])
    torus = action_variables(hamilton_jacobi(H), {x: 0, phi: 0, p_r: 1, p_phi: HALF}, digits=10)
    assert [float(J) for J in torus.J] == pytest.approx([0.5, 0.5])
    assert [float(w) for w in torus.frequencies] == pytest.approx([1, 0.5])
    for place, momentum, thirds in ((HALF, 1, 2), (HALF, -1, 4), (-1, -HALF, 0), (1, HALF, 3)):
        found = angles(torus, {x: place, phi: 2, p_r: momentum, p_phi: HALF})
        assert [float(a) for a in found] == pytest.approx(
            [thirds * float(sp.pi) / 3, 2 + (float(place) ** 2 - 1) / 2]
        )


def test_a_narrow_well_is_entered_from_rest():
    """Between −10⁻³ and 10⁻³; of 10⁻²⁵ no place inside is found."""
    narrow = hamilton_jacobi(Hamiltonian(p**2 / 2 + 10**6 * q**2 / 2, q, p))
    for side in (1, -1):
        torus = action_variables(narrow, {q: sp.Rational(side, 1000), p: 0}, digits=8)
        assert torus.cycles[0].kind is CycleKind.LIBRATION
        assert float(torus.J[0]) == pytest.approx(1 / 2000)
    with pytest.raises(
        NoCycleError, match="q is at rest too near to an equilibrium or a separatrix; change the start"
    ):
        action_variables(narrow, {q: sp.Rational(1, 10**25), p: 0}, digits=8)


def between(square):
    """Return the libration of p² between −1 and 1."""
    return Libration(BallFunction(square, q, {}), BallFunction(square.diff(q), q, {}), arb(-1), arb(1), "q")


def test_a_path_through_a_pole_is_left_for_a_narrower_one(monkeypatch):
    """∫ √(1 − q²)/(1 + q²) dq = π (√2 − 1): the first rectangle has its upper side through i."""
    monkeypatch.setattr(cycle_quadrature.integral_along, "__defaults__", (None, 3000))
    with precision(64):
        found = between(1 - q**2).integral(lambda z, _: 1 / (z * z + 1), 1)
        assert found.overlaps((arb(2).sqrt() - 1) * arb.pi())
        assert not found.overlaps((arb(2).sqrt() - 1) * arb.pi() * (1 + arb(2) ** -20))
        with pytest.raises(
            NoCycleError, match="between -1 and 1 is too near to a separatrix or to a singular point"
        ):
            between(1 - q**2).integral(lambda z, _: acb("nan"), 1)


def test_zeros_beside_the_interval_leave_no_rectangle():
    """p² = (1 − q²)(q² + ε²) has zeros at ±i ε: the rectangle is narrower, or none is wide enough."""
    with precision(64):
        near = between((1 - q**2) * (q**2 + sp.Rational(1, 100)))
        assert float(near.integral(lambda z, _: acb(1), 1)) == pytest.approx(0.698604650114, rel=1e-11)
        with pytest.raises(NoCycleError, match="ask for more digits, or change the start"):
            between((1 - q**2) * (q**2 + sp.Rational(1, 10**30))).integral(lambda z, _: acb(1), 1)


def test_sums_and_products_are_split_at_reference_places():
    apart = sp.log(r * s + r + s + 1)
    parts = sum_parts(apart, [[r], [s]], EVERYWHERE)
    assert [f.free_symbols for f in parts] == [{r}, {s}]
    assert vanishes(sum(parts) - apart).holds
    assert sum_parts(apart + r * s, [[r], [s]], EVERYWHERE) is None
    waves = sp.sin(x + y) + sp.sin(x - y) + 2 * sp.sin(x) * sp.cos(y)
    factors = product_parts(waves, [[x], [y]], EVERYWHERE)
    assert [f.free_symbols for f in factors] == [{x}, {y}]
    assert vanishes(factors[0] * factors[1] - waves).holds
    assert product_parts(waves + 1, [[x], [y]], EVERYWHERE) is None


def test_there_is_no_reference_place_for_what_is_negative():
    below = sp.Symbol("n", negative=True)
    assert list(reference_places([[x], [below]])) == []
    assert {place[r] > 0 for place in reference_places([[x], [r]])} == {True}


def test_a_free_particle_has_its_action_function_and_is_judged_without_time():
    free = hamilton_jacobi(Hamiltonian(p**2 / 2, q, p))
    assert sp.sqrt(2) * sp.sqrt(free.energy) * q == free.W
    assert free.motion == (sp.sqrt(2) * q / (2 * sp.sqrt(free.energy)),)
    assert free.is_complete_integral(budget=0.0).status is Status.HOLDS


def test_where_separability_is_not_decided_that_is_told():
    unknown = Hamiltonian(p**2 * sp.besselj(0, k - x), q, p)
    with pytest.raises(
        NotSeparatedError, match="whether H separates in q was not decided; declare what is positive"
    ):
        hamilton_jacobi(unknown)


def test_a_constant_on_which_nothing_depends_makes_no_complete_integral():
    """h = sin 2α − 2 sin α cos α is zero: both momenta depend on E alone, which their derivatives hide."""
    px, py = sp.symbols("p_x p_y", real=True)
    oscillators = hamilton_jacobi(Hamiltonian((px**2 + py**2 + x**2 + y**2) / 2, [x, y], [px, py]))
    assert oscillators.is_complete_integral().holds
    alpha, E = oscillators.constants
    hidden = sp.sin(2 * alpha) - 2 * sp.sin(alpha) * sp.cos(alpha)
    one, other = oscillators.momenta
    squares = (replace(one, square=E + hidden - x**2), replace(other, square=E - hidden - y**2))
    verdict = replace(oscillators, momenta=squares).is_complete_integral()
    assert verdict.fails
    assert verdict.feedback == "det ∂²W/∂q∂α vanishes"
    squares = (replace(one, square=E + alpha - x**2), replace(other, square=E - alpha - y**2))
    assert replace(oscillators, momenta=squares).is_complete_integral().holds
