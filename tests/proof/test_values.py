"""An answer has a value wherever the right one has, up to isolated points: in the library.

Each form of a worthless answer is tried with every question, and has a right neighbour that holds.
"""

import pytest
import sympy as sp
from sympy import Eq, Integer, Matrix, Ne, Piecewise, Rational, cos, cosh, cot, exp, log, sin, sinh, sqrt, tan

from canon import (
    CanonicalTransformation,
    GeneratingFunction,
    Hamiltonian,
    equal,
    is_constant_of_motion,
    time,
    vanishes,
)
from canon.proof.domain.domain import Domain

q, p = sp.symbols("q p", real=True)
n = sp.Symbol("n", integer=True)
HIDDEN = (q + 1) ** 2 - q**2 - 2 * q - 1
HUGE = Integer(10) ** 200

NOWHERE = {
    "one denominator": lambda r: 7 / HIDDEN,
    "added": lambda r: r + 1 / (sin(q) ** 2 + cos(q) ** 2 - 1),
    "hyperbolic": lambda r: r + 1 / (cosh(q) ** 2 - sinh(q) ** 2 - 1),
    "tangent": lambda r: r + 1 / (tan(q) - sin(q) / cos(q)),
    "zero over zero": lambda r: r + HIDDEN / (sin(q) ** 2 + cos(q) ** 2 - 1),
    "root below": lambda r: r + sqrt(HIDDEN) / HIDDEN,
    "in an exponential": lambda r: r + exp(1 / HIDDEN),
    "logarithm": lambda r: r + log(HIDDEN),
    "pole": lambda r: r + cot(HIDDEN),
    "no piece applies": lambda r: Piecewise((r, sin(q) > 1)),
    "a piece at one point": lambda r: Piecewise((r, Eq(q, 0))),
    "a hidden equality": lambda r: Piecewise((r, Ne(sin(q) ** 2 + cos(q) ** 2, 1))),
    "no piece has a value": lambda r: Piecewise((1 / HIDDEN, q > 0), (r + log(HIDDEN), True)),
}
ON_A_PART = {
    "far out": lambda r: Piecewise((r, p > HUGE)),
    "not far out": lambda r: Piecewise((r, p < HUGE)),
    "half": lambda r: Piecewise((r, q > 0)),
    "far out in two": lambda r: Piecewise((r, sp.And(p > HUGE, q > HUGE))),
    "a hidden half": lambda r: Piecewise((r, q > 0), (r + log(HIDDEN), True)),
    "a modulus": lambda r: r + 1 / (q + abs(q)) - 1 / (2 * q),
}
EVERYWHERE = {
    "itself": lambda r: r,
    "isolated points": lambda r: r + (q**2 - 1) / (q - 1) - q - 1,
    "a pole": lambda r: r + tan(q) - sin(q) / cos(q),
    "a branch": lambda r: r + log(1 + q**2) - log(1 + q**2).expand(),
    "all pieces": lambda r: Piecewise((r, p > HUGE), (r, True)),
}


@pytest.mark.parametrize("form", [*NOWHERE, *ON_A_PART])
def test_what_has_no_value_equals_nothing(form):
    worthless = {**NOWHERE, **ON_A_PART}[form](sin(q))
    for verdict in (equal(worthless, sin(q)), equal(Matrix([p, worthless]), Matrix([p, sin(q)]))):
        assert verdict.fails, verdict


@pytest.mark.parametrize("form", NOWHERE)
def test_what_has_a_value_nowhere_does_not_even_equal_itself(form):
    worthless = NOWHERE[form](sin(q))
    assert equal(worthless, worthless).fails
    assert "has a value nowhere" in equal(worthless, worthless).feedback


@pytest.mark.parametrize("form", NOWHERE)
def test_what_has_a_value_nowhere_does_not_vanish(form):
    worthless = NOWHERE[form](Integer(0))
    assert vanishes(worthless).fails
    assert "has a value nowhere" in vanishes(worthless).feedback
    assert vanishes(Matrix([[Integer(0), worthless]])).fails


