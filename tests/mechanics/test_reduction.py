"""Routh's function, constraints, Gibbs–Appell equations and symmetries, each against a second route."""

import pytest
import sympy as sp

from canon.expression.symbols.symbol import (
    acceleration,
    coordinates,
    parameters,
    time,
    time_derivative,
    velocity,
)
from canon.mechanics.algebra.linear import SingularMatrixError
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.hamilton.symmetry import (
    gauge_function,
    have_same_equations,
    is_constant_of_motion,
    is_gauge_equivalent,
    is_symmetry,
    noether_charge,
    poissons_theorem,
)
from canon.mechanics.lagrange.appell import GibbsAppell
from canon.mechanics.lagrange.body import Particle, PlanarBody
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.force import generalized_forces
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.reduction.ignorable import ignorable_coordinates
from canon.mechanics.reduction.routh import routhian
from canon.proof.vanish import vanishes

m, l, g, a, b, k, r0, J, M = parameters("m l g a b k r J M", positive=True)
x, y, theta, phi, q1, q2 = coordinates("x y theta phi q1 q2")


def spherical():
    return Lagrangian(
        m * l**2 * (theta.dot**2 + phi.dot**2 * sp.sin(theta) ** 2) / 2 + m * g * l * sp.cos(theta),
        [theta, phi],
    )


def test_routhian_of_the_spherical_pendulum():
    L = spherical()
    assert ignorable_coordinates(L) == (phi,)
    R = routhian(L)
    p = phi.momentum
    expected = (
        m * l**2 * theta.dot**2 / 2 - p**2 / (2 * m * l**2 * sp.sin(theta) ** 2) + m * g * l * sp.cos(theta)
    )
    assert vanishes(R.R - expected).holds
    assert vanishes(R.R - expected - p**2 / (m * l**2 * sp.sin(theta) ** 2)).fails
    assert vanishes(R.ignorable_velocities[0] - p / (m * l**2 * sp.sin(theta) ** 2)).holds


def test_routhian_of_the_two_degree_system():
    """L = q̇₁²/(2(a + b q₂²)) + q̇₂²/2 − k q₂²: R = q̇₂²/2 − k q₂² − p₁²(a + b q₂²)/2."""
    L = Lagrangian(q1.dot**2 / (2 * (a + b * q2**2)) + q2.dot**2 / 2 - k * q2**2, [q1, q2])
    R = routhian(L, [q1])
    p = q1.momentum
    assert vanishes(R.R - (q2.dot**2 / 2 - k * q2**2 - p**2 * (a + b * q2**2) / 2)).holds
    assert vanishes(R.lagrangian.equations[0] - (q2.ddot + (2 * k + b * p**2) * q2)).holds
    assert vanishes(R.lagrangian.equations[0] - (q2.ddot + (k + b * p**2) * q2)).fails


def test_reduced_equations_are_lagranges_at_constant_momentum():
    L = spherical()
    R = routhian(L)
    there = {phi.momentum: L.momenta[1]}
    full = L.equations[0]
    assert vanishes(R.lagrangian.equations[0].xreplace(there) - full).holds


def test_a_coordinate_that_enters_cannot_be_ignored():
    with pytest.raises(ValueError, match="theta is not ignorable"):
        routhian(spherical(), [theta])
    assert (
        theta.dot**2 / 2 + sp.cos(theta) == routhian(Lagrangian(theta.dot**2 / 2 + sp.cos(theta), [theta])).R
    )


def test_tension_of_the_pendulum():
    """f = r − l: λ = −(tension) = −(m l θ̇² + m g cos θ)."""
    r = coordinates("r", positive=True)
    L = Lagrangian(m * (r.dot**2 + r**2 * theta.dot**2) / 2 + m * g * r * sp.cos(theta), [r, theta])
    pendulum = ConstrainedLagrangian(L, holonomic=[r - l])
    on = {r: l, r.dot: sp.S.Zero}
    tension = m * l * theta.dot**2 + m * g * sp.cos(theta)
    assert vanishes(pendulum.multipliers[0].xreplace(on) + tension).holds
    assert vanishes(pendulum.multipliers[0].xreplace(on) - tension).fails
    assert vanishes(pendulum.accelerations[1].xreplace(on) + g * sp.sin(theta) / l).holds
    assert vanishes(pendulum.reactions[0].xreplace(on) + tension).holds


def test_hoop_rolling_down_an_incline():
    alpha = parameters("alpha")
    L = Lagrangian(M * x.dot**2 / 2 + M * r0**2 * theta.dot**2 / 2 + M * g * x * sp.sin(alpha), [x, theta])
    hoop = ConstrainedLagrangian(L, holonomic=[r0 * theta - x])
    assert vanishes(hoop.accelerations[0] - g * sp.sin(alpha) / 2).holds
    assert vanishes(hoop.multipliers[0] - M * g * sp.sin(alpha) / 2).holds
    assert vanishes(hoop.multipliers[0] + M * g * sp.sin(alpha) / 2).fails


