"""Equalities in a domain: points that satisfy them are drawn, proofs use them, refutations too."""

import random
import time

import pytest
import sympy as sp
from flint import Ordering, fmpq_mpoly_ctx
from sympy import Abs, Eq, Ne, Rational, cos, exp, sin, sqrt, symbols

from canon.proof.domain.domain import Domain
from canon.proof.domain.rational_points import rational_solution
from canon.proof.refute.root_branches import search_branches
from canon.proof.tower.ideal import Ideal
from canon.proof.vanish import equal, vanishes

a, b, c, d, x = symbols("a b c d x", real=True)
k, m, w = symbols("k m w", positive=True)

UNIMODULAR = Eq(a * d - b * c, 1)
CIRCLE = Eq(a**2 + b**2, 1)
ORTHOGONAL = (CIRCLE, Eq(c**2 + d**2, 1), Eq(a * c + b * d, 0))


@pytest.mark.parametrize(
    "conditions",
    [
        (UNIMODULAR,),
        (UNIMODULAR, Eq(a, d)),
        (UNIMODULAR, Eq(a, d), Eq(b, -c)),
        (CIRCLE,),
        (CIRCLE, a > 0, b > 0),
        ORTHOGONAL,
        (Eq((a - 1) * (a - 2), 0),),
        (Eq(w**2, k / m),),
        (Eq(w, sqrt(k / m)),),
        (Eq(a**2 + b**2, c**2 + d**2),),
        (Eq(a * b * c, 1), Eq(a + b + c, d)),
        (Eq(a**2 - b**2, 1),),
        (Eq(a, b), Eq(b, c), Eq(c, d)),
    ],
)
def test_points_satisfy_the_equalities(conditions):
    domain = Domain(conditions)
    points = list(domain.points([], 6))
    assert len(points) == 6
    for point in points:
        assert domain.contains(point)
        assert all(
            sp.simplify(e.lhs.subs(point) - e.rhs.subs(point)) == 0 for e in conditions if e.func is Eq
        )


def test_both_factors_of_an_equality_are_visited():
    points = list(Domain((Eq((a - 1) * (a - 2), 0),)).points([a], 12))
    assert {p[a] for p in points} == {1, 2}


def test_equations_without_rational_points_cost_little():
    start = time.process_time()
    for conditions in ((Eq(a**2, 2),), (Eq(a**2 + b**2, 3),), (Eq(a**4 + b**4, 7),)):
        assert list(Domain(conditions).points([a, b], 6)) == []
    assert time.process_time() - start < 5


def test_solutions_are_solutions():
    near = {a: Rational(1, 3), b: Rational(2), c: Rational(-1, 2), d: Rational(3)}
    for equations in (
        [a**2 + b**2 - 5],
        [a * b - 1, c * d - 2, a + c - 3],
        [a**2 - 4, b - a],
        [a**2 + b**2 + 1],
    ):
        found = rational_solution(equations, near, random.Random(3))
        if equations == [a**2 + b**2 + 1]:
            assert found is None
        else:
            assert all(e.subs(found) == 0 for e in equations)


