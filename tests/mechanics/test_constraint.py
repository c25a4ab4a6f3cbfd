"""Constraints: multipliers, elimination and quasi-velocities agree; contacts; refusals that name the rows."""

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.expression.symbols.symbol import acceleration, coordinates, parameters, time, velocity
from canon.mechanics.algebra.all_vanish import differ
from canon.mechanics.algebra.constraint_manifold import on_manifold, transported
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.dependence import DependentConstraintsError
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.lagrange.quasi_velocity import Kinematics, independent_velocities, maggi_accelerations
from canon.mechanics.reduction.contact import multiplier_along, multiplier_in_contact
from canon.mechanics.reduction.eliminate_constraints import eliminated, embedded, satisfies
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Undecided
from canon.proof.equivalence import equivalent_equations
from canon.proof.vanish import vanishes

m, g, l, R, I, J, I1, I2, a, b, k, w = parameters("m g l R I J I1 I2 a b k w", positive=True)
alpha = parameters("alpha")
x, y, z, s, theta, phi, psi, q1, q2, q3 = coordinates("x y z s theta phi psi q1 q2 q3")
r = coordinates("r", positive=True)
sin, cos, tan = sp.sin, sp.cos, sp.tan


def incline_roller():
    """The notes' body rolling on an incline, s up the slope."""
    L = Lagrangian(m * s.dot**2 / 2 + I * theta.dot**2 / 2 - m * g * s * sin(alpha), [s, theta])
    return ConstrainedLagrangian(L, holonomic=[R * theta - s]), {theta: s / R}, [s]


def pendulum():
    L = Lagrangian(m * (r.dot**2 + r**2 * theta.dot**2) / 2 + m * g * r * cos(theta), [r, theta])
    return ConstrainedLagrangian(L, holonomic=[r - l]), {r: l}, [theta]


def cartesian_pendulum():
    L = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 + m * g * y, [x, y])
    return (
        ConstrainedLagrangian(L, holonomic=[(x**2 + y**2 - l**2) / 2]),
        {x: l * sin(theta), y: l * cos(theta)},
        [theta],
    )


def bead_on_a_turning_parabola():
    """The notes' rheonomic wire x = ζ cos ωt, y = ζ sin ωt, z = ζ²."""
    L = Lagrangian(m * (x.dot**2 + y.dot**2 + z.dot**2) / 2 - m * g * z, [x, y, z])
    wire = [x * sin(w * time) - y * cos(w * time), z - x**2 - y**2]
    return (
        ConstrainedLagrangian(L, holonomic=wire),
        {x: s * cos(w * time), y: s * sin(w * time), z: s**2},
        [s],
    )


def atwood():
    L = Lagrangian(m * x.dot**2 / 2 + k * y.dot**2 / 2 + m * g * x + k * g * y, [x, y])
    return ConstrainedLagrangian(L, holonomic=[x + y - l]), {y: l - x}, [x]


def spherical_chain():
    """Two rods in space, Cartesian coordinates of the lower bob bound to the upper, in a vertical plane."""
    u, v = coordinates("u v")
    L = Lagrangian(m * (x.dot**2 + y.dot**2 + u.dot**2 + v.dot**2) / 2 + m * g * (y + v), [x, y, u, v])
    rods = [x**2 + y**2 - l**2, (u - x) ** 2 + (v - y) ** 2 - a**2]
    places = {
        x: l * sin(theta),
        y: l * cos(theta),
        u: l * sin(theta) + a * sin(phi),
        v: l * cos(theta) + a * cos(phi),
    }
    return ConstrainedLagrangian(L, holonomic=rods), places, [theta, phi]


HOLONOMIC = [
    incline_roller,
    pendulum,
    cartesian_pendulum,
    bead_on_a_turning_parabola,
    atwood,
    spherical_chain,
]


def in_new_coordinates(constrained, places, q):
    """Accelerations by multipliers as functions of the new coordinates, and their kinematics."""
    t = constrained.lagrangian.t
    kin = Kinematics(q, t=t)
    whole = {c: sp.sympify(places.get(c, c)) for c in constrained.lagrangian.q}
    rates = {velocity(c): kin.rate(e) for c, e in whole.items()}
    second = {c: kin.rate(kin.rate(e)) for c, e in whole.items()}
    by_multipliers = [f.xreplace({**whole, **rates}) for f in constrained.accelerations]
    return by_multipliers, [second[c] for c in constrained.lagrangian.q]


