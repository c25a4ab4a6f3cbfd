"""Routh's reduction against Lagrange's equations, closed forms and the lecture notes' systems."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.expression.symbols.symbol import coordinates, parameters, time, time_derivative
from canon.mechanics.hamilton.legendre import LegendreError
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.reduction.ignorable import (
    adapted,
    ignorable_coordinates,
    ignorable_directions,
    is_ignorable,
)
from canon.mechanics.reduction.routh import routhian
from canon.proof.domain.domain import Domain
from canon.proof.equivalence import equivalent_equations
from canon.proof.vanish import vanishes

m, g, l, a, b, d, c, k, I1, I3, M = parameters("m g l a b d c k I1 I3 M", positive=True)
x, y, z, theta, phi, psi, q1, q2 = coordinates("x y z theta phi psi q1 q2")
r = coordinates("r", positive=True)
P = sp.Symbol("P", real=True)


def projectile():
    """The lecture notes: R = m ẏ²/2 − m g y − P²/2m."""
    L = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 - m * g * y, [x, y])
    return L, [x], [P], m * y.dot**2 / 2 - m * g * y - P**2 / (2 * m), [y.ddot + g]


def two_degrees():
    L = Lagrangian(q1.dot**2 / (2 * (a + b * q2**2)) + q2.dot**2 / 2 - c - d * q2**2, [q1, q2])
    R = q2.dot**2 / 2 - c - d * q2**2 - (a + b * q2**2) * P**2 / 2
    return L, [q1], [P], R, [q2.ddot + (2 * d + b * P**2) * q2]


def cylindrical():
    """Where the notes print z for r, and z̈ + g z = 0 for z̈ + g = 0."""
    L = Lagrangian(m * (r.dot**2 + r**2 * theta.dot**2 + z.dot**2) / 2 - m * g * z, [r, theta, z])
    R = m * (r.dot**2 - P**2 / (m**2 * r**2) + z.dot**2) / 2 - m * g * z
    return L, [theta], [P], R, [m * r.ddot - P**2 / (m * r**3), z.ddot + g]


def spherical():
    L = Lagrangian(
        m * (r.dot**2 + r**2 * theta.dot**2 + r**2 * phi.dot**2 * sp.sin(theta) ** 2) / 2
        + m * g * r * sp.cos(theta),
        [r, theta, phi],
    )
    s = sp.sin(theta)
    R = (
        m * r.dot**2 / 2
        + m * r**2 * theta.dot**2 / 2
        + m * g * r * sp.cos(theta)
        - P**2 / (2 * m * r**2 * s**2)
    )
    radial = m * r.ddot - m * r * theta.dot**2 - m * g * sp.cos(theta) - P**2 / (m * r**3 * s**2)
    polar = r**2 * theta.ddot + 2 * r * r.dot * theta.dot + g * r * s
    return L, [phi], [P], R, [radial, polar - P**2 * sp.cos(theta) / (m**2 * r**2 * s**3)]


def lagrange_top():
    pf, ps = sp.symbols("pf ps", real=True)
    L = Lagrangian(
        I1 * (theta.dot**2 + phi.dot**2 * sp.sin(theta) ** 2) / 2
        + I3 * (psi.dot + phi.dot * sp.cos(theta)) ** 2 / 2
        - M * g * l * sp.cos(theta),
        [theta, phi, psi],
    )
    u = pf - ps * sp.cos(theta)
    s = sp.sin(theta)
    R = I1 * theta.dot**2 / 2 - u**2 / (2 * I1 * s**2) - ps**2 / (2 * I3) - M * g * l * sp.cos(theta)
    force = u * ps * s / (I1 * s**2) - u**2 * sp.cos(theta) / (I1 * s**3)
    return L, [phi, psi], [pf, ps], R, [I1 * theta.ddot + force - M * g * l * s]


SYSTEMS = [projectile, two_degrees, cylindrical, spherical, lagrange_top]


@pytest.mark.parametrize("system", SYSTEMS)
def test_routhian_and_reduced_equations(system):
    L, ignorable, momenta, R, equations = system()
    assert set(ignorable_coordinates(L)) == set(ignorable) | ({x} & set(L.q))
    found = routhian(L, ignorable, momenta)
    assert vanishes(found.R - R).holds
    accelerations = [s.ddot for s in found.q]
    assert equivalent_equations(found.equations, equations, accelerations).holds


@pytest.mark.parametrize("system", SYSTEMS)
def test_a_centrifugal_term_of_the_wrong_sign_is_seen(system):
    L, ignorable, momenta, R, equations = system()
    zero = dict.fromkeys(momenta, sp.S.Zero)
    twin = 2 * R.xreplace(zero) - R
    assert vanishes(routhian(L, ignorable, momenta).R - twin).fails
    wrong = [equations[0] + momenta[0], *equations[1:]]
    accelerations = [s.ddot for s in routhian(L, ignorable, momenta).q]
    assert equivalent_equations(routhian(L, ignorable, momenta).equations, wrong, accelerations).fails


@pytest.mark.parametrize("system", SYSTEMS)
def test_both_conventions_give_the_same_motion(system):
    L, ignorable, momenta, _, _ = system()
    plus, minus = routhian(L, ignorable, momenta), routhian(L, ignorable, momenta, convention="pq-L")
    assert vanishes(plus.R + minus.R).holds
    assert plus.lagrangian.L == minus.lagrangian.L
    assert plus.ignorable_velocities == minus.ignorable_velocities
    assert vanishes(plus.effective_potential - minus.effective_potential).holds


@pytest.mark.parametrize("system", SYSTEMS)
def test_ignorable_velocities_invert_the_momenta(system):
    L, ignorable, momenta, _, _ = system()
    found = routhian(L, ignorable, momenta)
    through = dict(zip((s.dot for s in ignorable), found.ignorable_velocities, strict=True))
    for s, p in zip(ignorable, momenta, strict=True):
        assert vanishes(L.L.diff(s.dot).xreplace(through) - p).holds
        assert vanishes(L.L.diff(s.dot).xreplace(through) + p).fails


def test_without_ignorable_coordinates_R_is_L():
    pendulum = Lagrangian(m * l**2 * theta.dot**2 / 2 + m * g * l * sp.cos(theta), [theta])
    found = routhian(pendulum)
    assert found.R == pendulum.L
    assert found.note == "no coordinate is ignorable, so R = L"
    assert routhian(pendulum, convention="pq-L").R == -pendulum.L
    assert found.equations == pendulum.equations


def test_double_pendulum_of_the_notes_has_nothing_to_ignore():
    cos = sp.cos
    L = m * l**2 * (2 * theta.dot**2 + phi.dot**2 + 2 * theta.dot * phi.dot * cos(theta - phi)) / 2
    pendulum = Lagrangian(L + m * g * l * (2 * cos(theta) + cos(phi)), [theta, phi])
    assert ignorable_directions(pendulum) == ()
    printed = [
        2 * theta.ddot
        + phi.ddot * cos(theta - phi)
        + phi.dot**2 * sp.sin(theta - phi)
        + 2 * g / l * sp.sin(theta),
        phi.ddot - theta.dot**2 * sp.sin(theta - phi) + theta.ddot * cos(theta - phi) + g / l * sp.sin(phi),
    ]
    unknowns = [theta.ddot, phi.ddot]
    assert equivalent_equations(routhian(pendulum).equations, printed, unknowns).holds
    twin = [printed[0], printed[1] + 2 * theta.dot**2 * sp.sin(theta - phi)]
    assert equivalent_equations(routhian(pendulum).equations, twin, unknowns).fails


def test_without_gravity_the_double_pendulum_turns_as_a_whole():
    """L holds θ − φ only: the direction (1, 1) is ignorable after a change of coordinates."""
    L = m * l**2 * (2 * theta.dot**2 + phi.dot**2 + 2 * theta.dot * phi.dot * sp.cos(theta - phi)) / 2
    free = Lagrangian(L, [theta, phi])
    assert ignorable_coordinates(free) == ()
    assert ignorable_directions(free) == ((1, 1),)
    new = adapted(free)
    assert new.ignorable == (theta,)
    assert is_ignorable(new.lagrangian, theta).holds
    reduced = routhian(new.lagrangian)
    assert reduced.ignorable == (theta,)
    total = sum(free.momenta)
    back = dict(new.old)
    rates = {s.dot: sp.Add(*(e.diff(w) * w.dot for w in new.lagrangian.q)) for s, e in back.items()}
    assert vanishes(total.xreplace({**back, **rates}) - new.lagrangian.L.diff(theta.dot)).holds


def test_masses_on_a_line_with_unequal_weights():
    """L feels only x − 2y: the direction is (2, 1)."""
    springs = Lagrangian(m * x.dot**2 / 2 + M * y.dot**2 / 2 - k * (x - 2 * y) ** 4, [x, y])
    (direction,) = ignorable_directions(springs)
    assert direction[0] == 2 * direction[1] != 0
    assert is_ignorable(adapted(springs).lagrangian, adapted(springs).ignorable[0]).holds
    held = Lagrangian(springs.L - k * y**2, [x, y])
    assert ignorable_directions(held) == ()


@pytest.mark.parametrize(
    ("V", "direction"),
    [
        (sp.cos(2 * x) * sp.cos(2 * y) + 4 * sp.sin(x) * sp.cos(x) * sp.sin(y) * sp.cos(y), (1, 1)),
        (sp.cos(2 * x) * sp.cos(2 * y) - 4 * sp.sin(x) * sp.cos(x) * sp.sin(y) * sp.cos(y), (1, -1)),
        (sp.cos(2 * x) * sp.cos(2 * y) - 3 * sp.sin(x) * sp.cos(x) * sp.sin(y) * sp.cos(y), None),
        ((x**2 - y**2) / (x + y) + 1 / (x - y), (1, 1)),
        ((x**2 - y**2) / (x + y) + 1 / (x + y), None),
        ((sp.tan(x) - sp.tan(y)) / (1 + sp.tan(x) * sp.tan(y)), (1, 1)),
        ((sp.tan(x) + sp.tan(y)) / (1 + sp.tan(x) * sp.tan(y)), None),
        (sp.exp(2 * x) / (sp.exp(2 * x) + sp.exp(2 * y)), (1, 1)),
    ],
)
def test_directions_behind_identities(V, direction):
    """cos 2(x ∓ y), x − y, tan(x − y) in disguise, and twins that depend on both coordinates."""
    found = ignorable_directions(Lagrangian(m * (x.dot**2 + y.dot**2) / 2 - k * V, [x, y]))
    assert [[c / found_[0] for c in found_] for found_ in found] == ([list(direction)] if direction else [])


def test_a_force_along_it_makes_a_coordinate_not_ignorable():
    dragged = Lagrangian(m * (x.dot**2 + y.dot**2) / 2, [x, y], forces=[-k * x.dot, 0])
    assert ignorable_coordinates(dragged) == (y,)
    with pytest.raises(ValueError, match="x is not ignorable: not so: no force acts along x"):
        routhian(dragged, [x])
    assert routhian(dragged, [y]).equations == (m * x.ddot + k * x.dot,)


def test_effective_potential_of_a_central_force_and_of_the_conical_pendulum():
    central = routhian(Lagrangian(m * (r.dot**2 + r**2 * phi.dot**2) / 2 + k / r, [r, phi]), momenta=[P])
    assert vanishes(central.effective_potential - (P**2 / (2 * m * r**2) - k / r)).holds
    circle = sp.solve(central.effective_potential.diff(r), r)
    assert [vanishes(found - P**2 / (m * k)).holds for found in circle] == [True]
    assert central.gyroscopic == (0,)


def test_gyroscopic_terms_stay_linear():
    """A charge with a constant momentum along a magnetic field has a term linear in the velocity."""
    L = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 + x.dot * y.dot * k * sp.sin(x), [x, y])
    reduced = routhian(L, [y], [P])
    assert vanishes(reduced.gyroscopic[0] - P * k * sp.sin(x) / m).holds
    assert vanishes(reduced.gyroscopic[0] + P * k * sp.sin(x) / m).fails


def test_the_ignored_coordinate_by_quadrature():
    """Two-degree system of the notes: q₂ = A cos(ωt + B), q₁ = P a t + P b ∫ q₂² dt."""
    L, ignorable, momenta, _, _ = two_degrees()
    reduced = routhian(L, ignorable, momenta)
    A, B = sp.symbols("A B", real=True)
    w = sp.sqrt(2 * d + b * P**2)
    (found,) = reduced.quadrature({q2: A * sp.cos(w * time + B)}, {q1: sp.S.Zero})
    s = sp.sin(2 * (w * time + B)) - sp.sin(2 * B)
    expected = P * a * time + P * b * A**2 * (time / 2 + s / (4 * w))
    assert vanishes(found - expected, budget=20).holds
    assert vanishes(found - expected - P * a * time).fails


def test_quadrature_at_times_against_the_closed_form():
    """A straight line in polar coordinates: φ = atan(v t/b)."""
    reduced = routhian(Lagrangian(m * (r.dot**2 + r**2 * phi.dot**2) / 2, [r, phi]), momenta=[P])

    def line(t):
        distance = np.sqrt(1 + t**2)
        return distance[None, :], (t / distance)[None, :]

    times = np.linspace(0.0, 5.0, 41)
    (angle,) = reduced.quadrature_at(line, times, [0.0], {m: 2.0, P: 2.0})
    assert np.abs(angle - np.arctan(times)).max() < 1e-13
    (turned,) = reduced.quadrature_at(line, times, [0.0], {m: 2.0, P: 2.1})
    assert np.abs(turned - np.arctan(times)).max() > 0.05


def test_an_integral_without_a_table_stays_an_integral():
    reduced = routhian(Lagrangian(x.dot**2 / (2 * sp.exp(sp.sin(y))) + y.dot**2 / 2, [x, y]), [x], [P])
    (found,) = reduced.quadrature({y: time**2}, {x: sp.S.Zero})
    assert found.has(sp.Integral)
    assert vanishes(found.diff(time) - P * sp.exp(sp.sin(time**2))).holds


def test_routh_of_the_relativistic_particle():
    gamma = sp.sqrt(1 - (x.dot**2 + y.dot**2))
    reduced = routhian(
        Lagrangian(-m * gamma - k * y**2, [x, y]), [x], [P], domain=Domain((x.dot**2 + y.dot**2 < 1,))
    )
    expected = -sp.sqrt(m**2 + P**2) * sp.sqrt(1 - y.dot**2) - k * y**2
    assert vanishes(reduced.R - expected, Domain((y.dot**2 < 1,))).holds
    assert vanishes(reduced.R + expected, Domain((y.dot**2 < 1,))).fails


SMALL = st.integers(-3, 3)


@settings(max_examples=50, deadline=None)
@given(st.lists(SMALL, min_size=6, max_size=6), st.integers(1, 4), st.integers(1, 4))
def test_reduction_of_generated_systems(numbers, one, two):
    """L = ½(A ẋ² + 2B ẋẏ + C ẏ²) + Eẏ − V in functions of x: Routh's equation is Lagrange's at constant p."""
    u, v, w, e, f, h = numbers
    A, C = one + 10 + u * sp.sin(x), two + 10 + v * x**2 / (1 + x**2)
    L = Lagrangian(
        A * x.dot**2 / 2
        + w * x.dot * y.dot * sp.cos(x)
        + C * y.dot**2 / 2
        + e * x * y.dot
        - f * x**3
        - h * x,
        [x, y],
    )
    reduced = routhian(L, [y], [P])
    there = {P: L.momenta[1]}
    p_dot = time_derivative(L.momenta[1], [x, y])
    # d/dt of ∂R/∂ẋ at constant p differs from Lagrange's by what multiplies ṗ, which vanishes on the motion.
    slope = reduced.R.diff(x.dot).diff(P)
    gap = reduced.equations[0].xreplace(there) + slope.xreplace(there) * p_dot - L.equations[0]
    assert vanishes(gap).holds
    assert vanishes(gap + x * L.momenta[1]).fails


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: routhian(spherical()[0], [theta]), ValueError, "theta is not ignorable"),
        (lambda: routhian(spherical()[0], [x]), ValueError, "x is no coordinate"),
        (lambda: routhian(spherical()[0], [phi], []), ValueError, "0 momenta for 1"),
        (lambda: routhian(spherical()[0], convention="L+pq"), ValueError, "write 'L-pq'"),
        (lambda: routhian(Lagrangian(x.dot + y.dot**2, [x, y]), [x]), LegendreError, "singular"),
    ],
)
def test_refusals(make, error, words):
    with pytest.raises(error, match=words):
        make()
