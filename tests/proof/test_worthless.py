"""Expressions without a value, with one almost nowhere, or right on a part only, are equal to nothing.

The grammar is that of tests/exercise/test_cheating_student.py. SymPy cancels what it can as soon as it is written, so
only forms stand here in which the hidden zero is still there when the library sees it.
"""

import random
from collections.abc import Sequence

import pytest
import sympy as sp

from canon import (
    CanonicalTransformation,
    Hamiltonian,
    coordinates,
    equal,
    is_constant_of_motion,
    parameters,
    vanishes,
)
from canon.expression.parse import Scope, parse_expression
from canon.expression.symbols.symbol import Momentum
from canon.expression.text.tokens import LanguageError
from tests.exercise.right_answers import Right
from tests.exercise.worthless_forms import (
    ALMOST_NOWHERE,
    HIDDEN_ZEROS,
    HONEST,
    JUMPS,
    NOWHERE,
    OFF_POINTS,
    PARTS,
    PLAIN_ZEROS,
    Form,
)

GONE = {
    "times over", "logarithm", "root below", "a small power below", "logarithm less itself",
    "not above zero and not below",
}  # fmt: skip
"""Forms that SymPy evaluates to honest expressions."""
q, p, kappa = coordinates("q"), Momentum("p", real=True), parameters("kappa")
SCOPE = Scope({"q": q, "p": p, "kappa": kappa})
H = Hamiltonian((p**2 + q**2) / 2, q, p)
ENERGY = "p**2 + q**2"
ANSWERS = ("sin(3*q)", "q**2*p + kappa", "exp(-q)*cos(p)", "sqrt(1 + q**2)", "7 + kappa", ENERGY)
ZEROS = tuple(zero for zero in HIDDEN_ZEROS if zero != "number")  # what SymPy makes of that one is its own
SPOILT = [form for form in (*NOWHERE, *ALMOST_NOWHERE, *PARTS) if form.name not in GONE]
BUDGET, PATIENCE = 3.0, 30.0


def written(form: Form, answer: str, zeros: Sequence[str] = ZEROS) -> list[sp.Expr]:
    """Return the answer so decorated; nothing where the language refuses what has no value.

    Nor where SymPy has made the bare answer of it, as of R·sign(1/Z)² with a number Z: only sheets know what was
    written.
    """
    right = Right("", {"answer": answer}, ("answer",), "", ("q", "q"), ("p", "p"))
    zero = random.Random(form.name + answer).choice(zeros)
    try:
        made = parse_expression(form.written(right, zero)[0], SCOPE)
    except LanguageError:
        return []
    return [made] if made != parse_expression(answer, SCOPE) else []


def beside(form: Form, answer: str) -> list[sp.Expr]:
    return written(Form(form.name, form.beside), answer, PLAIN_ZEROS)


@pytest.mark.parametrize("answer", ANSWERS)
def test_worthless_expressions_equal_nothing_and_their_neighbours_do(answer):
    right = parse_expression(answer, SCOPE)
    some = random.Random(answer).sample(SPOILT, 12)
    for form in some:
        for worthless in written(form, answer):
            assert not equal(worthless, right, budget=BUDGET).holds, worthless
            assert not equal(right, worthless, budget=BUDGET).holds, worthless
        for honest in beside(form, answer):
            assert equal(honest, right, budget=PATIENCE).holds, honest


@pytest.mark.slow
@pytest.mark.parametrize("form", SPOILT, ids=lambda form: form.name)
def test_no_worthless_expression_equals_anything(form):
    for answer in ANSWERS:
        right = parse_expression(answer, SCOPE)
        for worthless in written(form, answer):
            for said in (equal(worthless, right, budget=BUDGET), equal(right, worthless, budget=BUDGET)):
                assert not said.holds, worthless
        for honest in beside(form, answer):
            assert equal(honest, right, budget=PATIENCE).holds, honest


@pytest.mark.parametrize("zero", ZEROS)
def test_a_hidden_zero_vanishes_and_what_stands_over_it_does_not(zero):
    right = Right("", {"answer": "q"}, ("answer",), "", ("q", "q"), ("p", "p"))
    (nothing,) = (parse_expression(Form("", "Z").written(right, zero)[0], SCOPE),)
    assert vanishes(nothing, budget=PATIENCE).holds
    for over in (
        1 / nothing,
        q * p / nothing,
        (sp.exp(q) * sp.exp(p) - sp.exp(q + p)) / nothing,
        sp.log(nothing),
        1 / (1 + 1 / nothing),
    ):
        for said in (vanishes(over, budget=BUDGET), vanishes(sp.Matrix([nothing, over]), budget=BUDGET)):
            assert not said.holds, over
    assert vanishes(nothing / (1 + q**2), budget=PATIENCE).holds
    assert vanishes(sp.log(1 + nothing), budget=PATIENCE).holds


@pytest.mark.parametrize("place", ["Q", "P"])
def test_maps_without_values_are_not_canonical(place):
    right = {"Q": "q*cos(kappa) - p*sin(kappa)", "P": "q*sin(kappa) + p*cos(kappa)"}
    forms = [form for form in (*NOWHERE, *ALMOST_NOWHERE) if form.name not in GONE]

    def is_canonical(entry: sp.Expr, budget: float) -> bool:
        pair = {**{name: parse_expression(text, SCOPE) for name, text in right.items()}, place: entry}
        return CanonicalTransformation(q, p, pair["Q"], pair["P"]).is_canonical(budget=budget).holds

    for form in random.Random(place).sample(forms, 14):
        for worthless in written(form, right[place]):
            assert not is_canonical(worthless, BUDGET), worthless
        for honest in beside(form, right[place]):
            assert is_canonical(honest, PATIENCE), honest


@pytest.mark.parametrize(
    "forms", [NOWHERE, ALMOST_NOWHERE, JUMPS, PARTS], ids=["nowhere", "almost", "jumps", "parts"]
)
def test_no_constant_of_the_motion_without_values_or_with_jumps(forms):
    some = [form for form in forms if form.name not in GONE]
    for form in random.Random(len(forms)).sample(some, 9):
        for worthless in written(form, ENERGY):
            assert not is_constant_of_motion(worthless, H, budget=BUDGET).holds, worthless
        for honest in beside(form, ENERGY):
            assert is_constant_of_motion(honest, H, budget=PATIENCE).holds, honest


def test_for_the_library_a_number_is_constant():
    assert is_constant_of_motion(sp.Integer(7), H).holds
    assert is_constant_of_motion(kappa, H).holds
    assert is_constant_of_motion(q, H).fails


def test_the_right_answer_in_other_clothes_is_still_equal():
    for form in (
        form for form in HONEST if form.roles != OFF_POINTS
    ):  # the library asks about single points too
        for honest in written(form, ENERGY, PLAIN_ZEROS):
            assert equal(honest, p**2 + q**2, budget=PATIENCE).holds, honest
