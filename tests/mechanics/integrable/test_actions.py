"""Actions and frequencies: balls that hold published formulas, both routes of a derivative, and what has no cycle."""

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.actions import action_variables, angles, frequencies
from canon.mechanics.integrable.ball_function import NotHolomorphicError
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.mechanics.integrable.cycles import CycleKind
from canon.mechanics.integrable.turning_points import NoCycleError
from canon.proof.domain.balls import precision, value

q, p, x, y, px, py = sp.symbols("q p x y p_x p_y", real=True)
r, theta, m, k, w, D, a, b = sp.symbols("r theta m k omega D a b", positive=True)
phi, psi, p_r, p_theta, p_phi, p_psi = sp.symbols("phi psi p_r p_theta p_phi p_psi", real=True)

CENTRAL = p_r**2 / (2 * m) + p_phi**2 / (2 * m * r**2)
PLANE = ([r, phi], [p_r, p_phi])
PENDULUM = hamilton_jacobi(Hamiltonian(p**2 / 2 - sp.cos(q), q, p))
KEPLER = hamilton_jacobi(Hamiltonian(CENTRAL - k / r, *PLANE))
ISOCHRONE = hamilton_jacobi(Hamiltonian(CENTRAL - k / (b + sp.sqrt(b**2 + r**2)), *PLANE))
MORSE = hamilton_jacobi(Hamiltonian(p**2 / (2 * m) + D * (1 - sp.exp(-a * q)) ** 2, q, p))
POSCHL_TELLER = hamilton_jacobi(Hamiltonian(p**2 / (2 * m) - D / sp.cosh(a * q) ** 2, q, p))
OSCILLATOR = hamilton_jacobi(Hamiltonian(p**2 / (2 * m) + m * w**2 * q**2 / 2, q, p))
small = st.fractions(min_value="1/4", max_value=2, max_denominator=8).map(sp.Rational)


def holds(ball, formula):
    """Whether the ball and the formula, in balls of 200 bits, overlap and the ball is narrow."""
    with precision(200):
        due = value(sp.sympify(formula), {}).real
        return bool(ball.overlaps(due)) and ball.rel_accuracy_bits() > 90


def misses(ball, formula):
    with precision(200):
        return not ball.overlaps(value(sp.sympify(formula), {}).real)


@given(small, small, small, small)
@settings(deadline=None, max_examples=30)  # a sixth of a second each: two integrals in balls
def test_the_oscillator_has_the_action_energy_over_frequency(mass, frequency, place, momentum):
    found = action_variables(OSCILLATOR, {q: place, p: momentum}, {m: mass, w: frequency})
    E = momentum**2 / (2 * mass) + mass * frequency**2 * place**2 / 2
    assert holds(found.J[0], E / frequency)
    assert holds(found.frequencies[0], frequency)
    assert misses(found.J[0], E / frequency * (1 + sp.Rational(1, 10**25)))


@pytest.mark.parametrize("energy", [sp.Rational(-9, 10), sp.S.Zero, sp.Rational(99, 100)])
def test_the_pendulum_librates_as_its_elliptic_integrals_say(energy):
    found = action_variables(PENDULUM, {q: 0, p: sp.sqrt(2 * (1 + energy))})
    modulus = (1 + energy) / 2
    K, E = sp.elliptic_k(modulus), sp.elliptic_e(modulus)
    assert found.cycles[0].kind is CycleKind.LIBRATION
    assert holds(found.J[0], 8 / sp.pi * (E - (1 - modulus) * K))
    assert holds(found.frequencies[0], sp.pi / (2 * K))
    assert misses(found.frequencies[0], sp.pi / (2 * sp.elliptic_k(modulus / 2)))


@pytest.mark.parametrize("place", [sp.Rational(-27, 10), sp.Rational(27, 10)])
def test_the_pendulum_librates_wherever_it_starts_on_its_way(place):
    energy = sp.Rational(99, 100)
    found = action_variables(PENDULUM, {q: place, p: sp.sqrt(2 * (energy + sp.cos(place)))})
    modulus = (1 + energy) / 2
    assert found.cycles[0].kind is CycleKind.LIBRATION
    assert holds(found.frequencies[0], sp.pi / (2 * sp.elliptic_k(modulus)))


