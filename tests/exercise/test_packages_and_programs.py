"""Notations of LaTeX's packages and macros, of single programs and of copies from PDF: each read, its wrong twin fails.

Beside them what must stay refused: what can be meant in two ways, or is not known to leave a formula as it is.
"""

import pytest

from canon.exercise import Claim, InvalidClaim, judge
from canon.exercise.claim_verdict import examine

SIGNS = {"m": "positive", "k": "positive", "g": "positive", "l": "positive"}
OSCILLATOR = {"q": ["x"], "L": "m*x_dot**2/2 - k*x**2/2"}
DAMPED = {**OSCILLATOR, "F": "c*x_dot**2/2", "parameters": {**SIGNS, "c": "positive"}}
HAMILTON = {**OSCILLATOR, "p": ["p"]}
PENDULUM = {"q": ["theta"], "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)"}
FALLING = {"q": ["y"], "L": "m*y_dot**2/2 - m*981/100*y"}
THROWN = {"q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2 - m*g*y"}
PLANE = {"q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2 - k*(x**2 + y**2)/2"}
IN_FIELD = {"q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2 - V(x, y)", "functions": {"V": ["x", "y"]}}
KEPLER = {
    "q": ["r", "phi"],
    "L": "m*(r_dot**2 + r**2*phi_dot**2)/2 + k/r",
    "parameters": {**SIGNS, "r": "positive"},
}
PHASE = {"q": ["q"], "p": ["p"]}


def status(kind, **keys):
    """Return what is judged of a claim; ``invalid`` of one that is not read."""
    try:
        return judge(Claim("a", kind, {"parameters": SIGNS, **keys})).status.value
    except InvalidClaim:
        return "invalid"


def of_equation(system, text):
    """Return what is judged of an equation of motion."""
    kind = "dissipative" if "F" in system else "euler-lagrange"
    return status(kind, **system, claim=[text])


