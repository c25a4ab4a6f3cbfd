"""Chains and definitions as a stranger typed them: d for ∂ of a given function, speeds, V(x) said behind H, δ."""

import pytest

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.sheet.sheet import Claim

SPRING = {"m": "positive", "k": "positive"}
PHASE = {"q": ["x"], "p": ["p"], "parameters": SPRING}
HAMILTON = {**PHASE, "H": "p**2/(2*m) + k*x**2/2"}
LEGENDRE = {**PHASE, "L": "m*x_dot**2/2 - k*x**2/2"}
DAMPED = {
    "q": ["x"],
    "parameters": {**SPRING, "c": "positive"},
    "L": "m*x_dot**2/2 - k*x**2/2",
    "F": "c*x_dot**2/2",
}
BODY = {"q": ["x", "y"], "parameters": {"m": "positive"}, "bodies": [{"m": "m", "r": ["x", "y"]}]}
PENDULUM = {
    "q": ["theta"],
    "parameters": {"g": "positive", "l": "positive"},
    "L": "l**2*theta_dot**2/2 + g*l*cos(theta)",
    "equilibrium": {"theta": "0"},
}


def said(kind, **keys):
    """Return the verdict on a claim as a word."""
    return judge(Claim("a", kind, keys, budget=60.0)).status.value


@pytest.mark.parametrize(
    ("q_dot", "p_dot", "due"),
    [
        ("x' = dH/dp = p/m", "p' = -dH/dx = -k x", "holds"),
        ("x' = dH/dp = p/m", "p' = dH/dx = -k x", "fails"),
        ("x' = dH/dp = p/m", "p' = -dH/dx = k x", "fails"),
        ("x' = dH/dp = 2p/m", "p' = -dH/dx = -k x", "fails"),
        ("dx/dt = dH/dp = p/m", "dp/dt = -dH/dx = -k x", "holds"),
        (r"\dot x = \frac{dH}{dp} = \frac pm", r"\dot p = -\frac{dH}{dx} = -kx", "holds"),
        (r"\dot x = \frac{\mathrm{d}H}{\mathrm{d}p} = \frac pm", r"\dot p = -\frac{dH}{dx} = -kx", "holds"),
        (r"\dot x = \frac{dH}{dp} = \frac pm", r"\dot p = \frac{dH}{dx} = -kx", "fails"),
    ],
)
def test_in_hamiltons_equations_d_is_partial(q_dot, p_dot, due):
    assert said("hamilton-equations", **HAMILTON, q_dot=q_dot, p_dot=p_dot) == due


def test_a_total_derivative_by_the_time_stays_one():
    with pytest.raises(InvalidClaim, match="x' is asked for here, and this says dH/dt"):
        said("hamilton-equations", **HAMILTON, q_dot="x' = dH/dt = p/m", p_dot="-k x")


