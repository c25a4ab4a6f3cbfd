"""On generated expressions: an identity is never refuted, a changed one never proved."""

import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from sympy import Abs, Rational, cos, cosh, exp, log, sin, sinh, sqrt, tan

from canon.proof import Domain, vanishes
from canon.proof.domain.domain import EVERYWHERE

x, y = sp.symbols("x y", real=True)
a, b = sp.symbols("a b", positive=True)

rationals = st.fractions(-3, 3, max_denominator=4).map(lambda q: Rational(q.numerator, q.denominator))
atoms = st.one_of(st.sampled_from([x, y, a, b]), rationals)


def grow(children):
    pairs = st.tuples(children, children)
    return st.one_of(
        pairs.map(lambda p: p[0] + p[1]),
        pairs.map(lambda p: p[0] * p[1]),
        children.map(lambda e: e**2),
        children.map(sin),
        children.map(cos),
        children.map(lambda e: sqrt(1 + e**2)),
    )


expressions = st.recursive(atoms, grow, max_leaves=5)

# Each takes e to an e′ that is equal wherever both are defined.
REWRITINGS = [
    lambda e, f: sp.expand(e),
    lambda e, f: e * (sin(f) ** 2 + cos(f) ** 2),
    lambda e, f: e + sin(2 * f) - 2 * sin(f) * cos(f),
    lambda e, f: e * (cosh(f) ** 2 - sinh(f) ** 2),
    lambda e, f: (e**2 - f**2) / (e + f) + f,
    lambda e, f: e + sqrt(f**2) - Abs(f),
    lambda e, f: e + exp(x + y) - exp(x) * exp(y),
    lambda e, f: e + log(a * b) - log(a) - log(b),
    lambda e, f: e + tan(x) - sin(2 * x) / (1 + cos(2 * x)),
    lambda e, f: e + sqrt(a * b) * f - sqrt(a) * sqrt(b) * f,
    lambda e, f: e + f * cos(x - y) - f * (cos(x) * cos(y) + sin(x) * sin(y)),
]


def has_value(e):
    """Tell whether an expression is no nan or infinity, which (e² − f²)/(e + f) is where e and f are 0."""
    return not e.has(sp.nan, sp.zoo, sp.oo, -sp.oo)


@settings(max_examples=60, deadline=None)
@given(expressions, expressions, st.sampled_from(REWRITINGS))
def test_identities_are_never_refuted(e, f, rewritten):
    assume(has_value(rewritten(e, f)))
    assert not vanishes(e - rewritten(e, f), budget=2.0).fails


@settings(max_examples=60, deadline=None)
@given(
    expressions,
    expressions,
    st.sampled_from(REWRITINGS),
    st.sampled_from([Rational(1, 10**20), x / 10**9, sin(y) / 1000, a - b, 1 / (1 + x**2)]),
)
def test_changed_identities_are_never_proved(e, f, rewritten, delta):
    assume(has_value(rewritten(e, f)))
    assert not vanishes(e - rewritten(e, f) + delta, budget=2.0).holds


@settings(max_examples=50, deadline=None)
@given(st.lists(st.sampled_from([x > 0, x < 2, y > x, y < 5, x + y > 1]), max_size=3, unique=True))
def test_points_lie_in_the_domain(conditions):
    domain = Domain(conditions=tuple(conditions), box={x: (Rational(-4), Rational(4))})
    for point in domain.points([x, y, a], 5):
        assert all(condition.subs(point) == sp.true for condition in conditions)
        assert point[a] > 0


@settings(max_examples=60, deadline=None)
@given(expressions)
def test_equal_seeds_draw_equal_points(e):
    symbols = e.free_symbols
    assert list(EVERYWHERE.points(symbols, 3, seed=7)) == list(EVERYWHERE.points(symbols, 3, seed=7))
