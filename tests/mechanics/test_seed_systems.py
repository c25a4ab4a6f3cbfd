"""Systems, derivations and homework of the lecture notes that no other file of this room covers, with the misprints."""

import pytest
import sympy as sp

from canon.expression.symbols.symbol import coordinates, parameters, time, time_derivative
from canon.mechanics.hamilton.symmetry import is_constant_of_motion
from canon.mechanics.lagrange.body import Particle, PlanarBody, kinetic_energy, kinetic_form
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.force import (
    generalized_forces,
    generalized_torques,
    gravity,
    lagrangian_of_bodies,
)
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.reduction.eliminate_constraints import embedded
from canon.proof.domain.domain import Domain
from canon.proof.equivalence import equivalent_equations
from canon.proof.vanish import vanishes

m, g, a, R, I, m1, m2, m3, l1, l2, J0, J1, J2, b, c, n = parameters(
    "m g a R I m1 m2 m3 l1 l2 J0 J1 J2 b c n", positive=True
)
P, MT, e, v0, alpha, T, TL = parameters("P M_T e v0 alpha T T_L")
x, y, z, s, theta, phi, t1, t2 = coordinates("x y z s theta phi theta1 theta2")
r, rho = coordinates("r rho", positive=True)
sin, cos = sp.sin, sp.cos


def same(one, other, domain=None):
    assert vanishes(sp.sympify(one) - other, domain or Domain()).holds


def different(one, other, domain=None):
    assert vanishes(sp.sympify(one) - other, domain or Domain()).fails


def agrees(lagrangian, equations, *twins):
    unknowns = [q.ddot for q in lagrangian.q]
    assert equivalent_equations(lagrangian.equations, equations, unknowns).holds
    for twin in twins:
        assert equivalent_equations(lagrangian.equations, twin, unknowns).fails


# The piston engine with offset e: s = r cos θ + l cos φ, l sin φ = r sin θ − e ------------------------------

L = a + b
SLOPE = (R * sin(theta) - e) / L
REACH = Domain((e + L > R, L - e > R, e > -L, sp.Lt(SLOPE**2, 1)))
PHI = sp.asin(SLOPE)
PISTON = R * cos(theta) + L * sp.sqrt(1 - SLOPE**2)


def test_piston_geometry_and_transmission_ratios():
    lam = R / L
    k_phi = lam * cos(theta) / sp.sqrt(1 - (lam * sin(theta) - e / L) ** 2)
    same(PHI.diff(theta), k_phi, REACH)
    printed = -R * (sin(theta) + k_phi * SLOPE / lam)
    same(PISTON.diff(theta), printed, REACH)  # the notes call it θ̇; it is k_s
    different(PISTON.diff(theta), printed + 2 * R * sin(theta), REACH)


def test_piston_reduced_to_the_crank_angle():
    """½ I(θ) θ̇² with I = J₀ + m_A r² + (m₃ + m_B) k_s² + J_AB k_φ², Q = −(P k_s + M_T), I θ̈ + ½ I′ θ̇² = Q."""
    k_phi, k_s = sp.Function("k_phi")(theta), sp.Function("k_s")(theta)
    inertia = J0 + m1 * R**2 + (m3 + m2) * k_s**2 + J2 * k_phi**2
    (along,) = generalized_forces([(-P,)], [(sp.Function("s")(theta),)], [theta])
    (torque,) = generalized_torques([-MT], [theta], [theta])
    crank = Lagrangian(inertia * theta.dot**2 / 2, [theta], forces=[-P * k_s - MT])
    same(along.subs(sp.Function("s")(theta).diff(theta), k_s) + torque, crank.forces[0])
    half = inertia.diff(theta) * theta.dot**2 / 2
    equation = inertia * theta.ddot + half + P * k_s + MT
    agrees(crank, [equation], [equation + half], [equation - 2 * P * k_s])


