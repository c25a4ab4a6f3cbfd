"""Newton–Euler with joint forces against Lagrange, multipliers and the lecture notes."""

import pytest
import sympy as sp

from canon.expression.symbols.symbol import coordinates, parameters
from canon.mechanics.lagrange.body import Particle, PlanarBody, RigidBody, euler_rotation
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.force import gravity, lagrangian_of_bodies
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.lagrange.newton_euler import Load, NewtonEuler, joint, weights
from canon.proof.vanish import vanishes

m, g, l, R, J, I1, I3, m0, m1, m2, m3, h, a, b, c, J1, J2 = parameters(
    "m g l R J I1 I3 m0 m1 m2 m3 h a b c J1 J2", positive=True
)
tau, P, MT, e = parameters("tau P M_T e")
x, theta, phi, psi, q1, q2 = coordinates("x theta phi psi q1 q2")
sin, cos = sp.sin, sp.cos


def test_pendulum_three_ways():
    """The notes' homework: along fixed axes, along the string, and by Lagrange."""
    S = sp.Symbol("S", real=True)
    bob = Particle(m, (l * sin(theta), -l * cos(theta)))
    string = Load(0, (-S * sin(theta), S * cos(theta)))
    fixed = NewtonEuler([bob], [theta], [*weights([bob], (0, -g)), string], [S])
    lagrange = lagrangian_of_bodies([bob], [theta], gravity([bob], (0, -g)))
    assert fixed.agrees_with(lagrange.equations).holds
    assert fixed.agrees_with([theta.ddot - g / l * sin(theta)]).fails
    right, up = fixed.balances
    along = sp.expand(right * cos(theta) + up * sin(theta))
    across = sp.expand(-right * sin(theta) + up * cos(theta))
    assert vanishes(along - (m * l * theta.ddot + m * g * sin(theta))).holds
    assert vanishes(across - (m * l * theta.dot**2 + m * g * cos(theta) - S)).holds
    assert vanishes(across - (m * l * theta.ddot**2 + m * g * cos(theta) - S)).fails


def cart_and_rod():
    """Cart and inverted rod with joint force (s₁ along b₁, s₂ along b₂) and the rail's N."""
    s1, s2, N = sp.symbols("s1 s2 N", real=True)
    cart = Particle(m0, (x, sp.S.Zero))
    rod = PlanarBody(m1, (x + l / 2 * sin(theta), h / 2 + l / 2 * cos(theta)), J1, -theta)
    b1, b2 = (cos(theta), -sin(theta)), (sin(theta), cos(theta))
    force = [s1 * u + s2 * v for u, v in zip(b1, b2, strict=True)]
    pin = (x, h / 2)
    loads = [
        *weights([cart, rod], (0, -g)),
        Load(0, (tau, N)),
        Load(0, force),
        Load(1, [-f for f in force], at=pin),
    ]
    return [cart, rod], loads, (s1, s2, N)


def test_cart_pendulum():
    bodies, loads, reactions = cart_and_rod()
    route = NewtonEuler(bodies, [x, theta], loads, reactions)
    lagrange = lagrangian_of_bodies(bodies, [x, theta], gravity(bodies, (0, -g)), forces=[tau, 0])
    assert route.agrees_with(lagrange.equations).holds
    first = (
        (m0 + m1) * x.ddot
        + m1 * theta.ddot * l / 2 * cos(theta)
        - m1 * theta.dot**2 * l / 2 * sin(theta)
        - tau
    )
    second = (
        -l / 2 * m1 * g * sin(theta)
        + l / 2 * m1 * x.ddot * cos(theta)
        + l**2 / 4 * m1 * theta.ddot
        + theta.ddot * J1
    )
    assert route.agrees_with([first, second]).holds
    assert route.agrees_with([first, second - l / 2 * m1 * g * sin(theta)]).fails
    found = dict(zip(route.unknowns, route.solution, strict=True))
    s1 = (m1 * g * sin(theta) - m1 * x.ddot * cos(theta) - theta.ddot * l / 2 * m1).xreplace(found)
    assert vanishes(found[reactions[0]] - s1).holds
    assert vanishes(found[reactions[0]] + s1).fails


def test_joint_is_action_and_reaction():
    on_first, on_second = joint(0, 1, (tau, P), (x, 0))
    assert on_first.force == (tau, P)
    assert on_second.force == (-tau, -P)


