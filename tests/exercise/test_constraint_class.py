"""Classes of constraints and numbers of freedoms: Frobenius against made-up integrals, ranks against NumPy."""

import random

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.sheet.sheet import Claim
from canon.proof.domain.verdict import Status


def verdict(kind, **keys):
    return judge(Claim("a", kind, keys))


monomials = st.tuples(st.integers(0, 2), st.integers(0, 2), st.integers(0, 2))


@settings(max_examples=4, deadline=None)
@given(st.lists(monomials, min_size=1, max_size=3), monomials)
def test_multiples_of_differentials_are_holonomic_and_a_twist_makes_them_nonholonomic(terms, factor):
    x, y, z = v = sp.symbols("x y z")
    f = z + sum(x**i * y**j * z**k for i, j, k in terms)
    mu = 1 + x ** (2 * factor[0]) * y ** (2 * factor[1]) * z ** (2 * factor[2])
    form = [sp.expand(mu * f.diff(s)) for s in v]

    def text(form):
        return " + ".join(f"({c})*{s}_dot" for c, s in zip(form, v, strict=True))

    keys = {"q": ["x", "y", "z"]}
    assert verdict("constraint-class", **keys, constraints=[text(form)], **{"class": ["holonomic"]}).holds
    twisted = [form[0] + y * form[2] + 7 * y, form[1], form[2]]
    w, curl = (
        twisted,
        [
            twisted[(i + 2) % 3].diff(v[(i + 1) % 3]) - twisted[(i + 1) % 3].diff(v[(i + 2) % 3])
            for i in range(3)
        ],
    )
    integrable = sp.expand(sum(a * c for a, c in zip(w, curl, strict=True))) == 0
    said = verdict("constraint-class", **keys, constraints=[text(twisted)], **{"class": ["nonholonomic"]})
    assert said.fails if integrable else said.holds
    for counting, count in (("velocities", 2), ("positions", 2 if integrable else 3)):
        freedom = {"counting": counting, "constraints": [text(twisted)], **keys}
        assert verdict("degrees-of-freedom", **freedom, dof=str(count)).holds
        assert verdict("degrees-of-freedom", **freedom, dof=str(count - 1)).fails


@pytest.mark.parametrize(
    "constraints",
    [["(x - t)**2"], ["(x_dot - t)**2"], ["x", "x + (y - t)**2"]],
)
def test_constraints_that_are_degenerate_where_they_hold_are_not_called_scleronomic(constraints):
    said = verdict("constraint-class", q=["x", "y"], constraints=constraints, **{"class": ["scleronomic"]})
    assert said.status is not Status.HOLDS


def test_a_latex_constraint():
    keys = {"q": ["x", "y"], "parameters": {"a": "positive"}}
    assert verdict(
        "constraint-class", **keys, constraints=["$x^2 + y^2 = a^2$"], **{"class": ["holonomic"]}
    ).holds
    assert verdict(
        "constraint-class", **keys, constraints=[r"$x^2 + y^2 \geq a^2$"], **{"class": ["unilateral"]}
    ).holds


def said(kind, **keys):
    """Return the verdict on a claim as a word; invalid where nothing can be judged."""
    try:
        return judge(Claim("a", kind, keys)).status.value
    except InvalidClaim:
        return "invalid"


@pytest.mark.parametrize(
    ("constraints", "word", "expected"),
    [
        (["x_dot = 0", "x_dot = 1"], "holonomic", "undecided"),  # they contradict each other
        (["x_dot = 0", "y_dot = 1"], "holonomic", "holds"),
        (["x = 0", "x = 1"], "holonomic", "invalid"),
        (["x = 0", "y = 1"], "holonomic", "holds"),
        (["x**2 + y**2 + 1"], "holonomic", "invalid"),  # no point
        (["x**2 + y**2 - 1"], "holonomic", "holds"),
        (["x = t", "x_dot = 0"], "rheonomic", "invalid"),
        # together they say w = 0, and x_dot = 0 then: holonomic, although dω does not vanish off w = 0
        (["x_dot - w*y_dot - w", "x_dot - w*y_dot"], "nonholonomic", "undecided"),
        (["x_dot - w*y_dot"], "nonholonomic", "holds"),
        # on x = 0 what is left is z_dot = y*w_dot: a basis that divides by x sees nothing
        (["x = 0", "x*y_dot + z_dot - y*w_dot"], "holonomic", "fails"),
        (["x = 0", "x*y_dot + z_dot - y*w_dot"], "nonholonomic", "holds"),
        (["x = 0", "x*y_dot + z_dot - z*w_dot"], "holonomic", "holds"),
        # the second edge never bears
        (["x >= 0", "x >= -1 - t**2"], "rheonomic", "undecided"),
        (["x >= 0", "x >= 1 + t**2"], "rheonomic", "holds"),
    ],
)
def test_classes_of_constraints(constraints, word, expected):
    assert (
        said("constraint-class", q=["x", "y", "z", "w"], constraints=constraints, **{"class": [word]})
        == expected
    )


@pytest.mark.parametrize(
    ("constraints", "dof", "expected"),
    [
        (["x_dot - y_dot", "x_dot - y_dot - z"], "2", "undecided"),  # z = 0 follows, and one freedom is left
        (["x_dot - y_dot", "2*x_dot - 2*y_dot"], "2", "holds"),
        (["x_dot", "x_dot - 1"], "2", "undecided"),
        (["Max(x, 0)*y_dot"], "2", "undecided"),
        (["x*y_dot"], "2", "holds"),
    ],
)
def test_numbers_of_freedoms(constraints, dof, expected):
    assert said("degrees-of-freedom", q=["x", "y", "z"], constraints=constraints, dof=dof) == expected


def test_ranks_of_random_constraints_against_numpy():
    chance = random.Random(11)
    for _ in range(6):
        n, m = 4, chance.randint(1, 4)
        rows = [[chance.randint(-2, 2) for _ in range(n)] for _ in range(m)]
        if chance.random() < 0.5 and m > 1:
            rows[-1] = [a + b for a, b in zip(rows[0], rows[-2], strict=True)]
        rows = [row for row in rows if any(row)]
        if not rows:
            continue
        texts = [" + ".join(f"({c})*x{j}_dot" for j, c in enumerate(row)) for row in rows]
        right = n - np.linalg.matrix_rank(np.array(rows))
        keys = {"q": [f"x{j}" for j in range(n)], "constraints": texts}
        for dof in (right, right + 1, right - 1):
            expected = "holds" if dof == right else "fails"
            assert said("degrees-of-freedom", **keys, dof=str(dof)) == expected
            assert said("degrees-of-freedom", **keys, dof=str(dof), counting="positions") == expected
