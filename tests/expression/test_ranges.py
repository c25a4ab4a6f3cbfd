"""Definite integrals and finite sums as they are written: what they are read as, against quadrature and SymPy."""

import re
from contextlib import suppress

import mpmath
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon import coordinates
from canon.exercise import Claim, InvalidClaim, judge
from canon.expression.parse import LanguageError, Scope, parse_expression
from canon.expression.ranges.definite_integrals import definite_integral

theta, x_1, x_2 = coordinates("theta x_1 x_2")
m_1, m_2, m, a, k, beta = sp.symbols("m_1 m_2 m a k beta", positive=True)
SCOPE = Scope({s.name: s for s in (theta, x_1, x_2, m_1, m_2, m, a, k, beta)})
t = SCOPE.time

READ = [
    (r"\int_0^{2\pi} \sin^2\theta\,d\theta", sp.pi),
    (r"\frac{1}{2\pi}\int_{0}^{2\pi}\!\cos^4\theta\,\mathrm{d}\theta + m", m + sp.Rational(3, 8)),
    (r"m\int\limits_0^a s\left(1 + s\right) ds", m * (a**2 / 2 + a**3 / 3)),
    (r"\int_0^t e^{-\beta s}\,ds", (1 - sp.exp(-beta * t)) / beta),
    (r"\int_0^1\int_0^s u\,du\,ds", sp.Rational(1, 6)),
    (r"\int_0^a d s", a),
    ("∫_0^a s^2 ds", a**3 / 3),
    ("∫_0^a α^2 dα", a**3 / 3),
    ("$\\int_0^a \\sin φ_1\\,dφ_1$", 1 - sp.cos(a)),
    ("Integral(s**2*k, (s, 0, a))", k * a**3 / 3),
    ("integrate(s*u, (s, 0, 1), (u, 0, a))", a**2 / 4),
    ("'integrate(sin(s), s, 0, %pi)", 2),
    ("Integrate[Sin[s], {s, 0, a}]", 1 - sp.cos(a)),
    ("Integral(1/s, (s, a, 2*a))", sp.log(2)),
    (r"\sum_{i=1}^{2} \tfrac12 m_i \dot x_i^2", m_1 * x_1.dot**2 / 2 + m_2 * x_2.dot**2 / 2),
    (r"\sum_{k=1}^3 k^2 + m", 14 + m),
    (r"\prod_{i=1}^{3} i", 6),
    ("∑_{i=1}^{2} m_i", m_1 + m_2),
    ("Sum(m_i, (i, 1, 2))", m_1 + m_2),
    ("Sum[i m, {i, 1, 3}]", 6 * m),
    ("sum(j^2, j, 1, 3)", 14),
]


@pytest.mark.parametrize(("text", "meaning"), READ)
def test_ranges_are_read(text, meaning):
    assert sp.expand(parse_expression(text, SCOPE) - meaning) == 0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (r"\sum_{i=1}^{2} m_i + x_i", "does the sum go on"),
        (r"\sum_{i=1}^{2} 2i", "an index behind a number"),
        (r"\sum_{i=1}^{n} m_i", "the limits of a sum"),
        (r"\int x dx", "a lower and an upper limit"),
        (r"\int_0^a \frac{ds}{1+s}", "no differential outside brackets"),
        (r"\int_0^a ds\, s", "does what follows belong"),
        ("Integral(1/(1 + cos(s)), (s, 0, a))", "this integral is not read"),
        ("Integral(s**2, s)", "takes a variable and two bounds"),
        ("Integral(1/s, (s, -1, a))", "this integral is not read"),
        ("Sum(m, (i, 1, k))", "from 1 to 100 terms"),
        ("Sum(m, (i, 1, 10**9))", "from 1 to 100 terms"),
        ("Integral(s**10**5, (s, 0, 1))", "an exponent beyond"),
        ("Sum(zz*i, (i, 1, 2))", "zz is not declared"),
    ],
)
def test_what_is_open_or_not_known_is_refused(text, said):
    with pytest.raises(LanguageError) as error:
        parse_expression(text, SCOPE)
    assert said in str(error.value)


