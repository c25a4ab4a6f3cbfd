"""Claims of Hamilton–Jacobi theory and perturbation theory: what is told, and generators that would remove the mean."""

from dataclasses import replace
from itertools import islice

import pytest
from sympy import symbols

from canon.exercise.claim_verdict import examine
from canon.exercise.judges.perturbed import domain_tori
from canon.exercise.question.deadline import Deadline, Worked
from canon.exercise.sheet.reading import InvalidClaim
from canon.exercise.sheet.sheet import Claim, read_sheet
from canon.exercise.sheet_check import judged
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.proof.domain.domain import EVERYWHERE
from canon.proof.domain.verdict import Undecided
from tests.exercise.test_diagnosis import ROOT

CLAIMS = {
    c.id: c
    for kind in ("action-angle", "frequency", "generating-first-order", "adiabatic-invariant", "normal-form")
    for c in read_sheet(ROOT / f"tests/data/claims/{kind}.json").claims
}
QUARTIC = {
    "q": ["q"], "p": ["p"], "H": "(p**2 + q**2)/2 + eps*q**4", "parameters": {"eps": "real"}, "small": ["eps"],
}  # fmt: skip
RIGHT = "-5*p*q**3/8 - 3*p**3*q/8"
ANGLES = (
    "atan(q/p)",
    "atan2(q, p)",
    "acos(p/sqrt(p**2 + q**2))*sign(q)",
    "asin(q/sqrt(p**2 + q**2))*sign(p)",
    "2*atan(q/(p + sqrt(p**2 + q**2)))",
)


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("AA-01a", "this is ∮ p dq; the action of q is that divided by 2π"),
        ("FR-01a", "this counts turns; the frequency of q is 2π times that"),
        ("FR-06a", "in the frequency of x v should be w; in the frequency of y w should be v"),
        ("G1-01c", "in W the term I**2*theta/(2*w) does not belong"),
        ("AD-01a", "in I w(tau)**(-2) should be 1/w(tau)"),
        ("AD-06a", "I has not the period 2π in u: it changes with every turn"),
        ("NF-01a", "in K to degree 6 in q and p the term -J**2/8 should be half that"),
    ],
)
def test_what_is_told(name, told):
    patiently = replace(CLAIMS[name], budget=60.0)  # what is told does not depend on how busy the machine is
    (judgement,) = judged([patiently])
    assert (judgement.status, judgement.feedback) == ("fails", told)


@pytest.mark.parametrize("angle", ANGLES)
def test_a_generator_with_an_angle_in_it_removes_the_mean_and_does_not_hold(angle):
    claim = Claim("a", "generating-first-order", {**QUARTIC, "W": f"{RIGHT} + 3*(p**2 + q**2)**2*{angle}/8"})
    assert not examine(claim).verdict.holds


@pytest.mark.parametrize(
    "angle", ["acos(p/sqrt(p**2 + q**2))", "asin(q/sqrt(p**2 + q**2))", "atan(Abs(q/p))"]
)
def test_a_generator_with_an_angle_that_goes_to_and_fro_removes_the_mean_on_one_way_and_does_not_hold(angle):
    claim = Claim("a", "generating-first-order", {**QUARTIC, "W": f"{RIGHT} + 3*(p**2 + q**2)**2*{angle}/8"})
    assert not examine(claim).verdict.holds


@pytest.mark.parametrize("zigzag", ["asin(sin(u))", "v*acos(cos(u))", "Abs(sin(u))"])
def test_a_generator_whose_new_hamiltonian_jumps_does_not_hold(zigzag):
    rotor = {
        "q": ["u"],
        "p": ["v"],
        "H": "v**2/2 + eps*cos(u)",
        "parameters": {"eps": "real"},
        "small": ["eps"],
    }
    right = Claim("a", "generating-first-order", {**rotor, "W": "sin(u)/v"})
    assert examine(right).verdict.holds
    assert not examine(Claim("a", right.kind, {**rotor, "W": f"sin(u)/v + {zigzag}"})).verdict.holds


@pytest.mark.parametrize(("told", "holds"), [({}, True), ({"energy": "E"}, True), ({"energy": "7*E"}, False)])
def test_an_energy_that_is_told_beside_s_is_judged_too(told, holds):
    keys = {
        "q": ["q"],
        "p": ["p"],
        "H": "p**2/2",
        "constants": ["E"],
        "parameters": {"E": "positive"},
        **told,
    }
    verdict = examine(Claim("a", "hamilton-jacobi", {**keys, "S": "sqrt(2*E)*q - E*t"})).verdict
    assert verdict.holds is holds
    assert verdict.fails is not holds