@pytest.mark.parametrize(
    ("conditions", "left", "right", "wrong"),
    [
        ((UNIMODULAR,), (a * d - b * c) ** 3 - 1, sp.Integer(0), a),
        ((UNIMODULAR,), exp(a * d), exp(1 + b * c), exp(b * c - 1)),
        ((UNIMODULAR, Eq(a, 0)), b * c, sp.Integer(-1), sp.Integer(1)),
        ((UNIMODULAR, Eq(a, d), Eq(b, -c)), a**2 + b**2, sp.Integer(1), a**2 - b**2),
        (ORTHOGONAL, a**2 + c**2, sp.Integer(1), a**2 - c**2),
        (ORTHOGONAL, (a * d - b * c) ** 2, sp.Integer(1), a * d - b * c),
        ((CIRCLE,), sqrt(a**2 + b**2) * x, x, -x),
        ((CIRCLE,), sqrt(1 - a**2), Abs(b), b),
        ((CIRCLE, b > 0), sqrt(1 - a**2), b, -b),
        ((Eq(w**2, k / m),), sqrt(k / m), w, -w),
        ((Eq(w, sqrt(k / m)),), m * w**2, k, 2 * k),
        ((Eq(a, b),), sin(a * x), sin(b * x), cos(b * x)),
        ((Eq(a, -b),), sin(a), -sin(b), sin(b)),
        ((Eq(a**2, b**2),), cos(a), cos(b), sin(b)),
        ((Eq(a * b, b), Ne(b, 0)), a, sp.Integer(1), b),
        ((Eq(a**2, 0),), exp(a), sp.Integer(1), sp.Integer(0)),
        ((Eq(a**2, 2),), a**4, sp.Integer(4), sp.Integer(3)),
        ((Eq(a**2, 2),), Abs(a), sqrt(2), a),
        ((Eq(a**2 + b**2, 3),), sqrt(a**2 + b**2), sqrt(3), sp.Integer(3)),
        ((Eq((a + b - 1) * (a + b - 2), 0),), (a + b) ** 2, 3 * (a + b) - 2, sp.Integer(1)),
    ],
)
def test_what_holds_under_equalities_and_what_does_not(conditions, left, right, wrong):
    domain = Domain(conditions)
    assert equal(left, right, domain).holds
    refuted = equal(left, wrong, domain)
    assert refuted.fails
    names = {s.name: s for s in (a, b, c, d, x, k, m, w)}
    point = {names[n]: sp.sympify(v, locals=names) for n, v in refuted.counterexample.point.items()}
    point = {s: v.subs(point) for s, v in point.items()}
    assert all(abs(sp.N(e.lhs.subs(point) - e.rhs.subs(point))) < 1e-12 for e in conditions if e.func is Eq)
    assert abs(sp.N((left - wrong).subs(point))) > 1e-12


def test_an_equality_that_holds_nowhere_or_at_one_factor_only():
    assert not equal(a, sp.Integer(1), Domain((Eq(a * b, b),))).holds  # b = 0 leaves a open
    assert equal(a, sp.Integer(1), Domain((Eq(a * b, b),))).fails
    assert vanishes(a, Domain((Eq(a**2 + 1, 0),))).assumed  # no real point: anything holds there


def test_ideals():
    p, q, r = fmpq_mpoly_ctx.get(("p", "q", "r"), Ordering.lex).gens()
    ideal = Ideal.of([p**2 + q**2 - 1, p * r - q, r**2 * p / 3 - r])
    chance = random.Random(5)
    for _ in range(20):
        f, g, h = (chance.randint(-3, 3) * p**i * q + chance.randint(1, 5) * r**i for i in (1, 2, 3))
        inside = f * (p**2 + q**2 - 1) + g * (p * r - q) + h * (r**2 * p / 3 - r)
        assert ideal.holds(inside)
        assert not ideal.holds(inside + 1)
    assert not Ideal.of([p * q - 1, q**2 - p]).holds(p**2 - 1)


def test_a_root_that_is_not_real_refutes_nothing() -> None:
    """a² + iab = 1 of real numbers says a² = 1 and ab = 0; (−ib + √(4 − b²))/2 is no value of the real a."""
    domains = Domain((Eq(a**2 + sp.I * a * b, 1),)), Domain((Eq(a**2 + a * b, 1),))
    found = [search_branches(b, sp.Integer(0), domain, time.monotonic() + 10) for domain in domains]
    assert [search.counterexample is None for search in found] == [True, False]


def test_numbers_at_which_an_equation_has_no_value_are_no_solution_of_it():
    equation = 1 / a + 1 / b**3 - 2
    assert rational_solution([equation], {a: sp.Integer(0), b: sp.Integer(0)}, random.Random(1)) is None
    one = {a: sp.Integer(1), b: sp.Integer(1)}
    assert rational_solution([equation], one, random.Random(1)) == one
