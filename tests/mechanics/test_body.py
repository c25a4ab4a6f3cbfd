"""Bodies, their kinetic energy and forces: the lecture notes' systems, each with a wrong twin."""

import pytest
import sympy as sp

from canon.expression.symbols.symbol import coordinates, parameters, time, time_derivative
from canon.mechanics.hamilton.legendre_pair import hamiltonian
from canon.mechanics.hamilton.symmetry import have_same_equations
from canon.mechanics.lagrange.body import (
    Particle,
    PlanarBody,
    RigidBody,
    euler_rotation,
    is_scleronomic,
    kinetic_energy,
    kinetic_form,
)
from canon.mechanics.lagrange.force import (
    charge_term,
    damper,
    do_no_work,
    electric_field,
    generalized_forces,
    generalized_torques,
    gravity,
    lagrangian_of_bodies,
    magnetic_field,
    spring,
)
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.reduction.eliminate_constraints import embedded
from canon.proof.equivalence import equivalent_equations
from canon.proof.vanish import vanishes

m, M, g, l, R, I, I1, I3, k, d, w, a, b, c, e = parameters("m M g l R I I1 I3 k d w a b c e", positive=True)
J1, J2, m1, m2, m3, L1, c1, c2, y0 = parameters("J1 J2 m1 m2 m3 L1 c1 c2 y0", positive=True)
tau, tau1, tau2 = parameters("tau tau1 tau2")
x, y, z, s, theta, phi, psi, q1, q2 = coordinates("x y z s theta phi psi q1 q2")
sin, cos = sp.sin, sp.cos


def same(one, other):
    assert vanishes(sp.sympify(one) - other).holds


def different(one, other):
    assert vanishes(sp.sympify(one) - other).fails


def test_bead_on_a_turning_parabola():
    """The notes print − ω²ζ² and c = −mω²ζ²/2: both signs are wrong."""
    bead = [Particle(m, (s * cos(w * time), s * sin(w * time), s**2))]
    T = kinetic_energy(bead, [s])
    same(T, m * ((1 + 4 * s**2) * s.dot**2 + w**2 * s**2) / 2)
    different(T, m * (s.dot**2 - w**2 * s**2 + 4 * s**2 * s.dot**2) / 2)
    form = kinetic_form(T, [s])
    same(form.A[0, 0], m * (1 + 4 * s**2))
    same(form.b[0], 0)
    same(form.c, m * w**2 * s**2 / 2)
    assert is_scleronomic(bead).fails
    assert form.is_quadratic().fails


def test_scleronomic_bodies_have_a_quadratic_T():
    polar = [Particle(m, (s * cos(theta), s * sin(theta)))]
    assert is_scleronomic(polar).holds
    form = kinetic_form(kinetic_energy(polar, [s, theta]), [s, theta])
    assert form.is_quadratic().holds
    for found, expected in zip(form.A, (m, 0, 0, m * s**2), strict=True):
        same(found, expected)


def test_linear_terms_appear_in_a_moving_frame():
    """On a turntable T has all three parts, Coriolis and centrifugal."""
    c_, s_ = cos(w * time), sin(w * time)
    T = kinetic_energy([Particle(m, (x * c_ - y * s_, x * s_ + y * c_))], [x, y])
    T2, T1, T0 = kinetic_form(T, [x, y]).parts
    same(T2, m * (x.dot**2 + y.dot**2) / 2)
    same(T1, m * w * (x * y.dot - y * x.dot))
    same(T0, m * w**2 * (x**2 + y**2) / 2)
    different(T1, m * w * (y * x.dot - x * y.dot))


def test_T_of_higher_degree_is_refused():
    with pytest.raises(ValueError, match="not quadratic"):
        kinetic_form(x.dot**4, [x])


def test_rolling_plane():
    """T of an object that rolls without slipping: (I + m R²) θ̇²/2."""
    body = [PlanarBody(m, (R * theta, R), I, theta)]
    same(kinetic_energy(body, [theta]), (I + m * R**2) * theta.dot**2 / 2)
    different(kinetic_energy(body, [theta]), (I + m * R) * theta.dot**2 / 2)


