"""Inverses of maps of polar type, proved both ways, and K in the new variables; wrong twins beside them."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from sympy import atan, atan2, cos, pi, sin, sqrt

from canon.expression.symbols.symbol import time as t
from canon.mechanics import (
    CanonicalTransformation,
    NoClosedInverseError,
    inverse_transformation,
    new_hamiltonian,
    transformed_hamiltonian,
)
from canon.mechanics.canonical.inverse.inverse_branch import plain_arcs, plain_sign, united_squares
from canon.mechanics.canonical.new_hamiltonian import is_new_hamiltonian
from canon.proof.domain.domain import Domain
from canon.proof.vanish import vanishes

q, p, Q, P, Q2, P2 = sp.symbols("q p Q P Q2 P2", real=True)
phi, psi = sp.symbols("phi psi", real=True)
I, J, m, w = sp.symbols("I J m omega", positive=True)
ACTION = (p**2 + m**2 * w**2 * q**2) / (2 * m * w)
ENERGY = p**2 / (2 * m) + m * w**2 * q**2 / 2
SINE, COSINE = sqrt(2 * P / (m * w)) * sin(Q), sqrt(2 * P * m * w) * cos(Q)
RIGHT, LEFT = Domain((p > 0,)), Domain((p < 0,))


@pytest.mark.parametrize(
    ("angle", "domain", "sign"),
    [
        (atan(m * w * q / p), RIGHT, 1),
        (atan(m * w * q / p), LEFT, -1),
        (atan2(m * w * q, p), None, 1),
        (atan2(m * w * q, p), LEFT, 1),
    ],
)
def test_the_oscillators_angle_and_action_are_solved_for_q_and_p(angle, domain, sign):
    back = inverse_transformation(CanonicalTransformation(q, p, angle, ACTION, domain), [Q], [P])
    positive = Domain((P > 0,))
    assert vanishes(back.new_q[0] - sign * SINE, positive).holds
    assert vanishes(back.new_p[0] - sign * COSINE, positive).holds
    assert vanishes(back.new_p[0] + sign * COSINE, positive).fails
    assert back.is_canonical().holds


def test_the_domain_of_the_inverse_is_the_image():
    """An angle beyond the range of the arc is no image; the inverse would not come back to it."""
    back = inverse_transformation(CanonicalTransformation(q, p, atan(m * w * q / p), ACTION, RIGHT), [Q], [P])
    assert {"Q > -pi/2", "Q < pi/2", "P > 0"} <= {str(c) for c in back.domain.conditions}
    there = back.then(CanonicalTransformation(q, p, atan(m * w * q / p), ACTION))
    assert vanishes(there.new_q[0] - Q, back.domain).holds
    assert vanishes(there.new_q[0] - Q, Domain((P > 0,))).fails


def test_no_inverse_where_opposite_points_have_the_same_image():
    with pytest.raises(NoClosedInverseError, match=r"opposite point have the same image .atan2 tells"):
        inverse_transformation(CanonicalTransformation(q, p, atan(m * w * q / p), ACTION), [Q], [P])


TURNS = [(-pi, pi, 0), (pi, 3 * pi, 1), (-3 * pi, -pi, -1)]


@pytest.mark.parametrize(("low", "high", "turns"), TURNS)
def test_angles_under_sines_and_cosines_are_arcs_on_the_turn_of_the_domain(low, high, turns):
    domain = Domain((phi > low, phi < high))
    T = CanonicalTransformation(
        phi, I, sqrt(2 * I / (m * w)) * sin(phi), sqrt(2 * I * m * w) * cos(phi), domain
    )
    back = inverse_transformation(T, [Q], [P])
    assert back.new_q[0] == atan2(Q * m * w, P) + 2 * pi * turns
    assert vanishes(back.new_p[0] - (P**2 + m**2 * w**2 * Q**2) / (2 * m * w)).holds
    assert back.is_canonical().holds


@pytest.mark.parametrize("conditions", [(), (phi > 0, phi < 2 * pi), (phi > -pi, phi < 3 * pi)])
def test_no_arc_where_the_angle_crosses_its_cut_or_makes_more_than_a_turn(conditions):
    T = CanonicalTransformation(phi, I, sqrt(2 * I) * sin(phi), sqrt(2 * I) * cos(phi), Domain(conditions))
    words = "one turn: -pi < phi < pi" if not conditions else "narrow the domain"
    with pytest.raises(NoClosedInverseError, match=words):
        inverse_transformation(T, [Q], [P])


@pytest.mark.parametrize(("a", "b", "power"), [(1, 1, 1), (2, 3, 1), (5, 1, sp.Rational(1, 2))])
def test_other_radii_than_the_oscillators(a, b, power):
    """Q = atan2(b q, a p) with the ellipse's radius or its square: the old variables come back."""
    radius = (q**2 / a**2 + p**2 / b**2) ** power
    T = CanonicalTransformation(q, p, atan2(b * q, a * p), radius)
    R = sp.Symbol(
        "R", positive=True
    )  # the root is positive: with P that may be negative there is no such image
    back = inverse_transformation(T, [Q], [R])
    rng = np.random.default_rng(3)
    there, home = sp.lambdify((q, p), T.images), sp.lambdify((Q, R), back.images)
    for point in rng.normal(size=(10, 2)):
        assert np.allclose(home(*there(*point)), point, rtol=1e-12, atol=1e-14)