def test_piston_elimination_agrees_with_its_parts():
    """Seven coordinates embedded in the crank angle give that reduced inertia (e = 0)."""
    s_, x1, y1, x2, y2 = coordinates("s x1 y1 x2 y2")
    bodies = [PlanarBody(m1, (x1, y1), J1, theta), PlanarBody(m2, (x2, y2), J2, phi), Particle(m3, (s_,))]
    q = [x1, y1, x2, y2, theta, phi, s_]
    whole = lagrangian_of_bodies(bodies, q, forces=[0, 0, 0, 0, -MT, 0, -P])
    root = sp.sqrt(1 - (R * sin(theta) / L) ** 2)
    rod = R * sin(theta) / L
    places = {
        phi: sp.asin(rod), s_: R * cos(theta) + L * root, x1: c * cos(theta), y1: c * sin(theta),
        x2: R * cos(theta) + a * root, y2: b * rod,
    }  # fmt: skip
    crank = embedded(whole, places, [theta])
    k_phi, k_s = places[phi].diff(theta), places[s_].diff(theta)
    masses = (m2 * b / L * R**2, m2 * a / L, J2 - m2 * a * b)
    inertia = J1 + m1 * c**2 + masses[0] + (m3 + masses[1]) * k_s**2 + masses[2] * k_phi**2
    inside = Domain((R < L,))
    same(crank.mass_matrix[0, 0], inertia, inside)
    different(crank.mass_matrix[0, 0], inertia + 2 * m2 * a * b * k_phi**2, inside)
    same(crank.forces[0], -(P * k_s + MT), inside)


def test_torque_at_constant_speed():
    """I = A − B cos 2θ, P = 0, θ̇ = ω₀: M_T = −B ω₀² sin 2θ."""
    A, B, w0 = parameters("A B omega0", positive=True)
    crank = Lagrangian((A - B * cos(2 * theta)) * theta.dot**2 / 2, [theta], forces=[-MT])
    steady = crank.equations[0].xreplace({theta.ddot: sp.S.Zero, theta.dot: w0})
    same(steady, MT + B * w0**2 * sin(2 * theta))
    different(steady, MT - B * w0**2 * sin(2 * theta))


# Pendulums, particles ---------------------------------------------------------------------------------------


def test_double_pendulum_of_rods():
    first = PlanarBody(m1, (l1 / 2 * sin(t1), -l1 / 2 * cos(t1)), m1 * l1**2 / 12, t1)
    place = (l1 * sin(t1) + l2 / 2 * sin(t2), -l1 * cos(t1) - l2 / 2 * cos(t2))
    second = PlanarBody(m2, place, m2 * l2**2 / 12, t2)
    energy = kinetic_energy([first, second], [t1, t2])
    right = (m2 + m1 / 3) * l1**2 * t1.dot**2 / 2 + m2 * l2**2 * t2.dot**2 / 6
    right += m2 * l1 * l2 * cos(t1 - t2) * t1.dot * t2.dot / 2
    same(energy, right)
    middle = m1 * t1.dot**2 / 2 + m1 * l1**2 * t1.dot**2 / 24
    middle += m2 * (l1**2 * t1.dot**2 + l2**2 / 4 * t2.dot**2 + l1 * l2 * cos(t1 - t2) * t1.dot * t2.dot) / 2
    different(energy, middle)
    V = gravity([first, second], (0, -g))
    same(V, -g * l1 * (m2 + m1 / 2) * cos(t1) - g * l2 * m2 / 2 * cos(t2))
    rods = lagrangian_of_bodies([first, second], [t1, t2], V)
    same(rods.momenta[1], m2 / 3 * l2**2 * t2.dot + m2 / 2 * l1 * l2 * cos(t1 - t2) * t1.dot)
    same(rods.L.diff(t2), -m2 * l1 * l2 * sin(t2 - t1) * t1.dot * t2.dot / 2 - g * l2 * m2 / 2 * sin(t2))


def test_double_pendulum_of_points():
    upper = (a * sin(theta), -a * cos(theta))
    lower = (upper[0] + a * sin(phi), upper[1] - a * cos(phi))
    bodies = [Particle(m, upper), Particle(m, lower)]
    V = gravity(bodies, (0, -g))
    same(V, -m * g * a * (2 * cos(theta) + cos(phi)))
    different(V, m * g * a * (2 * cos(theta) + cos(phi)))
    first = (
        2 * theta.ddot + phi.ddot * cos(theta - phi) + phi.dot**2 * sin(theta - phi) + 2 * g / a * sin(theta)
    )
    second = phi.ddot + theta.ddot * cos(theta - phi) - theta.dot**2 * sin(theta - phi) + g / a * sin(phi)
    pendulum = lagrangian_of_bodies(bodies, [theta, phi], V)
    agrees(pendulum, [first, second], [first, second - 2 * g / a * sin(phi)])
    middle = 2 * m * a**2 * theta.ddot + m * a**2 * phi.ddot * cos(theta - phi) + 2 * m * g * a * sin(theta)
    middle += -m * a**2 * phi.dot * sin(theta - phi) * (theta.dot - phi.dot)
    middle += m * a**2 * phi.dot * theta.dot * sin(theta - phi)
    same(pendulum.equations[0], middle)
    different(pendulum.equations[0], middle - 4 * m * g * a * sin(theta))