@pytest.mark.parametrize("system", HOLONOMIC)
def test_elimination_agrees_with_multipliers(system):
    constrained, places, q = system()
    assert satisfies(constrained, places, q).holds
    reduced = embedded(constrained.lagrangian, places, q)
    solved = {acceleration(c): f for c, f in zip(q, reduced.accelerations, strict=True)}
    for by_multipliers, by_elimination in zip(*in_new_coordinates(constrained, places, q), strict=True):
        assert vanishes(by_multipliers - by_elimination.xreplace(solved)).holds


@pytest.mark.parametrize("system", HOLONOMIC)
def test_elimination_with_other_gravity_disagrees(system):
    constrained, places, q = system()
    wrong = embedded(Lagrangian(constrained.lagrangian.L.subs(g, 2 * g), constrained.lagrangian.q), places, q)
    solved = {acceleration(c): f for c, f in zip(q, wrong.accelerations, strict=True)}
    pairs = list(zip(*in_new_coordinates(constrained, places, q), strict=True))
    assert any(vanishes(one - other.xreplace(solved)).fails for one, other in pairs)


@pytest.mark.parametrize("system", HOLONOMIC)
def test_quasi_velocities_agree_with_multipliers(system):
    """Maggi's equations in whichever velocities elimination leaves free, on the manifold."""
    constrained, places, q = system()
    kin = independent_velocities(constrained)
    assert kin.satisfy(constrained).holds
    u_dot = dict(zip(kin.u_dot, maggi_accelerations(constrained.lagrangian, kin), strict=True))
    whole = {c: sp.sympify(places.get(c, c)) for c in constrained.lagrangian.q}
    new = Kinematics(q, t=constrained.lagrangian.t)
    rates = {velocity(c): new.rate(e) for c, e in whole.items()}
    for by_multipliers, f in zip(constrained.accelerations, kin.q_ddot, strict=True):
        gap = by_multipliers - f.xreplace(u_dot)
        assert vanishes(gap.xreplace({**whole, **rates})).holds


@pytest.mark.parametrize("system", HOLONOMIC)
def test_multiplier_equations_hold(system):
    constrained, _, _ = system()
    lam = sp.symbols(f"lam:{len(constrained.multipliers)}", real=True)
    found = dict(zip(map(acceleration, constrained.lagrangian.q), constrained.accelerations, strict=True))
    found |= dict(zip(lam, constrained.multipliers, strict=True))
    for equation in constrained.equations(lam)[: len(constrained.lagrangian.q)]:
        assert vanishes(equation.xreplace(found)).holds
    for second in constrained.differentiated:
        assert vanishes(second.xreplace(found)).holds
    wrong = found | {lam[0]: -constrained.multipliers[0]}
    assert any(
        vanishes(e.xreplace(wrong)).fails for e in constrained.equations(lam)[: len(constrained.lagrangian.q)]
    )


NUMBER = st.integers(-3, 3)


@settings(max_examples=20, deadline=None)  # a quarter of a second each: three derivations, five proofs
@given(st.lists(NUMBER, min_size=8, max_size=8), st.integers(1, 3))
def test_three_ways_agree_on_generated_systems(numbers, one):
    """A constraint z = u(x, y, t) in L with a position-dependent metric: multipliers, elimination, Maggi."""
    c1, c2, c3, c4, d1, d2, d3, d4 = numbers
    u = c1 * x + c2 * x * y + c3 * y**2 + c4 * x * time
    metric = (one + x**2) * x.dot**2 / 2 + y.dot**2 / 2 + m * z.dot**2 / 2 + d1 * x.dot * z.dot / 5
    L = Lagrangian(metric - d2 * z**2 - d3 * x * y * z - k * y**2, [x, y, z], forces=[0, -d4 * y.dot, 0])
    constrained = ConstrainedLagrangian(L, holonomic=[z - u])
    reduced = embedded(L, {z: u}, [x, y])
    found = {x.ddot: reduced.accelerations[0], y.ddot: reduced.accelerations[1]}
    by_multipliers, _ = in_new_coordinates(constrained, {z: u}, [x, y])
    kin = independent_velocities(constrained, [x, y])
    by_maggi = [f.xreplace({z: u}) for f in maggi_accelerations(L, kin)]
    for i, s_ in enumerate((x.ddot, y.ddot)):
        assert vanishes(by_multipliers[i] - found[s_]).holds
        assert vanishes(by_maggi[i] - found[s_]).holds
    assert vanishes(by_maggi[1] - found[y.ddot] - k * y).fails