def piston():
    """Crank (centre at c), rod (a from the crank pin, b from the piston), piston s; offset e; T and P given."""
    length = a + b
    x1, y1, x2, y2, s = coordinates("x1 y1 x2 y2 s")
    q = [x1, y1, x2, y2, theta, phi, s]
    T = m1 * (x1.dot**2 + y1.dot**2) / 2 + J1 * theta.dot**2 / 2
    T += m2 * (x2.dot**2 + y2.dot**2) / 2 + J2 * phi.dot**2 / 2 + m3 * s.dot**2 / 2
    forces = [0, 0, 0, 0, -MT, 0, -P]
    constraints = [
        s - R * cos(theta) - length * cos(phi),
        e - R * sin(theta) + length * sin(phi),
        x1 - c * cos(theta),
        y1 - c * sin(theta),
        x2 - R * cos(theta) - a * cos(phi),
        y2 - b * sin(phi) - e,
    ]
    return ConstrainedLagrangian(Lagrangian(T, q, forces=forces), holonomic=constraints), q


def test_printed_multiplier_equations_of_the_piston_engine():
    """Six constraints among seven coordinates; all seven equations of the notes.

    y₂ − b sin φ − e is printed; with f₂ the rod's centre is at y₂ = e + b sin φ.
    """
    engine, q = piston()
    lam = sp.symbols("lam1:7", real=True)
    length = a + b
    x1, y1, x2, y2, *_, s = q
    printed = [
        m1 * x1.ddot - lam[2],
        m1 * y1.ddot - lam[3],
        m2 * x2.ddot - lam[4],
        m2 * y2.ddot - lam[5],
        J1 * theta.ddot
        - (
            -MT
            + (lam[0] + lam[4]) * R * sin(theta)
            - lam[1] * R * cos(theta)
            + c * (lam[2] * sin(theta) - lam[3] * cos(theta))
        ),
        J2 * phi.ddot
        - (length * (lam[0] * sin(phi) + lam[1] * cos(phi)) + lam[4] * a * sin(phi) - lam[5] * b * cos(phi)),
        m3 * s.ddot - (lam[0] - P),
    ]
    for ours, theirs in zip(engine.equations(lam), printed, strict=False):
        assert vanishes(ours - theirs).holds
    twin = printed[4] + 2 * lam[1] * R * cos(theta)
    assert vanishes(engine.equations(lam)[4] + twin - 2 * printed[4]).fails
    assert engine.degrees_of_freedom == 1


def test_joint_forces_of_the_piston_engine_are_multipliers():
    """X₁₂ = −(λ₁ + λ₅), Y₁₂ = −λ₂ where the rod's force on the crank is (X₁₂, Y₁₂)."""
    X01, Y01, X12, Y12 = sp.symbols("X01 Y01 X12 Y12", real=True)
    crank = PlanarBody(m1, (c * cos(theta), c * sin(theta)), J1, theta)
    loads = [
        Load(0, (X01, Y01), at=(0, 0)),
        Load(0, (X12, Y12), at=(R * cos(theta), R * sin(theta))),
        Load(0, torque=-MT),
    ]
    route = NewtonEuler([crank], [theta], loads)
    lam = sp.symbols("lam1:7", real=True)
    engine, q = piston()
    x1, y1 = q[:2]
    equations = engine.equations(lam)
    kin = {x1.ddot: -c * (cos(theta) * theta.dot**2 + sin(theta) * theta.ddot)}
    kin[y1.ddot] = c * (cos(theta) * theta.ddot - sin(theta) * theta.dot**2)
    printed = {X12: -(lam[0] + lam[4]), Y12: -lam[1]}
    printed |= {X01: lam[2] - printed[X12], Y01: lam[3] - printed[Y12]}
    lagrange = [equations[0].xreplace(kin), equations[1].xreplace(kin), equations[4]]
    for newton, ours in zip(route.balances, lagrange, strict=True):
        assert vanishes(newton.xreplace(printed) - ours).holds
    twin = printed | {Y12: lam[1], Y01: lam[3] - lam[1]}
    assert vanishes(route.balances[2].xreplace(twin) - lagrange[2]).fails


