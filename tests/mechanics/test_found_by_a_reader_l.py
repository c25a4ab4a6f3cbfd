"""What a reader found in canon.mechanics.lagrange, reduction and at_scale: each case, and its right neighbour."""

from __future__ import annotations

import pytest
import sympy as sp
from sympy import cos

from canon import Lagrangian, coordinates, parameters
from canon.mechanics.at_scale.first_order import canonical_derivation
from canon.mechanics.at_scale.second_order import derivation
from canon.mechanics.hamilton.legendre_pair import (
    LegendreError,
    hamiltonian,
    has_hamiltonian,
    is_hamiltonian_of,
)
from canon.mechanics.hamilton.symmetry import is_constant_of_motion, is_symmetry, noether_charge
from canon.mechanics.lagrange.appell import GibbsAppell
from canon.mechanics.lagrange.body import (
    Particle,
    PlanarBody,
    RigidBody,
    euler_rotation,
    is_scleronomic,
    kinetic_form,
)
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.dependence import DependentConstraintsError
from canon.mechanics.lagrange.force import charge_term, lagrangian_of_bodies, magnetic_field
from canon.mechanics.lagrange.newton_euler import Load, NewtonEuler, weights
from canon.mechanics.lagrange.quasi_velocity import Kinematics, maggi_equations
from canon.mechanics.lagrange.unilateral import UnilateralLagrangian
from canon.mechanics.reduction.contact import multiplier_along, multiplier_in_contact
from canon.mechanics.reduction.eliminate_constraints import eliminated
from canon.mechanics.reduction.ignorable import adapted, ignorable_coordinates, ignorable_directions
from canon.mechanics.reduction.routh import routhian
from canon.mechanics.reduction.singular import singularity
from canon.proof.domain.domain import Domain

x, y, r, theta, phi = coordinates("x y r theta phi")
m, g, c, a, B, k = parameters("m g c a B k", positive=True)
u, w = sp.symbols("u w", real=True)


class TestForcesByCoordinate:
    """The keys of a mapping say which coordinate a force is of; they were read as the forces."""

    bodies = (Particle(m, (x, y)),)

    def test_of_bodies(self) -> None:
        damped = lagrangian_of_bodies(self.bodies, [x, y], forces={y: -c * y.dot})
        assert damped.equations == (m * x.ddot, c * y.dot + m * y.ddot)

    def test_of_gibbs_and_appell(self) -> None:
        damped = GibbsAppell(self.bodies, [x, y], forces={y: -c * y.dot})
        assert damped.equations == (m * x.ddot, c * y.dot + m * y.ddot)

    @pytest.mark.parametrize("forces", [{y: -c * y.dot}, [0, -c * y.dot]])
    def test_at_scale(self, forces: object) -> None:
        d = derivation(self.bodies, [x, y], forces=forces)
        assert [d.graph.to_sympy(node) for node in d.f] == [0, -c * y.dot]
        h = canonical_derivation(self.bodies, [x, y], forces=forces)
        assert [h.graph.to_sympy(node) for node in h.p_dot] == [0, -c * y.dot]

    @pytest.mark.parametrize("of", [lagrangian_of_bodies, GibbsAppell, derivation, canonical_derivation])
    def test_others_are_refused_in_words(self, of: object) -> None:
        with pytest.raises(ValueError, match="forces are given for r; the coordinates are x, y"):
            of(self.bodies, [x, y], forces={r: 1})
        with pytest.raises(ValueError, match="1 generalized force for 2 coordinates"):
            of(self.bodies, [x, y], forces=[1])


