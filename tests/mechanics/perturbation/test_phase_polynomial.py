"""Phase-space polynomials over ℚ, parameters and algebraic numbers: their arithmetic beside SymPy's."""

import pytest
import sympy as sp
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.mechanics.hamilton.bracket import poisson_bracket
from canon.mechanics.perturbation.coefficient_field import NoExactFieldError, ring_over
from canon.mechanics.perturbation.lie_transform import Brackets
from canon.mechanics.perturbation.phase_polynomial import PolynomialRing

a, b = sp.symbols("a b", real=True)
k = sp.Symbol("k", positive=True)
NESTED = sp.sqrt(sp.Rational(1, 3) + sp.sqrt(2))
"""Its equation over ℚ is 9 x⁴ − 6 x² − 17 = 0, which has no whole monic form."""

POINT = {a: sp.Rational(2, 3), b: -sp.Rational(5, 7), k: sp.Rational(3, 5)}

FIELDS = {
    "rational": (PolynomialRing(2), sp.S.One),
    "nested root": (ring_over([NESTED], 2), NESTED),
    "parameter": (ring_over([1 / (k + 1)], 2), 1 / (k + 1)),
    "root of a parameter": (ring_over([sp.sqrt(k / 2)], 2), sp.sqrt(k / 2)),
}
UNITS = {ring: ring.number(unit) for ring, unit in FIELDS.values()}
whole = st.integers(-6, 6)
terms = st.dictionaries(
    st.tuples(st.integers(0, 3), st.integers(0, 3)), st.tuples(whole, whole, st.integers(1, 6)), max_size=4
)


def polynomial(ring, unit, given_terms):
    """A polynomial of the ring and the same in SymPy: Σ (n + m unit + i m)/d aʲ bᵏ."""
    found, shown = ring.zero, sp.S.Zero
    for (j, l), (n, m, d) in given_terms.items():
        number = (ring.rational(n) + (UNITS[ring] + ring.i).times(m)) * ring.rational(d).inverse()
        for _ in range(j):
            number = number * ring.variable(0)
        for _ in range(l):
            number = number * ring.variable(1)
        found, shown = found + number, shown + (n + m * unit + sp.I * m) / sp.Integer(d) * a**j * b**l
    return found, shown


@given(st.sampled_from(sorted(FIELDS)), terms, terms)
@settings(max_examples=50, deadline=None)
def test_sums_products_and_brackets_are_those_of_sympy(name, first, second):
    ring, unit = FIELDS[name]
    (f, f_shown), (g, g_shown) = polynomial(ring, unit, first), polynomial(ring, unit, second)
    bracket = Brackets((UNITS[ring],))
    for found, due in (
        (f + g, f_shown + g_shown),
        (f * g, f_shown * g_shown),
        (bracket(f, g), unit * poisson_bracket(f_shown, g_shown, [a], [b])),
    ):
        assert abs((ring.expression(found, [a, b]) - due).xreplace(POINT).evalf(30)) < 1e-20
    assert bracket(f, g) == -bracket(g, f)
    assert ring.total([f, g, f, f, g]) == f.times(3) + g.times(2)
    assert (f * g).derivative(0) == f.derivative(0) * g + f * g.derivative(0)


def test_a_number_of_the_field_times_its_reciprocal_is_one():
    for ring, unit in FIELDS.values():
        number = ring.number(unit + 2)
        assert number * number.inverse() == ring.one
        assert (number * number.inverse().times(2)) != ring.one
        assert sp.expand(ring.expression(ring.number(unit), [a, b]) - unit) == 0


def test_equations_of_algebraic_numbers_have_whole_coefficients():
    ring = FIELDS["nested root"][0]
    assert all(number.is_Integer for number in ring.relation)
    assert ring.relation[-1] == 1
    assert sp.minimal_polynomial(ring.root, a) == sp.Poly(ring.relation[::-1], a).as_expr()


@pytest.mark.parametrize(
    ("name", "made_of"),
    [
        ("rational", "rational numbers"),
        ("nested root", f"{FIELDS['nested root'][0].root}"),
        ("parameter", "the parameters k"),
        ("root of a parameter", f"the parameters k and {FIELDS['root of a parameter'][0].root}"),
    ],
)
def test_a_number_outside_of_the_field_is_refused_with_what_the_field_is_made_of(name, made_of):
    with pytest.raises(ValueError) as refused:
        FIELDS[name][0].number(sp.pi)
    assert str(refused.value) == f"pi is not a rational function of {made_of}"


def test_nothing_has_no_reciprocal():
    for ring, unit in FIELDS.values():
        with pytest.raises(ZeroDivisionError, match="0 has no reciprocal"):
            (ring.number(unit) - ring.number(unit)).inverse()
        assert ring.number(2 * unit).inverse() * ring.number(unit) == ring.rational(fmpq(1, 2))


def test_parameters_stand_beside_an_algebraic_number():
    """(1 + √2 k)² = 1 + 2√2 k + 2 k² in ℚ(√2)[k], and √2 is no rational number there."""
    ring = ring_over([sp.sqrt(2), k], 2)
    number = ring.number(1 + sp.sqrt(2) * k)
    assert number * number == ring.number(1 + 2 * sp.sqrt(2) * k + 2 * k**2)
    assert number * number != ring.number(1 + 2 * k + 2 * k**2)
    assert number * ring.number(1 - sp.sqrt(2) * k) == ring.number(1 - 2 * k**2)


@pytest.mark.parametrize(
    ("constants", "said"),
    [
        (
            [sp.sqrt(n) for n in (2, 3, 5, 7)],
            r"the roots sqrt\(2\), sqrt\(3\), sqrt\(5\), sqrt\(7\) .* too large a degree; take parameters",
        ),
        (
            [sp.sqrt(k), sp.sqrt(sp.Symbol("m", positive=True))],
            r"sqrt\(k\), sqrt\(m\) are independent roots; give frequencies names",
        ),
    ],
)
def test_too_many_roots_for_one_field_are_named(constants, said):
    with pytest.raises(NoExactFieldError, match=said):
        ring_over(constants, 2)
    assert ring_over([*constants[:1], 1 / constants[0]], 2).root == constants[0]
