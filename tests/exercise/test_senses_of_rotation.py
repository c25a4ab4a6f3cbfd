"""Actions of rotations, whose sense a domain may leave open; what is slow beside ignorable coordinates."""

from __future__ import annotations

from typing import Any

import pytest

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.reading import InvalidClaim
from canon.exercise.sheet.sheet import Claim

ROTOR = {"q": ["phi"], "p": ["p"], "H": "p^2/(2*I_0)"}
RING = {"q": ["phi"], "p": ["p"], "H": "(p - a)^2/(2*I_0)"}
PENDULUM = {"q": ["q"], "p": ["p"], "H": "p^2/2 - cos(q)", "domain": ["p**2/2 - cos(q) > 1"]}
OVER = "2/pi*sqrt(2*(1 + E))*elliptic_e(2/(1 + E))"
RATE = "pi*sqrt((1 + E)/2)/elliptic_k(2/(1 + E))"


def told(kind: str, keys: dict[str, Any], p: str = "real", **more: Any) -> str:
    names = {"I_0": "positive", "E": "real", "p": p} | ({"a": "real"} if "a" in keys["H"] else {})
    return judge(Claim("a", kind, {"parameters": names, **keys, **more})).status.value


@pytest.mark.parametrize("J", ["p", "Abs(p)", "sqrt(2*I_0*E)"])
@pytest.mark.parametrize("p", ["positive", "negative", "nonzero"])
def test_an_action_is_counted_along_the_motion_or_along_its_coordinate(J: str, p: str) -> None:
    assert told("action-angle", ROTOR, p, J=J) == "holds"
    for wrong in (f"2*pi*{J}", f"{J}/2", f"{J} + 1"):
        assert told("action-angle", ROTOR, p, J=wrong) == "fails", wrong


@pytest.mark.parametrize("p", ["positive", "nonzero"])
def test_an_action_has_the_sign_of_a_momentum_that_is_positive(p: str) -> None:
    for wrong in ("-p", "-Abs(p)", "-sqrt(2*I_0*E)"):
        assert told("action-angle", ROTOR, p, J=wrong) == "fails", wrong


def test_what_changes_its_sign_at_other_places_does_not_hold() -> None:
    """Its square is right everywhere."""
    assert told("action-angle", ROTOR, "negative", J="p*sign(p + 1)") == "fails"
    assert told("action-angle", ROTOR, "negative", J="p*sign(phi)") == "fails"


@pytest.mark.parametrize("domain", [["p > 0"], ["p < 0"], ["Ne(p, 0)"]])
def test_the_pendulum_that_turns_over(domain: list[str]) -> None:
    keys = {**PENDULUM, "domain": [*PENDULUM["domain"], *domain]}
    assert told("action-angle", keys, J=OVER) == "holds"
    assert told("frequency", keys, omega=RATE) == "holds"
    for wrong in (f"2*{OVER}", OVER.replace("_e(2/(1 + E))", "_e((1 + E)/2)"), OVER.replace("_e", "_k")):
        assert told("action-angle", keys, J=wrong) == "fails", wrong
    assert told("frequency", keys, omega=f"{RATE}/2") == "fails"
    backwards = "holds" if domain == ["p < 0"] else "fails"
    assert told("action-angle", keys, J=f"-{OVER}") == told("frequency", keys, omega=f"-{RATE}") == backwards


def test_the_frequency_of_a_rotor() -> None:
    assert told("frequency", ROTOR, "nonzero", omega="p/I_0") == "holds"
    assert told("frequency", ROTOR, "nonzero", omega="sqrt(2*E/I_0)") == "holds"
    assert told("frequency", ROTOR, "nonzero", omega="p/(2*I_0)") == "fails"
    assert told("frequency", ROTOR, "nonzero", omega="J/I_0", actions=["J"]) == "holds"
    assert told("frequency", ROTOR, "nonzero", omega="2*J/I_0", actions=["J"]) == "fails"


