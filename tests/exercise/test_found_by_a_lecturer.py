"""What a lecturer's 3,762 claims found: rates are no constants of phase space, and values may be told by others."""

import pytest

from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import claim_from

PHASE = {"q": ["q"], "p": ["p"]}
NEW = {**PHASE, "new_q": ["Q"], "new_p": ["P"]}
IDENTITY = {"Q": ["q"], "P": ["p"]}


def judged(keys):
    claim = claim_from({"id": "a", **keys})
    assert not claim.errors
    return [judgement for judgement, _ in judgements(claim)][-1]


@pytest.mark.parametrize(
    ("question", "right", "wrong"),
    [
        ({"kind": "canonicity", **PHASE}, {"Q": ["q"], "P": ["p + q"]}, {"Q": ["q"], "P": ["p + q_dot"]}),
        (
            {"kind": "canonicity", **PHASE},
            {"Q": ["2*q"], "P": ["p"], "valence": "2"},
            {"Q": ["q*q_dot"], "P": ["p"], "valence": "q_dot"},
        ),
        (
            {"kind": "canonicity", **NEW},
            {"implicit": ["Q = q + p", "P = p"]},
            {"implicit": ["Q = q + q_dot", "P = p"]},
        ),
        (
            {"kind": "canonicity-time-dependent", **PHASE},
            {"Q": ["q - p*t"], "P": ["p"]},
            {"Q": ["q"], "P": ["p - q_ddot"]},
        ),
        (
            {"kind": "bilinear-covariant", **PHASE},
            {"Q": ["q"], "P": ["p + q"], "factor": "1"},
            {"Q": ["q"], "P": ["p + q_dot"], "factor": "1"},
        ),
        ({"kind": "generating-F2", **NEW, "map": IDENTITY}, {"F": "q*P"}, {"F": "q*P + q_dot*t"}),
        (
            {"kind": "transformed-hamiltonian-K", **NEW, "H": "p**2/2", "map": IDENTITY},
            {"K": "P**2/2"},
            {"K": "P**2/2 + q_dot"},
        ),
        (
            {"kind": "hamilton-equations", **PHASE, "H": "p**2/2 + q**2/2"},
            {"solution": {"q": "sin(t)", "p": "cos(t)"}},
            {"solution": {"q": "q_dot*sin(t)", "p": "q_dot*cos(t)"}},
        ),
        (
            {"kind": "lie-series", **PHASE, "f": "q", "W": "p", "small": "eps", "order": 1},
            {"claim": "q + eps"},
            {"claim": "q + eps*q_dot"},
        ),
        (
            {"kind": "solution", "q": ["x"], "equations": ["x_ddot + x = 0"]},
            {"solution": {"x": "sin(t)"}},
            {"solution": {"x": "x_ddot*sin(t)"}},
        ),
        (
            {"kind": "lagrangian-equivalence", "q": ["x"], "L1": "x_dot**2/2", "L2": "x_dot**2/2 + x*x_dot",
             "relation": "gauge"},
            {"F": "x**2/2"},
            {"F": "x**2/2 + x_ddot"},
        ),
    ],
)  # fmt: skip
def test_rates_are_no_constants(question: dict, right: dict, wrong: dict) -> None:
    parameters = {"parameters": {"eps": "real"}} if "small" in question else {}
    assert judged({**question, **parameters, **right}).status == "holds"
    assert judged({**question, **parameters, **wrong}).status == "invalid"


def test_velocities_in_hamiltons_equations_are_wrong_and_may_stand_on_the_left() -> None:
    question = {"kind": "hamilton-equations", **PHASE, "H": "p**2/2 + q**2/2"}
    assert judged({**question, "q_dot": ["q' = p"], "p_dot": ["dp/dt = -q"]}).status == "holds"
    assert judged({**question, "q_dot": ["q_dot"], "p_dot": ["-q"]}).status == "fails"


@pytest.mark.parametrize("angle", ["atan2(q,p) - t", "atan2(q,p) + t"])
def test_an_angle_that_holds_the_time_is_no_angle_of_the_motion(angle: str) -> None:
    question = {"kind": "action-angle", **PHASE, "H": "p**2/2 + q**2/2", "new_q": ["th"], "new_p": ["J"]}
    action = "(p**2 + q**2)/2"
    assert judged({**question, "transformation": {"th": "atan2(q,p)", "J": action}}).status == "holds"
    assert judged({**question, "transformation": {"th": angle, "J": action}}).status == "fails"
    assert (
        judged({**question, "transformation": {"th": "atan2(q,p)", "J": f"{action} + t"}}).status == "fails"
    )


