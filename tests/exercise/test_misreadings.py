"""Formulas that were read in a sense that their writer may not have meant, each with a right neighbour."""

import pytest
import sympy as sp

from canon import coordinates
from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.sheet.sheet import Claim
from canon.expression.as_written import as_written
from canon.expression.parse import LanguageError, Scope, parse_expression
from canon.expression.text.vocabulary import FUNCTIONS

BUDGET = 60.0
"""Seconds for a claim: that a busy machine is slow is no question here."""


def said(kind, **keys):
    """Return the verdict on a claim as a word; invalid where nothing can be judged."""
    try:
        return judge(Claim("a", kind, keys, budget=BUDGET)).status.value
    except InvalidClaim:
        return "invalid"


def scope(moving="", constant="", **functions):
    """Return a scope of coordinates, real parameters and functions of one variable."""
    names = {name: sp.Symbol(name, real=True) for name in constant.split()}
    return Scope(
        {**names, **{name: coordinates(name) for name in moving.split()}},
        {f: (v,) for f, v in functions.items()},
    )


def same(text, other, names):
    """Whether two texts are read alike."""
    return parse_expression(text, names) == parse_expression(other, names)


OSCILLATOR = {"q": ["x"], "p": ["p"], "L": "x'**2/2 - x**2/2", "domain": ["x > 0"]}
POSITIVE = {"m": "positive", "k": "positive"}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_function_is_built_as_it_is_written(name):
    least = FUNCTIONS[name][1]
    arguments = ", ".join(["x", "1/3", "1/5"][:least])
    assert as_written(f"{name}({arguments})", scope("x")).has(coordinates("x"))


@pytest.mark.parametrize(
    "worthless", ["0/(x - Abs(x)) + 0*sech(x)", "0*acot(x)/(x - Abs(x))", "0*coth(1)*log(x - Abs(x))"]
)
def test_an_answer_without_a_value_fails_whatever_functions_stand_in_it(worthless):
    assert said("legendre-hamiltonian", **OSCILLATOR, H=f"p**2/2 + x**2/2 + {worthless}") == "fails"


@pytest.mark.parametrize(
    ("H", "status"),
    [("p**2/2 + x**2/2 + 0*sech(x)", "holds"), ("p**2/2 + x**2/2 + sech(x) - csch(x)", "fails")],
)
def test_an_answer_with_hyperbolic_functions_is_judged_by_its_value(H, status):
    assert said("legendre-hamiltonian", **OSCILLATOR, H=H) == status


MANY = scope("x y theta r", "m k g a A gamma alpha omega v_0 E_0 e_1 d_0 varpi", V="x", f="t")

OPEN = [
    ("v_0 cos α t", "v_0 cos(α) t", "t*v_0*cos(alpha)"),
    ("g sin alpha t", "g sin ω t", "g*sin(omega*t)"),
    (r"$\frac{d}{dt} r\dot\theta$", r"$\frac{d}{dt}(r\dot\theta)$", "r*theta'' + r'*theta'"),
    (r"$\dv{t} x y$", r"$m\frac{d}{dt} x + a y$", "m*x' + a*y"),
    (r"$\frac{\partial}{\partial x} V(x) x$", r"$x \frac{\partial}{\partial x} V(x)$", "x*∂V/∂x"),
    (r"$1{,}000\,x$", r"$1000\,x$", "1000*x"),
    (r"$-2{,}500 x$", r"$-2{,}5 x$", "-5*x/2"),
    (r"$a + 10{,}000 x$", r"$a + 0{,}125 x$", "a + x/8"),
    ("2E0", "2E_0", "2*E_0"),
    ("2e1*x", "2e2*x", "200*x"),
    ("A e^-γ t", "A e^(-γ t)", "A*exp(-gamma*t)"),
    ("A e^-k t cos(ω t)", "e^-k a cos(ω t)", "a*exp(-k)*cos(omega*t)"),
    ("e^i ω t", "e^(i ω t)", "exp(I*omega*t)"),
    ("d/dt(x')^2", "d/dt((x')^2)", "2*x'*x''"),
    ("d/dt (x + y)²", "(d/dt(x + y))²", "(x' + y')**2"),
    ("∂/∂x(V)^2", "∂/∂x(V) x", "x*∂V/∂x"),
    (r"$\frac{d}{dt} x\cdot y$", r"$y\cdot\frac{d}{dt} x$", "y*x'"),
    ("x²(0)", "x²(t)", "x**2"),
    ("x'^2(0)", "½ m x'^2(t) + ½ k x²(t)", "m*x'**2/2 + k*x**2/2"),
    ("V²(a + k)", "V² (a + k)", "(a + k)*V(x)**2"),
    ("k²(x)", "k²(x + a)", "k**2*(x + a)"),
    (r"$\dot x^2(0)$", r"${\dot x}^2(t) + \left(\dot y\right)^2(t)$", "x'**2 + y'**2"),
    (r"$k^2(x)$", r"$k^2(x + a)$", "k**2*(x + a)"),
    (r"$x(t-a)$", r"$x \left(- a + t\right)$", "x*(t - a)"),
    (r"$x(-t)$", r"$\dot x(t)\,(t - a)$", "x'*(t - a)"),
    (r"$\int_0^10 a\,da$", r"$\int_0^{10} a\,da$", "50"),
    (r"$\int_0^2\pi a\,da$", r"$\int_0^{2\pi} a\,da$", "2*pi**2"),
    ("∫_0^12 a da", "∫_0^1 a da", "1/2"),
    (r"$\sum_{i=1}^10 m$", r"$\sum_{i=1}^{3} m$", "3*m"),
]


