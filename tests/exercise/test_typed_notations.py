"""Notations of keyboards and sentences: typed dots, reasons, numbers, maps, told signs; each with its wrong twin.

Beside them near misses: what may say something else, denies, restricts or leaves open stays refused.
"""

import pytest

from canon.exercise import Claim, InvalidClaim, judge

SIGNS = dict.fromkeys(("m", "k", "g", "l", "c", "R", "J", "omega", "alpha"), "positive")
OSCILLATOR = {"q": ["x"], "L": "m*x_dot**2/2 - k*x**2/2"}
PENDULUM = {"q": ["theta"], "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)"}
DAMPED = {**OSCILLATOR, "F": "c*x_dot**2/2"}
PLANE = {"q": ["x", "z"], "L": "m*(x_dot**2 + z_dot**2)/2 - k*(x**2 + z**2)/2"}
KEPLER = {
    "q": ["r", "phi"],
    "L": "m*(r_dot**2 + r**2*phi_dot**2)/2 + k/r",
    "parameters": {**SIGNS, "r": "positive"},
}
ROLLING = {
    "q": ["x", "phi"],
    "L": "m*x_dot**2/2 + J*phi_dot**2/2 + m*g*x*sin(alpha)",
    "constraints": ["x_dot - R*phi_dot"],
    "multipliers": ["lam"],
}
HOOP = {"q": ["theta"], "L": "m*R**2*(theta_dot**2 + omega**2*sin(theta)**2)/2 + m*g*R*cos(theta)"}
PHASE = {"q": ["q"], "p": ["p"]}
TURNED = {
    **PHASE,
    "H": "p**2/(2*m) + m*omega**2*q**2/2",
    "new_q": ["Q"],
    "new_p": ["P"],
    "inverse_map": {"q": ["sqrt(2*P/(m*omega))*sin(Q)"], "p": ["sqrt(2*m*omega*P)*cos(Q)"]},
}
FIELDS = {"x": ["x", "y"], "X": ["-y", "x"], "Y": ["x", "0"]}


def told(kind, **keys):
    """Return what is judged of a claim, and of one that is not read why."""
    try:
        return judge(Claim("a", kind, {"parameters": SIGNS, **keys})).status.value
    except InvalidClaim as error:
        return f"invalid: {error}"


def judged(kind, system, key, said):
    """Return what is judged of one answer."""
    return told(kind, **system, **{key: [said] if key == "claim" and isinstance(said, str) else said})