def test_spherical_pendulum():
    place = (a * sin(theta) * cos(phi), a * sin(theta) * sin(phi), -a * cos(theta))
    pendulum = lagrangian_of_bodies([Particle(m, place)], [theta, phi], -m * g * a * cos(theta))
    polar = theta.ddot + g / a * sin(theta) - phi.dot**2 * sin(theta) * cos(theta)
    same(pendulum.equations[0], m * a**2 * polar)
    assert is_constant_of_motion(phi.dot * sin(theta) ** 2, pendulum).holds
    assert is_constant_of_motion(phi.dot * sin(theta), pendulum).fails


def test_projectile_and_its_trajectory():
    flight = lagrangian_of_bodies([Particle(m, (x, y))], [x, y], m * g * y)
    motion = {x: v0 * cos(alpha) * time, y: v0 * sin(alpha) * time - g * time**2 / 2}
    for equation, q in zip(flight.equations, (x, y), strict=True):
        same(equation.xreplace({q.ddot: motion[q].diff(time, 2)}), 0)
    parabola = x * sp.tan(alpha) - g * x**2 / (2 * v0**2 * cos(alpha) ** 2)
    same(motion[y] - parabola.subs(x, motion[x]), 0)
    different(motion[y] - (parabola + g * x**2 / v0**2).subs(x, motion[x]), 0)


def test_particle_in_a_vertical_plane():
    place = (r * cos(theta), r * sin(theta))
    free = lagrangian_of_bodies([Particle(m, place)], [r, theta], m * g * r * sin(theta))
    radial = m * r.ddot - m * r * theta.dot**2 + m * g * sin(theta)
    angular = r**2 * theta.ddot + 2 * r * r.dot * theta.dot + g * r * cos(theta)
    agrees(free, [radial, angular], [radial, angular - 2 * r * r.dot * theta.dot])


def test_cylindrical_coordinates():
    """The notes print p_φ = m ρ φ̇, and V_φ where V_φ/ρ is meant."""
    V = sp.Function("V")(rho, phi, z)
    free = lagrangian_of_bodies([Particle(m, (rho * cos(phi), rho * sin(phi), z))], [rho, phi, z], V)
    angular = m * (rho * phi.ddot + 2 * rho.dot * phi.dot) + V.diff(phi) / rho
    right = [m * (rho.ddot - rho * phi.dot**2) + V.diff(rho), angular, m * z.ddot + V.diff(z)]
    agrees(free, right, [right[0], angular + V.diff(phi) - V.diff(phi) / rho, right[2]])
    same(free.momenta[1], m * rho**2 * phi.dot)
    different(free.momenta[1], m * rho * phi.dot)


def test_metric_of_polar_coordinates():
    """A_q = Aᵀ A_x A; the notes print ((1, r²), (0, r²))."""
    jacobian = sp.Matrix([[cos(theta), -r * sin(theta)], [sin(theta), r * cos(theta)]])
    A = kinetic_form(
        kinetic_energy([Particle(m, (r * cos(theta), r * sin(theta)))], [r, theta]), [r, theta]
    ).A
    assert vanishes(A - m * jacobian.T * jacobian).holds
    assert vanishes(A - m * sp.Matrix([[1, r**2], [0, r**2]])).fails


def test_vertical_velocity_in_spherical_coordinates():
    height = -r * cos(theta)
    same(time_derivative(height, [r, theta]), -r.dot * cos(theta) + r * theta.dot * sin(theta))
    different(time_derivative(height, [r, theta]), r.dot * cos(theta) + r.dot * sin(theta))


# Derivations ------------------------------------------------------------------------------------------------


def test_lemmas_of_dalembert():
    """∂ṙ/∂q̇ = ∂r/∂q and ∂ṙ/∂q = d/dt ∂r/∂q for any r(q, t)."""
    place = sp.Function("r")(x, y, time)
    rate = time_derivative(place, [x, y])
    for q in (x, y):
        same(rate.diff(q.dot), place.diff(q))
        same(rate.diff(q), time_derivative(place.diff(q), [x, y]))
        different(rate.diff(q), place.diff(q))


