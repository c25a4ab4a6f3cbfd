"""Sentences of other languages, joined equations, dictation, copied forms: each read, its wrong twin fails.

Beside them what must stay refused: what denies an equation, leaves it open, or can be read in two ways.
"""

import pytest

from canon.exercise import Claim, InvalidClaim, judge
from canon.expression.sentences.known_words import HARMLESS, LEADING, is_denial

SIGNS = {"m": "positive", "k": "positive", "g": "positive", "l": "positive"}
OSCILLATOR = {"q": ["x"], "L": "m*x_dot**2/2 - k*x**2/2"}
PENDULUM = {"q": ["theta"], "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)"}
KEPLER = {
    "q": ["r", "phi"],
    "L": "m*(r_dot**2 + r**2*phi_dot**2)/2 + k/r",
    "parameters": {**SIGNS, "r": "positive"},
}
PLANE = {"q": ["x", "z"], "L": "m*(x_dot**2 + z_dot**2)/2 - k*(x**2 + z**2)/2"}
THROWN = {"q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2 - m*9.81*y", "parameters": {"m": "positive"}}
DAMPED = {**OSCILLATOR, "F": "c*x_dot**2/2", "parameters": {**SIGNS, "c": "positive"}}
ROLLING = {
    "q": ["x", "theta"],
    "L": "m*x_dot**2/2 + m*l**2*theta_dot**2/2 + m*g*x*sin(alpha)",
    "constraints": ["l*theta - x"],
    "multipliers": ["lam"],
    "parameters": {**SIGNS, "alpha": "real"},
}


def status(kind, **keys):
    """Return what is judged of a claim; ``invalid`` of one that is not read."""
    try:
        return judge(Claim("a", kind, {"parameters": SIGNS, **keys})).status.value
    except InvalidClaim:
        return "invalid"


def both(kind, key, said, right, wrong, **keys):
    """Return what is judged of the right answer and of its twin."""
    found = []
    for formula in (right, wrong):
        text = said.replace("{}", formula)
        found.append(status(kind, **keys, **{key: [text] if key == "claim" else text}))
    return found


AROUND = [
    "Ответ: {}", "Следовательно, уравнение движения имеет вид {}", "Уравнение движения: {}",
    "Рівняння руху: {}", "On en déduit l'équation du mouvement : {}", "D'où l'équation : {}",
    "Donc l'équation du mouvement est {}", "Equazione del moto: {}", "Quindi l'equazione del moto è {}",
    "L'équation du mouvement s'écrit : {}", "Por lo tanto, la ecuación de movimiento es {}",
    "La ecuación del movimiento queda {}", "Equação do movimento: {}", "Portanto, a equação é {}",
    "Równanie ruchu: {}", "Pohybová rovnice: {}", "Rörelseekvationen blir {}", "Kurz: {}",
    "Bevægelsesligningen: {}", "De bewegingsvergelijking luidt {}", "A mozgásegyenlet: {}",
    "Hareket denklemi: {}", "Ecuația de mișcare: {}", "Liikeyhtälö: {}", "Εξίσωση κίνησης: {}", "Άρα {}",
    "Bewegungsgleichung des Federpendels: {}", "运动方程为：{}", "运动方程：{}。",
    "よって運動方程式は {} となる。", "運動方程式は {} である。", "答え：{}", "운동방정식: {}",
    "Damit ergibt sich die Bewegungsgleichung zu {}", "Die Euler-Lagrange-Gleichung liefert {}", "Es gilt: {}",
    "Finalement, {}", "L'équation de Lagrange donne {}", "En simplifiant : {}", "Se obtiene {}", "Así que {}",
    "Da cui {}", "Si ottiene {}", "Ответ. {}", "Lösung. {}", "Vi får {}", "所以 {}", "因此，{}",
    "由拉格朗日方程得 {}", "したがって {}", "따라서 {}", "{} (Newton's second law)",
    "{} (Schwingungsgleichung)", "{} — the equation of motion", "{} ist die Bewegungsgleichung.",
    "{}, c.q.f.d.", "운동방정식은 {} 이다.", "{} (équation du mouvement)",
    "The equation of motion of the block: {}", "{}:",
]  # fmt: skip


