"""Answers as people type them, judged: left sides, chains, several equations; each with a twin that does not hold."""

import time

import pytest

from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import claim_from

SIGNS = {"m": "positive", "g": "positive", "l": "positive", "k": "positive"}
H = {
    "kind": "legendre-hamiltonian",
    "q": ["theta"],
    "p": ["p_theta"],
    "L": "L = T - V = ½ m l² θ̇² + m g l cos θ",
}
EL = {"kind": "euler-lagrange", "q": ["theta"], "L": "½ m l² θ̇² + mgl cosθ"}
HE = {
    "kind": "hamilton-equations",
    "q": ["x", "y"],
    "p": ["p_x", "p_y"],
    "H": "(p_x^2 + p_y^2)/(2m) + ½k(x² + y²)",
}
PB = {"kind": "poisson-bracket", "q": ["x", "y"], "p": ["p_x", "p_y"]}
RIGHT = "p_θ²/(2ml²) - mgl cosθ"


def judged(question, **answer):
    claim = claim_from({"id": "a", "parameters": SIGNS, **question, **answer})
    assert not claim.errors
    return [judgement for judgement, _ in judgements(claim)][-1]


def bracket(value):
    return {"pairs": [{"f": "x*p_y - y*p_x", "g": "x", "value": value}]}


@pytest.mark.parametrize(
    ("question", "answer"),
    [
        (H, {"H": f"H = {RIGHT}"}),
        (H, {"H": f"H(θ, p_θ) = {RIGHT}."}),
        (H, {"H": f"H = T + V = {RIGHT}"}),
        (H, {"H": f"H = p_θ θ̇ - ½ml²θ̇² - mgl cosθ = {RIGHT}"}),
        (EL, {"claim": ["d/dt(m l² θ̇) = -mgl sinθ"]}),
        (EL, {"claim": ["d/dt(∂L/∂θ̇) - ∂L/∂θ = m l² θ̈ + m g l sin θ = 0"]}),
        (EL, {"claim": ["d/dt(∂L/∂θ̇) - ∂L/∂θ = m l² θ̈ + m g l sin θ"]}),
        (EL, {"claim": ["d/dt(m l² θ̇) = m l² θ̈ = -mgl sinθ"]}),
        (EL, {"claim": ["Eq(Derivative(theta(t), (t, 2)), -g*sin(theta(t))/l)"]}),
        (EL, {"claim": ["θ''[t] == -(g/l) Sin[θ[t]]"]}),
        (EL, {"claim": ["<p>m l<sup>2</sup> &theta;'' + m g l sin &theta; = 0</p>"]}),
        (HE, {"q_dot": "ẏ = p_y/m, ẋ = p_x/m", "p_dot": "(-kx, -ky)"}),
        (HE, {"q_dot": ["dx/dt = p_x/m", "y' = ∂H/∂p_y = p_y/m"], "p_dot": ["ṗ_x = -k x", "dp_y/dt = -k y"]}),
        (PB, bracket("{L_z, x} = y")),
    ],
)
def test_holds(question, answer):
    assert judged(question, **answer).status == "holds"


@pytest.mark.parametrize(
    ("question", "answer"),
    [
        (H, {"H": "H = p_θ²/(2ml²) + mgl cosθ"}),
        (H, {"H": f"H = p_θ θ̇ + ½ml²θ̇² - mgl cosθ = {RIGHT}"}),
        (H, {"H": f"H = {RIGHT} + 1 = {RIGHT}"}),
        (EL, {"claim": ["d/dt(m l² θ̇) = mgl sinθ"]}),
        (EL, {"claim": ["d/dt(∂L/∂θ̇) - ∂L/∂θ = m l² θ̈ - m g l sin θ"]}),
        (EL, {"claim": ["ml²θ̈ = -mglsinθ = 0"]}),
        (EL, {"claim": ["θ̈ = -(g/l) sinθ and θ̈ = -(g/l) cosθ"]}),
        (HE, {"q_dot": "ẏ = p_x/m, ẋ = p_y/m", "p_dot": "(-kx, -ky)"}),
        (PB, bracket("{L_z, x} = -y")),
    ],
)
def test_fails(question, answer):
    assert judged(question, **answer).status == "fails"


