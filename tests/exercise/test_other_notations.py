"""Notations of programs, of books and of what is copied from a page: each is read, and its wrong twin fails."""

import pytest

from canon.exercise import Claim, InvalidClaim, judge

SIGNS = {"m": "positive", "k": "positive", "g": "positive", "l": "positive"}
OSCILLATOR = {"q": ["x"], "L": "m*x_dot**2/2 - k*x**2/2"}
PENDULUM = {"q": ["theta"], "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)"}
GREEK = {"q": ["θ"], "L": "m*l**2*θ_dot**2/2 + m*g*l*cos(θ)"}
KEPLER = {
    "q": ["r", "phi"],
    "L": "m*(r_dot**2 + r**2*phi_dot**2)/2 + k/r",
    "parameters": {**SIGNS, "r": "positive"},
}
PLANE = {"q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2 - k*(x**2 + y**2)/2"}
IN_FIELD = {"q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2 - V(x, y)", "functions": {"V": ["x", "y"]}}
INCLINE = {"q": ["x"], "L": "m*x_dot**2/2 + m*g*x/2"}
RELATIVISTIC = {
    "q": ["x"],
    "L": "-m*c**2*sqrt(1 - x_dot**2/c**2) - k*x**2/2",
    "domain": ["x_dot**2 < c**2"],
    "parameters": {**SIGNS, "c": "positive"},
}


def status(kind, **keys):
    """Return what is judged of a claim; a claim that is not read raises its error."""
    return judge(Claim("a", kind, {"parameters": SIGNS, **keys})).status.value


def told(kind, **keys):
    """Return the error of a claim that is not read."""
    with pytest.raises(InvalidClaim) as caught:
        status(kind, **keys)
    return caught.value.error.reason


