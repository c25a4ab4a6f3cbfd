"""Centre manifolds: against the exact normal form, closed forms at L1, and the equations of motion."""

from dataclasses import replace

import mpmath as mp
import pytest
import sympy as sp
from flint import acb, arb
from hypothesis import given, settings
from hypothesis import strategies as st

from canon import Hamiltonian, birkhoff_normal_form
from canon.mechanics.perturbation.centre_reduction import centre_manifold
from canon.mechanics.perturbation.enclosed.enclosed_polynomial import FixedPointRing, PrecisionError
from canon.mechanics.perturbation.enclosed.enclosed_series import enclosed_parts
from canon.mechanics.perturbation.quadratic_form import NoDiagonalFormError
from canon.mechanics.perturbation.taylor_parts import NotAnalyticError
from canon.proof.domain.balls import precision

x, y, z, px, py, pz, mu = sp.symbols("x y z p_x p_y p_z mu", real=True)
MOON = sp.Rational("0.0121505856")
THREE_BODIES = Hamiltonian(
    (px**2 + py**2 + pz**2) / 2
    + y * px
    - x * py
    - (1 - mu) / sp.sqrt((x + mu) ** 2 + y**2 + z**2)
    - mu / sp.sqrt((x - 1 + mu) ** 2 + y**2 + z**2),
    [x, y, z],
    [px, py, pz],
)
NEAR_L1 = {x: 0.83, py: 0.83}


def at_l1(order, **choices):
    return centre_manifold(THREE_BODIES, order, at=NEAR_L1, parameters={mu: MOON}, **choices)


def of_exact_form(H, order):
    """Coefficients of the exact normal form where a = b = 0, in z with {z, z̄} = −2i, by exponents of z and z̄."""
    n = len(H.q)
    form = birkhoff_normal_form(H, order, resonances=[[int(i == j) for i in range(n)] for j in range(1, n)])
    ring = form.diagonal.eigenvalues[0].ring
    hyperbolic = [j for j in range(n) if not form.diagonal.is_elliptic(j)]
    assert hyperbolic == [0]
    elliptic = sorted(range(1, n), key=lambda j: -abs(float(form.diagonal.frequency(j))))
    kappas = [
        ring.expression(form.diagonal.brackets.constants[j], [sp.S.One] * 2 * n) / (-2 * sp.I)
        for j in elliptic
    ]
    symbols = form.complex_variables
    zero = {symbols[0]: 0, symbols[n]: 0}
    kept = [symbols[j] for j in elliptic] + [symbols[n + j] for j in elliptic]
    poly = sp.Poly(sp.expand(form.K.subs(zero)), *kept)
    return {
        powers: c
        * sp.prod(sp.sqrt(k) ** (powers[i] + powers[len(elliptic) + i]) for i, k in enumerate(kappas))
        for powers, c in poly.terms()
    }


def agrees(found, exact):
    with precision(found.bits):
        for powers, ball in found.coefficients.items():
            value = complex(sp.N(exact.get(powers, 0), 30))
            if abs(complex(ball) - value) > 1e-13 * (1 + abs(value)):
                return False
    return all(
        powers in found.coefficients or abs(sp.N(c)) < 1e-14 for powers, c in exact.items() if any(powers)
    )


SADDLE = (px**2 - x**2 + py**2 + 2 * y**2) / 2


@pytest.mark.parametrize("order", [3, 6, 9])
def test_a_saddle_and_a_centre_as_the_exact_form_has_them(order):
    H = Hamiltonian(SADDLE + x**2 * y - y**3 / 3 + x * y**2 / 2, [x, y], [px, py])
    found, exact = centre_manifold(H, order), of_exact_form(H, order)
    assert agrees(found, exact)
    twin = {k: (c if sum(k) < 3 else -c) for k, c in exact.items()}
    assert not agrees(found, twin)


@settings(max_examples=50, deadline=None)
@given(st.lists(st.integers(-3, 3), min_size=8, max_size=8))
def test_three_degrees_of_freedom_as_the_exact_form_has_them(numbers):
    terms = (x**2 * y, x * y * z, y**2 * z, z**3, x * px * y, y**4, x**2 * z**2, py * z * x)
    cubic = sum(c * term for c, term in zip(numbers, terms, strict=True))
    quadratic = (px**2 - x**2) / 2 + (py**2 + 9 * y**2) / 2 - (pz**2 + 4 * z**2) / 2
    H = Hamiltonian(quadratic + cubic, [x, y, z], [px, py, pz])
    assert agrees(centre_manifold(H, 4), of_exact_form(H, 4))