def test_knife_edge_on_an_incline():
    alpha = parameters("alpha")
    L = Lagrangian(
        m * (x.dot**2 + y.dot**2) / 2 + J * theta.dot**2 / 2 + m * g * x * sp.sin(alpha), [x, y, theta]
    )
    s, c = sp.sin(theta), sp.cos(theta)
    blade = ConstrainedLagrangian(L, nonholonomic=[x.dot * s - y.dot * c])
    expected = -m * (theta.dot * (x.dot * c + y.dot * s) + g * sp.sin(alpha) * s)
    assert vanishes(blade.multipliers[0] - expected).holds
    assert vanishes(blade.accelerations[2]).holds
    lam = sp.Symbol("lam", real=True)
    found = dict(zip(map(acceleration, L.q), blade.accelerations, strict=True)) | {lam: blade.multipliers[0]}
    assert all(vanishes(e.xreplace(found)).holds for e in blade.equations([lam])[:3])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda L: ConstrainedLagrangian(L, holonomic=[x.dot]), "holds velocities"),
        (lambda L: ConstrainedLagrangian(L, nonholonomic=[x.dot**2 - y.dot]), "not affine"),
        (lambda L: ConstrainedLagrangian(L, holonomic=[x - y]).equations([]), "0 multipliers for 1"),
        (
            lambda L: ConstrainedLagrangian(L, holonomic=[x - y, 2 * x - 2 * y]).multipliers,
            "depend on one another",
        ),
    ],
)
def test_constraints_that_are_refused(make, words):
    with pytest.raises((ValueError, SingularMatrixError), match=words):
        make(Lagrangian((x.dot**2 + y.dot**2) / 2, [x, y]))


def test_generalized_forces_of_a_damper():
    d = parameters("d", positive=True)
    place = (l * sp.sin(theta), -l * sp.cos(theta))
    drag = [-d * time_derivative(s, [theta]) for s in place]
    assert vanishes(generalized_forces([drag], [place], [theta])[0] + d * l**2 * theta.dot).holds


def cart_pendulum():
    rod = (x + l * sp.sin(theta), l * sp.cos(theta))
    V = m * g * l * sp.cos(theta)
    v = [time_derivative(s, [x, theta]) for s in rod]
    L = Lagrangian(M * x.dot**2 / 2 + m * (v[0] ** 2 + v[1] ** 2) / 2 + J * theta.dot**2 / 2 - V, [x, theta])
    return L, GibbsAppell([Particle(M, (x,)), PlanarBody(m, rod, J, theta)], [x, theta], V)


def test_gibbs_appell_agrees_with_lagrange():
    L, appell = cart_pendulum()
    for ours, theirs in zip(appell.equations, L.equations, strict=True):
        assert vanishes(ours - theirs).holds
    without_gravity = GibbsAppell(appell.bodies, appell.q)
    assert vanishes(without_gravity.equations[1] - L.equations[1]).fails


def test_gibbs_appell_in_quasi_velocities_agrees_with_multipliers():
    """The knife edge with its forward speed u and its turning rate w."""
    u, w = sp.symbols("u w", real=True)
    alpha = parameters("alpha")
    V = -m * g * x * sp.sin(alpha)
    blade = GibbsAppell(
        [PlanarBody(m, (x, y), J, theta)],
        [x, y, theta],
        V,
        u=[u, w],
        q_dot=[u * sp.cos(theta), u * sp.sin(theta), w],
    )
    u_dot, w_dot = blade.quasi_accelerations
    assert vanishes(u_dot - g * sp.sin(alpha) * sp.cos(theta)).holds
    assert vanishes(w_dot).holds
    assert vanishes(u_dot + g * sp.sin(alpha) * sp.cos(theta)).fails
    assert blade.u_dot == (velocity(u), velocity(w))


def test_noether_charges_are_constant():
    px, py = x.momentum, y.momentum
    V = sp.Function("V")(x**2 + y**2)
    L = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 - V, [x, y])
    rotation = noether_charge(L, [-y, x])
    assert is_symmetry(L, [-y, x]).holds
    assert is_symmetry(L, [y, x]).fails
    assert is_constant_of_motion(rotation, L).holds
    assert is_constant_of_motion(rotation + x, L).fails
    assert is_symmetry(L, [0, 0], tau=sp.S.One).holds
    assert is_constant_of_motion(noether_charge(L, [0, 0], tau=sp.S.One), L).holds
    free = Lagrangian(m * x.dot**2 / 2, [x])
    assert is_symmetry(free, [time], K=m * x).holds
    assert is_constant_of_motion(noether_charge(free, [time], K=m * x), free).holds
    assert is_constant_of_motion(m * x.dot * time + m * x, free).fails
    assert (px, py) == (x.momentum, y.momentum)


def test_poissons_theorem_makes_new_integrals():
    z = coordinates("z")
    q, p = (x, y, z), (x.momentum, y.momentum, z.momentum)
    kepler = Hamiltonian(sum(s**2 for s in p) / 2 - k / sp.sqrt(x**2 + y**2 + z**2), q, p)
    Lx, Ly = y * p[2] - z * p[1], z * p[0] - x * p[2]
    bracket, verdict = poissons_theorem(Lx, Ly, kepler)
    assert vanishes(bracket - (x * p[1] - y * p[0])).holds
    assert verdict.holds
    assert poissons_theorem(Lx, x, kepler)[1].fails or vanishes(poissons_theorem(Lx, x, kepler)[0]).holds


def test_gauge_equivalence():
    L = Lagrangian(m * (x.dot**2 + y.dot**2) / 2, [x, y])
    F = x**2 * sp.sin(y) * time
    other = Lagrangian(L.L + time_derivative(F, [x, y]), [x, y])
    assert is_gauge_equivalent(L, other, F).holds
    assert is_gauge_equivalent(L, other, 2 * F).fails
    assert is_gauge_equivalent(L, other).holds
    assert vanishes(gauge_function(L, other) - F).holds
    magnetic = Lagrangian(L.L + k * (x * y.dot - y * x.dot), [x, y])
    assert is_gauge_equivalent(L, magnetic).fails
    assert have_same_equations(L, other).holds
    assert have_same_equations(L, magnetic).fails
    assert have_same_equations(L, Lagrangian(3 * L.L, [x, y])).holds
    assert is_gauge_equivalent(L, Lagrangian(3 * L.L, [x, y])).fails
    with pytest.raises(ValueError, match="different coordinates"):
        have_same_equations(L, Lagrangian(x.dot**2, [x]))
