"""Published normal forms reproduced: the Toda lattice of three particles, whose cubic part is Hénon and Heiles' system.

The numbers are those that A. S. Nikolaev's programs in FORM print for the normal form by Dragt and Finn's products of
exponentials, and for Gustavson's integral (arXiv:1307.3368; demo-kato-nonlinear-classic, commit 1ff4f474,
symbolic/Toda2d_DragtFinn.log): other software by other people. Of the normal form each pair of conjugate
terms stands once; z = q + i p and w is its conjugate. x, y, p, r are q₁, q₂, p₁, p₂.
"""

import re

import pytest
import sympy as sp

from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.perturbation.birkhoff import birkhoff_normal_form
from canon.mechanics.perturbation.gustavson import formal_integral

x, y, p, r = sp.symbols("x y p r", real=True)
DEGREE = 12

NORMAL_FORM = """
1/12 z1^2 w1^2; -1/12 z1^2 w2^2; 1/3 z1 z2 w1 w2; 1/12 z2^2 w2^2;
5/216 z1^3 w1^3; 7/72 z1^3 w1 w2^2; -1/8 z1^2 z2 w1^2 w2; 7/72 z1^2 z2 w2^3; -1/8 z1 z2^2 w1 w2^2; 5/216 z2^3
w2^3;
-515/7776 z1^4 w1^4; -151/1296 z1^4 w1^2 w2^2; 313/7776 z1^4 w2^4; -31/972 z1^3 z2 w1^3 w2; -383/972 z1^3 z2 w1
w2^3; 67/216 z1^2 z2^2 w1^2 w2^2; -151/1296 z1^2 z2^2 w2^4; -31/972 z1 z2^3 w1 w2^3; -515/7776 z2^4 w2^4;
10759/93312 z1^5 w1^5; 61/729 z1^5 w1^3 w2^2; -24703/93312 z1^5 w1 w2^4; 38179/93312 z1^4 z2 w1^4 w2; 2777/2916
z1^4 z2 w1^2 w2^3; -13579/93312 z1^4 z2 w2^5; -5183/23328 z1^3 z2^2 w1^3 w2^2; 24997/23328 z1^3 z2^2 w1 w2^4;
-16307/23328 z1^2 z2^3 w1^2 w2^3; 1025/23328 z1^2 z2^3 w2^5; 45595/93312 z1 z2^4 w1 w2^4; 10759/93312 z2^5 w2^5;
-144683/839808 z1^6 w1^6; 95591/933120 z1^6 w1^4 w2^2; 2513711/2799360 z1^6 w1^2 w2^4; -34997/419904 z1^6 w2^6;
-1733603/1399680 z1^5 z2 w1^5 w2; -1954153/1399680 z1^5 z2 w1^3 w2^3; 26449/15552 z1^5 z2 w1 w2^5; -27781/17496
z1^4 z2^2 w1^4 w2^2; -75313/15552 z1^4 z2^2 w1^2 w2^4; 847229/2799360 z1^4 z2^2 w2^6; 315455/104976 z1^3 z2^3
w1^3 w2^3; -836549/466560 z1^3 z2^3 w1 w2^5; 55499/139968 z1^2 z2^4 w1^2 w2^4; 842267/2799360 z1^2 z2^4 w2^6;
-2289097/1399680 z1 z2^5 w1 w2^5; -144683/839808 z2^6 w2^6;
"""
INTEGRAL = """
1/12 x^4; 1/6 x^2 y^2; 1/6 x^2 p^2; 1/2 x^2 r^2; -2/3 x y p r; 1/12 y^4; 1/2 y^2 p^2; 1/6 y^2 r^2; 1/12 p^4; 1/6
p^2 r^2; 1/12 r^4;
1/3 x^4 y; -2/3 x^3 p r; 2/9 x^2 y^3; 1 x^2 y p^2; 5/3 x^2 y r^2; -2/3 x y^2 p r; -4/9 x p^3 r; 4/3 x p r^3;
-1/9 y^5; -7/9 y^3 p^2; -1/9 y^3 r^2; 4/9 y p^4; -4/3 y p^2 r^2;
35/216 x^6; 59/72 x^4 y^2; 35/72 x^4 p^2; 7/72 x^4 r^2; -11/9 x^3 y p r; 19/72 x^2 y^4; -5/12 x^2 y^2 p^2; 19/12
x^2 y^2 r^2; 31/72 x^2 p^4; -11/4 x^2 p^2 r^2; -101/72 x^2 r^4; 13/9 x y^3 p r; 17/9 x y p^3 r; 49/9 x y p r^3;
43/216 y^6; 31/72 y^4 p^2; 11/72 y^4 r^2; -133/72 y^2 p^4; -1/12 y^2 p^2 r^2; -1/72 y^2 r^4; 31/216 p^6; -65/72
p^4 r^2; 95/72 p^2 r^4; -1/216 r^6;
"""


def told(text, names):
    """Return the coefficients of a printed polynomial by their exponents."""
    found = {}
    for term in filter(None, (each.strip() for each in re.sub(r"\s+", " ", text).split(";"))):
        number, *factors = term.split()
        powers = dict(([*factor.split("^"), "1"])[:2] for factor in factors)
        found[tuple(int(powers.get(name, 0)) for name in names)] = sp.Rational(number)
    return found


def toda(degree):
    """[exp(2y + 2√3 x) + exp(2y − 2√3 x) + exp(−4y)]/24 − 1/8 + T, its Taylor series to a degree."""

    def exponential(u):
        return sum(u**k / sp.factorial(k) for k in range(degree + 1))

    cosine = sum((12 * x**2) ** k / sp.factorial(2 * k) for k in range(degree // 2 + 1))
    series = sp.Poly(exponential(2 * y) * cosine / 12 + exponential(-4 * y) / 24, x, y)
    potential = sp.Add(*(c * x**i * y**j for (i, j), c in series.terms() if 0 < i + j <= degree))
    return Hamiltonian((p**2 + r**2) / 2 + potential, [x, y], [p, r])


@pytest.fixture(scope="module")
def form():
    return birkhoff_normal_form(toda(DEGREE), DEGREE)


def test_all_coefficients_of_the_normal_form_to_degree_twelve(form):
    published = told(NORMAL_FORM, ("z1", "z2", "w1", "w2"))
    assert len(published) == 47
    published |= {(c, d, a, b): value for (a, b, c, d), value in published.items()}
    found = sp.Poly(form.K, *form.complex_variables)
    assert {k: c for k, c in found.terms() if sum(k) > 2} == published


def test_gustavsons_integral_of_the_toda_lattice(form):
    """It is H − I over the square of the small parameter there."""
    published = told(INTEGRAL, ("x", "y", "p", "r"))
    assert len(published) == 48
    found = sp.Poly(sp.expand(form.source.H - formal_integral(form).expression), x, y, p, r)
    assert {k: c for k, c in found.terms() if sum(k) <= 6} == published


def test_the_cubic_part_alone_has_another_normal_form(form):
    """Hénon and Heiles' system shares the cubic terms only: the fourth degree is another one already."""
    cubic = birkhoff_normal_form(toda(3), 4)
    fourth = sp.Poly(cubic.K, *cubic.complex_variables).coeff_monomial((2, 0, 2, 0))
    assert fourth == -sp.Rational(5, 48)
    assert told(NORMAL_FORM, ("z1", "z2", "w1", "w2"))[(2, 0, 2, 0)] == sp.Rational(1, 12)