def test_heavy_top_about_its_centre_of_mass():
    """Spatial: the tip's force is unknown; Lagrange knows nothing of it."""
    rotation = euler_rotation(phi, theta, psi)
    F = sp.symbols("F1:4", real=True)
    centre = tuple(l * rotation[i, 2] for i in range(3))
    top = RigidBody(m, centre, (I1, I1, I3), rotation)
    loads = [*weights([top], (0, 0, -g)), Load(0, F, at=(0, 0, 0))]
    route = NewtonEuler([top], [theta, phi, psi], loads, F)
    A = I1 + m * l**2
    L = A * (theta.dot**2 + phi.dot**2 * sin(theta) ** 2) / 2 + I3 * (psi.dot + phi.dot * cos(theta)) ** 2 / 2
    lagrange = Lagrangian(L - m * g * l * cos(theta), [theta, phi, psi])
    still = {s.ddot: f for s, f in zip(lagrange.q, lagrange.accelerations, strict=True)}
    forces = dict(
        zip(
            F,
            (sp.Add(*(balance.xreplace(still).subs(dict.fromkeys(F, 0)),)) for balance in route.balances[:3]),
            strict=True,
        )
    )
    for balance in route.balances[3:]:
        assert vanishes(balance.xreplace(still).xreplace(forces)).holds
    floating = dict.fromkeys(F, sp.S.Zero)
    assert any(vanishes(balance.xreplace(still).xreplace(floating)).fails for balance in route.balances[3:])


def test_euler_equations_of_a_free_body():
    """I₁ω̇₁ = (I₂ − I₃) ω₂ω₃ for a tumbling body, whose signs a twin changes."""
    moments = sp.symbols("A B C", positive=True)
    body = RigidBody(m, (), moments, euler_rotation(phi, theta, psi))
    route = NewtonEuler([body], [theta, phi, psi], [])
    from canon.mechanics.lagrange.quasi_velocity import Kinematics

    kinematics = Kinematics([theta, phi, psi])
    w = body.angular_velocity(kinematics)
    w_dot = [kinematics.rate(component) for component in w]
    for i in range(3):
        j, n = (i + 1) % 3, (i + 2) % 3
        euler = moments[i] * w_dot[i] - (moments[j] - moments[n]) * w[j] * w[n]
        assert vanishes(route.balances[i] - euler).holds
        assert vanishes(route.balances[i] - euler - 2 * (moments[j] - moments[n]) * w[j] * w[n]).fails


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: NewtonEuler([Particle(m, (x,))], [x], [Load(1, (tau,))]), "a load is on body 1"),
        (lambda: NewtonEuler([Particle(m, (x,))], [x], [Load(0, (tau, 0))]), "a force of 2 components"),
        (
            lambda: (
                NewtonEuler([Particle(m, (x,))], [x], [Load(0, (P,)), Load(0, (tau,))], [P, tau]).solution
            ),
            "do not determine",
        ),
        (
            lambda: (
                NewtonEuler(
                    [Particle(m, (x, sp.S.Zero))], [x], weights([Particle(m, (x, 0))], (0, -g))
                ).solution
            ),
            "cannot move like that",
        ),
        (
            lambda: (
                NewtonEuler(
                    [Particle(m, (x, theta, sp.S.Zero))],
                    [x, theta],
                    weights([Particle(m, (x, theta, 0))], (0, 0, -g)),
                ).solution
            ),
            "cannot move like that",
        ),
        (lambda: NewtonEuler([Particle(m, (x,))], [x], [Load(0, (P**2,))], [P]).solution, "not linear"),
    ],
)
def test_refusals(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_a_torque_needs_the_axes_of_the_body_that_it_turns():
    """J θ̈ = τ about the third axis, which turns in place; of a body given by ω the axes are not known."""
    turned = sp.Matrix([[cos(theta), -sin(theta), 0], [sin(theta), cos(theta), 0], [0, 0, 1]])

    def route(torque, **how):
        body = RigidBody(m, (), (I1, I1, J), **how)
        return NewtonEuler([body], [theta], [Load(0, torque=torque)])

    about = route((0, 0, tau), rotation=turned).balances[-1]
    assert vanishes(about - (J * theta.ddot - tau)).holds
    assert vanishes(about - (J * theta.ddot + tau)).fails
    spinning = (0, 0, theta.dot)
    assert vanishes(route((0, 0, 0), omega=spinning).balances[-1] - J * theta.ddot).holds
    with pytest.raises(ValueError, match="acts on a body given by omega; give its rotation"):
        route((0, 0, tau), omega=spinning).balances  # noqa: B018
