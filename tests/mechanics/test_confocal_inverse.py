"""Inverses of elliptic, prolate and oblate coordinates: both distances from the foci, and points that come back."""

from dataclasses import replace

import pytest
import sympy as sp
from sympy import cos, cosh, pi, sin, sinh, sqrt

from canon.mechanics import NoClosedInverseError, inverse_transformation
from canon.mechanics.algebra.branch_point import BranchPoint
from canon.mechanics.canonical.inverse.confocal_inverse import confocal_branch
from canon.mechanics.canonical.transformation import point_transformation
from canon.proof.domain.domain import Domain
from canon.proof.vanish import vanishes

u, c = sp.symbols("u c", positive=True)
v, phi, x, y, z, p_x, p_y, p_z = sp.symbols("v phi x y z p_x p_y p_z", real=True)
p_u, p_v, p_phi = sp.symbols("p_u p_v p_phi", real=True)
WHOLE, HALF, TURN = (v > -pi, v < pi), (v > 0, v < pi), (phi > -pi, phi < pi)
AXIS, RADIUS = c * cosh(u) * cos(v), c * sinh(u) * sin(v)
DISC, HEIGHT = c * cosh(u) * sin(v), c * sinh(u) * cos(v)
PLANE, SPACE = ((u, v), (p_u, p_v)), ((u, v, phi), (p_u, p_v, p_phi))
NEW, MOMENTA = (x, y, z), (p_x, p_y, p_z)

MAPS = {
    "elliptic": (PLANE, (AXIS, RADIUS), WHOLE, sp.Rational(-7, 3)),
    "elliptic, the axes exchanged": (PLANE, (RADIUS, AXIS), WHOLE, sp.Rational(7, 3)),
    "elliptic, from the other axis": (PLANE, (DISC, HEIGHT), WHOLE, sp.Rational(7, 3)),
    "elliptic, another turn": (PLANE, (AXIS, RADIUS), (v > pi, v < 3 * pi), sp.Integer(7)),
    "prolate": (SPACE, (RADIUS * cos(phi), RADIUS * sin(phi), AXIS), (*HALF, *TURN), sp.Rational(7, 3)),
    "oblate": (SPACE, (DISC * cos(phi), DISC * sin(phi), HEIGHT), (*HALF, *TURN), sp.Rational(7, 3)),
}
QUICK = ("elliptic",)


def confocal(name):
    (q, p), position, conditions, _ = MAPS[name]
    return replace(point_transformation(q, p, position), domain=Domain(conditions))


@pytest.mark.parametrize("name", [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in MAPS])
def test_a_point_comes_back(name):
    T, angle = confocal(name), MAPS[name][3]
    n = len(T.q)
    back = inverse_transformation(T, NEW[:n], MOMENTA[:n])
    start = dict(zip((*SPACE[0], *SPACE[1]), map(sp.Rational, ("3/4", angle, -2, "2/5", -3, 2)), strict=True))
    start[c] = sp.Rational(3, 2)
    there = dict(zip((*NEW[:n], *MOMENTA[:n]), (f.subs(start).n(30) for f in T.images), strict=True))
    for old, f in zip(T.variables, back.images, strict=True):
        found = f.subs({**there, c: start[c]}).n(30)
        assert abs(found - start[old]) < 1e-25
        assert abs(found + start[old]) > 1e-2


def test_the_coordinates_are_half_the_sum_and_the_difference_of_both_distances():
    back = inverse_transformation(confocal("elliptic"), [x, y], [p_x, p_y])
    far, near = sqrt((x + c) ** 2 + y**2), sqrt((x - c) ** 2 + y**2)
    u_there, v_there = back.new_q
    assert vanishes(2 * c * cosh(u_there) - far - near, Domain((far + near > 2 * c,))).holds
    assert vanishes(2 * c * cos(v_there) - far + near, Domain((y > 0,))).holds
    assert vanishes(2 * c * cos(v_there) + far - near, Domain((y > 0,))).fails


@pytest.mark.slow
def test_where_two_points_have_one_image_there_is_no_inverse():
    """(u, v) and (−u, −v) are one place."""
    w = sp.Symbol("w", real=True)
    T = point_transformation((w, v), (p_u, p_v), (cosh(w) * cos(v), sinh(w) * sin(v)))
    with pytest.raises(NoClosedInverseError):
        inverse_transformation(replace(T, domain=Domain(WHOLE)), [x, y], [p_x, p_y], budget=5)
    back = inverse_transformation(replace(T, domain=Domain((*WHOLE, w < 0))), [x, y], [p_x, p_y])
    assert back.new_q[0].subs({x: 2, y: 1}).n() < 0


def test_where_a_witness_does_not_tell_the_branch_none_is_given():
    """Between the foci u = 0, where v and −v are one place; beyond the axis ρ < 0, and φ is not the angle of (x, y)."""
    w = sp.Symbol("w", real=True)
    flat = {x: cosh(w) * cos(v), y: sinh(w) * sin(v)}
    rho = sinh(w) * sin(v)
    turned = {x: rho * cos(phi), y: rho * sin(phi), z: cosh(w) * cos(v)}
    beside = {w: sp.Integer(1), v: sp.Integer(1), phi: sp.Integer(1)}
    for q, places, nowhere in (
        ([w, v], flat, beside | {w: sp.S.Zero}),
        ([w, v, phi], turned, beside | {v: sp.Integer(-1)}),
    ):
        branch = confocal_branch(q, places, BranchPoint(beside, places))
        assert branch.values[w].subs({z: f.subs(beside) for z, f in places.items()}).n() == pytest.approx(1.0)
        assert confocal_branch(q, places, BranchPoint(nowhere, places)) is None


def test_four_coordinates_are_no_confocal_ones():
    s, Z = sp.symbols("s Z", real=True)
    places = {x: RADIUS * cos(phi), y: RADIUS * sin(phi), z: AXIS, Z: s}
    at = BranchPoint(dict.fromkeys((u, v, phi, s, c), sp.S.One), places)
    assert confocal_branch([u, v, phi, s], places, at) is None
    del places[Z]
    assert confocal_branch([u, v, phi], places, at) is not None
