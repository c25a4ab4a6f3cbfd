"""Forms that strangers typed: each is read as it is meant, its wrong twin fails, and what is open is asked about."""

import pytest

from canon.exercise import Claim, InvalidClaim, judge

SIGNS = {"m": "positive", "k": "positive", "g": "positive", "l": "positive"}
OSCILLATOR = {"q": ["x"], "L": "m*x_dot**2/2 - k*x**2/2"}
CENTRAL = {"q": ["r", "phi"], "p": ["p_r", "p_phi"], "L": "m*(r_dot**2 + r**2*phi_dot**2)/2"}
PLANE = {"q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2 - k*(x**2 + y**2)/2 - m*g*y"}
PENDULUM = {"q": ["theta"], "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)"}
IN_PHASE_SPACE = {"q": ["x", "y"], "p": ["p_x", "p_y"], "H": "(p_x**2 + p_y**2)/(2*m) + k*(x**2 + y**2)/2"}


def status(kind, **keys):
    """Return what is judged of a claim; a claim that is not read raises its error."""
    return judge(Claim("a", kind, {"parameters": SIGNS, **keys})).status.value


def equation(form, system=OSCILLATOR):
    return status("euler-lagrange", **system, claim=[form])


def hamiltonian(form, system):
    return status("legendre-hamiltonian", **{"p": ["p"], **system}, H=form)


ACCELERATIONS = [
    (r"m\partial_t^2 x + kx = 0", r"m\partial_t^2 x - kx = 0"),
    (r"m\partial^2_t x = -kx", r"m\partial_t x = -kx"),
    (r"m\partial_{tt} x = -kx", r"m\partial_{tt} x = -2kx"),
    (r"m\partial_t \dot x = -kx", r"m\partial_t \dot x = kx"),
    ("m*D(D(x))(t) + k*x(t) = 0", "m*D(x)(t) + k*x(t) = 0"),
]


@pytest.mark.parametrize(("form", "twin"), ACCELERATIONS)
def test_derivatives_by_the_time(form, twin):
    assert equation(form) == "holds"
    assert equation(twin) == "fails"


@pytest.mark.parametrize("form", [r"m\partial_t^2 x k = 0", r"m\partial_t^2 x^2 = 0", "D(m*D(x))(t) = 0"])
def test_derivatives_of_which_it_is_open_what_they_reach(form):
    with pytest.raises(InvalidClaim):
        equation(form)


def test_a_derivative_of_maple_is_that_of_a_declared_function():
    system = {"q": ["x"], "L": "m*x_dot**2/2 - V(x)", "functions": {"V": ["x"]}}
    assert equation("m*D(D(x))(t) = -D(V)(x)", system) == "holds"
    assert equation("m*D(D(x))(t) = -D(D(V))(x)", system) == "fails"


@pytest.mark.parametrize(
    "label",
    [
        r"H_{\text{total}} = ",
        r"H_\mathrm{tot} = ",
        "H_total = ",
        "E = ",
        "E = T + U = ",
        "E(x, p) = T + V = ",
    ],
)
def test_other_names_of_a_hamiltonian(label):
    assert hamiltonian(label + r"\frac{p^2}{2m} + \frac12 kx^2", OSCILLATOR) == "holds"
    assert hamiltonian(label + r"\frac{p^2}{2m} - \frac12 kx^2", OSCILLATOR) == "fails"


@pytest.mark.parametrize("label", ["L = ", "E = T - U = ", "T = ", "H_0 = "])
def test_names_of_something_else_are_told(label):
    with pytest.raises(InvalidClaim, match=r"is asked for here|not declared"):
        hamiltonian(f"{label}p**2/(2*m) + k*x**2/2", OSCILLATOR)


def test_a_declared_E_is_no_name_of_the_hamiltonian():
    with pytest.raises(InvalidClaim, match="is asked for here"):
        hamiltonian("E = p**2/(2*m) + k*x**2/2", {**OSCILLATOR, "parameters": {**SIGNS, "E": "real"}})


OVER_WORDS = [r"\frac{p_r^2}{2m} + p_φ²/2mr²", r"p_r^2/2m + p_\phi^2/2mr^2", "p_r²/2m + p_φ²/2mr²"]


@pytest.mark.parametrize("form", OVER_WORDS)
def test_a_momentum_over_a_word_is_over_all_of_it(form):
    assert hamiltonian(form, CENTRAL) == "holds"
    assert hamiltonian(form.replace("mr", "m^2r"), CENTRAL) == "fails"


@pytest.mark.parametrize(
    "form", [r"p_\phi^2/2m r^2", r"p_\phi^2/2m\,r^2", r"p_\phi^2/2rm", r"k/2mr^2", r"p_\phi^2/2mr^2\sin\phi"]
)
def test_a_gap_before_the_last_factor_is_asked_about(form):
    with pytest.raises(InvalidClaim, match="does the quotient end"):
        hamiltonian(r"\frac{p_r^2}{2m} + " + form, CENTRAL)


@pytest.mark.parametrize(
    ("form", "readings"),
    [
        ("θ'' + g sin l / m = 0", r"sin\(l\)/m or sin\(l/m\)"),
        ("m θ'' + m g sinθ/2 = 0", r"sin\(θ\)/2 or sin\(θ/2\)"),
        (r"\ddot\theta + g\sin\theta / 2 = 0", r"sin\(theta\)/2 or sin\(theta/2\)"),
    ],
)
def test_a_slash_behind_a_bare_argument_is_asked_about_with_both_readings(form, readings):
    with pytest.raises(InvalidClaim, match=readings):
        equation(form, PENDULUM)