@pytest.mark.parametrize(("open_", "right", "meaning"), OPEN)
def test_what_has_two_readings_is_asked_about(open_, right, meaning):
    with pytest.raises(LanguageError):
        parse_expression(open_, MANY)
    assert same(right, meaning, MANY)


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("2d0 x", "2*d_0*x"),
        ("V²(x)", "V(x)**2"),
        ("V'^2(x) a", "a*Derivative(V(x), x)**2"),
        ("f²(t)", "f(t)**2"),
        ("V(x)²(a + k)", "(a + k)*V(x)**2"),
        ("-½ m ẋ²(t)", "-m*x'**2/2"),
        ("2d3 x", "2000*x"),
        ("a sin(ϖ)", "a*sin(varpi)"),
        ("$a\\sin ϖ$", "a*sin(varpi)"),
        ("cos(π)", "-1"),
        ("v_0 cos αt", "v_0*cos(alpha*t)"),
        ("e^-t x", "x*exp(-t)"),
        ("m e^-γ a", "a*m*exp(-gamma)"),
    ],
)
def test_what_has_one_reading_is_read(text, meaning):
    assert same(text, meaning, MANY)


def test_the_letter_varpi_is_not_the_number():
    with pytest.raises(LanguageError, match="varpi"):
        parse_expression("cos(ϖ)", scope("x"))


PROJECTILE = {
    "q": ["x", "y"], "L": "m*(x'**2 + y'**2)/2 - m*g*y",
    "parameters": {"m": "positive", "g": "positive", "v_0": "positive", "alpha": "real"},
}  # fmt: skip


@pytest.mark.parametrize(
    ("x", "y", "status"),
    [
        ("v_0 cos α t", "v_0 sin α t - g t²/2", "invalid"),
        ("v_0 t cos α", "v_0 t sin α - g t²/2", "holds"),
        ("v_0 t cos α", "v_0 t sin α - g t²", "fails"),
    ],
)
def test_the_projectile_of_every_book(x, y, status):
    assert said("solution", **PROJECTILE, solution={"x": x, "y": y}) == status


@pytest.mark.parametrize(
    ("claim", "status"), [("x'' = x²(t)", "fails"), ("x'' = t x²(t)", "holds"), ("x'' = 2 t x²(t)", "fails")]
)
def test_the_time_behind_a_square_is_an_argument(claim, status):
    assert said("euler-lagrange", q=["x"], L="x'**2/2 + t*x**3/3", claim=[claim]) == status


UNITS = scope("x", "m K k V")