@pytest.mark.parametrize("energy", [sp.Rational(101, 100), sp.Integer(3)])
def test_the_pendulum_rotates_as_its_elliptic_integrals_say(energy):
    found = action_variables(PENDULUM, {q: 1, p: -sp.sqrt(2 * (energy + sp.cos(1)))})
    modulus = 2 / (1 + energy)
    assert found.cycles[0].kind is CycleKind.ROTATION
    assert holds(found.J[0], -2 * sp.sqrt(2 * (1 + energy)) / sp.pi * sp.elliptic_e(modulus))
    assert holds(found.frequencies[0], -sp.pi * sp.sqrt((1 + energy) / 2) / sp.elliptic_k(modulus))


def test_near_the_separatrix_the_ball_is_right_and_on_it_there_is_no_action():
    off = sp.Rational(1, 10**6)
    found = action_variables(PENDULUM, {q: 0, p: 2 - off}, digits=20)
    modulus = (2 - off) ** 2 / 4
    assert found.frequencies[0].overlaps(
        arb.pi() / 2 / arb(str(mp.ellipk(mp.mpf(str(sp.N(modulus, 40)))))) + arb(0, 1e-8)
    )
    with pytest.raises(NoCycleError, match="separatrix"):
        action_variables(PENDULUM, {q: 0, p: 2})
    with pytest.raises(NoCycleError, match="at rest"):
        action_variables(PENDULUM, {q: 0, p: 0})


@pytest.mark.parametrize(
    "start", [(1, sp.Rational(1, 3), sp.Rational(3, 4)), (2, sp.Rational(-1, 5), sp.Rational(1, 2))]
)
def test_kepler_in_the_plane(start):
    place, radial, L = start
    mass, strength = sp.Rational(3, 2), sp.Rational(5, 4)
    found = action_variables(KEPLER, {r: place, phi: 0, p_r: radial, p_phi: L}, {m: mass, k: strength})
    E = radial**2 / (2 * mass) + L**2 / (2 * mass * place**2) - strength / place
    total = strength * sp.sqrt(mass / (-2 * E))
    assert holds(found.J[0], total - L)
    assert holds(found.J[1], L)
    for omega in found.frequencies:
        assert holds(omega, mass * strength**2 / total**3)
    assert misses(found.J[0], total)


def test_the_isochrone():
    found = action_variables(
        ISOCHRONE, {r: 1, phi: 0, p_r: sp.Rational(1, 3), p_phi: sp.Rational(1, 2)}, {m: 1, k: 1, b: 1}
    )
    E = sp.Rational(1, 18) + sp.Rational(1, 8) - 1 / (1 + sp.sqrt(2))
    L = sp.Rational(1, 2)
    root = sp.sqrt(L**2 + 4)
    assert holds(found.J[0], 1 / sp.sqrt(-2 * E) - (L + root) / 2)
    assert holds(found.frequencies[0], (-2 * E) ** sp.Rational(3, 2))
    assert holds(found.frequencies[1], (-2 * E) ** sp.Rational(3, 2) * (1 + L / root) / 2)


def test_morse_and_poschl_teller():
    found = action_variables(MORSE, {q: 0, p: 1}, {m: 2, D: 3, a: sp.Rational(1, 2)})
    E = sp.Rational(1, 4)
    assert holds(found.J[0], 2 * (sp.sqrt(12) - sp.sqrt(4 * (3 - E))))
    found = action_variables(POSCHL_TELLER, {q: 0, p: 1}, {m: 2, D: 3, a: sp.Rational(1, 2)})
    E = sp.Rational(1, 4) - 3
    assert holds(found.J[0], 2 * (sp.sqrt(12) - sp.sqrt(-4 * E)))
    assert holds(found.frequencies[0], sp.Rational(1, 2) * sp.sqrt(-2 * E / 2))


@pytest.mark.parametrize("place", [5, 15])
def test_a_root_that_turns_on_its_way_about_a_deep_well_is_not_taken_for_the_other_root(place):
    """p²/((q − a)(b − q)) turns past the negative axis on wide paths, where its principal root jumps."""
    found = action_variables(MORSE, {q: place, p: 0}, {m: 1, D: 2, a: 1})
    depth = 2 * sp.exp(-place) - sp.exp(-2 * place)
    assert holds(found.J[0], 2 - 2 * sp.sqrt(depth))
    assert misses(found.J[0], 2 + 2 * sp.sqrt(depth))


def test_an_action_in_a_well_with_steep_walls_is_the_real_integral():
    wall = hamilton_jacobi(Hamiltonian(p**2 / 2 + sp.cosh(q), q, p))
    found = action_variables(wall, {q: 10, p: 1}).J[0]
    with mp.workdps(20):
        E = mp.mpf(1) / 2 + mp.cosh(10)
        end = mp.acosh(E)
        half = mp.quad(
            lambda u: mp.re(mp.sqrt(2 * (E - mp.cosh(end * mp.sin(u))))) * end * mp.cos(u), [0, mp.pi / 2]
        )
    assert abs(float(found) / float(2 * half / mp.pi) - 1) < 1e-12


