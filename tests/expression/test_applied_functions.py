"""Functions without brackets, constructors of programs, exponents and derivatives as typed, each with its neighbour."""

from __future__ import annotations

import pytest
import sympy as sp

from canon import coordinates, parameters
from canon.expression import LanguageError, Scope, parse_expression
from canon.expression.symbols.symbol import Momentum
from canon.expression.text import factor_parser

x, y, theta = coordinates("x y theta")
a, b, g, l, m, n = PARAMETERS = parameters("a b g l m n")
P = Momentum("p_x", real=True)
V, W = sp.Function("V", real=True), sp.Function("W", real=True)
SCOPE = Scope({s.name: s for s in (x, y, theta, *PARAMETERS, P)}, {"V": ("x",), "W": ("x", "y")})


def read(text: str) -> sp.Expr:
    return parse_expression(text, SCOPE)


@pytest.mark.parametrize(
    ("typed", "meant", "other"),
    [
        ("sin^n x", sp.sin(x) ** n, "sin^-n x"),
        ("sin cos x", sp.sin(sp.cos(x)), "cos sin x"),
        ("sin sin sin sin x", sp.sin(sp.sin(sp.sin(sp.sin(x)))), "sin sin sin x"),
        ("sin a cos b", sp.sin(a) * sp.cos(b), "sin(a cos b)"),
        ("arctan(y, x)", sp.atan2(y, x), "arctan(x, y)"),
        ("ArcTan[y, x]", sp.atan2(x, y), "ArcTan[x, y]"),
        ("cotg", sp.cot(g), "cot(1)*g"),
        ("sin θ(a + b)", (a + b) * sp.sin(theta), "sin(θ(a + b))"),
        ("xⁿ", x**n, "x⁻ⁿ"),
        ("x⁻ⁿ", 1 / x**n, "xⁿ"),
        ("Mul(2, x, evaluate=False)", 2 * x, "Mul(2, x, -1)"),
        ("Rational(1, 2)*x", x / 2, "Rational(2, 1)*x"),
        ("Subscript[p, x]/m", P / m, "Subscript[p, x]*m"),
        ("Derivative(m*theta(t), t)", m * theta.dot, "Derivative(theta(t), t)"),
        ("diff(theta(t)**2, t)", 2 * theta * theta.dot, "diff(theta(t)**2, t, t)"),
        ("Derivative(V(x), (x, 2,))", V(x).diff(x, 2), "Derivative(V(x), (x, 1,))"),
        ("D(D(x))(t)", x.ddot, "D(x)(t)"),
        ("dx/(dt)", x.dot, "d²x/(dt²)"),
        ("d/(dt)(m x')", m * x.ddot, "d/(dt)(m x)"),
        ("dV/(dx)", V(x).diff(x), "d²V/(dx²)"),
        ("∂²W/(∂x∂y)", W(x, y).diff(x, y), "∂²W/(∂x²)"),
        ("∂²W/(∂x²)", W(x, y).diff(x, 2), "∂²W/(∂x ∂y)"),
        ("(m x')' + (m y')' + (a x')' + (b y')'", (m + a) * x.ddot + (m + b) * y.ddot, "(m x')' + (m y')' + (a x')'"),
    ],
)  # fmt: skip
def test_what_is_read_is_what_was_meant(typed: str, meant: sp.Expr, other: str) -> None:
    assert sp.expand(read(typed) - meant) == 0
    assert sp.expand(read(other) - meant) != 0