def test_rod_of_the_piston_engine_as_two_masses():
    """T₂ = m_A v_A²/2 + m_B v_B²/2 + (J₂ − m₂ab) φ̇²/2 with m_A = m₂b/l, m_B = m₂a/l, l = a + b."""
    length = a + b
    A = (R * cos(theta), R * sin(theta))
    B = (R * cos(theta) + length * cos(phi), R * sin(theta) - length * sin(phi))
    centre = (R * cos(theta) + a * cos(phi), R * sin(theta) - a * sin(phi))
    T = kinetic_energy([PlanarBody(m2, centre, J2, phi)], [theta, phi])
    masses = [Particle(m2 * b / length, A), Particle(m2 * a / length, B)]
    replaced = kinetic_energy(masses, [theta, phi]) + (J2 - m2 * a * b) * phi.dot**2 / 2
    same(T, replaced)
    different(T, replaced + 2 * m2 * a * b * phi.dot**2 / 2)


def test_heavy_symmetric_top_from_its_rotation():
    """T = I₁(θ̇² + φ̇² sin²θ)/2 + I₃(ψ̇ + φ̇ cos θ)²/2 (Goldstein, § 5.7)."""
    q = [theta, phi, psi]
    top = RigidBody(M, (), (I1, I1, I3), euler_rotation(phi, theta, psi))
    expected = (
        I1 * (theta.dot**2 + phi.dot**2 * sin(theta) ** 2) / 2
        + I3 * (psi.dot + phi.dot * cos(theta)) ** 2 / 2
    )
    same(kinetic_energy([top], q), expected)
    different(kinetic_energy([top], q), expected - 2 * I3 * psi.dot * phi.dot * cos(theta))
    omega = (
        phi.dot * sin(theta) * sin(psi) + theta.dot * cos(psi),
        phi.dot * sin(theta) * cos(psi) - theta.dot * sin(psi),
        phi.dot * cos(theta) + psi.dot,
    )
    same(kinetic_energy([RigidBody(M, (), (I1, I1, I3), omega=omega)], q), expected)


def test_a_body_says_how_it_turns():
    turned = RigidBody(M, (), (I1, I1, I3), euler_rotation(phi, theta, psi))
    assert repr(turned).endswith(f"rotation={euler_rotation(phi, theta, psi).tolist()})")
    assert repr(RigidBody(M, (), (I1, I1, I3), omega=(0, 0, phi.dot))).endswith("omega=(0, 0, phi_dot))")


