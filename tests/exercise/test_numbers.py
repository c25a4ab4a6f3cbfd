"""Numbers as answers: read as typed, held against the right values exactly, ends of tolerances included."""

import time
from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from canon.exercise.explained_judgement import judgements
from canon.exercise.judges.number import sign_of
from canon.exercise.sheet.quantities.measures import measure_of
from canon.exercise.sheet.sheet import claim_from
from canon.proof import Undecided


def judged(**keys):
    claim = claim_from({"id": "a", "kind": "number", **keys})
    assert not claim.errors
    return [judgement for judgement, _ in judgements(claim)][-1]


TWO = {"value": ["1 + sqrt(2)", "1 - sqrt(2)"], "complete": True}
SPEED = {"value": "10", "unit": "m/s"}
HEAT = {"value": "4186", "unit": "J/(kg K)"}
HOLD = [
    ({"value": "10/17", "tolerance": "0.0005"}, "0.588", "0.587"),
    ({"value": "10/17", "tolerance": "0.0005"}, "≈ 0.588", "≈ 0.598"),
    ({"value": "10/17", "tolerance": "0.0005"}, "x = 10/17 ≈ 0.588", "x = 10/17 ≈ 0.578"),
    ({"value": "10/17", "tolerance": "0.0005"}, "x = 10/17 ≈ 0.588", "x = 9/17 ≈ 0.588"),
    ({"value": "10/17", "tolerance": "0.1 %"}, "5.88x10^-1", "5.88x10^-2"),
    ({"value": "10/17", "tolerance": "0.1 %"}, r"$5.88 \times 10^{-1}$", r"$5.88 \times 10^{1}$"),
    ({"value": "10/17", "tolerance": "0.1 %"}, "0.5882…", "0.5892…"),
    (TWO, "1 ± √2", "-1 ± √2"),
    (TWO, r"$x_{1,2} = 1 \pm \sqrt 2$", r"$x_{1,2} = 1 \pm \sqrt 3$"),
    (TWO, "x = 1 - √2 or x = 1 + √2", "x = 1 - √2 or x = 1 + √3"),
    (TWO, "{1 - √2, 1 + √2}", "{1 - √2, 1 - √2}"),
    (TWO, r"$x \in \{1 - \sqrt 2, 1 + \sqrt 2\}$", r"$x \in \{1 - \sqrt 2, 2 + \sqrt 2\}$"),
    (TWO, ["1 ∓ √2"], ["√2 ∓ 1"]),
    (SPEED, "36 km/h", "36 m/s"),
    (HEAT, "4186 J/(kg K)", "4186 J/(kg K^2)"),
    (HEAT, "4.186 kJ/(kg·K)", "4.186 kJ/(kg·m)"),
    (HEAT, "2 * 2093 J/(kg K)", "2 * 2093 J/(g K)"),
    (HEAT, "4186 m²/(s^2 K)", "4186 m/(s^2 K)"),
    (SPEED, "20 m/(2 s)", "20 m/(3 s)"),
    (SPEED, "5 s * 2 m/(s^2)", "5 s * 2 m/(s)"),
    (SPEED, "10", "36"),
    (SPEED, "10 [m/s]", "10 [m]"),
    (SPEED, r"$10\,\mathrm{m\,s^{-1}}$", r"$10\,\mathrm{m\,s^{-2}}$"),
    (SPEED, "10 m s⁻¹", "10 cm s⁻¹"),
    (SPEED, r"10\,\frac{\mathrm{m}}{\mathrm{s}}", r"10\,\frac{\mathrm{m}}{\mathrm{s}^2}"),
    (SPEED, r"$10\frac{m}{s}$", r"$10\frac{m}{h}$"),
    (SPEED, r"v = 36\,\mathrm{\frac{km}{h}}", r"v = 36\,\mathrm{\frac{m}{h}}"),
    (SPEED, "10~m/s", "10~m"),
    (SPEED, "36 kilometers per hour", "36 meters per hour"),
    (SPEED, "10 meters per second", "10 meters per minute"),
    ({"value": "pi/6", "unit": "rad"}, "30°", "31°"),
    ({"value": "2", "unit": "J"}, "2 N m", "2 N/m"),
    ({"value": "1 + 2*I"}, "1 + 2I", "1 - 2I"),
]