PUSHED = {"q": ["q"], "p": ["p"], "H": "p**2/2 - q*t", "constants": ["a"]}
"""A mass under a force that grows with the time: p = a + t²/2, and −∂S/∂t = p²/2 − q t."""


def test_a_hamiltonian_that_holds_the_time_has_a_complete_integral_but_no_energy() -> None:
    S = "q*(a + t**2/2) - a**2*t/2 - a*t**3/6 - t**5/40"
    assert examine(Claim("a", "hamilton-jacobi", {**PUSHED, "S": S})).verdict.holds
    twin = S.replace("- a*t**3", "+ a*t**3")
    assert examine(Claim("a", "hamilton-jacobi", {**PUSHED, "S": twin})).verdict.fails
    with pytest.raises(InvalidClaim, match="key W: H depends on t, so no energy is kept; claim S"):
        examine(Claim("a", "hamilton-jacobi", {**PUSHED, "W": "q*sqrt(2*a)"}))


def test_turns_in_place_of_radians_are_told() -> None:
    keys = {"q": ["q"], "p": ["p"], "H": "p**2/2 + w**2*q**2/2", "parameters": {"w": "positive"}}
    turns, other = (
        examine(Claim("a", "frequency", {**keys, "omega": [omega]})).verdict
        for omega in ("w/(2*pi)", "w/(3*pi)")
    )
    assert turns.fails
    assert turns.feedback == "this counts turns; the frequency of q is 2π times that"
    assert other.fails
    assert other.feedback == ""


@pytest.mark.parametrize(
    ("q", "p", "H"),
    [
        (["x", "y"], ["a", "b"], "a**2/2 + x*y"),
        (["x", "y", "z"], ["a", "b", "c"], "a**2/2 + b**2/2 + x*z"),
        (["x"], ["a"], "x**2"),
    ],
)
def test_a_coordinate_whose_momentum_is_not_in_h_does_not_separate(q, p, H):
    keys = {"q": q, "p": p, "H": H}
    assert examine(Claim("a", "separable", {**keys, "is": ["separable"]})).verdict.fails
    assert examine(Claim("a", "separable", {**keys, "is": ["not separable"]})).verdict.holds


@pytest.mark.parametrize("free", ["(p**2 + q**2)**3", "7", "sin(p**2 + q**2)"])
def test_what_commutes_with_the_unperturbed_hamiltonian_is_free(free):
    claim = Claim("a", "generating-first-order", {**QUARTIC, "W": f"{RIGHT} + {free}"})
    assert examine(claim).verdict.holds


@pytest.mark.parametrize(
    ("theta", "J", "holds"),
    [
        ("atan2(2*q, p)", "p**2/4 + q**2", True),
        ("-atan2(2*q, p)", "-p**2/4 - q**2", True),
        ("atan2(2*q, p) + p**2/4 + q**2", "p**2/4 + q**2", True),
        ("atan2(2*q, p)", "p**2/4 + q**2 + 5", True),
        ("3*atan2(2*q, p)", "p**2/12 + q**2/3", False),
        ("atan2(2*q, p)/2", "p**2/2 + 2*q**2", False),
        ("atan2(2*q, p) + q", "p**2/4 + q**2", False),
    ],
)
def test_angles_are_free_up_to_their_origin_and_sense_but_grow_by_a_turn(theta, J, holds):
    keys = {"q": ["q"], "p": ["p"], "H": "p**2/2 + 2*q**2", "new_q": ["u"], "new_p": ["J"]}
    claim = Claim("a", "action-angle", {**keys, "transformation": {"u": theta, "J": J}})
    assert examine(claim).verdict.holds == holds


@pytest.mark.parametrize(
    ("H", "J", "box"),
    [
        ("p**2/2 - cos(q)", "8/pi*(elliptic_e((1+E)/2) - (1-E)/2*elliptic_k((1+E)/2))",
         {"p": [-1, 1], "q": [-0.5, 0.5]}),
        ("p**2/2 - k/q + 1/(2*q**2)", "k/sqrt(-2*E) - 1", {"k": [0.5, 3], "q": [0.5, 3], "p": [-0.5, 0.5]}),
    ],
)  # fmt: skip
def test_a_box_is_a_hint_and_an_action_that_is_right_in_it_only_does_not_hold(H, J, box):
    keys = {"q": ["q"], "p": ["p"], "H": H, "J": [J], "parameters": {"k": "real", "E": "real"}}
    assert not examine(Claim("a", "action-angle", {**keys, "box": box})).verdict.holds