def test_a_ring_with_a_flux_through_it_has_its_momentum_for_its_action() -> None:
    """The sense is that of p − a, and the action p whatever it is."""
    assert told("action-angle", RING, domain=["p > a"], J="p") == "holds"
    assert told("action-angle", RING, domain=["p > a"], J="p - a") == "fails"


def test_what_moves_on_a_line_for_ever_has_no_action() -> None:
    line = {"q": ["x"], "p": ["p"], "H": "p^2/(2*I_0)"}
    verdict = judge(Claim("a", "action-angle", {"parameters": {"I_0": "positive"}, **line, "J": "p"}))
    assert verdict.undecided
    assert "call it one" in verdict.evidence[0].text


def test_a_map_to_an_angle_and_its_action_in_both_senses() -> None:
    keys = {**ROTOR, "new_q": ["w"], "new_p": ["J"], "domain": ["Ne(p, 0)"]}
    assert told("action-angle", keys, transformation={"w": "phi", "J": "p"}) == "holds"
    assert told("action-angle", keys, transformation={"w": "-phi", "J": "-p"}) == "holds"
    assert told("action-angle", keys, transformation={"w": "phi/2", "J": "2*p"}) == "fails"


LARMOR = {
    "q": ["x", "y"], "p": ["px", "py"], "H": "(px^2 + (py - B(tau)*x)^2)/2", "small": ["eps"], "slow": ["tau"],
    "functions": {"B": ["tau"]},
}  # fmt: skip


def of_larmor(I: str, **more: Any) -> str:
    names = {"eps": "positive", "B": "positive"}
    return judge(
        Claim("a", "adiabatic-invariant", {"parameters": names, **LARMOR, "I": I, **more})
    ).status.value


def test_the_moment_of_a_charge_that_turns_in_a_slow_field() -> None:
    energy = "(px^2 + (py - B(tau)*x)^2)"
    for right in (f"{energy}/(2*B(tau))", f"{energy}/B(tau) + py^2", f"py*{energy}^2/B(tau)^2"):
        assert of_larmor(right) == "holds", right
    for wrong in (
        f"{energy}/2", f"{energy}*B(tau)", f"{energy}/B(tau)^2", f"{energy}/B(tau) + y", f"{energy}/B(tau) + py*B(tau)",
    ):  # fmt: skip
        assert of_larmor(wrong) == "fails", wrong


def test_a_momentum_that_h_changes_slowly_is_no_constant_beside_the_action() -> None:
    H = "(px^2 + (py - B(tau)*x)^2)/2 + eps*y"
    assert of_larmor("(px^2 + (py - B(tau)*x)^2)/(2*B(tau))", H=H) == "undecided"


def test_a_rotating_frame_has_frequencies_whose_signs_are_not_known() -> None:
    keys = {
        "q": ["x", "y"], "p": ["a", "b"], "actions": ["I", "J"], "degree": 2, "parameters": {"w": "positive"},
        "H": "(a^2 + b^2)/2 + (x^2 + y^2)/2 - w*(x*b - y*a)", "domain": ["w < 1/2"],
    }  # fmt: skip
    for right in ("(1 + w)*I + (1 - w)*J", "(1 - w)*I + (1 + w)*J"):
        assert judge(Claim("a", "normal-form", {**keys, "K": right})).holds
    for wrong in ("I + J", "(1 + w)*(I + J)", "(1 + w)*I - (1 - w)*J", "(1 + w)*I + (w - 1)*J"):
        assert judge(Claim("a", "normal-form", {**keys, "K": wrong})).fails


ANGLE = {
    "q": ["q"], "p": ["p"], "H": "p**2/2 + w**2*q**2/2", "new_q": ["a"], "new_p": ["J"],
    "parameters": {"w": "positive"},
}  # fmt: skip
J = "(p**2 + w**2*q**2)/(2*w)"
TO_ANGLES = [
    "atan2(w*q, p)",
    "atan(w*q/p)",
    "2*atan(w*q/(p + sqrt(p^2 + w^2*q^2)))",
    "acos(p/sqrt(p^2 + w^2*q^2))*sign(q)",
]


