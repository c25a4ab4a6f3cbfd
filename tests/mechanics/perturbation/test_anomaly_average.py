"""Averages over the mean anomaly in closed form: the oblate planet to second order, beside quadrature and an orbit."""

import functools

import numpy as np
import pytest
import sympy as sp
from sympy import cos, sin

from canon import Hamiltonian, Taylor, propagate
from canon.mechanics import average_over_anomaly
from canon.mechanics.perturbation.averaging import AveragingError

mu, r, L, G, H, k = sp.symbols("mu r L G H k", positive=True)
f, g, h = sp.symbols("f g h", real=True)
OBLATE = k / (2 * r**3) * (3 * (1 - H**2 / G**2) * sin(f + g) ** 2 - 1)
"""H₁ of an oblate planet with k = μ J₂ R²."""


PERTURBATIONS = {
    "oblate planet": OBLATE,
    "inverse square": k / r**2,
    "fourth power": k / r**4 * (1 + (H / G) ** 2) + k / r**2 * sin(f) ** 2,
}


@functools.cache
def averaged(name):
    return average_over_anomaly(PERTURBATIONS[name], mu, r, f, [g, h], [L, G, H], order=2)


@pytest.fixture
def oblate():
    return averaged("oblate planet")


def published(sign=1):
    """K₂ with the coefficients of D. Brouwer, Astron. J. 64, 378 (1959), k₂ = J₂R²/2, with the sign of an energy."""
    c, x = H / G, L / G
    steady = (
        sp.Rational(15, 32) * x**5 * (1 - sp.Rational(18, 5) * c**2 + c**4)
        + sp.Rational(3, 8) * x**6 * (1 - 6 * c**2 + 9 * c**4)
        - sp.Rational(15, 32) * x**7 * (1 - 2 * c**2 - 7 * c**4)
    )
    wave = sp.Rational(3, 16) * (x**5 - x**7) * (1 - 16 * c**2 + 15 * c**4) * cos(2 * g)
    return -(mu**4 * k**2 / (4 * L**10)) * (steady - sign * wave)


def test_the_first_order_of_the_oblate_planet(oblate):
    """n and the secular rates of node and pericentre, −(3/2) J₂ R² n c/p² and (3/4) J₂ R² n (5 c² − 1)/p²."""
    K1 = oblate.in_momenta()[0]
    n, p = mu**2 / L**3, G**2 / mu
    assert sp.simplify(K1 - k * n * (1 - 3 * H**2 / G**2) / (4 * G**3) * mu) == 0
    assert sp.simplify(K1.diff(H) + sp.Rational(3, 2) * k / mu * n * (H / G) / p**2) == 0
    assert sp.simplify(K1.diff(G) - sp.Rational(3, 4) * k / mu * n * (5 * H**2 / G**2 - 1) / p**2) == 0
    assert oblate.removes_the_anomaly().holds


def test_the_second_order_is_brouwers(oblate):
    K2 = oblate.in_momenta()[1]
    assert sp.simplify(K2 - published()) == 0
    assert sp.simplify(K2 - published(sign=-1)) != 0
    assert not K2.has(sp.sqrt(1 - G**2 / L**2))


class ByQuadrature:
    """The same by Fourier sums over the mean anomaly and differences in the momenta, without any formula for W₁."""

    def __init__(self, perturbation, strength, points=512):
        self.strength = strength
        self.l = 2 * np.pi * np.arange(points) / points
        self.H1 = sp.lambdify((r, f, g, L, G, H), perturbation)

    def first(self, g0, L0, G0, H0):
        """Return H₁ and n W₁ on the grid, and K₁; W₁ has a mean of zero over f."""
        e = np.sqrt(1 - (G0 / L0) ** 2)
        E = self.l.copy()
        for _ in range(60):
            E -= (E - e * np.sin(E) - self.l) / (1 - e * np.cos(E))
        true = np.arctan2(np.sqrt(1 - e**2) * np.sin(E), np.cos(E) - e)
        radius = L0**2 / self.strength * (1 - e * np.cos(E))
        H1 = self.H1(radius, true, g0, L0, G0, H0)
        K1 = H1.mean()
        waves = np.fft.fft(H1 - K1)
        orders = np.fft.fftfreq(len(H1), 1 / len(H1))
        waves[1:] /= 1j * orders[1:]
        W = np.fft.ifft(waves).real
        by_f = (L0**2 / self.strength) ** 2 * (G0 / L0) / radius**2  # df/dl
        return H1, W - (W * by_f).mean(), K1

    def second(self, g0, L0, G0, H0, step=4e-4):
        def by(place):
            moved = [[x + d * (i == place) for i, x in enumerate((g0, L0, G0, H0))] for d in STEPS * step]
            found = [self.first(*each) for each in moved]
            n = [self.strength**2 / each[1] ** 3 for each in moved]
            return [
                sum(w * one for w, one in zip(WEIGHTS, column, strict=True)) / step
                for column in (
                    [one[0] + one[2] for one in found],
                    [one[1] / m for one, m in zip(found, n, strict=True)],
                )
            ]

        H1, _, K1 = self.first(g0, L0, G0, H0)
        n = self.strength**2 / L0**3
        (A_g, W_g), (A_L, W_L), (A_G, W_G) = by(0), by(1), by(2)
        waves = np.fft.fft(H1) * 1j * np.fft.fftfreq(len(H1), 1 / len(H1))
        A_l, W_l = np.fft.ifft(waves).real, (H1 - K1) / n
        return (A_l * W_L + A_g * W_G - A_L * W_l - A_G * W_g).mean() / 2