@pytest.mark.parametrize(
    ("question", "answer", "told"),
    [
        (H, {"H": f"K = {RIGHT}"}, "H is asked for here, and this says K = …"),
        (H, {"H": f"p_θ = {RIGHT}"}, "H is asked for here, and this says p_θ = …"),
        (H, {"H": f"H = T - V = {RIGHT}"}, "T is not declared"),
        (H, {"H": f"H = {RIGHT}; p_θ = 3"}, "another statement beside H"),
        (EL, {"claim": ["d/dt(∂L/∂θ̇) - ∂L/∂θ = 0"]}, "true of every system"),
        (EL, {"claim": ["d/dt(∂L/∂θ̇) = m l² θ̈"]}, "no equation of motion"),
        (PB, bracket("{x, L_z} = y"), "is asked for here, and this says {x, L_z}"),
        (PB, bracket("{L_z, y} = y"), "is asked for here, and this says {L_z, y}"),
        (EL, {"claim": ["h θ̈ = w"]}, "h is not declared"),
    ],
)
def test_what_contradicts_the_question_is_told(question, answer, told):
    found = judged(question, **answer)
    assert found.status == "invalid"
    assert told in found.known
    assert "declare " not in found.known


LIE = {"kind": "lie-bracket", "x": ["x", "y"], "X": ["y", "0"], "Y": ["0", "x"], "parameters": {}}


@pytest.mark.parametrize(
    ("form", "twin"),
    [
        (r"$\begin{pmatrix} -x \\ y \end{pmatrix}$", r"$\begin{pmatrix} y \\ -x \end{pmatrix}$"),
        (r"\left[\begin{matrix}- x\\y\end{matrix}\right]", r"\left[\begin{matrix}x\\y\end{matrix}\right]"),
        (r"\begin{bmatrix} -x & y \end{bmatrix}", r"\begin{bmatrix} -x & -y \end{bmatrix}"),
        ("Matrix([-x, y])", "Matrix([-x, x])"),
        ("sp.Matrix([[-x], [y]])", "sp.Matrix([[y], [-x]])"),
        ("Matrix([[-x, y]])", "Matrix([[y, -x]])"),
    ],
)
def test_vectors_are_read_from_columns_and_rows(form, twin):
    assert judged(LIE, claim=form).status == "holds"
    assert judged(LIE, claim=twin).status == "fails"


@pytest.mark.parametrize(
    "claim",
    [
        "(" + "1, " * 10_000 + "1)",
        "Matrix([" + "[x], " * 10_000 + "[x]])",
        r"\begin{pmatrix}" + r"x \\ " * 10_000 + r"y \end{pmatrix}",
        "Matrix([" * 500 + "x" + "])" * 500,
    ],
    ids=("bracket", "column", "latex", "nested"),
)
def test_vectors_of_thousands_are_refused_at_once(claim):
    start = time.process_time()
    assert judged(LIE, claim=claim).status == "invalid"
    assert time.process_time() - start < 4


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("Integral(k*x, (x, 0, a))", "a is not declared"),
        ("∫ k x dx", "a lower and an upper limit"),
        ("Sum(k*x**n, (n, 1, 10**9))", "from 1 to 100 terms"),
        (r"$\sum_{n=1}^{10^9} k x^n$", "numbers up to 9"),
        ("x' = ±k ± x", "is each ± chosen by itself here"),
        ("Matrix([[k, 0], [0, k]])", "write the components one by one"),
        (
            f"Matrix([{', '.join('[' + ', '.join('1' * 50) + ']' for _ in range(100))}])",
            "write the components one by one",
        ),
    ],
)
def test_what_is_not_read_is_told_with_what_to_write(text, told):
    found = judged({"kind": "euler-lagrange", "q": ["x"], "L": "x_dot**2/2 - k*x**2/2"}, claim=[text])
    assert found.status == "invalid"
    assert told in found.known


LISTS = [
    "[Eq(m*Derivative(x(t), (t, 2)), -k*x(t)), Eq(y(t).diff(t, 2), -g)]",
    "{m x''[t] == -k x[t], y''[t] == -g}",
    "Matrix([[m*x'' + k*x], [y'' + g]])",
    r"\begin{pmatrix} m\ddot x \\ \ddot y \end{pmatrix} = \begin{pmatrix} -kx \\ -g \end{pmatrix}",
    "matrix([m*x'' + k*x],[y'' + g])",
    "<p>m x'' = -k x</p><p>y'' = -g</p>",
]


TWO = {
    "kind": "euler-lagrange",
    "q": ["x", "y"],
    "L": "m*(x_dot**2 + y_dot**2)/2 - k*x**2/2 - m*g*y",
}


