"""Positive real functions: exact decisions against numbers in the right half plane, and wrong twins."""

import random
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import example, given, settings
from hypothesis import strategies as st

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.judges.positive_real import is_positive_real_at
from canon.exercise.sheet.sheet import Claim


def verdict(kind, **keys):
    return judge(Claim("a", kind, keys))


coefficients = st.lists(st.integers(-3, 6), min_size=1, max_size=4).filter(any)


def least_real_part(above, below):
    """Return the least Re H found at many points of the open right half plane, near poles and the axis too."""
    points = [complex(x, y) for x in (1e-3, 0.1, 1, 10) for y in np.linspace(-8, 8, 161)]
    for root in (*np.roots(below), *np.roots(np.polyadd(above, below))):
        points += [root + d * np.exp(1j * a) for d in (1e-2, 0.1, 0) for a in np.linspace(0, 2 * np.pi, 40)]
    inside = [z for z in points if z.real > 1e-6 and abs(np.polyval(below, z)) > 1e-9]
    return min((np.polyval(above, z) / np.polyval(below, z)).real for z in inside)


@settings(max_examples=50, deadline=None)
@example([1, 0, 0], [2, 1, 1])
@example([1, 0], [-1, 0])
@given(coefficients, coefficients)
def test_positive_real_against_values_in_the_right_half_plane(above, below):
    s = sp.Symbol("s")
    pair = [sp.Poly(f, s, domain="QQ") for f in (above, below)]
    fault = is_positive_real_at(*pair)
    above, below = ([float(c) for c in f.quo(sp.gcd(*pair)).all_coeffs()] for f in pair)
    least = least_real_part(above, below)
    if fault is None:
        assert least > -1e-6
    elif fault.value != "-1":  # a place on the axis is named, where H is negative
        w = float(Fraction(fault.place.removeprefix("j*sqrt(").removesuffix(")")))
        z = 1j * np.sqrt(w)
        assert (np.polyval(above, z) / np.polyval(below, z)).real == pytest.approx(float(fault.value))
        assert float(fault.value) < 0
    else:
        assert least < 1e-3


def test_sums_of_passive_elements_are_passive_and_one_negative_element_spoils_them():
    chance = random.Random(3)
    for _ in range(4):
        k = [chance.randint(1, 5) for _ in range(5)]
        H = f"{k[0]}/s + {k[1]}*s + {k[2]} + {k[3]}*s/(s**2 + {k[4]})"
        claim = {"variables": ["s"], "H": H}
        assert verdict("positive-real", **claim, **{"is": ["passive"]}).holds
        spoiled = {**claim, "H": H.replace(f"{k[3]}*s/(", f"-{k[3]}*s/(")}
        assert verdict("positive-real", **spoiled, **{"is": ["passive"]}).fails
        assert verdict("positive-real", **spoiled, **{"is": ["not passive"]}).holds


def said(kind, **keys):
    """Return the verdict on a claim as a word; invalid where nothing can be judged."""
    try:
        return judge(Claim("a", kind, keys)).status.value
    except InvalidClaim:
        return "invalid"


def declared(text):
    return dict(pair.split(":") for pair in text.split())


@pytest.mark.parametrize(("H", "expected"), [
    ("Abs(s)**2/s", "invalid"),  # the conjugate of s, which is not rational
    ("s**2/s", "holds"),
    ("conjugate(s)", "invalid"),
    ("(s**2 + 1)*(s**2 + 9)/(s*(s**2 + 4))", "holds"),  # zeros and poles take turns
    ("(s**2 + 1)*(s**2 + 4)/(s*(s**2 + 9))", "fails"),
])  # fmt: skip
def test_functions_of_the_complex_frequency(H, expected):
    assert said("positive-real", variables=["s"], H=H, **{"is": ["passive"]}) == expected


def test_a_lag_is_passive_up_to_the_sum_of_its_poles():
    keys = {
        "variables": ["s"],
        "H": "(s + c)/((s + a)*(s + b))",
        "parameters": declared("a:positive b:positive c:positive"),
    }
    assert said("positive-real", **keys, domain=["c <= a + b"], **{"is": ["passive"]}) == "holds"
    assert said("positive-real", **keys, domain=["c > a + b"], **{"is": ["passive"]}) == "fails"
    assert said("positive-real", **keys, domain=["c > a + b"], **{"is": ["not passive"]}) == "holds"


def test_one_word_is_a_list_of_one():
    keys = {"variables": ["s"], "H": "1/(s + 1)"}
    assert said("positive-real", **keys, **{"is": "passive"}) == "holds"
    assert said("positive-real", **keys, **{"is": "not passive"}) == "fails"
    assert said("positive-real", **keys, **{"is": "active"}) == "invalid"


@pytest.mark.parametrize(("H", "domain", "passive"), [
    # Re H has the sign of w² − (3 − c) w + 2 with w = ω², which is negative somewhere where 3 − c > 2√2: c < 0.17157…
    ("(s**2 + 0.1715*s + 1)/(s**2 + s + 2)", [], "fails"),
    ("(s**2 + 0.1716*s + 1)/(s**2 + s + 2)", [], "holds"),
    ("(s**2 + c*s + 1)/(s**2 + s + 2)", ["c <= 1/6"], "fails"),
    ("(s**2 + c*s + 1)/(s**2 + s + 2)", ["c >= 1/5", "c <= 4"], "holds"),
    ("1/(s + sqrt(2))", [], "holds"),  # numbers that are not rational, which no polynomial over ℚ has
    ("1/(s - sqrt(2))", [], "fails"),
    ("(2*s + 1)/(s**2 + s + sqrt(2))", [], "holds"),
    ("(s + 2)/(s**2 + s + sqrt(2))", [], "fails"),  # Re: 2√2 − ω²
    ("1/(s + 1 + cos(a))", [], "holds"),
    ("1/(s - 2 + cos(a))", [], "fails"),
    ("1/(s + cos(a))", [], "undecided"),  # it is for some values of a
    ("-1/(b*s + b)", [], "holds"),
    ("1/(b*s + b)", [], "fails"),
    ("-1/(b*s)", [], "holds"),
])  # fmt: skip
def test_what_is_passive_for_all_values_is_not_passive_for_none(H, domain, passive):
    keys = {
        "variables": ["s"],
        "H": H,
        "domain": domain,
        "parameters": declared("a:real b:negative c:positive"),
    }
    opposite = {"holds": {"fails"}, "fails": {"holds", "undecided"}, "undecided": {"undecided"}}[passive]
    assert said("positive-real", **keys, **{"is": ["passive"]}) == passive
    assert said("positive-real", **keys, **{"is": ["not passive"]}) in opposite


def test_numbers_that_leave_a_transfer_function_undecided_are_told():
    found = verdict(
        "positive-real", variables=["s"], H="(s**2 + sqrt(2))/(s**2 + s + 1)", **{"is": ["passive"]}
    )
    assert "write names for them" in found.evidence[0].text