@pytest.mark.parametrize("said", AROUND)
def test_sentences_in_any_language(said):
    assert both("euler-lagrange", "claim", said, "m x'' = -k x", "m x'' = k x", **OSCILLATOR) == [
        "holds",
        "fails",
    ]


@pytest.mark.parametrize("said", [each for each in AROUND if not each.endswith(":")])
def test_sentences_around_latex(said):
    right, wrong = r"$m\ddot x = -kx$", r"$m\ddot x = kx$"
    assert both("euler-lagrange", "claim", said, right, wrong, **OSCILLATOR) == ["holds", "fails"]


DENIED = [
    "not {}", "nicht: {}", "Nicht so: {}", "Das ist nicht die Gleichung: {}", "Keine Bewegungsgleichung: {}",
    "Ce n'est pas l'équation : {}", "L'équation n'est pas : {}", "L'équation du mouvement n'est pas {}",
    "Faux : {}", "No es cierto: {}", "No es la ecuación: {}", "La ecuación no es {}", "Non è l'equazione: {}",
    "Non vale: {}", "L'equazione del moto non è {}", "Неверно: {}", "Не верно, что {}", "Это не так: {}",
    "Нельзя сказать, что {}", "Уравнение не имеет вид {}", "Nieprawda: {}", "To nie jest równanie ruchu: {}",
    "Špatně: {}", "Neplatí: {}", "A equação não é {}", "Det er ikke: {}", "Liikeyhtälö ei ole: {}", "Nem: {}",
    "Değil: {}", "Δεν ισχύει: {}", "Λάθος: {}", "不对：{}", "这不是运动方程：{}", "错误：{}",
    "運動方程式は {} ではない。", "運動方程式は {} とはならない。", "よって {} とならない。",
    "正しくない式：{}", "{} とは限らない。", "运动方程为 {} 不成立", "운동방정식은 {} 이 아니다.",
    "{} is wrong", "{} ist falsch", "{} est faux", "{} es falso", "{} неверно", "{} (falsch)",
    "{} (not correct)", "{} (nicht richtig)", "{}?", "Impossible: {}", "Unmöglich: {}", "It cannot be: {}",
    "We do not get {}", "Wrong equation: {}", "Falsche Gleichung: {}", "Équation fausse : {}",
    "Ecuación falsa: {}", "Ошибочное уравнение: {}", "x'' = 0 und nicht {}", "{} et non x'' = 0",
    "{} y no x'' = 0", "{} и не x'' = 0", "لا: {}", "לא: {}", "नहीं: {}", "The opposite equation: {}",
    "Twice the equation: {}", "If the spring is weak, the equation: {}", "Equation of my friend, who says: {}",
    "Gegenbeispiel zur Gleichung: {}", "The sign of the equation is swapped: {}",
    "It would be the equation: {}", "{} is no equation of motion", "{} ist nicht die Bewegungsgleichung.",
    "{} n'est pas l'équation du mouvement", "{} no es la ecuación", "{} — not the equation of motion",
    "{} m is the mass", "{} and m is the mass", "{}, k is it", "Nicht die Lösung. {}", "Fake answer: {}",
    "Bogus: {}", "Xyzzy: {}",
]  # fmt: skip
OPEN = [
    "{} or m x'' = k x", "{} oder m x'' = k x", "{} ou m x'' = k x", "{} o m x'' = k x", "{} или m x'' = k x",
    "{} lub m x'' = k x", "{} eller m x'' = k x", "{} または m x'' = k x", "{} 或 m x'' = k x",
    "{} 또는 m x'' = k x", "either {} or m x'' = k x", "Entweder {} oder m x'' = k x",
    "Maybe the equation is: {}", "Vielleicht: {}", "Peut-être l'équation : {}", "Quizás la ecuación: {}",
    "Forse l'equazione: {}", "Может быть, уравнение: {}", "おそらく運動方程式は {}", "多分：{}",
    "I doubt the equation: {}", "Je pense que l'équation est : {}", "Approximately the equation: {}",
    "{} lorsque k = 0",
]  # fmt: skip


@pytest.mark.parametrize("formula", ["m x'' = -k x", r"$m\ddot x = -kx$"])
@pytest.mark.parametrize("said", [*DENIED, *OPEN])
def test_what_denies_or_leaves_open_is_refused(said, formula):
    assert status("euler-lagrange", **OSCILLATOR, claim=[said.replace("{}", formula)]) == "invalid"


