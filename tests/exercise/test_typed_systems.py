"""Systems as they are typed: matrices and columns, indices, sums over them, capitals; each with its wrong twin."""

import pytest

from canon.exercise import Claim, InvalidClaim, judge

SIGNS = dict.fromkeys(("m", "k", "g", "l", "m1", "m2"), "positive")
OSCILLATOR = {"q": ["x"], "L": "m*x_dot**2/2 - k*x**2/2"}
PENDULUM = {"q": ["theta"], "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)"}
COUPLED = {"q": ["x1", "x2"], "L": "m*(x1_dot**2 + x2_dot**2)/2 - k*x1**2/2 - k*x2**2/2 - k*(x1 - x2)**2/2"}
APART = {"q": ["x1", "x2"], "L": "m1*x1_dot**2/2 + m2*x2_dot**2/2 - k*x1**2/2 - k*x2**2/2"}
THROWN = {"q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2 - m*g*y"}
CART = {
    "q": ["x", "phi"],
    "L": "(m1 + m2)*x_dot**2/2 + m2*(l**2*phi_dot**2 + 2*l*x_dot*phi_dot*cos(phi))/2 + m2*g*l*cos(phi)",
}
TOP = {
    "x": ["w1", "w2", "w3"],
    "X": ["(I2 - I3)*w2*w3/I1", "(I3 - I1)*w3*w1/I2", "(I1 - I2)*w1*w2/I3"],
    "parameters": dict.fromkeys(("I1", "I2", "I3"), "positive"),
}


def judged(kind, system, key, said):
    """Return what is judged of one answer; ``invalid`` of one that is not read."""
    keys = {"parameters": SIGNS, **system, key: [said] if key == "claim" else said}
    try:
        return judge(Claim("a", kind, keys)).status.value
    except InvalidClaim:
        return "invalid"


MASSES = "[[m1+m2, m2 l cos(phi)], [m2 l cos(phi), m2 l^2]] (x'', phi'')^T + (-m2 l sin(phi) phi'^2, 0)^T"
EQUATIONS = [
    (OSCILLATOR, "d/dt [x; v] = [0 1; {}k/m 0] [x; v]", "-", "+"),
    (OSCILLATOR, "z' = A z, A = [0 1; {}k/m 0], z = [x; v]", "-", "2*"),
    (OSCILLATOR, "[x', v']^T = [0, 1; -k/m, {}] [x, v]^T", "0", "1"),
    (COUPLED, "M q'' + K q = 0, M = diag(m, m), K = [[2k, -k], [{}k, 2k]], q = (x1, x2)^T", "-", "+"),
    (COUPLED, "M*q'' = {}K*q with M = diag(m, m) and K = [2*k -k; -k 2*k] and q = [x1; x2]", "-", "+"),
    (COUPLED, "[m 0; 0 m] [x1''; x2''] = {}[2k -k; -k 2k] [x1; x2]", "-", "+"),
    (COUPLED, "m (x1'', x2'')ᵀ = k [[-2, 1], [{}, -2]] (x1, x2)ᵀ", "1", "-1"),
    (CART, f"{MASSES} + (0, {{}}m2 g l sin(phi))^T = 0", "+", "-"),
    (APART, "m_i x_i'' = {}k x_i, i = 1, 2", "-", "+"),
    (APART, "m_i x_i'' + {} x_i = 0 for i = 1, 2", "k", "2k"),
    (APART, "m_i x_i² x_i'' = {}k x_i³, i = 1, 2", "-", "+"),
    (THROWN, "m x''_i = -m g delta_{i{}}, i = 1, 2, (x_1, x_2) = (x, y)", "2", "1"),
    (PENDULUM, "Theta'' {} g/l*Sin(Theta) = 0", "+", "-"),
    (PENDULUM, "Θ'' {} g/l*sin(Θ) = 0", "+", "-"),
    (OSCILLATOR, "M X'' {} K X = 0", "+", "-"),
    (OSCILLATOR, "X'' = {}k/m X", "-", "+"),
]


@pytest.mark.parametrize(("system", "said", "right", "wrong"), EQUATIONS)
def test_systems_of_equations(system, said, right, wrong):
    assert judged("euler-lagrange", system, "claim", said.replace("{}", right)) == "holds"
    assert judged("euler-lagrange", system, "claim", said.replace("{}", wrong)) == "fails"


