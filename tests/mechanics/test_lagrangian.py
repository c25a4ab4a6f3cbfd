"""Lagrange's equations against Newton's, and what a Lagrangian refuses."""

import pytest
import sympy as sp
from sympy.physics.mechanics import LagrangesMethod, Particle, Point, ReferenceFrame, dynamicsymbols

from canon.expression.symbols.symbol import (
    acceleration,
    coordinates,
    parameters,
    time,
    time_derivative,
    velocity,
)
from canon.mechanics.algebra.linear import SingularMatrixError
from canon.mechanics.hamilton.symmetry import is_constant_of_motion
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.force import rayleigh_forces
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.domain.verdict import Undecided
from canon.proof.vanish import vanishes

m, a, l, g, k, m1, m2, l1, l2 = parameters("m a l g k m1 m2 l1 l2", positive=True)
theta, phi, q1, q2, t1, t2 = coordinates("theta phi q1 q2 theta1 theta2")


def d_alembert(q, bodies, potential, inertias=()):
    """Σ (m r̈ + ∂V/∂r)·∂r/∂q = 0 from positions alone; no kinetic energy is formed.

    ``inertias`` are pairs (moment of inertia, angle) of planar rigid bodies.
    """
    second = [[time_derivative(time_derivative(x, q), q) for x in r] for _, r in bodies]
    return [
        sp.Add(
            *(
                mass * acc * x.diff(s)
                for (mass, r), accs in zip(bodies, second, strict=True)
                for x, acc in zip(r, accs, strict=True)
            ),
            *(inertia * acceleration(angle) for inertia, angle in inertias if angle == s),
            potential.diff(s),
        )
        for s in q
    ]


def pendulum():
    L = m * l**2 * theta.dot**2 / 2 + m * g * l * sp.cos(theta)
    newton = d_alembert([theta], [(m, (l * sp.sin(theta), -l * sp.cos(theta)))], -m * g * l * sp.cos(theta))
    return Lagrangian(L, [theta]), newton


def sliding_mass():
    """A mass on a radial spring of zero natural length, in polar coordinates."""
    V = -m * g * q1 * sp.cos(q2) + k * q1**2 / 2
    L = m * (q1.dot**2 + q1**2 * q2.dot**2) / 2 - V
    return Lagrangian(L, [q1, q2]), d_alembert([q1, q2], [(m, (q1 * sp.sin(q2), -q1 * sp.cos(q2)))], V)


def spherical_pendulum():
    V = -m * g * a * sp.cos(theta)
    r = (a * sp.sin(theta) * sp.cos(phi), a * sp.sin(theta) * sp.sin(phi), -a * sp.cos(theta))
    L = m * a**2 * (theta.dot**2 + phi.dot**2 * sp.sin(theta) ** 2) / 2 - V
    return Lagrangian(L, [theta, phi]), d_alembert([theta, phi], [(m, r)], V)


def double_pendulum():
    V = -m * g * a * (2 * sp.cos(theta) + sp.cos(phi))
    upper = (a * sp.sin(theta), -a * sp.cos(theta))
    lower = (upper[0] + a * sp.sin(phi), upper[1] - a * sp.cos(phi))
    T = m * a**2 * (2 * theta.dot**2 + phi.dot**2 + 2 * theta.dot * phi.dot * sp.cos(theta - phi)) / 2
    return Lagrangian(T - V, [theta, phi]), d_alembert([theta, phi], [(m, upper), (m, lower)], V)


def rod_double_pendulum():
    V = -g * l1 * (m2 + m1 / 2) * sp.cos(t1) - g * l2 * m2 / 2 * sp.cos(t2)
    T = (m2 + m1 / 3) * l1**2 * t1.dot**2 / 2 + m2 * l2**2 * t2.dot**2 / 6
    T += m2 * l1 * l2 * sp.cos(t1 - t2) * t1.dot * t2.dot / 2
    upper = (l1 / 2 * sp.sin(t1), -l1 / 2 * sp.cos(t1))
    lower = (l1 * sp.sin(t1) + l2 / 2 * sp.sin(t2), -l1 * sp.cos(t1) - l2 / 2 * sp.cos(t2))
    inertias = [(m1 * l1**2 / 12, t1), (m2 * l2**2 / 12, t2)]
    return Lagrangian(T - V, [t1, t2]), d_alembert([t1, t2], [(m1, upper), (m2, lower)], V, inertias)


SYSTEMS = [pendulum, sliding_mass, spherical_pendulum, double_pendulum, rod_double_pendulum]


@pytest.mark.parametrize("system", SYSTEMS)
def test_equations_agree_with_newton(system):
    lagrangian, newton = system()
    for ours, theirs in zip(lagrangian.equations, newton, strict=True):
        assert vanishes(ours - theirs).holds


@pytest.mark.parametrize("system", SYSTEMS)
def test_a_wrong_sign_of_gravity_is_seen(system):
    lagrangian, _ = system()
    upside_down = Lagrangian(lagrangian.L.subs(g, -g), lagrangian.q)
    assert vanishes(upside_down.equations[0] - lagrangian.equations[0]).fails


