"""The laws of the brackets on generated functions, and what breaks them."""

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.expression.symbols.symbol import time
from canon.mechanics.canonical import bracket_law as law
from canon.mechanics.canonical.inverse.inverse_transformation import inverse_transformation
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.mechanics.hamilton.bracket import (
    lagrange_bracket,
    lagrange_matrix,
    lie_bracket,
    poisson_bracket,
    poisson_matrix,
    symplectic_unit,
)
from canon.mechanics.hamilton.vector_field import VectorField, hamiltonian_field
from canon.proof.domain.domain import Domain
from canon.proof.vanish import vanishes

x, y, px, py = z = sp.symbols("x y px py", real=True)
Q1, Q2, P1, P2 = sp.symbols("Q1 Q2 P1 P2", real=True)
q, p = (x, y), (px, py)
u, v, w = (sp.Function(name)(x, y, px, py, time) for name in "uvw")

powers = st.integers(0, 2)
term = st.tuples(
    st.integers(-3, 3), powers, powers, powers, powers, st.sampled_from(["1", "sin", "exp", "t"])
)


@st.composite
def functions(draw, most=2):
    """Sums of monomials in q, p, times an elementary function or the time."""
    total = sp.S.Zero
    for c, a, b, d, e, kind in draw(st.lists(term, min_size=1, max_size=most)):
        factor = {"1": 1, "sin": sp.sin(x + 2 * py), "exp": sp.exp(px), "t": time}[kind]
        total += c * x**a * y**b * px**d * py**e * factor
    return total


LAWS = {
    "antisymmetry": lambda f, g, h: law.antisymmetry(f, g, q, p),
    "bilinearity": lambda f, g, h: law.bilinearity([f, g], [3, time], h, q, p),
    "Leibniz": lambda f, g, h: law.leibniz_rule(f, g, h, q, p),
    "Jacobi": lambda f, g, h: law.jacobi_identity(f, g, h, q, p),
    "the time": lambda f, g, h: law.time_rule(f, g, q, p),
}


@pytest.mark.parametrize("name", LAWS)
@settings(max_examples=50, deadline=None)
@given(functions(), functions(), functions())
def test_laws_of_poissons_bracket(name, f, g, h):
    assert LAWS[name](f, g, h).holds


def test_laws_for_arbitrary_functions():
    assert law.antisymmetry(u, v, q, p).holds
    assert law.leibniz_rule(u, v, w, q, p).holds
    assert law.jacobi_identity(u, v, w, q, p).holds
    assert law.time_rule(u, v, q, p).holds


def test_coefficients_that_move_break_bilinearity():
    assert law.bilinearity([x**2], [px], x, q, p).fails


def test_fundamental_brackets_and_their_twin():
    assert law.fundamental_brackets(q, p, q, p).holds
    assert law.fundamental_brackets(p, q, q, p).fails
    assert law.fundamental_brackets([x, y], [py, px], q, p).fails


def test_angular_momentum_algebra():
    r = sp.symbols("x1:4", real=True)
    m = sp.symbols("p1:4", real=True)
    L = [r[1] * m[2] - r[2] * m[1], r[2] * m[0] - r[0] * m[2], r[0] * m[1] - r[1] * m[0]]
    assert vanishes(poisson_bracket(L[0], L[1], r, m) - L[2]).holds
    assert vanishes(poisson_bracket(L[0], L[1], r, m) + L[2]).fails
    assert vanishes(poisson_bracket(sum(c**2 for c in L), L[0], r, m)).holds


SHEAR = CanonicalTransformation(q, p, (x + 2 * y, y), (px, py - 2 * px + x**2))
SCALED = CanonicalTransformation(q, p, (2 * x, y), (px, py))


@settings(max_examples=50, deadline=None)
@given(functions(), functions())
def test_brackets_are_invariant_under_canonical_maps(f, g):
    exchange = CanonicalTransformation(q, p, (px, y), (-x, py))
    to_new = dict(zip(z, (Q1, Q2, P1, P2), strict=True))
    f, g = f.subs(to_new, simultaneous=True), g.subs(to_new, simultaneous=True)
    assert law.invariance(f, g, exchange, [Q1, Q2], [P1, P2]).holds


