"""Names that people use beside the declared ones: ω for w, H' and H̄ for K, sentences before a Hamiltonian."""

from __future__ import annotations

import pytest

from tests.exercise.test_words_around import judged

ROTATED = {
    "kind": "transformed-hamiltonian-K", "q": ["q"], "p": ["p"], "H": "p**2/2 + q**2/2", "new_q": ["Q"], "new_p": ["P"],
    "map": {"Q": "p", "P": "-q"},
}  # fmt: skip
SWING = {
    "kind": "solution", "q": ["x"], "equations": ["x_ddot + w**2*x = 0"], "parameters": {"w": "positive", "a": "real"},
    "initial": {"x": "a", "x_dot": "0"},
}  # fmt: skip
OSCILLATOR = {"kind": "legendre-hamiltonian", "q": ["q"], "p": ["p"], "L": "q_dot**2/2 - q**2/2"}


@pytest.mark.parametrize(
    "name", ["H'", "H̄", "H̃", "H*", "H_new", "H(Q,P)", "H'(Q,P)", "K(Q, P, t)", r"\bar H",
             r"\tilde{H}(Q,P)", r"\mathcal{H}'", r"H^*"]
)  # fmt: skip
def test_names_of_the_new_hamiltonian(name: str) -> None:
    half = r"\frac{P^2 + Q^2}{2}" if "\\" in name else "(P² + Q²)/2"
    assert judged(**ROTATED, K=f"{name} = {half}").status == "holds"
    assert judged(**ROTATED, K=f"{name} = {half} + Q").status == "fails"


@pytest.mark.parametrize("name", ["L'", "F'", "G̃", "K''", "L*", "dH/dt", "Ḣ", "dK/dt", r"\dot H"])
def test_names_of_something_else(name: str) -> None:
    assert judged(**ROTATED, K=f"{name} = (P² + Q²)/2").status == "invalid"


@pytest.mark.parametrize("typed", ["x(t) = a cos(ωt)", r"x(t) = a\cos(\omega t)", "x = a cos ωt"])
def test_omega_is_w(typed: str) -> None:
    assert judged(**SWING, solution={"x": typed}).status == "holds"
    assert judged(**SWING, solution={"x": typed.replace("cos", "sin")}).status == "fails"


def test_omega_beside_w_is_itself() -> None:
    both = {**SWING, "parameters": {**SWING["parameters"], "omega": "positive"}}
    assert judged(**both, solution={"x": "a cos(ωt)"}).status == "fails"
    assert judged(**both, solution={"x": "a cos(wt)"}).status == "holds"


@pytest.mark.parametrize("typed", ["x(t) = A cos(w t), A = a", "x = a cos(2π f t), where f = w/(2π)"])
def test_a_solution_with_abbreviations(typed: str) -> None:
    assert judged(**SWING, solution={"x": typed}).status == "holds"
    assert judged(**SWING, solution={"x": typed.replace("cos", "sin")}).status == "fails"


@pytest.mark.parametrize(
    "said", ["The Hamiltonian is H = {}", "the total Hamiltonian reads: {}", "Hamiltonian: {}", "{} = H"]
)  # fmt: skip
def test_sentences_before_a_hamiltonian(said: str) -> None:
    assert judged(**OSCILLATOR, H=said.format("p²/2 + q²/2")).status == "holds"
    assert judged(**OSCILLATOR, H=said.format("p²/2 - q²/2")).status == "fails"


def test_a_denial_is_not_passed_over() -> None:
    assert judged(**OSCILLATOR, H="The Hamiltonian is not p²/2 + q²/2").status == "invalid"


def test_a_coordinate_with_another_name_is_derived_once() -> None:
    """ω stood beside w among the coordinates, d/dt took both, and twice the force held."""
    spring = {"kind": "euler-lagrange", "q": ["w"], "L": "m*w_dot**2/2 - k*w**2/2"}
    spring["parameters"] = {"m": "positive", "k": "positive"}
    for name in ("w", "omega"):
        assert judged(**spring, claim=[f"d/dt(m {name}') + k {name} = 0"]).status == "holds"
        assert judged(**spring, claim=[f"d/dt(m {name}') + 2 k {name} = 0"]).status == "fails"


def test_the_time_keeps_its_name() -> None:
    timed = {**SWING, "t": "omega", "solution": {"x": "a*cos(w*omega)"}}
    assert judged(**timed).status == "holds"
    assert judged(**{**timed, "solution": {"x": "a*cos(omega**2)"}}).status == "fails"


def test_the_name_of_what_is_asked_is_no_answer() -> None:
    """ω = ω says nothing, although ω would be w elsewhere."""
    asked = {"kind": "frequency", "q": ["q"], "p": ["p"], "H": "p**2/2 + w**2*q**2/2"}
    asked |= {"parameters": {"w": "positive", "E": "positive"}}
    assert judged(**asked, omega=["omega"]).status == "invalid"
    assert judged(**asked, omega=["w"]).status == "holds"
