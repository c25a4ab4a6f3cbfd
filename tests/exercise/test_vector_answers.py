"""Vectors and matrices of one column or row as they are typed: components and equations, each with a wrong twin."""

import pytest

from canon.exercise import Claim, InvalidClaim, judge

FIELDS = {"x": ["x", "y"], "X": ["y", "0"], "Y": ["0", "x"]}
OSCILLATOR = {
    "q": ["x", "y"],
    "L": "m*(x_dot**2 + y_dot**2)/2 - k*(x**2 + y**2)/2",
    "parameters": {"m": "positive", "k": "positive"},
}

COMPONENTS = [
    "Matrix([[A], [B]])",
    "Matrix([A, B])",
    "(A, B)",
    "[A, B]",
    "{A, B}",
    "{{A}, {B}}",
    "{{A, B}}",
    "[[A], [B]]",
    "[[A, B]]",
    "ImmutableDenseMatrix([[A], [B]])",
    "matrix([A], [B])",
    "np.array([A, B])",
    "⟨A, B⟩",
    "(A, B)^T",
    "MatrixForm[{A, B}]",
    "{A, B} // MatrixForm",
    r"\begin{pmatrix} A \\ B \end{pmatrix}",
    r"\begin{bmatrix} A & B \end{bmatrix}",
    r"\left[\begin{matrix}A\\B\end{matrix}\right]",
    r"\left(\begin{array}{c} A \\ B \end{array}\right)",
    r"[X,Y] = \begin{pmatrix} A \\ B \end{pmatrix}",
    r"\langle A, B \rangle",
    r"$(A,\; B)^\top$",
    r"\vec{v} = (A, B)",
]


@pytest.mark.parametrize("form", COMPONENTS)
def test_components_are_read_in_their_order(form):
    def status(first, second):
        claim = form.replace("A", first).replace("B", second)
        return judge(Claim("a", "lie-bracket", {**FIELDS, "claim": claim})).status.value

    assert status("-x", "y") == "holds"
    assert status("-x", "-y") == "fails"
    assert status("y", "-x") == "fails"


EQUATIONS = [
    r"\begin{pmatrix} m\ddot x + kx \\ m \ddot y + K \end{pmatrix} = 0",
    r"\begin{pmatrix} m\ddot x \\ m \ddot y\end{pmatrix} = \begin{pmatrix} -kx \\ -K\end{pmatrix}",
    "Matrix([[m*x''], [m*y'']]) = Matrix([[-k*x], [-(K)]])", "Eq(Matrix([[m*x''], [m*y'']]), Matrix([[-k*x], [-(K)]]))",
    "{m x'', m y''} == {-k x, -(K)}", "(m x'', m y'') = (-k x, -(K))", "[m*x'' + k*x, m*y'' + K]",
    "Matrix([m*x'' + k*x, m*y'' + K]) = 0", "{m x'' + k x, m y'' + K} = {0, 0}",
]  # fmt: skip


@pytest.mark.parametrize("form", EQUATIONS)
def test_equations_of_vectors_are_those_of_their_components(form):
    for right, said in (("k y", "holds"), ("2 k y", "fails"), ("k x", "fails")):
        claim = form.replace("K", right)
        assert judge(Claim("a", "euler-lagrange", {**OSCILLATOR, "claim": claim})).status.value == said


@pytest.mark.parametrize(
    "text",
    ["{x, y} = 0", "(m x'', m y'') = (-k x, -k y, 0)", r"\begin{pmatrix} m & 0 \\ 0 & m \end{pmatrix} = 0",
     "{m x'', m y''} == {-k x, -k y} == {0, 0}", "Eq(Matrix([m*x'', m*y'']), 0, 0)"],
)  # fmt: skip
def test_what_may_mean_something_else_is_not_read(text):
    with pytest.raises(InvalidClaim):
        judge(Claim("a", "euler-lagrange", {**OSCILLATOR, "claim": text}))
