"""What leaves a report: pages, XML, JSON, an assertion. Whatever a stranger wrote, it stays text."""

import json
import subprocess
import sys
import xml.etree.ElementTree as ET
from html.parser import HTMLParser

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy.physics.mechanics import dynamicsymbols

import canon
from canon.cli import main
from canon.exercise.judging_process import Worker
from canon.exercise.report.judgement import Judgement
from canon.exercise.report.report import Report
from canon.exercise.sheet.sheet import SheetError, bundled_sheet, claim_from, sheet_from
from canon.expression.mathml import formula
from canon.expression.text.scope import Scope
from canon.printable import printable
from canon.proof.domain.verdict import Undecided

ALLOWED = {
    "html", "head", "meta", "title", "style", "body", "main", "h1", "h2", "p", "span", "section", "code", "dl", "dt",
    "dd", "div", "details", "summary", "ol", "li", "pre", "strong", "math", "mrow", "mi", "mn", "mo", "mfrac", "msup",
    "msub", "msqrt", "mover", "mtable", "mtr", "mtd", "mtext",
}  # fmt: skip
ATTRIBUTES = {"class", "lang", "charset", "http-equiv", "content", "name", "accent", "columnalign"}
EVIL = '<script>alert(1)</script><img src=x onerror="alert(1)"> & \' " ]]> --> \x1b[2J \x00 \u202e \ud800'


class Tags(HTMLParser):
    def __init__(self):
        super().__init__()
        self.tags, self.attributes, self.text, self.open = set(), set(), [], []

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.attributes |= {name for name, _ in attrs}
        if tag != "meta":
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


def read(html):
    tags = Tags()
    tags.feed(html)
    tags.close()
    assert not tags.open
    return tags


def evil_report():
    keys = {
        "id": EVIL,
        "kind": "equality-only",
        "title": EVIL,
        "lhs": EVIL,
        "rhs": "$" + EVIL,
        "source": EVIL,
    }
    claims = (
        claim_from(keys),
        claim_from({**keys, "id": "b", EVIL: EVIL, "domain": [EVIL]}),
        claim_from(EVIL),
    )
    told = tuple(
        Judgement(EVIL, EVIL, status, 1.0, EVIL, EVIL, {"point": {EVIL: EVIL}, "left": EVIL, "right": EVIL}, EVIL, EVIL,
                  EVIL, EVIL, EVIL, "", EVIL, ((EVIL, EVIL),), (EVIL,))
        for status in ("fails", "invalid", "undecided")
    )  # fmt: skip
    return Report(EVIL, told, claims)


@pytest.fixture(scope="module")
def tour():
    return canon.check(bundled_sheet(), jobs=2)


def test_the_report_of_the_tour(tour):
    assert tour.counts == {"holds": 8, "fails": 5}
    assert [j.id for j in tour] == [c.id for c in tour.claims]
    assert len(tour) == 13
    said = json.loads(tour.to_json())
    assert said["counts"] == tour.counts
    assert [c["status"] for c in said["claims"]] == [j.status for j in tour]
    with pytest.raises(AttributeError):
        tour.title = "x"


def test_the_page_shows_formulas_feedback_and_steps(tour):
    page = read(tour.to_html())
    assert page.tags <= ALLOWED
    assert page.attributes <= ATTRIBUTES
    text = "".join(page.text)
    for word in (
        "θ",
        "¨",
        "F should be half what it is",
        "equation 1 as canon derives it",
        "right would be",
        "8 holds",
    ):
        assert word in text
    assert "right would be: {f, g} of pair 1 = " in text
    assert {"math", "mfrac", "msup", "mover", "details"} <= page.tags


