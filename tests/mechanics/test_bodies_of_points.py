"""Second routes to energy, Appell's function and generalized forces: bodies taken apart into point masses."""

import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from canon.expression.symbols.symbol import coordinates, time
from canon.mechanics.at_scale.numeric_functions import acceleration_function
from canon.mechanics.at_scale.second_order import derivation
from canon.mechanics.lagrange.appell import GibbsAppell
from canon.mechanics.lagrange.body import Particle, PlanarBody, RigidBody, euler_rotation, kinetic_energy
from canon.mechanics.lagrange.force import (
    generalized_forces,
    generalized_moments,
    lagrangian_of_bodies,
    potential_forces,
)
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.lagrange.quasi_velocity import Kinematics

x, y, theta, phi, psi = coordinates("x y theta phi psi")
small = st.integers(-3, 3)
point_masses = st.lists(st.tuples(st.integers(1, 3), small, small, small), min_size=2, max_size=2)
TURNED = euler_rotation(phi, theta, psi)
ANGLES = (theta, phi, psi)
EULER = (
    phi.dot * sp.sin(theta) * sp.sin(psi) + theta.dot * sp.cos(psi),
    phi.dot * sp.sin(theta) * sp.cos(psi) - theta.dot * sp.sin(psi),
    phi.dot * sp.cos(theta) + psi.dot,
)
"""The angular velocity of TURNED along the body's axes (Goldstein, Classical Mechanics, § 4.9)."""


def at_a_point(symbols):
    """Return values of symbols and of the time to 50 digits, none of them special."""
    values = {s: sp.Float(sp.Rational(3 * k + 2, 2 * k + 5), 50) for k, s in enumerate(symbols)}
    return values | {time: sp.Float(sp.Rational(2, 7), 50)}


def is_zero(f):
    return abs(sp.N(f, 50)) < sp.Float("1e-30")


def agree(ours, theirs):
    there = at_a_point([s for c in ANGLES for s in (c, c.dot, c.ddot)])
    return all(is_zero((a - b).xreplace(there)) for a, b in zip(ours, theirs, strict=True))


def inertia_of(points):
    """Return Σ m (ρ² 1 − ρ ρᵀ) of point masses."""
    total = sp.zeros(3, 3)
    for m, *rho in points:
        arm = sp.Matrix(rho)
        total += m * (arm.dot(arm) * sp.eye(3) - arm * arm.T)
    return total


@settings(max_examples=10, deadline=None)  # half a second each: seven derivations in three angles
@given(point_masses)
def test_a_rigid_body_about_a_fixed_point_moves_as_its_points_do(points):
    inertia = inertia_of(points)
    assume(inertia[0, 1] != 0)
    particles = [Particle(m, tuple(TURNED * sp.Matrix(rho))) for m, *rho in points]
    twin = inertia.copy()
    twin[0, 1] = twin[1, 0] = -inertia[0, 1]
    body, mirrored = (RigidBody(0, (), I, TURNED) for I in (inertia, twin))
    apart = GibbsAppell(particles, ANGLES)
    assert agree([kinetic_energy([body], ANGLES)], [kinetic_energy(particles, ANGLES)])
    assert agree(GibbsAppell([body], ANGLES).slopes, apart.slopes)
    assert not agree([kinetic_energy([mirrored], ANGLES)], [kinetic_energy(particles, ANGLES)])
    assert not agree(GibbsAppell([mirrored], ANGLES).slopes, apart.slopes)


