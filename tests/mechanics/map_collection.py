"""Canonical maps, the types of generating function that each has, and twins that are not canonical.

Shared by the tests and by ``benchmarks/canonical.py``. The types were worked out by hand from the blocks of
the Jacobian: F₁ needs ∂Q/∂p regular, F₂ ∂P/∂p, F₃ ∂Q/∂q, F₄ ∂P/∂q.
"""

from dataclasses import dataclass, field

import sympy as sp
from sympy import acot, atan, atan2, cos, cosh, cot, exp, log, sin, sinh, sqrt

from canon.expression.symbols.symbol import time as t
from canon.mechanics.canonical.transformation import CanonicalTransformation, point_transformation
from canon.proof.domain.domain import Domain

q, p = sp.symbols("q p", real=True)
qp = sp.Symbol("q", positive=True)
x, y, z, px, py, pz = sp.symbols("x y z p_x p_y p_z", real=True)
r, theta, phi, pr, pth, pphi = sp.symbols("r theta phi p_r p_theta p_phi", real=True)
rp = sp.Symbol("r", positive=True)
u, v, pu, pv = sp.symbols("u v p_u p_v", real=True)
up, vp = sp.symbols("u v", positive=True)
m, w, k, a, h, g = sp.symbols("m omega k a h g", positive=True)
b = sp.Symbol("b", real=True)


@dataclass(frozen=True)
class Case:
    """A map, its types, and a twin that must be refused."""

    map: CanonicalTransformation
    kinds: frozenset[int]
    twins: tuple[CanonicalTransformation, ...] = field(default=())


def single(Q, P, kinds, *twins, old=q, momentum=p, domain=None):
    """One degree of freedom; each twin is a pair (Q, P)."""
    wrong = tuple(CanonicalTransformation(old, momentum, *twin, domain=domain) for twin in twins)
    return Case(CanonicalTransformation(old, momentum, Q, P, domain=domain), frozenset(kinds), wrong)


def lifted(old, momenta, new, kinds, domain=None):
    """A point transformation; its twin has one momentum doubled."""
    T = point_transformation(old, momenta, new, domain=domain)
    twin = CanonicalTransformation(T.q, T.p, T.new_q, (2 * T.new_p[0], *T.new_p[1:]), domain=domain)
    return Case(T, frozenset(kinds), (twin,))


E = (p**2 + m**2 * w**2 * qp**2) / (2 * m * w)
up_to_pi = Domain((p > 0, p < sp.pi))
quarter = Domain((p > 0, p < sp.pi / 2))
upper = Domain((p > 0,))

NOTES = {
    "oscillator": single(acot(p / (m * w * qp)), E, {1, 2, 3, 4}, (acot(p / (m * w * qp)), 2 * E), old=qp),
    "square roots": single(
        sqrt(2 * qp / k) * cos(p),
        sqrt(2 * k * qp) * sin(p),
        {1, 2, 3, 4},
        (sqrt(2 * qp / k) * cos(p), sqrt(k * qp) * sin(p)),
        (sqrt(2 * qp / k) * sin(p), sqrt(2 * k * qp) * cos(p)),
        old=qp,
        domain=quarter,
    ),
    "log of 1 + sqrt(q) cos p": single(
        log(1 + sqrt(qp) * cos(p)),
        2 * sqrt(qp) * sin(p) * (1 + sqrt(qp) * cos(p)),
        {1, 2, 3, 4},
        (log(1 + sqrt(qp) * cos(p)), sqrt(qp) * sin(p) * (1 + sqrt(qp) * cos(p))),
        old=qp,
        domain=quarter,
    ),
    "log of sin p / q": single(
        log(sin(p) / qp),
        qp * cot(p),
        {1, 2, 3, 4},
        (log(sin(p) / qp), qp * sp.tan(p)),
        old=qp,
        domain=quarter,
    ),
    "action and minus angle": single(
        (q**2 + p**2) / 2, -atan(q / p), {1, 2, 3, 4}, ((q**2 + p**2) / 2, atan(q / p))
    ),
}