@pytest.mark.parametrize(("question", "answer", "twin"), HOLD)
def test_right_values_hold_and_their_twins_do_not(question, answer, twin):
    assert judged(**question, claim=answer).status == "holds"
    assert judged(**question, claim=twin).status == "fails"


@pytest.mark.parametrize(
    ("answer", "told"),
    [
        ("0,588", "the decimal 0.588, or two values"),
        ("0.588 ± 0.001", "two values, or one with its uncertainty"),
        ("1.2(3)", "two values, or one with its uncertainty"),
        ("1 ± 0.1", "is 1 ± 0.1 two values, or one with its uncertainty"),
        ("+-2", "±, or a minus"),
        ("± 1 ± 2", "chosen by itself here, or all of them together"),
        ("y = 2", "x is asked for here, and this says y = …"),
        ("a", "a is not declared"),
        ("t", "a number is asked for, and this holds t"),
    ],
)
def test_what_can_be_read_in_two_ways_is_refused(answer, told):
    found = judged(value="2", name="x", claim=answer)
    assert found.status == "invalid"
    assert told in found.known


@pytest.mark.parametrize(
    "answer",
    [
        "10.0 m/s ± 0.1 m/s",
        "10 m/s +/- 0.1 m/s",
        "v = 36 km/h ± 1 km/h",
        r"$10\,\mathrm{m/s} \pm 1\,\mathrm{m/s}$",
        "(10.0 ± 0.1) m/s",
    ],
)
def test_an_uncertainty_with_its_unit_is_asked_about(answer):
    found = judged(**SPEED, claim=answer)
    assert found.status == "invalid"
    assert "two values, or one with its uncertainty" in found.known


RATIONAL = st.fractions(min_value=-100, max_value=100, max_denominator=50)


@given(right=RATIONAL, reach=st.fractions(0, 10, max_denominator=50), beyond=st.integers(1, 60))
def test_both_ends_of_a_tolerance_are_right_and_nothing_beyond_is(right, reach, beyond):
    keys = {"value": str(right), "tolerance": str(reach)}
    for side in (-1, 1):
        end = right + side * reach
        assert judged(**keys, claim=str(end)).status == "holds"
        assert judged(**keys, claim=str(end + side * Fraction(1, 10**beyond))).status == "fails"


@given(a=st.integers(1, 60), b=st.integers(1, 60), far=st.integers(1, 300))
def test_the_end_of_a_tolerance_is_told_from_its_neighbours_where_nothing_is_rational(a, b, far):
    root = sp.sqrt(a + b + 2 * sp.sqrt(a * b)) - sp.sqrt(a) - sp.sqrt(b)  # zero, in a form that hides it
    tiny = sp.Rational(1, 10**far)
    assert (sign_of(root, 10.0), sign_of(root + tiny, 10.0), sign_of(root - tiny, 10.0)) == (0, 1, -1)


def test_what_no_ball_tells_from_zero_is_left_open():
    with pytest.raises(Undecided, match="too near to its end"):
        sign_of(sp.exp(sp.pi * 7) - sp.exp(sp.pi * 7 + sp.Rational(1, 10**2000)), 2.0)


@pytest.mark.parametrize(
    ("unit", "same"),
    [("km/h", "1/3.6 m/s"), ("N m", "J"), ("kg m^2/s^2", "J"), (r"\mathrm{kW\,h}", "3600 kJ"), ("rpm", "rev/min"),
     ("µm", "1e-6 m"), ("hPa", "100 Pa"), ("L", "dm^3"), ("d", "24 h"), ("h", "60 min"), ("min", "60 s"),
     ("t", "1000 kg"), ("C", "A s"),
     ("V", "W/A"), ("T", "V s/m^2"), ("Wb", "V s"), ("H", "V s/A"), ("F", "C/V"), ("Ω", "V/A"),
     ("eV", "1.602176634e-19 J"),
     ("au", "149597870700 m")],
)  # fmt: skip
def test_units_have_the_factors_of_the_si_brochure(unit, same):
    number, _, other = same.rpartition(" ") if same[0].isdigit() else ("1", "", same)
    left, right = measure_of(unit), measure_of(other)
    factor = sp.prod(
        [sp.Rational(n) if i == 0 else 1 / sp.Rational(n) for i, n in enumerate(number.split("/"))]
    )
    assert left.powers == right.powers
    assert sp.simplify(left.factor - factor * right.factor) == 0


