"""Inverses of the classical point transformations, with their momenta; wrong twins beside them."""

import pytest
import sympy as sp
from sympy import Matrix, atan2, cos, cosh, pi, sin, sinh, sqrt

from canon.mechanics import CanonicalTransformation, NoClosedInverseError, inverse_transformation
from canon.mechanics.algebra.single_equation import generator_values
from canon.mechanics.algebra.substitution import MOST_TERMS, terms_if_expanded
from canon.proof.domain.domain import Domain
from canon.proof.vanish import vanishes

r, u, v = sp.symbols("r u v", positive=True)
m1, m2 = sp.symbols("m1 m2", positive=True)
theta, phi, z = sp.symbols("theta phi z", real=True)
x, y, w, p_x, p_y, p_w = sp.symbols("x y w p_x p_y p_w", real=True)
p1, p2, p3 = sp.symbols("p1:4", real=True)
TURN = (phi > -pi, phi < pi)
RHO, R = sqrt(x**2 + y**2), sqrt(x**2 + y**2 + w**2)
ROTATION = x * p_y - y * p_x
RADIAL = x * p_x + y * p_y


def point_map(q, images, domain=None, gauge=sp.S.Zero):
    """The canonical map of new coordinates, with momenta by Cramer's rule and the gradient of a gauge added."""
    p = (p1, p2, p3)[: len(q)]
    J = Matrix(images).jacobian(q)
    plain = J.T.adjugate() * Matrix(p) / sp.trigsimp(J.det())
    there = dict(zip(NEW, images, strict=False))
    moved = [sp.trigsimp(P) + gauge.diff(s).subs(there) for P, s in zip(plain, there, strict=True)]
    return CanonicalTransformation(q, p, images, moved, domain)


NEW = (x, y, w)
MAPS = {
    "polar": ((r, phi), (r * cos(phi), r * sin(phi)), TURN, (RHO, atan2(y, x), RADIAL / RHO, ROTATION)),
    "cylindrical": (
        (r, phi, z),
        (r * cos(phi), r * sin(phi), z),
        TURN,
        (RHO, atan2(y, x), w, RADIAL / RHO, ROTATION, p_w),
    ),
    "spherical": (
        (r, theta, phi),
        (r * sin(theta) * cos(phi), r * sin(theta) * sin(phi), r * cos(theta)),
        (theta > 0, theta < pi, *TURN),
        (R, atan2(RHO, w), atan2(y, x), (RADIAL + w * p_w) / R, (w * RADIAL - RHO**2 * p_w) / RHO, ROTATION),
    ),
    "parabolic": (
        (u, v),
        (u * v, (u**2 - v**2) / 2),
        (),
        (
            sqrt(RHO + y),
            sqrt(RHO - y),
            (RADIAL + p_y * RHO) / sqrt(RHO + y),
            (RADIAL - p_y * RHO) / sqrt(RHO - y),
        ),
    ),
    "centre of mass": (
        (u, z),
        (u - z, (m1 * u + m2 * z) / (m1 + m2)),
        (),
        (
            y + m2 * x / (m1 + m2),
            y - m1 * x / (m1 + m2),
            p_x + m1 * p_y / (m1 + m2),
            m2 * p_y / (m1 + m2) - p_x,
        ),
    ),
}


@pytest.mark.parametrize("name", MAPS)
def test_the_classical_point_transformations(name):
    q, images, conditions, expected = MAPS[name]
    n = len(q)
    back = inverse_transformation(point_map(q, images, Domain(conditions)), NEW[:n], (p_x, p_y, p_w)[:n])
    for found, right in zip(back.images, expected, strict=True):
        assert vanishes(found - right, back.domain).holds
        assert vanishes(found + right, back.domain).fails


def test_from_cartesian_to_polar_coordinates():
    """The new radius is an image that is not negative, whatever its symbol says."""
    back = inverse_transformation(point_map((x, y), (RHO, atan2(y, x))), [z, phi], [p_x, p_y])
    assert back.new_q == (z * cos(phi), z * sin(phi))
    assert (z > 0) in back.domain.conditions
    assert vanishes(back.new_p[0] - (p_x * cos(phi) - p_y * sin(phi) / z), back.domain).holds
    assert vanishes(back.new_p[0] - (p_x * cos(phi) + p_y * sin(phi) / z), back.domain).fails


