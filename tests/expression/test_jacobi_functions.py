"""Jacobi's functions: derivatives against difference quotients, values against series, and how they are read."""

import pytest
import sympy as sp

from canon.expression.parse import LanguageError, Scope, parse_expression
from canon.expression.symbols.jacobi_functions import (
    JACOBI,
    jacobi_am,
    jacobi_cn,
    jacobi_dn,
    jacobi_epsilon,
    jacobi_sn,
)

u, m = sp.symbols("u m", real=True)
SCOPE = Scope({"u": u, "m": m})
THIRD, STEP = sp.Rational(1, 3), sp.Rational(1, 10**10)


@pytest.mark.parametrize("f", JACOBI)
@pytest.mark.parametrize(
    "parameter",
    [THIRD, *(pytest.param(sp.Rational(*m), marks=pytest.mark.slow) for m in ((-5, 2), (7, 5)))],
)
@pytest.mark.parametrize("variable", [u, m])
def test_derivatives_are_limits_of_quotients(f, parameter, variable):
    place = {u: sp.Rational(31, 3), m: parameter}
    ends = [f(u, m).subs({**place, variable: place[variable] + sign * STEP}) for sign in (1, -1)]
    quotient = ((ends[0] - ends[1]) / (2 * STEP)).n(30, maxn=400)
    assert abs(f(u, m).diff(variable).subs(place).n(30) - quotient) < 1e-15


def test_maclaurins_series():
    """NIST DLMF 22.10.1–3."""
    due = {
        jacobi_sn: u - (1 + m) * u**3 / 6 + (1 + 14 * m + m**2) * u**5 / 120,
        jacobi_cn: 1 - u**2 / 2 + (1 + 4 * m) * u**4 / 24,
        jacobi_dn: 1 - m * u**2 / 2 + m * (4 + m) * u**4 / 24,
        jacobi_am: u - m * u**3 / 6 + m * (4 + m) * u**5 / 120,
        jacobi_epsilon: u - m * u**3 / 3 + m * (1 + m) * u**5 / 15,
    }
    for f, series in due.items():
        terms = [f(u, m).diff(u, k).subs(u, 0) * u**k / sp.factorial(k) for k in range(6)]
        assert sp.expand(sum(terms) - series) == 0


def test_they_are_elementary_at_both_ends():
    assert [f(u, 0) for f in JACOBI] == [u, sp.sin(u), sp.cos(u), 1, u]
    assert [f(-u, m) for f in JACOBI[1:4]] == [-jacobi_sn(u, m), jacobi_cn(u, m), jacobi_dn(u, m)]
    assert jacobi_sn(u, 1) == sp.tanh(u)
    assert abs(jacobi_am(2, 1).n(30) - jacobi_am(2, 1 - sp.Rational(1, 10**20)).n(30)) < 1e-15


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("jacobi_sn(u, m)*jacobi_cn(u, m)", jacobi_sn(u, m) * jacobi_cn(u, m)),
        ("sn(u, m)**2 + am(u, m)", jacobi_sn(u, m) ** 2 + jacobi_am(u, m)),
        ("JacobiDN[u, m] - EllipticF[u, m]", jacobi_dn(u, m) - sp.elliptic_f(u, m)),
        ("elliptic_f(u, m) + jacobi_epsilon(u, m)", sp.elliptic_f(u, m) + jacobi_epsilon(u, m)),
        ("elliptic_pi(1/3, m)", sp.elliptic_pi(THIRD, m)),
        ("elliptic_pi(1/3, u, m)", sp.elliptic_pi(THIRD, u, m)),
        (r"$\operatorname{sn}(u, m)\,\mathrm{dn}(u, m)$", jacobi_sn(u, m) * jacobi_dn(u, m)),
    ],
)
def test_they_are_read(text, value):
    assert parse_expression(text, SCOPE) == value


@pytest.mark.parametrize("f", [*JACOBI[:4], sp.elliptic_f])
def test_what_is_printed_is_read_back(f):
    g = f(2 * u, m / 3) ** 2 + f(u, m)
    assert parse_expression(f"${sp.latex(g)}$", SCOPE) == g
    assert parse_expression(str(g), SCOPE) == g


def test_two_letters_that_are_declared_are_factors():
    s, n = sp.symbols("s n", real=True)
    assert parse_expression("sn(u + 1)", Scope({"s": s, "n": n, "u": u})) == s * n * (u + 1)
    with pytest.raises(LanguageError, match="takes 2 argument"):
        parse_expression("jacobi_sn(u)", SCOPE)


def test_the_integral_of_the_third_kind_is_not_rewritten_where_a_formula_is_wrong():
    """SymPy has Π(n, φ, 0) = atanh(√(n − 1) tan φ)/√(n − 1), which jumps at φ = π/2."""
    f = parse_expression("elliptic_pi(1/2, u, 0)", SCOPE)
    assert f.func is sp.elliptic_pi