def to_angle(table: dict[str, str], **more: Any) -> str:
    return judge(Claim("a", "action-angle", {**ANGLE, "transformation": table, **more})).status.value


@pytest.mark.parametrize("angle", TO_ANGLES)
def test_angles_may_step_by_turns(angle: str) -> None:
    assert to_angle({"a": angle, "J": J}) == "holds"


@pytest.mark.parametrize(
    "step",
    ["sign(q)", "sign(p)", "sign(p)*sign(q)", "2*sign(p - q)", "atan(q) + atan(1/q)", "Max(0, sign(q))"],
)
def test_what_jumps_in_mid_motion_is_no_action_and_no_angle(step: str) -> None:
    """Brackets do not show it."""
    assert to_angle({"a": "atan2(w*q, p)", "J": f"{J} + {step}"}) == "fails"
    assert to_angle({"a": f"atan2(w*q, p) + {step}", "J": J}) != "holds"


@pytest.mark.parametrize(
    ("q", "p"),
    [
        ("sqrt(2*J/w)*sin(a)*sign(cos(a))", "sqrt(2*w*J)*Abs(cos(a))"),
        ("sqrt(2*J/w)*sin(a)*sign(cos(a))", "sqrt(2*w*J*(1 - sin(a)^2))"),
        ("sqrt(2*J/w)*Abs(sin(a))", "sqrt(2*w*J)*cos(a)*sign(sin(a))"),
        ("sqrt(2*J/w)*sin(atan(tan(a)))", "sqrt(2*w*J)*cos(atan(tan(a)))"),
        ("sqrt(2*(J + sign(a))/w)*sin(a)", "sqrt(2*w*(J + sign(a)))*cos(a)"),
        ("sqrt(2*J/w)*sin(a + sign(cos(a)))", "sqrt(2*w*J)*cos(a + sign(cos(a)))"),
    ],
)
def test_a_map_that_is_folded_does_not_hold(q: str, p: str) -> None:
    assert to_angle({"q": q, "p": p}) != "holds"


def test_a_map_is_real() -> None:
    right = {"q": "sqrt(2*J/w)*sin(a)", "p": "sqrt(2*w*J)*cos(a)"}
    assert to_angle(right) == to_angle(right, parameters={"w": "positive", "J": "positive"}) == "holds"
    assert to_angle(right, parameters={"w": "positive", "J": "negative"}) == "fails"
    turned = {"q": "sqrt(-2*J/w)*sin(a)", "p": "-sqrt(-2*w*J)*cos(a)"}
    assert to_angle(turned, parameters={"w": "positive", "J": "positive"}) == "fails"


@pytest.mark.parametrize(
    ("domain", "right", "wrong"),
    [
        (
            ["p < a"],
            ["p", "-p", "a - sqrt(2*I_0*E)", "sqrt(2*I_0*E) - a"],
            ["a - p", "2*p", "sqrt(2*I_0*E) + a"],
        ),
        (["p > a"], ["p", "a + sqrt(2*I_0*E)"], ["-p", "p - a"]),
        ([], ["p", "a + sign(p - a)*sqrt(2*I_0*E)"], ["-p", "p - a", "Abs(p)", "a + sign(p)*sqrt(2*I_0*E)"]),
    ],
)
def test_along_the_motion_is_the_sense_of_the_velocity(
    domain: list[str], right: list[str], wrong: list[str]
) -> None:
    assert [told("action-angle", RING, domain=domain, J=J) for J in right] == ["holds"] * len(right)
    assert [told("action-angle", RING, domain=domain, J=J) for J in wrong] == ["fails"] * len(wrong)