def test_dalembert_in_general_coordinates():
    """The notes say it cannot be formulated so: Σ m r̈·∂r/∂q = d/dt ∂T/∂q̇ − ∂T/∂q does it, for any r(q, t)."""
    places = [sp.Function(f"r{i}")(x, y, time) for i in range(2)]
    kinetic = Lagrangian(kinetic_energy([Particle(m, places)], [x, y]), [x, y])
    for q, lagrange in zip((x, y), kinetic.equations, strict=True):
        inertia = sum(m * time_derivative(time_derivative(r_, [x, y]), [x, y]) * r_.diff(q) for r_ in places)
        same(inertia, lagrange)
        different(inertia, lagrange + m * places[0].diff(q))


def test_multiplier_rule():
    """λ = −Dₙ/fₙ and Dᵢ + λ fᵢ = 0, D = ∂L/∂q − d/dt ∂L/∂q̇, on the constrained motion."""
    rolling = ConstrainedLagrangian(
        Lagrangian(m * s.dot**2 / 2 + I * theta.dot**2 / 2 - m * g * s * sin(alpha), [s, theta]),
        [R * theta - s],
    )
    found = dict(zip((s.ddot, theta.ddot), rolling.accelerations, strict=True))
    D = [-equation.xreplace(found) for equation in rolling.lagrangian.equations]
    (multiplier,) = rolling.multipliers
    same(multiplier, -D[1] / R)
    same(D[0] - multiplier, 0)
    different(D[0] + multiplier, 0)


@pytest.mark.parametrize("moving", [False, True])
def test_energy_is_conserved_only_by_constraints_at_rest(moving):
    """T + V is constant where time is not explicit; on the turning hoop it is not, Jacobi's energy is."""
    w = parameters("omega") if moving else sp.S.Zero
    place = (a * sin(phi) * cos(w * time), a * sin(phi) * sin(w * time), -a * cos(phi))
    bead = lagrangian_of_bodies([Particle(m, place)], [phi], -m * g * a * cos(phi))
    total = kinetic_energy([Particle(m, place)], [phi]) - m * g * a * cos(phi)
    assert is_constant_of_motion(total, bead).holds is not moving
    assert is_constant_of_motion(bead.jacobi_energy, bead).holds


# Drives -----------------------------------------------------------------------------------------------------


def test_motor_shaft_and_gear():
    """J θ̈ = T − T_L; through a gear φ = θ/n the load's inertia counts J₂/n²."""
    shaft = Lagrangian(J1 * theta.dot**2 / 2, [theta], forces=[T - TL])
    same(shaft.equations[0], J1 * theta.ddot - (T - TL))
    pair = Lagrangian((J1 * theta.dot**2 + J2 * phi.dot**2) / 2, [theta, phi], forces=[T, -TL])
    geared = ConstrainedLagrangian(pair, holonomic=[n * phi - theta])
    same(geared.accelerations[0], (T - TL / n) / (J1 + J2 / n**2))
    different(geared.accelerations[0], (T - TL / n) / (J1 + J2 * n**2))
    reduced = embedded(pair, {phi: theta / n}, [theta])
    same(reduced.accelerations[0], geared.accelerations[0])


def test_rack_and_pinion():
    """x = R θ: the force on the rack is a multiplier."""
    pair = Lagrangian(J1 * theta.dot**2 / 2 + m * x.dot**2 / 2, [theta, x], forces=[T, -P])
    rack = ConstrainedLagrangian(pair, holonomic=[x - R * theta])
    same(rack.accelerations[1], (T / R - P) / (m + J1 / R**2))
    same(rack.multipliers[0], m * rack.accelerations[1] + P)
    different(rack.multipliers[0], m * rack.accelerations[1] - P)


def test_hollow_cylinder_in_one_coordinate():
    pair = Lagrangian(m * x.dot**2 / 2 + m * R**2 * theta.dot**2 / 2 + m * g * x * sin(phi), [x, theta])
    rolled = embedded(pair, {theta: x / R}, [x])
    same(rolled.L, m * x.dot**2 + m * g * x * sin(phi))
    same(rolled.accelerations[0], g * sin(phi) / 2)
    different(rolled.accelerations[0], g * sin(phi))