ELEMENTARY = {
    "identity": single(q, p, {2, 3}, (q, -p)),
    "exchange": single(p, -q, {1, 4}, (p, q)),
    "scaling": single(a * q, p / a, {2, 3}, (a * q, a * p)),
    "alpha p / x": single(a * p / qp, -(qp**2) / (2 * a), {1, 3, 4}, (a * p / qp, qp**2 / (2 * a)), old=qp),
    "gauge": single(q, p - q**3, {2, 3, 4}, (q, p - q**3 * p)),
    "shear in p": single(q + p**2, p, {1, 2, 3}, (q + p**2 * q, p)),
    "rotation of phase space": single(
        q * cos(b) + p * sin(b),
        p * cos(b) - q * sin(b),
        {1, 2, 3, 4},
        (q * cos(b) + p * sin(b), p * cos(b) + q * sin(b)),
    ),
    "dilation and log": single(log(qp), qp * p, {2, 3, 4}, (log(qp), p), old=qp),
    "oscillator with atan": single(
        -atan(p / (m * w * qp)), E, {1, 2, 3, 4}, (atan(p / (m * w * qp)), E), old=qp
    ),
    "oscillator with atan2": single(
        atan2(m * w * q, p),
        (p**2 + m**2 * w**2 * q**2) / (2 * m * w),
        {1, 2, 3, 4},
        (atan2(p, m * w * q), (p**2 + m**2 * w**2 * q**2) / (2 * m * w)),
        domain=Domain((q > 0, p > 0)),
    ),
    "Poincare": single(
        sqrt(2 * sp.Symbol("p", positive=True)) * sin(q),
        sqrt(2 * sp.Symbol("p", positive=True)) * cos(q),
        {1, 2, 3, 4},
        (sqrt(2 * sp.Symbol("p", positive=True)) * cos(q), sqrt(2 * sp.Symbol("p", positive=True)) * sin(q)),
        momentum=sp.Symbol("p", positive=True),
        domain=Domain((q > 0, q < sp.pi / 2)),
    ),
    "exponential": single(exp(q), p * exp(-q), {2, 3, 4}, (exp(q), p * exp(q))),
    "hyperbolic rotation": single(
        q * cosh(b) + p * sinh(b),
        q * sinh(b) + p * cosh(b),
        {1, 2, 3, 4},
        (q * cosh(b) + p * sinh(b), p * cosh(b) - q * sinh(b)),
    ),
}

MOVING = {
    "Galilean boost": single(q - b * t, p - m * b, {2, 3}, (q - b * t, 2 * p - m * b)),
    "free motion": single(q + p * t / m, p, {1, 2, 3}, (q + p * t / m, p - q)),
    "fall": single(
        q + p * t / m - g * t**2 / 2,
        p - m * g * t,
        {1, 2, 3},
        (q + p * t / m - g * q * t**2 / 2, p - m * g * t),
    ),
    "oscillator's motion": single(
        q * cos(w * t) + p * sin(w * t) / (m * w),
        p * cos(w * t) - m * w * q * sin(w * t),
        {1, 2, 3, 4},
        (q * cos(w * t) + p * sin(w * t), p * cos(w * t) - m * w * q * sin(w * t)),
    ),
    "moving scale": single(
        q / sp.Function("rho")(t),
        sp.Function("rho")(t) * p - m * sp.Function("rho")(t).diff(t) * q,
        {2, 3, 4},
        (q / sp.Function("rho")(t), sp.Function("rho")(t) ** 2 * p - m * sp.Function("rho")(t).diff(t) * q),
    ),
    "damping": single(
        q * exp(a * t / 2), p * exp(-a * t / 2), {2, 3}, (q * exp(a * t / 2), p * exp(a * t / 2))
    ),
}

STEPS = {
    "symplectic Euler step": single(
        q + h * (p - h * sin(q)), p - h * sin(q), {1, 2, 3, 4}, (q + h * p, p - h * sin(q))
    ),
    "leapfrog step": single(
        q + h * (p - h * q**3 / 2),
        p - h * q**3 / 2 - h * (q + h * (p - h * q**3 / 2)) ** 3 / 2,
        {1, 2, 3, 4},
        (q + h * p, p - h * q**3 / 2 - h * (q + h * p) ** 3 / 2),
    ),
}