EQUATIONS = [
    # rates
    (PENDULUM, "l*(D@@2)(theta)(t) + g*sin(theta(t)) = 0;", "l*(D@@2)(theta)(t) - g*sin(theta(t)) = 0;"),
    (PENDULUM, "ddtheta = -(g./l).*sin(theta);", "ddtheta = (g./l).*sin(theta);"),
    (
        KEPLER,
        "ddr = r.*dphi.^2 - k./(m.*r.^2); ddphi = -2*dr.*dphi./r;",
        "ddr = r.*dphi.^2 - k./(m.*r.^2); ddphi = -dr.*dphi./r;",
    ),
    (OSCILLATOR, "m ¨x + k x = 0", "m ¨x − k x = 0"),
    (OSCILLATOR, "m¨x = −kx", "m˙x = −kx"),
    (PENDULUM, "l ¨θ + g sin θ = 0", "l ˙θ + g sin θ = 0"),
    (OSCILLATOR, "ddot x = -(k/m) x", "ddot x = -(m/k) x"),
    (PENDULUM, "ddot(theta) = -(g/l) sin(theta)", "dot(theta) = -(g/l) sin(theta)"),
    (OSCILLATOR, "$m x_{tt} + kx = 0$", "$m x_{tt} - kx = 0$"),
    (PENDULUM, r"l\theta_{tt} = -g\sin\theta", r"l\theta_{tt} = g\sin\theta"),
    (OSCILLATOR, "m*x_tt + k*x = 0", "m*x_tt + k*x_t = 0"),
    (GREEK, "theta'' + g/l*sin(theta) = 0", "theta'' - g/l*sin(theta) = 0"),
    (GREEK, r"$\ddot\theta + \frac{g}{l}\sin\theta = 0$", r"$\ddot\theta - \frac{g}{l}\sin\theta = 0$"),
    (
        RELATIVISTIC,
        r"$\frac{d}{dt}\frac{m\dot x}{\sqrt{1-\dot x^2/c^2}} = -kx$",
        r"$\frac{d}{dt}\frac{m\dot x}{1-\dot x^2/c^2} = -kx$",
    ),
    # lists and statements
    (
        PENDULUM,
        r"{{\[Theta]''[t] -> -((g Sin[\[Theta][t]])/l)}}",
        r"{{\[Theta]''[t] -> -((g Sin[\[Theta][t]])/(2 l))}}",
    ),
    (PLANE, "{x''[t] -> -k x[t]/m, y''[t] -> -k y[t]/m}", "{x''[t] -> -k x[t]/m, y''[t] -> k y[t]/m}"),
    (PLANE, "[m*ddx; m*ddy] = [-k*x; -k*y]", "[m*ddx; m*ddy] = [-k*y; -k*x]"),
    (PLANE, "<m*x'', m*y''> = <-k*x, -k*y>", "<m*x'', m*y''> = <k*x, -k*y>"),
    (
        PENDULUM,
        "m l² θ″ = −m g l sin θ, i.e. θ″ = −(g/l) sin θ",
        "m l² θ″ = −m g l sin θ, i.e. θ″ = −(g/l) cos θ",
    ),
    (OSCILLATOR, "m x'' = -k x, d. h. x'' = -k x/m", "m x'' = -k x, d. h. x'' = k x/m"),
    (
        OSCILLATOR,
        r"$m\ddot x = -kx$, i.e. $\ddot x = -\frac{k}{m}x$",
        r"$m\ddot x = -kx$, i.e. $\ddot x = -kx$",
    ),
    (PENDULUM, "θ̇ = ω, ω̇ = −(g/l) sin θ", "θ̇ = ω, ω̇ = (g/l) sin θ"),
    (
        PENDULUM,
        r"$\dot\theta = \omega,\quad \dot\omega = -\frac{g}{l}\sin\theta$",
        r"$\dot\theta = \omega,\quad \dot\omega = -g\sin\theta$",
    ),
    (
        OSCILLATOR,
        r"$m\ddot x = -kx \implies \boxed{\ddot x + \omega^2 x = 0},\quad \omega = \sqrt{\frac{k}{m}}$",
        r"$m\ddot x = -kx \implies \boxed{\ddot x + \omega^2 x = 0},\quad \omega = \frac{k}{m}$",
    ),
    (OSCILLATOR, "m x'' = -k x  # Newton, x = 0 at rest", "m x'' = k x  # Newton"),
    (OSCILLATOR, "m x'' = -k x; % equation of motion", "m x'' = k x; % equation of motion"),
    (OSCILLATOR, "1.0d0*m*xddot = -1d0*k*x", "1.0d1*m*xddot = -1d0*k*x"),
    (OSCILLATOR, "{Derivative(x(t), (t, 2)): -k*x(t)/m}", "{Derivative(x(t), (t, 2)): k*x(t)/m}"),
    (OSCILLATOR, "[{Derivative(x(t), (t, 2)): -k*x(t)/m}]", "[{Derivative(x(t), (t, 2)): -m*x(t)/k}]"),
    (OSCILLATOR, "m x'' + k x = 0 ⇔ x'' = -k x/m", "m x'' + k x = 0 ⇔ x'' = k x/m"),
    (OSCILLATOR, "m x'' = -k x, or equivalently x'' = -k x/m", "m x'' = -k x, or equivalently x'' = k x/m"),
    # what is constant
    (PENDULUM, "E = ½ m l² θ'² − m g l cos θ = konst.", "E = ½ m l² θ'² + m g l cos θ = konst."),
    (KEPLER, ["m r² φ̇ = const.", "m r̈ − m r φ̇² + k/r² = 0"], ["m r φ̇ = const.", "m r̈ − m r φ̇² + k/r² = 0"]),
    (
        KEPLER,
        [r"p_\phi = mr^2\dot\phi = \text{const.}", r"m\ddot r - mr\dot\phi^2 + k/r^2 = 0"],
        [r"p_\phi = mr\dot\phi = \text{const.}", r"m\ddot r - mr\dot\phi^2 + k/r^2 = 0"],
    ),
    # degrees
    (INCLINE, r"$\ddot x = g\sin 30^\circ$", r"$\ddot x = g\sin 60^\circ$"),
    (INCLINE, r"m\ddot x = mg\cos(60^{\circ})", r"m\ddot x = mg\cos(30^{\circ})"),
    (INCLINE, r"$\ddot x = g\tan 45° \sin 30\degree\cdot 1$", r"$\ddot x = g\tan 30° \sin 30\degree\cdot 1$"),
    # vectors
    (
        IN_FIELD,
        r"$m\begin{pmatrix}\ddot x\\ \ddot y\end{pmatrix} = -\nabla V(x,y)$",
        r"$m\begin{pmatrix}\ddot x\\ \ddot y\end{pmatrix} = \nabla V(x,y)$",
    ),
    (IN_FIELD, r"m\ddot{\vec r} = -\vec\nabla V", r"m\ddot{\vec r} = \vec\nabla V"),
    (IN_FIELD, "m*Matrix([x'', y'']) + ∇V = 0", "m*Matrix([x'', y'']) - ∇V = 0"),
    (PLANE, r"$m\,\ddot{\mathbf r} + k\mathbf{r} = 0$", r"$m\,\dot{\mathbf r} + k\mathbf{r} = 0$"),
    (PLANE, "m r̈⃗ = -k r⃗", "m ṙ⃗ = -k r⃗"),
    (PLANE, r"$m\frac{d^2\vec r}{dt^2} = -k\vec r$", r"$m\frac{d\vec r}{dt} = -k\vec r$"),
    (PLANE, r"$m\vec a = -k\vec r$", r"$m\vec v = -k\vec r$"),
]