def test_bound_motions_of_either_attraction_have_the_action_of_its_amount():
    H, parameters = "p**2/2 - k/q + 1/(2*q**2)", {"k": "nonzero", "E": "real"}
    keys = {"q": ["q"], "p": ["p"], "H": H, "parameters": parameters, "J": ["Abs(k)/sqrt(-2*E) - 1"]}
    claim = Claim("a", "action-angle", {**keys, "domain": ["p**2/2 - k/q + 1/(2*q**2) < 0"]})
    assert examine(claim).verdict.holds


def test_an_action_without_a_closed_form_is_refuted_by_quadrature():
    """By residues at tan q = ±i; the closed form of tan² alone is known, and decides."""
    keys = {"q": ["q"], "p": ["p"], "H": "p**2/2 + tan(q)**2 + tan(q)", "domain": ["-pi/2 < q", "q < pi/2"]}
    keys["parameters"] = {"E": "positive"}
    root = "sqrt(E + 1 + sqrt((E + 1)**2 + 1))"
    verdict = examine(Claim("a", "action-angle", {**keys, "J": [f"{root} - 1"]})).verdict
    assert verdict.fails
    assert verdict.certificate == "ball"
    right = f"{root} - sqrt(2)"
    assert examine(Claim("a", "action-angle", {**keys, "J": [right]})).verdict.undecided
    keys["H"] = "p**2/2 + tan(q)**2"
    assert examine(Claim("a", "action-angle", {**keys, "J": ["sqrt(2*E + 2) - sqrt(2)"]})).verdict.holds


@pytest.mark.slow
def test_the_action_of_morses_potential_is_known_up_to_its_rim():
    """Where the well is wide, balls held the integral of another root, and the formula was refused."""
    H = "p**2/2 + D*(exp(-2*q) - 2*exp(-q))"
    keys = {"q": ["q"], "p": ["p"], "H": H, "parameters": {"E": "negative", "D": "positive"}}
    for J, holds in (("sqrt(2*D) - sqrt(-2*E)", True), ("sqrt(D) - sqrt(-2*E)", False)):
        verdict = examine(Claim("a", "action-angle", {**keys, "domain": [f"{H} < 0"], "J": [J]})).verdict
        assert (verdict.holds, verdict.fails) == (holds, not holds)


def test_a_slow_coordinate_that_is_not_named_as_an_angle_may_stand_in_a_generator():
    keys = {"q": ["u", "x"], "p": ["I", "y"], "small": ["e"], "parameters": {"w": "positive", "e": "real"}}
    keys |= {"H": "w*I + e*y*I*cos(u)**2", "W": "y*I*sin(2*u)/(4*w) + x*y"}
    for other, holds in (({"angles": ["u"]}, True), ({}, False), ({"angles": ["u", "x"]}, False)):
        assert examine(Claim("a", "generating-first-order", {**keys, **other})).verdict.holds == holds
    moving = {**keys, "H": "w*I + v*y + e*y*I*cos(u)**2", "W": "y*I*sin(2*u)/(4*w) + x*y*I/(2*v)"}
    moving["parameters"] = {**keys["parameters"], "v": "positive"}
    assert examine(Claim("a", "generating-first-order", {**moving, "angles": ["u"]})).verdict.fails


def test_a_saddle_has_no_normal_form_in_the_actions_of_oscillators():
    keys = {"q": ["q"], "p": ["p"], "H": "p**2/2 - q**2/2 + q**4", "actions": ["J"], "degree": 4}
    for K in ("J + 3*J**2/2", "-J + 3*J**2/2", "J"):
        assert examine(Claim("a", "normal-form", {**keys, "K": K})).verdict.undecided


def test_the_action_of_a_quartic_wall_is_known_in_gamma_functions_and_elliptic_integrals():
    keys = {"q": ["q"], "p": ["p"], "H": "p**2/2 + q**4", "parameters": {"E": "positive"}}
    area = "4*elliptic_k(1/2)*E**(3/4)/(3*pi)"
    assert examine(Claim("a", "action-angle", {**keys, "J": [area]})).verdict.holds
    assert examine(Claim("a", "action-angle", {**keys, "J": [area.replace("4*", "2*")]})).verdict.fails


@pytest.mark.slow
@pytest.mark.parametrize("wrong", ["4*elliptic_k(1/4)*E**(3/4)/(3*pi)", "E**(3/4)"])
def test_other_actions_of_a_quartic_wall_fail(wrong):
    keys = {"q": ["q"], "p": ["p"], "H": "p**2/2 + q**4", "parameters": {"E": "positive"}}
    assert examine(Claim("a", "action-angle", {**keys, "J": [wrong]})).verdict.fails