def test_two_centres_of_which_one_has_no_mass_are_keplers_problem():
    """(u, v) and (−u, −v) are one place: a cycle of both is two revolutions, at half of Kepler's (−2 E)^(3/2)/k."""
    one, two, c = sp.symbols("k1 k2 c", positive=True)
    near, far = sp.sqrt((x - c) ** 2 + y**2), sp.sqrt((x + c) ** 2 + y**2)
    centres = Hamiltonian((px**2 + py**2) / 2 - one / near - two / far, [x, y], [px, py])
    found = hamilton_jacobi(centres, "elliptic", focal=c)
    start = (1, sp.Rational(1, 2), sp.Rational(1, 5), sp.Rational(1, 3))
    values = {one: 1, two: 0, c: sp.Rational(1, 2)}
    torus = action_variables(found, start, values)
    E = torus.values[found.energy]
    for frequency in torus.frequencies:
        assert holds(frequency, (-2 * E) ** sp.Rational(3, 2) / 2)
        assert misses(frequency, (-2 * E) ** sp.Rational(3, 2))
    both = action_variables(found, start, {**values, two: sp.Rational(1, 10)})
    assert not both.frequencies[0].overlaps(both.frequencies[1])


@pytest.mark.parametrize("n", [2, 4, 6])
def test_even_powers_have_the_action_of_their_gamma_functions(n):
    found = action_variables(hamilton_jacobi(Hamiltonian(p**2 / 2 + q**n, q, p)), {q: 0, p: sp.sqrt(2)})
    gammas = sp.gamma(sp.Rational(1, n)) / sp.gamma(sp.Rational(3, 2) + sp.Rational(1, n))
    assert holds(found.J[0], sp.sqrt(2) / (n * sp.sqrt(sp.pi)) * gammas)


TOP = Hamiltonian(
    p_theta**2 / 2
    + (p_phi - p_psi * sp.cos(theta)) ** 2 / (2 * sp.sin(theta) ** 2)
    + p_psi**2 / 3
    + sp.cos(theta),
    [theta, phi, psi],
    [p_theta, p_phi, p_psi],
)
QUARTIC = Hamiltonian(p_r**2 / 2 + p_phi**2 / (2 * r**2) + r**4, *PLANE)
SPHERE = Hamiltonian(
    (p_theta**2 + p_phi**2 / sp.sin(theta) ** 2) / 2 + sp.cos(theta), [theta, phi], [p_theta, p_phi]
)
STARTS = {
    "Lagrange's top": (TOP, {theta: 1, phi: 0, psi: 0, p_theta: sp.Rational(1, 4), p_phi: 2, p_psi: 3}),
    "quartic": (QUARTIC, {r: 1, phi: 0, p_r: sp.Rational(1, 3), p_phi: 1}),
    "spherical pendulum": (
        SPHERE,
        {theta: 2, phi: 0, p_theta: sp.Rational(1, 2), p_phi: sp.Rational(1, 2)},
    ),
}


@pytest.mark.parametrize("name", STARTS)
def test_the_frequencies_are_the_slopes_of_the_energy_between_neighbouring_tori(name):
    H, start = STARTS[name]
    integral = hamilton_jacobi(H)
    step = sp.Rational(1, 10**8)
    middle = action_variables(integral, start, digits=22)
    for moved in H.p[1:2]:
        ends = [
            action_variables(integral, {**start, moved: start[moved] + s * step}, digits=25) for s in (-1, 1)
        ]
        with precision(160):
            energies = [value(found.values[integral.energy], {}).real for found in ends]
            rise = energies[1] - energies[0]
            due = sum(
                (omega * (after - before))
                for omega, before, after in zip(middle.frequencies, ends[0].J, ends[1].J, strict=True)
            )
            assert abs(float(rise - due)) < 1e-14 * abs(float(rise)) + 1e-20


def test_angles_of_the_oscillator_are_those_of_its_circle():
    found = action_variables(OSCILLATOR, {q: 1, p: 1}, {m: 1, w: 1})
    for turn in range(1, 12):
        phase = sp.Rational(turn, 12) * 2 * sp.pi
        state = {q: -sp.sqrt(2) * sp.cos(phase), p: sp.sqrt(2) * sp.sin(phase)}
        assert holds(angles(found, state)[0], phase)
    with pytest.raises(ValueError, match="outside its turning points"):
        angles(found, {q: 2, p: 1})


