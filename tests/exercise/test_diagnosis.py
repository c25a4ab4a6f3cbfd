"""The law of feedback: a claim with what was told put into it is judged to hold, from its first question on."""

import re
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
import sympy as sp

from canon.exercise.claim_verdict import examine
from canon.exercise.diagnose.change import Mistake
from canon.exercise.diagnose.diagnosis import Proof, judged_to_hold
from canon.exercise.diagnose.diagnosis_search import diagnosis
from canon.exercise.diagnose.effort import Effort
from canon.exercise.diagnose.right_answer import corrected
from canon.exercise.explained_judgement import judgements
from canon.exercise.report import sentences
from canon.exercise.sheet.quantities.measures import measure_of
from canon.exercise.sheet.sheet import Claim, read_sheet

ROOT = Path(__file__).parents[2]
SEEDS = sorted((ROOT / "examples" / "sheets" / "seeds").glob("*.toml"))
DATA = [
    *sorted((ROOT / "tests" / "data" / "claims").glob("*.json")),
    *sorted((ROOT / "tests" / "data").glob("subtle*.json")),
]
SEED = {c.id: c for path in SEEDS for c in read_sheet(path).claims}
STATEMENTS = (
    "an equation is missing",
    "must be eliminated",
    "singular",
    "∂F/∂t",
    "opposite sign of a rule",
    "not affine",
    "depends on",
    "does not follow",
    "exchange Q and P",
    "multiply P",
    "nothing simple mends the map",
    "momenta stand in the wrong order",
    "right only for small",
    "there the reaction does not vanish",
    "this is no equilibrium",
    "no point transformation",
    "the general solution has",
    "the constants are not independent",
    "which its derivatives do not show",
    "it is not one function",
)
"""What is told without anything to put into the claim, nor an answer in it."""


ORDERS = ("zeroth", "first", "second", "third", "fourth", "fifth", "sixth")


def told(claim):
    finding = examine(claim)
    found = diagnosis(finding) if finding.verdict.fails else None
    return None if found is None else sentences.sentence(found)


def changed(claim, /, **keys):
    """Return a claim with other answers; those that are None are taken out."""
    return replace(claim, keys={k: v for k, v in {**claim.keys, **keys}.items() if v is not None})


def holds(claim):
    return examine(claim).verdict.holds


def order_told(sentence):
    """Return the lowest order whose terms are said to be wrong."""
    name = re.search(r"terms of (\S+) order", sentence)[1]
    return ORDERS.index(name) if name in ORDERS else int(name.strip("()th"))


def goes_further(claim, sentence):
    """Whether a claim with the terms put in that were told is right to a higher order, or to all that it claims."""
    missing = re.search(r"exact less claimed is (.*) there", sentence)[1]
    claims = claim.keys["claim"]
    for i, text in enumerate(claims):
        sides = text.split(" = ")
        mended = " = ".join([f"{sides[0]} + ({missing})", *sides[1:]])
        finding = examine(changed(claim, claim=[*claims[:i], mended, *claims[i + 1 :]]))
        if finding.verdict.holds or order_told(finding.verdict.feedback) > order_told(sentence):
            return True
    return False


def is_not_positive_real_somewhere(claim):
    """Whether the opposite holds with numbers for the parameters, those at which canon saw it."""
    example = examine(changed(claim, **{"is": ["positive-real"]})).verdict.counterexample
    if example is None:
        return False
    H, numbers = (
        claim.keys["H"],
        {k: v for k, v in example.point.items() if k in claim.keys.get("parameters", {})},
    )
    for name, number in numbers.items():
        H = re.sub(rf"\b{name}\b", f"({number})", H)
    return holds(changed(claim, H=H, parameters={}, **{"is": ["not positive-real"]}))


def is_a_solution(claim, sentence):
    """Whether the claim that asks for parameters holds with those put in that a sentence names."""
    named = (
        sentence.partition(": ")[2]
        if "is no solution" not in sentence
        else sentence.partition(" is no solution")[0]
    )
    keys = {
        k: v
        for k, v in claim.keys.items()
        if k not in ("of", "find", "values", "id", "kind", "expect", "title")
    }
    for name, value in re.findall(r"(\w+) = ([^,;]+)", named):
        put = partial(re.sub, rf"\b{name}\b", f"({value})")
        keys = {k: [put(item) for item in v] if k in ("Q", "P") else v for k, v in keys.items()}
        keys = {k: put(v) if k in ("F", "I", "H", "K", "lhs", "rhs") else v for k, v in keys.items()}
        keys = {k: {n: put(f) for n, f in v.items()} if k == "solution" else v for k, v in keys.items()}
    return holds(Claim(claim.id, claim.keys["of"], keys))


