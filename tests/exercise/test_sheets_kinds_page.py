"""docs/sheets_kinds.md: every example on the page is judged, and what it says is refused is refused."""

import re
from pathlib import Path

import pytest

from canon.exercise.sheet.kinds import KINDS
from canon.exercise.sheet.sheet import Claim, sheet_from
from canon.exercise.sheet_check import judged

PAGE = (Path(__file__).parents[2] / "docs" / "sheets_kinds.md").read_text("utf-8")


SAID = re.findall(r"^# (holds|fails)(?:: (.*))?\n\[\[claim\]\]\nid = \"(.*)\"", PAGE, re.MULTILINE)


SECTIONS = {
    part.split("`")[1]: part for part in re.split(r"^## ", PAGE, flags=re.MULTILINE) if part.startswith("`")
}


BLOCKS = re.findall(r"^```toml\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)


def test_what_the_page_says_is_what_canon_says():
    claims = [claim for block in BLOCKS for claim in sheet_from(block.encode(), toml=True).claims]
    told = list(judged(claims, jobs=2))
    assert [(t.status, t.feedback, t.id) for t in told] == SAID


def test_the_page_names_every_key_of_its_kinds_and_has_a_true_and_a_false_claim_of_each():
    for kind, section in SECTIONS.items():
        for key in (*KINDS[kind].required, *KINDS[kind].optional):
            assert re.search(rf"`{key}`|\(`?{key}`?[,)]|`{key} ", section), (kind, key)
        said = re.findall(r"^# (holds|fails)", section, re.MULTILINE)
        assert {"holds", "fails"} <= set(said), kind
    assert len(SECTIONS) == 17


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
    ],
)  # fmt: skip
def test_what_the_page_says_is_refused(kind, keys, status, told):
    (judgement,) = judged([Claim("a", kind, keys)])
    assert judgement.status == status
    assert told in judgement.known