def test_two_degrees_of_freedom():
    """Both angles at once, and one beside a plain degree of freedom."""
    one_turn = Domain((phi > -pi, phi < pi))
    x = (sqrt(2 * I) * sin(phi), psi + J)
    y = (sqrt(2 * I) * cos(phi), J)
    back = inverse_transformation(
        CanonicalTransformation((phi, psi), (I, J), x, y, one_turn), [Q, Q2], [P, P2]
    )
    assert back.new_q == (atan2(Q, P), Q2 - P2)
    arcs = CanonicalTransformation(
        (q, psi), (p, J), (atan2(q, p), psi), ((q**2 + p**2) / 2, J), Domain((J > 0,))
    )
    back = inverse_transformation(arcs, [Q, Q2], [P, P2])
    assert vanishes(back.new_q[0] - sqrt(2 * P) * sin(Q), Domain((P > 0,))).holds
    assert back.new_q[1] == Q2


@pytest.mark.parametrize("angle", [atan(m * w * q / p), atan2(m * w * q, p)])
def test_k_of_the_oscillator_is_omega_p(angle):
    """H. Goldstein, Classical Mechanics, 3rd ed., eq. (9.44); with atan no inverse exists, and K does."""
    T = CanonicalTransformation(q, p, angle, ACTION)
    K = transformed_hamiltonian(T, ENERGY, [Q], [P])
    assert (K.H, K.q, K.p) == (w * P, (Q,), (P,))
    assert is_new_hamiltonian(T, ENERGY, w * P, [Q, P]).holds
    assert is_new_hamiltonian(T, ENERGY, 2 * w * P, [Q, P]).fails
    assert vanishes(new_hamiltonian(T, ENERGY) - w * ACTION).holds


def test_k_of_moving_maps_and_of_the_way_back():
    turning = CanonicalTransformation(q, p, atan2(m * w * q, p) - w * t, ACTION)
    assert transformed_hamiltonian(turning, ENERGY, [Q], [P]).H == 0
    home = CanonicalTransformation(phi, I, sqrt(2 * I / (m * w)) * sin(phi), sqrt(2 * I * m * w) * cos(phi))
    assert sp.expand(transformed_hamiltonian(home, w * I, [Q], [P]).H - ENERGY.subs({q: Q, p: P})) == 0


def test_no_k_of_a_map_that_is_not_canonical():
    with pytest.raises(ValueError, match="not canonical, so it has no new Hamiltonian"):
        transformed_hamiltonian(CanonicalTransformation(q, p, atan2(q, p), q**2 + p**2), ENERGY, [Q], [P])
    with pytest.raises(ValueError, match="none of them an old variable"):
        transformed_hamiltonian(CanonicalTransformation(q, p, p, -q), ENERGY, [q], [P])


def test_k_of_a_central_force_in_polar_coordinates_has_neither_sine_nor_cosine():
    y, p_y = sp.symbols("y p_y", real=True)
    radius = sp.sqrt(q**2 + y**2)
    T = CanonicalTransformation(
        [q, y], [p, p_y], [radius, atan2(y, q)], [(q * p + y * p_y) / radius, q * p_y - y * p]
    )
    K = transformed_hamiltonian(T, (p**2 + p_y**2) / 2, [Q, Q2], [P, P2]).H
    assert sp.expand(K - P**2 / 2 - P2**2 / (2 * Q**2)) == 0


def test_a_new_hamiltonian_is_that_of_a_canonical_map():
    with pytest.raises(ValueError, match=r"so it has no new Hamiltonian; .* = 2, not 1"):
        new_hamiltonian(CanonicalTransformation(q, p, 2 * q, p), ENERGY)
    assert new_hamiltonian(CanonicalTransformation(q, p, 2 * q, p), ENERGY, valence=2) == 2 * ENERGY