@pytest.mark.parametrize(
    ("open_", "right", "meaning"),
    [
        ("4[m K]", "4[kg/s]", "4"),
        ("1/2[m V^2]", "1/2(m V^2)", "m*V**2/2"),
        ("x/(2[m])", "x/(2 m)", "x/(2*m)"),
        ("EllipticK(k)", "EllipticK[k]", "elliptic_k(k)"),
        ("JacobiSN(x, k)", "JacobiSN[x, k]", "jacobi_sn(x, k)"),
        (
            '<math><menclose notation="updiagonalstrike"><mi>x</mi></menclose><mo>+</mo><mi>k</mi></math>',
            '<math><menclose notation="radical"><mi>x</mi></menclose><mo>+</mo><mi>k</mi></math>',
            "sqrt(x) + k",
        ),
        (
            '<math><mfrac linethickness="0"><mn>4</mn><mn>2</mn></mfrac></math>',
            "<math><mfrac><mn>4</mn><mn>2</mn></mfrac></math>",
            "2",
        ),
        ('√<span style="text-decoration:overline">m + k</span>', "√(<span>m + k</span>)", "sqrt(m + k)"),
    ],
)
def test_units_programs_and_markup_are_asked_about(open_, right, meaning):
    with pytest.raises(LanguageError):
        parse_expression(open_, UNITS)
    assert same(right, meaning, UNITS)


def test_the_period_of_the_pendulum_as_books_write_it_is_asked_about():
    with pytest.raises(LanguageError, match="elliptic_k"):
        parse_expression(r"$4\,K\left(\sin\frac{a}{2}\right)$", scope("x", "a"))
    assert same(r"$4 K\left(a\right)$", "4*elliptic_k(a)", scope("x", "a"))


def test_the_letter_of_an_integral_is_no_unit():
    assert same("Integral(2 s, (s, 0, x))", "x**2", UNITS)


@pytest.mark.parametrize("text", ["2 s*x", "1/2 N*x^2", "5 J·x", "2 m*(x + 1)", "3 W * sqrt(x)"])
def test_a_letter_before_a_factor_is_no_unit_but_a_name_that_was_not_declared(text):
    with pytest.raises(LanguageError, match="not declared"):
        parse_expression(text, scope("x"))
    named = scope("x", "s N J m W")
    assert same(text, text.replace(" ", "*", 1).replace("·", "*"), named)


@pytest.mark.parametrize(
    ("text", "meaning"), [("2 kg*9.81 m/s^2", "2*9.81"), ("3 kg*x", "3*x"), ("2 s", "2")]
)
def test_units_that_nothing_else_can_be_are_passed_over(text, meaning):
    assert same(text, meaning, scope("x"))


def test_moduli_of_word_and_mathtype_stay():
    bars = '<math><mi>k</mi><mfenced open="|" close="|"><mi>x</mi></mfenced></math>'
    brackets = "<math><mi>k</mi><mfenced><mrow><mi>x</mi><mo>+</mo><mi>m</mi></mrow></mfenced></math>"
    assert same(bars, "k*Abs(x)", UNITS)
    assert same(brackets, "k*(x + m)", UNITS)


FORCED = {"q": ["x"], "L": "m*x'**2/2 - k*x**2/2 - a*x", "parameters": {**POSITIVE, "a": "positive"}}


@pytest.mark.parametrize(
    ("claim", "status"),
    [
        ("m*x'' + k*x\n + a = 0", "holds"),
        ("m*x'' = -k*x\n - a", "holds"),
        ("m*x'' =\n -k*x - a", "holds"),
        ("m*x'' = -k*x\n + a", "fails"),
    ],
)
def test_a_row_that_begins_with_a_sign_goes_on(claim, status):
    assert said("euler-lagrange", **FORCED, claim=[claim]) == status


@pytest.mark.parametrize(
    ("claim", "status"),
    [
        ("m*x'' = -k*x\nm*y'' = -k*y", "holds"),
        ("-m*x'' = k*x\n-m*y'' = k*y", "holds"),
        ("m*x'' = -k*x\nm*y'' = k*y", "fails"),
    ],
)
def test_rows_that_are_equations_stand_for_themselves(claim, status):
    L = "m*(x'**2 + y'**2)/2 - k*(x**2 + y**2)/2"
    assert said("euler-lagrange", q=["x", "y"], L=L, parameters=POSITIVE, claim=[claim]) == status


@pytest.mark.parametrize(
    ("L", "status"),
    [("x'**2/2 - k*x**2/m", "holds"), ("x'**2/2 - x**2", "fails"), ("x'**2/2 + k*x**2/m", "fails")],
)
def test_what_is_defined_later_is_no_unit(L, status):
    claim = ["x'' = -c x, c = 2 s, s = k/m"]
    assert said("euler-lagrange", q=["x"], L=L, parameters=POSITIVE, claim=claim) == status
