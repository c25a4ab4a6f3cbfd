"""Complete integrals by quadrature, W = ∫ √(2m(E − V)) dx: known by their derivative, which is what is integrated."""

import pytest

from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.left_sides import is_action
from canon.exercise.sheet.sheet import claim_from

OSCILLATOR = {
    "q": ["x"], "p": ["p"], "H": "p**2/(2*m) + m*w**2*x**2/2", "constants": ["E"],
    "parameters": {"m": "positive", "w": "positive"},
}  # fmt: skip
ORBIT = {
    "q": ["r", "phi"], "p": ["p_r", "p_phi"], "H": "p_r**2/(2*m) + p_phi**2/(2*m*r**2) - k/r", "constants": ["E", "l"],
    "parameters": {"m": "positive", "k": "positive", "r": "positive"},
}  # fmt: skip
ANY_POTENTIAL = {
    "q": ["x"], "p": ["p"], "H": "p**2/2 + V(x)", "functions": {"V": ["x"]}, "constants": ["E"]
}  # fmt: skip
PLANE = {
    "q": ["x", "y"],
    "p": ["p_x", "p_y"],
    "H": "(p_x**2 + p_y**2)/2 + x**2 + y**2",
    "constants": ["E", "a"],
}
ROOT = r"\sqrt{2mE - m^2\omega^2x^2}"


def judged(question, **answer):
    claim = claim_from({"id": "a", "kind": "hamilton-jacobi", **question, **answer})
    assert not claim.errors
    return [judgement for judgement, _ in judgements(claim)][-1]


@pytest.mark.parametrize(
    ("question", "key", "right", "wrong"),
    [
        (OSCILLATOR, "W", rf"\int {ROOT}\,dx", rf"2\int {ROOT}\,dx"),
        (OSCILLATOR, "S", rf"-Et + \int {ROOT}\,dx", rf"Et + \int {ROOT}\,dx"),
        (OSCILLATOR, "W", "∫ sqrt(2 m E - m^2 w^2 x^2) dx", "∫ sqrt(2 m E - m^2 w x^2) dx"),
        (
            OSCILLATOR,
            "W",
            "-Integral(sqrt(2*m*E - m**2*w**2*x**2), x)",
            "Integral(sqrt(2*m*E - m**2*w**2*x), x)",
        ),
        (OSCILLATOR, "W", rf"W = \int p\,dx = \int {ROOT}\,dx", rf"W = \int p\,dx = \int {ROOT}\,dx + x"),
        (
            ORBIT,
            "W",
            r"l\phi + \int\sqrt{2m(E + k/r) - l^2/r^2}\,dr",
            r"l\phi + \int\sqrt{2m(E - k/r) - l^2/r^2}\,dr",
        ),
        (
            ORBIT,
            "W",
            r"l\phi + \int\sqrt{2m(E + k/r) - l^2/r^2}\,dr",
            r"\phi + \int\sqrt{2m(E + k/r) - 1/r^2}\,dr",
        ),
        (
            OSCILLATOR,
            "W",
            r"\int_0^x \sqrt{2mE - m^2\omega^2s^2}\,ds",
            r"\int_0^x \sqrt{2mE - m\omega^2s^2}\,ds",
        ),
        (
            ANY_POTENTIAL,
            "W",
            "Integral(sqrt(2*(E - V(s))), (s, 1, x))",
            "Integral(sqrt(2*(E + V(s))), (s, 1, x))",
        ),
        (ANY_POTENTIAL, "W", r"\int\sqrt{2(E - V(x))}\,dx", r"\int\sqrt{2(E + V(x))}\,dx"),
        (
            PLANE,
            "W",
            r"\int\sqrt{2(E - a - x^2)}\,dx + \int\sqrt{2(a - y^2)}\,dy",
            r"\int\sqrt{2(E - a - x^2)}\,dx + \int\sqrt{2(E - y^2)}\,dy",
        ),
    ],
)
def test_a_complete_integral_may_be_a_quadrature(question, key, right, wrong):
    assert judged(question, **{key: right}).status == "holds"
    assert judged(question, **{key: wrong}).status == "fails"


