"""The rattleback's linear part: rocking grows or dies with the sense of the spin (A. Garcia & M. Hubbard 1988)."""

import numpy as np
import pytest
import sympy as sp

from canon.expression.symbols.symbol import coordinates, parameters
from canon.mechanics.at_scale.constrained import constrained, constrained_motion
from canon.mechanics.at_scale.second_order import derivation
from canon.mechanics.lagrange.body import RigidBody
from canon.mechanics.lagrange.quasi_velocity import Kinematics

m, g, h, a, b, A, B, C = parameters("m g h a b A B C", positive=True)
D = parameters("D")
x, y, yaw, pitch, roll = coordinates("x y yaw pitch roll")

STONE = {m: 1.0, g: 9.8, h: 1.0, a: 8.0, b: 2.0, A: 1.5, B: 8.0, C: 8.5, D: 0.8}
"""A paraboloid −h + x²/2a + y²/2b under the centre of mass; D is the product of inertia that skews it."""


def stone():
    c, s = sp.cos, sp.sin
    about_z = sp.Matrix([[c(yaw), -s(yaw), 0], [s(yaw), c(yaw), 0], [0, 0, 1]])
    about_x = sp.Matrix([[1, 0, 0], [0, c(pitch), -s(pitch)], [0, s(pitch), c(pitch)]])
    about_y = sp.Matrix([[c(roll), 0, s(roll)], [0, 1, 0], [-s(roll), 0, c(roll)]])
    R = about_z * about_x * about_y
    up = R[2, :].T
    px, py = -a * up[0] / up[2], -b * up[1] / up[2]
    contact = sp.Matrix([px, py, -h + px**2 / (2 * a) + py**2 / (2 * b)])
    height = -contact.dot(up)
    body = RigidBody(m, (x, y, height), sp.Matrix([[A, D, 0], [D, B, 0], [0, 0, C]]), R)
    omega = sp.Matrix(body.angular_velocity(Kinematics([x, y, yaw, pitch, roll])))
    centre = R * contact.cross(omega)
    rolling = [x.dot - centre[0], y.dot - centre[1]]
    return constrained(derivation([body], [x, y, yaw, pitch, roll], field=(0, 0, -g)), nonholonomic=rolling)


@pytest.fixture(scope="module")
def system():
    return stone()


def spectrum(system, values, spin):
    """Eigenvalues of the motion in (tilts, their rates, spin) about a steady spin upright."""
    motion = constrained_motion(system, values)

    def rates(z):
        q = np.array([0.0, 0.0, 0.0, z[0], z[1]])
        free = np.array([0.0, 0.0, z[4], z[2], z[3]])
        _, slip = motion.residual(q, free, 0.0)
        v = free - np.array([*slip, 0.0, 0.0, 0.0])
        accelerations, _ = motion.accelerations(q, v, 0.0)
        return np.array([z[2], z[3], accelerations[3], accelerations[4], accelerations[2]])

    steady = np.array([0.0, 0.0, 0.0, 0.0, spin])
    assert np.abs(rates(steady)).max() < 1e-12
    step = 1e-5
    columns = [(rates(steady + step * e) - rates(steady - step * e)) / (2 * step) for e in np.eye(5)]
    return np.linalg.eigvals(np.array(columns).T)


def fastest(values):
    return values[np.argmax(np.abs(values.imag))]


def test_rocking_at_rest_is_neutral(system):
    found = spectrum(system, STONE, 0.0)
    assert np.abs(found.real).max() < 1e-6
    assert np.sum(found.imag > 0.1) == 2


def test_the_skewed_stone_prefers_a_sense_of_spin(system):
    one, other = spectrum(system, STONE, 0.5), spectrum(system, STONE, -0.5)
    assert abs(fastest(one).real) > 1e-3
    assert fastest(one).real * fastest(other).real < 0
    mirrored = spectrum(system, STONE | {D: -STONE[D]}, 0.5)
    assert fastest(mirrored).real == pytest.approx(fastest(other).real, rel=1e-5)


def test_reversed_motion_has_opposite_growth(system):
    """(q, q̇, t) → (q, −q̇, −t) is a symmetry: the spectrum at −spin is the negative of that at spin."""
    one, other = spectrum(system, STONE, 0.5), spectrum(system, STONE, -0.5)
    assert np.allclose(np.sort_complex(np.round(one, 6)), np.sort_complex(np.round(-other, 6)), atol=2e-5)


def test_without_skewness_no_sense_is_preferred(system):
    found = spectrum(system, STONE | {D: 0.0}, 0.5)
    assert np.abs(found.real).max() < 1e-6


def test_frequencies_at_rest(system):
    """Unskewed: ω² = m g (R − h)/(I + m h²) for each radius of curvature R and its moment of inertia I."""
    found = spectrum(system, STONE | {D: 0.0}, 0.0)
    stone = STONE
    expected = [
        np.sqrt(stone[g] * (stone[R] - stone[h]) / (stone[I] + stone[h] ** 2)) for R, I in ((a, B), (b, A))
    ]
    assert sorted(found.imag)[-2:] == pytest.approx(sorted(expected), rel=1e-6)
    twin = [
        np.sqrt(stone[g] * (stone[R] - stone[h]) / (stone[I] + stone[h] ** 2)) for R, I in ((a, A), (b, B))
    ]
    assert sorted(found.imag)[-2:] != pytest.approx(sorted(twin), rel=1e-2)
