"""Gibbs–Appell against Lagrange, multipliers, Euler and classical equations of nonholonomic systems."""

import pytest
import sympy as sp

from canon.expression.symbols.symbol import acceleration, coordinates, parameters
from canon.mechanics.lagrange.appell import GibbsAppell
from canon.mechanics.lagrange.body import Particle, PlanarBody, RigidBody, euler_rotation
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.force import gravity, lagrangian_of_bodies
from canon.mechanics.lagrange.quasi_velocity import maggi_accelerations
from canon.proof.domain.domain import Domain
from canon.proof.equivalence import equivalent_equations
from canon.proof.vanish import vanishes

m, g, l, a, R, J, I1, I3, m1, m2, l1, l2, c = parameters("m g l a R J I1 I3 m1 m2 l1 l2 c", positive=True)
x, y, theta, phi, psi, t1, t2 = coordinates("x y theta phi psi theta1 theta2")
sin, cos = sp.sin, sp.cos


def double_pendulum():
    upper = (l1 * sin(t1), -l1 * cos(t1))
    lower = (upper[0] + l2 * sin(t2), upper[1] - l2 * cos(t2))
    return [Particle(m1, upper), Particle(m2, lower)], [t1, t2]


def spherical_pendulum():
    place = (l * sin(theta) * cos(phi), l * sin(theta) * sin(phi), -l * cos(theta))
    return [Particle(m, place)], [theta, phi]


def rod_on_a_cart():
    rod = PlanarBody(m1, (x + l * sin(theta), l * cos(theta)), J, -theta)
    return [Particle(m2, (x, sp.S.Zero)), rod], [x, theta]


SYSTEMS = [double_pendulum, spherical_pendulum, rod_on_a_cart]


@pytest.mark.parametrize("system", SYSTEMS)
def test_appell_agrees_with_lagrange(system):
    bodies, q = system()
    V = gravity(bodies, (0, 0, -g) if len(bodies[0].r) == 3 else (0, -g))
    appell = GibbsAppell(bodies, q, V)
    lagrange = lagrangian_of_bodies(bodies, q, V)
    for ours, theirs in zip(appell.equations, lagrange.equations, strict=True):
        assert vanishes(ours - theirs).holds
    upside_down = GibbsAppell(bodies, q, -V)
    assert any(
        vanishes(one - e).fails for one, e in zip(upside_down.equations, lagrange.equations, strict=True)
    )


def test_printed_gibbs_function_of_the_double_pendulum():
    bodies, q = double_pendulum()
    S = GibbsAppell(bodies, q).gibbs_function
    right = (m1 + m2) * l1**2 * t1.ddot**2 / 2 + m2 * l2**2 * t2.ddot**2 / 2
    cross = t1.ddot * t2.ddot * cos(t1 - t2)
    right += m2 * l1 * l2 * (cross + sin(t1 - t2) * (t1.ddot * t2.dot**2 - t2.ddot * t1.dot**2))
    for s in q:
        assert vanishes((S - right).diff(acceleration(s))).holds
    twin = right + 2 * m2 * l1 * l2 * sin(t1 - t2) * t2.ddot * t1.dot**2
    assert vanishes((S - twin).diff(t2.ddot)).fails


def test_gibbs_misprint_of_the_notes():
    """∂G/∂q̈ = −∂V/∂q with G = ½ m r̈²; a G linear in r̈ gives something else."""
    (place,) = [Particle(m, (x, y))]
    appell = GibbsAppell([place], [x, y], m * g * y)
    assert appell.equations == (m * x.ddot, m * y.ddot + m * g)
    assert vanishes(appell.gibbs_function - m * (x.ddot**2 + y.ddot**2) / 2).holds


def test_forces_without_potential():
    damped = GibbsAppell([Particle(m, (x,))], [x], forces=[-c * x.dot])
    assert damped.equations == (c * x.dot + m * x.ddot,)
    with pytest.raises(ValueError, match="2 generalized forces for 1"):
        GibbsAppell([Particle(m, (x,))], [x], forces=[0, 0])


def test_euler_equations_in_angular_velocities():
    """Quasi-velocities ω₁, ω₂, ω₃ of a tumbling body: I₁ω̇₁ = (I₂ − I₃) ω₂ω₃."""
    w = sp.symbols("omega1:4", real=True)
    moments = sp.symbols("A B C", positive=True)
    rates = [
        w[0] * cos(psi) - w[1] * sin(psi),
        (w[0] * sin(psi) + w[1] * cos(psi)) / sin(theta),
        w[2] - (w[0] * sin(psi) + w[1] * cos(psi)) * cos(theta) / sin(theta),
    ]
    domain = Domain((theta > 0, theta < sp.pi))
    body = RigidBody(m, (), moments, euler_rotation(phi, theta, psi))
    appell = GibbsAppell([body], [theta, phi, psi], u=w, q_dot=rates)
    for i, (equation, a_) in enumerate(zip(appell.equations, appell.u_dot, strict=True)):
        j, n = (i + 1) % 3, (i + 2) % 3
        euler = moments[i] * a_ - (moments[j] - moments[n]) * w[j] * w[n]
        assert vanishes(equation - euler, domain).holds
        assert vanishes(equation - euler - 2 * (moments[j] - moments[n]) * w[j] * w[n], domain).fails