class TestPotentialsWithVelocities:
    """d/dt ∂V/∂q̇ is half of Lorentz's force."""

    bodies = (Particle(m, (x, y)),)
    V = -B * x * y.dot

    def test_of_gibbs_and_appell(self) -> None:
        lorentz = (m * x.ddot - B * y.dot, m * y.ddot + B * x.dot)
        assert lagrangian_of_bodies(self.bodies, [x, y], self.V).equations == lorentz
        assert GibbsAppell(self.bodies, [x, y], self.V).equations == lorentz

    def test_in_quasi_velocities(self) -> None:
        q_dot = [u * cos(theta), u * sp.sin(theta), w]
        blade = GibbsAppell([Particle(m, (x, y))], [x, y, theta], self.V, [u, w], q_dot)
        assert sp.expand(blade.forces[0]).trigsimp() == 0  # the magnetic force does no work
        kept = GibbsAppell([Particle(m, (x, y))], [x, y, theta], m * g * y, [u, w], q_dot)
        assert kept.forces == (-g * m * sp.sin(theta), 0)

    def test_at_scale(self) -> None:
        d = derivation(self.bodies, [x, y], self.V)
        assert [d.graph.to_sympy(node) for node in d.f] == [B * y.dot, -B * x.dot]
        h = canonical_derivation(self.bodies, [x, y], self.V + k * x**2)
        assert [h.graph.to_sympy(node) for node in h.drift] == [0, B * x]
        assert [h.graph.to_sympy(node) for node in h.p_dot] == [B * y.dot - 2 * k * x, 0]
        px, py = h.p
        right = px**2 / (2 * m) + (py - B * x) ** 2 / (2 * m) + k * x**2
        assert sp.expand(h.graph.to_sympy(h.hamiltonian) - right) == 0

    def test_in_the_time(self) -> None:
        t = sp.Symbol("tau", real=True)
        d = derivation([Particle(m, (x,))], [x], t * x.dot, t=t)
        assert d.graph.to_sympy(d.f[0]) == 1
        assert GibbsAppell([Particle(m, (x,))], [x], t * x.dot, t=t).equations == (m * x.ddot - 1,)

    @pytest.mark.parametrize("of", [derivation, canonical_derivation])
    def test_others_are_refused(self, of: object) -> None:
        with pytest.raises(ValueError, match="not affine in the velocities"):
            of([Particle(m, (x,))], [x], a * x.dot**2)


class TestSlopesInPieces:
    """Slopes in pieces may be constant and differ; L was taken for quadratic with the slopes at rest."""

    dented = sp.Piecewise((x.dot**2 / 2 + x.dot, x.dot > 0), (x.dot**2 / 2, True))

    def test_no_hamiltonian_at_rest_for_all_velocities(self) -> None:
        with pytest.raises(LegendreError, match="closed form"):
            hamiltonian(Lagrangian(self.dented, [x]))
        with pytest.raises(LegendreError, match="closed form"):
            routhian(Lagrangian(self.dented + y.dot**2 / 2 - y**2, [x, y]), [x])
        with pytest.raises(ValueError, match="not quadratic"):
            kinetic_form(self.dented, [x])

    def test_pieces_of_the_place_do_no_harm(self) -> None:
        step = sp.Piecewise((x.dot**2 / 2 - 1, x > 0), (x.dot**2 / 2, True))
        H = hamiltonian(Lagrangian(step, [x]))
        assert H.H.subs({x: 1, x.momentum: 2}) == 3
        assert H.H.subs({x: -1, x.momentum: 2}) == 2
        assert kinetic_form(sp.Piecewise((m, x > 0), (k, True)) * x.dot**2 / 2, [x]).b == (0,)

    def test_reactions_in_pieces(self) -> None:
        N = sp.Symbol("N", real=True)
        body = Particle(m, (x, sp.S.Zero))
        kinked = Load(0, (sp.Piecewise((-N, N > 0), (-N - 1, True)), N))
        with pytest.raises(ValueError, match="not linear in the reactions"):
            _ = NewtonEuler([body], [x], [*weights([body], (0, -g)), kinked], [N]).solution
        rubbed = Load(0, (-c * N, N))
        assert NewtonEuler([body], [x], [*weights([body], (0, -g)), rubbed], [N]).solution == (-c * g, g * m)

    def test_eliminated(self) -> None:
        L = Lagrangian((x.dot**2 + y.dot**2) / 2, [x, y])
        stepped = y + sp.Piecewise((1, y > 0), (0, True)) - x
        with pytest.raises(ValueError, match="not affine in y"):
            eliminated(ConstrainedLagrangian(L, holonomic=[stepped]), [y])
        assert eliminated(ConstrainedLagrangian(L, holonomic=[2 * y - x]), [y])[1] == {y: x / 2}