@pytest.mark.parametrize(("system", "form", "twin"), EQUATIONS)
def test_equations_of_motion(system, form, twin):
    claims = [[said] if isinstance(said, str) else said for said in (form, twin)]
    assert [status("euler-lagrange", **system, claim=claim) for claim in claims] == ["holds", "fails"]


ROLLING = {
    "q": ["x", "theta"],
    "L": "m*x_dot**2/2 + m*l**2*theta_dot**2/2 + m*g*x*sin(alpha)",
    "constraints": ["l*theta - x"],
    "multipliers": ["lam"],
    "parameters": {**SIGNS, "alpha": "real"},
}
SKATE = {
    "q": ["x", "y", "theta"],
    "L": "m*(x_dot**2 + y_dot**2)/2 + J*theta_dot**2/2",
    "constraints": ["x_dot*sin(theta) - y_dot*cos(theta)"],
    "multipliers": ["lam"],
    "parameters": {**SIGNS, "J": "positive"},
}
BEAM = {
    "bodies": [{"m": "m", "r": ["l*sin(theta)", "-l*cos(theta)"]}],
    "V": "-m*g*l*cos(theta)",
    "q": ["theta"],
}
DAMPED = {**OSCILLATOR, "F": "c*x_dot**2/2", "parameters": {**SIGNS, "c": "positive"}}
FREE_TOP = {
    "x": ["omega1", "omega2", "omega3"],
    "parameters": {"I1": "positive", "I2": "positive", "I3": "positive"},
    "X": ["(I2 - I3)*omega2*omega3/I1", "(I3 - I1)*omega3*omega1/I2", "(I1 - I2)*omega1*omega2/I3"],
}
FIELDS = {"x": ["x", "y"], "X": ["y", "0"], "Y": ["0", "x"]}
OTHERS = [
    (
        "multiplier-holonomic",
        ROLLING,
        "claim",
        r"$\ddot x = \tfrac12 g\sin\alpha \\ \lambda = \tfrac12 mg\sin\alpha \text{ (friction)}$",
        r"$\ddot x = \tfrac12 g\sin\alpha \\ \lambda = mg\sin\alpha \text{ (friction)}$",
    ),
    (
        "multiplier-holonomic",
        ROLLING,
        "claim",
        r"$\ddot x = \tfrac12 g\sin\alpha \text{ (gravity)} \\ \ddot\theta = \ddot x/l$",
        r"$\ddot x = g\sin\alpha \text{ (gravity)} \\ \ddot\theta = \ddot x/l$",
    ),
    (
        "nonholonomic",
        SKATE,
        "claim",
        "{m x''[t] == λ[t] Sin[θ[t]], m y''[t] == -λ[t] Cos[θ[t]], J θ''[t] == 0}",
        "{m x''[t] == λ[t] Cos[θ[t]], m y''[t] == -λ[t] Cos[θ[t]], J θ''[t] == 0}",
    ),
    (
        "nonholonomic",
        SKATE,
        "claim",
        r"$m\ddot x = \lambda(t)\sin\theta, \quad \ddot\theta = 0$",
        r"$m\ddot x = -\lambda(t)\sin\theta, \quad \ddot\theta = 0$",
    ),
    ("nonholonomic", SKATE, "claim", "θ̇ = const.", "ẋ = const."),
    (
        "dissipative",
        DAMPED,
        "energy_rate",
        r"$\frac{dE}{dt} = -2F = -c\dot x^2$",
        r"$\frac{dE}{dt} = -F = -\tfrac12 c\dot x^2$",
    ),
    ("dissipative", DAMPED, "energy_rate", "dE/dt = -2F = -c x'^2", "dE/dt = -F = -c x'^2"),
    (
        "gibbs-appell",
        BEAM,
        "S",
        r"$S = \frac m2(\ddot x^2+\ddot y^2) = \frac12 ml^2\bigl(\ddot\theta^{\,2}+\dot\theta^{\,4}\bigr)$",
        r"$S = \frac12 m(\ddot x^2+\ddot y^2) = ml^2\bigl(\ddot\theta^{\,2}+\dot\theta^{\,4}\bigr)$",
    ),
    (
        "gibbs-appell",
        BEAM,
        "S",
        "S = m (x''² + y''²)/2 = m l² (θ''² + θ'⁴)/2",
        "S = m (x''² + y''²) = m l² (θ''² + θ'⁴)/2",
    ),
    (
        "legendre-hamiltonian",
        {**OSCILLATOR, "p": ["p"]},
        "H",
        "H = p**2/(2*m) + 0.5*k*x**2  # total energy",
        "H = p**2/2*m + 0.5*k*x**2  # total energy",
    ),
    ("lie-bracket", FIELDS, "claim", "[-x; y]", "[-y; x]"),
    ("lie-bracket", FIELDS, "claim", "<-x, y>", "<x, y>"),
    (
        "lie-bracket",
        FIELDS,
        "claim",
        r"$[X,Y] = -x\,\partial_x + y\,\partial_y$",
        r"$[X,Y] = -x\,\partial_y + y\,\partial_x$",
    ),
    ("lie-bracket", FIELDS, "claim", "−x ∂/∂x + y ∂/∂y", "x ∂/∂x − y ∂/∂y"),
    (
        "lie-bracket",
        FIELDS,
        "claim",
        r"y\frac{\partial}{\partial y} - x\frac{\partial}{\partial x}",
        r"x\frac{\partial}{\partial y} - y\frac{\partial}{\partial x}",
    ),
    ("constant-of-motion", OSCILLATOR, "I", "0.5d0*m*xdot**2 + 0.5d0*k*x**2", "0.5d0*m*xdot + 0.5d0*k*x**2"),
    (
        "constant-of-motion",
        PLANE,
        "I",
        r"$L_z = (\vec r\times\vec p)_z = m\left(x\dot y - y\dot x\right)$",
        r"$L_z = (\vec r\times\vec p)_z = m\left(x\dot x - y\dot y\right)$",
    ),
    (
        "constant-of-motion",
        PLANE,
        "I",
        r"$L_z = m(\vec r\times\dot{\vec r})_z = m(x\dot y - y\dot x)$",
        r"$L_z = (\vec r\times\dot{\vec r})_z = m(x\dot y - y\dot x)$",
    ),
    (
        "constant-of-motion",
        PLANE,
        "I",
        r"$m\begin{vmatrix} x & y \\ \dot x & \dot y \end{vmatrix} = \mathrm{const}$",
        r"$m\begin{vmatrix} x & \dot y \\ y & \dot x \end{vmatrix} = \mathrm{const}$",
    ),
    (
        "constant-of-motion",
        FREE_TOP,
        "I",
        "2T = I₁ω₁² + I₂ω₂² + I₃ω₃² = const",
        "2T = I₁²ω₁² + I₂²ω₂² + I₃ω₃² = const",
    ),
    (
        "constant-of-motion",
        FREE_TOP,
        "I",
        r"$\vec L^2 = \sum_{i=1}^3 I_i^2\omega_i^2$",
        r"$\vec L^2 = \sum_{i=1}^3 I_i^3\omega_i^2$",
    ),
    (
        "constant-of-motion",
        PLANE,
        "I",
        r"$\vec L^2 = m^2(x\dot y - y\dot x)^2$",
        r"$\vec L^2 = m^2(x\dot y + y\dot x)^2$",
    ),
    ("equality-only", {"lhs": "m**(1/3)"}, "rhs", "∛m", "∜m"),
    ("equality-only", {"lhs": "2*(m + k)**(1/4)"}, "rhs", "2∜(m + k)", "2∛(m + k)"),
    ("equality-only", {"lhs": "exp(2)*sin(m)"}, "rhs", "E^2 Sin[m]", "E^3 Sin[m]"),
]