@pytest.mark.parametrize("form", EVERYWHERE)
def test_right_neighbours_hold(form):
    assert equal(EVERYWHERE[form](sin(q)), sin(q)).holds
    assert equal(Matrix([EVERYWHERE[form](sin(q))]), Matrix([sin(q)])).holds
    assert vanishes(EVERYWHERE[form](Integer(0))).holds
    assert is_constant_of_motion(EVERYWHERE[form](p**2 + q**2), OSCILLATOR).holds
    assert CanonicalTransformation(q, p, EVERYWHERE[form](p), -q).is_canonical().holds


OSCILLATOR = Hamiltonian(p**2 / 2 + q**2 / 2, q, p)


@pytest.mark.parametrize("form", [*NOWHERE, *ON_A_PART])
def test_what_has_no_value_is_no_constant_of_motion(form):
    worthless = {**NOWHERE, **ON_A_PART}[form](p**2 + q**2)
    assert not is_constant_of_motion(worthless, OSCILLATOR).holds


@pytest.mark.parametrize("form", [*NOWHERE, *ON_A_PART])
def test_what_has_no_value_is_no_canonical_map(form):
    worthless = {**NOWHERE, **ON_A_PART}[form](p)
    map_ = CanonicalTransformation(q, p, worthless, -q)
    assert not map_.is_canonical().holds
    assert not OSCILLATOR.has_equations([worthless], [-q]).holds
    assert not OSCILLATOR.has_equations([p], [-q + worthless - p]).holds


def test_worthless_generating_functions_and_motions():
    Q, P = sp.symbols("Q P", real=True)
    exchange = CanonicalTransformation(q, p, p, -q)
    assert GeneratingFunction(1, q * Q, q, p, Q, P).generates(exchange).holds
    assert GeneratingFunction(1, q * Q + log(HIDDEN), q, p, Q, P).generates(exchange).fails
    assert GeneratingFunction(1, Piecewise((q * Q, Q > HUGE)), q, p, Q, P).generates(exchange).fails
    lost = {q: sin(time) + log((time + 1) ** 2 - time**2 - 2 * time - 1), p: cos(time)}
    assert OSCILLATOR.is_solution({q: sin(time), p: cos(time)}).holds
    assert OSCILLATOR.is_solution(lost).fails
    assert OSCILLATOR.is_solution({q: Piecewise((sin(time), time > HUGE)), p: cos(time)}).fails


def test_sentences_say_what_takes_the_value_and_where():
    assert equal(q / HIDDEN, q).feedback == (
        "the first expression has a value nowhere: "
        "its denominator -q**2 - 2*q + (q + 1)**2 - 1 is zero everywhere"
    )
    verdict = equal(q, Piecewise((q, q < 3)))
    assert verdict.certificate == "definedness"
    assert verdict.feedback.startswith("the second expression has no value around q = ")
    assert sp.Rational(verdict.counterexample.point["q"]) > 3


def test_a_denominator_that_is_zero_on_one_branch_only():
    assert equal(1 / (q + abs(q)), 1 / (2 * q)).fails
    assert equal(1 / (q + abs(q)), 1 / (2 * q), Domain((q > 0,))).holds
    assert equal(1 / (q + abs(q)), 1 / (q + abs(q))).holds
    root = sqrt(q**2 + 2 * q + 1)
    assert equal(1 / (root + q + 1), 1 / (2 * q + 2)).fails
    assert equal(1 / (root + q + 1), 1 / (2 * q + 2), Domain((q > 0,))).holds


def test_every_second_integer_is_no_isolated_point():
    assert equal(q + 1 / (1 + (-1) ** n) - Rational(1, 2), q).fails
    assert equal(1 / (n - 1), (n + 1) / (n**2 - 1)).holds


def test_on_a_narrow_domain_only_what_is_there_counts():
    piece = Piecewise((q, q > 0))
    assert equal(piece, q, Domain((q > 1,))).holds
    assert equal(piece, q, Domain((q > -1,))).fails


def test_arbitrary_functions_have_values():
    f = sp.Function("f", real=True)
    assert equal(f(q) / f(q) ** 2, 1 / f(q)).holds
    assert equal(1 / (f(q) * (sin(q) ** 2 + cos(q) ** 2) - f(q)), 1 / f(q)).fails
    assert equal(f(q).diff(q) / f(q), log(f(q)).diff(q)).holds


def test_of_an_empty_domain_anything_is_true():
    assert equal(q, q + 1, Domain((q < 1, q > 2))).holds