@settings(max_examples=10, deadline=None)  # half a second each: Lagrange's equations of a whole body
@given(st.lists(st.integers(1, 4), min_size=6, max_size=6), st.lists(small, min_size=6, max_size=6))
def test_slopes_are_those_of_the_gibbs_function_and_of_lagrange(moments, given_forces):
    """∂S/∂u̇ in quasi-velocities: from S itself, term by term, and from Lagrange's equations."""
    A, B, C, D, E, F = moments
    inertia = sp.Matrix([[A + 9, D, E], [D, B + 9, F], [E, F, C + 9]])
    n = given_forces
    u = sp.symbols("u v w", real=True)
    rates = [u[0] + n[0] * theta * u[1], (2 + sp.sin(theta)) * u[1] + n[1] * time, u[2] - phi * u[0]]
    body = RigidBody(2, (theta * psi, phi), inertia, omega=EULER)
    V, Q = n[2] * theta * sp.cos(psi), [n[3] * phi.dot, n[4] * theta * psi.dot, sp.S(n[5])]
    appell = GibbsAppell([body], ANGLES, V, u, rates, Q)
    kinematics = appell.kinematics
    lagrange = lagrangian_of_bodies([body], ANGLES, V, Q).equations
    by_maggi = [sp.Add(*(e * f.diff(w) for e, f in zip(lagrange, rates, strict=True))) for w in u]
    there = at_a_point((*ANGLES, *u, *kinematics.u_dot))
    for a, slope, maggi, ours in zip(
        kinematics.u_dot, appell.slopes, by_maggi, appell.equations, strict=True
    ):
        assert is_zero((appell.gibbs_function.diff(a) - slope).xreplace(there))
        assert is_zero((kinematics.along(maggi) - ours).xreplace(there))
        assert not is_zero((kinematics.along(maggi) - ours - a).xreplace(there))


def test_a_planar_body_given_by_its_angular_velocity_moves_as_the_one_given_by_its_angle():
    m, J = sp.symbols("m J", positive=True)
    place = (x + sp.sin(theta), y)
    q = [x, y, theta]
    by_angle, by_omega = PlanarBody(m, place, J, theta), PlanarBody(m, place, J, omega=theta.dot)
    assert kinetic_energy([by_angle], q) == kinetic_energy([by_omega], q)
    assert GibbsAppell([by_angle], q).equations == GibbsAppell([by_omega], q).equations
    one, other = (
        acceleration_function(derivation([body], q), {m: 1.5, J: 0.4}) for body in (by_angle, by_omega)
    )
    state = ([0.1, 0.2, 0.3], [1.0, -0.5, 2.0], 0.0)
    assert one(*state) == pytest.approx(other(*state), abs=1e-13)
    for wrong in ({}, {"angle": theta, "omega": theta.dot}):
        with pytest.raises(ValueError, match="by angle or by omega"):
            PlanarBody(m, place, J, **wrong)


def test_moments_on_angular_velocities_do_the_work_of_forces_on_points():
    """A couple F at ρ and −F at −ρ works as the moment 2 ρ × F along the axes of the body."""
    rho, F = sp.Matrix([1, -2, 3]), sp.Matrix([2, 5, -1])
    omega = RigidBody(0, (), (1, 1, 1), TURNED).angular_velocity(Kinematics(ANGLES))
    places = [tuple(sign * TURNED * rho) for sign in (1, -1)]
    couple = generalized_forces([tuple(sign * TURNED * F) for sign in (1, -1)], places, ANGLES)
    assert agree(generalized_moments([tuple(2 * rho.cross(F))], [omega], ANGLES), couple)
    assert not agree(generalized_moments([tuple(2 * F.cross(rho))], [omega], ANGLES), couple)
    with pytest.raises(ValueError, match="not affine"):
        generalized_moments([(1,)], [(theta.dot**2,)], ANGLES)


@settings(max_examples=50, deadline=None)
@given(st.lists(small, min_size=4, max_size=4))
def test_forces_of_a_potential_are_what_lagrange_takes_from_it(n):
    V = n[0] * x * y.dot + n[1] * y**2 * x.dot + n[2] * x**3 * y + n[3] * time * x
    free = Lagrangian((x.dot**2 + y.dot**2) / 2, [x, y])
    with_it = Lagrangian(free.L - V, [x, y])
    forces = potential_forces(V, [x, y])
    for equation, without, Q in zip(with_it.equations, free.equations, forces, strict=True):
        assert sp.expand(equation - without + Q) == 0
