"""Text in: factors side by side, units, and the many spellings of a rate. What can be read in two ways is refused."""

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon import coordinates, parameters
from canon.expression.parse import LanguageError, parse_equation, parse_expression
from canon.expression.text.scope import Scope
from canon.expression.text.units import units, without_units

theta, x = coordinates("theta x")
m, g, l, a, k, E = parameters("m g l a k E")
NAMES = {s.name: s for s in (theta, x, m, g, l, a, k, E)}
BESIDE = Scope(NAMES, {"V": ("x",)}, implicit=True)
PLAIN = Scope(NAMES, {"V": ("x",)})
V = sp.Function("V", real=True)


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("2 m g", 2 * m * g),
        ("2m", 2 * m),
        ("-m g l sin(theta)", -m * g * l * sp.sin(theta)),
        ("m(a + l)", m * (a + l)),
        ("m (a + l)", m * (a + l)),
        ("(a + l)(a - l)", (a + l) * (a - l)),
        ("V(x) m", V(x) * m),
        ("V (x)", V(x)),
        ("sin (x)", sp.sin(x)),
        ("m l**2 theta''", m * l**2 * theta.ddot),
        ("m l² θ̈".replace("²", "**2"), m * l**2 * theta.ddot),
        ("x**2 (a + l)", x**2 * (a + l)),
        ("(m g)/l", m * g / l),
        ("m g/l", m * g / l),
        ("-k/m x", -k * x / m),
        ("g/l theta'", g * theta.dot / l),
        ("1/2 k/m x**2 + m", k * x**2 / (2 * m) + m),
        ("g/l*sin(theta)", g / l * sp.sin(theta)),
        ("2 pi l", 2 * sp.pi * l),
        ("2 -3", -1),
        ("2 x' (x - a)", 2 * x.dot * (x - a)),
        ("k(x - a) = m x''", k * (x - a) - m * x.ddot),
    ],
)
def test_factors_side_by_side(text, meant):
    assert sp.expand(parse_equation(text, BESIDE) - meant) == 0


@pytest.mark.parametrize(
    ("text", "column", "reason"),
    [
        ("g/x sin(theta)", 5, "g/x\\*sin\\(theta or g/\\(x\\*sin"),
        ("1/2m", 4, "1/2\\*m or 1/\\(2\\*m\\)"),
        ("k/mx", 4, "k/m\\*x or k/\\(m\\*x\\)"),
        ("k /m x", 6, "k/m\\*x or k/\\(m\\*x\\)"),
        ("x/m x", 5, "x/m\\*x or x/\\(m\\*x\\)"),
        ("k/m l", 5, "k/m\\*l or k/\\(m\\*l\\)"),
        ("x^2/2m", 6, "x\\^2/2\\*m or x\\^2/\\(2\\*m\\)"),
        ("x**2y", 5, "belong to the exponent"),
        ("x**2(a + l)", 5, "belong to the exponent"),
        ("x^a(a + l)", 4, "belong to the exponent"),
        ("m(a)", 2, "applied to this"),
        ("m (a)", 3, "applied to this"),
        ("theta(0)", 6, "applied to this"),
        ("x(t + 1)", 2, "applied to this"),
        ("x'(0)", 3, "applied to this"),
        ("m(a, l)", 2, "applied to this"),
        ("x 2", 3, "a number after a factor"),
        ("2 3", 3, "a number after a factor"),
        ("(a) 2", 5, "a number after a factor"),
        ("2E3", 1, "a product with E"),
        ("mass", 1, "not declared"),
        ("sin a x", 7, "belong to the argument"),
        ("sin x/2", 6, "divide the function or its argument"),
        ("sin x^2", 6, "raise the function or its argument"),
        ("x^1/2", 3, "only 1 raised"),
        ("e^-kt", 5, "belong to the exponent"),
        ("√2x", 1, "how far does the root reach"),
        ("l d/dt", 3, "what does d/dt reach"),
        ("|a|x|a|", 5, "does this bar open or close"),
        ("V m", 1, "V is a function"),
        ("h(x + 1)", 1, "not a function"),
        ("m (a", 3, "never closed"),
    ],
)
def test_two_readings_are_refused(text, column, reason):
    with pytest.raises(LanguageError, match=reason) as caught:
        parse_equation(text, BESIDE)
    assert caught.value.column == column
    assert caught.value.caret().splitlines()[-1] == " " * (column - 1) + "^"


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("g/l sin(theta)", g / l * sp.sin(theta)),
        ("1/2 m x'^2", m * x.dot**2 / 2),
        ("½mẋ²", m * x.dot**2 / 2),
        ("mgl", m * g * l),
        ("mglsinθ", m * g * l * sp.sin(theta)),
        ("sin²θẋ²", sp.sin(theta) ** 2 * x.dot**2),
        ("2 sin^2 θ", 2 * sp.sin(theta) ** 2),
        ("sin kx", sp.sin(k * x)),
        ("cos k t", sp.cos(k * sp.Symbol("t", real=True))),
        ("theta(t)", theta),
        ("x'(t)", x.dot),
        ("√(g/l)", sp.sqrt(g / l)),
        ("|x − a|", sp.Abs(x - a)),
        ("d/dt(m l² θ̇)", m * l**2 * theta.ddot),
        ("d²θ/dt²", theta.ddot),
        ("∂V/∂x", V(x).diff(x)),
        ("sin⁻¹(x)", sp.asin(x)),
    ],
)
def test_as_it_is_typed(text, meant):
    assert sp.expand(parse_expression(text, PLAIN) - meant) == 0


