"""Residuals of mechanics, built by hand, each with a wrong twin."""

import pytest
import sympy as sp
from sympy import Function, asin, atan, atan2, cos, cosh, elliptic_k, sin, sinh, sqrt, tanh

from canon.proof import Domain, equal, vanishes

x, y, px, py, q, p, t = sp.symbols("x y p_x p_y q p t", real=True)
c, m, l, g, alpha, omega = sp.symbols("c m l g alpha omega", positive=True)


def bracket(f, h, qs, ps):
    return sum(f.diff(a) * h.diff(b) - f.diff(b) * h.diff(a) for a, b in zip(qs, ps, strict=True))


def canonicity(new_q, new_p, qs, ps):
    """Return MJMᵀ − J as the fundamental brackets less their values."""
    z = [*new_q, *new_p]
    n = len(new_q)
    residual = sp.zeros(2 * n)
    for i in range(2 * n):
        for j in range(i + 1, 2 * n):
            residual[i, j] = bracket(z[i], z[j], qs, ps) - (1 if j == i + n else 0)
    return residual


def spheroidal(y, wrong=1):
    r1, r2 = sqrt((x + c) ** 2 + y**2), sqrt((x - c) ** 2 + y**2)
    mu, nu = (r1 + r2) / (2 * c), (r1 - r2) / (2 * c)
    P = [
        c * nu * px + wrong * c * mu * sqrt((1 - nu**2) / (mu**2 - 1)) * py,
        c * mu * px - c * nu * sqrt((mu**2 - 1) / (1 - nu**2)) * py,
    ]
    return canonicity([mu, nu], P, [x, y], [px, py])


def test_spheroidal_coordinates_from_two_distances():
    above = sp.Symbol("y", positive=True)
    assert vanishes(spheroidal(y).xreplace({y: above})).holds
    assert vanishes(spheroidal(y, wrong=-1).xreplace({y: above})).fails


def parabolic(y):
    r = sqrt(x**2 + y**2)
    xi, eta = sqrt(r + x), sqrt(r - x)
    return canonicity([xi, eta], [xi * px + eta * py, -eta * px + xi * py], [x, y], [px, py])


def test_parabolic_coordinates_need_one_half_plane():
    assert vanishes(parabolic(y), Domain(conditions=(y > 0,))).holds
    assert vanishes(parabolic(y)).fails


def test_separatrix_of_the_pendulum():
    rate = sqrt(g / l)
    theta, momentum = 2 * atan(sinh(rate * t)), 2 * m * l**2 * rate / cosh(rate * t)
    assert equal(theta.diff(t), momentum / (m * l**2)).holds
    assert equal(momentum.diff(t), -m * g * l * sin(theta)).holds
    wrong = 2 * atan(tanh(rate * t))
    assert equal(wrong.diff(t), momentum / (m * l**2)).fails


@pytest.mark.parametrize(("factor", "holds"), [(1, True), (2, False)])
def test_oscillator_phase_and_action(factor, holds):
    Q, P = atan(alpha * q / p), factor * alpha * q**2 / 2 * (1 + p**2 / (alpha**2 * q**2))
    assert equal(bracket(Q, P, [q], [p]), sp.Integer(1)).holds is holds


@pytest.mark.parametrize(("sign", "holds"), [(-1, True), (1, False)])
def test_oscillator_generating_function_of_the_fourth_kind(sign, holds):
    above = sp.Symbol("q", positive=True)
    P = sp.Symbol("P", positive=True)
    F = (
        sign
        * (p * sqrt(2 * m * omega * P - p**2) / 2 + m * omega * P * asin(p / sqrt(2 * m * omega * P)))
        / (m * omega)
    )
    action = (p**2 + m**2 * omega**2 * above**2) / (2 * m * omega)
    rules = [
        above + F.diff(p).xreplace({P: action}),
        -atan(p / (m * omega * above)) - F.diff(P).xreplace({P: action}),
    ]
    assert [vanishes(rule).holds for rule in rules] == [holds, holds]


