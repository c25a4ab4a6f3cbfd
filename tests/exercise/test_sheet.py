"""Reading sheets: both encodings, and everything that can be wrong with a file or a claim."""

import json
from dataclasses import replace

import pytest

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.sheet.sheet import SheetError, read_sheet, sheet_from

GOOD = {"id": "a", "kind": "equality-only", "lhs": "2 + 2", "rhs": "4"}


def sheet(*claims):
    return sheet_from(json.dumps({"title": "t", "claims": list(claims)}).encode(), file="s.json")


def errors(claim):
    return [str(error) for error in sheet(claim).errors]


def test_toml_and_json_say_the_same(tmp_path):
    toml = tmp_path / "s.toml"
    toml.write_text(
        'title = "t"\n[[claim]]\nid = "a"\nkind = "equality-only"\nlhs = "2 + 2"\nrhs = "4"\nbudget = 2.5\n',
        "utf-8",
    )
    json_ = tmp_path / "s.json"
    json_.write_text(json.dumps({"title": "t", "claims": [{**GOOD, "budget": 2.5}]}), "utf-8")
    one, other = read_sheet(toml), read_sheet(json_)
    assert one.title == other.title
    assert replace(one.claims[0], file="") == replace(other.claims[0], file="")
    assert (one.claims[0].file, other.claims[0].file) == (str(toml), str(json_))
    assert one.claims[0].budget == 2.5


@pytest.mark.parametrize(
    ("data", "toml", "reason"),
    [
        (b"\xff\xfe", False, "UTF-8"),
        (b"{", False, "not valid JSON"),
        (b"[[claim]", True, "not valid TOML"),
        (b"{}", False, "no claims"),
        (b"3", False, "no claims"),
        (b'{"claims": 3}', False, "no claims"),
        (b'{"claims": [], "x": 1}', False, "unknown key 'x'"),
        (b'{"claims": [], "claims": []}', False, "stands twice"),
        (b'{"claims": [{"id": NaN}]}', False, "NaN"),
        (b"[" * 100_000, False, "nested too deeply"),
        (b"a = " + b"[" * 100_000, True, "nested too deeply"),
        (b'{"claims": [' + b"9" * 5000 + b"]}", False, "not valid JSON"),
        (b'{"claims": [' + b"{}," * 10_000 + b"{}]}", False, "at most 10000"),
    ],
)
def test_what_is_no_sheet(data, toml, reason):
    with pytest.raises(SheetError, match=reason):
        sheet_from(data, toml=toml)


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(SheetError, match="can't be read"):
        read_sheet(tmp_path / "missing.toml")
    large = tmp_path / "large.json"
    large.write_bytes(b" " * 10_000_001)
    with pytest.raises(SheetError, match="more than 10000000 bytes"):
        read_sheet(large)


@pytest.mark.parametrize(
    ("change", "where", "reason"),
    [
        ({"kind": "equality"}, "key kind", "is equality-only meant"),
        ({"kind": "astrology"}, "key kind", "known are"),
        ({"kind": 3}, "key kind", "missing"),
        ({"kind": None}, "key kind", "missing"),
        ({"lsh": "1"}, "key lsh", "is lhs meant"),
        ({"lhs": ["1", "2"]}, "key lhs", "should be an expression"),
        ({"lhs": True}, "key lhs", "should be an expression"),
        ({"lhs": None}, "key lhs", "should be an expression"),
        ({"parameters": {"x": "big"}}, "key parameters", "assumption"),
        ({"parameters": ["x"]}, "key parameters", "table"),
        ({"box": {"x": [2, 1]}}, "key box", "lo, hi"),
        ({"box": {"x": ["0", "1"]}}, "key box", "lo, hi"),
        ({"functions": {"V": []}}, "key functions", "arguments"),
        ({"budget": 0}, "key budget", "seconds"),
        ({"budget": True}, "key budget", "seconds"),
        ({"budget": 1e9}, "key budget", "seconds"),
        ({"expect": "maybe"}, "key expect", "holds or fails"),
        ({"title": 3}, "key title", "a word"),
    ],
)
def test_form_of_a_claim(change, where, reason):
    found = errors({**GOOD, **change})
    assert any(where in error and reason in error for error in found), found
    assert all("s.json, claim a" in error for error in found)