@pytest.mark.parametrize("system", SYSTEMS)
def test_accelerations_solve_the_equations(system):
    lagrangian, newton = system()
    found = {acceleration(s): a for s, a in zip(lagrangian.q, lagrangian.accelerations, strict=True)}
    for equation in newton:
        assert vanishes(equation.xreplace(found)).holds


def test_printed_equations_of_the_sliding_mass():
    lagrangian, _ = sliding_mass()
    radial = m * q1.ddot - m * q1 * q2.dot**2 - m * g * sp.cos(q2) + k * q1
    angular = m * q1**2 * q2.ddot + 2 * m * q1 * q1.dot * q2.dot + m * g * q1 * sp.sin(q2)
    assert vanishes(lagrangian.equations[0] - radial).holds
    assert vanishes(lagrangian.equations[1] - angular).holds
    without_coriolis = angular - 2 * m * q1 * q1.dot * q2.dot
    assert vanishes(lagrangian.equations[1] - without_coriolis).fails


def test_printed_first_rod_equation_misses_a_term():
    """The lecture notes print no θ̇₂² sin(θ₁ − θ₂) term for the double pendulum of rods."""
    lagrangian, _ = rod_double_pendulum()
    printed = (m2 + m1 / 3) * l1 * t1.ddot + m2 / 2 * l2 * sp.cos(t1 - t2) * t2.ddot
    printed += g * (m2 + m1 / 2) * sp.sin(t1)
    missing = m2 / 2 * l2 * sp.sin(t1 - t2) * t2.dot**2
    assert vanishes(lagrangian.equations[0] - l1 * (printed + missing)).holds
    assert vanishes(lagrangian.equations[0] - l1 * printed).fails


def test_agrees_with_sympys_lagranges_method():
    """Second route: SymPy's own derivation, in its own dynamicsymbols."""
    T1, T2 = dynamicsymbols("theta1 theta2")
    N = ReferenceFrame("N")
    O = Point("O")
    O.set_vel(N, 0)
    particle = O.locatenew("A", l1 * (sp.sin(T1) * N.x - sp.cos(T1) * N.y))
    particle.set_vel(N, particle.pos_from(O).dt(N))
    lower = particle.locatenew("B", l2 * (sp.sin(T2) * N.x - sp.cos(T2) * N.y))
    lower.set_vel(N, lower.pos_from(O).dt(N))
    bodies = [Particle("a", particle, m1), Particle("b", lower, m2)]
    T = sum(body.kinetic_energy(N) for body in bodies)
    V = sum(body.mass * g * body.point.pos_from(O).dot(N.y) for body in bodies)
    method = LagrangesMethod(T - V, [T1, T2])
    theirs = method.form_lagranges_equations()
    ours = Lagrangian(T - V, [T1, T2])
    clock = dynamicsymbols._t
    for equation, other in zip(ours.equations, theirs, strict=True):
        other = other.xreplace(
            {x.diff(clock, 2): acceleration(s) for x, s in zip((T1, T2), ours.q, strict=True)}
        )
        other = other.xreplace({x.diff(clock): velocity(s) for x, s in zip((T1, T2), ours.q, strict=True)})
        other = other.xreplace(dict(zip((T1, T2), ours.q, strict=True)))
        assert vanishes(equation - other).holds


def test_plain_symbols_are_taken_at_the_door():
    x, x_dot = sp.symbols("x x_dot")
    assert Lagrangian(m * x_dot**2 / 2, x).equations == (m * acceleration(x),)


def test_forces_enter_on_the_right():
    x = coordinates("x")
    damped = Lagrangian(m * x.dot**2 / 2 - k * x**2 / 2, [x], forces=[-a * x.dot])
    assert vanishes(damped.equations[0] - (m * x.ddot + a * x.dot + k * x)).holds
    assert vanishes(damped.equations[0] - (m * x.ddot - a * x.dot + k * x)).fails


def test_accelerations_that_forces_hold_are_solved_for():
    """A body with the added mass μ has the mass m + μ, free or held."""
    x, y = coordinates("x y")
    mu = parameters("mu", positive=True)
    free = Lagrangian(
        m * (x.dot**2 + y.dot**2) / 2 - k * x**2 / 2, [x, y], forces=[-mu * x.ddot, -mu * x.ddot]
    )
    assert vanishes(free.accelerations[0] + k * x / (m + mu)).holds
    assert vanishes(free.accelerations[0] + k * x / m).fails
    assert vanishes(free.accelerations[1] - mu * k * x / (m * (m + mu))).holds
    held = ConstrainedLagrangian(free, holonomic=[x - y])
    assert vanishes(held.accelerations[0] + k * x / (2 * m + 2 * mu)).holds
    assert vanishes(held.accelerations[0] + k * x / (2 * m + mu)).fails
    assert is_constant_of_motion((m + mu) * x.dot**2 + k * x**2, free).holds
    assert is_constant_of_motion(m * x.dot**2 + k * x**2, free).fails


