"""What is shown of a judgement: its steps, its card on a page, what is too long, what is kept to be said again."""

from decimal import Decimal

import pytest
import sympy as sp

import canon
from canon.exercise.claim_verdict import examine
from canon.exercise.diagnose.change import Change, Mistake, rank
from canon.exercise.diagnose.kept_explanations import meaning
from canon.exercise.explained_judgement import judgements
from canon.exercise.report.derivation_steps import MOST_STEPS, steps
from canon.exercise.report.page import page
from canon.exercise.report.report import Report
from canon.exercise.sheet.sheet import claim_from
from canon.exercise.sheet_check import check
from canon.proof.domain.verdict import Undecided

PHASE = {"q": ["q"], "p": ["p"]}
x, y = sp.symbols("x y")


def claim(kind, **keys):
    found = claim_from({"id": "a", "kind": kind, **keys})
    assert not found.errors
    return found


def judged(kind, **keys):
    return [judgement for judgement, _ in judgements(claim(kind, **keys))][-1]


def product(n):
    return "*".join(f"(p + {k}*q)" for k in range(1, n + 1))


def test_steps_are_as_many_as_anyone_reads():
    names = [f"a{i}" for i in range(1, 9)]
    keys = {"x": names, "pairs": [{"u": "a1", "v": "a2", "value": "1"}]}
    found = steps(examine(claim("jacobi-identity", **keys, casimirs=names[2:])))
    assert len(found) == MOST_STEPS
    assert found[0] == ("{a1, {a2, a3}} + cyclic: what must vanish is", "0")
    few = steps(examine(claim("jacobi-identity", **keys, casimirs=["a3"])))
    assert few[-1] == ("so a3 is continuous: it holds, decided by: structure", "")


def test_slopes_and_values_that_are_too_long_are_left_out_of_the_steps():
    keys = {**PHASE, "q_dot": ["p"], "p_dot": ["q"]}
    shown = [formula for _, formula in steps(examine(claim("hamilton-equations", **keys, H=product(2))))]
    assert "Derivative(H, p) = 2*p + 3*q" in shown
    assert "Derivative(H, q) = 3*p + 4*q" in shown
    long = steps(examine(claim("hamilton-equations", **keys, H=product(11))))
    assert not any(formula.startswith("Derivative") for _, formula in long)
    waves, slope = (" + ".join(f.format(k) for k in range(1, 80)) for f in ("sin({0}*q)", "{0}*cos({0}*q)"))
    keys = {**PHASE, "new_q": ["Q"], "new_p": ["P"], "map": {"Q": [f"p - ({slope})"], "P": ["-q"]}}
    found = examine(claim("generating-F1", **keys, F=f"q*Q + {waves}"))
    assert found.verdict.holds
    assert [formula for said, formula in steps(found) if said == "with"] == ["P = -q"]


def test_a_slip_in_every_place_of_a_part_is_said_once():
    keys = {"lhs": "sin(x - y) + cos(x - y)", "parameters": {"x": "real", "y": "real"}}
    found = judged("equality-only", **keys, rhs="sin(x + y) + cos(x + y)")
    assert found.feedback == "in rhs in x + y the sign of y is wrong, everywhere"
    assert judged("equality-only", **keys, rhs="sin(x - y) + cos(x - y)").status == "holds"


@pytest.mark.parametrize("rhs", ["x**2 - y", "x**3*exp(sin(y))"])
def test_of_two_sides_the_right_one_is_the_answer(rhs):
    found = judged("equality-only", lhs="x**2 + y", rhs=rhs, parameters={"x": "real", "y": "real"})
    assert (found.status, found.corrected) == ("fails", "rhs = x**2 + y")


def test_a_card_tells_what_was_expected_where_it_is_otherwise_and_words_as_words():
    keys = {"variables": ["s"], "H": "1/(s - 1)", "is": ["passive"]}
    right, wrong = (claim("positive-real", **keys, expect=word) for word in ("fails", "holds"))
    said = [page(Report("", (judged_of(one),), (one,))) for one in (right, wrong)]
    assert ["expected: holds" in html for html in said] == [False, True]
    assert all("<span>passive</span>" in html for html in said)


def judged_of(one):
    return [judgement for judgement, _ in judgements(one)][-1]


def test_the_meaning_of_an_answer_is_that_of_its_formulas_by_name():
    keys = {"q": ["x"], "L": "x_dot**2/2 - x**2/2", "constants": ["a", "b"]}
    said = ["a*cos(t) + 2*b*sin(2*t)", "2*sin(2*t)*b + cos(t)*a", "a*cos(t) + b*sin(2*t)"]
    first, same, other = (meaning(examine(claim("solution", **keys, solution={"x": f}))) for f in said)
    assert first == same != other
    keys = {**PHASE, "Q": ["q"]}
    numbers = [meaning(examine(claim("canonicity", **keys, P=[P]))) for P in (3, 4, 3)]
    assert numbers[0] == numbers[2] != numbers[1]


def test_symbols_that_are_lacking_are_likelier_slips_than_fractions():
    lacks = [Change.of(Mistake.FACTOR_MISSING, x, factor) for factor in (y, "a number", x / y, 2 * y)]
    assert sorted(range(4), key=lambda i: rank(lacks[i])) == [0, 1, 3, 2]


@pytest.mark.parametrize("X", [sp.Matrix([y, 0]), sp.Tuple(y, 0), sp.Array([y, 0]), [y, 0], (y, 0)])
def test_an_answer_may_be_any_sort_of_list_of_sympy(X):
    keys = {"x": ["x", "y"], "X": X, "Y": [0, x]}
    canon.expect("lie-bracket", **keys, claim=sp.Matrix([-x, y]))
    with pytest.raises(AssertionError, match="opposite sign convention"):
        canon.expect("lie-bracket", **keys, claim=sp.Matrix([x, -y]))


def test_conditions_and_numbers_of_python_are_read_as_they_are_meant():
    keys = {"lhs": "abs(x)", "rhs": "x", "parameters": {"x": "real"}}
    canon.expect("equality-only", **keys, domain=[sp.And(x > 0, x < 3)])
    with pytest.raises(AssertionError, match="rhs has the wrong sign"):
        canon.expect("equality-only", **keys, domain=[sp.And(x < 0, x > -3)])
    canon.expect("number", value=Decimal("0.5"), claim=0.5)
    with pytest.raises(AssertionError, match="twice as large"):
        canon.expect("number", value=Decimal("0.5"), claim=0.25)


def test_what_was_not_decided_is_no_assertion():
    with pytest.raises(Undecided, match="neither proved nor refuted: H holds numbers that are not rational"):
        canon.expect(
            "positive-real", variables=["s"], H="(s**2 + sqrt(2))/(s**2 + s + 1)", **{"is": ["passive"]}
        )


@pytest.mark.parametrize("budget", [0, -1.0, 3601, float("nan")])
def test_a_budget_for_every_claim_is_a_number_of_seconds(budget):
    with pytest.raises(ValueError, match="budget should be a number of seconds up to 3600"):
        check([{"id": "a", "kind": "equality-only", "lhs": "1", "rhs": "1"}], budget=budget)