def test_no_harmless_word_denies():
    assert LEADING <= HARMLESS
    flat = ("or", "oder", "ou", "o", "или", "lub", "not", "nicht", "pas", "non", "no", "не", "nie", "nem", "ikke", "if",
            "wenn", "wrong", "falsch", "faux", "falso", "нет", "ή", "sau")  # fmt: skip
    assert not [word for word in flat if word in HARMLESS]
    assert [word for word in flat if len(word) > 2 and not is_denial(word)] == []


@pytest.mark.parametrize("word", ["Kraft", "Ответ", "Equazione", "fuerza"])
def test_a_word_that_is_declared_is_none(word):
    declared = {**OSCILLATOR, "parameters": {**SIGNS, "Kraft": "real", "Equazione": "real", "fuerza": "real"}}
    refused = status("euler-lagrange", **declared, claim=[f"{word}: m x'' = -k x"]) == "invalid"
    assert refused == (word != "Ответ")


def test_a_word_of_declared_letters_is_none():
    letters = dict.fromkeys("kurz", "real")
    assert status("euler-lagrange", **OSCILLATOR, claim=["kurz: m x'' = -k x"]) == "holds"
    declared = {**OSCILLATOR, "parameters": {**SIGNS, **letters}}
    assert status("euler-lagrange", **declared, claim=["kurz: m x'' = -k x"]) == "invalid"


JOINED = [
    "m x'' = {}k x oraz m z'' = -k z", "m x'' = {}k x et m z'' = -k z", "m x'' = {}k x y m z'' = -k z",
    "m x'' = {}k x и m z'' = -k z", "m x'' = {}k x und m z'' = -k z", "m x'' = {}k x e m z'' = -k z",
    "m x'' = {}k x & m z'' = -k z", "m x'' = {}k x   |   m z'' = -k z", "m x'' = {}k x、 m z'' = -k z。",
    "m x'' = {}k x，m z'' = -k z。", "m x'' = {}k x。m z'' = -k z。", "ｍ x'' ＝ {}ｋｘ；ｍ z'' ＝ －ｋｚ",
    "$m\\ddot x = {}kx$ y $m\\ddot z = -kz$", "$m\\ddot x = {}kx$ и $m\\ddot z = -kz$",
    "$m\\ddot x = {}kx \\quad\\text{oraz}\\quad m\\ddot z = -kz$",
    "$m\\ddot x = {}kx \\text{ y } m\\ddot z = -kz$", "m x'' = {}k x, also x'' = {}k x/m; m z'' = -k z",
    "m z'' = -k z, donc m x'' = {}k x", "**1.** $m\\ddot x = {}kx$\n\n**2.** $m\\ddot z = -kz$",
    "1) m x'' = {}k x\n2) m z'' = -k z",
]  # fmt: skip


@pytest.mark.parametrize("said", JOINED)
def test_joined_equations(said):
    assert both("euler-lagrange", "claim", said, "-", "+", **PLANE) == ["holds", "fails"]


@pytest.mark.parametrize("joint", ["y", "et", "und", "oraz", "&", "、"])
def test_neither_of_two_joined_equations_is_lost(joint):
    for pair in (("-k x", "k z"), ("k x", "-k z"), ("k x", "k z")):
        said = f"m x'' = {pair[0]} {joint} m z'' = {pair[1]}"
        assert status("euler-lagrange", **PLANE, claim=[said]) == "fails"
    two = f"m x'' = -k x {joint} m x'' = k x"
    assert status("euler-lagrange", **OSCILLATOR, claim=[two]) == "fails"


@pytest.mark.parametrize(
    "joint", ["oder", "lub", "o", "или", "ou", "eller", "||", "|", "&&", "vs", "albo", "또는"]
)
def test_other_signs_do_not_join(joint):
    assert status("euler-lagrange", **PLANE, claim=[f"m x'' = -k x {joint} m z'' = -k z"]) == "invalid"