STEPS = np.array([-3, -2, -1, 1, 2, 3])
WEIGHTS = np.array([-1, 9, -45, 45, -9, 1]) / 60
PLACES = [(0.3, 1.1, 0.8, 0.5), (1.7, 0.9, 0.85, -0.2), (0.0, 1.0, 0.6, 0.45), (2.9, 1.3, 1.1, 0.0)]


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("name", PERTURBATIONS)
def test_the_second_order_by_quadrature(place, name):
    there = {mu: sp.Rational(13, 10), k: sp.Rational(7, 10)}
    found = averaged(name).in_momenta()
    values = {**there, **dict(zip((g, L, G, H), place, strict=True))}
    route = ByQuadrature(PERTURBATIONS[name].subs(there), 1.3)
    assert float(found[0].subs(values)) == pytest.approx(route.first(*place)[2], rel=1e-12)
    second = route.second(*place)
    assert float(found[1].subs(values)) == pytest.approx(second, rel=1e-7, abs=1e-9)
    if name == "oblate planet":
        assert float(published(sign=-1).subs(values)) != pytest.approx(second, rel=1e-3)


def test_an_inverse_square_is_known_exactly():
    """With G² + 2 k for G² it is Kepler's problem in a turning frame: K = −μ²/2 (L − G + √(G² + 2 k))²."""
    small = sp.Symbol("epsilon", positive=True)
    K = -(mu**2) / 2 / (L - G + sp.sqrt(G**2 + 2 * small * k)) ** 2
    found = average_over_anomaly(k / r**2, mu, r, f, [g], [L, G], order=2).in_momenta()
    for order, each in enumerate(found, 1):
        assert sp.simplify(each - K.diff(small, order).subs(small, 0) / sp.factorial(order)) == 0


def delaunay(motion):
    """Return (l, g, h, L, G, H), f and f − l of rows (x, y, z, p_x, p_y, p_z) with μ = 1, angles without jumps."""
    x, v = motion[:, :3], motion[:, 3:]
    radius, spin = np.linalg.norm(x, axis=1), np.cross(x, v)
    L0, G0 = 1 / np.sqrt(2 / radius - (v**2).sum(1)), np.linalg.norm(spin, axis=1)
    node = np.stack([-spin[:, 1], spin[:, 0], 0 * radius], axis=1)
    node /= np.linalg.norm(node, axis=1)[:, None]
    latitude = np.arctan2((np.cross(spin, node) * x).sum(1) / G0, (node * x).sum(1))
    e_cos, e_sin = G0**2 / radius - 1, G0 * (x * v).sum(1) / radius
    e, true = np.hypot(e_cos, e_sin), np.arctan2(e_sin, e_cos)
    E = 2 * np.arctan(np.sqrt((1 - e) / (1 + e)) * np.tan(true / 2))
    mean = E - e * np.sin(E)
    angles = (mean, latitude - true, np.arctan2(node[:, 1], node[:, 0]))
    return (*map(np.unwrap, angles), L0, G0, spin[:, 2]), true, true - mean