def test_brackets_are_invariant_where_the_map_is_meant():
    """√q² is q for q > 0 and −q beyond: canonical here, of valence −1 there, and neither everywhere."""
    u, v, U, V = sp.symbols("u v U V", real=True)

    def modulus(domain=None):
        return CanonicalTransformation(u, v, sp.sqrt(u**2), v, domain)

    right = modulus(Domain([u > 0]))
    assert law.invariance(U * V, V**2, right, [U], [V]).holds
    assert law.invariance(U * V, V**2, right, [U], [V], Domain([u < 0])).fails
    assert law.invariance(U * V, V**2, modulus(), [U], [V]).fails


def test_old_variables_are_no_names_for_new_ones():
    u, v = sp.symbols("u v", real=True)
    exchange = CanonicalTransformation(u, v, v, -u)
    for new_q, new_p in (([u], [v]), ([v], [u]), ([u], [sp.Symbol("V")]), ([sp.Symbol("U")], [v])):
        with pytest.raises(ValueError, match="none of them an old variable"):
            inverse_transformation(exchange, new_q, new_p)


def test_brackets_are_not_invariant_under_others():
    assert law.invariance(Q1, P1, SCALED, [Q1, Q2], [P1, P2]).fails
    assert not SHEAR.is_canonical().holds


@pytest.mark.parametrize("T", [SHEAR, SCALED], ids=["shear", "scaled"])
def test_lagranges_brackets_invert_poissons(T):
    inverse = inverse_transformation(T, (Q1, Q2), (P1, P2))
    assert law.lagrange_inverts_poisson(T, inverse).holds
    transposed = CanonicalTransformation(inverse.q, inverse.p, inverse.new_p, inverse.new_q)
    assert law.lagrange_inverts_poisson(T, transposed).fails


def test_matrices_of_the_canonical_variables():
    assert poisson_matrix(z, q, p) == symplectic_unit(2)
    assert lagrange_matrix(z, q, p) == symplectic_unit(2)
    assert poisson_matrix([x, x * px], q, p) == sp.Matrix([[0, x], [-x, 0]])


def test_lagrange_bracket_of_polar_oscillator_variables():
    P = sp.Symbol("P", positive=True)
    value = lagrange_bracket(Q1, P, [sp.sqrt(2 * P) * sp.sin(Q1)], [sp.sqrt(2 * P) * sp.cos(Q1)])
    assert vanishes(value - 1).holds
    assert vanishes(value + 1).fails


@settings(max_examples=50, deadline=None)
@given(functions(most=1), functions(most=1), functions(most=1), functions(most=1))
def test_jacobi_identity_of_vector_fields(a, b, c, d):
    X, Y, Z = (a, b, 0, 1), (0, c, d, x), (y, 0, a, px)
    assert law.lie_jacobi_identity(X, Y, Z, z).holds


def test_the_lie_bracket_is_the_commutator():
    f = sp.Function("f")(*z)
    X, Y = VectorField((x * y, px, 0, sp.sin(x)), z), VectorField((1, x * py, y, 0), z)
    assert vanishes(X(Y(f)) - Y(X(f)) - X.bracket(Y)(f)).holds
    assert vanishes(X(Y(f)) - Y(X(f)) + X.bracket(Y)(f)).fails
    assert (X + Y).components[0] == x * y + 1


@settings(max_examples=50, deadline=None)
@given(functions(), functions())
def test_hamiltonian_fields_go_against_the_brackets(f, g):
    both = hamiltonian_field(f, q, p).bracket(hamiltonian_field(g, q, p))
    of_bracket = hamiltonian_field(poisson_bracket(f, g, q, p), q, p)
    assert all(vanishes(a + b).holds for a, b in zip(both.components, of_bracket.components, strict=True))


@pytest.mark.parametrize(
    "make",
    [
        lambda: poisson_bracket(x, y, [x, y], [px]),
        lambda: lagrange_bracket(x, y, [x], [px, py]),
        lambda: lie_bracket([x], [y, x], [x, y]),
        lambda: VectorField([x], [x, y]),
        lambda: VectorField([x, y], [x]),
        lambda: VectorField([x], [x]).bracket(VectorField([y], [y])),
    ],
)
def test_mismatched_lengths_are_refused(make):
    with pytest.raises(ValueError, match=r"\d|different"):
        make()