@pytest.mark.parametrize(
    ("typed", "column", "told"),
    [
        ("sin -x", 5, r"sin needs its argument in brackets here; write sin\(-x\)"),
        ("sin^2.5 x", 5, r"a whole number or a name; write any other behind it, sin\(x\)\*\*2"),
        ("sin^* x", 5, "an exponent before an argument is a whole number or a name"),
        ("exp^(-1)(x)", 12, "exp to the power −1 can be the inverse function or 1/exp; write it out"),
        ("ArcTan(y, x)", 1, r"\(x, y\) as in Mathematica, or \(y, x\)\?; write atan2\(y, x\)"),
        ("sin sin sin sin sin x", 17, "more than 4 functions without brackets; write brackets"),
        ("log sin", 8, "sin needs its argument; write brackets"),
        ("sin 2*x", 6, r"sin\(2\) times this, or sin of the product\?; write brackets"),
        ("sin x(a + b)", 6, r"write sin\(x\)\*\(y\) or sin\(x\*\(y\)\)"),
        ("cotg(x)", 5, r"write cot\(x\)\*y or cot\(x\*y\)"),
        ("2*Symbol('x'", 3, r"'\(' is never closed"),
        ("x + Rational(1)", 5, r"Rational with 1 argument\(s\); write the formula itself"),
        ("Integrate[x]", 1, r"Integrate with 1 argument\(s\)"),
        ("Subs(x, y, m)", 1, r"Subs with 3 argument\(s\)"),
        ("Subscript[m, 1, 2]", 1, r"Subscript with 3 argument\(s\)"),
        ("Function('theta')(Symbol('m'))", 10, "theta is a declared symbol and can't be applied to anything"),
        ("d²x/dt", 1, "the orders above and below differ; write d²x/dt²"),
        ("d^(n)x/dt^n", 9, "write the one that is meant"),
        ("dx/(dt", 4, r"'\(' is never closed"),
        ("d²x/(dt)²", 1, "the orders above and below differ; write d²x/dt²"),
        ("∂²W/(∂x∂y", 5, r"'\(' is never closed"),
        ("∂²W/(∂x + ∂y)", 9, r"below a derivative stand its variables alone; write d/dt or ∂²f/\(∂x∂y\)"),
        ("dx/(dt m)", 8, "below a derivative stand its variables alone"),
        ("d^9x/dt^9", 1, "a derivative of more than the 8th order"),
        ("D(D(D(x)))(t)", 5, r"D with 1 argument\(s\)"),
        ("∂V/∂pi", 1, "a derivative is taken with respect to a declared symbol"),
        ("Derivative(V(x), (x, 2, 3))", 18, r"this should be \(variable, order\); write \(t, 2\)"),
        ("Derivative(V(x), (x, m))", 18, r"this should be \(variable, order\)"),
        ("Piecewise((1, x = 0), (0, True))", 15, r"an equation where a condition should be; write < <= > >= or Ne"),
        ("(x° + 1)", 3, r"an operator or '\)' is missing before '°'"),
        ("[x°]", 3, r"an operator or '\]' is missing before '°'"),
        ("p_x^2/2x", 8, r"p_x\^2/2\*x or p_x\^2/\(2\*x\)"),
    ],
)  # fmt: skip
def test_what_is_refused_says_where_and_why(typed: str, column: int, told: str) -> None:
    with pytest.raises(LanguageError, match=told) as caught:
        read(typed)
    assert caught.value.column == column


def test_a_momentum_is_divided_by_a_word_of_parameters_only() -> None:
    assert read("p_x^2/2m") == P**2 / (2 * m)
    assert read("p_x^2/2mx") == P**2 / (2 * m * x)
    with pytest.raises(LanguageError, match="write the one that is meant"):
        read("p_x^2/2xm")


def test_numbers_grow_too_long_in_a_sum_too() -> None:
    four = [f"1/{prime}**1000" for prime in (3, 7, 11, 13)]
    assert read(" + ".join(four)) == sum(sp.Rational(1, prime**1000) for prime in (3, 7, 11, 13))
    with pytest.raises(LanguageError, match="a number too long to be meant"):
        read(" + ".join([*four, "1/17**1000"]))


def test_a_name_may_abbreviate_a_float() -> None:
    scope = Scope({"x": x, "r": sp.Symbol("r")}, values={"r": sp.Float("1.5")})
    assert parse_expression("x**r", scope) == x ** sp.Float("1.5")
    assert parse_expression("r*x", scope) == sp.Float("1.5") * x != x * sp.Float("2.5")


def test_words_of_many_factors_are_counted_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(factor_parser, "MAX_TOKENS", 9)
    assert read("mgl*mgl*mgl") == (m * g * l) ** 3
    with pytest.raises(LanguageError, match="more than 9 numbers, names and signs; split the claim"):
        read("mgl*mgl*mgl*mgl")


