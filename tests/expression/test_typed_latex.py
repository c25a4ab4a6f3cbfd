"""LaTeX as people type it: what each form means in SymPy's own spelling, and a twin that means something else."""

import json
import re
from functools import cache
from pathlib import Path

import pytest
import sympy as sp
from sympy.parsing.sympy_parser import parse_expr

from canon import coordinates, parameters
from canon.expression.parse import LanguageError, Scope, parse_equation, parse_expression, statements_of
from canon.expression.symbols.symbol import Coordinate, Momentum, acceleration, time

FOLDER = Path(__file__).parents[1] / "data" / "typed"
LABEL = re.compile(
    r"\w+(\([\w,']*\))?|\w+'|\{\w+,\w+\}|\[\w+,\w+\]|d\w+/dt|-?∂[A-Z]/∂\w+'?|[A-Z][-+][A-Z]|H\+∂F/∂t"
)
"""What names an answer, or a definition from a book."""
FILES = ("latex.json", "latex_held_out.json", "outside.json", "first_sight.json")


@cache
def corpus(name):
    return json.loads((FOLDER / name).read_text("utf-8"))


@cache
def scope_of(name):
    """Return the scope that a corpus names, and the same names for SymPy's parser."""
    said = next(
        corpus(file)["scopes"][name]
        for file in ("latex.json", "outside.json", "first_sight.json")
        if name in corpus(file)["scopes"]
    )
    q = [Coordinate(x, real=True) for x in said["q"].split()]
    names = {s.name: s for s in (*q, *parameters(said["parameters"]))}
    names |= {p: Momentum(p, real=True) for p in said["p"].split()}
    functions = {f: tuple(arguments) for f, arguments in said["functions"].items()}
    rates = {r.name: r for x in q for r in (x.dot, x.ddot)}
    applied = {f: sp.Function(f, real=True) for f in functions}
    known = {**names, **rates, **applied, "t": time, "lambda_": names.get("lambda")}
    return Scope(names, functions), known


def meant(text, name):
    """Return the sides of an equation in SymPy's spelling, read by SymPy alone."""
    known = scope_of(name)[1]
    plain = text.replace("lambda", "lambda_") if known["lambda_"] is not None else text
    return tuple(parse_expr(side, local_dict=known) for side in plain.split(" = "))


def read(form, name):
    """Return the sides of every statement; a side that is only a name of the answer or a definition is left out."""
    scope = scope_of(name)[0]
    found = []
    for statement in statements_of(form, scope):
        *names, last = statement.sides
        sides = [side for said in names if (side := value_or_name(said, scope)) is not None]
        found.append((*sides, (parse_expression if names else parse_equation)(last.text, scope)))
    return found


def value_or_name(side, scope):
    """Return the value of a side, None where it is made of names that are not declared."""
    try:
        return parse_expression(side.text, scope)
    except LanguageError:
        if not LABEL.fullmatch(side.said):
            raise
        return None


def agree(found, expected):
    """Whether two expressions are equal: after expansion, or in 20 digits at two points."""
    if sp.expand(found - expected) == 0:
        return True
    derivatives = found.atoms(sp.Derivative) | expected.atoms(sp.Derivative)
    applied = found.atoms(sp.core.function.AppliedUndef) | expected.atoms(sp.core.function.AppliedUndef)
    for k, atoms in enumerate((derivatives, applied)):
        dummies = {a: sp.Symbol(f"A{k}_{i}") for i, a in enumerate(sorted(atoms, key=sp.default_sort_key))}
        found, expected = found.xreplace(dummies), expected.xreplace(dummies)
    symbols = sorted(found.free_symbols | expected.free_symbols, key=str)
    for k in range(2):
        point = {s: sp.Rational(5 + 7 * i + 3 * k, 11 + 2 * i) for i, s in enumerate(symbols)}
        values = [sp.N(f.xreplace(point), 30) for f in (found, expected)]
        if not all(value.is_finite for value in values):  # atan(I) has no value, whoever writes it
            if any(value.is_finite for value in values):
                return False
            continue
        if not abs(values[0] - values[1]) < 1e-18 * (1 + abs(values[1])):
            return False
    return True


def says(form, entry):
    """Tell whether a form is read as an entry means it; None where it is not read."""
    try:
        found = read(form, entry["scope"])
    except LanguageError:
        return None
    expected = [meant(text, entry["scope"]) for text in entry["means"]]
    if [len(sides) for sides in found] != [len(sides) for sides in expected]:
        return False
    pairs = zip((s for sides in found for s in sides), (s for sides in expected for s in sides), strict=True)
    return all(agree(f, e) for f, e in pairs)


@pytest.mark.parametrize("name", FILES)
def test_typed_forms_are_read_and_none_is_read_wrongly(name):
    forms = corpus(name)["forms"]
    told = [(entry["form"], says(entry["form"], entry)) for entry in forms]
    wrong = [form for form, verdict in told if verdict is False]
    unread = [form for form, verdict in told if verdict is None]
    assert wrong == []
    assert len(unread) <= 0.02 * len(forms), "\n".join(unread)


