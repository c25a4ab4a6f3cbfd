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


@settings(max_examples=20, deadline=None)  # a quarter of a second each: four judgements
@given(st.lists(monomials, min_size=1, max_size=2), monomials, st.sampled_from(["velocities", "positions"]))
def test_multiples_of_differentials_are_holonomic_and_a_twist_makes_them_nonholonomic(
    terms, factor, counting
):
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
    count = 2 if counting == "velocities" or integrable else 3
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


DISK = {"q": ["x", "y", "theta", "phi"], "parameters": {"a": "positive"}}
"""The disk that rolls upright, H. Goldstein, Classical Mechanics, section 1.3, as its equations are printed."""


@pytest.mark.parametrize(
    "printed",
    [
        [r"$dx - a\sin\theta\,d\phi = 0$", r"$dy + a\cos\theta\,d\phi = 0$"],
        ["dx - a*sin(theta)*dphi = 0", "dy = -a cosθ dφ"],
        ["d_x - a*sin(theta)*d_phi", "d_y + a*cos(theta)*d_phi"],
    ],
)
def test_constraints_between_differentials_are_those_between_rates(printed):
    rates = ["x_dot - a*sin(theta)*phi_dot", "y_dot + a*cos(theta)*phi_dot"]
    for constraints in (printed, rates):
        keys = {**DISK, "constraints": constraints}
        assert verdict("constraint-class", **keys, **{"class": ["nonholonomic", "scleronomic"]}).holds
        assert verdict("constraint-class", **keys, **{"class": ["holonomic"]}).fails
        assert verdict("degrees-of-freedom", **keys, dof="2").holds
        assert verdict("degrees-of-freedom", **keys, dof="3").fails


def test_a_differential_of_the_time_makes_a_constraint_depend_on_its_motion():
    """A plane that moves upwards with v, and one that is tilted: dz = v dt and dz = v dx."""
    keys = {
        "q": ["x", "z"],
        "L": "(x_dot**2 + z_dot**2)/2",
        "multipliers": ["lam"],
        "parameters": {"v": "real"},
    }
    assert verdict("nonholonomic", **keys, constraints=["dz - v*dt = 0"], claim=["x'' = 0"]).holds
    assert verdict("nonholonomic", **keys, constraints=["dz - v*x*dt = 0"], claim=["lam = v*x'"]).holds
    assert verdict("nonholonomic", **keys, constraints=["dz - v*x*dx = 0"], claim=["lam = v*x'"]).fails


@pytest.mark.parametrize("form", ["dx*dy = 0", "dx - x = 0", "dx - y_dot = 0", "dx**2"])
def test_what_is_no_pfaffian_form_is_told(form):
    with pytest.raises(InvalidClaim, match="each term of a Pfaffian constraint has one differential"):
        verdict("constraint-class", q=["x", "y"], constraints=[form], **{"class": ["nonholonomic"]})


def test_names_that_are_declared_stay_what_they_are():
    """dx is d times x where d is a parameter; where both readings fail, that is told which comes further."""
    keys = {"q": ["x", "y"], "parameters": {"d": "positive"}, "class": ["holonomic"]}
    assert verdict("constraint-class", **keys, constraints=["d x - y = 0"]).holds
    with pytest.raises(InvalidClaim, match="b is not declared"):
        verdict("constraint-class", q=["x", "y"], constraints=["dx - b*dy = 0"], **{"class": ["holonomic"]})


@pytest.mark.parametrize(
    ("dof", "wrong"),
    [
        ("1 degree of freedom", "2 degrees of freedom"),
        ("one degree of freedom", "two degrees of freedom"),
        ("f = 1 DOF", "f = 2 DOF"),
        ("1 Freiheitsgrad", "2 Freiheitsgrade"),
    ],
)
def test_degrees_of_freedom_are_counted_in_words(dof, wrong):
    keys = {"q": ["x", "y"], "constraints": ["x**2 + y**2 - 1"]}
    assert said("degrees-of-freedom", **keys, dof=dof) == "holds"
    assert said("degrees-of-freedom", **keys, dof=wrong) == "fails"
