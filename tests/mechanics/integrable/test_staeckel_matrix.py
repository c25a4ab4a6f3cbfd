"""Stäckel's matrix in three coordinates that do not come off one by one: ellipsoidal ones, and a field of gradients."""

import pytest
import sympy as sp

from canon.mechanics.hamilton.bracket import poisson_bracket
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.mechanics.integrable.separability import is_separable
from canon.mechanics.integrable.separated_momenta import NotSeparatedError
from canon.mechanics.integrable.staeckel_matrix import StaeckelMatrix, staeckel_matrix
from canon.proof.domain.domain import EVERYWHERE

A, B, C = 5, 7, 11
Q = sp.symbols("lambda mu nu", positive=True)
P = sp.symbols("p_lambda p_mu p_nu", real=True)
PLACE = dict(
    zip(
        (*Q, *P),
        (sp.Rational(3), sp.Rational(13, 2), sp.Rational(17, 2), sp.Rational(1, 3), sp.Rational(-2, 5), 1),
        strict=True,
    )
)


def cubic(x):
    return (x - A) * (x - B) * (x - C)


def ellipsoidal(potential, shift=lambda x: 0, extra=0):
    """Return H = Σ (2 f(λᵢ) (pᵢ + cᵢ)² + v(λᵢ)) / Π (λᵢ − λⱼ): Jacobi's coordinates (Vorlesungen über Dynamik, 26)."""
    terms = []
    for x, p in zip(Q, P, strict=True):
        y, z = (s for s in Q if s != x)
        terms.append((2 * cubic(x) * (p + shift(x)) ** 2 + potential(x)) / ((x - y) * (x - z)))
    return Hamiltonian(sp.Add(*terms) + extra, Q, P)


def test_constants_solve_for_the_separation_constant_whatever_factor_a_row_has():
    x, y, alpha, E = sp.symbols("x y alpha E", real=True)
    rows, v = ((2 * x, 3 * x**2), (y, 5 * y)), (x**2, y**3)
    a = -rows[1][0] / sp.Matrix(rows).det()
    squares = [row[0] * alpha + row[1] * E - each for row, each in zip(rows, v, strict=True)]
    (found,) = StaeckelMatrix((x, y), rows, v).constants(squares, a)
    assert sp.simplify(found - alpha) == 0


@pytest.mark.slow
def test_ellipsoidal_coordinates_separate_with_two_constants_in_involution():
    H = ellipsoidal(lambda x: x**3)
    found = hamilton_jacobi(H)
    first, second, _ = (found.defined_as[c] for c in found.constants)
    for f, g in ((first, second), (first, H.H), (second, H.H)):
        bracket = poisson_bracket(f, g, Q, P)
        assert bracket.subs(PLACE) == 0
        assert poisson_bracket(f, g + Q[0], Q, P).subs(PLACE) != 0


@pytest.mark.parametrize(
    "shift",
    [lambda x: 0, pytest.param(lambda x: x**2, marks=pytest.mark.slow)],
    ids=["none", "a gradient"],
)
def test_the_constants_of_a_place_give_its_momenta(shift):
    found = hamilton_jacobi(ellipsoidal(lambda x: x, shift))
    values = {c: f.subs(PLACE) for c, f in found.defined_as.items()}
    for momentum in found.momenta:
        root = momentum.square.subs(values).subs(PLACE)
        assert root == (momentum.p - momentum.shift).subs(PLACE) ** 2
        if momentum.constant is not None:
            assert momentum.defined_as.subs(PLACE) == values[momentum.constant]


def test_a_potential_of_another_kind_does_not_separate():
    H = ellipsoidal(lambda x: x**3, extra=Q[0] * Q[1])
    assert is_separable(H).fails
    with pytest.raises(NotSeparatedError, match="Levi-Civita"):
        hamilton_jacobi(H)
    coefficients = {x: H.H.diff(p, 2) / 2 for x, p in zip(Q, P, strict=True)}
    assert staeckel_matrix(coefficients, H.H.subs(dict.fromkeys(P, 0)), EVERYWHERE) is None


def test_the_constants_are_independent():
    found = hamilton_jacobi(ellipsoidal(lambda x: 0))
    roots = sp.Matrix([[m.square.diff(c) for c in found.constants] for m in found.momenta])
    assert roots.subs(PLACE).det() != 0