def is_so_of_a_number(claim, sentence):
    """Whether the slip that a sentence names leads from the value that was claimed to one that is right."""
    example = examine(claim).verdict.counterexample
    given = {name: sp.sympify(value) for name, value in claim.keys.get("given", {}).items()}
    value = claim.keys["value"]
    right = [sp.sympify(v).subs(given) for v in (value if isinstance(value, list) else [value])]
    if (open_ := re.search(r"(\d+) of (\d+) values stays? open", sentence)) is not None:
        return int(open_[2]) == len(right) and "complete" in claim.keys
    if "is no unit of" in sentence or "dimension" in sentence:
        return (
            measure_of(re.search(r"[A-Za-z/^0-9]+$", claim.keys["claim"])[0]).powers
            != measure_of(claim.keys["unit"]).powers
        )
    claimed = sp.sympify(example.left)
    if "further from" in sentence:
        said = sp.sympify(re.search(r"allows: (\S+)$", sentence)[1])
        return sp.Abs(min(sp.Abs(v - claimed) for v in right) - said) < said / 10
    if "the exact one is asked for" in sentence:
        digits = len(claim.keys["claim"].partition(".")[2])
        gaps = [sp.Abs(v - sp.Rational(claim.keys["claim"])).n(20) for v in right]
        return any(0 < gap <= sp.Rational(1, 2 * 10**digits) for gap in gaps)
    mended = {
        "the value has the wrong sign": -claimed,
        "the value should be its reciprocal": 1 / claimed,
        "the value should be half as large": claimed / 2,
        "the value should be twice as large": 2 * claimed,
        "the value seems to be in degrees; it is asked in radians": claimed * sp.pi / 180,
    }[sentence]
    return any(sp.Abs(v - mended) < sp.Abs(v) / 100 for v in right)


def is_so(claim, sentence):
    """Whether what is stated of a claim is so: where an answer is named, the claim of that answer holds."""
    word = sentence.partition(":")[0]
    match claim.kind:
        case "degrees-of-freedom":
            return holds(changed(claim, dof=re.search(r"leave (\d+), not", sentence)[1]))
        case "constraint-class":
            return holds(changed(claim, **{"class": [word]}))
        case "conserved-or-not":
            return holds(changed(claim, conserved=[word.removesuffix(" is conserved")], not_conserved=None))
        case "positive-real" if sentence.endswith("for some values of the parameters"):
            return examine(changed(claim, **{"is": ["not positive-real"]})).verdict.fails
        case "positive-real" if sentence == "H is positive real":
            return holds(changed(claim, **{"is": ["positive-real"]}))
        case "positive-real":
            return is_not_positive_real_somewhere(claim)
        case "separable":
            other = {"separable": "not separable", "not separable": "separable"}[claim.keys["is"][0]]
            return holds(changed(claim, **{"is": [other]}))
        case "parameters":
            return is_a_solution(claim, sentence) == ("is no solution" not in sentence)
        case "first-order":
            return goes_further(claim, sentence)
        case "number":
            return is_so_of_a_number(claim, sentence)
        case _:
            return any(text in sentence for text in STATEMENTS)


def break_of_the_law(claim):
    """Return what was told of a claim although it does not hold with that put in, or is not so."""
    finding = examine(claim)
    found = diagnosis(finding) if finding.verdict.fails else None
    if found is None:
        return None
    if found.repaired is None:
        told = sentences.sentence(found)
        own = found.changes[0].mistake is Mistake.AS_JUDGED and finding.verdict.certificate
        stated = is_so(claim, told) if own else any(text in told for text in STATEMENTS)
        return None if stated else told
    assert found.repaired.claim.id == claim.id
    return None if judged_to_hold(found.repaired, Effort(60.0)) else sentences.sentence(found)


def test_an_equation_that_doubles_another_one_is_no_repair():
    """Both equations of motion would be that of z; the one for r would be missing."""
    assert told(SEED["routh-cylindrical-eom-r"]) is None


@pytest.mark.parametrize("path", [pytest.param(p, id=p.stem) for p in SEEDS if "lagrange" in p.stem])
def test_every_repair_of_a_seed_holds_as_a_whole(path):
    broken = {c.id: break_of_the_law(c) for c in read_sheet(path).claims if c.expect != "holds"}
    assert not any(broken.values()), {k: v for k, v in broken.items() if v}


@pytest.mark.slow
@pytest.mark.parametrize("path", [pytest.param(p, id=p.stem) for p in (*SEEDS, *DATA)])
def test_every_repair_of_a_claim_holds_as_a_whole(path):
    broken = {c.id: break_of_the_law(c) for c in read_sheet(path).claims if c.expect != "holds"}
    assert not any(broken.values()), {k: v for k, v in broken.items() if v}