def test_printed_incline():
    constrained, _, _ = incline_roller()
    assert vanishes(constrained.multipliers[0] - I / R**2 * constrained.accelerations[0]).holds
    assert vanishes(constrained.multipliers[0] + I / R**2 * constrained.accelerations[0]).fails
    assert vanishes((m + I / R**2) * constrained.accelerations[0] + m * g * sin(alpha)).holds
    force, torque = constrained.reactions
    assert vanishes(force + constrained.multipliers[0]).holds
    assert vanishes(torque - R * constrained.multipliers[0]).holds
    reduced, places = eliminated(constrained, [theta])
    assert places == {theta: s / R}
    assert vanishes(reduced.L - ((m + I / R**2) * s.dot**2 / 2 - m * g * s * sin(alpha))).holds


def test_atwood_tension():
    constrained, _, _ = atwood()
    assert vanishes(constrained.multipliers[0] + 2 * m * k * g / (m + k)).holds
    assert vanishes(constrained.multipliers[0] + m * k * g / (m + k)).fails


def knife_edge():
    L = Lagrangian(
        m * (x.dot**2 + y.dot**2) / 2 + J * theta.dot**2 / 2 + m * g * x * sin(alpha), [x, y, theta]
    )
    return ConstrainedLagrangian(L, nonholonomic=[x.dot * sin(theta) - y.dot * cos(theta)])


PLANE = Lagrangian((x.dot**2 + y.dot**2) / 2, [x, y])


@pytest.mark.parametrize(
    ("holonomic", "nonholonomic", "rows", "contradictory", "words"),
    [
        ([x - y, 2 * x - 2 * y], [], (1, 2), False, "leave one of them out"),
        ([x - y, 2 * x - 2 * y + 1], [], (1, 2), True, "contradict one another"),
        (
            [],
            [x.dot - y.dot, y.dot - x.dot],
            (1, 2),
            False,
            r"constraint 1 \(x_dot - y_dot = 0\) and constraint 2",
        ),
        ([], [x.dot - y.dot, y.dot - x.dot + 1], (1, 2), True, "contradict"),
        ([x - y], [x.dot - y.dot], (1, 2), None, "depend on one another"),
        ([x - y], [x.dot - y.dot + w], (1, 2), True, "contradict"),
        ([x - y, x - y - w * time], [], (1, 2), True, "contradict"),
        ([x, y, x + y], [], (1, 2, 3), False, "constraint 3"),
        ([l - k], [], (1,), True, "restricts no velocity"),
        ([x**2 + y**2 - l**2, (x**2 + y**2) ** 2 - l**4], [], (1, 2), None, "holds no velocity"),
    ],
)
def test_dependent_rows_are_named(holonomic, nonholonomic, rows, contradictory, words):
    constrained = ConstrainedLagrangian(PLANE, holonomic, nonholonomic)
    with pytest.raises(DependentConstraintsError, match=words) as caught:
        constrained.multipliers  # noqa: B018
    assert caught.value.rows == rows
    assert caught.value.contradictory is contradictory


def test_a_constraint_given_as_a_power_is_refused():
    squared = ConstrainedLagrangian(PLANE, holonomic=[x**2 - 2 * x * y + y**2])
    with pytest.raises(DependentConstraintsError, match=r"holds a power.*write x - y = 0"):
        squared.multipliers  # noqa: B018
    assert vanishes(ConstrainedLagrangian(PLANE, holonomic=[x - y]).multipliers[0]).holds


def hemisphere():
    L = Lagrangian(m * (r.dot**2 + r**2 * theta.dot**2) / 2 - m * g * r * cos(theta), [r, theta])
    return ConstrainedLagrangian(L, holonomic=[r - a])