class TestMaggi:
    """Rows belong to coordinates, whatever their order."""

    L = Lagrangian((x.dot**2 + y.dot**2) / 2 - x, [x, y])

    def test_another_order(self) -> None:
        same = [Kinematics([x, y], [u], [2 * u, u]), Kinematics([y, x], [u], [u, 2 * u])]
        u_dot = same[0].u_dot[0]
        assert [sp.expand(maggi_equations(self.L, one)[0]) for one in same] == [5 * u_dot + 2] * 2

    def test_other_coordinates(self) -> None:
        with pytest.raises(ValueError, match="of the coordinates"):
            maggi_equations(self.L, Kinematics([x, r], [u], [2 * u, u]))
        bound = ConstrainedLagrangian(self.L, nonholonomic=[x.dot - 2 * y.dot])
        assert Kinematics([y, x], [u], [u, 2 * u]).satisfy(bound).holds
        with pytest.raises(ValueError, match="of the coordinates"):
            Kinematics([x, r], [u], [2 * u, u]).satisfy(bound)


class TestKinematics:
    """What is no quasi-velocity counted as constant, and doubled names twice."""

    def test_rates_through_rates(self) -> None:
        with pytest.raises(ValueError, match="holds x_dot, which is no quasi-velocity"):
            Kinematics([x, y, theta], [u, w], [u * cos(theta), x.dot * sp.tan(theta), w])
        kept = Kinematics([x, y], [x.dot], [x.dot, x.dot * sp.tan(x)])
        assert kept.q_ddot[0] == x.ddot

    def test_doubles(self) -> None:
        with pytest.raises(ValueError, match=r"coordinates .* not all different"):
            GibbsAppell([Particle(1, (x, y))], [x, x])
        with pytest.raises(ValueError, match=r"quasi-velocities .* not all different"):
            Kinematics([x, y], [x.dot, x.dot], [x.dot, x.dot])


class TestForcesWithAccelerations:
    """Forces of added mass hold accelerations, also of coordinates that are eliminated."""

    def test_routhian(self) -> None:
        L = m * (x.dot**2 + phi.dot**2) / 2 + c * x.dot * phi.dot - x**2 / 2
        R = routhian(Lagrangian(L, [x, phi], [-a * phi.ddot, 0]), [phi])
        assert sp.expand(R.forces[0] - a * c * x.ddot / m) == 0  # φ̈ = −(c/m) ẍ at constant p
        assert routhian(Lagrangian(L, [x, phi], [-a * x.ddot, 0]), [phi]).forces == (-a * x.ddot,)

    def test_adapted(self) -> None:
        L = Lagrangian((x.dot**2 + y.dot**2) / 2 - k * (x - y) ** 2 / 2, [x, y], [a * y.ddot, -a * y.ddot])
        pair = adapted(L)
        assert not pair.lagrangian.forces[0].has(x.ddot, y.ddot) or y in pair.lagrangian.q
        new = pair.lagrangian.q
        assert all(force.free_symbols <= {a, *(s.ddot for s in new)} for force in pair.lagrangian.forces)
        (old_x, old_y) = L.accelerations
        found = dict(zip(new, pair.lagrangian.accelerations, strict=True))
        (rel,) = (s for s in new if s not in pair.ignorable)
        (kept,) = pair.ignorable
        there = {rel: (y - x) if kept == x else (x - y)}
        first, second = (old_x, old_y) if kept == x else (old_y, old_x)
        assert sp.cancel(found[kept].subs(there) - first) == 0
        assert sp.cancel(found[rel].subs(there) + first - second) == 0


