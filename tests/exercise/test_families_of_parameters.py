"""Families of parameters for which expressions vanish: all of them, and what is told where they were not found."""

import pytest
import sympy as sp

from canon.exercise.question import parameter_system
from canon.exercise.question.deadline import Deadline
from canon.exercise.question.parameter_system import families
from canon.proof.domain.domain import EVERYWHERE, Domain
from canon.proof.domain.verdict import Undecided


def values_of(residual, *wanted, domain=EVERYWHERE):
    return families([residual], wanted, [], domain, Deadline.after(5.0))


x, a, b = sp.symbols("x a b", real=True)
V = sp.Function("V")
ONE = sp.sin(x) ** 2 + sp.cos(x) ** 2


def test_an_arbitrary_function_at_two_places_is_not_taken_for_one_value():
    assert values_of(V(x) - V(a * x), a) == [{a: 1}]
    assert values_of(V(x) - a * V(x + 1), a) == []
    assert values_of(V(x + a * ONE) - V(x + a), a) == [{}]  # one place, whatever a is


@pytest.mark.parametrize(("residual", "told"), [
    (V(x + ONE) - a * V(x + 1), "are taken at one place was not decided"),
    (V(x + b * ONE) - a * V(x + b), "at one place that is written in two ways"),
])  # fmt: skip
def test_one_place_that_is_written_in_two_ways_is_told(residual, told):
    with pytest.raises(Undecided, match=told):
        values_of(residual, a, b)


def test_whole_parameters_have_whole_values_only():
    n = sp.Symbol("n", integer=True)
    assert values_of(x * (2 * n - 4), n) == [{n: 2}]
    assert values_of(x * (2 * n - 1), n) == []


def test_a_logarithm_of_a_parameter_is_solved_for_where_the_parameter_is_positive():
    c = sp.Symbol("c", positive=True)
    assert values_of(x * (sp.log(c) - 1), c) == [{c: sp.E}]
    with pytest.raises(Undecided, match="were not found"):
        values_of(x * (sp.log(a) - 1), a)


def test_states_that_a_condition_ties_to_a_parameter_are_not_drawn():
    assert values_of(x * (a - 1), a, domain=Domain((x > 2,))) == [{a: 1}]
    with pytest.raises(Undecided, match="were not found"):
        values_of(x * (a - 1), a, domain=Domain((x > a,)))


def test_more_cases_than_are_looked_at_are_told(monkeypatch):
    four = x * (a - 1) * (a - 2) * (a - 3) * (a - 4)
    monkeypatch.setattr(parameter_system, "MOST_FAMILIES", 4)
    assert {family[a] for family in values_of(four, a)} == {1, 2, 3, 4}
    with pytest.raises(Undecided, match="more than 4 cases"):
        values_of(four * (a - 5), a)


def test_places_of_a_function_are_brought_together_in_as_many_rounds_as_are_allowed(monkeypatch):
    monkeypatch.setattr(parameter_system, "MOST_ROUNDS", 0)
    with pytest.raises(Undecided, match="not solved in time"):
        values_of(V(x) - V(a * x), a)