def test_leaving_the_hemisphere():
    """λ = m g cos θ − m a θ̇² = m g (3 cos θ − 2): the notes print its negative in one line."""
    sphere = hemisphere()
    force = multiplier_in_contact(sphere, {r: a}, (theta,))
    assert vanishes(force - (m * g * cos(theta) - m * a * theta.dot**2)).holds
    along = multiplier_along(sphere, {r: a}, theta, sp.S.Zero)
    assert vanishes(along - m * g * (3 * cos(theta) - 2)).holds
    assert vanishes(along + m * g * (3 * cos(theta) - 2)).fails
    assert along.subs(theta, sp.acos(sp.Rational(2, 3))) == 0
    pushed = multiplier_along(sphere, {r: a}, theta, sp.S.Zero, speed=sp.sqrt(g / a))
    assert vanishes(pushed.subs(theta, 0)).holds


def test_leaving_the_hemisphere_sideways():
    """With a spin about the vertical: λ = 3 m g cos θ − 2 E/a, by energy alone (Newton: m v²/a inwards)."""
    phi, start, spin = (coordinates("phi"), *parameters("start spin", positive=True))
    T = m * (r.dot**2 + r**2 * theta.dot**2 + r**2 * sin(theta) ** 2 * phi.dot**2) / 2
    free = Lagrangian(T - m * g * r * cos(theta), [r, theta, phi])
    sphere = ConstrainedLagrangian(free, holonomic=[r - a])
    along = multiplier_along(sphere, {r: a}, theta, start, others={phi: spin})
    E = m * a**2 * sin(start) ** 2 * spin**2 / 2 + m * g * a * cos(start)
    assert vanishes(along - (3 * m * g * cos(theta) - 2 * E / a)).holds
    assert vanishes(along - (3 * m * g * cos(theta) - E / a)).fails
    tilted = ConstrainedLagrangian(Lagrangian(free.L - k * cos(phi), free.q), holonomic=[r - a])
    with pytest.raises(ValueError, match="phi is not ignorable"):
        multiplier_along(tilted, {r: a}, theta, start, others={phi: spin})


def test_a_multiplier_that_depends_on_the_direction_is_refused():
    """A charge on a hemisphere in a field across the plane: λ = m g cos θ − m a θ̇² − k a θ̇ in one direction."""
    plain = hemisphere()
    charged = Lagrangian(plain.lagrangian.L + k * r**2 * theta.dot / 2, [r, theta])
    held = ConstrainedLagrangian(charged, holonomic=[r - a])
    force = multiplier_in_contact(held, {r: a}, (theta,))
    assert vanishes(force - (m * g * cos(theta) - m * a * theta.dot**2 - k * a * theta.dot)).holds
    with pytest.raises(ValueError, match="depends on the direction of motion"):
        multiplier_along(held, {r: a}, theta, sp.S.Zero)


def test_one_velocity_squared_is_not_affine():
    with pytest.raises(ValueError, match="not affine in the velocities"):
        ConstrainedLagrangian(Lagrangian(x.dot**2 + y.dot**2, [x, y]), nonholonomic=[x.dot**2 + y.dot])