EQUATIONS = [
    # siunitx
    (FALLING, r"$\ddot y = {}\SI{9.81}{\metre\per\second\squared}$", "-", ""),
    (FALLING, r"$\ddot y = -\qty{9,81}{\meter\second\tothe{-2}}\cdot {}$", "1", "2"),
    (FALLING, r"$m\ddot y = {}m\,\SI{9.81}{m.s^{-2}}$", "-", "-2"),
    (FALLING, r"$\ddot y = -\num{981e{}}$", "-2", "-3"),
    (FALLING, r"$\ddot y = \num{{}9.81}$", "-", "+"),
    (FALLING, r"$\ddot y = -9.81\,\si{\metre\per\second\squared}{}$", "", r"\cdot m"),
    (FALLING, r"$\ddot y = -\num{9,81}\sin\ang{{}}$", "90", "30"),
    (FALLING, r"$\ddot y = -\num{9,81}\sin\SI{{}}{\degree}$", "90", "30"),
    # macros
    (OSCILLATOR, r"\newcommand{\w}{\frac{k}{m}}$\ddot x {} \w x = 0$", "+", "-"),
    (OSCILLATOR, r"\newcommand{\dd}[2]{\frac{d^2 #1}{d #2^2}}$m\dd{x}{t} = {}kx$", "-", ""),
    (OSCILLATOR, r"$\def\a{k}\def\b{\a x}m\ddot x = {}\b$", "-", ""),
    (PENDULUM, r"\newcommand\td{\ddot\theta}$l\td {} g\sin\theta = 0$", "+", "-"),
    (PENDULUM, r"\newcommand{\th}{\theta}$\ddot\th = {}\frac gl\sin\th$", "-", ""),
    (PENDULUM, r"\renewcommand{\theta}{\vartheta}$\ddot\theta = {}\frac gl\sin\theta$", "-", ""),
    # labels at braces
    (DAMPED, r"$m\ddot x + \underbrace{c\dot x}_{\text{friction}} {} \overbrace{kx}^{F} = 0$", "+", "-"),
    (DAMPED, r"$m\ddot x = {}\underbrace{-c\dot x - kx}_{F}$", "", "2"),
    (DAMPED, r"$m\ddot x + \underbrace{c\dot x {} kx}_{F} = 0$", "+", "-"),
    (OSCILLATOR, r"$\ddot x {} \underbrace{\frac km}_{=\omega_0^2} x = 0$", "+", "-"),
    # vectors
    (THROWN, r"$m\ddot{\boldsymbol r}={}mg\,\boldsymbol e_y$ with $\boldsymbol r=(x,y)$", "-", ""),
    (THROWN, r"$m\ddot{\vec r} = -mg\hat{}$", "{y}", "{x}"),
    (THROWN, r"$m\ddot{\vec r} = {}mg\,\hat{\mathbf e}_y$", "-", ""),
    (THROWN, r"$m\ddot x\,\hat x + m\ddot y\,\hat y = {}mg\,\hat y$", "-", ""),
    (THROWN, r"$m\ddot{\vec r} = m\vec g$, $\vec g = (0, {}g)$", "-", ""),
    (THROWN, r"$m\ddot{\vec r} = m\vec g$ mit $\vec g = \begin{pmatrix}0\\{}g\end{pmatrix}$", "-", ""),
    (PLANE, r"$m\ddot{\mathbf{x}} = {}k\mathbf{x}$, $\mathbf{x} = (x, y)^T$", "-", ""),
    (IN_FIELD, r"$m\ddot{\mathbf{x}}={}\nabla V$, where $\mathbf{x}=(x,y)$", "-", "+"),
    # programs
    (DAMPED, "m*D2x {} c*Dx + k*x = 0", "+", "-"),
    (DAMPED, "m*der(der(x)) {} c*der(x) + k*x = 0", "+", "-"),
    (OSCILLATOR, "der(x) = v; m*der(v) = {}k*x", "-", ""),
    (DAMPED, "m*df(x,t,2) {} c*df(x,t) + k*x = 0;", "+", "-"),
    (OSCILLATOR, "m*D[0, 0](x)(t) {} k*x(t) == 0", "+", "-"),
    (OSCILLATOR, "(+ (* m (((expt D 2) x) t)) (* {} (x t)))", "k", "m"),
    (OSCILLATOR, "(= (* m (((expt D 2) x) t)) ({} (* k (x t))))", "-", "+"),
    (PENDULUM, "l*theta'' = -g*{}(theta)", "Math.sin", "Math.cos"),
    (PENDULUM, "l*theta'' = -g*{}(theta)", "std::sin", "std::cos"),
    (PENDULUM, "'diff(theta,t,2) = -(g/l)*{}(%theta)", "sin", "cos"),
    (PENDULUM, "$ l dot.double(theta) {} g sin theta = 0 $", "+", "-"),
    # copies
    (DAMPED, "m ¨ x {} c ˙ x + k x = 0", "+", "-"),
    (KEPLER, "m ¨ r = m r ˙ φ² {} k/r²; r ¨ φ + 2 ˙ r ˙ φ = 0", "-", "+"),
    (OSCILLATOR, "mẍ = {}kx 😊!!", "−", ""),
]  # fmt: skip


@pytest.mark.parametrize(("system", "said", "right", "wrong"), EQUATIONS)
def test_equations_of_motion(system, said, right, wrong):
    found = [of_equation(system, said.replace("{}", piece)) for piece in (right, wrong)]
    assert found == ["holds", "fails"]