def test_a_start_at_rest_is_a_turning_point():
    found = action_variables(PENDULUM, {q: 1, p: 0})
    assert holds(found.frequencies[0], sp.pi / (2 * sp.elliptic_k(sp.sin(sp.Rational(1, 2)) ** 2)))
    low, high = found.cycles[0].turning_points
    assert low.overlaps(arb(-1))
    assert high == 1


@pytest.mark.parametrize(
    ("start", "message"),
    [
        ({r: 1, phi: 0, p_r: 2, p_phi: 1}, "not bounded"),
        ({r: 1, phi: 0, p_r: 0, p_phi: 1}, "at rest"),
        ({r: 1, phi: 0, p_r: sp.Rational(1, 2), p_phi: 0}, "singular point"),
    ],
    ids=["hyperbola", "circle", "collision"],
)
def test_what_runs_through_no_cycle_is_told(start, message):
    with pytest.raises(NoCycleError, match=message):
        action_variables(KEPLER, start, {m: 1, k: 1})


def test_bad_input_is_told():
    with pytest.raises(ValueError, match="what p is"):
        action_variables(OSCILLATOR, {q: 1}, {m: 1, w: 1})
    with pytest.raises(ValueError, match="omega has no value"):
        action_variables(OSCILLATOR, {q: 1, p: 1}, {m: 1})
    with pytest.raises(ValueError, match="real number"):
        frequencies(OSCILLATOR, {q: 1, p: sp.I}, {m: 1, w: 1})
    with pytest.raises(ValueError, match="m should have a real number for its value, not '1'"):
        action_variables(OSCILLATOR, {q: 1, p: 1}, {m: "1", w: 1})
    with pytest.raises(ValueError, match="declared positive"):
        action_variables(KEPLER, {r: -1, phi: 0, p_r: 0, p_phi: 1}, {m: 1, k: 1})
    with pytest.raises(NotHolomorphicError, match="Max"):
        action_variables(hamilton_jacobi(Hamiltonian(p**2 / 2 + sp.Max(q, -q), q, p)), {q: 1, p: 1})
    with pytest.raises(NotHolomorphicError, match=r"Abs\(q\*\*2 - 1\) may have a kink .* not linear in q"):
        action_variables(hamilton_jacobi(Hamiltonian(p**2 / 2 + sp.Abs(q**2 - 1), q, p)), {q: 0, p: 2})


def test_the_working_precision_is_as_it_was():
    before = ctx.prec
    frequencies(OSCILLATOR, {q: 1, p: 1}, {m: 1, w: 1})
    assert ctx.prec == before


def test_a_start_in_the_order_of_the_coordinates_is_a_start_by_name() -> None:
    in_order, by_name = (
        action_variables(OSCILLATOR, start, {m: 2, w: 3}, digits=5) for start in ([1, 5], {"p": 5, "q": 1})
    )
    for torus in (in_order, by_name):
        assert torus.J[0].overlaps(arb(61) / 12)  # (5²/4 + 9)/3
    assert not action_variables(OSCILLATOR, [5, 1], {m: 2, w: 3}, digits=5).J[0].overlaps(arb(61) / 12)


def test_a_start_is_given_as_to_propagate():
    oscillator = hamilton_jacobi(Hamiltonian(p**2 / 2 + k * q**2 / 2, q, p))
    ways = ({q: 1, p: 2}, {"q": 1, "p": 2}, [1, 2], (1.0, 2), np.array([1.0, 2.0]))
    for start in ways:
        for number in ({k: 9}, {"k": 9}):
            torus = action_variables(oscillator, start, number)
            assert float(torus.J[0]) == pytest.approx((4 + 9) / 6, abs=1e-15)
            assert float(angles(torus, start)[0]) == float(angles(torus, ways[0])[0])
    with pytest.raises(ValueError, match="3 numbers; give q, p in this order, or by name"):
        action_variables(oscillator, [1, 2, 3], {k: 9})
    with pytest.raises(ValueError, match=r"the state is \(q, p\), and r is none of them"):
        action_variables(oscillator, {"q": 1, "r": 2}, {k: 9})


@pytest.mark.parametrize("place", [1, -1])
def test_the_oscillator_starts_at_rest_at_either_end(place):
    torus = action_variables(OSCILLATOR, {q: place, p: 0}, {m: 2, w: 3})
    assert holds(torus.J[0], 3)
    assert misses(torus.J[0], 3 + sp.Rational(1, 10**20))
    assert [float(end) for end in torus.cycles[0].turning_points] == pytest.approx([-1, 1], abs=1e-15)