def test_missing_keys_and_ids():
    assert errors({"id": "a", "kind": "equality-only", "lhs": "1"}) == [
        "s.json, claim a, key rhs: missing (an expression)"
    ]
    assert "claim #1, key id" in errors({**GOOD, "id": ""})[0]
    assert "claim #1" in str(sheet("not a table").errors[0])
    assert any(
        "needs H or exists" in e
        for e in errors({"id": "a", "kind": "legendre-hamiltonian", "q": ["x"], "p": ["p"], "L": "x"})
    )


def test_a_repeated_id_is_an_error_of_the_second_only():
    read = sheet(GOOD, {**GOOD, "rhs": "5"}, {**GOOD, "id": "b"})
    assert [bool(claim.errors) for claim in read.claims] == [False, True, False]


@pytest.mark.parametrize(
    ("change", "key", "column"),
    [
        ({"lhs": "2 + y"}, "lhs", 5),
        ({"rhs": "sin(4"}, "rhs", 4),
        ({"domain": ["x > 0"]}, "domain[0]", 1),
        ({"domain": ["1 > 2"]}, "domain[0]", 0),
        ({"box": {"x": [0, 1]}}, "box", 0),
        ({"t": "2t"}, "t", 0),
        ({"functions": {"V": ["x"]}, "lhs": "V(1, 2)"}, "lhs", 1),
    ],
)
def test_what_a_claim_says_is_invalid_for_that_claim_only(change, key, column):
    read = sheet({**GOOD, **change}, {**GOOD, "id": "b"})
    with pytest.raises(InvalidClaim) as caught:
        judge(read.claims[0])
    assert (caught.value.error.claim, caught.value.error.key, caught.value.error.column) == ("a", key, column)
    assert judge(read.claims[1]).holds