def table():
    """Return the rows of the page on sheets: what is typed, and what it is read as."""
    page = (Path(__file__).parents[2] / "docs" / "sheets.md").read_text("utf-8")
    rows = page.split("| as typed | read as |\n|---|---|\n")[1].split("\n\n")[0].splitlines()
    cells = [row.strip("|").split(" | ") for row in rows]
    return [
        (form, meaning.strip(" `"))
        for typed, meaning in cells
        for form in re.findall(r"`([^`]+)`", typed)
        if form != "lam"
    ]


def test_the_table_on_the_page_is_true():
    names = {s.name: s for s in (*coordinates("x theta phi theta_1"), *parameters("m k g l lam"))}
    scope = Scope({**names, "p": Momentum("p", real=True)}, {"V": ("x",)})
    rows = table()
    assert len(rows) > 20
    for form, meaning in rows:
        last = statements_of(form, scope)[-1].sides[-1]
        assert sp.expand(parse_expression(last.text, scope) - parse_expression(meaning, scope)) == 0, form


MEANINGS = {
    "x⁻¹": "1/x",
    "2 m g l": "2*m*g*l",
    "2mgl": "2*m*g*l",
    "m·g·l": "m*g*l",
    "m×g": "m*g",
    "m*g*l": "m*g*l",
    "mgl(1 - cos θ)": "m*g*l*(1 - cos(theta))",
    "½ m": "m/2",
    "1/2 m": "m/2",
    "m/2 (x + a)": "m*(x + a)/2",
    "p²/(2m)": "p**2/(2*m)",
    "a^2x^2": "a**2*x**2",
    "1/2(a + b)": "(a + b)/2",
    "k/m (x + a)": "k*(x + a)/m",
    "x/2 sqrt(a)": "x*sqrt(a)/2",
    "k/2π": "k/(2*pi)",
    "p²/2m": "p**2/(2*m)",
    "(g/l) sin θ": "g*sin(theta)/l",
    "g/l sin θ": "g*sin(theta)/l",
    "θ̇": "theta_dot",
    "θ̈": "theta_ddot",
    "θ'": "theta_dot",
    "θ″": "theta_ddot",
    "theta_dot": "theta_dot",
    "thetadot": "theta_dot",
    "dθ/dt": "theta_dot",
    "(r dθ/dt)²": "r**2*theta_dot**2",
    "(rdθ/dt)²": "r**2*theta_dot**2",
    "d²θ/dt²": "theta_ddot",
    "θ̇₁": "theta1_dot",
    "θ1'": "theta1_dot",
    "d/dt(m l² θ̇)": "m*l**2*theta_ddot",
    "x'[t]": "x_dot",
    "theta(t)": "theta",
    "sin θ": "sin(theta)",
    "sinθ": "sin(theta)",
    "sin 2θ": "sin(2*theta)",
    "2 sin^2 θ": "2*sin(theta)**2",
    "sin²θ φ̇²": "sin(theta)**2*phi_dot**2",
    "cos ωt": "cos(omega*t)",
    "ln x": "log(x)",
    "arctan(x)": "atan(x)",
    "sin⁻¹(x)": "asin(x)",
    "e^(-k t)": "exp(-k*t)",
    "√(g/l)": "sqrt(g/l)",
    "V'(x)": "Derivative(V(x), x)",
    "dV/dx": "Derivative(V(x), x)",
    "∂V/∂x": "Derivative(V(x), x)",
    "Derivative(V(x), x)": "Derivative(V(x), x)",
    "diff(V(x), x)": "Derivative(V(x), x)",
    "θ": "theta",
    "φ": "phi",
    "ω": "omega",
    "λ": "lam",
    "θ₁": "theta1",
    "θ_1": "theta1",
    "θ1": "theta1",
    "ℓ": "l",
    "&#124;x − a&#124;": "Abs(x - a)",
    "theta(t).diff(t, 2)": "theta_ddot",
    "S.Half*m": "m/2",
    "np.power(x, 2)": "x**2",
    "Derivative(theta(t), (t, 2))": "theta_ddot",
    "Subs(Derivative(V(u), u), u, x)": "Derivative(V(x), x)",
    "Rational(1, 2)*m": "m/2",
    "np.sin(x)": "sin(x)",
    "Mul(Integer(2), Symbol('m'))": "2*m",
    "Sqrt[g/l]": "sqrt(g/l)",
    "D[x[t], {t, 2}]": "x_ddot",
    "Derivative[1][x][t]": "x_dot",
    "Subscript[m, 1]": "m_1",
    "ArcTan[x, y]": "atan2(y, x)",
    "'diff(x,t,2)": "x_ddot",
    "%pi": "pi",
    "%e^(-t)": "exp(-t)",
    "<p>m&nbsp;x<sup>2</sup></p>": "m*x**2",
    "**2*m**": "2*m",
    "2*m": "2*m",
    r"\int_0^{2\pi} \sin^2\theta\,d\theta": "pi",
    "∫_0^a x^2 dx": "a**3/3",
    "Integral(x**2, (x, 0, a))": "a**3/3",
    "Integrate[x^2, {x, 0, a}]": "a**3/3",
    "integrate(x^2, x, 0, a)": "a**3/3",
    r"\sum_{i=1}^{2} m_i x_i^2": "m_1*x_1**2 + m_2*x_2**2",
    "Sum(k**2, (k, 1, 3))": "14",
    "I": "I",
    "i": "I",
    r"\mathrm{i}": "I",
    "%i": "I",
    "x^2": "x**2",
    "x**2": "x**2",
    "x²": "x**2",
    "p²/2mr²": "p**2/(2*m*r**2)",
    "D(D(x))(t)": "x_ddot",
    r"\[Theta]''[t] == -(g/l) Sin[\[Theta][t]]": "theta_ddot + g*sin(theta)/l",
    "Eq(a, b)": "a - b",
    "-g/l sin θ": "-g*sin(theta)/l",
    "-k/m x": "-k*x/m",
    "g sin θ/l": "g*sin(theta)/l",
    "cos φ/r²": "cos(phi)/r**2",
    "V'(r - a)": "",
    "V''(2x)": "",
    "(D@@2)(x)(t)": "x_ddot",
    "¨x": "x_ddot",
    "ddot x": "x_ddot",
    "ddot(theta)": "theta_ddot",
    "dot x": "x_dot",
    "x_{tt}": "x_ddot",
    "m x_{tt} + k x_{t}": "m*x_ddot + k*x_dot",
    "ddx": "x_ddot",
    "m*ddx + k*dx": "m*x_ddot + k*x_dot",
    "∛x": "x**(1/3)",
    "∜x": "x**(1/4)",
    "x**(1/3)": "x**(1/3)",
    "x**(1/4)": "x**(1/4)",
    "sin 30°": "1/2",
    r"\sin 30^\circ": "1/2",
    r"\frac{d}{dt}\frac{\dot x}{m}": "x_ddot/m",
    "E^2 Sin[x]": "exp(2)*sin(x)",
}
"""What the page's table of plain text shows, and what it is; empty where the meaning has no plain spelling."""
OTHER_ROWS = (
    "other names", "abbreviations", "rates by their letters", "prose", "derivations", "numbers of equations",
    "decimal commas", "remarks", "around", "left sides", "chains", "several", "both signs", "the energy",
    "values of functions", "virtual work", "MATLAB, Maple, Fortran", "what is constant", "vectors",
)  # fmt: skip
"""Rows about whole answers, which are tested with questions."""