@pytest.mark.parametrize(("kind", "system", "key", "form", "twin"), OTHERS)
def test_other_answers(kind, system, key, form, twin):
    assert [status(kind, **system, **{key: said}) for said in (form, twin)] == ["holds", "fails"]


BRACKETS = [
    (
        ["x", "y", "z"],
        "y*pz - z*py",
        "z*px - x*pz",
        r"$\{L_x,L_y\} = xp_y - yp_x = L_z$",
        r"$\{L_x,L_y\} = yp_x - xp_y = -L_z$",
    ),
    (["x", "y", "z"], "y*pz - z*py", "z*px - x*pz", "{L_x, L_y} = L_z", "{L_x, L_y} = -L_z"),
    (["x", "y"], "x**2 + y**2", "x*px + y*py", "2r², where r² = x² + y²", "r², where r² = x² + y²"),
]


@pytest.mark.parametrize(("q", "f", "g", "form", "twin"), BRACKETS)
def test_values_of_brackets(q, f, g, form, twin):
    def found(said):
        return status("poisson-bracket", q=q, p=[f"p{x}" for x in q], pairs=[{"f": f, "g": g, "value": said}])

    assert (found(form), found(twin)) == ("holds", "fails")


OPEN = [
    ("euler-lagrange", OSCILLATOR, {"claim": "m dot x = -k x"}, "is dot a product here, or the rate"),
    ("euler-lagrange", OSCILLATOR, {"claim": "m x_t = -k x"}, "x_t is not declared"),
    ("euler-lagrange", OSCILLATOR, {"claim": "m dx = -k x"}, "d is not declared"),
    (
        "euler-lagrange",
        PLANE,
        {"claim": "{{x''[t] -> -x[t]}, {x''[t] -> x[t]}}"},
        "several solutions stand in this list",
    ),
    ("euler-lagrange", INCLINE, {"claim": r"\ddot x = \sin 30^\circ g"}, "does this factor still belong"),
    (
        "euler-lagrange",
        RELATIVISTIC,
        {"claim": r"\frac{d}{dt}\frac{m\dot x}{c} \dot x = 0"},
        "the derivative of what?",
    ),
    (
        "euler-lagrange",
        RELATIVISTIC,
        {"claim": r"\frac{d}{dt}\frac{m\dot x}{c}\cdot x = 0"},
        "does this factor still belong",
    ),
    (
        "euler-lagrange",
        RELATIVISTIC,
        {"claim": r"\frac{d}{dt}\frac{m\dot x}{c}/x = 0"},
        "divide the derivative or the fraction",
    ),
    ("euler-lagrange", KEPLER, {"claim": r"m\ddot{\vec r} = -k\vec r"}, "is not declared"),
    ("euler-lagrange", KEPLER, {"claim": "m r² = const, m v = const"}, "v is not declared"),
    ("nonholonomic", SKATE, {"claim": "λ = const."}, "is not a rate of a declared coordinate"),
    ("lie-bracket", FIELDS, {"claim": "∂_x x"}, "a derivative is written ∂f/∂x"),
    ("lie-bracket", FIELDS, {"claim": "[1, 2; 3, 4]"}, "leave the others out"),
    (
        "lagrange-bracket",
        {"variables": ["u", "v"], "q": ["exp(u)*cos(v)"], "p": ["exp(u)*sin(v)"]},
        {"pairs": [{"u": "u", "v": "v", "value": "E^2 u"}]},
        "is E Euler's number, or a name that is not declared?",
    ),
    ("constant-of-motion", PLANE, {"I": "L² = m²(x ẏ − y ẋ)²"}, "is L the Lagrangian here"),
    ("constant-of-motion", PLANE, {"I": "|L| = m(x ẏ − y ẋ)"}, "is L the Lagrangian here"),
    ("constant-of-motion", KEPLER, {"I": r"L_z = (\vec r\times\vec p)_z = m r^2\dot\phi"}, "is not declared"),
]