@pytest.mark.parametrize("rate", ["Derivative(M(x),t)", "diff(M(x),t)", "D[M[x],t]"])
def test_the_rate_of_a_function_of_a_coordinate_is_asked_about(rate: str) -> None:
    question = {
        "kind": "euler-lagrange", "q": ["x"], "L": "M(x)*x_dot**2/2 - k*x**2/2", "functions": {"M": ["x"]},
        "parameters": {"k": "positive"},
    }  # fmt: skip
    for claim in (f"M(x)*x'' + {rate}*x'/2 + k*x = 0", f"M(x)*x'' + M'(x)*x'**2/2 + k*x + {rate} = 0"):
        assert judged({**question, "claim": [claim]}).status == "invalid"
    assert judged({**question, "claim": ["M(x)*x'' + d/dt(M(x))*x'/2 + k*x = 0"]}).status == "holds"


@pytest.mark.parametrize(
    ("values", "status"),
    [
        (["a", "-a"], "holds"),
        (["Abs(a)", "-Abs(a)"], "holds"),
        (["sqrt(a**2)", "-sqrt(a**2)"], "holds"),
        (["a", "-a", "Abs(a)"], "holds"),
        (["Abs(a)"], "fails"),
        (["a", "Abs(a)"], "fails"),
    ],
)
def test_several_values_together_may_be_the_solutions(values: list[str], status: str) -> None:
    question = {
        "kind": "parameters", "of": "solution", "q": ["x"], "L": "x_dot**2/2 - a**2*x**2/2", "find": ["w"],
        "parameters": {"a": "nonzero", "w": "nonzero", "A": "nonzero"}, "solution": {"x": "A*sin(w*t)"},
    }  # fmt: skip
    assert judged({**question, "values": [{"w": value} for value in values]}).status == status


@pytest.mark.parametrize("sign", ["positive", "nonzero"])
def test_the_difference_of_two_angles_is_a_step_whatever_their_factor_is_called(sign: str) -> None:
    question = {
        "kind": "adiabatic-invariant", "q": ["q"], "p": ["p"], "H": "p**2/2 + w(tau)**2*q**2/2", "slow": "tau",
        "functions": {"w": ["tau"]}, "parameters": {"eps": "positive", "w": sign}, "small": "eps",
    }  # fmt: skip
    action = "(p**2 + w(tau)**2*q**2)/w(tau)"
    assert judged({**question, "I": action}).status == "holds"
    assert judged({**question, "I": f"{action} + atan2(w(tau)*q,p) - atan(w(tau)*q/p)"}).status == "fails"


@pytest.mark.slow
def test_points_at_fixed_distances_end_in_their_budget(processor_seconds) -> None:
    q = [f"{axis}{point}" for point in (1, 2, 3) for axis in "xyz"]
    pairs = [(1, 2), (2, 3), (1, 3)]
    apart = ["(x{0}-x{1})**2 + (y{0}-y{1})**2 + (z{0}-z{1})**2 - l**2".format(*pair) for pair in pairs]
    question = {"kind": "degrees-of-freedom", "q": q, "constraints": apart, "parameters": {"l": "positive"}}
    before = processor_seconds()
    assert judged({**question, "dof": "6", "budget": 2}).status in ("holds", "undecided")
    assert processor_seconds() - before < 60


M = {"m": "positive", "k": "positive"}
OSCILLATOR = {
    "kind": "hamilton-jacobi", "q": ["x"], "p": ["p"], "H": "p**2/(2*m) + m*w**2*x**2/2", "constants": ["E"],
    "parameters": {"m": "positive", "w": "positive"},
}  # fmt: skip
SLOW_AND_FAST = {
    "kind": "euler-lagrange", "q": ["x"], "L": "-m*c**2*sqrt(1 - x_dot**2/c**2) - k*x**2/2",
    "parameters": {**M, "c": "positive"},
}  # fmt: skip
LEGENDRE = {"kind": "legendre-hamiltonian", "q": ["x"], "p": ["p"], "parameters": M}
ROOT = "x*sqrt(2*m*E - m**2*w**2*x**2)/2"