FACTORS = st.sampled_from(
    ["m", "g", "l", "x", "theta'", "sin(x)", "V(x)", "(a + l)", "x**2", "(x - a)**3", "cos(2 x)"]
)


FRONTS = st.sampled_from(["", "-", "2 ", "3/2*"])
TERMS = st.lists(st.tuples(FRONTS, st.lists(FACTORS, min_size=1, max_size=5)), min_size=1, max_size=3)


@settings(max_examples=300, deadline=None)
@given(TERMS)
def test_a_blank_is_a_sign_of_multiplication(terms):
    """Read side by side, factors are what they are with * between them."""
    beside = " + ".join(f"{front}{' '.join(factors)}" for front, factors in terms)
    signed = " + ".join(
        f"{front.replace(' ', '*')}{'*'.join(factors)}".replace("2 x", "2*x") for front, factors in terms
    )
    assert parse_expression(beside, BESIDE) == parse_expression(signed, PLAIN)


@pytest.mark.parametrize(
    ("text", "meant", "unit"),
    [
        ("9.81 [m/s^2]*x", sp.Rational(981, 100) * x, "m/s^2"),
        ("9.81 [m/s**2]", sp.Rational(981, 100), "m/s**2"),
        ("9.81 [m s^-2]", sp.Rational(981, 100), "m s^-2"),
        ("9.81 [m·s⁻²]", sp.Rational(981, 100), "m·s⁻²"),
        ("2[kg*m/(s^2)]", sp.Integer(2), "kg*m/(s^2)"),
        ("5 [1/s]*x", 5 * x, "1/s"),
        ("3 N + x", 3 + x, "N"),
        ("3 kg", sp.Integer(3), "kg"),
        ("1.5e-3 Pa s + x", x + sp.Rational(3, 2000), "Pa s"),
        (r"$9.81\,\mathrm{N}\,x$", sp.Rational(981, 100) * x, "N"),
        (r"$2\;\text{kg s^{-1}} x$", 2 * x, "kg s^{-1}"),
    ],
)
def test_units_are_passed_over(text, meant, unit):
    assert parse_expression(text, PLAIN) == meant
    assert [found.text for found in units(text, PLAIN)] == [unit]
    assert len(without_units(text, PLAIN)) == len(text)


@pytest.mark.parametrize(
    ("text", "column", "reason"),
    [
        ("9.81 [cm/s^2]", 7, "'cm/s\\^2' is not a unit"),
        ("30 [deg]", 5, "is not a unit"),
        ("2 [x]", 4, "is not a unit"),
        ("x[1]", 2, "no indexing"),
        ("9.81 m/s^2", 8, "s is not declared"),
        ("5 kN", 3, "kN is not declared"),
        ("3 K", 3, "K is not declared"),
        ("3 N x", 3, "N is not declared"),
        ("3 N*x", 3, "N is not declared"),
    ],
)
def test_what_is_no_unit_is_refused_at_its_place(text, column, reason):
    with pytest.raises(LanguageError, match=reason) as caught:
        parse_expression(text, PLAIN)
    assert caught.value.column == column
    assert caught.value.text == text


def test_a_declared_letter_is_never_a_unit():
    """A mass m after a number is a mass, or refused; never left out."""
    assert units("2 m", PLAIN) == ()
    assert units("2 m", Scope()) != ()
    assert parse_expression("2 m", BESIDE) == 2 * m
    for text in ("3 N", "3 s", "3 kg"):  # side by side, a bare letter is a quantity that was not declared
        with pytest.raises(LanguageError, match=r"not declared|a unit, or"):
            parse_expression(text, BESIDE)
    assert parse_expression("3 [N] m", BESIDE) == 3 * m


@pytest.mark.parametrize(
    "text",
    [
        "theta''",
        "theta_ddot",
        "θ̈",
        "θ''",
        "θ_ddot",
        "θ\u0307\u0307",
        r"$\ddot\theta$",
        r"$\ddot{\theta}$",
        r"$\theta''$",
        "ϑ''",
    ],
)
def test_an_acceleration_in_every_spelling(text):
    assert parse_expression(text, PLAIN) == theta.ddot
    assert parse_expression(text, BESIDE) == theta.ddot


@pytest.mark.parametrize("text", ["ẍ", "x\u0308", "x''", "x_ddot", r"$\ddot x$", r"$\ddot{x}$", "$x''$"])
def test_the_same_of_a_latin_letter(text):
    assert parse_expression(text, PLAIN) == x.ddot