def test_chaplygin_sleigh():
    """u̇ = a ω², (J + m a²) ω̇ = −m a u ω (S. A. Chaplygin 1911)."""
    u, w = sp.symbols("u omega", real=True)
    body = PlanarBody(m, (x + a * cos(theta), y + a * sin(theta)), J, theta)
    sleigh = GibbsAppell([body], [x, y, theta], u=[u, w], q_dot=[u * cos(theta), u * sin(theta), w])
    u_dot, w_dot = sleigh.quasi_accelerations
    assert vanishes(u_dot - a * w**2).holds
    assert vanishes(w_dot + m * a * u * w / (J + m * a**2)).holds
    assert vanishes(w_dot + m * a * u * w / J).fails
    assert sleigh.kinematics.satisfy(knife(body)).holds
    lagrange = maggi_accelerations(knife(body).lagrangian, sleigh.kinematics)
    assert all(vanishes(p - q).holds for p, q in zip((u_dot, w_dot), lagrange, strict=True))


def knife(body):
    L = lagrangian_of_bodies([body], [x, y, theta])
    return ConstrainedLagrangian(L, nonholonomic=[x.dot * sin(theta) - y.dot * cos(theta)])


def leaning_disc():
    """A thin disc that rolls without slipping, leaning by θ (θ = π/2 upright), heading φ, rolled by ψ."""
    q = [x, y, theta, phi, psi]
    rotation = euler_rotation(phi, theta, psi)
    up = sp.Matrix([-sin(phi) * cos(theta), cos(phi) * cos(theta), sin(theta)])
    axis = sp.Matrix([sin(phi) * sin(theta), -cos(phi) * sin(theta), cos(theta)])
    knot = sp.Matrix([cos(phi), sin(phi), 0])
    omega = phi.dot * sp.Matrix([0, 0, 1]) + theta.dot * knot + psi.dot * axis
    rolling = (omega.cross(R * up))[:2]
    disc = RigidBody(m, (x, y, R * sin(theta)), (I1, I1, I3), rotation)
    return disc, q, [sp.expand(v) for v in rolling]


def test_leaning_disc_against_maggi_and_the_classical_equations():
    """Appell 1900, in ω along knot, slope and axis: for a steady state see the sign of gravity."""
    disc, q, rolling = leaning_disc()
    free = [theta.dot, phi.dot, psi.dot]
    V = m * g * R * sin(theta)
    appell = GibbsAppell([disc], q, V, u=free, q_dot=[*rolling, *free])
    constrained = ConstrainedLagrangian(
        lagrangian_of_bodies([disc], q, V), nonholonomic=[x.dot - rolling[0], y.dot - rolling[1]]
    )
    assert appell.kinematics.satisfy(constrained).holds
    from canon.mechanics.lagrange.quasi_velocity import maggi_equations

    maggi = maggi_equations(constrained.lagrangian, appell.kinematics)
    for ours, theirs in zip(appell.equations, maggi, strict=True):
        assert vanishes(ours - theirs, budget=30).holds
    n = psi.dot + phi.dot * cos(theta)
    lean = (I1 + m * R**2) * theta.ddot + (I3 + m * R**2) * n * phi.dot * sin(theta)
    lean += -I1 * phi.dot**2 * sin(theta) * cos(theta) + m * g * R * cos(theta)
    n_dot = psi.ddot + phi.ddot * cos(theta) - phi.dot * theta.dot * sin(theta)
    spin = (I3 + m * R**2) * n_dot - m * R**2 * theta.dot * phi.dot * sin(theta)
    head = I1 * phi.ddot * sin(theta) + 2 * I1 * theta.dot * phi.dot * cos(theta) - I3 * n * theta.dot
    accelerations = [theta.ddot, phi.ddot, psi.ddot]
    upright = Domain((theta > 0, theta < sp.pi))
    assert equivalent_equations(appell.equations, [lean, spin, head], accelerations, upright, budget=30).holds
    fallen = [lean - 2 * m * g * R * cos(theta), spin, head]
    assert equivalent_equations(appell.equations, fallen, accelerations, upright, budget=30).fails


def test_rolling_disc_by_appell_agrees_with_multipliers():
    """A disc that stays upright: heading, roll, place."""
    q = [x, y, phi, psi]
    disc = [Particle(m, (x, y)), PlanarBody(0, (), I1, phi), PlanarBody(0, (), I3, psi)]
    rolling = [R * cos(phi) * psi.dot, R * sin(phi) * psi.dot]
    appell = GibbsAppell(disc, q, -m * g * x, u=[phi.dot, psi.dot], q_dot=[*rolling, phi.dot, psi.dot])
    constrained = ConstrainedLagrangian(
        lagrangian_of_bodies(disc, q, -m * g * x), nonholonomic=[x.dot - rolling[0], y.dot - rolling[1]]
    )
    through = dict(appell.kinematics.through)
    for ours, theirs in zip(appell.quasi_accelerations, constrained.accelerations[2:], strict=True):
        assert vanishes(ours - theirs.xreplace(through)).holds
    assert vanishes(appell.quasi_accelerations[1] - m * g * R * cos(phi) / (I3 + m * R**2)).holds
    assert vanishes(appell.quasi_accelerations[1] - m * g * R * cos(phi) / I3).fails
