"""What was declared of a symbol, asked of numbers: what is seen at once is what SymPy deduces."""

from __future__ import annotations

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from canon.proof.domain.declarations import _SEEN_AT_ONCE, allows, said_of

FACTS = (
    "positive", "negative", "zero", "nonzero", "nonnegative", "nonpositive", "integer", "noninteger", "even", "odd",
    "prime", "composite", "real", "imaginary", "finite", "infinite", "rational", "irrational",
)  # fmt: skip
NUMBERS = st.builds(sp.Rational, st.integers(-40, 40), st.integers(1, 12))


@given(number=NUMBERS, so=st.booleans())
def test_every_fact_is_what_sympy_says_of_the_number(number: sp.Rational, so: bool) -> None:
    for fact in FACTS:
        assert allows({fact: so}, number) is (getattr(number, f"is_{fact}") is so), (fact, number)


def test_all_that_is_seen_at_once_is_tried_above() -> None:
    assert set(_SEEN_AT_ONCE) <= set(FACTS)


@pytest.mark.parametrize(
    "fact", ["positive", "negative", "nonzero", "integer", "even", "odd", "prime", "nonpositive"]
)
@given(number=NUMBERS)
def test_a_number_is_allowed_where_nothing_declared_is_untrue_of_it(fact: str, number: sp.Rational) -> None:
    declared = sp.Symbol("x", **{fact: True})
    against = any(getattr(number, f"is_{f}") is not so for f, so in said_of(declared).items())
    assert allows(said_of(declared), number) is not against