class TestForcesWithoutPotential:
    """Neither Hamilton's equations nor Noether's theorem may forget them."""

    damped = Lagrangian(x.dot**2 / 2 - x**2 / 2, [x], [-c * x.dot])

    def test_no_hamiltonian(self) -> None:
        H = x.momentum**2 / 2 + x**2 / 2
        with pytest.raises(LegendreError, match="forces without a potential"):
            is_hamiltonian_of(self.damped, H, [x.momentum])
        with pytest.raises(LegendreError, match="forces without a potential"):
            has_hamiltonian(self.damped)
        free = Lagrangian(self.damped.L, [x])
        assert is_hamiltonian_of(free, H, [x.momentum]).holds
        assert has_hamiltonian(free).holds

    def test_symmetry(self) -> None:
        rubbed = Lagrangian(x.dot**2 / 2, [x], [-c * x.dot])
        assert is_symmetry(rubbed, [1]).fails
        assert is_symmetry(rubbed, [1], K=-c * x).holds
        assert is_constant_of_motion(noether_charge(rubbed, [1], K=-c * x), rubbed).holds
        assert is_symmetry(rubbed, [0], 1).fails
        turned = Lagrangian((x.dot**2 + y.dot**2) / 2, [x, y], [-y.dot, x.dot])  # a force that does no work
        assert is_symmetry(turned, [0, 0], 1).holds


class TestMultiplierAlong:
    """λ in s̈² needs the whole polynomial."""

    def sphere(self, force: sp.Expr) -> ConstrainedLagrangian:
        L = m * (r.dot**2 + r**2 * theta.dot**2) / 2 - m * g * r * cos(theta)
        return ConstrainedLagrangian(Lagrangian(L, [r, theta], [force, 0]), holonomic=[r - a])

    def test_of_degree_four(self) -> None:
        found = multiplier_along(self.sphere(c * theta.dot**4), {r: a}, theta, sp.S.Zero)
        square = 2 * g * (1 - cos(theta)) / a
        assert sp.expand(found - (m * g * cos(theta) - m * a * square - c * square**2)) == 0
        plainly = multiplier_along(self.sphere(sp.S.Zero), {r: a}, theta, sp.S.Zero)
        assert sp.expand(plainly - m * g * (3 * cos(theta) - 2)) == 0

    def test_no_polynomial(self) -> None:
        with pytest.raises(ValueError, match="no polynomial in theta_dot"):
            multiplier_along(self.sphere(c * abs(theta.dot)), {r: a}, theta, sp.S.Zero)


def test_a_given_rate_of_turning_is_rheonomic() -> None:
    assert is_scleronomic([PlanarBody(1, (x, 0), 1, omega=w)], [x]).fails
    assert is_scleronomic([PlanarBody(1, (x, 0), 1, omega=x.dot * cos(y))], [x]).holds
    assert is_scleronomic([RigidBody(1, (), (1, 1, 2), omega=(theta.dot, 0, w))], [theta]).fails
    assert is_scleronomic([RigidBody(1, (), (1, 1, 2), omega=(theta.dot, 0, 0))]).holds
    assert is_scleronomic([RigidBody(1, (), (1, 1, 2), euler_rotation(phi, 0, 0))]).holds