READ = [
    ("euler-lagrange", OSCILLATOR, "claim", "m*x.. + k*x = 0", "m*x.. - k*x = 0"),
    ("euler-lagrange", OSCILLATOR, "claim", "mx.. = -k x", "mx.. = -k"),
    ("euler-lagrange", OSCILLATOR, "claim", "x.. = -k/m*x", "x.. = k/m*x"),
    ("dissipative", DAMPED, "claim", "m x.. + c x. + k x = 0", "m x.. + c x. - k x = 0"),
    ("dissipative", DAMPED, "claim", "m x.. + k x + c x.; ", "m x.. + k x - c x.; "),
    (
        "euler-lagrange",
        KEPLER,
        "claim",
        "m r.. = m r phi.^2 - k/r^2, m r^2 phi' = const",
        "m r.. = m r phi. - k/r^2, m r^2 phi' = const",
    ),
    (
        "euler-lagrange",
        PENDULUM,
        "claim",
        "z1 = theta, z2 = theta': z1' = z2; z2' = -(g/l) sin(z1)",
        "z1 = theta, z2 = theta': z1' = z2; z2' = (g/l) sin(z1)",
    ),
    ("euler-lagrange", PENDULUM, "claim", "w^2 = g/l: θ'' + w^2 sin θ = 0", "w^2 = l/g: θ'' + w^2 sin θ = 0"),
    ("euler-lagrange", PLANE, "claim", "1) m x'' = -k x 2) m z'' = -k z", "1) m x'' = -k x 2) m z'' = k z"),
    ("euler-lagrange", PLANE, "claim", "a) m x'' = -k x b) m z'' = -k z", "a) m x'' = k x b) m z'' = -k z"),
    (
        "nonholonomic",
        ROLLING,
        "claim",
        ["m x'' = m g sin(alpha) + lam ... (3)", "J phi'' = -R lam ... (4)"],
        ["m x'' = m g sin(alpha) + lam ... (3)", "J phi'' = R lam ... (4)"],
    ),
    ("dissipative", DAMPED, "energy_rate", "dE/dt = -c x'^2 <= 0", "dE/dt = -2 c x'^2 <= 0"),
    ("dissipative", DAMPED, "energy_rate", "dE/dt = x'(m x'' + k x) = -c x'^2 ≤ 0", "dE/dt = c x'^2 ≥ 0"),
    (
        "dissipative",
        DAMPED,
        "energy_rate",
        r"$\dot E = -c\dot x^2 \leq 0$",
        r"$\dot E = -c^2\dot x^2 \leq 0$",
    ),
    ("dissipative", DAMPED, "energy_rate", "dE/dt = -c x'^2 < 0", "dE/dt = -k x'^2 < 0"),
    ("lie-bracket", FIELDS, "claim", "[X,Y] = -y d/dx - x d/dy", "[X,Y] = y d/dx - x d/dy"),
    (
        "transformed-hamiltonian-K",
        TURNED,
        "K",
        "K = H = omega*P since dF/dt = 0 explicitly",
        "K = P/omega since dF/dt = 0",
    ),
    (
        "transformed-hamiltonian-K",
        TURNED,
        "K",
        "K = omega P because F does not depend on t",
        "K = P because F does not depend on t",
    ),
    ("transformed-hamiltonian-K", TURNED, "K", "K = omega P, weil ∂F/∂t = 0", "K = omega, weil ∂F/∂t = 0"),
    (
        "transformed-hamiltonian-K",
        TURNED,
        "K",
        r"$K = \omega P$ since $\frac{\partial F}{\partial t} = 0$",
        r"$K = P$ since $\frac{\partial F}{\partial t} = 0$",
    ),
    (
        "generating-F4",
        {**PHASE, "new_q": ["Q"], "new_p": ["P"], "map": {"Q": ["p"], "P": ["-q"]}},
        "F",
        "F4(p,P) is p times P",
        "F4(p,P) is p times q",
    ),
    ("bilinear-covariant", {**PHASE, "Q": ["2*q"], "P": ["3*p"]}, "factor", "činitel je 6", "činitel je 5"),
    (
        "bilinear-covariant",
        {**PHASE, "Q": ["2*q"], "P": ["3*p"]},
        "factor",
        "The factor is 6.",
        "The factor is 5.",
    ),
    ("bilinear-covariant", {**PHASE, "Q": ["2*q"], "P": ["3*p"]}, "factor", "six", "five"),
    (
        "legendre-hamiltonian",
        {**OSCILLATOR, "p": ["p"]},
        "H",
        "p squared over 2m, plus one half k times x squared",
        "p squared over 2m, minus one half k times x squared",
    ),
    (
        "constant-of-motion",
        HOOP,
        "I",
        "h = ½ m R² (θ̇² − ω² sin²θ) − m g R cos θ is conserved",
        "h = ½ m R² (θ̇² + ω² sin²θ) − m g R cos θ is conserved",
    ),
    ("constant-of-motion", KEPLER, "I", r"$m r^2\dot\phi$ ist erhalten", r"$m r\dot\phi$ ist erhalten"),
    (
        "constant-of-motion",
        KEPLER,
        "I",
        "m r² φ' is a constant of the motion",
        "m r φ' is a constant of the motion",
    ),
    (
        "euler-lagrange",
        KEPLER,
        "claim",
        "m r'' = m r φ'² - k/r²; m r² φ' is conserved",
        "m r'' = m r φ'² - k/r²; m r φ' is conserved",
    ),
    ("euler-lagrange", PLANE, "claim", "m x'' = -k x resp. m z'' = -k z", "m x'' = -k x resp. m z'' = k z"),
    ("euler-lagrange", PLANE, "claim", "m x'' = -k x bzw. m z'' = -k z", "m x'' = k x bzw. m z'' = -k z"),
    (
        "euler-lagrange",
        OSCILLATOR,
        "claim",
        "解：m x'' + k x = 0，即 x'' = -k x/m。",
        "解：m x'' + k x = 0，即 x'' = k x/m。",
    ),
]


@pytest.mark.parametrize(("kind", "system", "key", "form", "twin"), READ)
def test_what_is_read(kind, system, key, form, twin):
    assert judged(kind, system, key, form) == "holds"
    assert judged(kind, system, key, twin) == "fails"


AROUND = [
    "{}, as expected for a pendulum.", "{} as required.", "{}, wie erwartet.", "{}, d'où le résultat.",
    "{}, comme prévu", "{}, come previsto", "{}, como se esperaba.", "{}, was zu zeigen war.", "Man erhält {}",
    "Wir erhalten {}", "{}, onde k é constante.", "{}, where k is constant", "{}, où k est constante",
    "{} because the energy is conserved", "{}, denn die Energie ist konstant",
]  # fmt: skip


@pytest.mark.parametrize("said", AROUND)
def test_sentences_around_a_formula(said):
    for form, twin in (("m x'' = -k x", "m x'' = k x"), (r"$m\ddot x = -kx$", r"$m\ddot x = kx$")):
        assert judged("euler-lagrange", OSCILLATOR, "claim", said.replace("{}", form)) == "holds"
        assert judged("euler-lagrange", OSCILLATOR, "claim", said.replace("{}", twin)) == "fails"


