"""What SymPy's ``latex()`` prints is read back as what was printed, whatever the expression of the language."""

import re
import time

import pytest
import sympy as sp
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from canon.expression.parse import LanguageError, Scope, parse_expression
from canon.expression.symbols.symbol import Coordinate, Momentum
from canon.expression.text.vocabulary import WHICH_E
from tests.expression.test_typed_latex import agree

WHICH_REACH = "the derivative of what?"
SLOPE_BEFORE_A_FACTOR = re.compile(
    r"\\frac\{(?:d|\\partial)(?:\^\{\d\})?\}\{[^{}]*(?:\{\d\}[^{}]*)*\} \\?\w+\{\\left\([^()]*\\right\)\}"
    r" ?(?![ +\-&,}]|\\right|\\\\|$)"
)
THETA, X, Y = (Coordinate(name, real=True) for name in ("theta", "x", "y_1"))
P = Momentum("p_theta", real=True)
M, L, W = (sp.Symbol(name, positive=True) for name in ("m", "l_2", "omega"))
V = sp.Function("V", real=True)
SCOPE = Scope({s.name: s for s in (THETA, X, Y, P, M, L, W)}, {"V": ("x",)})
ATOMS = (THETA, X, Y, P, M, L, W, THETA.dot, X.ddot, sp.E, sp.pi, sp.I, sp.Integer(2), sp.Rational(-3, 7))
ONE = (sp.sin, sp.cos, sp.tan, sp.cot, sp.sec, sp.csc, sp.asin, sp.acos, sp.atan, sp.sinh, sp.cosh, sp.tanh, sp.asinh,
       sp.acosh, sp.atanh, sp.exp, sp.log, sp.sqrt, sp.Abs, sp.sign, sp.LambertW, sp.elliptic_k)  # fmt: skip
REAL = (X, Y, M, L)


U = sp.Symbol("u")
CUBE = sp.Lambda(U, U**3 + U)


def slope_at(place):
    """Return V'' at a place, as the chain rule leaves it."""
    return V(X - place).diff(X, 2) if not place.has(X) else V(M * X).diff(X)


def piecewise(pair):
    a, b = pair
    return sp.Piecewise((a, sp.And(X > 0, Y < M)), (b, sp.Or(X > L, Y <= 1)), (a + b, True))


def grown(inner):
    powers = st.sampled_from((sp.Integer(2), sp.Integer(-1), sp.Rational(1, 2), sp.Rational(-2, 3), X, -W))
    return st.one_of(
        st.tuples(inner, inner).map(lambda pair: pair[0] + pair[1]),
        st.tuples(inner, inner).map(lambda pair: pair[0] * pair[1]),
        st.tuples(inner, inner).map(lambda pair: pair[0] / pair[1]),
        st.tuples(inner, powers).map(lambda pair: pair[0] ** pair[1]),
        st.tuples(st.sampled_from(ONE), inner).map(lambda pair: pair[0](pair[1])),
        st.tuples(inner, inner).map(piecewise),
        st.sampled_from(REAL).map(slope_at),
        st.tuples(st.sampled_from(REAL), st.sampled_from(REAL)).map(lambda pair: sp.atan2(*pair)),
        st.tuples(st.sampled_from(REAL), st.sampled_from(REAL)).map(
            lambda pair: sp.Max(*pair) * sp.Min(pair[0], 1)
        ),
        st.just(V(X).diff(X)),
    )


EXPRESSIONS = st.recursive(st.sampled_from(ATOMS), grown, max_leaves=7)

NO_WORDS_FOR = (sp.nan, sp.zoo, sp.oo, sp.S.NegativeInfinity, sp.AccumBounds, sp.gamma)
"""What SymPy makes of some, and the language has no words for: Γ(1/4) of K(1/2)."""


def read_back(expression):
    """Tell whether an expression is read back from its print; a refusal is an error.

    But of ``m e^{2}``, as SymPy prints m exp(2), it is asked whether e is an eccentricity whose name was forgotten, and
    of V'(x) before another factor, which SymPy prints as (V(x) f(x))', how far d/dx reaches.
    """
    text = sp.latex(expression)
    try:
        found = parse_expression(f"${text}$", SCOPE)
    except LanguageError as error:
        if WHICH_REACH in str(error):
            return SLOPE_BEFORE_A_FACTOR.search(text) is not None
        return WHICH_E in str(error) and any(power.exp.is_Rational for power in expression.atoms(sp.exp))
    return found == expression or agree(*(f.subs(V, CUBE).doit() for f in (found, expression)))