x = sp.Symbol("x", real=True)
linear = st.tuples(st.integers(-3, 3), st.integers(-3, 3)).map(lambda ab: ab[0] * x + ab[1])
wave = st.builds(lambda g, u: g(u), st.sampled_from([sp.sin, sp.cos, sp.exp]), linear)
term = st.builds(
    lambda c, n, g: c * x**n * g, st.integers(-4, 4), st.integers(0, 4), st.one_of(wave, st.just(sp.S.One))
)
integrands = st.lists(
    st.one_of(term, st.builds(lambda u, v: sp.sin(u) * sp.cos(v) ** 2, linear, linear)),
    min_size=1,
    max_size=3,
)


@settings(max_examples=50, deadline=None)
@given(integrands, st.integers(-3, 3), st.integers(-3, 3))
def test_integrals_agree_with_quadrature(parts, lower, upper):
    f = sp.Add(*parts)
    found = definite_integral(f, x, sp.Integer(lower), sp.Integer(upper))
    assert found is not None
    by_quadrature = mpmath.quad(sp.lambdify(x, f, "mpmath"), [lower, (lower + upper) / 2, upper])
    assert abs(sp.N(found, 30) - by_quadrature) < 1e-8 * (1 + abs(by_quadrature))


def test_the_variable_of_an_integral_is_its_own():
    """A bound may hold the name that is integrated over; it means the one outside."""
    assert parse_expression("Integral(theta, (theta, 0, theta))", SCOPE) == theta**2 / 2
    assert parse_expression("m*Integral(m, (m, 0, a))", SCOPE) == m * a**2 / 2


@pytest.mark.parametrize(
    ("text", "parameters"),
    [
        ("Integral(cos(n*x), (x, 0, 2*pi))", {"n": "integer", "x": "real"}),  # 2 pi for n = 0
        ("Integral(cos(n*x)*cos(m*x), (x, 0, 2*pi))", {"n": "integer", "m": "integer", "x": "real"}),
        (r"$\int_0^{2\pi} \sin(nx)\sin(mx)\,dx$", {"n": "integer", "m": "integer", "x": "real"}),
        ("Integral(abs(r), (r, -1, 1))", {"r": "positive"}),  # 1
        (r"$\int_{-1}^{1}\sqrt{r^2}\,dr$", {"r": "positive"}),
        ("Integral(sin(2*pi*x), (x, 0, 1/2))", {"x": "integer"}),  # 1/pi
        (r"$\int_0^1 x^2 dx^2$", {"x": "real"}),
    ],
)
def test_no_integral_vanishes_that_does_not(text, parameters):
    claim = Claim("a", "equality-only", {"lhs": text, "rhs": "0", "parameters": parameters})
    with suppress(InvalidClaim):
        assert not judge(claim).holds


def test_what_has_a_value_is_read_still():
    keys = {"lhs": "Integral(cos(n*x), (x, 0, a))", "rhs": "sin(n*a)/n"}
    claim = Claim(
        "a", "equality-only", {**keys, "parameters": {"n": "nonzero", "a": "real", "x": "positive"}}
    )
    assert judge(claim).holds


@pytest.mark.parametrize(
    ("text", "meaning", "other"),
    [
        ("Sum(-(m_i), (i, 1, 2))", -m_1 - m_2, "Sum(m_i, (i, 1, 2))"),
        ("Sum(m_i*(x_i + i), (i, 1, 2))", m_1 * (x_1 + 1) + m_2 * (x_2 + 2), "Sum(m_i*x_i + i, (i, 1, 2))"),
        (
            "Sum(Piecewise((i, x_i < i), (0, True)), (i, 1, 2))",
            sp.Piecewise((1, x_1 < 1), (0, True)) + sp.Piecewise((2, x_2 < 2), (0, True)),
            "Sum(Piecewise((i, x_i < 1), (0, True)), (i, 1, 2))",
        ),
        (r"\int_0^1\int_0^1\int_0^1\int_0^1 k\,du\,ds\,da\,dm", k, r"\int_0^1\int_0^1 s\,du\,ds"),
    ],
)
def test_an_index_stands_for_its_number_wherever_it_is(text, meaning, other):
    assert sp.expand(parse_expression(text, SCOPE) - meaning) == 0
    assert sp.expand(parse_expression(other, SCOPE) - meaning) != 0


