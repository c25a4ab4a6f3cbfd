"""Derivatives that would be 0 only because it is not written what depends on what are asked about, and never judged."""

import pytest
import sympy as sp

from canon import Domain, Verdict
from canon.exercise.claim_verdict import examine
from canon.exercise.question.deadline import Deadline
from canon.exercise.question.question import Chain, Part, decide
from canon.exercise.sheet.reading import InvalidClaim
from canon.exercise.sheet.sheet import claim_from
from canon.proof.domain.verdict import Status

MORSE = {"kind": "frequency", "q": ["x"], "p": ["p"], "H": "p^2/(2m) + D*(1 - exp(-a*x))^2",
         "parameters": {"m": "positive", "D": "positive", "a": "positive", "E": "positive"},
         "domain": "p**2/(2*m) + D*(1 - exp(-a*x))**2 < D", "actions": ["J"]}  # fmt: skip
OSCILLATOR = {"q": ["q"], "p": ["p"], "H": "p^2/(2m) + m w^2 q^2/2",
              "parameters": {"m": "positive", "w": "positive", "E": "positive"}}  # fmt: skip
ACTION = {"kind": "action-angle", **OSCILLATOR}
FREQUENCY = {"kind": "frequency", **OSCILLATOR}
SLOW = {"kind": "adiabatic-invariant", "q": ["q"], "p": ["p"], "small": ["eps"], "slow": ["tau"],
        "functions": {"w": ["tau"]}, "parameters": {"eps": "positive", "w": "positive"},
        "H": "p^2/2 + w(tau)^2 q^2/2"}  # fmt: skip
J0 = "(p^2 + w(tau)^2*q^2)/(2*w(tau))"
PHASE = {"q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"]}
GALILEI = {"kind": "transformed-hamiltonian-K", **PHASE, "H": "p^2/(2m)", "parameters": {"m": "positive", "v": "real"},
           "map": {"Q": ["q - v*t"], "P": ["p"]}}  # fmt: skip
TURNING = {"kind": "transformed-hamiltonian-K", **PHASE, "H": "p^2/(2m) + m w^2 q^2/2",
           "parameters": {"m": "positive", "w": "positive", "P": "positive"},
           "inverse_map": {"q": ["sqrt(2*P/(m*w))*sin(Q)"], "p": ["sqrt(2*m*w*P)*cos(Q)"]}}  # fmt: skip
CUBE = {"kind": "generating-F2", **PHASE, "map": {"Q": ["q^3/3"], "P": ["p/q^2"]}, "domain": ["Ne(q,0)"]}
JACOBI = {"kind": "hamilton-jacobi", "q": ["q"], "p": ["p"], "H": "p^2/(2m) + m w^2 q^2/2", "constants": ["E"],
          "parameters": {"m": "positive", "w": "positive", "E": "positive"}, "energy": "E"}  # fmt: skip
KEPLER = {"kind": "frequency", "q": ["r", "phi"], "p": ["pr", "l"], "H": "(pr^2 + l^2/r^2)/(2m) - k/r",
          "parameters": {"m": "positive", "k": "positive", "E": "negative", "l": "positive"},
          "domain": ["(pr**2 + l**2/r**2)/(2*m) - k/r < 0"], "actions": ["J1", "J2"], "budget": 60}  # fmt: skip


def verdict(base, key, answer):
    return examine(claim_from({**base, key: answer, "id": "a"})).verdict


