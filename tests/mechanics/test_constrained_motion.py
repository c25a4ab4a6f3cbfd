"""Motions on a constraint manifold: multipliers and forces of constraint, with first integrals put in."""

import pytest
import sympy as sp
from sympy import Function, cos, sin

from canon import ConstrainedLagrangian, Lagrangian, coordinates, parameters
from canon.expression.symbols.symbol import acceleration
from canon.mechanics import constrained_motions, multiplier_along
from canon.mechanics.algebra.constraint_manifold import EmptyDomainError
from canon.proof import vanishes

m, g, a, R, E, J = parameters("m g a R E J", positive=True)
r, theta, x, y, phi = coordinates("r theta x y phi")
PLANE = Lagrangian(m * (r.dot**2 + r**2 * theta.dot**2) / 2 - m * g * r * cos(theta), [r, theta])
SPHERE = ConstrainedLagrangian(PLANE, holonomic=[r - a])
ENERGY = m * a**2 * theta.dot**2 / 2 + m * g * a * cos(theta)


def test_with_its_energy_the_force_of_the_sphere_is_a_function_of_the_place():
    forth, back = constrained_motions(SPHERE, ENERGY - E)
    by_routh = multiplier_along(SPHERE, {r: a}, theta, sp.S.Zero)
    assert vanishes(forth.along(theta.dot) + back.along(theta.dot), forth.branch.domain).holds
    for motion in (forth, back):
        assert vanishes(motion.multipliers[0].subs(E, m * g * a) - by_routh).holds
        assert vanishes(motion.multipliers[0].subs(E, m * g * a) + by_routh).fails
        assert motion.reactions == (motion.multipliers[0], 0)
        assert vanishes(motion.rates[0], motion.branch.domain).holds


def test_without_integrals_it_is_what_the_constraints_alone_make_of_the_multipliers():
    """ConstrainedLagrangian solves off the manifold: on it both are the same, and accelerations too."""
    free = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 - m * g * y, [x, y])
    circle = ConstrainedLagrangian(free, holonomic=[x**2 + y**2 - a**2])
    for motion in constrained_motions(circle):
        domain = motion.branch.domain
        assert vanishes(motion.multipliers[0] - motion.along(circle.multipliers[0]), domain).holds
        assert vanishes(motion.multipliers[0] - 2 * motion.along(circle.multipliers[0]), domain).fails
        for s, value in zip((x, y), circle.accelerations, strict=True):
            found = motion.solution[acceleration(s)]
            assert vanishes(found - motion.along(value), domain).holds


def test_of_a_velocity_constraint_the_force_is_that_of_the_blade():
    """A blade on a plane, ẋ sin φ = ẏ cos φ: λ = −m φ̇ (ẋ cos φ + ẏ sin φ), and the spin is kept."""
    free = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 + J * phi.dot**2 / 2, [x, y, phi])
    blade = ConstrainedLagrangian(free, nonholonomic=[x.dot * sin(phi) - y.dot * cos(phi)])
    right = -m * phi.dot * (x.dot * cos(phi) + y.dot * sin(phi))
    (motion,) = constrained_motions(blade, phi.dot - R)
    assert vanishes(motion.multipliers[0] - motion.along(right), motion.branch.domain).holds
    assert vanishes(motion.multipliers[0] + motion.along(right), motion.branch.domain).fails


def test_arbitrary_functions_stay_what_they_are():
    V = Function("V")(theta)
    held = ConstrainedLagrangian(Lagrangian(PLANE.L - V, [r, theta]), holonomic=[r - a])
    (motion,) = constrained_motions(held)
    assert vanishes(motion.multipliers[0] - (m * g * cos(theta) - m * a * theta.dot**2)).holds


@pytest.mark.parametrize("wrong", [ENERGY + m * g * a * cos(theta) - E, theta.dot - R])
def test_what_is_not_constant_is_refused(wrong):
    with pytest.raises(ValueError, match="not proved constant along the motion"):
        constrained_motions(SPHERE, wrong)


def test_what_no_motion_satisfies_is_refused():
    with pytest.raises(EmptyDomainError):
        constrained_motions(SPHERE, theta.dot**2 + 1)
    with pytest.raises(TypeError, match="the system"):
        constrained_motions(PLANE)