@pytest.mark.parametrize(
    ("question", "right", "wrong"),
    [
        (OSCILLATOR, {"W": f"{ROOT} + E/w*asin(x*w*sqrt(m/(2*E)))"}, {"W": f"{ROOT} - E/w*asin(x*w*sqrt(m/(2*E)))"}),
        (
            OSCILLATOR,
            {"S": f"{ROOT} - E/w*acos(x*w*sqrt(m/(2*E))) - E*t"},
            {"S": f"{ROOT} - E/w*acos(x*w*sqrt(m/(2*E))) + E*t"},
        ),
        (OSCILLATOR, {"W": f"{ROOT} + E/w*asin(x*w*sqrt(m)/sqrt(2*E))"}, {"W": f"{ROOT} + sqrt(-1 - x**2)"}),
        (
            SLOW_AND_FAST,
            {"claim": ["m*x'' = -k*x*sqrt((1 - x'**2/c**2)**3)"]},
            {"claim": ["m*x'' = -k*x*sqrt(1 - x'**2/c**2)"]},
        ),
        (
            {**LEGENDRE, "L": "m*x_dot**2/2 - k*x**(3/2)"},
            {"H": "p**2/(2*m) + k*sqrt(x**3)"},
            {"H": "p**2/(2*m) - k*sqrt(x**3)"},
        ),
        (
            {**LEGENDRE, "L": "m*x_dot**2/2 - k*log(x)"},
            {"H": "p**2/(2*m) - k*log(1/x)"},
            {"H": "p**2/(2*m) + k*log(1/x)"},
        ),
        ({**LEGENDRE, "L": "log(x_dot)"}, {"H": "1 + log(p)"}, {"H": "1 - log(p)"}),
    ],
)  # fmt: skip
def test_what_is_not_real_refutes_nothing(question: dict, right: dict, wrong: dict) -> None:
    assert judged({**question, **right}).status == "holds"
    assert judged({**question, **wrong}).status == "fails"


NEW_HAMILTONIAN = {
    "kind": "transformed-hamiltonian-K", **NEW, "H": "(p**2 + w**2*q**2)/2", "parameters": {"w": "positive"},
    "map": {"Q": ["atan2(w*q, p)"], "P": ["(p**2/w + w*q**2)/2"]},
}  # fmt: skip
W = "q*sqrt(2*E - q**2)/2 + E*asin(q/sqrt(2*E))"


@pytest.mark.parametrize(
    ("question", "right", "wrong"),
    [
        (NEW_HAMILTONIAN, {"K": "w*P + 1"}, {"K": "w*P + Q - atan(tan(Q))"}),
        (NEW_HAMILTONIAN, {"K": "w*P + cos(t)"}, {"K": "w*P + atan(tan(2*Q)) - 2*Q"}),
        (
            {"kind": "hamilton-jacobi", **PHASE, "H": "p**2/2 + q**2/2", "constants": ["E"]},
            {"W": "q*sqrt(2*E - q**2)/2 + E*atan2(q, sqrt(2*E - q**2))"},
            {"W": f"{W} + atan(q) + atan(1/q)"},
        ),
    ],
)
def test_steps_beside_what_jumps_itself(question: dict, right: dict, wrong: dict) -> None:
    """An angle of the map excuses no jump elsewhere: Q − atan(tan Q) is 0 on one side of p = 0 and π on the other."""
    assert judged({**question, **right}).status == "holds"
    assert judged({**question, **wrong}).status == "fails"


def test_where_a_lagrangian_is_real_is_told() -> None:
    right = {**SLOW_AND_FAST, "claim": ["m*x'' = -k*x*sqrt((1 - x'**2/c**2)**3)"]}
    assert judged(right).warnings == ("judged where L is real: 1 - x_dot**2/c**2 > 0",)
    assert judged({**right, "domain": "x_dot**2 < c**2"}).warnings == ()


@pytest.mark.parametrize("claim", ["3,600,000 J", "3 600 000 J", r"$3\,600\,000$ J", "3.6 MJ"])
def test_figures_in_groups_of_three(claim: str) -> None:
    question = {"kind": "number", "claim": claim, "unit": "J"}
    assert judged({**question, "value": "3.6e6 J"}).status == "holds"
    assert judged({**question, "value": "3.6e5 J"}).status == "fails"


