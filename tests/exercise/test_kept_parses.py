"""A text is read once for equal scopes, and anew where a name means something else."""

from __future__ import annotations

from canon.exercise import Claim
from canon.exercise.sheet.reading import Reading


def reading(word: str, **more: object) -> Reading:
    return Reading(
        Claim("a", "equality-only", {"lhs": "sqrt(x**2)", "rhs": "x", "parameters": {"x": word}, **more})
    )


def test_scopes_with_the_same_names_are_one():
    one, other = reading("positive"), reading("positive")
    assert one.scope == other.scope
    assert hash(one.scope) == hash(other.scope)
    assert one.expression("lhs") is other.expression("lhs")


def test_the_same_text_is_another_expression_where_its_names_mean_something_else():
    positive, real = reading("positive"), reading("real")
    assert positive.scope != real.scope
    assert positive.expression("lhs") == positive.scope.names["x"]
    assert real.expression("lhs") == abs(real.scope.names["x"])
    assert positive.expression("lhs") == positive.scope.names["x"]


def test_the_time_is_a_name_like_the_others():
    one, other = (
        reading("real", lhs="2*tau", t="tau"),
        reading("real", lhs="2*tau", parameters={"tau": "real"}),
    )
    assert one.scope != other.scope