@pytest.mark.parametrize(
    ("gradient", "due"),
    [
        (["dW/dr = sqrt(2m(E + k/r) - l²/r²)", "dW/dphi = l"], "holds"),
        ([r"\frac{dW}{dr} = \sqrt{2m(E + k/r) - l^2/r^2}", r"\frac{dW}{d\phi} = l"], "holds"),
        (["dW/dr = sqrt(2m(E - k/r) - l²/r²)", "dW/dphi = l"], "fails"),
    ],
)
def test_a_gradient_may_be_written_with_d(gradient, due):
    kepler = {
        "q": ["r", "phi"],
        "p": ["pr", "pphi"],
        "H": "(pr^2 + pphi^2/r^2)/(2m) - k/r",
        "constants": ["E", "l"],
        "parameters": {"m": "positive", "k": "positive", "r": "positive"},
    }
    assert said("hamilton-jacobi", **kepler, gradient=gradient) == due


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("T = ½mv² = ½m(ẋ²+ẏ²)", "T = ½mv² = m(ẋ²+ẏ²)"),
        ("T = ½mv² = ½m(ẋ²+ẏ²)", "T = mv² = ½m(ẋ²+ẏ²)"),
        (
            r"T=\frac{1}{2} m \dot{\mathbf{r}}^2=\frac12 m(\dot x^2+\dot y^2)",
            r"T=\frac{1}{2} m \dot{\mathbf{r}}^2=\frac12 m(\dot x^2-\dot y^2)",
        ),
        (
            r"T=\frac{1}{2} m |\dot{\vec r}|^2=\frac12 m(\dot x^2+\dot y^2)",
            r"T=m |\dot{\vec r}|^2=\frac12 m(\dot x^2+\dot y^2)",
        ),
        (
            r"T=\frac12 m \vec v^2=\frac12 m(\dot x^2+\dot y^2)",
            r"T=\frac12 m \vec v^2=\frac13 m(\dot x^2+\dot y^2)",
        ),
    ],
)
def test_the_speed_of_a_body_is_worked_out_in_a_chain(right, wrong):
    assert said("kinetic-energy", **BODY, T=right) == "holds"
    assert said("kinetic-energy", **BODY, T=wrong) == "fails"


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("H = p²/(2m) + V(x), V(x) = ½kx²", "H = p²/(2m) + V(x), V(x) = kx²"),
        ("H = p²/(2m) + V(x) where V(x) = ½kx²", "H = p²/(2m) - V(x) where V(x) = ½kx²"),
        (
            r"H = \frac{p^2}{2m} + V(x), \quad V(x) = \frac12 kx^2",
            r"H = \frac{p^2}{2m} + V(x), \quad V(x) = \frac13 kx^2",
        ),
        ("H(p,q) = p²/2m + ½kx²", "H(p,q) = p²/2m - ½kx²"),
        ("H(q, p, t) = p²/2m + ½kx²", "H(q, p, t) = p²/2m + kx²"),
    ],
)
def test_a_hamiltonian_with_its_arguments_and_a_potential_that_is_said_behind_it(right, wrong):
    assert said("legendre-hamiltonian", **LEGENDRE, H=right) == "holds"
    assert said("legendre-hamiltonian", **LEGENDRE, H=wrong) == "fails"


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("dE/dt = -2F", "dE/dt = 2F"),
        ("dE/dt = -c x'^2 = -2F", "dE/dt = -c x'^2 = -F"),
        (r"\frac{dE}{dt} = -c\dot x^2 = -2F", r"\frac{dE}{dt} = -c\dot x^2 = 2F"),
        (r"\dot E = -2\mathcal{F}", r"\dot E = -\mathcal{F}"),
    ],
)
def test_a_rate_of_energy_may_be_said_by_rayleighs_function(right, wrong):
    assert said("dissipative", **DAMPED, energy_rate=right) == "holds"
    assert said("dissipative", **DAMPED, energy_rate=wrong) == "fails"


def test_a_doubtful_definition_is_told_where_it_stands():
    with pytest.raises(InvalidClaim, match=r"c/2m is c/2\*m or c/\(2\*m\)\?"):
        said("dissipative", **DAMPED, claim="x'' + 2βx' + ω0²x = 0, where β = c/2m, ω0 = √(k/m)")


@pytest.mark.parametrize(("sign", "due"), [("+", "holds"), ("-", "fails")])
def test_definitions_in_a_bracket_behind_a_wide_gap(sign, due):
    claim = rf"\ddot{{x}} + 2\beta\dot{{x}} {sign} \omega_0^2x = 0 \quad (\beta = c/(2m),\ \omega_0^2 = k/m)"
    assert said("dissipative", **DAMPED, claim=claim) == due


@pytest.mark.parametrize(
    "form",
    [
        r"\delta\ddot\theta {} \frac{{g}}{{l}}\delta\theta = 0",
        r"\ddot{{\delta\theta}} {} \frac{{g}}{{l}}\delta\theta = 0",
        r"\frac{{d^2\delta\theta}}{{dt^2}} {} \frac{{g}}{{l}}\delta\theta = 0",
        "δθ'' {} (g/l) δθ = 0",
    ],
)
def test_a_deviation_may_be_called_delta(form):
    assert said("linearisation", **PENDULUM, claim=form.format("+")) == "holds"
    assert said("linearisation", **PENDULUM, claim=form.format("-")) == "fails"


def test_a_coordinate_beside_its_deviation_is_not_read_as_one():
    with pytest.raises(InvalidClaim, match="not declared"):
        said("linearisation", **PENDULUM, claim="δθ'' + (g/l) θ = 0")


@pytest.mark.parametrize(
    "left",
    [
        r"\left\{x,p^2/2\right\}_{P.B.}",
        r"\{x,p^2/2\}_{P.B.}",
        r"\left[x,p^2/2\right]_{\rm P.B.}",
        r"\left\{x,p^2/2\right\}_{PB}",
        r"\left\{x,p^2/2\right\}_{\mathrm{PB}}",
        "{x, p^2/2}_{P.B.}",
        "{x, p^2/2}_PB",
    ],
)
def test_brackets_are_called_poissons(left):
    def value(of):
        pairs = [{"f": "x", "g": "p**2/2", "value": f"{left} = {of}"}]
        return said("poisson-bracket", q=["x"], p=["p"], pairs=pairs)

    assert value("p") == "holds"
    assert value("-p") == "fails"