CLAIMED = {c.id: c for path in DATA for c in read_sheet(path).claims}


@pytest.mark.parametrize(
    ("name", "sentence", "right"),
    [
        ("DF-01a", "2 coordinates less 1 independent constraint leave 1, not 2", True),
        ("DF-01a", "2 coordinates less 1 independent constraint leave 0, not 2", False),
        ("CC-04a", "nonholonomic: the constraint on the velocities is not integrable", True),
        ("CC-04a", "holonomic: the constraint on the velocities is integrable", False),
        ("CN-01b", "-px*y + py*x is conserved: its rate vanishes on every motion", True),
        ("CN-01b", "px*y + py*x is conserved: its rate vanishes on every motion", False),
        ("PR-06b", "H is positive real", True),
        ("PR-06b", "Re H(jω) < 0 for some ω", False),
        ("PR-01a", "H is positive real for some values of the parameters", True),
        ("PR-01b", "H is positive real for some values of the parameters", False),
        (
            "FO-02c",
            "the terms of third order are wrong: exact less claimed is e**3*r*sin(theta)**4/8 there",
            True,
        ),
        (
            "FO-02c",
            "the terms of third order are wrong: exact less claimed is e**3*r*sin(theta)**4/4 there",
            False,
        ),
    ],
)
def test_a_statement_is_held_against_the_claim_of_what_it_names(name, sentence, right):
    assert is_so(CLAIMED[name], sentence) == right


PENDULUM = {"q": ["theta"], "parameters": {"m": "positive", "l": "positive", "g": "positive"},
            "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)"}  # fmt: skip
BENT = "l**2*theta_dot**2/2 + g*l*cos(theta)*sqrt(1 + sin(theta)**4)"
SIZES = {"dimensions": {"m": "mass", "l": "length", "g": "m/s^2", "theta": "1"}}


@pytest.mark.parametrize(
    ("kind", "keys", "proof"),
    [
        ("euler-lagrange", {"claim": ["l*theta_ddot - g*sin(theta)"]}, Proof.REPAIRED),
        ("euler-lagrange", {"L": BENT, "claim": ["l*theta_ddot + g*theta"]}, Proof.COMPARED),
        ("legendre-hamiltonian", {"p": ["p"], "H": "7*g*l*p**3", **SIZES}, Proof.JUDGED),
    ],
)
def test_a_diagnosis_says_how_it_is_known(kind: str, keys: dict[str, object], proof: Proof) -> None:
    found = diagnosis(examine(Claim("a", kind, {**PENDULUM, **keys})))
    assert found.proof is proof
    assert (found.repaired is not None) == (proof is Proof.REPAIRED)


def test_a_slip_behind_a_derivative_is_passed_over():
    keys = {"lhs": "Derivative(A(x), x)*x", "rhs": "Derivative(A(x), x)*x**5 + sin(x) + exp(x)"}
    assert (
        told(Claim("d", "equality-only", {**keys, "functions": {"A": ["x"]}, "parameters": {"x": "real"}}))
        is None
    )


def test_routhian_feedback_speaks_of_momenta():
    """The slips stand in the student's momenta, not in the velocities of the ignorable coordinates."""
    assert told(SEED["routh-cylindrical-eom-r-read-as"]) == (
        "in equation 1 the sign of P0**2/(m*r**3) is wrong"
    )
    keys = dict(SEED["routh-cylindrical-eom-r-read-as"].keys)
    lost = Claim("lost", "routhian", {**keys, "claim": ["m*r_ddot", "z_ddot + g"]})
    assert told(lost) == "in equation 1 the term -P0**2/(m*r**3) is missing"
    assert "theta" not in corrected(examine(lost))
    assert "P0**2" in corrected(examine(lost))


GENERATED = {
    c.id: c for k in "1234" for c in read_sheet(ROOT / f"tests/data/claims/generating-F{k}.json").claims
}


@pytest.mark.parametrize("name", ["F1-02a", "F1-08b", "F2-05a", "F3-01a", "F3-06a", "F4-03a", "F4-05a"])
def test_the_right_generating_function_is_shown(name):
    """By the map and by the inverse map; the claim with it put in holds."""
    claim = GENERATED[name]
    shown = corrected(examine(claim))
    assert shown
    right = Claim(name, claim.kind, {**claim.keys, "F": shown}, budget=claim.budget)
    assert examine(right).verdict.holds


def test_the_right_answer_is_told_before_the_diagnosis_is_looked_for():
    steps = [judgement for judgement, _ in judgements(GENERATED["F1-02a"])]
    assert [bool(s.corrected) for s in steps] == [False, True, True]
    assert [bool(s.feedback) for s in steps] == [False, False, True]