def test_an_arc_that_is_turned():
    back = inverse_transformation(
        CanonicalTransformation(x, p_x, atan2(x, p_x) + 1, (x**2 + p_x**2) / 2), [phi], [p1]
    )
    assert back.images == (sqrt(2) * sqrt(p1) * sin(phi - 1), sqrt(2) * sqrt(p1) * cos(phi - 1))
    assert {phi > 1 - pi, phi < 1 + pi} <= set(back.domain.conditions)


def test_a_gauge_is_taken_off_the_momenta():
    back = inverse_transformation(
        point_map((r, phi), (r * cos(phi), r * sin(phi)), Domain(TURN), x**2 * y), [x, y], [p_x, p_y]
    )
    assert vanishes(back.new_p[1] - (x * (p_y - x**2) - y * (p_x - 2 * x * y)), back.domain).holds
    assert vanishes(back.new_p[1] - ROTATION, back.domain).fails
    assert back.is_canonical().holds


def test_what_is_not_canonical_is_not_inverted_by_its_coordinates():
    """The momenta are those of the gradient only in a canonical map; in another one they are solved for."""
    T = CanonicalTransformation((r, z), (p1, p2), (r**2, z + r), (p1, 5 * p2))
    back = inverse_transformation(T, [x, y], [p_x, p_y])
    assert back.images == (sqrt(x), y - sqrt(x), p_x, p_y / 5)


ACROSS, ALONG = cosh(u) * cos(theta), sinh(u) * sin(theta)
TURNED = CanonicalTransformation(
    (u, theta),
    (p1, p2),
    (ACROSS + ALONG, ACROSS - ALONG),
    (p1 / ACROSS, p2),
    Domain((theta > -pi, theta < pi)),
)


def test_a_turn_without_bounds_is_told_at_once(monkeypatch):
    monkeypatch.setattr("canon.mechanics.canonical.inverse.inverse_transformation.point_branch", None)
    T = point_map((r, phi), (r * cos(phi), r * sin(phi)))
    with pytest.raises(
        NoClosedInverseError, match=r"phi and phi \+ 2\*pi have the same image; .* -pi < phi < pi"
    ):
        inverse_transformation(T, [x, y], [p_x, p_y])


def test_a_budget_that_ends_is_told(monkeypatch):
    """Turned elliptic coordinates lead to an equation of degree four in cosh u, whose roots are not tried for long."""
    now = iter(range(0, 10**6, 5))
    monkeypatch.setattr(
        "canon.mechanics.canonical.inverse.inverse_transformation.clock.monotonic", lambda: next(now)
    )
    with pytest.raises(
        NoClosedInverseError, match=r"within 7 s; give inverse_transformation a larger budget"
    ):
        inverse_transformation(TURNED, [x, y], [p_x, p_y], budget=7)


@pytest.mark.parametrize("bad", ["long", float("nan"), None])
def test_a_budget_is_a_number_of_seconds(bad):
    with pytest.raises((ValueError, TypeError), match="budget should be a number of seconds, not"):
        inverse_transformation(TURNED, [x, y], [p_x, p_y], budget=bad)


@pytest.mark.parametrize("n", [1, 4, 12, 40])
def test_only_small_polynomials_over_symbols_are_eliminated(monkeypatch, n):
    """SymPy's resultants of large polynomials, or of such with functions as coefficients, may take minutes."""
    asked = []

    def resultant(f, g, name):
        asked.append((f, g))
        return OF_SYMPY(f, g, name)

    monkeypatch.setattr("canon.mechanics.algebra.single_equation.sp.resultant", resultant)
    f = sum((sqrt(k + 1) * sin(k * y) * cos(phi) ** k * sin(phi) ** (k % 2) for k in range(1, n + 1)), -w)
    values = list(generator_values(f, phi))
    assert bool(values) == (n == 1)
    assert bool(asked) == (n <= 4)
    for f, g in asked:
        assert f.is_polynomial()
        assert g.is_polynomial()
        assert terms_if_expanded(f) ** 2 <= MOST_TERMS
    for kernel, value, _ in values:
        assert kernel.has(phi)
        assert not value.has(phi)


OF_SYMPY = sp.resultant
