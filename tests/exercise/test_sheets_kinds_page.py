"""docs/sheets_kinds.md, sheets_perturbation.md: every example is judged, and what is said to be refused is refused."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from canon.exercise.sheet.kinds import KINDS
from canon.exercise.sheet.sheet import Claim, sheet_from
from canon.exercise.sheet_check import judged

DOCS = Path(__file__).parents[2] / "docs"
PAGE = "".join((DOCS / f"{name}.md").read_text("utf-8") for name in ("sheets_kinds", "sheets_perturbation"))


SAID = re.findall(r"^# (holds|fails)(?:: (.*))?\n\[\[claim\]\]\nid = \"(.*)\"", PAGE, re.MULTILINE)


SECTIONS = {
    part.split("`")[1]: part for part in re.split(r"^## ", PAGE, flags=re.MULTILINE) if part.startswith("`")
}


BLOCKS = re.findall(r"^```toml\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)


def test_what_the_page_says_is_what_canon_says():
    claims = [claim for block in BLOCKS for claim in sheet_from(block.encode(), toml=True).claims]
    # Two judge at a time beside other tests: what is wrong is looked for as long as on a machine of one's own.
    claims = [replace(claim, budget=3 * claim.budget) for claim in claims]
    told = list(judged(claims, jobs=2))
    assert [(t.status, t.feedback, t.id) for t in told] == SAID


def test_the_page_names_every_key_of_its_kinds_and_has_a_true_and_a_false_claim_of_each():
    for kind, section in SECTIONS.items():
        for key in (*KINDS[kind].required, *KINDS[kind].optional):
            assert re.search(rf"`{key}`|\(`?{key}`?[,)]|`{key} ", section), (kind, key)
        said = re.findall(r"^# (holds|fails)", section, re.MULTILINE)
        assert {"holds", "fails"} <= set(said), kind
    assert len(SECTIONS) == 26


PHASE = {"q": ["q"], "p": ["p"]}
SMALL = {"small": ["e"], "parameters": {"e": "real"}}


@pytest.mark.parametrize(
    ("kind", "keys", "status", "told"),
    [
        ("routhian", {"q": ["r", "s"], "L": "r_dot**2 + s_dot**2", "cyclic": ["s"], "momenta": ["l", "k"], "R": "1",
                      "convention": "L-pq"}, "invalid", "2 momenta for 1 ignorable coordinate"),
        ("poisson-bracket", {"q": ["q"], "p": ["p", "r"], "pairs": [{"f": "q", "g": "p", "value": "1"}]},
         "invalid", "2 momenta for 1 coordinate"),
        ("canonicity", {"q": ["q"], "p": ["p"], "Q": ["q**2"], "P": ["p"], "valence": "q"},
         "invalid", "a valence is the same at all points"),
        ("generating-F1", {"q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"], "F": "q*Q",
                           "map": {"Q": "Q", "P": "-q"}}, "invalid", "the variables on the left"),
        ("reaction", {"q": ["x"], "L": "x_dot**2/2", "constraints": ["x = 1"], "multipliers": ["N"],
                      "values": {"N": "2*N"}}, "invalid", "coordinates, velocities and time only"),
        ("degrees-of-freedom", {"q": ["x", "y"], "constraints": ["x_dot**2 + y_dot**2 = 1"], "dof": "1"},
         "undecided", "affine in the velocities"),
        ("conserved-or-not", {"q": ["x"], "L": "x_dot**2/2", "conserved": ["x_dot + Abs(x)/x"], "domain": ["Ne(x, 0)"]},
         "undecided", "may jump"),
        ("linearisation", {"q": ["x"], "L": "x_dot**2/2", "equilibrium": {"x": "t"}, "claim": ["x_ddot"]},
         "invalid", "by parameters only"),
        ("first-order", {"exact": ["x"], "small": ["x"], "parameters": {"x": "real"}, "claim": ["x"], "order": 9},
         "invalid", "from -8 to 8"),
        ("first-order", {"exact": ["x"], "small": ["x"], "parameters": {"x": "real"}, "claim": ["x"],
                         "domain": ["x > 1"]}, "undecided", "away from zero"),
        ("first-order", {"exact": ["Abs(x)"], "small": ["x"], "parameters": {"x": "real"}, "claim": ["x"]},
         "undecided", "not certainly analytic"),
        ("jacobi-identity", {"x": ["a", "b"], "pairs": [{"u": "a", "v": "b", "value": "1"},
                                                        {"u": "b", "v": "a", "value": "1"}]},
         "invalid", "zero by antisymmetry"),
        ("parameters", {"of": "equality", "find": ["a"], "values": []}, "invalid", "should be one of canonicity"),
        ("parameters", {"of": "poisson-bracket", "q": ["q"], "p": ["p"], "find": ["q"], "values": [],
                        "pairs": [{"f": "q", "g": "p", "value": "1"}]}, "invalid", "q is no parameter"),
        ("positive-real", {"variables": ["s"], "H": "1/(s**13 + 1)", "is": ["passive"]},
         "invalid", "a degree above 12"),
        ("hamilton-jacobi", {**PHASE, "H": "p**2/2 + c*q", "constants": ["c"], "W": "c*q"}, "invalid", "c stands in H"),
        ("hamilton-jacobi", {**PHASE, "H": "p**2/2 + t*q", "constants": ["E"], "W": "E*q"},
         "invalid", "H depends on t"),
        ("hamilton-jacobi", {"q": ["x", "y"], "p": ["a", "b"], "H": "a + b", "constants": ["c", "d"], "W": "c*x + d*y"},
         "invalid", "which of them is the energy"),
        ("separable", {**PHASE, "H": "p**2/2 + t*q", "is": ["separable"]}, "invalid", "depends on t"),
        ("separable", {**PHASE, "H": "p**2/2", "is": ["perhaps"]}, "invalid", "separable or not separable"),
        ("action-angle", {**PHASE, "H": "p**2/2 + q**2/2", "new_q": ["u"], "new_p": ["J"],
                          "transformation": {"u": "p"}}, "invalid", "should say what u, J are, or what q, p are"),
        ("action-angle", {**PHASE, "H": "p**2/2 - cos(q)", "parameters": {"E": "real"}, "J": ["E"]},
         "undecided", "motions of several kinds"),
        ("action-angle", {**PHASE, "H": "p**2/2 - q**2/2", "J": ["q"]}, "undecided", "bounded motions"),
        ("frequency", {**PHASE, "H": "p**2/2 + tan(q)**2 + tan(q)", "domain": ["-pi/2 < q", "q < pi/2"],
                       "parameters": {"E": "positive"},
                       "omega": ["2*sqrt((E + 1)**2 + 1)/sqrt(E + 1 + sqrt((E + 1)**2 + 1))"]},
         "undecided", "no closed form"),
        ("frequency", {"q": ["x", "y"], "p": ["a", "b"], "H": "(a**2 + b**2 + x**2 + y**2)/2 + x**2*y",
                       "omega": ["1", "1"]}, "undecided", "does not separate"),
        ("frequency", {**PHASE, "H": "p**2/2 + q**2/2 + t", "omega": ["1"]}, "invalid", "depends on t"),
        ("lie-series", {**PHASE, "f": "q", "W": "p", **SMALL, "order": 9, "claim": "q"},
         "invalid", "from 1 to 8"),
        ("lie-series", {**PHASE, "f": "q", "W": "p*Abs(e)", **SMALL, "claim": "q"},
         "undecided", "not certainly analytic"),
        ("normal-form", {**PHASE, "H": "p**2/2 + q**2/2", "actions": ["J"], "degree": 5, "K": "J"},
         "invalid", "an even number"),
        ("normal-form", {"q": ["x", "y"], "p": ["a", "b"], "H": "(a**2 + b**2 + x**2 + y**2)/2 + x**2*y",
                         "actions": ["J", "L"], "degree": 4, "K": "J + L"}, "undecided", "resonant terms"),
        ("averaged-hamiltonian", {**PHASE, "H": "q + e*p", "angles": ["q"], "small": ["e"], "parameters": {"e": "real"},
                                  "K": "q"}, "undecided", "the average was not found"),
        ("averaged-hamiltonian", {"q": ["u", "x"], "p": ["J", "y"], **SMALL, "order": 2,
                                  "H": "J + e*(y**2/2 + x**2/2 + J*x*cos(u))", "angles": ["u"],
                                  "K": "J + e*(y**2 + x**2)/2 + e**2*x*y"}, "undecided", "which generator is taken"),
        ("generating-first-order", {**PHASE, "H": "p + e*t", **SMALL, "W": "q"},
         "invalid", "take the phase as an angle"),
        ("adiabatic-invariant", {**PHASE, "H": "p**2/2 + e*t", **SMALL, "I": "p"},
         "invalid", "slow = "),
        ("adiabatic-invariant", {**PHASE, "H": "p**2/2", **SMALL, "I": "p", "order": 0},
         "invalid", "one slow time is wanted"),
    ],
)  # fmt: skip
def test_what_the_page_says_is_refused(kind, keys, status, told):
    (judgement,) = judged([Claim("a", kind, keys)])
    assert judgement.status == status
    assert told in judgement.known