@pytest.mark.parametrize("typed", LISTS)
def test_equations_in_one_list_or_matrix_are_judged_one_by_one(typed):
    assert judged(TWO, claim=[typed]).status == "holds"
    wrong = typed.replace("k", "3*k", 1) if "begin" not in typed else typed.replace("-k", "-3k")
    assert judged(TWO, claim=[wrong]).status == "fails"


def test_a_name_may_stand_before_a_column():
    field = {"kind": "lie-bracket", "x": ["x", "y"], "X": ["y", "0"], "Y": ["0", "x"]}
    assert judged(field, claim=r"Z = \begin{pmatrix} -x \\ y \end{pmatrix}").status == "holds"
    assert judged(field, claim=r"Z = \begin{pmatrix} x \\ y \end{pmatrix}").status == "fails"


SPRING = {"parameters": {"m": "positive", "k": "positive", "a": "real"}, "q": ["x"]}
HAMILTON = {**SPRING, "kind": "hamilton-equations", "p": ["p"], "H": "p²/2m + kx²/2", "q_dot": "p/m"}
LAGRANGE = {**SPRING, "kind": "euler-lagrange", "L": "mẋ²/2 - kx²/2"}
DAMPED = {**LAGRANGE, "kind": "dissipative", "F": "aẋ²/2"}
FORCE = {**SPRING, "kind": "generalized-force", "V": "ax²"}


@pytest.mark.parametrize(
    ("question", "right", "wrong"),
    [
        (HAMILTON, {"p_dot": "ṗ = -∂H/∂x = -kx"}, {"p_dot": "ṗ = ∂H/∂x = -kx"}),
        (HAMILTON, {"p_dot": "-∂H/∂x = -kx"}, {"p_dot": "∂H/∂x = -kx"}),
        (
            HAMILTON,
            {"p_dot": r"$\dot p = -\frac{\partial H}{\partial x} = -kx$"},
            {"p_dot": r"$\dot p = -\frac{\partial H}{\partial p} = -kx$"},
        ),
        (HAMILTON, {"p_dot": "{p, H} = -kx"}, {"p_dot": "{x, H} = -kx"}),
        (LAGRANGE, {"claim": ["mẍ = ∂L/∂x = -kx"]}, {"claim": ["mẍ = -∂L/∂x = -kx"]}),
        (LAGRANGE, {"claim": ["mẍ = ∂L/∂x = -kx"]}, {"claim": ["mẍ = ∂L/∂ẋ = -kx"]}),
        (LAGRANGE, {"claim": ["∂L/∂x = -kx = mẍ"]}, {"claim": ["∂L/∂ẋ = -kx = mẍ"]}),
        (LAGRANGE, {"claim": ["d/dt(∂L/∂ẋ) = -kx = mẍ"]}, {"claim": ["d/dt(∂L/∂ẋ) = kx = mẍ"]}),
        (
            LAGRANGE,
            {"claim": ["d/dt(∂L/∂ẋ) - ∂L/∂x = mẍ + kx = 0"]},
            {"claim": ["d/dt(∂L/∂ẋ) + ∂L/∂x = mẍ + kx = 0"]},
        ),
        (
            DAMPED,
            {"claim": ["d/dt(∂L/∂ẋ) - ∂L/∂x + ∂F/∂ẋ = mẍ + aẋ + kx = 0"]},
            {"claim": ["d/dt(∂L/∂ẋ) - ∂L/∂x - ∂F/∂ẋ = mẍ + aẋ + kx = 0"]},
        ),
        (DAMPED, {"claim": ["mẍ + kx = -∂F/∂ẋ = -aẋ"]}, {"claim": ["mẍ + kx = ∂F/∂ẋ = -aẋ"]}),
        (DAMPED, {"claim": ["d/dt(∂L/∂ẋ) - ∂L/∂x = -aẋ"]}, {"claim": ["d/dt(∂L/∂ẋ) - ∂L/∂x = aẋ"]}),
        (FORCE, {"Q": ["Q_x = -∂V/∂x = -2ax"]}, {"Q": ["Q_x = ∂V/∂x = -2ax"]}),
    ],
)
def test_where_a_formula_comes_from_is_worked_out(question, right, wrong):
    assert judged(question, **right).status == "holds"
    assert judged(question, **wrong).status == "fails"


def test_what_is_made_of_functions_that_nobody_gave_is_passed_over():
    found = judged({**FORCE, "V": "ax²"}, Q=["Q_x = -∂U/∂x = -2ax"])
    assert found.status == "holds"
    assert any("is passed over" in line for line in found.warnings)