def test_gauge_term_of_a_vortex():
    vx, vy, kappa = sp.symbols("v_x v_y kappa", real=True)
    F = kappa * atan2(y, x)
    rate = F.diff(x) * vx + F.diff(y) * vy
    assert equal(rate, kappa * (x * vy - y * vx) / (x**2 + y**2)).holds
    assert equal(rate, kappa * (x * vy + y * vx) / (x**2 + y**2)).fails


def test_landen():
    k2 = sp.Symbol("m", positive=True)
    below_one = Domain(conditions=(k2 < 1,))
    complement = sqrt(1 - k2)
    ratio = (1 - complement) / (1 + complement)
    assert equal(elliptic_k(k2), 2 / (1 + complement) * elliptic_k(ratio**2), below_one).holds
    assert equal(elliptic_k(k2), 2 / (1 + complement) * elliptic_k(ratio), below_one).fails


def test_runge_lenz_vector():
    qs, ps = sp.symbols("x y z", real=True), sp.symbols("p_x p_y p_z", real=True)
    k = sp.Symbol("k", positive=True)
    r = sqrt(sum(s**2 for s in qs))
    H = sum(s**2 for s in ps) / (2 * m) - k / r
    L = sp.Matrix(qs).cross(sp.Matrix(ps))
    A = sp.Matrix(ps).cross(L) - m * k * sp.Matrix(qs) / r
    assert vanishes(bracket(A[0], H, qs, ps)).holds
    assert equal(bracket(A[0], A[1], qs, ps), -2 * m * H * L[2]).holds
    assert equal(bracket(A[0], A[1], qs, ps), 2 * m * H * L[2]).fails


def test_heavy_top_legendre_transform():
    theta = sp.Symbol("theta", real=True)
    I1, I3, M = sp.symbols("I1 I3 M", positive=True)
    pt, pf, ps = sp.symbols("p_theta p_phi p_psi", real=True)
    phi_dot = (pf - ps * cos(theta)) / (I1 * sin(theta) ** 2)
    psi_dot = ps / I3 - phi_dot * cos(theta)
    T = (
        I1 * ((pt / I1) ** 2 + phi_dot**2 * sin(theta) ** 2) / 2
        + I3 * (psi_dot + phi_dot * cos(theta)) ** 2 / 2
    )
    H = pt**2 / (2 * I1) + (pf - ps * cos(theta)) ** 2 / (2 * I1 * sin(theta) ** 2) + ps**2 / (2 * I3)
    upright = Domain(conditions=(theta > 0, theta < sp.pi))
    assert equal(pt * pt / I1 + pf * phi_dot + ps * psi_dot - T, H, upright).holds
    assert equal(pt * pt / I1 + pf * phi_dot + ps * psi_dot - T, H + M * cos(theta), upright).fails


def test_time_dependent_scaling():
    rho = Function("rho")
    Q, P = q / rho(t), rho(t) * p - m * rho(t).diff(t) * q
    assert equal(bracket(Q, P, [q], [p]), sp.Integer(1)).holds
    assert equal(bracket(Q, P / 2, [q], [p]), sp.Integer(1)).fails


@pytest.mark.parametrize("steps", [1, 2])
def test_leapfrog_is_symplectic(steps):
    """The pendulum's leapfrog map, its Jacobian taken of the composed map."""
    h = sp.Symbol("h", positive=True)
    Q, P = q, p
    for _ in range(steps):
        P = P - h / 2 * sin(Q)
        Q = Q + h * P
        P = P - h / 2 * sin(Q)
    M = sp.Matrix([Q, P]).jacobian([q, p])
    assert vanishes(sp.Matrix([M.det() - 1])).holds
    assert vanishes(sp.Matrix([M.det() - 1 - h**9 / 10**12])).fails
