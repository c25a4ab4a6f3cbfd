"""Newton–Euler solved without poles: at sin θ = 0 and cos θ = 0 exactly, where a pivot of elimination would vanish."""

import numpy as np
import pytest
import sympy as sp
from scipy.differentiate import derivative
from scipy.integrate import solve_ivp
from sympy import asin, cos, sin, sqrt

from canon import coordinates, parameters, propagate
from canon.mechanics.lagrange.body import Particle, PlanarBody
from canon.mechanics.lagrange.newton_euler import Load, NewtonEuler, joint, weights
from canon.mechanics.lagrange.overdetermined import solve_overdetermined

m, l, g, R, M = parameters("m l g R M", positive=True)
mu = parameters("mu")
theta, phi, x = coordinates("theta phi x")
A, B, N, S = sp.symbols("A:2", real=True), sp.symbols("B:2", real=True), *sp.symbols("N S", real=True)
C = sp.symbols("C:2", real=True)
NUMBERS = {m: 1.2, l: 0.8, g: 9.81, R: 0.3, M: 0.5}


def rod_on_a_pin() -> NewtonEuler:
    rod = PlanarBody(m, (l * sin(theta) / 2, -l * cos(theta) / 2), m * l**2 / 12, theta)
    return NewtonEuler([rod], [theta], [*weights([rod], (0, -g)), Load(0, A, at=(0, 0))], A)


def bob_on_a_string() -> NewtonEuler:
    bob = Particle(m, (l * sin(theta), -l * cos(theta)))
    return NewtonEuler(
        [bob], [theta], [*weights([bob], (0, -g)), Load(0, (-S * sin(theta), S * cos(theta)))], [S]
    )


def two_rods() -> NewtonEuler:
    pin = (l * sin(theta), -l * cos(theta))
    upper = PlanarBody(m, [c / 2 for c in pin], m * l**2 / 12, theta)
    lower = PlanarBody(m, (pin[0] + l * sin(phi) / 2, pin[1] - l * cos(phi) / 2), m * l**2 / 12, phi)
    loads = [*weights([upper, lower], (0, -g)), Load(0, A, at=(0, 0)), *joint(0, 1, B, pin)]
    return NewtonEuler([upper, lower], [theta, phi], loads, [*A, *B])


def slider_crank() -> NewtonEuler:
    """Crank R, rod l, piston M on the x axis; the rod leans by −asin(R sin θ/l)."""
    pin = (R * cos(theta), R * sin(theta))
    end = R * cos(theta) + sqrt(l**2 - R**2 * sin(theta) ** 2)
    crank = PlanarBody(m, [c / 2 for c in pin], m * R**2 / 12, theta)
    rod = PlanarBody(m, ((pin[0] + end) / 2, pin[1] / 2), m * l**2 / 12, -asin(R * sin(theta) / l))
    piston = Particle(M, (end, 0))
    loads = [Load(0, A, at=(0, 0)), *joint(0, 1, B, pin), *joint(1, 2, C, (end, 0)), Load(2, (0, N))]
    return NewtonEuler([crank, rod, piston], [theta], loads, [*A, *B, *C, N])


def rates_of(route: NewtonEuler, state: list[float]) -> np.ndarray:
    symbols = [*route.q, *(s.dot for s in route.q)]
    found = sp.lambdify([symbols, list(NUMBERS)], route.solution)
    return np.array(found(state, list(NUMBERS.values())), dtype=float)


def fall_of_two_rods(state):
    """θ̈ and φ̈ by Lagrange's equations of the double pendulum of rods, written by hand."""
    a, b, u, w = state
    mass, length, weight = NUMBERS[m], NUMBERS[l], NUMBERS[g]
    half = mass * length**2 / 2 * np.cos(a - b)
    inertia = [[4 / 3 * mass * length**2, half], [half, mass * length**2 / 3]]
    swing = mass * length**2 / 2 * np.sin(a - b)
    moments = [
        -swing * w**2 - 1.5 * mass * weight * length * np.sin(a),
        swing * u**2 - mass * weight * length / 2 * np.sin(b),
    ]
    return np.linalg.solve(inertia, moments)


def spin_of_the_crank(angle, speed):
    """θ̈ = −I′ θ̇²/2I with 2T = I(θ) θ̇² written by hand."""
    mass, length, radius, piston = NUMBERS[m], NUMBERS[l], NUMBERS[R], NUMBERS[M]

    def inertia(a):
        root = np.sqrt(length**2 - radius**2 * np.sin(a) ** 2)
        end = -radius * np.sin(a) - radius**2 * np.sin(a) * np.cos(a) / root
        middle = ((-radius * np.sin(a) + end) / 2) ** 2 + (radius * np.cos(a) / 2) ** 2
        lean = radius * np.cos(a) / root
        return mass * radius**2 / 3 + mass * middle + mass * length**2 / 12 * lean**2 + piston * end**2

    return -derivative(inertia, angle, tolerances={"rtol": 1e-11}).df * speed**2 / (2 * inertia(angle))