def test_the_domain_of_an_inverse_leaves_out_where_its_roots_are_not_real():
    left = sp.Symbol("x", negative=True)
    inverse = inverse_transformation(CanonicalTransformation(left, p, left**2, p / (2 * left)), [Q], [P])
    assert inverse.images == (-sp.sqrt(Q), -2 * P * sp.sqrt(Q))
    assert inverse.domain.conditions == (Q > 0,)


def test_only_factors_that_keep_the_direction_leave_an_arc():
    assert plain_arcs(atan2(m * q, m * p)) == atan2(q, p)
    assert plain_arcs(atan2(-q, -p)) == atan2(-q, -p)
    assert plain_arcs(atan2(q * p, p)) == atan2(q * p, p)
    assert plain_sign(sqrt(P) * cos(Q) > 0) == (cos(Q) > 0)
    assert plain_sign(P * cos(Q) > 0) == (P * cos(Q) > 0)
    assert united_squares(3 * sin(Q) ** 2 + 2 * cos(Q) ** 2) == cos(Q) ** 2 * -1 + 3


@pytest.mark.parametrize(
    ("arc", "plain"),
    [
        (atan2(m**w * sin(phi), m**w * cos(phi)), atan2(sin(phi), cos(phi))),
        (atan2(q**w * sin(phi), q**w * cos(phi)), atan2(q**w * sin(phi), q**w * cos(phi))),
        (atan2(0, 2 * q), atan2(0, 2 * q)),
        (atan2(2 * q, 0), atan2(2 * q, 0)),
    ],
    ids=["a positive power", "a power of any sign", "along the axis", "across the axis"],
)
def test_factors_leave_an_arc_only_where_they_are_positive(arc, plain):
    assert plain_arcs(arc) == plain


def test_a_map_of_positive_coordinates_has_no_opposite_points():
    """r⁵ + r grows for r > 0 and has an inverse, though no closed one."""
    r = sp.Symbol("r", positive=True)
    with pytest.raises(NoClosedInverseError, match="in closed form on its whole domain; narrow the domain"):
        inverse_transformation(CanonicalTransformation(r, p, r**5 + r, p / (5 * r**4 + 1)), [Q], [P])
    with pytest.raises(NoClosedInverseError, match="opposite point have the same image"):
        inverse_transformation(CanonicalTransformation(q, p, q**2, p / (2 * q)), [Q], [P])


def test_k_is_not_found_where_the_map_is_not_solved_or_its_rates_are_not_integrated():
    F = sp.Function("F")
    quintic = CanonicalTransformation(q, p, q**5 + q, p / (5 * q**4 + 1))
    with pytest.raises(
        NoClosedInverseError, match="K was found in the old variables only, see new_hamiltonian"
    ):
        transformed_hamiltonian(quintic, p**2 / 2, [Q], [P])
    assert new_hamiltonian(quintic, p**2 / 2) == p**2 / 2
    singular = CanonicalTransformation(q, p, q, p + t * F(q) / q)
    with pytest.raises(
        NoClosedInverseError, match="the rates ∂Q/∂t, ∂P/∂t of the map could not be integrated"
    ):
        transformed_hamiltonian(singular, p**2 / 2, [Q], [P])


def test_k_of_a_map_that_is_solved_step_by_step():
    """Q = q + t f′(p), P = p: K = H(Q − t f′(P), P) + f(P)."""
    slope = p**5 + p + sin(p)
    T = CanonicalTransformation(q, p, q + t * slope, p)
    K = transformed_hamiltonian(T, q + p**2 / 2, [Q], [P]).H
    due = Q - t * slope.subs(p, P) + P**2 / 2 + P**6 / 6 + P**2 / 2 - cos(P)
    assert vanishes((K - due).diff(Q)).holds
    assert vanishes((K - due).diff(P)).holds
    assert is_new_hamiltonian(T, q + p**2 / 2, due + P, [Q, P]).fails


def test_an_energy_that_tells_points_of_one_image_apart_has_no_k():
    """(q, p) and (−q, −p) have the image (q², p/2q): p²/2 + q² is the same in both, p²/2 + q is not."""
    T = CanonicalTransformation(q, p, q**2, p / (2 * q))
    assert transformed_hamiltonian(T, p**2 / 2 + q**2, [Q], [P]).H == 2 * P**2 * Q + Q
    with pytest.raises(NoClosedInverseError, match="the K found so could not be proved"):
        transformed_hamiltonian(T, p**2 / 2 + q, [Q], [P])
    right = replace(T, domain=Domain((q > 0,)))
    assert 2 * P**2 * Q + sqrt(Q) == transformed_hamiltonian(right, p**2 / 2 + q, [Q], [P]).H