@pytest.mark.parametrize(
    ("claim", "told"),
    [
        ("100,200,300", "100200300, or 3 values"),
        ("100 200 300", "100200300, or 3 values"),
        ("12 345", "12345, or 2 values"),
        ("27 °C", "from zero"),
    ],
)
def test_what_two_numbers_may_be_meant_by_is_asked(claim: str, told: str) -> None:
    found = judged({"kind": "number", "claim": claim, "value": "300.15", "unit": "K"})
    assert found.status == "invalid"
    assert told in found.reasons[0]


SPRING = {"parameters": M, "q": ["x"], "p": ["p"], "L": "m*x_dot**2/2 - k*x**2/2"}


@pytest.mark.parametrize("chain", ["{} = H", "{} = T + V = H", "H = T + V = {}", "H = {}"])
def test_a_chain_may_end_with_what_is_asked(chain: str) -> None:
    question = {"kind": "legendre-hamiltonian", **SPRING}
    assert judged({**question, "H": chain.format("p^2/(2m) + k x^2/2")}).status == "holds"
    assert judged({**question, "H": chain.format("p^2/(2m) - k x^2/2")}).status == "fails"


def test_both_sides_are_told_whatever_the_right_one_is() -> None:
    bracket = {"kind": "poisson-bracket", **PHASE, "pairs": [{"f": "p", "g": "q", "value": "1"}]}
    assert "1.00000000000000 against -1.00000000000000" in " ".join(judged(bracket).reasons)


def test_a_lost_time_and_a_slip_in_a_motion_are_told() -> None:
    falling = {"kind": "constant-of-motion", **PHASE, "H": "p**2/2 + q"}
    assert judged({**falling, "I": "p + t"}).status == "holds"
    assert "the term 1 lacks the factor t" in judged({**falling, "I": "p + 1"}).reasons[0]
    moving = {"kind": "solution", "q": ["x"], "L": SPRING["L"], "parameters": {**M, "A": "real"}}
    assert judged({**moving, "solution": {"x": "A*cos(sqrt(k/m)*t)"}}).status == "holds"
    assert (
        "should be cos(sqrt(k)*t/sqrt(m))"
        in judged({**moving, "solution": {"x": "A*cos(2*sqrt(k/m)*t)"}}).reasons[0]
    )
    begun = {**moving, "initial": {"x": "1"}}
    assert (
        "should be half what it is" in judged({**begun, "solution": {"x": "2*cos(sqrt(k/m)*t)"}}).reasons[0]
    )


@pytest.mark.parametrize(
    ("given", "open_"),
    [
        ({}, ("this is one motion of many: 2 constants of integration stay open",)),
        ({"initial": {"x": "A"}}, ("the initial value of x_dot stays open",)),
        ({"initial": {"x": "A", "x_dot": "0"}}, ()),
    ],
)
def test_what_a_motion_leaves_open_is_told(given: dict, open_: tuple[str, ...]) -> None:
    moving = {"kind": "solution", "q": ["x"], "L": SPRING["L"], "parameters": {**M, "A": "real"}}
    assert judged({**moving, **given, "solution": {"x": "A*cos(sqrt(k/m)*t)"}}).warnings == open_


@pytest.mark.parametrize(("value", "other"), [("-1", True), ("-2", False), ("2", False)])
def test_another_convention_is_told_where_it_is_one(value: str, other: bool) -> None:
    found = judged({"kind": "poisson-bracket", **PHASE, "pairs": [{"f": "q", "g": "p", "value": value}]})
    assert ("opposite sign convention" in found.reasons[0]) == other


@pytest.mark.parametrize("count", [2, 8, 11])
def test_a_side_with_a_declared_letter_is_no_definition_however_many_stand_before_it(count: int) -> None:
    """H = Σ P²/2 - L, where L is a parameter and a number of P_1, P_2, … come first."""
    numbers = range(1, count + 1)
    right = " + ".join(f"P_{i}**2/2" for i in numbers) + " - L"
    question = {
        "kind": "legendre-hamiltonian",
        "q": [f"x_{i}" for i in numbers],
        "p": [f"P_{i}" for i in numbers],
        "parameters": {"L": "real"},
        "L": " + ".join(f"x_{i}_dot**2/2" for i in numbers) + " + L",
    }
    assert judged({**question, "H": f"H = {right} = {right}"}).status == "holds"
    assert judged({**question, "H": f"H = P_1**2 + {right} = {right}"}).status == "fails"
