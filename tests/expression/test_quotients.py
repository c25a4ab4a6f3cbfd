"""Quotients and exponents typed without brackets: where they end beyond doubt, and what is asked about."""

from __future__ import annotations

import pytest
import sympy as sp

from canon import coordinates, parameters
from canon.expression.parse import LanguageError, Scope, parse_expression

q, x = coordinates("q x")
p = q.momentum
a, m, w, E, k = parameters("a m w E k", positive=True)
SCOPE = Scope({**{s.name: s for s in (q, x, a, m, w, E, k)}, "p": p})

READ = {
    "q/2 sqrt(a)": q / 2 * sp.sqrt(a),
    "x/2 (a + m)": x * (a + m) / 2,
    "E/w (q + a)": E / w * (q + a),
    "E^2/w (q + a)": E**2 / w * (q + a),
    "sqrt(2m)/a (1 - q)": sp.sqrt(2 * m) / a * (1 - q),
    "a/w^2 (q + x)": a / w**2 * (q + x),
    "1/2(p^2 + w^2 q^2)": (p**2 + w**2 * q**2) / 2,
    "a + 3/4(q + x) m": a + sp.Rational(3, 4) * (q + x) * m,
    "E/2π": E / (2 * sp.pi),
    "1/2π + a": 1 / (2 * sp.pi) + a,
    "q E/2π": q * E / (2 * sp.pi),
    "w^2q^2": w**2 * q**2,
    "m w^2q^2/2": m * w**2 * q**2 / 2,
    "p^2+w^2q^2": p**2 + w**2 * q**2,
    "x**2q**2": x**2 * q**2,
    "p^2/2m": p**2 / (2 * m),
}


@pytest.mark.parametrize("text", READ)
def test_they_end_where_nobody_doubts_it(text):
    assert sp.expand(parse_expression(text, SCOPE) - READ[text]) == 0


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("p^2/2 (m + a)", "is p"),  # p²/(2(m + a)), by many a hand
        ("p/2 sqrt(a)", "is p/2"),
        ("E/w(q + a)", "is E/w"),
        ("a/2(q + x)", "is a/2"),
        ("1/2m (q + x)", "is 1/2"),
        ("E/ w (q + a)", "is E/"),
        ("q/w sqrt(a)", "is q/w"),
        ("E/q (q + a)", "is E/q"),
        ("k/m a", "is k/m"),
        ("E/2w", "is E/2"),
        ("E/2π q", "is E/2π"),
        ("E/2π^2", "is E/2"),
        ("x^2q", "belong to the exponent"),
        ("w^2 + x^2m", "belong to the exponent"),
    ],
)
def test_what_may_end_elsewhere_is_asked_about(text, reason):
    with pytest.raises(LanguageError, match=reason):
        parse_expression(text, SCOPE)