@pytest.mark.parametrize(
    ("text", "column", "said"),
    [
        (
            f"Sum({'+'.join(['m*a'] * 100)}, (i, 1, 100))",
            1,
            "this sum is longer than anyone writes; write its value",
        ),
        ("Integral(2, (V, 0, 1))", 14, "an integral is over a variable, no function or rate"),
        ("Integral(2, (theta', 0, 1))", 14, "an integral is over a variable, no function or rate"),
        (
            "$" + "+".join([r"\int_0^1 a\,ds"] * 65) + "$",
            962,
            "more than 64 integrals and sums; split the claim",
        ),
        (
            r"$\int_0^1\int_0^1\int_0^1\int_0^1\int_0^1 k\,du\,ds\,da\,dm\,dv$",
            34,
            "more than 3 integrals within one",
        ),
        (r"$\int_0^1 s\,ds'$", 14, "a differential of a rate; write the integral over one variable"),
        (r"$\int_{0 s\,ds$", 7, "{ is never closed"),
        (r"$\sum_{i=1 m_i$", 7, "{ is never closed"),
    ],
)
def test_what_is_too_much_or_not_whole_is_told(text, column, said):
    with pytest.raises(LanguageError, match=re.escape(said)) as caught:
        parse_expression(text, Scope(SCOPE.names, {"V": ("x_1",)}))
    assert caught.value.column == column


def test_powers_of_functions_are_integrated_up_to_the_twelfth():
    s, zero = sp.Symbol("s", real=True), sp.S.Zero
    assert definite_integral(sp.sin(s) ** 12, s, zero, sp.pi) == sp.pi * sp.binomial(12, 6) / 2**12
    assert definite_integral(sp.sin(s) ** 13, s, zero, sp.pi) is None


def test_a_logarithm_is_the_integral_between_positive_ends_only():
    s, one = sp.Symbol("s", real=True), sp.S.One
    assert definite_integral(1 / s, s, one, a) == sp.log(a)
    assert definite_integral(1 / s, s, -one, one) is None
    assert definite_integral(s ** sp.Rational(-1, 2), s, sp.S.Zero, a) is None


def test_an_integral_up_to_a_coordinate_is_kept_where_quadratures_may_stand():
    text = "Integral(exp(-s**2), (s, 0, theta))"
    known = parse_expression(text, Scope(SCOPE.names, quadratures=True))
    assert known.diff(theta) == sp.exp(-(theta**2))
    assert known.subs(theta, 0).doit() == 0
    for scope, written in ((SCOPE, text), (Scope(SCOPE.names, quadratures=True), text.replace("theta", "a"))):
        with pytest.raises(
            LanguageError, match="the integrand is no sum of powers, sines, cosines and exponentials"
        ):
            parse_expression(written, scope)


def test_sums_typed_one_after_the_other():
    scope = Scope({s.name: s for s in (m_1, m_2)})
    typed = [f"sum_{index} m_{index}" for index in "ijknabcd"]
    assert parse_expression(" + ".join(typed), scope) == 8 * (m_1 + m_2)
    assert parse_expression(" + ".join(typed[1:]), scope) == 7 * (m_1 + m_2)
    with pytest.raises(LanguageError, match="sum_e is not declared"):
        parse_expression(" + ".join([*typed, "sum_e m_e"]), scope)


def test_a_declared_sum_is_a_name():
    with pytest.raises(LanguageError, match="sum_i is not declared; is sum meant"):
        parse_expression("sum_i m_i", Scope({s.name: s for s in (m_1, m_2, sp.Symbol("sum"))}))
