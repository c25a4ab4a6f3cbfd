"""Constraints on velocities: Frobenius with integrals, multipliers against quasi-velocities, classical motions."""

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.expression.symbols.symbol import coordinates, parameters, time
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.constraint_system import is_integrable, positional_freedom
from canon.mechanics.lagrange.frobenius import integrals, pfaffian
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.lagrange.quasi_velocity import Kinematics, independent_velocities, maggi_accelerations
from canon.proof.domain.domain import Domain
from canon.proof.vanish import vanishes

m, g, l, R, I, J, I1, I2, a, k, w = parameters("m g l R I J I1 I2 a k w", positive=True)
alpha = parameters("alpha")
x, y, z, theta, phi, psi = coordinates("x y z theta phi psi")
sin, cos, tan = sp.sin, sp.cos, sp.tan


def hollow_cylinder():
    """The notes give the rolling condition on velocities, R θ̇ − ẋ = 0, x down the slope."""
    L = Lagrangian(m * x.dot**2 / 2 + m * R**2 * theta.dot**2 / 2 + m * g * x * sin(phi), [x, theta])
    return ConstrainedLagrangian(L, nonholonomic=[R * theta.dot - x.dot])


def test_the_rolling_condition_of_the_hollow_cylinder_is_holonomic_in_disguise():
    rolling = hollow_cylinder()
    assert is_integrable(rolling).holds
    (f,) = integrals(rolling)
    assert vanishes(f - (R * theta - x)).holds
    disguised = ConstrainedLagrangian(rolling.lagrangian, holonomic=[f])
    for one, other in zip(rolling.accelerations, disguised.accelerations, strict=True):
        assert vanishes(one - other).holds
    assert vanishes(rolling.accelerations[0] - g * sin(phi) / 2).holds
    assert vanishes(rolling.multipliers[0] - m * g * sin(phi) / 2).holds
    assert vanishes(rolling.multipliers[0] - m * R * rolling.accelerations[1]).holds


def unicycle():
    L = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 + J * theta.dot**2 / 2, [x, y, theta])
    return ConstrainedLagrangian(L, nonholonomic=[y.dot - x.dot * tan(theta)])


def knife_edge():
    L = Lagrangian(
        m * (x.dot**2 + y.dot**2) / 2 + J * theta.dot**2 / 2 + m * g * x * sin(alpha), [x, y, theta]
    )
    return ConstrainedLagrangian(L, nonholonomic=[x.dot * sin(theta) - y.dot * cos(theta)])


def chaplygin_sleigh():
    """Blade at (x, y), centre of mass a ahead of it."""
    vx, vy = x.dot - a * sin(theta) * theta.dot, y.dot + a * cos(theta) * theta.dot
    L = Lagrangian(m * (vx**2 + vy**2) / 2 + J * theta.dot**2 / 2, [x, y, theta])
    return ConstrainedLagrangian(L, nonholonomic=[x.dot * sin(theta) - y.dot * cos(theta)])


def rolling_disc():
    """A vertical disc that rolls and steers: heading φ, roll angle ψ."""
    L = Lagrangian(
        m * (x.dot**2 + y.dot**2) / 2 + I1 * psi.dot**2 / 2 + I2 * phi.dot**2 / 2, [x, y, phi, psi]
    )
    return ConstrainedLagrangian(
        L, nonholonomic=[x.dot - R * cos(phi) * psi.dot, y.dot - R * sin(phi) * psi.dot]
    )


def snakeboard():
    """Centre (x, y), heading θ, rotor ψ, wheels turned by φ and −φ at distance l (Ostrowski et al. 1994)."""
    L = Lagrangian(
        m * (x.dot**2 + y.dot**2) / 2
        + m * l**2 * theta.dot**2 / 2
        + J * psi.dot**2 / 2
        + J * psi.dot * theta.dot
        + I * phi.dot**2,
        [x, y, theta, psi, phi],
    )
    front = -sin(theta + phi) * x.dot + cos(theta + phi) * y.dot + l * cos(phi) * theta.dot
    back = -sin(theta - phi) * x.dot + cos(theta - phi) * y.dot - l * cos(phi) * theta.dot
    return ConstrainedLagrangian(L, nonholonomic=[front, back])


NONHOLONOMIC = [unicycle, knife_edge, chaplygin_sleigh, rolling_disc, snakeboard]


@pytest.mark.parametrize("system", NONHOLONOMIC)
def test_truly_nonholonomic(system):
    constrained = system()
    verdict = is_integrable(constrained)
    assert verdict.fails
    assert verdict.counterexample is not None
    assert integrals(constrained) == ()
    assert pfaffian(constrained).holonomic_part.forms == ()
    rank = len(constrained.nonholonomic)
    assert constrained.degrees_of_freedom == len(constrained.lagrangian.q) - rank


