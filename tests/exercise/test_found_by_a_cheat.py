"""What a stranger met who cheated, and who wrote right answers that were marked wrong: each beside its twin."""

from __future__ import annotations

import pytest

from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.quantities.calculations import calculated
from canon.exercise.sheet.sheet import claim_from
from canon.expression import LanguageError, Scope


def judged(**keys: object):
    claim = claim_from({"id": "a", **keys})
    assert not claim.errors
    return [judgement for judgement, _ in judgements(claim)][-1]


P = "positive"
CENTRAL = {
    "kind": "euler-lagrange", "q": ["r", "phi"], "parameters": {"m": P, "r": P}, "functions": {"V": ["r"]},
    "L": "m*(r_dot**2 + r**2*phi_dot**2)/2 - V(r)",
}  # fmt: skip
BEAD = {
    "kind": "multiplier-holonomic", "q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2 - m*g*y",
    "constraints": ["x**2 + y**2 - l**2"], "multipliers": ["lam"], "parameters": {"m": P, "g": P, "l": P},
}  # fmt: skip
FALL = {
    "kind": "hamilton-equations", "q": ["x"], "p": ["p"], "H": "p**2/(2*m) + V(x)", "functions": {"V": ["x"]},
    "parameters": {"m": P},
}  # fmt: skip
OSCILLATOR = {"q": ["x"], "L": "m*x_dot**2/2 - k*x**2/2", "parameters": {"m": P, "k": P}}
TABLE = {
    "kind": "reaction", "q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2 - m*g*y", "parameters": {"m": P, "g": P},
    "constraints": ["y"], "multipliers": ["N"],
}  # fmt: skip


@pytest.mark.parametrize(
    ("radial", "status"),
    [
        ("m(r'' - r φ'²) = -∂V/∂r", "holds"),
        (r"$m(\ddot r - r\dot\phi^2) = -\frac{\partial V}{\partial r}$", "holds"),
        ("-∂V/∂r = m(r'' - r φ'²)", "holds"),
        ("m(r'' - r φ'²) = -∂V/∂r = -V'(r)", "holds"),
        ("m r'' = ∂L/∂r", "holds"),
        ("m(r'' - r φ'²) = ∂V/∂r", "fails"),
        ("m(r'' - r φ'²) + V'(r) = ∂V/∂r", "fails"),
        ("m(r'' - r φ'²) + V'(r) = -∂V/∂r", "fails"),
        ("m r'' = ∂L/∂r - m r φ'²", "invalid"),
        ("m(r'' - r φ'²) = -∂U/∂r", "invalid"),
        ("∂L/∂r = m r φ'² - V'(r)", "invalid"),
    ],
)
def test_derivatives_of_declared_and_given_functions_are_read(radial: str, status: str) -> None:
    assert judged(**CENTRAL, claim=[radial, "r φ'' + 2 r' φ' = 0"]).status == status


@pytest.mark.parametrize("claim", ["m y'' + m g - 2λ y = ∂V/∂y", "m x'' - 2λx = ∂V/∂y"])
def test_equations_with_functions_that_nobody_gave_are_refused(claim: str) -> None:
    assert "∂V/∂y is made of is not given here" in judged(**BEAD, claim=[claim]).known
    assert judged(**BEAD, claim=["m x'' = 2λx", "m y'' - 2λy = -m g"]).status == "holds"


@pytest.mark.parametrize(
    ("rate", "status"),
    [("p' = -∂V/∂x = -V'(x)", "holds"), ("p' = ∂V/∂x = -V'(x)", "fails"), ("-∂H/∂x = -V'(x)", "holds")],
)
def test_links_with_declared_functions_are_judged(rate: str, status: str) -> None:
    assert judged(**FALL, q_dot=["x' = ∂H/∂p = p/m"], p_dot=[rate]).status == status


@pytest.mark.parametrize(
    ("asked", "key", "said"),
    [
        ({**OSCILLATOR, "kind": "legendre-hamiltonian", "p": ["p"]}, "H", "∂H/∂x = p²/(2m) + kx²/2"),
        ({**OSCILLATOR, "kind": "legendre-hamiltonian", "p": ["p"]}, "H", "-∂S/∂t = p²/(2m) + kx²/2"),
        ({"kind": "canonicity", "q": ["q"], "p": ["p"], "P": ["p"]}, "Q", ["∂F/∂q = q"]),
        ({**FALL, "p_dot": ["-V'(x)"]}, "q_dot", ["∂L/∂x = p/m"]),
    ],
)
def test_derivatives_of_others_are_no_names_of_the_answer(
    asked: dict[str, object], key: str, said: object
) -> None:
    assert "is asked for here, and this says" in judged(**asked, **{key: said}).known