def test_exponents_at_l1_to_thirty_digits():
    """λ² = (c₂ − 2 + √(9c₂² − 8c₂))/2, ω_p² = (2 − c₂ + √(9c₂² − 8c₂))/2, ω_v² = c₂ (Szebehely, 5.3)."""
    found = at_l1(2, digits=32)
    with mp.workdps(60):
        m = mp.mpf(MOON.p) / MOON.q
        gamma = mp.findroot(
            lambda g: g**5 - (3 - m) * g**4 + (3 - 2 * m) * g**3 - m * g**2 + 2 * m * g - m, 0.15
        )
        c2 = m / gamma**3 + (1 - m) / (1 - gamma) ** 3
        root = mp.sqrt(9 * c2**2 - 8 * c2)
        wanted = [mp.sqrt((c2 - 2 + root) / 2), mp.sqrt((2 - c2 + root) / 2), mp.sqrt(c2)]
        places = [1 - m - gamma, 1 - m - gamma]
        with precision(found.bits):
            balls = [*found.rates, *found.frequencies, found.equilibrium[x], found.equilibrium[py]]
            for ball, value in zip(balls, [*wanted, *places], strict=True):
                assert abs(ball - arb(mp.nstr(value, 45))) < arb("1e-32")
                assert not ball.contains(arb(mp.nstr(value * (1 + mp.mpf(10) ** -25), 45)))


def errors_of_the_motion(found, scale, spoilt=0):
    """|H∘E − K| and |J ∇H(E) − DE J ∇K| at one direction from the equilibrium."""
    old, w = [x, y, z, px, py, pz], [*found.q, *found.p]
    H, K = THREE_BODIES.H.subs(mu, MOON), found.hamiltonian.H + spoilt * found.q[0] ** 3
    embedding = sp.Matrix([found.embedding[s] for s in old])
    with mp.workdps(40):
        at = dict(zip(w, [mp.mpf(scale) * mp.mpf(d) for d in ("0.3", "-0.5", "0.4", "0.7")], strict=True))
        names = (w, "mpmath")
        place = list(sp.lambdify(w, list(embedding), "mpmath")(*at.values()))
        centre = list(sp.lambdify(w, list(embedding), "mpmath")(*[0] * 4))
        energy = sp.lambdify(old, H, "mpmath")
        rates = sp.lambdify(old, [*(H.diff(p) for p in old[3:]), *(-H.diff(q) for q in old[:3])], "mpmath")
        inner = [*(K.diff(p) for p in found.p), *(-K.diff(q) for q in found.q)]
        pushed = sp.lambdify(w, embedding.jacobian(w) * sp.Matrix(inner), "mpmath")(*at.values())
        k = sp.lambdify(w, K, names[1])(*at.values())
        gap = abs(energy(*place) - energy(*centre) - k)
        return gap, max(abs(a - b) for a, b in zip(rates(*place), list(pushed), strict=True))


@pytest.mark.parametrize(
    "order", [4, pytest.param(5, marks=pytest.mark.slow), pytest.param(7, marks=pytest.mark.slow)]
)
def test_the_manifold_is_invariant_and_carries_the_motion(order):
    found = at_l1(order, digits=25)
    (energy, motion), (nearer, slower) = (errors_of_the_motion(found, s) for s in (0.004, 0.002))
    assert mp.log(energy / nearer, 2) == pytest.approx(order + 1, abs=0.1)
    assert mp.log(motion / slower, 2) == pytest.approx(order, abs=0.1)
    (energy, motion), (nearer, slower) = (errors_of_the_motion(found, s, spoilt=1e-3) for s in (0.004, 0.002))
    assert mp.log(energy / nearer, 2) < order
    assert mp.log(motion / slower, 2) < order - 0.5


def test_more_digits_lie_within_the_bounds_of_fewer():
    coarse, fine = at_l1(6), at_l1(6, digits=40)
    assert coarse.error < 1e-15
    assert fine.error < 1e-40
    with precision(fine.bits):
        for powers, ball in fine.coefficients.items():
            near = coarse.coefficients.get(powers, acb(0))
            assert abs(ball - near).abs_lower() <= arb(coarse.error) + arb(fine.error)


def test_coefficients_that_are_not_known_to_the_digits_are_not_given():
    found = centre_manifold(Hamiltonian(SADDLE + x**2 * y - y**3 / 3, [x, y], [px, py]), 4)
    assert found.hamiltonian.H.has(found.q[0])
    assert found.embedding[x] == 0  # x = p_x = 0 is invariant
    assert found.embedding[y].has(found.q[0])
    claimed = replace(found, digits=60)
    with pytest.raises(PrecisionError, match="more digits"):
        _ = claimed.hamiltonian
    with pytest.raises(PrecisionError, match="more digits"):
        _ = claimed.embedding


