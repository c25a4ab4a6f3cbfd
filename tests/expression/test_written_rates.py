"""Rates in notations of their own beside names that look like them."""

from __future__ import annotations

import pytest
import sympy as sp

from canon import coordinates, parameters
from canon.expression import LanguageError, Scope, parse_expression
from canon.expression.written_rates import with_primes

x = coordinates("x")
dot, m, m_t = parameters("dot m m_t")


def test_a_declared_dot_is_a_factor() -> None:
    assert parse_expression("dot x", Scope({"x": x, "dot": dot})) == dot * x
    assert parse_expression("dot x", Scope({"x": x})) == x.dot
    with pytest.raises(LanguageError, match="d is not declared"):
        parse_expression("ddot x", Scope({"x": x, "dot": dot}))


@pytest.mark.parametrize("typed", ["$x_{tt} + m_t x_t$", "x_tt + m_t*x_t", "$x_{tt} + m_{t} x_{t}$"])
def test_a_subscript_of_the_time_is_a_rate_of_what_moves_and_a_name_elsewhere(typed: str) -> None:
    assert parse_expression(typed, Scope({"x": x, "m_t": m_t})) == x.ddot + m_t * x.dot
    with pytest.raises(LanguageError, match="m_t is not declared"):
        parse_expression(typed, Scope({"x": x, "m": m}))


def test_a_text_keeps_its_length() -> None:
    typed = "$x_{tt} + m_t x_t$"
    written = with_primes(typed, Scope({"x": x}))
    assert written == "$x''    + m_t x' $"
    assert len(written) == len(typed)
    assert sp.Symbol("m_t") not in parse_expression("x_tt + x_t", Scope({"x": x})).free_symbols