def test_the_steps_are_those_of_a_derivation(tour):
    pendulum = dict(tour.judgements[0].steps[i][::-1] for i in range(len(tour.judgements[0].steps)))
    assert tour.judgements[0].steps[:2] == (
        ("", "Derivative(L, theta_dot) = l**2*m*theta_dot"),
        ("", "Derivative(L, theta) = -g*l*m*sin(theta)"),
    )
    assert pendulum["g*l*m*sin(theta) + l**2*m*theta_ddot = 0"] == "equation 1 as canon derives it"
    assert tour.judgements[0].steps[-1] == ("so it holds, decided by: exact", "")
    for judgement in tour:
        assert judgement.steps[-1][0].startswith(f"so it {judgement.status}, decided by: ")
        for _, shown in judgement.steps:
            assert not shown or formula(shown, Scope()) is not None, shown


def test_nothing_is_fetched(tour):
    html = tour.to_html()
    for word in ("http:", "https:", "src=", "href=", "url(", "@import", "<script", "<link"):
        assert word not in html
    assert "default-src 'none'" in html


def test_a_notebook_shows_the_same(tour):
    shown = tour._repr_html_()
    assert shown.startswith("<div><style>")
    assert shown.count("<section") == 13
    assert "html {" not in shown.split("</style>")[0]
    assert "body {" not in shown.split("</style>")[0]


def test_what_strangers_wrote_stays_text():
    report = evil_report()
    for html in (report.to_html(), report._repr_html_()):
        page = read(html)
        assert page.tags <= ALLOWED
        assert page.attributes <= ATTRIBUTES
        assert "<script>alert(1)</script>" in "".join(page.text)
        html.encode("utf-8")
    root = ET.fromstring(report.to_junit().encode("utf-8"))
    assert len(root.findall(".//testcase")) == 3
    table = str(report)
    assert "\x1b" not in table
    assert "\u202e" not in table
    assert "\x00" not in table
    table.encode("utf-8")


def test_json_keeps_every_character():
    for judgement in evil_report():
        assert json.loads(judgement.json_line)["id"] == EVIL
        assert "\x1b" not in judgement.json_line
        judgement.json_line.encode("utf-8")


@settings(max_examples=200, deadline=None)
@given(st.text(max_size=30))
def test_any_text_on_a_page(text):
    shown = Report(
        text, (Judgement(text, "k", "fails", feedback=text, corrected=text, steps=((text, text),)),)
    )
    page = read(shown.to_html())
    assert page.tags <= ALLOWED
    ET.fromstring(shown.to_junit().encode("utf-8"))
    assert printable(printable(text)) == printable(text)


LINES = st.recursive(
    st.sampled_from(["x", "theta_dot", "l1", "2", "0.5", "pi", "lambda_2", "x'"]),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(["+", "-", "*", "/", "**"]), inner).map(
            lambda p: f"({p[0]}){p[1]}({p[2]})"
        ),
        inner.map(lambda s: f"sin({s})**2"),
        inner.map(lambda s: f"-({s})"),
        inner.map(lambda s: f"sqrt({s})"),
        inner.map(lambda s: f"Derivative({s}, x, (t, 2))"),
        inner.map(lambda s: f"Piecewise(({s}, x < 1), (0, True))"),
    ),
    max_leaves=8,
)


def value(element):
    """Read a MathML element back as a number at fixed values of the names; the independent route of the next test."""
    children = list(element)
    match element.tag:
        case "mn":
            return sp.Rational(element.text)
        case "mi" | "msub" | "mover":
            return sp.Symbol("".join(element.itertext()))
        case "mfrac":
            return value(children[0]) / value(children[1])
        case "msqrt":
            return sp.sqrt(value(children[0]))
        case "msup":
            return value(children[0]) ** value(children[1])
        case "math":
            return value(children[0])
    assert element.tag == "mrow"
    total, product, minus, at = sp.Integer(0), None, False, 0
    while at < len(children):
        child = children[at]
        said = child.text if child.tag == "mo" else None
        if said in ("+", "−"):
            if product is not None:
                total, product = total + (-product if minus else product), None
            minus = said == "−"
        elif said == "(":
            inner = ET.Element("mrow")
            inner.extend(children[at + 1 : -1])
            assert children[-1].text == ")"
            return value(inner)
        elif said not in ("\u2062", "·"):
            factor = value(child)
            product = factor if product is None else product * factor
        at += 1
    return total + (-product if minus else product) if product is not None else total