@pytest.mark.parametrize(
    "form", ["θ'' + g sin θ / l = 0", "m θ'' + m g sinθ/l = 0", r"\ddot\theta + g\sin\theta / l = 0"]
)
def test_nobody_divides_an_angle_by_a_length(form):
    assert equation(form, PENDULUM) == "holds"
    assert equation(form.replace("+", "-"), PENDULUM) == "fails"


ONE, BOTH = r"\begin{bmatrix}x\\0\end{bmatrix}", r"\begin{pmatrix}x\\y\end{pmatrix}"
MATRICES = [
    r"m\begin{pmatrix}\ddot x\\ \ddot y\end{pmatrix} = \begin{pmatrix}-kx\\-ky-W\end{pmatrix}",
    r"\left[\begin{matrix}m&0\\0&m\end{matrix}\right]\begin{bmatrix}\ddot x\\ \ddot y + ky/m + W/m\end{bmatrix} = -k"
    + ONE,
    r"$$m\left(\begin{matrix}\ddot x\\ \ddot y\end{matrix}\right) = -k"
    + BOTH
    + r" - W \begin{pmatrix}0\\1\end{pmatrix}$$",
    "m*Matrix([x'', y'']) = Matrix([-k*x, -k*y - W])",
    "Matrix([[0, m], [m, 0]])*Matrix([y'', x'']) = Matrix([-k*x, -k*y - W])",
    "np.array([[m, 0], [0, m]]) @ np.array([x'', y'']) = np.array([-k*x, -k*y - W])",
]


@pytest.mark.parametrize("form", MATRICES)
def test_products_and_sums_of_matrices(form):
    weight = "m g" if "\\" in form else "m*g"
    assert equation(form.replace("W", weight), PLANE) == "holds"
    assert equation(form.replace("W", f"2 {weight}"), PLANE) == "fails"


@pytest.mark.parametrize(
    "form",
    [
        r"m\begin{pmatrix}\ddot x\\ \ddot y\end{pmatrix} = \begin{pmatrix}-kx\end{pmatrix}",
        r"m\begin{pmatrix}\ddot x\\ \ddot y\end{pmatrix}^2 = 0",
        r"m\begin{pmatrix}\ddot x & \ddot y\end{pmatrix} = " + BOTH + BOTH,
        r"m\begin{pmatrix}\ddot x & \ddot y\end{pmatrix} + k" + BOTH + " = 0",
        "np.array([[m, 0], [0, m]]) * np.array([x'', y'']) = 0",
        "m*Matrix([x'', y'']) + k = 0",
        "m**Matrix([x'', y'']) = -k*Matrix([x, y])",
        "m*Matrix([x'', y'']) = -k**Matrix([x, y])",
        "Matrix([[0, m], [m, 0]])**Matrix([y'', x'']) = -k*Matrix([x, y])",
    ],
)
def test_what_is_no_sum_of_vectors_of_one_length_is_not_read(form):
    with pytest.raises(InvalidClaim):
        equation(form, PLANE)


def test_an_undeclared_name_in_a_product_is_told_at_its_column():
    with pytest.raises(InvalidClaim, match="column 27: h is not declared"):
        equation("m*Matrix([x'', y'']) = h*Matrix([x, y])".replace("= h", "=    h"), PLANE)


def test_components_by_a_product():
    fields = {"x": ["x", "y"], "X": ["y", "0"], "Y": ["0", "x"]}
    form = r"[X, Y] = \begin{pmatrix}-1&0\\0&1\end{pmatrix}\begin{pmatrix}A\\y\end{pmatrix}"
    assert status("lie-bracket", **fields, claim=form.replace("A", "x")) == "holds"
    assert status("lie-bracket", **fields, claim=form.replace("A", "-x")) == "fails"


@pytest.mark.parametrize(
    "force", ["F_x = -kx, F_y = -A", ["F_y = -A", "F_x = -kx"], ["F_1 = -kx", "F_2 = -A"]]
)
def test_forces_and_velocities_by_their_letters(force):
    def judged(right):
        said = force.replace("A", right) if isinstance(force, str) else [f.replace("A", right) for f in force]
        velocity = ["v_x = p_x/m", "v_y = p_y/m"]
        return status("hamilton-equations", **IN_PHASE_SPACE, q_dot=velocity, p_dot=said)

    assert judged("ky") == "holds"
    assert judged("kx") == "fails"


@pytest.mark.parametrize(
    ("form", "means", "twin"),
    [
        (r"\binom{4}{2} x", "6*x", "4*x"),
        (r"2\tbinom{5}{1} x", "10*x", "5*x"),
        (r"\sin^{-1}{(x)}^{2}", "asin(x)**2", "asin(x**2)"),
        (r"\cos^{-1}(x)^2", "acos(x)**2", "acos(x**2)"),
        (r"\tan^{-1}(x^2)", "atan(x**2)", "atan(x)**2"),
    ],
)
def test_binomial_coefficients_and_powers_of_inverse_functions(form, means, twin):
    keys = {"parameters": {"x": "positive"}, "domain": ["x < 1"], "lhs": form}
    assert status("equality-only", **keys, rhs=means) == "holds"
    assert status("equality-only", **keys, rhs=twin) == "fails"


@pytest.mark.parametrize("form", [r"\binom{n}{2} x", r"\binom{1000}{500} x", r"\sin^2(x)^2"])
def test_what_is_not_read_of_them(form):
    with pytest.raises(InvalidClaim):
        status("equality-only", parameters={"x": "positive", "n": "integer"}, lhs=form, rhs="x")