def test_a_declared_name_joins_nothing():
    in_xy = {"q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2 - k*(x**2 + y**2)/2"}
    assert status("euler-lagrange", **in_xy, claim=["m x'' = -k x y m y'' = -k y"]) != "holds"
    charged = {**PLANE, "parameters": {**SIGNS, "e": "positive"}}
    assert status("euler-lagrange", **charged, claim=["m x'' = -k x e m z'' = -k z"]) != "holds"
    both_letters = {**PLANE, "parameters": {**SIGNS, "e": "positive"}}  # e t
    assert status("euler-lagrange", **both_letters, claim=["m x'' = -k x et m z'' = -k z"]) != "holds"


def test_two_answers_in_one_field_are_not_one():
    asked = {**OSCILLATOR, "p": ["p"]}
    for joint in ("und", "et", "y", "и", "&", "、", "oraz"):
        said = f"H = p²/(2m) + k x²/2 {joint} H = p²/(2m) - k x²/2"
        assert status("legendre-hamiltonian", **asked, H=said) == "invalid"


DEFINED = [
    (PENDULUM, "θ'' = -ω₀² sin θ, où ω₀² = {}", "g/l", "l/g"),
    (PENDULUM, "θ'' = -ω₀² sin θ, где ω₀² = {}", "g/l", "l/g"),
    (PENDULUM, "θ'' = -Ω² sin θ with the natural frequency Ω := {}", "√(g/l)", "g/l"),
    (PENDULUM, "θ'' + ω₀² sin θ = 0 con ω₀² = {}", "g/l", "g/(2 l)"),
    (
        PENDULUM,
        (
            r"Daraus folgt die Bewegungsgleichung $$\ddot\theta = -\omega_0^2\sin\theta \quad\text{mit}\quad "
            r"\omega_0^2 = {}.$$"
        ),
        "g/l",
        "l/g",
    ),
    (PENDULUM, r"$\ddot\theta = -\omega_0^2\sin\theta$ mit $\omega_0^2 = {}$", "g/l", "l/g"),
    (PENDULUM, r"$\ddot\theta = -\omega_0^2\sin\theta$, où $\omega_0^2 = {}$", "g/l", "l/g"),
]


@pytest.mark.parametrize(("system", "said", "right", "wrong"), DEFINED)
def test_abbreviations_behind_words(system, said, right, wrong):
    assert both("euler-lagrange", "claim", said, right, wrong, **system) == ["holds", "fails"]


def test_abbreviations_in_a_bracket():
    said = "x'' + 2γx' + ω₀²x = 0  ({}, ω₀² = k/m)"
    assert both("dissipative", "claim", said, "2γ = c/m", "γ = c/m", **DAMPED, energy_rate="-c*x_dot**2") == [
        "holds",
        "fails",
    ]


@pytest.mark.parametrize(
    "said",
    [
        "θ'' = -w sin θ, où w = g/l, w = l/g",
        "θ'' = -w² sin θ, où w² = g/L",
        "θ'' = -w² sin θ, où peut-être w² = g/l",
        "θ'' = -w² sin θ, où pas w² = g/l",
        "θ'' = -w² sin θ, mit w² ≠ g/l",
        "θ'' = -w² sin θ (w² = g/l oder l/g)",
        "θ'' = -w² sin θ (w² = g/l, w² = l/g)",
    ],
)
def test_what_defines_nothing_is_no_abbreviation(said):
    assert status("euler-lagrange", **PENDULUM, claim=[said]) != "holds"


FORMS = [
    (OSCILLATOR, r"$m\diff[2]{x}{t} = {}kx$", "-", "+"),
    (OSCILLATOR, r"m\overset{..}{x} = {}kx", "-", "+"),
    (OSCILLATOR, r"m\mathop x\limits^{..} = {}kx", "-", "+"),
    (OSCILLATOR, r"m\overset{{}}{x} = -kx", "..", "."),
    (OSCILLATOR, r"\frac{{{d^2}x}}{{d{t^2}}} = {}\frac{k}{m}x", "-", "+"),
    (OSCILLATOR, "m dot.double(x) = {}k x", "-", "+"),
    (OSCILLATOR, "D(D(x)) ~ {}k/m*x", "-", ""),
    (OSCILLATOR, "{} ~ -k/m*x", "D(D(x))", "D(x)"),
    (OSCILLATOR, "m x-double-dot = {}k x", "-", ""),
    (OSCILLATOR, "m x-{} = -k x", "double-dot", "dot"),
    (OSCILLATOR, "a = x'' = {}k x/m", "-", ""),
    (KEPLER, "({})' = 0; m r'' - m r φ'² + k/r² = 0", "m r² φ'", "m r φ'"),
    (KEPLER, "(r²φ̇)˙ = {}; m r̈ − m r φ̇² + k/r² = 0", "0", "1"),
    (KEPLER, "m r̈ = m r φ̇² − k/r² y {} = cte.", "m r² φ̇", "m r φ̇"),
    (THROWN, "x'' = 0, y'' = {} m/s²", "-9.81", "9.81"),
    (THROWN, "ẍ = 0; ÿ = {} m/s²", "−9,81", "9,81"),
    (THROWN, r"$\ddot x = 0, \ddot{y} = {}\;\mathrm{m\,s^{-2}}$", "-9.81", "+9.81"),
    (PENDULUM, "theta double dot equals {} g over l, times the sine of theta", "minus", "negative two"),
    (OSCILLATOR, "m times x double dot equals minus {} times x", "k", "two k"),
]