SUMS = [
    ("sum_{i=1}^{3} {} = 2T", "I_i w_i^2", "I_i w_i"),
    ("½ Σ_i {}", "I_i w_i²", "w_i²"),
    ("∑_{k=1}^3 {} = const", "I_k² w_k²", "I_k³ w_k²"),
    ("Σᵢ {}", "Iᵢ wᵢ²", "Iᵢ wᵢ³"),
    ("2T = sum_(i=1)^{}", "3 (I_i w_i^2)", "2 (I_i w_i^2)"),
]


@pytest.mark.parametrize(("said", "right", "wrong"), SUMS)
def test_sums_over_an_index(said, right, wrong):
    assert judged("constant-of-motion", TOP, "I", said.replace("{}", right)) == "holds"
    assert judged("constant-of-motion", TOP, "I", said.replace("{}", wrong)) == "fails"


def test_an_answer_in_capitals():
    asked = {**OSCILLATOR, "p": ["p"]}
    said = "H = P^2/({}M) + K X^2/2"
    assert judged("legendre-hamiltonian", asked, "H", said.replace("{}", "2")) == "holds"
    assert judged("legendre-hamiltonian", asked, "H", said.replace("{}", "")) == "fails"


REFUSED = [
    ("euler-lagrange", OSCILLATOR, "claim", "[x; v]' = [0 1; -k/m 0] [x; v]"),
    ("euler-lagrange", OSCILLATOR, "claim", "z' = A z, A = [0 1; -k/m 0]"),
    ("euler-lagrange", OSCILLATOR, "claim", "d/dt [x; v] = [0 1 0; -k/m 0 0] [x; v]"),
    ("euler-lagrange", OSCILLATOR, "claim", "z' = A z, A = [0 1; -k/m 0] or A = [0 1; k/m 0], z = [x; v]"),
    ("euler-lagrange", COUPLED, "claim", "M^-1 K q = -q'', M = diag(m, m), K = [2k -k; -k 2k], q = [x1; x2]"),
    ("euler-lagrange", COUPLED, "claim", "m q'' + K q = 0, m = diag(m, m), K = [2k -k; -k 2k], q = [x1; x2]"),
    ("euler-lagrange", COUPLED, "claim", "q'^T M q' = 0, M = diag(m, m), q = [x1; x2]"),
    ("euler-lagrange", APART, "claim", "m_i x_i'' = -k x_i"),
    ("euler-lagrange", APART, "claim", "m_i x_i'' = -k x_i, i = 1, 3"),
    ("euler-lagrange", APART, "claim", "m_i x_i'' = -k x_j, i = 1, 2"),
    ("euler-lagrange", APART, "claim", "m_i x_i'' = -i k x_i, i = 1, 2"),
    ("euler-lagrange", THROWN, "claim", "m x''_i = -m g delta_{i2}, i = 1, 2"),
    ("euler-lagrange", PENDULUM, "claim", "Theta'' + g/l*sin(theta) = 0"),
    ("euler-lagrange", PENDULUM, "claim", "Theta*phi'' = -m*g*l*sin(phi)"),
    ("euler-lagrange", THROWN, "claim", "X'' = 0; Y'' = -g"),
    ("euler-lagrange", OSCILLATOR, "claim", "M X'' = -k X"),
    ("legendre-hamiltonian", {**OSCILLATOR, "p": ["p"]}, "H", "H = P^2/(2m) + k x^2/2"),
    ("legendre-hamiltonian", {**OSCILLATOR, "p": ["p"]}, "H", "H = K + V"),
    ("legendre-hamiltonian", {**OSCILLATOR, "p": ["p"]}, "H", "H = (l/2) p^2/m + (O/2) k x^2"),
    ("constant-of-motion", TOP, "I", "Σ_i I_i w_i^2 + w_i"),
    ("constant-of-motion", TOP, "I", "Σ_i I_i w_j^2"),
    ("constant-of-motion", TOP, "I", "Σ I w²"),
    ("constant-of-motion", TOP, "I", "sum_{i=1}^4 I_i w_i^2"),
]


@pytest.mark.parametrize(("kind", "system", "key", "said"), REFUSED)
def test_what_may_be_meant_otherwise_is_refused(kind, system, key, said):
    assert judged(kind, system, key, said) == "invalid"


def test_capitals_that_are_defined_or_declared_keep_their_meaning():
    assert judged("euler-lagrange", OSCILLATOR, "claim", "X'' = -(k/m) X, X = 2 x") == "holds"
    assert judged("euler-lagrange", OSCILLATOR, "claim", "X'' = -(k/m) X, X = 2") != "holds"
    declared = {**PENDULUM, "parameters": {**SIGNS, "Theta": "real"}}
    assert judged("euler-lagrange", declared, "claim", "Theta'' + g/l*sin(Theta) = 0") == "invalid"