@pytest.mark.parametrize(
    ("given", "words"), [({x: 1, y: 2}, "keys of a dictionary"), ({x, y}, "members of a set")]
)
def test_what_has_no_order_is_refused_by_its_name(given, words):
    with pytest.raises(TypeError, match=words):
        ConstrainedLagrangian(Lagrangian(x.dot**2 + y.dot**2, [x, y]), holonomic=given)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: multiplier_in_contact(hemisphere(), {r: 2 * a}, (theta,)), "not in contact"),
        (lambda: embedded(PLANE, {x: theta}, [theta]), "no place is given for y"),
        (lambda: embedded(PLANE, {x: theta + phi, y: theta + phi}, [theta, phi]), "do not change along"),
        (lambda: eliminated(cartesian_pendulum()[0], [x]), "not affine in x"),
        (lambda: eliminated(knife_edge(), [x]), "takes no coordinate away"),
        (lambda: eliminated(atwood()[0], [x, y]), "cannot determine 2 coordinates"),
        (lambda: independent_velocities(knife_edge(), [x]), "leave 2 of 3 velocities free"),
        (lambda: Kinematics([x, y], [q1], [q1]), "1 rate for 2"),
    ],
)
def test_refusals(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_gravity_on_a_driven_support_with_equivalent_forms():
    """The bead on the turning parabola: printed equation of the notes, centrifugal sign and its twin."""
    constrained, places, q = bead_on_a_turning_parabola()
    bead = embedded(constrained.lagrangian, places, q)
    equation = (1 + 4 * s**2) * s.ddot + 4 * s * s.dot**2 + (2 * g - w**2) * s
    assert equivalent_equations(bead.equations, [equation], [s.ddot]).holds
    assert equivalent_equations(bead.equations, [equation + 2 * w**2 * s], [s.ddot]).fails


def test_numbers_differ_from_zero_on_either_side():
    assert differ(sp.Integer(-2))
    assert differ(sp.Rational(1, 3))
    assert not differ(sp.Integer(0))


def test_what_is_assumed_of_a_symbol_is_asked_of_its_value():
    u = sp.Symbol("u", real=True)
    signs = {"positive": u > 0, "negative": u < 0, "nonzero": sp.Ne(u, 0)}
    for sign, condition in signs.items():
        assert transported(Domain(), {sp.Symbol("c", real=True, **{sign: True}): u}).conditions == (
            condition,
        )
    assert transported(Domain(), {sp.Symbol("c", real=True): u}).conditions == ()


def test_a_manifold_of_many_branches_is_not_looked_into():
    signs = sp.symbols("s0:5", real=True)
    assert len(on_manifold([s**2 - 1 for s in signs[:4]], Domain())) == 16
    with pytest.raises(Undecided, match="the constraints have more than 16 branches; split the claim"):
        on_manifold([s**2 - 1 for s in signs], Domain())


NOT_KEPT = "Jacobi's energy is not conserved: forces act, or L depends on time; integrate instead"


@pytest.mark.parametrize(
    ("more", "forces", "weight", "said"),
    [
        (0, {theta: -k * theta.dot}, g, NOT_KEPT),
        (-m * r * cos(theta) * sin(time), None, g + sin(time), NOT_KEPT),
        (m * theta.dot**4, None, g, r"is not quadratic in theta_dot, so theta_dot² does not follow from it alone"),
    ],
    ids=["friction", "a moving field", "a fourth power"],
)  # fmt: skip
def test_without_an_energy_that_gives_the_speed_the_multiplier_is_known_in_contact_alone(
    more, forces, weight, said
):
    free = hemisphere().lagrangian
    held = ConstrainedLagrangian(Lagrangian(free.L + more, free.q, forces), holonomic=[r - a])
    with pytest.raises(ValueError, match=said):
        multiplier_along(held, {r: a}, theta, sp.S.Zero)
    force = multiplier_in_contact(held, {r: a}, (theta,))
    assert vanishes(force - (m * weight * cos(theta) - m * a * theta.dot**2)).holds
    assert vanishes(force - (m * weight * cos(theta) + m * a * theta.dot**2)).fails


def test_a_reaction_that_depends_on_an_ignorable_angle_is_known_in_contact_alone():
    """A pull k (r − a) cos φ across the sphere: no force along it, λ = … + k cos φ."""
    spin = parameters("spin", positive=True)
    T = m * (r.dot**2 + r**2 * theta.dot**2 + r**2 * sin(theta) ** 2 * phi.dot**2) / 2

    def sphere(pull):
        L = Lagrangian(T - m * g * r * cos(theta) - pull * (r - a), [r, theta, phi])
        return ConstrainedLagrangian(L, holonomic=[r - a])

    start = {"others": {phi: spin}}
    even = multiplier_along(sphere(k), {r: a}, theta, sp.pi / 2, **start)
    assert vanishes(even - (3 * m * g * cos(theta) - m * a * spin**2 + k)).holds
    assert vanishes(even - (3 * m * g * cos(theta) - m * a * spin**2 - k)).fails
    with pytest.raises(ValueError, match="depends on phi; take multiplier_in_contact"):
        multiplier_along(sphere(k * cos(phi)), {r: a}, theta, sp.pi / 2, **start)


def test_a_constraint_in_pieces_is_taken_as_it_stands():
    """A bend y = |x|: on each side the multipliers and accelerations are those of its straight line."""
    bend = sp.Piecewise((y - x, x > 0), (y + x, True))
    free = Lagrangian((x.dot**2 + y.dot**2) / 2 - g * y, [x, y])
    pieced, *sides = (ConstrainedLagrangian(free, holonomic=[f]) for f in (bend, y - x, y + x))
    for number, side in zip((1, -1), sides, strict=True):
        here = [f.subs({x: number, y: 1}) for f in pieced.accelerations]
        due = [f.subs({x: number, y: 1}) for f in side.accelerations]
        assert here == due == [-number * g / 2, -g / 2]
