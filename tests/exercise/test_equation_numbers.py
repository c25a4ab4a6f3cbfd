"""Numbers of equations are no factors, and a factor is no number."""

import pytest

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.reading import InvalidClaim
from canon.exercise.sheet.sheet import Claim

SPRINGS = {
    "q": ["x", "y"],
    "L": "m*(x_dot**2 + y_dot**2)/2 - k*(x**2 + 2*y**2)/2",
    "parameters": {"m": "positive", "k": "positive"},
}
FORMS = [
    ["1. m x'' + k x = 0", "2. m y'' + {} k y = 0"],
    ["(1) m x'' + k x = 0", "(2) m y'' + {} k y = 0"],
    "(1) m x'' + k x = 0; (2) m y'' + {} k y = 0",
    "1) m x'' + k x = 0\n2) m y'' + {} k y = 0",
    "m x'' + k x = 0 (1)\nm y'' + {} k y = 0 (2)",
    "x'' = -k x/m (3); y'' = -{} k y/m (4)",
    r"(1) $m\ddot x + k x = 0$; (2) $m\ddot y + {} k y = 0$",
    ["$\\ddot x = -k x/m \\quad (1)$", "$\\ddot y = -{} k y/m \\quad (2)$"],
]


def said(form, factor):
    texts = [form] if isinstance(form, str) else form
    filled = [text.replace("{}", factor) for text in texts]
    return judge(Claim("a", "euler-lagrange", {**SPRINGS, "claim": filled})).status.value


@pytest.mark.parametrize("form", FORMS)
def test_numbered_equations_are_judged_without_their_numbers(form):
    assert said(form, "2") == "holds"
    assert said(form, "1") == "fails"
    assert said(form, "4") == "fails"


@pytest.mark.parametrize(
    "claim",
    [
        ["m x'' + k x = 0", "(2) m y'' + 2 k y = 0"],
        ["(1) m x'' + k x = 0", "(3) m y'' + 2 k y = 0"],
        ["m x'' + k x = 0", "m y'' = -k y*2 + 0*3 (2)"],
        "(2) m x'' + 2 k x = 0",
    ],
)
def test_a_number_that_may_be_a_factor_is_asked_about(claim):
    with pytest.raises(InvalidClaim, match="may be a factor, or the number of the equation"):
        judge(Claim("a", "euler-lagrange", {**SPRINGS, "claim": claim}))


def test_factors_stay_factors():
    assert said(["2 m x'' + 2 k x = 0", "2*m*y'' + {}*k*y = 0"], "4") == "holds"
    assert said(["(2)*m x'' + 2 k x = 0", "(3 m) y'' + {} k y = 0"], "6") == "holds"
    assert said(["2.0 m x'' + 2. k x = 0", "2. m y'' + {}. k y = 0"], "4") == "holds"
