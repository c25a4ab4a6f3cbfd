"""Singular Lagrangians: primary constraints and equations without accelerations, and their wrong twins."""

import pytest
import sympy as sp

from canon.expression.symbols.symbol import coordinates, parameters, time_derivative
from canon.mechanics.algebra.linear import SingularMatrixError
from canon.mechanics.hamilton.legendre import LegendreError
from canon.mechanics.hamilton.legendre_pair import hamiltonian
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.reduction.singular import singularity
from canon.proof.domain.domain import Domain
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
        hamiltonian(L)


def test_a_total_derivative_has_no_dynamics():
    F = x**2 * y
    found = singularity(Lagrangian(time_derivative(F, [x, y]), [x, y]))
    assert found.rank == 0
    assert all(vanishes(c).holds for c in found.motion_constraints)


def holds_identically(L, primary):
    there = dict(zip((s.momentum for s in L.q), L.momenta, strict=True))
    return primary.xreplace(there)


def test_jacobis_form_of_a_pendulum_is_homogeneous():
    """√(2 (E − V)) √(q̇ᵀM q̇): any parameter will do, p M⁻¹ p = 2 (E − V), and Σ p q̇ − L = 0."""
    E, V = sp.Symbol("E", positive=True), k * (x**2 + y**2) / 2
    inside = Domain((V < E, x.dot > 0, y.dot > 0))
    L = Lagrangian(sp.sqrt(2 * (E - V)) * sp.sqrt(m * (x.dot**2 + y.dot**2)), [x, y])
    found = singularity(L, domain=inside)
    assert found.rank == 1
    (primary,) = found.primary_constraints
    energy = (x.momentum**2 + y.momentum**2) / (2 * m) + V - E
    assert vanishes(holds_identically(L, energy), inside).holds
    assert vanishes(holds_identically(L, primary), inside).holds
    wrong = (x.momentum**2 + y.momentum**2) / (2 * m) - V - E
    assert vanishes(holds_identically(L, wrong), inside).fails
    assert primary.diff(y.momentum) != 0 or primary.diff(x.momentum) != 0
    assert found.motion_constraints == (0,)
    assert found.hamiltonian == 0
    assert "arbitrary" in str(found)


def test_a_relativistic_particle_in_any_parameter():
    c, mass = parameters("c mass", positive=True)
    t, s = coordinates("t s")
    L = Lagrangian(-mass * c * sp.sqrt(c**2 * t.dot**2 - s.dot**2), [t, s], t=sp.Symbol("tau", real=True))
    future = Domain((t.dot > 0, c * t.dot > s.dot, c * t.dot > -s.dot))
    found = singularity(L, domain=future)
    (primary,) = found.primary_constraints
    assert vanishes(primary - (t.momentum + c * sp.sqrt(s.momentum**2 + mass**2 * c**2))).holds
    assert vanishes(primary - (t.momentum - c * sp.sqrt(s.momentum**2 + mass**2 * c**2))).fails
    assert found.hamiltonian == 0


def test_part_of_a_nonquadratic_L_may_be_regular():
    """A relativistic bead and a multiplier: p_z = 0, and H is that of the bead with the multiplier in it."""
    c = sp.Symbol("c", positive=True)
    slow = Domain((x.dot**2 < c**2,))
    L = Lagrangian(-m * c**2 * sp.sqrt(1 - x.dot**2 / c**2) - z * x, [x, z])
    found = singularity(L, domain=slow)
    assert found.primary_constraints == (z.momentum,)
    assert vanishes(found.hamiltonian - (c * sp.sqrt(m**2 * c**2 + x.momentum**2) + z * x)).holds
    assert vanishes(found.hamiltonian - (c * sp.sqrt(m**2 * c**2 + x.momentum**2) - z * x)).fails
    assert found.motion_constraints == (x,)


def test_the_canonical_hamiltonian_of_a_quadratic_L():
    """L = (ẋ − y)²/2: H = p_x²/2 + y p_x up to the constraint p_y = 0 (Dirac)."""
    found = singularity(Lagrangian((x.dot - y) ** 2 / 2, [x, y]))
    assert vanishes(found.hamiltonian - (x.momentum**2 / 2 + y * x.momentum)).holds
    assert vanishes(found.hamiltonian - (x.momentum**2 / 2 - y * x.momentum)).fails
    linear = singularity(Lagrangian(B * x * y.dot - k * x**2, [x, y]))
    assert linear.hamiltonian == k * x**2


def test_what_has_no_closed_form_is_refused():
    quartic = (x.dot - y.dot) ** 4 + sp.exp(x.dot - y.dot)
    with pytest.raises(ValueError, match=r"singular .* rank 1 for 2 coordinates.* not found in closed form"):
        singularity(Lagrangian(quartic, [x, y]))
