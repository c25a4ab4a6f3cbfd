"""Sentences told about wrong claims: each is true, names the mistake, and is readable in the claim's own terms."""

import pytest

from canon.exercise.claim_verdict import examine
from canon.exercise.diagnose.right_answer import corrected
from canon.exercise.report.sentences import feedback
from canon.exercise.sheet.reading import InvalidClaim
from canon.exercise.sheet.sheet import Claim, claim_from


def told(kind, **keys):
    finding = examine(Claim("a", kind, keys))
    assert finding.verdict.fails
    return feedback(finding) or finding.verdict.feedback, corrected(finding)


def reason(kind, **keys):
    claim = claim_from({"id": "a", "kind": kind, **keys})
    if claim.errors:
        return "; ".join(error.brief for error in claim.errors)
    with pytest.raises(InvalidClaim) as found:
        examine(claim)
    return found.value.error.brief


def test_where_a_claim_is_right_is_not_said_to_be_the_only_place():
    capped = {"parameters": {"x": "real"}, "lhs": "Min(x, 10000)", "rhs": "x"}
    assert told("equality-only", **capped)[0] == "right for x < 0, but not on the whole domain"
    assert told("equality-only", **{**capped, "lhs": "Min(x, 10000) + Max(x, 0) - Max(x, 1)"})[0] == ""


def test_nothing_is_said_of_a_part_of_the_domain_that_is_empty():
    sliver = {"parameters": {"x": "real"}, "domain": ["Abs(x - 7) < 1/1000"]}
    assert told("equality-only", **sliver, lhs="asin(sin(x))", rhs="pi - x")[0] == ""
    momentum = {"q": "x", "p": "p", "domain": ["x_dot > 0"], "L": "x_dot*exp(x_dot) - exp(x_dot)"}
    assert "p < 0" not in told("legendre-hamiltonian", **momentum, H="p*LambertW(p) - p")[0]
    contradiction = {**momentum, "H": "p*LambertW(p) - p", "parameters": {"p": "negative"}}
    assert "no point satisfies" in reason("legendre-hamiltonian", **contradiction)


@pytest.mark.parametrize(
    ("Q", "P", "factor", "right"),
    [
        ("q**3/3", "5*p/q**2", "2", "5"),
        ("q*exp(t)", "p + q*t", "exp(t) + t", "exp(t)"),
        ("mu*q + sin(p)", "nu*p", "mu + nu", "mu*nu"),
    ],
)
def test_the_right_factor_of_a_bilinear_covariant_is_shown(Q, P, factor, right):
    keys = {"q": "q", "p": "p", "Q": Q, "P": P, "parameters": {"mu": "real", "nu": "real"}}
    sentence, shown = told("bilinear-covariant", **keys, factor=factor)
    assert sentence.startswith(f"the factor is {right}, not ")
    assert shown == f"the coefficient of δp dq − dp δq = {right}"
    assert examine(Claim("a", "bilinear-covariant", {**keys, "factor": right})).verdict.holds


def test_equations_are_counted_as_the_claim_counts_them():
    keys = {
        "q": ["x", "y"],
        "parameters": {"m": "positive"},
        "L": "m*(x_dot**2 + y_dot**2)/2 - y",
        "constraints": ["x_dot - y_dot", "2*x_dot - 2*y_dot"],
        "multipliers": ["l1", "l2"],
    }
    sentence, _ = told("nonholonomic", **keys, claim=["2*m*x_ddot + 1", "l1 = -1/2"])
    assert sentence.startswith(
        ("equation 2 of the claim does not follow", "in claim 2 the term 2*l2 is missing")
    )
    both = {**keys, "claim": ["2*m*x_ddot + 1", "l1 + 2*l2 = -1/2"]}
    assert examine(Claim("a", "nonholonomic", both)).verdict.holds


def test_an_equation_that_is_not_affine_is_called_so():
    assert (
        told("euler-lagrange", q="x", L="x_dot**2/2", claim="x_ddot**2")[0]
        == "equation 1 is not affine in x_ddot"
    )


def test_long_equations_are_left_out_of_sentences():
    terms = " + ".join(f"{k}*sin({k}*x)*cos({k}*y)*x_dot*y_dot" for k in range(1, 12))
    sentence, _ = told(
        "euler-lagrange",
        q=["x", "y"],
        L=f"(x_dot**2 + y_dot**2)/2*exp(x*y) + {terms}",
        claim=["x_ddot + x", "y_ddot + y**2"],
    )
    assert len(sentence) < 120


def test_a_kinetic_energy_of_the_second_order_is_not_right_to_first_order():
    sentence, _ = told(
        "legendre-hamiltonian",
        q=["u", "v"],
        p=["p1", "p2"],
        parameters={"a": "positive", "b": "positive"},
        domain=["a > b"],
        L="(b**2*u_dot**2 + (a + b*cos(u))**2*v_dot**2)/2",
        H="p1**2/(2*b**2) + p2**2/(2*(a**2 + b**2*cos(u)**2))",
    )
    assert "to first order" not in sentence


