"""Lagrangians with the same equations of motion that do not differ by dF/dt, and those that seem to have them."""

import pytest

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import Claim

DAMPED = "exp(b*t)*x_dot**2/2"
RIGHT = (
    ("x_dot*log(x_dot) - b*x", ["x_dot > 0"]),
    ("m*x_dot*log(x_dot) - m*b*x", ["x_dot > 0"]),
    ("x_dot*(log(x_dot) + x) - b*x", ["x_dot > 0"]),
    ("x_dot*log(Abs(x_dot)) - b*x", ["Ne(x_dot, 0)"]),
)
WRONG = (
    ("x_dot*log(x_dot) - 2*b*x", ["x_dot > 0"]),
    ("x_dot*log(x_dot) + b*x", ["x_dot > 0"]),
    ("x_dot*log(x_dot)/2 - b*x", ["x_dot > 0"]),
    ("x_dot*log(Abs(x_dot)) - 2*b*x", ["Ne(x_dot, 0)"]),
    ("x_dot*log(x_dot) - b*x + sign(x)", ["x_dot > 0"]),
)


def judged(L2, domain, L1=DAMPED):
    keys = {"q": ["x"], "parameters": {"b": "positive", "m": "positive"}, "relation": "equations"}
    return judge(Claim("a", "lagrangian-equivalence", {**keys, "L1": L1, "L2": L2, "domain": domain}))


@pytest.mark.parametrize(("L2", "domain"), RIGHT)
def test_a_factor_of_the_velocity_alone_is_no_other_motion(L2, domain):
    assert judged(L2, domain).holds
    assert judged(DAMPED, domain, L1=L2).holds


@pytest.mark.parametrize(("L2", "domain"), WRONG)
def test_another_force_is_another_motion(L2, domain):
    verdict = judged(L2, domain)
    assert verdict.fails
    assert verdict.counterexample is not None


def test_what_has_no_value_at_rest_is_not_said_to_be_without_steps():
    L = "x*x_dot*log(x_dot)"
    assert judged(f"{L} + x_dot", ["x_dot > 0"], L1=L).undecided


@pytest.mark.parametrize("relation", ["gauge", "equations"])
@pytest.mark.parametrize(("first", "second", "status"), [
    ("0", "sign(x - t)", "fails"),  # a step of the potential that moves kicks what it meets
    ("sign(x - t)", "sign(x + t) + x*x_dot", "fails"),
    ("sign(x - t)", "sign(x - t) + x*x_dot", "holds"),
    ("0", "sign(t - 1)", "holds"),  # a step at one time, in all places alike, kicks nothing
    ("0", "abs(t - 1)*x_dot + x*sign(t - 1)", "holds"),  # d(x |t − 1|)/dt
    ("0", "abs(t - 1)*x_dot - x*sign(t - 1)", "fails"),
    ("0", "2*abs(x - t)*sign(x - t)*(x_dot - 1)", "holds"),  # d((x − t) |x − t|)/dt
    ("0", "sign(x - t)*(x_dot - 1)", "undecided"),  # d|x − t|/dt
])  # fmt: skip
def test_a_step_that_moves_is_no_gauge_term(relation, first, second, status):
    keys = {"q": ["x"], "relation": relation, "L1": f"x_dot**2/2 + {first}", "L2": f"x_dot**2/2 + {second}"}
    assert judge(Claim("a", "lagrangian-equivalence", keys)).status.value == status