OSCILLATOR = {"q": ["q"], "p": ["p"], "H": "p**2/(2*m) + m*omega**2*q**2/2"}
OF_IT = {"m": "positive", "omega": "positive", "E": "positive"}
SINE = {"exact": ["sin(x)"], "small": ["x"], "parameters": {"x": "real"}, "order": 3}


@pytest.mark.parametrize(
    ("kind", "keys", "right", "wrong"),
    [
        ("action-angle", {**OSCILLATOR, "parameters": OF_IT}, {"J": "$J = \\frac{E}{\\omega}$"},
         {"J": "$J = \\frac{\\omega}{E}$"}),
        ("action-angle", {**OSCILLATOR, "parameters": OF_IT}, {"J": "I = E/ω"}, {"J": "K = E/ω"}),
        ("frequency", {"q": "q", "p": "p", "H": "p**2/2 + k*q**2/2", "parameters": {"k": "positive"}},
         {"omega": "\\omega = \\sqrt{k}"}, {"omega": "\\omega = k"}),
        ("generating-first-order", {"q": "theta", "p": "I", "H": "w*I + eps*I**2*cos(theta)**2", "small": "eps",
                                    "parameters": {"w": "positive", "eps": "real"}},
         {"W": "W_1 = I^2 sin(2θ)/(4w)"}, {"W": "W_1 = I^2 sin(2θ)/4w^2"}),
        ("first-order", SINE, {"claim": "x - x³/6 + O(x^5)"}, {"claim": "x + O(x^5)"}),
        ("first-order", SINE, {"claim": "$x - \\frac{x^3}{6} + \\mathcal{O}\\left(x^5\\right)$"}, {"claim": "O(x)"}),
        ("first-order", SINE, {"claim": ["x - x^3/6 + \\dots"]}, {"claim": ["x - x^3/3 + \\dots"]}),
        ("normal-form", {"q": "q", "p": "p", "H": "p**2/2 - cos(q)", "actions": "J", "degree": 4},
         {"K": "K(J) = J - J²/16 + O(J^3)"}, {"K": "K(J) = J + O(J^2)"}),
        ("hamilton-jacobi", {"q": "q", "p": "p", "H": "p**2/(2*m) + m*g*q", "constants": "E",
                             "parameters": {"m": "positive", "g": "positive"}},
         {"gradient": "\\partial W/\\partial q = \\sqrt{2m(E - mgq)}"}, {"gradient": "p = \\sqrt{m(E - mgq)}"}),
    ],
)  # fmt: skip
def test_answers_as_people_type_them(kind, keys, right, wrong):
    told, other = judged([Claim("a", kind, {**keys, **right}), Claim("b", kind, {**keys, **wrong})])
    assert (told.status, other.status in ("fails", "invalid")) == ("holds", True)


def test_a_remainder_is_passed_over_and_told():
    (told,) = judged([Claim("a", "first-order", {**SINE, "claim": "x - x³/6 + O(x^5)"})])
    assert told.warnings == ("the remainder O(x^5) in claim is passed over",)


def test_actions_that_the_time_is_too_short_for_are_no_ground_for_a_verdict(monkeypatch):
    """A formula that is another one elsewhere may pass on fewer tori, so that none pass on those found until then."""
    q, p = symbols("q p", real=True)
    integral = hamilton_jacobi(Hamiltonian(p**2 / 2 + q**2, q, p))
    assert len(list(islice(domain_tori._bounded(integral, EVERYWHERE, Deadline.after(1e9)), 2))) == 2
    worked = iter([Worked(0.0, 0.0), Worked(0.5, 2.0), Worked(2.0, 3.0)])
    monkeypatch.setattr(Worked, "now", classmethod(lambda _: next(worked)))
    found = domain_tori._bounded(integral, EVERYWHERE, Deadline.after(1.0))
    next(found)  # a second of work has not passed, although the clock went on
    with pytest.raises(Undecided, match="were not found in the budget"):
        next(found)


def test_the_coordinate_whose_action_has_no_closed_form_is_named():
    x, y, p_x, p_y, E = symbols("x y p_x p_y E", real=True)
    H = Hamiltonian((p_x**2 + p_y**2 + x**2 + y**2) / 2 + y**3, [x, y], [p_x, p_y])
    tori = domain_tori.Tori(hamilton_jacobi(H), (), (E, None), {})
    with pytest.raises(Undecided, match="the action of y has no closed form"):
        tori.known()