@pytest.mark.parametrize(
    ("said", "status"),
    [
        ("E = x' ∂L/∂x' - L = ½ m x'² + ½ k x²", "holds"),
        ("E = x' ∂L/∂x' + L = ½ m x'² + ½ k x²", "fails"),
        ("E = T + V = ½ m x'² + ½ k x²", "holds"),
        ("½ m x'² + ½ k x² = E", "holds"),
        ("½ m x'² - ½ k x² = E", "fails"),
        ("L = ½ m x'² + ½ k x²", "invalid"),
    ],
)
def test_jacobis_energy_by_its_definition(said: str, status: str) -> None:
    assert judged(**OSCILLATOR, kind="constant-of-motion", I=said).status == status


def test_a_force_in_multipliers_leaves_them_open() -> None:
    assert judged(**TABLE, force=["0", "N"]).warnings == ("N stays open",)
    assert judged(**TABLE, force=["0", "N"], complete=True).status == "fails"
    assert judged(**TABLE, force=["0", "N"], values={"N": "m*g"}, complete=True).status == "holds"
    assert judged(**TABLE, force=["0", "m*g"], complete=True).status == "holds"
    assert judged(**TABLE, force=["0", "2*m*g"]).status == "fails"


@pytest.mark.parametrize(
    ("value", "status"),
    [
        ("N = m g + m y'' = m g", "holds"),
        ("N = m g + m x' = m g", "fails"),
        ("m g = N", "holds"),
        ("N - m g = 0", "invalid"),
        ("2N = 2 m g", "invalid"),
    ],
)
def test_sides_that_are_equal_on_the_motion(value: str, status: str) -> None:
    assert judged(**TABLE, values={"N": value}).status == status


@pytest.mark.parametrize(
    ("rate", "status"),
    [
        ("dE/dt = m x' x'' + k x x' = -c x'²", "holds"),
        ("dE/dt = d/dt(½mx'² + ½kx²) = -c x'²", "holds"),
        ("dE/dt = m x' x'' - k x x' = -c x'²", "fails"),
    ],
)
def test_the_energy_rate_by_the_motion(rate: str, status: str) -> None:
    damped = {
        **OSCILLATOR,
        "parameters": {"m": P, "k": P, "c": P},
        "kind": "dissipative",
        "F": "c*x_dot**2/2",
    }
    assert judged(**damped, energy_rate=rate).status == status


def test_two_constants_of_the_motion_need_not_be_equal() -> None:
    free = {"kind": "constant-of-motion", "q": ["x", "y"], "L": "x_dot**2/2 + y_dot**2/2"}
    assert judged(**free, I="I = x' = y'").status == "fails"


@pytest.mark.parametrize(("link", "status"), [("p = m x' = m v", "holds"), ("p = x' = m v", "fails")])
def test_velocities_in_a_solution_are_those_of_the_solution(link: str, status: str) -> None:
    free = {
        "kind": "hamilton-equations",
        "q": ["x"],
        "p": ["p"],
        "H": "p**2/(2*m)",
        "parameters": {"m": P, "v": "real"},
    }
    assert judged(**free, solution={"x": "v*t", "p": link}).status == status


@pytest.mark.parametrize(
    ("link", "status"),
    [("F1 = ½ q p = ½ m w q² cot Q", "holds"), ("F1 = q p = ½ m w q² cot Q", "fails")],
)
def test_generating_functions_on_the_map(link: str, status: str) -> None:
    asked = {
        "kind": "generating-F1", "q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"], "parameters": {"m": P, "w": P},
        "map": {"Q": ["atan2(m*w*q, p)"], "P": ["(p**2 + m**2*w**2*q**2)/(2*m*w)"]},
    }  # fmt: skip
    assert judged(**asked, F=link).status == status