@pytest.mark.parametrize(("system", "said", "right", "wrong"), FORMS)
def test_copied_forms_and_dictation(system, said, right, wrong):
    assert both("euler-lagrange", "claim", said, right, wrong, **system) == ["holds", "fails"]


@pytest.mark.parametrize(
    ("system", "said"),
    [
        (KEPLER, "k(m r² φ')' = 0"),
        (KEPLER, "(m r²)' = 0"),
        (THROWN, "y'' = -9.81 m/s"),
        (THROWN, "y'' = -981 cm/s²"),
        (THROWN, "m y'' = -9.81 m/s²"),
        (PENDULUM, "theta double dot equals minus sine of theta times g over l"),
        (PENDULUM, "theta double dot equals not minus g over l, times the sine of theta"),
        (PENDULUM, "theta double dot equals minus g over l or l over g"),
        (PENDULUM, "theta double dot equals minus g over l times the sine of theta over two"),
        (OSCILLATOR, "x double dot equals minus k plus m over m"),
        (OSCILLATOR, "x double dot ~ -k/m*x"),
        (OSCILLATOR, "x'' ~ -k/m*x"),
        (OSCILLATOR, "x'' ≈ -k/m*x"),
    ],
)
def test_forms_that_may_say_something_else(system, said):
    assert status("euler-lagrange", **system, claim=[said]) == "invalid"