def plain_table():
    """Return the pieces of the second table of the page, but those with dots and those about whole answers."""
    page = (Path(__file__).parents[2] / "docs" / "sheets.md").read_text("utf-8")
    rows = page.split("| what | how it may be typed |\n|---|---|\n")[1].split("\n\n")[0].splitlines()
    said = [row.strip("| ").split(" | ", 1) for row in rows]
    skipped = (
        "[ ]",
        "{ }",
        "( )",
        "theta",
        "phi",
        "omega",
        "lam",
        "lambda",
        "theta1",
        "l",
        "<math>…</math>",
        "(x' = p/m)",
    )
    return [
        piece
        for what, typed in said
        if what not in OTHER_ROWS
        for piece in re.findall(r"(?<!`)`([^`]+)`(?!`)", typed)
        if "…" not in piece
        and (piece not in skipped or what not in ("names", "brackets", "HTML, MathML, Markdown"))
    ]


def test_the_table_of_plain_text_is_true():
    coordinates_ = coordinates("x y theta phi theta1 r x_1 x_2")
    names = {s.name: s for s in (*coordinates_, *parameters("m k g l lam a b omega m_1 m_2"))}
    scope = Scope({**names, "p": Momentum("p", real=True)}, {"V": ("x",)})
    pieces = plain_table()
    assert len(pieces) > 80
    for piece in pieces:
        found = parse_equation(piece.replace("&#124;", "|"), scope)
        if MEANINGS[piece]:
            assert sp.expand(found - parse_expression(MEANINGS[piece], scope)) == 0, piece


@pytest.mark.parametrize("name", FILES)
def test_twins_are_not_taken_for_the_forms(name):
    taken = [entry["twin"] for entry in corpus(name)["forms"] if says(entry["twin"], entry)]
    assert taken == []


def test_what_is_open_is_refused():
    for entry in corpus("outside.json")["open"]:
        with pytest.raises(LanguageError):
            read(entry["form"], entry["scope"])


@pytest.mark.parametrize("mark", "'′’ʹ´")
def test_one_prime_of_any_keyboard_is_a_velocity(mark):
    x = coordinates("x")
    scope = Scope({"x": x})
    assert parse_expression(f"x{mark}", scope) == x.dot
    assert parse_expression(f"x{mark}{mark}", scope) == acceleration(x)