@pytest.mark.parametrize(
    ("base", "key", "answer"),
    [
        (SLOW | {"order": 1}, "I", f"{J0} + Derivative(w(tau), t)*q*p/(2*w(tau)^2)"),
        (SLOW, "I", f"{J0} + q^2*Derivative(w(tau), t)/eps"),
        (SLOW, "I", f"{J0} + q^2*Derivative(tau, t)/eps"),
        (SLOW | {"order": 1}, "I", f"{J0} + d/dt(w(tau))*q*p/(2*w(tau)^2)"),
        (SLOW | {"order": 1}, "I", f"{J0} + dw/dt*q*p/(2*w(tau)^2)"),
        (SLOW, "I", f"{J0} + q^2*∂tau/∂t/eps"),
        (SLOW | {"order": 1}, "I", f"{J0} + q*Derivative(w(tau)**2, t)"),
        (MORSE, "omega", ["a*sqrt(2*(D-E)/m) + ∂E/∂J"]),
        (MORSE, "omega", ["a*sqrt(2*(D-E)/m) + Derivative(E, J)"]),
        (MORSE, "omega", ["a*sqrt(2*(D-E)/m)*(1 + ∂J/∂E)"]),
        (MORSE, "omega", ["a*sqrt(2*(D-E)/m) + ∂E/∂p"]),
        (MORSE, "omega", ["a*sqrt(2*(D-E)/m) + Derivative(E**2, J)"]),
        (ACTION, "J", ["E/w + ∂E/∂q"]),
        (ACTION, "J", ["E/w*(1 + Derivative(E, q))"]),
        (ACTION, "J", ["J = E/w + ∂(E^2)/∂p"]),
        (GALILEI, "K", "P^2/(2m) - v P + Q ∂Q/∂t"),
        (GALILEI, "K", "K = P^2/(2m) + P ∂Q/∂t"),
        (GALILEI, "K", "P^2/(2m) - v P + P*Derivative(Q, q)"),
        (TURNING, "K", "w P*(1 + ∂q/∂P)"),
        (TURNING, "K", "w*P + Q*Derivative(q, Q)"),
        (CUBE, "F", "q^3 P/3 + q*Derivative(p, q)"),
        (JACOBI, "W", "Integral(sqrt(2*m*E - m**2*w**2*q**2), q) + q*Derivative(p, q)"),
    ],
)
def test_what_depends_is_asked(base, key, answer):
    with pytest.raises(InvalidClaim, match=r"depend on \w+ here, or is it held fixed\?"):
        verdict(base, key, answer)


@pytest.mark.parametrize(
    ("base", "key", "right", "wrong"),
    [
        (SLOW | {"order": 1}, "I", f"{J0} + eps*Derivative(w(tau), tau)*q*p/(2*w(tau)^2)", f"{J0} + eps*q*p"),
        (MORSE, "omega", ["ω = ∂E/∂J = a sqrt(2D/m) - a^2 J/m"], ["ω = ∂E/∂J = a sqrt(2D/m) - 2a^2 J/m"]),
        (MORSE, "omega", ["ω = ∂H/∂J = a sqrt(2D/m) - a^2 J/m"], ["ω = ∂H/∂J = a sqrt(D/m) - a^2 J/m"]),
        (MORSE, "omega", ["dE/dJ = a sqrt(2(D-E)/m)"], ["dE/dJ = a sqrt((D-E)/m)"]),
        (
            MORSE,
            "omega",
            ["1/Derivative(sqrt(2m)/a*(sqrt(D) - sqrt(D - E)), E)"],
            ["2/Derivative(sqrt(2m)/a*(sqrt(D) - sqrt(D - E)), E)"],
        ),
        (
            MORSE,
            "omega",
            ["a sqrt(2(D-E)/m) = a sqrt(2D/m) - a^2 J/m"],
            ["2a sqrt(2(D-E)/m) = a sqrt(2D/m) - a^2 J/m"],
        ),
        (
            MORSE,
            "omega",
            ["a sqrt(2D/m) - a^2 J/m = a sqrt(2(D-E)/m)"],
            ["a sqrt(2(D-E)/m) = a sqrt(2D/m) - 2a^2 J/m"],
        ),
        (ACTION, "J", ["J = H/ω = E/ω"], ["J = H/w*2 = E/ω"]),
        (ACTION, "J", ["J = (p^2/(2m) + m w^2 q^2/2)/w = E/w"], ["J = (p^2/(2m) + m w^2 q^2)/w = E/w"]),
        (ACTION, "J", ["J = E/ω = p^2/(2 m w) + m w q^2/2"], ["J = 2E/ω = p^2/(2 m w) + m w q^2/2"]),
        (
            FREQUENCY,
            "omega",
            ["omega = w*E/(p^2/(2m) + m w^2 q^2/2) = w"],
            ["omega = 2*w*E/(p^2/(2m) + m w^2 q^2/2) = w"],
        ),
        (
            KEPLER,
            "omega",
            ["sqrt(-8E^3/m)/k = m k^2/(J1+J2)^3", "m k^2/(J1+J2)^3"],
            ["2sqrt(-8E^3/m)/k = m k^2/(J1+J2)^3", "m k^2/(J1+J2)^3"],
        ),
    ],
)
def test_what_is_written_out_is_judged(base, key, right, wrong):
    assert verdict(base, key, right).holds
    assert verdict(base, key, wrong).fails