@pytest.mark.parametrize(("kind", "system", "answer", "question"), OPEN)
def test_what_is_open_is_asked_about(kind, system, answer, question):
    assert question in told(kind, **{**system, **answer})


SPRINGS = {**OSCILLATOR, "parameters": {**SIGNS, "d": "positive", "d0": "positive"}}
KEPT = [
    ("2d0*m", "2*d0*m"),
    ("m x¨k", "m*x''*k"),
    ("m x'' + k*x*d", "m*x_ddot + k*x*d"),
    ("m x'' = -k x, so x'' = -(k/m) x", "m*x_ddot + k*x = 0"),
    (r"m\boxed{x}\,k", "m*x*k"),
]


@pytest.mark.parametrize(("form", "means"), KEPT)
def test_what_was_read_before_means_what_it_meant(form, means):
    by = {key: {**SPRINGS, "claim": [said]} for key, said in (("form", form), ("means", means))}
    verdicts = [judge(Claim("a", "euler-lagrange", keys)) for keys in by.values()]
    assert verdicts[0].status == verdicts[1].status


def test_names_in_greek_are_declared_in_any_table():
    keys = {"q": "φ₁", "parameters": {"ω₀": "positive", "phi_1": "real"}, "L": "φ₁'**2/2 - ω₀**2*φ₁**2/2"}
    assert judge(Claim("a", "euler-lagrange", {**keys, "claim": "phi_1'' = -omega_0^2 phi_1"})).holds
    assert not judge(Claim("a", "euler-lagrange", {**keys, "claim": "phi1'' = omega0^2 phi1"})).holds


def test_two_spellings_of_one_name_are_declared_once():
    keys = {"q": ["θ", "theta"], "L": "theta'**2/2", "claim": "theta'' = 0", "parameters": {}}
    assert "declared twice" in told("euler-lagrange", **keys)
    both = {**keys, "q": ["x"], "parameters": {"ω": "positive", "omega": "negative"}}
    assert "write omega for ω" in told("euler-lagrange", **both)