ARITHMETIC = st.recursive(
    st.sampled_from(["x", "y", "theta_dot", "l1", "2", "3", "0.5"]),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(["+", "-", "*", "/"]), inner).map("".join),
        st.tuples(inner, st.sampled_from(["+", "-", "*", "/"]), inner).map(lambda p: f"({''.join(p)})"),
        inner.map(lambda s: f"(-({s}))"),
        inner.map(lambda s: f"({s})**2"),
    ),
    max_leaves=8,
)


@settings(max_examples=300, deadline=None)
@given(ARITHMETIC)
def test_a_set_formula_means_what_was_written(text):
    """MathML read back by its layout alone is the expression that the language reads."""
    names = {"x": "x", "y": "y", "theta_dot": "θ˙", "l1": "l1"}
    scope = Scope({name: sp.Symbol(shown) for name, shown in names.items()})
    try:
        meant = canon.expression.parse_expression(text, scope)
    except canon.expression.parse.LanguageError:
        return  # a division by zero
    assert sp.simplify(value(formula(text, scope)) - meant) == 0


@settings(max_examples=200, deadline=None)
@given(LINES)
def test_every_formula_is_set(text):
    found = formula(text, Scope())
    assert found is not None
    page = read(ET.tostring(found, encoding="unicode", method="html"))
    assert page.tags <= ALLOWED


def test_the_command_writes_both_files(tmp_path, capsys):
    sheet = tmp_path / "s.json"
    claim = {"id": "a", "kind": "equality-only", "lhs": "1", "rhs": "2"}
    sheet.write_text(
        json.dumps({"title": "Sheet", "claims": [claim, {**claim, "id": "b", "expect": "fails"}]}), "utf-8"
    )
    page, xml = tmp_path / "r.html", tmp_path / "r.xml"
    assert main(["check", str(sheet), "--html", str(page), "--junit", str(xml)]) == 1
    assert "Sheet" in page.read_text("utf-8")
    suite = ET.parse(xml).getroot().find("testsuite")
    assert suite is not None
    assert suite.attrib["tests"] == "2"
    assert suite.attrib["failures"] == "1"  # the other one fails as its author expects
    assert main(["check", str(sheet), "--html", str(tmp_path / "no" / "r.html")]) == 2
    assert "can't be written" in capsys.readouterr().err


PENDULUM = {
    "q": ["theta"],
    "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)",
    "parameters": {"m": "positive", "g": "positive", "l": "positive"},
}


def test_an_answer_that_is_right_passes():
    theta = dynamicsymbols("theta")
    g, l = sp.symbols("g l", positive=True)
    q = canon.coordinates("theta")
    for answer in (
        "theta'' = -g/l*sin(theta)",
        r"$\ddot\theta + \frac{g}{l}\sin\theta = 0$",
        sp.Eq(theta.diff(dynamicsymbols._t, 2), -g / l * sp.sin(theta)),
        q.ddot + g / l * sp.sin(q),
    ):
        assert canon.expect("euler-lagrange", **PENDULUM, claim=[answer]) is None


@pytest.mark.parametrize(
    ("claim", "sentence"),
    [
        ("theta'' - g/l*sin(theta) = 0", "in equation 1 the sign of"),
        ("theta'' + g/h*sin(theta) = 0", "column 13: h is not declared"),
        ("theta'' + g/l*sin(theta = 0", "column 18: '.' is never closed"),
    ],
)
def test_an_answer_that_is_wrong_is_told_why(claim, sentence):
    with pytest.raises(AssertionError, match=sentence):
        canon.expect("euler-lagrange", **PENDULUM, claim=[claim])