class TestWords:
    """What ended in errors of Python's or was passed over is refused in words."""

    def test_contacts_are_counted_from_1(self) -> None:
        U = UnilateralLagrangian(Lagrangian((x.dot**2 + y.dot**2) / 2 - g * y, [x, y]), [y, x])
        for wrong in (0, 3, -1):
            with pytest.raises(ValueError, match=f"no contact has the number {wrong}; there are 2"):
                U.closed(wrong)
        assert U.closed(1, 2).holonomic == (y, x)

    def test_constraints_are_counted_from_0(self) -> None:
        bound = ConstrainedLagrangian(Lagrangian((x.dot**2 + y.dot**2) / 2 - g * y, [x, y]), holonomic=[y])
        for wrong in (-1, 1):
            with pytest.raises(ValueError, match=f"no constraint has the number {wrong}"):
                multiplier_in_contact(bound, {y: sp.S.Zero}, (x,), wrong)
        assert multiplier_in_contact(bound, {y: sp.S.Zero}, (x,)) == g

    def test_torques(self) -> None:
        with pytest.raises(ValueError, match="a particle, which does not turn"):
            NewtonEuler([Particle(1, (x, y))], [x, y], [Load(0, (0, -1), torque=5)])
        plate = PlanarBody(1, (x, y), 1, angle=theta)
        with pytest.raises(ValueError, match="torque of 3 components on body 0, which turns about 1 axis"):
            NewtonEuler([plate], [x, y, theta], [Load(0, torque=(0, 0, 5))])
        at_a_point = NewtonEuler([plate], [x, y, theta], [Load(0, at=(0, 0), torque=5)])
        assert at_a_point.balances == (x.ddot, y.ddot, theta.ddot - 5)
        with pytest.raises(ValueError, match="force at a point of 3 components"):
            NewtonEuler([plate], [x, y, theta], [Load(0, (1, 0), at=(0, 0, 0))])

    def test_potentials_of_fields(self) -> None:
        with pytest.raises(ValueError, match="2 components of A and 2 coordinates"):
            magnetic_field((0, B * x), [x, y])
        assert magnetic_field((0, B * x, 0), [x, y, r]) == (0, 0, B)
        with pytest.raises(ValueError, match="A has 1 component at a position of 2"):
            charge_term(c, (x, y), [x, y], A=(0,))

    def test_quadrature(self) -> None:
        R = routhian(Lagrangian(m * (r.dot**2 + r**2 * phi.dot**2) / 2, [r, phi]))
        with pytest.raises(ValueError, match="no motion is given of r"):
            R.quadrature({}, {phi: sp.S.Zero})
        with pytest.raises(ValueError, match="no start is given of phi"):
            R.quadrature({r: 1 + R.t}, {})
        assert R.quadrature({r: sp.S.One}, {phi: sp.S.Zero}) == (phi.momentum * R.t / m,)


class TestStepsAreNotIgnored:
    """The slope of a step vanishes on both of its sides, and L has two values all the same."""

    def test_ignorable(self) -> None:
        kinetic = phi.dot**2 / 2 + x.dot**2 / 2
        stepped = Lagrangian(kinetic - x * sp.sign(phi), [x, phi])
        assert ignorable_coordinates(stepped) == ()
        with pytest.raises(ValueError, match="phi is not ignorable"):
            routhian(stepped, [phi])
        assert ignorable_coordinates(stepped, Domain((phi > 0,))) == (phi,)
        hidden = Lagrangian(kinetic - x**2 * (sp.sin(phi) ** 2 + cos(phi) ** 2), [x, phi])
        assert ignorable_coordinates(hidden) == (phi,)

    def test_directions(self) -> None:
        kinetic = (x.dot**2 + y.dot**2) / 2
        assert (1, 0) not in ignorable_directions(Lagrangian(kinetic - y * sp.sign(x), [x, y]))
        assert ignorable_directions(Lagrangian(kinetic - abs(x - y), [x, y])) == ((1, 1),)


def test_null_directions_beside_forces_with_accelerations() -> None:
    with pytest.raises(ValueError, match="forces hold accelerations"):
        singularity(Lagrangian(x.dot**2 / 2, [x, y], [0, -c * y.ddot - y]))
    found = singularity(Lagrangian(x.dot**2 / 2, [x, y], [0, -y]))
    assert found.motion_constraints == (y,)


def test_a_constraint_that_follows_from_a_factor_of_it() -> None:
    """The two gradients are parallel where both constraints hold, and nowhere else."""
    L = Lagrangian((x.dot**2 + y.dot**2) / 2, [x, y])
    for first in (x - y, y - x, m * (x - y)):
        with pytest.raises(
            DependentConstraintsError, match=r"constraint 2 .* follows from constraint 1"
        ) as caught:
            _ = ConstrainedLagrangian(L, holonomic=[first, (x - y) * (x + 2)]).degrees_of_freedom
        assert caught.value.rows == (1, 2)
    assert ConstrainedLagrangian(L, holonomic=[m * (x - y), m * (x + 2)]).degrees_of_freedom == 0
    assert ConstrainedLagrangian(L, holonomic=[(x - y) * (x + 2)]).degrees_of_freedom == 1