def test_a_letter_below_a_stroke_is_a_parameter_where_it_is_declared_as_one():
    keys = {
        "value": "F/m",
        "unit": "N",
        "given": {"F": "6", "m": "2"},
        "parameters": {"F": "real", "m": "positive"},
    }
    assert judged(**keys, claim="6 N/(m)").status == "holds"
    assert judged(**keys, claim="7 N/(m)").status == "fails"
    assert judged(value="6", unit="N/m", claim="6 N/(m)").status == "holds"


@pytest.mark.parametrize(
    ("claim", "column", "wrong"), [("2 m foo * 3 s", 5, "foo"), ("2 m * 3 s * bar", 13, "bar")]
)
def test_what_is_wrong_in_a_calculation_with_units_is_told_in_its_own_words(claim, column, wrong):
    found = judged(value="6", unit="m s", claim=claim)
    assert found.status == "invalid"
    assert f"column {column}: {wrong} is not declared; no names are declared here\n{claim}" in found.known


def test_values_are_held_against_conditions_that_they_decide():
    keys = {"value": "m", "claim": "2", "given": {"m": "2"}, "parameters": {"m": "real", "x": "real"}}
    assert judged(**keys, domain=["m*x > -1"]).status == "holds"  # x has no value
    assert judged(**keys, domain=["m > 1"]).status == "holds"
    told = judged(**keys, domain=["m > 1", "m > 2"])
    assert told.status == "invalid"
    assert told.known == "key given: condition 2 of the domain, m > 2, is false for these values"


@pytest.mark.parametrize(
    ("condition", "status"), [(">=", "holds"), ("<=", "holds"), (">", "invalid"), ("<", "invalid")]
)
def test_a_value_at_the_end_of_its_domain_is_told_apart_from_one_outside(condition, status):
    keys = {
        "value": "m",
        "claim": "√2 + √3",
        "given": {"m": "sqrt(2) + sqrt(3)"},
        "parameters": {"m": "positive"},
    }
    assert judged(**keys, domain=[f"m {condition} sqrt(5 + 2*sqrt(6))"]).status == status


@pytest.mark.parametrize(
    "unit", ["furlong", "J/kg K", "J/(kg K", "J/kg)", "(m/s)^2", "m^", "", "mm2mm", "x" * 200, "kkg"]
)
def test_what_is_no_unit_is_none(unit):
    assert measure_of(unit) is None


def test_values_of_parameters_may_be_two():
    keys = {"id": "a", "kind": "parameters", "of": "canonicity", "q": ["q"], "p": ["p"], "Q": ["a*q"], "P": ["a*p"],
            "parameters": {"a": "nonzero"}, "find": ["a"]}  # fmt: skip
    both = [judgement for judgement, _ in judgements(claim_from({**keys, "values": [{"a": "±1"}]}))][-1]
    one = [judgement for judgement, _ in judgements(claim_from({**keys, "values": [{"a": "±2"}]}))][-1]
    assert (both.status, one.status) == ("holds", "fails")


@pytest.mark.parametrize(
    "answer",
    ["±" * 9000, "1 or " * 9000 + "1", "{" * 9000, "1" + " km" * 5000, "1" + " m/" * 900, "0,5 " * 5000,
     "1 ± " * 3000 + "1", "x = " * 9000 + "1", "9" * 5000, "9**9**9**9", "± 9**999999", "1e999999999", "(" * 5000 + "1",
     "exp(exp(exp(exp(9))))", "$" + r"\pm 1," * 4000 + "$", "1; " * 5000, "~" * 9000, "2 " + r"\mathrm{m}" * 3000],
    ids=range(18),
)  # fmt: skip
def test_hostile_answers_are_refused_at_once(answer):
    start = time.process_time()
    assert judged(value="2", unit="m", claim=answer, tolerance="1 %").status != "holds"
    assert time.process_time() - start < 4


@pytest.mark.parametrize(
    ("claim", "told"), [("1.41421", True), ("1.4", False), ("1.42", False), ("-1.41421", False)]
)
def test_a_rounded_value_is_told_where_the_exact_one_is_asked_for(claim, told):
    found = judged(value="sqrt(2)", claim=claim)
    assert found.status == "fails"
    assert ("is the right value rounded" in found.reasons[0]) == told