@settings(max_examples=50, suppress_health_check=list(HealthCheck), deadline=None)
@given(EXPRESSIONS)
def test_what_sympy_prints_is_read_back(expression):
    assume(not expression.has(*NO_WORDS_FOR))
    assert read_back(expression), sp.latex(expression)


def test_the_number_e_joins_no_equations_that_stand_in_other_places():
    assert read_back(piecewise((slope_at(X), 2 * sp.E)))
    assert not agree(*(piecewise((slope_at(X), k * sp.E)).subs(V, CUBE).doit() for k in (2, 3)))


@pytest.mark.parametrize(
    ("expression", "twin"),
    [
        (V(X - L).diff(X), V(X + L).diff(X)),
        (2 * sp.E * X, 3 * sp.E * X),
        (V(X * M).diff(X) + sp.E, V(X * M).diff(X) - sp.E),
        (sp.atan2(Y, X), sp.atan2(X, Y)),
        (piecewise((X, Y)), piecewise((Y, X))),
        (
            sp.Piecewise((X, sp.And(X > 0, X < 1)), (0, True)),
            sp.Piecewise((X, sp.And(X > 0, X < 2)), (0, True)),
        ),
    ],
)
def test_and_not_as_something_else(expression, twin):
    assert parse_expression(f"${sp.latex(expression)}$", SCOPE) == expression
    assert parse_expression(f"${sp.latex(twin)}$", SCOPE) != expression


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("  2\nm*x \n----\n 2 ", "drawing of the formula over several lines"),
        ("g⋅sin(θ)\n────────\n   l    ", "drawing of the formula over several lines"),
        ("V'(x, y)", "with respect to what"),
        (r"$V'''''''''(2x)$", "no derivative of a function"),
    ],
)
def test_what_is_no_formula_on_one_line_is_told(text, told):
    with pytest.raises(LanguageError) as caught:
        parse_expression(text, SCOPE)
    assert told in caught.value.message


SLOPE = r"\left. \frac{d}{d \xi} V{\left(\xi \right)} \right|_{\substack{ \xi=m x }} + "
CASES = r"$\begin{cases} x & \text{for}\: {} \\ 0 & \text{otherwise} \end{cases}$"


@pytest.mark.parametrize(
    "text",
    [
        "x" + ".diff(x)" * 3000,
        "x" + ".diff(x)" * 8 + "".join(f".diff({c})" for c in "xy" * 900),
        "Piecewise((x, " + "And(" * 60 + "x > 0" + ")" * 60 + "), (0, True)) + q",
        "Piecewise((x, And(" + ", ".join(["Or(x > 0, x < 1)"] * 40) + ")), (0, True))",
        "V" + "'" * 9000 + "(2*x)",
        f"${SLOPE * 600}",
        f"${SLOPE.replace('m x', '{' * 3000 + 'x' + '}' * 3000)}0",
        CASES.replace("{}", r"\left(" * 3000 + "x > 0" + r"\right)" * 3000),
        "(" * 9000 + "x = 1" + ")" * 9000,
        "[" * 60 + "x = 1" + "]" * 60 + " = ",
        "np.power(" * 5000,
        "dd" * 9000 + "x/dt",
        "r" * 24 + "dtheta/dt",
        "─" * 40_000,
        "\n" + " " * 20_000 + "---",
    ],
    ids=range(15),
)
def test_hostile_text_is_refused_at_once(text):
    start = time.process_time()
    with pytest.raises(LanguageError):
        parse_expression(text, SCOPE)
    assert time.process_time() - start < 4


def test_many_conditions_are_read_or_refused_at_once():
    many = CASES.replace("{}", r" \vee ".join(["x > y_1"] * 2000))
    with pytest.raises(LanguageError, match="alternatives"):
        parse_expression(many, SCOPE)