def test_a_repair_does_not_empty_an_equation():
    """On the skate's motion φ̈ = 0: putting it for m makes every term vanish and repairs nothing."""
    sentence, _ = told(
        "nonholonomic",
        q=["x", "y", "phi"],
        parameters={"m": "positive", "J": "positive", "g": "positive"},
        functions={"U": ["x", "y"]},
        L="m*(x_dot**2 + y_dot**2)/2 + J*phi_dot**2/2 - U(x, y)",
        constraints=["x_dot*sin(phi) - y_dot*cos(phi)"],
        multipliers=["lam"],
        claim=["m*x_dot*x_ddot + m*y_dot*y_ddot - m*g*x_dot"],
    )
    assert "phi_ddot everywhere" not in sentence


def test_a_superfluous_term_is_named_before_another_symbol_in_it():
    keys = {"q": "x", "parameters": {"g": "positive"}, "relation": "equations", "L1": "x_dot**2/2"}
    assert (
        told("lagrangian-equivalence", **keys, L2="sqrt(1 + x_dot**2) - g*x")[0]
        == "in L2 the term -g*x does not belong"
    )


def test_derivatives_at_a_place_are_written_as_in_a_sheet():
    keys = {
        "q": "q",
        "p": "p",
        "functions": {"V": ["y"], "X": ["t"]},
        "H": "p**2/2 + V(q - X(t))",
        "q_dot": ["p"],
    }
    right = "-Derivative(V(q - X(t)), q)"
    sentence, shown = told(
        "hamilton-equations", **keys, p_dot=["-Derivative(V(q - X(t)), q)*Derivative(X(t), t)"]
    )
    assert "Subs" not in sentence + shown
    assert right in shown
    assert examine(Claim("a", "hamilton-equations", {**keys, "p_dot": [right]})).verdict.holds


def test_no_right_answer_is_shown_where_canon_has_none():
    solution = {"q": "q0*exp(t)", "p": "p0*exp(t)"}
    keys = {"q": "q", "p": "p", "parameters": {"q0": "real", "p0": "real"}, "H": "-q*p"}
    assert told("hamilton-equations", **keys, solution=solution)[1] == ""
    ignored = {
        "q": ["r", "f"],
        "parameters": {"r": "positive"},
        "cyclic": "f",
        "momenta": "l",
        "convention": "L-pq",
    }
    wrong = {"L": "(r_dot**2 + r**2*f_dot**2)/2 - cos(f)", "R": "r_dot**2/2 - l**2/(2*r**2) - cos(f)"}
    assert told("routhian", **ignored, **wrong) == ("f is not ignorable: L depends on it", "")


MAP = {"q": "q", "p": "p", "new_q": "Q", "new_p": "P", "F": "q*Q", "map": {"Q": "p", "P": "-q"}}


@pytest.mark.parametrize(
    ("kind", "keys", "said"),
    [
        ("generating-F1", {**MAP, "inverse_map": {"q": "-P", "p": "Q"}}, "map and inverse_map both say"),
        (
            "constant-of-motion",
            {"q": "q", "p": "p", "H": "p**2/2", "x": "x", "X": "1", "I": "p"},
            "both say what it is about; leave one out",
        ),
        (
            "euler-lagrange",
            {"q": ["x", "x_dot"], "L": "x_dot**2/2", "claim": "x_ddot"},
            "x_dot is the velocity of a coordinate that is declared too",
        ),
        (
            "equality-only",
            {"lhs": "x", "rhs": "x", "parameters": {"x": "complex"}},
            "x is positive, negative, nonzero",
        ),
        (
            "equality-only",
            {"lhs": "x", "rhs": "x", "parameters": {"x": "real"}, "box": {"x": [2, 1]}},
            "that of x should be two numbers, the smaller one first",
        ),
        ("euler-lagrange", {"q": "π", "L": "π̇**2", "claim": "π̈"}, "write pi for π"),
        (
            "equality-only",
            {"lhs": "x**(1000001/2000000)", "rhs": "x", "parameters": {"x": "positive"}},
            "an exponent whose numerator or denominator is beyond 1000",
        ),
        (
            "equality-only",
            {"lhs": "x**1001", "rhs": "x", "parameters": {"x": "positive"}},
            "an exponent beyond 1000",
        ),
    ],
)
def test_what_is_told_of_a_claim_that_cannot_be_read(kind, keys, said):
    assert said in reason(kind, **keys)


def test_one_of_two_ways_is_enough():
    assert examine(Claim("a", "generating-F1", MAP)).verdict.holds
    either = {key: value for key, value in MAP.items() if key != "map"}
    assert examine(
        Claim("a", "generating-F1", {**either, "inverse_map": {"q": "-P", "p": "Q"}})
    ).verdict.holds