REFUSED = [
    ("dissipative", DAMPED, "claim", "m x.. + k x + c x."),
    ("dissipative", DAMPED, "claim", "m x.. = -k x - c x."),
    ("dissipative", DAMPED, "claim", "m x'' = -c x. - k x"),
    ("euler-lagrange", OSCILLATOR, "claim", "m x... = -k x"),
    ("euler-lagrange", OSCILLATOR, "claim", "m y.. = -k x"),
    ("euler-lagrange", OSCILLATOR, "claim", "k = 0: m x'' = 0"),
    ("euler-lagrange", OSCILLATOR, "claim", "w = 2: m x'' = -k x"),
    ("euler-lagrange", OSCILLATOR, "claim", "w = k: m x'' = -k x"),
    ("euler-lagrange", PLANE, "claim", "1) m x'' = -k x 3) m z'' = -k z"),
    ("euler-lagrange", PLANE, "claim", "m x'' = -k x 2) m z'' = -k z"),
    ("euler-lagrange", PLANE, "claim", "1) m x'' = -k x or 2) m z'' = -k z"),
    ("dissipative", DAMPED, "energy_rate", "dE/dt = -c x'^2 >= 0"),
    ("dissipative", DAMPED, "energy_rate", "dE/dt = c x'^2 <= 0"),
    ("dissipative", {**DAMPED, "parameters": {**SIGNS, "c": "real"}}, "energy_rate", "dE/dt = -c x'^2 <= 0"),
    ("dissipative", DAMPED, "energy_rate", "dE/dt <= 0"),
    ("dissipative", DAMPED, "energy_rate", "-c x'^2 <= 0"),
    ("dissipative", DAMPED, "energy_rate", "dE/dt = -c x'^2 <= 1"),
    ("lie-bracket", FIELDS, "claim", "[X,Y] = d/dx y - d/dy x"),
    ("lie-bracket", FIELDS, "claim", "[X,Y] = -y d/dt - x d/dy"),
    ("transformed-hamiltonian-K", TURNED, "K", "K = omega P since P = 0"),
    ("transformed-hamiltonian-K", TURNED, "K", "K = omega P since F is not wrong"),
    ("transformed-hamiltonian-K", TURNED, "K", "K = omega P if dF/dt = 0"),
    ("transformed-hamiltonian-K", TURNED, "K", "K = omega P since otherwise nothing holds"),
    ("bilinear-covariant", {**PHASE, "Q": ["2*q"], "P": ["3*p"]}, "factor", "the factor is not 6"),
    ("bilinear-covariant", {**PHASE, "Q": ["2*q"], "P": ["3*p"]}, "factor", "the factor is 6 or 5"),
    ("bilinear-covariant", {**PHASE, "Q": ["2*q"], "P": ["3*p"]}, "factor", "the inverse factor is 6"),
    (
        "legendre-hamiltonian",
        {**OSCILLATOR, "p": ["p"]},
        "H",
        "p squared over two m, plus one half k times x squared",
    ),
    (
        "legendre-hamiltonian",
        {**OSCILLATOR, "p": ["p"]},
        "H",
        "p squared over 2m squared, plus one half k times x squared",
    ),
    ("constant-of-motion", KEPLER, "I", "m r² φ' is not conserved"),
    ("constant-of-motion", KEPLER, "I", "m r² φ' is hardly conserved"),
    ("constant-of-motion", KEPLER, "I", "m r² φ' is conserved if k = 0"),
    ("constant-of-motion", KEPLER, "I", "Behouden grootheid: L = m r² φ' (impulsmoment)"),
    ("euler-lagrange", OSCILLATOR, "claim", "m x'' = -k x, where x is constant"),
    ("euler-lagrange", OSCILLATOR, "claim", "m x'' = -k x, as half expected"),
    ("euler-lagrange", OSCILLATOR, "claim", "m x'' = -k x, as expected for small k"),
    ("euler-lagrange", OSCILLATOR, "claim", "m x'' = -k x, nicht wie erwartet"),
    ("euler-lagrange", OSCILLATOR, "claim", "m x'' = -k x, not as expected"),
    ("euler-lagrange", OSCILLATOR, "claim", "m x'' = -k x since m = 1"),
    ("euler-lagrange", OSCILLATOR, "claim", "m x'' = -k x because friction is small"),
    ("euler-lagrange", OSCILLATOR, "claim", "Man erhält nicht m x'' = -k x"),
    ("canonicity", {**PHASE, "P": ["-q"]}, "Q", ["p ↦ q"]),
    ("canonicity", {**PHASE, "P": ["-q"]}, "Q", ["q ↤ p"]),
]


@pytest.mark.parametrize(("kind", "system", "key", "said"), REFUSED)
def test_what_may_say_something_else_is_refused(kind, system, key, said):
    assert judged(kind, system, key, said).startswith("invalid")


@pytest.mark.parametrize(
    ("first", "second", "verdict"), [("q ↦ p", "p ↦ −q", "holds"), ("q ↦ p", "p ↦ q", "fails")]
)
def test_maps_by_arrows(first, second, verdict):
    assert told("canonicity", **PHASE, Q=[first], P=[second]) == verdict


@pytest.mark.parametrize(("said", "verdict"), [("one", "holds"), ("minus one", "fails"), ("zero", "fails")])
def test_values_in_words(said, verdict):
    pairs = [{"f": "q", "g": "p", "value": said}]
    assert told("poisson-bracket", **PHASE, pairs=pairs) == verdict
    names = {**PHASE, "parameters": {"one": "real", "zero": "real", "minus": "real"}}
    assert told("poisson-bracket", **names, pairs=pairs) != "holds"