def test_forces_not_affine_in_the_accelerations_are_not_solved_for():
    x = coordinates("x")
    with pytest.raises(Undecided, match="not affine"):
        Lagrangian(m * x.dot**2 / 2, [x], forces=[-(x.ddot**3)]).accelerations  # noqa: B018


def test_a_moving_support_enters_through_time():
    """A bead on a wire that rotates with θ = ω t: r̈ − ω² r = 0."""
    r = coordinates("r")
    w = parameters("omega")
    x, y = r * sp.cos(w * time), r * sp.sin(w * time)
    v = [time_derivative(s, [r]) for s in (x, y)]
    bead = Lagrangian(m * (v[0] ** 2 + v[1] ** 2) / 2, [r])
    assert vanishes(bead.equations[0] - m * (r.ddot - w**2 * r)).holds


def test_energy_changes_by_explicit_time_and_forces():
    """dE/dt = −∂L/∂t + Q q̇ along the motion."""
    x = coordinates("x")
    driven = Lagrangian(m * x.dot**2 / 2 - k * x**2 * sp.cos(time) / 2, [x], forces=[-a * x.dot**3])
    rate = time_derivative(driven.jacobi_energy, [x]).xreplace({x.ddot: driven.accelerations[0]})
    assert vanishes(rate - (-driven.L.diff(time) - a * x.dot**4)).holds


def test_relativistic_particle():
    x = coordinates("x")
    c = parameters("c", positive=True)
    particle = Lagrangian(-m * c**2 * sp.sqrt(1 - x.dot**2 / c**2) - k * x, [x])
    gamma = 1 / sp.sqrt(1 - x.dot**2 / c**2)
    assert vanishes(particle.accelerations[0] + k / (m * gamma**3)).holds
    assert vanishes(particle.jacobi_energy - (m * c**2 * gamma + k * x)).holds


def test_a_singular_mass_matrix_names_its_null_direction():
    x, y = coordinates("x y")
    with pytest.raises(SingularMatrixError, match=r"\(-1, 1\).*x_dot, y_dot") as caught:
        Lagrangian(m * (x.dot + y.dot) ** 2 / 2 - k * x**2, [x, y]).accelerations  # noqa: B018
    assert caught.value.null_direction == (-1, 1)


def test_a_mass_matrix_singular_by_an_identity_is_found():
    """det M = sin² + cos² − 1 = 0 although no entry shows it."""
    x, y = coordinates("x y")
    s, c = sp.sin(x), sp.cos(x)
    L = (s**2 * x.dot**2 + 2 * s * c * x.dot * y.dot + (1 - s**2) * y.dot**2) / 2
    with pytest.raises(SingularMatrixError):
        Lagrangian(L, [x, y]).accelerations  # noqa: B018


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Lagrangian(theta.dot**2, [theta, phi], forces=[0]), "1 generalized force for 2"),
        (lambda: Lagrangian(theta.ddot * theta, [theta]), "accelerations theta_ddot"),
        (lambda: Lagrangian(theta.dot**2, ["theta"]), "is no coordinate"),
    ],
)
def test_refusals_say_what_is_wrong(make, words):
    with pytest.raises((ValueError, TypeError), match=words):
        make()


def test_rayleighs_function_adds_its_forces_to_the_given_ones() -> None:
    x, y = coordinates("x y")
    c, m, k = parameters("c m k", positive=True)
    L = m * (x.dot**2 + y.dot**2) / 2
    F = c * (x.dot - y.dot) ** 2 / 2
    both = [sp.expand(Q) for Q in Lagrangian(L, [x, y], forces=[-k * x, 0], dissipation=F).forces]
    assert both == [sp.expand(-k * x - c * (x.dot - y.dot)), sp.expand(c * (x.dot - y.dot))]
    assert both != [sp.expand(-k * x + c * (x.dot - y.dot)), sp.expand(-c * (x.dot - y.dot))]
    assert Lagrangian(L, [x, y], dissipation=F).forces == rayleigh_forces(F, [x, y])


def test_a_quadratic_rayleigh_function_takes_twice_itself_from_the_energy() -> None:
    x, y = coordinates("x y")
    c, m, k = parameters("c m k", positive=True)
    F = c * (x.dot**2 + 3 * x.dot * y.dot + 5 * y.dot**2) / 2
    system = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 - k * (x**2 + y**2) / 2, [x, y], dissipation=F)
    power = sum(Q * v for Q, v in zip(system.forces, system.velocities, strict=True))
    assert sp.expand(power + 2 * F) == 0


def test_coordinates_of_which_one_has_the_name_of_a_velocity():
    u, v = coordinates("x x_dot")
    with pytest.raises(ValueError, match="name of the velocity or acceleration of x,"):
        Lagrangian((u.dot**2 + v.dot**2) / 2, [u, v])


def test_a_system_has_a_coordinate():
    for none in ([], ()):
        with pytest.raises(ValueError, match="no coordinates given; a system moves in at least one"):
            Lagrangian(theta.dot**2 / 2, none)