@pytest.mark.parametrize("system", NONHOLONOMIC)
def test_nonholonomic_quasi_velocities_agree_with_multipliers(system):
    constrained = system()
    kin = independent_velocities(constrained)
    u_dot = dict(zip(kin.u_dot, maggi_accelerations(constrained.lagrangian, kin), strict=True))
    for by_multipliers, f in zip(constrained.accelerations, kin.q_ddot, strict=True):
        assert vanishes(by_multipliers.xreplace(dict(kin.through)) - f.xreplace(u_dot)).holds
    twin = independent_velocities(constrained)
    off = {n: 2 * value + 1 for n, value in u_dot.items()}
    gaps = [
        one.xreplace(dict(twin.through)) - f.xreplace(off)
        for one, f in zip(constrained.accelerations, twin.q_ddot, strict=True)
    ]
    assert any(vanishes(gap).fails for gap in gaps)


def test_chaplygin_sleigh_in_its_own_quasi_velocities():
    """u̇ = a ω², (J + m a²) ω̇ = −m a u ω (S. A. Chaplygin 1911)."""
    u, n = sp.symbols("u omega", real=True)
    constrained = chaplygin_sleigh()
    kin = Kinematics([x, y, theta], [u, n], [u * cos(theta), u * sin(theta), n])
    assert kin.satisfy(constrained).holds
    assert Kinematics([x, y, theta], [u, n], [u * sin(theta), u * cos(theta), n]).satisfy(constrained).fails
    u_dot, n_dot = maggi_accelerations(constrained.lagrangian, kin)
    assert vanishes(u_dot - a * n**2).holds
    assert vanishes(n_dot + m * a * u * n / (J + m * a**2)).holds
    assert vanishes(n_dot - m * a * u * n / (J + m * a**2)).fails


def test_rolling_disc_rolls_straight_on():
    constrained = rolling_disc()
    assert vanishes(constrained.accelerations[2]).holds
    on = {x.dot: R * cos(phi) * psi.dot, y.dot: R * sin(phi) * psi.dot}
    assert vanishes(constrained.accelerations[3].xreplace(on)).holds
    sideways = constrained.multipliers[0] * -sin(phi) + constrained.multipliers[1] * cos(phi)
    assert vanishes(sideways.xreplace(on) - m * R * psi.dot * phi.dot).holds
    assert vanishes(sideways.xreplace(on) + m * R * psi.dot * phi.dot).fails


def test_part_of_the_constraints_may_be_holonomic():
    """A straight rolling wheel beside a blade: one combination restricts positions."""
    L = Lagrangian(sum(c.dot**2 for c in (x, y, theta, z, psi)) / 2, [x, y, theta, z, psi])
    blade = x.dot * sin(theta) - y.dot * cos(theta)
    mixed = ConstrainedLagrangian(L, nonholonomic=[blade + z.dot - R * psi.dot, z.dot - R * psi.dot])
    assert is_integrable(mixed).fails
    assert len(pfaffian(mixed).holonomic_part.forms) == 1
    (f,) = integrals(mixed)
    assert vanishes(f.diff(z) * R + f.diff(psi)).holds
    assert not f.has(theta, x, y)


@pytest.mark.parametrize(
    ("form", "keeps"),
    [
        (y * x.dot + x * y.dot, x * y),
        (x * y.dot - y * x.dot, y / x),
        (cos(theta) * x.dot - x * sin(theta) * theta.dot, x * cos(theta)),
        (x.dot - w * x, sp.log(x) - w * time),
        (2 * x * x.dot + z.dot - k * sin(time), x**2 + z + k * cos(time)),
    ],
)
def test_integrals_of_integrable_forms(form, keeps):
    domain = Domain((x > 0, y > 0, theta > 0, theta < 1))
    L = Lagrangian(x.dot**2 + y.dot**2 + z.dot**2 + theta.dot**2, [x, y, z, theta])
    constrained = ConstrainedLagrangian(L, nonholonomic=[form])
    assert is_integrable(constrained, domain).holds
    (found,) = integrals(constrained, domain)
    places = (x, y, z, theta, time)
    for i, c in enumerate(places):
        for d in places[:i]:
            assert vanishes(found.diff(c) * keeps.diff(d) - found.diff(d) * keeps.diff(c), domain).holds


def test_a_form_that_depends_on_time_may_be_nonholonomic():
    L = Lagrangian(x.dot**2 + y.dot**2, [x, y])
    turning = ConstrainedLagrangian(L, nonholonomic=[x.dot * sin(w * time) - y.dot * cos(w * time)])
    assert is_integrable(turning).fails
    assert integrals(turning) == ()


