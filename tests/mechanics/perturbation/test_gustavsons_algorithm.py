"""Gustavson's own route to the integral of Hénon and Heiles' system, to degree eight: mixed variables, no Lie series.

F. G. Gustavson, Astron. J. 71 (1966) 670, doi:10.1086/110172: F₂ = q P + W(q, P) is found degree by degree from
H(q, P + ∂W/∂q) = K(q + ∂W/∂P, P), and the integral is ½(P² + Q²) as a function of the old variables. Everything is
polynomials of SymPy over ℚ(i), truncated; of canon only the two results are used.
"""

import pytest
import sympy as sp
from sympy import QQ_I, Rational, ring

from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.perturbation.birkhoff import birkhoff_normal_form
from canon.mechanics.perturbation.gustavson import formal_integral

DEGREE = 8
x, y, p, r = NAMES = sp.symbols("x y p r", real=True)
RING, *VARIABLES = ring("x y p r", QQ_I)
HALF, THIRD = QQ_I.from_sympy(Rational(1, 2)), QQ_I.from_sympy(Rational(1, 3))
I = QQ_I.from_sympy(sp.I)
COEFFICIENTS = {(2, 1, 0, 0): QQ_I.one, (0, 3, 0, 0): -THIRD}
QUADRATIC = HALF * sum(v**2 for v in VARIABLES)


def product(f, g):
    """f g without what is beyond the degree."""
    found = {}
    for a, c in f.items():
        room = DEGREE - sum(a)
        for b, d in g.items():
            if sum(b) <= room:
                powers = tuple(i + j for i, j in zip(a, b, strict=True))
                found[powers] = found.get(powers, QQ_I.zero) + c * d
    return RING.from_dict(found)


def power(f, n, known):
    """fⁿ, with the powers that are known already."""
    if n not in known:
        known[n] = RING.one if n == 0 else product(power(f, n - 1, known), f)
    return known[n]


def composed(f, places):
    """f with a polynomial in the place of each variable."""
    known = [{} for _ in places]
    total = RING.zero
    for powers, c in f.items():
        term = RING.one
        for place, n, kept in zip(places, powers, known, strict=True):
            term = product(term, power(place, n, kept)) if n else term
        total += c * term
    return total


def part(f, degree):
    return RING.from_dict({powers: c for powers, c in f.items() if sum(powers) == degree})


def split(f):
    """Return W and K of f = K + (q ∂/∂P − P ∂/∂q) W, through the eigenvectors z = q + i P."""
    X, Y, P, R = VARIABLES
    in_z = composed(f, (HALF * (X + P), HALF * (Y + R), -HALF * I * (X - P), -HALF * I * (Y - R)))
    generator, kernel = {}, {}
    for (a, b, c, d), value in in_z.items():
        k = a + b - c - d
        if k:
            generator[a, b, c, d] = value / (I * k)
        else:
            kernel[a, b, c, d] = value
    back = (X + I * P, Y + I * R, X - I * P, Y - I * R)
    return composed(RING.from_dict(generator), back), composed(RING.from_dict(kernel), back)


def gustavson():
    """Return K(q, P) and the integral I(q, p), each to the degree."""
    X, Y, P, R = VARIABLES
    H = QUADRATIC + RING.from_dict(COEFFICIENTS)
    K, W = QUADRATIC, RING.zero
    for degree in range(3, DEGREE + 1):
        left = composed(H, (X, Y, P + W.diff(X), R + W.diff(Y)))
        right = composed(K, (X + W.diff(P), Y + W.diff(R), P, R))
        found, kept = split(part(left - right, degree))
        W, K = W + found, K + kept
    new = (P, R)
    for _ in range(DEGREE):
        new = tuple(old - composed(W.diff(q), (X, Y, *new)) for old, q in ((P, X), (R, Y)))
    moved = tuple(q + composed(W.diff(momentum), (X, Y, *new)) for q, momentum in ((X, P), (Y, R)))
    return K, composed(QUADRATIC, (*moved, *new))


def numbers(f):
    return {powers: QQ_I.to_sympy(c) for powers, c in f.items()}


@pytest.fixture(scope="module")
def by_gustavson():
    return tuple(map(numbers, gustavson()))


def canons_form(cubic):
    H = (x**2 + y**2 + p**2 + r**2) / 2 + cubic
    return birkhoff_normal_form(Hamiltonian(H, [x, y], [p, r]), DEGREE)


def coefficients(f):
    return {powers: c for powers, c in sp.Poly(sp.expand(f), *NAMES).terms() if sum(powers) <= DEGREE}


@pytest.fixture(scope="module")
def form():
    return canons_form(x**2 * y - y**3 / 3)


def test_all_coefficients_of_the_integral_of_henon_and_heiles(form, by_gustavson):
    """The integral is unique: what two normal forms differ by commutes with ½(P² + Q²)."""
    _, expected = by_gustavson
    assert [sum(sum(powers) == degree for powers in expected) for degree in range(2, 9)] == [
        4,
        2,
        11,
        13,
        24,
        29,
        45,
    ]
    assert coefficients(formal_integral(form).expression) == expected


def test_all_coefficients_of_the_normal_form_of_henon_and_heiles(form, by_gustavson):
    expected, _ = by_gustavson
    real = dict(
        zip(form.complex_variables, (x + sp.I * p, y + sp.I * r, x - sp.I * p, y - sp.I * r), strict=True)
    )
    assert coefficients(form.K.subs(real, simultaneous=True)) == expected


@pytest.mark.parametrize("cubic", [x**2 * y + y**3 / 3, x**2 * y - y**3 / 3 + x**8 / 1000])
def test_another_system_has_another_integral(cubic, by_gustavson):
    twin = formal_integral(canons_form(cubic)).expression
    assert coefficients(twin) != by_gustavson[1]