t = sp.Symbol("t", real=True)
k, omega = parameters("k omega", positive=True)
OSCILLATOR = Scope({s.name: s for s in (x, y, theta, *PARAMETERS, k, omega)})


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("a cos √(k/m) t", "a*cos(sqrt(k/m)*t)"),
        ("a sin sqrt(k/m) t", "a*sin(sqrt(k/m)*t)"),
        ("a cos √2 t", "a*cos(sqrt(2)*t)"),
        ("a cos √(2) t", "a*cos(sqrt(2)*t)"),
        ("a cos √3 √(g/l) t", "a*cos(sqrt(3)*sqrt(g/l)*t)"),
        ("a cos 2 sqrt(k/m) t", "a*cos(2*sqrt(k/m)*t)"),
        ("a cos √(k/m)t", "a*cos(sqrt(k/m)*t)"),
        ("a sin |ω| t", "a*sin(Abs(omega)*t)"),
        ("a cos √(k/m) t + b sin √(k/m) t", "a*cos(sqrt(k/m)*t) + b*sin(sqrt(k/m)*t)"),
        ("a cosh ∛k t", "a*cosh(k**(1/3)*t)"),
        ("a√(k/m) cos √(k/m) t", "a*sqrt(k/m)*cos(sqrt(k/m)*t)"),
    ],
)
def test_a_constant_root_and_the_time_are_one_argument(typed: str, meant: str) -> None:
    read_here = parse_expression(typed, OSCILLATOR)
    assert sp.simplify(read_here - parse_expression(meant, OSCILLATOR)) == 0
    cut = meant.replace("*t)", ")*t")
    assert sp.simplify(read_here - parse_expression(cut, OSCILLATOR)) != 0


@pytest.mark.parametrize(
    ("typed", "told"),
    [
        ("a cos t√(k/m)", r"this root .* write cos\(t\)\*sqrt\(…\) or cos\(sqrt\(…\)\*t\)"),
        ("a cos t sqrt(k/m)", r"this root .* write cos\(t\)\*sqrt\(…\) or cos\(sqrt\(…\)\*t\)"),
        ("a cos (k/m)^(1/2) t", r"\(cos\(k/m\)\^\(1/2\)\)\*t or cos\(\(k/m\)\^\(1/2\)\*t\)"),
        ("a cos (k/m)² t", r"\(cos\(k/m\)²\)\*t or cos\(\(k/m\)²\*t\)"),
        ("a cos (k/m)^2 t", r"\(cos\(k/m\)\^2\)\*t or cos\(\(k/m\)\^2\*t\)"),
        ("a cos (2π/k) t", r"cos\(2π/k\)\*t or cos\(\(2π/k\)\*t\)"),
        ("a sin √(k/m) · t", r"sin\(√\(k/m\)\) times this, or sin of the product\?"),
        ("a sin ω · t", r"sin\(ω\) times this, or sin of the product\?"),
        ("a cos √(k/m) (t - 1)", r"still belong to the argument of cos\?"),
        ("a cos √(k/m) b", r"still belong to the argument of cos\?"),
        ("a cos k sqrt(g/l)", r"still belong to the argument of cos\?"),
    ],
)
def test_what_may_stand_in_an_argument_or_behind_it_is_asked_about(typed: str, told: str) -> None:
    with pytest.raises(LanguageError, match=told):
        parse_expression(typed, OSCILLATOR)


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("a cos θ √(g/l)", "a*cos(theta)*sqrt(g/l)"),
        ("a cos ω t √(k/m)", "a*cos(omega*t)*sqrt(k/m)"),
        ("a cos(k/m)^(1/2) t", "a*sqrt(cos(k/m))*t"),
        ("a cos(ω) t", "a*cos(omega)*t"),
        ("a cos (θ) t", "a*cos(theta)*t"),
        ("a cos √(k/m)", "a*cos(sqrt(k/m))"),
        ("a cos √(x² + y²) y", "a*cos(sqrt(x**2 + y**2))*y"),
    ],
)
def test_an_argument_that_is_complete_ends(typed: str, meant: str) -> None:
    assert parse_expression(typed, OSCILLATOR) == parse_expression(meant, OSCILLATOR)