def test_a_part_without_terms_but_with_an_error_is_not_taken_for_zero():
    found = centre_manifold(Hamiltonian(SADDLE + x**2 * y - y**3 / 3, [x, y], [px, py]), 4)
    ring = found.parts[3].ring
    for error, kept in ((ring.unit >> 60, True), (ring.unit >> 40, False)):
        unsure = replace(found, parts={**found.parts, 3: replace(ring.zero, error=error)})
        if kept:
            assert unsure.hamiltonian.H.coeff(found.q[0], 3) == 0
        else:
            with pytest.raises(PrecisionError, match="known to within"):
                _ = unsure.hamiltonian


@pytest.mark.parametrize("j", range(4))
def test_an_embedding_with_wide_generators_is_not_given(j):
    found = centre_manifold(Hamiltonian(SADDLE + x**2 * y - y**3 / 3, [x, y], [px, py]), 4)
    degree, chi = found.generators[0]
    wide = replace(
        found, generators=((degree, replace(chi, error=chi.ring.unit >> 30)), *found.generators[1:])
    )
    assert wide.hamiltonian.H.has(found.q[0])
    with pytest.raises(PrecisionError, match="known to within"):
        wide._embedded(j, [x, y, px, py][j])


@pytest.mark.slow
def test_l1_to_degree_sixteen_with_fifteen_digits():
    found = at_l1(16)
    assert found.error < 1e-16
    assert sorted(found.parts) == [*range(2, 17)]
    lower = at_l1(10)
    with precision(found.bits):
        for powers, ball in lower.coefficients.items():
            assert abs(ball - found.coefficients[powers]).abs_lower() < arb("1e-15")


@settings(max_examples=50, deadline=None)
@given(
    st.sampled_from(
        [
            lambda u: 1 / (2 + u),
            lambda u: sp.sqrt(1 + u),
            lambda u: sp.exp(u),
            lambda u: sp.log(3 + u),
            lambda u: sp.sin(1 + u),
            lambda u: sp.cosh(u),
            lambda u: (2 + u) ** sp.Rational(-3, 2),
            lambda u: (1 + u) ** 3 * sp.cos(u),
            lambda u: sp.sinh(u / 2) + u**2,
        ]
    ),
    st.integers(-3, 3),
    st.integers(-3, 3),
)
def test_series_in_balls_are_those_of_taylor(function, a, b):
    ring = FixedPointRing(2, 96)
    f = function(a * x + b * x * y + y**2)
    with precision(160):
        parts = enclosed_parts(f, {x: ring.variable(0), y: ring.variable(1)}, {x: acb(0), y: acb(0)}, 4)
        for j in range(5):
            along_x = f.diff(x, j).subs(x, 0)
            for k in range(5 - j):
                exact = along_x.diff(y, k).subs(y, 0) / (sp.factorial(j) * sp.factorial(k))
                ball = parts[j + k].coefficients.get((j, k), acb(0)).real + arb(0, parts[j + k].bound)
                assert ball.overlaps(arb(str(sp.N(exact, 50))) + arb(0, 1e-40))
                assert parts[j + k].bound < 1e-20


@pytest.mark.parametrize(
    ("H", "error", "said"),
    [
        ((px**2 + x**2 + py**2 + y**2) / 2, NoDiagonalFormError, "equal"),
        ((px**2 + x**2 + py**2 + 2 * y**2) / 2, ValueError, "no hyperbolic direction"),
        ((px**2 + py**2 - x**2 + mu * y**2) / 2, ValueError, "mu has no value"),
        ((px**2 + py**2 + y**2) / 2, PrecisionError, "not isolated"),
        ((px**2 - x**2 + py**2 + y**2) / 2 + sp.Abs(x) * y, NotAnalyticError, "kink"),
        ((px**2 - x**2 + py**2 + y**2) / 2 + sp.gamma(2 + x) ** 2 * y**3, NotAnalyticError, "gamma"),
    ],
)
def test_what_has_no_centre_manifold_is_told(H, error, said):
    with pytest.raises(error, match=said):
        centre_manifold(Hamiltonian(H, [x, y], [px, py]), 4)


def test_orders_digits_and_times_are_looked_at():
    H = Hamiltonian(SADDLE, [x, y], [px, py])
    with pytest.raises(ValueError, match="whole number from 2"):
        centre_manifold(H, 1)
    with pytest.raises(ValueError, match="from 1 to 300"):
        centre_manifold(H, 4, digits=0)
    with pytest.raises(ValueError, match="more than memory holds"):
        centre_manifold(H, 200)
    with pytest.raises(ValueError, match="depends on the time"):
        centre_manifold(Hamiltonian(SADDLE + H.t, [x, y], [px, py], H.t), 4)
    with pytest.raises(PrecisionError, match=r"start nearer|does not end|not isolated"):
        centre_manifold(Hamiltonian(px**2 / 2 + sp.exp(x) + py**2 / 2 + y**2, [x, y], [px, py]), 3)