def test_positions_that_can_be_reached():
    assert positional_freedom(unicycle()) == 3
    assert positional_freedom(hollow_cylinder()) == 1
    assert positional_freedom(rolling_disc()) == 4
    ring = Lagrangian(x.dot**2 + y.dot**2, [x, y])
    assert positional_freedom(ConstrainedLagrangian(ring, holonomic=[x**2 + y**2 - R**2])) == 1


def test_constraints_are_integrable_where_the_positions_are_that_other_constraints_allow():
    """ẋ = z ẏ turns by dz ∧ dy; on z = 0 it is ẋ = 0, on z = t it is not integrable, and dz = dt counts."""
    L = Lagrangian((x.dot**2 + y.dot**2 + theta.dot**2) / 2, [x, y, theta])
    rolling = x.dot - theta * y.dot
    assert is_integrable(ConstrainedLagrangian(L, nonholonomic=[rolling])).fails
    on_a_place = ConstrainedLagrangian(L, holonomic=[theta], nonholonomic=[rolling])
    assert is_integrable(on_a_place).holds
    assert positional_freedom(on_a_place) == 1
    assert is_integrable(ConstrainedLagrangian(L, holonomic=[theta - time], nonholonomic=[rolling])).fails


def test_every_branch_of_a_constraint_is_looked_at():
    """θ² = 1 has the branches θ = 1 and θ = −1: ẋ = (θ − 1) ẏ is integrable on both, ẋ = φ (θ − 1) ẏ on one only."""
    q = [x, y, theta, phi]
    L = Lagrangian(sum(s.dot**2 for s in q) / 2, q)
    flat = ConstrainedLagrangian(L, holonomic=[theta**2 - 1], nonholonomic=[x.dot - (theta - 1) * y.dot])
    bent = ConstrainedLagrangian(
        L, holonomic=[theta**2 - 1], nonholonomic=[x.dot - phi * (theta - 1) * y.dot]
    )
    assert is_integrable(flat).holds
    assert is_integrable(bent).fails


@settings(max_examples=50, deadline=None)
@given(st.lists(st.integers(-2, 2), min_size=6, max_size=6))
def test_frobenius_agrees_with_the_wedge_product(n):
    """One form in three variables is integrable exactly where ω ∧ dω = 0, a second route without branches."""
    z = (x, y, theta)
    form = [1 + n[0] * y + n[1] * theta**2, n[2] * x + n[3] * theta * y, 2 + n[4] * x * y + n[5] * y**2]
    L = Lagrangian(sum(s.dot**2 for s in z) / 2, z)
    found = is_integrable(
        ConstrainedLagrangian(L, nonholonomic=[sum(a * s.dot for a, s in zip(form, z, strict=True))])
    )
    curl = [form[(k + 2) % 3].diff(z[(k + 1) % 3]) - form[(k + 1) % 3].diff(z[(k + 2) % 3]) for k in range(3)]
    wedge = sp.expand(sum(a * c for a, c in zip(map(sp.sympify, form), curl, strict=True)))
    assert found.holds if wedge == 0 else found.fails


def free_with(q, *rates):
    return ConstrainedLagrangian(Lagrangian(sum(s.dot**2 for s in q) / 2, q), nonholonomic=rates)


@pytest.mark.parametrize(
    ("q", "rates", "keeps"),
    [
        ((x,), [x.dot], [x]),
        ((x, y), [x.dot - y.dot, y.dot - x * y.dot], [x, y]),
        ((x, y, z), [x.dot - y.dot, z.dot + z * x * (x.dot - y.dot)], [x - y, z]),
        ((x, y, z, theta), [x.dot - y.dot, x.dot - y.dot + z.dot - theta.dot], [x - y, z - theta]),
        ((z, x, y), [x.dot * y - x * y.dot], [x / y]),
        ((x, y), [x.dot * y**2 - x * y.dot], [sp.log(x) + 1 / y]),
        ((x, y), [(x + y) * x.dot - y.dot], [(x + y + 1) * sp.exp(-x)]),
    ],
)
def test_integrals_span_the_differentials_of_what_is_kept(q, rates, keeps):
    """The second form of the third is closed by no factor, and its integral stands in a combination of both."""
    found = integrals(free_with(q, *rates))
    assert len(found) == len(keeps)

    def rank(functions):
        return sp.Matrix([[f.diff(s) for s in (*q, time)] for f in functions]).rank(simplify=True)

    assert rank(found) == len(keeps)
    assert rank([*found, *keeps]) == len(keeps)
    assert rank([*found, q[-1] ** 2 * time]) == len(keeps) + 1


def test_integrals_without_a_closed_form_that_is_looked_for_are_not_made_up():
    """(x + y) e⁻ᵗ and (x − y) eᵗ are kept: both positions are restricted, though no function is returned."""
    constrained = free_with((x, y), x.dot - y, y.dot - x)
    assert is_integrable(constrained).holds
    assert positional_freedom(constrained) == 0
    assert integrals(constrained) == ()
