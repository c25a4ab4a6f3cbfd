"""Formulas that were read in a sense that their writer may not have meant, each with a right neighbour."""

import pytest
import sympy as sp

from canon import coordinates
from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.sheet.sheet import Claim
from canon.expression.as_written import as_written
from canon.expression.parse import LanguageError, Scope, parse_expression
from canon.expression.text.vocabulary import FUNCTIONS

BUDGET = 60.0
"""Seconds for a claim: that a busy machine is slow is no question here."""


def said(kind, **keys):
    """Return the verdict on a claim as a word; invalid where nothing can be judged."""
    try:
        return judge(Claim("a", kind, keys, budget=BUDGET)).status.value
    except InvalidClaim:
        return "invalid"


def scope(moving="", constant="", **functions):
    """Return a scope of coordinates, real parameters and functions of one variable."""
    names = {name: sp.Symbol(name, real=True) for name in constant.split()}
    return Scope(
        {**names, **{name: coordinates(name) for name in moving.split()}},
        {f: (v,) for f, v in functions.items()},
    )


def same(text, other, names):
    """Whether two texts are read alike."""
    return parse_expression(text, names) == parse_expression(other, names)


OSCILLATOR = {"q": ["x"], "p": ["p"], "L": "x'**2/2 - x**2/2", "domain": ["x > 0"]}
POSITIVE = {"m": "positive", "k": "positive"}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_function_is_built_as_it_is_written(name):
    least = FUNCTIONS[name][1]
    arguments = ", ".join(["x", "1/3", "1/5"][:least])
    assert as_written(f"{name}({arguments})", scope("x")).has(coordinates("x"))


@pytest.mark.parametrize(
    "worthless", ["0/(x - Abs(x)) + 0*sech(x)", "0*acot(x)/(x - Abs(x))", "0*coth(1)*log(x - Abs(x))"]
)
def test_an_answer_without_a_value_fails_whatever_functions_stand_in_it(worthless):
    assert said("legendre-hamiltonian", **OSCILLATOR, H=f"p**2/2 + x**2/2 + {worthless}") == "fails"


@pytest.mark.parametrize(
    ("H", "status"),
    [("p**2/2 + x**2/2 + 0*sech(x)", "holds"), ("p**2/2 + x**2/2 + sech(x) - csch(x)", "fails")],
)
def test_an_answer_with_hyperbolic_functions_is_judged_by_its_value(H, status):
    assert said("legendre-hamiltonian", **OSCILLATOR, H=H) == status