@pytest.mark.parametrize(
    ("claim", "key"),
    [
        (
            {
                "kind": "poisson-bracket",
                "q": ["x"],
                "p": ["x"],
                "pairs": [{"f": "x", "g": "x", "value": "0"}],
            },
            "p",
        ),
        (
            {
                "kind": "poisson-bracket",
                "q": ["x"],
                "p": ["p", "r"],
                "pairs": [{"f": "x", "g": "x", "value": "0"}],
            },
            "p",
        ),
        (
            {
                "kind": "poisson-bracket",
                "q": ["t"],
                "p": ["p"],
                "pairs": [{"f": "p", "g": "p", "value": "0"}],
            },
            "q",
        ),
        (
            {
                "kind": "poisson-bracket",
                "q": ["x"],
                "p": ["p"],
                "pairs": [{"u": "x", "v": "x", "value": "0"}],
            },
            "pairs[0]",
        ),
        ({"kind": "lie-bracket", "x": ["x", "y"], "X": ["1"], "Y": ["1", "0"], "claim": ["0", "0"]}, "X"),
        (
            {"kind": "hamilton-equations", "q": ["x"], "p": ["p"], "H": "p**2", "solution": {"x": "t"}},
            "solution",
        ),
        (
            {
                "kind": "hamilton-equations",
                "q": ["x"],
                "p": ["p"],
                "H": "p**2",
                "solution": {"x": "p", "p": "1"},
            },
            "solution.x",
        ),
        (
            {
                "kind": "routhian",
                "q": ["x"],
                "L": "x_dot**2",
                "cyclic": ["y"],
                "momenta": ["p"],
                "convention": "L-pq",
                "R": "p",
            },
            "cyclic",
        ),
        (
            {
                "kind": "routhian",
                "q": ["x"],
                "L": "x_dot**2",
                "cyclic": ["x"],
                "momenta": ["p"],
                "convention": "none",
                "R": "p",
            },
            "convention",
        ),
        (
            {"kind": "lagrangian-equivalence", "q": ["x"], "L1": "x", "L2": "x", "relation": "friends"},
            "relation",
        ),
        (
            {
                "kind": "lagrangian-equivalence",
                "q": ["x"],
                "L1": "x",
                "L2": "x",
                "relation": "equations",
                "F": "x",
            },
            "F",
        ),
        (
            {
                "kind": "generating-F1",
                "q": ["x"],
                "p": ["p"],
                "new_q": ["Q"],
                "new_p": ["P"],
                "F": "x*Q",
                "map": {"Q": ["p"]},
            },
            "map",
        ),
        (
            {
                "kind": "generating-F1",
                "q": ["x"],
                "p": ["p"],
                "new_q": ["Q"],
                "new_p": ["P"],
                "F": "x*Q",
                "map": {"Q": ["P"], "P": ["x"]},
            },
            "map",
        ),
        (
            {
                "kind": "nonholonomic",
                "q": ["x"],
                "L": "x_dot**2",
                "constraints": ["x - 1"],
                "multipliers": ["l"],
                "claim": ["x"],
            },
            "constraints[0]",
        ),
        (
            {
                "kind": "nonholonomic",
                "q": ["x"],
                "L": "x_dot**2",
                "constraints": ["x_dot**2 - 1"],
                "multipliers": ["l"],
                "claim": ["x"],
            },
            "constraints",
        ),
        (
            {
                "kind": "multiplier-holonomic",
                "q": ["x"],
                "L": "x_dot**2",
                "constraints": ["x_dot - 1"],
                "multipliers": ["l"],
                "claim": ["x"],
            },
            "constraints[0]",
        ),
        (
            {
                "kind": "multiplier-holonomic",
                "q": ["x"],
                "L": "x_dot**2",
                "constraints": ["x - 1"],
                "multipliers": ["l", "k"],
                "claim": ["x"],
            },
            "multipliers",
        ),
        (
            {
                "kind": "gibbs-appell",
                "q": ["x"],
                "quasi": ["u"],
                "bodies": [{"m": "1", "r": ["x"]}],
                "S": "u_dot**2/2",
            },
            "q_dot",
        ),
        ({"kind": "constant-of-motion", "q": ["x"], "L": "x_dot**2", "I": "x_ddot"}, "I"),
        ({"kind": "constant-of-motion", "q": ["x"], "p": ["p"], "H": "p**2", "I": "x_dot"}, "I"),
        ({"kind": "euler-lagrange", "q": ["x"], "L": "x_ddot**2", "claim": ["x_ddot"]}, "L"),
        (
            {
                "kind": "hamilton-equations",
                "q": ["x"],
                "p": ["p"],
                "H": "p*x_dot",
                "q_dot": ["p"],
                "p_dot": ["0"],
            },
            "H",
        ),
    ],
)
def test_claims_that_do_not_fit_together(claim, key):
    with pytest.raises(InvalidClaim) as caught:
        judge(sheet({"id": "a", **claim}).claims[0])
    assert caught.value.error.key == key


@pytest.mark.parametrize(
    "text", ["\theta + 1", "1 + \frac{1}{2}", "$\theta + 1$", "\begin{align} x", "x\right)"]
)
def test_latex_that_lost_its_backslashes_to_quotes_says_so(text):
    keys = {"id": "a", "kind": "equality-only", "lhs": text, "rhs": "1", "parameters": {"theta": "real"}}
    (error,) = sheet_from(json.dumps({"claims": [keys]}).encode(), toml=False).errors
    assert "a backslash and a letter became one sign here" in str(error)


@pytest.mark.parametrize("text", ["x +\tan", "a\tb", "x\ny", "x\r\n+ 1"])
def test_blanks_are_no_lost_backslashes(text):
    keys = {"id": "a", "kind": "equality-only", "lhs": text, "rhs": "1", "parameters": {"x": "real"}}
    assert not sheet_from(json.dumps({"claims": [keys]}).encode(), toml=False).errors