def test_what_is_not_the_answers_fault():
    with pytest.raises(SheetError, match="unknown kind"):
        canon.expect("euler-lagrage", **PENDULUM, claim=["theta"])
    with pytest.raises(SheetError, match="unknown key"):
        canon.expect("euler-lagrange", **PENDULUM, claims=["theta"])
    true = {
        "lhs": "(x + t + cos(x) + 1)**60*sin(x)**40",
        "rhs": "(x + t + cos(x) + 1)**60*(1 - cos(x)**2)**20",
    }
    with pytest.raises(
        Undecided, match=r"neither proved nor refuted: .* too large: a product of \d+ by \d+ terms"
    ):
        canon.expect("equality-only", **true, parameters={"x": "real"})


def test_a_doctest_grades_with_it(tmp_path):
    """Otter's tests are doctests, nbgrader's are cells: both pass where nothing is printed and nothing raised."""
    test = tmp_path / "q1.py"
    right = "canon.expect('equality-only', lhs='x**2 + 2*x + 1', rhs=answer, parameters={'x': 'real'})"
    test.write_text(f'"""\n>>> import canon\n>>> answer = "(x + 1)**2"\n>>> {right}\n"""\n', "utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "doctest", str(test)], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (0, "")
    wrong = tmp_path / "q2.py"  # a file of its own: the compiled one is known by its second and its size
    wrong.write_text(test.read_text("utf-8").replace("(x + 1)", "(x - 1)"), "utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "doctest", str(wrong)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "AssertionError: in rhs the sign of" in done.stdout


def test_units_are_told_of_and_change_nothing():
    keys = {
        "id": "g",
        "kind": "equality-only",
        "lhs": "9.81 m/s^2*x",
        "rhs": "981/100*x",
        "parameters": {"x": "real"},
    }
    with Worker() as worker:
        told = worker.judge(claim_from(keys))
        wrong = worker.judge(claim_from({**keys, "rhs": "980/100*x"}))
    assert (told.status, wrong.status) == ("holds", "fails")
    assert told.warnings == wrong.warnings
    assert "the unit m/s^2 in lhs is passed over" in told.warnings[0]
    assert any("m/s^2" in line for line in told.lines())


def test_a_letter_after_a_number_is_a_unit_or_a_factor_as_the_sheet_says(tmp_path, capsys):
    side_by_side = {
        "id": "a",
        "kind": "equality-only",
        "lhs": "2 x(x + 1)",
        "rhs": "2*x**2 + 2*x",
        "parameters": {"x": "real"},
    }
    claim = {"id": "a", "kind": "equality-only", "lhs": "9.81 N", "rhs": "9.81"}
    sheets = (
        ({"claims": [side_by_side]}, "holds"),
        ({"implicit_multiplication": True, "claims": [side_by_side]}, "holds"),
        ({"claims": [claim]}, "holds"),
        ({"implicit_multiplication": True, "claims": [claim]}, "invalid"),
        ({"claims": [{**claim, "implicit_multiplication": True}]}, "invalid"),
        ({"claims": [{**claim, "implicit_multiplication": "yes"}]}, "invalid"),
    )
    with Worker() as worker:
        for sheet, status in sheets:
            (said,) = sheet_from(json.dumps(sheet).encode()).claims
            assert worker.judge(said).status == status
    path = tmp_path / "s.json"
    path.write_text(json.dumps({"claims": [claim]}), "utf-8")
    assert main(["check", str(path)]) == 0
    capsys.readouterr()
    assert main(["check", "--implicit-multiplication", str(path)]) == 2
    assert "N is not declared" in capsys.readouterr().out


def test_a_sheet_that_says_it_in_toml():
    text = (
        'implicit_multiplication = true\n[[claim]]\nid = "a"\nkind = "equality-only"\nlhs = "1"\nrhs = "1"\n'
    )
    assert sheet_from(text.encode(), toml=True).claims[0].keys["implicit_multiplication"] is True