OTHERS = [
    ("legendre-hamiltonian", HAMILTON, "H", "H -> p^2/(2 m) {} k x^2/2", "+", "-"),
    ("legendre-hamiltonian", HAMILTON, "H", "H → p²/(2m) {} kx²/2", "+", "-"),
    ("legendre-hamiltonian", HAMILTON, "H", "(+ (/ (* p p) (* 2 m)) (* 1/{} k (expt x 2)))", "2", "3"),
    ("legendre-hamiltonian", HAMILTON, "H", "H = (- (/ (* p p) (* 2 m)) (* {} k x x))", "-0.5", "0.5"),
    (
        "legendre-hamiltonian",
        HAMILTON,
        "H",
        r"$H=\omega p + \frac{kx^2}{2}$ where $\omega = \frac{p}{{}m}$",
        "2",
        "3",
    ),
    (
        "legendre-hamiltonian",
        HAMILTON,
        "H",
        r"$H = \underbrace{\frac{p^2}{2m}}_{\text{kinetic energy}} {} \underbrace{\frac12 kx^2}_{V}$",
        "+",
        "-",
    ),
    (
        "legendre-hamiltonian",
        {"q": ["r", "phi"], "p": ["p_r", "p_phi"], "L": KEPLER["L"], "parameters": KEPLER["parameters"]},
        "H",
        "pᵣ²/(2m) {} pᵩ²/(2mr²) − k/r",
        "+",
        "-",
    ),
    (
        "constant-of-motion",
        KEPLER,
        "I",
        r"$\underbrace{\tfrac12 m(\dot r^2+r^2\dot\varphi^2)}_{T}\underbrace{{}\frac kr}_{V}$",
        "-",
        "+",
    ),
]


@pytest.mark.parametrize(("kind", "system", "key", "said", "right", "wrong"), OTHERS)
def test_other_answers(kind, system, key, said, right, wrong):
    found = [status(kind, **system, **{key: said.replace("{}", piece)}) for piece in (right, wrong)]
    assert found == ["holds", "fails"]


def test_rules_of_a_solution():
    signs = {"m": "positive", "omega": "positive", "A": "real", "phi": "real"}
    system = {**PHASE, "H": "p**2/(2*m) + m*omega**2*q**2/2", "parameters": signs}
    found = [
        status("hamilton-equations", **system, solution={"q": q, "p": f"p(t) → {sign}mωA·sin(ωt + φ)"})
        for q in ("q(t) → A·cos(ωt + φ)", "{{q[t] -> A Cos[ω t + φ]}}")
        for sign in ("−", "")
    ]
    assert found == ["holds", "fails"] * 2


def test_consoles():
    def found(value):
        return status("poisson-bracket", **PHASE, pairs=[{"f": "q**3", "g": "p", "value": value}])

    assert [found("[1] 3 * q^2"), found("[1] 2 * q^2")] == ["holds", "fails"]