def along_an_orbit(small, order):
    """Return the spread of the mean L', and by how much an oblate planet turns its node otherwise than K says."""
    found = averaged("oblate planet")
    x, y, z, *p = sp.symbols("x y z p_x p_y p_z")
    distance = sp.sqrt(x**2 + y**2 + z**2)
    oblate = sp.Rational(1, 2) * small * (3 * z**2 / distance**2 - 1) / distance**3
    system = Hamiltonian(sum(one**2 for one in p) / 2 - 1 / distance + oblate, (x, y, z), tuple(p))
    start = np.array([0.8, 0, 0, 0, 1.2 * np.cos(0.7), 1.2 * np.sin(0.7)])
    motion = propagate(system, (0.0, 60 * np.pi), start, method=Taylor(), samples=1501)
    osculating, true, centre = delaunay(motion.y.T)
    ellipse, there = found.ellipse, {mu: 1, k: 1}
    given = (f, ellipse.e, ellipse.eta, *found.angles, *found.momenta, found.centre)
    shifts = sp.lambdify(given, [each.subs(there) for each in found.shifts()])
    e, eta = np.sqrt(1 - (osculating[4] / osculating[3]) ** 2), osculating[4] / osculating[3]
    moved = shifts(true, e, eta, *osculating[1:], centre)
    mean = [one - small * shift for one, shift in zip(osculating, moved, strict=True)]
    K = sum(small**n * each for n, each in enumerate(found.in_momenta()[:order], 1))
    rate = sp.lambdify((g, L, G, H), K.subs(there).diff(H))(mean[1], *mean[3:])
    smooth = np.sin(
        np.pi * motion.t / motion.t[-1]
    )  # squared, Hann's window: waves of the anomaly leave no slope
    turned = np.polyfit(motion.t, mean[2], 1, w=smooth)[0]
    return np.ptp(mean[3]), abs(turned - np.average(rate, weights=smooth**2))


def test_mean_elements_stay_along_an_orbit():
    """L' wanders by J₂² only; the node turns as K₁ says to J₂², and as K₁ + K₂ say to J₂³."""
    spread = [along_an_orbit(small, 1)[0] for small in (2e-3, 1e-3)]
    assert spread[0] / spread[1] == pytest.approx(4, rel=0.1)
    for order, due in ((1, 4), (2, 8)):
        wrong = [along_an_orbit(small, order)[1] for small in (2e-3, 1e-3)]
        assert wrong[0] / wrong[1] == pytest.approx(due, rel=0.1)


@pytest.mark.parametrize(
    ("perturbation", "order", "words"),
    [
        (k / r, 1, r"terms from 1/r\*\*2 on"),
        (k * r**2, 1, r"terms from 1/r\*\*2 on"),
        (k / r**3 * sp.exp(cos(f)), 1, "no polynomial in sines and cosines of f and g"),
        (k / r**3 * sin(f / 2), 1, "no polynomial in sines and cosines of f and g"),
        (k / r**4 * sin(f + g), 2, "first average has no angle in it"),
        (k / r**3 * sin(f + g + h), 2, "the perturbation no node"),
        (k / r**3, 3, "order should be 1 or 2"),
    ],
)
def test_what_is_not_averaged_is_told(perturbation, order, words):
    with pytest.raises((AveragingError, ValueError), match=words):
        average_over_anomaly(perturbation, mu, r, f, [g, h], [L, G, H], order)


def test_the_pear_shape_in_first_order():
    """J₃: K₁ holds e sin g, a long period; of first order it is known."""
    s = sp.sqrt(1 - H**2 / G**2)
    J3 = k / (2 * r**4) * (5 * s**3 * sin(f + g) ** 3 - 3 * s * sin(f + g))
    found = average_over_anomaly(J3, mu, r, f, [g, h], [L, G, H])
    assert found.removes_the_anomaly().holds
    e = sp.sqrt(1 - G**2 / L**2)
    due = sp.Rational(3, 8) * k * mu**4 / (G**5 * L**3) * e * s * (1 - 5 * H**2 / G**2) * sin(g)
    assert sp.simplify(found.in_momenta()[0] - due) == 0


@pytest.mark.parametrize(
    ("angles", "momenta", "said"),
    [
        ([g], [L], "1 angle and 1 momentum; give g with L, G or g, h with L, G, H"),
        ([g, h], [L, G], "2 angles and 2 momenta; give g with L, G"),
        ([], [L], "0 angles and 1 momentum; give g with L, G"),
    ],
)
def test_angles_and_momenta_that_do_not_belong_together_are_counted(angles, momenta, said):
    with pytest.raises(ValueError, match=said):
        average_over_anomaly(k / r**2, mu, r, f, angles, momenta)
