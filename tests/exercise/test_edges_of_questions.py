"""Edges of what judges ask: solutions of implicit maps, orders, integer matrices, systems that bind the state."""

from types import MappingProxyType

import pytest
import sympy as sp

from canon import coordinates
from canon.exercise.claim_verdict import examine
from canon.exercise.judges.perturbed.tori import _integer_matrix
from canon.exercise.judges.small_quantities import _order_of
from canon.exercise.question import implicit_point
from canon.exercise.question.answer import equations_missing
from canon.exercise.question.deadline import Deadline
from canon.exercise.question.equation_systems import same_equations
from canon.exercise.question.implicit_point import solved_somewhere
from canon.exercise.sheet.quantities.measures import unit_behind
from canon.exercise.sheet.reading import InvalidClaim, Reading
from canon.exercise.sheet.sheet import Claim, claim_from
from canon.exercise.sheet_check import judged
from canon.expression.text.scope import Scope
from canon.proof.domain.domain import EVERYWHERE, Domain
from canon.proof.domain.verdict import Undecided

x, y, e = sp.symbols("x y e", real=True)


@pytest.mark.parametrize(("assumed", "root", "found"), [
    ({"real": True}, 0, True),
    ({"real": True, "nonzero": True}, 0, False),
    ({"real": True, "nonzero": True}, 1, True),
    ({"positive": True}, -1, False),
    ({"integer": True}, 1, False),  # no ball tells that a root is a whole number
])  # fmt: skip
def test_a_solution_is_what_is_assumed_of_the_new_variables(assumed, root, found):
    Q = sp.Symbol("Q", **assumed)
    assert solved_somewhere([sp.exp(Q) - sp.exp(root)], (x,), (Q,), EVERYWHERE) is found


def test_solutions_are_looked_for_in_as_many_steps_as_are_allowed(monkeypatch):
    Q = sp.Symbol("Q", real=True)
    equation = [(Q - x - 3) * (1 + Q**2)]
    assert solved_somewhere(equation, (x,), (Q,), EVERYWHERE)
    monkeypatch.setattr(implicit_point, "STEPS", -1)
    assert not solved_somewhere(equation, (x,), (Q,), EVERYWHERE)


def test_the_order_of_a_denominator_is_found_up_to_the_highest():
    assert _order_of(3 * e**8 + e**9, e, EVERYWHERE, Deadline.after(5.0)) == (8, 3)
    with pytest.raises(Undecided, match="the order of a denominator"):
        _order_of(e**9, e, EVERYWHERE, Deadline.after(5.0))


@pytest.mark.parametrize(("right", "momenta", "matrix"), [
    ([x + y, y], [x, y], [[1, 1], [0, 1]]),
    ([x + y, y], [y, x], [[1, 1], [1, 0]]),
    ([2 * x, y], [x, y], [[1, 0], [0, 1]]),  # not unimodular
    ([x, y], [x, x], [[1, 0], [0, 1]]),  # no momenta of two degrees of freedom
])  # fmt: skip
def test_actions_and_momenta_are_tied_by_unimodular_matrices_only(right, momenta, matrix):
    assert _integer_matrix(right, momenta, [x, y], EVERYWHERE) == sp.Matrix(matrix)
    nowhere = Domain((sp.Eq(x, sp.sqrt(2)),))
    assert _integer_matrix(right, momenta, [x, y], nowhere) == sp.eye(2)


def test_systems_that_bind_the_state_are_compared_with_their_rates_where_the_time_is_given():
    a, b = coordinates("a b")
    right, rates = (a.dot - b, b.dot + a), (a.ddot + a, b.ddot + b)
    asked = (right, right, (a.ddot, b.ddot), EVERYWHERE, Deadline.after(5.0))
    assert same_equations(*asked, time=sp.Symbol("t", real=True)).holds
    assert same_equations(rates, *asked[1:], time=sp.Symbol("t", real=True)).fails  # they say less
    with pytest.raises(Undecided, match="what follows from their rates was not looked into"):
        same_equations((*right, a.ddot + a), *asked[1:])


def test_what_equations_leave_open_is_told_of_affine_ones():
    assert equations_missing([x + y], [x - 1, y], [x, y], EVERYWHERE) == (
        "x, y stay open: 1 equation is missing",
    )
    with pytest.raises(Undecided, match="solve it for them"):
        equations_missing([x**2 + y], [x - 1, y], [x, y], EVERYWHERE)


@pytest.mark.parametrize(
    ("text", "declared", "unit"), [("3 m", "", "m"), ("3 m", "m", ""), ("3 kg m", "m", "")]
)
def test_a_letter_behind_a_number_is_a_unit_unless_it_is_declared(text, declared, unit):
    assert unit_behind(text, Scope({name: sp.Symbol(name, real=True) for name in declared}))[1] == unit


def test_tables_of_any_class_are_judged_as_tables():
    keys = {"q": ["x"], "L": "x_dot**2/2 - x**2/2", "constants": ["a", "b"]}
    said = [MappingProxyType({"x": f"a*cos(t) + b*{f}(t)"}) for f in ("sin", "exp")]
    claims = [Claim(str(i), "solution", {**keys, "solution": one}) for i, one in enumerate(said)]
    assert [judgement.status for judgement in judged(claims)] == ["holds", "fails"]


def test_assumptions_have_words_of_their_own():
    with pytest.raises(InvalidClaim, match="complex can't be assumed of x; write positive, negative"):
        Reading(
            Claim("a", "equality-only", {"lhs": "x", "rhs": "x", "parameters": {"x": "complex"}})
        ).scope.near("x")


@pytest.mark.parametrize(("constants", "W", "status"), [
    (["E", "a"], "sqrt(2*E - a**2)*x + a*y", "holds"),
    (["E"], "sqrt(2*E)*x", "fails"),
    (["E", "a", "b"], "sqrt(2*E - a**2)*x + a*y + b", "fails"),
])  # fmt: skip
def test_a_complete_integral_has_as_many_constants_as_coordinates(constants, W, status):
    keys = {
        "q": ["x", "y"],
        "p": ["px", "py"],
        "H": "(px**2 + py**2)/2",
        "domain": ["2*E > a**2"] if "a" in constants else [],
    }
    verdict = examine(
        claim_from({"id": "a", "kind": "hamilton-jacobi", **keys, "constants": constants, "W": W})
    ).verdict
    assert verdict.status.value == status
    told = f"a complete integral has 2 constants beside an additive one, not {len(constants)}"
    assert verdict.feedback == ("" if status == "holds" else told)


def test_a_rate_whose_place_is_not_said_has_no_start():
    keys = {"q": ["x", "y"], "L": "x_dot**2/2 + y_dot**2/2 - y", "constants": ["a", "E"]}
    rates = {"x": "a", "y": "sqrt(2*(E - y))"}
    claim = {"id": "a", "kind": "solution", **keys, "rates": rates}
    assert examine(claim_from({**claim, "initial": {"x": "0"}})).verdict.holds
    assert examine(
        claim_from({**claim, "rates": {**rates, "y": "sqrt(E - y)"}, "initial": {"x": "0"}})
    ).verdict.fails