@pytest.mark.parametrize(
    ("question", "W", "told"),
    [
        (OSCILLATOR, rf"x \int {ROOT}\,dx", "has to be a constant"),
        (OSCILLATOR, rf"\left(\int {ROOT}\,dx\right)^2", "has to be a constant"),
        (OSCILLATOR, rf"\int {ROOT}\,dt", "over a coordinate"),
        (OSCILLATOR, r"x \int_0^x \sqrt{E - s^2}\,ds", "has to be a constant"),
        (OSCILLATOR, r"\int_0^x \sqrt{E - 1/s^2}\,ds", "may have no value"),
        (OSCILLATOR, r"\int_0^E \sqrt{E - s^2}\,ds", "may have no value"),
        (OSCILLATOR, rf"\int {ROOT}", "a lower and an upper limit"),
        (PLANE, r"\int\sqrt{2(E - x^2 - y^2)}\,dx", "holds y too"),
        (OSCILLATOR, r"\int\int x\,dx\,dx", "holds an integral too"),
    ],
)
def test_quadratures_whose_derivatives_are_not_known_are_asked_about(question, W, told):
    found = judged(question, W=W)
    assert found.status == "invalid"
    assert told in found.reasons[0]


def test_a_gradient_has_no_quadratures():
    found = judged(OSCILLATOR, gradient=[r"\int x\,dx"])
    assert found.status == "invalid"
    assert "a lower and an upper limit" in found.reasons[0]


def test_what_is_wrong_in_a_quadrature_is_told():
    found = judged(OSCILLATOR, W=r"\int\sqrt{2mE - 2m^2\omega^2x^2}\,dx")
    assert "the term -2*m**2*w**2*x**2 should be half that" in found.reasons[0]


ACTION = {
    "q": ["x"], "p": ["p"], "H": "p**2/(2*m) + m*w**2*x**2/2",
    "parameters": {"m": "positive", "w": "positive", "E": "positive"},
}  # fmt: skip


def judged_action(J):
    claim = claim_from({"id": "a", "kind": "action-angle", **ACTION, "J": [J]})
    assert not claim.errors
    return [judgement for judgement, _ in judgements(claim)][-1]


@pytest.mark.parametrize(
    "definition",
    [r"J = \frac{1}{2\pi}\oint p\,dx", r"\frac1{2\pi} \int p\,\mathrm{d}x", "(1/2π)∮p dx", "1/(2π) ∮ p dx"],
)
def test_the_definition_of_an_action_before_its_value_is_passed_over(definition):
    right = judged_action(f"{definition} = E/w")
    assert right.status == "holds"
    assert "is passed over" in right.warnings[0]
    assert judged_action(f"{definition} = E/(2*w)").status == "fails"


@pytest.mark.parametrize("other", ["J = ∮ p dx = E/w", "J = (1/4π) ∮ p dx = E/w", "J = (1/2π) ∮ p dx"])
def test_another_definition_is_not(other):
    assert judged_action(other).status == "invalid"


PLAIN = "x*sqrt(2*m*E - m**2*w**2*x**2)/2 + E/w*asin(x*w*sqrt(m/(2*E)))"
NOTHING = "(sin(x)**2 + cos(x)**2 - 1)"


@pytest.mark.parametrize("where", ["log(x)", "sqrt(x)", "log(x)*log(2*x)", "log(E*x)"])
def test_an_answer_does_not_choose_where_it_is_asked(where):
    """Real logarithms times nothing leave W as it is, and a W that is wrong for x < 0 wrong."""
    assert judged(OSCILLATOR, W=PLAIN).status == "holds"
    assert judged(OSCILLATOR, W=f"{PLAIN} + {NOTHING}*{where} + Abs(x) - x").status == "fails"


def test_many_blanks_are_no_work(processor_seconds):
    before = processor_seconds()
    for hostile in (" " * 20_000 + "x", r"\, " * 5_000, "(1/2π)" + " *" * 9_000, "∫p" + " " * 20_000):
        assert not is_action(hostile, "W")
    assert processor_seconds() - before < 0.5