@pytest.mark.parametrize("angle", [0.0, np.pi / 2, np.pi, 0.7])
def test_rods_and_strings_are_finite_and_right_wherever_they_hang(angle):
    fall = NUMBERS[g] / NUMBERS[l] * np.sin(angle)
    pinned = rates_of(rod_on_a_pin(), [angle, 0.9])
    assert pinned[0] == pytest.approx(-1.5 * fall, rel=1e-13, abs=1e-14)
    hung = rates_of(bob_on_a_string(), [angle, 0.9])
    assert hung[0] == pytest.approx(-fall, rel=1e-13, abs=1e-14)
    assert hung[1] == pytest.approx(1.2 * (9.81 * np.cos(angle) + 0.8 * 0.81), rel=1e-13, abs=1e-13)


@pytest.mark.parametrize(
    "state",
    [[0.0, 0.0, 1.0, 2.0], [np.pi / 2, 0.0, 1.0, 2.0], [0.0, np.pi / 2, 1, -1], [np.pi / 2] * 2 + [0, 1]],
)
def test_two_rods_on_pins_against_lagrange(state):
    found = rates_of(two_rods(), state)
    assert np.isfinite(found).all()
    np.testing.assert_allclose(found[:2], fall_of_two_rods(state), rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("angle", [0.0, np.pi / 2, np.pi, -np.pi / 2, 0.7])
def test_a_slider_crank_against_lagrange(angle):
    found = rates_of(slider_crank(), [angle, 2.0])
    assert np.isfinite(found).all()
    assert found[0] == pytest.approx(spin_of_the_crank(angle, 2.0), rel=1e-9, abs=1e-9)


def test_motions_go_through_the_places_where_pivots_vanish():
    numbers = {m: 1.2, l: 0.8, g: 9.81}
    found = propagate(rod_on_a_pin(), (0, 10), [1, 0], parameters=numbers).final
    true = solve_ivp(
        lambda t, s: [s[1], -1.5 * 9.81 / 0.8 * np.sin(s[0])],
        (0, 10),
        [1, 0],
        "DOP853",
        rtol=1e-12,
        atol=1e-13,
    )
    np.testing.assert_allclose(found, true.y[:, -1], atol=1e-9)
    two = propagate(two_rods(), (0, 3), [1, 0.5, 0, 0], parameters=numbers).final
    true = solve_ivp(
        lambda t, s: [*s[2:], *fall_of_two_rods(s)], (0, 3), [1, 0.5, 0, 0], "DOP853", rtol=1e-12, atol=1e-13
    )
    np.testing.assert_allclose(two, true.y[:, -1], atol=1e-8)


def test_a_crank_turns_over_its_dead_centres():
    motion = propagate(slider_crank(), (0, 4), [0.0, 2.0], parameters={m: 1.2, l: 0.8, R: 0.3, M: 0.5})
    true = solve_ivp(
        lambda t, s: [s[1], float(spin_of_the_crank(s[0], s[1]))],
        (0, 4),
        [0.0, 2.0],
        "DOP853",
        rtol=1e-10,
        atol=1e-11,
    )
    np.testing.assert_allclose(motion.final, true.y[:, -1], atol=1e-7)


def test_friction_by_a_reaction_does_work_and_is_solved_too():
    """A bead that slides down a straight wire at 45°, slowed by μ N: ẍ = g (1 − μ)/2."""
    bead = Particle(m, (x, -x))
    loads = [*weights([bead], (0, -g)), Load(0, (N, N)), Load(0, (-mu * N, mu * N))]
    route = NewtonEuler([bead], [x], loads, [N])
    assert route.ideal.fails
    assert sp.simplify(route.solution[0] - g * (1 - mu) / 2) == 0
    final = propagate(route, (0, 1), [0, 0], parameters={m: 2, g: 10, mu: 0.2}).final
    np.testing.assert_allclose(final, [2, 4], rtol=1e-14)


def test_elimination_prefers_what_vanishes_nowhere_in_any_column():
    a, b = sp.symbols("a b", real=True)
    matrix = sp.Matrix([[a, -1], [m, a]])
    first, second = solve_overdetermined(matrix, [a * b - 2, m * b + 2 * a], [1, 1])
    assert sp.simplify(first - b) == sp.simplify(second - 2) == 0
    assert first.subs(a, 0) == b
    assert second.subs(a, 0) == 2


def test_loads_that_hold_accelerations_are_solved_for():
    """A force −a ÿ along x: x'' = a g/m and y'' = −g; the matrix of the accelerations is not symmetric."""
    from canon import Particle, coordinates, parameters, propagate
    from canon.mechanics import Load, NewtonEuler

    x, y = coordinates("x y")
    m, a, g = parameters("m a g", positive=True)
    pulled = NewtonEuler([Particle(m, (x, y))], [x, y], [Load(0, (-a * y.ddot, -g * m))])
    assert [sp.cancel(f) for f in pulled.solution] == [a * g / m, -g]
    motion = propagate(pulled, (0, 1), [0, 0, 0, 0], parameters={m: 1, a: 0.5, g: 1})
    assert motion.final[:2] == pytest.approx([0.25, -0.5], rel=1e-12)
    assert propagate(pulled, (0, 1), [0, 0, 0, 0], parameters={m: 1, a: 1, g: 1}).final[0] == pytest.approx(
        0.5
    )
