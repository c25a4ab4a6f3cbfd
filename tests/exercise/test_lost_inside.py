"""Terms lost inside an answer: found, named, and put back so that the answer is right."""

import pytest
import sympy as sp

from canon.exercise.diagnose.effort import Effort
from canon.exercise.diagnose.repairs.component_screen import PRECISION, Screen
from canon.exercise.diagnose.repairs.lost_factor import Monomials
from canon.exercise.diagnose.repairs.repair import repair
from canon.exercise.question.question import Part
from canon.proof.domain.balls import precision
from canon.proof.domain.domain import Domain
from canon.proof.vanish import vanishes

m, g, l, k = sp.symbols("m g l k", positive=True)
x, y, theta = sp.symbols("x y theta", real=True)

LOST = [
    (m * x / (k * l), m * x / (k * l + m * g), "TERM_MISSING_IN", m * g),
    (x * sp.sqrt(m * g + l), x * sp.sqrt(m * g + l + k * y**2), "TERM_MISSING_IN", k * y**2),
    (k * x - y * m * g**2, k * x - y * m * (g + k * x**2) ** 2, "TERM_MISSING_IN", k * x**2),
    (sp.sin(theta) / sp.cos(theta), sp.sin(theta) / (sp.cos(theta) + 1), "TERM_MISSING_IN", 1),
    (x / (g * (k * x**2 + l)), x / (g * (k * x**2 + l - m * y)), "TERM_MISSING_IN", -m * y),
    (x + y * g / l, x + y * g / sp.sqrt(l**2 + x**2), "SYMBOL", sp.sqrt(l**2 + x**2)),
    (x**2 / 2 + m * x * y / 2 + y**2 / 2, m * (x**2 + x * y + y**2) / 2, "FACTOR_MISSING", m),
    (x**2 + y + k * theta, (x**2 + y) / k**2 + k * theta, "FACTOR_MISSING", k**-2),
    (x**2 + m * g * x * y + 3 * y, m * g * (x**2 + x * y + 3 * y), "FACTOR_MISSING", g * m),
    (x**2 + y / (k + l) - theta, (x**2 + y - theta) / (k + l), "FACTOR_MISSING", 1 / (k + l)),
    (
        3 * y**2 * m,
        3 * y**2 * m / (4 * g ** sp.Rational(1, 3)),
        "FACTOR_MISSING",
        g ** sp.Rational(-1, 3) / 4,
    ),
]


@pytest.mark.parametrize(("claimed", "right", "mistake", "lost"), LOST)
def test_what_is_lost_is_named(claimed, right, mistake, lost):
    found = repair(Part("a", claimed, right), Domain(), Effort(60.0))
    assert found is not None
    assert found.change.mistake.name == mistake
    assert vanishes(found.change.items[-1] - lost).holds
    assert vanishes(found.right - right).holds


@pytest.mark.parametrize("right", [m * x / (k * l + m * g), x * sp.sqrt(2 * m * g - k * y**2)])
def test_nothing_is_lost_in_what_is_wrong_altogether(right):
    found = repair(Part("a", sp.exp(x) * y, right), Domain(), Effort(60.0))
    assert found is None or vanishes(found.right - right).holds


def test_a_lost_term_is_first_told_in_the_functions_of_the_answer() -> None:
    own, other = sp.log(l / k), sp.log(k / l)
    part = Part("a", x + own, x + own + m * other)
    screen = Screen(part, Domain())
    with precision(PRECISION):
        found = list(Monomials(part, screen.first, screen.memo).of_residual())
    assert found[:2] == [m * own, -m * other]