def test_frequencies_on_a_ring() -> None:
    for omega, status in {
        "(p - a)/I_0": "holds",
        "sign(p - a)*sqrt(2*E/I_0)": "holds",
        "p/I_0": "fails",
    }.items():
        assert told("frequency", RING, omega=omega) == status
    assert told("frequency", RING, domain=["p < a"], omega="sqrt(2*E/I_0)") == "holds"
    assert told("frequency", RING, actions=["J"], omega="(J - a)/I_0") == "holds"
    assert told("frequency", RING, actions=["J"], omega="J/I_0") == "fails"


def test_a_rotating_oscillator_whose_angle_falls() -> None:
    keys = {
        "q": ["r", "phi"], "p": ["p_r", "l"], "H": "p_r**2/2 + l**2/(2*r**2) + w**2*r**2/2 - W*l",
        "parameters": {"w": "positive", "W": "positive", "r": "positive", "E": "real"}, "domain": ["l > 0", "W > w"],
    }  # fmt: skip
    radial = "(E + W*l)/(2*w) - l/2"
    for answer, status in ((["l"], "holds"), (["-l"], "holds"), (["2*l"], "fails")):
        assert told("action-angle", keys, J=[radial, *answer]) == status
    assert told("action-angle", keys, J=["(E + W*l)/(2*w) + l/2", "l"]) == "fails"
    assert (
        told("frequency", keys, omega=["2*w", "W - w"])
        == told("frequency", keys, omega=["2*w", "w - W"])
        == "holds"
    )


def test_momenta_that_are_shifted() -> None:
    moved = {"q": ["q"], "p": ["p"], "H": "(p - a)**2/2 - cos(q)"}
    over, around = "2/pi*sqrt(2*(1 + E))*elliptic_e(2/(1 + E))", ["(p - a)**2/2 - cos(q) > 1", "p > a"]
    assert told("action-angle", moved, domain=around, J=f"a + {over}") == "holds"
    assert told("action-angle", moved, domain=around, J=over) == "fails"
    slow = {
        "q": ["q"],
        "p": ["p"],
        "small": ["eps"],
        "slow": ["tau"],
        "functions": {"w": ["tau"], "c": ["tau"]},
    }
    H = "(p**2 + w(tau)**2*q**2)/2 + c(tau)*q*p"
    keys = {**slow, "H": H, "domain": ["c(tau) < w(tau)"]}
    names = {"eps": "positive", "w": "positive", "c": "positive"}
    for root, status in (("sqrt(w(tau)**2 - c(tau)**2)", "holds"), ("w(tau)", "fails")):
        assert told("adiabatic-invariant", keys, parameters=names, I=f"({H})/{root}") == status


def test_a_momentum_alone_is_a_constant_beside_what_is_slow() -> None:
    keys = {
        "q": ["phi"], "p": ["p"], "H": "p**2/2 - W(tau)*p", "small": ["eps"], "slow": ["tau"],
        "functions": {"W": ["tau"]}, "parameters": {"eps": "positive", "W": "positive"},
    }  # fmt: skip
    assert [told("adiabatic-invariant", keys, I=I) for I in ("p", "p**3 + p")] == ["holds"] * 2
    assert {told("adiabatic-invariant", keys, I=I) for I in ("p - W(tau)", "p + phi", "3")} == {"fails"}


def test_nothing_given_is_constant_under_an_integral() -> None:
    """The mean of H is not H: the chain failed, although both of its sides are right."""
    keys = {
        "q": ["theta"], "p": ["J"], "H": "w*J + eps*J^2*cos(theta)^4", "angles": ["theta"], "small": ["eps"],
        "parameters": {"w": "positive", "eps": "real"},
    }  # fmt: skip
    with pytest.raises(InvalidClaim, match="H is not declared"):
        told(
            "averaged-hamiltonian",
            keys,
            K=r"\frac{1}{2\pi}\int_0^{2\pi} H\,d\theta = w J + \frac{3}{8} eps J^2",
        )
    assert told("averaged-hamiltonian", keys, K="w*J + 3/8*eps*J^2") == "holds"