def test_a_body_about_a_fixed_point_by_its_centre():
    """Steiner: the top about its tip, from the motion of its centre of mass."""
    rotation = euler_rotation(phi, theta, psi)
    tip = kinetic_energy([RigidBody(M, (), (I1 + M * l**2, I1 + M * l**2, I3), rotation)], [theta, phi, psi])
    centre = [l * rotation[i, 2] for i in range(3)]
    same(tip, kinetic_energy([RigidBody(M, centre, (I1, I1, I3), rotation)], [theta, phi, psi]))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: RigidBody(m, (), (I1, I1), omega=(0, 0, 0)), "a symmetric 3×3 matrix"),
        (lambda: RigidBody(m, (), (I1, I1, I3)), "say how the body turns"),
        (lambda: RigidBody(m, (), (I1, I1, I3), omega=(0,)), "1 component of the angular velocity"),
    ],
)
def test_refusals(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def agrees(lagrangian, equations, twin):
    unknowns = [s.ddot for s in lagrangian.q]
    assert equivalent_equations(lagrangian.equations, equations, unknowns).holds
    assert equivalent_equations(lagrangian.equations, twin, unknowns).fails


def test_block_in_a_pipe():
    """Spring and damper along a pipe that swings; the notes print Q_y = −d y for −d ẏ."""
    q = [theta, y]
    place = (y * sin(theta), -y * cos(theta))
    V = gravity([Particle(m, place)], (0, -g)) + k * (y - y0) ** 2 / 2
    friction = [-d * y.dot * part for part in (sin(theta), -cos(theta))]
    Q = generalized_forces([friction], [place], q)
    same(Q[0], 0)
    same(Q[1], -d * y.dot)
    different(Q[1], -d * y)
    swing = m * y**2 * theta.ddot + 2 * m * y * y.dot * theta.dot + m * g * y * sin(theta)
    slide = m * y.ddot - m * y * theta.dot**2 - m * g * cos(theta) + k * (y - y0) + d * y.dot
    block = lagrangian_of_bodies([Particle(m, place)], q, V, forces=Q)
    agrees(block, [swing, slide], [swing, slide - 2 * d * y.dot])
    by_rayleigh = lagrangian_of_bodies([Particle(m, place)], q, V, dissipation=damper(d, place, (0, 0), q))
    agrees(by_rayleigh, [swing, slide], [swing, slide + m * g * cos(theta)])


def test_inertia_wheel_pendulum():
    """J₁ q̈₁ + J₂(q̈₁ + q̈₂) = −U′, J₂(q̈₁ + q̈₂) = τ: the motor works on the relative angle."""
    U = sp.Function("U")(q1)
    Q = generalized_torques([tau], [q2], [q1, q2])
    assert (0, tau) == Q
    turning = [PlanarBody(0, (), J1, q1), PlanarBody(0, (), J2, q1 + q2)]
    wheel = lagrangian_of_bodies(turning, [q1, q2], U, forces=Q)
    both = J2 * (q1.ddot + q2.ddot)
    agrees(wheel, [J1 * q1.ddot + both + U.diff(q1), both - tau], [J1 * q1.ddot + U.diff(q1), both - tau])


def test_mass_spring_with_actuator():
    q = coordinates("q")
    driven = lagrangian_of_bodies([Particle(m, (q,))], [q], k * (q - y0) ** 2 / 2, forces=[tau])
    agrees(driven, [m * q.ddot + k * (q - y0) - tau], [m * q.dot + k * (q - y0) - tau])


def test_robotic_manipulator():
    """Planar two-link arm (Egeland & Gravdahl, Modeling and Simulation for Automatic Control, § 8.2.8)."""
    elbow = (L1 * cos(q1), L1 * sin(q1))
    first = PlanarBody(m1, (c1 * cos(q1), c1 * sin(q1)), I1, q1)
    second = PlanarBody(m2, (elbow[0] + c2 * cos(q1 + q2), elbow[1] + c2 * sin(q1 + q2)), I3, q1 + q2)
    torques = generalized_torques([tau1, tau2], [q1, q2], [q1, q2])
    arm = lagrangian_of_bodies([first, second], [q1, q2], gravity([first, second], (0, -g)), forces=torques)
    T = m1 * c1**2 * q1.dot**2 / 2 + I1 * q1.dot**2 / 2 + I3 * (q1.dot + q2.dot) ** 2 / 2
    T += m2 * (L1**2 * q1.dot**2 + c2**2 * (q1.dot + q2.dot) ** 2) / 2
    T += m2 * L1 * c2 * cos(q2) * q1.dot * (q1.dot + q2.dot)
    V = m1 * g * c1 * sin(q1) + m2 * g * (L1 * sin(q1) + c2 * sin(q1 + q2))
    assert have_same_equations(arm, Lagrangian(T - V, [q1, q2], forces=[tau1, tau2])).holds
    assert have_same_equations(arm, Lagrangian(T + V, [q1, q2], forces=[tau1, tau2])).fails
    h = m2 * L1 * c2 * sin(q2)
    coriolis = [-h * (2 * q1.dot * q2.dot + q2.dot**2), h * q1.dot**2]
    at_rest = {q1.dot: 0, q2.dot: 0}
    for bias, expected in zip(arm.bias, coriolis, strict=True):
        same(bias - bias.subs(at_rest), expected)


def test_bead_on_a_turning_hoop():
    """The notes' second quiz: m a² φ̈ = m a² ω² sin φ cos φ − m g a sin φ."""
    place = (a * sin(phi) * cos(w * time), a * sin(phi) * sin(w * time), a - a * cos(phi))
    bead = lagrangian_of_bodies([Particle(m, place)], [phi], gravity([Particle(m, place)], (0, 0, -g)))
    equation = a * phi.ddot - a * w**2 * sin(phi) * cos(phi) + g * sin(phi)
    agrees(bead, [equation], [equation + 2 * a * w**2 * sin(phi) * cos(phi)])
    same(
        hamiltonian(bead).H,
        phi.momentum**2 / (2 * m * a**2) - m * a**2 * w**2 * sin(phi) ** 2 / 2 + m * g * a * (1 - cos(phi)),
    )


def test_foucault_pendulum():
    """Small swings over ground that turns with Ω at the latitude β: ẍ = −ω²x + 2Ω sin β ẏ to first order in Ω."""
    Omega, beta = sp.symbols("Omega beta", real=True)
    c_, s_ = cos(Omega * time), sin(Omega * time)
    turn = sp.Matrix([[c_, -s_, 0], [s_, c_, 0], [0, 0, 1]])
    tilt = sp.Matrix([[sin(beta), 0, cos(beta)], [0, 1, 0], [-cos(beta), 0, sin(beta)]])
    local = sp.Matrix([x, y, 0])  # south, east, up; the height is of second order
    place = tuple(turn * tilt * local)
    swing = lagrangian_of_bodies([Particle(m, place)], [x, y], m * w**2 * (x**2 + y**2) / 2)
    first_order = [f.subs(Omega, 0) + Omega * f.diff(Omega).subs(Omega, 0) for f in swing.accelerations]
    same(first_order[0], -(w**2) * x + 2 * Omega * sin(beta) * y.dot)
    same(first_order[1], -(w**2) * y - 2 * Omega * sin(beta) * x.dot)
    different(first_order[1], -(w**2) * y + 2 * Omega * sin(beta) * x.dot)


def test_charge_in_electric_and_magnetic_fields():
    """Lorentz: m r̈ = e (E + ṙ × B); the notes' quiz with A, B, C the components of a vector potential."""
    r = (x, y, z)
    A = tuple(sp.Function(f"A{i}")(x, y, z, time) for i in range(3))
    V = sp.Function("phi")(x, y, z, time)
    charge = lagrangian_of_bodies([Particle(m, r)], r, -charge_term(e, r, r, A, V))
    E, B = electric_field(A, V, r), magnetic_field(A, r)
    v = [s.dot for s in r]
    for i in range(3):
        j, n = (i + 1) % 3, (i + 2) % 3
        lorentz = e * (E[i] + v[j] * B[n] - v[n] * B[j])
        same(charge.equations[i], m * r[i].ddot - lorentz)
        different(charge.equations[i], m * r[i].ddot - e * (E[i] - v[j] * B[n] + v[n] * B[j]))


def test_the_printed_y_for_z_of_the_quiz_is_seen():
    r = (x, y, z)
    A = tuple(sp.Function(name)(x, y, z) for name in "ABC")
    V = sp.Function("V")(x, y, z)
    charge = lagrangian_of_bodies([Particle(m, r)], r, -charge_term(sp.S.One, r, r, A, V))
    right = (
        m * x.ddot + (A[0].diff(y) - A[1].diff(x)) * y.dot + (A[0].diff(z) - A[2].diff(x)) * z.dot + V.diff(x)
    )
    printed = (
        m * x.ddot + (A[0].diff(y) - A[1].diff(x)) * y.dot + (A[0].diff(x) - A[2].diff(x)) * z.dot + V.diff(x)
    )
    same(charge.equations[0], right)
    different(charge.equations[0], printed)


def test_springs_and_dampers_between_moving_points():
    energy = spring(k, (x, y), (z, 0), rest=l)
    same(energy, k * (sp.sqrt((x - z) ** 2 + y**2) - l) ** 2 / 2)
    same(damper(d, (x,), (z,), [x, z]), d * (x.dot - z.dot) ** 2 / 2)
    different(damper(d, (x,), (z,), [x, z]), d * (x.dot + z.dot) ** 2 / 2)


def test_quadratic_drag_by_rayleigh():
    speed = sp.sqrt(x.dot**2 + y.dot**2)
    falling = lagrangian_of_bodies([Particle(m, (x, y))], [x, y], m * g * y, dissipation=k * speed**3 / 3)
    right = [m * x.ddot + k * speed * x.dot, m * y.ddot + m * g + k * speed * y.dot]
    agrees(falling, right, [right[0], right[1] - 2 * k * speed * y.dot])


def test_ideal_reactions_do_no_virtual_work():
    """On the turning wire the reaction works in real displacements, not in virtual ones."""
    S = sp.Symbol("S", real=True)
    place = (s * cos(w * time), s * sin(w * time))
    across = (-S * sin(w * time), S * cos(w * time))
    assert do_no_work([across], [place], [s]).holds
    real_power = sum(F * time_derivative(r, [s]) for F, r in zip(across, place, strict=True))
    assert vanishes(real_power).fails
    assert do_no_work([place], [place], [s]).fails


def test_equilibrium_by_virtual_work():
    """A lever with weights at arms a and b: Q = (m₁a − m₂b) g cos φ."""
    left, right = (-a * cos(phi), -a * sin(phi)), (b * cos(phi), b * sin(phi))
    (Q,) = generalized_forces([(0, -m1 * g), (0, -m2 * g)], [left, right], [phi])
    same(Q, (m1 * a - m2 * b) * g * cos(phi))
    same(Q.subs(m1, m2 * b / a), 0)
    different(Q.subs(m1, m2), 0)


def test_lagranges_equations_keep_their_form_under_affine_maps():
    """The notes' invariance: q = a Q + c with constants; equations map into one another."""
    Y = coordinates("Y")
    V = sp.Function("V")(x)
    old = Lagrangian(m * x.dot**2 / 2 - V, [x])
    new = embedded(old, {x: a * Y + c}, [Y])
    there = {x.dot: a * Y.dot, x.ddot: a * Y.ddot}
    assert vanishes(new.equations[0] - a * old.equations[0].xreplace(there).subs(x, a * Y + c)).holds