OPEN = [
    # a prefix, a thousand or one, a figure that would run into the number
    (FALLING, r"$\ddot y = -\SI{981}{\centi\metre\per\second\squared}$"),
    (FALLING, r"$\ddot y = -\SI{981}{cm/s^2}$"),
    (FALLING, r"$\ddot y = -\num{9,810}$"),
    (FALLING, r"$\ddot y = -1\num{9.81}$"),
    (FALLING, r"$\ddot y = -1\,\num{9.81}$"),
    # only the first letter would be raised; another meaning of a known command; by itself
    (OSCILLATOR, r"\newcommand{\w}{1 x}$m\ddot x = -kx^\w$"),
    (OSCILLATOR, r"\newcommand{\w}{k/m}$\ddot x = -\w x$"),
    (OSCILLATOR, r"\renewcommand{\sin}{x}$m\ddot x = -k\sin$"),
    (PENDULUM, r"\renewcommand{\phi}{\theta}$l\ddot\phi = -g\sin\phi$"),
    (OSCILLATOR, r"\def\x{\x x}$m\ddot x = -k\x$"),
    (OSCILLATOR, r"\def\a{k}\def\a{m}$m\ddot x = -\a x$"),
    # labels that say more, braces that may be meant as a whole
    (DAMPED, r"$m\ddot x + \underbrace{c\dot x}_{=0} + kx = 0$"),
    (DAMPED, r"$m\ddot x + \underbrace{c\dot x}_{\approx 0} + kx = 0$"),
    (DAMPED, r"$m\ddot x + \underbrace{c\dot x}_{\text{neglected}} + kx = 0$"),
    (DAMPED, r"$m\ddot x + \underbrace{c\dot x}_{wrong} + kx = 0$"),
    (DAMPED, r"$m\ddot x + \underbrace{c\dot x}_{c} + kx = 0$"),
    (DAMPED, r"$m\ddot x = -\underbrace{c\dot x + kx}_{F}$"),
    (OSCILLATOR, r"$m\underbrace{\ddot x + x}_{T} = -kx$"),
    (PENDULUM, r"$l\ddot\theta = -g\underbrace{\sin}_{s}\theta$"),
    # vectors that are not those of the coordinates
    (THROWN, r"$m\ddot{\vec r} = -mg\vec e_z$"),
    (THROWN, r"$m\ddot{\vec r} = -mg\vec e_y$ with $\vec r = (y, x)$"),
    (THROWN, r"$m\ddot{\vec r} = -mg\vec e_y$ with $\vec r = (x, y, z)$"),
    (PLANE, r"$m\ddot{\mathbf{x}} \neq -k\mathbf{x}$, $\mathbf{x} = (x, y)$"),
    (THROWN, r"$m\ddot{\vec r} = -mg\vec e_y$ with $\vec F = (0, 1)$"),
    (KEPLER, r"$m\ddot{\vec r} = -mg\hat r$ with $\vec r = (r, \phi)$"),
    # letters of programs that mean something else
    ({**OSCILLATOR, "parameters": {**SIGNS, "D": "real"}}, "m D2x = -k x"),
    (OSCILLATOR, "m Dx = -k x"),
    (OSCILLATOR, "m*D[0, 1](x)(t) == -k*x(t)"),
    (DAMPED, "m*df(x,t,2) + c*df(x,y) + k*x = 0"),
    (OSCILLATOR, "Gleichung der (x): m x'' = -kx"),
    (PENDULUM, "l*theta'' = -g*sin(%phi)"),
    (PENDULUM, "l*theta'' = -g*Math.constructor(theta)"),
    (OSCILLATOR, "(+ (* m (((expt D 2) x) t) (* k x))"),
    (OSCILLATOR, "(not (= (* m (((expt D 2) x) t)) (- (* k x))))"),
    (OSCILLATOR, "(or (= (* m (((expt D 2) x) t)) (- (* k x))) (= x 0))"),
    (OSCILLATOR, "m x'' = -k x (* wrong *)"),
    # dots whose letter is open, signs that doubt
    (KEPLER, "r ¨ − r ˙ φ² = −k/(m r²)"),
    (OSCILLATOR, "m x'' = -k x 🤔"),
    (OSCILLATOR, "m x'' = -k x ❌"),
    (OSCILLATOR, "m x'' = -k x!!"),
]


@pytest.mark.parametrize(("system", "said"), OPEN)
def test_what_is_open_is_refused(system, said):
    assert of_equation(system, said) == "invalid"


@pytest.mark.parametrize("said", ["H -> 0", "p -> p^2/(2 m) + k x^2/2", "H -> p^2/(2 m) -> k x^2/2"])
def test_arrows_that_name_no_answer(said):
    assert status("legendre-hamiltonian", **HAMILTON, H=said) == "invalid"


def test_minus_without_lisp_is_a_sign():
    """``(- x y)`` is −x y where no form of Lisp's own stands beside it."""
    pair = {"f": "q**2", "g": "p**2/2"}
    assert status("poisson-bracket", **PHASE, pairs=[{**pair, "value": "(- q p) (-2)"}]) == "holds"


def test_units_of_packages_are_told():
    claim = {"parameters": SIGNS, **FALLING, "claim": [r"\ddot y = -\SI{9.81}{\metre\per\second\squared}"]}
    warnings = examine(Claim("a", "euler-lagrange", claim)).reading.warnings
    assert any("the unit m/s^{2}" in said for said in warnings)