PHASE = {"q": ["q"], "p": ["p"], "parameters": {**SIGNS, "n": "positive", "q": "positive"}}
KEPLER_H = {
    "q": ["r", "phi"],
    "p": ["p_r", "p_phi"],
    "H": "p_r**2/(2*m) + p_phi**2/(2*m*r**2) - k/r",
    "parameters": {**SIGNS, "r": "positive"},
}
TOP = [
    {"u": "a", "v": "b", "value": "c"},
    {"u": "b", "v": "c", "value": "a"},
    {"u": "c", "v": "a", "value": "b"},
]
OTHERS = [
    (
        "dissipative",
        {**DAMPED, "claim": ["m x'' + c x' + k x"]},
        "energy_rate",
        "minus {} times c times x dot squared",
        "one",
        "one half",
    ),
    (
        "dissipative",
        {**DAMPED, "claim": ["m x'' + c x' + k x"]},
        "energy_rate",
        r"$\dot E = {}2\mathcal F = {}c\dot x^2$",
        "-",
        "+",
    ),
    ("multiplier-holonomic", ROLLING, "claim", "Натяжение нити: λ = {}m g sin α", "1/2 ", "2 "),
    ("multiplier-holonomic", ROLLING, "claim", "The frictional force is λ = ({}m g sin α) ÷ 2.", "", "3 "),
    ("multiplier-holonomic", ROLLING, "claim", "Quindi la tensione vale λ = {}m g sin α", "1/2 ", "2 "),
    (
        "multiplier-holonomic",
        ROLLING,
        "claim",
        "λ = {}m g sin α  (Zwangskraft in radialer Richtung)",
        "½",
        "2",
    ),
    ("legendre-hamiltonian", {**OSCILLATOR, "p": ["p"]}, "H", "H := p^2/({}m) + k*x^2/2:", "2*", ""),
    (
        "legendre-hamiltonian",
        {**OSCILLATOR, "p": ["p"]},
        "H",
        r"Energie totale : $E = \frac{p^2}{{}m} + \frac12kx^2$",
        "2",
        "",
    ),
    (
        "hamilton-equations",
        {**KEPLER_H, "p_dot": ["p_phi**2/(m*r**3) - k/r**2", "0"]},
        "q_dot",
        "(p_r/m, p_φ/({}r²))ᵀ",
        "m",
        "2 m",
    ),
    ("hamilton-equations", {**PHASE, "H": "p**2/2 + q", "p_dot": "-1"}, "q_dot", "dq_dt = {};", "p", "-p"),
    (
        "hamilton-equations",
        {**KEPLER_H, "q_dot": ["p_r/m", "p_phi/(m*r**2)"]},
        "p_dot",
        ["p_φ²/(m r³) {} k/r²", "p_φ = const"],
        "-",
        "+",
    ),
    (
        "routhian",
        {**KEPLER, "cyclic": ["phi"], "momenta": ["l"], "convention": "L-pq"},
        "R",
        "ℛ = ½mṙ² − ℓ²/({}mr²) + k/r",
        "2",
        "",
    ),
    (
        "gibbs-appell",
        {"q": ["x"], "bodies": [{"m": "m", "r": ["x", "0"]}], "V": "0"},
        "S",
        "S = {}m x''²/2 + (terms without accelerations)",
        "",
        "2 ",
    ),
    (
        "lie-bracket",
        {"x": ["x", "y"], "X": ["-y", "x"], "Y": ["x", "0"]},
        "claim",
        "[X,Y] = {}y∂ₓ {} x∂_y",
        "-",
        "+",
    ),
    (
        "lie-bracket",
        {"x": ["x", "y"], "X": ["-y", "x"], "Y": ["x", "0"]},
        "claim",
        "[X,Y] = {}(y∂_x + x∂_y) = {}y∂_x {} x∂_y",
        "-",
        "+",
    ),
    (
        "bilinear-covariant",
        {"q": ["q"], "p": ["p"], "Q": ["2*q"], "P": ["p"]},
        "factor",
        "c = {}",
        "2",
        "1/2",
    ),
    ("equality-only", {"lhs": "cos(m)/sin(m)", "parameters": {"m": "real"}}, "rhs", "{}(m)", "cotg", "tg"),
    ("degrees-of-freedom", {"q": ["x", "y"], "constraints": ["x - y"]}, "dof", "{}", "one", "two"),
    ("degrees-of-freedom", {"q": ["x", "y"], "constraints": ["x - y"]}, "dof", "{}", "eins", "zwei"),
    ("linearisation", {**PENDULUM, "equilibrium": {"theta": "0"}}, "claim", "θ̈ {} (g/l) θ ≈ 0", "+", "-"),
    (
        "linearisation",
        {**PENDULUM, "equilibrium": {"theta": "0"}},
        "claim",
        r"$\ddot\theta\simeq {}\frac gl\theta$",
        "-",
        "+",
    ),
    (
        "first-order",
        {"exact": ["sin(k)"], "small": ["k"], "parameters": {"k": "real"}},
        "claim",
        "s ≈ {}k",
        "",
        "2 ",
    ),
    ("jacobi-identity", {"x": ["a", "b", "c"], "pairs": TOP}, "casimirs", "C = a² + b² {} c²", "+", "-"),
    ("differential", {"x": ["q", "p"], "f": "q*p**2"}, "claim", "df = p² dq + {}q p dp", "2 ", ""),
    (
        "lagrangian-equivalence",
        {"q": ["x"], "L1": "m*x_dot**2/2", "L2": "m*x_dot**2/2 + k*x*x_dot", "relation": "gauge"},
        "F",
        "χ = k x²/{}",
        "2",
        "3",
    ),
    (
        "averaged-hamiltonian",
        {
            "q": ["theta"],
            "p": ["I"],
            "H": "omega*I + eps*I**2*cos(theta)**4",
            "angles": ["theta"],
            "small": ["eps"],
            "parameters": {"omega": "positive", "eps": "real"},
        },
        "K",
        "⟨H⟩ = ωI + {}εI²",
        "⅜",
        "½",
    ),
    ("equality-only", {"lhs": "sqrt(2)*m"}, "rhs", "m·2^({}) ", "1/2", "1/3"),
    (
        "number",
        {
            "given": {"g": "9.81", "l": "0.5"},
            "name": "T",
            "value": "2*pi*sqrt(l/g)",
            "unit": "s",
            "tolerance": "0.2 %",
        },
        "claim",
        "T ≈ {} Sekunden",
        "1.42",
        "2.42",
    ),
]