@pytest.mark.parametrize(
    "said",
    [
        "v^2 = 10 m/s",
        "2v = 10 m/s",
        "1/v = 10 m/s",
        "v*t = 10 m/s",
        "v' = 10 m/s",
        "dv/dt = 10 m/s",
        "v = 2v = 10 m/s",
    ],
)
def test_an_equation_for_a_value_is_not_the_value(said: str) -> None:
    asked = {"kind": "number", "value": "10", "unit": "m/s", "name": "v"}
    assert "v is asked for here, and this says" in judged(**asked, claim=said).known
    assert judged(**asked, claim="v = √(2 g h) = 10 m/s").status == "holds"


@pytest.mark.parametrize(
    "said", ["x^2 = 2", "1/x = 2", "e^x = 2", "x + y = 2", "sin x = 2", "ln x = 2", "x' = 2"]
)
def test_an_equation_for_a_value_without_a_name_is_not_the_value(said: str) -> None:
    assert judged(kind="number", value="2", claim=said).status == "invalid"
    assert judged(kind="number", value="2", claim="x = 2").status == "holds"


@pytest.mark.parametrize(
    ("said", "status"),
    [
        ("v = (10 kg)", "fails"), ("v = (20 kg)/2", "fails"), ("v = (20 s)/(2 kg)", "fails"), ("10 kg*1", "fails"),
        ("20 s/2", "fails"), ("20 [m]/2", "fails"), ("5 kg + 5", "invalid"), ("√(100 kg)", "invalid"),
        (r"$(10\,\mathrm{kg})$", "invalid"), ("v = 20 m / 2 s", "holds"), ("v = 20 m ÷ 4 s", "fails"),
        ("5 m/s + 18 km/h", "holds"), ("5 m/s + 18 m", "invalid"), ("v = √(100 m²/s²)", "holds"),
        ("v = 9.8 m/s² · 1 s + 0.2 m/s", "holds"), ("1/2 · 20 m/s", "holds"), ("1/2 · 10 m/s", "fails"),
    ],
)  # fmt: skip
def test_units_inside_calculations_count(said: str, status: str) -> None:
    assert judged(kind="number", value="10", unit="m/s", name="v", claim=said).status == status


def test_calculations_keep_their_units() -> None:
    assert calculated("F = 150 kg · 10 m/s²".removeprefix("F = "), Scope()) == ("1500", "m kg s^-2")
    assert calculated("3 J / 2 J", Scope()) == ("3/2", "1")
    assert calculated("2 * 36 km/h", Scope()) is None
    with pytest.raises(LanguageError, match="different dimensions"):
        calculated("1 kg + 1 m", Scope())


@pytest.mark.parametrize(
    "said", ["θ = arccos(2/3) ≈ 48.19°", "arccos(2/3)", "ArcCos[2/3]", "cos⁻¹(2/3)", "48.19"]
)
def test_an_arc_cosine_is_an_angle(said: str) -> None:
    asked = {"kind": "number", "value": "180/pi*acos(2/3)", "unit": "deg", "tolerance": "0.5 %"}
    assert judged(**asked, claim=said).status == "holds"
    assert judged(**asked, claim="arccos(1/3)").status == "fails"


def test_mathematicas_or() -> None:
    asked = {"kind": "number", "value": ["-1+sqrt(2)", "-1-sqrt(2)"], "complete": True}
    assert judged(**asked, claim="x == -1 - Sqrt[2] || x == -1 + Sqrt[2]").status == "holds"
    assert judged(**asked, claim="x == -1 - Sqrt[2] || x == 1 + Sqrt[2]").status == "fails"


def test_what_moves_depends_on_the_time_alone() -> None:
    pendulum = {
        "kind": "euler-lagrange",
        "q": ["theta"],
        "L": "theta_dot**2/2 + w**2*cos(theta)",
        "parameters": {"w": P},
    }
    assert judged(**pendulum, claim=["∂²θ/∂t² = -w² sin θ"]).status == "holds"
    assert judged(**pendulum, claim=["∂²θ/∂t² = w² sin θ"]).status == "fails"


def test_the_search_for_a_repair_of_a_jump_in_time_ends() -> None:
    asked = {
        "kind": "solution", "q": ["x"], "equations": ["x_ddot + w**2*x = 0"], "parameters": {"w": P, "a": "real"},
        "initial": {"x": "a", "x_dot": "0"},
    }  # fmt: skip
    # It was a RecursionError.
    assert judged(**asked, solution={"x": "a*cos(w*t)*sign(t)**2"}).status == "fails"
    assert judged(**asked, solution={"x": "a*cos(w*t)"}).status == "holds"
