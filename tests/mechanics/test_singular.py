"""Singular Lagrangians: primary constraints and equations without accelerations, and their wrong twins."""

import pytest
import sympy as sp

from canon.expression.symbol import coordinates, parameters, time_derivative
from canon.mechanics.lagrangian import Lagrangian
from canon.mechanics.legendre import LegendreError
from canon.mechanics.linear import SingularMatrixError
from canon.mechanics.singular import singularity
from canon.proof.vanish import vanishes

m, k, B = parameters("m k B", positive=True)
x, y, z, theta = coordinates("x y z theta")


def parallel(one, other):
    return vanishes(one.diff(x.momentum) * other - other.diff(x.momentum) * one).holds


def test_a_regular_lagrangian_has_none():
    found = singularity(Lagrangian(m * (x.dot**2 + y.dot**2) / 2, [x, y]))
    assert (found.rank, found.primary_constraints, found.motion_constraints) == (2, (), ())
    assert "regular" in str(found)


def test_L_linear_in_the_velocities():
    """Guiding centre: L = B x ẏ − V: p_x = 0, p_y = B x; the equations are of first order."""
    V = k * (x**2 + y**2) / 2
    L = Lagrangian(B * x * y.dot - V, [x, y])
    found = singularity(L)
    assert found.rank == 0
    assert set(found.primary_constraints) == {x.momentum, y.momentum - B * x}
    assert set(found.motion_constraints) == {-B * y.dot + k * x, B * x.dot + k * y}
    assert found.primary_constraints[1] != y.momentum + B * x


def test_L_free_of_a_velocity():
    """A multiplier among the coordinates: p_z = 0 and the constraint itself."""
    found = singularity(Lagrangian(m * (x.dot**2 + y.dot**2) / 2 + z * (x - y), [x, y, z]))
    assert found.rank == 2
    assert found.primary_constraints == (z.momentum,)
    assert vanishes(found.motion_constraints[0] - (y - x)).holds
    assert vanishes(found.motion_constraints[0] - (y + x)).fails


def test_a_velocity_that_only_occurs_in_a_combination():
    found = singularity(Lagrangian(m * (x.dot + y.dot) ** 2 / 2 - k * x**2 * y, [x, y]))
    assert parallel(found.primary_constraints[0], x.momentum - y.momentum)
    assert not parallel(found.primary_constraints[0], x.momentum + y.momentum)
    assert vanishes(found.motion_constraints[0] ** 2 - (2 * k * x * y - k * x**2) ** 2).holds


def test_null_directions_that_depend_on_position():
    """L = (cos θ ẋ + sin θ ẏ)²/2: sin θ p_x − cos θ p_y = 0."""
    c, s = sp.cos(theta), sp.sin(theta)
    found = singularity(Lagrangian((c * x.dot + s * y.dot) ** 2 / 2 + theta.dot**2 / 2, [x, y, theta]))
    assert found.rank == 2
    (primary,) = found.primary_constraints
    assert parallel(primary, s * x.momentum - c * y.momentum)
    assert not parallel(primary, s * x.momentum + c * y.momentum)


@pytest.mark.parametrize(
    "L",
    [
        Lagrangian((x.dot - y) ** 2 / 2, [x, y]),
        Lagrangian(B * x * y.dot - x**2, [x, y]),
        Lagrangian(m * (x.dot + y.dot) ** 2 / 2 + y * x.dot, [x, y]),
    ],
)
def test_the_momenta_satisfy_the_primary_constraints_identically(L):
    there = dict(zip((s.momentum for s in L.q), L.momenta, strict=True))
    for primary, motion, n in zip(
        singularity(L).primary_constraints,
        singularity(L).motion_constraints,
        singularity(L).null_directions,
        strict=True,
    ):
        assert vanishes(primary.xreplace(there)).holds
        lagrange = sum(c * e for c, e in zip(n, L.equations, strict=True))
        assert vanishes(lagrange - motion).holds
    with pytest.raises(SingularMatrixError):
        L.accelerations  # noqa: B018
    with pytest.raises(LegendreError):
        L.hamiltonian()


def test_a_total_derivative_has_no_dynamics():
    F = x**2 * y
    found = singularity(Lagrangian(time_derivative(F, [x, y]), [x, y]))
    assert found.rank == 0
    assert all(vanishes(c).holds for c in found.motion_constraints)


def test_what_is_not_quadratic_is_refused():
    with pytest.raises(ValueError, match="depends on the velocities"):
        singularity(Lagrangian(sp.sqrt(x.dot**2 + y.dot**2), [x, y]))