def put(said, formula):
    """Return what is said, a text or a list of texts, with a piece of it put in."""
    return (
        [text.replace("{}", formula) for text in said]
        if isinstance(said, list)
        else said.replace("{}", formula)
    )


@pytest.mark.parametrize(("kind", "system", "key", "said", "right", "wrong"), OTHERS)
def test_other_answers(kind, system, key, said, right, wrong):
    found = [status(kind, **{**system, key: put(said, piece)}) for piece in (right, wrong)]
    assert found == ["holds", "fails"]


def test_exponents_in_small_letters():
    def found(said, f):
        return status("poisson-bracket", **PHASE, pairs=[{"f": f, "g": "p", "value": said}])

    assert [found(said, "q**n") for said in ("n·qⁿ⁻¹", "n·qⁿ⁺¹")] == ["holds", "fails"]
    assert [found(said, "exp(q*t)") for said in ("t·exp(qt)", "q·eᵗ")] == ["holds", "fails"]


def test_brackets_with_labels():
    pair = {"f": "y*pz - z*py", "g": "z*px - x*pz"}
    space = {"q": ["x", "y", "z"], "p": ["px", "py", "pz"]}
    label = r"$\{L_x,L_y\}_{\mathrm{PB}} = "
    said = [
        f"{label}x p_y - y p_x$",
        f"{label}y p_x - x p_y$",
        label.replace("L_y", "L_z") + "x p_y - y p_x$",
    ]
    assert [status("poisson-bracket", **space, pairs=[{**pair, "value": each}]) for each in said[:2]] == [
        "holds",
        "fails",
    ]
    rate = {"f": "p", "g": "p**2/2 + q**2/2"}
    for value, verdict in (
        ("ṗ = {p, H} = -q", "holds"),
        ("ṗ = {p, H} = q", "fails"),
        ("q̇ = {p, H} = -q", "invalid"),
    ):
        assert status("poisson-bracket", **PHASE, pairs=[{**rate, "value": value}]) == verdict


def test_values_under_their_names():
    asked = {
        "of": "canonicity", "q": ["q"], "p": ["p"], "Q": ["q**alpha*cos(beta*p)"], "P": ["q**alpha*sin(beta*p)"],
        "find": ["alpha", "beta"], "parameters": {"q": "positive", "alpha": "real", "beta": "real"},
    }  # fmt: skip
    found = [
        status("parameters", **asked, values=[{"alpha": a, "beta": b}])
        for a, b in (("α = ½", "β = 2"), ("α = 2", "β = ½"), ("β = ½", "α = 2"))
    ]
    assert found == ["holds", "fails", "invalid"]


def test_rounded_values_behind_exact_ones():
    asked = {"q": ["r", "theta"], "L": "m*(r_dot**2 + r**2*theta_dot**2)/2 - m*g*r*cos(theta)", "contact": "r - a",
             "integrals": ["m*a**2*theta_dot**2/2 + m*g*a*cos(theta) = m*g*a"],
             "parameters": {"m": "positive", "g": "positive", "a": "positive", "r": "positive"}}  # fmt: skip
    said = {
        "θ = arccos(2/3) ≈ 48,2°": "holds",
        r"\theta=\arccos\tfrac23\approx 48{,}2^\circ": "holds",
        "θ = arcsin(2/3) ≈ 41.8°": "fails",
        "θ = arccos(2/3) ≈ 41.8°": "invalid",
        "θ ≈ 48.2°": "invalid",
    }
    assert {each: status("leaving-condition", **asked, leaves=each) for each in said} == said


def test_separable_in_a_sentence():
    asked = {"q": ["x", "y"], "p": ["px", "py"], "H": "(px**2 + py**2)/2 + (x**2 + y**2)/2"}
    words = ("Separable.", "Not separable.", "maybe separable")
    assert [status("separable", **asked, **{"is": [word]}) for word in words] == ["holds", "fails", "invalid"]