def _rotating():
    c, s = cos(w * t), sin(w * t)
    new, old = (x * c + y * s, -x * s + y * c), (px * c + py * s, -px * s + py * c)
    T = CanonicalTransformation((x, y), (px, py), new, old)
    return Case(T, frozenset({2, 3}), (CanonicalTransformation((x, y), (px, py), new, (old[1], old[0])),))


def _delaunay():
    """(l, g, h; L, G, H) → (λ, −ϖ, −Ω; Λ, Λ − G, G − H)."""
    angles, actions = sp.symbols("l g_1 h_1", real=True), sp.symbols("L G H", real=True)
    l_, g_, h_ = angles
    L, G, H = actions
    new, momenta = (l_ + g_ + h_, -g_ - h_, -h_), (L, L - G, G - H)
    T = CanonicalTransformation(angles, actions, new, momenta)
    twin = CanonicalTransformation(angles, actions, new, (L, G - L, G - H))
    return Case(T, frozenset({2, 3}), (twin,))


def _toda_like():
    """Q₁ = x², Q₂ = x + y and momenta with an added gradient."""
    T = CanonicalTransformation((x, y), (px, py), (x**2, x + y), ((px - py) / (2 * x), py + (x + y) ** 2))
    twin = CanonicalTransformation((x, y), (px, py), (x**2, x + y), ((px - py) / x, py + (x + y) ** 2))
    return Case(T, frozenset({2, 3, 4}), (twin,))


def _exchange_of_one():
    T = CanonicalTransformation((x, y), (px, py), (px, y), (-x, py))
    twin = CanonicalTransformation((x, y), (px, py), (px, y), (x, py))
    return Case(T, frozenset(), (twin,))


def linear_symplectic(n):
    """A product of shears with integer entries: canonical, of size 2n."""
    qs, ps = sp.symbols(f"q1:{n + 1}", real=True), sp.symbols(f"p1:{n + 1}", real=True)
    S = sp.Matrix(n, n, lambda i, j: ((i + 1) * (j + 1) + i + j) % 5 - 2)
    R = sp.Matrix(n, n, lambda i, j: (i * j + 2 * (i + j)) % 3 - 1)
    one, zero = sp.eye(n), sp.zeros(n, n)
    M = one.row_join(S).col_join(zero.row_join(one)) * one.row_join(zero).col_join(R.row_join(one))
    images = M * sp.Matrix([*qs, *ps])
    T = CanonicalTransformation(qs, ps, tuple(images[:n]), tuple(images[n:]))
    twin = CanonicalTransformation(qs, ps, tuple(images[:n]), (*images[n:-1], images[-1] + qs[0]))
    return Case(T, frozenset(), (twin,))


SEVERAL = {
    "rotating frame": _rotating(),
    "polar to Cartesian": lifted(
        (rp, phi), (pr, pphi), (rp * cos(phi), rp * sin(phi)), {2, 3, 4}, Domain((phi > 0, phi < sp.pi / 2))
    ),
    "Cartesian to polar": lifted(
        (x, y), (px, py), (sqrt(x**2 + y**2), atan2(y, x)), {2, 3, 4}, Domain((x > 0, y > 0))
    ),
    "spherical to Cartesian": lifted(
        (rp, theta, phi),
        (pr, pth, pphi),
        (rp * sin(theta) * cos(phi), rp * sin(theta) * sin(phi), rp * cos(theta)),
        {2, 3, 4},
        Domain((theta > 0, theta < sp.pi / 2, phi > 0, phi < sp.pi / 2)),
    ),
    "parabolic to Cartesian": lifted((up, vp), (pu, pv), ((up**2 - vp**2) / 2, up * vp), {2, 3, 4}),
    "elliptic to Cartesian": lifted(
        (up, v),
        (pu, pv),
        (a * cosh(up) * cos(v), a * sinh(up) * sin(v)),
        {2, 3, 4},
        Domain((v > 0, v < sp.pi / 2)),
    ),
    "Levi-Civita": lifted((up, vp), (pu, pv), (up**2 - vp**2, 2 * up * vp), {2, 3, 4}),
    "Delaunay": _delaunay(),
    "squares and sums": _toda_like(),
    "exchange of one": _exchange_of_one(),
}

MAPS = {**NOTES, **ELEMENTARY, **MOVING, **STEPS, **SEVERAL}