def test_sides_that_differ_are_no_wrong_chain_where_it_is_open_whether_each_is_right():
    x, y = sp.symbols("x y", real=True)
    seen = {}
    for status in Status:
        other = Verdict(status, "whether the left side is right", "exact")
        chain = Chain(
            Part("the chain", x, y), Domain(), "two sides are not equal", lambda other=other: iter([other])
        )
        seen[status] = decide(chain, Deadline.after(10.0))
    assert {status: found.status for status, found in seen.items()} == {each: each for each in Status}
    assert seen[Status.FAILS].feedback == "two sides are not equal"
    assert decide(Chain(Part("the chain", x, y), Domain(), "not equal"), Deadline.after(10.0)).fails


def test_of_several_frequencies_the_derivative_says_which():
    with pytest.raises(InvalidClaim, match="depend on J1 here"):
        verdict(KEPLER, "omega", ["∂E/∂J1 = m k^2/(J1+J2)^3", "m k^2/(J1+J2)^3"])


def test_in_brackets_one_variable_does_not_depend_on_another():
    base = {"kind": "poisson-bracket", "q": ["q"], "p": ["p"]}
    pair = {"f": "q", "g": "p"}
    for value, holds in (
        ("diff(q, q)*diff(p, p) - diff(q, p)*diff(p, q)", True),
        ("1 + diff(q, p) + diff(q, q)", False),
    ):
        assert verdict(base, "pairs", [{**pair, "value": value}]).holds is holds


def test_symbols_that_are_all_alike_do_not_depend_on_each_other():
    both = {
        "kind": "equality-only",
        "lhs": "diff(x*y, x) + diff(y, x)",
        "rhs": "y",
        "parameters": {"x": "real", "y": "real"},
    }
    assert examine(claim_from({**both, "id": "a"})).verdict.holds


FREE = {"kind": "solution", "q": ["x"], "L": "x'^2/2 - w^2 x^2/2", "constants": ["E"],
        "parameters": {"w": "positive", "E": "positive"}, "domain": ["2*E - w**2*x**2 > 0"]}  # fmt: skip


@pytest.mark.parametrize(
    "said", ["x' = sqrt(2E - w^2 x^2)", "dx/dt = sqrt(2E - w^2 x^2)", r"$\dot x = \sqrt{2E - w^2 x^2}$"]
)
def test_rates_are_called_by_their_own_names(said):
    assert (
        verdict(FREE, "rates", {"x": said}).status
        is verdict(FREE, "rates", {"x": "sqrt(2E - w^2 x^2)"}).status
    )
    assert verdict(FREE, "rates", {"x": said.replace("- w", "- 2w")}).fails
    with pytest.raises(InvalidClaim, match="x' is asked for here"):
        verdict(
            FREE,
            "rates",
            {"x": said.replace("x' =", "x =").replace("dx/dt =", "x'' =").replace(r"\dot x =", "v =")},
        )


@pytest.mark.parametrize(
    "said", [f"{J0} + w' q*p/(2*w(tau)^2)", r"$\frac{p^2+w^2q^2}{2w} + \frac{w' q p}{2w^2}$"]
)
def test_a_prime_of_what_changes_slowly_is_asked_about(said):
    base = SLOW | {"order": 1}
    with pytest.raises(InvalidClaim, match="is w' the derivative by tau, or by t"):
        verdict(base, "I", said)
    by_tau = said.replace("w' q", "eps w'(tau) q" if "$" not in said else r"\epsilon w'(\tau) q")
    assert verdict(base, "I", by_tau).holds


def test_coordinates_and_momenta_are_independent_in_hamiltons_equations():
    """{q, H} and {p, H} written out hold derivatives of q by p, which are 0 there."""
    base = {
        "kind": "hamilton-equations", "q": ["q"], "p": ["p"], "functions": {"H": ["q", "p"]}, "H": "H(q, p)",
        "q_dot": ["Derivative(q, q)*Derivative(H(q, p), p) - Derivative(q, p)*Derivative(H(q, p), q)"],
    }  # fmt: skip
    bracket = "Derivative(p, q)*Derivative(H(q, p), p) {} Derivative(p, p)*Derivative(H(q, p), q)"
    assert verdict(base, "p_dot", [bracket.format("-")]).holds
    assert verdict(base, "p_dot", [bracket.format("+")]).fails
